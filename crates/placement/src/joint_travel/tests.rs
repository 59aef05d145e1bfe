use super::*;
use crate::testing::five_segments;
use nalgebra::Vector3;
use stead_model::robot::Posture;

/// A point of a plan of the five segments, the first of which is 9.6 mm from point to point, with these angles of joints 1 and 4. deg
fn point(number: usize, [first, fourth]: [f64; 2]) -> PlanPoint {
    let mut joints = [0.0; 6];
    (joints[0], joints[3]) = (first.to_radians(), fourth.to_radians());
    PlanPoint {
        point: number,
        segment: 1,
        position: Vector3::zeros(),
        beta: 0.0,
        posture: Posture::from_number(1).unwrap(),
        joints,
        inverse_condition: 1.0,
        force: Vector3::zeros(),
        deflection: Vector3::zeros(),
        feed_part: 0.0,
        normal_part: 0.0,
        axial_part: 0.0,
        surface_part: None,
        score: 0.0,
        deviation: None,
        clearance: None,
    }
}

#[test]
fn joint_travel_is_summed_and_the_largest_turn_within_25_mm_is_found() {
    let problem = five_segments();
    let path = problem.task.path();
    let angles = [[0.0, 0.0], [5.0, 0.0], [0.0, 10.0], [0.0, 40.0], [0.0, 70.0], [0.0, 80.0], [0.0, 60.0]];
    let mut points: Vec<PlanPoint> = (0..).zip(angles).map(|(number, angles)| point(number, angles)).collect();
    let found = JointTravel::of(path, &points);
    assert!((found.total.to_degrees() - 110.0).abs() < 1e-9, "{found:?}");
    assert!((found.largest_step.to_degrees() - 30.0).abs() < 1e-9);
    let swing = found.swing.unwrap();
    assert_eq!((swing.joint, swing.points), (4, [2, 4]));
    assert!((swing.angle.to_degrees() - 60.0).abs() < 1e-9 && (swing.length - 0.0192).abs() < 1e-9);
    // The way from segment to segment is none of the cut.
    points[4..].iter_mut().for_each(|point| point.segment = 2);
    let found = JointTravel::of(path, &points);
    assert!((found.total.to_degrees() - 80.0).abs() < 1e-9);
    assert_eq!(found.swing.map(|swing| (swing.joint, swing.points)), Some((4, [1, 3])));
    assert_eq!(JointTravel::of(path, &points[..1]).swing, None);
}

#[test]
fn the_widest_turn_is_that_of_plain_loops() {
    for seed in 0..40 {
        let number = |k: usize, of: f64| libm::fabs(libm::sin(of * (k + 7 * seed) as f64));
        let angles: Vec<f64> = (0..60).map(|k| 3.0 * number(k, 1.7)).collect();
        let lengths: Vec<f64> = (0..60)
            .scan(0.0, |sum, k| {
                *sum += if k == 0 { 0.0 } else { 0.03 * number(k, 2.9) };
                Some(*sum)
            })
            .collect();
        let pairs = (0..60).flat_map(|to| (0..to).map(move |from| (from, to)));
        let within = pairs.filter(|(from, to)| from + 1 == *to || lengths[*to] - lengths[*from] <= WINDOW);
        let expected = within.map(|(from, to)| (angles[to] - angles[from]).abs()).fold(0.0, f64::max);
        let (from, to) = widest(&angles, &lengths).unwrap();
        assert_eq!((angles[to] - angles[from]).abs(), expected, "{seed}");
        assert!(from + 1 == to || lengths[to] - lengths[from] <= WINDOW);
    }
}
