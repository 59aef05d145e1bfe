//! What joins axes 2 and 3: the range of their sum, and the parallelogram that drives axis 3 of some arms.
//!
//! The sum `theta_2 + theta_3` is how far the forearm is turned against the base (`theta_2 - theta_3` where the axis of
//! row 3 points against that of row 2). With a parallelogram the motor of axis 3 sits beside that of axis 2 and turns
//! the forearm by a rod: what it turns is the sum, and what yields are `theta_2`, the sum held, and the sum.

use super::{Compliance, Robot, RobotError, turns::Range};
use stead_numerics::scalar::Scalar;

/// What joins axes 2 and 3 of an arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axes23 {
    /// Whether a parallelogram drives axis 3.
    pub linkage: bool,
    /// The range of the sum of their joint angles. rad
    pub sum: Range,
}

/// A range of the sum may be wider than those of the axes allow by this. rad
const ROUNDING: f64 = 1e-9;

impl Robot {
    /// What joins axes 2 and 3, where anything is stated.
    pub fn axes_2_3(&self) -> Option<&Axes23> {
        self.axes_2_3.as_ref()
    }

    /// The same arm with axes 2 and 3 joined like this.
    ///
    /// # Errors
    /// [`RobotError`] for a range of the sum that is none or that the ranges of the axes do not allow, axes 2 or 3 that
    /// turn by a whole turn, or a compliance of joint 3 that changes with its angle on an arm with a linkage.
    pub fn with_axes_2_3(mut self, axes_2_3: Option<Axes23>) -> Result<Self, RobotError> {
        if let Some(Axes23 { linkage, sum }) = axes_2_3 {
            for (field, value) in [("sum_min", sum.min), ("sum_max", sum.max)] {
                if !value.is_finite() {
                    return Err(RobotError::Sum { field, reason: format!("is {value} in SI units") });
                }
            }
            if sum.min >= sum.max {
                let reason = format!("is not below sum_max = {:.4} deg", sum.max.to_degrees());
                return Err(RobotError::Sum { field: "sum_min", reason });
            }
            for joint in [1, 2] {
                if Range::of(&self.joints[joint]).has_turns() {
                    let reason = format!("needs a range of less than 360 deg of joint {}", joint + 1);
                    return Err(RobotError::Sum { field: "sum_max", reason });
                }
            }
            let [min, max] = self.sums();
            for (field, is_beyond) in [("sum_min", sum.min < min - ROUNDING), ("sum_max", sum.max > max + ROUNDING)] {
                if is_beyond {
                    let [min, max] = [min, max].map(f64::to_degrees);
                    let reason = format!("is beyond what the ranges of joints 2 and 3 allow, {min:.4} to {max:.4} deg");
                    return Err(RobotError::Sum { field, reason });
                }
            }
            if linkage && !matches!(self.joints[2].compliance, Compliance::Constant(_)) {
                let reason = "drives joint 3, whose compliance changes with its angle".to_owned();
                return Err(RobotError::Sum { field: "linkage", reason });
            }
        }
        self.axes_2_3 = axes_2_3;
        Ok(self)
    }

    /// Whether a parallelogram drives axis 3.
    pub fn has_linkage(&self) -> bool {
        self.axes_2_3.is_some_and(|axes| axes.linkage)
    }

    /// The range of the sum of joint angles 2 and 3, where it is stated. rad
    pub fn sum_range(&self) -> Option<Range> {
        self.axes_2_3.map(|axes| axes.sum)
    }

    /// The sums that the ranges of joints 2 and 3 allow by themselves, the least and the largest. rad
    pub fn sums(&self) -> [f64; 2] {
        self.sums_within([1, 2].map(|joint| [self.joints[joint].min, self.joints[joint].max]))
    }

    /// The least and the largest sum with joints 2 and 3 in ranges. rad
    pub fn sums_within(&self, ranges: [[f64; 2]; 2]) -> [f64; 2] {
        let [second, third] = ranges;
        let [from, to] = if self.geometry.fold < 0.0 { [-third[1], -third[0]] } else { third };
        [second[0] + from, second[1] + to]
    }

    /// The sum of joint angles 2 and 3 (rad): how far the forearm is turned against the base.
    pub fn sum_of<T: Scalar>(&self, theta: &[T; 6]) -> T {
        theta[1] + theta[2].scale(self.geometry.fold)
    }

    /// How far joint angles (rad), real ones, are beyond the range of their sum; nothing inside or where there is none.
    pub fn beyond_sum(&self, theta: &[f64; 6]) -> f64 {
        let beyond = |range: Range| {
            let sum = self.sum_of(theta);
            (range.min - sum).max(sum - range.max).max(0.0)
        };
        self.sum_range().map_or(0.0, beyond)
    }

    /// The angles that the motors turn at joint angles: those of the joints, but the sum of 2 and 3 in the place of
    /// joint 3 on an arm with a linkage. rad
    #[inline]
    pub fn drives(&self, theta: &[f64; 6]) -> [f64; 6] {
        let mut drives = *theta;
        if self.has_linkage() {
            drives[2] = self.sum_of(theta);
        }
        drives
    }

    /// The ranges of these angles. rad
    pub fn drive_ranges(&self) -> [Range; 6] {
        let mut ranges = self.joints.each_ref().map(Range::of);
        if let Some(Axes23 { linkage: true, sum }) = self.axes_2_3 {
            ranges[2] = sum;
        }
        ranges
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{irb4400, kr270, odd_arms};
    use super::super::{Frames, Joint};
    use super::*;

    fn with(linkage: bool, min_deg: f64, max_deg: f64) -> Result<Robot, RobotError> {
        let sum = Range { min: min_deg.to_radians(), max: max_deg.to_radians() };
        kr270().with_axes_2_3(Some(Axes23 { linkage, sum }))
    }

    #[test]
    fn what_joins_no_axes_is_refused() {
        let refused = |result: Result<Robot, RobotError>| result.unwrap_err().to_string();
        // Joints 2 and 3 go from 0 to 146 and from -245 to 29 deg.
        assert!(with(true, -245.0, 175.0).is_ok());
        assert!(refused(with(true, -245.1, 100.0)).contains("sum_min is beyond what the ranges of joints 2 and 3"));
        assert!(refused(with(false, -245.0, 175.1)).contains("-245.0000 to 175.0000 deg"));
        assert!(refused(with(true, 10.0, 10.0)).contains("sum_min is not below sum_max = 10"));
        assert!(refused(with(true, f64::NAN, 10.0)).contains("sum_min is NaN"));
        assert!(refused(with(true, 0.0, f64::INFINITY)).contains("sum_max is inf"));
        let turning = |joint: usize| {
            let mut joints = kr270().joints().clone();
            joints[joint] = Joint { min: -3.2, max: 3.2, ..joints[joint].clone() };
            let sum = Range { min: -1.0, max: 1.0 };
            refused(Robot::new("x", joints).unwrap().with_axes_2_3(Some(Axes23 { linkage: false, sum })))
        };
        assert!(turning(1).contains("less than 360 deg of joint 2") && turning(2).contains("deg of joint 3"));
        let mut joints = kr270().joints().clone();
        joints[2].compliance = Compliance::Range { at_min: 1e-7, at_max: 2e-7 };
        let varying = Robot::new("x", joints.clone()).unwrap();
        let sum = Range { min: -1.0, max: 1.0 };
        assert!(varying.clone().with_axes_2_3(Some(Axes23 { linkage: false, sum })).is_ok());
        let with = |linkage| varying.clone().with_axes_2_3(Some(Axes23 { linkage, sum }));
        assert!(refused(with(true)).contains("linkage drives joint 3, whose compliance changes"));
        // Other compliances keep the linkage, and are refused where it does not allow them.
        let linked = kr270().with_axes_2_3(Some(Axes23 { linkage: true, sum })).unwrap();
        assert!(linked.with_compliances([1e-6; 6]).unwrap().has_linkage());
        assert!(linked.with_compliances(joints.map(|joint| joint.compliance)).is_err());
    }

    #[test]
    fn the_sum_is_the_turn_of_the_forearm_and_motor_3_turns_it() {
        let (a, b) = ([0.3, 0.5, -1.4, 0.2, 0.9, 1.0], [0.3, 0.9, 0.0, 0.2, 0.9, 1.0]);
        for arm in odd_arms() {
            let fold = arm.geometry().fold;
            // Joint 3 such that the sum stays.
            let mut held = b;
            held[2] = a[2] + fold * (a[1] - b[1]);
            assert!((arm.sum_of(&a) - arm.sum_of(&held)).abs() < 1e-15);
            let axes = |theta: &[f64; 6]| Frames::new(&arm, theta).axes[3];
            assert!((axes(&a) - axes(&held)).norm() < 1e-14);
            assert_eq!(arm.drives(&a), a);
        }
        let linked = with(true, -155.0, -30.0).unwrap();
        assert_eq!(linked.drives(&a), [0.3, 0.5, 0.5 - 1.4, 0.2, 0.9, 1.0]);
        assert!((linked.beyond_sum(&b) - (0.9 + 30_f64.to_radians())).abs() < 1e-15);
        assert_eq!(linked.beyond_sum(&a), 0.0);
        let narrow = linked.with_joint_margin(0.1).unwrap();
        let [wide, narrow] = [&linked, &narrow].map(|arm| arm.sum_range().unwrap());
        assert!((narrow.min - wide.min - 0.1).abs() < 1e-15 && (wide.max - narrow.max - 0.1).abs() < 1e-15);
    }

    /// The two rows of ABB's IRB 8700: A3, which its controller counts against the horizontal, from -30 deg whatever
    /// A2, and A3 - A2, the angle between the links, up to 67 deg (RobotComponents, issue 181).
    #[test]
    fn the_irb_8700_has_a_range_of_a3_and_one_of_a3_less_a2() {
        let counted_so = irb4400();
        let mut joints = counted_so.joints().clone();
        // theta_3 = -180 deg - (A3 - A2), and theta_2 + theta_3 = -90 deg - A3; the other ends are wide.
        (joints[2].min, joints[2].max) = ((-180.0_f64 - 67.0).to_radians(), -90_f64.to_radians());
        let sum = Range { min: -200_f64.to_radians(), max: (-90.0_f64 + 30.0).to_radians() };
        let arm = Robot::new("irb8700", joints).unwrap().with_axes_2_3(Some(Axes23 { linkage: true, sum })).unwrap();
        let controller = counted_so.controller().unwrap();
        // Whether angles of the controller in degrees are within the row of A3, and within that of A3 - A2.
        let within = |a2: f64, a3: f64| {
            let theta = controller.joints(&arm, &[0.0, a2.to_radians(), a3.to_radians(), 0.0, 0.0, 0.0]);
            [arm.beyond_sum(&theta) < 1e-9, !arm.joints()[2].is_beyond(theta[2], 1e-9)]
        };
        for (a2, highest) in [(0.0, 67.0), (15.0, 82.0), (30.0, 97.0)] {
            assert_eq!([within(a2, -30.0), within(a2, highest)], [[true; 2]; 2], "A2 = {a2}");
            assert_eq!(within(a2, -30.1), [false, true], "A2 = {a2}");
            assert_eq!(within(a2, highest + 0.1), [true, false], "A2 = {a2}");
        }
    }
}
