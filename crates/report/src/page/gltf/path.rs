//! The tool path as tubes, coloured by the score at each point.

use super::super::shapes::Shaded;
use super::document::{linear, single};
use super::motion::{Motion, Stop};
use crate::picture::of_deflection;
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Corners of the cross section.
const CORNERS: usize = 6;
/// Radius of the tubes. m
const RADIUS: f64 = 0.008;

/// The tubes and the linear colour of each of their corners.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Tubes {
    pub mesh: Shaded,
    pub colors: Vec<[f32; 3]>,
}

/// One tube for each segment, in the workpiece frame.
pub(super) fn tubes(motion: &Motion) -> Tubes {
    let mut tubes = Tubes::default();
    for segment in motion.shown().chunk_by(|a, b| a.segment == b.segment) {
        tubes.add(segment);
    }
    tubes
}

impl Tubes {
    fn add(&mut self, stops: &[Stop]) {
        // Points in the same place have no direction between them.
        let mut chain: Vec<&Stop> = Vec::new();
        for stop in stops {
            if chain.last().is_none_or(|last| (last.position - stop.position).norm() > 1e-6) {
                chain.push(stop);
            }
        }
        if chain.len() < 2 {
            return;
        }
        let base = self.mesh.positions.len() as u32;
        let direction = |k: usize| (chain[k + 1].position - chain[k].position).normalize();
        let mut across = normal_to(&direction(0));
        for (k, stop) in chain.iter().enumerate() {
            let [before, after] = [k.saturating_sub(1), k.min(chain.len() - 2)].map(direction);
            let along = (before + after).try_normalize(1e-6).unwrap_or(after);
            // The section is carried along without twist.
            across = (across - along * along.dot(&across)).try_normalize(1e-6).unwrap_or_else(|| normal_to(&along));
            let second = along.cross(&across);
            let color = of_deflection(stop.score).map(linear);
            for corner in 0..CORNERS {
                let (sine, cosine) = libm::sincos(TAU * corner as f64 / CORNERS as f64);
                let outward = across * cosine + second * sine;
                self.push(stop.position + outward * RADIUS, outward, color);
            }
        }
        let count = CORNERS as u32;
        for ring in 1..chain.len() as u32 {
            for k in 0..count {
                let corner = |ring: u32, k: u32| base + ring * count + k % count;
                let [a, b, c, d] = [corner(ring - 1, k), corner(ring - 1, k + 1), corner(ring, k), corner(ring, k + 1)];
                self.mesh.triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
        let last = chain.len() - 1;
        self.cap(base, chain[0], -direction(0), true);
        self.cap(base + last as u32 * count, chain[last], direction(last - 1), false);
    }

    /// Closes the end whose ring begins at a corner.
    fn cap(&mut self, ring: u32, stop: &Stop, outward: Vector3<f64>, is_start: bool) {
        let color = of_deflection(stop.score).map(linear);
        let centre = self.mesh.positions.len() as u32;
        self.push(stop.position, outward, color);
        for k in 0..CORNERS {
            let corner = Vector3::from(self.mesh.positions[ring as usize + k].map(f64::from));
            self.push(corner, outward, color);
        }
        for k in 0..CORNERS as u32 {
            let [a, b] = [centre + 1 + k, centre + 1 + (k + 1) % CORNERS as u32];
            self.mesh.triangles.push(if is_start { [centre, b, a] } else { [centre, a, b] });
        }
    }

    fn push(&mut self, position: Vector3<f64>, normal: Vector3<f64>, color: [f32; 3]) {
        self.mesh.positions.push(single(&position));
        self.mesh.normals.push(single(&normal));
        self.colors.push(color);
    }
}

/// A unit vector normal to another.
fn normal_to(along: &Vector3<f64>) -> Vector3<f64> {
    let axis = if along.z.abs() < 0.9 { Vector3::z() } else { Vector3::x() };
    along.cross(&axis).normalize()
}
