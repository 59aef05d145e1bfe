//! How far the tool may lean from the axis that the path states: in lead and tilt, at every path point.

use crate::cell::Interval;
use crate::limit::Limit;
use nalgebra::Vector3;
use stead_model::task::lean::{ContactRule, Lean, LeanError, LeanRule, between};
use stead_model::task::{PathPoint, ToolPath};

/// Angles that differ by less are one. rad
const ROUNDING: f64 = 1e-9;
/// The tool axis turns by no more than this from one point to the next, where that of the path turns by less. rad
const MOST_TURN: f64 = std::f64::consts::PI / 12.0;

/// A turn from which the error of the contact is extrapolated. rad
const SMALL_TURN: f64 = 0.01;

/// Points of a path on which lead and tilt are planned, at the most.
pub const MOST_PLANNED_POINTS: usize = 400;

/// Lead and tilt that a point allows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeanRange {
    /// Lead. rad
    pub lead: Interval,
    /// Tilt. rad
    pub tilt: Interval,
}

impl LeanRange {
    /// The axis of the path alone.
    pub const NONE: Self = Self { lead: Interval { min: 0.0, max: 0.0 }, tilt: Interval { min: 0.0, max: 0.0 } };

    /// Whether it is the axis of the path alone.
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// Whether a lean is in it, up to rounding.
    pub fn contains(&self, lean: &Lean) -> bool {
        let is_in = |range: &Interval, value: f64| value >= range.min - ROUNDING && value <= range.max + ROUNDING;
        is_in(&self.lead, lean.lead) && is_in(&self.tilt, lean.tilt)
    }

    /// The nearest lean that is in it, lead and tilt each by itself.
    pub fn nearest(&self, lean: &Lean) -> Lean {
        let within = |range: &Interval, value: f64| value.max(range.min).min(range.max);
        Lean { lead: within(&self.lead, lean.lead), tilt: within(&self.tilt, lean.tilt) }
    }
}

/// How far the tool may lean along a path.
#[derive(Debug, Clone, PartialEq)]
pub struct LeanSpace {
    /// What stays where it is.
    pub rule: LeanRule,
    /// For every path point.
    pub ranges: Vec<LeanRange>,
    /// The largest angle between the tool axis and that of the path, where one is set. rad
    pub max_lean: Option<f64>,
    /// Steps of lead and tilt that are planned on at first. rad
    pub steps: [f64; 2],
    /// Distance between passes side by side, where it is known. m
    pub step_over: Option<f64>,
    /// The highest ridge that may be left between passes, where one is set. m
    pub scallop: Option<f64>,
    /// How far the contact may leave its line between points. m
    pub contact_tolerance: f64,
}

/// A tool that may lean as it cannot.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum LeanSpaceError {
    /// Ranges for another number of points.
    #[error("the tool may lean at {found} points, and the path has {expected}")]
    Points {
        /// Ranges.
        found: usize,
        /// Points.
        expected: usize,
    },
    /// A lean that the cutter does not allow.
    #[error("point {point}, lead {lead_deg:.3} deg, tilt {tilt_deg:.3} deg: {error}", point = point + 1)]
    Refused {
        /// The path point, from 0.
        point: usize,
        /// Lead. deg
        lead_deg: f64,
        /// Tilt. deg
        tilt_deg: f64,
        /// Why not.
        error: LeanError,
    },
    /// No lean of a point is allowed.
    #[error("point {point} has no lean that is allowed: {what}", point = point + 1)]
    Nothing {
        /// The path point, from 0.
        point: usize,
        /// Which limit leaves none.
        what: &'static str,
    },
}

impl LeanSpace {
    /// Whether the tool keeps to the axis of the path everywhere.
    pub fn is_closed(&self) -> bool {
        self.ranges.iter().all(LeanRange::is_none)
    }

    /// Whether the axis of the path itself is among what is allowed at every point: then a plan is never worse than
    /// one that keeps to it.
    pub fn holds_path(&self, path: &ToolPath) -> bool {
        (0..self.ranges.len()).all(|point| self.allows(path, point, &Lean::NONE))
    }

    /// For some points of the path alone, ascending.
    pub(crate) fn on_points(&self, points: &[usize]) -> Self {
        Self { ranges: points.iter().map(|point| self.ranges[*point]).collect(), ..self.clone() }
    }

    /// Checks that the cutter can lean over the whole of the ranges of an upright path, which is so where it can at
    /// their corners.
    ///
    /// # Errors
    /// [`LeanSpaceError`] at the first point where it cannot.
    pub fn check(&self, path: &ToolPath) -> Result<(), LeanSpaceError> {
        if self.ranges.len() != path.points().len() {
            return Err(LeanSpaceError::Points { found: self.ranges.len(), expected: path.points().len() });
        }
        for (point, range) in self.ranges.iter().enumerate() {
            let refused = |lean: Lean, error: LeanError| {
                let (lead_deg, tilt_deg) = (lean.lead.to_degrees(), lean.tilt.to_degrees());
                LeanSpaceError::Refused { point, lead_deg, tilt_deg, error }
            };
            let tilt = if range.tilt.max > -range.tilt.min { range.tilt.max } else { range.tilt.min };
            // Whatever the largest angle is, which leaves some of the tilt.
            if tilt != 0.0 && self.rule.end.is_flat() {
                return Err(refused(Lean { lead: 0.0, tilt }, LeanError::FlatTilt));
            }
            let corners = [range.lead.min, range.lead.max]
                .into_iter()
                .flat_map(|lead| [range.tilt.min, range.tilt.max].map(|tilt| Lean { lead, tilt }));
            for lean in corners.filter(|lean| *lean != Lean::NONE && self.is_within(lean)) {
                let normal = path.surface_normals().map(|normals| &normals[point]);
                self.rule.check(&path.points()[point], normal, &lean).map_err(|error| refused(lean, error))?;
            }
            if range.is_none() {
                continue;
            }
            if let Some((lean, error)) = self.through_normal(path, point) {
                return Err(refused(lean, error));
            }
            let all = self.grid(point, self.half_counts());
            let within = || all.iter().filter(|lean| self.is_within(lean));
            if within().next().is_none() {
                let what = "lead and tilt together are more than max_lean_deg in the whole range";
                return Err(LeanSpaceError::Nothing { point, what });
            }
            // Beyond the largest angle no corner was looked at.
            if self.max_lean.is_some() {
                let normal = path.surface_normals().map(|normals| &normals[point]);
                for lean in within().filter(|lean| **lean != Lean::NONE) {
                    self.rule.check(&path.points()[point], normal, lean).map_err(|error| refused(*lean, error))?;
                }
            }
            if !all.iter().any(|lean| self.allows(path, point, lean)) {
                return Err(LeanSpaceError::Nothing {
                    point,
                    what: "scallop_mm or step_over_mm forbids the whole range",
                });
            }
        }
        Ok(())
    }

    /// The lean of a point that is nearest to the normal of the surface, where it is too near for a contact that stays.
    fn through_normal(&self, path: &ToolPath, point: usize) -> Option<(Lean, LeanError)> {
        let normal = path.surface_normals()?[point];
        let (at, range) = (&path.points()[point], &self.ranges[point]);
        let lean = range.nearest(&lean_of(at, &normal));
        match self.rule.check(at, Some(&normal), &lean) {
            Err(error @ LeanError::ThroughNormal { .. }) => Some((lean, error)),
            _ => None,
        }
    }

    /// Whether a lean is within the largest angle.
    fn is_within(&self, lean: &Lean) -> bool {
        self.max_lean.is_none_or(|max| lean.angle() <= max + ROUNDING)
    }

    /// Whether a lean is allowed at a point of an upright path: within its range and with no [margin](Self::margins)
    /// below zero.
    pub fn allows(&self, path: &ToolPath, point: usize, lean: &Lean) -> bool {
        if !self.ranges[point].contains(lean) {
            return false;
        }
        let is_kept = |margin: Option<f64>| margin.is_none_or(|margin| margin >= -ROUNDING);
        *lean == Lean::NONE && self.ranges[point].is_none() || self.margins(path, point, lean).into_iter().all(is_kept)
    }

    /// How far a lean is from what bounds it beside its range, in the order of [`LeanSpace::LIMITS`]: by how much it is
    /// less than the largest angle (rad), by which share the ridge is lower than it may be, and, where a plane stays,
    /// by how much the contact is less far aside than half the distance between passes (m); none where nothing is set.
    pub fn margins(&self, path: &ToolPath, point: usize, lean: &Lean) -> [Option<f64>; 3] {
        let angle = self.max_lean.map(|max| max - lean.angle());
        let ridge = self.scallop.and_then(|most| Some(1.0 - self.rule.end.scallop(lean, self.step_over)? / most));
        [angle, ridge, self.margin_aside(path, point, lean)]
    }

    /// What the [margins](Self::margins) are to.
    pub const LIMITS: [Limit; 3] = [Limit::MaxLean, Limit::Scallop, Limit::StepOver];

    fn margin_aside(&self, path: &ToolPath, point: usize, lean: &Lean) -> Option<f64> {
        let step = self.step_over.filter(|_| self.rule.contact == ContactRule::Plane && lean.tilt != 0.0)?;
        let at = &path.points()[point];
        let normal = path.surface_normals().map_or(at.axis, |normals| normals[point]);
        let (end, left) = (&self.rule.end, at.normal());
        let aside = |at: &PathPoint| {
            let contact = end.contact(&at.position, &at.axis, &normal);
            contact.map_or(0.0, |contact| (contact - path.points()[point].position).dot(&left))
        };
        let shift = aside(&self.rule.leaned(at, Some(&normal), lean)) - aside(at);
        Some(step / 2.0 - shift.abs())
    }

    /// Whether the tool axis may go from one lean to another between two points of an upright path, the second of which
    /// is told: as far as the contact stays near its line between them, and as the axis of the path turns in any case.
    /// In a thinned path the axis turns evenly over the steps that are left out.
    pub fn allows_step(&self, path: &ToolPath, point: usize, leans: [&Lean; 2]) -> bool {
        let at = [point - 1, point].map(|point| &path.points()[point]);
        let [from, to] = [0, 1].map(|k| leans[k].axis(at[k]));
        let turn = between(&from, &to);
        if turn <= between(&at[0].axis, &at[1].axis) + ROUNDING {
            return true;
        }
        let part = path.largest_part(point);
        if turn * part > MOST_TURN + ROUNDING {
            return false;
        }
        let normal = |k: usize| path.surface_normals().map_or(at[k].axis, |normals| normals[point - 1 + k]);
        let pieces = (1.0 / part - ROUNDING).ceil() as usize;
        let along = |share: f64| turned([&from, &to], turn, share);
        (0..pieces).all(|piece| {
            // The longest of the steps that are left out, wherever it is.
            let first = (1.0 - part) * piece as f64 / pieces.saturating_sub(1).max(1) as f64;
            let axes = if pieces == 1 { [from, to] } else { [along(first), along(first + part)] };
            let error = |k: usize| self.rule.error_between(&normal(k), [&axes[0], &axes[1]]);
            error(0).max(error(1)) <= self.contact_tolerance * (1.0 + ROUNDING)
        })
    }

    /// About how far the tool axis may turn on the way to a point, from a lean at the point before to one there. rad
    pub fn most_turn(&self, path: &ToolPath, point: usize, leans: [&Lean; 2]) -> f64 {
        let at = [point - 1, point].map(|point| &path.points()[point]);
        let [from, mut to] = [0, 1].map(|k| leans[k].axis(at[k]));
        if between(&from, &to) < SMALL_TURN {
            let ahead = Lean { lead: leans[1].lead + SMALL_TURN, ..*leans[1] };
            to = ahead.axis(at[1]);
        }
        let turn = between(&from, &to);
        let normal = |k: usize| path.surface_normals().map_or(at[k].axis, |normals| normals[point - 1 + k]);
        let error = |k: usize| self.rule.error_between(&normal(k), [&from, &to]);
        // The error is as the square of the turn, to a good approximation.
        let by_contact = turn * (self.contact_tolerance / error(0).max(error(1))).sqrt();
        by_contact.min(MOST_TURN / path.largest_part(point)).max(between(&at[0].axis, &at[1].axis))
    }

    /// About how far the tool axis may turn in one step of a path, from the middle of the ranges of its points. rad
    pub fn usual_turn(&self, path: &ToolPath) -> f64 {
        let allows = |turn: f64| {
            let at_point = |(point, range): (usize, &LeanRange)| {
                let at = &path.points()[point];
                let normal = path.surface_normals().map_or(at.axis, |normals| normals[point]);
                let middle = Lean { lead: middle(&range.lead), tilt: middle(&range.tilt) };
                let ends = [-0.5, 0.5].map(|half| Lean { lead: middle.lead + half * turn, ..middle }.axis(at));
                self.rule.error_between(&normal, [&ends[0], &ends[1]]) <= self.contact_tolerance
            };
            self.ranges.iter().enumerate().filter(|(_, range)| !range.is_none()).all(at_point)
        };
        let (mut low, mut high) = (0.0, MOST_TURN);
        if allows(high) {
            return high;
        }
        for _ in 0..20 {
            let half = (low + high) / 2.0;
            if allows(half) { low = half } else { high = half }
        }
        low
    }

    /// Steps to either side of the middle of lead and tilt, with which none is larger than the given ones.
    pub fn half_counts(&self) -> [usize; 2] {
        let half = |of: &dyn Fn(&LeanRange) -> Interval, step: f64| {
            let reach = |range: Interval| {
                let holds_zero = range.min <= 0.0 && range.max >= 0.0;
                if holds_zero { range.max.max(-range.min) } else { (range.max - range.min) / 2.0 }
            };
            let most = self.ranges.iter().map(|range| reach(of(range))).fold(0.0, f64::max);
            (most / step - ROUNDING).ceil().max(0.0) as usize
        };
        [half(&|range| range.lead, self.steps[0]), half(&|range| range.tilt, self.steps[1])]
    }

    /// About how much memory planning takes with so many values of beta. Bytes
    pub fn memory(&self, beta_count: usize) -> u64 {
        let leans: usize = self.half_counts().iter().map(|half| 2 * half + 1).product();
        // Where each state of a class came from, and the scores and joint angles of two points, their rows continued.
        let links = MOST_PLANNED_POINTS.min(self.ranges.len()) * 4 * 4;
        let rows = 2 * 4 * 13 * 3 * 8;
        ((links + rows) * leans * beta_count) as u64
    }

    /// Values of lead and tilt of a point, so many to either side of the middle: of zero, where it is in the range.
    pub fn grid(&self, point: usize, half: [usize; 2]) -> Vec<Lean> {
        let LeanRange { lead, tilt } = self.ranges[point];
        let tilts = values(&tilt, half[1]);
        values(&lead, half[0])
            .into_iter()
            .flat_map(|lead| tilts.iter().map(move |tilt| Lean { lead, tilt: *tilt }))
            .collect()
    }
}

/// The lean that a point between two others has where the tool axis turns evenly from the lean of one to that of the
/// other, a share of the way from the first.
pub fn lean_between(path: &ToolPath, ends: [(usize, Lean); 2], point: usize, share: f64) -> Lean {
    let [from, to] = ends.map(|(point, lean)| lean.axis(&path.points()[point]));
    let turn = between(&from, &to);
    let axis = if turn > ROUNDING { turned([&from, &to], turn, share) } else { from };
    lean_of(&path.points()[point], &axis)
}

/// An axis turned a share of the way from one to another, which it is apart from by an angle above zero.
fn turned(axes: [&Vector3<f64>; 2], turn: f64, share: f64) -> Vector3<f64> {
    (axes[0] * libm::sin((1.0 - share) * turn) + axes[1] * libm::sin(share * turn)).normalize()
}

/// The lean with which the tool axis of a point is along a unit vector.
fn lean_of(at: &PathPoint, axis: &Vector3<f64>) -> Lean {
    let seen = at.workpiece_from_point().tr_mul(axis);
    Lean { lead: libm::atan2(seen.x, seen.z), tilt: libm::asin(seen.y.clamp(-1.0, 1.0)) }
}

/// Values of a range, `half` to either side of the middle.
fn values(range: &Interval, half: usize) -> Vec<f64> {
    let middle = middle(range);
    let at = |k: usize| match k.cmp(&half) {
        std::cmp::Ordering::Equal => middle,
        std::cmp::Ordering::Less => middle + (range.min - middle) * ((half - k) as f64 / half as f64),
        std::cmp::Ordering::Greater => middle + (range.max - middle) * ((k - half) as f64 / half as f64),
    };
    (0..=2 * half).map(at).collect()
}

/// Zero, where it is in a range, or else its middle.
fn middle(range: &Interval) -> f64 {
    if range.min <= 0.0 && range.max >= 0.0 { 0.0 } else { (range.min + range.max) / 2.0 }
}
