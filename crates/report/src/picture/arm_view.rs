//! An arm drawn from its rows, from the side and from above, with the cell and the tool path in the middle of it.

use super::axes::{Panel, square_around};
use super::canvas::{Canvas, Pixel, Place, TextStyle, nearest, picture};
use super::colour::{BLUE, GREY, INK, ORANGE, TEAL};
use super::surroundings::Outline;
use crate::units::fixed;
use nalgebra::Vector3;
use stead_cell::{Poses, Shape};
use stead_model::robot::{Frames, Pose, Robot, Spindle};
use stead_placement::overview::Overview;
use stead_problem::problem::{Cell, Problem};

const SIZE: Pixel = (1110, 640);
/// Left edges of the two panels.
const COLUMNS: [i32; 2] = [85, 635];
/// Upper edge of the panels.
const TOP: i32 = 100;
/// Width and height of a panel.
const SIDE: i32 = 455;
/// What the two panels show: the arm from the side, in the upright plane through axis 1 and the wrist, and from above.
const VIEWS: [(&str, [&str; 2]); 2] =
    [("From the side", ["from axis 1 towards the wrist (mm)", "z (mm)"]), ("From above", ["x (mm)", "y (mm)"])];

/// What is drawn beside the arm.
struct Surroundings<'a> {
    cell: &'a Cell,
    /// The tool path, a line for each segment. m
    path: Vec<Vec<Vector3<f64>>>,
    /// The shapes, where they stand, and whether they hit one another.
    shapes: Vec<(&'a Shape, Poses, bool)>,
}

/// The arm of a run at the first path point that it reaches with the workpiece in the middle of its cell, or in the
/// middle of its joint ranges where it reaches none.
pub fn arm_of_run(problem: &Problem, overview: &Overview) -> String {
    let base_from_workpiece = overview.middle.placement.base_from_workpiece();
    let points = problem.task.points();
    let of_segment = |segment: &std::ops::Range<usize>| {
        points[segment.clone()].iter().map(|point| base_from_workpiece.point(&point.position)).collect()
    };
    let path = problem.task.segments().iter().map(of_segment).collect();
    let (point, joints) = overview.middle.shown(&problem.robot);
    let hits = |shape: &Shape| overview.hits.iter().any(|hit| hit.pair.contains(&shape.name));
    let mut shapes = Vec::new();
    if let Some(scene) = problem.scene.as_deref() {
        let poses = problem.poses(scene, point, &overview.middle.placement, &joints);
        shapes.extend(scene.surroundings().shapes().iter().map(|shape| (shape, poses, hits(shape))));
    }
    let surroundings = Surroundings { cell: &problem.cell, path, shapes };
    Drawn::new(&problem.robot, &joints, Some(&problem.spindle), Some(&surroundings)).picture(&joints)
}

/// An arm alone, in the middle of its joint ranges.
pub fn arm_alone(robot: &Robot) -> String {
    let joints = robot.mid_range();
    Drawn::new(robot, &joints, None, None).picture(&joints)
}

/// An arm with all that is drawn of it.
struct Drawn<'a> {
    robot: &'a Robot,
    /// Its joints from the base to the flange.
    arm: Vec<Vector3<f64>>,
    /// The tool frame.
    tip: Option<Pose<f64>>,
    /// What the views must show.
    all: Vec<Vector3<f64>>,
    /// Across and upwards in each view.
    directions: [[Vector3<f64>; 2]; 2],
    surroundings: Option<&'a Surroundings<'a>>,
}

impl<'a> Drawn<'a> {
    fn new(
        robot: &'a Robot,
        joints: &[f64; 6],
        spindle: Option<&Spindle>,
        surroundings: Option<&'a Surroundings<'a>>,
    ) -> Self {
        let frames = Frames::new(robot, joints);
        let to_wrist = Vector3::new(frames.wrist_centre().x, frames.wrist_centre().y, 0.0);
        let ahead = to_wrist.try_normalize(1e-6).unwrap_or_else(Vector3::x);
        let directions = [[ahead, Vector3::z()], [Vector3::x(), Vector3::y()]];
        let tip = spindle.map(|on| frames.base_from_flange.then(&on.flange_from_tool));
        let mut arm = vec![robot.cell_from_base::<f64>().translation];
        arm.extend(frames.origins);
        arm.push(frames.base_from_flange.translation);
        let mut all = arm.clone();
        all.extend(tip.iter().map(|tip| tip.translation));
        if let Some(Surroundings { cell, path, .. }) = surroundings {
            all.extend(path.iter().flatten());
            all.extend((0..8).map(|corner| corner_of(cell, corner)));
        }
        Self { robot, arm, tip, all, directions, surroundings }
    }

    fn picture(&self, joints: &[f64; 6]) -> String {
        picture(SIZE, |canvas| {
            let frame = if self.robot.is_mounted() { "cell" } else { "base" };
            let title = format!("{}, drawn from its rows in the {frame} frame", self.robot.name());
            canvas.title(&title, (COLUMNS[0], 24));
            let angles = joints.map(|angle| fixed(angle.to_degrees(), 1)).join(", ");
            canvas.text(&format!("joint angles {angles} deg"), (COLUMNS[0], 50), TextStyle::new(12.0).coloured(INK));
            (0..2).for_each(|number| self.view(canvas, number));
            let legend = "grey: links, with joints as dots; red: spindle and tool axis; green: tool path with the workpiece in the middle of the \
                          cell (dashed)";
            canvas.text(
                if self.surroundings.is_some() { legend } else { "grey: links, with joints as dots" },
                (COLUMNS[0], 615),
                TextStyle::new(12.0),
            );
            if self.surroundings.is_some_and(|surroundings| !surroundings.shapes.is_empty()) {
                let legend = "outlines: shapes, grey where fixed, blue with the workpiece, pale on the arm, red where \
                              they hit another";
                canvas.text(legend, (COLUMNS[0], 632), TextStyle::new(12.0));
            }
        })
    }

    fn view(&self, canvas: &mut Canvas, number: usize) {
        let ((title, labels), along, left) = (VIEWS[number], self.directions[number], COLUMNS[number]);
        let shown = |point: &Vector3<f64>| along.map(|direction| point.dot(&direction) * 1e3);
        let shapes = self.surroundings.map_or(&[][..], |surroundings| &surroundings.shapes);
        let outlines = shapes.iter().map(|(shape, poses, is_hit)| {
            let outline = Outline::new(shape, poses, shown);
            if *is_hit { outline.coloured(ORANGE) } else { outline }
        });
        let outlines: Vec<Outline> = outlines.collect();
        let corners = outlines.iter().flat_map(|outline| outline.corners.iter().copied());
        let window = square_around(self.all.iter().map(shown).chain(corners), 0.55);
        let panel = Panel::square(window, (left, TOP), SIDE, labels);
        let place = |point: &Vector3<f64>| {
            let [x, y] = shown(point);
            panel.place(x, y)
        };
        canvas.text(title, (left, TOP - 18), TextStyle::new(13.0).bold().coloured(INK));
        panel.draw_grid(canvas);
        outlines.iter().for_each(|outline| outline.draw(canvas, |[x, y]| panel.place(x, y)));
        if let Some(surroundings) = self.surroundings {
            draw_surroundings(canvas, surroundings, &place);
        }
        let joints: Vec<Place> = self.arm.iter().map(place).collect();
        canvas.curve(&joints, GREY, 6);
        joints.iter().for_each(|joint| canvas.dot(*joint, 5, INK));
        canvas.dot(joints[0], 7, BLUE);
        if let Some(tip) = self.tip {
            // The tool axis, as far out of the spindle as the picture makes it visible.
            let out = tip.translation + tip.rotation.column(2) * 0.15;
            canvas.curve(&[joints[joints.len() - 1], place(&tip.translation)], ORANGE, 3);
            canvas.arrow(place(&tip.translation), place(&out), ORANGE, 2);
        }
        panel.draw_frame(canvas);
    }
}

fn draw_surroundings(canvas: &mut Canvas, around: &Surroundings<'_>, place: &impl Fn(&Vector3<f64>) -> Place) {
    let Surroundings { cell, path, .. } = around;
    // The twelve edges of the cell: from every corner along each axis whose lower end it is at.
    for corner in 0..8_usize {
        for axis in (0..3).filter(|axis| corner >> axis & 1 == 0) {
            let [from, to] = [corner, corner | 1 << axis].map(|corner| nearest(place(&corner_of(cell, corner))));
            canvas.dashed(from, to, INK);
        }
    }
    for segment in path {
        canvas.edged_curve(&segment.iter().map(place).collect::<Vec<_>>(), TEAL, 3);
    }
}

/// A corner of the cell: bit `k` of its number says whether it is at the upper end of axis `k`.
fn corner_of(cell: &Cell, corner: usize) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| {
        let bounds = cell.position[axis];
        if corner >> axis & 1 == 1 { bounds.max } else { bounds.min }
    })
}
