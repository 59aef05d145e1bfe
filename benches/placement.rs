//! Speed of the kernel and of the planner on the published case: `cargo bench`.
//!
//! `kernel` counts poses: path point x beta, all posture classes, with joint angles, limits, 1/kappa and score. `planner`
//! counts edges: for each allowed state every predecessor within the band of beta, with the joint steps checked. `worth` is
//! both together, once per placement.

#![allow(clippy::expect_used, reason = "a benchmark of shipped files")]

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use std::path::Path;
use stead::config::read_run;
use stead::placement::kernel::{Flips, Kernel, States};
use stead::placement::problem::Problem;
use stead::placement::redundancy::{Extremum, Planner, band};
use stead::robot::PostureClass;

fn main() {
    divan::main();
}

fn problem() -> Problem {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/caro-2013.toml");
    read_run(&file).expect("the shipped run is valid").problem
}

/// Placements spread over the cell.
fn poses() -> Vec<[f64; 4]> {
    let share = |k: usize, n: usize| (k * 7 % n) as f64 / n as f64;
    (0..20)
        .map(|k| {
            [
                -0.3 + 0.6 * share(k, 20),
                -2.24 + 0.6 * share(k, 11),
                -0.6 + 0.38 * share(k, 13),
                -3.1 + 6.2 * share(k, 17),
            ]
        })
        .collect()
}

#[divan::bench]
fn kernel(bencher: Bencher) {
    let problem = problem();
    let kernel = Kernel::new(&problem, &problem.redundancy, Flips::Both);
    let mut states = States::new(problem.redundancy.beta_count, 3);
    let points = problem.task.points().len();
    let poses = poses();
    bencher.counter(ItemsCount::new(poses.len() * points * problem.redundancy.beta_count)).bench_local(|| {
        for pose in &poses {
            for point in 0..points {
                kernel.evaluate(point, black_box(pose), &mut states);
            }
        }
    });
}

#[divan::bench]
fn planner(bencher: Bencher) {
    let problem = problem();
    let planner = Planner::new(&problem);
    let kernel = Kernel::new(&problem, &problem.redundancy, Flips::Both);
    let count = problem.redundancy.beta_count;
    let pose = [0.0, -1.64, -0.214, 1.378];
    let segments: Vec<Vec<(usize, States)>> = problem
        .task
        .segments()
        .iter()
        .map(|span| {
            let evaluated = span.clone().map(|point| {
                let mut states = States::new(count, planner.pad());
                kernel.evaluate(point, &pose, &mut states);
                PostureClass::ALL.into_iter().for_each(|class| states.wrap_around(class));
                (point, states)
            });
            evaluated.collect()
        })
        .collect();
    let edges: usize = segments
        .iter()
        .flat_map(|segment| &segment[1..])
        .map(|(point, states)| {
            let allowed = PostureClass::ALL.into_iter().flat_map(|class| states.inner_scores(class));
            allowed.filter(|score| score.is_finite()).count() * (2 * planner.step(*point, Extremum::Smallest).reach + 1)
        })
        .sum();
    let mut way = vec![0; count];
    bencher.counter(ItemsCount::new(edges)).with_inputs(|| segments.clone()).bench_local_refs(|segments| {
        for segment in segments {
            for class in PostureClass::ALL {
                band::begin(&mut segment[0].1, class, 1.0);
                for place in 1..segment.len() {
                    let (before, now) = segment.split_at_mut(place);
                    let (before, (point, now)) = (&before[place - 1].1, &mut now[0]);
                    if before.is_alive(class) && now.is_alive(class) {
                        band::advance(before, now, class, &planner.step(*point, Extremum::Smallest), &mut way);
                        now.wrap_around(class);
                    }
                }
            }
        }
    });
}

#[divan::bench]
fn worth(bencher: Bencher) {
    let problem = problem();
    let planner = Planner::new(&problem);
    let mut workspace = planner.workspace();
    let poses = poses();
    bencher.counter(ItemsCount::new(poses.len())).bench_local(|| {
        for pose in &poses {
            black_box(planner.worth(pose, Extremum::Smallest, None, &mut workspace));
        }
    });
}
