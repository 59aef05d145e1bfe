//! Points along a removed piece of a line: dense at its ends, where the force over removed volume has an inverse root.

use std::f64::consts::PI;

/// Points and weights for a piece from 0 to 1: Gauss points in theta of `x = (1 - cos theta) / 2`.
#[derive(Debug, Clone)]
pub struct Quadrature {
    /// For each number of points their places and weights.
    tables: Vec<Vec<(f64, f64)>>,
}

/// The fewest and the most points of a piece.
const FEWEST: usize = 4;
const MOST: usize = 96;

impl Default for Quadrature {
    fn default() -> Self {
        Self { tables: (0..=MOST).map(|count| if count < FEWEST { Vec::new() } else { table(count) }).collect() }
    }
}

impl Quadrature {
    /// Places and weights: about so many, within limits.
    pub fn of(&self, points: f64) -> &[(f64, f64)] {
        &self.tables[(points.ceil() as usize).clamp(FEWEST, MOST)]
    }
}

fn table(count: usize) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = gauss(count)
        .into_iter()
        .map(|(x, weight)| {
            let (sine, cosine) = libm::sincos(PI * (1.0 + x) / 2.0);
            ((1.0 - cosine) / 2.0, weight * sine)
        })
        .collect();
    let sum: f64 = points.iter().map(|(_, weight)| weight).sum();
    points.iter_mut().for_each(|(_, weight)| *weight /= sum);
    points
}

/// Gauss-Legendre points and weights from -1 to 1, by Newton's method.
fn gauss(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    let legendre = |x: f64| {
        let (mut before, mut now) = (1.0, x);
        for k in 2..=count {
            let k = k as f64;
            (before, now) = (now, ((2.0 * k - 1.0) * x * now - (k - 1.0) * before) / k);
        }
        (now, n * (x * now - before) / (x * x - 1.0))
    };
    let point = |k: usize| {
        let mut x = libm::cos(PI * (k as f64 + 0.75) / (n + 0.5));
        for _ in 0..20 {
            let (value, slope) = legendre(x);
            x -= value / slope;
        }
        let (_, slope) = legendre(x);
        (-x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(point).collect()
}
