//! What a leaning tool reaches in the box of `configs/restricted-space.toml`: two lines of 900 mm, both mounts of the
//! spindle, the box where searches found the most, with beta alone, with lead and with cones of 15 and 30 deg.
//!
//! - *points*: of 131 along the line those at which any state is allowed, each by itself: the axis every
//!   7.5 deg off that of the task in 12 directions, beta every 15 deg, all postures, every shape;
//! - *way*: the longest chain of such states in one posture over every second of these points (13.8 mm), the axis
//!   turning by at most 9 deg and beta by 15 deg from one to the next, each joint as fast as it may at 20 mm/s;
//! - *plan*: what `stead score` makes of that stretch with a point every 2 mm, all limits of the run included: the mean
//!   deflection, the least clearance with its pair, and how long it took.

use super::write_line;
use std::collections::HashSet;
use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::ops::Range;
use std::path::Path;
use std::time::Instant;

use rayon::prelude::*;
use stead::files::FieldOverride;
use stead::{Monitor, Run};
use stead_cell::{PairKind, Proximity};
use stead_model::robot::Posture;
use stead_model::robot::angles::wrap;
use stead_model::task::lean::{Lean, between};
use stead_planning::feasibility::without_clearance;
use stead_problem::problem::{Placement, Problem};
use stead_problem::setup::Setup;

const RUN: &str = "configs/restricted-space.toml";
/// Where the lines begin and end along the box. mm
const ALONG: [f64; 2] = [130.0, 1030.0];
/// Points at which states are evaluated, and how many of them a way goes at a time.
const POINTS: (usize, usize) = (131, 2);
/// The force at every point. N
const FORCE: [f64; 3] = [-60.0, 100.0, -20.0];
/// Distance of the points that are planned. mm
const STEP: f64 = 2.0;
/// How far the tool leans at these points: so many rings (rad) and directions.
const RING: f64 = 7.5 / 180.0 * PI;
const RINGS: usize = 4;
const AZIMUTHS: usize = 12;
/// Values of beta.
const BETAS: usize = 24;
/// The largest turn of the tool axis in a step of a way. rad
const TURN: f64 = 9.0 / 180.0 * PI;
/// A way of fewer points is not planned.
const LEAST_WAY: usize = 3;

/// A place of the box: origin (mm) and yaw (deg).
type Place = [f64; 4];

/// A line, its depth and height in the box (mm), and places of the box.
const LINES: [(&str, [f64; 2], &[Place]); 2] = [
    ("A", [0.0, 30.0], &[[637.9, -2592.6, 319.4, 160.8], [780.9, -2343.3, 18.4, 170.5]]),
    (
        "B",
        [380.0, 300.0],
        &[[-682.3, -870.8, -88.6, 304.7], [754.1, -1990.1, 230.5, 228.3], [793.7, -2049.9, 203.7, 219.6]],
    ),
];

/// What the tool may do: the range of lead and of tilt to either side, and together. deg
const FREEDOMS: [(&str, f64, f64, f64); 4] = [
    ("beta alone", 0.0, 0.0, 0.1),
    ("lead 15 deg", 15.0, 0.0, 15.0),
    ("cone 15 deg", 15.0, 15.0, 15.0),
    ("cone 30 deg", 30.0, 30.0, 30.0),
];

/// Mounts of the spindle, with what changes in the run file.
const MOUNTS: [(&str, &[&str]); 2] = [
    ("square to axis 6", &[]),
    (
        "straight on axis 6",
        &[
            "spindle.xyz_mm=[0.0, 0.0, 420.0]",
            "spindle.rotation=[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]",
            "shape[1].xyz_mm=[0.0, 0.0, 150.0]",
            "shape[1].rpy_deg=[0.0, 0.0, 0.0]",
            "shape[2].xyz_mm=[0.0, 0.0, 335.0]",
            "shape[2].rpy_deg=[0.0, 0.0, 0.0]",
        ],
    ),
];

/// An allowed state of a point.
struct Allowed {
    lean: usize,
    beta: usize,
    posture: Posture,
    joints: [f64; 6],
    /// The longest chain that ends in it. Points
    length: usize,
}

pub fn print_table(folder: &Path) -> Result<(), Box<dyn Error>> {
    println!(
        "| line | spindle | box at x, y, z (mm), yaw (deg) | tool | points of 131 | way of 66 | mean deflection, mm | least clearance, mm | s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    LINES.iter().try_for_each(|(line, at, places)| {
        places.iter().try_for_each(|place| MOUNTS.iter().try_for_each(|mount| rows(folder, (line, *at), place, mount)))
    })
}

/// The run with a task, a mount, a place of the box and what the tool may do.
fn run_with(
    task: &Path,
    mount: &[&str],
    [x, y, z, yaw]: &Place,
    (_, lead, tilt, most): (&str, f64, f64, f64),
) -> Result<Run, Box<dyn Error>> {
    let yaw = wrap(yaw.to_radians()).to_degrees();
    let mut values = vec![
        format!("task={}", task.display()),
        format!("cell.x_mm=[{x}, {x}]"),
        format!("cell.y_mm=[{y}, {y}]"),
        format!("cell.z_mm=[{z}, {z}]"),
        format!("cell.yaw_deg=[{yaw}, {yaw}]"),
        format!("lean.lead_deg=[-{lead:?}, {lead:?}]"),
        format!("lean.tilt_deg=[-{tilt:?}, {tilt:?}]"),
        format!("lean.max_lean_deg={most:?}"),
    ];
    values.extend(mount.iter().map(|value| (*value).to_owned()));
    let values = values.iter().map(|value| FieldOverride::parse(value)).collect::<Result<Vec<_>, _>>()?;
    Ok(Run::read_with(RUN, values, &Monitor::silent())?)
}

/// The rows of a line with the box at a place and the spindle mounted so.
fn rows(
    folder: &Path,
    (line, at): (&str, [f64; 2]),
    place: &Place,
    (mounted, mount): &(&str, &[&str]),
) -> Result<(), Box<dyn Error>> {
    let task = folder.join("line.csv");
    write_line(&task, at, ALONG, POINTS.0, FORCE)?;
    let run = run_with(&task, mount, place, FREEDOMS[3])?;
    let placement = run.problem().cell.pinned().ok_or("the box is pinned")?;
    let (leans, all) = states(run.problem(), &placement)?;
    for freedom in FREEDOMS {
        let (name, lead, tilt, most) = freedom;
        let is_free = |lean: &Lean| {
            let within = |angle: f64, most: f64| angle <= most.to_radians() + 1e-9;
            within(lean.lead.abs(), lead) && within(lean.tilt.abs(), tilt) && within(lean.angle(), most)
        };
        let free: HashSet<usize> = (0..leans.len()).filter(|k| is_free(&leans[*k])).collect();
        let reached = all.iter().filter(|states| states.iter().any(|state| free.contains(&state.lean))).count();
        let way = longest(run.problem(), &leans, &all, &free);
        let planned = match way.len() {
            ..LEAST_WAY => "- | - | -".to_owned(),
            _ => {
                let x =
                    |place: usize| ALONG[0] + (ALONG[1] - ALONG[0]) * (place * POINTS.1) as f64 / (POINTS.0 - 1) as f64;
                let ends = [x(way.start), x(way.end - 1)];
                let task = folder.join("stretch.csv");
                write_line(&task, at, ends, ((ends[1] - ends[0]) / STEP).round() as usize + 1, FORCE)?;
                plan(&run_with(&task, mount, place, freedom)?, &placement)
            }
        };
        let [x, y, z, yaw] = place;
        println!("| {line} | {mounted} | {x}, {y}, {z}, {yaw} | {name} | {reached} | {} | {planned} |", way.len());
    }
    Ok(())
}

/// Mean deflection, least clearance and seconds of a plan.
fn plan(run: &Run, placement: &Placement) -> String {
    let start = Instant::now();
    let scored = run.score(placement, &Monitor::silent());
    let seconds = start.elapsed().as_secs_f64();
    match scored {
        Ok(score) => {
            let plan = &score.score().plans.best;
            let clearance = plan.clearance.as_ref().map_or("-".to_owned(), |clearance| {
                format!("{:.1} ({})", clearance.distance * 1e3, clearance.names.join(", "))
            });
            format!("{:.4} | {clearance} | {seconds:.0}", plan.mean * 1e3)
        }
        Err(_) => format!("no plan | - | {seconds:.0}"),
    }
}

/// The leans of a cone, and of every point the allowed states in them.
type LeanStates = (Vec<Lean>, Vec<Vec<Allowed>>);

/// See [`LeanStates`].
#[expect(clippy::excessive_nesting, reason = "steps of one search that share what it keeps")]
fn states(problem: &Problem, placement: &Placement) -> Result<LeanStates, Box<dyn Error>> {
    let space = problem.lean.as_deref().ok_or("the tool leans")?;
    let path = problem.task.upright().path();
    let round = |tilt: usize| (0..AZIMUTHS).map(move |k| (RING * tilt as f64, TAU * k as f64 / AZIMUTHS as f64));
    let lean = |(tilt, azimuth): (f64, f64)| {
        let (sine, cosine) = libm::sincos(tilt);
        let (left, ahead) = libm::sincos(azimuth);
        Lean { lead: libm::atan2(sine * ahead, cosine), tilt: libm::asin(sine * left) }
    };
    let all = std::iter::once(Lean::NONE).chain((1..=RINGS).flat_map(round).map(lean));
    let leans: Vec<Lean> = all.filter(|lean| space.allows(path, 0, lean)).collect();
    let leaned: Vec<Problem> = leans
        .iter()
        .map(|lean| {
            let setup = Setup { leans: vec![*lean; POINTS.0].into(), ..problem.setup.clone() };
            problem.in_setup(&setup).into_owned()
        })
        .collect();
    let of_point = |point: usize| {
        let (mut all, mut known) = (Vec::new(), Proximity::default());
        for (lean, problem) in leaned.iter().enumerate() {
            for beta in 0..BETAS {
                let angle = -PI + TAU * beta as f64 / BETAS as f64;
                for found in without_clearance(problem, placement, point, angle) {
                    let Some(state) = found.state.as_ref().filter(|_| found.is_allowed()) else { continue };
                    let (posture, joints) = (found.posture, state.joints);
                    let kinds = &PairKind::OF_STATES;
                    if problem.at(placement).next_hit(point, angle, posture, kinds, &mut known).is_none() {
                        all.push(Allowed { lean, beta, posture, joints, length: 1 });
                    }
                }
            }
        }
        all
    };
    Ok((leans, (0..POINTS.0).into_par_iter().map(of_point).collect()))
}

/// The longest way, as places among every second point.
fn longest(problem: &Problem, leans: &[Lean], all: &[Vec<Allowed>], free: &HashSet<usize>) -> Range<usize> {
    let path = problem.task.upright().path();
    let point = &path.points()[0];
    let axes: Vec<_> = leans.iter().map(|lean| lean.axis(point)).collect();
    let may_follow: Vec<Vec<bool>> =
        axes.iter().map(|a| axes.iter().map(|b| between(a, b) <= TURN).collect()).collect();
    let time: f64 = (1..=POINTS.1).map(|point| problem.step_time(point)).sum();
    let steps: Vec<f64> = problem.robot.joints().iter().map(|j| j.max_speed.map_or(PI, |speed| speed * time)).collect();
    let (mut before, mut best): (Vec<Allowed>, Range<usize>) = (Vec::new(), 0..0);
    for (place, known) in all.iter().step_by(POINTS.1).enumerate() {
        let now = known.par_iter().filter(|state| free.contains(&state.lean)).map(|state| {
            let follows = |old: &&Allowed| {
                let apart = state.beta.abs_diff(old.beta);
                old.posture == state.posture
                    && (apart <= 1 || apart == BETAS - 1)
                    && may_follow[old.lean][state.lean]
                    && (0..6).all(|j| wrap(state.joints[j] - old.joints[j]).abs() <= steps[j])
            };
            let length = 1 + before.iter().filter(follows).map(|old| old.length).max().unwrap_or(0);
            Allowed { length, ..*state }
        });
        before = now.collect();
        let length = before.iter().map(|state| state.length).max().unwrap_or(0);
        if length > best.len() {
            best = place + 1 - length..place + 1;
        }
    }
    best
}
