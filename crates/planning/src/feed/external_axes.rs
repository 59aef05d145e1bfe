//! The feed that external axes hold which move along the path.

use super::{FeedLimit, FeedLimitKind};
use crate::redundancy::SegmentPlan;
use stead_problem::problem::Problem;

/// The highest feed of a segment (from 1) by the speeds of the external axes that move along it.
pub(super) fn axis_limit(problem: &Problem, segment: usize, plan: &SegmentPlan) -> Option<FeedLimit> {
    if !problem.moves_axes_along_segments() {
        return None;
    }
    let at = |point: usize| {
        let [from, to] = [point - 1, point].map(|point| problem.axis_positions(point));
        let moves = problem.external_axes.iter().zip(from.iter().zip(to)).enumerate();
        let feeds = moves.filter_map(move |(number, (axis, (from, to)))| {
            Some((axis.max_speed? * problem.step_length(point) / (to - from).abs(), number + 7))
        });
        let (feed, joint) = smallest(feeds)?;
        Some(FeedLimit { feed, kind: FeedLimitKind::Speed, joint, segment, point })
    };
    // A turn of the tool in place has a time, and no feed.
    let path = problem.task.path();
    plan.points.clone().skip(1).filter(|point| !path.turns_in_place(*point)).filter_map(at).reduce(FeedLimit::smaller)
}

/// The smallest finite feed (m/s) with its joint.
pub(super) fn smallest(feeds: impl Iterator<Item = (f64, usize)>) -> Option<(f64, usize)> {
    feeds.filter(|(feed, _)| feed.is_finite()).reduce(|a, b| if b.0 < a.0 { b } else { a })
}
