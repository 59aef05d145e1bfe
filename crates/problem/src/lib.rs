//! What may vary at a placement, what must hold and what is scored, and the states of the arm under it.
//!
//! - [`problem`]: what may vary, what must hold; [`placement`], [`cell`]: where the part is and may be; [`setup`]: with
//!   which side up it lies, where external axes stand; [`lean`]: how far the tool may lean; [`settings`]: how hard to
//!   search.
//! - [`evaluate`]: the score of a state of the arm, one at a time with derivatives, or a batch of states at once.
//! - [`criterion`]: which part of the deflection is scored, and how points make up one figure; [`objective`]: that of a
//!   problem; [`candidate`]: a placement with its objective value; [`sense`]: minimise or maximise.
//! - [`constraints`]: what a plan must satisfy, by kind, with signed margins; [`limit`]: which limits can hold an
//!   optimum; [`postures`], [`joint_travel`]: which postures a plan may have, how much its joints turn.
//! - [`collision`], [`straight_move`]: shapes along a plan, and whether the arm follows a straight move of the tool;
//!   [`segment_plan`]: the plan of a segment; [`beta_step`]: how far beta may turn from point to point.
//! - [`symmetry`]: upright tools; [`table_shape`]: the lookup table that they allow.
//!
//! Where the paper (Caro et al. 2013) leaves a choice or has a misprint, it is done as follows. Eq. 8 is a plain
//! rotation about z. The compliance is `J K_theta^-1 J^T` without a complementary term. kappa_F carries the factor 1/6
//! that makes the published bound of 0.2 possible.

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

pub mod beta_step;
pub mod candidate;
pub mod cell;
pub mod collision;
pub mod constraints;
pub mod criterion;
pub mod evaluate;
pub mod joint_travel;
pub mod lean;
pub mod limit;
pub mod objective;
pub mod placement;
pub mod postures;
pub mod problem;
pub mod segment_plan;
pub mod sense;
pub mod settings;
pub mod setup;
pub mod straight_move;
pub mod symmetry;
pub mod table_shape;

#[cfg(any(test, feature = "testing"))]
pub mod testing;
