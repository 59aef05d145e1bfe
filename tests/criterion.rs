//! What is minimised, from outside: directions, stiffness sets, margins, postures, sensitivity.

use crate::common::{Bench, RUN};
use serde_json::Value;

/// A raster of 500 upright points in 20 lines, cut to and fro; the force is against the feed and to its right.
fn raster() -> String {
    let mut text =
        "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,force_x_n,force_y_n,force_z_n\n".to_owned();
    for line in 0..20 {
        for k in 0..25 {
            let (along, feed) = if line % 2 == 0 { (k, 1) } else { (24 - k, -1) };
            let (x, y) = (10 * along - 120, 10 * line - 95);
            text += &format!("{},{x},{y},0,{feed},0,0,0,0,1,{},{},-40\n", line + 1, -120 * feed, -80 * feed);
        }
    }
    text
}

fn placed(bench: &Bench, more: &[&str]) -> Value {
    let ended = bench.stead(&[&["place", RUN, "--out", "out", "--json"], more].concat());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.json()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn scored_as_a_whole_the_deflection_of_a_raster_is_much_smaller() {
    let bench = Bench::new();
    bench.replace(RUN, "task = \"../tasks/five-segments.csv\"", "task = \"raster.csv\"");
    bench.write("configs/raster.csv", &raster());
    bench.replace(RUN, "population = 16\n", "population = 8\n");
    bench.replace(RUN, "generations = 3\nbasins = 2\n", "generations = 1\nbasins = 1\n");
    let total = |document: &Value| number(&document["cases"][0]["deflection_mm"]["total"]["mean"]);
    let plain = placed(&bench, &[]);
    bench.replace(RUN, "force_uncertainty = 0.0", "direction = \"total\"");
    let whole = placed(&bench, &[]);
    assert_eq!(whole["cases"][0]["mean_mm"], whole["cases"][0]["deflection_mm"]["total"]["mean"]);
    assert!(total(&whole) < 0.7 * total(&plain), "{} {}", total(&whole), total(&plain));
    let notes = plain["notes"].as_array().unwrap();
    assert!(notes.iter().any(|note| note.as_str().unwrap().contains("below a fifth of the whole")), "{notes:?}");
}

/// The published placement.
const PLACE: [&str; 8] = ["--x-mm", "2.2", "--y-mm", "-1643.5", "--z-mm", "-556.4", "--q4", "0.9258"];

#[test]
fn postures_are_kept_where_they_may_not_change() {
    let bench = Bench::new();
    bench.replace(RUN, "tie_percent = 0.0", "tie_percent = 0.0\nallowed = [4, 3]\nchanges = \"never\"");
    let score = bench.stead(&[&["score", RUN, "--json"], &PLACE[..]].concat()).json();
    for plan in ["best", "worst"] {
        let postures = score[plan]["postures"].as_array().unwrap();
        assert!(postures.iter().all(|posture| posture == &postures[0]), "{postures:?}");
        assert!([3, 4].contains(&postures[0].as_u64().unwrap()), "{postures:?}");
    }
    assert!(bench.read(RUN).contains("tie_percent = 0.0"));
    bench.replace(RUN, "allowed = [4, 3]", "allowed = [4, 9]");
    let refused = bench.stead(&[&["score", RUN], &PLACE[..]].concat());
    assert_eq!(refused.code, Some(2));
    refused.assert_says(&["postures.allowed[2]: ", "found 9", "from 1 to 8"]);
}

#[test]
fn a_posture_that_no_segment_can_take_is_refused_by_its_number() {
    let bench = Bench::new();
    let line = bench.replace(RUN, "tie_percent = 0.0", "allowed = [3, 4]");
    // Joint 5 turns to one side alone, so that one flip of the wrist is left.
    bench.replace("configs/robots/kuka-kr270-2.toml", "min_deg = -125.0", "min_deg = 5.0");
    let before = bench.tree("");
    let refused = bench.stead(&["place", RUN, "--out", "out"]);
    assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""));
    let place = format!("run.toml:{line}: postures.allowed[");
    refused.assert_says(&[
        &place,
        "no segment can take posture",
        "the limits of the joints leave it out",
        "; allowed: ",
    ]);
    assert_eq!(bench.tree(""), before);
    let (_, said) = refused.stderr.split_once("allowed: ").unwrap();
    let possible: Vec<u8> = said.trim().split(", ").map(|number| number.parse::<u8>().unwrap()).collect();
    assert!(possible.len() == 4 && possible.iter().filter(|number| [3, 4].contains(*number)).count() == 1, "{said}");
}

#[test]
fn words_for_postures_are_kept_and_stated_beside_the_numbers() {
    let bench = Bench::new();
    let line = bench.replace(RUN, "tie_percent = 0.0", "allowed = [\"front\", \"elbow up\"]");
    let placed = bench.stead(&["place", RUN, "--out", "out"]);
    assert_eq!((placed.code, placed.said().as_str()), (Some(0), ""));
    // No plan goes over the back, and none is noted.
    assert!(!placed.stderr.contains("over the back"), "{}", placed.stderr);
    let summary: serde_json::Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
    assert_eq!(summary["postures"]["allowed"], serde_json::json!([3, 4]));
    assert_eq!(summary["posture_words"][2], "front, elbow up, flip");
    for case in summary["cases"].as_array().unwrap() {
        let words = case["posture_words"].as_array().unwrap();
        assert_eq!(words.len(), case["postures"].as_array().unwrap().len());
        assert!(words.iter().all(|of| of.as_str().unwrap().starts_with("front, elbow up, ")), "{words:?}");
    }
    assert!(placed.stdout.contains("\nposture 3: front, elbow up, flip\n"), "{}", placed.stdout);
    let plan = bench.read("out/best.csv");
    assert!(
        plan.lines()
            .skip(1)
            .all(|row| row.contains(",3,front; elbow up; flip,") || row.contains(",4,front; elbow up; no flip,"))
    );
    assert!(bench.read("out/report.html").contains("front, elbow up, no flip"));
    // The back is noted, and told apart from numbers that are no words.
    let refused = |list: &str, parts: &[&str]| {
        bench.replace(RUN, "allowed = [\"front\", \"elbow up\"]", &format!("allowed = {list}"));
        let ended = bench.stead(&["check", RUN]);
        assert_eq!((ended.code, ended.stdout.as_str(), ended.stderr.lines().count()), (Some(2), "", 1), "{list}");
        ended.assert_says(&[&format!("run.toml:{line}: postures.allowed")]);
        ended.assert_says(parts);
        bench.replace(RUN, &format!("allowed = {list}"), "allowed = [\"front\", \"elbow up\"]");
    };
    refused(
        "[\"back\", \"front\"]",
        &["allowed[2]: and \"back\" before it exclude each other, found", "; allowed: one of the two"],
    );
    refused("[\"up\"]", &["allowed[1]: ", "found \"up\"", "\"elbow up\" or \"elbow down\""]);
    bench.replace("configs/robots/kuka-kr270-2.toml", "min_deg = -125.0", "min_deg = 5.0");
    refused(
        "[\"no flip\", \"front\"]",
        &["leaves no posture: the limits of the joints leave out all that are no flip, front"],
    );
    // Another number beside the words.
    bench.replace(RUN, "allowed = [\"front\", \"elbow up\"]", "allowed = [\"back\", 3]");
    let placement = [&["score", RUN, "--json"], &PLACE[..]].concat();
    let scored = bench.stead(&placement);
    assert_eq!(scored.code, Some(0), "{}", scored.stderr);
    for posture in scored.json()["best"]["postures"].as_array().unwrap() {
        assert!(posture.as_u64().unwrap() >= 5 || posture == 3, "{posture}");
    }
}

#[test]
fn a_tie_of_a_thousandth_is_the_default() {
    let bench = Bench::new();
    let score = || bench.stead(&[&["score", RUN, "--json"], &PLACE[..]].concat()).json();
    let free = number(&score()["best"]["mean_mm"]);
    bench.replace(RUN, "[postures]\ntie_percent = 0.0", "");
    let default = score();
    bench.replace(RUN, "[search]", "[postures]\ntie_percent = 0.1\n\n[search]");
    assert_eq!(score()["best"], default["best"]);
    let tied = number(&default["best"]["mean_mm"]);
    assert!(free <= tied && tied <= free * 1.001 + 1e-7, "{free} {tied}");
}

#[test]
fn margins_keep_plans_off_the_limits_and_the_path_off_the_column() {
    let bench = Bench::new();
    bench.replace(RUN, "characteristic_length_mm = 682.0", "joint_margin_deg = 5.0\ncharacteristic_length_mm = 682.0");
    let document = placed(&bench, &[]);
    let limits = [(-185.0, 185.0), (0.0, 146.0), (-245.0, 29.0), (-350.0, 350.0), (-125.0, 125.0), (-350.0, 350.0)];
    for case in document["cases"].as_array().unwrap() {
        for point in case["plan"].as_array().unwrap() {
            for (angle, (min, max)) in point["joints_deg"].as_array().unwrap().iter().zip(limits) {
                assert!((min + 4.9999..=max - 4.9999).contains(&number(angle)), "{angle} beside {min} and {max}");
            }
        }
    }
    bench.replace(RUN, "joint_margin_deg = 5.0", "min_base_distance_mm = 2500.0");
    let refused = bench.stead(&[&["score", RUN], &PLACE[..]].concat());
    assert_eq!(refused.code, Some(1), "{}", refused.stderr);
    refused.assert_says(&["from axis 1", "nearer than min_base_distance = 2500 mm"]);
}

#[test]
fn one_placement_for_several_stiffnesses_and_what_force_errors_do_are_stated() {
    let bench = Bench::new();
    bench.copy_all(&["configs/robots/kuka-kr270-2-k1-0.8.toml"]);
    bench.replace(RUN, "population = 16\n", "population = 8\n");
    bench.replace(RUN, "generations = 3\nbasins = 2\n", "generations = 1\nbasins = 1\n");
    let sets = "over = \"worst\"\nrobots = [\"robots/kuka-kr270-2.toml\", \"robots/kuka-kr270-2-k1-0.8.toml\"]\n";
    bench.replace(RUN, "force_uncertainty = 0.0", sets);
    let document = placed(&bench, &["--sensitivity"]);
    let found = &document["stiffness_sets"];
    let means: Vec<f64> = found["sets"].as_array().unwrap().iter().map(|set| number(&set["mean_mm"])).collect();
    let worst = number(&found["worst_mean_mm"]);
    assert!(means.len() == 2 && means[0].max(means[1]) == worst, "{found}");
    assert!(worst <= number(&document["cases"][0]["mean_mm"]) + 1e-7, "{found}");
    let sensitivity = &document["sensitivity"];
    assert_eq!(sensitivity["force_uncertainty"], 0.1);
    let [nominal, robust] = ["nominal", "robust"].map(|key| number(&sensitivity[key]["with_force_errors_mm"]));
    assert!(robust <= nominal * (1.0 + 1e-6), "{sensitivity}");
    assert_eq!(document["inputs"].as_array().unwrap().len(), 5);
    for case in [0, 2] {
        assert_eq!(document["cases"][case]["objective_by_stiffness"].as_array().unwrap().len(), 6);
        assert!(document["cases"][case]["active_bounds"].is_array());
    }
}
