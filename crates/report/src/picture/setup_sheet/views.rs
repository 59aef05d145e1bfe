//! Plan and elevation of a setup, to one scale, with dimension lines from the origin of the frame.

use super::super::axes::around;
use super::super::canvas::{Canvas, Pixel, Place, TextStyle, exact, nearest};
use super::super::colour::{BLACK, GREY, WHITE};
use super::super::labels::{Label, Labeller};
use super::super::surroundings::{arm, corners_at, hull};
use super::words::{deg, mm};
use super::{SIDES, SIZES};
use nalgebra::Vector3;
use stead_cell::{Attachment, Shape};
use stead_model::external_axis::{AxisKind, Carried, carried};
use stead_model::robot::Pose;
use stead_numerics::rotation::zyx_from_rotation;
use stead_placement::outcome::Case;
use stead_placement::setup_sheet::{SetupSheet, SheetFrame};
use stead_problem::problem::Problem;

/// Width of a view.
const WIDTH: i32 = 368;
/// What dimension lines take to the left and below.
const MARGIN: i32 = 46;
/// What a view keeps free elsewhere.
const FREE: i32 = 34;
/// Scales: 1 to so many.
const SCALES: [f64; 14] = [2.0, 3.0, 4.0, 5.0, 7.5, 10.0, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0, 75.0, 100.0];
/// Pixels for a metre at full scale.
const PIXELS: f64 = 4000.0;
/// A box of the path is drawn at least so large. m
const LEAST: f64 = 1e-3;

/// A line of a view, in coordinates of the frame. m
struct Line {
    points: Vec<Vector3<f64>>,
    width: i32,
    is_dashed: bool,
    is_outline: bool,
}

/// Both views, from a height on and so high.
pub(super) fn draw(canvas: &mut Canvas, problem: &Problem, case: &Case, sheet: &SetupSheet, (top, height): (i32, i32)) {
    let size = [WIDTH, height];
    let datum = sheet.part.translation;
    // The elevation shows the direction in which the part is farther away.
    let aside = if datum.y.abs() > datum.x.abs() { 1 } else { 0 };
    let lines = lines(problem, case, sheet);
    let axes = [[0, 1], [aside, 2]];
    let kept = shown(&lines, sheet);
    let extent = |[h, v]: [usize; 2]| around(kept.iter().map(|place| [place[h], place[v]])).unwrap_or_default();
    let windows = axes.map(extent);
    let fits = |scale: f64| {
        windows.iter().all(|[low, high]| {
            let room = size.map(|side| f64::from(side - MARGIN - FREE));
            (0..2).all(|k| (high[k] - low[k]) * PIXELS / scale <= room[k])
        })
    };
    let scale = SCALES.into_iter().find(|scale| fits(*scale)).unwrap_or(200.0);
    let names = ["x", "y", "z"];
    let titles = [
        format!("Plan, from above, 1 : {scale}"),
        format!("Elevation, {} to the right and z upwards, 1 : {scale}", names[aside]),
    ];
    for (k, (window, axes)) in windows.into_iter().zip(axes).enumerate() {
        let left = SIDES[0] + k as i32 * (SIDES[1] - SIDES[0] - size[0]);
        canvas.text(&titles[k], (left, top + 6), TextStyle::new(12.5).bold());
        if k == 0 {
            let [a, b, c] = zyx_from_rotation(&sheet.part.rotation).map(deg);
            let words = format!("part turned: A {a}, B {b}, C {c}");
            canvas.text(&words, (left + size[0], top + 6), TextStyle::new(SIZES[1]).ending());
        }
        let view = View { corner: (left, top + 18), size, axes, window, scale };
        view.draw(canvas, &lines, problem, sheet);
        canvas.outline((left, top + 18), (left + size[0], top + 18 + size[1]), BLACK);
    }
    let mut legend = vec!["thick: part", "dashed: extent of the path", "1 2 3: check points"];
    legend.push(if sheet.axes.is_empty() {
        "line with dots: arm at check point 1"
    } else {
        "dash-dotted: external axes, those of the part at zero"
    });
    let has_part_shape = problem
        .scene
        .as_ref()
        .is_some_and(|scene| scene.surroundings().shapes().iter().any(|shape| shape.attached == Attachment::Workpiece));
    if !has_part_shape {
        legend.remove(0);
    }
    if problem.scene.is_some() {
        legend.push("thin: surroundings, cut at the edge");
    }
    canvas.text(&legend.join("; "), (SIDES[0], top + 18 + size[1] + 10), TextStyle::new(SIZES[1]));
}

/// What must be in view: origin, datum, robot, path, and what carries the part.
fn shown(lines: &[Line], sheet: &SetupSheet) -> Vec<Vector3<f64>> {
    let own = lines.iter().filter(|line| line.is_outline).flat_map(|line| line.points.iter().copied());
    own.chain([Vector3::zeros(), sheet.part.translation, sheet.robot.translation]).collect()
}

/// The closed outline of the hull of points in a view is made by the view; here are its points.
fn lines(problem: &Problem, case: &Case, sheet: &SetupSheet) -> Vec<Line> {
    let task = problem.task.points();
    let placed = sheet_from_placed(problem, sheet);
    let mut lines = Vec::new();
    let shapes = problem.scene.as_deref().map_or(&[][..], |scene| scene.surroundings().shapes());
    for shape in shapes {
        if let Some((pose, width, is_outline)) = stands(problem, sheet, shape) {
            let points = corners_at(shape, &pose);
            lines.push(Line { points, width, is_dashed: false, is_outline });
        }
    }
    // The box of the path in the frame of the task.
    let ends = |k: usize| {
        let values = || task.iter().map(|point| point.position[k]);
        let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        [low, high.max(low + LEAST)]
    };
    let ends = [ends(0), ends(1), ends(2)];
    let corner = |bits: usize| placed.point(&Vector3::from_fn(|k, _| ends[k][bits >> k & 1]));
    lines.push(Line { points: (0..8).map(corner).collect(), width: 1, is_dashed: true, is_outline: true });
    if sheet.axes.is_empty()
        && let Some(check) = sheet.check_points.first()
        && let Some(point) = case.plan.points.get(check.point)
    {
        let points = arm(problem, point).iter().map(|joint| sheet.sheet_from_cell.point(joint)).collect();
        lines.push(Line { points, width: 2, is_dashed: false, is_outline: true });
    }
    lines
}

/// The task as it is placed, all axes at zero, in the frame of the sheet: the task of a setup is turned already.
fn sheet_from_placed(problem: &Problem, sheet: &SetupSheet) -> Pose<f64> {
    let turned = problem.orientation().map_or(nalgebra::Matrix3::identity(), |of| of.rotation);
    Pose { rotation: sheet.part.rotation * turned.transpose(), ..sheet.part }
}

/// Where a shape stands, how boldly it is drawn, and whether it must be in view; nothing for shapes on the arm.
fn stands(problem: &Problem, sheet: &SetupSheet, shape: &Shape) -> Option<(Pose<f64>, i32, bool)> {
    let of_cell = |cell_from_it: Pose<f64>| sheet.sheet_from_cell.then(&cell_from_it).then(&shape.pose);
    match shape.attached {
        Attachment::Base => Some((of_cell(Pose::identity()), 1, false)),
        Attachment::Workpiece => Some((sheet.part.then(&shape.pose), 3, true)),
        Attachment::Axis(number) => {
            let axes = problem.external_axes.get(..=usize::from(number))?;
            let carries = axes.last()?.carries;
            let zeros = vec![0.0; axes.len()];
            let positions = if carries == Carried::Robot { problem.axis_positions(0) } else { &zeros };
            Some((of_cell(carried(axes, positions, carries)), 1, true))
        }
        Attachment::Link(_) | Attachment::Flange => None,
    }
}

/// A view along an axis.
struct View {
    corner: Pixel,
    /// Width and height.
    size: [i32; 2],
    /// Which axes go to the right and upwards.
    axes: [usize; 2],
    /// The extent of what must be in view. m
    window: [[f64; 2]; 2],
    scale: f64,
}

impl View {
    fn place(&self, point: &Vector3<f64>) -> Place {
        let factor = PIXELS / self.scale;
        let [low, high] = self.window;
        let middle = [0, 1].map(|k| (low[k] + high[k]) / 2.0);
        let (width, height) = (f64::from(self.size[0] - MARGIN - FREE), f64::from(self.size[1] - MARGIN - FREE));
        (
            f64::from(self.corner.0 + MARGIN) + width / 2.0 + (point[self.axes[0]] - middle[0]) * factor,
            f64::from(self.corner.1 + FREE) + height / 2.0 - (point[self.axes[1]] - middle[1]) * factor,
        )
    }

    /// A direction on the paper, as long as it is seen.
    fn seen(&self, direction: &Vector3<f64>) -> (f64, f64) {
        (direction[self.axes[0]], -direction[self.axes[1]])
    }

    fn draw(&self, canvas: &mut Canvas, lines: &[Line], problem: &Problem, sheet: &SetupSheet) {
        for line in lines {
            self.line(canvas, line);
        }
        self.dimensions(canvas, sheet);
        self.axes_of_cell(canvas, sheet);
        let mut named = self.robot(canvas, sheet);
        named.extend(self.part(canvas, sheet));
        named.extend(self.check_points(canvas, problem, sheet));
        let corner = (self.corner.0 + self.size[0], self.corner.1 + self.size[1]);
        let mut labeller = Labeller::new((self.corner, corner));
        let stands = [sheet.part.translation, sheet.robot.translation].map(|point| (self.place(&point), 6));
        for (at, half) in named.iter().map(|(_, at)| (*at, 3)).chain(stands) {
            let (x, y) = nearest(at);
            labeller.take(((x - half, y - half), (x + half, y + half)));
        }
        // Beside what it names, on the side that is free, to the lower right first.
        for (name, at) in &named {
            let label = Label { text: name, colour: BLACK, ground: WHITE };
            let around = |radius: f64| {
                (0..12).map(move |k| {
                    let turn = std::f64::consts::TAU * (f64::from(k) + 1.5) / 12.0;
                    nearest((at.0 + radius * libm::cos(turn), at.1 + radius * libm::sin(turn)))
                })
            };
            labeller.put(canvas, &label, [11.0, 15.0, 20.0, 26.0, 34.0, 44.0].into_iter().flat_map(around));
        }
    }

    /// A line: an arm as it is, all else by its outline.
    fn line(&self, canvas: &mut Canvas, line: &Line) {
        let places: Vec<Place> = line.points.iter().map(|point| self.place(point)).collect();
        let is_arm = line.width == 2;
        let corners = if is_arm { places } else { closed(hull(places.iter().map(|(x, y)| [*x, *y]).collect())) };
        for pair in corners.windows(2) {
            let Some([from, to]) = self.cut([pair[0], pair[1]]) else { continue };
            if line.is_dashed {
                canvas.dashed(nearest(from), nearest(to), BLACK);
            } else {
                canvas.curve(&[from, to], if line.width == 1 { GREY } else { BLACK }, line.width);
            }
        }
        if is_arm {
            corners.iter().for_each(|joint| canvas.dot(*joint, 3, BLACK));
        }
    }

    /// The part of a straight line inside the view (Liang and Barsky 1984).
    fn cut(&self, line: [Place; 2]) -> Option<[Place; 2]> {
        let ([from, to], (left, top)) = (line, exact(self.corner));
        let (right, bottom) = (left + f64::from(self.size[0]), top + f64::from(self.size[1]));
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let (mut start, mut end) = (0.0_f64, 1.0_f64);
        for (step, room) in [(-dx, from.0 - left), (dx, right - from.0), (-dy, from.1 - top), (dy, bottom - from.1)] {
            if step == 0.0 && room < 0.0 {
                return None;
            }
            if step < 0.0 {
                start = start.max(room / step);
            } else if step > 0.0 {
                end = end.min(room / step);
            }
        }
        let at = |share: f64| (from.0 + dx * share, from.1 + dy * share);
        (start < end).then(|| [at(start), at(end)])
    }

    /// External axes: rails and slanted axes as lines, others as crosses.
    fn axes_of_cell(&self, canvas: &mut Canvas, sheet: &SetupSheet) {
        for axis in &sheet.axes {
            let through = match axis.kind {
                AxisKind::Rail => sheet.robot.translation,
                AxisKind::Turntable => axis.point,
            };
            let (x, y) = self.place(&through);
            let (dx, dy) = self.seen(&axis.direction);
            let length = libm::hypot(dx, dy);
            let half = 60.0;
            if length > 0.05 {
                let ends = [-half, half].map(|along| (x + dx / length * along, y + dy / length * along));
                if let Some([from, to]) = self.cut(ends) {
                    canvas.dash_dotted(from, to, BLACK);
                    canvas.text(&axis.name, nearest((to.0 + 4.0, to.1 - 8.0)), TextStyle::new(SIZES[1]));
                }
            } else {
                canvas.dash_dotted((x - 14.0, y), (x + 14.0, y), BLACK);
                canvas.dash_dotted((x, y - 14.0), (x, y + 14.0), BLACK);
                canvas.text(&axis.name, nearest((x + 8.0, y + 18.0)), TextStyle::new(SIZES[1]));
            }
        }
    }

    /// The robot's own frame, and the origin of the frame of the sheet; returns the names of its axes and where they
    /// end.
    fn robot(&self, canvas: &mut Canvas, sheet: &SetupSheet) -> Vec<(String, Place)> {
        let (x, y) = nearest(self.place(&sheet.robot.translation));
        canvas.fill((x - 6, y - 6), (x + 6, y + 6), BLACK);
        let origin = self.place(&Vector3::zeros());
        if sheet.frame == SheetFrame::Cell {
            canvas.text("robot", (x + 11, y - 10), TextStyle::new(SIZES[1]).bold());
        }
        let names = self.axes.map(|axis| ["x", "y", "z"][axis]);
        let axes = [(26.0, 0.0), (0.0, -26.0)].into_iter().zip(names).map(|((dx, dy), name)| {
            let tip = (origin.0 + dx, origin.1 + dy);
            canvas.arrow(origin, tip, BLACK, 1);
            (name.to_owned(), tip)
        });
        let axes = axes.collect();
        canvas.dot(origin, 3, BLACK);
        axes
    }

    /// Axes of the part at its datum; returns their names and where they end.
    fn part(&self, canvas: &mut Canvas, sheet: &SetupSheet) -> Vec<(String, Place)> {
        let datum = self.place(&sheet.part.translation);
        let mut axes = Vec::new();
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let (dx, dy) = self.seen(&sheet.part.rotation.column(axis).into_owned());
            if libm::hypot(dx, dy) > 0.3 {
                let tip = (datum.0 + dx * 30.0, datum.1 + dy * 30.0);
                canvas.arrow(datum, tip, BLACK, 2);
                axes.push((name.to_owned(), tip));
            }
        }
        canvas.dot(datum, 5, BLACK);
        canvas.dot(datum, 2, WHITE);
        axes
    }

    /// The check points, all axes at zero; returns their numbers and places.
    fn check_points(&self, canvas: &mut Canvas, problem: &Problem, sheet: &SetupSheet) -> Vec<(String, Place)> {
        let placed = sheet_from_placed(problem, sheet);
        let numbered = (1..).zip(&sheet.check_points).filter_map(|(number, check)| {
            let point = problem.task.points().get(check.point)?;
            let at = self.place(&placed.point(&point.position));
            canvas.dot(at, 3, BLACK);
            Some((number.to_string(), at))
        });
        numbered.collect()
    }

    /// Lines from the origin to the datum with the distance along each axis of the view.
    fn dimensions(&self, canvas: &mut Canvas, sheet: &SetupSheet) {
        let (origin, datum) = (self.place(&Vector3::zeros()), self.place(&sheet.part.translation));
        let style = TextStyle::new(SIZES[0]);
        let [across, up] = self.axes.map(|axis| (["x", "y", "z"][axis], sheet.part.translation[axis]));
        let y = f64::from(self.corner.1 + self.size[1] - 26);
        let x = f64::from(self.corner.0 + 26);
        for end in [origin, datum] {
            self.thin(canvas, (end.0, end.1 + 8.0), (end.0, y + 5.0));
            self.thin(canvas, (end.0 - 8.0, end.1), (x - 5.0, end.1));
        }
        arrows(canvas, (origin.0, y), (datum.0, y));
        arrows(canvas, (x, origin.1), (x, datum.1));
        let middle = nearest(((origin.0 + datum.0) / 2.0, y + 13.0));
        canvas.text(&format!("{} {}", across.0, mm(across.1)), middle, style.centred());
        let middle = nearest((x - 12.0, (origin.1 + datum.1) / 2.0));
        canvas.text(&format!("{} {}", up.0, mm(up.1)), middle, style.centred().upwards());
    }

    fn thin(&self, canvas: &mut Canvas, from: Place, to: Place) {
        if let Some(ends) = self.cut([from, to]) {
            canvas.curve(&ends, GREY, 1);
        }
    }
}

/// A dimension line with an arrow at each end; of a short one the arrows point inwards from outside.
fn arrows(canvas: &mut Canvas, from: Place, to: Place) {
    let length = libm::hypot(to.0 - from.0, to.1 - from.1);
    if length < 1.0 {
        return;
    }
    let (ux, uy) = ((to.0 - from.0) / length, (to.1 - from.1) / length);
    let at = |end: Place, along: f64| (end.0 + ux * along, end.1 + uy * along);
    if length > 30.0 {
        canvas.arrow(at(from, 15.0), at(from, 5.0), BLACK, 1);
        canvas.arrow(at(to, -15.0), at(to, -5.0), BLACK, 1);
        canvas.curve(&[from, to], BLACK, 1);
    } else {
        canvas.arrow(at(from, -18.0), at(from, -5.0), BLACK, 1);
        canvas.arrow(at(to, 18.0), at(to, 5.0), BLACK, 1);
    }
}

fn closed(corners: Vec<[f64; 2]>) -> Vec<Place> {
    let mut places: Vec<Place> = corners.into_iter().map(|[x, y]| (x, y)).collect();
    places.extend(places.first().copied());
    places
}
