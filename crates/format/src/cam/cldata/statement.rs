//! Statements of CLDATA: a word, and behind a slash words and numbers, over one line or several.

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

/// Words whose statement is free text.
const FREE_TEXT: [&str; 5] = ["PARTNO", "PPRINT", "INSERT", "REMARK", "TPRINT"];

/// The statements of a text.
pub(super) struct Statements<'a> {
    lines: Lines<'a>,
    line: usize,
    /// What stands behind a semicolon.
    rest: Option<&'a str>,
}

impl<'a> Statements<'a> {
    pub fn new(text: &'a str) -> Self {
        Self { lines: text.lines(), line: 0, rest: None }
    }

    /// The rest of a line behind a semicolon, or the next line, without comment.
    fn next_part(&mut self) -> Option<&'a str> {
        if let Some(rest) = self.rest.take() {
            return Some(rest.trim());
        }
        let line = self.lines.next()?;
        self.line += 1;
        Some(line.find("$$").map_or(line, |comment| &line[..comment]).trim())
    }

    /// Reads the next statement into one that is used again; whether there was one.
    pub fn next_into(&mut self, statement: &mut Statement<'a>) -> bool {
        statement.minors.clear();
        let mut is_continued = false;
        while let Some(line) = self.next_part() {
            let line = if is_continued { line } else { without_label(line) };
            let is_free = !is_continued && is_free_text(line);
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
                let end = body.find(['/', ',']).unwrap_or(body.len());
                let free = is_free;
                let end = if free { body.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(body.len()) } else { end };
                statement.word = body[..end].trim_end();
                statement.line = self.line;
                rest = if free { "" } else { body[end..].trim_start_matches(['/', ',']) };
            }
            statement.minors.extend(rest.split(',').map(str::trim).filter(|text| !text.is_empty()).map(minor));
            if !goes_on {
                return true;
            }
            is_continued = true;
        }
        is_continued
    }
}

fn is_free_text(text: &str) -> bool {
    FREE_TEXT.iter().any(|word| starts_with(text, word))
}

/// A statement without the label before it, as in `A1) GOTO/1,2,3`.
fn without_label(text: &str) -> &str {
    match text.split_once(')') {
        Some((label, rest)) if !label.is_empty() && label.chars().all(|c| c.is_ascii_alphanumeric()) => {
            rest.trim_start()
        }
        _ => text,
    }
}

fn starts_with(text: &str, word: &str) -> bool {
    text.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word))
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
        let mut statements = Statements::new(text);
        let (mut one, mut found) = (Statement::default(), Vec::new());
        while statements.next_into(&mut one) {
            found.push((one.line, one.word.to_owned(), one.text()));
        }
        let expected = [(3, "GOTO", "1.,-.5,3"), (5, "RAPID", ""), (6, "RAPID", ""), (7, "PPRINT", "")];
        let expected = expected.into_iter().chain([(8, "TOOL PATH", "A,TOOL,B"), (9, "FINI", "")]);
        assert!(found.iter().map(|(line, word, text)| (*line, &word[..], &text[..])).eq(expected), "{found:?}");
    }
}
