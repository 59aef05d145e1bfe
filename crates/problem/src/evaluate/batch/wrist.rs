//! The second half of the batch evaluator: wrist, conditioning and score of the states that the first three joints
//! allow.

use super::arm::{Arm, Elbow};
use super::limit::Limit;
use super::pose::{Directions, Load, Pose, Vector, turned};
use super::whole::{Beside, Planar, WholeState};
use super::{BatchEvaluator, Constants, Flips, Set, Turning};
use stead_numerics::simd::{LaneNumber, Lanes, Mask, Simd};

/// A state that is scored: the same for every set of compliances.
struct ScoredState<'a, S: Simd, const N: usize> {
    pose: &'a Pose<S>,
    demand: &'a Demand<S, N>,
    directions: &'a Directions<S>,
    planar: Planar<S>,
}

/// What the tool is to do, in the frame of joint 1: the same for both elbows.
pub(super) struct Demand<S: Simd, const N: usize> {
    x6: Vector<S>,
    y6: Vector<S>,
    z6: Vector<S>,
    lever: Vector<S>,
    load: Load<S, N>,
    beside: Beside<S, N>,
}

impl<S: Simd, const N: usize> Demand<S, N> {
    #[inline(always)]
    pub fn new<const WHOLE: bool>(
        simd: S,
        constants: &Constants<'_, S::Number>,
        arm: &Arm<S>,
        cosine: Lanes<S>,
        sine: Lanes<S>,
    ) -> Self {
        let Constants { flange: [x6, y6, z6, lever], fixed, .. } = constants;
        let force = Self::constant(&constants.force, arm);
        // A loop and not a closure, which would be compiled without the processor's wide instructions.
        let mut directions = [force; N];
        for (turned, direction) in directions.iter_mut().zip(&constants.directions) {
            *turned = Self::constant(direction, arm);
        }
        let x6 = Self::turning(x6, arm, cosine, sine);
        let y6 = Self::turning(y6, arm, cosine, sine);
        let z6 = Self::turning(z6, arm, cosine, sine);
        let zero = Lanes::splat(simd, 0.0);
        let mut beside = Beside { parts: [zero; N], responses: [force; N], flange: [x6, y6, z6] };
        if WHOLE {
            beside.parts = fixed.at(simd, cosine, sine);
            for (turned, response) in beside.responses.iter_mut().zip(&fixed.responses) {
                let response = [response.x, response.y, response.z].map(S::Number::of);
                *turned = Self::constant(&response, arm);
            }
        }
        Self {
            x6,
            y6,
            z6,
            lever: Self::turning(lever, arm, cosine, sine),
            load: Load { directions, force, moment: Self::constant(&constants.moment, arm) },
            beside,
        }
    }

    #[inline(always)]
    fn turning(v: &Turning<S::Number>, arm: &Arm<S>, cosine: Lanes<S>, sine: Lanes<S>) -> Vector<S> {
        turned([v.at(0, cosine, sine), v.at(1, cosine, sine), v.at(2, cosine, sine)], arm.sin1, arm.cos1)
    }

    #[inline(always)]
    fn constant(v: &[S::Number; 3], arm: &Arm<S>) -> Vector<S> {
        turned([arm.sin1.all_of(v[0]), arm.sin1.all_of(v[1]), arm.sin1.all_of(v[2])], arm.sin1, arm.cos1)
    }
}

/// States that the first three joints allow, theta_5 not negative, whatever the limits of the wrist.
struct Bent<S: Simd> {
    pose: Pose<S>,
    planar: Planar<S>,
    /// Sines and cosines of joints 4 to 6; those of joints 4 and 6 are to be divided by the sine of joint 5.
    joints: [[Lanes<S>; 2]; 3],
    per_sine: Lanes<S>,
}

/// Sines and cosines of joints 4 to 6 of a flipped wrist: joint 5 is bent to the other side, and joints 4 and 6 point
/// the other way.
#[inline(always)]
fn flipped<S: Simd>(joints: [[Lanes<S>; 2]; 3]) -> [[Lanes<S>; 2]; 3] {
    let [fourth, fifth, sixth] = joints;
    [[-fourth[0], -fourth[1]], [-fifth[0], fifth[1]], [-sixth[0], -sixth[1]]]
}

impl BatchEvaluator<'_> {
    /// Elbow, forearm and wrist.
    #[inline(always)]
    fn bent<S: Simd, const N: usize>(&self, simd: S, demand: &Demand<S, N>, arm: &Arm<S>, elbow: &Elbow<S>) -> Bent<S> {
        let g = self.problem.robot.geometry();
        let zero = Lanes::splat(simd, 0.0);
        let Demand { x6, y6, z6, lever, .. } = *demand;
        let (s2, c2) = (elbow.sin2, elbow.cos2);

        // Elbow and forearm: the bar from elbow to wrist centre, turned back by its constant angle, is x3.
        let (forward, height) = (arm.forward, arm.height);
        let u = forward - g.shoulder_radius;
        let u3 = u - c2 * g.upper_arm;
        let height3 = height - s2 * (g.lift * g.upper_arm);
        let (bar_cos, bar_sin) = (u3 * (1.0 / g.forearm), height3 * (g.lift / g.forearm));
        let (sin_bar_angle, cos_bar_angle) = (self.forearm_sin_cos.0 * g.fold, self.forearm_sin_cos.1);
        let cos_psi = bar_cos * cos_bar_angle + bar_sin * sin_bar_angle;
        let sin_psi = bar_sin * cos_bar_angle - bar_cos * sin_bar_angle;
        let [twist4, s5, s6] = [g.fold * g.twist[0], g.twist[1], g.twist[2]];
        let z4 = Vector { x: sin_psi * twist4, y: zero, z: cos_psi * (-twist4 * g.lift) };
        let planar = Planar { second: [c2, s2 * g.lift], third: [cos_psi, sin_psi * g.lift] };

        // Wrist, with theta_5 not negative.
        let m1 = z6.x * cos_psi + z6.z * sin_psi * g.lift;
        let m2 = z6.y * (-twist4 * g.lift);
        let dot46 = z6.x * z4.x + z6.z * z4.z;
        let sine5_squared = m1 * m1 + m2 * m2;
        let sine5 = sine5_squared.sqrt();
        let per_sine = Lanes::splat(simd, 1.0) / sine5;
        let z5 = z4.cross(z6).scale(per_sine);
        let linkage = self.problem.robot.has_linkage();
        let pose = Pose { u, height, u3, height3, forward, lever, z4, z5, z6, dot46, sine5_squared, linkage };
        let joints = [[m2 * s6, m1 * s6], [sine5, dot46 * (-s5 * s6)], [z4.dot(y6) * -s5, z4.dot(x6) * s5]];
        Bent { pose, planar, joints, per_sine }
    }

    /// Whether the limits of joints 4 to 6 allow a wrist, by their sines and cosines of any length.
    #[inline(always)]
    fn allows_wrist<S: Simd>(simd: S, limits: &[Limit<S::Number>; 6], joints: [[Lanes<S>; 2]; 3]) -> Mask<S> {
        let [_, _, _, l4, l5, l6] = *limits;
        l4.allows(simd, joints[0]) & l5.allows(simd, joints[1]) & l6.allows(simd, joints[2])
    }

    /// Scores of the states with one elbow, infinite where not allowed, and the sines and cosines of their joint angles
    /// (theta_5 not negative); nothing where none is allowed. `PLAIN` where there is one set of compliances, and scores
    /// cover no errors.
    #[inline(always)]
    pub(super) fn wrist<S: Simd, const PLAIN: bool, const WHOLE: bool, const N: usize>(
        &self,
        simd: S,
        constants: &Constants<'_, S::Number>,
        demand: &Demand<S, N>,
        arm: &Arm<S>,
        elbow: &Elbow<S>,
    ) -> Option<(Lanes<S>, Directions<S>)> {
        let Bent { pose, planar, joints, per_sine } = self.bent(simd, demand, arm, elbow);
        let lateral = self.problem.robot.geometry().lateral;
        let inverse_condition = pose.inverse_condition(simd, lateral, self.problem.constraints.characteristic_length);
        let conditioned = Lanes::splat(simd, self.problem.constraints.min_inverse_condition).at_most(inverse_condition);
        let Constants { limits, uncertainty, .. } = constants;
        let plain = Self::allows_wrist(simd, limits, joints);
        let turned = Self::allows_wrist(simd, limits, flipped(joints));
        let mut allowed = elbow.allowed
            & conditioned
            & match self.flips {
                Flips::Both => plain | turned,
                Flips::Plain => plain,
                Flips::Flipped => turned,
            };
        if !allowed.any() {
            return None;
        }

        let [fourth, fifth, sixth] = joints;
        let fourth = [fourth[0] * per_sine, fourth[1] * per_sine];
        let sixth = [sixth[0] * per_sine, sixth[1] * per_sine];
        let directions = [[arm.sin1, arm.cos1], [elbow.sin2, elbow.cos2], elbow.third, fourth, fifth, sixth];
        let mut turned = directions;
        if self.flips == Flips::Flipped {
            [turned[3], turned[4], turned[5]] = flipped([fourth, fifth, sixth]);
        }
        let state = ScoredState { pose: &pose, demand, directions: &turned, planar };
        let score = self.score::<S, PLAIN, WHOLE, N>(simd, &state, *uncertainty);
        if let Some(limit) = self.problem.constraints.max_deflection {
            allowed = allowed & score.at_most(Lanes::splat(simd, limit));
            if !allowed.any() {
                return None;
            }
        }
        Some((allowed.select(score, Lanes::splat(simd, f64::INFINITY)), directions))
    }

    /// Scores over all sets of compliances.
    #[inline(always)]
    fn score<S: Simd, const PLAIN: bool, const WHOLE: bool, const N: usize>(
        &self,
        simd: S,
        state: &ScoredState<'_, S, N>,
        uncertainty: f64,
    ) -> Lanes<S> {
        if PLAIN {
            return self.score_of_set::<S, PLAIN, WHOLE, N>(simd, &self.sets[0], state, uncertainty);
        }
        let mut score = Lanes::splat(simd, 0.0);
        for set in &self.sets {
            let other = self.score_of_set::<S, PLAIN, WHOLE, N>(simd, set, state, uncertainty);
            score = if self.is_over_worst { score.max(other) } else { score + other };
        }
        if self.is_over_worst { score } else { score * (1.0 / self.sets.len() as f64) }
    }

    /// Scores with one set of compliances.
    #[inline(always)]
    fn score_of_set<S: Simd, const PLAIN: bool, const WHOLE: bool, const N: usize>(
        &self,
        simd: S,
        set: &Set,
        state: &ScoredState<'_, S, N>,
        uncertainty: f64,
    ) -> Lanes<S> {
        let Set { laws, deviation, normal } = set;
        let ScoredState { pose, demand, directions, planar } = state;
        let compliances = laws.at(simd, &self.limits, directions);
        let lateral = self.problem.robot.geometry().lateral;
        // Two conditions, so that nothing of this is compiled where it is not needed.
        if WHOLE && let Some(fixed) = &self.fixed {
            // Axis 5 against the one that the pose has, z4 x z6.
            let [_, s5, s6] = self.problem.robot.geometry().twist;
            let side = if self.flips == Flips::Flipped { s5 * s6 } else { -s5 * s6 };
            let (load, beside) = (&demand.load, &demand.beside);
            let whole = WholeState { normal, fixed, planar, lateral, side, load, beside };
            let (score, parts) = pose.score_whole::<PLAIN, N>(simd, &whole, &compliances, uncertainty);
            return match deviation {
                Some(known) if !PLAIN => score + known.margin(simd, &self.limits, &parts, directions, &compliances),
                _ => score,
            };
        }
        let (score, parts) = pose.score::<PLAIN, N>(simd, lateral, &compliances, &demand.load, uncertainty);
        match deviation {
            Some(deviation) if !PLAIN => score + deviation.margin(simd, &self.limits, &parts, directions, &compliances),
            _ => score,
        }
    }
}
