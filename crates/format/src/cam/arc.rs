//! Arcs as points that are nowhere farther from the arc than the chord error.

use super::Resampling;
use super::refusals::{Measured, misses_end};
use nalgebra::{Rotation3, Unit, Vector3};
use std::f64::consts::{PI, TAU};

/// A start or end that is farther than this from its arc misses it: digits as CAM systems print them, in inches too. m
pub(super) const MISSED: f64 = 5e-5;
/// An arc that turns by less than this ends where it starts: a full circle. rad
const FULL: f64 = 1e-9;

/// An arc about an axis, counter-clockwise seen against it, with an even rise along the axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arc {
    pub start: Vector3<f64>,
    pub end: Vector3<f64>,
    pub centre: Vector3<f64>,
    pub axis: Unit<Vector3<f64>>,
    /// Full turns beside the part of a turn from start to end.
    pub more_turns: u32,
}

impl Arc {
    /// How far a point is from its axis. m
    pub fn distance(&self, point: Vector3<f64>) -> f64 {
        self.arm(point).norm()
    }

    /// The part of a turn from start to end, a whole one where they are one above the other. rad
    pub fn turn(&self) -> f64 {
        let [from, to] = [self.start, self.end].map(|point| self.arm(point));
        let turn = libm::atan2(self.axis.dot(&from.cross(&to)), from.dot(&to)).rem_euclid(TAU);
        if turn < FULL || TAU - turn < FULL { TAU } else { turn }
    }

    /// The directions in which it sets out and arrives, without what it rises.
    pub fn tangents(&self) -> [Vector3<f64>; 2] {
        [self.start, self.end].map(|point| self.axis.cross(&self.arm(point)).try_normalize(1e-12).unwrap_or_default())
    }

    /// From the axis to a point.
    fn arm(&self, point: Vector3<f64>) -> Vector3<f64> {
        let arm = point - self.centre;
        arm - self.axis.scale(arm.dot(&self.axis))
    }

    /// How far the end is from the plane of the start, along the axis. m
    pub fn rise(&self) -> f64 {
        (self.end - self.start).dot(&self.axis)
    }

    /// The points after the start up to the end, which is the last, so many that neither the chord error nor the step
    /// is passed; or what is wrong, and what is allowed, where the end is not as far from the axis as the start.
    pub fn points(&self, resampling: &Resampling) -> Result<Vec<Vector3<f64>>, Measured> {
        let (from, to) = (self.arm(self.start), self.arm(self.end));
        let radius = from.norm();
        ensure!(radius >= 1e-9 && (radius - to.norm()).abs() <= MISSED, misses_end([radius, to.norm()]));
        let turn = self.turn() + TAU * f64::from(self.more_turns);
        let part = 2.0 * libm::acos((1.0 - resampling.chord / radius).clamp(-1.0, 1.0));
        let part = part.min(resampling.step / radius).clamp(1e-4, PI / 4.0);
        let count = (turn / part).ceil().max(1.0) as usize;
        let rise = self.end - self.start - (to - from);
        let growth = to.norm() / radius - 1.0;
        let mut points: Vec<Vector3<f64>> = (1..count)
            .map(|k| {
                let share = k as f64 / count as f64;
                let arm = Rotation3::from_axis_angle(&self.axis, turn * share) * from * (1.0 + growth * share);
                self.start - from + arm + rise * share
            })
            .collect();
        points.push(self.end);
        Ok(points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::vector;

    const FINE: Resampling = Resampling { chord: 1e-5, step: 0.1 };

    fn arc(end: Vector3<f64>, axis: Vector3<f64>) -> Arc {
        let axis = Unit::new_normalize(axis);
        Arc { start: vector![0.01, 0.0, 0.0], end, centre: Vector3::zeros(), axis, more_turns: 0 }
    }

    #[test]
    fn points_are_on_the_arc_and_chords_within_the_error() {
        for (axis, quarters) in [(Vector3::z(), 1.0), (-Vector3::z(), 3.0)] {
            let arc = arc(vector![0.0, 0.01, 0.0], axis * 3.0);
            let points = arc.points(&FINE).unwrap();
            let all: Vec<_> = std::iter::once(arc.start).chain(points).collect();
            assert!(all.iter().all(|point| (point.norm() - 0.01).abs() < 1e-12));
            let length: f64 = all.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
            assert!((length / (0.01 * quarters * PI / 2.0) - 1.0).abs() < 1e-3, "{length}");
            assert!(all.windows(2).all(|pair| 0.01 - ((pair[0] + pair[1]) / 2.0).norm() <= 1.001e-5));
            assert_eq!(all.last(), Some(&arc.end));
        }
    }

    #[test]
    fn a_full_circle_a_helix_and_arcs_that_are_none() {
        let full = arc(vector![0.01, 0.0, 0.0], Vector3::z()).points(&FINE).unwrap();
        assert!(full.len() > 60 && full.iter().any(|point| point.x < -0.0099));
        let helix = arc(vector![0.0, 0.01, 0.004], Vector3::z()).points(&FINE).unwrap();
        let middle = helix[helix.len() / 2 - 1];
        assert!((middle.z - 0.002).abs() < 3e-4 && (middle.xy().norm() - 0.01).abs() < 1e-12);
        let (problem, _) = arc(vector![0.0, 0.02, 0.0], Vector3::z()).points(&FINE).unwrap_err();
        assert_eq!(problem, "the arc misses its end: radius 10.0000 mm at its start, 20.0000 mm there");
    }
}
