use super::*;
use crate::read_run;
use std::sync::OnceLock;
use stead_format::testing::root;
use stead_runs::Run;

fn shipped() -> &'static Run {
    static RUN: OnceLock<Run> = OnceLock::new();
    RUN.get_or_init(|| read_run(&root().join("configs/caro-2013.toml")).unwrap())
}

fn plan(name: &str) -> Vec<u8> {
    std::fs::read(root().join("results/caro-2013").join(name)).unwrap()
}

#[test]
fn shipped_file_is_the_best_plan_played_on_the_same_arm() {
    let run = read_compensation(&root().join("configs/compensate-caro-2013.toml"), None, &Monitor::silent()).unwrap();
    assert_eq!(run.job.robot, shipped().problem.robot);
    assert_eq!((&run.job.reality, run.has_reality), (&run.job.robot, false));
    let expected = Settings { characteristic_length: 0.682, ..Settings::default() };
    assert!((run.job.settings.tolerance - expected.tolerance).abs() < 1e-24);
    assert_eq!(Settings { tolerance: expected.tolerance, ..run.job.settings }, expected);
    let roles: Vec<&str> = run.inputs.iter().map(|input| input.role).collect();
    assert_eq!(roles, ["config", "run", "robot", "task", "plan"]);
    assert_eq!(run.inputs[4].sha256, stead_disk::input::sha256(&plan("best.csv")));
    assert!(run.notes.is_empty());
    let reality = root().join("configs/robots/kuka-kr270-2-k1-0.8.toml");
    let other =
        read_compensation(&root().join("configs/compensate-caro-2013.toml"), Some(&reality), &Monitor::silent())
            .unwrap();
    assert!(other.has_reality && other.inputs[5].role == "reality");
    assert_eq!(other.job.reality.joints()[0].compliance, (1e-6 / 0.8).into());
}
