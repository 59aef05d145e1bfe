//! Whether the moves between segments keep free of what stands around, by the joint angles that the program has.

use super::expected::Expected;
use super::geometry::of_rows;
use super::written::{Goal, Written};
use super::{MoveHit, MovePlace, UnfollowedMove};
use crate::transfer_paths::TransferPaths;
use stead_model::robot::Robot;
use stead_planning::transfer_path::Space;
use stead_problem::problem::{Placement, Problem};

/// The moves that hit: those of no free way, and joint moves of ways, straight between the angles of the program.
pub(super) fn hits(
    problem: &Problem,
    placement: &Placement,
    transfer_paths: &TransferPaths,
    written: &[Written],
    expected: &[Expected],
) -> Vec<MoveHit> {
    let Some(space) = Space::among_shapes(problem, placement) else { return Vec::new() };
    let joints = |place: usize| joints_of(&problem.robot, &written[place], &expected[place]);
    let count = written.len().min(expected.len());
    let pair_at = |place: usize| {
        let wanted = &expected[place];
        let is_first = place.checked_sub(1).is_none_or(|before| expected[before].segment != wanted.segment);
        let is_way = transfer_paths.free_to(wanted.segment - 1).is_some();
        if is_first && !is_way {
            return transfer_paths.hit_before(wanted.segment - 1).cloned();
        }
        if is_way && wanted.is_joint {
            let before = place.checked_sub(1)?;
            return space.hit((&joints(before), expected[before].point), (&joints(place), wanted.point));
        }
        transfer_paths.ends_hit[1].clone().filter(|_| place + 1 == expected.len())
    };
    let hit = |place: usize| {
        let names = pair_at(place)?;
        Some(MoveHit {
            at: MovePlace::of(&written[place], &expected[place]),
            pair: format!("{} and {}", names[0], names[1]),
        })
    };
    (0..count).filter_map(hit).collect()
}

/// The lines between path points that the arm cannot follow.
pub(super) fn unfollowed(
    transfer_paths: &TransferPaths,
    written: &[Written],
    expected: &[Expected],
) -> Vec<UnfollowedMove> {
    let lines = written.iter().zip(expected).filter(|(_, wanted)| !wanted.is_joint && !wanted.is_retracted);
    let of_line = |(one, wanted): (&Written, &Expected)| {
        let end = transfer_paths.unfollowed_to(wanted.point)?.clone();
        Some(UnfollowedMove { at: MovePlace::of(one, wanted), end })
    };
    lines.filter_map(of_line).collect()
}

/// The angles of the rows after a move: those of the program where it has any. rad
fn joints_of(robot: &Robot, written: &Written, expected: &Expected) -> [f64; 6] {
    match (&written.goal, robot.controller()) {
        (Goal::Angles(angles) | Goal::Row { angles: Some(angles), is_joint: true, .. }, Some(controller)) => {
            of_rows(robot.joints(), controller, angles)
        }
        _ => expected.near,
    }
}
