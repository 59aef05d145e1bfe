//! What a certificate asks of a problem.

use super::arm::{is_base_alike, needed_condition};
use super::at_rest::without_axes;
use super::cell::{NEAREST, extent, points_of, too_near};
use super::coarse_bounds::CoarseBounds;
use super::compliance_table::ComplianceTable;
use super::leaning;
use super::model::STEPS;
use super::orientations;
use super::segments;
use stead_model::stiffness::whole::yields_elsewhere;
use stead_planning::criterion::Aggregate;
use stead_planning::problem::Problem;
use stead_planning::symmetry::{
    Unsupported, Upright, require_certain_compliances, require_constant, require_free_beta, require_no_travel,
};

/// Whether the best placement of a problem can be certified with tables of at most `memory` bytes when they are empty,
/// found without work.
///
/// What adds to an objective and is never below zero is left out of its bound, and so is what keeps plans from being
/// better: see `left_out`.
///
/// # Errors
/// The first reason why not.
pub fn certifiable(problem: &Problem, memory: u64) -> Result<(), Unsupported> {
    if orientations::are_several(problem) {
        return orientations::alone(problem)?.iter().try_for_each(|(orientation, one)| {
            let named = |reason| Unsupported::Orientation { name: orientation.name.clone(), reason: Box::new(reason) };
            certifiable(one, memory).map_err(named)
        });
    }
    if problem.lean.is_some() {
        return Err(Unsupported::Lean);
    }
    if segments::are_apart(problem) {
        return segments::alone(problem)?.iter().try_for_each(|(_, one)| certifiable(one, memory));
    }
    let alone = without_axes(problem)?;
    let problem = alone.as_ref();
    let axes = tool_axes(problem)?;
    require_constant(problem, &[0, 3, 4, 5])?;
    require_covered_springs(problem)?;
    let extent = extent(problem);
    if let Some(needed) = needed_condition(problem, extent.radius.0) {
        return Err(Unsupported::Conditioning { needed });
    }
    if axes > 0 {
        require_covered_leaning(problem)?;
        let bytes = leaning::bytes(problem, axes);
        return if bytes > memory { Err(Unsupported::TooLarge { bytes, max: memory }) } else { Ok(()) };
    }
    let coarse = CoarseBounds::bytes(extent, STEPS, &points_of(problem));
    let bytes = ComplianceTable::bytes(extent, STEPS)
        .saturating_mul(problem.scored_robots().len() as u64)
        .saturating_add(coarse);
    if bytes > memory { Err(Unsupported::TooLarge { bytes, max: memory }) } else { Ok(()) }
}

/// What a certificate of a problem costs more than others, to be said before a long search: in a sentence, where there
/// is something to say.
pub fn expected_cost(problem: &Problem) -> Option<String> {
    let [nearest, missing] = [NEAREST, missing_to_axis_1(problem)?].map(|length| (length * 1e3).ceil());
    Some(format!(
        "path points may come nearer than {nearest} mm to axis 1 in this cell, where they count without deflection in \
         the certificate: its gap closes slowly, or not to the one asked for; in a cell {missing} mm farther from \
         axis 1 none do"
    ))
}

/// The most that [`too_near`] says of the parts of a problem that are bounded by themselves. m
fn missing_to_axis_1(problem: &Problem) -> Option<f64> {
    if orientations::are_several(problem) {
        return orientations::alone(problem)
            .ok()?
            .iter()
            .filter_map(|(_, one)| missing_to_axis_1(one))
            .reduce(f64::max);
    }
    if segments::are_apart(problem) {
        return segments::alone(problem).ok()?.iter().filter_map(|(_, one)| missing_to_axis_1(one)).reduce(f64::max);
    }
    too_near(without_axes(problem).ok()?.as_ref())
}

/// Whether the worst placement can be certified too: bounds from above are those of the mean of scores that are the
/// absolute value of one part of the deflection.
///
/// # Errors
/// The first reason why not.
pub fn certifiable_from_above(problem: &Problem, memory: u64) -> Result<(), Unsupported> {
    if orientations::are_several(problem) {
        return Err(Unsupported::Orientations);
    }
    certifiable(problem, memory)?;
    Upright::of(problem)?;
    require_no_travel(problem)?;
    require_free_beta(problem)?;
    require_certain_compliances(problem)?;
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

/// What a lower bound leaves out of the objective of a problem, and of what is allowed, beside its constraints: in
/// words.
pub(super) fn left_out(problem: &Problem) -> Vec<String> {
    let mut words = Vec::new();
    if require_no_travel(problem).is_err() {
        words.push("travel of the joints in the objective".to_owned());
    }
    if require_certain_compliances(problem).is_err() {
        words.push("errors of the compliances in the scores".to_owned());
    }
    if require_free_beta(problem).is_err() {
        words.push("beta that stays along the path".to_owned());
    }
    if expected_cost(problem).is_some() {
        let nearest = NEAREST * 1e3;
        words.push(format!("the deflection of path points nearer than {nearest} mm to axis 1"));
    }
    if !problem.external_axes.is_empty() {
        words.push("which position of the external axes goes with which x, y, z and yaw".to_owned());
    }
    if segments::are_apart(problem) {
        words.push("that all segments have the same x, y, z and yaw".to_owned());
    }
    words
}

/// The number of tool axes of a path, where the tool is not upright at every point; zero where it is.
fn tool_axes(problem: &Problem) -> Result<usize, Unsupported> {
    match Upright::of(problem) {
        Ok(_) => Ok(0),
        Err(Unsupported::TiltedTool { .. } | Unsupported::UpsideDown { .. }) => {
            let axes = leaning::axes_of(problem).len();
            let max = leaning::MOST_AXES;
            if axes > max { Err(Unsupported::ManyToolAxes { axes, max }) } else { Ok(axes) }
        }
        Err(reason) => Err(reason),
    }
}

/// Requires of a problem whose tool leans what bounds cover there.
fn require_covered_leaning(problem: &Problem) -> Result<(), Unsupported> {
    let beyond = |what| Err(Unsupported::Leaning { what });
    if problem.task.wrenches().iter().any(|wrench| wrench.moment.norm() > 0.0) {
        beyond("moments on the tool")
    } else if problem.scored_robots().len() > 1 {
        beyond("several stiffness sets (criterion.robots)")
    } else if problem.scored_robots().iter().any(|robot| yields_elsewhere(robot, &problem.spindle)) {
        beyond("springs normal to the axes, base, mount and tip")
    } else {
        Ok(())
    }
}

/// Requires that what yields beside the joints about their axes turns with the arm, the tool or the part, and does so
/// under forces alone.
fn require_covered_springs(problem: &Problem) -> Result<(), Unsupported> {
    let has_moments = problem.task.wrenches().iter().any(|wrench| wrench.moment.norm() > 0.0);
    for robot in problem.scored_robots() {
        if !is_base_alike(robot) {
            return Err(Unsupported::YieldsBeside {
                what: "base and pedestal that are not alike in every direction about axis 1 ([base_compliance])",
            });
        }
        if !robot.flips_yield_alike() {
            return Err(Unsupported::UnlikeFlips);
        }
        if has_moments && yields_elsewhere(robot, &problem.spindle) {
            return Err(Unsupported::YieldsBeside {
                what: "springs normal to the axes, base or mount under moments on the tool",
            });
        }
    }
    Ok(())
}
