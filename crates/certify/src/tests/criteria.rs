//! The tangent bound against the criterion itself, with nothing of the arm in it.

use super::super::load::Load;
use super::super::load::{Tangent, Yielding};
use super::seeded;
use nalgebra::{Matrix3, Vector3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use stead_problem::criterion::worst_force_error;

fn vector(random: &mut ChaCha8Rng) -> [f64; 3] {
    std::array::from_fn(|_| random.random_range(-1.0..1.0))
}

/// A compliance that is positive semidefinite, now and then nearly singular.
fn compliance(random: &mut ChaCha8Rng) -> Matrix3<f64> {
    let root = Matrix3::from_columns(&[0, 1, 2].map(|_| Vector3::from(vector(random))));
    let sizes = Vector3::new(1.0, random.random_range(0.05..1.0), random.random_range(0.001..1.0));
    root * Matrix3::from_diagonal(&sizes) * root.transpose()
}

fn seen(c: &Matrix3<f64>) -> Yielding {
    let (m, half) = ((c[(0, 0)] + c[(1, 1)]) / 2.0, (c[(0, 0)] - c[(1, 1)]) / 2.0);
    Yielding { m, d: [half, c[(0, 1)]], v: [c[(0, 2)], c[(1, 2)]], zz: c[(2, 2)] }
}

/// One, two or three scored directions, with errors of the force or without.
fn load(random: &mut ChaCha8Rng, k: usize) -> Load {
    let mut directions = [[0.0; 3]; 3];
    directions[..=k % 3].iter_mut().for_each(|direction| *direction = vector(random));
    let force = vector(random).map(|f| 100.0 * f);
    let size = Vector3::from(force).norm();
    let error = [0.0, 0.1, 0.4][k / 3 % 3] * size;
    Load { directions, force, moment: [0.0; 3], error, part: None, turn: 0.0 }
}

/// The score by the criterion's own maximum over errors of the force.
fn score(load: &Load, c: &Matrix3<f64>) -> f64 {
    let rows = Matrix3::from_columns(&load.directions.map(Vector3::from)).transpose();
    let parts = rows * c * Vector3::from(load.force);
    let gain = rows * c;
    if load.error == 0.0 {
        return parts.norm();
    }
    (parts + gain * worst_force_error(&gain, &parts, load.error)).norm()
}

/// How often a tangent at one compliance is above the score at another, by more than rounding; and what is missing at
/// its own compliance: the largest share without errors, and the mean with errors of a tenth.
fn violations(change: fn(&mut Load), own: fn(Tangent) -> Tangent) -> (usize, [f64; 2]) {
    let mut random = seeded(81);
    let (mut wrong, mut missing) = (0, [0.0_f64; 2]);
    for k in 0..9000 {
        let load = load(&mut random, k);
        let mut changed = load;
        change(&mut changed);
        let at = compliance(&mut random);
        let (sharp, of_error) = changed.tangents(&seen(&at), [0.0; 3]);
        let kind = k / 3 % 3;
        let lost = 1.0 - own(sharp).of(&seen(&at)) / score(&load, &at);
        match kind {
            0 => missing[0] = missing[0].max(lost),
            1 => missing[1] += lost / 3000.0,
            _ => {}
        }
        for other in 0..6 {
            // Near by, where tangents are sharp, and anywhere.
            let share = [0.0, 1e-3, 0.03, 0.3, 1.0, 1.0][other];
            let c = at * (1.0 - share) + compliance(&mut random) * share;
            let truth = score(&load, &c);
            for tangent in [Some(sharp), of_error].into_iter().flatten() {
                wrong += usize::from(own(tangent).of(&seen(&c)) > truth * (1.0 + 1e-9));
            }
        }
    }
    (wrong, missing)
}

#[test]
fn tangents_are_below_the_score_everywhere_and_sharp_where_they_were_taken() {
    let (wrong, missing) = violations(|_| {}, |tangent| tangent);
    assert_eq!(wrong, 0);
    assert!(missing[0] < 1e-9 && missing[1] < 1e-3, "{missing:?}");
}

/// What tangents leave out at their own compliance, at most and in the mean, with forces near to the stiffest axis of
/// it, errors of a tenth of them, and the whole displacement scored.
fn missing_near_the_stiffest_axis() -> [f64; 2] {
    let mut random = seeded(82);
    let (mut most, mut mean) = (0.0_f64, 0.0);
    for k in 0..3000 {
        let at = compliance(&mut random);
        let axes = at.symmetric_eigen();
        let stiffest = axes.eigenvectors.column(axes.eigenvalues.imin()).into_owned();
        let off = Vector3::from(vector(&mut random)) * [0.0, 1e-6, 0.01, 0.1, 0.5][k % 5];
        let force: [f64; 3] = ((stiffest + off).normalize() * 100.0).into();
        let directions = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let load = Load { directions, force, moment: [0.0; 3], error: 10.0, part: None, turn: 0.0 };
        let lost = 1.0 - load.tangents(&seen(&at), [0.0; 3]).0.of(&seen(&at)) / score(&load, &at);
        (most, mean) = (most.max(lost), mean + lost / 3000.0);
    }
    [most, mean]
}

#[test]
fn tangents_are_sharp_where_the_force_acts_along_the_stiffest_axis() {
    let [most, mean] = missing_near_the_stiffest_axis();
    assert!(most < 0.2 && mean < 5e-4, "{most} {mean}");
}

#[test]
fn broken_tangents_are_seen() {
    type Mutation = (&'static str, fn(&mut Load), fn(Tangent) -> Tangent);
    let mutations: [Mutation; 6] = [
        ("errors twice as large", |load| load.error *= 2.0, |tangent| tangent),
        ("force a thousandth larger", |load| load.force = load.force.map(|f| 1.001 * f), |tangent| tangent),
        ("scored directions a thousandth longer", longer, |tangent| tangent),
        ("vertical part once", |_| {}, |tangent| Tangent { vertical: tangent.vertical.map(|v| 0.5 * v), ..tangent }),
        ("axial part left out", |_| {}, |tangent| Tangent { axial: 0.0, ..tangent }),
        ("turning the other way", |_| {}, |tangent| Tangent { turning: tangent.turning.map(|t| -t), ..tangent }),
    ];
    for (name, change, own) in mutations {
        assert!(violations(change, own).0 > 0, "{name} is not seen");
    }
}

fn longer(load: &mut Load) {
    load.directions = load.directions.map(|direction| direction.map(|x| 1.001 * x));
}
