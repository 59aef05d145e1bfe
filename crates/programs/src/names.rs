//! Texts that come from a user, as names, comments and statements of a program: none of them may break out of its
//! place.

use super::{ProgramError, ProgramFormat};

/// The longest name of a program and, where older controllers take less, the longest that they take.
///
/// KUKA: 24 characters (KUKA, Quickguide KRL-Syntax, KSS 8.x, "Names in KRL"). ABB: 32, and 16 before IRC5; Fanuc: 36,
/// and 8 before R-30iA: both as users remember them, found in no source that could be read.
fn limits(format: ProgramFormat) -> (usize, Option<usize>) {
    match format {
        ProgramFormat::Krl => (24, None),
        ProgramFormat::Rapid => (32, Some(16)),
        ProgramFormat::Fanuc => (36, Some(8)),
        ProgramFormat::Csv => (64, None),
    }
}

/// Words that cannot name a program: those of the languages that look like one.
const RESERVED: [&str; 30] = [
    "AND", "BAS", "CASE", "CIRC", "CONST", "DEF", "DEFDAT", "DEFFCT", "DO", "ELSE", "END", "ENDDAT", "ENDFOR", "EXIT",
    "FOR", "GOTO", "HALT", "IF", "LIN", "LOOP", "MAIN", "MODULE", "NOT", "OR", "PERS", "PROC", "PTP", "THEN", "WAIT",
    "WHILE",
];

/// Checks the name of a program with so many parts. Returns a note where older controllers do not take it.
///
/// # Errors
/// [`ProgramError::Name`] for a name that the controller does not take.
pub(super) fn check(name: &str, format: ProgramFormat, parts: usize) -> Result<Option<String>, ProgramError> {
    let (longest, older) = limits(format);
    // ABB's names of modules stand beside those of procedures and begin with two more characters.
    let added = match format {
        ProgramFormat::Csv => 0,
        ProgramFormat::Rapid => part(parts).len() + MODULE.len(),
        _ => part(parts).len(),
    };
    let max = longest - added;
    let wrong = |problem: String| {
        let allowed = format!("up to {max} letters, digits and _, the first a letter, and no word of the language");
        Err(ProgramError::Name { name: quoted(name), problem, allowed })
    };
    if !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return wrong("has other characters in it than letters, digits and _".to_owned());
    }
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        return wrong("does not begin with a letter".to_owned());
    }
    if name.len() > max {
        let of_part = if added > 0 { ", with the number of a part behind it" } else { "" };
        return wrong(format!("is {} characters long, more than the controller takes{of_part}", name.len()));
    }
    if RESERVED.contains(&name.to_ascii_uppercase().as_str()) {
        return wrong("is a word of the language".to_owned());
    }
    let is_long = |older: &usize| name.len() + added > *older;
    Ok(older.filter(is_long).map(|older| format!("controllers of older make take names of at most {older} characters")))
}

/// What stands before the name of a RAPID module.
pub(super) const MODULE: &str = "M_";

/// What stands behind the name in that of a part, from 1.
pub(super) fn part(number: usize) -> String {
    format!("_{number:02}")
}

/// A text for a comment: printable ASCII on one line, at most so long.
pub(super) fn comment(text: &str, longest: usize) -> String {
    text.chars().map(|c| if c == ' ' || c.is_ascii_graphic() { c } else { '?' }).take(longest).collect()
}

/// A text in quotes for a message.
fn quoted(text: &str) -> String {
    let shown: String = text.chars().take(80).flat_map(char::escape_debug).collect();
    format!("'{shown}'")
}

/// The longest statement that is taken.
const LONGEST_STATEMENT: usize = 120;

/// Checks a statement of the user's own, which is written as it is.
///
/// # Errors
/// [`ProgramError::Argument`] unless it is one line of printable ASCII, for Fanuc without a semicolon, which would end
/// it.
pub(super) fn statement(option: &'static str, text: &str, format: ProgramFormat) -> Result<String, ProgramError> {
    let is_plain = text.chars().all(|c| c == ' ' || c.is_ascii_graphic());
    let ends_it = format == ProgramFormat::Fanuc && text.contains(';');
    let text = text.trim();
    if !is_plain || ends_it || text.is_empty() || text.len() > LONGEST_STATEMENT {
        let rule = if format == ProgramFormat::Fanuc { ", without a semicolon" } else { "" };
        return Err(ProgramError::Argument {
            option,
            problem: format!("is no statement that is taken, found {}", quoted(text)),
            allowed: format!("a statement on one line of up to {LONGEST_STATEMENT} printable ASCII characters{rule}"),
        });
    }
    Ok(text.to_owned())
}

/// A number with so many decimals, zero without a sign.
pub(super) fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    if is_zero { text.trim_start_matches('-').to_owned() } else { text }
}
