//! A chosen set of measurements, and how well the compliances will be known from it. SI units and radians.

use super::super::gauge::Gauge;
use super::super::sheet::{LoadCase, Sheet};
use super::candidates::Rejected;
use super::expected::{ExpectedCompliance, ExpectedParameter};
use super::unobservable::{Unobservable, WeaklyObserved};
use serde::Serialize;
use stead_numerics::message::{Note, Warning};

/// A set of configurations to measure, and how well the compliances will be known from it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Design {
    /// Joint angles and loads, in the order in which to measure.
    pub load_cases: Vec<LoadCase>,
    /// The sheet of these, with the readings of the starting arm; base and tracker frame are the same.
    pub sheet: Sheet,
    /// Which springs cannot be told apart.
    pub gauge: Gauge,
    /// Every identifiable compliance with its expected standard deviation.
    pub compliances: Vec<ExpectedCompliance>,
    /// The parameters of the compensator and of the joint beside it likewise, where the starting robot has a
    /// compensator.
    pub compensator: Vec<ExpectedParameter>,
    /// Expected error of the deflection of the tip, from this set and from random sets.
    pub errors: ExpectedErrors,
    /// Root of the mean square of that deflection itself over the tests, by the starting arm. m
    pub deflection: f64,
    /// Where the deflection of the tip is to be known.
    pub tests: Vec<LoadCase>,
    /// Unobservable compliances and combinations, with the reasons.
    pub unobservable: Vec<Unobservable>,
    /// Compliances that are observable, but only weakly.
    pub weakly_observed: Vec<WeaklyObserved>,
    /// Candidates the set was chosen from.
    pub candidates: usize,
    /// Configurations drawn to have these.
    pub draws: usize,
    /// Configurations drawn that were not allowed, and why.
    pub rejected: Rejected,
    /// The largest rotation of a joint, summed over the moves from one configuration to the next. rad
    pub travel: f64,
    /// What the set leaves out on purpose, in sentences.
    pub notes: Vec<Note>,
    /// Unobservable and weakly observed compliances, in sentences.
    pub warnings: Vec<Warning>,
}

/// Root of the mean square error of the deflection of the tip over the tests, `sqrt(trace(Q M^-1))`. m
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ExpectedErrors {
    /// From the chosen set.
    pub planned: f64,
    /// From the best of the random sets; infinite where none identifies all that the candidates identify.
    pub best_random: f64,
    /// From the median of the random sets, likewise.
    pub median_random: f64,
    /// How many random sets there are.
    pub random_sets: usize,
    /// How many of those leave a parameter unidentifiable that the candidates identify.
    pub unidentifiable_sets: usize,
}
