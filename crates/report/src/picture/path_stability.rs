//! Critical depths along the path.

use super::chart::charts;
use crate::page::cards::{Axis, Chart, Mark, Series, Style};
use crate::units::fixed;
use stead_placement::outcome::Plan;
use stead_study::PathStability;

/// Critical depth of cut over the points of the path, for one or two plans by their names, and the depth of the cut at
/// hand. Where every depth examined is stable the curve runs along the top.
pub fn path_stability(stability: &PathStability, plans: &[&Plan], names: [&str; 2]) -> String {
    let (max_depth, cut) = (stability.analysis.max_depth, stability.analysis.cut.section.axial_depth);
    let segments: Vec<usize> =
        plans.first().map_or_else(Vec::new, |plan| plan.points.iter().map(|p| p.segment).collect());
    let starts = (1..segments.len()).filter(|k| segments[*k] != segments[k - 1]);
    let depths = stability.plans.iter().map(|plan| plan.iter().map(|at| at.semi_discretisation.unwrap_or(max_depth)));
    let highest = depths.clone().flatten().fold(1.3 * cut, f64::max);
    let curve = |((depths, name), (color, style)): ((_, &str), (usize, Style))| {
        let depths = Iterator::enumerate(depths).map(|(k, depth): (usize, f64)| [k as f64, depth * 1e3]);
        let gaps = starts.clone().map(|k| [k as f64 - 0.5, f64::NAN]);
        let mut points: Vec<[f64; 2]> = depths.chain(gaps).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Series::curve(name, color, points).styled(style)
    };
    let edges = starts.clone().map(|k| Mark::across(k as f64 - 0.5, ""));
    let level = Mark::level(cut * 1e3, format!("this cut, {} mm", fixed(cut * 1e3, 2)));
    let y = Axis { range: Some([0.0, highest * 1.05e3]), ..Axis::new("critical depth of cut (mm)") };
    let curves = depths.zip(names).zip([(0, Style::Line), (2, Style::Dashed)]).map(curve);
    let chart = Chart::new("How deep may be cut along the path", "path point", y, curves);
    charts(&[chart.marked(edges.chain([level]))])
}
