//! `stead compensate` from outside: the corrected path of the shipped plan, what remains of it in reality, and what is
//! refused.

use crate::common::{Bench, Ended};
use nalgebra::Vector3;
use std::path::Path;
use stead_format::read_robot;
use stead_model::robot::angles::wrap;
use stead_model::stiffness::equilibrium::{Load, equilibrium};
use stead_problem::problem::{Placement, Problem};
use stead_run_files::read_run;

const CONFIG: &str = "configs/compensate.toml";
const PLAN: &str = "plan/best.csv";
const ROBOT: &str = "configs/robots/kuka-kr270-2.toml";
const SOFTER: &str = "softer.toml";

/// A bench with the published case, the shipped plan of it, and a file that compensates it.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.copy("results/caro-2013/best.csv", PLAN);
    bench.copy("configs/compensate-caro-2013.toml", CONFIG);
    bench.replace(CONFIG, "caro-2013.toml", "run.toml");
    bench.replace(CONFIG, "../results/caro-2013/best.csv", "../plan/best.csv");
    bench
}

fn run(bench: &Bench, more: &[&str]) -> Ended {
    bench.stead(&[&["compensate", CONFIG, "--out", "out"], more].concat())
}

/// Writes the robot of the bench with all stiffnesses divided by a factor.
fn write_softer(bench: &Bench, factor: f64) {
    let line = |line: &str| match line.strip_prefix("stiffness_mnm_per_rad = ") {
        Some(rest) => {
            let value: f64 = rest.split('#').next().unwrap().trim().parse().unwrap();
            format!("stiffness_mnm_per_rad = {}\n", value / factor)
        }
        None => format!("{line}\n"),
    };
    bench.write(SOFTER, &bench.read(ROBOT).lines().map(line).collect::<String>());
}

/// The columns of a CSV file, by name.
struct Columns {
    header: csv::StringRecord,
    rows: Vec<csv::StringRecord>,
}

impl Columns {
    fn read(bench: &Bench, name: &str) -> Self {
        let text = bench.read(name);
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        Self { header: reader.headers().unwrap().clone(), rows: reader.records().map(Result::unwrap).collect() }
    }

    fn number(&self, row: usize, name: &str) -> f64 {
        let column = self.header.iter().position(|column| column == name).unwrap_or_else(|| panic!("{name}"));
        self.rows[row][column].parse().unwrap()
    }

    fn vector(&self, row: usize, names: [&str; 3]) -> Vector3<f64> {
        Vector3::from(names.map(|name| self.number(row, name)))
    }
}

fn number(document: &serde_json::Value, pointer: &str) -> f64 {
    document.pointer(pointer).and_then(serde_json::Value::as_f64).unwrap_or_else(|| panic!("{pointer} in {document}"))
}

/// Where the loaded tool of the run's arm comes to rest for corrected joint angles, computed from the files alone. mm
fn rest_mm(problem: &Problem, placement: &Placement, path: &Columns, row: usize) -> Vector3<f64> {
    let joints: [f64; 6] = std::array::from_fn(|j| path.number(row, &format!("theta{}_deg", j + 1)).to_radians());
    let base_from_workpiece = placement.base_from_workpiece().rotation;
    let wrench = &problem.task.loads()[row].wrench;
    let point = problem.spindle.flange_from_tool.translation;
    let load = Load { point, force: base_from_workpiece * wrench.force, moment: base_from_workpiece * wrench.moment };
    problem.robot.forward(&equilibrium(&problem.robot, &joints, &load).unwrap()).point(&point) * 1e3
}

#[test]
fn the_corrected_path_brings_the_loaded_tool_to_the_plan() {
    let bench = bench();
    let ended = run(&bench, &["--json"]);
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""));
    let document = ended.json();
    assert!((1.0..=3.0).contains(&number(&document, "/iterations")));
    assert!(number(&document, "/before/mean_mm") > 0.5 && number(&document, "/before/max_mm") > 1.0);
    assert!(number(&document, "/after/max_mm") <= 1e-6);
    assert!(number(&document, "/reduction_percent") > 99.9999);
    assert!(document["reality"].is_null());
    assert_eq!(
        bench.tree("out").keys().collect::<Vec<_>>(),
        ["compensation.svg", "corrected-path.csv", "manifest.json", "report.html", "summary.json"]
    );
    assert_eq!(bench.read("out/summary.json"), ended.stdout);

    let run = read_run(&bench.path("configs/run.toml")).unwrap();
    let place = |name: &str| number(&document, &format!("/placement/{name}"));
    let placement = Placement {
        x: place("x_mm") / 1e3,
        y: place("y_mm") / 1e3,
        z: place("z_mm") / 1e3,
        yaw: place("yaw_deg").to_radians(),
    };
    // The placement of case 1 of the shipped run.
    assert!((place("y_mm") + 1640.0).abs() < 1e-3 && (place("yaw_deg") - 78.9664).abs() < 1e-4);
    let (path, plan) = (Columns::read(&bench, "out/corrected-path.csv"), Columns::read(&bench, PLAN));
    assert_eq!((path.rows.len(), plan.rows.len()), (105, 105));
    let mut sum = 0.0;
    for row in 0..105 {
        let target = path.vector(row, ["target_x_mm", "target_y_mm", "target_z_mm"]);
        assert!((target - plan.vector(row, ["x_mm", "y_mm", "z_mm"])).norm() < 2e-4);
        let rest = rest_mm(&run.problem, &placement, &path, row);
        // The placement is printed to 1e-4 mm and 1e-4 deg, and turns the force.
        assert!((rest - target).norm() < 1e-5, "{row}: {}", (rest - target).norm());
        let before = path.vector(row, ["before_x_mm", "before_y_mm", "before_z_mm"]);
        // To first order that of the plan: up to 3 mm turn an arm of 1 m and more by up to 3e-3.
        let of_plan = plan.vector(row, ["deflection_x_mm", "deflection_y_mm", "deflection_z_mm"]);
        assert!((before - of_plan).norm() < 5e-3 * before.norm() + 2e-5, "{row}: {before} {of_plan}");
        assert!((path.number(row, "before_normal_mm") - plan.number(row, "normal_mm")).abs() < 5e-3 * before.norm());
        let command = path.vector(row, ["corrected_x_mm", "corrected_y_mm", "corrected_z_mm"]);
        assert!((command - target + before).norm() < 0.02 * before.norm());
        for j in 1..=6 {
            let name = format!("theta{j}_deg");
            let off = path.number(row, &name) - plan.number(row, &name);
            assert!(off.abs() < 0.5 && wrap(off.to_radians()) == off.to_radians(), "turns stay: {name} {off}");
        }
        sum += before.norm();
    }
    assert!((sum / 105.0 - number(&document, "/before/mean_mm")).abs() < 1e-6);

    let picture = bench.read("out/compensation.svg");
    for part in ["Deflection before and after", "path point", "Normal to the feed before and after", "below 0.001"] {
        assert!(picture.contains(part), "{part}");
    }
    bench.stead(&["compensate", CONFIG, "--out", "again"]);
    assert_eq!(bench.tree("out"), bench.tree("again"));
}

#[test]
fn in_reality_the_share_that_the_model_does_not_know_remains() {
    let bench = bench();
    write_softer(&bench, 1.25);
    let document = run(&bench, &["--reality", SOFTER, "--json"]).json();
    let reduction = number(&document, "/reduction_percent");
    assert!((reduction - 80.0).abs() < 1.0, "{reduction}");
    assert!((number(&document, "/normal/reduction_percent") - 80.0).abs() < 1.0);
    let path = Columns::read(&bench, "out/corrected-path.csv");
    for row in 0..105 {
        let before = path.vector(row, ["before_x_mm", "before_y_mm", "before_z_mm"]);
        let after = path.vector(row, ["after_x_mm", "after_y_mm", "after_z_mm"]);
        assert!((after - before * 0.2).norm() < 0.01 * before.norm() + 1e-6, "{row}: {before} {after}");
    }
    // The file may name it, and the command line goes before it.
    bench.replace(CONFIG, "# reality = \"robots/kuka-kr270-2-k1-0.8.toml\"", "reality = \"../softer.toml\"");
    let named = run(&bench, &["--json"]).json();
    assert_eq!(number(&named, "/reduction_percent"), reduction);
    assert_eq!(named["inputs"][5]["name"], "../softer.toml");
    let same = run(&bench, &["--reality", ROBOT, "--json"]).json();
    assert!(number(&same, "/after/max_mm") <= 1e-6);
    let text = run(&bench, &[]).stdout;
    for part in
        ["105 points, compensated for the static equilibrium", "executed on KUKA KR270-2 (../softer.toml)", "80."]
    {
        assert!(text.contains(part), "{part} in {text}");
    }
}

#[test]
fn the_linear_model_leaves_little_in_the_equilibrium() {
    let bench = bench();
    bench.replace(CONFIG, "model = \"equilibrium\"", "model = \"linear\"");
    let document = run(&bench, &["--json"]).json();
    let (before, after) = (number(&document, "/before/mean_mm"), number(&document, "/after/mean_mm"));
    assert!(after > 1e-5 && after < 5e-3 * before, "{before} {after}");
}

#[test]
fn a_path_that_cannot_be_corrected_all_along_has_no_result_where_all_is_asked_for() {
    // Joint 1 of the plan goes up to 104.2999 deg, and corrected to 104.33699 deg, at point 61.
    let bench = bench();
    bench.replace(ROBOT, "max_deg = 185.0", "max_deg = 104.3365");
    bench.write_result("compensate", "out/corrected-path.csv", "an earlier result\n");
    let before = bench.tree("");
    for more in [&["--out", "new"][..], &["--out", "new", "--json"], &["--out", "out"]] {
        let ended = bench.stead(&[&["compensate", CONFIG, "--all-or-nothing"], more].concat());
        assert_eq!(ended.code, Some(1));
        ended.assert_says(&[
            "error: 1 of 105 points cannot be compensated:",
            "\n  point 61: corrected, joint 1 would be 0.00048",
            " deg beyond its limit",
        ]);
        if more.contains(&"--json") {
            let document = ended.json();
            assert!(document["failed"][0]["reason"].as_str().unwrap().contains("joint 1"));
            assert!(document.get("after").is_none());
        } else {
            assert_eq!(ended.stdout, "");
        }
        assert_eq!(bench.tree(""), before);
    }
}

#[test]
fn what_can_be_corrected_is_and_the_rest_keeps_its_target() {
    let bench = bench();
    let before = run(&bench, &["--json"]).json();
    assert_eq!((number(&before, "/corrected"), &before["not_corrected"]), (105.0, &serde_json::json!([])));
    bench.replace(ROBOT, "max_deg = 185.0", "max_deg = 104.3365");
    let ended = run(&bench, &["--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let reason = "corrected, joint 1 would be 0.00048";
    ended.assert_says(&[
        "warning: 1 of 105 points are not corrected and keep their target, the first point 61: ",
        reason,
    ]);
    let document = ended.json();
    assert_eq!((number(&document, "/points"), number(&document, "/corrected")), (105.0, 104.0));
    assert_eq!(document["not_corrected"][0]["point"], 61);
    assert!(document["warnings"][0].as_str().unwrap().starts_with("1 of 105 points"));
    let path = Columns::read(&bench, "out/corrected-path.csv");
    assert_eq!(path.rows.len(), 105);
    for row in 0..105 {
        let [target, command, before, after] = ["target", "corrected", "before", "after"].map(|part| {
            path.vector(row, ["x", "y", "z"].map(|axis| format!("{part}_{axis}_mm")).each_ref().map(String::as_str))
        });
        let status = &path.rows[row][29];
        if row == 61 {
            assert!(status.starts_with(reason), "{status}");
            assert_eq!((command, after), (target, before));
            assert_eq!((path.number(row, "iterations"), path.number(row, "rotation_z_deg")), (0.0, 0.0));
        } else {
            assert_eq!(status, "corrected");
            assert!(command != target && after.norm() <= 1e-6, "{row}");
        }
    }
    // The largest deflection that is left is that of the point that is not corrected, and the mean counts it.
    let left = path.vector(61, ["before_x_mm", "before_y_mm", "before_z_mm"]).norm();
    assert!((number(&document, "/after/max_mm") - left).abs() < 1e-6);
    assert!((number(&document, "/after/mean_mm") - left / 105.0).abs() < 1e-6);
    assert!(run(&bench, &[]).stdout.contains("105 points, 104 of them compensated for the static equilibrium"));
}

#[test]
fn an_iteration_that_does_not_end_is_told() {
    let bench = bench();
    bench.replace(CONFIG, "alpha = 1.0", "alpha = 0.1");
    let ended = run(&bench, &[]);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(1), ""));
    ended.assert_says(&["105 of 105 points", "points 0 to 104: at point 0, after 50 iterations the error is still"]);
    bench.replace(CONFIG, "max_iterations = 50", "max_iterations = 200");
    let damped = run(&bench, &["--json"]).json();
    assert!(number(&damped, "/iterations") > 100.0 && number(&damped, "/after/max_mm") <= 1e-6);
}

/// Asserts that the bench is refused with exit code 2, parts in the message, and every file as it was.
#[track_caller]
fn refused(bench: &Bench, more: &[&str], parts: &[&str]) {
    let before = bench.tree("");
    let ended = run(bench, more);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
    assert!(ended.stderr.starts_with("error: ") && !ended.stderr.contains("panicked"), "{}", ended.stderr);
    ended.assert_says(parts);
    ended.assert_says(&["; allowed: "]);
    assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
    assert_eq!(bench.tree(""), before);
}

/// Asserts that a bench with one text of a file replaced is refused at the line of that text.
#[track_caller]
fn refused_after(file: &str, from: &str, to: &str, parts: &[&str]) {
    let bench = bench();
    let line = bench.replace(file, from, to);
    let base = Path::new(file).file_name().unwrap().to_str().unwrap().to_owned();
    refused(&bench, &[], &[&[format!("{base}:{line}: ").as_str()], parts].concat());
}

#[test]
fn a_compensation_file_that_breaks_a_rule_is_refused_at_its_line() {
    for (from, to, parts) in [
        ("run.toml", "ran.toml", ["run: ", "cannot be read", "found \"ran.toml\""]),
        ("plan/best.csv", "plan/bent.csv", ["plan: ", "cannot be read", "found \"../plan/bent.csv\""]),
        ("plan =", "path =", ["path: unknown key", "nearest known one", "run, plan, reality, compensation"]),
        ("alpha = 1.0", "alpha = 0", ["compensation.alpha: ", "found 0;", "above 0 and not above 1"]),
        ("alpha = 1.0", "alpha = 2.0", ["compensation.alpha: ", "found 2.0", "above 0 and not above 1"]),
        ("alpha = 1.0", "alpha = nan", ["compensation.alpha: ", "found nan", "above 0 and not above 1"]),
        ("= 1e-6", "= 1e-12", ["compensation.tolerance_mm: ", "found 1e-12", "1e-9 to 1"]),
        ("= 50", "= 0", ["compensation.max_iterations: ", "found 0;", "from 1 to"]),
        (
            "\"equilibrium\" ",
            "\"exact\" ",
            ["compensation.model: ", "found \"exact\"", "\"equilibrium\" or \"linear\""],
        ),
    ] {
        refused_after(CONFIG, from, to, &parts);
    }
    let bench = bench();
    bench.write(CONFIG, "run = 'run.toml'\n");
    refused(&bench, &[], &["compensate.toml:1: plan: is missing"]);
    refused(&bench, &["--reality", "none.toml"], &["error: configs/compensate.toml:1: plan: is missing"]);
}

#[test]
fn a_plan_with_a_wrong_cell_is_refused_at_it() {
    for (from, to, parts) in [
        ("theta6_deg", "theta7_deg", &["theta6_deg: missing column", "each once"][..]),
        ("inverse_condition", "posture", &["posture: this column is there twice"]),
        ("deflection_y_mm", "deflected_y_mm", &["deflection_y_mm: missing column"]),
        ("\n0,1,-429.3236", "\n0,1,nan", &["x_mm: not a finite number", "found 'nan'"]),
        (",-93.2368,", ",inf,", &["theta1_deg: not a finite number", "found 'inf'"]),
        (",-129.2248,4,", ",-129.2248,9,", &["posture: not a posture", "found '9'", "from 1 to 8"]),
        (",-129.2248,4,", ",-129.2248,2,", &["theta2_deg: is 45.8040, but in posture 2 the joint stands at"]),
        (
            ",-129.2248,",
            ",-128.2248,",
            &["beta_deg: is -128.2248, which with", "puts the workpiece at a yaw of", "and other rows at 78.966"],
        ),
        ("-1751.8967", "-1752.8967", &["theta1_deg to theta6_deg: ", "1.0001 mm away from the position of the row"]),
        (
            "-94.3373",
            "94.3373",
            &["force_x_n,force_y_n,force_z_n: ", "188.67", "away from the force that the task has"],
        ),
        ("\n7,1,", "\n8,1,", &["point: not the number that the task has here", "found '8'", "allowed: 7, as in"]),
        ("\n7,1,", "\n7,2,", &["segment: not the number that the task has here", "found '2'", "allowed: 1, as in"]),
    ] {
        let from_next = from.strip_prefix('\n');
        let bench = bench();
        let line = bench.replace(PLAN, from, to) + usize::from(from_next.is_some());
        refused(&bench, &[], &[&[format!("best.csv:{line}: ").as_str()], parts].concat());
    }
}

#[test]
fn a_plan_of_another_run_is_refused() {
    // As many points as the task, and no more.
    let bench = bench();
    let text = bench.read(PLAN);
    let cut: String = text.lines().take(101).map(|line| format!("{line}\n")).collect();
    bench.write(PLAN, &cut);
    refused(
        &bench,
        &[],
        &["best.csv:101: point: the plan ends before the task, which has 105 points", "found 100 points"],
    );
    bench.write(PLAN, &format!("{text}{}\n", text.lines().last().unwrap()));
    refused(
        &bench,
        &[],
        &["best.csv:107: point: the plan has more points than the 105 of the task", "allowed: points 0 to 104"],
    );
    // Another arm, another spindle, another task of the same shape.
    refused_in_plan(ROBOT, "a_mm = 1250.0", "a_mm = 1260.0", "these angles bring the tool");
    refused_in_plan("configs/run.toml", "684.0]", "685.0]", "these angles bring the tool");
    refused_in_plan(
        TASK,
        "-192.000000,361.600000,0,",
        "-192.000000,361.500000,0,",
        "0.1000 mm away from where the other rows place",
    );
    refused_in_plan(TASK, "-22.904457,91.647810,0.000000\n", "-22.904457,-91.647810,0.000000\n", "away from the force");
}

const TASK: &str = "tasks/five-segments.csv";

#[track_caller]
fn refused_in_plan(file: &str, from: &str, to: &str, part: &str) {
    let bench = bench();
    bench.replace(file, from, to);
    refused(&bench, &[], &["best.csv:", part, "allowed: a row of the plan that stead place wrote for this run"]);
}

#[test]
fn a_reality_of_another_geometry_is_refused_and_other_compliances_of_a_plan_are_noted() {
    let bench = bench();
    write_softer(&bench, 1.25);
    let line = bench.replace(SOFTER, "d_mm = 1100.0", "d_mm = 1101.0");
    let place = format!("error: {SOFTER}:{line}: joints[4].d_mm: ");
    refused(
        &bench,
        &["--reality", SOFTER],
        &[&place, "'KUKA KR270-2' has another geometry", "found 1101.0", "allowed: 1100"],
    );
    refused(&bench, &["--reality", "absent.toml"], &["error: absent.toml: cannot be read"]);

    write_softer(&bench, 1.25);
    assert!(read_robot(&bench.path(SOFTER)).is_ok());
    bench.write(ROBOT, &bench.read(SOFTER));
    let ended = run(&bench, &["--json"]);
    assert_eq!(ended.code, Some(0));
    ended.assert_says(&["note: the plan was made for other compliances than the robot of the run has (line 2: "]);
    assert!(number(&ended.json(), "/after/max_mm") <= 1e-6);
}
