//! `stead schema` and `stead init` from outside.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may panic, in its helpers too")]

use crate::common::Bench;
use std::path::Path;

/// A starter set in the folder `new`.
fn starter(kind: &str) -> Bench {
    let bench = Bench::new();
    let ended = bench.stead(&["init", kind, "new"]);
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""), "{kind}");
    assert!(ended.stdout.contains("now run: stead "), "{}", ended.stdout);
    bench
}

#[test]
fn every_starter_set_runs() {
    for (kind, files, commands) in [
        ("place", &["cell.toml", "robot.toml", "run.toml", "task.csv"][..], &[&["place", "new/run.toml"][..]][..]),
        ("assess", &["assess.toml", "robot.toml"], &[&["assess", "new/assess.toml"]]),
        (
            "identify",
            &["identify.toml", "robot.toml", "sheet.csv"],
            &[&["identify", "plan", "new/identify.toml"], &["identify", "fit", "new/identify.toml"]],
        ),
        (
            "simulate",
            &["robot.toml", "simulate.toml"],
            &[&["simulate", "new/simulate.toml"], &["stability", "new/simulate.toml"]],
        ),
        (
            "study",
            &["cell.toml", "robot.toml", "run.toml", "study.toml", "task.csv"],
            &[&["study", "run", "new/study.toml"]],
        ),
        (
            "compensate",
            &["cell.toml", "compensate.toml", "robot.toml", "run.toml", "task.csv"],
            &[&["place", "new/run.toml", "--out", "new/results"], &["compensate", "new/compensate.toml"]],
        ),
    ] {
        let bench = starter(kind);
        assert!(bench.tree("new").keys().map(String::as_str).eq(files.iter().copied()), "{kind}");
        for command in commands {
            let out = if command.contains(&"--out") { &[][..] } else { &["--out", "out"] };
            let ended = bench.stead(&[command, out].concat());
            assert_eq!(ended.code, Some(0), "{command:?}: {}", ended.stderr);
        }
    }
}

#[test]
fn a_file_that_is_there_is_neither_replaced_nor_joined() {
    let bench = Bench::new();
    bench.write("new/robot.toml", "mine\n");
    let before = bench.tree("");
    for kind in ["place", "assess", "identify", "simulate", "study", "compensate"] {
        let ended = bench.stead(&["init", kind, "new"]);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""));
        ended.assert_says(&["error: new/robot.toml: is there already", "; allowed: "]);
        assert_eq!(bench.tree(""), before);
    }
    assert_eq!(bench.stead(&["init", "cook", "new"]).code, Some(2));
    // What is not of the kind is somebody else's, with --force too.
    let foreign = bench.stead(&["init", "assess", "new", "--force"]);
    assert_eq!(foreign.code, Some(2));
    foreign.assert_says(&["new/robot.toml: was not written by this command, and is not replaced"]);
    assert_eq!(bench.tree(""), before);
    let begin = starter("assess").read("new/robot.toml").lines().next().unwrap().to_owned();
    bench.write("new/robot.toml", &(begin + "\n# mine\n"));
    let replaced = bench.stead(&["init", "assess", "new", "--force"]);
    assert_eq!((replaced.code, bench.tree("new").len()), (Some(0), 2), "{}", replaced.stderr);
    assert!(bench.read("new/robot.toml").contains("[[joints]]"));
}

#[test]
fn a_study_and_a_compensation_begin_from_the_run_that_is_there() {
    let bench = starter("place");
    bench
        .write("new/run.toml", &bench.read("new/run.toml").replace("joint_margin_deg = 2.0", "joint_margin_deg = 3.0"));
    for (kind, file) in [("study", "study.toml"), ("compensate", "compensate.toml")] {
        let before = bench.tree("new");
        let ended = bench.stead(&["init", kind, "new"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert!(ended.stdout.starts_with(&format!("written: new/{file}\n")), "{}", ended.stdout);
        let after = bench.tree("new");
        assert_eq!(after.len(), before.len() + 1);
        assert!(before.iter().all(|(name, bytes)| after.get(name) == Some(bytes)));
    }
    let status = bench.stead(&["study", "status", "new/study.toml"]);
    assert_eq!(status.code, Some(0), "{}", status.stderr);
}

#[test]
fn schemas_are_printed_as_they_are_kept() {
    let bench = Bench::new();
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/schema");
    let files = |folder| std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files: Vec<_> = files(kept.join("results")).chain(files(kept)).filter(|path| path.is_file()).collect();
    assert!(files.len() > 28);
    for path in files {
        let ended = bench.stead(&["schema", path.file_stem().unwrap().to_str().unwrap()]);
        assert_eq!((ended.code, ended.stdout), (Some(0), std::fs::read_to_string(&path).unwrap()));
    }
    let ended = bench.stead(&["schema", "robbot"]);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""));
    ended.assert_says(&["no schema 'robbot'", "nearest known one: robot", "; allowed: run, robot", "place-summary"]);
}
