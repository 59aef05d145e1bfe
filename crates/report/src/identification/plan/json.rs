//! What `stead identify plan --json` prints, and `plan.json`: the same document.

use super::super::json::{SharedFigures, URAD, key, rounded, shared};
use crate::document::Document;
use crate::figure::{AngleDeg, ForceN, PlaceMm, each};
use serde_json::Value;
use stead_calibration::identification::FitModel;
use stead_calibration::identification::design::expected::{ExpectedCompliance, ExpectedParameter};
use stead_calibration::identification::design::unobservable::{Unobservable, UnobservableReason, WeaklyObserved};
use stead_calibration::identification::design::{Design, Request};
use stead_calibration::identification::gauge::Gauge;
use stead_calibration::identification::sheet::Configuration;
use stead_model::robot::Spring;
use stead_runs::PlanRun;

/// Significant digits of expected errors.
const DIGITS: usize = 9;

records! {
    /// A plan of measurements. Expected errors have nine significant digits; they are null where they are not finite.
    pub struct PlanFigures of (run: &PlanRun, plan: &Design) {
        let request = &run.request;
    } with {
        /// Name of the robot.
        robot: String = request.robot.name().to_owned(),
        /// Seed of all random numbers.
        seed: u64 = request.seed,
        /// The load.
        load_n: ForceN = request.load.into(),
        /// Standard deviation of a reading. mm
        noise_mm: f64 = request.noise * 1e3,
        /// Reference points.
        points: usize = request.points.len(),
        /// Configurations in the order of measuring.
        configurations: Vec<ConfigurationFigures> = plan.sheet.configurations.iter().map(Into::into).collect(),
        /// Expected errors of the compliances.
        compliances: Vec<ExpectedFigures> = plan.compliances.iter().map(|bar| ExpectedFigures::of(request, plan, bar)).collect(),
        /// Expected errors of the compensator.
        compensator: Vec<ParameterFigures> = plan.compensator.iter().map(Into::into).collect(),
        /// Expected error of the deflection.
        deflection: DeflectionFigures = DeflectionFigures::of(plan),
        /// Where the candidates come from.
        candidates: CandidateFigures = CandidateFigures::of(plan),
        /// Motion through the configurations, by the joint that moves furthest in each move.
        travel_deg: AngleDeg = plan.travel.into(),
        /// Compliances that the plan does not show.
        unseen: Vec<UnseenFigures> = plan.unobservable.iter().map(|entry| UnseenFigures::of(request, entry)).collect(),
        /// Compliances that it hardly shows.
        hardly_seen: Vec<HardlySeenFigures> = plan.weakly_observed.iter().map(|hardly| HardlySeenFigures::of(request, plan, hardly)).collect(),
    }

    /// A configuration to be measured.
    pub struct ConfigurationFigures from configuration: &Configuration {
        /// Name of the configuration.
        configuration: String = configuration.name.clone(),
        /// Joint angles.
        joints_deg: [AngleDeg; 6] = each(configuration.theta),
        /// The load, in the base frame.
        force_n: [ForceN; 3] = each(configuration.force.into()),
    }

    /// A compliance: that of a joint, or of one angle of the joint beside a compensator.
    pub struct ComplianceName of (request: &Request, gauge: Option<&Gauge>, spring: Spring, angle: Option<f64>) {
        let is_full = request.model == FitModel::Full;
    } with {
        /// The joint, from 1.
        joint: usize = spring.joint + 1,
        /// The axis of the frame of its row about which the spring turns, where those normal to the axes are sought
        /// too.
        about?: &'static str = is_full.then(|| spring.about.word()),
        /// Springs whose compliance is in the estimate too, since they cannot be told apart from it.
        with?: Vec<SharedFigures> = gauge.and_then(|gauge| shared(gauge, spring)),
        /// Joint angle at which the compliance holds; only for the joint beside a compensator.
        angle_deg?: AngleDeg = angle.map(Into::into),
    }

    /// The expected error of a compliance, beside those of random sets of configurations.
    pub struct ExpectedFigures of (request: &Request, plan: &Design, bar: &ExpectedCompliance) {
        let urad = |value: Option<f64>| value.and_then(|value| digits(value * URAD));
    } with {
        #[serde(flatten)] compliance: ComplianceName =
            ComplianceName::of(request, Some(&plan.gauge), bar.spring(), bar.angle),
        /// Compliance assumed for the plan. urad/(N m)
        urad_per_nm: Option<f64> = urad(Some(bar.value)),
        /// Standard deviation that `fit` is expected to report for this compliance alone. urad/(N m)
        std_urad_per_nm: Option<f64> = urad(bar.deviation),
        /// The same in per cent of the compliance. %
        std_percent: Option<f64> = bar.deviation.and_then(|deviation| digits((100.0 * deviation / bar.value).abs())),
        /// Standard deviation by the law of the joint over all its angles. urad/(N m)
        by_law_std_urad_per_nm: Option<f64> = urad(Some(bar.by_law)),
        /// Least standard deviation by the law among the random sets of configurations. urad/(N m)
        best_random_std_urad_per_nm: Option<f64> = urad(bar.best_random),
        /// Median of that over the random sets. urad/(N m)
        median_random_std_urad_per_nm: Option<f64> = urad(bar.median_random),
    }

    /// The expected error of a parameter of the robot file, in the unit of its key.
    pub struct ParameterFigures from bar: &ExpectedParameter {
        let (parameter, factor) = key(&bar.parameter);
    } with {
        /// Key of the parameter in the robot file.
        parameter: String = parameter,
        /// Value assumed for the plan.
        value: Option<f64> = digits(bar.value * factor),
        /// Expected standard deviation.
        std: Option<f64> = digits(bar.deviation * factor),
    }

    /// The expected error of the deflection, beside those of random sets of configurations.
    pub struct DeflectionFigures of (plan: &Design) {
        let errors = &plan.errors;
        let length = |value: f64| digits(value * 1e3);
    } with {
        /// Test poses over which the deflection is predicted.
        tests: usize = plan.tests.len(),
        /// Root mean square of the deflection at the test poses. mm
        rms_mm: Option<f64> = length(plan.deflection),
        /// Expected error of the predicted deflection after the planned measurements. mm
        error_mm: Option<f64> = length(errors.planned),
        /// The least expected error among the random sets of configurations. mm
        best_random_error_mm: Option<f64> = length(errors.best_random),
        /// Median of the expected errors of the random sets. mm
        median_random_error_mm: Option<f64> = length(errors.median_random),
        /// Number of random sets compared.
        random_sets: usize = errors.random_sets,
        /// Random sets from which not every compliance is identifiable.
        random_sets_that_do_not_tell_all: usize = errors.unidentifiable_sets,
    }

    /// Where the candidates come from.
    pub struct CandidateFigures of (plan: &Design) {
        /// Candidate configurations that the limits allow.
        allowed: usize = plan.candidates,
        /// Random configurations drawn.
        drawn: usize = plan.draws,
        /// Rejected: a part would be outside the volume.
        outside_volume: usize = plan.rejected.volume,
        /// Rejected: a part would be too near to the z axis of the base.
        too_near_base: usize = plan.rejected.radius,
        /// Rejected: a reference point would deflect too far.
        deflected_too_far: usize = plan.rejected.deflection,
    }

    /// Compliances that a plan does not show.
    pub struct UnseenFigures of (request: &Request, unobservable: &Unobservable) {
        let names = unobservable.compliances.iter();
        let names = names.map(|(spring, angle)| ComplianceName::of(request, None, *spring, *angle));
    } with {
        /// The compliances that are not identifiable.
        compliances: Vec<ComplianceName> = names.collect(),
        /// Why they are not.
        #[schemars(with = "String")] reason: UnobservableReason = unobservable.reason,
    }

    /// A compliance that a plan hardly shows.
    pub struct HardlySeenFigures of (request: &Request, plan: &Design, hardly: &WeaklyObserved) {
        let spring = Spring { joint: hardly.joint, about: hardly.about };
    } with {
        #[serde(flatten)] compliance: ComplianceName =
            ComplianceName::of(request, Some(&plan.gauge), spring, hardly.angle),
        /// Expected standard deviation in per cent of the compliance. %
        std_percent: Option<f64> = digits(hardly.share * 100.0),
        /// Largest lever arm of the load about the axis of the joint.
        lever_mm: PlaceMm = hardly.lever.into(),
    }
}

/// The document: configurations in the order of measuring, expected errors beside those of random sets, warnings.
pub fn plan_json(run: &PlanRun, plan: &Design) -> Value {
    Document::new(&run.inputs)
        .notes(run.notes.iter().chain(&plan.notes))
        .warnings(&plan.warnings)
        .with(PlanFigures::of(run, plan))
}

/// Nothing where there is no finite number.
fn digits(value: f64) -> Option<f64> {
    value.is_finite().then(|| rounded(value, DIGITS))
}
