//! Files that are written for people: rows with their comments, and names of other files.

use std::path::{Component, Path, PathBuf, absolute};

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
    fn files_are_named_from_the_folder_of_the_file() {
        let named = |folder: &str, file: &str| relative(Path::new(folder), Path::new(file));
        assert_eq!(named("my", "my/meshes/a.stl"), "meshes/a.stl");
        assert_eq!(named("my/cells", "robots/a.stl"), "../../robots/a.stl");
        assert_eq!(named("", "a.stl"), "a.stl");
    }
}
