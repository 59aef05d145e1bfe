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
use stead_model::robot::Robot;
use stead_model::stiffness::whole::yields_elsewhere;
use stead_problem::criterion::Aggregate;
use stead_problem::problem::Problem;
use stead_problem::setup::Orientation;
use stead_problem::symmetry::{
    Unsupported, Upright, require_certain_compliances, require_constant, require_free_beta, require_no_travel,
};

/// Whether the best placement of a problem can be certified with tables of at most `memory` bytes when they are empty,
/// found without work.
///
/// What adds to an objective and is never below zero is left out of its bound, and so is what keeps plans from being
/// better: see `left_out`.
///
/// # Errors
/// All reasons why not; that the tables are too large where there is no other.
pub fn certifiable(problem: &Problem, memory: u64) -> Result<(), Unsupported> {
    together(reasons(problem, memory))
}

/// Reasons as one.
fn together(mut reasons: Vec<Unsupported>) -> Result<(), Unsupported> {
    let Some(last) = reasons.pop() else { return Ok(()) };
    if reasons.is_empty() {
        return Err(last);
    }
    reasons.push(last);
    Err(Unsupported::Several(reasons))
}

/// The reasons of parts of a problem that are bounded by themselves, each said once.
fn of_parts(parts: Result<Vec<Vec<Unsupported>>, Unsupported>) -> Vec<Unsupported> {
    let mut all: Vec<Unsupported> = Vec::new();
    for reason in parts.unwrap_or_else(|reason| vec![vec![reason]]).into_iter().flatten() {
        if !all.contains(&reason) {
            all.push(reason);
        }
    }
    all
}

fn reasons(problem: &Problem, memory: u64) -> Vec<Unsupported> {
    if orientations::are_several(problem) {
        let named = |(orientation, one): &(&Orientation, Problem)| {
            let name = |reason| Unsupported::Orientation { name: orientation.name.clone(), reason: Box::new(reason) };
            reasons(one, memory).into_iter().map(name).collect()
        };
        return of_parts(orientations::alone(problem).map(|parts| parts.iter().map(named).collect()));
    }
    let mut all: Vec<Unsupported> = problem.lean.is_some().then_some(Unsupported::Lean).into_iter().collect();
    if all.is_empty() && segments::are_apart(problem) {
        let parts = segments::alone(problem);
        return of_parts(parts.map(|parts| parts.iter().map(|(_, one)| reasons(one, memory)).collect()));
    }
    let alone = without_axes(problem);
    let rest = alone.as_ref().map_or(problem, |alone| alone);
    all.extend(alone.as_ref().err().cloned());
    let axes = tool_axes(rest).unwrap_or_else(|reason| {
        // That there are external axes was said.
        all.extend(Some(reason).filter(|reason| alone.is_ok() || *reason != Unsupported::ExternalAxes));
        0
    });
    all.extend(require_constant(rest, &[0, 3, 4, 5]).err());
    all.extend(unlike_springs(rest));
    if axes > 0 {
        all.extend(not_covered_leaning(rest));
    }
    if alone.is_err() {
        return all;
    }
    let extent = extent(rest);
    all.extend(needed_condition(rest, extent.radius.0).map(|needed| Unsupported::Conditioning { needed }));
    if !all.is_empty() {
        return all;
    }
    let bytes = if axes > 0 {
        leaning::bytes(rest, axes)
    } else {
        ComplianceTable::bytes(extent, STEPS)
            .saturating_mul(rest.scored_robots().len() as u64)
            .saturating_add(CoarseBounds::bytes(extent, STEPS, &points_of(rest)))
    };
    (bytes > memory).then_some(Unsupported::TooLarge { bytes, max: memory }).into_iter().collect()
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
/// All reasons why the best one cannot be certified; where it can, all why the worst cannot.
pub fn certifiable_from_above(problem: &Problem, memory: u64) -> Result<(), Unsupported> {
    if orientations::are_several(problem) {
        return Err(Unsupported::Orientations);
    }
    certifiable(problem, memory)?;
    let criterion = &problem.criterion;
    let beyond = [
        ("criterion.aggregate", criterion.aggregate != Aggregate::Mean),
        ("criterion.robots", criterion.stiffness.is_some()),
        ("criterion.force_uncertainty", criterion.force_uncertainty != 0.0),
        ("criterion.direction", !criterion.weights.is_single()),
    ];
    let beyond = beyond.into_iter().filter(|(_, is_beyond)| *is_beyond);
    let asked = [
        Upright::of(problem).map(drop),
        require_no_travel(problem),
        require_free_beta(problem),
        require_certain_compliances(problem),
    ];
    let asked = asked.into_iter().filter_map(Result::err);
    together(asked.chain(beyond.map(|(key, _)| Unsupported::NotFromAbove { key })).collect())
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

/// What bounds do not cover of a problem whose tool leans.
fn not_covered_leaning(problem: &Problem) -> Vec<Unsupported> {
    let robots = problem.scored_robots();
    let beyond = [
        ("moments on the tool", has_moments(problem)),
        ("several stiffness sets (criterion.robots)", robots.len() > 1),
        (
            "springs normal to the axes, base, mount and tip",
            robots.iter().any(|robot| yields_elsewhere(robot, &problem.spindle)),
        ),
    ];
    beyond.into_iter().filter(|(_, is_beyond)| *is_beyond).map(|(what, _)| Unsupported::Leaning { what }).collect()
}

fn has_moments(problem: &Problem) -> bool {
    problem.task.wrenches().any(|wrench| wrench.moment.norm() > 0.0)
}

/// What yields beside the joints about their axes without turning with the arm, the tool or the part, or under more
/// than forces.
fn unlike_springs(problem: &Problem) -> Vec<Unsupported> {
    let robots = problem.scored_robots();
    let is_any = |yields: &dyn Fn(&Robot) -> bool| robots.iter().any(yields);
    let beside = |what| Unsupported::YieldsBeside { what };
    let all = [
        (
            beside("base and pedestal that are not alike in every direction about axis 1 ([base_compliance])"),
            is_any(&|robot| !is_base_alike(robot)),
        ),
        (Unsupported::UnlikeFlips, is_any(&|robot| !robot.flips_yield_alike())),
        (
            beside("springs normal to the axes, base or mount under moments on the tool"),
            has_moments(problem) && is_any(&|robot| yields_elsewhere(robot, &problem.spindle)),
        ),
    ];
    all.into_iter().filter(|(_, is_so)| *is_so).map(|(reason, _)| reason).collect()
}
