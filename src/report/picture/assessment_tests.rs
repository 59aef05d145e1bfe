//! Tests of the pictures of an assessment.

use super::{circularity_map, indicators};
use crate::assessment::benchmark::{Benchmark, LimitsAt, Obstacle, Plane, StiffnessModel, Turning};
use crate::assessment::map::{Elbow, Grid};
use crate::assessment::ranking::Selection;
use crate::assessment::study::{Assessment, ElbowNames, Study, assess};
use crate::report::testing::assert_well_formed;
use crate::robot::Pose;
use crate::task::Wrench;
use nalgebra::{Matrix3, Vector3};
use std::sync::OnceLock;

/// The benchmark of Klimchik 2017 for two of its robots, the tool along the flange axis and towards the plane, over a grid of
/// so many steps to the metre.
fn study(steps: usize) -> Study {
    let robots = ["kr500", "kr120-r3900"];
    let robots = robots.map(|name| {
        let path = format!("{}/configs/robots/kuka-{name}.toml", env!("CARGO_MANIFEST_DIR"));
        crate::config::read_robot(path.as_ref()).unwrap()
    });
    let benchmark = Benchmark {
        plane: Plane::XOZ,
        radius: 0.1,
        points: 12,
        wrench: Wrench { force: Vector3::new(-440.0, -1370.0, -635.0), moment: Vector3::new(0.0, 3.0, 10.5) },
        turning: Turning::WithTool,
        base_from_tool: Matrix3::from_columns(&[Vector3::x(), -Vector3::z(), Vector3::y()]),
        flange_from_tool: Some(Pose { rotation: Matrix3::identity(), translation: Vector3::zeros() }),
        yielding: [true; 6],
        limits_at: LimitsAt::Circle,
        stiffness: StiffnessModel::Unloaded,
    };
    Study {
        robots: robots.to_vec(),
        benchmark,
        grid: Grid { origin: [0.0, -2.0], step: 1.0 / steps as f64, counts: [4 * steps + 1, 6 * steps + 1] },
        zones: vec![steps / 5, steps / 2, steps],
        elbow_names: ElbowNames::Geometric,
        range_share: None,
        rated_share: 0.8,
        selection: Selection { accuracies: vec![], forces: vec![], remaining_share: 0.2, gravity: 10.0 },
    }
}

fn small() -> &'static (Study, Assessment) {
    static SMALL: OnceLock<(Study, Assessment)> = OnceLock::new();
    SMALL.get_or_init(|| {
        let study = study(10);
        let assessment = assess(&study, &|_, _| ()).unwrap();
        (study, assessment)
    })
}

#[test]
fn maps_are_well_formed_the_same_each_time_and_labelled() {
    let (study, assessment) = small();
    for result in &assessment.robots {
        let svg = circularity_map(study, result).unwrap();
        assert_eq!(svg, circularity_map(study, result).unwrap());
        assert_well_formed(&svg);
        let title = format!("{}: circularity of a circle of radius 100 mm under 1439 N, mm", result.name);
        let labels =
            ["Elbow up", "Elbow down", "x (mm)", "z (mm)", "axis 1", "shoulder", "plane y = 0 mm", "most accurate"];
        for label in labels.into_iter().chain([title.as_str(), "optimal zones", "middle zones", "circularity (mm)"]) {
            assert!(svg.contains(label), "{label}");
        }
    }
}
