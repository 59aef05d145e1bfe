//! Several states at once against one state after the other.

use super::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stead_numerics::simd::{Instructions, WithSimd};

const CASES: usize = 4096;
const SIZE: f64 = 0.3;

/// `A^T A` and `A^T d` by entries, a row of all cases each.
struct Cases<E>([Vec<E>; 9]);

impl<E: LaneNumber> WithSimd for &Cases<E> {
    type Number = E;
    type Output = Vec<E>;

    #[inline(always)]
    fn with_simd<S: Simd<Number = E>>(self, simd: S) -> Vec<E> {
        let mut gains = vec![E::of(0.0); CASES];
        for start in (0..CASES).step_by(Lanes::<S>::COUNT) {
            let row = |k: usize| Lanes::load(simd, &self.0[k], start);
            worst_gains(simd, std::array::from_fn(row), std::array::from_fn(|k| row(6 + k)), SIZE)
                .store(&mut gains, start);
        }
        gains
    }
}

#[test]
fn several_states_at_once_gain_what_each_gains() {
    let mut random = ChaCha8Rng::seed_from_u64(29);
    let mut cases = Cases(std::array::from_fn(|_| Vec::new()));
    let mut alone = Vec::new();
    for trial in 0..CASES {
        let mut any = || random.random_range(-1.0..1.0_f64);
        let mut gain = Matrix3::from_fn(|_, _| any());
        let mut parts = Vector3::from_fn(|_, _| 3.0 * any());
        match trial % 9 {
            // One direction scored, two, equal compliances, no deflection, nothing moves, the softest direction without
            // a part, or with nearly none, a small part of all, and two of the compliances equal.
            0 => {
                gain.fill_row(1, 0.0);
                gain.fill_row(2, 0.0);
                (parts.y, parts.z) = (0.0, 0.0);
            }
            1 => {
                gain.fill_row(2, 0.0);
                parts.z = 0.0;
            }
            2 => gain = Matrix3::identity() * any(),
            3 => parts = Vector3::zeros(),
            4 => gain = Matrix3::zeros(),
            5 => {
                gain = Matrix3::from_diagonal(&Vector3::new(1.0, 0.5, 0.2));
                parts = Vector3::new(0.0, 0.3 * any(), 0.1);
            }
            6 => {
                gain = Matrix3::from_diagonal(&Vector3::new(1.0, 0.5, 0.2));
                parts = Vector3::new(1e-6 * any(), 0.03 * any(), 0.1);
            }
            7 => parts *= 1e-3,
            _ => gain = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.2)),
        }
        let (curvature, slope) = (gain.tr_mul(&gain), gain.tr_mul(&parts));
        alone.push(worst_gain(curvature, slope, SIZE));
        let at = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|at| curvature[at]);
        at.into_iter().chain(slope.iter().copied()).zip(&mut cases.0).for_each(|(entry, row)| row.push(entry));
    }
    let plain = Instructions::plain().run(&cases);
    for (trial, (found, expected)) in plain.iter().zip(&alone).enumerate() {
        assert!((found - expected).abs() <= 1e-10 * expected, "{trial}: {found} {expected}");
    }
    // In single precision to some of its last digits; where nothing has a part along the softest direction, fewer.
    let single = Cases(cases.0.each_ref().map(|row| row.iter().map(|entry| *entry as f32).collect()));
    for (trial, (found, expected)) in Instructions::best().run(&single).iter().zip(&alone).enumerate() {
        let found = f64::from(*found);
        assert!((found - expected).abs() <= 3e-4 * expected, "{trial}: {found} {expected} in single precision");
    }
    for instructions in Instructions::all() {
        assert_eq!(instructions.run(&cases), plain, "{instructions:?}");
    }
}
