//! Random configurations under random loads, as many as a user could take.

use super::super::elastic::Elastic;
use super::super::response::Response;
use super::super::sheet::LoadCase;
use super::super::springs::{AXES, FULL, FitModel, compliances_of};
use super::request::{LoadDirections, Request, Volume};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use std::f64::consts::TAU;
use stead_model::robot::Frames;
use stead_model::robot::angles::ANGLE_ROUNDING;

/// What has been drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidates {
    /// The configurations that are allowed.
    pub load_cases: Vec<LoadCase>,
    /// How many were drawn.
    pub draws: usize,
    /// How many of those were not allowed, and why.
    pub rejected: Rejected,
}

/// Counts of configurations that are not allowed, by the first reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Rejected {
    /// Something would be outside the volume; or no angles were found with the sum of joints 2 and 3 within its limits.
    pub volume: usize,
    /// Something would be too near to the z axis of the base.
    pub radius: usize,
    /// A reference point would be deflected too far.
    pub deflection: usize,
}

/// What a stream of random numbers is for: its upper bits. The lower bits count draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u64)]
pub(super) enum Purpose {
    Candidates = 1 << 60,
    Tests = 2 << 60,
    RandomSets = 3 << 60,
}

/// The stream of one draw.
pub(super) fn stream(seed: u64, purpose: Purpose, index: usize) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(purpose as u64 | index as u64);
    random
}

/// So many draws for each configuration that is wanted; what is not found by then is not there.
const MAX_DRAWS_PER_CANDIDATE: usize = 200;

/// Draws configurations until there are as many candidates as requested, or nobody would wait for more.
///
/// Joint angles are uniform within the limits and whole hundredths of a degree, components of the force whole tenths of
/// a newton, so that what a sheet prints is what is planned.
pub fn draw_candidates(request: &Request) -> Candidates {
    let mut drawn =
        Candidates { load_cases: Vec::with_capacity(request.candidates), draws: 0, rejected: Rejected::default() };
    while drawn.load_cases.len() < request.candidates && drawn.draws < MAX_DRAWS_PER_CANDIDATE * request.candidates {
        let mut random = stream(request.seed, Purpose::Candidates, drawn.draws);
        drawn.draws += 1;
        let theta = angles(request, &mut random, true);
        let force = (direction(&request.loads, &mut random) * request.load).map(|value| (value * 10.0).round() / 10.0);
        let load_case = LoadCase { theta, force, moment: Vector3::zeros() };
        match rejection(request, &load_case) {
            None => drawn.load_cases.push(load_case),
            Some(reason) => *reason(&mut drawn.rejected) += 1,
        }
    }
    drawn
}

/// Draws test poses likewise, under loads in any direction.
pub fn test_cases(request: &Request, count: usize) -> Vec<LoadCase> {
    let mut tests = Vec::with_capacity(count);
    for draw in 0..MAX_DRAWS_PER_CANDIDATE * count {
        if tests.len() == count {
            break;
        }
        let mut random = stream(request.seed, Purpose::Tests, draw);
        let theta = angles(request, &mut random, false);
        let force = direction(&LoadDirections::Any, &mut random) * request.load;
        let test = LoadCase { theta, force, moment: Vector3::zeros() };
        if rejection(request, &test).is_none() {
            tests.push(test);
        }
    }
    tests
}

/// Angles are drawn again, so often at the most, where the sum of those of joints 2 and 3 is beyond its limits.
const SUM_TRIES: usize = 1000;

/// Angles within their limits, at its levels that of the joint that has such where this is asked for.
fn angles(request: &Request, random: &mut ChaCha8Rng, at_levels: bool) -> [f64; 6] {
    let mut theta = one_of_each(request, random);
    for _ in 0..SUM_TRIES {
        if at_levels && !request.levels.is_empty() {
            theta[request.level_joint] = request.levels[random.random_range(0..request.levels.len())];
        }
        if request.robot.beyond_sum(&theta) <= ANGLE_ROUNDING {
            break;
        }
        theta = one_of_each(request, random);
    }
    theta
}

/// An angle of each joint within its limits.
fn one_of_each(request: &Request, random: &mut ChaCha8Rng) -> [f64; 6] {
    request.limits.map(|[min, max]| {
        // The bounds are a little wider than the hundredths within them where those are meant exactly.
        let (low, high) = ((min.to_degrees() * 100.0 - 1e-6).ceil(), (max.to_degrees() * 100.0 + 1e-6).floor());
        let hundredths = random.random_range(low as i64..=(high.max(low)) as i64);
        (hundredths as f64 / 100.0).to_radians()
    })
}

/// A direction of the load.
fn direction(loads: &LoadDirections, random: &mut ChaCha8Rng) -> Vector3<f64> {
    let (sine, cosine) = libm::sincos(random.random_range(0.0..TAU));
    match loads {
        LoadDirections::Any => {
            let z: f64 = random.random_range(-1.0..=1.0);
            let radius = libm::sqrt(1.0 - z * z);
            Vector3::new(radius * cosine, radius * sine, z)
        }
        LoadDirections::Horizontal => Vector3::new(cosine, sine, 0.0),
        LoadDirections::Vertical => -Vector3::z(),
        LoadDirections::Listed(list) => list[random.random_range(0..list.len())],
    }
}

/// Why a configuration is not allowed: the count that it belongs to.
fn rejection(request: &Request, load_case: &LoadCase) -> Option<fn(&mut Rejected) -> &mut usize> {
    let LoadCase { theta, force, moment } = load_case;
    let frames = Frames::new(&request.robot, theta);
    let flange = &frames.base_from_flange;
    let at = |place: &Vector3<f64>| flange.point(place);
    let on_flange = request.points.iter().chain([&request.load_point, &request.tip]).map(at);
    let places = || on_flange.clone().chain([frames.wrist_centre(), flange.translation]);
    let boxed = Volume { min_radius: 0.0, ..request.volume };
    if request.robot.beyond_sum(theta) > ANGLE_ROUNDING || places().any(|place| !boxed.contains(&place)) {
        return Some(|rejected| &mut rejected.volume);
    }
    if places().any(|place| !request.volume.contains(&place)) {
        return Some(|rejected| &mut rejected.radius);
    }
    let is_far = match request.model {
        FitModel::Axes => is_far::<AXES>(request, theta, force, moment),
        FitModel::Full => is_far::<FULL>(request, theta, force, moment),
    };
    is_far.then_some(|rejected| &mut rejected.deflection)
}

/// Whether a reference point is deflected too far.
fn is_far<const N: usize>(request: &Request, theta: &[f64; 6], force: &Vector3<f64>, moment: &Vector3<f64>) -> bool {
    let arm = Elastic::<N>::unloaded(&request.robot, theta);
    let at = |place: &Vector3<f64>| arm.base_from_flange.point(place);
    let (compliances, load) = (compliances_of::<N>(&request.robot, theta), at(&request.load_point));
    request.points.iter().any(|point| {
        let response = Response::new(&arm, &at(point), &load, force, moment);
        (response.linear * compliances).norm() > request.max_deflection
    })
}
