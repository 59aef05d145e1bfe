//! What each move of a cutter removes of the stock, and the mean force that this takes.
//!
//! The stock is three grids of lines (dexels), one along each axis of the workpiece. A move removes the cutter swept
//! along it, exactly; what it removes of each line says where on the path, where on the cutter and at which angle the
//! material is cut, and the mean force over a turn is a sum over that.

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

pub mod cut;
pub mod cutting;
pub mod error;
pub mod forces;
pub mod guess;
mod job;
pub mod kept;
pub mod lattice;
pub mod leaning;
pub mod load;
mod memory;
pub mod moves;
pub mod operation;
pub mod outcome;
pub mod piece;
mod points;
pub mod profile;
pub mod quadrature;
mod reach;
pub mod removal;
pub mod solid_lines;
pub mod sums;
pub mod surface;
mod swept;
pub mod tile;
pub mod turn;
mod warnings;
