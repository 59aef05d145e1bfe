//! Lanes against `f64` and libm, with every kind of instructions that this processor has.

use super::*;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// A function of two numbers, worked out in lanes with the second number and others around it.
struct InLanes<F, E> {
    a: E,
    b: E,
    function: F,
}

/// What [`InLanes`] works out.
trait Function {
    fn of<S: Simd>(&self, a: Lanes<S>, b: Lanes<S>) -> Lanes<S>;
}

impl<F: Function, E: LaneNumber> WithSimd for InLanes<F, E> {
    type Number = E;
    type Output = E;

    #[inline(always)]
    fn with_simd<S: Simd<Number = E>>(self, simd: S) -> E {
        // The last lane of other numbers.
        let mut a = [E::of(0.3); MAX_LANES];
        let mut b = [E::of(-0.7); MAX_LANES];
        (a[S::COUNT - 1], b[S::COUNT - 1]) = (self.a, self.b);
        let found = self.function.of(Lanes::load(simd, &a, 0), Lanes::load(simd, &b, 0));
        found.to_array()[S::COUNT - 1]
    }
}

/// One result, and that all instructions give its bits.
fn in_lanes<F: Function + Copy, E: LaneNumber>(function: F, a: E, b: E) -> E {
    let results = Instructions::all().map(|way| way.run(InLanes { a, b, function }));
    let bits = results.map(|result| result.get().to_bits());
    assert!(bits.iter().all(|one| *one == bits[0]), "{results:?} {a:?} {b:?}");
    results[0]
}

macro_rules! function {
    ($name:ident, $a:ident, $b:ident, $value:expr) => {
        #[derive(Clone, Copy)]
        struct $name;
        impl Function for $name {
            #[inline(always)]
            fn of<S: Simd>(&self, $a: Lanes<S>, $b: Lanes<S>) -> Lanes<S> {
                $value
            }
        }
    };
}

function!(Atan2, a, b, a.atan2(b));
function!(Ceil, a, _b, a.ceil());
function!(Round, a, _b, a.round());
function!(Max, a, b, a.max(b));
function!(Min, a, b, a.min(b));
function!(Abs, a, _b, a.abs());
function!(Negative, a, _b, -a);
function!(Root, a, _b, a.sqrt());
function!(WithSign, a, b, a.with_sign_of(b));
function!(ProductAndSum, a, b, a * b + a);
function!(Quotient, a, b, a / b - b);
function!(Less, a, b, a.less(b).select(a.all(1.0), a.all(0.0)));
function!(AtMost, a, b, a.at_most(b).select(a.all(1.0), a.all(0.0)));
function!(Equal, a, b, a.equal(b).select(a.all(1.0), a.all(0.0)));
function!(AnyLess, a, b, a.all(if a.less(b).any() { 1.0 } else { 0.0 }));
function!(FirstLess, a, b, a.all((Lanes::<S>::COUNT - a.less(b).first()) as f64));
function!(Between, a, b, {
    let (low, high) = (a.all(-1.0).less(a), a.less(b));
    ((low & high) | high.and_not(low) | Mask::splat(a.simd, false)).select(a.map(|x| x * 2.0), b)
});

/// Bound on the error of the arctangent, relative.
const ATAN_ERROR: f64 = 4.5e-16;

fn assert_arctangent(y: f64, x: f64) {
    let (found, expected) = (in_lanes(Atan2, y, x), libm::atan2(y, x));
    assert!((found - expected).abs() <= ATAN_ERROR * expected.abs(), "{y:e} {x:e}: {found:e} {expected:e}");
}

/// That every operation gives, to the last bit, what a kind of numbers gives by itself.
macro_rules! operations {
    ($number:ident, $a:ident, $b:ident) => {
        let (a, b) = ($a, $b);
        prop_assert_eq!(in_lanes(Ceil, a, b), a.ceil());
        prop_assert!((in_lanes(Round, a, b) - a).abs() <= 0.5);
        prop_assert_eq!(in_lanes(Max, a, b), a.max(b));
        prop_assert_eq!(in_lanes(Min, a, b), a.min(b));
        prop_assert_eq!(in_lanes(Abs, a, b), a.abs());
        prop_assert_eq!(in_lanes(Negative, a, b), -a);
        prop_assert_eq!(in_lanes(Root, a.abs(), b), a.abs().sqrt());
        prop_assert_eq!(in_lanes(WithSign, a, b), a.copysign(b));
        prop_assert_eq!(in_lanes(ProductAndSum, a, b), a * b + a);
        prop_assert_eq!(in_lanes(Quotient, a, b), a / b - b);
        let of = |yes: bool| if yes { 1.0 } else { 0.0 };
        for (a, b) in
            [(a, b), (a, a), (a, $number::NAN), ($number::NAN, b), ($number::INFINITY, a), (-$number::INFINITY, a)]
        {
            prop_assert_eq!(in_lanes(Less, a, b), of(a < b));
            prop_assert_eq!(in_lanes(AtMost, a, b), of(a <= b));
            prop_assert_eq!(in_lanes(Equal, a, b), of(a == b));
            // The other lanes say no.
            prop_assert_eq!(in_lanes(AnyLess, a, b), of(a < b));
            prop_assert_eq!(in_lanes(FirstLess, a, b), of(a < b));
        }
        prop_assert_eq!(in_lanes(Between, a, b), if a < b { 2.0 * a } else { b });
    };
}

proptest! {
    #[test]
    fn arctangent_agrees_with_libm(angle in -PI..PI, scale in -12.0..12.0_f64) {
        let r = libm::exp(scale);
        assert_arctangent(r * libm::sin(angle), r * libm::cos(angle));
    }

    #[test]
    fn every_operation_is_that_of_a_number(a in -1e6..1e6_f64, b in -1e6..1e6_f64) {
        operations!(f64, a, b);
    }

    #[test]
    fn every_operation_is_that_of_a_number_in_single_precision(a in -1e6..1e6_f32, b in -1e6..1e6_f32) {
        operations!(f32, a, b);
        let (found, expected) = (in_lanes(Atan2, a, b).get(), libm::atan2(a.get(), b.get()));
        prop_assert!((found - expected).abs() <= 3e-7 * expected.abs(), "{} {}", found, expected);
    }
}

#[test]
fn arctangent_at_its_edges() {
    // Where one of its branches gives way to the next, and one step of rounding to either side.
    let eighth = libm::tan(PI / 8.0);
    let mut angles = vec![0.0, FRAC_PI_4, FRAC_PI_2, PI - FRAC_PI_4, PI, PI / 8.0, 3.0 * PI / 8.0];
    angles.extend((0..64).map(|k| f64::from(k) * PI / 64.0));
    for angle in angles {
        for angle in [angle, angle.next_up(), angle.next_down()] {
            for r in [1.0, 1e-150, 1e150] {
                let (s, c) = libm::sincos(angle);
                assert_arctangent(r * s, r * c);
                assert_arctangent(-r * s, r * c);
            }
        }
    }
    for q in [eighth, 1.0] {
        for q in [q, q.next_up(), q.next_down()] {
            [(q, 1.0), (1.0, q), (-q, 1.0), (q, -1.0), (-1.0, -q)]
                .into_iter()
                .for_each(|(y, x)| assert_arctangent(y, x));
        }
    }
    let tiny = [1e-300, 1e-160, 1e-20, 5e-9, 1e-300 * 1.7];
    for small in tiny {
        [(small, 1.0), (1.0, small), (small, -1.0), (-small, small)]
            .into_iter()
            .for_each(|(y, x)| assert_arctangent(y, x));
    }
    for (y, x) in [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0), (1.0, 1.0), (-1.0, -1.0), (-0.0, -1.0)] {
        assert_arctangent(y, x);
    }
    assert_eq!(in_lanes(Atan2, 0.0, 0.0), 0.0);
    // What comes out NaN must never pass a comparison.
    assert!(in_lanes(Atan2, f64::NAN, 1.0).is_nan());
    assert!(in_lanes(Root, -1.0_f64, 0.0).is_nan());
}

#[test]
fn nothing_is_fused() {
    // Rounded twice, a product and a sum give zero here; fused they would give what the product lost.
    let a = 1.0 + f64::EPSILON;
    let square = a * a;
    assert!(libm::fma(a, a, -square) != 0.0);
    assert_eq!(in_lanes(SquareLess, a, square), 0.0);
}

function!(SquareLess, a, b, a * a - b);
