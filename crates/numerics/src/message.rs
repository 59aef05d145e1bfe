//! What a job has to say about its result beside the numbers.

use serde::Serialize;
use std::borrow::Borrow;
use std::fmt;
use std::ops::Deref;

/// A reason why a result may not be what was wanted, though the job has not failed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Warning {
    /// What it is about, for programs: the same for all warnings of a kind, in kebab case.
    pub kind: &'static str,
    /// A sentence for people, without a full stop.
    pub message: String,
}

impl Warning {
    /// A warning of a kind.
    pub fn new(kind: &'static str, message: impl Into<String>) -> Self {
        Self { kind, message: message.into() }
    }

    /// That the caller's stop left something out, with its verb.
    pub fn left_out(what: &str) -> Self {
        Self::new("interrupted", format!("interrupted: {what} left out"))
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// What a note is about, in the order in which a summary says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum NoteGroup {
    /// What the result rests on that nobody has measured: guesses, borrowed numbers, published ones.
    RestsOn,
    /// What was not looked at.
    NotChecked,
    /// What looks like a mistake in the input.
    MayBeWrong,
    /// How it was computed.
    Computed,
}

/// What should be known about a result though nothing is wrong with it: a sentence for people, without a full stop. It
/// reads as its text, and documents have that alone.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(into = "String")]
pub struct Note {
    group: NoteGroup,
    short: String,
    text: String,
}

impl Note {
    /// A note of a group, with its few words for a summary.
    pub fn new(group: NoteGroup, short: impl Into<String>, text: impl Into<String>) -> Self {
        Self { group, short: short.into(), text: text.into() }
    }

    /// What the result rests on.
    pub fn rests_on(short: impl Into<String>, text: impl Into<String>) -> Self {
        Self::new(NoteGroup::RestsOn, short, text)
    }

    /// What was not looked at.
    pub fn not_checked(short: impl Into<String>, text: impl Into<String>) -> Self {
        Self::new(NoteGroup::NotChecked, short, text)
    }

    /// What looks like a mistake, which has no other words than its text.
    pub fn may_be_wrong(text: impl Into<String>) -> Self {
        Self::new(NoteGroup::MayBeWrong, String::new(), text)
    }

    /// What it is about.
    pub fn group(&self) -> NoteGroup {
        self.group
    }

    /// The few words of the notes of a group, each once, in the order of the notes.
    pub fn shorts(notes: &[Self], group: NoteGroup) -> Vec<&str> {
        let mut words: Vec<&str> = Vec::new();
        for note in notes.iter().filter(|note| note.group == group) {
            if !words.contains(&&*note.short) {
                words.push(&note.short);
            }
        }
        words
    }
}

/// A note on how a result was computed.
impl From<String> for Note {
    fn from(text: String) -> Self {
        Self::new(NoteGroup::Computed, String::new(), text)
    }
}

impl From<Note> for String {
    fn from(note: Note) -> Self {
        note.text
    }
}

impl Borrow<str> for Note {
    fn borrow(&self) -> &str {
        &self.text
    }
}

impl PartialEq<&str> for Note {
    fn eq(&self, text: &&str) -> bool {
        self.text == *text
    }
}

impl Deref for Note {
    type Target = str;

    fn deref(&self) -> &str {
        &self.text
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_of_a_group_are_said_once_in_few_words() {
        let note = |short: &str| Note::rests_on(short, "a sentence");
        let notes =
            [note("guesses: cell"), note("borrowed"), note("borrowed"), Note::not_checked("collisions", "none")];
        assert_eq!(Note::shorts(&notes, NoteGroup::RestsOn), ["guesses: cell", "borrowed"]);
        assert_eq!(Note::shorts(&notes, NoteGroup::NotChecked), ["collisions"]);
    }
}
