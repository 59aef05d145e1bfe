//! Dense paths.

use super::*;
use nalgebra::{Matrix3, Vector3};
use stead_model::task::Wrench;

/// Numbers from 0 to 1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((self.0 >> 33) as f64) / (1u64 << 31) as f64
    }

    fn between(&mut self, min: f64, max: f64) -> f64 {
        min + (max - min) * self.next()
    }
}

/// A winding path of one segment, with a force that turns slowly.
fn winding(numbers: &mut Numbers) -> Problem {
    let mut problem = five_segments();
    if numbers.next() < 0.5 {
        problem = with_laws(problem, &[(1, compensated(0.2, 1e-6 / 3.32)), (4, stead_model::robot::Compliance::Constant(4e-6))]);
        problem.spindle = stead_model::robot::Spindle::new(
            Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.5_f64.sqrt(), -(0.5_f64.sqrt()), 0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()),
            Vector3::new(0.0, -0.25, 0.45),
        ).unwrap();
    }
    let count = numbers.between(100.0, 300.0) as usize;
    let spacing = numbers.between(0.2e-3, 1e-3);
    let bend = numbers.between(0.0, 15.0);
    let wave = numbers.between(0.02, 0.2);
    let (mut heading, mut way) = (numbers.between(-3.0, 3.0), 0.0_f64);
    let mut position = problem.task.points()[0].position;
    let (mut points, mut wrenches) = (Vec::new(), Vec::new());
    let (phase, pull) = (numbers.between(-3.0, 3.0), numbers.between(20.0, 200.0));
    for _ in 0..count {
        let feed = Vector3::new(libm::cos(heading), libm::sin(heading), 0.0);
        points.push((1, PathPoint { position, feed, axis: Vector3::z() }));
        let (sine, cosine) = libm::sincos(phase + way * 6.0 / wave);
        wrenches.push(Wrench { force: feed * (50.0 * cosine) + Vector3::new(pull * sine, pull * cosine, 20.0), moment: Vector3::zeros() });
        position += feed * spacing;
        way += spacing;
        heading += bend * libm::cos(way / wave * 6.28) * spacing;
    }
    problem.task = Task::new(ToolPath::new(points).unwrap(), wrenches).unwrap();
    problem
}

fn with_limits(problem: &Problem, rate: Option<f64>, turn: Option<f64>, speed: f64) -> Problem {
    let mut problem = problem.clone();
    let unit = 1f64.to_radians() * 1e3;
    problem.redundancy.max_beta_rate = rate.map(|r| r * unit);
    problem.redundancy.max_spindle_turn = turn.map(|r| r * unit);
    let speed = speed * unit * problem.redundancy.feed;
    let joints: [Joint; 6] = problem.robot.joints().clone().map(|j| Joint { max_speed: Some(speed), ..j });
    problem.robot = Robot::new("limited", joints).unwrap();
    problem
}

fn fine(problem: &Problem, placement: &Placement) -> Option<f64> {
    let planner = Planner::finer(problem);
    let spacing = off_grid::Spacing::full(planner.grid());
    let plans = planner.plan_fine(placement, Sense::Min, None, spacing, &mut planner.workspace()).ok()?;
    assert_sound(problem, placement, &plans);
    Some(problem.objective(plans.iter().map(|p| p.cost)))
}

fn judge(problem: &Problem, placement: &Placement, count: usize) -> Option<f64> {
    let grid = Redundancy { beta_count: count, ..problem.redundancy };
    let planner = Planner::on_grid(problem, grid, knots::Room { neighbours: 0.0, knots: 1.0 });
    let spacing = off_grid::Spacing::full(planner.grid());
    let plans = planner.plan_fine(placement, Sense::Min, None, spacing, &mut planner.workspace()).ok()?;
    Some(problem.objective(plans.iter().map(|p| p.cost)))
}

#[test]
fn experiment() {
    let mut numbers = Numbers(7);
    let number = |name: &str, or: usize| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(or);
    for k in 0..number("CASES", 6) {
        let base = winding(&mut numbers);
        let s = base.step_length(1);
        let placement = Placement::from([numbers.between(-0.3, 0.3), numbers.between(-1.9, -1.64), numbers.between(-0.6, -0.2), numbers.between(-3.0, 3.0)]);
        println!("case {k}: {} points {:.2} mm", base.task.points().len(), s * 1e3);
        let row = |rate: Option<f64>, turn: Option<f64>, speed: f64| {
            let problem = with_limits(&base, rate, turn, speed);
            let start = std::time::Instant::now();
            let found = fine(&problem, &placement);
            let time = start.elapsed().as_secs_f64();
            let steps = [rate, turn, Some(speed)].into_iter().flatten().fold(f64::INFINITY, f64::min).to_radians() * 1e3 * s;
            let count = (std::f64::consts::TAU / steps * number("PARTS", 8) as f64) as usize;
            let start = std::time::Instant::now();
            let exact = judge(&problem, &placement, count);
            let f = |x: Option<f64>| x.map_or("none".into(), |x| format!("{:.4}", x * 1e6));
            let off = found.zip(exact).map_or(f64::NAN, |(a, b)| (a / b - 1.0) * 100.0);
            println!("  rate {rate:?} turn {turn:?} speed {speed}: {} ({time:.2} s) exact {} ({count}, {:.2} s) {off:+.3} %", f(found), f(exact), start.elapsed().as_secs_f64());
        };
        for rate in [0.3, 1.0, 3.0, 30.0] { row(Some(rate), None, 1.7); }
        for turn in [1.0, 3.0] { row(None, Some(turn), 1.7); }
        for speed in [0.5, 1.0, 3.0] { row(Some(10.0), None, speed); }
    }
}
