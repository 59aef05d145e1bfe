//! `stead place --certify` from outside: a short path in a small cell, so that it takes seconds.

use crate::common::{Bench, Ended, RUN};
use serde_json::Value;

/// What a certificate adds to the files of a placement.
const ADDED: [&str; 3] = ["certificate.json", "open-region.csv", "open-region.svg"];
/// The path: two segments at a right angle.
const PATH: &str = "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,force_x_n,force_y_n,force_z_n
1,0,0,0,1,0,0,0,0,1,-150,280,50
1,10,0,0,1,0,0,0,0,1,-150,280,50
1,20,0,0,1,0,0,0,0,1,-150,280,50
2,30,10,0,0,1,0,0,0,1,-280,-150,50
2,30,20,0,0,1,0,0,0,1,-280,-150,50
";

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("tasks/five-segments.csv", PATH);
    bench.replace(RUN, "x_mm = [-300.0, 300.0]", "x_mm = [-60.0, 60.0]");
    bench.replace(RUN, "y_mm = [-2240.0, -1640.0]", "y_mm = [-1720.0, -1640.0]");
    bench.replace(RUN, "z_mm = [-602.0, -214.0]", "z_mm = [-300.0, -250.0]");
    bench
}

fn certificate(bench: &Bench) -> Value {
    serde_json::from_str(&bench.read("out/certificate.json")).unwrap()
}

/// What `--json` prints of it, without the time that it took, which alone differs from run to run.
fn lasting(mut certificate: Value) -> Value {
    assert!(certificate.as_object_mut().unwrap().remove("wall_s").unwrap().as_f64().unwrap() > 0.0);
    certificate
}

fn place(bench: &Bench, more: &[&str]) -> Ended {
    bench.stead(&[&["place", RUN, "--out", "out"], more].concat())
}

/// Value and bound of the best placement in mm.
#[track_caller]
fn assert_holds(certificate: &Value, gap: std::ops::RangeInclusive<f64>) {
    let best = &certificate["best"];
    let number = |key: &str| best[key].as_f64().unwrap_or_else(|| panic!("{key} in {certificate:#}"));
    let (value, bound) = (number("value_mm"), number("bound_mm"));
    assert!(0.0 < value && bound < value, "{value} and {bound}");
    assert!(gap.contains(&number("gap_percent")), "{certificate:#}");
    // The gap is that between the two, to their digits.
    assert!((number("gap_percent") - 100.0 * (1.0 - bound / value)).abs() < 2e-7 * 100.0 / value + 1e-4);
}

#[test]
fn a_certificate_is_stated_and_leaves_the_placement_as_it_is() {
    let bench = bench();
    assert_eq!(place(&bench, &[]).code, Some(0));
    let mut plain = bench.tree("out");
    let ended = place(&bench, &["--certify", "1", "--threads", "2"]);
    assert_eq!((ended.code, ended.said().as_str()), (Some(0), ""));
    let certified = certificate(&bench);
    assert_holds(&certified, 0.0..=1.0);
    assert_eq!(certified["best"]["status"], "reached");
    assert_eq!(certified["gap_percent_asked"], 1.0);
    let relaxed = &certified["best"]["limits_relaxed"];
    assert_eq!(relaxed[1], "limits of joints 1, 4 and 6", "{relaxed}");
    let best = bench.read("out/placements.csv").lines().nth(1).unwrap().to_owned();
    assert!(best.contains(&format!(",{:.7},", certified["best"]["value_mm"].as_f64().unwrap())), "{best}");
    let words = ended.stdout.replace('\n', " ");
    let claim = format!("redundancy plan it is at least {:.7} mm; ", certified["best"]["bound_mm"].as_f64().unwrap());
    let sentence = "has a mean normal deflection more than 1 % below yours.";
    for part in [claim.as_str(), sentence, "Certified up to rounding."] {
        assert!(words.contains(part), "{part} in {words}");
    }

    let mut tree = bench.tree("out");
    for added in ADDED {
        assert!(tree.remove(added).flatten().is_some_and(|bytes| bytes.len() > 50), "{added}");
    }
    tree.remove("open-region-worst.svg");
    // All of them are listed as results of one run.
    let manifest: Value = serde_json::from_slice(&tree.remove("manifest.json").flatten().unwrap()).unwrap();
    assert_eq!((manifest["results"].as_array().unwrap().len(), &manifest["results"][0]["complete"]), (1, &true.into()));
    let listed = manifest["results"][0]["files"].as_array().unwrap();
    let listed: Vec<&str> = listed.iter().map(|file| file["name"].as_str().unwrap()).collect();
    assert!(tree.keys().map(String::as_str).chain(ADDED).all(|name| listed.contains(&name)), "{listed:?}");
    plain.remove("manifest.json");
    // The page has the certificate too.
    for tree in [&mut tree, &mut plain] {
        assert!(tree.remove("report.html").is_some());
    }
    let differing: Vec<&String> = tree.keys().filter(|name| tree.get(*name) != plain.get(*name)).collect();
    assert_eq!((tree.keys().collect::<Vec<_>>(), differing), (plain.keys().collect(), Vec::new()));

    // Once more: every file is the same.
    let before = bench.tree("out");
    assert_eq!(place(&bench, &["--certify", "1", "--threads", "2"]).code, Some(0));
    assert!(before == bench.tree("out"), "two runs differ");

    // From the run file, on one thread, and as JSON: the same.
    let files = ADDED.map(|name| (name, bench.read(&format!("out/{name}"))));
    let text = bench.read(RUN);
    bench.write(RUN, &format!("{text}\n[certificate]\ngap_percent = 1\n"));
    let ended = place(&bench, &["--threads", "1", "--json"]);
    let waits = "note: out has finished results with a certificate; they are replaced when that of this run is done\n";
    assert_eq!((ended.code, ended.said().as_str()), (Some(0), waits));
    let mut again = lasting(ended.json()["certificate"].clone());
    assert_eq!(again, certificate(&bench));
    // The run file is another one.
    again["inputs"] = certified["inputs"].clone();
    assert_eq!(again, certified);
    for (name, before) in &files[1..] {
        assert_eq!(&bench.read(&format!("out/{name}")), before, "{name}");
    }
}

#[test]
fn gaps_that_mean_nothing_are_refused_on_the_command_line() {
    let bench = bench();
    for bad in ["0", "-0.5", "0.00001", "100", "nan", "inf", "much"] {
        let ended = place(&bench, &["--certify", bad]);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{bad}: {}", ended.stderr);
        ended.assert_says(&["--certify", bad, "allowed: a number of per cent from 0.0001"]);
    }
    assert!(!bench.path("out").exists());
}

#[test]
fn gaps_and_limits_of_the_run_file_are_refused_at_their_line() {
    for (table, field, line) in [
        ("gap_percent = 0", "gap_percent", 1),
        ("gap_percent = 1e-5", "gap_percent", 1),
        ("time_limit_s = 5", "gap_percent", 0),
        ("gap_percent = 1\ntime_limit_s = -5", "time_limit_s", 2),
        ("gap = 1", "gap", 1),
    ] {
        let bench = bench();
        let line = line + bench.replace(RUN, "[constraints]", &format!("[certificate]\n{table}\n[constraints]"));
        let ended = place(&bench, &[]);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{table}");
        let place = format!("error: {RUN}:{line}: certificate.{field}: ");
        assert!(ended.stderr.starts_with(&place) && ended.stderr.contains("; allowed: "), "{place}: {}", ended.stderr);
        assert!(!bench.path("out").exists());
    }
}

#[test]
fn tables_beyond_the_memory_do_not_cost_the_placement() {
    let bench = bench();
    bench.replace(RUN, "[constraints]", "[certificate]\ngap_percent = 1\nmemory_gb = 0.001\n[constraints]");
    let ended = place(&bench, &[]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let start = "warning: no certificate: the cell is so large that tables would take ";
    assert!(ended.said().starts_with(start) && ended.said().lines().count() == 1, "{}", ended.stderr);
    ended.assert_says(&["at most 0.001 GB are allowed by certificate.memory_gb; the workpiece is placed without one"]);
    let found = certificate(&bench);
    assert_eq!((&found["best"], &found["memory_gb"]), (&Value::Null, &0.001.into()));
    assert!(found["worst_reason"].as_str().unwrap().contains("at most 0.001 GB"), "{found:#}");
    assert!(bench.path("out/best.csv").exists());
}

#[test]
fn memory_used_up_on_the_way_leaves_the_bound_reached() {
    let bench = bench();
    bench.replace(RUN, "[constraints]", "[certificate]\ngap_percent = 0.001\nmemory_gb = 0.0050\n[constraints]");
    let ended = place(&bench, &["--threads", "2"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&["the 0.00500 GB of certificate.memory_gb are used up: "]);
    let found = certificate(&bench);
    assert_eq!(found["best"]["status"], "memory", "{found:#}");
    assert!(found["best_reason"].as_str().unwrap().starts_with("the 0.00500 GB of certificate.memory_gb"));
    // It is counted, not measured.
    assert_eq!(place(&bench, &["--threads", "1"]).code, Some(0));
    assert_eq!(certificate(&bench), found);
}

#[test]
fn what_cannot_be_certified_is_said_and_placed_all_the_same() {
    let bench = bench();
    bench.write_result("place", "out/open-region.svg", "of an earlier certificate");
    bench.replace(RUN, "[cell]", "[mount]\nxyz_mm = [0.0, 0.0, 0.0]\nrpy_deg = [0.0, 2.0, 0.0]\n\n[cell]");
    let ended = place(&bench, &["--certify", "1"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let reason = "axis 1 of the robot leans 2.000 deg from the vertical";
    assert!(ended.said().starts_with(&format!("warning: no certificate: {reason}")), "{}", ended.stderr);
    assert_eq!(ended.said().lines().count(), 1);
    let found = certificate(&bench);
    assert_eq!((&found["best"], &found["worst"]), (&Value::Null, &Value::Null));
    assert!(found["best_reason"].as_str().unwrap().starts_with(reason));
    assert!(!bench.path("out/open-region.svg").exists() && bench.path("out/best.csv").exists());
    assert!(ended.stdout.contains("No certificate for the best placement: axis 1"), "{}", ended.stdout);
}

/// The criterion that `stead init` writes, with a point to plunge to, moments, and a joint that yields by its angle.
#[test]
fn the_recommended_criterion_is_certified_with_a_plunge_and_moments() {
    let bench = bench();
    let mut task = String::from(
        "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,force_x_n,force_y_n,force_z_n,\
         moment_x_nm,moment_y_nm,moment_z_nm,scored\n1,0,0,20,1,0,0,0,0,1,0,0,0,0,0,0,0\n",
    );
    PATH.lines().skip(1).for_each(|line| task += &format!("{line},2,-3,4,1\n"));
    bench.write("tasks/five-segments.csv", &task);
    bench.replace(RUN, "force_uncertainty = 0.0", "direction = \"total\"\nforce_uncertainty = 0.1");
    bench.replace(RUN, "max_beta_rate_deg_per_mm = 0.9", "max_spindle_turn_deg_per_mm = 0.9");
    let ended = place(&bench, &["--certify", "5"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let found = certificate(&bench);
    assert_holds(&found, 0.0..=5.0);
    assert_eq!((&found["best"]["status"], &found["best"]["with_beta_rate"]), (&"reached".into(), &false.into()));
    let relaxed = found["best"]["limits_relaxed"].to_string();
    assert!(!relaxed.contains("spindle") && relaxed.contains("joints 1, 4 and 6"), "{relaxed}");
    // Bounds from above do not cover it, which is said by itself.
    let reason = found["worst_reason"].as_str().unwrap();
    assert!(reason.starts_with("bounds from above cover the mean of one part"), "{reason}");
    ended.assert_says(&["no certificate for the worst placement: bounds from above cover"]);
    let words = ended.stdout.replace('\n', " ");
    let claim = "has a mean total deflection (of the points that are scored; force errors of 10 % covered) more than 5 % below yours.";
    assert!(words.contains(claim), "{words}");
}

#[test]
fn a_time_limit_leaves_what_is_reached_and_says_so() {
    let bench = bench();
    bench.replace(RUN, "[constraints]", "[certificate]\ngap_percent = 0.0001\ntime_limit_s = 0.05\n[constraints]");
    let ended = place(&bench, &[]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    // By then there may be a bound or none yet.
    ended.assert_says(&["the time limit of 0.0500 s is over: ", "is reached, 0.000100 % was asked for; ", " open"]);
    let found = certificate(&bench);
    assert_eq!(found["best"]["status"], "time_limit");
    let [bound, value] = ["bound_mm", "value_mm"].map(|key| found["best"][key].as_f64().unwrap());
    assert!((0.0..value).contains(&bound), "{bound} and {value}");
    // Never a bound that is none.
    assert_eq!(ended.stdout.contains("nothing is known"), bound == 0.0, "{}", ended.stdout);
    assert!(found["worst_reason"].as_str().unwrap().contains("time limit"), "{found:#}");
    let rows = bench.read("out/open-region.csv").lines().filter(|line| line.starts_with("best,")).count();
    assert!(rows > 0 && Some(rows as u64) == found["best"]["open_boxes"].as_u64());
    assert!(bench.read("out/open-region.svg").contains("<polygon"));
}

/// A path three times as long whose forces are all different: its coarse tables alone take several times the limit.
#[test]
fn a_time_limit_ends_long_stages() {
    let bench = Bench::new();
    let task = bench.read("tasks/five-segments.csv");
    let mut lines = task.lines();
    let mut long = format!("{}\n", lines.next().unwrap());
    for (number, line) in (0..3).flat_map(|_| task.lines().skip(1)).enumerate() {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        cells[0] = (5 * (number / 105) + cells[0].parse::<usize>().unwrap()).to_string();
        for force in &mut cells[10..13] {
            let factor = 1.0 + 0.1 * libm::sin(0.37 * number as f64);
            *force = format!("{:.4}", force.parse::<f64>().unwrap() * factor);
        }
        long += &(cells.join(",") + "\n");
    }
    bench.write("tasks/five-segments.csv", &long);
    bench.replace(RUN, "[constraints]", "[certificate]\ngap_percent = 0.0001\ntime_limit_s = 0.5\n[constraints]");
    let ended = place(&bench, &["--no-worst", "--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let certificate = &ended.json()["certificate"];
    assert_eq!(certificate["best"]["status"], "time_limit");
    // Well below the many seconds that a stage takes, and with room for a machine that does other work.
    let wall = certificate["wall_s"].as_f64().unwrap();
    assert!((0.5..6.0).contains(&wall), "{wall} s");
}

/// A gap finer than the tables can distinguish.
#[test]
fn a_gap_too_fine_leaves_what_is_reached_and_says_so() {
    let bench = bench();
    let ended = place(&bench, &["--certify", "0.0001"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&[
        "smaller than the tables can tell apart: a gap of ",
        " % is reached, 0.000100 % was asked for; ",
    ]);
    let found = certificate(&bench);
    assert_holds(&found, 0.0001..=0.5);
    assert_eq!(found["best"]["status"], "exhausted");
    let open = found["best"]["open_boxes"].as_u64().unwrap();
    let rows: Vec<f64> = bench
        .read("out/open-region.csv")
        .lines()
        .filter(|line| line.starts_with("best,"))
        .map(|line| line.split(',').nth(7).unwrap().parse().unwrap())
        .collect();
    assert!(open > 0 && rows.len() as u64 == open, "{open} and {}", rows.len());
    // The bound is that of the most promising box.
    let (least, bound) = (rows.iter().copied().fold(f64::MAX, f64::min), found["best"]["bound_mm"].as_f64().unwrap());
    assert!((least - bound).abs() < 1.5e-7, "{least} and {bound}");
}

/// Ctrl-C while the certificate is made.
#[cfg(unix)]
#[test]
fn ctrl_c_ends_the_certificate_and_keeps_the_placement() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};
    let bench = bench();
    // The whole cell, so that it takes long enough.
    bench.replace(RUN, "x_mm = [-60.0, 60.0]", "x_mm = [-300.0, 300.0]");
    bench.replace(RUN, "y_mm = [-1720.0, -1640.0]", "y_mm = [-2240.0, -1640.0]");
    bench.replace(RUN, "z_mm = [-300.0, -250.0]", "z_mm = [-602.0, -214.0]");
    let mut command = bench.command(&["place", RUN, "--out", "out", "--certify", "0.0001", "--json"]);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // The last file of the placement is written before the certificate begins.
    let begun = Instant::now();
    while !bench.path("out/cell.svg").exists() {
        assert!(begun.elapsed() < Duration::from_secs(60), "the certificate does not begin");
        std::thread::sleep(Duration::from_millis(20));
    }
    std::thread::sleep(Duration::from_millis(200));
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let ended = Ended::from(child.wait_with_output().unwrap());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&["interrupted: "]);
    let found = certificate(&bench);
    assert_eq!(found["best"]["status"], "interrupted", "{found:#}");
    assert!(found["best"]["bound_mm"].as_f64().unwrap() < found["best"]["value_mm"].as_f64().unwrap());
    assert_eq!(ended.json()["interrupted"], false);
}
