//! The local frame of a set of points: about their mean, scaled to unit size, and the checks that a circle needs.

use super::chart::{Centre, Chart, Far, Middle, Point};
use super::{Circle, CircleError, Fit, Radius};

/// Largest coordinate, and smallest extent, whose powers up to the fourth can be computed with.
const MAX_COORDINATE: f64 = 1e60;
const MIN_ALLOWANCE: f64 = 1e-60;
/// Part of the largest coordinate within which points count as equal, and as on one line.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Where points are and how far they reach.
pub(super) struct Spread {
    /// Their mean.
    origin: Point,
    /// The largest distance from there.
    extent: f64,
    /// The farthest point as seen from there.
    direction: Point,
    /// Distance within which points count as equal.
    allowance: f64,
}

impl Spread {
    /// Shows each point as seen from the mean to `visit`.
    ///
    /// # Errors
    /// [`CircleError::NotFinite`], and [`CircleError::TooFew`] when all points are the same.
    pub fn new(points: &[Point], mut visit: impl FnMut(Point)) -> Result<Self, CircleError> {
        let origin = mean(points)?;
        let (mut squared, mut direction, mut largest) = (0.0, [0.0; 2], 0.0_f64);
        for p in points {
            let q = [p[0] - origin[0], p[1] - origin[1]];
            largest = largest.max(p[0].abs()).max(p[1].abs());
            let length = q[0] * q[0] + q[1] * q[1];
            if length > squared {
                (squared, direction) = (length, q);
            }
            visit(q);
        }
        let spread = Self { origin, extent: squared.sqrt(), direction, allowance: ROUNDING * largest + MIN_ALLOWANCE };
        if spread.extent > spread.allowance { Ok(spread) } else { Err(CircleError::TooFew(1)) }
    }

    /// Whether there are three different points at least, and not all on one line.
    ///
    /// # Errors
    /// [`CircleError::TooFew`] and [`CircleError::Collinear`].
    pub fn check(&self, points: &[Point]) -> Result<(), CircleError> {
        let ([x, y], [dx, dy]) = (self.origin, self.direction);
        let aside = |p: &Point| ((p[0] - x) * dy - (p[1] - y) * dx) / self.extent;
        if points.iter().any(|p| aside(p).abs() > self.allowance) {
            return Ok(());
        }
        let apart = |p: &Point, q: &Point| (p[0] - q[0]).abs().max((p[1] - q[1]).abs()) > self.allowance;
        let first = points[0];
        let second = points.iter().find(|p| apart(p, &first)).unwrap_or(&first);
        match points.iter().any(|p| apart(p, &first) && apart(p, second)) {
            true => Err(CircleError::Collinear),
            false => Err(CircleError::TooFew(2)),
        }
    }
}

/// A mean of the points; it need not be exact, only near their middle.
fn mean(points: &[Point]) -> Result<Point, CircleError> {
    let first = *points.first().ok_or(CircleError::TooFew(0))?;
    let (mut sum, mut is_good) = ([0.0; 2], true);
    for p in points {
        is_good &= p[0].abs() <= MAX_COORDINATE && p[1].abs() <= MAX_COORDINATE;
        sum = [sum[0] + (p[0] - first[0]), sum[1] + (p[1] - first[1])];
    }
    if !is_good {
        let is_bad = |p: &Point| !(p[0].abs() <= MAX_COORDINATE && p[1].abs() <= MAX_COORDINATE);
        return Err(CircleError::NotFinite(points.iter().position(is_bad).unwrap_or(0)));
    }
    let count = points.len() as f64;
    Ok([first[0] + sum[0] / count, first[1] + sum[1] / count])
}

/// A frame about the mean of the points with the largest distance from it in (1/2, 1].
pub(super) struct Frame {
    /// Its origin in the frame of the points.
    pub origin: Point,
    /// Local unit in the unit of the points: a power of two, so that scaling rounds nothing.
    pub unit: f64,
}

impl Frame {
    /// The frame of checked points.
    ///
    /// # Errors
    /// [`CircleError`] but [`CircleError::Straight`].
    pub fn new(points: &[Point]) -> Result<Self, CircleError> {
        let spread = Spread::new(points, |_| ())?;
        spread.check(points)?;
        Ok(Self::of(&spread))
    }

    /// The frame of points whose spread is known.
    pub fn of(spread: &Spread) -> Self {
        // The next power of two above.
        let unit = f64::from_bits((spread.extent.to_bits() & !((1 << 52) - 1)) + (1 << 52));
        Self { origin: spread.origin, unit }
    }

    /// A point of the frame of the points in this one.
    #[inline(always)]
    pub fn localised(&self, p: Point) -> Point {
        // The inverse of a power of two is exact.
        let factor = 1.0 / self.unit;
        [(p[0] - self.origin[0]) * factor, (p[1] - self.origin[1]) * factor]
    }

    /// All points in this frame.
    pub fn localise(&self, points: &[Point]) -> Vec<Point> {
        points.iter().map(|p| self.localised(*p)).collect()
    }

    /// The reference circle about a centre in this frame, for points in theirs.
    pub fn fit(&self, middle: Middle, points: &[Point], radius: Radius) -> Fit {
        let Reaches { min, max, mean } = match middle {
            Middle::Near(coordinates) => self.reaches::<Centre>(coordinates, points),
            Middle::Far(coordinates) => self.reaches::<Far>(coordinates, points),
        };
        let (constant, sign) = middle.distance_from_reach();
        let (low, high) = if sign > 0.0 { (min, max) } else { (-max, -min) };
        let distance = |reach: f64| (constant + reach) * self.unit;
        let radius = match radius {
            Radius::Smallest => low,
            Radius::Middle => 0.5 * (low + high),
            Radius::Largest => high,
            Radius::Mean => sign * mean,
        };
        let [x, y] = middle.place();
        let center = [self.origin[0] + self.unit * x, self.origin[1] + self.unit * y];
        Fit {
            circle: Circle { center, radius: distance(radius) },
            circularity: (high - low) * self.unit,
            smallest: distance(low),
            largest: distance(high),
        }
    }

    fn reaches<C: Chart>(&self, coordinates: Point, points: &[Point]) -> Reaches {
        let at = C::at(coordinates);
        let first = C::reach(C::key(&at, &self.localised(points[0])));
        let (mut min, mut max, mut excess) = (first, first, 0.0);
        for p in points {
            let reach = C::reach(C::key(&at, &self.localised(*p)));
            (min, max) = (min.min(reach), max.max(reach));
            excess += reach - first;
        }
        Reaches { min, max, mean: first + excess / points.len() as f64 }
    }
}

/// Reaches of points from a centre.
struct Reaches {
    min: f64,
    max: f64,
    mean: f64,
}
