//! Springs beside those about the joint axes: normal to each axis, and under the base; and what the numbers of a robot
//! file stand for.
//!
//! A joint yields about its axis z, and about x and y of the frame of its row, all at one point of the axis, the
//! bearing. A joint-only identification puts what x and y do into springs about z; a full one states them apart. So the
//! springs about the axes of a full set are no joint-only set, and the two are told apart by [`SpringModel`].

use super::{Pose, Robot, RobotError};
use crate::stiffness::matrix::{MatrixError, checked};
use nalgebra::{Matrix6, Vector3};
use serde::Serialize;
use std::fmt;

/// Two springs of a joint, about the directions normal to its axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalSprings {
    /// Compliance about x and y of the frame of the row, which turns with the joint; zero is rigid. rad/(N m)
    pub compliance: [f64; 2],
    /// Where on the axis they sit: coordinate on the z axis of the row's frame. m
    pub bearing: f64,
}

stead_numerics::worded! {
    /// The axis of the frame of a row about which a spring of the joint turns.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum About {
        /// The axis of the joint.
        Z = "z",
        /// Normal to it.
        X = "x",
        /// Normal to it.
        Y = "y",
    }
}

/// A spring of the arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Spring {
    /// Its joint, from 0.
    pub joint: usize,
    /// The axis about which it turns.
    pub about: About,
}

impl fmt::Display for Spring {
    /// `joint 3 about x`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "joint {} about {}", self.joint + 1, self.about.word())
    }
}

stead_numerics::worded! {
    /// What the compliances of an arm stand for.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum SpringModel {
        /// A fit of springs about the axes alone, which absorb what links and bearings do.
        Axes = "axes",
        /// The springs about the axes of a full set, without the others: they leave out part of the deflection.
        AxialPart = "axial_part",
        /// Springs about three directions of every joint.
        Full = "full",
    }
}

stead_numerics::worded! {
    /// What the measuring instrument stood on when the compliances were identified.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum MeasuredFrom {
        /// The base of the robot: what yields under it was not seen.
        Base = "base",
        /// The floor: what yields under the base is in the compliances.
        Floor = "floor",
    }
}

/// How what carries the robot yields.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseCompliance {
    /// Where, in the base frame. m
    point: Vector3<f64>,
    /// Displacement and turn (m, rad) per force and moment (N, N m) at the point, in the base frame.
    matrix: Matrix6<f64>,
}

impl BaseCompliance {
    /// Takes the point (m) and the matrix, displacement and turn (m, rad) per force and moment (N, N m), both in the
    /// base frame.
    ///
    /// # Errors
    /// [`MatrixError`] for a matrix that is no compliance.
    pub fn new(point: Vector3<f64>, matrix: Matrix6<f64>) -> Result<Self, MatrixError> {
        Ok(Self { point, matrix: checked(matrix)? })
    }

    /// Where, in the base frame. m
    pub fn point(&self) -> &Vector3<f64> {
        &self.point
    }

    /// Displacement and turn (m, rad) per force and moment (N, N m) at the point, in the base frame.
    pub fn matrix(&self) -> &Matrix6<f64> {
        &self.matrix
    }
}

/// What a robot has of all this.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Springs {
    model: Option<SpringModel>,
    measured_from: Option<MeasuredFrom>,
    normal: Option<[NormalSprings; 6]>,
    base: Option<BaseCompliance>,
}

impl Robot {
    /// What the compliances stand for, where that is stated.
    pub fn spring_model(&self) -> Option<SpringModel> {
        self.springs.model
    }

    /// The same arm with compliances that stand for this.
    #[must_use]
    pub fn with_spring_model(mut self, model: Option<SpringModel>) -> Self {
        self.springs.model = model;
        self
    }

    /// What the instrument stood on when the compliances were identified, where that is stated.
    pub fn stiffness_measured_from(&self) -> Option<MeasuredFrom> {
        self.springs.measured_from
    }

    /// The same arm with compliances measured from there.
    #[must_use]
    pub fn with_stiffness_measured_from(mut self, from: Option<MeasuredFrom>) -> Self {
        self.springs.measured_from = from;
        self
    }

    /// The springs normal to the axes that are stated, whether deflections count them or not.
    pub fn stated_normal_springs(&self) -> Option<&[NormalSprings; 6]> {
        self.springs.normal.as_ref()
    }

    /// The springs normal to the axes that deflections count: those of a full set.
    pub fn normal_springs(&self) -> Option<&[NormalSprings; 6]> {
        self.springs.normal.as_ref().filter(|_| self.springs.model == Some(SpringModel::Full))
    }

    /// The same arm with these springs normal to its axes, or without any.
    ///
    /// # Errors
    /// [`RobotError`] for a compliance that is negative or not finite, or a bearing that is not finite.
    pub fn with_normal_springs(mut self, normal: Option<[NormalSprings; 6]>) -> Result<Self, RobotError> {
        for (joint, springs) in normal.iter().flatten().enumerate() {
            let joint = joint + 1;
            let [x, y] = springs.compliance;
            for (field, value) in [(NORMAL, x), (NORMAL, y), ("bearing", springs.bearing)] {
                if !value.is_finite() {
                    return Err(RobotError::NotFinite { joint, field, value });
                }
            }
            for value in [x, y] {
                if value < 0.0 {
                    return Err(RobotError::Negative { joint, field: NORMAL, value });
                }
            }
        }
        self.springs.normal = normal;
        Ok(self)
    }

    /// How what carries the robot yields, where that counts.
    pub fn base_compliance(&self) -> Option<&BaseCompliance> {
        self.springs.base.as_ref()
    }

    /// The same arm on a base that yields.
    #[must_use]
    pub fn with_base_compliance(mut self, base: Option<BaseCompliance>) -> Self {
        self.springs.base = base;
        self
    }

    /// The base compliance as the arm is mounted: pose of the frame of its matrix in the frame in which the arm is
    /// given, its origin where the base yields.
    pub fn yielding_base(&self) -> Option<(Pose<f64>, &Matrix6<f64>)> {
        let base = self.springs.base.as_ref()?;
        let at_point = Pose { translation: base.point, ..Pose::identity() };
        Some((self.cell_from_base().then(&at_point), &base.matrix))
    }
}

/// The name of a compliance normal to an axis among the numbers of a row.
const NORMAL: &str = "orthogonal_compliance";

#[cfg(test)]
mod tests {
    use super::super::testing::kr270;
    use super::*;

    fn springs(compliance: [f64; 2], bearing: f64) -> Option<[NormalSprings; 6]> {
        let mut all = [NormalSprings { compliance: [1e-7, 2e-7], bearing: 0.1 }; 6];
        all[2] = NormalSprings { compliance, bearing };
        Some(all)
    }

    #[test]
    fn springs_that_are_none_are_refused() {
        let with = |compliance, bearing| kr270().with_normal_springs(springs(compliance, bearing)).unwrap_err();
        assert!(matches!(with([1e-7, -1e-9], 0.0), RobotError::Negative { joint: 3, value, .. } if value == -1e-9));
        assert!(matches!(with([f64::NAN, 0.0], 0.0), RobotError::NotFinite { joint: 3, .. }));
        assert!(matches!(with([0.0, 0.0], f64::INFINITY), RobotError::NotFinite { field: "bearing", .. }));
        assert!(kr270().with_normal_springs(springs([0.0, 0.0], 0.0)).is_ok());
    }

    #[test]
    fn only_a_full_set_counts_and_other_compliances_or_limits_keep_it() {
        let stated = kr270().with_normal_springs(springs([3e-7, 0.0], -0.2)).unwrap();
        assert!(stated.stated_normal_springs().is_some() && stated.normal_springs().is_none());
        for model in [SpringModel::Axes, SpringModel::AxialPart] {
            assert!(stated.clone().with_spring_model(Some(model)).normal_springs().is_none());
        }
        let full = stated.with_spring_model(Some(SpringModel::Full));
        let full = full.with_stiffness_measured_from(Some(MeasuredFrom::Base));
        let softer = full.with_compliances([1e-6; 6]).unwrap();
        let narrow = full.with_joint_margin(0.01).unwrap();
        for arm in [&full, &softer, &narrow] {
            assert_eq!(arm.normal_springs(), springs([3e-7, 0.0], -0.2).as_ref());
            assert_eq!(arm.stiffness_measured_from(), Some(MeasuredFrom::Base));
        }
    }
}
