//! How a program gets from segment to segment among the surroundings of its run: the ways that `stead place` looks for,
//! found again from the plan, and what its other moves hit.

use std::sync::Arc;
use stead_numerics::digits::figures;
use stead_numerics::message::Warning;
use stead_numerics::monitor::{Monitor, Progress, Stop};
use stead_planning::redundancy::SegmentPlan;
use stead_planning::transfer_path::{AtPoint, LineEnd, ShortLine, Space, TransferPath, transfer_path};
use stead_problem::problem::Problem;
use stead_runs::plan::PlacedPlan;

/// How close to its points a program goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ends {
    /// How far the tool is retracted along its axis before and after a segment. m
    pub approach: f64,
    /// Whether corners are blended.
    pub has_blending: bool,
}

/// The ways between segments, empty where there are no surroundings, and the moves that are not free.
#[derive(Debug, Clone, Default)]
pub(super) struct TransferPaths {
    /// From each segment to the next.
    all: Vec<TransferPath>,
    /// The pairs that hit before the first segment and after the last.
    pub ends_hit: [Option<Names>; 2],
    /// Path points to which the arm cannot follow the straight move of the tool, and why.
    unfollowed: Vec<(usize, LineEnd)>,
}

/// The names of two shapes.
pub(super) type Names = Arc<[String; 2]>;

impl TransferPaths {
    /// Those of a plan, with the retraction before the first segment and after the last one in m.
    ///
    /// # Errors
    /// [`Stop`] when `monitor` asked to stop before all ways are found: a program needs them all.
    pub fn new(problem: &Problem, plan: &PlacedPlan, approach: f64, monitor: &Monitor) -> Result<Self, Stop> {
        monitor.go_on()?;
        let segments = problem.task.segments();
        let plans: Vec<SegmentPlan> = segments.iter().map(|points| segment_plan(plan, points.clone())).collect();
        let unfollowed = plans.iter().flat_map(|segment| problem.unfollowed_moves(&plan.placement, segment)).collect();
        let known = Self { unfollowed, ..Self::default() };
        let Some(space) = Space::among_shapes(problem, &plan.placement) else { return Ok(known) };
        let at = |point: usize| {
            let row = &plan.points[point];
            AtPoint { point, beta: plan.betas[point], posture: row.posture, joints: row.joints }
        };
        let total = plans.len().saturating_sub(1);
        let mut all = Vec::with_capacity(total);
        for (index, pair) in plans.windows(2).enumerate() {
            monitor.go_on()?;
            all.extend(transfer_path(problem, &plan.placement, [&pair[0], &pair[1]], index));
            monitor.report(Progress::Steps { stage: "free ways", done: index + 1, total });
        }
        let last = problem.task.points().len().checked_sub(1);
        let ends_hit = [Some(0), last].map(|point| {
            let of_arm = match space.line_end(at(point?), approach)?.end {
                LineEnd::Hit(names) => Some(names),
                _ => None,
            };
            of_arm.or_else(|| space.tool_hit(point?, approach))
        });
        Ok(Self { all, ends_hit, ..known })
    }

    /// The free way from a segment (from 0) to the next, if there is one.
    pub fn free_from(&self, segment: usize) -> Option<&TransferPath> {
        self.all.get(segment).filter(|way| way.blocked_by.is_none())
    }

    /// The free way to a segment (from 0) from the one before.
    pub fn free_to(&self, segment: usize) -> Option<&TransferPath> {
        self.free_from(segment.checked_sub(1)?)
    }

    /// The pair that hits on the move to a segment (from 0).
    pub fn hit_before(&self, segment: usize) -> Option<&Names> {
        match segment.checked_sub(1) {
            None => self.ends_hit[0].as_ref(),
            Some(previous) => self.all.get(previous)?.blocked_by.as_ref(),
        }
    }

    /// Why the arm cannot follow the line to a path point.
    pub fn unfollowed_to(&self, point: usize) -> Option<&LineEnd> {
        self.unfollowed.iter().find(|(to, _)| *to == point).map(|(_, end)| end)
    }

    /// The moves that hit, and those between path points that the arm cannot follow, in sentences.
    pub fn blocked(&self, ends: Ends) -> Vec<String> {
        let between = self.all.iter().zip(1..).filter_map(|(way, number)| {
            let [a, b] = &**way.blocked_by.as_ref()?;
            Some(format!(
                "the move from segment {number} to segment {} hits ({a} and {b}), and no free way was found",
                number + 1
            ))
        });
        let mm = ends.approach * 1e3;
        let whens = ["before the first segment", "after the last segment"];
        let at_ends = self.ends_hit.iter().zip(whens).filter_map(|(hit, when)| {
            let [a, b] = &**hit.as_ref()?;
            Some(format!("the move of {mm:.1} mm along the tool axis {when} hits ({a} and {b})"))
        });
        let unfollowed = self.unfollowed.iter().map(|(point, end)| {
            format!("the arm cannot follow the straight move of the tool to point {point} ({end})")
        });
        between.chain(at_ends).chain(unfollowed).collect()
    }

    /// What is said in the program of the lines out of the segment before a segment (from 0), and into it, that are too
    /// short.
    pub fn short_lines(&self, segment: usize) -> Vec<String> {
        let Some(way) = self.free_to(segment) else { return Vec::new() };
        let named =
            way.short_lines.iter().zip([format!("out of segment {segment}"), format!("into segment {}", segment + 1)]);
        let line = |(line, name): (&Option<ShortLine>, String)| {
            let line = line.as_ref()?;
            let [length, wanted] = [line.length, line.wanted].map(|length| figures(length * 1e3));
            Some((format!("line {name} along the tool axis {length} of {wanted} mm"), line.end.to_string()))
        };
        named.filter_map(line).map(|(what, why)| format!("{what}: {why}")).collect()
    }

    /// Warnings of moves that hit, and of lines into and out of the cut that are too short.
    pub fn warnings(&self, ends: Ends) -> Vec<Warning> {
        let hits = self.blocked(ends).into_iter().map(|text| Warning::new("blocked-move", format!("NOT FREE: {text}")));
        let short = (0..=self.all.len()).flat_map(|segment| self.short_lines(segment));
        hits.chain(short.map(|text| Warning::new("short-line", text))).collect()
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
