use super::super::testing::{layouts, measure};
use super::*;

fn effects_of(axes: &[&str], cases: &[(Vec<&str>, Option<f64>)]) -> Effects {
    let layouts = layouts(axes, cases);
    effects(&layouts, &measure(&layouts, "figure_mm", 0.0))
}

fn values(effect: &AxisEffect) -> Vec<(&str, f64)> {
    effect.levels.iter().map(|level| (level.label.as_str(), level.value)).collect()
}

fn close(found: &[(&str, f64)], expected: &[(&str, f64)]) -> bool {
    found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 1e-12)
}

/// Two arms by three heights: 10 or 20 for the arm, 0, 1 or 5 for the height, and 3 more for the second arm at the
/// third height.
fn grid() -> Vec<(Vec<&'static str>, Option<f64>)> {
    let mut cases = Vec::new();
    for (arm, base) in [("a.toml", 10.0), ("b.toml", 20.0)] {
        for (height, more) in [("100", 0.0), ("50", 1.0), ("200", 5.0)] {
            let both = if (arm, height) == ("b.toml", "200") { 3.0 } else { 0.0 };
            cases.push((vec![arm, height], Some(base + more + both)));
        }
    }
    cases
}

#[test]
fn a_grid_by_hand() {
    let found = effects_of(&["robot", "height"], &grid());
    // 10 11 15 | 20 21 28: mean 17.5; arms 12 and 23, heights (50) 16, (100) 15, (200) 21.5.
    assert_eq!((found.count, found.mean), (6, 17.5));
    let [robot, height] = &found.axes[..] else { panic!() };
    assert_eq!((robot.name.as_str(), robot.method, height.method), ("robot", Method::Means, Method::Means));
    assert!(close(&values(robot), &[("a.toml", 12.0), ("b.toml", 23.0)]));
    assert!(close(&values(height), &[("50", 16.0), ("100", 15.0), ("200", 21.5)]));
    assert_eq!((robot.range, height.range), (11.0, 6.5));
    // Squares about the mean: 233.5 in all, 181.5 of the arms, 49 of the heights.
    assert!((robot.share.unwrap() - 181.5 / 233.5).abs() < 1e-12);
    assert!((height.share.unwrap() - 49.0 / 233.5).abs() < 1e-12);
    assert!((found.remainder.unwrap() - 3.0 / 233.5).abs() < 1e-12);
    assert_eq!((robot.rank_correlation, height.best(Sense::Min).unwrap().label.as_str()), (None, "100"));
    // About (350 / 3, 17.5): heights of -200/3, -50/3, 250/3 with values of -1.5, -2.5, 4.
    let slope = (200.0 * 1.5 + 50.0 * 2.5 + 250.0 * 4.0) / ((200.0 * 200.0 + 50.0 * 50.0 + 250.0 * 250.0) / 3.0);
    assert!((height.slope.unwrap() - slope).abs() < 1e-12 && robot.slope.is_none(), "{:?}", height.slope);
    // Ranks of the heights 1 0 2 | 1 0 2 and of the values 0 1 2 | 3 4 5.
    assert!((height.rank_correlation.unwrap() - 4.0 / libm::sqrt(16.0 * 17.5)).abs() < 1e-12);
}

#[test]
fn a_case_that_failed_does_not_mix_the_axes() {
    let mut cases = grid();
    // Without what both do together, and without one of the heights for the second arm.
    cases[5].1 = Some(25.0);
    cases[3].1 = None;
    let found = effects_of(&["robot", "height"], &cases);
    let [robot, height] = &found.axes[..] else { panic!() };
    assert_eq!((robot.method, robot.levels[1].count, height.method), (Method::AdjustedMeans, 2, Method::AdjustedMeans));
    // Plain means would differ by 11 between the arms.
    assert!((robot.range - 10.0).abs() < 1e-12 && (height.range - 5.0).abs() < 1e-12);
    assert!(found.remainder.unwrap() < 1e-12);
}

#[test]
fn many_numbers_are_a_line() {
    let numbers: Vec<String> = (0..20).map(|k| format!("{}", k * k)).collect();
    let cases: Vec<_> = numbers
        .iter()
        .enumerate()
        .map(|(k, number)| {
            (vec![number.as_str(), if k % 3 == 0 { "x" } else { "y" }], Some(7.0 - 0.5 * (k * k) as f64))
        })
        .collect();
    let found = effects_of(&["k1", "side"], &cases);
    let k1 = &found.axes[0];
    assert_eq!((k1.method, found.axes[1].method), (Method::Line, Method::AdjustedMeans));
    assert!(close(&values(k1), &[("0", 7.0), ("361", -173.5)]));
    assert!((k1.slope.unwrap() + 0.5).abs() < 1e-12);
    assert!((k1.rank_correlation.unwrap() + 1.0).abs() < 1e-12 && found.axes[1].range < 1e-9);
}

#[test]
fn axes_that_go_together_are_not_told_apart() {
    let cases = [("a", "1"), ("b", "2"), ("a", "1"), ("b", "2")].map(|(a, b)| vec![a, b]);
    let cases: Vec<_> = cases.into_iter().zip([1.0, 2.0, 3.0, 4.0]).map(|(case, value)| (case, Some(value))).collect();
    let found = effects_of(&["robot", "spindle"], &cases);
    assert!(
        found.axes.iter().all(|axis| axis.method == Method::MixedMeans && axis.range == 1.0 && axis.slope.is_none())
    );
}

#[test]
fn nothing_to_tell_is_no_error() {
    let none = effects_of(&["robot"], &[(vec!["a"], None), (vec!["b"], None)]);
    assert_eq!((none.count, none.axes.len(), none.remainder), (0, 0, None));
    let same = effects_of(&["robot"], &[(vec!["a"], Some(0.1)), (vec!["b"], Some(0.1))]);
    assert_eq!((same.axes[0].share, same.axes[0].range, same.remainder), (None, 0.0, None));
}
