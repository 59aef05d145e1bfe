//! Axes: scales from numbers to pixels, ticks at round numbers, and a frame with labels.

use super::canvas::{Canvas, Pixel, Place, TextStyle};
use super::colour::{GRID, INK};
use crate::units::fixed;
use std::borrow::Cow;

/// A linear scale from numbers to pixels.
#[derive(Clone, Copy)]
pub struct Scale {
    /// Number at the first pixel.
    pub from: f64,
    /// Number at the last pixel.
    pub to: f64,
    /// First pixel.
    pub start: i32,
    /// Last pixel.
    pub end: i32,
}

impl Scale {
    /// A scale; a range without width is widened a little.
    pub fn new(from: f64, to: f64, start: i32, end: i32) -> Self {
        if to > from { Self { from, to, start, end } } else { Self { from: from - 0.5, to: from + 0.5, start, end } }
    }

    /// The pixel of a number.
    pub fn pixel(&self, value: f64) -> i32 {
        self.place(value).round() as i32
    }

    /// The place of a number between the pixels.
    pub fn place(&self, value: f64) -> f64 {
        let part = (value - self.from) / (self.to - self.from);
        f64::from(self.start) + part * f64::from(self.end - self.start)
    }

    /// The number at a place.
    pub fn number(&self, place: f64) -> f64 {
        let part = (place - f64::from(self.start)) / f64::from(self.end - self.start);
        self.from + part * (self.to - self.from)
    }

    /// The pixel of a number, the nearest end for a number beyond the scale.
    pub fn clamped(&self, value: f64) -> i32 {
        self.pixel(value.max(self.from).min(self.to))
    }
}

/// Numbers at which an axis has ticks, and how many decimals their labels need.
pub struct Ticks {
    /// The numbers, ascending.
    pub values: Vec<f64>,
    /// Decimals of the labels.
    pub decimals: usize,
    /// Whether the labels are powers of ten with the numbers as exponents.
    pub of_ten: bool,
    /// Labels in place of numbers: that of 0, of 1, and so on.
    pub names: Vec<String>,
}

impl Ticks {
    /// No ticks at all.
    pub fn none() -> Self {
        Self { values: vec![], decimals: 0, of_ten: false, names: vec![] }
    }

    /// Multiples of 1, 2 or 5 times a power of ten, at most `max` of them.
    pub fn round(scale: &Scale, max: usize) -> Self {
        let room = (scale.to - scale.from) / max.max(1) as f64;
        for exponent in -9..=9_i32 {
            for digit in [1.0, 2.0, 5.0] {
                let step = digit * libm::pow(10.0, f64::from(exponent));
                if step >= room {
                    return Self::every(scale, step, (-exponent).max(0) as usize);
                }
            }
        }
        Self { values: vec![scale.from, scale.to], ..Self::none() }
    }

    /// Multiples of a step.
    pub fn every(scale: &Scale, step: f64, decimals: usize) -> Self {
        let (first, last) = ((scale.from / step - 1e-9).ceil() as i64, (scale.to / step + 1e-9).floor() as i64);
        Self { values: (first..=last).map(|k| k as f64 * step).collect(), decimals, ..Self::none() }
    }

    /// Whole exponents on a scale of common logarithms: of many decades every second, third and so on.
    pub fn decades(scale: &Scale) -> Self {
        let step = ((scale.to - scale.from) / 8.0).ceil().max(1.0);
        Self { of_ten: true, ..Self::every(scale, step, 0) }
    }

    /// Names at 0, 1, 2 and so on.
    pub fn named(names: Vec<String>) -> Self {
        Self { values: (0..names.len()).map(|k| k as f64).collect(), names, ..Self::none() }
    }

    /// The label of a tick.
    pub fn label(&self, value: f64) -> String {
        if let Some(name) = self.names.get(value as usize) {
            return name.clone();
        }
        if self.of_ten && value < -4.0 {
            return format!("1e{}", fixed(value, 0));
        }
        if self.of_ten {
            let decimals = (-value).max(0.0).round() as usize;
            return fixed(libm::pow(10.0, value), decimals);
        }
        fixed(value, self.decimals)
    }
}

/// Two axes and what stands at them.
pub struct Panel {
    /// Horizontal scale.
    pub x: Scale,
    /// Vertical scale; its first pixel is at the bottom.
    pub y: Scale,
    /// Ticks of the horizontal axis.
    pub x_ticks: Ticks,
    /// Ticks of the vertical axis.
    pub y_ticks: Ticks,
    /// Label of the horizontal axis, with its unit.
    pub x_label: Cow<'static, str>,
    /// Label of the vertical axis, with its unit.
    pub y_label: Cow<'static, str>,
}

/// The smallest and the largest of some numbers and two given ones.
pub fn extent(given: [f64; 2], values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    values.into_iter().fold(given, |[low, high], value| [low.min(value), high.max(value)])
}

/// A rectangle of the plane: its lowest and its highest coordinates.
pub type Window = [[f64; 2]; 2];

/// The smallest rectangle around points; none around no points.
pub fn around(points: impl IntoIterator<Item = [f64; 2]>) -> Option<Window> {
    let windows = points.into_iter().map(|point| [point, point]);
    windows
        .reduce(|[low, high], [point, _]| [[0, 1].map(|k| low[k].min(point[k])), [0, 1].map(|k| high[k].max(point[k]))])
}

/// The square around points, half as wide as that part of what they take, or of 100 if that is more.
pub fn square_around(points: impl IntoIterator<Item = [f64; 2]>, part: f64) -> Window {
    let [low, high] = around(points).unwrap_or_default();
    let half = part * (high[0] - low[0]).max(high[1] - low[1]).max(100.0);
    [-half, half].map(|by| [0, 1].map(|k| (low[k] + high[k]) / 2.0 + by))
}

impl Panel {
    /// A square panel that shows a window, by its upper left corner.
    pub fn square(shown: Window, corner: Pixel, side: i32, labels: [&'static str; 2]) -> Self {
        let ([low, high], (left, top)) = (shown, corner);
        let (x, y) = (Scale::new(low[0], high[0], left, left + side), Scale::new(low[1], high[1], top + side, top));
        Self::new(x, y, [8, 8], labels)
    }

    /// A panel with at most so many ticks at round numbers along each axis.
    pub fn new(x: Scale, y: Scale, ticks: [usize; 2], labels: [impl Into<Cow<'static, str>>; 2]) -> Self {
        let [x_label, y_label] = labels.map(Into::into);
        Self { x_ticks: Ticks::round(&x, ticks[0]), y_ticks: Ticks::round(&y, ticks[1]), x, y, x_label, y_label }
    }

    /// The place of a point.
    pub fn place(&self, x: f64, y: f64) -> Place {
        (self.x.place(x), self.y.place(y))
    }

    /// Thin lines at the ticks, to be drawn before the content.
    pub fn draw_grid(&self, canvas: &mut Canvas) {
        for value in &self.x_ticks.values {
            let x = self.x.pixel(*value);
            canvas.line(&[(x, self.y.start), (x, self.y.end)], GRID, 1);
        }
        for value in &self.y_ticks.values {
            let y = self.y.pixel(*value);
            canvas.line(&[(self.x.start, y), (self.x.end, y)], GRID, 1);
        }
    }

    /// Frame, ticks and labels, to be drawn after the content.
    pub fn draw_frame(&self, canvas: &mut Canvas) {
        let (left, right, bottom, top) = (self.x.start, self.x.end, self.y.start, self.y.end);
        canvas.outline((left, top), (right, bottom), INK);
        let style = TextStyle::new(12.0).coloured(INK);
        for value in &self.x_ticks.values {
            let x = self.x.pixel(*value);
            canvas.line(&[(x, bottom), (x, bottom + 5)], INK, 1);
            canvas.text(&self.x_ticks.label(*value), (x, bottom + 14), style.centred());
        }
        let mut widest = 0;
        for value in &self.y_ticks.values {
            let y = self.y.pixel(*value);
            let label = self.y_ticks.label(*value);
            widest = widest.max(style.width(&label));
            canvas.line(&[(left - 5, y), (left, y)], INK, 1);
            canvas.text(&label, (left - 8, y), style.ending());
        }
        let style = TextStyle::new(13.0).centred();
        canvas.text(&self.x_label, ((left + right) / 2, bottom + 34), style);
        canvas.text(&self.y_label, (left - 8 - widest - 14, (top + bottom) / 2), style.upwards())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers_inside_the_scale() {
        let ticks = Ticks::round(&Scale::new(0.0, 0.62, 0, 100), 8);
        let labels: Vec<_> = ticks.values.iter().map(|v| ticks.label(*v)).collect();
        assert_eq!(labels, ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6"]);
        let ticks = Ticks::round(&Scale::new(-2700.0, 300.0, 0, 100), 7);
        let labels: Vec<_> = ticks.values.iter().map(|v| ticks.label(*v)).collect();
        assert_eq!(labels, ["-2500", "-2000", "-1500", "-1000", "-500", "0"]);
        assert!(Ticks::round(&Scale::new(3.0, 3.0, 0, 10), 5).values.contains(&3.0));
        let ticks = Ticks::decades(&Scale::new(-2.3, 1.7, 0, 100));
        let labels: Vec<_> = ticks.values.iter().map(|v| ticks.label(*v)).collect();
        assert_eq!(labels, ["0.01", "0.1", "1", "10"]);
        let ticks = Ticks::decades(&Scale::new(-9.5, 1.2, 0, 100));
        let labels: Vec<_> = ticks.values.iter().map(|v| ticks.label(*v)).collect();
        assert_eq!(labels, ["1e-8", "1e-6", "0.0001", "0.01", "1"]);
        let ticks = Ticks::named(["low", "high"].map(str::to_owned).to_vec());
        let labels: Vec<_> = ticks.values.iter().map(|v| ticks.label(*v)).collect();
        assert_eq!(labels, ["low", "high"]);
    }
}
