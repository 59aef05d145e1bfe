//! The convergence of both genetic searches (Caro 2013, Fig. 6).

use super::axes::extent;
use super::chart::charts;
use crate::page::cards::{Axis, Chart, Mark, Series};
use crate::units::fixed;
use stead_placement::outcome::{Generation, Outcome};
use stead_problem::sense::Sense;

/// Best and average mean deflection over the generations: the search for the best placement above, for the worst below.
/// Dashed lines are the means after refinement.
pub fn convergence(outcome: &Outcome) -> String {
    let search = |case: &stead_placement::outcome::Case| {
        let sense = case.placement_sense;
        let generations = outcome.convergence.iter().filter(|generation| generation.sense == sense);
        search(sense, &generations.collect::<Vec<_>>(), case.plan.mean * 1e3)
    };
    charts(&outcome.cases.optima().into_iter().map(search).collect::<Vec<_>>())
}

/// One search; `refined` is the mean deflection in the end, in mm.
fn search(sense: Sense, generations: &[&Generation], refined: f64) -> Chart {
    let (title, color, least) = match sense {
        Sense::Min => ("Best placement: smallest mean deflection under the best plan", 4, 0.0),
        Sense::Max => ("Worst placement: largest mean deflection under the best plan", 2, f64::INFINITY),
    };
    let values = generations.iter().flat_map(|generation| [generation.best, generation.average]).flatten();
    let [low, high] = extent([least, 0.0], values.map(|value| value * 1e3).chain([refined]));
    let margin = 0.06 * (high - low);
    let curve = |name: &str, color: usize, value: fn(&Generation) -> Option<f64>| {
        let at = |of: &&Generation| [of.generation as f64, value(of).map_or(f64::NAN, |value| value * 1e3)];
        Series::curve(name, color, generations.iter().map(at))
    };
    let y = Axis { range: Some([(low - margin).max(0.0), high + margin]), ..Axis::new("mean deflection (mm)") };
    let curves = [
        curve("average of the feasible", 0, |generation| generation.average),
        curve("best so far", color, |generation| generation.best),
    ];
    Chart::new(title, "generation", y, curves)
        .marked([Mark::level(refined, format!("after refinement: {} mm", fixed(refined, 4)))])
}
