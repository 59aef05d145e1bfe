//! Runs with a table `[stock]`: forces of what their path removes.

use crate::common::{Bench, RUN};
use serde_json::Value;
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};
use stead::monitor::Stop;
use stead::{Error, Monitor, Progress};

/// A run of the published path, whose forces are those of what is cut of a slab, 5 mm of it above the path.
fn run_with_stock() -> Bench {
    let bench = Bench::new();
    bench.copy("tasks/five-segments-path.csv", "tasks/five-segments.csv");
    let text = bench.read(RUN);
    bench.write(
        RUN,
        &format!(
            "{text}\n[stock]\nbox_mm = [400, 440, 10]\nxyz_mm = [0, 200, 0]\n[tool]\ncutter_diameter_mm = 16\n\
             teeth = 4\nflute_length_mm = 4\nkt_mpa = 800\nkr = 0.4\nka_mpa = 100\nkte_n_per_mm = 20\n\
             kre_n_per_mm = 20\n[cut]\nspindle_rpm = 20000\n"
        ),
    );
    bench
}

#[test]
fn warnings_of_forces_inside_a_run_are_those_of_the_run() {
    let bench = run_with_stock();
    // Once, before the search.
    let ended = bench.stead(&["place", RUN, "--out", "out"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let of_path = ["warning: the cutter stands in the stock where a segment begins", "warning: material is cut above"];
    for warning in of_path {
        assert_eq!(ended.stderr.matches(warning).count(), 1, "{}", ended.stderr);
    }
    let found = |document: &Value, warning: &str| {
        let all = document["warnings"].as_array().unwrap();
        let text = all.iter().filter_map(Value::as_str).find(|text| text.contains("above the flutes (4 mm)"));
        let text = text.unwrap_or_else(|| panic!("{warning}: {all:?}"));
        // How many, and where the first is.
        assert!(text.contains(" points, first at point 1, (-192, 390.4, 0) mm: "), "{text}");
    };
    found(&serde_json::from_str(&bench.read("out/summary.json")).unwrap(), "place");
    assert!(bench.read("out/report.html").contains("material is cut above the flutes (4 mm)"));
    for command in [
        &["check", RUN, "--json"][..],
        &["score", RUN, "--placement-of", "out", "--json"],
        &["explain", RUN, "--placement-of", "out", "--point", "3", "--beta-deg", "0", "--json"],
    ] {
        let ended = bench.stead(command);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert_eq!(ended.stderr.matches(of_path[1]).count(), 1, "{}", ended.stderr);
        found(&ended.json(), command[0]);
    }
}

#[test]
fn forces_inside_a_run_say_how_far_they_are_and_stop() {
    let bench = run_with_stock();
    let axis = "[[axis]]\nname = 'depth'\nfield = 'stock.box_mm'\nvalues = [[400, 440, 8], [400, 440, 10]]\n";
    bench.write("study.toml", &format!("base = '{RUN}'\n{axis}"));
    let stages = Arc::new(Mutex::new(BTreeSet::new()));
    let seen = Arc::clone(&stages);
    let monitor = Monitor::new(move |progress| {
        if let Progress::Steps { stage, done, total } = *progress {
            assert!(done <= total);
            seen.lock().unwrap().insert(stage);
        }
    });
    let run = stead::Run::read_with(bench.path(RUN), Vec::new(), &monitor).unwrap();
    assert!(run.warnings().iter().any(|warning| warning.kind == "above-flutes"));
    let known = stages.lock().unwrap().clone();
    assert!(known.contains("cutting") && known.contains("cutting with cells twice as large"), "{known:?}");
    stead::Study::read_with(bench.path("study.toml"), &monitor).unwrap();
    assert!(stages.lock().unwrap().contains("reading cases"));
    // Stopped, there is no run, and that is no fault of the file.
    monitor.stop_handle().stop();
    let stopped = [
        stead::Run::read_with(bench.path(RUN), Vec::new(), &monitor).map(drop),
        stead::Study::read_with(bench.path("study.toml"), &monitor).map(drop),
        stead::Checked::read_with(bench.path(RUN), &monitor).map(drop),
    ];
    for result in stopped {
        let error = result.unwrap_err();
        assert!(matches!(error, Error::Stopped(Stop::Asked)) && error.is_interrupted(), "{error}");
    }
}
