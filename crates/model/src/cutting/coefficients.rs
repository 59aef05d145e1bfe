//! Cutting coefficients: force on a tooth over chip thickness and depth of cut, given as such or derived from the
//! geometry of the rake face (Klimchik 2017, section 2.2).
//!
//! # The linear law with edge forces
//!
//! At a depth of cut b and a chip of thickness h the work pushes a tooth with `b (K_t h + K_te)` against its motion,
//! with `b (K_r h + K_re)` from the edge to the cutter's axis, and with `b K_a h` along the tool axis from the work to
//! the spindle (mechanistic model with edge terms, after Tlusty and MacNeil 1975, the model that Caro 2013 names; UMONS
//! paper, eq. 13).
//!
//! # The rake face
//!
//! **One tooth.** A tooth at angle phi (see [`Engagement`]) cuts a chip of thickness `f_z sin(phi) sin(kappa)` and
//! width `a_p / sin(kappa)`, so of area `f_z a_p sin(phi)` whatever the entering angle kappa. Its rake face is pressed
//! with the normal force `F_n = K_n f_z a_p sin(phi)` (eq. 1), and the chip that slides along it drags it with
//! `k_f F_n`.
//!
//! **Its direction.** Tooth frame: radial, from the cutter's axis out to the tooth; tangential, along the motion of the
//! tooth; axial, from the work to the spindle. The paper names a rotation `R(kappa, lambda_s, gamma_0)` and does not
//! write it out. Ours is made of three steps, each with its unit vectors:
//!
//! 1. The entering angle kappa stands between the cutting edge and the plane of the feed, normal to the cutter's axis:
//!    `n = radial sin(kappa) - axial cos(kappa)` is normal to the cut surface, into the work, and
//!    `s = radial cos(kappa) + axial sin(kappa)` runs up along the edge.
//! 2. The helix angle lambda_s turns motion and edge about n, so that the edge falls back with height:
//!    `t' = tangential cos(lambda_s) + s sin(lambda_s)`, `s' = s cos(lambda_s) - tangential sin(lambda_s)`. A positive
//!    helix is of the hand of the cut, right-hand on a cutter that turns clockwise.
//! 3. The cutting angle gamma_0 turns the rake face about the edge s', back from the work when positive; this is the
//!    normal rake of ISO 3002. The chip leaves along `f = -n cos(gamma_0) - t' sin(gamma_0)`, and the normal into the
//!    rake face is `p = n sin(gamma_0) - t' cos(gamma_0)`.
//!
//! The force on the tooth is `F_n (p + k_f f)`, that is `F_n R C` with `R = [p, s', f]` and `C = [1, 0, k_f]` (eq. 2
//! and 6). With kappa = 90 deg and the other angles zero it is `-F_n` tangential and `-k_f F_n` radial: against the
//! motion, and away from the work. A positive rake draws the tool into the work, a positive helix draws it out of the
//! spindle.
//!
//! **The published case.** With R = 5 mm, z = 3, kappa = 90 deg, gamma_0 = 7 deg, lambda_s = 45 deg, f_z = 0.08 mm, a_p
//! = 5 mm and K_n = 750 MPa the paper prints F = (-440, -1370, -635) N and M = (0, 3, 10.5) N m in a full slot (section
//! 5.1), and does not print k_f. No k_f gives that: at these angles |F_y / F_z| is pi / 4 for any, and k_f = 0.4 gives
//! F = (-61.9, 165.7, -210.9) N and M = (0, 0.83, 1.05) N m. Whatever the angles, M_y / F_z and M_z / F_y of a slot are
//! R pi / 4 and 4 R / pi, and both printed ratios say R = 6.0 mm. All printed digits, but for the sign of F_y, come out
//! with that R, lambda_s = 20 deg, gamma_0 = 5 deg and k_f = 0.4 if the factor 1 / (2 pi) of eq. 4 to 7 is left out. So
//! the printed force is probably that of another cutter, and 2 pi times its mean. By eq. 8, F_y has the sign of M_z
//! wherever M_x is 0, M_y positive and F_z negative.

use nalgebra::{Matrix3, Vector3, vector};
use serde::Serialize;

/// Coefficients of the linear cutting force law with edge forces.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Coefficients {
    /// K_t, against the motion of the tooth. Pa
    pub tangential: f64,
    /// K_r, from the edge to the cutter's axis. Pa
    pub radial: f64,
    /// K_a, on the tool along its axis from the work to the spindle. Pa
    pub axial: f64,
    /// K_te: edge force against the motion of the tooth, over the depth of cut. N/m
    pub tangential_edge: f64,
    /// K_re: edge force to the cutter's axis, over the depth of cut. N/m
    pub radial_edge: f64,
}

impl Coefficients {
    /// K_t, K_r and K_a (Pa), without edge forces.
    pub const fn new(tangential: f64, radial: f64, axial: f64) -> Self {
        Self { tangential, radial, axial, tangential_edge: 0.0, radial_edge: 0.0 }
    }

    /// All five, in the order of the fields.
    pub(super) fn parts(&self) -> [f64; 5] {
        [self.tangential, self.radial, self.axial, self.tangential_edge, self.radial_edge]
    }

    /// Whether there is an edge force.
    pub fn has_edge_forces(&self) -> bool {
        self.tangential_edge != 0.0 || self.radial_edge != 0.0
    }
}

/// The rake face of a tooth with its friction and specific cutting coefficient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RakeFace {
    /// Entering angle kappa, above 0 and below pi. rad
    pub entering_angle: f64,
    /// Cutting angle gamma_0, the normal rake, within a quarter turn. rad
    pub rake: f64,
    /// Ratio k_f of friction to normal force on the rake face.
    pub friction: f64,
    /// Specific cutting coefficient K_n: normal force on the rake face over area of the chip. Pa
    pub normal_pressure: f64,
}

impl RakeFace {
    /// The rotation `R(kappa, lambda_s, gamma_0)` of eq. 2: its columns are the normal into the rake face, the edge and
    /// the way of the chip, each by its radial, tangential and axial part, for a helix angle (rad).
    pub fn axes(&self, helix: f64) -> Matrix3<f64> {
        let (entering_sine, entering_cosine) = libm::sincos(self.entering_angle);
        let (helix_sine, helix_cosine) = libm::sincos(helix);
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
    pub fn force_ratios(&self, helix: f64) -> Vector3<f64> {
        self.axes(helix) * vector![1.0, 0.0, self.friction]
    }

    /// The coefficients that give the same force: `K_n R C`, without edge forces.
    pub fn coefficients(&self, helix: f64) -> Coefficients {
        let [radial, tangential, axial] = (self.force_ratios(helix) * self.normal_pressure).into();
        Coefficients::new(-tangential, -radial, axial)
    }
}
