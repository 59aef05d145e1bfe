//! Calm programs from outside: joint travel in the results, its weight in the objective, and a spindle that stays.

use crate::common::{Bench, RUN};
use crate::place::Rows;
use serde_json::Value;
use stead_model::testing::some;

const PLACE: [&str; 9] = ["--x-mm", "2.2", "--y-mm", "-1643.5", "--z-mm", "-556.4", "--q4", "0.9258", "--json"];

const ROBOT: &str = "configs/robots/kuka-kr270-2.toml";

fn number(value: &Value, pointer: &str) -> f64 {
    value.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer} in {value}"))
}

/// What the best plan at a placement comes to.
fn scored(bench: &Bench) -> Value {
    let ended = bench.stead(&[&["score", RUN], &PLACE[..]].concat());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.json()
}

/// Joint travel of a plan file, its largest step, and the largest turn of a joint within 25 mm. deg
fn travelled(plan: &str) -> [f64; 3] {
    let rows = Rows::of(plan);
    let joints: [Vec<f64>; 6] = std::array::from_fn(|j| rows.column(&format!("theta{}_deg", j + 1)));
    let segments = rows.column("segment");
    let place = ["x_mm", "y_mm", "z_mm"].map(|name| rows.column(name));
    let step = |i: usize| place.iter().map(|place| (place[i] - place[i - 1]).powi(2)).sum::<f64>().sqrt();
    let follows = |i: usize| segments[i] == segments[i - 1];
    let steps = || {
        let of = |i: usize| joints.each_ref().map(|angles| (angles[i] - angles[i - 1]).abs());
        (1..segments.len()).filter(|i| follows(*i)).flat_map(of)
    };
    let mut swing = 0.0_f64;
    for from in 0..segments.len() {
        let mut length = 0.0;
        for to in (from + 1..segments.len()).take_while(|to| segments[*to] == segments[from]) {
            length += step(to);
            if length < 25.0 || to == from + 1 {
                swing = joints.iter().map(|angles| (angles[to] - angles[from]).abs()).fold(swing, f64::max);
            }
        }
    }
    [steps().sum(), steps().fold(0.0, f64::max), swing]
}

#[test]
fn joint_travel_is_in_the_tables_the_summary_and_the_notes() {
    let bench = Bench::new();
    bench.replace(RUN, "[reference]", "[output]\nmaps = false\n[reference]");
    // So fast that the spindle swings.
    bench.replace(RUN, "max_beta_rate_deg_per_mm = 0.9", "max_beta_rate_deg_per_mm = 9.0");
    let slow = bench.read(ROBOT);
    let without: String =
        slow.lines().filter(|line| !line.starts_with("max_speed")).map(|l| format!("{l}\n")).collect();
    bench.write(ROBOT, &without);
    let ended = bench.stead(&["place", RUN, "--out", "out", "--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let cases = ended.json()["cases"].clone();
    let table = Rows::of(&bench.read("out/placements.csv"));
    let [total, largest] = ["joint_travel_deg", "max_joint_step_deg"].map(|name| table.column(name));
    let plans = ["best.csv", "best-worst-plan.csv", "worst.csv", "worst-worst-plan.csv"];
    for (case, plan) in plans.into_iter().enumerate() {
        let [sum, most, swing] = travelled(&bench.read(&format!("out/{plan}")));
        assert!((total[case] - sum).abs() < 0.05 && (largest[case] - most).abs() < 3e-4, "{plan}: {sum} {most}");
        let stated = |key: &str| number(&cases, &format!("/{case}/joint_travel/{key}"));
        assert_eq!((stated("total_deg"), stated("max_step_deg")), (total[case], largest[case]));
        assert!((stated("largest_turn/turn_deg") - swing).abs() < 3e-4, "{plan}: {swing}");
        assert!(stated("largest_turn/length_mm") <= 25.0);
    }
    let [joint, turn, length] =
        ["joint", "turn_deg", "length_mm"].map(|key| number(&cases, &format!("/0/joint_travel/largest_turn/{key}")));
    assert!(turn > 45.0, "{turn}");
    let note = format!("note: axis {joint} turns by {turn:.0} deg within {length:.0}");
    assert!(ended.stderr.contains(&note), "{note} in {}", ended.stderr);
    let summary: Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
    assert!(summary["notes"].to_string().contains(&note[6..]), "{}", summary["notes"]);
    let page = bench.read("out/report.html");
    assert!(page.contains("Joint travel") && page.contains("joint_travel"));
    let text = bench.stead(&[&["score", RUN], &PLACE[..8]].concat()).stdout;
    assert!(text.contains("the best plan turns the joints by "), "{text}");
}

#[test]
fn a_weight_on_joint_travel_is_in_the_objective_and_makes_calmer_plans() {
    let bench = Bench::new();
    let free = scored(&bench);
    let weighed = |weight: &str| {
        let line = format!("joint_travel_weight_mm_per_rad = {weight}");
        let bench = Bench::new();
        bench.replace(RUN, "force_uncertainty = 0.0", &line);
        scored(&bench)
    };
    let mut last = number(&free, "/best/joint_travel/total_deg");
    assert_eq!(free["best"]["objective_mm"], free["best"]["mean_mm"]);
    for weight in ["0.02", "0.2", "2"] {
        let found = weighed(weight);
        let best = |key: &str| number(&found, &format!("/best/{key}"));
        let travel = best("joint_travel/total_deg");
        assert!(travel < last, "{travel} {last}");
        assert!(best("mean_mm") >= number(&free, "/best/mean_mm") * (1.0 - 1e-6));
        let added = weight.parse::<f64>().unwrap() * travel.to_radians() / (best("joint_travel/length_mm") / 10.0);
        assert!((best("objective_mm") - best("mean_mm") - added).abs() < 2e-7, "{added} {found}");
        // The worst plan is that of the largest scores alone.
        assert_eq!(found["worst"]["mean_mm"], free["worst"]["mean_mm"]);
        last = travel;
    }
    // What the search finds with a weight is no worse by its objective than what it finds without.
    bench.replace(RUN, "generations = 3\nbasins = 2", "generations = 0\nbasins = 1");
    bench.replace(RUN, "[reference]", "[output]\nmaps = false\npage = false\n[reference]");
    bench.replace(RUN, "force_uncertainty = 0.0", "joint_travel_weight_mm_per_rad = 0.2");
    let ended = bench.stead(&["place", RUN, "--out", "out", "--certify", "60", "--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&["no certificate for the worst placement: the objective has the travel of the joints in it"]);
    let certificate: Value = serde_json::from_str(&bench.read("out/certificate.json")).unwrap();
    let relaxed = certificate["best"]["limits_relaxed"].to_string();
    assert!(relaxed.contains("travel of the joints in the objective"), "{relaxed}");
    let case = ended.json()["cases"][0].clone();
    let added =
        0.2 * number(&case, "/joint_travel/total_deg").to_radians() / (number(&case, "/joint_travel/length_mm") / 10.0);
    assert!((number(&case, "/objective_mm") - number(&case, "/mean_mm") - added).abs() < 2e-7);
    let at = ["--placement-of", "out", "--json"];
    let again = bench.stead(&[&["score", RUN], &at[..]].concat()).json();
    let (found, again) = (number(&case, "/objective_mm"), number(&again, "/best/objective_mm"));
    assert!((found / again - 1.0).abs() < 1e-4, "{found} {again}");
}

#[test]
fn a_spindle_that_stays_has_one_beta_in_the_segment_or_the_path() {
    for (beta, runs) in some(2, [("constant_per_segment", 5), ("constant", 1)]) {
        let bench = Bench::new();
        let stays = format!("beta = \"{beta}\"");
        // None of the limits on beta is needed then.
        bench.replace(RUN, "max_beta_rate_deg_per_mm = 0.9", &stays);
        bench.replace(RUN, "[reference]", "[output]\nmaps = false\npage = false\n[reference]");
        let ended = bench.stead(&["place", RUN, "--out", "out", "--certify", "60", "--json"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let reason = format!("no certificate for the worst placement: beta stays (redundancy.beta = \"{beta}\")");
        ended.assert_says(&[&reason]);
        let certificate: Value = serde_json::from_str(&bench.read("out/certificate.json")).unwrap();
        let relaxed = certificate["best"]["limits_relaxed"].to_string();
        assert!(relaxed.contains("beta that stays along the path"), "{relaxed}");
        let summary: Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
        assert_eq!(summary["redundancy"]["beta"], beta, "{}", summary["redundancy"]);
        for plan in ["best.csv", "worst-worst-plan.csv"] {
            let rows = Rows::of(&bench.read(&format!("out/{plan}")));
            let (segments, betas) = (rows.column("segment"), rows.column("beta_deg"));
            let kept: Vec<(f64, f64)> = segments.into_iter().zip(betas).collect();
            let changes = kept.windows(2).filter(|pair| pair[0].1 != pair[1].1);
            if runs == 1 {
                assert_eq!(changes.count(), 0, "{plan}");
            } else {
                assert!(changes.into_iter().all(|pair| pair[0].0 != pair[1].0), "{plan}");
            }
        }
        let at = ["--placement-of", "out", "--json"];
        let again = bench.stead(&[&["score", RUN], &at[..]].concat()).json();
        let found = number(&ended.json(), "/cases/0/mean_mm");
        assert!((number(&again, "/best/mean_mm") / found - 1.0).abs() < 1e-4, "{again} {found}");
    }
}

#[test]
fn what_does_not_go_with_these_options_is_refused() {
    for (from, to, parts) in [
        (
            "force_uncertainty = 0.0",
            "aggregate = \"rms\"\njoint_travel_weight_mm_per_rad = 0.1",
            ["criterion.joint_travel_weight_mm_per_rad: is for the mean of the scores alone", "aggregate = \"mean\""],
        ),
        (
            "force_uncertainty = 0.0",
            "joint_travel_weight_mm_per_rad = -0.1",
            ["criterion.joint_travel_weight_mm_per_rad", "found -0.1; allowed: a number from 0 to 10"],
        ),
        (
            "beta_step_deg = 7.2",
            "beta_step_deg = 7.2\nbeta = \"still\"",
            ["redundancy.beta", "\"free\" or \"constant_per_segment\" or \"constant\""],
        ),
        (
            "max_beta_rate_deg_per_mm = 0.9",
            "beta = \"free\"",
            ["redundancy: sets no limit to the rotation of the spindle", "max_spindle_turn_deg_per_mm"],
        ),
    ] {
        let bench = Bench::new();
        bench.replace(RUN, from, to);
        let refused = bench.stead(&["place", RUN, "--out", "out"]);
        assert_eq!(refused.code, Some(2), "{to}: {}", refused.stderr);
        refused.assert_says(&parts);
    }
}
