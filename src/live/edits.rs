//! Other values of the run file, and the file that holds them.

use super::place::{Place, shown};
use super::reading::Reading;
use super::requests::RequestError;
use crate::Run;
use crate::files::FieldOverride;
use std::path::{Path, PathBuf};
use stead_disk::Existing;
use stead_disk::files::new::write_new;
use stead_model::external_axis::AxisKind;
use stead_problem::setup::AxisPositions;
use toml_edit::{DocumentMut, Item, Table, Value};

/// The tables whose values can be changed in a session.
const TABLES: [&str; 2] = ["cell.", "criterion."];

/// A value that can be changed in a session.
///
/// # Errors
/// [`RequestError`] for one of another table, or that is no value.
pub(super) fn allowed(text: &str) -> Result<FieldOverride, RequestError> {
    let refused = |problem: String| RequestError::new("edits", problem, "values of [cell] and [criterion]");
    let found = FieldOverride::parse(text).map_err(|error| refused(error.to_string()))?;
    let path = found.path().to_string();
    if !TABLES.iter().any(|table| path.starts_with(table)) {
        return Err(refused(format!("{path} is not changed here")));
    }
    Ok(found)
}

/// Writes the run file with all values in place as a new file beside it, and reads it back; with a placement, its cell
/// holds that one alone.
///
/// # Errors
/// [`RequestError`]: the name is none, the file is there, or no run file says the same.
pub(super) fn save(
    run_file: &Path,
    given: &[FieldOverride],
    reading: &Reading,
    name: &str,
    place: Option<&Place>,
) -> Result<PathBuf, RequestError> {
    let named = name.strip_suffix(".toml").unwrap_or(name);
    let is_plain = !named.starts_with('.') && !named.contains(['/', '\\', ':', '\0', '\n', '\r']);
    if named.trim().is_empty() || !is_plain {
        return Err(RequestError::new("name", format!("is no name of a file, found {name}"), "a name without folders"));
    }
    let file = run_file.with_file_name(format!("{named}.toml"));
    if file.exists() {
        let problem = format!("{} is there already", file.display());
        return Err(RequestError::new("name", problem, "a name that no file has yet"));
    }
    let refused = |error: &dyn std::fmt::Display| RequestError::of_file("name", error);
    let text = std::fs::read_to_string(run_file).map_err(|error| refused(&error))?;
    let text = composed(&text, given.iter().chain(&reading.edits), place.map(|place| (reading, place)))?;
    write_new(&file, &text, Existing::Kept).map_err(|error| refused(&error))?;
    if let Err(error) = Run::read(&file) {
        // It is ours, and of no use.
        let _ = std::fs::remove_file(&file);
        return Err(RequestError::new("name", format!("the file would not be read again: {error}"), "other values"));
    }
    Ok(file)
}

/// The text of a run file with other values.
fn composed<'a>(
    text: &str,
    values: impl Iterator<Item = &'a FieldOverride>,
    pinned: Option<(&Reading, &Place)>,
) -> Result<String, RequestError> {
    let refused = |problem: String| RequestError::new("edits", problem, "values of the run file itself");
    let mut document: DocumentMut = text.parse().map_err(|error| refused(format!("the run file: {error}")))?;
    for value in values {
        let path = value.path().to_string();
        let parsed: Value = value.value().parse().map_err(|error| refused(format!("{path}: {error}")))?;
        put(&mut document, &path, parsed).map_err(refused)?;
    }
    if let Some((reading, place)) = pinned {
        pin(&mut document, reading, place).map_err(refused)?;
    }
    Ok(document.to_string())
}

/// Puts a value at a path of tables.
fn put(document: &mut DocumentMut, path: &str, value: Value) -> Result<(), String> {
    let keys: Vec<&str> = path.split('.').collect();
    let Some((last, tables)) = keys.split_last().filter(|_| !path.contains('[')) else {
        return Err(format!("{path} is a value of a list, which is changed in the file by hand"));
    };
    let mut table: &mut dyn toml_edit::TableLike = document.as_table_mut();
    for key in tables {
        let is_file = table.get(key).is_some_and(Item::is_str);
        let entry = table.entry(key).or_insert(Item::Table(Table::new()));
        table = entry.as_table_like_mut().ok_or_else(|| {
            let what =
                if is_file { "of another file, which the run file names" } else { "in no table of the run file" };
            format!("{path} is {what}")
        })?;
    }
    table.insert(last, Item::Value(value));
    Ok(())
}

/// Narrows the cell down to a placement, and the ranges of external axes to where they stand.
fn pin(document: &mut DocumentMut, reading: &Reading, place: &Place) -> Result<(), String> {
    let problem = reading.run.problem();
    let both = |at: f64| Value::from_iter([at, at]);
    let Place { placement, setup } = place;
    for (key, metres) in [("x_mm", placement.x), ("y_mm", placement.y), ("z_mm", placement.z)] {
        put(document, &format!("cell.{key}"), both(metres * 1e3))?;
    }
    if let Some(cell) = document.get_mut("cell").and_then(Item::as_table_like_mut) {
        cell.remove("q4");
        if let Some(orientation) = problem.orientations.get(setup.orientation) {
            cell.insert("orientation", toml_edit::value(&orientation.name));
        }
    }
    put(document, "cell.yaw_deg", both(placement.yaw.to_degrees()))?;
    if problem.external_axes.is_empty() {
        return Ok(());
    }
    let AxisPositions::Same(positions) = &setup.positions else {
        return Err("external axes that move along the path cannot be held at one position".to_owned());
    };
    let axes = document.get_mut("external_axis").and_then(Item::as_array_of_tables_mut);
    for (table, (axis, at)) in
        axes.into_iter().flat_map(|axes| axes.iter_mut()).zip(problem.external_axes.iter().zip(positions))
    {
        let key = match axis.kind {
            AxisKind::Rail => "range_mm",
            AxisKind::Turntable => "range_deg",
        };
        table.insert(key, Item::Value(both(shown(axis, *at))));
    }
    Ok(())
}
