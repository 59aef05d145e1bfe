use super::*;
use crate::testing::{RUN, TASK, assert_refused, folder, read_text as read};
use proptest::prelude::*;
use std::f64::consts::PI;
use stead_disk::input::InputFile;
use stead_format::task::read_csv;
use stead_format::testing::root;
use stead_problem::problem::Interval;
use stead_problem::settings::SearchSettings;
use stead_problem::settings::TransferSettings;

fn shipped(name: &str) -> Run {
    read_run(&root().join("configs").join(name)).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn shipped_runs_are_the_published_case() {
    let run = shipped("caro-2013.toml");
    let testing = stead_problem::testing::five_segments();
    assert_eq!(run.problem.task, testing.task);
    assert_eq!(run.problem.constraints, testing.constraints);
    assert_eq!(run.problem.criterion, testing.criterion);
    assert_eq!(run.problem.redundancy.beta_count, 120);
    assert!((run.problem.redundancy.feed - 0.066667).abs() < 1e-15);
    let spindle = (run.problem.spindle.flange_from_tool, testing.spindle.flange_from_tool);
    assert!((spindle.0.rotation - spindle.1.rotation).abs().max() < 1e-8);
    assert_eq!(spindle.0.translation, spindle.1.translation);
    for (found, expected) in run.problem.cell.position.iter().zip(testing.cell.position) {
        assert!((found.min - expected.min).abs() + (found.max - expected.max).abs() < 1e-12);
    }
    assert_eq!(run.problem.cell.yaw, Interval { min: -PI, max: PI });
    assert_eq!(run.search, SearchSettings::default());
    assert_eq!(run.transfer, TransferSettings::default());
    let reference = run.reference.unwrap();
    assert_eq!(reference.source, "Caro et al. 2013, Table III");
    assert_eq!(reference.figures[1], 0.35);
    assert!(run.notes.len() == 1 && run.notes[0].starts_with("collisions were not checked: "), "{:?}", run.notes);

    let softer = shipped("caro-2013-k1-0.8.toml");
    assert_eq!(softer.problem.robot.joints()[0].compliance, (1e-6 / 0.8).into());
    assert_eq!(softer.problem.task, testing.task);
}

#[test]
fn shipped_cutting_table_reproduces_the_shipped_forces() {
    let run = shipped("five-segments-cutting.toml");
    let with_forces = read_csv(&root().join("tasks/five-segments.csv")).unwrap();
    assert_eq!(run.problem.task.path(), &with_forces.path);
    for (ours, theirs) in run.problem.task.wrenches().zip(with_forces.wrenches.unwrap()) {
        assert!((ours.force - theirs.force).abs().max() < 0.1);
    }
}

#[test]
fn inputs_are_the_bytes_that_were_read() {
    let run = shipped("caro-2013.toml");
    let expected = [
        ("config", "caro-2013.toml", "configs/caro-2013.toml"),
        ("robot", "robots/kuka-kr270-2.toml", "configs/robots/kuka-kr270-2.toml"),
        ("task", "../tasks/five-segments.csv", "tasks/five-segments.csv"),
    ];
    for (input, (role, name, file)) in run.inputs.iter().zip(expected) {
        let digest = stead_disk::input::sha256(&std::fs::read(root().join(file)).unwrap());
        assert_eq!((input.role, input.name.as_str(), &input.sha256), (role, name, &digest));
    }
    assert_eq!(run.inputs.len(), 3);
}

#[test]
fn a_bad_file_that_the_run_names_is_located() {
    assert_refused(
        "arm.toml",
        "arn.toml",
        &["run.toml:1: robot: ", "cannot be read", "arn.toml: ", "found 'arn.toml'"],
    );
    assert_refused("task.csv", "tusk.csv", &["run.toml:2: task: ", "cannot be read", "tusk.csv: ", "found 'tusk.csv'"]);
    assert_refused("task.csv", "arm.toml", &["arm.toml:1: ", "unknown column"]);
    assert_refused("arm.toml", "task.csv", &["task.csv:1: ", "TOML"]);
    let folder = folder();
    std::fs::write(folder.path().join("task.csv"), TASK.replace("10,20,0\n1", "10,nan,0\n1")).unwrap();
    let file = folder.path().join("run.toml");
    std::fs::write(&file, RUN).unwrap();
    let message = read_run(&file).unwrap_err().to_string();
    for part in ["task.csv:2: force_y_n: ", "finite", "found 'nan'", "; allowed: "] {
        assert!(message.contains(part), "{part} in {message}");
    }
    let message = read_run(&folder.path().join("ran.toml")).unwrap_err().to_string();
    assert!(message.contains("ran.toml: cannot be read: "), "{message}");
}

const CUTTING: &str = "[tool]\ncutter_diameter_mm = 16\nteeth = 4\nkt_mpa = 800\nkr = 0.4\nkte_n_per_mm = 20\n\
    kre_n_per_mm = 20\n[cut]\nmilling = 'climb'\nradial_depth_mm = 2\naxial_depth_mm = 5\nfeed_per_tooth_mm = 0.05\n";

proptest! {
    #[test]
    fn a_damaged_file_is_read_or_refused_with_its_name(
        at in 0..RUN.len(), cut in 0..4_usize, put in "[ -~\n\u{e4}]{0,3}"
    ) {
        let text = format!("{}{put}{}", &RUN[..at], RUN.get(at + cut..).unwrap_or_default());
        if let Err(error) = read(&text) {
            prop_assert!(error.file.ends_with("run.toml") && error.line.is_some() && error.allowed.is_some());
        }
    }
}

#[test]
fn forces_come_from_one_place() {
    let both = format!("{CUTTING}[cell]");
    assert_refused("[cell]", &both, &["run.toml:6: tool: ", "one place only", "task.csv", "found [tool]"]);
    assert_refused(
        "task.csv",
        "path.csv",
        &["run.toml:2: task: ", "no force columns", "found 'path.csv'", "[tool] and [cut]"],
    );
    let text = format!("{RUN}{CUTTING}").replace("task.csv", "path.csv");
    assert!(read(&text).unwrap().problem.task.wrenches().all(|wrench| wrench.force.norm() > 50.0));
    let message = read(&text.replace("kr = 0.4", "kr = 1e305")).unwrap_err().to_string();
    assert!(message.contains("run.toml:21: tool.kr: is out of range, found 1e305; "), "{message}");
}

#[test]
fn notes_say_what_the_result_rests_on() {
    let folder = folder();
    let robot = std::fs::read_to_string(folder.path().join("arm.toml")).unwrap();
    std::fs::write(folder.path().join("arm.toml"), robot.replacen("max_speed_deg_per_s = 84.0\n", "", 1)).unwrap();
    let file = folder.path().join("run.toml");
    std::fs::write(&file, format!("{RUN}{CUTTING}").replace("task.csv", "path.csv")).unwrap();
    let notes = read_run(&file).unwrap().notes;
    assert_eq!(
        notes[0],
        "feed is up to 5.71 deg off the normal of the tool axis (task line 3): the wall normal is axis x feed"
    );
    assert!(notes[1].contains("no max_speed_deg_per_s for joints 2: "), "{}", notes[1]);
    assert!(notes.len() == 3 && notes[2].starts_with("collisions were not checked: "), "{notes:?}");
}

#[test]
fn an_arm_without_stiffness_gets_that_of_the_arm_that_the_run_names() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let run = |like: &str| {
        let text = RUN.replacen("'arm.toml'", "'name:abb-irb6640-185'", 1);
        std::fs::write(at("run.toml"), format!("{like}{text}")).unwrap();
        read_run(&at("run.toml"))
    };
    let without = run("").unwrap_err().to_string();
    assert!(without.contains("stiffness_like in the run file"), "{without}");
    for name in ["kuka-kr270-r2700", "name:kuka-kr270-r2700"] {
        let read = run(&format!("stiffness_like = '{name}'\n")).unwrap_or_else(|e| panic!("{e}"));
        let lender = stead_format::read_robot(Path::new("name:kuka-kr270-r2700")).unwrap();
        let robot = &read.problem.robot;
        assert_eq!(robot.stiffness_like(), Some("KUKA KR 270 R2700"));
        assert!(robot.name().starts_with("ABB IRB 6640-185/2.8"), "{}", robot.name());
        // Joint 2 of the lender has a range, whose middle is taken; the others are as they are.
        let (ours, theirs) = (robot.compliances_at(&robot.mid_range()), lender.compliances_at(&lender.mid_range()));
        assert!(ours.iter().zip(theirs).all(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{ours:?} {theirs:?}");
        let borrowed = "stiffness is borrowed from KUKA KR 270 R2700";
        assert!(read.notes.iter().any(|note| note.contains(borrowed)), "{:?}", read.notes);
        let is_lender = |input: &InputFile| (input.role, &input.name[..]) == ("stiffness", "name:kuka-kr270-r2700");
        assert!(read.inputs.iter().any(is_lender));
    }
    for (name, part) in [("kr270", "is no shipped arm"), ("abb-irb120", "is an arm without stiffness")] {
        let message = run(&format!("stiffness_like = '{name}'\n")).unwrap_err().to_string();
        assert!(message.contains(":1: stiffness_like: ") && message.contains(part), "{message}");
        assert!(message.contains("states no joint stiffness of its own"), "{message}");
    }
    // A robot file that states its own says itself whose it is.
    for name in ["made up", "kuka-kr270-r2700"] {
        std::fs::write(at("run.toml"), format!("stiffness_like = '{name}'\n{RUN}")).unwrap();
        let message = read_run(&at("run.toml")).unwrap_err().to_string();
        let start = "run.toml:1: stiffness_like: lends a stiffness to a robot file that states its own, found ";
        assert!(message.contains(start) && message.contains("; allowed: a robot file without"), "{message}");
    }
    let arm = std::fs::read_to_string(at("arm.toml")).unwrap();
    std::fs::write(at("arm.toml"), format!("stiffness_like = 'made up'\n{arm}")).unwrap();
    std::fs::write(at("run.toml"), RUN).unwrap();
    assert_eq!(read_run(&at("run.toml")).unwrap().problem.robot.stiffness_like(), Some("made up"));
}

#[test]
fn stability_along_the_path_is_that_of_the_arm_with_the_stiffness_lent_to_it() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let text = |name: &str| std::fs::read_to_string(root().join("configs").join(name)).unwrap();
    let is_kept = |line: &&str| !line.starts_with("stiffness_mnm_per_rad");
    let bare: String =
        text("robots/staubli-tx200.toml").lines().filter(is_kept).map(|line| format!("{line}\n")).collect();
    std::fs::write(at("arm.toml"), bare).unwrap();
    let task = root().join("tasks/five-segments.csv");
    let run = text("tx200-stability.toml").replace(
        "../tasks/five-segments.csv",
        &std::path::absolute(task).unwrap().display().to_string().replace('\\', "/"),
    );
    let read = |arm: &str, like: &str| {
        let robot = format!("robot = '{arm}'\n{like}");
        std::fs::write(at("run.toml"), run.replace("robot = \"robots/staubli-tx200.toml\"", &robot)).unwrap();
        read_run(&at("run.toml"))
    };
    let without = read("arm.toml", "").unwrap_err().to_string();
    assert!(without.contains("stiffness_like in the run file"), "{without}");
    let like = "stiffness_like = 'kuka-kr270-2'\n";
    let lent = read("arm.toml", like).unwrap_or_else(|e| panic!("{e}"));
    let lender = stead_format::read_robot(Path::new("name:kuka-kr270-2")).unwrap();
    let arm = &lent.problem.robot;
    assert!(lent.path_stability.is_some() && arm.dynamics().is_some());
    assert_eq!(arm.stiffness_like(), Some(lender.name()));
    let (ours, theirs) = (arm.compliances_at(&arm.mid_range()), lender.compliances_at(&lender.mid_range()));
    assert!(ours.iter().zip(theirs).all(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{ours:?} {theirs:?}");
    // Masses are not lent.
    let message = read("name:abb-irb6640-185", like).unwrap_err().to_string();
    assert!(message.contains("joints[1].mass_kg: is missing: this robot file says nothing of masses"), "{message}");
}
