//! `stead import path` from outside: what it writes, says and refuses, and that what it writes can be placed.

use crate::common::Bench;

/// A plunge, a cut, a turn of the tool in place, a cut at another feed, a retract; then a second cut.
const PROGRAM: &str = "\
TOOL PATH/SLOT,TOOL,MILL_16
UNITS/MM
SPINDL/RPM,9000,CLW
RAPID
GOTO/0.,0.,60.,0.,0.,1.
RAPID
GOTO/0.,0.,12.
FEDRAT/MMPM,300.
GOTO/0.,0.,0.
FEDRAT/MMPM,1800.
GOTO/60.,0.,0.
GOTO/60.,0.,0.,0.,.1736482,.9848078
FEDRAT/MMPM,1200.
GOTO/60.,40.,0.
GOTO/60.,42.083778,11.817694
RAPID
GOTO/0.,0.,60.,0.,0.,1.
RAPID
GOTO/0.,40.,0.
GOTO/60.,40.,0.
COOLNT/OFF
END-OF-PATH
FINI
";

const IMPORT: [&str; 7] = ["import", "path", "slot.cls", "--out", "new/task.csv", "--step-mm", "20"];

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("slot.cls", PROGRAM);
    bench
}

#[test]
fn writes_a_task_and_says_what_was_changed() {
    let bench = bench();
    let ended = bench.stead(&[&IMPORT[..], &["--report"]].concat());
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""));
    for part in [
        "read      6 cutting and 3 rapid moves",
        "segments  2",
        "points    14, of which 10 are scored",
        "tilt      0.000 to 10.000 deg",
        "feed      5.000 to 30.000 mm/s",
        "- 2 points of plunges",
        "- 2 points of turns of the tool in place",
        "- words passed over: COOLNT 1",
        "written: new/task.csv: 2 segments, 14 points, 10 of them scored",
    ] {
        assert!(ended.stdout.contains(part), "{part} in {}", ended.stdout);
    }
    let task = bench.read("new/task.csv");
    assert_eq!(task.lines().next().unwrap().split(',').skip(10).collect::<Vec<_>>(), ["feed_mm_per_s", "scored"]);
    assert_eq!(task.lines().count(), 15);
    let again = bench.stead(&IMPORT);
    assert_eq!((again.code, again.stdout.as_str()), (Some(2), ""));
    again.assert_says(&["error: new/task.csv: is there already", "; allowed: "]);
    assert_eq!(bench.read("new/task.csv"), task);
}

#[test]
fn nothing_is_written_on_an_error() {
    let bench = bench();
    bench.replace("slot.cls", "GOTO/60.,40.,0.", "GOTO/60.,40.,nan");
    let before = bench.tree("");
    let ended = bench.stead(&IMPORT);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""));
    ended.assert_says(&["error: slot.cls:14: GOTO: ", "found '60.,40.,nan'", "; allowed: 3 or 6 finite numbers"]);
    for (option, value) in [("--step-mm", "0"), ("--chord-mm", "nan"), ("--machine", "table-ab"), ("--pivot-mm", "1,2")]
    {
        let ended = bench.stead(&["import", "path", "slot.cls", "--out", "new/task.csv", option, value]);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{option}");
        ended.assert_says(&[option, value]);
    }
    let missing = bench.stead(&["import", "path", "none.cls", "--out", "new/task.csv"]);
    assert_eq!(missing.code, Some(2));
    missing.assert_says(&["none.cls: cannot be read"]);
    assert_eq!(bench.tree(""), before);
}

#[test]
fn an_imported_path_is_placed_with_stated_forces() {
    let bench = bench();
    assert_eq!(bench.stead(&["init", "place", "new"]).code, Some(0));
    std::fs::remove_file(bench.path("new/task.csv")).unwrap();
    assert_eq!(bench.stead(&IMPORT).code, Some(0));
    let refused = bench.stead(&["place", "new/run.toml"]);
    assert_eq!(refused.code, Some(2));
    refused.assert_says(&["task: has no force columns", "[tool] and [cut]", "[forces] with feed_n"]);
    let forces = "[forces]\nfeed_n = -90.0\nnormal_n = -25.0\naxis_n = 10.0\n";
    let run = bench.read("new/run.toml").replace("max_beta_rate_deg_per_mm = 0.9", "max_beta_rate_deg_per_mm = 9.0");
    bench.write("new/run.toml", &format!("{run}\n{forces}"));
    let ended = bench.stead(&["place", "new/run.toml", "--out", "out", "--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let best = bench.read("out/best.csv");
    let header: Vec<&str> = best.lines().next().unwrap().split(',').collect();
    let column =
        |name: &str| header.iter().position(|own| *own == name).unwrap_or_else(|| panic!("{name} in {header:?}"));
    let score = column("score_mm");
    let scores: Vec<f64> =
        best.lines().skip(1).map(|row| row.split(',').nth(score).unwrap().parse().unwrap()).collect();
    assert_eq!((scores.len(), scores.iter().filter(|score| **score == 0.0).count()), (14, 4));
    let document = ended.json();
    let case = &document["cases"][0];
    let mean = case["mean_mm"].as_f64().unwrap();
    assert!((mean / (scores.iter().sum::<f64>() / 10.0) - 1.0).abs() < 1e-4, "{mean} {scores:?}");
}
