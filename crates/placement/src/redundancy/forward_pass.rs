//! The dynamic programming of [`super::transition`] along a segment.
//!
//! Point by point: the batch evaluator fills a fresh set of states, and each state takes its cheapest predecessor. Only the last two
//! points are kept, and for each state the way it came: of a long segment only for a block of points, since the joint_paths of
//! the others can be found again from the costs at the start of their block. So memory grows with the square root of the
//! number of points, and time with their number.

use super::super::evaluate::batch::{BatchEvaluator, StateGrid};
use super::rate_limit::SavedChange;
use super::transition::{JointStep, Step, advance, begin};
use super::{Planner, Sense, Workspace};
use crate::problem::{MAX_JOINT_STEP, Placement};
use std::ops::Range as Span;
use stead_model::robot::{Posture, PostureClass};

/// What one pass over a segment found.
#[derive(Debug, Clone)]
pub(super) struct ForwardPass {
    /// For each class the smallest sum of signed scores and the beta number at the end.
    pub ends: [Option<(f64, usize)>; 4],
    /// For each class the first point that it cannot get to.
    pub stuck: [Option<usize>; 4],
    /// Points without an allowed state in any class asked for, ascending.
    pub blocked: Vec<usize>,
}

impl ForwardPass {
    /// The first point that the class that gets farthest cannot get to: the last one, where a class gets through but for
    /// the turns of its joints.
    pub fn farthest(&self, span: &Span<usize>) -> usize {
        let last = span.end - 1;
        if self.ends.iter().any(Option::is_some) {
            last
        } else {
            self.stuck.iter().flatten().copied().max().unwrap_or(last)
        }
    }
}

/// The joint_paths by which states were reached, and the costs from which they can be found again.
#[derive(Debug, Clone)]
pub(super) struct Record {
    count: usize,
    /// Number of steps whose joint_paths are kept.
    block: usize,
    /// For each step of a block and each class the shifts to the predecessors, over beta.
    joint_paths: Vec<i16>,
    /// For the first point of each block and each class the costs over beta; nothing of segments of one block.
    costs: Vec<f64>,
}

/// Segments whose joint_paths take no more numbers than this are kept whole.
const MAX_WAYS: usize = 1 << 25;

impl Record {
    /// Room for segments of up to `longest` points with `count` values of beta.
    pub fn new(longest: usize, count: usize) -> Self {
        Self::with_capacity_of(longest, count, MAX_WAYS)
    }

    /// The same with at most so many numbers kept, if a block may be that short.
    pub fn with_capacity_of(longest: usize, count: usize, max_numbers: usize) -> Self {
        let block = (max_numbers / (4 * count)).max(longest.isqrt()).max(1).min(longest.max(1));
        Self { count, block, joint_paths: vec![0; block * 4 * count], costs: Vec::new() }
    }

    /// The row for the way to the point at `place` of its segment.
    fn way(&mut self, place: usize, class: PostureClass) -> &mut [i16] {
        let row = place.wrapping_sub(1) % self.block;
        &mut self.joint_paths[(row * 4 + class.index()) * self.count..][..self.count]
    }

    /// Whether a block begins at this place of a segment of `length` points.
    fn begins(&self, place: usize, length: usize) -> bool {
        length > self.block + 1 && place.is_multiple_of(self.block)
    }

    /// Keeps the costs at the beginning of a block.
    fn keep(&mut self, states: &StateGrid) {
        for class in PostureClass::ALL {
            if states.is_alive(class) {
                self.costs.extend_from_slice(states.inner_scores(class));
            } else {
                self.costs.resize(self.costs.len() + self.count, f64::INFINITY);
            }
        }
    }

    /// The costs at the beginning of a block.
    fn kept(&self, block: usize, class: PostureClass) -> &[f64] {
        &self.costs[(block * 4 + class.index()) * self.count..][..self.count]
    }
}

/// What is planned in a pass: for the workpiece at `placement`, one segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pass<'p> {
    pub evaluator: &'p BatchEvaluator<'p>,
    pub span: &'p Span<usize>,
    pub placement: &'p Placement,
    pub sense: Sense,
    /// Whether steps of beta are saved up between points too close for one.
    pub is_accumulated: bool,
}

impl Planner<'_> {
    /// What bounds the step to path point `point` from the one before.
    pub fn step(&self, point: usize, sense: Sense) -> Step {
        self.accumulated_step(point, sense, false)
    }

    fn accumulated_step(&self, point: usize, sense: Sense, is_accumulated: bool) -> Step {
        let SavedChange { change, points, is_moving } = match is_accumulated {
            true => self.rate_limit.saved(point),
            false => SavedChange { change: self.rate_limit.direct(point), points: 1, is_moving: false },
        };
        let mut limits = self.steps[point];
        for other in point + 1 - points..point {
            limits.iter_mut().zip(self.steps[other]).for_each(|(sum, limit)| *sum = MAX_JOINT_STEP.min(*sum + limit));
        }
        if is_moving {
            // Joint steps are checked when the changes are spread; here states are beside those of the plan.
            let rounding = 2.0 * self.grid.beta_step();
            limits.iter_mut().for_each(|limit| *limit = MAX_JOINT_STEP.min(*limit + rounding));
        }
        Step {
            change,
            joints: std::array::from_fn(|j| JointStep::new(limits[j], self.ranges[j])),
            sense,
            aggregate: self.problem.criterion.aggregate,
            instructions: self.instructions,
        }
    }

    /// Passes over the points of a segment with one of the evaluators, in every posture class or in that of one posture. With
    /// `count_only`, only the blocked points are found.
    pub(super) fn forward_pass(
        &self,
        pass: Pass<'_>,
        only: Option<Posture>,
        workspace: &mut Workspace,
        count_only: bool,
    ) -> ForwardPass {
        let mut forward_pass = ForwardPass { ends: [None; 4], stuck: [None; 4], blocked: Vec::new() };
        let rules = &self.problem.postures;
        let asked = PostureClass::ALL
            .map(|class| only.is_none_or(|posture| posture.class() == class) && rules.allows_class(class));
        let Workspace { before, now, record } = workspace;
        record.costs.clear();
        for (place, point) in pass.span.clone().enumerate() {
            pass.evaluator.evaluate_classes(point, pass.placement, asked, now);
            if PostureClass::ALL.iter().all(|class| !now.is_alive(*class)) {
                forward_pass.blocked.push(point);
            }
            if count_only {
                continue;
            }
            let step = self.accumulated_step(point, pass.sense, pass.is_accumulated);
            for class in PostureClass::ALL {
                if now.is_alive(class) {
                    if place == 0 {
                        begin(now, class, step.sense.sign());
                    } else if !before.is_alive(class) || !advance(before, now, class, &step, record.way(place, class)) {
                        now.clear(class);
                    }
                }
                if now.is_alive(class) {
                    now.wrap_around(class);
                } else if forward_pass.stuck[class.index()].is_none() {
                    forward_pass.stuck[class.index()] = Some(point);
                }
            }
            if record.begins(place, pass.span.len()) {
                record.keep(now);
            }
            std::mem::swap(before, now);
        }
        if !count_only {
            for class in PostureClass::ALL.into_iter().filter(|class| before.is_alive(*class)) {
                let costs = before.inner_scores(class);
                let end = (0..costs.len()).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).unwrap_or(0);
                forward_pass.ends[class.index()] = Some((costs[end], end));
            }
        }
        forward_pass
    }

    /// The beta numbers of the plan that a class ended with, along the segment last swept, in a pass like that.
    pub(super) fn trace(
        &self,
        pass: Pass<'_>,
        class: PostureClass,
        forward_pass: &ForwardPass,
        workspace: &mut Workspace,
    ) -> Vec<usize> {
        let count = self.grid.beta_count as isize;
        let mut beta = forward_pass.ends[class.index()].map_or(0, |(_, end)| end);
        let mut betas = vec![beta; pass.span.len()];
        let is_whole = workspace.record.costs.is_empty();
        for place in (1..pass.span.len()).rev() {
            let block = workspace.record.block;
            if !is_whole && (place == pass.span.len() - 1 || place.is_multiple_of(block)) {
                self.repeat_block(pass, class, (place - 1) / block, workspace);
            }
            let shift = workspace.record.way(place, class)[beta];
            beta = (beta as isize + isize::from(shift)).rem_euclid(count) as usize;
            betas[place - 1] = beta;
        }
        betas
    }

    /// Finds the joint_paths of one class in one block again.
    fn repeat_block(&self, pass: Pass<'_>, class: PostureClass, block: usize, workspace: &mut Workspace) {
        let mut asked = [false; 4];
        asked[class.index()] = true;
        let Workspace { before, now, record } = workspace;
        let first = block * record.block;
        let last = (first + record.block).min(pass.span.len() - 1);
        for place in first..=last {
            let point = pass.span.start + place;
            pass.evaluator.evaluate_classes(point, pass.placement, asked, now);
            if place == first {
                let (pad, count) = (now.pad(), now.count());
                now.scores_mut(class)[pad..pad + count].copy_from_slice(record.kept(block, class));
            } else {
                advance(
                    before,
                    now,
                    class,
                    &self.accumulated_step(point, pass.sense, pass.is_accumulated),
                    record.way(place, class),
                );
            }
            now.wrap_around(class);
            std::mem::swap(before, now);
        }
    }
}
