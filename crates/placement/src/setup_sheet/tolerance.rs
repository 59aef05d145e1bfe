//! By how much a part may stand off its place before the objective grows: at every trial the best plan is made anew, in
//! the postures of the plan that the sheet is of.
//!
//! Trials are planned on the grid of beta of the run, and off it as far as such a growth needs: with the published case
//! sixty of them take a tenth of the time of the whole search when they are planned as finely as what is stated.

use crate::path_subset::PathSubset;
use crate::refine::planned;
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;
use std::borrow::Cow;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};
use stead_model::robot::Posture;
use stead_numerics::monitor::{Monitor, Progress};
use stead_planning::constraints::{Measured, describe};
use stead_planning::criterion::CANCELLATION;
use stead_planning::feasibility::diagnose;
use stead_planning::problem::{Placement, Problem};
use stead_planning::redundancy::Planner;
use stead_planning::redundancy::off_grid::Spacing;
use stead_planning::sense::Sense;

/// Shares by which the objective may grow, the smaller first.
pub const RISES: [f64; 2] = [0.01, 0.05];
/// The first trial along an axis and about one; the farthest; and how near to each other two trials may be. m, rad
const TRIALS: [[f64; 3]; 2] = [[5e-3, 0.1, 5e-5], [PI / 360.0, PI / 18.0, PI / 36000.0]];
/// The next trial is so many times as far.
const GROWTH: f64 = 5.0;
/// An offset is found to this share of itself, on the safe side.
const FINENESS: f64 = 0.2;
/// Where beta is narrowed down off the grid, it is to this: the objective is then off by less than a thousandth. rad
const LAST: f64 = 1e-3;
/// Most plans for a direction.
const MOST: usize = 14;
/// Where the objective on the grid of the run is farther above the stated one than this (relative), trials are planned
/// on the finer grid.
const AGREEMENT: f64 = 2e-3;
/// Path points that stand for a long path, beside one for every segment; paths of fewer than twice as many are planned
/// whole.
const POINTS: usize = 180;
/// Most blocked points whose reason is looked for.
const DIAGNOSED: usize = 3;

/// A way in which a part can stand off its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OffDirection {
    /// 0 to 2: along x, y, z of the frame of the sheet; 3: turned about its z axis, in the datum.
    pub axis: usize,
    /// Whether it is against the axis.
    pub is_negative: bool,
}

impl OffDirection {
    /// All eight.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..4).flat_map(|axis| [false, true].map(|is_negative| Self { axis, is_negative }))
    }

    /// Whether it is a turn.
    pub fn is_turn(self) -> bool {
        self.axis == 3
    }
}

impl std::fmt::Display for OffDirection {
    /// `+x`, `-rz`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}", if self.is_negative { '-' } else { '+' }, ["x", "y", "z", "rz"][self.axis])
    }
}

/// How far a part may be off in a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Allowed {
    /// The farthest trial up to which every one kept below the rise; the next one that did not is at most a fifth of it
    /// farther. m or rad
    pub offset: f64,
    /// Whether it is the farthest tried, so that the part may be off by more.
    pub is_more: bool,
}

/// What makes a placement infeasible on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct Blocked {
    /// The nearest trial without a plan. m or rad
    pub offset: f64,
    /// The limit that it breaks, or the two shapes that come too near, in words.
    pub by: String,
}

/// How far a part may be off in one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerance {
    /// The direction.
    pub direction: OffDirection,
    /// Until the objective has grown by each of [`RISES`].
    pub rises: [Allowed; 2],
    /// What no plan can keep, where it is met before the larger rise.
    pub blocked: Option<Blocked>,
}

/// How far a part may be off.
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerances {
    /// The objective of the best plan where the part stands as stated, by which rises are measured: planned as all
    /// trials are, on the points below. m
    pub nominal: f64,
    /// Points of the path that are planned, of all; fewer for a long path.
    pub points: [usize; 2],
    /// Plans made.
    pub plans: usize,
    /// By direction.
    pub directions: Vec<Tolerance>,
}

/// Trials of placements around one.
struct Trials<'a> {
    planner: Planner<'a>,
    placement: Placement,
    /// The posture of each segment.
    scheme: &'a [Posture],
    /// From the frame of the sheet to that of placements.
    rotation: Matrix3<f64>,
}

/// How far a part may be off a placement; a part that stands on external axes with all of them at zero. `rotation`
/// turns the frame of the sheet, in which directions are, into that of placements; their z axes are parallel. `scheme`
/// are the postures of the segments, and `stated` the objective of their plan (m).
///
/// # Errors
/// A sentence: why it is not known.
pub(super) fn tolerances(
    problem: &Problem,
    placement: &Placement,
    (scheme, stated): (&[Posture], f64),
    rotation: Matrix3<f64>,
    monitor: &Monitor,
) -> Result<Tolerances, String> {
    let problem = problem.without_tie_rule();
    let task = &problem.task;
    let (all, count) = (task.points().len(), POINTS + task.segments().len());
    let problem = match all < 2 * count {
        true => problem,
        false => Cow::Owned(PathSubset::new(task, count).of(&problem)),
    };
    let of = |planner: &Planner<'_>| planned(planner, placement, Some(scheme), &mut planner.workspace());
    let rough = spaced(Planner::new(&problem));
    let agrees = |objective: f64| problem.task.path().is_thinned() || objective <= stated * (1.0 + AGREEMENT);
    let found = of(&rough).map(|found| found.objective).filter(|objective| agrees(*objective));
    let (planner, nominal) = match found {
        Some(objective) => (rough, Some(objective)),
        None => {
            let finer = spaced(Planner::finer(&problem));
            let found = of(&finer).map(|found| found.objective);
            (finer, found)
        }
    };
    let nominal = nominal.ok_or("the placement has no plan when it is planned anew in its postures")?;
    if nominal <= CANCELLATION {
        return Err("the best plan cancels the deflection: any offset is many times as much".to_owned());
    }
    let trials = Trials { planner, placement: *placement, scheme, rotation };
    let (done, directions) = (AtomicUsize::new(0), OffDirection::all().collect::<Vec<_>>());
    let report = |done| monitor.report(Progress::Steps { stage: "tolerances", done, total: directions.len() });
    report(0);
    let one = |direction: &OffDirection| {
        let found = trials.along(*direction, nominal, monitor);
        report(done.fetch_add(1, Ordering::Relaxed) + 1);
        found
    };
    let found: Option<Vec<(Tolerance, usize)>> = directions.par_iter().map(one).collect();
    let (directions, plans): (Vec<_>, Vec<usize>) = found.ok_or(super::INTERRUPTED)?.into_iter().unzip();
    let points = [problem.task.points().len(), all];
    Ok(Tolerances { nominal, points, plans: 1 + plans.iter().sum::<usize>(), directions })
}

/// A planner that narrows beta down as far as a trial needs.
fn spaced(planner: Planner<'_>) -> Planner<'_> {
    let spacing = Spacing { last: LAST, ..Spacing::full(planner.grid()) };
    planner.with_spacing(spacing)
}

/// A trial: how far off, and the objective there.
type Trial = (f64, Option<f64>);

/// The last of the trials up to which all keep a limit, and the next, where there is one.
fn bracket(trials: &[Trial], limit: f64) -> (Trial, Option<Trial>) {
    let keeps = |trial: &&Trial| trial.1.is_some_and(|objective| objective <= limit);
    let kept = trials.iter().take_while(keeps).count();
    (kept.checked_sub(1).map_or((0.0, None), |last| trials[last]), trials.get(kept).copied())
}

/// Where the limit may be met between two trials.
fn between(low: Trial, high: Trial, limit: f64, bisects: bool) -> f64 {
    let width = high.0 - low.0;
    let share = match (low.1, high.1) {
        (Some(below), Some(above)) if !bisects && above > below => {
            // Between what a kink and what a smooth minimum would have.
            libm::pow(((limit - below) / (above - below)).max(0.0), 0.75)
        }
        _ => 0.5,
    };
    low.0 + width * share.clamp(0.1, 0.9)
}

impl Trials<'_> {
    /// The placement with the part off by so much. m or rad
    fn off(&self, direction: OffDirection, offset: f64) -> Placement {
        let offset = if direction.is_negative { -offset } else { offset };
        let mut placement = self.placement;
        if direction.is_turn() {
            placement.yaw += offset * self.rotation[(2, 2)];
            return placement;
        }
        let shift: Vector3<f64> = self.rotation.column(direction.axis) * offset;
        (0..3).for_each(|k| placement[k] += shift[k]);
        placement
    }

    /// How far the part may be off in a direction, and the number of plans made; `None` once the caller asks to stop.
    fn along(&self, direction: OffDirection, nominal: f64, monitor: &Monitor) -> Option<(Tolerance, usize)> {
        let [first, farthest, nearest] = TRIALS[usize::from(direction.is_turn())];
        let mut workspace = self.planner.workspace();
        let mut trials: Vec<Trial> = vec![(0.0, Some(nominal))];
        let mut attempt = |trials: &mut Vec<Trial>, offset: f64| {
            let found = planned(&self.planner, &self.off(direction, offset), Some(self.scheme), &mut workspace);
            let trial = (offset, found.map(|found| found.objective));
            trials.insert(trials.partition_point(|known| known.0 < offset), trial);
        };
        let limits = RISES.map(|rise| nominal * (1.0 + rise));
        let mut offset = first;
        loop {
            if monitor.should_stop() {
                return None;
            }
            attempt(&mut trials, offset);
            if bracket(&trials, limits[1]).1.is_some() || offset >= farthest {
                break;
            }
            offset = (offset * GROWTH).min(farthest);
        }
        for limit in limits.into_iter().rev() {
            let mut bisects = false;
            while let (low, Some(high)) = bracket(&trials, limit)
                && high.0 - low.0 > nearest.max(FINENESS * low.0)
                && trials.len() <= MOST
            {
                if monitor.should_stop() {
                    return None;
                }
                attempt(&mut trials, between(low, high, limit, bisects));
                bisects = !bisects;
            }
        }
        let rises = limits.map(|limit| {
            let (low, high) = bracket(&trials, limit);
            Allowed { offset: low.0, is_more: high.is_none() }
        });
        let blocked = trials.iter().find(|trial| trial.1.is_none());
        let blocked = blocked.map(|trial| Blocked { offset: trial.0, by: self.blocker(&self.off(direction, trial.0)) });
        Some((Tolerance { direction, rises, blocked }, trials.len() - 1))
    }

    /// What a placement without a plan breaks, in words.
    fn blocker(&self, placement: &Placement) -> String {
        let problem = self.planner.problem();
        let unnamed = || "limits that no plan keeps together".to_owned();
        let Err(mut none) = self.planner.plan(placement, Sense::Min, Some(self.scheme), &mut self.planner.workspace())
        else {
            return unnamed();
        };
        let pair = none.collisions.keys().next().and_then(|pair| problem.scene.as_deref()?.pair(*pair));
        if let Some(pair) = pair {
            let [a, b] = &*pair.names;
            return format!("{a} and {b}");
        }
        none.blocked_points.truncate(DIAGNOSED);
        none.broken_segments.truncate(1);
        let findings = diagnose(problem, placement, Some(self.scheme), &none);
        let worst = findings.iter().find_map(|finding| {
            let violations = &finding.nearest.as_ref()?.violations;
            violations.iter().max_by(|a, b| a.severity().total_cmp(&b.severity())).map(Measured::kind)
        });
        match (worst, findings.first()) {
            (Some(kind), _) => describe(&[kind]).join(", "),
            (None, Some(finding)) => {
                let kinds: Vec<_> = finding.stopped_by.first().cloned().unwrap_or_default();
                let words = if kinds.is_empty() {
                    "limits and turns of the joints".to_owned()
                } else {
                    describe(&kinds).join(", ")
                };
                format!("{words}, in segment {}", finding.segment)
            }
            (None, None) => unnamed(),
        }
    }
}
