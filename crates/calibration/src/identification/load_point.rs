//! Whether the readings agree with where the load is said to act.
//!
//! A wrong load point scales the levers of the wrist, and least squares takes that for other compliances: their
//! intervals do not show it. What of it the compliances cannot take up stays in the residuals, and is tested for.

use super::distribution::tail;
use super::equilibria::Equilibria;
use super::model::Observation;
use super::normal_equations::{FreeParameters, NormalEquations};
use super::outcome::Identified;
use super::outliers::{ROUNDING, RobustEstimate};
use super::problem::Problem;
use super::setup::Setup;
use nalgebra::{Matrix3, SVector, Vector3, Vector6};
use stead_numerics::message::Warning;

/// Where the load acts by the readings.
#[derive(Debug, Clone, Copy)]
pub(super) struct LoadPointTest {
    /// The Gauss-Newton step from the place stated, the compliances following. Flange frame; m
    pub shift: Vector3<f64>,
    /// Probability that the residuals of a load at the place stated fall so much by such a step.
    pub probability: f64,
}

/// The place stated is doubted below this probability.
const DOUBTED: f64 = 1e-3;
/// How far the load is moved to see what that changes. m
const MOVED: f64 = 1e-3;
/// A direction of the load point of less than this part of the information of the best seen one is not seen.
const UNSEEN: f64 = 1e-8;
/// Gauss-Newton steps to the place by the readings, and the last one worth taking. m
const STEPS: (usize, f64) = (8, 1e-5);

/// Tests the load point that a problem states, about the arm of an estimate; nothing where there are too few readings
/// for it.
pub(super) fn tested<const N: usize>(
    equilibria: &Equilibria<'_, N>,
    setup: &Setup,
    equations: &[Observation<N>],
    robust: &RobustEstimate<N>,
) -> Option<LoadPointTest> {
    let Equilibria { problem, layout, free, .. } = *equilibria;
    let sheet = &problem.sheet;
    let compliances = |reading: usize| {
        robust.solution.compliances(layout.varying, layout.group(sheet.readings[reading].configuration))
    };
    let predicted = |equations: &[Observation<N>]| -> Vec<Vector6<f64>> {
        equations.iter().enumerate().map(|(index, e)| e.design * compliances(index) + e.known).collect()
    };
    let here = predicted(equations);
    let mut columns = Vec::with_capacity(3);
    for axis in 0..3 {
        let load_point = problem.load_point + Vector3::ith(axis, MOVED);
        let moved = Problem { load_point, ..problem.clone() };
        let there = predicted(&Equilibria { problem: &moved, ..*equilibria }.about(setup, &robust.solution).0);
        let change: Vec<Vector6<f64>> = there.iter().zip(&here).map(|(there, here)| (there - here) / MOVED).collect();
        columns.push(unexplained(equilibria, equations, &change, robust, free)?);
    }
    let kept = || (0..equations.len()).filter(|index| robust.kept[*index]);
    let residual = |index: usize| equations[index].deflection + equations[index].known - here[index];
    let dot = |a: usize, b: usize| kept().map(|index| columns[a][index].dot(&columns[b][index])).sum::<f64>();
    let scale = Vector3::from_fn(|axis, _| 1.0 / libm::sqrt(dot(axis, axis).max(f64::MIN_POSITIVE)));
    let information = Matrix3::from_fn(|a, b| dot(a, b) * scale[a] * scale[b]).symmetric_eigen();
    let slope = Vector3::from_fn(|axis, _| {
        scale[axis] * kept().map(|index| columns[axis][index].dot(&residual(index))).sum::<f64>()
    });
    let along = information.eigenvectors.transpose() * slope;
    let is_seen = |axis: usize| information.eigenvalues[axis] > UNSEEN * information.eigenvalues.max();
    let seen = (0..3).filter(|axis| is_seen(*axis)).count();
    let degrees = robust.degrees.checked_sub(seen).filter(|left| *left > 0 && seen > 0)?;
    let step = Vector3::from_fn(|k, _| if is_seen(k) { along[k] / information.eigenvalues[k] } else { 0.0 });
    let fall = step.dot(&along);
    let left = kept().map(|index| residual(index).norm_squared()).sum::<f64>() - fall;
    let floor = if problem.noise.is_some() { 1.0 } else { ROUNDING * ROUNDING };
    Some(LoadPointTest {
        shift: (information.eigenvectors * step).component_mul(&scale),
        probability: tail(fall / seen as f64 / (left / degrees as f64).max(floor), seen, degrees),
    })
}

/// What of a change of all readings no compliance takes up.
fn unexplained<const N: usize>(
    equilibria: &Equilibria<'_, N>,
    equations: &[Observation<N>],
    change: &[Vector6<f64>],
    robust: &RobustEstimate<N>,
    free: &FreeParameters<N>,
) -> Option<Vec<Vector6<f64>>> {
    let (sheet, layout) = (&equilibria.problem.sheet, equilibria.layout);
    let weights: Vec<f64> = robust.kept.iter().map(|kept| if *kept { 1.0 } else { 0.0 }).collect();
    let changed: Vec<Observation<N>> =
        equations.iter().zip(change).map(|(e, change)| Observation { deflection: *change, ..*e }).collect();
    let none = (&SVector::zeros(), &vec![0.0; layout.angles.len()][..]);
    let taken = NormalEquations::new(sheet, layout, &changed, &weights).solve(free, none)?;
    let left = |(e, reading): (&Observation<N>, &super::Reading)| {
        e.deflection - e.design * taken.compliances(layout.varying, layout.group(reading.configuration))
    };
    Some(changed.iter().zip(&sheet.readings).map(left).collect())
}

/// A warning where the readings contradict the place stated: where they have the load, and what that does to the
/// compliances.
pub(super) fn doubted(
    problem: &Problem,
    found: &Identified,
    test: LoadPointTest,
    fitted: impl Fn(&Problem) -> Option<(Identified, Option<LoadPointTest>)>,
) -> Option<Warning> {
    if test.probability >= DOUBTED {
        return None;
    }
    let mut moved = problem.clone();
    let mut there: Option<Identified> = None;
    let mut shift = test.shift;
    for _ in 0..STEPS.0 {
        moved.load_point += shift;
        let Some((next, test)) = fitted(&moved) else {
            there = None;
            break;
        };
        there = Some(next);
        shift = test.map_or_else(Vector3::zeros, |test| test.shift);
        if shift.norm() < STEPS.1 {
            break;
        }
    }
    let millimetres = |place: &Vector3<f64>| {
        let [x, y, z] = [place.x, place.y, place.z].map(|value| format!("{:.1}", value * 1e3 + 0.0));
        format!("[{x}, {y}, {z}]")
    };
    let stated = millimetres(&problem.load_point);
    let message = match there.filter(|there| there.residual_rms < found.residual_rms) {
        Some(there) => {
            let changes: Vec<String> = found.compliances.iter().filter_map(|e| change(e, &there)).collect();
            let changes =
                if changes.is_empty() { String::new() } else { format!(", and there {}", changes.join(", ")) };
            format!(
                "the deflections contradict load_point_mm = {stated}: they agree best with a load at {}, with a \
                 residual of {:.4} mm rms \
                 in place of {:.4} mm{changes}: measure where the load acts",
                millimetres(&moved.load_point),
                there.residual_rms * 1e3,
                found.residual_rms * 1e3
            )
        }
        None => format!(
            "the deflections contradict load_point_mm = {stated}, and other loads than at a point nearby too: check \
             load_point_mm, the \
             wrench columns and the names of the points"
        ),
    };
    Some(Warning::new("load-point", message))
}

/// How a compliance changes that leaves its interval.
fn change(estimate: &super::Estimate<super::model::Parameter>, there: &Identified) -> Option<String> {
    let other = there.compliances.iter().find(|other| other.parameter == estimate.parameter)?;
    let [low, high] = estimate.interval;
    (!(low..=high).contains(&other.value)).then(|| {
        let name = there.model.name(there.spring(other.parameter), other.angle);
        format!("the compliance {name} is {:.3} urad/(N m) in place of {:.3}", other.value * 1e6, estimate.value * 1e6)
    })
}
