//! What is known of states of a tool that leans: regions of the place of the tool centre point and of the turn of the
//! spindle about its axis.

use super::super::arm::{Arm, ArmCompliance};
use super::super::compliance_table::{FUNCTIONS, REMAINDERS, heading_over, remainders};
use super::super::enclosure::Enclosure;
use super::super::interval_simd::{Lanes, WIDTH};
use super::super::kind::Kind;
use super::super::load::{Tangent, Yielding};
use super::super::minorant::{Affine, ZERO, rounded};
use super::super::number::{LEANING, LEANING_PAIRS};
use stead_model::robot::PostureClass;

type Enclosed = Enclosure<LEANING, LEANING_PAIRS>;

/// What is known of the states of a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Known {
    /// None of them is allowed.
    Empty,
    /// Nothing is known of them.
    Unknown,
    /// How they yield.
    Yields(States),
}

/// An affine model of how the states of a region yield, joint 1 included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct States {
    /// Of m, d1, d2, c_xz, c_yz and c_zz in the middle: value, and gradient by x, y, z and turn.
    pub values: [(f64, [f64; LEANING]); FUNCTIONS],
    /// What these leave out, as in [`super::super::compliance_table::AffineModel`].
    pub remainder: [f64; REMAINDERS],
}

/// What is known of four regions (x, y, z, turn) of those half widths; `first` is the compliance of joint 1
/// (rad/(N m)).
pub(super) fn known_over(
    (arm, first): (&Arm, f64),
    place: &[[f64; LEANING]; WIDTH],
    half: [f64; LEANING],
    class: PostureClass,
) -> [Known; WIDTH] {
    let (sine, cosine) = heading_over(place.map(|p| p[3]), half);
    let at = |k: usize| Enclosed::variable(Lanes(place.map(|p| p[k])), k, half);
    match arm.evaluate_leaning([at(0), at(1), at(2)], sine, cosine, first, class) {
        None => [Known::Empty; WIDTH],
        Some(y) => std::array::from_fn(|lane| judged(&y, lane, half)),
    }
}

fn judged(y: &ArmCompliance<Enclosed>, lane: usize, half: [f64; LEANING]) -> Known {
    if y.violated.lane(lane) {
        return Known::Empty;
    }
    if !y.regular.lane(lane) {
        return Known::Unknown;
    }
    let functions = [&y.m, &y.d1, &y.d2, &y.vertical[0], &y.vertical[1], &y.axial];
    let remainder = remainders(&functions, lane, half);
    if !remainder.iter().all(|r| *r < 1e30) {
        return Known::Unknown;
    }
    let values = functions.map(|f| {
        let middle = f.middle();
        (middle.value.0[lane], middle.gradient.map(|g| g.0[lane]))
    });
    Known::Yields(States { values, remainder })
}

impl States {
    /// An affine function of the place below the score under the loads of a kind, for all the region.
    pub fn below(&self, kind: &Kind, half: [f64; LEANING]) -> Affine {
        let [m, d1, d2, v1, v2, zz] = self.values.map(|v| v.0);
        let at = Yielding { m, d: [d1, d2], v: [v1, v2], zz };
        let (sharp, of_error) = kind.load.tangents(&kind.load.with_part(at), [0.0; 3]);
        let place = [half[0], half[1], half[2]];
        let size = |(value, slope): &(f64, [f64; 3])| value - (0..3).map(|k| slope[k].abs() * place[k]).sum::<f64>();
        let found = self.least(kind, &sharp, half[3]);
        let (value, slope) = match of_error.map(|tangent| self.least(kind, &tangent, half[3])) {
            Some(other) if size(&other) > size(&found) => other,
            _ => found,
        };
        let value = value - self.spread(kind, half);
        if value <= 0.0 { ZERO } else { rounded(value, slope, place) }
    }

    /// What a tangent says: its value in the middle, less all but its slopes by the place.
    fn least(&self, kind: &Kind, tangent: &Tangent, half_turn: f64) -> (f64, [f64; 3]) {
        let Tangent { plane, turning: [q, w], vertical: [g, h], axial, .. } = *tangent;
        let factors = [plane, q, w, g, h, axial];
        let mut value = kind.load.of_part(tangent);
        let mut slopes = [0.0; LEANING];
        for (factor, (of, gradient)) in factors.into_iter().zip(&self.values) {
            value += factor * of;
            (0..LEANING).for_each(|k| slopes[k] += factor * gradient[k]);
        }
        let lengths = [plane.abs(), libm::hypot(q, w), libm::hypot(g, h), axial.abs()];
        let remainder: f64 = lengths.into_iter().zip(self.remainder).map(|(length, rest)| length * rest).sum();
        let [x, y, z, by_turn] = slopes;
        (value - remainder - by_turn.abs() * half_turn, [x, y, z])
    }

    /// By how much the scores of the loads of a kind can differ from that of its own: no eigenvalue of the compliance
    /// is above its trace. m
    fn spread(&self, kind: &Kind, half: [f64; LEANING]) -> f64 {
        if kind.force_spread == 0.0 && kind.part_spread == 0.0 {
            return 0.0;
        }
        let up = |f: usize, remainder: usize| {
            let (value, gradient) = self.values[f];
            value.abs() + (0..LEANING).map(|k| gradient[k].abs() * half[k]).sum::<f64>() + self.remainder[remainder]
        };
        let part = kind.load.part.map_or(0.0, |part| part.size());
        let scored = kind.load.directions.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
        let by_part = kind.part_spread * (1.0 + kind.load.error);
        scored * ((2.0 * up(0, 0) + up(5, 3) + part) * kind.force_spread + by_part)
    }
}
