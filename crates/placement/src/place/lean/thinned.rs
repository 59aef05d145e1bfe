//! The points of a path on which lead and tilt are planned.

use crate::path_subset::PathSubset;
use crate::place::axes::kept_points;
use stead_planning::problem::Problem;

/// An upright problem with the points on which lead and tilt are planned.
pub(in crate::place) struct Thinned<'a> {
    pub(in crate::place) upright: &'a Problem,
    pub(in crate::place) kept: Vec<usize>,
    /// On these points alone, where they are not all.
    few: Option<Problem>,
}

impl<'a> Thinned<'a> {
    pub(in crate::place) fn new(upright: &'a Problem, kept: Vec<usize>) -> Self {
        let is_few = kept.len() < upright.task.points().len();
        let few = is_few.then(|| PathSubset::of_points(kept.clone()).of(upright));
        Self { upright, kept, few }
    }

    /// With all points, or so many of a longer path.
    pub(in crate::place) fn to_at_most(upright: &'a Problem, points: usize) -> Self {
        Self::new(upright, kept_points(upright, points, |_| 0.0))
    }

    pub(in crate::place) fn problem(&self) -> &Problem {
        self.few.as_ref().unwrap_or(self.upright)
    }
}
