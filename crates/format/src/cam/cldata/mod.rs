//! CLDATA: cutter locations in text, the words of APT (ISO 4343) in the dialects of CAM systems.
//!
//! What is particular to a dialect is data ([`dialect`]); the reader interprets it. Positions are in the frame of the
//! file, `RAPID` is for the next `GOTO` alone, and an arc is a word and the move behind it.

mod cutter;
mod cycle;
mod dialect;
mod reader;
mod statement;
mod told;

pub(super) use told::{is_labelled, is_statement};

use super::{LengthUnit, Program, ReadSettings};
use dialect::Dialect;
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
    let dialect = Dialect::of(text, settings.format);
    let unit = unit_of(file, dialect, text, settings.units)?;
    let mut reader = Reader::new(file, dialect, unit, settings)?;
    let mut statements = Statements::new(dialect, text);
    let mut statement = Statement::default();
    while statements.next_into(&mut statement) {
        if !reader.take(&statement)? {
            break;
        }
    }
    reader.finish(&statement)
}

/// The statements of the unit, in lines that may hold one: most are moves, which a look at their letters shows.
fn statements_of_unit<'a>(dialect: &'static Dialect, text: &'a str) -> Vec<Statement<'a>> {
    let mut found = Vec::new();
    let mut at = 0;
    for (line, number) in text.split_inclusive('\n').zip(1..) {
        if line.bytes().any(|byte| byte.eq_ignore_ascii_case(&b'u')) {
            let mut statements = Statements::new(dialect, &text[at..]);
            let mut statement = Statement::default();
            while statements.next_into(&mut statement) && statement.line == 1 {
                if ["UNIT", "UNITS"].iter().any(|word| statement.word.eq_ignore_ascii_case(word)) {
                    found.push(Statement { line: number, ..statement.clone() });
                }
            }
        }
        at += line.len();
    }
    found
}

/// The unit that a file states, or the one given for a file that does not.
fn unit_of(
    file: &Path,
    dialect: &'static Dialect,
    text: &str,
    given: Option<LengthUnit>,
) -> Result<LengthUnit, InputError> {
    let mut unit = given;
    for statement in statements_of_unit(dialect, text) {
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
