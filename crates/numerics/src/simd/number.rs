//! What lanes are made of: `f64`, or `f32` in twice as many for what is only compared.

use pulp::bytemuck::NoUninit;
use std::fmt::Debug;

/// A number of `f64` or `f32`.
pub trait LaneNumber: Copy + PartialOrd + Debug + Send + Sync + 'static {
    /// Vectors of such numbers, with the instructions of `pulp`.
    type Vectors<P: pulp::Simd>: Simd<Number = Self>;

    /// The step from 1 to the next number.
    const EPSILON: f64;

    /// Rounding error of the distance between two unit vectors in these numbers; zero where it is negligible.
    const ROUNDING: f64;

    /// Added to a number of small magnitude this leaves a whole number in the last bits.
    const SHIFT: f64;

    /// The nearest to a number.
    fn of(value: f64) -> Self;

    /// Its value.
    fn get(self) -> f64;

    /// The last 16 bits.
    fn low_bits(self) -> i16;

    /// A row of such numbers.
    fn row(rows: &LaneRows) -> &[Self];

    /// Vectors by these instructions.
    fn vectors<P: pulp::Simd>(simd: P) -> Self::Vectors<P>;
}

/// A row in both kinds of numbers.
#[derive(Debug, Clone)]
pub struct LaneRows {
    double: Vec<f64>,
    single: Vec<f32>,
}

impl LaneRows {
    /// From its numbers.
    pub fn new(values: impl IntoIterator<Item = f64>) -> Self {
        let double: Vec<f64> = values.into_iter().collect();
        let single = double.iter().map(|value| f32::of(*value)).collect();
        Self { double, single }
    }
}

/// The operations of vectors, lane by lane, by one kind of instructions.
pub trait Simd: Copy {
    /// A lane.
    type Number: LaneNumber;
    /// A vector.
    type Values: Copy + Debug;
    /// A yes or no for each lane.
    type Answers: Copy + Debug + NoUninit;

    /// Number of lanes.
    const COUNT: usize;

    /// The same number in every lane.
    fn splat(self, value: Self::Number) -> Self::Values;
    /// From as many numbers as there are lanes.
    fn from_slice(values: &[Self::Number]) -> Self::Values;
    /// To as many numbers as there are lanes.
    fn to_slice(vector: Self::Values, values: &mut [Self::Number]);
    /// Sum.
    fn add(self, a: Self::Values, b: Self::Values) -> Self::Values;
    /// Difference.
    fn sub(self, a: Self::Values, b: Self::Values) -> Self::Values;
    /// Product.
    fn mul(self, a: Self::Values, b: Self::Values) -> Self::Values;
    /// Quotient.
    fn div(self, a: Self::Values, b: Self::Values) -> Self::Values;
    /// The negative.
    fn neg(self, a: Self::Values) -> Self::Values;
    /// Magnitude.
    fn abs(self, a: Self::Values) -> Self::Values;
    /// Square root.
    fn sqrt(self, a: Self::Values) -> Self::Values;
    /// The magnitude of one with the sign of the other.
    fn with_sign_of(self, a: Self::Values, sign: Self::Values) -> Self::Values;
    /// Where the first is below the second.
    fn less(self, a: Self::Values, b: Self::Values) -> Self::Answers;
    /// Where the first is not above the second.
    fn at_most(self, a: Self::Values, b: Self::Values) -> Self::Answers;
    /// Where both are equal.
    fn equal(self, a: Self::Values, b: Self::Values) -> Self::Answers;
    /// One where yes, else the other.
    fn select(self, which: Self::Answers, yes: Self::Values, no: Self::Values) -> Self::Values;
    /// Yes in both.
    fn and(self, a: Self::Answers, b: Self::Answers) -> Self::Answers;
    /// Yes in one of them.
    fn or(self, a: Self::Answers, b: Self::Answers) -> Self::Answers;
    /// Yes where it says no.
    fn not(self, a: Self::Answers) -> Self::Answers;
}

/// Vectors of one kind of numbers, by the names that `pulp` has for their operations.
macro_rules! vectors {
    ($(#[$doc:meta])* $name:ident of $number:ident, $whole:ident, $lanes:ident, $rounding:expr, $shift:expr,
     $values:ident, $answers:ident, $splat:ident, $as_simd:ident, $as_mut_simd:ident,
     $add:ident, $sub:ident, $mul:ident, $div:ident, $neg:ident, $abs:ident, $sqrt:ident,
     $and_values:ident, $or_values:ident, $not_values:ident,
     $less:ident, $at_most:ident, $equal:ident, $select:ident, $and:ident, $or:ident, $not:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy)]
        pub struct $name<P>(P);

        impl<P: pulp::Simd> Simd for $name<P> {
            type Number = $number;
            type Values = P::$values;
            type Answers = P::$answers;

            const COUNT: usize = P::$lanes;

            #[inline(always)]
            fn splat(self, value: $number) -> P::$values {
                self.0.$splat(value)
            }
            #[inline(always)]
            fn from_slice(values: &[$number]) -> P::$values {
                P::$as_simd(values).0[0]
            }
            #[inline(always)]
            fn to_slice(vector: P::$values, values: &mut [$number]) {
                P::$as_mut_simd(values).0[0] = vector;
            }
            #[inline(always)]
            fn add(self, a: P::$values, b: P::$values) -> P::$values {
                self.0.$add(a, b)
            }
            #[inline(always)]
            fn sub(self, a: P::$values, b: P::$values) -> P::$values {
                self.0.$sub(a, b)
            }
            #[inline(always)]
            fn mul(self, a: P::$values, b: P::$values) -> P::$values {
                self.0.$mul(a, b)
            }
            #[inline(always)]
            fn div(self, a: P::$values, b: P::$values) -> P::$values {
                self.0.$div(a, b)
            }
            #[inline(always)]
            fn neg(self, a: P::$values) -> P::$values {
                self.0.$neg(a)
            }
            #[inline(always)]
            fn abs(self, a: P::$values) -> P::$values {
                self.0.$abs(a)
            }
            #[inline(always)]
            fn sqrt(self, a: P::$values) -> P::$values {
                self.0.$sqrt(a)
            }
            #[inline(always)]
            fn with_sign_of(self, a: P::$values, sign: P::$values) -> P::$values {
                let simd = self.0;
                let bit = simd.$splat(-0.0);
                let magnitude = simd.$and_values(a, simd.$not_values(bit));
                simd.$or_values(magnitude, simd.$and_values(sign, bit))
            }
            #[inline(always)]
            fn less(self, a: P::$values, b: P::$values) -> P::$answers {
                self.0.$less(a, b)
            }
            #[inline(always)]
            fn at_most(self, a: P::$values, b: P::$values) -> P::$answers {
                self.0.$at_most(a, b)
            }
            #[inline(always)]
            fn equal(self, a: P::$values, b: P::$values) -> P::$answers {
                self.0.$equal(a, b)
            }
            #[inline(always)]
            fn select(self, which: P::$answers, yes: P::$values, no: P::$values) -> P::$values {
                self.0.$select(which, yes, no)
            }
            #[inline(always)]
            fn and(self, a: P::$answers, b: P::$answers) -> P::$answers {
                self.0.$and(a, b)
            }
            #[inline(always)]
            fn or(self, a: P::$answers, b: P::$answers) -> P::$answers {
                self.0.$or(a, b)
            }
            #[inline(always)]
            fn not(self, a: P::$answers) -> P::$answers {
                self.0.$not(a)
            }
        }

        impl LaneNumber for $number {
            type Vectors<P: pulp::Simd> = $name<P>;

            const EPSILON: f64 = $number::EPSILON as f64;
            const ROUNDING: f64 = $rounding;
            const SHIFT: f64 = $shift;

            #[inline(always)]
            fn of(value: f64) -> Self {
                value as Self
            }
            #[inline(always)]
            fn get(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn low_bits(self) -> i16 {
                self.to_bits() as i16
            }
            fn row(rows: &LaneRows) -> &[Self] {
                &rows.$whole
            }
            #[inline(always)]
            fn vectors<P: pulp::Simd>(simd: P) -> $name<P> {
                $name(simd)
            }
        }
    };
}

vectors!(
    /// Vectors of `f64`.
    Double of f64, double, F64_LANES, 0.0, 6_755_399_441_055_744.0,
    f64s, m64s, splat_f64s, as_simd_f64s, as_mut_simd_f64s,
    add_f64s, sub_f64s, mul_f64s, div_f64s, neg_f64s, abs_f64s, sqrt_f64s,
    and_f64s, or_f64s, not_f64s,
    less_than_f64s, less_than_or_equal_f64s, equal_f64s, select_f64s, and_m64s, or_m64s, not_m64s
);

vectors!(
    /// Vectors of `f32`.
    Single of f32, single, F32_LANES, 4e-7, 12_582_912.0,
    f32s, m32s, splat_f32s, as_simd_f32s, as_mut_simd_f32s,
    add_f32s, sub_f32s, mul_f32s, div_f32s, neg_f32s, abs_f32s, sqrt_f32s,
    and_f32s, or_f32s, not_f32s,
    less_than_f32s, less_than_or_equal_f32s, equal_f32s, select_f32s, and_m32s, or_m32s, not_m32s
);
