//! The error of a lookup table against the reference evaluator, at random states all over the cell.

use super::{BetaGrid, LookupTable};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use stead_model::robot::{PostureClass, angles::wrap};
use stead_planning::feasibility::without_clearance;
use stead_problem::problem::{Placement, Redundancy};

/// Random placements, each with a path point.
const DRAWN: u64 = 96;
/// Values of beta at each.
const BETAS: usize = 12;

/// The error of a lookup table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// States compared: path point, beta, posture class.
    pub states: usize,
    /// Root of the mean square of the errors of allowed states, relative to that of their scores.
    pub rms: f64,
    /// Largest error of an allowed state, relative to the root of the mean square of all scores.
    pub largest: f64,
    /// Share of the states that the one allows and the other does not.
    pub disputed: f64,
}

/// Sums over some states.
#[derive(Default)]
struct Sums {
    states: usize,
    disputed: usize,
    scores: f64,
    errors: f64,
    largest: f64,
}

impl LookupTable<'_> {
    /// Compares states drawn all over the cell with the reference evaluator. The draw is always the same.
    pub fn accuracy(&self) -> Accuracy {
        let sums: Vec<Sums> = (0..DRAWN).into_par_iter().map(|draw| self.compare(draw)).collect();
        let total = sums.into_iter().fold(Sums::default(), |a, b| Sums {
            states: a.states + b.states,
            disputed: a.disputed + b.disputed,
            scores: a.scores + b.scores,
            errors: a.errors + b.errors,
            largest: a.largest.max(b.largest),
        });
        let agreed = (total.scores / total.states.max(1) as f64).max(f64::MIN_POSITIVE);
        Accuracy {
            states: total.states,
            rms: libm::sqrt(total.errors / total.scores.max(f64::MIN_POSITIVE)),
            largest: total.largest / libm::sqrt(agreed),
            disputed: total.disputed as f64 / total.states.max(1) as f64,
        }
    }

    fn compare(&self, draw: u64) -> Sums {
        let problem = self.problem;
        let mut random = ChaCha8Rng::seed_from_u64(0);
        random.set_stream(draw);
        let [x, y, z] = problem.cell.position;
        let placement: Placement =
            [x, y, z, problem.cell.yaw].map(|bounds| bounds.min + random.random::<f64>() * bounds.width()).into();
        let point = random.random_range(0..problem.task.points().len());
        let redundancy = Redundancy { beta_count: self.shape.headings, ..problem.redundancy };
        let grid = BetaGrid {
            count: redundancy.beta_count,
            changes: Vec::new(),
            tool_hits: None,
            step: redundancy.beta_step(),
        };
        let mut workspace = self.workspace(&grid);
        let interpolated: [Option<Vec<f32>>; 4] = std::array::from_fn(|class| {
            let polar = self.polar_point(&self.place(&placement), point)?;
            let mut scores = vec![f32::INFINITY; grid.count];
            self.interpolate(&polar, class, &grid, &mut workspace.scratch, &mut scores).then_some(scores)
        });
        let mut sums = Sums::default();
        for _ in 0..BETAS {
            let k = random.random_range(0..grid.count);
            let all = without_clearance(problem, &placement, point, wrap(redundancy.beta(k)));
            for class in PostureClass::ALL {
                let mut postures = class.postures().into_iter().map(|posture| &all[usize::from(posture.number()) - 1]);
                let ordinary = postures.find(|e| e.is_allowed()).and_then(|e| e.state.as_ref()).map(|s| s.score());
                let found =
                    interpolated[class.index()].as_ref().map(|scores| f64::from(scores[k])).filter(|s| s.is_finite());
                sums.states += usize::from(ordinary.is_some() || found.is_some());
                match (ordinary, found) {
                    (Some(ordinary), Some(found)) => {
                        let error = (found - ordinary).abs();
                        sums.scores += ordinary * ordinary;
                        sums.errors += error * error;
                        sums.largest = sums.largest.max(error);
                    }
                    (None, None) => {}
                    _ => sums.disputed += 1,
                }
            }
        }
        sums
    }
}
