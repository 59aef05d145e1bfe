//! The elements of a URDF: links and joints, with what stead uses of them.

use super::xml::{Element, one_line, quoted};
use crate::file_kind::FileKind;
use nalgebra::{Matrix3, Vector3};
use roxmltree::{Document, Error as XmlError, Node};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use stead_disk::files;
use stead_disk::input::InputError;
use stead_model::robot::{Inertial, InertialError, Pose};

/// No length is above this, m.
const LARGEST_LENGTH: f64 = 1e3;
/// No angle, and no angular speed, is above this, rad and rad/s: 1e6 deg.
const LARGEST_ANGLE: f64 = 17453.0;
/// Nothing else is above this.
const LARGEST: f64 = 1e12;

/// A robot as a URDF describes it: links joined by joints, in the order of the file.
#[derive(Debug, Clone)]
pub(super) struct Urdf {
    pub file: PathBuf,
    pub text: String,
    pub name: String,
    pub links: Vec<Link>,
    pub joints: Vec<Joint>,
}

/// A link.
#[derive(Debug, Clone)]
pub(super) struct Link {
    pub name: String,
    /// Where it stands in the text.
    pub byte: usize,
    /// Its mass, in its own frame; the reason where the numbers are those of no body.
    pub inertial: Option<Result<Inertial, InertialError>>,
    /// The files of its shapes, as written.
    pub meshes: Vec<String>,
    /// Its shapes for collision checks, each in its own frame; the reason where one says nothing that can be.
    pub collisions: Vec<Result<(Pose<f64>, Geometry), InputError>>,
    /// What it looks like, each in its own frame; the reason where one says nothing that can be.
    pub visuals: Vec<Result<VisualForm, InputError>>,
}

/// The form of a `<visual>`, and its colour where the file states it: red, green and blue from 0 to 1.
#[derive(Debug, Clone)]
pub(super) struct VisualForm {
    pub origin: Pose<f64>,
    pub geometry: Geometry,
    pub color: Option<[f64; 3]>,
}

/// The form of a shape. m
#[derive(Debug, Clone)]
pub(super) enum Geometry {
    Box(Vector3<f64>),
    /// Along z.
    Cylinder {
        radius: f64,
        length: f64,
    },
    Sphere(f64),
    Mesh {
        file: String,
        scale: Vector3<f64>,
    },
}

/// What a joint lets its child do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Fixed,
    Revolute,
    Continuous,
    /// Prismatic, planar or floating.
    Other(&'static str),
}

/// A joint between two links.
#[derive(Debug, Clone)]
pub(super) struct Joint {
    pub name: String,
    /// Where it stands in the text.
    pub byte: usize,
    pub kind: Kind,
    /// Index of the link before it.
    pub parent: usize,
    /// Index of the link behind it.
    pub child: usize,
    /// The frame of joint and child at joint value zero, in that of the parent.
    pub origin: Pose<f64>,
    /// Unit vector of the axis in the frame of the joint.
    pub axis: Vector3<f64>,
    pub limit: Option<Limit>,
    /// The joint that this one follows.
    pub mimic: Option<String>,
}

/// The limits of a joint. rad, rad/s
#[derive(Debug, Clone, Copy)]
pub(super) struct Limit {
    pub lower: Option<f64>,
    pub upper: Option<f64>,
    pub velocity: Option<f64>,
}

impl Urdf {
    /// Reads a file.
    pub fn read(file: &Path) -> Result<Self, InputError> {
        let bytes = files::read(file).map_err(|error| {
            InputError::new(file, format!("cannot be read: {error}")).allowed("the name of a readable URDF file")
        })?;
        // CAM systems write comments in the code page of their machine.
        FileKind::expect(&KINDS, file, &bytes, WANTED)?;
        let text = String::from_utf8(bytes)
            .map_err(|_| InputError::new(file, "is not UTF-8 text").allowed("a URDF in UTF-8"))?;
        Self::parse(file, text)
    }

    /// Takes the text of a file already read; `file` is its name in messages.
    pub fn parse(file: &Path, text: String) -> Result<Self, InputError> {
        FileKind::expect(&KINDS, file, text.as_bytes(), WANTED)?;
        let (name, links, joints) = {
            let document = Document::parse(&text).map_err(|error| not_xml(file, &text, &error))?;
            let root = Element { file, node: document.root_element() };
            if root.tag() != "robot" {
                return Err(root.error(None, "is not a robot", "a URDF, whose outermost element is <robot>"));
            }
            refuse_xacro(root)?;
            let name = root.require("name")?.to_owned();
            let (links, numbers) = links_of(root)?;
            let joints = joints_of(root, &numbers)?;
            (name, links, joints)
        };
        Ok(Self { file: file.to_owned(), text, name, links, joints })
    }

    /// An error at a place of the text.
    pub fn error(
        &self,
        byte: usize,
        field: impl Into<String>,
        problem: impl Into<String>,
        allowed: impl Into<String>,
    ) -> InputError {
        let before = self.text.as_bytes().get(..byte).unwrap_or_default();
        let line = 1 + before.iter().filter(|byte| **byte == b'\n').count();
        InputError::new(&self.file, problem).at_line(line).in_field(field).allowed(allowed)
    }

    /// An error at a joint.
    pub fn joint_error(&self, joint: usize, problem: impl Into<String>, allowed: impl Into<String>) -> InputError {
        let joint = &self.joints[joint];
        self.error(joint.byte, format!("joint {}", quoted(&joint.name)), problem, allowed)
    }
}

/// What the reader tells apart itself, with the line.
const KINDS: [FileKind; 3] = [FileKind::Urdf, FileKind::Xacro, FileKind::Xml];
const WANTED: &str = "a URDF, the robot description of ROS";
const EXPAND: &str = "a URDF: expand a xacro file first, `pip install xacro`, `xacro robot.xacro > robot.urdf`";

/// Text that is no XML, at its line.
fn not_xml(file: &Path, text: &str, error: &XmlError) -> InputError {
    if let XmlError::UnknownNamespace(prefix, at) = error
        && prefix == "xacro"
    {
        let error = InputError::new(file, "uses xacro, which is not expanded").at_line(at.row as usize);
        return error.allowed(EXPAND);
    }
    let is_cut = matches!(error, XmlError::UnexpectedEndOfStream | XmlError::UnclosedRootNode);
    let line = if is_cut { text.lines().count() } else { error.pos().row as usize };
    let problem = if is_cut {
        "ends before its last element is closed".to_owned()
    } else {
        format!("is no XML: {}", one_line(&error.to_string()))
    };
    InputError::new(file, problem).at_line(line).allowed("a URDF: well-formed XML with the root <robot>")
}

/// Refuses what a xacro file has and a URDF has not: elements of xacro, and expressions in attributes.
fn refuse_xacro(root: Element<'_>) -> Result<(), InputError> {
    let is_xacro = |node: &Node<'_, '_>| node.tag_name().namespace().is_some_and(|uri| uri.contains("xacro"));
    for node in root.node.descendants().filter(Node::is_element) {
        let at = Element { file: root.file, node };
        if is_xacro(&node) {
            return Err(at.error(None, "is an element of xacro, which is not expanded", EXPAND));
        }
        if let Some(attribute) = node.attributes().find(|attribute| attribute.value().contains("${")) {
            return Err(at.error(Some(attribute.name()), "has an expression of xacro, which is not expanded", EXPAND));
        }
    }
    Ok(())
}

/// All links, and the index of each by its name.
fn links_of(root: Element<'_>) -> Result<(Vec<Link>, BTreeMap<String, usize>), InputError> {
    let (mut links, mut numbers) = (Vec::new(), BTreeMap::new());
    for element in root.children("link") {
        let name = element.require("name")?.to_owned();
        if numbers.insert(name.clone(), links.len()).is_some() {
            return Err(element.error(Some("name"), "is the name of two links", "a name that no other link has"));
        }
        let shapes = element.children("visual").chain(element.children("collision"));
        let files = shapes.filter_map(|shape| shape.child("geometry")?.child("mesh")?.attribute("filename"));
        let mut meshes: Vec<String> = files.map(str::to_owned).collect();
        meshes.dedup();
        let inertial = element.child("inertial").map(inertial_of).transpose()?;
        let collisions = element.children("collision").map(collision_of).collect();
        let visuals = element.children("visual").map(|visual| visual_of(visual, root)).collect();
        links.push(Link { name, byte: element.byte(), inertial, meshes, collisions, visuals });
    }
    if links.is_empty() {
        return Err(root.error(None, "has no links", "a robot of links and joints"));
    }
    Ok((links, numbers))
}

fn collision_of(element: Element<'_>) -> Result<(Pose<f64>, Geometry), InputError> {
    const FORMS: &str = "<box>, <cylinder>, <sphere> or <mesh> in <geometry>";
    let origin = origin_of(element)?;
    let geometry = element.require_child("geometry")?;
    let length = |form: Element<'_>, name: &str| -> Result<f64, InputError> {
        let wanted = || form.error(Some(name), "is no length above 0", "a length above 0, in m");
        form.number(name, LARGEST_LENGTH)?.filter(|length| *length > 0.0).ok_or_else(wanted)
    };
    let form = if let Some(form) = geometry.child("box") {
        let edges = form.vector("size", LARGEST_LENGTH)?.filter(|edges| edges.iter().all(|edge| *edge > 0.0));
        let wanted = || form.error(Some("size"), "is not three lengths above 0", "three lengths above 0, in m");
        Geometry::Box(edges.ok_or_else(wanted)?.into())
    } else if let Some(form) = geometry.child("cylinder") {
        Geometry::Cylinder { radius: length(form, "radius")?, length: length(form, "length")? }
    } else if let Some(form) = geometry.child("sphere") {
        Geometry::Sphere(length(form, "radius")?)
    } else if let Some(form) = geometry.child("mesh") {
        let scale = Vector3::from(form.vector("scale", LARGEST_LENGTH)?.unwrap_or([1.0; 3]));
        if scale.iter().any(|factor| *factor == 0.0) {
            return Err(form.error(Some("scale"), "has a factor of 0", "three factors that are not 0"));
        }
        Geometry::Mesh { file: form.require("filename")?.to_owned(), scale }
    } else {
        return Err(geometry.error(None, "has no form that is known", FORMS));
    };
    Ok((origin, form))
}

fn visual_of(element: Element<'_>, root: Element<'_>) -> Result<VisualForm, InputError> {
    let (origin, geometry) = collision_of(element)?;
    // A material with its colour, or the name of one that the robot has.
    let named = |material: Element<'_>| {
        let name = material.attribute("name")?;
        root.children("material").find(|known| known.attribute("name") == Some(name))?.child("color")
    };
    let color = element.child("material").and_then(|material| material.child("color").or_else(|| named(material)));
    let parts = color
        .and_then(|color| color.attribute("rgba"))
        .map(|rgba| rgba.split_whitespace().take(3).map_while(|part| part.parse::<f64>().ok()).collect::<Vec<f64>>());
    let color = parts.and_then(|parts| <[f64; 3]>::try_from(parts).ok());
    let color = color.filter(|parts| parts.iter().all(|part| (0.0..=1.0).contains(part)));
    Ok(VisualForm { origin, geometry, color })
}

fn inertial_of(element: Element<'_>) -> Result<Result<Inertial, InertialError>, InputError> {
    let origin = origin_of(element)?;
    let mass = match element.child("mass") {
        Some(mass) => mass.number("value", LARGEST)?.unwrap_or_default(),
        None => 0.0,
    };
    let inertia = element.child("inertia");
    let entry = |name: &str| -> Result<f64, InputError> {
        let given = inertia.map(|inertia| inertia.number(name, LARGEST)).transpose()?;
        Ok(given.flatten().unwrap_or_default())
    };
    let [xx, yy, zz] = [entry("ixx")?, entry("iyy")?, entry("izz")?];
    let [xy, xz, yz] = [entry("ixy")?, entry("ixz")?, entry("iyz")?];
    let tensor = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    Ok(Inertial::new(mass, Vector3::zeros(), tensor).map(|body| body.placed(&origin)))
}

fn joints_of(root: Element<'_>, links: &BTreeMap<String, usize>) -> Result<Vec<Joint>, InputError> {
    let (mut joints, mut names) = (Vec::new(), BTreeMap::new());
    for element in root.children("joint") {
        let name = element.require("name")?.to_owned();
        if names.insert(name.clone(), ()).is_some() {
            return Err(element.error(Some("name"), "is the name of two joints", "a name that no other joint has"));
        }
        let end = |tag: &'static str| -> Result<usize, InputError> {
            let end = element.require_child(tag)?;
            let name = end.require("link")?;
            let unknown = || end.error(Some("link"), "names no link of the file", "the name of a <link>");
            links.get(name).copied().ok_or_else(unknown)
        };
        joints.push(Joint {
            name,
            byte: element.byte(),
            kind: kind_of(element)?,
            parent: end("parent")?,
            child: end("child")?,
            origin: origin_of(element)?,
            axis: axis_of(element)?,
            limit: element.child("limit").map(limit_of).transpose()?,
            mimic: element.child("mimic").map(|mimic| mimic.require("joint").map(str::to_owned)).transpose()?,
        });
    }
    Ok(joints)
}

fn kind_of(element: Element<'_>) -> Result<Kind, InputError> {
    Ok(match element.require("type")? {
        "fixed" => Kind::Fixed,
        "revolute" => Kind::Revolute,
        "continuous" => Kind::Continuous,
        "prismatic" => Kind::Other("prismatic"),
        "planar" => Kind::Other("planar"),
        "floating" => Kind::Other("floating"),
        _ => {
            let allowed = "revolute, continuous, prismatic, fixed, planar or floating";
            return Err(element.error(Some("type"), "is no type of joint", allowed));
        }
    })
}

/// The element `<origin>`: `Tx Ty Tz Rz(yaw) Ry(pitch) Rx(roll)`; nothing moved where it is left out.
fn origin_of(element: Element<'_>) -> Result<Pose<f64>, InputError> {
    let Some(origin) = element.child("origin") else { return Ok(Pose::identity()) };
    let xyz = origin.vector("xyz", LARGEST_LENGTH)?.unwrap_or_default();
    let [roll, pitch, yaw] = origin.vector("rpy", LARGEST_ANGLE)?.unwrap_or_default();
    let [(sr, cr), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(libm::sincos);
    let about_z = Matrix3::new(cy, -sy, 0.0, sy, cy, 0.0, 0.0, 0.0, 1.0);
    let about_y = Matrix3::new(cp, 0.0, sp, 0.0, 1.0, 0.0, -sp, 0.0, cp);
    let about_x = Matrix3::new(1.0, 0.0, 0.0, 0.0, cr, -sr, 0.0, sr, cr);
    Ok(Pose { rotation: about_z * about_y * about_x, translation: xyz.into() })
}

/// The unit vector of `<axis>`: x where it is left out.
fn axis_of(element: Element<'_>) -> Result<Vector3<f64>, InputError> {
    let Some(axis) = element.child("axis") else { return Ok(Vector3::x()) };
    let xyz = Vector3::from(axis.vector("xyz", LARGEST_LENGTH)?.unwrap_or([1.0, 0.0, 0.0]));
    if xyz.norm() < SHORTEST_AXIS && element.require("type")? == "fixed" {
        // It does not turn about anything.
        return Ok(Vector3::x());
    }
    if xyz.norm() < SHORTEST_AXIS {
        return Err(axis.error(Some("xyz"), "is an axis of length zero", "the direction of an axis"));
    }
    Ok(xyz.normalize())
}

/// A shorter vector has no direction.
const SHORTEST_AXIS: f64 = 1e-6;

fn limit_of(element: Element<'_>) -> Result<Limit, InputError> {
    let number = |name: &str| element.number(name, LARGEST);
    number("effort")?;
    Ok(Limit { lower: number("lower")?, upper: number("upper")?, velocity: number("velocity")? })
}
