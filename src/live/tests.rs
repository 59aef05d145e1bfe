use super::{LiveOptions, Session};
use crate::{Monitor, Run};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use stead_problem::problem::Placement;
use stead_report::Folder;

/// The published case on a coarser grid and with a search of a second, in a folder of its own.
struct Bench {
    folder: tempfile::TempDir,
    session: Arc<Session>,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let here = std::env::current_dir().unwrap().display().to_string().replace('\\', "/");
        let text = std::fs::read_to_string("configs/caro-2013.toml").unwrap();
        let text = text
            .replace("\"robots/", &format!("\"{here}/configs/robots/"))
            .replace("\"../tasks/", &format!("\"{here}/tasks/"))
            .replace("beta_step_deg = 3.0", "beta_step_deg = 12.0")
            .replace("population = 120\ngenerations = 51", "population = 12\ngenerations = 1\nbasins = 1");
        std::fs::write(folder.path().join("run.toml"), text).unwrap();
        let session = session(folder.path());
        Self { folder, session }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Begins a job and waits for its end.
    fn job(&self, name: &str, more: &Value) -> Value {
        let mut body = place(name, -1640.0);
        body.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        body["job"] = name.into();
        let id = self.session.begin(body.to_string().as_bytes()).unwrap()["id"].clone();
        self.ended(&id)
    }

    fn ended(&self, id: &Value) -> Value {
        let begun = Instant::now();
        loop {
            let jobs = self.session.state()["jobs"].clone();
            if let Some(found) = jobs["ended"].as_array().unwrap().iter().find(|job| job["id"] == *id) {
                return found.clone();
            }
            assert!(begun.elapsed() < Duration::from_secs(300), "{jobs}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.session.close();
    }
}

fn session(folder: &Path) -> Arc<Session> {
    let options = LiveOptions { file: folder.join("run.toml"), ..LiveOptions::default() };
    let out = Folder::create(&folder.join("out")).unwrap();
    let run = Run::read(&options.file).unwrap();
    let session = Arc::new(Session::new(run, options, out, &Monitor::silent()).unwrap());
    session.start().unwrap();
    session
}

fn place(page: &str, y_mm: f64) -> Value {
    json!({ "page": page, "id": 3, "x_mm": 0.03, "y_mm": y_mm, "z_mm": -214.0, "yaw_deg": 79.0 })
}

fn asked(result: Result<Value, super::RequestError>) -> Value {
    result.unwrap()
}

#[test]
fn a_placement_comes_to_what_the_commands_say_of_it() {
    let bench = Bench::new();
    let body = place("a", -1640.0).to_string();
    let preview = asked(bench.session.preview(body.as_bytes()));
    let whole = asked(bench.session.whole(body.as_bytes()));
    let run = Run::read(bench.path("run.toml")).unwrap();
    let placement = Placement::from_mm_deg([0.03, -1640.0, -214.0], 79.0);
    let mut score = run.score(&placement, &Monitor::silent()).unwrap();
    for key in ["best", "worst", "placement_exact", "notes", "warnings", "inputs"] {
        assert_eq!(whole["document"][key], score.to_json()[key], "{key}");
    }
    assert_eq!((&preview["id"], &preview["feasible"], &preview["is_whole"]), (&json!(3), &json!(true), &json!(false)));
    let [coarse, fine] = [&preview, &whole].map(|answer| answer["document"]["best"]["mean_mm"].as_f64().unwrap());
    assert!(fine <= coarse && coarse < 1.5 * fine, "{fine} {coarse}");

    // A placement that is kept is a folder as the command writes it, byte for byte.
    let kept = bench.job("keep", &json!({}));
    assert_eq!(kept["pin"], "placement-1", "{kept}");
    score.map(&Monitor::silent());
    score.make_sheet(&Monitor::silent());
    let mut count = 0;
    for path in score.write(bench.path("scored")).unwrap() {
        let name = path.file_name().unwrap().to_owned();
        let of_session = std::fs::read(bench.path("out/placement-1").join(&name)).unwrap();
        assert!(of_session == std::fs::read(&path).unwrap(), "{name:?}");
        count += 1;
    }
    assert!(count > 8);
    // No other session takes the folder in the meantime.
    let taken = Folder::create(&bench.path("out")).unwrap_err().to_string();
    assert!(taken.contains("another run of stead"), "{taken}");

    // What its folder does not hold cannot be written.
    std::fs::remove_file(bench.path("out/live.json")).unwrap();
    std::fs::create_dir(bench.path("out/live.json")).unwrap();
    let kept = bench.job("keep", &json!({}));
    assert_eq!(kept["pin"], "placement-2", "{kept}");
    let warning = kept["said"][1].as_str().unwrap();
    assert!(warning.starts_with("warning: a later session will not know names and changed values: "), "{warning}");
}

#[test]
fn the_next_session_begins_where_the_last_one_ended() {
    let bench = Bench::new();
    asked(bench.session.whole(place("a", -1700.5).to_string().as_bytes()));
    asked(bench.session.edit(json!({ "edits": ["cell.z_mm=[-500, -214]"] }).to_string().as_bytes()));
    assert_eq!(bench.job("keep", &json!({ "is_labelled": true, "label": "first" }))["pin"], "placement-1");
    let before = bench.session.state();
    bench.session.close();
    let options = LiveOptions { file: bench.path("run.toml"), ..LiveOptions::default() };
    let run = Run::read(&options.file).unwrap();
    // The first session still holds the folder; what it has left is read from a copy.
    let copy = bench.path("copy");
    copy_all(&bench.path("out"), &copy);
    // As of a session that was killed while it kept another one.
    let left = copy.join("placement-1/.stead-a1B2c3.tmp");
    std::fs::write(&left, "left").unwrap();
    let next = Session::new(run, options, Folder::create(&copy).unwrap(), &Monitor::silent()).unwrap();
    assert!(!left.exists());
    assert_eq!(next.state()["pins"], before["pins"]);
    assert_eq!(next.state()["edits"], json!(["cell.z_mm=[-500, -214]"]));
    assert!(next.notes()[0].contains("cell.z_mm=[-500, -214]"));
    assert_eq!(next.run().problem().cell.position[2].min, -0.5);
    assert_eq!(next.known().place.placement.y, -1.7005);
    assert_eq!(before["pins"][0]["label"], "first");
}

#[test]
fn what_is_kept_is_read_with_care_and_numbers_are_not_given_again() {
    let bench = Bench::new();
    assert_eq!(bench.job("keep", &json!({}))["pin"], "placement-1");
    let certified = bench.job("certify", &json!({ "gap_percent": 60 }));
    assert!(certified["said"].to_string().contains("certificate-1.json"), "{certified}");
    let document: Value =
        serde_json::from_slice(&std::fs::read(bench.path("out/certificate-1.json")).unwrap()).unwrap();
    assert_eq!((&document["changed_values"], &document["placement_exact"]["y_mm"]), (&json!([]), &json!(-1640.0)));
    bench.session.close();
    let next = |copy: &Path| {
        let options = LiveOptions { file: bench.path("run.toml"), ..LiveOptions::default() };
        let run = Run::read(&options.file).unwrap();
        Session::new(run, options, Folder::create(copy).unwrap(), &Monitor::silent())
    };
    // What was there has been removed: its number stays taken.
    let copy = bench.path("copy");
    copy_all(&bench.path("out"), &copy);
    std::fs::remove_dir_all(copy.join("placement-1")).unwrap();
    std::fs::remove_file(copy.join("certificate-1.json")).unwrap();
    let session = next(&copy).unwrap();
    assert_eq!((session.state()["pins"].clone(), session.next_number("placement-", "")), (json!([]), 2));
    assert_eq!(session.next_number("certificate-", ".json"), 2);
    drop(session);

    // What somebody has sent changes no file that the run names, and what is no such file is kept aside.
    let sent = bench.path("sent");
    std::fs::create_dir(&sent).unwrap();
    let far = json!({ "placement_exact": { "x_mm": 1e300, "y_mm": 0, "z_mm": 0, "yaw_deg": 0 } });
    let kept = json!({ "edits": ["robot=/etc/passwd", "cell.z_mm=[-500, -214]"], "place": far, "pins": 5 });
    std::fs::write(sent.join("live.json"), kept.to_string()).unwrap();
    let session = next(&sent).unwrap();
    assert_eq!(session.state()["edits"], json!(["cell.z_mm=[-500, -214]"]));
    assert!(session.known().place.placement.x.abs() < 1.0);
    drop(session);
    for (count, nonsense) in [&b"{\"edits\": ["[..], b"[1]", b"\xff\xfe", b""].into_iter().enumerate() {
        std::fs::write(sent.join("live.json"), nonsense).unwrap();
        let session = next(&sent).unwrap();
        let aside = format!("live-unreadable-{}.json", count + 1);
        assert!(session.notes()[0].contains(&aside), "{:?}", session.notes());
        assert_eq!(std::fs::read(sent.join(aside)).unwrap(), nonsense);
    }
}

fn copy_all(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap().map(|entry| entry.unwrap()) {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy_all(&entry.path(), &target);
        } else if !entry.file_name().to_string_lossy().starts_with('.') {
            std::fs::copy(entry.path(), target).unwrap();
        }
    }
}

#[test]
fn the_map_comes_column_by_column_and_is_that_of_the_table() {
    let bench = Bench::new();
    let (mut from, mut codes, mut reasons) = (0, Vec::new(), Vec::new());
    loop {
        let mut body = place("a", -1640.0);
        body["from"] = from.into();
        let answer = asked(bench.session.map(body.to_string().as_bytes()));
        let columns = &answer["columns"];
        let made = columns["points"].as_array().unwrap().len();
        if made == 0 {
            break;
        }
        from += made;
        codes.push(columns["codes"].as_str().unwrap().len());
        reasons.extend(columns["reasons"].as_array().unwrap().iter().map(|one| one.as_str().unwrap().to_owned()));
    }
    assert_eq!(from, 105);
    assert!(codes.iter().all(|length| *length > 0) && !reasons.is_empty());
}

#[test]
fn values_are_changed_with_the_words_of_the_file_and_saved_as_a_new_one() {
    let bench = Bench::new();
    let edit = |edits: Value| bench.session.edit(json!({ "edits": edits }).to_string().as_bytes());
    for (edits, part) in [
        (json!(["cell.x_mm=[3, 1]"]), "cell.x_mm"),
        (json!(["cell.x_mm=[nan, 1]"]), "cell.x_mm"),
        (json!(["criterion.direction=sideways"]), "criterion.direction"),
        (json!(["criterion.force_uncertainty=-1"]), "criterion.force_uncertainty"),
        (json!(["cell.yaw_deg=[0, 1]"]), "states the yaw once more"),
        (json!(["robot=other.toml"]), "robot is not changed here"),
        (json!(["cell.x_mm"]), "has no '='"),
        (json!("cell"), "edits: is no list of texts"),
    ] {
        let message = edit(edits).unwrap_err().to_string();
        assert!(message.contains(part), "{part} in {message}");
    }
    assert_eq!(bench.session.state()["version"], 1);
    let before = asked(bench.session.preview(place("a", -1640.0).to_string().as_bytes()));
    asked(edit(json!(["criterion.direction=total", "criterion.force_uncertainty=0.1"])));
    let after = asked(bench.session.preview(place("a", -1640.0).to_string().as_bytes()));
    assert_eq!((&before["version"], &after["version"]), (&json!(1), &json!(2)));
    assert!(after["document"]["best"]["mean_mm"].as_f64() > before["document"]["best"]["mean_mm"].as_f64());

    let save = |name: &str, is_placement: bool| {
        let mut body = place("a", -1640.0);
        body["name"] = name.into();
        body["is_placement"] = is_placement.into();
        bench.session.save(body.to_string().as_bytes())
    };
    for (name, part) in
        [("run.toml", "is there already"), ("../up.toml", "without folders"), (".toml", "no name"), ("", "name")]
    {
        let message = save(name, false).unwrap_err().to_string();
        assert!(message.contains(part), "{part} in {message}");
    }
    asked(save("new", false));
    let saved = Run::read(bench.path("new.toml")).unwrap();
    assert_eq!(saved.problem().criterion, bench.session.run().problem().criterion);
    assert_eq!(saved.problem().cell, bench.session.run().problem().cell);
    asked(save("alone.toml", true));
    let alone = Run::read(bench.path("alone.toml")).unwrap();
    let pinned = alone.problem().cell.pinned().unwrap();
    assert!((pinned.y + 1.64).abs() < 1e-12 && (pinned.yaw.to_degrees() - 79.0).abs() < 1e-9, "{pinned:?}");
    assert!(
        std::fs::read_to_string(bench.path("alone.toml")).unwrap().contains("# an assumption"),
        "remarks of the file are kept"
    );
}

#[test]
fn jobs_run_one_at_a_time_stop_with_what_they_have_and_keep_it() {
    let bench = Bench::new();
    asked(bench.session.edit(json!({ "edits": ["cell.x_mm=[-300, 300]"] }).to_string().as_bytes()));
    let mut body = place("a", -1800.0);
    body["job"] = "search_cell".into();
    let id = asked(bench.session.begin(body.to_string().as_bytes()))["id"].clone();
    let refused = bench.session.begin(body.to_string().as_bytes()).unwrap_err().to_string();
    assert!(refused.contains("`search the cell` is running"), "{refused}");
    // Placements are answered in the meantime.
    assert_eq!(asked(bench.session.preview(place("a", -1640.0).to_string().as_bytes()))["feasible"], true);
    bench.session.stop();
    let ended = bench.ended(&id);
    assert!(ended["was_stopped"] == true && ended["pin"] == "placement-1", "{ended}");
    assert!(bench.path("out/placement-1/setup.svg").exists());
    for (job, more, part) in [
        ("dance", json!({}), "job: is none, found dance"),
        ("certify", json!({ "gap_percent": 0 }), "gap_percent: is no such gap, found 0 %"),
        ("certify", json!({ "gap_percent": null }), "gap_percent: is no such number"),
        ("set_up", json!({}), "job: is none, found set_up"),
        ("export", json!({ "pin": "placement-9", "format": "krl", "name": "A" }), "pin: is none"),
        (
            "export",
            json!({ "pin": "placement-1", "format": "dxf", "name": "A" }),
            "format: is none, found dxf; allowed: krl",
        ),
    ] {
        let mut body = place("a", -1640.0);
        body.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        body["job"] = job.into();
        let message = bench.session.begin(body.to_string().as_bytes()).unwrap_err().to_string();
        assert!(message.contains(part), "{part} in {message}");
    }
    let exported = bench.job("export", &json!({ "pin": "placement-1", "format": "csv", "name": "PART" }));
    assert!(exported["error"].is_null() && bench.path("out/programs/placement-1/PART.csv").exists(), "{exported}");
    let again = bench.job("export", &json!({ "pin": "placement-1", "format": "csv", "name": "PART" }));
    assert!(again["error"].as_str().unwrap().contains("is there already"), "{again}");
    let here = bench.job("search_here", &json!({}));
    assert_eq!(here["pin"], "placement-2", "{here}");
    let certified = bench.job("certify", &json!({ "gap_percent": 60 }));
    let said = certified["said"][0].as_str().unwrap();
    let begin = "Little is proved, and up to 60 % may be left to gain: no placement in this cell";
    assert!(said.starts_with(begin) && said.contains("Certificate, best placement: "), "{said}");
}

#[test]
fn a_placement_without_a_plan_names_what_is_in_the_way() {
    let bench = Bench::new();
    let body = place("a", -4000.0).to_string();
    for answer in [asked(bench.session.preview(body.as_bytes())), asked(bench.session.whole(body.as_bytes()))] {
        assert_eq!(answer["feasible"], false);
        let reasons = answer["reasons"].to_string();
        assert!(reasons.contains("beyond the stretched arm"), "{reasons}");
        assert!(answer["outside_cell"].as_str().unwrap().contains("outside the cell"));
    }
    let none = bench.job("keep", &json!({ "y_mm": -4000 }));
    assert!(none["error"].as_str().unwrap().contains("nothing is feasible at"), "{none}");
    assert!(!bench.path("out/placement-1").exists());
}
