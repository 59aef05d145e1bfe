//! The stock of a new file, where none is named: that which the path itself tells.

use crate::forces::rounded_mm;
use stead_format::written::commented;
use stead_model::cutting::{Coefficients, Cutter, Rotation};
use stead_model::task::ToolPath;
use stead_numerics::monitor::Monitor;
use stead_removal::guess::{StockGuess, stock_of};
use stead_removal::operation::EndMill;

/// A key of `[stock]` that is guessed.
pub(super) struct Guess {
    pub key: &'static str,
    value: String,
    /// What tells it.
    comment: &'static str,
}

impl Guess {
    /// The stock of a path that a cutter of a diameter and a corner radius (mm) takes.
    pub fn of_path(path: &ToolPath, diameter: f64, corner: f64) -> Self {
        let told = told_by_path(path, diameter, corner).and_then(|StockGuess { stock, told_by }| {
            let depth = stock.depth.map(|depth| ("depth_mm", depth));
            let (key, length) = depth.or(stock.layer.map(|layer| ("layer_mm", layer)))?;
            Some(Self { key, value: format!("{:?}", rounded_mm(length)), comment: told_by.words() })
        });
        let half = diameter / 2.0;
        let allowance = || Self {
            key: "allowance_mm",
            value: format!("[{half:?}, {half:?}, 2.0]"),
            comment: "the path tells no depth: a box about it",
        };
        told.unwrap_or_else(allowance)
    }

    /// The row of the file.
    pub fn row(&self) -> String {
        commented(&format!("{} = {}", self.key, self.value), self.comment).trim_end().to_owned()
    }
}

fn told_by_path(path: &ToolPath, diameter: f64, corner: f64) -> Option<StockGuess> {
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
    stock_of(path, &mill, &Monitor::silent()).ok()
}
