//! The robot cell from above with the best and the worst placement (Caro 2013, Fig. 8).

use super::axes::{Panel, Window, square_around};
use super::canvas::{BEST_LINE, Canvas, LineStyle, Pixel, TextStyle, WORST_LINE, exact, picture};
use super::cell_view::{CellView, is_upright, middles, top_view, wrist_centre};
use super::colour::{BLUE, GREY, INK, PALE};
use crate::units::fixed;
use nalgebra::Vector3;
use stead_placement::outcome::{Case, Outcome};
use stead_problem::problem::Problem;

const SIZE: Pixel = (1110, 1180);
/// Left edges of the two columns of panels.
const COLUMNS: [i32; 2] = [85, 635];
/// Upper edges of the two rows of panels.
const ROWS: [i32; 2] = [85, 660];
/// Width and height of a panel.
const SIDE: i32 = 455;
/// Half the side of the square shown around the origin of the base frame. mm
const BASE: f64 = 300.0;

/// A placement that is shown.
struct Shown<'a> {
    case: &'a Case,
    line: LineStyle,
    /// What its panel is called.
    title: &'static str,
    /// What its tool path is called.
    path: &'static str,
}

/// The cell from above in the robot base frame: a view with the robot, and the surroundings of both placements larger,
/// with the tool path as it lies and the direction to the wrist centre in the middle of each segment.
pub fn cell(problem: &Problem, outcome: &Outcome) -> String {
    let names = [
        (BEST_LINE, "Best placement", "tool path at the best placement"),
        (WORST_LINE, "Worst placement", "tool path at the worst placement"),
    ];
    let shown = outcome.cases.optima().into_iter().zip(names);
    drawn(problem, &shown.map(|(case, (line, title, path))| Shown { case, line, title, path }).collect::<Vec<_>>())
}

/// The same with one given placement.
pub fn cell_with(problem: &Problem, case: &Case) -> String {
    drawn(problem, &[Shown { case, line: BEST_LINE, title: "This placement", path: "tool path at this placement" }])
}

fn drawn(problem: &Problem, all: &[Shown<'_>]) -> String {
    picture(SIZE, |canvas| {
        let frame = if problem.robot.is_mounted() { "cell" } else { "robot base" };
        canvas.title(&format!("The cell from above, in the {frame} frame"), (COLUMNS[0], 24));
        let near = near(problem, all);
        overview(canvas, problem, all, near);
        legend(canvas, problem, all);
        for (shown, left) in all.iter().zip(COLUMNS) {
            placement(canvas, problem, shown, panel(near, left, ROWS[1]));
        }
    })
}

/// The robot, its reach, the cell, and where the other panels are.
fn overview(canvas: &mut Canvas, problem: &Problem, all: &[Shown<'_>], near: Window) {
    let view = CellView { problem, panel: panel(whole(problem, near), COLUMNS[0], ROWS[0]) };
    canvas.text("Robot and cell", (COLUMNS[0], ROWS[0] - 18), TextStyle::new(13.0).bold().coloured(INK));
    view.panel.draw_grid(canvas);
    view.reach(canvas);
    let corner = |[x, y]: [f64; 2]| (view.panel.x.pixel(x), view.panel.y.pixel(y));
    canvas.outline(corner(near[0]), corner(near[1]), PALE);
    view.limits(canvas);
    view.base(canvas);
    for shown in all.iter().rev() {
        view.path(canvas, shown.case, shown.line);
        view.origin(canvas, shown.case);
    }
    view.panel.draw_frame(canvas)
}

/// One placement with its surroundings.
fn placement(canvas: &mut Canvas, problem: &Problem, shown: &Shown<'_>, panel: Panel) {
    let Shown { case, line, title, .. } = *shown;
    let title = format!("{title}: mean {} mm", fixed(case.plan.mean * 1e3, 4));
    let (left, top) = (panel.x.start, panel.y.end);
    canvas.text(&title, (left, top - 38), TextStyle::new(13.0).bold().coloured(line.colour));
    let place = &case.placement;
    let [x, y, z] = [place.x, place.y, place.z].map(|value| fixed(value * 1e3, 1));
    let words = format!("x = {x} mm, y = {y} mm, z = {z} mm, yaw = {} deg", fixed(place.yaw.to_degrees(), 1));
    canvas.text(&words, (left, top - 18), TextStyle::new(12.0).coloured(INK));
    let view = CellView { problem, panel };
    view.panel.draw_grid(canvas);
    view.limits(canvas);
    view.wrists(canvas, case);
    view.path(canvas, case, line);
    view.workpiece(canvas, case);
    view.numbers(canvas, case, line.colour);
    view.panel.draw_frame(canvas)
}

fn legend(canvas: &mut Canvas, problem: &Problem, all: &[Shown<'_>]) {
    let (left, right, mut y) = (COLUMNS[1], COLUMNS[1] + 34, ROWS[0] + 12);
    let mut entry = |label: &str, sign: &dyn Fn(&mut Canvas, i32)| {
        sign(canvas, y);
        canvas.text(label, (right + 12, y), TextStyle::new(12.0));
        y += 28;
    };
    for shown in all {
        entry(shown.path, &|canvas, y| canvas.styled_curve(&[exact((left, y)), exact((right, y))], shown.line, 3));
    }
    entry("workpiece origin; below with the axes x and y", &|canvas, y| canvas.dot(exact((left + 17, y)), 4, INK));
    entry("where the workpiece origin may stand", &|canvas, y| canvas.dashed((left, y), (right, y), INK));
    if is_upright(problem) {
        let reach = fixed(problem.robot.geometry().reach() * 1e3, 0);
        let label = format!("reach of the wrist centre: {reach} mm from axis 1");
        entry(&label, &|canvas, y| canvas.line(&[(left, y), (right, y)], BLUE, 2));
    }
    entry("from the tool to the wrist centre, at mid-segment", &|canvas, y| {
        canvas.line(&[(left, y), (right - 3, y)], PALE, 1);
        canvas.dot(exact((right - 3, y)), 3, GREY)
    });
    entry("part shown below", &|canvas, y| canvas.outline((left, y - 8), (right, y + 8), PALE))
}

/// The cell, and of each case the tool path and the wrist centres that are drawn.
fn near(problem: &Problem, all: &[Shown<'_>]) -> Window {
    let [x, y, _] = problem.cell.position;
    let mut points = vec![[x.min * 1e3, y.min * 1e3], [x.max * 1e3, y.max * 1e3]];
    for Shown { case, .. } in all {
        points.extend(case.plan.points.iter().map(|point| top_view(&point.position)));
        points.extend(middles(problem, case).map(|point| top_view(&wrist_centre(problem, point))));
    }
    square_around(points, 0.5 + 0.06)
}

/// The base, the near region, and the reach in the direction of the cell.
fn whole(problem: &Problem, near: Window) -> Window {
    let mut points = vec![[-BASE, -BASE], [BASE, BASE], near[0], near[1]];
    let stand = top_view(&problem.robot.cell_from_base::<f64>().translation);
    points.extend([-BASE, BASE].map(|by| stand.map(|at| at + by)));
    let [x, y, _] = problem.cell.position;
    let root = problem.robot.geometry().root_in_base;
    let toward = Vector3::new((x.min + x.max) / 2.0 - root.x, (y.min + y.max) / 2.0 - root.y, 0.0);
    if let Some(direction) = toward.try_normalize(1e-6)
        && is_upright(problem)
    {
        points.push(top_view(&(root + direction * problem.robot.geometry().reach())));
    }
    square_around(points, 0.5 + 0.03)
}

/// A part of the plane with x and y of the base.
fn panel(shown: Window, left: i32, top: i32) -> Panel {
    Panel::square(shown, (left, top), SIDE, ["x (mm)", "y (mm)"])
}
