//! An arm in its surroundings: which shapes can meet, and whether they do.

mod build;
mod depth;
mod motion;
mod near;
mod poses;
mod proximity;
mod quick;
#[cfg(test)]
mod tests;

pub use build::SceneError;
pub use motion::MotionHit;
pub use near::Near;
pub use poses::{MAX_AXES, Poses};
pub use proximity::Proximity;

use crate::collider::{Collider, Separation};
use crate::cover::{Cover, lower_bound};
use crate::shape::{Attachment, Shape, TrackedPoint};
use crate::surroundings::Surroundings;
use nalgebra::Vector3;
use poses::largest_move;
use quick::Quick;
use std::ops::Range as Span;
use std::sync::Arc;
use stead_model::robot::{Pose, Robot};

/// What the distance of a pair depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum PairKind {
    /// On path point and free angle alone: spindle, holder or link 6 against part or fixture.
    ToolWorkpiece,
    /// On the placement alone: part or fixture against what stands in the cell.
    WorkpieceCell,
    /// On joints 2 to 6 alone: links and spindle among themselves.
    ArmArm,
    /// On the joints: links and spindle against what stands in the cell, and points of the arm against zones.
    ArmCell,
    /// On joints and placement: links 1 to 5 against part or fixture.
    ArmWorkpiece,
}

impl PairKind {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::ToolWorkpiece, Self::WorkpieceCell, Self::ArmArm, Self::ArmCell, Self::ArmWorkpiece];
    /// Those that depend on more than the placement.
    pub const OF_STATES: [Self; 4] = [Self::ToolWorkpiece, Self::ArmArm, Self::ArmCell, Self::ArmWorkpiece];
    /// Those that depend on the joints.
    pub const OF_JOINTS: [Self; 3] = [Self::ArmArm, Self::ArmCell, Self::ArmWorkpiece];
}

/// A shape made ready.
#[derive(Debug, Clone)]
struct Body {
    frame: usize,
    collider: Collider,
    cover: Cover,
    /// From the frame of its attachment to that of the box of its cover.
    box_from_attachment: Pose<f64>,
    /// How far its points move in the base frame for each radian of a joint, at the most. m
    reach: [f64; 6],
}

impl Body {
    /// The centre of the sphere around it, in the base frame. m
    fn centre(&self, poses: &Poses) -> Vector3<f64> {
        poses.frames[self.frame].point(&self.cover.bound.centre)
    }

    /// How far its points are apart in two states, at the most. m
    fn moved(&self, states: [&Poses; 2]) -> f64 {
        let [before, after] = states.map(|poses| &poses.frames[self.frame]);
        let turn = largest_move(&before.rotation, &after.rotation);
        (self.centre(states[1]) - self.centre(states[0])).norm() + turn * self.cover.bound.radius
    }
}

/// Two shapes that can meet, or a point of the arm and a zone.
#[derive(Debug, Clone)]
pub struct Pair {
    /// Their names.
    pub names: Arc<[String; 2]>,
    /// What their distance depends on.
    pub kind: PairKind,
    /// The distance that they have to keep. m
    pub required: f64,
    members: Members,
    /// Whether turning joints 4 and 6 by half a turn and joint 5 to the other side, which leaves the tool where it is,
    /// changes the distance: something is attached to link 4 or 5.
    pub knows_flips: bool,
    /// By how much the two can come nearer for each radian of a joint, at the most. m
    reach: [f64; 6],
}

impl Pair {
    /// Whether it is a point of the arm and a zone, which may touch.
    pub fn is_of_zone(&self) -> bool {
        matches!(self.members, Members::Zone(..))
    }
}

impl std::fmt::Display for Pair {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} and {}", self.names[0], self.names[1])
    }
}

#[derive(Debug, Clone, Copy)]
enum Members {
    /// The spheres of the first are held against the box of the second.
    Bodies(usize, usize),
    Zone(usize, TrackedPoint),
}

/// The least room that a configuration leaves between two shapes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clearance {
    /// Their distance; zero or less where they touch. m
    pub distance: f64,
    /// Number of the pair ([`Scene::pair`]).
    pub pair: usize,
}

/// An arm with the shapes on it and around it.
#[derive(Debug, Clone)]
pub struct Scene {
    surroundings: Surroundings,
    robot: Robot,
    flange_from_tool: Pose<f64>,
    bodies: Vec<Body>,
    /// Sorted by kind.
    pairs: Vec<Pair>,
    /// The numbers of the pairs of each kind.
    spans: [Span<usize>; 5],
}

impl PartialEq for Scene {
    fn eq(&self, other: &Self) -> bool {
        self.surroundings == other.surroundings
            && self.robot == other.robot
            && self.flange_from_tool == other.flange_from_tool
    }
}

/// Distances above this are not distinguished. m
pub const FAR: f64 = 1.0;

impl Scene {
    /// The shapes and zones.
    pub fn surroundings(&self) -> &Surroundings {
        &self.surroundings
    }

    /// All pairs that can meet.
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// A pair by its number; `None` where there is none.
    pub fn pair(&self, number: usize) -> Option<&Pair> {
        self.pairs.get(number)
    }

    /// The shapes that move with something, each made ready for queries in the frame of that.
    pub fn attached_to(&self, attached: Attachment) -> impl Iterator<Item = (&Shape, &Collider)> {
        let shapes = self.surroundings.shapes().iter().zip(&self.bodies);
        shapes.filter(move |(shape, _)| shape.attached == attached).map(|(shape, body)| (shape, &body.collider))
    }

    /// Links, from 1 to 5, that no shape is attached to: the arm is not checked there.
    pub fn unchecked_links(&self) -> Vec<u8> {
        let has_shape = |link: u8| self.bodies.iter().any(|body| body.frame == usize::from(link));
        (1..=5).filter(|link| !has_shape(*link)).collect()
    }

    /// The arm at its joint angles (rad), and the workpiece at a pose in the base frame (m).
    pub fn poses(&self, joints: &[f64; 6], base_from_workpiece: &Pose<f64>) -> Poses {
        Poses::new(&self.robot, joints, base_from_workpiece)
    }

    /// The first pair of some kinds that is nearer than it may be: covers first, then the shapes themselves.
    pub fn first_hit(&self, poses: &Poses, kinds: &[PairKind]) -> Option<usize> {
        let quick = Quick::new(self, poses);
        self.of_kinds(kinds)
            .find(|number| !quick.leaves(self, &self.pairs[*number], 0.0) && !self.keeps_apart(*number, poses))
    }

    /// The numbers of all pairs of some kinds.
    fn of_kinds(&self, kinds: &[PairKind]) -> impl Iterator<Item = usize> {
        kinds.iter().flat_map(|kind| self.spans[*kind as usize].clone())
    }

    /// The first such pair by the covers alone, which may refuse what the shapes allow.
    pub fn first_covered_hit(&self, poses: &Poses, kinds: &[PairKind]) -> Option<usize> {
        let is_hit = |pair: &Pair| self.bound(pair, poses, pair.required) < pair.required;
        self.of_kinds(kinds).find(|number| is_hit(&self.pairs[*number]))
    }

    /// Whether a pair is as far apart as it has to be.
    pub fn keeps_apart(&self, number: usize, poses: &Poses) -> bool {
        let pair = &self.pairs[number];
        let is_apart = |distance: f64| distance >= pair.required && !self.is_touching(number, distance);
        is_apart(self.bound(pair, poses, pair.required.max(f64::MIN_POSITIVE)))
            || is_apart(self.distance(number, poses, pair.required.max(f64::MIN_POSITIVE)))
    }

    /// Whether a distance means that two shapes touch; a point may lie on the edge of a zone.
    fn is_touching(&self, number: usize, distance: f64) -> bool {
        distance <= 0.0 && matches!(self.pairs[number].members, Members::Bodies(..))
    }

    /// A lower bound of the distance of a pair by its covers, where it is below `enough`; else a value not below that.
    /// m
    fn bound(&self, pair: &Pair, poses: &Poses, enough: f64) -> f64 {
        match pair.members {
            Members::Bodies(a, b) => {
                let (a, b) = (&self.bodies[a], &self.bodies[b]);
                lower_bound(&a.cover, &poses.frames[a.frame], &b.cover, &poses.frames[b.frame], enough)
            }
            Members::Zone(zone, point) => self.zone_distance(zone, point, poses),
        }
    }

    /// The distance of a pair, where it is below `limit`; else a value not below that. m
    pub fn distance(&self, number: usize, poses: &Poses, limit: f64) -> f64 {
        self.separation(number, poses, limit).distance
    }

    /// The same with the direction.
    fn separation(&self, number: usize, poses: &Poses, limit: f64) -> Separation {
        match self.pairs[number].members {
            Members::Bodies(a, b) => {
                let (a, b) = (&self.bodies[a], &self.bodies[b]);
                a.collider.separation(&poses.frames[a.frame], &b.collider, &poses.frames[b.frame], limit)
            }
            Members::Zone(zone, point) => Separation { distance: self.zone_distance(zone, point, poses), axis: None },
        }
    }

    fn zone_distance(&self, zone: usize, point: TrackedPoint, poses: &Poses) -> f64 {
        let point = self.tracked(point, poses);
        self.surroundings.zones()[zone].zone.distance(&poses.frames[0].inverse().point(&point))
    }

    /// Where a tracked point of the arm is, in the base frame. m
    fn tracked(&self, point: TrackedPoint, poses: &Poses) -> Vector3<f64> {
        match point {
            TrackedPoint::Tool => poses.frames[6].point(&self.flange_from_tool.translation),
            TrackedPoint::Wrist => poses.frames[4].translation,
            TrackedPoint::Elbow => poses.frames[3].translation,
        }
    }

    /// The pair of some kinds with the least room beyond what it has to keep; `None` where there is no pair nearer than
    /// [`FAR`].
    pub fn clearance(&self, poses: &Poses, kinds: &[PairKind]) -> Option<Clearance> {
        self.clearance_of(poses, self.of_kinds(kinds))
    }

    /// The same of all pairs but those of these numbers.
    pub fn clearance_without(&self, poses: &Poses, left_out: &[usize]) -> Option<Clearance> {
        self.clearance_of(poses, (0..self.pairs.len()).filter(|number| !left_out.contains(number)))
    }

    fn clearance_of(&self, poses: &Poses, numbers: impl Iterator<Item = usize>) -> Option<Clearance> {
        let room = |pair: &Pair| self.bound(pair, poses, f64::INFINITY) - pair.required;
        let mut bounds: Vec<_> = numbers.map(|number| (room(&self.pairs[number]), number)).collect();
        bounds.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut best: Option<(f64, Clearance)> = None;
        for (bound, number) in bounds {
            let known = best.map_or(FAR, |(margin, _)| margin);
            if bound >= known {
                break;
            }
            let required = self.pairs[number].required;
            let distance = self.distance(number, poses, known + required);
            if distance - required < known {
                best = Some((distance - required, Clearance { distance, pair: number }));
            }
        }
        best.map(|(_, clearance)| clearance)
    }
}
