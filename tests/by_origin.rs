//! Whole arms as a user meets them: where a deflection comes from, and what a robot file says of its stiffness.

use crate::common::{Bench, RUN};
use serde_json::Value;

const PLACE: [&str; 8] = ["--x-mm", "0", "--y-mm", "-1640", "--z-mm", "-214", "--yaw-deg", "79"];

/// What of a whole arm adds to a deflection, in the words of tables.
const ORIGINS: [&str; 6] = ["axes", "normal", "base", "mount", "tip", "part"];

/// Adds lines to all rows of a robot file.
fn in_all_rows(bench: &Bench, robot: &str, lines: &str) {
    let text = bench.read(robot).replace("[[joints]]\n", &format!("[[joints]]\n{lines}\n"));
    bench.write(robot, &text);
}

/// The arm of the run with springs normal to its axes, on a base that yields, with holder and part that yield.
fn whole() -> Bench {
    let bench = Bench::new();
    let robot = "configs/robots/kuka-kr270-2.toml";
    bench.replace(robot, "\"axes\"", "\"full\"");
    in_all_rows(&bench, robot, "orthogonal_compliance_urad_per_nm = [0.2, 0.3]\nbearing_mm = 20.0");
    bench.replace(RUN, "[spindle]", "[spindle]\ntip_um_per_n = [[0.05, 0, 0], [0, 0.05, 0], [0, 0, 0.01]]");
    let tables = "[base_compliance]\nmatrix = [[0.03, 0, 0, 0, 0.01, 0], [0, 0.02, 0, -0.01, 0, 0], [0, 0, 0.01, 0, 0, 0], \
                  [0, -0.01, 0, 0.05, 0, 0], [0.01, 0, 0, 0, 0.07, 0], [0, 0, 0, 0, 0, 0.04]]\n\n\
                  [part_compliance]\num_per_n = [[0.05, 0.01, 0], [0.01, 0.03, 0], [0, 0, 0.08]]\n\n[cell]";
    bench.replace(RUN, "[cell]", tables);
    bench
}

fn mm(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("no number {key} in {value}"))
}

/// What a document states of a deflection by what yields; springs normal to the axes, joint by joint, add up too.
fn by_origin(value: &Value) -> [f64; 6] {
    let stated = &value["by_origin_mm"];
    let by_joint: f64 = stated["normal_by_joint_mm"].as_array().unwrap().iter().map(|mm| mm.as_f64().unwrap()).sum();
    assert!((by_joint - mm(stated, "normal_mm")).abs() < 1e-6, "{stated}");
    ORIGINS.map(|name| mm(stated, &format!("{name}_mm")))
}

/// Columns of a table by what yields, and another, row by row; rows without figures are left out.
fn columns(table: &str, other: &str) -> Vec<([f64; 6], f64)> {
    let mut rows = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let names = rows.next().unwrap();
    let at =
        |name: &str| names.iter().position(|known| *known == name).unwrap_or_else(|| panic!("no {name}: {names:?}"));
    let wanted = ORIGINS.map(|name| at(&format!("from_{name}_mm")));
    let other = at(other);
    let full = rows.filter(|row| !row[other].is_empty());
    let rows = full.map(|row| (wanted.map(|k| row[k].parse().unwrap()), row[other].parse().unwrap()));
    rows.collect()
}

#[test]
fn explain_says_where_the_deflection_of_every_posture_comes_from() {
    let bench = whole();
    let explain = |more: &[&str]| {
        bench.stead(&[&["explain", RUN, "--point", "30", "--beta-deg", "40"], &PLACE[..], more].concat())
    };
    let document = explain(&["--json"]).json();
    let postures = document["postures"].as_array().unwrap();
    let mut reached = 0;
    for posture in postures.iter().filter(|posture| !posture["joints_deg"].is_null()) {
        let parts = by_origin(posture);
        assert!((parts.iter().sum::<f64>() - mm(posture, "score_mm")).abs() < 1e-6, "{posture}");
        assert_eq!((parts[2] == 0.0, parts[3] == 0.0), (false, true), "{posture}");
        reached += 1;
    }
    assert!(reached >= 2 && postures.iter().all(|p| p["by_origin_mm"].is_null() == p["joints_deg"].is_null()));
    let text = explain(&[]).stdout;
    let rows: Vec<&str> =
        text.lines().skip_while(|line| !line.starts_with("of the scored deflection, in mm")).collect();
    let header: Vec<&str> = rows[2].split("  ").filter(|word| !word.is_empty()).map(str::trim).collect();
    let words = ["posture", "sum", "axes", "normal 1", "normal 2", "normal 3", "normal 4", "normal 5", "normal 6"];
    assert_eq!(header, [&words[..], &["base", "tool", "part"]].concat(), "{text}");
    assert_eq!(rows[3..].iter().take_while(|row| !row.is_empty()).count(), reached, "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 120), "{text}");

    let plain = Bench::new().stead(&[&["explain", RUN, "--point", "30", "--beta-deg", "40"], &PLACE[..]].concat());
    assert!(!plain.stdout.contains("of the scored deflection"), "{}", plain.stdout);
}

#[test]
fn plans_maps_and_the_page_say_where_the_deflection_comes_from() {
    let bench = whole();
    assert_eq!(bench.stead(&["place", RUN, "--out", "out"]).code, Some(0));
    let document: Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
    for (case, name) in ["best", "best-worst-plan", "worst", "worst-worst-plan"].into_iter().enumerate() {
        let rows = columns(&bench.read(&format!("out/{name}.csv")), "score_mm");
        let means: [f64; 6] = std::array::from_fn(|k| rows.iter().map(|row| row.0[k]).sum::<f64>() / rows.len() as f64);
        for (parts, score) in &rows {
            assert!((parts.iter().sum::<f64>() - score).abs() < 4e-7, "{parts:?} {score}");
        }
        let stated = by_origin(&document["cases"][case]);
        assert!(stated.iter().zip(means).all(|(a, b)| (a - b).abs() < 2e-7), "{stated:?} {means:?}");
    }
    let states = columns(&bench.read("out/deflection-map-best.csv"), "score_mm");
    assert!(states.len() > 100);
    for (parts, score) in states {
        assert!((parts.iter().sum::<f64>() - score).abs() < 4e-7, "{parts:?} {score}");
    }
    let page = bench.read("out/report.html");
    assert!(page.contains("Where the deflection comes from") && page.contains("normal_by_joint_mm"));
    let found = bench.stead(&["place", RUN, "--no-page"]);
    assert!(found.stdout.contains("in the mean: joints about their axes "), "{}", found.stdout);
}

#[test]
fn a_run_says_that_a_robot_file_does_not_state_what_its_stiffness_stands_for() {
    let bench = Bench::new();
    let says = |bench: &Bench| {
        let ended = bench.stead(&[&["score", RUN], &PLACE[..]].concat());
        assert_eq!(ended.code, Some(0));
        ended.said().contains("the robot file does not state what its stiffness stands for (stiffness_model)")
    };
    assert!(!says(&bench));
    let robot = "configs/robots/kuka-kr270-2.toml";
    bench.replace(robot, "stiffness_model = \"axes\"\n", "");
    assert!(says(&bench));
    // Springs that are stated and left out have a note of their own.
    in_all_rows(&bench, robot, "orthogonal_compliance_urad_per_nm = 0.2");
    assert!(!says(&bench));
    let ended = bench.stead(&[&["score", RUN], &PLACE[..]].concat());
    assert!(ended.said().contains("scores leave them out"), "{}", ended.said());
}
