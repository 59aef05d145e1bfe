//! Drawing to SVG in pixels: frames, fills and text on whole ones, curves on quarters of one.

use super::colour::{BEST, BLACK, Colour, WHITE, WORST};

/// A place on the picture: pixels to the right and down from the upper left corner.
pub type Pixel = (i32, i32);
/// The same, between the pixels too.
pub type Place = (f64, f64);

/// A picture being drawn: the SVG document so far.
pub struct Canvas {
    document: String,
    /// Whether the document states once for all texts what most of them are: black, from the left, in one family.
    is_brief: bool,
}

/// Which end of a text is at its place.
#[derive(Clone, Copy)]
enum Anchor {
    Start,
    Middle,
    End,
}

/// Where a text stands relative to its place, and how it looks. Its middle is at the height of the place.
#[derive(Clone, Copy)]
pub struct TextStyle {
    /// Height of the letters in pixels.
    size: f64,
    colour: Colour,
    is_bold: bool,
    anchor: Anchor,
    runs_upwards: bool,
}

/// How a line is drawn: what is best is whole and what is worst in strokes, so that nobody needs the colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LineStyle {
    /// Its colour.
    pub colour: Colour,
    /// Whether it is in strokes.
    pub is_dashed: bool,
}

impl From<Colour> for LineStyle {
    /// A whole line.
    fn from(colour: Colour) -> Self {
        Self { colour, is_dashed: false }
    }
}

/// The line of what is best.
pub const BEST_LINE: LineStyle = LineStyle { colour: BEST, is_dashed: false };
/// The line of what is worst.
pub const WORST_LINE: LineStyle = LineStyle { colour: WORST, is_dashed: true };

/// Whole numbers of the SVG document to a pixel.
const FINENESS: i32 = 4;

impl TextStyle {
    /// Black text that starts at its place.
    pub fn new(size: f64) -> Self {
        Self { size, colour: BLACK, is_bold: false, anchor: Anchor::Start, runs_upwards: false }
    }

    /// Centred at its place.
    pub fn centred(self) -> Self {
        Self { anchor: Anchor::Middle, ..self }
    }

    /// Ending at its place.
    pub fn ending(self) -> Self {
        Self { anchor: Anchor::End, ..self }
    }

    /// In another colour.
    pub fn coloured(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    /// In bold.
    pub fn bold(self) -> Self {
        Self { is_bold: true, ..self }
    }

    /// Running upwards.
    pub fn upwards(self) -> Self {
        Self { runs_upwards: true, ..self }
    }

    /// Width of a text, estimated on the wide side. Pixels
    pub fn width(self, text: &str) -> i32 {
        (text.chars().count() as f64 * self.size * 0.6).ceil() as i32
    }
}

impl Canvas {
    /// A filled rectangle between two corners.
    pub fn fill(&mut self, from: Pixel, to: Pixel, colour: Colour) {
        let (from, to) = (raster(from), raster(to));
        let (x, y) = (from.0.min(to.0), from.1.min(to.1));
        let (width, height) = ((to.0 - from.0).abs(), (to.1 - from.1).abs());
        self.document += &format!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{colour}\" stroke=\"none\"/>\n"
        );
    }

    /// A filled polygon.
    pub fn polygon(&mut self, corners: &[Pixel], colour: Colour) {
        self.fine_polygon(corners.iter().map(|corner| raster(*corner)), colour);
    }

    fn fine_polygon(&mut self, corners: impl IntoIterator<Item = Pixel>, colour: Colour) {
        self.document += &format!("<polygon fill=\"{colour}\" points=\"{}\"/>\n", points(corners));
    }

    /// The outline of a rectangle.
    pub fn outline(&mut self, from: Pixel, to: Pixel, colour: Colour) {
        self.line(&[from, (to.0, from.1), to, (from.0, to.1), from], colour, 1);
    }

    /// A line through pixels.
    pub fn line(&mut self, points: &[Pixel], colour: Colour, width: i32) {
        self.fine_line(points.iter().map(|point| raster(*point)), colour, width);
    }

    /// A line through any places.
    pub fn curve(&mut self, points: &[Place], colour: Colour, width: i32) {
        self.fine_line(points.iter().map(|place| fine(*place)), colour, width);
    }

    fn fine_line(&mut self, line: impl IntoIterator<Item = Pixel>, colour: Colour, width: i32) {
        self.stroked(line, colour, width, "");
    }

    fn stroked(&mut self, line: impl IntoIterator<Item = Pixel>, colour: Colour, width: i32, dashes: &str) {
        let (width, points) = (width * FINENESS, points(line));
        self.document += &format!(
            "<polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"{dashes} points=\"{points}\"/>\n"
        );
    }

    /// A line through any places, whole or in strokes.
    pub fn styled_curve(&mut self, points: &[Place], line: LineStyle, width: i32) {
        let dashes = if line.is_dashed {
            format!(" stroke-dasharray=\"{} {}\"", 9 * FINENESS, 5 * FINENESS)
        } else {
            String::new()
        };
        self.stroked(points.iter().map(|place| fine(*place)), line.colour, width, &dashes);
    }

    /// A line through any places; a single one is a dot.
    pub fn curve_or_dot(&mut self, points: &[Place], line: impl Into<LineStyle>, width: i32) {
        let line = line.into();
        match points {
            [] => {}
            [alone] => self.dot(*alone, 3, line.colour),
            _ => self.styled_curve(points, line, width),
        }
    }

    /// A line with a white edge that stands out from any ground.
    pub fn edged_curve(&mut self, points: &[Place], line: impl Into<LineStyle>, width: i32) {
        self.curve(points, WHITE, width + 3);
        self.styled_curve(points, line.into(), width);
    }

    /// A dashed straight line.
    pub fn dashed(&mut self, from: Pixel, to: Pixel, colour: Colour) {
        self.strokes(exact(from), exact(to), colour, &[(7.0, 5.0)]);
    }

    /// A dash-dotted straight line.
    pub fn dash_dotted(&mut self, from: Place, to: Place, colour: Colour) {
        self.strokes(from, to, colour, &[(12.0, 4.0), (2.0, 4.0)]);
    }

    /// A straight line in strokes and gaps of these lengths, over and over. Pixels
    fn strokes(&mut self, from: Place, to: Place, colour: Colour, pattern: &[(f64, f64)]) {
        let length = libm::hypot(to.0 - from.0, to.1 - from.1);
        let at = |along: f64| {
            let part = (along / length).min(1.0);
            (from.0 + (to.0 - from.0) * part, from.1 + (to.1 - from.1) * part)
        };
        let mut along = 0.0;
        let mut pattern = pattern.iter().cycle();
        while along < length
            && let Some((stroke, gap)) = pattern.next()
        {
            self.curve(&[at(along), at(along + stroke)], colour, 1);
            along += stroke + gap;
        }
    }

    /// An arrow with its head at `to`.
    pub fn arrow(&mut self, from: Place, to: Place, colour: Colour, width: i32) {
        self.curve(&[from, to], colour, width);
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = libm::hypot(dx, dy).max(1.0);
        let (ux, uy) = (dx / length, dy / length);
        let at = |ahead: f64, aside: f64| fine((to.0 + ahead * ux - aside * uy, to.1 + ahead * uy + aside * ux));
        self.fine_polygon([at(5.0, 0.0), at(-5.0, 4.0), at(-5.0, -4.0)], colour);
    }

    /// A filled disc with a white edge.
    pub fn dot(&mut self, centre: Place, radius: i32, colour: Colour) {
        let (x, y) = fine(centre);
        for (radius, colour) in [(radius + 1, WHITE), (radius, colour)] {
            let radius = radius * FINENESS;
            self.document += &format!(
                "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{colour}\" stroke=\"none\" stroke-width=\"1\"/>\n"
            );
        }
    }

    /// The title of a picture.
    pub fn title(&mut self, text: &str, place: Pixel) {
        self.text(text, place, TextStyle::new(17.0).bold());
    }

    /// A text.
    pub fn text(&mut self, text: &str, place: Pixel, style: TextStyle) {
        let (x, y) = raster(place);
        let size = style.size * f64::from(FINENESS);
        let anchor = match style.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let weight = if style.is_bold { " font-weight=\"bold\"" } else { "" };
        let turn = if style.runs_upwards { format!(" transform=\"rotate(270, {x}, {y})\"") } else { String::new() };
        let text = escaped(text);
        if self.is_brief {
            let anchor = if anchor == "start" { String::new() } else { format!(" text-anchor=\"{anchor}\"") };
            self.document += &format!(
                "<text x=\"{x}\" y=\"{y}\" dy=\"0.5ex\" font-size=\"{size}\"{anchor}{weight}{turn}>{text}</text>\n"
            );
            return;
        }
        self.document += &format!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"0.5ex\" text-anchor=\"{anchor}\" font-family=\"sans-serif\" \
             font-size=\"{size}\" fill=\"{}\"{weight}{turn}>\n{text}\n</text>\n",
            style.colour
        );
    }
}

/// The place of a pixel.
pub fn exact(pixel: Pixel) -> Place {
    (f64::from(pixel.0), f64::from(pixel.1))
}

/// The pixel nearest to a place.
pub fn nearest(place: Place) -> Pixel {
    (place.0.round() as i32, place.1.round() as i32)
}

fn raster(pixel: Pixel) -> Pixel {
    (pixel.0 * FINENESS, pixel.1 * FINENESS)
}

fn fine(place: Place) -> Pixel {
    nearest((place.0 * f64::from(FINENESS), place.1 * f64::from(FINENESS)))
}

fn points(points: impl IntoIterator<Item = Pixel>) -> String {
    points.into_iter().map(|(x, y)| format!("{x},{y} ")).collect()
}

fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '&' => escaped.push_str("&amp;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&apos;"),
            other => escaped.push(other),
        }
    }
    escaped
}

/// Draws a picture of the given size in pixels on white and returns the SVG document.
pub fn picture(size: Pixel, paint: impl FnOnce(&mut Canvas)) -> String {
    drawn(size, [size.0.to_string(), size.1.to_string()], false, paint)
}

/// Draws a page of A4, upright, with pixels of a quarter of a millimetre; all its texts are black.
pub fn paper(paint: impl FnOnce(&mut Canvas)) -> String {
    drawn((840, 1188), ["210mm".to_owned(), "297mm".to_owned()], true, paint)
}

/// A picture of a size in pixels that is shown in another.
fn drawn(size: Pixel, shown: [String; 2], is_brief: bool, paint: impl FnOnce(&mut Canvas)) -> String {
    let ([wide, high], (width, height)) = (shown, raster(size));
    let family = if is_brief { " font-family=\"sans-serif\"" } else { "" };
    let document = format!(
        "<svg width=\"{wide}\" height=\"{high}\" viewBox=\"0 0 {width} {height}\" xmlns=\"http://www.w3.org/2000/svg\"{family}>\n"
    );
    let mut canvas = Canvas { document, is_brief };
    canvas.fill((0, 0), size, WHITE);
    paint(&mut canvas);
    canvas.document + "</svg>\n"
}

#[cfg(test)]
mod tests {
    use super::super::colour::INK;
    use super::*;

    #[test]
    fn shapes_are_written_in_quarters_of_a_pixel() {
        let svg = picture((20, 10), |canvas| {
            canvas.curve(&[(1.0, 2.0), (3.2, 4.1)], INK, 2);
            canvas.dot((5.0, 5.0), 3, BLACK);
            canvas.text("a < b", (1, 2), TextStyle::new(12.0).bold().upwards());
        });
        let lines = [
            "<svg width=\"20\" height=\"10\" viewBox=\"0 0 80 40\" xmlns=\"http://www.w3.org/2000/svg\">",
            "<rect x=\"0\" y=\"0\" width=\"80\" height=\"40\" fill=\"#FFFFFF\" stroke=\"none\"/>",
            "<polyline fill=\"none\" stroke=\"#3C3C3C\" stroke-width=\"8\" points=\"4,8 13,16 \"/>",
            "<circle cx=\"20\" cy=\"20\" r=\"16\" fill=\"#FFFFFF\" stroke=\"none\" stroke-width=\"1\"/>",
            "<circle cx=\"20\" cy=\"20\" r=\"12\" fill=\"#000000\" stroke=\"none\" stroke-width=\"1\"/>",
            "<text x=\"4\" y=\"8\" dy=\"0.5ex\" text-anchor=\"start\" font-family=\"sans-serif\" font-size=\"48\" \
             fill=\"#000000\" font-weight=\"bold\" transform=\"rotate(270, 4, 8)\">",
            "a &lt; b",
            "</text>",
            "</svg>",
        ];
        assert_eq!(svg.lines().collect::<Vec<_>>(), lines);
    }
}
