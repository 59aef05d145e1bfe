//! Results folders that are safe at any moment: killed runs, changed files, two runs at once, disks that are full.

use crate::common::{Bench, RUN};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

/// Every file in a folder.
type Tree = BTreeMap<String, Option<Vec<u8>>>;

/// A run that takes a fraction of a second and leaves all files of a placement.
fn quick() -> Bench {
    let bench = Bench::new();
    bench.replace(RUN, "x_mm = [-300.0, 300.0]", "x_mm = [0.0, 10.0]");
    bench.replace(RUN, "y_mm = [-2240.0, -1640.0]", "y_mm = [-1645.0, -1640.0]");
    bench.replace(RUN, "z_mm = [-602.0, -214.0]", "z_mm = [-220.0, -214.0]");
    bench.replace(RUN, "q4 = [-1.0, 1.0]", "q4 = [0.62, 0.65]");
    bench.replace(RUN, "generations = 3\nbasins = 2", "generations = 0\nbasins = 1");
    bench.replace(RUN, "beta_step_deg = 7.2", "beta_step_deg = 30.0");
    let task = bench.read("tasks/five-segments.csv");
    let mut short = String::new();
    for line in task.lines().take(9) {
        writeln!(short, "{line}").unwrap();
    }
    bench.write("tasks/five-segments.csv", &short);
    bench
}

fn hex(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::new(), |mut hex, byte| {
        write!(hex, "{byte:02x}").unwrap();
        hex
    })
}

/// Asserts that a manifest states the size and the digest of every file that it lists.
fn assert_states(set: &Value, tree: &Tree) {
    let files = set["files"].as_array().unwrap();
    assert!(!files.is_empty() && set["complete"] == true, "{set:#}");
    for file in files {
        let name = file["name"].as_str().unwrap();
        let bytes = tree.get(name).and_then(Option::as_ref).unwrap_or_else(|| panic!("{name} is not there"));
        assert_eq!((file["bytes"].as_u64(), file["sha256"].as_str()), (Some(bytes.len() as u64), Some(&*hex(bytes))));
    }
}

fn sets(tree: &Tree) -> Vec<Value> {
    let manifest: Value = serde_json::from_slice(tree["manifest.json"].as_ref().unwrap()).unwrap();
    assert_eq!(manifest["format"], 1);
    manifest["results"].as_array().unwrap().clone()
}

#[test]
fn a_manifest_states_what_a_run_has_read_and_written() {
    let bench = quick();
    assert_eq!(bench.stead(&["place", RUN, "--out", "out"]).code, Some(0));
    let tree = bench.tree("out");
    let sets = sets(&tree);
    assert_states(&sets[0], &tree);
    assert_eq!((sets.len(), &sets[0]["command"]), (1, &"place".into()));
    assert_eq!(sets[0]["files"].as_array().unwrap().len(), tree.len() - 1);
    let summary: Value = serde_json::from_slice(tree["summary.json"].as_ref().unwrap()).unwrap();
    assert_eq!(sets[0]["inputs"], summary["inputs"]);
}

/// Shipped results: files that are not shipped, for their size, are listed all the same.
#[test]
fn every_shipped_folder_is_what_its_manifest_states() {
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("results");
    let mut count = 0;
    for folder in std::fs::read_dir(results).unwrap().map(|folder| folder.unwrap().path()) {
        // What a study is made of is not shipped, but is there where it was run here.
        let is_unshipped = |path: &Path| {
            path.is_dir() || ["study.json", "study.lock", "study-timing.csv"].iter().any(|name| path.ends_with(name))
        };
        let files = std::fs::read_dir(&folder).unwrap().map(|file| file.unwrap().path());
        let files = files.filter(|path| !is_unshipped(path));
        let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
        let tree: Tree = files.map(|path| (name(&path), Some(std::fs::read(&path).unwrap()))).collect();
        let mut listed = 0;
        for mut set in sets(&tree) {
            let is_large = |name: &str| name == "series.csv" || (name.starts_with("map-") && name.ends_with(".csv"));
            let files = set["files"].as_array_mut().unwrap();
            files.retain(|file| {
                let name = file["name"].as_str().unwrap();
                tree.contains_key(name) || !is_large(name)
            });
            listed += files.len();
            assert_states(&set, &tree);
        }
        assert_eq!(listed, tree.len() - 1, "{}", folder.display());
        count += 1;
    }
    assert!(count >= 12, "{count}");
}

#[test]
fn a_result_that_was_changed_is_refused_with_what_to_do() {
    let bench = quick();
    bench.copy("configs/compensate-caro-2013.toml", "configs/compensate.toml");
    bench.replace("configs/compensate.toml", "\"caro-2013.toml\"", "\"run.toml\"");
    bench.replace("configs/compensate.toml", "../results/caro-2013/best.csv", "../out/best.csv");
    let compensate = ["compensate", "configs/compensate.toml", "--out", "corrected"];
    let score = ["score", RUN, "--placement-of", "out", "--json"];
    assert_eq!(bench.stead(&["place", RUN, "--out", "out"]).code, Some(0));
    let ended = bench.stead(&compensate);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(bench.stead(&score).code, Some(0));
    for (command, file) in [(&compensate[..], "out/best.csv"), (&score[..], "out/summary.json")] {
        let before = bench.read(file);
        bench.write(file, &format!("{before}\n"));
        let ended = bench.stead(command);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
        assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
        ended.assert_says(&[file, ": is not the file that `stead place` has written, by the manifest.json beside it"]);
        ended.assert_says(&["; allowed: sha256 ", "run `stead place` again, or copy a changed file to another folder"]);
        bench.write(file, &before);
    }
    // A plan that no run has left there; and without a manifest, whose it is is the user's affair.
    bench.write("out/mine.csv", &bench.read("out/best.csv"));
    bench.replace("configs/compensate.toml", "../out/best.csv", "../out/mine.csv");
    let ended = bench.stead(&compensate);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    ended.assert_says(&["out/mine.csv: is not among the results that the manifest.json beside it lists; allowed: "]);
    std::fs::remove_file(bench.path("out/manifest.json")).unwrap();
    assert_eq!(bench.stead(&compensate).code, Some(0));
}

/// A robot file is an input like any other, but here it is a result too.
#[test]
fn an_identified_robot_is_used_as_it_was_written_and_not_when_it_was_changed() {
    let bench = Bench::new();
    bench.copy("configs/identify-example.toml", "configs/identify.toml");
    bench.copy_all(&["tasks/identify-example.csv"]);
    assert_eq!(bench.stead(&["identify", "fit", "configs/identify.toml", "--out", "out"]).code, Some(0));
    let robot = bench.read("out/robot-identified.toml");
    bench.write("out/robot-identified.toml", &robot.replacen("compliance", "compliance ", 1));
    bench.replace("configs/identify.toml", "robots/kuka-kr270-2.toml", "../out/robot-identified.toml");
    let ended = bench.stead(&["identify", "fit", "configs/identify.toml", "--out", "again"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    ended.assert_says(&["robot-identified.toml: is not the file that `stead identify fit` has written"]);
    bench.write("out/robot-identified.toml", &robot);
    assert_eq!(bench.stead(&["identify", "fit", "configs/identify.toml", "--out", "again"]).code, Some(0));
}

#[test]
fn a_manifest_of_something_else_is_left_alone() {
    let bench = quick();
    bench.write("out/manifest.json", "{\"name\": \"a web page\"}\n");
    let before = bench.tree("");
    let ended = bench.stead(&["place", RUN, "--out", "out"]);
    assert_eq!((ended.code, ended.stderr.lines().count()), (Some(2), 1), "{}", ended.stderr);
    ended.assert_says(&["out/manifest.json: is none of stead and is left as it is: ", "; allowed: another folder"]);
    assert_eq!(bench.tree(""), before);
}

mod killed {
    use super::*;
    use crate::common::Ended;
    use std::process::{Child, Command, Stdio};
    use std::time::{Duration, Instant};

    const SEEDS: [&str; 2] = ["1", "2"];

    fn place(bench: &Bench, seed: &str) -> Command {
        let mut command = bench.command(&["place", RUN, "--out", "out", "--seed", seed, "--threads", "1"]);
        command.stdout(Stdio::null()).stderr(Stdio::null());
        command
    }

    /// What a run leaves that nobody disturbs, how long it takes, and how much of that it writes results.
    fn undisturbed(seed: &str) -> (Tree, [Duration; 2]) {
        let bench = quick();
        let begun = Instant::now();
        let mut child = place(&bench, seed).spawn().unwrap();
        while !is_writing(&bench) && child.try_wait().unwrap().is_none() {}
        let writing = Instant::now();
        assert!(child.wait().unwrap().success());
        (bench.tree("out"), [begun.elapsed(), writing.elapsed()])
    }

    /// Whether there is a temporary file with something in it: the empty one of the start is none.
    fn is_writing(bench: &Bench) -> bool {
        let is_written = |path: std::path::PathBuf| {
            let is_temporary = path.extension().is_some_and(|end| end == "tmp");
            is_temporary && path.metadata().is_ok_and(|metadata| metadata.len() > 0)
        };
        std::fs::read_dir(bench.path("out")).is_ok_and(|names| names.flatten().any(|name| is_written(name.path())))
    }

    /// When a run is killed.
    #[derive(Debug, Clone, Copy)]
    enum Moment {
        /// So long after its start.
        After(Duration),
        /// So long after it has begun to write results: its first temporary file after that of the start.
        Writing(Duration),
        /// As soon as the manifest says that results are being put in place.
        Marked,
    }

    /// Kills a process, which has no others, at a moment or not at all where it has ended before.
    fn kill(bench: &Bench, mut child: Child, moment: Moment) {
        let begun = Instant::now();
        let out = bench.path("out");
        let has_ended = |child: &mut Child| child.try_wait().unwrap().is_some();
        match moment {
            Moment::After(time) => std::thread::sleep(time),
            Moment::Writing(time) => {
                while !is_writing(bench) && !has_ended(&mut child) {}
                let seen = Instant::now();
                while seen.elapsed() < time {}
            }
            Moment::Marked => {
                let is_marked = || {
                    std::fs::read_to_string(out.join("manifest.json"))
                        .is_ok_and(|text| text.contains("\"complete\": false"))
                };
                while !is_marked() && !has_ended(&mut child) {
                    assert!(begun.elapsed() < Duration::from_secs(60), "it does not end");
                }
            }
        }
        // It may have ended.
        let _ = child.kill();
        child.wait().unwrap();
    }

    /// What a folder is after a kill.
    #[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
    enum State {
        Nothing,
        OneRun,
        Marked,
    }

    /// Asserts that a folder has results of one run, or is marked and refused.
    fn state(bench: &Bench, runs: &[Tree; 2]) -> State {
        let tree = bench.tree("out");
        assert_eq!(tree["own.txt"].as_deref(), Some(&b"the user's own\n"[..]));
        if !tree.contains_key("manifest.json") {
            assert!(!runs[0].keys().any(|name| tree.contains_key(name)), "{:?}", tree.keys());
            return State::Nothing;
        }
        let is_complete = sets(&tree)[0]["complete"] == true;
        let scored = bench.stead(&["score", RUN, "--placement-of", "out", "--json"]);
        if is_complete {
            assert_states(&sets(&tree)[0], &tree);
            assert!(runs.iter().any(|run| run.iter().all(|(name, bytes)| tree.get(name) == Some(bytes))));
            assert_eq!(scored.code, Some(0), "{}", scored.stderr);
            return State::OneRun;
        }
        assert_eq!((scored.code, scored.stdout.as_str()), (Some(2), ""), "{}", scored.stderr);
        // Before its first file is in place there may be no summary at all.
        if tree.contains_key("summary.json") {
            scored.assert_says(&[
                "out/summary.json: is from a run of `stead place` that did not come to its end",
                "; allowed: results of a run that did: run `stead place` again",
            ]);
        }
        State::Marked
    }

    /// Kills runs of two seeds in turn, in one folder, and lets one in so many come to its end.
    fn kills(count: usize) {
        let [(one, [time, writing]), (two, _)] = SEEDS.map(undisturbed);
        let runs = [one, two];
        assert_ne!(runs[0]["summary.json"], runs[1]["summary.json"]);
        let bench = quick();
        bench.write("out/own.txt", "the user's own\n");
        let mut met = BTreeMap::new();
        for index in 0..count {
            let share = index as f64 / count as f64;
            let moment = match index % 4 {
                0 => Moment::After(time.mul_f64(1.2 * share)),
                1 | 2 => Moment::Writing(writing.mul_f64(share)),
                _ => Moment::Marked,
            };
            let child = place(&bench, SEEDS[index % 2]).spawn().unwrap();
            kill(&bench, child, moment);
            *met.entry(state(&bench, &runs)).or_insert(0) += 1;
            if index % 5 == 4 || index + 1 == count {
                let which = (index / 5) % 2;
                assert!(place(&bench, SEEDS[which]).status().unwrap().success());
                let mut tree = bench.tree("out");
                tree.remove("own.txt").unwrap();
                assert!(tree.keys().eq(runs[which].keys()), "{:?}", tree.keys());
                assert!(tree == runs[which], "not the bytes of an undisturbed run");
            }
        }
        println!("after {count} kills: {met:?}");
    }

    #[test]
    fn runs_leave_one_runs_results_or_none_that_anybody_takes() {
        kills(20);
    }

    #[test]
    #[ignore = "a longer look at the same"]
    fn a_hundred_runs_leave_one_runs_results_or_none_that_anybody_takes() {
        kills(100);
    }

    /// A run that takes a while, once it holds its folder.
    fn long(bench: &Bench) -> Child {
        bench.replace(RUN, "generations = 0", "generations = 2000");
        bench.replace(RUN, "population = 16", "population = 2000");
        let child = place(bench, "1").spawn().unwrap();
        let begun = Instant::now();
        while !bench.path("out/.stead.lock").exists() {
            assert!(begun.elapsed() < Duration::from_secs(30), "it does not begin");
            std::thread::sleep(Duration::from_millis(5));
        }
        child
    }

    #[test]
    fn a_second_run_in_a_folder_is_refused_until_the_first_has_gone() {
        let bench = quick();
        bench.write("configs/other.toml", &bench.read(RUN));
        let mut child = long(&bench);
        let ended = bench.stead(&["place", "configs/other.toml", "--out", "out"]);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(1), ""), "{}", ended.stderr);
        let process = format!("another run of stead (process {}) writes to this folder", child.id());
        ended.assert_says(&["out: results cannot be written here: ", &process]);
        ended.assert_says(&["; allowed: another folder, or wait until the other run has ended\n"]);
        assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
        child.kill().unwrap();
        child.wait().unwrap();
        assert_eq!(bench.stead(&["place", "configs/other.toml", "--out", "out"]).code, Some(0));
        assert!(!bench.path("out/.stead.lock").exists());
    }

    /// A limit on the size of files stands for the end of the disk: what was there stays, whole.
    #[cfg(unix)]
    #[test]
    fn a_disk_that_fills_up_leaves_what_was_there() {
        let bench = quick();
        let run = |limit: &str| {
            // 512-byte blocks; the signal that comes with the limit is passed over.
            let script = format!("trap '' XFSZ; ulimit -f {limit}; exec \"$0\" \"$@\"");
            let stead = bench.command(&[]).get_program().to_owned();
            let mut command = Command::new("sh");
            command.current_dir(bench.path("")).arg("-c").arg(script).arg(stead);
            Ended::from(command.args(["place", RUN, "--out", "out", "--seed", "2"]).output().unwrap())
        };
        assert_eq!(bench.stead(&["place", RUN, "--out", "out"]).code, Some(0));
        let before = bench.tree("out");
        for limit in ["2", "8", "16"] {
            let ended = run(limit);
            assert_eq!(ended.code, Some(1), "{}", ended.stderr);
            ended.assert_says(&["error: out/", ": cannot be written: "]);
            assert!(ended.stdout.starts_with("best "), "{}", ended.stdout);
            assert_eq!(bench.tree("out"), before);
        }
        assert_eq!(run("unlimited").code, Some(0));
        assert_ne!(bench.tree("out"), before);
    }
}
