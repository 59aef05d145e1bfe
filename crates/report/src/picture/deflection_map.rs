//! The deflection over path point and beta, with both plans (Caro 2013, Fig. 7 and 9).

use super::axes::{Panel, Scale, Ticks};
use super::canvas::{Canvas, Drawn, Lettering, Pixel, Place, picture};
use super::colour::{GREEN, GREY, INK, LEVELS, RED, ground, viridis};
use super::hatch::{Slope, hatch};
use crate::names;
use crate::output::ReportError;
use crate::units::fixed;
use plotters::style::{RGBColor, WHITE};
use std::collections::BTreeSet;
use stead_placement::outcome::{Blocked, Case, DeflectionMap, MapCell, Plan};
use stead_placement::problem::Problem;

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

/// A heat map of the smallest allowed score over path point and beta, with the best and the worst plan of that placement.
/// States without an allowed posture have a pale ground that tells the reason. A path of more than 240 points is thinned
/// out evenly, the plans are not.
///
/// # Errors
/// [`ReportError::Format`] when the drawing fails.
pub fn deflection_map(
    problem: &Problem,
    map: &DeflectionMap,
    best: &Case,
    worst: &Case,
) -> Result<String, ReportError> {
    picture("the picture of a deflection map", SIZE, |canvas| Picture::new(problem, map, best, worst).draw(canvas))
}

struct Picture<'a> {
    problem: &'a Problem,
    map: &'a DeflectionMap,
    best: &'a Case,
    worst: &'a Case,
    panel: Panel,
    /// Score at the bright end of the colour scale. m
    brightest: f64,
    /// Path point shown in each column.
    columns: Vec<usize>,
    /// Left edges of the columns and the right edge of the last. Pixels
    column_edges: Vec<i32>,
    /// Lower edges of the rows and the upper edge of the last. Pixels
    row_edges: Vec<i32>,
}

/// What a cell of the map looks like.
#[derive(Clone, Copy, PartialEq)]
enum Look {
    Level(usize),
    Blocked(Blocked),
}

impl<'a> Picture<'a> {
    fn new(problem: &'a Problem, map: &'a DeflectionMap, best: &'a Case, worst: &'a Case) -> Self {
        let points = map.rows.len();
        let x = Scale::new(-0.5, points as f64 - 0.5, LEFT, RIGHT);
        let y = Scale::new(-180.0, 180.0, BOTTOM, TOP);
        let stride = points.div_ceil(COLUMNS).max(1);
        let starts: Vec<usize> = (0..points).step_by(stride).collect();
        let columns = starts.iter().map(|start| (start + stride / 2).min(points - 1)).collect();
        let column_edges = starts.iter().chain([&points]).map(|start| x.pixel(*start as f64 - 0.5)).collect();
        let step = 360.0 / map.beta_count as f64;
        let row_edges = (0..=map.beta_count + 1).map(|k| y.clamped(-180.0 + (k as f64 - 0.5) * step)).collect();
        let x_ticks = Ticks::round(&x, 12);
        let y_ticks = Ticks::every(&y, 45.0, 0);
        let panel =
            Panel { x, y, x_ticks, y_ticks, x_label: "path point", y_label: "angle β about the tool axis (deg)" };
        Self { problem, map, best, worst, panel, brightest: brightest(map), columns, column_edges, row_edges }
    }

    fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        self.title(canvas)?;
        self.cells(canvas)?;
        self.hatching(canvas, Blocked::Conditioning, Slope::Up)?;
        self.hatching(canvas, Blocked::Deflection, Slope::Down)?;
        self.segments(canvas)?;
        self.plan(canvas, &self.worst.plan, RED)?;
        self.plan(canvas, &self.best.plan, GREEN)?;
        self.panel.draw_frame(canvas)?;
        self.colour_bar(canvas)?;
        self.legend(canvas)
    }

    fn title(&self, canvas: &Canvas<'_>) -> Drawn {
        let kind = names::sense(self.best.placement_sense);
        let title = format!("Deflection at the {kind} placement");
        canvas.text(&title, (LEFT, 24), Lettering::new(17.0).bold())?;
        let place = &self.best.placement;
        let [x, y, z] = [place.x, place.y, place.z].map(|value| fixed(value * 1e3, 1));
        let (q4, yaw) = (fixed(place.q4(), 4), fixed(place.yaw.to_degrees(), 1));
        let subtitle = format!(
            "x = {x} mm, y = {y} mm, z = {z} mm, Q4 = {q4} (yaw {yaw} deg); for each state the smallest over the allowed postures"
        );
        canvas.text(&subtitle, (LEFT, 47), Lettering::new(12.0).coloured(INK))
    }

    /// The look of a row of the picture: the grid value at -180 deg is half at the bottom and half at the top.
    fn look(&self, column: usize, row: usize) -> Look {
        match self.map.rows[self.columns[column]][row % self.map.beta_count] {
            Ok(MapCell { score, .. }) => {
                let part = if self.brightest > 0.0 { score / self.brightest } else { 0.0 };
                Look::Level(((part * LEVELS as f64) as usize).min(LEVELS - 1))
            }
            Err(blocked) => Look::Blocked(blocked),
        }
    }

    fn cells(&self, canvas: &Canvas<'_>) -> Drawn {
        for column in 0..self.columns.len() {
            let rows: Vec<usize> = (0..=self.map.beta_count).collect();
            for run in rows.chunk_by(|a, b| self.look(column, *a) == self.look(column, *b)) {
                let colour = match self.look(column, run[0]) {
                    Look::Level(level) => viridis(level),
                    Look::Blocked(blocked) => ground(blocked),
                };
                let (upper, lower) = (self.row_edges[run[0] + run.len()], self.row_edges[run[0]]);
                let (left, right) = (self.column_edges[column], self.column_edges[column + 1]);
                if colour != WHITE {
                    canvas.fill((left, upper), (right, lower), colour)?;
                }
            }
        }
        Ok(())
    }

    fn hatching(&self, canvas: &Canvas<'_>, blocked: Blocked, slope: Slope) -> Drawn {
        if !self.reasons().contains(&blocked) {
            return Ok(());
        }
        hatch(canvas, ((LEFT, TOP), (RIGHT, BOTTOM)), slope, GREY, |(x, y)| {
            let column = self.column_edges.partition_point(|edge| *edge <= x).saturating_sub(1);
            let row = self.row_edges.partition_point(|edge| *edge > y).saturating_sub(1);
            column < self.columns.len()
                && row <= self.map.beta_count
                && self.look(column, row) == Look::Blocked(blocked)
        })
    }

    fn reasons(&self) -> BTreeSet<Blocked> {
        self.map.rows.iter().flatten().filter_map(|cell| cell.err()).collect()
    }

    /// Borders of the segments, and above them their numbers and postures, as far as there is room.
    fn segments(&self, canvas: &Canvas<'_>) -> Drawn {
        let segments = self.problem.task.segments();
        let narrowest = segments.iter().map(|range| self.panel.x.pixel(range.len() as f64) - self.panel.x.pixel(0.0));
        let narrowest = narrowest.min().unwrap_or(0);
        if (NARROW..MEDIUM).contains(&narrowest) {
            let heading = Lettering::new(11.5).ending();
            canvas.text("segment", (LEFT - 8, TOP - 43), heading.bold().coloured(INK))?;
            canvas.text("posture", (LEFT - 8, TOP - 26), heading.coloured(GREEN))?;
            canvas.text("posture", (LEFT - 8, TOP - 10), heading.coloured(RED))?;
        }
        for (index, range) in segments.iter().enumerate() {
            let (left, right) = (self.edge(range.start), self.edge(range.end));
            if index > 0 {
                canvas.line(vec![(left, TOP - 50), (left, BOTTOM)], INK, 1)?;
            }
            if narrowest < NARROW {
                continue;
            }
            let middle = (left + right) / 2;
            let (segment, posture) = if narrowest < MEDIUM { ("", "") } else { ("segment ", "posture ") };
            let lettering = Lettering::new(11.5).centred();
            canvas.text(&format!("{segment}{}", index + 1), (middle, TOP - 43), lettering.bold().coloured(INK))?;
            for (plan, colour, up) in [(&self.best.plan, GREEN, 26), (&self.worst.plan, RED, 10)] {
                if let Some(number) = plan.postures.get(index) {
                    canvas.text(&format!("{posture}{number}"), (middle, TOP - up), lettering.coloured(colour))?;
                }
            }
        }
        Ok(())
    }

    fn edge(&self, point: usize) -> i32 {
        self.panel.x.pixel(point as f64 - 0.5)
    }

    fn plan(&self, canvas: &Canvas<'_>, plan: &Plan, colour: RGBColor) -> Drawn {
        for run in plan_lines(plan, |point, beta_deg| self.panel.place(point, beta_deg)) {
            match run[..] {
                [alone] => canvas.dot(alone, 3, colour)?,
                _ => canvas.edged_curve(&run, colour, 3)?,
            }
        }
        Ok(())
    }

    fn colour_bar(&self, canvas: &Canvas<'_>) -> Drawn {
        let (left, right) = (RIGHT + 28, RIGHT + 48);
        let edges = Scale::new(0.0, LEVELS as f64, BOTTOM, TOP);
        for level in 0..LEVELS {
            let (lower, upper) = (edges.pixel(level as f64), edges.pixel(level as f64 + 1.0));
            canvas.fill((left, upper), (right, lower), viridis(level))?;
        }
        canvas.outline((left, TOP), (right, BOTTOM), INK)?;
        let largest = scores(self.map).fold(0.0, f64::max);
        if largest > self.brightest {
            let beyond = format!("up to {}", fixed(largest * 1e3, 2));
            canvas.text(&beyond, (left, TOP - 12), Lettering::new(12.0).coloured(INK))?;
        }
        let scale = Scale::new(0.0, self.brightest * 1e3, BOTTOM, TOP);
        let ticks = Ticks::round(&scale, 9);
        let mut widest = 0;
        for value in &ticks.values {
            let (y, label) = (scale.pixel(*value), ticks.label(*value));
            let lettering = Lettering::new(12.0).coloured(INK);
            widest = widest.max(lettering.width(&label));
            canvas.line(vec![(right, y), (right + 5, y)], INK, 1)?;
            canvas.text(&label, (right + 8, y), lettering)?;
        }
        let place = (right + 8 + widest + 16, (TOP + BOTTOM) / 2);
        canvas.text("deflection normal to the feed (mm)", place, Lettering::new(13.0).centred().upwards())
    }

    /// The plans, and the reasons that occur.
    fn legend(&self, canvas: &Canvas<'_>) -> Drawn {
        let lettering = Lettering::new(12.0);
        let mut x = LEFT;
        for (kind, plan, colour) in [("best", &self.best.plan, GREEN), ("worst", &self.worst.plan, RED)] {
            let (mean, max) = (fixed(plan.mean * 1e3, 4), fixed(plan.max * 1e3, 4));
            let label = format!("{kind} plan: mean {mean} mm, largest {max} mm");
            canvas.line(vec![(x, 632), (x + 32, 632)], colour, 3)?;
            canvas.text(&label, (x + 40, 632), lettering)?;
            x += 40 + lettering.width(&label) + 24;
        }
        let reasons = self.reasons();
        if reasons.is_empty() {
            return Ok(());
        }
        let indent = LEFT + lettering.width("not allowed:") + 10;
        let mut y = 664;
        canvas.text("not allowed:", (LEFT, y), lettering)?;
        x = indent;
        for blocked in reasons {
            let label = names::reason_in_legend(blocked);
            let width = 33 + lettering.width(&label);
            if x + width > SIZE.0 {
                (x, y) = (indent, y + 26);
            }
            let corners = ((x, y - 8), (x + 26, y + 8));
            canvas.fill(corners.0, corners.1, ground(blocked))?;
            match blocked {
                Blocked::Conditioning => hatch(canvas, corners, Slope::Up, GREY, |_| true)?,
                Blocked::Deflection => hatch(canvas, corners, Slope::Down, GREY, |_| true)?,
                Blocked::Reach | Blocked::JointLimit(_) => {}
            }
            canvas.outline(corners.0, corners.1, GREY)?;
            canvas.text(&label, (x + 33, y), lettering)?;
            x += width + 12;
        }
        Ok(())
    }
}

fn scores(map: &DeflectionMap) -> impl Iterator<Item = f64> + '_ {
    map.rows.iter().flatten().flatten().map(|cell| cell.score)
}

/// The score at the bright end of the colour scale: the largest, but where few states are far above all others, the one
/// that 97 of 100 states do not pass, so that a peak does not leave the rest in the dark. m
fn brightest(map: &DeflectionMap) -> f64 {
    let mut sorted: Vec<f64> = scores(map).collect();
    sorted.sort_by(f64::total_cmp);
    let largest = sorted.last().copied().unwrap_or(0.0);
    let common = sorted.get(sorted.len() * 97 / 100).copied().unwrap_or(0.0);
    if common > 0.0 && largest > 1.5 * common { common } else { largest }
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
