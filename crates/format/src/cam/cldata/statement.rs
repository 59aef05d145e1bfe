//! Statements of CLDATA: a word, and behind a slash words and numbers, over one line or several.

use super::dialect::{Dialect, Effect, FrameForm};
use std::str::Lines;

/// A word or number behind the slash.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Minor<'a> {
    /// A number as it is read, with its text; NaN where it is written so.
    Number(f64, &'a str),
    /// Anything else.
    Word(&'a str),
}

/// A statement with its line.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Statement<'a> {
    /// Line of its first word, from 1.
    pub line: usize,
    /// Its word as written.
    pub word: &'a str,
    /// What stands behind the slash.
    pub minors: Vec<Minor<'a>>,
}

impl<'a> Statement<'a> {
    /// Its numbers, in their order.
    pub fn numbers(&self) -> impl Iterator<Item = f64> + Clone {
        self.minors.iter().filter_map(|minor| match minor {
            Minor::Number(value, _) => Some(*value),
            Minor::Word(_) => None,
        })
    }

    /// Its words, in their order.
    pub fn words(&self) -> impl Iterator<Item = &'a str> {
        self.minors.iter().filter_map(|minor| match minor {
            Minor::Word(word) => Some(*word),
            Minor::Number(..) => None,
        })
    }

    /// Whether one of its words is this one.
    pub fn has(&self, word: &str) -> bool {
        self.words().any(|own| own.eq_ignore_ascii_case(word))
    }

    /// Adds what stands behind the slash.
    fn take(&mut self, text: &'a str) {
        let texts = |text: &'a str| text.split(',').map(str::trim).filter(|text| !text.is_empty()).map(minor);
        if text.contains(['(', ')']) {
            // Geometry within a statement: (CIRCLE/x,y,z,r).
            self.minors.extend(text.split(['(', ')', '/']).flat_map(texts));
        } else {
            self.minors.extend(texts(text));
        }
    }

    /// What stands behind the slash, as written.
    pub fn text(&self) -> String {
        let texts: Vec<&str> = self
            .minors
            .iter()
            .map(|minor| match minor {
                Minor::Number(_, text) | Minor::Word(text) => *text,
            })
            .collect();
        texts.join(",")
    }
}

/// Comment lines that hold the rows of a frame, at the most: its name and the three rows.
const FRAME_LINES: usize = 4;

/// The statements of a text, in a dialect, whose comments that mean something are statements too.
pub(super) struct Statements<'a> {
    dialect: &'static Dialect,
    lines: Lines<'a>,
    line: usize,
    /// What stands behind a semicolon.
    rest: Option<&'a str>,
}

impl<'a> Statements<'a> {
    pub fn new(dialect: &'static Dialect, text: &'a str) -> Self {
        Self { dialect, lines: text.lines(), line: 0, rest: None }
    }

    fn next_line(&mut self) -> Option<&'a str> {
        let line = self.lines.next()?;
        self.line += 1;
        Some(line.trim())
    }

    /// Reads the next statement into one that is used again; whether there was one.
    pub fn next_into(&mut self, statement: &mut Statement<'a>) -> bool {
        statement.minors.clear();
        let mut is_continued = false;
        loop {
            let line = match self.rest.take() {
                Some(rest) => rest.trim(),
                None => match self.next_line() {
                    Some(line) => line,
                    None => return is_continued,
                },
            };
            if line.starts_with("$$") {
                if !is_continued && self.comment(line, statement) {
                    return true;
                }
                continue;
            }
            let line = line.find("$$").map_or(line, |comment| line[..comment].trim());
            let line = if is_continued { line } else { without_label(line) };
            let is_free = !is_continued && self.is_free_text(line);
            let line = match line.split_once(';') {
                Some((first, rest)) if !is_free => {
                    self.rest = Some(rest);
                    first.trim()
                }
                _ => line,
            };
            let (body, goes_on) = match line.strip_suffix('$') {
                Some(body) => (body.trim_end(), true),
                None => (line, false),
            };
            if body.is_empty() && !goes_on && !is_continued {
                continue;
            }
            let mut rest = body;
            if !is_continued {
                let end = match is_free {
                    true => body.find(|c: char| !is_of_word(c)).unwrap_or(body.len()),
                    false => body.find(['/', ',']).unwrap_or(body.len()),
                };
                statement.word = body[..end].trim_end();
                statement.line = self.line;
                rest = if is_free { "" } else { body[end..].trim_start_matches(['/', ',']) };
            }
            statement.take(rest);
            if !goes_on {
                return true;
            }
            is_continued = true;
        }
    }

    /// Takes a comment with the lines that it goes on in; whether it means something.
    fn comment(&mut self, mut line: &'a str, statement: &mut Statement<'a>) -> bool {
        let known = self.dialect.of_comment(line);
        statement.line = self.line;
        if let Some((word, effect, rest)) = known {
            statement.word = word;
            if effect == Effect::Frame(FrameForm::RowsBelow) {
                self.rows_below(statement);
                return true;
            }
            statement.take(rest.trim_end_matches('$'));
        }
        while line.ends_with('$') && !line.ends_with("$$") {
            // A comment may end in a dollar sign: no move is lost to it.
            let is_move = |next: &str| without_label(next.trim()).starts_with("GOTO");
            if self.lines.clone().next().is_none_or(is_move) {
                break;
            }
            let next = self.next_line().unwrap_or_default();
            line = next.find("$$").map_or(next, |comment| next[..comment].trim_end());
            if known.is_some() {
                statement.take(line.trim_end_matches('$'));
            }
        }
        known.is_some()
    }

    /// Takes the comments below with four numbers each.
    fn rows_below(&mut self, statement: &mut Statement<'a>) {
        for _ in 0..FRAME_LINES {
            let next = self.lines.clone().next().and_then(|line| line.trim().strip_prefix("$$"));
            let Some(row) = next.filter(|row| !row.starts_with('*')) else { return };
            self.next_line();
            let numbers = || row.split_whitespace().map(minor);
            if numbers().count() == 4 && numbers().all(|minor| matches!(minor, Minor::Number(..))) {
                statement.minors.extend(numbers());
            }
        }
    }

    fn is_free_text(&self, text: &str) -> bool {
        // Most statements are moves.
        let word = &text[..text.find(|c: char| !is_of_word(c)).unwrap_or(text.len())];
        word != "GOTO" && self.dialect.effect(word) == Some(Effect::Text)
    }
}

fn is_of_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// A statement without the label before it, as in `A1) GOTO/1,2,3`.
pub(super) fn without_label(text: &str) -> &str {
    match text.find(')') {
        Some(end) if end > 0 && text.as_bytes()[..end].iter().all(u8::is_ascii_alphanumeric) => {
            text[end + 1..].trim_start()
        }
        _ => text,
    }
}

fn minor(text: &str) -> Minor<'_> {
    match text.parse::<f64>() {
        Ok(value) => Minor::Number(value, text),
        Err(_) => Minor::Word(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_continuations_and_free_text() {
        let text = "$$ a comment\n\nGOTO/1.,-.5, $ \n 3 $$ more\nRAPID\r\nRAPID/\nPPRINT a / b, 'c'\nTOOL PATH/A,TOOL,B\n  FINI";
        let mut statements = Statements::new(Dialect::of(text, None), text);
        let (mut one, mut found) = (Statement::default(), Vec::new());
        while statements.next_into(&mut one) {
            found.push((one.line, one.word.to_owned(), one.text()));
        }
        let expected = [(3, "GOTO", "1.,-.5,3"), (5, "RAPID", ""), (6, "RAPID", ""), (7, "PPRINT", "")];
        let expected = expected.into_iter().chain([(8, "TOOL PATH", "A,TOOL,B"), (9, "FINI", "")]);
        assert!(found.iter().map(|(line, word, text)| (*line, &word[..], &text[..])).eq(expected), "{found:?}");
    }
}
