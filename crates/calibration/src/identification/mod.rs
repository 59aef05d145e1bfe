//! From measurements to joint compliances, with their uncertainty (Klimchik et al. 2017, section 3.2).
//!
//! Makers publish no stiffness. It is identified by loading the arm at known joint angles with a known wrench and
//! measuring the displacement of some reference points. [`identify`] takes such a [`Sheet`] through these steps:
//!
//! 1. [`setup`]: poses of tracker and reference points, from the unloaded readings alone (eq. 24);
//! 2. [`model`], [`response`]: deflections as linear functions of the compliances (eq. 16, 20) about the arm as it
//!    rests under its loads ([`deflected`]), the joint beside a compensator having one for each distinct angle;
//!    Sought are the springs about the joint axes alone, or those about three directions of every joint ([`springs`]),
//!    the latter in a gauge that [`gauge`] fixes, since not all of them can be told apart;
//! 3. [`normal_equations`]: least squares with covariance (eq. 18, 19, 23), and which parameters are identifiable;
//! 4. [`outliers`]: a robust estimate, and readings that deviate from the others by more than noise;
//! 5. [`law`]: from the compliances at distinct angles to joint stiffness, spring stiffness and free length (eq. 21,
//!    22);
//! 6. [`cross_validation`]: the error of predicting a configuration that was left out;
//! 7. whether the readings agree with where the load is said to act, and their residuals with the scatter of the
//!    unloaded ones.
//!
//! Nothing is regularised: unidentifiable compliances are refused by name, or on request held at their value in the
//! starting robot. [`design`] chooses the measurements.

mod assemble;
mod bounded;
pub mod cross_validation;
pub mod deflected;
pub mod design;
pub mod distribution;
pub mod elastic;
mod equilibria;
mod error;
pub mod gauge;
mod identify;
mod inverse;
pub mod law;
mod load_point;
mod made;
pub mod model;
pub mod normal_equations;
pub mod outcome;
pub mod outliers;
mod problem;
pub mod response;
pub mod setup;
pub mod sheet;
pub mod spring;
pub mod springs;
pub mod synthetic;
#[cfg(test)]
mod tests;
mod warnings;

pub use error::{IdentifyError, SheetFault};
pub use identify::identify;
pub use outcome::{Estimate, Held, HeldReason, Identified, RowResult};
pub use problem::Problem;
pub use sheet::{Configuration, LoadCase, Reading, Sheet};
pub use springs::FitModel;
