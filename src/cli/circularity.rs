//! `stead circularity`: roundness of measured points.

use super::arguments::CircularityOptions;
use super::{Failure, files_written, print, say};
use std::path::Path;
use stead_assessment::circle::CircleError;
use stead_assessment::roundness::{RoundnessError, assess};
use stead_format::input::InputError;
use stead_format::{PointFile, read_points};
use stead_report::circularity::{circularity_json, circularity_text, write_circularity};
use stead_report::document;
use stead_report::output::Folder;

pub(super) fn run(options: &CircularityOptions) -> Result<(), Failure> {
    let file = read_points(&options.points)?;
    let found = assess(&file.measured, &options.exclude_deg).map_err(|error| located(&options.points, &file, error))?;
    found.warnings().iter().for_each(|warning| say(&format!("warning: {warning}")));
    if let Some(out) = &options.out {
        let folder = Folder::create(out).map_err(Failure::Output)?;
        files_written(write_circularity(&folder, &file, &found))?;
    }
    if options.json {
        print(&document::bytes(&circularity_json(&file, &found)));
    } else {
        let where_to = options.out.as_ref().map(|out| format!("\nresults in {}\n", out.display()));
        print((circularity_text(&file, &found) + &where_to.unwrap_or_default()).as_bytes());
    }
    Ok(())
}

/// What is wrong with the points, in their file.
fn located(path: &Path, file: &PointFile, error: RoundnessError) -> InputError {
    const ALLOWED: &str = "at least three different points that are not on one straight line";
    let (cause, excluded) = match error {
        RoundnessError::Points(cause) => (cause, None),
        RoundnessError::Left { count, cause } => (cause, Some(count)),
    };
    let columns = match file.measured {
        stead_assessment::roundness::Measured::Planar(_) => "x_mm,y_mm",
        stead_assessment::roundness::Measured::Spatial(_) => "x_mm,y_mm,z_mm",
    };
    let first = file.lines.first().copied().unwrap_or(1);
    let (line, found, allowed) = match cause {
        CircleError::NotFinite { point } => (file.lines.get(point).copied().unwrap_or(first), None, "finite numbers"),
        CircleError::TooFew { distinct } => (first, Some(format!("{distinct} different points")), ALLOWED),
        CircleError::Collinear => (first, Some(format!("{} points on a line", file.lines.len())), ALLOWED),
        CircleError::Straight => (first, None, "points of a circle, or of an arc that is bent more than it is rough"),
    };
    let located = match excluded {
        None => InputError::new(path, cause.to_string()).at_line(line).in_field(columns),
        Some(count) => {
            let all = file.lines.len();
            InputError::new(path, format!("with {count} of {all} points left, {cause}")).in_field("--exclude-deg")
        }
    };
    match found {
        Some(found) => located.found(found).allowed(allowed),
        None => located.allowed(allowed),
    }
}
