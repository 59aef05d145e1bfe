//! What segments share of a placement where external axes have another position for each, divided into cells.

use super::cell::{SAME, corners, side, whole};
use super::region::Region;
use super::requirements::farthest;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::RangeInclusive;
use stead_model::external_axis::{AxisKind, AxisUse, ExternalAxis};
use stead_model::robot::angles::wrap;
use stead_problem::problem::Problem;

/// Cells of what is shared, seen along axis 1: of a length, of the height, and of an angle. One cell where something is
/// not shared.
#[derive(Debug)]
pub(super) struct SharedCells {
    shared: SharedMotion,
    /// Lengths and heights of the problem's cell: from and to. m
    ends: [[f64; 2]; 2],
    /// Width of a cell of lengths and of heights. m
    step: [f64; 2],
    counts: [usize; 3],
    /// Narrow ranges of azimuths in which the part may be.
    azimuths: Vec<Azimuth>,
    /// Where it may be, all positions of the axes together: x and y, from and to. m
    corners: [[f64; 2]; 2],
    /// Which angles of a turn the problem's cell allows.
    angles: Vec<bool>,
}

/// What the length and the angle are.
#[derive(Debug, Clone, Copy)]
enum SharedMotion {
    /// Rails: the coordinate in the direction across them, of which this is the azimuth (rad), and the yaw.
    AcrossRails(f64),
    /// A turntable: the distance from its axis, which is there (m), and the yaw less the azimuth about it.
    AboutTable([f64; 2]),
}

/// A narrow range of azimuths.
#[derive(Debug)]
struct Azimuth {
    /// From and to. rad
    ends: [f64; 2],
    /// The least and the largest coordinates of unit vectors: x, y, and across the rails.
    units: [[f64; 2]; 3],
}

/// Cells of the angle, of a turn; and azimuths in each.
const ANGLES: usize = 128;
const AZIMUTHS: usize = 4;
/// Width of a cell of lengths (m), how many of these there are at most, and how many cells of all segments.
const WIDTH: f64 = 0.025;
const MOST: usize = 64;
const MOST_OF_ALL: usize = 20_000_000;
/// How far cells begin before the ends, in terms of their width: so that boxes, halved again and again, have no side in
/// common with them.
const BEFORE: f64 = 2.0 / 3.0;
/// Boxes reach farther by this: rounding. m, rad
const FARTHER: f64 = 1e-9;

impl SharedCells {
    /// Of a problem in the cell of what segments share, and the same in that of all places to which its axes bring the
    /// part ([`super::part::Part::Apart`]).
    pub fn new(problem: &Problem, widened: &Problem) -> Self {
        let (side, region) = (side(problem), whole(problem));
        let (shared, is_shared) = SharedMotion::of(problem, side);
        let [x, y] = corners(&problem.cell, problem);
        let places = [[0, 0], [0, 1], [1, 0], [1, 1]].map(|[i, j]| [x[i], y[j] * side]);
        let height = [region.middle[1] - region.half[1], region.middle[1] + region.half[1]];
        let ends = [shared.lengths(places), height];
        let most = (MOST_OF_ALL / ANGLES / problem.task.segments().len()).isqrt().clamp(1, MOST);
        let divided = |k: usize| {
            let [low, high] = ends[k];
            let count = (((high - low) / WIDTH).ceil() as usize).clamp(1, most);
            if is_shared[k] { (count + 1, (high - low).max(WIDTH) / count as f64) } else { (1, f64::INFINITY) }
        };
        let [(lengths, length), (heights, height)] = [0, 1].map(divided);
        let counts = [lengths, heights, if is_shared[2] { ANGLES } else { 1 }];
        let [x, y] = corners(&widened.cell, widened);
        let (reach, corners) = (whole(widened), [x, ends_of(y.map(|y| y * side))]);
        let radius = [reach.middle[0] - reach.half[0], reach.middle[0] + reach.half[0]];
        let width = TAU / (ANGLES * AZIMUTHS) as f64;
        let azimuths = (0..ANGLES * AZIMUTHS)
            .map(|k| Azimuth::new([k as f64 * width, (k + 1) as f64 * width], shared))
            .filter(|azimuth| azimuth.meets(radius, corners))
            .collect();
        let (cell, of_yaw) = (problem.cell, is_shared[2] && matches!(shared, SharedMotion::AcrossRails(_)));
        let is_allowed = |k: usize| {
            let middle = (k as f64 + 0.5 - BEFORE) * TAU / ANGLES as f64;
            let half = cell.yaw.width() / 2.0 + PI / ANGLES as f64 + FARTHER;
            let off = wrap(side * middle - (cell.yaw.min + cell.yaw.max) / 2.0).abs();
            !of_yaw || cell.is_yaw_free() || off <= half
        };
        let angles = (0..counts[2]).map(is_allowed).collect();
        Self { shared, ends, step: [length, height], counts, azimuths, corners, angles }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.counts.iter().product()
    }

    /// What is left out where segments are held together by these cells alone: in words.
    pub fn left_out(&self) -> Vec<String> {
        let is_shared = self.counts.map(|count| count > 1);
        let names = ["x", "y", "z", "yaw"].into_iter().zip([0, 0, 1, 2]);
        let free: Vec<&str> = names.filter(|(_, k)| !is_shared[*k]).map(|of| of.0).collect();
        let length = self.step.into_iter().filter(|step| step.is_finite()).reduce(f64::max);
        let length = length.map(|step| format!("{} mm", (step * 1e3).ceil()));
        let angle = is_shared[2].then(|| format!("{:.1} deg", 360.0 / ANGLES as f64));
        let widths: Vec<String> = length.into_iter().chain(angle).collect();
        let all_free = (!free.is_empty()).then(|| format!("that all segments have the same {}", free.join(", ")));
        let apart = format!("differences of up to {} between the places of segments", widths.join(" and "));
        all_free.into_iter().chain((!widths.is_empty()).then_some(apart)).collect()
    }

    /// What is known of all of them for so many segments takes. bytes
    pub fn bytes(&self, segments: usize) -> u64 {
        (2 * self.count() * segments * size_of::<f64>()) as u64
    }

    /// The cells of lengths (0) or heights (1) that a range reaches; `None` where it leaves the problem's cell.
    fn along(&self, side: usize, range: [f64; 2]) -> Option<RangeInclusive<usize>> {
        if self.counts[side] == 1 {
            return Some(0..=0);
        }
        let ([low, high], [first, last]) = ([range[0] - FARTHER, range[1] + FARTHER], self.ends[side]);
        let place = |at: f64| ((at.clamp(first, last) - first) / self.step[side] + BEFORE) as usize;
        (low <= last && high >= first).then(|| place(low)..=place(high).min(self.counts[side] - 1))
    }

    /// Calls with every cell that placements of a box reach, some of them more than once.
    pub fn reached(&self, region: &Region, mut call: impl FnMut(usize)) {
        let [radius, height, turn] = [0, 1, 2].map(|k| {
            let (middle, half) = (region.middle[k], region.half[k]);
            [middle - half, middle + half]
        });
        let Some(heights) = self.along(1, height) else { return };
        let [_, _, angles] = self.counts;
        for azimuth in self.azimuths.iter().filter(|azimuth| azimuth.meets(radius, self.corners)) {
            let (length, [from, to]) = azimuth.shared(self.shared, radius, turn);
            let Some(lengths) = self.along(0, length) else { continue };
            // From zero to two turns.
            let begin = (from - FARTHER).rem_euclid(TAU);
            let place = |angle: f64| (angle * ANGLES as f64 / TAU + BEFORE) as usize;
            let around = match place(begin)..=place(begin + (to - from) + 2.0 * FARTHER) {
                all if angles == 1 || all.end() - all.start() >= angles => 0..=angles - 1,
                some => some,
            };
            for i in lengths {
                for j in heights.clone() {
                    let some = around.clone().map(|k| k % angles).filter(|k| self.angles[*k]);
                    some.for_each(|k| call((i * self.counts[1] + j) * angles + k));
                }
            }
        }
    }
}

impl SharedMotion {
    /// What segments of a problem share, seen along axis 1 from a `side`: and whether it is a length, the height, an
    /// angle.
    fn of(problem: &Problem, side: f64) -> (Self, [bool; 3]) {
        let axes = &problem.external_axes;
        let indexed = || axes.iter().filter(|axis| axis.axis_use == AxisUse::Indexed);
        let is_rail = |axis: &ExternalAxis| axis.kind == AxisKind::Rail;
        let is_level = |axis: &ExternalAxis| !is_rail(axis) || axis.direction.z.abs() < SAME;
        let first = indexed().next();
        let is_alike = |axis: &ExternalAxis| {
            first.is_some_and(|first| match axis.kind {
                AxisKind::Rail => axis.direction.cross(&first.direction).norm() < SAME,
                AxisKind::Turntable => (axis.point - first.point).xy().norm() < SAME,
            })
        };
        // A turntable turns the rails that it carries, and a rail or another turntable shifts the axis of one.
        let are_rails = axes.iter().all(is_rail) && indexed().all(is_alike) && indexed().all(is_level);
        let are_tables = axes.iter().all(|axis| !is_rail(axis) && is_alike(axis));
        let has_length = are_rails || are_tables;
        let is_shared = [has_length, indexed().all(is_level), has_length || indexed().all(is_rail)];
        let root = problem.robot.geometry().root_in_base;
        let shared = match first {
            Some(axis) if are_tables => Self::AboutTable([axis.point.x - root.x, (axis.point.y - root.y) * side]),
            along => {
                let along = along.map_or([1.0, 0.0], |axis| [axis.direction.x, axis.direction.y * side]);
                Self::AcrossRails(libm::atan2(along[1], along[0]) + FRAC_PI_2)
            }
        };
        (shared, is_shared)
    }

    /// The length over a cell with those corners: from and to. m
    fn lengths(self, corners: [[f64; 2]; 4]) -> [f64; 2] {
        match self {
            Self::AcrossRails(across) => {
                let (sine, cosine) = libm::sincos(across);
                ends_of(corners.map(|[x, y]| cosine * x + sine * y))
            }
            Self::AboutTable([x0, y0]) => {
                let [_, far] = ends_of(corners.map(|[x, y]| libm::hypot(x - x0, y - y0)));
                [0.0, far]
            }
        }
    }
}

/// The least and the largest.
fn ends_of<const N: usize>(all: [f64; N]) -> [f64; 2] {
    all.into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |ends, x| [ends[0].min(x), ends[1].max(x)])
}

impl Azimuth {
    /// Between two ends.
    fn new(ends: [f64; 2], shared: SharedMotion) -> Self {
        let across = match shared {
            SharedMotion::AcrossRails(across) => across,
            SharedMotion::AboutTable(_) => 0.0,
        };
        let unit = |direction: f64| {
            let range = farthest(1.0, ends[0] - direction, ends[1] - direction);
            [range.min, range.max]
        };
        Self { ends, units: [unit(0.0), unit(FRAC_PI_2), unit(across)] }
    }

    /// A coordinate over radii: from and to.
    fn coordinate(&self, number: usize, radius: [f64; 2]) -> [f64; 2] {
        let ([low, high], [near, far]) = (self.units[number], radius.map(|radius| radius.max(0.0)));
        [low * if low > 0.0 { near } else { far }, high * if high > 0.0 { far } else { near }]
    }

    /// Whether it meets a cell of those x and y within those radii.
    fn meets(&self, radius: [f64; 2], cell: [[f64; 2]; 2]) -> bool {
        cell.into_iter().enumerate().all(|(number, [from, to])| {
            let [low, high] = self.coordinate(number, radius);
            low <= to + FARTHER && high >= from - FARTHER
        })
    }

    /// The shared length and angle over radii and yaws less azimuth: from and to.
    fn shared(&self, shared: SharedMotion, radius: [f64; 2], turn: [f64; 2]) -> ([f64; 2], [f64; 2]) {
        let yaw = [turn[0] + self.ends[0], turn[1] + self.ends[1]];
        let axis = match shared {
            SharedMotion::AcrossRails(_) => return (self.coordinate(2, radius), yaw),
            SharedMotion::AboutTable(axis) => axis,
        };
        let [[x0, x1], [y0, y1]] = [0, 1].map(|k| self.coordinate(k, radius));
        let (x, y) = ((x0 + x1) / 2.0 - axis[0], (y0 + y1) / 2.0 - axis[1]);
        // All of it is as near to its middle.
        let (distance, near) = (libm::hypot(x, y), libm::hypot(x1 - x0, y1 - y0) / 2.0);
        let azimuth = libm::atan2(y, x);
        let off = if near < distance { libm::asin(near / distance) } else { PI };
        ([distance - near, distance + near], [yaw[0] - azimuth - off, yaw[1] - azimuth + off])
    }
}

#[cfg(test)]
mod tests {
    use super::super::cell::Yaws;
    use super::super::part::Part;
    use super::super::part::tests::moved;
    use super::super::tests::{hanging_arm, seeded};
    use super::*;
    use nalgebra::Vector3;
    use rand::RngExt;
    use std::collections::HashSet;
    use stead_model::external_axis::Carried;
    use stead_model::testing::some;
    use stead_problem::problem::{Cell, Interval, Placement};
    use stead_problem::symmetry::about_axis_1;
    use stead_problem::testing::five_segments;

    fn axis(kind: AxisKind, carries: Carried, axis_use: AxisUse, direction: [f64; 3], point: [f64; 2]) -> ExternalAxis {
        let (min, max) = if kind == AxisKind::Rail { (-0.3, 0.5) } else { (-2.0, 1.0) };
        let (direction, point) = (Vector3::from(direction).normalize(), Vector3::new(point[0], point[1], 0.0));
        ExternalAxis {
            name: format!("{direction:?}"),
            kind,
            carries,
            direction,
            point,
            min,
            max,
            max_speed: None,
            axis_use,
        }
    }

    /// Sets of axes, and what they leave to share: a length, the height, an angle.
    fn sets() -> Vec<(Vec<ExternalAxis>, [bool; 3])> {
        use {AxisKind::*, AxisUse::*, Carried::*};
        let at = [1.2, 0.1];
        let rail = |carries, axis_use, direction| axis(Rail, carries, axis_use, direction, [0.0; 2]);
        let table = |carries, axis_use, at| axis(Turntable, carries, axis_use, [0.0, 0.0, 1.0], at);
        let [along_x, along_y, oblique] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 2.0, 0.0]];
        let under = axis(Turntable, Workpiece, Indexed, [0.0, 0.0, -1.0], at);
        vec![
            (vec![rail(Workpiece, Indexed, along_y)], [true; 3]),
            (vec![rail(Robot, Indexed, oblique)], [true; 3]),
            (vec![rail(Workpiece, Fixed, along_x), rail(Robot, Indexed, along_y)], [true; 3]),
            (vec![rail(Workpiece, Indexed, along_x), rail(Robot, Indexed, along_y)], [false, true, true]),
            (vec![rail(Workpiece, Indexed, [0.0, 0.6, 0.8])], [false, false, true]),
            (vec![table(Workpiece, Indexed, at)], [true; 3]),
            (vec![under], [true; 3]),
            (vec![table(Robot, Indexed, at)], [true; 3]),
            (vec![table(Workpiece, Indexed, at), table(Workpiece, Fixed, at)], [true; 3]),
            (vec![table(Workpiece, Indexed, at), table(Workpiece, Fixed, [0.9, 0.0])], [false, true, false]),
            (vec![table(Workpiece, Fixed, at), rail(Robot, Indexed, along_x)], [false, true, true]),
            (vec![rail(Workpiece, Fixed, along_y), table(Workpiece, Indexed, at)], [false, true, false]),
        ]
    }

    impl SharedCells {
        /// The cell of a place (x and y, m), and the same about axis 1.
        fn holding(&self, (x, y): (f64, f64), [_, height, turn]: [f64; 3]) -> usize {
            let yaw = turn + libm::atan2(y, x);
            let (length, angle) = match self.shared {
                SharedMotion::AcrossRails(across) => (x * libm::cos(across) + y * libm::sin(across), yaw),
                SharedMotion::AboutTable([x0, y0]) => (libm::hypot(x - x0, y - y0), yaw - libm::atan2(y - y0, x - x0)),
            };
            let place = |k: usize, at: f64| match self.counts[k] {
                1 => 0,
                _ => ((at - self.ends[k][0]) / self.step[k] + BEFORE) as usize,
            };
            let angle = (angle.rem_euclid(TAU) * ANGLES as f64 / TAU + BEFORE) as usize % self.counts[2];
            (place(0, length) * self.counts[1] + place(1, height)) * self.counts[2] + angle
        }
    }

    /// Every box in which a segment stands reaches the cell of the placement, wherever the axes are.
    #[test]
    fn boxes_of_a_placement_reach_its_cell_wherever_the_axes_are() {
        let mut random = seeded(60);
        for (axes, shares) in some(4, sets()) {
            for mut problem in [five_segments(), hanging_arm()] {
                let [x, y] = [(0.9, 1.5), (-0.3, 0.4)].map(|(min, max)| Interval { min, max });
                let yaw =
                    if random.random() { Interval { min: -PI, max: PI } } else { Interval { min: 0.4, max: 1.9 } };
                problem.cell = Cell { position: [x, y, problem.cell.position[2]], yaw };
                problem.external_axes.clone_from(&axes);
                problem.setup = stead_problem::setup::Setup::at_rest(&axes);
                let Ok(Part::Apart(shared, leaf)) = Part::of(&problem, u64::MAX) else { panic!("{axes:?}") };
                let cells = SharedCells::new(&shared, &leaf.problem);
                let allowed = Yaws::of(&leaf.pieces, &leaf.problem);
                assert_eq!(cells.counts.map(|count| count > 1), shares, "{axes:?}");
                let (side, root) = (side(&problem), problem.robot.geometry().root_in_base);
                let seen = |at: &Placement| {
                    let [radius, z, turn] = about_axis_1(&problem, at);
                    [radius, (z - root.z) * side, turn * side]
                };
                for _ in 0..200 {
                    let mut from = |min: f64, max: f64| min + (max - min) * random.random::<f64>();
                    let [px, py, pz] = problem.cell.position.map(|range| from(range.min, range.max));
                    let at = Placement { x: px, y: py, z: pz, yaw: from(yaw.min, yaw.max) };
                    let fixed: Vec<f64> = axes.iter().map(|axis| from(axis.min, axis.max)).collect();
                    let mut cell_of_all = None;
                    for _ in 0..4 {
                        let of = |(axis, fixed): (&ExternalAxis, &f64)| match axis.axis_use {
                            AxisUse::Indexed => from(axis.min, axis.max),
                            _ => *fixed,
                        };
                        let positions: Vec<f64> = axes.iter().zip(&fixed).map(of).collect();
                        let there = moved(&axes, &positions, &at);
                        let own = *cell_of_all.get_or_insert_with(|| {
                            cells.holding((there.x - root.x, (there.y - root.y) * side), seen(&there))
                        });
                        let middle = seen(&there);
                        assert!(allowed.allow(&Region { middle, half: [0.0; 3] }), "{axes:?} {at:?} {positions:?}");
                        let size = from(0.001, 1.0);
                        let half = [0.06, 0.06, 0.2].map(|most| most * size);
                        let middle = std::array::from_fn(|k| middle[k] + half[k] * from(-1.0, 1.0));
                        let (mut holds, mut all) = (false, HashSet::new());
                        cells.reached(&Region { middle, half }, |cell| {
                            holds |= cell == own;
                            all.insert(cell);
                        });
                        assert!(holds, "{axes:?} {at:?} {positions:?}");
                        assert!(all.len() * 2 < cells.count() || shares != [true; 3], "{axes:?}");
                    }
                }
            }
        }
    }
}
