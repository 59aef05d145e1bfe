use super::super::*;
use crate::load::PointForces;
use crate::operation::Stock;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::TAU;
use stead_model::cutting::{Coefficients, Cutter, Rotation, Tooth};
use stead_model::robot::Pose;
use stead_model::task::{PathPoint, ToolPath, Wrench};
use stead_model::testing::some;

const K: Coefficients =
    Coefficients { tangential: 800e6, radial: 320e6, axial: 100e6, tangential_edge: 20e3, radial_edge: 20e3 };

/// An end mill by diameter, corner radius (mm) and taper (deg).
pub(super) fn mill(diameter: f64, corner: f64, taper: f64) -> EndMill {
    let tooth = Tooth { pitch: TAU / 4.0, radius: diameter / 2e3 };
    EndMill {
        cutter: Cutter::new(vec![tooth; 4], 0.0, Some(0.04), Rotation::Clockwise, K).unwrap(),
        flute_length: 0.04,
        corner_radius: corner / 1e3,
        taper: taper.to_radians(),
        is_centre_cutting: true,
        holder: Vec::new(),
    }
}

/// A place of the tool: position (mm) and axis.
pub(super) type Knot = ([f64; 3], [f64; 3]);

/// Straight lines between places, with points about so far apart (mm).
pub(super) fn line(knots: &[Knot], step: f64) -> Vec<(Vector3<f64>, Vector3<f64>)> {
    let mut points = vec![(Vector3::from(knots[0].0) / 1e3, Vector3::from(knots[0].1).normalize())];
    for pair in knots.windows(2) {
        let [from, to] = [Vector3::from(pair[0].0), Vector3::from(pair[1].0)];
        let count = ((to - from).norm() / step).round().max(1.0);
        for k in 1..=count as usize {
            let share = k as f64 / count;
            let axis = Vector3::from(pair[0].1) * (1.0 - share) + Vector3::from(pair[1].1) * share;
            points.push(((from + (to - from) * share) / 1e3, axis.normalize()));
        }
    }
    points
}

/// The path in a pose, 0.05 mm a tooth.
pub(super) fn operation(points: &[(Vector3<f64>, Vector3<f64>)], mill: &EndMill, pose: &Pose<f64>) -> Operation {
    let direction = |k: usize| {
        let (from, to) = if k + 1 < points.len() { (k, k + 1) } else { (k - 1, k) };
        (points[to].0 - points[from].0).normalize()
    };
    let point = |(k, (position, axis)): (usize, &(Vector3<f64>, Vector3<f64>))| {
        let feed = direction(k);
        let has_wall = feed.cross(axis).norm() > 0.1;
        let feed = if has_wall { feed } else { axis.cross(&Vector3::new(0.1, 1.0, 0.2)).normalize() };
        let point =
            PathPoint { position: pose.point(position), feed: pose.rotation * feed, axis: pose.rotation * axis };
        (1, point, has_wall)
    };
    let path = ToolPath::partly_scored(points.iter().enumerate().map(point)).unwrap();
    let path = path.with_feeds(vec![0.02; points.len()]).unwrap();
    Operation { name: "path".to_owned(), path, rapids: Vec::new(), mill: mill.clone(), spindle_speed: 100.0 }
}

/// A box from corner to corner (mm) in a pose.
pub(super) fn stock([min, max]: [[f64; 3]; 2], pose: &Pose<f64>) -> Stock {
    let [min, max] = [min, max].map(|corner| Vector3::from(corner) / 1e3);
    let pose = Pose { translation: pose.point(&((min + max) / 2.0)), ..*pose };
    Stock::Solid { solid: Solid::Box(max - min), pose }
}

/// Poses of the whole about the grid: along its rows, quarter turns and odd angles.
pub(super) fn poses() -> Vec<Pose<f64>> {
    let angles = [0.0_f64, 90.0, 180.0, 17.0, 45.0, 101.0, 222.0, 333.0];
    let pose = |(k, degrees): (usize, f64)| {
        let (s, c) = libm::sincos(degrees.to_radians());
        let rotation = Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
        let k = k as f64;
        Pose { rotation, translation: Vector3::new(0.37 * k, 0.21 * k, 0.13 * k) * 1e-3 }
    };
    angles.into_iter().enumerate().map(pose).collect()
}

/// Force (N), moment (N mm), removed area (mm2), edge part (N).
pub(super) type Figures = ([f64; 3], [f64; 3], f64, [f64; 3]);

/// Of the slot and the four shoulders below, in their order.
pub(super) const OF_CASES: [Figures; 5] = [
    ([-207.3240, 327.3240, 31.8310], [-818.310, -718.310, 3637.183], 80.0, [-127.3240, 127.3240, 0.0]),
    ([-150.3504, -3.3003, 7.9577], [55.997, -414.976, 1042.629], 20.0, [-86.9639, -23.3019, 0.0]),
    ([55.4083, 145.1627, 7.9577], [-410.653, 99.421, 1042.629], 20.0, [23.3019, 86.9639, 0.0]),
    ([71.4029, 99.9017, 3.9789], [-529.350, 346.605, 769.404], 10.0, [45.7250, 77.5559, 0.0]),
    ([-38.1399, -26.6781, 0.7958], [139.677, -191.645, 279.171], 2.0, [-31.4751, -25.1089, 0.0]),
];

struct Case {
    name: &'static str,
    mill: EndMill,
    stock: [[f64; 3]; 2],
    before: Option<Vec<Knot>>,
    path: Vec<Knot>,
    step: f64,
    /// The points that are looked at, as the length of path to them. mm
    at: [f64; 2],
    is: Figures,
    /// Largest errors: force, rms and largest; moment, largest; volume.
    within: [f64; 4],
}

const UP: [f64; 3] = [0.0, 0.0, 1.0];
const FLAT: [f64; 4] = [0.015, 0.04, 0.04, 0.01];
const ROUND: [f64; 4] = [0.03, 0.05, 0.05, 0.01];
const FIVE: [f64; 4] = [0.02, 0.05, 0.05, 0.01];

/// A straight cut along x with the tip at a place (mm), the stock from one y to another and 20 mm high.
fn straight(
    name: &'static str,
    mill: EndMill,
    [y, z]: [f64; 2],
    axis: [f64; 3],
    [from, to]: [f64; 2],
    is: Figures,
) -> Case {
    Case {
        name,
        mill,
        stock: [[0.0, from, -20.0], [80.0, to, 0.0]],
        before: None,
        path: vec![([10.3, y, z], axis), ([70.3, y, z], axis)],
        step: 2.0,
        at: [20.0, 40.0],
        is,
        within: FLAT,
    }
}

fn cases() -> Vec<Case> {
    let flat = || mill(16.0, 0.0, 0.0);
    let ball = || mill(10.0, 5.0, 0.0);
    let shoulder = |name, depth: f64, work, is| straight(name, flat(), [0.0, -depth], UP, work, is);
    let round = |case: Case| Case { within: ROUND, ..case };
    let raster = |case: Case| {
        let moved = |(at, axis): &Knot| ([at[0], at[1] - 1.5, at[2]], *axis);
        Case { before: Some(case.path.iter().map(moved).collect()), ..round(case) }
    };
    let (s20, c20) = libm::sincos(20_f64.to_radians());
    let leaning = [0.0, -s20, c20];
    let ((s15, c15), (s10, c10)) = (libm::sincos(15_f64.to_radians()), libm::sincos(10_f64.to_radians()));
    let lead = [s15, -s10 * c15, c10 * c15];
    // The tip of a ball whose lowest point is 1 mm deep: its centre is 4 mm high.
    let tip = |axis: [f64; 3]| [-5.0 * axis[1], 4.0 - 5.0 * axis[2]];
    let all = [-30.0, 30.0];
    let corner = |name, end: f64, is| Case {
        name,
        mill: flat(),
        stock: [[-60.0, -60.0, -8.0], [60.0, 60.0, 0.0]],
        before: Some(vec![([-50.0, -1.5, -8.0], UP), ([0.0, -1.5, -8.0], UP), ([0.0, -50.0, -8.0], UP)]),
        path: vec![([-40.0, 0.0, -8.0], UP), ([end, 0.0, -8.0], UP), ([3.0, 0.0, -8.0], UP)],
        step: 0.5,
        at: [40.0 + end - 0.01, 40.0 + end + 0.01],
        is,
        // At the kink itself the load is the mean over the window on both sides of it.
        within: [0.03, 0.04, 0.04, 0.02],
    };
    let (s3, c3) = libm::sincos(3_f64.to_radians());
    let turning = |x: f64| {
        let (s, c) = libm::sincos(x.to_radians());
        ([x, 0.0, 0.0], [s, 0.0, c])
    };
    let [slot, up, down, narrow, thin] = OF_CASES;
    let plunge = ([0.0, 0.0, 1152.0], [0.0, 0.0, 7680.0], 201.0619, [0.0, 0.0, 640.0]);
    let ramp = ([-165.7715, 261.6399, 692.2259], [-523.280, -491.324, 5735.473], 74.4351, [-101.8592, 101.8592, 640.0]);
    let corners = [
        ([-385.413, 148.686, 27.8524], [-493.78, -1720.72, 3139.07], 70.0007, [-212.82, 10.0, 0.0]),
        ([-419.898, 323.227, 40.3101], [-1225.67, -1951.24, 4367.01], 101.310, [-244.0, 78.48, 0.0]),
    ];
    let ball_slot = ([-27.5049, 121.9334, 140.9369], [-47.694, -162.525, 304.088], 4.0875, [-25.4649, 81.9334, 120.0]);
    let ball_raster = ([-50.1116, 51.8876, 82.0380], [49.312, -83.545, 130.003], 1.4718, [-39.5329, 36.4640, 73.0797]);
    let ball_leaning = ([26.807, 80.293, 165.522], [-172.816, -194.255, 252.900], 4.0875, [11.899, 51.605, 135.019]);
    let ball_lead = ([-14.433, 36.649, 52.934], [19.575, -126.056, 109.109], 1.4717, [-12.350, 25.233, 44.442]);
    let bull = ([-112.5274, 225.4651, 116.7381], [-301.803, -594.922, 1775.672], 34.2833, [-76.3946, 105.4651, 80.0]);
    let taper =
        ([-232.2696, 423.5225, 179.6384], [-1192.035, -926.175, 1193.425], 25.3585, [-152.7892, 183.5225, 109.4464]);
    let axis = ([74.540, 102.632, 4.465], [0.0; 3], 11.2217, [45.7250, 77.5559, 0.0]);
    vec![
        shoulder("slot", 5.0, all, slot),
        shoulder("up, a_e 4 a_p 5", 5.0, [4.0, 30.0], up),
        shoulder("down, a_e 4 a_p 5", 5.0, [-30.0, -4.0], down),
        shoulder("down, a_e 1 a_p 10", 10.0, [-30.0, -7.0], narrow),
        shoulder("up, a_e 0.2 a_p 10", 10.0, [7.8, 30.0], thin),
        Case {
            path: vec![([40.0, 0.0, 5.0], UP), ([40.0, 0.0, -12.0], UP), ([42.0, 0.0, -12.0], UP)],
            step: 1.0,
            at: [9.9, 14.1],
            within: [0.05, 0.08, 0.05, 0.01],
            ..shoulder("plunge", 0.0, all, plunge)
        },
        Case {
            stock: [[-60.0, -30.0, -20.0], [200.0, 30.0, 0.0]],
            path: vec![([-c3 / s3, 0.0, 1.0], UP), ([7.0 * c3 / s3, 0.0, -7.0], UP)],
            step: 2.0,
            at: [5.0 / s3 - 1.1, 5.0 / s3 + 1.1],
            within: ROUND,
            ..shoulder("ramp 3 deg", 0.0, all, ramp)
        },
        corner("pocket corner, g 0", 0.0, corners[0]),
        corner("pocket corner, g 1.5", 1.5, corners[1]),
        round(straight("ball slot", ball(), [0.0, -1.0], UP, all, ball_slot)),
        raster(straight("ball raster 1.5", ball(), [0.0, -1.0], UP, all, ball_raster)),
        round(straight("ball, leaning by 20 deg, slot", ball(), tip(leaning), leaning, all, ball_leaning)),
        raster(straight("ball, lead 15 tilt 10, raster 1.5", ball(), tip(lead), lead, all, ball_lead)),
        round(straight("bull slot", mill(12.0, 2.0, 0.0), [0.0, -3.0], UP, all, bull)),
        round(straight("tapered ball slot", mill(4.0, 2.0, 10.0), [0.0, -6.0], UP, all, taper)),
        Case {
            stock: [[-40.0, -30.0, 2.0], [40.0, -7.0, 12.0]],
            path: (-20..=20).map(|k| turning(f64::from(k) / 2.0)).collect(),
            step: 0.5,
            at: [9.9, 10.1],
            within: FIVE,
            ..shoulder("axis turning 1 deg/mm", 0.0, all, axis)
        },
    ]
}

/// The loads at the points of a case that are looked at, turned back.
fn loads(case: &Case, cell: Option<f64>, pose: &Pose<f64>) -> (RemovalForces, Vec<PointForces>) {
    let path = line(&case.path, case.step);
    let problem = ForcesProblem {
        stock: stock(case.stock, pose),
        before: case.before.iter().map(|before| operation(&line(before, 2.0), &case.mill, pose)).collect(),
        operation: operation(&path, &case.mill, pose),
        finished_part: None,
        cell,
        memory: 2e9,
    };
    let found = forces(&problem, &Monitor::silent()).unwrap();
    let back = pose.rotation.transpose();
    let turned = |wrench: Wrench| Wrench { force: back * wrench.force, moment: back * wrench.moment };
    let mut along = 0.0;
    let mut last = found.path.points()[0].position;
    let mut kept = Vec::new();
    for (point, load) in found.path.points().iter().zip(&found.points) {
        along += (point.position - last).norm() * 1e3;
        last = point.position;
        if along < case.at[0] || along > case.at[1] {
            continue;
        }
        kept.push(PointForces { chip: turned(load.chip), edge: turned(load.edge), ..*load });
    }
    assert!(!kept.is_empty(), "{}", case.name);
    (found, kept)
}

fn off(found: Vector3<f64>, is: [f64; 3]) -> f64 {
    let is = Vector3::from(is);
    (found - is).norm() / is.norm()
}

/// How far a case is off over all poses.
#[derive(Clone, Copy)]
struct Errors {
    /// Of force (rms, largest), moment (largest) and volume (of the mean).
    errors: [f64; 4],
    /// The difference of the force that runs state, rms, mean of all.
    stated: f64,
    /// m
    cell: f64,
}

fn errors(case: &Case, cell: Option<f64>) -> Errors {
    let (mut squares, mut count, mut largest, mut moment, mut volume) = (0.0, 0.0, 0.0_f64, 0.0_f64, 0.0);
    let (mut taken, mut stated) = (0.0, 0.0);
    let poses = poses();
    for pose in &poses {
        let (whole, found) = loads(case, cell, pose);
        taken = whole.cell;
        stated += whole.difference.rms[0] / poses.len() as f64;
        for load in found {
            let all = load.at_feed(1.0);
            let error = off(all.force, case.is.0);
            squares += error * error;
            count += 1.0;
            largest = largest.max(error);
            if case.is.1 != [0.0; 3] {
                moment = moment.max(off(all.moment * 1e3, case.is.1));
            }
            volume += load.removed * 1e6 / case.is.2 - 1.0;
        }
    }
    let errors = [f64::sqrt(squares / count), largest, moment, f64::abs(volume / count)];
    Errors { errors, stated, cell: taken }
}

/// What is left of errors by the points of the quadrature and the lattice, whatever the cell.
const NOISE: f64 = 0.006;

#[test]
#[expect(clippy::print_stdout, reason = "the guide states what it prints")]
fn forces_are_those_of_closed_forms_at_the_default_cell() {
    let mut wrong = Vec::new();
    for case in some(3, cases()) {
        let Errors { errors: found, cell, .. } = errors(&case, None);
        let [rms, largest, moment, volume] = found.map(|error| error * 100.0);
        println!(
            "{:36} cell {:.3} mm: force {rms:.2} % rms, {largest:.2} % largest, moment {moment:.2} %, volume {volume:.2} %",
            case.name,
            cell * 1e3
        );
        if found.iter().zip(case.within).any(|(found, within)| found.is_nan() || *found > within) {
            wrong.push(case.name);
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// Half the cell, and the error falls, but where it is no more than the noise of the lattice; and the difference that a
/// run states of itself is no less than its error.
#[test]
#[expect(clippy::print_stdout, reason = "the guide states what it prints")]
fn half_the_cell_takes_the_error_down_and_the_stated_difference_covers_it() {
    let names = ["ball raster 1.5", "ball slot", "plunge", "bull slot", "tapered ball slot", "down, a_e 1 a_p 10"];
    for name in some(3, names) {
        let case = cases().into_iter().find(|case| case.name == name).unwrap();
        let of_cell = [1e-3, 0.5e-3, 0.25e-3].map(|cell| errors(&case, Some(cell)));
        let error = of_cell.map(|found| found.errors[0]);
        let stated = of_cell.map(|found| found.stated);
        println!("{name:36} error {error:.4?}, stated {stated:.4?} at 1, 0.5, 0.25 mm");
        for k in 0..2 {
            assert!(error[k + 1] < 0.75 * error[k] || error[k + 1] < NOISE, "{name}: {error:?}");
        }
        for k in 0..3 {
            assert!(stated[k] > error[k] || error[k] < NOISE, "{name}: {stated:?} {error:?}");
        }
    }
}
