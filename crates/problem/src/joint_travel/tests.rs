use super::*;
use crate::testing::five_segments;

/// The angles of all joints, from those of joints 1 and 4. deg
fn joints([first, fourth]: [f64; 2]) -> [f64; 6] {
    [first.to_radians(), 0.0, 0.0, fourth.to_radians(), 0.0, 0.0]
}

#[test]
fn joint_travel_is_summed_and_the_largest_turn_within_25_mm_is_found() {
    // 9.6 mm from point to point.
    let line = five_segments().task.points()[..7].to_vec();
    let path = |segments: [u32; 7]| ToolPath::new(segments.into_iter().zip(line.clone())).unwrap();
    let angles = [[0.0, 0.0], [5.0, 0.0], [0.0, 10.0], [0.0, 40.0], [0.0, 70.0], [0.0, 80.0], [0.0, 60.0]];
    let joints = angles.map(joints);
    let found = JointTravel::of(&path([1; 7]), &joints);
    assert!((found.total.to_degrees() - 110.0).abs() < 1e-9, "{found:?}");
    assert!((found.largest_step.to_degrees() - 30.0).abs() < 1e-9);
    let swing = found.swing.unwrap();
    assert_eq!((swing.joint, swing.points), (4, [2, 4]));
    assert!((swing.angle.to_degrees() - 60.0).abs() < 1e-9 && (swing.length - 0.0192).abs() < 1e-9);
    // The way from segment to segment is none of the cut.
    let found = JointTravel::of(&path([1, 1, 1, 1, 2, 2, 2]), &joints);
    assert!((found.total.to_degrees() - 80.0).abs() < 1e-9);
    assert_eq!(found.swing.map(|swing| (swing.joint, swing.points)), Some((4, [1, 3])));
    let point = ToolPath::new([(1, line[0])]).unwrap();
    assert_eq!(JointTravel::of(&point, &joints[..1]).swing, None);
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
