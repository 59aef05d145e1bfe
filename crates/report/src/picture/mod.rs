//! Pictures: SVG, with coordinates in quarters of a pixel, so that the same result gives the same bytes.

mod arm_view;
mod axes;
mod canvas;
mod cell;
mod cell_view;
mod chart;
mod circularity_map;
mod circularity_panel;
mod colour;
mod contour;
mod convergence;
mod cutting;
mod deflection_map;
mod hatch;
mod heat_map;
mod indicators;
mod labels;
mod line_chart;
mod measurement_plan;
mod merged_cells;
mod open_region;
mod path_stability;
mod plane_view;
mod polar;
mod setup_sheet;
mod study;
mod surroundings;

pub use arm_view::{arm_alone, arm_of_run};
pub use cell::{cell, cell_with};
pub use chart::charts;
pub use circularity_map::circularity_map;
pub(crate) use colour::of_deflection;
pub use convergence::convergence;
pub use cutting::cutting;
pub use deflection_map::deflection_map;
pub(crate) use heat_map::ColourRange;
pub use indicators::indicators;
pub use measurement_plan::measurement_plan;
pub use open_region::open_region;
pub use path_stability::path_stability;
pub(crate) use plane_view::PlaneView;
pub use polar::polar;
pub use setup_sheet::{SheetTitle, setup_sheet};
pub use study::{effects as study_effects, front as study_front, map as study_map};
pub use surroundings::surroundings;

#[cfg(test)]
mod assessment_tests;
