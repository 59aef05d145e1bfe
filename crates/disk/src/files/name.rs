//! Names that Windows gives to something else than a file.

use std::io::{Error, ErrorKind, Result};
use std::path::{Component, Path, PathBuf, Prefix};

/// Names of devices, with any ending; those with a number behind them are `COM1` to `LPT9`.
const DEVICES: [&str; 6] = ["con", "prn", "aux", "nul", "conin$", "conout$"];
const NUMBERED: [&str; 2] = ["com", "lpt"];

/// Refuses, on Windows, a path with a name that is that of a device or that the system would change, and one that
/// depends on the folder that a drive was left in, such as `C:part.csv`.
///
/// # Errors
/// [`ErrorKind::InvalidInput`] with what is wrong.
pub fn check_name(path: &Path) -> Result<()> {
    if !cfg!(windows) {
        return Ok(());
    }
    let problem = path.components().find_map(|part| match part {
        Component::Prefix(prefix) if matches!(prefix.kind(), Prefix::Disk(_)) && !path.has_root() => {
            Some("it is relative to the folder that the drive was left in: write C:\\folder\\file".to_owned())
        }
        Component::Normal(name) => problem_of(&name.to_string_lossy()),
        _ => None,
    });
    problem.map_or(Ok(()), |problem| Err(Error::new(ErrorKind::InvalidInput, problem)))
}

/// Where a file lies that is named relative to a folder. A slash is between them on every system, as files write it, so
/// that notes of results say the same everywhere.
pub fn below(folder: &Path, name: &str) -> PathBuf {
    let mut joined = folder.as_os_str().to_owned();
    // Paths that Windows is to take as they are have no slashes.
    if !cfg!(windows)
        || joined.is_empty()
        || Path::new(name).has_root()
        || name.contains(':')
        || folder.starts_with(r"\\?\")
    {
        return folder.join(name);
    }
    joined.push("/");
    joined.push(name);
    PathBuf::from(joined)
}

/// What is wrong with a name on Windows.
fn problem_of(name: &str) -> Option<String> {
    let stem = name.split('.').next().unwrap_or_default().trim_end().to_ascii_lowercase();
    let is_number =
        |rest: &str| rest.chars().count() == 1 && rest.chars().all(|c| "123456789\u{b9}\u{b2}\u{b3}".contains(c));
    let is_device = DEVICES.contains(&stem.as_str())
        || NUMBERED.iter().filter_map(|device| stem.strip_prefix(device)).any(is_number);
    let problem = if is_device {
        "is that of a device on Windows"
    } else if name.ends_with(['.', ' ']) {
        "ends with a dot or a blank, which Windows leaves out"
    } else if name.chars().any(|c| c < ' ' || ":*?\"<>|".contains(c)) {
        "has a character that Windows allows in no name: : * ? \" < > |"
    } else {
        return None;
    };
    Some(format!("the name {name:?} {problem}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_devices_and_names_that_would_be_changed_are_refused() {
        for name in ["CON", "nul.toml", "Aux .csv", "com1", "LPT9.stl", "lpt\u{b2}", "CONOUT$", "a.", "a ", "a:b", "a?"]
        {
            assert!(problem_of(name).is_some(), "{name}");
        }
        for name in ["console", "nullpunkt.toml", "com", "com10", "lpt0", ".stead.lock", "a b.csv", "Fr\u{e4}steil.csv"]
        {
            assert_eq!(problem_of(name), None, "{name}");
        }
    }

    #[test]
    fn names_of_files_are_relative_to_their_folder() {
        for (folder, name, expected) in
            [("configs", "../a.csv", "configs/../a.csv"), ("", "a.csv", "a.csv"), ("a", "/b", "/b")]
        {
            assert_eq!(below(Path::new(folder), name).display().to_string(), expected);
        }
    }

    #[test]
    fn a_path_is_refused_by_each_of_its_names() {
        let is_refused = |path: &str| check_name(Path::new(path)).is_err();
        for path in ["C:part.csv", "C:", "out/nul/best.csv", "out\\aux.toml"] {
            assert_eq!(is_refused(path), cfg!(windows), "{path}");
        }
        for path in ["C:\\out\\part.csv", "..\\out", "\\\\server\\share\\part.csv", "\\\\?\\C:\\part.csv", "."] {
            assert!(!is_refused(path), "{path}");
        }
    }
}
