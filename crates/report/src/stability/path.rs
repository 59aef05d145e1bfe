//! Critical depths along the plans of a placement.

use super::super::output::ReportError;
use super::super::picture;
use super::json::VerdictFigures;
use crate::csv_file::rows;
use crate::figure::{DepthMm, RatePerS, SpeedRpm, some};
use crate::units::fixed;
use stead_placement::outcome::{Plan, PlanPoint};
use stead_simulation::path_stability::smallest;
use stead_simulation::stability_analysis::CutStability;
use stead_study::PathStability;

/// The tables of plans by their file names and `stability.svg`, which calls the plans by other names.
///
/// # Errors
/// [`ReportError::Format`] when a file cannot be made.
pub fn files(
    stability: &PathStability,
    plans: &[&Plan],
    tables: [&'static str; 2],
    names: [&str; 2],
) -> Result<Vec<(&'static str, Vec<u8>)>, ReportError> {
    let of = plans.iter().zip(&stability.plans).zip(tables);
    let of_each = of.map(|((plan, depths), name)| Ok((name, along(plan, depths)?)));
    let mut files = of_each.collect::<Result<Vec<_>, ReportError>>()?;
    files.push(("stability.svg", picture::path_stability(stability, plans, names).into_bytes()));
    Ok(files)
}

records! {
    /// Critical depths along plans, and the setting that they are for.
    pub struct PathStabilityFigures of (stability: &PathStability, with_points: bool) {
        let analysis = &stability.analysis;
        let plan = |depths: &Vec<_>| PlanStability::of(depths, with_points);
    } with {
        /// The model of the arm.
        variant: &'static str = analysis.variant.word(),
        /// What the damping of the robot file is multiplied by.
        damping_scale: f64 = analysis.damping_scale,
        /// Spindle speed.
        spindle_rpm: SpeedRpm = analysis.cut.spindle_speed.into(),
        /// Axial depth of the cut.
        axial_depth_mm: DepthMm = analysis.cut.section.axial_depth.into(),
        /// Depths are searched up to this.
        max_depth_mm: DepthMm = analysis.max_depth.into(),
        /// The best plan.
        best: Option<PlanStability> = stability.plans.first().map(plan),
        /// The worst plan, or that of the worst placement.
        worst: Option<PlanStability> = stability.plans.get(1).map(plan),
    }

    /// Critical depths along a plan.
    pub struct PlanStability of (depths: &[CutStability], with_points: bool) {
        let min = smallest(depths);
    } with {
        /// The smallest critical depth; null where all depths up to the largest are stable.
        smallest_critical_depth_mm: Option<DepthMm> = min.map(|(_, depth)| depth.into()),
        /// The path point where it is, from 0.
        at_point: Option<usize> = min.map(|(point, _)| point),
        /// Whether the cut is stable at every point.
        stable: bool = depths.iter().all(|at| at.verdict.is_stable()),
        /// How many points chatter.
        points_that_chatter: usize = chattering(depths),
        /// Every point.
        points?: Vec<VerdictFigures> = with_points.then(|| depths.iter().map(Into::into).collect()),
    }
}

/// A line for each of the two plans, by what they are called.
pub fn text(stability: &PathStability, names: [&str; 2]) -> String {
    let mut text = String::new();
    for (name, depths) in names.iter().zip(&stability.plans) {
        let max_depth = match smallest(depths) {
            Some((point, depth)) => format!("down to {} mm (point {point})", fixed(depth * 1e3, 3)),
            None => format!("beyond {} mm everywhere", fixed(stability.analysis.max_depth * 1e3, 3)),
        };
        let (bad, count) = (chattering(depths), depths.len());
        let verdict = match bad {
            0 => "is stable at every point".to_owned(),
            _ => format!("chatters at {bad} of {count} points"),
        };
        let depth = fixed(stability.analysis.cut.section.axial_depth * 1e3, 3);
        text.push_str(&format!("{name}: critical depth {max_depth}; the cut of {depth} mm {verdict}\n"));
    }
    text
}

fn chattering(depths: &[CutStability]) -> usize {
    depths.iter().filter(|at| !at.verdict.is_stable()).count()
}

records! {
    /// The critical depths at a path point; empty where all depths up to the largest are stable.
    pub struct PathStabilityRow of (point: &PlanPoint, at: &CutStability) {
        /// Path point, from 0.
        point: usize = point.point,
        /// Segment, from 1.
        segment: usize = point.segment,
        /// Critical depth by semi-discretisation.
        critical_depth_mm: Option<DepthMm> = some(at.semi_discretisation),
        /// Critical depth by the zero-order solution.
        zero_order_mm: Option<DepthMm> = some(at.zero_order),
        /// Whether the cut is stable.
        stable: bool = at.verdict.is_stable(),
        /// What small motions do.
        kind: &'static str = at.verdict.kind().word(),
        /// The rate at which small motions grow.
        growth_rate_per_s: RatePerS = at.verdict.growth_rate().into(),
    }
}

fn along(plan: &Plan, depths: &[CutStability]) -> Result<Vec<u8>, ReportError> {
    let row = |(point, at): (&PlanPoint, &CutStability)| PathStabilityRow::of(point, at);
    rows("the table of critical depths", plan.points.iter().zip(depths).map(row))
}
