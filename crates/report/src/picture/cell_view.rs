//! What there is to see of a robot cell from above, to be drawn into a panel.

use super::axes::Panel;
use super::canvas::{Canvas, LineStyle, Place, TextStyle, nearest};
use super::colour::{BLUE, Colour, GREY, INK, PALE};
use nalgebra::Vector3;
use std::f64::consts::TAU;
use stead_model::robot::Frames;
use stead_placement::outcome::{Case, PlanPoint};
use stead_problem::problem::Problem;

/// Most segments whose numbers are all shown.
const NUMBERS: usize = 12;

/// A panel with the cell seen from above; its axes are x and y of the robot base frame in mm, to the same scale.
pub(super) struct CellView<'a> {
    /// What the cell is part of.
    pub problem: &'a Problem,
    /// Where to draw.
    pub panel: Panel,
}

impl CellView<'_> {
    fn place(&self, point: &Vector3<f64>) -> Place {
        let [x, y] = top_view(point);
        self.panel.place(x, y)
    }

    fn shows(&self, place: Place) -> bool {
        let (x, y) = nearest(place);
        let (x_pixels, y_pixels) = (self.panel.x.start..=self.panel.x.end, self.panel.y.end..=self.panel.y.start);
        x_pixels.contains(&x) && y_pixels.contains(&y)
    }

    /// The circle that the wrist centre cannot leave, as far as it is inside the panel.
    pub fn reach(&self, canvas: &mut Canvas) {
        if !is_upright(self.problem) {
            return;
        }
        let geometry = self.problem.robot.geometry();
        let circle: Vec<Place> = (0..=720)
            .map(|k| {
                let (sine, cosine) = libm::sincos(TAU * f64::from(k) / 720.0);
                self.place(&(geometry.root_in_base + Vector3::new(cosine, sine, 0.0) * geometry.reach()))
            })
            .collect();
        for run in circle.chunk_by(|a, b| self.shows(*a) == self.shows(*b)) {
            if run.len() > 1 && self.shows(run[0]) {
                canvas.curve(run, BLUE, 2);
            }
        }
    }

    /// A dashed rectangle around the allowed places of the workpiece origin.
    pub fn limits(&self, canvas: &mut Canvas) {
        let [x, y, _] = self.problem.cell.position;
        let corners = [(x.min, y.min), (x.max, y.min), (x.max, y.max), (x.min, y.max)];
        let [a, b, c, d] = corners.map(|(x, y)| nearest(self.place(&Vector3::new(x, y, 0.0))));
        [(a, b), (b, c), (c, d), (d, a)].into_iter().for_each(|(from, to)| canvas.dashed(from, to, INK));
    }

    /// The robot base with the axes of its frame; those of the cell frame for an arm that is mounted in it.
    pub fn base(&self, canvas: &mut Canvas) {
        let origin = self.place(&Vector3::zeros());
        let (x, y) = nearest(origin);
        let is_mounted = self.problem.robot.is_mounted();
        if is_mounted {
            let (x, y) = nearest(self.place(&self.problem.robot.cell_from_base::<f64>().translation));
            canvas.fill((x - 8, y - 8), (x + 8, y + 8), INK);
            canvas.text("robot base", (x - 14, y - 16), TextStyle::new(12.0).coloured(INK).ending());
        }
        canvas.arrow(origin, (origin.0 + 40.0, origin.1), GREY, 2);
        canvas.arrow(origin, (origin.0, origin.1 - 40.0), GREY, 2);
        let style = TextStyle::new(12.0).coloured(INK);
        if is_mounted {
            canvas.dot(origin, 4, GREY);
        } else {
            canvas.fill((x - 8, y - 8), (x + 8, y + 8), INK);
        }
        canvas.text("x", (x + 51, y), style);
        canvas.text("y", (x + 8, y - 42), style);
        canvas.text(if is_mounted { "cell" } else { "robot base" }, (x - 14, y), style.ending())
    }

    /// Lines from the middle of each segment to the wrist centre.
    pub fn wrists(&self, canvas: &mut Canvas, case: &Case) {
        for point in middles(self.problem, case) {
            let centre = self.place(&wrist_centre(self.problem, point));
            canvas.curve(&[self.place(&point.position), centre], PALE, 1);
            canvas.dot(centre, 3, GREY);
        }
    }

    /// The tool path as it lies.
    pub fn path(&self, canvas: &mut Canvas, case: &Case, line: LineStyle) {
        for run in case.plan.points.chunk_by(|a, b| a.segment == b.segment) {
            let places: Vec<Place> = run.iter().map(|point| self.place(&point.position)).collect();
            canvas.edged_curve(&places, line, 3);
        }
    }

    /// The numbers of the segments, to the left of their middle points.
    pub fn numbers(&self, canvas: &mut Canvas, case: &Case, colour: Colour) {
        let stride = self.problem.task.segments().len().div_ceil(NUMBERS).max(1);
        let problem = self.problem.in_setup(&case.setup);
        for point in middles(self.problem, case).step_by(stride) {
            let left = problem.placed(point.point, &case.placement).axes.column(1).into_owned();
            let place = beside(self.place(&point.position), &left, 14.0);
            let style = TextStyle::new(13.0).bold().centred().coloured(colour);
            canvas.text(&point.segment.to_string(), nearest(place), style);
        }
    }

    /// Origin and axes of the workpiece frame, the letters outside the right angle between the axes.
    pub fn workpiece(&self, canvas: &mut Canvas, case: &Case) {
        let base_from_workpiece = self.problem.in_setup(&case.setup).base_from_workpiece(0, &case.placement);
        let origin = self.place(&base_from_workpiece.translation);
        let [x, y] = [0, 1].map(|axis| base_from_workpiece.rotation.column(axis).into_owned());
        for (axis, other, name) in [(x, y, "x"), (y, x, "y")] {
            let tip = beside(origin, &axis, 36.0);
            canvas.arrow(origin, tip, INK, 2);
            let place = beside(tip, &other, -12.0);
            canvas.text(name, nearest(place), TextStyle::new(12.0).centred().coloured(INK));
        }
        canvas.dot(origin, 4, INK)
    }

    /// The workpiece origin alone.
    pub fn origin(&self, canvas: &mut Canvas, case: &Case) {
        let base_from_workpiece = self.problem.in_setup(&case.setup).base_from_workpiece(0, &case.placement);
        canvas.dot(self.place(&base_from_workpiece.translation), 4, INK)
    }
}

/// The place at a distance in pixels from another, in a direction of the base frame.
fn beside(place: Place, direction: &Vector3<f64>, distance: f64) -> Place {
    (place.0 + direction.x * distance, place.1 - direction.y * distance)
}

/// Whether axis 1 is vertical, so that its circles look like circles from above.
pub(super) fn is_upright(problem: &Problem) -> bool {
    problem.robot.geometry().base_from_root[(2, 2)].abs() > 1.0 - 1e-9
}

/// The middle point of each segment.
pub(super) fn middles<'a>(problem: &'a Problem, case: &'a Case) -> impl Iterator<Item = &'a PlanPoint> {
    let segments = problem.task.segments().iter();
    segments.filter_map(|range| case.plan.points.get((range.start + range.end) / 2))
}

/// The wrist centre in the robot base frame. m
pub(super) fn wrist_centre(problem: &Problem, point: &PlanPoint) -> Vector3<f64> {
    Frames::new(&problem.robot, &point.joints).wrist_centre()
}

/// x and y in mm.
pub(super) fn top_view(point: &Vector3<f64>) -> [f64; 2] {
    [point.x * 1e3, point.y * 1e3]
}
