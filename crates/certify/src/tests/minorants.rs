//! The coarse tables: minorants whatever the heading, and the coarser levels above them.

use super::super::cell::Extent;
use super::super::coarse_bounds::{CoarseBounds, below_all};
use super::super::compliance_table::{AffineModel, ComplianceTable, Node, Steps};
use super::super::cost::Direction;
use super::super::kind::{Kind, kinds};
use super::super::load::Load;
use super::super::minorant::{Affine, Around, EMPTY, ModelledRegion, OfKind, ZERO};
use super::*;
use stead_model::testing::some;
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::Planner;
use stead_problem::sense::Sense;

/// The same with a table of other steps, of nodes about some radii and heights only.
pub fn local(setting: &Setting, radius: (f64, f64), height: (f64, f64), steps: Steps, levels: usize) -> Model {
    let b = &setting.model;
    Model {
        arm: b.arm.clone(),
        table: ComplianceTable::new(Extent { radius, height }, steps, levels).into(),
        points: b.points.clone(),
        segments: b.segments.clone(),
        keeps: b.keeps,
        changes: b.changes.clone(),
        others: [].into(),
        over: b.over,
        yaws: b.yaws.clone(),
        objective: b.objective,
    }
}

fn at(e: &Affine, off: [f64; 3]) -> f64 {
    f64::from(e.value) + (0..3).map(|k| f64::from(e.slope[k]) * off[k]).sum::<f64>()
}

/// What is done to the minorant of a node before it is held against the truth.
pub struct Mutation {
    name: &'static str,
    known: fn(&mut AffineModel),
    states: fn(&mut Vec<ModelledRegion>),
    joint1: f64,
    chi: f64,
    /// What the spread of the loads of a kind is multiplied by, where another load stands for that of the point; none
    /// where it stands for itself.
    spread: Option<f64>,
}

pub const SOUND: Mutation =
    Mutation { name: "sound", known: |_| {}, states: |_| {}, joint1: 1.0, chi: 1.0, spread: None };

/// A kind of load for a point, and how many times as large its own is (f32, as minorants are).
fn kind_of(model: &Model, point: usize, spread: Option<f64>) -> (Kind, f32) {
    let own = model.points[point].load;
    let Some(times) = spread else {
        return (Kind { load: own, force_spread: 0.0, moment_spread: 0.0, part_spread: 0.0 }, 1.0);
    };
    let far = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let size = far(own.force, [0.0; 3]);
    let unit = |v: [f64; 3]| v.map(|x| x / size);
    // A tenth larger everywhere, so that a bound without the spread is too high.
    let load = Load {
        force: unit(own.force).map(|f| 1.1 * f),
        moment: unit(own.moment).map(|m| 1.1 * m),
        error: own.error / size,
        ..own
    };
    let (force_spread, moment_spread) = (far(load.force, unit(own.force)), far(load.moment, unit(own.moment)));
    let (force_spread, moment_spread) = (times * force_spread, times * moment_spread);
    (Kind { load, force_spread, moment_spread, part_spread: 0.0 }, size as f32)
}

/// The states about the only node of a table, with their models changed.
fn states(model: &Model, class: PostureClass, mutation: &Mutation) -> Option<Vec<ModelledRegion>> {
    let table = &model.table;
    let node = table.place(0, [1, 1]);
    let mut found = Vec::new();
    for cell in 0..table.headings(0) {
        let (node_at, moments) = table.nodes_at(&model.arm, 0, [1, 1]).known(cell, class);
        match node_at {
            Node::Empty => {}
            Node::Unknown => return None,
            Node::Known(known) => {
                let mut known = *known;
                (mutation.known)(&mut known);
                let half = [table.length(0), table.length(0), PI / table.headings(0) as f64];
                let first = model.arm.joint1 * mutation.joint1;
                found.push(ModelledRegion::new((&known, moments), half, [node[0], first], [0.0, 0.0]));
            }
        }
    }
    (mutation.states)(&mut found);
    Some(found)
}

/// Violations of minorants about random nodes, at corners and in between, over all headings; and how many were
/// compared.
pub fn violations(setting: &Setting, steps: Steps, mutation: &Mutation) -> [usize; 2] {
    let mut random = seeded(21);
    let (mut wrong, mut compared) = (0, 0);
    let turn = TAU / steps.headings as f64;
    for _ in 0..24 {
        let (point, place) = anywhere(setting, &mut random);
        let Some((class, _)) = setting.random_state(&mut random, point, place) else { continue };
        let along = |v: f64| (v - steps.length, v + steps.length);
        let model = local(setting, along(place[0]), along(place[1]), steps, 1);
        let Some(found) = states(&model, class, mutation) else { continue };
        let load = &model.points[point].load;
        let half = [steps.length, steps.length, turn * mutation.chi];
        let direction = Direction::new(place[2] + load.turn);
        // The load of another point stands for it, as coarse tables have kinds of load.
        let (kind, size) = kind_of(&model, point, mutation.spread);
        let mut e = OfKind::new(&found, &kind, random.random()).minorant(&direction, half);
        e.value *= size;
        e.slope = e.slope.map(|slope| slope * size);
        if e == ZERO {
            continue;
        }
        for _ in 0..6 {
            let s = shares(&mut random);
            let off = [s[0] * steps.length, s[1] * steps.length, s[2] * turn];
            let moved: [f64; 3] = std::array::from_fn(|k| place[k] + off[k]);
            let below = at(&e, off);
            for k in 0..2 * steps.headings {
                let heading = PI / steps.headings as f64 * k as f64;
                let Some(truth) = setting.truth(point, moved, heading, class) else { continue };
                compared += 1;
                wrong += usize::from(truth.score < below);
            }
        }
    }
    [wrong, compared]
}

const COARSE: Steps = Steps { length: 0.025, headings: 128 };
pub const FINE: Steps = Steps { length: 0.002, headings: 512 };

#[test]
fn minorants_are_below_the_cost_at_every_heading() {
    let criteria = Setting::criteria().into_iter().map(|one| (one, &[FINE][..]));
    let all = Setting::all().into_iter().map(|one| (one, &[COARSE, FINE][..]));
    for ((name, setting), steps) in some(4, all.chain(criteria)) {
        for steps in steps.iter().copied() {
            let [wrong, compared] = violations(&setting, steps, &SOUND);
            assert!(wrong == 0 && compared > 500, "{name}: {wrong} of {compared} with {steps:?}");
        }
    }
}

#[test]
fn minorants_of_a_kind_are_below_the_cost_of_its_loads() {
    let like = |(name, _): &(&str, Setting)| ["total, moments, force errors", "wall, moments"].contains(name);
    let forced = ("slanted", Setting::new(slanted()));
    for (name, setting) in Setting::criteria().into_iter().filter(like).chain([forced]) {
        let [wrong, compared] = violations(&setting, FINE, &Mutation { spread: Some(1.0), ..SOUND });
        assert!(wrong == 0 && compared > 200, "{name}: {wrong} of {compared}");
    }
}

#[test]
fn kinds_of_load_are_few_and_hold_their_points() {
    for (name, setting) in Setting::all().into_iter().chain(Setting::criteria()) {
        let points = &setting.model.points;
        let (kinds, numbers) = kinds(points);
        assert!(kinds.len() <= 12, "{name}: {}", kinds.len());
        for (point, number) in points.iter().zip(&numbers) {
            let Some((number, size)) = number else { continue };
            let (kind, load) = (&kinds[*number], &point.load);
            let off = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k] / size).powi(2)).sum::<f64>().sqrt();
            assert!(off(kind.load.force, load.force) <= kind.force_spread + 1e-12, "{name}");
            assert!(off(kind.load.moment, load.moment) <= kind.moment_spread + 1e-12, "{name}");
            assert!((kind.load.error - load.error / size).abs() < 1e-12, "{name}");
        }
    }
    // The published forces are of few kinds, which are exact.
    let (kinds, numbers) = kinds(&Setting::new(five_segments()).model.points);
    assert!(numbers.iter().all(Option::is_some) && kinds.iter().all(|kind| kind.force_spread < 1e-13));
}

#[test]
fn broken_minorants_are_seen() {
    let mutations = [
        Mutation { name: "joint 1 term missing", joint1: 0.0, ..SOUND },
        Mutation { name: "direction of the feed held still", chi: 0.0, ..SOUND },
        Mutation { name: "most headings left out", states: most_left_out, ..SOUND },
        Mutation { name: "spread of loads left out", spread: Some(0.0), ..SOUND },
        Mutation { name: "slopes by radius and height turned round", known: turned_round, ..SOUND },
    ];
    let setting = Setting::new(slanted());
    for mutation in &mutations {
        let wrong: usize = [COARSE, FINE].map(|steps| violations(&setting, steps, mutation)[0]).iter().sum();
        assert!(wrong > 0, "{} is not seen", mutation.name);
    }
}

fn most_left_out(states: &mut Vec<ModelledRegion>) {
    states.truncate(states.len().div_ceil(4));
}

fn turned_round(known: &mut AffineModel) {
    known.values.iter_mut().for_each(|v| (v[1], v[2]) = (-v[1], -v[2]));
}

#[test]
fn regions_cut_up_are_below_the_cost_too() {
    // As the coarse tables do it: coarse models are replaced by those of the finer levels.
    let setting = Setting::new(five_segments());
    let mut random = seeded(22);
    let (mut compared, mut cut) = (0, 0);
    for _ in 0..10 {
        let (point, place) = anywhere(&setting, &mut random);
        let Some((class, _)) = setting.random_state(&mut random, point, place) else { continue };
        let along = |v: f64| (v - COARSE.length, v + COARSE.length);
        let model = local(&setting, along(place[0]), along(place[1]), COARSE, 3);
        let node = model.table.place(0, [1, 1]);
        let mut found = Vec::new();
        let around = Around { arm: &model.arm, table: &model.table, node, class };
        let known = (0..COARSE.headings).all(|cell| around.collect(0, [1, 1], cell, &mut found));
        if !known {
            continue;
        }
        cut += usize::from(found.len() > COARSE.headings);
        let turn = TAU / COARSE.headings as f64;
        let half = [COARSE.length, COARSE.length, turn];
        let load = &model.points[point].load;
        let direction = Direction::new(place[2] + load.turn);
        let kind = Kind { load: *load, force_spread: 0.0, moment_spread: 0.0, part_spread: 0.0 };
        let e = OfKind::new(&found, &kind, random.random()).minorant(&direction, half);
        for _ in 0..6 {
            let s = shares(&mut random);
            let off = [s[0] * COARSE.length, s[1] * COARSE.length, s[2] * turn];
            let moved: [f64; 3] = std::array::from_fn(|k| place[k] + off[k]);
            for k in 0..256 {
                let Some(truth) = setting.truth(point, moved, TAU / 256.0 * k as f64, class) else { continue };
                compared += 1;
                assert!(e != EMPTY && truth.score >= at(&e, off), "{} {}", truth.score, at(&e, off));
            }
        }
    }
    assert!(compared > 300 && cut > 0, "{compared} {cut}");
}

/// Random affine functions about the 27 children of a node, as the levels above the lowest put them together.
fn children(random: &mut ChaCha8Rng, half: [f64; 3]) -> Vec<([f64; 3], Affine)> {
    let mut out = Vec::new();
    for k in 0..27 {
        let off = [k % 3, k / 3 % 3, k / 9].map(|d| f64::from(d) - 1.0);
        let slope = std::array::from_fn(|k| (random.random_range(-0.2..0.2) / half[k]) as f32);
        let e = Affine { value: random.random_range(2.0..3.0), slope };
        let e = if random.random_range(0..9) == 0 { EMPTY } else { e };
        out.push((std::array::from_fn(|k| off[k] * half[k]), e));
    }
    out
}

#[test]
fn coarser_levels_are_below_finer_ones_and_broken_ones_are_seen() {
    let half = [0.025, 0.025, 0.05];
    type Build = fn(&[([f64; 3], Affine)], [f64; 3]) -> Affine;
    let sound: Build = |all, half| below_all(all.iter().copied(), all.iter().copied(), half);
    let mutations: [(&str, Build); 4] = [
        ("from the middle child alone", |all, half| {
            below_all(all[13..14].iter().copied(), all[13..14].iter().copied(), half)
        }),
        ("children at the edges left out", |all, half| {
            below_all(all[9..18].iter().copied(), all[9..18].iter().copied(), half)
        }),
        ("slopes taken as alike", |all, _| below_all(all.iter().copied(), all.iter().copied(), [0.0; 3])),
        ("children taken as in the middle", |all, half| {
            let middle = || all.iter().map(|(_, e)| ([0.0; 3], *e));
            below_all(middle(), middle(), half)
        }),
    ];
    let wrong = |build: Build| {
        let mut random = seeded(23);
        let mut wrong = 0;
        for _ in 0..200 {
            let all = children(&mut random, half);
            let coarse = build(&all, half);
            for (middle, e) in all.iter().filter(|(_, e)| *e != EMPTY) {
                let s = shares(&mut random);
                let off: [f64; 3] = std::array::from_fn(|k| s[k] * half[k]);
                let whole = std::array::from_fn(|k| middle[k] + off[k]);
                wrong += usize::from(coarse == EMPTY || at(&coarse, whole) > at(e, off));
            }
        }
        wrong
    };
    assert_eq!(wrong(sound), 0);
    for (name, build) in mutations {
        assert!(wrong(build) > 0, "{name} is not seen");
    }
}

#[test]
fn sums_over_boxes_are_below_what_the_planner_finds() {
    let mut problem = five_segments();
    problem.redundancy.max_beta_rate = Some(1e3);
    let setting = Setting::new(problem);
    let placement = [1.64, -0.5564, 2.2];
    let places: Vec<[f64; 3]> = (0..105).map(|point| setting.place(placement, point)).collect();
    let over = |k: usize| {
        let all = || places.iter().map(|p| p[k]);
        (all().fold(f64::INFINITY, f64::min) - 0.06, all().fold(f64::NEG_INFINITY, f64::max) + 0.06)
    };
    let model = local(&setting, over(0), over(1), COARSE, 2);
    let coarse = CoarseBounds::new(&model, &Monitor::silent(), || None).expect("nobody ends it");
    let planner = Planner::new(&setting.problem);
    let mut space = planner.workspace();
    let mut random = seeded(24);
    for size in [0.1, 0.5, 1.0] {
        let half = [0.009, 0.0125, 0.0157].map(|h: f64| h * size);
        let region = Region { middle: placement, half };
        let below = coarse.lower_bound(&model, &region).unwrap();
        let (mut lowest, mut feasible) = (f64::INFINITY, 0);
        for _ in 0..20 {
            let s = shares(&mut random);
            let inside = std::array::from_fn(|k| placement[k] + s[k] * half[k]);
            let pose = setting.pose(inside, -PI / 2.0);
            if let Some(mean) = planner.objective(&pose, Sense::Min, None, &mut space).mean() {
                lowest = lowest.min(105.0 * mean);
                feasible += 1;
            }
        }
        assert!(feasible > 10, "{feasible}");
        assert!(below <= lowest, "{size}: {below} {lowest}");
        if size < 0.2 {
            assert!(below > 0.5 * lowest, "no power: {below} of {lowest}");
        }
    }
    // A box of half the size is for the finer level, which says more of it.
    let region = Region { middle: placement, half: [0.0045, 0.00625, 0.00785] };
    let lone = local(&setting, over(0), over(1), COARSE, 1);
    let without = CoarseBounds::new(&lone, &Monitor::silent(), || None).expect("nobody ends it");
    let [with, without] = [(&coarse, &model), (&without, &lone)].map(|(all, model)| all.lower_bound(model, &region));
    assert!(with > without && without > Some(0.0) && coarse.used() > 0, "{with:?} {without:?}");
    // Every level reaches so far and no farther: never infeasible, but nothing to say.
    let wide = Region { middle: placement, half: [0.2, 0.0, 0.0] };
    assert_eq!(coarse.lower_bound(&model, &wide), None);
    let near = Region { middle: [0.3, -0.5564, 2.2], half: [0.001; 3] };
    assert_eq!(coarse.lower_bound(&model, &near), Some(0.0));
    let far = Region { middle: [2.4, -0.5564, 2.2], half: [0.001; 3] };
    assert_eq!(coarse.lower_bound(&model, &far), None);
    let high = Region { middle: [1.64, 0.5, 2.2], half: [0.001; 3] };
    assert_eq!(coarse.lower_bound(&model, &high), None);
    let low = Region { middle: [1.64, -1.5, 2.2], half: [0.001; 3] };
    assert_eq!(coarse.lower_bound(&model, &low), None);
}
