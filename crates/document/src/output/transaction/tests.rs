use super::super::Folder;
use super::*;
use std::collections::BTreeMap;
use stead_disk::manifest::{Unlisted, check};

type Files<'a> = [(&'a str, Vec<u8>)];
type Content = BTreeMap<String, Vec<u8>>;

fn files<'a>(run: u8, names: &[&'a str]) -> Vec<(&'a str, Vec<u8>)> {
    names.iter().map(|name| (*name, format!("{name} of run {run}").into_bytes())).collect()
}

/// Everything in a folder but its lock.
fn content(folder: &Path) -> Content {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    entries
        .filter(|path| !path.ends_with(".stead.lock"))
        .map(|path| (name(&path), std::fs::read(path).unwrap()))
        .collect()
}

fn is_refused(folder: &Path, name: &str) -> bool {
    let file = folder.join(name);
    check(&file, &std::fs::read(&file).unwrap(), Unlisted::Refused).is_err()
}

fn manifest(folder: &Path) -> Manifest {
    manifest_in(folder).unwrap()
}

/// Does the first steps of a run and then what a kill does: leaves the rest under temporary names. Returns whether
/// steps were left.
fn killed_after(count: usize, folder: &Folder, run: &Files<'_>) -> bool {
    let transaction = folder.results("place", &[]);
    let mut steps = transaction.steps(run).unwrap();
    let rest = steps.split_off(count.min(steps.len()));
    steps.into_iter().for_each(|step| transaction.take(step).unwrap());
    let is_cut_short = !rest.is_empty();
    for step in rest {
        if let Step::Put(staged, _) = step {
            staged.abandon().unwrap();
        }
    }
    is_cut_short
}

/// What a folder holds after an undisturbed run.
fn undisturbed(run: &Files<'_>) -> Content {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::create(place.path()).unwrap();
    folder.results("place", &[]).write(run).unwrap();
    content(place.path())
}

#[test]
fn a_run_killed_at_any_step_is_refused_or_leaves_one_run_and_the_next_clears_up() {
    let one = files(1, &["best.csv", "map.csv", "map.svg", "summary.json"]);
    let two = files(2, &["best.csv", "stability.csv", "summary.json"]);
    let three = files(3, &["best.csv", "summary.json"]);
    let mut refusals = 0;
    for count in 0.. {
        let place = tempfile::tempdir().unwrap();
        std::fs::write(place.path().join("notes.txt"), "the user's own").unwrap();
        let folder = Folder::create(place.path()).unwrap();
        folder.results("place", &[]).write(&one).unwrap();
        let is_cut_short = killed_after(count, &folder, &two);
        drop(folder);
        let found = content(place.path());
        let set = manifest(place.path()).of("place").unwrap().clone();
        if set.complete {
            let run = if found["best.csv"] == one[0].1 { &one } else { &two };
            let whole = undisturbed(run);
            assert!(whole.iter().all(|(name, bytes)| found[name] == *bytes), "after {count} steps");
            assert!(whole.keys().all(|name| name == MANIFEST || !is_refused(place.path(), name)));
        } else {
            refusals += 1;
            for name in found.keys().filter(|name| set.file(name).is_some()) {
                assert!(is_refused(place.path(), name), "{name} after {count} steps");
            }
        }
        // The next run is another one still.
        let folder = Folder::create(place.path()).unwrap();
        folder.results("place", &[]).write(&three).unwrap();
        let mut after = content(place.path());
        assert_eq!(after.remove("notes.txt").unwrap(), b"the user's own");
        assert_eq!(after, undisturbed(&three), "after {count} steps");
        if !is_cut_short {
            break;
        }
    }
    // From the mark to the last file, with what is removed and put on disk.
    assert_eq!(refusals, 1 + 1 + 3 + 2 + 1);
}

#[test]
fn files_that_join_a_run_are_listed_with_it_and_with_no_other() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::create(place.path()).unwrap();
    let names = |folder: &Path| {
        manifest(folder).of("place").unwrap().files.iter().map(|file| file.name.clone()).collect::<Vec<_>>()
    };
    let (one, two) = (files(1, &["best.csv", "summary.json"]), files(2, &["best.csv", "summary.json"]));
    let certificate = files(1, &["certificate.json", "open.svg"]);
    let join = |anchor: &[u8]| {
        folder.results("place", &[]).joining("summary.json", anchor).without(["open.csv"]).write(&certificate)
    };
    folder.results("place", &[]).write(&one).unwrap();
    join(&one[1].1).unwrap();
    let all = ["best.csv", "certificate.json", "open.svg", "summary.json"];
    assert_eq!(names(place.path()), all);
    assert!(all.iter().all(|name| !is_refused(place.path(), name)));
    // Again, with one file less.
    folder
        .results("place", &[])
        .joining("summary.json", &one[1].1)
        .without(["open.svg"])
        .write(&certificate[..1])
        .unwrap();
    assert_eq!(names(place.path()), ["best.csv", "certificate.json", "summary.json"]);
    assert!(!place.path().join("open.svg").exists());

    let before = content(place.path());
    let error = join(&two[1].1).unwrap_err();
    assert!(matches!(error, ReportError::OtherRun { .. }), "{error}");
    assert_eq!(content(place.path()), before);
    // Another run takes them away.
    folder.results("place", &[]).write(&two).unwrap();
    assert_eq!(content(place.path()), undisturbed(&two));
}

#[test]
fn commands_share_a_folder_and_leave_each_others_files_alone() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::create(place.path()).unwrap();
    folder.results("identify plan", &[]).with_form("sheet.csv").write(&files(1, &["plan.json", "sheet.csv"])).unwrap();
    std::fs::write(place.path().join("sheet.csv"), "filled in").unwrap();
    folder.results("identify fit", &[]).write(&files(1, &["report.json"])).unwrap();
    for name in ["plan.json", "report.json", "sheet.csv"] {
        assert!(!is_refused(place.path(), name), "{name}");
    }
    // A form stays whatever comes after it.
    folder.results("identify plan", &[]).write(&files(2, &["plan.json"])).unwrap();
    assert_eq!(std::fs::read(place.path().join("sheet.csv")).unwrap(), b"filled in");
}

#[test]
fn the_manifest_states_inputs_sizes_and_digests() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::create(place.path()).unwrap();
    let input = stead_disk::input::input_file("config", "run.toml", b"abc");
    folder.results("place", std::slice::from_ref(&input)).write(&[("x.csv", b"abc".to_vec())]).unwrap();
    let document: serde_json::Value = serde_json::from_slice(&content(place.path())[MANIFEST]).unwrap();
    let set = &document["results"][0];
    assert_eq!((&document["format"], &set["command"], &set["complete"]), (&1.into(), &"place".into(), &true.into()));
    let file = serde_json::json!({ "name": "x.csv", "bytes": 3, "sha256": input.sha256 });
    assert_eq!(set["files"], serde_json::json!([file]));
    assert_eq!(set["inputs"], serde_json::json!([{ "role": "config", "name": "run.toml", "sha256": input.sha256 }]));
}
