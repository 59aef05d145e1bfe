//! Rays from the tool centre, several at once, and the part of them that lies in the block.

use stead_numerics::simd::{Lanes, Simd};

/// Rays in one bundle: the same for every processor, so that what is decided for a bundle does not depend on it.
pub const LANES: usize = 8;

/// Where in a bundle each of the processor's vectors starts.
#[inline(always)]
pub(crate) fn starts<S: Simd<Number = f64>>() -> impl Iterator<Item = usize> {
    (0..LANES).step_by(Lanes::<S>::COUNT)
}

/// The block that is milled, as it was before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stock {
    /// It reaches from x = 0 to here. m
    pub length: f64,
    /// It reaches up to this y; infinite for a slot. m
    pub top: f64,
}

/// Directions from the tool centre and what is known of the work along them. The angle psi of a ray is 0 towards the
/// wall and a quarter turn along the feed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rays {
    /// sin(psi)
    pub sine: [f64; LANES],
    /// cos(psi)
    pub cosine: [f64; LANES],
    /// Where the work may begin: what lies nearer is known to be cleared. m
    pub from: [f64; LANES],
    /// Where the work or the edge ends: nothing to cut unless it is above `from`. m
    pub to: [f64; LANES],
}

impl Rays {
    /// Rays that lag behind a first one, given by its sine and cosine.
    #[inline(always)]
    pub fn lagging<S: Simd<Number = f64>>(simd: S, first: [f64; 2], lags: &[[f64; LANES]; 2]) -> Self {
        let [sine, cosine] = first;
        let zero = [0.0; LANES];
        let mut rays = Self { sine: zero, cosine: zero, from: zero, to: zero };
        for start in starts::<S>() {
            let (lag_sine, lag_cosine) = (Lanes::load(simd, &lags[0], start), Lanes::load(simd, &lags[1], start));
            (lag_cosine * sine - lag_sine * cosine).store(&mut rays.sine, start);
            (lag_cosine * cosine + lag_sine * sine).store(&mut rays.cosine, start);
        }
        rays
    }

    /// Limits the rays to the block, from a centre to a radius (m). `ledge` is a height above which nothing is left
    /// behind the centre (m). Whether there is anything left to cut.
    #[inline(always)]
    pub fn enter<S: Simd<Number = f64>>(
        &mut self,
        simd: S,
        stock: &Stock,
        centre: [f64; 2],
        radius: f64,
        ledge: f64,
    ) -> bool {
        let ([x, y], zero) = (centre, Lanes::splat(simd, 0.0));
        let mut any = false;
        for start in starts::<S>() {
            let (sine, cosine) = (Lanes::load(simd, &self.sine, start), Lanes::load(simd, &self.cosine, start));
            let high = zero.all(ledge).less(cosine * -radius + y);
            let behind = sine.less(zero) & high;
            let mut span = [zero, behind.select(zero.all(-1.0), zero.all(radius))];
            limit(&mut span, stock.top - y, cosine, radius);
            if x < radius {
                limit(&mut span, x, sine, radius);
            }
            if x > stock.length - radius {
                limit(&mut span, stock.length - x, -sine, radius);
            }
            let [from, to] = span;
            any |= from.less(to).any();
            from.store(&mut self.from, start);
            to.store(&mut self.to, start);
        }
        any
    }
}

/// Leaves of spans (from and to) what has `inside + distance slope >= 0`.
#[inline(always)]
fn limit<S: Simd<Number = f64>>(span: &mut [Lanes<S>; 2], inside: f64, slope: Lanes<S>, radius: f64) {
    let zero = slope.all(0.0);
    let end = slope * radius + inside;
    if inside < 0.0 {
        let entry = zero.less(end).select(zero.all(-inside) / slope, zero.all(radius));
        span[0] = span[0].max(entry);
    } else if inside < radius {
        let exit = end.less(zero).select(zero.all(-inside) / slope, zero.all(radius));
        span[1] = span[1].min(exit);
    }
}
