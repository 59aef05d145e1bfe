//! Results of a compensation: corrected points with their remaining errors, or the points that cannot be corrected and
//! why.

use nalgebra::Vector3;
use serde::Serialize;
use std::fmt;
use stead_model::plausibility;
use stead_model::robot::{Pose, Unreachable};
use stead_model::stiffness::Displacement;
use stead_numerics::mean_max::MeanAndMax;
use stead_numerics::message::{Note, Warning};

/// Where the loaded tool rests, seen from the target.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Deflection {
    /// From the target to the tool centre point, in the base frame. m
    pub linear: Vector3<f64>,
    /// Rotation vector from the target to the tool, in the base frame. rad
    pub angular: Vector3<f64>,
    /// Part to the left of the feed, with its sign: what spoils the wall. m
    pub normal: f64,
}

/// One point of a path with its command.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CompensatedPoint {
    /// Number of its segment, from 1.
    pub segment: usize,
    /// Where the tool is to be: the tool frame in the base frame.
    pub target: Pose<f64>,
    /// What is to be commanded, likewise: the target itself, where that cannot be corrected.
    pub command: Pose<f64>,
    /// From the target to the command: translation, and rotation vector in the base frame. m, rad
    pub correction: Displacement<f64>,
    /// The joint angles of the command, in the posture and turns of the plan and within the limits. rad
    pub joints: [f64; 6],
    /// Deflection in reality with the target commanded; none where the arm of reality has no equilibrium under the
    /// load.
    pub before: Option<Deflection>,
    /// Deflection in reality with the command, likewise.
    pub after: Option<Deflection>,
    /// Iterations of eq. 27 that it took.
    pub iterations: usize,
    /// Whether it is corrected.
    pub status: Status,
}

/// Whether a point is corrected.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum Status {
    /// To the tolerance.
    Corrected,
    /// It cannot be, for this reason: the target is kept.
    Kept(PointError),
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Corrected => f.write_str("corrected"),
            Self::Kept(reason) => reason.fmt(f),
        }
    }
}

/// A path with its commands.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CompensatedPath {
    /// The points, in order; at least one.
    pub points: Vec<CompensatedPoint>,
    /// Why the path may not be what was wanted: `not-corrected` where points keep their target.
    pub warnings: Vec<Warning>,
    /// What looks like a wrong unit though it is possible, in sentences.
    pub notes: Vec<Note>,
}

impl CompensatedPath {
    pub(super) fn new(points: Vec<CompensatedPoint>) -> Self {
        let mut path = Self { points, warnings: Vec::new(), notes: Vec::new() };
        path.notes = plausibility::deflection(path.deflections()[0].max).map(Note::from).into_iter().collect();
        path.warnings =
            path.not_corrected().map(|not| Warning::new("not-corrected", not.summary())).into_iter().collect();
        path
    }

    /// The points that are not corrected, if there are some.
    pub fn not_corrected(&self) -> Option<NotCompensated> {
        let reason = |(index, point): (usize, &CompensatedPoint)| match point.status {
            Status::Corrected => None,
            Status::Kept(reason) => Some((index, reason)),
        };
        let failed: Vec<(usize, PointError)> = self.points.iter().enumerate().filter_map(reason).collect();
        (!failed.is_empty()).then_some(NotCompensated { failed, of: self.points.len() })
    }

    /// The path, if every point of it is corrected.
    ///
    /// # Errors
    /// [`NotCompensated`] with the points that are not, and the reason for each.
    pub fn complete(self) -> Result<Self, NotCompensated> {
        self.not_corrected().map_or(Ok(self), Err)
    }

    /// Figures of a magnitude over the points that have it.
    pub fn figures(&self, value: impl Fn(&CompensatedPoint) -> Option<f64>) -> MeanAndMax {
        MeanAndMax::of(self.points.iter().filter_map(value))
    }

    /// Magnitudes of a part of the deflection before and after.
    fn before_and_after(&self, part: impl Fn(&Deflection) -> f64) -> [MeanAndMax; 2] {
        [self.figures(|point| point.before.as_ref().map(&part)), self.figures(|point| point.after.as_ref().map(&part))]
    }

    /// Deflections before and after, those of points that are not corrected among them.
    pub fn deflections(&self) -> [MeanAndMax; 2] {
        self.before_and_after(|deflection| deflection.linear.norm())
    }

    /// Magnitudes of their parts normal to the feed, before and after.
    pub fn normal_parts(&self) -> [MeanAndMax; 2] {
        self.before_and_after(|deflection| deflection.normal.abs())
    }

    /// The most iterations that a point took.
    pub fn iterations(&self) -> usize {
        self.points.iter().map(|point| point.iterations).max().unwrap_or(0)
    }
}

/// The share by which the mean became smaller; none where there was nothing to reduce.
pub fn reduction(before_and_after: [MeanAndMax; 2]) -> Option<f64> {
    let [before, after] = before_and_after;
    (before.mean > 0.0).then(|| 1.0 - after.mean / before.mean)
}

/// Why a point cannot be corrected.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, thiserror::Error)]
pub enum PointError {
    /// The correction leads out of reach.
    #[error("the corrected pose is out of reach: {0}")]
    Reach(Unreachable),
    /// The corrected command is beyond a joint limit.
    #[error("corrected, joint {joint} would be {:.6} deg beyond its limit", by.to_degrees())]
    JointLimit {
        /// Number of the joint, from 1.
        joint: usize,
        /// By how much. rad
        by: f64,
    },
    /// The sum of joints 2 and 3 of the corrected command is beyond a limit.
    #[error("corrected, the sum of joints 2 and 3 would be {:.6} deg beyond its limit", by.to_degrees())]
    AxesSum {
        /// By how much. rad
        by: f64,
    },
    /// The arm of the model has no equilibrium under the load.
    #[error("the arm has no stable equilibrium beyond {share:.3} of the load")]
    Unstable {
        /// The share of the load up to which there is one.
        share: f64,
    },
    /// The arm that stands for reality has none.
    #[error("the arm of reality has no stable equilibrium beyond {share:.3} of the load")]
    RealityUnstable {
        /// The share of the load up to which there is one.
        share: f64,
    },
    /// An iteration increased the error.
    #[error(
        "iteration {iterations} diverges: the error goes from {:.3e} to {:.3e} mm; a smaller alpha may help",
        from * 1e3,
        to * 1e3
    )]
    Diverged {
        /// Which iteration, from 1.
        iterations: usize,
        /// The error before it. m
        from: f64,
        /// The error after it. m
        to: f64,
    },
    /// The iteration limit was reached.
    #[error("after {iterations} iterations the error is still {:.3e} mm; more iterations, or an alpha nearer to 1, may help", error * 1e3)]
    NotConverged {
        /// How many.
        iterations: usize,
        /// The error left. m
        error: f64,
    },
}

impl PointError {
    /// Whether two errors differ in their numbers only.
    fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::JointLimit { joint: a, .. }, Self::JointLimit { joint: b, .. }) => a == b,
            _ => std::mem::discriminant(self) == std::mem::discriminant(other),
        }
    }
}

/// A path that cannot be corrected all along.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NotCompensated {
    /// The points that cannot, from 0 and ascending, each with the reason; at least one.
    pub failed: Vec<(usize, PointError)>,
    /// Number of all points.
    pub of: usize,
}

impl NotCompensated {
    /// Whether not one point can be compensated.
    pub fn is_all(&self) -> bool {
        self.failed.len() == self.of
    }

    /// How many, and the first reason, in a sentence.
    fn summary(&self) -> String {
        let first = self
            .failed
            .first()
            .map_or_else(String::new, |(point, reason)| format!(", the first point {point}: {reason}"));
        format!("{} of {} points are not corrected and keep their target{first}", self.failed.len(), self.of)
    }
}

impl fmt::Display for NotCompensated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {} points cannot be compensated:", self.failed.len(), self.of)?;
        let runs = self.failed.chunk_by(|(a, left), (b, right)| a + 1 == *b && left.is_like(right));
        for run in runs {
            let [(first, reason), .., (last, _)] = run else {
                run.iter().try_for_each(|(point, reason)| write!(f, "\n  point {point}: {reason}"))?;
                continue;
            };
            write!(f, "\n  points {first} to {last}: at point {first}, {reason}")?;
        }
        Ok(())
    }
}

impl std::error::Error for NotCompensated {}
