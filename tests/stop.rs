//! Ctrl-C on long paths, what is left out then, results without maps, and `stead score` on the placement of a result.

use crate::common::{Bench, Ended, RUN};
use crate::place::{FILES, Rows};
use serde_json::Value;
use std::fmt::Write;

const MAPS: [&str; 4] =
    ["deflection-map-best.csv", "deflection-map-best.svg", "deflection-map-worst.csv", "deflection-map-worst.svg"];

/// What a score leaves, its map apart.
const SCORE_FILES: [&str; 10] = [
    "best-plan.csv",
    "cell.glb",
    "manifest.json",
    "notes.txt",
    "page-data.json",
    "placement.svg",
    "report.html",
    "score.json",
    "setup.svg",
    "worst-plan.csv",
];

/// What a placement leaves, maps apart.
fn files_without_maps() -> Vec<&'static str> {
    FILES.into_iter().filter(|file| !MAPS.contains(file)).collect()
}

fn json_in(bench: &Bench, file: &str) -> Value {
    serde_json::from_str(&bench.read(file)).unwrap()
}

/// A small cell that every candidate is feasible in, and a search so small that it takes a second.
fn small() -> Bench {
    let bench = Bench::new();
    bench.replace(RUN, "x_mm = [-300.0, 300.0]", "x_mm = [0.0, 10.0]");
    bench.replace(RUN, "y_mm = [-2240.0, -1640.0]", "y_mm = [-1645.0, -1640.0]");
    bench.replace(RUN, "z_mm = [-602.0, -214.0]", "z_mm = [-220.0, -214.0]");
    bench.replace(RUN, "q4 = [-1.0, 1.0]", "q4 = [0.62, 0.65]");
    bench.replace(RUN, "generations = 3\nbasins = 2", "generations = 1\nbasins = 1");
    bench
}

/// Rows of a raster, one segment each, as a task.
fn raster(rows: usize, points: usize) -> String {
    let mut text =
        "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,force_x_n,force_y_n,force_z_n\n".to_owned();
    for row in 0..rows {
        for point in 0..points {
            let (x, y) = (point as f64 * 2.0, row as f64 * 4.0);
            writeln!(text, "{},{x},{y},0,1,0,0,0,0,1,-150,280,50", row + 1).unwrap();
        }
    }
    text
}

#[test]
fn without_maps_the_rest_is_as_before_and_maps_of_an_earlier_run_go() {
    let bench = small();
    assert_eq!(bench.stead(&["place", RUN, "--out", "out"]).code, Some(0));
    let before = bench.tree("out");
    let text = bench.read(RUN);
    bench.write(RUN, &format!("{text}\n[output]\nmaps = false\n"));
    let ended = bench.stead(&["place", RUN, "--out", "out"]);
    assert_eq!((ended.code, ended.said().as_str()), (Some(0), ""));
    assert_eq!(bench.names("out"), files_without_maps());
    for (name, bytes) in bench.tree("out") {
        // These state the run file's digest, or have the maps in them.
        let differs = ["manifest.json", "page-data.json", "report.html", "setup.svg", "summary.json"];
        assert!(differs.contains(&name.as_str()) || bytes == before[&name], "{name}");
    }
    assert!(MAPS.iter().all(|map| before.contains_key(*map)));

    let ended = bench.stead(&["score", RUN, "--placement-of", "out", "--out", "scored"]);
    assert_eq!((ended.code, ended.said().as_str()), (Some(0), ""));
    assert_eq!(bench.names("scored"), SCORE_FILES);
}

#[test]
fn the_exact_placement_of_a_result_is_scored_and_written() {
    let bench = small();
    let placed = bench.stead(&["place", RUN, "--out", "out", "--json"]);
    assert_eq!(placed.code, Some(0), "{}", placed.stderr);
    let with = |more: &[&str]| bench.stead(&[&["score", RUN, "--placement-of", "out", "--json"], more].concat());
    for (case, more) in [(0, &[][..]), (0, &["--case", "1"]), (2, &["--case", "3"])] {
        let scored = with(more);
        assert!(scored.said().is_empty(), "{}", scored.stderr);
        assert_eq!(scored.code, Some(0));
        let (scored, case) = (scored.json(), &placed.json()["cases"][case]);
        assert_eq!((&scored["placement_exact"], &scored["interrupted"]), (&case["placement_exact"], &false.into()));
    }
    let scored = with(&["--out", "scored"]);
    let files = [
        "best-plan.csv",
        "cell.glb",
        "deflection-map.csv",
        "deflection-map.svg",
        "manifest.json",
        "notes.txt",
        "page-data.json",
        "placement.svg",
        "report.html",
        "score.json",
        "setup.svg",
        "worst-plan.csv",
    ];
    assert_eq!(bench.names("scored"), files);
    assert_eq!(json_in(&bench, "scored/score.json"), scored.json());
    let header = |file: &str| bench.read(file).lines().next().unwrap().to_owned();
    assert_eq!(header("scored/best-plan.csv"), header("out/best.csv"));
    assert_eq!(header("scored/deflection-map.csv"), header("out/deflection-map-best.csv"));
    assert!(bench.read("scored/placement.svg").contains("This placement: mean "));
    assert!(bench.read("scored/deflection-map.svg").contains("Deflection at this placement"));
}

#[test]
fn a_folder_that_is_no_result_of_this_problem_is_refused() {
    let bench = small();
    assert_eq!(bench.stead(&["place", RUN, "--out", "out"]).code, Some(0));
    let refused = |arguments: &[&str], parts: &[&str]| {
        let ended = bench.stead(&[&["score", RUN, "--out", "scored"], arguments].concat());
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
        ended.assert_says(parts);
        assert!(!bench.path("scored").exists());
    };
    refused(&["--placement-of", "nowhere"], &["nowhere/summary.json: cannot be read", "; allowed: a folder that"]);
    bench.write("other/summary.json", "{\"robots\": []}");
    refused(&["--placement-of", "other"], &["other/summary.json: cases: is missing"]);
    refused(&["--placement-of", "out", "--case", "2"], &["--case", "allowed: 1 or 3"]);
    refused(&["--placement-of", "out", "--x-mm", "0"], &["--placement-of", "--x-mm"]);
    refused(&["--case", "1", "--x-mm", "0"], &["--placement-of"]);
    refused(&["--x-mm", "0", "--y-mm", "0", "--z-mm", "0"], &["--q4"]);
    let task = bench.read("tasks/five-segments.csv");
    bench.write("tasks/five-segments.csv", &task.replacen("1,", "1, ", 1));
    refused(
        &["--placement-of", "out"],
        &["out/summary.json: inputs: comes from another task file than ", "found sha256"],
    );
}

#[cfg(unix)]
mod interrupt {
    use super::*;
    use std::process::{Child, Command, Stdio};
    use std::time::{Duration, Instant};

    /// Starts a command and waits until it has made its folder, which it does before anything that takes long.
    fn started(bench: &Bench, arguments: &[&str]) -> Child {
        let mut command = bench.command(arguments);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let begun = Instant::now();
        while !bench.path("out").is_dir() {
            assert!(begun.elapsed() < Duration::from_secs(30), "it does not begin");
            std::thread::sleep(Duration::from_millis(20));
        }
        child
    }

    /// Starts a search that would take hours.
    fn search(bench: &Bench, population: usize) -> Child {
        bench.replace(RUN, "population = 16", &format!("population = {population}"));
        bench.replace(RUN, "generations = 3", "generations = 2000");
        started(bench, &["place", RUN, "--out", "out", "--threads", "2", "--json"])
    }

    fn interrupt(child: &Child) {
        assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    }

    /// Waits until a process has worked for so long, or has ended. What a clock shows says nothing on a machine that
    /// does other things.
    fn wait_for_work(child: &Child, work: Duration) {
        let begun = Instant::now();
        while begun.elapsed() < Duration::from_secs(120) {
            std::thread::sleep(Duration::from_millis(10));
            match worked(child) {
                Some(done) if done >= work => return,
                None if begun.elapsed() >= work => return,
                _ => {}
            }
        }
        panic!("it does not work");
    }

    /// Processor time of a process, of all its threads, where the system tells it: user and system time in hundredths
    /// of a second are the 14th and the 15th field of its state; its name, the second, is between brackets. A process
    /// that has ended has done all.
    fn worked(child: &Child) -> Option<Duration> {
        let state = std::fs::read_to_string(format!("/proc/{}/stat", child.id())).ok()?;
        let fields: Vec<&str> = state.rsplit_once(')')?.1.split_whitespace().collect();
        if fields[0] == "Z" {
            return Some(Duration::MAX);
        }
        let ticks: u64 = fields[11].parse::<u64>().ok()? + fields[12].parse::<u64>().ok()?;
        Some(Duration::from_millis(10 * ticks))
    }

    /// Interrupts a command once, when it has worked for some time.
    fn interrupted(child: Child, after: Duration) -> Ended {
        wait_for_work(&child, after);
        interrupt(&child);
        Ended::from(child.wait_with_output().unwrap())
    }

    #[test]
    fn a_job_without_a_partial_result_leaves_earlier_results_alone() {
        let bench = Bench::new();
        bench.copy_all(&["configs/umons-aluminium.toml", "configs/robots/staubli-tx200.toml"]);
        let pass = "configs/umons-aluminium.toml";
        bench.replace(pass, "window_s = [0.4, 1.4]", "steps_per_turn = 3600\nslices = 256\nwindow_s = [0.3, 0.4]");
        bench.write_result("simulate", "out/wall.csv", "an earlier result\n");
        let arguments = ["simulate", pass, "--out", "out", "--json"];
        let ended = interrupted(started(&bench, &arguments), Duration::from_millis(800));
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(130), ""), "{}", ended.stderr);
        assert_eq!(ended.said(), format!("{STOPPED}error: stopped before it was done\n"));
        assert_eq!(bench.names("out"), ["manifest.json", "wall.csv"]);
    }

    const STOPPED: &str = "interrupted: ending with what there is; Ctrl-C again ends at once\n";

    #[test]
    fn once_leaves_the_best_so_far_and_says_so() {
        let bench = Bench::new();
        let ended = interrupted(search(&bench, 200), Duration::from_millis(1500));
        assert_eq!(ended.code, Some(130), "{}", ended.stderr);
        let warnings = "warning: interrupted: the results are the best found so far, not the end of the search\n\
                        warning: interrupted: the tolerances of the setup sheet are left out\n";
        assert_eq!(ended.said(), format!("{STOPPED}{warnings}"));
        assert_eq!(bench.names("out"), FILES);
        let document = ended.json();
        assert_eq!(document["interrupted"], true);
        assert_eq!(json_in(&bench, "out/summary.json")["interrupted"], true);
        for case in document["cases"].as_array().unwrap() {
            assert_eq!(case["plan"].as_array().unwrap().len(), 105);
        }
        let mean = Rows::of(&bench.read("out/placements.csv")).column("mean_mm");
        assert!(mean[0] <= mean[1] && mean[2] <= mean[3] && mean[0] <= mean[2], "{mean:?}");
    }

    #[test]
    fn finished_results_are_not_replaced_by_those_of_an_interrupted_run() {
        let bench = small();
        assert_eq!(bench.stead(&["place", RUN, "--out", "out"]).code, Some(0));
        let finished = bench.tree("out");
        bench.replace(RUN, "population = 16", "population = 200");
        bench.replace(RUN, "generations = 1\n", "generations = 2000\n");
        let again = |more: &[&str]| {
            let arguments = [&["place", RUN, "--out", "out", "--threads", "2"], more].concat();
            interrupted(started(&bench, &arguments), Duration::from_millis(1500))
        };
        let ended = again(&[]);
        assert_eq!(ended.code, Some(130), "{}", ended.stderr);
        ended.assert_says(&[
            "note: out has finished results and is left as it is; those of this run are in out.interrupted",
        ]);
        assert!(ended.stdout.starts_with("INTERRUPTED "), "{}", ended.stdout);
        assert!(
            ended.stdout.contains(" out.interrupted/notes.txt") && !ended.stdout.contains("next "),
            "{}",
            ended.stdout
        );
        assert_eq!(bench.tree("out"), finished);
        assert_eq!(json_in(&bench, "out.interrupted/summary.json")["interrupted"], true);
        assert_eq!(json_in(&bench, "out.interrupted/manifest.json")["results"][0]["interrupted"], true);

        // Whoever goes on from them is told.
        let said =
            "is from a run of `stead place` that was interrupted: the best found by then, not the end of the search";
        let scored = bench.stead(&["score", RUN, "--placement-of", "out.interrupted", "--json"]);
        assert_eq!(scored.code, Some(0), "{}", scored.stderr);
        scored.assert_says(&["note: out.interrupted/summary.json ", said]);
        assert!(scored.json()["notes"].to_string().contains(said));
        let program = ["export", RUN, "out.interrupted/best.csv", "--format", "csv", "--out", "p/PART"];
        let exported = bench.stead(&program);
        assert_eq!(exported.code, Some(0), "{}", exported.stderr);
        exported.assert_says(&["note: out.interrupted/best.csv ", said]);
        let header = "; INTERRUPTED search: the best plan found by then\n";
        for (plan, is_said) in [("out.interrupted/best.csv", true), ("out/best.csv", false)] {
            let program = format!("p{}/PART", u8::from(is_said));
            let exported = bench.stead(&["export", RUN, plan, "--format", "krl", "--out", &program]);
            assert_eq!(exported.code, Some(0), "{}", exported.stderr);
            assert_eq!(bench.read(&format!("{program}.src")).contains(header), is_said);
        }

        // A second one takes the place of the first, and with --keep-partial that of the finished ones.
        assert_eq!(again(&[]).code, Some(130));
        assert_eq!(bench.tree("out"), finished);
        let ended = again(&["--keep-partial"]);
        assert!(ended.code == Some(130) && ended.stdout.contains(" out/notes.txt"), "{}", ended.stdout);
        assert_eq!(json_in(&bench, "out/summary.json")["interrupted"], true);
        // Results of an interrupted run are not finished ones.
        assert!(again(&[]).stdout.contains(" out/notes.txt"));
    }

    #[test]
    fn a_finished_certificate_is_not_replaced_by_an_interrupted_one() {
        let bench = small();
        let ended = bench.stead(&["place", RUN, "--out", "out", "--certify", "50"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let finished = bench.tree("out");
        assert!(finished.contains_key("certificate.json"));
        // A gap that is not reached in the time of a test.
        let again = |more: &[&str]| {
            let arguments = [&["place", RUN, "--out", "out", "--threads", "2", "--certify", "0.0001"], more].concat();
            interrupted(started(&bench, &arguments), Duration::from_millis(4000))
        };
        let ended = again(&[]);
        assert_eq!(ended.code, Some(130), "{} {}", ended.stdout, ended.stderr);
        ended.assert_says(&[
            "note: out has finished results with a certificate; they are replaced when that of this run is done",
            "note: out has finished results and is left as it is; those of this run are in out.interrupted",
        ]);
        assert!(ended.stdout.contains("results in out.interrupted\n"), "{}", ended.stdout);
        assert!(bench.tree("out") == finished, "{:?}", bench.names("out"));
        let certificate = json_in(&bench, "out.interrupted/certificate.json");
        assert_ne!(certificate["best"]["status"], "reached", "{certificate:#}");

        again(&["--keep-partial"]);
        assert_eq!(json_in(&bench, "out/certificate.json")["gap_percent_asked"], 0.0001);
        // One that comes to its end takes the place of the earlier one.
        assert_eq!(bench.stead(&["place", RUN, "--out", "out", "--certify", "40"]).code, Some(0));
        assert_eq!(json_in(&bench, "out/certificate.json")["gap_percent_asked"], 40.0);
    }

    #[test]
    fn once_with_nothing_found_says_so_too() {
        let bench = Bench::new();
        bench.replace(RUN, "y_mm = [-2240.0, -1640.0]", "y_mm = [-9240.0, -8640.0]");
        let ended = interrupted(search(&bench, 2000), Duration::from_millis(300));
        assert_eq!((ended.code, ended.json()["feasible"].as_bool()), (Some(130), Some(false)), "{}", ended.stderr);
        assert_eq!(ended.json()["interrupted"], true);
        ended.assert_says(&["interrupted: ", "error: no feasible placement was found", "segment 1, points 0 to 20"]);
    }

    #[test]
    fn twice_ends_at_once_and_leaves_earlier_results_alone() {
        let bench = Bench::new();
        bench.write_result("place", "out/best.csv", "an earlier result\n");
        let child = search(&bench, 100_000);
        wait_for_work(&child, Duration::from_millis(500));
        interrupt(&child);
        // So soon that the two plans that are still made are not there yet.
        std::thread::sleep(Duration::from_millis(20));
        interrupt(&child);
        let begun = Instant::now();
        let ended = Ended::from(child.wait_with_output().unwrap());
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(130), ""), "{}", ended.stderr);
        assert!(begun.elapsed() < Duration::from_secs(5));
        assert_eq!(bench.read("out/best.csv"), "an earlier result\n");
        assert_eq!(bench.names("out"), ["best.csv", "manifest.json"]);
    }
    #[test]
    fn a_long_path_is_placed_with_what_there_is_and_without_maps() {
        for tables in ["auto", "never"] {
            let bench = Bench::new();
            bench.write("tasks/five-segments.csv", &raster(30, 100));
            bench.replace(RUN, "generations = 3", "generations = 2000");
            bench.replace(RUN, "seed = 1", &format!("tables = \"{tables}\"\nseed = 1"));
            let arguments = ["place", RUN, "--out", "out", "--json", "--certify", "1"];
            let ended = interrupted(started(&bench, &arguments), Duration::from_millis(4000));
            assert_eq!(ended.code, Some(130), "{}", ended.stderr);
            assert!(ended.stderr.contains(STOPPED), "{}", ended.stderr);
            ended.assert_says(&["the best found so far", "warning: interrupted: the deflection maps are left out\n"]);
            assert_eq!(
                (&ended.json()["interrupted"], &json_in(&bench, "out/summary.json")["interrupted"]),
                (&true.into(), &true.into())
            );
            assert!(files_without_maps().iter().all(|file| bench.path(&format!("out/{file}")).exists()));
            assert!(!MAPS.iter().any(|file| bench.path(&format!("out/{file}")).exists()));
            for case in ended.json()["cases"].as_array().unwrap() {
                assert_eq!(case["plan"].as_array().unwrap().len(), 3000);
            }
            // Nor is there time for a certificate, which its file says.
            let certificate = json_in(&bench, "out/certificate.json");
            assert_eq!(
                (&certificate["best"], &certificate["best_reason"]),
                (&Value::Null, &"interrupted before it began".into())
            );
        }
    }

    #[test]
    fn a_score_has_both_plans_and_leaves_out_the_map() {
        let bench = Bench::new();
        bench.write("tasks/five-segments.csv", &raster(30, 100));
        bench.replace(RUN, "beta_step_deg = 7.2", "beta_step_deg = 0.25");
        let place = ["--x-mm", "0", "--y-mm", "-1800", "--z-mm", "-400", "--yaw-deg", "0"];
        let arguments = [&["score", RUN, "--out", "out", "--json"], &place[..]].concat();
        let ended = interrupted(started(&bench, &arguments), Duration::from_millis(400));
        assert_eq!(ended.code, Some(130), "{}", ended.stderr);
        let left_out = ["the deflection map is", "the tolerances of the setup sheet are"]
            .map(|what| format!("warning: interrupted: {what} left out\n"));
        assert_eq!(ended.said(), format!("{STOPPED}{}", left_out.concat()));
        let document = ended.json();
        assert_eq!(document["interrupted"], true);
        assert!(document["best"]["mean_mm"].as_f64() < document["worst"]["mean_mm"].as_f64(), "{document:#}");
        assert_eq!(bench.names("out"), SCORE_FILES);
    }
}
