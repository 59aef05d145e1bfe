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
    assert!(row("staubli-tx200").contains("yes        yes     -        staubli"), "{list}");
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

/// Values are put into a shipped arm by its name as into a robot file.
#[test]
fn a_shipped_arm_in_a_run_takes_other_values() {
    let bench = Bench::new();
    bench.replace(RUN, "robots/kuka-kr270-2.toml", "name:kuka-kr270-2");
    let at = ["score", RUN, "--x-mm", "2.2", "--y-mm", "-1643.5", "--z-mm", "-556.4", "--q4", "0.9258", "--json"];
    let mean = |set: &str| {
        let ended = bench.stead(&[&at[..], &["--set", set]].concat());
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        ended.assert_says(&[&format!("note: {} in place of what the files say", set.replacen('=', " is ", 1))]);
        ended.json()["best"]["mean_mm"].as_f64().unwrap()
    };
    let [as_printed, softer] = ["2.0", "0.8"].map(|k1| mean(&format!("robot.joints[1].stiffness_mnm_per_rad={k1}")));
    assert!(softer > 1.05 * as_printed, "{softer} {as_printed}");
    let wrong = [&at[..], &["--set", "robot.joints[7].stiffness_mnm_per_rad=1"]].concat();
    refused(&bench, &wrong, &["--set robot.joints[7].stiffness_mnm_per_rad=1", "has no entry [7]"]);
}

/// Every shape with its extents where it stands, the pairs that hit there, and the feeds of the task.
#[test]
fn shapes_hits_and_the_feeds_of_the_task_are_checked() {
    let bench = Bench::new();
    let plain = bench.stead(&["check", RUN]);
    assert!(plain.stdout.contains("feed      66.7 mm/s") && !plain.stdout.contains("shapes"), "{}", plain.stdout);
    let task = bench.read(TASK);
    let feeds = task.lines().enumerate().map(|(k, line)| match k {
        0 => format!("{line},feed_mm_per_s"),
        _ => format!("{line},{}", if k < 50 { "20" } else { "35.5" }),
    });
    bench.write(TASK, &(feeds.collect::<Vec<_>>().join("\n") + "\n"));
    let shapes = "[[shape]]\nname = 'wall'\nattached = 'base'\nbox_mm = [100, 200, 300]\nxyz_mm = [0, 3000, 150]\n\
                  rpy_deg = [0, 0, 90]\n[[shape]]\nname = 'table'\nattached = 'workpiece'\n\
                  box_mm = [800, 1000, 100]\nxyz_mm = [0, 0, 0]\n[[shape]]\nname = 'spindle'\nattached = 'flange'\n\
                  capsule_mm = { radius = 60, length = 600 }\nxyz_mm = [0, 0, 400]\n";
    bench.write(RUN, &format!("{}\n{shapes}", bench.read(RUN)));
    let checked = bench.stead(&["check", RUN, "--out", "check"]);
    assert_eq!(checked.code, Some(0), "{}", checked.stderr);
    for part in [
        "feed      20.0 to 35.5 mm/s, as the task states; the 66.7 mm/s of redundancy.feed_mm_per_s apply to none",
        "wall (moves with base): x -100.0 to 100.0, y 2950.0 to 3050.0, z 0.0 to 300.0",
        "table (moves with workpiece): x -",
        "spindle (moves with flange): x -",
    ] {
        assert!(checked.stdout.contains(part), "{part} in {}", checked.stdout);
    }
    checked.assert_says(&["shapes hit: ", "spindle and table (touching)"]);
    let document = bench.stead(&["check", RUN, "--json"]).json();
    assert_eq!(document["feeds_mm_per_s"], serde_json::json!([20.0, 35.5]));
    assert_eq!(document["shapes"][0]["extents_mm"][1], serde_json::json!([2950.0, 3050.0]));
    let hit = &document["hits"][0];
    assert!(hit["pair"].as_array().unwrap().contains(&"table".into()), "{hit}");
    assert!(hit["distance_mm"].as_f64().unwrap() <= 0.0, "{hit}");
    let picture = bench.read("check/check.svg");
    assert!(picture.contains("red where they hit another"), "{picture}");
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
