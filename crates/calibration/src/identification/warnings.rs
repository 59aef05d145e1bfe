//! What may be wrong with an identification that has not failed.

use super::distribution::tail;
use super::law::{ArmParameter, Quantity};
use super::model::{Layout, Parameter};
use super::outcome::{Estimate, HeldReason, Identified};
use super::problem::Problem;
use super::sheet::Sheet;
use super::springs::FitModel;
use std::cmp::Reverse;
use std::collections::BTreeMap;
use stead_model::robot::About;
use stead_numerics::message::Warning;

/// Distances below this are rounding. m
const ROUNDING: f64 = 1e-9;
/// Estimates of less than this many standard deviations are weakly identified.
const WEAK: f64 = 5.0;
/// Unloaded readings with a larger misfit than this share of the flange's spread leave levers in doubt that matter.
const MISFIT: f64 = 2e-3;
/// Likewise reference points with a larger standard deviation.
const LOOSE: f64 = 1e-3;
/// A reading so many times as far off as the others is not like them.
const FAR: f64 = 6.0;
/// Compliances so many times those of the robot file, up or down, by their median: rather another unit than another
/// arm.
const SCALE: f64 = 5.0;
/// The stated noise is doubted where the residuals are outside this range of it.
const NOISE_RATIO: std::ops::Range<f64> = 0.8..1.25;
/// Residuals are held for more than noise below this probability.
const MISFIT_PROBABILITY: f64 = 1e-3;
/// A law is doubted below this probability.
const LAW_PROBABILITY: f64 = 0.01;
/// Residuals of springs about the axes alone are doubted where they are more than so many times the noise.
const LEFT_OVER: f64 = 2.0;
/// The model is doubted with more outliers than one reading in so many.
const READINGS_PER_OUTLIER: usize = 5;

/// All warnings on a result.
pub(super) fn warnings(problem: &Problem, result: &Identified) -> Vec<Warning> {
    let mut warnings = correlated(&problem.sheet);
    warnings.extend(held(problem, result));
    warnings.extend(setup(problem, result));
    warnings.extend(scale(problem, result));
    match result.model {
        FitModel::Axes => {
            let weak_ones = result.arm.iter().filter(|e| e.value < WEAK * e.deviation);
            warnings.extend(weak_ones.map(|e| weak(e.parameter.to_string(), e.parameter)));
        }
        FitModel::Full => warnings.extend(weak_sums(result)),
    }
    warnings.extend(at_lowest(result));
    let ratio = libm::sqrt(result.variance_ratio);
    if !result.is_noise_estimated && !NOISE_RATIO.contains(&ratio) {
        let message = format!("the residuals are {ratio:.2} times as large as noise_mm lets expect");
        warnings.push(Warning::new("noise-mismatch", message));
    }
    warnings.extend(misfit(result));
    warnings.extend(full_model(result, ratio));
    if result.law_probability.is_some_and(|probability| probability < LAW_PROBABILITY) {
        let number = result.varying.unwrap_or_default() + 1;
        let message = format!(
            "the compliances of joint {number} at its distinct angles do not follow the law of its compensator, or are not \
             constant"
        );
        warnings.push(Warning::new("law-misfit", message));
    }
    if let Some(fault) = &result.spring_fault {
        let number = result.varying.unwrap_or_default() + 1;
        let message = format!(
            "the spring beside joint {number} is left out, and the joint has one compliance for all its angles; everything else is \
             kept: {fault}"
        );
        warnings.push(Warning::new("spring-not-identified", message));
    }
    if let Some(first) = result.not_at_rest.first() {
        let message = format!(
            "the deflections of {} of {} configurations (first {}) are so large that no arm with these compliances comes to rest so: \
             the compliances are wrong, or the sheet is",
            result.not_at_rest.len(),
            problem.sheet.configurations.len(),
            problem.sheet.configurations[*first].name
        );
        warnings.push(Warning::new("not-at-rest", message));
    }
    if !result.are_outliers_searched {
        warnings.push(Warning::new("outliers-not-searched", "too few readings to look for outliers"));
    }
    let (outliers, readings) = (result.outliers().count(), problem.sheet.readings.len());
    if outliers * READINGS_PER_OUTLIER > readings {
        let message = format!("{outliers} of {readings} readings are outliers: the model does not fit the sheet");
        warnings.push(Warning::new("many-outliers", message));
    }
    warnings
}

/// Readings that are there more than once, so that their errors are correlated.
fn correlated(sheet: &Sheet) -> Vec<Warning> {
    let mut unloaded: BTreeMap<[u64; 3], Vec<usize>> = BTreeMap::new();
    let mut repeated = 0;
    for configuration in &sheet.configurations {
        let own = &sheet.readings[configuration.readings.clone()];
        repeated += (1..own.len()).filter(|k| own[*k].turn.is_some_and(|turn| own[k - 1].turn == Some(turn))).count();
        for reading in own {
            let bits: [u64; 3] = std::array::from_fn(|axis| reading.unloaded[axis].to_bits());
            unloaded.entry(bits).or_default().push(reading.line);
        }
    }
    let mut warnings = Vec::new();
    let shared = || unloaded.values().filter(|lines| lines.len() > 1);
    // Where several are as long as the longest, the one that comes first.
    if let Some(lines) = shared().min_by_key(|lines| (Reverse(lines.len()), lines[0])) {
        // Differences to one common reading: a variance of one and a covariance of a half, at worst all alike.
        let factor = libm::sqrt((1.0 + lines.len() as f64) / 2.0);
        let listed: Vec<String> = lines.iter().map(usize::to_string).collect();
        let more = match shared().count() - 1 {
            0 => String::new(),
            more => format!(" (and {more} more such groups)"),
        };
        let message = format!(
            "lines {}{more} share one unloaded reading: rows that share an unloaded reading have correlated errors; the \
             intervals assume independence and may be {factor:.2} times too narrow; read without load anew before every load",
            listed.join(", ")
        );
        warnings.push(Warning::new("shared-unloaded-reading", message));
    }
    if repeated > 0 {
        let message = format!(
            "{repeated} rows repeat the orientation of another point of their configuration: it counts every time, which makes \
             the intervals too narrow; give orientations with one point alone"
        );
        warnings.push(Warning::new("repeated-orientation", message));
    }
    warnings
}

/// Parameters that were not estimated.
fn held(problem: &Problem, result: &Identified) -> Vec<Warning> {
    let layout = Layout::new(&problem.sheet, result.model, result.varying, problem.angle_tolerance);
    let warning = |held: &super::Held| {
        let spring = result.spring(held.parameter);
        let joint = match result.model {
            FitModel::Axes => format!("joint {}", spring.joint + 1),
            FitModel::Full => spring.to_string(),
        };
        let is_unstated = spring.about != About::Z && problem.robot.stated_normal_springs().is_none();
        let message = match (held.reason, layout.angle(held.parameter)) {
            (HeldReason::Asked, _) if is_unstated => format!(
                "the spring of {joint} is held rigid, as asked: the robot file states no springs normal to the axes; intervals \
                 and covariance take it for exact"
            ),
            (HeldReason::Unidentifiable, _) if is_unstated => format!(
                "the compliance of {joint} is not identifiable: it is taken for rigid, since the robot file states no springs \
                 normal to the axes, and intervals and covariance take that for exact"
            ),
            (HeldReason::Asked, _) => format!(
                "the compliance of {joint} is held at the value of the robot file, as asked: intervals and covariance \
                 take it for exact"
            ),
            (HeldReason::Unidentifiable, None) => format!(
                "the compliance of {joint} is not identifiable: it keeps the value of the robot file, which intervals \
                 and covariance take for exact"
            ),
            (HeldReason::Unidentifiable, Some(angle)) => format!(
                "the compliance of {joint} at {:.2} deg is not identifiable: there it follows from its other angles",
                angle.to_degrees()
            ),
        };
        Warning::new(if held.reason == HeldReason::Asked { "held" } else { "unidentifiable" }, message)
    };
    result.held.iter().map(warning).collect()
}

/// Base transform and reference points.
fn setup(problem: &Problem, result: &Identified) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let (off, fit) = (result.setup.residual_rms, &result.setup_fit);
    let (line, distance) = fit.worst;
    if off > MISFIT * fit.flange_rms || distance > FAR * fit.others_rms.max(ROUNDING) {
        let message = format!(
            "line {line}: the unloaded reading is {:.3} mm away from where the joint angles put it (all: {:.3} mm rms); levers \
             may be wrong by as much",
            distance * 1e3,
            off * 1e3
        );
        warnings.push(Warning::new("unloaded-misfit", message));
    }
    for (name, deviation) in problem.sheet.points.iter().zip(&fit.point_deviations) {
        if *deviation > LOOSE * fit.flange_rms {
            let message = format!(
                "the position of point {name} on the flange is known only to {:.2} mm (standard deviation), which the \
                 intervals do not include: measure with the flange in more orientations",
                deviation * 1e3
            );
            warnings.push(Warning::new("uncertain-point", message));
        }
    }
    warnings
}

/// Whether the deflections scatter by more than the readings of which they are the differences.
fn misfit(result: &Identified) -> Option<Warning> {
    let fit = &result.setup_fit;
    let ratio = result.noise.max(ROUNDING) / fit.noise.max(ROUNDING);
    let is_doubted = result.is_noise_estimated
        && fit.degrees > 0
        && ratio > NOISE_RATIO.end
        && tail(ratio * ratio, result.degrees_of_freedom.max(1), fit.degrees) < MISFIT_PROBABILITY;
    is_doubted.then(|| {
        let message = format!(
            "the deflections scatter about those of the arm found as if one reading had {:.4} mm of noise, {ratio:.1} \
             times as much as the unloaded readings show: load point, wrenches or the model are off, and the intervals do \
             not cover that",
            result.noise * 1e3
        );
        Warning::new("residual-misfit", message)
    })
}

/// Whether springs about the axes alone leave so much over that others are to be sought.
fn full_model(result: &Identified, ratio: f64) -> Option<Warning> {
    let fit = &result.setup_fit;
    let by_unloaded = result.noise.max(ROUNDING) / fit.noise.max(ROUNDING);
    let (ratio, noise) = if result.is_noise_estimated {
        (by_unloaded, "the scatter of the unloaded readings")
    } else {
        (ratio, "noise_mm")
    };
    let is_left = ratio > LEFT_OVER && (!result.is_noise_estimated || fit.degrees > 0);
    (result.model == FitModel::Axes && is_left).then(|| {
        let message = format!(
            "springs about the joint axes alone leave residuals {ratio:.1} times as large as {noise}: links and bearings may \
             yield too; fit the full model (fit.model = \"full\")"
        );
        Warning::new("full-model", message)
    })
}

/// Compliances that came out below zero by chance.
fn at_lowest(result: &Identified) -> Option<Warning> {
    if result.at_lowest.is_empty() {
        return None;
    }
    let named = |parameter: &Parameter| {
        let estimate = result.compliances.iter().find(|estimate| estimate.parameter == *parameter)?;
        let (value, deviation) = (estimate.value * 1e6, estimate.deviation * 1e6);
        Some(format!("{} ({value:.3}, standard deviation {deviation:.3})", result.name(*parameter, estimate.angle)))
    };
    let names: Vec<String> = result.at_lowest.iter().filter_map(named).collect();
    let message = format!(
        "compliances in urad/(N m) that come out below zero, or too low for the others, by no more than noise explains: {}; the \
         robot file has them as good as rigid and the others as they agree best with the readings then; the estimates and \
         intervals listed, and [covariance], are without that bound",
        names.join(", ")
    );
    Some(Warning::new("below-zero", message))
}

/// Whether all compliances are off by a common factor.
fn scale(problem: &Problem, result: &Identified) -> Option<Warning> {
    let start = problem.robot.joints();
    let ratio =
        |e: &Estimate<Parameter>| e.value / start[result.joint(e.parameter)].compliance_at(e.angle.unwrap_or_default());
    // Springs normal to the axes, and sums with them, may be of any size beside those of a robot file.
    let is_alone = |e: &&Estimate<Parameter>| {
        let spring = result.spring(e.parameter);
        spring.about == About::Z && result.gauge.others(spring).is_empty()
    };
    let mut ratios: Vec<f64> = result.compliances.iter().filter(is_alone).map(ratio).collect();
    ratios.sort_by(f64::total_cmp);
    let median = *ratios.get(ratios.len() / 2)?;
    // Three digits, and no exponent where none is needed.
    let figures: f64 = format!("{median:.2e}").parse().unwrap_or(median);
    (!(1.0 / SCALE..=SCALE).contains(&median)).then(|| {
        let message = format!(
            "the compliances are {figures} times those of the robot file (median): are forces in N and places in mm?"
        );
        Warning::new("unit-mismatch", message)
    })
}

/// Springs, or sums of them, of a full set that are hardly known; all in one sentence.
fn weak_sums(result: &Identified) -> Option<Warning> {
    let is_weak = |e: &&Estimate<Parameter>| e.value.abs() < WEAK * e.deviation;
    let names: Vec<String> =
        result.compliances.iter().filter(is_weak).map(|e| result.name(e.parameter, e.angle)).collect();
    (!names.is_empty()).then(|| {
        let message = format!(
            "weakly identified, by less than {WEAK} standard deviations: {}; take more configurations, with larger loads on \
             longer levers in all directions",
            names.join("; ")
        );
        Warning::new("weakly-identified", message)
    })
}

fn weak(name: String, parameter: ArmParameter) -> Warning {
    let ArmParameter { joint, quantity } = parameter;
    let advice = match quantity {
        Quantity::Compliance => "load the arm so that this joint turns".to_owned(),
        _ => format!("take more angles of joint {}, wider apart", joint + 1),
    };
    let message = format!("{name} is weakly identified, by less than {WEAK} standard deviations: {advice}");
    Warning::new("weakly-identified", message)
}
