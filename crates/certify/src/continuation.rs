//! Elbow and wrist as functions of one number each, continued where no state is allowed.

use super::interval_simd::Lanes;

/// Upper arm and forearm, as [`Number::elbow`] needs them.
///
/// No allowed state has its elbow nearer to stretched or folded than the two limits say. Beyond them the sine of the
/// elbow angle is continued along its tangent: then it has bounded second derivatives everywhere, so that a Taylor
/// model may be made about any state, and is true for all that are allowed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Links {
    pub upper_arm: f64,
    pub forearm: f64,
    /// Least and largest squared distance of the wrist centre from the shoulder. m^2
    pub limits: [f64; 2],
}

impl Links {
    /// Sine of the elbow angle with its first two derivatives by q, continued beyond the limits.
    #[inline(always)]
    pub fn sine(&self, q: Lanes) -> [Lanes; 3] {
        let b = 1.0 / (2.0 * self.upper_arm * self.forearm);
        let inside = q.max(Lanes::splat(self.limits[0])).min(Lanes::splat(self.limits[1]));
        let x = (inside - self.square()) * b;
        let one = Lanes::splat(1.0);
        let s = ((one - x) * (one + x)).sqrt();
        let first = -(x * b) / s;
        [s + first * (q - inside), first, -(Lanes::splat(b * b) / (s * s * s))]
    }

    /// q at which the elbow is at a right angle.
    pub fn square(&self) -> f64 {
        self.upper_arm * self.upper_arm + self.forearm * self.forearm
    }
}

/// One over the squared sine of the angle between axes 4 and 6, as [`Number::wrist`] needs it: a function of its
/// cosine, continued along its tangent beyond the largest cosine that is allowed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bend {
    pub limit: f64,
}

impl Bend {
    #[inline(always)]
    pub fn inverse(&self, x: Lanes) -> [Lanes; 3] {
        let limit = Lanes::splat(self.limit);
        let inside = x.max(-limit).min(limit);
        let value = Lanes::splat(1.0) / (Lanes::splat(1.0) - inside * inside);
        let first = inside * value * value * 2.0;
        let second = (inside * inside * 3.0 + 1.0) * value * value * value * 2.0;
        [value + first * (x - inside), first, second]
    }
}
