//! Tool paths from CAM systems: CLDATA and G-code into the points of a task file.
//!
//! A reader ([`cldata`], [`gcode`]) turns a program into straight [`Move`]s of the tool centre point, in the workpiece
//! frame, SI inside. `segments` takes the runs of cutting moves between rapids and resamples them; [`ImportedPath`]
//! holds the points, writes them as a task file, and says what was found and what was changed.

mod arc;
pub mod cldata;
pub mod gcode;
mod imported;
mod segments;
#[cfg(test)]
mod tests;
mod tool;

pub use imported::ImportedPath;
pub use segments::Resampling;
pub use tool::ProgramTool;
pub use tool::file_beside;

use crate::file_kind::FileKind;
use gcode::Machine;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use stead_disk::files;
use stead_disk::input::InputError;

/// No coordinate is larger than this: a wrong unit, or no coordinate at all. m
const LARGEST: f64 = 100.0;

/// A unit of length of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LengthUnit {
    /// Millimetres.
    Millimetre,
    /// Inches.
    Inch,
}

impl LengthUnit {
    /// Its length. m
    pub fn metres(self) -> f64 {
        match self {
            Self::Millimetre => 1e-3,
            Self::Inch => 25.4e-3,
        }
    }

    /// Its name as an option has it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Inch => "inch",
        }
    }
}

/// What a program is written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CamFormat {
    /// Cutter location data, APT words in text.
    Cldata,
    /// G-code of ISO 6983.
    Gcode,
}

/// How a program is read.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ReadSettings {
    /// The format; told from the file where left out.
    pub format: Option<CamFormat>,
    /// The unit of length, needed where the program does not state it.
    pub units: Option<LengthUnit>,
    /// The machine that G-code with rotary axes is for.
    pub machine: Option<Machine>,
    /// Where the rotary axes of that machine meet, for G-code without tool centre point control: in the workpiece frame
    /// for a table, from the tool centre point with the tool upright for a head. m
    pub pivot: Option<Vector3<f64>>,
    /// Whether tool centre point control is on though the program has no G43.4.
    pub tool_centre_point: bool,
    /// Whether the holes of drilling cycles are left out.
    pub skip_cycles: bool,
    /// How densely points are taken.
    pub resampling: Resampling,
}

/// A straight move of the tool centre point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// Its end in the workpiece frame. m
    pub position: Vector3<f64>,
    /// Tool axis at its end, of unit length, from the workpiece to the spindle.
    pub axis: Vector3<f64>,
    /// Feed. m/s
    pub feed: Option<f64>,
    /// Whether it is a move in the air.
    pub is_rapid: bool,
    /// Whether it ends on an arc, whose points are as far apart as they may be.
    pub is_arc: bool,
    /// Line in the file, from 1.
    pub line: usize,
}

/// A program as its moves; the first only says where the tool starts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Program {
    /// The moves in their order.
    pub moves: Vec<Move>,
    /// Tools and tool paths that the program names, in their order.
    pub tools: Vec<String>,
    /// What is known of the tool, each with the move that it is made from on.
    pub tools_from: Vec<(usize, ProgramTool)>,
    /// What was made of the program that is not plain, with how often.
    pub notes: BTreeMap<String, usize>,
    /// Holes of drilling cycles that were left out: places in the workpiece frame (m), with the line.
    pub holes_left_out: Vec<(Vector3<f64>, usize)>,
    /// Words that do not move the tool and were passed over, with how often.
    pub passed_over: BTreeMap<String, usize>,
}

impl Program {
    fn note(&mut self, text: impl Into<String>) {
        *self.notes.entry(text.into()).or_default() += 1;
    }
}

/// Reads a program and resamples it into the points of a task.
///
/// # Errors
/// [`InputError`] with file and line: a file that cannot be read, a format or a unit that cannot be told, whatever the
/// reader of the format refuses, or a program without a cutting move that can be scored.
pub fn import_path(file: &Path, settings: &ReadSettings) -> Result<ImportedPath, InputError> {
    let bytes = files::read(file).map_err(|e| InputError::new(file, format!("cannot be read: {e}")))?;
    import_bytes(file, &bytes, settings)
}

/// As [`import_path`], from the bytes of a file already read; `file` is its name in messages.
///
/// # Errors
/// As [`import_path`].
pub fn import_bytes(file: &Path, bytes: &[u8], settings: &ReadSettings) -> Result<ImportedPath, InputError> {
    FileKind::expect(
        &[FileKind::Cldata, FileKind::GCode],
        file,
        bytes,
        "a tool path of a CAM system, CLDATA or G-code",
    )?;
    // CAM systems write comments in the code page of their machine.
    let text = String::from_utf8_lossy(bytes);
    let text = text.trim_start_matches('\u{feff}');
    let format = match settings.format {
        Some(format) => format,
        None => format_of(text).ok_or_else(|| {
            InputError::new(file, "is neither CLDATA nor G-code that can be told as such")
                .in_field("--format")
                .allowed("--format cldata or --format gcode, for a file that is one of them")
        })?,
    };
    let program = match format {
        CamFormat::Cldata => cldata::read(file, text, settings)?,
        CamFormat::Gcode => gcode::read(file, text, settings)?,
    };
    ImportedPath::new(file, program, settings.resampling)
}

/// Lines that are looked at to tell the format.
const TELLING_LINES: usize = 2000;

/// The format by the first line that is of one alone.
fn format_of(text: &str) -> Option<CamFormat> {
    text.lines().take(TELLING_LINES).find_map(|line| {
        let line = line.trim();
        if line.starts_with("$$") {
            return Some(CamFormat::Cldata);
        }
        if line.starts_with('%') || line.starts_with('(') || line.starts_with(';') {
            return Some(CamFormat::Gcode);
        }
        let word: String =
            line.chars().take_while(|c| c.is_ascii_alphabetic()).collect::<String>().to_ascii_uppercase();
        let rest = line[word.len()..].trim_start();
        let is_cldata = word.len() > 1 && (rest.starts_with('/') || cldata::is_known(&word));
        let is_gcode = word.len() == 1 && rest.starts_with(|c: char| c.is_ascii_digit() || "+-.#".contains(c));
        if is_cldata {
            Some(CamFormat::Cldata)
        } else if is_gcode || gcode::foreign(line).is_some() {
            Some(CamFormat::Gcode)
        } else {
            None
        }
    })
}

/// A number without the digits that its unit has brought in.
fn rounded(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}

/// What was counted, as `NAME 3, OTHER 1`.
fn counted(counts: &BTreeMap<String, usize>) -> String {
    let mut text = String::new();
    for (name, count) in counts {
        let comma = if text.is_empty() { "" } else { ", " };
        // Writing to a string cannot fail.
        let _ = write!(text, "{comma}{name} {count}");
    }
    text
}
