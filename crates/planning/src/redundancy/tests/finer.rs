//! Objectives on two grids.

use super::*;
use stead_problem::testing::{corners, with_turn_limits};

/// Corners at a feed at which a grid of 10 deg does not get around them, and a segment of the first points alone.
fn two_segments() -> Problem {
    let mut problem = with_turn_limits(corners(0.15), 36, None, 1.0);
    problem.redundancy.feed *= 4.0;
    let all = problem.task.points().to_vec();
    let points = all.iter().map(|point| (1, *point)).chain(all[..3].iter().map(|point| (2, *point)));
    let path = ToolPath::new(points).unwrap();
    let wrenches = vec![problem.task.loads()[0].wrench; all.len() + 3];
    problem.task = Task::new(path, wrenches).unwrap();
    problem
}

/// Segments that the coarse grid does not get through cost what they cost on the finer one, the others what they cost
/// on the coarse one; where that has a plan for all, or points are blocked, it alone decides.
#[test]
fn segments_that_a_grid_does_not_get_through_are_planned_on_the_finer_one() {
    let problem = two_segments();
    let (coarse, fine) = (Planner::new(&problem), Planner::finer(&problem));
    let both = coarse.clone().with_finer(&fine);
    let (mut on_coarse, mut on_fine, mut on_both) = (coarse.workspace(), fine.workspace(), both.workspace());
    let (mut mixed, mut refused) = (0, 0);
    for k in 0..40 {
        let share = |step: f64| (f64::from(k) * step).fract();
        let placement =
            [-0.2 + 0.5 * share(0.618), -1.9 + 0.5 * share(0.414), -0.6 + 0.4 * share(0.732), 6.0 * share(0.236)];
        let placement = Placement::from(placement);
        let found = both.objective(&placement, Sense::Min, None, &mut on_both);
        let alone = coarse.objective(&placement, Sense::Min, None, &mut on_coarse);
        if !matches!(alone, Objective::Infeasible { points: 0, .. }) {
            assert_eq!(found, alone);
            continue;
        }
        let of_coarse = coarse.segment_costs(&placement, &mut on_coarse).remove(0);
        let of_fine = fine.segment_costs(&placement, &mut on_fine).remove(0);
        let costs: Vec<Option<f64>> = of_coarse.iter().zip(&of_fine).map(|(cost, fine)| cost.or(*fine)).collect();
        let expected: Option<Vec<f64>> = costs.iter().copied().collect();
        assert_eq!(found.mean(), expected.map(|costs| problem.objective(costs)));
        mixed += usize::from(found.mean().is_some() && of_coarse.iter().any(Option::is_some));
        refused += usize::from(found.mean().is_none());
    }
    assert!(mixed > 20 && refused > 0, "{mixed} {refused}");
}
