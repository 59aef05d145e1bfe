//! Statements of CLDATA: a word, and behind a slash words and numbers, over one line or several.

use super::dialect::{Dialect, Effect};
use super::told::without_label;
use std::path::Path;
use std::str::Lines;
use stead_disk::input::InputError;

/// A word or number behind the slash: its text, and the number that it is; NaN where it is written so.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Minor<'a> {
    pub text: &'a str,
    pub number: Option<f64>,
}

/// A statement with its line.
#[derive(Debug, Clone)]
pub(super) struct Statement<'a> {
    pub file: &'a Path,
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
        self.minors.iter().filter_map(|minor| minor.number)
    }

    /// Its words, in their order.
    pub fn words(&self) -> impl Iterator<Item = &'a str> {
        self.minors.iter().filter(|minor| minor.number.is_none()).map(|minor| minor.text)
    }

    /// Whether one of its words is this one.
    pub fn has(&self, word: &str) -> bool {
        self.words().any(|own| own.eq_ignore_ascii_case(word))
    }

    /// Its words between commas.
    pub fn worded(&self) -> String {
        self.words().collect::<Vec<_>>().join(",")
    }

    /// What stands behind the slash, as written.
    pub fn text(&self) -> String {
        self.minors.iter().map(|minor| minor.text).collect::<Vec<_>>().join(",")
    }

    /// Its word without the marks of a comment.
    pub fn name(&self) -> &'a str {
        self.word.trim_start_matches(['$', '-', '>', '*'])
    }

    /// That it is wrong.
    pub fn fail(&self, refusal: (impl Into<String>, impl Into<String>)) -> InputError {
        let found = if self.minors.is_empty() { self.name().to_owned() } else { self.text() };
        let error = InputError::new(self.file, refusal.0).at_line(self.line).in_field(self.name());
        error.found(format!("'{found}'")).allowed(refusal.1)
    }

    /// How many numbers it has, for messages.
    pub fn counted(&self) -> String {
        format!("{} numbers that can be read", self.numbers().count())
    }

    /// Adds what stands behind the slash; a dollar sign at its end says that the statement goes on.
    fn take(&mut self, text: &'a str) {
        let text = text.trim_end_matches('$');
        let minors = |text: &'a str| text.split(',').map(str::trim).filter(|text| !text.is_empty()).map(minor);
        if text.contains(['(', ')']) {
            // Geometry within a statement: (CIRCLE/x,y,z,r).
            self.minors.extend(text.split(['(', ')', '/']).flat_map(minors));
        } else {
            self.minors.extend(minors(text));
        }
    }
}

/// Comment lines that hold the rows of a frame, at the most: its name and the three rows.
const FRAME_LINES: usize = 4;

/// The statements of a text in a dialect, whose comments that mean something are statements too.
pub(super) struct Statements<'a> {
    dialect: &'static Dialect,
    lines: Lines<'a>,
    line: usize,
    /// What stands behind a semicolon.
    rest: Option<&'a str>,
    /// The last one that was read.
    pub statement: Statement<'a>,
}

impl<'a> Statements<'a> {
    /// Those from a line on, with which the text begins.
    pub fn new(file: &'a Path, dialect: &'static Dialect, text: &'a str, line: usize) -> Self {
        let statement = Statement { file, line, word: "", minors: Vec::new() };
        Self { dialect, lines: text.lines(), line: line - 1, rest: None, statement }
    }

    fn next_line(&mut self) -> Option<&'a str> {
        let line = self.rest.take().or_else(|| {
            self.line += 1;
            self.lines.next()
        });
        line.map(str::trim)
    }

    /// The next statement.
    pub fn next(&mut self) -> Option<&Statement<'a>> {
        let mut is_continued = false;
        loop {
            let Some(line) = self.next_line() else { return is_continued.then_some(&self.statement) };
            if line.starts_with("$$") {
                if !is_continued && self.comment(line) {
                    return Some(&self.statement);
                }
                continue;
            }
            let mut line = without_comment(if is_continued { line } else { without_label(line) });
            let end = line.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(line.len());
            // Most statements are moves.
            let is_known = is_continued || &line[..end] == "GOTO";
            let is_free = !is_known && self.dialect.effect(&line[..end]) == Some(Effect::Text);
            if let (Some((first, rest)), false) = (line.split_once(';'), is_free) {
                (line, self.rest) = (first.trim(), Some(rest));
            }
            if is_continued {
                self.statement.take(line);
            } else if line.is_empty() {
                continue;
            } else {
                let body = line.trim_end_matches('$');
                let end = if is_free { end } else { body.find(['/', ',']).unwrap_or(body.len()) };
                let (word, behind) = body.split_at(end);
                self.begin(word.trim_end());
                self.statement.take(if is_free { "" } else { behind.trim_start_matches(['/', ',']) });
            }
            if !line.ends_with('$') {
                return Some(&self.statement);
            }
            is_continued = true;
        }
    }

    fn begin(&mut self, word: &'a str) {
        (self.statement.word, self.statement.line) = (word, self.line);
        self.statement.minors.clear();
    }

    /// Takes a comment with the lines that it goes on in; whether it means something.
    fn comment(&mut self, mut line: &'a str) -> bool {
        let known = self.dialect.of_comment(line);
        if let Some((word, effect, rest)) = known {
            self.begin(word);
            if matches!(effect, Effect::Frame(form) if form.is_in_comments_below) {
                self.rows_below();
                return true;
            }
            self.statement.take(rest);
        }
        // A comment may end in a dollar sign: no move is lost to it.
        let is_move = |next: &str| without_label(next.trim()).starts_with("GOTO");
        while line.ends_with('$') && !line.ends_with("$$") && !self.lines.clone().next().is_none_or(is_move) {
            line = without_comment(self.next_line().unwrap_or_default());
            if known.is_some() {
                self.statement.take(line);
            }
        }
        known.is_some()
    }

    /// Takes the comments below with four numbers each.
    fn rows_below(&mut self) {
        for _ in 0..FRAME_LINES {
            let next = self.lines.clone().next().and_then(|line| line.trim().strip_prefix("$$"));
            let Some(row) = next.filter(|row| !row.starts_with('*')) else { return };
            self.next_line();
            let minors = row.split_whitespace().map(minor);
            if minors.clone().count() == 4 && minors.clone().all(|minor| minor.number.is_some()) {
                self.statement.minors.extend(minors);
            }
        }
    }
}

fn without_comment(text: &str) -> &str {
    text.find("$$").map_or(text, |comment| &text[..comment]).trim()
}

fn minor(text: &str) -> Minor<'_> {
    Minor { text, number: text.parse().ok() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_continuations_and_free_text() {
        let text = "$$ a comment\n\nGOTO/1.,-.5, $ \n 3 $$ more\nRAPID\r\nRAPID/\nPPRINT a / b, 'c'\nTOOL PATH/A,TOOL,B\n  FINI";
        let mut statements = Statements::new(Path::new("f"), Dialect::of(text, None), text, 1);
        let mut found = Vec::new();
        while let Some(one) = statements.next() {
            found.push((one.line, one.word.to_owned(), one.text()));
        }
        let expected = [(3, "GOTO", "1.,-.5,3"), (5, "RAPID", ""), (6, "RAPID", ""), (7, "PPRINT", "")];
        let expected = expected.into_iter().chain([(8, "TOOL PATH", "A,TOOL,B"), (9, "FINI", "")]);
        assert!(found.iter().map(|(line, word, text)| (*line, &word[..], &text[..])).eq(expected), "{found:?}");
    }
}
