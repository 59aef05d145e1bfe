//! The plane in which points in space are measured.

use super::CircleError;
use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

/// Part of the largest coordinate within which points count as equal, and as on one line.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Largest coordinate whose square can be computed with.
const MAX_COORDINATE: f64 = 1e60;
/// Largest cosine of the angle between normal and x axis for which x of the plane is the projection of x.
const NEARLY_NORMAL: f64 = 0.9;

/// A plane with a frame in it. Lengths are in the unit of the points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FittedPlane {
    /// The mean of the points, origin of the plane's frame.
    pub center: Vector3<f64>,
    /// Unit normal, its largest component positive: z of the plane's frame.
    pub normal: Vector3<f64>,
    /// x axis of the plane's frame: the x axis of the points' frame projected onto the plane, or their y axis where x
    /// is within some 26 deg of the normal.
    pub x_axis: Vector3<f64>,
    /// y axis of the plane's frame, `normal x x_axis`.
    pub y_axis: Vector3<f64>,
}

impl FittedPlane {
    /// The plane with the smallest sum of squared distances from the points (total least squares).
    ///
    /// # Errors
    /// [`CircleError`] but [`CircleError::Straight`].
    pub fn fit(points: &[[f64; 3]]) -> Result<Self, CircleError> {
        let vectors = || points.iter().map(|p| Vector3::from(*p));
        if let Some(point) = points.iter().position(|p| p.iter().any(|c| !c.is_finite() || c.abs() > MAX_COORDINATE)) {
            return Err(CircleError::NotFinite(point));
        }
        let first = vectors().next().ok_or(CircleError::TooFew(0))?;
        let sum = vectors().fold(Vector3::zeros(), |sum, p| sum + (p - first));
        let center = first + sum / points.len() as f64;
        let scatter = vectors().fold(Matrix3::zeros(), |sum, p| sum + (p - center) * (p - center).transpose());
        let eigen = scatter.symmetric_eigen();
        let axis = |index: usize| eigen.eigenvectors.column(index).into_owned();
        let long = axis(eigen.eigenvalues.imax());
        let allowance = ROUNDING * vectors().fold(0.0_f64, |max, p| max.max(p.amax()));
        if vectors().all(|p| (p - center - long * long.dot(&(p - center))).norm() <= allowance) {
            return Err(on_a_line(points, allowance));
        }
        let normal = axis(eigen.eigenvalues.imin());
        Ok(Self::with(center, normal * normal[normal.iamax()].signum()))
    }

    fn with(center: Vector3<f64>, normal: Vector3<f64>) -> Self {
        let along = if normal.x.abs() > NEARLY_NORMAL { Vector3::y() } else { Vector3::x() };
        let x_axis = (along - normal * normal.dot(&along)).normalize();
        Self { center, normal, x_axis, y_axis: normal.cross(&x_axis) }
    }

    /// A point in the plane's frame: x, y and the height above the plane.
    pub fn coordinates(&self, point: [f64; 3]) -> [f64; 3] {
        let offset = Vector3::from(point) - self.center;
        [offset.dot(&self.x_axis), offset.dot(&self.y_axis), offset.dot(&self.normal)]
    }

    /// The place of a point of the plane in the frame of the points.
    pub fn place(&self, point: [f64; 2]) -> [f64; 3] {
        (self.center + self.x_axis * point[0] + self.y_axis * point[1]).into()
    }
}

/// What is wrong with points on one line.
fn on_a_line(points: &[[f64; 3]], allowance: f64) -> CircleError {
    let apart = |p: &[f64; 3], q: &[f64; 3]| (0..3).any(|k| (p[k] - q[k]).abs() > allowance);
    let first = points[0];
    let Some(second) = points.iter().find(|p| apart(p, &first)) else { return CircleError::TooFew(1) };
    match points.iter().any(|p| apart(p, &first) && apart(p, second)) {
        true => CircleError::Collinear,
        false => CircleError::TooFew(2),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn points_of_a_plane_lie_in_it_and_come_back(
            normal in prop::array::uniform3(-1.0..1.0_f64), center in prop::array::uniform3(-1e3..1e3_f64),
            places in prop::collection::vec(prop::array::uniform2(-50.0..50.0_f64), 4..40)
        ) {
            let normal = Vector3::from(normal);
            prop_assume!(normal.norm() > 0.1);
            let made = FittedPlane::with(center.into(), normal.normalize());
            let points: Vec<[f64; 3]> = places.iter().map(|p| made.place(*p)).collect();
            if let Ok(plane) = FittedPlane::fit(&points) {
                // Four points may be nearly on a line, which leaves the plane free to turn about it.
                prop_assert!(points.iter().all(|p| plane.coordinates(*p)[2].abs() < 1e-10));
                for p in &points {
                    let [x, y, _] = plane.coordinates(*p);
                    let back = Vector3::from(plane.place([x, y])) - Vector3::from(*p);
                    prop_assert!(back.norm() < 1e-10);
                }
                prop_assert!((plane.x_axis.cross(&plane.y_axis) - plane.normal).norm() < 1e-14);
                prop_assert!(plane.normal[plane.normal.iamax()] > 0.0);
            }
        }
    }

    #[test]
    fn level_points_keep_their_axes_and_lines_are_refused() {
        let plane = FittedPlane::fit(&[[1.0, 0.0, 5.0], [0.0, 1.0, 5.0], [-1.0, 0.0, 5.0], [0.0, -1.0, 5.0]]).unwrap();
        assert_eq!((plane.center, plane.normal), (Vector3::new(0.0, 0.0, 5.0), Vector3::z()));
        assert_eq!((plane.x_axis, plane.y_axis), (Vector3::x(), Vector3::y()));
        let upright = FittedPlane::fit(&[[5.0, 1.0, 0.0], [5.0, 0.0, 1.0], [5.0, -1.0, 0.0]]).unwrap();
        assert!((upright.x_axis - Vector3::y()).norm() < 1e-15);
        let line: Vec<[f64; 3]> = (0..9).map(|k| [1e4 + 0.1 * f64::from(k), 0.3 * f64::from(k), 0.7]).collect();
        assert_eq!(FittedPlane::fit(&line), Err(CircleError::Collinear));
        assert_eq!(FittedPlane::fit(&[[1.0; 3]; 4]), Err(CircleError::TooFew(1)));
        assert_eq!(FittedPlane::fit(&[[1.0; 3], [2.0; 3], [1.0; 3]]), Err(CircleError::TooFew(2)));
        assert_eq!(FittedPlane::fit(&[[1.0; 3], [f64::NAN; 3]]), Err(CircleError::NotFinite(1)));
    }
}
