//! The searches for the best and the worst placement.

use super::infeasible::{Infeasible, infeasible};
use crate::evaluator::Evaluator;
use crate::lookup::LookupTable;
use crate::outcome::LookupSummary;
use crate::search::{self, SearchResult};
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::Planner;
use stead_problem::candidate::Objective;
use stead_problem::sense::{BySense, Sense};
use stead_problem::settings::{LookupUse, SearchSettings};
use stead_problem::symmetry::Unsupported;

/// What the searches of both senses come to.
pub(super) struct Searched<'a> {
    pub found: BySense<SearchResult>,
    pub table: Option<LookupTable<'a>>,
    pub lookup_summary: Option<Result<LookupSummary, Unsupported>>,
    pub evaluations: usize,
}

/// What the searches of both senses come to, each by itself; nothing for one that is not requested.
fn of_sought(settings: &SearchSettings, search: impl Fn(Sense) -> SearchResult) -> BySense<SearchResult> {
    BySense::from_fn(|sense| if settings.seeks(sense) { search(sense) } else { SearchResult::nothing() })
}

/// Searches for the best and the worst placement on the coarse grid; a planner on the finer one, `finer`, has the last
/// word on what is feasible.
pub(super) fn search_cell<'a>(
    finer: &Planner<'a>,
    settings: &SearchSettings,
    monitor: &Monitor,
) -> Result<Searched<'a>, Infeasible> {
    let problem = finer.problem();
    if let Some(placement) = problem.cell.pinned() {
        let found = of_sought(settings, |sense| search::pinned(finer, placement, sense));
        return match found.best.basins[0].objective {
            Objective::Feasible(_) => Ok(Searched { found, table: None, lookup_summary: None, evaluations: 1 }),
            Objective::Infeasible { .. } => Err(infeasible(finer, &placement, None, false, monitor)),
        };
    }
    let planner = Planner::new(problem).with_finer(finer);
    let table = match settings.tables {
        LookupUse::Auto | LookupUse::Always => Some(LookupTable::monitored(problem, monitor)),
        LookupUse::Never => None,
    };
    let mut lookup_summary = table.as_ref().map(|table| match table {
        Ok(table) => Ok(LookupSummary { shape: *table.shape(), accuracy: table.accuracy() }),
        Err(unsuited) => Err(unsuited.clone()),
    });
    let mut table = table.and_then(Result::ok);
    let search = |table: Option<&LookupTable<'_>>| {
        let evaluator = Evaluator::new(&planner, table);
        of_sought(settings, |sense| search::search(&evaluator, settings, sense, monitor))
    };
    let mut found = search(table.as_ref());
    let mut evaluations = found.values().map(|f| f.evaluations).iter().sum::<usize>();
    if found.values().iter().any(|f| f.lookup_rejected && !f.interrupted) && !monitor.should_stop() {
        (table, lookup_summary) = (None, Some(Err(Unsupported::Rejected)));
        found = search(None);
        evaluations += found.values().map(|f| f.evaluations).iter().sum::<usize>();
    }
    if !found.values().iter().any(|f| f.is_feasible()) {
        evaluations += found.values().map(|f| f.basins.len()).iter().sum::<usize>();
        for (sense, found) in found.iter_mut().filter(|(sense, _)| settings.seeks(*sense)) {
            search::evaluate_finer(finer, sense, &mut found.basins, monitor);
            found.basins.truncate(settings.basins);
        }
    }
    if !SearchResult::share_basins(&mut found, settings) {
        let nearest = &found.best.basins[0];
        return Err(infeasible(finer, &nearest.placement, nearest.scheme.as_deref(), true, monitor));
    }
    Ok(Searched { found, table, lookup_summary, evaluations })
}
