//! Which posture of an arm yields least? `cargo run --release --example robot`

#![allow(clippy::print_stdout, reason = "an example prints what it finds")]

use stead::model::nalgebra::{Vector3, vector};
use stead::model::robot::{Frames, Joint, Posture, Robot};
use stead::model::stiffness::displacement;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Six rows, base first: modified Denavit-Hartenberg in deg and m, limits in deg, stiffness in MN m/rad. All else is
    // in SI units and radians.
    let row = |alpha: f64, a, d, limit: [f64; 2], stiffness: f64| {
        let [min, max] = limit.map(f64::to_radians);
        let (max_speed, max_acceleration, max_jerk, compliance) = (None, None, None, (1e-6 / stiffness).into());
        Joint { alpha: alpha.to_radians(), a, d, min, max, max_speed, max_acceleration, max_jerk, compliance }
    };
    let rows = [
        row(0.0, 0.0, 0.0, [-185.0, 185.0], 1.85),
        row(90.0, 0.35, 0.0, [0.0, 146.0], 3.32),
        row(0.0, 1.25, 0.0, [-245.0, 29.0], 2.79),
        row(-90.0, 0.055, 1.1, [-350.0, 350.0], 0.486),
        row(90.0, 0.0, 0.0, [-125.0, 125.0], 0.521),
        row(-90.0, 0.0, 0.0, [-350.0, 350.0], 0.38),
    ];
    let robot = Robot::new("an arm like the KUKA KR270-2", rows)?;

    // The flange at joint angles, all postures that reach it there, and what each yields under 500 N to the left.
    let flange = robot.forward(&[0.3, 1.2, -2.0, 0.0, 1.0, 0.0]);
    println!("{}: flange at {:.4?} m", robot.name(), flange.translation.as_slice());
    for posture in Posture::ALL {
        let Ok(joints) = robot.inverse(&flange, posture) else { continue };
        let (frames, compliances) = (Frames::new(&robot, &joints), robot.compliances_at(&joints));
        let (force, moment) = (vector![0.0, 500.0, 0.0], Vector3::zeros());
        let moved = displacement(&frames, &flange.translation, &compliances, &force, &moment);
        println!("posture {posture}: {:7.2?} deg, {:.3} mm", joints.map(f64::to_degrees), moved.linear.norm() * 1e3);
    }
    Ok(())
}
