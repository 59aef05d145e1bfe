//! Tool paths from CAM systems: CLDATA and G-code into the points of a task file.
//!
//! A reader ([`cldata`], [`gcode`]) turns a program into straight [`Move`]s of the tool centre point, in the workpiece
//! frame, SI inside: `course` is what both have in common. `segments` takes the runs of cutting moves between rapids
//! and resamples them; [`ImportedPath`] holds the points, writes them as a task file, and says what was found and what
//! was changed.

/// Refuses what does not hold.
macro_rules! ensure {
    ($holds:expr, $refused:expr) => {{
        let holds: bool = $holds;
        if !holds {
            return Err($refused);
        }
    }};
}

mod arc;
pub mod cldata;
mod course;
pub mod gcode;
mod imported;
mod links;
mod refusals;
mod segments;
#[cfg(test)]
mod tests;
mod tool;
mod units;

pub use cldata::CamFormat;
pub use imported::ImportedPath;
pub use refusals::{GUESSES as TOOL_GUESSES, guessed_keys};
pub use segments::Resampling;
pub use tool::ProgramTool;
pub use tool::file_beside;
pub use units::LengthUnit;

use crate::file_kind::FileKind;
use gcode::Machine;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::path::Path;
use stead_disk::files;
use stead_disk::input::{InputError, input_file};

/// No coordinate is larger than this: a wrong unit, or no coordinate at all. m
const LARGEST: f64 = 100.0;

/// How a program is read.
#[derive(Debug, Clone, PartialEq, Default)]
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
    /// Whether links between cuts that are programmed at feed are taken as cuts.
    pub keep_links: bool,
    /// Words of CLDATA that are passed over whatever they do, or codes of G-code, whose blocks are.
    pub ignore: Vec<String>,
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
    /// Whether its end stays when points are left out: on an arc they are as far apart as they may be.
    pub is_fixed: bool,
    /// Line in the file, from 1.
    pub line: usize,
}

/// How often something was found, and the first of its lines.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Found {
    /// How often.
    pub times: usize,
    /// Some of its lines, in their order.
    pub lines: Vec<usize>,
}

impl Found {
    fn at(&mut self, line: usize) {
        self.times += 1;
        self.lines.extend(Some(line).filter(|_| self.lines.len() < NAMED_LINES));
    }

    /// Behind what it is of.
    fn words(&self) -> String {
        let lines = self.lines.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
        match self.times {
            1 => format!(" (line {lines})"),
            times if times == self.lines.len() => format!(" (lines {lines})"),
            times => format!(" ({times} times, first in lines {lines})"),
        }
    }
}

/// Lines that are named of what was found.
const NAMED_LINES: usize = 5;

/// A program as its moves; the first only says where the tool starts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Program {
    /// What it is written in.
    pub format: CamFormat,
    /// The moves in their order.
    pub moves: Vec<Move>,
    /// Tools and tool paths that the program names, in their order.
    pub tools: Vec<String>,
    /// What is known of the tool, each with the move that it is made from on.
    pub tools_from: Vec<(usize, ProgramTool)>,
    /// Whether it says that rapid moves are made at feed.
    pub has_rapids_at_feed: bool,
    /// What was made of the program that is not plain.
    pub notes: BTreeMap<String, Found>,
    /// Holes of drilling cycles that were left out: places in the workpiece frame (m), with the line.
    pub holes_left_out: Vec<(Vector3<f64>, usize)>,
    /// Words that do not move the tool and were passed over.
    pub passed_over: BTreeMap<String, Found>,
}

impl Program {
    fn note(&mut self, text: impl Into<String>, line: usize) {
        self.notes.entry(text.into()).or_default().at(line);
    }

    fn name_tool(&mut self, name: String) {
        if !self.tools.contains(&name) {
            self.tools.push(name);
        }
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
    let format = settings.format.or_else(|| format_of(text)).ok_or_else(|| {
        InputError::new(file, "is neither CLDATA nor G-code that can be told as such")
            .in_field("--format")
            .allowed("--format cldata or --format gcode, for a file that is one of them")
    })?;
    let mut program = match format {
        CamFormat::Gcode => gcode::read(file, text, settings)?,
        _ => cldata::read(file, text, settings)?,
    };
    if !settings.keep_links {
        links::take_out(&mut program);
    }
    let inputs = vec![input_file("program", file.display().to_string(), bytes)];
    let mut imported = ImportedPath::new(file, program, settings.resampling)?;
    imported.inputs = inputs;
    Ok(imported)
}

/// CLDATA or G-code, by the first line that is of one alone.
pub(crate) fn format_of(text: &str) -> Option<CamFormat> {
    text.lines().find_map(|line| {
        let line = cldata::without_label(line.trim());
        let mut chars = line.chars();
        let is_gcode = line.starts_with(['%', '(', ';'])
            || (chars.next().is_some_and(|c| c.is_ascii_alphabetic())
                && chars.find(|c| *c != ' ').is_some_and(|c| c.is_ascii_digit() || "+-.#".contains(c)));
        if is_gcode {
            Some(CamFormat::Gcode)
        } else if cldata::is_statement(line) {
            Some(CamFormat::Cldata)
        } else {
            gcode::foreign(line).map(|_| CamFormat::Gcode)
        }
    })
}
