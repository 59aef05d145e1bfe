//! Growth of small motions over one period of milling, by semi-discretisation.

use super::directional::{Directional, exit};
use super::plant::Plant;
use crate::modes::eigenvalues;
use nalgebra::{Complex, DMatrix, Matrix2, Matrix2x3, Matrix3x2, Vector2, Vector3};
use serde::Serialize;
use std::f64::consts::TAU;
use stead_model::cutting::{Cutter, EngagementError, PassCut};

stead_numerics::worded! {
    /// Kind of instability.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
    pub enum Kind {
        /// Stable.
        None = "none",
        /// A motion that changes sign from period to period: each tooth cuts what the one before left (period
        /// doubling).
        Flip = "flip",
        /// A motion of a frequency of its own (Neimark-Sacker).
        Hopf = "hopf",
    }
}

/// The largest Floquet multiplier of a cut.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Verdict {
    /// Factor on small motions in one period.
    pub multiplier: Complex<f64>,
    /// The period: a turn, or that part of it after which the teeth repeat. s
    pub period: f64,
}

impl Verdict {
    /// Whether small motions die out.
    pub fn is_stable(&self) -> bool {
        self.multiplier.norm_sqr() < 1.0
    }

    /// How they grow, if they do.
    pub fn kind(&self) -> Kind {
        if self.is_stable() {
            Kind::None
        } else if self.multiplier.re < 0.0 && self.multiplier.im.abs() < -1e-6 * self.multiplier.re {
            Kind::Flip
        } else {
            Kind::Hopf
        }
    }

    /// `ln |mu| / period`: motions grow as its exponential over time, or die out if it is negative. 1/s
    pub fn growth_rate(&self) -> f64 {
        libm::log(self.multiplier.norm_sqr()) / (2.0 * self.period)
    }
}

/// A cutter in a cut at a spindle speed, with the tool tip of a plant, for any depth of cut.
///
/// The turn is cut into equal intervals. In each, `K_j` is its exact mean, and present and delayed motion of the tip
/// are interpolated linearly, while the plant moves exactly (semi-discretisation with first-order terms, Insperger and
/// Stépán 2004, in the form of Ding et al. 2010 that also interpolates the present motion, so that one matrix
/// exponential does for all intervals and depths). Errors fall with the square of the interval.
#[derive(Debug, Clone, PartialEq)]
pub struct SemiDiscretisation<'a> {
    cutter: &'a Cutter,
    cut: &'a PassCut,
    exit: f64,
    plant: &'a Plant,
    /// E, W_0, W_1.
    step: [DMatrix<f64>; 3],
    /// Delays of the teeth in intervals.
    delays: Vec<f64>,
    intervals: usize,
    /// After so many intervals everything repeats.
    period: usize,
}

/// Intervals between two teeth, at least.
const INTERVALS_PER_TOOTH: usize = 60;
/// Intervals in a period of the fastest mode that swings, at least, as far as [`MAX_INTERVALS`] allows.
const INTERVALS_PER_SWING: f64 = 32.0;
/// Intervals in a turn, at most, unless more are requested.
const MAX_INTERVALS: usize = 1200;

impl<'a> SemiDiscretisation<'a> {
    /// With as many intervals as teeth and modes need.
    ///
    /// # Errors
    /// [`EngagementError`] for a width of cut that is none.
    pub fn new(plant: &'a Plant, cutter: &'a Cutter, cut: &'a PassCut) -> Result<Self, EngagementError> {
        let swings = plant.poles().iter().fold(0.0_f64, |most, pole| most.max(pole.im));
        let for_modes = (INTERVALS_PER_SWING * swings / cut.spindle_speed).min(MAX_INTERVALS as f64) as usize;
        Self::with_intervals(plant, cutter, cut, for_modes.max(INTERVALS_PER_TOOTH * cutter.teeth().len()))
    }

    /// With at least so many intervals in a turn, and some between teeth: the next number with which the teeth repeat
    /// after whole intervals.
    ///
    /// # Errors
    /// [`EngagementError`] for a width of cut that is none.
    pub fn with_intervals(
        plant: &'a Plant,
        cutter: &'a Cutter,
        cut: &'a PassCut,
        intervals: usize,
    ) -> Result<Self, EngagementError> {
        let repeats = cutter.repeats();
        let smallest = cutter.teeth().iter().fold(TAU, |smallest, tooth| tooth.pitch.min(smallest));
        let period = intervals.max((2.0 * TAU / smallest).ceil() as usize).div_ceil(repeats);
        let intervals = period * repeats;
        let turn = TAU / cut.spindle_speed;
        Ok(Self {
            cutter,
            cut,
            exit: exit(cutter, cut)?,
            plant,
            step: plant.step(turn / intervals as f64),
            delays: cutter.teeth().iter().map(|tooth| tooth.pitch / TAU * intervals as f64).collect(),
            intervals,
            period,
        })
    }

    /// The largest multiplier at a depth of cut. m
    pub fn verdict(&self, depth: f64) -> Verdict {
        self.verdict_of(self.directional(depth))
    }

    /// The directional coefficients at a depth of cut (m), interval by interval.
    fn directional(&self, depth: f64) -> Directional {
        Directional::new(self.cutter, self.cut, self.exit, depth, self.intervals)
    }

    /// The largest multiplier with these directional coefficients.
    fn verdict_of(&self, directional: Directional) -> Verdict {
        let map = Map::new(self, directional);
        let period = TAU / self.cut.spindle_speed * self.period as f64 / self.intervals as f64;
        Verdict { multiplier: map.largest_multiplier(), period }
    }

    /// The smallest depth of cut at which small motions do not die out, to a thousandth; `None` if there is none up to
    /// `max_depth`. m
    ///
    /// Depths are examined from a thousandth of `max_depth` up, each a fifth larger than the one before, so a narrow
    /// island of instability may be missed.
    pub fn critical_depth(&self, max_depth: f64) -> Option<f64> {
        self.critical_depth_of(max_depth, |depth| self.verdict(depth))
    }

    /// The same for a verdict on depths of cut that may rest on other coefficients.
    fn critical_depth_of(&self, max_depth: f64, verdict: impl Fn(f64) -> Verdict) -> Option<f64> {
        let [mut low, mut high] = [0.0, max_depth / 1000.0];
        while verdict(high).is_stable() {
            if high >= max_depth {
                return None;
            }
            (low, high) = (high, (1.2 * high).min(max_depth));
        }
        while high - low > 1e-3 * high && high > max_depth * 1e-9 {
            let middle = (low + high) / 2.0;
            if verdict(middle).is_stable() { low = middle } else { high = middle }
        }
        Some(high)
    }
}

#[cfg(test)]
impl SemiDiscretisation<'_> {
    /// The critical depth with the mean of `K_j` over a turn in its place.
    pub(super) fn critical_depth_by_the_mean(&self, max_depth: f64) -> Option<f64> {
        self.critical_depth_of(max_depth, |depth| self.verdict_of(self.directional(depth).mean()))
    }
}

/// What a period does to the states and to the past motions of the tip.
struct Map<'a> {
    method: &'a SemiDiscretisation<'a>,
    directional: Directional,
    /// C E, C W_0 and C W_1.
    seen: [DMatrix<f64>; 3],
    /// For each interval the inverse of `1 - C W_1 sum K_j`.
    implicit: Vec<Matrix2<f64>>,
    kept: usize,
}

impl<'a> Map<'a> {
    fn new(method: &'a SemiDiscretisation<'a>, directional: Directional) -> Self {
        let [e, w0, w1] = &method.step;
        let c = method.plant.c();
        let seen = [e, w0, w1].map(|part| c * part);
        let at_once = Matrix2x3::from_fn(|row, column| seen[2][(row, column)]);
        let implicit = (0..method.period).map(|interval| {
            let sum: Matrix3x2<f64> = directional.at(interval).iter().sum();
            (Matrix2::identity() - at_once * sum).try_inverse().unwrap_or_else(Matrix2::identity)
        });
        let kept = method.delays.iter().fold(0.0_f64, |most, delay| most.max(*delay)).ceil() as usize;
        Self { method, seen, implicit: implicit.collect(), directional, kept }
    }

    /// Length of what is mapped: states, then motions of the tip one, two, ... intervals ago.
    fn size(&self) -> usize {
        self.method.plant.states() + 2 * self.kept
    }

    /// One period. `tip` is room for the motions of the tip over it and before.
    fn apply(&self, vector: &mut [f64], tip: &mut Vec<Vector2<f64>>) {
        let n = self.method.plant.states();
        let [e, w0, w1] = &self.method.step;
        let c = self.method.plant.c();
        let (states, past) = vector.split_at_mut(n);
        let mut x = nalgebra::DVector::from_column_slice(states);
        let mut next = x.clone();
        tip.clear();
        tip.extend(past.chunks_exact(2).rev().map(|motion| Vector2::new(motion[0], motion[1])));
        let now = c * &x;
        tip.push(Vector2::new(now[0], now[1]));
        for interval in 0..self.method.period {
            let matrices = self.directional.at(interval);
            // Position in `tip` of the start of the interval.
            let start = self.kept + interval;
            let (mut before, mut after, mut sum) = (Vector3::zeros(), Vector3::zeros(), Matrix3x2::zeros());
            for (matrix, delay) in matrices.iter().zip(&self.method.delays) {
                if *matrix == Matrix3x2::zeros() {
                    continue;
                }
                let whole = delay.floor();
                let rest = delay - whole;
                let at = start - whole as usize;
                // Motions a delay before the start and the end of the interval.
                let earlier = if rest > 0.0 { tip[at - 1] } else { tip[at] };
                before += matrix * (tip[start] - tip[at] * (1.0 - rest) - earlier * rest);
                after -= matrix * (tip[at + 1] * (1.0 - rest) + tip[at] * rest);
                sum += matrix;
            }
            // The tip at the end: C (E x + W_0 F_0 + W_1 (after + sum u)).
            let mut seen = &self.seen[0] * &x;
            seen.gemv(1.0, &self.seen[1], &before, 1.0);
            seen.gemv(1.0, &self.seen[2], &after, 1.0);
            let end = self.implicit[interval] * Vector2::new(seen[0], seen[1]);
            after += sum * end;
            next.gemv(1.0, e, &x, 0.0);
            next.gemv(1.0, w0, &before, 1.0);
            next.gemv(1.0, w1, &after, 1.0);
            std::mem::swap(&mut x, &mut next);
            tip.push(end);
        }
        states.copy_from_slice(x.as_slice());
        let last = tip.len() - 1;
        for (ago, motion) in past.chunks_exact_mut(2).enumerate() {
            motion.copy_from_slice(tip[last - 1 - ago].as_slice());
        }
    }

    /// The largest eigenvalue of the map, by Arnoldi's method on ever larger subspaces, until two agree or the whole
    /// space is reached.
    fn largest_multiplier(&self) -> Complex<f64> {
        let size = self.size();
        let mut basis: Vec<Vec<f64>> = vec![start(size)];
        let mut columns: Vec<Vec<f64>> = Vec::new();
        let mut room = Vec::with_capacity(self.kept + self.method.period + 1);
        let (mut found, mut wanted) = (None::<Complex<f64>>, FIRST_LOOK.min(size));
        loop {
            let mut vector = basis[columns.len()].clone();
            self.apply(&mut vector, &mut room);
            let mut column = vec![0.0; columns.len() + 1];
            // Twice is enough for vectors that are orthogonal to rounding.
            for _ in 0..2 {
                for (entry, other) in column.iter_mut().zip(&basis) {
                    let part: f64 = vector.iter().zip(other).map(|(a, b)| a * b).sum();
                    vector.iter_mut().zip(other).for_each(|(a, b)| *a -= part * b);
                    *entry += part;
                }
            }
            let norm = vector.iter().map(|a| a * a).sum::<f64>().sqrt();
            if !norm.is_finite() {
                // Beyond what numbers can hold: certainly not stable.
                return Complex::new(f64::INFINITY, 0.0);
            }
            let scale = column.iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
            column.push(norm);
            columns.push(column);
            let goes_on = norm > 1e-14 * scale;
            let exhausted = columns.len() == size || !goes_on;
            if columns.len() == wanted || exhausted {
                let now = largest(&columns);
                let close =
                    |before: Complex<f64>, now: Complex<f64>| (before.norm_sqr() / now.norm_sqr() - 1.0).abs() < AGREE;
                if exhausted || found.zip(now).is_some_and(|(before, now)| close(before, now)) {
                    // What cannot be found at all is beyond what numbers can hold.
                    return now.unwrap_or(Complex::new(f64::INFINITY, 0.0));
                }
                found = now;
                wanted = (wanted + wanted / 2).min(size);
            }
            basis.push(vector.iter().map(|a| a / norm).collect());
        }
    }
}

/// Size of the first subspace.
const FIRST_LOOK: usize = 20;
/// Two subspaces agree when their largest multipliers differ by less, relatively.
const AGREE: f64 = 1e-7;

/// A start that is orthogonal to nothing in particular.
fn start(size: usize) -> Vec<f64> {
    let raw: Vec<f64> = (0..size).map(|k| 1.0 + libm::sin(1.7 * k as f64 + 0.3)).collect();
    let norm = raw.iter().map(|a| a * a).sum::<f64>().sqrt();
    raw.iter().map(|a| a / norm).collect()
}

/// The largest eigenvalue of an upper Hessenberg matrix given by its columns; none where its eigenvalues are not found.
fn largest(columns: &[Vec<f64>]) -> Option<Complex<f64>> {
    let size = columns.len();
    let matrix = DMatrix::from_fn(size, size, |row, column| columns[column].get(row).copied().unwrap_or(0.0));
    let larger =
        |most: Complex<f64>, value: Complex<f64>| if value.norm_sqr() > most.norm_sqr() { value } else { most };
    Some(eigenvalues(matrix)?.into_iter().fold(Complex::new(0.0, 0.0), larger))
}
