//! Files that a command makes and that must not be there yet.

use crate::input::InputError;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

const ALLOWED: &str = "the name of a file that is not there yet, in a folder that can be written to";

/// Writes a text to a file, which must not be there; folders to it are made.
///
/// # Errors
/// [`InputError`] where the file is there already or cannot be written; it is then as it was.
pub(crate) fn write_new(file: &Path, text: &str) -> Result<(), InputError> {
    check_new(file)?;
    let cannot = |error: std::io::Error| InputError::new(file, format!("cannot be written: {error}")).allowed(ALLOWED);
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder).map_err(cannot)?;
    }
    // Fails rather than replacing a file that has come in the meantime.
    let mut made = OpenOptions::new().write(true).create_new(true).open(file).map_err(cannot)?;
    let result = made.write_all(text.as_bytes()).and_then(|()| made.sync_all());
    result.map_err(|error| {
        let _ = std::fs::remove_file(file);
        cannot(error)
    })
}

/// Writes files none of which may be there: all, or none where one of them is there already or cannot be written.
///
/// # Errors
/// Those of [`write_new`].
pub(crate) fn write_all_new(files: &[(PathBuf, &str)]) -> Result<(), InputError> {
    files.iter().try_for_each(|(file, _)| check_new(file))?;
    for (index, (file, text)) in files.iter().enumerate() {
        write_new(file, text).inspect_err(|_| {
            // What is removed here is what was made here.
            files[..index].iter().for_each(|(made, _)| drop(std::fs::remove_file(made)));
        })?;
    }
    Ok(())
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
    }
}
