//! Milling in a restricted space: how far the free angle about the tool axis alone gets along a line inside a half-closed box, and what
//! stands in the way.
//!
//! `cargo run --release --example restricted-space -- MESH` with the obstacle mesh of *A Benchmark for Robotic Milling in Restricted
//! Spaces* (Su et al. 2026, IJMTM 215, 104364; its public repository; binary STL in metres, y up): it is not part of this repository.
//! The arm is the KUKA KR 210-2 of the catalogue (the paper has an ABB IRB 6660, whose geometry is not public); links are capsules along its
//! rows. The place of the line is in the paper only: here it runs along the length of the box (1.3 m, 651 points, 2 mm apart) on the
//! floor of the step next to the channel. Both are stated with every figure.

#![allow(clippy::print_stdout, reason = "an example prints")]

use std::collections::BTreeMap;
use std::env;
use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use stead_placement::constraints::{ConstraintKind, Measured};
use stead_placement::feasibility::explain;

/// Points of the line, and their distance. mm
const LINE: (usize, f64) = (651, 2.0);
/// Where the line is in the box: height, and depth. mm
const HEIGHT: f64 = 300.0;
const DEPTH: f64 = -150.0;
/// The box, its length along x, upright, in front of the robot: its origin. mm
const BOX: [f64; 3] = [-650.0, -2000.0, -300.0];

const RUN: &str = "robot = \"name:kuka-kr210-2\"\ntask = \"line.csv\"\nsurroundings = \"box.toml\"\n\n[spindle]\nxyz_mm = [0.0, 0.0, 450.0]\n\
    rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]\n\n[constraints]\nmin_inverse_condition = 0.05\n\
    characteristic_length_mm = 700.0\n\n[redundancy]\nbeta_step_deg = 3.0\nfeed_mm_per_s = 20.0\nmax_beta_rate_deg_per_mm = 2.0\n\n";

fn main() -> Result<(), Box<dyn Error>> {
    let mesh = env::args().nth(1).ok_or("usage: restricted-space MESH")?;
    let mesh = fs::canonicalize(mesh)?;
    let folder = env::temp_dir().join(format!("restricted-space-{}", std::process::id()));
    fs::create_dir_all(&folder)?;
    let found = study(&folder, &mesh);
    fs::remove_dir_all(&folder)?;
    found
}

fn study(folder: &Path, mesh: &Path) -> Result<(), Box<dyn Error>> {
    let mut task =
        "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,force_x_n,force_y_n,force_z_n\n".to_owned();
    for point in 0..LINE.0 {
        // The task lies in the frame of the box turned upright: x along, y into the depth, z up.
        writeln!(task, "1,{},{},{HEIGHT},1,0,0,0,0,1,0,100,0", point as f64 * LINE.1, -DEPTH)?;
    }
    fs::write(folder.join("line.csv"), task)?;
    let [x, y, z] = BOX;
    let cell = format!("[cell]\nx_mm = [{x}, {x}]\ny_mm = [{y}, {y}]\nz_mm = [{z}, {z}]\nq4 = [0.0, 0.0]\n");
    fs::write(folder.join("run.toml"), format!("{RUN}{cell}"))?;
    let shapes = format!(
        "[[shape]]\nname = \"box\"\nattached = \"workpiece\"\nmesh = {:?}\nunit = \"m\"\nrpy_deg = [90.0, 0.0, 0.0]\n\n\
         [[shape]]\nname = \"upper arm\"\nattached = \"link_2\"\ncapsule_mm = {{ radius = 170.0, length = 1250.0 }}\n\
         xyz_mm = [625.0, 0.0, 0.0]\nrpy_deg = [0.0, 90.0, 0.0]\n\n[[shape]]\nname = \"forearm\"\nattached = \"link_4\"\n\
         capsule_mm = {{ radius = 135.0, length = 700.0 }}\nxyz_mm = [0.0, 0.0, -450.0]\n\n[[shape]]\nname = \"wrist\"\n\
         attached = \"link_5\"\ncapsule_mm = {{ radius = 105.0, length = 110.0 }}\nrpy_deg = [90.0, 0.0, 0.0]\n\n\
         [[shape]]\nname = \"spindle\"\nattached = \"flange\"\ncylinder_mm = {{ radius = 75.0, length = 300.0 }}\nxyz_mm = [0.0, 0.0, 180.0]\n\n\
         [[shape]]\nname = \"holder\"\nattached = \"flange\"\ncylinder_mm = {{ radius = 25.0, length = 70.0 }}\nxyz_mm = [0.0, 0.0, 365.0]\n\n\
         [collision]\nclearance_mm = 0.0\nignore = [[\"link_2\", \"link_4\"]]\n",
        mesh.display().to_string()
    );
    fs::write(folder.join("box.toml"), shapes)?;
    let run = stead::Run::read(folder.join("run.toml"))?;
    run.notes().iter().for_each(|note| println!("note: {note}"));
    let problem = run.problem();
    let placement = problem.cell.pinned().ok_or("the box is pinned")?;
    let (mut reached, mut free, mut free_points) = (0, 0, 0);
    let mut blocking: BTreeMap<String, usize> = BTreeMap::new();
    for point in 0..problem.task.points().len() {
        let mut is_free = false;
        for k in 0..problem.redundancy.beta_count {
            for explanation in explain(problem, &placement, point, problem.redundancy.beta(k)) {
                let hits: Vec<&Measured> =
                    explanation.violations.iter().filter(|v| v.kind() == ConstraintKind::Clearance).collect();
                if explanation.state.is_none() || hits.len() < explanation.violations.len() {
                    continue;
                }
                reached += 1;
                match hits.first() {
                    None => {
                        free += 1;
                        is_free = true;
                    }
                    Some(Measured::Clearance { names, .. }) => *blocking.entry(names.join(" and ")).or_default() += 1,
                    Some(_) => {}
                }
            }
        }
        free_points += usize::from(is_free);
    }
    println!(
        "line of {} points at x {x} y {} z {} mm of the base frame, box at {BOX:?} mm",
        LINE.0,
        y - DEPTH,
        z + HEIGHT
    );
    println!(
        "{free_points} of {} points have a free state; {free} of {reached} states within the limits of the joints are free",
        LINE.0
    );
    for (pair, count) in blocking {
        println!("  {pair}: {count} states");
    }
    match run.score(&placement) {
        Ok(score) => println!("the whole line can be cut: mean {:.4} mm", score.score().best.mean * 1e3),
        Err(error) => {
            println!("the whole line cannot be cut: {}", error.to_string().lines().next().unwrap_or_default())
        }
    }
    Ok(())
}
