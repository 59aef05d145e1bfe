//! What a placement that a subset of a long path allows comes to on the whole path, and which points decide that.

use super::path_subset::PathSubset;
use stead_model::robot::Posture;
use stead_planning::redundancy::{NoFeasiblePlan, Planner, SegmentPlan, off_grid};
use stead_problem::candidate::{Candidate, Objective};
use stead_problem::criterion::Aggregate;
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;

/// Of every stretch of points that decide, so many join a subset.
const STRETCH: usize = 3;
/// Of a placement, at most so many stretches.
const STRETCHES: usize = 12;

/// Where the objective on the coarse grid is farther than this (relative) from that on a subset, the finer grid
/// decides: between dense points a coarse grid may leave a narrow way out that the subset takes.
const AGREEMENT: f64 = 0.05;

/// The whole path on the coarse grid of beta, and on the finer one where that is too coarse.
pub(crate) struct WholePath<'a, 'p> {
    coarse: Planner<'p>,
    finer: &'a Planner<'p>,
}

/// What a placement comes to on the whole path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OnWhole {
    /// The mean score of its best plan. m
    pub mean: f64,
    /// Whether that plan is on the finer grid.
    pub is_fine: bool,
}

impl<'a, 'p> WholePath<'a, 'p> {
    pub fn new(finer: &'a Planner<'p>) -> Self {
        Self { coarse: Planner::new(finer.problem()), finer }
    }

    /// The problem on the whole path.
    pub fn problem(&self) -> &'p Problem {
        self.finer.problem()
    }

    /// The planner on the finer grid.
    pub fn finer(&self) -> &'a Planner<'p> {
        self.finer
    }

    /// The objective of a placement on the coarse grid in single precision, by which neighbours can be distinguished. m
    pub fn rough(&self, placement: &Placement, scheme: Option<&[Posture]>) -> Option<f64> {
        self.coarse.objective(placement, Sense::Min, scheme, &mut self.coarse.workspace_of::<f32>()).mean()
    }

    /// The objective of a placement that is `expected` to come to about so much (m), or points that decide against it.
    pub fn objective(
        &self,
        placement: &Placement,
        scheme: Option<&[Posture]>,
        expected: Option<f64>,
    ) -> Result<OnWhole, Vec<usize>> {
        self.objective_by(placement, scheme, expected, self.finer)
    }

    /// The same, where a planner has the last word on what has no plan on the coarse grid though every point is
    /// allowed.
    fn objective_by(
        &self,
        placement: &Placement,
        scheme: Option<&[Posture]>,
        expected: Option<f64>,
        last: &Planner<'_>,
    ) -> Result<OnWhole, Vec<usize>> {
        let on = |planner: &Planner<'_>| planner.objective(placement, Sense::Min, scheme, &mut planner.workspace());
        let last = match on(&self.coarse) {
            Objective::Feasible(mean)
                if expected.is_some_and(|expected| (mean - expected).abs() > AGREEMENT * mean) =>
            {
                let fine = on(self.finer).mean();
                return Ok(OnWhole { mean: fine.unwrap_or(mean), is_fine: fine.is_some() });
            }
            Objective::Feasible(mean) => return Ok(OnWhole { mean, is_fine: false }),
            Objective::Infeasible { points: 0, .. } => last,
            Objective::Infeasible { .. } => &self.coarse,
        };
        match last.plan(placement, Sense::Min, scheme, &mut last.workspace()) {
            Ok(plans) => {
                let mean = self.problem().objective(plans.iter().map(|plan| plan.cost));
                Ok(OnWhole { mean, is_fine: last.grid().beta_count > self.coarse.grid().beta_count })
            }
            Err(none) => Err(deciding(self.problem(), &none)),
        }
    }

    /// Whether a candidate of a subset comes to more on the whole path than the subset promises, or has no plan there.
    pub fn is_misjudged(candidate: &Candidate, mean: Option<f64>) -> bool {
        let promised = candidate.objective.mean();
        promised.is_some_and(|promised| mean.is_none_or(|mean| mean > promised * (1.0 + AGREEMENT)))
    }

    /// Points that keep the whole path from what a subset promises of a candidate: some of every stretch where the
    /// subset's plan, with beta interpolated in between, breaks a constraint; where it breaks none, the point whose
    /// score is the farthest above those of the subset's points around it.
    pub fn obstacles(&self, candidate: &Candidate, subset: &PathSubset) -> Vec<usize> {
        let problem = self.problem();
        let (placement, scheme) = (&candidate.placement, candidate.scheme.as_deref());
        let thinned = subset.of(problem);
        let planner = Planner::new(&thinned);
        let Ok(plans) = planner.plan(placement, Sense::Min, scheme, &mut planner.workspace()) else {
            return Vec::new();
        };
        let (mut blocked_points, mut highest) = (Vec::new(), None);
        for (span, plan) in problem.task.segments().iter().zip(&plans) {
            let kept = &subset.points()[plan.points.clone()];
            // Beyond the first and the last kept point beta stays.
            let around = |point: usize| {
                let after = kept.partition_point(|kept| *kept <= point);
                (after.saturating_sub(1), after.min(kept.len() - 1))
            };
            let score = |point: usize| {
                let (from, to) = around(point);
                let apart = kept[to].saturating_sub(kept[from]);
                let share = if apart > 0 { (point - kept[from]) as f64 / apart as f64 } else { 0.0 };
                let between = |a: f64, b: f64| a + share * (b - a);
                let near = std::array::from_fn(|j| between(plan.joints[from][j], plan.joints[to][j]));
                let beta = between(plan.betas[from], plan.betas[to]);
                off_grid::score(problem, placement, point, beta, plan, &near)
            };
            let of_kept: Vec<f64> = kept.iter().map(|point| score(*point).unwrap_or(0.0)).collect();
            for point in span.clone().filter(|point| kept.binary_search(point).is_err()) {
                let (from, to) = around(point);
                let ends = of_kept[from].max(of_kept[to]);
                match score(point) {
                    None => blocked_points.push(point),
                    Some(score) if highest.is_none_or(|(known, _)| score - ends > known) => {
                        highest = Some((score - ends, point));
                    }
                    Some(_) => {}
                }
            }
        }
        if blocked_points.is_empty() {
            return highest.into_iter().map(|(_, point)| point).collect();
        }
        deciding(problem, &NoFeasiblePlan { blocked_points, ..NoFeasiblePlan::empty() })
    }

    /// The objective of a candidate of a subset, none where it has no plan, and the points that decide that.
    pub fn check(&self, candidate: &Candidate) -> (Option<f64>, Vec<usize>) {
        self.check_by(candidate, self.finer)
    }

    /// The same of one of many, which is given up where the coarse grid does not get through: that a finer one does not
    /// either takes long to find out.
    pub fn check_coarsely(&self, candidate: &Candidate) -> (Option<f64>, Vec<usize>) {
        self.check_by(candidate, &self.coarse)
    }

    fn check_by(&self, candidate: &Candidate, last: &Planner<'_>) -> (Option<f64>, Vec<usize>) {
        let (placement, scheme) = (&candidate.placement, candidate.scheme.as_deref());
        let largest = self.largest(placement, scheme);
        match self.objective_by(placement, scheme, candidate.objective.mean(), last) {
            Ok(whole) => (Some(whole.mean), largest.into_iter().collect()),
            Err(points) => (None, points),
        }
    }
}

impl WholePath<'_, '_> {
    /// The point with the largest cost under the best plan of a placement, where that alone is the objective.
    fn largest(&self, placement: &Placement, scheme: Option<&[Posture]>) -> Option<usize> {
        let problem = self.problem();
        if problem.criterion.aggregate != Aggregate::Max {
            return None;
        }
        let plans = self.coarse.plan(placement, Sense::Min, scheme, &mut self.coarse.workspace()).ok()?;
        let cost = |plan: &SegmentPlan, point: usize| {
            let beta = plan.betas[point - plan.points.start];
            let state = problem.at(placement).state(point, beta, plan.posture).ok()?;
            Some((point, problem.point_cost(point, state.score())))
        };
        let costs = plans.iter().flat_map(|plan| plan.points.clone().filter_map(move |point| cost(plan, point)));
        costs.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(point, _)| point)
    }
}

/// Of the points that leave a placement without a plan, some of every stretch.
fn deciding(problem: &Problem, none: &NoFeasiblePlan) -> Vec<usize> {
    let mut points = Vec::new();
    for stretch in none.blocked_points.chunk_by(|a, b| a + 1 == *b).take(STRETCHES) {
        points.extend((0..STRETCH).map(|k| stretch[k * (stretch.len() - 1) / (STRETCH - 1)]));
    }
    for (segment, stuck) in none.broken_segments.iter().take(STRETCHES) {
        // A segment breaks between the points before and the first that cannot be reached.
        let span = &problem.task.segments()[*segment];
        points.extend((stuck.saturating_sub(2)..=stuck + 2).filter(|point| span.contains(point)));
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use stead_model::task::{PathPoint, Task, ToolPath, Wrench};
    use stead_problem::testing::five_segments;

    /// The five segments with points `from` to `from + 3` changed, which a subset of ten points leaves out, and that
    /// subset.
    fn changed(from: usize, change: impl Fn(&mut PathPoint, &mut Wrench)) -> (Problem, PathSubset) {
        let mut problem = five_segments();
        let mut wrenches: Vec<_> = problem.task.wrenches().copied().collect();
        let path = problem.task.path();
        let mut points: Vec<_> =
            (0..wrenches.len()).map(|k| (path.segment_of(k) as u32 + 1, problem.task.points()[k])).collect();
        (from..from + 3).for_each(|k| change(&mut points[k].1, &mut wrenches[k]));
        let subset = PathSubset::new(&problem.task, 10);
        assert!(subset.points().iter().all(|point| !(from..from + 3).contains(point)));
        problem.task = Task::new(ToolPath::new(points).unwrap(), wrenches).unwrap();
        (problem, subset)
    }

    /// A candidate in the middle of the cell at a yaw (rad) as the subset sees it.
    fn promised(problem: &Problem, subset: &PathSubset, yaw: f64) -> Candidate {
        let middle = |k: usize| problem.cell.position[k].min + 0.5 * problem.cell.position[k].width();
        let placement = Placement { x: middle(0), y: middle(1), z: middle(2), yaw };
        let thinned = subset.of(problem);
        let planner = Planner::new(&thinned);
        let objective = planner.objective(&placement, Sense::Min, None, &mut planner.workspace());
        Candidate { placement, scheme: None, objective }
    }

    #[test]
    fn a_stiff_corner_that_a_subset_leaves_out_is_what_decides() {
        let (problem, subset) = changed(26, |_, wrench| wrench.force *= 40.0);
        let finer = Planner::finer(&problem);
        let whole = WholePath::new(&finer);
        let obstacles = |turn: i32| whole.obstacles(&promised(&problem, &subset, 0.3 * f64::from(turn)), &subset);
        // Where the plan of the subset breaks no constraint.
        let highest: Vec<usize> = (-10..10).map(obstacles).filter(|points| points.len() == 1).flatten().collect();
        assert!(!highest.is_empty() && highest.iter().all(|point| (26..29).contains(point)), "{highest:?}");
    }

    #[test]
    fn points_where_the_plan_of_a_subset_is_forbidden_are_what_decides() {
        let (problem, subset) = changed(26, |point, _| point.position.z += 5.0);
        let finer = Planner::finer(&problem);
        let whole = WholePath::new(&finer);
        let candidate = promised(&problem, &subset, 0.0);
        assert!(whole.obstacles(&candidate, &subset).starts_with(&[26, 27, 28]));
        assert_eq!(whole.check(&candidate), (None, vec![26, 27, 28]));
    }

    #[test]
    fn more_than_a_subset_promised_or_no_plan_is_misjudged() {
        let (problem, subset) = changed(26, |_, _| {});
        let candidate = promised(&problem, &subset, 0.0);
        let mean = candidate.objective.mean().unwrap();
        let misjudged = [None, Some(1.06 * mean), Some(1.04 * mean), Some(0.5 * mean)]
            .map(|mean| WholePath::is_misjudged(&candidate, mean));
        assert_eq!(misjudged, [true, true, false, false]);
    }
}
