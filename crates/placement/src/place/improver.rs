//! The problem that a [descent](super::descent) and its blocks work on.

use stead_numerics::monitor::Monitor;
use stead_problem::lean::LeanSpace;
use stead_problem::problem::Problem;

/// A step that gains less (relative) ends what repeats it.
pub(super) const GAIN: f64 = 1e-4;
/// With more path points the placement is not refined again for other axes or leans.
pub(super) const MOST_REFINED: usize = 5000;

/// The problem, with what may be varied in it.
pub(super) struct Improver<'a> {
    pub problem: &'a Problem,
    /// How the tool may lean, where leans are planned as well.
    pub space: Option<&'a LeanSpace>,
    pub monitor: &'a Monitor,
}
