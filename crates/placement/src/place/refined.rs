//! What comes out of the refinement of a basin.

use crate::refine::Solution;
use stead_model::robot::Posture;

/// A refined solution with the scheme it was held to.
#[derive(Clone)]
pub(super) struct Refined {
    pub solution: Solution,
    pub scheme: Option<Vec<Posture>>,
}
