//! Unobservable and weakly observed compliances of a chosen set, in sentences.

use super::super::model::compliance_name;
use super::expected::ExpectedCompliance;
use super::request::{LoadDirections, Request};
use super::unobservable::{Unobservable, UnobservableReason, WeaklyObserved};
use stead_numerics::message::Warning;

/// Warnings of unobservable compliances, then of weakly observed ones.
pub(super) fn warnings(request: &Request, unobservable: &[Unobservable], weak: &[WeaklyObserved]) -> Vec<Warning> {
    let unobservable = unobservable.iter().map(|entry| Warning::new("unobservable", unobservable_text(request, entry)));
    unobservable.chain(weak.iter().map(|entry| Warning::new("weakly-observed", weak_text(entry)))).collect()
}

/// A note on the angles of the varying joint at which the set has no configuration, though it may.
pub(super) fn unused_angles(compliances: &[ExpectedCompliance]) -> Option<String> {
    let unused = compliances.iter().filter(|compliance| compliance.deviation.is_none());
    let names: Vec<String> = unused.map(|compliance| compliance_name(compliance.joint, compliance.angle)).collect();
    (!names.is_empty()).then(|| {
        let names = names.join(", ");
        format!(
            "the plan has no configuration for {names}: configurations at the other angles tell more about the joint"
        )
    })
}

fn unobservable_text(request: &Request, unobservable: &Unobservable) -> String {
    let names: Vec<String> =
        unobservable.compliances.iter().map(|(joint, angle)| compliance_name(*joint, *angle)).collect();
    let first = names.first().map_or("", String::as_str);
    let axis = unobservable.compliances.first().map_or(0, |(joint, _)| joint + 1);
    let cause = match unobservable.reason {
        UnobservableReason::LoadsAlongAxis if request.loads == LoadDirections::Vertical => {
            format!("{first} is unobservable: every load is vertical, along axis {axis}")
        }
        UnobservableReason::LoadsAlongAxis => format!("{first} is unobservable: every load is along axis {axis}"),
        UnobservableReason::LoadOnAxis => format!("{first} is unobservable: the load acts on axis {axis}"),
        UnobservableReason::NoTorque => format!("{first} is unobservable: no load turns joint {axis}"),
        UnobservableReason::PointsOnAxis => {
            format!("{first} is unobservable: every reference point is on axis {axis}")
        }
        UnobservableReason::Dependent => {
            format!("{} are identifiable only in combination, and {first} is given up", names.join(", "))
        }
    };
    format!(
        "{cause}; the plan is for the others, and a fit needs fit.hold = [{axis}] or fit.reduce = true to keep the value of the \
         robot file"
    )
}

fn weak_text(weak: &WeaklyObserved) -> String {
    let axis = weak.joint + 1;
    // Three significant digits, without an exponent.
    let percent: f64 = format!("{:.2e}", weak.share * 100.0).parse().unwrap_or(weak.share * 100.0);
    format!(
        "{} is weakly observed: its expected standard deviation is {percent} % of it; the load's lever about axis {axis} is \
         {:.1} mm (rms): a longer one or a larger load would help",
        compliance_name(weak.joint, weak.angle),
        weak.lever * 1e3
    )
}
