//! Pieces of input files as messages quote them.

/// Longest piece of a file that is quoted in a message, in characters.
const QUOTE: usize = 80;

/// A piece of a file on one line, cut where it is long.
pub(crate) fn shorten(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(QUOTE) {
        Some((end, _)) => format!("{}...", &line[..end]),
        None => line,
    }
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
