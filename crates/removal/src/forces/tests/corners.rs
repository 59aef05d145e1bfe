//! Corners of leaning cutters, against integrals over 1 260 elements of the corner and 2 016 angles of a cutter that is
//! put down every 0.043 mm, which know nothing of lines or moves.

use super::*;
use oracles::{Knot, line, operation, stock};
use std::f64::consts::TAU;
use stead_model::cutting::{Coefficients, Tooth};
use stead_model::testing::some;

/// A straight row along x with the tip at the origin, in a solid below a top, beside an earlier row of the same cutter.
struct Row {
    name: &'static str,
    /// Diameter and corner radius (mm), taper (deg), teeth and feed of a tooth (mm).
    cutter: ([f64; 3], u8, f64),
    axis: [f64; 3],
    /// Top of the solid, and y of the row before. mm
    top_and_row: [f64; 2],
    /// Chip and edge part of the force (N).
    chip: [f64; 3],
    edge: [f64; 3],
    /// N mm about the tip.
    moment: [f64; 3],
    /// mm3 for each mm of path.
    removed: f64,
}

const ROWS: [Row; 6] = [
    Row {
        name: "bull D 12 r 2, lead 5",
        cutter: ([12.0, 2.0, 0.0], 3, 0.06),
        axis: [0.087155743, 0.0, 0.996194698],
        top_and_row: [0.5, -2.0],
        chip: [-5.1730, 4.8918, 3.4831],
        edge: [-12.6943, 7.1706, 11.7122],
        moment: [49.5314, -52.1191, 114.1312],
        removed: 1.7055,
    },
    Row {
        name: "bull D 20 r 3, lead 5, tilt 5",
        cutter: ([20.0, 3.0, 0.0], 4, 0.06),
        axis: [0.087155743, 0.086824089, 0.992403877],
        top_and_row: [0.5, -3.0],
        chip: [-11.9174, 6.7289, 5.6265],
        edge: [-27.3598, 6.2475, 18.4678],
        moment: [177.9994, -100.9190, 365.8368],
        removed: 4.1162,
    },
    Row {
        name: "bull D 16 r 4, lead 8, tilt -6",
        cutter: ([16.0, 4.0, 0.0], 2, 0.08),
        axis: [0.139173101, -0.103511199, 0.984843277],
        top_and_row: [1.0, -4.0],
        chip: [-6.0571, 18.2365, 11.8763],
        edge: [-11.1539, 19.6291, 23.1721],
        moment: [53.8548, -187.9160, 285.6455],
        removed: 6.8745,
    },
    Row {
        name: "ball D 10, lead 10, tilt 15",
        cutter: ([10.0, 5.0, 0.0], 2, 0.08),
        axis: [0.173648178, 0.254887002, 0.951251243],
        top_and_row: [0.6, -0.8],
        chip: [-3.6141, 2.5228, 1.7942],
        edge: [-9.4248, 3.6597, 7.2418],
        moment: [22.8336, -15.5934, 44.4069],
        removed: 0.6707,
    },
    Row {
        name: "taper D 6 r 2, 5 deg, lead 3",
        cutter: ([6.0, 2.0, 5.0], 3, 0.04),
        axis: [0.052335956, 0.0, 0.998629535],
        top_and_row: [0.8, -1.0],
        chip: [-4.5052, 3.6166, 2.6436],
        edge: [-15.9246, 7.1926, 13.3208],
        moment: [19.7821, -24.8388, 48.3824],
        removed: 0.8531,
    },
    Row {
        name: "bull D 12 r 1, upright, row on the left",
        cutter: ([12.0, 1.0, 0.0], 3, 0.06),
        axis: [0.0, 0.0, 1.0],
        top_and_row: [0.7, 5.0],
        chip: [5.8393, 12.2280, 4.9269],
        edge: [7.6265, 15.9006, 10.1583],
        moment: [-61.5129, -52.0152, 179.1196],
        removed: 3.5025,
    },
];

/// Largest share that the force, its chip and edge part, the moment and the volume may be off.
const WITHIN: [f64; 5] = [0.01, 0.015, 0.015, 0.015, 0.015];

impl Row {
    fn mill(&self) -> EndMill {
        let ([diameter, corner, taper], teeth, _) = self.cutter;
        let tooth = Tooth { pitch: TAU / f64::from(teeth), radius: diameter / 2e3 };
        let coefficients =
            Coefficients { tangential: 800e6, radial: 320e6, axial: 100e6, tangential_edge: 20e3, radial_edge: 15e3 };
        let teeth = vec![tooth; usize::from(teeth)];
        EndMill {
            cutter: Cutter::new(teeth, 0.0, Some(0.04), Rotation::Clockwise, coefficients).unwrap(),
            flute_length: 0.04,
            corner_radius: corner / 1e3,
            taper: taper.to_radians(),
            is_centre_cutting: true,
            holder: Vec::new(),
        }
    }

    /// The problem in a pose, and the mean of the loads at its middle, turned back.
    fn found(&self, pose: &Pose<f64>) -> (f64, [Vector3<f64>; 3], f64) {
        let (_, teeth, feed_per_tooth) = self.cutter;
        let [top, before] = self.top_and_row;
        let row = |y: f64| -> Vec<Knot> { vec![([10.0, y, 0.0], self.axis), ([40.0, y, 0.0], self.axis)] };
        let mill = self.mill();
        let at = |y: f64| {
            let mut one = operation(&line(&row(y), 2.0), &mill, pose);
            one.spindle_speed = 0.02 / (feed_per_tooth * 1e-3 * f64::from(teeth));
            one
        };
        let problem = ForcesProblem {
            stock: stock([[-10.0, -30.0, -8.0], [60.0, 30.0, top]], pose),
            before: vec![at(before)],
            operation: at(0.0),
            finished_part: None,
            cell: None,
            memory: 2e9,
        };
        let found = forces(&problem, &Monitor::silent()).unwrap();
        let back = pose.rotation.transpose();
        let middle: Vec<_> = found.points.iter().filter(|point| !point.is_added).skip(4).take(8).collect();
        let mean = |of: &dyn Fn(&PointForces) -> Vector3<f64>| {
            back * middle.iter().map(|point| of(point)).sum::<Vector3<f64>>() / middle.len() as f64
        };
        let loads = [
            mean(&|point| point.chip.force),
            mean(&|point| point.edge.force),
            mean(&|point| point.at_feed(1.0).moment * 1e3),
        ];
        (found.cell, loads, middle.iter().map(|point| point.removed * 1e6).sum::<f64>() / middle.len() as f64)
    }
}

#[test]
#[expect(clippy::print_stdout, reason = "the guide states what it prints")]
fn leaning_corners_have_the_forces_of_their_surface() {
    let (s, c) = libm::sincos(37_f64.to_radians());
    let turned = Pose {
        rotation: Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0),
        translation: Vector3::new(0.0137, -0.0071, 0.0043),
    };
    let mut wrong = Vec::new();
    for row in some(2, &ROWS) {
        let [chip, edge, moment] = [row.chip, row.edge, row.moment].map(Vector3::from);
        for pose in [Pose::identity(), turned] {
            let start = std::time::Instant::now();
            let (cell, found, removed) = row.found(&pose);
            let off = |found: Vector3<f64>, is: Vector3<f64>| (found - is).norm() / is.norm();
            let force = off(found[0] + found[1], chip + edge);
            let errors = [
                force,
                off(found[0], chip),
                off(found[1], edge),
                off(found[2], moment),
                (removed / row.removed - 1.0).abs(),
            ];
            let [force, of_chip, of_edge, of_moment, volume] = errors.map(|error| error * 100.0);
            println!(
                "{:40} cell {:.3} mm: force {force:.2} %, chip {of_chip:.2} %, edge {of_edge:.2} %, moment {of_moment:.2} %, volume {volume:.2} % {:?}",
                row.name,
                cell * 1e3,
                start.elapsed()
            );
            if errors.iter().zip(WITHIN).any(|(error, within)| error.is_nan() || *error > within) {
                wrong.push(row.name);
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}
