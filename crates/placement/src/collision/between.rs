//! Collisions between two path points, where the tool moves straight and turns evenly, as a robot programme does it.
//!
//! Where points are close to each other that is as good as a straight move of the joints; else it is cut into such moves.

use crate::problem::{Placement, Problem};
use stead_cell::{Attachment, PairKind, Poses, Proximity, Scene};
use stead_model::robot::{Pose, Posture, angles::wrap};
use stead_numerics::rotation::{rotation_from_vector, rotation_vector};

/// Steps of joints 1 to 3, and of joints 4 to 6, over which a straight move of the joints leaves the straight line of the tool by less
/// than a tenth of a millimetre. rad
const STEPS: [f64; 2] = [0.03, 0.06];

impl Problem {
    /// A pair that comes too near on the move to a path point from the one before, in a posture. Both ends are given by joint angles (rad) and
    /// where all stands; nothing hits at the first, to which `known` has gone.
    pub(super) fn move_hit(
        &self,
        scene: &Scene,
        placement: &Placement,
        (point, posture): (usize, Posture),
        ends: [([f64; 6], Poses); 2],
        known: &mut Proximity,
    ) -> Option<usize> {
        let [(from, start), (to, end)] = &ends;
        let steps = (0..6).map(|j| (to[j] - from[j]).abs() / STEPS[j / 3]).fold(1.0, f64::max).ceil() as usize;
        let mut last = (*from, *start);
        for step in 1..=steps {
            let next = if step == steps {
                ends[1]
            } else {
                let share = step as f64 / steps as f64;
                self.on_the_way(scene, placement, (point, posture), [start, end], (share, &last.0))
                    .unwrap_or_else(|| self.by_joints(scene, placement, [(from, point - 1), (to, point)], share))
            };
            let hit = scene.next_hit(known, &next.1, &PairKind::OF_STATES);
            if let Some(pair) = hit {
                // That the end of the move hits is told of its point.
                return (step < steps).then_some(pair);
            }
            if let Some(hit) = scene.motion_to(known, (&last.0, &last.1), (&next.0, &next.1)) {
                return Some(hit.pair);
            }
            last = next;
        }
        None
    }

    /// The arm where the tool has gone a share of the straight way to a path point, near given joint angles (rad); `None` out of reach.
    fn on_the_way(
        &self,
        scene: &Scene,
        placement: &Placement,
        (point, posture): (usize, Posture),
        ends: [&Poses; 2],
        (share, near): (f64, &[f64; 6]),
    ) -> Option<([f64; 6], Poses)> {
        let flange_from_tool = self.spindle.flange_from_tool;
        let [a, b] = ends.map(|poses| {
            poses.of(Attachment::Workpiece).inverse().then(poses.of(Attachment::Flange)).then(&flange_from_tool)
        });
        let turn = rotation_vector(&(b.rotation * a.rotation.transpose())) * share;
        let workpiece_from_tool = Pose {
            rotation: rotation_from_vector(&turn) * a.rotation,
            translation: a.translation + (b.translation - a.translation) * share,
        };
        let positions = self.positions_between([point - 1, point], share);
        let part = self.turned(self.base_from_workpiece_at(&positions, placement));
        let flange = part.then(&workpiece_from_tool).then(&flange_from_tool.inverse());
        let found = self.robot.inverse(&flange, posture).ok()?;
        let joints: [f64; 6] = std::array::from_fn(|j| near[j] + wrap(found[j] - near[j]));
        Some((joints, self.poses_at(scene, &positions, placement, &joints)))
    }

    /// Where the arm and all else is a share of the straight way of the joints (rad), the external axes moving evenly from where they stand at
    /// one path point to where they stand at another.
    pub(crate) fn by_joints(
        &self,
        scene: &Scene,
        placement: &Placement,
        [from, to]: [(&[f64; 6], usize); 2],
        share: f64,
    ) -> ([f64; 6], Poses) {
        let joints: [f64; 6] = std::array::from_fn(|j| from.0[j] + (to.0[j] - from.0[j]) * share);
        let positions = self.positions_between([from.1, to.1], share);
        (joints, self.poses_at(scene, &positions, placement, &joints))
    }

    /// Positions of the external axes a share of the way from one path point to another. m or rad
    fn positions_between(&self, points: [usize; 2], share: f64) -> Vec<f64> {
        let [start, end] = points.map(|point| self.axis_positions(point));
        start.iter().zip(end).map(|(start, end)| start + (end - start) * share).collect()
    }
}
