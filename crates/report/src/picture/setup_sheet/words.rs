//! Figures and texts of a setup sheet.

use crate::units::fixed;

/// The end of a text that is too long.
pub(super) fn shortened(text: &str, most: usize) -> String {
    let count = text.chars().count();
    if count <= most {
        return text.to_owned();
    }
    format!("..{}", text.chars().skip(count + 2 - most).collect::<String>())
}

/// A length in mm, to a tenth. From m
pub(super) fn mm(length: f64) -> String {
    fixed(length * 1e3, 1)
}

/// An angle in deg, to a hundredth. From rad
pub(super) fn deg(angle: f64) -> String {
    fixed(angle.to_degrees(), 2)
}
