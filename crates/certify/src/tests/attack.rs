//! Placements sought that a certificate says there are none of: random ones all over the cell and in the boxes left
//! open, and descents from these. Each is planned with every constraint, so none may be below the bound, below that of
//! the open boxes that it is in, or outside of these better than the value by more than the gap.

use super::*;
use crate::{OpenBox, certify};
use rayon::prelude::*;
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::{Planner, Workspace};
use stead_problem::sense::Sense;
use stead_problem::settings::CertificateSettings;
use stead_problem::symmetry::about_axis_1;

const GAP: f64 = 1e-3;

/// A placement of the cell: anywhere, or as near to somewhere in a box as the cell allows.
fn drawn(problem: &Problem, one: Option<&OpenBox>, random: &mut ChaCha8Rng) -> Placement {
    let cell = &problem.cell;
    let mut within = |[from, to]: [f64; 2]| from + (to - from) * random.random::<f64>();
    let [x, y, z] = cell.position.map(|i| within([i.min, i.max]));
    let anywhere = Placement { x, y, z, yaw: within([cell.yaw.min, cell.yaw.max]) };
    let Some(one) = one else { return anywhere };
    let root = problem.robot.geometry().root_in_base;
    let azimuth = libm::atan2(anywhere.y - root.y, anywhere.x - root.x);
    let (radius, (sine, cosine)) = (within(one.radius), libm::sincos(azimuth));
    let (x, y) = (root.x + radius * cosine, root.y + radius * sine);
    cell.clamp(&Placement { x, y, z: within(one.z), yaw: azimuth + within(one.turn) })
}

/// Where steps along one coordinate at a time lead to.
fn descent(problem: &Problem, start: Placement, of: &mut impl FnMut(&Placement) -> f64) -> (Placement, f64) {
    let (mut best, mut value, mut step) = (start, of(&start), 1.0);
    while step > 0.01 {
        let before = value;
        for k in 0..8 {
            let mut at = [best.x, best.y, best.z, best.yaw];
            at[k / 2] += step * if k % 2 == 0 { 0.04 } else { -0.04 };
            let placement = problem.cell.clamp(&Placement::from(at));
            let there = of(&placement);
            if there < value {
                (best, value) = (placement, there);
            }
        }
        step *= if value < before { 1.2 } else { 0.4 };
    }
    (best, value)
}

fn holds(one: &OpenBox, [radius, z, turn]: [f64; 3]) -> bool {
    let within = |[from, to]: [f64; 2], value: f64| value >= from - 1e-9 && value <= to + 1e-9;
    let [from, to] = one.turn;
    let off = stead_model::robot::angles::wrap(turn - 0.5 * (from + to));
    within(one.radius, radius) && within(one.z, z) && off.abs() <= 0.5 * (to - from) + 1e-9
}

/// How many of so many placements and descents violate a certificate, whose bounds are multiplied by a factor.
#[expect(clippy::print_stdout, reason = "a measurement prints")]
fn violations(name: &str, problem: &Problem, seconds: f64, [count, descents]: [usize; 2], factor: f64) -> usize {
    let planner = Planner::new(problem);
    let value = |placement: &Placement, workspace: &mut Workspace| {
        planner.objective(placement, Sense::Min, None, workspace).mean().unwrap_or(f64::INFINITY)
    };
    let ended = |start: Placement, workspace: &mut Workspace| {
        descent(problem, start, &mut |placement: &Placement| value(placement, workspace))
    };
    let seeds = |of: u64| move |k: usize| seeded(of + k as u64);
    let found = (0..40_usize)
        .into_par_iter()
        .map_init(|| planner.workspace(), |workspace, k| ended(drawn(problem, None, &mut seeds(0)(k)), workspace));
    let found = found.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    let settings = CertificateSettings { time_limit: Some(seconds), ..CertificateSettings::new(GAP) };
    let proof = certify(problem, &found.0, found.1, None, settings, &Monitor::silent()).best.unwrap();
    let boxes = proof.open_boxes(problem);
    println!("{name}: value {:.5} mm, bound {:.5} mm, {} open", found.1 * 1e3, proof.bound.bound * 1e3, boxes.len());
    let least = |placement: &Placement| {
        let at = about_axis_1(problem, placement);
        let inside = boxes.iter().filter(|one| holds(one, at)).map(|one| one.bound).fold(f64::INFINITY, f64::min);
        let closed = found.1 * (1.0 - GAP);
        factor * proof.bound.bound.max(if inside < f64::INFINITY { inside } else { closed })
    };
    let started = |k: usize, random: &mut ChaCha8Rng| {
        let is_open = k % 2 == 1 && !boxes.is_empty();
        let one = is_open.then(|| &boxes[random.random_range(0..boxes.len())]);
        drawn(problem, one, random)
    };
    let random = (0..count).into_par_iter().map_init(
        || planner.workspace(),
        |workspace, k| {
            let placement = started(k, &mut seeds(1000)(k));
            (placement, value(&placement, workspace))
        },
    );
    let ends = (0..descents)
        .into_par_iter()
        .map_init(|| planner.workspace(), |workspace, k| ended(started(1, &mut seeds(500_000)(k)), workspace));
    let all: Vec<(Placement, f64)> = random.chain(ends).collect();
    let planned = all.iter().filter(|(_, value)| value.is_finite()).count();
    let wrong = all.iter().filter(|(placement, value)| *value < least(placement) * (1.0 - 1e-7)).count();
    let best = all.iter().map(|(_, value)| *value).fold(f64::INFINITY, f64::min);
    println!("{count} placements, {descents} descents: {planned} planned, best {:.5} mm, {wrong} wrong", best * 1e3);
    wrong
}

#[test]
#[ignore = "a measurement: minutes"]
fn no_placement_is_better_than_a_certificate_allows() {
    let mut leant = leaning(five_segments(), 20.0);
    leant.cell.position = [(0.0, 0.1), (-1.74, -1.64), (-0.3, -0.214)].map(|(min, max)| Interval { min, max });
    leant.cell.yaw = Interval { min: 0.0, max: 2.0 };
    let mut odd = odd_arm();
    odd.constraints.min_inverse_condition = 0.26;
    let all = [("KR 270, tool leans", leant), ("odd arm", odd), ("KR 270", five_segments())];
    for (name, problem) in all {
        assert_eq!(violations(name, &problem, 120.0, [10_000, 200], 1.0), 0, "{name}");
    }
    assert!(violations("bounds a tenth too high", &five_segments(), 60.0, [100, 20], 1.1) > 0);
}
