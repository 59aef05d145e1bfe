//! The setup sheet from outside: every number in it is one of the run's files.

use crate::common::{Bench, RUN};
use serde_json::Value;

const WALL: &str = "[mount]\nxyz_mm = [0, 0, 2500]\nrpy_deg = [90, 0, 0]\n[cell]\n";
const RAIL: &str = "\
    [[external_axis]]\nname = 'rail'\nkind = 'rail'\ncarries = 'robot'\ndirection = [1, 0, 0]\nrange_mm = [-200, 200]\n\
    speed_mm_per_s = 500\nuse = 'fixed'\n";
const TABLE: &str = "\
    [[external_axis]]\nname = 'table'\nkind = 'turntable'\ncarries = 'workpiece'\naxis = [0, 0, 1]\nxyz_mm = [0, -1940, 0]\n\
    range_deg = [-90, 90]\nspeed_deg_per_s = 60\nuse = 'indexed'\n";

/// All numbers of a document.
fn numbers(value: &Value, found: &mut Vec<f64>) {
    match value {
        Value::Number(number) => found.extend(number.as_f64()),
        Value::Array(all) => all.iter().for_each(|one| numbers(one, found)),
        Value::Object(all) => all.values().for_each(|one| numbers(one, found)),
        _ => {}
    }
}

/// The texts of a picture.
fn texts(svg: &str) -> Vec<&str> {
    let ends = |text: &'static str| {
        svg.split("<text ").skip(1).filter_map(move |part| part.split_once('>')?.1.split_once(text))
    };
    ends("</text>").map(|(text, _)| text.trim()).collect()
}

/// The numbers with decimals in a text, with how many these are.
fn decimals(text: &str) -> Vec<(f64, usize)> {
    let words = text.split(|letter: char| !(letter.is_ascii_digit() || letter == '.' || letter == '-'));
    let numbers = words.map(|word| word.trim_end_matches('.')).filter(|word| word.matches('.').count() == 1);
    numbers.map(|word| (word.parse().unwrap(), word.split_once('.').unwrap().1.len())).collect()
}

/// A text as an SVG has it.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// The sheet of a folder against its documents; returns what `setup_sheet` states.
fn check(bench: &Bench, folder: &str, document: &str, plan: &str) -> Value {
    let said: Value = serde_json::from_str(&bench.read(&format!("{folder}/{document}"))).unwrap();
    let svg = bench.read(&format!("{folder}/setup.svg"));
    let sheet = &said["setup_sheet"];
    let mut known = Vec::new();
    numbers(sheet, &mut known);
    let clearance = said["cases"].get(0).map_or(&said["best"]["clearance"], |case| &case["clearance"]);
    numbers(clearance, &mut known);
    let all = texts(&svg);
    // What is to be known of the result is on the sheet as in the summary, above the files.
    let summary: Vec<[&str; 2]> = said["summary"]
        .as_array()
        .unwrap()
        .iter()
        .map(|line| ["about", "text"].map(|key| line[key].as_str().unwrap()))
        .collect();
    let from = summary.iter().position(|[about, _]| ["cut", "RESTS ON", "NOT CHECKED", "WARNING"].contains(about));
    let rest = &summary[from.unwrap()..];
    for [about, text] in rest {
        let begin = all.iter().position(|of| of == about).unwrap_or_else(|| panic!("{about} is not on the sheet"));
        assert!(all[begin + 1..].join(" ").starts_with(&escaped(text)), "{text}");
    }
    let is_said = |of: &str| of.contains(' ') && rest.iter().any(|[_, text]| escaped(text).contains(of));
    let mut compared = 0;
    for text in all.iter().filter(|text| !text.starts_with("stead ") && !text.contains("1 : ") && !is_said(text)) {
        for (number, digits) in decimals(text) {
            // Rounded once in the document and once more in the sheet.
            let off = 0.5 * 0.1_f64.powi(digits as i32) + 1e-4;
            assert!(known.iter().any(|of| (of - number).abs() <= off), "{number} of {text:?} is in no file");
            compared += 1;
        }
    }
    assert!(compared > 40, "{compared}");
    for input in said["inputs"].as_array().unwrap() {
        assert!(all.contains(&input["sha256"].as_str().unwrap()), "{input}");
    }
    // Joint angles are those of the plan, and what lies between check points is what lies between its points.
    let mut rows = csv_rows(&bench.read(&format!("{folder}/{plan}")));
    for check in sheet["check_points"].as_array().unwrap() {
        let row = &mut rows[check["point"].as_u64().unwrap() as usize];
        for joint in 0..6 {
            assert_eq!(row[&format!("theta{}_deg", joint + 1)], check["joints_deg"][joint].as_f64().unwrap());
        }
    }
    sheet.clone()
}

fn csv_rows(csv: &str) -> Vec<std::collections::BTreeMap<String, f64>> {
    let mut lines = csv.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let row = |line: &str| {
        let cells = names.iter().zip(line.split(','));
        cells.filter_map(|(name, cell)| Some(((*name).to_owned(), cell.parse().ok()?))).collect()
    };
    lines.map(row).collect()
}

fn placed(change: impl FnOnce(&Bench)) -> Bench {
    let bench = Bench::new();
    bench.replace(RUN, "generations = 3", "generations = 1");
    bench.replace(RUN, "basins = 2", "basins = 1");
    bench.replace(RUN, "q4 = [-1.0, 1.0]", "q4 = [0.0, 0.0]");
    change(&bench);
    let ended = bench.stead(&["place", RUN, "--no-worst", "--out", "r"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    bench
}

fn triple(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|k| value[k].as_f64().unwrap())
}

#[test]
fn the_sheet_of_a_run_states_what_its_files_do_in_the_frame_of_the_pendant() {
    let bench = placed(|_| {});
    let sheet = check(&bench, "r", "summary.json", "best.csv");
    assert_eq!((sheet["frame"].as_str(), sheet["robot_frame"].as_str()), (Some("root"), Some("root")));
    let robot: toml::Table = bench.read("configs/robots/kuka-kr270-2.toml").parse().unwrap();
    let root: Vec<f64> = robot["root"]["xyz_mm"].as_array().unwrap().iter().map(|of| of.as_float().unwrap()).collect();
    let said: Value = serde_json::from_str(&bench.read("r/summary.json")).unwrap();
    let rows = csv_rows(&bench.read("r/best.csv"));
    let part = triple(&sheet["part"]["xyz_mm"]);
    for (k, name) in ["x_mm", "y_mm", "z_mm"].into_iter().enumerate() {
        let placement = said["cases"][0]["placement"][name].as_f64().unwrap();
        assert!((part[k] - placement - root[k]).abs() < 2e-4, "{part:?} {placement}");
        for check in sheet["check_points"].as_array().unwrap() {
            let row = rows[check["point"].as_u64().unwrap() as usize][name];
            assert!((triple(&check["xyz_mm"])[k] - row - root[k]).abs() < 2e-4);
        }
    }
    // theta = sign A + offset, as the robot file states it.
    let of = |key: &str, joint: usize| {
        let entry = &robot["controller"][key][joint];
        entry.as_float().unwrap_or_else(|| entry.as_integer().unwrap() as f64)
    };
    for check in sheet["check_points"].as_array().unwrap() {
        for joint in 0..6 {
            let [theta, shown] = ["joints_deg", "controller_deg"].map(|key| check[key][joint].as_f64().unwrap());
            assert!((of("sign", joint) * shown + of("offset_deg", joint) - theta).abs() < 2e-4);
        }
    }
    assert!(bench.read("r/report.html").contains("Setup sheet"));
    // The rows end at the wrist centre; the tool is stated on the mounting flange, 230 mm beyond it, as programs do.
    let run: toml::Table = bench.read(RUN).parse().unwrap();
    let stated = |k: usize| {
        let entry = &run["spindle"]["xyz_mm"][k];
        entry.as_float().unwrap_or_else(|| entry.as_integer().unwrap() as f64)
    };
    let on_flange = triple(&sheet["tool_on_flange"]["xyz_mm"]);
    assert_eq!(on_flange, [stated(0), stated(1), stated(2) - 230.0]);
    let export = ["export", RUN, "r/best.csv", "--format", "krl", "--out", "p/PART"];
    assert_eq!(bench.stead(&export).code, Some(0));
    let tool = bench.read("p/PART.src");
    let line = tool.lines().find(|line| line.contains("$TOOL={")).unwrap();
    assert!(
        decimals(&line.replace(',', " ")).iter().any(|(z, _)| (z - on_flange[2]).abs() < 1e-3),
        "{line} {on_flange:?}"
    );
    assert_eq!(bench.stead(&["export", RUN, "r/best.csv", "--check", "p/PART.src"]).code, Some(0));
    // Each check point has the frame of the tool, status and turn; without shapes nothing is said to be free.
    for check in sheet["check_points"].as_array().unwrap() {
        assert_eq!(
            (check["abc_deg"].as_array().unwrap().len(), check["status_and_turn"].as_array().unwrap().len()),
            (3, 2)
        );
    }
    assert_eq!((sheet["ways"].as_str(), &sheet["collisions_checked"]), (Some("not-checked"), &Value::Bool(false)));
    assert!(texts(&bench.read("r/setup.svg")).join(" ").contains("COLLISIONS WERE NOT CHECKED"));
}

#[test]
fn mounted_robots_rails_and_tables_have_a_sheet_and_a_run_without_a_page_has_none() {
    let fixed = |bench: &Bench| {
        bench.replace(RUN, "x_mm = [-300.0, 300.0]", "x_mm = [0.0, 0.0]");
        bench.replace(RUN, "y_mm = [-2240.0, -1640.0]", "y_mm = [-1800.0, -1800.0]");
        bench.replace(RUN, "z_mm = [-602.0, -214.0]", "z_mm = [-500.0, -500.0]");
    };
    // As on the floor, the cell and the part turned with the robot.
    let bench = placed(|bench| {
        bench.replace(RUN, "[cell]", WALL);
        bench.replace(RUN, "y_mm = [-2240.0, -1640.0]", "y_mm = [214.0, 602.0]");
        bench.replace(RUN, "z_mm = [-602.0, -214.0]", "z_mm = [260.0, 860.0]");
        bench.replace(RUN, "q4 =", "orientations = [{ name = 'as the robot', rpy_deg = [90, 0, 0] }]\nq4 =");
    });
    let sheet = check(&bench, "r", "summary.json", "best.csv");
    assert_eq!((sheet["frame"].as_str(), &sheet["part"]["abc_deg"][2]), (Some("cell"), &serde_json::json!(90.0)));
    // What the pendant shows is turned with the robot.
    for check in sheet["check_points"].as_array().unwrap() {
        let [in_cell, in_root] = [&check["xyz_mm"], &check["in_root"]["xyz_mm"]].map(triple);
        assert!((in_cell[2] - 2500.0 - in_root[1]).abs() < 2e-4 && (in_cell[0] - in_root[0]).abs() < 2e-4, "{check}");
    }
    let bench = placed(|bench| {
        bench.replace(RUN, "[constraints]", &format!("{RAIL}[constraints]"));
        fixed(bench);
    });
    let sheet = check(&bench, "r", "summary.json", "best.csv");
    assert_eq!(sheet["frame"], "cell");
    let [axis] = &sheet["axes"].as_array().unwrap()[..] else { panic!("{sheet}") };
    // The robot stands where the rail has it; the pendant shows places from there.
    let at = axis["positions"][0].as_f64().unwrap();
    assert!((triple(&sheet["robot"]["xyz_mm"])[0] - at).abs() < 2e-4, "{sheet}");
    for check in sheet["check_points"].as_array().unwrap() {
        let [in_cell, in_root] = [&check["xyz_mm"], &check["in_root"]["xyz_mm"]].map(triple);
        assert!((in_cell[0] - in_root[0] - at).abs() < 2e-4, "{check}");
    }
    let bench = placed(|bench| {
        bench.replace(RUN, "[constraints]", &format!("{TABLE}[constraints]"));
        fixed(bench);
    });
    let sheet = check(&bench, "r", "summary.json", "best.csv");
    assert_eq!((sheet["frame"].as_str(), sheet["axes"][0]["carries"].as_str()), (Some("root"), Some("workpiece")));
    let ended = bench.stead(&["place", RUN, "--no-worst", "--no-page", "--out", "r"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(!bench.path("r/setup.svg").exists() && !bench.read("r/summary.json").contains("setup_sheet"));
}

#[test]
fn a_score_has_a_sheet_where_its_files_are_asked_for() {
    let bench = Bench::new();
    let place = ["score", RUN, "--x-mm", "0", "--y-mm", "-1640", "--z-mm", "-214", "--yaw-deg", "79"];
    let ended = bench.stead(&[&place[..], &["--json"]].concat());
    assert!(ended.code == Some(0) && !ended.stdout.contains("setup_sheet"));
    assert_eq!(bench.stead(&[&place[..], &["--out", "s"]].concat()).code, Some(0));
    let sheet = check(&bench, "s", "score.json", "best-plan.csv");
    let rises = &sheet["tolerances"]["directions"];
    assert_eq!(rises.as_array().unwrap().len(), 8);
    assert!(sheet["tolerances"]["rises"] == serde_json::json!([1.0, 5.0]));
}
