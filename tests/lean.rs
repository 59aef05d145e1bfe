//! A tool that leans, from outside: what `place` and `score` plan is better than with the axis of the task, the judge
//! agrees, and what reads the results again finds the same plan.

use crate::common::{Bench, Ended};
use serde_json::Value;
use stead::{Monitor, Run};
use stead_model::testing::{is_all, some};

const RUN: &str = "configs/leaning-tool.toml";

fn bench() -> Bench {
    let bench = Bench::new();
    bench.copy_all(&[RUN, "configs/robots/kuka-kr500.toml", "tasks/raster.csv"]);
    let search = "\n[search]\npopulation = 12\ngenerations = 2\nbasins = 1\n";
    bench.replace(RUN, "max_beta_rate_deg_per_mm = 0.9", &format!("max_beta_rate_deg_per_mm = 0.9\n{search}"));
    bench.replace(RUN, "beta_step_deg = 6.0", "beta_step_deg = 12.0");
    bench.replace(RUN, "[lean]  ", "[lean]\nlead_step_deg = 5.0\ntilt_step_deg = 7.5  ");
    bench
}

fn ok(bench: &Bench, arguments: &[&str]) -> Ended {
    let ended = bench.stead(arguments);
    assert_eq!(ended.code, Some(0), "{arguments:?}: {}", ended.stderr);
    ended
}

fn summary(bench: &Bench, folder: &str) -> Value {
    serde_json::from_str(&bench.read(&format!("{folder}/summary.json"))).unwrap()
}

fn objective(document: &Value) -> f64 {
    document["cases"][0]["objective_mm"].as_f64().unwrap()
}

#[test]
fn a_sensitivity_to_force_errors_is_refused_where_the_tool_leans() {
    let ended = bench().stead(&["place", RUN, "--sensitivity"]);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
    assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
    ended.assert_says(&["error: --sensitivity: how far force errors move", "[lean]", "; allowed: "]);
}

#[test]
fn a_tool_that_may_lean_deflects_less_and_the_judge_agrees() {
    let bench = bench();
    ok(&bench, &["place", RUN, "--no-page", "--out", "leaned"]);
    let found = summary(&bench, "leaned");
    let leaned = objective(&found);
    let verdict = stead_judge::judge(&bench.path(RUN), &bench.path("leaned")).unwrap();
    assert!(verdict.disagreements.is_empty(), "{:?}", verdict.disagreements);
    let header = bench.read("leaned/best.csv").lines().next().unwrap().to_owned();
    assert!(header.contains(",lead_deg,tilt_deg"), "{header}");
    let notes = found["notes"].to_string();
    for note in
        ["the tool leans from the axis of the path by", "keep the directions of feed and wall", "may have been missed"]
    {
        assert!(notes.contains(note), "{note} in {notes}");
    }
    every_lean_has_a_score_or_a_reason(&bench);
    no_neighbour_is_better(&bench, &found);
    // The same search with the axis of the task.
    let upright = "configs/upright.toml";
    bench.write(
        upright,
        &bench.read(RUN).replace("lead_deg = [-10.0, 15.0]", "").replace("tilt_deg = [-15.0, 15.0]", ""),
    );
    ok(&bench, &["place", upright, "--no-page", "--out", "upright"]);
    let upright = objective(&summary(&bench, "upright"));
    assert!(leaned < 0.99 * upright, "{leaned} {upright}");
    // The placement read again has its leans; a program of the plan states the orientation at every point.
    let again = ok(&bench, &["score", RUN, "--placement-of", "leaned", "--json"]).json();
    let again = again["best"]["objective_mm"].as_f64().unwrap();
    assert!((again / leaned - 1.0).abs() < 1e-3, "{again} {leaned}");
    the_map_over_lead_and_tilt_is_that_of_the_search(&bench);
    ok(&bench, &["export", RUN, "leaned/best.csv", "--approach-mm", "0", "--format", "csv", "--out", "program/part"]);
    the_program_touches_where_the_task_does(&bench);
    let refused = bench.stead(&["place", RUN, "--certify", "5", "--no-page", "--out", "certified"]);
    assert!(refused.stderr.contains("the tool may lean"), "{}", refused.stderr);
}

/// The map over lead and tilt: beyond the largest lean none is allowed, and of the others the best is no worse than
/// that of the plan at this point, but for the grid of beta.
fn every_lean_has_a_score_or_a_reason(bench: &Bench) {
    let rows = |file: &str| -> Vec<Vec<String>> {
        let text = bench.read(file);
        text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
    };
    let (map, plan) = (rows("leaned/lean-map.csv"), rows("leaned/best.csv"));
    let of = |table: &[Vec<String>], row: usize, name: &str| -> Option<f64> {
        let column = table[0].iter().position(|head| head == name).unwrap();
        table[row][column].parse().ok()
    };
    let scores: Vec<f64> = (1..plan.len()).map(|row| of(&plan, row, "score_mm").unwrap()).collect();
    let worst = (0..scores.len()).max_by(|a, b| scores[*a].total_cmp(&scores[*b])).unwrap();
    let mut best = f64::INFINITY;
    assert_eq!(map.len(), 1 + 7 * 5);
    for row in 1..map.len() {
        assert_eq!(of(&map, row, "point"), Some(worst as f64));
        let [lead, tilt] = ["lead_deg", "tilt_deg"].map(|name| of(&map, row, name).unwrap().to_radians());
        let is_beyond = libm::acos(libm::cos(lead) * libm::cos(tilt)).to_degrees() > 15.0 + 1e-3;
        assert_eq!(map[row].last().unwrap() == "lean", is_beyond, "{:?}", map[row]);
        best = best.min(of(&map, row, "score_mm").unwrap_or(f64::INFINITY));
    }
    assert!(best < 1.1 * scores[worst], "{best} {}", scores[worst]);
}

/// The same placement, read with every digit, gives the same bytes, as the map takes each lean by itself; the page has
/// them. Without maps it is removed, and a stop leaves it out where the path is too short to leave out the other map.
fn the_map_over_lead_and_tilt_is_that_of_the_search(bench: &Bench) {
    let score = ["score", RUN, "--placement-of", "leaned", "--out", "scored"];
    ok(bench, &score);
    assert_eq!(bench.read("scored/lean-map.csv"), bench.read("leaned/lean-map.csv"));
    assert!(bench.read("scored/manifest.json").contains("lean-map.csv"));
    assert!(bench.read("scored/report.html").contains("\"lean_map\":"));
    ok(bench, &[&score[..], &["--set", "output.maps=false"]].concat());
    assert!(bench.path("scored/score.json").exists() && !bench.path("scored/lean-map.csv").exists());
    let (run, placement) = Run::read(bench.path(RUN)).unwrap().set_up_as_in(bench.path("leaned"), 1).unwrap();
    let mut score = run.score(&placement, &Monitor::silent()).unwrap();
    let stopped = Monitor::silent();
    stopped.stop_handle().stop();
    score.map(&stopped);
    let files: Vec<_> = score.to_files().unwrap().into_iter().map(|(name, _)| name).collect();
    assert!(files.iter().any(|name| name == "deflection-map.csv") && !files.iter().any(|name| name == "lean-map.csv"));
    let last = score.warnings().last().unwrap().to_string();
    assert!(score.score().interrupted && last.contains("the map over lead and tilt is left out"), "{last}");
}

/// The placement is the best one near it, with leads and tilts planned anew at each of the others.
fn no_neighbour_is_better(bench: &Bench, found: &Value) {
    let best = &found["cases"][0]["placement"];
    let at = |key: &str| best[key].as_f64().unwrap();
    let mut tried = 0;
    let all = [("y_mm", -3.0), ("x_mm", -3.0), ("yaw_deg", 1.7), ("y_mm", 3.0), ("z_mm", -3.0), ("yaw_deg", -1.7)];
    for (moved, shift) in some(2, all) {
        let value = |key: &str| (at(key) + if key == moved { shift } else { 0.0 }).to_string();
        let [x, y, z, yaw] = ["x_mm", "y_mm", "z_mm", "yaw_deg"].map(value);
        let place = ["score", RUN, "--x-mm", &x, "--y-mm", &y, "--z-mm", &z, "--yaw-deg", &yaw, "--json"];
        let ended = bench.stead(&place);
        if ended.code == Some(0) {
            tried += 1;
            let there = ended.json()["best"]["objective_mm"].as_f64().unwrap();
            assert!(there > objective(found) * (1.0 - 1e-3), "{moved} {shift}: {there} {}", objective(found));
        }
    }
    assert!(tried > if is_all() { 2 } else { 1 }, "{tried}");
}

/// The contact is rebuilt from the program alone: one whose tips are all moved is refused for it.
fn the_program_touches_where_the_task_does(bench: &Bench) {
    let check = ["export", RUN, "leaned/best.csv", "--approach-mm", "0", "--check", "program/part.csv", "--json"];
    let document = ok(bench, &check).json();
    let off = document["contact_mm"]["value"].as_f64().unwrap();
    assert!(off <= document["allowed_contact_mm"].as_f64().unwrap(), "{document}");
    // With a tip moved by 0.05 mm it is beside.
    let program = bench.read("program/part.csv");
    let mut rows: Vec<Vec<String>> = program.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect();
    let z = rows[0].iter().position(|name| name == "z_mm").unwrap();
    assert_eq!(rows[2][2], "linear");
    rows[2][z] = (rows[2][z].parse::<f64>().unwrap() + 0.05).to_string();
    bench.write("program/part.csv", &rows.iter().map(|row| row.join(",") + "\n").collect::<String>());
    let ended = bench.stead(&check);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    let off = ended.json()["contact_mm"]["value"].as_f64().unwrap();
    assert!((off - 0.05).abs() < 0.005, "{off}");
}
