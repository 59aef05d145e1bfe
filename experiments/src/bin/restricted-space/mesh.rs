//! How far the free angle about the tool axis alone gets along two lines inside a half-closed box, and what stands in
//! the way: the obstacle mesh of *A Benchmark for Robotic Milling in Restricted Spaces* (Su et al. 2026, IJMTM 215,
//! 104364; its public repository; binary STL in metres, y up), which is not part of this repository. The arm is the
//! KUKA KR 210-2 of the catalogue (the paper has an ABB IRB 6660, whose geometry is not public); base column,
//! shoulder and links are capsules along its rows. The box stands with its slot, above the inclined front wall,
//! towards the robot. The spindle is square to axis 6, its tip 600 mm from that: straight on that axis, the free
//! angle would turn joint 6 and move nothing else.
//!
//! Both lines run along the whole length of the box (1.3 m, 651 points, 2 mm apart) with the tool upright. The place of
//! the paper's line is in the paper only; ours are
//!
//! - the channel floor, 25 mm above the underside of the box, half way between its ends in depth: planned at all points
//!   when this was written;
//! - a line over the step, at the height of the step's top. It lies on the step up to x = 190 mm alone; from there on
//!   the step recedes and the line is in the air over the channel, 275 mm above its floor.
//!
//! The box stands where a search found a plan for the first of them, and is not moved for the second.

use super::write_line;
use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::Path;
use stead_planning::feasibility::explain;
use stead_problem::constraints::{ConstraintKind, Measured};

/// Points of a line, and their distance. mm
const LINE: (usize, f64) = (651, 2.0);
/// What a line is, and where it is in the box turned upright: in depth, from the slot on, and in height. mm
const LINES: [(&str, f64, f64); 2] = [("the channel floor", 0.0, 25.0), ("the height of the step", 150.0, 300.0)];
/// The box, turned about the vertical until its slot faces the robot: its origin (mm), and the sine of half of the
/// turn.
const BOX: [f64; 3] = [791.0, -2773.0, 397.0];
const Q4: f64 = 0.999877;
/// Of every so many points all states are evaluated.
const EVERY: usize = 10;

const RUN: &str = "robot = \"name:kuka-kr210-2\"\ntask = \"line.csv\"\nsurroundings = \"box.toml\"\n\n[spindle]\n\
    xyz_mm = [600.0, 0.0, 120.0]\nrotation = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]\n\n[constraints]\n\
    min_inverse_condition = 0.05\ncharacteristic_length_mm = 700.0\n\n[redundancy]\nbeta_step_deg = 3.0\nfeed_mm_per_s = 20.0\n\
    max_beta_rate_deg_per_mm = 2.0\n\n";

/// The arm, its base column and the spindle; what is not the box.
const ARM: &str = r#"
[[shape]]
name = "base column"
attached = "base"
capsule_mm = { radius = 250.0, length = 600.0 }
xyz_mm = [0.0, 0.0, 300.0]

[[shape]]
name = "shoulder"
attached = "link_1"
capsule_mm = { radius = 200.0, length = 350.0 }
xyz_mm = [175.0, 0.0, 0.0]
rpy_deg = [0.0, 90.0, 0.0]

[[shape]]
name = "upper arm"
attached = "link_2"
capsule_mm = { radius = 170.0, length = 1250.0 }
xyz_mm = [625.0, 0.0, 0.0]
rpy_deg = [0.0, 90.0, 0.0]

[[shape]]
name = "forearm"
attached = "link_4"
capsule_mm = { radius = 135.0, length = 700.0 }
xyz_mm = [0.0, 0.0, -450.0]

[[shape]]
name = "wrist"
attached = "link_5"
capsule_mm = { radius = 105.0, length = 110.0 }
rpy_deg = [90.0, 0.0, 0.0]

[[shape]]
name = "spindle"
attached = "flange"
cylinder_mm = { radius = 75.0, length = 300.0 }
xyz_mm = [330.0, 0.0, 120.0]
rpy_deg = [0.0, 90.0, 0.0]

[[shape]]
name = "holder"
attached = "flange"
cylinder_mm = { radius = 25.0, length = 70.0 }
xyz_mm = [515.0, 0.0, 120.0]
rpy_deg = [0.0, 90.0, 0.0]

[collision]
clearance_mm = 0.0
ignore = [["link_2", "link_4"], ["base column", "upper arm"], ["base column", "shoulder"]]
"#;

/// What the free angle alone does in the box of a mesh file.
pub fn study_mesh(folder: &Path, mesh: &str) -> Result<(), Box<dyn Error>> {
    let mesh = fs::canonicalize(mesh)?;
    LINES.iter().try_for_each(|line| study(folder, &mesh, *line))
}

fn study(folder: &Path, mesh: &Path, (name, depth, height): (&str, f64, f64)) -> Result<(), Box<dyn Error>> {
    // The task lies in the frame of the box turned upright: x along, y into the depth, z up.
    let ends = [0.0, (LINE.0 - 1) as f64 * LINE.1];
    write_line(&folder.join("line.csv"), [depth, height], ends, LINE.0, [0.0, 100.0, 0.0])?;
    let [x, y, z] = BOX;
    let cell = format!("[cell]\nx_mm = [{x}, {x}]\ny_mm = [{y}, {y}]\nz_mm = [{z}, {z}]\nq4 = [{Q4}, {Q4}]\n");
    fs::write(folder.join("run.toml"), format!("{RUN}{cell}"))?;
    let shapes = format!(
        "[[shape]]\nname = \"box\"\nattached = \"workpiece\"\nmesh = {:?}\nunit = \"m\"\nrpy_deg = [90.0, 0.0, 0.0]\n{ARM}",
        mesh.display().to_string()
    );
    fs::write(folder.join("box.toml"), shapes)?;
    let run = stead::Run::read(folder.join("run.toml"))?;
    run.notes().iter().for_each(|note| println!("note: {note}"));
    let problem = run.problem();
    let placement = problem.cell.pinned().ok_or("the box is pinned")?;
    let (mut reached, mut free, mut free_points) = (0, 0, 0);
    let mut blocking: BTreeMap<String, usize> = BTreeMap::new();
    for point in (0..problem.task.points().len()).step_by(EVERY) {
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
        "{name}: {} points at depth {depth} and height {height} mm of the box, which stands at {BOX:?} mm, turned by {:.1} deg",
        LINE.0,
        2.0 * libm::asin(Q4).to_degrees()
    );
    println!(
        "{free_points} of {} points evaluated have a free state; {free} of {reached} states within the limits of the joints are free",
        problem.task.points().len().div_ceil(EVERY)
    );
    for (pair, count) in blocking {
        println!("  {pair}: {count} states");
    }
    match run.score(&placement, &stead::Monitor::silent()) {
        Ok(score) => println!("the whole line can be cut: mean {:.4} mm", score.score().plans.best.mean * 1e3),
        Err(error) => {
            println!("the whole line cannot be cut: {}", error.to_string().lines().next().unwrap_or_default())
        }
    }
    Ok(())
}
