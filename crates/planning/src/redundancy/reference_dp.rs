//! Dynamic programming over (beta, turns) in one posture: where a flip or the turns of joints 1, 4 and 6 decide.
//!
//! The judge of [`super::transition`] and [`super::turns_dp`] in the tests, written to be plainly right: every real
//! configuration of every grid state is a node, and an edge is a change of beta within its limits with every real joint
//! angle within its step.

use super::joint_turns::{JointPath, SegmentChoice, is_allowed};
use super::{SegmentPlanner, Sense, Workspace};
use std::ops::Range as Span;
use stead_model::robot::turns::real_configurations;
use stead_model::robot::{Posture, PostureClass};
use stead_problem::constraints::joint_steps_hold;
use stead_problem::evaluate::batch::BatchEvaluator;
use stead_problem::joint_travel::joint_distance;
use stead_problem::problem::Placement;

/// One real configuration at one grid value of beta.
#[derive(Debug, Clone)]
struct Node {
    beta: usize,
    joints: [f64; 6],
    /// What the point adds to the cost.
    score: f64,
    /// Smallest signed cost up to here.
    cost: f64,
    from: usize,
}

/// The cheapest plan of a segment over the given postures.
pub(super) fn plan(
    planner: &SegmentPlanner<'_>,
    span: &Span<usize>,
    placement: &Placement,
    sense: Sense,
    postures: &[Posture],
    workspace: &mut Workspace,
) -> Option<SegmentChoice> {
    let mut best: Option<SegmentChoice> = None;
    for posture in postures {
        let Some(choice) = one_posture(planner, span, placement, sense, *posture, workspace) else { continue };
        let sign = sense.sign();
        match &mut best {
            Some(known) if known.cost == choice.cost && known.betas == choice.betas => {
                known.joint_paths.extend(choice.joint_paths)
            }
            Some(known) if known.cost * sign <= choice.cost * sign => {}
            _ => best = Some(choice),
        }
    }
    best
}

/// Segments of more points than this are gone through in blocks.
const MAX_LAYERS: usize = 4096;

/// What is planned: one segment in one posture.
pub(super) struct Search<'s> {
    pub planner: &'s SegmentPlanner<'s>,
    pub span: &'s Span<usize>,
    pub placement: &'s Placement,
    pub sense: Sense,
    pub posture: Posture,
}

fn one_posture(
    planner: &SegmentPlanner<'_>,
    span: &Span<usize>,
    placement: &Placement,
    sense: Sense,
    posture: Posture,
    workspace: &mut Workspace,
) -> Option<SegmentChoice> {
    let block = if span.len() > MAX_LAYERS { span.len().isqrt() } else { span.len() };
    Search { planner, span, placement, sense, posture }.plan(block, workspace)
}

impl Search<'_> {
    /// The cheapest plan. Only the layers of one block of points are kept, and the first ones of the others, from which
    /// theirs are found again.
    pub fn plan(&self, block: usize, workspace: &mut Workspace) -> Option<SegmentChoice> {
        let length = self.span.len();
        let mut firsts = vec![self.first(workspace)?];
        let mut layers = Vec::new();
        for place in (0..length).step_by(block) {
            layers = self.block(firsts.last()?, place, (place + block).min(length), workspace)?;
            if place + block < length {
                firsts.push(self.next(layers.last()?, place + block, workspace)?);
            }
        }
        let last = layers.last()?;
        let mut index = (0..last.len()).min_by(|a, b| last[*a].cost.total_cmp(&last[*b].cost))?;
        let cost = last[index].cost * self.sense.sign();
        let (mut betas, mut joints) = (Vec::with_capacity(length), Vec::with_capacity(length));
        for (number, first) in firsts.iter().enumerate().rev() {
            if number + 1 < firsts.len() {
                layers = self.block(first, number * block, (number + 1) * block, workspace)?;
            }
            for layer in layers.iter().rev() {
                let node = &layer[index];
                betas.push(self.planner.grid.beta(node.beta));
                joints.push(node.joints);
                index = node.from;
            }
        }
        betas.reverse();
        joints.reverse();
        let joint_paths = vec![JointPath { posture: self.posture, joints }];
        Some(SegmentChoice { points: self.span.clone(), betas, cost, joint_paths })
    }

    /// The layers of the points at `from` up to `to`, the first one given.
    fn block(&self, first: &[Node], from: usize, to: usize, workspace: &mut Workspace) -> Option<Vec<Vec<Node>>> {
        let mut layers = vec![first.to_vec()];
        for place in from + 1..to {
            layers.push(self.next(layers.last()?, place, workspace)?);
        }
        Some(layers)
    }

    /// The layer of the first point, where it has states.
    fn first(&self, workspace: &mut Workspace) -> Option<Vec<Node>> {
        let mut layer = nodes(self.planner, self.span.start, self.placement, self.posture, workspace);
        layer.iter_mut().for_each(|node| node.cost = node.score * self.sense.sign());
        Some(layer).filter(|layer| !layer.is_empty())
    }

    /// The layer after another, where some of its states can be reached.
    fn next(&self, before: &[Node], place: usize, workspace: &mut Workspace) -> Option<Vec<Node>> {
        let point = self.span.start + place;
        let planner = self.planner;
        let mut layer = nodes(planner, point, self.placement, self.posture, workspace);
        connect(planner, before, &mut layer, point, planner.travel_cost(self.sense));
        layer.retain(|node| node.cost.is_finite());
        let join = |node: &Node| {
            let own = node.score * self.sense.sign();
            planner.problem.criterion.aggregate.join_signed(self.sense, node.cost, own)
        };
        layer.iter_mut().for_each(|node| node.cost = join(node));
        Some(layer).filter(|layer| !layer.is_empty())
    }
}

/// Every real configuration of every allowed grid state of one point, in the order of beta.
fn nodes(
    planner: &SegmentPlanner<'_>,
    point: usize,
    placement: &Placement,
    posture: Posture,
    space: &mut Workspace,
) -> Vec<Node> {
    let problem = planner.problem;
    // The batch evaluator says which grid values are worth a closer look.
    let Some(evaluator) = BatchEvaluator::of_posture(&planner.evaluators, posture) else {
        return Vec::new();
    };
    evaluator.evaluate(point, placement, &mut space.now);
    let class: PostureClass = posture.class();
    let mut nodes = Vec::new();
    for beta in 0..planner.grid.beta_count {
        if !space.now.inner_scores(class)[beta].is_finite() {
            continue;
        }
        let Ok(state) = problem.at(placement).state(point, planner.grid.beta(beta), posture) else {
            continue;
        };
        if !is_allowed(problem, &state) {
            continue;
        }
        let score = problem.point_cost(point, state.score());
        nodes.extend(real_configurations(&problem.robot, &state.joints).into_iter().map(|joints| Node {
            beta,
            joints,
            score,
            cost: f64::INFINITY,
            from: 0,
        }));
    }
    nodes
}

/// Gives each node its cheapest predecessor.
fn connect(planner: &SegmentPlanner<'_>, before: &[Node], layer: &mut [Node], point: usize, travel: f64) {
    let (change, count, limits) = (planner.changes[point], planner.grid.beta_count, &planner.steps[point]);
    let mut starts = vec![before.len(); count + 1];
    for (index, node) in before.iter().enumerate().rev() {
        starts[node.beta] = index;
    }
    for beta in (0..count).rev() {
        starts[beta] = starts[beta].min(starts[beta + 1]);
    }
    for node in layer {
        for shift in change.shifts() {
            let beta = (node.beta as isize + shift).rem_euclid(count as isize) as usize;
            for (index, old) in before.iter().enumerate().take(starts[beta + 1]).skip(starts[beta]) {
                let cost = old.cost + travel * joint_distance(&old.joints, &node.joints);
                if cost < node.cost && joint_steps_hold(&planner.problem.robot, &old.joints, &node.joints, limits) {
                    node.cost = cost;
                    node.from = index;
                }
            }
        }
    }
}
