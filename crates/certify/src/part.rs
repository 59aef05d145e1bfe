//! A problem as the parts that are bounded by themselves, and how their bounds make up one.

use super::apart;
use super::best::bound_of;
use super::branch_and_bound::{Bound, OpenIn, Status};
use super::cell::{NEAREST, too_near};
use super::load::Objective;
use super::relaxed::low_value;
use super::requirements::{Leaf, cell_moved};
use super::shared_cells::SharedCells;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;
use stead_model::external_axis::{AxisUse, ExternalAxis};
use stead_model::task::KeptPoint;
use stead_numerics::monitor::Monitor;
use stead_problem::criterion::CANCELLATION;
use stead_problem::problem::Problem;
use stead_problem::settings::CertificateSettings;
use stead_problem::setup::Setup;
use stead_problem::symmetry::Unsupported;

/// A problem, or a part of it, that can be certified.
#[derive(Debug)]
pub(super) enum Part {
    /// A problem that is bounded as a whole.
    Leaf(Box<Leaf>),
    /// The orientations of the part by name: the least of their bounds holds.
    Least(Vec<(String, Part)>),
    /// A problem whose external axes have another position for each segment, in a cell that holds all places to which
    /// the axes at one place for the path bring the part; and the same where all axes do.
    Apart(Box<Problem>, Box<Leaf>),
    /// The segments that count, by number from 0, of one whose tool leans: seen from the robot no two need have the
    /// same placement, and their bounds make up the figure.
    Sum(Objective, Vec<(usize, Leaf)>),
}

/// Whether the best placement of a problem can be certified with tables of at most `memory` bytes when they are empty,
/// found without work.
///
/// What adds to an objective and is never below zero is left out of its bound, and so is what keeps plans from being
/// better: see `left_out`.
///
/// # Errors
/// All reasons why not.
pub fn certifiable(problem: &Problem, memory: u64) -> Result<(), Unsupported> {
    Part::of(problem, memory).map(drop).map_err(together)
}

/// What a certificate of a problem costs more than others, to be said before a long search: in a sentence, where there
/// is something to say.
pub fn expected_cost(problem: &Problem) -> Option<String> {
    let part = Part::of(problem, u64::MAX).ok()?;
    let missing = part.leaves().into_iter().filter_map(|leaf| too_near(&leaf.problem)).reduce(f64::max)?;
    let [nearest, missing] = [NEAREST, missing].map(|length| (length * 1e3).ceil());
    Some(format!(
        "path points may come nearer than {nearest} mm to axis 1 in this cell, where they count without deflection in \
         the certificate: its gap closes slowly, or not to the one asked for; in a cell {missing} mm farther from \
         axis 1 none do"
    ))
}

/// Bounds the objective of all placements of a problem from below, until no placement can be better than `value` (what
/// is minimised, m) by more than the gap of the settings.
///
/// Limits between neighbouring points are relaxed, and those of joints 1, 4 and 6; the rate of beta is kept, where one
/// is set, else the turn of the spindle, where that is limited. The result does not depend on the number of threads.
///
/// # Errors
/// Why the problem cannot be certified this way.
pub fn best(
    problem: &Problem,
    value: f64,
    settings: &CertificateSettings,
    monitor: &Monitor,
) -> Result<Bound, Unsupported> {
    let part = Part::of(problem, settings.memory).map_err(together)?;
    part.bound_from_below(value, settings, monitor).map(|(bound, _)| bound)
}

/// Reasons as one.
pub(super) fn together(mut reasons: Vec<Unsupported>) -> Unsupported {
    if reasons.len() == 1 { reasons.swap_remove(0) } else { Unsupported::Several(reasons) }
}

/// All without repetitions.
pub(super) fn once_each<T: PartialEq>(all: impl Iterator<Item = T>) -> Vec<T> {
    all.fold(Vec::new(), |mut said, reason| {
        if !said.contains(&reason) {
            said.push(reason);
        }
        said
    })
}

/// All parts, or the reasons why some of them cannot be certified.
fn all<T>(parts: impl Iterator<Item = Result<T, Vec<Unsupported>>>) -> Result<Vec<T>, Vec<Unsupported>> {
    let (mut found, mut reasons) = (Vec::new(), Vec::new());
    for part in parts {
        match part {
            Ok(part) => found.push(part),
            Err(more) => reasons.extend(more),
        }
    }
    if reasons.is_empty() { Ok(found) } else { Err(once_each(reasons.into_iter())) }
}

impl Part {
    /// Of a problem, with tables of at most `memory` bytes each when they are empty.
    ///
    /// # Errors
    /// All reasons why it cannot be certified.
    pub fn of(problem: &Problem, memory: u64) -> Result<Self, Vec<Unsupported>> {
        if problem.orientations.len() > 1 {
            let one = |number: usize| {
                let name = problem.orientations[number].name.clone();
                let named = |reason| Unsupported::Orientation { name: name.clone(), reason: Box::new(reason) };
                let part = Self::of(&in_orientation(problem, number)?, memory);
                Ok((name.clone(), part.map_err(|reasons| reasons.into_iter().map(named).collect::<Vec<_>>())?))
            };
            return all((0..problem.orientations.len()).map(one)).map(Self::Least);
        }
        if are_segments_apart(problem) {
            let leaf = Leaf::of(&with_axes_still(problem)?, memory)?;
            if !leaf.leans {
                let shared = problem.in_cell(cell_moved(problem, |axis| axis.axis_use == AxisUse::Fixed));
                return Ok(Self::Apart(Box::new(shared), Box::new(leaf)));
            }
            let one = |segment: usize| Ok((segment, Leaf::of(&on_segment(problem, segment)?, memory)?));
            let spans = problem.task.segments();
            let counts = |segment: &usize| spans[*segment].clone().any(|point| problem.point_weight(point) > 0.0);
            let parts = all((0..spans.len()).filter(counts).map(one))?;
            return Ok(Self::Sum(Objective::of(problem), parts));
        }
        Ok(Self::Leaf(Box::new(Leaf::of(problem, memory)?)))
    }

    fn leaves(&self) -> Vec<&Leaf> {
        match self {
            Self::Leaf(leaf) | Self::Apart(_, leaf) => vec![leaf],
            Self::Least(parts) => parts.iter().flat_map(|(_, part)| part.leaves()).collect(),
            Self::Sum(_, parts) => parts.iter().map(|(_, leaf)| leaf).collect(),
        }
    }

    /// What is left out of what segments share: in words.
    fn left_out(&self) -> Vec<String> {
        match self {
            Self::Leaf(_) => Vec::new(),
            Self::Least(parts) => once_each(parts.iter().flat_map(|(_, part)| part.left_out())),
            Self::Apart(shared, leaf) => SharedCells::new(shared, &leaf.problem).left_out(),
            Self::Sum(..) => vec!["that all segments have the same x, y, z, yaw".to_owned()],
        }
    }

    /// A bound from below ([`super::best()`]), and the open boxes of each part that is bounded by itself, in the order
    /// of those of the bound. The time that is left is shared evenly by the parts that are left.
    ///
    /// # Errors
    /// [`Unsupported`] where no part counts.
    pub fn bound_from_below(
        &self,
        value: f64,
        settings: &CertificateSettings,
        monitor: &Monitor,
    ) -> Result<(Bound, Vec<OpenIn>), Unsupported> {
        match self {
            Self::Leaf(leaf) => {
                let bound = bound_of(leaf, value, settings, monitor);
                let boxes = bound.open.len();
                Ok((bound, vec![OpenIn { boxes, ..OpenIn::default() }]))
            }
            Self::Least(parts) => least(parts, value, settings, monitor),
            Self::Apart(problem, leaf) => Ok(apart::best(problem, leaf, value, settings, monitor)),
            Self::Sum(objective, parts) => sum(objective, parts, value, settings, monitor),
        }
    }
}

/// The same problem in one of the orientations of the part alone.
fn in_orientation(problem: &Problem, number: usize) -> Result<Problem, Vec<Unsupported>> {
    let orientation = &problem.orientations[number];
    let changed = problem.changed(|parts| {
        parts.task = (*orientation.task).clone();
        parts.orientations = Arc::from([orientation.clone()]);
        parts.setup.orientation = 0;
    });
    changed.map_err(|_| vec![Unsupported::Orientations])
}

/// Whether segments are bounded one by one: external axes have another position for each.
pub(super) fn are_segments_apart(problem: &Problem) -> bool {
    problem.task.segments().len() > 1 && problem.external_axes.iter().any(|axis| axis.axis_use == AxisUse::Indexed)
}

/// What a bound of a problem leaves out of what its segments share: in words.
pub(super) fn left_out_between_segments(problem: &Problem) -> Vec<String> {
    if !are_segments_apart(problem) {
        return Vec::new();
    }
    let mut said = Part::of(problem, u64::MAX).map_or_else(|_| Vec::new(), |part| part.left_out());
    let counts = |span: &Range<usize>| span.clone().any(|point| problem.point_weight(point) > 0.0);
    if !problem.task.segments().iter().all(counts) {
        said.push("segments without scored points".to_owned());
    }
    said
}

/// The same problem with each external axis at one place for the path.
fn with_axes_still(problem: &Problem) -> Result<Problem, Vec<Unsupported>> {
    let changed = problem.changed(|parts| {
        let still = |axis: &ExternalAxis| match axis.axis_use {
            AxisUse::Indexed => ExternalAxis { axis_use: AxisUse::Fixed, ..axis.clone() },
            AxisUse::Fixed | AxisUse::Continuous => axis.clone(),
        };
        parts.external_axes = parts.external_axes.iter().map(still).collect();
        (parts.scene, parts.setup) =
            (None, Setup { leans: parts.setup.leans.clone(), ..Setup::at_rest(&parts.external_axes) });
    });
    changed.map_err(|_| vec![Unsupported::OtherAxes])
}

/// The same problem on one segment (from 0) alone.
fn on_segment(problem: &Problem, segment: usize) -> Result<Problem, Vec<Unsupported>> {
    let (path, points) = (problem.task.path(), problem.task.segments()[segment].clone());
    let kept: Vec<_> = points.map(|point| KeptPoint { point, weight: path.weight(point) }).collect();
    let changed = problem.on_points(&kept).changed(|parts| {
        parts.criterion.segment_weights = vec![problem.segment_weight(segment)];
        (parts.scene, parts.orientations) = (None, [].into());
        parts.setup = Setup { leans: parts.setup.leans.clone(), ..Setup::at_rest(&parts.external_axes) };
    });
    changed.map_err(|_| vec![Unsupported::OtherAxes])
}

/// A monitor with its share of the time that is left, by so many parts.
fn sharing(monitor: &Monitor, parts: usize) -> Monitor {
    let share = |deadline: Instant| {
        let now = Instant::now();
        now + deadline.saturating_duration_since(now) / parts as u32
    };
    monitor.clone().with_deadline(monitor.deadline().map(share))
}

impl Bound {
    /// With the open boxes of another search and what it took; limits that one of them drops are not kept.
    fn and(mut self, other: Self) -> Self {
        self.open.extend(other.open);
        self.nodes += other.nodes;
        (self.with_rate, self.with_turn) = (self.with_rate && other.with_rate, self.with_turn && other.with_turn);
        self
    }
}

/// The bound that holds in all orientations.
fn least(
    parts: &[(String, Part)],
    value: f64,
    settings: &CertificateSettings,
    monitor: &Monitor,
) -> Result<(Bound, Vec<OpenIn>), Unsupported> {
    let (mut found, mut open_in): (Option<Bound>, _) = (None, Vec::new());
    for (number, (name, part)) in parts.iter().enumerate() {
        let (bound, open) = part.bound_from_below(value, settings, &sharing(monitor, parts.len() - number))?;
        open_in.extend(open.into_iter().map(|open| OpenIn { orientation: Some(name.clone()), ..open }));
        found = Some(match found {
            None => bound,
            Some(other) => lower(other, bound),
        });
    }
    found.map(|bound| (bound, open_in)).ok_or(Unsupported::Orientations)
}

/// The bound that holds in two orientations: the lower one, with how that ended that fell short.
fn lower(first: Bound, second: Bound) -> Bound {
    let bound = first.bound.min(second.bound);
    // Where both fell short, the one of the lower bound says why.
    let is_first = match (first.status, second.status) {
        (Status::Reached, Status::Reached) => first.bound <= second.bound,
        (Status::Reached, _) => false,
        (_, Status::Reached) => true,
        _ => first.bound <= second.bound,
    };
    let Bound { status, keeps_open, .. } = *if is_first { &first } else { &second };
    Bound { bound, status, keeps_open, ..first.and(second) }
}

/// The bound that those of the segments make up, each over all that the axes bring the part to: that all segments share
/// x, y, z and yaw is left out.
fn sum(
    objective: &Objective,
    parts: &[(usize, Leaf)],
    value: f64,
    settings: &CertificateSettings,
    monitor: &Monitor,
) -> Result<(Bound, Vec<OpenIn>), Unsupported> {
    let (mut whole, mut open_in, mut sum, mut most_lost): (Option<Bound>, _, _, _) = (None, Vec::new(), 0.0, 0.0);
    for (number, (segment, leaf)) in parts.iter().enumerate() {
        let (monitor, own) = (sharing(monitor, parts.len() - number), Objective::of(&leaf.problem));
        // The other segments cost no less than nothing.
        let most = own.value(objective.sum(value));
        let compared = low_value(&leaf.problem, &monitor).map_or(most, |found| found.min(most));
        if compared <= CANCELLATION {
            continue;
        }
        let bound = bound_of(leaf, compared, settings, &monitor);
        let counted = own.sum(bound.bound.max(0.0));
        let lost = own.sum(compared) - counted;
        sum = objective.aggregate.join(sum, counted);
        open_in.push(OpenIn { segment: Some(segment + 1), boxes: bound.open.len(), ..OpenIn::default() });
        whole = Some(match whole {
            None => bound,
            Some(other) => {
                let keeps_open = if lost > most_lost { bound.keeps_open } else { other.keeps_open };
                Bound { keeps_open, status: first_of(other.status, bound.status), ..other.and(bound) }
            }
        });
        most_lost = f64::max(most_lost, lost);
    }
    let whole = whole.ok_or(Unsupported::OtherAxes)?;
    let mut whole = Bound { value, bound: objective.value(sum), ..whole };
    if matches!(whole.status, Status::Reached | Status::Exhausted) && whole.gap() > settings.gap {
        whole.status = Status::SegmentsApart;
    }
    Ok((whole, open_in))
}

/// Of how two searches ended, what is to be said of both.
fn first_of(a: Status, b: Status) -> Status {
    let order = [Status::Interrupted, Status::Memory, Status::TimeLimit, Status::Exhausted];
    order.into_iter().find(|status| [a, b].contains(status)).unwrap_or(Status::Reached)
}

#[cfg(test)]
pub(super) mod tests;
