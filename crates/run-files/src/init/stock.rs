//! The stock of a new file, where none is named: that which the path itself tells.

use crate::forces::rounded_mm;
use stead_model::cutting::{Coefficients, Cutter, Rotation};
use stead_model::task::ToolPath;
use stead_numerics::monitor::Monitor;
use stead_removal::guess::stock_of;
use stead_removal::operation::EndMill;

/// A row of `[stock]` for a path that a cutter of a diameter and a corner radius (mm) takes, with what tells it.
pub(super) fn of_path(path: &ToolPath, diameter: f64, corner: f64) -> Option<(String, &'static str)> {
    let radius = diameter / 2e3;
    let cutter = Cutter::even(2, radius, 0.0, Rotation::Clockwise, Coefficients::default()).ok()?;
    let mill = EndMill {
        cutter,
        flute_length: 3.0 * diameter * 1e-3,
        corner_radius: (corner * 1e-3).min(radius),
        taper: 0.0,
        is_centre_cutting: true,
        holder: Vec::new(),
    };
    let guess = stock_of(path, &mill, &Monitor::silent()).ok()?;
    let row = |key: &str, metres: f64| format!("{key} = {:?}", rounded_mm(metres));
    let stock = guess.stock;
    let row = stock.depth.map(|depth| row("depth_mm", depth)).or(stock.layer.map(|layer| row("layer_mm", layer)))?;
    Some((row, guess.told_by.words()))
}
