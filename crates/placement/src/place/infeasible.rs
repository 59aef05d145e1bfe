//! The placement that comes nearest, and why it is not allowed.

use stead_model::robot::Posture;
use stead_numerics::monitor::Monitor;
use stead_planning::feasibility::{AFTER_STOP, Finding, diagnose};
use stead_planning::redundancy::Planner;
use stead_problem::problem::Placement;
use stead_problem::sense::Sense;

/// Two shapes, or a point of the arm and a zone, that come nearer than they may in all plans tried.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BlockingPair {
    /// Their names.
    pub names: [String; 2],
    /// The path points at which they do, ascending.
    pub points: Vec<usize>,
}

impl std::fmt::Display for BlockingPair {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut runs: Vec<(usize, usize)> = Vec::new();
        for point in &self.points {
            match runs.last_mut() {
                Some((_, last)) if *last + 1 == *point => *last = *point,
                _ => runs.push((*point, *point)),
            }
        }
        let shown = runs.iter().take(RUNS_NAMED).map(|(first, last)| match last - first {
            0 => first.to_string(),
            _ => format!("{first} to {last}"),
        });
        let shown = shown.collect::<Vec<_>>().join(", ");
        let more = if runs.len() > RUNS_NAMED { " and elsewhere" } else { "" };
        let [a, b] = &self.names;
        write!(f, "{a} and {b} come too near to each other at points {shown}{more}, in plans tried")
    }
}

/// Runs of neighbouring points that are named.
const RUNS_NAMED: usize = 6;

/// Why a placement job has no result.
#[derive(Debug, Clone, PartialEq)]
pub struct Infeasible {
    /// The placement that comes nearest: of all tried the one with the fewest blocked points.
    pub placement: Placement,
    /// Whether it was the only one requested, or the nearest of a search.
    pub searched: bool,
    /// Which constraint fails at which points there; of a search that was stopped, for some of the points.
    pub findings: Vec<Finding>,
    /// Pairs of shapes that hit in the plans tried, and where.
    pub collisions: Vec<BlockingPair>,
    /// Whether the caller stopped the search before its end.
    pub interrupted: bool,
}

impl Infeasible {
    /// Where no placement that was tried has a plan, and none of them says why.
    pub(super) fn unexplained(placement: Placement, monitor: &Monitor) -> Self {
        let interrupted = monitor.should_stop();
        Self { placement, searched: true, findings: Vec::new(), collisions: Vec::new(), interrupted }
    }
}

impl std::fmt::Display for Infeasible {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Placement { x, y, z, .. } = self.placement;
        if self.searched {
            write!(f, "no feasible placement was found; the nearest is")?;
        } else {
            write!(f, "nothing is feasible at")?;
        }
        write!(
            f,
            " x = {:.1} mm, y = {:.1} mm, z = {:.1} mm, yaw = {:.2} deg (Q4 {:.4}):",
            x * 1e3,
            y * 1e3,
            z * 1e3,
            self.placement.yaw.to_degrees(),
            self.placement.q4()
        )?;
        self.findings.iter().try_for_each(|finding| write!(f, "\n  {finding}"))?;
        self.collisions.iter().try_for_each(|pair| write!(f, "\n  {pair}"))?;
        if self.searched {
            write!(f, "\na search may miss a small feasible region: more population and generations look closer")?;
        }
        Ok(())
    }
}

impl std::error::Error for Infeasible {}

/// Why a placement has no plan, in any posture or in a scheme of them. Once the caller asks to stop, some of its points
/// tell it.
pub(super) fn infeasible(
    planner: &Planner<'_>,
    placement: &Placement,
    scheme: Option<&[Posture]>,
    searched: bool,
    monitor: &Monitor,
) -> Infeasible {
    let mut none = planner.plan(placement, Sense::Min, scheme, &mut planner.workspace()).err();
    let interrupted = monitor.should_stop();
    if let (true, Some(none)) = (interrupted, &mut none) {
        none.blocked_points.truncate(AFTER_STOP / planner.problem().redundancy.beta_count);
        none.broken_segments.truncate(1);
    }
    let problem = planner.problem();
    let collisions = none.iter().flat_map(|none| &none.collisions).filter_map(|(pair, points)| {
        let names = problem.scene.as_deref()?.pair(*pair)?.names.as_ref().clone();
        Some(BlockingPair { names, points: points.iter().copied().collect() })
    });
    let collisions = collisions.collect();
    let findings = none.map(|none| diagnose(problem, placement, scheme, &none)).unwrap_or_default();
    Infeasible { placement: *placement, searched, findings, collisions, interrupted }
}
