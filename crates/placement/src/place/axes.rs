//! Where the external axes stand: from one position for the path over one for each segment to a position for each
//! point.
//!
//! Each use starts from the answer of the poorer one, and a step is only taken to a setup whose plan is better, so a
//! richer use is never worse.

use super::job::Planned;
use crate::evaluator::Evaluator;
use crate::path_subset::PathSubset;
use crate::refine::refine;
use rayon::prelude::*;
use stead_model::external_axis::{AxisUse, ExternalAxis};
use stead_numerics::monitor::{Monitor, Progress};
use stead_planning::compass::CompassSteps;
use stead_planning::redundancy::Planner;
use stead_planning::redundancy::axis_path::AxisGrid;
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;
use stead_problem::setup::{AxisPositions, Setup};

/// Positions of an axis that are tried first, over its whole range.
pub(super) const GRID: usize = 5;
/// Positions of an axis that moves along the path, at each point.
pub(super) const PATH_GRID: usize = 13;
/// A step of a position that is this share of the range is the last.
const LAST_STEP: f64 = 1e-3;
/// Rounds of axes and placement.
pub(super) const ROUNDS: usize = 3;
/// A round that gains less (relative) is the last.
pub(super) const GAIN: f64 = 1e-4;
/// How often the positions of an axis along the path are narrowed down.
const NARROWINGS: usize = 3;
/// With more path points the placement is not refined again for other positions of the axes.
pub(super) const MOST_REFINED: usize = 5000;
/// Steps of the positions of an axis at the most.
const STEPS: usize = 60;
/// Points that are left of a segment at least, where the axis is planned on some of the points of a dense path.
const KEPT: usize = 4;

/// One axis after the other, those of some numbers along the path, and the placement, by turns.
pub(super) fn by_turns(problem: &Problem, start: &Planned, moving: &[usize], monitor: &Monitor) -> Planned {
    let mut best = start.clone();
    let axes = || problem.external_axes.iter().enumerate().filter(|(_, axis)| axis.max > axis.min);
    for round in 0..ROUNDS {
        if monitor.should_stop() || axes().next().is_none() {
            break;
        }
        monitor.report(Progress::Steps { stage: "external axes", done: round, total: ROUNDS });
        let before = best.solution.objective;
        for (number, axis) in axes() {
            if let Some(better) = by_segments(problem, &best, number, axis, monitor) {
                best = better;
            }
            if moving.contains(&number)
                && let Some(better) = along_path(problem, &best, number, axis, monitor)
            {
                best = better;
            }
        }
        if let Some(better) = refined(problem, &best, monitor) {
            best = better;
        }
        if before - best.solution.objective < GAIN * before {
            break;
        }
    }
    best
}

/// The plan with other positions of the axes, where it is better.
fn better(problem: &Problem, known: &Planned, positions: AxisPositions) -> Option<Planned> {
    let setup = Setup { positions, ..known.setup.clone() };
    let found = Planned::at(problem, setup, &known.solution.placement)?;
    (found.solution.objective < known.solution.objective).then_some(found)
}

/// The placement refined with the axes where they stand.
pub(super) fn refined(problem: &Problem, known: &Planned, monitor: &Monitor) -> Option<Planned> {
    let is_long = problem.task.points().len() > MOST_REFINED;
    if problem.cell.pinned().is_some() || is_long || monitor.should_stop() {
        return None;
    }
    let set_up = problem.in_setup(&known.setup);
    let planner = Planner::finer(&set_up);
    let evaluator = Evaluator::new(&planner, None);
    let (solution, _) = refine(&evaluator, &known.solution.placement, Sense::Min, None, monitor)?;
    (solution.objective < known.solution.objective).then(|| Planned { solution, ..known.clone() })
}

/// Another position of an axis for the path, or for each segment: first anywhere in its range, then by ever smaller
/// steps.
fn by_segments<'a>(
    problem: &Problem,
    known: &Planned,
    number: usize,
    axis: &'a ExternalAxis,
    monitor: &Monitor,
) -> Option<Planned> {
    let path = problem.task.path();
    let rows = known.setup.positions.spread(&problem.task);
    let placement = &known.solution.placement;
    let is_one = axis.axis_use == AxisUse::Fixed;
    // For an axis that moves along segments already only shifts as a whole are tried.
    let still = vec![0.0; path.segments().len()];
    let at_rest = Shifts { rows, shifts: still.clone(), number, axis };
    let start = (costs(problem, known, &at_rest, placement, &still)?, at_rest);
    let range = axis.max - axis.min;
    let steps = CompassSteps { first: range / (GRID - 1) as f64, last: LAST_STEP * range, shrink: 2.0, rounds: STEPS };
    // First anywhere in the range.
    let mut reach = GRID - 1;
    let moved = |(costs, now): &(SegmentCosts, Shifts<'a>), step: f64| {
        let offsets: Vec<f64> = (1..=reach).flat_map(|k| [step * k as f64, -step * k as f64]).collect();
        reach = 1;
        let cost =
            |offset: &f64| Some((*offset, self::costs(problem, known, now, placement, &vec![*offset; still.len()])?));
        let tried: Vec<(f64, SegmentCosts)> = offsets.par_iter().filter_map(cost).collect();
        let moves = if is_one { one_for_all(problem, costs, &tried) } else { for_each(problem, costs, &tried) }?;
        let shifts = now.shifts.iter().zip(&moves).map(|(shift, by)| shift + by).collect();
        let now = Shifts { rows: now.rows.clone(), shifts, ..*now };
        Some((self::costs(problem, known, &now, placement, &still)?, now))
    };
    let (_, found) = steps.search(start, monitor, moved);
    if found.shifts.iter().all(|shift| *shift == 0.0) {
        return None;
    }
    better(problem, known, found.positions(problem, &still))
}

/// What each segment adds to the objective, for each choice of postures ([`Planner::segment_costs`]).
type SegmentCosts = Vec<Vec<Option<f64>>>;

/// The positions of the axes, those of one of them shifted segment by segment.
struct Shifts<'a> {
    /// For every point.
    rows: Vec<Vec<f64>>,
    /// For every segment.
    shifts: Vec<f64>,
    number: usize,
    axis: &'a ExternalAxis,
}

impl Shifts<'_> {
    /// Shifted once more, within the range of the axis.
    fn positions(&self, problem: &Problem, by: &[f64]) -> AxisPositions {
        let mut rows = self.rows.clone();
        for (segment, span) in problem.task.segments().iter().enumerate() {
            for row in &mut rows[span.clone()] {
                let moved = row[self.number] + self.shifts[segment] + by[segment];
                row[self.number] = moved.max(self.axis.min).min(self.axis.max);
            }
        }
        AxisPositions::shortest(rows, &problem.task)
    }
}

/// The costs with the axis shifted; nothing
/// where the range of the axis leaves no shift.
fn costs(
    problem: &Problem,
    known: &Planned,
    now: &Shifts<'_>,
    placement: &Placement,
    by: &[f64],
) -> Option<SegmentCosts> {
    let positions = now.positions(problem, by);
    let is_shifted = by.iter().any(|by| *by != 0.0);
    if is_shifted && positions == now.positions(problem, &vec![0.0; by.len()]) {
        return None;
    }
    let setup = Setup { positions, ..known.setup.clone() };
    let set_up = problem.in_setup(&setup);
    let planner = Planner::new(&set_up);
    Some(planner.segment_costs(placement, &mut planner.workspace()))
}

/// The objective of the best choice of postures.
fn objective(problem: &Problem, costs: &[Vec<Option<f64>>]) -> f64 {
    let of =
        |row: &Vec<Option<f64>>| row.iter().copied().collect::<Option<Vec<f64>>>().map(|row| problem.objective(row));
    costs.iter().filter_map(of).fold(f64::INFINITY, f64::min)
}

/// The one shift of all segments that is better than none.
fn one_for_all(problem: &Problem, costs: &[Vec<Option<f64>>], tried: &[(f64, SegmentCosts)]) -> Option<Vec<f64>> {
    let best = tried.iter().min_by(|a, b| objective(problem, &a.1).total_cmp(&objective(problem, &b.1)))?;
    let count = costs.first()?.len();
    (objective(problem, &best.1) < objective(problem, costs) * (1.0 - ROUNDING)).then(|| vec![best.0; count])
}

/// Differences that are less (relative) are none.
const ROUNDING: f64 = 1e-9;

/// The shift of each segment, in the choice of postures that is best then.
fn for_each(problem: &Problem, costs: &[Vec<Option<f64>>], tried: &[(f64, SegmentCosts)]) -> Option<Vec<f64>> {
    let of_choice = |choice: usize| {
        let mut shifts = Vec::with_capacity(costs[choice].len());
        let mut least = Vec::with_capacity(costs[choice].len());
        for (segment, own) in costs[choice].iter().enumerate() {
            let mut best = (own.map_or(f64::INFINITY, |own| own * (1.0 - ROUNDING)), 0.0);
            for (shift, other) in tried {
                if let Some(cost) = other[choice][segment]
                    && cost < best.0
                {
                    best = (cost, *shift);
                }
            }
            least.push(best.0);
            shifts.push(best.1);
        }
        (problem.objective(least), shifts)
    };
    let best = (0..costs.len()).map(of_choice).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let is_better = best.0 < objective(problem, costs) * (1.0 - ROUNDING) && best.1.iter().any(|shift| *shift != 0.0);
    is_better.then_some(best.1)
}

/// An axis that moves along the path: over its whole range on a grid, then about the way found.
fn along_path(
    problem: &Problem,
    known: &Planned,
    number: usize,
    axis: &ExternalAxis,
    monitor: &Monitor,
) -> Option<Planned> {
    let set_up = problem.in_setup(&known.setup);
    let kept = stride(&set_up, axis);
    let thinned = (kept.len() < set_up.task.points().len()).then(|| PathSubset::of_points(kept.clone()).of(&set_up));
    let coarse = thinned.as_ref().unwrap_or(&set_up);
    let all: Vec<Vec<f64>> = known.setup.positions.spread(&set_up.task);
    let mut way: Vec<f64> = kept.iter().map(|point| all[*point][number]).collect();
    let mut width = axis.max - axis.min;
    let mut best: Option<Planned> = None;
    for narrowing in 0..=NARROWINGS {
        if monitor.should_stop() {
            break;
        }
        let positions = way.iter().map(|at| around(axis, *at, width)).collect();
        let grid = AxisGrid { problem: coarse, axis: number, positions };
        let Some(paths) = grid.paths(&known.solution.placement) else { break };
        let found: Vec<f64> = paths.into_iter().flat_map(|path| path.positions).collect();
        let rows: Vec<Vec<f64>> = kept
            .iter()
            .zip(&found)
            .map(|(point, position)| {
                let mut row = all[*point].clone();
                row[number] = *position;
                row
            })
            .collect();
        let rows = between(&set_up, &kept, &rows);
        let positions = AxisPositions::shortest(rows, &problem.task);
        let candidate = better(problem, best.as_ref().unwrap_or(known), positions);
        if candidate.is_none() && narrowing > 0 {
            break;
        }
        best = candidate.or(best);
        way = found;
        width *= 3.0 / (PATH_GRID - 1) as f64;
    }
    best
}

/// Positions about one, as far as the range allows; with the one itself among them.
fn around(axis: &ExternalAxis, at: f64, width: f64) -> Vec<f64> {
    let from = (at - width / 2.0).max(axis.min).min((axis.max - width).max(axis.min));
    let step = width.min(axis.max - axis.min) / (PATH_GRID - 1) as f64;
    let mut positions: Vec<f64> = (0..PATH_GRID).map(|k| (from + step * k as f64).min(axis.max)).collect();
    let off = |position: &f64| (position - at).abs();
    if let Some(nearest) = (0..PATH_GRID).min_by(|a, b| off(&positions[*a]).total_cmp(&off(&positions[*b]))) {
        positions[nearest] = at;
    }
    positions
}

/// The points on which an axis is planned.
fn stride(problem: &Problem, axis: &ExternalAxis) -> Vec<usize> {
    let grid = (axis.max - axis.min) / (PATH_GRID - 1) as f64;
    kept_points(problem, usize::MAX, |time| grid / (axis.max_speed.unwrap_or(f64::INFINITY) * time))
}

/// Of a path at most so many points, or on a dense path so few that beta and what else is planned can take a step of
/// their grids from one to the next; `steps` says how many points that takes, by the time from one to the next (s).
/// Every segment keeps its ends.
pub(super) fn kept_points(problem: &Problem, most: usize, steps_needed: impl Fn(f64) -> f64) -> Vec<usize> {
    let count = problem.task.points().len();
    let least = count.div_ceil(most.max(1)) as f64;
    let mut kept = Vec::new();
    for span in problem.task.segments() {
        let steps = span.len().saturating_sub(1).max(1) as f64;
        let time: f64 =
            span.clone().skip(1).map(|point| problem.step_time(point)).filter(|time| time.is_finite()).sum();
        let length: f64 = span.clone().skip(1).map(|point| problem.step_length(point)).sum();
        let by_axis = steps_needed(time / steps);
        let limits = &problem.redundancy;
        let by_length = [limits.max_beta_rate, limits.max_spindle_turn].into_iter().flatten().map(|rate| rate * length);
        let by_time = limits.max_spindle_speed.map(|speed| speed * time);
        let change = by_length.chain(by_time).fold(f64::INFINITY, f64::min) / steps;
        let by_beta = limits.beta_step() / change;
        let wanted = by_axis.max(by_beta).max(least).ceil();
        let most = (span.len() / KEPT).max(1);
        let stride = if wanted.is_finite() { (wanted.max(1.0) as usize).min(most) } else { most };
        kept.extend(span.clone().step_by(stride));
        if kept.last() != Some(&(span.end - 1)) {
            kept.push(span.end - 1);
        }
    }
    kept
}

/// The positions of all axes at every point, from those at the points kept, in proportion to the time between these
/// where it is known.
pub(super) fn between(problem: &Problem, kept: &[usize], found: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut rows = problem.setup.positions.spread(&problem.task);
    for (point, row) in kept.iter().zip(found) {
        rows[*point].clone_from(row);
    }
    for (pair, ends) in kept.windows(2).zip(found.windows(2)) {
        let (first, last) = (pair[0], pair[1]);
        if problem.task.path().segment_of(first) != problem.task.path().segment_of(last) {
            continue;
        }
        let times: Vec<f64> = (first + 1..=last).map(|point| problem.step_time(point)).collect();
        let whole: f64 = times.iter().sum();
        let mut done = 0.0;
        for (point, time) in (first + 1..last).zip(&times) {
            done += time;
            let at = |(number, own): (usize, &mut f64)| {
                let (from, to) = (ends[0][number], ends[1][number]);
                if from != to {
                    *own = from + (to - from) * done / whole;
                }
            };
            rows[point].iter_mut().enumerate().for_each(at);
        }
    }
    rows
}
