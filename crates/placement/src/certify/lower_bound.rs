//! A lower bound of what any placement of a box is worth, with the rate of beta: dynamic programming over cells of heading at
//! the corners of the box.
//!
//! Every cell costs an affine function of the placement, a way through the cells their sum, the best way the least of these:
//! a concave function, so its least value over the box is at a corner. Ways are taken from cell to cell where some beta of
//! the one is within the rate of some beta of the other.

use super::active_cells::ActiveCells;
use super::arm::Arm;
use super::compliance_table::{ComplianceTable, Node};
use super::cost::{CORNERS, PointCost};
use super::model::Yaws;
use super::region::{Point, PolarModel, Region};
use super::sliding_min::{NOTHING, SlidingMin, least, plus};
use std::f64::consts::TAU;
use std::ops::Range;
use stead_model::robot::PostureClass;

/// Steps over more cells than there are.
const ANYWHERE: (isize, isize) = (-1_000_000, 1_000_000);

/// What is to be model, prepared.
#[derive(Debug)]
pub(super) struct Model {
    pub arm: Arm,
    pub table: ComplianceTable,
    pub points: Vec<Point>,
    pub segments: Vec<Range<usize>>,
    /// Largest change of beta from the point before. rad; infinite without the rate
    pub rates: Vec<f64>,
    /// Compliance of joint 1. rad/(N m)
    pub first: f64,
    pub yaws: Yaws,
}

#[derive(Debug, Clone)]
pub(super) struct LowerBound {
    /// Least sum of the scores; infinite where nothing is feasible. m
    pub sum: f64,
    pub active: ActiveCells,
}

impl Model {
    /// The finest level whose nodes answer for every point of a box that is surely off axis 1; `None` for a box that is too
    /// large, or where there is no such point.
    pub fn level(&self, region: &Region) -> Option<usize> {
        let mut placed = self.points.iter().filter_map(|p| p.over(region)).peekable();
        placed.peek()?;
        placed.try_fold(usize::MAX, |level, placed| {
            Some(level.min(self.table.level(placed.reach[0].max(placed.reach[1]))?))
        })
    }

    /// Where a point is over a box; `None` where some of it may be nearer to axis 1 than tables reach, so that nothing is known.
    ///
    /// Tables hold every radius of the cell beyond that, and every height ([`super::prepare`]).
    pub fn placed(&self, point: usize, region: &Region) -> Option<PolarModel> {
        let placed = self.points[point].over(region)?;
        // A point is never nearer to axis 1 than the workpiece origin less its distance from there.
        let nearest = region.middle[0] - region.half[0] - self.points[point].distance;
        let least = nearest.max(placed.r - placed.reach[0]);
        if least < self.table.grid().0.radius.0 - 1e-9 { None } else { Some(placed) }
    }

    /// Every point over a box, where something is known of it.
    pub fn point_costs(&self, region: &Region) -> Vec<Option<PointCost>> {
        let placed = (0..self.points.len()).map(|point| self.placed(point, region));
        placed.zip(&self.points).map(|(placed, p)| Some(PointCost::new(p, placed?, self.first))).collect()
    }

    /// Bounds a box from below, on the level of the active; cells through which every way costs `ceiling` (m, sum) or more
    /// leave the active.
    ///
    /// A point that tables do not answer for, whether the box is too large for the level, or may have it near axis 1, costs
    /// nothing and loses no cell, and beta may step anywhere from it and to it. What the box is worth is up to the others.
    pub fn lower_bound(&self, region: &Region, active: &ActiveCells, ceiling: f64) -> LowerBound {
        let mut active = active.clone();
        let count = active.count();
        let width = TAU / count as f64;
        let points = self.point_costs(region);
        let mut totals = [0.0; CORNERS];
        let mut all: Vec<Ways> = Vec::new();
        let mut bests = Vec::new();
        let mut sliding = SlidingMin::new(count);
        for (segment, span) in self.segments.iter().enumerate() {
            let mut best = NOTHING;
            for class in PostureClass::ALL {
                let mut ways = Ways { segment, class: class.index(), rows: Vec::with_capacity(span.len()) };
                let mut end = NOTHING;
                for (place, point) in span.clone().enumerate() {
                    if place > 0 {
                        let (low, high) = self.steps(region, &points, point, width);
                        sliding.least(&ways.rows[place - 1].sums, -high, -low);
                    }
                    let mut row = Row { cells: Vec::new(), costs: Vec::new(), sums: vec![NOTHING; count] };
                    end = NOTHING;
                    let found = points[point].as_ref().and_then(|p| {
                        let placed = &p.placed;
                        let answers = self.table.answers(active.level, [placed.reach[0], placed.reach[1]]);
                        let (at, off) = self.table.nearest(active.level, placed.r, placed.z).filter(|_| answers)?;
                        Some((p, at, off))
                    });
                    let cells: Vec<usize> = active.cells(point, class.index()).collect();
                    for cell in cells {
                        if place > 0 && sliding.out[cell][0] == f64::INFINITY {
                            active.clear(point, class.index(), cell);
                            continue;
                        }
                        let cost = match found {
                            None => [0.0; CORNERS],
                            Some((p, at, off)) => match self.table.node(&self.arm, active.level, at, cell, class) {
                                Node::Empty => {
                                    active.clear(point, class.index(), cell);
                                    continue;
                                }
                                Node::Unknown => [0.0; CORNERS],
                                Node::Known(known) => p.least(known, off, 0.5 * width, region),
                            },
                        };
                        let sum = if place == 0 { cost } else { plus(&sliding.out[cell], &cost) };
                        row.sums[cell] = sum;
                        row.cells.push(cell);
                        row.costs.push(cost);
                        least(&mut end, &sum);
                    }
                    ways.rows.push(row);
                    if end[0] == f64::INFINITY {
                        break;
                    }
                }
                if end[0] == f64::INFINITY {
                    span.clone().for_each(|point| active.clear_all(point, class.index()));
                    continue;
                }
                least(&mut best, &end);
                all.push(ways);
            }
            if best[0] == f64::INFINITY {
                return LowerBound { sum: f64::INFINITY, active };
            }
            totals = plus(&totals, &best);
            bests.push(best);
        }
        let sum = totals.iter().copied().fold(f64::INFINITY, f64::min);
        if sum >= ceiling {
            return LowerBound { sum, active };
        }
        // From the ends back: what leads to no good leaves the active.
        for ways in &all {
            let span = &self.segments[ways.segment];
            let others: [f64; CORNERS] = std::array::from_fn(|k| totals[k] - bests[ways.segment][k]);
            let mut after = vec![NOTHING; count];
            for (place, row) in ways.rows.iter().enumerate().rev() {
                let point = span.start + place;
                let is_end = place + 1 == span.len();
                if !is_end {
                    let (low, high) = self.steps(region, &points, point + 1, width);
                    sliding.least(&after, low, high);
                }
                after.fill(NOTHING);
                for (cell, cost) in row.cells.iter().zip(&row.costs) {
                    let onward = if is_end { [0.0; CORNERS] } else { sliding.out[*cell] };
                    let sum = &row.sums[*cell];
                    let through = (0..CORNERS).map(|k| sum[k] + onward[k] + others[k]).fold(f64::INFINITY, f64::min);
                    if through >= ceiling {
                        active.clear(point, ways.class, *cell);
                    } else {
                        after[*cell] = plus(&onward, cost);
                    }
                }
            }
        }
        LowerBound { sum, active }
    }

    /// From which to which number of cells a way may step up, to `point` from the one before.
    ///
    /// Beta is the heading less the direction of the feed (or the other way round), both against the azimuth of the point.
    pub fn steps(&self, region: &Region, points: &[Option<PointCost>], point: usize, width: f64) -> (isize, isize) {
        let (Some(before), Some(here)) = (&points[point - 1], &points[point]) else { return ANYWHERE };
        let (before, here) = (&before.placed, &here.placed);
        let [a, _, g] = region.half;
        let unsure = (here.slope_chi[0] - before.slope_chi[0]).abs() * a
            + (here.slope_chi[1] - before.slope_chi[1]).abs() * g
            + here.remainder_chi
            + before.remainder_chi;
        let turned = here.chi - before.chi;
        let turned = turned - TAU * (turned / TAU).round();
        let most = (self.rates[point] + unsure) / width + 1.0 + 1e-6;
        if most >= 1e6 {
            return ANYWHERE;
        }
        let shift = turned / width;
        ((shift - most).ceil() as isize, (shift + most).floor() as isize)
    }
}

/// The ways through one segment in one class.
struct Ways {
    segment: usize,
    class: usize,
    rows: Vec<Row>,
}

/// The cells of one point, their costs, and for every cell the least sum up to it.
struct Row {
    cells: Vec<usize>,
    costs: Vec<[f64; CORNERS]>,
    sums: Vec<[f64; CORNERS]>,
}
