//! A lower bound of the objective over a box of placements, with the rate of beta: dynamic programming over cells of
//! heading at the corners of the box.
//!
//! Every cell costs an affine function of the placement, a way through the cells their sum, the best way the least of
//! these: a concave function, so its least value over the box is at a corner. Ways are taken from cell to cell where
//! some beta of the one is within the limits on beta of some beta of the other.

use super::active_cells::ActiveCells;
use super::compliance_table::{Node, NodesAt};
use super::cost::{CORNERS, NOTHING, PointCost, Without, cost_at_corners, joined_sets};
use super::model::{Model, OtherSet};
use super::region::Region;
use super::sliding_min::{INFINITE, SlidingMin, joined, min_into};
use std::f64::consts::TAU;
use stead_model::robot::PostureClass;
use stead_numerics::monitor::Monitor;
use stead_problem::beta_step::BetaStep;
use stead_problem::criterion::Aggregate;

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
        self.lower_bound_without(Without::Nothing, region, active, ceiling, monitor)
    }

    /// The same with less of its uncertainty, which is no bound.
    pub fn lower_bound_without(
        &self,
        without: Without,
        region: &Region,
        active: &ActiveCells,
        ceiling: f64,
        monitor: &Monitor,
    ) -> LowerBound {
        let (count, aggregate) = (active.count(), self.objective.aggregate);
        let mut pass = Pass {
            model: self,
            monitor,
            region,
            points: self.point_costs(region, without),
            active,
            neighbours: SlidingMin::default(),
            targets: Vec::new(),
            width: TAU / count as f64,
        };
        let (mut totals, mut sum) = ([0.0; CORNERS], 0.0);
        let (mut all, mut bests) = (Vec::new(), Vec::new());
        for segment in 0..self.segments.len() {
            let mut best = INFINITE;
            for class in PostureClass::ALL {
                let ways = pass.forward(segment, class);
                min_into(&mut best, &ways.end);
                all.push(ways);
            }
            if best[0] == f64::INFINITY {
                return LowerBound { sum: f64::INFINITY, active: active.clone() };
            }
            totals = joined(aggregate, &totals, &best);
            bests.push(best);
            // What the points of later segments cost is nowhere less than nothing.
            sum = totals.iter().copied().fold(f64::INFINITY, f64::min);
            if sum >= ceiling {
                return LowerBound { sum, active: active.clone() };
            }
        }
        for (ways, best) in all.iter_mut().zip(bests.iter().flat_map(|best| [best; 4])) {
            let others = match aggregate {
                Aggregate::Mean | Aggregate::Rms => std::array::from_fn(|k| totals[k] - best[k]),
                // Those of the other segments are below the ceiling by themselves.
                Aggregate::Max => [0.0; CORNERS],
            };
            pass.prune(ways, &others, ceiling);
        }
        let lists = self.segments.iter().zip(all.chunks(4)).flat_map(|(span, classes)| {
            let rows = move |place: usize| {
                classes.iter().map(move |ways| ways.rows.get(place).map_or(&[][..], |row| &row.cells[..]))
            };
            (0..span.len()).flat_map(rows)
        });
        LowerBound { sum, active: ActiveCells::of(active.level, count, lists) }
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
    active: &'a ActiveCells,
    neighbours: SlidingMin,
    /// The active cells of one point.
    targets: Vec<u16>,
    /// Width of a cell. rad
    width: f64,
}

/// The ways through one segment in one class.
struct Ways {
    segment: usize,
    /// A row for each point; none where there is no way.
    rows: Vec<Row>,
    /// The least sum at the end.
    end: [f64; CORNERS],
}

/// The cells of one point that some way leads to, what they cost, and the least sum up to each.
struct Row {
    cells: Vec<u16>,
    costs: Vec<[f64; CORNERS]>,
    sums: Vec<[f64; CORNERS]>,
    /// The least of the sums.
    min: [f64; CORNERS],
}

/// A point with the nodes that answer for it under each set of stiffness, and how far it is from them in radius and
/// height (m).
struct Answer<'a> {
    point: PointCost<'a>,
    nodes: NodesAt<'a>,
    others: Vec<(PointCost<'a>, NodesAt<'a>)>,
    off: [f64; 2],
}

impl<'a> Pass<'a> {
    /// The ways through a segment from its start; infinite where there is none.
    fn forward(&mut self, segment: usize, class: PostureClass) -> Ways {
        let none = Ways { segment, rows: Vec::new(), end: INFINITE };
        let span = self.model.segments[segment].clone();
        let mut rows: Vec<Row> = Vec::with_capacity(span.len());
        let mut end = INFINITE;
        for point in span {
            // Making the nodes of one point takes up to milliseconds, and there are thousands of points.
            if self.monitor.should_stop() {
                return none;
            }
            let row = self.row(point, class, rows.last());
            end = row.min;
            if end[0] == f64::INFINITY {
                return none;
            }
            rows.push(row);
        }
        Ways { segment, rows, end }
    }

    /// A point after the row of the one before: the active cells that some way leads to, and in which something is
    /// allowed.
    fn row(&mut self, point: usize, class: PostureClass, before: Option<&Row>) -> Row {
        self.targets.clear();
        self.targets.extend(self.active.cells(point, class.index()));
        if let Some(before) = before {
            let (low, high) = self.model.steps(self.region, &self.points, point, self.width);
            let (steps, count) = ((-high, -low), self.active.count());
            self.neighbours.compute(&before.cells, &before.sums, steps, count, &self.targets);
        }
        let most = self.targets.len();
        let mut row = Row {
            cells: Vec::with_capacity(most),
            costs: Vec::with_capacity(most),
            sums: Vec::with_capacity(most),
            min: INFINITE,
        };
        let answer = self.answer(point);
        for (number, cell) in self.targets.iter().enumerate() {
            let reached = before.map(|_| self.neighbours.out[number]);
            if reached.is_some_and(|sum| sum[0] == f64::INFINITY) {
                continue;
            }
            let Some(cost) = self.cost(answer.as_ref(), usize::from(*cell), class) else { continue };
            let sum = reached.map_or(cost, |sum| joined(self.model.objective.aggregate, &sum, &cost));
            row.cells.push(*cell);
            row.costs.push(cost);
            row.sums.push(sum);
            min_into(&mut row.min, &sum);
        }
        row
    }

    /// What answers for a point all over the box, if anything does.
    fn answer(&self, point: usize) -> Option<Answer<'a>> {
        let cost = self.points[point]?;
        let (Model { table, arm, others, .. }, level) = (self.model, self.active.level);
        let (nodes, off) = table.answer(arm, level, &cost.placed)?;
        let of = |set: &'a OtherSet| {
            let (nodes, _) = set.table.answer(&set.arm, level, &cost.placed)?;
            Some((cost.with_first(set.arm.joint1), nodes))
        };
        Some(Answer { point: cost, nodes, others: others.iter().map(of).collect::<Option<_>>()?, off })
    }

    /// What a point costs at least in a cell; `None` where none of its states is allowed.
    #[inline]
    fn cost(&self, answer: Option<&Answer<'_>>, cell: usize, class: PostureClass) -> Option<[f64; CORNERS]> {
        let Some(Answer { point, nodes, others, off }) = answer else { return Some([0.0; CORNERS]) };
        let (half, aggregate) = (0.5 * self.width, self.model.objective.aggregate);
        let least = |nodes: &NodesAt<'_>, point: &PointCost<'_>| {
            let (node, moments) = nodes.known(cell, class);
            match node {
                Node::Empty => None,
                Node::Unknown => Some(NOTHING),
                Node::Known(known) => Some(point.least((known, moments), *off, half, self.region)),
            }
        };
        let own = least(nodes, point)?;
        if others.is_empty() {
            return Some(cost_at_corners(own, self.region, aggregate));
        }
        let mut all = vec![own];
        for (point, nodes) in others {
            all.push(least(nodes, point)?);
        }
        Some(cost_at_corners(joined_sets(self.model.over, all.into_iter()), self.region, aggregate))
    }

    /// From the end back: cells through which every way costs `ceiling` or more, with `others` for the other segments,
    /// are left out of the rows.
    fn prune(&mut self, ways: &mut Ways, others: &[f64; CORNERS], ceiling: f64) {
        let (start, aggregate) = (self.model.segments[ways.segment].start, self.model.objective.aggregate);
        // Of the row after, the cells that are left and the least sum from each to the end.
        let (mut cells, mut after): (Vec<u16>, Vec<[f64; CORNERS]>) = (Vec::new(), Vec::new());
        let number = ways.rows.len();
        for (place, row) in ways.rows.iter_mut().enumerate().rev() {
            let is_end = place + 1 == number;
            if !is_end {
                let steps = self.model.steps(self.region, &self.points, start + place + 1, self.width);
                self.neighbours.compute(&cells, &after, steps, self.active.count(), &row.cells);
            }
            (cells, after) = (Vec::with_capacity(row.cells.len()), Vec::with_capacity(row.cells.len()));
            for (number, ((cell, cost), sum)) in row.cells.iter().zip(&row.costs).zip(&row.sums).enumerate() {
                let onward = if is_end { [0.0; CORNERS] } else { self.neighbours.out[number] };
                let through = joined(aggregate, &joined(aggregate, sum, &onward), others);
                if through.into_iter().fold(f64::INFINITY, f64::min) < ceiling {
                    cells.push(*cell);
                    after.push(joined(aggregate, &onward, cost));
                }
            }
            row.cells.clone_from(&cells);
        }
    }
}
