//! `stead score` and `stead explain` from outside, on the published case.

use crate::common::{Bench, Ended, RUN};
use serde_json::Value;
use std::process::Stdio;

/// Caro 2013, Table III, case 1: where our reference values were computed, independently of this program.
const PLACE: [&str; 6] = ["--x-mm", "2.2", "--y-mm", "-1643.5", "--z-mm", "-556.4"];
const Q4: [&str; 2] = ["--q4", "0.9258"];

/// The published grid of 3 deg.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.replace(RUN, "beta_step_deg = 7.2", "beta_step_deg = 3.0");
    bench
}

fn run(bench: &Bench, command: &str, more: &[&[&str]]) -> Ended {
    bench.stead(&[&[command, RUN], &more.concat()[..]].concat())
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[track_caller]
fn assert_near(found: &Value, expected: f64, tolerance: f64) {
    assert!((number(found) - expected).abs() <= tolerance, "{found} and not {expected}");
}

#[test]
fn score_has_the_reference_values() {
    let bench = bench();
    let before = bench.tree("");
    let ended = run(&bench, "score", &[&PLACE, &Q4, &["--json"]]);
    assert_eq!((ended.code, ended.said().as_str()), (Some(0), ""));
    assert_eq!(bench.tree(""), before);
    let document = ended.json();
    assert_eq!(document["feasible"], true);
    let keys = ["x_mm", "y_mm", "z_mm", "q4", "yaw_deg"];
    for (key, expected) in keys.iter().zip([2.2, -1643.5, -556.4, 0.9258, 135.5786]) {
        assert_near(&document["placement"][key], expected, 5e-5);
    }
    assert_eq!(document["placement"].as_object().unwrap().len(), keys.len());
    for (plan, mean) in [("best", 0.5357), ("worst", 0.594)] {
        let plan = &document[plan];
        assert_near(&plan["mean_mm"], mean, 0.01 * mean);
        assert!(number(&plan["max_mm"]) > number(&plan["mean_mm"]));
        let postures: Vec<u64> = plan["postures"].as_array().unwrap().iter().map(|p| p.as_u64().unwrap()).collect();
        assert!(postures.len() == 5 && postures.iter().all(|p| (1..=8).contains(p)), "{postures:?}");
    }

    let table = run(&bench, "score", &[&PLACE, &Q4]);
    assert_eq!((table.code, table.said().as_str()), (Some(0), ""));
    for plan in ["best", "worst"] {
        let row = table.stdout.lines().find(|line| line.starts_with(plan)).unwrap();
        let mean = format!("{:.4}", number(&document[plan]["mean_mm"]));
        assert_eq!(row.split_whitespace().nth(1), Some(mean.as_str()));
    }
}

#[test]
fn yaw_may_be_given_as_q4_or_in_degrees_of_any_turn() {
    let bench = bench();
    // Q4 is the sine of half the yaw.
    let [by_q4, by_yaw, by_turn] = [["--q4", "-0.5"], ["--yaw-deg", "-60"], ["--yaw-deg", "300"]]
        .map(|turn| run(&bench, "score", &[&PLACE, &turn, &["--json"]]));
    assert_eq!((by_q4.code, by_yaw.code, by_turn.code), (Some(0), Some(0), Some(0)), "{}", by_q4.stderr);
    assert_near(&by_yaw.json()["placement"]["q4"], -0.5, 1e-6);
    assert_near(&by_turn.json()["placement"]["yaw_deg"], -60.0, 1e-4);
    for other in [by_yaw, by_turn] {
        for plan in ["best", "worst"] {
            for key in ["mean_mm", "max_mm"] {
                assert_near(&other.json()[plan][key], number(&by_q4.json()[plan][key]), 1.1e-7);
            }
        }
    }
}

#[test]
fn score_out_of_reach_says_which_constraint_fails_where() {
    let bench = bench();
    let far = ["--x-mm", "0", "--y-mm", "-4000", "--z-mm", "-400", "--yaw-deg", "0"];
    let ended = run(&bench, "score", &[&far, &["--json"]]);
    assert_eq!(ended.code, Some(1));
    let document = ended.json();
    assert_eq!(document["feasible"], false);
    assert_eq!((&document["best"], &document["worst"]), (&Value::Null, &Value::Null));
    let finding = &document["findings"][0];
    assert_eq!((&finding["segment"], &finding["first_point"]), (&1.into(), &0.into()));
    assert!(number(&finding["last_point"]) >= 20.0);
    let parts =
        ["note: this placement is outside the cell", "error: nothing is feasible at x = 0.0 mm, y = -4000.0 mm"];
    ended.assert_says(&parts);
    ended.assert_says(&["segment 1, points 0 to 20: no allowed state", " mm beyond the stretched arm"]);

    let table = run(&bench, "score", &[&far]);
    assert_eq!((table.code, table.stdout.as_str()), (Some(1), ""));
    assert_eq!(table.stderr, ended.stderr);

    // A constraint of the cell's own: every point can be reached, but never so well conditioned.
    bench.replace(RUN, "min_inverse_condition = 0.2", "min_inverse_condition = 0.9");
    let ended = run(&bench, "score", &[&PLACE, &Q4]);
    assert_eq!(ended.code, Some(1));
    ended.assert_says(&["1/kappa", " below 0.9", "segment 5, points 84 to 104"]);
    assert!(!ended.stderr.contains("outside the cell"), "{}", ended.stderr);
}

#[test]
fn explain_has_the_reference_state() {
    let bench = bench();
    let ended = run(&bench, "explain", &[&PLACE, &Q4, &["--point", "30", "--beta-deg", "40", "--json"]]);
    assert_eq!((ended.code, ended.said().as_str()), (Some(0), ""));
    let document = ended.json();
    assert_eq!((&document["point"], number(&document["beta_deg"])), (&30.into(), 40.0));
    let postures = document["postures"].as_array().unwrap();
    let numbers: Vec<u64> = postures.iter().map(|p| p["posture"].as_u64().unwrap()).collect();
    assert_eq!(numbers, [1, 2, 3, 4, 5, 6, 7, 8]);
    let third = &postures[2];
    let expected = [-92.6318, 27.4912, -150.7821, -178.7079, 101.6922, 1.5275];
    for (joint, expected) in third["joints_deg"].as_array().unwrap().iter().zip(expected) {
        assert_near(joint, expected, 5.01e-5);
    }
    assert_near(&third["normal_deflection_mm"], 0.839_242_8, 5.01e-8);
    assert_near(&third["inverse_condition"], 0.479_182, 5.01e-7);
    assert_eq!((&third["feasible"], &third["violations"]), (&true.into(), &Value::Array(vec![])));
}

/// Postures that break a limit say so with the amount; here the limits come from the robot file once more.
#[test]
fn explain_tells_what_each_refused_posture_breaks_and_by_how_much() {
    let bench = bench();
    let robot: toml::Table = toml::from_str(&bench.read("configs/robots/kuka-kr270-2.toml")).unwrap();
    let joints = robot["joints"].as_array().unwrap();
    let ended = run(&bench, "explain", &[&PLACE, &Q4, &["--point", "30", "--beta-deg", "40", "--json"]]);
    let (mut refused, mut unreachable) = (0, 0);
    for posture in ended.json()["postures"].as_array().unwrap() {
        let told: Vec<&str> = posture["violations"].as_array().unwrap().iter().map(|v| v.as_str().unwrap()).collect();
        let mut expected = Vec::new();
        let Some(angles) = posture["joints_deg"].as_array() else {
            assert_eq!((posture["feasible"].as_bool(), told.len()), (Some(false), 1), "{posture}");
            assert!(
                told[0].starts_with("wrist centre ") && told[0].contains(" mm beyond the stretched arm"),
                "{told:?}"
            );
            unreachable += 1;
            continue;
        };
        for (number_, (angle, joint)) in (1..).zip(angles.iter().zip(joints)) {
            let angle = number(angle);
            let [min, max] = ["min_deg", "max_deg"].map(|key| joint[key].as_float().unwrap());
            let (limit, side) = if angle > max { (max, "above") } else { (min, "below") };
            if !(min..=max).contains(&angle) {
                let by = (angle - limit).abs();
                expected
                    .push(format!("joint {number_} at {angle:.2} deg is {by:.2} deg {side} its limit {limit:.2} deg"));
            }
        }
        let condition = number(&posture["inverse_condition"]);
        if condition < 0.2 {
            expected.push(format!("1/kappa {condition:.4} is {:.4} below 0.2", 0.2 - condition));
        }
        assert_eq!(told, expected);
        assert_eq!(posture["feasible"], expected.is_empty());
        refused += usize::from(!expected.is_empty());
    }
    assert_eq!((refused, unreachable), (2, 4));

    let table = run(&bench, "explain", &[&PLACE, &Q4, &["--point", "30", "--beta-deg", "40"]]);
    assert_eq!((table.code, table.said().as_str()), (Some(0), ""));
    let rows: Vec<&str> = table.stdout.lines().filter(|l| l.ends_with("allowed") || l.ends_with("refused")).collect();
    assert_eq!(rows.len(), 8);
    assert!(rows[2].ends_with("allowed") && rows[0].ends_with("refused"), "{}", table.stdout);
    assert!(table.stdout.contains("posture 1: joint 2 at -31.66 deg is 31.66 deg below its limit 0.00 deg"));
}

#[test]
fn explain_agrees_with_score_on_a_limit_of_the_deflection() {
    let bench = bench();
    bench.replace(RUN, "[criterion]", "max_deflection_mm = 0.8\n[criterion]");
    let ended = run(&bench, "explain", &[&PLACE, &Q4, &["--point", "30", "--beta-deg", "40", "--json"]]);
    let third = &ended.json()["postures"][2];
    assert_eq!(third["feasible"], false);
    assert_eq!(third["violations"][0], "deflection 0.8392 mm is 0.0392 mm above c_max = 0.8 mm");
    let ended = run(&bench, "score", &[&PLACE, &Q4]);
    assert_eq!(ended.code, Some(1));
    ended.assert_says(&["above c_max = 0.8 mm"]);
}

#[test]
fn a_reader_that_has_gone_away_is_no_failure() {
    let bench = bench();
    let mut command = bench.command(&[&["score", RUN][..], &PLACE, &Q4].concat());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let ended = Ended::from(child.wait_with_output().unwrap());
    assert_eq!((ended.code, ended.said().as_str()), (Some(0), ""));
}

#[test]
fn help_and_version_are_no_failures() {
    let bench = Bench::new();
    let version = bench.stead(&["--version"]);
    assert_eq!(version.code, Some(0));
    assert!(
        version.stdout.starts_with(concat!("stead ", env!("CARGO_PKG_VERSION"), " (commit ")),
        "{}",
        version.stdout
    );
    assert!(version.stdout.contains(std::env::consts::ARCH) && version.stdout.ends_with(")\n"), "{}", version.stdout);
    let help = bench.stead(&["--help"]);
    assert_eq!(help.code, Some(0));
    for command in ["place", "score", "explain"] {
        assert!(help.stdout.lines().any(|line| line.trim_start().starts_with(command)), "{command}");
        let own = bench.stead(&[command, "--help"]);
        assert_eq!((own.code, own.said().as_str()), (Some(0), ""));
        assert!(own.stdout.contains("<CONFIG>") && own.stdout.contains("--json"), "{}", own.stdout);
    }
    let nothing = bench.stead(&[]);
    assert_eq!((nothing.code, nothing.stdout.as_str()), (Some(2), ""));
    nothing.assert_says(&["Usage: stead <COMMAND>"]);
}

#[test]
fn a_tight_corner_needs_a_limit_in_space_and_score_says_so() {
    let bench = bench();
    // A straight wall of 40 mm, a corner of 2 mm radius in steps of 10 deg, and another wall.
    let mut path = String::from(
        "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,force_x_n,force_y_n,force_z_n\n",
    );
    let mut row = |x: f64, y: f64, heading: f64| {
        let (sine, cosine) = libm::sincos(heading);
        path +=
            &format!("1,{x:.6},{y:.6},0,{cosine:.9},{sine:.9},0,0,0,1,{:.6},{:.6},0\n", 80.0 * sine, -80.0 * cosine);
    };
    (0..4).for_each(|k| row(10.0 * f64::from(k), 0.0, 0.0));
    (0..=9).for_each(|k| {
        let turned = f64::from(k) * 10.0_f64.to_radians();
        row(40.0 + 2.0 * libm::sin(turned), 2.0 - 2.0 * libm::cos(turned), turned);
    });
    (1..5).for_each(|k| row(42.0, 2.0 + 10.0 * f64::from(k), 90.0_f64.to_radians()));
    bench.write("tasks/five-segments.csv", &path);
    let ended = run(&bench, "score", &[&PLACE, &Q4]);
    assert_eq!(ended.code, Some(1), "{}", ended.stdout);
    ended.assert_says(&[
        "segment 1, point ",
        "every point has allowed states, but no posture gets here",
        "without rate of beta",
    ]);
    bench.replace(RUN, "max_beta_rate_deg_per_mm", "max_spindle_turn_deg_per_mm");
    let ended = run(&bench, "score", &[&PLACE, &Q4]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
}

/// Both points are in reach, and the straight line between them leads through the foot of the robot.
#[test]
fn a_line_that_the_arm_cannot_follow_is_warned_of() {
    let bench = bench();
    let header = "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,force_x_n,force_y_n,force_z_n";
    let points = "1,0,-1700,0,0,1,0,0,0,1,-60,-40,-20\n1,0,1700,0,0,1,0,0,0,1,-60,-40,-20";
    bench.write("tasks/five-segments.csv", &format!("{header}\n{points}\n"));
    let at = ["--x-mm", "300", "--y-mm", "0", "--z-mm", "-400", "--yaw-deg", "0", "--json"];
    let ended = run(&bench, "score", &[&at]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&[
        "warning: between path points the arm cannot follow the straight line of the tool: best plan to point 1: ",
    ]);
    let document = ended.json();
    assert_eq!(document["best"]["unfollowed_moves"][0]["to_point"], 1);
    let fine = run(&self::bench(), "score", &[&PLACE, &Q4, &["--json"]]).json();
    assert_eq!(fine["best"]["unfollowed_moves"], Value::Array(Vec::new()));
}

/// On a rail the shapes of the cell come nearer as the robot drives towards them: of two pairs that touch the deeper
/// one is named.
#[test]
fn explain_names_the_deepest_pair_of_a_robot_on_a_rail() {
    let bench = bench();
    let bar = |name: &str, height: f64| {
        format!(
            "[[shape]]\nname = '{name}'\nattached = 'base'\nbox_mm = [8000, 8000, {height}]\nxyz_mm = [0, 0, {}]\n",
            -1000.0 + height / 2.0
        )
    };
    let rail = "[[external_axis]]\nname = 'rail'\nkind = 'rail'\ncarries = 'robot'\ndirection = [1, 0, 0]\n\
                range_mm = [300, 900]\nuse = 'fixed'\n";
    let arm = "[[shape]]\nname = 'spindle'\nattached = 'flange'\ncapsule_mm = { radius = 60, length = 100 }\n\
               xyz_mm = [0, 0, 150]\n";
    let text = bench.read(RUN);
    for (deepest, heights) in [("high", [1300.0, 2500.0]), ("low", [2500.0, 1300.0])] {
        let [low, high] = heights;
        let bars = format!("{}{}", bar("low", low), bar("high", high));
        bench.write(RUN, &format!("{text}\n{rail}{arm}{bars}"));
        let ended = run(&bench, "explain", &[&PLACE, &Q4, &["--point", "30", "--beta-deg", "40", "--json"]]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        ended.assert_says(&[
            "note: the external axes are taken as near to zero as their ranges allow: rail at 300.0 mm",
        ]);
        let postures = ended.json()["postures"].clone();
        let told: Vec<&str> = postures
            .as_array()
            .unwrap()
            .iter()
            .flat_map(|posture| posture["violations"].as_array().unwrap())
            .filter_map(Value::as_str)
            .filter(|violation| violation.contains(" touch, limit "))
            .collect();
        assert!(
            !told.is_empty() && told.iter().all(|line| line.starts_with(&format!("spindle and {deepest} touch"))),
            "{told:?}"
        );
    }
}

#[test]
fn explain_says_that_a_point_is_not_scored() {
    let bench = bench();
    let text = bench.read("tasks/five-segments.csv");
    let scored = |(number, line): (usize, &str)| match number {
        0 => format!("{line},scored"),
        31 => format!("{line},0"),
        _ => format!("{line},1"),
    };
    let lines: Vec<String> = text.lines().enumerate().map(scored).collect();
    bench.write("tasks/five-segments.csv", &(lines.join("\n") + "\n"));
    let at = |point: &str| run(&bench, "explain", &[&PLACE, &Q4, &["--point", point, "--beta-deg", "40", "--json"]]);
    at("30").assert_says(&["note: point 30 is not scored: it is followed"]);
    assert!(!at("31").stderr.contains("is not scored"));
}

/// The published case with a small search and its results in the folder `out`.
fn placed() -> Bench {
    let bench = Bench::new();
    let ended = bench.stead(&["place", RUN, "--out", "out"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    bench
}

#[test]
fn explain_takes_the_placement_of_results() {
    let bench = placed();
    let ended = bench.stead(&["explain", RUN, "--placement-of", "out", "--point", "30", "--beta-deg", "40", "--json"]);
    assert_eq!((ended.code, ended.said().as_str()), (Some(0), ""));
    let summary: Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
    assert_eq!(ended.json()["placement"], summary["cases"][0]["placement"]);
    let worst = ["explain", RUN, "--placement-of", "out", "--case", "3", "--point", "30", "--beta-deg", "40", "--json"];
    assert_eq!(bench.stead(&worst).json()["placement"], summary["cases"][2]["placement"]);
    let both = ["explain", RUN, "--placement-of", "out", "--x-mm", "1", "--point", "30", "--beta-deg", "40"];
    assert_eq!(bench.stead(&both).code, Some(2));
}

/// Comments, names, the search and the output may change, with a note; what a score depends on may not.
#[test]
fn the_placement_of_results_may_be_scored_by_a_run_file_that_says_the_same() {
    let bench = placed();
    let score = |bench: &Bench| bench.stead(&["score", RUN, "--placement-of", "out", "--json"]);
    let before = score(&bench);
    assert_eq!((before.code, before.said().as_str()), (Some(0), ""));
    let text = bench.read(RUN);
    bench.write(RUN, &format!("# A comment.\n{text}"));
    let ended = score(&bench);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&["note: run.toml is not as it was for these results: its comments and layout changed"]);
    assert_eq!(ended.json()["best"], before.json()["best"]);
    bench.copy("configs/robots/kuka-kr270-2.toml", "configs/robots/same.toml");
    bench.replace(RUN, "robots/kuka-kr270-2.toml", "robots/same.toml");
    bench.replace(RUN, "seed = 1 ", "seed = 2 ");
    bench.write(RUN, &format!("{}\n[output]\nmaps = false\n", bench.read(RUN)));
    let ended = score(&bench);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&["these results: output.maps, robot, search.seed changed"]);
    let noted = ended.json()["notes"].to_string();
    assert!(noted.contains("output.maps, robot, search.seed changed"), "{noted}");
    bench.replace(RUN, "min_inverse_condition = 0.2", "min_inverse_condition = 0.25");
    let ended = score(&bench);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""));
    ended.assert_says(&[
        "out/summary.json: run_file.constraints.min_inverse_condition: comes from a run file with another \
         constraints.min_inverse_condition: run.toml has 0.25, found 0.2; allowed: ",
    ]);
}
