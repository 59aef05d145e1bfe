//! The feed that the arm holds, from outside: `feed` in the documents, the note, and cutting times.

use crate::common::{Bench, Ended, RUN};
use serde_json::Value;

const ROBOT: &str = "configs/robots/kuka-kr270-2.toml";
const TASK: &str = "tasks/five-segments.csv";
const NOTE: &str = "does not hold the programmed feed of 66.7 mm/s";
const SCORE: [&str; 11] =
    ["score", RUN, "--x-mm", "2.2", "--y-mm", "-1643.5", "--z-mm", "-556.4", "--q4", "0.9258", "--json"];

fn scored(bench: &Bench) -> (Ended, Value) {
    let ended = bench.stead(&SCORE);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let document = ended.json();
    (ended, document)
}

/// Joint 6 of the robot file with an acceleration.
fn with_acceleration(bench: &Bench, degrees_per_s2: f64) {
    let speed = "max_speed_deg_per_s = 184.0\n";
    bench.replace(ROBOT, speed, &format!("{speed}max_acceleration_deg_per_s2 = {degrees_per_s2:.1}\n"));
}

/// Length of each segment of the task. mm
fn lengths(bench: &Bench) -> Vec<f64> {
    let text = bench.read(TASK);
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().unwrap().clone();
    let column = |name: &str| header.iter().position(|found| found == name).unwrap();
    let columns = ["segment", "x_mm", "y_mm", "z_mm"].map(column);
    let rows: Vec<[f64; 4]> =
        reader.records().map(|row| columns.map(|k| row.as_ref().unwrap()[k].parse().unwrap())).collect();
    let segments = rows.chunk_by(|a, b| a[0] == b[0]);
    let change = |pair: &[[f64; 4]], k: usize| pair[1][k] - pair[0][k];
    let step = |pair: &[[f64; 4]]| (1..4).map(|k| change(pair, k) * change(pair, k)).sum::<f64>().sqrt();
    segments.map(|segment| segment.windows(2).map(step).sum()).collect()
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

/// Asserts that the time in the cut is that of every segment at the feed held.
fn assert_timed(plan: &Value, lengths: &[f64]) {
    let held = numbers(&plan["feed"]["segments_mm_per_s"]).into_iter().map(|highest| highest.min(66.667));
    let time: f64 = lengths.iter().zip(held).map(|(length, feed)| length / feed).sum();
    assert!((plan["cutting_s"].as_f64().unwrap() - time).abs() < 1e-3, "{time} and not {}", plan["cutting_s"]);
}

#[test]
fn an_acceleration_that_the_programmed_feed_asks_too_much_of_is_noted_and_timed() {
    let bench = Bench::new();
    let lengths = lengths(&bench);
    assert_eq!(lengths.len(), 5);
    let (_, free) = scored(&bench);
    with_acceleration(&bench, 20.0);
    let (ended, slow) = scored(&bench);
    for plan in ["best", "worst"] {
        assert_eq!(slow[plan]["mean_mm"], free[plan]["mean_mm"], "the feed held is no part of the plan");
        let feed = &slow[plan]["feed"];
        let highest = feed["highest_mm_per_s"].as_f64().unwrap();
        assert_eq!(feed["programmed_mm_per_s"], 66.667);
        assert_eq!(highest, numbers(&feed["segments_mm_per_s"]).into_iter().fold(f64::INFINITY, f64::min));
        assert!(highest < 66.0 && highest > 1.0, "{feed}");
        assert_eq!((&feed["decided_by"]["kind"], &feed["decided_by"]["joint"]), (&"acceleration".into(), &6.into()));
        let segment = feed["decided_by"]["segment"].as_u64().unwrap();
        let point = feed["decided_by"]["point"].as_u64().unwrap();
        assert!((21 * (segment - 1)..21 * segment).contains(&point), "{feed}");
        assert_timed(&slow[plan], &lengths);
        assert_timed(&free[plan], &lengths);
        assert!(slow[plan]["cutting_s"].as_f64().unwrap() > free[plan]["cutting_s"].as_f64().unwrap());
    }
    ended.assert_says(&["note: the best plan ", NOTE, "acceleration of joint 6 at point "]);
    let notes = slow["notes"].as_array().unwrap();
    assert!(notes.iter().any(|note| note.as_str().unwrap().contains(NOTE)), "{notes:?}");
    // Four times the acceleration holds twice the feed.
    let (highest, segment) =
        (&slow["best"]["feed"]["highest_mm_per_s"], &slow["best"]["feed"]["decided_by"]["segment"]);
    bench.replace(ROBOT, "max_acceleration_deg_per_s2 = 20.0", "max_acceleration_deg_per_s2 = 5.0");
    let (_, slower) = scored(&bench);
    let feed = &slower["best"]["feed"];
    assert!((2.0 * feed["highest_mm_per_s"].as_f64().unwrap() - highest.as_f64().unwrap()).abs() < 1e-3, "{feed}");
    assert_eq!(&feed["decided_by"]["segment"], segment);
}

#[test]
fn a_longer_blending_distance_holds_a_higher_feed() {
    let bench = Bench::new();
    with_acceleration(&bench, 20.0);
    let highest = |bench: &Bench| scored(bench).1["best"]["feed"]["highest_mm_per_s"].as_f64().unwrap();
    let usual = highest(&bench);
    bench.replace(RUN, "[reference]", "[transfer]\nblend_mm = 20\n[reference]");
    assert!(highest(&bench) > 1.2 * usual);
    let line = bench.replace(RUN, "blend_mm = 20", "blend_mm = 0.01");
    let refused = bench.stead(&SCORE);
    assert_eq!(refused.code, Some(2));
    refused.assert_says(&[&format!("run.toml:{line}: transfer.blend_mm: "), "found 0.01", "from 0.1 to 1000"]);
}

#[test]
fn a_low_feed_is_held_and_says_by_how_much() {
    let bench = Bench::new();
    bench.replace(RUN, "feed_mm_per_s = 66.667", "feed_mm_per_s = 10.0");
    let (ended, document) = scored(&bench);
    assert!(!ended.stderr.contains("programmed feed"), "{}", ended.stderr);
    let feed = &document["best"]["feed"];
    assert!(feed["highest_mm_per_s"].as_f64().unwrap() > 10.0, "{feed}");
    assert_eq!(feed["decided_by"]["kind"], "speed");
    let text = bench.stead(&SCORE[..10]);
    assert!(text.stdout.contains("the best plan holds a feed of up to "), "{}", text.stdout);
    assert!(text.stdout.contains("  what decides: speed of joint "), "{}", text.stdout);
}

/// A rail that goes to and fro by all that its speed allows decides by itself.
#[test]
fn a_rail_that_is_slower_than_the_joints_decides() {
    let bench = Bench::new();
    let rail = "[[external_axis]]\nname = 'rail'\nkind = 'rail'\ncarries = 'robot'\ndirection = [1, 0, 0]\n\
                range_mm = [-100, 100]\nspeed_mm_per_s = 500\nuse = 'continuous'\n";
    bench.replace(RUN, "[constraints]", &format!("{rail}[constraints]"));
    let (_, document) = scored(&bench);
    for plan in ["best", "worst"] {
        let decided = &document[plan]["feed"]["decided_by"];
        assert_eq!((&decided["kind"], &decided["external_axis"]), (&"speed".into(), &"rail".into()), "{decided}");
        assert_eq!(decided["joint"], Value::Null);
    }
    let text = bench.stead(&SCORE[..10]);
    assert!(text.stdout.contains("  what decides: speed of external axis \"rail\" at point "), "{}", text.stdout);
}
