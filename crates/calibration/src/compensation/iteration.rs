//! One point: the iteration of eq. 27, and the playing of its result.

use super::{Compensated, Compensation, Deflection, Model, Reason, Settings, Station};
use std::f64::consts::TAU;
use stead_model::robot::{Frames, Pose, Robot, angles::ANGLE_ROUNDING};
use stead_model::stiffness::equilibrium::{Load, NoEquilibrium, equilibrium};
use stead_model::stiffness::rotation::{rotation_from_vector, rotation_vector};
use stead_model::stiffness::{Displacement, displacement};

/// What is to be commanded.
struct Command {
    base_from_tool: Pose<f64>,
    joints: [f64; 6],
    iterations: usize,
}

/// Corrects one point and plays it, without and with the correction.
pub(super) fn compensated(job: &Compensation, station: &Station) -> Result<Compensated, Reason> {
    let command = corrected(job, station)?;
    let target = &station.base_from_tool;
    let deflection = |joints: &[f64; 6]| -> Result<Deflection, Reason> {
        let rest = rest(job, &job.reality, Model::Equilibrium, station, joints)
            .map_err(|NoEquilibrium { share }| Reason::RealityGivesWay { share })?;
        let Displacement { linear, angular } = from_to(target, &rest);
        Ok(Deflection { linear, angular, normal: linear.dot(&station.normal) })
    };
    Ok(Compensated {
        segment: station.segment,
        target: *target,
        command: command.base_from_tool,
        correction: from_to(target, &command.base_from_tool),
        joints: command.joints,
        before: deflection(&joints(job, station, target)?)?,
        after: deflection(&command.joints)?,
        iterations: command.iterations,
    })
}

/// The command at which the loaded tool of the model rests at the target.
fn corrected(job: &Compensation, station: &Station) -> Result<Command, Reason> {
    let Settings { alpha, tolerance, characteristic_length, most_iterations, model } = job.settings;
    let target = &station.base_from_tool;
    let mut command = *target;
    let mut last = f64::INFINITY;
    let mut iterations = 0;
    loop {
        let joints = joints(job, station, &command)?;
        let rest = rest(job, &job.robot, model, station, &joints)
            .map_err(|NoEquilibrium { share }| Reason::GivesWay { share })?;
        let error = from_to(&rest, target);
        let size = error.linear.norm().max(error.angular.norm() * characteristic_length);
        if size <= tolerance {
            within_limits(&job.robot, &joints)?;
            return Ok(Command { base_from_tool: command, joints, iterations });
        }
        if size.is_nan() || size >= last {
            return Err(Reason::Grows { iterations, from: last, to: size });
        }
        if iterations == most_iterations {
            return Err(Reason::NotSettled { iterations, error: size });
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
fn joints(job: &Compensation, station: &Station, base_from_tool: &Pose<f64>) -> Result<[f64; 6], Reason> {
    let base_from_flange = base_from_tool.then(&job.spindle.flange_from_tool.inverse());
    let wrapped = job.robot.inverse(&base_from_flange, station.posture).map_err(Reason::Reach)?;
    let near = |j: usize| wrapped[j] + TAU * ((station.joints[j] - wrapped[j]) / TAU).round();
    Ok(std::array::from_fn(near))
}

/// Where the tool of an arm comes to rest.
fn rest(
    job: &Compensation,
    robot: &Robot,
    model: Model,
    station: &Station,
    joints: &[f64; 6],
) -> Result<Pose<f64>, NoEquilibrium> {
    let Station { force, moment, .. } = *station;
    let flange_from_tool = &job.spindle.flange_from_tool;
    match model {
        Model::Equilibrium => {
            let load = Load { point: flange_from_tool.translation, force, moment };
            Ok(robot.forward(&equilibrium(robot, joints, &load)?).then(flange_from_tool))
        }
        Model::Linear => {
            let frames = Frames::new(robot, joints);
            let tool = frames.base_from_flange.then(flange_from_tool);
            let compliances = robot.compliances_at(joints);
            let moved = displacement(&frames, &tool.translation, &compliances, &force, &moment);
            Ok(Pose {
                rotation: rotation_from_vector(&moved.angular) * tool.rotation,
                translation: tool.translation + moved.linear,
            })
        }
    }
}

/// What takes the tool from one pose to another, in the base frame.
fn from_to(from: &Pose<f64>, to: &Pose<f64>) -> Displacement<f64> {
    Displacement {
        linear: to.translation - from.translation,
        angular: rotation_vector(&(to.rotation * from.rotation.transpose())),
    }
}

fn within_limits(robot: &Robot, joints: &[f64; 6]) -> Result<(), Reason> {
    for (j, (joint, angle)) in robot.joints().iter().zip(joints).enumerate() {
        let by = (joint.min - angle).max(angle - joint.max);
        if by > ANGLE_ROUNDING {
            return Err(Reason::JointLimit { joint: j + 1, by });
        }
    }
    Ok(())
}
