//! Meshes of triangles, and their distance from other solids.
//!
//! A mesh is descended through its tree of boxes with the distance of each triangle from the other solid, so that a distance costs
//! hardly more than an intersection: the library's own distance of meshes does not prune both sides.

use super::convex::{Convex, core_distance};
use super::vector;
use crate::solid::TriangleMesh;
use parry3d_f64::bounding_volume::{Aabb, BoundingSphere};
use parry3d_f64::math::{Pose as ParryPose, Vector};
use parry3d_f64::partitioning::BvhNode;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::{Shape as ParryShape, SupportMap, TriMesh, TriMeshFlags};

/// A mesh with its tree.
#[derive(Clone)]
pub struct Mesh {
    triangles: TriMesh,
    /// Whether it is the surface of a solid.
    is_closed: bool,
}

/// What is held against a mesh, in the frame of the mesh.
struct Other<'a> {
    core: &'a dyn SupportMap,
    /// Of all points that are not farther than this from the core. m
    radius: f64,
    from_mesh: ParryPose,
    sphere: BoundingSphere,
    bounds: Aabb,
}

impl Mesh {
    pub fn new(mesh: &TriangleMesh) -> Option<Self> {
        let vertices: Vec<Vector> = mesh.vertices().iter().map(vector).collect();
        let formed = |flags: TriMeshFlags| TriMesh::with_flags(vertices.clone(), mesh.triangles().to_vec(), flags).ok();
        // What is inside of a closed mesh is told by the normals of its edges and vertices.
        let solid = mesh.is_closed().then(|| formed(TriMeshFlags::ORIENTED)).flatten();
        let is_closed = solid.is_some();
        Some(Self { triangles: solid.or_else(|| formed(TriMeshFlags::empty()))?, is_closed })
    }

    /// How far the box around it extends along a direction. m
    pub fn extent(&self, direction: Vector) -> f64 {
        let bounds = self.triangles.local_aabb();
        bounds.center().dot(direction) + bounds.half_extents().dot(direction.abs())
    }

    /// The distance of a convex solid at a pose, where it is below `limit`; else a value not below that.
    pub fn distance(&self, pose: &ParryPose, solid: &Convex, limit: f64) -> f64 {
        let (sphere, bounds) = solid.bounds(pose);
        let other = Other { core: solid.core(), radius: solid.radius(), from_mesh: pose.inverse(), sphere, bounds };
        let distance = self.surface_distance(&other, limit);
        if distance > 0.0 && self.is_inside(sphere.center) { 0.0 } else { distance }
    }

    /// The same of another mesh.
    pub fn distance_to_mesh(&self, pose: &ParryPose, other: &Self, limit: f64) -> f64 {
        // The triangles of the smaller one, each against the tree of the other.
        if self.triangles.num_triangles() < other.triangles.num_triangles() {
            return other.distance_to_mesh(&pose.inverse(), self, limit);
        }
        let mut nearest = limit.max(f64::MIN_POSITIVE);
        for triangle in other.triangles.triangles() {
            let (sphere, bounds) = (triangle.compute_bounding_sphere(pose), triangle.compute_aabb(pose));
            let one = Other { core: &triangle, radius: 0.0, from_mesh: pose.inverse(), sphere, bounds };
            nearest = nearest.min(self.surface_distance(&one, nearest));
            if nearest <= 0.0 {
                return 0.0;
            }
        }
        let inside = |outer: &Self, inner: &Self, pose: &ParryPose| {
            inner.triangles.vertices().first().is_some_and(|v| outer.is_inside(pose.transform_point(*v)))
        };
        if inside(self, other, pose) || inside(other, self, &pose.inverse()) { 0.0 } else { nearest }
    }

    /// The distance of the nearest triangle, where it is below `limit`.
    fn surface_distance(&self, other: &Other<'_>, limit: f64) -> f64 {
        let node_cost = |node: &BvhNode, _: f64| {
            let apart = (node.mins() - other.bounds.maxs).max(other.bounds.mins - node.maxs()).max(Vector::ZERO);
            apart.length().max(box_distance(node, other.sphere.center, other.sphere.radius))
        };
        let leaf_cost = |leaf: u32, known: f64| {
            let triangle = self.triangles.triangle(leaf);
            let (distance, _) = core_distance(other.core, &other.from_mesh, &triangle, known + other.radius);
            Some((distance - other.radius).max(0.0))
        };
        // Only costs below the limit are found; the search stops at once where one is zero.
        let limit = limit.max(f64::MIN_POSITIVE);
        self.triangles.bvh().find_best(limit, node_cost, leaf_cost).map_or(limit, |(_, distance)| distance)
    }

    /// Whether a point is inside, where it is closed.
    fn is_inside(&self, point: Vector) -> bool {
        let bounds = self.triangles.local_aabb();
        let is_near = (0..3).all(|k| point[k] >= bounds.mins[k] && point[k] <= bounds.maxs[k]);
        self.is_closed && is_near && self.triangles.contains_local_point(point)
    }
}

/// The distance of a box of the tree from a point, less a radius.
fn box_distance(node: &BvhNode, centre: Vector, radius: f64) -> f64 {
    let outside = (node.mins() - centre).max(centre - node.maxs()).max(Vector::ZERO);
    (outside.length() - radius).max(0.0)
}
