//! The placement problem, built in code, and what [`Run::place`](crate::Run::place) returns of it.

pub use crate::builder::{PlaceOptions, RunBuilder};
pub use crate::run::{Placements, Run};
pub use crate::score::{Explanations, PlacementScore};
pub use stead_placement::outcome::*;
pub use stead_placement::overview::Overview;
pub use stead_placement::place::Infeasible;
pub use stead_planning::{feasibility, feed, transfer, transfer_path};
pub use stead_problem::problem::{
    BetaPlan, Cell, Constraints, Interval, Placement, Problem, ProblemError, ProblemParts, Redundancy,
};
pub use stead_problem::sense::{BySense, Sense};
pub use stead_problem::settings::{LookupUse, PostureSearch, SearchSettings};
pub use stead_problem::{collision, constraints, criterion, joint_travel, limit, postures, setup};
