//! A forces file for a tool path that is there.

use super::run_for::tool_beside;
use super::stock::Guess;
use crate::forces::{ReadingTable, path_of, rounded_mm};
use std::path::Path;
use stead_disk::files::{
    new::{Existing, write_new},
    read,
};
use stead_disk::input::InputError;
use stead_disk::template::{filled, shown_if};
use stead_format::cam::{LengthUnit, TOOL_GUESSES, guessed_keys};
use stead_format::sources::Sources;
use stead_format::written::{commented, relative};

/// Writes a forces file for `stead forces` that names a tool path, and a mesh of its stock where there is one. The
/// cutter is that of the program, or that beside a task (`NAME-tool.toml`). What is not known is filled in by a guess,
/// and named in `guesses`.
///
/// # Errors
/// [`InputError`]: the path or what is beside it is wrong, or the file is there already and to be kept, or cannot be
/// written.
pub fn init_forces(path: &Path, stock: Option<&Path>, out: &Path, existing: Existing) -> Result<(), InputError> {
    let bytes = read(path).map_err(|e| InputError::new(path, format!("cannot be read: {e}")))?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let read = |keys: &ReadingTable| path_of(name.to_string(), path, &bytes, keys, &Sources::disk());
    let stated = read(&ReadingTable::default());
    let in_mm = ReadingTable { units: Some(LengthUnit::Millimetre.into()), ..ReadingTable::default() };
    let has_units = stated.is_ok();
    let known = stated.or_else(|error| read(&in_mm).map_err(|_| error))?;
    let beside = tool_beside(path)?;
    let of_program = known.tool.as_ref();
    let speed = of_program.and_then(|tool| tool.spindle_speed);
    let diameter = of_program.and_then(|tool| tool.diameter).map(rounded_mm);
    let diameter = diameter.or(beside.as_ref().map(|tool| tool.cutter_diameter_mm.written()));
    let corner = of_program.and_then(|tool| tool.corner_radius).map(rounded_mm);
    let corner = corner.or(beside.as_ref().and_then(|tool| tool.corner_radius_mm).map(|corner| corner.written()));
    let length = of_program.and_then(|tool| tool.length).map(rounded_mm);
    let folder = out.parent().unwrap_or(Path::new(""));
    let quoted = |file: &Path| toml::Value::from(relative(folder, file)).to_string();
    let number = |value: f64| format!("{value:?}");
    let wide = diameter.unwrap_or(GUESSED_DIAMETER);
    let guess = stock.is_none().then(|| Guess::of_path(&known.path, wide, corner.unwrap_or_default()));
    let has_feeds = known.path.feed(0).is_some();
    let guessed = [
        ("reading".to_owned(), !has_units),
        (guess.as_ref().map_or(String::new(), |guess| format!("stock.{}", guess.key)), guess.is_some()),
        ("tool.cutter_diameter_mm".to_owned(), diameter.is_none()),
        ("tool.flute_length_mm".to_owned(), length.is_none()),
        ("cut.spindle_rpm".to_owned(), speed.is_none()),
        ("cut.feed_per_tooth_mm".to_owned(), !has_feeds),
    ];
    let guessed = guessed.into_iter().filter(|(_, is_guess)| *is_guess).map(|(key, _)| key);
    let guesses: Vec<String> = guessed.chain(guessed_keys()).collect();
    let of_tool: String = TOOL_GUESSES.iter().map(|(row, comment)| commented(row, comment)).collect();
    let text = filled(
        include_str!("forces_for.toml"),
        &[
            ("out", Some(out.display().to_string())),
            ("guesses", Some(format!("{guesses:?}"))),
            ("path", Some(quoted(path))),
            ("no_unit", shown_if(!has_units)),
            ("mesh", stock.map(quoted)),
            ("has_mesh", shown_if(stock.is_some())),
            ("stock", guess.as_ref().map(Guess::row)),
            ("diameter", diameter.map(number)),
            ("guessed_diameter", diameter.is_none().then(|| number(wide))),
            ("corner", corner.map(number)),
            ("no_corner", shown_if(corner.is_none())),
            ("length", length.map(number)),
            ("guessed_length", length.is_none().then(|| number(3.0 * wide))),
            ("tool_guesses", Some(of_tool.trim_end().to_owned())),
            ("speed", speed.map(|speed| number((speed * 6e4).round() / 1e3))),
            ("no_speed", shown_if(speed.is_none())),
            ("no_feeds", shown_if(!has_feeds)),
        ],
    );
    write_new(out, &text, existing)
}

/// Of a cutter that nothing is said of. mm
const GUESSED_DIAMETER: f64 = 10.0;
