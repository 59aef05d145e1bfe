//! What `stead identify fit --json` prints, and `report.json`: the same document.

use crate::document::Document;
use crate::figure::{AngleDeg, PlaceMm, each, some};
use nalgebra::Vector3;
use serde_json::Value;
use stead_calibration::identification::gauge::Gauge;
use stead_calibration::identification::law::{ArmParameter, Quantity};
use stead_calibration::identification::model::Parameter;
use stead_calibration::identification::outcome::Estimate;
use stead_calibration::identification::springs::key_name;
use stead_calibration::identification::{FitModel, Held, Identified, RowResult};
use stead_model::robot::{Compensator, Compliance, Spring};
use stead_runs::IdentifyRun;

/// Significant digits of estimates.
const DIGITS: usize = 12;

records! {
    /// An identified arm. Estimates have twelve significant digits.
    pub struct IdentificationFigures of (run: &IdentifyRun, found: &Identified) {
        /// Name of the robot.
        robot: String = found.robot.name().to_owned(),
        /// Which springs were sought, where those normal to the axes were too: `full`.
        model?: &'static str = is_full(found).then(|| found.model.word()),
        /// Configurations measured.
        configurations: usize = run.problem.sheet.configurations.len(),
        /// Readings.
        readings: usize = run.problem.sheet.readings.len(),
        /// Every compliance, one for each distinct angle of the joint beside a compensator; of springs that cannot be
        /// told apart their sum.
        compliances: Vec<ComplianceFigures> =
            found.compliances.iter().map(|estimate| ComplianceFigures::of(found, estimate)).collect(),
        /// The joint beside a compensator.
        compensator: Option<CompensatorFigures> = compensator(found),
        /// The parameters of the robot file.
        arm: Vec<ParameterFigures> = found.arm.iter().map(Into::into).collect(),
        /// The springs of the robot file, where those normal to the axes were sought too.
        springs?: Vec<SpringsFigures> =
            is_full(found).then(|| (0..6).map(|joint| SpringsFigures::of(found, joint)).collect()),
        /// Joints that keep the compliance of the robot file, from 1: that about their axis.
        held: Vec<usize> = held(found),
        /// All springs that do, by name, where those normal to the axes were sought too.
        held_springs?: Vec<String> = is_full(found).then(|| held_springs(found)),
        /// Standard deviation of a reading. mm
        noise_mm: f64 = millimetres(found.noise),
        /// Whether it was estimated from the readings.
        noise_estimated: bool = found.is_noise_estimated,
        /// Standard deviation of the residuals for that of the readings.
        noise_ratio: f64 = rounded(libm::sqrt(found.variance_ratio), 6),
        /// Readings less parameters.
        degrees_of_freedom: usize = found.degrees_of_freedom,
        /// Residuals, root mean square. mm
        residual_rms_mm: f64 = millimetres(found.residual_rms),
        /// Readings left out.
        outliers: Vec<OutlierFigures> = found.outliers().map(|row| OutlierFigures::of(run, row)).collect(),
        /// Whether outliers were searched.
        outliers_searched: bool = found.are_outliers_searched,
        /// Probability of such residuals if the law of the compensator holds.
        law_probability: Option<f64> = found.law_probability.map(|probability| rounded(probability, 6)),
        /// How configurations are predicted from all others.
        leave_one_out: PredictionFigures = PredictionFigures::of(run, found),
        /// Where tracker and reference points are.
        setup: SetupFigures = SetupFigures::of(run, found),
    }

    /// A compliance.
    pub struct ComplianceFigures of (found: &Identified, estimate: &Estimate<Parameter>) {
        let [urad_per_nm, std_urad_per_nm, low_urad_per_nm, high_urad_per_nm] = numbers(estimate, URAD, DIGITS);
        let joint = found.joint(estimate.parameter);
    } with {
        /// The joint, from 1.
        joint: usize = joint + 1,
        /// The axis of the frame of its row about which the spring turns, where those normal to the axes were sought
        /// too.
        about?: &'static str = is_full(found).then(|| found.spring(estimate.parameter).about.word()),
        /// Springs whose compliance is in the estimate too, since they cannot be told apart from it.
        with?: Vec<SharedFigures> = shared(&found.gauge, found.spring(estimate.parameter)),
        /// Joint angle at which the compliance holds; only for the joint beside a compensator.
        angle_deg?: AngleDeg = some(estimate.angle),
        /// The same angle under the name of joint 2; only where that joint is beside the compensator.
        q2_deg?: AngleDeg = some(estimate.angle.filter(|_| joint == 1)),
        /// Estimated compliance. urad/(N m)
        urad_per_nm: f64 = urad_per_nm,
        /// Standard deviation of the estimate. urad/(N m)
        std_urad_per_nm: f64 = std_urad_per_nm,
        /// Lower end of the 95 % confidence interval. urad/(N m)
        low_urad_per_nm: f64 = low_urad_per_nm,
        /// Upper end of the 95 % confidence interval. urad/(N m)
        high_urad_per_nm: f64 = high_urad_per_nm,
    }

    /// A spring whose compliance is in the estimate of another.
    pub struct SharedFigures of (spring: Spring, share: f64) {
        /// The spring, as identification files name it.
        spring: String = key_name(spring),
        /// How much of its compliance is in the sum.
        share: f64 = share,
    }
}

/// The springs that are told only together with one.
pub(super) fn shared(gauge: &Gauge, spring: Spring) -> Option<Vec<SharedFigures>> {
    let others = gauge.others(spring);
    (!others.is_empty()).then(|| others.into_iter().map(|(other, share)| SharedFigures::of(other, share)).collect())
}

records! {
    /// The springs of a joint as the robot file has them: those that cannot be told apart are split such that none is
    /// below zero and the sum of all squares is least.
    pub struct SpringsFigures of (found: &Identified, joint: usize) {
        let [about_x, about_y] = found.robot.stated_normal_springs().map_or([0.0; 2], |all| all[joint].compliance);
        let about_z = match found.robot.joints()[joint].compliance {
            Compliance::Constant(value) => Some(rounded(value * URAD, DIGITS)),
            _ => None,
        };
    } with {
        /// The joint, from 1.
        joint: usize = joint + 1,
        /// Compliance about its axis; null where it changes with the angle. urad/(N m)
        about_z_urad_per_nm: Option<f64> = about_z,
        /// Compliance about x of the frame of its row. urad/(N m)
        about_x_urad_per_nm: f64 = rounded(about_x * URAD, DIGITS),
        /// Compliance about y of the frame of its row. urad/(N m)
        about_y_urad_per_nm: f64 = rounded(about_y * URAD, DIGITS),
    }

    /// A joint beside a compensator.
    pub struct CompensatorFigures of (found: &Identified, joint: usize, alone: f64, spring: &Compensator) {
        let deviation = |quantity: Quantity, factor: f64| {
            let estimate = found.arm.iter().find(|e| e.parameter.joint == joint && e.parameter.quantity == quantity);
            estimate.map(|estimate| rounded(estimate.deviation * factor, DIGITS))
        };
    } with {
        /// The joint, from 1.
        joint: usize = joint + 1,
        /// Compliance of the joint without the spring. urad/(N m)
        compliance_urad_per_nm: f64 = rounded(alone * URAD, DIGITS),
        /// Standard deviation of `compliance_urad_per_nm`; null where it was not estimated. urad/(N m)
        std_compliance_urad_per_nm: Option<f64> = deviation(Quantity::Compliance, URAD),
        /// Stiffness of the joint without the spring. MN m/rad
        stiffness_mnm_per_rad: f64 = rounded(1e-6 / alone, DIGITS),
        /// Stiffness of the spring of the compensator. N/mm
        spring_stiffness_n_per_mm: f64 = rounded(spring.spring_stiffness / 1e3, DIGITS),
        /// Standard deviation of `spring_stiffness_n_per_mm`; null where it was not estimated. N/mm
        std_spring_stiffness_n_per_mm: Option<f64> = deviation(Quantity::SpringStiffness, 1e-3),
        /// Length of the unloaded spring. mm
        free_length_mm: f64 = rounded(spring.free_length * 1e3, DIGITS),
        /// Standard deviation of `free_length_mm`; null where it was not estimated. mm
        std_free_length_mm: Option<f64> = deviation(Quantity::FreeLength, 1e3),
        /// Distance from the joint axis to the end of the spring on the base side. mm
        a_mm: f64 = rounded(spring.a * 1e3, DIGITS),
        /// Distance from the joint axis to the end of the spring on the moving link. mm
        l_mm: f64 = rounded(spring.l * 1e3, DIGITS),
        /// Angle between the lines from the joint axis to both ends of the spring, at joint angle 0. deg
        alpha_deg: f64 = rounded(spring.alpha.to_degrees(), DIGITS),
    }

    /// A parameter of the robot file, in the unit of its key.
    pub struct ParameterFigures from estimate: &Estimate<ArmParameter> {
        let (parameter, factor) = key(&estimate.parameter);
        let [value, std, low, high] = numbers(estimate, factor, DIGITS);
    } with {
        /// Key of the parameter in the robot file.
        parameter: String = parameter,
        /// Estimated value.
        value: f64 = value,
        /// Standard deviation of the estimate.
        std: f64 = std,
        /// Lower end of the 95 % confidence interval.
        low: f64 = low,
        /// Upper end of the 95 % confidence interval.
        high: f64 = high,
    }

    /// A reading left out.
    pub struct OutlierFigures of (run: &IdentifyRun, row: &RowResult) {
        /// Line of the reading in the sheet, from 1.
        line: usize = row.line,
        /// Name of the configuration.
        configuration: String = run.problem.sheet.configurations[row.configuration].name.clone(),
        /// Name of the reference point.
        point: String = run.problem.sheet.points[row.point].clone(),
        /// Magnitude of the residual: read less predicted deflection. mm
        residual_mm: f64 = millimetres((row.measured - row.predicted).norm()),
        /// The residual divided by its own standard deviation.
        studentised: f64 = rounded(row.studentised, 6),
    }

    /// How configurations are predicted from all others.
    pub struct PredictionFigures of (run: &IdentifyRun, found: &Identified) {
        let sheet = &run.problem.sheet;
        let name = |index: usize| sheet.configurations[index].name.clone();
        let prediction = &found.prediction;
    } with {
        /// Root mean square of the prediction errors over all configurations. mm
        rms_mm: f64 = millimetres(prediction.rms),
        /// The configuration with the largest prediction error.
        worst: Option<WorstConfiguration> =
            prediction.worst.map(|(index, rms)| WorstConfiguration::of(name(index), rms)),
        /// Names of configurations that cannot be predicted, since without them a compliance is not identifiable.
        unpredicted: Vec<String> = prediction.unpredicted.iter().map(|index| name(*index)).collect(),
    }

    /// The configuration that is predicted worst.
    pub struct WorstConfiguration of (name: String, rms: f64) {
        /// Name of the configuration.
        configuration: String = name,
        /// Root mean square of its prediction errors. mm
        rms_mm: f64 = millimetres(rms),
    }

    /// Where tracker and reference points are.
    pub struct SetupFigures of (run: &IdentifyRun, found: &Identified) {
        /// Pose of the robot base in the frame of the tracker.
        tracker_from_base: PoseFigures = PoseFigures::of(found),
        /// The reference points.
        points: Vec<ReferencePoint> =
            run.problem.sheet.points.iter().zip(&found.setup.points).zip(&found.setup_fit.point_deviations)
            .map(|((name, place), std)| ReferencePoint::of(name, *place, *std)).collect(),
        /// Root mean square of the residuals of the readings without a load. mm
        residual_rms_mm: f64 = millimetres(found.setup.residual_rms),
        /// The reading without a load that has the largest residual.
        worst: WorstReading = WorstReading::of(found),
    }

    /// A pose.
    pub struct PoseFigures of (found: &Identified) {
        let base = &found.setup.tracker_from_base;
    } with {
        /// Origin of the frame.
        xyz_mm: [PlaceMm; 3] = each(base.translation.into()),
        /// Rotation matrix, row by row.
        rotation: [[f64; 3]; 3] =
            [0, 1, 2].map(|row| [0, 1, 2].map(|column| rounded(base.rotation[(row, column)], DIGITS))),
    }

    /// A reference point.
    pub struct ReferencePoint of (name: &str, place: Vector3<f64>, deviation: f64) {
        /// Name of the point.
        point: String = name.to_owned(),
        /// Place of the point in the flange frame.
        flange_mm: [PlaceMm; 3] = each(place.into()),
        /// Standard deviation of that place in the direction in which it is largest. mm
        std_mm: f64 = millimetres(deviation),
    }

    /// A reading with its residual.
    pub struct WorstReading of (found: &Identified) {
        let (line, distance) = found.setup_fit.worst;
    } with {
        /// Line of the reading in the sheet, from 1.
        line: usize = line,
        /// Magnitude of its residual. mm
        mm: f64 = millimetres(distance),
    }
}

/// The document: compliances, compensator, arm with covariance, residuals, outliers, prediction error.
pub fn identify_json(run: &IdentifyRun, found: &Identified) -> Value {
    Document::new(&run.inputs).notes(&run.notes).warnings(&found.warnings).with(IdentificationFigures::of(run, found))
}

/// Lengths, with the digits of any deflection and more where they are tiny.
fn millimetres(length: f64) -> f64 {
    rounded(length * 1e3, DIGITS)
}

/// The joints that keep the compliance of the robot file: not those of which one angle alone is unidentifiable.
fn held(found: &Identified) -> Vec<usize> {
    let joint = |held: &Held| match held.parameter {
        Parameter::Joint(joint) => Some(joint + 1),
        Parameter::Normal(_) | Parameter::Group(_) => None,
    };
    found.held.iter().filter_map(joint).collect()
}

/// The springs that do, by name.
fn held_springs(found: &Identified) -> Vec<String> {
    let springs = found.held.iter().filter(|held| !matches!(held.parameter, Parameter::Group(_)));
    springs.map(|held| key_name(found.spring(held.parameter))).collect()
}

/// Whether springs normal to the axes were sought too.
pub(super) fn is_full(found: &Identified) -> bool {
    found.model == FitModel::Full
}

/// Value, standard deviation and 95 % interval, rounded in a unit.
pub(super) fn numbers<P>(estimate: &Estimate<P>, factor: f64, digits: usize) -> [f64; 4] {
    let [low, high] = estimate.interval;
    [estimate.value, estimate.deviation, low, high].map(|value| rounded(value * factor, digits))
}

fn compensator(found: &Identified) -> Option<CompensatorFigures> {
    let joint = found.varying?;
    match &found.robot.joints()[joint].compliance {
        Compliance::Compensated { alone, compensator } => {
            Some(CompensatorFigures::of(found, joint, *alone, compensator))
        }
        _ => None,
    }
}

/// The key of a robot file for a number of the arm, and what a number in SI is multiplied by to stand there.
pub(super) fn key(parameter: &ArmParameter) -> (String, f64) {
    let number = parameter.joint + 1;
    match parameter.quantity {
        Quantity::Compliance => (format!("joints[{number}].compliance_urad_per_nm"), 1e6),
        Quantity::SpringStiffness => (format!("joints[{number}].compensator.spring_stiffness_n_per_mm"), 1e-3),
        Quantity::FreeLength => (format!("joints[{number}].compensator.free_length_mm"), 1e3),
        Quantity::AboutX => (format!("joints[{number}].orthogonal_compliance_urad_per_nm[1]"), 1e6),
        Quantity::AboutY => (format!("joints[{number}].orthogonal_compliance_urad_per_nm[2]"), 1e6),
    }
}

/// Its unit there.
pub(super) fn unit(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Compliance | Quantity::AboutX | Quantity::AboutY => "urad/(N m)",
        Quantity::SpringStiffness => "N/mm",
        Quantity::FreeLength => "mm",
    }
}

/// Compliances, from rad/(N m) to urad/(N m).
pub(super) const URAD: f64 = 1e6;

/// A number with so many significant digits, as a number.
pub(super) fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}
