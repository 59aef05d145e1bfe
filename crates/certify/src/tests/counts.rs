//! Why cells stay open: what the nodes of the boxes of least bound say, and which constraint leaves them undecided.

use super::super::arm::Margins;
use super::super::compliance_table::{Node, enclosed};
use super::super::interval_simd::WIDTH;
use super::*;
use crate::{Bound, best};
use stead_model::robot::{Joint, Spindle};
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::Planner;
use stead_problem::sense::Sense;
use stead_problem::settings::CertificateSettings;

/// Names of the margins, in the order of [`undecided`].
const NAMES: [&str; 6] = ["elbow", "joint 2", "joint 3", "joint 5", "wrist", "conditioning"];

/// Which constraints are not decided over a node, and whether its middle violates them.
fn undecided(setting: &Setting, place: [f64; 3], half: [f64; 3], class: PostureClass) -> Option<[[bool; 2]; 6]> {
    let y = enclosed(&setting.model.arm, &[place; WIDTH], half, class)?;
    let Margins { elbow, joints: [second, third], joint5, wrist, conditioning, .. } = &y.margins;
    let of = |margin: &super::super::enclosure::Enclosure| {
        let (low, middle) = (margin.value.low().0[0], margin.middle().value.0[0]);
        [low < 0.0, middle < 0.0]
    };
    let either = |[a, b]: [[bool; 2]; 2]| [a[0] || b[0], a[1] || b[1]];
    let [second, third] = [second, third].map(|pair| either([of(&pair[0]), of(&pair[1])]));
    Some([of(elbow), second, third, of(joint5), of(wrist), of(conditioning)])
}

/// The best of some random placements, and of steps from it.
fn found(problem: &Problem) -> (f64, Placement) {
    let planner = Planner::new(problem);
    let mut space = planner.workspace();
    let mut worth = |p: &Placement| planner.objective(p, Sense::Min, None, &mut space).mean().unwrap_or(f64::INFINITY);
    let mut random = seeded(91);
    let ([x, y, z], yaw) = (problem.cell.position, problem.cell.yaw);
    let mut best = (f64::INFINITY, Placement::from([0.0; 4]));
    for k in 0..600 {
        let size = [1.0, 0.3, 0.1, 0.03, 0.01, 0.003][k / 100];
        let at: [f64; 4] = std::array::from_fn(|c| {
            let range = [x, y, z, yaw][c];
            let middle = if k < 100 { range.min + 0.5 * range.width() } else { best.1[c] };
            (middle + 0.5 * size * range.width() * random.random_range(-1.0..1.0)).clamp(range.min, range.max)
        });
        let value = worth(&at.into());
        if value < best.0 {
            best = (value, at.into());
        }
    }
    best
}

fn counted(name: &str, problem: Problem) -> String {
    let setting = Setting::new(problem);
    let (value, _) = found(&setting.problem);
    let settings = CertificateSettings { time_limit: None, ..CertificateSettings::new(0.01) };
    let until = std::time::Instant::now() + std::time::Duration::from_secs(150);
    let monitor = Monitor::silent().with_deadline(Some(until));
    let Bound { bound, mut open, status, .. } = best(&setting.problem, value, &settings, &monitor).unwrap();
    let mut text =
        format!("{name}: value {:.5} mm, bound {:.5}, {status:?}, {} open\n", value * 1e3, bound * 1e3, open.len());
    open.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut kinds = [0_usize; 4];
    let mut by = [[0_usize; 2]; 6];
    let model = &setting.model;
    for (region, _) in open.iter().take(20) {
        let Some(level) = model.level(region) else { continue };
        let half = [model.table.length(level), model.table.length(level), PI / model.table.headings(level) as f64];
        for (point, class) in (0..model.points.len()).step_by(5).flat_map(|p| PostureClass::ALL.map(|c| (p, c))) {
            let Some(placed) = model.placed(point, region) else { continue };
            let Some((at, _)) = model.table.nearest(level, placed.r, placed.z) else { continue };
            for cell in 0..model.table.headings(level) {
                match model.table.nodes_at(&model.arm, level, at).known(cell, class).0 {
                    Node::Empty => kinds[0] += 1,
                    Node::Unknown => kinds[3] += 1,
                    Node::Known(known) if known.sure => kinds[1] += 1,
                    Node::Known(_) => {
                        kinds[2] += 1;
                        let [r, z] = model.table.place(level, at);
                        let place = [r, z, model.table.heading(level, cell)];
                        let Some(margins) = undecided(&setting, place, half, class) else { continue };
                        let is_forbidden = margins.iter().any(|[low, middle]| *low && *middle);
                        for (count, [low, middle]) in by.iter_mut().zip(margins) {
                            count[0] += usize::from(low);
                            count[1] += usize::from(low && middle && is_forbidden);
                        }
                    }
                }
            }
        }
    }
    text += &format!("  nodes: {} empty, {} sure, {} undecided, {} unknown\n", kinds[0], kinds[1], kinds[2], kinds[3]);
    for (name, [low, middle]) in NAMES.iter().zip(by) {
        text += &format!("  {name}: {low} undecided, {middle} of them with a forbidden middle\n");
    }
    text
}

/// `cargo test --release -p stead-certify --lib -- --ignored --nocapture what_keeps`
#[test]
#[ignore = "a measurement: minutes"]
#[expect(clippy::print_stdout, reason = "a measurement")]
fn what_keeps_cells_open_is_counted() {
    let recommended = |mut problem: Problem| {
        (problem.criterion.weights, problem.criterion.force_uncertainty) = (Weights::TOTAL, 0.1);
        (problem.redundancy.max_beta_rate, problem.redundancy.max_spindle_turn) = (None, Some(8.7));
        problem
    };
    let offset = |mut problem: Problem| {
        let mut joints: [Joint; 6] = problem.robot.joints().clone();
        joints[1].d = 0.15;
        problem.robot = Robot::new("offset", joints).unwrap();
        problem
    };
    let loose = |mut problem: Problem| {
        problem.constraints.min_inverse_condition = 0.1;
        problem
    };
    let across = |mut problem: Problem| {
        let rotation = nalgebra::Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0);
        problem.spindle = Spindle::new(rotation, Vector3::new(0.0, 0.2, 0.35)).unwrap();
        problem
    };
    let all = [
        ("published, recommended criterion", recommended(five_segments())),
        ("the same, conditioning 0.1", recommended(loose(five_segments()))),
        ("the same, lateral offset", recommended(loose(offset(five_segments())))),
        ("the same, spindle across the flange", recommended(loose(across(five_segments())))),
        ("lateral offset, across, wall", loose(across(offset(five_segments())))),
    ];
    for (name, problem) in all {
        println!("{}", counted(name, problem));
    }
}
