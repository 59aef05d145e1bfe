//! Pictures: SVG, with coordinates in quarters of a pixel, so that the same result gives the same bytes.

mod axes;
mod canvas;
mod cell;
mod colour;
mod convergence;
mod cutting;
mod deflection_map;
mod hatch;
mod polar;
mod scene;

pub use cell::cell;
pub use convergence::convergence;
pub use cutting::cutting;
pub use deflection_map::deflection_map;
pub use polar::polar;
