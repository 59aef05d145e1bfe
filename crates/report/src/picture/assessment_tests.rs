//! Tests of the pictures of an assessment.

use super::indicators;
use crate::assessment::map::picture as circularity_map;
use crate::testing::assert_well_formed;
use nalgebra::{Matrix3, Vector3};
use std::sync::OnceLock;
use stead_assessment::benchmark::{Benchmark, LimitsAt, Obstacle, Plane, StiffnessModel, Turning};
use stead_assessment::comparison::{Assessment, Comparison, ElbowNames, assess};
use stead_assessment::map::{Elbow, Grid};
use stead_assessment::ranking::Selection;
use stead_model::robot::Pose;
use stead_model::task::Wrench;
use stead_numerics::monitor::Monitor;

/// The benchmark of Klimchik 2017 for two of its robots, the tool along the flange axis and towards the plane, over a
/// grid of so many steps to the metre.
fn comparison(steps: usize) -> Comparison {
    let robots = ["kr500", "kr120-r3900"];
    let robots = robots.map(|name| {
        let path = format!("{}/../../configs/robots/kuka-{name}.toml", env!("CARGO_MANIFEST_DIR"));
        stead_format::read_robot(path.as_ref()).unwrap()
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
    Comparison {
        robots: robots.to_vec(),
        benchmark,
        grid: Grid { origin: [0.0, -2.0], step: 1.0 / steps as f64, counts: [4 * steps + 1, 6 * steps + 1] },
        zones: vec![steps / 5, steps / 2, steps],
        elbow_names: ElbowNames::Geometric,
        rated_share: 0.8,
        selection: Selection { accuracies: vec![], forces: vec![], remaining_share: 0.2, gravity: 10.0 },
    }
}

fn small() -> &'static (Comparison, Assessment) {
    static SMALL: OnceLock<(Comparison, Assessment)> = OnceLock::new();
    SMALL.get_or_init(|| {
        let comparison = comparison(10);
        let assessment = assess(&comparison, &Monitor::silent()).unwrap();
        (comparison, assessment)
    })
}

#[test]
fn maps_are_well_formed_the_same_each_time_and_labelled() {
    let (comparison, assessment) = small();
    for result in &assessment.robots {
        let svg = circularity_map(comparison, result);
        assert_eq!(svg, circularity_map(comparison, result));
        assert_well_formed(&svg);
        let title = format!("{}: circularity of a circle of radius 100 mm under 1439 N, mm", result.name);
        let labels =
            ["Elbow up", "Elbow down", "x (mm)", "z (mm)", "axis 1", "shoulder", "plane y = 0 mm", "most accurate"];
        for label in labels.into_iter().chain([title.as_str(), "optimal zones", "middle zones", "circularity (mm)"]) {
            assert!(svg.contains(label), "{label}");
        }
    }
}

#[test]
fn a_map_of_ten_thousand_circles_is_small() {
    let mut comparison = comparison(40);
    comparison.benchmark.points = 8;
    comparison.robots.truncate(1);
    let assessment = assess(&comparison, &Monitor::silent()).unwrap();
    let result = &assessment.robots[0];
    let circles: Vec<usize> = result.maps.iter().map(|(_, map)| map.count()).collect();
    assert!(circles.iter().sum::<usize>() > 10_000, "{circles:?}");
    let svg = circularity_map(&comparison, result);
    assert!(svg.len() < 250_000, "{}", svg.len());
    // Finer than the picture shows.
    let mut fine = result.clone();
    for (_, map) in &mut fine.maps {
        let [columns, rows] = map.grid.counts;
        let nodes = (0..4 * rows * columns).map(|k| map.nodes[k / (2 * columns) / 2 * columns + k % (2 * columns) / 2]);
        map.nodes = nodes.collect();
        map.grid = Grid { step: map.grid.step / 2.0, counts: [2 * columns, 2 * rows], ..map.grid };
    }
    let thinned = circularity_map(&comparison, &fine);
    assert!(thinned.len() < svg.len() * 11 / 10, "{} {}", thinned.len(), svg.len());
}

#[test]
fn an_elbow_without_circles_says_so() {
    let (comparison, assessment) = small();
    let mut result = assessment.robots[0].clone();
    let mut clear = |index: usize| {
        let nodes = &mut result.maps[index].1.nodes;
        nodes.iter_mut().for_each(|node| *node = Err(Obstacle::JointLimit(5)));
        let elbow = Elbow::BOTH[index];
        for found in result.configurations.iter_mut().filter(|found| found.elbow == elbow) {
            (found.circles, found.min, found.max, found.middle) = (0, None, None, None);
            found.zones.iter_mut().for_each(|zones| (zones.optimal, zones.middle) = (None, None));
        }
        circularity_map(comparison, &result)
    };
    let svg = clear(1);
    assert_well_formed(&svg);
    assert!(svg.contains("no circle fits") && svg.contains("limit of joint 5 at 2501 of 2501 places"));
    assert!(svg.contains("circularity (mm)"));
    let svg = clear(0);
    assert_well_formed(&svg);
    assert!(!svg.contains("circularity (mm)"), "no colours without values");
}

#[test]
fn huge_and_tiny_values_are_drawn() {
    let (comparison, assessment) = small();
    for (factor, label) in [(1e9, "e9"), (1e-12, "e-"), (0.0, "smallest 0, ")] {
        let mut result = assessment.robots[0].clone();
        for (_, map) in &mut result.maps {
            map.nodes.iter_mut().flatten().for_each(|values| *values = values.map(|value| value * factor));
        }
        for found in &mut result.configurations {
            for spot in [&mut found.min, &mut found.middle, &mut found.max].into_iter().flatten() {
                spot.circularity *= factor;
            }
        }
        let svg = circularity_map(comparison, &result);
        assert_well_formed(&svg);
        assert!(svg.contains(label) && !svg.contains("NaN") && !svg.contains("inf"), "{factor}");
        assert!(svg.len() < 200_000, "{}", svg.len());
    }
}

#[test]
fn a_plane_without_axis_1_shows_no_arm() {
    let (comparison, assessment) = small();
    let mut comparison = comparison.clone();
    comparison.benchmark.plane.origin.y = 0.5;
    comparison.elbow_names = ElbowNames::Swapped;
    let svg = circularity_map(&comparison, &assessment.robots[0]);
    assert!(svg.contains("plane y = 500 mm") && svg.contains("elbow up, by the names of this study: below the line"));
    assert!(!svg.contains("axis 1") && !svg.contains("shoulder (axis 2)"));
    comparison.benchmark.plane.x = Vector3::new(0.6, 0.8, 0.0);
    let svg = circularity_map(&comparison, &assessment.robots[0]);
    assert!(svg.contains("along the plane") && svg.contains("z (mm)") && !svg.contains("x (mm)"));
}

#[test]
fn indicators_show_values_relative_to_the_best_robot() {
    let (_, assessment) = small();
    let svg = indicators(assessment);
    assert_eq!(svg, indicators(assessment));
    assert_well_formed(&svg);
    for label in ["KUKA KR 500", "KUKA KR 120 R3900", "2.825", "3.900", ">\n500\n<", ">\n120\n<", "kg", "1439 N"] {
        assert!(svg.contains(label), "{label}");
    }
    assert!(svg.contains("relative to the best robot, which has 1"));
    // No prices are known, and nothing is missing.
    assert!(!svg.contains("price") && !svg.contains('–'));
}

#[test]
fn indicators_leave_out_what_is_not_known() {
    let mut assessment = small().1.clone();
    assessment.robots[0].data_sheet.price = Some(123_456.0);
    assessment.robots[0].configurations.iter_mut().for_each(|found| found.min = None);
    let svg = indicators(&assessment);
    assert!(svg.contains("123456") && svg.contains("the lowest price"));
    // One robot has no accuracy, the other no price.
    assert_eq!(svg.matches('–').count(), 2);
    for robot in &mut assessment.robots {
        (robot.data_sheet.payload, robot.data_sheet.price) = (None, None);
    }
    let svg = indicators(&assessment);
    assert!(!svg.contains("payload") && svg.contains("working radius"));
    assessment.robots.clear();
    assert_well_formed(&indicators(&assessment));
}

#[test]
fn many_robots_stand_in_several_rows() {
    let mut assessment = small().1.clone();
    let height = |svg: &str| svg.split("height=\"").nth(1).unwrap().split('"').next().unwrap().parse::<i32>().unwrap();
    let one_row = height(&indicators(&assessment));
    for number in 0..12 {
        let mut robot = assessment.robots[0].clone();
        robot.name = format!("another robot with quite a long name {number}");
        assessment.robots.push(robot);
    }
    let svg = indicators(&assessment);
    assert!(height(&svg) > 2 * one_row && svg.contains("long name 11"));
}
