//! Modified Denavit-Hartenberg rows from the six joint axes of a URDF.
//!
//! At joint values zero the axes are lines in the base link. Directions that miss a right or straight angle by rounding
//! are made exact, each in terms of the one before it; the wrist centre is the point nearest to axes 4, 5 and 6. Then
//! every x axis lies along the common normal of two neighbours, and the rows are read off (Khalil and Dombre 2002).
//! What the rounding costs is measured afterwards, on the rows as they are written (`deviation`).

use super::forward::{link_at, tip_at};
use super::read::Urdf;
use super::tree::Chain;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};
use stead_disk::input::InputError;
use stead_model::robot::Pose;
use stead_model::robot::angles::wrap;

/// One joint as a robot file writes it, and how its angle follows from that of the URDF: `theta = sign q + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImportedRow {
    /// Twist before the joint. deg
    pub alpha_deg: f64,
    /// Offset along the previous x axis. mm
    pub a_mm: f64,
    /// Offset along the joint axis. mm
    pub d_mm: f64,
    /// 1 where the joint turns as in the URDF, -1 where the other way.
    pub sign: f64,
    /// Joint angle at joint value zero of the URDF. deg
    pub offset_deg: f64,
}

/// The arm as rows, and where they are in the URDF.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rows {
    pub rows: [ImportedRow; 6],
    /// The base frame of the rows in the base link.
    pub link_from_base: Pose<f64>,
    /// The tip link in the frame of the last row.
    pub flange_from_tip: Pose<f64>,
}

/// Directions may miss a right or straight angle by this much. deg
const ANGLE_TOLERANCE_DEG: f64 = 0.1;
/// Axes 4, 5 and 6 may miss the wrist centre by this much. m
const WRIST_TOLERANCE: f64 = 0.5e-3;
/// Axes nearer than this count as meeting: the x axis then points where the offset is smaller. m
const MEETING: f64 = 1e-6;
/// A shorter upper arm, and a shorter flange, is none. m
const SHORTEST: f64 = 1e-3;

/// A line: a point on it and its direction.
#[derive(Debug, Clone, Copy)]
struct Axis {
    point: Vector3<f64>,
    direction: Vector3<f64>,
}

impl Rows {
    /// Derives the rows of a chain.
    ///
    /// # Errors
    /// [`InputError`] at the joint that makes the arm another one than an upright elbow arm with a spherical wrist.
    pub fn derive(urdf: &Urdf, chain: &Chain) -> Result<Self, InputError> {
        let axes = axes(urdf, chain);
        let tip = tip_at(urdf, chain, &[0.0; 6]);
        let (mut z, mut sign) = directions(urdf, chain, &axes)?;
        let wrist = wrist_centre(urdf, chain, &axes)?;
        if points_inwards(&z[5], &wrist, &tip) {
            (z[5], sign[5]) = (-z[5], -1.0);
        }
        let (on_first, second) = feet(&axes[0], &axes[1]);
        let (third, _) = feet(&axes[2], &axes[3]);
        let along = third - second;
        let upper_arm = along - z[1] * z[1].dot(&along);
        if upper_arm.norm() < SHORTEST {
            let problem =
                format!("has its axis in that of the joint before it, within {:.3} mm", upper_arm.norm() * 1e3);
            return Err(urdf.joint_error(chain.moving[2], problem, "an arm with an upper arm between axes 2 and 3"));
        }
        let base = Vector3::new(on_first.x, on_first.y, 0.0);
        let origins =
            [Vector3::new(base.x, base.y, second.z), second, third, wrist, wrist, flange(&wrist, &z[5], &tip)];
        let x = normals(&z, &origins, upper_arm.normalize(), &tip);
        let rows = read_off(&z, &x, &base, &origins, &sign);
        let link_from_base = Pose { rotation: Matrix3::identity(), translation: base };
        let last = Matrix3::from_columns(&[x[5], z[5].cross(&x[5]), z[5]]);
        let link_from_flange = Pose { rotation: last, translation: origins[5] };
        Ok(Self { rows, link_from_base, flange_from_tip: link_from_flange.inverse().then(&tip) })
    }
}

/// The six joint axes at joint values zero, in the base link.
fn axes(urdf: &Urdf, chain: &Chain) -> [Axis; 6] {
    chain.moving.map(|joint| {
        let last = chain.path.iter().position(|other| *other == joint).unwrap_or_default();
        let pose = link_at(urdf, chain, &[0.0; 6], last);
        Axis { point: pose.translation, direction: pose.rotation * urdf.joints[joint].axis }
    })
}

/// The z axes of the rows, at exact angles to each other, and which way each turns: axis 1 up, the others as in the
/// URDF.
fn directions(urdf: &Urdf, chain: &Chain, axes: &[Axis; 6]) -> Result<([Vector3<f64>; 6], [f64; 6]), InputError> {
    let up = Vector3::z();
    let given = axes.map(|axis| axis.direction);
    let tilt = degrees_off(given[0].cross(&up).norm());
    if tilt > ANGLE_TOLERANCE_DEG {
        let problem = format!("has its axis {tilt:.4} deg from the z axis of the base link");
        let allowed = "an arm whose axis 1 is along z of its base link, which --base-link names; how the robot is mounted is said elsewhere";
        return Err(urdf.joint_error(chain.moving[0], problem, allowed));
    }
    let mut z = given;
    z[0] = up * if given[0].z < 0.0 { -1.0 } else { 1.0 };
    for k in 1..6 {
        let is_parallel = k == 2;
        let (before, here) = (z[k - 1], given[k]);
        let off = degrees_off(if is_parallel { before.cross(&here).norm() } else { before.dot(&here) });
        if off > ANGLE_TOLERANCE_DEG {
            return Err(wrong_angle(urdf, chain, k, before.dot(&here)));
        }
        z[k] = match is_parallel {
            true => before * before.dot(&here).signum(),
            false => (here - before * before.dot(&here)).normalize(),
        };
    }
    let mut sign = [1.0; 6];
    if z[0].z < 0.0 {
        (z[0], sign[0]) = (-z[0], -1.0);
    }
    Ok((z, sign))
}

/// Whether axis 6 points into the flange: against the z axis of the tip, or where that lies across, away from the tip.
fn points_inwards(z6: &Vector3<f64>, wrist: &Vector3<f64>, tip: &Pose<f64>) -> bool {
    match z6.dot(&tip.rotation.column(2)) {
        along if along.abs() > 0.5 => along < 0.0,
        _ => z6.dot(&(tip.translation - wrist)) < -SHORTEST,
    }
}

/// The angle of a sine, in deg and without its sign.
fn degrees_off(sine: f64) -> f64 {
    libm::asin(sine.abs().min(1.0)).to_degrees()
}

fn wrong_angle(urdf: &Urdf, chain: &Chain, k: usize, cosine: f64) -> InputError {
    let angle = libm::acos(cosine.clamp(-1.0, 1.0)).to_degrees();
    let problem = format!("has its axis {angle:.4} deg from axis {k}, as axis {}", k + 1);
    let wrist = "a spherical wrist: axes 4, 5 and 6 meet in one point, axis 5 at right angles to both";
    let allowed = match k {
        1 => "axis 2 at a right angle to axis 1",
        2 => "axis 3 parallel to axis 2",
        3 => "axis 4 at a right angle to axis 3; arms without a spherical wrist are not supported",
        _ => wrist,
    };
    urdf.joint_error(chain.moving[k], problem, allowed)
}

/// The point nearest to axes 4, 5 and 6 in the least-squares sense.
fn wrist_centre(urdf: &Urdf, chain: &Chain, axes: &[Axis; 6]) -> Result<Vector3<f64>, InputError> {
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    // About a point on axis 5, so that no large coordinates cancel.
    let about = axes[4].point;
    for axis in &axes[3..] {
        let across = Matrix3::identity() - axis.direction * axis.direction.transpose();
        matrix += across;
        right += across * (axis.point - about);
    }
    let centre = about + matrix.try_inverse().map_or(Vector3::zeros(), |inverse| inverse * right);
    let misses = |k: usize| (centre - axes[k].point).cross(&axes[k].direction).norm();
    let worst = (3..6).max_by(|a, b| misses(*a).total_cmp(&misses(*b))).unwrap_or(3);
    let off = misses(worst);
    if off.is_nan() || off > WRIST_TOLERANCE {
        let problem = format!(
            "has its axis {:.3} mm from the point nearest to axes 4, 5 and 6, as axis {}",
            off * 1e3,
            worst + 1
        );
        let allowed = "a spherical wrist: axes 4, 5 and 6 meet in one point, within 0.5 mm";
        return Err(urdf.joint_error(chain.moving[worst], problem, allowed));
    }
    Ok(centre)
}

/// The points where the common normal of two axes, which are not parallel, meets them.
fn feet(first: &Axis, second: &Axis) -> (Vector3<f64>, Vector3<f64>) {
    let between = second.point - first.point;
    let cosine = first.direction.dot(&second.direction);
    let (along_first, along_second) = (between.dot(&first.direction), between.dot(&second.direction));
    let sine2 = 1.0 - cosine * cosine;
    let s = (along_first - along_second * cosine) / sine2;
    let t = (along_first * cosine - along_second) / sine2;
    (first.point + first.direction * s, second.point + second.direction * t)
}

/// The point of axis 6 nearest to the tip.
fn flange(wrist: &Vector3<f64>, z6: &Vector3<f64>, tip: &Pose<f64>) -> Vector3<f64> {
    wrist + z6 * z6.dot(&(tip.translation - wrist))
}

/// The x axes of the rows.
fn normals(
    z: &[Vector3<f64>; 6],
    origins: &[Vector3<f64>; 6],
    upper_arm: Vector3<f64>,
    tip: &Pose<f64>,
) -> [Vector3<f64>; 6] {
    let mut x = [Vector3::x(); 6];
    let mut before = Vector3::x();
    for k in 0..5 {
        x[k] = if k == 1 {
            upper_arm
        } else {
            let normal = z[k].cross(&z[k + 1]);
            let length = (origins[k + 1] - origins[k]).dot(&normal);
            let wrist = k >= 3;
            if wrist || length.abs() < MEETING { nearer(&z[k], &before, normal) } else { normal * length.signum() }
        };
        before = x[k];
    }
    // That of the tip; where it lies along axis 6, the y axis.
    let across = |column: usize| {
        let axis = tip.rotation.column(column).into_owned();
        axis - z[5] * z[5].dot(&axis)
    };
    let last = [across(0), across(1)].into_iter().find(|axis| axis.norm() > 0.5);
    x[5] = last.map_or(before, |axis| axis.normalize());
    x
}

/// A direction or its opposite: the one that is turned less about z from another; of a right angle the positive one.
fn nearer(z: &Vector3<f64>, from: &Vector3<f64>, direction: Vector3<f64>) -> Vector3<f64> {
    let offset = turned(z, from, &direction);
    let is_better = if (offset.abs() - FRAC_PI_2).abs() < 1e-9 { offset > 0.0 } else { offset.abs() < FRAC_PI_2 };
    if is_better { direction } else { -direction }
}

/// The angle about a unit vector from one normal of it to another. rad
fn turned(about: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
    libm::atan2(from.cross(to).dot(about), from.dot(to))
}

fn read_off(
    z: &[Vector3<f64>; 6],
    x: &[Vector3<f64>; 6],
    base: &Vector3<f64>,
    origins: &[Vector3<f64>; 6],
    sign: &[f64; 6],
) -> [ImportedRow; 6] {
    std::array::from_fn(|k| {
        let (z_before, x_before, before) = match k {
            0 => (Vector3::z(), Vector3::x(), *base),
            _ => (z[k - 1], x[k - 1], origins[k - 1]),
        };
        let step = origins[k] - before;
        let alpha = turned(&x_before, &z_before, &z[k]).to_degrees();
        ImportedRow {
            // A multiple of 90 deg, since the directions have been made exact.
            alpha_deg: match (alpha / 90.0).round() * 90.0 {
                -180.0 => 180.0,
                alpha => alpha + 0.0,
            },
            a_mm: written(step.dot(&x_before) * 1e3),
            d_mm: written(step.dot(&z[k]) * 1e3),
            sign: sign[k],
            offset_deg: angle_written(wrap(turned(&z[k], &x_before, &x[k]))),
        }
    })
}

/// A length without the digits that rounding has made: to 1e-11 mm, zero without a sign.
pub(super) fn written(value: f64) -> f64 {
    (value * 1e11).round() / 1e11 + 0.0
}

/// An angle or speed in deg without the digits that rounding has made: to 1e-9 deg.
pub(super) fn rounded(degrees: f64) -> f64 {
    (degrees * 1e9).round() / 1e9 + 0.0
}

/// An angle in rad as a file has it in deg: to 1e-12 deg, -180 as 180.
fn angle_written(angle: f64) -> f64 {
    let degrees = if angle <= -PI { 180.0 } else { angle.to_degrees() };
    let rounded = (degrees * 1e12).round() / 1e12 + 0.0;
    // Within 1e-9 deg of a right angle the digits behind are those of rounding.
    let right = (rounded / 90.0).round() * 90.0;
    let exact = if (rounded - right).abs() < 1e-9 { right + 0.0 } else { rounded };
    if exact == -180.0 { 180.0 } else { exact }
}
