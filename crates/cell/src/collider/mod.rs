//! Distances between solids: the one adapter around the library of shapes (parry3d).
//!
//! Convex pairs are decided by GJK (`convex`); meshes by their trees of boxes (`mesh`), two of them by both trees at
//! once (`tree`).
//!
//! The orientation goes to the library as a unit quaternion, so distances agree with the matrices of the arm to about
//! 1e-12 m.

mod convex;
mod mesh;
mod tree;

use crate::solid::Solid;
use convex::{Convex, vector};
use mesh::Mesh;
use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use parry3d_f64::math::{Pose as ParryPose, Rotation, Vector};
use std::fmt;
use stead_model::robot::Pose;

/// A solid made ready for queries, in the frame of what it is attached to.
#[derive(Clone)]
pub struct Collider {
    form: Form,
    /// From the library's frame of the form to the frame of the attachment.
    pose: ParryPose,
}

#[derive(Clone)]
enum Form {
    Convex(Convex),
    Mesh(Box<Mesh>),
}

impl fmt::Debug for Collider {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Collider").field("pose", &self.pose).finish_non_exhaustive()
    }
}

fn parry_pose(pose: &Pose<f64>) -> ParryPose {
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(pose.rotation));
    let [x, y, z, w] = [rotation.i, rotation.j, rotation.k, rotation.w];
    ParryPose::from_parts(vector(&pose.translation), Rotation::from_xyzw(x, y, z, w))
}

/// How far two solids are apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// Their distance where it is below the limit requested; else a value not below that; zero where they touch. m
    pub distance: f64,
    /// The direction from the first to the second along which they are so far apart, in the common frame; `None` where
    /// it is not known.
    pub axis: Option<Vector3<f64>>,
}

/// Where two solids are nearest to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Their distance. m
    pub distance: f64,
    /// The nearest points, of capsules those on their axes, in the common frame. m
    pub points: [Vector3<f64>; 2],
}

impl Collider {
    /// Makes a solid ready, at a pose in the frame of its attachment. `None` where a mesh has no triangle.
    pub fn new(solid: &Solid, pose: &Pose<f64>) -> Option<Self> {
        let at = parry_pose(pose);
        Some(match solid {
            Solid::Mesh(mesh) => Self { form: Form::Mesh(Box::new(Mesh::new(mesh)?)), pose: at },
            convex => {
                let (convex, along_z) = Convex::new(convex)?;
                Self { form: Form::Convex(convex), pose: at * along_z }
            }
        })
    }

    /// The distance of two solids whose attachments stand at poses in one frame, where it is below `limit`; else a
    /// value not below that; zero where they touch. m
    pub fn distance(&self, at: &Pose<f64>, other: &Self, other_at: &Pose<f64>, limit: f64) -> f64 {
        self.separation(at, other, other_at, limit).distance
    }

    /// The same with the direction.
    pub fn separation(&self, at: &Pose<f64>, other: &Self, other_at: &Pose<f64>, limit: f64) -> Separation {
        let [here, there] = [parry_pose(at) * self.pose, parry_pose(other_at) * other.pose];
        let found = |(distance, axis): (f64, Option<Vector>), from: &ParryPose| {
            let axis = axis.map(|axis| from.rotation * axis);
            Separation { distance, axis: axis.map(|axis| Vector3::new(axis.x, axis.y, axis.z)) }
        };
        match (&self.form, &other.form) {
            (Form::Convex(a), Form::Convex(b)) => found(a.distance(&here.inv_mul(&there), b, limit), &here),
            (Form::Mesh(a), Form::Convex(b)) => found(a.distance(&here.inv_mul(&there), b, limit), &here),
            (Form::Mesh(a), Form::Mesh(b)) => found(a.distance_to_mesh(&here.inv_mul(&there), b, limit), &here),
            (Form::Convex(a), Form::Mesh(b)) => {
                let Separation { distance, axis } = found(b.distance(&there.inv_mul(&here), a, limit), &there);
                Separation { distance, axis: axis.map(|axis| -axis) }
            }
        }
    }

    /// Where two solids are nearest to each other, where that is nearer than `limit` and they do not touch.
    pub fn nearest(&self, at: &Pose<f64>, other: &Self, other_at: &Pose<f64>, limit: f64) -> Option<Nearest> {
        let [here, there] = [parry_pose(at) * self.pose, parry_pose(other_at) * other.pose];
        let (found, from, is_swapped) = match (&self.form, &other.form) {
            (Form::Convex(a), Form::Convex(b)) => (a.nearest(&here.inv_mul(&there), b, limit), here, false),
            (Form::Mesh(a), Form::Convex(b)) => (a.nearest(&here.inv_mul(&there), b, limit), here, false),
            (Form::Mesh(a), Form::Mesh(b)) => (a.nearest_of_mesh(&here.inv_mul(&there), b, limit), here, false),
            (Form::Convex(a), Form::Mesh(b)) => (b.nearest(&there.inv_mul(&here), a, limit), there, true),
        };
        let (distance, points) = found?;
        let mut points = points.map(|point| from * point).map(|point| Vector3::new(point.x, point.y, point.z));
        if is_swapped {
            points.reverse();
        }
        Some(Nearest { distance, points })
    }

    /// How far two solids are apart along a direction, a unit vector in the common frame from the first to the second:
    /// never more than their distance. m
    pub fn gap(&self, at: &Pose<f64>, other: &Self, other_at: &Pose<f64>, axis: &Vector3<f64>) -> f64 {
        -self.extent(at, axis) - other.extent(other_at, &-axis)
    }

    /// How far the solid extends along a direction. m
    fn extent(&self, at: &Pose<f64>, axis: &Vector3<f64>) -> f64 {
        let in_attachment = vector(&at.rotation.tr_mul(axis));
        let direction = self.pose.rotation.inverse() * in_attachment;
        let farthest = match &self.form {
            Form::Convex(convex) => convex.extent(direction),
            Form::Mesh(mesh) => mesh.extent(direction),
        };
        farthest + in_attachment.dot(self.pose.translation) + axis.dot(&at.translation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::TriangleMesh;
    use crate::solid::tests::{box_mesh, boxes};
    use proptest::prelude::*;
    use std::sync::Arc;
    use stead_numerics::rotation::rotation_from_zyx;

    fn at(x: f64, y: f64, z: f64) -> Pose<f64> {
        Pose { translation: Vector3::new(x, y, z), ..Pose::identity() }
    }

    fn collider(solid: &Solid) -> Collider {
        Collider::new(solid, &Pose::identity()).unwrap()
    }

    /// A prism over an L: two boxes, 2 m by 1 m and 1 m by 1 m, side by side.
    fn l_mesh() -> TriangleMesh {
        let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let corners = [0.0, 1.0].map(|z| outline.map(|[x, y]| Vector3::new(x, y, z))).concat();
        let caps = [[0, 1, 2], [0, 2, 3], [0, 3, 5], [3, 4, 5]];
        let bottom = caps.map(|[a, b, c]| [a, c, b]);
        let top = caps.map(|corner| corner.map(|k| k + 6));
        let sides = (0..6_u32).flat_map(|k| {
            let next = (k + 1) % 6;
            [[k, next, next + 6], [k, next + 6, k + 6]]
        });
        let triangles: Vec<[u32; 3]> = bottom.into_iter().chain(top).chain(sides).collect();
        TriangleMesh::new(&corners, &triangles).unwrap()
    }

    #[test]
    fn distances_by_hand() {
        let cube = collider(&Solid::Box(Vector3::new(1.0, 1.0, 1.0)));
        let capsule = collider(&Solid::Capsule { radius: 0.1, length: 1.0 });
        let cylinder = collider(&Solid::Cylinder { radius: 0.1, length: 1.0 });
        let here = Pose::identity();
        assert!((cube.distance(&here, &cube, &at(3.0, 0.0, 0.0), 10.0) - 2.0).abs() < 1e-12);
        assert!((cube.distance(&here, &capsule, &at(0.0, 0.0, 2.0), 10.0) - 0.9).abs() < 1e-12);
        assert!((cube.distance(&here, &cylinder, &at(0.0, 0.0, 2.0), 10.0) - 1.0).abs() < 1e-9);
        assert_eq!(cube.distance(&here, &cube, &at(0.9, 0.0, 0.0), 10.0), 0.0);
    }

    /// Two boxes that touch along a face, one that the file has turned inside out, and one with a hollow.
    #[test]
    fn each_of_several_solids_has_an_inside() {
        let bead = collider(&Solid::Capsule { radius: 0.01, length: 0.0 });
        let inside = |mesh: &TriangleMesh, x: f64| {
            let solid = collider(&Solid::Mesh(Arc::new(mesh.clone())));
            solid.distance(&Pose::identity(), &bead, &at(x, 0.02, 0.03), 1.0) == 0.0
        };
        let two = boxes(&[Vector3::zeros(), Vector3::x()]);
        assert!(two.is_touching() && [0.0, 0.45, 0.55, 1.2].iter().all(|x| inside(&two, *x)) && !inside(&two, 1.6));
        let turned_from = |first: usize, mesh: &TriangleMesh| {
            let turn = |(k, [a, b, c]): (usize, &[u32; 3])| if k < first { [*a, *b, *c] } else { [*a, *c, *b] };
            let triangles: Vec<[u32; 3]> = mesh.triangles().iter().enumerate().map(turn).collect();
            TriangleMesh::new(mesh.vertices(), &triangles).unwrap()
        };
        let apart = turned_from(12, &boxes(&[Vector3::zeros(), Vector3::x() * 3.0]));
        assert!(inside(&apart, 0.0) && inside(&apart, 3.0) && !inside(&apart, 1.5));
        let (outer, inner) = (box_mesh(Vector3::new(2.0, 2.0, 2.0)), box_mesh(Vector3::new(1.0, 1.0, 1.0)));
        let vertices = [outer.vertices(), inner.vertices()].concat();
        let triangles = outer.triangles().iter().copied().chain(inner.triangles().iter().map(|t| t.map(|k| k + 8)));
        let hollow = turned_from(12, &TriangleMesh::new(&vertices, &triangles.collect::<Vec<_>>()).unwrap());
        assert!(inside(&hollow, 0.75) && !inside(&hollow, 0.0) && !inside(&hollow, 1.2));
    }

    #[test]
    fn a_mesh_is_solid_where_it_is_closed() {
        let big = box_mesh(Vector3::new(2.0, 2.0, 2.0));
        let open = TriangleMesh::new(big.vertices(), &big.triangles()[1..]).unwrap();
        let small = collider(&Solid::Box(Vector3::new(0.1, 0.1, 0.1)));
        let here = Pose::identity();
        let distance = |mesh: &TriangleMesh, solid: &Collider| {
            collider(&Solid::Mesh(Arc::new(mesh.clone()))).distance(&here, solid, &here, 5.0)
        };
        assert_eq!(distance(&big, &small), 0.0);
        assert!((distance(&open, &small) - 0.95).abs() < 1e-9);
        let little = box_mesh(Vector3::new(0.1, 0.1, 0.1));
        assert_eq!(distance(&big, &collider(&Solid::Mesh(Arc::new(little.clone())))), 0.0);
        assert!((distance(&open, &collider(&Solid::Mesh(Arc::new(little)))) - 0.95).abs() < 1e-9);
    }

    #[test]
    fn the_hull_of_flat_points_is_flat() {
        let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]].map(Vector3::from);
        let mesh = TriangleMesh::new(&corners, &[[0, 1, 2], [0, 2, 3]]).unwrap();
        let plate = collider(&Solid::Hull(Arc::new(mesh)));
        let capsule = collider(&Solid::Capsule { radius: 0.1, length: 0.4 });
        let cylinder = collider(&Solid::Cylinder { radius: 0.1, length: 0.4 });
        let here = Pose::identity();
        for (place, off) in [(at(0.3, -0.8, 0.5), 0.3), (at(0.0, 0.0, -1.0), 0.8), (at(1.4, 0.2, 0.1), 0.4)] {
            let distance = plate.distance(&here, &capsule, &place, 5.0);
            assert!((distance - (off - 0.1)).abs() < 1e-9, "{distance} {off}");
        }
        assert!((plate.distance(&here, &cylinder, &at(0.3, 0.2, 0.5), 5.0) - 0.3).abs() < 1e-9);
        assert_eq!(plate.distance(&here, &cylinder, &at(0.3, 0.2, 0.1), 5.0), 0.0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        /// No direction shows two solids farther apart than they are, and the one found shows just that.
        #[test]
        fn a_gap_is_never_above_the_distance(
            place in prop::array::uniform3(-2.0..2.0_f64), turn in prop::array::uniform3(-3.0..3.0_f64), any in prop::array::uniform3(0.1..1.0_f64)
        ) {
            let pose = Pose { rotation: rotation_from_zyx(turn), translation: place.into() };
            let here = Pose { translation: Vector3::new(0.1, -0.3, 0.2), ..Pose::identity() };
            let mesh = Arc::new(box_mesh(Vector3::new(0.5, 0.3, 0.7)));
            let solids = [
                Solid::Box(Vector3::new(0.8, 1.2, 0.4)),
                Solid::Capsule { radius: 0.2, length: 0.9 },
                Solid::Cylinder { radius: 0.3, length: 0.5 },
                Solid::Hull(mesh.clone()),
                Solid::Mesh(mesh),
            ].map(|solid| Collider::new(&solid, &Pose { rotation: rotation_from_zyx(any), ..Pose::identity() }).unwrap());
            for a in &solids {
                for b in &solids {
                    let found = a.separation(&here, b, &pose, 10.0);
                    let axis = Vector3::from(any).normalize();
                    let rounding = 1e-5;
                    prop_assert!(a.gap(&here, b, &pose, &axis) <= found.distance + rounding);
                    if let Some(axis) = found.axis.filter(|_| found.distance > 0.0) {
                        prop_assert!((a.gap(&here, b, &pose, &axis) - found.distance).abs() < rounding);
                    }
                }
            }
        }

        /// A box as a box, as a hull, and as a mesh is as far from another solid.
        #[test]
        fn three_forms_of_a_box_agree(
            place in prop::array::uniform3(-2.0..2.0_f64), turn in prop::array::uniform3(-3.0..3.0_f64), limit in 0.05..3.0_f64
        ) {
            let edges = Vector3::new(0.8, 1.2, 0.4);
            let mesh = Arc::new(box_mesh(edges));
            let pose = Pose { rotation: rotation_from_zyx(turn), translation: place.into() };
            for other in [
                Solid::Capsule { radius: 0.2, length: 0.9 },
                Solid::Cylinder { radius: 0.3, length: 0.5 },
                Solid::Mesh(Arc::new(box_mesh(Vector3::new(0.5, 0.3, 0.7)))),
            ] {
                let other = collider(&other);
                let [plain, hull, mesh] = [Solid::Box(edges), Solid::Hull(mesh.clone()), Solid::Mesh(mesh.clone())]
                    .map(|solid| collider(&solid).distance(&Pose::identity(), &other, &pose, limit));
                // Far away, values are only not below the limit.
                let cut = |value: f64| if value <= 0.0 { 0.0 } else { value.min(limit) };
                // GJK ends at some micrometres on round surfaces.
                prop_assert!((cut(plain) - cut(hull)).abs() < 1e-5, "{plain} {hull}");
                prop_assert!((cut(plain) - cut(mesh)).abs() < 1e-5, "{plain} {mesh}");
            }
        }

        /// A mesh that is not convex is as far from a solid as the nearer of the boxes that make it up, and its nearest
        /// points are that far apart.
        #[test]
        fn a_mesh_with_a_notch_is_as_far_away_as_its_parts(
            place in prop::array::uniform3(-0.5..2.5_f64), turn in prop::array::uniform3(-3.0..3.0_f64), limit in 0.05..2.0_f64
        ) {
            let mesh = l_mesh();
            prop_assert!(mesh.is_closed());
            let whole = collider(&Solid::Mesh(Arc::new(mesh)));
            let parts = [
                (Vector3::new(2.0, 1.0, 1.0), Vector3::new(1.0, 0.5, 0.5)),
                (Vector3::new(1.0, 1.0, 1.0), Vector3::new(0.5, 1.5, 0.5)),
            ];
            let parts = parts.map(|(edges, middle)| {
                Collider::new(&Solid::Box(edges), &Pose { translation: middle, ..Pose::identity() }).unwrap()
            });
            let pose = Pose { rotation: rotation_from_zyx(turn), translation: place.into() };
            let here = Pose::identity();
            let rounding = 1e-5;
            let small = Vector3::new(0.3, 0.2, 0.1);
            for (other, radius) in [
                (Solid::Capsule { radius: 0.1, length: 0.4 }, 0.1),
                (Solid::Box(small), 0.0),
                (Solid::Mesh(Arc::new(box_mesh(small))), 0.0),
                (Solid::Cylinder { radius: 0.1, length: 0.4 }, 0.0),
            ] {
                let other = collider(&other);
                let of_parts = parts.iter().map(|part| part.distance(&here, &other, &pose, limit)).fold(limit, f64::min);
                let found = whole.separation(&here, &other, &pose, limit);
                prop_assert!((found.distance.min(limit) - of_parts).abs() < rounding, "{found:?} {of_parts}");
                if let Some(axis) = found.axis.filter(|_| found.distance > 0.0) {
                    prop_assert!(whole.gap(&here, &other, &pose, &axis) <= found.distance + rounding);
                }
                for (first, at, second, second_at) in [(&whole, &here, &other, &pose), (&other, &pose, &whole, &here)] {
                    match first.nearest(at, second, second_at, limit) {
                        Some(Nearest { distance, points: [a, b] }) => {
                            prop_assert!((distance - of_parts).abs() < rounding && distance < limit);
                            prop_assert!(((b - a).norm() - radius - distance).abs() < rounding);
                            let on_first = first.distance(at, &collider(&Solid::Box(Vector3::repeat(1e-6))), &Pose { translation: a, ..here }, 1.0);
                            prop_assert!(on_first < radius + rounding);
                        }
                        None => prop_assert!(of_parts <= rounding || of_parts >= limit - rounding, "{of_parts}"),
                    }
                }
            }
        }
    }
}
