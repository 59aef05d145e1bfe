//! The plans of one segment: which postures it can be driven in, and at what cost.

use super::corridor::Corridor;
use super::forward_pass::{ForwardPass, Pass};
use super::{SegmentPlanner, Workspace, joint_turns};
use std::ops::Range as Span;
use stead_model::robot::{Posture, PostureClass};
use stead_problem::joint_travel::joint_travel;
use stead_problem::problem::Placement;
use stead_problem::sense::Sense;

/// What a segment offers.
pub(super) struct SegmentOptions {
    /// The cheapest plans.
    pub choices: Vec<joint_turns::SegmentChoice>,
    /// Points without an allowed state in any posture requested.
    pub blocked: Vec<usize>,
    /// The first point that the posture that gets farthest cannot get to.
    pub farthest: usize,
}

/// How a segment is gone through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Strategy {
    /// From knot to knot.
    Knots,
    /// From point to point: where a plan by knots breaks a limit between them.
    PointToPoint,
    /// By the knots of the other sense: where no plan is found so, so that both senses find the same segments feasible.
    KnotsOfOtherSense,
}

impl Strategy {
    const IN_ORDER: [Self; 3] = [Self::Knots, Self::PointToPoint, Self::KnotsOfOtherSense];
}

impl SegmentPlanner<'_> {
    /// Sweeps one segment with every evaluator that evaluates a posture requested, and takes from all together the
    /// cheapest plans; with no `margin`, only the blocked points are found.
    pub(super) fn segment(
        &self,
        span: Span<usize>,
        placement: &Placement,
        sense: Sense,
        only: Option<Posture>,
        workspace: &mut Workspace,
        margin: Option<f64>,
    ) -> SegmentOptions {
        let mut found = SegmentOptions { choices: Vec::new(), blocked: span.clone().collect(), farthest: span.start };
        let rules = &self.problem.postures;
        let is_spread = margin.is_some() && self.knots.is_spread(&span);
        let is_requested =
            |posture: Posture| only.is_none_or(|requested| requested == posture) && rules.allows(posture);
        for evaluator in &self.evaluators {
            let postures = |posture: &Posture| evaluator.flips().contains(*posture) && is_requested(*posture);
            if !Posture::ALL.iter().any(postures) {
                continue;
            }
            let mut has_knots = is_spread;
            for strategy in Strategy::IN_ORDER {
                let is_by_knots = strategy != Strategy::PointToPoint;
                let is_of_other_sense = strategy == Strategy::KnotsOfOtherSense;
                if (is_by_knots && !has_knots) || (is_of_other_sense && !found.choices.is_empty()) {
                    continue;
                }
                let requested = sense;
                let sense = if is_of_other_sense { sense.other() } else { sense };
                let pass = Pass { evaluator, span: &span, placement, sense, is_by_knots };
                let forward_pass = self.forward_pass(pass, only, workspace, margin.is_none());
                found.blocked.retain(|point| forward_pass.blocked.binary_search(point).is_ok());
                let Some(margin) = margin else { break };
                found.farthest = found.farthest.max(forward_pass.farthest(&span));
                has_knots &= !is_by_knots || forward_pass.ends.iter().any(Option::is_some);
                let has_all = self.choose(pass, postures, &forward_pass, workspace, margin, &mut found.choices);
                let travel = self.travel_cost(requested) - self.travel_cost(sense);
                if is_of_other_sense && travel != 0.0 {
                    found.choices.iter_mut().for_each(|choice| choice.cost += travel * travelled(choice));
                }
                if has_all {
                    break;
                }
            }
        }
        found
    }

    /// The postures of a class that yield like the given one, itself among them.
    pub(super) fn equivalent_postures(&self, posture: Posture) -> Vec<Posture> {
        let evaluator = self.evaluators.iter().find(|evaluator| evaluator.flips().contains(posture));
        let postures = posture.class().postures().into_iter();
        let is_like = |p: &Posture| evaluator.is_some_and(|evaluator| evaluator.flips().contains(*p));
        postures.filter(|p| is_like(p) && self.problem.postures.allows(*p)).collect()
    }

    /// Adds the plans of one segment, in the postures that pass a test, whose classes and turns keep every joint inside
    /// its limits, and keeps of all the cheapest, and those that cost at most `margin` (relative) more, cheapest first.
    /// Returns whether every class that can be cheaper has a plan.
    fn choose(
        &self,
        pass: Pass<'_>,
        is_requested: impl Fn(&Posture) -> bool,
        outcome: &ForwardPass,
        workspace: &mut Workspace,
        margin: f64,
        found: &mut Vec<joint_turns::SegmentChoice>,
    ) -> bool {
        let Pass { span, placement, sense, is_by_knots, .. } = pass;
        let forbidden = workspace.forbidden.clone();
        let mut has_all = outcome.ends.iter().any(Option::is_some);
        // The classes by rising cost; what flips and turns allow of a class can only cost more than its relaxation.
        let mut order: Vec<(f64, PostureClass)> = PostureClass::ALL
            .into_iter()
            .filter_map(|class| outcome.ends[class.index()].map(|(cost, _)| (cost, class)))
            .collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let sign = sense.sign();
        let limit = |found: &[joint_turns::SegmentChoice]| {
            found.first().map(|best| best.cost * sign + margin * best.cost.abs())
        };
        for (cost, class) in order {
            if limit(found).is_some_and(|limit| cost >= limit) {
                break;
            }
            let postures: Vec<Posture> = class.postures().into_iter().filter(&is_requested).collect();
            let path = |betas: &[usize]| {
                let mut path: Vec<f64> = betas.iter().map(|k| self.grid.beta(*k)).collect();
                if is_by_knots {
                    self.knots.spread(span, &mut path);
                }
                path
            };
            let drive = |path: &[f64], cost: f64| {
                let choice =
                    joint_turns::unwind(self.problem, span, placement, path, &postures, cost * sign, &self.steps)?;
                if is_by_knots { self.recosted(placement, sense, choice) } else { Some(choice) }
            };
            let follow =
                |path: &[f64], cost: f64| drive(&self.followed(span, placement, *postures.first()?, path)?, cost);
            let near = |path: &[f64], cost: f64| {
                // What the search compares is not worth the time.
                let posture = *postures.first().filter(|_| self.checks_moves())?;
                let corridor = Corridor { span, placement, sense, posture, forbidden: &forbidden };
                let path = self.within_corridor(&corridor, path)?;
                drive(&path, cost)
            };
            let betas = self.trace(pass, class, outcome, workspace);
            let relaxed = path(&betas);
            let mut choice = drive(&relaxed, cost);
            if choice.is_none() {
                let flips = [false, true].map(|flip| postures.iter().any(|posture| posture.is_flipped() == flip));
                let with_turns = self.path_with_turns(pass, class, flips, cost, workspace);
                let with_turns = with_turns.map(|found| (path(&found.betas), found.cost));
                choice = with_turns.as_ref().and_then(|(path, cost)| drive(path, *cost));
                if choice.is_none() && is_by_knots {
                    choice = near(&relaxed, cost)
                        .or_else(|| {
                            with_turns.and_then(|(path, cost)| near(&path, cost).or_else(|| follow(&path, cost)))
                        })
                        .or_else(|| follow(&relaxed, cost));
                }
            }
            has_all &= choice.is_some();
            found.extend(choice);
            found.sort_by(|a, b| (a.cost * sign).total_cmp(&(b.cost * sign)));
        }
        if let Some(limit) = limit(found) {
            let best = found[0].cost;
            found.retain(|choice| choice.cost == best || choice.cost * sign <= limit);
        }
        has_all
    }

    /// A plan with its own cost, where all its states are allowed.
    fn recosted(
        &self,
        placement: &Placement,
        sense: Sense,
        mut choice: joint_turns::SegmentChoice,
    ) -> Option<joint_turns::SegmentChoice> {
        let posture = choice.joint_paths.first()?.posture;
        let travel = self.travel_cost(sense);
        choice.cost = if travel > 0.0 { travel * travelled(&choice) } else { 0.0 };
        for (point, beta) in choice.points.clone().zip(&choice.betas) {
            let state = self.problem.at(placement).state(point, *beta, posture).ok()?;
            if !joint_turns::is_allowed(self.problem, &state) {
                return None;
            }
            choice.cost =
                self.problem.criterion.aggregate.join(choice.cost, self.problem.point_cost(point, state.score()));
        }
        Some(choice)
    }
}

/// The joint travel of a plan, which is the same in every flip and turn. rad
fn travelled(choice: &joint_turns::SegmentChoice) -> f64 {
    choice.joint_paths.first().map_or(0.0, |path| joint_travel(&path.joints))
}
