//! The feed that the arm holds along a plan: with which no joint is faster, or accelerated more, than the robot file
//! allows.
//!
//! From path point to path point the tool moves as in a linear move of a robot controller: the tool centre point along
//! the straight line, the tool about one fixed axis, both in proportion to the way s, in the frame of the part;
//! external axes move evenly. So the joint angles are functions q(s) of the way, and at a constant feed v
//!
//! ```text
//! speed q'(s) v        acceleration q''(s) v^2
//! ```
//!
//! The highest feed of a segment is the smallest of `limit / |q'|` and `sqrt(limit / |q''|)` over its length and all
//! joints whose limit is known.
//!
//! q' is exact at both ends of each step from point to point and between them, at poses so close that no joint turns by
//! more than 2 deg from one to the next and speeds are much the same, and interpolated by a parabola from pose to pose:
//! so a joint is found that is fast only near a singularity between two points.
//!
//! q' jumps where the straight lines meet, and with it beta, whose plan is piecewise linear. A controller blends there,
//! so accelerations are those of the path blended over a distance w: the mean of q'' within w of s, weighted by a
//! triangle,
//!
//! ```text
//! q''(s) = (q(s + w) - 2 q(s) + q(s - w)) / w^2
//! ```
//!
//! (as a divided difference, where the poses at hand are a little farther apart than w). Within w of the ends of a
//! segment, where the feed starts and stops, accelerations are not evaluated.

mod external_axes;
mod linear_motion;

use crate::redundancy::SegmentPlan;
use external_axes::{axis_limit, smallest};
use linear_motion::{LinearMotion, Node, rates_between};
use rayon::prelude::*;
use serde::Serialize;
use std::fmt;
use stead_model::robot::Joint;
use stead_problem::problem::Problem;

/// Poses of the blended path on each blending distance.
const POSES_PER_BLEND: f64 = 4.0;
/// Steps that one thread evaluates at least.
const MIN_SHARE: usize = 250;
/// A programmed feed that is higher by this share is held: rounding.
const FEED_ROUNDING: f64 = 1e-6;

/// What a joint has too little of for a higher feed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FeedLimitKind {
    /// Speed.
    Speed,
    /// Acceleration.
    Acceleration,
}

impl fmt::Display for FeedLimitKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Speed => "speed",
            Self::Acceleration => "acceleration",
        })
    }
}

/// The highest feed of a stretch of the path, and what decides it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeedLimit {
    /// The highest feed. m/s
    pub feed: f64,
    /// Whether a speed or an acceleration decides.
    pub kind: FeedLimitKind,
    /// The joint that decides, from 1; from 7 on the external axes.
    pub joint: usize,
    /// Number of the segment, from 1.
    pub segment: usize,
    /// Index of the path point that is nearest to where it decides, from 0.
    pub point: usize,
}

impl FeedLimit {
    fn smaller(self, other: Self) -> Self {
        if other.feed < self.feed { other } else { self }
    }
}

/// The feed of a cut: as programmed, and as the arm holds it.
#[derive(Debug, Clone, PartialEq)]
pub struct CutFeed {
    /// The programmed feed; where the task states feeds, the highest of them. m/s
    pub programmed: f64,
    /// The highest programmed feed of each segment. m/s
    pub programmed_segments: Vec<f64>,
    /// The highest feed of each segment; `None` where no limit of a joint is known or none of these joints moves.
    pub segments: Vec<Option<FeedLimit>>,
    /// The names of the external axes, which a limit has by their numbers.
    pub external_axes: Vec<String>,
}

impl CutFeed {
    /// The highest feed of the whole path: that of the segment with the lowest.
    pub fn highest(&self) -> Option<FeedLimit> {
        self.segments.iter().flatten().copied().reduce(FeedLimit::smaller)
    }

    /// The name of the external axis that decides a limit, where that is no joint of the arm.
    pub fn external_axis(&self, limit: &FeedLimit) -> Option<&str> {
        self.external_axes.get(limit.joint.checked_sub(7)?).map(String::as_str)
    }

    /// What decides a limit, without the feed.
    pub fn decided_by(&self, limit: &FeedLimit) -> String {
        let FeedLimit { kind, joint, segment, point, .. } = limit;
        let what = self
            .external_axis(limit)
            .map_or_else(|| format!("joint {joint}"), |axis| format!("external axis {axis:?}"));
        format!("{kind} of {what} at point {point}, segment {segment}")
    }

    /// The highest feed with which a segment (from 0) is cut: the highest programmed one, or the highest that the arm
    /// holds where that is lower. m/s
    pub fn held(&self, segment: usize) -> f64 {
        let limit = self.segments.get(segment).copied().flatten();
        limit.filter(|limit| self.is_beyond(limit)).map_or_else(|| self.programmed_for(segment), |limit| limit.feed)
    }

    /// The feed at a point of a segment (from 0) over the feed that the point is programmed with (m/s): 1 where that is
    /// held.
    pub fn share(&self, segment: usize, programmed: f64) -> f64 {
        let limit = self.segments.get(segment).copied().flatten();
        limit.filter(|limit| self.is_beyond(limit)).map_or(1.0, |limit| (limit.feed / programmed).min(1.0))
    }

    /// Number of segments that cannot be cut with the programmed feed.
    pub fn slowed(&self) -> usize {
        self.segments.iter().flatten().filter(|limit| self.is_beyond(limit)).count()
    }

    fn programmed_for(&self, segment: usize) -> f64 {
        self.programmed_segments.get(segment).copied().unwrap_or(self.programmed)
    }

    fn is_beyond(&self, limit: &FeedLimit) -> bool {
        limit.feed < self.programmed_for(limit.segment - 1) * (1.0 - FEED_ROUNDING)
    }
}

/// The feed that each segment of a plan holds; accelerations are those of the path blended over the distance `blend`
/// (m).
pub fn cut_feed(problem: &Problem, blend: f64, plans: &[SegmentPlan]) -> CutFeed {
    let of = |limit: fn(&Joint) -> Option<f64>| problem.robot.joints().each_ref().map(limit);
    let limits =
        Limits { speeds: of(|joint| joint.max_speed), accelerations: of(|joint| joint.max_acceleration), blend };
    let segment = |(index, plan): (usize, &SegmentPlan)| {
        let axes = axis_limit(problem, index + 1, plan);
        limits.segment(problem, index + 1, plan).into_iter().chain(axes).reduce(FeedLimit::smaller)
    };
    let programmed_segments: Vec<f64> = (0..plans.len()).map(|segment| problem.programmed_feed(segment)).collect();
    CutFeed {
        programmed: programmed_segments.iter().copied().reduce(f64::max).unwrap_or(problem.redundancy.feed),
        programmed_segments,
        segments: plans.par_iter().enumerate().map(segment).collect(),
        external_axes: problem.external_axes.iter().map(|axis| axis.name.clone()).collect(),
    }
}

/// The limits of the joints where they are known, rad/s and rad/s^2, and the blending distance, m.
struct Limits {
    speeds: [Option<f64>; 6],
    accelerations: [Option<f64>; 6],
    blend: f64,
}

/// The joint angles at a place of a segment.
#[derive(Clone, Copy)]
struct Sample {
    /// Way from the start of the segment. m
    way: f64,
    /// The nearest path point.
    point: usize,
    /// What the motors turn. rad
    joints: [f64; 6],
}

/// What one step from path point to path point holds, and its poses without the first.
struct Step {
    limit: Option<FeedLimit>,
    length: f64,
    /// Whether the tool turns in place, to which no feed belongs.
    is_in_place: bool,
    /// Its first pose.
    start: Sample,
    /// Ways are from the start of the step.
    samples: Vec<Sample>,
}

impl Limits {
    fn segment(&self, problem: &Problem, segment: usize, plan: &SegmentPlan) -> Option<FeedLimit> {
        if self.speeds.iter().chain(&self.accelerations).all(Option::is_none) {
            return None;
        }
        let steps = (1..plan.joints.len()).into_par_iter().with_min_len(MIN_SHARE);
        let steps: Vec<Step> = steps.map(|place| self.step(problem, segment, plan, place)).collect();
        let by_speed = steps.iter().filter_map(|step| step.limit).reduce(FeedLimit::smaller);
        let by_acceleration = self.has_accelerations().then(|| {
            // Between two turns of the tool in place the feed starts and stops.
            let stretches = steps.split(|step| step.is_in_place).filter(|stretch| !stretch.is_empty());
            let held = stretches.filter_map(|stretch| {
                let mut samples = vec![stretch[0].start];
                let mut start = 0.0;
                for step in stretch {
                    samples.extend(step.samples.iter().map(|sample| Sample { way: start + sample.way, ..*sample }));
                    start += step.length;
                }
                self.by_acceleration(segment, &samples)
            });
            held.reduce(FeedLimit::smaller)
        });
        by_speed.into_iter().chain(by_acceleration.flatten()).reduce(FeedLimit::smaller)
    }

    fn has_accelerations(&self) -> bool {
        self.accelerations.iter().any(Option::is_some)
    }

    /// The step to a place (from 1) of a segment's plan.
    fn step(&self, problem: &Problem, segment: usize, plan: &SegmentPlan, place: usize) -> Step {
        let ends = [&plan.joints[place - 1], &plan.joints[place]];
        let point = plan.points.start + place;
        let weights = self.speeds.map(|speed| speed.map_or(0.0, f64::recip));
        let motion = LinearMotion::new(problem, point, plan.posture, weights, ends);
        // Feeds are those of what the tool touches: where it leans otherwise at both ends the tip goes another way.
        let tip_length = motion.length();
        let length = tip_length / problem.task.path().tip_share(point);
        let spacing = if self.has_accelerations() { self.blend / POSES_PER_BLEND } else { f64::INFINITY };
        let mut nodes = motion.nodes(ends, spacing / tip_length);
        // Limits are those of what the motors turn, which is linear in the joint angles.
        for node in &mut nodes {
            node.joints = problem.robot.drives(&node.joints);
            node.rates = node.rates.map(|rates| problem.robot.drives(&rates));
        }
        let is_in_place = problem.task.path().turns_in_place(point);
        let nearest = |part: f64| if part < 0.5 { point - 1 } else { point };
        let at_nodes = nodes.iter().filter_map(|node| Some((node.part, node.rates?)));
        let between = nodes.windows(2).map(|pair| (f64::midpoint(pair[0].part, pair[1].part), rates_between(pair)));
        let limit = at_nodes.chain(between).filter_map(|(part, rates): (f64, [f64; 6])| {
            let feeds = (0..6).filter_map(|j| Some((self.speeds[j]? * length / rates[j].abs(), j + 1)));
            let (feed, joint) = smallest(feeds).filter(|_| !is_in_place)?;
            Some(FeedLimit { feed, kind: FeedLimitKind::Speed, joint, segment, point: nearest(part) })
        });
        let limit = limit.reduce(FeedLimit::smaller);
        let samples = if self.has_accelerations() { &nodes[1..] } else { &[] };
        let sample = |node: &Node| Sample { way: node.part * length, point: nearest(node.part), joints: node.joints };
        let start = Sample { way: 0.0, point: point - 1, joints: problem.robot.drives(ends[0]) };
        Step { limit, length, is_in_place, start, samples: samples.iter().map(sample).collect() }
    }

    /// The highest feed of a segment by the accelerations of its joints.
    fn by_acceleration(&self, segment: usize, samples: &[Sample]) -> Option<FeedLimit> {
        let reach = self.blend * (1.0 - 1e-9);
        let (mut before, mut after) = (0, 0);
        let mut limit: Option<FeedLimit> = None;
        for (index, here) in samples.iter().enumerate() {
            while samples.get(after).is_some_and(|sample| sample.way - here.way < reach) {
                after += 1;
            }
            let Some(next) = samples.get(after) else { break };
            while before < index && here.way - samples[before + 1].way >= reach {
                before += 1;
            }
            let last = &samples[before];
            if here.way - last.way < reach {
                continue;
            }
            let feeds = (0..6).filter_map(|j| {
                let slope = |a: &Sample, b: &Sample| (b.joints[j] - a.joints[j]) / (b.way - a.way);
                let curvature = 2.0 * (slope(here, next) - slope(last, here)) / (next.way - last.way);
                Some((libm::sqrt(self.accelerations[j]? / curvature.abs()), j + 1))
            });
            let Some((feed, joint)) = smallest(feeds) else { continue };
            let found = FeedLimit { feed, kind: FeedLimitKind::Acceleration, joint, segment, point: here.point };
            limit = Some(limit.map_or(found, |known| known.smaller(found)));
        }
        limit
    }
}

#[cfg(test)]
mod tests;
