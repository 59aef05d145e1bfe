//! What a placement comes to while it is moved about: its best plan on the grid of the run, along a long path on some
//! of its points.

use super::infeasible::BlockingPair;
use super::plan::detailed;
use crate::outcome::{DeflectionFigures, Plan, PlanPoint};
use crate::path_subset::PathSubset;
use stead_numerics::mean_max::MeanAndMax;
use stead_planning::feasibility::{Finding, diagnose};
use stead_planning::redundancy::{NoFeasiblePlan, Planner, SegmentPlan, Workspace};
use stead_planning::transfer::{Cycle, cut_alone};
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;
use stead_problem::settings::TransferSettings;
use stead_problem::setup::AxisPath;

/// Longer paths are previewed on some of their points.
const WHOLE: usize = 1000;
/// So many, beside one for every segment.
const POINTS: usize = 150;
/// Blocked points and segments whose reason is looked for.
const DIAGNOSED: usize = 4;

/// A problem as it is previewed: on its whole path, or on some points of a long one.
#[derive(Debug, Clone)]
pub struct PreviewProblem {
    problem: Problem,
    subset: Option<PathSubset>,
    all: usize,
    /// Where the external axes stand at all points.
    axes: Vec<AxisPath>,
}

/// What a placement comes to.
#[derive(Debug, Clone, PartialEq)]
pub struct Preview {
    /// Its best plan on the grid; of some points of a long path those alone, by their numbers in the whole path, its
    /// means being estimates of those of all points and its largest values those of the points looked at.
    pub plan: Plan,
    /// Feed and time of the cut, without the moves between segments.
    pub cycle: Cycle,
}

/// Why a placement has no plan, as far as that is looked for while it is moved.
#[derive(Debug, Clone, PartialEq)]
pub struct Blocked {
    /// How many of the points looked at have no allowed state.
    pub points: usize,
    /// How many points were looked at.
    pub looked_at: usize,
    /// Segments whose points are allowed each, but through which no posture gets, and the first point out of reach.
    pub segments: Vec<(usize, usize)>,
    /// The reasons at some of the points: which limit is broken, and by how much.
    pub findings: Vec<Finding>,
    /// Pairs of shapes that hit in the plans tried.
    pub collisions: Vec<BlockingPair>,
}

impl Blocked {
    /// What is in the way, in sentences.
    pub fn reasons(&self) -> Vec<String> {
        let points = (self.points > 0)
            .then(|| format!("{} of {} points looked at have no allowed state", self.points, self.looked_at));
        let segment = |(segment, point): &(usize, usize)| {
            format!(
                "segment {segment}: every point has allowed states, but no posture gets to point {point} from its start"
            )
        };
        let segments = self.segments.iter().take(DIAGNOSED).map(segment);
        let findings = self.findings.iter().map(ToString::to_string);
        let pairs = self.collisions.iter().map(ToString::to_string);
        points.into_iter().chain(findings).chain(segments).chain(pairs).collect()
    }
}

impl PreviewProblem {
    /// That of a problem in its setup.
    pub fn new(problem: &Problem) -> Self {
        let all = problem.task.points().len();
        let count = POINTS + problem.task.segments().len();
        let subset = (all > WHOLE && count < all).then(|| PathSubset::new(&problem.task, count));
        let thinned = subset.as_ref().map(|subset| subset.of(problem));
        Self { problem: thinned.unwrap_or_else(|| problem.clone()), subset, all, axes: problem.axis_paths() }
    }

    /// The planner of it, on the grid of the run.
    pub fn planner(&self) -> Planner<'_> {
        Planner::new(&self.problem)
    }

    /// How many points are looked at, and of how many.
    pub fn points(&self) -> [usize; 2] {
        [self.problem.task.points().len(), self.all]
    }

    /// What a placement comes to, by the planner of this problem.
    ///
    /// # Errors
    /// [`Blocked`]: it has no plan on the grid.
    pub fn preview(
        &self,
        planner: &Planner<'_>,
        placement: &Placement,
        transfer: &TransferSettings,
        workspace: &mut Workspace,
    ) -> Result<Preview, Blocked> {
        match planner.plan(placement, Sense::Min, None, workspace) {
            Ok(plans) => Ok(self.stated(placement, transfer, &plans)),
            Err(none) => Err(self.blocked(placement, none)),
        }
    }

    fn stated(&self, placement: &Placement, transfer: &TransferSettings, plans: &[SegmentPlan]) -> Preview {
        let mut plan = detailed(&self.problem, placement, plans);
        let cycle = cut_alone(&self.problem, transfer, plans);
        if let Some(subset) = &self.subset {
            self.as_of_all(&mut plan);
            let number = |point: usize| subset.points().get(point).copied().unwrap_or(point);
            plan.points.iter_mut().for_each(|point| point.point = number(point.point));
            plan.axes.clone_from(&self.axes);
            plan.clearance.iter_mut().for_each(|clearance| clearance.point = number(clearance.point));
        }
        Preview { plan, cycle }
    }

    /// Means by the number of points that each stands for.
    fn as_of_all(&self, plan: &mut Plan) {
        let path = self.problem.task.path();
        let whole: f64 = plan.points.iter().map(|point| path.weight(point.point)).sum();
        let points = &plan.points;
        let mean = |of: &dyn Fn(&PlanPoint) -> f64| {
            points.iter().map(|point| path.weight(point.point) * of(point)).sum::<f64>() / whole
        };
        let of_all = |figures: MeanAndMax, of: &dyn Fn(&PlanPoint) -> f64| MeanAndMax { mean: mean(of), ..figures };
        let DeflectionFigures { wall, surface, feed, axis, total } = plan.deflection;
        let deflection = DeflectionFigures {
            wall: of_all(wall, &|point| point.normal_part.abs()),
            surface: surface.map(|figures| of_all(figures, &|point| point.surface_part.unwrap_or(0.0).abs())),
            feed: of_all(feed, &|point| point.feed_part.abs()),
            axis: of_all(axis, &|point| point.axial_part.abs()),
            total: of_all(total, &|point| point.deflection.norm()),
        };
        (plan.mean, plan.deflection) = (mean(&|point| point.score), deflection);
    }

    fn blocked(&self, placement: &Placement, none: NoFeasiblePlan) -> Blocked {
        let number = |point: usize| match &self.subset {
            Some(subset) => subset.points().get(point).copied().unwrap_or(point),
            None => point,
        };
        let scene = self.problem.scene.as_deref();
        let pair = |(pair, points): (&usize, &std::collections::BTreeSet<usize>)| {
            let names = scene?.pair(*pair)?.names.as_ref().clone();
            Some(BlockingPair { names, points: points.iter().map(|point| number(*point)).collect() })
        };
        let collisions = none.collisions.iter().filter_map(pair).collect();
        let count = none.blocked_points.len();
        let step = count.div_ceil(DIAGNOSED).max(1);
        let some = NoFeasiblePlan {
            blocked_points: none.blocked_points.iter().copied().step_by(step).collect(),
            ..NoFeasiblePlan::empty()
        };
        let mut findings = diagnose(&self.problem, placement, None, &some);
        for finding in &mut findings {
            finding.points = (number(finding.points.0), number(finding.points.1));
            finding.nearest.iter_mut().for_each(|nearest| nearest.point = number(nearest.point));
        }
        let segments = none.broken_segments.iter().map(|(segment, point)| (segment + 1, number(*point))).collect();
        Blocked { points: count, looked_at: self.problem.task.points().len(), segments, findings, collisions }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::place::score;
    use stead_numerics::monitor::Monitor;
    use stead_problem::testing::five_segments;

    const PLACE: [f64; 4] = [0.0284e-3, -1.64, -0.214, 1.378];

    #[test]
    fn a_preview_is_what_the_grid_of_the_run_comes_to() {
        let problem = five_segments();
        let placement = Placement::from(PLACE);
        let transfer = TransferSettings::default();
        let shown = PreviewProblem::new(&problem);
        let planner = shown.planner();
        let found = shown.preview(&planner, &placement, &transfer, &mut planner.workspace()).unwrap();
        let coarse = Planner::new(&problem);
        let plans = coarse.plan(&placement, Sense::Min, None, &mut coarse.workspace()).unwrap();
        let expected = problem.objective(plans.iter().map(|plan| plan.cost));
        assert!((found.plan.mean - expected).abs() < 1e-12, "{} {expected}", found.plan.mean);
        let fine = score(&problem, &placement, &transfer, &Monitor::silent()).unwrap();
        assert!(fine.plans.best.mean <= found.plan.mean && found.plan.points.len() == 105);
        assert!((found.cycle.cutting / fine.cycles.best.cutting - 1.0).abs() < 0.2);
    }

    #[test]
    fn a_placement_out_of_reach_says_which_limits_are_in_the_way() {
        let problem = five_segments();
        let shown = PreviewProblem::new(&problem);
        let planner = shown.planner();
        let far = Placement { y: -4.0, ..Placement::from(PLACE) };
        let blocked =
            shown.preview(&planner, &far, &TransferSettings::default(), &mut planner.workspace()).unwrap_err();
        assert_eq!(blocked.points, 105);
        assert!((1..=DIAGNOSED).contains(&blocked.findings.len()), "{:?}", blocked.findings);
        assert!(blocked.findings[0].to_string().contains("beyond the stretched arm"));
    }

    #[test]
    fn a_long_path_is_previewed_on_some_of_its_points_by_their_own_numbers() {
        use stead_model::task::{Task, ToolPath};
        let short = five_segments();
        // Every move in fifteen parts.
        let mut points = Vec::new();
        for (segment, span) in short.task.segments().iter().enumerate() {
            for k in span.clone() {
                let (from, to) = (short.task.points()[k], short.task.points()[(k + 1).min(span.end - 1)]);
                for part in 0..15 {
                    let share = f64::from(part) / 15.0;
                    let position = from.position + (to.position - from.position) * share;
                    if part == 0 || k + 1 < span.end {
                        points.push((segment as u32 + 1, stead_model::task::PathPoint { position, ..from }, k));
                    }
                }
            }
        }
        let wrenches = points.iter().map(|(_, _, k)| short.task.loads()[*k].wrench).collect();
        let path = ToolPath::new(points.iter().map(|(segment, point, _)| (*segment, *point))).unwrap();
        let long = short.clone().with(|parts| parts.task = Task::new(path, wrenches).unwrap());
        let shown = PreviewProblem::new(&long);
        let [looked_at, all] = shown.points();
        assert!(all == long.task.points().len() && looked_at < 200 && all > WHOLE, "{looked_at} of {all}");
        let placement = Placement::from(PLACE);
        let planner = shown.planner();
        let transfer = TransferSettings::default();
        let found = shown.preview(&planner, &placement, &transfer, &mut planner.workspace()).unwrap();
        assert!(found.plan.points.windows(2).all(|pair| pair[0].point < pair[1].point));
        assert!(found.plan.points.last().unwrap().point > all - 20);
        let whole = Planner::new(&long);
        let plans = whole.plan(&placement, Sense::Min, None, &mut whole.workspace()).unwrap();
        let expected = long.objective(plans.iter().map(|plan| plan.cost));
        assert!((found.plan.mean / expected - 1.0).abs() < 0.1, "{} {expected}", found.plan.mean);
    }
}
