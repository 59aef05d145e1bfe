//! Where arm and external axes are on a move between two segments, from place to place: for pictures of the move, and
//! for times of it.

use crate::transfer::part_durations;
use crate::transfer_path::{STRAIGHT_STEP, TransferPath};
use stead_model::robot::angles::nearest_turns;
use stead_model::robot::{Pose, Posture};
use stead_problem::problem::Problem;
use stead_problem::settings::TransferSettings;

/// A part of a move between segments that is driven from rest to rest, straight in joint space or along the tool axis.
#[derive(Debug, Clone, PartialEq)]
pub struct MovePart {
    /// Places at equal shares of it, at least two; from each to the next everything moves evenly.
    pub places: Vec<PlaceOnMove>,
    /// The share of the time of the whole move that it takes.
    pub time_share: f64,
}

/// Where everything is that moves.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaceOnMove {
    /// Joint angles. rad
    pub joints: [f64; 6],
    /// Positions of the external axes. m or rad
    pub axes: Vec<f64>,
}

/// The parts of a way from one path point to another, each with the posture there. Shares of the time are those of the
/// times of the parts, or of how far the joints turn where a speed is not known.
pub fn parts(
    problem: &Problem,
    settings: &TransferSettings,
    way: &TransferPath,
    ends: [(usize, Posture); 2],
) -> Vec<MovePart> {
    let [before, behind] = ends.map(|(point, _)| problem.axis_positions(point));
    let times = part_durations(problem, settings, &way.joints, way.axes_from, [before, behind]);
    let turned: Vec<f64> = way.joints.windows(2).map(|pair| largest_turn(&pair[0], &pair[1])).collect();
    let shares = times.map(|times| shares(&times)).unwrap_or_else(|| shares(&turned));
    let parts = way.joints.windows(2).zip(1..).zip(shares);
    let part = |((pair, place), time_share): ((&[[f64; 6]], usize), f64)| {
        let joints = match way.is_along_axis(place) {
            true => along_axis(problem, ends[usize::from(place > 1)].1, pair[0], pair[1]),
            false => vec![pair[0], pair[1]],
        };
        let [from, to] = match place.cmp(&way.axes_from) {
            std::cmp::Ordering::Less => [before, before],
            std::cmp::Ordering::Equal => [before, behind],
            std::cmp::Ordering::Greater => [behind, behind],
        };
        let steps = (joints.len() - 1) as f64;
        let place = |(step, joints): (usize, [f64; 6])| {
            let share = step as f64 / steps;
            PlaceOnMove { joints, axes: from.iter().zip(to).map(|(from, to)| from + (to - from) * share).collect() }
        };
        MovePart { places: joints.into_iter().enumerate().map(place).collect(), time_share }
    };
    parts.map(part).collect()
}

/// Parts of one; equal parts where all are zero.
fn shares(values: &[f64]) -> Vec<f64> {
    let sum: f64 = values.iter().sum();
    values.iter().map(|value| if sum > 0.0 { value / sum } else { 1.0 / values.len() as f64 }).collect()
}

fn largest_turn(from: &[f64; 6], to: &[f64; 6]) -> f64 {
    from.iter().zip(to).map(|(a, b)| (b - a).abs()).fold(0.0, f64::max)
}

/// Joint angles along the straight line of the flange between two configurations that hold the tool alike; those two
/// alone where the arm cannot follow it.
fn along_axis(problem: &Problem, posture: Posture, from: [f64; 6], to: [f64; 6]) -> Vec<[f64; 6]> {
    let [start, end] = [from, to].map(|joints| problem.robot.forward(&joints));
    let line = end.translation - start.translation;
    let steps = (line.norm() / STRAIGHT_STEP - 1e-6).ceil().max(1.0) as usize;
    let mut all = vec![from];
    let mut last = from;
    for step in 1..steps {
        let translation = start.translation + line * (step as f64 / steps as f64);
        let Ok(found) = problem.robot.inverse(&Pose { translation, ..start }, posture) else { return vec![from, to] };
        last = nearest_turns(&found, &last);
        all.push(last);
    }
    all.push(to);
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::redundancy::Planner;
    use crate::transfer_path::transfer_path;
    use std::sync::Arc;
    use stead_cell::testing::{kr270_shapes, scene_of};
    use stead_problem::sense::Sense;
    use stead_problem::testing::five_segments;

    /// Out of the cut and into it the tool stays on its axis to two hundredths of a millimetre between the places, and
    /// what is between is one straight joint move; each part ends where the next one begins.
    #[test]
    fn parts_follow_the_way() {
        let placement = stead_problem::problem::Placement::from([0.1, -1.9, -0.4, 1.0]);
        let mut problem = five_segments();
        let planner = Planner::new(&problem);
        let plans = planner.plan(&placement, Sense::Min, None, &mut planner.workspace()).unwrap();
        drop(planner);
        let spindle = kr270_shapes().into_iter().filter(|s| s.name == "spindle").collect();
        problem.scene = Some(Arc::new(scene_of(spindle, 0.005)));
        let way = transfer_path(&problem, &placement, [&plans[0], &plans[1]], 1).unwrap();
        let (last, first) = (plans[0].points.end - 1, plans[1].points.start);
        let ends = [(last, plans[0].posture), (first, plans[1].posture)];
        let parts = parts(&problem, &TransferSettings::default(), &way, ends);
        assert_eq!(parts.iter().map(|part| part.places.len()).collect::<Vec<_>>(), [6, 2, 6]);
        assert!((parts.iter().map(|part| part.time_share).sum::<f64>() - 1.0).abs() < 1e-12);
        for (part, joints) in parts.iter().zip(way.joints.windows(2)) {
            let ends = [part.places.first(), part.places.last()].map(|place| place.unwrap().joints);
            assert_eq!(ends, [joints[0], joints[1]]);
        }
        let tip =
            |joints: &[f64; 6]| problem.robot.forward(joints).point(&problem.spindle.flange_from_tool.translation);
        for (part, point) in [(&parts[0], last), (&parts[2], first)] {
            let placed = problem.placed(point, &placement);
            let axis = placed.axes.column(2).into_owned();
            for pair in part.places.windows(2) {
                let middle = std::array::from_fn(|j| (pair[0].joints[j] + pair[1].joints[j]) / 2.0);
                for joints in [&pair[0].joints, &middle, &pair[1].joints] {
                    let off = tip(joints) - placed.tip;
                    let beside = (off - axis * off.dot(&axis)).norm();
                    assert!(beside < 2e-5, "{beside} m beside the axis");
                }
            }
        }
    }
}
