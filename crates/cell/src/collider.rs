//! Distances between solids: the one adapter around the library of shapes (parry3d).
//!
//! Convex pairs are decided by GJK. A mesh is descended through its tree of boxes with the distance of each triangle from the other
//! solid, so that a distance costs hardly more than an intersection: the library's own distance of meshes does not prune both sides.
//!
//! On round surfaces GJK ends within 0.01 mm of the distance.
//!
//! The orientation goes to the library as a unit quaternion, so distances agree with the matrices of the arm to about 1e-12 m.

use crate::solid::{Solid, TriangleMesh};
use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use parry3d_f64::math::{Pose as ParryPose, Rotation, Vector};
use parry3d_f64::partitioning::BvhNode;
use parry3d_f64::query::{self, ClosestPoints, PointQuery};
use parry3d_f64::shape::{
    Capsule, ConvexPolyhedron, Cuboid, Cylinder, Shape as ParryShape, SharedShape, TriMesh, TriMeshFlags,
};
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
    Convex(SharedShape),
    Mesh(Box<TriMesh>, bool),
}

impl fmt::Debug for Collider {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Collider").field("pose", &self.pose).finish_non_exhaustive()
    }
}

/// How far a vertex may be outside of the hull, relative to its size.
const HULL_TOLERANCE: f64 = 1e-6;

fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

fn parry_pose(pose: &Pose<f64>) -> ParryPose {
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(pose.rotation));
    let [x, y, z, w] = [rotation.i, rotation.j, rotation.k, rotation.w];
    ParryPose::from_parts(vector(&pose.translation), Rotation::from_xyzw(x, y, z, w))
}

impl Collider {
    /// Makes a solid ready, at a pose in the frame of its attachment. `None` where the hull of a mesh cannot be formed.
    pub fn new(solid: &Solid, pose: &Pose<f64>) -> Option<Self> {
        let mut pose = parry_pose(pose);
        let form = match solid {
            Solid::Box(edges) => Form::Convex(SharedShape::new(Cuboid::new(vector(&(edges / 2.0))))),
            Solid::Cylinder { radius, length } => {
                // The library's cylinders stand along y.
                let half = std::f64::consts::FRAC_1_SQRT_2;
                let along_z = Rotation::from_xyzw(half, 0.0, 0.0, half);
                pose *= ParryPose::from_parts(Vector::ZERO, along_z);
                Form::Convex(SharedShape::new(Cylinder::new(length / 2.0, *radius)))
            }
            Solid::Capsule { radius, length } => Form::Convex(SharedShape::new(Capsule::new_z(length / 2.0, *radius))),
            Solid::Hull(mesh) => {
                let points: Vec<Vector> = mesh.vertices().iter().map(vector).collect();
                let hull = ConvexPolyhedron::from_convex_hull(&points)?;
                // What the library makes of flat meshes does not contain them.
                let size = hull.local_aabb().half_extents().length();
                let is_outside = |point: &Vector| hull.distance_to_local_point(*point, true) > HULL_TOLERANCE * size;
                if points.iter().any(is_outside) {
                    return None;
                }
                Form::Convex(SharedShape::new(hull))
            }
            Solid::Mesh(mesh) => Form::Mesh(Box::new(tri_mesh(mesh)?), mesh.is_closed()),
        };
        Some(Self { form, pose })
    }

    /// The distance of two solids whose attachments stand at poses in one frame, where it is below `limit`; else a value not below
    /// that; zero where they touch. m
    pub fn distance(&self, at: &Pose<f64>, other: &Self, other_at: &Pose<f64>, limit: f64) -> f64 {
        let poses = [parry_pose(at) * self.pose, parry_pose(other_at) * other.pose];
        match (&self.form, &other.form) {
            (Form::Convex(a), Form::Convex(b)) => {
                convex_distance((&poses[0], a.as_ref()), (&poses[1], b.as_ref()), limit)
            }
            (Form::Mesh(mesh, is_closed), Form::Convex(b)) => {
                mesh_distance((mesh, *is_closed), &poses[0].inv_mul(&poses[1]), b.as_ref(), limit)
            }
            (Form::Convex(a), Form::Mesh(mesh, is_closed)) => {
                mesh_distance((mesh, *is_closed), &poses[1].inv_mul(&poses[0]), a.as_ref(), limit)
            }
            (Form::Mesh(a, a_closed), Form::Mesh(b, b_closed)) => {
                meshes_distance((a, *a_closed), (b, *b_closed), &poses[0].inv_mul(&poses[1]), limit)
            }
        }
    }
}

fn tri_mesh(mesh: &TriangleMesh) -> Option<TriMesh> {
    let vertices: Vec<Vector> = mesh.vertices().iter().map(vector).collect();
    // What is inside of a closed mesh is told by the normals of its edges and vertices.
    let flags = if mesh.is_closed() { TriMeshFlags::ORIENTED } else { TriMeshFlags::empty() };
    TriMesh::with_flags(vertices, mesh.triangles().to_vec(), flags).ok()
}

/// The distance of two convex solids, where it is below `limit`; zero where they touch.
fn convex_distance(
    (a_at, a): (&ParryPose, &dyn ParryShape),
    (b_at, b): (&ParryPose, &dyn ParryShape),
    limit: f64,
) -> f64 {
    // The search ends as soon as the two are known to be farther apart.
    match query::closest_points(a_at, a, b_at, b, limit) {
        Ok(ClosestPoints::Disjoint) => limit,
        Ok(ClosestPoints::WithinMargin(on_a, on_b)) => (on_a - on_b).length(),
        // Pairs that the library does not know count as touching.
        Ok(ClosestPoints::Intersecting) | Err(_) => 0.0,
    }
}

/// The distance of a box of the tree from a point, less a radius.
fn box_distance(node: &BvhNode, centre: Vector, radius: f64) -> f64 {
    let outside = (node.mins() - centre).max(centre - node.maxs()).max(Vector::ZERO);
    (outside.length() - radius).max(0.0)
}

/// The distance of a convex solid from a mesh, where it is below `limit`.
fn mesh_distance(
    (mesh, is_closed): (&TriMesh, bool),
    mesh_from_solid: &ParryPose,
    solid: &dyn ParryShape,
    limit: f64,
) -> f64 {
    let sphere = solid.compute_bounding_sphere(mesh_from_solid);
    let bounds = solid.compute_aabb(mesh_from_solid);
    let node_cost = |node: &BvhNode, _: f64| {
        let apart = (node.mins() - bounds.maxs).max(bounds.mins - node.maxs()).max(Vector::ZERO).length();
        apart.max(box_distance(node, sphere.center, sphere.radius))
    };
    let leaf_cost = |leaf: u32, known: f64| {
        Some(convex_distance((mesh_from_solid, solid), (&ParryPose::IDENTITY, &mesh.triangle(leaf)), known))
    };
    // Only costs below the limit are found; the search stops at once where one is zero.
    match mesh.bvh().find_best(limit.max(f64::MIN_POSITIVE), node_cost, leaf_cost) {
        Some((_, distance)) if distance <= 0.0 => 0.0,
        found => {
            if is_closed && is_inside(mesh, sphere.center) {
                return 0.0;
            }
            found.map_or(limit.max(f64::MIN_POSITIVE), |(_, distance)| distance)
        }
    }
}

/// Whether a point is inside a closed mesh.
fn is_inside(mesh: &TriMesh, point: Vector) -> bool {
    let bounds = mesh.local_aabb();
    let is_near = (0..3).all(|k| point[k] >= bounds.mins[k] && point[k] <= bounds.maxs[k]);
    is_near && mesh.contains_local_point(point)
}

/// The distance of two meshes, where it is below `limit`.
fn meshes_distance(a: (&TriMesh, bool), b: (&TriMesh, bool), a_from_b: &ParryPose, limit: f64) -> f64 {
    // The triangles of the smaller one, each against the tree of the other.
    if a.0.num_triangles() < b.0.num_triangles() {
        return meshes_distance(b, a, &a_from_b.inverse(), limit);
    }
    let mut nearest = limit.max(f64::MIN_POSITIVE);
    for triangle in b.0.triangles() {
        let found = mesh_distance((a.0, false), a_from_b, &triangle, nearest);
        nearest = nearest.min(found);
        if nearest <= 0.0 {
            return 0.0;
        }
    }
    let inside = |outer: (&TriMesh, bool), inner: &TriMesh, pose: &ParryPose| {
        outer.1 && inner.vertices().first().is_some_and(|v| is_inside(outer.0, pose.transform_point(*v)))
    };
    if inside(a, b.0, a_from_b) || inside(b, a.0, &a_from_b.inverse()) { 0.0 } else { nearest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::tests::box_mesh;
    use proptest::prelude::*;
    use std::sync::Arc;
    use stead_numerics::rotation::rotation_from_zyx;

    fn at(x: f64, y: f64, z: f64) -> Pose<f64> {
        Pose { translation: Vector3::new(x, y, z), ..Pose::identity() }
    }

    fn collider(solid: &Solid) -> Collider {
        Collider::new(solid, &Pose::identity()).unwrap()
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

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
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
    }
}
