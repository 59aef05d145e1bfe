//! Heat maps as data, drawn: the same that pages show, side by side.

use super::axes::{Panel, Scale, Ticks, Window};
use super::canvas::{Canvas, Pixel, Place, TextStyle, exact, nearest, picture};
use super::colour::{BLACK, Colour, GREY, INK, SERIES, WHITE, contrast, viridis};
use super::contour::contour;
use super::heat_map::{ColourBar, ColourRange, ColouredCells};
use super::labels::{Area, Label, Labeller, TICKS, cut, fitting};
use crate::cards::{HeatMap, MapLine, MapPoint, Outline};
use crate::units::figures;

/// Upper edge of the panels, and width of one whose axes are to the same scale. Pixels
const TOP: i32 = 116;
const PANEL: i32 = 405;
/// Least and largest height of such a panel. Pixels
const HEIGHTS: [i32; 2] = [260, 660];
/// Free space around such a map, as a share of its larger side.
const MARGIN: f64 = 0.04;
/// Least and largest width and height of a field of any other map, and what all of them may take. Pixels
const FIELDS: [[i32; 2]; 2] = [[34, 130], [22, 64]];
const SIDES: [i32; 2] = [820, 620];
/// Letters of the name of a row.
const LETTERS: usize = 26;
/// Most letters of a label of the colours without a power of ten.
const MAX_LETTERS: usize = 7;
/// A contour line is labelled when it is so many times as long as its label.
const LONG: f64 = 1.5;

/// Maps side by side to the scale of colours of the first, each under its heading, with what explains them and notes
/// below.
///
/// A map of two axes to the same scale has contour lines at the ticks of the colours, with their values as far as there
/// is space; outlines are labelled with their sizes, points and lines are named in the legend. Any other map has its
/// values written in its fields.
pub fn heat_maps(title: &str, subtitle: &str, maps: &[HeatMap], notes: &[&str]) -> String {
    let drawn = Drawn::all(maps);
    let [right, bottom] = drawn.last().map_or([0, TOP], |last| [last.panel.x.end, last.panel.y.start]);
    let width = (right + 130).max(640);
    let lines = maps.iter().map(|map| map.notes.len()).max().unwrap_or(0) as i32;
    let below = bottom + 76 + 17 * lines;
    let signs = legend(&drawn, width, below);
    let notes_from = signs.last().map_or(below, |((_, y), ..)| y + 26);
    picture((width, notes_from + 26 * notes.len() as i32 - 2), |canvas| {
        let size = (f64::from(width - 2 * 40) / (title.chars().count() as f64 * 0.6)).min(17.0);
        let left = drawn.first().map_or(0, |first| first.panel.x.start);
        let style = TextStyle::new(12.0);
        canvas.text(title, (left, 24), TextStyle::new(size).bold());
        canvas.text(subtitle, (left, 47), style.coloured(INK));
        drawn.iter().for_each(|map| map.draw(canvas));
        if let Some(first) = drawn.first().filter(|_| maps.iter().any(|map| finite(map).next().is_some())) {
            let largest = maps.iter().flat_map(finite).fold(f64::NEG_INFINITY, f64::max);
            first.colour_bar(canvas, right, largest);
        }
        for ((x, y), sign, label) in &signs {
            sign.draw(canvas, (*x, *y));
            canvas.text(label, (x + sign.width(), *y), style);
        }
        for (note, y) in notes.iter().zip((notes_from..).step_by(26)) {
            canvas.text(note, (left, y), style.coloured(INK));
        }
    })
}

fn finite(map: &HeatMap) -> impl Iterator<Item = f64> + '_ {
    map.values.iter().copied().filter(|value| value.is_finite())
}

/// What stands before a word of the legend.
#[derive(Clone, Copy, PartialEq)]
enum Sign {
    Nothing,
    Square(Colour),
    Point { is_ring: bool },
    Line,
}

impl Sign {
    /// Space that it takes. Pixels
    fn width(self) -> i32 {
        match self {
            Self::Nothing => 0,
            Self::Square(_) | Self::Point { .. } => 24,
            Self::Line => 44,
        }
    }

    fn draw(self, canvas: &mut Canvas, left: Pixel) {
        let (x, y) = exact(left);
        match self {
            Self::Nothing => {}
            Self::Square(colour) => {
                let corners = [(x, y - 8.0), (x + 16.0, y - 8.0), (x + 16.0, y + 8.0), (x, y + 8.0), (x, y - 8.0)];
                canvas.curve(&corners, colour, 2);
            }
            Self::Point { is_ring } => draw_point(canvas, (x + 8.0, y), is_ring),
            Self::Line => canvas.dash_dotted((x, y), (x + 36.0, y), INK),
        }
    }
}

fn draw_point(canvas: &mut Canvas, place: Place, is_ring: bool) {
    if is_ring {
        canvas.dot(place, 6, INK);
        canvas.dot(place, 2, WHITE);
    } else {
        canvas.dot(place, 4, BLACK);
    }
}

/// What is on the maps, with its place in lines of a width from a height on.
fn legend(drawn: &[Drawn], width: i32, from: i32) -> Vec<(Pixel, Sign, String)> {
    let mut entries: Vec<(Sign, String)> = Vec::new();
    for of in drawn {
        let kinds = of.map.outlines.iter().map(|outline| (Sign::Square(colour(outline)), of_outline(outline)[0]));
        let points = of.map.points.iter().filter(|point| of.has(point.at));
        let points = points.map(|point| (Sign::Point { is_ring: point.is_ring }, point.label.as_str()));
        let lines = of.map.lines.iter().filter(|line| of.ends(line).is_some());
        let lines = lines.map(|line| (Sign::Line, line.label.as_str()));
        let entries_of = kinds.chain(points).chain(lines).map(|(sign, label)| (sign, label.to_owned()));
        let is_blank = of.map.values.iter().any(|value| !value.is_finite());
        let blank = is_blank.then(|| (Sign::Nothing, format!("white: {}", of.map.blank)));
        for entry in entries_of.chain(blank) {
            if !entries.contains(&entry) {
                entries.push(entry);
            }
        }
    }
    let left = drawn.first().map_or(0, |first| first.panel.x.start);
    let (mut x, mut y) = (left, from);
    let placed = |(sign, label): (Sign, String)| {
        let wide = sign.width() + TextStyle::new(12.0).width(&label) + 16;
        if x > left && x + wide > width {
            (x, y) = (left, y + 26);
        }
        x += wide;
        ((x - wide, y), sign, label)
    };
    entries.into_iter().map(placed).collect()
}

fn colour(outline: &Outline) -> Colour {
    SERIES[outline.color % SERIES.len()]
}

/// The kind of an outline and its size.
fn of_outline(outline: &Outline) -> [&str; 2] {
    outline.label.split_once(", ").map_or([&outline.label, ""], |(kind, size)| [kind, size])
}

/// A map and where it is drawn.
struct Drawn<'a> {
    map: &'a HeatMap,
    panel: Panel,
    /// Distance of neighbouring columns and rows, in the numbers of the axes.
    steps: [f64; 2],
    cells: ColouredCells<usize>,
    range: ColourRange,
    /// Values of the contour lines and of the ticks at the colours.
    ticks: Ticks,
}

impl<'a> Drawn<'a> {
    fn all(maps: &'a [HeatMap]) -> Vec<Self> {
        let [from, to] = maps.first().map_or([0.0, 1.0], |map| map.range);
        let mut left = 0;
        let drawn = |map: &'a HeatMap| {
            let steps = steps(map);
            let panel = panel(map, steps, left);
            left = panel.x.end;
            let edges = |places: &[f64], step: f64, scale: Scale| {
                let first = places.first().map(|first| first - step / 2.0);
                let edges = first.into_iter().chain(places.iter().map(|place| place + step / 2.0));
                edges.map(|edge| scale.pixel(edge)).collect()
            };
            let range = ColourRange { from, to };
            let cells = ColouredCells {
                columns: edges(&map.columns, steps[0], panel.x),
                rows: edges(&map.rows, steps[1], panel.y),
                cells: map.values.iter().map(|value| value.is_finite().then(|| range.level(*value))).collect(),
            };
            let ticks = Ticks::round(&Scale::new(from, to, 0, 1), if map.is_even { 10 } else { 8 });
            Self { map, panel, steps, cells, range, ticks }
        };
        maps.iter().map(drawn).collect()
    }

    fn draw(&self, canvas: &mut Canvas) {
        let (map, Panel { x, y, .. }) = (self.map, &self.panel);
        canvas.text(&map.title, (x.start, TOP - 34), TextStyle::new(14.0).bold());
        canvas.text(&map.detail, (x.start, TOP - 15), TextStyle::new(12.0).coloured(INK));
        self.panel.draw_grid(canvas);
        if finite(map).next().is_some() {
            self.cells.draw_merged(canvas, viridis);
        } else {
            let place = ((x.start + x.end) / 2, (y.start + y.end) / 2);
            canvas.text(&map.blank, place, TextStyle::new(14.0).centred().coloured(INK));
        }
        for line in &map.lines {
            if let Some([from, to]) = self.ends(line) {
                canvas.dash_dotted(self.place(from), self.place(to), INK);
            }
        }
        if map.is_written {
            self.write(canvas);
        }
        let mut labeller = Labeller::new(((x.start, y.end), (x.end, y.start)));
        let lines = if map.is_even { self.contours(canvas) } else { Vec::new() };
        self.outlines(canvas, &mut labeller);
        for (value, line) in lines {
            self.contour_label(canvas, &mut labeller, value, &line);
        }
        self.panel.draw_frame(canvas);
        for ((note, color), y) in map.notes.iter().zip((y.start + 58..).step_by(17)) {
            canvas.text(note, (x.start, y), TextStyle::new(11.0).coloured(SERIES[color % SERIES.len()]));
        }
    }

    fn place(&self, at: [f64; 2]) -> Place {
        self.panel.place(at[0], at[1])
    }

    fn window(&self) -> Window {
        let Panel { x, y, .. } = &self.panel;
        [[x.from, y.from], [x.to, y.to]]
    }

    /// Whether a point is in view.
    fn has(&self, at: [f64; 2]) -> bool {
        let [low, high] = self.window();
        (0..2).all(|k| low[k] <= at[k] && at[k] <= high[k])
    }

    /// The ends of a line in view.
    fn ends(&self, line: &MapLine) -> Option<Window> {
        within(line, self.window())
    }

    /// The value of each field that has space for it, a dash where there is none.
    fn write(&self, canvas: &mut Canvas) {
        let fields = self.map.rows.iter().flat_map(|row| self.map.columns.iter().map(|column| [*column, *row]));
        for (at, value) in fields.zip(&self.map.values) {
            let (text, colour) = if value.is_finite() {
                (figures(*value), contrast(viridis(self.range.level(*value))))
            } else {
                ("–".to_owned(), GREY)
            };
            let style = TextStyle::new(11.0).centred().coloured(colour);
            if style.width(&text) <= self.panel.x.pixel(self.steps[0]) - self.panel.x.pixel(0.0) {
                canvas.text(&text, nearest(self.place(at)), style);
            }
        }
    }

    /// The label of a tick of the colours.
    fn label(&self, value: f64) -> String {
        let label = self.ticks.label(value);
        if label.len() <= MAX_LETTERS { label } else { format!("{value:.2e}") }
    }

    /// The contour lines, drawn and returned with their values.
    fn contours(&self, canvas: &mut Canvas) -> Vec<(f64, Vec<Place>)> {
        let mut drawn = Vec::new();
        let (Some(left), Some(low)) = (self.map.columns.first(), self.map.rows.first()) else { return drawn };
        let place = |steps: [f64; 2]| self.place([left + self.steps[0] * steps[0], low + self.steps[1] * steps[1]]);
        for value in &self.ticks.values {
            let colour = contrast(viridis(self.range.level(*value)));
            for line in contour(self.map.columns.len(), &self.map.values, *value) {
                let places: Vec<Place> = line.into_iter().map(place).collect();
                canvas.curve(&places, colour, 1);
                drawn.push((*value, places));
            }
        }
        drawn
    }

    /// The value of a contour line on a ground of its colour, as near to the middle of the line as there is space.
    fn contour_label(&self, canvas: &mut Canvas, labeller: &mut Labeller, value: f64, line: &[Place]) {
        let text = self.label(value);
        let (wide, high) = Labeller::half(&text);
        let length: f64 = line.windows(2).map(|pair| libm::hypot(pair[1].0 - pair[0].0, pair[1].1 - pair[0].1)).sum();
        if length < LONG * 2.0 * f64::from(wide) {
            return;
        }
        let ground = viridis(self.range.level(value));
        let middle = line.len() / 2;
        let outwards = (0..=middle).flat_map(|off| [middle.checked_sub(off), middle.checked_add(off)]).flatten();
        let on_map = |(x, y): &Pixel| {
            let corners = [(-wide, -high), (wide, -high), (-wide, high), (wide, high)];
            corners.into_iter().all(|(across, down)| self.cells.at((x + across, y + down)).is_some())
        };
        let centres = outwards.filter_map(|index| line.get(index)).map(|place| nearest(*place)).filter(on_map);
        labeller.put(canvas, &Label { text: &text, colour: contrast(ground), ground }, centres)
    }

    /// Outlines and points, then the sizes of the outlines where there is space.
    fn outlines(&self, canvas: &mut Canvas, labeller: &mut Labeller) {
        let area = |outline: &Outline| -> Area {
            let Outline { low, high, .. } = outline;
            (nearest(self.place([low[0], high[1]])), nearest(self.place([high[0], low[1]])))
        };
        for outline in &self.map.outlines {
            let ((left, top), (right, bottom)) = area(outline);
            let corners = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)].map(exact);
            canvas.edged_curve(&corners, colour(outline), 2);
            labeller.take_outline(((left, top), (right, bottom)));
        }
        for MapPoint { at, is_ring, .. } in self.map.points.iter().filter(|point| self.has(point.at)) {
            draw_point(canvas, self.place(*at), *is_ring);
            let (x, y) = nearest(self.place(*at));
            labeller.take(((x - 6, y - 6), (x + 6, y + 6)));
        }
        for outline in &self.map.outlines {
            let text = of_outline(outline)[1].trim_end_matches(&self.map.unit).trim_end();
            let ((left, top), (right, bottom)) = area(outline);
            let (half_width, half_height) = Labeller::half(text);
            let (beside, above) = (half_width + 4, half_height + 4);
            let (inner_left, inner_right) = (left + half_width, right - half_width);
            let centres = [top - above, top + above, bottom + above, bottom - above].into_iter().flat_map(|y| {
                [inner_right, inner_left, (left + right) / 2, left - beside, right + beside].map(|x| (x, y))
            });
            let sides = [right + beside, left - beside].map(|x| (x, (top + bottom) / 2));
            let label = Label { text, colour: colour(outline), ground: WHITE };
            labeller.put(canvas, &label, centres.chain(sides));
        }
    }

    /// The colours beside the last panel, which ends at `right`.
    fn colour_bar(&self, canvas: &mut Canvas, right: i32, largest: f64) {
        let ColourRange { from, to } = self.range;
        let ends = [from, to].map(|value| (value, figures(value)));
        let ticks = self.ticks.values.iter().map(|value| (*value, self.label(*value)));
        ColourBar {
            sides: [right + 22, right + 40],
            scale: Scale::new(from, to, self.panel.y.start, TOP),
            labels: if self.ticks.values.len() > 1 { ticks.collect() } else { ends.to_vec() },
            beyond: (largest > to).then(|| figures(largest)),
            title: self.map.measure.clone().into(),
            gap: 14,
        }
        .draw(canvas);
    }
}

/// Distances of neighbouring columns and rows; of a single one on axes to the same scale, that of the other.
fn steps(map: &HeatMap) -> [f64; 2] {
    let step = |places: &[f64]| Some(places.get(1)? - places.first()?);
    let [across, up] = [step(&map.columns), step(&map.rows)];
    [across.or(up), up.or(across)].map(|step| step.unwrap_or(1.0))
}

/// The panel of a map beside what ends at `from`.
fn panel(map: &HeatMap, steps: [f64; 2], from: i32) -> Panel {
    let ends = |k: usize, places: &[f64]| match (places, [&map.x, &map.y][k].range) {
        (_, Some(range)) => range,
        ([first, ..], None) => [first - steps[k] / 2.0, places[places.len() - 1] + steps[k] / 2.0],
        ([], None) => [0.0, 1.0],
    };
    let (across, up) = (ends(0, &map.columns), ends(1, &map.rows));
    let extent = [[across[0], up[0]], [across[1], up[1]]];
    let field = |k: usize, count: usize| (SIDES[k] / count.max(1) as i32).clamp(FIELDS[k][0], FIELDS[k][1]);
    let fields = [field(0, map.columns.len()), field(1, map.rows.len())];
    let ([low, high], [width, height]) = if map.is_even {
        let (window, height) = even(extent);
        (window, [PANEL, height])
    } else {
        let all = [fields[0] * map.columns.len() as i32, fields[1] * map.rows.len() as i32];
        (extent, [all[0], all[1].max(150)])
    };
    let y = Scale::new(low[1], high[1], TOP + height, TOP);
    let mut x_ticks = Ticks::round(&Scale::new(low[0], high[0], 0, width), 7);
    let mut y_ticks = match x_ticks.values[..] {
        [first, second, ..] if map.is_even => Ticks::every(&y, second - first, x_ticks.decimals),
        _ => Ticks::round(&y, 7),
    };
    if !map.x.names.is_empty() {
        x_ticks = Ticks::named(fitting(&map.x.names, fields[0]));
    }
    if !map.y.names.is_empty() {
        let step = (18 / fields[1]).max(1) as usize;
        let shown =
            |(k, name): (usize, &String)| if k.is_multiple_of(step) { cut(name, LETTERS) } else { String::new() };
        y_ticks = Ticks::named(map.y.names.iter().enumerate().map(shown).collect());
    }
    let widths = y_ticks.values.iter().map(|value| TextStyle::new(TICKS).width(&y_ticks.label(*value)));
    let left = from + 51 + widths.max().unwrap_or(0);
    let x = Scale::new(low[0], high[0], left, left + width);
    let [x_label, y_label] = [&map.x, &map.y].map(|axis| axis.label.clone().into());
    Panel { x, y, x_ticks, y_ticks, x_label, y_label }
}

/// The edges of the view and the height of the panel (pixels) of a map to the same scale both ways: its extent, a
/// margin, and as much more as fills the panel.
fn even(extent: Window) -> (Window, i32) {
    let [low, high] = extent;
    let sides = [0, 1].map(|k| (high[k] - low[k]).max(1e-6));
    let margin = 2.0 * MARGIN * sides[0].max(sides[1]);
    let [width, height] = sides.map(|side| side + margin);
    let scale = (f64::from(PANEL) / width).min(f64::from(HEIGHTS[1]) / height);
    let pixels = ((height * scale).round() as i32).clamp(HEIGHTS[0], HEIGHTS[1]);
    let half = [PANEL, pixels].map(|pixels| f64::from(pixels) / scale / 2.0);
    let middle = [0, 1].map(|k| (low[k] + high[k]) / 2.0);
    ([[0, 1].map(|k| middle[k] - half[k]), [0, 1].map(|k| middle[k] + half[k])], pixels)
}

/// The ends of a line in a window.
fn within(line: &MapLine, window: Window) -> Option<Window> {
    let ([low, high], MapLine { through, along, .. }) = (window, line);
    let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
    for k in 0..2 {
        if along[k].abs() > 1e-9 {
            let ends = [(low[k] - through[k]) / along[k], (high[k] - through[k]) / along[k]];
            from = from.max(ends[0].min(ends[1]));
            to = to.min(ends[0].max(ends[1]));
        } else if through[k] < low[k] || through[k] > high[k] {
            return None;
        }
    }
    let at = |distance: f64| [0, 1].map(|k| through[k] + along[k] * distance);
    (from < to).then(|| [at(from), at(to)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_axes_have_the_same_scale_and_the_map_is_in_view() {
        let extents = [
            [[600.0, -400.0], [2700.0, 3200.0]],
            [[300.0, 500.0], [3000.0, 1500.0]],
            [[1200.0, -2000.0], [1300.0, 3000.0]],
            [[1200.0, 500.0], [2400.0, 620.0]],
            [[1200.0, 800.0], [1220.0, 820.0]],
        ];
        for extent in extents {
            let ([low, high], pixels) = even(extent);
            let (across, up) = ((high[0] - low[0]) / f64::from(PANEL), (high[1] - low[1]) / f64::from(pixels));
            assert!((across / up - 1.0).abs() < 1e-12, "{extent:?}");
            assert!((HEIGHTS[0]..=HEIGHTS[1]).contains(&pixels));
            assert!((0..2).all(|k| low[k] < extent[0][k] && extent[1][k] < high[k]), "{extent:?}");
        }
    }

    #[test]
    fn a_line_is_clipped_to_the_window() {
        let line = |through, along| MapLine { label: String::new(), through, along };
        let window = [[0.0, 0.0], [100.0, 50.0]];
        let ends =
            |line: MapLine| within(&line, window).map(|ends| ends.map(|end| end.map(|part| (part * 10.0).round())));
        assert_eq!(ends(line([10.0, 200.0], [0.0, -1.0])), Some([[100.0, 500.0], [100.0, 0.0]]));
        assert_eq!(ends(line([-12.0, -12.0], [0.6, 0.8])), Some([[0.0, 40.0], [345.0, 500.0]]));
        assert_eq!(ends(line([-1.0, 20.0], [0.0, 1.0])), None);
        assert_eq!(ends(line([0.0, 60.0], [0.6, 0.8])), None);
    }
}
