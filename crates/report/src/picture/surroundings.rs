//! The shapes of a cell with the arm among them, from above and from the side.

use super::axes::{Panel, square_around};
use super::canvas::{Canvas, Place, TextStyle, picture};
use super::cell_view::middles;
use super::colour::{BLUE, Colour, GREY, INK, ORANGE, PALE, TEAL};
use crate::units::fixed;
use nalgebra::Vector3;
use stead_cell::{Attachment, Poses, Scene, Shape, Solid};
use stead_model::robot::Pose;
use stead_placement::outcome::{Case, PlanPoint};
use stead_problem::problem::Problem;

/// Left edges of the two views.
const COLUMNS: [i32; 2] = [85, 635];
/// Upper edge of the views of the first case, and how far those of the next are below.
const ROWS: (i32, i32) = (110, 560);
/// Width and height of a view.
const SIDE: i32 = 455;
/// The views: what they are called, their coordinates, and which axes of the base frame these are.
const VIEWS: [(&str, [&str; 2], [usize; 2]); 2] =
    [("From above", ["x (mm)", "y (mm)"], [0, 1]), ("From the side", ["y (mm)", "z (mm)"], [1, 2])];
/// Corners of the circles that round forms are drawn by.
const CORNERS: usize = 16;

/// All shapes with the arm in the middle of each segment, for each case a row: the best placement, and the worst.
/// `None` where the run has no shapes.
pub fn surroundings(problem: &Problem, cases: &[(&Case, &str)]) -> Option<String> {
    let scene = problem.scene.as_deref()?;
    let height = ROWS.0 + ROWS.1 * cases.len() as i32;
    Some(picture((1110, height), |canvas| {
        canvas.title("Shapes of the cell and the arm among them, in the robot base frame", (COLUMNS[0], 24));
        let legend = "grey: what stands in the cell; blue: part and what moves with it; pale: shapes on the arm, in the middle of each \
                      segment; red: where the plan has the least clearance";
        canvas.text(legend, (COLUMNS[0], 50), TextStyle::new(12.0));
        for (row, (case, name)) in cases.iter().enumerate() {
            draw_case(canvas, &problem.in_setup(&case.setup), scene, (case, name), ROWS.0 + ROWS.1 * row as i32);
        }
    }))
}

/// A shape as a view shows it: the outline of its points. mm
pub(super) struct Outline {
    pub corners: Vec<[f64; 2]>,
    colour: Colour,
    width: i32,
}

impl Outline {
    /// That of a shape, for a view that makes a point of the base frame (m) one of its own (mm).
    pub fn new(shape: &Shape, poses: &Poses, flat: impl Fn(&Vector3<f64>) -> [f64; 2]) -> Self {
        let (colour, width) = match shape.attached {
            Attachment::Base | Attachment::Axis(_) => (GREY, 2),
            Attachment::Workpiece => (BLUE, 2),
            Attachment::Link(_) | Attachment::Flange => (PALE, 1),
        };
        Self { corners: hull(corners(shape, poses).iter().map(flat).collect()), colour, width }
    }

    /// The same in another colour, more boldly.
    pub fn coloured(self, colour: Colour) -> Self {
        Self { colour, width: 3, ..self }
    }

    /// Draws it.
    pub fn draw(&self, canvas: &mut Canvas, place: impl Fn([f64; 2]) -> Place) {
        let mut closed: Vec<Place> = self.corners.iter().map(|corner| place(*corner)).collect();
        closed.extend(closed.first().copied());
        canvas.curve(&closed, self.colour, self.width);
    }
}

fn draw_case(canvas: &mut Canvas, problem: &Problem, scene: &Scene, (case, name): (&Case, &str), top: i32) {
    let shown: Vec<&PlanPoint> = middles(problem, case).collect();
    if shown.is_empty() {
        return;
    }
    for ((title, labels, axes), left) in VIEWS.into_iter().zip(COLUMNS) {
        let flat = |point: &Vector3<f64>| axes.map(|axis| point[axis] * 1e3);
        let mut outlines = Vec::new();
        for shape in scene.surroundings().shapes() {
            let is_on_arm = matches!(shape.attached, Attachment::Link(_) | Attachment::Flange);
            for point in if is_on_arm { &shown[..] } else { &shown[..1] } {
                let poses = problem.poses(scene, point.point, &case.placement, &point.joints);
                outlines.push(Outline::new(shape, &poses, flat));
            }
        }
        let path: Vec<[f64; 2]> = case.plan.points.iter().map(|point| flat(&point.position)).collect();
        let all = outlines.iter().flat_map(|outline| &outline.corners).chain(&path).copied();
        let panel = Panel::square(square_around(all, 0.53), (left, top), SIDE, labels);
        let place = |[x, y]: [f64; 2]| panel.place(x, y);
        canvas.text(&format!("{title}: {name}"), (left, top - 18), TextStyle::new(13.0).bold().coloured(INK));
        panel.draw_grid(canvas);
        outlines.iter().for_each(|outline| outline.draw(canvas, place));
        for point in &shown {
            let arm: Vec<Place> = arm(problem, point).iter().map(|joint| place(flat(joint))).collect();
            canvas.curve(&arm, INK, 2);
        }
        for segment in problem.task.segments() {
            let line: Vec<Place> = path[segment.clone()].iter().map(|point| place(*point)).collect();
            canvas.curve(&line, TEAL, 3);
        }
        if let Some(near) = &case.plan.clearance
            && let Some(at) = path.get(near.point)
        {
            canvas.dot(place(*at), 5, ORANGE);
        }
        panel.draw_frame(canvas);
    }
    let words = case.plan.clearance.as_ref().map_or_else(
        || "no two shapes come nearer than 1 m to each other".to_owned(),
        |near| {
            let ([a, b], distance) = (near.names.as_ref(), fixed(near.distance * 1e3, 1));
            format!("least clearance {distance} mm, between {a} and {b}, at point {}", near.point)
        },
    );
    canvas.text(&words, (COLUMNS[0], top - 40), TextStyle::new(12.0).coloured(INK));
}

/// The arm as a line: base, axes, flange, tool centre point. m
pub(super) fn arm(problem: &Problem, point: &PlanPoint) -> Vec<Vector3<f64>> {
    let links = problem.robot.link_frames(&point.joints);
    let mut joints = vec![problem.robot.geometry().root_in_base];
    joints.extend(links.iter().map(|link| link.translation));
    joints.push(point.position);
    joints
}

/// Points in the base frame whose hull a shape is, or about is. m
fn corners(shape: &Shape, poses: &Poses) -> Vec<Vector3<f64>> {
    corners_at(shape, &poses.of(shape.attached).then(&shape.pose))
}

/// The same with the shape at a pose. m
pub(super) fn corners_at(shape: &Shape, pose: &Pose<f64>) -> Vec<Vector3<f64>> {
    let ring = |radius: f64, z: f64| {
        (0..CORNERS).map(move |k| {
            let (sine, cosine) = libm::sincos(std::f64::consts::TAU * k as f64 / CORNERS as f64);
            Vector3::new(radius * cosine, radius * sine, z)
        })
    };
    let own: Vec<Vector3<f64>> = match &shape.solid {
        Solid::Box(edges) => (0..8)
            .map(|corner: usize| Vector3::from_fn(|k, _| edges[k] * if corner >> k & 1 == 1 { 0.5 } else { -0.5 }))
            .collect(),
        Solid::Cylinder { radius, length } => {
            [-0.5, 0.5].into_iter().flat_map(|side| ring(*radius, side * length)).collect()
        }
        // Half spheres by three rings and their tips.
        Solid::Capsule { radius, length } => [-1.0, 1.0]
            .into_iter()
            .flat_map(|side: f64| {
                [0.0, 0.4, 0.8].into_iter().flat_map(move |share: f64| {
                    let (sine, cosine) = libm::sincos(share * std::f64::consts::FRAC_PI_2);
                    ring(radius * cosine, side * (length / 2.0 + radius * sine))
                })
            })
            .chain([-1.0, 1.0].map(|side| Vector3::new(0.0, 0.0, side * (length / 2.0 + radius))))
            .collect(),
        Solid::Hull(mesh) | Solid::Mesh(mesh) => mesh.vertices().to_vec(),
    };
    own.iter().map(|point| pose.point(point)).collect()
}

/// The corners of the convex hull of points, in order.
pub(super) fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let turn = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut kept: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while let [.., a, b] = kept[..]
                && turn(a, b, point) <= 0.0
            {
                kept.pop();
            }
            kept.push(point);
        }
        kept.pop();
        kept
    };
    let mut corners = chain(&mut points.iter().copied());
    corners.extend(chain(&mut points.iter().rev().copied()));
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_of_a_square_with_a_point_inside_is_its_corners() {
        let points = vec![[0.0, 0.0], [1.0, 1.0], [0.5, 0.4], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0]];
        assert_eq!(hull(points), [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    }
}
