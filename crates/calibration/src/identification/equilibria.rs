//! The equations of a sheet about the arm as it rests under its loads, which depends on the compliances that are
//! sought: Gauss-Newton on the exact static equilibria.

use super::error::IdentifyError;
use super::model::{Layout, Noise, Observation, ObservationModel};
use super::normal_equations::{FreeParameters, NormalEquations, Solution};
use super::outliers::{OutlierSearch, ROUNDING, RobustEstimate};
use super::problem::Problem;
use super::setup::Setup;
use nalgebra::SVector;
use stead_numerics::monitor::Monitor;

/// What all equations of an identification have in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct Equilibria<'a, const N: usize> {
    /// The problem.
    pub problem: &'a Problem,
    /// The parameters.
    pub layout: &'a Layout,
    /// Which of them are free.
    pub free: &'a FreeParameters<N>,
    /// Values of the others.
    pub held: (&'a SVector<f64, N>, &'a [f64]),
    /// Springs whose compliance is that of the starting arm in every configuration.
    pub hold: [bool; N],
    /// Standard deviations by which the equations are divided.
    pub noise: Noise,
    /// Who may stop it.
    pub monitor: &'a Monitor,
}

/// Equations about the arm that they describe.
#[derive(Debug, Clone)]
pub(super) struct Settled<const N: usize> {
    /// The equations.
    pub observations: Vec<Observation<N>>,
    /// Configurations (from 0) whose equations do not describe the arm at rest: it gives way there with the compliances
    /// found, or the equations did not settle.
    pub not_at_rest: Vec<usize>,
}

/// Gauss-Newton steps: each takes another factor of about deflection over arm length off the error.
const STEPS: usize = 12;
/// Equations that predict every reading as the equilibrium does, within this, describe it. m
const SAME: f64 = 1e-12;

impl<const N: usize> Equilibria<'_, N> {
    /// The equations about the arm with the compliances of a solution, and the configurations in which it would give
    /// way.
    pub fn about(&self, setup: &Setup, solution: &Solution<N>) -> (Vec<Observation<N>>, Vec<usize>) {
        let Problem { robot, sheet, load_point, .. } = self.problem;
        let compliances = |configuration| solution.compliances(self.layout.varying, self.layout.group(configuration));
        ObservationModel { robot, sheet, setup, load_point, noise: self.noise, hold: self.hold }.about(compliances)
    }

    /// From equations about another arm to those about the arm that they describe, by the readings that are kept. Where
    /// these do not determine it, or when `monitor` asked to stop, the equations are left as they are.
    pub fn settled(&self, setup: &Setup, mut observations: Vec<Observation<N>>, kept: &[bool]) -> Settled<N> {
        let weights: Vec<f64> = kept.iter().map(|kept| if *kept { 1.0 } else { 0.0 }).collect();
        let mut not_at_rest = Vec::new();
        for _ in 0..STEPS {
            let normal = NormalEquations::new(&self.problem.sheet, self.layout, &observations, &weights);
            let Some(solution) = normal.solve(self.free, self.held) else {
                return Settled { observations, not_at_rest };
            };
            let (next, given_way) = self.about(setup, &solution);
            let apart = self.apart(&observations, &next, &solution);
            (observations, not_at_rest) = (next, given_way);
            if apart.is_empty() || self.monitor.should_stop() {
                return Settled { observations, not_at_rest };
            }
            not_at_rest.extend(apart);
        }
        not_at_rest.sort_unstable();
        not_at_rest.dedup();
        Settled { observations, not_at_rest }
    }

    /// The configurations in which two sets of equations predict different readings by a solution.
    fn apart(&self, first: &[Observation<N>], second: &[Observation<N>], solution: &Solution<N>) -> Vec<usize> {
        let difference = libm::sqrt(2.0) * self.noise.position;
        let predicted = |observation: &Observation<N>, compliances: &SVector<f64, N>| {
            (observation.design * compliances + observation.known).fixed_rows::<3>(0) * difference
        };
        let is_apart = |configuration: &usize| {
            let compliances = solution.compliances(self.layout.varying, self.layout.group(*configuration));
            let mut readings = self.problem.sheet.configurations[*configuration].readings.clone();
            readings.any(|reading| {
                let [first, second] = [first, second].map(|equations| predicted(&equations[reading], &compliances));
                (first - second).norm() > SAME
            })
        };
        (0..self.problem.sheet.configurations.len()).filter(is_apart).collect()
    }

    /// The estimate without outliers.
    ///
    /// # Errors
    /// [`IdentifyError::Unidentifiable`] where outliers are needed for it.
    pub fn robust_estimate(&self, observations: &[Observation<N>]) -> Result<RobustEstimate<N>, IdentifyError> {
        let Self { problem: Problem { sheet, noise, .. }, layout, free, held, .. } = *self;
        let min_scale = if noise.is_some() { 1.0 } else { ROUNDING };
        let search = OutlierSearch { sheet, layout, observations, free, held, min_scale };
        search.robust_estimate().map_err(|kept| self.unidentifiable_without_outliers(observations, &kept))
    }

    /// What is unidentifiable from the readings that are kept, and which outliers would be needed for it.
    fn unidentifiable_without_outliers(&self, observations: &[Observation<N>], kept: &[bool]) -> IdentifyError {
        let (sheet, layout) = (&self.problem.sheet, self.layout);
        let weights: Vec<f64> = kept.iter().map(|kept| if *kept { 1.0 } else { 0.0 }).collect();
        let unidentifiable = NormalEquations::new(sheet, layout, observations, &weights).unidentifiable(self.free);
        let outliers = sheet.readings.iter().zip(kept).filter(|(_, kept)| !**kept).map(|(reading, _)| reading.line);
        IdentifyError::Unidentifiable { unidentifiable, layout: layout.clone(), outliers: outliers.collect() }
    }
}
