//! Roundness of measured points: in the plane or in space, with sectors left out.

use super::circle::plane::FittedPlane;
use super::circle::{CircleError, Circles, Fit, least_squares};
use serde::Serialize;
use std::f64::consts::TAU;
use stead_numerics::digits::figures;
use stead_numerics::message::Warning;

/// Measured points in one unit of length.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub enum Measured {
    /// x and y.
    Planar(Vec<[f64; 2]>),
    /// x, y and z.
    Spatial(Vec<[f64; 3]>),
}

/// A sector of polar angles, both ends included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sector {
    /// Where it begins. rad
    pub start: f64,
    /// How far it goes from there, counter-clockwise. rad
    pub width: f64,
}

impl Sector {
    /// From one angle to another, counter-clockwise from the x axis and through zero where the second is smaller;
    /// `None` for angles that are not from -360 to 360 degrees.
    pub fn between_deg(from: f64, to: f64) -> Option<Self> {
        let is_allowed = |angle: f64| angle.abs() <= 360.0;
        let turns = if to < from { libm::ceil((from - to) / 360.0) } else { 0.0 };
        let sector = Self { start: from.to_radians(), width: (to - from + 360.0 * turns).to_radians() };
        (is_allowed(from) && is_allowed(to)).then_some(sector)
    }
}

/// A measured point as it was assessed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Assessed {
    /// Its place in the plane: x and y as measured, or in the frame of the fitted plane.
    pub place: [f64; 2],
    /// Height above the fitted plane; zero for points without z.
    pub height: f64,
    /// Polar angle about the least-squares centre of all points, in [0, 2 pi), by which sectors leave out points. rad
    pub angle: f64,
    /// Whether a sector leaves it out.
    pub is_excluded: bool,
}

/// What came out. Lengths are in the unit of the points.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Roundness {
    /// The plane fitted to the points not left out, where they have a z.
    pub plane: Option<FittedPlane>,
    /// All points, in their order.
    pub points: Vec<Assessed>,
    /// The reference circles of the points not left out.
    pub circles: Circles,
}

/// Why there is no result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RoundnessError {
    /// The points have no circle.
    #[error("{0}")]
    Points(CircleError),
    /// What the sectors leave has none.
    #[error("of the points that are left, {cause}")]
    Left {
        /// Points not left out.
        count: usize,
        /// What is wrong with them.
        cause: CircleError,
    },
}

/// The four circles of measured points without those in some sectors.
///
/// The angle of a point is that about the least-squares centre of all points, from the x axis of the points, or from
/// that of the plane fitted to all of them (see [`FittedPlane::x_axis`]) where they have a z. After that the plane is
/// fitted again, to the points that are left.
///
/// # Errors
/// [`RoundnessError`].
pub fn assess(measured: &Measured, sectors: &[Sector]) -> Result<Roundness, RoundnessError> {
    let all = vec![true; measured.len()];
    let (_, places) = measured.in_plane(&all).map_err(RoundnessError::Points)?;
    let flat: Vec<[f64; 2]> = places.iter().map(|[x, y, _]| [*x, *y]).collect();
    let center = least_squares(&flat).map_err(RoundnessError::Points)?.circle.center;
    let angles: Vec<f64> = flat.iter().map(|p| turn(libm::atan2(p[1] - center[1], p[0] - center[0]))).collect();
    let is_kept: Vec<bool> = angles.iter().map(|angle| !sectors.iter().any(|sector| sector.contains(*angle))).collect();
    let count = is_kept.iter().filter(|kept| **kept).count();
    let fail = |cause| match count == is_kept.len() {
        true => RoundnessError::Points(cause),
        false => RoundnessError::Left { count, cause },
    };
    let (plane, places) = measured.in_plane(&is_kept).map_err(fail)?;
    let points: Vec<Assessed> = (places.iter().zip(&angles).zip(&is_kept))
        .map(|(([x, y, height], angle), kept)| Assessed {
            place: [*x, *y],
            height: *height,
            angle: *angle,
            is_excluded: !kept,
        })
        .collect();
    let kept: Vec<[f64; 2]> = points.iter().filter(|p| !p.is_excluded).map(|p| p.place).collect();
    let circles = Circles::new(&kept).map_err(fail)?;
    Ok(Roundness { plane, points, circles })
}

impl Measured {
    /// How many points there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Planar(points) => points.len(),
            Self::Spatial(points) => points.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The plane of some of the points, and all of them in it.
    fn in_plane(&self, of: &[bool]) -> Result<(Option<FittedPlane>, Vec<[f64; 3]>), CircleError> {
        match self {
            Self::Planar(points) => Ok((None, points.iter().map(|[x, y]| [*x, *y, 0.0]).collect())),
            Self::Spatial(points) => {
                let some: Vec<[f64; 3]> = points.iter().zip(of).filter(|(_, of)| **of).map(|(p, _)| *p).collect();
                let plane = FittedPlane::fit(&some)?;
                Ok((Some(plane), points.iter().map(|p| plane.coordinates(*p)).collect()))
            }
        }
    }
}

impl Sector {
    /// Whether an angle is in the sector, whatever full turns it has. rad
    pub fn contains(&self, angle: f64) -> bool {
        turn(angle - self.start) <= self.width
    }
}

/// Points farther off their plane than this, in radii, are hardly one profile.
const MAX_FLATNESS: f64 = 0.1;

impl Roundness {
    /// Points that no sector leaves out.
    pub fn kept(&self) -> impl Iterator<Item = &Assessed> {
        self.points.iter().filter(|point| !point.is_excluded)
    }

    /// Peak to valley of the points not left out, across the plane; none for points without z.
    pub fn flatness(&self) -> Option<f64> {
        self.plane.map(|_| {
            let heights = self.kept().map(|point| point.height);
            let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), z| (l.min(z), h.max(z)));
            high - low
        })
    }

    /// What speaks against the points being those of one circular profile.
    pub fn warnings(&self) -> Vec<Warning> {
        let radius = self.circles.lsc.circle.radius;
        let flatness = self.flatness().filter(|flatness| *flatness > MAX_FLATNESS * radius);
        let message = |flatness| {
            let spread = figures(flatness);
            format!(
                "the points are spread over {spread} mm across their plane, more than a tenth of the radius: are they one profile?"
            )
        };
        flatness.map(|flatness| Warning::new("not-flat", message(flatness))).into_iter().collect()
    }

    /// The centre of a circle in the frame of the points, with z where they have one.
    pub fn center(&self, fit: &Fit) -> ([f64; 2], Option<f64>) {
        match &self.plane {
            None => (fit.circle.center, None),
            Some(plane) => {
                let [x, y, z] = plane.place(fit.circle.center);
                ([x, y], Some(z))
            }
        }
    }
}

/// The same angle in [0, 2 pi).
fn turn(angle: f64) -> f64 {
    let angle = angle - TAU * libm::floor(angle / TAU);
    if angle < TAU { angle } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(count: usize) -> Vec<[f64; 2]> {
        let place = |k: usize| libm::sincos((0.5 + k as f64) * TAU / count as f64);
        (0..count).map(place).map(|(sine, cosine)| [7.0 + 3.0 * cosine, -2.0 + 3.0 * sine]).collect()
    }

    fn degrees(from: f64, to: f64) -> Sector {
        Sector { start: from.to_radians(), width: (to - from).to_radians() }
    }

    #[test]
    fn sectors_wrap_and_leave_out_what_is_in_them() {
        let mut points = ring(36);
        // A burr of which the circles must know nothing; it hardly moves the centre of the angles.
        points[35] = [10.05, -2.25];
        let found = assess(&Measured::Planar(points), &[degrees(350.0, 370.0), degrees(90.0, 111.0)]).unwrap();
        let excluded: Vec<usize> = (0..36).filter(|k| found.points[*k].is_excluded).collect();
        assert_eq!(excluded, [0, 9, 10, 35]);
        assert!(found.circles.mzc.circularity < 1e-14 && (found.circles.mcc.circle.radius - 3.0).abs() < 1e-14);
        assert_eq!((found.plane, found.flatness()), (None, None));
    }

    #[test]
    fn tilted_points_are_as_round_as_level_ones() {
        let (sine, cosine) = libm::sincos(0.3);
        let tilt = |(k, [x, y]): (usize, &[f64; 2])| {
            let height = if k % 2 == 0 { 0.01 } else { -0.01 };
            [cosine * x + sine * height, *y, 5.0 - sine * x + cosine * height]
        };
        let points = ring(36).iter().enumerate().map(tilt).collect();
        let found = assess(&Measured::Spatial(points), &[degrees(-30.0, 10.0)]).unwrap();
        assert_eq!(found.kept().count(), 32);
        assert!(found.circles.lsc.circularity < 1e-4);
        let ([x, y], z) = found.center(&found.circles.lsc);
        assert!(
            (x - 7.0 * cosine).abs() < 1e-3 && (y + 2.0).abs() < 1e-3 && (z.unwrap() - 5.0 + 7.0 * sine).abs() < 1e-3
        );
        assert!((found.flatness().unwrap() - 0.02).abs() < 1e-3);
    }

    #[test]
    fn what_is_left_must_be_a_circle() {
        let all = [degrees(0.0, 360.0)];
        let none = RoundnessError::Left { count: 0, cause: CircleError::TooFew(0) };
        assert_eq!(assess(&Measured::Planar(ring(9)), &all), Err(none));
        let two = RoundnessError::Left { count: 2, cause: CircleError::TooFew(2) };
        assert_eq!(assess(&Measured::Planar(ring(9)), &[degrees(90.0, 361.0)]), Err(two));
        let flat = Measured::Spatial(vec![[1.0, 2.0, 3.0]; 5]);
        assert_eq!(assess(&flat, &[]), Err(RoundnessError::Points(CircleError::TooFew(1))));
    }
}
