//! `stead assess` from outside: what it prints and writes, that threads do not matter, and what it refuses.

use crate::common::{Bench, Ended};

const STUDY: &str = "configs/klimchik-2017.toml";
const COMPATIBLE: &str = "configs/klimchik-2017-table-compatible.toml";

/// A bench with the published study in it, on a map so coarse that it takes a moment.
fn bench() -> Bench {
    let bench = fine_bench();
    for comparison in [STUDY, COMPATIBLE] {
        bench.replace(comparison, "step_mm = 25.0", "step_mm = 100.0");
        bench.replace(comparison, "points = 72", "points = 24");
    }
    bench
}

/// The same with the map as shipped.
fn fine_bench() -> Bench {
    let bench = Bench::new();
    bench.copy_all(&[STUDY, COMPATIBLE, "configs/reference/klimchik-2017-tables.toml"]);
    for name in ["kr100-ha", "kr120-r3900", "kr270-r2700", "kr360-l240", "kr500"] {
        let file = format!("configs/robots/kuka-{name}.toml");
        bench.copy(&file, &file);
    }
    bench
}

fn run(bench: &Bench, comparison: &str, more: &[&str]) -> Ended {
    bench.stead(&[&["assess", comparison], more].concat())
}

#[test]
fn table_compatible_is_within_eleven_percent_of_the_printed_tables() {
    let bench = fine_bench();
    let ended = run(&bench, COMPATIBLE, &["--out", "out", "--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let document = ended.json();
    let reference = &document["reference"];
    assert_eq!(reference["readings"], 55);
    let rms = reference["rms_percent"].as_f64().unwrap();
    assert!(rms > 9.0 && rms < 11.0, "{rms}");
    assert_eq!((&reference["same_best"], &reference["same_worst"]), (&true.into(), &true.into()));
    // Table 9 comes out of our own smallest circularities too.
    assert_eq!(
        (&reference["selection_cells"], &reference["selection_cells_with_the_same_robots"]),
        (&30.into(), &30.into())
    );
    let robot = &document["robots"][4];
    assert_eq!(robot["name"], "KUKA KR 500");
    let down = &robot["configurations"][1];
    assert_eq!((&down["elbow"], &down["load"]), (&"down".into(), &"test".into()));
    let zone = &down["zones"][3];
    assert_eq!(zone["size_mm"].as_f64(), Some(1000.0));
    for (found, published) in
        [(&down["min_mm"], 0.41), (&down["max_mm"], 1.42), (&down["middle_mm"], 0.76), (&zone["optimal_mm"], 1.0)]
    {
        assert!((found.as_f64().unwrap() / published - 1.0).abs() < 0.05, "{found} {published}");
    }
}

#[test]
fn files_are_the_same_for_any_number_of_threads() {
    let bench = bench();
    for (threads, out) in [("1", "one"), ("2", "two"), ("5", "five")] {
        let ended = run(&bench, STUDY, &["--threads", threads, "--out", out]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert!(ended.stdout.contains("KUKA KR 360 L240") && ended.stdout.contains("results in"), "{}", ended.stdout);
        ended.assert_says(&["note: ", "linear in the joint angle"]);
    }
    let tree = bench.tree("one");
    let names: Vec<&str> = tree.keys().map(String::as_str).collect();
    let expected = [
        "accuracy.csv",
        "circularity.csv",
        "indicators.svg",
        "manifest.json",
        "map-kuka-kr-100-ha.csv",
        "map-kuka-kr-100-ha.svg",
        "map-kuka-kr-120-r3900.csv",
        "map-kuka-kr-120-r3900.svg",
        "map-kuka-kr-270-r2700.csv",
        "map-kuka-kr-270-r2700.svg",
        "map-kuka-kr-360-l240.csv",
        "map-kuka-kr-360-l240.svg",
        "map-kuka-kr-500.csv",
        "map-kuka-kr-500.svg",
        "middle-zones.csv",
        "optimal-zones.csv",
        "report.html",
        "selection.csv",
        "summary.json",
    ];
    assert_eq!(names, expected);
    assert!(tree == bench.tree("two") && tree == bench.tree("five"));
}

#[test]
fn one_accuracy_at_one_force_may_be_asked_for() {
    let bench = bench();
    let ended = run(&bench, COMPATIBLE, &["--accuracy-mm", "0.3", "--force-n", "2500", "--out", "out", "--json"]);
    let selection = ended.json()["selection"].as_array().unwrap().clone();
    assert_eq!(selection.len(), 1);
    assert_eq!((selection[0]["accuracy_mm"].as_f64(), selection[0]["force_n"].as_f64()), (Some(0.3), Some(2500.0)));
    // The KR 360 would need 0.86 mm at the test force of 1439 N.
    assert_eq!(selection[0]["robots"], serde_json::json!(["KUKA KR 500"]));
}

#[test]
fn a_circle_that_fits_nowhere_ends_with_1_and_says_what_limits_it() {
    let bench = bench();
    bench.replace(STUDY, "radius_mm = 100.0", "radius_mm = 1800.0");
    let ended = run(&bench, STUDY, &["--out", "new", "--json"]);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(1), ""));
    ended.assert_says(&[
        "error: the circle of radius 1800 mm fits nowhere",
        "KUKA KR 500: ",
        "out of reach at",
        "limit of joint",
    ]);
    assert!(!bench.path("new").exists());
}

#[test]
fn computed_forces_and_another_plane() {
    let bench = bench();
    bench.replace(STUDY, "force_n = [-440.0, -1370.0, -635.0]\n", "");
    bench.replace(STUDY, "moment_nm = [0.0, 3.0, 10.5]\n", "");
    bench.replace(STUDY, "x = [1.0, 0.0, 0.0]\ny = [0.0, 0.0, 1.0]", "x = [1.0, 0.0, 0.0]\ny = [0.0, 1.0, 0.0]");
    bench.replace(STUDY, "origin_mm = [0.0, 0.0, 0.0]", "origin_mm = [0.0, 0.0, 600.0]");
    bench.replace(STUDY, "y_mm = [-2000.0, 4500.0]", "y_mm = [-2000.0, 2000.0]");
    let milling = "[tool]\ncutter_diameter_mm = 16.0\nteeth = 4\nkn_mpa = 800.0\nfriction = 0.4\n[cut]\n\
                   feed_per_tooth_mm = 0.05\naxial_depth_mm = 5.0\nengagement = \"up\"\nradial_depth_mm = 2.0\n\n[map]";
    bench.replace(STUDY, "[map]", milling);
    let ended = run(&bench, STUDY, &["--out", "out", "--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    for name in ["cutting.svg", "cutting-engagement.csv", "cutting-turn.csv"] {
        assert!(bench.path("out").join(name).exists(), "{name}");
    }
    // Over a table the elbow is up, which the shipped file calls down.
    let kr500 = &ended.json()["robots"][4]["configurations"][1];
    assert!(kr500["circles"].as_u64().unwrap() > 100);
    assert!(bench.read("out/map-kuka-kr-500.svg").contains("y (mm)"));
}

#[test]
fn bad_input_ends_with_2_and_leaves_everything_as_it_was() {
    for (from, to, parts) in [
        (
            "kuka-kr500.toml",
            "kuka-kr100-ha.toml",
            ["klimchik-2017.toml:13: robots[5]: ", "second robot called 'KUKA KR 100 HA'"],
        ),
        ("1000.0]", "9000.0]", ["zones.sides_mm[4]: ", "larger than the map, found 9000.0; allowed: "]),
        ("[-440.0, -1370.0, -635.0]", "[0.0, 0.0, -635.0]", ["benchmark.force_n: ", "no force in the plane"]),
        ("[-440.0, -1370.0, -635.0]", "[0.0, inf, 0.0]", ["benchmark.force_n[2]: ", "not a finite number, found inf"]),
        ("reference/klimchik", "reference/clumchik", ["reference.tables: ", "cannot be read"]),
        ("forces_n = [100.0,", "forces_n = [0.0,", ["selection.forces_n[1]: ", "out of range, found 0.0"]),
    ] {
        let bench = bench();
        bench.replace(STUDY, from, to);
        let before = bench.tree("");
        let ended = run(&bench, STUDY, &["--json"]);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
        ended.assert_says(&parts);
        assert!(!ended.stderr.contains("panicked"));
        assert_eq!(bench.tree(""), before);
    }
    let bench = bench();
    for (arguments, part) in [
        (["--accuracy-mm", "0"], "above 0"),
        (["--accuracy-mm", "nan"], "above 0"),
        (["--force-n", "-5"], "above 0"),
        (["--threads", "0"], "from 1 to 1024"),
    ] {
        let ended = run(&bench, STUDY, &arguments);
        assert_eq!(ended.code, Some(2), "{}", ended.stderr);
        ended.assert_says(&[part]);
    }
}

#[test]
fn a_comparison_of_arms_with_borrowed_stiffness_says_what_its_order_is_not() {
    let bench = bench();
    let borrowed = "some arms have a borrowed stiffness: the order of the robots does not rank how stiff those are";
    assert!(!run(&bench, STUDY, &["--out", "out"]).stderr.contains(borrowed));
    let name = "configs/robots/kuka-kr500.toml";
    let text = bench.read(name);
    let (before, after) = text.split_once("\n[[joints]]").unwrap();
    bench.write(name, &format!("{before}\nstiffness_like = 'KUKA KR360 L240'\n[[joints]]{after}"));
    let ended = run(&bench, STUDY, &["--out", "again", "--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&["note: ", borrowed]);
    assert!(ended.json()["notes"].as_array().unwrap().iter().any(|note| note == borrowed));
}
