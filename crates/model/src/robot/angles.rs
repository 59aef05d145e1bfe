//! Angles: wrapping, and the quaternion component Q4 by which the paper states a yaw.

use std::f64::consts::{PI, TAU};

/// The angle modulo a full turn, in (-pi, pi]. rad.
pub fn wrap(angle: f64) -> f64 {
    let turned = angle - TAU * (angle / TAU).round();
    if turned <= -PI { turned + TAU } else { turned }
}

/// Joint angles known modulo a turn, in the turns nearest to given ones. rad
pub fn nearest_turns(wrapped: &[f64; 6], near: &[f64; 6]) -> [f64; 6] {
    std::array::from_fn(|j| near[j] + wrap(wrapped[j] - near[j]))
}

/// Yaw gamma of a workpiece turned about the vertical, from Q4 = sin(gamma / 2), Q1 = cos(gamma / 2) >= 0
/// (Caro 2013, eq. 1-6). `q4` in [-1, 1]; the yaw is in [-pi, pi].
pub fn yaw_from_q4(q4: f64) -> f64 {
    2.0 * libm::asin(q4.clamp(-1.0, 1.0))
}

/// The inverse of [`yaw_from_q4`], for any yaw in rad. A yaw of pi is read as Q4 = 1.
pub fn q4_from_yaw(yaw: f64) -> f64 {
    libm::sin(wrap(yaw) / 2.0)
}

/// `bound` is allowed to be missed by this much (rad) before a joint limit counts as broken: rounding, not tolerance.
pub const ANGLE_ROUNDING: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn wrapped_angle_is_the_same_direction_inside_one_turn(angle in -50.0..50.0_f64) {
            let wrapped = wrap(angle);
            prop_assert!(wrapped > -PI && wrapped <= PI);
            let turns = (angle - wrapped) / TAU;
            prop_assert!((turns - turns.round()).abs() < 1e-12);
        }

        #[test]
        fn q4_and_yaw_are_inverse(q4 in -1.0..1.0_f64) {
            prop_assert!((q4_from_yaw(yaw_from_q4(q4)) - q4).abs() < 1e-12);
        }
    }

    #[test]
    fn half_turn_is_read_as_plus_one() {
        assert_eq!(q4_from_yaw(PI), 1.0);
        assert_eq!(q4_from_yaw(-PI), 1.0);
    }
}
