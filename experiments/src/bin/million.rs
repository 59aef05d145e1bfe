//! How long paths are planned: very many points in one segment, planned and scored once, best and worst.
//!
//! `cargo run --release -p stead-experiments --bin million -- configs/caro-2013.toml 250000 500000 1000000 [PATH.csv]`
//! takes robot, spindle and rules from the run file, and prints for each number of points the time and the most memory
//! that the process has had so far. The last path is written to a CSV file if one is given, to be tried with
//! `stead score`.

#![allow(clippy::print_stdout, reason = "an experiment prints")]

use nalgebra::Vector3;
use std::env;
use std::error::Error;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;
use stead_model::task::{PathPoint, Task, ToolPath, Wrench};
use stead_numerics::monitor::Monitor;
use stead_placement::place::score;
use stead_problem::problem::Placement;
use stead_run_files::read_run;
use stead_runs::Run;

/// Distance between neighbours. m
const SPACING: f64 = 1e-4;
/// Half the width of the figure eight. m
const WIDTH: f64 = 0.25;
/// What one round of it is deeper than the one before. m
const DEPTH: f64 = 5e-4;

fn main() -> Result<(), Box<dyn Error>> {
    let (files, counts): (Vec<String>, Vec<String>) =
        env::args().skip(1).partition(|text| text.parse::<usize>().is_err());
    let config = files.first().ok_or("usage: million CONFIG POINTS.. [PATH.csv]")?;
    let Run { problem, transfer, .. } = read_run(Path::new(config))?;
    // Within easy reach of the arm of the shipped run file.
    let placement = Placement { x: 0.0, y: -1.8, z: -0.4, yaw: 0.0 };
    println!("points    seconds  us a point  peak MB  best mm   worst mm");
    for count in &counts {
        let count = count.parse()?;
        let task = eights(count)?;
        if let (Some(csv), true) = (files.get(1), Some(count) == counts.last().and_then(|last| last.parse().ok())) {
            std::fs::write(csv, table(&task)?)?;
        }
        let problem = problem.changed(|parts| parts.task = task)?;
        let start = Instant::now();
        let scored = score(&problem, &placement, &transfer, &Monitor::silent())?;
        let seconds = start.elapsed().as_secs_f64();
        let each = seconds / count as f64 * 1e6;
        let memory = peak_memory().map_or("?".to_owned(), |bytes| format!("{:.0}", bytes as f64 / 1e6));
        let (best, worst) = (scored.plans.best.mean * 1e3, scored.plans.worst.mean * 1e3);
        println!("{count:<9} {seconds:<8.1} {each:<11.1} {memory:<8} {best:<9.5} {worst:.5}");
    }
    Ok(())
}

/// Rounds of a figure eight (Bernoulli's lemniscate), each a little deeper: its points as one segment. It turns as much
/// to the left as to the right, so that no joint has to wind up.
fn eights(count: usize) -> Result<Task, Box<dyn Error>> {
    let mut points = Vec::with_capacity(count);
    let mut wrenches = Vec::with_capacity(count);
    let mut t: f64 = 0.0;
    for _ in 0..count {
        let (s, c) = libm::sincos(t);
        let d = 1.0 + s * s;
        let slope = -DEPTH / std::f64::consts::TAU;
        let position = Vector3::new(WIDTH * c / d, WIDTH * s * c / d, slope * t);
        let velocity = Vector3::new(
            -WIDTH * s * (2.0 + c * c) / (d * d),
            WIDTH * (c * c * (1.0 - s * s) - s * s * d) / (d * d),
            slope,
        );
        let speed = velocity.norm();
        let feed = velocity / speed;
        points.push((1, PathPoint { position, feed, axis: Vector3::z() }));
        let force = feed * -150.0 + Vector3::z().cross(&feed) * 200.0 + Vector3::z() * 40.0;
        wrenches.push(Wrench { force, moment: Vector3::zeros() });
        t += SPACING / speed;
    }
    Ok(Task::new(ToolPath::new(points)?, wrenches)?)
}

/// The task as a file.
fn table(task: &Task) -> Result<String, std::fmt::Error> {
    let mut text = String::from(
        "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,force_x_n,force_y_n,force_z_n\n",
    );
    for (point, wrench) in task.points().iter().zip(task.wrenches()) {
        let (p, d, a, w) = (point.position * 1e3, point.feed, point.axis, wrench.force);
        writeln!(
            text,
            "1,{:.6},{:.6},{:.6},{:.9},{:.9},{:.9},{},{},{},{:.6},{:.6},{:.6}",
            p.x, p.y, p.z, d.x, d.y, d.z, a.x, a.y, a.z, w.x, w.y, w.z
        )?;
    }
    Ok(text)
}

/// The most memory that this process has had, where the system tells. Bytes
fn peak_memory() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    line.split_whitespace().nth(1)?.parse::<usize>().ok().map(|kilobytes| kilobytes * 1024)
}
