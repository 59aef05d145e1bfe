//! The mean cutting force of a cylindrical cutter by its coefficients, along a tool path.
//!
//! A tooth at immersion angle phi from the machined wall cuts a chip of thickness `h = f_z sin(phi)`; the force on it is
//! `F_t = a_p (K_t h + K_te)` against its motion and `F_r = a_p (K_r K_t h + K_re)` towards the cutter's axis (mechanistic
//! model with edge terms, after Tlusty and MacNeil 1975, the model that Caro 2013 names). [`CuttingModel::mean_force`]
//! integrates that over the engagement in closed form; [`CuttingModel::wrenches`] puts it along a tool path.

use super::engagement::{Arc, Integrals, immersion};
use super::rotation::Rotation;
use crate::task::{ToolPath, Wrench};
use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};

/// A side of the path, seen in the feed direction with the tool axis pointing up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Towards `axis x feed`.
    Left,
    /// Away from it.
    Right,
}

impl Side {
    /// +1 for left, -1 for right.
    fn sign(self) -> f64 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }
}

/// How the teeth meet the work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MillingDirection {
    /// Up milling: the chip starts at zero thickness.
    Conventional,
    /// Down milling: the chip ends at zero thickness.
    Climb,
}

/// A cutter, its cutting coefficients and the cut.
#[derive(Debug, Clone, PartialEq)]
pub struct CuttingModel {
    /// Cutter diameter. m
    pub diameter: f64,
    /// Number of teeth.
    pub teeth: u32,
    /// Sense of rotation.
    pub rotation: Rotation,
    /// Conventional or climb milling; with the rotation this says on which side the wall is.
    pub milling: MillingDirection,
    /// Width of cut a_e. m
    pub radial_depth: f64,
    /// Depth of cut a_p. m
    pub axial_depth: f64,
    /// Feed per tooth f_z. m
    pub feed_per_tooth: f64,
    /// Tangential cutting pressure K_t. Pa
    pub tangential_pressure: f64,
    /// Ratio K_r of radial to tangential cutting force.
    pub radial_ratio: f64,
    /// Tangential edge force K_te. N/m
    pub tangential_edge: f64,
    /// Radial edge force K_re. N/m
    pub radial_edge: f64,
    /// Turns of the path to this side run into a wall: over the last radius + a_e before the turn the width of cut grows
    /// linearly from a_e to a full slot. `None`: the width of cut never changes.
    pub concave_corners: Option<Side>,
}

/// A turn of the path by less than this is no corner. rad
const CORNER: f64 = 5.0 * PI / 180.0;

impl CuttingModel {
    /// The side of the path on which the machined wall stands.
    pub fn wall(&self) -> Side {
        match (self.rotation, self.milling) {
            (Rotation::Clockwise, MillingDirection::Conventional)
            | (Rotation::Counterclockwise, MillingDirection::Climb) => Side::Left,
            (Rotation::Clockwise, MillingDirection::Climb)
            | (Rotation::Counterclockwise, MillingDirection::Conventional) => Side::Right,
        }
    }

    /// Immersion angle of a width of cut, from the wall: 0 to pi. rad
    pub fn immersion(&self, radial_depth: f64) -> f64 {
        immersion(radial_depth, self.diameter)
    }

    /// Mean force on the tool over one turn for a width of cut (m), along feed, left of the feed, and tool axis. N
    pub fn mean_force(&self, radial_depth: f64) -> Vector3<f64> {
        // From the wall, in the sense of rotation or against it.
        let turn = Integrals::over(Arc { entry: 0.0, exit: self.immersion(radial_depth) });
        let chip_t = self.axial_depth * self.tangential_pressure * self.feed_per_tooth;
        let chip_r = chip_t * self.radial_ratio;
        let edge_t = self.axial_depth * self.tangential_edge;
        let edge_r = self.axial_depth * self.radial_edge;
        let against = match self.milling {
            MillingDirection::Conventional => -1.0,
            MillingDirection::Climb => 1.0,
        };
        let per_turn = f64::from(self.teeth) / TAU;
        let feed = against * (chip_t * turn.sine_cosine + edge_t * turn.cosine)
            - (chip_r * turn.sine_squared + edge_r * turn.sine);
        let out = against * (chip_t * turn.sine_squared + edge_t * turn.sine)
            + (chip_r * turn.sine_cosine + edge_r * turn.cosine);
        Vector3::new(feed, -self.wall().sign() * out, 0.0) * per_turn
    }

    /// The wrench at every point of a path, in the workpiece frame: a mean force, no moment.
    pub fn wrenches(&self, path: &ToolPath) -> Vec<Wrench> {
        let mut wrenches = Vec::with_capacity(path.points().len());
        for (number, range) in path.segments().iter().enumerate() {
            let points = &path.points()[range.clone()];
            let corner = self.ends_in_corner(path, number);
            let mut left = path.segment_length(number);
            for (index, point) in points.iter().enumerate() {
                if index > 0 {
                    left -= (point.position - points[index - 1].position).norm();
                }
                let depth = if corner { self.depth_before_corner(left) } else { self.radial_depth };
                let force = point.workpiece_from_point() * self.mean_force(depth);
                wrenches.push(Wrench { force, moment: Vector3::zeros() });
            }
        }
        wrenches
    }

    /// Width of cut at a distance (m) before a concave corner. m
    fn depth_before_corner(&self, distance: f64) -> f64 {
        let reach = self.diameter / 2.0 + self.radial_depth;
        let share = (1.0 - distance / reach).clamp(0.0, 1.0);
        self.radial_depth + (self.diameter - self.radial_depth) * share
    }

    /// Whether the path goes on from the end of a segment with a turn into a wall.
    fn ends_in_corner(&self, path: &ToolPath, segment: usize) -> bool {
        let (Some(side), Some(next)) = (self.concave_corners, path.segments().get(segment + 1)) else {
            return false;
        };
        let (end, start) = (&path.points()[next.start - 1], &path.points()[next.start]);
        let apart = (end.position - start.position).norm();
        let turn = libm::atan2(end.axis.dot(&end.feed.cross(&start.feed)), end.feed.dot(&start.feed));
        apart < self.diameter / 2.0 && turn * side.sign() > CORNER
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The cut behind `tasks/five-segments.csv`.
    fn five_segments() -> CuttingModel {
        CuttingModel {
            diameter: 0.016,
            teeth: 4,
            rotation: Rotation::Clockwise,
            milling: MillingDirection::Conventional,
            radial_depth: 0.002,
            axial_depth: 0.005,
            feed_per_tooth: 5e-5,
            tangential_pressure: 800e6,
            radial_ratio: 0.4,
            tangential_edge: 20e3,
            radial_edge: 20e3,
            concave_corners: Some(Side::Left),
        }
    }

    #[test]
    fn reproduces_the_shipped_task_to_a_millinewton() {
        let task = crate::task::testing::five_segments();
        let ours = five_segments().wrenches(task.path());
        let theirs = task.wrenches();
        assert_eq!(ours.len(), 105);
        for (index, (a, b)) in ours.iter().zip(theirs).enumerate() {
            assert!((a.force - b.force).abs().max() < 1e-3, "point {index}: {} {}", a.force, b.force);
        }
    }

    proptest! {
        #[test]
        fn closed_form_agrees_with_summing_over_tooth_positions(
            depth in 0.0001..0.016_f64, clockwise in any::<bool>(), climb in any::<bool>()
        ) {
            let model = CuttingModel {
                rotation: if clockwise { Rotation::Clockwise } else { Rotation::Counterclockwise },
                milling: if climb { MillingDirection::Climb } else { MillingDirection::Conventional },
                ..five_segments()
            };
            // A tooth at a compass angle, turning; the wall stands on one side, the work reaches `depth` from it.
            let radius = model.diameter / 2.0;
            let wall = model.wall().sign();
            let spin = if clockwise { -1.0 } else { 1.0 };
            let steps = 200_000;
            let mut sum = Vector3::zeros();
            for k in 0..steps {
                let angle = (f64::from(k) + 0.5) / f64::from(steps) * TAU;
                let outward = Vector3::new(libm::cos(angle), libm::sin(angle), 0.0);
                let from_wall = radius - outward.y * wall * radius;
                if outward.x <= 0.0 || from_wall > depth {
                    continue;
                }
                let motion = Vector3::new(-outward.y, outward.x, 0.0) * spin;
                let h = model.feed_per_tooth * outward.x;
                let ft = model.axial_depth * (model.tangential_pressure * h + model.tangential_edge);
                let fr = model.axial_depth * (model.radial_ratio * model.tangential_pressure * h + model.radial_edge);
                sum -= (motion * ft + outward * fr) * f64::from(model.teeth) / f64::from(steps);
            }
            let closed = model.mean_force(depth);
            prop_assert!((closed - sum).norm() < 0.05, "{} {}", closed, sum);
        }
    }
}
