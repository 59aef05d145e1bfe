//! Meshes of triangles, and their distance from other solids.
//!
//! A mesh is descended through its tree of boxes with the distance of each triangle from the other solid, so that a
//! distance costs hardly more than an intersection; two meshes through the trees of both: the library's own distance of
//! meshes does not prune both sides.

use super::convex::{Convex, core_distance, nearest_core_points, vector};
use super::tree::{MARGIN, Tree};
use crate::solid::TriangleMesh;
use parry3d_f64::bounding_volume::{Aabb, BoundingSphere};
use parry3d_f64::math::{Pose as ParryPose, Vector};
use parry3d_f64::partitioning::BvhNode;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::{Shape as ParryShape, SupportMap, TriMesh, TriMeshFlags, Triangle};

/// A mesh with its tree.
#[derive(Clone)]
pub struct Mesh {
    triangles: TriMesh,
    /// What other meshes are held against.
    tree: Tree,
    /// Whether it is the surface of a solid.
    is_closed: bool,
    /// The solids that it is made of, where there are several.
    solids: Vec<Part>,
    /// The convex hull of its vertices, and a little more for rounding.
    hull: Convex,
}

/// A closed surface of a mesh that has several, facing outwards.
#[derive(Clone)]
struct Part {
    surface: TriMesh,
    /// Whether it is a hollow in another.
    is_hollow: bool,
}

/// A distance from the hull and one from the mesh that differ by no more are one: what rounding and GJK on round
/// surfaces make of them. m
const SAME: f64 = 5e-6;

/// What is held against a mesh, in the frame of the mesh.
struct Other<'a> {
    core: &'a dyn SupportMap,
    /// Of all points that are not farther than this from the core. m
    radius: f64,
    from_mesh: ParryPose,
    sphere: BoundingSphere,
    bounds: Aabb,
}

impl<'a> Other<'a> {
    fn convex(solid: &'a Convex, pose: &ParryPose) -> Self {
        let (sphere, bounds) = solid.bounds(pose);
        Self { core: solid.core(), radius: solid.radius(), from_mesh: pose.inverse(), sphere, bounds }
    }

    fn triangle(triangle: &'a Triangle, pose: &ParryPose) -> Self {
        let (sphere, bounds) = (triangle.compute_bounding_sphere(pose), triangle.compute_aabb(pose));
        Self { core: triangle, radius: 0.0, from_mesh: pose.inverse(), sphere, bounds }
    }
}

impl Mesh {
    pub fn new(mesh: &TriangleMesh) -> Option<Self> {
        let vertices: Vec<Vector> = mesh.vertices().iter().map(vector).collect();
        let formed = |flags: TriMeshFlags| TriMesh::with_flags(vertices.clone(), mesh.triangles().to_vec(), flags).ok();
        // What is inside of a closed surface is told by the normals of its edges and vertices; of several, of each by
        // itself.
        let hull = Convex::around(vertices.clone())?;
        let of = |triangles: TriMesh, solids: Option<Vec<Part>>, is_closed: bool| {
            let tree = Tree::new(&triangles.triangles().collect::<Vec<Triangle>>());
            Self { triangles, tree, is_closed, solids: solids.unwrap_or_default(), hull }
        };
        if !mesh.solids().is_empty() {
            let solids = parts(mesh);
            let is_closed = solids.is_some();
            return Some(of(formed(TriMeshFlags::empty())?, solids, is_closed));
        }
        let solid = mesh.is_closed().then(|| formed(TriMeshFlags::ORIENTED)).flatten();
        let is_closed = solid.is_some();
        Some(of(solid.or_else(|| formed(TriMeshFlags::empty()))?, None, is_closed))
    }

    /// How far it extends along a direction. m
    pub fn extent(&self, direction: Vector) -> f64 {
        self.hull.extent(direction)
    }

    /// The distance of a convex solid at a pose, where it is below `limit`; else a value not below that. The direction
    /// from one to the other, where the hull of the mesh is as far away.
    pub fn distance(&self, pose: &ParryPose, solid: &Convex, limit: f64) -> (f64, Option<Vector>) {
        unless_by_hulls(self.hull.distance(pose, solid, limit), limit, || self.distance_to_convex(pose, solid, limit))
    }

    fn distance_to_convex(&self, pose: &ParryPose, solid: &Convex, limit: f64) -> f64 {
        let other = Other::convex(solid, pose);
        let distance = self.surface_distance(&other, limit);
        if distance > 0.0 && self.is_inside(other.sphere.center) { 0.0 } else { distance }
    }

    /// How far away a convex solid at a pose is, and the nearest points of the mesh and of its core in the frame of the
    /// mesh; `None` where it is not below `limit`, or they touch.
    pub fn nearest(&self, pose: &ParryPose, solid: &Convex, limit: f64) -> Option<(f64, [Vector; 2])> {
        let other = Other::convex(solid, pose);
        let found = self.nearest_triangle(&other, limit)?;
        let points = self.points_of(&other, found)?;
        (!self.is_inside(other.sphere.center)).then_some((found.1, points))
    }

    /// The same of another mesh.
    pub fn nearest_of_mesh(&self, pose: &ParryPose, other: &Self, limit: f64) -> Option<(f64, [Vector; 2])> {
        let (on_self, on_other, distance) = self.nearest_triangles(pose, other, limit)?;
        let triangle = other.triangles.triangle(on_other);
        let points = self.points_of(&Other::triangle(&triangle, pose), (on_self, distance))?;
        (!self.is_within_or_around(pose, other)).then_some((distance, points))
    }

    /// The same of another mesh.
    pub fn distance_to_mesh(&self, pose: &ParryPose, other: &Self, limit: f64) -> (f64, Option<Vector>) {
        unless_by_hulls(self.hull.distance(pose, &other.hull, limit), limit, || {
            let limit = limit.max(f64::MIN_POSITIVE);
            let nearest = self.nearest_triangles(pose, other, limit).map_or(limit, |(_, _, distance)| distance);
            if nearest > 0.0 && self.is_within_or_around(pose, other) { 0.0 } else { nearest }
        })
    }

    /// The numbers of the triangles of this mesh and of the other that are nearest to each other, and their distance,
    /// where that is below `limit`, a positive number; the first that touch, where any do.
    fn nearest_triangles(&self, pose: &ParryPose, other: &Self, limit: f64) -> Option<(u32, u32, f64)> {
        let from_mesh = pose.inverse();
        self.tree.nearest(pose, &other.tree, limit, |on_self, on_other, known| {
            let [own, others] = [self.triangles.triangle(on_self), other.triangles.triangle(on_other)];
            // Most pairs are distinguished by a direction that is easily found.
            let gap = gap_of_triangles(own.vertices(), &others.vertices().map(|vertex| pose * vertex));
            if gap >= known { gap } else { core_distance(&others, &from_mesh, &own, known).0 }
        })
    }

    /// Whether one of two meshes whose surfaces do not meet is inside of the other.
    fn is_within_or_around(&self, pose: &ParryPose, other: &Self) -> bool {
        let is_inside = |outer: &Self, inner: &Self, pose: &ParryPose| {
            inner.triangles.vertices().first().is_some_and(|v| outer.is_inside(pose.transform_point(*v)))
        };
        is_inside(self, other, pose) || is_inside(other, self, &pose.inverse())
    }

    /// The distance of the nearest triangle, where it is below `limit`; else that.
    fn surface_distance(&self, other: &Other<'_>, limit: f64) -> f64 {
        let limit = limit.max(f64::MIN_POSITIVE);
        self.nearest_triangle(other, limit).map_or(limit, |(_, distance)| distance)
    }

    /// The nearest points of a triangle at a distance and of the other; `None` where that is zero.
    fn points_of(&self, other: &Other<'_>, nearest: (u32, f64)) -> Option<[Vector; 2]> {
        let triangle = self.triangles.triangle(nearest.0);
        let points = nearest_core_points(other.core, &other.from_mesh, &triangle, f64::INFINITY);
        let [on_other, on_mesh] = points.filter(|_| nearest.1 > 0.0)?.map(|point| other.from_mesh.inverse() * point);
        Some([on_mesh, on_other])
    }

    /// The nearest triangle and its distance, where that is below `limit`, a positive number.
    fn nearest_triangle(&self, other: &Other<'_>, limit: f64) -> Option<(u32, f64)> {
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
        self.triangles.bvh().find_best(limit, node_cost, leaf_cost)
    }

    /// Whether a point is inside, where it is closed.
    fn is_inside(&self, point: Vector) -> bool {
        let bounds = self.triangles.local_aabb();
        let is_near = (0..3).all(|k| point[k] >= bounds.mins[k] && point[k] <= bounds.maxs[k]);
        if !self.is_closed || !is_near {
            return false;
        }
        if self.solids.is_empty() {
            return self.triangles.contains_local_point(point);
        }
        let around = self.solids.iter().filter(|part| part.contains(point));
        around.map(|part| if part.is_hollow { -1 } else { 1 }).sum::<i32>() > 0
    }
}

impl Part {
    fn contains(&self, point: Vector) -> bool {
        let bounds = self.surface.local_aabb();
        let is_near = (0..3).all(|k| point[k] >= bounds.mins[k] && point[k] <= bounds.maxs[k]);
        is_near && self.surface.contains_local_point(point)
    }
}

/// The closed surfaces of a mesh. One that faces inwards is a hollow where it lies in one that faces outwards; else the
/// file has turned it.
fn parts(mesh: &TriangleMesh) -> Option<Vec<Part>> {
    let read = |triangles: &Vec<[u32; 3]>| {
        let mut corners: Vec<u32> = triangles.iter().flatten().copied().collect();
        corners.sort_unstable();
        corners.dedup();
        let vertices: Vec<Vector> = corners.iter().map(|corner| vector(&mesh.vertices()[*corner as usize])).collect();
        let about = vertices.first().copied()?;
        let at = |corner: u32| corners.binary_search(&corner).unwrap_or_default();
        let mut own: Vec<[u32; 3]> =
            triangles.iter().map(|triangle| triangle.map(|corner| at(corner) as u32)).collect();
        let volume = |[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|corner| vertices[*corner as usize] - about);
            a.dot(b.cross(c))
        };
        let is_turned = own.iter().map(volume).sum::<f64>() < 0.0;
        if is_turned {
            own.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        let surface = TriMesh::with_flags(vertices, own, TriMeshFlags::ORIENTED).ok()?;
        Some((Part { surface, is_hollow: false }, is_turned))
    };
    let read: Vec<(Part, bool)> = mesh.solids().iter().map(read).collect::<Option<_>>()?;
    let is_within = |part: &Part| {
        let vertex = part.surface.vertices().first();
        vertex.is_some_and(|v| read.iter().any(|(outer, is_turned)| !is_turned && outer.contains(*v)))
    };
    Some(
        read.iter()
            .map(|(part, is_turned)| Part { is_hollow: *is_turned && is_within(part), ..part.clone() })
            .collect(),
    )
}

/// The distance and direction of two hulls where that is enough; else the distance of what is in them, with that
/// direction where it is as large.
fn unless_by_hulls(hulls: (f64, Option<Vector>), limit: f64, distance: impl FnOnce() -> f64) -> (f64, Option<Vector>) {
    if hulls.0 >= limit && hulls.0 > 0.0 {
        return hulls;
    }
    let distance = distance();
    (distance, hulls.1.filter(|_| hulls.0 > 0.0 && (distance - hulls.0).abs() <= SAME))
}

/// How far two triangles are apart at the least: along the normals of both, and along the line between their middles. m
fn gap_of_triangles(a: &[Vector; 3], b: &[Vector; 3]) -> f64 {
    let normal = |[a, b, c]: &[Vector; 3]| (*b - *a).cross(*c - *a);
    let middles = b[0] + b[1] + b[2] - a[0] - a[1] - a[2];
    let along = |direction: Vector| {
        let [a, b] = [a, b].map(|corners| corners.map(|corner| corner.dot(direction)));
        let (low, high) = (|[a, b, c]: [f64; 3]| a.min(b).min(c), |[a, b, c]: [f64; 3]| a.max(b).max(c));
        (low(b) - high(a)).max(low(a) - high(b)) / direction.length().max(f64::MIN_POSITIVE)
    };
    // Less what rounding makes of it.
    [normal(a), normal(b), middles].map(along).into_iter().fold(0.0, f64::max) - MARGIN
}

/// The distance of a box of the tree from a point, less a radius.
fn box_distance(node: &BvhNode, centre: Vector, radius: f64) -> f64 {
    let outside = (node.mins() - centre).max(centre - node.maxs()).max(Vector::ZERO);
    (outside.length() - radius).max(0.0)
}
