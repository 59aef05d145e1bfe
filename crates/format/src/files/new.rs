//! Files that a command makes and that must not be there yet.

use super::is_full;
use super::staged::{PREFIX, Staged, sync};
use crate::input::InputError;
use std::path::{Path, PathBuf};

const ALLOWED: &str = "the name of a file that is not there yet, in a folder that can be written to";

/// Writes a text to a file, which must not be there; folders to it are made.
///
/// # Errors
/// [`InputError`] where the file is there already or cannot be written; it is then as it was.
pub(crate) fn write_new(file: &Path, text: &str) -> Result<(), InputError> {
    write_all_new(&[(file.to_owned(), text)])
}

/// Writes files none of which may be there: all, or none where one of them is there already or cannot be written. They are written under
/// temporary names first. The first of them, which tells of the others, gets its name last: a process that is killed leaves it or nothing
/// that looks whole.
///
/// # Errors
/// [`InputError`] where a file is there already or cannot be written.
pub(crate) fn write_all_new(files: &[(PathBuf, &str)]) -> Result<(), InputError> {
    files.iter().try_for_each(|(file, _)| check_new(file))?;
    let mut made = MadeFolders::default();
    let mut staged = Vec::with_capacity(files.len());
    for (file, text) in files {
        let folder = file.parent().unwrap_or(Path::new(""));
        let written = made.make(folder).and_then(|()| Staged::write(folder, PREFIX, text.as_bytes()));
        staged.push((written.map_err(|cause| cannot(file, &cause))?, file));
    }
    let mut named: Vec<&PathBuf> = Vec::new();
    while let Some((written, file)) = staged.pop() {
        // Fails rather than replacing a file that has come in the meantime.
        if let Err(cause) = written.put_new(file) {
            // What is removed here is what was made here.
            named.into_iter().for_each(|made| drop(std::fs::remove_file(made)));
            return Err(cannot(file, &cause));
        }
        named.push(file);
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

fn check_new(file: &Path) -> Result<(), InputError> {
    match file.symlink_metadata() {
        Ok(_) => Err(InputError::new(file, "is there already, and is left as it is").allowed(ALLOWED)),
        Err(_) => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_there_is_left_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("below/new.toml");
        write_new(&file, "mine").unwrap();
        let message = write_new(&file, "other").unwrap_err().to_string();
        assert!(message.contains("new.toml: is there already") && message.contains("; allowed: "), "{message}");
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "mine");
        assert!(write_new(&file.join("below"), "other").unwrap_err().to_string().contains("cannot be written: "));
    }

    #[test]
    fn of_several_files_all_are_written_or_none() {
        let folder = tempfile::tempdir().unwrap();
        let files = ["a.src", "b.src"].map(|name| (folder.path().join(name), "text"));
        write_all_new(&files).unwrap();
        std::fs::remove_file(&files[0].0).unwrap();
        assert!(write_all_new(&files).unwrap_err().to_string().contains("b.src: is there already"));
        assert!(!files[0].0.exists());
        // The second cannot be written, since its folder is a file.
        let files = [(folder.path().join("c.src"), "text"), (files[1].0.join("d.src"), "text")];
        assert!(write_all_new(&files).is_err() && !files[0].0.exists());
        // Nor is a folder left, or a temporary file.
        let files = ["new/e.src", "new/deep/f.src", "b.src/g.src"].map(|name| (folder.path().join(name), "text"));
        assert!(write_all_new(&files).is_err());
        let names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(names, ["b.src"]);
    }
}
