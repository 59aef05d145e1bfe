//! A lookup table of the scores of upright tools: candidates are scored by interpolating it, at a tenth of the cost of
//! planning them; only survivors are planned exactly.
//!
//! With the tool axis along axis 1 ([`stead_problem::symmetry`]), a state depends on four things alone: the tool
//! centre point's radius r and height z in the root frame, the heading of the spindle against the point's azimuth, and
//! the posture class. The compliance there is sampled once per robot and spindle, by the reference geometry (`sample`,
//! over the grid of `shape`). A placement is scored point by point (`polar`, `interpolate`), and the best plan through
//! the scores found by the planner's rules without joint steps and turns (`objective`); the search descends on that.
//! With n the wall normal, f the force and t the moment about the tool centre point, all as (radial, tangential, up),
//! the in-plane compliance of joints 2 to 6 [[m + d1, d2], [d2, m - d1]], and g their compliance between n and t:
//!
//! ```text
//! n . K^-1 w = m n.f + d1 (n_r f_r - n_t f_t) + d2 (n_r f_t + n_t f_r)  joints 2 to 6 in the plane
//!            + f_z (c_rz n_r + c_tz n_t)                                and out of it
//!            + sum over i = r, t and j = r, t, z of g_ij n_i t_j        under the moment
//!            + r k_1 n_t (r f_t + t_z)                                  joint 1, of compliance k_1: not in the table
//!            + what base and part do                                    neither is in the table
//! ```
//!
//! Springs normal to the axes turn with the arm, and mount and tip with the spindle: they are in the same fields.
//!
//! Force and moment enter point by point, so that they may differ at every point at no cost.
//!
//! [`LookupTable::accuracy`] measures the error of the interpolation.

mod accuracy;
mod collision_free;
mod interpolate;
mod objective;
mod polar;
mod sample;

pub use accuracy::Accuracy;
pub use objective::{CollisionEffort, Workspace};
pub use stead_problem::table_shape::{MAX_BYTES, Parts, Shape, TableAxis};

use nalgebra::{Matrix3, Matrix6};
use polar::WorkpiecePoint;
use std::f64::consts::PI;
use std::sync::Arc;
use stead_model::robot::Pose;
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::{BetaChange, Planner, StateSet, saved_changes};
use stead_problem::constraints::{ConstraintKind, relaxed};
use stead_problem::problem::{Problem, Redundancy};
use stead_problem::symmetry::{Unsupported, Upright};

/// The compliance of an arm with an upright tool, and the room left to its limits, everywhere in a cell.
#[derive(Debug, Clone)]
pub struct LookupTable<'a> {
    problem: &'a Problem,
    shape: Shape,
    /// Rows over the heading: height, radius, posture class, field.
    data: Vec<f32>,
    /// Whether a row (height, radius, posture class) has an allowed state.
    alive: Vec<bool>,
    points: Vec<WorkpiecePoint>,
    root_from_base: Matrix3<f64>,
    /// +1 where a growing beta turns the spindle counter-clockwise about axis 1.
    rotation_sign: f64,
    /// Compliance of joint 1. rad/(N m)
    first_compliance: f64,
    /// How what carries the robot yields, where it does: pose of the frame of the matrix in the root frame.
    base: Option<(Pose<f64>, Matrix6<f64>)>,
    /// So many points are near enough to each other for one of them to be looked at for collisions first.
    pub(crate) stride: usize,
}

/// Points as near as this to each other along the path mostly hit together. m
const SAME_STRETCH: f64 = 0.1;

/// How many points of the path [`SAME_STRETCH`] has in the mean.
fn stride(problem: &Problem) -> usize {
    let task = &problem.task;
    let lengths = task.segments().iter().flat_map(|span| task.points()[span.clone()].windows(2));
    let (length, steps) = lengths
        .fold((0.0, 0), |(length, steps), pair| (length + (pair[1].position - pair[0].position).norm(), steps + 1));
    if length > 0.0 { ((SAME_STRETCH * f64::from(steps) / length) as usize).max(1) } else { 1 }
}

/// A grid of beta, with the changes of beta allowed between neighbouring points.
#[derive(Debug, Clone)]
pub struct BetaGrid {
    /// Number of grid values.
    pub(crate) count: usize,
    /// For each path point the allowed changes of the beta number from the one before.
    pub(crate) changes: Vec<BetaChange>,
    /// States in which spindle or holder hit part or fixture, where they were looked at ahead of all plans.
    pub(crate) tool_hits: Option<Arc<StateSet>>,
    /// Its step. rad
    step: f64,
}

impl BetaGrid {
    /// The grid and the steps of a planner.
    pub fn of(planner: &Planner<'_>) -> Self {
        Self::with(planner.problem(), *planner.grid(), planner.tool_hits())
    }

    /// A grid of `count` values over a full turn, with the changes of beta that are allowed on it.
    pub fn new(problem: &Problem, count: usize) -> Self {
        let grid = Redundancy { beta_count: count, ..problem.redundancy };
        Self::with(problem, grid, StateSet::of_tool(problem, &grid).map(Arc::new))
    }

    fn with(problem: &Problem, grid: Redundancy, tool_hits: Option<Arc<StateSet>>) -> Self {
        Self { count: grid.beta_count, changes: saved_changes(problem, &grid), tool_hits, step: grid.beta_step() }
    }

    /// Grid value of beta, as [`Redundancy::beta`]. rad
    pub(crate) fn beta(&self, number: usize) -> f64 {
        -PI + self.step * number as f64
    }
}

impl<'a> LookupTable<'a> {
    /// Samples the table of a problem.
    ///
    /// # Errors
    /// [`Unsupported`], with the reason.
    pub fn new(problem: &'a Problem) -> Result<Self, Unsupported> {
        Self::monitored(problem, &Monitor::silent())
    }

    /// As [`LookupTable::new`], until the caller asks to stop.
    ///
    /// # Errors
    /// [`Unsupported`], with the reason, one of which is [`Unsupported::Interrupted`].
    pub fn monitored(problem: &'a Problem, monitor: &Monitor) -> Result<Self, Unsupported> {
        let shape = Shape::of(problem)?;
        let rotation_sign = Upright::of(problem)?.rotation_sign;
        let (data, alive) = sample::sample(problem, &shape, rotation_sign, monitor).ok_or(Unsupported::Interrupted)?;
        // Exactly upright, so that a level path is level to the last bit.
        let r = problem.robot.geometry().base_from_root.transpose();
        let root_from_base = Matrix3::new(r.m11, r.m12, 0.0, r.m21, r.m22, 0.0, 0.0, 0.0, r.m33.signum());
        Ok(Self {
            problem,
            shape,
            data,
            alive,
            points: polar::points(problem),
            root_from_base,
            rotation_sign,
            first_compliance: problem.robot.compliances_at(&[0.0; 6])[0],
            base: problem.robot.yielding_base().map(|(frame, matrix)| {
                let root = Pose {
                    rotation: root_from_base * frame.rotation,
                    translation: root_from_base * (frame.translation - problem.robot.geometry().root_in_base),
                };
                (root, *matrix)
            }),
            stride: stride(problem),
        })
    }

    /// What is sampled where.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The constraints that an objective by the table leaves out: only the planner evaluates them.
    pub fn relaxed(&self) -> Vec<ConstraintKind> {
        use ConstraintKind::{
            AxesSum, BaseDistance, BetaRate, CellPosition, CellYaw, Conditioning, JointLimit, MaxDeflection, Posture,
            Reach, SpindleTurn,
        };
        let mut evaluated = vec![Reach, AxesSum, BaseDistance, Conditioning, BetaRate, SpindleTurn, Posture];
        evaluated.extend([MaxDeflection, CellPosition, CellYaw]);
        evaluated.extend((1..=6).map(JointLimit));
        relaxed(self.problem, &evaluated)
    }

    /// The problem it is for.
    pub fn problem(&self) -> &'a Problem {
        self.problem
    }
}

#[cfg(test)]
mod tests;
