//! Pictures: SVG, made with whole pixel coordinates so that the same result gives the same bytes.

mod axes;
mod canvas;
mod cell;
mod colour;
mod convergence;
mod deflection_map;
mod hatch;

pub use cell::cell;
pub use convergence::convergence;
pub use deflection_map::deflection_map;
