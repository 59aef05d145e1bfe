//! What is known of states of a tool that leans: regions of the place of the tool centre point and of the turn of the
//! spindle about its axis.

use super::super::arm::{Arm, ArmCompliance};
use super::super::compliance_table::{FUNCTIONS, REMAINDERS};
use super::super::enclosure::Enclosure;
use super::super::interval_simd::{Lanes, WIDTH};
use super::super::kind::Kind;
use super::super::load::{Tangent, Yielding};
use super::super::minorant::{Affine, ZERO, rounded};
use super::super::number::{LEANING, LEANING_PAIRS};
use super::super::over_regions::{heading_over, is_sure, remainders};
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

/// How the states of a region yield, joint 1 included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct States {
    pub compliance: Modelled,
    /// Of the matrix below the compliance: see [`ArmCompliance::below`].
    pub below: Modelled,
    /// Whether all the states are sure to be allowed.
    pub sure: bool,
}

/// An affine model of a symmetric matrix over a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Modelled {
    /// Of m, d1, d2, c_xz, c_yz and c_zz in the middle: value, and gradient by x, y, z and turn.
    pub values: [(f64, [f64; LEANING]); FUNCTIONS],
    /// What these leave out, as in [`super::super::compliance_table::AffineModel`].
    pub remainder: [f64; REMAINDERS],
    /// How much each variable makes of that. m/N
    pub bends: [f64; LEANING],
}

/// What is known of a score over a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Below {
    /// Below it everywhere.
    pub affine: Affine,
    /// What share of the score that leaves out; one where it is zero.
    pub share: f32,
    /// How much each variable makes of that. m
    pub bends: [f64; LEANING],
}

impl Below {
    pub const NOTHING: Self = Self { affine: ZERO, share: 1.0, bends: [0.0; LEANING] };
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
        Some(y) => std::array::from_fn(|lane| judged(arm, &y, lane, half)),
    }
}

fn judged(arm: &Arm, y: &ArmCompliance<Enclosed>, lane: usize, half: [f64; LEANING]) -> Known {
    if y.violated.lane(lane) {
        return Known::Empty;
    }
    if !y.regular.lane(lane) {
        return Known::Unknown;
    }
    let of = |functions: &[&Enclosed; FUNCTIONS]| Modelled::of(functions, lane, half);
    let compliance = of(&[&y.m, &y.d1, &y.d2, &y.vertical[0], &y.vertical[1], &y.axial]);
    let below = y.below.as_ref().map(|below| of(&below.each_ref()));
    match (compliance, below.unwrap_or(compliance)) {
        (Some(compliance), Some(below)) => Known::Yields(States { compliance, below, sure: is_sure(arm, y, lane) }),
        _ => Known::Unknown,
    }
}

/// What a tangent says: its value in the middle less all but its slopes by the place, these, and of what was taken
/// away the parts of the remainder and of the turn.
type Least = (f64, [f64; 3], f64, f64);

impl Modelled {
    fn of(functions: &[&Enclosed; FUNCTIONS], lane: usize, half: [f64; LEANING]) -> Option<Self> {
        let remainder = remainders(functions, lane, half);
        if !remainder.iter().all(|r| *r < 1e30) {
            return None;
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
        Some(Self { values, remainder, bends })
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

    /// How large the matrix can be: the root of the sum of the squares of its entries. m/N
    fn size(&self, half: [f64; LEANING]) -> f64 {
        let up = |f: usize| {
            let (value, gradient) = self.values[f];
            value.abs() + (0..LEANING).map(|k| gradient[k].abs() * half[k]).sum::<f64>()
        };
        let [m, d, v, zz] = [up(0), libm::hypot(up(1), up(2)), libm::hypot(up(3), up(4)), up(5)];
        let [m, d, v, zz] = std::array::from_fn(|k| [m, d, v, zz][k] + self.remainder[k]);
        libm::sqrt(2.0 * (m * m + d * d + v * v) + zz * zz)
    }
}

impl States {
    /// What is known of the score under the loads of a kind, for all the region.
    pub fn below(&self, kind: &Kind, half: [f64; LEANING]) -> Below {
        let [m, d1, d2, v1, v2, zz] = self.compliance.values.map(|v| v.0);
        let at = Yielding { m, d: [d1, d2], v: [v1, v2], zz };
        let (sharp, of_error) = kind.load.tangents(&kind.load.with_part(at), [0.0; 3]);
        let place = [half[0], half[1], half[2]];
        let found = |model: &Modelled, tangent: &Tangent, times: f64| {
            let (value, slope, remainder, turning) = model.least(kind, tangent, half[TURN]);
            let spread = times * spread(kind, || model.size(half));
            let value = value - spread;
            let low = value - (0..3).map(|k| slope[k].abs() * place[k]).sum::<f64>();
            let mut bends = model.bends;
            bends[TURN] += turning;
            if value <= 0.0 {
                return (low, Below { bends, ..Below::NOTHING });
            }
            let lost = remainder + turning + spread;
            (low, Below { affine: rounded(value, slope, place), share: (lost / (value + lost)) as f32, bends })
        };
        let mut best = found(&self.compliance, &sharp, 1.0);
        let others = [
            of_error.map(|tangent| found(&self.compliance, &tangent, 1.0)),
            kind.along_force().map(|(tangent, times)| found(&self.below, &tangent, times)),
        ];
        for other in others.into_iter().flatten() {
            if other.0 > best.0 {
                best = other;
            }
        }
        best.1
    }
}

/// By how much the scores of the loads of a kind can differ from that of its own, with a matrix of that size. m
fn spread(kind: &Kind, size: impl Fn() -> f64) -> f64 {
    if kind.force_spread == 0.0 && kind.part_spread == 0.0 {
        return 0.0;
    }
    let part = kind.load.part.map_or(0.0, |part| part.size());
    let by_part = kind.part_spread * (1.0 + kind.load.error);
    kind.load.most_scored() * ((size() + part) * kind.force_spread + by_part)
}
