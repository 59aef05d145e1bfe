//! Tools that lean, with the same axis at many path points (3+2): a lower bound of the best placement.
//!
//! Seen from the workpiece, a placement is where axis 1 is: two coordinates and a height. With one tool axis in the
//! workpiece a state is the place of the tool centre point about axis 1 (in the directions of the workpiece) and the
//! turn of the spindle about its axis; loads are the same everywhere. What a point costs at least, whatever the turn,
//! is a function of its place alone ([`cells`]), and the place of every point moves as that of the workpiece does. So a
//! box of placements needs one affine function below that for each point, and their sum is least at a corner of the
//! box. Limits on beta along the path are dropped.

mod cells;
mod piece;
mod states;

use super::arm::Arm;
use super::branch_and_bound::{Bound, BranchAndBound, Open, Parts};
use super::cell::{SAME, Yaws, axes_of, extent, seen, side, whole};
use super::cost::{CORNERS, cost_at_corners};
use super::keeps_open::{KeepsOpen, some_points};
use super::kind::kinds_of;
use super::load::{Load, Objective};
use super::minorant::Affine;
use super::model::Keeps;
use super::region::Region;
use super::sliding_min::{INFINITE, joined, min_into, plus};
pub(super) use cells::bytes;
use cells::{Cells, LEVELS};
use nalgebra::Vector3;
use piece::half_of;
use states::count;
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;
use stead_model::robot::PostureClass;
use stead_numerics::monitor::Monitor;
use stead_problem::criterion::Aggregate;
use stead_problem::problem::{Cell, Problem};
use stead_problem::sense::Sense;
use stead_problem::settings::CertificateSettings;

/// Tool axes of a path that a bound covers.
pub(super) const MOST_AXES: usize = 3;
/// What a point costs where it is of no interest at first, in terms of what all of them cost in the mean.
const ENOUGH: f64 = 1.5;

/// A path point: where it is in the workpiece (m), which axis its tool has, and its kind of load, with how many times
/// as large its own is; `None` of one that costs nothing.
#[derive(Debug, Clone, Copy)]
struct LeaningPoint {
    at: [f64; 3],
    axis: usize,
    kind: Option<(usize, f64)>,
}

/// What is to be bounded, prepared.
#[derive(Debug)]
struct Leaning {
    axes: Vec<Cells>,
    points: Vec<LeaningPoint>,
    segments: Vec<Range<usize>>,
    aggregate: Aggregate,
    yaws: Yaws,
    /// Distances from axis 1 of the workpiece origin, from and to. m
    radius: (f64, f64),
    /// Nearer to axis 1 nothing is known of a point. m
    nearest: f64,
}

/// The posture classes that are still of interest in a box, a bit each, segment by segment.
type Classes = Option<Arc<[u8]>>;

/// A box of placements: x, y and height of the workpiece origin about axis 1, in the directions of the workpiece.
type Box3 = Region;

/// Bounds the objective of all placements of a problem from below, whose cell is made of pieces: see [`super::best()`].
pub(super) fn best(
    problem: &Problem,
    pieces: &[Cell],
    value: f64,
    settings: &CertificateSettings,
    monitor: &Monitor,
) -> Bound {
    let CertificateSettings { gap, memory, .. } = *settings;
    let objective = Objective::of(problem);
    let search = BranchAndBound { sense: Sense::Min, value, gap, keeps: Keeps::NOTHING, objective, memory };
    let ceiling = search.ceiling();
    let model = Leaning { yaws: Yaws::of(pieces, problem), ..Leaning::new(problem, ceiling) };
    let start = model.start(&whole(problem)).into_iter();
    let all = Parts {
        start: start.map(|region| Open { bound: 0.0, region, known: None }).collect(),
        nodes: 0,
        of: |open: &Open<Classes>| model.parts(open, ceiling, monitor),
        used: || model.axes.iter().map(Cells::used).sum(),
        bytes: |known: &Classes| known.as_ref().map_or(0, |known| known.len() as u64),
        count: |counted: &mut KeepsOpen, region: &Box3, known: &Classes| {
            some_points(model.points.len()).for_each(|point| model.count(counted, region, known, point));
        },
    };
    let mut bound = search.explore(all, monitor, |_| None);
    // About axis 1 a box is part of a larger region, which neighbours share: what holds in all of them is the least.
    let least = bound.open.iter().map(|open| open.1).fold(f64::INFINITY, f64::min);
    bound.open.iter_mut().for_each(|(region, bound)| (*region, *bound) = (about_axis_1(region), least));
    bound
}

/// Radius, height and yaw less azimuth of a box.
fn about_axis_1(of: &Box3) -> Region {
    let [x, y, z] = of.middle;
    let (middle, reach) = (libm::hypot(x, y), libm::hypot(of.half[0], of.half[1]));
    let (near, far) = ((middle - reach).max(0.0), middle + reach);
    Region {
        middle: [0.5 * (near + far), z, -libm::atan2(y, x)],
        half: [0.5 * (far - near), of.half[2], half_angle(middle, reach)],
    }
}

/// Half the angle that a circle is seen under. rad
fn half_angle(distance: f64, radius: f64) -> f64 {
    if radius >= distance { PI } else { libm::asin(radius / distance) }
}

impl Leaning {
    /// For boxes that are of interest where all points together cost less than `ceiling`.
    fn new(problem: &Problem, ceiling: f64) -> Self {
        let (axes, side, extent, region) = (axes_of(problem), side(problem), extent(problem), whole(problem));
        let robot = problem.scored_robots()[0].clone();
        let nearest = extent.radius.0;
        let path = problem.task.points();
        let axis_at = |point: usize| {
            let axis = seen(&path[point].axis, side);
            axes.iter().position(|other| (other - axis).norm() <= SAME).unwrap_or(0)
        };
        let mut points: Vec<LeaningPoint> = (0..path.len())
            .map(|point| LeaningPoint {
                at: seen(&path[point].position, side).into(),
                axis: axis_at(point),
                kind: None,
            })
            .collect();
        let aggregate = problem.criterion.aggregate;
        let of_axis = |number: usize| {
            let own: Vec<usize> = (0..path.len()).filter(|point| points[*point].axis == number).collect();
            let loads: Vec<Load> = own.iter().map(|point| Load::seen(problem, *point, 0.0, side).signed()).collect();
            let (kinds, of) = kinds_of(loads.iter());
            (kinds, own.into_iter().zip(of).collect::<Vec<_>>())
        };
        let of_axes: Vec<_> = (0..axes.len()).map(of_axis).collect();
        for (point, kind) in of_axes.iter().flat_map(|(_, of)| of) {
            points[*point].kind = *kind;
        }
        let sizes = || points.iter().filter_map(|point| point.kind).map(|(_, size)| size);
        let enough = ENOUGH
            * match aggregate {
                Aggregate::Mean => ceiling / sizes().sum::<f64>(),
                Aggregate::Rms => libm::sqrt(ceiling / sizes().map(|size| size * size).sum::<f64>()),
                Aggregate::Max => ceiling / sizes().fold(0.0, f64::max),
            };
        let cells = |(axis, (kinds, _)): (&Vector3<f64>, (Vec<_>, Vec<_>))| {
            let arm = Arm::leaning(problem, &robot, nearest, *axis);
            Cells::new(arm, kinds, enough, extent.radius.1, extent.height)
        };
        let all = axes.iter().zip(of_axes).map(cells).collect();
        Self {
            axes: all,
            points,
            segments: problem.task.segments().to_vec(),
            aggregate,
            yaws: Yaws::new(problem),
            radius: (region.middle[0] - region.half[0], region.middle[0] + region.half[0]),
            nearest,
        }
    }

    /// Boxes that hold all placements.
    fn start(&self, whole: &Region) -> Vec<Box3> {
        let half = half_of(0);
        let count = |width: f64| ((width / (2.0 * half)).ceil() as usize).max(1);
        let (plan, up) = (count(2.0 * self.radius.1), count(2.0 * whole.half[1]));
        let (half_plan, half_up) = (self.radius.1 / plan as f64, whole.half[1] / up as f64);
        let at = |k: usize, half: f64, from: f64| from + half * (2 * k + 1) as f64;
        let numbers = (0..plan * plan * up).map(|k| (k / up / plan, k / up % plan, k % up));
        let boxes = numbers.map(|(i, j, k)| Region {
            middle: [
                at(i, half_plan, -self.radius.1),
                at(j, half_plan, -self.radius.1),
                at(k, half_up, whole.middle[1] - whole.half[1]),
            ],
            half: [half_plan, half_plan, half_up],
        });
        boxes.filter(|region| self.allows(region)).collect()
    }

    /// Whether some placement of the cell may be in a box, as far as distance and yaw tell.
    fn allows(&self, region: &Box3) -> bool {
        let side = |k: usize| (region.middle[k].abs() - region.half[k], region.middle[k].abs() + region.half[k]);
        let [(x0, x1), (y0, y1)] = [0, 1].map(side);
        let (near, far) = (libm::hypot(x0.max(0.0), y0.max(0.0)), libm::hypot(x1, y1));
        if far < self.radius.0 - 1e-9 || near > self.radius.1 + 1e-9 {
            return false;
        }
        self.yaws.allow(&about_axis_1(region))
    }

    /// A box that was not bounded yet with its bound, or the parts of one with theirs; `None` where it is not to be cut
    /// further.
    fn parts(&self, open: &Open<Classes>, ceiling: f64, monitor: &Monitor) -> Option<Vec<Open<Classes>>> {
        let (parts, classes) = match &open.known {
            None => (vec![open.region], Arc::from(vec![15; self.segments.len()])),
            Some(classes) => (eighths(&open.region)?, Arc::clone(classes)),
        };
        let bound = |region: Box3| {
            let (sum, classes) = self.lower_bound(&region, &classes, ceiling, monitor);
            Open { bound: sum.max(open.bound), region, known: Some(classes) }
        };
        Some(parts.into_iter().filter(|part| self.allows(part)).map(bound).collect())
    }

    /// What all points cost at least together, over a box, up to `ceiling`; and the classes that may still be of
    /// interest in it. Once the caller asks to stop, what is returned is no bound.
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    fn lower_bound(&self, region: &Box3, classes: &[u8], ceiling: f64, monitor: &Monitor) -> (f64, Arc<[u8]>) {
        let mut totals = [0.0; CORNERS];
        let mut all: Vec<[[f64; CORNERS]; 4]> = Vec::with_capacity(self.segments.len());
        for (span, active) in self.segments.iter().zip(classes) {
            let mut of_classes = [INFINITE; 4];
            for class in PostureClass::ALL {
                let number = class.index();
                if active >> number & 1 == 0 {
                    continue;
                }
                let mut sum = [0.0; CORNERS];
                for point in &self.points[span.clone()] {
                    if monitor.should_stop() {
                        return (0.0, Arc::from(classes));
                    }
                    let cost = self.cost(point, region, class).unwrap_or(INFINITE);
                    sum = joined(self.aggregate, &sum, &cost);
                    // With that class the box is of no interest, whatever the other points cost.
                    if joined(self.aggregate, &totals, &sum).into_iter().all(|sum| sum >= ceiling) {
                        sum = INFINITE;
                        break;
                    }
                }
                of_classes[number] = sum;
            }
            if of_classes.iter().all(|sum| sum[0] == f64::INFINITY) {
                return (ceiling, Arc::from(classes));
            }
            let mut best = INFINITE;
            of_classes.iter().for_each(|sum| min_into(&mut best, sum));
            totals = joined(self.aggregate, &totals, &best);
            all.push(of_classes);
        }
        let sum = totals.iter().copied().fold(ceiling, f64::min);
        let left = |of: &[[f64; CORNERS]; 4]| {
            let mut best = INFINITE;
            of.iter().for_each(|sum| min_into(&mut best, sum));
            let is_left = |number: &usize| {
                let through: [f64; CORNERS] = match self.aggregate {
                    Aggregate::Mean | Aggregate::Rms => {
                        plus(&of[*number], &std::array::from_fn(|k| totals[k] - best[k]))
                    }
                    Aggregate::Max => of[*number],
                };
                through.into_iter().any(|sum| sum < ceiling)
            };
            (0..4).filter(is_left).fold(0, |bits, number| bits | 1 << number)
        };
        let left: Arc<[u8]> = if sum < ceiling { all.iter().map(left).collect() } else { Arc::from(classes) };
        (sum, left)
    }

    /// What a point costs at least at the corners of a box; `None` where none of its states is allowed.
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    fn cost(&self, point: &LeaningPoint, region: &Box3, class: PostureClass) -> Option<[f64; CORNERS]> {
        let middle: [f64; 3] = std::array::from_fn(|k| region.middle[k] + point.at[k]);
        let half = region.half;
        let inner = |k: usize| (middle[k].abs() - half[k]).max(0.0);
        // Nearer to axis 1 the closed form need not be true.
        let nearest = self.radius.0 - libm::hypot(point.at[0], point.at[1]);
        if libm::hypot(inner(0), inner(1)).max(nearest) < self.nearest - 1e-9 {
            return Some([0.0; CORNERS]);
        }
        let cells = &self.axes[point.axis];
        let level = level_of(region);
        let numbers: [(usize, usize); 3] =
            std::array::from_fn(|k| cells.between(level, k, middle[k] - half[k], middle[k] + half[k]));
        let (kind, size) = point.kind.unwrap_or((0, 0.0));
        let mut found = [None; MOST_CELLS];
        let mut count = 0;
        let [(i0, i1), (j0, j1), (k0, k1)] = numbers;
        for i in i0..=i1 {
            for j in j0..=j1 {
                for k in k0..=k1 {
                    let below = cells.below(level, [i, j, k], class);
                    let Some(e) = below.get(kind).filter(|e| e.value < f32::INFINITY) else { continue };
                    if let Some(place) = found.get_mut(count) {
                        *place = Some(Part::new(cells, level, [i, j, k], e, &Region { middle, half }));
                    }
                    count += 1;
                }
            }
        }
        if count == 0 {
            return None;
        }
        if count > found.len() || point.kind.is_none() {
            return Some([0.0; CORNERS]);
        }
        let all = || found.iter().flatten();
        let slope = all().min_by(|a, b| a.low().total_cmp(&b.low()))?.slope;
        let value = all().map(|part| part.left(slope)).fold(f64::INFINITY, f64::min);
        Some(cost_at_corners((size * value, slope.map(|s| size * s)), region, self.aggregate))
    }
}

impl Leaning {
    /// Counts what is known of the states of a path point that the bound of a box still counts, in the classes that are
    /// of interest.
    fn count(&self, counted: &mut KeepsOpen, region: &Box3, classes: &Classes, number: usize) {
        let point = &self.points[number];
        let segment = self.segments.iter().position(|span| span.contains(&number)).unwrap_or(0);
        let active = classes.as_ref().map_or(15, |classes| classes[segment]);
        let (cells, level) = (&self.axes[point.axis], level_of(region));
        // One cell for all that the box is in: that of its middle.
        let at = std::array::from_fn(|k| {
            let middle = region.middle[k] + point.at[k];
            cells.between(level, k, middle, middle).0
        });
        for class in PostureClass::ALL.into_iter().filter(|class| active >> class.index() & 1 == 1) {
            cells.pieces(level, at, class).for_each(|(place, half)| count(counted, &cells.arm, place, half, class));
        }
    }
}

/// The finest level whose cells are no smaller than a box.
fn level_of(region: &Box3) -> usize {
    let widest = region.half.into_iter().fold(0.0, f64::max) * (1.0 - 1e-9);
    (0..LEVELS).rev().find(|level| half_of(*level) >= widest).unwrap_or(0)
}

/// Cells that a box no larger than they are can be in, where rounding lets it touch one on each side.
const MOST_CELLS: usize = 27;

/// The part of a box that is in a cell, and an affine function below what a load of size 1 costs there.
#[derive(Debug, Clone, Copy)]
struct Part {
    /// In the middle of the part. m
    value: f64,
    slope: [f64; 3],
    /// That middle from the middle of the box, and half widths. m
    off: [f64; 3],
    half: [f64; 3],
}

impl Part {
    /// Of a box.
    fn new(cells: &Cells, level: usize, at: [usize; 3], e: &Affine, of: &Box3) -> Self {
        let Box3 { middle, half } = *of;
        let slope = e.slope.map(f64::from);
        let mut part = Self { value: f64::from(e.value), slope, off: [0.0; 3], half: [0.0; 3] };
        for k in 0..3 {
            let own = cells.middle(level, k, at[k]);
            let from = (middle[k] - half[k]).max(own - half_of(level));
            let to = (middle[k] + half[k]).min(own + half_of(level));
            let of_part = 0.5 * (from + to);
            (part.off[k], part.half[k]) = (of_part - middle[k], 0.5 * (to - from).max(0.0));
            part.value += slope[k] * (of_part - own);
        }
        part
    }

    /// The least in it.
    fn low(&self) -> f64 {
        self.value - (0..3).map(|k| self.slope[k].abs() * self.half[k]).sum::<f64>()
    }

    /// What a function with these slopes may be in the middle of the box, not to be above it anywhere in the part.
    fn left(&self, slope: [f64; 3]) -> f64 {
        let turned = |k: usize| (self.slope[k] - slope[k]).abs() * self.half[k] + slope[k] * self.off[k];
        self.value - (0..3).map(turned).sum::<f64>()
    }
}

/// The parts of a box, cut along every side that is not much shorter than the longest; `None` where it is not to be cut
/// further.
fn eighths(region: &Box3) -> Option<Vec<Box3>> {
    let longest = region.half.into_iter().fold(0.0, f64::max);
    if longest <= half_of(LEVELS - 1) {
        return None;
    }
    let mut parts = vec![*region];
    for side in (0..3).filter(|side| region.half[*side] > 0.6 * longest) {
        parts = parts.iter().flat_map(|part| part.split(side)).collect();
    }
    Some(parts)
}

#[cfg(test)]
mod tests;
