//! Force and moment of a milling cutter: at an angle of the turn, and as means over the turn in closed form.
//!
//! A tooth at angle phi (see [`Engagement`]) cuts a chip of thickness `h = f_z sin(phi)` at the full depth of cut a_p
//! and is pushed as its [`Coefficients`] say. Means integrate that over the arcs of the engagement (Klimchik 2017, eq.
//! 5 to 8; with edge terms as Tlusty and MacNeil 1975).
//!
//! **What is left out.** As in Klimchik 2017 a tooth is a point at the radius R in the plane of the tool centre point
//! (eq. 8): the lag of the helix over the depth of cut, which does not change the mean force, and the lever of the
//! height of the cut, [`CuttingForce::lever`]. The feed turns into the chip as if the teeth ran on circles.
//

use super::coefficients::Coefficients;
use super::cutter::Cutter;
use super::engagement::{Engagement, Integrals};
use crate::task::Wrench;
use nalgebra::{Vector3, vector};
use std::f64::consts::TAU;

/// A cutter at a depth of cut and a feed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CuttingForce<'a> {
    /// The cutter.
    pub cutter: &'a Cutter,
    /// Depth of cut a_p. m
    pub axial_depth: f64,
    /// Feed per tooth f_z. m
    pub feed_per_tooth: f64,
}

/// The force on one tooth, over its chip and at its edge. N
struct ToothForce {
    /// Radial, tangential and axial force where the chip is `f_z` thick.
    chip: [f64; 3],
    /// Radial and tangential force of the edge.
    edge: [f64; 2],
}

impl CuttingForce<'_> {
    fn tooth(&self) -> ToothForce {
        let Coefficients { tangential, radial, axial, tangential_edge, radial_edge } = self.cutter.coefficients();
        ToothForce {
            chip: [-radial, -tangential, axial].map(|pressure| self.axial_depth * pressure * self.feed_per_tooth),
            edge: [-radial_edge, -tangential_edge].map(|edge| self.axial_depth * edge),
        }
    }

    /// Wrench of one tooth in the work at angle phi (rad) from 0 to pi, in the frame of [this room](crate::cutting),
    /// the moment about the tool centre point.
    pub fn tooth_wrench(&self, phi: f64) -> Wrench {
        let [outward, motion] = self.cutter.rotation().tooth(phi);
        let ToothForce { chip, edge } = self.tooth();
        let thickness = libm::sin(phi);
        let force = outward * (chip[0] * thickness + edge[0])
            + motion * (chip[1] * thickness + edge[1])
            + Vector3::z() * (chip[2] * thickness);
        Wrench { force, moment: (outward * self.cutter.radius()).cross(&force) }
    }

    /// Wrench of all teeth while the first is at angle phi (rad), any angle, in the frame of [this
    /// room](crate::cutting).
    pub fn instantaneous_wrench(&self, engagement: &Engagement, phi: f64) -> Wrench {
        let mut sum = Wrench::default();
        for offset in self.cutter.offsets() {
            let phi = (phi + offset).rem_euclid(TAU);
            if engagement.cuts_at(phi) {
                let wrench = self.tooth_wrench(phi);
                sum.force += wrench.force;
                sum.moment += wrench.moment;
            }
        }
        sum
    }

    /// Mean wrench of all teeth over a turn, in the frame of [this room](crate::cutting): eq. 5 to 8 in closed form,
    /// summed over the teeth.
    pub fn mean_wrench(&self, engagement: &Engagement) -> Wrench {
        self.mean_over(engagement.integrals())
    }

    /// What the height of a cut that begins at the tip adds to the moment about the tool centre point of a force: half
    /// the depth of cut along the tool axis, times the force. The other moments here leave it out, as Klimchik 2017
    /// does; the moments along a path with its stock have it.
    #[cfg(any(test, feature = "testing"))]
    pub fn lever(&self, force: &Vector3<f64>) -> Vector3<f64> {
        (Vector3::z() * (self.axial_depth / 2.0)).cross(force)
    }

    /// The mean wrench from the integrals over the arcs.
    pub(super) fn mean_over(&self, turn: Integrals) -> Wrench {
        let spin = self.cutter.rotation().sign();
        let ToothForce { chip: [radial, tangential, axial], edge: [radial_edge, tangential_edge] } = self.tooth();
        let force = vector![
            (radial * turn.sine_squared + radial_edge * turn.sine)
                + (tangential * turn.sine_cosine + tangential_edge * turn.cosine),
            spin * ((tangential * turn.sine_squared + tangential_edge * turn.sine)
                - (radial * turn.sine_cosine + radial_edge * turn.cosine)),
            axial * turn.sine
        ];
        let moment = vector![
            -spin * axial * turn.sine_cosine,
            -axial * turn.sine_squared,
            spin * (tangential * turn.sine + tangential_edge * turn.angle)
        ];
        let teeth_per_radian = self.cutter.teeth().len() as f64 / TAU;
        Wrench { force: force * teeth_per_radian, moment: moment * (self.cutter.radius() * teeth_per_radian) }
    }
}
