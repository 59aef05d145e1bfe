//! `stead circularity` from outside: what it prints and writes, and what it refuses.

use crate::common::{Bench, Ended};
use std::f64::consts::TAU;

const FILE: &str = "points.csv";

/// A bench with points of a round of radius 20 mm about (1000, -500) with a flat side, and a burr near 0 deg.
fn bench() -> Bench {
    let bench = Bench::new();
    let mut text = "x_mm,y_mm\n".to_owned();
    for k in 0..72 {
        let angle = TAU * f64::from(k) / 72.0;
        let radius = match k {
            0 | 1 | 71 => 20.3,
            _ => 20.0 + 0.01 * libm::cos(2.0 * angle),
        };
        text += &format!("{},{}\n", 1000.0 + radius * libm::cos(angle), -500.0 + radius * libm::sin(angle));
    }
    bench.write(FILE, &text);
    bench
}

fn run(bench: &Bench, more: &[&str]) -> Ended {
    bench.stead(&[&["circularity", FILE], more].concat())
}

/// Asserts that points are refused with exit code 2, nothing on standard output and no file written.
#[track_caller]
fn refused(text: &str, more: &[&str], parts: &[&str]) {
    let bench = bench();
    bench.write(FILE, text);
    let before = bench.tree("");
    let ended = run(&bench, &[more, &["--out", "out", "--json"]].concat());
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
    assert!(ended.stderr.starts_with("error: ") && !ended.stderr.contains("panicked"), "{}", ended.stderr);
    ended.assert_says(parts);
    assert_eq!(bench.tree(""), before);
}

#[test]
fn four_circles_without_the_burr() {
    let bench = bench();
    let ended = run(&bench, &["--exclude-deg", "350:10", "--json"]);
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""));
    let document = ended.json();
    assert_eq!((document["points"].as_u64(), document["excluded"].as_u64()), (Some(72), Some(3)));
    assert!(document["plane"].is_null());
    for method in ["lsc", "mzc", "mic", "mcc"] {
        let number = |name: &str| document[method][name].as_f64().unwrap();
        let about = [("center_x_mm", 1000.0), ("center_y_mm", -500.0), ("radius_mm", 20.0), ("circularity_mm", 0.02)];
        for (name, value) in about {
            assert!((number(name) - value).abs() < 0.011, "{method} {name}: {}", number(name));
        }
        assert!(number("circularity_mm") >= document["mzc"]["circularity_mm"].as_f64().unwrap());
        let width = number("largest_radius_mm") - number("smallest_radius_mm");
        assert!((width - number("circularity_mm")).abs() < 1e-11);
    }
    let with_burr = run(&bench, &["--json"]).json();
    assert!(with_burr["mzc"]["circularity_mm"].as_f64().unwrap() > 0.15);
    assert_eq!(with_burr["excluded"], 0);
}

#[test]
fn table_names_the_four_circles_and_files_are_asked_for() {
    let bench = bench();
    let before = bench.tree("");
    let ended = run(&bench, &["--exclude-deg=-10:10"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    for part in ["72 points, 3 left out", "least squares (LSC)", "minimum zone (MZC)", "inscribed (MIC)", "(MCC)"] {
        assert!(ended.stdout.contains(part), "{part} in {}", ended.stdout);
    }
    assert_eq!(bench.tree(""), before);

    let written = run(&bench, &["--exclude-deg", "350:10", "--out", "out", "--json"]);
    assert_eq!(
        bench.tree("out").keys().collect::<Vec<_>>(),
        ["circularity.json", "deviations.csv", "manifest.json", "polar.svg", "report.html"]
    );
    assert_eq!(bench.read("out/circularity.json"), written.stdout);
    let deviations = bench.read("out/deviations.csv");
    let mut rows = csv::Reader::from_reader(deviations.as_bytes());
    let header = rows.headers().unwrap().clone();
    let place = |name: &str| header.iter().position(|column| column == name).unwrap();
    let records: Vec<csv::StringRecord> = rows.records().map(Result::unwrap).collect();
    assert_eq!(records.len(), 72);
    let number = |row: &csv::StringRecord, name: &str| row[place(name)].parse::<f64>().unwrap();
    let kept = || records.iter().filter(|row| &row[place("excluded")] == "false");
    assert_eq!(kept().count(), 69);
    let document = written.json();
    for method in ["lsc", "mzc", "mic", "mcc"] {
        let column = format!("{method}_deviation_mm");
        let all = kept().map(|row| number(row, &column));
        let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), d| (l.min(d), h.max(d)));
        assert!((high - low - document[method]["circularity_mm"].as_f64().unwrap()).abs() < 2e-7, "{method}");
    }
    assert!((number(&records[18], "angle_deg") - 90.0).abs() < 0.1 && &records[18][place("line")] == "20");
    let picture = bench.read("out/polar.svg");
    for part in ["Roundness of points.csv", "magnified", "left out, 3 points", "zone circles", "deviation in mm"] {
        assert!(picture.contains(part), "{part}");
    }
    run(&bench, &["--exclude-deg", "350:10", "--out", "again", "--json"]);
    assert_eq!(bench.tree("out"), bench.tree("again"));
}

#[test]
fn points_in_space_are_measured_in_their_plane() {
    let bench = bench();
    let mut text = "label,z_mm,x_mm,y_mm\n".to_owned();
    // A circle of radius 5 mm in the plane z = x, which its projection would show as an ellipse.
    for k in 0..36 {
        let (sine, cosine) = libm::sincos(TAU * f64::from(k) / 36.0);
        let x = 100.0 + 5.0 * cosine / 2.0_f64.sqrt();
        text += &format!("p{k},{x},{x},{}\n", 7.0 + 5.0 * sine);
    }
    bench.write(FILE, &text);
    let document = run(&bench, &["--json", "--out", "out"]).json();
    let close = |value: &serde_json::Value, expected: f64| {
        let value = value.as_f64().unwrap();
        assert!((value - expected).abs() < 1e-10, "{value} {expected}");
    };
    for method in ["lsc", "mzc", "mic", "mcc"] {
        let circle = &document[method];
        let expected = [("center_x_mm", 100.0), ("center_y_mm", 7.0), ("center_z_mm", 100.0), ("radius_mm", 5.0)];
        expected.iter().for_each(|(name, value)| close(&circle[*name], *value));
        close(&circle["circularity_mm"], 0.0);
    }
    close(&document["plane"]["flatness_mm"], 0.0);
    // The file's x and z axes are equally far from the plane; the sign follows the larger component, or the first.
    let normal = document["plane"]["normal"].as_array().unwrap();
    close(&normal[1], 0.0);
    close(&(normal[0].as_f64().unwrap() + normal[2].as_f64().unwrap()).into(), 0.0);
    assert!(
        bench.read("out/deviations.csv").starts_with("point,line,x_mm,y_mm,z_mm,angle_deg,excluded,height_mm,lsc_")
    );
    assert!(run(&bench, &[]).stdout.contains("flatness 0.00000 mm"));
}

#[test]
fn shipped_example_is_what_the_manual_says() {
    let bench = bench();
    bench.copy("tasks/measured-groove.csv", FILE);
    let document = run(&bench, &["--exclude-deg", "354:7", "--json"]).json();
    assert_eq!((document["points"].as_u64(), document["excluded"].as_u64()), (Some(240), Some(9)));
    let ratio =
        document["lsc"]["circularity_mm"].as_f64().unwrap() / document["mzc"]["circularity_mm"].as_f64().unwrap();
    assert!(ratio > 1.0 && ratio < 1.1, "{ratio}");
}

#[test]
fn points_that_are_no_circle_are_refused_by_name() {
    const THREE: &str = "allowed: at least three different points that are not on one straight line";
    let at = format!("error: {FILE}:2: x_mm,y_mm: ");
    refused("x_mm,y_mm\n", &[], &[FILE, "x_mm,y_mm: ", "found 0 different points", THREE]);
    refused("x_mm,y_mm\n1,2\n1,2\n1,2\n", &[], &[&at, "found 1 different points", THREE]);
    refused("x_mm,y_mm\n1,2\n3,2\n1,2\n", &[], &[&at, "found 2 different points", THREE]);
    refused(
        "x_mm,y_mm\n0.1,0.3\n0.2,0.6\n0.3,0.9\n0.7,2.1\n",
        &[],
        &[&at, "one straight line", "found 4 points", THREE],
    );
    refused("x_mm,y_mm,z_mm\n1,2,3\n2,4,6\n3,6,9\n", &[], &["x_mm,y_mm,z_mm: ", "one straight line", THREE]);
    refused("x_mm,y_mm\n0,0\n1,1\n2,0\n3,1\n4,0\n5,1\n", &[], &["a straight line fits", "allowed: points of a circle"]);
}

#[test]
fn cells_and_columns_that_are_wrong_are_refused_at_their_place() {
    refused("x_mm,y_mm\n1,2\n3,NaN\n", &[], &["points.csv:3: y_mm: ", "found 'NaN'", "allowed: a finite"]);
    refused("x_mm,y_mm\n1,2\n3,inf\n", &[], &["points.csv:3: y_mm: ", "found 'inf'", "allowed: a finite"]);
    refused("x_mm\n1\n", &[], &["points.csv:1: y_mm: missing column", "found 'x_mm'", "allowed: "]);
    refused("x_mm,y_mm,y_mm\n1,2,3\n", &[], &["points.csv:1: y_mm: ", "there twice", "allowed: "]);
    refused("x_mm,y_mm\n1,2\n3\n", &[], &["points.csv:3: ", "found 1 values", "allowed: 2 values"]);
    let ended = bench().stead(&["circularity", "absent.csv"]);
    assert_eq!(ended.code, Some(2));
    ended.assert_says(&["error: absent.csv: cannot be read", "allowed: "]);
}

#[test]
fn sectors_that_are_wrong_or_leave_too_little_are_refused() {
    let good = bench().read(FILE);
    for wrong in ["10", "a:b", "10:", "10:nan", "10:20:30", "inf:3", "0:400"] {
        refused(&good, &["--exclude-deg", wrong], &["--exclude-deg", wrong, "allowed: two angles from -360 to 360"]);
    }
    let parts = ["points.csv: --exclude-deg: with 0 of 72 points left", "found 0 different", "allowed: at least three"];
    refused(&good, &["--exclude-deg", "0:360"], &parts);
    refused(&good, &["--exclude-deg", "0:180", "--exclude-deg", "180:351"], &["with 1 of 72 points left", "allowed: "]);
}
