//! What the readings do not tell: springs and compliances that are left out, named, or held.

use super::{CONFIG, ROBOT, SHEET, TRUTH, bench, fit, refused, warns};
use crate::common::Bench;
use nalgebra::Vector3;
use stead_calibration::identification::synthetic::{MeasuringCell, sheet};
use stead_calibration::identification::{Configuration, LoadCase};
use stead_model::robot::{Compensator, Compliance, Pose};

/// The example's sheet as it would be under vertical loads, without noise.
fn hang_loads(bench: &Bench) {
    write_sheet(bench, -20.0, |_| Vector3::new(0.0, 0.0, -2700.0));
}

/// The example's sheet without noise, of an arm whose spring stands at this angle, under loads for each configuration.
fn write_sheet(bench: &Bench, alpha_deg: f64, force: impl Fn(&Configuration) -> Vector3<f64>) {
    let run = stead_run_files::read_identification(&bench.path(CONFIG)).unwrap();
    let alpha = alpha_deg.to_radians();
    let compensator = Compensator { spring_stiffness: 4e6, a: 0.75, l: 0.25, alpha, free_length: 0.6 };
    let mut laws = TRUTH.map(|urad| Compliance::from(urad / 1e6));
    laws[1] = Compliance::Compensated { alone: 0.3e-6, compensator };
    let robot = run.problem.robot.with_compliances(laws).unwrap();
    let cell = MeasuringCell {
        tracker_from_base: Pose::identity(),
        load_point: run.problem.load_point,
        points: [[0.12, 0.0, 0.25], [-0.06, 0.11, 0.2], [-0.06, -0.11, 0.3]].map(Vector3::from).to_vec(),
        is_full_pose: false,
    };
    let load_case = |c: &Configuration| LoadCase { theta: c.theta, force: force(c), moment: Vector3::zeros() };
    let load_cases: Vec<_> = run.problem.sheet.configurations.iter().map(load_case).collect();
    bench.write(SHEET, &sheet(&robot, &cell, &load_cases, || 0.0, || 0.0).csv(9));
}

/// A spring that stands elsewhere than the file says, so that one there would have to push: everything else is
/// identified, and the robot file has no spring.
#[test]
fn a_spring_that_the_readings_contradict_does_not_lose_the_rest() {
    let bench = bench();
    write_sheet(&bench, 100.0, |configuration| configuration.force);
    let ended = fit(&bench, &["--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let document = ended.json();
    assert!(document["compensator"].is_null());
    let mut warnings = document["warnings"].as_array().unwrap().iter().map(|warning| warning.as_str().unwrap());
    let warning = warnings.find(|warning| warning.starts_with("the spring beside joint 2 is left out")).unwrap();
    for part in ["one compliance for all its angles", "everything else is kept: joint 2: ", "is not above zero"] {
        assert!(warning.contains(part), "{part} in {warning}");
    }
    assert!(fit(&bench, &[]).stdout.contains(&format!("warning: {warning}\n")));
    let compliances = document["compliances"].as_array().unwrap();
    assert_eq!(compliances.len(), 10);
    for entry in compliances {
        let joint = entry["joint"].as_u64().unwrap() as usize;
        let ratio = entry["urad_per_nm"].as_f64().unwrap() / TRUTH[joint - 1];
        assert!(joint == 2 || (ratio - 1.0).abs() < 1e-6, "{entry}");
    }
    let robot = bench.read("out/robot-identified.toml");
    assert!(!robot.contains("compensator"), "{robot}");
    bench.write("arm.toml", &robot);
    let robot = stead_format::read_robot(&bench.path("arm.toml")).unwrap();
    assert!(matches!(robot.joints()[1].compliance, Compliance::Constant(value) if (0.2e-6..0.4e-6).contains(&value)));
}

#[test]
fn what_the_loads_do_not_show_is_named_and_kept_on_request() {
    let bench = bench();
    hang_loads(&bench);
    refused(&bench, &["no reading depends on k_1", "fit.reduce = true"]);
    bench.replace(CONFIG, "reduce = false", "reduce = true");
    let document = fit(&bench, &["--json"]).json();
    assert_eq!(document["held"], serde_json::json!([1]));
    for entry in document["compliances"].as_array().unwrap() {
        let joint = entry["joint"].as_u64().unwrap() as usize;
        let ratio = entry["urad_per_nm"].as_f64().unwrap() / TRUTH[joint - 1];
        assert!(joint == 2 || (ratio - 1.0).abs() < 1e-6, "{entry}");
    }
    assert!(bench.read("out/robot-identified.toml").contains("stiffness_mnm_per_rad = 0.237        # as printed"));
}

#[test]
fn held_joints_keep_the_compliance_of_the_robot_file() {
    let bench = bench();
    bench.replace(CONFIG, "# hold = [4, 6]", "hold = [4, 6]");
    let document = fit(&bench, &["--json"]).json();
    assert_eq!(document["held"], serde_json::json!([4, 6]));
    let joints = |key: &str| document[key].as_array().unwrap().iter().map(|c| c["joint"].as_u64()).collect::<Vec<_>>();
    assert!(joints("compliances").iter().all(|joint| *joint != Some(4) && *joint != Some(6)));
    let (old, new) = (bench.read(ROBOT), bench.read("out/robot-identified.toml"));
    let given =
        |text: &str| text.lines().filter(|l| l.starts_with("stiffness_mnm_per_rad")).map(str::to_owned).collect();
    let (old, new): (Vec<String>, Vec<String>) = (given(&old), given(&new));
    assert_eq!(new, [old[3].clone(), old[5].clone()]);
    let robot: toml::Table = bench.read("out/robot-identified.toml").parse().unwrap();
    let names: Vec<&str> =
        robot["covariance"]["parameters"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    assert_eq!(names.len(), 6);
    assert!(names.iter().all(|name| !name.starts_with("joints[4]") && !name.starts_with("joints[6]")), "{names:?}");
    warns(&bench, &["the compliance of joint 6 is held at the value of the robot file"]);
}
