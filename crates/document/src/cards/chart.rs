//! Charts as data.

use serde::{Serialize, Serializer};

/// Significant digits of a number in a chart: a part of a pixel.
const DIGITS: usize = 6;
/// Those of a value that is shown as a colour.
const COLOUR_DIGITS: usize = 4;
/// Points that a curve has at most; of more, the smallest and the largest of each stretch are kept.
const MAX_POINTS: usize = 2000;

/// An axis.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Axis {
    /// What it shows, with its unit.
    pub label: String,
    /// Whether it is logarithmic.
    pub is_log: bool,
    /// Names in the place of numbers, for the values 0, 1, 2 and so on.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub names: Vec<String>,
    /// Its ends, where they are not those of the values.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// A linear axis.
    pub fn new(label: impl Into<String>) -> Self {
        Self { label: label.into(), ..Self::default() }
    }

    /// A logarithmic axis.
    pub fn log(label: impl Into<String>) -> Self {
        Self { is_log: true, ..Self::new(label) }
    }

    /// An axis of things with names.
    pub fn named(label: impl Into<String>, names: Vec<String>) -> Self {
        Self { names, ..Self::new(label) }
    }
}

impl<T: Into<String>> From<T> for Axis {
    /// A linear axis with a label.
    fn from(label: T) -> Self {
        Self::new(label)
    }
}

/// Curves and dots over two axes, with zoom and the values under the pointer.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Chart {
    /// Heading.
    pub title: String,
    /// What is said beside the heading.
    pub detail: String,
    /// Across.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// What is drawn, the first first.
    pub series: Vec<Series>,
    /// Lines at a value.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub marks: Vec<Mark>,
    /// Whether both axes are to the same scale.
    pub is_even: bool,
    /// Whether it takes the whole width of the page.
    pub is_wide: bool,
}

impl Chart {
    /// A chart under a heading.
    pub fn new(
        title: impl Into<String>,
        x: impl Into<Axis>,
        y: impl Into<Axis>,
        series: impl IntoIterator<Item = Series>,
    ) -> Self {
        let series = series.into_iter().collect();
        Self { title: title.into(), x: x.into(), y: y.into(), series, ..Self::default() }
    }

    /// With words beside the heading.
    pub fn detailed(self, detail: impl Into<String>) -> Self {
        Self { detail: detail.into(), ..self }
    }

    /// With lines at values.
    pub fn marked(self, marks: impl IntoIterator<Item = Mark>) -> Self {
        Self { marks: marks.into_iter().collect(), ..self }
    }

    /// Over the whole width of the page.
    pub fn wide(self) -> Self {
        Self { is_wide: true, ..self }
    }
}

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum Style {
    /// A line from point to point, broken where there is no value.
    #[default]
    Line,
    /// A dashed line.
    Dashed,
    /// A dot at each point.
    Dots,
    /// A ring at each point.
    Rings,
    /// A dot with the interval about it.
    Intervals,
}

/// Points of one kind.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Series {
    /// What they are.
    pub name: String,
    /// How they are drawn.
    pub style: Style,
    /// Their colour, by the place in the list of colours of the page.
    pub color: usize,
    /// Their places across.
    #[serde(serialize_with = "numbers")]
    pub x: Vec<f64>,
    /// Their places upwards; infinity and NaN for none.
    #[serde(serialize_with = "numbers")]
    pub y: Vec<f64>,
    /// Of intervals: the lower ends.
    #[serde(serialize_with = "numbers", skip_serializing_if = "Vec::is_empty")]
    pub low: Vec<f64>,
    /// Of intervals: the upper ends.
    #[serde(serialize_with = "numbers", skip_serializing_if = "Vec::is_empty")]
    pub high: Vec<f64>,
    /// What each point is, shown under the pointer.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub labels: Vec<String>,
    /// Where each point leads, from the folder of the page; empty where nowhere.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub links: Vec<String>,
    /// What a picture writes beside each point, where there is space.
    #[serde(skip)]
    pub written: Vec<String>,
}

impl Series {
    /// A curve. Of many points, the smallest and the largest of each of some thousand stretches are kept.
    pub fn curve(name: impl Into<String>, color: usize, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let [x, y] = thinned(points.into_iter().collect());
        Self { name: name.into(), color, x, y, ..Self::default() }
    }

    /// Single points.
    pub fn dots(name: impl Into<String>, color: usize, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let (x, y) = points.into_iter().map(|[x, y]| (x, y)).unzip();
        Self { name: name.into(), color, style: Style::Dots, x, y, ..Self::default() }
    }

    /// The same in another style.
    pub fn styled(self, style: Style) -> Self {
        Self { style, ..self }
    }

    /// The same with what each point is.
    pub fn labelled(self, labels: Vec<String>) -> Self {
        Self { labels, ..self }
    }
}

/// A line across a chart at a value of an axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Mark {
    /// Whether the value is one of the axis upwards.
    pub is_level: bool,
    /// The value.
    pub at: f64,
    /// What it is.
    pub label: String,
}

impl Mark {
    /// At a value of the axis upwards.
    pub fn level(at: f64, label: impl Into<String>) -> Self {
        Self { is_level: true, at, label: label.into() }
    }

    /// At a value of the axis across.
    pub fn across(at: f64, label: impl Into<String>) -> Self {
        Self { is_level: false, at, label: label.into() }
    }
}

/// Values over two axes as colours.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct HeatMap {
    /// Heading.
    pub title: String,
    /// What is said beside the heading.
    pub detail: String,
    /// Across: its values are those of `columns`, or its names.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// Places of the columns.
    #[serde(serialize_with = "numbers")]
    pub columns: Vec<f64>,
    /// Places of the rows, from the lowest up.
    #[serde(serialize_with = "numbers")]
    pub rows: Vec<f64>,
    /// Values row by row; infinity and NaN for none.
    #[serde(serialize_with = "colours")]
    pub values: Vec<f64>,
    /// The values of the first and the last colour.
    pub range: [f64; 2],
    /// What the values are, with their unit.
    pub unit: String,
    /// What a place without a value means.
    pub blank: String,
    /// Rectangles over it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub outlines: Vec<Outline>,
    /// Whether both axes are to the same scale.
    pub is_even: bool,
    /// Whether the value is written in each field.
    pub is_written: bool,
    /// What the values are, with their unit: the title of the colours in a picture.
    #[serde(skip)]
    pub measure: String,
    /// Points that a picture shows on it, over its values.
    #[serde(skip)]
    pub points: Vec<MapPoint>,
    /// Lines that a picture shows on it.
    #[serde(skip)]
    pub lines: Vec<MapLine>,
    /// What a picture states below it, line by line, in the colours of the list of the page.
    #[serde(skip)]
    pub notes: Vec<(String, usize)>,
}

/// A point on a heat map.
#[derive(Debug, Clone, PartialEq)]
pub struct MapPoint {
    /// What it is.
    pub label: String,
    /// Its place on both axes.
    pub at: [f64; 2],
    /// Whether it is a ring, or a dot.
    pub is_ring: bool,
}

/// A straight line right across a heat map.
#[derive(Debug, Clone, PartialEq)]
pub struct MapLine {
    /// What it is.
    pub label: String,
    /// A point of it.
    pub through: [f64; 2],
    /// Its direction.
    pub along: [f64; 2],
}

/// A rectangle over a heat map.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outline {
    /// Its name: of what kind it is, and after a comma its size.
    pub label: String,
    /// Its colour, by the place in the list of colours of the page.
    pub color: usize,
    /// Its corner with the smallest values.
    pub low: [f64; 2],
    /// Its corner with the largest.
    pub high: [f64; 2],
}

/// Deviations from a circle over the angle, drawn as a polar plot.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Polar {
    /// Heading.
    pub title: String,
    /// What is said beside the heading.
    pub detail: String,
    /// Unit of the deviations.
    pub unit: String,
    /// Reference circles to choose from, each with the deviations of the points about its centre.
    pub choices: Vec<PolarChoice>,
    /// The angle of each point. deg
    #[serde(serialize_with = "numbers")]
    pub angles: Vec<f64>,
    /// Which points were left out.
    pub excluded: Vec<bool>,
}

/// A reference circle.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct PolarChoice {
    /// Its name.
    pub name: String,
    /// What is said of it.
    pub detail: String,
    /// The deviation of each point.
    #[serde(serialize_with = "numbers")]
    pub deviations: Vec<f64>,
    /// The smallest and the largest deviation that count.
    pub band: [f64; 2],
    /// Radius of the circle.
    #[serde(skip)]
    pub radius: f64,
    /// Figures of the circle that a picture states, by their names.
    #[serde(skip)]
    pub figures: Vec<(String, String)>,
}

/// A curve that looks the same at any width of a screen: its points, or of many the smallest and the largest of each
/// stretch.
fn thinned(points: Vec<[f64; 2]>) -> [Vec<f64>; 2] {
    let width = points.len().div_ceil(MAX_POINTS / 2);
    if points.len() <= MAX_POINTS {
        return [0, 1].map(|axis| points.iter().map(|point| point[axis]).collect());
    }
    let mut kept = Vec::with_capacity(MAX_POINTS);
    for stretch in points.chunks(width) {
        let by_height = |a: &(usize, &[f64; 2]), b: &(usize, &[f64; 2])| a.1[1].total_cmp(&b.1[1]);
        let (min, max) = (stretch.iter().enumerate().min_by(by_height), stretch.iter().enumerate().max_by(by_height));
        let mut ends: Vec<_> = min.into_iter().chain(max).collect();
        ends.sort_by_key(|(index, _)| *index);
        ends.dedup_by_key(|(index, _)| *index);
        kept.extend(ends.into_iter().map(|(_, point)| *point));
    }
    [0, 1].map(|axis| kept.iter().map(|point| point[axis]).collect())
}

/// Numbers with as many digits as a chart shows; null for what is none.
fn numbers<S: Serializer>(values: &[f64], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(values.iter().map(|value| short(*value, DIGITS)))
}

/// Numbers with as many digits as a colour shows.
fn colours<S: Serializer>(values: &[f64], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(values.iter().map(|value| short(*value, COLOUR_DIGITS)))
}

fn short(value: f64, digits: usize) -> Option<f64> {
    format!("{value:.*e}", digits - 1).parse::<f64>().ok().filter(|value| value.is_finite())
}
