//! Cutter and holder on the moves between segments, and the part that they are kept out of.
//!
//! In the cut the cutter is in the part; between segments it must not be. So cutter and holder are shapes of these
//! moves alone, held against all that is not on the arm. The part is what is attached to the workpiece and holds the
//! path; where there is no such shape and all tool axes are one, it is the box of the path's extent.

use crate::collider::Collider;
use crate::{Attachment, Scene, SceneError, Shape, Solid, Surroundings};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;
use stead_model::robot::{Pose, Robot};
use stead_model::task::{PathPoint, ToolPath};
use stead_numerics::digits::figures;

/// A cylinder about the tool axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    /// Its radius. m
    pub radius: f64,
    /// The height above the tool centre point at which it begins. m
    pub from: f64,
    /// The height at which it ends. m
    pub to: f64,
}

/// What turns with the spindle below its nose.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ToolBody {
    /// Along its flutes, where its diameter is known; its end face alone where their length is not. Of a tapered cutter
    /// its lowest part.
    pub cutter: Option<Cylinder>,
    /// The other parts of a tapered cutter, from below, each as wide as its upper end.
    pub taper: Vec<Cylinder>,
    /// Shank and holder above it, from below.
    pub holder: Vec<Cylinder>,
}

/// What cutter and holder are kept out of.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Part {
    /// Shapes that are attached to the workpiece.
    Shapes,
    /// The box of the path's extent, with these edges. m
    PathBox(Vector3<f64>),
    /// Nothing is known of it, and the tool axes differ.
    Unknown,
}

/// The shapes around an arm with cutter, holder and part.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolScene {
    scene: Scene,
    tool: ToolBody,
    flange_from_tool: Pose<f64>,
    part: Part,
}

/// How the tool gets out of the cut and over to the next segment, where there are shapes to keep free of.
#[derive(Debug, Clone, PartialEq)]
pub struct SegmentMoves {
    /// How far it is drawn out along its axis. m
    pub retract: f64,
    /// The shapes with cutter, holder and part; without them the shapes alone are kept free of.
    pub tool: Option<Arc<ToolScene>>,
    /// Diameter of the cutter, where it is stated, with shapes or without. m
    pub cutter_diameter: Option<f64>,
}

impl Default for SegmentMoves {
    fn default() -> Self {
        Self { retract: 0.05, tool: None, cutter_diameter: None }
    }
}

/// Path points may be so far outside of the box around a shape that is the part. m
const BESIDE_PART: f64 = 0.01;
/// Tool axes are one where they differ by less. rad
const SAME_AXIS: f64 = 1e-6;
/// The length of what is but a face or a point. m
const FACE: f64 = 1e-4;
/// Halvings by which it is found how deep the cutter is in the part at a path point.
const HALVINGS: usize = 12;

impl Cylinder {
    /// The shape of it on the tool frame, whose z axis points to the work.
    fn solid(self) -> (Solid, Pose<f64>) {
        let middle = Vector3::new(0.0, 0.0, -(self.from + self.to) / 2.0);
        let length = (self.to - self.from).max(FACE);
        let solid = match self.radius > 0.0 {
            true => Solid::Cylinder { radius: self.radius, length },
            false => Solid::Capsule { radius: FACE / 2.0, length: 0.0 },
        };
        (solid, Pose { translation: middle, ..Pose::identity() })
    }
}

impl ToolBody {
    /// Its cylinders with their names; the tool centre point alone where nothing is known of it.
    fn pieces(&self) -> Vec<(String, Cylinder)> {
        let parts = self.cutter.iter().chain(&self.taper);
        let cutter = parts.map(|part| ("cutter".to_owned(), *part));
        let holder = self.holder.iter().map(|piece| ("holder".to_owned(), *piece));
        let mut pieces: Vec<_> = cutter.chain(holder).collect();
        if pieces.is_empty() {
            pieces.push(("tool point".to_owned(), Cylinder { radius: 0.0, from: 0.0, to: 0.0 }));
        }
        pieces
    }
}

impl ToolScene {
    /// Joins the shapes around an arm with its tool, for a path in the frame of its task file.
    ///
    /// # Errors
    /// [`SceneError`] where a piece of the tool touches something in every posture.
    pub fn new(
        robot: &Robot,
        flange_from_tool: &Pose<f64>,
        around: &Scene,
        path: &ToolPath,
        tool: ToolBody,
    ) -> Result<Self, SceneError> {
        let known = around.surroundings();
        let mut shapes = known.shapes().to_vec();
        let mut ignored = known.ignored().to_vec();
        let (part, part_box) = part_of(&shapes, path.points());
        let unlike_all = |name: String, shapes: &[Shape]| {
            let is_taken = |name: &str| {
                shapes.iter().any(|shape| shape.name == name) || known.zones().iter().any(|zone| zone.name == name)
            };
            let numbered = (2..).map(|number| format!("{name} {number}"));
            std::iter::once(name.clone()).chain(numbered).find(|name| !is_taken(name)).unwrap_or(name)
        };
        let count = shapes.len();
        let on_arm = |shape: &Shape| matches!(shape.attached, Attachment::Link(_) | Attachment::Flange);
        for (name, piece) in tool.pieces() {
            let (solid, tool_from_piece) = piece.solid();
            let name = unlike_all(name, &shapes);
            // The arm itself is not held against its own tool.
            let arm = shapes[..count].iter().filter(|shape| on_arm(shape));
            ignored.extend(arm.map(|shape| [name.clone(), shape.name.clone()]));
            let pose = flange_from_tool.then(&tool_from_piece);
            shapes.push(Shape { name, attached: Attachment::Flange, solid, pose });
        }
        if let Some((solid, pose)) = part_box {
            let name = unlike_all("extent of the path".to_owned(), &shapes);
            ignored.extend(shapes[..count].iter().map(|shape| [name.clone(), shape.name.clone()]));
            shapes.push(Shape { name, attached: Attachment::Workpiece, solid, pose });
        }
        // All names are known and unlike each other, and the clearance is one that was allowed.
        let joined = Surroundings::new(shapes, known.zones().to_vec(), known.clearance(), ignored);
        let joined = joined.unwrap_or_else(|_| known.clone()).with_visuals(known.visuals().to_vec());
        let scene = Scene::new(robot, flange_from_tool, joined)?;
        Ok(Self { scene, tool, flange_from_tool: *flange_from_tool, part })
    }

    /// All shapes, with cutter, holder and part.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// What of tool and part is not known, in sentences.
    pub fn notes(&self) -> Vec<String> {
        let moves = "on moves between segments";
        let of_tool = match (&self.tool.cutter, self.tool.holder.is_empty()) {
            (None, true) => Some(format!(
                "{moves} the tool centre point alone is kept out of the part: state [tool] cutter_diameter_mm, flute_length_mm and holder_mm"
            )),
            (None, false) => {
                Some(format!("{moves} the holder is kept out of the part, the cutter is not: state its diameter"))
            }
            (Some(cutter), _) if cutter.to <= FACE => Some(format!(
                "{moves} the cutter's end face alone is kept out of the part: state [tool] flute_length_mm"
            )),
            (Some(_), true) => Some(format!("{moves} the holder is not kept out of the part: state [tool] holder_mm")),
            (Some(_), false) => None,
        };
        let of_part = match self.part {
            Part::Shapes => None,
            Part::PathBox(edges) => {
                let [x, y, z] = [edges.x, edges.y, edges.z].map(|edge| figures(edge * 1e3));
                Some(format!(
                    "no shape attached to the workpiece holds the path: {moves} the tool is kept out of the box of the path's extent, \
                     {x} x {y} x {z} mm, in place of the part"
                ))
            }
            Part::Unknown => Some(format!(
                "no shape attached to the workpiece holds the path, and its tool axes differ: {moves} the tool is not checked against the part"
            )),
        };
        of_tool.into_iter().chain(of_part).collect()
    }

    /// The first piece of the tool, and what it hits, where the tool is drawn back along its axis by a length (m) from
    /// a path point, in the frame of the task file, or goes in there again. Only what is deeper in the part than at the
    /// point counts.
    pub fn line_hit(&self, point: &PathPoint, length: f64) -> Option<Arc<[String; 2]>> {
        let at = Pose { rotation: upright(&-point.axis), translation: point.position };
        self.tool.pieces().into_iter().find_map(|(name, piece)| {
            let mut part = self.scene.attached_to(Attachment::Workpiece);
            let (hit, _) = part.find(|(_, shape)| piece.rises_into(shape, &at, length))?;
            Some(Arc::new([name, hit.name.clone()]))
        })
    }
}

impl Cylinder {
    /// Whether it is deeper in a shape, both in one frame, anywhere on a line along the tool axis than at its start,
    /// where the tool stands at a pose. Along its own axis it fills a longer cylinder.
    fn rises_into(self, shape: &Collider, at: &Pose<f64>, length: f64) -> bool {
        let touches = |piece: Self| {
            let (solid, pose) = piece.solid();
            let here = Pose::identity();
            Collider::new(&solid, &at.then(&pose)).is_some_and(|own| own.distance(&here, shape, &here, FACE) <= 0.0)
        };
        let risen = |piece: Self| Self { to: piece.to + length, ..piece };
        if self.radius <= 0.0 {
            return false;
        }
        if !touches(risen(self)) {
            return false;
        }
        // As much thinner and shorter as it is deep in the part: what of it is still outside there.
        let core = |depth: f64| Self { radius: self.radius - depth, from: self.from + depth, ..self };
        let most = self.radius.min(self.to - self.from) - FACE;
        if most <= 0.0 || touches(core(most)) {
            return false;
        }
        let (mut inside, mut outside) = (0.0, most);
        if !touches(self) {
            outside = 0.0;
        }
        for _ in 0..if outside > 0.0 { HALVINGS } else { 0 } {
            let middle = (inside + outside) / 2.0;
            if touches(core(middle)) { inside = middle } else { outside = middle }
        }
        touches(risen(core((outside + FACE).min(most))))
    }
}

/// A rotation that takes z to a direction of length 1.
fn upright(z: &Vector3<f64>) -> Matrix3<f64> {
    let other = if z.z.abs() < 0.5 { Vector3::z() } else { Vector3::x() };
    let x = other.cross(z).normalize();
    Matrix3::from_columns(&[x, z.cross(&x), *z])
}

/// What is the part, among shapes and a path in the frame of its task file, and the box that stands for it where none
/// of the shapes is.
fn part_of(shapes: &[Shape], points: &[PathPoint]) -> (Part, Option<(Solid, Pose<f64>)>) {
    let holds = |shape: &&Shape| {
        let [low, high] = shape.solid.extent();
        let beside = Vector3::repeat(BESIDE_PART);
        let (low, high, inverse) = (low - beside, high + beside, shape.pose.inverse());
        let is_inside = |point: &&PathPoint| {
            let at = inverse.point(&point.position);
            (0..3).all(|k| (low[k]..=high[k]).contains(&at[k]))
        };
        2 * points.iter().filter(is_inside).count() >= points.len()
    };
    if shapes.iter().filter(|shape| shape.attached == Attachment::Workpiece).any(|shape| holds(&shape)) {
        return (Part::Shapes, None);
    }
    let Some(axis) = points.first().map(|point| point.axis) else { return (Part::Unknown, None) };
    if points.iter().any(|point| (point.axis - axis).norm() > SAME_AXIS) {
        return (Part::Unknown, None);
    }
    let rotation = if (axis - Vector3::z()).norm() <= SAME_AXIS { Matrix3::identity() } else { upright(&axis) };
    let inside = |point: &PathPoint| rotation.tr_mul(&point.position);
    let first = inside(&points[0]);
    let bounds = |[low, high]: [Vector3<f64>; 2], at: Vector3<f64>| [low.inf(&at), high.sup(&at)];
    let [low, high] = points.iter().map(inside).fold([first, first], bounds);
    let edges = (high - low).sup(&Vector3::repeat(FACE));
    let pose = Pose { rotation, translation: rotation * ((low + high) / 2.0) };
    (Part::PathBox(high - low), Some((Solid::Box(edges), pose)))
}
