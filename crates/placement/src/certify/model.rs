//! From a placement problem to what is model; or the reasons why it cannot be.

use super::arm::Arm;
use super::coarse_bounds::CoarseBounds;
use super::compliance_table::{ComplianceTable, Extent, Steps};
use super::lower_bound::Model;
use super::region::{Point, Region};
use crate::problem::{Cell, Problem};
use std::f64::consts::{PI, TAU};
use std::fmt;

/// Why a problem cannot be certified this way.
#[derive(Debug, Clone, PartialEq)]
pub enum Unfit {
    /// The arm stands neither upright nor upside down; the angle of axis 1 from the vertical of the base frame. rad
    Leaning(f64),
    /// The tool axis of a path point (from 0) is not along axis 1, or not the same way as that of the first.
    Tilted(usize),
    /// The wrench of a path point (from 0) has a moment.
    Moment(usize),
    /// Compliances change with the joint angles.
    VaryingCompliance,
    /// Scores cover errors of the force or of the compliances.
    Uncertainty,
    /// The least inverse condition is so small that arms may be all but stretched, folded or have axes 4 and 6 all but in
    /// line; what it would have to be.
    Conditioning(f64),
    /// Tables would not fit in memory: what they would take, and what is allowed. bytes
    TooLarge(u64, u64),
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Leaning(angle) => write!(
                f,
                "axis 1 leans {:.3} deg from the vertical; only arms that stand upright or hang upside down can be certified",
                angle.to_degrees()
            ),
            Self::Tilted(point) => write!(
                f,
                "the tool axis of path point {point} (from 0) is not vertical, or not the same way as at the first point; only \
                 upright tools can be certified"
            ),
            Self::Moment(point) => {
                write!(f, "the wrench of path point {point} (from 0) has a moment; only forces can be certified")
            }
            Self::VaryingCompliance => {
                write!(f, "a joint compliance changes with the joint angle; only constant ones can be certified")
            }
            Self::Uncertainty => write!(
                f,
                "scores cover errors of the force or of the compliances (criterion.force_uncertainty, criterion.confidence); only \
                 plain scores can be certified"
            ),
            Self::Conditioning(least) => write!(
                f,
                "constraints.min_inverse_condition must be at least {least:.3} for a certificate: nearer to a singularity \
                 nothing can be model"
            ),
            Self::TooLarge(bytes, allowed) => write!(
                f,
                "the cell is so large that tables would take {:.1} GB, where {:.1} GB are allowed",
                *bytes as f64 / 1e9,
                *allowed as f64 / 1e9
            ),
        }
    }
}

impl std::error::Error for Unfit {}

/// An axis may lean by this much (rad) and is then taken as vertical.
const LEANING: f64 = 1e-9;
/// What tables may take, empty. bytes
const MEMORY: u64 = 400_000_000;
/// Steps of the coarsest tables, and their number.
const STEPS: Steps = Steps { length: 0.025, headings: 128 };
const LEVELS: usize = 4;

/// Whether a problem can be certified, found without work.
///
/// # Errors
/// The first reason why not.
pub fn certifiable(problem: &Problem) -> Result<(), Unfit> {
    let g = problem.robot.geometry();
    let upright = g.base_from_root[(2, 2)];
    if 1.0 - upright.abs() > LEANING * LEANING {
        return Err(Unfit::Leaning(libm::acos(upright.abs())));
    }
    let points = problem.task.points();
    let first = points.first().map_or(1.0, |p| p.axis.z.signum());
    if let Some(point) = points.iter().position(|p| libm::hypot(p.axis.x, p.axis.y) > LEANING || p.axis.z * first < 0.0)
    {
        return Err(Unfit::Tilted(point));
    }
    if let Some(point) = problem.task.wrenches().iter().position(|w| w.moment.norm() != 0.0) {
        return Err(Unfit::Moment(point));
    }
    if problem.robot.constant_compliances().is_none() {
        return Err(Unfit::VaryingCompliance);
    }
    let confident = problem.criterion.confidence != 0.0 && problem.robot.uncertainty().is_some();
    if problem.criterion.force_uncertainty != 0.0 || confident {
        return Err(Unfit::Uncertainty);
    }
    let place = extent(problem);
    if let Some(least) = Arm::least_condition(problem, place.radius.0) {
        return Err(Unfit::Conditioning(least));
    }
    let bytes = ComplianceTable::bytes(place, STEPS, LEVELS).saturating_add(CoarseBounds::bytes(
        place,
        STEPS,
        &points_of(problem),
    ));
    if bytes > MEMORY { Err(Unfit::TooLarge(bytes, MEMORY)) } else { Ok(()) }
}

/// Everything that bounds are made of, and the box of all placements.
pub(super) fn prepared(problem: &Problem, compliances: &[f64; 6], with_rate: bool) -> (Model, Region) {
    let extent = extent(problem);
    let arm = Arm::new(problem, compliances, extent.radius.0);
    let rate = |point: usize| if with_rate && point > 0 { problem.beta_step_limit(point) } else { f64::INFINITY };
    let points = points_of(problem);
    let model = Model {
        arm,
        table: ComplianceTable::new(extent, STEPS, LEVELS),
        rates: (0..points.len()).map(rate).collect(),
        points,
        segments: problem.task.segments().to_vec(),
        first: compliances[0],
        yaws: Yaws::new(problem),
    };
    (model, whole(problem))
}

/// Which way up the arm stands: +1, or -1 upside down.
fn side(problem: &Problem) -> f64 {
    problem.robot.geometry().base_from_root[(2, 2)].signum()
}

/// Path points and their forces as seen along axis 1; for a hanging arm y and z change sign.
fn points_of(problem: &Problem) -> Vec<Point> {
    let side = side(problem);
    let task = &problem.task;
    let one = |(p, w): (&stead_model::task::PathPoint, &stead_model::task::Wrench)| {
        let (x, y) = (p.position.x, p.position.y * side);
        let feed = libm::atan2(p.feed.y * side, p.feed.x);
        let (sine, cosine) = libm::sincos(feed);
        let (fx, fy) = (w.force.x, w.force.y * side);
        Point {
            distance: libm::hypot(x, y),
            direction: libm::atan2(y, x),
            height: p.position.z * side,
            feed,
            force: [fx * cosine + fy * sine, fy * cosine - fx * sine, w.force.z * side],
        }
    };
    task.points().iter().zip(task.wrenches()).map(one).collect()
}

/// The corners of the cell about axis 1, x and y. m
fn corners(cell: &Cell, problem: &Problem) -> [[f64; 2]; 2] {
    let root = problem.robot.geometry().root_in_base;
    let [x, y, _] = cell.position;
    [[x.min - root.x, x.max - root.x], [y.min - root.y, y.max - root.y]]
}

/// All placements of the cell as radius, height and yaw less azimuth.
fn whole(problem: &Problem) -> Region {
    let side = side(problem);
    let [[x0, x1], [y0, y1]] = corners(&problem.cell, problem);
    let gap = |a: f64, b: f64| if a > 0.0 { a } else { (-b).max(0.0) };
    let near = libm::hypot(gap(x0, x1), gap(y0, y1));
    let far = libm::hypot(x0.abs().max(x1.abs()), y0.abs().max(y1.abs()));
    let z = problem.cell.position[2];
    let root = problem.robot.geometry().root_in_base.z;
    let (a, b) = ((z.min - root) * side, (z.max - root) * side);
    Region { middle: [(near + far) / 2.0, (a + b) / 2.0, 0.0], half: [(far - near) / 2.0, (a - b).abs() / 2.0, PI] }
}

/// Where path points of placements of the cell can be.
fn extent(problem: &Problem) -> Extent {
    let region = whole(problem);
    let points = points_of(problem);
    let most = points.iter().map(|p| p.distance).fold(0.0, f64::max);
    let low = points.iter().map(|p| p.height).fold(f64::INFINITY, f64::min);
    let high = points.iter().map(|p| p.height).fold(f64::NEG_INFINITY, f64::max);
    let [(near, far), (bottom, top)] =
        [0, 1].map(|k| (region.middle[k] - region.half[k], region.middle[k] + region.half[k]));
    Extent { radius: ((near - most).max(NEAREST), far + most), height: (bottom + low, top + high) }
}

/// Nearer to axis 1 nothing is known of a path point. m
const NEAREST: f64 = 0.05;

/// Which yaws less azimuth the cell allows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Yaws {
    /// Middle and half width of the range, where it is not the whole turn. rad
    pub(super) range: Option<(f64, f64)>,
}

impl Yaws {
    fn new(problem: &Problem) -> Self {
        let cell = &problem.cell;
        let [[x0, x1], [y0, y1]] = corners(cell, problem);
        let around = x0 <= 0.0 && x1 >= 0.0 && y0 <= 0.0 && y1 >= 0.0;
        if cell.is_yaw_free() || around {
            return Self { range: None };
        }
        // Azimuths of the four corners about that of the middle: less than half a turn apart in all.
        let middle = libm::atan2(y0 + y1, x0 + x1);
        let off = |x: f64, y: f64| stead_model::robot::angles::wrap(libm::atan2(y, x) - middle);
        let all = [off(x0, y0), off(x0, y1), off(x1, y0), off(x1, y1)];
        let (low, high) =
            (all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(f64::NEG_INFINITY, f64::max));
        let (from, to) = (cell.yaw.min - middle - high, cell.yaw.max - middle - low);
        let range = (to - from < TAU).then_some((side(problem) * (from + to) / 2.0, (to - from) / 2.0 + 1e-9));
        Self { range }
    }

    /// Whether some placement of a box is in the cell, as far as its yaw tells.
    pub fn allow(&self, region: &Region) -> bool {
        self.range.is_none_or(|(middle, half)| {
            stead_model::robot::angles::wrap(region.middle[2] - middle).abs() <= half + region.half[2]
        })
    }
}
