//! What a study says, from outside.

use crate::study::{STUDY, bench, run};

#[test]
fn a_study_of_arms_with_borrowed_stiffness_does_not_rank_their_stiffness() {
    let bench = bench();
    let robot = "configs/robots/kuka-kr270-2.toml";
    let text = bench.read(robot);
    bench.write(robot, &format!("stiffness_like = \"KUKA KR500\"\n{text}"));
    run(&bench, "out", &[]);
    let ended = bench.stead(&["study", "report", STUDY, "--out", "out"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    for text in [ended.stdout, bench.read("out/study-report.json"), bench.read("out/report.html")] {
        for part in ["borrowed stiffness: KUKA KR270-2 (stiffness of KUKA KR500)", "does not say how stiff the arm is"]
        {
            assert!(text.contains(part), "{part} in {text}");
        }
    }
    bench.replace(robot, "stiffness_like = \"KUKA KR500\"", "stiffness_like = ' '");
    let wrong = bench.stead(&["check", crate::common::RUN]);
    assert_eq!(wrong.code, Some(2));
    wrong.assert_says(&["stiffness_like: is blank", "; allowed: "]);
}

#[test]
fn a_study_that_is_done_is_ranked_and_drawn() {
    let bench = bench();
    run(&bench, "out", &["--shard", "1/2"]);
    let ended = bench.stead(&["study", "report", STUDY, "--out", "out"]);
    assert_eq!(ended.code, Some(2));
    ended.assert_says(&["out: only 3 of 6 cases of the study are done; allowed: the folder of a study that is done"]);
    assert!(!bench.path("out/study-ranking.csv").exists());

    run(&bench, "out", &["--shard", "2/2"]);
    // As where the last shards have ended elsewhere.
    std::fs::remove_file(bench.path("out/study.csv")).unwrap();
    let by = ["study", "report", STUDY, "--out", "out", "--by", "best_mean_total_mm"];
    let ended = bench.stead(&by);
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""));
    for part in [
        "study: 6 cases, 6 placed\n",
        "By best_mean_total_mm (smaller is better; within 0.2 % layouts tie",
        "What matters most for best_mean_total_mm is robot.joints[1].stiffness_mnm_per_rad: ",
        "On the front of best_mean_total_mm (smaller is better) and cycle_s (smaller is better): ",
        "results in out\n",
    ] {
        assert!(ended.stdout.contains(part), "{part} is not in {}", ended.stdout);
    }
    let csv = bench.read("out/study-ranking.csv");
    let lines: Vec<&str> = csv.lines().collect();
    let header = "rank,cases,robot.joints[1].stiffness_mnm_per_rad,cell.z_mm,best_mean_total_mm,behind_best_percent,status,reason";
    assert_eq!((lines.len(), lines[0]), (7, header));
    assert!(lines[1].starts_with("1,") && lines[1].contains(",6,") && lines[1].ends_with(",0,placed,"), "{}", lines[1]);
    for name in ["study.csv", "study-front.csv", "study-effects.csv"] {
        assert!(bench.read(&format!("out/{name}")).lines().count() > 1, "{name}");
    }
    for name in ["study-front.svg", "study-effects.svg", "study-map.svg"] {
        assert!(bench.read(&format!("out/{name}")).starts_with("<svg "), "{name}");
    }
    let before = bench.read("out/study-report.json");
    let json = bench.stead(&[&by[..], &["--json"]].concat()).stdout;
    assert_eq!(json, before);
    assert!(bench.read("out/manifest.json").contains("\"study report\""));

    let ended = bench.stead(&[
        "study",
        "report",
        STUDY,
        "--out",
        "out",
        "--by",
        "max_feed_mm_per_s:max",
        "--noise-percent",
        "0",
    ]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.contains("By max_feed_mm_per_s (larger is better; within 0.0 %"), "{}", ended.stdout);

    for (arguments, part) in [
        (["--by", "cicle_s"], "\"cicle_s\" is no column of study.csv (nearest one: cycle_s); allowed: "),
        (["--by", "active_bounds"], "\"active_bounds\" holds no numbers; allowed: "),
        (["--by", "certificate_best_mm"], "\"certificate_best_mm\" has no value in any case; allowed: "),
        (["--front", "cycle_s"], "\"cycle_s\": is no list of two to six columns; allowed: "),
        (["--map", "cell.z_mm"], "--map cell.z_mm: is no pair of axes; allowed: "),
        (["--map", "cell.z,robot.joints[1].stiffness_mnm_per_rad"], "(nearest one: cell.z_mm); allowed: "),
        (["--noise-percent", "100"], "allowed: a number from 0 to below 100"),
    ] {
        let ended = bench.stead(&[&["study", "report", STUDY, "--out", "out"], &arguments[..]].concat());
        assert_eq!(ended.code, Some(2), "{arguments:?}");
        assert!(ended.stderr.contains(part), "{part} is not in {}", ended.stderr);
    }
    // What is refused leaves the last report.
    assert!(bench.read("out/study-report.json").contains("\"max_feed_mm_per_s\""));
}

/// The tables are vouched for, and a report is one of the table beside it.
#[test]
fn tables_cut_short_or_mixed_are_refused_and_written_anew() {
    let bench = bench();
    run(&bench, "out", &[]);
    let report = || bench.stead(&["study", "report", STUDY, "--out", "out", "--json"]);
    let ended = report();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let inputs = ended.json()["inputs"].clone();
    let table = inputs.as_array().unwrap().iter().find(|input| input["role"] == "table").unwrap().clone();
    assert!(bench.read("out/manifest.json").contains(table["sha256"].as_str().unwrap()));

    let path = bench.path("out/study.csv");
    let whole = std::fs::read(&path).unwrap();
    let mut changed = whole.clone();
    *changed.last_mut().unwrap() ^= 1;
    for other in [&whole[..whole.len() / 2], &changed] {
        std::fs::write(&path, other).unwrap();
        let ended = report();
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
        assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
        ended.assert_says(&[
            "out/study.csv: is not the file that `stead study run` has written, by the manifest.json beside it",
            "run `stead study run` again",
        ]);
        run(&bench, "out", &[]);
        assert_eq!(std::fs::read(&path).unwrap(), whole);
        assert_eq!(report().code, Some(0));
    }

    // Of another table there is no report, and its files go; the user's own stay.
    bench.write("out/mine.csv", "1\n");
    run(&bench, "out", &[]);
    assert!(bench.path("out/study-report.json").exists());
    bench.replace(STUDY, "[0.2, 0.8, 6.0]", "[0.2, 0.8]");
    run(&bench, "out", &[]);
    let left: Vec<String> = bench.names("out").into_iter().filter(|name| !name.starts_with("shards")).collect();
    assert_eq!(left, ["manifest.json", "mine.csv", "study-timing.csv", "study.csv", "study.json", "study.lock"]);
    assert!(!bench.read("out/manifest.json").contains("study report"));
}

#[test]
fn the_status_is_one_document_too() {
    let bench = bench();
    let status = || bench.stead(&["study", "status", STUDY, "--out", "out", "--json"]).json();
    assert_eq!(
        (&status()["planned"], &status()["done"], &status()["shards"]),
        (&6.into(), &0.into(), &serde_json::json!([]))
    );
    run(&bench, "out", &["--shard", "2/2"]);
    let found = status();
    assert_eq!((&found["done"], &found["study"]), (&3.into(), &"study".into()));
    let shards = found["shards"].as_array().unwrap();
    assert_eq!((&shards[0]["shard"], &shards[0]["done"]), (&"1/2".into(), &0.into()));
    assert_eq!((&shards[1]["done"], &shards[1]["running"]), (&3.into(), &false.into()));
}
