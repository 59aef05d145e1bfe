//! Reports of `stead circularity`: what it prints, and `circularity.json`, `deviations.csv`, `polar.svg` and `report.html`.

mod page;

use super::output::{Folder, ReportError};
use super::page::PAGE;
use super::picture;
use super::{Files, named};
use crate::columns::aligned;
use crate::csv_file::table;
use crate::document::{Document, bytes};
use crate::units::fixed;
use serde_json::{Value, json};
use std::path::PathBuf;
use stead_assessment::circle::Fit;
use stead_assessment::roundness::{Measured, Roundness};
use stead_format::PointFile;

/// Decimals of lengths in mm: a nine-digit micrometre has no fewer.
const DECIMALS: usize = 12;

/// Writes `circularity.json`, `deviations.csv`, `polar.svg` and `report.html` into a folder and returns their paths in that order.
///
/// # Errors
/// [`ReportError`]: nothing is written when a file cannot be made, and no file is ever left half written.
pub fn write_circularity(folder: &Folder, file: &PointFile, found: &Roundness) -> Result<Vec<PathBuf>, ReportError> {
    let files = circularity_files(file, found)?;
    folder.results("circularity", std::slice::from_ref(&file.input)).write(&files)
}

/// The files that [`write_circularity`] writes.
///
/// # Errors
/// [`ReportError::Format`]: a file cannot be made.
pub fn circularity_files(file: &PointFile, found: &Roundness) -> Result<Files, ReportError> {
    Ok(named([
        ("circularity.json", bytes(&circularity_json(file, found))),
        ("deviations.csv", deviations(file, found)?),
        ("polar.svg", picture::polar(&file.input.name, found).into_bytes()),
        (PAGE, page::page(file, found).html()),
    ]))
}

/// Names of the four circles in files, in words, and what they are.
fn circles(found: &Roundness) -> [(&'static str, &'static str, &Fit); 4] {
    let circles = &found.circles;
    [
        ("lsc", "least squares (LSC)", &circles.lsc),
        ("mzc", "minimum zone (MZC)", &circles.mzc),
        ("mic", "maximum inscribed (MIC)", &circles.mic),
        ("mcc", "minimum circumscribed (MCC)", &circles.mcc),
    ]
}

/// What `stead circularity --json` prints, and the content of `circularity.json`. Centres are in the frame of the file.
pub fn circularity_json(file: &PointFile, found: &Roundness) -> Value {
    let mut entries = json!({
        "input": { "name": file.input.name, "sha256": file.input.sha256 },
        "points": found.points.len(),
        "excluded": found.points.len() - found.kept().count(),
        "plane": plane(found),
    });
    for (name, _, fit) in circles(found) {
        entries[name] = circle(found, fit);
    }
    Document::new(std::slice::from_ref(&file.input)).warnings(found.warnings()).with(entries)
}

fn circle(found: &Roundness, fit: &Fit) -> Value {
    let ([x, y], z) = found.center(fit);
    let mut value = json!({
        "center_x_mm": number(x),
        "center_y_mm": number(y),
        "radius_mm": number(fit.circle.radius),
        "circularity_mm": number(fit.circularity),
        "smallest_radius_mm": number(fit.smallest),
        "largest_radius_mm": number(fit.largest),
    });
    if let (Value::Object(map), Some(z)) = (&mut value, z) {
        map.insert("center_z_mm".to_owned(), json!(number(z)));
    }
    value
}

fn plane(found: &Roundness) -> Value {
    let (Some(plane), Some(flatness)) = (&found.plane, found.flatness()) else { return Value::Null };
    let triple = |v: nalgebra::Vector3<f64>| json!([number(v.x), number(v.y), number(v.z)]);
    json!({
        "center_mm": triple(plane.center),
        "normal": triple(plane.normal),
        "x_axis": triple(plane.x_axis),
        "flatness_mm": number(flatness),
    })
}

fn number(value: f64) -> f64 {
    fixed(value, DECIMALS).parse().unwrap_or(f64::NAN)
}

/// The table for people.
pub fn circularity_text(file: &PointFile, found: &Roundness) -> String {
    let (all, kept) = (found.points.len(), found.kept().count());
    let mut text = format!("{}: {all} points, {} left out\n", file.input.name, all - kept);
    if let (Some(plane), Some(flatness)) = (&found.plane, found.flatness()) {
        let (c, n) = (plane.center, plane.normal);
        text.push_str(&format!(
            "plane through ({}, {}, {}) mm, normal ({}, {}, {}), flatness {} mm\n",
            fixed(c.x, 4),
            fixed(c.y, 4),
            fixed(c.z, 4),
            fixed(n.x, 6),
            fixed(n.y, 6),
            fixed(n.z, 6),
            fixed(flatness, 5),
        ));
    }
    let mut header =
        ["reference circle", "circularity mm", "radius mm", "center x mm", "y mm"].map(str::to_owned).to_vec();
    if found.plane.is_some() {
        header.push("z mm".to_owned());
    }
    let mut rows = vec![header];
    for (_, name, fit) in circles(found) {
        let ([x, y], z) = found.center(fit);
        let mut row = vec![name.to_owned(), fixed(fit.circularity, 6), fixed(fit.circle.radius, 5)];
        row.extend([Some(x), Some(y), z].into_iter().flatten().map(|value| fixed(value, 5)));
        rows.push(row);
    }
    text.push('\n');
    text.push_str(&aligned(&rows, &[0]));
    text
}

/// Columns of points in the plane and in space.
const PLANAR: &str = "point,line,x_mm,y_mm,angle_deg,excluded";
const SPATIAL: &str = "point,line,x_mm,y_mm,z_mm,angle_deg,excluded,height_mm";

/// `deviations.csv`: every point with its polar angle (by which `--exclude-deg` goes), whether it was left out, its height
/// above the plane where there is one, and about each of the four centres its radius and that less the reference circle's.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn deviations(file: &PointFile, found: &Roundness) -> Result<Vec<u8>, ReportError> {
    let is_spatial = found.plane.is_some();
    let places = if is_spatial { SPATIAL } else { PLANAR }.split(',').map(str::to_owned);
    let about = |(name, ..): (&str, _, _)| [format!("{name}_radius_mm"), format!("{name}_deviation_mm")];
    let header = places.chain(circles(found).into_iter().flat_map(about));
    let rows = found.points.iter().enumerate().map(|(index, point)| {
        let mut row = vec![index.to_string(), file.lines.get(index).map_or_else(String::new, ToString::to_string)];
        match &file.measured {
            Measured::Planar(points) => row.extend(points[index].map(|value| value.to_string())),
            Measured::Spatial(points) => row.extend(points[index].map(|value| value.to_string())),
        }
        row.extend([fixed(point.angle.to_degrees(), 4), point.is_excluded.to_string()]);
        if is_spatial {
            row.push(fixed(point.height, 7));
        }
        for (_, _, fit) in circles(found) {
            let [x, y] = fit.circle.center;
            let radius = libm::hypot(point.place[0] - x, point.place[1] - y);
            row.extend([radius, radius - fit.circle.radius].map(|value| fixed(value, 7)));
        }
        row
    });
    table("the table of deviations", header, rows)
}
