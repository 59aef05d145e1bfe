//! Sampling a table by the reference geometry.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;
use std::f64::consts::PI;
use stead_model::robot::{Frames, Pose, PostureClass, Robot, conditioning::inverse_condition, turns::Range};
use stead_model::stiffness::whole::{ByOrigin, WholeArm};
use stead_numerics::monitor::Monitor;
use stead_problem::problem::Problem;
use stead_problem::table_shape::{MAX_FIELDS, Shape, field};

/// The smallest bound on 1/kappa that room is measured in units of.
const MIN_SLOPE: f64 = 0.05;
/// Room is cut off at this.
const MAX_ROOM: f64 = 0.5;

/// All rows, and which of them (height, radius, posture class) have an allowed state; `None` once the caller asks to
/// stop.
pub(super) fn sample(
    problem: &Problem,
    shape: &Shape,
    rotation_sign: f64,
    monitor: &Monitor,
) -> Option<(Vec<f32>, Vec<bool>)> {
    let (radii, block) = (shape.radius.count, shape.block());
    let mut data = vec![0.0_f32; shape.height.count * radii * 4 * block];
    data.par_chunks_mut(4 * block).enumerate().try_for_each(|(index, rows)| {
        if monitor.should_stop() {
            return None;
        }
        let (height, radius) = (shape.height.node(index / radii), shape.radius.node(index % radii));
        for heading in 0..shape.headings {
            let angle = shape.heading_step() * heading as f64;
            let flange = base_from_flange(problem, radius, height, rotation_sign * angle, rotation_sign);
            for class in PostureClass::ALL {
                let row = &mut rows[class.index() * block..][..block];
                let values = state(problem, shape, &flange, class, radius, height);
                for (k, value) in values.into_iter().enumerate().take(shape.fields()) {
                    row[k * shape.headings + heading] = value as f32;
                }
            }
        }
        Some(())
    })?;
    data.par_chunks_mut(radii * 4 * block).for_each(|slice| fill(shape, slice));
    let alive = data.par_chunks(block).map(|row| room(shape, row).iter().any(|room| *room >= 0.0)).collect();
    Some((data, alive))
}

fn room<'r>(shape: &Shape, row: &'r [f32]) -> &'r [f32] {
    &row[field::ROOM * shape.headings..][..shape.headings]
}

/// The flange for the tool centre point at (`radius`, 0, `height`) of the root frame (m), the tool's x axis at an angle
/// of `heading` (rad) to the root's, and the tool axis along axis 1 (`rotation_sign` +1) or against it.
pub(super) fn base_from_flange(
    problem: &Problem,
    radius: f64,
    height: f64,
    heading: f64,
    rotation_sign: f64,
) -> Pose<f64> {
    let g = problem.robot.geometry();
    let (sine, cosine) = libm::sincos(heading);
    let x = Vector3::new(cosine, sine, 0.0);
    let z = Vector3::new(0.0, 0.0, -rotation_sign);
    let root_from_tool = Matrix3::from_columns(&[x, z.cross(&x), z]);
    let base_from_tool = Pose {
        rotation: g.base_from_root * root_from_tool,
        translation: g.root_in_base + g.base_from_root * Vector3::new(radius, 0.0, height),
    };
    base_from_tool.then(&problem.spindle.flange_from_tool.inverse())
}

/// How the tip yields to a unit force radial and one tangential to axis 1, axis 1 itself held: by displacements along
/// these, radial (`r`), tangential (`t`) and along axis 1 (`z`). m/N
#[derive(Default)]
struct HorizontalForces {
    rr: f64,
    tt: f64,
    rt: f64,
    rz: f64,
    tz: f64,
    /// How it turns by the radial force, in the root frame. rad/N
    radial: Vector3<f64>,
    /// The same by the tangential one. rad/N
    tangential: Vector3<f64>,
}

impl HorizontalForces {
    /// Of springs about the axes 2 to 6 alone, and how the tip turns only where that is needed.
    fn of_axes(robot: &Robot, frames: &Frames<f64>, joints: &[f64; 6], tip: &Vector3<f64>, turns: bool) -> Self {
        let compliances = robot.compliances_at(joints);
        let root_from_base = robot.geometry().base_from_root.transpose();
        let mut by = Self::default();
        for j in 1..6 {
            let (velocity, axis) = frames.twist_yielding(j, tip);
            let v = root_from_base * velocity;
            let k = compliances[j];
            by.rr += k * v.x * v.x;
            by.tt += k * v.y * v.y;
            by.rt += k * v.x * v.y;
            by.rz += k * v.x * v.z;
            by.tz += k * v.y * v.z;
            if turns {
                let axis = root_from_base * axis;
                by.radial += axis * (k * v.x);
                by.tangential += axis * (k * v.y);
            }
        }
        by
    }

    /// Of all that yields but axis 1 and base: with the load in the base frame.
    fn of_whole_arm(problem: &Problem, frames: &Frames<f64>, joints: &[f64; 6], tip: Vector3<f64>) -> Self {
        let (robot, g) = (&problem.robot, problem.robot.geometry());
        let root_from_base = g.base_from_root.transpose();
        let compliances = robot.compliances_at(joints);
        let behind_first = std::array::from_fn(|j| if j == 0 { 0.0 } else { compliances[j] });
        let arm = WholeArm::new(robot, &problem.spindle, frames, behind_first, tip);
        let answer = |force: Vector3<f64>| {
            let ByOrigin { axes, normal, mount, tip, .. } = arm.by_origin(&force, &Vector3::zeros());
            let parts = [axes, normal, mount, tip];
            let linear: Vector3<f64> = parts.iter().map(|part| part.linear).sum();
            let angular: Vector3<f64> = parts.iter().map(|part| part.angular).sum();
            (root_from_base * linear, root_from_base * angular)
        };
        let [(by_radial, radial), (by_tangential, tangential)] =
            [0, 1].map(|k| answer(g.base_from_root.column(k).into_owned()));
        let (rr, rt, rz) = (by_radial.x, by_radial.y, by_radial.z);
        Self { rr, rt, rz, tt: by_tangential.y, tz: by_tangential.z, radial, tangential }
    }
}

/// The fields of one state. Out of reach, the room is NaN and the first field says by how much (m).
fn state(
    problem: &Problem,
    shape: &Shape,
    base_from_flange: &Pose<f64>,
    class: PostureClass,
    radius: f64,
    height: f64,
) -> [f64; MAX_FIELDS] {
    let robot = &problem.robot;
    let g = robot.geometry();
    let mut values = [0.0; MAX_FIELDS];
    let joints = match robot.inverse(base_from_flange, class.postures()[0]) {
        Ok(joints) => joints,
        Err(unreachable) => {
            values[field::MEAN] = unreachable.by();
            values[field::ROOM] = f64::NAN;
            return values;
        }
    };
    let frames = Frames::new(robot, &joints);
    let tip = g.root_in_base + g.base_from_root * Vector3::new(radius, 0.0, height);
    let by = if problem.yields_beside() {
        HorizontalForces::of_whole_arm(problem, &frames, &joints, tip)
    } else {
        HorizontalForces::of_axes(robot, &frames, &joints, &tip, shape.parts.moment)
    };
    let condition = inverse_condition(&frames, &tip, problem.constraints.characteristic_length);
    // In squares, which run straight through the limit of the reach, where 1/kappa comes to nothing like a root.
    let bound = problem.constraints.min_inverse_condition;
    let conditioned = (condition * condition - bound * bound) / (2.0 * bound.max(MIN_SLOPE));
    values[field::MEAN] = 0.5 * (by.rr + by.tt);
    values[field::DIFFERENCE] = 0.5 * (by.rr - by.tt);
    values[field::MIXED] = by.rt;
    values[field::ROOM] = conditioned.min(joint_room(robot, &joints)).min(MAX_ROOM);
    if shape.parts.vertical {
        values[field::VERTICAL] = by.rz;
        values[field::VERTICAL + 1] = by.tz;
    }
    if shape.parts.moment {
        let all = by.radial.iter().chain(&by.tangential);
        values[shape.moment()..].iter_mut().zip(all).for_each(|(value, part)| *value = *part);
    }
    if shape.parts.first_joint {
        let (sine, cosine) = libm::sincos(joints[0]);
        values[shape.first_joint()] = sine;
        values[shape.first_joint() + 1] = cosine;
    }
    values
}

/// Distance of joints 2 to 6, and of the sum of 2 and 3, from their limits, in the better of the two flips; below zero
/// outside. rad
fn joint_room(robot: &Robot, theta: &[f64; 6]) -> f64 {
    let room = |j: usize, angle: f64| {
        let range = Range::of(&robot.joints()[j]);
        if range.has_turns() {
            return f64::INFINITY;
        }
        let (real, excess) = range.nearest(angle);
        if excess > 0.0 { -excess } else { (real - range.min).min(range.max - real) }
    };
    let plain = room(3, theta[3]).min(room(4, theta[4])).min(room(5, theta[5]));
    let flipped = room(3, theta[3] + PI).min(room(4, -theta[4])).min(room(5, theta[5] + PI));
    let of_sum = robot.sum_range().map_or(f64::INFINITY, |range| {
        let mut real = *theta;
        for j in [1, 2] {
            real[j] = Range::of(&robot.joints()[j]).nearest(theta[j]).0;
        }
        let sum = robot.sum_of(&real);
        (sum - range.min).min(range.max - sum)
    });
    room(1, theta[1]).min(room(2, theta[2])).min(of_sum).min(plain.max(flipped))
}

/// Gives states out of reach what the nearest radius within reach has, so that the interpolation beside them stays
/// smooth, and the room that goes on from there as it went, below zero.
fn fill(shape: &Shape, slice: &mut [f32]) {
    let (radii, block, headings) = (shape.radius.count, shape.block(), shape.headings);
    let place =
        |radius: usize, class: usize, k: usize, heading: usize| (radius * 4 + class) * block + k * headings + heading;
    for class in 0..4 {
        for heading in 0..headings {
            let room = |radius: usize| place(radius, class, field::ROOM, heading);
            let reached: Vec<bool> = (0..radii).map(|radius| !slice[room(radius)].is_nan()).collect();
            for radius in (0..radii).filter(|radius| !reached[*radius]) {
                let by = slice[place(radius, class, field::MEAN, heading)];
                let Some(near) = (0..radii).filter(|k| reached[*k]).min_by_key(|k| k.abs_diff(radius)) else {
                    (0..shape.fields()).for_each(|k| slice[place(radius, class, k, heading)] = 0.0);
                    slice[room(radius)] = -1.0;
                    continue;
                };
                for k in (0..shape.fields()).filter(|k| *k != field::ROOM) {
                    slice[place(radius, class, k, heading)] = slice[place(near, class, k, heading)];
                }
                let further = if near < radius { near.checked_sub(1) } else { Some(near + 1) };
                let further = further.filter(|k| *k < radii && reached[*k]).unwrap_or(near);
                let slope = (slice[room(near)] - slice[room(further)]).min(0.0);
                let gone_on = slice[room(near)] + slope * near.abs_diff(radius) as f32;
                slice[room(radius)] = gone_on.min(-by);
            }
        }
    }
}
