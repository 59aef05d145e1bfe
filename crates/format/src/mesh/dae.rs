//! COLLADA (DAE): the surfaces of a scene, each where the nodes of the scene place it, in metres by the unit that the
//! file states. Of a surface only its vertices are read; a polygon with more than three corners becomes a fan.
//!
//! The coordinates are taken as they are written, whatever `<up_axis>` says: so ROS shows them.

use super::stl::number_of;
use super::{MAX_TRIANGLES, THINNER, Triangles};
use crate::urdf::xml::{Element, one_line};
use nalgebra::{Matrix4, Rotation3, Unit, Vector3, Vector4};
use roxmltree::{Document, Node};
use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;
use stead_disk::files::without_mark;
use stead_disk::input::InputError;
use stead_disk::quote::shorten;

/// Nodes within nodes, and nodes in all with those that are shown again: no more than any scene has.
const DEEPEST: usize = 64;
const MOST_NODES: usize = 20_000;
const KIND: &str = "a COLLADA file: well-formed XML with the root <COLLADA>";

pub(super) fn read(file: &Path, bytes: &[u8]) -> Result<Triangles, InputError> {
    let text = str::from_utf8(without_mark(bytes))
        .map_err(|_| InputError::new(file, "is not UTF-8 text").allowed("a DAE file in UTF-8"))?;
    let document = Document::parse(text).map_err(|error| {
        let problem = format!("is no XML: {}", one_line(&error.to_string()));
        InputError::new(file, problem).at_line(error.pos().row as usize).allowed(KIND)
    })?;
    let root = Element { file, node: document.root_element() };
    if root.tag() != "COLLADA" {
        return Err(root.error(None, "is no COLLADA file", KIND));
    }
    let unit = root.child("asset").and_then(|asset| asset.child("unit"));
    let metres = unit.map(|unit| unit.number("meter", 1e3)).transpose()?.flatten().unwrap_or(1.0);
    if let Some(unit) = unit.filter(|_| metres <= 0.0) {
        return Err(unit.error(Some("meter"), "is no length above 0", "the length of a unit in m"));
    }
    let elements = root.node.descendants().filter(Node::is_element);
    let ids = elements.filter_map(|node| Some((node.attribute("id")?, Element { file, node }))).collect();
    let mut scene = Scene { ids, positions: BTreeMap::new(), nodes: 0, read: Triangles::default() };
    let pose = Matrix4::new_scaling(metres);
    let shown = root.child("scene").and_then(|scene| scene.child("instance_visual_scene"));
    if let Some(shown) = shown {
        scene.node(scene.named(shown, "url")?, &pose, 0)?;
    } else {
        // Without a scene, everything that there is.
        for geometry in root.children("library_geometries").flat_map(|library| library.children("geometry")) {
            scene.geometry(geometry, &pose)?;
        }
    }
    if scene.read.triangles.is_empty() {
        return Err(root.error(None, "shows no triangles", "a scene with <triangles>, <polylist> or <polygons>"));
    }
    Ok(scene.read)
}

/// A scene on its way.
struct Scene<'a> {
    ids: BTreeMap<&'a str, Element<'a>>,
    /// Those of a source of positions, by its place in the text.
    positions: BTreeMap<usize, Rc<Vec<Vector3<f64>>>>,
    /// Nodes gone through.
    nodes: usize,
    read: Triangles,
}

impl<'a> Scene<'a> {
    /// The element that an attribute names by `#id`.
    fn named(&self, at: Element<'a>, attribute: &str) -> Result<Element<'a>, InputError> {
        let name = at.require(attribute)?;
        let found = name.strip_prefix('#').and_then(|id| self.ids.get(id));
        found.copied().ok_or_else(|| at.error(Some(attribute), "names nothing of this file", "# and an id of the file"))
    }

    fn node(&mut self, node: Element<'a>, above: &Matrix4<f64>, depth: usize) -> Result<(), InputError> {
        self.nodes += 1;
        if depth > DEEPEST || self.nodes > MOST_NODES {
            let allowed = format!("{DEEPEST} nodes within each other and {MOST_NODES} in all, none within itself");
            return Err(node.error(None, "is in a scene of too many nodes", allowed));
        }
        let mut pose = *above;
        for below in node.node.children().filter(Node::is_element) {
            let at = Element { file: node.file, node: below };
            match at.tag() {
                "matrix" | "translate" | "rotate" | "scale" => pose *= transform(at)?,
                "lookat" | "skew" => {
                    return Err(at.error(None, "is not read", "<matrix>, <translate>, <rotate> and <scale>"));
                }
                "instance_controller" => {
                    return Err(at.error(None, "is a deformed surface, which is not read", "<instance_geometry>"));
                }
                "instance_geometry" => self.geometry(self.named(at, "url")?, &pose)?,
                "instance_node" => self.node(self.named(at, "url")?, &pose, depth + 1)?,
                "node" => self.node(at, &pose, depth + 1)?,
                _ => {}
            }
        }
        Ok(())
    }

    fn geometry(&mut self, geometry: Element<'a>, pose: &Matrix4<f64>) -> Result<(), InputError> {
        let mesh = geometry.require_child("mesh")?;
        for part in mesh.node.children().filter(Node::is_element) {
            let part = Element { file: mesh.file, node: part };
            if matches!(part.tag(), "triangles" | "polylist" | "polygons" | "trifans" | "tristrips") {
                self.surface(part, pose)?;
            }
        }
        Ok(())
    }

    /// Triangles of one `<triangles>` and the like.
    fn surface(&mut self, part: Element<'a>, pose: &Matrix4<f64>) -> Result<(), InputError> {
        let (mut stride, mut vertex) = (0, None);
        for input in part.children("input") {
            let offset = input.number("offset", 255.0)?.filter(|offset| *offset >= 0.0).unwrap_or(0.0) as usize;
            stride = stride.max(offset + 1);
            if input.attribute("semantic") == Some("VERTEX") {
                vertex = Some((input, offset));
            }
        }
        let (input, offset) = vertex.ok_or_else(|| {
            part.error(None, "has no input of vertices", "an <input semantic=\"VERTEX\" source=\"#..\"/>")
        })?;
        let positions = self.positions(self.named(input, "source")?)?;
        let is_mirrored = pose.fixed_view::<3, 3>(0, 0).determinant() < 0.0;
        for corners in corners(part, stride, offset)? {
            let at = |number: &usize| {
                let found = positions.get(*number).map(|at| (pose * Vector4::new(at.x, at.y, at.z, 1.0)).xyz());
                let problem = || format!("names vertex {number}, and there are {}", positions.len());
                found.ok_or_else(|| part.error(None, problem(), "numbers of vertices from 0"))
            };
            let corners = corners.iter().map(at).collect::<Result<Vec<_>, _>>()?;
            if corners.iter().flatten().any(|value| !value.is_finite()) {
                return Err(part.error(
                    None,
                    "has a vertex that is placed nowhere",
                    "coordinates and transforms that are finite",
                ));
            }
            for (number, edge) in corners.windows(2).enumerate().skip(1) {
                let is_strip = part.tag() == "tristrips";
                let first = if is_strip { corners[number - 1] } else { corners[0] };
                let is_turned = is_mirrored != (is_strip && number % 2 == 0);
                let triangle = if is_turned { [first, edge[1], edge[0]] } else { [first, edge[0], edge[1]] };
                self.read.push(triangle);
            }
            if self.read.triangles.len() > MAX_TRIANGLES {
                return Err(part.error(None, "makes too many triangles", THINNER));
            }
        }
        Ok(())
    }

    /// The positions that `<vertices>` name.
    fn positions(&mut self, vertices: Element<'a>) -> Result<Rc<Vec<Vector3<f64>>>, InputError> {
        let input = vertices.children("input").find(|input| input.attribute("semantic") == Some("POSITION"));
        let input = input.ok_or_else(|| {
            vertices.error(None, "have no positions", "an <input semantic=\"POSITION\" source=\"#..\"/>")
        })?;
        let source = self.named(input, "source")?;
        if let Some(known) = self.positions.get(&source.byte()) {
            return Ok(Rc::clone(known));
        }
        let array = source.require_child("float_array")?;
        let accessor = source.child("technique_common").and_then(|technique| technique.child("accessor"));
        let whole = |name: &str, else_: f64| -> Result<usize, InputError> {
            let Some(accessor) = accessor else { return Ok(else_ as usize) };
            Ok(accessor.number(name, 1e6)?.filter(|value| *value >= 0.0).unwrap_or(else_) as usize)
        };
        let (stride, offset) = (whole("stride", 3.0)?.max(3), whole("offset", 0.0)?);
        let numbers = numbers(array)?;
        let rows = numbers.get(offset..).unwrap_or_default().chunks_exact(stride);
        let made = Rc::new(rows.map(|row| Vector3::new(row[0], row[1], row[2])).collect::<Vec<_>>());
        self.positions.insert(source.byte(), Rc::clone(&made));
        Ok(made)
    }
}

/// The numbers of the vertices of each face.
fn corners(part: Element<'_>, stride: usize, offset: usize) -> Result<Vec<Vec<usize>>, InputError> {
    if part.child("ph").is_some() {
        return Err(part.error(None, "has polygons with holes, which are not read", "polygons without holes"));
    }
    let mut all: Vec<Vec<usize>> = Vec::new();
    for numbers in part.children("p") {
        let corners = wholes(numbers)?;
        let vertices: Vec<usize> = corners.chunks_exact(stride).map(|corner| corner[offset]).collect();
        match part.tag() {
            "triangles" => all.extend(vertices.chunks_exact(3).map(<[usize]>::to_vec)),
            "polylist" => {
                let mut rest = &vertices[..];
                for count in wholes(part.require_child("vcount")?)? {
                    let Some((face, others)) = rest.split_at_checked(count) else {
                        return Err(part.error(None, "has fewer corners than <vcount> says", "as many as it says"));
                    };
                    rest = others;
                    all.push(face.to_vec());
                }
            }
            _ => all.push(vertices),
        }
    }
    Ok(all)
}

/// What a transform of a node does.
fn transform(at: Element<'_>) -> Result<Matrix4<f64>, InputError> {
    let numbers = numbers(at)?;
    let made = match (at.tag(), &numbers[..]) {
        ("matrix", values) if values.len() == 16 => Some(Matrix4::from_row_slice(values)),
        ("translate", [x, y, z]) => Some(Matrix4::new_translation(&Vector3::new(*x, *y, *z))),
        ("scale", [x, y, z]) => Some(Matrix4::new_nonuniform_scaling(&Vector3::new(*x, *y, *z))),
        ("rotate", [_, _, _, 0.0]) => Some(Matrix4::identity()),
        ("rotate", [x, y, z, degrees]) => Unit::try_new(Vector3::new(*x, *y, *z), 1e-9).map(|axis| {
            let (sine, cosine) = libm::sincos(degrees.to_radians());
            let across = axis.cross_matrix();
            let turned = nalgebra::Matrix3::identity() + across * sine + across * across * (1.0 - cosine);
            Rotation3::from_matrix_unchecked(turned).to_homogeneous()
        }),
        _ => None,
    };
    let allowed = "16 numbers of <matrix>, three of <translate> and <scale>, an axis and an angle of <rotate>";
    made.ok_or_else(|| at.error(None, "has not the numbers of such a transform", allowed))
}

/// The words of the text of an element.
fn words<'a>(at: Element<'a>) -> impl Iterator<Item = &'a str> {
    at.node.children().filter(Node::is_text).filter_map(|text| text.text()).flat_map(str::split_ascii_whitespace)
}

fn numbers(at: Element<'_>) -> Result<Vec<f64>, InputError> {
    let wrong = |word: &str| {
        at.error(None, "has a word that is no finite number", "finite numbers").found(format!("'{}'", shorten(word)))
    };
    words(at).map(|word| number_of(word).ok_or_else(|| wrong(word))).collect()
}

fn wholes(at: Element<'_>) -> Result<Vec<usize>, InputError> {
    let wrong = |word: &str| {
        let error = at.error(None, "has a word that is no number of a vertex", "whole numbers from 0");
        error.found(format!("'{}'", shorten(word)))
    };
    words(at).map(|word| word.parse::<u32>().map(|n| n as usize).map_err(|_| wrong(word))).collect()
}
