//! The placement job: search, refine, improve, state.
//!
//! Three stages hand on placements with their plans (`job`, `found`): `candidates` searches (`searched`) and refines
//! (`basins`) in every setup, then a `descent` through blocks of variables (`block`) improves external axes and leans
//! of what it finds (`lean`, from there and from placements `drawn`), and `state` says what there is to say of the end
//! alone (`plan`, `notes`, `sets` for several stiffnesses, `calmer` for plans whose joints turn less). `long_path` and
//! `long_refinement` search by subsets of a long path, `infeasible` says what blocks a placement that is refused,
//! `preview` and `from_here` are for a placement that is moved by hand: what it comes to at once, and the best one near
//! it.

use super::outcome::Outcome;
use candidates::{candidates, with_axes};
use job::Job;
use lean::leaned;
use state::state;
use stead_numerics::monitor::Monitor;
use stead_problem::problem::Problem;
use stead_problem::settings::SearchSettings;
use stead_problem::settings::TransferSettings;

mod basins;
mod block;
mod calmer;
mod candidates;
mod descent;
mod drawn;
mod found;
mod from_here;
mod improver;
mod infeasible;
mod job;
mod lean;
mod long_path;
mod long_refinement;
mod notes;
mod plan;
mod preview;
mod score;
mod searched;
mod sets;
mod state;
mod thinned;

pub use candidates::setup_at;
pub use from_here::improve;
pub use infeasible::{BlockingPair, Infeasible};
pub use long_path::LongPath;
pub use preview::{Blocked, Preview, PreviewProblem};
pub use score::{Score, score};

/// Finds the best and the worst placement, each with its best and its worst plan: the four cases of Caro 2013, Table
/// III; or the best one alone ([`SearchSettings::worst`]), which is what it is beside the worst one as long as the path
/// is not searched on a subset.
///
/// The result depends on the arguments alone, not on the number of threads. When `monitor` asks to stop, every stage
/// ends with what it has, only the plans of the best and the worst placement are still made, and
/// [`Outcome::interrupted`] is set. Maps are not made here: see [`Outcome::map`].
///
/// # Errors
/// [`Infeasible`] when the search met no feasible placement.
pub fn place(
    problem: &Problem,
    settings: &SearchSettings,
    transfer: &TransferSettings,
    monitor: &Monitor,
) -> Result<Outcome, Infeasible> {
    let without_tie_rule = problem.without_tie_rule();
    let job = Job { problem, without_tie_rule: &without_tie_rule, settings, transfer, monitor };
    let found = candidates(&job).map(|found| with_axes(&job, found));
    Ok(state(&job, leaned(&job, found)?))
}

#[cfg(test)]
mod brute_force;
#[cfg(test)]
pub(crate) mod tests;
