//! Drawing in whole pixels.

use super::super::output::ReportError;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// A place on the picture: pixels to the right and down from the upper left corner.
pub(super) type Pixel = (i32, i32);
/// What a failed drawing says.
pub(super) type DrawError = DrawingAreaErrorKind<std::io::Error>;
/// The result of drawing something.
pub(super) type Drawn = Result<(), DrawError>;

/// A picture being drawn.
pub(super) struct Canvas<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
}

/// Where a text stands relative to its place, and how it looks.
#[derive(Clone, Copy)]
pub(super) struct Lettering {
    /// Height of the letters in pixels.
    pub size: f64,
    /// Colour.
    pub colour: RGBColor,
    /// Whether the text is bold.
    pub bold: bool,
    /// Which end of the text is at the place.
    pub horizontal: HPos,
    /// Which height of the text is at the place.
    pub vertical: VPos,
    /// Whether the text runs upwards.
    pub upwards: bool,
}

/// Plotters divides font sizes by this on the way to SVG.
const FONT_SCALE: f64 = 1.24;

impl Lettering {
    /// Black text that starts at its place.
    pub fn new(size: f64) -> Self {
        let (horizontal, vertical) = (HPos::Left, VPos::Center);
        Self { size, colour: BLACK, bold: false, horizontal, vertical, upwards: false }
    }

    /// Centred at its place.
    pub fn centred(self) -> Self {
        Self { horizontal: HPos::Center, ..self }
    }

    /// Ending at its place.
    pub fn ending(self) -> Self {
        Self { horizontal: HPos::Right, ..self }
    }

    /// In another colour.
    pub fn coloured(self, colour: RGBColor) -> Self {
        Self { colour, ..self }
    }

    /// In bold.
    pub fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    /// Running upwards.
    pub fn upwards(self) -> Self {
        Self { upwards: true, ..self }
    }

    /// Width of a text, estimated on the wide side. Pixels
    pub fn width(self, text: &str) -> i32 {
        (text.chars().count() as f64 * self.size * 0.6).ceil() as i32
    }
}

impl Canvas<'_> {
    /// A filled rectangle between two corners.
    pub fn fill(&self, from: Pixel, to: Pixel, colour: RGBColor) -> Drawn {
        self.area.draw(&Rectangle::new([from, to], colour.filled()))
    }

    /// The outline of a rectangle.
    pub fn outline(&self, from: Pixel, to: Pixel, colour: RGBColor) -> Drawn {
        self.area.draw(&Rectangle::new([from, to], colour.stroke_width(1)))
    }

    /// A line through points.
    pub fn line(&self, points: Vec<Pixel>, colour: RGBColor, width: u32) -> Drawn {
        self.area.draw(&PathElement::new(points, colour.stroke_width(width)))
    }

    /// A line with a white edge that stands out from any ground.
    pub fn edged_line(&self, points: Vec<Pixel>, colour: RGBColor, width: u32) -> Drawn {
        self.line(points.clone(), WHITE, width + 3)?;
        self.line(points, colour, width)
    }

    /// A dashed straight line.
    pub fn dashed(&self, from: Pixel, to: Pixel, colour: RGBColor) -> Drawn {
        let (dx, dy) = (f64::from(to.0 - from.0), f64::from(to.1 - from.1));
        let length = libm::hypot(dx, dy);
        let at = |along: f64| {
            let part = (along / length).min(1.0);
            (from.0 + (dx * part).round() as i32, from.1 + (dy * part).round() as i32)
        };
        let mut along = 0.0;
        while along < length {
            self.line(vec![at(along), at(along + 7.0)], colour, 1)?;
            along += 12.0;
        }
        Ok(())
    }

    /// An arrow with its head at `to`.
    pub fn arrow(&self, from: Pixel, to: Pixel, colour: RGBColor, width: u32) -> Drawn {
        self.line(vec![from, to], colour, width)?;
        let (dx, dy) = (f64::from(to.0 - from.0), f64::from(to.1 - from.1));
        let length = libm::hypot(dx, dy).max(1.0);
        let (ux, uy) = (dx / length, dy / length);
        let (tip, head) = ((f64::from(to.0) + 4.0 * ux, f64::from(to.1) + 4.0 * uy), 9.0);
        let corner = |side: f64| {
            let x = tip.0 - head * ux - side * uy;
            let y = tip.1 - head * uy + side * ux;
            (x.round() as i32, y.round() as i32)
        };
        let tip = (tip.0.round() as i32, tip.1.round() as i32);
        self.area.draw(&Polygon::new(vec![tip, corner(4.0), corner(-4.0)], colour.filled()))
    }

    /// A filled disc with a white edge.
    pub fn dot(&self, centre: Pixel, radius: u32, colour: RGBColor) -> Drawn {
        self.area.draw(&Circle::new(centre, radius + 1, WHITE.filled()))?;
        self.area.draw(&Circle::new(centre, radius, colour.filled()))
    }

    /// A text.
    pub fn text(&self, text: &str, place: Pixel, lettering: Lettering) -> Drawn {
        let weight = if lettering.bold { FontStyle::Bold } else { FontStyle::Normal };
        let transform = if lettering.upwards { FontTransform::Rotate270 } else { FontTransform::None };
        let style = ("sans-serif", lettering.size * FONT_SCALE, weight)
            .into_font()
            .transform(transform)
            .color(&lettering.colour)
            .pos(Pos::new(lettering.horizontal, lettering.vertical));
        self.area.draw(&Text::new(text.to_owned(), place, style))
    }
}

/// Draws a picture of the given size on white and returns the SVG document.
///
/// # Errors
/// [`ReportError::Format`] naming `what`.
pub(super) fn picture(
    what: &'static str,
    size: (u32, u32),
    paint: impl FnOnce(&Canvas<'_>) -> Drawn,
) -> Result<String, ReportError> {
    let mut document = String::new();
    paint_on(&mut document, size, paint).map_err(|error| ReportError::Format { what, cause: error.to_string() })?;
    // Opaque is the default of SVG: saying so on every element is a seventh of the file.
    Ok(document.replace(" opacity=\"1\"", ""))
}

fn paint_on(document: &mut String, size: (u32, u32), paint: impl FnOnce(&Canvas<'_>) -> Drawn) -> Drawn {
    let canvas = Canvas { area: SVGBackend::with_string(document, size).into_drawing_area() };
    canvas.area.fill(&WHITE)?;
    paint(&canvas)?;
    canvas.area.present()
}
