//! The whole chain, integrated by Newmark's method.

use super::{End, Job, JobError, Process, Run};
use crate::arm::{Arm, Compensation};
use crate::integrator::{MotionState, Newmark, Settings, System, Tangent};
use crate::milling::Force;
use nalgebra::SVector;
use stead_numerics::monitor::Monitor;

/// The arm under the forces of milling.
struct Coupled<'a, const N: usize> {
    arm: &'a Arm<N>,
    process: Process<'a>,
    compensation: Compensation<N>,
    /// Of the last evaluation: place and velocity of the tool centre, and the force on it.
    last: ([f64; 2], [f64; 2], Force),
}

impl<const N: usize> System<N> for Coupled<'_, N> {
    fn unbalanced(&mut self, time: f64, state: &MotionState<N>) -> SVector<f64, N> {
        let (angles, speeds) = self.process.motion.motors(time);
        let posed = self.arm.chain.at(&state.q);
        let place = self.process.plane.place(&posed.tip());
        let jacobian = posed.tip_jacobian();
        let velocity = self.process.plane.part(&(jacobian * state.speed));
        let force = self.process.force(time, place);
        self.last = (place, velocity, force);
        let reference = [&Arm::<N>::spread(&angles), &Arm::<N>::spread(&speeds)];
        let motion = [&state.q, &state.speed, &state.acceleration];
        self.arm.unbalanced(&posed, motion, reference, &mut self.compensation)
            - jacobian.tr_mul(&self.process.plane.force(force.on_tool))
    }

    fn tangent(&mut self, time: f64, state: &MotionState<N>) -> Tangent<N> {
        let posed = self.arm.chain.at(&state.q);
        let reference = Arm::<N>::spread(&self.process.motion.motors(time).0);
        let springs = self.arm.drive.stiffness_at(&state.q, &reference);
        Tangent {
            mass: posed.mass_matrix(&self.arm.chain),
            damping: nalgebra::SMatrix::from_diagonal(&self.arm.drive.damping),
            stiffness: nalgebra::SMatrix::from_diagonal(&springs),
        }
    }
}

/// Simulates a pass.
///
/// # Errors
/// [`JobError`] before the first step, or when `monitor` asked to stop.
pub fn run<const N: usize>(job: &Job<'_>, arm: &Arm<N>, monitor: &Monitor) -> Result<Run, JobError> {
    let process = Process::new(job)?;
    let (steps, step) = (process.steps(), process.step);
    let (angles, speeds) = process.motion.motors(0.0);
    let mut state = MotionState {
        q: arm.at_rest(&Arm::<N>::spread(&angles)),
        speed: Arm::<N>::spread(&speeds),
        acceleration: SVector::zeros(),
    };
    let compensation = Compensation::about(arm, &state.q);
    let mut system = Coupled { arm, process, compensation, last: ([0.0; 2], [0.0; 2], Force::default()) };
    state = Newmark::started(&mut system, 0.0, &state)?;
    let mut newmark = Newmark::new(Settings::default());
    let (place, velocity, force) = system.last;
    let mut end = system.process.keep(place, velocity, force).map_or_else(End::Limit, |()| End::Complete);
    for index in 0..steps {
        if end != End::Complete {
            break;
        }
        system.process.watched(monitor)?;
        if let Err(error) = newmark.step(&mut system, index as f64 * step, step, &mut state) {
            end = End::Step(error);
            break;
        }
        let (place, velocity, force) = system.last;
        end = system.process.keep(place, velocity, force).map_or_else(End::Limit, |()| End::Complete);
    }
    Ok(system.process.ended(end))
}
