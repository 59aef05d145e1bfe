//! The score of one state: one path point, one placement, one beta, one posture.
//!
//! This is the reference evaluator: whatever is printed, and every derivative, comes from here. The search goes through
//! the batch evaluator of [`super::batch`], which is tested against this one.

use super::point_evaluator::PointEvaluator;
use crate::criterion::{Over, ScoredDirections, worst_force_error};
use crate::problem::{PlacedPoint, Placement, Problem};
use nalgebra::{Matrix3, Vector3};
use stead_model::robot::{Frames, Parameter, Posture, Robot, Unreachable, conditioning::inverse_condition};
use stead_model::stiffness::whole::{ByOrigin, WholeArm};
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
    /// Its part along the feed (made normal to the tool axis), as the path states both however the tool leans. m
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
    /// The scored part: with its sign where one direction is scored, else the norm of the parts. Its absolute value is
    /// c_i (eq. 11, where that is the wall). m
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

impl<T: Scalar> PointEvaluator<'_, T> {
    /// The state of the arm at this point, a free angle (rad) and in a posture. Joint limits are not checked.
    ///
    /// # Errors
    /// [`Unreachable`] when the posture cannot reach the point.
    pub fn state(&self, beta: T, posture: Posture) -> Result<State<T>, Unreachable> {
        let problem = self.problem;
        let joints = problem.robot.inverse(&self.base_from_flange(beta), posture)?;
        let arm = PlacedArm::new(self, &joints);
        let PlacedPoint { tip, scored_axes: axes, .. } = &self.placed;
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
            surface_part: self.surface_normal.map(|normal| deflection.dot(&normal)),
            own,
            score,
        })
    }
}

/// The arm at a path point, the workpiece placed: what does not depend on the compliances.
struct PlacedArm<'a, T: Scalar> {
    at: &'a PointEvaluator<'a, T>,
    joints: &'a [T; 6],
    frames: Frames<T>,
}

impl<'a, T: Scalar> PlacedArm<'a, T> {
    /// At joint angles that [`PlacedTask::state`](super::placed_task::PlacedTask::state) found.
    fn new(at: &'a PointEvaluator<'a, T>, joints: &'a [T; 6]) -> Self {
        Self { at, joints, frames: Frames::new(&at.problem.robot, joints) }
    }

    /// Under its load, with the compliances of a robot.
    fn under(&self, robot: &'a Robot) -> DeflectedArm<'_, T> {
        let PlacedPoint { tip, force, moment, .. } = &self.at.placed;
        let compliances = robot.compliances_at(self.joints);
        let whole = WholeArm::new(robot, &self.at.problem.spindle, &self.frames, compliances, *tip);
        let mut deflection = whole.displacement(force, moment).linear;
        if let Some(part) = &self.at.part {
            deflection += part * force;
        }
        DeflectedArm { arm: self, robot, whole, deflection }
    }

    /// What each joint adds to the part of the deflection along a direction per compliance: `(J_j . n) (J_j . w)`, in m
    /// per rad/(N m).
    fn parts_per_compliance(&self, direction: &Vector3<T>) -> [T; 6] {
        let PlacedPoint { tip, force, moment, .. } = &self.at.placed;
        std::array::from_fn(|j| {
            let (velocity, axis) = self.frames.twist_yielding(j, tip);
            velocity.dot(direction) * (velocity.dot(force) + axis.dot(moment))
        })
    }

    /// The same of a spring normal to the axis of joint `j`, about x (0) or y (1) of the frame of its row, that sits at
    /// a place on the axis (m).
    fn part_of_normal_spring(&self, j: usize, about: usize, bearing: f64, direction: &Vector3<T>) -> T {
        let PlacedPoint { tip, force, moment, .. } = &self.at.placed;
        let (velocity, axis) = self.frames.twist_normal(j, about, bearing, tip);
        velocity.dot(direction) * (velocity.dot(force) + axis.dot(moment))
    }
}

/// The arm at a path point under its load, with one set of compliances.
struct DeflectedArm<'a, T: Scalar> {
    arm: &'a PlacedArm<'a, T>,
    robot: &'a Robot,
    whole: WholeArm<'a, T>,
    /// Displacement of the tool centre point. m
    deflection: Vector3<T>,
}

impl<T: Scalar> DeflectedArm<'_, T> {
    /// What is scored.
    fn score(&self) -> SetScore<T> {
        let scored = Scored::new(&self.arm.at.directions, &self.deflection);
        let deviation =
            self.robot.uncertainty().map(|known| known.standard_deviation(&self.by_parameters(&scored.direction)));
        let confidence = self.arm.at.problem.criterion.confidence;
        let margin = match deviation {
            Some(deviation) if confidence > 0.0 => deviation.scale(confidence),
            _ => T::zero(),
        };
        SetScore { scored: scored.part, uncertainty: self.force_margin(scored.part), deviation, margin }
    }

    /// What force errors can add to the scored part. m
    fn force_margin(&self, scored_part: T) -> T {
        let PlacedArm { at, .. } = self.arm;
        let PointEvaluator { problem, point, part, directions, .. } = at;
        if problem.criterion.force_uncertainty == 0.0 {
            return T::zero();
        }
        let size = problem.criterion.force_uncertainty * problem.task.loads()[*point].wrench.force.norm();
        let moved_by = |force: &Vector3<T>| {
            let moved = self.whole.displacement(force, &Vector3::zeros()).linear;
            part.as_ref().map_or(moved, |part| moved + part * force)
        };
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
        self.by_parameters(&Scored::new(&self.arm.at.directions, &self.deflection).direction)
    }

    /// Derivatives of the part along a direction by the uncertain parameters of the robot: the chain rule from what
    /// each joint adds per compliance to the parameters of the joints' laws.
    fn by_parameters(&self, direction: &Vector3<T>) -> Vec<T> {
        let Some(known) = self.robot.uncertainty() else { return Vec::new() };
        let parts = self.arm.parts_per_compliance(direction);
        let slopes = self.robot.compliance_gradient_at(self.arm.joints);
        let normal = self.robot.normal_springs();
        let part = |parameter: &Parameter| match (parameter.about(), normal) {
            (None, _) => parts[parameter.joint()],
            (Some(_), None) => T::zero(),
            (Some(about), Some(normal)) => {
                let j = parameter.joint();
                self.arm.part_of_normal_spring(j, about, normal[j].bearing, direction)
            }
        };
        known.parameters().iter().zip(slopes).map(|(parameter, slope)| part(parameter) * slope).collect()
    }
}

/// What is scored under every set of compliances ([`Problem::scored_robots`]), at joint angles that
/// [`PlacedTask::state`](super::placed_task::PlacedTask::state) found for path point `point` and a workpiece at
/// `placement`, with the derivatives of each scored part by the uncertain parameters of its set
/// ([`scored_part_by_parameters`]).
pub fn set_scores<T: Scalar>(
    problem: &Problem,
    point: usize,
    placement: &Placement<T>,
    joints: &[T; 6],
) -> Vec<(SetScore<T>, Vec<T>)> {
    let at = problem.at(placement).evaluator(point);
    let arm = PlacedArm::new(&at, joints);
    let of = |robot| {
        let deflected = arm.under(robot);
        (deflected.score(), deflected.scored_slopes())
    };
    problem.scored_robots().iter().map(of).collect()
}

/// The parts of the deflection along the scored directions under every set of compliances, as [`set_scores`]; several
/// directions only. m
pub fn scored_parts<T: Scalar>(
    problem: &Problem,
    point: usize,
    placement: &Placement<T>,
    joints: &[T; 6],
) -> Vec<Vec<T>> {
    let at = problem.at(placement).evaluator(point);
    let arm = PlacedArm::new(&at, joints);
    let of = |robot| {
        let moved = arm.under(robot).deflection;
        arm.at.directions.vectors().iter().map(|direction| direction.dot(&moved)).collect()
    };
    problem.scored_robots().iter().map(of).collect()
}

/// Derivatives of the scored part of the deflection by the uncertain parameters of the robot ([`Robot::uncertainty`]),
/// in their order, at joint angles that [`PlacedTask::state`](super::placed_task::PlacedTask::state) found for
/// path point `point` and a workpiece at `placement`. m per SI unit of each parameter; empty where no uncertainty is
/// known.
///
/// Summed over path points they tell the standard deviation of a mean with all correlations between the points.
pub fn scored_part_by_parameters<T: Scalar>(
    problem: &Problem,
    point: usize,
    placement: &Placement<T>,
    joints: &[T; 6],
) -> Vec<T> {
    PlacedArm::new(&problem.at(placement).evaluator(point), joints).under(&problem.robot).scored_slopes()
}

/// What each thing that yields adds to the scored part of the deflection, its absolute value taken: the sum is c_i. m
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ScoredByOrigin {
    /// What yields of robot and spindle.
    pub arm: ByOrigin<f64>,
    /// Of the springs normal to the axes, what those of each joint add.
    pub normal_by_joint: [f64; 6],
    /// The part.
    pub part: f64,
}

impl ScoredByOrigin {
    /// Adds what each does at another point. m
    pub fn add(&mut self, other: &Self) {
        let others = other.arm.into_array();
        let mut others = others.into_iter();
        self.arm = self.arm.map(|own| own + others.next().unwrap_or_default());
        self.normal_by_joint = std::array::from_fn(|j| self.normal_by_joint[j] + other.normal_by_joint[j]);
        self.part += other.part;
    }

    /// All of it by a factor.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            arm: self.arm.map(|own| own * factor),
            normal_by_joint: self.normal_by_joint.map(|own| own * factor),
            part: self.part * factor,
        }
    }

    /// The sum. m
    pub fn total(&self) -> f64 {
        self.arm.into_array().iter().sum::<f64>() + self.part
    }
}

/// The scored part of the deflection under the robot's own compliances by what yields, at joint angles that
/// [`PlacedTask::state`](super::placed_task::PlacedTask::state) found for path point `point` and a workpiece at
/// `placement`.
pub fn scored_by_origin(problem: &Problem, point: usize, placement: &Placement, joints: &[f64; 6]) -> ScoredByOrigin {
    let at = problem.at(placement).evaluator(point);
    let arm = PlacedArm::new(&at, joints);
    let deflected = arm.under(&problem.robot);
    let Scored { part, direction } = Scored::new(&at.directions, &deflected.deflection);
    let direction = if part < 0.0 { -direction } else { direction };
    let along = |moved: Vector3<f64>| moved.dot(&direction);
    let PlacedPoint { force, moment, .. } = &at.placed;
    ScoredByOrigin {
        arm: deflected.whole.by_origin(force, moment).map(|moved| along(moved.linear)),
        normal_by_joint: deflected.whole.normal_by_joint(force, moment).map(|moved| along(moved.linear)),
        part: at.part.map_or(0.0, |matrix| along(matrix * force)),
    }
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
mod tests;
