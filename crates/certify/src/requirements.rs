//! What a certificate asks of a problem.

use super::arm::needed_condition;
use super::cell::{extent, points_of};
use super::coarse_bounds::CoarseBounds;
use super::compliance_table::ComplianceTable;
use super::model::{LEVELS, STEPS};
use stead_planning::problem::Problem;
use stead_planning::symmetry::{
    Unsupported, Upright, require_axial_springs, require_certain_compliances, require_constant, require_free_beta,
    require_mean_wall, require_no_moment,
};

/// Whether a problem can be certified with tables of at most `memory` bytes when they are empty, found without work.
///
/// # Errors
/// The first reason why not.
pub fn certifiable(problem: &Problem, memory: u64) -> Result<(), Unsupported> {
    if problem.orientations.len() > 1 {
        return Err(Unsupported::Orientations);
    }
    Upright::of(problem)?;
    require_no_moment(problem)?;
    require_mean_wall(problem)?;
    require_free_beta(problem)?;
    if !problem.criterion.segment_weights.is_empty() {
        return Err(Unsupported::OtherCriterion { key: "weight of a segment" });
    }
    if let Some(point) = problem.task.path().first_unscored() {
        return Err(Unsupported::Unscored { point });
    }
    require_constant(problem, &[0, 1, 2, 3, 4, 5])?;
    if problem.criterion.force_uncertainty != 0.0 {
        return Err(Unsupported::UncertainForce);
    }
    require_certain_compliances(problem)?;
    require_axial_springs(problem)?;
    let extent = extent(problem);
    if let Some(needed) = needed_condition(problem, extent.radius.0) {
        return Err(Unsupported::Conditioning { needed });
    }
    let coarse = CoarseBounds::bytes(extent, STEPS, &points_of(problem));
    let bytes = ComplianceTable::bytes(extent, STEPS, LEVELS).saturating_add(coarse);
    if bytes > memory { Err(Unsupported::TooLarge { bytes, max: memory }) } else { Ok(()) }
}
