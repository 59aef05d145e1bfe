//! `stead identify plan` from outside: the plan, the sheet, the way from it to an identified robot, and what it
//! refuses.

use crate::common::{Bench, Ended};
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;
use std::path::Path;
use stead_calibration::identification::LoadCase;
use stead_calibration::identification::synthetic::{MeasuringCell, sheet};
use stead_model::robot::{Compensator, Compliance, Pose};

const CONFIG: &str = "configs/identify-plan-example.toml";
const SHEET: &str = "results/identify-plan-example/sheet.csv";

/// A bench with the shipped example, on as few candidates as make it quick.
fn bench() -> Bench {
    let bench = shipped();
    bench.replace(CONFIG, "candidates = 2000", "candidates = 150");
    bench.replace(CONFIG, "starts = 8", "starts = 2");
    bench
}

fn shipped() -> Bench {
    let bench = Bench::new();
    bench.copy_all(&[CONFIG, "configs/robots/kuka-kr270-r2700.toml"]);
    bench
}

fn plan(bench: &Bench, more: &[&str]) -> Ended {
    bench.stead(&[&["identify", "plan", CONFIG], more].concat())
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn the_reference_results_are_what_the_command_gives() {
    let bench = shipped();
    let ended = plan(&bench, &["--threads", "2"]);
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""));
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/identify-plan-example");
    let names = ["expected.csv", "manifest.json", "plan.json", "plan.svg", "sheet.csv"];
    let written: Vec<String> = bench.tree("results/identify-plan-example").into_keys().collect();
    assert_eq!(written, names);
    for name in names {
        let reference = std::fs::read_to_string(folder.join(name)).unwrap();
        assert!(bench.read(&format!("results/identify-plan-example/{name}")) == reference, "{name}");
    }
}

#[test]
fn a_plan_is_better_than_random_sets_and_its_sheet_is_a_form() {
    let bench = bench();
    let ended = plan(&bench, &["--json", "--out", "out"]);
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""));
    let document = ended.json();
    let deflection = &document["deflection"];
    let error = number(&deflection["error_mm"]);
    assert!(error < number(&deflection["best_random_error_mm"]) && error < 0.01 * number(&deflection["rms_mm"]));
    assert_eq!(deflection["random_sets"], 1000);
    assert_eq!(document["compliances"].as_array().unwrap().len(), 10);
    assert!(document["compliances"].as_array().unwrap().iter().all(|c| c["std_percent"].as_f64() < Some(10.0)));
    assert_eq!(document["configurations"].as_array().unwrap().len(), 20);
    assert_eq!((&document["unseen"], &document["warnings"]), (&serde_json::json!([]), &serde_json::json!([])));
    assert_eq!(serde_json::from_str::<Value>(&bench.read("out/plan.json")).unwrap(), document);

    let form = bench.read("out/sheet.csv");
    assert_eq!(form.lines().count(), 61);
    let levels = ["10", "40", "70", "100", "130"];
    for (index, line) in form.lines().skip(1).enumerate() {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!((fields.len(), fields[0]), (20, format!("c{}", index / 3 + 1).as_str()));
        assert_eq!((fields[13], &fields[14..]), (format!("p{}", index % 3 + 1).as_str(), &[""; 6][..]));
        assert!(levels.contains(&fields[2]) && fields[10..13] == ["0", "0", "0"], "{line}");
        let force: f64 = (7..10).map(|k| fields[k].parse::<f64>().unwrap()).map(|f| f * f).sum();
        assert!((libm::sqrt(force) - 2700.0).abs() < 0.2, "{line}");
    }
    // Another seed, another plan; the same seed, the same bytes, whatever the threads.
    let first = bench.tree("out");
    assert_eq!(plan(&bench, &["--out", "out", "--threads", "3"]).code, Some(0));
    assert_eq!(bench.tree("out"), first);
    assert_eq!(plan(&bench, &["--out", "out", "--seed", "2"]).code, Some(0));
    assert_ne!(bench.read("out/sheet.csv"), form);
    let text = plan(&bench, &["--out", "out"]).stdout;
    for part in ["20 configurations chosen of 150", "% by law", "best of 1000 random sets: ", "in out"] {
        assert!(text.contains(part), "{part} is not in {text}");
    }
}

/// Fills a sheet in with what an arm of other compliances shows a tracker that stands elsewhere.
fn fill(bench: &Bench) {
    let alpha = (-20.0_f64).to_radians();
    let compensator = Compensator { spring_stiffness: 4e6, a: 0.75, l: 0.25, alpha, free_length: 0.6 };
    let mut laws = [0.54, 0.3, 0.42, 2.79, 3.48, 2.074].map(|urad| Compliance::from(urad / 1e6));
    laws[1] = Compliance::Compensated { alone: 0.3e-6, compensator };
    let robot = stead_format::read_robot(&bench.path("configs/robots/kuka-kr270-2.toml")).unwrap();
    let cell = MeasuringCell {
        tracker_from_base: Pose {
            rotation: Matrix3::new(-0.6, -0.8, 0.0, 0.8, -0.6, 0.0, 0.0, 0.0, 1.0),
            translation: Vector3::new(3.2, -1.5, 0.4),
        },
        load_point: Vector3::new(0.25, 0.0, 0.15),
        // The points are never quite where the plan has them.
        points: vec![
            Vector3::new(0.121, 0.002, 0.25),
            Vector3::new(-0.06, 0.112, 0.2),
            Vector3::new(-0.062, -0.11, 0.3),
        ],
        is_full_pose: false,
    };
    let text = bench.read(SHEET);
    let load_cases: Vec<LoadCase> = text
        .lines()
        .skip(1)
        .step_by(3)
        .map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            let value = |k: usize| fields[k].parse::<f64>().unwrap();
            let theta = std::array::from_fn(|joint| value(1 + joint).to_radians());
            LoadCase { theta, force: Vector3::new(value(7), value(8), value(9)), moment: Vector3::zeros() }
        })
        .collect();
    // Noise of standard deviation 0.03 mm: sums of twelve uniform numbers, less six.
    let mut state = 1_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let noise = || ((0..12).map(|_| uniform()).sum::<f64>() - 6.0) * 3e-5;
    let filled = sheet(&robot.with_compliances(laws).unwrap(), &cell, &load_cases, noise, || 0.0).csv(4);
    let given = |text: &str| {
        let given = |line: &str| line.split(',').take(14).map(str::to_owned).collect::<Vec<_>>();
        text.lines().map(given).collect::<Vec<_>>()
    };
    assert_eq!(given(&filled), given(&text));
    bench.write(SHEET, &filled);
}

#[test]
fn from_a_plan_over_a_filled_sheet_to_a_robot_whose_deflections_are_known_as_well_as_planned() {
    let bench = bench();
    bench.replace(CONFIG, "robots/kuka-kr270-r2700.toml", "robots/kuka-kr270-2.toml");
    // This arm has its base at the height of axis 2, and joint 1 is much softer on paper.
    bench.replace(CONFIG, "z_mm = [400.0, 3200.0]", "z_mm = [-400.0, 2500.0]");
    bench.replace(CONFIG, "max_deflection_mm = 10.0", "max_deflection_mm = 40.0");
    let document = plan(&bench, &["--json"]).json();
    let fit = || bench.stead(&["identify", "fit", CONFIG, "--out", "out", "--json"]);
    let empty = fit();
    assert_eq!(empty.code, Some(2));
    empty.assert_says(&["sheet.csv:2: unloaded_x_mm: no reading is filled in here", "found ''", "in mm"]);

    fill(&bench);
    let fitted = fit();
    assert_eq!((fitted.code, fitted.stderr.as_str()), (Some(0), ""));
    let found = fitted.json();
    let of = |document: &Value| -> Vec<(u64, f64)> {
        // At angles that the plan leaves out there is none.
        let entry = |c: &Value| Some((c["joint"].as_u64().unwrap(), c["std_urad_per_nm"].as_f64()?));
        document["compliances"].as_array().unwrap().iter().filter_map(entry).collect()
    };
    let (expected, reported) = (of(&document), of(&found));
    assert!(expected.len() >= 8 && expected.len() == reported.len());
    for ((joint, expected), (fitted, reported)) in expected.iter().zip(&reported) {
        assert_eq!(joint, fitted);
        assert!((reported / expected - 1.0).abs() < 0.02, "k_{joint}: {reported} where {expected} was expected");
    }
    // A new plan would write over the readings.
    let again = plan(&bench, &[]);
    assert_eq!(again.code, Some(2));
    again.assert_says(&["sheet.csv: is a sheet with readings in it", "--out"]);

    bench.write("arm.toml", &bench.read("out/robot-identified.toml"));
    bench.replace(crate::common::RUN, "robots/kuka-kr270-2.toml", "../arm.toml");
    let place = ["--x-mm", "2.2", "--y-mm", "-1643.5", "--z-mm", "-556.4", "--q4", "0.9258", "--json"];
    let score = bench.stead(&[&["score", crate::common::RUN], &place[..]].concat()).json();
    let (mean, deviation) = (number(&score["best"]["mean_mm"]), number(&score["best"]["mean_std_mm"]));
    assert!(deviation > 1e-4 * mean && deviation < 0.05 * mean, "{score}");
}

#[test]
fn what_the_loads_do_not_show_is_warned_of_and_the_rest_is_planned() {
    let warned = |from: &str, to: &str| {
        let bench = bench();
        bench.replace(CONFIG, from, to);
        let ended = plan(&bench, &["--json"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let text = plan(&bench, &[]).stdout;
        let document = ended.json();
        for warning in document["warnings"].as_array().unwrap() {
            assert!(text.contains(&format!("warning: {}", warning.as_str().unwrap())), "{text}");
        }
        document
    };
    let says = |document: &Value, part: &str| {
        assert!(
            document["warnings"].as_array().unwrap().iter().any(|w| w.as_str().unwrap().contains(part)),
            "{document:#}"
        );
    };
    let vertical = warned("load_directions = \"any\"", "load_directions = \"vertical\"");
    says(&vertical, "k_1 is unobservable: every load is vertical, along axis 1; the plan is for the others");
    assert_eq!(vertical["unseen"][0]["compliances"][0]["joint"], 1);
    assert!(vertical["compliances"].as_array().unwrap().iter().all(|c| c["joint"] != 1));
    let on_axis = warned("load_point_mm = [250.0, 0.0,", "load_point_mm = [0.0, 0.0,");
    says(&on_axis, "k_6 is unobservable: the load acts on axis 6");
    let near = warned("load_point_mm = [250.0, 0.0,", "load_point_mm = [2.0, 0.0,");
    says(&near, "k_6 is weakly observed: its expected standard deviation is ");
    assert_eq!(near["hardly_seen"][0]["joint"], 6);
    assert!(number(&near["hardly_seen"][0]["lever_mm"]) < 2.0);
    let list = "load_directions = [[0.0, 0.0, -2.0], [0.0, 0.0, 1.0]]";
    says(&warned("load_directions = \"any\"", list), "k_1 is unobservable: every load is along axis 1");
}

#[test]
fn tests_of_ones_own_and_arms_without_compensator_are_taken() {
    let bench = bench();
    let config = bench.read(CONFIG);
    let table = config.find("[compensator]").unwrap()..config.find("[plan]").unwrap();
    let mut config =
        config.replace(&config[table], "").replace("tests = 200 ", "# ").replace("levels_deg", "# levels_deg");
    config += "[[plan.test]]\njoints_deg = [0, 90, -90, 0, 45, 0]\nforce_n = [300, 0, -100]\n";
    bench.write(CONFIG, &config);
    let ended = plan(&bench, &["--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&["note: joint 2 has a range of compliances"]);
    let document = ended.json();
    assert_eq!(
        (&document["deflection"]["tests"], document["compliances"].as_array().unwrap().len()),
        (&Value::from(1), 6)
    );
    // One test under one load asks for less than many, so that it is known better.
    assert!(number(&document["deflection"]["error_mm"]) < 0.01);
}

#[test]
fn bad_plans_are_refused_at_their_line() {
    for (from, to, parts) in [
        ("configurations = 20", "configurations = 0", &["plan.configurations: ", "found 0", "from 1 to 1000"][..]),
        (
            "configurations = 20",
            "configurations = 2",
            &["plan.configurations: ", "2 distinct angles of joint 2", "found 2"],
        ),
        (
            "configurations = 20",
            "configurations = 151",
            &["plan.candidates: ", "less than there are to choose", "found 150"],
        ),
        ("load_n = 2700.0", "load_n = 0.0", &["plan.load_n: ", "found 0.0", "above 0"]),
        ("load_n = 2700.0", "load_m = 1.0", &["plan.load_m: ", "nearest known one: load_n"]),
        (
            "load_directions = \"any\"",
            "load_directions = \"up\"",
            &["plan.load_directions: ", "found \"up\"", "or \"vertical\""],
        ),
        (
            "load_directions = \"any\"",
            "load_directions = [[0, 0, 0]]",
            &["plan.load_directions[1]: ", "length is zero"],
        ),
        (
            "reference_points_mm = [[120.0, 0.0, 250.0],",
            "reference_points_mm = [[120.0, nan, 250.0],",
            &["reference_points_mm[1][2]: ", "nan"],
        ),
        (
            "levels_deg = [10.0,",
            "levels_deg = [1.0,",
            &["plan.levels_deg: ", "not within the limits", "from 5.0000 to 140.0000"],
        ),
        ("levels_deg = [10.0, 40.0,", "levels_deg = [40.0, 40.0,", &["plan.levels_deg: ", "ascending"]),
        ("70.0, 100.0, 130.0]", "]", &["plan.levels_deg: ", "has 2 angles", "three or more"]),
        ("noise_mm = 0.03", "# ", &["noise_mm: is missing", "above 0"]),
        (
            "# limits_deg = [[-90.0,",
            "limits_deg = [[-190.0,",
            &["plan.limits_deg[1]: ", "limits of the joint", "-185.0000"],
        ),
        ("max_deflection_mm = 10.0", "max_deflection_mm = -1", &["plan.max_deflection_mm: ", "found -1"]),
        ("z_mm = [400.0, 3200.0]", "z_mm = [400.0, 300.0]", &["plan.volume.z_mm: ", "lower end above"]),
        ("hardly_seen_percent = 20.0", "hardly_seen_percent = 0", &["plan.hardly_seen_percent: ", "found 0"]),
    ] {
        let bench = bench();
        let line = bench.replace(CONFIG, from, to);
        let ended = plan(&bench, &["--json"]);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{from}: {}", ended.stderr);
        assert!(ended.stderr.starts_with("error: ") && ended.stderr.contains("; allowed: "), "{}", ended.stderr);
        ended.assert_says(parts);
        let is_located = ended.stderr.contains(&format!("toml:{line}: ")) || to.contains("151") || to.starts_with('#');
        assert!(is_located, "line {line} is not in {}", ended.stderr);
        assert!(!bench.path("results/identify-plan-example").exists());
    }
}

#[test]
fn too_few_readings_and_too_small_a_volume_are_named() {
    let bench = bench();
    let config = bench.read(CONFIG);
    let table = config.find("[compensator]").unwrap()..config.find("[plan]").unwrap();
    bench.write(CONFIG, &config.replace(&config[table], ""));
    bench.replace(CONFIG, "configurations = 20", "configurations = 1");
    bench.replace(CONFIG, ", [-60.0, 110.0, 200.0], [-60.0, -110.0, 300.0]]", "]");
    let ended = plan(&bench, &[]);
    assert_eq!(ended.code, Some(2));
    ended.assert_says(&[
        "plan.configurations: 3 deflection components do not determine 6 compliances",
        "found 1",
        "allowed",
    ]);

    let bench = self::bench();
    bench.replace(CONFIG, "min_radius_mm = 700.0", "min_radius_mm = 7000.0");
    let ended = plan(&bench, &[]);
    assert_eq!(ended.code, Some(1));
    ended.assert_says(&[
        "plan: of 30000 random configurations only 0 are allowed, where 20 are wanted",
        "too near to the base",
    ]);
    assert!(!bench.path("results/identify-plan-example").exists());
}
