//! A forces file for a tool path that is there.

use super::run_for::{relative, tool_beside};
use super::stock::Guess;
use crate::forces::{ReadingTable, path_of, rounded_mm};
use std::path::Path;
use stead_disk::files::{
    new::{Existing, write_new},
    read,
};
use stead_disk::input::InputError;
use stead_format::cam::{LengthUnit, TOOL_GUESSES, guessed_keys};
use stead_format::sources::Sources;
use stead_format::toml_file::commented;

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
    let diameter = of_program.and_then(|tool| tool.diameter).map(rounded_mm);
    let diameter = diameter.or(beside.as_ref().map(|tool| tool.cutter_diameter_mm.written()));
    let corner = of_program.and_then(|tool| tool.corner_radius).map(rounded_mm);
    let corner = corner.or(beside.as_ref().and_then(|tool| tool.corner_radius_mm).map(|corner| corner.written()));
    let length = of_program.and_then(|tool| tool.length).map(rounded_mm);
    let about = |is_known: bool| if is_known { "as the program has it" } else { "" };
    let folder = out.parent().unwrap_or(Path::new(""));
    let quoted = |file: &Path| toml::Value::from(relative(folder, file)).to_string();
    let half = diameter.unwrap_or(10.0) / 2.0;
    let guess = stock.is_none().then(|| Guess::of_path(&known.path, 2.0 * half, corner.unwrap_or_default()));
    let stock = match (stock, &guess) {
        (Some(mesh), _) => format!(
            "mesh = {}\n# unit = \"mm\"                        # of the mesh file; or \"m\"\n\
             # xyz_mm = [0.0, 0.0, 0.0]             # where its origin is\n",
            quoted(mesh)
        ),
        (None, guess) => guess.as_ref().map(Guess::row).unwrap_or_default(),
    };
    let has_feeds = known.path.feed(0).is_some();
    let guessed = [
        ("reading".to_owned(), !has_units),
        (guess.as_ref().map_or(String::new(), |guess| format!("stock.{}", guess.key)), guess.is_some()),
        ("tool.cutter_diameter_mm".to_owned(), diameter.is_none()),
        ("tool.flute_length_mm".to_owned(), length.is_none()),
        ("cut.spindle_rpm".to_owned(), known.spindle_speed.is_none()),
        ("cut.feed_per_tooth_mm".to_owned(), !has_feeds),
    ];
    let guessed = guessed.into_iter().filter(|(_, is_guess)| *is_guess).map(|(key, _)| key);
    let guesses: Vec<String> = guessed.chain(guessed_keys()).collect();
    let mut text = format!(
        "# Forces along a tool path from what it removes of the stock. Written by `stead init forces`. Replace the values that `guesses`\n\
         # names by those of your cutter and stock, and take the names out. Run it with\n#     stead forces {} --out TASK.csv\n\n\
         guesses = {guesses:?}\npath = {}\n",
        out.display(),
        quoted(path)
    );
    if !has_units {
        text += &commented("reading = { units = \"mm\" }", "the program does not state its unit; or \"inch\"");
    }
    text += &commented(
        "# material = \"aluminium-7075\"",
        "published cutting coefficients, in place of kt_mpa to kre_n_per_mm",
    );
    text += &format!(
        "\n[stock]                                # the material before it is cut, in the workpiece frame\n{stock}\n[tool]\n"
    );
    text += &commented(&format!("cutter_diameter_mm = {:?}", 2.0 * half), about(diameter.is_some()));
    match corner {
        Some(corner) => text += &commented(&format!("corner_radius_mm = {corner:?}"), about(true)),
        None => text += &commented("# corner_radius_mm = 0.0", "half the diameter for a ball"),
    }
    let flutes = length.unwrap_or(6.0 * half);
    let of_length = if length.is_some() { "as the program has it, perhaps with the shank" } else { "" };
    text += &commented(&format!("flute_length_mm = {flutes:?}"), of_length);
    TOOL_GUESSES.iter().for_each(|(row, comment)| text += &commented(row, comment));
    text += "\n[cut]\n";
    match known.spindle_speed {
        Some(speed) => {
            text += &commented(&format!("# spindle_rpm = {:?}", (speed * 6e4).round() / 1e3), "as the program has it")
        }
        None => text += &commented("spindle_rpm = 9000.0", "the path states none"),
    }
    if !has_feeds {
        text += &commented("feed_per_tooth_mm = 0.05", "the path has no feeds");
    }
    write_new(out, &text, existing)
}
