//! `stead identify fit` from outside: what it prints and writes, and what it refuses.

use crate::common::{Bench, Ended};
use stead_model::robot::Compliance;

mod full;
mod shipped_full;
mod unidentifiable;

const CONFIG: &str = "configs/identify-example.toml";
const SHEET: &str = "tasks/identify-example.csv";
const ROBOT: &str = "configs/robots/kuka-kr270-2.toml";

/// A bench with the shipped example.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.copy_all(&[CONFIG, SHEET]);
    bench
}

fn fit(bench: &Bench, more: &[&str]) -> Ended {
    bench.stead(&[&["identify", "fit", CONFIG, "--out", "out"], more].concat())
}

/// The fields of a line of the sheet, from 1, changed.
fn change(bench: &Bench, line: usize, edit: impl Fn(&mut Vec<String>)) {
    let text = bench.read(SHEET);
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let mut fields: Vec<String> = lines[line - 1].split(',').map(str::to_owned).collect();
    edit(&mut fields);
    lines[line - 1] = fields.join(",");
    bench.write(SHEET, &(lines.join("\n") + "\n"));
}

/// Asserts exit code 2 with all of some parts, nothing on standard output and no file written.
#[track_caller]
fn refused(bench: &Bench, parts: &[&str]) {
    let before = bench.tree("");
    let ended = fit(bench, &["--json"]);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
    assert!(ended.stderr.starts_with("error: ") && !ended.stderr.contains("panicked"), "{}", ended.stderr);
    ended.assert_says(parts);
    ended.assert_says(&["; allowed: "]);
    assert_eq!(bench.tree(""), before);
}

/// Compliances of the arm behind the example. urad/(N m)
const TRUTH: [f64; 6] = [0.54, 0.3, 0.42, 2.79, 3.48, 2.074];

#[test]
fn the_example_is_identified_and_its_robot_file_keeps_the_rest() {
    let bench = bench();
    let ended = fit(&bench, &["--json"]);
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""));
    let document = ended.json();
    let compliances = document["compliances"].as_array().unwrap();
    assert_eq!(compliances.len(), 10);
    for entry in compliances {
        let joint = entry["joint"].as_u64().unwrap() as usize;
        assert_eq!(entry.get("q2_deg").is_some(), joint == 2);
        if joint != 2 {
            let off = entry["urad_per_nm"].as_f64().unwrap() - TRUTH[joint - 1];
            assert!(off.abs() < 3.0 * entry["std_urad_per_nm"].as_f64().unwrap(), "{entry}");
        }
    }
    let spring = &document["compensator"];
    for (name, truth) in [("spring_stiffness_n_per_mm", 4000.0), ("free_length_mm", 600.0)] {
        let off = spring[name].as_f64().unwrap() - truth;
        assert!(off.abs() < 3.0 * spring[format!("std_{name}")].as_f64().unwrap(), "{spring}");
    }
    assert_eq!(document["outliers"].as_array().unwrap().len(), 0);
    let residual = document["residual_rms_mm"].as_f64().unwrap();
    assert!((0.036..0.048).contains(&residual), "{residual}: sqrt(2) times 0.03 is expected");
    assert_eq!(serde_json::from_str::<serde_json::Value>(&bench.read("out/report.json")).unwrap(), document);
    assert_eq!(bench.read("out/residuals.csv").lines().count(), 61);
    assert_eq!(bench.read("out/compliances.csv").lines().count(), 19);
    assert!(bench.read("out/deflections.svg").contains("</svg>"));

    // Every line of the user's file is there, in order, but those of compliances and the one that names the schema,
    // which is true in the folder of that file alone.
    let (old, new) = (bench.read(ROBOT), bench.read("out/robot-identified.toml"));
    assert!(old.starts_with("#:schema ") && !new.contains("#:schema"));
    let mut lines = new.lines();
    for line in old.lines().skip(1).filter(|line| !line.starts_with("stiffness_mnm_per_rad")) {
        assert!(lines.any(|new| new == line), "{line} is not kept");
    }
    assert!(new.contains("# as printed, see above"));
    let parsed: toml::Table = new.parse().unwrap();
    let names = parsed["covariance"]["parameters"].as_array().unwrap();
    assert_eq!(names.len(), 8);
    assert_eq!(names[2].as_str(), Some("joints[2].compensator.spring_stiffness_n_per_mm"));
    let entry = |i: usize, j: usize| parsed["covariance"]["matrix"][i][j].as_float().unwrap();
    for i in 0..8 {
        let deviation = document["arm"][i]["std"].as_f64().unwrap();
        assert!((libm::sqrt(entry(i, i)) / deviation - 1.0).abs() < 1e-9);
        assert!((0..8).all(|j| entry(i, j) == entry(j, i)));
    }
    assert!(fit(&bench, &[]).stdout.contains("predicting a configuration from the others"));
}

#[test]
fn the_robot_file_is_one_that_can_be_read_again() {
    let bench = bench();
    assert_eq!(fit(&bench, &[]).code, Some(0));
    bench.write("arm.toml", &bench.read("out/robot-identified.toml"));
    let robot = stead_format::read_robot(&bench.path("arm.toml")).unwrap();
    let Compliance::Compensated { alone, compensator } = robot.joints()[1].compliance else {
        panic!("{:?}", robot.joints()[1]);
    };
    assert!((alone * 1e6 - 0.3).abs() < 0.01 && compensator.a == 0.75);
    // The covariance goes on into the score of a placement.
    bench.replace(crate::common::RUN, "robots/kuka-kr270-2.toml", "../arm.toml");
    let place = ["--x-mm", "2.2", "--y-mm", "-1643.5", "--z-mm", "-556.4", "--q4", "0.9258", "--json"];
    let score = || bench.stead(&[&["score", crate::common::RUN], &place[..]].concat()).json()["best"].clone();
    let plain = score();
    let (mean, deviation) = (plain["mean_mm"].as_f64().unwrap(), plain["mean_std_mm"].as_f64().unwrap());
    assert!(deviation > 1e-4 * mean && deviation < 0.1 * mean, "{plain}");
    bench.replace(crate::common::RUN, "force_uncertainty = 0.0", "force_uncertainty = 0.0\nconfidence = 2.0");
    assert!(score()["mean_mm"].as_f64().unwrap() > mean);
    // What stead has written it can start from: the compensator's geometry is that of the robot file now.
    let config = bench.read(CONFIG).replace("robots/kuka-kr270-2.toml", "../arm.toml");
    let table = config.find("[compensator]").unwrap()..config.find("# [base]").unwrap();
    bench.write(CONFIG, &config.replace(&config[table], ""));
    assert_eq!(fit(&bench, &[]).code, Some(0));
    assert_eq!(bench.read("out/robot-identified.toml").matches("[joints.compensator]").count(), 1);
}

/// What is measured is the arm's own, where the loads show all joints.
#[test]
fn a_measured_stiffness_is_borrowed_no_longer() {
    let bench = bench();
    let text = bench.read(ROBOT);
    let at = text.find("\nname = ").unwrap() + 1;
    bench.write(ROBOT, &format!("{}stiffness_like = 'KUKA KR500'\n{}", &text[..at], &text[at..]));
    let ended = fit(&bench, &[]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let parsed: toml::Table = bench.read("out/robot-identified.toml").parse().unwrap();
    assert!(!parsed.contains_key("stiffness_like"), "{parsed:?}");
    assert_eq!(parsed["name"], text.parse::<toml::Table>().unwrap()["name"]);
}

#[test]
fn outliers_are_named_by_line() {
    let bench = bench();
    for line in [5, 23, 40] {
        change(&bench, line, |fields| fields[18] = format!("{:.3}", fields[18].parse::<f64>().unwrap() + 1.0));
    }
    let document = fit(&bench, &["--json"]).json();
    let lines: Vec<u64> =
        document["outliers"].as_array().unwrap().iter().map(|outlier| outlier["line"].as_u64().unwrap()).collect();
    assert_eq!(lines, [5, 23, 40]);
    assert!(fit(&bench, &[]).stdout.contains("outlier left out: line 23, configuration c8, point p1: "));
}

#[test]
fn bad_sheets_are_refused_at_their_line_and_column() {
    type Edit = fn(&mut Vec<String>);
    let cases: [(usize, Edit, &[&str]); 10] = [
        (4, |f| f[15] = "nan".to_owned(), &["identify-example.csv:4: unloaded_y_mm: ", "finite", "'nan'"]),
        (4, |f| f[17] = String::new(), &["identify-example.csv:4: loaded_x_mm: ", "finite", "''"]),
        (
            5,
            |f| f[3] = "29.5".to_owned(),
            &[":5: theta3_deg: ", "limits of the joint", "'29.5'", "-245.0000 to 29.0000"],
        ),
        (6, |f| f[4] = "351".to_owned(), &[":6: theta4_deg: ", "limits of the joint", "'351'"]),
        (7, |f| f[7..13].fill("0".to_owned()), &[":7: force_x_n: ", "all zero", "a load"]),
        (8, |f| (14..17).for_each(|k| f[k + 3] = f[k].clone()), &[":8: loaded_x_mm: ", "is the unloaded one"]),
        (9, |f| f[13] = "p1".to_owned(), &[":9: point: ", "line 8 has this point", "'p1'"]),
        (10, |f| f[0] = "c4".to_owned(), &[":11: configuration: ", "of line 10", "other joint angles", "'c4'"]),
        (11, |f| f[13] = String::new(), &[":11: point: ", "is blank"]),
        (
            12,
            |f| (17..20).for_each(|k| f[k] = (f[k].parse::<f64>().unwrap() / 1e3).to_string()),
            &[":12: loaded_x_mm: ", "deflection of", "the load could cause", "millimetres"],
        ),
    ];
    for (line, edit, parts) in cases {
        let bench = bench();
        change(&bench, line, edit);
        // The line above the one whose name changes belongs to another configuration then.
        refused(&bench, parts);
    }
}

/// Every line of the sheet but the header changed.
fn change_all(bench: &Bench, edit: impl Fn(&mut Vec<f64>)) {
    for line in 2..=61 {
        change(bench, line, |fields| {
            let mut read: Vec<f64> = fields[14..20].iter().map(|text| text.parse().unwrap()).collect();
            edit(&mut read);
            (0..6).for_each(|k| fields[14 + k] = format!("{:.4}", read[k]));
        });
    }
}

#[test]
fn sheets_that_do_not_belong_to_the_arm_are_refused_with_what_to_look_at() {
    let mirrored = bench();
    change_all(&mirrored, |read| {
        read.swap(0, 1);
        read.swap(3, 4);
    });
    refused(
        &mirrored,
        &["unloaded_x_mm: the unloaded readings are ", "away from where the joint angles", "right-handed"],
    );
    let exchanged = bench();
    change_all(&exchanged, |read| read.rotate_left(3));
    refused(&exchanged, &["identify-example.csv:2: force_x_n: ", "comes out as -", "against its load"]);
    let misplaced = bench();
    change(&misplaced, 40, |fields| {
        fields[14] = (fields[14].parse::<f64>().unwrap() + 1e3).to_string();
        fields[17] = (fields[17].parse::<f64>().unwrap() + 1e3).to_string();
    });
    refused(&misplaced, &["identify-example.csv:40: unloaded_x_mm: "]);
}

/// Asserts one warning with all of some parts, in the document and in the text.
#[track_caller]
fn warns(bench: &Bench, parts: &[&str]) {
    let document = fit(bench, &["--json"]).json();
    let warnings: Vec<&str> = document["warnings"].as_array().unwrap().iter().map(|w| w.as_str().unwrap()).collect();
    let warning = warnings.iter().find(|warning| parts.iter().all(|part| warning.contains(part)));
    let warning = warning.unwrap_or_else(|| panic!("{parts:?} are not in {warnings:?}"));
    assert!(fit(bench, &[]).stdout.contains(&format!("warning: {warning}\n")));
}

#[test]
fn what_error_bars_do_not_count_is_told() {
    let bench = bench();
    assert!(!fit(&bench, &[]).stdout.contains("warning: "));
    assert_eq!(fit(&bench, &["--json"]).json()["warnings"], serde_json::json!([]));
    // Off by 5 mm, without and with the load.
    change(&bench, 40, |fields| {
        fields[14] = (fields[14].parse::<f64>().unwrap() + 5.0).to_string();
        fields[17] = (fields[17].parse::<f64>().unwrap() + 5.0).to_string();
    });
    assert!(fit(&bench, &[]).stdout.contains("warning: line 40: the unloaded reading is 4."));

    let bench = self::bench();
    // The first configuration again under another name, with other readings under the same load.
    let mut text = bench.read(SHEET);
    let again: String = text.lines().skip(1).take(3).map(|line| line.replacen("c1,", "again,", 1) + "\n").collect();
    text += &again;
    bench.write(SHEET, &text);
    warns(&bench, &["lines 2, 62 (and 2 more such groups) share one unloaded reading", "1.22 times"]);

    let bench = self::bench();
    for line in 2..=61 {
        change(&bench, line, |fields| {
            (7..10).for_each(|k| fields[k] = (fields[k].parse::<f64>().unwrap() / 9.81).to_string());
        });
    }
    warns(&bench, &[" times those of the robot file (median): are forces in N"]);
}

#[test]
fn an_orientation_that_is_there_twice_is_noted() {
    let bench = bench();
    let text = bench.read(SHEET);
    let names: Vec<String> = ["unloaded", "loaded"]
        .iter()
        .flat_map(|state| ["rx", "ry", "rz"].map(|axis| format!("{state}_{axis}_deg")))
        .collect();
    let wide: String = text
        .lines()
        .enumerate()
        .map(
            |(k, line)| {
                if k == 0 { format!("{line},{}\n", names.join(",")) } else { format!("{line},0,0,0,0,0,0.01\n") }
            },
        )
        .collect();
    bench.write(SHEET, &wide);
    bench.replace(CONFIG, "# noise_mm = 0.03 ", "noise_mm = 0.03\nnoise_deg = 1 # ");
    warns(&bench, &["40 rows repeat the orientation of another point"]);
}

#[test]
fn sheets_that_tell_too_little_are_refused() {
    let only = |keep: fn(usize) -> bool| {
        let bench = bench();
        let text = bench.read(SHEET);
        let kept: Vec<&str> = text.lines().enumerate().filter(|(k, _)| *k == 0 || keep(*k)).map(|(_, l)| l).collect();
        bench.write(SHEET, &(kept.join("\n") + "\n"));
        bench
    };
    refused(&only(|_| false), &["identify-example.csv:1: ", "no measurements"]);
    refused(&only(|k| k <= 3), &["9 unloaded coordinates", "15 unknowns", "more configurations"]);
    refused(&only(|k| (k - 1) / 3 % 5 < 2), &["theta2_deg", "2 distinct angles of joint 2", "three or more"]);

    let bench = bench();
    let text = bench.read(SHEET);
    let metres: Vec<String> = text
        .lines()
        .enumerate()
        .map(|(k, line)| {
            let field = |(at, text): (usize, &str)| match text.parse::<f64>() {
                Ok(value) if at >= 14 => (value / 1e3).to_string(),
                _ => text.to_owned(),
            };
            if k == 0 { line.to_owned() } else { line.split(',').enumerate().map(field).collect::<Vec<_>>().join(",") }
        })
        .collect();
    bench.write(SHEET, &(metres.join("\n") + "\n"));
    refused(&bench, &["unloaded_x_mm", "spread over", "millimetres"]);
}

#[test]
fn bad_configs_are_refused_at_their_line() {
    for (from, to, parts) in [
        ("# hold = [4, 6]", "hold = [0]", &["fit.hold[1]: ", "found 0", "from 1 to 6"][..]),
        ("# hold = [4, 6]", "hold = [4, 7]", &["fit.hold[2]: ", "found 7", "from 1 to 6"]),
        ("# hold = [4, 6]", "hold = [4, 4]", &["fit.hold[2]: is there twice", "found 4", "each once"]),
        ("# hold = [4, 6]", "hold = [4.5]", &["fit.hold[1]: is not a whole number", "found 4.5"]),
        ("# hold = [4, 6]", "hold = 4", &["fit.hold: ", "found 4", "one or more whole numbers from 1 to 6"]),
        ("# hold = [4, 6]", "hold = []", &["fit.hold: ", "one or more whole numbers from 1 to 6"]),
        ("# hold = [4, 6]", "hold = [1, 2, 3, 4, 5, 6]", &["fit.hold: holds every joint", "one to five joints"]),
        ("load_point_mm = [250.0,", "load_point_mm = [inf,", &[":10: load_point_mm[1]: ", "found inf"]),
        ("# noise_mm = 0.03 ", "noise_mm = 0 # ", &["noise_mm: ", "found 0", "above 0"]),
        ("sheet = \"../tasks", "sheet = \"../tusks", &[":9: sheet: ", "cannot be read", "tusks"]),
        ("joint = 2", "joint = 7", &["compensator.joint: ", "found 7", "from 1 to 6"]),
        ("l_mm = 250.0", "l_mm = 750.0", &["compensator.l_mm: ", "meet", "found 750.0"]),
        ("reduce = false", "redoce = false", &["fit.redoce: ", "nearest known one: reduce"]),
        ("angle_tolerance_deg = 0.05", "angle_tolerance_deg = -1", &["fit.angle_tolerance_deg: ", "found -1"]),
    ] {
        let bench = bench();
        bench.replace(CONFIG, from, to);
        refused(&bench, parts);
    }
    let bench = bench();
    bench.replace(SHEET, "point,", "point,unloaded_rx_deg,");
    refused(&bench, &[":1: unloaded_ry_deg: ", "missing column"]);
}
