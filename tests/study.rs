//! Studies: in shards, edited, and what is refused.

use crate::common::{Bench, Ended, RUN};
use std::collections::BTreeMap;
use std::time::Duration;

pub const STUDY: &str = "configs/study.toml";

const AXES: &str = "base = \"run.toml\"
[[axis]]
field = \"robot.joints[1].stiffness_mnm_per_rad\"
values = [0.2, 0.8, 6.0]
[[axis]]
field = \"cell.z_mm\"
values = [[-220.0, -214.0], [-240.0, -234.0]]
labels = [\"high\", \"low\"]
";

/// A study of six cases that take a tenth of a second each.
pub fn bench() -> Bench {
    let bench = Bench::new();
    for (from, to) in [
        ("x_mm = [-300.0, 300.0]", "x_mm = [0.0, 10.0]"),
        ("y_mm = [-2240.0, -1640.0]", "y_mm = [-1645.0, -1640.0]"),
        ("z_mm = [-602.0, -214.0]", "z_mm = [-220.0, -214.0]"),
        ("q4 = [-1.0, 1.0]", "q4 = [0.62, 0.65]"),
        ("population = 16", "population = 4"),
        ("generations = 3\nbasins = 2", "generations = 1\nbasins = 1"),
    ] {
        bench.replace(RUN, from, to);
    }
    let task = bench.read("tasks/five-segments.csv");
    bench.write("tasks/five-segments.csv", &task.lines().take(8).map(|line| format!("{line}\n")).collect::<String>());
    bench.write(STUDY, AXES);
    bench
}

pub fn run(bench: &Bench, out: &str, more: &[&str]) -> Ended {
    let ended = bench.stead(&[&["study", "run", STUDY, "--out", out], more].concat());
    // A machine that is slow shows progress.
    let is_quiet = ended.stderr.lines().all(|line| line.starts_with("progress: "));
    assert!(ended.code == Some(0) && is_quiet, "{}{}", ended.stdout, ended.stderr);
    ended
}

/// The file that depends on nothing but the study.
pub fn results(bench: &Bench, out: &str) -> Vec<u8> {
    std::fs::read(bench.path(&format!("{out}/study.csv"))).unwrap()
}

/// The rows of a table of results, by the names of the columns.
fn rows(bench: &Bench, out: &str) -> Vec<BTreeMap<String, String>> {
    let text = bench.read(&format!("{out}/study.csv"));
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    reader.deserialize().map(Result::unwrap).collect()
}

#[test]
fn shards_in_any_order_and_on_any_threads_give_the_bytes_of_one() {
    let bench = bench();
    let whole = run(&bench, "whole", &["--threads", "1"]);
    assert_eq!(whole.stdout, "study: 6 of 6 cases done, 6 of them now; results in whole/study.csv\n");
    assert_eq!(bench.names("whole/shards"), ["0001-of-0001.jsonl", "0001-of-0001.lock"]);
    let expected = results(&bench, "whole");
    for (out, order) in [("a", [4, 1, 3, 2]), ("b", [2, 3, 4, 1])] {
        for (done, shard) in order.iter().enumerate() {
            assert!(!bench.path(&format!("{out}/study.csv")).exists());
            let ended = run(&bench, out, &["--threads", "2", "--shard", &format!("{shard}/4")]);
            assert_eq!(ended.stdout.contains("results in"), done == 3, "{}", ended.stdout);
            let status = bench.stead(&["study", "status", STUDY, "--out", out]).stdout;
            let planned = if *shard < 3 { 2 } else { 1 };
            let line = format!("{shard}/4{planned:>9}{planned:>9}");
            assert!(status.contains(&line) && status.contains("of 6 cases done, 0 infeasible, 0 failed"), "{status}");
        }
        assert_eq!(results(&bench, out), expected);
    }
    let ended = run(&bench, "whole", &[]);
    assert!(ended.stdout.contains("6 of 6 cases done, 0 of them now"), "{}", ended.stdout);
    assert_eq!(results(&bench, "whole"), expected);

    let rows = rows(&bench, "whole");
    assert_eq!(rows.len(), 6);
    let column = |name: &str| rows.iter().map(|row| row[name].clone()).collect::<Vec<_>>();
    assert_eq!(column("case"), ["1", "2", "3", "4", "5", "6"]);
    assert_eq!(column("cell.z_mm"), ["high", "low", "high", "low", "high", "low"]);
    assert_eq!(column("robot.joints[1].stiffness_mnm_per_rad"), ["0.2", "0.2", "0.8", "0.8", "6", "6"]);
    assert!(column("task").iter().all(|task| task == "five-segments.csv"));
    let mean: Vec<f64> = column("best_mean_wall_mm").iter().map(|mean| mean.parse().unwrap()).collect();
    assert!(mean[0] > mean[2] && mean[1] > mean[3], "{mean:?}");
}

#[test]
fn a_case_is_what_place_finds_with_the_same_values() {
    let bench = bench();
    bench.write(STUDY, &format!("keep = \"best 2\"\n{AXES}"));
    run(&bench, "out", &[]);
    let rows = rows(&bench, "out");
    let values = ["robot.joints[1].stiffness_mnm_per_rad=6.0", "cell.z_mm=[-240.0, -234.0]"];
    let arguments = ["place", RUN, "--out", "placed", "--set", values[0], "--set", values[1]];
    let placed = bench.stead(&arguments);
    assert_eq!(placed.code, Some(0), "{}", placed.stderr);
    placed.assert_says(&["note: cell.z_mm is [-240.0, -234.0] in place of what the files say"]);
    let placements = bench.read("placed/placements.csv");
    let mut reader = csv::Reader::from_reader(placements.as_bytes());
    let best: BTreeMap<String, f64> = {
        let row: BTreeMap<String, String> = reader.deserialize().next().unwrap().unwrap();
        row.into_iter().filter_map(|(name, text)| Some((name, text.parse().ok()?))).collect()
    };
    let figure = |name: &str| rows[5][name].parse::<f64>().unwrap();
    for (ours, theirs) in [
        ("objective_mm", "objective_mm"),
        ("best_mean_wall_mm", "mean_wall_mm"),
        ("best_max_total_mm", "max_total_mm"),
        ("x_mm", "x_mm"),
        ("yaw_deg", "yaw_deg"),
        ("cycle_s", "cycle_s"),
        ("max_feed_mm_per_s", "max_feed_mm_per_s"),
    ] {
        assert_eq!(figure(ours), best[theirs], "{ours}");
    }
    let mut by_objective: Vec<&BTreeMap<String, String>> = rows.iter().collect();
    by_objective.sort_by(|a, b| {
        let objective = |row: &BTreeMap<String, String>| row["objective_mm"].parse::<f64>().unwrap();
        objective(a).total_cmp(&objective(b))
    });
    let mut folders: Vec<String> =
        by_objective[..2].iter().map(|row| format!("{:0>4}-{}", row["case"], &row["id"][..8])).collect();
    folders.sort();
    let kept = std::fs::read_dir(bench.path("out/cases")).unwrap();
    let mut kept: Vec<String> = kept.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    kept.sort();
    assert_eq!(kept, folders);
    let of_case = &by_objective[0];
    let folder = format!("out/cases/{:0>4}-{}/placements.csv", of_case["case"], &of_case["id"][..8]);
    assert!(bench.read(&folder).contains(&of_case["x_mm"]));
}

#[test]
fn shards_that_end_together_keep_the_best_cases_once() {
    let bench = bench();
    bench.write(STUDY, &format!("keep = \"best 4\"\n{AXES}"));
    let shard = |shard: &str| {
        let mut command = bench.command(&["study", "run", STUDY, "--out", "out", "--threads", "1", "--shard", shard]);
        command.stdout(std::process::Stdio::null()).stderr(std::process::Stdio::piped()).spawn().unwrap()
    };
    let children = ["1/3", "2/3", "3/3"].map(shard);
    for child in children {
        let ended = Ended::from(child.wait_with_output().unwrap());
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    }
    assert_eq!(std::fs::read_dir(bench.path("out/cases")).unwrap().count(), 4);
}

#[test]
fn an_edited_study_does_what_the_edit_has_changed() {
    let bench = bench();
    run(&bench, "out", &[]);
    let before = rows(&bench, "out");
    // A comment and another order of the values change nothing of any case.
    bench.replace(STUDY, "[0.2, 0.8, 6.0]", "[0.8, 0.2, 6.0] # reordered");
    assert!(run(&bench, "out", &[]).stdout.contains("6 of 6 cases done, 0 of them now"));
    let after = rows(&bench, "out");
    assert_eq!((&after[0]["case"], &after[0]["id"]), (&"1".to_owned(), &before[2]["id"]));
    bench.replace(STUDY, "[0.8, 0.2, 6.0]", "[0.8, 0.2, 1.6, 6.0]");
    assert!(run(&bench, "out", &[]).stdout.contains("8 of 8 cases done, 2 of them now"));
    // Nor does a comment in the run file, but a seed does.
    bench.replace(RUN, "seed = 1", "seed = 1 # a comment");
    assert!(run(&bench, "out", &[]).stdout.contains("8 of 8 cases done, 0 of them now"));
    bench.replace(RUN, "seed = 1", "seed = 2");
    assert!(run(&bench, "out", &[]).stdout.contains("8 of 8 cases done, 8 of them now"));
    let fresh = run(&bench, "fresh", &[]);
    assert!(fresh.stdout.contains("8 of them now"));
    assert_eq!(results(&bench, "out"), results(&bench, "fresh"));
}

#[test]
fn kept_cases_of_values_that_were_edited_are_named_and_removed_when_asked() {
    let bench = bench();
    bench.write(STUDY, &format!("keep = \"all\"\n{AXES}"));
    run(&bench, "out", &[]);
    let kept = |bench: &Bench| -> Vec<String> {
        bench.names("out/cases").into_iter().filter(|name| !name.contains('/')).collect()
    };
    let before = kept(&bench);
    assert_eq!(before.len(), 6);
    bench.replace(STUDY, "[0.2, 0.8, 6.0]", "[0.2, 0.9, 6.0]");
    // Of one of the two that are not of the study any longer the user has made something, and beside them.
    bench.write(&format!("out/cases/{}/mine.txt", before[2]), "the user's own\n");
    bench.write("out/cases/mine/mine.txt", "the user's own\n");
    let stale = format!(
        "note: 2 kept cases not of the study as it is now: {}, {}; `stead study run --prune` removes them",
        before[2], before[3]
    );
    let ended = bench.stead(&["study", "run", STUDY, "--out", "out"]);
    assert_eq!((ended.code, ended.stderr.contains(&stale)), (Some(0), true), "{}", ended.stderr);
    let status = bench.stead(&["study", "status", STUDY, "--out", "out"]);
    assert!(status.stderr.contains(&stale), "{}", status.stderr);
    let document = bench.stead(&["study", "status", STUDY, "--out", "out", "--json"]).json();
    assert_eq!(document["stale_cases"], serde_json::json!([before[2], before[3]]));
    assert_eq!(kept(&bench).len(), 9);

    let ended = bench.stead(&["study", "run", STUDY, "--out", "out", "--prune"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&["note: 1 kept case removed that the study has no longer"]);
    let after = kept(&bench);
    assert!(after.len() == 8 && !after.contains(&before[3]), "{after:?}");
    assert_eq!(bench.names(&format!("out/cases/{}", before[2])), ["mine.txt"]);
    assert_eq!(bench.read("out/cases/mine/mine.txt"), "the user's own\n");
    // The others are as the study has left them.
    let ended = run(&bench, "fresh", &[]);
    assert!(ended.stdout.contains("6 of them now"));
    let [pruned, fresh] = ["out", "fresh"].map(|out| bench.tree(&format!("{out}/cases/{}", before[0])));
    assert!(pruned == fresh);
}

#[test]
fn a_case_without_a_placement_is_a_row_with_its_reason() {
    let bench = bench();
    bench.replace(STUDY, "[-240.0, -234.0]", "[-9240.0, -9234.0]");
    run(&bench, "out", &[]);
    let rows = rows(&bench, "out");
    for row in rows {
        let is_far = row["cell.z_mm"] == "low";
        assert_eq!(row["status"], if is_far { "infeasible" } else { "placed" });
        assert_eq!(row["objective_mm"].is_empty(), is_far);
        assert!(!is_far || row["reason"].contains("no feasible placement was found"), "{}", row["reason"]);
    }
    let status = bench.stead(&["study", "status", STUDY, "--out", "out"]).stdout;
    assert!(status.contains("6 of 6 cases done, 3 infeasible, 0 failed"), "{status}");
}

#[test]
fn tasks_are_placed_each_or_as_one() {
    let bench = bench();
    let task = bench.read("tasks/five-segments.csv");
    bench.write("tasks/other.csv", &task.replace("-150", "-250"));
    let tasks = "[[task]]\nfile = \"../tasks/five-segments.csv\"\nlabel = \"a\"\nweight = 3\n\
                 [[task]]\nfile = \"../tasks/other.csv\"\nlabel = \"b\"\n";
    bench.write(STUDY, &format!("base = \"run.toml\"\n{tasks}"));
    run(&bench, "each", &[]);
    let each = rows(&bench, "each");
    assert_eq!(
        each.iter().map(|row| (row["task"].as_str(), row["task_weight"].as_str())).collect::<Vec<_>>(),
        [("a", "3"), ("b", "1")]
    );
    bench.write(STUDY, &format!("base = \"run.toml\"\nplacement = \"one\"\n{tasks}"));
    run(&bench, "one", &[]);
    let one = rows(&bench, "one");
    assert_eq!((one.len(), one[0]["task"].as_str(), one[0]["status"].as_str()), (1, "a + b", "placed"));
}

/// Runs a study that must be refused with one line, exit code 2 and nothing changed.
#[track_caller]
fn refused(bench: &Bench, arguments: &[&str], parts: &[&str]) {
    let before = bench.tree("");
    let ended = bench.stead(&[&["study", "run"], arguments].concat());
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
    ended.assert_says(parts);
    assert!(!ended.stderr.contains("panicked"), "{}", ended.stderr);
    assert_eq!(bench.tree(""), before);
}

#[test]
fn bad_studies_are_refused_before_anything_runs() {
    let k1 = "robot.joints[1].stiffness_mnm_per_rad";
    for (from, to, parts) in [
        (
            k1,
            "robot.joints[1].stifness_mnm_per_rad",
            &[
                "robots/kuka-kr270-2.toml: case 1 of study.toml (robot.joints[1].stifness_mnm_per_rad = 0.2, cell.z_mm = high): ",
                "joints[1].stifness_mnm_per_rad: unknown key (nearest known one: stiffness_mnm_per_rad), found 0.2",
            ][..],
        ),
        (
            "\"cell.z_mm\"",
            "\"cell.z_m\"",
            &["run.toml: case 1 of study.toml", "cell.z_m: unknown key (nearest known one: z_mm)"],
        ),
        (
            "\"cell.z_mm\"",
            "\"cell..z_mm\"",
            &["study.toml:6: axis[2].field: is no path of a field", "allowed: keys joined"],
        ),
        ("[0.2, 0.8, 6.0]", "[]", &["study.toml:4: axis[1].values: has no values", "found []"]),
        ("values = [0.2, 0.8, 6.0]\n", "", &["study.toml:2: axis[1]: has no values", "values = [..] or range"]),
        (
            "[0.2, 0.8, 6.0]",
            "[0.2, -0.8, 6.0]",
            &[
                "case 3 of study.toml (robot.joints[1].stiffness_mnm_per_rad = -0.8, cell.z_mm = high): ",
                "is out of range, found -0.8",
            ],
        ),
        ("[-240.0, -234.0]]", "[-240.0, -234.0]", &["study.toml", "is not readable as TOML"]),
        ("[\"high\", \"low\"]", "[\"high\"]", &["axis[2].labels: has 1 labels for 2 values"]),
        ("base = \"run.toml\"", "base = \"ran.toml\"", &["study.toml:1: base: names a file that cannot be read"]),
        ("base", "combine = \"zipped\"\nbase", &["axis[2]: has 2 values, and the first axis 3"]),
        ("base", "combine = \"latin\"\nbase", &["samples: is missing", "a whole number from 1"]),
        ("base", "samples = 3\nbase", &["samples: is for a Latin hypercube"]),
        ("base", "keep = \"best 0\"\nbase", &["keep: is unknown, found \"best 0\"", "\"none\", \"all\""]),
        ("base", "certify = true\nbase", &["certificate: is missing, but the study asks for certificates"]),
        ("base", "exclude = [\"robt == 1\"]\nbase", &["exclude[1]: names robt, which is on no axis", "nearest one: "]),
        ("base", "exclude = [\"cell.z_mm[1] < \"]\nbase", &["exclude[1]: has '' where a value should be"]),
        ("base", "exclude = [\"cell.z_mm[1] < 0\"]\nbase", &["exclude: leaves no case"]),
        ("base", "axes = 3\nbase", &["study.toml:1: axes: unknown key (nearest known one: axis)"]),
        (
            "field = \"cell.z_mm\"",
            "name = \"status\"\nfield = \"cell.z_mm\"",
            &["axis: an axis has the name of a column"],
        ),
    ] {
        let bench = bench();
        bench.replace(STUDY, from, to);
        refused(&bench, &[STUDY], parts);
    }
}

#[test]
fn shards_out_of_range_other_studies_and_locks_are_refused() {
    let bench = bench();
    for bad in ["5/4", "0/4", "1/0", "1", "a/b", "1/10000"] {
        refused(&bench, &[STUDY, "--shard", bad], &["--shard", "allowed: I/N with whole numbers"]);
    }
    run(&bench, "out", &[]);
    bench.write("configs/other.toml", AXES);
    refused(
        &bench,
        &["configs/other.toml", "--out", "out"],
        &[
            "out/study.json: is of another study, study, and not of other",
            "; allowed: a folder of this study, or a new one",
        ],
    );
    bench.write("odd/study.json", "{}");
    refused(&bench, &[STUDY, "--out", "odd"], &["odd/study.json: is no description of a study"]);
    let below = format!("{RUN}/out");
    refused(
        &bench,
        &[STUDY, "--out", &below],
        &["run.toml/out/study.json: is below a file; allowed: a folder of this"],
    );

    let lock = stead_disk::files::Lock::attempt(&bench.path("out/shards/0001-of-0001.lock")).unwrap();
    assert!(matches!(lock, stead_disk::files::TryLock::Taken(_)));
    let before = results(&bench, "out");
    let ended = bench.stead(&["study", "run", STUDY, "--out", "out"]);
    assert_eq!((ended.code, ended.stderr.lines().count()), (Some(1), 1), "{}", ended.stderr);
    ended.assert_says(&["shard 1/1 of the study is being worked on by another process; allowed: "]);
    assert_eq!(results(&bench, "out"), before);
    let status = bench.stead(&["study", "status", STUDY, "--out", "out"]);
    assert!(status.stdout.contains("running"), "{}", status.stdout);
}

#[test]
fn a_journal_that_was_changed_is_told_and_its_cases_done_again() {
    let bench = bench();
    for shard in ["1/2", "2/2"] {
        run(&bench, "out", &["--shard", shard]);
    }
    let expected = results(&bench, "out");
    let file = bench.path("out/shards/0002-of-0002.jsonl");
    let bytes = std::fs::read(&file).unwrap();
    let second = bytes.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    let mut changed = bytes.clone();
    changed[second + 100] ^= 1;
    std::fs::write(&file, &changed).unwrap();
    let status = bench.stead(&["study", "status", STUDY, "--out", "out"]);
    assert!(status.stdout.starts_with("4 of 6 cases done"), "{}", status.stdout);
    let warning = "warning: out/shards/0002-of-0002.jsonl: line 2 is not as it was written; its case and those behind";
    status.assert_says(&[warning]);
    let ended = bench.stead(&["study", "run", STUDY, "--out", "out", "--shard", "2/2"]);
    assert_eq!(ended.code, Some(0));
    ended.assert_says(&[warning, " it are done again"]);
    assert!(ended.stdout.starts_with("shard 2/2: 3 of 3 cases done, 2 of them now; results in"), "{}", ended.stdout);
    assert_eq!(results(&bench, "out"), expected);
    assert!(!bench.stead(&["study", "status", STUDY, "--out", "out"]).stderr.contains("warning"));
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_what_is_done() {
    let bench = bench();
    bench.replace(RUN, "population = 4", "population = 400");
    bench.replace(RUN, "generations = 1", "generations = 2000");
    let child = bench.command(&["study", "run", STUDY, "--out", "out"]);
    let mut child =
        { child }.stderr(std::process::Stdio::piped()).stdout(std::process::Stdio::piped()).spawn().unwrap();
    while !bench.path("out/shards/0001-of-0001.jsonl").exists() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(20));
    }
    std::thread::sleep(Duration::from_millis(100));
    assert!(std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let ended = Ended::from(child.wait_with_output().unwrap());
    assert_eq!(ended.code, Some(130), "{}", ended.stderr);
    ended.assert_says(&["interrupted: finished cases are kept; the same command continues"]);
    assert!(bench.path("out/shards/0001-of-0001.jsonl").exists());
}
