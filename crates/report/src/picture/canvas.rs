//! Drawing in pixels: frames, fills and text on whole ones, curves on quarters of one.

use super::super::output::ReportError;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// A place on the picture: pixels to the right and down from the upper left corner.
pub(super) type Pixel = (i32, i32);
/// The same, between the pixels too.
pub(super) type Place = (f64, f64);
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

/// Whole numbers of the SVG document to a pixel.
const FINENESS: i32 = 4;
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
        self.area.draw(&Rectangle::new([raster(from), raster(to)], colour.filled()))
    }

    /// A filled polygon.
    pub fn polygon(&self, corners: &[Pixel], colour: RGBColor) -> Drawn {
        let corners: Vec<Pixel> = corners.iter().map(|corner| raster(*corner)).collect();
        self.area.draw(&Polygon::new(corners, colour.filled()))
    }

    /// The outline of a rectangle.
    pub fn outline(&self, from: Pixel, to: Pixel, colour: RGBColor) -> Drawn {
        self.line(vec![from, (to.0, from.1), to, (from.0, to.1), from], colour, 1)
    }

    /// A line through pixels.
    pub fn line(&self, points: Vec<Pixel>, colour: RGBColor, width: u32) -> Drawn {
        self.curve(&points.into_iter().map(exact).collect::<Vec<_>>(), colour, width)
    }

    /// A line through any places.
    pub fn curve(&self, points: &[Place], colour: RGBColor, width: u32) -> Drawn {
        let points: Vec<Pixel> = points.iter().map(|place| fine(*place)).collect();
        self.area.draw(&PathElement::new(points, colour.stroke_width(width * FINENESS as u32)))
    }

    /// A line with a white edge that stands out from any ground.
    pub fn edged_curve(&self, points: &[Place], colour: RGBColor, width: u32) -> Drawn {
        self.curve(points, WHITE, width + 3)?;
        self.curve(points, colour, width)
    }

    /// A dashed straight line.
    pub fn dashed(&self, from: Pixel, to: Pixel, colour: RGBColor) -> Drawn {
        let (from, to) = (exact(from), exact(to));
        let length = libm::hypot(to.0 - from.0, to.1 - from.1);
        let at = |along: f64| {
            let part = (along / length).min(1.0);
            (from.0 + (to.0 - from.0) * part, from.1 + (to.1 - from.1) * part)
        };
        let mut along = 0.0;
        while along < length {
            self.curve(&[at(along), at(along + 7.0)], colour, 1)?;
            along += 12.0;
        }
        Ok(())
    }

    /// An arrow with its head at `to`.
    pub fn arrow(&self, from: Place, to: Place, colour: RGBColor, width: u32) -> Drawn {
        self.curve(&[from, to], colour, width)?;
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = libm::hypot(dx, dy).max(1.0);
        let (ux, uy) = (dx / length, dy / length);
        let at = |ahead: f64, aside: f64| fine((to.0 + ahead * ux - aside * uy, to.1 + ahead * uy + aside * ux));
        self.area.draw(&Polygon::new(vec![at(5.0, 0.0), at(-5.0, 4.0), at(-5.0, -4.0)], colour.filled()))
    }

    /// A filled disc with a white edge.
    pub fn dot(&self, centre: Place, radius: i32, colour: RGBColor) -> Drawn {
        let disc = |radius: i32, colour: RGBColor| Circle::new(fine(centre), radius * FINENESS, colour.filled());
        self.area.draw(&disc(radius + 1, WHITE))?;
        self.area.draw(&disc(radius, colour))
    }

    /// A text.
    pub fn text(&self, text: &str, place: Pixel, lettering: Lettering) -> Drawn {
        let weight = if lettering.bold { FontStyle::Bold } else { FontStyle::Normal };
        let transform = if lettering.upwards { FontTransform::Rotate270 } else { FontTransform::None };
        let style = ("sans-serif", lettering.size * FONT_SCALE * f64::from(FINENESS), weight)
            .into_font()
            .transform(transform)
            .color(&lettering.colour)
            .pos(Pos::new(lettering.horizontal, lettering.vertical));
        self.area.draw(&Text::new(text.to_owned(), raster(place), style))
    }
}

/// The place of a pixel.
pub(super) fn exact(pixel: Pixel) -> Place {
    (f64::from(pixel.0), f64::from(pixel.1))
}

/// The pixel nearest to a place.
pub(super) fn nearest(place: Place) -> Pixel {
    (place.0.round() as i32, place.1.round() as i32)
}

fn raster(pixel: Pixel) -> Pixel {
    (pixel.0 * FINENESS, pixel.1 * FINENESS)
}

fn fine(place: Place) -> Pixel {
    nearest((place.0 * f64::from(FINENESS), place.1 * f64::from(FINENESS)))
}

/// Draws a picture of the given size in pixels on white and returns the SVG document.
///
/// # Errors
/// [`ReportError::Format`] naming `what`.
pub(super) fn picture(
    what: &'static str,
    size: Pixel,
    paint: impl FnOnce(&Canvas<'_>) -> Drawn,
) -> Result<String, ReportError> {
    let mut document = String::new();
    paint_on(&mut document, size, paint).map_err(|error| ReportError::Format { what, cause: error.to_string() })?;
    let (width, height) = raster(size);
    let fine = format!("width=\"{width}\" height=\"{height}\"");
    // Opaque is the default of SVG: saying so on every element is a seventh of the file.
    let document = document.replace(" opacity=\"1\"", "");
    Ok(document.replacen(&fine, &format!("width=\"{}\" height=\"{}\"", size.0, size.1), 1))
}

fn paint_on(document: &mut String, size: Pixel, paint: impl FnOnce(&Canvas<'_>) -> Drawn) -> Drawn {
    let (width, height) = raster(size);
    let canvas = Canvas { area: SVGBackend::with_string(document, (width as u32, height as u32)).into_drawing_area() };
    canvas.area.fill(&WHITE)?;
    paint(&canvas)?;
    canvas.area.present()
}
