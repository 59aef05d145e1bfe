//! Boxes of placements: where they put a point, and what it costs over them.

use super::super::compliance_table::{AffineModel, Node, known_over};
use super::super::cost::PointCost;
use super::super::enclosure::REMAINDERS;
use super::super::interval_simd::WIDTH;
use super::super::moment::MomentModel;
use super::super::region::PolarModel;
use super::*;
use stead_model::robot::NormalSprings;
use stead_model::testing::some;

/// A placement in a box, by its shares of the half widths.
fn inside(region: &Region, s: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| region.middle[k] + s[k] * region.half[k])
}

/// Boxes large in all three, or in the radius or the yaw alone.
fn random_box(setting: &Setting, random: &mut ChaCha8Rng, size: f64) -> Region {
    let middle =
        std::array::from_fn(|k| setting.whole.middle[k] + setting.whole.half[k] * random.random_range(-0.9..0.9));
    let half = match random.random_range(0..3) {
        0 => [size, size, size],
        1 => [size, 0.0, 0.0],
        _ => [0.0, 0.0, size],
    };
    Region { middle, half }
}

fn wrapped(angle: f64) -> f64 {
    stead_model::robot::angles::wrap(angle)
}

/// How often a point of a box is not where it is said to be: slopes with rests, reach.
fn misplaced(setting: &Setting, change: fn(&mut PolarModel)) -> usize {
    let mut random = seeded(31);
    let mut wrong = 0;
    for k in 0..3000 {
        let size = [0.003, 0.02, 0.1, 0.4][k % 4];
        let region = random_box(setting, &mut random, size);
        let point = random.random_range(0..setting.model.points.len());
        let Some(mut p) = setting.model.points[point].over(&region) else { continue };
        change(&mut p);
        for _ in 0..8 {
            let s = shares(&mut random);
            let [r, z, chi] = setting.place(inside(&region, s), point);
            let (a, g) = (s[0] * region.half[0], s[2] * region.half[2]);
            let turned = wrapped(chi - p.chi);
            let by = |slope: [f64; 2]| slope[0] * a + slope[1] * g;
            let tiny = 1e-12;
            wrong += usize::from((r - p.r - by(p.slope_r)).abs() > p.remainder_r + tiny);
            // With a reach of half a turn, nothing is said of the direction.
            if p.reach[2] < 3.0 {
                wrong += usize::from((turned - by(p.slope_chi)).abs() > p.remainder_chi + tiny);
                wrong += usize::from(turned.abs() > p.reach[2] + tiny);
            }
            wrong += usize::from((r - p.r).abs() > p.reach[0] + tiny || (z - p.z).abs() > p.reach[1] + tiny);
        }
    }
    wrong
}

#[test]
fn points_are_where_boxes_put_them_and_broken_rests_are_seen() {
    for (name, setting) in Setting::all() {
        assert_eq!(misplaced(&setting, |_| {}), 0, "{name}");
    }
    let setting = Setting::new(five_segments());
    let mutations: [Breaking<PolarModel>; 8] = [
        ("radius's remainder left out", |p| p.remainder_r = 0.0),
        ("azimuth's remainder left out", |p| p.remainder_chi = 0.0),
        ("radius's remainder times 0.3", |p| p.remainder_r *= 0.3),
        ("azimuth's remainder times 0.3", |p| p.remainder_chi *= 0.3),
        ("reach of the radius by slopes alone", |p| p.reach[0] *= 0.9),
        ("reach of the direction times 0.9", |p| p.reach[2] *= 0.9),
        ("turn of the azimuth left out", |p| p.slope_chi[0] = 0.0),
        ("sense of the yaw", |p| p.slope_r[1] = -p.slope_r[1]),
    ];
    for (name, change) in mutations {
        assert!(misplaced(&setting, change) > 0, "{name} is not seen");
    }
}

/// What is done to a cost before it is held against the truth.
#[derive(Clone, Copy)]
pub struct Mutation {
    name: &'static str,
    known: fn(&mut AffineModel),
    moments: fn(&mut MomentModel),
    placed: fn(&mut PolarModel),
    joint1: f64,
    cell: f64,
    /// Whether remainders count how far the point is from the node.
    with_off: bool,
}

pub const SOUND: Mutation =
    Mutation { name: "sound", known: |_| {}, moments: |_| {}, placed: |_| {}, joint1: 1.0, cell: 1.0, with_off: true };

/// Size of a box, half width of the node in radius and height, half width of its cell of heading.
const SIZES: [[f64; 3]; 5] =
    [[1e-7, 0.02, 0.02], [1e-7, 1e-6, 0.02], [0.01, 0.03, 1e-4], [0.01, 0.012, 0.01], [0.001, 0.002, 1e-3]];

/// Placements and headings at which a point costs less than it is said to cost at least; and how many were compared.
pub fn violations(setting: &Setting, mutation: &Mutation) -> [usize; 2] {
    let mut random = seeded(32);
    let (mut wrong, mut compared) = (0, 0);
    for k in 0..2500 {
        let [size, length, cell] = SIZES[k % SIZES.len()];
        let region = random_box(setting, &mut random, size);
        let point = random.random_range(0..setting.model.points.len());
        let Some(mut placed) = setting.model.points[point].over(&region) else { continue };
        let room = length - placed.reach[0].max(placed.reach[1]);
        let Some((class, heading)) = setting.random_state(&mut random, point, [placed.r, placed.z, placed.chi]) else {
            continue;
        };
        if room < 0.0 {
            continue;
        }
        let off = [share(&mut random) * room, share(&mut random) * room];
        let place = [placed.r - off[0], placed.z - off[1], heading];
        let [(node, mut moments), ..] = known_over(&setting.model.arm, &[place; WIDTH], [length, length, cell], class);
        let Node::Known(mut known) = node else { continue };
        (mutation.known)(&mut known);
        moments.iter_mut().for_each(mutation.moments);
        (mutation.placed)(&mut placed);
        if !mutation.with_off {
            let [r, z, _] = placed.reach;
            known.remainder = known.remainder.in_place_of([off[0].abs() + r, off[1].abs() + z, cell], [r, z, cell]);
        }
        let one = PointCost::new(&setting.model.points[point], placed, setting.model.arm.joint1 * mutation.joint1);
        let min = one.min_cost(
            (&known, moments.as_ref()),
            off,
            cell * mutation.cell,
            &region,
            setting.model.objective.aggregate,
        );
        for _ in 0..8 {
            let s = shares(&mut random);
            // The affine function that has those values at the corners.
            let weight = |corner: usize| {
                (0..3).map(|k| if corner >> k & 1 == 1 { 1.0 + s[k] } else { 1.0 - s[k] } / 2.0).product::<f64>()
            };
            let below: f64 = (0..8).map(|corner| weight(corner) * min[corner]).sum();
            let at = setting.place(inside(&region, s), point);
            let Some(truth) = setting.truth(point, at, heading + share(&mut random) * cell, class) else { continue };
            compared += 1;
            wrong += usize::from(truth.cost < below - 1e-12 * truth.cost);
        }
    }
    [wrong, compared]
}

#[test]
fn points_cost_at_least_what_is_said_anywhere_in_the_box() {
    for (name, setting) in some(3, Setting::all().into_iter().chain(Setting::criteria())) {
        let [wrong, compared] = violations(&setting, &SOUND);
        assert!(wrong == 0 && compared > 3000, "{name}: {wrong} of {compared}");
    }
}

#[test]
fn broken_costs_are_seen() {
    let mutations = [
        Mutation {
            name: "remainders zero",
            known: |known| known.remainder = known.remainder.times([0.0; REMAINDERS]),
            ..SOUND
        },
        Mutation {
            name: "remainders halved",
            known: |known| known.remainder = known.remainder.times([0.5; REMAINDERS]),
            ..SOUND
        },
        Mutation { name: "remainders without the distance from the node", with_off: false, ..SOUND },
        Mutation { name: "heading cell half as wide", cell: 0.5, ..SOUND },
        Mutation { name: "joint 1 term missing", joint1: 0.0, ..SOUND },
        Mutation { name: "sign of d2", known: |known| known.values[2] = known.values[2].map(|v| -v), ..SOUND },
        Mutation { name: "sign of c_tz", known: |known| known.values[4] = known.values[4].map(|v| -v), ..SOUND },
    ];
    let setting = Setting::new(slanted());
    for mutation in &mutations {
        assert!(violations(&setting, mutation)[0] > 0, "{} is not seen", mutation.name);
    }
    // And where the whole deflection is scored, with errors of the force.
    let mut problem = slanted();
    (problem.criterion.weights, problem.criterion.force_uncertainty) = (Weights::TOTAL, 0.1);
    let setting = Setting::new(problem);
    let axial = Mutation {
        name: "vertical compliance doubled",
        known: |known| known.values[5] = known.values[5].map(|v| 2.0 * v),
        ..SOUND
    };
    // Without joint 1 the arm is stiffer, and the whole deflection smaller.
    let twice = Mutation { name: "joint 1 twice", joint1: 2.0, ..SOUND };
    let others = mutations.iter().filter(|mutation| mutation.joint1 == 1.0);
    for mutation in others.chain([&axial, &twice]) {
        assert!(violations(&setting, mutation)[0] > 0, "{} is not seen in the whole deflection", mutation.name);
    }
    let of_moments = [
        Mutation {
            name: "remainders of moments zero",
            moments: |known| known.remainder = known.remainder.times([0.0; 6]),
            ..SOUND
        },
        Mutation {
            name: "antisymmetric part",
            moments: |known| known.values[1] = known.values[1].map(|v| -v),
            ..SOUND
        },
        Mutation { name: "vertical columns", moments: |known| known.values[4] = known.values[4].map(|v| -v), ..SOUND },
        Mutation { name: "turning part", moments: |known| known.values[3] = known.values[3].map(|v| -v), ..SOUND },
    ];
    let (_, setting) = Setting::criteria().into_iter().find(|(name, _)| *name == "wall, moments").unwrap();
    for mutation in &of_moments {
        assert!(violations(&setting, mutation)[0] > 0, "{} is not seen", mutation.name);
    }
    // Deflection along axis 1 by moments about horizontal axes, which the wall does not have.
    let rows = Mutation {
        name: "vertical rows",
        moments: |known| [6, 7].into_iter().for_each(|f| known.values[f] = known.values[f].map(|v| -v)),
        ..SOUND
    };
    let (_, setting) = Setting::criteria().into_iter().find(|(name, _)| *name == "total, moments").unwrap();
    assert!(violations(&setting, &rows)[0] > 0, "{} is not seen", rows.name);
}

#[test]
fn what_yields_beside_the_joints_is_seen_where_it_is_missing_or_doubled() {
    let of = |name: &str| Setting::criteria().into_iter().find(|(other, _)| *other == name).unwrap().1;
    // Parts of either sign add up to the deflection normal to the wall: a bound without some of them is none.
    let mut setting = of("whole arm");
    let mut plain = setting.problem.clone();
    plain.robot = plain.robot.clone().with_normal_springs(None).unwrap();
    setting.model = Model::new(&plain);
    assert!(violations(&setting, &SOUND)[0] > 0, "normal springs left out are not seen");
    let mut setting = of("total, whole arm");
    setting.model.points.iter_mut().for_each(|point| point.load.part = point.load.part.map(|part| part.plus(&part)));
    assert!(violations(&setting, &SOUND)[0] > 0, "a part twice as soft is not seen");
    let mut setting = of("total, whole arm");
    let mut soft = setting.problem.clone();
    let springs = soft
        .robot
        .normal_springs()
        .unwrap()
        .map(|spring| NormalSprings { compliance: spring.compliance.map(|compliance| 1.2 * compliance), ..spring });
    soft.robot = soft.robot.clone().with_normal_springs(Some(springs)).unwrap();
    setting.model = Model::new(&soft);
    assert!(violations(&setting, &SOUND)[0] > 0, "normal springs a fifth softer are not seen");
}
