//! From shapes to pairs: which can meet, and which touch whatever the arm does.

use super::poses::{Poses, WORKPIECE, frame, on_arm};
use super::{Body, Members, Pair, PairKind, Scene};
use crate::collider::Collider;
use crate::cover::Cover;
use crate::shape::{Attachment, Shape, TrackedPoint};
use crate::surroundings::Surroundings;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;
use stead_model::robot::{Pose, Robot};

/// Why surroundings and an arm do not make a scene.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SceneError {
    /// A shape without a triangle.
    #[error("the mesh of {0:?} has nothing that could collide")]
    Empty(String),
    /// Pairs that touch in every posture.
    #[error("{} in every posture tried: leave room between them, or list them in ignore", listed(.0))]
    AlwaysTouching(Vec<[String; 2]>),
}

fn listed(pairs: &[[String; 2]]) -> String {
    let words: Vec<String> = pairs.iter().map(|[a, b]| format!("{a:?} and {b:?}")).collect();
    format!("{} {}", words.join(", "), if words.len() == 1 { "touch" } else { "touch each other" })
}

/// Postures tried to find pairs that touch in all of them.
const POSTURES_TRIED: usize = 100;

impl Scene {
    /// Joins an arm and its spindle (the tool frame in the flange frame) with its surroundings.
    ///
    /// # Errors
    /// [`SceneError`].
    pub fn new(robot: &Robot, flange_from_tool: &Pose<f64>, surroundings: Surroundings) -> Result<Self, SceneError> {
        let mut bodies = Vec::with_capacity(surroundings.shapes().len());
        for shape in surroundings.shapes() {
            let collider = Collider::new(&shape.solid, &shape.pose);
            let collider = collider.ok_or_else(|| SceneError::Empty(shape.name.clone()))?;
            let cover = Cover::new(&shape.solid, &shape.pose);
            let box_from_attachment = cover.box_pose.inverse();
            let frame = frame(shape.attached);
            let reach = travel(robot, 0, on_arm(frame), cover.farthest());
            bodies.push(Body { frame, collider, cover, box_from_attachment, reach });
        }
        let mut pairs = Vec::new();
        for (a, first) in surroundings.shapes().iter().enumerate() {
            for (b, second) in surroundings.shapes().iter().enumerate().skip(a + 1) {
                let Some(kind) = pair_kind(first, second).filter(|_| !surroundings.is_ignored(first, second)) else {
                    continue;
                };
                // Spheres for what is on the arm, the box for what stands.
                let (a, b) = if moves_more(bodies[a].frame, bodies[b].frame) { (a, b) } else { (b, a) };
                let name = |body: usize| surroundings.shapes()[body].name.clone();
                let reach = reach(robot, bodies[a].frame, &bodies[a].cover, bodies[b].frame, &bodies[b].cover);
                pairs.push(Pair {
                    names: Arc::new([name(a), name(b)]),
                    kind,
                    required: surroundings.clearance(),
                    members: Members::Bodies(a, b),
                    knows_flips: [a, b].iter().any(|body| matches!(bodies[*body].frame, 4 | 5)),
                    reach,
                });
            }
        }
        for (number, zone) in surroundings.zones().iter().enumerate() {
            for point in &zone.points {
                let (frame, beyond) = match point {
                    TrackedPoint::Tool => (6, flange_from_tool.translation.norm()),
                    TrackedPoint::Wrist => (4, 0.0),
                    TrackedPoint::Elbow => (3, 0.0),
                };
                pairs.push(Pair {
                    names: Arc::new([point.word().to_owned(), zone.name.clone()]),
                    kind: PairKind::ArmCell,
                    required: 0.0,
                    members: Members::Zone(number, *point),
                    knows_flips: false,
                    reach: travel(robot, 0, frame, beyond),
                });
            }
        }
        // In the order in which their kinds are cheapest to decide: a stable sort.
        pairs.sort_by_key(|pair| pair.kind);
        let spans = PairKind::ALL.map(|kind| {
            pairs.partition_point(|pair: &Pair| pair.kind < kind)
                ..pairs.partition_point(|pair: &Pair| pair.kind <= kind)
        });
        let scene =
            Self { surroundings, robot: robot.clone(), flange_from_tool: *flange_from_tool, bodies, pairs, spans };
        match scene.always_touching() {
            touching if touching.is_empty() => Ok(scene),
            touching => Err(SceneError::AlwaysTouching(touching)),
        }
    }

    /// Pairs that depend on the joints alone and touch in every posture tried.
    fn always_touching(&self) -> Vec<[String; 2]> {
        self.in_every_posture(|number, poses| !self.keeps_apart(number, poses))
    }

    /// Pairs that depend on the joints alone and are nearer to each other than a distance (m) in every posture tried:
    /// parts that move along with each other, as a link and the one after next.
    pub fn always_near(&self, distance: f64) -> Vec<[String; 2]> {
        self.in_every_posture(|number, poses| self.distance(number, poses, distance) < distance)
    }

    /// The names of the pairs that depend on the joints alone of which something holds in every posture tried.
    fn in_every_posture(&self, holds: impl Fn(usize, &Poses) -> bool) -> Vec<[String; 2]> {
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let mut suspects: Vec<usize> = (0..self.pairs.len())
            .filter(|number| matches!(self.pairs[*number].kind, PairKind::ArmArm | PairKind::ArmCell))
            .filter(|number| matches!(self.pairs[*number].members, Members::Bodies(..)))
            .collect();
        for _ in 0..POSTURES_TRIED {
            let joints: [f64; 6] = std::array::from_fn(|j| {
                let joint = &self.robot.joints()[j];
                joint.min + (joint.max - joint.min) * random.random::<f64>()
            });
            let poses = Poses::new(&self.robot, &joints, &Pose::identity());
            suspects.retain(|number| holds(*number, &poses));
            if suspects.is_empty() {
                break;
            }
        }
        suspects.into_iter().map(|number| self.pairs[number].names.as_ref().clone()).collect()
    }
}

/// What the distance of two shapes depends on; `None` where nothing moves them against each other, and for neighbouring
/// links.
fn pair_kind(a: &Shape, b: &Shape) -> Option<PairKind> {
    use Attachment::{Axis, Base, Flange, Link, Workpiece};
    let (a, b) = (a.attached, b.attached);
    if frame(a) == frame(b) {
        return None;
    }
    let of = |first: Attachment, second: Attachment| match (first, second) {
        (Link(j), Link(k)) if j.abs_diff(k) <= 1 => Some(None),
        (Link(_) | Flange, Link(_) | Flange) => Some(Some(PairKind::ArmArm)),
        (Flange | Link(6), Workpiece) => Some(Some(PairKind::ToolWorkpiece)),
        (Link(_), Workpiece) => Some(Some(PairKind::ArmWorkpiece)),
        (Link(_) | Flange, Base | Axis(_)) => Some(Some(PairKind::ArmCell)),
        (Workpiece, Base | Axis(_)) | (Axis(_), Base | Axis(_)) => Some(Some(PairKind::WorkpieceCell)),
        _ => None,
    };
    of(a, b).or_else(|| of(b, a)).flatten()
}

/// Whether what is attached to the first frame moves against the base by more joints than to the second.
fn moves_more(first: usize, second: usize) -> bool {
    let rank = |frame: usize| match frame {
        1..=6 => frame + 2,
        WORKPIECE => 2,
        0 => 0,
        _ => 1,
    };
    rank(first) > rank(second)
}

/// By how much two bodies can come nearer for each radian of a joint.
fn reach(robot: &Robot, a: usize, cover_a: &Cover, b: usize, cover_b: &Cover) -> [f64; 6] {
    let (a, b, cover) =
        if on_arm(a) > on_arm(b) { (on_arm(b), on_arm(a), cover_a) } else { (on_arm(a), on_arm(b), cover_b) };
    travel(robot, a, b, cover.farthest())
}

/// How far a point of frame `to`, not farther than `beyond` (m) from its origin, moves against frame `from` for each
/// radian of the joints: not farther from an axis than all that lies between. m
fn travel(robot: &Robot, from: usize, to: usize, beyond: f64) -> [f64; 6] {
    std::array::from_fn(|j| {
        let joint = j + 1;
        if joint <= from || joint > to {
            return 0.0;
        }
        robot.rows()[joint..to].iter().map(|row| row.translation.norm()).sum::<f64>() + beyond
    })
}
