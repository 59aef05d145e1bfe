//! Layer by layer: a cell of heading, a box, the whole search; the cell with mutations that must be noticed.

use super::super::branch_and_bound::Status;
use super::super::upper_bound::BoxBounds;
use super::*;
use crate::compliance_table::{AffineModel, Node};
use crate::cost::CORNERS;
use crate::relaxed::{relaxed_value, score};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};
use stead_model::robot::PostureClass;
use stead_numerics::monitor::StopHandle;
use stead_planning::redundancy::Planner;
use stead_problem::problem::{Interval, Placement};
use stead_problem::sense::Sense;
use stead_problem::settings::CertificateSettings;
use stead_problem::testing::five_segments;

/// A placement of a region; the azimuth is that of the middle of the paper's cell.
fn placed(problem: &Problem, [radius, height, turn]: [f64; 3]) -> Placement {
    let root = problem.robot.geometry().root_in_base;
    let azimuth = -PI / 2.0;
    let (sine, cosine) = libm::sincos(azimuth);
    Placement { x: root.x + radius * cosine, y: root.y + radius * sine, z: root.z + height, yaw: turn + azimuth }
}

fn somewhere(random: &mut ChaCha8Rng, size: f64) -> Region {
    let mut from = |a: f64, b: f64| a + (b - a) * random.random::<f64>();
    let middle = [from(1.66, 2.24), from(-0.6, -0.22), from(-PI, PI)];
    let half = [0.009, 0.0125, 0.0157].map(|h| h * size * from(0.5, 1.0));
    Region { middle, half }
}

/// Corner k of a box, in the order of [`PointCost::most`].
fn corner(region: &Region, k: usize) -> [f64; 3] {
    std::array::from_fn(|i| region.middle[i] + region.half[i] * if k >> i & 1 == 1 { 1.0 } else { -1.0 })
}

/// Over many cells, how often a corner of a box has no heading in a cell that costs as little as is said, or one that
/// costs more; what is known of the cell may be tampered with.
fn violations(tamper: impl Fn(&mut AffineModel)) -> (usize, usize) {
    let problem = five_segments();
    let model = without_rate(&problem);
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let silent = &Monitor::silent();
    let (mut looked, mut wrong) = (0, 0);
    while looked < 300 {
        let size = [1.2, 0.6, 0.3][looked % 3];
        let region = somewhere(&mut random, size);
        let Some(over) = BoxBounds::new(&model, &region, silent) else { continue };
        let point = random.random_range(0..over.points.len());
        let cell = random.random_range(0..model.table.headings(over.level));
        let class = PostureClass::ALL[random.random_range(0..4)];
        let pointwise = over.points[point].as_ref().unwrap();
        let (at, off) = model.table.nearest(over.level, pointwise.placed.r, pointwise.placed.z).unwrap();
        let Node::Known(mut known) = *model.table.nodes_at(&model.arm, over.level, at).known(cell, class).0 else {
            continue;
        };
        tamper(&mut known);
        if !known.sure {
            continue;
        }
        looked += 1;
        let half_cell = PI / model.table.headings(over.level) as f64;
        let heading = model.table.heading(over.level, cell);
        let [chosen, all] =
            [true, false].map(|choice| pointwise.max_cost((&known, None), off, half_cell, &region, choice));
        for k in 0..CORNERS {
            let place = corner(&region, k);
            let p = placed(&problem, place);
            let chi = model.points[point].over(&Region { middle: place, half: [0.0; 3] }).unwrap().chi;
            let costs: Vec<f64> = (0..=40)
                .map(|k| heading + half_cell * (f64::from(k) / 20.0 - 1.0) - chi)
                .map(|beta| score(&problem, &p, point, class, beta))
                .collect();
            let (min, max) = costs.iter().fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), c| (a.min(*c), b.max(*c)));
            // A zero between two of the headings is not met: what neighbours differ by.
            let missed = costs.windows(2).map(|c| (c[0] - c[1]).abs()).filter(|d| d.is_finite()).fold(0.0, f64::max);
            wrong += usize::from(min - missed > chosen[k] || max > all[k] * (1.0 + 1e-9));
        }
    }
    (looked, wrong)
}

#[test]
fn cells_cost_no_more_than_is_said() {
    assert_eq!(violations(|_| {}), (300, 0));
}

#[test]
fn tampered_cells_are_noticed() {
    assert!(violations(|known| known.remainder = known.remainder.times([0.0; 4])).1 > 0);
    assert!(violations(|known| known.sure = true).1 > 0);
}

#[test]
fn boxes_are_worth_no_more_than_is_said() {
    let problem = five_segments();
    let model = without_rate(&problem);
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let silent = &Monitor::silent();
    let (mut tight, mut nothing) = (0, 0);
    for k in 0..9 {
        let region = somewhere(&mut random, [0.6, 0.2, 0.1][k % 3]);
        let over = BoxBounds::new(&model, &region, silent).unwrap();
        let (sum, seen) = over.upper_bound(&Inherited::nothing(&model), 0.0);
        let (again, _) = over.upper_bound(&seen, f64::MAX);
        let bound = sum / over.points.len() as f64;
        let place = std::array::from_fn(|i| region.middle[i] + region.half[i] * random.random_range(-1.0..1.0));
        match relaxed_value(&problem, &placed(&problem, place), &Monitor::silent()) {
            Some(value) => {
                assert!(value <= bound && value * over.points.len() as f64 <= again, "{value} {bound} {region:?}");
                tight += usize::from(bound < 1.1 * value);
            }
            None => nothing += usize::from(bound == f64::NEG_INFINITY),
        }
    }
    assert!(tight >= 1, "{tight} {nothing}");
}

#[test]
fn the_relaxed_value_is_that_of_a_plan_without_limits_between_points() {
    let mut problem = five_segments();
    problem.redundancy.max_beta_rate = Some(1e9);
    let planner = Planner::new(&problem);
    for yaw in [-2.6, 1.4] {
        let placement = Placement { x: 0.0, y: -1.9, z: -0.214, yaw };
        let relaxed = relaxed_value(&problem, &placement, &Monitor::silent());
        let plan = planner.objective(&placement, Sense::Min, None, &mut planner.workspace()).mean();
        match (relaxed, plan) {
            (Some(relaxed), Some(plan)) => assert!(relaxed <= plan && plan < 1.05 * relaxed, "{relaxed} {plan}"),
            (relaxed, plan) => assert!(plan.is_none(), "{relaxed:?} {plan:?}"),
        }
    }
}

/// Asks a job to stop at its n-th report.
fn stopped_at(reports: usize) -> Monitor {
    let (stop, seen) = (StopHandle::default(), AtomicUsize::new(0));
    let handle = stop.clone();
    Monitor::new(move |_| {
        if seen.fetch_add(1, Ordering::SeqCst) + 1 >= reports {
            handle.stop();
        }
    })
    .with_stop(stop)
}

/// A small cell about the worst placement, with that placement.
fn corner_of_the_cell() -> (Problem, Placement) {
    let mut problem = five_segments();
    let interval = |min, max| Interval { min, max };
    problem.cell.position = [interval(-0.3, -0.29), interval(-2.24, -2.23), interval(-0.22, -0.214)];
    problem.cell.yaw = interval((-156.0_f64).to_radians(), (-146.0_f64).to_radians());
    (problem, Placement { x: -0.3, y: -2.24, z: -0.214, yaw: (-151.3731_f64).to_radians() })
}

#[test]
fn the_worst_of_a_small_cell_is_certified_whatever_the_threads() {
    let (problem, placement) = corner_of_the_cell();
    let value = relaxed_value(&problem, &placement, &Monitor::silent()).unwrap();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| worst(&problem, value, &CertificateSettings::new(5e-3), &Monitor::silent()).unwrap())
    };
    let one = run(1);
    assert_eq!(one.status, Status::Reached, "{} {}", one.bound, one.nodes);
    assert!(one.bound >= value && one.gap() <= 5e-3 && one.open.is_empty());
    assert_eq!(one, run(3));
}

/// A value that others get past is no reason to blame the tables: the search goes on with the worst placement that it
/// meets.
#[test]
fn a_worse_placement_that_is_met_takes_the_place_of_the_one_known() {
    let (problem, placement) = corner_of_the_cell();
    let value = relaxed_value(&problem, &placement, &Monitor::silent()).unwrap();
    let found = worst(&problem, 0.98 * value, &CertificateSettings::new(1e-3), &Monitor::silent()).unwrap();
    assert_eq!(found.status, Status::Reached, "{} {}", found.bound, found.value);
    assert!(
        found.value >= value * (1.0 - 1e-3) && found.bound >= value && found.gap() <= 1e-3 && found.open.is_empty()
    );
    let met = found.met.unwrap();
    assert!(problem.cell.contains(&met));
    assert_eq!(relaxed_value(&problem, &met, &Monitor::silent()), Some(found.value));
}

#[test]
fn what_is_ended_early_is_a_bound_all_the_same() {
    let (problem, placement) = corner_of_the_cell();
    let value = relaxed_value(&problem, &placement, &Monitor::silent()).unwrap();
    let found = worst(&problem, 0.5 * value, &CertificateSettings::new(1e-3), &stopped_at(12)).unwrap();
    assert_eq!(found.status, Status::Interrupted);
    assert!(found.bound >= value && !found.open.is_empty());
}

#[test]
#[ignore = "the whole of the paper's cell: a quarter of a minute in release"]
fn the_worst_of_the_papers_cell_is_certified() {
    let problem = five_segments();
    let (_, placement) = corner_of_the_cell();
    let value = relaxed_value(&problem, &placement, &Monitor::silent()).unwrap();
    let found = worst(&problem, value, &CertificateSettings::new(1e-3), &Monitor::silent()).unwrap();
    assert_eq!(found.status, Status::Reached);
    assert!(found.bound >= value && found.gap() <= 1e-3);
}
