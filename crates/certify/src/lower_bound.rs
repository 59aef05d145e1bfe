//! A lower bound of the objective over a box of placements, with the rate of beta: dynamic programming over cells of
//! heading at the corners of the box.
//!
//! Every cell costs an affine function of the placement, a way through the cells their sum, the best way the least of
//! these: a concave function, so its least value over the box is at a corner. Ways are taken from cell to cell where
//! some beta of the one is within the limits on beta of some beta of the other.

use super::active_cells::ActiveCells;
use super::arm::Arm;
use super::compliance_table::{ComplianceTable, Node};
use super::cost::{CORNERS, NOTHING, PointCost, cost_at_corners, joined_sets};
use super::model::Model;
use super::region::Region;
use super::sliding_min::{INFINITE, SlidingMin, joined, min_into};
use std::f64::consts::TAU;
use stead_model::robot::PostureClass;
use stead_numerics::monitor::Monitor;
use stead_planning::beta_step::BetaStep;
use stead_planning::criterion::Aggregate;

/// Steps over more cells than there are.
const ANYWHERE: (isize, isize) = (-1_000_000, 1_000_000);

#[derive(Debug, Clone)]
pub(super) struct LowerBound {
    /// Least sum of what the points cost (the largest, where that is minimised); infinite where nothing is feasible.
    pub sum: f64,
    /// Cells of heading that some placement of the box may still need.
    pub active: ActiveCells,
}

impl Model {
    /// Bounds a box from below, on the level of the active cells; cells through which every way costs `ceiling` (m,
    /// sum) or more become inactive.
    ///
    /// A point that tables do not answer for, whether the box is too large for the level, or may have it near axis 1,
    /// costs nothing and loses no cell, and beta may step anywhere from it and to it. The bound is left to the other
    /// points.
    ///
    /// Once the caller asks to stop, what is returned is no bound.
    pub fn lower_bound(&self, region: &Region, active: &ActiveCells, ceiling: f64, monitor: &Monitor) -> LowerBound {
        let (count, aggregate) = (active.count(), self.objective.aggregate);
        let mut pass = Pass {
            model: self,
            monitor,
            region,
            points: self.point_costs(region),
            active: active.clone(),
            neighbours: SlidingMin::new(count),
            width: TAU / count as f64,
        };
        let mut totals = [0.0; CORNERS];
        let (mut all, mut bests) = (Vec::new(), Vec::new());
        for segment in 0..self.segments.len() {
            let mut best = INFINITE;
            for class in PostureClass::ALL {
                if let Some(ways) = pass.forward(segment, class) {
                    min_into(&mut best, &ways.end);
                    all.push(ways);
                }
            }
            if best[0] == f64::INFINITY {
                return LowerBound { sum: f64::INFINITY, active: pass.active };
            }
            totals = joined(aggregate, &totals, &best);
            bests.push(best);
        }
        let sum = totals.iter().copied().fold(f64::INFINITY, f64::min);
        if sum < ceiling {
            for ways in &all {
                let best = bests[ways.segment];
                let others = match aggregate {
                    Aggregate::Mean | Aggregate::Rms => std::array::from_fn(|k| totals[k] - best[k]),
                    // Those of the other segments are below the ceiling by themselves.
                    Aggregate::Max => [0.0; CORNERS],
                };
                pass.prune(ways, &others, ceiling);
            }
        }
        LowerBound { sum, active: pass.active }
    }

    /// From which to which number of cells a way may step up, to `point` from the one before.
    ///
    /// Beta is the heading less the direction of the feed (or the other way round), both against the azimuth of the
    /// point.
    pub fn steps(&self, region: &Region, points: &[Option<PointCost<'_>>], point: usize, width: f64) -> (isize, isize) {
        let (Some(before), Some(here)) = (&points[point - 1], &points[point]) else { return ANYWHERE };
        let (before, here) = (&before.placed, &here.placed);
        let [a, _, g] = region.half;
        let unsure = (here.slope_chi[0] - before.slope_chi[0]).abs() * a
            + (here.slope_chi[1] - before.slope_chi[1]).abs() * g
            + here.remainder_chi
            + before.remainder_chi;
        let BetaStep { middle, half } = self.changes[point];
        let turned = here.chi - before.chi + middle;
        let turned = turned - TAU * (turned / TAU).round();
        let max_step = (half + unsure) / width + 1.0 + 1e-6;
        if max_step >= 1e6 {
            return ANYWHERE;
        }
        let shift = turned / width;
        ((shift - max_step).ceil() as isize, (shift + max_step).floor() as isize)
    }
}

/// The dynamic programming over one box.
struct Pass<'a> {
    model: &'a Model,
    monitor: &'a Monitor,
    region: &'a Region,
    /// `None` for a point of which nothing is known.
    points: Vec<Option<PointCost<'a>>>,
    active: ActiveCells,
    neighbours: SlidingMin,
    /// Width of a cell. rad
    width: f64,
}

/// The ways through one segment in one class.
struct Ways {
    segment: usize,
    class: usize,
    rows: Vec<Row>,
    /// The least sum at the end.
    end: [f64; CORNERS],
}

/// The cells of one point, their costs, and for every cell the least sum up to it.
struct Row {
    cells: Vec<usize>,
    costs: Vec<[f64; CORNERS]>,
    sums: Vec<[f64; CORNERS]>,
    /// The least of the sums.
    min: [f64; CORNERS],
}

/// A point with its node, and how far the point is from it in radius and height (m).
type Answer<'a> = (PointCost<'a>, [usize; 2], [f64; 2]);

impl<'a> Pass<'a> {
    /// The ways through a segment from its start; `None`, with all its cells inactive, where there is none.
    fn forward(&mut self, segment: usize, class: PostureClass) -> Option<Ways> {
        let span = self.model.segments[segment].clone();
        let mut rows: Vec<Row> = Vec::with_capacity(span.len());
        let mut end = INFINITE;
        for point in span.clone() {
            // Making the nodes of one point takes up to milliseconds, and there are thousands of points.
            if self.monitor.should_stop() {
                return None;
            }
            let row = self.row(point, class, rows.last());
            end = row.min;
            if end[0] == f64::INFINITY {
                span.clone().for_each(|point| self.active.clear_all(point, class.index()));
                return None;
            }
            rows.push(row);
        }
        Some(Ways { segment, class: class.index(), rows, end })
    }

    /// A point after the row of the one before; cells that no way leads to, or in which nothing is allowed, become
    /// inactive.
    fn row(&mut self, point: usize, class: PostureClass, before: Option<&Row>) -> Row {
        if let Some(before) = before {
            let (low, high) = self.model.steps(self.region, &self.points, point, self.width);
            self.neighbours.compute(&before.sums, -high, -low);
        }
        let sums = vec![INFINITE; self.active.count()];
        let mut row = Row { cells: Vec::new(), costs: Vec::new(), sums, min: INFINITE };
        let answer = self.answer(point);
        let cells: Vec<usize> = self.active.cells(point, class.index()).collect();
        for cell in cells {
            let reached = before.map(|_| self.neighbours.out[cell]);
            let is_reached = reached.is_none_or(|sum| sum[0] != f64::INFINITY);
            let Some(cost) = is_reached.then(|| self.cost(answer.as_ref(), cell, class)).flatten() else {
                self.active.clear(point, class.index(), cell);
                continue;
            };
            let sum = reached.map_or(cost, |sum| joined(self.model.objective.aggregate, &sum, &cost));
            row.sums[cell] = sum;
            row.cells.push(cell);
            row.costs.push(cost);
            min_into(&mut row.min, &sum);
        }
        row
    }

    /// The node that answers for a point all over the box, if there is one.
    fn answer(&self, point: usize) -> Option<Answer<'a>> {
        let cost = self.points[point]?;
        let (placed, level, table) = (&cost.placed, self.active.level, &self.model.table);
        let answers = table.answers(level, [placed.reach[0], placed.reach[1]]);
        let (at, off) = table.nearest(level, placed.r, placed.z).filter(|_| answers)?;
        Some((cost, at, off))
    }

    /// What a point costs at least in a cell; `None` where none of its states is allowed.
    fn cost(&self, answer: Option<&Answer<'_>>, cell: usize, class: PostureClass) -> Option<[f64; CORNERS]> {
        let Some((point, at, off)) = answer else { return Some([0.0; CORNERS]) };
        let Model { table, arm, others, over, objective, .. } = self.model;
        let (level, half, aggregate) = (self.active.level, 0.5 * self.width, objective.aggregate);
        let least = |table: &ComplianceTable, arm: &Arm, point: &PointCost<'_>| {
            let (node, moments) = table.known(arm, level, *at, cell, class);
            match node {
                Node::Empty => None,
                Node::Unknown => Some(NOTHING),
                Node::Known(known) => Some(point.least((known, moments), *off, half, self.region)),
            }
        };
        let own = least(table, arm, point)?;
        if others.is_empty() {
            return Some(cost_at_corners(own, self.region, aggregate));
        }
        let mut all = vec![own];
        for set in others {
            all.push(least(&set.table, &set.arm, &point.with_first(set.first))?);
        }
        Some(cost_at_corners(joined_sets(*over, all.into_iter()), self.region, aggregate))
    }

    /// From the end back: cells through which every way costs `ceiling` or more, with `others` for the other segments,
    /// become inactive.
    fn prune(&mut self, ways: &Ways, others: &[f64; CORNERS], ceiling: f64) {
        let (span, aggregate) = (&self.model.segments[ways.segment], self.model.objective.aggregate);
        let mut after = vec![INFINITE; self.active.count()];
        for (place, row) in ways.rows.iter().enumerate().rev() {
            let point = span.start + place;
            let is_end = place + 1 == span.len();
            if !is_end {
                let (low, high) = self.model.steps(self.region, &self.points, point + 1, self.width);
                self.neighbours.compute(&after, low, high);
            }
            after.fill(INFINITE);
            for (cell, cost) in row.cells.iter().zip(&row.costs) {
                let onward = if is_end { [0.0; CORNERS] } else { self.neighbours.out[*cell] };
                let sum = &row.sums[*cell];
                let through = joined(aggregate, &joined(aggregate, sum, &onward), others);
                let through = through.into_iter().fold(f64::INFINITY, f64::min);
                if through >= ceiling {
                    self.active.clear(point, ways.class, *cell);
                } else {
                    after[*cell] = joined(aggregate, &onward, cost);
                }
            }
        }
    }
}
