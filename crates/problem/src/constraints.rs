//! The constraints of a placement problem, by kind.
//!
//! Whatever evaluates states or plans by a shortcut declares which kinds it evaluates; what it relaxes are the
//! constraints in force less these.

mod measured;

pub use measured::{Measured, STEP_ROUNDING, joint_steps_hold, on_joint_steps, on_joints, on_state};

use super::problem::Problem;
use serde::Serialize;

/// A kind of constraint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ConstraintKind {
    /// Steps of the joints from path point to path point, by their speeds.
    JointStep,
    /// The turns of the joints along a segment.
    JointTurn,
    /// The allowed postures, and whether they may change between segments.
    Posture,
    /// The arm reaches the point.
    Reach,
    /// The limits of a joint, from 1.
    JointLimit(u8),
    /// The limits of the sum of joints 2 and 3.
    AxesSum,
    /// The bound on 1/kappa_F.
    Conditioning,
    /// The rate of beta along the path.
    BetaRate,
    /// The turn of the spindle in space along the path.
    SpindleTurn,
    /// The largest score of a point.
    MaxDeflection,
    /// The smallest distance of a path point from axis 1.
    BaseDistance,
    /// The distance of shapes on the arm and around it, and zones that the arm keeps out of.
    Clearance,
    /// The bounds of the cell on x, y and z.
    CellPosition,
    /// The bounds of the cell on the yaw.
    CellYaw,
}

impl ConstraintKind {
    /// A short code, as tables state it.
    pub fn code(self) -> String {
        match self {
            Self::JointStep => "joint_step".to_owned(),
            Self::JointTurn => "joint_turn".to_owned(),
            Self::Posture => "posture".to_owned(),
            Self::Reach => "reach".to_owned(),
            Self::JointLimit(joint) => format!("joint_{joint}"),
            Self::AxesSum => "axes_2_3".to_owned(),
            Self::Conditioning => "conditioning".to_owned(),
            Self::BetaRate => "beta_rate".to_owned(),
            Self::SpindleTurn => "spindle_turn".to_owned(),
            Self::MaxDeflection => "deflection".to_owned(),
            Self::BaseDistance => "base_distance".to_owned(),
            Self::Clearance => "clearance".to_owned(),
            Self::CellPosition => "cell_position".to_owned(),
            Self::CellYaw => "cell_yaw".to_owned(),
        }
    }
}

impl Problem {
    /// The kinds of constraint that are in force.
    pub fn constraint_kinds(&self) -> Vec<ConstraintKind> {
        use ConstraintKind::*;
        let mut kinds = vec![JointStep, JointTurn, Reach];
        kinds.extend((1..=6).map(JointLimit));
        kinds.extend(self.robot.sum_range().map(|_| AxesSum));
        kinds.push(Conditioning);
        kinds.extend(self.redundancy.max_beta_rate.map(|_| BetaRate));
        let turns = [self.redundancy.max_spindle_turn, self.redundancy.max_spindle_speed];
        kinds.extend(turns.iter().any(Option::is_some).then_some(SpindleTurn));
        kinds.extend(self.constraints.max_deflection.map(|_| MaxDeflection));
        kinds.extend((self.constraints.min_base_distance > 0.0).then_some(BaseDistance));
        let is_free = self.postures.may_change && self.postures.allowed().count() == 8;
        kinds.extend((!is_free).then_some(Posture));
        kinds.extend(self.scene.as_ref().map(|_| Clearance));
        kinds.push(CellPosition);
        kinds.extend((!self.cell.is_yaw_free()).then_some(CellYaw));
        kinds
    }
}

/// What an evaluation of the kinds `evaluated` relaxes: the constraints in force less these.
pub fn relaxed(problem: &Problem, evaluated: &[ConstraintKind]) -> Vec<ConstraintKind> {
    problem.constraint_kinds().into_iter().filter(|kind| !evaluated.contains(kind)).collect()
}

/// Names kinds of constraint as files and sentences do, those of a sort together.
pub fn describe(kinds: &[ConstraintKind]) -> Vec<String> {
    use ConstraintKind::*;
    let mut words = Vec::new();
    match [JointStep, JointTurn].map(|kind| kinds.contains(&kind)) {
        [true, true] => words.push("steps and turns of the joints between path points".to_owned()),
        [true, false] => words.push("steps of the joints between path points".to_owned()),
        [false, true] => words.push("turns of the joints between path points".to_owned()),
        [false, false] => {}
    }
    let limits: Vec<String> = kinds
        .iter()
        .filter_map(|kind| if let JointLimit(joint) = kind { Some(joint.to_string()) } else { None })
        .collect();
    match &limits[..] {
        [] => {}
        [joint] => words.push(format!("limits of joint {joint}")),
        [first @ .., last] => words.push(format!("limits of joints {} and {last}", first.join(", "))),
    }
    words.extend(kinds.iter().filter_map(|kind| {
        match kind {
            JointStep | JointTurn | JointLimit(_) => None,
            Posture => Some("allowed postures"),
            Reach => Some("reach"),
            AxesSum => Some("limits of the sum of joints 2 and 3"),
            Conditioning => Some("conditioning"),
            BetaRate => Some("rate of beta"),
            SpindleTurn => Some("turn of the spindle"),
            MaxDeflection => Some("max_deflection_mm"),
            BaseDistance => Some("distance of the path from axis 1"),
            Clearance => Some("clearance of the shapes"),
            CellPosition => Some("bounds of x, y and z"),
            CellYaw => Some("which yaw goes with which x and y"),
        }
        .map(str::to_owned)
    }));
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::batch::{BatchEvaluator, Flips};
    use crate::testing::five_segments;

    #[test]
    fn what_is_not_evaluated_is_relaxed_and_named() {
        let mut problem = five_segments();
        assert_eq!(relaxed(&problem, &problem.constraint_kinds()), []);
        let in_force = problem.constraint_kinds().len();
        problem.constraints.max_deflection = Some(1e-3);
        problem.constraints.min_base_distance = 0.3;
        problem.cell.yaw.max = 1.0;
        problem.redundancy.max_spindle_speed = Some(1.0);
        assert_eq!(problem.constraint_kinds().len(), in_force + 4);
        let all = relaxed(&problem, &[]);
        // The joints' limits are one name, and so are their steps and turns.
        assert_eq!(describe(&all).len(), all.len() - 6);
        let some = [ConstraintKind::JointTurn, ConstraintKind::JointLimit(4), ConstraintKind::CellYaw];
        let words =
            ["turns of the joints between path points", "limits of joint 4", "which yaw goes with which x and y"];
        assert_eq!(describe(&some), words);
    }

    #[test]
    fn shortcuts_declare_what_they_relax() {
        let mut problem = five_segments();
        problem.constraints.max_deflection = Some(1e-3);
        problem.constraints.min_base_distance = 0.3;
        problem.redundancy.max_spindle_turn = Some(1.0);
        use ConstraintKind::*;
        let batch = BatchEvaluator::new(&problem, &problem.redundancy, Flips::Both);
        assert_eq!(batch.relaxed(), [JointStep, JointTurn, BetaRate, SpindleTurn, CellPosition]);
    }
}
