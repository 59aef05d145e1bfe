//! `stead simulate` from outside.

use crate::common::{Bench, Ended};
use serde_json::Value;

const PASS: &str = "configs/pass.toml";
const ROBOT: &str = "configs/robots/staubli-tx200.toml";

/// A bench with the shipped aluminium pass, shortened so that it takes little time: 20 mm of work, 90 steps a turn, 8
/// slices.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.copy("configs/umons-aluminium.toml", PASS);
    bench.copy(ROBOT, ROBOT);
    bench.replace(PASS, "length_mm = 107.9167", "length_mm = 32.0");
    bench.replace(PASS, "length_mm = 90.0", "length_mm = 20.0");
    bench.replace(PASS, "window_s = [0.4, 1.4]", "steps_per_turn = 90\nslices = 8\nwindow_s = [0.3, 0.4]");
    bench
}

fn simulate(bench: &Bench, arguments: &[&str]) -> Ended {
    bench.stead(&[&["simulate", PASS], arguments].concat())
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn a_pass_has_its_files_its_document_and_its_text() {
    let bench = bench();
    let ended = simulate(&bench, &["--json"]);
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""));
    let document = ended.json();
    for axis in ["force_x", "force_y"] {
        let [min, max, mean, rms] = ["min_n", "max_n", "mean_n", "rms_n"].map(|key| number(&document[axis][key]));
        assert!(min < mean && mean < max && rms >= mean.abs(), "{axis}");
    }
    // Towards the wall, as the published tables print it.
    assert!(number(&document["force_y"]["min_n"]) < -80.0 && number(&document["force_x"]["max_n"]) > 30.0);
    assert_eq!(number(&document["published"]["force_x"]["mean_n"]), 8.78);
    assert!(number(&document["profile"]["ra_um"]) < number(&document["profile"]["raw"]["rt_um"]));
    let modes = document["modes"].as_array().unwrap();
    let frequencies: Vec<f64> = modes.iter().map(|mode| number(&mode["frequency_hz"])).collect();
    assert!((frequencies[0] - 15.76).abs() < 0.0051 && frequencies.len() == 6, "{frequencies:?}");
    assert_eq!((document["stable"].as_bool(), document["end"].as_str()), (Some(true), Some("complete")));
    assert!(number(&document["real_time_factor"]) > 0.0);

    let expected = [
        "forces.svg",
        "manifest.json",
        "report.html",
        "series.csv",
        "summary.json",
        "turns.svg",
        "wall.csv",
        "wall.svg",
    ];
    let files = bench.tree("results/pass");
    assert!(files.keys().eq(&expected), "{:?}", files.keys());
    let series = bench.read("results/pass/series.csv");
    assert!(series.starts_with("time_s,force_x_n,force_y_n,force_axial_n,x_mm,y_mm,deflection_x_um,deflection_y_um\n"));
    assert_eq!(series.lines().count() as f64, number(&document["steps"]) + 2.0);
    let summary: Value = serde_json::from_str(&bench.read("results/pass/summary.json")).unwrap();
    assert_eq!(summary["force_x"], document["force_x"]);
    assert!(summary["real_time_factor"].is_null());

    // The same bytes again; and a text for people.
    let ended = simulate(&bench, &["--out", "again"]);
    assert_eq!(ended.code, Some(0));
    for part in ["along the feed", "published", "roughness of the wall", "The cut is calm", "results in again"] {
        assert!(ended.stdout.contains(part), "{part} in {}", ended.stdout);
    }
    assert!(bench.tree("again") == files);
}

#[test]
fn an_option_that_was_taken_away_is_refused_with_what_does_instead() {
    let ended = simulate(&bench(), &["--fast"]);
    assert_eq!((ended.code, ended.stderr.lines().count()), (Some(2), 1), "{}", ended.stderr);
    ended.assert_says(&["error: --fast: there is no such option any more; allowed: nothing in its place: "]);
}

/// Forces push the tip the way it goes: both have one sense of y, in which the wall pushes it back.
#[test]
fn forces_and_deflections_have_one_sense() {
    let bench = bench();
    assert_eq!(simulate(&bench, &["--out", "out"]).code, Some(0));
    let series = bench.read("out/series.csv");
    let column = |name: &str| series.lines().next().unwrap().split(',').position(|header| header == name).unwrap();
    let [force, place, deflection] = ["force_y_n", "y_mm", "deflection_y_um"].map(column);
    let (mut work, mut forces) = (0.0, 0.0);
    for line in series.lines().skip(1) {
        let fields: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        work += fields[force] * fields[deflection];
        forces += fields[force];
        // The tool centre stays in front of the wall by about its radius.
        assert!((fields[place] + 5.0 - fields[deflection] / 1e3).abs() < 1e-3, "{line}");
    }
    assert!(forces < 0.0 && work > 0.0, "{forces} {work}");
}

/// Steel without runout, at depths of 0.55, 0.62, 0.75 and 1.0 mm: a flip of two teeth repeats every turn, and is told
/// all the same.
#[test]
fn simulate_and_stability_agree_on_calm_and_flip() {
    let steel = "configs/umons-steel.toml";
    for (depth, judgement, is_calm) in
        [("0.55", "calm", true), ("0.62", "calm", true), ("0.75", "flip", false), ("1.0", "flip", false)]
    {
        let bench = Bench::new();
        bench.copy_all(&[steel, ROBOT]);
        bench.replace(steel, "axial_depth_mm = 1.6", &format!("axial_depth_mm = {depth}"));
        bench.replace(steel, "runout_um = [6.929, 0.0]", "runout_um = [0.0, 0.0]");
        bench.replace(steel, "# steps_per_turn = 360", "steps_per_turn = 90\nslices = 8");
        bench.replace(steel, "# [stability] ", "[stability]\nlobes_points = 2\n# ");
        let pass = bench.stead(&["simulate", steel, "--json"]).json();
        let stability = bench.stead(&["stability", steel, "--json"]).json();
        assert_eq!(pass["judgement"], judgement, "{depth}: {}", pass["small_motions"]);
        assert_eq!((&pass["stable"], &stability["stable"]), (&is_calm.into(), &is_calm.into()), "{depth}");
        let kind = if is_calm { "none" } else { judgement };
        assert_eq!((&pass["small_motions"]["kind"], &stability["kind"]), (&kind.into(), &kind.into()), "{depth}");
        assert!(number(&pass["unrest"]) < 0.01, "{depth}: from turn to turn nothing is to be seen");
        assert_eq!(number(&pass["unrest_of_teeth_alike"]) > 0.2, !is_calm, "{depth}");
        assert_eq!((&pass["notes"], &stability["notes"]), (&serde_json::json!([]), &serde_json::json!([])));
        let text = bench.stead(&["simulate", steel]).stdout;
        let sentence =
            if is_calm { "The cut is calm: forces differ by " } else { "The cut chatters (flip): forces differ by " };
        assert!(text.contains(sentence) && text.contains("% from tooth to tooth"), "{text}");
    }
}

/// With runout a flip repeats from turn to turn; both commands say that the stability is that without it.
#[test]
fn a_flip_with_runout_is_told_by_its_growth() {
    let steel = "configs/umons-steel.toml";
    let bench = Bench::new();
    bench.copy_all(&[steel, ROBOT]);
    bench.replace(steel, "axial_depth_mm = 1.6", "axial_depth_mm = 0.75");
    bench.replace(steel, "# steps_per_turn = 360", "steps_per_turn = 90\nslices = 8");
    bench.replace(steel, "# [stability] ", "[stability]\nlobes_points = 2\n# ");
    let ended = bench.stead(&["simulate", steel]);
    for part in ["The cut chatters (flip): with runout a flip repeats from turn to turn", "Small motions grow (flip)"] {
        assert!(ended.stdout.contains(part), "{part} in {}", ended.stdout);
    }
    for command in [&["simulate", steel, "--json"][..], &["stability", steel, "--json"]] {
        let ended = bench.stead(command);
        let note = "the stability of small motions is that of the cutter without its runout";
        ended.assert_says(&["note: ", note]);
        assert!(ended.json()["notes"][0].as_str().unwrap().starts_with(note));
    }
}

/// Whatever happens, a run that could start ends with a verdict, its files and exit code 0.
#[test]
fn an_unstable_run_ends_cleanly_with_the_verdict() {
    let bench = bench();
    bench.replace(PASS, "kt_mpa = 661.553", "kt_mpa = 66155.3");
    bench.replace(PASS, "kr_mpa = 253.458", "kr_mpa = 25345.8");
    bench.replace(PASS, "axial_depth_mm = 1.6", "axial_depth_mm = 20.0");
    let ended = simulate(&bench, &["--json", "--damping-scale", "0"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let document = ended.json();
    assert_eq!((document["stable"].as_bool(), document["end"].as_str()), (Some(false), Some("limit")));
    assert!(document["end_reason"].as_str().unwrap().contains("more than"), "{}", document["end_reason"]);
    assert!(document["force_x"].is_null());
    assert_eq!(bench.tree("results/pass").len(), 8);
    assert!(simulate(&bench, &["--damping-scale", "0"]).stdout.contains("The cut is unstable: at "));
}

#[test]
fn bad_input_names_line_field_value_and_what_is_allowed() {
    for (from, to, parts) in [
        ("radial_depth_mm = 4.0", "radial_depth_mm = 10.5", &["cut.radial_depth_mm", "10.5", "cutter_diameter_mm"][..]),
        ("axial_depth_mm = 1.6", "axial_depth_mm = 22.5", &["cut.axial_depth_mm", "22.5", "flute_length_mm = 22"]),
        (
            "spindle_rpm = 18700.0",
            "spindle_rpm = 300.0",
            &["simulation.steps_per_turn", "90", "too coarse", "at least"],
        ),
        (
            "gap_mm = 0.5",
            "gap_mm = 0.5\nslot_width_mm = 9.5",
            &["work.slot_width_mm", "9.5", "narrower than the cutter, 10 mm"],
        ),
        ("window_s = [0.3, 0.4]", "window_s = [0.4, 0.3]", &["simulation.window_s", "[0.4, 0.3]", "first below"]),
        (
            "window_s = [0.3, 0.4]",
            "window_s = [0.3, 9.0]",
            &["simulation.window_s[2]", "found 9.0", "duration of the pass"],
        ),
        ("# cutoff_mm = 2.5 ", "cutoff_mm = 0.0 #", &["simulation.cutoff_mm", "found 0.0", "0.08 to 25"]),
        (
            "# wall_height_mm = 0.8 ",
            "wall_height_mm = 1.7 #",
            &["simulation.wall_height_mm", "1.7", "axial_depth_mm = 1.6"],
        ),
        (
            "springs = { force_x_n = [-7.63, ",
            "springs = { force_x_n = [",
            &["published.springs.force_x_n", "four finite numbers"],
        ),
    ] {
        let bench = bench();
        bench.replace(PASS, from, to);
        let ended = simulate(&bench, &[]);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{to}");
        ended.assert_says(&[parts, &["configs/pass.toml:", "allowed: "]].concat());
        assert!(!bench.path("results").exists(), "{to}");
    }
}
