//! Convex solids, and their distance by GJK.
//!
//! A capsule is a segment with a radius: GJK ends after a few steps on a segment, where it would creep along the round surface. On
//! cylinders it ends within 0.01 mm of the distance.

use super::vector;
use crate::solid::Solid;
use parry3d_f64::bounding_volume::{Aabb, BoundingSphere};
use parry3d_f64::math::{Pose as ParryPose, Rotation, Vector};
use parry3d_f64::query::PointQuery;
use parry3d_f64::query::details::closest_points_support_map_support_map_with_params;
use parry3d_f64::query::gjk::{GJKResult, VoronoiSimplex};
use parry3d_f64::shape::{ConvexPolyhedron, Cuboid, Cylinder, Segment, SupportMap};
use std::sync::Arc;

/// All points that are not farther than a radius from a core.
#[derive(Clone)]
pub struct Convex {
    core: Core,
    /// m
    radius: f64,
}

#[derive(Clone)]
enum Core {
    Segment(Segment),
    Box(Cuboid),
    Cylinder(Cylinder),
    Hull(Arc<Hull>),
}

/// The convex hull of points.
struct Hull {
    /// At least one.
    points: Vec<Vector>,
}

impl SupportMap for Hull {
    fn local_support_point(&self, direction: Vector) -> Vector {
        let farther =
            |best: Vector, point: &Vector| if point.dot(direction) > best.dot(direction) { *point } else { best };
        self.points.iter().fold(self.points[0], farther)
    }
}

/// The corners of the hull of points, or all points where the library forms no hull that contains them: the hull is the same, only more
/// is looked at.
fn corners(points: Vec<Vector>) -> Vec<Vector> {
    // A corrupt mesh must not end the program: the library asserts that its links are right.
    let formed = || {
        let hull = ConvexPolyhedron::from_convex_hull(&points)?;
        // What the library makes of flat meshes does not contain them.
        let size = hull.local_aabb().half_extents().length();
        let is_inside = |point: &Vector| hull.distance_to_local_point(*point, true) <= HULL_TOLERANCE * size;
        points.iter().all(is_inside).then(|| hull.points().to_vec())
    };
    std::panic::catch_unwind(formed).ok().flatten().unwrap_or(points)
}

/// How far a vertex may be outside of the hull, relative to its size.
const HULL_TOLERANCE: f64 = 1e-6;
/// See [`Convex::around`].
const MOST_POINTS: usize = 20_000;
/// See [`Convex::around`].
const MOST_CORNERS: usize = 200;
/// What rounding makes of a separating distance, relative.
const ROUNDING: f64 = 1e-9;

impl Convex {
    /// A solid that is not a mesh, and the pose of the library's form of it, whose cylinders stand along y; `None` where a mesh
    /// has no vertex.
    pub fn new(solid: &Solid) -> Option<(Self, ParryPose)> {
        let plain = |core: Core| Some((Self { core, radius: 0.0 }, ParryPose::IDENTITY));
        match solid {
            Solid::Box(edges) => plain(Core::Box(Cuboid::new(vector(&(edges / 2.0))))),
            Solid::Cylinder { radius, length } => {
                let half = std::f64::consts::FRAC_1_SQRT_2;
                let along_z = ParryPose::from_parts(Vector::ZERO, Rotation::from_xyzw(half, 0.0, 0.0, half));
                Some((Self { core: Core::Cylinder(Cylinder::new(length / 2.0, *radius)), radius: 0.0 }, along_z))
            }
            Solid::Capsule { radius, length } => {
                let end = Vector::new(0.0, 0.0, length / 2.0);
                Some((Self { core: Core::Segment(Segment::new(-end, end)), radius: *radius }, ParryPose::IDENTITY))
            }
            Solid::Hull(mesh) | Solid::Mesh(mesh) => {
                let points: Vec<Vector> = mesh.vertices().iter().map(vector).collect();
                (!points.is_empty()).then(|| (Self::hull(corners(points), 0.0), ParryPose::IDENTITY))
            }
        }
    }

    /// All that is not farther than a radius (m) from the hull of points.
    fn hull(points: Vec<Vector>, radius: f64) -> Self {
        Self { core: Core::Hull(Arc::new(Hull { points })), radius }
    }

    /// What contains all points for certain: their hull and a little more, since its corners may be off by rounding; of so many points
    /// that their hull may take longer than what it saves, the box around them. `None` where there is none.
    pub fn around(points: Vec<Vector>) -> Option<Self> {
        if points.is_empty() {
            return None;
        }
        let bounds = Aabb::from_points(points.iter().copied());
        let radius = HULL_TOLERANCE * bounds.half_extents().length();
        let hull = (points.len() <= MOST_POINTS).then(|| corners(points)).filter(|hull| hull.len() <= MOST_CORNERS);
        Some(Self::hull(hull.unwrap_or_else(|| bounds.vertices().to_vec()), radius))
    }

    /// What its points are not farther from than its radius.
    pub fn core(&self) -> &dyn SupportMap {
        match &self.core {
            Core::Segment(segment) => segment,
            Core::Box(cuboid) => cuboid,
            Core::Cylinder(cylinder) => cylinder,
            Core::Hull(hull) => hull.as_ref(),
        }
    }

    /// How far it extends along a direction. m
    pub fn extent(&self, direction: Vector) -> f64 {
        let farthest = match &self.core {
            Core::Segment(segment) => segment.local_support_point(direction),
            Core::Box(cuboid) => cuboid.local_support_point(direction),
            Core::Cylinder(cylinder) => cylinder.local_support_point(direction),
            Core::Hull(hull) => hull.local_support_point(direction),
        };
        farthest.dot(direction) + self.radius * direction.length()
    }

    /// A sphere and a box around it, at a pose.
    pub fn bounds(&self, pose: &ParryPose) -> (BoundingSphere, Aabb) {
        let (sphere, core) = match &self.core {
            Core::Segment(shape) => (shape.bounding_sphere(pose), shape.aabb(pose)),
            Core::Box(shape) => (shape.bounding_sphere(pose), shape.aabb(pose)),
            Core::Cylinder(shape) => (shape.bounding_sphere(pose), shape.aabb(pose)),
            Core::Hull(hull) => {
                let points = || hull.points.iter().map(|point| pose * *point);
                // Its centre is inside.
                let centre = points().fold(Vector::ZERO, |sum, point| sum + point) / hull.points.len() as f64;
                let radius = points().map(|point| (point - centre).length()).fold(0.0, f64::max);
                (BoundingSphere::new(centre, radius), Aabb::from_points(points()))
            }
        };
        let outside = Vector::splat(self.radius);
        let bounds = Aabb::new(core.mins - outside, core.maxs + outside);
        (BoundingSphere::new(sphere.center, sphere.radius + self.radius), bounds)
    }

    /// The distance of another convex solid at a pose, where it is below `limit`, else a value not below that, zero where they touch; and
    /// the direction from one to the other.
    pub fn distance(&self, pose: &ParryPose, other: &Self, limit: f64) -> (f64, Option<Vector>) {
        let around = self.radius + other.radius;
        let (distance, axis) = core_distance(self.core(), pose, other.core(), limit + around);
        ((distance - around).max(0.0), axis)
    }

    /// How far away another convex solid at a pose is, and the nearest points of the two cores in this one's frame; `None` where it is
    /// not below `limit`, or they touch.
    pub fn nearest(&self, pose: &ParryPose, other: &Self, limit: f64) -> Option<(f64, [Vector; 2])> {
        let around = self.radius + other.radius;
        let points = nearest_core_points(self.core(), pose, other.core(), limit + around)?;
        let distance = (points[1] - points[0]).length() - around;
        (distance > 0.0 && distance < limit).then_some((distance, points))
    }

    /// How far its points are from the core at the most. m
    pub fn radius(&self) -> f64 {
        self.radius
    }
}

/// The nearest points of two cores, the second at a pose in the frame of the first, in that frame; `None` where they are not nearer than
/// `limit`, or touch.
pub fn nearest_core_points(
    a: &dyn SupportMap,
    pose: &ParryPose,
    b: &dyn SupportMap,
    limit: f64,
) -> Option<[Vector; 2]> {
    let simplex = &mut VoronoiSimplex::new();
    match closest_points_support_map_support_map_with_params(pose, a, b, limit, simplex, None) {
        GJKResult::ClosestPoints(on_a, on_b, _) => Some([on_a, on_b]),
        GJKResult::NoIntersection(_) | GJKResult::Intersection | GJKResult::Proximity(_) => None,
    }
}

/// The distance of two cores, the second at a pose in the frame of the first, where it is below `limit`; else a value not below that.
pub fn core_distance(a: &dyn SupportMap, pose: &ParryPose, b: &dyn SupportMap, limit: f64) -> (f64, Option<Vector>) {
    // The search ends as soon as the two are known to be farther apart.
    let simplex = &mut VoronoiSimplex::new();
    match closest_points_support_map_support_map_with_params(pose, a, b, limit, simplex, None) {
        GJKResult::ClosestPoints(on_a, on_b, _) => {
            let distance = (on_b - on_a).length();
            (distance, (distance > 0.0).then(|| (on_b - on_a) / distance))
        }
        GJKResult::NoIntersection(axis) => {
            // The library says so too where its search does not end.
            let gap = b.support_point(pose, -axis).dot(axis) - a.local_support_point(axis).dot(axis);
            if gap >= limit * (1.0 - ROUNDING) { (gap.max(limit), Some(axis)) } else { (gap.max(0.0), None) }
        }
        GJKResult::Intersection | GJKResult::Proximity(_) => (0.0, None),
    }
}
