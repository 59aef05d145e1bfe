//! One point: the iteration of eq. 27, and the execution of its result.

use super::{
    CompensatedPoint, CompensationProblem, Deflection, DeflectionModel, PathPoint, PointError, Settings, Status,
};
use std::f64::consts::TAU;
use stead_model::robot::{Frames, Pose, Robot, angles::ANGLE_ROUNDING};
use stead_model::stiffness::Displacement;
use stead_model::stiffness::elastic::ElasticArm;
use stead_model::stiffness::equilibrium::{Load, NoEquilibrium, equilibrium};
use stead_model::stiffness::whole::{WholeArm, yields_elsewhere};
use stead_model::task::Wrench;
use stead_numerics::rotation::{rotation_from_vector, rotation_vector};

/// A commanded pose.
struct Command {
    base_from_tool: Pose<f64>,
    joints: [f64; 6],
    iterations: usize,
}

/// Corrects one point and executes it, without and with the correction; a point that cannot be corrected is executed as
/// it is.
pub(super) fn compensated(job: &CompensationProblem, point: &PathPoint) -> CompensatedPoint {
    let target = &point.base_from_tool;
    // The joint angles of the plan are those of the target but for rounding.
    let planned = joints(job, point, target).unwrap_or(point.joints);
    let before = deflection(job, point, &planned);
    let corrected = corrected(job, point).and_then(|command| Ok((deflection(job, point, &command.joints)?, command)));
    let kept = Command { base_from_tool: *target, joints: planned, iterations: 0 };
    let (status, after, command) = match (corrected, before) {
        (Ok((after, command)), Ok(_)) => (Status::Corrected, Ok(after), command),
        (Err(reason), _) | (Ok(_), Err(reason)) => (Status::Kept(reason), before, kept),
    };
    CompensatedPoint {
        segment: point.segment,
        target: *target,
        command: command.base_from_tool,
        correction: from_to(target, &command.base_from_tool),
        joints: command.joints,
        before: before.ok(),
        after: after.ok(),
        iterations: command.iterations,
        status,
    }
}

/// Where the loaded tool of the arm that stands for reality rests for commanded joint angles (rad), seen from the
/// target.
fn deflection(job: &CompensationProblem, point: &PathPoint, joints: &[f64; 6]) -> Result<Deflection, PointError> {
    let rest = rest(job, &job.reality, DeflectionModel::Equilibrium, point, joints)
        .map_err(|NoEquilibrium { share }| PointError::RealityUnstable { share })?;
    let Displacement { linear, angular } = from_to(&point.base_from_tool, &rest);
    Ok(Deflection { linear, angular, normal: linear.dot(&point.normal) })
}

/// The command at which the loaded tool of the model rests at the target.
fn corrected(job: &CompensationProblem, point: &PathPoint) -> Result<Command, PointError> {
    let Settings { alpha, tolerance, characteristic_length, max_iterations, model, .. } = job.settings;
    let target = &point.base_from_tool;
    let mut command = *target;
    let mut last = f64::INFINITY;
    let mut iterations = 0;
    loop {
        let joints = joints(job, point, &command)?;
        let rest = rest(job, &job.robot, model, point, &joints)
            .map_err(|NoEquilibrium { share }| PointError::Unstable { share })?;
        let error = from_to(&rest, target);
        let size = error.linear.norm().max(error.angular.norm() * characteristic_length);
        if size <= tolerance {
            within_limits(&job.robot, &joints)?;
            return Ok(Command { base_from_tool: command, joints, iterations });
        }
        if size.is_nan() || size >= last {
            return Err(PointError::Diverged { iterations, from: last, to: size });
        }
        if iterations == max_iterations {
            return Err(PointError::NotConverged { iterations, error: size });
        }
        command = Pose {
            rotation: rotation_from_vector(&(error.angular * alpha)) * command.rotation,
            translation: command.translation + error.linear * alpha,
        };
        last = size;
        iterations += 1;
    }
}

/// The joint angles that bring the unloaded tool to a pose, in the posture and the turns of the plan. rad
fn joints(job: &CompensationProblem, point: &PathPoint, base_from_tool: &Pose<f64>) -> Result<[f64; 6], PointError> {
    let base_from_flange = base_from_tool.then(&job.spindle.flange_from_tool.inverse());
    let wrapped = job.robot.inverse(&base_from_flange, point.posture).map_err(PointError::Reach)?;
    let near = |j: usize| wrapped[j] + TAU * ((point.joints[j] - wrapped[j]) / TAU).round();
    Ok(std::array::from_fn(near))
}

/// Where the tool of an arm comes to rest, seen from a part that does not yield.
fn rest(
    job: &CompensationProblem,
    robot: &Robot,
    model: DeflectionModel,
    point: &PathPoint,
    joints: &[f64; 6],
) -> Result<Pose<f64>, NoEquilibrium> {
    let rest = match model {
        DeflectionModel::Equilibrium => at_rest(job, robot, point, joints)?,
        DeflectionModel::Linear => displaced(job, robot, point, joints),
    };
    // The part moves against the force on the tool.
    Ok(Pose { translation: rest.translation + point.of_part, ..rest })
}

/// Where the tool of an arm comes to rest in its exact equilibrium.
fn at_rest(
    job: &CompensationProblem,
    robot: &Robot,
    point: &PathPoint,
    joints: &[f64; 6],
) -> Result<Pose<f64>, NoEquilibrium> {
    let PathPoint { force, moment, free_fall, .. } = *point;
    let flange_from_tool = &job.spindle.flange_from_tool;
    if !job.settings.gravity && !yields_elsewhere(robot, &job.spindle) {
        let load = Load { point: flange_from_tool.translation, force, moment };
        return Ok(robot.forward(&equilibrium(robot, joints, &load)?).then(flange_from_tool));
    }
    let arm = ElasticArm::new(robot, &job.spindle);
    let arm = if job.settings.gravity { arm.in_gravity(free_fall) } else { arm };
    arm.at_rest(joints, &Wrench { force, moment })
}

/// Where the tool of an arm is by the displacement linear in the load.
fn displaced(job: &CompensationProblem, robot: &Robot, point: &PathPoint, joints: &[f64; 6]) -> Pose<f64> {
    let frames = Frames::new(robot, joints);
    let tool = frames.base_from_flange.then(&job.spindle.flange_from_tool);
    let arm = WholeArm::new(robot, &job.spindle, &frames, robot.compliances_at(joints), tool.translation);
    let mut moved = arm.displacement(&point.force, &point.moment);
    if job.settings.gravity {
        let sag = ElasticArm::new(robot, &job.spindle).in_gravity(point.free_fall).sag(joints);
        moved.linear += sag.linear;
        moved.angular += sag.angular;
    }
    Pose {
        rotation: rotation_from_vector(&moved.angular) * tool.rotation,
        translation: tool.translation + moved.linear,
    }
}

/// What takes the tool from one pose to another, in the base frame.
fn from_to(from: &Pose<f64>, to: &Pose<f64>) -> Displacement<f64> {
    Displacement {
        linear: to.translation - from.translation,
        angular: rotation_vector(&(to.rotation * from.rotation.transpose())),
    }
}

fn within_limits(robot: &Robot, joints: &[f64; 6]) -> Result<(), PointError> {
    for (j, (joint, angle)) in robot.joints().iter().zip(joints).enumerate() {
        let by = (joint.min - angle).max(angle - joint.max);
        if by > ANGLE_ROUNDING {
            return Err(PointError::JointLimit { joint: j + 1, by });
        }
    }
    let by = robot.beyond_sum(joints);
    if by > ANGLE_ROUNDING {
        return Err(PointError::AxesSum { by });
    }
    Ok(())
}
