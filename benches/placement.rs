//! Speed of the evaluator and of the planner on the published case: `cargo bench`.
//!
//! The number after a name is the kind of instructions: 0 plain, then what else the processor has (AVX2, AVX-512).
//!
//! `evaluator` counts poses: path point x beta, all posture classes, with joint angles, limits, 1/kappa and score.
//! `planner` counts edges: for each allowed state every predecessor within the band of beta, with the joint steps
//! checked. `worth` is both together, once per placement.

#![allow(clippy::expect_used, reason = "a benchmark of shipped files")]

mod published;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use nalgebra::{Matrix3, Matrix6, Vector3};
use published::{poses, problem};
use stead_model::robot::{BaseCompliance, NormalSprings, PostureClass, SpringModel};
use stead_numerics::simd::Instructions;
use stead_planning::redundancy::Planner;
use stead_planning::redundancy::transition::{self, Step};
use stead_problem::evaluate::batch::{BatchEvaluator, Flips, StateGrid};
use stead_problem::problem::{Placement, Problem, ProblemParts};
use stead_problem::sense::Sense;

fn main() {
    divan::main();
}

#[divan::bench(args = instructions())]
fn evaluator(bencher: Bencher, instructions: usize) {
    evaluate(bencher, instructions, &problem());
}

/// With springs normal to the axes, alike about x and y, those of the wrist in its centre.
#[divan::bench(args = instructions())]
fn evaluator_of_full_arm(bencher: Bencher, instructions: usize) {
    evaluate(bencher, instructions, &full(problem(), false));
}

/// With springs that differ about x and y, joint 4 off the wrist centre, and base, mount, tip and part.
#[divan::bench(args = instructions())]
fn evaluator_of_everything(bencher: Bencher, instructions: usize) {
    let problem = full(problem(), true);
    let part = vec![Matrix3::from_diagonal_element(1e-7); problem.task.points().len()];
    let base = BaseCompliance::new(Vector3::new(0.0, 0.0, -0.5), Matrix6::from_diagonal_element(1e-8));
    let everything = problem.changed(|parts| {
        parts.robot = parts.robot.clone().with_base_compliance(base.ok());
        parts.spindle.mount = Some(Matrix6::from_diagonal_element(1e-8));
        parts.spindle.tip = Some(Matrix3::from_diagonal_element(1e-7));
        parts.task = parts.task.clone().with_part_compliances(part).expect("a compliance");
    });
    evaluate(bencher, instructions, &everything.expect("parts that agree"));
}

/// The problem with springs about three directions of every joint.
fn full(problem: Problem, are_pairs: bool) -> Problem {
    let springs = std::array::from_fn(|joint| match are_pairs {
        true => NormalSprings { compliance: [3e-7, 5e-7], bearing: [-0.3, 0.2, 0.3, -0.6, 0.0, 0.0][joint] },
        false => NormalSprings { compliance: [4e-7; 2], bearing: 0.0 },
    });
    let change = |parts: &mut ProblemParts| {
        let robot = parts.robot.clone().with_normal_springs(Some(springs)).expect("springs");
        parts.robot = robot.with_spring_model(Some(SpringModel::Full));
    };
    problem.changed(change).expect("parts that agree")
}

fn evaluate(bencher: Bencher, instructions: usize, problem: &Problem) {
    let evaluator = BatchEvaluator::new(problem, &problem.redundancy, Flips::Both)
        .with_instructions(Instructions::all()[instructions]);
    let mut states = StateGrid::<f64>::new(problem.redundancy.beta_count, 3);
    let points = problem.task.points().len();
    let poses = poses(20);
    bencher.counter(ItemsCount::new(poses.len() * points * problem.redundancy.beta_count)).bench_local(|| {
        for pose in &poses {
            for point in 0..points {
                evaluator.evaluate(point, black_box(pose), &mut states);
            }
        }
    });
}

/// Every way of using the processor that it has, the plain one first.
fn instructions() -> Vec<usize> {
    (0..Instructions::all().len()).collect()
}

#[divan::bench(args = instructions())]
fn planner(bencher: Bencher, instructions: usize) {
    let problem = problem();
    let planner = Planner::new(&problem);
    let evaluator = BatchEvaluator::new(&problem, &problem.redundancy, Flips::Both);
    let count = problem.redundancy.beta_count;
    let pose = Placement::from([0.0, -1.64, -0.214, 1.378]);
    let step =
        |point: usize| Step { instructions: Instructions::all()[instructions], ..planner.step(point, Sense::Min) };
    // One segment, so that its states stay as near to the processor as those of the planner, which keeps two points.
    let span = problem.task.segments()[2].clone();
    let mut segment: Vec<(Step, StateGrid)> = span
        .map(|point| {
            let mut states = StateGrid::<f64>::new(count, planner.pad());
            evaluator.evaluate(point, &pose, &mut states);
            PostureClass::ALL.into_iter().for_each(|class| states.wrap_around(class));
            (step(point), states)
        })
        .collect();
    let alive = |(_, states): &(Step, StateGrid)| PostureClass::ALL.map(|class| states.is_alive(class));
    assert!(segment.iter().all(|item| alive(item) == alive(&segment[0])), "a class ends within the segment");
    let classes: Vec<PostureClass> =
        PostureClass::ALL.into_iter().filter(|class| segment[0].1.is_alive(*class)).collect();
    let scores =
        |states: &StateGrid| classes.iter().flat_map(|class| states.scores(*class)).copied().collect::<Vec<_>>();
    let kept: Vec<Vec<f64>> = segment.iter().map(|(_, states)| scores(states)).collect();
    let edges: usize = segment[1..]
        .iter()
        .map(|(step, states)| {
            let allowed = classes.iter().flat_map(|class| states.inner_scores(*class));
            allowed.filter(|score| score.is_finite()).count() * step.change.count()
        })
        .sum();
    let mut way = vec![0; count];
    bencher.counter(ItemsCount::new(edges)).bench_local(|| {
        // The scores as the evaluator left them, in place of the costs of the last time.
        for ((_, states), kept) in segment.iter_mut().zip(&kept) {
            for (class, kept) in classes.iter().zip(kept.chunks(kept.len() / classes.len())) {
                states.scores_mut(*class).copy_from_slice(kept);
            }
        }
        for class in &classes {
            transition::begin(&mut segment[0].1, *class, 1.0);
            for place in 1..segment.len() {
                let (before, now) = segment.split_at_mut(place);
                let (before, (step, now)) = (&before[place - 1].1, &mut now[0]);
                transition::advance(before, now, *class, step, &mut way);
                now.wrap_around(*class);
            }
        }
    });
}

#[divan::bench]
fn objective(bencher: Bencher) {
    let problem = problem();
    let planner = Planner::new(&problem);
    let mut workspace = planner.workspace();
    let poses = poses(20);
    bencher.counter(ItemsCount::new(poses.len())).bench_local(|| {
        for pose in &poses {
            black_box(planner.objective(pose, Sense::Min, None, &mut workspace));
        }
    });
}
