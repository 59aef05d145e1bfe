//! Springs about three directions of every joint, from a sheet to the placement of a part with the robot file made.

use super::{ROBOT, fit, refused};
use crate::common::Bench;
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stead_calibration::identification::LoadCase;
use stead_calibration::identification::synthetic::{MeasuringCell, sheet};
use stead_model::robot::{About, NormalSprings, Pose, Robot, Spring, SpringModel};

const CONFIG: &str = "configs/identify-example.toml";
const SHEET: &str = "tasks/identify-example.csv";

/// The arm behind the sheet: the shipped KUKA KR270-2 with springs of its own about three directions. Compliances about
/// z, x, y; urad/(N m)
const TRUTH: [[f64; 3]; 6] =
    [[0.54, 0.12, 0.12], [0.3, 0.2, 0.1], [0.42, 0.6, 0.4], [2.79, 0.8, 1.0], [3.48, 1.2, 0.7], [2.07, 1.5, 1.9]];

/// Where those normal to the axes sit, joint 6 apart from the wrist centre.
const BEARING_MM: [f64; 6] = [0.0, 0.0, 0.0, 0.0, 0.0, 120.0];

fn truth() -> Robot {
    let robot = stead_format::read_robot(&std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(ROBOT)).unwrap();
    let normal = std::array::from_fn(|joint| {
        let [_, x, y] = TRUTH[joint];
        NormalSprings { compliance: [x * 1e-6, y * 1e-6], bearing: BEARING_MM[joint] / 1e3 }
    });
    let robot = robot.with_compliances(TRUTH.map(|[z, ..]| z * 1e-6)).unwrap();
    robot.with_normal_springs(Some(normal)).unwrap().with_spring_model(Some(SpringModel::Full))
}

/// A bench with a sheet of the arm, and the example's file without a compensator and with these keys of `[fit]`.
fn full_bench(fit: &str) -> Bench {
    let bench = Bench::new();
    bench.copy_all(&[ROBOT]);
    let robot = truth();
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let mut load_case = |_| {
        let theta = std::array::from_fn(|joint| {
            let joint = &robot.joints()[joint];
            random.random_range(joint.min.max(-3.1)..joint.max.min(3.1))
        });
        let force = Vector3::from_fn(|_, _| random.random_range(-2000.0..2000.0));
        LoadCase { theta, force, moment: Vector3::zeros() }
    };
    let load_cases: Vec<LoadCase> = (0..40).map(&mut load_case).collect();
    let cell = MeasuringCell {
        tracker_from_base: Pose::identity(),
        load_point: Vector3::new(0.25, 0.0, 0.15),
        points: [[0.12, 0.0, 0.25], [-0.06, 0.11, 0.2], [-0.06, -0.11, 0.3]].map(Vector3::from).to_vec(),
        is_full_pose: false,
    };
    // As good as normal for this purpose.
    let noise = || (0..6).map(|_| random.random_range(-0.5..0.5)).sum::<f64>() * 1.414 * 1e-5;
    bench.write(SHEET, &sheet(&robot, &cell, &load_cases, noise, || 0.0).csv(6));
    let text = format!(
        "robot = \"robots/kuka-kr270-2.toml\"\nsheet = \"../{SHEET}\"\nload_point_mm = [250, 0, 150]\nnoise_mm = 0.01\n[fit]\n\
         {fit}\n"
    );
    bench.write(CONFIG, &text);
    // The file says where they sit, and that they are as good as rigid.
    let robot = bench.read(ROBOT);
    let mut rows = robot.split("[[joints]]\n");
    let mut stated = rows.next().unwrap().to_owned();
    for (row, bearing) in rows.zip(BEARING_MM) {
        stated += "[[joints]]\n";
        if fit.contains("full") {
            stated +=
                &format!("orthogonal_compliance_urad_per_nm = 0.01 # as good as rigid\nbearing_mm = {bearing:?}\n");
        }
        stated += row;
    }
    bench.write(ROBOT, &stated);
    bench
}

const FULL: &str = "model = \"full\"\nstiffness_measured_from = \"base\"";

#[test]
fn a_robot_file_with_all_springs_is_made_and_parts_are_placed_with_it() {
    let bench = full_bench(FULL);
    let ended = fit(&bench, &["--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let document = ended.json();
    assert_eq!((document["model"].as_str(), document["compliances"].as_array().unwrap().len()), (Some("full"), 15));
    // What is told, with what it is told together with, covers the truth within five standard deviations.
    let of = |spring: &str| {
        let Spring { joint, about } = (0..18)
            .map(stead_calibration::identification::springs::spring)
            .find(|known| stead_calibration::identification::springs::key_name(*known) == spring)
            .unwrap();
        TRUTH[joint][[About::Z, About::X, About::Y].iter().position(|one| *one == about).unwrap()]
    };
    for entry in document["compliances"].as_array().unwrap() {
        let mut expected = of(&format!("joints[{}].{}", entry["joint"], entry["about"].as_str().unwrap()));
        for other in entry["with"].as_array().into_iter().flatten() {
            expected += other["share"].as_f64().unwrap() * of(other["spring"].as_str().unwrap());
        }
        let [value, std] = ["urad_per_nm", "std_urad_per_nm"].map(|key| entry[key].as_f64().unwrap());
        assert!((value - expected).abs() < 5.0 * std && std < 0.3 * expected.abs().max(0.3), "{entry} {expected}");
    }
    let made = bench.read("out/robot-identified.toml");
    for part in [
        "stiffness_model = \"full\"",
        "stiffness_measured_from = \"base\"",
        "#     joint 5 about z with joint 4 about y",
    ] {
        assert!(made.contains(part), "{part} in {made}");
    }
    let robot = stead_format::read_robot(&bench.path("out/robot-identified.toml")).unwrap();
    assert!(robot.normal_springs().is_some());
    assert_eq!(robot.uncertainty().unwrap().parameters().len(), 15);
    for (figures, joint) in document["springs"].as_array().unwrap().iter().zip(robot.joints()) {
        assert!((figures["about_z_urad_per_nm"].as_f64().unwrap() / joint.compliance_at(0.0) / 1e6 - 1.0).abs() < 1e-9);
    }
    // All springs of the file are of the sums, so that the tool of the truth yields as that of the file does.
    let text = fit(&bench, &[]).stdout;
    for part in ["joint 6 about z with joint 5 about y, less joint 5 about x", "in the robot file, urad/(N m)"] {
        assert!(text.contains(part), "{part} in {text}");
    }

    // A part is scored with it, and a spring normal to an axis is set like any other key.
    bench.copy_all(&["configs/caro-2013.toml", "tasks/five-segments.csv"]);
    let run = bench.read("configs/caro-2013.toml");
    let robot = run.lines().find(|line| line.starts_with("robot")).unwrap().to_owned();
    bench.replace("configs/caro-2013.toml", &robot, "robot = \"../out/robot-identified.toml\"");
    let score = |more: &[&str]| {
        let placed = [
            "score",
            "configs/caro-2013.toml",
            "--x-mm",
            "2.2",
            "--y-mm",
            "-1643.5",
            "--z-mm",
            "-556.4",
            "--q4",
            "0.9258",
            "--json",
        ];
        let ended = bench.stead(&[&placed[..], more].concat());
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        ended.json()
    };
    let whole = score(&[]);
    let softer = score(&["--set", "robot.joints[3].orthogonal_compliance_urad_per_nm[1]=3.0"]);
    assert_ne!(whole, softer);
}

#[test]
fn a_fit_of_all_springs_needs_to_know_what_the_tracker_stood_on() {
    refused(&full_bench("model = \"full\""), &["fit.stiffness_measured_from: is missing"]);
    refused(
        &full_bench("model = \"axes\"\nhold = [\"joints[3].y\"]"),
        &["fit.hold[1]: is a spring normal to its axis"],
    );
}

#[test]
fn a_fit_of_the_axes_alone_hints_at_the_full_one() {
    let bench = full_bench("hold = [6]");
    let ended = fit(&bench, &["--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let document = ended.json();
    let warnings: Vec<&str> = document["warnings"].as_array().unwrap().iter().filter_map(|w| w.as_str()).collect();
    assert!(warnings.iter().any(|text| text.contains("fit the full model (fit.model = \"full\")")), "{warnings:?}");
    assert!(bench.read("out/robot-identified.toml").contains("stiffness_model = \"axes\""));
    assert!(document.get("model").is_none() && document.get("springs").is_none());
}
