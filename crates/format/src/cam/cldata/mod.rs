//! CLDATA: cutter locations in text, the words of APT (ISO 4343) as NX, SolidWorks CAM and others write them.
//!
//! Positions are in the frame of the last `MSYS` or `CSYS`, the tool axis is modal, `RAPID` is for the next `GOTO`
//! alone, and `CIRCLE` makes it an arc. With 11 numbers, as NX writes them, it turns as a left-handed screw along its
//! axis; with 6 (SolidWorks CAM) and 7 (Creo), as a right-handed one.

mod cutter;
mod cycle;
mod reader;
mod statement;
mod words;

pub(super) use words::is_known;

use super::{LengthUnit, Program, ReadSettings};
use reader::Reader;
use statement::{Statement, Statements};
use std::path::Path;
use stead_disk::input::InputError;

/// Reads the moves of a CLDATA file.
///
/// # Errors
/// [`InputError`] with line and word: a unit that is not stated or stated twice, numbers that are not finite or not as
/// many as the word has, a tool axis without length, an arc that misses its end, a word that moves the tool in a way
/// that is not known.
pub fn read(file: &Path, text: &str, settings: &ReadSettings) -> Result<Program, InputError> {
    let unit = unit_of(file, text, settings.units)?;
    let mut reader = Reader::new(file, unit, settings);
    let mut statements = Statements::new(text);
    let mut statement = Statement::default();
    while statements.next_into(&mut statement) {
        if !reader.take(&statement)? {
            break;
        }
    }
    reader.finish(&statement)
}

/// The unit that a file states, or the one given for a file that does not.
fn unit_of(file: &Path, text: &str, given: Option<LengthUnit>) -> Result<LengthUnit, InputError> {
    let mut unit = given;
    let mut statements = Statements::new(text);
    let mut statement = Statement::default();
    while statements.next_into(&mut statement) {
        if !["UNIT", "UNITS"].iter().any(|word| statement.word.eq_ignore_ascii_case(word)) {
            continue;
        }
        let fail = |problem: String, allowed: &str| {
            InputError::new(file, problem)
                .at_line(statement.line)
                .in_field(statement.word)
                .found(format!("'{}'", statement.text()))
                .allowed(allowed)
        };
        let known = [("MM", LengthUnit::Millimetre), ("INCH", LengthUnit::Inch), ("INCHES", LengthUnit::Inch)];
        let stated = known.iter().find(|(word, _)| statement.has(word)).map(|(_, unit)| *unit);
        let stated = stated.ok_or_else(|| fail("names no unit of length".to_owned(), "MM or INCHES"))?;
        match unit {
            Some(unit) if unit != stated => {
                let other = if given.is_some() { "--units" } else { "the file before" };
                let problem = format!("is not what {other} says: {}", unit.word());
                return Err(fail(problem, "one unit of length for the whole file"));
            }
            _ => unit = Some(stated),
        }
    }
    unit.ok_or_else(|| {
        InputError::new(file, "does not state its unit of length (no UNITS/MM or UNITS/INCHES)")
            .in_field("--units")
            .allowed("--units mm or --units inch")
    })
}
