//! How hard to search.

use crate::problem::Problem;
use crate::sense::Sense;
use serde::Serialize;

/// How the posture scheme of a candidate placement is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PostureSearch {
    /// Exactly: the best posture of each segment, for every candidate.
    Exact,
    /// In the genome, one posture number per segment, as Caro 2013 did.
    Genetic,
}

/// Whether the search uses a lookup table ([`crate::table_shape`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LookupUse {
    /// Where the task allows it and the table fits in memory.
    Auto,
    /// As a wish: a task that does not allow it is refused when it is read.
    Always,
    /// Never: the planner evaluates every candidate.
    Never,
}

/// Settings of the genetic search and of the refinement after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchSettings {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Candidates in a generation, at least 4.
    pub population: usize,
    /// Generations after the random start.
    pub generations: usize,
    /// How posture schemes are found.
    pub postures: PostureSearch,
    /// Distinct basins of each search that are refined, at least 1.
    pub basins: usize,
    /// Whether to use a lookup table.
    pub tables: LookupUse,
    /// Points of a long path by which candidates are compared; chosen where none is given. With all points of the path
    /// or more, it is searched and refined whole.
    pub path_points: Option<usize>,
    /// Whether the worst placement is looked for, too, to show what is at stake.
    pub worst: bool,
    /// The relative size of a force error for which the basins are refined once more, to see how far the optimum moves;
    /// none where that is not asked.
    pub sensitivity: Option<f64>,
}

impl SearchSettings {
    /// The force error of a sensitivity analysis where no other is given.
    pub const FORCE_ERROR: f64 = 0.1;

    /// Checks that what is asked beside the search can be found for a problem.
    ///
    /// # Errors
    /// [`Unfit`]: a sensitivity to force errors where the tool may lean.
    pub fn check_for(&self, problem: &Problem) -> Result<(), Unfit> {
        if self.sensitivity.is_some() && problem.lean.is_some() { Err(Unfit::Sensitivity) } else { Ok(()) }
    }

    /// Whether the placement that is best in a sense is looked for.
    pub fn seeks(&self, sense: Sense) -> bool {
        sense == Sense::Min || self.worst
    }
}

/// Why settings do not go with a problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Unfit {
    /// Force errors where the tool may lean.
    #[error(
        "how far force errors move the best placement is found for the tool axis of the task alone, and [lean] lets the tool \
         lean; allowed: a run without [lean], or criterion.force_uncertainty, which covers force errors in every score"
    )]
    Sensitivity,
}

impl Default for SearchSettings {
    /// The published population and generations (Caro 2013, section V).
    fn default() -> Self {
        Self {
            seed: 1,
            population: 120,
            generations: 51,
            postures: PostureSearch::Exact,
            basins: 4,
            tables: LookupUse::Auto,
            path_points: None,
            worst: true,
            sensitivity: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::five_segments;

    #[test]
    fn settings_of_a_problem_without_a_tool_that_leans_fit() {
        let settings = SearchSettings { sensitivity: Some(0.1), ..SearchSettings::default() };
        assert_eq!(settings.check_for(&five_segments()), Ok(()));
        assert!(Unfit::Sensitivity.to_string().contains("[lean] lets the tool lean; allowed: a run without [lean]"));
    }
}
