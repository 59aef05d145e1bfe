//! The force and the moment of a milling cutter from the geometry of its teeth (Klimchik 2017, section 2.2).
//!
//! **One tooth.** A tooth at angle phi (see [`Engagement`]) cuts a chip of thickness `f_z sin(phi) sin(kappa)` and width
//! `a_p / sin(kappa)`, so of area `f_z a_p sin(phi)` whatever the entering angle kappa. Its rake face is pressed with the normal
//! force `F_n = K_n f_z a_p sin(phi)` (eq. 1), and the chip that slides along it drags it with `k_f F_n`.
//!
//! **Its direction.** Tooth frame: radial, from the cutter's axis out to the tooth; tangential, along the motion of the tooth;
//! axial, from the work to the spindle. The paper names a rotation `R(kappa, lambda_s, gamma_0)` and does not write it out. Ours
//! is made of three steps, each with its unit vectors:
//!
//! 1. The entering angle kappa stands between the cutting edge and the plane of the feed, normal to the cutter's axis:
//!    `n = radial sin(kappa) - axial cos(kappa)` is normal to the cut surface, into the work, and
//!    `s = radial cos(kappa) + axial sin(kappa)` runs up along the edge.
//! 2. The helix angle lambda_s turns motion and edge about n, so that the edge falls back with height:
//!    `t' = tangential cos(lambda_s) + s sin(lambda_s)`, `s' = s cos(lambda_s) - tangential sin(lambda_s)`. A positive helix is
//!    of the hand of the cut, right-hand on a cutter that turns clockwise.
//! 3. The cutting angle gamma_0 turns the rake face about the edge s', back from the work when positive; this is the normal rake
//!    of ISO 3002. The chip leaves along `f = -n cos(gamma_0) - t' sin(gamma_0)`, and the normal into the rake face is
//!    `p = n sin(gamma_0) - t' cos(gamma_0)`.
//!
//! The force on the tooth is `F_n (p + k_f f)`, that is `F_n R C` with `R = [p, s', f]` and `C = [1, 0, k_f]` (eq. 2 and 6). With
//! kappa = 90 deg and the other angles zero it is `-F_n` tangential and `-k_f F_n` radial: against the motion, and away from the
//! work. A positive rake draws the tool into the work, a positive helix draws it out of the spindle.
//!
//! **What is left out.** As in the paper a tooth is a point at the radius R in the plane of the tool centre point (eq. 8): the
//! lag of the helix over the depth of cut, which does not change the mean force, and the lever of the height of the cut, at most
//! `a_p` times the force. There are no edge forces, and the feed turns into the chip as if the teeth ran on circles.
//!
//! **The published case.** With R = 5 mm, z = 3, kappa = 90 deg, gamma_0 = 7 deg, lambda_s = 45 deg, f_z = 0.08 mm, a_p = 5 mm
//! and K_n = 750 MPa the paper prints F = (-440, -1370, -635) N and M = (0, 3, 10.5) N m in a full slot (section 5.1), and does
//! not print k_f. No k_f gives that: at these angles |F_y / F_z| is pi / 4 for any, and k_f = 0.4 gives
//! F = (-61.9, 165.7, -210.9) N and M = (0, 0.83, 1.05) N m. Whatever the angles, M_y / F_z and M_z / F_y of a slot are R pi / 4
//! and 4 R / pi, and both printed ratios say R = 6.0 mm. All printed digits, but for the sign of F_y, come out with that R,
//! lambda_s = 20 deg, gamma_0 = 5 deg and k_f = 0.4 if the factor 1 / (2 pi) of eq. 4 to 7 is left out. So the printed force is
//! probably that of another cutter, and 2 pi times its mean. By eq. 8, F_y has the sign of M_z wherever M_x is 0, M_y positive
//! and F_z negative.

use super::engagement::{Engagement, Integrals};
use super::rotation::Rotation;
use crate::task::Wrench;
use nalgebra::{Matrix3, Vector3, vector};
use std::f64::consts::TAU;

/// A milling cutter, its specific cutting coefficient, and the feed and depth of its cut.
#[derive(Debug, Clone, PartialEq)]
pub struct MillingTool {
    /// Cutter radius R, the lever of the tooth forces. m
    pub radius: f64,
    /// Number of teeth z.
    pub teeth: u32,
    /// Sense of rotation.
    pub rotation: Rotation,
    /// Entering angle kappa, above 0 and below pi. rad
    pub entering_angle: f64,
    /// Helix angle lambda_s, the inclination of the edge, within a quarter turn; positive of the hand of the cut. rad
    pub helix: f64,
    /// Cutting angle gamma_0, the normal rake, within a quarter turn. rad
    pub rake: f64,
    /// Ratio k_f of friction to normal force on the rake face.
    pub friction: f64,
    /// Specific cutting coefficient K_n: normal force on the rake face over area of the chip. Pa
    pub normal_pressure: f64,
    /// Feed per tooth f_z. m
    pub feed_per_tooth: f64,
    /// Depth of cut a_p. m
    pub axial_depth: f64,
}

impl MillingTool {
    /// The rotation `R(kappa, lambda_s, gamma_0)` of eq. 2: its columns are the normal into the rake face, the edge and the way
    /// of the chip, each by its radial, tangential and axial part.
    pub fn rake_face(&self) -> Matrix3<f64> {
        let (entering_sine, entering_cosine) = libm::sincos(self.entering_angle);
        let (helix_sine, helix_cosine) = libm::sincos(self.helix);
        let (rake_sine, rake_cosine) = libm::sincos(self.rake);
        let into_work = vector![entering_sine, 0.0, -entering_cosine];
        let up_edge = vector![entering_cosine, 0.0, entering_sine];
        let motion = Vector3::y();
        let motion_across = motion * helix_cosine + up_edge * helix_sine;
        let edge = up_edge * helix_cosine - motion * helix_sine;
        let normal = into_work * rake_sine - motion_across * rake_cosine;
        let chip = -into_work * rake_cosine - motion_across * rake_sine;
        Matrix3::from_columns(&[normal, edge, chip])
    }

    /// Radial, tangential and axial force on a tooth over the normal force on its rake face: `R C` of eq. 6.
    pub fn force_ratios(&self) -> Vector3<f64> {
        self.rake_face() * vector![1.0, 0.0, self.friction]
    }

    /// Wrench of one tooth in the work at angle phi from 0 to pi (eq. 1, 3 and 8), in the frame of
    /// [this room](crate::cutting), the moment about the tool centre point.
    pub fn tooth_wrench(&self, phi: f64) -> Wrench {
        let [outward, motion] = self.rotation.tooth(phi);
        let ratios = self.force_ratios();
        let direction = outward * ratios.x + motion * ratios.y + Vector3::z() * ratios.z;
        let force = direction * (self.largest_normal_force() * libm::sin(phi));
        Wrench { force, moment: (outward * self.radius).cross(&force) }
    }

    /// Wrench of all teeth while the first is at angle phi, any angle, in the frame of [this room](crate::cutting).
    pub fn instantaneous_wrench(&self, engagement: &Engagement, phi: f64) -> Wrench {
        let mut sum = Wrench::zero();
        for tooth in 0..self.teeth {
            let phi = (phi + TAU * f64::from(tooth) / f64::from(self.teeth)).rem_euclid(TAU);
            if engagement.cuts_at(phi) {
                let wrench = self.tooth_wrench(phi);
                sum.force += wrench.force;
                sum.moment += wrench.moment;
            }
        }
        sum
    }

    /// Mean wrench of all teeth over a turn, in the frame of [this room](crate::cutting): eq. 5 to 8 in closed form, summed
    /// over the teeth.
    pub fn mean_wrench(&self, engagement: &Engagement) -> Wrench {
        self.mean_over(engagement.integrals())
    }

    /// The mean wrench from the integrals over the arcs.
    pub(super) fn mean_over(&self, turn: Integrals) -> Wrench {
        let spin = self.rotation.sign();
        let [radial, tangential, axial] =
            (self.force_ratios() * (self.largest_normal_force() * f64::from(self.teeth) / TAU)).into();
        let force = vector![
            radial * turn.sine_squared + tangential * turn.sine_cosine,
            spin * (tangential * turn.sine_squared - radial * turn.sine_cosine),
            axial * turn.sine
        ];
        let moment =
            vector![-spin * axial * turn.sine_cosine, -axial * turn.sine_squared, spin * tangential * turn.sine];
        Wrench { force, moment: moment * self.radius }
    }

    /// Normal force on the rake face of a tooth in front, `K_n f_z a_p`. N
    fn largest_normal_force(&self) -> f64 {
        self.normal_pressure * self.feed_per_tooth * self.axial_depth
    }
}
