//! A whole arm as a finite chain of elastic coordinates: where it rests under a load and under its weight.
//!
//! Behind the drive's turn of every joint come, all in its bearing and in this order, elastic turns about z, x and y of
//! the frame of its row; before joint 1 the base yields in three shifts and three turns at its point, behind joint 6
//! the mount of the spindle likewise at the origin of the flange, and at the tool centre point holder and tool in three
//! shifts. Shifts of a matrix come first, then its turns about x, y and z in this order. With q the coordinates, C
//! their compliance and tau the torques and forces on them, the arm rests where `q = C tau(q)`. Forces and moments keep
//! their directions in space and act on the displaced points. Coordinates are scaled, `q = S x` with `S S^T = C`, so
//! that rigid ones need no case of their own.
//!
//! [`super::whole`] is the slope of all this at zero load, [`super::equilibrium`] the same for springs about the axes
//! alone.

mod posed;
mod root;
#[cfg(test)]
mod tests;

use super::Displacement;
use super::equilibrium::{NoEquilibrium, loaded_in_steps, settled};
use super::loaded::Buckled;
use crate::robot::{NormalSprings, PointMass, Pose, Robot, Spindle};
use crate::task::Wrench;
use nalgebra::{Matrix3, Matrix6, SMatrix, SVector, Vector3};
use posed::{Applied, Posed};

/// Coordinates: six of the base, three of every joint, six of the mount, three of the tip.
const COUNT: usize = 33;
/// The first coordinate of joint 1.
const JOINTS: usize = 6;
/// The turns of joints 2 and 3 about their axes. On an arm with a linkage the spring of joint 2 turns both, so that the
/// forearm keeps its direction.
const SECOND: usize = JOINTS + 3;
const THIRD: usize = JOINTS + 6;
/// The first coordinate of the mount.
const MOUNT: usize = 24;
/// The first coordinate of the tip.
const TIP: usize = 30;

type Coordinates = SVector<f64, COUNT>;
type Square = SMatrix<f64, COUNT, COUNT>;

/// An arm with a spindle, and everything of it that yields.
#[derive(Debug, Clone)]
pub struct ElasticArm<'a> {
    robot: &'a Robot,
    spindle: &'a Spindle,
    /// Coordinates per scaled coordinate, but for the joints about their axes, whose compliance may depend on the
    /// angle.
    scale: Box<Square>,
    bearings: [f64; 6],
    /// Acceleration of free fall in the frame of the arm, where weight counts. m/s^2
    free_fall: Option<Vector3<f64>>,
}

impl<'a> ElasticArm<'a> {
    /// An arm without weight.
    pub fn new(robot: &'a Robot, spindle: &'a Spindle) -> Self {
        let mut scale = Box::new(Square::zeros());
        let mut set = |at: usize, root: Matrix6<f64>| scale.fixed_view_mut::<6, 6>(at, at).copy_from(&root);
        if let Some((_, matrix)) = robot.yielding_base() {
            set(0, root::of(matrix));
        }
        if let Some(matrix) = &spindle.mount {
            set(MOUNT, root::of(matrix));
        }
        if let Some(matrix) = &spindle.tip {
            let tip: Matrix3<f64> = root::of(matrix);
            scale.fixed_view_mut::<3, 3>(TIP, TIP).copy_from(&tip);
        }
        let mut bearings = [0.0; 6];
        for (j, NormalSprings { compliance, bearing }) in robot.normal_springs().into_iter().flatten().enumerate() {
            bearings[j] = *bearing;
            for (about, compliance) in compliance.iter().enumerate() {
                let k = JOINTS + 3 * j + 1 + about;
                scale[(k, k)] = libm::sqrt(*compliance);
            }
        }
        Self { robot, spindle, scale, bearings, free_fall: None }
    }

    /// The same arm with the weight of its links and of what its flange carries, as far as their masses are known, in a
    /// field of gravity: acceleration of free fall in the frame in which the arm is given, m/s^2.
    #[must_use]
    pub fn in_gravity(self, free_fall: Vector3<f64>) -> Self {
        Self { free_fall: Some(free_fall), ..self }
    }

    /// Where the tool comes to rest, in the frame in which the arm is given, commanded to joint angles `theta` (rad).
    ///
    /// # Errors
    /// [`NoEquilibrium`] when the arm gives way before the load is complete.
    pub fn at_rest(&self, theta: &[f64; 6], load: &Wrench) -> Result<Pose<f64>, NoEquilibrium> {
        let scale = self.scale_at(&self.robot.compliances_at(theta));
        let taken = self.taken(theta);
        let deflection = loaded_in_steps(Coordinates::zeros(), |share, start| {
            settled(&scale, start, |deflection| {
                let posed = self.posed(theta, &(scale * deflection));
                let applied = self.applied(&posed, load, share);
                let inverse = inverse_tangent(&(scale.tr_mul(&posed.hessian(&applied)) * scale))?;
                Some((inverse, posed.torques(&applied) + taken * share))
            })
        })?;
        Ok(self.posed(theta, &(scale * deflection)).base_from_tool)
    }

    /// The displacement of the tool centre point and the turn of the tool by the weight alone, linear in it, commanded
    /// to joint angles `theta` (rad). Nothing for an arm without gravity.
    pub fn sag(&self, theta: &[f64; 6]) -> Displacement<f64> {
        let scale = self.scale_at(&self.robot.compliances_at(theta));
        let posed = self.posed(theta, &Coordinates::zeros());
        let torques = posed.torques(&self.applied(&posed, &Wrench::default(), 1.0)) + self.taken(theta);
        posed.moved(&(scale * scale.tr_mul(&torques)))
    }

    /// The displacement of the tool as Klimchik et al. (2017) take it, by the compliance under the load itself
    /// ([`super::loaded::loaded_displacement`], eq. 9 with 11), for compliances of the joints about their axes in
    /// rad/(N m).
    ///
    /// # Errors
    /// [`Buckled`] when the arm has no stiffness left under the load.
    pub fn loaded_displacement(
        &self,
        compliances: &[f64; 6],
        theta: &[f64; 6],
        load: &Wrench,
    ) -> Result<Displacement<f64>, Buckled> {
        let scale = self.scale_at(compliances);
        let posed = self.posed(theta, &Coordinates::zeros());
        let applied = self.applied(&posed, load, 1.0);
        let softening = scale.tr_mul(&posed.hessian(&applied)) * scale;
        let inverse = inverse_tangent(&softening).ok_or_else(|| {
            if softening.iter().any(|entry| !entry.is_finite()) {
                return Buckled { share: 0.0 };
            }
            let most = ((softening + softening.transpose()) * 0.5).symmetric_eigenvalues().max();
            Buckled { share: (1.0 / most).min(1.0) }
        })?;
        Ok(posed.moved(&(scale * (inverse * scale.tr_mul(&posed.torques(&applied))))))
    }

    /// Coordinates per scaled coordinate, with the joints about their axes.
    fn scale_at(&self, compliances: &[f64; 6]) -> Square {
        let mut scale = *self.scale;
        for (j, compliance) in compliances.iter().enumerate() {
            let k = JOINTS + 3 * j;
            scale[(k, k)] = libm::sqrt(*compliance);
        }
        if self.robot.has_linkage() {
            scale[(THIRD, SECOND)] = -self.robot.geometry().fold * scale[(SECOND, SECOND)];
        }
        scale
    }

    /// Torques with which compensators of the joints oppose the weight, about the axes that have one: what the weight
    /// does to their springs at the commanded angles, joints 4 and 6 at zero. N m
    fn taken(&self, theta: &[f64; 6]) -> Coordinates {
        let mut taken = Coordinates::zeros();
        let Some(dynamics) = self.robot.dynamics() else { return taken };
        if self.free_fall.is_none() || !dynamics.iter().any(|joint| joint.gravity_compensated) {
            return taken;
        }
        let planar = [theta[0], theta[1], theta[2], 0.0, theta[4], 0.0];
        let posed = self.posed(&planar, &Coordinates::zeros());
        let torques = posed.torques(&self.applied(&posed, &Wrench::default(), 1.0));
        for (j, _) in dynamics.iter().enumerate().filter(|(_, joint)| joint.gravity_compensated) {
            let k = JOINTS + 3 * j;
            taken[k] = -torques[k];
        }
        if self.robot.has_linkage() {
            // Motor 2 carries tau_2 - tau_3, and motor 3 the forearm, about both joints.
            let fold = self.robot.geometry().fold;
            let is_taken = |joint: usize| dynamics[joint].gravity_compensated;
            let third = if is_taken(2) { torques[THIRD] } else { 0.0 };
            let second = if is_taken(1) { torques[SECOND] - fold * torques[THIRD] } else { 0.0 };
            (taken[SECOND], taken[THIRD]) = (-second - fold * third, -third);
        }
        taken
    }

    /// What presses on the posed chain: a share of a load on the tool, and of the weight where that counts.
    fn applied(&self, posed: &Posed, load: &Wrench, share: f64) -> [Applied; 8] {
        let mut all = [Applied::NONE; 8];
        all[7] = Applied {
            behind: COUNT,
            point: posed.base_from_tool.translation,
            force: load.force * share,
            moment: load.moment * share,
        };
        let Some(free_fall) = self.free_fall.map(|free_fall| free_fall * share) else { return all };
        let weight = |behind: usize, frame: &Pose<f64>, mass: PointMass| Applied {
            behind,
            point: frame.point(&mass.centre),
            force: free_fall * mass.mass,
            moment: Vector3::zeros(),
        };
        for (j, joint) in self.robot.dynamics().into_iter().flatten().enumerate() {
            all[j] = weight(JOINTS + 3 * (j + 1), &posed.links[j], joint.link.point_mass());
        }
        if let Some(mass) = self.spindle.carried_mass() {
            all[6] = weight(TIP, &posed.flange, mass);
        }
        all
    }

    fn posed(&self, theta: &[f64; 6], q: &Coordinates) -> Posed {
        posed::Chain { robot: self.robot, spindle: self.spindle, bearings: &self.bearings }.at(theta, q)
    }
}

/// `(1 - S^T H S)^-1`, where its symmetric part is positive definite.
fn inverse_tangent(softening: &Square) -> Option<Square> {
    let tangent = Square::identity() - softening;
    let symmetric = (tangent + tangent.transpose()) * 0.5;
    symmetric.cholesky().and_then(|_| tangent.try_inverse())
}
