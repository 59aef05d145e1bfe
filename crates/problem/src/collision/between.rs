//! What is wrong between two path points, where the tool moves straight and turns evenly, as a robot program does it.
//!
//! Where points are close to each other that is as good as a straight move of the joints; else it is cut into such
//! moves.

use super::Fault;
use crate::evaluate::placed_task::PlacedTask;
use crate::straight_move::StraightMove;
use stead_cell::{PairKind, Poses, Proximity, Scene};
use stead_model::robot::Posture;

impl PlacedTask<'_> {
    /// What is wrong with the move to a path point from the one before, in a posture, from joint angles to others
    /// (rad): the arm cannot follow it, or a pair comes too near on the way. Where there is a scene, the poses at the
    /// ends are given, and nothing hits at the first, to which `known` has gone; that the end itself hits counts at its
    /// point.
    pub fn move_fault(
        self,
        point: usize,
        posture: Posture,
        joints: [[f64; 6]; 2],
        scene: Option<(&Scene, [&Poses; 2])>,
        known: &mut Proximity,
    ) -> Option<Fault> {
        let Self { problem, placement } = self;
        let straight = StraightMove::new(problem, placement, point, posture, joints);
        let Some((scene, [start, end])) = scene else {
            return straight.follow(|_, _| None::<()>).err().map(Fault::Unfollowed);
        };
        let mut last = (joints[0], *start);
        let followed = straight.follow(|share, joints| {
            let is_end = share >= 1.0;
            let poses = match is_end {
                true => *end,
                false => {
                    problem.poses_at(scene, &problem.positions_between([point - 1, point], share), placement, joints)
                }
            };
            // Between points nine tenths of the distances are kept, as on any motion: what hits at the end counts at
            // its point.
            if scene.next_hit(known, &poses, &PairKind::OF_STATES).is_some() && is_end {
                return Some(None);
            }
            if let Some(hit) = scene.motion_to(known, (&last.0, &last.1), (joints, &poses)) {
                return Some(Some(Fault::Hit(hit.pair)));
            }
            last = (*joints, poses);
            None
        });
        match followed {
            Ok(found) => found.flatten(),
            Err(end) => Some(Fault::Unfollowed(end)),
        }
    }

    /// Where the arm and all else is a share of the straight way of the joints (rad), the external axes moving evenly
    /// from where they stand at one path point to where they stand at another.
    pub fn by_joints(self, scene: &Scene, ends: [(&[f64; 6], usize); 2], share: f64) -> ([f64; 6], Poses) {
        let [from, to] = ends.map(|(joints, _)| joints);
        let joints: [f64; 6] = std::array::from_fn(|j| from[j] + (to[j] - from[j]) * share);
        let positions = self.problem.positions_between(ends.map(|(_, point)| point), share);
        (joints, self.problem.poses_at(scene, &positions, self.placement, &joints))
    }
}
