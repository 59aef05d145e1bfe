//! Machines with two rotary axes: the tool axis and the tool centre point from the angles that G-code programs.
//!
//! Angles count as those of the tool against the workpiece, right-handed about the axes x (A), y (B) and z (C), as ISO
//! 841 has it for tables too. C turns the other one: the tool axis is Rz(C) Rx(A) z, or Rz(C) Ry(B) z.

use nalgebra::{Rotation3, Vector3};

stead_numerics::worded! {
    /// Which rotary axes a machine has, and what they turn.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Machine {
        /// A table that turns about z (C) on one that tilts about x (A).
        TableAc = "table-ac",
        /// A table that turns about z (C) on one that tilts about y (B).
        TableBc = "table-bc",
        /// A spindle that tilts about x (A) in a head that turns about z (C).
        HeadAc = "head-ac",
        /// A spindle that tilts about y (B) in a head that turns about z (C).
        HeadBc = "head-bc",
    }
}

impl Machine {
    /// Whether it has this rotary axis, 0 for A to 2 for C.
    pub(super) fn has(self, axis: usize) -> bool {
        axis != usize::from(matches!(self, Self::TableAc | Self::HeadAc))
    }

    /// How the tool stands in the workpiece frame at angles of A, B and C (rad).
    pub(in super::super) fn workpiece_from_tool(self, [a, b, c]: [f64; 3]) -> Rotation3<f64> {
        let (axis, angle) = if self.has(0) { (Vector3::x_axis(), a) } else { (Vector3::y_axis(), b) };
        Rotation3::from_axis_angle(&Vector3::z_axis(), c) * Rotation3::from_axis_angle(&axis, angle)
    }

    /// The tool centre point in the workpiece frame, from what is programmed without tool centre point control. m
    pub(super) fn tip(self, programmed: Vector3<f64>, angles: [f64; 3], pivot: Vector3<f64>) -> Vector3<f64> {
        let rotation = self.workpiece_from_tool(angles);
        match self {
            Self::TableAc | Self::TableBc => pivot + rotation * (programmed - pivot),
            Self::HeadAc | Self::HeadBc => programmed + pivot - rotation * pivot,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::vector;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn axes_and_tips_of_a_quarter_turn() {
        let up = |machine: Machine, angles| machine.workpiece_from_tool(angles) * Vector3::z();
        assert!((up(Machine::TableAc, [FRAC_PI_2, 0.0, 0.0]) - vector![0.0, -1.0, 0.0]).norm() < 1e-12);
        assert!((up(Machine::HeadAc, [FRAC_PI_2, 0.0, FRAC_PI_2]) - vector![1.0, 0.0, 0.0]).norm() < 1e-12);
        assert!((up(Machine::HeadBc, [0.0, FRAC_PI_2, FRAC_PI_2]) - vector![0.0, 1.0, 0.0]).norm() < 1e-12);
        // The table turns the workpiece about its pivot, the other way round.
        let turned = Machine::TableBc.tip(vector![2.0, 0.0, 5.0], [0.0, 0.0, FRAC_PI_2], vector![1.0, 0.0, 0.0]);
        assert!((turned - vector![1.0, 1.0, 5.0]).norm() < 1e-12);
        // The head swings the tip about its pivot.
        let swung = Machine::HeadBc.tip(Vector3::zeros(), [0.0, FRAC_PI_2, 0.0], vector![0.0, 0.0, 0.3]);
        assert!((swung - vector![-0.3, 0.0, 0.3]).norm() < 1e-12);
    }
}
