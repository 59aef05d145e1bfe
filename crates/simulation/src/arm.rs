//! A robot with its spindle as a chain with drives, in one of four variants.

use super::drive::Drive;
use nalgebra::{SMatrix, SVector, Vector3};
use serde::Serialize;
use stead_model::robot::chain::{Axis, Chain, Link, Posed};
use stead_model::robot::{Inertial, JointDynamics, Orthogonal, Pose, Robot, Spindle};
use stead_numerics::message::Warning;

stead_numerics::worded! {
    /// How much of the arm is modelled; each adds to the one before.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
    pub enum Variant {
        /// A spring and a damper about each joint axis, no gravity.
        Springs = "springs",
        /// Gravity and its compensators too.
        Gravity = "gravity",
        /// Springs and dampers normal to the joint axes too.
        Orthogonal = "orthogonal",
        /// Backlash of the gears too.
        Backlash = "backlash",
    }
}

impl Variant {
    /// That this variant leaves out springs of a full set, of which those about the axes are but a part.
    pub fn left_out(self, robot: &Robot) -> Option<Warning> {
        (self < Self::Orthogonal && robot.normal_springs().is_some()).then(|| {
            let message = format!(
                "{}: variant {} leaves out the springs normal to the axes, which are part of the set (stiffness_model = \"full\"): \
                 the arm is softer than that, and critical depths are smaller; variant orthogonal has them",
                robot.name(),
                self.word()
            );
            Warning::new("springs-left-out", message)
        })
    }
}

/// What the robot file lacks for the dynamics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error, Serialize)]
pub enum Missing {
    /// The robot has no masses.
    #[error("the robot has no masses and inertias")]
    Dynamics,
    /// A joint, by its number from 1, has no stiffness normal to its axis, which the variant takes into account.
    #[error("joint {0} has no stiffness and damping normal to its axis")]
    Orthogonal(usize),
}

/// A chain of `N` joints, six of them with motors, and the drives about all.
#[derive(Debug, Clone, PartialEq)]
pub struct Arm<const N: usize> {
    /// The chain, and its tip: the tool centre point with the tool's frame.
    pub chain: Chain<N>,
    /// Springs and dampers.
    pub drive: Drive<N>,
}

/// An arm with as many joints as its variant has.
#[derive(Debug, Clone, PartialEq)]
pub enum AnyArm {
    /// Six joints.
    Six(Box<Arm<6>>),
    /// Each of six followed by two normal to it.
    Eighteen(Box<Arm<18>>),
}

impl AnyArm {
    /// The arm at joint angles `theta` (rad), for which the joint stiffnesses are taken.
    ///
    /// # Errors
    /// [`Missing`] when the robot file says too little for the variant.
    pub fn new(robot: &Robot, spindle: &Spindle, variant: Variant, theta: &[f64; 6]) -> Result<Self, Missing> {
        if variant < Variant::Orthogonal {
            Arm::six(robot, spindle, variant, theta).map(|arm| Self::Six(Box::new(arm)))
        } else {
            Arm::eighteen(robot, spindle, variant, theta).map(|arm| Self::Eighteen(Box::new(arm)))
        }
    }
}

/// What the chains of six and of eighteen joints have in common.
struct Parts<'a> {
    dynamics: &'a [JointDynamics; 6],
    bodies: [Inertial; 6],
    stiffness: [f64; 6],
}

impl<'a> Parts<'a> {
    fn new(robot: &'a Robot, spindle: &Spindle, theta: &[f64; 6]) -> Result<Self, Missing> {
        let dynamics = robot.dynamics().ok_or(Missing::Dynamics)?;
        let mut bodies = dynamics.map(|joint| joint.link);
        if let Some(payload) = &spindle.payload {
            bodies[5] = bodies[5].joined(payload);
        }
        let stiffness = robot.compliances_at(theta).map(|compliance| 1.0 / compliance);
        Ok(Self { dynamics, bodies, stiffness })
    }

    fn felt_gravity(&self, j: usize, variant: Variant) -> f64 {
        if variant == Variant::Springs || self.dynamics[j].gravity_compensated { 0.0 } else { 1.0 }
    }

    fn backlash(&self, j: usize, variant: Variant) -> f64 {
        if variant == Variant::Backlash { self.dynamics[j].backlash } else { 0.0 }
    }
}

impl Arm<6> {
    /// A joint with a spring for each row of the robot: [`Variant::Springs`], and [`Variant::Gravity`] with gravity.
    /// Joint stiffnesses are those at `theta` (rad).
    ///
    /// # Errors
    /// [`Missing::Dynamics`] for a robot without masses.
    pub fn six(robot: &Robot, spindle: &Spindle, variant: Variant, theta: &[f64; 6]) -> Result<Self, Missing> {
        let parts = Parts::new(robot, spindle, theta)?;
        Ok(Self {
            chain: robot.chain(&parts.bodies, spindle.flange_from_tool),
            drive: Drive {
                stiffness: parts.stiffness.into(),
                damping: parts.dynamics.map(|joint| joint.damping).into(),
                backlash: SVector::from_fn(|j, _| parts.backlash(j, variant)),
                felt_gravity: SVector::from_fn(|j, _| parts.felt_gravity(j, variant)),
            },
        })
    }
}

impl Arm<18> {
    /// Three joints for each row of the robot: that of the motor, then one about x and one about y of the link's frame,
    /// in the place where the joint's bearing is (paper, eq. 11).
    ///
    /// # Errors
    /// [`Missing`] for a robot without masses, or without stiffness normal to its joints.
    pub fn eighteen(robot: &Robot, spindle: &Spindle, variant: Variant, theta: &[f64; 6]) -> Result<Self, Missing> {
        let parts = Parts::new(robot, spindle, theta)?;
        let mut normal = [Orthogonal { stiffness: [0.0; 2], damping: [0.0; 2] }; 6];
        for (j, slot) in normal.iter_mut().enumerate() {
            *slot = parts.dynamics[j].orthogonal.ok_or(Missing::Orthogonal(j + 1))?;
        }
        // The frame of a row, seen from the same axes in the joint's bearing.
        let bearing = |j: usize| Vector3::new(0.0, 0.0, parts.dynamics[j].bearing);
        let from_bearing = |j: usize| Pose { translation: -bearing(j), ..Pose::identity() };
        let to_bearing = |j: usize| Pose { translation: bearing(j), ..Pose::identity() };
        let rows = robot.mounted_rows();
        let links = std::array::from_fn(|k| {
            let j = k / 3;
            match k % 3 {
                0 => {
                    let step = rows[j].then(&to_bearing(j));
                    let step = if j == 0 { step } else { from_bearing(j - 1).then(&step) };
                    Link::new(step, Axis::Z, None)
                }
                1 => Link::new(Pose::identity(), Axis::X, None),
                _ => Link::new(Pose::identity(), Axis::Y, Some(parts.bodies[j].placed(&from_bearing(j)))),
            }
        });
        // About z first, then about x (0) and y (1).
        let each = |motor: &dyn Fn(usize) -> f64, other: &dyn Fn(usize, usize) -> f64| {
            SVector::from_fn(|k, _| if k % 3 == 0 { motor(k / 3) } else { other(k / 3, k % 3 - 1) })
        };
        let gravity = f64::from(u8::from(variant != Variant::Springs));
        Ok(Self {
            chain: Chain::new(links, from_bearing(5).then(&spindle.flange_from_tool)),
            drive: Drive {
                stiffness: each(&|j| parts.stiffness[j], &|j, about| normal[j].stiffness[about]),
                damping: each(&|j| parts.dynamics[j].damping, &|j, about| normal[j].damping[about]),
                backlash: each(&|j| parts.backlash(j, variant), &|_, _| 0.0),
                felt_gravity: each(&|j| parts.felt_gravity(j, variant), &|_, _| gravity),
            },
        })
    }
}

impl<const N: usize> Arm<N> {
    /// Joints of the chain for each motor.
    const PER_MOTOR: usize = N / 6;

    /// Angles or speeds of the six motors as those of the chain: zero normal to them.
    pub fn spread(motors: &[f64; 6]) -> SVector<f64, N> {
        SVector::from_fn(|k, _| if k % Self::PER_MOTOR == 0 { motors[k / Self::PER_MOTOR] } else { 0.0 })
    }

    /// Generalised forces (N m) that are not yet accounted for at angles, speeds and accelerations `motion`, posed at
    /// the angles, with the motors at `reference` (angles and speeds), with nothing on the tip: inertia and gravity
    /// less drives.
    pub fn unbalanced(
        &self,
        posed: &Posed<N>,
        motion: [&SVector<f64, N>; 3],
        reference: [&SVector<f64, N>; 2],
        compensation: &mut Compensation<N>,
    ) -> SVector<f64, N> {
        let [q, speed, acceleration] = motion;
        let drives = self.drive.torques(q, speed, reference[0], reference[1]);
        if self.feels_gravity() {
            let held = posed.inverse_dynamics(&self.chain, speed, acceleration, self.chain.free_fall());
            held - drives - compensation.taken(self, q)
        } else {
            posed.inverse_dynamics(&self.chain, speed, acceleration, &Vector3::zeros()) - drives
        }
    }

    /// Gravity torque that the springs carry at angles `q` (rad), posed there. N m
    pub fn felt_gravity(&self, posed: &Posed<N>, q: &SVector<f64, N>) -> SVector<f64, N> {
        posed.gravity(&self.chain) - self.not_felt(&self.planar(q).gravity(&self.chain))
    }

    /// The arm with the motors of joints 4 and 6 at zero, so that it is in a plane: compensators take what gravity
    /// would ask of their joint there, since the paper computes them from sums of q2, q3 and q5 alone (its eq. 9, with
    /// the payload).
    fn planar(&self, q: &SVector<f64, N>) -> Posed<N> {
        let mut planar = *q;
        for motor in COMPENSATED_AS_IF_ZERO {
            planar[motor * Self::PER_MOTOR] = 0.0;
        }
        self.chain.at(&planar)
    }

    fn not_felt(&self, torques: &SVector<f64, N>) -> SVector<f64, N> {
        self.drive.felt_gravity.map(|share| 1.0 - share).component_mul(torques)
    }

    /// Whether some spring has to carry gravity.
    pub fn feels_gravity(&self) -> bool {
        self.drive.felt_gravity.iter().any(|share| *share != 0.0)
    }

    /// How the static torques of springs and gravity change with the angles. N m/rad
    pub fn stiffness(&self, posed: &Posed<N>, springs: &SVector<f64, N>) -> SMatrix<f64, N, N> {
        let mut matrix = SMatrix::from_diagonal(springs);
        if self.feels_gravity() {
            let gravity = posed.gravity_stiffness(&self.chain);
            for row in 0..N {
                for column in 0..N {
                    matrix[(row, column)] += gravity[(row, column)] * self.drive.felt_gravity[row];
                }
            }
        }
        matrix
    }

    /// The angles (rad) at which gravity and springs are in equilibrium, the motors held at `reference`: the backlash
    /// of each gear is taken up by what its joint carries. Joint angles settle to within rounding in a few repetitions,
    /// since gravity hardly changes with them.
    pub fn at_rest(&self, reference: &SVector<f64, N>) -> SVector<f64, N> {
        let mut q = *reference;
        if !self.feels_gravity() {
            return q;
        }
        for _ in 0..50 {
            let load = -self.felt_gravity(&self.chain.at(&q), &q);
            let next = reference + self.drive.deflection(&load);
            let change = (next - q).amax();
            q = next;
            if change < 1e-15 {
                break;
            }
        }
        q
    }
}

/// Motors of the joints whose angles do not enter the compensation.
const COMPENSATED_AS_IF_ZERO: [usize; 2] = [3, 5];

/// Gravity torque carried by compensators, linearised about some joint angles; linearised anew for angles farther off
/// than 1 mrad, where it is off by some millionths of the torque.
#[derive(Debug, Clone)]
pub struct Compensation<const N: usize> {
    at: SVector<f64, N>,
    taken: SVector<f64, N>,
    /// N m/rad
    slope: SMatrix<f64, N, N>,
}

impl<const N: usize> Compensation<N> {
    /// Angles (rad) for which it is linear.
    const NEAR: f64 = 1e-3;

    /// About angles `q` (rad).
    pub fn about(arm: &Arm<N>, q: &SVector<f64, N>) -> Self {
        let planar = arm.planar(q);
        let mut slope = planar.gravity_stiffness(&arm.chain);
        for motor in COMPENSATED_AS_IF_ZERO {
            slope.fill_column(motor * Arm::<N>::PER_MOTOR, 0.0);
        }
        for (mut row, felt) in slope.row_iter_mut().zip(&arm.drive.felt_gravity) {
            row *= 1.0 - felt;
        }
        Self { at: *q, taken: arm.not_felt(&planar.gravity(&arm.chain)), slope }
    }

    /// At angles `q` (rad). N m
    pub fn taken(&mut self, arm: &Arm<N>, q: &SVector<f64, N>) -> SVector<f64, N> {
        let off = q - self.at;
        if off.amax() > Self::NEAR {
            *self = Self::about(arm, q);
            return self.taken;
        }
        self.taken + self.slope * off
    }
}

#[cfg(any(test, feature = "testing"))]
pub mod testing;
#[cfg(test)]
mod tests;
