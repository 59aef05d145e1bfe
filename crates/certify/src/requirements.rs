//! What a certificate asks of a problem.

use super::arm::needed_condition;
use super::cell::{extent, points_of};
use super::coarse_bounds::CoarseBounds;
use super::compliance_table::ComplianceTable;
use super::model::{LEVELS, STEPS};
use stead_planning::criterion::Aggregate;
use stead_planning::problem::Problem;
use stead_planning::symmetry::{
    Unsupported, Upright, require_axial_springs, require_certain_compliances, require_constant, require_free_beta,
    require_no_travel,
};

/// Whether the best placement of a problem can be certified with tables of at most `memory` bytes when they are empty,
/// found without work.
///
/// # Errors
/// The first reason why not.
pub fn certifiable(problem: &Problem, memory: u64) -> Result<(), Unsupported> {
    if problem.orientations.len() > 1 {
        return Err(Unsupported::Orientations);
    }
    if problem.lean.is_some() {
        return Err(Unsupported::Lean);
    }
    Upright::of(problem)?;
    require_no_travel(problem)?;
    require_free_beta(problem)?;
    require_constant(problem, &[0, 3, 4, 5])?;
    require_certain_compliances(problem)?;
    require_axial_springs(problem)?;
    let extent = extent(problem);
    if let Some(needed) = needed_condition(problem, extent.radius.0) {
        return Err(Unsupported::Conditioning { needed });
    }
    let coarse = CoarseBounds::bytes(extent, STEPS, &points_of(problem));
    let bytes = ComplianceTable::bytes(extent, STEPS, LEVELS)
        .saturating_mul(problem.scored_robots().len() as u64)
        .saturating_add(coarse);
    if bytes > memory { Err(Unsupported::TooLarge { bytes, max: memory }) } else { Ok(()) }
}

/// Whether the worst placement can be certified too: bounds from above are those of the mean of scores that are the
/// absolute value of one part of the deflection.
///
/// # Errors
/// The first reason why not.
pub fn certifiable_from_above(problem: &Problem, memory: u64) -> Result<(), Unsupported> {
    certifiable(problem, memory)?;
    let beyond = |key| Err(Unsupported::NotFromAbove { key });
    if problem.criterion.aggregate != Aggregate::Mean {
        beyond("criterion.aggregate")
    } else if problem.criterion.stiffness.is_some() {
        beyond("criterion.robots")
    } else if problem.criterion.force_uncertainty != 0.0 {
        beyond("criterion.force_uncertainty")
    } else if !problem.criterion.weights.is_single() {
        beyond("criterion.direction")
    } else {
        Ok(())
    }
}
