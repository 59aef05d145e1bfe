//! The identification as a whole.

use super::assemble::Assembly;
use super::equilibria::Equilibria;
use super::error::IdentifyError;
use super::gauge::Gauge;
use super::load_point::{LoadPointTest, doubted, tested};
use super::model::{Layout, Noise, Observation, ObservationModel, Parameter};
use super::normal_equations::{FreeParameters, NormalEquations};
use super::outcome::Identified;
use super::problem::Problem;
use super::response::Response;
use super::setup::{Setup, check, estimate};
use super::sheet::Sheet;
use super::springs::{AXES, FULL, FitModel, column, compliances_of, held, spring};
use super::warnings::warnings;
use nalgebra::SVector;
use stead_model::robot::Pose;
use stead_numerics::monitor::{Monitor, Progress};

/// Largest ratio of a deflection to the one predicted by the starting arm.
const FAR: f64 = 50.0;
/// Rounds of setup and outliers, which depend on each other only weakly: two usually suffice.
const ROUNDS: usize = 4;

/// Identifies the compliances of an arm.
///
/// The equations are linear about the arm as it rests under its loads, and are made anew with its new compliances until
/// they predict every reading as its static equilibrium does. Outliers are left out of the deflections and then of the
/// setup too, until both agree. Noise that is not stated is estimated from the residuals; a deflection is the
/// difference of two readings and has twice their variance.
///
/// # Errors
/// [`IdentifyError`] when they are not identifiable from the sheet, or when `monitor` asked to stop.
pub fn identify(problem: &Problem, monitor: &Monitor) -> Result<Identified, IdentifyError> {
    let (mut identified, load_point) = fitted(problem, "fitting the arm", monitor)?;
    identified.warnings = warnings(problem, &identified);
    let moved = |moved: &Problem| fitted(moved, "load elsewhere", monitor).ok();
    let doubt = load_point.and_then(|test| doubted(problem, &identified, test, moved));
    // What was found of the load point by then is no answer.
    monitor.go_on()?;
    identified.warnings.extend(doubt);
    Ok(identified)
}

/// All of an identification but the warnings, and the test of the load point.
type Fitted = Result<(Identified, Option<LoadPointTest>), IdentifyError>;

/// That of a problem, reported as a stage.
fn fitted(problem: &Problem, stage: &'static str, monitor: &Monitor) -> Fitted {
    if problem.varying.is_some_and(|(joint, _)| problem.hold[joint]) {
        // The joint keeps the law that it has in the starting arm: there is none to fit.
        return fitted(&Problem { varying: None, ..problem.clone() }, stage, monitor);
    }
    match problem.model {
        FitModel::Axes => fitted_of::<AXES>(problem, stage, monitor),
        FitModel::Full => fitted_of::<FULL>(problem, stage, monitor),
    }
}

/// The same with so many springs.
fn fitted_of<const N: usize>(problem: &Problem, stage: &'static str, monitor: &Monitor) -> Fitted {
    monitor.go_on()?;
    let round_done = |done: usize| monitor.report(Progress::Steps { stage, done, total: 1 + ROUNDS });
    let sheet = &problem.sheet;
    let layout = Layout::new(sheet, problem.model, problem.varying.map(|(joint, _)| joint), problem.angle_tolerance);
    let flanges: Vec<Pose<f64>> = sheet.configurations.iter().map(|c| problem.robot.forward(&c.theta)).collect();
    let mut kept = vec![true; sheet.readings.len()];
    let mut used = kept.clone();
    let mut setup = estimate(sheet, &flanges, &kept, problem.start.as_ref())?;
    check_lengths::<N>(problem, &setup)?;
    let asked: [bool; N] = held(&problem.hold, &problem.hold_normal);
    let gauge = Gauge::of(problem.model, &problem.robot, &asked);
    let values = starting_values::<N>(problem, &layout, &gauge);
    let noise = Noise { position: problem.noise.unwrap_or(1.0), orientation: problem.orientation_noise.unwrap_or(1.0) };
    let Problem { robot, load_point, .. } = problem;
    let unloaded = ObservationModel { robot, sheet, setup: &setup, load_point, noise, hold: asked }.linear();
    let (free, dropped) = free_parameters(problem, &layout, &asked, &gauge, &unloaded)?;
    if problem.varying.is_some() && free.groups.iter().all(|is_free| !is_free) {
        // Identifiable at no angle: then its law is not either, and the joint keeps the one it has.
        return fitted(&Problem { varying: None, ..problem.clone() }, stage, monitor);
    }
    // A spring that is given up is held like one that is to be: at the angle of each configuration.
    let hold = std::array::from_fn(|number| asked[number] || dropped.contains(&Parameter::of_column(number)));
    let equilibria =
        Equilibria { problem, layout: &layout, free: &free, held: (&values.0, &values.1), hold, noise, monitor };
    let mut settled = equilibria.settled(&setup, unloaded, &kept);
    monitor.go_on()?;
    let mut robust = equilibria.robust_estimate(&settled.observations)?;
    for round in 1..=ROUNDS {
        round_done(round);
        if robust.kept == kept {
            break;
        }
        kept.clone_from(&robust.kept);
        used = used_for_setup(sheet, &kept);
        setup = estimate(sheet, &flanges, &used, Some(&setup.tracker_from_base.rotation))?;
        let (about, _) = equilibria.about(&setup, &robust.solution);
        settled = equilibria.settled(&setup, about, &kept);
        monitor.go_on()?;
        robust = equilibria.robust_estimate(&settled.observations)?;
    }
    monitor.go_on()?;
    round_done(1 + ROUNDS);
    let fit = check(sheet, &flanges, &used, &setup)?;
    let load_point = tested(&equilibria, &setup, &settled.observations, &robust);
    let assembly = Assembly {
        problem,
        layout: &layout,
        setup,
        fit,
        equations: &settled.observations,
        free: &free,
        robust,
        noise,
        asked,
        gauge,
        not_at_rest: settled.not_at_rest,
    };
    Ok((assembly.assemble(dropped)?, load_point))
}

/// The readings by which base transform and reference points are estimated where these are no outliers: a point whose
/// deflections all are has a place all the same.
fn used_for_setup(sheet: &Sheet, kept: &[bool]) -> Vec<bool> {
    let is_lost = |point: usize| !sheet.readings.iter().zip(kept).any(|(r, kept)| *kept && r.point == point);
    let lost: Vec<bool> = (0..sheet.points.len()).map(is_lost).collect();
    sheet.readings.iter().zip(kept).map(|(reading, kept)| *kept || lost[reading.point]).collect()
}

/// Refuses a deflection far larger than the one predicted by the starting arm.
fn check_lengths<const N: usize>(problem: &Problem, setup: &Setup) -> Result<(), IdentifyError> {
    for configuration in &problem.sheet.configurations {
        let compliances = compliances_of::<N>(&problem.robot, &configuration.theta);
        for reading in &problem.sheet.readings[configuration.readings.clone()] {
            let response =
                Response::<N>::of(&problem.robot, configuration, &problem.load_point, &setup.points[reading.point]);
            let columns = response.linear.column_iter().zip(compliances.iter());
            let expected: f64 = columns.map(|(column, compliance)| column.norm() * compliance).sum();
            let deflection = (reading.loaded - reading.unloaded).norm();
            if deflection > FAR * expected.max(1e-4) {
                return Err(IdentifyError::TooFar {
                    line: reading.line,
                    deflection_mm: deflection * 1e3,
                    expected_mm: expected * 1e3,
                });
            }
        }
    }
    Ok(())
}

/// The compliances of the starting arm, zero for springs that others replace: of the springs, and at the distinct
/// angles.
fn starting_values<const N: usize>(problem: &Problem, layout: &Layout, gauge: &Gauge) -> (SVector<f64, N>, Vec<f64>) {
    let middle = problem.sheet.configurations.first().map_or([0.0; 6], |configuration| configuration.theta);
    let mut joints = compliances_of::<N>(&problem.robot, &middle);
    gauge.replaced.iter().for_each(|replaced| joints[column(replaced.spring)] = 0.0);
    let at = |angle: &f64| layout.varying.map_or(0.0, |joint| problem.robot.joints()[joint].compliance_at(*angle));
    (joints, layout.angles.iter().map(at).collect())
}

/// The parameters to estimate, and those given up so that these are identifiable.
fn free_parameters<const N: usize>(
    problem: &Problem,
    layout: &Layout,
    asked: &[bool; N],
    gauge: &Gauge,
    equations: &[Observation<N>],
) -> Result<(FreeParameters<N>, Vec<Parameter>), IdentifyError> {
    if asked.iter().all(|held| *held) {
        return Err(IdentifyError::NothingFree);
    }
    let sheet = &problem.sheet;
    let normal = NormalEquations::new(sheet, layout, equations, &vec![1.0; equations.len()]);
    let hold = std::array::from_fn(|number| asked[number] || gauge.is_zero(spring(number)));
    let (free, unidentifiable) = normal.identifiable(hold);
    let rows = sheet.readings.len() * sheet.rows_per_reading();
    if !unidentifiable.is_empty() && !problem.reduce {
        let unknowns = normal.free_unless(hold).count();
        return Err(if rows < unknowns {
            IdentifyError::TooFew { equations: rows, unknowns }
        } else {
            IdentifyError::Unidentifiable { unidentifiable, layout: layout.clone(), outliers: vec![] }
        });
    }
    let dropped: Vec<Parameter> =
        unidentifiable.iter().filter_map(|unidentifiable| unidentifiable.parameters.first().copied()).collect();
    let unknowns = free.count();
    if rows < unknowns || unknowns == 0 {
        return Err(IdentifyError::TooFew { equations: rows, unknowns });
    }
    if rows == unknowns && problem.noise.is_none() {
        return Err(IdentifyError::NoiseUnknown { equations: rows });
    }
    Ok((free, dropped))
}
