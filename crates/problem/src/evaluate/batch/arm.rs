//! The first half of the batch evaluator: joints 1 to 3, which bring the wrist centre to its place.

use super::limit::Limit;
use super::{BatchEvaluator, Constants};
use stead_numerics::simd::{Lanes, Mask, Simd};

/// Wrist centres of neighbouring values of beta.
#[derive(Clone, Copy)]
pub(super) struct Centre<S: Simd> {
    x: Lanes<S>,
    y: Lanes<S>,
    inverse_radius2: Lanes<S>,
    /// Distance along the arm from axis 1, not negative; NaN where the lateral offset is larger. m
    forward: Lanes<S>,
    /// Above the shoulder. m
    height: Lanes<S>,
}

/// Joint 1, and both elbows, with the wrist centre on one side of axis 1.
#[derive(Clone, Copy)]
pub(super) struct Arm<S: Simd> {
    pub sin1: Lanes<S>,
    pub cos1: Lanes<S>,
    /// Wrist centre along the arm. m
    pub forward: Lanes<S>,
    /// Wrist centre above the shoulder. m
    pub height: Lanes<S>,
    /// With delta not negative, and negative.
    pub elbows: [Elbow<S>; 2],
}

/// One elbow.
#[derive(Clone, Copy)]
pub(super) struct Elbow<S: Simd> {
    pub sin2: Lanes<S>,
    pub cos2: Lanes<S>,
    /// Sine and cosine of theta_3.
    pub third: [Lanes<S>; 2],
    /// Where it reaches the point with joints 1 to 3 inside their limits.
    pub allowed: Mask<S>,
}

impl BatchEvaluator<'_> {
    /// Wrist centres from `start` on.
    #[inline(always)]
    pub(super) fn centre<S: Simd>(
        &self,
        simd: S,
        constants: &Constants<'_, S::Number>,
        cosine: Lanes<S>,
        sine: Lanes<S>,
    ) -> Centre<S> {
        let g = self.problem.robot.geometry();
        let Constants { tip, flange: [.., lever], .. } = constants;
        let x = cosine.all_of(tip[0]) - lever.at(0, cosine, sine);
        let y = cosine.all_of(tip[1]) - lever.at(1, cosine, sine);
        let z = cosine.all_of(tip[2]) - lever.at(2, cosine, sine);
        let radius2 = x * x + y * y;
        let forward2 = radius2 - g.lateral * g.lateral;
        Centre {
            x,
            y,
            inverse_radius2: Lanes::splat(simd, 1.0) / radius2,
            forward: forward2.sqrt(),
            height: z - g.shoulder_height,
        }
    }

    /// The first three joints, wrist centre in front (or back) of joint 1, both elbows.
    #[inline(always)]
    pub(super) fn arm<S: Simd>(
        &self,
        simd: S,
        limits: &[Limit<S::Number>; 6],
        centre: &Centre<S>,
        back: bool,
    ) -> Arm<S> {
        let g = self.problem.robot.geometry();
        let sign = if back { -1.0 } else { 1.0 };
        let product = 1.0 / (2.0 * g.upper_arm * g.forearm);
        let squares = g.upper_arm * g.upper_arm + g.forearm * g.forearm;
        let one = Lanes::splat(simd, 1.0);
        let forward = centre.forward * sign;
        let height = centre.height;
        let u = forward - g.shoulder_radius;
        let v = height * g.lift;
        let distance2 = u * u + v * v;
        let cosine = (distance2 - squares) * product;
        let sine = ((one - cosine) * (cosine + 1.0)).sqrt();
        let along = cosine * g.forearm + g.upper_arm;
        let across = sine * (g.fold * g.forearm);
        let (u_along, v_along) = (u * along, v * along);
        let (u_across, v_across) = (u * across, v * across);
        let inverse = one / distance2;
        let (sin_bar, cos_bar) = self.forearm_sin_cos;
        let sin1 = (centre.y * forward - centre.x * g.lateral) * centre.inverse_radius2;
        let cos1 = (centre.x * forward + centre.y * g.lateral) * centre.inverse_radius2;
        // Out of reach the sine is NaN, and so is everything made of it.
        let exists = sine.at_most(one) & limits[0].allows(simd, [sin1, cos1]);
        let none = Elbow { sin2: sine, cos2: sine, third: [sine; 2], allowed: exists };
        let mut elbows = [none; 2];
        for (elbow, e) in elbows.iter_mut().zip([1.0, -1.0]) {
            let sine2 = v_along - u_across * e;
            let cosine2 = u_along + v_across * e;
            let third = [sine * (e * cos_bar) - cosine * sin_bar, cosine * cos_bar + sine * (e * sin_bar)];
            let mut allowed = exists & limits[1].allows(simd, [sine2, cosine2]) & limits[2].allows(simd, third);
            if let Some(sum) = &self.sum {
                allowed = allowed & sum.allows([sine2, cosine2], third);
            }
            *elbow = Elbow { sin2: sine2 * inverse, cos2: cosine2 * inverse, third, allowed };
        }
        Arm { sin1, cos1, forward, height, elbows }
    }
}
