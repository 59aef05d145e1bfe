//! Joint motions: whether all pairs keep apart all along.
//!
//! No point of a body moves faster than its reach times the speeds of the joints. So two bodies keep apart on a whole interval
//! where the room that they have at both ends together is not less than what they can move towards each other in between. Where
//! that does not decide, the interval is halved. In the end nothing moves farther between two states looked at than the
//! resolution, and both states keep the distance asked for.

use super::{Pair, Poses, Scene};
use stead_model::robot::Pose;

/// Where a motion brings two shapes nearer than they may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionHit {
    /// The share of the motion.
    pub share: f64,
    /// Number of the pair.
    pub pair: usize,
}

/// The resolution where no clearance is asked for, and at the finest. m
const FINEST: f64 = 5e-4;

impl Scene {
    /// The first state found at which a straight motion of the joints (rad) brings a pair nearer than it may be, the workpiece moving
    /// evenly from one pose to another; `None` where all pairs keep apart all along.
    pub fn motion(&self, from: (&[f64; 6], &Pose<f64>), to: (&[f64; 6], &Pose<f64>)) -> Option<MotionHit> {
        let steps: [f64; 6] = std::array::from_fn(|j| (to.0[j] - from.0[j]).abs());
        let ends = [from, to].map(|(joints, workpiece)| Poses::new(&self.robot, joints, workpiece));
        let mut open = Vec::new();
        for (number, pair) in self.pairs.iter().enumerate() {
            let travel = pair.travel(&steps);
            let rooms = [0, 1].map(|end| self.room(number, &ends[end], travel));
            for (share, room) in [(0.0, rooms[0]), (1.0, rooms[1])] {
                if room < 0.0 {
                    return Some(MotionHit { share, pair: number });
                }
            }
            if rooms[0] + rooms[1] < travel {
                open.push((number, rooms));
            }
        }
        if open.is_empty() {
            return None;
        }
        self.halved((from.0, to.0, from.1), &steps, (0.0, 1.0), &open)
    }

    /// The same between two shares of a motion, for pairs that are open there, with their room at both.
    fn halved(
        &self,
        motion: (&[f64; 6], &[f64; 6], &Pose<f64>),
        steps: &[f64; 6],
        (start, end): (f64, f64),
        open: &[(usize, [f64; 2])],
    ) -> Option<MotionHit> {
        let (from, to, workpiece) = motion;
        let middle = (start + end) / 2.0;
        let joints: [f64; 6] = std::array::from_fn(|j| from[j] + (to[j] - from[j]) * middle);
        let poses = Poses::new(&self.robot, &joints, workpiece);
        let mut halves = [Vec::new(), Vec::new()];
        for (number, rooms) in open {
            let pair = &self.pairs[*number];
            let travel = pair.travel(steps) * (end - start) / 2.0;
            let room = self.room(*number, &poses, travel);
            if room < 0.0 {
                return Some(MotionHit { share: middle, pair: *number });
            }
            if travel <= pair.required.max(FINEST) {
                continue;
            }
            for (half, ends) in halves.iter_mut().zip([[rooms[0], room], [room, rooms[1]]]) {
                if ends[0] + ends[1] < travel {
                    half.push((*number, ends));
                }
            }
        }
        for (half, interval) in halves.iter().zip([(start, middle), (middle, end)]) {
            if !half.is_empty() {
                let hit = self.halved(motion, steps, interval, half);
                if hit.is_some() {
                    return hit;
                }
            }
        }
        None
    }

    /// The room of a pair beyond the distance that it has to keep, where it is below `enough`; else a value not below that. Where
    /// shapes touch it is less than nothing. m
    fn room(&self, number: usize, poses: &Poses, enough: f64) -> f64 {
        let pair = &self.pairs[number];
        let wanted = (enough + pair.required).max(f64::MIN_POSITIVE);
        let bound = self.bound(pair, poses, wanted);
        let distance = if bound >= wanted { bound } else { self.distance(number, poses, wanted) };
        if self.is_touching(number, distance) {
            (distance - pair.required).min(-f64::MIN_POSITIVE)
        } else {
            distance - pair.required
        }
    }
}

impl Pair {
    /// How far the two can move towards each other while the joints turn by these steps (rad). m
    fn travel(&self, steps: &[f64; 6]) -> f64 {
        self.reach.iter().zip(steps).map(|(reach, step)| reach * step).sum()
    }
}
