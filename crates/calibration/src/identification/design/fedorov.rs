//! The set with the smallest `trace(Q M^-1)`: a greedy and several random starts, each improved by exchanging one
//! configuration at a time for the best that is not in the set (Fedorov's exchange, in the order of Cook and Nachtsheim
//! 1980), until no exchange improves it.
//!
//! With eight parameters a new value of the criterion costs as much as an update of the last one, and with twenty it is
//! dear but exact: no updates are used.

use super::candidates::{Purpose, stream};
use super::parameters::{InformationMatrix, MAX_PARAMETERS};
use nalgebra::{DMatrix, SymmetricEigen};
use rand::RngExt;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use stead_numerics::monitor::{Monitor, Progress};

/// A matrix over the free parameters only, each in a unit in which the sum over a set of mean configurations has a unit
/// diagonal.
type Packed<const P: usize> = [[f64; P]; P];

/// The criterion `trace(Q M^-1)` of an I-optimal design, prepared for many M.
#[derive(Debug, Clone, PartialEq)]
pub struct IOptimality<const P: usize = MAX_PARAMETERS> {
    /// The free parameters.
    free: Vec<usize>,
    /// Their units.
    unit: [f64; P],
    /// Columns of a factor of Q.
    factor: Packed<P>,
}

/// A set of candidates and its value of the criterion.
#[derive(Debug, Clone, PartialEq)]
pub struct ExactDesign {
    /// Places among the candidates, ascending.
    pub set: Vec<usize>,
    /// `trace(Q M^-1)`. m^2
    pub value: f64,
}

/// A pivot of less than this part of its diagonal element means that a parameter is unidentifiable, as in the fit.
const SINGULAR: f64 = 1e-14;
/// A value is smaller than another only below this part of it.
const BETTER: f64 = 1.0 - 1e-10;
/// More rounds of exchanges than this have never been needed.
const ROUNDS: usize = 200;
/// Weight of the mean candidate that a greedy start begins with, so that its first steps differ in value.
const PRIOR: f64 = 1e-3;

impl<const P: usize> IOptimality<P> {
    /// For Q, the free parameters, and sets of so many of these candidates.
    pub fn new(
        weighting: &InformationMatrix<P>,
        free: &[bool; P],
        informations: &[InformationMatrix<P>],
        size: usize,
    ) -> Self {
        let sum = informations.iter().fold(InformationMatrix::zeros(), |sum, information| sum + information);
        let share = size as f64 / informations.len().max(1) as f64;
        let unit = std::array::from_fn(|k| {
            let diagonal = sum[(k, k)] * share;
            if diagonal > 0.0 { 1.0 / libm::sqrt(diagonal) } else { 1.0 }
        });
        let free: Vec<usize> = (0..P).filter(|k| free[*k]).collect();
        let mut criterion = Self { free, unit, factor: [[0.0; P]; P] };
        // trace(Q M^-1) is trace(D Q D (D M D)^-1) with the units D: Q is packed as M is.
        let packed = criterion.packed(weighting);
        let size = criterion.free.len();
        let eigen = SymmetricEigen::new(DMatrix::from_fn(P, P, |i, j| packed[i][j]));
        for column in 0..P {
            let root = libm::sqrt(eigen.eigenvalues[column].max(0.0));
            for row in 0..size {
                criterion.factor[row][column] = eigen.eigenvectors[(row, column)] * root;
            }
        }
        criterion
    }

    fn packed(&self, information: &InformationMatrix<P>) -> Packed<P> {
        let mut packed = [[0.0; P]; P];
        for (i, a) in self.free.iter().enumerate() {
            for (j, b) in self.free.iter().enumerate() {
                packed[i][j] = information[(*a, *b)] * self.unit[*a] * self.unit[*b];
            }
        }
        packed
    }

    /// `trace(Q M^-1)`, infinite where not every free parameter is identifiable from M.
    pub fn value(&self, information: &InformationMatrix<P>) -> f64 {
        self.packed_value(&self.packed(information))
    }

    fn packed_value(&self, matrix: &Packed<P>) -> f64 {
        let size = self.free.len();
        let mut lower = [[0.0; P]; P];
        for i in 0..size {
            for j in 0..=i {
                let mut rest = matrix[i][j];
                for k in 0..j {
                    rest -= lower[i][k] * lower[j][k];
                }
                if i > j {
                    lower[i][j] = rest * lower[j][j];
                } else if rest > SINGULAR * matrix[i][i] {
                    // The inverse of the diagonal, which is all that is needed of it.
                    lower[i][i] = 1.0 / libm::sqrt(rest);
                } else {
                    return f64::INFINITY;
                }
            }
        }
        let mut trace = 0.0;
        let mut solved = self.factor;
        for i in 0..size {
            let (done, rest) = solved.split_at_mut(i);
            let row = &mut rest[0];
            for (k, known) in done.iter().enumerate() {
                for column in 0..P {
                    row[column] -= lower[i][k] * known[column];
                }
            }
            for value in row {
                *value *= lower[i][i];
                trace += *value * *value;
            }
        }
        trace
    }
}

fn add<const P: usize>(sum: &mut Packed<P>, part: &Packed<P>, sign: f64) {
    for (row, part) in sum.iter_mut().zip(part) {
        for (value, part) in row.iter_mut().zip(part) {
            *value += sign * part;
        }
    }
}

fn sum_of<const P: usize>(parts: &[Packed<P>], set: &[usize]) -> Packed<P> {
    let mut sum = [[0.0; P]; P];
    set.iter().for_each(|index| add(&mut sum, &parts[*index], 1.0));
    sum
}

/// Random sets of `size` among `of` candidates, all different from draw to draw; the same for the same seed.
pub fn random_set(seed: u64, draw: usize, size: usize, of: usize) -> Vec<usize> {
    let mut random = stream(seed, Purpose::RandomSets, draw);
    let mut all: Vec<usize> = (0..of).collect();
    for place in 0..size.min(of) {
        let other = random.random_range(place..of);
        all.swap(place, other);
    }
    all.truncate(size);
    all.sort_unstable();
    all
}

/// Values of the criterion, in the order of the sets.
pub fn values<const P: usize>(
    criterion: &IOptimality<P>,
    informations: &[InformationMatrix<P>],
    sets: &[Vec<usize>],
) -> Vec<f64> {
    sets.iter().map(|set| criterion.value(&sum_over(informations, set))).collect()
}

/// The sum over a set.
pub(super) fn sum_over<const P: usize>(informations: &[InformationMatrix<P>], set: &[usize]) -> InformationMatrix<P> {
    set.iter().fold(InformationMatrix::zeros(), |sum, index| sum + informations[*index])
}

/// The best set of `size` from the greedy start and from these, each improved as long as an exchange helps. `None` when
/// `monitor` asked to stop. The result does not depend on the number of threads; ties go to the first.
pub fn exchange<const P: usize>(
    criterion: &IOptimality<P>,
    informations: &[InformationMatrix<P>],
    size: usize,
    starts: &[Vec<usize>],
    monitor: &Monitor,
) -> Option<ExactDesign> {
    let parts: Vec<Packed<P>> = informations.iter().map(|information| criterion.packed(information)).collect();
    let (done, total) = (AtomicUsize::new(0), starts.len() + 1);
    let improved: Vec<Option<ExactDesign>> = (0..=starts.len())
        .into_par_iter()
        .map(|start| {
            let set = if start == 0 { greedy(criterion, &parts, size) } else { starts[start - 1].clone() };
            let chosen = improve(criterion, &parts, set, monitor);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            monitor.report(Progress::Steps { stage: "choosing", done, total });
            (!monitor.should_stop()).then_some(chosen)
        })
        .collect();
    let mut best: Option<ExactDesign> = None;
    for chosen in improved {
        let chosen = chosen?;
        if best.as_ref().is_none_or(|best| chosen.value < best.value * BETTER) {
            best = Some(chosen);
        }
    }
    best
}

/// Adds the best candidate, one after the other, to a small multiple of the mean of all.
fn greedy<const P: usize>(criterion: &IOptimality<P>, parts: &[Packed<P>], size: usize) -> Vec<usize> {
    let mut sum = [[0.0; P]; P];
    let share = PRIOR / parts.len() as f64 * size as f64;
    parts.iter().for_each(|part| add(&mut sum, part, share));
    let mut set = Vec::with_capacity(size);
    let mut is_in = vec![false; parts.len()];
    for _ in 0..size.min(parts.len()) {
        let Some((best, _)) = best_addition(criterion, parts, &sum, &is_in, f64::INFINITY) else { break };
        add(&mut sum, &parts[best], 1.0);
        is_in[best] = true;
        set.push(best);
    }
    // Where no addition gives a finite value, any will do.
    let others = (0..parts.len()).filter(|index| !is_in[*index]).take(size.min(parts.len()) - set.len());
    set.extend(others.collect::<Vec<_>>());
    set
}

/// The candidate outside a set whose addition gives the smallest value, if that is below a bound.
fn best_addition<const P: usize>(
    criterion: &IOptimality<P>,
    parts: &[Packed<P>],
    sum: &Packed<P>,
    is_in: &[bool],
    bound: f64,
) -> Option<(usize, f64)> {
    let mut best = None;
    let mut min = bound;
    for (index, part) in parts.iter().enumerate() {
        if is_in[index] {
            continue;
        }
        let mut trial = *sum;
        add(&mut trial, part, 1.0);
        let value = criterion.packed_value(&trial);
        if value < min * BETTER {
            (best, min) = (Some((index, value)), value);
        }
    }
    best
}

fn improve<const P: usize>(
    criterion: &IOptimality<P>,
    parts: &[Packed<P>],
    mut set: Vec<usize>,
    monitor: &Monitor,
) -> ExactDesign {
    let mut is_in = vec![false; parts.len()];
    set.iter().for_each(|index| is_in[*index] = true);
    let mut value = criterion.packed_value(&sum_of(parts, &set));
    for _ in 0..ROUNDS {
        let mut has_changed = false;
        for place in 0..set.len() {
            let mut without = sum_of(parts, &set);
            add(&mut without, &parts[set[place]], -1.0);
            let Some((index, _)) = best_addition(criterion, parts, &without, &is_in, value) else { continue };
            let mut trial = set.clone();
            trial[place] = index;
            // From scratch, without the rounding of what was subtracted and added.
            let exact = criterion.packed_value(&sum_of(parts, &trial));
            if exact < value || (value.is_infinite() && exact.is_finite()) {
                is_in[set[place]] = false;
                is_in[index] = true;
                (set, value, has_changed) = (trial, exact, true);
            }
        }
        if !has_changed || monitor.should_stop() {
            break;
        }
    }
    set.sort_unstable();
    ExactDesign { value: criterion.packed_value(&sum_of(parts, &set)), set }
}
