//! The zero-order solution: mean coefficients in place of those that change over the turn.

use super::directional::{exit, mean};
use super::plant::Plant;
use nalgebra::{Complex, Matrix2x3, Matrix3x2};
use std::f64::consts::TAU;
use stead_model::cutting::{Cutter, EngagementError, PassCut};

/// The frequency response of a tool tip, from which the zero-order solution is read at any spindle speed.
///
/// With `F = b K q(omega) u`, K the mean coefficients of all teeth and `q = mean_j (1 - e^(-i omega tau_j))`, motion of
/// a frequency omega keeps its size where `b q(omega) lambda(omega) = 1` for an eigenvalue lambda of `K G(i omega)`
/// (Altintas and Budak 1995, here for a given speed, which allows for unequal pitch).
#[derive(Debug, Clone, PartialEq)]
pub struct ZeroOrder {
    responses: Vec<(f64, Matrix2x3<Complex<f64>>)>,
}

/// Frequencies in the half width of a resonance.
const IN_RESONANCE: f64 = 8.0;
/// Half widths of a resonance in which frequencies are dense.
const AROUND: f64 = 12.0;
/// Frequencies in equal steps.
const EVENLY: usize = 2000;
/// Delays are followed in such steps of their phase. rad
const STEP: f64 = 0.1;
/// Frequencies go so far beyond the fastest mode,
const BEYOND: f64 = 2.0;
/// and no farther than this: what moves faster does not swing with the teeth of a cutter. rad/s
const FASTEST: f64 = 1e6;
/// Steps in which the delays are followed over all frequencies, at most.
const MAX_STEPS: f64 = 2e7;

/// Why there is no zero-order solution.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ZeroOrderError {
    /// The cut has no width.
    #[error("{0}")]
    Engagement(#[from] EngagementError),
    /// The delays between teeth hold too many periods of the fastest modes.
    #[error(
        "a spindle of {rpm:.3} rpm is too slow for the zero-order solution of an arm with modes up to {fastest_hz:.3e} Hz: each tooth \
         follows the one before after too many of their periods"
    )]
    TooSlow {
        /// Spindle speed. 1/min
        rpm: f64,
        /// Frequency up to which modes are considered. Hz
        fastest_hz: f64,
    },
}

impl ZeroOrder {
    /// Looks at the plant at evenly spread frequencies and densely around its resonances.
    pub fn new(plant: &Plant) -> Self {
        let poles = plant.poles();
        let swinging = poles.iter().filter(|pole| pole.im > 0.0);
        let max_frequency = (BEYOND * poles.iter().map(|pole| pole.norm()).fold(1.0, f64::max)).min(FASTEST);
        let mut frequencies: Vec<f64> = (1..=EVENLY).map(|k| max_frequency * k as f64 / EVENLY as f64).collect();
        for pole in swinging {
            let step = (pole.re.abs() / IN_RESONANCE).max(1e-6 * pole.im);
            let count = (AROUND * IN_RESONANCE) as i32;
            frequencies.extend((-count..=count).map(|k| pole.im + step * f64::from(k)));
        }
        frequencies.retain(|omega| *omega > 0.0 && *omega <= FASTEST);
        frequencies.sort_by(f64::total_cmp);
        let responses = frequencies.into_iter().filter_map(|omega| Some((omega, plant.response(omega)?)));
        Self { responses: responses.collect() }
    }

    /// The smallest depth of cut at which some motion keeps its size; `None` if there is none up to `max_depth`. m
    ///
    /// # Errors
    /// [`ZeroOrderError`] for a width of cut that is none, and for a spindle so slow beside the modes of the arm that
    /// the delays cannot be followed.
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    pub fn critical_depth(
        &self,
        cutter: &Cutter,
        cut: &PassCut,
        max_depth: f64,
    ) -> Result<Option<f64>, ZeroOrderError> {
        let teeth = cutter.teeth();
        let coefficients = mean(cutter, cut, exit(cutter, cut)?).map(Complex::from);
        let delays: Vec<f64> = teeth.iter().map(|tooth| tooth.pitch / cut.spindle_speed).collect();
        let longest = delays.iter().copied().fold(0.0, f64::max);
        let fastest = self.responses.last().map_or(0.0, |(omega, _)| *omega);
        if fastest * longest / STEP > MAX_STEPS {
            let rpm = cut.spindle_speed / TAU * 60.0;
            return Err(ZeroOrderError::TooSlow { rpm, fastest_hz: fastest / TAU });
        }
        let mut best = max_depth;
        let mut last = None::<[Complex<f64>; 2]>;
        for pair in self.responses.windows(2) {
            let [(from, first), (to, second)] = pair else { continue };
            // Between two frequencies the delays may turn several times.
            let steps = ((to - from) * longest / STEP).ceil().max(1.0) as usize;
            for step in 0..steps {
                let share = step as f64 / steps as f64;
                let response = first + (second - first) * Complex::from(share);
                let found = gains(&coefficients, &delays, from + (to - from) * share, &response);
                let found = last.map_or(found, |last| matched(&last, found));
                for (before, after) in last.iter().flatten().zip(found) {
                    // Where the imaginary part passes zero.
                    if before.im * after.im <= 0.0 && before.im != after.im {
                        let real = before.re + before.im / (before.im - after.im) * (after.re - before.re);
                        best = if real * best > 1.0 { 1.0 / real } else { best };
                    }
                }
                last = Some(found);
            }
        }
        Ok((best < max_depth).then_some(best))
    }
}

/// The eigenvalues of what one metre of depth feeds back.
fn gains(
    coefficients: &Matrix3x2<Complex<f64>>,
    delays: &[f64],
    omega: f64,
    response: &Matrix2x3<Complex<f64>>,
) -> [Complex<f64>; 2] {
    let factor: Complex<f64> = delays
        .iter()
        .map(|delay| {
            let (sine, cosine) = libm::sincos(omega * delay);
            Complex::new(1.0 - cosine, sine)
        })
        .sum();
    let fed = response * coefficients * factor;
    let (half, determinant) = (fed.trace() / 2.0, fed.determinant());
    let root = square_root(half * half - determinant);
    [half + root, half - root]
}

fn square_root(z: Complex<f64>) -> Complex<f64> {
    let norm = z.norm_sqr().sqrt();
    let [real, imaginary] = [norm + z.re, norm - z.re].map(|twice| (twice.max(0.0) / 2.0).sqrt());
    Complex::new(real, imaginary.copysign(z.im))
}

/// The second pair in the order in which it goes on from the first.
fn matched(first: &[Complex<f64>; 2], second: [Complex<f64>; 2]) -> [Complex<f64>; 2] {
    let crossed = [second[1], second[0]];
    let off = |pair: [Complex<f64>; 2]| (pair[0] - first[0]).norm_sqr() + (pair[1] - first[1]).norm_sqr();
    if off(second) <= off(crossed) { second } else { crossed }
}
