//! Spheres and boxes that contain a solid: what decides most pairs without looking at the solid itself.

use crate::solid::Solid;
use nalgebra::Vector3;
use stead_model::robot::Pose;

/// A sphere in the frame of an attachment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Its centre. m
    pub centre: Vector3<f64>,
    /// Its radius. m
    pub radius: f64,
}

/// What contains a solid: one sphere, several smaller ones, and a box.
#[derive(Debug, Clone, PartialEq)]
pub struct Cover {
    /// One sphere around all.
    pub bound: Sphere,
    /// Smaller spheres, together around all.
    pub spheres: Vec<Sphere>,
    /// From the frame of the box to that of the attachment.
    pub box_pose: Pose<f64>,
    /// Half the edges of the box. m
    pub half: Vector3<f64>,
}

/// Spheres of one cover, at the most.
const MAX_SPHERES: f64 = 24.0;
/// What rounding may make of a point on the surface. m
const ROUNDING: f64 = 1e-9;

impl Cover {
    /// Covers a solid that stands at a pose in the frame of its attachment.
    pub fn new(solid: &Solid, pose: &Pose<f64>) -> Self {
        let [low, high] = solid.extent();
        let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
        let box_pose = pose.then(&Pose { translation: middle, ..Pose::identity() });
        let sphere =
            |centre: Vector3<f64>, radius: f64| Sphere { centre: box_pose.point(&centre), radius: radius + ROUNDING };
        let bound = match solid {
            Solid::Capsule { radius, length } => sphere(Vector3::zeros(), length / 2.0 + radius),
            _ => sphere(Vector3::zeros(), half.norm()),
        };
        let spheres = match solid {
            // The ends, and slices of the cylinder between them.
            Solid::Capsule { radius, length } => {
                let parts = (length / radius).ceil().clamp(1.0, MAX_SPHERES);
                let step = length / parts;
                let reach = libm::hypot(*radius, step / 2.0);
                let at = |z: f64| Vector3::new(0.0, 0.0, z);
                let ends = [-length / 2.0, length / 2.0].map(|z| sphere(at(z), *radius));
                let slices = (0..parts as usize).map(|k| sphere(at(-length / 2.0 + (k as f64 + 0.5) * step), reach));
                ends.into_iter().chain(slices).collect()
            }
            // The box around it is cut along its longest edge into pieces about as long as the next edge.
            _ => {
                let axis = half.imax();
                let next = (0..3).filter(|k| *k != axis).map(|k| half[k]).fold(0.0, f64::max);
                let parts = (half[axis] / next.max(half[axis] / MAX_SPHERES)).ceil().clamp(1.0, MAX_SPHERES);
                let step = 2.0 * half[axis] / parts;
                let mut piece = half;
                piece[axis] = step / 2.0;
                (0..parts as usize)
                    .map(|k| {
                        let mut centre = Vector3::zeros();
                        centre[axis] = -half[axis] + (k as f64 + 0.5) * step;
                        sphere(centre, piece.norm())
                    })
                    .collect()
            }
        };
        Self { bound, spheres, box_pose, half: half.map(|edge| edge + ROUNDING) }
    }

    /// No point of the solid is farther than this from the origin of the attachment. m
    pub fn farthest(&self) -> f64 {
        let of = |sphere: &Sphere| sphere.centre.norm() + sphere.radius;
        self.spheres.iter().map(of).fold(0.0, f64::max).min(of(&self.bound))
    }
}

/// A lower bound of the distance between a solid with spheres and one with a box, where it is below `enough`; else any
/// value not below that. Both attachments stand at poses in one frame. m
pub fn lower_bound(a: &Cover, a_at: &Pose<f64>, b: &Cover, b_at: &Pose<f64>, enough: f64) -> f64 {
    let outside = |in_box: Vector3<f64>| (in_box.abs() - b.half).sup(&Vector3::zeros()).norm();
    let centre = b.box_pose.inverse_point(&b_at.inverse_point(&a_at.point(&a.bound.centre)));
    let coarse = outside(centre) - a.bound.radius;
    if coarse >= enough {
        return coarse;
    }
    // From the frame of a's attachment to that of b's box.
    let box_from_a = b_at.then(&b.box_pose).inverse().then(a_at);
    let of = |sphere: &Sphere| outside(box_from_a.point(&sphere.centre)) - sphere.radius;
    let fine = a.spheres.iter().map(of).fold(f64::INFINITY, f64::min);
    fine.max(coarse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collider::Collider;
    use crate::solid::tests::box_mesh;
    use proptest::prelude::*;
    use std::sync::Arc;
    use stead_numerics::rotation::rotation_from_zyx;

    fn solids() -> Vec<Solid> {
        let mesh = Arc::new(box_mesh(Vector3::new(0.3, 1.1, 0.2)));
        vec![
            Solid::Box(Vector3::new(2.0, 0.1, 0.6)),
            Solid::Capsule { radius: 0.15, length: 1.2 },
            Solid::Cylinder { radius: 0.4, length: 0.3 },
            Solid::Hull(mesh.clone()),
            Solid::Mesh(mesh),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(150))]
        /// What the covers say is never more than the distance of the solids.
        #[test]
        fn the_bound_is_below_the_distance(
            place in prop::array::uniform3(-2.0..2.0_f64), turn in prop::array::uniform3(-3.0..3.0_f64), tilt in prop::array::uniform3(-3.0..3.0_f64)
        ) {
            let a_pose = Pose { rotation: rotation_from_zyx(tilt), translation: Vector3::new(0.1, -0.2, 0.05) };
            let b_at = Pose { rotation: rotation_from_zyx(turn), translation: place.into() };
            let here = Pose::identity();
            for (number_a, a) in solids().iter().enumerate() {
                for (number_b, b) in solids().iter().enumerate() {
                    let (cover_a, cover_b) = (Cover::new(a, &a_pose), Cover::new(b, &here));
                    let bound = lower_bound(&cover_a, &here, &cover_b, &b_at, 10.0);
                    let (a, b) = (Collider::new(a, &a_pose).unwrap(), Collider::new(b, &here).unwrap());
                    let exact = a.distance(&here, &b, &b_at, 10.0);
                    prop_assert!(bound <= exact + 1e-7 || (exact <= 0.0 && bound <= 1e-7), "{number_a} {number_b} {bound} {exact}");
                }
            }
        }
    }
}
