//! Speed of the four reference circles: `cargo bench --bench circularity`.
//!
//! A million points near a circle, with noise of 1 um and of 0.1 mm, lobed, and scattered over a disc; then the
//! least-squares circle of 72 points as a map of circularity computes it at every place.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::f64::consts::TAU;
use stead_assessment::circle::{Circles, least_squares, maximum_inscribed, minimum_circumscribed, minimum_zone};

fn main() {
    divan::main();
}

const MILLION: usize = 1_000_000;

/// Uniform in [0, 1).
fn uniform(random: &mut ChaCha8Rng) -> f64 {
    (random.next_u64() >> 11) as f64 * 0.5_f64.powi(53)
}

/// A round of radius 30 mm with three lobes and noise of these half widths, in mm.
fn round(count: usize, lobes: f64, noise: f64) -> Vec<[f64; 2]> {
    let mut random = ChaCha8Rng::seed_from_u64(12181);
    let place = |k: usize| {
        let angle = TAU * k as f64 / count as f64;
        let (sine, cosine) = libm::sincos(angle);
        let radius = 30.0 + lobes * libm::cos(3.0 * angle) + noise * (2.0 * uniform(&mut random) - 1.0);
        [412.0 + radius * cosine, -187.0 + radius * sine]
    };
    (0..count).map(place).collect()
}

fn disc(count: usize) -> Vec<[f64; 2]> {
    let mut random = ChaCha8Rng::seed_from_u64(12181);
    let place = |_| {
        let (sine, cosine) = libm::sincos(TAU * uniform(&mut random));
        let radius = 30.0 * uniform(&mut random).sqrt();
        [radius * cosine, radius * sine]
    };
    (0..count).map(place).collect()
}

fn shape(name: &str) -> Vec<[f64; 2]> {
    match name {
        "1 um" => round(MILLION, 0.0, 0.001),
        "0.1 mm" => round(MILLION, 0.0, 0.1),
        "lobed" => round(MILLION, 0.05, 0.001),
        _ => disc(MILLION),
    }
}

const SHAPES: [&str; 4] = ["1 um", "0.1 mm", "lobed", "disc"];

#[divan::bench(args = SHAPES, sample_count = 3, sample_size = 1)]
fn all_four(bencher: Bencher, name: &str) {
    let points = shape(name);
    bencher.counter(ItemsCount::new(MILLION)).bench_local(|| Circles::new(black_box(&points)));
}

#[divan::bench(args = SHAPES, sample_count = 3, sample_size = 1)]
fn lsc(bencher: Bencher, name: &str) {
    let points = shape(name);
    bencher.counter(ItemsCount::new(MILLION)).bench_local(|| least_squares(black_box(&points)));
}

#[divan::bench(args = SHAPES, sample_count = 3, sample_size = 1)]
fn mzc(bencher: Bencher, name: &str) {
    let points = shape(name);
    bencher.counter(ItemsCount::new(MILLION)).bench_local(|| minimum_zone(black_box(&points)));
}

#[divan::bench(args = SHAPES, sample_count = 3, sample_size = 1)]
fn mic(bencher: Bencher, name: &str) {
    let points = shape(name);
    bencher.counter(ItemsCount::new(MILLION)).bench_local(|| maximum_inscribed(black_box(&points)));
}

#[divan::bench(args = SHAPES, sample_count = 3, sample_size = 1)]
fn mcc(bencher: Bencher, name: &str) {
    let points = shape(name);
    bencher.counter(ItemsCount::new(MILLION)).bench_local(|| minimum_circumscribed(black_box(&points)));
}

#[divan::bench]
fn lsc_of_72(bencher: Bencher) {
    let points = round(72, 0.3, 0.01);
    bencher.counter(ItemsCount::new(1_usize)).bench_local(|| least_squares(black_box(&points)));
}
