//! The robot cell from above with the best and the worst placement (Caro 2013, Fig. 8).

use super::axes::{Panel, Scale, Ticks};
use super::canvas::{Canvas, Drawn, Lettering, Pixel, picture};
use super::colour::{BLUE, GREEN, GREY, INK, RED};
use crate::placement::outcome::{Case, Outcome, PlanPoint};
use crate::placement::problem::Problem;
use crate::report::number::fixed;
use crate::report::output::ReportError;
use crate::robot::Frames;
use nalgebra::Vector3;
use plotters::style::RGBColor;
use std::f64::consts::TAU;

/// Room left of, right of, above and below a panel. Pixels
const MARGIN: (i32, i32, i32, i32) = (92, 24, 62, 50);
/// Height of the legend. Pixels
const LEGEND: i32 = 62;
/// Height of the title. Pixels
const HEAD: i32 = 40;
/// Most segments whose numbers are all shown.
const NUMBERS: usize = 12;

/// The cell from above in the robot base frame, both axes to the same scale: the best placement in one panel, the worst in
/// another, each with the tool path as it lies and the direction to the wrist centre in the middle of each segment.
///
/// # Errors
/// [`ReportError::Format`] when the drawing fails.
pub fn cell(problem: &Problem, outcome: &Outcome) -> Result<String, ReportError> {
    let [best, _, worst, _] = &outcome.cases;
    let view = View::around(problem, [best, worst]);
    let size = view.picture_size();
    picture("the picture of the cell", (size.0 as u32, size.1 as u32), |canvas| {
        canvas.text("The cell from above, in the robot base frame", (MARGIN.0, 24), Lettering::new(17.0).bold())?;
        for (index, (title, case, colour)) in
            [("Best placement", best, GREEN), ("Worst placement", worst, RED)].into_iter().enumerate()
        {
            let scene = Scene { problem, case, colour, panel: view.panel(index as i32) };
            scene.draw(canvas, title)?;
        }
        legend(canvas, problem, size.1 - LEGEND)
    })
}

/// What part of the plane is shown, and how large.
struct View {
    /// Lower ends of x and y. mm
    from: [f64; 2],
    /// Upper ends of x and y. mm
    to: [f64; 2],
    /// Width and height of a panel. Pixels
    size: (i32, i32),
    /// Whether the panels stand side by side.
    beside: bool,
}

impl View {
    /// Shows the base, the cell, and of each case the tool path and the wrist centres drawn.
    fn around(problem: &Problem, cases: [&Case; 2]) -> Self {
        let [x, y, _] = problem.cell.position;
        let mut points = vec![[0.0, 0.0], [x.min * 1e3, y.min * 1e3], [x.max * 1e3, y.max * 1e3]];
        for case in cases {
            points.extend(case.plan.points.iter().map(|point| top_view(&point.position)));
            points.extend(middles(problem, case).map(|point| top_view(&wrist_centre(problem, point))));
        }
        let bound = |k: usize, start: f64, better: fn(f64, f64) -> f64| points.iter().map(|p| p[k]).fold(start, better);
        let from = [0, 1].map(|k| bound(k, f64::INFINITY, f64::min));
        let to = [0, 1].map(|k| bound(k, f64::NEG_INFINITY, f64::max));
        let margin = 0.07 * (to[0] - from[0]).max(to[1] - from[1]).max(100.0);
        let (from, to) = (from.map(|v| v - margin), to.map(|v| v + margin));
        let extent = [to[0] - from[0], to[1] - from[1]];
        let beside = extent[1] > 0.8 * extent[0];
        let (width, height) = if beside { (480.0, 720.0) } else { (980.0, 400.0) };
        let scale = (width / extent[0]).min(height / extent[1]);
        Self { from, to, size: extent.map(|v| (v * scale).round() as i32).into(), beside }
    }

    fn picture_size(&self) -> Pixel {
        let (left, right, above, below) = MARGIN;
        let (width, height) = (self.size.0 + left + right, self.size.1 + above + below);
        let (width, height) = if self.beside { (2 * width, height) } else { (width, 2 * height) };
        (width.max(820), HEAD + height + LEGEND)
    }

    fn panel(&self, index: i32) -> Panel {
        let (left, right, above, below) = MARGIN;
        let (dx, dy) = if self.beside { (self.size.0 + left + right, 0) } else { (0, self.size.1 + above + below) };
        let (left, top) = (left + index * dx, HEAD + above + index * dy);
        let x = Scale::new(self.from[0], self.to[0], left, left + self.size.0);
        let y = Scale::new(self.from[1], self.to[1], top + self.size.1, top);
        let most = |pixels: i32| (pixels / 65).max(2) as usize;
        let (x_ticks, y_ticks) = (Ticks::round(&x, most(self.size.0)), Ticks::round(&y, most(self.size.1)));
        Panel { x, y, x_ticks, y_ticks, x_label: "x (mm)", y_label: "y (mm)" }
    }
}

/// One placement in its panel.
struct Scene<'a> {
    problem: &'a Problem,
    case: &'a Case,
    colour: RGBColor,
    panel: Panel,
}

impl Scene<'_> {
    fn draw(&self, canvas: &Canvas<'_>, title: &str) -> Drawn {
        let (left, top) = (self.panel.x.start, self.panel.y.end);
        canvas.text(title, (left, top - 38), Lettering::new(13.0).bold().coloured(self.colour))?;
        let place = &self.case.placement;
        let [x, y, z] = [place.x, place.y, place.z].map(|value| fixed(value * 1e3, 1));
        let yaw = fixed(place.yaw.to_degrees(), 1);
        let mean = fixed(self.case.plan.mean * 1e3, 4);
        let words = format!("({x}, {y}, {z}) mm, yaw {yaw} deg; mean {mean} mm");
        canvas.text(&words, (left, top - 18), Lettering::new(12.0).coloured(INK))?;
        self.panel.draw_grid(canvas)?;
        self.reach(canvas)?;
        self.limits(canvas)?;
        self.base(canvas)?;
        self.wrist(canvas)?;
        self.path(canvas)?;
        self.workpiece(canvas)?;
        self.panel.draw_frame(canvas)
    }

    fn pixel(&self, point: &Vector3<f64>) -> Pixel {
        let [x, y] = top_view(point);
        self.panel.pixel(x, y)
    }

    fn shows(&self, (x, y): Pixel) -> bool {
        (self.panel.x.start..=self.panel.x.end).contains(&x) && (self.panel.y.end..=self.panel.y.start).contains(&y)
    }

    /// The circle that the wrist centre cannot leave, as far as it is inside the panel.
    fn reach(&self, canvas: &Canvas<'_>) -> Drawn {
        if !is_upright(self.problem) {
            return Ok(());
        }
        let geometry = self.problem.robot.geometry();
        let circle: Vec<Pixel> = (0..=720)
            .map(|k| {
                let (sine, cosine) = libm::sincos(TAU * f64::from(k) / 720.0);
                self.pixel(&(geometry.root_in_base + Vector3::new(cosine, sine, 0.0) * geometry.reach()))
            })
            .collect();
        for run in circle.chunk_by(|a, b| self.shows(*a) == self.shows(*b)) {
            if run.len() > 1 && self.shows(run[0]) {
                canvas.line(run.to_vec(), BLUE, 2)?;
            }
        }
        Ok(())
    }

    fn limits(&self, canvas: &Canvas<'_>) -> Drawn {
        let [x, y, _] = self.problem.cell.position;
        let [a, b, c, d] = [(x.min, y.min), (x.max, y.min), (x.max, y.max), (x.min, y.max)]
            .map(|(x, y)| self.pixel(&Vector3::new(x, y, 0.0)));
        [(a, b), (b, c), (c, d), (d, a)].into_iter().try_for_each(|(from, to)| canvas.dashed(from, to, INK))
    }

    fn base(&self, canvas: &Canvas<'_>) -> Drawn {
        let (x, y) = self.pixel(&Vector3::zeros());
        canvas.arrow((x, y), (x + 40, y), GREY, 2)?;
        canvas.arrow((x, y), (x, y - 40), GREY, 2)?;
        canvas.fill((x - 8, y - 8), (x + 8, y + 8), INK)?;
        let lettering = Lettering::new(12.0).coloured(INK);
        canvas.text("x", (x + 50, y), lettering)?;
        canvas.text("y", (x + 8, y - 42), lettering)?;
        canvas.text("robot base", (x - 14, y), lettering.ending())
    }

    fn wrist(&self, canvas: &Canvas<'_>) -> Drawn {
        for point in middles(self.problem, self.case) {
            let centre = self.pixel(&wrist_centre(self.problem, point));
            canvas.line(vec![self.pixel(&point.position), centre], GREY, 1)?;
            canvas.dot(centre, 3, GREY)?;
        }
        Ok(())
    }

    /// The tool path; numbers stand in the middle of the segments.
    fn path(&self, canvas: &Canvas<'_>) -> Drawn {
        for run in self.case.plan.points.chunk_by(|a, b| a.segment == b.segment) {
            canvas.edged_line(run.iter().map(|point| self.pixel(&point.position)).collect(), self.colour, 3)?;
        }
        let stride = self.problem.task.segments().len().div_ceil(NUMBERS).max(1);
        for point in middles(self.problem, self.case).step_by(stride) {
            let (x, y) = self.pixel(&point.position);
            canvas.dot((x, y), 8, self.colour)?;
            let lettering = Lettering::new(11.0).bold().centred().coloured(plotters::style::WHITE);
            canvas.text(&point.segment.to_string(), (x, y), lettering)?;
        }
        Ok(())
    }

    fn workpiece(&self, canvas: &Canvas<'_>) -> Drawn {
        let base_from_workpiece = self.case.placement.base_from_workpiece();
        let origin = self.pixel(&base_from_workpiece.translation);
        for (axis, name) in [(0, "x"), (1, "y")] {
            let direction = base_from_workpiece.rotation.column(axis).into_owned();
            let at = |length: f64| {
                (origin.0 + (direction.x * length).round() as i32, origin.1 - (direction.y * length).round() as i32)
            };
            canvas.arrow(origin, at(44.0), INK, 2)?;
            canvas.text(name, at(58.0), Lettering::new(12.0).centred().bold().coloured(INK))?;
        }
        canvas.dot(origin, 5, INK)
    }
}

fn legend(canvas: &Canvas<'_>, problem: &Problem, top: i32) -> Drawn {
    let lettering = Lettering::new(12.0);
    let (first, second) = (MARGIN.0, MARGIN.0 + 360);
    let (upper, lower) = (top + 14, top + 40);
    canvas.dashed((first, upper), (first + 32, upper), INK)?;
    canvas.text("where the workpiece origin may stand", (first + 42, upper), lettering)?;
    canvas.dot((first + 16, lower), 5, INK)?;
    canvas.text("workpiece origin and axes", (first + 42, lower), lettering)?;
    canvas.line(vec![(second, lower), (second + 29, lower)], GREY, 1)?;
    canvas.dot((second + 29, lower), 3, GREY)?;
    canvas.text("from tool path to wrist centre, mid-segment", (second + 42, lower), lettering)?;
    if is_upright(problem) {
        let reach = format!("reach of the wrist centre, {} mm", fixed(problem.robot.geometry().reach() * 1e3, 0));
        canvas.line(vec![(second, upper), (second + 32, upper)], BLUE, 2)?;
        canvas.text(&reach, (second + 42, upper), lettering)?;
    }
    Ok(())
}

/// Whether axis 1 is vertical, so that its circles look like circles from above.
fn is_upright(problem: &Problem) -> bool {
    problem.robot.geometry().base_from_root[(2, 2)].abs() > 1.0 - 1e-9
}

/// The middle point of each segment.
fn middles<'a>(problem: &'a Problem, case: &'a Case) -> impl Iterator<Item = &'a PlanPoint> {
    let segments = problem.task.segments().iter();
    segments.filter_map(|range| case.plan.points.get((range.start + range.end) / 2))
}

fn wrist_centre(problem: &Problem, point: &PlanPoint) -> Vector3<f64> {
    Frames::new(&problem.robot, &point.joints).wrist_centre()
}

/// x and y in mm.
fn top_view(point: &Vector3<f64>) -> [f64; 2] {
    [point.x * 1e3, point.y * 1e3]
}
