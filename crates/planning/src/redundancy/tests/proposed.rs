//! Plans that single precision proposes and double precision prices.

use super::super::segment::Sought;
use super::*;
use stead_problem::testing::{corners, with_turn_limits};

/// What leaves the grid costs what it does in double precision throughout, in every class that is near the cheapest.
#[test]
fn proposed_plans_cost_what_those_in_double_precision_cost() {
    let mut largest = five_segments();
    largest.criterion.aggregate = Aggregate::Max;
    let mut calm = with_axes_2_3(five_segments(), true, [-150.0, 0.0]);
    calm.criterion.joint_travel_weight = 1e-5;
    // Turns of the wrist decide.
    let wound = with_wrist(five_segments(), [(-150.0, 150.0), (-30.0, 125.0), (-170.0, 120.0)]);
    for (number, problem) in
        [five_segments(), largest, calm, wound, with_turn_limits(corners(0.15), 120, None, 3.0)].iter().enumerate()
    {
        let planner = Planner::finer(problem);
        let mut workspace = planner.workspace();
        let (mut found, mut costs) = (0, Vec::new());
        for k in 0..24 {
            let share = |step: f64| (f64::from(k) * step).fract();
            let placement =
                [-0.3 + 0.6 * share(0.618), -2.0 + 0.6 * share(0.414), -0.8 + 0.5 * share(0.732), 6.0 * share(0.236)];
            let placement = Placement::from(placement);
            let sense = if k % 2 == 0 { Sense::Min } else { Sense::Max };
            let request = segment_planner::Request { placement: &placement, sense, scheme: None };
            for segment in 0..problem.task.segments().len() {
                let exact = planner.segments.segment(segment, request, &mut workspace, Sought::Plans(0.2));
                let proposed = planner.segments.proposed(segment, request, &mut workspace, 0.2);
                assert_eq!(proposed.choices.is_empty(), exact.choices.is_empty(), "{number} {placement:?}");
                assert_eq!(proposed.blocked, exact.blocked);
                let Some((proposed, exact)) = proposed.choices.first().zip(exact.choices.first()) else { continue };
                found += 1;
                // A path that costs as much to single precision may be taken.
                costs.push((proposed.cost / exact.cost - 1.0).abs());
                let plan = joint_turns::select_joint_paths(problem, sense, vec![vec![proposed.clone()]]).remove(0);
                let replayed = off_grid::replay(problem, &placement, sense, &plan).unwrap();
                assert!((replayed.cost - proposed.cost).abs() < 1e-12 * proposed.cost.abs());
            }
        }
        costs.sort_by(f64::total_cmp);
        let worst = costs.last().copied().unwrap_or(f64::INFINITY);
        assert!(found > 10 && worst < 1e-5, "{number}: {found} {worst}");
    }
}
