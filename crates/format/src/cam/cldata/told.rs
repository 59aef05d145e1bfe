//! The dialect of a CLDATA file, and the rows of its words.

use super::dialect::{COMMON, CamFormat, DIALECTS, Dialect, Effect, Sign};

impl Dialect {
    /// What a word does, if it is known.
    pub fn effect(&self, word: &str) -> Option<Effect> {
        let is_of = |known: &&str| match known.strip_suffix('*') {
            Some(family) => word.get(..family.len()).is_some_and(|start| start.eq_ignore_ascii_case(family)),
            None => known.eq_ignore_ascii_case(word),
        };
        let own = self.words.iter().find(|(known, _)| is_of(known)).map(|(_, effect)| *effect);
        own.or_else(|| COMMON.iter().find(|(_, words)| words.iter().any(&is_of)).map(|(effect, _)| *effect))
    }

    /// The word of a comment that means something, what it does, and what stands behind it.
    pub fn of_comment<'a>(&self, comment: &'a str) -> Option<(&'static str, Effect, &'a str)> {
        let (head, rest) = comment.split_once('/').unwrap_or((comment, ""));
        let mut own = self.words.iter().filter(|(word, _)| word.starts_with("$$"));
        own.find(|(word, _)| is_same(head, word)).map(|(word, effect)| (*word, *effect, rest))
    }

    /// The dialect of a format, or the one that a text is told to be of.
    pub fn of(text: &str, format: Option<CamFormat>) -> &'static Self {
        // Most lines are moves, and no sign is one.
        let lines = text.lines().map(str::trim_start).filter(|line| !line.starts_with("GOTO")).map(without_label);
        let lines: Vec<&str> = lines.collect();
        let is_told = |dialect: &&Self| lines.iter().any(|line| dialect.told_by.iter().any(|sign| sign.is_in(line)));
        let stated = DIALECTS.iter().find(|dialect| Some(dialect.format) == format);
        stated.or_else(|| DIALECTS.iter().find(is_told)).unwrap_or(&DIALECTS[DIALECTS.len() - 1])
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

/// What a word does in any dialect.
fn of_any(word: &str) -> Option<Effect> {
    DIALECTS.iter().find_map(|dialect| dialect.effect(word))
}

/// A word of a statement, and whether a slash is behind it.
fn head(line: &str) -> (&str, bool) {
    let line = without_label(line.trim());
    let end = line.find(['/', ',']).unwrap_or(line.len());
    (line[..end].trim_end(), line[end..].starts_with('/'))
}

/// Whether a line has a known word with a slash behind it, or what only CLDATA has.
pub(crate) fn has_word(line: &str) -> bool {
    let (word, is_slashed) = head(line);
    let begins = |text: &str| word.get(..text.len()).is_some_and(|start| start.eq_ignore_ascii_case(text));
    (is_slashed && of_any(word).is_some()) || begins("PARTNO") || begins("$$->")
}

/// Whether a line reads as a statement of CLDATA, where the file is that or G-code.
pub(crate) fn is_statement(line: &str) -> bool {
    let (word, is_slashed) = head(line);
    let is_word = word.len() > 1 && word.starts_with(|c: char| c.is_ascii_alphabetic());
    let is_plain = || word.chars().all(|c| c.is_ascii_alphanumeric() || " _-".contains(c));
    let is_known = || of_any(word).is_some_and(|effect| !matches!(effect, Effect::Refused(_)));
    let is_text = || word.split_whitespace().next().and_then(of_any) == Some(Effect::Text);
    word.starts_with("$$") || (is_word && (is_known() || is_text() || (is_slashed && is_plain())))
}

/// A statement without the label before it, as in `A1) GOTO/1,2,3`.
pub(crate) fn without_label(text: &str) -> &str {
    let end = text.find(')').unwrap_or(0);
    let is_label = end > 0 && text.as_bytes()[..end].iter().all(u8::is_ascii_alphanumeric);
    if is_label { text[end + 1..].trim_start() } else { text }
}
