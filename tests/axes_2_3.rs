//! Axes 2 and 3 together, from outside: an arm with a parallelogram is posed, placed, exported and judged, and what
//! joins no axes is refused.

use crate::common::{Bench, Ended};
use stead_model::testing::is_all;

const ROBOT: &str = "irb4400.toml";
const CELL: &str = "\
robot = 'irb4400.toml'
task = 'tasks/five-segments.csv'
[spindle]
xyz_mm = [0, 0, 250]
rpy_deg = [0, 45, 0]
mass_kg = 20
centre_of_mass_mm = [0, 0, 120]
[cell]
x_mm = [900, 1150]
y_mm = [-250, 50]
z_mm = [400, 700]
yaw_deg = [-40, 40]
[constraints]
min_inverse_condition = 0.15
characteristic_length_mm = 500
[redundancy]
beta_step_deg = 7.2
feed_mm_per_s = 60
max_beta_rate_deg_per_mm = 2
[search]
seed = 1
population = 16
generations = 2
basins = 1
[output]
maps = false
";

/// The shipped arm with a stiffness of our own, and a cell around it.
fn bench() -> Bench {
    let bench = Bench::new();
    let mut stiffness = ["2.5", "2.5", "2.0", "0.4", "0.4", "0.3"].into_iter();
    let shipped = bench.stead(&["robots", "abb-irb4400-60"]).stdout;
    let line = |line: &str| match line.starts_with("max_speed_deg_per_s") {
        true => format!("{line}\nstiffness_mnm_per_rad = {}\n", stiffness.next().unwrap()),
        false => format!("{line}\n"),
    };
    bench.write(ROBOT, &shipped.lines().map(line).collect::<String>());
    bench.write("run.toml", CELL);
    bench
}

fn ok(ended: &Ended) -> &str {
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    &ended.stdout
}

/// A command that is refused with one line that has these words.
fn refused(bench: &Bench, arguments: &[&str], words: &[&str]) {
    let ended = bench.stead(arguments);
    assert_eq!(ended.code, Some(2), "{arguments:?}: {}", ended.stderr);
    let errors: Vec<&str> = ended.stderr.lines().filter(|line| line.starts_with("error: ")).collect();
    let [error] = errors[..] else { panic!("{}", ended.stderr) };
    words.iter().for_each(|word| assert!(error.contains(word), "{word} in {error}"));
}

/// Sums of joints 2 and 3 of a plan, in deg.
fn sums(bench: &Bench, plan: &str) -> Vec<f64> {
    let csv = bench.read(plan);
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let [second, third] = ["theta2_deg", "theta3_deg"].map(|name| header.iter().position(|c| *c == name).unwrap());
    let sum = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        [second, third].map(|column| cells[column].parse::<f64>().unwrap()).iter().sum()
    };
    lines.map(sum).collect()
}

/// Placed, exported as RAPID, read back by the program's own reader and by the judge, whose counting shares nothing
/// with either.
fn placed_and_judged(bench: &Bench, more: &[&str]) {
    ok(&bench.stead(&["place", "run.toml", "--out", "r"]));
    let all = sums(bench, "r/best.csv");
    assert!(all.iter().all(|sum| (-155.0001..=-29.9999).contains(sum)), "{all:?}");
    let export = ["export", "run.toml", "r/best.csv", "--format", "rapid", "--out", "p/PART", "--approach-mm", "5"];
    ok(&bench.stead(&[&export[..], more].concat()));
    ok(&bench.stead(&["export", "run.toml", "r/best.csv", "--check", "p/PART.mod", "--approach-mm", "5"]));
    let [run, results, program] = ["run.toml", "r", "p/PART.mod"].map(|name| bench.path(name));
    let verdict = stead_judge::judge(&run, &results).unwrap();
    assert!(verdict.disagreements.is_empty(), "{verdict}");
    assert!(verdict.checks["limit of the sum of joints 2 and 3 (rad)"] > 300, "{verdict}");
    let read = stead_judge::judge_program(&run, &results, &program).unwrap();
    assert!(read.disagreements.is_empty() && read.checks["points of a program"] > 0, "{read}");
}

#[test]
fn an_arm_with_a_parallelogram_is_where_its_controller_says() {
    let bench = Bench::new();
    let pose = bench.stead(&["pose", "name:abb-irb4400-60", "--controller-deg", "0,30,0,0,0,0", "--json"]);
    let document = pose.json();
    assert_eq!(document["frames"][0]["xyz_mm"], serde_json::json!([1665.0, 0.0, 1600.763]), "{document}");
    // With axis 2 alone the forearm stays level: beyond its range is A3 by itself.
    let beyond = bench.stead(&["pose", "name:abb-irb4400-60", "--controller-deg", "0,30,70,0,0,0"]);
    let note = "the sum of joints 2 and 3 at -160.000 deg is beyond its limits, -155.000 to -30.000 deg";
    assert!(ok(&beyond).contains("controller") && beyond.stderr.contains(note), "{}", beyond.stderr);
    let list = bench.stead(&["robots"]).stdout;
    let linked = list.lines().filter(|line| line.starts_with("abb-irb4400-60 ") || line.starts_with("fanuc-m900ia"));
    assert!(linked.clone().count() == 2 && linked.clone().all(|line| line.contains(" yes ")), "{list}");
    let document: serde_json::Value = serde_json::from_str(&bench.stead(&["robots", "--json"]).stdout).unwrap();
    let arms = document["robots"].as_array().unwrap();
    assert_eq!(arms.iter().filter(|arm| arm["has_linkage"] == true).count(), 2);
    let checked = bench.stead(&["check", "name:abb-irb4400-60"]);
    let words = "sum of joints 2 and 3, deg: -155.0 to -30.0, driven by a parallelogram";
    assert!(ok(&checked).contains(words), "{}", checked.stdout);
}

#[test]
fn an_arm_with_a_parallelogram_is_placed_explained_exported_and_judged() {
    let bench = bench();
    placed_and_judged(&bench, &[]);
    let at = ["explain", "run.toml", "--x-mm", "900", "--y-mm", "-100", "--z-mm", "1500", "--yaw-deg", "0"];
    let explained = bench.stead(&[&at[..], &["--point", "0", "--beta-deg", "0"]].concat());
    assert!(explained.stdout.contains("the sum of joints 2 and 3 at "), "{}{}", explained.stdout, explained.stderr);
    // Sag and compensation with gravity.
    bench.write(
        "compensate.toml",
        "run = 'run.toml'\nplan = 'r/best.csv'\nalpha = 1.0\ntolerance_um = 1.0\nmax_iterations = 50\ngravity = true\n",
    );
}

#[test]
fn on_a_ceiling_and_on_a_rail_too() {
    let bench = self::bench();
    bench.replace("run.toml", "[cell]", "[mount]\nxyz_mm = [0, 0, 2200]\nrpy_deg = [180, 0, 0]\n[cell]");
    bench.replace("run.toml", "z_mm = [400, 700]", "z_mm = [900, 1300]");
    // The way into the cut and out of it may use what the cut keeps off.
    bench.replace("run.toml", "[constraints]", "[constraints]\njoint_margin_deg = 3");
    placed_and_judged(&bench, &[]);
    if !is_all() {
        return;
    }
    let bench = self::bench();
    let rail = "[[external_axis]]\nname = 'rail'\nkind = 'rail'\ncarries = 'robot'\ndirection = [0, 1, 0]\n\
                range_mm = [-300, 300]\nspeed_mm_per_s = 500\nuse = 'continuous'\n[cell]";
    bench.replace("run.toml", "[cell]", rail);
    placed_and_judged(&bench, &[]);
}

#[test]
fn programs_of_a_linkage_need_to_know_how_axis_3_is_counted() {
    let bench = bench();
    ok(&bench.stead(&["place", "run.toml", "--out", "r"]));
    bench.replace(ROBOT, "is_j3_level = true\n", "");
    let export = ["export", "run.toml", "r/best.csv", "--format", "rapid", "--out", "p/PART"];
    refused(&bench, &export, &["irb4400.toml: controller.is_j3_level: is missing", "; allowed: true where"]);
    ok(&bench.stead(&["export", "run.toml", "r/best.csv", "--format", "csv", "--out", "p/PART"]));
}

#[test]
fn what_joins_no_axes_is_refused_in_one_line() {
    for (from, to, words) in [
        ("sum_min_deg = -155.0", "sum_min_deg = -20", ["axes_2_3.sum_min_deg: is not below sum_max", "found -20"]),
        (
            "sum_min_deg = -155.0",
            "sum_min_deg = -236",
            ["axes_2_3.sum_min_deg: is beyond what the ranges", "-235.0000"],
        ),
        ("sum_max_deg = -30.0", "sum_max_deg = 31", ["axes_2_3.sum_max_deg: is beyond what the ranges", "30.0000"]),
        ("sum_min_deg = -155.0\nsum_max_deg = -30.0", "", ["axes_2_3.sum_min_deg: is missing", "a finite number"]),
        ("sum_max_deg = -30.0", "sum_max_deg = nan", ["axes_2_3.sum_max_deg: is not a finite", "found nan"]),
        ("sum_max_deg = -30.0", "sum_max_deg = inf", ["axes_2_3.sum_max_deg: is not a finite", "found inf"]),
    ] {
        let bench = bench();
        bench.replace(ROBOT, from, to);
        refused(&bench, &["check", ROBOT], &words);
    }
    let bench = bench();
    bench.replace("run.toml", "[constraints]", "[constraints]\njoint_margin_deg = 70");
    refused(&bench, &["check", "run.toml"], &["constraints.joint_margin_deg: leaves no range"]);
}
