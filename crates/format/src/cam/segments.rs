//! From the moves of a program to the points of a task: runs of cutting moves between rapids, resampled.
//!
//! Points that a straight line stands for within the chord error are left out, and long lines are divided. Corners,
//! changes of the feed, points of arcs and the ends of plunges and of turns in place stay where they are.

use super::{Move, Program};
use nalgebra::{Rotation3, Vector3};
use stead_model::task::MIN_FEED_TO_AXIS_DEG;

/// How densely points are taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resampling {
    /// How far a left-out point may be from the line that stands for it. m
    pub chord: f64,
    /// The largest distance between points, which a hundredth more is not divided for. m
    pub step: f64,
}

impl Default for Resampling {
    fn default() -> Self {
        Self { chord: 1e-5, step: 1e-2 }
    }
}

/// Ends nearer than this are the same place. m
const SAME_PLACE: f64 = 1e-6;
/// Tool axes nearer than this are the same. rad
const SAME_AXIS: f64 = 1e-6;
/// A turn of the path by more than this is a corner. rad
const CORNER: f64 = 20.0 * std::f64::consts::PI / 180.0;
/// How far the tool axis of a left-out point may be from that on the line. rad
const AXIS_ERROR: f64 = 0.5 * std::f64::consts::PI / 180.0;
/// The largest turn of the tool axis between points. rad
const AXIS_STEP: f64 = 5.0 * std::f64::consts::PI / 180.0;
/// Points may be farther apart than the step by this share, so that a line of 10.05 mm is not divided at 10.
const LONGER: f64 = 0.01;
/// A line stands for no more points than this, so that the work grows with their number alone.
const MAX_RUN: usize = 256;
/// A feed nearer to the tool axis than this gives no wall normal: what a task accepts, and room for rounding. rad
const NO_WALL: f64 = (MIN_FEED_TO_AXIS_DEG + 0.05) * std::f64::consts::PI / 180.0;

/// A point of a task.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Point {
    /// m
    pub position: Vector3<f64>,
    pub axis: Vector3<f64>,
    /// Feed direction; where the point is not scored the direction from which beta counts.
    pub direction: Vector3<f64>,
    /// Feed of the move to it. m/s
    pub feed: Option<f64>,
    pub is_scored: bool,
}

/// What became of the moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Counts {
    /// Cutting moves of the program.
    pub cutting: usize,
    /// Rapid moves of the program.
    pub rapid: usize,
    /// Moves that end where they start.
    pub doubled: usize,
    /// Points that a line stands for.
    pub left_out: usize,
    /// Points on long lines.
    pub added: usize,
    /// Points of plunges along the tool axis.
    pub plunging: usize,
    /// Points of turns of the tool in place.
    pub turning: usize,
}

/// Direction from an end of a move to another, nothing where the tool only turns.
fn way(from: &Move, to: &Move) -> Option<Vector3<f64>> {
    (to.position - from.position).try_normalize(SAME_PLACE)
}

/// About how many points a program has at most.
pub(super) fn expected_points(program: &Program, resampling: Resampling) -> f64 {
    let cuts = program.moves.windows(2).filter(|pair| !pair[1].is_rapid);
    cuts.map(|pair| 1.0 + (pair[1].position - pair[0].position).norm() / resampling.step).sum()
}

/// The segments of a program, and the rapid moves before each of them and after the last: the places in the air
/// between the end of one and the start of the next.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Segments {
    pub segments: Vec<Vec<Point>>,
    pub rapids: Vec<Vec<Move>>,
    pub counts: Counts,
}

/// The segments of a program. Inside, a move that `is_fixed` keeps its end whatever the chord error.
pub(super) fn segments(program: &Program, resampling: Resampling) -> Segments {
    let mut all = Segments::default();
    let counts = &mut all.counts;
    counts.rapid = program.moves.iter().skip(1).filter(|one| one.is_rapid).count();
    // Rapid moves since the end of the last segment.
    let mut air: Vec<Move> = Vec::new();
    for run in program.moves.chunk_by(|one, next| one.is_rapid == next.is_rapid) {
        if run[0].is_rapid {
            air.extend(run);
            continue;
        }
        counts.cutting += run.len();
        let start = air.last().map(|start| Move { feed: run[0].feed, is_fixed: true, ..*start });
        let mut knots = Vec::from_iter(start);
        run.iter().for_each(|one| push(&mut knots, one, counts));
        if knots.len() > 1 {
            let kept = kept(&knots, resampling, counts);
            all.segments.push(points(&divided(&kept, resampling, counts), counts));
            // The last of them ends where the segment starts.
            air.pop();
            all.rapids.push(std::mem::take(&mut air));
        }
    }
    all.rapids.push(air);
    all
}

/// Adds the end of a move, unless the tool is there already.
fn push(knots: &mut Vec<Move>, one: &Move, counts: &mut Counts) {
    let mut knot = *one;
    if let Some(last) = knots.last_mut()
        && (last.position - knot.position).norm() < SAME_PLACE
    {
        if angle(&last.axis, &knot.axis) < SAME_AXIS {
            counts.doubled += 1;
            return;
        }
        last.is_fixed = true;
        (knot.position, knot.is_fixed) = (last.position, true);
    }
    knots.push(knot);
}

/// The knots that are left when lines stand for what is within the chord error.
fn kept(knots: &[Move], resampling: Resampling, counts: &mut Counts) -> Vec<Move> {
    let mut kept = vec![knots[0]];
    let mut anchor = 0;
    while anchor + 1 < knots.len() {
        let last = knots.len().min(anchor + MAX_RUN + 1);
        let is_end = |at: &usize| stays(&knots[at - 1..at + 2]) || !stands_for(&knots[anchor..at + 2], resampling);
        let end = (anchor + 1..last - 1).find(is_end).unwrap_or(last - 1);
        counts.left_out += end - anchor - 1;
        kept.push(knots[end]);
        anchor = end;
    }
    kept
}

/// Whether a knot between two others stays whatever the chord error.
fn stays(around: &[Move]) -> bool {
    let [before, here, after] = around else { return true };
    let (Some(to), Some(from)) = (way(before, here), way(here, after)) else { return true };
    here.is_fixed
        || here.feed != after.feed
        || angle(&to, &from) > CORNER
        || has_wall(&to, here) != has_wall(&from, here)
}

/// Whether the line from the first knot to the last is within the errors of all between, and no longer than the step.
fn stands_for(knots: &[Move], resampling: Resampling) -> bool {
    let [start, inner @ .., end] = knots else { return true };
    let way = end.position - start.position;
    let length = way.norm();
    if length > resampling.step || length < SAME_PLACE || angle(&start.axis, &end.axis) > AXIS_STEP {
        return false;
    }
    inner.iter().all(|knot| {
        let share = ((knot.position - start.position).dot(&way) / (length * length)).clamp(0.0, 1.0);
        let axis = start.axis * (1.0 - share) + end.axis * share;
        (knot.position - start.position - way * share).norm() <= resampling.chord
            && angle(&axis, &knot.axis) <= AXIS_ERROR
    })
}

/// The knots with points between those that are too far apart.
fn divided(knots: &[Move], resampling: Resampling, counts: &mut Counts) -> Vec<Move> {
    let mut all = vec![knots[0]];
    for pair in knots.windows(2) {
        let (from, to) = (&pair[0], &pair[1]);
        let turn = angle(&from.axis, &to.axis);
        let by_length = ((to.position - from.position).norm() / (resampling.step * (1.0 + LONGER)) - 1e-6).ceil();
        let parts = by_length.max((turn / AXIS_STEP - 1e-6).ceil()).max(1.0) as u32;
        let about = nalgebra::Unit::try_new(from.axis.cross(&to.axis), 1e-12);
        all.extend((1..parts).map(|part| {
            let share = f64::from(part) / f64::from(parts);
            let axis = about.map_or(from.axis, |about| Rotation3::from_axis_angle(&about, turn * share) * from.axis);
            Move { position: from.position + (to.position - from.position) * share, axis, ..*to }
        }));
        counts.added += parts as usize - 1;
        all.push(*to);
    }
    all
}

/// The points with their directions: to the next point, or from the one before where there is no wall on the way to the
/// next.
fn points(knots: &[Move], counts: &mut Counts) -> Vec<Point> {
    let mut directions = Vec::with_capacity(knots.len());
    for (place, here) in knots.iter().enumerate() {
        let to = place.checked_sub(1).map(|before| way(&knots[before], here));
        let from = knots.get(place + 1).and_then(|next| way(here, next));
        let is_turn = to == Some(None);
        let walled = [from, to.flatten()].into_iter().flatten().find(|way| !is_turn && has_wall(way, here));
        counts.turning += usize::from(is_turn);
        counts.plunging += usize::from(!is_turn && walled.is_none());
        directions.push(walled);
    }
    let mut reference = directions.iter().flatten().next().copied().unwrap_or_else(Vector3::x);
    let point = |(&Move { position, axis, feed, .. }, walled): (&Move, Option<Vector3<f64>>)| {
        reference = walled.unwrap_or_else(|| across(&reference, &axis));
        Point { position, axis, direction: reference, feed, is_scored: walled.is_some() }
    };
    knots.iter().zip(directions).map(point).collect()
}

/// The direction normal to an axis that is nearest to another, or any where that is along the axis.
fn across(direction: &Vector3<f64>, axis: &Vector3<f64>) -> Vector3<f64> {
    let normal = |direction: &Vector3<f64>| (direction - axis * direction.dot(axis)).try_normalize(0.1);
    let others = [Vector3::x(), Vector3::y()];
    normal(direction).or_else(|| others.iter().find_map(normal)).unwrap_or_else(Vector3::x)
}

/// Whether a direction of the feed is far enough from the tool axis to tell the normal of the wall.
fn has_wall(direction: &Vector3<f64>, knot: &Move) -> bool {
    let off = angle(direction, &knot.axis);
    off > NO_WALL && std::f64::consts::PI - off > NO_WALL
}

/// The angle between two directions of any length. rad
pub(super) fn angle(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    libm::atan2(a.cross(b).norm(), a.dot(b))
}
