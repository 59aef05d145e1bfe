//! A file that a command makes and that must not be there yet.

use crate::input::InputError;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::Path;

/// Writes a text to a file, which must not be there; folders to it are made.
///
/// # Errors
/// [`InputError`] where the file is there already or cannot be written; it is then as it was.
pub(crate) fn write_new(file: &Path, text: &str) -> Result<(), InputError> {
    const ALLOWED: &str = "the name of a file that is not there yet, in a folder that can be written to";
    if file.symlink_metadata().is_ok() {
        return Err(InputError::new(file, "is there already, and is left as it is").allowed(ALLOWED));
    }
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
}
