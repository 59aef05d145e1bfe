//! Arms from outside: the catalogue, poses, what was understood of a file, a run file for what is there.

use crate::common::{Bench, RUN};

const TASK: &str = "tasks/five-segments.csv";

/// A command that is refused with exit code 2 and these words on standard error.
fn refused(bench: &Bench, arguments: &[&str], words: &[&str]) {
    let ended = bench.stead(arguments);
    assert_eq!(ended.code, Some(2), "{arguments:?}: {}", ended.stderr);
    words.iter().for_each(|word| assert!(ended.stderr.contains(word), "{word} in {}", ended.stderr));
}

#[test]
fn the_catalogue_says_what_is_known_of_each_arm() {
    let bench = Bench::new();
    let list = bench.stead(&["robots"]).stdout;
    assert!(list.lines().count() > 40, "{list}");
    let row = |name: &str| list.lines().find(|line| line.starts_with(&format!("{name} "))).unwrap().to_owned();
    assert!(row("kuka-kr240-2").contains("geometry: series 2000 frame"), "{list}");
    assert!(row("staubli-tx200").contains("yes        yes     staubli"), "{list}");
    // The file of one, to begin with.
    bench.write("own.toml", &bench.stead(&["robots", "abb-irb6640-235"]).stdout);
    assert_eq!(bench.stead(&["check", "own.toml"]).code, Some(0));
    refused(&bench, &["robots", "abb-irb664"], &["is no shipped arm; allowed: abb-irb66"]);
    let document: serde_json::Value = serde_json::from_str(&bench.stead(&["robots", "--json"]).stdout).unwrap();
    let arms = document["robots"].as_array().unwrap();
    assert!(arms.iter().filter(|arm| arm["has_stiffness"] == true).count() >= 12);
    assert!(arms.iter().all(|arm| !arm["source"].as_str().unwrap().is_empty()));
}

#[test]
fn a_pose_is_that_of_the_teach_pendant() {
    let bench = Bench::new();
    let angles = "--controller-deg=0,-90,90,0,0,0";
    let pose = bench.stead(&["pose", "name:kuka-kr210-r2700", angles]);
    assert_eq!(pose.code, Some(0), "{}", pose.stderr);
    let flange = pose.stdout.lines().find(|line| line.starts_with("flange in root")).unwrap().to_owned();
    let numbers: Vec<&str> = flange.split_whitespace().skip(3).collect();
    // 350 + 1200 + 215 mm ahead, 675 + 1150 - 41 mm up.
    assert_eq!(numbers[..6], ["1765.000", "0.000", "1784.000", "0.0000", "90.0000", "0.0000"], "{flange}");
    let beyond = bench.stead(&["pose", "name:abb-irb6640-235", "--joints-deg", "0,95,200,0,0,0"]);
    assert!(beyond.stderr.contains("note: joint 3 at 200.000 deg is beyond its limits"), "{}", beyond.stderr);
    let tool = bench.stead(&["pose", "name:kuka-kr270-2", angles, "--tool-of", RUN, "--json"]);
    let document: serde_json::Value = serde_json::from_str(&tool.stdout).unwrap();
    assert_eq!(document["frames"].as_array().unwrap().len(), 4);
    assert_eq!(document["inputs"][1]["role"], "spindle");
}

#[test]
fn poses_of_wrong_input_are_refused() {
    let bench = Bench::new();
    let with = |robot: &'static str, option: &'static str| ["pose", robot, option];
    refused(
        &bench,
        &with("name:kuka-kr2100", "--joints-deg=0,0,0,0,0,0"),
        &["name:kuka-kr2100: is no shipped arm; allowed: "],
    );
    refused(&bench, &with("name:motoman-ms210", "--controller-deg=0,0,0,0,0,0"), &["no table [controller]"]);
    refused(&bench, &with("name:kuka-kr500", "--joints-deg=0,0,0"), &["six finite decimal numbers"]);
    refused(&bench, &with("name:kuka-kr500", "--joints-deg=0,0,0,0,0,nan"), &["six finite decimal numbers"]);
    refused(&bench, &with("missing.toml", "--joints-deg=0,0,0,0,0,0"), &["missing.toml: cannot be read"]);
    let arguments = ["pose", "name:kuka-kr500", "--joints-deg=0,0,0,0,0,0", "--tool-of", TASK];
    refused(&bench, &arguments, &["five-segments.csv:1: "]);
}

#[test]
fn a_run_for_what_is_there_is_checked_and_placed() {
    let bench = Bench::new();
    let init = ["init", "place", "--robot", "name:kuka-kr270-r2700", "--task", TASK, "--out", "my/run.toml"];
    let made = bench.stead(&init);
    assert_eq!((made.code, made.stdout.contains("stead check my/run.toml")), (Some(0), true), "{}", made.stderr);
    refused(&bench, &init, &["run.toml: is there already"]);
    let checked = bench.stead(&["check", "my/run.toml", "--out", "check"]);
    assert_eq!(checked.code, Some(0), "{}", checked.stderr);
    for part in
        ["KUKA KR 270 R2700; wrist centre up to 2700.7 mm", "105 points in 5 segments", "90.0 deg from the flange axis"]
    {
        assert!(checked.stdout.contains(part), "{part} in {}", checked.stdout);
    }
    assert!(std::fs::read_to_string(bench.path("check/check.svg")).unwrap().starts_with("<svg"));
    let small =
        ["place", "my/run.toml", "--set", "search.population=8", "--set", "search.generations=1", "--out", "placed"];
    let placed = bench.stead(&small);
    assert_eq!(placed.code, Some(0), "{}", placed.stderr);
    // The name of the arm stands among the inputs.
    let manifest = std::fs::read_to_string(bench.path("placed/manifest.json")).unwrap();
    assert!(manifest.contains("\"name:kuka-kr270-r2700\""), "{manifest}");
    refused(&bench, &["init", "place", "--robot", "name:kuka-kr500"], &["--out"]);
    refused(
        &bench,
        &["init", "assess", "--robot", "name:kuka-kr500", "--task", TASK, "--out", "a.toml"],
        &["go with `stead init place`"],
    );
}

#[test]
fn an_arm_is_checked_alone_and_what_is_not_verified_is_noted() {
    let bench = Bench::new();
    let checked = bench.stead(&["check", "name:kuka-kr240-2"]);
    assert!(checked.stderr.contains("note: KUKA KR 240-2: not verified: geometry: "), "{}", checked.stderr);
    let geometry = bench.stead(&["check", "name:abb-irb6640-235", "--json"]);
    let document: serde_json::Value = serde_json::from_str(&geometry.stdout).unwrap();
    assert_eq!((&document["has_stiffness"], &document["robot"]["controller"]), (&false.into(), &"abb".into()));
    bench.stead(&["init", "place", "--robot", "name:abb-irb6640-235", "--task", TASK, "--out", "run.toml"]);
    refused(
        &bench,
        &["place", "run.toml"],
        &["name:abb-irb6640-235:", "joints[1].stiffness_mnm_per_rad: is missing", "stead identify plan"],
    );
    refused(&bench, &["check", "gone.toml"], &["gone.toml: cannot be read"]);
}
