//! The dialect of a CLDATA file, and the rows of its words.

use super::dialect::{COMMON, CamFormat, DIALECTS, Dialect, Effect, Sign};
use super::statement::without_label;

impl CamFormat {
    /// Its name as an option has it.
    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, format)| *format == self).map_or("", |(word, _)| word)
    }
}

impl Dialect {
    /// What a word does, if it is known.
    pub fn effect(&self, word: &str) -> Option<Effect> {
        let is_of = |row: &&(&str, Effect)| match row.0.strip_suffix('*') {
            Some(family) => word.get(..family.len()).is_some_and(|start| start.eq_ignore_ascii_case(family)),
            None => row.0.eq_ignore_ascii_case(word),
        };
        let own = self.words.iter().find(is_of);
        own.or_else(|| COMMON.iter().find(is_of)).map(|(_, effect)| *effect)
    }

    /// The word of a comment that means something, what it does, and what stands behind it.
    pub fn of_comment<'a>(&self, comment: &'a str) -> Option<(&'static str, Effect, &'a str)> {
        let (head, rest) = comment.split_once('/').unwrap_or((comment, ""));
        let mut own = self.words.iter().filter(|(word, _)| word.starts_with("$$"));
        own.find(|(word, _)| is_same(head, word)).map(|(word, effect)| (*word, *effect, rest))
    }

    /// The dialect of a format, or the one that a text is told to be of.
    pub fn of(text: &str, format: Option<CamFormat>) -> &'static Self {
        if let Some(stated) = DIALECTS.iter().find(|dialect| Some(dialect.format) == format) {
            return stated;
        }
        // Most lines are moves, and no sign is one.
        let lines = text.lines().map(str::trim_start).filter(|line| !line.starts_with("GOTO")).map(without_label);
        let found = lines.fold(DIALECTS.len() - 1, |found, line| {
            let told = |dialect: &Dialect| dialect.told_by.iter().any(|sign| sign.is_in(line));
            DIALECTS[..found].iter().position(told).unwrap_or(found)
        });
        &DIALECTS[found]
    }
}

impl Sign {
    fn is_in(self, line: &str) -> bool {
        match self {
            Self::Begins(text) => after(line, text).is_some(),
            Self::Is(text) => is_same(line, text),
            Self::Comment(text) => line.starts_with("$$") && line.to_ascii_uppercase().contains(text),
        }
    }
}

/// What stands behind a text at the start of a line, whatever blanks and letter case.
fn after<'a>(line: &'a str, text: &str) -> Option<impl Iterator<Item = char> + use<'a>> {
    let mut own = line.chars().filter(|c| !c.is_whitespace());
    let is_start = text.chars().filter(|c| *c != ' ').all(|c| own.next().is_some_and(|o| o.eq_ignore_ascii_case(&c)));
    is_start.then_some(own)
}

fn is_same(line: &str, text: &str) -> bool {
    after(line, text).is_some_and(|mut rest| rest.next().is_none())
}

/// Whether a line reads as a statement of CLDATA.
pub(crate) fn is_statement(line: &str) -> bool {
    let line = without_label(line.trim());
    let end = line.find(['/', ',']).unwrap_or(line.len());
    let (head, is_slashed) = (line[..end].trim_end(), line[end..].starts_with('/'));
    let is_word = head.len() > 1 && head.starts_with(|c: char| c.is_ascii_alphabetic());
    let of = |word: &str| DIALECTS.iter().find_map(|dialect| dialect.effect(word));
    let first = head.split_whitespace().next().unwrap_or_default();
    line.starts_with("$$")
        || (is_word && is_slashed && head.chars().all(|c| c.is_ascii_alphanumeric() || " _-".contains(c)))
        || (is_word && of(head).is_some_and(|effect| !matches!(effect, Effect::Refused(_))))
        || (is_word && of(first) == Some(Effect::Text))
}
