//! Files that are written for people: templates with holes, rows with their comments, and names of other files.

use std::path::{Component, Path, PathBuf, absolute};

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

/// A row, with its comment in one column with those of others, and a line break.
pub fn commented(row: &str, comment: &str) -> String {
    if comment.is_empty() { format!("{row}\n") } else { format!("{row:<38} # {comment}\n") }
}

/// The name of a file seen from a folder, with forward slashes; the whole name where there is no way between them.
pub fn relative(folder: &Path, file: &Path) -> String {
    let (Ok(folder), Ok(file)) = (absolute(folder.join(".")), absolute(file)) else { return shown(file) };
    let (from, to): (Vec<Component<'_>>, Vec<Component<'_>>) =
        (folder.components().collect(), file.components().collect());
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    // Another drive, or a way through a folder whose name is not known.
    if common == 0 || from[common..].contains(&Component::ParentDir) {
        return shown(&file);
    }
    let up = std::iter::repeat_n(Component::ParentDir, from.len() - common);
    shown(&up.chain(to[common..].iter().copied()).collect::<PathBuf>())
}

fn shown(file: &Path) -> String {
    file.to_string_lossy().replace('\\', "/")
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

    #[test]
    fn files_are_named_from_the_folder_of_the_file() {
        let named = |folder: &str, file: &str| relative(Path::new(folder), Path::new(file));
        assert_eq!(named("my", "my/meshes/a.stl"), "meshes/a.stl");
        assert_eq!(named("my/cells", "robots/a.stl"), "../../robots/a.stl");
        assert_eq!(named("", "a.stl"), "a.stl");
    }
}
