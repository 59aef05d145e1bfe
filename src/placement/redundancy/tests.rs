//! The planner against check values, and against plain dynamic programming over every real configuration.

use super::*;
use crate::placement::criterion::state;
use crate::placement::testing::five_segments;
use crate::robot::angles::yaw_from_q4;
use crate::robot::{Joint, Robot};

fn published_optimum() -> [f64; 4] {
    [2.2e-3, -1.6435, -0.5564, yaw_from_q4(0.9258)]
}

/// Every joint may step by 10 deg in 10 mm, as in the prototype.
fn with_prototype_steps(mut problem: Problem) -> Problem {
    let speed = 10.0_f64.to_radians() * problem.redundancy.feed / 0.010;
    let joints: [Joint; 6] = problem.robot.joints().clone().map(|j| Joint { max_speed: Some(speed), ..j });
    problem.robot = Robot::new("stepped", joints).unwrap();
    problem
}

fn worth(problem: &Problem, pose: &[f64; 4], extremum: Extremum) -> Worth {
    let planner = Planner::new(problem);
    let mut workspace = planner.workspace();
    planner.worth(pose, extremum, None, &mut workspace)
}

#[test]
fn zz_check() {
    let problem = with_prototype_steps(five_segments());
    println!(
        "{:?} {:?}",
        worth(&problem, &published_optimum(), Extremum::Smallest),
        worth(&problem, &published_optimum(), Extremum::Largest)
    );
    let planner = Planner::new(&problem);
    let mut workspace = planner.workspace();
    let t = std::time::Instant::now();
    for _ in 0..100 {
        planner.worth(&published_optimum(), Extremum::Smallest, None, &mut workspace);
    }
    println!("{:?}", t.elapsed() / 100);
    let t = std::time::Instant::now();
    let mut plan = planner.plan(&published_optimum(), Extremum::Smallest, None, &mut workspace).unwrap();
    println!("{:?}", t.elapsed());
    for p in &plan {
        println!("{} {:?} {}", p.posture, p.points, p.cost);
    }
    let t = std::time::Instant::now();
    for p in &mut plan {
        fine::refine(&problem, &published_optimum(), Extremum::Smallest, fine::Tube::full(&problem), p);
    }
    println!("{:?} {}", t.elapsed(), plan.iter().map(|p| p.cost).sum::<f64>() / 105.0);
}
