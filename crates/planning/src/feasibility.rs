//! Why a state or a placement is not allowed: which constraint is broken, and by how much; and the map of deflections
//! and of what forbids states along a path.

use super::redundancy::{NoFeasiblePlan, Obstruction};
use rayon::prelude::*;
use std::fmt;
use stead_cell::{PairKind, Proximity};
use stead_model::external_axis::{AxisKind, ExternalAxis};
use stead_model::robot::{Posture, PostureWords, turns::Range};
use stead_numerics::monitor::Monitor;
use stead_problem::constraints::{ConstraintKind, Measured, describe, on_joints, on_state};
use stead_problem::evaluate::reference::{ScoredByOrigin, State, scored_by_origin};
use stead_problem::problem::{BetaPlan, Placement, Problem};

/// What one posture gives at one point and beta.
#[derive(Debug, Clone, PartialEq)]
pub struct Explanation {
    /// The posture.
    pub posture: Posture,
    /// The same in words.
    pub words: PostureWords,
    /// The state with its joint angles in the turn nearest to their ranges; `None` when out of reach.
    pub state: Option<State<f64>>,
    /// The constraints broken; none means allowed.
    pub violations: Vec<Measured>,
    /// What each thing that yields adds to the scored part, where more does than the joints about their axes; of
    /// [`explain`] alone.
    pub by_origin: Option<ScoredByOrigin>,
}

impl Explanation {
    /// Whether every constraint on a single state holds.
    pub fn is_allowed(&self) -> bool {
        self.violations.is_empty()
    }

    fn severity(&self) -> f64 {
        self.violations.iter().map(Measured::severity).sum()
    }

    /// The worst of the broken constraints.
    fn worst(&self) -> Option<&Measured> {
        self.violations.iter().max_by(|a, b| a.severity().total_cmp(&b.severity()))
    }
}

/// What each of the eight postures gives at path point `point`, workpiece at a placement, free angle
/// `beta` (rad), in the order of their numbers.
pub fn explain(problem: &Problem, placement: &Placement, point: usize, beta: f64) -> [Explanation; 8] {
    without_clearance(problem, placement, point, beta).map(|mut explanation| {
        let measured =
            explanation.state.as_ref().and_then(|s| problem.clearance_constraint(point, placement, &s.joints));
        explanation.violations.extend(measured.filter(|measured| !measured.holds()));
        let state = explanation.state.as_ref().filter(|_| problem.yields_beside());
        explanation.by_origin = state.map(|s| scored_by_origin(problem, point, placement, &s.joints));
        explanation
    })
}

/// The positions of the external axes at a path point for [`explain`], in a sentence; `None` where there are none. They
/// are those of a result, or as they are at rest.
pub fn standing_axes(problem: &Problem, point: usize, is_set_up: bool) -> Option<String> {
    let at = |(axis, position): (&ExternalAxis, &f64)| match axis.kind {
        AxisKind::Rail => format!("{} at {:.1} mm", axis.name, position * 1e3),
        AxisKind::Turntable => format!("{} at {:.2} deg", axis.name, position.to_degrees()),
    };
    let axes: Vec<String> = problem.external_axes.iter().zip(problem.axis_positions(point)).map(at).collect();
    (!axes.is_empty()).then(|| {
        let axes = axes.join(", ");
        match is_set_up {
            true => format!("the external axes are where the results have them: {axes}"),
            false => format!(
                "the external axes are taken as near to zero as their ranges allow: {axes}; another \
                 range_mm or range_deg moves them"
            ),
        }
    })
}

/// That a path point counts for nothing, in a sentence; `None` where it is scored.
pub fn unscored(problem: &Problem, point: usize) -> Option<String> {
    let is_scored = problem.task.path().is_scored(point);
    (!is_scored).then(|| {
        format!("point {point} is not scored: it is followed, and its deflection, without a force, counts for nothing")
    })
}

/// The same without the shapes of the scene.
pub fn without_clearance(problem: &Problem, placement: &Placement, point: usize, beta: f64) -> [Explanation; 8] {
    Posture::ALL.map(|posture| {
        let words = problem.robot.posture_words(posture);
        let mut found = match problem.at(placement).state(point, beta, posture) {
            Err(unreachable) => {
                let violations = vec![Measured::Reach(unreachable)];
                return Explanation { posture, words, state: None, violations, by_origin: None };
            }
            Ok(found) => found,
        };
        for (angle, joint) in found.joints.iter_mut().zip(problem.robot.joints()) {
            *angle = Range::of(joint).nearest(*angle).0;
        }
        let measured = on_joints(problem, &found.joints).chain(on_state(problem, &found));
        let violations = measured.filter(|measured| !measured.holds()).collect();
        Explanation { posture, words, state: Some(found), violations, by_origin: None }
    })
}

/// Deflection over path point and beta (the paper's Fig. 7 and 9): for every grid state the smallest score over the
/// allowed postures.
#[derive(Debug, Clone, PartialEq)]
pub struct DeflectionMap {
    /// Number of grid values of beta; the k-th is `-pi + 2 pi k / beta_count`.
    pub beta_count: usize,
    /// For each path point the row of its `beta_count` states: a score (m), or the constraint that the posture nearest
    /// to being allowed breaks most.
    pub rows: Vec<MapRow>,
}

/// Why no posture of a state is allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MapReason {
    /// The constraint that the posture nearest to being allowed breaks most.
    pub kind: ConstraintKind,
    /// Number of the pair of the scene that is nearer than it may be.
    pub pair: Option<usize>,
}

/// An allowed state of a [`DeflectionMap`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapCell {
    /// The smallest score over the allowed postures. m
    pub score: f64,
    /// The posture that has it.
    pub posture: Posture,
}

/// States (path point, beta, all postures) that are still evaluated one by one after the caller has asked to stop: half
/// a second's work.
pub const AFTER_STOP: usize = 50_000;

/// A row of a [`DeflectionMap`].
pub type MapRow = Vec<Result<MapCell, MapReason>>;

/// The smallest score over the allowed postures for every path point and grid value of beta (Caro 2013, Fig. 7 and 9).
/// `None` for a large map that the caller stops.
pub fn deflection_map(problem: &Problem, placement: &Placement, monitor: &Monitor) -> Option<DeflectionMap> {
    let beta_count = problem.redundancy.beta_count;
    let points = problem.task.points().len();
    let is_stopped = || points * beta_count > AFTER_STOP && monitor.should_stop();
    let all: Vec<usize> = (0..points).collect();
    Some(DeflectionMap { beta_count, rows: deflection_rows(problem, placement, &all, is_stopped)? })
}

/// The rows of that map at some path points. `None` where the caller stops it in between.
pub fn deflection_rows(
    problem: &Problem,
    placement: &Placement,
    points: &[usize],
    is_stopped: impl Fn() -> bool + Sync,
) -> Option<Vec<MapRow>> {
    let beta_count = problem.redundancy.beta_count;
    let placement_hit = problem.placement_hit(placement);
    let cell = |point: usize, k: usize, known: &mut Proximity| {
        let all = without_clearance(problem, placement, point, problem.redundancy.beta(k));
        let mut allowed: Vec<(MapCell, [f64; 6])> = all
            .iter()
            .filter(|e| e.is_allowed())
            .filter_map(|e| e.state.as_ref().map(|s| (MapCell { score: s.score(), posture: e.posture }, s.joints)))
            .collect();
        allowed.sort_by(|a, b| a.0.score.total_cmp(&b.0.score));
        let mut hit = placement_hit;
        for (cell, joints) in &allowed {
            match placement_hit.or_else(|| problem.hit_after(known, point, placement, joints, &PairKind::OF_STATES)) {
                None => return Ok(*cell),
                found => hit = hit.or(found),
            }
        }
        if let (Some(pair), false) = (hit, allowed.is_empty()) {
            return Err(MapReason { kind: ConstraintKind::Clearance, pair: Some(pair) });
        }
        let nearest = all.iter().min_by(|a, b| a.severity().total_cmp(&b.severity()));
        let kind = nearest.and_then(Explanation::worst).map_or(ConstraintKind::Reach, Measured::kind);
        Err(MapReason { kind, pair: None })
    };
    let row = |point: &usize| {
        let mut known = Proximity::default();
        (!is_stopped()).then(|| (0..beta_count).map(|k| cell(*point, k, &mut known)).collect())
    };
    points.par_iter().map(row).collect()
}

/// Neighbouring path points of one segment that fail for the same reason.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Number of the segment, from 1.
    pub segment: usize,
    /// First and last path point, from 0.
    pub points: (usize, usize),
    /// The reason, at the state that comes nearest to being allowed, or `None` where every point has allowed states but
    /// no one posture gets from one to the next.
    pub nearest: Option<Nearest>,
    /// Where no one posture gets through: sets of limits between neighbouring points of which each, left out, lets one
    /// past the last point. None where the limits and turns of the joints stop every posture.
    pub stopped_by: Vec<Vec<ConstraintKind>>,
    /// Where beta may change.
    pub beta: BetaPlan,
}

/// The state of a blocked point that comes nearest to being allowed.
#[derive(Debug, Clone, PartialEq)]
pub struct Nearest {
    /// Its path point.
    pub point: usize,
    /// Its free angle. rad
    pub beta: f64,
    /// Its posture.
    pub posture: Posture,
    /// The same in words.
    pub words: PostureWords,
    /// What it breaks.
    pub violations: Vec<Measured>,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "segment {}, ", self.segment)?;
        match (&self.nearest, self.points) {
            (None, (_, point)) => {
                write!(
                    f,
                    "point {point}: every point has allowed states, but no posture gets here from the segment's start"
                )?;
                match &self.stopped_by[..] {
                    [] if self.beta != BetaPlan::Free => {
                        write!(f, " with one beta all along (redundancy.beta = \"{}\")", self.beta.name())
                    }
                    [] => write!(f, ", whatever the steps between points: limits and turns of the joints stop it"),
                    sets => {
                        let sets = sets.iter().map(|kinds| format!("without {}", describe(kinds).join(" and ")));
                        write!(f, "; one would {}", sets.collect::<Vec<_>>().join(", or "))
                    }
                }
            }
            (Some(nearest), (first, last)) => {
                if first == last {
                    write!(f, "point {first}")?;
                } else {
                    write!(f, "points {first} to {last}")?;
                }
                if nearest.violations.is_empty() {
                    return write!(f, ": no way past the shapes that come too near, though they leave states");
                }
                write!(
                    f,
                    ": no allowed state; nearest at point {}, beta {:.1} deg, posture {} ({}): ",
                    nearest.point,
                    nearest.beta.to_degrees(),
                    nearest.posture,
                    nearest.words
                )?;
                for (k, violation) in nearest.violations.iter().enumerate() {
                    write!(f, "{}{violation}", if k > 0 { ", and " } else { "" })?;
                }
                Ok(())
            }
        }
    }
}

/// Which constraint fails at which points of a placement that has no plan, in any posture or in a given scheme (one
/// posture per segment).
pub fn diagnose(
    problem: &Problem,
    placement: &Placement,
    scheme: Option<&[Posture]>,
    none: &NoFeasiblePlan,
) -> Vec<Finding> {
    let mut findings = blocked(problem, placement, scheme, &none.blocked_points);
    let obstruction = (!none.broken_segments.is_empty()).then(|| Obstruction::new(problem));
    let broken = none.broken_segments.par_iter().map(|(segment, point)| Finding {
        segment: segment + 1,
        points: (problem.task.segments()[*segment].start, *point),
        nearest: None,
        stopped_by: obstruction.as_ref().map(|o| o.at(placement, scheme, *segment, *point)).unwrap_or_default(),
        beta: problem.redundancy.beta,
    });
    findings.extend(broken.collect::<Vec<_>>());
    findings.sort_by_key(|finding| (finding.segment, finding.points));
    findings
}

/// The points without an allowed state, those that follow one another and fail by the same constraints together, with
/// the state of them all that comes nearest to being allowed.
fn blocked(problem: &Problem, placement: &Placement, scheme: Option<&[Posture]>, points: &[usize]) -> Vec<Finding> {
    let nearest_of = |point: usize| {
        let only = scheme.map(|postures| postures[problem.task.path().segment_of(point)]);
        let states = (0..problem.redundancy.beta_count).flat_map(|k| {
            let beta = problem.redundancy.beta(k);
            explain(problem, placement, point, beta).map(|e| (beta, e))
        });
        let states = states
            .filter(|(_, e)| only.is_none_or(|posture| e.posture == posture) && problem.postures.allows(e.posture));
        states.min_by(|a, b| a.1.severity().total_cmp(&b.1.severity()))
    };
    let nearest: Vec<_> = points.par_iter().map(|point| (*point, nearest_of(*point))).collect();
    let mut findings: Vec<(f64, Finding)> = Vec::new();
    for (point, found) in nearest {
        let Some((beta, explanation)) = found else { continue };
        let segment = problem.task.path().segment_of(point) + 1;
        let kinds: Vec<ConstraintKind> = explanation.violations.iter().map(Measured::kind).collect();
        let severity = explanation.severity();
        let Explanation { posture, words, violations, .. } = explanation;
        let nearest = Nearest { point, beta, posture, words, violations };
        if let Some((lowest, last)) = findings.last_mut()
            && last.segment == segment
            && last.points.1 + 1 == point
            && last.nearest.as_ref().is_some_and(|n| n.violations.iter().map(Measured::kind).eq(kinds.iter().copied()))
        {
            last.points.1 = point;
            if severity < *lowest {
                *lowest = severity;
                last.nearest = Some(nearest);
            }
        } else {
            let (nearest, beta) = (Some(nearest), problem.redundancy.beta);
            let finding = Finding { segment, points: (point, point), nearest, stopped_by: Vec::new(), beta };
            findings.push((severity, finding));
        }
    }
    findings.into_iter().map(|(_, finding)| finding).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::redundancy::Planner;
    use stead_model::robot::angles::yaw_from_q4;
    use stead_problem::sense::Sense;
    use stead_problem::testing::five_segments;

    #[test]
    fn explains_the_eight_postures_at_the_check_point() {
        let problem = five_segments();
        let placement = Placement::from([2.2e-3, -1.6435, -0.5564, yaw_from_q4(0.9258)]);
        let all = explain(&problem, &placement, 30, 40.0_f64.to_radians());
        assert!(all[2].is_allowed() && all[3].is_allowed());
        for e in &all {
            let Some(s) = &e.state else { continue };
            let outside =
                problem.robot.joints().iter().zip(s.joints).any(|(j, q)| q < j.min - 1e-8 || q > j.max + 1e-8);
            let told = e.violations.iter().any(|v| matches!(v, Measured::JointLimit { .. }));
            assert_eq!(outside, told);
        }
    }

    #[test]
    fn map_agrees_with_the_planner_on_what_is_allowed() {
        let mut problem = five_segments();
        problem.redundancy.beta_count = 24;
        let placement = Placement::from([0.1, -1.9, -0.4, 1.0]);
        let map = deflection_map(&problem, &placement, &Monitor::silent()).unwrap();
        let blocked = map.rows.iter().filter(|row| row.iter().all(Result::is_err)).count();
        let planner = Planner::new(&problem);
        let none = planner.plan(&placement, Sense::Min, None, &mut planner.workspace());
        assert_eq!(none.err().map_or(0, |n| n.blocked_points.len()), blocked);
        assert_eq!((map.rows.len(), map.rows[0].len()), (105, 24));
    }

    #[test]
    fn names_the_constraint_the_points_and_the_distance() {
        let mut problem = five_segments();
        problem.redundancy.beta_count = 24;
        let planner = Planner::new(&problem);
        let far = Placement::from([0.0, -4.0, -0.4, 0.0]);
        let none = planner.plan(&far, Sense::Min, None, &mut planner.workspace()).unwrap_err();
        let findings = diagnose(&problem, &far, None, &none);
        assert_eq!(findings.first().map(|f| f.points), Some((0, 20)));
        let text = findings[0].to_string();
        assert!(text.contains("segment 1, points 0 to 20") && text.contains("beyond the stretched arm"), "{text}");
        problem.constraints.min_inverse_condition = 0.95;
        let planner = Planner::new(&problem);
        let near = Placement::from([0.0, -1.8, -0.4, 0.0]);
        let none = planner.plan(&near, Sense::Min, None, &mut planner.workspace()).unwrap_err();
        let text = diagnose(&problem, &near, None, &none)[0].to_string();
        assert!(text.contains("1/kappa") && text.contains("below 0.95"), "{text}");
    }
}
