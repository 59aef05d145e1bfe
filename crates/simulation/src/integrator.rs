//! Newmark's method for a mechanical system: implicit, with a constant matrix factored once and reused.
//!
//! With beta = 1/4 and gamma = 1/2 (mean acceleration) it is of second order and, for a linear system, keeps the energy
//! (Newmark 1959; Géradin and Cardona 2001). The equations at the end of a step are solved by Newton's method for the
//! accelerations, with `M + gamma h C + beta h^2 K` of some earlier step: how fast that contracts is measured, and when
//! it becomes slow the matrix is made anew. A step that does not converge is halved, up to [`Settings::max_halvings`]
//! times, and then reported.

use nalgebra::{SMatrix, SVector};
use serde::Serialize;

/// Angles, speeds and accelerations of a system. rad, rad/s, rad/s^2
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionState<const N: usize> {
    /// Angles. rad
    pub q: SVector<f64, N>,
    /// Speeds. rad/s
    pub speed: SVector<f64, N>,
    /// Accelerations. rad/s^2
    pub acceleration: SVector<f64, N>,
}

/// How unbalanced forces change with accelerations, speeds and angles; symmetric and positive definite together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tangent<const N: usize> {
    /// With accelerations. kg m^2
    pub mass: SMatrix<f64, N, N>,
    /// With speeds. N m s/rad
    pub damping: SMatrix<f64, N, N>,
    /// With angles. N m/rad
    pub stiffness: SMatrix<f64, N, N>,
}

/// A mechanical system to integrate.
pub trait System<const N: usize> {
    /// Forces that are out of balance at a time (s) in a state: zero on a solution. N m
    fn unbalanced(&mut self, time: f64, state: &MotionState<N>) -> SVector<f64, N>;

    /// An approximation of how they change, at least as to inertia.
    fn tangent(&mut self, time: f64, state: &MotionState<N>) -> Tangent<N>;

    /// Called with each state that is kept, at the end of each step or part of one.
    fn accept(&mut self, _time: f64, _state: &MotionState<N>) {}
}

/// Settings of the integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Newmark's beta.
    pub beta: f64,
    /// Newmark's gamma.
    pub gamma: f64,
    /// A step is solved when its angles will not change by more than this any more. rad
    pub tolerance: f64,
    /// Corrections before a step counts as not converging.
    pub max_corrections: usize,
    /// How often a step may be halved.
    pub max_halvings: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self { beta: 0.25, gamma: 0.5, tolerance: 1e-10, max_corrections: 8, max_halvings: 6 }
    }
}

/// Why a step could not be made.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error, Serialize)]
pub enum StepError {
    /// Corrections do not become small, however short the step.
    #[error("at {time} s the motion does not converge, not even in steps of {step} s")]
    NotConverged {
        /// Start of the step. s
        time: f64,
        /// The shortest step tried. s
        step: f64,
    },
    /// The mass matrix with damping and stiffness is not positive definite: the start of the step. s
    #[error("at {0} s the matrix of the step is not positive definite")]
    Singular(f64),
}

/// The method with its matrix.
#[derive(Debug, Clone)]
pub struct Newmark<const N: usize> {
    settings: Settings,
    inverse: Option<(f64, SMatrix<f64, N, N>)>,
    contraction: f64,
}

/// Corrections are taken to contract no faster than this, since what pushes may change from step to step.
const MIN_CONTRACTION: f64 = 0.01;
/// A matrix with which corrections contract more slowly than this is made anew.
const SLOW: f64 = 0.1;
/// Angles that differ by less than this relative amount are the same but for rounding.
const ROUNDING: f64 = 1e-15;

impl<const N: usize> Newmark<N> {
    /// The method, without a matrix yet.
    pub fn new(settings: Settings) -> Self {
        Self { settings, inverse: None, contraction: MIN_CONTRACTION }
    }

    /// Accelerations that bring a system at given angles and speeds into balance: the start of an integration.
    ///
    /// # Errors
    /// [`StepError`] when the mass matrix is not positive definite, or the accelerations do not converge.
    pub fn started<S: System<N>>(
        system: &mut S,
        time: f64,
        state: &MotionState<N>,
    ) -> Result<MotionState<N>, StepError> {
        let mut state = *state;
        let mass = system.tangent(time, &state).mass.cholesky().ok_or(StepError::Singular(time))?;
        for _ in 0..20 {
            let change = mass.solve(&system.unbalanced(time, &state));
            state.acceleration -= change;
            if change.amax() <= 1e-9 * (1e-3 + state.acceleration.amax()) {
                return Ok(state);
            }
        }
        Err(StepError::NotConverged { time, step: 0.0 })
    }

    /// Moves a state on by a step (s) from `time` (s).
    ///
    /// # Errors
    /// [`StepError`] when the step cannot be made; the state is then the last one that was kept.
    pub fn step<S: System<N>>(
        &mut self,
        system: &mut S,
        time: f64,
        step: f64,
        state: &mut MotionState<N>,
    ) -> Result<(), StepError> {
        let parts = 1_u64 << self.settings.max_halvings;
        let (mut done, mut width) = (0, parts);
        while done < parts {
            let from = time + step * (done as f64 / parts as f64);
            let length = step * (width as f64 / parts as f64);
            match self.part(system, from, length, state) {
                Ok(next) => {
                    *state = next;
                    done += width;
                    system.accept(time + step * (done as f64 / parts as f64), state);
                    if width < parts && done % (2 * width) == 0 {
                        width *= 2;
                    }
                }
                Err(error) if width == 1 => return Err(error),
                Err(_) => width /= 2,
            }
        }
        Ok(())
    }

    /// One part of a step, with the matrix there is, or with a new one if that is too slow.
    fn part<S: System<N>>(
        &mut self,
        system: &mut S,
        time: f64,
        step: f64,
        state: &MotionState<N>,
    ) -> Result<MotionState<N>, StepError> {
        if self.inverse.as_ref().is_some_and(|(made_for, _)| *made_for == step)
            && let Some(next) = self.solved(system, time, step, state)
            && self.contraction <= SLOW
        {
            return Ok(next);
        }
        self.factor(system, time, step, state)?;
        self.solved(system, time, step, state).ok_or(StepError::NotConverged { time, step })
    }

    fn factor<S: System<N>>(
        &mut self,
        system: &mut S,
        time: f64,
        step: f64,
        state: &MotionState<N>,
    ) -> Result<(), StepError> {
        let Tangent { mass, damping, stiffness } = system.tangent(time, state);
        let Settings { beta, gamma, .. } = self.settings;
        let matrix = mass + damping * (gamma * step) + stiffness * (beta * step * step);
        let factor = matrix.cholesky().ok_or(StepError::Singular(time))?;
        self.inverse = Some((step, factor.inverse()));
        self.contraction = MIN_CONTRACTION;
        Ok(())
    }

    /// Newton's method from the accelerations at the start of the step; none if it does not converge.
    fn solved<S: System<N>>(
        &mut self,
        system: &mut S,
        time: f64,
        step: f64,
        state: &MotionState<N>,
    ) -> Option<MotionState<N>> {
        let Settings { beta, gamma, tolerance, max_corrections, .. } = self.settings;
        let (_, inverse) = self.inverse.as_ref()?;
        let mut next = MotionState {
            q: state.q + state.speed * step + state.acceleration * (0.5 * step * step),
            speed: state.speed + state.acceleration * step,
            acceleration: state.acceleration,
        };
        let mut before = f64::INFINITY;
        for _ in 0..max_corrections {
            let change = inverse * system.unbalanced(time + step, &next);
            next.acceleration -= change;
            next.speed -= change * (gamma * step);
            next.q -= change * (beta * step * step);
            let size = change.amax() * beta * step * step;
            if !size.is_finite() {
                return None;
            }
            let rounding = ROUNDING * (1.0 + next.q.amax());
            if before.is_finite() && before > rounding {
                self.contraction = (size / before).max(MIN_CONTRACTION);
                if self.contraction >= 1.0 && size > rounding {
                    return None;
                }
            }
            let contraction = self.contraction.min(0.5);
            if size * contraction / (1.0 - contraction) <= tolerance || size <= rounding {
                return Some(next);
            }
            before = size;
        }
        None
    }
}

#[cfg(test)]
mod tests;
