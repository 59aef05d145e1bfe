//! How much the joints turn within the cut: what is stated of plans, and what it costs where the criterion weighs it.
//!
//! The joint travel of a plan is the sum over its steps from path point to path point, within segments, of
//! `|dq_1| + .. + |dq_6|`. With [`Criterion::joint_travel_weight`] w the objective is the mean score plus w times the
//! joint travel for every [`STRETCH`] of the path, so that neither the length of a path nor how finely it is divided
//! changes what w means.
//!
//! [`Criterion::joint_travel_weight`]: crate::criterion::Criterion::joint_travel_weight

use crate::problem::Problem;
use crate::sense::Sense;
use std::collections::VecDeque;
use stead_model::task::ToolPath;

/// Joint travel is weighed for each so long a stretch of the path. m
pub const STRETCH: f64 = 0.01;

/// Turns of a joint are looked for within so long a stretch of the path, or from one point to the next where these are
/// farther apart. m
const WINDOW: f64 = 0.025;

/// How much the joints of the arm turn within the cut; external axes are left out.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointTravel {
    /// The sum over all joints and steps. rad
    pub total: f64,
    /// The length of the cut. m
    pub length: f64,
    /// The largest step of a joint from one point to the next. rad
    pub largest_step: f64,
    /// The largest turn of a joint within 25 mm of the path, or from one point to the next where these are farther
    /// apart; none where no joint turns.
    pub swing: Option<Swing>,
}

/// A turn of a joint along a short stretch of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing {
    /// The joint, from 1.
    pub joint: usize,
    /// By how much it turns. rad
    pub angle: f64,
    /// Along how much of the path. m
    pub length: f64,
    /// From which path point to which.
    pub points: [usize; 2],
}

impl JointTravel {
    /// That of a plan, from the joint angles (rad) at all points of the path.
    pub fn of(path: &ToolPath, joints: &[[f64; 6]]) -> Self {
        let mut found = Self::default();
        for span in path.segments() {
            let Some(segment) = joints.get(span.clone()) else { continue };
            for pair in segment.windows(2) {
                found.total += joint_distance(&pair[0], &pair[1]);
                let steps = (0..6).map(|j| (pair[1][j] - pair[0][j]).abs());
                found.largest_step = steps.fold(found.largest_step, f64::max);
            }
            let lengths = span.clone().scan(0.0, |sum, point| {
                *sum += if point == span.start { 0.0 } else { path.step_length(point) };
                Some(*sum)
            });
            let lengths: Vec<f64> = lengths.collect();
            found.length += lengths.last().copied().unwrap_or(0.0);
            for joint in 0..6 {
                let angles: Vec<f64> = segment.iter().map(|joints| joints[joint]).collect();
                let Some((from, to)) = widest(&angles, &lengths) else { continue };
                let angle = (angles[to] - angles[from]).abs();
                if found.swing.is_none_or(|known| angle > known.angle) {
                    let points = [from, to].map(|place| span.start + place);
                    found.swing = Some(Swing { joint: joint + 1, angle, length: lengths[to] - lengths[from], points });
                }
            }
        }
        found
    }
}

/// Between which two places of a segment a joint turns the most, if it turns at all; `lengths` (m) are along the path
/// up to each.
fn widest(angles: &[f64], lengths: &[f64]) -> Option<(usize, usize)> {
    let mut best: Option<(usize, usize)> = None;
    // Places of the window in which a later one is larger, and smaller, than all before it: the first is the extreme of
    // the window.
    let (mut smallest, mut largest): (VecDeque<usize>, VecDeque<usize>) = Default::default();
    for to in 0..angles.len() {
        for (queue, sign) in [(&mut smallest, 1.0), (&mut largest, -1.0)] {
            while queue.front().is_some_and(|from| lengths[to] - lengths[*from] > WINDOW && from + 1 < to) {
                queue.pop_front();
            }
            if let Some(from) = queue.front() {
                let wider =
                    |(a, b): (usize, usize)| (angles[to] - angles[*from]) * sign > (angles[b] - angles[a]).abs();
                if angles[to] != angles[*from] && best.is_none_or(wider) {
                    best = Some((*from, to));
                }
            }
            // Of equal angles the last begins the shortest stretch.
            while queue.back().is_some_and(|from| angles[to] * sign <= angles[*from] * sign) {
                queue.pop_back();
            }
            queue.push_back(to);
        }
    }
    best
}

/// The joint travel from some joint angles (rad) to others. rad
pub fn joint_distance(from: &[f64; 6], to: &[f64; 6]) -> f64 {
    (0..6).map(|j| (to[j] - from[j]).abs()).sum()
}

/// The joint travel along a segment, from the joint angles (rad) at its points. rad
pub fn joint_travel(joints: &[[f64; 6]]) -> f64 {
    joints.windows(2).map(|pair| joint_distance(&pair[0], &pair[1])).sum()
}

impl Problem {
    /// What a radian of joint travel adds to the objective. m/rad
    pub fn travel_weight(&self) -> f64 {
        let weight = self.criterion.joint_travel_weight;
        if weight == 0.0 || !self.criterion.aggregate.weighs_joint_travel() { 0.0 } else { weight / self.stretches() }
    }

    /// How many stretches joint travel is weighed by: at least one.
    pub fn stretches(&self) -> f64 {
        let path = self.task.path();
        let length: f64 = (0..self.task.segments().len()).map(|segment| path.segment_length(segment)).sum();
        (length / STRETCH).max(1.0)
    }

    /// What a radian of joint travel adds to the cost of a plan ([`Self::objective`]). The worst plans are those of the
    /// largest scores alone.
    pub fn travel_cost(&self, sense: Sense) -> f64 {
        match (sense, self.travel_weight()) {
            (Sense::Max, _) | (_, 0.0) => 0.0,
            (Sense::Min, weight) => weight * self.total_weight(),
        }
    }
}

#[cfg(test)]
mod tests;
