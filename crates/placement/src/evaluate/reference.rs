//! The score of one state: one path point, one placement, one beta, one posture.
//!
//! This is the reference evaluator: whatever is printed, and every derivative, comes from here. The search goes through the
//! batch evaluator of [`super::batch`], which is tested against this one.

use crate::criterion::{Over, ScoredDirections, worst_force_error};
use crate::problem::{PlacedPoint, Placement, Problem};
use nalgebra::{Matrix3, Vector3};
use stead_model::robot::{Frames, Posture, Robot, Unreachable, conditioning::inverse_condition};
use stead_model::stiffness::displacement;
use stead_numerics::scalar::Scalar;

/// A state of the arm at a path point and what the cutting force does to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State<T: Scalar> {
    /// Joint angles as the inverse kinematics gives them, limits not checked. rad
    pub joints: [T; 6],
    /// 1/kappa_F of the normalised Jacobian at the tool centre point (Caro 2013, eq. 26).
    pub inverse_condition: T,
    /// Distance of the tool centre point from axis 1. m
    pub base_distance: T,
    /// Displacement of the tool centre point in the base frame, `K^-1 w` (eq. 12). m
    pub deflection: Vector3<T>,
    /// Its part along the feed (made normal to the tool axis). m
    pub feed_part: T,
    /// Its part to the left of the feed, `axis x feed`: normal to the wall. m
    pub normal_part: T,
    /// Its part along the tool axis, positive towards the robot. m
    pub axial_part: T,
    /// Its part along the normal of the surface, where the task states that. m
    pub surface_part: Option<T>,
    /// What is scored under the robot's own compliances.
    pub own: SetScore<T>,
    /// The score: that under the robot's own compliances, or the mean or the largest under the sets of the criterion. m
    pub score: T,
}

/// What is scored of a state under one set of compliances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SetScore<T: Scalar> {
    /// The scored part: with its sign where one direction is scored, else the norm of the parts. Its absolute value is c_i
    /// (eq. 11, where that is the wall). m
    pub scored: T,
    /// What force errors of the given relative size can add to c_i: with one direction n, `eps |w| |K^-1 n|`. m
    pub uncertainty: T,
    /// Standard deviation sigma_i of the scored part, where the uncertainty of the compliances is known. m
    pub deviation: Option<T>,
    /// What the score adds for it: `confidence sigma_i`. m
    pub margin: T,
}

impl<T: Scalar> SetScore<T> {
    /// The score: c_i, what force errors can add to it, and `confidence sigma_i`. m
    pub fn score(&self) -> T {
        self.scored.abs() + self.uncertainty + self.margin
    }
}

impl<T: Scalar> State<T> {
    /// The score of the point. m
    pub fn score(&self) -> T {
        self.score
    }
}

/// Evaluates path point `point` for a workpiece at a placement, free angle `beta` (rad) and a
/// posture. Joint limits are not checked.
///
/// # Errors
/// [`Unreachable`] when the posture cannot reach the point.
pub fn state<T: Scalar>(
    problem: &Problem,
    point: usize,
    placement: &Placement<T>,
    beta: T,
    posture: Posture,
) -> Result<State<T>, Unreachable> {
    let joints = problem.robot.inverse(&problem.base_from_flange(point, placement, beta), posture)?;
    let arm = PlacedArm::new(problem, point, placement, &joints);
    let PlacedPoint { tip, axes, .. } = &arm.placed;
    let deflected = arm.under(&problem.robot);
    let (deflection, own) = (deflected.deflection, deflected.score());
    let score = match &problem.criterion.stiffness {
        None => own.score(),
        Some(sets) => {
            let scores = sets.robots.iter().map(|set| arm.under(set).score().score());
            match sets.over {
                Over::Mean | Over::Regret => {
                    scores.fold(T::zero(), |sum, score| sum + score).scale(1.0 / sets.robots.len() as f64)
                }
                Over::Worst => {
                    scores.fold(T::zero(), |worst, score| if score.value() > worst.value() { score } else { worst })
                }
            }
        }
    };
    let inverse_condition = inverse_condition(&arm.frames, tip, problem.constraints.characteristic_length);
    Ok(State {
        joints,
        inverse_condition,
        base_distance: problem.base_distance(tip),
        deflection,
        feed_part: deflection.dot(&axes.column(0)),
        normal_part: deflection.dot(&axes.column(1)),
        axial_part: deflection.dot(&axes.column(2)),
        surface_part: problem.surface_normal(point, placement).map(|normal| deflection.dot(&normal)),
        own,
        score,
    })
}

/// The arm at a path point, the workpiece placed: what does not depend on the compliances.
struct PlacedArm<'a, T: Scalar> {
    problem: &'a Problem,
    point: usize,
    joints: &'a [T; 6],
    frames: Frames<T>,
    placed: PlacedPoint<T>,
    directions: ScoredDirections<T>,
}

impl<'a, T: Scalar> PlacedArm<'a, T> {
    /// At joint angles that [`state`] found.
    fn new(problem: &'a Problem, point: usize, placement: &Placement<T>, joints: &'a [T; 6]) -> Self {
        let frames = Frames::new(&problem.robot, joints);
        let placed = problem.placed(point, placement);
        let directions = problem.scored_directions(point, &placed.axes);
        Self { problem, point, joints, frames, placed, directions }
    }

    /// Under its load, with the compliances of a robot.
    fn under(&self, robot: &'a Robot) -> DeflectedArm<'_, T> {
        let PlacedPoint { tip, force, moment, .. } = &self.placed;
        let compliances = robot.compliances_at(self.joints);
        let deflection = displacement(&self.frames, tip, &compliances, force, moment).linear;
        DeflectedArm { arm: self, robot, compliances, deflection }
    }

    /// What each joint adds to the part of the deflection along a direction per compliance: `(J_j . n) (J_j . w)`, in m per
    /// rad/(N m).
    fn parts_per_compliance(&self, direction: &Vector3<T>) -> [T; 6] {
        let PlacedPoint { tip, force, moment, .. } = &self.placed;
        std::array::from_fn(|j| {
            let (velocity, axis) = self.frames.twist(j, tip);
            velocity.dot(direction) * (velocity.dot(force) + axis.dot(moment))
        })
    }
}

/// The arm at a path point under its load, with one set of compliances.
struct DeflectedArm<'a, T: Scalar> {
    arm: &'a PlacedArm<'a, T>,
    robot: &'a Robot,
    /// rad/(N m)
    compliances: [T; 6],
    /// Displacement of the tool centre point. m
    deflection: Vector3<T>,
}

impl<T: Scalar> DeflectedArm<'_, T> {
    /// What is scored.
    fn score(&self) -> SetScore<T> {
        let scored = Scored::new(&self.arm.directions, &self.deflection);
        let deviation =
            self.robot.uncertainty().map(|known| known.standard_deviation(&self.by_parameters(&scored.direction)));
        let confidence = self.arm.problem.criterion.confidence;
        let margin = match deviation {
            Some(deviation) if confidence > 0.0 => deviation.scale(confidence),
            _ => T::zero(),
        };
        SetScore { scored: scored.part, uncertainty: self.force_margin(scored.part), deviation, margin }
    }

    /// What force errors can add to the scored part. m
    fn force_margin(&self, scored_part: T) -> T {
        let PlacedArm { problem, point, frames, placed, directions, .. } = self.arm;
        if problem.criterion.force_uncertainty == 0.0 {
            return T::zero();
        }
        let size = problem.criterion.force_uncertainty * problem.task.wrenches()[*point].force.norm();
        let moved_by =
            |force: &Vector3<T>| displacement(frames, &placed.tip, &self.compliances, force, &Vector3::zeros()).linear;
        if let Some(direction) = directions.single() {
            let response = moved_by(direction);
            return response.dot(&response).sqrt().scale(size);
        }
        // The worst error is held while derivatives are taken, since at a maximum it does not matter how it moves.
        let gain = directions.rows() * Matrix3::from_columns(&[0, 1, 2].map(|k| moved_by(&Vector3::ith(k, T::one()))));
        let parts = directions.parts(&self.deflection);
        let error = worst_force_error(&gain.map(T::value), &parts.map(T::value), size);
        let parts = parts + gain * error.map(T::constant);
        parts.dot(&parts).sqrt() - scored_part
    }

    /// Derivatives of the scored part by the uncertain parameters of the robot.
    fn scored_slopes(&self) -> Vec<T> {
        self.by_parameters(&Scored::new(&self.arm.directions, &self.deflection).direction)
    }

    /// Derivatives of the part along a direction by the uncertain parameters of the robot: the chain rule from what each joint
    /// adds per compliance to the parameters of the joints' laws.
    fn by_parameters(&self, direction: &Vector3<T>) -> Vec<T> {
        let Some(known) = self.robot.uncertainty() else { return Vec::new() };
        let parts = self.arm.parts_per_compliance(direction);
        let slopes = self.robot.compliance_gradient_at(self.arm.joints);
        known.parameters().iter().zip(slopes).map(|(parameter, slope)| parts[parameter.joint()] * slope).collect()
    }
}

/// What is scored under every set of compliances ([`Problem::scored_robots`]), at joint angles that [`state`] found for path point
/// `point` and a workpiece at `placement`, with the derivatives of each scored part by the uncertain parameters of its set
/// ([`scored_part_by_parameters`]).
pub fn set_scores<T: Scalar>(
    problem: &Problem,
    point: usize,
    placement: &Placement<T>,
    joints: &[T; 6],
) -> Vec<(SetScore<T>, Vec<T>)> {
    let arm = PlacedArm::new(problem, point, placement, joints);
    let of = |robot| {
        let deflected = arm.under(robot);
        (deflected.score(), deflected.scored_slopes())
    };
    problem.scored_robots().iter().map(of).collect()
}

/// The parts of the deflection along the scored directions under every set of compliances, as [`set_scores`]; several directions
/// only. m
pub fn scored_parts<T: Scalar>(
    problem: &Problem,
    point: usize,
    placement: &Placement<T>,
    joints: &[T; 6],
) -> Vec<Vec<T>> {
    let arm = PlacedArm::new(problem, point, placement, joints);
    let of = |robot| {
        let moved = arm.under(robot).deflection;
        arm.directions.vectors().iter().map(|direction| direction.dot(&moved)).collect()
    };
    problem.scored_robots().iter().map(of).collect()
}

/// Derivatives of the scored part of the deflection by the uncertain parameters of the robot ([`Robot::uncertainty`]), in
/// their order, at joint angles that [`state`] found for path point `point` and a workpiece at `placement`. m per SI unit of each
/// parameter; empty where no uncertainty is known.
///
/// Summed over path points they tell the standard deviation of a mean with all correlations between the points.
pub fn scored_part_by_parameters<T: Scalar>(
    problem: &Problem,
    point: usize,
    placement: &Placement<T>,
    joints: &[T; 6],
) -> Vec<T> {
    PlacedArm::new(problem, point, placement, joints).under(&problem.robot).scored_slopes()
}

/// The scored part of a deflection, and the direction along which it grows fastest, as long as it grows.
struct Scored<T: Scalar> {
    part: T,
    direction: Vector3<T>,
}

impl<T: Scalar> Scored<T> {
    fn new(directions: &ScoredDirections<T>, deflection: &Vector3<T>) -> Self {
        if let Some(direction) = directions.single() {
            return Self { part: deflection.dot(direction), direction: *direction };
        }
        let parts = directions.parts(deflection);
        let part = parts.dot(&parts).sqrt();
        let inverse = if part.value() > 0.0 { T::one() / part } else { T::zero() };
        let direction =
            directions.vectors().iter().zip(&parts).fold(Vector3::zeros(), |sum, (d, part)| sum + d * *part);
        Self { part, direction: direction * inverse }
    }
}

#[cfg(test)]
mod uncertainty_tests;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{five_segments, five_segments_compensated};
    use nalgebra::{Matrix6, Vector6};
    use proptest::prelude::*;
    use stead_model::robot::angles::yaw_from_q4;
    use stead_numerics::scalar::Dual;

    fn published_optimum() -> Placement {
        [2.2e-3, -1.6435, -0.5564, yaw_from_q4(0.9258)].into()
    }

    #[test]
    fn agrees_with_the_prototype_at_point_30() {
        let problem = five_segments();
        let found = state(&problem, 30, &published_optimum(), 40.0_f64.to_radians(), Posture::ALL[2]).unwrap();
        let expected = [-92.6318, 27.4912, -150.7821, -178.7079, 101.6922, 1.5275];
        for (found, expected) in found.joints.iter().zip(expected) {
            assert!((found.to_degrees() - expected).abs() < 5.1e-5, "{} {expected}", found.to_degrees());
        }
        assert!((found.score() * 1e3 - 0.8392428).abs() < 5.1e-8, "{}", found.score() * 1e3);
        assert!((found.inverse_condition - 0.479182).abs() < 5.1e-7, "{}", found.inverse_condition);
    }

    #[test]
    fn parts_of_the_deflection_make_up_the_whole() {
        let problem = five_segments();
        let s = state(&problem, 41, &published_optimum(), 0.4, Posture::ALL[3]).unwrap();
        let parts = Vector3::new(s.feed_part, s.normal_part, s.axial_part);
        assert!((parts.norm() - s.deflection.norm()).abs() < 1e-15);
    }

    #[test]
    fn uncertainty_is_the_worst_case_over_force_errors() {
        let mut problem = five_segments();
        problem.criterion.force_uncertainty = 0.1;
        let (placement, beta, posture) = (published_optimum(), 0.3, Posture::ALL[2]);
        let robust = state(&problem, 60, &placement, beta, posture).unwrap();
        let size = 0.1 * problem.task.wrenches()[60].force.norm();
        let mut worst = 0.0_f64;
        for k in 0..2000 {
            // Directions spread over the sphere.
            let z = 1.0 - 2.0 * (f64::from(k) + 0.5) / 2000.0;
            let (s, c) = libm::sincos(f64::from(k) * 2.399_963_229_728_653);
            let r = libm::sqrt(1.0 - z * z);
            let error = Vector3::new(r * c, r * s, z) * size;
            let mut wrenches = problem.task.wrenches().to_vec();
            wrenches[60].force += error;
            let mut changed = problem.clone();
            changed.task = stead_model::task::Task::new(problem.task.path().clone(), wrenches).unwrap();
            let c_i = state(&changed, 60, &placement, beta, posture).unwrap().normal_part.abs();
            assert!(c_i <= robust.score() * (1.0 + 1e-12));
            worst = worst.max(c_i);
        }
        assert!(worst > robust.score() * 0.998, "{worst} {}", robust.score());
    }

    proptest! {
        #[test]
        fn deflection_agrees_with_the_matrix_inverse(beta in -3.0..3.0_f64, point in 0..105_usize) {
            let problem = five_segments();
            let placement = published_optimum();
            for posture in Posture::ALL {
                let Ok(found) = state(&problem, point, &placement, beta, posture) else { continue };
                let frames = Frames::new(&problem.robot, &found.joints);
                let workpiece = placement.base_from_workpiece();
                let tip = workpiece.point(&problem.task.points()[point].position);
                prop_assert!((frames.base_from_flange.point(&problem.spindle.flange_from_tool.translation) - tip).norm() < 1e-9);
                let jacobian = frames.jacobian(&tip);
                let joint = Matrix6::from_diagonal(&Vector6::from(problem.robot.compliances_at(&found.joints).map(|c| 1.0 / c)));
                let Some(inverse) = jacobian.try_inverse() else { continue };
                let stiffness = inverse.transpose() * joint * inverse;
                let force = workpiece.rotation * problem.task.wrenches()[point].force;
                let wrench = Vector6::new(force.x, force.y, force.z, 0.0, 0.0, 0.0);
                let Some(moved) = stiffness.lu().solve(&wrench) else { continue };
                prop_assume!(found.inverse_condition > 0.02);
                prop_assert!((moved.fixed_rows::<3>(0) - found.deflection).norm() < 1e-9 * (1.0 + moved.norm()));
            }
        }

        #[test]
        fn derivatives_agree_with_central_differences(
            beta in -3.0..3.0_f64, point in 0..105_usize, is_compensated in any::<bool>()
        ) {
            let mut problem = if is_compensated { five_segments_compensated() } else { five_segments() };
            problem.criterion.force_uncertainty = 0.2;
            let placement = published_optimum();
            let at = |shift: [f64; 5]| {
                let moved = Placement::from(std::array::from_fn(|k| placement[k] + shift[k]));
                state(&problem, point, &moved, beta + shift[4], Posture::ALL[2])
            };
            let variables = Placement::from(std::array::from_fn(|k| Dual::<5>::variable(placement[k], k)));
            let Ok(exact) = state(&problem, point, &variables, Dual::variable(beta, 4), Posture::ALL[2]) else { return Ok(()) };
            prop_assume!(exact.inverse_condition.value > 0.05);
            for k in 0..5 {
                let h = 1e-6;
                let mut shift = [0.0; 5];
                shift[k] = h;
                let Ok(up) = at(shift) else { continue };
                shift[k] = -h;
                let Ok(down) = at(shift) else { continue };
                let difference = |f: &dyn Fn(&State<f64>) -> f64| (f(&up) - f(&down)) / (2.0 * h);
                prop_assert!((exact.normal_part.gradient[k] - difference(&|s| s.normal_part)).abs() < 1e-8);
                prop_assert!((exact.own.uncertainty.gradient[k] - difference(&|s| s.own.uncertainty)).abs() < 1e-8);
                prop_assert!((exact.inverse_condition.gradient[k] - difference(&|s| s.inverse_condition)).abs() < 1e-6);
                for j in 0..6 {
                    let turned = stead_model::robot::angles::wrap(up.joints[j] - down.joints[j]) / (2.0 * h);
                    let tolerance = 1e-6 * (1.0 + turned.abs() * turned.abs());
                    prop_assert!((exact.joints[j].gradient[k] - turned).abs() < tolerance, "{} {}", exact.joints[j].gradient[k], turned);
                }
            }
        }
    }
}
