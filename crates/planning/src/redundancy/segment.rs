//! The plans of one segment: which postures it can be driven in, and at what cost.

use super::corridor::Corridor;
use super::forward_pass::{ForwardPass, Pass};
use super::joint_turns::{SegmentChoice, is_allowed};
use super::segment_planner::Request;
use super::{SegmentPlanner, StateSet, Workspace};
use std::borrow::Cow;
use stead_model::robot::{Posture, PostureClass};
use stead_problem::evaluate::batch::{BatchEvaluator, KernelNumber};
use stead_problem::joint_travel::joint_travel;
use stead_problem::problem::Placement;
use stead_problem::sense::Sense;

/// What a segment offers.
pub(super) struct SegmentOptions {
    /// The cheapest plans.
    pub choices: Vec<SegmentChoice>,
    /// Points without an allowed state in any posture requested.
    pub blocked: Vec<usize>,
    /// The first point that the posture that gets farthest cannot get to.
    pub farthest: usize,
}

/// What is sought of a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sought {
    /// The blocked points alone.
    Blocked,
    /// The cost of the cheapest plan: one way to drive it is enough.
    Cost,
    /// All plans that cost at most so much (relative) more than the cheapest.
    Plans(f64),
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

/// How a path of beta is found that can be driven, in the order in which it is tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Attempt {
    /// The cheapest path, flips and turns of the joints left aside.
    Relaxed,
    /// The cheapest with flips and turns, which keep every joint inside its limits at the knots.
    Turns,
    /// The cheapest near the relaxed one, where a joint cannot follow that between its knots.
    Corridor,
    /// The cheapest near that with flips and turns.
    CorridorOfTurns,
    /// The path with flips and turns as far as the joints follow it.
    FollowTurns,
    /// The relaxed path as far as the joints follow it.
    Follow,
}

impl Attempt {
    const IN_ORDER: [Self; 6] =
        [Self::Relaxed, Self::Turns, Self::Corridor, Self::CorridorOfTurns, Self::FollowTurns, Self::Follow];

    /// Whether it is tried: nothing is wrong between the points of a pass without knots, and the comparison of
    /// placements is not worth the time of a corridor.
    fn is_tried(self, is_by_knots: bool, checks_moves: bool) -> bool {
        match self {
            Self::Relaxed | Self::Turns => true,
            Self::Corridor | Self::CorridorOfTurns => is_by_knots && checks_moves,
            Self::FollowTurns | Self::Follow => is_by_knots,
        }
    }

    /// Whether it begins with the path with flips and turns.
    fn is_of_turns(self) -> bool {
        matches!(self, Self::Turns | Self::CorridorOfTurns | Self::FollowTurns)
    }
}

/// A path of beta (rad) with what it costs, by the sense: the smaller the better.
type CostedPath = (Vec<f64>, f64);

/// One segment in the postures of one class.
struct ClassDrive<'s> {
    planner: &'s SegmentPlanner<'s>,
    pass: Pass<'s>,
    class: PostureClass,
    postures: Vec<Posture>,
    sought: Sought,
    /// States that hit.
    forbidden: &'s StateSet,
}

impl ClassDrive<'_> {
    /// The path along values of the grid, interpolated between knots. rad
    fn path(&self, betas: &[usize]) -> Vec<f64> {
        let mut path: Vec<f64> = betas.iter().map(|k| self.planner.grid.beta(*k)).collect();
        if self.pass.is_by_knots {
            self.planner.knots.spread(self.pass.span, &mut path);
        }
        path
    }

    /// The cheapest path with flips and turns.
    fn with_turns<E: KernelNumber>(&self, cost: f64, workspace: &mut Workspace<E>) -> Option<CostedPath> {
        let flips = [false, true].map(|flip| self.postures.iter().any(|posture| posture.is_flipped() == flip));
        let found = self.planner.path_with_turns(self.pass, self.class, flips, cost, workspace)?;
        Some((self.path(&found.betas), found.cost))
    }

    /// A path as it is driven, or one made of it in some way.
    fn driven(&self, attempt: Attempt, path: &[f64], cost: f64) -> Option<SegmentChoice> {
        let Pass { span, placement, sense, is_by_knots, .. } = self.pass;
        let posture = *self.postures.first()?;
        let made = match attempt {
            Attempt::Relaxed | Attempt::Turns => Cow::Borrowed(path),
            Attempt::Corridor | Attempt::CorridorOfTurns => {
                let corridor = Corridor { span, placement, sense, posture, forbidden: self.forbidden };
                Cow::Owned(self.planner.within_corridor(&corridor, path)?)
            }
            Attempt::FollowTurns | Attempt::Follow => {
                Cow::Owned(self.planner.followed(span, placement, posture, path)?)
            }
        };
        let unwound = |postures: &[Posture]| self.planner.unwind(span, placement, &made, postures, cost * sense.sign());
        let choice = match self.sought {
            Sought::Cost => self.postures.chunks(1).find_map(unwound)?,
            _ => unwound(&self.postures)?,
        };
        if is_by_knots { self.planner.recosted(placement, sense, choice) } else { Some(choice) }
    }

    /// The plan by the first way that leads to one.
    fn choice<E: KernelNumber>(&self, relaxed: CostedPath, workspace: &mut Workspace<E>) -> Option<SegmentChoice> {
        let mut turns = None;
        let is_tried = |attempt: &Attempt| attempt.is_tried(self.pass.is_by_knots, self.planner.checks_moves());
        Attempt::IN_ORDER.into_iter().filter(is_tried).find_map(|attempt| {
            if attempt == Attempt::Turns {
                turns = self.with_turns(relaxed.1, workspace);
            }
            let (path, cost) = if attempt.is_of_turns() { turns.as_ref()? } else { &relaxed };
            self.driven(attempt, path, *cost)
        })
    }
}

impl SegmentPlanner<'_> {
    /// Sweeps one segment with every evaluator that evaluates a posture requested, and takes from all together the
    /// cheapest plans.
    pub(super) fn segment<E: KernelNumber>(
        &self,
        segment: usize,
        request: Request<'_>,
        workspace: &mut Workspace<E>,
        sought: Sought,
    ) -> SegmentOptions {
        let span = &self.problem.task.segments()[segment];
        let mut found = SegmentOptions { choices: Vec::new(), blocked: span.clone().collect(), farthest: span.start };
        let is_spread = sought != Sought::Blocked && self.knots.is_spread(span);
        for evaluator in &self.evaluators {
            let Request { placement, sense, .. } = request;
            let of = Pass { evaluator, span, placement, sense, only: request.posture(segment), is_by_knots: false };
            if !Posture::ALL.iter().any(|posture| self.is_requested(of, *posture)) {
                continue;
            }
            let mut has_knots = is_spread;
            for strategy in Strategy::IN_ORDER {
                let is_by_knots = strategy != Strategy::PointToPoint;
                let is_of_other_sense = strategy == Strategy::KnotsOfOtherSense;
                if (is_by_knots && !has_knots) || (is_of_other_sense && !found.choices.is_empty()) {
                    continue;
                }
                let pass = Pass { sense: if is_of_other_sense { sense.other() } else { sense }, is_by_knots, ..of };
                let forward_pass = self.forward_pass(pass, workspace, sought == Sought::Blocked);
                found.blocked.retain(|point| forward_pass.blocked.binary_search(point).is_ok());
                if sought == Sought::Blocked {
                    break;
                }
                found.farthest = found.farthest.max(forward_pass.farthest(span));
                has_knots &= !is_by_knots || forward_pass.ends.iter().any(Option::is_some);
                let has_all = self.choose(pass, &forward_pass, workspace, sought, &mut found.choices);
                let travel = self.travel_cost(sense) - self.travel_cost(pass.sense);
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

    /// The plans that cost at most `margin` (relative) more than the cheapest as single precision finds them, with
    /// their costs in double precision; by this alone where one of them is not allowed in it, or none is found.
    pub(super) fn proposed(
        &self,
        segment: usize,
        request: Request<'_>,
        workspace: &mut Workspace,
        margin: f64,
    ) -> SegmentOptions {
        let (forbidden, only_beta) = (workspace.forbidden.clone(), workspace.only_beta);
        let single = workspace.single.get_or_insert_with(|| Box::new(self.workspace()));
        (single.forbidden, single.only_beta) = (forbidden, only_beta);
        let sought = Sought::Plans(margin);
        let found = self.segment(segment, request, single, sought);
        let Request { placement, sense, .. } = request;
        let exact = |choice| self.recosted(placement, sense, choice);
        let choices: Option<Vec<SegmentChoice>> = found.choices.into_iter().map(exact).collect();
        match choices.filter(|choices| !choices.is_empty()) {
            Some(mut choices) => {
                choices.sort_by(|a, b| sense.compare(a.cost, b.cost));
                SegmentOptions { choices, ..found }
            }
            None => self.segment(segment, request, workspace, sought),
        }
    }

    /// The postures of a class that yield like the given one, itself among them.
    pub(super) fn equivalent_postures(&self, posture: Posture) -> Vec<Posture> {
        let evaluator = BatchEvaluator::of_posture(&self.evaluators, posture);
        let postures = posture.class().postures().into_iter();
        let is_like = |p: &Posture| evaluator.is_some_and(|evaluator| evaluator.flips().contains(*p));
        postures.filter(|p| is_like(p) && self.problem.postures.allows(*p)).collect()
    }

    /// Adds the plans of one segment, in the postures of a pass, whose classes and turns keep every joint inside
    /// its limits, and keeps of all the cheapest, and those that are sought beside it, cheapest first.
    /// Returns whether every class that can be cheaper has a plan.
    fn choose<E: KernelNumber>(
        &self,
        pass: Pass<'_>,
        outcome: &ForwardPass,
        workspace: &mut Workspace<E>,
        sought: Sought,
        found: &mut Vec<SegmentChoice>,
    ) -> bool {
        let forbidden = workspace.forbidden.clone();
        let mut has_all = outcome.ends.iter().any(Option::is_some);
        let margin = if let Sought::Plans(margin) = sought { margin } else { 0.0 };
        // The classes by rising cost; what flips and turns allow of a class can only cost more than its relaxation.
        let mut order: Vec<(f64, PostureClass)> = PostureClass::ALL
            .into_iter()
            .filter_map(|class| outcome.ends[class.index()].map(|(cost, _)| (cost, class)))
            .collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let sign = pass.sense.sign();
        let limit = |found: &[SegmentChoice]| found.first().map(|best| best.cost * sign + margin * best.cost.abs());
        for (cost, class) in order {
            if limit(found).is_some_and(|limit| cost >= limit) {
                break;
            }
            let postures: Vec<Posture> =
                class.postures().into_iter().filter(|posture| self.is_requested(pass, *posture)).collect();
            let drive = ClassDrive { planner: self, pass, class, postures, sought, forbidden: &forbidden };
            let relaxed = drive.path(&self.trace(pass, class, outcome, workspace));
            let choice = drive.choice((relaxed, cost), workspace);
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
    fn recosted(&self, placement: &Placement, sense: Sense, mut choice: SegmentChoice) -> Option<SegmentChoice> {
        let posture = choice.joint_paths.first()?.posture;
        let travel = self.travel_cost(sense);
        choice.cost = if travel > 0.0 { travel * travelled(&choice) } else { 0.0 };
        for (point, beta) in choice.points.clone().zip(&choice.betas) {
            let state = self.problem.at(placement).state(point, *beta, posture).ok()?;
            if !is_allowed(self.problem, &state) {
                return None;
            }
            choice.cost =
                self.problem.criterion.aggregate.join(choice.cost, self.problem.point_cost(point, state.score()));
        }
        Some(choice)
    }
}

/// The joint travel of a plan, which is the same in every flip and turn. rad
fn travelled(choice: &SegmentChoice) -> f64 {
    choice.joint_paths.first().map_or(0.0, |path| joint_travel(&path.joints))
}
