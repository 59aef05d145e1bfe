//! Numbers and lines of text as files state them.

pub use stead_numerics::digits::{figures, fixed};
pub use stead_numerics::unit::Unit;

/// A text in lines of so many letters at most, broken between words; a longer word has a line of its own.
pub fn lines_of(text: &str, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::lines_of;

    #[test]
    fn lines_are_broken_between_words_and_lose_none() {
        let text = "stiffness of KUKA KR 270; guesses: spindle, cell";
        for most in [1, 9, 17, 200] {
            let lines = lines_of(text, most);
            assert_eq!(lines.join(" "), text);
            let fits = |line: &String| line.chars().count() <= most || !line.contains(' ');
            assert!(lines.iter().all(fits), "{most}: {lines:?}");
        }
        assert_eq!(lines_of("one two three", 7), ["one two", "three"]);
    }
}
