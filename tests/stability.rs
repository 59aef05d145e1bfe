//! `stead stability` from outside, and critical depths along a path in `place` and `score`.

use crate::common::{Bench, Ended};
use serde_json::Value;

const STEEL: &str = "configs/umons-steel.toml";
const ALUMINIUM: &str = "configs/umons-aluminium.toml";
const PATH: &str = "configs/tx200-stability.toml";
const ROBOT: &str = "configs/robots/staubli-tx200.toml";

/// A bench with the shipped simulation files, with few lobes, and a path of six points.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.copy_all(&[STEEL, ALUMINIUM, PATH, ROBOT]);
    for name in [STEEL, ALUMINIUM] {
        bench.replace(name, "# [stability] ", "[stability]\nlobes_points = 3\n# ");
    }
    let task = bench.read("tasks/five-segments.csv");
    let kept = |line: &&str| line.starts_with('1') || line.starts_with("segment");
    let few: Vec<&str> = task.lines().filter(kept).take(4).collect();
    bench.write("tasks/few.csv", &(few.join("\n") + "\n"));
    bench.replace(PATH, "five-segments.csv", "few.csv");
    bench.replace(PATH, "seed = 1\n", "seed = 1\npopulation = 8\ngenerations = 1\nbasins = 1\n");
    bench
}

fn stability(bench: &Bench, config: &str, more: &[&str]) -> Ended {
    bench.stead(&[&["stability", config, "--out", "out"], more].concat())
}

fn json(ended: &Ended) -> Value {
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.json()
}

/// An independent prototype's frequencies, with whatever damping lets all of them swing.
#[test]
fn natural_frequencies_are_those_of_the_published_arm() {
    let bench = bench();
    for scale in ["1e-6", "1"] {
        let found = json(&stability(&bench, ALUMINIUM, &["--json", "--damping-scale", scale]));
        let modes = found["modes"].as_array().unwrap();
        let frequencies = [15.76, 25.05, 27.69, 33.55, 90.92, 143.08];
        assert_eq!(modes.len(), frequencies.len());
        for (mode, expected) in modes.iter().zip(frequencies) {
            let frequency = mode["frequency_hz"].as_f64().unwrap();
            assert!((frequency - expected).abs() < 0.0051, "{frequency} {expected}");
        }
    }
}

#[test]
fn aluminium_is_calm_and_steel_chatters_with_a_flip_until_it_is_damped() {
    let bench = bench();
    let calm = json(&stability(&bench, ALUMINIUM, &["--json"]));
    assert_eq!((&calm["stable"], &calm["kind"]), (&true.into(), &"none".into()));
    assert!(calm["growth_rate_per_s"].as_f64().unwrap() < 0.0);
    assert!(calm["critical_depth_mm"]["semi_discretisation"].as_f64().unwrap() > 1.6);
    let steel = json(&stability(&bench, STEEL, &["--json"]));
    assert_eq!((&steel["stable"], &steel["kind"]), (&false.into(), &"flip".into()));
    assert!(steel["growth_rate_per_s"].as_f64().unwrap() > 0.0);
    let critical = steel["critical_depth_mm"]["semi_discretisation"].as_f64().unwrap();
    assert!(critical < 1.6 && critical < steel["critical_depth_mm"]["zero_order"].as_f64().unwrap());
    let growth = |found: &Value| found["growth_rate_per_s"].as_f64().unwrap();
    let damped = json(&stability(&bench, STEEL, &["--json", "--damping-scale", "10"]));
    assert!(growth(&damped) < growth(&steel) / 5.0);
    let damped = json(&stability(&bench, STEEL, &["--json", "--damping-scale", "20"]));
    assert!(growth(&damped) < 0.0 && damped["stable"] == true);
    let faster = json(&stability(&bench, STEEL, &["--json", "--spindle-rpm", "9000"]));
    assert_eq!((&faster["stable"], &faster["spindle_rpm"]), (&true.into(), &9000.0.into()));
}

#[test]
fn files_are_written_alike_with_any_number_of_threads() {
    let bench = bench();
    let text = stability(&bench, STEEL, &["--threads", "1"]);
    assert_eq!(text.code, Some(0), "{}", text.stderr);
    for part in ["chatters (flip", "15.76", "results in out"] {
        assert!(text.stdout.contains(part), "{part} in {}", text.stdout);
    }
    let first = bench.tree("out");
    let names: Vec<&str> = first.keys().map(String::as_str).collect();
    let expected = [
        "frequency-response.csv",
        "frequency-response.svg",
        "lobes.csv",
        "lobes.svg",
        "manifest.json",
        "modes.csv",
        "report.html",
        "summary.json",
    ];
    assert_eq!(names, expected);
    stability(&bench, STEEL, &["--threads", "2"]);
    assert!(first == bench.tree("out"));
    let summary: Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
    assert_eq!(summary["lobes"].as_array().unwrap().len(), 3);
    assert!(summary["lobes"][0]["critical_depth_mm"].as_f64().unwrap() > 0.0);
}

#[test]
fn every_variant_has_its_modes() {
    let bench = bench();
    for (variant, states) in [("springs", 12), ("gravity", 12), ("orthogonal", 36), ("backlash", 36)] {
        let found = json(&stability(&bench, ALUMINIUM, &["--json", "--variant", variant]));
        assert_eq!(found["variant"], variant);
        let modes = found["modes"].as_array().unwrap();
        let count = |mode: &Value| if mode["damping_ratio"].as_f64().unwrap() < 1.0 { 2 } else { 1 };
        assert_eq!(modes.iter().map(count).sum::<i32>(), states, "{variant}");
        assert_eq!(modes[0]["joints"].as_array().unwrap().len(), if states == 12 { 6 } else { 18 });
    }
}

#[test]
fn bad_input_is_named_with_file_line_and_field() {
    for (file, from, to, parts) in [
        (ROBOT, "mass_kg = 99.0", "mass_kg = 0.0", ["staubli-tx200.toml:", "joints[3].mass_kg", "found 0.0"]),
        (ROBOT, "mass_kg = 99.0", "mass_kg = -99.0", ["staubli-tx200.toml:", "joints[3].mass_kg", "found -99.0"]),
        (ROBOT, "xx = 12.25", "xx = 99.0", ["joints[1].inertia_kg_m2", "triangle inequality", "xx = 99.0"]),
        (ROBOT, "xz = 0.74", "xz = 20.0", ["joints[2].inertia_kg_m2", "not positive definite", "xz = 20.0"]),
        (STEEL, "staubli-tx200", "kuka-kr270-2", ["kuka-kr270-2.toml:", "mass_kg", "centre_of_mass_mm, inertia_kg_m2"]),
        (STEEL, "axial_depth_mm = 1.6", "axial_depth_mm = 23.0", ["umons-steel.toml:", "flutes", "found 23.0"]),
        (STEEL, "radial_depth_mm = 4.0", "radial_depth_mm = 11.0", ["umons-steel.toml:", "wider", "found 11.0"]),
    ] {
        let bench = bench();
        let line = bench.replace(file, from, to);
        let ended = stability(&bench, STEEL, &[]);
        assert_eq!(ended.code, Some(2), "{}", ended.stderr);
        ended.assert_says(&parts);
        ended.assert_says(&["; allowed: "]);
        // What the robot file lacks is located there, anything else where it stands.
        if !to.starts_with("kuka") {
            ended.assert_says(&[&format!(":{line}: ")]);
        }
        assert!(!bench.path("out").exists());
    }
    let bench = bench();
    for arguments in [["--variant", "soft"], ["--damping-scale", "-1"], ["--spindle-rpm", "0"]] {
        assert_eq!(stability(&bench, STEEL, &arguments).code, Some(2));
    }
}

const SPOT: [&str; 8] = ["--x-mm", "1175.5", "--y-mm", "32", "--z-mm", "600", "--q4", "0.9832"];

#[test]
fn place_and_score_tell_how_deep_may_be_cut_along_the_path() {
    let bench = bench();
    let ended = bench.stead(&[&["score", PATH, "--json"][..], &SPOT].concat());
    let points = json(&ended)["stability"]["best"]["points"].as_array().unwrap().clone();
    assert_eq!(points.len(), 3);
    for point in &points {
        let critical = point["critical_depth_mm"]["semi_discretisation"].as_f64().unwrap();
        assert_eq!(point["stable"].as_bool().unwrap(), critical > 5.0, "{point}");
    }
    let text = bench.stead(&[&["score", PATH][..], &SPOT].concat());
    assert!(text.stdout.contains("best plan: critical depth down to "), "{}", text.stdout);

    let ended = bench.stead(&["place", PATH, "--out", "out"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.contains("worst placement: critical depth"), "{}", ended.stdout);
    for name in ["stability-best.csv", "stability-worst.csv"] {
        let csv = bench.read(&format!("out/{name}"));
        assert!(csv.starts_with("point,segment,critical_depth_mm,zero_order_mm,stable,kind,growth_rate_per_s\n0,1,"));
        assert_eq!(csv.lines().count(), 4);
    }
    assert!(bench.read("out/stability.svg").contains("critical depth of cut (mm)"));
    let summary: Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
    let best = &summary["stability"]["best"];
    assert!(best["smallest_critical_depth_mm"].as_f64().unwrap() > 0.0 && best["points"].is_null());
}

#[test]
fn a_run_that_asks_for_stability_needs_a_robot_with_masses() {
    let bench = bench();
    bench.replace(PATH, "staubli-tx200", "kuka-kr270-2");
    let ended = bench.stead(&[&["score", PATH][..], &SPOT].concat());
    assert_eq!(ended.code, Some(2));
    ended.assert_says(&["kuka-kr270-2.toml:", "joints[1].mass_kg: is missing", "damping_nms_per_rad in every"]);
    let body =
        "centre_of_mass_mm = [-4.0, 0.0, 158.0]\ninertia_kg_m2 = { xx = 0.095, yy = 0.106, zz = 0.098, xz = 0.035 }\n";
    let bare = bench.read(PATH).replace(body, "").replace("mass_kg = 44.4\n", "");
    bench.write("configs/bare.toml", &bare);
    let ended = bench.stead(&[&["score", "configs/bare.toml"][..], &SPOT].concat());
    assert_eq!(ended.code, Some(2));
    ended.assert_says(&[
        "bare.toml:",
        "spindle.mass_kg: is missing: how the arm moves",
        "centre_of_mass_mm and inertia",
    ]);
    let line = bench.replace(PATH, "teeth = 4", "tooth = 4");
    let ended = bench.stead(&[&["score", PATH][..], &SPOT].concat());
    let place = format!("tx200-stability.toml:{line}: tool.tooth: ");
    assert!(ended.code == Some(2) && ended.stderr.contains(&place), "{}", ended.stderr);
}
