//! The published path and cell for a KUKA KR 210-2 with springs about three directions of every joint, against figures
//! of another program: the guide's page `whole_arm`.

use super::*;
use crate::sag::SagRange;
use nalgebra::Vector3;
use stead_model::robot::{Joint, NormalSprings, PointMass, Robot, Spindle, SpringModel};

/// `configs/whole-arm.toml`, with the part of the deflection that is scored.
pub(crate) fn full_arm(weights: Weights) -> Problem {
    let row = |alpha: f64, a, d, [min, max]: [f64; 2], speed: f64, stiffness: f64| Joint {
        alpha: alpha.to_radians(),
        a,
        d,
        min: min.to_radians(),
        max: max.to_radians(),
        max_speed: Some(speed.to_radians()),
        max_acceleration: None,
        max_jerk: None,
        compliance: (1e-6 / stiffness).into(),
    };
    let joints = [
        row(0.0, 0.0, 0.75, [-185.0, 185.0], 86.0, 5.6),
        row(90.0, 0.35, 0.0, [0.0, 146.0], 84.0, 8.0397),
        row(0.0, 1.25, 0.0, [-245.0, 29.0], 84.0, 3.1205),
        row(-90.0, 0.055, 1.1, [-350.0, 350.0], 100.0, 0.71959),
        row(90.0, 0.0, 0.0, [-125.0, 125.0], 110.0, 0.65862),
        row(-90.0, 0.0, 0.23, [-350.0, 350.0], 184.0, 0.31403),
    ];
    let normal = [13.3, 26.1, 1.54, 1.93, 0.6584, 1.899];
    let springs = std::array::from_fn(|joint| NormalSprings {
        compliance: [1e-6 / normal[joint]; 2],
        bearing: if joint == 0 { -0.75 } else { 0.0 },
    });
    let robot = Robot::new("full", joints).unwrap().with_normal_springs(Some(springs)).unwrap();
    five_segments().with(|parts| {
        parts.robot = robot.with_spring_model(Some(SpringModel::Full));
        let mut tool = parts.spindle.flange_from_tool;
        tool.translation.z = 0.454;
        parts.spindle = Spindle::rigid(tool);
        parts.cell.position[2] = Interval { min: 0.148, max: 0.536 };
        parts.criterion.weights = weights;
    })
}

/// With 61 kg on the flange, 250 mm from it.
pub(crate) fn heavy(problem: Problem) -> Problem {
    problem
        .with(|parts| parts.spindle.point_mass = Some(PointMass { mass: 61.0, centre: Vector3::new(0.0, 0.0, 0.25) }))
}

/// Mean deflections of best and worst placement, each under its best plan, in mm, within half a per cent; and by how
/// much the weight of a spindle moves the tool there, least, most and differently, by the sum over 18 springs in a
/// program of its own: more than the cut, and in no score.
#[test]
fn a_full_arm_is_placed_as_another_program_places_it() {
    let by_weight = [[0.4834, 0.9999, 0.7329], [0.7983, 1.3166, 0.8023]];
    for (weights, expected) in [(Weights::TOTAL, [0.1690, 0.2228]), (Weights::WALL, [0.0144, 0.0871])] {
        let is_heavy = weights == Weights::TOTAL;
        let problem = if is_heavy { heavy(full_arm(weights)) } else { full_arm(weights) };
        let transfer = TransferSettings::default();
        let outcome = place(&problem, &SearchSettings::default(), &transfer, &Monitor::silent()).unwrap();
        let plans = outcome.cases.optima();
        for ((case, expected), by_weight) in plans.into_iter().zip(expected).zip(by_weight) {
            let mean = case.plan.mean * 1e3;
            let origins = case.plan.by_origin.unwrap();
            assert!((origins.total() - case.plan.mean).abs() < 1e-12, "{origins:?}");
            assert!((mean / expected - 1.0).abs() < 0.005, "{weights:?}: {mean} {expected}, {origins:?}");
            let Some(sag) = &case.plan.sag else {
                assert!(!is_heavy);
                continue;
            };
            let SagRange { least, largest, spread } = sag.path;
            for (found, expected) in [least, largest, spread].into_iter().zip(by_weight) {
                assert!((found * 1e3 / expected - 1.0).abs() < 0.005, "{:?} {expected}", sag.path);
            }
            assert_eq!(sag.segments.iter().map(|(number, _)| *number).collect::<Vec<_>>(), [1, 2, 3, 4, 5]);
            let mut ranges = sag.segments.iter().map(|(_, range)| range);
            assert!(ranges.all(|range| range.least >= least && range.largest <= largest && range.spread <= spread));
        }
        let words = "the weight of the 61.0 kg on the flange (the masses of the links";
        assert_eq!(outcome.notes.iter().filter(|note| note.contains(words)).count(), usize::from(is_heavy));
    }
}
