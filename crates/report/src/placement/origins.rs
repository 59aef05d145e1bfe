//! Where a deflection comes from: what each thing that yields adds to the scored part, in documents, tables and words;
//! nothing where only the joints about their axes yield.

use crate::columns::table;
use crate::figure::{DeflectionMm, each, some};
use crate::units::fixed;
use stead_model::robot::Posture;
use stead_model::stiffness::whole::ByOrigin;
use stead_placement::outcome::Plan;
use stead_planning::feasibility::Explanation;
use stead_problem::evaluate::reference::{ScoredByOrigin, scored_by_origin};
use stead_problem::problem::{Placement, Problem};

records! {
    /// What each thing that yields adds to the scored part; one below 0 takes from the others.
    pub struct OriginFigures from origins: &ScoredByOrigin {
        let ByOrigin { axes, normal, base, mount, tip } = origins.arm;
    } with {
        /// The joints about their axes.
        axes_mm: DeflectionMm = axes.into(),
        /// The joints normal to their axes.
        normal_mm: DeflectionMm = normal.into(),
        /// The same, joint by joint.
        normal_by_joint_mm: [DeflectionMm; 6] = each(origins.normal_by_joint),
        /// What carries the robot.
        base_mm: DeflectionMm = base.into(),
        /// The bolts of the spindle.
        mount_mm: DeflectionMm = mount.into(),
        /// Holder and tool.
        tip_mm: DeflectionMm = tip.into(),
        /// The part.
        part_mm: DeflectionMm = origins.part.into(),
    }

    /// The same as columns of a table of points or states, empty where there is no state.
    pub struct OriginColumns of (origins: Option<&ScoredByOrigin>) {
        let ByOrigin { axes, normal, base, mount, tip } = origins.map(|origins| origins.arm.map(Some)).unwrap_or_default();
    } with {
        /// What the joints about their axes add to the scored part, where more yields than these.
        from_axes_mm: Option<DeflectionMm> = some(axes),
        /// What the joints normal to their axes add to it.
        from_normal_mm: Option<DeflectionMm> = some(normal),
        /// What adds to it that carries the robot.
        from_base_mm: Option<DeflectionMm> = some(base),
        /// What the bolts of the spindle add to it.
        from_mount_mm: Option<DeflectionMm> = some(mount),
        /// What holder and tool add to it.
        from_tip_mm: Option<DeflectionMm> = some(tip),
        /// What the part adds to it.
        from_part_mm: Option<DeflectionMm> = some(origins.map(|origins| origins.part)),
    }
}

/// The words for what yields, and what each adds. m
fn named(origins: &ScoredByOrigin) -> [(&'static str, f64); 6] {
    let ByOrigin { axes, normal, base, mount, tip } = origins.arm;
    [
        ("joints about their axes", axes),
        ("normal to them", normal),
        ("base", base),
        ("mount of the spindle", mount),
        ("holder and tool", tip),
        ("part", origins.part),
    ]
}

/// What each thing that yields adds to the mean of a plan, where more does than the joints about their axes.
pub(super) fn of_plan(plan: &Plan) -> Option<String> {
    let origins = plan.by_origin?;
    let parts = named(&origins).into_iter().filter(|(_, part)| *part != 0.0);
    let parts: Vec<String> = parts.map(|(name, part)| format!("{name} {}", fixed(part * 1e3, 4))).collect();
    let total = fixed(origins.total() * 1e3, 4);
    Some(format!("of the scored deflection of {total} mm in the mean: {}", parts.join(", ")))
}

/// A table of what adds to the scored deflection of each posture, joint by joint; columns of what adds nothing are left
/// out. `None` where only the joints about their axes yield.
pub(super) fn of_postures(postures: &[Explanation; 8]) -> Option<String> {
    let known = || postures.iter().filter_map(|e| Some((e.posture, e.by_origin.as_ref()?)));
    known().next()?;
    let columns = |origins: &ScoredByOrigin| {
        let [axes, _, others @ ..] = named(origins);
        let joints = (1..).zip(origins.normal_by_joint).map(|(joint, part)| (format!("normal {joint}"), part));
        let others = others.map(|(name, part)| (name.rsplit(' ').next().unwrap_or(name).to_owned(), part));
        let all = [("sum".to_owned(), origins.total()), ("axes".to_owned(), axes.1)];
        all.into_iter().chain(joints).chain(others).collect::<Vec<_>>()
    };
    let all: Vec<_> = known().map(|(posture, origins)| (posture, columns(origins))).collect();
    let count = all.first().map_or(0, |(_, columns)| columns.len());
    let shown: Vec<usize> = (0..count).filter(|k| all.iter().any(|(_, columns)| columns[*k].1 != 0.0)).collect();
    let header = all.first().map(|(_, columns)| shown.iter().map(|k| columns[*k].0.clone()).collect::<Vec<_>>());
    let header = std::iter::once("posture".to_owned()).chain(header.unwrap_or_default());
    let rows = all.iter().map(|(posture, columns)| {
        let figures = shown.iter().map(|k| fixed(columns[*k].1 * 1e3, 5));
        std::iter::once(posture.to_string()).chain(figures).collect()
    });
    Some(format!(
        "of the scored deflection, in mm: joints about their axes, normal to them by joint, and what else yields\n\n{}",
        table(header, rows, &[])
    ))
}

/// What adds to the scored deflection of a state of a deflection map, where there is an allowed one, and where more
/// yields than the joints about their axes.
pub(super) fn of_state(
    (problem, placement): (&Problem, &Placement),
    point: usize,
    beta: f64,
    posture: Option<Posture>,
) -> Option<OriginColumns> {
    problem.yields_beside().then(|| {
        let state = posture.and_then(|posture| problem.at(placement).state(point, beta, posture).ok());
        OriginColumns::of(state.map(|s| scored_by_origin(problem, point, placement, &s.joints)).as_ref())
    })
}
