//! Where is there room for the part between fence and pillar? `cargo run --release --example collide`

#![allow(clippy::print_stdout, reason = "an example prints what it finds")]

use stead::{Error, Monitor, Placement, Run};

fn main() -> Result<(), Error> {
    // Arm, spindle, part and what stands around are shapes in `configs/cells/kr270-cell.toml`.
    let run = Run::read("configs/collision.toml")?;
    let at = |y: f64| Placement { x: 0.0, y, z: -0.214, yaw: 180_f64.to_radians() };
    for y in [-1.64, -1.84, -2.04, -2.24] {
        // The best plan in which nothing hits, or what forbids the placement at which points of the path.
        match run.score(&at(y), &Monitor::silent()) {
            Ok(score) => println!("y = {y} m: mean deflection {:.4} mm", score.score().plans.best.mean * 1e3),
            Err(Error::Infeasible(reason)) => println!("y = {y} m: {reason}"),
            Err(error) => return Err(error),
        }
    }

    // One state of the arm: what each of its eight postures breaks, and by how much.
    let explanations = run.explain(&at(-1.84), 30, 40_f64.to_radians())?;
    let allowed = explanations.postures().iter().filter(|posture| posture.is_allowed()).count();
    println!("{allowed} of 8 postures are allowed at point 30:\n{explanations}");
    Ok(())
}
