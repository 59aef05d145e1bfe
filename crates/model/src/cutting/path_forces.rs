//! Mean cutting forces along a tool path, with the width of cut that grows before a concave corner.

use super::cut::{Cut, Side};
use super::cutter::Cutter;
use super::engagement::Engagement;
use super::force::CuttingForce;
use crate::task::{ToolPath, Wrench};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// A cutter and its cut along a tool path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathForces {
    /// The cutter.
    pub cutter: Cutter,
    /// The cut.
    pub cut: Cut,
    /// Feed per tooth f_z. m
    pub feed_per_tooth: f64,
    /// Turns of the path to this side run into a wall: over the last radius + a_e before the turn the width of cut
    /// grows linearly from a_e to a full slot. `None`: the width of cut never changes.
    pub concave_corners: Option<Side>,
}

/// A turn of the path by less than this is no corner. rad
const CORNER: f64 = 5.0 * PI / 180.0;

impl PathForces {
    /// Mean force on the tool over one turn for a width of cut (m), along feed, left of the feed, and tool axis. N
    pub fn mean_force(&self, radial_depth: f64) -> Vector3<f64> {
        let Self { cutter, cut, feed_per_tooth, .. } = self;
        let force = CuttingForce { cutter, axial_depth: cut.axial_depth, feed_per_tooth: *feed_per_tooth };
        force.mean_wrench(&Engagement::of_cut(cut.direction, radial_depth, cutter.diameter())).force
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
                let depth = if corner { self.depth_before_corner(left) } else { self.cut.radial_depth };
                let force = point.workpiece_from_point() * self.mean_force(depth);
                wrenches.push(Wrench { force, moment: Vector3::zeros() });
            }
        }
        wrenches
    }

    /// Width of cut at a distance (m) before a concave corner. m
    fn depth_before_corner(&self, distance: f64) -> f64 {
        let reach = self.cutter.radius() + self.cut.radial_depth;
        let share = (1.0 - distance / reach).clamp(0.0, 1.0);
        self.cut.radial_depth + (self.cutter.diameter() - self.cut.radial_depth) * share
    }

    /// Whether the path goes on from the end of a segment with a turn into a wall.
    fn ends_in_corner(&self, path: &ToolPath, segment: usize) -> bool {
        let (Some(side), Some(next)) = (self.concave_corners, path.segments().get(segment + 1)) else {
            return false;
        };
        let (end, start) = (&path.points()[next.start - 1], &path.points()[next.start]);
        let apart = (end.position - start.position).norm();
        let turn = libm::atan2(end.axis.dot(&end.feed.cross(&start.feed)), end.feed.dot(&start.feed));
        apart < self.cutter.radius() && turn * side.sign() > CORNER
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Coefficients, MillingDirection, Rotation};
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    const COEFFICIENTS: Coefficients =
        Coefficients { tangential: 800e6, radial: 320e6, axial: 0.0, tangential_edge: 20e3, radial_edge: 20e3 };

    /// The cut behind `tasks/five-segments.csv`, with another rotation and direction.
    fn five_segments(rotation: Rotation, direction: MillingDirection) -> PathForces {
        PathForces {
            cutter: Cutter::even(4, 0.008, 0.0, rotation, COEFFICIENTS).unwrap(),
            cut: Cut { direction, radial_depth: 0.002, axial_depth: 0.005 },
            feed_per_tooth: 5e-5,
            concave_corners: Some(Side::Left),
        }
    }

    #[test]
    fn reproduces_the_shipped_task_to_a_millinewton() {
        let task = crate::task::testing::five_segments();
        let ours = five_segments(Rotation::Clockwise, MillingDirection::Conventional).wrenches(task.path());
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
            let rotation = if clockwise { Rotation::Clockwise } else { Rotation::Counterclockwise };
            let direction = if climb { MillingDirection::Climb } else { MillingDirection::Conventional };
            let model = five_segments(rotation, direction);
            // A tooth at a compass angle, turning; the wall stands on one side, the work reaches `depth` from it.
            let radius = 0.008;
            let wall = direction.wall(rotation).sign();
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
                let ft = model.cut.axial_depth * (COEFFICIENTS.tangential * h + COEFFICIENTS.tangential_edge);
                let fr = model.cut.axial_depth * (COEFFICIENTS.radial * h + COEFFICIENTS.radial_edge);
                sum -= (motion * ft + outward * fr) * 4.0 / f64::from(steps);
            }
            let closed = model.mean_force(depth);
            prop_assert!((closed - sum).norm() < 0.05, "{} {}", closed, sum);
        }
    }
}
