//! Boxes of placements, and where they put a path point.
//!
//! Turning the workpiece and joint 1 together about axis 1 changes nothing but theta_1, so a placement is three
//! numbers: radius and height of the workpiece origin, and the yaw less its azimuth.

use super::load::Load;
use super::number::VARIABLES;
use serde::Serialize;

/// A box of placements.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Region {
    /// Radius (m), height (m), yaw less azimuth (rad) of its middle.
    pub middle: [f64; 3],
    /// Half its widths.
    pub half: [f64; 3],
}

/// One path point in the workpiece frame, as seen along axis 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    /// Distance and direction from the workpiece origin. m, rad
    pub distance: f64,
    pub direction: f64,
    /// Height above the origin, along axis 1. m
    pub height: f64,
    /// Direction of the feed. rad
    pub feed: f64,
    /// What acts on it, and what is scored.
    pub load: Load,
}

/// Radius and azimuth of a path point over a box: value, slopes and what the slopes leave out.
#[derive(Debug, Clone, Copy)]
pub(super) struct PolarModel {
    pub r: f64,
    pub z: f64,
    /// Direction of the feed against the azimuth of the point. rad
    pub chi: f64,
    /// Slopes of r and chi by the radius and by the yaw of the box.
    pub slope_r: [f64; 2],
    pub slope_chi: [f64; 2],
    /// What the slopes leave out.
    pub remainder_r: f64,
    pub remainder_chi: f64,
    /// How far r, z and chi get from their values.
    pub reach: [f64; VARIABLES],
}

impl Region {
    /// The two halves along one of its three sides.
    pub fn split(&self, side: usize) -> [Self; 2] {
        [-0.5, 0.5].map(|sign| {
            let mut out = *self;
            out.half[side] *= 0.5;
            out.middle[side] += sign * self.half[side];
            out
        })
    }
}

impl Point {
    /// Where the point is, over all placements of a box; `None` where axis 1 may pass through the point.
    pub fn over(&self, region: &Region) -> Option<PolarModel> {
        let [radius, height, turn] = region.middle;
        let [a, b, g] = region.half;
        let angle = turn + self.direction;
        let (sine, cosine) = libm::sincos(angle);
        let (x, y) = (radius + self.distance * cosine, self.distance * sine);
        let r = libm::hypot(x, y);
        // Bounds over the box: x and y move with the radius, and along the circle about the workpiece origin.
        let moved = a + self.distance * g;
        let min_r = r - moved;
        if min_r <= 1e-3 {
            return None;
        }
        let (cos_azimuth, sin_azimuth) = (x / r, y / r);
        let turn_of_azimuth = 1.0 - radius * cos_azimuth / r;
        let slope_r = [cos_azimuth, -radius * sin_azimuth];
        let slope_chi = [sin_azimuth / r, radius * cos_azimuth / r];
        // Second derivatives, each bounded over the box by its middle value and how far that can move.
        let swing = (moved / min_r).min(2.0);
        let max_sine = (sin_azimuth.abs() + swing).min(1.0);
        let max_cosine = (cos_azimuth.abs() + swing).min(1.0);
        let max_turn =
            turn_of_azimuth.abs() + (a / min_r + (radius + a) * (moved / (min_r * min_r) + swing / min_r)).max(0.0);
        let far = radius + a;
        let r_rr = max_sine * max_sine / min_r;
        let r_rt = max_sine * max_turn;
        let r_tt = far * max_cosine * max_turn;
        let c_rr = 2.0 * max_sine * max_cosine / (min_r * min_r);
        let c_rt = max_cosine * max_turn / min_r + far * max_sine * max_sine / (min_r * min_r);
        let c_tt = far * (max_sine * max_turn / min_r + far * max_sine * max_cosine / (min_r * min_r));
        let remainder = |rr: f64, rt: f64, tt: f64| 0.5 * rr * a * a + rt * a * g + 0.5 * tt * g * g;
        let (remainder_r, remainder_chi) = (remainder(r_rr, r_rt, r_tt), remainder(c_rr, c_rt, c_tt));
        let linear = |slope: [f64; 2]| slope[0].abs() * a + slope[1].abs() * g;
        let reach = [(linear(slope_r) + remainder_r).min(moved), b, linear(slope_chi) + remainder_chi];
        Some(PolarModel {
            r,
            z: height + self.height,
            chi: turn + self.feed - libm::atan2(y, x),
            slope_r,
            slope_chi,
            remainder_r,
            remainder_chi,
            reach,
        })
    }
}
