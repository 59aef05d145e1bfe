//! The job as a whole.

use super::found::Found;
use super::law::{Law, LawError};
use super::model::{Layout, Noise, Observation, Parameter, Response, observations};
use super::normal::{Free, Normal, Unseen};
use super::outcome::Identified;
use super::outliers::Task;
use super::setup::{Setup, SetupError, check, estimate};
use super::sheet::Sheet;
use nalgebra::{Matrix3, Vector3, Vector6};
use stead_model::robot::{Pose, Robot, RobotError};

/// What is to be identified, from what.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// The arm to start from: geometry, limits, and compliances of about the right size.
    pub robot: Robot,
    /// The measurements.
    pub sheet: Sheet,
    /// Where the wrench acts, in the flange frame. m
    pub load_point: Vector3<f64>,
    /// Standard deviation of a coordinate of one reading, if known; always known in sheets with orientations. m
    pub noise: Option<f64>,
    /// Standard deviation of a component of one orientation; used in sheets with orientations. rad
    pub orientation_noise: Option<f64>,
    /// The joint (from 0) with one compliance for each distinct angle, and the law of those.
    pub varying: Option<(usize, Law)>,
    /// Angles of that joint that differ by no more than this count as one. rad
    pub angle_tolerance: f64,
    /// Rotation from the robot base to the tracker's frame to start from; without it, all round.
    pub start: Option<Matrix3<f64>>,
    /// Whether parameters that cannot be seen are held at the values of `robot`; else they are refused.
    pub reduce: bool,
}

/// Why nothing can be identified.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// Base transform and reference points cannot be told.
    #[error("{0}")]
    Setup(#[from] SetupError),
    /// A deflection is far larger than the load could cause on the starting arm.
    #[error("a deflection of {deflection_mm:.3} mm, where the load could cause some {expected_mm:.3} mm")]
    TooFar {
        /// Line of the reading in the sheet, from 1.
        line: usize,
        /// The deflection. mm
        deflection_mm: f64,
        /// Upper bound by the compliances of the starting arm. mm
        expected_mm: f64,
    },
    /// Fewer equations than unknowns.
    #[error("{equations} deflection components do not tell {unknowns} compliances")]
    TooFew {
        /// Components read.
        equations: usize,
        /// Compliances sought.
        unknowns: usize,
    },
    /// As many equations as unknowns, and the noise is not stated.
    #[error("{equations} deflection components for {equations} compliances leave nothing to estimate the noise from")]
    NoiseUnknown {
        /// Components read, and compliances sought.
        equations: usize,
    },
    /// Compliances, or combinations of them, that change no reading.
    #[error("the readings do not see every compliance")]
    Unseen {
        /// What they do not see.
        unseen: Vec<Unseen>,
        /// The parameters, to name them by.
        layout: Layout,
        /// Lines of the outliers without which it is so, from 1; none where all readings together do not see them.
        outliers: Vec<usize>,
    },
    /// A compliance comes out far below zero: the arm goes against the load.
    #[error(
        "the compliance of joint {joint} comes out as {value_urad:.4} with a standard deviation of {deviation_urad:.4} \
         urad/(N m): the joint turns against its load"
    )]
    Negative {
        /// Number of the joint, from 1.
        joint: usize,
        /// The estimate. urad/(N m)
        value_urad: f64,
        /// Its standard deviation. urad/(N m)
        deviation_urad: f64,
    },
    /// The compensator cannot be told.
    #[error("{0}")]
    Law(#[from] LawError),
    /// A compliance comes out at zero or below.
    #[error(
        "the compliance of joint {joint} comes out as {value_urad:.4} with a standard deviation of {deviation_urad:.4} \
         urad/(N m): it is not told by these readings"
    )]
    NotPositive {
        /// Number of the joint, from 1.
        joint: usize,
        /// The estimate. urad/(N m)
        value_urad: f64,
        /// Its standard deviation. urad/(N m)
        deviation_urad: f64,
    },
    /// The identified arm is refused, as where the compensator makes a joint give way inside its limits.
    #[error("the identified arm is none: {0}")]
    Robot(#[from] RobotError),
}

/// Deflections may be this many times what the starting arm lets expect.
const FAR: f64 = 50.0;
/// Residuals below this are rounding, whatever the tracker. m
pub(super) const ROUNDING: f64 = 1e-10;
/// Setup and outliers hardly depend on each other: two rounds settle them.
const ROUNDS: usize = 4;

/// Identifies the compliances of an arm.
///
/// Outliers are left out of the deflections and then of the setup too, until both agree. Where the noise is not stated it is
/// estimated from the residuals, with twice its variance in the difference of two readings.
///
/// # Errors
/// [`IdentifyError`] when the sheet does not tell them.
pub fn identify(problem: &Problem) -> Result<Identified, IdentifyError> {
    let sheet = &problem.sheet;
    let layout = Layout::new(sheet, problem.varying.map(|(joint, _)| joint), problem.angle_tolerance);
    let flanges: Vec<Pose<f64>> = sheet.configurations.iter().map(|c| problem.robot.forward(&c.theta)).collect();
    let mut kept = vec![true; sheet.readings.len()];
    let mut used = kept.clone();
    let mut setup = estimate(sheet, &flanges, &kept, problem.start.as_ref())?;
    check_lengths(problem, &setup)?;
    let (start_joints, start_groups) = starting_values(problem, &layout);
    let held = (&start_joints, &start_groups[..]);
    let noise = Noise { position: problem.noise.unwrap_or(1.0), orientation: problem.orientation_noise.unwrap_or(1.0) };
    let least_scale = if problem.noise.is_some() { 1.0 } else { ROUNDING };
    let equations = |setup: &Setup| observations(&problem.robot, sheet, setup, &problem.load_point, &noise);
    let mut observations = equations(&setup);
    let (free, dropped) = free_parameters(problem, &layout, &observations)?;
    if problem.varying.is_some() && free.groups.iter().all(|is_free| !is_free) {
        // Seen at no angle: then there is no law to be found either, and the joint keeps the one it has.
        return identify(&Problem { varying: None, ..problem.clone() });
    }
    let judge = |observations: &[Observation]| {
        let task = Task { sheet, layout: &layout, observations, free: &free, held, least_scale };
        task.judge().map_err(|kept| unseen_without_outliers(sheet, &layout, observations, &free, &kept))
    };
    let mut judgement = judge(&observations)?;
    for _ in 0..ROUNDS {
        if judgement.kept == kept {
            break;
        }
        kept.clone_from(&judgement.kept);
        // A point whose deflections are all outliers has a place all the same.
        let is_lost = |point: usize| !sheet.readings.iter().zip(&kept).any(|(r, kept)| *kept && r.point == point);
        let lost: Vec<bool> = (0..sheet.points.len()).map(is_lost).collect();
        used = sheet.readings.iter().zip(&kept).map(|(reading, kept)| *kept || lost[reading.point]).collect();
        setup = estimate(sheet, &flanges, &used, Some(&setup.tracker_from_base.rotation))?;
        observations = equations(&setup);
        judgement = judge(&observations)?;
    }
    let fit = check(sheet, &flanges, &used, &setup)?;
    let found = Found { problem, layout: &layout, setup, fit, equations: &observations, free: &free, judgement, noise };
    found.outcome(dropped)
}

/// What the readings that are kept do not see, and which outliers would be needed for it.
fn unseen_without_outliers(
    sheet: &Sheet,
    layout: &Layout,
    observations: &[Observation],
    free: &Free,
    kept: &[bool],
) -> IdentifyError {
    let weights: Vec<f64> = kept.iter().map(|kept| if *kept { 1.0 } else { 0.0 }).collect();
    let unseen = Normal::new(sheet, layout, observations, &weights).unseen(free);
    let outliers = sheet.readings.iter().zip(kept).filter(|(_, kept)| !**kept).map(|(reading, _)| reading.line);
    IdentifyError::Unseen { unseen, layout: layout.clone(), outliers: outliers.collect() }
}

/// Refuses a deflection that is far larger than the starting arm lets expect.
fn check_lengths(problem: &Problem, setup: &Setup) -> Result<(), IdentifyError> {
    for configuration in &problem.sheet.configurations {
        let compliances = problem.robot.compliances_at(&configuration.theta);
        for reading in &problem.sheet.readings[configuration.readings.clone()] {
            let response =
                Response::of(&problem.robot, configuration, &problem.load_point, &setup.points[reading.point]);
            let columns = response.linear.column_iter().zip(compliances);
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

/// The compliances of the starting arm: of the joints, and at the distinct angles.
fn starting_values(problem: &Problem, layout: &Layout) -> (Vector6<f64>, Vec<f64>) {
    let middle = problem.sheet.configurations.first().map_or([0.0; 6], |configuration| configuration.theta);
    let joints = Vector6::from(problem.robot.compliances_at(&middle));
    let at = |angle: &f64| layout.varying.map_or(0.0, |joint| problem.robot.joints()[joint].compliance_at(*angle));
    (joints, layout.angles.iter().map(at).collect())
}

/// Which parameters are sought, and those that are not because nothing is seen of them.
fn free_parameters(
    problem: &Problem,
    layout: &Layout,
    equations: &[Observation],
) -> Result<(Free, Vec<Parameter>), IdentifyError> {
    let sheet = &problem.sheet;
    let normal = Normal::new(sheet, layout, equations, &vec![1.0; equations.len()]);
    let (free, unseen) = normal.tellable();
    let rows = sheet.readings.len() * sheet.rows_per_reading();
    if !unseen.is_empty() && !problem.reduce {
        let unknowns = layout.parameters().len();
        return Err(if rows < unknowns {
            IdentifyError::TooFew { equations: rows, unknowns }
        } else {
            IdentifyError::Unseen { unseen, layout: layout.clone(), outliers: vec![] }
        });
    }
    let dropped: Vec<Parameter> = unseen.iter().filter_map(|unseen| unseen.parameters.first().copied()).collect();
    let unknowns = layout.parameters().len() - dropped.len();
    if rows < unknowns || unknowns == 0 {
        return Err(IdentifyError::TooFew { equations: rows, unknowns });
    }
    if rows == unknowns && problem.noise.is_none() {
        return Err(IdentifyError::NoiseUnknown { equations: rows });
    }
    Ok((free, dropped))
}
