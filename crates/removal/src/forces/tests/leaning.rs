//! A ball that leans in a slot, against a fine integral over its surface that knows nothing of lines or moves.

use super::*;
use crate::leaning::leaning_forces;
use stead_model::task::lean::{ContactRule, CutterEnd, Lean, LeanForce, LeanRule};
use stead_model::task::{Task, ToolPath, Wrench};

/// Radius of the ball, and depth of the slot. mm
const BALL: (f64, f64) = (8.0, 1.5);

/// A slot along x in the middle of a wide block.
fn slot() -> ForcesProblem {
    let (radius, depth) = BALL;
    let path = line(&along_x(depth), 2.0);
    ForcesProblem {
        stock: stock([[0.0, -30.0, -20.0], [80.0, 30.0, 0.0]], &Pose::identity()),
        operation: operation(&path, &mill(2.0 * radius, radius, 0.0), &Pose::identity()),
        ..shoulder([-30.0, 30.0], &along_x(depth))
    }
}

/// Chip and edge part of the mean force, and their moments about the tip, of a ball with an axis: over the half of it
/// ahead that is below the face of the block. A surface element with the normal n, out of the cutter, at the distance
/// r from the axis turns a share dA / (2 pi r) of the time in a tooth; its chip per turn is the feed per turn times
/// n . x.
fn of_surface(axis: &Vector3<f64>) -> [Wrench; 2] {
    let (radius, depth) = (BALL.0 * 1e-3, BALL.1 * 1e-3);
    let cutter = mill(2.0 * BALL.0, BALL.0, 0.0).cutter;
    let (k, teeth) = (cutter.coefficients(), cutter.teeth().len() as f64);
    // As of the operation: 20 mm/s at 100 turns per second.
    let feed_per_turn = 0.02 / 100.0;
    let [mut chip, mut edge] = [Wrench::default(); 2];
    let steps = 1200;
    for row in 0..steps {
        // From the lowest point of the ball up to the face, in rings of equal height.
        let height = depth * (row as f64 + 0.5) / steps as f64;
        let ring = (2.0 * radius * height - height * height).sqrt();
        for column in 0..steps {
            let around = std::f64::consts::PI * ((column as f64 + 0.5) / steps as f64 - 0.5);
            let (s, c) = libm::sincos(around);
            let n = Vector3::new(ring * c, ring * s, height - radius) / radius;
            // Rings of equal height have equal areas on a ball.
            let area = radius * depth / steps as f64 * std::f64::consts::PI / steps as f64;
            let y = n * radius;
            let across = y - axis * y.dot(axis);
            let r = across.norm();
            let t = (across / r).cross(axis);
            let side = t.cross(&n);
            let share = area / (std::f64::consts::TAU * r);
            let of_chip = (n * -k.radial - t * k.tangential + side * k.axial) * (share * feed_per_turn * n.x);
            let of_edge = (n * -k.radial_edge - t * k.tangential_edge) * (share * teeth);
            let lever = y + axis * radius;
            for (sum, force) in [(&mut chip, of_chip), (&mut edge, of_edge)] {
                sum.force += force;
                sum.moment += lever.cross(&force);
            }
        }
    }
    [chip, edge]
}

#[test]
fn a_leaning_ball_has_the_force_of_its_surface() {
    let problem = slot();
    let known = found(&problem);
    let rule = LeanRule {
        end: CutterEnd { radius: BALL.0 * 1e-3, corner: BALL.0 * 1e-3 },
        contact: ContactRule::Centre,
        force: LeanForce::Feed,
    };
    let leans = [[0.0, 0.0], [20.0, 0.0], [-15.0, 10.0], [5.0, -25.0]]
        .map(|[lead, tilt]: [f64; 2]| Lean { lead: lead.to_radians(), tilt: tilt.to_radians() });
    let task = Task::new(known.path.clone(), known.wrenches()).unwrap();
    let leaned = leans.map(|lean| task.leaned(&rule, &vec![lean; task.points().len()]));
    let paths: Vec<ToolPath> = leaned.iter().map(|task| task.path().clone()).collect();
    let all = leaning_forces(&problem, &known, &paths, &Monitor::silent()).unwrap();
    // A tool that does not lean has what is known, to the last digit.
    for (own, known) in all[0].iter().zip(&known.points) {
        assert_eq!((own.chip, own.edge), (known.chip, known.edge));
    }
    let mut differs = 0.0_f64;
    for (found, lean) in all.iter().zip(&leans) {
        let axis = lean.axis(&task.points()[0]);
        let expected = of_surface(&axis);
        let scale = (expected[0].force + expected[1].force).norm();
        for load in &found[8..23] {
            for (own, expected) in [(&load.chip, &expected[0]), (&load.edge, &expected[1])] {
                let off = (own.force - expected.force).norm() / scale;
                let turned = (own.moment - expected.moment).norm() / (scale * BALL.0 * 1e-3);
                assert!(off < 0.05 && turned < 0.05, "{lean:?}: {off} {turned} {own:?} {expected:?}");
            }
        }
        let upright = of_surface(&Vector3::z());
        differs = differs.max((expected[0].force - upright[0].force).norm() / upright[0].force.norm());
    }
    assert!(differs > 0.2, "{differs}");
}
