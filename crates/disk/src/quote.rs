//! Pieces of input files as messages quote them, and names as they may be.

/// Longest piece of a file that is quoted in a message, in characters.
const QUOTE: usize = 80;

/// A piece of a file on one line, cut where it is long.
pub fn shorten(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(QUOTE) {
        Some((end, _)) => format!("{}...", &line[..end]),
        None => line,
    }
}

/// What is refused in a text of a file.
pub const GARBLED: &str = "holds a control character or a mark of writing direction";

/// Whether a character is none that is seen, and changes how what is around it is shown: a control, an end of a line,
/// or a mark of writing direction, which makes a name look like another one.
pub fn garbles(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
}

/// A text with a space for each character that [`garbles`] it.
pub fn one_line(text: &str) -> String {
    text.replace(garbles, " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_quotes_are_cut_between_characters() {
        let long = "\u{e4}".repeat(200);
        assert_eq!(shorten(&long).chars().count(), QUOTE + 3);
        assert_eq!(shorten("[1,\n   2]"), "[1, 2]");
    }
}
