//! Milling in a restricted space: how far a tool gets along lines inside a half-closed box.
//!
//! `cargo run --release -p stead-experiments --bin restricted-space` prints what a leaning tool reaches in the box of
//! `configs/restricted-space.toml` (module `table`); from the root of the repository, some minutes. With a file behind
//! `--` it is about the mesh of a published benchmark (module `mesh`).

#![allow(clippy::print_stdout, reason = "an experiment prints")]

mod mesh;
mod table;

use std::env;
use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = env::temp_dir().join(format!("restricted-space-{}", std::process::id()));
    fs::create_dir_all(&folder)?;
    let done = match env::args().nth(1) {
        Some(mesh) => mesh::study_mesh(&folder, &mesh),
        None => table::print_table(&folder),
    };
    fs::remove_dir_all(&folder)?;
    done
}

/// A task file with points along a line at a depth and height of the box (mm), evenly from one end (mm) to the other,
/// and a force (N) at each.
fn write_line(
    file: &Path,
    [depth, height]: [f64; 2],
    ends: [f64; 2],
    count: usize,
    [fx, fy, fz]: [f64; 3],
) -> Result<(), Box<dyn Error>> {
    let mut text =
        "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,force_x_n,force_y_n,force_z_n\n".to_owned();
    for k in 0..count {
        let x = ends[0] + (ends[1] - ends[0]) * k as f64 / (count - 1) as f64;
        writeln!(text, "1,{x},{depth},{height},1,0,0,0,0,1,{fx},{fy},{fz}")?;
    }
    Ok(fs::write(file, text)?)
}
