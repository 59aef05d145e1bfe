//! Joint motions: whether all pairs keep apart all along.
//!
//! Two bodies keep apart on a whole interval where the room that they have at both ends together is not less than what
//! they can move towards each other in between. That has two bounds: no point of a body moves faster than its reach
//! times the speeds of the joints; and none is farther from the straight line between its places at both ends than its
//! acceleration takes it, an eighth of the most that it can be, so that short motions count hardly more than what they
//! lead to. Where neither decides, the interval is halved. In the end nothing moves farther between two states looked
//! at than the resolution, and both states keep nine tenths of the distance requested.

use super::poses::{FRAMES, Poses, on_arm};
use super::quick::Quick;
use super::{Body, Members, Scene};
use nalgebra::Vector3;
use stead_model::robot::Pose;
use stead_numerics::rotation::{rotation_from_vector, rotation_vector};

/// Where a motion brings two shapes nearer than they may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionHit {
    /// The share of the motion.
    pub share: f64,
    /// Number of the pair.
    pub pair: usize,
}

/// The share of the clearance that has to be left between the ends of a motion: where both ends have just what is
/// requested, a straight motion between them comes a little nearer.
const BETWEEN: f64 = 0.9;

/// The resolution where no clearance is requested, and at the finest. m
const FINEST: f64 = 5e-4;

/// What a frame that is not on the arm does in a motion: it turns evenly about an axis and moves evenly along it.
#[derive(Debug, Clone, Copy, Default)]
struct Screw {
    /// Direction of the axis times the angle. rad
    turn: Vector3<f64>,
    /// A point on the axis, in the base frame. m
    centre: Vector3<f64>,
    /// How far it moves along the axis, or without a turn, in all. m
    along: Vector3<f64>,
    /// How far the origin of the frame is from the axis. m
    offset: f64,
}

/// A smaller angle is no turn. rad
const SMALLEST_TURN: f64 = 1e-9;

impl Screw {
    /// From one pose to another.
    fn between(from: &Pose<f64>, to: &Pose<f64>) -> Self {
        let rotation = to.rotation * from.rotation.transpose();
        let turn = rotation_vector(&rotation);
        let angle = turn.norm();
        if angle < SMALLEST_TURN {
            return Self { along: to.translation - from.translation, centre: from.translation, ..Self::default() };
        }
        let axis = turn / angle;
        let moved = to.translation - rotation * from.translation;
        let along = axis * axis.dot(&moved);
        let (sine, cosine) = libm::sincos(angle / 2.0);
        let across = moved - along;
        let centre = (across + axis.cross(&across) * (cosine / sine)) / 2.0;
        Self { turn, centre, along, offset: (from.translation - centre).cross(&axis).norm() }
    }

    /// Where it has brought a frame at a share of it.
    fn at(&self, from: &Pose<f64>, share: f64) -> Pose<f64> {
        let rotation = rotation_from_vector(&(self.turn * share));
        let translation = rotation * (from.translation - self.centre) + self.centre + self.along * share;
        Pose { rotation: rotation * from.rotation, translation }
    }

    /// How far it moves a point that is not farther than this from the origin of the frame, at the most. m
    fn travel(&self, farthest: f64) -> f64 {
        let angle = self.turn.norm();
        self.along.norm() + if angle > 0.0 { angle * (self.offset + farthest) } else { 0.0 }
    }

    /// How much it accelerates such a point, per square of its duration. m
    fn bend(&self, farthest: f64) -> f64 {
        self.turn.norm_squared() * (self.offset + farthest)
    }
}

/// A pair for which it is not decided whether it keeps apart on an interval.
#[derive(Debug, Clone, Copy)]
struct OpenPair {
    number: usize,
    /// What the two can move towards each other on the whole motion, by the speeds of the joints. m
    by_joints: f64,
    /// See [`Scene::bend`]. m
    bend: f64,
    /// Their room at both ends of the interval. m
    rooms: [f64; 2],
}

/// A motion: straight in the joints, all else turning and moving evenly about and along an axis from one pose to
/// another.
struct Motion<'a> {
    from: (&'a [f64; 6], &'a Poses),
    to: (&'a [f64; 6], &'a Poses),
    /// Steps of the joints. rad
    steps: [f64; 6],
    /// What frames do that are not on the arm and do not stand.
    screws: [Option<Screw>; FRAMES],
}

impl<'a> Motion<'a> {
    fn new(from: (&'a [f64; 6], &'a Poses), to: (&'a [f64; 6], &'a Poses)) -> Self {
        let steps = std::array::from_fn(|j| (to.0[j] - from.0[j]).abs());
        let screws = std::array::from_fn(|frame| {
            let [a, b] = [from.1, to.1].map(|poses| &poses.frames[frame]);
            let stands = on_arm(frame) > 0 || a == b;
            (!stands).then(|| Screw::between(a, b))
        });
        Self { from, to, steps, screws }
    }

    /// Where all stands at a share of the motion.
    fn at(&self, scene: &Scene, share: f64) -> Poses {
        let joints: [f64; 6] = std::array::from_fn(|j| self.from.0[j] + (self.to.0[j] - self.from.0[j]) * share);
        let mut poses = *self.from.1;
        poses.frames[1..=6].copy_from_slice(&scene.robot.link_frames(&joints));
        for (frame, screw) in self.screws.iter().enumerate() {
            if let Some(screw) = screw {
                poses.frames[frame] = screw.at(&self.from.1.frames[frame], share);
            }
        }
        poses
    }
}

impl Scene {
    /// The first state found at which a motion, straight in the joints (rad), brings a pair nearer than nine tenths of
    /// what it has to keep; `None` where all pairs keep apart all along. Each end has its joint angles and where all
    /// stands there. Pairs that do not move against each other are not looked at.
    pub fn motion(&self, from: (&[f64; 6], &Poses), to: (&[f64; 6], &Poses)) -> Option<MotionHit> {
        let quick = Quick::new(self, from.1);
        self.motion_unless(|number, travel| quick.leaves(self, &self.pairs[number], travel), from, to)
    }

    /// The same but for pairs that are known to have more room than the two can move towards each other (m).
    pub(super) fn motion_unless(
        &self,
        has_room: impl Fn(usize, f64) -> bool,
        from: (&[f64; 6], &Poses),
        to: (&[f64; 6], &Poses),
    ) -> Option<MotionHit> {
        let motion = Motion::new(from, to);
        let mut open = Vec::new();
        for number in 0..self.pairs.len() {
            let by_joints = self.travel(number, &motion);
            if by_joints == 0.0 || has_room(number, by_joints) {
                continue;
            }
            let pair = OpenPair { number, by_joints, bend: self.bend(number, &motion), rooms: [0.0; 2] };
            let travel = self.approach(&pair, [from.1, to.1], 1.0);
            if has_room(number, travel) {
                continue;
            }
            let rooms = [from.1, to.1].map(|poses| self.room(number, poses, travel));
            if let Some(end) = rooms.iter().position(|room| *room < 0.0) {
                return Some(MotionHit { share: end as f64, pair: number });
            }
            if rooms[0] + rooms[1] < travel {
                open.push(OpenPair { rooms, ..pair });
            }
        }
        if open.is_empty() { None } else { self.halved(&motion, (0.0, 1.0), [from.1, to.1], &open) }
    }

    /// The same between two shares of a motion, where all stands at poses, for pairs that are open there.
    fn halved(
        &self,
        motion: &Motion<'_>,
        (start, end): (f64, f64),
        ends: [&Poses; 2],
        open: &[OpenPair],
    ) -> Option<MotionHit> {
        let middle = (start + end) / 2.0;
        let poses = motion.at(self, middle);
        let mut halves = [Vec::new(), Vec::new()];
        let sides = [[ends[0], &poses], [&poses, ends[1]]];
        for pair in open {
            let travels = sides.map(|side| self.approach(pair, side, (end - start) / 2.0));
            let room = self.room(pair.number, &poses, travels[0].max(travels[1]));
            if room < 0.0 {
                return Some(MotionHit { share: middle, pair: pair.number });
            }
            let rooms = [[pair.rooms[0], room], [room, pair.rooms[1]]];
            for ((half, travel), rooms) in halves.iter_mut().zip(travels).zip(rooms) {
                if travel > self.wanted_between(pair.number).max(FINEST) && rooms[0] + rooms[1] < travel {
                    half.push(OpenPair { rooms, ..*pair });
                }
            }
        }
        for ((half, interval), side) in halves.iter().zip([(start, middle), (middle, end)]).zip(sides) {
            if !half.is_empty() {
                let hit = self.halved(motion, interval, side, half);
                if hit.is_some() {
                    return hit;
                }
            }
        }
        None
    }

    /// How far the two of a pair can move towards each other between two states of a motion that are a share of it
    /// apart. m
    fn approach(&self, pair: &OpenPair, ends: [&Poses; 2], share: f64) -> f64 {
        let by_joints = pair.by_joints * share;
        let Members::Bodies(a, b) = self.pairs[pair.number].members else { return by_joints };
        let moved = [a, b].iter().map(|body| self.bodies[*body].moved(ends)).sum::<f64>();
        by_joints.min(moved + pair.bend * share * share / 4.0)
    }

    /// The most that the points of a pair are accelerated against each other, per square of the motion's duration;
    /// nothing for zones, whose travel is bounded by the joints alone. m
    fn bend(&self, number: usize, motion: &Motion<'_>) -> f64 {
        let Members::Bodies(a, b) = self.pairs[number].members else { return 0.0 };
        let of = |body: usize| {
            let Body { frame, reach, cover, .. } = &self.bodies[body];
            let mut inner = 0.0;
            let mut bend = 0.0;
            for (reach, step) in reach.iter().zip(motion.steps) {
                bend += reach * step * (step + 2.0 * inner);
                inner += step;
            }
            bend + motion.screws[*frame].map_or(0.0, |screw| screw.bend(cover.farthest()))
        };
        of(a) + of(b)
    }

    /// The distance that a pair has to keep between the ends of a motion. m
    fn wanted_between(&self, number: usize) -> f64 {
        self.pairs[number].required * BETWEEN
    }

    /// The room of a pair beyond the distance that it has to keep between the ends of a motion, where it is below
    /// `enough`; else a value not below that. Where shapes touch it is less than nothing. m
    fn room(&self, number: usize, poses: &Poses, enough: f64) -> f64 {
        let (pair, wanted) = (&self.pairs[number], self.wanted_between(number));
        let limit = (enough + wanted).max(f64::MIN_POSITIVE);
        let bound = self.bound(pair, poses, limit);
        let distance = if bound >= limit { bound } else { self.distance(number, poses, limit) };
        let room = distance - wanted;
        if self.is_touching(number, distance) { room.min(-f64::MIN_POSITIVE) } else { room }
    }

    /// How far the two of a pair can move towards each other in a motion. m
    fn travel(&self, number: usize, motion: &Motion<'_>) -> f64 {
        let pair = &self.pairs[number];
        let by_joints: f64 = pair.reach.iter().zip(motion.steps).map(|(reach, step)| reach * step).sum();
        let screw = |frame: usize| motion.screws[frame].as_ref();
        let of_body = |body: &Body| screw(body.frame).map_or(0.0, |screw| screw.travel(body.cover.farthest()));
        by_joints
            + match pair.members {
                Members::Bodies(a, b) => of_body(&self.bodies[a]) + of_body(&self.bodies[b]),
                // A zone turns with the cell about the origin of the base frame: no point of the arm is farther from
                // that.
                Members::Zone(..) => screw(0).map_or(0.0, |screw| {
                    let rows: f64 = self.robot.mounted_rows().iter().map(|row| row.translation.norm()).sum();
                    screw.travel(rows + self.flange_from_tool.translation.norm())
                }),
            }
    }
}
