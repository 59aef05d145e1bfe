//! Files that a command makes beside those of the user: they must not be there yet, or are replaced where that was asked for.

use crate::input::InputError;
use std::fs::OpenOptions;
use std::io::Write;
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
pub(crate) fn write_new(file: &Path, text: &str, existing: Existing) -> Result<(), InputError> {
    write_all_new(&[(file.to_owned(), text)], existing)
}

/// Writes files: all, or none where one of them is there already and to be kept, or cannot be written.
///
/// # Errors
/// Those of [`write_new`].
pub(crate) fn write_all_new(files: &[(PathBuf, &str)], existing: Existing) -> Result<(), InputError> {
    files.iter().try_for_each(|(file, _)| check(file, existing))?;
    let staged = |file: &Path| match existing {
        Existing::Kept => file.to_owned(),
        Existing::Replaced => {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            file.with_file_name(format!(".{name}.{}.stead-new", std::process::id()))
        }
    };
    let mut written = Vec::with_capacity(files.len());
    let remove = |written: &[PathBuf]| written.iter().for_each(|made| drop(std::fs::remove_file(made)));
    for (file, text) in files {
        let made = staged(file);
        // What is removed here is what was made here.
        create(&made, text).map_err(|error| cannot(file, &error)).inspect_err(|_| remove(&written))?;
        written.push(made);
    }
    if existing == Existing::Replaced {
        for (made, (file, _)) in written.iter().zip(files) {
            std::fs::rename(made, file).map_err(|error| cannot(file, &error)).inspect_err(|_| remove(&written))?;
        }
    }
    Ok(())
}

/// Makes a file, unless it is there; folders to it are made.
fn create(file: &Path, text: &str) -> std::io::Result<()> {
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder)?;
    }
    // Fails rather than replacing a file that has come in the meantime.
    let mut made = OpenOptions::new().write(true).create_new(true).open(file)?;
    made.write_all(text.as_bytes()).and_then(|()| made.sync_all()).inspect_err(|_| drop(std::fs::remove_file(file)))
}

fn cannot(file: &Path, error: &std::io::Error) -> InputError {
    InputError::new(file, format!("cannot be written: {error}")).allowed(ALLOWED)
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
        let below = write_new(&file.join("below"), "other", Existing::Kept).unwrap_err().to_string();
        assert!(below.contains("cannot be written: "), "{below}");
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
    }
}
