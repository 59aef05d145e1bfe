//! Colours.

use std::fmt;

/// Red, green and blue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:02X}{:02X}{:02X}", self.0, self.1, self.2)
    }
}

/// Text, and what is as it is.
pub const BLACK: Colour = Colour(0, 0, 0);
/// The ground of every picture.
pub const WHITE: Colour = Colour(255, 255, 255);

/// Frames, ticks and their labels.
pub const INK: Colour = Colour(60, 60, 60);
/// Things of second rank.
pub const GREY: Colour = Colour(130, 130, 130);
/// Thin lines of second rank.
pub const PALE: Colour = Colour(175, 175, 175);
/// Grid lines.
pub const GRID: Colour = Colour(228, 228, 228);
/// What is best: that of the pages in daylight. No two things differ by red and green alone.
pub const BEST: Colour = Colour(0, 105, 166);
/// What is worst.
pub const WORST: Colour = Colour(184, 74, 0);
/// What is shown of a thing, beside orange distinct for the colour-blind too (Okabe and Ito 2008).
pub const TEAL: Colour = Colour(0, 158, 115);
/// What stands out: loads, hits, points left out.
pub const ORANGE: Colour = Colour(213, 94, 0);
/// Means.
pub const BLUE: Colour = Colour(110, 140, 190);

/// Series of a chart: those of the pages in daylight.
pub const SERIES: [Colour; 6] = [
    Colour(59, 76, 192),
    Colour(31, 143, 138),
    Colour(194, 106, 0),
    Colour(160, 48, 127),
    Colour(90, 125, 0),
    Colour(122, 74, 43),
];
/// Indicators of a robot: accuracy, working radius, payload, price (Okabe and Ito 2008).
pub const INDICATORS: [Colour; 4] =
    [Colour(0, 114, 178), Colour(0, 158, 115), Colour(230, 159, 0), Colour(204, 121, 167)];

/// Levels of the colour scale of deflections.
pub const LEVELS: usize = 32;

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
pub fn viridis(level: usize) -> Colour {
    let [red, green, blue] = at(level.min(LEVELS - 1) as f64 / (LEVELS - 1) as f64).map(|part| part.round() as u8);
    Colour(red, green, blue)
}

/// The colour at a place of the scale, from 0 to 1, in parts up to 255.
fn at(place: f64) -> [f64; 3] {
    let place = place.clamp(0.0, 1.0) * 8.0;
    let index = (place.floor() as usize).min(7);
    let part = place - index as f64;
    std::array::from_fn(|k| {
        let (low, high) = (f64::from(VIRIDIS[index][k]), f64::from(VIRIDIS[index + 1][k]));
        low + (high - low) * part
    })
}

/// The ends of the logarithmic scale on which scenes show deflections. m
const DEFLECTIONS: [f64; 2] = [5e-6, 5e-3];

/// The colour of a deflection (m) in scenes: red, green and blue, sRGB from 0 to 1.
pub fn of_deflection(deflection: f64) -> [f32; 3] {
    let [low, high] = DEFLECTIONS;
    let place = libm::log(deflection.abs().max(low) / low) / libm::log(high / low);
    at(place).map(|part| (part / 255.0) as f32)
}

/// Black or white, whichever stands out more from a ground.
pub fn contrast(ground: Colour) -> Colour {
    let Colour(red, green, blue) = ground;
    let brightness = 0.2126 * f64::from(red) + 0.7152 * f64::from(green) + 0.0722 * f64::from(blue);
    if brightness > 130.0 { BLACK } else { WHITE }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_gets_brighter_from_level_to_level() {
        let brightness = |level| {
            let Colour(r, g, b) = viridis(level);
            0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
        };
        assert!((1..LEVELS).all(|level| brightness(level) > brightness(level - 1)));
        assert_eq!(viridis(LEVELS), viridis(LEVELS - 1));
    }
}
