//! Blocks of G-code: letters with numbers, comments left out; and programs that are something else by their name.

use super::codes::{FOREIGN, Foreign};
use std::path::Path;
use stead_disk::input::InputError;

/// A letter, in upper case, with its number.
pub(super) type Word = (char, f64);

/// One block.
pub(super) struct Block<'a> {
    pub file: &'a Path,
    pub line: usize,
    pub words: &'a [Word],
}

impl Block<'_> {
    /// The number of a letter, where the block has it.
    pub fn get(&self, letter: char) -> Option<f64> {
        self.words.iter().find(|(own, _)| *own == letter).map(|(_, value)| *value)
    }

    /// Whether it has one of some letters.
    pub fn has(&self, letters: &str) -> bool {
        self.words.iter().any(|(letter, _)| letters.contains(*letter))
    }

    /// The first of its words with one of these letters.
    pub fn first(&self, letters: &str) -> Word {
        self.words.iter().find(|(letter, _)| letters.contains(*letter)).copied().unwrap_or(('G', 2.0))
    }

    /// That the first of its words with one of these letters is wrong.
    pub fn fail_at(&self, letters: &str, refusal: (impl Into<String>, &str)) -> InputError {
        self.fail(self.first(letters), refusal)
    }

    /// That one of its words is wrong.
    pub fn fail(&self, word: Word, refusal: (impl Into<String>, &str)) -> InputError {
        let error = InputError::new(self.file, refusal.0).at_line(self.line).in_field(word.0.to_string());
        error.found(format!("'{}{}'", word.0, word.1)).allowed(refusal.1)
    }
}

/// The words of a line, or the text that is none of them.
pub(super) fn words<'a>(line: &'a str, words: &mut Vec<Word>) -> Result<(), &'a str> {
    words.clear();
    let mut rest = line.trim_start();
    loop {
        rest = rest.trim_start_matches([' ', '\t', '\r']);
        let Some(letter) = rest.chars().next() else { return Ok(()) };
        match letter {
            ';' | '%' => return Ok(()),
            '/' if words.is_empty() => rest = &rest[1..],
            '(' => match rest.find(')') {
                Some(end) => rest = &rest[end + 1..],
                None => return Err(rest),
            },
            _ if letter.is_ascii_alphabetic() => {
                let behind = rest[1..].trim_start_matches([' ', '\t']);
                let length = behind.find(|c: char| !(c.is_ascii_digit() || "+-.".contains(c))).unwrap_or(behind.len());
                let value = behind[..length].parse().map_err(|_| rest)?;
                words.push((letter.to_ascii_uppercase(), value));
                rest = &behind[length..];
            }
            _ => return Err(rest),
        }
    }
}

/// What a line is of, where that is a language which is not read.
pub(crate) fn foreign(line: &str) -> Option<&'static Foreign> {
    let line = line.trim().trim_start_matches('/').to_ascii_uppercase();
    let body = line.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start();
    let code = line.split(['(', ';']).next().unwrap_or_default();
    let code = code.trim_start_matches('N').trim_start_matches(|c: char| c.is_ascii_digit()).trim_start();
    let begins = |of: &&Foreign| of.names.iter().any(|name| body.starts_with(name) || code.starts_with(name));
    let [heidenhain, .., o_words, variables] = &FOREIGN;
    let is_numbered = body.len() < line.len();
    if is_numbered && ["L ", "CC ", "C ", "CR "].iter().any(|word| body.starts_with(word)) {
        return Some(heidenhain);
    }
    let has = |words: &[&str]| words.iter().any(|word| code.contains(word));
    if code.starts_with('O') && has(&["SUB", "IF", "WHILE", "DO", "CALL", "REPEAT", "ELSE", "END"]) {
        return Some(o_words);
    }
    FOREIGN.iter().find(begins).or_else(|| has(&["#", "="]).then_some(variables))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_with_and_without_spaces_and_comments() {
        let mut found = Vec::new();
        assert_eq!(words("/N10 G01X-1.5 y .5(a comment)F 250. ; more", &mut found), Ok(()));
        assert_eq!(found, [('N', 10.0), ('G', 1.0), ('X', -1.5), ('Y', 0.5), ('F', 250.0)]);
        assert_eq!(words("%", &mut found), Ok(()));
        assert_eq!(words("X1 Ynan", &mut found), Err("Ynan"));
        assert_eq!(words("X1 (open", &mut found), Err("(open"));
        assert_eq!(words("X1 ü", &mut found), Err("ü"));
    }

    #[test]
    fn other_languages_by_name() {
        for (line, name) in [
            ("CYCLE800(1,\"TC1\",0,57,0,0,0,30,0,0,0)", Some("a tilted plane of a Siemens or Heidenhain control")),
            ("PLANE SPATIAL SPA+0 SPB+30 SPC+0 STAY", Some("a tilted plane of a Siemens or Heidenhain control")),
            ("N20 TRAORI", Some("five axes of a Siemens control")),
            ("0 BEGIN PGM PART MM", Some("Heidenhain conversational")),
            ("7 L X+10 Y+5 R0 FMAX", Some("Heidenhain conversational")),
            ("CYCL DEF 32.0 TOLERANCE", Some("Heidenhain conversational")),
            ("#100 = 3", Some("a macro program (variables)")),
            ("N5 G1 X#1", Some("a macro program (variables)")),
            ("IF [1 EQ 1] GOTO 5", Some("a macro program (control words)")),
            ("O100 while [1 LT 2]", Some("a macro program (O-words)")),
            ("O1234 (PART)", None),
            ("N10 G1 X5 (IF = #)", None),
        ] {
            let found = foreign(line).map(|of| of.is.rsplit_once(" not read").unwrap().0);
            let found = found.map(|is| is.trim_end_matches(" is").trim_end_matches(" are"));
            assert_eq!(found, name, "{line}");
        }
    }
}
