use super::super::testing::{outcome, problem};
use super::*;
use crate::units::Unit;
use stead_certify::{BOUND_DECIMALS, Bound, NoProof, Proof, Region, Status};
use stead_problem::problem::Problem;
use stead_problem::sense::Sense;
use stead_problem::settings::CertificateSettings;

/// Bounds about the best placement of the result, in mm.
fn proof(sense: Sense, value_mm: f64, bound_mm: f64, open: Vec<(Region, f64)>) -> Proof {
    let (value, bound) = (value_mm / 1e3, bound_mm / 1e3);
    let status = if open.is_empty() { Status::Reached } else { Status::TimeLimit };
    let with_rate = sense == Sense::Min;
    let bound =
        Bound { value, met: None, bound, with_rate, with_turn: false, nodes: 7, status, keeps_open: None, open };
    Proof::new(problem(), sense, outcome().cases.best.placement, bound)
}

fn certificate(best: Proof) -> Certificate {
    Certificate {
        settings: CertificateSettings { time_limit: Some(20.0), ..CertificateSettings::new(0.005) },
        best: Ok(best),
        worst: Err(NoProof::TimeLimit),
        warnings: Vec::new(),
        wall: 1.5,
    }
}

/// Two boxes, in front of the arm and to both sides.
fn boxes() -> Vec<(Region, f64)> {
    let region = |radius, turn| Region { middle: [radius, -0.4, turn], half: [0.05, 0.1, 0.2] };
    vec![(region(1.8, -1.0), 0.9e-4), (region(2.0, 1.0), 0.95e-4)]
}

#[test]
fn bounds_are_rounded_to_where_they_hold_and_gaps_upwards() {
    let best = proof(Sense::Min, 0.1, 0.099_500_08, Vec::new());
    assert_eq!((best.bound_mm(), best.gap_percent()), (0.0995, 0.5));
    let worst = proof(Sense::Max, 1.0, 1.001_000_01, Vec::new());
    assert_eq!((worst.bound_mm(), worst.gap_percent()), (1.0010001, 0.1001));
    assert_eq!(BOUND_DECIMALS, Unit::DEFLECTION_MM.decimals);
    // What is reached exactly is not stated as missed by the last bits.
    let gap = 0.005;
    let exact = proof(Sense::Min, 0.107_509_9, 0.107_509_9 * (1.0 - gap), Vec::new());
    assert_eq!(exact.gap_percent(), 0.5);
}

#[test]
fn relaxed_limits_are_named() {
    let mut problem = problem().clone();
    let words = |problem: &Problem, sense| {
        let bound = proof(sense, 1.0, 1.0, Vec::new()).bound;
        Proof::new(problem, sense, outcome().cases.best.placement, bound).relaxed_words().join(", ")
    };
    let common = "steps and turns of the joints between path points, limits of joints 1, 4 and 6";
    assert_eq!(words(&problem, Sense::Min), format!("{common}, max_deflection_mm"));
    assert_eq!(words(&problem, Sense::Max), format!("{common}, rate of beta, max_deflection_mm"));
    problem.constraints.max_deflection = None;
    problem.cell.yaw.max = 1.0;
    assert_eq!(words(&problem, Sense::Min), format!("{common}, which yaw goes with which x and y"));
    // A joint 5 that cannot be straight: the flips of the wrist do not reach equally far.
    let mut joints = problem.robot.joints().clone();
    joints[4].min = 0.1;
    problem.robot = stead_model::robot::Robot::new("bent", joints).unwrap();
    assert!(words(&problem, Sense::Min).contains("limits of joints 1, 4, 5 and 6, "));
}

#[test]
fn sentences_state_the_bound_and_what_falls_short() {
    let reached = certificate(proof(Sense::Min, 0.1075099, 0.106_972_39, Vec::new()));
    let text = certificate_text(&reached);
    let joined = text.replace('\n', " ");
    assert!(
        joined.contains("more than 0.5 % below yours. Certificate, best placement: ")
            && joined.contains(" it is at least 0.1069723 mm; yours has 0.1075099 mm."),
        "{text}"
    );
    assert!(
        joined.contains("No certificate for the worst placement: the time limit was over before it began. "),
        "{text}"
    );
    assert!(text.lines().all(|line| line.chars().count() <= 110), "{text}");
    assert_eq!(reached.best.as_ref().unwrap().shortfall(&reached.settings), None);

    let open = certificate(proof(Sense::Min, 0.1, 0.09, boxes()));
    let said = "the time limit of 20.0 s is over: a gap of 10 % is reached, 0.500 % was asked for; 2 boxes are open";
    assert_eq!(open.best.as_ref().unwrap().shortfall(&open.settings).as_deref(), Some(said));

    // Stopped by the deadline of the caller, which the settings do not know.
    let said = "the time limit is over: a gap of 10 % is reached, 0.500 % was asked for; 2 boxes are open";
    let unlimited = CertificateSettings { time_limit: None, ..open.settings };
    assert_eq!(open.best.as_ref().unwrap().shortfall(&unlimited).as_deref(), Some(said));

    // Dropping a limit makes the worst placement better, so each one dropped is no bound of what it is with it.
    let worst = Certificate { worst: Ok(proof(Sense::Max, 1.0, 1.001, Vec::new())), ..reached.clone() };
    let joined = certificate_text(&worst).replace('\n', " ");
    let parts = [
        "with the limits named below dropped: no feasible",
        "With these limits kept this is no bound",
        "rate of beta;",
    ];
    assert!(parts.iter().all(|part| joined.contains(part)), "{joined}");

    // Where there is no bound yet, none is stated.
    let nothing = certificate_text(&certificate(proof(Sense::Min, 0.1, 0.0, boxes())));
    assert!(nothing.contains("nothing is known") && !nothing.contains("below"), "{nothing}");
    let worst = Certificate { worst: Ok(proof(Sense::Max, 1.0, f64::INFINITY, boxes())), ..reached };
    let nothing = certificate_text(&worst);
    assert!(nothing.contains("nothing is known") && !nothing.contains("above"), "{nothing}");
    assert_eq!(certificate_json(&worst, &[])["worst"]["bound_mm"], serde_json::Value::Null);
}

#[test]
fn open_boxes_are_in_the_base_frame_for_an_arm_that_hangs_too() {
    let text = |problem: &Problem| {
        let certificate = certificate(proof(Sense::Min, 0.1, 0.09, boxes()));
        String::from_utf8(open_region(problem, &certificate).unwrap()).unwrap()
    };
    let standing = text(problem());
    let mut rows = standing.lines().skip(1);
    // Axis 1 passes through the origin of the base frame; the shoulder's z is no part of it.
    let first = rows.next().unwrap();
    let z = problem().robot.geometry().root_in_base.z * 1e3;
    let expected = format!("best,1750.0000,1850.0000,{:.4},{:.4},-68.7549,-45.8366,0.0900000,,", z - 500.0, z - 300.0);
    assert_eq!(first, expected);
    assert_eq!(rows.count(), 1);
    let up = proof(Sense::Min, 0.1, 0.09, boxes()).open_boxes(problem())[0].clone();
    assert!((up.turn[0] + 1.2).abs() < 1e-12 && (up.radius[1] - 1.85).abs() < 1e-12);
}

#[test]
fn the_picture_shows_what_is_open_and_the_placement() {
    let fills = |svg: &str| svg.matches("<polygon").count();
    let open = picture::open_region(problem(), &proof(Sense::Min, 0.1, 0.09, boxes()));
    let closed = picture::open_region(problem(), &proof(Sense::Min, 0.1, 0.0995, Vec::new()));
    assert_eq!(fills(&closed), 0);
    assert!(fills(&open) >= 4, "{}", fills(&open));
    assert!(open.contains("2 boxes of placements") && open.contains("0.09000 mm") && open.contains("0.09500 mm"));
    assert!(closed.contains("Nothing: no placement in the cell is better by more than 0.5000 %"));
    // A cell that is one place is drawn all the same.
    let mut point = problem().clone();
    let placement = outcome().cases.best.placement;
    for (range, at) in point.cell.position.iter_mut().zip([placement.x, placement.y, placement.z]) {
        (range.min, range.max) = (at, at);
    }
    let radius = libm::hypot(placement.x, placement.y);
    let whole = Region { middle: [radius, 0.0, 0.0], half: [0.0, 0.0, std::f64::consts::PI] };
    let drawn = picture::open_region(&point, &proof(Sense::Min, 0.1, 0.09, vec![(whole, 0.9e-4)]));
    assert!(fills(&drawn) >= 2);
}
