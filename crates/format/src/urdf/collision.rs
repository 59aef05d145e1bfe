//! The `<collision>` shapes of a URDF as surroundings: each attached to a link of the arm, in the frame of its row.

use super::arm::Arm;
use super::bodies::{attached_to, row_from_links};
use super::meshes::{found, free_name, is_read, unit_of};
use super::read::{Geometry, Urdf};
use super::xml::{one_line, quoted};
use crate::mesh::{MeshUnit, read_mesh};
use crate::surroundings::{CLEARANCE, attachment};
use nalgebra::Vector3;
use std::path::PathBuf;
use std::sync::Arc;
use stead_cell::collider::Collider;
use stead_cell::scene::PairKind;
use stead_cell::{Attachment, Scene, SceneError, Shape, Solid, Surroundings, TriangleMesh};
use stead_disk::files;
use stead_disk::input::InputError;
use stead_model::robot::{Pose, Robot};

/// A shape of a link, and the mesh file that it is made of.
#[derive(Debug, Clone)]
pub struct LinkShape {
    /// The shape, in the frame of the row that its link moves with.
    pub shape: Shape,
    /// The mesh file, and its unit.
    pub file: Option<(PathBuf, MeshUnit)>,
}

/// What a URDF says of the bodies of its links.
#[derive(Debug, Clone)]
pub struct LinkShapes {
    /// The shapes, base first.
    pub shapes: Vec<LinkShape>,
    /// Pairs that touch in every posture or at joint values zero, or that are near in every posture.
    pub ignored: Vec<[String; 2]>,
    /// What the user should know, in sentences.
    pub notes: Vec<String>,
}

/// A mesh sticks out of its hull nowhere, and the hull out of the mesh by no more than this: it is taken for convex. m
const CONVEX: f64 = 1e-3;

/// The shapes of what stands with the base and of the six links behind the moving joints, each with all that is fixed
/// to it.
///
/// # Errors
/// [`InputError`] for a `<collision>` that says nothing that can be, and for a mesh file that cannot be read.
pub(super) fn link_shapes(arm: &Arm<'_>) -> Result<LinkShapes, InputError> {
    let stand = &arm.stand;
    let mut read = Reading { urdf: arm.urdf, shapes: Vec::new(), notes: Vec::new() };
    read.links(stand.link, &stand.cell_from_link(), Attachment::Base)?;
    for ((link, row_from_link), number) in row_from_links(arm).into_iter().zip(1..) {
        read.links(link, &row_from_link, Attachment::Link(number))?;
    }
    let Reading { shapes, mut notes, .. } = read;
    let zero = std::array::from_fn(|k| arm.rows.rows[k].offset_deg.to_radians());
    let mounted = arm.robot.clone().mounted(&stand.mount.unwrap_or_else(Pose::identity));
    let ignored = touching(&mounted, &zero, &shapes, &mut notes);
    Ok(LinkShapes { shapes, ignored, notes })
}

/// The form of a shape, where its middle is in the frame of the `<collision>`, and the mesh file.
struct Form {
    solid: Solid,
    middle: Pose<f64>,
    file: Option<(PathBuf, MeshUnit)>,
}

struct Reading<'a> {
    urdf: &'a Urdf,
    shapes: Vec<LinkShape>,
    notes: Vec<String>,
}

impl Reading<'_> {
    /// The shapes of a link and of all that is fixed to it.
    fn links(&mut self, link: usize, frame_from_link: &Pose<f64>, attached: Attachment) -> Result<(), InputError> {
        let before = self.shapes.len();
        for (link, pose) in attached_to(self.urdf, link) {
            for collision in &self.urdf.links[link].collisions {
                let (origin, geometry) = collision.clone()?;
                let pose = frame_from_link.then(&pose).then(&origin);
                self.shape(link, geometry, pose, attached)?;
            }
        }
        if before == self.shapes.len() && attached != Attachment::Base {
            let link = quoted(&self.urdf.links[link].name);
            self.notes.push(format!("link {link} has no <collision> shape: the arm is not checked there"));
        }
        Ok(())
    }

    fn shape(
        &mut self,
        link: usize,
        geometry: Geometry,
        pose: Pose<f64>,
        attached: Attachment,
    ) -> Result<(), InputError> {
        let name = self.name(link);
        let plain = |solid: Solid| Some(Form { solid, middle: Pose::identity(), file: None });
        let form = match geometry {
            Geometry::Box(edges) => plain(Solid::Box(edges)),
            Geometry::Cylinder { radius, length } => plain(Solid::Cylinder { radius, length }),
            Geometry::Sphere(radius) => plain(Solid::Capsule { radius, length: 0.0 }),
            Geometry::Mesh { file, scale } => self.mesh(&name, &file, &scale)?,
        };
        if let Some(Form { solid, middle, file }) = form {
            let shape = Shape { name, attached, solid, pose: pose.then(&middle) };
            self.shapes.push(LinkShape { shape, file });
        }
        Ok(())
    }

    /// A name for a shape of a link: that of the link, made different from frames and other shapes.
    fn name(&self, link: usize) -> String {
        let plain = one_line(&self.urdf.links[link].name).replace('"', "'");
        let plain = if attachment(&plain).is_some() { format!("{plain} shape") } else { plain };
        free_name(plain, |name| self.shapes.iter().all(|known| known.shape.name != name))
    }

    /// The form that a mesh file makes; nothing for a file that is not read.
    fn mesh(&mut self, name: &str, file: &str, scale: &Vector3<f64>) -> Result<Option<Form>, InputError> {
        let here = Pose::identity();
        if !is_read(file) {
            let problem = "is none of STL, OBJ and DAE: the shape is left out";
            self.notes.push(format!("mesh {} of {name:?} {problem}", quoted(file)));
            return Ok(None);
        }
        let Some(path) = found(self.urdf, file) else {
            self.notes.push(format!("mesh {} of {name:?} is not found: the shape is left out", quoted(file)));
            return Ok(None);
        };
        let bytes = files::read(&path)
            .map_err(|e| InputError::new(&path, format!("cannot be read: {e}")).allowed("a readable mesh file"))?;
        let Some(unit) = unit_of(scale) else {
            let mesh = read_mesh(&path, &bytes, MeshUnit::Metre)?;
            let [low, high] = Solid::Mesh(Arc::new(mesh)).extent().map(|end| end.component_mul(scale));
            let middle = Pose { translation: (low + high) / 2.0, ..here };
            self.notes.push(format!(
                "mesh {} of {name:?} is scaled by {:?}: the box around it is taken",
                quoted(file),
                scale.as_slice()
            ));
            return Ok(Some(Form { solid: Solid::Box((high - low).abs()), middle, file: None }));
        };
        let mesh = Arc::new(read_mesh(&path, &bytes, unit)?);
        if mesh.is_closed() && is_convex(&mesh) && Collider::new(&Solid::Hull(mesh.clone()), &here).is_some() {
            return Ok(Some(Form { solid: Solid::Hull(mesh), middle: here, file: Some((path, unit)) }));
        }
        let reason = if mesh.is_closed() { "not convex" } else { "not closed, so that it has no inside" };
        self.notes.push(format!(
            "the mesh of {name:?} is {reason}: it is taken as it is; a hull would be faster and refuse more"
        ));
        Ok(Some(Form { solid: Solid::Mesh(mesh), middle: here, file: Some((path, unit)) }))
    }
}

/// Whether no vertex is above any triangle by more than the tolerance.
fn is_convex(mesh: &TriangleMesh) -> bool {
    let corner = |number: u32| mesh.vertices()[number as usize];
    mesh.triangles().iter().all(|triangle| {
        let [a, b, c] = triangle.map(corner);
        let normal = (b - a).cross(&(c - a));
        let area = normal.norm();
        // A sliver says nothing of its plane.
        area < SLIVER || mesh.vertices().iter().all(|vertex| (vertex - a).dot(&normal) <= CONVEX * area)
    })
}

/// Twice the area of a triangle that is too small to have a plane. m^2
const SLIVER: f64 = 1e-8;

/// Pairs of shapes that touch in every posture or at joint values zero, or that are near in every posture, noted.
fn touching(robot: &Robot, zero: &[f64; 6], shapes: &[LinkShape], notes: &mut Vec<String>) -> Vec<[String; 2]> {
    let mut ignored: Vec<[String; 2]> = Vec::new();
    let scene = loop {
        let all = shapes.iter().map(|shape| shape.shape.clone()).collect();
        let around = Surroundings::new(all, Vec::new(), CLEARANCE, ignored.clone());
        let Ok(around) = around else { return ignored };
        match Scene::new(robot, &Pose::identity(), around) {
            Ok(scene) => break scene,
            Err(SceneError::AlwaysTouching(pairs)) if !pairs.is_empty() => {
                notes.extend(
                    pairs.iter().map(|[a, b]| format!("{a:?} and {b:?} touch in every posture tried: ignored")),
                );
                ignored.extend(pairs);
            }
            Err(error) => {
                notes.push(error.to_string());
                return ignored;
            }
        }
    };
    let poses = scene.poses(zero, &Pose::identity());
    for (pair, number) in scene.pairs().iter().zip(0..) {
        if pair.kind != PairKind::WorkpieceCell && !scene.keeps_apart(number, &poses) {
            notes.push(format!(
                "{pair} touch at joint values zero: ignored; take the pair out of ignore if they really do"
            ));
            ignored.push(pair.names.as_ref().clone());
        }
    }
    let near = scene.always_near(ALWAYS_NEAR).into_iter().filter(|pair| !ignored.contains(pair)).collect::<Vec<_>>();
    notes.extend(near.iter().map(|[a, b]| {
        let mm = ALWAYS_NEAR * 1e3;
        format!(
            "{a:?} and {b:?} are within {mm} mm of each other in every posture tried, as parts next to each other \
             are: ignored; take the \
             pair out of ignore if they can touch"
        )
    }));
    ignored.extend(near);
    ignored
}

/// Shapes nearer than this in every posture are parts that move along with each other. m
const ALWAYS_NEAR: f64 = 0.05;
