//! What a stage of the job hands on.

use super::job::Planned;
use super::long_path::LongPath;
use super::sets::Sets;
use crate::outcome::{Generation, LookupSummary, Refinement};
use stead_problem::candidate::{Candidate, Objective};
use stead_problem::setup::TriedSetup;
use stead_problem::symmetry::Unsupported;

/// What was found, and how.
pub(super) struct Found {
    pub best: Planned,
    /// The worst placement, where it was looked for.
    pub worst: Option<Planned>,
    pub record: Record,
    /// The objective of the best placement with the axis of the path, where the tool may lean. m
    pub upright: Option<f64>,
    /// Whether the best placement is another than the one of the search.
    pub is_improved: bool,
}

/// How something was found; of several setups the best one's.
#[derive(Default)]
pub(super) struct Record {
    /// The basins of the best placement, in the cell in which they were searched.
    pub basins: Vec<Candidate>,
    pub long: Option<LongPath>,
    pub sets: Sets,
    pub tried: Vec<TriedSetup>,
    pub lookup_summary: Option<Result<LookupSummary, Unsupported>>,
    pub convergence: Vec<Generation>,
    pub refinements: Vec<Refinement>,
    pub evaluations: usize,
    pub states: usize,
    pub interrupted: bool,
}

impl Found {
    /// Where refinements of the best placement start, in the setup and the cell that it is planned in: the basins, and
    /// it itself where it is none of theirs.
    pub fn starts(&self) -> Vec<Candidate> {
        let Planned { scheme, solution, .. } = &self.best;
        let objective = Objective::Feasible(solution.objective);
        let itself = Candidate { placement: solution.placement, scheme: scheme.clone(), objective };
        self.is_improved.then_some(itself).into_iter().chain(self.record.basins.iter().cloned()).collect()
    }
}
