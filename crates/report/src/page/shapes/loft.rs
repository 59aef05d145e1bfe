//! Closed surfaces: bars with rounded ends whose cross section is a superellipse, and boxes.

use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Corners of a cross section.
const CORNERS: usize = 24;

/// Closed surfaces under construction, lengths in m.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Solid {
    /// Corners.
    pub positions: Vec<[f32; 3]>,
    /// Corners of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// How the cross section of a bar looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Section {
    /// Exponent of the superellipse: 2 is round, larger is squarer.
    pub power: f64,
    /// Size across over size along `up`.
    pub flat: f64,
    /// Where the first axis of the section points; any direction that is not along the bar.
    pub up: Vector3<f64>,
}

impl Section {
    /// A circle.
    pub fn round() -> Self {
        Self::squarish(2.0)
    }

    /// A superellipse of this exponent.
    pub fn squarish(power: f64) -> Self {
        Self { power, flat: 1.0, up: Vector3::zeros() }
    }

    /// The same with its first axis along `up`, and narrower across by a factor.
    pub fn flattened(self, flat: f64, up: Vector3<f64>) -> Self {
        Self { flat, up, ..self }
    }
}

impl Solid {
    /// Adds a bar from one point to another: radii at its ends, how far it goes beyond them, and the width of the
    /// bevel.
    pub fn bar(&mut self, ends: [Vector3<f64>; 2], radii: [f64; 2], beyond: [f64; 2], bevel: f64, section: Section) {
        let length = (ends[1] - ends[0]).norm();
        let bevel = bevel.min((length + beyond[0] + beyond[1]) / 3.0).min(radii[0].min(radii[1]) / 2.0);
        let (start, end) = (-beyond[0], length + beyond[1]);
        let profile =
            [(start, radii[0] - bevel), (start + bevel, radii[0]), (end - bevel, radii[1]), (end, radii[1] - bevel)];
        self.loft(ends, &profile, section);
    }

    /// Adds the body whose cross section at each distance from the first point has the radius beside it, closed by flat
    /// ends; nothing where the two points are one.
    pub fn loft(&mut self, ends: [Vector3<f64>; 2], profile: &[(f64, f64)], section: Section) {
        let [from, to] = ends;
        let Some(along) = (to - from).try_normalize(1e-9) else { return };
        let first = across(&along, &section.up);
        let second = along.cross(&first);
        let base = self.positions.len() as u32;
        for &(distance, radius) in profile {
            let centre = from + along * distance;
            for corner in 0..CORNERS {
                let (sine, cosine) = libm::sincos(TAU * corner as f64 / CORNERS as f64);
                let x = superellipse(cosine, section.power) * radius;
                let y = superellipse(sine, section.power) * radius * section.flat;
                self.push(centre + first * x + second * y);
            }
        }
        let count = CORNERS as u32;
        let corner = |ring: u32, corner: u32| base + ring * count + corner % count;
        for ring in 1..profile.len() as u32 {
            for k in 0..count {
                let [a, b] = [corner(ring - 1, k), corner(ring - 1, k + 1)];
                let [c, d] = [corner(ring, k), corner(ring, k + 1)];
                self.triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
        let Some(last) = (profile.len() as u32).checked_sub(1) else { return };
        let ends = [profile[0].0, profile[last as usize].0].map(|distance| {
            self.push(from + along * distance);
            self.positions.len() as u32 - 1
        });
        for k in 0..count {
            self.triangles.push([ends[0], corner(0, k + 1), corner(0, k)]);
            self.triangles.push([ends[1], corner(last, k), corner(last, k + 1)]);
        }
    }

    /// Adds a box with its faces along the axes, between two opposite corners.
    pub fn cuboid(&mut self, low: Vector3<f64>, high: Vector3<f64>) {
        let base = self.positions.len() as u32;
        for corner in 0..8_usize {
            let side = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
            self.push(Vector3::new(side(0), side(1), side(2)));
        }
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
            .map(|face: [u32; 4]| face.map(|k| base + k));
        self.triangles.extend(faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]));
    }

    fn push(&mut self, point: Vector3<f64>) {
        self.positions.push([point.x as f32, point.y as f32, point.z as f32]);
    }
}

/// A unit vector normal to `along`: as near to `up` as can be, or to an axis where `up` does not say.
fn across(along: &Vector3<f64>, up: &Vector3<f64>) -> Vector3<f64> {
    let axis = if along.z.abs() < 0.9 { Vector3::z() } else { Vector3::x() };
    let normal = |direction: &Vector3<f64>| (direction - along * along.dot(direction)).try_normalize(1e-6);
    normal(up).or_else(|| normal(&axis)).unwrap_or(axis)
}

/// A coordinate of the superellipse from that of the circle: on an axis exactly.
fn superellipse(circle: f64, power: f64) -> f64 {
    if circle.abs() < 1e-12 { 0.0 } else { libm::pow(circle.abs(), 2.0 / power) * circle.signum() }
}
