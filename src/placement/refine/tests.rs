//! The refinement: exact gradients, never worse, never infeasible.

use super::*;
use crate::placement::testing::five_segments;
use crate::robot::angles::yaw_from_q4;

#[test]
fn zz() {
    let problem = five_segments();
    let planner = Planner::new(&problem);
    for (goal, pose) in [
        (Goal::Best, [2.2e-3, -1.6435, -0.5564, yaw_from_q4(0.9258)]),
        (Goal::Best, [0.0, -1.7, -0.4, 0.7]),
        (Goal::Worst, [0.0, -2.0, -0.4, 2.2]),
        (Goal::Worst, [0.2, -2.1, -0.3, -2.2]),
    ] {
        let t = std::time::Instant::now();
        if let Some((s, r)) = refine(&planner, &pose, goal, None) {
            println!("{:?} {:#?}", t.elapsed(), r);
            println!("{:?}", s.plans.iter().map(|p| p.posture.number()).collect::<Vec<_>>());
        }
    }
}
