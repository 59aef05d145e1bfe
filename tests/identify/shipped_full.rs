//! Springs about three directions of every joint, on the shipped arms that state them: which are told apart and how
//! well, what a fit of the axes alone makes of them, and what a file may ask for.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};
use stead_calibration::identification::gauge::Gauge;
use stead_calibration::identification::springs::FULL;
use stead_calibration::identification::synthetic::{MeasuringCell, sheet};
use stead_calibration::identification::{FitModel, Identified, LoadCase, Problem, Sheet, identify};
use stead_format::read_robot;
use stead_model::robot::{About, MeasuredFrom, Pose, Robot, SpringModel};
use stead_numerics::monitor::Monitor;
use stead_run_files::{read_identification, read_plan};

const NOISE: f64 = 3e-5;

fn shipped(name: &str) -> Robot {
    read_robot(&Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/robots").join(name)).unwrap()
}

/// What a tracker reads of an arm at random poses under 2.7 kN in random directions at a point of the flange frame.
fn readings(robot: &Robot, load_point: Vector3<f64>, count: usize) -> Sheet {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let mut load_case = |_| {
        let theta = std::array::from_fn(|joint| {
            let joint = &robot.joints()[joint];
            random.random_range(joint.min.max(-PI)..joint.max.min(PI))
        });
        let (z, (sine, cosine)) = (random.random_range(-1.0..1.0_f64), libm::sincos(random.random_range(0.0..TAU)));
        let radius = libm::sqrt(1.0 - z * z);
        LoadCase { theta, force: Vector3::new(radius * cosine, radius * sine, z) * 2700.0, moment: Vector3::zeros() }
    };
    let load_cases: Vec<LoadCase> = (0..count).map(&mut load_case).collect();
    let points = [[0.12, 0.0, 0.25], [-0.06, 0.11, 0.2], [-0.06, -0.11, 0.3]].map(Vector3::from).to_vec();
    let cell = MeasuringCell { tracker_from_base: Pose::identity(), load_point, points, is_full_pose: false };
    sheet(robot, &cell, &load_cases, || 0.0, || 0.0)
}

fn problem(robot: &Robot, model: FitModel, load_point: Vector3<f64>, count: usize) -> Problem {
    Problem {
        robot: robot.clone(),
        model,
        measured_from: Some(MeasuredFrom::Base),
        sheet: readings(robot, load_point, count),
        load_point,
        noise: Some(NOISE),
        orientation_noise: None,
        varying: None,
        angle_tolerance: 0.0,
        start: Some(nalgebra::Matrix3::identity()),
        reduce: false,
        hold: [false; 6],
        hold_normal: [[false; 2]; 6],
    }
}

fn fitted(problem: &Problem) -> Identified {
    identify(problem, &Monitor::silent()).unwrap()
}

#[test]
fn fifteen_springs_of_the_one_shipped_arm_are_told_and_seventeen_of_the_other() {
    let replaced = |name: &str| -> Vec<String> {
        let gauge = Gauge::of::<FULL>(FitModel::Full, &shipped(name), &[false; FULL]);
        gauge.replaced.iter().map(|replaced| replaced.spring.to_string()).collect()
    };
    assert_eq!(replaced("kuka-kr210-2-full.toml"), ["joint 4 about y", "joint 5 about x", "joint 5 about y"]);
    assert_eq!(replaced("staubli-tx200-huynh.toml"), ["joint 5 about y"]);
}

/// The relative standard deviations of springs about the axes, and of those normal to them, ascending. %
fn percents(name: &str, count: usize) -> [Vec<f64>; 2] {
    let found = fitted(&problem(&shipped(name), FitModel::Full, Vector3::new(0.25, 0.0, 0.15), count));
    [true, false].map(|is_axial| {
        let own = found.compliances.iter().filter(|e| (found.spring(e.parameter).about == About::Z) == is_axial);
        let mut percents: Vec<f64> = own.map(|e| 100.0 * e.deviation / e.value.abs()).collect();
        percents.sort_by(f64::total_cmp);
        percents
    })
}

/// The figures of the guide: `cargo test --test all springs_normal_to_the_axes_ask -- --nocapture`.
#[test]
fn springs_normal_to_the_axes_ask_for_more_configurations() {
    #[expect(clippy::print_stdout, reason = "the figures of the guide")]
    fn say(text: &str) {
        println!("{text}");
    }
    for name in ["kuka-kr210-2-full.toml", "staubli-tx200-huynh.toml"] {
        let mut before: Option<[Vec<f64>; 2]> = None;
        for count in [20, 60] {
            let found = percents(name, count);
            for (what, of) in ["about the axes", "normal to them"].into_iter().zip(&found) {
                let (least, median, most) = (of[0], of[of.len() / 2], of[of.len() - 1]);
                say(&format!("{name}, {count}: {what} {least:.1} to {most:.1} %, median {median:.1} %"));
            }
            if let Some(before) = &before {
                // Three times as many readings: by the root of three, and what one bad pose of few does.
                for (more, less) in found.iter().flatten().zip(before.iter().flatten()) {
                    assert!(more < less, "{found:?} {before:?}");
                }
            }
            assert!(found[1].iter().sum::<f64>() / found[1].len() as f64 > found[0][2], "{found:?}");
            before = Some(found);
        }
    }
}

/// Stiffnesses in MN m/rad that an independent program fitted to 60 forces on these arms, at poses of its own.
#[test]
fn a_fit_of_the_axes_alone_finds_what_another_program_found() {
    let tool = Vector3::new(0.0, 0.0, 0.454);
    let off_axis = Vector3::new(0.25, 0.0, 0.454);
    for (name, load_point, expected) in [
        ("kuka-kr210-2-full.toml", tool, &[1.7, 5.2, 2.8, 0.23, 0.34][..]),
        ("staubli-tx200-huynh.toml", off_axis, &[1.5, 4.6, 1.7, 0.69, 0.19, 0.42][..]),
    ] {
        let full = shipped(name);
        let mut axes = problem(&full, FitModel::Axes, load_point, 60);
        axes.robot = full.clone().with_normal_springs(None).unwrap().with_spring_model(None);
        axes.noise = None;
        axes.hold = std::array::from_fn(|joint| joint >= expected.len());
        let found = fitted(&axes);
        for (joint, expected) in expected.iter().enumerate() {
            let stiffness = 1e-6 / found.robot.joints()[joint].compliance_at(0.0);
            let range = (expected / FARTHEST)..=(expected * FARTHEST);
            assert!(range.contains(&stiffness), "{name}, joint {}: {stiffness} {expected}", joint + 1);
        }
        // What is left over, as a share of the deflections.
        let of = |row: fn(&stead_calibration::identification::RowResult) -> Vector3<f64>| {
            libm::sqrt(found.rows.iter().map(|r| row(r).norm_squared()).sum::<f64>())
        };
        let share = of(|row| row.measured - row.predicted) / of(|row| row.measured);
        assert!((0.03..0.5).contains(&share), "{name}: {share}");
    }
}

/// Other poses and another lever give other figures by so much.
const FARTHEST: f64 = 1.6;

/// An identification file of the full KUKA KR 210-2 with its sheet in a folder, some keys added to it.
fn file(robot: &str, fit: &str, plan: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let load_point = Vector3::new(0.25, 0.0, 0.15);
    let readings = readings(&shipped("kuka-kr210-2-full.toml"), load_point, 25);
    std::fs::write(folder.path().join("sheet.csv"), readings.csv(6)).unwrap();
    let text = format!(
        "robot = \"{robot}\"\nsheet = \"sheet.csv\"\nload_point_mm = [250, 0, 150]\nnoise_mm = 0.03\n[fit]\n{fit}\n[plan]\n\
         load_n = 2700\nreference_points_mm = [[120, 0, 250], [-60, 110, 200], [-60, -110, 300]]\n{plan}\n"
    );
    let file = folder.path().join("full.toml");
    std::fs::write(&file, text).unwrap();
    (folder, file)
}

const KUKA: &str = "name:kuka-kr210-2-full";
const FROM_BASE: &str = "model = \"full\"\nstiffness_measured_from = \"base\"";

#[test]
fn a_file_asks_for_all_springs_and_names_those_that_are_held() {
    let hold = format!("{FROM_BASE}\nhold = [6, \"joints[5].y\", \"joints[4].y\"]");
    let (_folder, named) = file(KUKA, &hold, "");
    let run = read_identification(&named).unwrap();
    let Problem { model, measured_from, hold, hold_normal, .. } = &run.problem;
    assert_eq!((*model, *measured_from), (FitModel::Full, Some(MeasuredFrom::Base)));
    assert_eq!(*hold, [false, false, false, false, false, true]);
    let expected = [[false; 2], [false; 2], [false; 2], [false, true], [false, true], [true; 2]];
    assert_eq!(*hold_normal, expected);
    let note = run.notes.iter().find(|note| note.contains("cannot be told apart")).unwrap();
    assert!(note.contains("is taken from the robot file") && !note.contains("under the base"), "{note}");
    let found = fitted(&run.problem);
    assert_eq!((found.robot.spring_model(), found.held.len()), (Some(SpringModel::Full), 5));

    let (_folder, floor) = file("name:kuka-kr210-2", &FROM_BASE.replace("base", "floor"), "");
    let run = read_identification(&floor).unwrap();
    let note = run.notes.iter().find(|note| note.contains("cannot be told apart")).unwrap();
    for part in
        ["does not say where the springs normal to the axes sit", "what yields under the base is in the springs of"]
    {
        assert!(note.contains(part), "{part} in {note}");
    }
    let (_folder, alone) = file("name:kuka-kr210-2", "model = \"axes\"\nhold = [\"joints[6].z\", 4]", "");
    let run = read_identification(&alone).unwrap();
    assert_eq!(run.problem.hold, [false, false, false, true, false, true]);
    // What the file of the arm says of other compliances does not hold for these.
    assert_eq!(run.problem.robot.spring_model(), Some(SpringModel::Axes));
}

#[test]
fn a_plan_for_all_springs_has_sixty_configurations_and_says_why() {
    let (_folder, plan) = file(KUKA, FROM_BASE, "");
    let run = read_plan(&plan, None).unwrap();
    assert_eq!((run.request.configurations, run.request.model), (60, FitModel::Full));
    assert!(
        run.notes.iter().any(|note| note.contains("60 are planned and not 20, since springs normal")),
        "{:?}",
        run.notes
    );
    let (_folder, few) = file(KUKA, FROM_BASE, "configurations = 25");
    let notes = read_plan(&few, None).unwrap().notes;
    assert!(notes.iter().any(|note| note.contains("plan.configurations = 25 is few")), "{notes:?}");
    let (_folder, axes) = file("name:kuka-kr210-2", "", "");
    let run = read_plan(&axes, None).unwrap();
    assert_eq!(run.request.configurations, 20);
    assert!(run.notes.iter().all(|note| !note.contains("configurations")), "{:?}", run.notes);
}

#[test]
fn files_that_ask_for_what_cannot_be_are_refused_at_the_key() {
    let every = (1..=6).map(|joint| joint.to_string()).collect::<Vec<_>>().join(", ");
    for (robot, fit, parts) in [
        (KUKA, "", &["robot: states springs normal to the axes", "fit.model = \"full\", or"][..]),
        (KUKA, "model = \"full\"", &["fit.stiffness_measured_from: is missing", "\"base\" or \"floor\""]),
        (KUKA, "model = \"whole\"", &["fit.model: ", "whole", "axes"]),
        (KUKA, &FROM_BASE.replace("base", "wall"), &["fit.stiffness_measured_from: ", "wall", "floor"]),
        (KUKA, &format!("{FROM_BASE}\nhold = [\"joints[7].x\"]"), &["fit.hold[1]: ", "joints[7].x", "\"joints[1].x\""]),
        (KUKA, &format!("{FROM_BASE}\nhold = [0]"), &["fit.hold[1]: ", "found 0", "from 1 to 6"]),
        (KUKA, &format!("{FROM_BASE}\nhold = [3, \"joints[3].y\"]"), &["fit.hold[2]: is there twice", "each once"]),
        (KUKA, &format!("{FROM_BASE}\nhold = [{every}]"), &["fit.hold: holds every joint", "not all"]),
        (
            "name:kuka-kr210-2",
            "hold = [\"joints[3].x\"]",
            &["fit.hold[1]: is a spring normal to its axis", "fit.model = \"full\""],
        ),
    ] {
        let (_folder, file) = file(robot, fit, "");
        let message = read_identification(&file).unwrap_err().to_string();
        for part in parts {
            assert!(message.contains(part), "{part} in {message}");
        }
        assert!(message.contains("; allowed: "), "{message}");
    }
}
