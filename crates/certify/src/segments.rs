//! External axes with a place for each segment: a bound for each segment by itself, which add up.

use super::at_rest::without_axes;
use super::best::best as best_of_all;
use super::branch_and_bound::{Bound, Status};
use super::load::Objective;
use super::orientations::{OpenIn, sharing};
use super::relaxed::{relaxed_value, rough_value};
use rayon::prelude::*;
use stead_model::external_axis::AxisUse;
use stead_model::task::KeptPoint;
use stead_numerics::monitor::Monitor;
use stead_problem::criterion::CANCELLATION;
use stead_problem::problem::{Placement, Problem};
use stead_problem::settings::CertificateSettings;
use stead_problem::setup::Setup;
use stead_problem::symmetry::Unsupported;

/// Whether segments are bounded one by one: external axes stand at another place for each, so that seen from the robot
/// no two need have the same placement.
pub(super) fn are_apart(problem: &Problem) -> bool {
    problem.task.segments().len() > 1 && problem.external_axes.iter().any(|axis| axis.axis_use == AxisUse::Indexed)
}

/// The same problem on each segment alone that counts, with its number from 0.
///
/// # Errors
/// [`Unsupported::OtherAxes`] where it is no problem by itself.
pub(super) fn alone(problem: &Problem) -> Result<Vec<(usize, Problem)>, Unsupported> {
    let path = problem.task.path();
    let counts = |segment: &usize| problem.task.segments()[*segment].clone().any(|p| problem.point_weight(p) > 0.0);
    let one = |segment: usize| {
        let points = problem.task.segments()[segment].clone();
        let kept: Vec<_> = points.map(|point| KeptPoint { point, weight: path.weight(point) }).collect();
        let changed = problem.on_points(&kept).changed(|parts| {
            parts.criterion.segment_weights = vec![problem.segment_weight(segment)];
            (parts.scene, parts.orientations) = (None, [].into());
            parts.setup = Setup { leans: parts.setup.leans.clone(), ..Setup::at_rest(&parts.external_axes) };
        });
        changed.map(|changed| (segment, changed)).map_err(|_| Unsupported::OtherAxes)
    };
    (0..problem.task.segments().len()).filter(counts).map(one).collect()
}

/// A bound from below ([`super::best()`]), and the open boxes of each segment that is bounded by itself, in the order
/// of those of the bound.
///
/// Where external axes stand at another place for each segment, every segment is bounded over all that they bring the
/// part to, and the bounds make up the figure: that all segments share x, y, z and yaw is left out. The time that is
/// left is shared evenly by the segments that are left.
///
/// # Errors
/// Why it cannot be certified.
pub(super) fn best(
    problem: &Problem,
    value: f64,
    settings: &CertificateSettings,
    monitor: &Monitor,
) -> Result<(Bound, Vec<OpenIn>), Unsupported> {
    if !are_apart(problem) {
        let bound = best_of_all(problem, value, settings, true, monitor)?;
        let boxes = bound.open.len();
        return Ok((bound, vec![OpenIn { boxes, ..OpenIn::default() }]));
    }
    let (objective, segments) = (Objective::of(problem), alone(problem)?);
    let count = segments.len();
    let (mut whole, mut open_in, mut sum, mut most_lost): (Option<Bound>, _, _, _) = (None, Vec::new(), 0.0, 0.0);
    for (number, (segment, one)) in segments.into_iter().enumerate() {
        let (monitor, own) = (sharing(monitor, count - number), Objective::of(&one));
        // The other segments cost no less than nothing.
        let most = own.value(objective.sum(value));
        let compared = low_value(without_axes(&one)?.as_ref(), &monitor).map_or(most, |found| found.min(most));
        if compared <= CANCELLATION {
            continue;
        }
        let bound = best_of_all(&one, compared, settings, true, &monitor)?;
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

/// Placements tried all over the cell, how many of the best of them are improved, and how often steps are halved there.
const TRIED: usize = 192;
const IMPROVED: usize = 2;
const HALVINGS: usize = 6;
/// Path points that placements are compared on.
const COMPARED: usize = 8;

/// What some good placement comes to with limits relaxed ([`relaxed_value`]): what a bound of a segment is compared
/// with, of which no plan is known. m
fn low_value(problem: &Problem, monitor: &Monitor) -> Option<f64> {
    let path = problem.task.path();
    let scored: Vec<usize> = (0..problem.task.points().len()).filter(|p| problem.point_weight(*p) > 0.0).collect();
    let step = scored.len().div_ceil(COMPARED).max(1);
    let kept: Vec<_> =
        scored.iter().step_by(step).map(|point| KeptPoint { point: *point, weight: path.weight(*point) }).collect();
    let few = problem.on_points(&kept);
    let [x, y, z] = problem.cell.position;
    let ranges = [x, y, z, problem.cell.yaw];
    let at = |shares: &[f64; 4]| {
        let [x, y, z, yaw] = std::array::from_fn(|k| ranges[k].min + ranges[k].width() * shares[k]);
        Placement { x, y, z, yaw }
    };
    let of = |shares: &[f64; 4]| rough_value(&few, &at(shares), monitor).unwrap_or(f64::INFINITY);
    // An additive recurrence, which covers four dimensions evenly.
    let ratio = 1.167_303_978_261_418_7_f64;
    let tried = |k: usize| std::array::from_fn(|d| (0.5 + (k + 1) as f64 / ratio.powi(d as i32 + 1)).fract());
    let mut all: Vec<(f64, [f64; 4])> = (0..TRIED).into_par_iter().map(|k| (of(&tried(k)), tried(k))).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let improved = all.into_iter().take(IMPROVED).filter(|(value, _)| value.is_finite()).map(|mut best| {
        let (mut step, mut halved) = (0.125, 0);
        while halved < HALVINGS {
            let beside = (0..8).map(|k| {
                let mut shares = best.1;
                shares[k / 2] = (shares[k / 2] + if k % 2 == 0 { step } else { -step }).clamp(0.0, 1.0);
                (of(&shares), shares)
            });
            let next = beside.fold(best, |best, other| if other.0 < best.0 { other } else { best });
            if next.0 < best.0 {
                best = next;
            } else {
                (step, halved) = (0.5 * step, halved + 1);
            }
        }
        best
    });
    let best = improved.min_by(|a, b| a.0.total_cmp(&b.0))?;
    relaxed_value(problem, &at(&best.1), monitor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::certify;
    use crate::{NoProof, certifiable};
    use nalgebra::Vector3;
    use stead_model::external_axis::{AxisKind, Carried, ExternalAxis};
    use stead_problem::criterion::{Aggregate, Weights};
    use stead_problem::problem::{Cell, Interval};
    use stead_problem::setup::AxisPositions;
    use stead_problem::testing::five_segments;

    /// The five segments near the best placement, on a short rail or turntable with a place for each segment.
    fn indexed(kind: AxisKind, aggregate: Aggregate) -> (Problem, Placement) {
        let mut problem = five_segments();
        let at = Placement::from_mm_deg([0.0284, -1640.0, -214.0], 78.9664);
        let near = |value: f64| Interval { min: value - 1e-3, max: value + 1e-3 };
        problem.cell = Cell { position: [near(at.x), near(at.y), near(at.z)], yaw: near(at.yaw) };
        (problem.criterion.aggregate, problem.criterion.weights) = (aggregate, Weights::TOTAL);
        problem.criterion.segment_weights = vec![1.0, 2.0, 0.0, 1.0, 0.5];
        let (direction, max) = match kind {
            AxisKind::Rail => (Vector3::y(), 0.02),
            AxisKind::Turntable => (Vector3::z(), 0.05),
        };
        problem.external_axes = vec![ExternalAxis {
            name: "axis".to_owned(),
            kind,
            carries: Carried::Workpiece,
            direction,
            point: Vector3::new(at.x, at.y, 0.0),
            min: -max,
            max,
            max_speed: None,
            axis_use: AxisUse::Indexed,
        }];
        problem.setup = Setup::at_rest(&problem.external_axes);
        (problem, at)
    }

    /// What the problem comes to with the axis at these shares of its range, segment by segment.
    fn value_at(problem: &Problem, at: &Placement, shares: [f64; 5]) -> f64 {
        let mut there = problem.clone();
        let axis = &problem.external_axes[0];
        let positions = shares.map(|share| vec![axis.min + share * (axis.max - axis.min)]);
        there.setup.positions = AxisPositions::PerSegment(positions.to_vec());
        relaxed_value(&there, at, &Monitor::silent()).unwrap()
    }

    #[test]
    fn no_places_of_an_axis_for_the_segments_are_better_than_their_bounds_together() {
        for (kind, aggregate) in [(AxisKind::Rail, Aggregate::Mean), (AxisKind::Turntable, Aggregate::Max)] {
            let (problem, at) = indexed(kind, aggregate);
            assert_eq!(certifiable(&problem, u64::MAX), Ok(()));
            let ends = (0..32).map(|k| std::array::from_fn(|s| f64::from(k >> s & 1)));
            let least = ends.map(|shares| value_at(&problem, &at, shares)).fold(f64::INFINITY, f64::min);
            let silent = Monitor::silent();
            let settings = CertificateSettings::new(0.01);
            let (bound, parts) = best(&problem, least, &settings, &silent).unwrap();
            // In so small a cell that segments share a placement is worth little; where only the largest counts, what a
            // segment comes to by itself is the larger of one way.
            assert!(bound.bound <= least && bound.gap() < 0.02, "{kind:?} {aggregate:?}: {bound:?} {least}");
            // The third segment has no weight.
            assert_eq!(parts.iter().map(|part| part.segment).collect::<Vec<_>>(), [1, 2, 4, 5].map(Some));
            assert_eq!(parts.iter().map(|part| part.boxes).sum::<usize>(), bound.open.len());
            // With the axis at one place for the path there is less to choose from.
            let mut still = problem.clone();
            still.external_axes[0].axis_use = AxisUse::Fixed;
            let (of_one, _) = best(&still, least, &settings, &silent).unwrap();
            assert!(of_one.bound >= bound.bound * 0.989, "{kind:?}: {} {}", of_one.bound, bound.bound);
            let proof = certify(&problem, &at, least, Some(&at), settings, &silent);
            let words = proof.best.unwrap().relaxed_words();
            assert!(words.iter().any(|word| word == "that all segments have the same x, y, z and yaw"), "{words:?}");
            let Err(NoProof::Unsupported(Unsupported::Several(reasons))) = proof.worst else { panic!("bounded") };
            let direction = Unsupported::NotFromAbove { key: "criterion.direction" };
            assert!(reasons[0] == Unsupported::ExternalAxes && reasons.contains(&direction), "{reasons:?}");
        }
    }

    #[test]
    fn bounds_of_segments_make_up_the_figure_as_their_values_do() {
        for aggregate in [Aggregate::Mean, Aggregate::Rms, Aggregate::Max] {
            let (problem, at) = indexed(AxisKind::Rail, aggregate);
            let whole = value_at(&problem, &at, [0.5; 5]);
            let objective = Objective::of(&problem);
            let sum = alone(&problem).unwrap().iter().fold(0.0, |sum, (_, one)| {
                let value = relaxed_value(without_axes(one).unwrap().as_ref(), &at, &Monitor::silent()).unwrap();
                objective.aggregate.join(sum, Objective::of(one).sum(value))
            });
            assert!((objective.value(sum) - whole).abs() < 1e-9 * whole, "{aggregate:?}");
        }
    }

    #[test]
    fn placements_compared_with_are_no_better_than_what_is_possible() {
        let (problem, _) = indexed(AxisKind::Rail, Aggregate::Mean);
        let (settings, silent) = (CertificateSettings::new(0.01), Monitor::silent());
        for (_, one) in alone(&problem).unwrap() {
            let one = without_axes(&one).unwrap();
            let found = low_value(&one, &silent).unwrap();
            let bound = best_of_all(&one, found, &settings, true, &silent).unwrap();
            assert!(bound.bound <= found && bound.status == Status::Reached, "{bound:?}");
        }
    }
}
