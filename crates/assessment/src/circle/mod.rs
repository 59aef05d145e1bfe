//! Roundness of points: the four reference circles of ISO 12181 and the circularity about each (Klimchik et al. 2017,
//! section 4).
//!
//! | circle | centre | [`Circle::radius`] |
//! |---|---|---|
//! | LSC, [`least_squares`] | smallest sum of squared distances to the circle (eq. 29) | mean distance of the points |
//! | MZC, [`minimum_zone`] | smallest circularity | mean of the two radii of the zone |
//! | MIC, [`maximum_inscribed`] | of the largest circle with no point in it, inside the convex hull | that circle's |
//! | MCC, [`minimum_circumscribed`] | of the smallest circle around all points | that circle's |
//!
//! The circularity is always the largest less the smallest distance of the points from the centre (eq. 28, 32); eq. 31
//! of the paper has a plus under its root. Points may be in any unit of length; results are in the same.
//!
//! The last three are global optima: what is found is within `1e-12` of the optimum, or within rounding, some `1e-15`
//! of the extent of the points, where that is more. [`least_squares`] says what it promises. All are computed relative
//! to the middle of the points, so that a place far from the origin costs no digits.
//!
//! ```
//! use stead_assessment::circle::{maximum_inscribed, minimum_circumscribed};
//! # fn main() -> Result<(), stead_assessment::circle::CircleError> {
//! let points = [[3.0, 0.0], [0.0, 2.0], [-3.0, 0.0], [0.0, -2.0]];
//! let (inscribed, circumscribed) = (maximum_inscribed(&points)?, minimum_circumscribed(&points)?);
//! assert!((circumscribed.circle.radius - 3.0).abs() < 1e-12);
//! assert!((circumscribed.circularity - 1.0).abs() < 1e-12);
//! assert!((inscribed.circle.radius - 13.0 / 6.0).abs() < 1e-12, "as far from (3, 0) as from (0, 2) and (0, -2)");
//! # Ok(())
//! # }
//! ```

mod algebraic;
mod chart;
mod frame;
mod hull;
mod lsc;
mod mcc;
mod mic;
mod mzc;
pub mod plane;
mod polygon;
mod search;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;

pub use lsc::least_squares;

use chart::Middle;
use frame::Frame;
use hull::Hull;
use serde::Serialize;

/// A circle in the plane.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Circle {
    /// Centre, in the frame and unit of the points.
    pub center: [f64; 2],
    /// Radius, in the unit of the points.
    pub radius: f64,
}

/// A reference circle and how far the points depart from it. Lengths are in the unit of the points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Fit {
    /// The reference circle.
    pub circle: Circle,
    /// Largest less smallest distance of the points from the centre (eq. 28), with more digits than the difference of
    /// the two below.
    pub circularity: f64,
    /// Smallest distance of a point from the centre (eq. 32).
    pub smallest: f64,
    /// Largest distance of a point from the centre (eq. 32).
    pub largest: f64,
}

/// All four reference circles of the same points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Circles {
    /// Least-squares circle.
    pub lsc: Fit,
    /// Minimum zone circles.
    pub mzc: Fit,
    /// Maximum inscribed circle.
    pub mic: Fit,
    /// Minimum circumscribed circle.
    pub mcc: Fit,
}

/// Why points have no reference circle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum CircleError {
    /// A coordinate of the point of this index is not a number, infinite, or beyond `1e60`.
    #[error("point {0} has a coordinate that is no finite number")]
    NotFinite(usize),
    /// Only so many different points, fewer than three. Differences of a few units in the last place of the coordinates
    /// do not count.
    #[error("a circle needs at least three different points")]
    TooFew(usize),
    /// All points lie on one straight line, but for the rounding of their coordinates.
    #[error("all points lie on one straight line")]
    Collinear,
    /// The best circle has a radius beyond all bounds: a straight line (LSC) or two parallel ones (MZC) fit no worse
    /// than any circle.
    #[error("a straight line fits these points as well as any circle")]
    Straight,
}

/// The minimum zone circles: the centre about which the circularity is smallest, over all the plane.
///
/// The search is global: the plane is cut into cells, and none is given up before a bound shows that there is nothing
/// better in it. Points on a short arc may have their centre far away.
///
/// # Errors
/// [`CircleError`]; [`CircleError::Straight`] where two parallel lines enclose the points at least as closely as any
/// two concentric circles.
pub fn minimum_zone(points: &[[f64; 2]]) -> Result<Fit, CircleError> {
    let frame = Frame::new(points)?;
    let local = frame.localise(points);
    Ok(frame.fit(mzc::minimum_zone(&local, &Hull::new(&local), &[])?, points, Radius::Middle))
}

/// The maximum inscribed circle: of all circles that hold no point inside and have their centre in the convex hull of
/// the points, the largest. About a measured round that is the largest disc that fits into the profile.
///
/// # Errors
/// [`CircleError`], never [`CircleError::Straight`].
pub fn maximum_inscribed(points: &[[f64; 2]]) -> Result<Fit, CircleError> {
    let frame = Frame::new(points)?;
    let local = frame.localise(points);
    let start = mcc::minimum_circumscribed(&local);
    let centre = mic::maximum_inscribed(&local, &Hull::new(&local), &[start]);
    Ok(frame.fit(Middle::Near(centre), points, Radius::Smallest))
}

/// The minimum circumscribed circle: the smallest that holds all points.
///
/// # Errors
/// [`CircleError`], never [`CircleError::Straight`].
pub fn minimum_circumscribed(points: &[[f64; 2]]) -> Result<Fit, CircleError> {
    let frame = Frame::new(points)?;
    let local = frame.localise(points);
    Ok(frame.fit(Middle::Near(mcc::minimum_circumscribed(&local)), points, Radius::Largest))
}

impl Circles {
    /// All four circles of the same points, faster than one by one.
    ///
    /// # Errors
    /// [`CircleError`] where any of the four has one.
    pub fn new(points: &[[f64; 2]]) -> Result<Self, CircleError> {
        let lsc = least_squares(points)?;
        let frame = Frame::new(points)?;
        let local = frame.localise(points);
        let hull = Hull::new(&local);
        let mcc = mcc::minimum_circumscribed(&hull.vertices);
        let starts = [frame.localised(lsc.circle.center), mcc];
        let (zone, inscribed) = rayon::join(
            || mzc::minimum_zone(&local, &hull, &starts),
            || mic::maximum_inscribed(&local, &hull, &starts),
        );
        Ok(Self {
            lsc,
            mzc: frame.fit(zone?, points, Radius::Middle),
            mic: frame.fit(Middle::Near(inscribed), points, Radius::Smallest),
            mcc: frame.fit(Middle::Near(mcc), points, Radius::Largest),
        })
    }
}

/// Which distances from the centre make the radius of a reference circle.
#[derive(Clone, Copy)]
enum Radius {
    Smallest,
    Middle,
    Largest,
    Mean,
}
