//! Critical depths along the plans of a placement.

use super::super::output::ReportError;
use super::super::picture;
use super::json::verdict;
use super::{DEPTH_MM, RATE, RPM};
use crate::csv_file::table;
use crate::document::joined;
use crate::units::fixed;
use serde_json::{Value, json};
use stead_placement::outcome::Plan;
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

/// The setting and, for each plan, the smallest critical depth, where it is, and how many points chatter; with `points` all
/// of them too.
pub fn document(stability: &PathStability, points: bool) -> Value {
    let plan = |depths: &Vec<CutStability>| {
        let min = smallest(depths);
        let value = json!({
            "smallest_critical_depth_mm": min.map(|(_, depth)| DEPTH_MM.number(depth)),
            "at_point": min.map(|(point, _)| point),
            "stable": depths.iter().all(|at| at.verdict.is_stable()),
            "points_that_chatter": chattering(depths),
        });
        if points { joined(value, json!({ "points": depths.iter().map(verdict).collect::<Value>() })) } else { value }
    };
    json!({
        "variant": stability.analysis.variant.word(),
        "damping_scale": stability.analysis.damping_scale,
        "spindle_rpm": RPM.number(stability.analysis.cut.spindle_speed),
        "axial_depth_mm": DEPTH_MM.number(stability.analysis.cut.section.axial_depth),
        "max_depth_mm": DEPTH_MM.number(stability.analysis.max_depth),
        "best": stability.plans.first().map(plan),
        "worst": stability.plans.get(1).map(plan),
    })
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

/// One row for each path point; depths are empty where all depths up to the largest are stable.
fn along(plan: &Plan, depths: &[CutStability]) -> Result<Vec<u8>, ReportError> {
    const HEADER: &str = "point,segment,critical_depth_mm,zero_order_mm,stable,kind,growth_rate_per_s";
    let rows = plan.points.iter().zip(depths).map(|(point, at)| {
        let mut row = vec![point.point.to_string(), point.segment.to_string()];
        row.extend([at.semi_discretisation, at.zero_order].map(|depth| DEPTH_MM.text_or_empty(depth)));
        row.push(at.verdict.is_stable().to_string());
        row.extend([at.verdict.kind().word().to_owned(), RATE.text(at.verdict.growth_rate())]);
        row
    });
    table("the table of critical depths", HEADER.split(','), rows)
}
