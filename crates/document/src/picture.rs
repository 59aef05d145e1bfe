//! Pictures: SVG, with coordinates in quarters of a pixel, so that the same result gives the same bytes.

pub mod axes;
pub mod canvas;
pub mod chart;
pub mod colour;
pub mod contour;
pub mod hatch;
pub mod heat_map;
pub mod labels;
pub mod maps;
pub mod merged_cells;
pub mod polar;
