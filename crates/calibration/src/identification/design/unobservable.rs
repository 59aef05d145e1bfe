//! Compliances that a set of configurations and loads leaves unobservable, and why.

use super::super::elastic::Elastic;
use super::super::model::{Layout, Parameter};
use super::super::normal_equations::Unidentifiable;
use super::super::sheet::LoadCase;
use super::super::springs::{FULL, column};
use super::expected::ExpectedCompliance;
use super::request::Request;
use serde::Serialize;
use stead_model::robot::{About, Spring};

/// A compliance, or a combination of several, on which no reading depends.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unobservable {
    /// The compliances in it by spring and, where the joint has several, angle (rad); the one that is given up
    /// comes first.
    pub compliances: Vec<(Spring, Option<f64>)>,
    /// Why.
    pub reason: UnobservableReason,
}

impl Unobservable {
    /// Whether both are of the same compliances, in any order.
    pub fn is_same(&self, other: &Self) -> bool {
        let near = |(a, b): (Option<f64>, Option<f64>)| (a.unwrap_or_default() - b.unwrap_or_default()).abs() < NOTHING;
        let has = |all: &[(Spring, Option<f64>)], one: &(Spring, Option<f64>)| {
            all.iter().any(|entry| entry.0 == one.0 && near((entry.1, one.1)))
        };
        self.compliances.len() == other.compliances.len()
            && self.compliances.iter().all(|entry| has(&other.compliances, entry))
    }
}

/// Why a compliance is unobservable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum UnobservableReason {
    /// Every load is along the axis of the joint.
    LoadsAlongAxis,
    /// Every load acts on the axis of the joint.
    LoadOnAxis,
    /// Every load is along a line through the axis, or parallel to it.
    NoTorque,
    /// The joint turns, but every reference point is on its axis.
    PointsOnAxis,
    /// Several compliances change the readings in proportion.
    #[serde(rename = "not-apart")]
    Dependent,
}

/// A compliance with a large expected standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WeaklyObserved {
    /// The joint, from 0.
    pub joint: usize,
    /// About which axis of the frame of its row.
    pub about: About,
    /// The angle, where the joint has several compliances. rad
    pub angle: Option<f64>,
    /// Expected standard deviation as a share of the compliance.
    pub share: f64,
    /// Root of the mean square of the load's lever about the axis of the spring. m
    pub lever: f64,
}

/// Lengths (m) and angles (rad) below this are rounding.
const NOTHING: f64 = 1e-7;

/// The unidentifiable combinations of normal equations by joint and angle, with reasons from all the loads.
pub fn unobservable(
    request: &Request,
    load_cases: &[LoadCase],
    layout: &Layout,
    unidentifiable: &[Unidentifiable],
) -> Vec<Unobservable> {
    let name = |parameter: &Parameter| (layout.spring(*parameter), layout.angle(*parameter));
    let unobservable = |unidentifiable: &Unidentifiable| {
        let compliances: Vec<_> = unidentifiable.parameters.iter().map(name).collect();
        let reason = match compliances[..] {
            [(spring, _)] => reason(request, load_cases, column(spring)),
            _ => UnobservableReason::Dependent,
        };
        Unobservable { compliances, reason }
    };
    unidentifiable.iter().map(unobservable).collect()
}

fn reason(request: &Request, load_cases: &[LoadCase], column: usize) -> UnobservableReason {
    let [mut lever, mut aside, mut off_load, mut off_points] = [0.0_f64; 4];
    for LoadCase { theta, force, .. } in load_cases {
        let arm = Elastic::<FULL>::unloaded(&request.robot, theta);
        let flange = &arm.base_from_flange;
        let along = force / force.norm();
        let load = flange.point(&request.load_point);
        let (velocity, axis) = arm.twist(column, &load);
        lever = lever.max(velocity.dot(&along).abs());
        aside = aside.max(axis.cross(&along).norm());
        off_load = off_load.max(velocity.norm());
        for point in &request.points {
            off_points = off_points.max(arm.twist(column, &flange.point(point)).0.norm());
        }
    }
    if lever > NOTHING && off_points <= NOTHING {
        UnobservableReason::PointsOnAxis
    } else if aside <= NOTHING {
        UnobservableReason::LoadsAlongAxis
    } else if off_load <= NOTHING {
        UnobservableReason::LoadOnAxis
    } else {
        UnobservableReason::NoTorque
    }
}

/// The compliances whose expected standard deviation is above a share of them.
pub fn weakly_observed(
    request: &Request,
    load_cases: &[LoadCase],
    compliances: &[ExpectedCompliance],
) -> Vec<WeaklyObserved> {
    let is_weak = |compliance: &&ExpectedCompliance| compliance.share() > request.max_relative_deviation;
    let entry = |compliance: &ExpectedCompliance| WeaklyObserved {
        joint: compliance.joint,
        about: compliance.about,
        angle: compliance.angle,
        share: compliance.share(),
        lever: lever(request, load_cases, compliance.spring()),
    };
    compliances.iter().filter(is_weak).map(entry).collect()
}

/// Root of the mean square of the load's lever about the axis of a spring. m
pub fn lever(request: &Request, load_cases: &[LoadCase], of: Spring) -> f64 {
    let square = |LoadCase { theta, force, .. }: &LoadCase| {
        let arm = Elastic::<FULL>::unloaded(&request.robot, theta);
        let load = arm.base_from_flange.point(&request.load_point);
        let torque = arm.twist(column(of), &load).0.dot(force);
        torque * torque / force.norm_squared()
    };
    libm::sqrt(load_cases.iter().map(square).sum::<f64>() / load_cases.len().max(1) as f64)
}
