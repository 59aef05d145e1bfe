//! Tools that comments of G-code describe, as posts write them: `(T1 D=20. CR=3. - END MILL)`,
//! `(TOOL - 1 | TOOL DIA. - 12.)`, `(MILL DIA 10.0 R0.)`.

use super::super::tool::ProgramTool;
use stead_disk::quote::shorten;

/// The tool that a line describes in a comment, its lengths in the unit of the program.
pub(super) fn tool_in(line: &str) -> Option<ProgramTool> {
    let start = line.find(['(', ';'])?;
    let comment = line[start + 1..].trim_end().trim_end_matches(')').trim();
    let text = comment.to_ascii_uppercase();
    Some(ProgramTool {
        description: shorten(comment),
        number: number_of(&text),
        diameter: Some(number_after(&text, &["D=", "D =", "DIAMETER", "TOOL DIA", "DIA"])?),
        corner_radius: number_after(&text, &["CR=", "CR =", "CORNER RADIUS", "CORNER RAD"]),
        ..ProgramTool::default()
    })
}

/// Whether a line says in a comment that rapid moves are made at feed.
pub(super) fn says_rapids_at_feed(line: &str) -> bool {
    // Posts break the sentence behind another word.
    let says = ["FEEDRATE OF RAPID", "PERSONAL USE, THE FEEDRATE OF"];
    let line = line.to_ascii_uppercase();
    line.contains(['(', ';']) && says.iter().any(|words| line.contains(words))
}

/// The first number above 0 behind one of the words, which is no part of a longer one, with no more than signs between
/// them.
fn number_after(text: &str, words: &[&str]) -> Option<f64> {
    let mut numbers = words.iter().flat_map(|word| text.match_indices(word)).filter_map(|(at, word)| {
        let is_whole = !text[..at].ends_with(|c: char| c.is_ascii_alphabetic());
        // Behind an abbreviation there may be a point: DIA. - 12.
        let rest = text[at + word.len()..].trim_start_matches('.').trim_start_matches([' ', '=', ':', '-']);
        let number: f64 = rest.split(|c: char| !c.is_ascii_digit() && c != '.').next()?.parse().ok()?;
        (is_whole && number > 0.0 && number.is_finite()).then_some(number)
    });
    numbers.next()
}

/// The number of the tool: `T1`, `TOOL - 1`, `TOOL 1`.
fn number_of(text: &str) -> Option<u32> {
    let by_letter =
        text.split(|c: char| !c.is_ascii_alphanumeric()).find_map(|word| word.strip_prefix('T')?.parse().ok());
    by_letter.or_else(|| {
        let rest = text[text.find("TOOL")? + 4..].trim_start_matches([' ', '-', '#', ':', '.']);
        rest.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tools_are_found_in_comments_as_posts_write_them() {
        for (line, expected) in [
            ("(T1 D=20. CR=3. - ZMIN=-5. - BULLNOSE END MILL)", Some((Some(1), 20.0, Some(3.0)))),
            ("(T12  D=6 CR=0. - FLAT END MILL)", Some((Some(12), 6.0, None))),
            (
                "( 12. FLAT ENDMILL | TOOL - 4 | DIA. OFF. - 4 | LEN. - 4 | TOOL DIA. - 12. )",
                Some((Some(4), 12.0, None)),
            ),
            ("N5 T3 M6 (MILL DIA 10.0 R0. MM)", Some((None, 10.0, None))),
            ("; TOOL 2 DIAMETER: 8.5 CORNER RADIUS: 0.5", Some((Some(2), 8.5, Some(0.5)))),
            ("(MEDIA 5)", None),
            ("(DIA)", None),
            ("(PART)", None),
            ("G1 X5 D=3", None),
        ] {
            let found = tool_in(line).map(|tool| (tool.number, tool.diameter.unwrap(), tool.corner_radius));
            assert_eq!(found, expected, "{line}");
        }
    }
}
