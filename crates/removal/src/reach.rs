//! How far a move reaches: a box about what it sweeps, and the interval of a line that it sweeps.

use crate::moves::Move;
use crate::piece::{Line, Piece};
use nalgebra::Vector3;

/// A box about what is swept, inside the stock, by axis. m
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach(pub [[f64; 2]; 3]);

impl Reach {
    pub fn is_empty(&self) -> bool {
        self.0.iter().any(|[low, high]| low >= high)
    }

    pub fn with(&self, other: &Self) -> Self {
        if self.is_empty() {
            return *other;
        }
        Self([0, 1, 2].map(|k| [self.0[k][0].min(other.0[k][0]), self.0[k][1].max(other.0[k][1])]))
    }
}

/// How far a cutter reaches about its axis, and along it.
pub struct Size {
    radius: f64,
    heights: [f64; 2],
}

impl Size {
    pub fn of(pieces: &[Piece]) -> Self {
        let radius = pieces.iter().map(|piece| piece.radius).fold(0.0, f64::max);
        let low = pieces.iter().map(|piece| piece.heights[0]).fold(f64::INFINITY, f64::min);
        let high = pieces.iter().map(|piece| piece.heights[1]).fold(0.0, f64::max);
        Self { radius, heights: [low, high] }
    }
}

impl Move {
    /// By how much a point of the cutter moves. m
    pub fn displacement(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.by + self.turn.cross(&(point - self.middle))
    }

    /// A box about what it sweeps of a cutter of this size, inside the stock.
    pub fn reach(&self, size: &Size, stock: &[Vector3<f64>; 2]) -> Reach {
        let turned = self.turn.norm() * libm::hypot(size.heights[1], size.radius);
        Reach([0, 1, 2].map(|k| {
            let half = self.by[k].abs() / 2.0;
            let ends = size.heights.map(|height| height * self.axis[k]);
            let wide = size.radius * ((1.0 - self.axis[k] * self.axis[k]).max(0.0).sqrt() + 1e-9) + turned;
            let low = self.middle[k] - half + ends[0].min(ends[1]) - wide;
            let high = self.middle[k] + half + ends[0].max(ends[1]) + wide;
            [low.max(stock[0][k]), high.min(stock[1][k])]
        }))
    }

    /// The interval of a line `o + l d` that the pieces sweep, where there is one.
    pub fn extent(&self, pieces: &[Piece], o: &Vector3<f64>, d: &Vector3<f64>) -> Option<[f64; 2]> {
        let by = |u: &Vector3<f64>| {
            let w = o - self.middle + u / 2.0;
            let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
            // From above: what shank and side reach, a corner need not be asked for.
            let line = Line { axis: &self.axis, w: &w, d, u };
            pieces.iter().rev().for_each(|piece| piece.sweep(&line, &mut ends));
            (ends[0] < ends[1]).then_some(ends)
        };
        let ends = by(&self.by)?;
        if self.turn == Vector3::zeros() {
            return Some(ends);
        }
        // Each end with the displacement of its own.
        let [low, high] = ends.map(|end| by(&self.displacement(&(o + d * end))));
        let ends = [low?[0], high?[1]];
        (ends[0] < ends[1]).then_some(ends)
    }
}
