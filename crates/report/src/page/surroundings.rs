//! The shapes in which collisions are looked for, as meshes to be drawn.

use super::shapes::{BodyFrame, BodyMesh};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};
use stead_cell::{Attachment, Shape, Solid};
use stead_problem::problem::Problem;

/// Corners about an axis.
const AROUND: u32 = 28;
/// Rings of each half sphere.
const RINGS: u32 = 6;

/// All shapes, each in the frame that it moves with.
pub(super) fn surroundings(problem: &Problem) -> Vec<BodyMesh> {
    let Some(scene) = &problem.scene else { return Vec::new() };
    // The frame of the task that the page has.
    let turned = problem.orientation().map_or(Matrix3::identity(), |orientation| orientation.rotation);
    scene.surroundings().shapes().iter().map(|shape| drawn(shape, &turned)).collect()
}

fn drawn(shape: &Shape, turned: &Matrix3<f64>) -> BodyMesh {
    let (frame, color) = match shape.attached {
        Attachment::Base => (BodyFrame::Cell, [0.62, 0.66, 0.7]),
        Attachment::Link(number) => (BodyFrame::Link(number), [0.35, 0.6, 0.8]),
        Attachment::Flange => (BodyFrame::Link(6), [0.35, 0.6, 0.8]),
        Attachment::Workpiece => (BodyFrame::Workpiece, [0.73, 0.77, 0.82]),
        Attachment::Axis(number) => (BodyFrame::Axis(number), [0.5, 0.56, 0.62]),
    };
    let (corners, triangles) = mesh(&shape.solid);
    let place = |corner: &Vector3<f64>| {
        let point = shape.pose.point(corner);
        let point = if shape.attached == Attachment::Workpiece { turned * point } else { point };
        [point.x as f32, point.y as f32, point.z as f32]
    };
    let positions = corners.iter().map(place).collect();
    BodyMesh { name: shape.name.clone(), frame, color, positions, triangles, is_illustration: false }
}

/// Corners (m) and triangles of a form; of a hull those of the mesh that it is about.
fn mesh(solid: &Solid) -> (Vec<Vector3<f64>>, Vec<[u32; 3]>) {
    match solid {
        Solid::Box(edges) => cuboid(edges / 2.0),
        Solid::Cylinder { radius, length } => {
            let half = length / 2.0;
            turned_profile(&[(-half, 0.0), (-half, *radius), (half, *radius), (half, 0.0)])
        }
        Solid::Capsule { radius, length } => {
            let half = length / 2.0;
            let ring = |k: u32, end: f64| {
                let angle = FRAC_PI_2 * f64::from(k) / f64::from(RINGS);
                (end * (half + radius * libm::sin(angle)), radius * libm::cos(angle))
            };
            let lower = (0..=RINGS).rev().map(|k| ring(k, -1.0));
            turned_profile(&lower.chain((0..=RINGS).map(|k| ring(k, 1.0))).collect::<Vec<_>>())
        }
        Solid::Hull(mesh) | Solid::Mesh(mesh) => (mesh.vertices().to_vec(), mesh.triangles().to_vec()),
    }
}

fn cuboid(half: Vector3<f64>) -> (Vec<Vector3<f64>>, Vec<[u32; 3]>) {
    let sign = |bits: u32, k: u32| if bits >> k & 1 == 1 { 1.0 } else { -1.0 };
    let corners = (0..8).map(|b| half.component_mul(&Vector3::new(sign(b, 0), sign(b, 1), sign(b, 2)))).collect();
    let sides: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    (corners, sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect())
}

/// A body about z from pairs of height and radius, upwards.
fn turned_profile(profile: &[(f64, f64)]) -> (Vec<Vector3<f64>>, Vec<[u32; 3]>) {
    let (mut corners, mut triangles) = (Vec::new(), Vec::new());
    for (z, radius) in profile {
        corners.extend((0..AROUND).map(|k| {
            let (sine, cosine) = libm::sincos(TAU * f64::from(k) / f64::from(AROUND));
            Vector3::new(radius * cosine, radius * sine, *z)
        }));
    }
    for ring in 0..profile.len().saturating_sub(1) as u32 {
        for k in 0..AROUND {
            let next = (k + 1) % AROUND;
            let [a, b] = [k, next].map(|corner| ring * AROUND + corner);
            triangles.extend([[a, b, b + AROUND], [a, b + AROUND, a + AROUND]]);
        }
    }
    (corners, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use stead_model::robot::Pose;

    /// The volume inside, by the divergence theorem: positive where triangles are counter-clockwise from outside.
    fn volume(solid: &Solid) -> f64 {
        let (corners, triangles) = mesh(solid);
        let sixth = |[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|corner| corners[*corner as usize]);
            a.dot(&b.cross(&c)) / 6.0
        };
        triangles.iter().map(sixth).sum()
    }

    #[test]
    fn what_an_axis_carries_is_in_the_frame_of_that_axis_and_only_the_part_is_turned() {
        let turned = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        let pose = Pose { translation: Vector3::new(1.0, 2.0, 3.0), ..Pose::identity() };
        let at = |attached: Attachment| {
            let shape = Shape { name: "plate".to_owned(), attached, solid: Solid::Box(Vector3::repeat(0.5)), pose };
            let body = drawn(&shape, &turned);
            let middle: Vector3<f32> =
                body.positions.iter().map(|position| Vector3::from(*position)).sum::<Vector3<f32>>() / 8.0;
            (body.frame, <[f32; 3]>::from(middle))
        };
        assert_eq!(at(Attachment::Axis(1)), (BodyFrame::Axis(1), [1.0, 2.0, 3.0]));
        assert_eq!(at(Attachment::Base), (BodyFrame::Cell, [1.0, 2.0, 3.0]));
        assert_eq!(at(Attachment::Workpiece), (BodyFrame::Workpiece, [-2.0, 1.0, 3.0]));
        assert_eq!(at(Attachment::Flange), (BodyFrame::Link(6), [1.0, 2.0, 3.0]));
    }

    #[test]
    fn forms_are_closed_with_their_outside_out_and_nearly_their_volume() {
        let pi = std::f64::consts::PI;
        let (radius, length) = (0.2, 0.5);
        let cylinder = pi * radius * radius * length;
        for (solid, expected) in [
            (Solid::Box(Vector3::new(1.0, 2.0, 3.0)), 6.0),
            (Solid::Cylinder { radius, length }, cylinder),
            (Solid::Capsule { radius, length }, cylinder + 4.0 / 3.0 * pi * radius.powi(3)),
        ] {
            let ratio = volume(&solid) / expected;
            assert!(ratio > 0.97 && ratio < 1.0 + 1e-12, "{solid:?}: {ratio}");
        }
    }
}
