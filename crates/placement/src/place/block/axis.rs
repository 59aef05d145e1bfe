//! The position of an external axis: one for the path, or one for each segment.

use crate::place::improver::Improver;
use crate::place::job::Planned;
use rayon::prelude::*;
use stead_model::external_axis::{AxisUse, ExternalAxis};
use stead_planning::compass::CompassSteps;
use stead_planning::redundancy::Planner;
use stead_problem::problem::{Placement, Problem};
use stead_problem::setup::{AxisPositions, Setup};

/// Positions of an axis that are tried first, over its whole range.
pub(in crate::place) const GRID: usize = 5;
/// A step of a position that is this share of the range is the last.
const LAST_STEP: f64 = 1e-3;
/// Steps of the positions of an axis at the most.
const STEPS: usize = 60;

/// Another position of an axis for the path, or for each segment: first anywhere in its range, then by ever smaller
/// steps.
pub(in crate::place) fn by_segments<'a>(job: &Improver<'a>, known: &Planned, number: usize) -> Option<Planned> {
    let problem = job.problem;
    let axis = &problem.external_axes[number];
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
    let (_, found) = steps.search(start, job.monitor, moved);
    if found.shifts.iter().all(|shift| *shift == 0.0) {
        return None;
    }
    let setup = Setup { positions: found.positions(problem, &still), ..known.setup.clone() };
    Planned::at(problem, setup, placement)
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

/// The costs with the axis shifted; nothing where the range of the axis leaves no shift.
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
