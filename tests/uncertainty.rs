//! A robot file that says how well its compliances are known: `stead score`, `explain` and `place` from outside.

use crate::common::{Bench, RUN};
use serde_json::Value;

const ROBOT: &str = "configs/robots/kuka-kr270-2.toml";
const PLACE: [&str; 8] = ["--x-mm", "2.2", "--y-mm", "-1643.5", "--z-mm", "-556.4", "--q4", "0.9258"];

/// All compliances known to 10 % by one common error: a measured force that is off by as much.
fn common_error() -> String {
    let compliances = [0.237, 3.32, 2.79, 0.486, 0.521, 0.38].map(|stiffness| 1.0 / stiffness);
    let names = (1..=6).map(|joint| format!("'joints[{joint}].compliance_urad_per_nm'")).collect::<Vec<_>>().join(", ");
    let row = |a: f64| compliances.map(|b| format!("{}", 0.01 * a * b)).join(", ");
    let rows = compliances.map(|a| format!("    [{}],\n", row(a))).concat();
    format!("\n[covariance]\nparameters = [{names}]\nmatrix = [\n{rows}]\n")
}

/// Joint 4 alone is uncertain, and very much so.
const FOURTH_JOINT: &str = "
[covariance]
parameters = ['joints[4].compliance_urad_per_nm']
matrix = [[4.0]]
";

fn bench(covariance: &str) -> Bench {
    let bench = Bench::new();
    bench.write(ROBOT, &format!("{}{covariance}", bench.read(ROBOT)));
    bench
}

fn score(bench: &Bench) -> Value {
    let ended = bench.stead(&[&["score", RUN], &PLACE[..], &["--json"]].concat());
    assert_eq!((ended.code, ended.said().as_str()), (Some(0), ""));
    ended.json()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn score_states_how_well_the_mean_is_known_and_covers_it_on_request() {
    let bare = score(&Bench::new());
    let bench = bench(&common_error());
    let known = score(&bench);
    for plan in ["best", "worst"] {
        assert!(bare[plan].get("mean_std_mm").is_none());
        assert_eq!(bare[plan]["mean_mm"], known[plan]["mean_mm"]);
        // What scales all compliances by 10 % scales the mean by 10 %.
        let share = number(&known[plan]["mean_std_mm"]) / number(&known[plan]["mean_mm"]);
        assert!((share - 0.1).abs() < 1e-6, "{share}");
    }
    // Every c_i has the same relative error, so that covering two of them makes every score 1.2 c_i, of the same plans.
    bench.replace(RUN, "force_uncertainty = 0.0", "force_uncertainty = 0.0\nconfidence = 2.0");
    let covered = score(&bench);
    for plan in ["best", "worst"] {
        let ratio = number(&covered[plan]["mean_mm"]) / number(&known[plan]["mean_mm"]);
        assert!((ratio - 1.2).abs() < 1e-5, "{ratio}");
        let ratio = number(&covered[plan]["mean_std_mm"]) / number(&known[plan]["mean_std_mm"]);
        assert!((ratio - 1.0).abs() < 1e-4, "{ratio}");
    }
    let table = bench.stead(&[&["score", RUN], &PLACE[..]].concat()).stdout;
    let row = table.lines().find(|line| line.starts_with("best")).unwrap();
    assert!(table.contains("std mm"), "{table}");
    let expected = format!("{:.4}", number(&covered["best"]["mean_std_mm"]));
    assert_eq!(row.split_whitespace().nth(5), Some(expected.as_str()));

    let arguments = [&["explain", RUN], &PLACE[..], &["--point", "30", "--beta-deg", "40"]].concat();
    let third = &bench.stead(&[&arguments[..], &["--json"]].concat()).json()["postures"][2];
    let [c, deviation, score] = ["normal_deflection_mm", "std_mm", "score_mm"].map(|key| number(&third[key]));
    assert!((deviation - 0.1 * c).abs() < 2e-9 && (score - 1.2 * c).abs() < 3e-9, "{third}");
    assert!(bench.stead(&arguments).stdout.contains("std mm"));
}

#[test]
fn place_reports_deviations_and_a_confident_search_finds_a_place_that_is_better_covered() {
    let columns = |bench: &Bench, file: &str, name: &str| -> Vec<f64> {
        let text = bench.read(file);
        let mut lines = text.lines();
        let at = lines.next().unwrap().split(',').position(|column| column == name);
        let at = at.unwrap_or_else(|| panic!("no column {name} in {file}"));
        lines.map(|line| line.split(',').nth(at).unwrap().parse().unwrap()).collect()
    };
    let bench = bench(FOURTH_JOINT);
    bench.replace(RUN, "beta_step_deg = 7.2", "beta_step_deg = 12.0");
    bench.replace(RUN, "generations = 3\nbasins = 2\n", "generations = 1\nbasins = 1\n");
    assert_eq!(bench.stead(&["place", RUN, "--out", "plain", "--json"]).code, Some(0));
    bench.replace(RUN, "force_uncertainty = 0.0", "confidence = 3.0");
    let ended = bench.stead(&["place", RUN, "--out", "covered", "--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let document = ended.json();
    for (folder, confidence) in [("plain", 0.0), ("covered", 3.0)] {
        let at = |file: &str, name: &str| columns(&bench, &format!("{folder}/{file}"), name);
        let [normal, score, deviation] = ["normal_mm", "score_mm", "std_mm"].map(|name| at("best.csv", name));
        for ((normal, score), deviation) in normal.iter().zip(&score).zip(&deviation) {
            assert!((score - normal.abs() - confidence * deviation).abs() < 4e-7, "{score} {normal} {deviation}");
        }
        let mean = at("placements.csv", "mean_std_mm");
        // Points err together at the most.
        assert!(mean[0] > 0.0 && mean[0] <= deviation.iter().sum::<f64>() / deviation.len() as f64 + 1e-7);
        let summary: Value = serde_json::from_str(&bench.read(&format!("{folder}/summary.json"))).unwrap();
        assert_eq!(number(&summary["criterion"]["confidence"]), confidence);
        assert_eq!(number(&summary["cases"][0]["mean_std_mm"]), mean[0]);
    }
    assert!(document["cases"][0]["plan"][7]["std_mm"].is_number());
    let covered = |folder: &str| {
        let [normal, deviation] =
            ["normal_mm", "std_mm"].map(|name| columns(&bench, &format!("{folder}/best.csv"), name));
        normal.iter().zip(&deviation).map(|(normal, deviation)| normal.abs() + 3.0 * deviation).sum::<f64>()
    };
    assert!(covered("covered") < 0.9 * covered("plain"), "{} {}", covered("covered"), covered("plain"));
}

#[test]
fn what_cannot_be_covered_is_refused() {
    let refused = |bench: &Bench, parts: &[&str]| {
        let before = bench.tree("");
        let ended = bench.stead(&["place", RUN, "--out", "out"]);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
        ended.assert_says(parts);
        assert_eq!(bench.tree(""), before);
    };
    let unknown = Bench::new();
    let line = unknown.replace(RUN, "force_uncertainty = 0.0", "confidence = 2.0");
    let place = format!("error: {RUN}:{line}: criterion.confidence: asks for standard deviations");
    refused(&unknown, &[&place, "no table [covariance]", "found 2.0; allowed: 0, or a robot file"]);
    for value in ["-1.0", "10.5", "nan"] {
        let bench = bench(FOURTH_JOINT);
        bench.replace(RUN, "force_uncertainty = 0.0", &format!("confidence = {value}"));
        refused(&bench, &["criterion.confidence: ", &format!("found {value}"), "allowed: a number from 0 to 10"]);
    }
    let indefinite = FOURTH_JOINT.replace("4.0", "-4.0");
    let line = bench("").read(ROBOT).lines().count() + 4;
    let place = format!("error: configs/robots/kuka-kr270-2.toml:{line}: covariance.matrix[1][1]: ");
    refused(&bench(&indefinite), &[&place, "variance below 0", "found -4.0"]);
    let elsewhere = FOURTH_JOINT.replace("compliance_urad_per_nm", "compensator.free_length_mm");
    refused(
        &bench(&elsewhere),
        &["covariance.parameters[1]: is of a compensator, but joint 4 has none", "allowed: joints[1]"],
    );
}
