//! The deflection over path point and beta, with both plans (Caro 2013, Fig. 7 and 9).

use super::axes::{Panel, Scale, Ticks};
use super::canvas::{BEST_LINE, Canvas, LineStyle, Pixel, Place, TextStyle, WORST_LINE, picture};
use super::colour::{BEST, Colour, GREY, INK, WHITE, WORST, viridis};
use super::hatch::{Slope, hatch};
use super::heat_map::{ColourBar, ColourRange, ColouredCells};
use crate::names;
use crate::units::fixed;
use std::collections::BTreeSet;
use stead_placement::outcome::{Case, Plan};
use stead_planning::feasibility::{DeflectionMap, MapCell};
use stead_problem::constraints::ConstraintKind;
use stead_problem::problem::Problem;

const SIZE: Pixel = (1120, 710);
const LEFT: i32 = 80;
const RIGHT: i32 = 975;
const TOP: i32 = 122;
const BOTTOM: i32 = 572;
/// Segments narrower than this are not labelled. Pixels
const NARROW: i32 = 22;
/// Segments narrower than this are labelled with numbers only. Pixels
const MEDIUM: i32 = 75;
/// Most columns of the picture: a longer path is thinned out to keep the file small.
const COLUMNS: usize = 240;

/// A heat map of the smallest allowed score over path point and beta, with the best and the worst plan of that
/// placement. States without an allowed posture have a pale ground that tells the reason. A path of more than 240
/// points is thinned out evenly, the plans are not. `place` is what the placement is called: "the best placement".
pub fn deflection_map(problem: &Problem, map: &DeflectionMap, plans: [&Case; 2], place: &str) -> String {
    picture(SIZE, |canvas| Picture::new(problem, map, plans, place).draw(canvas))
}

struct Picture<'a> {
    place: &'a str,
    problem: &'a Problem,
    map: &'a DeflectionMap,
    best: &'a Case,
    worst: &'a Case,
    panel: Panel,
    /// Scores of the colours. m
    colours: ColourRange,
    cells: ColouredCells<Cell>,
}

/// What a cell of the map shows: a level of the colours, or why no posture is allowed.
#[derive(Clone, Copy, PartialEq)]
enum Cell {
    Level(usize),
    Blocked(ConstraintKind),
}

impl<'a> Picture<'a> {
    fn new(problem: &'a Problem, map: &'a DeflectionMap, plans: [&'a Case; 2], place: &'a str) -> Self {
        let [best, worst] = plans;
        let points = map.rows.len();
        let x = Scale::new(-0.5, points as f64 - 0.5, LEFT, RIGHT);
        let y = Scale::new(-180.0, 180.0, BOTTOM, TOP);
        let (x_ticks, y_ticks) = (Ticks::round(&x, 12), Ticks::every(&y, 45.0, 0));
        let panel = Panel {
            x,
            y,
            x_ticks,
            y_ticks,
            x_label: "path point".into(),
            y_label: "angle β about the tool axis (deg)".into(),
        };
        let mut ascending: Vec<f64> = scores(map).collect();
        ascending.sort_by(f64::total_cmp);
        let colours = ColourRange::below_peaks(0.0, &ascending);
        let cells = cells(map, &panel, colours);
        Self { place, problem, map, best, worst, panel, colours, cells }
    }

    fn draw(&self, canvas: &mut Canvas) {
        self.title(canvas);
        self.cells.draw_columns(canvas, |cell| match cell {
            Cell::Level(level) => viridis(level),
            Cell::Blocked(blocked) => ground(blocked),
        });
        self.hatching(canvas, ConstraintKind::Conditioning, Slope::Up);
        self.hatching(canvas, ConstraintKind::MaxDeflection, Slope::Down);
        self.segments(canvas);
        self.plan(canvas, &self.worst.plan, WORST_LINE);
        self.plan(canvas, &self.best.plan, BEST_LINE);
        self.panel.draw_frame(canvas);
        self.colour_bar(canvas);
        self.legend(canvas)
    }

    fn title(&self, canvas: &mut Canvas) {
        canvas.title(&format!("Deflection at {}", self.place), (LEFT, 24));
        let place = &self.best.placement;
        let [x, y, z] = [place.x, place.y, place.z].map(|value| fixed(value * 1e3, 1));
        let (q4, yaw) = (fixed(place.q4(), 4), fixed(place.yaw.to_degrees(), 1));
        let subtitle = format!(
            "x = {x} mm, y = {y} mm, z = {z} mm, yaw = {yaw} deg (Q4 {q4}); for each state the smallest over the \
             allowed postures"
        );
        canvas.text(&subtitle, (LEFT, 47), TextStyle::new(12.0).coloured(INK))
    }

    fn hatching(&self, canvas: &mut Canvas, blocked: ConstraintKind, slope: Slope) {
        if self.reasons().contains(&blocked) {
            let area = ((LEFT, TOP), (RIGHT, BOTTOM));
            hatch(canvas, area, slope, GREY, |pixel| self.cells.at(pixel) == Some(Cell::Blocked(blocked)));
        }
    }

    fn reasons(&self) -> BTreeSet<ConstraintKind> {
        self.map.rows.iter().flatten().filter_map(|cell| cell.err().map(|reason| reason.kind)).collect()
    }

    /// Borders of the segments, and above them their numbers and postures, as far as there is room.
    fn segments(&self, canvas: &mut Canvas) {
        let segments = self.problem.task.segments();
        let narrowest = segments.iter().map(|range| self.panel.x.pixel(range.len() as f64) - self.panel.x.pixel(0.0));
        let narrowest = narrowest.min().unwrap_or(0);
        if (NARROW..MEDIUM).contains(&narrowest) {
            let heading = TextStyle::new(11.5).ending();
            canvas.text("segment", (LEFT - 8, TOP - 43), heading.bold().coloured(INK));
            canvas.text("posture", (LEFT - 8, TOP - 26), heading.coloured(BEST));
            canvas.text("posture", (LEFT - 8, TOP - 10), heading.coloured(WORST));
        }
        for (index, range) in segments.iter().enumerate() {
            let (left, right) = (self.edge(range.start), self.edge(range.end));
            if index > 0 {
                canvas.line(&[(left, TOP - 50), (left, BOTTOM)], INK, 1);
            }
            if narrowest < NARROW {
                continue;
            }
            let middle = (left + right) / 2;
            let (segment, posture) = if narrowest < MEDIUM { ("", "") } else { ("segment ", "posture ") };
            let style = TextStyle::new(11.5).centred();
            canvas.text(&format!("{segment}{}", index + 1), (middle, TOP - 43), style.bold().coloured(INK));
            for (plan, colour, up) in [(&self.best.plan, BEST, 26), (&self.worst.plan, WORST, 10)] {
                if let Some(number) = plan.postures.get(index) {
                    canvas.text(&format!("{posture}{number}"), (middle, TOP - up), style.coloured(colour));
                }
            }
        }
    }

    fn edge(&self, point: usize) -> i32 {
        self.panel.x.pixel(point as f64 - 0.5)
    }

    fn plan(&self, canvas: &mut Canvas, plan: &Plan, line: LineStyle) {
        for run in plan_lines(plan, |point, beta_deg| self.panel.place(point, beta_deg)) {
            match run[..] {
                [alone] => canvas.dot(alone, 3, line.colour),
                _ => canvas.edged_curve(&run, line, 3),
            }
        }
    }

    fn colour_bar(&self, canvas: &mut Canvas) {
        let largest = scores(self.map).fold(0.0, f64::max);
        let scale = Scale::new(0.0, self.colours.to * 1e3, BOTTOM, TOP);
        ColourBar {
            sides: [RIGHT + 28, RIGHT + 48],
            scale,
            labels: ColourBar::labels(&Ticks::round(&scale, 9)),
            beyond: (largest > self.colours.to).then(|| fixed(largest * 1e3, 2)),
            title: "deflection normal to the feed (mm)".into(),
            gap: 16,
        }
        .draw(canvas);
    }

    /// The plans, and the reasons that occur.
    fn legend(&self, canvas: &mut Canvas) {
        let style = TextStyle::new(12.0);
        let mut x = LEFT;
        for (kind, plan, line) in [("best", &self.best.plan, BEST_LINE), ("worst", &self.worst.plan, WORST_LINE)] {
            let (mean, max) = (fixed(plan.mean * 1e3, 4), fixed(plan.max * 1e3, 4));
            let label = format!("{kind} plan: mean {mean} mm, largest {max} mm");
            canvas.styled_curve(&[(f64::from(x), 632.0), (f64::from(x + 32), 632.0)], line, 3);
            canvas.text(&label, (x + 40, 632), style);
            x += 40 + style.width(&label) + 24;
        }
        let postures = names::posture_lines([&self.best.plan, &self.worst.plan].into_iter());
        let small = TextStyle::new(11.0);
        let mut words = postures.join("; ");
        for count in (0..postures.len()).rev() {
            if LEFT + small.width(&words) <= SIZE.0 {
                break;
            }
            words = format!("{}; ..", postures[..count].join("; "));
        }
        canvas.text(&words, (LEFT, 648), small);
        let reasons = self.reasons();
        if reasons.is_empty() {
            return;
        }
        let indent = LEFT + style.width("not allowed:") + 10;
        let mut y = 664;
        canvas.text("not allowed:", (LEFT, y), style);
        x = indent;
        for blocked in reasons {
            let label = names::constraint_in_legend(blocked);
            let width = 33 + style.width(&label);
            if x + width > SIZE.0 {
                (x, y) = (indent, y + 26);
            }
            let corners = ((x, y - 8), (x + 26, y + 8));
            canvas.fill(corners.0, corners.1, ground(blocked));
            match blocked {
                ConstraintKind::Conditioning => hatch(canvas, corners, Slope::Up, GREY, |_| true),
                ConstraintKind::MaxDeflection => hatch(canvas, corners, Slope::Down, GREY, |_| true),
                _ => {}
            }
            canvas.outline(corners.0, corners.1, GREY);
            canvas.text(&label, (x + 33, y), style);
            x += width + 12;
        }
    }
}

fn scores(map: &DeflectionMap) -> impl Iterator<Item = f64> + '_ {
    map.rows.iter().flatten().flatten().map(|cell| cell.score)
}

/// The cells of the map: of very many points every so many, and beta at -180 deg half at the bottom and half at the
/// top.
fn cells(map: &DeflectionMap, panel: &Panel, colours: ColourRange) -> ColouredCells<Cell> {
    let points = map.rows.len();
    let stride = points.div_ceil(COLUMNS).max(1);
    let starts = || (0..points).step_by(stride);
    let step = 360.0 / map.beta_count as f64;
    let content = |row: usize, start: usize| match map.rows[(start + stride / 2).min(points - 1)][row % map.beta_count]
    {
        Ok(MapCell { score, .. }) => Cell::Level(colours.level(score)),
        Err(blocked) => Cell::Blocked(blocked.kind),
    };
    ColouredCells {
        columns: starts().chain([points]).map(|start| panel.x.pixel(start as f64 - 0.5)).collect(),
        rows: (0..=map.beta_count + 1).map(|k| panel.y.clamped(-180.0 + (k as f64 - 0.5) * step)).collect(),
        cells: (0..=map.beta_count)
            .flat_map(|row| starts().map(move |start| (row, start)))
            .map(|(row, start)| Some(content(row, start)))
            .collect(),
    }
}

/// The lines of a plan over path point and beta in degrees: one for each segment, cut where beta passes 180 deg.
fn plan_lines(plan: &Plan, place: impl Fn(f64, f64) -> Place) -> Vec<Vec<Place>> {
    let mut lines: Vec<Vec<Place>> = Vec::new();
    let mut line = Vec::new();
    for (index, point) in plan.points.iter().enumerate() {
        let (x, beta_deg) = (point.point as f64, point.beta.to_degrees());
        if let Some(before) = index.checked_sub(1).map(|k| &plan.points[k]) {
            let step = beta_deg - before.beta.to_degrees();
            if before.segment != point.segment {
                lines.push(std::mem::take(&mut line));
            } else if step.abs() > 180.0 {
                let side = 180.0 * step.signum();
                let unwrapped = step - 2.0 * side;
                let part = (-side - before.beta.to_degrees()) / unwrapped;
                let crossing = before.point as f64 + (x - before.point as f64) * part;
                line.push(place(crossing, -side));
                lines.push(std::mem::take(&mut line));
                line.push(place(crossing, side));
            }
        }
        line.push(place(x, beta_deg));
    }
    lines.push(line);
    lines.retain(|line| !line.is_empty());
    lines
}

/// The pale ground of states that are not allowed.
fn ground(blocked: ConstraintKind) -> Colour {
    match blocked {
        ConstraintKind::Reach => WHITE,
        ConstraintKind::JointLimit(1) => Colour(240, 240, 215),
        ConstraintKind::JointLimit(2) => Colour(221, 230, 245),
        ConstraintKind::JointLimit(3) => Colour(246, 224, 222),
        ConstraintKind::JointLimit(4) => Colour(232, 224, 244),
        ConstraintKind::JointLimit(5) => Colour(222, 222, 222),
        ConstraintKind::AxesSum => Colour(244, 232, 214),
        ConstraintKind::JointLimit(_) => Colour(222, 240, 228),
        _ => Colour(248, 248, 248),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::outcome;

    #[test]
    fn plan_is_cut_at_segment_ends_and_where_beta_wraps() {
        let mut plan = outcome().cases.best.plan.clone();
        plan.points.truncate(4);
        for (k, (segment, beta_deg)) in [(1, 150.0), (1, 170.0), (1, -170.0), (2, 0.0)].into_iter().enumerate() {
            (plan.points[k].segment, plan.points[k].beta) = (segment, f64::to_radians(beta_deg));
        }
        let lines = plan_lines(&plan, |x, y| ((x * 10.0).round(), y.round()));
        assert_eq!(
            lines,
            [vec![(0.0, 150.0), (10.0, 170.0), (15.0, 180.0)], vec![(15.0, -180.0), (20.0, -170.0)], vec![(30.0, 0.0)]]
        );
    }
}
