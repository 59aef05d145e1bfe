//! The arm with its elastic turns, finite as they are: where it comes to rest under a load, and how that changes with
//! the compliances.
//!
//! Behind the drive's turn of a joint come the elastic turns about z, x and y of the frame of its row, in this order
//! and all at the bearing; or the one about z alone. Each is proportional to the torque of the load about its own axis
//! as it lies under the load. Turns of the springs about the axes alone are those of the joints, for which
//! [`equilibrium_with`] has the equilibrium; for all springs it is sought by iterating `q = C tau(q)`, which converges
//! by a factor of about deflection over arm length a step.

use super::springs::{AXES, bearings, spring};
use nalgebra::{DMatrix, SMatrix, SVector, Vector3};
use stead_model::robot::{About, Frames, Pose, Robot, Spring};
use stead_model::stiffness::equilibrium::{Load, NoEquilibrium, equilibrium_with};
use stead_numerics::rotation::rotation_from_vector;

/// The lines about which the springs of an arm turn its flange, in one configuration; springs in the order of
/// [`super::springs`], everything in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic<const N: usize> {
    /// Direction of each line, and a point of it. m
    lines: [(Vector3<f64>, Vector3<f64>); N],
    /// On an arm with a linkage, by how much joint 3 turns back where the spring of joint 2 turns about its line.
    held: Option<f64>,
    /// The flange.
    pub base_from_flange: Pose<f64>,
}

impl<const N: usize> Elastic<N> {
    /// Without a load, at joint angles in rad.
    pub fn unloaded(robot: &Robot, theta: &[f64; 6]) -> Self {
        let (frames, bearings) = (Frames::new(robot, theta), bearings(robot));
        let line = |column: usize| match spring(column) {
            Spring { joint, about: About::Z } => (frames.axes[joint], frames.origins[joint]),
            Spring { joint, about } => {
                let place = frames.origins[joint] + frames.axes[joint] * bearings[joint];
                (frames.rotations[joint].column(usize::from(about == About::Y)).into_owned(), place)
            }
        };
        Self { lines: std::array::from_fn(line), held: frames.held(), base_from_flange: frames.base_from_flange }
    }

    /// With the springs turned so far (rad) behind the drives at joint angles in rad.
    fn turned(robot: &Robot, theta: &[f64; 6], turns: &SVector<f64, N>) -> Self {
        let bearings = bearings(robot);
        let held = robot.has_linkage().then_some(robot.geometry().fold);
        let turns = lines_by_springs(held) * turns;
        let mut lines = [(Vector3::zeros(), Vector3::zeros()); N];
        let mut pose = robot.cell_from_base();
        let along = |pose: &Pose<f64>, shift: f64| pose.translation + pose.rotation.column(2) * shift;
        let (order, steps) = (chain_order::<N>(), N / AXES);
        for joint in 0..6 {
            pose = pose.then(&robot.rows()[joint]);
            pose.translation = along(&pose, bearings[joint]);
            for (step, column) in order[steps * joint..steps * (joint + 1)].iter().enumerate() {
                let axis = [2, 0, 1][step];
                lines[*column] = (pose.rotation.column(axis).into_owned(), pose.translation);
                let drive = if step == 0 { theta[joint] } else { 0.0 };
                pose.rotation *= rotation_from_vector(&Vector3::ith(axis, drive + turns[*column]));
            }
            pose.translation = along(&pose, -bearings[joint]);
        }
        Self { lines, held, base_from_flange: pose }
    }

    /// The velocities of a turn about the line of a spring alone.
    fn line(&self, column: usize, point: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let (axis, place) = &self.lines[column];
        (axis.cross(&(point - place)), *axis)
    }

    /// Linear and angular velocity of a point of the flange (m, base frame) per unit speed of a spring.
    pub fn twist(&self, column: usize, point: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let (velocity, axis) = self.line(column, point);
        let Some(held) = self.held.filter(|_| column == SECOND) else { return (velocity, axis) };
        let (back, around) = self.line(THIRD, point);
        (velocity - back * held, axis - around * held)
    }

    /// The torque of a force (N) and a moment (N m) at a place (m, base frame) about a spring. N m
    pub fn torque(&self, column: usize, place: &Vector3<f64>, force: &Vector3<f64>, moment: &Vector3<f64>) -> f64 {
        let (velocity, axis) = self.twist(column, place);
        velocity.dot(force) + axis.dot(moment)
    }

    /// Velocity (m/s) and angular velocity (rad/s) of the flange at a point (m, base frame), in rows, per unit speed of
    /// the springs.
    pub fn jacobian(&self, point: &Vector3<f64>) -> SMatrix<f64, 6, N> {
        let mut jacobian = SMatrix::<f64, 6, N>::zeros();
        for column in 0..N {
            let (linear, angular) = self.twist(column, point);
            jacobian.fixed_view_mut::<3, 1>(0, column).copy_from(&linear);
            jacobian.fixed_view_mut::<3, 1>(3, column).copy_from(&angular);
        }
        jacobian
    }

    /// The derivative of the torques by the turns of the springs, row by row:
    /// [`stead_model::stiffness::loaded::load_hessian`] with a line for each spring. N m/rad
    fn load_hessian(&self, place: &Vector3<f64>, force: &Vector3<f64>, moment: &Vector3<f64>) -> SMatrix<f64, N, N> {
        let mut hessian = SMatrix::zeros();
        let order = chain_order::<N>();
        for (rank, j) in order.iter().enumerate() {
            let velocity = self.line(*j, place).0;
            for i in &order[..=rank] {
                let of_force = self.lines[*i].0.cross(&velocity).dot(force);
                hessian[(*i, *j)] = of_force;
                hessian[(*j, *i)] = of_force;
                if i != j {
                    hessian[(*j, *i)] += self.lines[*i].0.cross(&self.lines[*j].0).dot(moment);
                }
            }
        }
        if self.held.is_none() {
            return hessian;
        }
        let lines: SMatrix<f64, N, N> = lines_by_springs(self.held);
        lines.transpose() * hessian * lines
    }
}

/// The columns of joints 2 and 3 about their axes.
const SECOND: usize = 1;
const THIRD: usize = 2;

/// Turns about the lines per turn of the springs: the identity, but on an arm with a linkage.
fn lines_by_springs<const N: usize>(held: Option<f64>) -> SMatrix<f64, N, N> {
    let mut lines = SMatrix::identity();
    if let Some(held) = held {
        lines[(THIRD, SECOND)] = -held;
    }
    lines
}

/// The columns as their turns follow each other from the base on.
fn chain_order<const N: usize>() -> [usize; N] {
    let steps = N / AXES;
    std::array::from_fn(|rank| match (rank / steps, rank % steps) {
        (joint, 0) => joint,
        (joint, normal) => AXES + 2 * joint + normal - 1,
    })
}

/// An arm at rest under a load.
#[derive(Debug, Clone)]
pub struct Rest<const N: usize> {
    /// As it lies there.
    pub arm: Elastic<N>,
    /// Derivatives of the turns of the springs, in rows, by the compliances. N m
    pub turns: SMatrix<f64, N, N>,
}

/// Steps of the iteration, which settles in some six where the arm holds its load.
const STEPS: usize = 60;
/// A step that turns no spring by more is the last. rad
const LAST_STEP: f64 = 1e-15;

impl<const N: usize> Rest<N> {
    /// With these compliances (rad/(N m)) behind joint angles in rad.
    ///
    /// # Errors
    /// [`NoEquilibrium`] where the arm gives way under the load.
    pub fn new(
        robot: &Robot,
        compliances: &SVector<f64, N>,
        theta: &[f64; 6],
        load: &Load,
    ) -> Result<Self, NoEquilibrium> {
        let arm = if N == AXES {
            let about_axes = std::array::from_fn(|joint| compliances[joint]);
            Elastic::unloaded(robot, &equilibrium_with(robot, &about_axes, theta, load)?)
        } else {
            settled(robot, compliances, theta, load)?
        };
        let place = arm.base_from_flange.point(&load.point);
        let torques = SVector::from_fn(|column, _| arm.torque(column, &place, &load.force, &load.moment));
        let hessian = arm.load_hessian(&place, &load.force, &load.moment);
        let tangent = SMatrix::<f64, N, N>::identity() - SMatrix::<f64, N, N>::from_diagonal(compliances) * hessian;
        let turns = solved(&tangent, &SMatrix::from_diagonal(&torques)).ok_or(NoEquilibrium { share: 1.0 })?;
        Ok(Self { arm, turns })
    }
}

/// The arm with all springs at rest, by iteration.
fn settled<const N: usize>(
    robot: &Robot,
    compliances: &SVector<f64, N>,
    theta: &[f64; 6],
    load: &Load,
) -> Result<Elastic<N>, NoEquilibrium> {
    let mut turns = SVector::<f64, N>::zeros();
    for _ in 0..STEPS {
        let arm = Elastic::turned(robot, theta, &turns);
        let place = arm.base_from_flange.point(&load.point);
        let next = SVector::<f64, N>::from_fn(|column, _| {
            compliances[column] * arm.torque(column, &place, &load.force, &load.moment)
        });
        let step = (next - turns).amax();
        turns = next;
        if step <= LAST_STEP {
            return Ok(Elastic::turned(robot, theta, &turns));
        }
        if !step.is_finite() {
            break;
        }
    }
    Err(NoEquilibrium { share: 0.0 })
}

/// The solution of linear equations with several right-hand sides; nothing for a singular matrix.
fn solved<const N: usize>(matrix: &SMatrix<f64, N, N>, right: &SMatrix<f64, N, N>) -> Option<SMatrix<f64, N, N>> {
    let [matrix, right] = [matrix, right].map(|matrix| DMatrix::from_column_slice(N, N, matrix.as_slice()));
    let solved = matrix.lu().solve(&right)?;
    Some(SMatrix::from_column_slice(solved.as_slice()))
}
