//! Robust estimation: readings that deviate from the others by more than noise.
//!
//! A first estimate that outliers hardly move (Huber's weights, then Tukey's bisquare, both by iterated least squares
//! with the median of the residuals as scale) tells which readings to leave out at first. Then the ordinary estimate
//! from the others judges every reading by its studentised residual, as often as that changes something: one that was
//! left out comes back if it agrees. A reading is an outlier where so large a residual would turn up by chance in one
//! sheet of a hundred.

use super::distribution::tail;
use super::model::{Layout, Observation};
use super::normal_equations::{FreeParameters, NormalEquations, Solution};
use super::sheet::Sheet;
use nalgebra::{Matrix6, SVector, Vector6};

/// The estimate without outliers, and the residual of each reading.
#[derive(Debug, Clone, PartialEq)]
pub struct RobustEstimate<const N: usize> {
    /// The estimate.
    pub solution: Solution<N>,
    /// The equations it solves.
    pub normal: NormalEquations<N>,
    /// Mean square of the residuals over the degrees of freedom, 1 where the noise is as stated.
    pub variance: f64,
    /// Equations less parameters.
    pub degrees: usize,
    /// Which readings are no outliers.
    pub kept: Vec<bool>,
    /// Root of the mean square of the studentised residual of each reading: about 1.
    pub studentised: Vec<f64>,
    /// Whether there are enough equations to look for outliers.
    pub is_searched: bool,
}

/// Inputs of the robust estimate.
pub struct OutlierSearch<'a, const N: usize> {
    /// The readings.
    pub sheet: &'a Sheet,
    /// The parameters.
    pub layout: &'a Layout,
    /// The equations.
    pub observations: &'a [Observation<N>],
    /// Which parameters are free.
    pub free: &'a FreeParameters<N>,
    /// Values of the others.
    pub held: (&'a SVector<f64, N>, &'a [f64]),
    /// Lower limit of the scale of the residuals: the known noise, or the resolution of any tracker.
    pub min_scale: f64,
}

/// Residuals below this are rounding, whatever the tracker. m
pub(super) const ROUNDING: f64 = 1e-10;
/// One false outlier in so many sheets of ordinary noise.
const SHEETS: f64 = 100.0;
/// Rounds of reweighting, and of testing for outliers.
const ROUNDS: usize = 30;
/// No weight is less in the robust start, so that no parameter is left without readings.
const MIN_WEIGHT: f64 = 1e-6;

impl<const N: usize> OutlierSearch<'_, N> {
    fn solve(&self, weights: &[f64]) -> Option<(NormalEquations<N>, Solution<N>)> {
        let normal = NormalEquations::new(self.sheet, self.layout, self.observations, weights);
        let solution = normal.solve(self.free, self.held)?;
        Some((normal, solution))
    }

    fn group(&self, reading: usize) -> Option<usize> {
        self.layout.group(self.sheet.readings[reading].configuration)
    }

    fn residual(&self, solution: &Solution<N>, reading: usize) -> Vector6<f64> {
        let observation = &self.observations[reading];
        let compliances = solution.compliances(self.layout.varying, self.group(reading));
        observation.deflection - observation.design * compliances
    }

    /// The estimate without outliers.
    ///
    /// # Errors
    /// The readings that were kept when not all parameters were identifiable from them any more.
    pub fn robust_estimate(&self) -> Result<RobustEstimate<N>, Vec<bool>> {
        let readings = self.sheet.readings.len();
        let equations = readings * self.sheet.rows_per_reading();
        let mut kept = vec![true; readings];
        let is_searched = equations >= 2 * self.free.count() + 2 * self.sheet.rows_per_reading();
        if is_searched {
            kept = self.robust_start(equations).ok_or_else(|| kept.clone())?;
        }
        for _ in 0..ROUNDS {
            let (robust, keep) = self.estimate_without(&kept, is_searched).ok_or_else(|| kept.clone())?;
            if !is_searched || keep == kept {
                return Ok(robust);
            }
            kept = keep;
        }
        self.estimate_without(&kept, is_searched).map(|(robust, _)| robust).ok_or(kept)
    }

    fn robust_start(&self, equations: usize) -> Option<Vec<bool>> {
        // 95 % and median of the length of a vector of standard normal numbers.
        let (reach, median) = if self.sheet.is_full_pose() { (3.548, 2.313) } else { (2.795, 1.538) };
        let correction = libm::sqrt(equations as f64 / (equations - self.free.count()) as f64);
        let mut weights = vec![1.0; self.observations.len()];
        let mut kept = vec![true; weights.len()];
        for round in 0..2 * ROUNDS {
            let (_, solution) = self.solve(&weights)?;
            let lengths: Vec<f64> = (0..weights.len()).map(|k| self.residual(&solution, k).norm()).collect();
            let mut sorted = lengths.clone();
            sorted.sort_by(f64::total_cmp);
            let scale = (sorted[sorted.len() / 2] / median * correction).max(self.min_scale);
            let mut change = 0.0_f64;
            for (index, length) in lengths.iter().enumerate() {
                let far = length / (reach * scale);
                let weight = if round < ROUNDS { huber(far) } else { bisquare(far / 2.0) }.max(MIN_WEIGHT);
                change = change.max((weight - weights[index]).abs());
                weights[index] = weight;
                kept[index] = far < 2.0;
            }
            if round >= ROUNDS && change < 1e-3 {
                break;
            }
        }
        self.restore(&mut kept);
        Some(kept)
    }

    /// Takes readings back where a parameter would be left without any.
    fn restore(&self, kept: &mut [bool]) {
        let mut left = vec![0_usize; self.layout.angles.len()];
        for index in (0..kept.len()).filter(|index| kept[*index]) {
            if let Some(group) = self.group(index) {
                left[group] += 1;
            }
        }
        for (index, kept) in kept.iter_mut().enumerate() {
            *kept |= self.group(index).is_some_and(|group| left[group] == 0);
        }
    }

    /// The estimate from the readings that are kept, and which readings it keeps.
    fn estimate_without(&self, kept: &[bool], is_searched: bool) -> Option<(RobustEstimate<N>, Vec<bool>)> {
        let weights: Vec<f64> = kept.iter().map(|kept| if *kept { 1.0 } else { 0.0 }).collect();
        let (normal, solution) = self.solve(&weights)?;
        let rows = self.sheet.rows_per_reading();
        let count = kept.iter().filter(|kept| **kept).count();
        let degrees = (count * rows).saturating_sub(self.free.count());
        let residuals: Vec<Vector6<f64>> = (0..kept.len()).map(|index| self.residual(&solution, index)).collect();
        let squares: f64 = residuals.iter().zip(kept).filter(|(_, kept)| **kept).map(|(r, _)| r.norm_squared()).sum();
        let variance = if degrees > 0 { squares / degrees as f64 } else { 0.0 };
        let floor = self.min_scale * self.min_scale;
        let limit = 1.0 / (SHEETS * kept.len() as f64);
        let mut studentised = Vec::with_capacity(kept.len());
        let mut keep = Vec::with_capacity(kept.len());
        for (index, residual) in residuals.iter().enumerate() {
            let design = &self.observations[index].design;
            let covariance = solution.covariance(self.layout.varying, self.group(index));
            let leverage = design * covariance * design.transpose();
            let own = if kept[index] { Matrix6::identity() - leverage } else { Matrix6::identity() + leverage };
            let square = own.cholesky().map_or(0.0, |own| residual.dot(&own.solve(residual)));
            // The variance without this reading, so that it does not hide itself.
            let below = degrees.saturating_sub(if kept[index] { rows } else { 0 });
            let others = if kept[index] { (squares - square).max(0.0) } else { squares };
            let spread = (others / below.max(1) as f64).max(floor);
            let ratio = if spread > 0.0 { square / rows as f64 / spread } else { 0.0 };
            studentised.push(libm::sqrt(ratio));
            keep.push(!is_searched || below == 0 || tail(ratio, rows, below) > limit);
        }
        self.restore(&mut keep);
        let robust =
            RobustEstimate { solution, normal, variance, degrees, kept: kept.to_vec(), studentised, is_searched };
        Some((robust, keep))
    }
}

fn huber(far: f64) -> f64 {
    if far > 1.0 { 1.0 / far } else { 1.0 }
}

fn bisquare(far: f64) -> f64 {
    let rest = (1.0 - far * far).max(0.0);
    rest * rest
}
