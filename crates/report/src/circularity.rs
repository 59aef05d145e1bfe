//! Reports of `stead circularity`: what it prints, and `circularity.json`, `deviations.csv`, `polar.svg` and
//! `report.html`.

mod page;

use super::output::ReportError;
use super::page::PAGE;
use super::{Files, named};
use crate::columns::table;
use crate::csv_file::rows;
use crate::document::{Document, bytes};
use crate::figure::{AngleDeg, MeasuredMm, MmDeflection, each, some};
use crate::units::fixed;
use serde_json::Value;
use stead_assessment::circle::{Fit, plane::FittedPlane};
use stead_assessment::roundness::{Assessed, Measured, Roundness};
use stead_runs::PointFile;

/// `circularity.json`, `deviations.csv`, `polar.svg` and `report.html`.
///
/// # Errors
/// [`ReportError::Format`]: a file cannot be made.
pub fn circularity_files(file: &PointFile, found: &Roundness) -> Result<Files, ReportError> {
    Ok(named([
        ("circularity.json", bytes(&circularity_json(file, found))),
        ("deviations.csv", deviations(file, found)?),
        ("polar.svg", page::polar_picture(&file.input.name, found).into_bytes()),
        (PAGE, page::page(file, found).html()),
    ]))
}

records! {
    /// The circularity of a measured profile. Centres are in the frame of the file.
    pub struct CircularityFigures of (file: &PointFile, found: &Roundness) {
        /// The file of the points.
        input: MeasuredFile = MeasuredFile::of(file),
        /// Points.
        points: usize = found.points.len(),
        /// Points left out.
        excluded: usize = found.points.len() - found.kept().count(),
        /// The plane through points in space.
        plane: Option<PlaneFigures> =
            found.plane.as_ref().zip(found.flatness()).map(|(plane, flatness)| PlaneFigures::of(plane, flatness)),
        /// The least squares circle.
        lsc: CircleFigures = CircleFigures::of(found, &found.circles.lsc),
        /// The minimum zone circle.
        mzc: CircleFigures = CircleFigures::of(found, &found.circles.mzc),
        /// The maximum inscribed circle.
        mic: CircleFigures = CircleFigures::of(found, &found.circles.mic),
        /// The minimum circumscribed circle.
        mcc: CircleFigures = CircleFigures::of(found, &found.circles.mcc),
    }

    /// A file of points.
    pub struct MeasuredFile of (file: &PointFile) {
        /// Its name.
        name: String = file.input.name.clone(),
        /// SHA-256 digest of its bytes, in hexadecimal.
        sha256: String = file.input.sha256.clone(),
    }

    /// A plane through points.
    pub struct PlaneFigures of (plane: &FittedPlane, flatness: f64) {
        /// Centre of the points.
        center_mm: [MeasuredMm; 3] = each(plane.center.into()),
        /// Its normal.
        normal: [MeasuredMm; 3] = each(plane.normal.into()),
        /// The direction of angle zero.
        x_axis: [MeasuredMm; 3] = each(plane.x_axis.into()),
        /// Distance of the farthest points on both sides.
        flatness_mm: MeasuredMm = flatness.into(),
    }

    /// A reference circle.
    pub struct CircleFigures of (found: &Roundness, fit: &Fit) {
        let ([x, y], z) = found.center(fit);
    } with {
        /// x of its centre.
        center_x_mm: MeasuredMm = x.into(),
        /// y of its centre.
        center_y_mm: MeasuredMm = y.into(),
        /// z of its centre, of points in space.
        center_z_mm?: MeasuredMm = some(z),
        /// Its radius.
        radius_mm: MeasuredMm = fit.circle.radius.into(),
        /// Largest less smallest distance of a point from its centre.
        circularity_mm: MeasuredMm = fit.circularity.into(),
        /// Smallest distance.
        smallest_radius_mm: MeasuredMm = fit.smallest.into(),
        /// Largest distance.
        largest_radius_mm: MeasuredMm = fit.largest.into(),
    }
}

/// What `stead circularity --json` prints, and the content of `circularity.json`.
pub fn circularity_json(file: &PointFile, found: &Roundness) -> Value {
    Document::new(std::slice::from_ref(&file.input))
        .warnings(found.warnings())
        .with(CircularityFigures::of(file, found))
}

/// The table for people.
pub fn circularity_text(file: &PointFile, found: &Roundness) -> String {
    let (all, kept) = (found.points.len(), found.kept().count());
    let mut text = format!("{}: {all} points, {} left out\n", file.input.name, all - kept);
    if let (Some(plane), Some(flatness)) = (&found.plane, found.flatness()) {
        let (c, n) = (plane.center, plane.normal);
        let center = [c.x, c.y, c.z].map(|value| fixed(value, 4)).join(", ");
        let normal = [n.x, n.y, n.z].map(|value| fixed(value, 6)).join(", ");
        let flatness = fixed(flatness, 5);
        text.push_str(&format!("plane through ({center}) mm, normal ({normal}), flatness {flatness} mm\n"));
    }
    let header = ["reference circle", "circularity mm", "radius mm", "center x mm", "y mm"];
    let header = header.into_iter().chain(found.plane.as_ref().map(|_| "z mm"));
    let rows = page::circles(found).into_iter().map(|(_, name, fit)| {
        let ([x, y], z) = found.center(fit);
        let mut row = vec![name.to_owned(), fixed(fit.circularity, 6), fixed(fit.circle.radius, 5)];
        row.extend([Some(x), Some(y), z].into_iter().flatten().map(|value| fixed(value, 5)));
        row
    });
    text.push('\n');
    text.push_str(&table(header, rows, &[0]));
    text
}

records! {
    /// A measured point. Its radius about a centre less that of the reference circle is its deviation.
    pub struct DeviationRow of (index: usize, point: &Assessed, file: &PointFile, found: &Roundness) {
        let is_spatial = found.plane.is_some();
        let (x_mm, y_mm, z_mm) = match &file.measured {
            Measured::Planar(points) => (points[index][0], points[index][1], None),
            Measured::Spatial(points) => (points[index][0], points[index][1], Some(points[index][2])),
        };
    } with {
        /// Point, from 0.
        point: usize = index,
        /// Line of the file.
        line: Option<usize> = file.lines.get(index).copied(),
        /// x as it was read. mm
        x_mm: f64 = x_mm,
        /// y as it was read. mm
        y_mm: f64 = y_mm,
        /// z as it was read, of points in space. mm
        z_mm?: f64 = z_mm,
        /// Polar angle, by which `--exclude-deg` goes.
        angle_deg: AngleDeg = point.angle.into(),
        /// Whether it was left out.
        excluded: bool = point.is_excluded,
        /// Height over the plane, of points in space.
        height_mm?: MmDeflection = is_spatial.then(|| point.height.into()),
        /// About the least squares circle.
        lsc: AboutCircle = AboutCircle::of(point, &found.circles.lsc),
        /// About the minimum zone circle.
        mzc: AboutCircle = AboutCircle::of(point, &found.circles.mzc),
        /// About the maximum inscribed circle.
        mic: AboutCircle = AboutCircle::of(point, &found.circles.mic),
        /// About the minimum circumscribed circle.
        mcc: AboutCircle = AboutCircle::of(point, &found.circles.mcc),
    }

    /// A point about the centre of a reference circle.
    struct AboutCircle of (point: &Assessed, fit: &Fit) {
        let [x, y] = fit.circle.center;
        let radius = libm::hypot(point.place[0] - x, point.place[1] - y);
    } with {
        /// Its radius.
        radius_mm: MmDeflection = radius.into(),
        /// That less the radius of the circle.
        deviation_mm: MmDeflection = MmDeflection(radius - fit.circle.radius),
    }
}

/// `deviations.csv`: a [`DeviationRow`] for each point.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn deviations(file: &PointFile, found: &Roundness) -> Result<Vec<u8>, ReportError> {
    let row = |(index, point): (usize, &Assessed)| DeviationRow::of(index, point, file, found);
    rows("the table of deviations", found.points.iter().enumerate().map(row))
}
