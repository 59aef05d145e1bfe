//! The published case, for the benchmarks of the placement.

use std::path::Path;
use stead_problem::problem::{Placement, Problem};
use stead_run_files::read_run;

/// The problem of the shipped run.
pub fn problem() -> Problem {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/caro-2013.toml");
    read_run(&file).expect("the shipped run is valid").problem
}

/// So many placements (x, y, z in m, yaw in rad) spread over the cell.
pub fn poses(count: usize) -> Vec<Placement> {
    let share = |k: usize, n: usize| (k * 7 % n) as f64 / n as f64;
    (0..count)
        .map(|k| {
            Placement::from([
                -0.3 + 0.6 * share(k, 20),
                -2.24 + 0.6 * share(k, 11),
                -0.6 + 0.38 * share(k, 13),
                -3.1 + 6.2 * share(k, 17),
            ])
        })
        .collect()
}
