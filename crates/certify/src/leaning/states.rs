//! What is known of states of a tool that leans: regions of the place of the tool centre point and of the turn of the
//! spindle about its axis.

use super::super::arm::{Arm, ArmCompliance};
use super::super::enclosure::{Enclosure, FUNCTIONS, REMAINDERS, bends, digits};
use super::super::interval_simd::{Lanes, WIDTH};
use super::super::keeps_open::KeepsOpen;
use super::super::kind::Kind;
use super::super::load::{Tangent, Yielding};
use super::super::minorant::{Affine, ZERO, rounded};
use super::super::number::{LEANING, LEANING_PAIRS};
use stead_model::robot::PostureClass;

/// The number of the turn among the variables.
pub(super) const TURN: usize = 3;

type Enclosed = Enclosure<LEANING, LEANING_PAIRS>;

/// What is known of the states of a region.
#[expect(clippy::large_enum_variant, reason = "four at a time, on the stack")]
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
    /// How much each variable makes of that. m/N
    pub bends: [f64; LEANING],
    /// Whether all the states are sure to be allowed.
    pub sure: bool,
}

/// What is known of a score over a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Below {
    /// Below it everywhere.
    pub affine: Affine,
    /// What share of the score that leaves out; one where it is zero.
    pub share: f32,
    /// What it leaves out for the turn, which is free. m
    pub turning: f64,
}

impl Below {
    pub const NOTHING: Self = Self { affine: ZERO, share: 1.0, turning: 0.0 };
}

/// What is known of four regions (x, y, z, turn) of those half widths.
pub(super) fn known_over(
    arm: &Arm,
    place: &[[f64; LEANING]; WIDTH],
    half: [f64; LEANING],
    class: PostureClass,
) -> [Known; WIDTH] {
    match enclosed(arm, place, half, class) {
        None => [Known::Empty; WIDTH],
        Some(y) => std::array::from_fn(|lane| judged(arm, &y, lane, half)),
    }
}

fn enclosed(
    arm: &Arm,
    place: &[[f64; LEANING]; WIDTH],
    half: [f64; LEANING],
    class: PostureClass,
) -> Option<ArmCompliance<Enclosed>> {
    let (sine, cosine) = Enclosed::heading(place.map(|p| p[3]), half);
    let at = |k: usize| Enclosed::variable(Lanes(place.map(|p| p[k])), k, half);
    arm.evaluate_leaning([at(0), at(1), at(2)], sine, cosine, class)
}

fn judged(arm: &Arm, y: &ArmCompliance<Enclosed>, lane: usize, half: [f64; LEANING]) -> Known {
    if y.violated.lane(lane) {
        return Known::Empty;
    }
    if !y.regular.lane(lane) {
        return Known::Unknown;
    }
    let functions = [&y.m, &y.d1, &y.d2, &y.vertical[0], &y.vertical[1], &y.axial];
    let mut remainder = digits(&functions, lane, half);
    for (bends, factor) in bends(&functions, lane).into_iter().zip(Enclosed::pair_factors(half)) {
        (0..REMAINDERS).for_each(|f| remainder[f] += factor * bends[f]);
    }
    if !remainder.iter().all(|r| *r < 1e30) {
        return Known::Unknown;
    }
    let values = functions.map(|f| {
        let middle = f.middle();
        (middle.value.0[lane], middle.gradient.map(|g| g.0[lane]))
    });
    let mut bends = [0.0; LEANING];
    for (p, (i, j)) in Enclosed::PAIR.into_iter().enumerate() {
        let second: f64 = functions.iter().map(|f| f.second[p].magnitude().0[lane]).sum();
        let bend = second * half[i] * half[j];
        (bends[i], bends[j]) = (bends[i] + bend, bends[j] + bend);
    }
    let sure = arm.is_sure(y, lane);
    Known::Yields(States { values, remainder, bends, sure })
}

/// Counts what is known of the states of a region.
pub(super) fn count(
    counted: &mut KeepsOpen,
    arm: &Arm,
    place: [f64; LEANING],
    half: [f64; LEANING],
    class: PostureClass,
) {
    let Some(y) = enclosed(arm, &[place; WIDTH], half, class) else { return };
    match judged(arm, &y, 0, half) {
        Known::Empty => {}
        Known::Unknown => counted.add(None),
        Known::Yields(States { sure: true, .. }) => counted.states += 1,
        Known::Yields(_) => counted.add(Some(arm.sure_to_hold(&y.margins, 0))),
    }
}

/// What a tangent says: its value in the middle less all but its slopes by the place, these, and of what was taken
/// away the parts of the remainder and of the turn.
type Least = (f64, [f64; 3], f64, f64);

impl States {
    /// What is known of the score under the loads of a kind, for all the region.
    pub fn below(&self, kind: &Kind, half: [f64; LEANING]) -> Below {
        let [m, d1, d2, v1, v2, zz] = self.values.map(|v| v.0);
        let at = Yielding { m, d: [d1, d2], v: [v1, v2], zz };
        let (sharp, of_error) = kind.load.tangents(&kind.load.with_part(at), [0.0; 3]);
        let place = [half[0], half[1], half[2]];
        let found = self.least(kind, &sharp, half[TURN]);
        let low = |(value, slope, ..): &Least| value - (0..3).map(|k| slope[k].abs() * place[k]).sum::<f64>();
        let (value, slope, remainder, turning) = match of_error.map(|tangent| self.least(kind, &tangent, half[TURN])) {
            Some(other) if low(&other) > low(&found) => other,
            _ => found,
        };
        let lost = remainder + turning + self.spread(kind, half);
        let value = value - self.spread(kind, half);
        if value <= 0.0 {
            return Below { turning, ..Below::NOTHING };
        }
        Below { affine: rounded(value, slope, place), share: (lost / (value + lost)) as f32, turning }
    }

    /// What a tangent says.
    fn least(&self, kind: &Kind, tangent: &Tangent, half_turn: f64) -> Least {
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
        let turning = by_turn.abs() * half_turn;
        (value - remainder - turning, [x, y, z], remainder, turning)
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
        let by_part = kind.part_spread * (1.0 + kind.load.error);
        kind.load.most_scored() * ((2.0 * up(0, 0) + up(5, 3) + part) * kind.force_spread + by_part)
    }
}
