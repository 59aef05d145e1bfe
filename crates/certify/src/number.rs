//! What the closed form needs of a number.
//!
//! One formula ([`super::arm`]) serves the plain one, [`super::enclosure::Slope`], a value with its gradient, in lanes;
//! and [`super::enclosure::Enclosure`]: intervals for value, gradient and second derivatives over a whole region.

use super::continuation::{Bend, Links};
use super::interval_simd::{Lanes, Mask};
use std::ops::{Add, Mul, Neg, Sub};

/// Independent variables: radius and height of the tool centre point, heading of the spindle against its azimuth.
pub(super) const VARIABLES: usize = 3;
/// Pairs of variables, in the order of [`pairs`]: rr, zz, ee, rz, re, ze.
pub(super) const PAIRS: usize = 6;
/// Independent variables of a tool that leans: the place of the tool centre point in the frame of the workpiece about
/// axis 1, and the turn of the spindle about its axis.
pub(super) const LEANING: usize = 4;
/// Pairs of these.
pub(super) const LEANING_PAIRS: usize = 10;

/// The two variables of each pair, the diagonal first.
pub(super) const fn pairs<const V: usize, const P: usize>() -> [(usize, usize); P] {
    let mut out = [(0, 0); P];
    let (mut i, mut next) = (0, V);
    while i < V {
        out[i] = (i, i);
        let mut j = i + 1;
        while j < V {
            out[next] = (i, j);
            (next, j) = (next + 1, j + 1);
        }
        i += 1;
    }
    out
}

/// What the closed form needs of a number.
pub(super) trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// The same plain number in every lane.
    fn constant(value: f64) -> Self;
    /// Times a plain number.
    fn scale(self, factor: f64) -> Self;
    /// Plus a plain number.
    fn plus(self, term: f64) -> Self;
    /// Square.
    fn square(self) -> Self;
    /// Square root of what is above zero.
    fn sqrt(self) -> Self;
    /// One over the square root of what is above zero.
    fn inverse_sqrt(self) -> Self;
    /// One over what is above zero, or below.
    fn reciprocal(self) -> Self;
    /// The angle of which it is the tangent, less than a quarter of a turn.
    fn arctangent(self) -> Self;
    /// Of the squared distance q of the wrist centre from the shoulder, above zero: the sine of the elbow angle, and
    /// the elbow's components along and across the line between them, alpha and beta of `elbow = alpha S + beta S'`.
    /// Each is a function of q alone.
    fn elbow(self, links: &Links) -> [Self; 3];
    /// Of the cosine of the angle between axes 4 and 6: one over its squared sine.
    fn wrist(self, bend: &Bend) -> Self;
    /// Where it is sure to be below zero.
    fn is_negative(self) -> Mask;
    /// What it is at least.
    fn low(self) -> Lanes;
    /// What it is at most.
    fn high(self) -> Lanes;
    /// The same, where it is sure to be above `floor`; elsewhere the lane leaves `sure`, and anything may come out.
    fn assume_above(self, floor: f64, sure: &mut Mask) -> Self;
}

/// Zero in every lane.
pub(super) const ZERO: Lanes = Lanes([0.0; super::interval_simd::WIDTH]);
