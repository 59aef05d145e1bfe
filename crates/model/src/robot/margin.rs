//! Joint limits with a margin kept from them.

use super::turns::Range;
use super::uncertainty::{Parameter, Uncertainty};
use super::{Axes23, Compliance, Joint, Robot, RobotError};
use nalgebra::DMatrix;

impl Robot {
    /// The same arm with every limit of the joints and of the sum of 2 and 3 `margin` (rad) further inside, and the
    /// same compliance at every angle that is left; with the margin negated, the arm before that again.
    ///
    /// # Errors
    /// [`RobotError::Limits`] for the first joint, [`RobotError::Sum`] for the sum, of which nothing is left.
    pub fn with_joint_margin(&self, margin: f64) -> Result<Self, RobotError> {
        let joints = self.joints().clone().map(|joint| {
            let share = margin / (joint.max - joint.min);
            let compliance = match joint.compliance {
                Compliance::Range { at_min, at_max } => {
                    let change = (at_max - at_min) * share;
                    Compliance::Range { at_min: at_min + change, at_max: at_max - change }
                }
                law => law,
            };
            Joint { min: joint.min + margin, max: joint.max - margin, compliance, ..joint }
        });
        let narrowed = Self::new(self.name(), joints)?;
        let axes_2_3 = match self.axes_2_3 {
            Some(Axes23 { linkage, sum }) => {
                let sum = Range { min: sum.min + margin, max: sum.max - margin };
                if sum.min >= sum.max {
                    let reason = format!("is not below sum_max = {:.4} deg", sum.max.to_degrees());
                    return Err(RobotError::Sum { field: "sum_min", reason });
                }
                Some(Axes23 { linkage, sum })
            }
            None => None,
        };
        let robot = Self { joints: narrowed.joints, uncertainty: None, axes_2_3, ..self.clone() };
        // Covariances stay positive semidefinite, and parameters those of the laws: nothing to refuse.
        match self.uncertainty().and_then(|known| moved(known, self.joints(), margin)) {
            Some(uncertainty) => Ok(robot.clone().with_uncertainty(uncertainty).unwrap_or(robot)),
            None => Ok(robot),
        }
    }
}

/// What is known of the compliances, of ranges at the ends of the narrowed limits: a linear map of the parameters.
fn moved(known: &Uncertainty, joints: &[Joint; 6], margin: f64) -> Option<Uncertainty> {
    let mut parameters: Vec<Parameter> = Vec::new();
    for parameter in known.parameters() {
        let joint = parameter.joint();
        let both = match parameter {
            Parameter::ComplianceAtMin(_) | Parameter::ComplianceAtMax(_) => {
                vec![Parameter::ComplianceAtMin(joint), Parameter::ComplianceAtMax(joint)]
            }
            other => vec![*other],
        };
        both.into_iter().for_each(|new| {
            if !parameters.contains(&new) {
                parameters.push(new)
            }
        });
    }
    let map = DMatrix::from_fn(parameters.len(), known.parameters().len(), |row, column| {
        let (new, old) = (parameters[row], known.parameters()[column]);
        let share = |joint: usize| margin / (joints[joint].max - joints[joint].min);
        match (new, old) {
            (new, old) if new == old => match new {
                Parameter::ComplianceAtMin(joint) | Parameter::ComplianceAtMax(joint) => 1.0 - share(joint),
                _ => 1.0,
            },
            (Parameter::ComplianceAtMin(a), Parameter::ComplianceAtMax(b))
            | (Parameter::ComplianceAtMax(a), Parameter::ComplianceAtMin(b))
                if a == b =>
            {
                share(a)
            }
            _ => 0.0,
        }
    });
    Uncertainty::new(parameters, &map * known.covariance() * map.transpose()).ok()
}

#[cfg(test)]
mod tests {
    use super::super::testing::kr270;
    use super::*;

    #[test]
    fn limits_move_inwards_and_compliances_stay_where_they_are() {
        let margin = 0.05;
        let mut joints = kr270().joints().clone();
        joints[1].compliance = Compliance::Range { at_min: 3e-7, at_max: 9e-7 };
        let robot = Robot::new("range", joints).unwrap();
        let parameters = vec![Parameter::Compliance(0), Parameter::ComplianceAtMax(1)];
        let covariance = DMatrix::from_row_slice(2, 2, &[1e-14, 2e-15, 2e-15, 4e-15]);
        let robot = robot.with_uncertainty(Uncertainty::new(parameters, covariance).unwrap()).unwrap();
        let robot = robot.with_unverified(vec!["limits".to_owned()]);
        let narrow = robot.with_joint_margin(margin).unwrap();
        assert_eq!(narrow.unverified(), robot.unverified());
        for (wide, narrow) in robot.joints().iter().zip(narrow.joints()) {
            assert!((narrow.min - wide.min - margin).abs() < 1e-15 && (wide.max - narrow.max - margin).abs() < 1e-15);
        }
        for angle in [0.06, 0.7, 1.4, 2.4] {
            let theta = [0.3, angle, -1.0, 0.2, 0.4, 0.1];
            let pairs = robot.compliances_at(&theta).into_iter().zip(narrow.compliances_at(&theta));
            pairs.for_each(|(a, b)| assert!((a / b - 1.0).abs() < 1e-12));
            let (a, b) = (robot.compliance_covariance_at(&theta), narrow.compliance_covariance_at(&theta));
            assert!((a - b).norm() < 1e-12 * a.norm(), "{a} {b}");
        }
        assert_eq!(robot.with_joint_margin(0.0).unwrap().joints(), robot.joints());
        let again = narrow.with_joint_margin(-margin).unwrap();
        for (own, again) in robot.joints().iter().zip(again.joints()) {
            assert!((own.min - again.min).abs() < 1e-15 && (own.max - again.max).abs() < 1e-15);
        }
        let theta = [0.3, 0.01, -1.0, 0.2, 0.4, 0.1];
        let pairs = robot.compliances_at(&theta).into_iter().zip(again.compliances_at(&theta));
        pairs.for_each(|(own, again)| assert!((own / again - 1.0).abs() < 1e-12));
        assert!(matches!(robot.with_joint_margin(1.3), Err(RobotError::Limits { joint: 2, .. })));
    }
}
