//! What bounds are made of: the arm, how it yields all over the cell, and the path points.

use super::arm::Arm;
use super::cell::{Yaws, extent, points_of};
use super::compliance_table::{ComplianceTable, Steps};
use super::cost::{PointCost, Without};
use super::load::Objective;
use super::region::{Point, PolarModel, Region};
use std::ops::Range;
use std::sync::Arc;
use stead_model::robot::Robot;
use stead_problem::beta_step::BetaStep;
use stead_problem::criterion::Over;
use stead_problem::problem::{Cell, Problem};
use stead_problem::symmetry::Upright;

/// Steps of the coarsest tables, and their number.
pub(super) const STEPS: Steps = Steps { length: 0.025, headings: 128 };
pub(super) const LEVELS: usize = 6;

/// Which limits on beta along the path a bound keeps. Where both are set, that is the rate of beta alone: the two
/// together can leave two ranges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Keeps {
    pub with_rate: bool,
    pub with_turn: bool,
}

impl Keeps {
    pub const NOTHING: Self = Self { with_rate: false, with_turn: false };

    /// What a bound can keep of the limits of a problem.
    pub fn of(problem: &Problem) -> Self {
        let limits = &problem.redundancy;
        let with_rate = limits.max_beta_rate.is_some();
        let turns = limits.max_spindle_turn.is_some() || limits.max_spindle_speed.is_some();
        Self { with_rate, with_turn: turns && !with_rate }
    }
}

/// The arm with another set of stiffness than the first.
#[derive(Debug)]
pub(super) struct OtherSet {
    pub arm: Arm,
    pub table: ComplianceTable,
}

/// What is to be bounded, prepared.
#[derive(Debug)]
pub(super) struct Model {
    pub arm: Arc<Arm>,
    pub table: Arc<ComplianceTable>,
    pub points: Vec<Point>,
    pub segments: Vec<Range<usize>>,
    /// Which limits on beta along the path are kept.
    pub keeps: Keeps,
    /// Changes of the heading from the point before, less that of the direction of the feed, that the limits on beta
    /// allow. rad
    pub changes: Vec<BetaStep>,
    /// The same arm with the other sets of stiffness that a score covers, where there are several.
    pub others: Arc<[OtherSet]>,
    /// How the scores under the sets make up that of a point.
    pub over: Over,
    pub yaws: Yaws,
    /// How the costs of the points make up the figure that is minimised.
    pub objective: Objective,
}

impl Model {
    /// Of a problem.
    pub fn new(problem: &Problem) -> Self {
        let (extent, keeps) = (extent(problem), Keeps::of(problem));
        let arm = |robot: &Robot| Arm::new(problem, robot, extent.radius.0);
        let table = || ComplianceTable::new(extent, STEPS, LEVELS);
        let robots = problem.scored_robots();
        let other = |robot: &Robot| OtherSet { arm: arm(robot), table: table() };
        // A growing beta turns the spindle about axis 1 or against it.
        let sign = Upright::of(problem).map_or(1.0, |upright| upright.rotation_sign);
        let change = |point: usize| match problem.redundancy.max_beta_rate {
            _ if point == 0 => BetaStep::ANY,
            Some(rate) if keeps.with_rate => BetaStep { middle: 0.0, half: rate * problem.step_length(point) },
            None if keeps.with_turn => {
                let BetaStep { middle, half } = problem.beta_step(point);
                BetaStep { middle: sign * middle, half }
            }
            _ => BetaStep::ANY,
        };
        let points = points_of(problem);
        Self {
            arm: Arc::new(arm(&robots[0])),
            table: Arc::new(table()),
            keeps,
            changes: (0..points.len()).map(change).collect(),
            points,
            segments: problem.task.segments().to_vec(),
            others: robots[1..].iter().map(other).collect(),
            over: problem.criterion.stiffness.as_ref().map_or(Over::Mean, |sets| sets.over),
            yaws: Yaws::new(problem),
            objective: Objective::of(problem),
        }
    }

    /// Of a problem whose cell is made of pieces.
    pub fn of(problem: &Problem, pieces: &[Cell]) -> Self {
        Self { yaws: Yaws::of(pieces, problem), ..Self::new(problem) }
    }

    /// The same of one of the segments alone, with the same tables.
    pub fn on_segment(&self, segment: usize) -> Self {
        let span = self.segments[segment].clone();
        Self {
            arm: Arc::clone(&self.arm),
            table: Arc::clone(&self.table),
            others: Arc::clone(&self.others),
            points: self.points[span.clone()].to_vec(),
            segments: std::iter::once(0..span.len()).collect(),
            changes: self.changes[span].to_vec(),
            yaws: self.yaws.clone(),
            ..*self
        }
    }

    /// The finest level whose nodes answer for every point of a box that is surely off axis 1; `None` for a box that is
    /// too large, or where there is no such point.
    pub fn level(&self, region: &Region) -> Option<usize> {
        let mut placed = self.points.iter().filter_map(|p| p.over(region)).peekable();
        placed.peek()?;
        placed.try_fold(usize::MAX, |level, placed| {
            Some(level.min(self.table.level(placed.reach[0].max(placed.reach[1]))?))
        })
    }

    /// Where a point is over a box; `None` where some of it may be nearer to axis 1 than tables reach, so that nothing
    /// is known.
    ///
    /// Tables hold every radius of the cell beyond that, and every height ([`super::cell::extent`]).
    pub fn placed(&self, point: usize, region: &Region) -> Option<PolarModel> {
        let placed = self.points[point].over(region)?;
        // A point is never nearer to axis 1 than the workpiece origin less its distance from there.
        let nearest = region.middle[0] - region.half[0] - self.points[point].distance;
        let min_r = nearest.max(placed.r - placed.reach[0]);
        if min_r < self.table.grid().0.radius.0 - 1e-9 { None } else { Some(placed) }
    }

    /// What the tables take. bytes
    pub fn used(&self) -> u64 {
        self.others.iter().map(|set| set.table.used()).sum::<u64>() + self.table.used()
    }

    /// Every point over a box, where something is known of it.
    pub fn point_costs(&self, region: &Region, without: Without) -> Vec<Option<PointCost<'_>>> {
        let placed = (0..self.points.len()).map(|point| self.placed(point, region));
        let of = |(placed, p)| Some(PointCost::new(p, placed?, self.arm.joint1).without(without));
        placed.zip(&self.points).map(of).collect()
    }
}
