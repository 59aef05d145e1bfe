//! Moves between segments: how long the joints need from the end of one segment to the start of the next.
//!
//! Each joint and each external axis moves from rest to rest within its speed, acceleration and jerk; all arrive
//! together. Time-optimal profiles come from rsruckig. Without shapes of the cell only the time is computed: that the
//! move clears the workpiece is for the programmer to see to. With them, moves keep free of all shapes
//! ([`TransferPath`]).

use super::feed::{CutFeed, cut_feed};
use super::transfer_path::{LineEnd, TransferPath, transfer_path};
use rsruckig::prelude::{InputParameter, Ruckig, ThrowErrorHandler, Trajectory};
use stead_problem::problem::{Placement, Problem};
use stead_problem::segment_plan::SegmentPlan;
use stead_problem::settings::TransferSettings;

/// How long the cut takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Cycle {
    /// The feed that the arm holds.
    pub feed: CutFeed,
    /// Time in the cut: the length of each segment over the feed held there. s
    pub cutting: f64,
    /// Moves between segments, in order, one fewer than segments; zero where nothing changes.
    pub transfers: Vec<Transfer>,
    /// Path points to which the arm cannot follow the straight move of the tool, and why.
    pub unfollowed: Vec<(usize, LineEnd)>,
}

/// A joint move from the end of one segment to the start of the next, from rest to rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Transfer {
    /// Number of the segment before the move, from 1.
    pub after_segment: usize,
    /// Duration; `None` where a joint that moves has no speed in the robot file. s
    pub duration: Option<f64>,
    /// Largest joint travel of the move. rad
    pub travel: f64,
    /// How it keeps free, where there is a scene.
    pub way: Option<TransferPath>,
}

impl Cycle {
    /// Cutting and moves together; `None` where a move's time is not known. s
    pub fn total(&self) -> Option<f64> {
        self.transfers.iter().try_fold(self.cutting, |sum, transfer| Some(sum + transfer.duration?))
    }
}

/// A joint that moves by less than this stands still. rad
const STANDSTILL: f64 = 1e-7;

/// The times of the cut itself, each segment with the feed that the arm holds, without the moves between segments.
pub fn cut_alone(problem: &Problem, settings: &TransferSettings, plans: &[SegmentPlan]) -> Cycle {
    let feed = cut_feed(problem, settings.blend, plans);
    let cutting =
        plans.iter().enumerate().map(|(s, plan)| cutting_time(problem, settings, feed.held(s), s, plan)).sum();
    Cycle { feed, cutting, transfers: Vec::new(), unfollowed: Vec::new() }
}

/// The times of a plan: the cut itself, each segment with the feed that the arm holds, and the moves between segments.
pub fn cycle(problem: &Problem, placement: &Placement, settings: &TransferSettings, plans: &[SegmentPlan]) -> Cycle {
    let Cycle { feed, cutting, .. } = cut_alone(problem, settings, plans);
    let transfers = plans
        .windows(2)
        .enumerate()
        .filter_map(|(index, pair)| {
            let direct = [*pair[0].joints.last()?, *pair[1].joints.first()?];
            let way = transfer_path(problem, placement, [&pair[0], &pair[1]], index);
            let joints = way.as_ref().map_or(&direct[..], |way| &way.joints);
            let travel = (0..6).map(|j| joints.windows(2).map(|step| (step[0][j] - step[1][j]).abs()).sum::<f64>());
            let positions = [pair[0].points.end - 1, pair[1].points.start].map(|point| problem.axis_positions(point));
            let axes_from = way.as_ref().map_or(1, |way| way.axes_from);
            let duration = part_durations(problem, settings, joints, axes_from, positions).map(|all| all.iter().sum());
            Some(Transfer { after_segment: index + 1, duration, travel: travel.fold(0.0, f64::max), way })
        })
        .collect();
    let unfollowed = plans.iter().flat_map(|plan| problem.unfollowed_moves(placement, plan)).collect();
    Cycle { feed, cutting, transfers, unfollowed }
}

/// The time of a segment (from 0): each move with its feed, or with the highest that the arm holds along the segment
/// (m/s) where that is lower; a turn of the tool in place from rest to rest, where the speeds of the joints are known.
/// s
fn cutting_time(problem: &Problem, settings: &TransferSettings, held: f64, segment: usize, plan: &SegmentPlan) -> f64 {
    let path = problem.task.path();
    if path.feed(plan.points.start).is_none() && path.first_unscored().is_none() {
        return path.segment_length(segment) / held;
    }
    let step = |place: usize| {
        let point = plan.points.start + place;
        if path.turns_in_place(point) {
            let joints = duration(problem, settings, &plan.joints[place - 1], &plan.joints[place]).unwrap_or(0.0);
            let axes = axis_duration(problem, settings, [point - 1, point].map(|point| problem.axis_positions(point)));
            return joints.max(axes.unwrap_or(0.0));
        }
        path.step_length(point) / path.feed(point).map_or(held, |feed| feed.min(held))
    };
    (1..plan.joints.len()).map(step).sum()
}

/// Times of joint moves one after the other, each from rest to rest; on the move to one of them (`axes_from`) the
/// external axes move too, between these positions. `None` as in [`duration`]. s
pub(crate) fn part_durations(
    problem: &Problem,
    settings: &TransferSettings,
    joints: &[[f64; 6]],
    axes_from: usize,
    positions: [&[f64]; 2],
) -> Option<Vec<f64>> {
    let time = |(step, place): (&[[f64; 6]], usize)| {
        let of_joints = duration(problem, settings, &step[0], &step[1])?;
        Some(if place == axes_from { of_joints.max(axis_duration(problem, settings, positions)?) } else { of_joints })
    };
    joints.windows(2).zip(1..).map(time).collect()
}

/// Shortest time from rest at `from` to rest at `to` (joint angles in rad); `None` when a joint that has to move has no
/// speed limit, or when no profile was found. s
pub fn duration(problem: &Problem, settings: &TransferSettings, from: &[f64; 6], to: &[f64; 6]) -> Option<f64> {
    let mut input = InputParameter::<6>::new(None);
    let (from, to) = (problem.robot.drives(from), problem.robot.drives(to));
    let mut moves = false;
    for (j, joint) in problem.robot.joints().iter().enumerate() {
        let stands = (to[j] - from[j]).abs() < STANDSTILL;
        input.enabled[j] = !stands;
        if stands {
            continue;
        }
        moves = true;
        let speed = joint.max_speed?;
        let acceleration = joint.max_acceleration.unwrap_or(speed / settings.acceleration_time);
        input.current_position[j] = from[j];
        input.target_position[j] = to[j];
        input.max_velocity[j] = speed;
        input.max_acceleration[j] = acceleration;
        input.max_jerk[j] = joint.max_jerk.unwrap_or(acceleration / settings.jerk_time);
    }
    if !moves {
        return Some(0.0);
    }
    let mut trajectory = Trajectory::<6>::new(None);
    let mut generator = Ruckig::<6, ThrowErrorHandler>::new(None, 0.01);
    generator.calculate(&input, &mut trajectory).ok()?;
    let duration = trajectory.get_duration();
    duration.is_finite().then_some(duration)
}

/// Shortest time in which the external axes move from rest to rest between positions (m or rad), each by itself, beside
/// the joints; `None` when one that has to move has no speed. s
fn axis_duration(problem: &Problem, settings: &TransferSettings, positions: [&[f64]; 2]) -> Option<f64> {
    let [from, to] = positions;
    let moved = problem.external_axes.iter().zip(from.iter().zip(to)).filter(|(_, (from, to))| from != to);
    moved
        .map(|(axis, (from, to))| {
            let mut input = InputParameter::<1>::new(None);
            let speed = axis.max_speed?;
            let acceleration = speed / settings.acceleration_time;
            input.current_position[0] = *from;
            input.target_position[0] = *to;
            input.max_velocity[0] = speed;
            input.max_acceleration[0] = acceleration;
            input.max_jerk[0] = acceleration / settings.jerk_time;
            let mut trajectory = Trajectory::<1>::new(None);
            Ruckig::<1, ThrowErrorHandler>::new(None, 0.01).calculate(&input, &mut trajectory).ok()?;
            Some(trajectory.get_duration()).filter(|duration| duration.is_finite())
        })
        .try_fold(0.0, |longest: f64, duration| Some(longest.max(duration?)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use stead_model::robot::{Joint, Robot};
    use stead_problem::testing::five_segments;

    fn with_speeds(speeds_deg: [f64; 6]) -> Problem {
        let mut problem = five_segments();
        let mut joints: [Joint; 6] = problem.robot.joints().clone();
        for (joint, speed) in joints.iter_mut().zip(speeds_deg) {
            joint.max_speed = Some(speed.to_radians());
        }
        problem.robot = Robot::new("fast", joints).unwrap();
        problem
    }

    /// Textbook seven-phase profile of one joint, from rest to rest, where full speed is reached.
    fn seven_phases(distance: f64, v: f64, a: f64, j: f64) -> f64 {
        distance / v + v / a + a / j
    }

    #[test]
    fn a_long_move_takes_the_textbook_time_of_the_slowest_joint() {
        let problem = with_speeds([105.0, 101.0, 107.0, 136.0, 129.0, 206.0]);
        let settings = TransferSettings::default();
        let to = [2.0, 0.1, -0.2, 0.0, 0.3, 0.0];
        let found = duration(&problem, &settings, &[0.0; 6], &to).unwrap();
        let v = 105.0_f64.to_radians();
        let expected = seven_phases(2.0, v, v / 0.4, v / 0.4 / 0.1);
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }

    #[test]
    fn standing_still_takes_no_time_and_an_unknown_speed_is_not_guessed() {
        let problem = five_segments();
        let settings = TransferSettings::default();
        assert_eq!(duration(&problem, &settings, &[0.3; 6], &[0.3; 6]), Some(0.0));
        assert_eq!(duration(&problem, &settings, &[0.3; 6], &[0.4; 6]), None);
    }
}
