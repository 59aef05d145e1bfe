//! Convex solids, and their distance by GJK.
//!
//! A capsule is a segment with a radius: GJK ends after a few steps on a segment, where it would creep along the round
//! surface. On cylinders it ends within 0.01 mm of the distance.

use crate::solid::Solid;
use nalgebra::Vector3;
use parry3d_f64::bounding_volume::{Aabb, BoundingSphere};
use parry3d_f64::math::{Pose as ParryPose, Rotation, Vector};
use parry3d_f64::query::PointQuery;
use parry3d_f64::query::details::closest_points_support_map_support_map_with_params;
use parry3d_f64::query::gjk::{GJKResult, VoronoiSimplex};
use parry3d_f64::shape::{ConvexPolyhedron, Cuboid, Cylinder, Segment, SupportMap};
use parry3d_f64::transformation::try_convex_hull;
use std::sync::Arc;

/// A vector as the library has it.
pub(super) fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

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

/// The corners of the hull of points and, of many points, others on it or near it; all points where the library forms
/// no hull that contains them: the hull is the same, only more is looked at.
fn corners(points: Vec<Vector>) -> Vec<Vector> {
    // A corrupt mesh must not end the program: the library asserts that its links are right.
    let formed = || if points.len() <= MOST_AT_ONCE { formed(&points) } else { outermost(&points) };
    std::panic::catch_unwind(formed).ok().flatten().unwrap_or(points)
}

/// The corners of the hull that the library forms, in a time that grows with the square of their number.
fn formed(points: &[Vector]) -> Option<Vec<Vector>> {
    let hull = ConvexPolyhedron::from_convex_hull(points)?;
    // What the library makes of flat meshes does not contain them.
    let size = hull.local_aabb().half_extents().length();
    let is_inside = |point: &Vector| hull.distance_to_local_point(*point, true) <= HULL_TOLERANCE * size;
    points.iter().all(is_inside).then(|| hull.points().to_vec())
}

/// Points without those that are in the hull of a few of them, in a time that grows with their number: the hull of the
/// outermost ones along some directions, and of those that are farthest from the faces of that hull, and so on.
fn outermost(points: &[Vector]) -> Option<Vec<Vector>> {
    let size = Aabb::from_points(points.iter().copied()).half_extents().length();
    let mut chosen: Vec<usize> = Vec::new();
    for k in 0..27 {
        let direction = Vector::new(f64::from(k % 3 - 1), f64::from(k / 3 % 3 - 1), f64::from(k / 9 - 1));
        chosen.extend((0..points.len()).max_by(|a, b| points[*a].dot(direction).total_cmp(&points[*b].dot(direction))));
    }
    let mut outside: Vec<usize> = (0..points.len()).collect();
    let mut known = 0;
    loop {
        chosen.sort_unstable();
        chosen.dedup();
        let some: Vec<Vector> = chosen.iter().map(|number| points[*number]).collect();
        let (corners, faces) = try_convex_hull(&some).ok()?;
        let centre = corners.iter().fold(Vector::ZERO, |sum, point| sum + *point) / corners.len() as f64;
        let faces = faces.iter().map(|face| face.map(|number| corners[number as usize]));
        let planes = faces.filter_map(|[a, b, c]| {
            let normal = (b - a).cross(c - a).try_normalize()?;
            Some((normal, normal.dot(a)))
        });
        let planes: Vec<(Vector, f64)> = planes.collect();
        // A hull that is as much larger that its nearest face is so much farther out sticks out by no more than the
        // tolerance.
        let inner = planes.iter().map(|(normal, offset)| offset - normal.dot(centre)).fold(f64::INFINITY, f64::min);
        if !inner.is_finite() || inner < FLAT * size {
            return None;
        }
        let tolerance = HULL_TOLERANCE * inner / 2.0;
        let mut farthest: Vec<Option<(f64, usize)>> = vec![None; planes.len()];
        outside.retain(|number| {
            let beyond =
                |(face, (normal, offset)): (usize, &(Vector, f64))| (normal.dot(points[*number]) - offset, face);
            let most = planes.iter().enumerate().map(beyond).max_by(|a, b| a.0.total_cmp(&b.0));
            let Some((distance, face)) = most.filter(|(distance, _)| *distance > tolerance) else { return false };
            if farthest[face].is_none_or(|(known, _)| known < distance) {
                farthest[face] = Some((distance, *number));
            }
            true
        });
        if outside.is_empty() {
            return Some(corners);
        }
        if planes.len() > MOST_FACES || chosen.len() == known {
            chosen.extend(outside);
            chosen.sort_unstable();
            chosen.dedup();
            let some: Vec<Vector> = chosen.into_iter().map(|number| points[number]).collect();
            return if some.len() <= MOST_AT_ONCE { formed(&some) } else { Some(some) };
        }
        known = chosen.len();
        chosen.extend(farthest.into_iter().flatten().map(|(_, number)| number));
    }
}

/// Points of which the library forms the hull at once.
const MOST_AT_ONCE: usize = 2000;
/// The hull of a few points that the others are looked for in has about so many faces.
const MOST_FACES: usize = 800;
/// A hull whose nearest face is so near to its middle, relative to its size, is flat.
const FLAT: f64 = 2e-6;
/// How far a vertex may be outside of the hull, relative to its size.
const HULL_TOLERANCE: f64 = 1e-6;
/// See [`Convex::around`].
const MOST_POINTS: usize = 20_000;
/// See [`Convex::around`].
const MOST_CORNERS: usize = 200;
/// What rounding makes of a separating distance, relative.
const ROUNDING: f64 = 1e-9;

impl Convex {
    /// A solid that is not a mesh, and the pose of the library's form of it, whose cylinders stand along y; `None`
    /// where a mesh has no vertex.
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

    /// What contains all points for certain: their hull and a little more, since its corners may be off by rounding; of
    /// so many points that their hull may take longer than what it saves, the box around them. `None` where there is
    /// none.
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

    /// The distance of another convex solid at a pose, where it is below `limit`, else a value not below that, zero
    /// where they touch; and the direction from one to the other.
    pub fn distance(&self, pose: &ParryPose, other: &Self, limit: f64) -> (f64, Option<Vector>) {
        let around = self.radius + other.radius;
        let (distance, axis) = core_distance(self.core(), pose, other.core(), limit + around);
        ((distance - around).max(0.0), axis)
    }

    /// How far away another convex solid at a pose is, and the nearest points of the two cores in this one's frame;
    /// `None` where it is not below `limit`, or they touch.
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

/// The nearest points of two cores, the second at a pose in the frame of the first, in that frame; `None` where they
/// are not nearer than `limit`, or touch.
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

/// The distance of two cores, the second at a pose in the frame of the first, where it is below `limit`; else a value
/// not below that.
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

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Points in a ball or on it, as scans and finely meshed parts have them: with the square of their number it would
    /// take an hour.
    #[test]
    fn the_hull_of_very_many_points_is_theirs() {
        let mut random = ChaCha8Rng::seed_from_u64(30);
        let mut any = || Vector::from_array([0; 3].map(|_| random.random_range(-1.0..1.0)));
        let on = |point: Vector| point.normalize() * Vector::new(0.3, 0.2, 0.5);
        let sphere: Vec<Vector> = (0..200_000).map(|_| on(any())).collect();
        let ball: Vec<Vector> = sphere.iter().map(|point| *point * libm::cbrt(any().x.abs())).collect();
        let cube: Vec<Vector> = (0..200_000).map(|_| any() / any().abs().max_element()).collect();
        let block: Vec<Vector> =
            cube.iter().map(|point| point.clamp(Vector::splat(-0.4), Vector::splat(0.4))).collect();
        for (points, most) in [(sphere, 200_000), (ball, 20_000), (block, 2000)] {
            let found = corners(points.clone());
            assert!(found.len() <= most, "{}", found.len());
            let [hull, all] = [found, points].map(|points| Hull { points });
            for _ in 0..30 {
                let direction = any().normalize();
                let off = (all.local_support_point(direction) - hull.local_support_point(direction)).dot(direction);
                assert!((0.0..1e-6).contains(&off), "{off}");
            }
        }
    }

    #[test]
    fn flat_points_all_count() {
        let plate: Vec<Vector> = (0..3000).map(|k| Vector::new(f64::from(k % 60), f64::from(k / 60), 1.0)).collect();
        let hull = Hull { points: corners(plate) };
        assert_eq!(hull.local_support_point(Vector::new(1.0, 2.0, 0.0)), Vector::new(59.0, 49.0, 1.0));
    }
}
