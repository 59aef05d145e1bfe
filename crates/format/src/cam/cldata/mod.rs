//! CLDATA: cutter locations in text, the words of APT (ISO 4343) in the dialects of CAM systems.
//!
//! What is particular to a dialect is data (`dialect`); the reader interprets it. Positions are in the frame of the
//! file, `RAPID` is for the next `GOTO` alone, and an arc is a word and the move behind it.

mod cutter;
mod cycle;
mod dialect;
mod reader;
mod statement;
mod told;

pub use dialect::CamFormat;
pub(crate) use told::has_word;
pub(super) use told::{is_statement, without_label};

use super::refusals::NO_UNIT;
use super::{LengthUnit, Program, ReadSettings};
use dialect::Dialect;
use reader::Reader;
use statement::Statements;
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
    let mut reader = Reader::new(dialect, unit, settings);
    let mut statements = Statements::new(file, dialect, text);
    while let Some(statement) = statements.next() {
        if !reader.take(statement)? {
            break;
        }
    }
    reader.finish(statements.last())
}

/// The unit that a file states, or the one given for a file that does not.
fn unit_of(
    file: &Path,
    dialect: &'static Dialect,
    text: &str,
    given: Option<LengthUnit>,
) -> Result<LengthUnit, InputError> {
    let known = [("MM", LengthUnit::Millimetre), ("INCH", LengthUnit::Inch), ("INCHES", LengthUnit::Inch)];
    let mut unit = given;
    let mut at = 0;
    for (line, number) in text.split_inclusive('\n').zip(1..) {
        let mut statements = Statements::new(file, dialect, &text[at..]);
        at += line.len();
        // Most lines are moves, which a look at their letters shows.
        let may_state = line.bytes().any(|byte| byte.eq_ignore_ascii_case(&b'u'));
        while may_state && let Some(statement) = statements.next().filter(|statement| statement.line == 1) {
            if !["UNIT", "UNITS"].iter().any(|word| statement.word.eq_ignore_ascii_case(word)) {
                continue;
            }
            let fail = |problem: &str, allowed: &str| statement.fail((problem, allowed)).at_line(number);
            let stated = known.iter().find(|(word, _)| statement.has(word)).map(|(_, unit)| *unit);
            let stated = stated.ok_or_else(|| fail(NO_UNIT.0, NO_UNIT.1))?;
            if let Some(unit) = unit.filter(|unit| *unit != stated) {
                let other = if given.is_some() { "--units" } else { "the file before" };
                let problem = format!("is not what {other} says: {}", unit.word());
                return Err(fail(&problem, "one unit of length for the whole file"));
            }
            unit = Some(stated);
        }
    }
    unit.ok_or_else(|| {
        InputError::new(file, "does not state its unit of length (no UNITS/MM or UNITS/INCHES)")
            .in_field("--units")
            .allowed("--units mm or --units inch")
    })
}
