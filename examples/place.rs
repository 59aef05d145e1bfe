//! Where should the workpiece stand? `cargo run --release --example place`

#![allow(clippy::print_stdout, reason = "an example prints what it finds")]

use stead::model::nalgebra::{Vector3, vector};
use stead::model::task::{PathPoint, Task, ToolPath, Wrench};
use stead::placement::criterion::Weights;
use stead::placement::{Cell, Constraints, Interval, Problem, Redundancy};
use stead::{Monitor, PlaceOptions, Progress, Run};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A wall of 200 mm in 21 points, cut along x with an upright tool; robot and spindle are those of a file.
    let (feed, axis, force) = (Vector3::x(), Vector3::z(), vector![-150.0, 280.0, 50.0]);
    let point = |k: u32| (1, PathPoint { position: vector![0.01 * f64::from(k), 0.0, 0.0], feed, axis });
    let wrenches = vec![Wrench { force, moment: Vector3::zeros() }; 21];
    let task = Task::new(ToolPath::new((0..21).map(point))?, wrenches)?;
    let shipped = Run::read("configs/caro-2013.toml")?;
    let (robot, spindle) = (shipped.problem().robot.clone(), shipped.problem().spindle);

    // Where it may stand, and how the spindle may turn about the tool axis. SI units and radians.
    let range = |min, max| Interval { min, max };
    let cell = Cell { position: [range(-0.3, 0.3), range(-2.2, -1.6), range(-0.5, -0.3)], yaw: range(-3.1, 3.1) };
    let redundancy = Redundancy { max_beta_rate: Some(15.0), ..Redundancy::new(60, 0.05) };
    let mut parts = Problem::builder(robot, spindle, task, cell, redundancy);
    parts.constraints = Constraints { min_inverse_condition: 0.2, characteristic_length: 0.7, ..Default::default() };
    parts.criterion.weights = Weights::TOTAL;

    // A monitor hears how far a job is; its stop handle ends the job with what there is by then.
    let monitor = Monitor::new(|progress| match progress {
        Progress::Search { stage, done, total, .. } if done % 10 == 0 => println!("{stage}: {done} of {total}"),
        _ => {}
    });
    let mut options = PlaceOptions::default();
    (options.search.population, options.search.worst) = (60, false);
    let placements = Run::builder(parts.build()?).options(options).build()?.place(&monitor)?;

    // Values, text and files: as of the command.
    let best = &placements.cases().best;
    println!("{placements}\nbest: {:?}, mean deflection {:.4} mm", best.placement, best.plan.mean * 1e3);
    println!("{} files", placements.write(std::env::temp_dir().join("stead-example"))?.len());
    Ok(())
}
