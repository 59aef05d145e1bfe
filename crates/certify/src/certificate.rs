//! The certificate: bounds around the best and the worst placement found, what they relax, and how they ended.

use super::branch_and_bound::{Bound, OpenIn, Status};
use super::cell::NEAREST;
use super::part::{Part, expected_cost, left_out_between_segments, together};
use super::region::Region;
use super::relaxed::relaxed_value;
use super::worst::{certifiable_from_above, worst};
use serde::{Serialize, Serializer};
use std::time::{Duration, Instant};
use stead_numerics::digits::{figures, trimmed};
use stead_numerics::message::Warning;
use stead_numerics::monitor::{Monitor, Stop};
use stead_problem::constraints::{ConstraintKind, describe, relaxed};
use stead_problem::criterion::CANCELLATION;
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;
use stead_problem::settings::CertificateSettings;
use stead_problem::symmetry::{Unsupported, require_certain_compliances, require_free_beta, require_no_travel};

/// Gaps in per cent are rounded up to this many decimals.
const GAP_DECIMALS: usize = 4;
/// Bounds in mm are rounded to this many decimals, to the side where they still hold.
pub const BOUND_DECIMALS: usize = 7;
/// A gap up to this says that a placement is about the best, one up to the next that it is none of the poor ones. %
const CLOSE_PERCENT: f64 = 5.0;
const WIDE_PERCENT: f64 = 25.0;
/// Wider gaps are none to speak of.
pub const MAX_GAP_PERCENT: f64 = 1000.0;

/// A constraint of the problem that a bound does not evaluate.
pub type Relaxation = ConstraintKind;

/// How far the placements found are from the best and the worst there are.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Certificate {
    /// What was requested, without the time limit where an earlier deadline of the caller stood in its place.
    pub settings: CertificateSettings,
    /// No placement is better by more than a gap, or why there is no bound.
    pub best: Result<Proof, NoProof>,
    /// No placement is worse by more than a gap, or why there is no bound.
    pub worst: Result<Proof, NoProof>,
    /// Why it falls short of what was requested.
    pub warnings: Vec<Warning>,
    /// Time on the clock. s
    pub wall: f64,
}

/// A bound, and what it is a bound of.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Proof {
    /// Whether nothing is better, or nothing is worse.
    pub sense: Sense,
    /// The placement that it is compared with: the one found, or for the worst one met on the way that is worse with
    /// constraints relaxed.
    pub placement: Placement,
    /// What is minimised, of the placement found with the same constraints relaxed. m
    pub found: f64,
    /// The placements that it is about, in words.
    pub scope: String,
    /// What is minimised, in words, with all that it contains.
    pub figure: String,
    /// What no placement gets past.
    pub bound: Bound,
    /// The constraints of the problem less those that the bound evaluates.
    pub relaxed: Vec<Relaxation>,
    /// What else it leaves out, in words.
    pub left_out: Vec<String>,
    /// The open boxes of each part of the problem that is bounded by itself, in the order of those of the bound.
    pub parts: Vec<OpenIn>,
}

/// Why there is no bound.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoProof {
    /// The problem cannot be certified.
    #[error(transparent)]
    Unsupported(#[from] Unsupported),
    /// There is no placement to bound.
    #[error("it was not looked for")]
    NotLookedFor,
    /// The caller stopped before the search began.
    #[error("interrupted before it began")]
    Interrupted,
    /// The time limit was over before the search began.
    #[error("the time limit was over before it began")]
    TimeLimit,
    /// A plan without deflection: a relative gap means nothing.
    #[error("the plan balances the deflection to nothing, which no bound can be compared with")]
    Cancelled,
    /// The worst placement is infeasible with the constraints that are evaluated alone.
    #[error("the worst placement has no value with these limits relaxed")]
    NoRelaxedValue,
}

impl Serialize for NoProof {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Bounds how far a placement is from the best there is, whose best plan has the objective `objective` (m), and the
/// placement `found_worst`, where one was looked for, from the worst, within a common time limit: that of the settings,
/// or the deadline of the monitor where it comes first.
///
/// The lower bound keeps the rate of beta, or the turn of the spindle where no rate is set; the upper bound, like the
/// value it is compared with ([`relaxed_value`]), does not. The result does not depend on the number of threads, unless
/// the time limit or the caller ends it.
pub fn certify(
    problem: &Problem,
    found: &Placement,
    objective: f64,
    found_worst: Option<&Placement>,
    settings: CertificateSettings,
    monitor: &Monitor,
) -> Certificate {
    let started = Instant::now();
    // A limit beyond what a clock holds is none.
    let limit = settings.time_limit.and_then(|limit| Duration::try_from_secs_f64(limit).ok());
    let deadline = limit.and_then(|limit| started.checked_add(limit));
    let is_earlier = |own| monitor.deadline().is_none_or(|callers| own < callers);
    let (monitor, settings) = match deadline {
        Some(own) if is_earlier(own) => (monitor.clone().with_deadline(deadline), settings),
        Some(_) => (monitor.clone(), CertificateSettings { time_limit: None, ..settings }),
        None => (monitor.clone(), settings),
    };
    let ended = || match monitor.stop() {
        Some(Stop::Asked) => Err(NoProof::Interrupted),
        Some(Stop::Deadline) => Err(NoProof::TimeLimit),
        None => Ok(()),
    };
    let comparable = |value: &dyn Fn() -> Option<f64>| {
        ended()?;
        match value() {
            None => Err(ended().err().unwrap_or(NoProof::NoRelaxedValue)),
            Some(value) if value <= CANCELLATION => Err(NoProof::Cancelled),
            Some(value) => Ok(value),
        }
    };
    let of_best = || {
        let part = Part::of(problem, settings.memory).map_err(together)?;
        let value = comparable(&|| Some(objective))?;
        let (bound, parts) = part.bound_from_below(value, &settings, &monitor)?;
        Ok(Proof { parts, ..Proof::new(problem, Sense::Min, *found, bound) })
    };
    let of_worst = |placement: &Placement| {
        certifiable_from_above(problem, settings.memory)?;
        let value = comparable(&|| relaxed_value(problem, placement, &monitor))?;
        let bound = worst(problem, value, &settings, &monitor)?;
        Ok(Proof { found: value, ..Proof::new(problem, Sense::Max, *placement, bound) })
    };
    let (best, worst) = (of_best(), found_worst.map_or(Err(NoProof::NotLookedFor), of_worst));
    let warnings = shortfalls(&settings, &best, &worst);
    Certificate { settings, best, worst, warnings, wall: started.elapsed().as_secs_f64() }
}

/// The warning that a problem cannot be certified.
pub fn no_certificate(reason: &Unsupported) -> Warning {
    let last = if let Unsupported::Several(all) = reason { all.last() } else { Some(reason) };
    let help = if let Some(Unsupported::TooLarge { .. }) = last { " by certificate.memory_gb" } else { "" };
    Warning::new("no-certificate", format!("no certificate: {reason}{help}; the workpiece is placed without one"))
}

/// Where bounds fall short of what was requested.
fn shortfalls(
    settings: &CertificateSettings,
    best: &Result<Proof, NoProof>,
    worst: &Result<Proof, NoProof>,
) -> Vec<Warning> {
    if let Err(NoProof::Unsupported(reason)) = best {
        return vec![no_certificate(reason)];
    }
    let one = |(name, side): (&str, &Result<Proof, NoProof>)| match side {
        Ok(proof) => {
            proof.shortfall(settings).map(|why| Warning::new("certificate-gap", format!("{name} placement, {why}")))
        }
        Err(NoProof::NotLookedFor) => None,
        Err(reason) => Some(Warning::new("no-bound", format!("no certificate for the {name} placement: {reason}"))),
    };
    [("best", best), ("worst", worst)].into_iter().filter_map(one).collect()
}

/// The kinds of constraint that a bound evaluates.
fn evaluated(problem: &Problem, bound: &Bound) -> Vec<ConstraintKind> {
    use ConstraintKind::{AxesSum, BetaRate, CellPosition, Conditioning, JointLimit, Reach, SpindleTurn};
    let mut kinds = vec![Reach, JointLimit(2), JointLimit(3), AxesSum, Conditioning, CellPosition];
    // Both flips of the wrist are taken to reach as far as the better one; where the range holds zero, one of them
    // does.
    let fifth = &problem.robot.joints()[4];
    kinds.extend((fifth.min <= 0.0 && fifth.max >= 0.0).then_some(JointLimit(5)));
    kinds.extend(bound.with_rate.then_some(BetaRate));
    kinds.extend(bound.with_turn.then_some(SpindleTurn));
    kinds
}

/// The placements that a bound is about, in words.
fn scope(problem: &Problem) -> String {
    let lying = if problem.orientations.len() > 1 { ", lying in any of its orientations" } else { "" };
    let axes = if problem.external_axes.is_empty() { "" } else { ", with the external axes anywhere in their ranges" };
    format!("in this cell{lying}{axes}")
}

/// What a lower bound leaves out of the objective of a problem, and of what is allowed, beside its constraints: in
/// words.
fn left_out(problem: &Problem) -> Vec<String> {
    let nearest = format!("the deflection of path points nearer than {} mm to axis 1", NEAREST * 1e3);
    let all = [
        (require_no_travel(problem).is_err(), "travel of the joints in the objective"),
        (require_certain_compliances(problem).is_err(), "errors of the compliances in the scores"),
        (require_free_beta(problem).is_err(), "beta that stays along the path"),
        (expected_cost(problem).is_some(), &nearest),
        (!problem.external_axes.is_empty(), "which position of the external axes goes with which x, y, z and yaw"),
    ];
    let of_all = all.into_iter().filter(|(is_so, _)| *is_so).map(|(_, words)| words.to_owned());
    of_all.chain(left_out_between_segments(problem)).collect()
}

impl Certificate {
    /// Whether the caller stopped it before it was done.
    pub fn is_interrupted(&self) -> bool {
        [&self.best, &self.worst].into_iter().any(|found| match found {
            Ok(proof) => proof.bound.status == Status::Interrupted,
            Err(reason) => *reason == NoProof::Interrupted,
        })
    }
}

impl Proof {
    /// What a bound proves of a placement found, of the score that it is compared with.
    pub fn new(problem: &Problem, sense: Sense, placement: Placement, bound: Bound) -> Self {
        let relaxed = relaxed(problem, &evaluated(problem, &bound));
        let placement = bound.met.unwrap_or(placement);
        let (scope, figure) = (scope(problem), problem.objective_words());
        // Bounds from above are refused where they would leave something out.
        let left_out = if sense == Sense::Min { left_out(problem) } else { Vec::new() };
        Self { sense, placement, found: bound.value, scope, figure, bound, relaxed, left_out, parts: Vec::new() }
    }

    /// The relaxed constraints, and what else is left out, in words.
    pub fn relaxed_words(&self) -> Vec<String> {
        let left_out = self.left_out.iter().cloned();
        describe(&self.relaxed).into_iter().chain(left_out).collect()
    }

    /// Whether the bound says anything of use: it is above zero, and the gap no wider than [`MAX_GAP_PERCENT`].
    pub fn is_of_use(&self) -> bool {
        self.bound_mm() > 0.0 && self.gap_percent() <= MAX_GAP_PERCENT
    }

    /// The gap in per cent, rounded up.
    pub fn gap_percent(&self) -> f64 {
        let scale = libm::pow(10.0, GAP_DECIMALS as f64);
        // A gap reached exactly is not rounded up for the last bits of a double.
        (self.bound.gap() * 100.0 * scale - 1e-6).ceil().max(0.0) / scale
    }

    /// The gap in per cent as sentences state it.
    pub fn gap_words(&self) -> String {
        trimmed(self.gap_percent(), GAP_DECIMALS)
    }

    /// What is proved of the best placement, in one plain sentence; `None` where that is nothing of use.
    pub fn sentence(&self) -> Option<String> {
        let is_said = self.sense == Sense::Min && self.is_of_use();
        is_said.then(|| {
            let Self { scope, figure, .. } = self;
            let gap = self.gap_words();
            let begin = match self.gap_percent() {
                close if close <= CLOSE_PERCENT => "No".to_owned(),
                wide if wide <= WIDE_PERCENT => format!("Up to {gap} % may be left to gain: no"),
                _ => format!("Little is proved, and up to {gap} % may be left to gain: no"),
            };
            format!(
                "{begin} placement {scope}, however the arm is posed, has a {figure} more than {gap} % below yours."
            )
        })
    }

    /// The bound in mm, rounded to where it still holds.
    pub fn bound_mm(&self) -> f64 {
        self.rounded_mm(self.bound.bound)
    }

    /// A bound (m) in mm, rounded to where it still holds.
    pub fn rounded_mm(&self, bound: f64) -> f64 {
        let scale = libm::pow(10.0, BOUND_DECIMALS as f64);
        let scaled = bound * 1e3 * scale;
        let rounded = match self.sense {
            Sense::Min => scaled.floor(),
            Sense::Max => scaled.ceil(),
        };
        rounded / scale
    }

    /// The boxes that are left open.
    pub fn open_boxes(&self, problem: &Problem) -> Vec<OpenBox> {
        let parts = self.parts.iter().flat_map(|part| std::iter::repeat_n(Some(part), part.boxes));
        let boxes = self.bound.open.iter().zip(parts.chain(std::iter::repeat(None)));
        let named = |((region, bound), part): (&(Region, f64), Option<&OpenIn>)| OpenBox {
            orientation: part.and_then(|part| part.orientation.clone()),
            segment: part.and_then(|part| part.segment),
            ..OpenBox::new(problem, region, *bound)
        };
        boxes.map(named).collect()
    }

    /// Why the search ended before what was requested, if it did.
    pub fn shortfall(&self, settings: &CertificateSettings) -> Option<String> {
        let why = match self.bound.status {
            Status::Reached => return None,
            Status::Exhausted => "what is left open is smaller than the tables can tell apart".to_owned(),
            Status::SegmentsApart => {
                "each segment is bounded by itself, at its own best place of part and axes, where \
                                      in the cell all of them share the place of the part"
                    .to_owned()
            }
            Status::Interrupted => "interrupted".to_owned(),
            Status::TimeLimit => {
                let limit = settings.time_limit.map_or_else(String::new, |limit| format!(" of {} s", figures(limit)));
                format!("the time limit{limit} is over")
            }
            Status::Memory => {
                format!("the {} GB of certificate.memory_gb are used up", figures(settings.memory as f64 / 1e9))
            }
        };
        let (requested, open) = (figures(settings.gap * 100.0), self.bound.open.len());
        let gap = if self.is_of_use() { format!("a gap of {} %", self.gap_words()) } else { "no gap".to_owned() };
        let boxes = if open == 1 { "box is" } else { "boxes are" };
        let kept = self.bound.keeps_open.map_or_else(String::new, |kept| format!("; {kept}"));
        Some(format!("{why}: {gap} is reached, {requested} % was asked for; {open} {boxes} open{kept}"))
    }
}

/// A box of placements in the user's terms: about axis 1, in the robot base frame.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OpenBox {
    /// Distance of the workpiece origin from axis 1, from and to. m
    pub radius: [f64; 2],
    /// z of the workpiece origin, from and to. m
    pub z: [f64; 2],
    /// Yaw less the azimuth of the workpiece origin about axis 1, from and to. rad
    pub turn: [f64; 2],
    /// What no placement in it gets past. m
    pub bound: f64,
    /// The name of the orientation of the part, where there are several.
    pub orientation: Option<String>,
    /// The number of the segment, from 1, that it is of, where each has a place of its own: the bound is of all
    /// segments then, or of it alone, where the tool leans.
    pub segment: Option<usize>,
}

impl OpenBox {
    /// Boxes are seen along axis 1, so that an arm that hangs turns z and angles over.
    fn new(problem: &Problem, region: &Region, bound: f64) -> Self {
        let geometry = problem.robot.geometry();
        let side = geometry.base_from_root[(2, 2)].signum();
        let ends = |k: usize, sign: f64, from: f64| {
            let middle = from + sign * region.middle[k];
            [middle - region.half[k], middle + region.half[k]]
        };
        Self {
            radius: ends(0, 1.0, 0.0),
            z: ends(1, side, geometry.root_in_base.z),
            turn: ends(2, side, 0.0),
            bound,
            orientation: None,
            segment: None,
        }
    }
}
