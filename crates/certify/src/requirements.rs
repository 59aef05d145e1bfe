//! What a certificate asks of a problem that is bounded as a whole.

use super::arm::{is_base_alike, needed_condition};
use super::at_rest::without_axes;
use super::cell::{extent, points_of};
use super::coarse_bounds::CoarseBounds;
use super::compliance_table::ComplianceTable;
use super::leaning;
use super::model::STEPS;
use stead_model::robot::Robot;
use stead_model::stiffness::whole::yields_elsewhere;
use stead_problem::criterion::Aggregate;
use stead_problem::problem::Problem;
use stead_problem::symmetry::{
    Unsupported, Upright, require_certain_compliances, require_constant, require_free_beta, require_no_travel,
};

/// A problem that is bounded as a whole: bounds cover it.
#[derive(Debug)]
pub(super) struct Leaf {
    /// With external axes as a larger cell.
    pub problem: Problem,
    /// Whether the tool leans at some point of the path.
    pub leans: bool,
}

impl Leaf {
    /// Of a problem, with tables of at most `memory` bytes when they are empty.
    ///
    /// # Errors
    /// All reasons why bounds do not cover it.
    pub fn of(problem: &Problem, memory: u64) -> Result<Self, Vec<Unsupported>> {
        let alone = without_axes(problem);
        let rest = alone.as_deref().unwrap_or(problem);
        let axes = tool_axes(rest);
        let mut reasons: Vec<_> = problem.lean.is_some().then_some(Unsupported::Lean).into_iter().collect();
        reasons.extend(alone.as_ref().err().cloned());
        // That there are external axes was said.
        let of_tool = axes.as_ref().err().filter(|reason| alone.is_ok() || **reason != Unsupported::ExternalAxes);
        reasons.extend(of_tool.cloned());
        reasons.extend([0, 3, 4, 5].iter().filter_map(|joint| require_constant(rest, &[*joint]).err()));
        reasons.extend(unlike_springs(rest));
        if matches!(axes, Ok(1..) | Err(Unsupported::ManyToolAxes { .. })) {
            reasons.extend(not_covered_leaning(rest));
        }
        if alone.is_ok() {
            let needed = needed_condition(rest, extent(rest).radius.0);
            reasons.extend(needed.map(|needed| Unsupported::Conditioning { needed }));
            let bytes = axes.as_ref().map_or(0, |axes| bytes(rest, *axes));
            reasons.extend((bytes > memory).then_some(Unsupported::TooLarge { bytes, max: memory }));
        }
        match (alone, axes) {
            (Ok(alone), Ok(axes)) if reasons.is_empty() => Ok(Self { problem: alone.into_owned(), leans: axes > 0 }),
            _ => Err(reasons),
        }
    }
}

/// What empty tables take, for a path of so many tool axes, zero where the tool is upright. bytes
fn bytes(problem: &Problem, axes: usize) -> u64 {
    if axes > 0 {
        return leaning::bytes(problem, axes);
    }
    let extent = extent(problem);
    ComplianceTable::bytes(extent, STEPS)
        .saturating_mul(problem.scored_robots().len() as u64)
        .saturating_add(CoarseBounds::bytes(extent, STEPS, &points_of(problem)))
}

/// Why the worst placement of a problem cannot be certified, beside what bounds of the best one ask too.
pub(super) fn not_from_above(problem: &Problem) -> Vec<Unsupported> {
    let criterion = &problem.criterion;
    let beyond = [
        ("criterion.aggregate", criterion.aggregate != Aggregate::Mean),
        ("criterion.robots", criterion.stiffness.is_some()),
        ("criterion.force_uncertainty", criterion.force_uncertainty != 0.0),
        ("criterion.direction", !criterion.weights.is_single()),
    ];
    let beyond = beyond.into_iter().filter(|(_, is_beyond)| *is_beyond);
    let asked = [
        if problem.orientations.len() > 1 { Err(Unsupported::Orientations) } else { Ok(()) },
        Upright::of(problem).map(drop),
        require_no_travel(problem),
        require_free_beta(problem),
        require_certain_compliances(problem),
    ];
    let asked = asked.into_iter().filter_map(Result::err);
    asked.chain(beyond.map(|(key, _)| Unsupported::NotFromAbove { key })).collect()
}

/// What bounds leave out of what is minimised, and of how beta is planned: in words.
pub(super) fn uncounted(problem: &Problem) -> Vec<String> {
    let all = [
        (require_no_travel(problem), "travel of the joints in the objective"),
        (require_certain_compliances(problem), "errors of the compliances in the scores"),
        (require_free_beta(problem), "beta that stays along the path"),
    ];
    all.into_iter().filter(|(required, _)| required.is_err()).map(|(_, words)| words.to_owned()).collect()
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
