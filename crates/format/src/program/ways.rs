//! How a program gets from segment to segment among the surroundings of its run: the ways that `stead place` looks for, found again from
//! the plan, and what its other moves hit.

use crate::plan::PlacedPlan;
use stead_cell::Scene;
use stead_numerics::message::Warning;
use stead_placement::problem::Problem;
use stead_placement::redundancy::SegmentPlan;
use stead_placement::settings::TransferSettings;
use stead_placement::transfer::{AtPoint, Space, Way, way};

/// How close to its points a program goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ends {
    /// How far the tool is retracted along its axis before and after a segment. m
    pub approach: f64,
    /// Whether corners are blended.
    pub has_blending: bool,
}

/// The ways between segments and the moves that are not free; empty where nothing stands around.
#[derive(Debug, Clone, Default)]
pub(super) struct Ways {
    /// From each segment to the next.
    all: Vec<Way>,
    /// The pairs of the scene that hit before the first segment and after the last.
    pub ends_hit: [Option<usize>; 2],
}

impl Ways {
    /// Those of a plan, with the retraction before the first segment and after the last one in m.
    pub fn new(problem: &Problem, settings: &TransferSettings, plan: &PlacedPlan, approach: f64) -> Self {
        let Some(space) = Space::new(problem, &plan.placement) else { return Self::default() };
        let at = |point: usize| {
            let row = &plan.points[point];
            AtPoint { point, beta: plan.betas[point], posture: row.posture, joints: row.joints }
        };
        let segments = problem.task.segments();
        let plans: Vec<SegmentPlan> = segments.iter().map(|points| segment_plan(plan, points.clone())).collect();
        let way = |(index, pair): (usize, &[SegmentPlan])| {
            way(problem, settings, &plan.placement, [&pair[0], &pair[1]], index)
        };
        let all = plans.windows(2).enumerate().filter_map(way).collect();
        let last = problem.task.points().len().checked_sub(1);
        let ends_hit = [Some(0), last].map(|point| space.retraction_hit(at(point?), approach));
        Self { all, ends_hit }
    }

    /// The free way from a segment (from 0) to the next, if there is one.
    pub fn free_from(&self, segment: usize) -> Option<&Way> {
        self.all.get(segment).filter(|way| way.blocked_by.is_none())
    }

    /// The free way to a segment (from 0) from the one before.
    pub fn free_to(&self, segment: usize) -> Option<&Way> {
        self.free_from(segment.checked_sub(1)?)
    }

    /// The number of the pair that hits on the move to a segment (from 0).
    pub fn hit_before(&self, segment: usize) -> Option<usize> {
        match segment.checked_sub(1) {
            None => self.ends_hit[0],
            Some(previous) => self.all.get(previous)?.blocked_by,
        }
    }

    /// One warning for each move that hits.
    pub fn warnings(&self, scene: Option<&Scene>, ends: Ends) -> Vec<Warning> {
        let Some(scene) = scene else { return Vec::new() };
        let between = self.all.iter().zip(1..).filter_map(|(way, number)| {
            let pair = scene.pair(way.blocked_by?)?;
            Some(format!(
                "the move from segment {number} to segment {} hits: {pair}; no free way was found, and the program goes straight over",
                number + 1
            ))
        });
        let mm = ends.approach * 1e3;
        let whens = ["before the first segment", "after the last segment"];
        let at_ends = self.ends_hit.iter().zip(whens).filter_map(|(hit, when)| {
            let pair = scene.pair((*hit)?)?;
            Some(format!("the move of {mm:.1} mm along the tool axis {when} hits: {pair}"))
        });
        between.chain(at_ends).map(|text| Warning::new("blocked-move", text)).collect()
    }
}

/// The plan of a segment as ways are looked for from it.
fn segment_plan(plan: &PlacedPlan, points: std::ops::Range<usize>) -> SegmentPlan {
    let rows = &plan.points[points.clone()];
    SegmentPlan {
        posture: rows[0].posture,
        betas: plan.betas[points.clone()].to_vec(),
        joints: rows.iter().map(|row| row.joints).collect(),
        cost: 0.0,
        points,
    }
}
