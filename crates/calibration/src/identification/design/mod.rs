//! Which configurations to measure: design of experiments for the identification of compliances (Klimchik et al. 2017,
//! section 3.2, step i, and its references 64, 65 and 70 for the criterion).
//!
//! Random configurations under random loads are drawn ([`candidates`]), and the information matrix of each over the
//! parameters of the arm is computed ([`parameters`]). Of these the set is chosen whose covariance M^-1 gives the
//! smallest mean variance of the deflection at the test poses, `trace(Q M^-1)` with Q from the derivatives of that
//! deflection (an I-optimal design), by exchanges from several starts ([`fedorov`]). The standard deviations that an
//! identification will report are predicted by its own normal equations ([`expected`]), and unobservable compliances
//! are named with the reason ([`unobservable`]).
//!
//! A deflection is linear in the compliances, so that the covariance does not depend on their values. The one exception
//! is a joint beside a compensator, whose compliance is linear in its stiffnesses only to first order about the
//! starting robot.

pub mod candidates;
mod error;
pub mod expected;
pub mod fedorov;
mod optimise;
mod order;
pub mod parameters;
mod request;
mod result;
#[cfg(test)]
mod tests;
pub mod unobservable;
mod warnings;

pub use error::DesignError;
pub use optimise::design_experiment;
pub use request::{LoadDirections, Request, TestCases, Volume};
pub use result::{Design, ExpectedErrors};
