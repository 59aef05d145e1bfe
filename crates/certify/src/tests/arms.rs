//! The layers once more, for arms of every build: all signs of twists, lateral offsets, wide and narrow limits, upright
//! and hanging, with spindles at any angle.

use super::super::certifiable;
use super::*;
use nalgebra::{Rotation3, Unit};
use stead_model::robot::Spindle;
use stead_model::testing::tried;

fn arm(random: &mut ChaCha8Rng) -> Robot {
    let mut joints = stead_model::robot::testing::kr270().joints().clone();
    let mut from = |a: f64, b: f64| a + (b - a) * random.random::<f64>();
    let turned = |v: f64| if v < 0.0 { -PI / 2.0 } else { PI / 2.0 };
    joints[0].alpha = if from(0.0, 1.0) < 0.5 { 0.0 } else { PI };
    joints[2].alpha = if from(0.0, 1.0) < 0.5 { 0.0 } else { PI };
    for k in [1, 3, 4, 5] {
        joints[k].alpha = turned(from(-1.0, 1.0));
    }
    (joints[0].a, joints[0].d) = (from(-0.3, 0.3), from(-0.2, 0.8));
    (joints[1].a, joints[1].d) = (from(-0.2, 0.5), from(-0.15, 0.15));
    (joints[2].a, joints[2].d) = (from(0.6, 1.4), from(-0.15, 0.15));
    (joints[3].a, joints[3].d) = (from(-0.2, 0.2), from(0.5, 1.3) * turned(from(-1.0, 1.0)).signum());
    joints[5].d = from(-0.1, 0.3);
    for j in [0, 3, 5] {
        (joints[j].min, joints[j].max) = (-6.1, 6.1);
    }
    for j in [1, 2] {
        let (middle, half) = (from(-3.5, 3.5), [from(0.5, 1.5), from(1.6, 3.1), 3.5][from(0.0, 3.0) as usize % 3]);
        (joints[j].min, joints[j].max) = (middle - half, middle + half);
    }
    (joints[4].min, joints[4].max) = (-from(0.7, 3.1), from(0.7, 3.5));
    joints.iter_mut().for_each(|joint| joint.compliance = (from(0.3, 5.0) * 1e-6).into());
    Robot::new("any", joints).unwrap()
}

/// A problem with that arm that can be certified, and in which about every third state is allowed.
fn problem(random: &mut ChaCha8Rng) -> Setting {
    loop {
        let mut problem = if random.random_range(0..2) == 0 { slanted() } else { hanging() };
        problem.robot = arm(random);
        let mut from = |a: f64, b: f64| a + (b - a) * random.random::<f64>();
        let axis = Unit::new_normalize(Vector3::new(from(-1.0, 1.0), from(-1.0, 1.0), from(-1.0, 1.0)));
        let rotation = Rotation3::from_axis_angle(&axis, from(-PI, PI)).into_inner();
        let shift = Vector3::new(from(-0.2, 0.2), from(-0.2, 0.2), from(-0.2, 0.7));
        problem.spindle = Spindle::new(rotation, shift).unwrap();
        problem.constraints.min_inverse_condition = from(0.1, 0.3);
        problem.constraints.characteristic_length = from(0.4, 1.0);
        let middle = [from(-0.3, 0.3), from(-1.8, -0.6), from(-1.5, 1.5)];
        problem.cell.position = middle.map(|m| Interval { min: m - 0.2, max: m + 0.2 });
        if certifiable(&problem, 400_000_000).is_err() {
            continue;
        }
        let setting = Setting::new(problem);
        let found = (0..20).filter(|_| {
            let (point, at) = anywhere(&setting, random);
            setting.random_state(random, point, at).is_some()
        });
        if found.count() > 6 {
            return setting;
        }
    }
}

#[test]
fn layers_hold_for_arms_of_every_build() {
    let mut random = seeded(71);
    let (mut sides, mut seen) = ([0; 2], [0; 4]);
    let count = tried(16).min(8);
    for k in 0..count {
        let setting = problem(&mut random);
        let told = format!("arm {k}: {:?} {:?}", setting.problem.robot.geometry(), setting.problem.robot.joints());
        sides[usize::from(setting.side() < 0.0)] += 1;
        for level in [0, 2, 3] {
            let [wrong, known, states] = super::cell::violations(&setting, level, |half| half, |_| {});
            assert_eq!(wrong, 0, "cells, {told}");
            (seen[0], seen[1]) = (seen[0] + known, seen[1] + states);
        }
        let [wrong, compared] = super::boxes::violations(&setting, &super::boxes::SOUND);
        assert_eq!(wrong, 0, "boxes, {told}");
        seen[2] += compared;
        let [wrong, compared] =
            super::minorants::violations(&setting, super::minorants::FINE, &super::minorants::SOUND);
        assert_eq!(wrong, 0, "minorants, {told}");
        seen[3] += compared;
    }
    assert!(sides.iter().all(|count| *count > 0), "{sides:?}");
    let least = [125, 1250, 3750, 1250].map(|of_one| count * of_one);
    assert!(seen.iter().zip(least).all(|(seen, least)| *seen > least), "{seen:?}");
}
