//! The dynamic programming of [`super::transition`] along a segment.
//!
//! Point by point: the batch evaluator fills a fresh set of states, and each state takes its cheapest predecessor. Only
//! the last two points are kept, and for each state the way it came: of a long segment only for a block of points,
//! since the ways of the others can be found again from the costs at the start of their block. So memory grows
//! with the square root of the number of points, and time with their number.
//!
//! Where points are dense the pass goes from knot to knot ([`super::knots`]), and the points between add to what a step
//! costs.

use super::between::{CyclicRow, Joining};
use super::knots::{Knot, Place};
use super::rate_limit::BetaChange;
use super::record::Record;
use super::transition::{Step, advance, advance_costs, advance_over, begin, cheapest_shift};
use super::{SegmentPlanner, Sense, Workspace};
use std::ops::Range as Span;
use stead_model::robot::{Posture, PostureClass};
use stead_problem::evaluate::batch::{BatchEvaluator, KernelNumber};
use stead_problem::problem::{MAX_JOINT_STEP, Placement};

/// What one pass over a segment found.
#[derive(Debug, Clone)]
pub(super) struct ForwardPass {
    /// For each class the smallest sum of signed scores and the beta number at the end.
    pub ends: [Option<(f64, usize)>; 4],
    /// For each class the first point that it cannot get to.
    pub stuck: [Option<usize>; 4],
    /// Points without an allowed state in any class requested, ascending.
    pub blocked: Vec<usize>,
}

impl ForwardPass {
    /// The first point that the class that gets farthest cannot get to: the last one, where a class gets through but
    /// for the turns of its joints.
    pub fn farthest(&self, span: &Span<usize>) -> usize {
        let last = span.end - 1;
        if self.ends.iter().any(Option::is_some) {
            last
        } else {
            self.stuck.iter().flatten().copied().max().unwrap_or(last)
        }
    }
}

/// A pass over a segment, with the workpiece at a placement.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pass<'p> {
    pub evaluator: &'p BatchEvaluator<'p>,
    pub span: &'p Span<usize>,
    pub placement: &'p Placement,
    pub sense: Sense,
    /// The posture, where one is given.
    pub only: Option<Posture>,
    /// Whether it goes from knot to knot, or else from point to point.
    pub is_by_knots: bool,
}

impl SegmentPlanner<'_> {
    /// What bounds the step to path point `point` from the one before.
    pub fn step(&self, point: usize, sense: Sense) -> Step {
        self.step_over::<f64>(point, self.changes[point], false, sense)
    }

    /// By how much each joint may step to a path point from the one so many points before. rad
    pub(super) fn joint_limits(&self, point: usize, points: usize) -> [f64; 6] {
        let mut limits = self.steps[point];
        for other in point + 1 - points..point {
            limits.iter_mut().zip(self.steps[other]).for_each(|(sum, limit)| *sum = MAX_JOINT_STEP.min(*sum + limit));
        }
        limits
    }

    /// What bounds the step to a path point from the one before, or from the knot before.
    fn step_over<E: KernelNumber>(&self, point: usize, change: BetaChange, is_by_knots: bool, sense: Sense) -> Step {
        Step {
            change,
            joints: self.kernel_steps::<E>(point, is_by_knots),
            sense,
            aggregate: self.problem.criterion.aggregate,
            fold: self.problem.robot.has_linkage().then_some(self.problem.robot.geometry().fold),
            travel: self.travel_cost(sense),
            instructions: self.instructions,
        }
    }

    /// What a point is to a pass.
    pub(super) fn place(&self, pass: Pass<'_>, point: usize) -> Place {
        match pass.is_by_knots {
            true => self.knots.at(point),
            false => Place::Knot(Knot {
                number: point - pass.span.start,
                change: self.changes[point],
                points: 1,
                middle: 0.0,
            }),
        }
    }

    /// The path point of a knot of a pass.
    pub(super) fn knot(&self, pass: Pass<'_>, number: usize) -> usize {
        if pass.is_by_knots { self.knots.of(pass.span)[number] } else { pass.span.start + number }
    }

    /// Number of knots of a pass.
    pub(super) fn knot_count(&self, pass: Pass<'_>) -> usize {
        if pass.is_by_knots { self.knots.of(pass.span).len() } else { pass.span.len() }
    }

    /// Adds the scores of a point between knots to the costs of the run; false when no state is left.
    pub(super) fn add_between<E: KernelNumber>(
        &self,
        pass: Pass<'_>,
        point: usize,
        class: PostureClass,
        workspace: &mut Workspace<E>,
    ) -> bool {
        let Place::Between { knot, middle, share, is_first } = self.knots.at(point) else { return true };
        let Place::Knot(end) = self.knots.at(knot) else { return true };
        let Workspace { now, run_costs, .. } = workspace;
        if !now.is_alive(class) {
            return false;
        }
        now.wrap_scores(class);
        let offsets = self.knots.offsets(end, middle, share);
        let row = CyclicRow { scores: now.scores(class), pad: now.pad() };
        run_costs.add(class, row, offsets, is_first, self.joining(pass));
        true
    }

    pub(super) fn joining(&self, pass: Pass<'_>) -> Joining {
        Joining { sense: pass.sense, aggregate: self.problem.criterion.aggregate }
    }

    /// Takes the cheapest predecessors of a knot's states; false when no state is reached.
    fn reach<E: KernelNumber>(
        &self,
        pass: Pass<'_>,
        point: usize,
        knot: Knot,
        class: PostureClass,
        workspace: &mut Workspace<E>,
    ) -> bool {
        let Workspace { before, now, record, run_costs, .. } = workspace;
        let step = self.step_over::<E>(point, knot.change, pass.is_by_knots, pass.sense);
        if knot.points == 1 && record.keeps_reached && step.is_free(before, now, class) {
            record.leave_way(knot.number, class);
            return advance_costs(before, now, class, &step);
        }
        before.wrap_joints(class);
        let way = record.way(knot.number, class);
        if knot.points == 1 {
            return advance(before, now, class, &step, way);
        }
        let between = run_costs.of(class, knot.change.min, self.joining(pass));
        advance_over(before, now, class, &step, between, way)
    }

    /// Evaluates a path point in some posture classes, without the states in which something hits.
    pub(super) fn evaluate<E: KernelNumber>(
        &self,
        pass: Pass<'_>,
        point: usize,
        classes: [bool; 4],
        workspace: &mut Workspace<E>,
    ) {
        let Workspace { now, forbidden, only_beta, .. } = workspace;
        pass.evaluator.evaluate_some(point, pass.placement, classes, *only_beta, now);
        if let Some(hits) = &self.tool_hits {
            hits.apply(point, now);
        }
        forbidden.apply(point, now);
    }

    /// Whether a pass is made for a posture.
    pub(super) fn is_requested(&self, pass: Pass<'_>, posture: Posture) -> bool {
        let is_given = pass.only.is_none_or(|requested| requested == posture);
        is_given && pass.evaluator.flips().contains(posture) && self.problem.postures.allows(posture)
    }

    /// Passes over the points of a segment, in every posture class or in that of the posture given. With `count_only`,
    /// only the blocked points are found.
    pub(super) fn forward_pass<E: KernelNumber>(
        &self,
        pass: Pass<'_>,
        workspace: &mut Workspace<E>,
        count_only: bool,
    ) -> ForwardPass {
        let mut forward_pass = ForwardPass { ends: [None; 4], stuck: [None; 4], blocked: Vec::new() };
        let rules = &self.problem.postures;
        let requested = PostureClass::ALL
            .map(|class| pass.only.is_none_or(|posture| posture.class() == class) && rules.allows_class(class));
        workspace.record.begin(if count_only { None } else { Some(self.knot_count(pass)) });
        for point in pass.span.clone() {
            if self.unwanted.is_set() {
                return forward_pass;
            }
            // A class that is stuck is evaluated only where that tells whether the point is blocked.
            let live: [bool; 4] = std::array::from_fn(|k| requested[k] && forward_pass.stuck[k].is_none());
            let classes = if live.contains(&true) { live } else { requested };
            let is_blocked =
                |workspace: &Workspace<E>| PostureClass::ALL.iter().all(|class| !workspace.now.is_alive(*class));
            self.evaluate(pass, point, classes, workspace);
            if classes != requested && is_blocked(workspace) {
                self.evaluate(pass, point, requested, workspace);
            }
            if is_blocked(workspace) {
                forward_pass.blocked.push(point);
            }
            if count_only {
                continue;
            }
            let place = self.place(pass, point);
            for class in PostureClass::ALL {
                let (is_reached, stuck) = self.continue_to(pass, point, place, class, workspace);
                if !is_reached && forward_pass.stuck[class.index()].is_none() {
                    forward_pass.stuck[class.index()] = Some(stuck);
                }
            }
            if let Place::Knot(knot) = place {
                let Workspace { record, now, .. } = &mut *workspace;
                if record.begins(knot.number, self.knot_count(pass)) {
                    Record::keep(&mut record.costs, now);
                }
                if record.keeps_reached {
                    Record::keep(&mut record.reached, now);
                }
                std::mem::swap(&mut workspace.before, &mut workspace.now);
            }
        }
        let before = &workspace.before;
        if !count_only {
            for class in PostureClass::ALL.into_iter().filter(|class| before.is_alive(*class)) {
                let costs = before.inner_scores(class);
                let end = (0..costs.len()).min_by(|a, b| costs[*a].get().total_cmp(&costs[*b].get())).unwrap_or(0);
                forward_pass.ends[class.index()] = Some((costs[end].get(), end));
            }
        }
        forward_pass
    }

    /// Continues a class to a point. Returns whether a state is reached, and the point that is not where none is.
    fn continue_to<E: KernelNumber>(
        &self,
        pass: Pass<'_>,
        point: usize,
        place: Place,
        class: PostureClass,
        workspace: &mut Workspace<E>,
    ) -> (bool, usize) {
        match place {
            Place::Between { .. } => {
                let is_reached = workspace.before.is_alive(class) && self.add_between(pass, point, class, workspace);
                if !is_reached {
                    workspace.before.clear(class);
                }
                (is_reached, point)
            }
            Place::Knot(knot) => {
                let (is_start, is_alive) = (point == pass.span.start, workspace.now.is_alive(class));
                if is_alive && is_start {
                    begin(&mut workspace.now, class, pass.sense.sign());
                } else if is_alive
                    && (!workspace.before.is_alive(class) || !self.reach(pass, point, knot, class, workspace))
                {
                    workspace.now.clear(class);
                }
                let is_reached = workspace.now.is_alive(class);
                if is_reached {
                    workspace.now.wrap_scores(class);
                }
                // Of a run that is not gone through, no more is known than that its first point may be out of reach.
                (is_reached, if is_alive { point + 1 - knot.points } else { point })
            }
        }
    }

    /// The beta numbers of the plan that a class ended with, along the segment last swept, in a pass like that.
    pub(super) fn trace<E: KernelNumber>(
        &self,
        pass: Pass<'_>,
        class: PostureClass,
        forward_pass: &ForwardPass,
        workspace: &mut Workspace<E>,
    ) -> Vec<usize> {
        let count = self.grid.beta_count as isize;
        let mut beta = forward_pass.ends[class.index()].map_or(0, |(_, end)| end);
        let mut betas = vec![beta; pass.span.len()];
        let is_whole = workspace.record.costs.is_empty();
        let last = self.knot_count(pass) - 1;
        for number in (1..=last).rev() {
            let block = workspace.record.block;
            if !is_whole && (number == last || number.is_multiple_of(block)) {
                self.repeat_block(pass, class, (number - 1) / block, workspace);
            }
            let shift = self.shift_to(pass, class, number, beta, workspace);
            beta = (beta as isize + isize::from(shift)).rem_euclid(count) as usize;
            betas[self.knot(pass, number - 1) - pass.span.start] = beta;
        }
        betas
    }

    /// The shift from a state of a knot to the one before on the way to it.
    fn shift_to<E: KernelNumber>(
        &self,
        pass: Pass<'_>,
        class: PostureClass,
        number: usize,
        beta: usize,
        workspace: &mut Workspace<E>,
    ) -> i16 {
        let record = &mut workspace.record;
        if record.has_way(number, class) {
            return record.way(number, class)[beta];
        }
        let change = match self.place(pass, self.knot(pass, number)) {
            Place::Knot(knot) => knot.change,
            Place::Between { .. } => BetaChange::only(0),
        };
        record.reached(number - 1, class).map_or(0, |costs| cheapest_shift(change, costs, beta))
    }

    /// Finds the ways of one class in one block again.
    fn repeat_block<E: KernelNumber>(
        &self,
        pass: Pass<'_>,
        class: PostureClass,
        block: usize,
        workspace: &mut Workspace<E>,
    ) {
        let mut requested = [false; 4];
        requested[class.index()] = true;
        let first = block * workspace.record.block;
        let last = (first + workspace.record.block).min(self.knot_count(pass) - 1);
        for point in self.knot(pass, first)..=self.knot(pass, last) {
            self.evaluate(pass, point, requested, workspace);
            match self.place(pass, point) {
                Place::Between { .. } => {
                    self.add_between(pass, point, class, workspace);
                    continue;
                }
                Place::Knot(knot) if knot.number == first => {
                    let Workspace { now, record, .. } = workspace;
                    let (pad, count) = (now.pad(), now.count());
                    now.scores_mut(class)[pad..pad + count].copy_from_slice(record.kept(block, class));
                }
                Place::Knot(knot) => {
                    self.reach(pass, point, knot, class, workspace);
                }
            }
            workspace.now.wrap_scores(class);
            std::mem::swap(&mut workspace.before, &mut workspace.now);
        }
    }
}
