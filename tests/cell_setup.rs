//! Mount, orientations of the part and external axes from outside.

use crate::common::{Bench, Ended, RUN};

const ROBOT: &str = "configs/robots/kuka-kr270-2.toml";
const CONTROLLER: &str = "\
    [controller]\nkind = 'kuka'\nsign = [-1, -1, -1, -1, -1, -1]\noffset_deg = [0, 0, -90, 0, 0, 0]\n\
    [root]\nxyz_mm = [0, 0, 750]\nabc_deg = [0, 0, 0]\n";

/// On a wall, the base frame turned about x of the cell by a right angle.
const WALL: &str = "[mount]\nxyz_mm = [0, 0, 2500]\nrpy_deg = [90, 0, 0]\n[cell]\n";
const RAIL: &str = "\
    [[external_axis]]\nname = 'rail'\nkind = 'rail'\ncarries = 'robot'\ndirection = [1, 0, 0]\nrange_mm = [-200, 200]\n\
    speed_mm_per_s = 500\nuse = 'continuous'\n";
const TABLE: &str = "\
    [[external_axis]]\nname = 'table'\nkind = 'turntable'\ncarries = 'workpiece'\naxis = [0, 0, 1]\nxyz_mm = [0, -1940, 0]\n\
    range_deg = [-90, 90]\nspeed_deg_per_s = 60\nuse = 'indexed'\n";

fn bench() -> Bench {
    let bench = Bench::new();
    let mut robot: toml::Table = bench.read(ROBOT).parse().unwrap();
    robot.retain(|key, _| key != "controller" && key != "root");
    robot.extend(CONTROLLER.parse::<toml::Table>().unwrap());
    bench.write(ROBOT, &toml::to_string(&robot).unwrap());
    bench.replace(RUN, "generations = 3", "generations = 1");
    bench.replace(RUN, "basins = 2", "basins = 1");
    bench.replace(RUN, "q4 = [-1.0, 1.0]", "q4 = [0.0, 0.0]");
    bench.replace(RUN, "[reference]", "[output]\nmaps = false\n[reference]");
    bench
}

fn ok(ended: &Ended) -> &str {
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    &ended.stdout
}

fn place(bench: &Bench) -> serde_json::Value {
    let ended = bench.stead(&["place", RUN, "--json", "--out", "r"]);
    ok(&ended);
    ended.json()
}

/// Programs of the best plan in a form, and their check.
fn assert_exported(bench: &Bench, format: &str, file: &str, more: &[&str]) {
    let export = ["export", RUN, "r/best.csv", "--format", format, "--out", "p/PART", "--approach-mm", "5"];
    ok(&bench.stead(&[&export[..], more].concat()));
    let file = format!("p/{file}");
    let checked = bench.stead(&["export", RUN, "r/best.csv", "--check", &file, "--approach-mm", "5"]);
    ok(&checked);
}

fn columns<'a>(csv: &'a str, name: &str) -> Vec<&'a str> {
    let mut lines = csv.lines();
    let place = lines.next().unwrap().split(',').position(|column| column == name).unwrap_or_else(|| panic!("{name}"));
    lines.map(|line| line.split(',').nth(place).unwrap()).collect()
}

#[test]
fn a_robot_on_a_wall_is_placed_exported_and_checked() {
    let bench = bench();
    let floor = place(&bench)["cases"][0]["mean_mm"].as_f64().unwrap();
    // The cell and the part turned with the robot: y of the base is z of the cell, z of the base is against y.
    bench.replace(RUN, "[cell]", WALL);
    bench.replace(RUN, "y_mm = [-2240.0, -1640.0]", "y_mm = [214.0, 602.0]");
    bench.replace(RUN, "z_mm = [-602.0, -214.0]", "z_mm = [260.0, 860.0]");
    bench.replace(RUN, "q4 =", "orientations = [{ name = 'as the robot', rpy_deg = [90, 0, 0] }]\nq4 =");
    let checked = bench.stead(&["check", RUN]);
    let text = ok(&checked);
    for part in ["mount     base frame in the cell frame at x 0.0, y 0.0, z 2500.0 mm", "leans 90.0 deg from upright"] {
        assert!(text.contains(part), "{part} in {text}");
    }
    let wall = place(&bench);
    let found = wall["cases"][0]["mean_mm"].as_f64().unwrap();
    assert!((found / floor - 1.0).abs() < 0.02, "{found} {floor}");
    assert_eq!(wall["cases"][0]["orientation"], "as the robot");
    assert_exported(&bench, "krl", "PART.src", &[]);
    let summary: serde_json::Value = serde_json::from_str(&bench.read("r/summary.json")).unwrap();
    assert_eq!(summary["mount"]["rpy_deg"][0], 90.0);
    let at = ["--x-mm", "0", "--y-mm", "400", "--z-mm", "500", "--yaw-deg", "0"];
    let moved = bench.stead(&[&["score", RUN, "--set", "mount.xyz_mm[3]=500"], &at[..]].concat());
    moved.assert_says(&["note: mount.xyz_mm[3] is 500 in place of what the files say"]);
}

#[test]
fn axes_are_in_plans_results_and_programs() {
    let bench = bench();
    bench.replace(RUN, "[constraints]", &format!("{RAIL}{TABLE}[constraints]"));
    bench.replace(RUN, "x_mm = [-300.0, 300.0]", "x_mm = [0.0, 0.0]");
    bench.replace(RUN, "y_mm = [-2240.0, -1640.0]", "y_mm = [-1800.0, -1800.0]");
    bench.replace(RUN, "z_mm = [-602.0, -214.0]", "z_mm = [-500.0, -500.0]");
    let document = place(&bench);
    let axes = &document["cases"][0]["external_axes"];
    assert_eq!((&axes["axes"][0]["name"], &axes["axes"][1]["unit"]), (&"rail".into(), &"deg".into()));
    let plan = bench.read("r/best.csv");
    assert_eq!((columns(&plan, "e1_mm").len(), columns(&plan, "e2_deg").len()), (105, 105));
    assert!(columns(&bench.read("r/placements.csv"), "e1_mm").len() == 4);
    // What was found is found again from the results.
    let again = bench.stead(&["score", RUN, "--placement-of", "r", "--json"]).json();
    let [a, b] = [&document["cases"][0], &again["best"]].map(|entry| entry["mean_mm"].as_f64().unwrap());
    assert!((a - b).abs() < 2e-7, "{a} {b}");
    // The part is on the table: the program has to be coupled to it.
    let refused =
        bench.stead(&["export", RUN, "r/best.csv", "--format", "krl", "--out", "p/PART", "--approach-mm", "5"]);
    assert_eq!(refused.code, Some(2), "{}", refused.stderr);
    refused
        .assert_says(&["error: --mechanism: is missing, and the workpiece is carried by", "; allowed: the number n"]);
    assert_exported(&bench, "krl", "PART.src", &["--mechanism", "2"]);
    assert_exported(&bench, "csv", "PART.csv", &[]);
    let text = bench.read("p/PART_01.src");
    assert!(text.contains("\n$BASE=EK(MACHINE_DEF[2].ROOT,MACHINE_DEF[2].MECH_TYPE,{FRAME: X "), "{text}");
    let line = text.lines().find(|line| line.starts_with("LIN")).unwrap();
    let (before, after) = line.split_once("E1 ").unwrap();
    let (position, behind) = after.split_once(',').unwrap();
    let off = position.parse::<f64>().unwrap() + 0.05;
    bench.replace("p/PART_01.src", line, &format!("{before}E1 {off},{behind}"));
    let tampered = bench.stead(&["export", RUN, "r/best.csv", "--check", "p/PART.src", "--approach-mm", "5"]);
    assert_eq!(tampered.code, Some(1));
    assert!(tampered.stdout.contains("external axis E1 is not where the plan has it"), "{}", tampered.stdout);
}

#[test]
fn an_orientation_is_named_where_there_are_several() {
    let bench = bench();
    let two = "orientations = [{ name = 'flat' }, { name = 'turned', rpy_deg = [0, 0, 90] }]\nq4 =";
    bench.replace(RUN, "q4 =", two);
    let at = ["--x-mm", "0", "--y-mm", "-1800", "--z-mm", "-500", "--yaw-deg", "0"];
    let score = |more: &[&str]| bench.stead(&[&["score", RUN, "--json"], &at[..], more].concat());
    let without = score(&[]);
    assert_eq!(without.code, Some(2));
    without.assert_says(&["--orientation: is missing; allowed: flat, turned"]);
    let unknown = score(&["--orientation", "upside down"]);
    assert_eq!(unknown.code, Some(2));
    unknown.assert_says(&["--orientation", "upside down", "allowed: flat, turned"]);
    let turned = score(&["--orientation", "turned"]).json();
    assert_eq!(turned["orientation"], "turned");
    // Turned by the part or by the yaw is the same.
    bench.replace(RUN, "q4 = [0.0, 0.0]", "q4 = [-1.0, 1.0]");
    let by_yaw = [&["score", RUN, "--json", "--orientation", "flat"], &at[..7], &["90"]].concat();
    let by_yaw = bench.stead(&by_yaw).json();
    let [a, b] = [&turned, &by_yaw].map(|entry| entry["best"]["mean_mm"].as_f64().unwrap());
    assert!((a - b).abs() < 2e-7, "{a} {b}");
    let only =
        bench.stead(&[&["score", RUN, "--json", "--set", "cell.orientation=\"turned\""], &at[..]].concat()).json();
    assert_eq!(only["best"], turned["best"]);
}

#[test]
fn a_table_turns_along_the_path_beside_a_limit_on_the_turn_of_the_spindle() {
    let bench = bench();
    let table = TABLE.replace("'indexed'", "'continuous'");
    bench.replace(RUN, "[constraints]", &format!("{table}[constraints]"));
    for (from, to) in [
        ("x_mm = [-300.0, 300.0]", "x_mm = [0.0, 0.0]"),
        ("y_mm = [-2240.0, -1640.0]", "y_mm = [-1800.0, -1800.0]"),
        ("z_mm = [-602.0, -214.0]", "z_mm = [-500.0, -500.0]"),
        ("max_beta_rate_deg_per_mm = 0.9", "max_spindle_turn_deg_per_mm = 0.5"),
    ] {
        bench.replace(RUN, from, to);
    }
    let mean = number(&place(&bench)["cases"][0]["mean_mm"]);
    let plan = bench.read("r/best.csv");
    let of = |name: &str| columns(&plan, name).into_iter().map(number_of).collect::<Vec<f64>>();
    let (positions, betas, segments) = (of("e1_deg"), of("beta_deg"), of("segment"));
    // Five lines of one direction each with the tool upright: the spindle turns with the table and by beta.
    let mut moved = 0.0_f64;
    for i in (1..105).filter(|i| segments[*i] == segments[i - 1]) {
        let table = positions[i] - positions[i - 1];
        let turn = (table + betas[i] - betas[i - 1]).rem_euclid(360.0);
        // Points are up to 10.4 mm apart.
        assert!(turn.min(360.0 - turn) <= 0.5 * 10.4 + 3e-4, "{i}: {turn} {table}");
        moved = moved.max(table.abs());
    }
    assert!(moved > 0.1, "{moved}");
    // Better than a table that stands still for each segment.
    bench.replace(RUN, "'continuous'", "'indexed'");
    assert!(mean < number(&place(&bench)["cases"][0]["mean_mm"]));
    // A table that tilts is refused beside such a limit: how the spindle turns would depend on the yaw of the part.
    bench.replace(RUN, "'indexed'", "'continuous'");
    bench.replace(RUN, "axis = [0, 0, 1]", "axis = [0, 1, 0]");
    let refused = bench.stead(&["place", RUN, "--out", "never"]);
    assert_eq!(refused.code, Some(2));
    refused.assert_says(&["external_axis[1].use: turns the workpiece about another direction than the vertical"]);
}

fn number(value: &serde_json::Value) -> f64 {
    value.as_f64().unwrap()
}

fn number_of(text: &str) -> f64 {
    text.parse().unwrap()
}

#[test]
fn bad_input_says_where_and_what() {
    let bench = bench();
    let good = bench.read(RUN);
    let refused = |from: &str, to: &str, parts: &[&str]| {
        bench.write(RUN, &good.replacen("[constraints]", &format!("{RAIL}{TABLE}[constraints]"), 1));
        let line = bench.replace(RUN, from, to);
        let ended = bench.stead(&["place", RUN, "--out", "never"]);
        assert_eq!(ended.code, Some(2), "{to}: {}", ended.stderr);
        assert_eq!(ended.said().lines().count(), 1, "{}", ended.stderr);
        ended.assert_says(parts);
        assert!(!bench.path("never").exists() || bench.names("never").is_empty());
        line
    };
    refused("range_mm = [-200, 200]\n", "", &["external_axis[1].range_mm: is missing", "; allowed: "]);
    let line = refused(
        "range_mm = [-200, 200]",
        "range_mm = [200, -200]",
        &["external_axis[1].range_mm", "above its upper end"],
    );
    refused("range_mm = [-200, 200]", "range_mm = [200, -200]", &[&format!("run.toml:{line}: ")]);
    refused("kind = 'rail'", "kind = 'crane'", &["external_axis[1].kind", "allowed: \"rail\" or \"turntable\""]);
    refused("name = 'table'", "name = 'rail'", &["external_axis[2].name: is there twice"]);
    refused("direction = [1, 0, 0]", "direction = [0, 0, 0]", &["external_axis[1].direction: is no direction"]);
    refused("direction = [1, 0, 0]", "axis = [1, 0, 0]", &["external_axis[1].axis: is no key of a rail"]);
    refused("speed_mm_per_s = 500\n", "", &["external_axis[1].speed_mm_per_s: is missing"]);
    refused(
        "speed_deg_per_s = 60\nuse = 'indexed'",
        "use = 'continuous'",
        &["external_axis[2].speed_deg_per_s: is missing; allowed: the speed of an axis that moves along the path"],
    );
    refused("range_deg = [-90, 90]", "range_deg = [-90, nan]", &["external_axis[2].range_deg"]);
    let lists = [
        ("orientations = []", "cell.orientations: is empty"),
        ("orientations = [{ name = 'a' }, { name = 'a' }]", "cell.orientations[2].name: is there twice"),
        ("orientations = [{ name = ' ' }]", "cell.orientations[1].name: is blank"),
        ("orientations = [{ name = 'a', rpy_deg = [0, 0, 0], abc_deg = [0, 0, 0] }]", "states an orientation beside"),
        ("orientation = 'a'", "cell.orientation: names an orientation, and none is listed"),
        (
            "orientations = [{ name = 'a' }]\norientation = 'b'",
            "cell.orientation: is not among the orientations, found",
        ),
    ];
    for (text, part) in lists {
        refused("q4 =", &format!("{text}\nq4 ="), &[part, "; allowed: "]);
    }
    refused("[cell]", "[mount]\nxyz_mm = [0, 0]\n[cell]", &["mount.xyz_mm", "three"]);
    refused("[cell]", "[mount]\nxyz_mm = [0, 0, inf]\n[cell]", &["mount.xyz_mm"]);
    refused("[cell]", "[mount]\nxyz_mm = [0, 0, 0]\nup = 1\n[cell]", &["mount.up", "allowed: "]);
}
