//! What enclosures tell of a region of states, for any number of variables.

use super::arm::{Arm, ArmCompliance, LimitSpan, Margins};
use super::enclosure::Enclosure;
use super::interval::Interval;
use super::interval_simd::{Lanes, WIDTH};
use std::f64::consts::{PI, TAU};

/// Functions modelled: m, d1, d2, c_rz, c_tz and c_zz of [`ArmCompliance`].
pub(super) const FUNCTIONS: usize = 6;
/// Remainders of them: of m, of the length of (d1, d2), of that of (c_rz, c_tz), and of c_zz.
pub(super) const REMAINDERS: usize = 4;

/// Sine and cosine of four headings, the last variable, each within that half width.
pub(super) fn heading_over<const V: usize, const P: usize>(
    middle: [f64; WIDTH],
    half: [f64; V],
) -> (Enclosure<V, P>, Enclosure<V, P>) {
    let ends = middle.map(|angle| sine_cosine_over(angle - half[V - 1], angle + half[V - 1]));
    let middle = middle.map(libm::sincos);
    Enclosure::heading(
        [Lanes(middle.map(|m| m.0)), Lanes(middle.map(|m| m.1))],
        [
            Interval::between(Lanes(ends.map(|e| e.0.0)), Lanes(ends.map(|e| e.0.1))),
            Interval::between(Lanes(ends.map(|e| e.1.0)), Lanes(ends.map(|e| e.1.1))),
        ],
        half,
    )
}

/// Whether all states of a region are sure to be allowed.
pub(super) fn is_sure<const V: usize, const P: usize>(
    arm: &Arm,
    y: &ArmCompliance<Enclosure<V, P>>,
    lane: usize,
) -> bool {
    y.conditioned.lane(lane) && sure_to_hold(arm, &y.margins, lane).into_iter().all(|holds| holds)
}

/// Which constraints are sure to hold in all states of a region: the elbow's, the wrist's and the general share of
/// conditioning, and the limits of joints 2, 3 (with those of the sum of both) and 5.
pub(super) fn sure_to_hold<const V: usize, const P: usize>(
    arm: &Arm,
    margins: &Margins<Enclosure<V, P>>,
    lane: usize,
) -> [bool; 6] {
    let holds = |margin: &Enclosure<V, P>| margin.value.low().0[lane] >= 0.0;
    let is_within = |span: LimitSpan, [min, max]: &[Enclosure<V, P>; 2]| match span {
        LimitSpan::Full => true,
        LimitSpan::Wide => holds(min) || holds(max),
        LimitSpan::Narrow => holds(min) && holds(max),
    };
    let within = |joint: usize| is_within(arm.limit_span(joint), &margins.joints[joint]);
    // A sum that is within its limits but for a whole turn is beyond them.
    let of_sum = match (arm.sum_limits(), &margins.sum) {
        (Some(limits), Some(sum)) => limits.is_exact && is_within(LimitSpan::of(limits.limits), sum),
        _ => true,
    };
    let Margins { elbow, wrist, conditioning, joint5, .. } = margins;
    [holds(elbow), holds(wrist), holds(conditioning), within(0), within(1) && of_sum, holds(joint5)]
}

/// What the second derivatives of each pair of variables are multiplied by.
pub(super) fn pair_factors<const V: usize, const P: usize>(half: [f64; V]) -> [f64; P] {
    Enclosure::<V, P>::PAIR.map(|(i, j)| half[i] * half[j] * if i == j { 0.5 } else { 1.0 })
}

/// See [`super::compliance_table::AffineModel::remainder`]: of m, d1, d2, c_rz, c_tz and c_zz; with what is lost by
/// writing values with fewer digits.
pub(super) fn remainders<const V: usize, const P: usize>(
    functions: &[&Enclosure<V, P>; FUNCTIONS],
    lane: usize,
    half: [f64; V],
) -> [f64; REMAINDERS] {
    let second = |f: usize, p: usize| functions[f].second[p].magnitude().0[lane];
    let mut remainder = [0.0; REMAINDERS];
    for (p, factor) in pair_factors::<V, P>(half).into_iter().enumerate() {
        remainder[0] += second(0, p) * factor;
        remainder[1] += libm::hypot(second(1, p), second(2, p)) * factor;
        remainder[2] += libm::hypot(second(3, p), second(4, p)) * factor;
        remainder[3] += second(5, p) * factor;
    }
    let size = |f: usize| {
        let middle = functions[f].middle();
        middle.value.0[lane].abs() + (0..V).map(|k| middle.gradient[k].0[lane].abs() * half[k]).sum::<f64>()
    };
    let lost = [size(0), size(1) + size(2), size(3) + size(4), size(5)];
    std::array::from_fn(|f| remainder[f] + 1e-7 * lost[f])
}

/// Least and largest sine and cosine between two angles less than a turn apart. rad
fn sine_cosine_over(from: f64, to: f64) -> ((f64, f64), (f64, f64)) {
    let (s0, c0) = libm::sincos(from);
    let (s1, c1) = libm::sincos(to);
    // Whether an angle of that kind (plus whole turns) is between.
    let holds = |angle: f64| ((to - angle) / TAU).floor() > ((from - angle) / TAU).floor();
    let range = |a: f64, b: f64, top: f64| {
        let high = if holds(top) { 1.0 } else { a.max(b) };
        let low = if holds(top + PI) { -1.0 } else { a.min(b) };
        (low, high)
    };
    (range(s0, s1, PI / 2.0), range(c0, c1, 0.0))
}
