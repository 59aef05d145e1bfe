//! The dialect of a CLDATA file, and the rows of its words.

use super::super::CamFormat;
use super::dialect::{COMMON, DIALECTS, Dialect, Effect, Sign};
use super::statement::without_label;

impl Dialect {
    /// What a word does, if it's known.
    pub fn effect(&self, word: &str) -> Option<Effect> {
        let is_of = |row: &&(&str, Effect)| match row.0.strip_suffix('*') {
            Some(family) => word.get(..family.len()).is_some_and(|start| start.eq_ignore_ascii_case(family)),
            None => row.0.eq_ignore_ascii_case(word),
        };
        let own = self.words.iter().find(is_of);
        own.or_else(|| COMMON.iter().find(is_of)).map(|(_, effect)| *effect)
    }

    /// The word of a comment that means something, and what stands behind it.
    pub fn of_comment<'a>(&self, comment: &'a str) -> Option<(&'static str, Effect, &'a str)> {
        let (head, rest) = comment.split_once('/').unwrap_or((comment, ""));
        let own = self.words.iter().filter(|(word, _)| word.starts_with("$$"));
        own.filter(|(word, _)| is_same(head, word)).map(|(word, effect)| (*word, *effect, rest)).next()
    }

    /// The dialect of a format, or the one that a text is told to be of.
    pub fn of(text: &str, format: Option<CamFormat>) -> &'static Self {
        let stated = format.and_then(|format| DIALECTS.iter().find(|dialect| dialect.format == format));
        let mut found = DIALECTS.len() - 1;
        if stated.is_none() {
            for line in text.lines() {
                let line = line.trim_start();
                // Most lines are moves, and no sign is one.
                if !line.starts_with("GOTO") {
                    let line = without_label(line);
                    let told = |dialect: &Dialect| dialect.told_by.iter().any(|sign| sign.is_in(line));
                    found = DIALECTS[..found].iter().position(told).unwrap_or(found);
                }
            }
        }
        stated.unwrap_or(&DIALECTS[found])
    }
}

impl Sign {
    fn is_in(self, line: &str) -> bool {
        match self {
            Self::Begins(text) => after(line, text).is_some(),
            Self::Is(text) => is_same(line, text),
            Self::Comment(text) => {
                line.starts_with("$$") && line.to_ascii_uppercase().contains(&text.to_ascii_uppercase())
            }
        }
    }
}

/// What stands behind a text at the start of a line, without blanks.
fn after<'a>(line: &'a str, text: &str) -> Option<impl Iterator<Item = char> + use<'a>> {
    let mut own = line.chars().filter(|c| !c.is_whitespace());
    let is_start = text.chars().filter(|c| *c != ' ').all(|c| own.next().is_some_and(|o| o.eq_ignore_ascii_case(&c)));
    is_start.then_some(own)
}

/// Whether a line is a text, whatever blanks and letter case.
fn is_same(line: &str, text: &str) -> bool {
    after(line, text).is_some_and(|mut rest| rest.next().is_none())
}

/// Whether a line reads as a statement of CLDATA.
pub(crate) fn is_statement(line: &str) -> bool {
    let line = without_label(line.trim());
    let (head, is_slashed) = match line.find(['/', ',']) {
        Some(end) => (line[..end].trim_end(), line[end..].starts_with('/')),
        None => (line, false),
    };
    let is_word = head.len() > 1 && head.starts_with(|c: char| c.is_ascii_alphabetic());
    let is_known = |word: &str| {
        DIALECTS
            .iter()
            .find_map(|dialect| dialect.effect(word))
            .is_some_and(|effect| !matches!(effect, Effect::Refused(_)))
    };
    let first = head.split_whitespace().next().unwrap_or_default();
    line.starts_with("$$")
        || (is_word && is_slashed && head.chars().all(|c| c.is_ascii_alphanumeric() || " _-".contains(c)))
        || (is_word && is_known(head))
        || ["PARTNO", "PPRINT"].iter().any(|word| first.eq_ignore_ascii_case(word))
}

/// Whether a line begins with a label.
pub(crate) fn is_labelled(line: &str) -> bool {
    without_label(line).len() < line.len()
}
