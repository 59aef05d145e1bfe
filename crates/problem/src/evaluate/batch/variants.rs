//! The loop of the batch evaluator over beta and postures, once for each kind of numbers and of problem.

use super::wrist::Demand;
use super::{BatchEvaluator, Constants, PointGeometry, StateGrid};
use crate::criterion::Aggregate;
use std::ops::Range as Span;
use stead_model::robot::PostureClass;
use stead_numerics::simd::{LaneNumber, Lanes, Simd, WithSimd};

/// Numbers that the evaluator works in: for each it is compiled in this crate, and not again in those that use it.
pub trait KernelNumber: LaneNumber {
    /// Evaluates a point; `is_plain` where there is one set of compliances, and scores cover no errors.
    fn evaluate(evaluation: Evaluation<'_, Self>, is_plain: bool);
}

macro_rules! compiled_here {
    ($($number:ty),+) => {
        $(impl KernelNumber for $number {
            fn evaluate(evaluation: Evaluation<'_, Self>, is_plain: bool) {
                evaluation.by_variant(is_plain);
            }
        })+
    };
}
compiled_here!(f64, f32);

/// The evaluation of one point, for any instructions of the processor.
pub struct Evaluation<'k, E> {
    pub(super) evaluator: &'k BatchEvaluator<'k>,
    pub(super) geometry: &'k PointGeometry,
    pub(super) classes: [bool; 4],
    /// Of all values of beta.
    pub(super) sine: &'k [E],
    pub(super) cosine: &'k [E],
    /// Numbers of beta; their neighbours in the same lanes are evaluated too.
    pub(super) betas: Span<usize>,
    pub(super) states: &'k mut StateGrid<E>,
}

/// The evaluation with `N` scored directions, 1 or 3 (see [`super::pose::Load`]); `PLAIN` where there is one set of
/// compliances, and scores cover no errors; `WHOLE` where more than the joints about their axes yields. Each is a
/// function of its own: what one needs costs the others nothing, and without optimisation none needs the stack of all.
struct Variant<'k, E, const PLAIN: bool, const WHOLE: bool, const N: usize>(Evaluation<'k, E>);

impl<E: LaneNumber, const PLAIN: bool, const WHOLE: bool, const N: usize> WithSimd for Variant<'_, E, PLAIN, WHOLE, N> {
    type Number = E;
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd<Number = E>>(self, simd: S) {
        self.0.batches::<S, PLAIN, WHOLE, N>(simd);
    }
}

impl<E: LaneNumber> Evaluation<'_, E> {
    /// Evaluates by the variant that it needs.
    fn by_variant(self, is_plain: bool) {
        let instructions = self.evaluator.instructions;
        let is_single = self.evaluator.problem.criterion.weights.is_single();
        match (self.evaluator.fixed.is_some(), is_single, is_plain) {
            (false, true, true) => instructions.run(Variant::<E, true, false, 1>(self)),
            (false, true, false) => instructions.run(Variant::<E, false, false, 1>(self)),
            (false, false, true) => instructions.run(Variant::<E, true, false, 3>(self)),
            (false, false, false) => instructions.run(Variant::<E, false, false, 3>(self)),
            (true, true, true) => instructions.run(Variant::<E, true, true, 1>(self)),
            (true, true, false) => instructions.run(Variant::<E, false, true, 1>(self)),
            (true, false, true) => instructions.run(Variant::<E, true, true, 3>(self)),
            (true, false, false) => instructions.run(Variant::<E, false, true, 3>(self)),
        }
    }

    /// As [`Variant`].
    #[inline(always)]
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    fn batches<S: Simd<Number = E>, const PLAIN: bool, const WHOLE: bool, const N: usize>(self, simd: S) {
        let Self { evaluator, geometry, classes, sine: sines, cosine: cosines, betas, states } = self;
        let constants = Constants::<E>::new(geometry, &evaluator.limits);
        let infinity = Lanes::splat(simd, f64::INFINITY);
        let is_squared = evaluator.problem.criterion.aggregate == Aggregate::Rms;
        let first = betas.start - betas.start % Lanes::<S>::COUNT;
        for start in (first..betas.end).step_by(Lanes::<S>::COUNT) {
            let cosine = Lanes::load(simd, cosines, start);
            let sine = Lanes::load(simd, sines, start);
            let centre = evaluator.centre(simd, &constants, cosine, sine);
            for back in [false, true] {
                let both = 2 * usize::from(back);
                if !(classes[both] || classes[both + 1]) {
                    continue;
                }
                let arm = evaluator.arm(simd, &constants.limits, &centre, back);
                if !(arm.elbows[0].allowed | arm.elbows[1].allowed).any() {
                    continue;
                }
                let demand = Demand::<S, N>::new::<WHOLE>(simd, &constants, &arm, cosine, sine);
                for (negative, elbow) in arm.elbows.iter().enumerate() {
                    let class = PostureClass::ALL[both + negative];
                    if !classes[class.index()] || !elbow.allowed.any() {
                        continue;
                    }
                    let found = evaluator.wrist::<S, PLAIN, WHOLE, N>(simd, &constants, &demand, &arm, elbow);
                    if let Some((score, directions)) = found {
                        let cost = if is_squared { score * score } else { score };
                        // A point of no weight has forbidden states too.
                        let cost = score.less(infinity).select(cost * geometry.weight, infinity);
                        states.set_lanes(class, start, cost, &directions);
                    }
                }
            }
        }
    }
}
