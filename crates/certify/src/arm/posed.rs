//! One state of the arm, joint by joint, in the radial frame of the tool centre point.

use super::super::interval_simd::{Lanes, Mask};
use super::super::number::Number;
use super::vector::{InPlane, Vector};
use nalgebra::Vector3;
use stead_model::robot::PostureClass;

/// The signs that a posture class stands for.
#[derive(Clone, Copy)]
pub(super) struct Signs {
    /// +1 with the wrist centre in front of axis 1, -1 behind it.
    pub side: f64,
    /// Sign of delta.
    pub elbow: f64,
}

impl Signs {
    pub fn of(class: PostureClass) -> Self {
        let posture = class.postures()[0];
        Self {
            side: if posture.is_back() { -1.0 } else { 1.0 },
            elbow: if posture.is_delta_negative() { -1.0 } else { 1.0 },
        }
    }
}

/// Where the tool centre point is.
pub(super) struct Place<T> {
    /// From the root of the arm. m
    pub tip: Vector<T>,
    /// The wrist centre in plan. m
    pub wrist: [T; 2],
    /// Squared distance of the tool centre point from axis 1. m^2
    pub radius2: T,
}

/// What turns with the spindle, in the radial frame.
pub(super) struct Tool<T> {
    /// Sine and cosine of the heading.
    pub sine: T,
    pub cosine: T,
    /// What it turns about, where that is not axis 1.
    pub leaning: Option<Vector3<f64>>,
    /// Tool centre point from the wrist centre, t. m
    pub lever: Vector<T>,
    /// a_6.
    pub axis6: Vector<T>,
}

impl<T: Number> Tool<T> {
    /// R(eta) v.
    #[inline(always)]
    pub fn turned(&self, v: &Vector3<f64>) -> Vector<T> {
        turned(self.sine, self.cosine, self.leaning.as_ref(), v)
    }
}

/// A vector turned about axis 1, or about another axis.
#[inline(always)]
pub(super) fn turned<T: Number>(sine: T, cosine: T, leaning: Option<&Vector3<f64>>, v: &Vector3<f64>) -> Vector<T> {
    let Some(axis) = leaning else {
        let (x, y) = (cosine.scale(v.x) - sine.scale(v.y), sine.scale(v.x) + cosine.scale(v.y));
        return Vector { x, y, z: T::constant(v.z) };
    };
    let along = axis * axis.dot(v);
    let (off, across) = (v - along, axis.cross(v));
    let entry = |k: usize| (cosine.scale(off[k]) + sine.scale(across[k])).plus(along[k]);
    Vector { x: entry(0), y: entry(1), z: entry(2) }
}

/// Joint 1 against the azimuth of the tool centre point.
pub(super) struct FirstJoint<T> {
    /// Distance of the wrist centre from axis 1 along the arm, rho. m
    pub forward: T,
    /// What its square is at most, true wherever the wrist centre is. m^2
    pub forward_squared_high: Lanes,
    pub cosine: T,
    pub sine: T,
}

/// The plane arm: shoulder, elbow and wrist centre.
pub(super) struct Elbow<T> {
    /// Wrist centre from the shoulder.
    pub from_shoulder: InPlane<T>,
    /// Elbow from the shoulder: along the arm, and up times `lift`. m
    pub elbow: [T; 2],
    pub sin_delta: T,
    /// The square of that, nowhere continued.
    pub sin_delta_squared: T,
    /// Squared distance of the wrist centre from the shoulder. m^2
    pub distance2: T,
    /// Sines and cosines of joints 2 and 3.
    pub angles: [[T; 2]; 2],
    /// Not negative where the bound on conditioning allows the elbow.
    pub margin: T,
    /// sin(theta - min), sin(max - theta) of joints 2 and 3.
    pub joint_margins: [[T; 2]; 2],
    /// The same of their sum, where it has limits.
    pub sum_margins: Option<[T; 2]>,
    /// Where one of these is sure to be violated.
    pub violated: Mask,
}

/// Axes 4 to 6, in the radial frame.
pub(super) struct Wrist<T> {
    /// Wrist centre from the elbow.
    pub from_elbow: InPlane<T>,
    pub axis4: Vector<T>,
    /// Component of axis 4 along the arm.
    pub axis4_along: T,
    /// z_4 . a_6.
    pub dot46: T,
    pub sine5_squared: T,
    /// 1 / sin^2 theta_5, continued: see [`super::super::continuation`].
    pub inverse5: T,
    /// Not negative where the bound on conditioning allows the wrist.
    pub margin: T,
    /// cos theta_5 above that of its limits.
    pub joint5_margin: T,
}

/// One state, joint by joint.
///
/// By reference: an enclosure is large to copy.
pub(super) struct Posed<'a, T> {
    pub signs: Signs,
    pub tool: &'a Tool<T>,
    pub first: &'a FirstJoint<T>,
    pub elbow: &'a Elbow<T>,
    pub wrist: &'a Wrist<T>,
    /// Tool centre point from axes 2 and 3.
    pub tips: &'a [InPlane<T>; 2],
}
