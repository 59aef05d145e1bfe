//! Files that a command makes beside those of the user: they must not be there yet, or are replaced with `--force`.

use super::is_full;
use super::staged::{PREFIX, Staged, sync};
use crate::input::InputError;
use std::path::{Path, PathBuf};

/// What becomes of files that are there already.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Existing {
    /// Nothing is written.
    #[default]
    Kept,
    /// They are replaced, each as a whole.
    Replaced,
}

const ALLOWED: &str = "the name of a file that is not there yet, in a folder that can be written to";

/// Writes a text to a file; folders to it are made.
///
/// # Errors
/// [`InputError`] where the file is there already and to be kept, or cannot be written; it is then as it was.
pub fn write_new(file: &Path, text: &str, existing: Existing) -> Result<(), InputError> {
    write_all_new(&[(file.to_owned(), text)], existing)
}

/// Refuses names of files that could not be written, before the long work that makes them.
///
/// # Errors
/// [`InputError`] where a file is there already and to be kept.
pub fn check_all_new(files: &[PathBuf], existing: Existing) -> Result<(), InputError> {
    files.iter().try_for_each(|file| check(file, existing))
}

/// Writes files: all, or none where one of them is there already and to be kept, or cannot be written. They are written
/// under temporary names first. The first of them, which names the others, gets its name last: a process that is killed
/// leaves it or nothing that looks whole.
///
/// # Errors
/// Those of [`write_new`].
pub fn write_all_new(files: &[(PathBuf, &str)], existing: Existing) -> Result<(), InputError> {
    files.iter().try_for_each(|(file, _)| check(file, existing))?;
    let mut made = MadeFolders::default();
    let mut staged = Vec::with_capacity(files.len());
    for (file, text) in files {
        let folder = file.parent().unwrap_or(Path::new(""));
        let written = made.make(folder).and_then(|()| Staged::write(folder, PREFIX, text.as_bytes()));
        staged.push((written.map_err(|cause| cannot(file, &cause))?, file));
    }
    let mut named: Vec<&PathBuf> = Vec::new();
    while let Some((written, file)) = staged.pop() {
        let put = match existing {
            // Fails rather than replacing a file that has come in the meantime.
            Existing::Kept => written.put_new(file),
            Existing::Replaced => written.put(file),
        };
        if let Err(cause) = put {
            // What is removed here is what was made here.
            named.into_iter().for_each(|made| drop(std::fs::remove_file(made)));
            return Err(cannot(file, &cause));
        }
        if existing == Existing::Kept {
            named.push(file);
        }
    }
    made.keep();
    if let Some(folder) = files.first().and_then(|(file, _)| file.parent()).filter(|folder| folder.is_dir()) {
        // They are there; where the names cannot be put on the disk now, the system does it later.
        let _ = sync(folder);
    }
    Ok(())
}

/// Folders that were made on the way, removed when this is dropped, where they are empty and not to be kept.
#[derive(Debug, Default)]
struct MadeFolders(Vec<PathBuf>);

impl MadeFolders {
    /// Makes a folder and those above it.
    fn make(&mut self, folder: &Path) -> std::io::Result<()> {
        let missing = folder.ancestors().take_while(|above| !above.as_os_str().is_empty() && !above.exists());
        let missing: Vec<PathBuf> = missing.map(Path::to_owned).collect();
        self.0.extend(missing.into_iter().rev());
        std::fs::create_dir_all(folder)
    }

    fn keep(mut self) {
        self.0.clear();
    }
}

impl Drop for MadeFolders {
    fn drop(&mut self) {
        self.0.iter().rev().for_each(|folder| drop(std::fs::remove_dir(folder)));
    }
}

fn cannot(file: &Path, cause: &std::io::Error) -> InputError {
    let error = InputError::new(file, format!("cannot be written: {cause}"));
    if is_full(cause) { error.of_disk() } else { error.allowed(ALLOWED) }
}

/// Refuses a file that is there, where it is to be kept or is no plain file.
fn check(file: &Path, existing: Existing) -> Result<(), InputError> {
    match (file.symlink_metadata(), existing) {
        (Err(_), _) => Ok(()),
        (Ok(found), Existing::Replaced) if found.is_file() => Ok(()),
        (Ok(_), Existing::Replaced) => {
            let problem = "is a folder or a link, which is not replaced";
            Err(InputError::new(file, problem).allowed("the name of a file, in a folder that can be written to"))
        }
        (Ok(_), Existing::Kept) => {
            let allowed = format!("{ALLOWED}; --force replaces it");
            Err(InputError::new(file, "is there already, and is left as it is").allowed(allowed))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_there_is_left_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("below/new.toml");
        write_new(&file, "mine", Existing::Kept).unwrap();
        let message = write_new(&file, "other", Existing::Kept).unwrap_err().to_string();
        assert!(message.contains("new.toml: is there already") && message.contains("; allowed: "), "{message}");
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "mine");
        assert!(
            write_new(&file.join("below"), "other", Existing::Kept)
                .unwrap_err()
                .to_string()
                .contains("cannot be written: ")
        );
    }

    #[test]
    fn a_file_is_replaced_where_that_is_asked_for_and_a_folder_or_a_link_never() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("a"), "mine").unwrap();
        std::fs::create_dir(at("d")).unwrap();
        write_all_new(&[(at("a"), "new"), (at("b"), "new")], Existing::Replaced).unwrap();
        assert_eq!([at("a"), at("b")].map(|file| std::fs::read_to_string(file).unwrap()), ["new", "new"]);
        for other in ["d", "a/below"] {
            let files = [(at("a"), "newer"), (at(other), "newer")];
            let message = write_all_new(&files, Existing::Replaced).unwrap_err().to_string();
            assert!(message.contains("is a folder or a link") || message.contains("cannot be written"), "{message}");
            assert_eq!(std::fs::read_to_string(at("a")).unwrap(), "new", "{other}");
        }
        // Nothing else is left.
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
    }

    #[test]
    fn of_several_files_all_are_written_or_none() {
        let folder = tempfile::tempdir().unwrap();
        let files = ["a.src", "b.src"].map(|name| (folder.path().join(name), "text"));
        write_all_new(&files, Existing::Kept).unwrap();
        std::fs::remove_file(&files[0].0).unwrap();
        assert!(write_all_new(&files, Existing::Kept).unwrap_err().to_string().contains("b.src: is there already"));
        assert!(!files[0].0.exists());
        // The second cannot be written, since its folder is a file.
        let files = [(folder.path().join("c.src"), "text"), (files[1].0.join("d.src"), "text")];
        assert!(write_all_new(&files, Existing::Kept).is_err() && !files[0].0.exists());
        // Nor is a folder left, or a temporary file.
        let files = ["new/e.src", "new/deep/f.src", "b.src/g.src"].map(|name| (folder.path().join(name), "text"));
        assert!(write_all_new(&files, Existing::Kept).is_err());
        let names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(names, ["b.src"]);
    }
}
