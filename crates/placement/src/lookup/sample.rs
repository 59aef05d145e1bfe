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
    let compliances = robot.compliances_at(&joints);
    let (mut rr, mut tt, mut rt, mut rz, mut tz) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let (mut radial, mut tangential) = (Vector3::zeros(), Vector3::zeros());
    let root_from_base = g.base_from_root.transpose();
    if problem.yields_beside() {
        // All but axis 1 and base: with the load in the base frame, radial and tangential.
        let behind_first = std::array::from_fn(|j| if j == 0 { 0.0 } else { compliances[j] });
        let arm = WholeArm::new(robot, &problem.spindle, &frames, behind_first, tip);
        let answer = |force: Vector3<f64>| {
            let ByOrigin { axes, normal, mount, tip, .. } = arm.by_origin(&force, &Vector3::zeros());
            let parts = [axes, normal, mount, tip];
            let linear: Vector3<f64> = parts.iter().map(|part| part.linear).sum();
            let angular: Vector3<f64> = parts.iter().map(|part| part.angular).sum();
            (root_from_base * linear, root_from_base * angular)
        };
        let [(by_radial, about_radial), (by_tangential, about_tangential)] =
            [0, 1].map(|k| answer(g.base_from_root.column(k).into_owned()));
        (rr, rt, rz) = (by_radial.x, by_radial.y, by_radial.z);
        (tt, tz) = (by_tangential.y, by_tangential.z);
        (radial, tangential) = (about_radial, about_tangential);
    }
    let axial_alone = if problem.yields_beside() { 6..6 } else { 1..6 };
    for j in axial_alone {
        let (velocity, axis) = frames.twist_yielding(j, &tip);
        let v = root_from_base * velocity;
        let k = compliances[j];
        rr += k * v.x * v.x;
        tt += k * v.y * v.y;
        rt += k * v.x * v.y;
        rz += k * v.x * v.z;
        tz += k * v.y * v.z;
        if shape.parts.moment {
            let axis = root_from_base * axis;
            radial += axis * (k * v.x);
            tangential += axis * (k * v.y);
        }
    }
    let condition = inverse_condition(&frames, &tip, problem.constraints.characteristic_length);
    // In squares, which run straight through the limit of the reach, where 1/kappa comes to nothing like a root.
    let bound = problem.constraints.min_inverse_condition;
    let conditioned = (condition * condition - bound * bound) / (2.0 * bound.max(MIN_SLOPE));
    values[field::MEAN] = 0.5 * (rr + tt);
    values[field::DIFFERENCE] = 0.5 * (rr - tt);
    values[field::MIXED] = rt;
    values[field::ROOM] = conditioned.min(joint_room(robot, &joints)).min(MAX_ROOM);
    if shape.parts.vertical {
        values[field::VERTICAL] = rz;
        values[field::VERTICAL + 1] = tz;
    }
    if shape.parts.moment {
        let all = radial.iter().chain(&tangential);
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
