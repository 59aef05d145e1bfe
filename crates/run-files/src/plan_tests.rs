//! Plans of shipped results, read back.

use crate::read_run;
use proptest::prelude::*;
use std::path::Path;
use std::sync::OnceLock;
use stead_format::testing::root;
use stead_model::robot::Posture;
use stead_runs::Run;
use stead_runs::plan::*;

fn shipped() -> &'static Run {
    static RUN: OnceLock<Run> = OnceLock::new();
    RUN.get_or_init(|| read_run(&root().join("configs/caro-2013.toml")).unwrap())
}

fn plan(name: &str) -> Vec<u8> {
    std::fs::read(root().join("results/caro-2013").join(name)).unwrap()
}

/// Case `number` (from 1) in the shipped table of placements: x, y, z in mm, yaw in deg.
fn printed_placement(number: usize) -> [f64; 4] {
    let text = String::from_utf8(plan("placements.csv")).unwrap();
    let cells = |line: usize| text.lines().nth(line).unwrap().split(',');
    let of = |name: &str| cells(number).nth(cells(0).position(|cell| cell == name).unwrap()).unwrap();
    ["x_mm", "y_mm", "z_mm", "yaw_deg"].map(|name| of(name).parse().unwrap())
}

#[test]
fn a_plan_tells_its_placement() {
    let problem = &shipped().problem;
    for (name, number) in [("best.csv", 1), ("best-worst-plan.csv", 2), ("worst.csv", 3), ("worst-worst-plan.csv", 4)] {
        let rows = rows_from(Path::new(name), &plan(name), problem).unwrap();
        let placed = set_up(Path::new(name), &rows, problem).unwrap();
        let [x, y, z, yaw] = printed_placement(number);
        let found = &placed.placement;
        for (found, printed) in [found.x, found.y, found.z].iter().zip([x, y, z]) {
            // Rows are printed to 1e-4 mm, and 105 of them say where it is.
            assert!((found * 1e3 - printed).abs() < 2e-4, "{name} {found} {printed}");
        }
        assert!((found.yaw.to_degrees() - yaw).abs() < 1e-4, "{name}");
        assert!(placed.notes.is_empty());
        assert_eq!(placed.points.len(), 105);
        let spindle = &problem.spindle.flange_from_tool;
        for (station, row) in placed.points.iter().zip(&rows) {
            let tool = problem.robot.forward(&row.joints).then(spindle);
            assert!((tool.translation - station.base_from_tool.translation).norm() < 1e-5);
            assert!((tool.rotation - station.base_from_tool.rotation).norm() < 2e-5);
            assert!((station.normal.norm() - 1.0).abs() < 1e-12 && station.normal.z.abs() < 1e-12);
            assert_eq!(station.posture, Posture::of(&problem.robot, &station.joints));
        }
    }
}

proptest! {
    #[test]
    fn a_damaged_plan_is_read_or_refused_at_a_line(at in 0.0..1.0_f64, cut in 0..6_usize, put in "[ -~\n\u{e4}]{0,4}") {
        let problem = &shipped().problem;
        let mut bytes = plan("best.csv");
        let at = (at * bytes.len() as f64) as usize;
        let end = (at + cut).min(bytes.len());
        bytes.splice(at..end, put.bytes());
        let file = Path::new("plan.csv");
        let result = rows_from(file, &bytes, problem).and_then(|rows| set_up(file, &rows, problem));
        match result {
            Ok(placed) => prop_assert_eq!(placed.points.len(), 105),
            Err(error) => prop_assert!(error.line.is_some() && error.allowed.is_some(), "{}", error),
        }
    }
}
