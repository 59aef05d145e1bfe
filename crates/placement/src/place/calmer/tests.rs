use super::*;
use crate::place::score;
use stead_problem::settings::TransferSettings;
use stead_problem::testing::five_segments;

#[test]
fn numbers_are_rounded_down_to_two_digits() {
    for (value, expected) in [(0.02357, 0.023), (1.0, 1.0), (99.99, 99.0), (7.4e-5, 7.4e-5), (0.1099, 0.1)] {
        assert_eq!(rounded_down(value), expected);
    }
}

#[test]
fn a_calmer_plan_that_costs_little_is_named_with_what_it_comes_to() {
    let problem = five_segments();
    let silent = Monitor::silent();
    let scored = |problem: &Problem, placement: &Placement| {
        score(problem, placement, &TransferSettings::default(), &silent).unwrap()
    };
    let mut named = 0;
    for k in 0..6 {
        let f = f64::from(k);
        let placement = Placement::from([0.02 * f, -1.66 - 0.02 * f, -0.5 + 0.03 * f, 0.4 + 0.3 * f]);
        let best = scored(&problem, &placement).plans.best;
        let Some(note) = calmer(&problem, &placement, &best, &silent) else { continue };
        named += 1;
        // As the note says it, the run is calmer and costs less than 2 %.
        let mut calm = problem.clone();
        match note.split_once("joint_travel_weight_mm_per_rad = ") {
            Some((_, rest)) => {
                let weight: f64 = rest.split(' ').next().unwrap().parse().unwrap();
                calm.criterion.joint_travel_weight = weight * 1e-3;
            }
            None => {
                assert!(note.contains("redundancy.beta = \"constant_per_segment\""), "{note}");
                calm.redundancy.beta = BetaPlan::ConstantPerSegment;
            }
        }
        let found = scored(&calm, &placement).plans.best;
        assert!(found.mean < best.mean * (1.0 + COST), "{} {} {note}", found.mean, best.mean);
        assert!(found.travel.total < 0.85 * best.travel.total, "{note}");
        assert_eq!(calmer(&calm, &placement, &found, &silent), None);
    }
    assert!(named > 0);
}
