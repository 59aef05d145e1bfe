//! Small CAM files in every dialect, each with its reading worked out by hand: what `stead import path` makes of them.

use crate::common::{Bench, Ended};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A place (mm) and a tool axis.
type Pose = [f64; 6];

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cam");
/// How far points, corners and ways may be apart. mm
const OFF: f64 = 0.05;
/// How far tool axes may be apart. deg
const TILTED: f64 = 0.1;
/// How much feeds and figures of the tool may differ.
const SHARE: f64 = 1e-3;

/// The rows of a table by their segment, each with whether it is scored.
fn segments(text: &str) -> Vec<Vec<(Pose, bool, f64)>> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().unwrap().clone();
    let mut segments: BTreeMap<u32, Vec<(Pose, bool, f64)>> = BTreeMap::new();
    for row in reader.records().map(Result::unwrap) {
        let value = |name: &str| {
            let column = header.iter().position(|own| own == name)?;
            Some(row[column].parse::<f64>().unwrap())
        };
        let names = ["x_mm", "y_mm", "z_mm", "axis_x", "axis_y", "axis_z"];
        let pose = names.map(|name| value(name).unwrap());
        let is_scored = value("scored").is_none_or(|scored| scored == 1.0);
        let segment = value("segment").unwrap() as u32;
        segments.entry(segment).or_default().push((pose, is_scored, value("feed_mm_per_s").unwrap_or(0.0)));
    }
    segments.into_values().collect()
}

/// How far a place is from a way, and the tool axis there.
fn nearest(place: &Pose, way: &[Pose]) -> (f64, [f64; 3]) {
    let between = |pair: &[Pose]| {
        let (from, to) = (pair[0], pair[1]);
        let dot = |a: &dyn Fn(usize) -> f64, b: &dyn Fn(usize) -> f64| (0..3).map(|k| a(k) * b(k)).sum::<f64>();
        let along = |k: usize| to[k] - from[k];
        let share = dot(&|k| place[k] - from[k], &along) / dot(&along, &along).max(1e-12);
        let share = share.clamp(0.0, 1.0);
        let at = |k: usize| from[k] + (to[k] - from[k]) * share;
        let off = (0..3).map(|k| (place[k] - at(k)).powi(2)).sum::<f64>().sqrt();
        (off, [3, 4, 5].map(at))
    };
    way.windows(2).map(between).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
}

/// Angle between two axes. deg
fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    let length = |a: [f64; 3]| a.iter().map(|value| value * value).sum::<f64>().sqrt();
    let dot: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
    libm::acos((dot / length(a) / length(b)).clamp(-1.0, 1.0)).to_degrees()
}

/// What the table of a task has that is wrong against the ways of a reading.
fn wrong_ways(task: &str, reading: &str) -> Vec<String> {
    let task = segments(task);
    let poses = |segment: &Vec<(Pose, bool, f64)>| segment.iter().map(|(pose, ..)| *pose).collect::<Vec<_>>();
    let ways: Vec<Vec<Pose>> = segments(reading).iter().map(poses).collect();
    let read: Vec<Vec<Pose>> =
        task.iter().filter(|segment| segment.iter().any(|(_, is_scored, _)| *is_scored)).map(poses).collect();
    let mut wrong = Vec::new();
    for (pose, ..) in task.iter().flatten().filter(|(_, is_scored, _)| *is_scored) {
        let (off, axis) = ways.iter().map(|way| nearest(pose, way)).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        if off > OFF || angle(axis, [pose[3], pose[4], pose[5]]) > TILTED {
            wrong.push(format!("the point {pose:?}, {off} mm off, where the axis is {axis:?}"));
        }
    }
    let is_missed = |corner: &&Pose| read.iter().all(|way| nearest(corner, way).0 > OFF);
    wrong.extend(ways.iter().flatten().filter(is_missed).map(|corner| format!("the corner {corner:?} is missing")));
    wrong
}

/// What is wrong about a file that is read, against what is expected of it.
fn wrong(bench: &Bench, ended: &Ended, program: &Path, expected: &toml::Table) -> Vec<String> {
    let said = format!("{}{}", ended.stdout, ended.stderr).to_lowercase();
    let words = |key: &str| {
        let values = expected.get(key).and_then(toml::Value::as_array).cloned().unwrap_or_default();
        values.iter().map(|word| word.as_str().unwrap().to_lowercase()).collect::<Vec<_>>()
    };
    let mut wrong = Vec::new();
    let exit = expected["exit"].as_integer().unwrap() as i32;
    if ended.code != Some(exit) {
        wrong.push(format!("exit {:?}: {said}", ended.code));
    }
    wrong.extend(words("says").iter().filter(|word| !said.contains(*word)).map(|word| format!("no '{word}': {said}")));
    wrong.extend(words("says_not").iter().filter(|word| said.contains(*word)).map(|word| format!("'{word}': {said}")));
    if let Some(format) = expected.get("format").and_then(toml::Value::as_str)
        && !said.starts_with(&format!("format    {format}\n"))
    {
        wrong.push(format!("not {format}: {said}"));
    }
    let out = bench.path("out");
    if exit == 2 {
        if out.exists() || ended.stderr.trim_end().lines().count() != 1 {
            wrong.push(format!("a file beside a refusal, or not one line: {said}"));
        }
        return wrong;
    }
    let task = bench.read("out/task.csv");
    let table = segments(&task);
    let scored = table.iter().filter(|segment| segment.iter().any(|(_, is_scored, _)| *is_scored)).count();
    if expected.get("segments").is_some_and(|count| count.as_integer() != Some(scored as i64)) {
        wrong.push(format!("{scored} segments"));
    }
    let number = |value: &toml::Value| value.as_float().or(value.as_integer().map(|value| value as f64)).unwrap();
    let is_near = |found: f64, value: f64| (found / value - 1.0).abs() < SHARE;
    if let Some(range) = expected.get("feed_mm_per_s").and_then(toml::Value::as_array) {
        let feeds = || table.iter().flatten().map(|(.., feed)| *feed);
        let found = [feeds().fold(f64::INFINITY, f64::min), feeds().fold(0.0, f64::max)];
        if !(is_near(found[0], number(&range[0])) && is_near(found[1], number(&range[1]))) {
            wrong.push(format!("feeds {found:?}"));
        }
    }
    if let Some(keys) = expected.get("tool").and_then(toml::Value::as_table) {
        let tool: toml::Table = bench.read("out/task-tool.toml").parse().unwrap();
        for (key, value) in keys {
            let of = |table: &str| tool.get(table).and_then(|table| table.get(key)).map(number);
            let found = of("tool").or(of("cut"));
            if !found.is_some_and(|found| is_near(found, number(value))) {
                wrong.push(format!("{key} {found:?}, not {value}"));
            }
        }
    }
    let reading = PathBuf::from(format!("{}.csv", program.display()));
    if reading.is_file() {
        wrong.extend(wrong_ways(&task, &std::fs::read_to_string(reading).unwrap()));
    }
    wrong
}

#[test]
fn every_file_is_read_as_it_is_meant() {
    let mut readings: Vec<PathBuf> = std::fs::read_dir(FOLDER).unwrap().map(|entry| entry.unwrap().path()).collect();
    readings.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    readings.sort();
    assert!(readings.len() >= 42, "{}", readings.len());
    let mut failed = Vec::new();
    for reading in &readings {
        let expected: toml::Table = std::fs::read_to_string(reading).unwrap().parse().unwrap();
        let program = reading.with_extension("");
        let bench = Bench::new();
        let arguments = ["import", "path", program.to_str().unwrap(), "--out", "out/task.csv", "--report"];
        let more: Vec<String> = expected.get("args").map_or(Vec::new(), |args| args.clone().try_into().unwrap());
        let all: Vec<&str> = arguments.into_iter().chain(more.iter().map(String::as_str)).collect();
        let ended = bench.stead(&all);
        let wrong = wrong(&bench, &ended, &program, &expected);
        failed.extend(wrong.iter().map(|what| format!("{}: {what}", program.display())));
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}
