//! Another model of a pass, which the whole chain is held against: mass matrix and Jacobian frozen along the pass, each
//! step condensed to the two unknowns of the tip.
//!
//! With `u` the angles by which springs have yielded, the arm obeys `M u'' + D u' + K(u) = r(t) + J^T F`, where r is
//! what gravity and the commanded motion ask for. Intervals of a few millimetres have M, the slope of gravity and J;
//! between two, M is that of the middle and J is interpolated. A step of Newmark's method is then linear but for the
//! force, and the tip moves as `u_tip = free + G F(u_tip)` with a matrix G of two rows (and three columns: the force
//! along the tool axis moves the tip in the plane of the cut as well), so that the force alone is iterated on, and an
//! arm of eighteen joints costs little more than one of six.
//!
//! With backlash springs act or not. For every set of springs that act the step is linear as well; its matrices are
//! made when it first occurs, and a step is repeated until the springs that it assumes to act are those that do.

use super::super::{CutPlane, End, Job, JobError, Process, Run};
use crate::arm::Arm;
use crate::integrator::StepError;
use crate::milling::Force;
use crate::motion::Motion;
use nalgebra::{Matrix2x3, SMatrix, SVector, Vector2, Vector3};
use stead_numerics::monitor::Monitor;

/// Longest interval. m
const SPACING: f64 = 5e-3;
/// What the commanded motion asks for is known at times at most so far apart. s
const TICK: f64 = 4e-3;
/// The force of milling is found again while it moves the tip by what changes it by more than this part of itself.
const FORCE_TOLERANCE: f64 = 1e-4;
/// Or by more than this. N
const MIN_FORCE: f64 = 1e-3;
/// Evaluations of the force in a step, at most.
const MAX_EVALUATIONS: usize = 30;
/// Sets of acting springs tried in a step, at most.
const MAX_SETS: usize = 12;

/// The tip at a place of the pass: how it moves with the joints, and where it is beyond that.
#[derive(Clone)]
struct Tip<const N: usize> {
    /// Along feed and normal. m/rad
    jacobian: SMatrix<f64, 2, N>,
    /// Along the tool axis. m/rad
    axial: SMatrix<f64, 1, N>,
    /// Tip less nominal place less the Jacobian times what the springs have yielded at rest. m
    offset: Vector2<f64>,
}

/// The arm between two places of the pass.
struct Interval<const N: usize> {
    mass: SMatrix<f64, N, N>,
    /// Slope of gravity as far as springs feel it; none where they feel nothing.
    gravity: Option<SMatrix<f64, N, N>>,
    /// Along feed, normal and tool axis. m/rad
    jacobian: SMatrix<f64, 3, N>,
    /// Matrices of a step, by the springs that act.
    factors: Vec<(u32, Factor<N>)>,
}

/// Matrices of a step for one set of acting springs.
struct Factor<const N: usize> {
    /// (M + h/2 D + h^2/4 K)^-1
    inverse: SMatrix<f64, N, N>,
    /// That times J^T: accelerations of a force at the tip.
    response: SMatrix<f64, N, 3>,
    /// h^2/4 J times that: motion of the tip in the plane.
    tip: Matrix2x3<f64>,
}

/// Everything that is made before the first step.
struct Frozen<'a, const N: usize> {
    arm: &'a Arm<N>,
    step: f64,
    spacing: f64,
    tips: Vec<Tip<N>>,
    intervals: Vec<Interval<N>>,
    tick: f64,
    /// r at every tick. N m
    requested: Vec<SVector<f64, N>>,
    /// Numbers of the joints with backlash.
    loose: Vec<usize>,
}

impl<'a, const N: usize> Frozen<'a, N> {
    fn new(arm: &'a Arm<N>, motion: &Motion, plane: &CutPlane, step: f64, steps: usize) -> Self {
        let count = (motion.length / SPACING).ceil().max(1.0) as usize;
        let spacing = motion.length / count as f64;
        let posed = |distance: f64| {
            let reference = Arm::<N>::spread(&motion.motors_at(distance, 0.0).0);
            let q = arm.at_rest(&reference);
            (q - reference, arm.chain.at(&q))
        };
        // Rows along feed, normal and tool axis.
        let turned = |jacobian: SMatrix<f64, 3, N>| {
            SMatrix::<f64, 3, N>::from_fn(|row, joint| {
                let column = jacobian.column(joint);
                [plane.feed, plane.normal, plane.axis][row].dot(&column)
            })
        };
        let tips = (0..=count).map(|k| {
            let distance = spacing * k as f64;
            let (yielded, posed) = posed(distance);
            let all = turned(posed.tip_jacobian());
            let (jacobian, axial) = (all.fixed_rows::<2>(0).into_owned(), all.fixed_rows::<1>(2).into_owned());
            let off = Vector2::from(plane.place(&posed.tip())) - Vector2::from(plane.nominal(motion, distance));
            Tip { jacobian, axial, offset: off - jacobian * yielded }
        });
        let intervals = (0..count).map(|k| {
            let (_, posed) = posed(spacing * (k as f64 + 0.5));
            let gravity = arm.feels_gravity().then(|| arm.stiffness(&posed, &SVector::zeros()));
            let jacobian = turned(posed.tip_jacobian());
            Interval { mass: posed.mass_matrix(&arm.chain), gravity, jacobian, factors: Vec::new() }
        });
        let loose: Vec<usize> = (0..N).filter(|joint| arm.drive.backlash[*joint] > 0.0).collect();
        let duration = step * steps as f64;
        let ticks = (duration / TICK).ceil().max(1.0) as usize;
        let tick = duration / ticks as f64;
        let requested = (0..=ticks).map(|k| requested(arm, motion, tick * k as f64));
        let (tips, intervals, requested) = (tips.collect(), intervals.collect(), requested.collect());
        Self { arm, step, spacing, tips, intervals, tick, requested, loose }
    }

    /// The interval at a distance (m) along the pass, and the tip there.
    fn at(&self, distance: f64) -> (usize, Tip<N>) {
        let place = distance / self.spacing;
        let index = (place.max(0.0) as usize).min(self.intervals.len() - 1);
        let share = place - index as f64;
        let (from, to) = (&self.tips[index], &self.tips[index + 1]);
        let jacobian = from.jacobian + (to.jacobian - from.jacobian) * share;
        let axial = from.axial + (to.axial - from.axial) * share;
        (index, Tip { jacobian, axial, offset: from.offset + (to.offset - from.offset) * share })
    }

    fn requested(&self, time: f64) -> SVector<f64, N> {
        let place = time / self.tick;
        let index = (place as usize).min(self.requested.len() - 2);
        let share = place - index as f64;
        self.requested[index] + (self.requested[index + 1] - self.requested[index]) * share
    }
}

/// What gravity and the commanded motion ask of the springs at a time: `r`, with the slope of gravity times what the
/// springs have yielded at rest added, since the equation of motion takes that slope times all that they yield. N m
fn requested<const N: usize>(arm: &Arm<N>, motion: &Motion, time: f64) -> SVector<f64, N> {
    let (angles, speeds) = motion.motors(time);
    let (reference, speed) = (Arm::<N>::spread(&angles), Arm::<N>::spread(&speeds));
    let apart = 1e-5;
    let after = Arm::<N>::spread(&motion.motors(time + apart).1);
    let before_time = (time - apart).max(0.0);
    let before = Arm::<N>::spread(&motion.motors(before_time).1);
    let acceleration = (after - before) / (time + apart - before_time);
    let q = arm.at_rest(&reference);
    let posed = arm.chain.at(&q);
    let mut torques = -posed.inverse_dynamics(&arm.chain, &speed, &acceleration, &Vector3::zeros());
    if arm.feels_gravity() {
        torques -= arm.felt_gravity(&posed, &q);
        torques += arm.stiffness(&posed, &SVector::zeros()) * (q - reference);
    }
    torques
}

impl<const N: usize> Interval<N> {
    /// The matrices for a set of acting springs: bits of loose joints that act.
    fn factor(&mut self, arm: &Arm<N>, loose: &[usize], step: f64, set: u32) -> Option<&Factor<N>> {
        if let Some(index) = self.factors.iter().position(|(made, _)| *made == set) {
            return self.factors.get(index).map(|(_, factor)| factor);
        }
        let mut springs = arm.drive.stiffness;
        for (bit, joint) in loose.iter().enumerate() {
            if set & (1 << bit) == 0 {
                springs[*joint] = 0.0;
            }
        }
        let mut matrix = self.mass;
        for joint in 0..N {
            matrix[(joint, joint)] += step / 2.0 * arm.drive.damping[joint] + step * step / 4.0 * springs[joint];
        }
        if let Some(gravity) = &self.gravity {
            matrix += (gravity + gravity.transpose()) * (step * step / 8.0);
        }
        let inverse = matrix.cholesky()?.inverse();
        let response = inverse * self.jacobian.transpose();
        let tip = self.jacobian.fixed_rows::<2>(0) * response * (step * step / 4.0);
        self.factors.push((set, Factor { inverse, response, tip }));
        self.factors.last().map(|(_, factor)| factor)
    }
}

/// Angles by which springs have yielded, their speeds and accelerations.
struct Yielded<const N: usize> {
    u: SVector<f64, N>,
    speed: SVector<f64, N>,
    acceleration: SVector<f64, N>,
}

/// On which side of its backlash a joint is: -1, 0 or 1.
fn side(angle: f64, gap: f64) -> f64 {
    if angle > gap {
        1.0
    } else if angle < -gap {
        -1.0
    } else {
        0.0
    }
}

/// Simulates a pass.
///
/// # Errors
/// [`JobError`] before the first step, or when `monitor` asked to stop.
pub(super) fn run<const N: usize>(job: &Job<'_>, arm: &Arm<N>, monitor: &Monitor) -> Result<Run, JobError> {
    let mut process = Process::new(job)?;
    let (steps, h) = (process.steps(), process.step);
    let motion = process.motion;
    monitor.go_on()?;
    let mut frozen = Frozen::new(arm, motion, &process.plane, h, steps);
    let reference = Arm::<N>::spread(&motion.motors(0.0).0);
    let mut state =
        Yielded { u: arm.at_rest(&reference) - reference, speed: SVector::zeros(), acceleration: SVector::zeros() };
    let start = process.plane.place(&arm.chain.at(&(reference + state.u)).tip());
    let mut force = process.force(0.0, start);
    let mut end = process.keep(start, [motion.ramp.at(0.0).1, 0.0], force).map_or_else(End::Limit, |()| End::Complete);
    for index in 1..=steps {
        if end != End::Complete {
            break;
        }
        process.watched(monitor)?;
        let time = index as f64 * h;
        end = match stepped(&mut frozen, &mut process, &mut state, time, force) {
            Ok(Ended { place, velocity, force: found }) => {
                force = found;
                process.keep(place, velocity, found).map_or_else(End::Limit, |()| End::Complete)
            }
            Err(error) => End::Step(error),
        };
    }
    Ok(process.ended(end))
}

/// The end of a step.
struct Ended {
    place: [f64; 2],
    velocity: [f64; 2],
    force: Force,
}

/// One step to a time (s), with the force of the step before as a first guess.
fn stepped<const N: usize>(
    frozen: &mut Frozen<'_, N>,
    process: &mut Process<'_>,
    state: &mut Yielded<N>,
    time: f64,
    guess: Force,
) -> Result<Ended, StepError> {
    let (h, arm) = (frozen.step, frozen.arm);
    let (distance, feed) = process.motion.ramp.at(time);
    let (index, tip) = frozen.at(distance);
    let nominal = Vector2::from(process.plane.nominal(process.motion, distance)) + tip.offset;
    let u = state.u + state.speed * h + state.acceleration * (h * h / 4.0);
    let speed = state.speed + state.acceleration * (h / 2.0);
    let mut free = frozen.requested(time) - arm.drive.damping.component_mul(&speed);
    if let Some(gravity) = &frozen.intervals[index].gravity {
        free -= gravity * u;
    }
    // Springs with backlash are put in below, by the side on which they act.
    free -= arm.drive.stiffness.component_mul(&u);
    let mut sides = SVector::<f64, N>::zeros();
    for joint in &frozen.loose {
        sides[*joint] = side(state.u[*joint], arm.drive.backlash[*joint]);
    }
    let Frozen { intervals, loose, .. } = frozen;
    let mut force = guess;
    for _ in 0..MAX_SETS {
        let mut set = 0;
        let mut torques = free;
        for (bit, joint) in loose.iter().enumerate() {
            let stiffness = arm.drive.stiffness[*joint];
            if sides[*joint] == 0.0 {
                torques[*joint] += stiffness * u[*joint];
            } else {
                set |= 1 << bit;
                torques[*joint] += stiffness * arm.drive.backlash[*joint] * sides[*joint];
            }
        }
        let factor = intervals[index].factor(arm, loose, h, set).ok_or(StepError::Singular(time))?;
        let mut assumed = Vector3::from(force.on_tool);
        torques += tip.jacobian.transpose() * assumed.xy() + tip.axial.transpose() * assumed.z;
        let mut acceleration = factor.inverse * torques;
        let mut place = nominal + tip.jacobian * (u + acceleration * (h * h / 4.0));
        let mut evaluations = 0;
        loop {
            force = process.force(time, place.into());
            evaluations += 1;
            let found = Vector3::from(force.on_tool);
            let change = found - assumed;
            acceleration += factor.response * change;
            let moved = factor.tip * change;
            place += moved;
            assumed = found;
            // What the force changes by when the tip moves so far.
            let follows = process.removal.stiffness() * moved.norm();
            if follows <= (FORCE_TOLERANCE * found.norm()).max(MIN_FORCE) {
                break;
            }
            if evaluations == MAX_EVALUATIONS || !follows.is_finite() {
                return Err(StepError::NotConverged { time: time - h, step: h });
            }
        }
        let next = u + acceleration * (h * h / 4.0);
        let mut settled = true;
        for joint in loose.iter() {
            let now = side(next[*joint], arm.drive.backlash[*joint]);
            settled &= now == sides[*joint];
            sides[*joint] = now;
        }
        if settled {
            state.u = next;
            state.speed = speed + acceleration * (h / 2.0);
            state.acceleration = acceleration;
            let velocity = tip.jacobian * state.speed;
            return Ok(Ended { place: place.into(), velocity: [feed + velocity[0], velocity[1]], force });
        }
    }
    Err(StepError::NotConverged { time: time - h, step: h })
}
