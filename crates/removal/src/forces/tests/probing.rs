//! The mean force by probing the surface of the cutter, element by element: which are in the stock and were in no
//! cutter before. It knows nothing of lines through the stock and of moves.

use super::*;
use std::f64::consts::{FRAC_PI_2, TAU};
use stead_model::task::Wrench;

/// The tool at a place of the path.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// Tool centre point. m
    pub position: Vector3<f64>,
    /// Tool axis.
    pub axis: Vector3<f64>,
}

/// A cut without an end, by the tool over the length of path (m).
pub(super) struct Probing<'p> {
    pub mill: &'p EndMill,
    pub at: &'p dyn Fn(f64) -> Place,
    /// The tool in the cut before.
    pub before: &'p dyn Fn(f64) -> Place,
    /// Whether a place is in the stock before any cut.
    pub is_stock: &'p dyn Fn(&Vector3<f64>) -> bool,
    /// Length of the edge from the tip that is probed. m
    pub edge: f64,
    pub feed_per_turn: f64,
}

/// Elements along the edge and around the axis.
const ELEMENTS: [usize; 2] = [150, 1800];
/// Stamps of the cut before, and how far apart. m
const STAMPS: i32 = 500;
const APART: f64 = 4e-5;

impl Probing<'_> {
    /// The load at a length of path (m), and the removed area (m2).
    pub fn load(&self, along: f64) -> (Wrench, f64) {
        let here = (self.at)(along);
        let step = 1e-5;
        let (past, next) = ((self.at)(along - step), (self.at)(along + step));
        let ahead = (next.position - past.position) / (2.0 * step);
        let spin = here.axis.cross(&((next.axis - past.axis) / (2.0 * step)));
        let stamps: Vec<Place> = (-STAMPS..=STAMPS).map(|k| (self.before)(along + f64::from(k) * APART)).collect();
        let k = self.mill.cutter.coefficients();
        let teeth = self.mill.cutter.teeth().len() as f64;
        let radius = self.mill.cutter.radius();
        let is_ball = self.mill.corner_radius > 0.0;
        let side = here.axis.cross(&Vector3::new(0.3, 0.4, -0.8)).normalize();
        let other = here.axis.cross(&side);
        let [slices, angles] = ELEMENTS;
        let (dl, dphi) = (self.edge / slices as f64, TAU / angles as f64);
        let mut sum = Wrench::default();
        let mut removed = 0.0;
        for slice in 0..slices {
            let l = (slice as f64 + 0.5) * dl;
            let (r, height, [radial, axial]) = if is_ball {
                assert!(self.edge <= radius * FRAC_PI_2 + 1e-9);
                let (s, c) = libm::sincos(l / radius);
                (radius * s, radius * (1.0 - c), [s, -c])
            } else {
                (radius, l, [1.0, 0.0])
            };
            for angle in 0..angles {
                let (s, c) = libm::sincos((angle as f64 + 0.5) * dphi);
                let outward = side * c + other * s;
                let n = outward * radial + here.axis * axial;
                let y = outward * r + here.axis * height;
                let speed = n.dot(&(ahead + spin.cross(&y)));
                let point = here.position + y;
                if speed <= 0.0 || !(self.is_stock)(&point) || stamps.iter().any(|stamp| self.covers(stamp, &point)) {
                    continue;
                }
                let t = outward.cross(&here.axis);
                let up = t.cross(&n);
                let chip = (n * -k.radial - t * k.tangential + up * k.axial) * (self.feed_per_turn * speed);
                let edge = (n * -k.radial_edge - t * k.tangential_edge) * teeth;
                let force = (chip + edge) * (dl * dphi / TAU);
                sum.force += force;
                sum.moment += y.cross(&force);
                removed += speed * r * dl * dphi;
            }
        }
        (sum, removed)
    }

    /// Whether the cutter at a place covers a point.
    fn covers(&self, place: &Place, point: &Vector3<f64>) -> bool {
        let y = point - place.position;
        let height = y.dot(&place.axis);
        let square = y.norm_squared() - height * height;
        let (radius, corner) = (self.mill.cutter.radius(), self.mill.corner_radius);
        if height < corner {
            let below = height - corner;
            square + below * below < corner * corner
        } else {
            height > 0.0 && square < radius * radius
        }
    }
}
