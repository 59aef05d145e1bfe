//! Texts of files as templates with holes.

/// A template with its holes filled by values of their names. A hole `@name   @` with blanks is as wide as it stands
/// there; a line with a hole of which there is no value is left out.
pub fn filled(template: &str, values: &[(&str, Option<String>)]) -> String {
    let value = |hole: &str| {
        let (_, value) = values.iter().find(|(name, _)| *name == hole.trim_end())?;
        let width = if hole.ends_with(' ') { hole.len() + 2 } else { 0 };
        value.as_ref().map(|value| format!("{value:<width$}"))
    };
    let line = |line: &str| -> Option<String> {
        let pieces = line.split('@').enumerate();
        pieces.map(|(place, piece)| if place % 2 == 1 { value(piece) } else { Some(piece.to_owned()) }).collect()
    };
    template.split_inclusive('\n').filter_map(line).collect()
}

/// The empty value of a hole before the text of a line, where the line is to be there.
pub fn shown_if(is_there: bool) -> Option<String> {
    is_there.then(String::new)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_are_filled_and_lines_without_a_value_left_out() {
        let template = "a = @a   @ # @b@\nc = @c@\n@d@# d\n@e@\n";
        let values = [("a", Some("1".to_owned())), ("b", Some("@c@".to_owned())), ("c", None), ("d", shown_if(true))];
        assert_eq!(filled(template, &values), "a = 1      # @c@\n# d\n");
    }
}
