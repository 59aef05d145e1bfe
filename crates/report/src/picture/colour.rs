//! Colours.

use plotters::style::RGBColor;
use stead_placement::constraints::ConstraintKind;

/// Frames, ticks and their labels.
pub(super) const INK: RGBColor = RGBColor(60, 60, 60);
/// Things of second rank.
pub(super) const GREY: RGBColor = RGBColor(130, 130, 130);
/// Thin lines of second rank.
pub(super) const PALE: RGBColor = RGBColor(175, 175, 175);
/// Grid lines.
pub(super) const GRID: RGBColor = RGBColor(228, 228, 228);
/// What is best.
pub(super) const GREEN: RGBColor = RGBColor(0, 170, 60);
/// What is worst.
pub(super) const RED: RGBColor = RGBColor(214, 20, 30);
/// Means.
pub(super) const BLUE: RGBColor = RGBColor(110, 140, 190);

/// Components along x, y and z, distinct for the colour-blind too (Okabe and Ito 2008).
pub(super) const COMPONENTS: [RGBColor; 3] = [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115)];
/// Indicators of a robot: accuracy, working radius, payload, price (Okabe and Ito 2008).
pub(super) const INDICATORS: [RGBColor; 4] =
    [RGBColor(0, 114, 178), RGBColor(0, 158, 115), RGBColor(230, 159, 0), RGBColor(204, 121, 167)];
/// The ground of a part of an axis that is meant.
pub(super) const SHADE: RGBColor = RGBColor(248, 244, 230);

/// Levels of the colour scale of deflections.
pub(super) const LEVELS: usize = 32;

/// Points of the colour map viridis (Smith and van der Walt), an eighth apart.
const VIRIDIS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 82, 139],
    [44, 113, 142],
    [33, 145, 140],
    [39, 173, 129],
    [94, 201, 98],
    [170, 220, 50],
    [253, 231, 37],
];

/// The colour of a level, dark for the smallest.
pub(super) fn viridis(level: usize) -> RGBColor {
    let place = level.min(LEVELS - 1) as f64 / (LEVELS - 1) as f64 * 8.0;
    let index = (place.floor() as usize).min(7);
    let part = place - index as f64;
    let mix = |k: usize| {
        let (low, high) = (f64::from(VIRIDIS[index][k]), f64::from(VIRIDIS[index + 1][k]));
        (low + (high - low) * part).round() as u8
    };
    RGBColor(mix(0), mix(1), mix(2))
}

/// Black or white, whichever stands out more from a ground.
pub(super) fn contrast(RGBColor(red, green, blue): RGBColor) -> RGBColor {
    let brightness = 0.2126 * f64::from(red) + 0.7152 * f64::from(green) + 0.0722 * f64::from(blue);
    if brightness > 130.0 { RGBColor(0, 0, 0) } else { RGBColor(255, 255, 255) }
}

/// The pale ground of states that are not allowed.
pub(super) fn ground(blocked: ConstraintKind) -> RGBColor {
    match blocked {
        ConstraintKind::Reach => RGBColor(255, 255, 255),
        ConstraintKind::JointLimit(1) => RGBColor(240, 240, 215),
        ConstraintKind::JointLimit(2) => RGBColor(221, 230, 245),
        ConstraintKind::JointLimit(3) => RGBColor(246, 224, 222),
        ConstraintKind::JointLimit(4) => RGBColor(232, 224, 244),
        ConstraintKind::JointLimit(5) => RGBColor(222, 222, 222),
        ConstraintKind::JointLimit(_) => RGBColor(222, 240, 228),
        _ => RGBColor(248, 248, 248),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_gets_brighter_from_level_to_level() {
        let brightness = |level| {
            let RGBColor(r, g, b) = viridis(level);
            0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
        };
        assert!((1..LEVELS).all(|level| brightness(level) > brightness(level - 1)));
        assert_eq!(viridis(LEVELS), viridis(LEVELS - 1));
    }
}
