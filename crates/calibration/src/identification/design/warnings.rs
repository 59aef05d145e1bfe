//! Unobservable and weakly observed compliances of a chosen set, in sentences.

use super::super::gauge::Gauge;
use super::super::springs::{FitModel, key_name};
use super::expected::ExpectedCompliance;
use super::request::{LoadDirections, Request};
use super::unobservable::{Unobservable, UnobservableReason, WeaklyObserved};
use stead_model::robot::{About, Spring};
use stead_numerics::message::Warning;

/// Warnings of unobservable compliances, then of weakly observed ones.
pub(super) fn warnings(
    request: &Request,
    gauge: &Gauge,
    unobservable: &[Unobservable],
    weak: &[WeaklyObserved],
) -> Vec<Warning> {
    let unobservable = unobservable.iter().map(|entry| Warning::new("unobservable", unobservable_text(request, entry)));
    unobservable
        .chain(weak.iter().map(|entry| Warning::new("weakly-observed", weak_text(request, gauge, entry))))
        .collect()
}

/// A note on the angles of the varying joint at which the set has no configuration, though it may.
pub(super) fn unused_angles(model: FitModel, compliances: &[ExpectedCompliance]) -> Option<String> {
    let unused = compliances.iter().filter(|compliance| compliance.deviation.is_none());
    let names: Vec<String> = unused.map(|compliance| model.name(compliance.spring(), compliance.angle)).collect();
    (!names.is_empty()).then(|| {
        let names = names.join(", ");
        format!(
            "the plan has no configuration for {names}: configurations at the other angles tell more about the joint"
        )
    })
}

fn unobservable_text(request: &Request, unobservable: &Unobservable) -> String {
    let names: Vec<String> =
        unobservable.compliances.iter().map(|(spring, angle)| request.model.name(*spring, *angle)).collect();
    let first = names.first().map_or("", String::as_str);
    let spring = unobservable.compliances.first().map(|(spring, _)| *spring);
    let axis = spring.map_or_else(String::new, |spring| axis_name(request.model, spring));
    let turned = spring.map_or_else(String::new, |spring| match request.model {
        FitModel::Axes => format!("joint {}", spring.joint + 1),
        FitModel::Full => "it".to_owned(),
    });
    let hold = spring.map_or_else(String::new, |spring| match request.model {
        FitModel::Axes => (spring.joint + 1).to_string(),
        FitModel::Full => format!("\"{}\"", key_name(spring)),
    });
    let cause = match unobservable.reason {
        UnobservableReason::LoadsAlongAxis if request.loads == LoadDirections::Vertical => {
            format!("{first} is unobservable: every load is vertical, along {axis}")
        }
        UnobservableReason::LoadsAlongAxis => format!("{first} is unobservable: every load is along {axis}"),
        UnobservableReason::LoadOnAxis => format!("{first} is unobservable: the load acts on {axis}"),
        UnobservableReason::NoTorque => format!("{first} is unobservable: no load turns {turned}"),
        UnobservableReason::PointsOnAxis => {
            format!("{first} is unobservable: every reference point is on {axis}")
        }
        UnobservableReason::Dependent => {
            format!("{} are identifiable only in combination, and {first} is given up", names.join(", "))
        }
    };
    format!(
        "{cause}; the plan is for the others, and a fit needs fit.hold = [{hold}] or fit.reduce = true to keep the value of the \
         robot file"
    )
}

fn weak_text(request: &Request, gauge: &Gauge, weak: &WeaklyObserved) -> String {
    let spring = Spring { joint: weak.joint, about: weak.about };
    let axis = axis_name(request.model, spring);
    // Three significant digits, without an exponent.
    let percent: f64 = format!("{:.2e}", weak.share * 100.0).parse().unwrap_or(weak.share * 100.0);
    format!(
        "{} is weakly observed: its expected standard deviation is {percent} % of it; the load's lever about {axis} is \
         {:.1} mm (rms): a longer one or a larger load would help",
        gauge.sum_name(spring, request.model.name(spring, weak.angle)),
        weak.lever * 1e3
    )
}

/// The line about which a spring turns: the axis of its joint, or a direction normal to it.
fn axis_name(model: FitModel, spring: Spring) -> String {
    match (model, spring.about) {
        (FitModel::Axes, _) | (_, About::Z) => format!("axis {}", spring.joint + 1),
        (FitModel::Full, about) => format!("{} of joint {}", about.word(), spring.joint + 1),
    }
}
