//! Pictures: SVG, with coordinates in quarters of a pixel, so that the same result gives the same bytes.

mod arm_view;
mod cell;
mod cell_view;
mod convergence;
mod deflection_map;
mod indicators;
mod measurement_plan;
mod open_region;
mod path_stability;
mod plane_view;
mod setup_sheet;
mod surroundings;

use stead_document::picture::{axes, canvas, chart, colour, hatch, heat_map, labels};

pub use arm_view::{arm_alone, arm_of_run};
pub use cell::{cell, cell_with};
pub use convergence::convergence;
pub use deflection_map::deflection_map;
pub use indicators::indicators;
pub use measurement_plan::measurement_plan;
pub use open_region::open_region;
pub use path_stability::path_stability;
pub(crate) use plane_view::PlaneView;
pub use setup_sheet::{SheetTitle, setup_sheet};
pub use stead_document::picture::chart::charts;
pub(crate) use stead_document::picture::colour::of_deflection;
pub(crate) use stead_document::picture::heat_map::ColourRange;
pub use stead_document::picture::maps::heat_maps;
pub use stead_document::picture::polar::polar;
pub use surroundings::surroundings;

#[cfg(test)]
mod assessment_tests;
