//! Which configurations to measure: a set that tells the deflection of the tool best (Klimchik et al. 2017, section 3.2, step i,
//! and its references 64, 65 and 70 for the measure).
//!
//! Random configurations under random loads are drawn ([`candidates`]) and what each would tell is summed up in an information
//! matrix over the numbers of the arm ([`parameters`]). Of these the set is chosen whose covariance M^-1 gives the least variance of
//! the deflection at the test poses, `trace(Q M^-1)` with Q from the derivatives of that deflection, by exchanges from several
//! starts ([`fedorov`]). What `fit` will report is foreseen by its own normal equations ([`expected`]), and what the loads do
//! not show is named with the reason ([`unobservable`]).
//!
//! A deflection is linear in the compliances, so that the covariance does not depend on what they are. The one exception is a
//! joint beside a compensator, whose compliance is linear in its stiffnesses only to first order about the starting robot.

pub mod candidates;
pub mod expected;
pub mod fedorov;
mod job;
mod order;
pub mod parameters;
mod request;
#[cfg(test)]
mod tests;
pub mod unobservable;

pub use job::{Design, DesignError, ExpectedErrors, design_experiment};
pub use request::{Loads, Request, TestCases, Volume};
