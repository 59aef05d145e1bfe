//! What changed from one placement with its leans to a better one, followed further as long as that gains: where leans
//! and placement hold each other, blocks by turns come forward in small steps alone.

use crate::place::improver::Improver;
use crate::place::job::Planned;
use crate::place::thinned::{Thinned, spread};
use stead_model::task::lean::Lean;
use stead_problem::problem::Placement;
use stead_problem::setup::Setup;

/// How often a change that gains is doubled.
const DOUBLINGS: usize = 8;

/// The last plan on the way from one plan over a better one that is better than those before.
pub(in crate::place) fn ahead(job: &Improver<'_>, from: &Planned, to: Planned) -> Planned {
    let (start, end) = (from.solution.placement, to.solution.placement);
    let Some(space) = job.space.filter(|_| (0..4).any(|k| start[k] != end[k])) else { return to };
    let upright = job.problem.in_setup(&Setup { leans: [].into(), ..to.setup.clone() });
    let on = Thinned::new(&upright, (0..upright.task.points().len()).collect());
    let (old, new) = (on.leans_of(&from.setup), on.leans_of(&to.setup));
    let mut best = to;
    let mut share = 1.0;
    for _ in 0..DOUBLINGS {
        let further = |from: f64, to: f64| to + share * (to - from);
        let lean =
            |(old, new): (&Lean, &Lean)| Lean { lead: further(old.lead, new.lead), tilt: further(old.tilt, new.tilt) };
        let leans: Vec<Lean> = old.iter().zip(&new).map(lean).collect();
        let placement = Placement::from(std::array::from_fn(|k| further(start[k], end[k])));
        let next = spread(space, &on, &leans).filter(|_| !job.monitor.should_stop()).and_then(|leans| {
            let setup = Setup { leans: leans.into(), ..best.setup.clone() };
            Planned::at(job.problem, setup, &job.problem.cell.clamp(&placement))
        });
        match next.filter(|next| next.solution.objective < best.solution.objective) {
            Some(next) => best = next,
            None => break,
        }
        share = 2.0 * share + 1.0;
    }
    best
}
