//! Solids, and how far they are apart, by the plain distances of parry3d.

use crate::values::{Answer, list, number, section, text};
use nalgebra::{Isometry3, Vector3};
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::query;
use parry3d_f64::shape::{ConvexPolyhedron, Cuboid, Cylinder, Segment, SharedShape, TriMesh};
use std::path::Path;
use toml::Table;

/// A form in its own frame: all that is within a radius of a core.
#[derive(Clone)]
pub(crate) struct Solid {
    core: SharedShape,
    /// From the core, which parry has along y where we have z, to the form.
    turned: Isometry3<f64>,
    radius: f64,
    /// The triangles of a closed mesh.
    closed: Vec<[Vector3<f64>; 3]>,
    /// A point of it.
    inside: Vector3<f64>,
    /// The box about it in its own frame.
    pub extent: [Vector3<f64>; 2],
}

fn to_parry(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

fn parry_pose(pose: &Isometry3<f64>) -> Pose {
    let q = pose.rotation.quaternion();
    Pose::from_parts(to_parry(&pose.translation.vector), Rotation::from_xyzw(q.i, q.j, q.k, q.w))
}

impl Solid {
    fn new(core: SharedShape, radius: f64, half: Vector3<f64>) -> Self {
        let turned = Isometry3::identity();
        Self { core, turned, radius, closed: Vec::new(), inside: Vector3::zeros(), extent: [-half, half] }
    }

    pub(crate) fn cuboid(edges: &Vector3<f64>) -> Self {
        Self::new(SharedShape::new(Cuboid::new(to_parry(&(edges / 2.0)))), 0.0, edges / 2.0)
    }

    /// Along z.
    pub(crate) fn cylinder(radius: f64, length: f64) -> Self {
        let upright = Isometry3::rotation(Vector3::x() * std::f64::consts::FRAC_PI_2);
        let core = SharedShape::new(Cylinder::new(length / 2.0, radius));
        Self { turned: upright, ..Self::new(core, 0.0, Vector3::new(radius, radius, length / 2.0)) }
    }

    /// Along z, with half spheres on its ends.
    pub(crate) fn capsule(radius: f64, length: f64) -> Self {
        let half = length / 2.0;
        let core = SharedShape::new(Segment::new(Vector::new(0.0, 0.0, -half), Vector::new(0.0, 0.0, half)));
        Self::new(core, radius, Vector3::new(radius, radius, half + radius))
    }

    fn triangles(triangles: Vec<[Vector3<f64>; 3]>, is_hull: bool) -> Answer<Self> {
        let vertices: Vec<Vector3<f64>> = triangles.iter().flatten().copied().collect();
        let first = *vertices.first().ok_or("a mesh without triangles")?;
        let extent = vertices.iter().fold([first, first], |[low, high], v| [low.inf(v), high.sup(v)]);
        let points: Vec<Vector> = vertices.iter().map(to_parry).collect();
        let core = match is_hull {
            true => SharedShape::new(ConvexPolyhedron::from_convex_hull(&points).ok_or("no hull")?),
            false => {
                let corners = (0..triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
                SharedShape::new(TriMesh::new(points, corners).map_err(|error| format!("{error:?}"))?)
            }
        };
        let inside = if is_hull { (extent[0] + extent[1]) / 2.0 } else { first };
        let closed = if !is_hull && is_closed(&triangles) { triangles } else { Vec::new() };
        let turned = Isometry3::identity();
        Ok(Self { core, turned, radius: 0.0, closed, inside, extent })
    }

    /// What a table of shapes states, with mesh files beside `folder`.
    pub(crate) fn read(table: &Table, folder: &Path) -> Answer<Self> {
        if let Some(edges) = list(table, "box_mm") {
            return Ok(Self::cuboid(&(Vector3::from_column_slice(&edges) * 1e-3)));
        }
        let round = |key: &str| {
            let table = section(table, key)?;
            Some([number(table, "radius")? * 1e-3, number(table, "length")? * 1e-3])
        };
        if let Some([radius, length]) = round("cylinder_mm") {
            return Ok(Self::cylinder(radius, length));
        }
        if let Some([radius, length]) = round("capsule_mm") {
            return Ok(Self::capsule(radius, length));
        }
        let unit = if text(table, "unit") == Some("m") { 1.0 } else { 1e-3 };
        let (file, is_hull) = match (text(table, "hull"), text(table, "mesh")) {
            (Some(file), _) => (file, true),
            (None, Some(file)) => (file, false),
            (None, None) => return Err("a shape without a form".to_owned()),
        };
        let file = folder.join(file);
        let bytes = std::fs::read(&file).map_err(|error| format!("{}: {error}", file.display()))?;
        let is_obj = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj"));
        let mut triangles = if is_obj { read_obj(&bytes) } else { read_stl(&bytes) };
        triangles.iter_mut().flatten().for_each(|vertex| *vertex *= unit);
        Self::triangles(triangles, is_hull)
    }

    /// The radius of a sphere about the middle of the extent that contains it, and that middle.
    fn ball(&self) -> (Vector3<f64>, f64) {
        let [low, high] = self.extent;
        ((low + high) / 2.0, (high - low).norm() / 2.0)
    }

    /// Winding number of a closed mesh about a point: nothing outside.
    fn contains(&self, point: &Vector3<f64>) -> bool {
        let solid_angle = |[a, b, c]: &[Vector3<f64>; 3]| {
            let [a, b, c] = [a - point, b - point, c - point];
            let [x, y, z] = [a.norm(), b.norm(), c.norm()];
            let below = x * y * z + a.dot(&b) * z + b.dot(&c) * x + c.dot(&a) * y;
            2.0 * a.dot(&b.cross(&c)).atan2(below)
        };
        let sum: f64 = self.closed.iter().map(solid_angle).sum();
        (sum / (2.0 * std::f64::consts::TAU)).abs() > 0.5
    }

    /// At least so far apart.
    pub(crate) fn least_distance(&self, at: &Isometry3<f64>, other: &Self, other_at: &Isometry3<f64>) -> f64 {
        let ((a, mine), (b, theirs)) = (self.ball(), other.ball());
        (at * nalgebra::Point3::from(a) - other_at * nalgebra::Point3::from(b)).norm() - mine - theirs
    }

    /// Zero where they touch. m
    pub(crate) fn distance(&self, at: &Isometry3<f64>, other: &Self, other_at: &Isometry3<f64>) -> f64 {
        let [here, there] = [(at, self), (other_at, other)].map(|(pose, solid)| parry_pose(&(pose * solid.turned)));
        let between =
            query::distance(&here, &*self.core, &there, &*other.core).map_or(f64::NAN, |found| found.distance);
        let within = |mesh: &Self, mesh_at: &Isometry3<f64>, solid: &Self, solid_at: &Isometry3<f64>| {
            let point = mesh_at.inverse() * (solid_at * nalgebra::Point3::from(solid.inside));
            !mesh.closed.is_empty() && mesh.contains(&point.coords)
        };
        if within(self, at, other, other_at) || within(other, other_at, self, at) {
            return 0.0;
        }
        (between - self.radius - other.radius).max(0.0)
    }
}

/// Whether each edge is there as often in one direction as in the other.
fn is_closed(triangles: &[[Vector3<f64>; 3]]) -> bool {
    let size = triangles.iter().flatten().map(|v| v.amax()).fold(0.0, f64::max).max(1e-12);
    let key = |v: &Vector3<f64>| v.map(|x| (x / size * 1e6).round() as i64);
    let mut edges = std::collections::HashMap::new();
    for triangle in triangles {
        let [a, b, c] = [0, 1, 2].map(|k| key(&triangle[k]));
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((from.data.0, to.data.0)).or_insert(0) += 1;
            *edges.entry((to.data.0, from.data.0)).or_insert(0) -= 1;
        }
    }
    edges.values().all(|count| *count == 0)
}

fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

fn read_stl(bytes: &[u8]) -> Vec<[Vector3<f64>; 3]> {
    let count = bytes.get(80..84).map_or(0, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    let content = String::from_utf8_lossy(bytes);
    if bytes.len() == 84 + 50 * count && count > 0 {
        let number =
            |at: usize| f64::from(f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]));
        let vertex = |at: usize| Vector3::new(number(at), number(at + 4), number(at + 8));
        return (0..count).map(|k| [12, 24, 36].map(|offset| vertex(84 + 50 * k + offset))).collect();
    }
    let vertices: Vec<Vector3<f64>> = content
        .lines()
        .filter_map(|line| line.trim().strip_prefix("vertex").map(numbers))
        .filter(|v| v.len() == 3)
        .map(|v| Vector3::new(v[0], v[1], v[2]))
        .collect();
    vertices.chunks_exact(3).map(|v| [v[0], v[1], v[2]]).collect()
}

fn read_obj(bytes: &[u8]) -> Vec<[Vector3<f64>; 3]> {
    let content = String::from_utf8_lossy(bytes);
    let mut vertices: Vec<Vector3<f64>> = Vec::new();
    let mut triangles = Vec::new();
    for line in content.lines().map(str::trim) {
        if let Some(v) = line.strip_prefix("v ").map(numbers).filter(|v| v.len() >= 3) {
            vertices.push(Vector3::new(v[0], v[1], v[2]));
        } else if let Some(face) = line.strip_prefix("f ") {
            let corner = |word: &str| {
                let number: i64 = word.split('/').next()?.parse().ok()?;
                let index = if number < 0 { vertices.len() as i64 + number } else { number - 1 };
                vertices.get(usize::try_from(index).ok()?).copied()
            };
            let corners: Vec<Vector3<f64>> = face.split_whitespace().filter_map(corner).collect();
            triangles.extend((1..corners.len().saturating_sub(1)).map(|k| [corners[0], corners[k], corners[k + 1]]));
        }
    }
    triangles
}
