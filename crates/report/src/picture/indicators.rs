//! Robots side by side by four indicators (Klimchik 2017, Fig. 20).

use super::axes::{Panel, Scale, Ticks};
use super::canvas::{Canvas, TextStyle, picture};
use super::colour::{Colour, INDICATORS, INK};
use crate::units::{figures, fixed};
use stead_assessment::comparison::{Assessment, Load, RobotResult};

const WIDTH: i32 = 1100;
const LEFT: i32 = 80;
const RIGHT: i32 = 1075;
/// Upper edge of the first row of robots, its height, and the distance to the next row.
const ROWS: [i32; 3] = [150, 300, 365];
/// Most robots in a row.
const ROBOTS_PER_ROW: usize = 6;
/// Value at the upper edge of a row, where the best robot has 1.
const FULL: f64 = 1.18;

/// An indicator of how good a robot is.
struct Indicator {
    name: &'static str,
    /// How the bars are normalised.
    relative_to: &'static str,
    unit: &'static str,
    /// Value in its unit, where known.
    of: fn(&RobotResult) -> Option<f64>,
    /// Whether the smallest value is the best.
    least_is_best: bool,
    /// The value for people.
    text: fn(f64) -> String,
}

const ALL: [Indicator; 4] = [
    Indicator {
        name: "accuracy",
        relative_to: "the smallest circularity of all robots / that of the robot, at the best place of each",
        unit: "mm",
        of: |robot| robot.competitor().min.map(|min| min * 1e3),
        least_is_best: true,
        text: figures,
    },
    Indicator {
        name: "working radius",
        relative_to: "working radius / the largest of all robots",
        unit: "m",
        of: |robot| Some(robot.working_radius),
        least_is_best: false,
        text: |radius| fixed(radius, 3),
    },
    Indicator {
        name: "payload",
        relative_to: "payload / the largest of all robots",
        unit: "kg",
        of: |robot| robot.data_sheet.payload,
        least_is_best: false,
        text: figures,
    },
    Indicator {
        name: "price",
        relative_to: "the lowest price of all robots / that of the robot",
        unit: "EUR",
        of: |robot| robot.data_sheet.price,
        least_is_best: true,
        text: |price| fixed(price, 0),
    },
];

/// Bars of accuracy (under the test load, at the best place), working radius, payload and price for every robot, each
/// relative to the best robot, which has 1; the values themselves stand at the bars. An indicator that no robot has is
/// left out; a robot without a value has a dash in place of the bar. Six robots stand in a row, more in more rows.
pub fn indicators(assessment: &Assessment) -> String {
    let rows = assessment.robots.chunks(ROBOTS_PER_ROW);
    let height = ROWS[0] + ROWS[2] * rows.len().max(1) as i32;
    picture((WIDTH, height), |canvas| {
        let known: Vec<Known> =
            ALL.iter().zip(INDICATORS).filter_map(|(i, colour)| Known::new(i, colour, assessment)).collect();
        let room = (RIGHT - LEFT) / assessment.robots.len().clamp(1, ROBOTS_PER_ROW) as i32;
        head(canvas, assessment, &known);
        for (robots, row) in rows.zip(0..) {
            draw_row(canvas, robots, ROWS[0] + ROWS[2] * row, room, &known);
        }
    })
}

/// An indicator that some robot has.
struct Known<'a> {
    indicator: &'a Indicator,
    colour: Colour,
    /// Value of the best robot.
    best: f64,
}

impl<'a> Known<'a> {
    fn new(indicator: &'a Indicator, colour: Colour, assessment: &Assessment) -> Option<Self> {
        let values = assessment.robots.iter().filter_map(indicator.of);
        let best = values.reduce(if indicator.least_is_best { f64::min } else { f64::max })?;
        Some(Self { indicator, colour, best })
    }

    /// A value relative to the best.
    fn relative(&self, value: f64) -> f64 {
        if value == self.best {
            1.0
        } else if self.indicator.least_is_best {
            self.best / value
        } else {
            value / self.best
        }
    }
}

/// Title and legend.
fn head(canvas: &mut Canvas, assessment: &Assessment, known: &[Known<'_>]) {
    canvas.title("Robots by their principal indicators", (LEFT, 24));
    let mut configurations = assessment.robots.iter().flat_map(|robot| &robot.configurations);
    let force = configurations.find(|found| found.load == Load::Test).map(|found| figures(found.force));
    for (known, y) in known.iter().zip((50..).step_by(21)) {
        let Indicator { name, relative_to, unit, .. } = known.indicator;
        let load = match &force {
            Some(force) if *name == "accuracy" => format!(" under {force} N"),
            _ => String::new(),
        };
        let value = if *name == "accuracy" { "circularity" } else { name };
        canvas.fill((LEFT, y - 7), (LEFT + 26, y + 7), known.colour);
        let style = TextStyle::new(12.0);
        canvas.text(name, (LEFT + 34, y), style.bold());
        let text = format!("{relative_to}{load}; the number is the {value} in {unit}");
        canvas.text(&text, (LEFT + 152, y), style.coloured(INK));
    }
}

/// A row of robots: its upper edge, and the width for each.
fn draw_row(canvas: &mut Canvas, robots: &[RobotResult], top: i32, room: i32, known: &[Known<'_>]) {
    let x = Scale::new(0.0, robots.len() as f64, LEFT, LEFT + room * robots.len() as i32);
    let y = Scale::new(0.0, FULL, top + ROWS[1], top);
    let (x_ticks, y_ticks) = (Ticks::none(), Ticks::every(&y, 0.2, 1));
    let y_label = "relative to the best robot, which has 1";
    let panel = Panel { x, y, x_ticks, y_ticks, x_label: "robot".into(), y_label: y_label.into() };
    panel.draw_grid(canvas);
    for (index, robot) in robots.iter().enumerate() {
        let (left, right) = (panel.x.pixel(index as f64), panel.x.pixel(index as f64 + 1.0));
        bars(canvas, &panel, robot, left, known);
        let size = (f64::from(right - left - 4) / (robot.name.chars().count().max(1) as f64 * 0.6)).min(13.0);
        let place = ((left + right) / 2, panel.y.start + 15);
        canvas.text(&robot.name, place, TextStyle::new(size).bold().centred());
    }
    panel.draw_frame(canvas)
}

/// The bars of a robot, with their values above them.
fn bars(canvas: &mut Canvas, panel: &Panel, robot: &RobotResult, left: i32, known: &[Known<'_>]) {
    let room = panel.x.pixel(1.0) - panel.x.pixel(0.0);
    let width = room * 8 / 10 / known.len().max(1) as i32;
    let first = left + (room - width * known.len() as i32) / 2;
    for (bar, known) in (0..).zip(known) {
        let from = first + bar * width;
        let middle = from + width / 2;
        let Some(value) = (known.indicator.of)(robot) else {
            canvas.text("–", (middle, panel.y.start - 10), TextStyle::new(14.0).centred());
            continue;
        };
        let upper = panel.y.pixel(known.relative(value));
        canvas.fill((from + 1, upper), (from + width - 1, panel.y.start), known.colour);
        let (text, unit) = ((known.indicator.text)(value), known.indicator.unit);
        let size = (f64::from(width) / (text.chars().count() as f64 * 0.6)).min(11.0);
        canvas.text(&text, (middle, upper - 22), TextStyle::new(size).centred());
        canvas.text(unit, (middle, upper - 9), TextStyle::new(11.0).centred().coloured(INK));
    }
}
