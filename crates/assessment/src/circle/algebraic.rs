//! A circle from moments alone, to begin with (Taubin 1991, by Newton's method after Chernov, *Circular and Linear
//! Regression*, 2010).

use super::chart::Point;

/// Moments of points about their mean, to the fourth order with z = x^2 + y^2; sums, not means.
#[derive(Default)]
pub(super) struct Moments {
    xx: f64,
    xy: f64,
    yy: f64,
    xz: f64,
    yz: f64,
    zz: f64,
}

/// Newton steps at most; the polynomial is convex on the way, so that they do not jump about.
const STEPS: usize = 20;

impl Moments {
    /// Adds a point.
    pub fn add(&mut self, point: Point) {
        let [x, y] = point;
        let z = x * x + y * y;
        self.xx += x * x;
        self.xy += x * y;
        self.yy += y * y;
        self.xz += x * z;
        self.yz += y * z;
        self.zz += z * z;
    }

    /// Whether the points are so wide across their longest direction that they are not nearly on a line.
    pub fn is_wide(&self) -> bool {
        let trace = self.xx + self.yy;
        self.xx * self.yy - self.xy * self.xy > 1e-8 * trace * trace
    }

    /// The centre of Taubin's circle as `x / w, y / w`, for so many points and coordinates divided by a unit.
    pub fn centre(&self, count: f64, unit: f64) -> (Point, f64) {
        let (second, third) = (1.0 / (count * unit * unit), 1.0 / (count * unit * unit * unit));
        let [xx, xy, yy] = [self.xx, self.xy, self.yy].map(|m| m * second);
        let [xz, yz] = [self.xz, self.yz].map(|m| m * third);
        let zz = self.zz * third / unit;
        let (z, spread) = (xx + yy, xx * yy - xy * xy);
        let cubic = 4.0 * z;
        let square = -3.0 * z * z - zz;
        let linear = zz * z + 4.0 * spread * z - xz * xz - yz * yz - z * z * z;
        let constant = xz * xz * yy + yz * yz * xx - zz * spread - 2.0 * xz * yz * xy + z * z * spread;
        let mut root = 0.0;
        let mut value = constant;
        for _ in 0..STEPS {
            let slope = linear + root * (2.0 * square + 3.0 * cubic * root);
            let next = root - value / slope;
            let at_next = constant + next * (linear + next * (square + next * cubic));
            if !next.is_finite() || at_next.abs() >= value.abs() {
                break;
            }
            (root, value) = (next, at_next);
        }
        let determinant = root * root - root * z + spread;
        ([xz * (yy - root) - yz * xy, yz * (xx - root) - xz * xy], 2.0 * determinant)
    }
}
