//! Critical depths along the path.

use super::axes::{Panel, Scale};
use super::canvas::picture;
use super::colour::{GREEN, INK, PALE, RED};
use super::line_chart::{LineChart, Mark, Sign, legend};
use crate::units::fixed;
use stead_placement::outcome::Plan;
use stead_simulation::stability_analysis::CutStability;
use stead_study::PathStability;

const LEFT: i32 = 95;
const RIGHT: i32 = 970;

/// Critical depth of cut over the points of the path, for one or two plans by their names, and the depth of the cut at hand.
/// Where every depth examined is stable the curve runs along the top.
pub fn path_stability(stability: &PathStability, plans: &[&Plan], names: [&str; 2]) -> String {
    let (max_depth, cut) = (stability.analysis.max_depth, stability.analysis.cut.section.axial_depth);
    let of = |plan: &Vec<CutStability>| plan.iter().map(|at| at.semi_discretisation.unwrap_or(max_depth)).collect();
    let depths: Vec<Vec<f64>> = stability.plans.iter().map(of).collect();
    let points = plans.first().map_or(&[][..], |plan| &plan.points);
    let highest = depths.iter().flatten().copied().fold(1.3 * cut, f64::max);
    picture((1000, 520), |canvas| {
        canvas.title("How deep may be cut along the path", (LEFT, 26));
        let x = Scale::new(0.0, points.len().saturating_sub(1) as f64, LEFT, RIGHT);
        let y = Scale::new(0.0, highest * 1.05e3, 440, 84);
        let mut chart = LineChart::new(Panel::new(x, y, [12, 8], ["path point", "critical depth of cut (mm)"]));
        let segments = points.chunk_by(|a, b| a.segment == b.segment).map(<[_]>::len);
        chart.by_segment(segments, PALE, |chart, points| {
            for (depths, colour) in depths.iter().zip([GREEN, RED]) {
                let depth = |k: usize| depths.get(k).copied().unwrap_or(max_depth);
                chart.curve(points.clone().map(|k| [k as f64, depth(k) * 1e3]), colour);
            }
        });
        chart.marks.push(Mark::Dashed(cut * 1e3, INK));
        chart.draw(canvas);
        let cut = format!("this cut, {} mm", fixed(cut * 1e3, 2));
        let mut signs = vec![(LEFT, Sign::Line(GREEN), names[0]), (LEFT + 170, Sign::Line(RED), names[1])];
        signs.truncate(depths.len());
        signs.push((LEFT + 170 * signs.len() as i32, Sign::Dashed(INK), &cut));
        legend(canvas, 52, &signs);
    })
}
