//! G-code of ISO 6983: straight moves and arcs with up to five axes.
//!
//! What each code does is data (`codes`). Positions are those of the work offset (G54 to G59) as the workpiece frame.
//! Angles of rotary axes are those of a named [`Machine`], along a move in proportion to the way, so moves that turn
//! the tool are taken in small parts.

mod block;
mod codes;
mod comment;
mod machine;
mod motion;
mod reader;

pub(super) use block::foreign;
pub use machine::Machine;

use super::refusals::NOT_A_WORD;
use super::{Program, ReadSettings};
use block::Block;
use codes::Foreign;
use reader::Reader;
use std::path::Path;
use stead_disk::input::InputError;
use stead_disk::quote::shorten;

/// Reads the moves of a G-code program.
///
/// # Errors
/// [`InputError`] with line and word: another language by its name, a code that is not known or that another in the
/// same block or mode contradicts, an arc that misses its end, a unit that is not stated, rotary axes without their
/// machine.
pub fn read(file: &Path, text: &str, settings: &ReadSettings) -> Result<Program, InputError> {
    let is_of_control = |(line, number)| refused(file, line, number, |of| of.is_control);
    // What is refused in a block says less than the control that the program is for.
    blocks(file, text, settings).map_err(|error| text.lines().zip(1..).find_map(is_of_control).unwrap_or(error))
}

/// The refusal of a line of a language that is not read.
fn refused(file: &Path, line: &str, number: usize, is: impl Fn(&Foreign) -> bool) -> Option<InputError> {
    let of = foreign(line).filter(|of| is(of))?;
    let error = InputError::new(file, of.is).at_line(number).found(format!("'{}'", shorten(line)));
    Some(error.allowed(of.allowed))
}

fn blocks(file: &Path, text: &str, settings: &ReadSettings) -> Result<Program, InputError> {
    let mut reader = Reader::new(settings);
    let (mut words, mut last) = (Vec::new(), 1);
    for (line, number) in text.lines().zip(1..) {
        refused(file, line, number, |_| true).map_or(Ok(()), Err)?;
        if let Err(text) = block::words(line, &mut words) {
            let error = InputError::new(file, NOT_A_WORD.0).at_line(number);
            return Err(error.found(format!("'{}'", text.trim())).allowed(NOT_A_WORD.1));
        }
        last = number;
        reader.comment(line, number);
        if !reader.take(&Block { file, line: number, words: &words })? {
            break;
        }
    }
    Ok(reader.finish(last))
}
