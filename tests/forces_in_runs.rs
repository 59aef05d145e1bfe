//! Runs whose forces come from `[stock]`, with every other thing that a run may have: they are the runs whose task has
//! the same forces as columns.

use crate::common::{Bench, Ended};
use serde_json::Value;
use std::fmt::Write;

/// A shoulder around a corner, with a plunge that is not scored, then a line back beside it; no feeds.
fn ell() -> String {
    let mut text =
        "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,normal_x,normal_y,normal_z,scored\n"
            .to_owned();
    let mut row = |segment: usize, at: [i32; 3], feed: [i32; 2], scored: u8| {
        let ([x, y, z], [a, b]) = (at, feed);
        let _ = writeln!(text, "{segment},{x},{y},{z},{a},{b},0,0,0,1,{},{a},0,{scored}", -b);
    };
    row(1, [-60, 0, 5], [1, 0], 0);
    row(1, [-60, 0, -6], [1, 0], 0);
    (1..13).for_each(|k| row(1, [10 * k - 60, 0, -6], [1, 0], 1));
    (0..9).for_each(|k| row(2, [60, 10 * k, -6], [0, 1], 1));
    (0..13).for_each(|k| row(3, [60 - 10 * k, 84, -4], [-1, 0], 1));
    text
}

const STOCK: &str = "[stock]\nbox_mm = [160, 120, 20]\nxyz_mm = [0, 45, -10]\n[cut]\nspindle_rpm = 9000\n";
const TOOL: &str = "[tool]\ncutter_diameter_mm = 16\ncorner_radius_mm = 2\ntaper_deg = 3\nteeth = 3\nflute_length_mm = 30\nkt_mpa = 800\n\
                    kr = 0.4\nka_mpa = 100\nkte_n_per_mm = 20\nkre_n_per_mm = 20\n";

/// A run of an arm that states no stiffness of its own, with tables added.
fn run(task: &str, criterion: &str, tables: &str) -> String {
    let robot = concat!(env!("CARGO_MANIFEST_DIR"), "/configs/robots/motoman-ms210.toml");
    format!(
        "robot = '{robot}'\nstiffness_like = 'kuka-kr500'\ntask = '{task}'\n[spindle]\nxyz_mm = [0, 0, 350]\nrotation = [[0, -0.70710678, 0.70710678], [1, 0, 0], [0, 0.70710678, 0.70710678]]\n\
         [cell]\nx_mm = [1400, 1600]\ny_mm = [-100, 100]\nz_mm = [700, 900]\nq4 = [0, 0]\n{}\
         [constraints]\nmin_inverse_condition = 0.02\ncharacteristic_length_mm = 700\n[criterion]\ndirection = '{criterion}'\n\
         [redundancy]\nbeta_step_deg = 10\nfeed_mm_per_s = 45\nmax_spindle_turn_deg_per_mm = 0.9\n[search]\npopulation = 8\ngenerations = 1\nbasins = 1\n\
         [output]\nmaps = false\n{}",
        tables.split_once("|").map_or("", |(cell, _)| cell),
        tables.split_once("|").map_or(tables, |(_, others)| others)
    )
}

/// A bench with the path and the same path with the forces that its stock gives, at 0.1 mm a tooth.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("my/ell.csv", &ell());
    bench.write("my/forces.toml", &format!("path = 'ell.csv'\n{STOCK}feed_per_tooth_mm = 0.1\n{TOOL}"));
    let ended = bench.stead(&["forces", "my/forces.toml", "--out", "my/with.csv"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    bench
}

#[track_caller]
fn done(ended: Ended) -> Ended {
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended
}

/// All numbers of a document with their paths.
fn numbers(value: &Value, path: &str, all: &mut Vec<(String, f64)>) {
    match value {
        Value::Number(number) => all.push((path.to_owned(), number.as_f64().unwrap())),
        Value::Array(list) => list.iter().enumerate().for_each(|(k, one)| numbers(one, &format!("{path}[{k}]"), all)),
        Value::Object(table) => table.iter().for_each(|(key, one)| numbers(one, &format!("{path}.{key}"), all)),
        _ => {}
    }
}

#[test]
fn whatever_a_run_has_its_stock_gives_what_the_same_forces_as_columns_give() {
    let bench = bench();
    let rail = "[[external_axis]]\nname = 'rail'\nkind = 'rail'\ncarries = 'robot'\ndirection = [0, 1, 0]\nrange_mm = [-300, 300]\n\
                speed_mm_per_s = 500\nuse = 'fixed'\n";
    let table = "[[external_axis]]\nname = 'table'\nkind = 'turntable'\ncarries = 'workpiece'\naxis = [0, 1, 0]\nxyz_mm = [1500, 0, 700]\n\
                 range_deg = [-30, 30]\nspeed_deg_per_s = 60\nuse = 'indexed'\n";
    for (name, criterion, at, tables) in [
        ("on the floor", "wall", ["1500", "0", "800"], String::new()),
        ("normal to the surface", "surface", ["1500", "0", "800"], String::new()),
        (
            "under the ceiling",
            "total",
            ["1500", "0", "1600"],
            "[mount]\nxyz_mm = [0, 0, 3000]\nrpy_deg = [180, 0, 0]\n".to_owned(),
        ),
        ("on a wall", "axis", ["1200", "0", "0"], "[mount]\nxyz_mm = [0, 0, 1500]\nrpy_deg = [0, 90, 0]\n".to_owned()),
        ("on a rail", "wall", ["1500", "0", "800"], rail.to_owned()),
        ("on a tilting table", "total", ["1500", "0", "800"], table.to_owned()),
        (
            "on its side",
            "total",
            ["1500", "0", "800"],
            "orientations = [{ name = 'side', rpy_deg = [90, 0, 0] }]\n|".to_owned(),
        ),
        ("a heavy segment", "wall", ["1500", "0", "800"], "[[segment]]\nnumber = 2\nweight = 3\n".to_owned()),
    ] {
        let mut scores = Vec::new();
        for (task, own) in [("ell.csv", format!("{STOCK}{TOOL}")), ("with.csv", String::new())] {
            bench.write("my/run.toml", &format!("{}{own}", run(task, criterion, &tables)));
            let [x, y, z] = at;
            let options = ["--x-mm", x, "--y-mm", y, "--z-mm", z, "--q4", "0", "--json"];
            let ended = done(bench.stead(&[&["score", "my/run.toml"][..], &options].concat()));
            let document = ended.json();
            let mut all = Vec::new();
            for plan in ["best", "worst"] {
                numbers(&document[plan]["deflection_mm"], plan, &mut all);
            }
            scores.push(all);
        }
        assert!(scores[0].len() >= 12, "{name}: {:?}", scores[0]);
        for ((key, own), (_, columns)) in scores[0].iter().zip(&scores[1]) {
            assert!((own - columns).abs() <= 2e-4 * columns.abs() + 1e-6, "{name}: {key} {own} {columns}");
        }
    }
}

#[test]
fn commands_on_a_plan_follow_the_path_with_the_points_that_were_added() {
    let bench = bench();
    bench.write("my/run.toml", &format!("{}{STOCK}{TOOL}", run("ell.csv", "wall", "")));
    done(bench.stead(&["place", "my/run.toml", "--out", "my/results", "--no-page"]));
    let rows = bench.read("my/results/best.csv").lines().count() - 1;
    assert!(rows > ell().lines().count() - 1, "{rows} points: none was added");
    // The task states no feeds: those of the run count, and nothing says otherwise.
    let ended = done(bench.stead(&["check", "my/run.toml"]));
    assert!(!ended.stdout.contains("as the task states"), "{}", ended.stdout);
    let ended = done(bench.stead(&[
        "explain",
        "my/run.toml",
        "--placement-of",
        "my/results",
        "--point",
        "3",
        "--beta-deg",
        "10",
    ]));
    assert!(ended.stdout.contains("allowed"), "{}", ended.stdout);
    done(bench.stead(&["export", "my/run.toml", "my/results/best.csv", "--format", "csv", "--out", "my/program/ELL"]));
    bench.write(
        "my/compensate.toml",
        "run = 'run.toml'\nplan = 'results/best.csv'\n[compensation]\nmodel = 'linear'\nalpha = 1\ntolerance_mm = 1e-6\nmax_iterations = 50\n",
    );
    let ended = done(bench.stead(&["compensate", "my/compensate.toml", "--out", "my/corrected", "--json"]));
    assert!(ended.json().to_string().contains("reduction"), "{}", ended.stdout);
    // Forces of what is removed have moments, which bounds count.
    bench.write(
        "my/run.toml",
        &format!("{}{STOCK}{TOOL}", run("ell.csv", "wall", "[certificate]\ngap_percent = 5\ntime_limit_s = 5\n"))
            .replace("min_inverse_condition = 0.02", "min_inverse_condition = 0.05"),
    );
    let ended = bench.stead(&["place", "my/run.toml", "--out", "my/certified", "--no-page", "--no-worst"]);
    assert!(!ended.stderr.contains("no certificate"), "{}", ended.stderr);
}

#[test]
fn a_study_over_depth_and_feed_has_the_forces_of_each() {
    let bench = bench();
    bench.write("my/run.toml", &format!("{}{STOCK}{TOOL}", run("ell.csv", "wall", "")));
    bench.write(
        "my/study.toml",
        "base = 'run.toml'\n[[axis]]\nname = 'top'\nfield = 'stock.xyz_mm'\nvalues = [[0, 45, -12], [0, 45, -10]]\nlabels = ['4 mm', '6 mm']\n\
         [[axis]]\nname = 'feed'\nfield = 'redundancy.feed_mm_per_s'\nvalues = [20, 45]\n\
         [[axis]]\nname = 'x'\nfield = 'cell.x_mm'\nvalues = [[1400, 1400], [1600, 1600]]\n",
    );
    done(bench.stead(&["study", "run", "my/study.toml", "--out", "my/studied", "--threads", "2"]));
    let text = bench.read("my/studied/study.csv");
    let mut rows = csv::Reader::from_reader(text.as_bytes());
    let at = rows.headers().unwrap().iter().position(|name| name == "best_mean_wall_mm").unwrap();
    let means: Vec<f64> = rows.records().map(|row| row.unwrap()[at].parse().unwrap()).collect();
    assert_eq!(means.len(), 8);
    // Deeper and faster cuts deflect more, wherever the part stands.
    for x in 0..2 {
        let [shallow_slow, shallow_fast, deep_slow, deep_fast] = [0, 2, 4, 6].map(|case| means[case + x]);
        assert!(shallow_slow < shallow_fast && deep_slow < deep_fast, "{means:?}");
        assert!(shallow_slow < deep_slow && shallow_fast < deep_fast, "{means:?}");
    }
}
