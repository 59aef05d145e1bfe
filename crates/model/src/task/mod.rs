//! What is to be cut: a tool path in segments, and the wrench at every point of it.
//!
//! Everything is in the workpiece frame. A [`ToolPath`] is geometry alone; a [`Task`] has the wrenches too.

mod following;
pub mod lean;
mod lean_forces;
mod leaned;
mod load;
mod thinned;
mod turned;

pub use lean_forces::{LeanForces, PointLeanForces};
pub use load::{PointLoad, Wrench};
pub use thinned::KeptPoint;

use crate::stiffness::matrix::MatrixError;
use nalgebra::{Matrix3, Vector3};
use std::ops::Range;
use std::sync::Arc;

/// One point of a tool path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathPoint {
    /// Tool centre point. m
    pub position: Vector3<f64>,
    /// Feed direction, of unit length.
    pub feed: Vector3<f64>,
    /// Tool axis, of unit length, from the workpiece to the robot.
    pub axis: Vector3<f64>,
}

impl PathPoint {
    /// The direction to the left of the feed seen against the tool axis, `axis x feed`, of unit length: the direction
    /// in which the deflection spoils the wall (Caro 2013, eq. 11, where the sign does not matter).
    pub fn normal(&self) -> Vector3<f64> {
        self.axis.cross(&self.feed).normalize()
    }

    /// Rotation from frame P_i (z along the tool axis, y along [`PathPoint::normal`], x the feed normal to the axis) to
    /// the workpiece frame.
    pub fn workpiece_from_point(&self) -> Matrix3<f64> {
        let normal = self.normal();
        Matrix3::from_columns(&[normal.cross(&self.axis), normal, self.axis])
    }

    /// Angle by which the feed misses the plane normal to the tool axis, positive towards the robot. rad
    pub fn feed_tilt(&self) -> f64 {
        libm::atan2(self.feed.dot(&self.axis), self.axis.cross(&self.feed).norm())
    }
}

/// The geometry of a task: points in segments. Within a segment the posture must not change.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolPath {
    points: Vec<PathPoint>,
    segments: Vec<Range<usize>>,
    surface_normals: Option<Vec<Vector3<f64>>>,
    /// Feed of the move to each point, where the task states it. m/s
    feeds: Option<Vec<f64>>,
    /// Whether each point is scored, where some are not.
    scored: Option<Vec<bool>>,
    thinned: Option<thinned::Thinned>,
    leaned: Option<leaned::Leaned>,
}

/// A tool path with what acts at every point. Geometry and loads are shared by the tasks that are made of one.
#[derive(Debug, Clone, PartialEq)]
pub struct Task {
    path: Arc<ToolPath>,
    loads: Arc<[PointLoad]>,
    /// The wrenches of a tool that leans, where they are known lean by lean.
    lean_forces: Option<Arc<LeanForces>>,
    /// The same with the tool axis that the path states, where the tool leans.
    upright: Option<Arc<Task>>,
}

/// Why points do not make a task. Points are counted from 0, in the order given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TaskError {
    /// There is no point.
    #[error("the task has no points")]
    Empty,
    /// A number is NaN or infinite.
    #[error("point {point}: {field} must be finite")]
    NotFinite {
        /// The point.
        point: usize,
        /// Which vector of it.
        field: &'static str,
    },
    /// A direction is not of unit length.
    #[error("point {point}: {field} must be of unit length within {tolerance}, but is {length} long", tolerance = UNIT_TOLERANCE)]
    NotUnit {
        /// The point.
        point: usize,
        /// Which vector of it.
        field: &'static str,
        /// Its length.
        length: f64,
    },
    /// The feed is so near to the tool axis that there is no direction normal to both.
    #[error(
        "point {point}: the feed is {angle_deg:.2} deg from the tool axis: at least {limit} deg are needed to tell a normal to both",
        limit = MIN_FEED_TO_AXIS_DEG
    )]
    FeedAlongAxis {
        /// The point.
        point: usize,
        /// Angle between feed and tool axis in degrees.
        angle_deg: f64,
    },
    /// Two points in a row of the same segment are at the same place: the second of the two.
    #[error("point {0} repeats the position of the point before it")]
    Repeated(usize),
    /// There are not as many surface normals as points.
    #[error("{normals} surface normals for {points} points")]
    Normals {
        /// Number of normals.
        normals: usize,
        /// Number of points.
        points: usize,
    },
    /// Segment numbers do not start at 1 or do not rise by one.
    #[error("point {point}: segment {found} after segment {before}")]
    SegmentOrder {
        /// The point.
        point: usize,
        /// The number of the segment before it, 0 at the start.
        before: u32,
        /// The number found.
        found: u32,
    },
    /// No point is scored.
    #[error("no point of the path is scored")]
    NothingScored,
    /// A feed is not above zero.
    #[error("point {point}: the feed must be above 0 and finite, but is {feed} m/s")]
    Feed {
        /// The point.
        point: usize,
        /// The feed. m/s
        feed: f64,
    },
    /// There are not as many feeds as points.
    #[error("{feeds} feeds for {points} points")]
    Feeds {
        /// Number of feeds.
        feeds: usize,
        /// Number of points.
        points: usize,
    },
    /// There are not as many compliances of the part as points.
    #[error("{matrices} compliances of the part for {points} points")]
    PartCompliances {
        /// Number of compliances.
        matrices: usize,
        /// Number of points.
        points: usize,
    },
    /// A compliance of the part that is none.
    #[error("point {point}: the compliance of the part: {error}")]
    PartCompliance {
        /// The point.
        point: usize,
        /// Why it is none.
        error: MatrixError,
    },
    /// Not as many wrenches as points.
    #[error("{wrenches} wrenches for {points} points")]
    Wrenches {
        /// Number of wrenches.
        wrenches: usize,
        /// Number of points.
        points: usize,
    },
}

/// How far the length of a given direction may be from one: three printed digits. It is made exact.
pub const UNIT_TOLERANCE: f64 = 2e-3;
/// The smallest angle between feed and tool axis. deg
pub const MIN_FEED_TO_AXIS_DEG: f64 = 5.0;
/// Two points nearer than this are the same place. m
const SAME_PLACE: f64 = 1e-9;

impl ToolPath {
    /// Checks points with their segment numbers (from 1, rising by one), and makes directions exactly unit.
    ///
    /// # Errors
    /// [`TaskError`] at the first point that breaks a rule.
    pub fn new(points: impl IntoIterator<Item = (u32, PathPoint)>) -> Result<Self, TaskError> {
        Self::partly_scored(points.into_iter().map(|(segment, point)| (segment, point, true)))
    }

    /// As [`ToolPath::new`], with whether each point is scored. One that is not must be reached, but has no part in the
    /// objective and no force, as in a plunge. Its `feed` only says from where beta counts, and it may be where the
    /// point before it is.
    ///
    /// # Errors
    /// [`TaskError`] at the first point that breaks a rule, or where no point is scored.
    pub fn partly_scored(points: impl IntoIterator<Item = (u32, PathPoint, bool)>) -> Result<Self, TaskError> {
        let mut path = Self {
            points: Vec::new(),
            segments: Vec::new(),
            surface_normals: None,
            feeds: None,
            scored: None,
            thinned: None,
            leaned: None,
        };
        let mut all_scored = Vec::new();
        for (index, (segment, point, is_scored)) in points.into_iter().enumerate() {
            let point = check_point(index, point)?;
            let before = path.segments.len() as u32;
            if segment == before + 1 {
                path.segments.push(index..index + 1);
            } else if segment == before && before > 0 {
                let way = path.points[index - 1].position - point.position;
                if way.norm() < SAME_PLACE && is_scored && all_scored[index - 1] {
                    return Err(TaskError::Repeated(index));
                }
                path.segments[segment as usize - 1].end = index + 1;
            } else {
                return Err(TaskError::SegmentOrder { point: index, before, found: segment });
            }
            path.points.push(point);
            all_scored.push(is_scored);
        }
        match all_scored.iter().filter(|is_scored| **is_scored).count() {
            _ if all_scored.is_empty() => return Err(TaskError::Empty),
            0 => return Err(TaskError::NothingScored),
            count => path.scored = (count < all_scored.len()).then_some(all_scored),
        }
        Ok(path)
    }

    /// States the normal of the surface to be cut at every point, in the workpiece frame, and makes it exactly unit.
    ///
    /// # Errors
    /// [`TaskError`] where their number is not that of the points, or at the first that is not a unit vector.
    pub fn with_surface_normals(mut self, mut normals: Vec<Vector3<f64>>) -> Result<Self, TaskError> {
        if normals.len() != self.points.len() {
            return Err(TaskError::Normals { normals: normals.len(), points: self.points.len() });
        }
        for (point, normal) in normals.iter_mut().enumerate() {
            *normal = unit(point, "normal", *normal)?;
        }
        self.surface_normals = Some(normals);
        Ok(self)
    }

    /// The normal of the surface at every point, in the workpiece frame, where the task states them.
    pub fn surface_normals(&self) -> Option<&[Vector3<f64>]> {
        self.surface_normals.as_deref()
    }

    /// All points, in the order of the cut.
    pub fn points(&self) -> &[PathPoint] {
        &self.points
    }

    /// The index ranges of the segments, in order; together they cover all points.
    pub fn segments(&self) -> &[Range<usize>] {
        &self.segments
    }

    /// The index of the segment (from 0) that a point belongs to.
    pub fn segment_of(&self, point: usize) -> usize {
        self.segments.partition_point(|range| range.end <= point)
    }

    /// Length of one segment along the straight lines between its points. m
    pub fn segment_length(&self, segment: usize) -> f64 {
        self.segments[segment].clone().skip(1).map(|point| self.step_length(point)).sum()
    }
}

/// A direction made exactly unit.
fn unit(point: usize, field: &'static str, vector: Vector3<f64>) -> Result<Vector3<f64>, TaskError> {
    if vector.iter().any(|v| !v.is_finite()) {
        return Err(TaskError::NotFinite { point, field });
    }
    let length = vector.norm();
    if (length - 1.0).abs() > UNIT_TOLERANCE {
        Err(TaskError::NotUnit { point, field, length })
    } else {
        Ok(vector / length)
    }
}

fn check_point(index: usize, mut point: PathPoint) -> Result<PathPoint, TaskError> {
    if point.position.iter().any(|v| !v.is_finite()) {
        return Err(TaskError::NotFinite { point: index, field: "position" });
    }
    (point.feed, point.axis) = (unit(index, "feed", point.feed)?, unit(index, "axis", point.axis)?);
    let angle_deg = 90.0 - point.feed_tilt().to_degrees().abs();
    if angle_deg < MIN_FEED_TO_AXIS_DEG {
        return Err(TaskError::FeedAlongAxis { point: index, angle_deg });
    }
    Ok(point)
}

impl Task {
    /// Puts a wrench to every point; none to a point that is not scored, whatever is given for it.
    ///
    /// # Errors
    /// [`TaskError::Wrenches`] when the numbers differ, [`TaskError::NotFinite`] for a wrench with NaN or infinity.
    pub fn new(path: ToolPath, wrenches: Vec<Wrench>) -> Result<Self, TaskError> {
        let loads = path.of_scored(wrenches)?.map(PointLoad::of).collect();
        Ok(Self { path: Arc::new(path), loads, lean_forces: None, upright: None })
    }

    /// The geometry.
    pub fn path(&self) -> &ToolPath {
        &self.path
    }

    /// All points, in the order of the cut.
    pub fn points(&self) -> &[PathPoint] {
        self.path.points()
    }

    /// The index ranges of the segments.
    pub fn segments(&self) -> &[Range<usize>] {
        self.path.segments()
    }

    /// What acts at every point.
    pub fn loads(&self) -> &[PointLoad] {
        &self.loads
    }

    /// The wrench at every point.
    pub fn wrenches(&self) -> impl ExactSizeIterator<Item = &Wrench> + Clone {
        self.loads.iter().map(|load| &load.wrench)
    }
}

#[cfg(any(test, feature = "testing"))]
pub mod testing {
    //! The shipped path for the tests of this crate and of those above.
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::lean::{ContactRule, CutterEnd, LeanForce, LeanRule};
    use super::*;

    /// A ball cutter of 12 mm that leans about its centre, forces staying in the directions of feed and wall.
    pub const BALL: LeanRule = LeanRule {
        end: CutterEnd { radius: 0.006, corner: 0.006 },
        contact: ContactRule::Centre,
        force: LeanForce::Feed,
    };

    /// The five segments of Caro 2013 with their forces, from `tasks/five-segments.csv`.
    pub fn five_segments() -> Task {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tasks/five-segments.csv");
        let text = std::fs::read_to_string(file).unwrap();
        let rows = text.lines().skip(1).map(|line| {
            let numbers: Vec<f64> = line.split(',').map(|v| v.parse().unwrap()).collect();
            let vector = |k: usize| Vector3::new(numbers[k], numbers[k + 1], numbers[k + 2]);
            let point = PathPoint { position: vector(1) * 1e-3, feed: vector(4), axis: vector(7) };
            ((numbers[0] as u32, point), Wrench { force: vector(10), moment: Vector3::zeros() })
        });
        let (points, wrenches): (Vec<_>, Vec<_>) = rows.unzip();
        let path = ToolPath::new(points).unwrap();
        Task::new(path, wrenches).unwrap()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::vector;

    fn point(x: f64) -> PathPoint {
        PathPoint { position: vector![x, 0.0, 0.0], feed: vector![1.0, 0.0, 0.0], axis: vector![0.0, 0.0, 1.0] }
    }

    #[test]
    fn segments_are_ranges_of_points() {
        let path = ToolPath::new([(1, point(0.0)), (1, point(0.1)), (2, point(0.1)), (2, point(0.3))]).unwrap();
        assert_eq!(path.segments(), [0..2, 2..4]);
        assert_eq!([0, 1, 2, 3].map(|i| path.segment_of(i)), [0, 0, 1, 1]);
        assert!((path.segment_length(1) - 0.2).abs() < 1e-15);
        assert!((point(0.0).normal() - vector![0.0, 1.0, 0.0]).norm() < 1e-15);
    }

    #[test]
    fn each_rule_is_checked() {
        assert_eq!(ToolPath::new([]), Err(TaskError::Empty));
        assert_eq!(ToolPath::new([(1, point(0.0)), (1, point(0.0))]), Err(TaskError::Repeated(1)));
        assert!(matches!(ToolPath::new([(2, point(0.0))]), Err(TaskError::SegmentOrder { before: 0, found: 2, .. })));
        let backwards = [(1, point(0.0)), (2, point(0.1)), (1, point(0.2))];
        assert!(matches!(ToolPath::new(backwards), Err(TaskError::SegmentOrder { point: 2, before: 2, found: 1 })));
        let long = PathPoint { feed: vector![1.1, 0.0, 0.0], ..point(0.0) };
        assert!(matches!(ToolPath::new([(1, long)]), Err(TaskError::NotUnit { field: "feed", .. })));
        let plunge = PathPoint { feed: vector![0.0, 0.0, -1.0], ..point(0.0) };
        assert!(matches!(ToolPath::new([(1, plunge)]), Err(TaskError::FeedAlongAxis { .. })));
        let nan = PathPoint { position: vector![f64::NAN, 0.0, 0.0], ..point(0.0) };
        assert!(matches!(ToolPath::new([(1, nan)]), Err(TaskError::NotFinite { field: "position", .. })));
        let path = ToolPath::new([(1, point(0.0))]).unwrap();
        assert!(matches!(Task::new(path, vec![]), Err(TaskError::Wrenches { .. })));
    }

    #[test]
    fn a_ramp_keeps_its_normal_and_states_its_angle() {
        let (s, c) = libm::sincos(0.3);
        let ramp = PathPoint { feed: vector![c, 0.0, -s], ..point(0.0) };
        assert!((ramp.feed_tilt() + 0.3).abs() < 1e-12);
        let frame = ramp.workpiece_from_point();
        assert!((frame * frame.transpose() - Matrix3::identity()).norm() < 1e-14);
        assert!((frame.column(0) - vector![1.0, 0.0, 0.0]).norm() < 1e-14);
    }
}
