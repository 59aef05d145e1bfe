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

use super::refusals::{NO_UNIT, another_unit};
use super::{LengthUnit, Program, ReadSettings};
use dialect::{Dialect, Effect, UNITS};
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
    let mut statements = Statements::new(file, dialect, text, 1);
    while let Some(statement) = statements.next() {
        if !reader.take(statement)? {
            break;
        }
    }
    reader.finish(&statements.statement)
}

/// The unit that a file states, or the one given for a file that does not.
fn unit_of(
    file: &Path,
    dialect: &'static Dialect,
    text: &str,
    given: Option<LengthUnit>,
) -> Result<LengthUnit, InputError> {
    let (mut unit, mut at) = (given, 0);
    for (line, number) in text.split_inclusive('\n').zip(1..) {
        let mut statements = Statements::new(file, dialect, &text[at..], number);
        at += line.len();
        // Most lines are moves, which a look at their letters shows.
        let may_state = line.bytes().any(|byte| byte.eq_ignore_ascii_case(&b'u'));
        while may_state && let Some(statement) = statements.next().filter(|statement| statement.line == number) {
            if dialect.effect(statement.word) == Some(Effect::Unit) {
                let stated =
                    UNITS.iter().find(|(word, _)| statement.has(word)).ok_or_else(|| statement.fail(NO_UNIT))?;
                let unit = *unit.get_or_insert(stated.1);
                ensure!(unit == stated.1, statement.fail(another_unit(given.is_some(), unit.word())));
            }
        }
    }
    unit.ok_or_else(|| {
        InputError::new(file, "does not state its unit of length (no UNITS/MM or UNITS/INCHES)")
            .in_field("--units")
            .allowed("--units mm or --units inch")
    })
}
