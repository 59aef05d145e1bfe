//! A serial chain of revolute joints that carry rigid bodies: kinematics, mass matrix, inverse dynamics, Jacobian.
//!
//! Everything is computed in base coordinates, with spatial vectors about one point, the origin of the last joint
//! (Featherstone 2008; Siciliano and Khatib 2016, ch. 3): there composite inertias are plain sums
//! ([`Posed::mass_matrix`]) and forces are passed on unchanged ([`Posed::inverse_dynamics`]). A link with springs
//! normal to its joint is a body behind three joints in one place, the first two of which carry nothing.
//!
//! ```
//! use nalgebra::{Matrix3, SVector, vector};
//! use stead_model::robot::{Inertial, Pose};
//! use stead_model::robot::chain::{Axis, Chain, Link};
//! # fn main() -> Result<(), stead_model::robot::InertialError> {
//! // A pendulum about x: a rod of 3 kg and 2 m, hanging down.
//! let rod = Inertial::new(3.0, vector![0.0, 0.0, -1.0], Matrix3::from_diagonal(&vector![1.0, 1.0, 0.01]))?;
//! let chain = Chain::new([Link::new(Pose::identity(), Axis::X, Some(rod))], Pose::identity());
//! let posed = chain.at(&SVector::from([0.1]));
//! assert!((posed.mass_matrix(&chain)[(0, 0)] - 4.0).abs() < 1e-12);
//! assert!((posed.gravity(&chain)[0] - 3.0 * 9.81 * 0.1_f64.sin()).abs() < 1e-12);
//! # Ok(())
//! # }
//! ```

mod dynamics;

use super::inertial::Inertial;
use super::pose::Pose;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// The axis of its frame about which a joint turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// The x axis.
    X,
    /// The y axis.
    Y,
    /// The z axis.
    Z,
}

/// A revolute joint and the body fixed behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    turn: Option<Matrix3<f64>>,
    shift: Vector3<f64>,
    axis: Axis,
    body: Option<Inertial>,
}

impl Link {
    /// A joint whose frame at angle zero is `previous_from_joint` (the base frame for the first), turning about an axis
    /// of its own frame; `body` is given in the joint's frame, which turns with it.
    pub fn new(previous_from_joint: Pose<f64>, axis: Axis, body: Option<Inertial>) -> Self {
        let turned = previous_from_joint.rotation != Matrix3::identity();
        let turn = turned.then_some(previous_from_joint.rotation);
        Self { turn, shift: previous_from_joint.translation, axis, body }
    }
}

/// A serial chain of `N` revolute joints, base first, and a tip fixed to the last.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain<const N: usize> {
    links: [Link; N],
    last_from_tip: Pose<f64>,
    gravity: Vector3<f64>,
}

/// Acceleration of free fall that the published case uses. m/s^2
pub const GRAVITY: f64 = 9.81;

impl<const N: usize> Chain<N> {
    /// Joins links, base first; `last_from_tip` is the tip in the frame of the last joint. Gravity is 9.81 m/s^2 along
    /// -z.
    pub fn new(links: [Link; N], last_from_tip: Pose<f64>) -> Self {
        Self { links, last_from_tip, gravity: Vector3::new(0.0, 0.0, -GRAVITY) }
    }

    /// The same chain in another field of gravity: acceleration of free fall in base coordinates, m/s^2.
    #[cfg(any(test, feature = "testing"))]
    pub fn with_gravity(mut self, gravity: Vector3<f64>) -> Self {
        self.gravity = gravity;
        self
    }

    /// Acceleration of free fall in base coordinates. m/s^2
    pub fn free_fall(&self) -> &Vector3<f64> {
        &self.gravity
    }

    /// Where everything is at joint angles `q` (rad).
    pub fn at(&self, q: &SVector<f64, N>) -> Posed<N> {
        let mut rotation = Matrix3::identity();
        let mut origin = Vector3::zeros();
        let mut posed = Posed {
            axes: [Vector3::zeros(); N],
            origins: [Vector3::zeros(); N],
            rotations: [Matrix3::identity(); N],
            base_from_tip: Pose::identity(),
        };
        for (j, link) in self.links.iter().enumerate() {
            origin += rotation * link.shift;
            if let Some(turn) = &link.turn {
                rotation *= turn;
            }
            let (sine, cosine) = sine_cosine(q[j]);
            let (kept, first, second) = match link.axis {
                Axis::X => (0, 1, 2),
                Axis::Y => (1, 2, 0),
                Axis::Z => (2, 0, 1),
            };
            let (a, b) = (rotation.column(first).into_owned(), rotation.column(second).into_owned());
            rotation.set_column(first, &(a * cosine + b * sine));
            rotation.set_column(second, &(b * cosine - a * sine));
            posed.axes[j] = rotation.column(kept).into_owned();
            posed.origins[j] = origin;
            posed.rotations[j] = rotation;
        }
        posed.base_from_tip = Pose { rotation, translation: origin }.then(&self.last_from_tip);
        posed
    }
}

/// Below this (rad), four terms of the series are exact to rounding.
const SMALL: f64 = 0.02;

/// Sine and cosine; of the small angles of springs by their series.
#[inline]
fn sine_cosine(angle: f64) -> (f64, f64) {
    if angle.abs() > SMALL {
        return libm::sincos(angle);
    }
    let square = angle * angle;
    let sine = angle * (1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0)));
    let cosine = 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0));
    (sine, cosine)
}

/// A chain in one configuration, in base coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Posed<const N: usize> {
    /// Unit vectors of the joint axes.
    pub axes: [Vector3<f64>; N],
    /// Origins of the joint frames, each on its axis. m
    pub origins: [Vector3<f64>; N],
    /// The joint frames: rotations to base coordinates.
    pub rotations: [Matrix3<f64>; N],
    /// The tip.
    pub base_from_tip: Pose<f64>,
}

impl<const N: usize> Posed<N> {
    /// Where the tip is. m
    pub fn tip(&self) -> Vector3<f64> {
        self.base_from_tip.translation
    }

    /// How the tip moves per unit speed of each joint: velocity, one column a joint. m/rad
    pub fn tip_jacobian(&self) -> SMatrix<f64, 3, N> {
        let tip = self.tip();
        SMatrix::from_columns(&std::array::from_fn::<_, N, _>(|j| self.axes[j].cross(&(tip - self.origins[j]))))
    }

    /// Joint torques of a force (N) on the tip: the transposed Jacobian times the force. N m
    pub fn tip_torques(&self, force: &Vector3<f64>) -> SVector<f64, N> {
        let tip = self.tip();
        SVector::from_fn(|j, _| self.axes[j].cross(&(tip - self.origins[j])).dot(force))
    }
}

#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
