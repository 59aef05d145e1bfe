//! Parts of an earlier, longer program that a new one of the same name replaces.

use super::{Program, ProgramFormat, names};
use std::path::{Path, PathBuf};
use stead_disk::files;

/// What every file of a KRL or RAPID program says of itself.
pub(super) const MARK: &str = "written by stead";
/// The same in the header of a TP program.
pub(super) const TP_MARK: &str = "COMMENT\t\t= \"stead\";";

/// Files beside a program that are named as parts of it and are none.
#[derive(Debug)]
pub(super) struct StaleParts {
    /// Parts that an export has written, of the program that is there now.
    ours: Vec<PathBuf>,
    /// All others.
    others: Vec<PathBuf>,
}

impl StaleParts {
    /// Those in a folder where the program is not written yet.
    pub(super) fn beside(program: &Program, folder: &Path) -> Self {
        let main = program.files.first().filter(|_| program.format != ProgramFormat::Csv).map(|main| &main.name);
        let (ending, old) =
            match main.and_then(|main| Some((main.strip_prefix(&program.name)?, own_text(folder, main)))) {
                Some((ending, old)) => (ending, old.unwrap_or_default()),
                None => return Self { ours: Vec::new(), others: Vec::new() },
            };
        let is_called = |part: &str| {
            let words = old.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
            words.into_iter().any(|word| word.eq_ignore_ascii_case(part))
        };
        let number = |name: &str| {
            let text = name.strip_prefix(&program.name)?.strip_suffix(ending)?;
            text.strip_prefix('_')?.parse().ok().filter(|number| names::part(*number) == text)
        };
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        let mut named: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
        named.retain(|name| number(name).is_some() && program.files.iter().all(|file| file.name != *name));
        named.sort();
        let (ours, others) = named.into_iter().partition::<Vec<String>, _>(|name| {
            is_called(name.trim_end_matches(ending)) && own_text(folder, name).is_some()
        });
        let paths = |names: Vec<String>| names.into_iter().map(|name| folder.join(name)).collect();
        Self { ours: paths(ours), others: paths(others) }
    }

    /// Removes those that are the work of an export. Returns a note on them, and one on all that are still there.
    pub(super) fn remove(self) -> Vec<String> {
        let (removed, left): (Vec<_>, Vec<_>) =
            self.ours.into_iter().partition(|file| std::fs::remove_file(file).is_ok());
        let note = |files: Vec<PathBuf>, text: &str| {
            let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
            (!names.is_empty()).then(|| format!("{text}: {}", names.join(", ")))
        };
        let of_earlier = "removed as parts of the program that was replaced, which the new one does not have";
        let named = "named as parts of this program but not of it; look at them, and keep them off the controller";
        note(removed, of_earlier).into_iter().chain(note([left, self.others].concat(), named)).collect()
    }
}

/// Whether a plain file says that an export has written it.
pub(super) fn is_own(folder: &Path, name: &str) -> bool {
    own_text(folder, name).is_some()
}

/// The text of a plain file that says that an export has written it.
fn own_text(folder: &Path, name: &str) -> Option<String> {
    let file = folder.join(name);
    let is_plain = file.symlink_metadata().is_ok_and(|found| found.is_file());
    let bytes = is_plain.then(|| files::read(&file).ok()).flatten()?;
    let text = String::from_utf8_lossy(&bytes).into_owned();
    (text.contains(MARK) || text.contains(TP_MARK)).then_some(text)
}
