//! Diagonal hatching of any region, in few and long lines.

use super::canvas::{Canvas, Pixel};
use super::colour::Colour;
use super::labels::Area;

/// Which way the lines of a hatching run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slope {
    /// From lower left to upper right.
    Up,
    /// From upper left to lower right.
    Down,
}

/// Distance of the lines across. Pixels
const SPACING: usize = 9;

/// Hatches those pixels of an area for which `inside` holds.
pub fn hatch(canvas: &mut Canvas, area: Area, slope: Slope, colour: Colour, inside: impl Fn(Pixel) -> bool) {
    for (start, end) in lines(area, slope, inside) {
        canvas.line(&[start, end], colour, 1);
    }
}

fn lines(area: Area, slope: Slope, inside: impl Fn(Pixel) -> bool) -> Vec<(Pixel, Pixel)> {
    let (from, to) = area;
    let (width, height) = (to.0 - from.0, to.1 - from.1);
    let mut lines = Vec::new();
    for offset in (0..width + height).step_by(SPACING) {
        // Pixels of one diagonal, by rows from the top.
        let pixels = (0..height).filter_map(|row| {
            let column = match slope {
                Slope::Up => offset - row,
                Slope::Down => offset - height + row,
            };
            (0..width).contains(&column).then_some((from.0 + column, from.1 + row))
        });
        let mut run: Option<(Pixel, Pixel)> = None;
        for pixel in pixels {
            if inside(pixel) {
                run = Some(run.map_or((pixel, pixel), |(start, _)| (start, pixel)));
            } else {
                lines.extend(run.take());
            }
        }
        lines.extend(run);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stay_inside_and_run_the_right_way() {
        let inside = |(x, y): Pixel| (20..60).contains(&x) && (30..50).contains(&y);
        for (slope, sign) in [(Slope::Up, -1), (Slope::Down, 1)] {
            let lines = lines(((0, 0), (100, 80)), slope, inside);
            assert!(lines.len() >= 6);
            for (start, end) in lines {
                assert!(inside(start) && inside(end));
                assert_eq!(end.0 - start.0, sign * (end.1 - start.1));
            }
        }
    }
}
