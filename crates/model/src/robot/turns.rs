//! Joint limits and turns.
//!
//! A joint whose range is a full turn or more can stand at several real angles that look the same. The inverse
//! kinematics gives one wrapped angle; here are the real ones.

use super::{Joint, angles::ANGLE_ROUNDING};
use std::f64::consts::TAU;

/// The range of real angles of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Lower limit. rad
    pub min: f64,
    /// Upper limit. rad
    pub max: f64,
}

impl Range {
    /// The limits of a joint.
    pub fn of(joint: &Joint) -> Self {
        Self { min: joint.min, max: joint.max }
    }

    /// Whether some wrapped angle has two real ones.
    pub fn has_turns(&self) -> bool {
        self.max - self.min >= TAU - ANGLE_ROUNDING
    }

    /// The smallest real angle not below the lower limit. rad
    pub fn lowest(&self, angle: f64) -> f64 {
        let turns = ((self.min - ANGLE_ROUNDING - angle) / TAU).ceil();
        angle + TAU * turns
    }

    /// All real angles inside the limits, ascending. rad
    pub fn real_angles(&self, angle: f64) -> impl Iterator<Item = f64> + use<> {
        let (lowest, max) = (self.lowest(angle), self.max + ANGLE_ROUNDING);
        (0..).map(move |k| lowest + TAU * f64::from(k)).take_while(move |real| *real <= max)
    }

    /// The real angle nearest to the range, and by how much it is outside (zero inside). rad
    pub fn nearest(&self, angle: f64) -> (f64, f64) {
        let above = self.lowest(angle);
        let excess_above = (above - self.max).max(0.0);
        if excess_above <= ANGLE_ROUNDING {
            return (above, 0.0);
        }
        let below = above - TAU;
        let excess_below = self.min - below;
        if excess_above <= excess_below { (above, excess_above) } else { (below, excess_below) }
    }
}

/// All real joint angles inside the limits of an arm, and of the sum of angles 2 and 3, that are given angles (rad) but
/// for whole turns: ascending, those of joint 6 change first.
#[cfg(any(test, feature = "testing"))]
pub fn real_configurations(robot: &super::Robot, angles: &[f64; 6]) -> Vec<[f64; 6]> {
    let mut configurations = vec![*angles];
    for (j, range) in robot.joints().iter().map(Range::of).enumerate() {
        let turned = configurations.iter().flat_map(|known| {
            range.real_angles(angles[j]).map(|real| {
                let mut next = *known;
                next[j] = real;
                next
            })
        });
        configurations = turned.collect();
    }
    configurations.retain(|real| robot.beyond_sum(real) <= ANGLE_ROUNDING);
    configurations
}

/// Full turns of a real angle: what it has beyond its wrapped value in (-pi, pi].
pub fn turns(real: f64) -> i32 {
    ((real - super::angles::wrap(real)) / TAU).round() as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn range(min_deg: f64, max_deg: f64) -> Range {
        Range { min: min_deg.to_radians(), max: max_deg.to_radians() }
    }

    #[test]
    fn a_joint_of_350_deg_either_way_has_up_to_two_real_angles() {
        let wide = range(-350.0, 350.0);
        let at =
            |deg: f64| wide.real_angles(deg.to_radians()).map(|a| a.to_degrees().round() as i32).collect::<Vec<_>>();
        assert_eq!(at(20.0), [-340, 20]);
        assert_eq!(at(5.0), [5]);
        assert_eq!(at(-20.0), [-20, 340]);
        assert_eq!(at(350.0), [-10, 350]);
        assert!(wide.has_turns() && !range(-125.0, 125.0).has_turns());
    }

    #[test]
    fn limits_belong_to_the_range_and_the_excess_is_to_the_nearer_one() {
        let narrow = range(-245.0, 29.0);
        assert_eq!(narrow.real_angles(29.0_f64.to_radians()).count(), 1);
        assert_eq!(narrow.real_angles(115.0_f64.to_radians()).count(), 1);
        assert_eq!(narrow.real_angles(40.0_f64.to_radians()).count(), 0);
        let (real, by) = narrow.nearest(40.0_f64.to_radians());
        assert!((real.to_degrees() - 40.0).abs() < 1e-9 && (by.to_degrees() - 11.0).abs() < 1e-9);
        let (real, by) = narrow.nearest(100.0_f64.to_radians());
        assert!((real.to_degrees() + 260.0).abs() < 1e-9 && (by.to_degrees() - 15.0).abs() < 1e-9);
    }

    proptest! {
        #[test]
        fn turns_undo_wrapping(real in -12.0..12.0_f64) {
            let wrapped = super::super::angles::wrap(real);
            prop_assert!((wrapped + TAU * f64::from(turns(real)) - real).abs() < 1e-12);
        }
    }
}
