//! Files that a command makes beside those of the user: they must not be there yet, or are replaced with `--force`.

use super::staged::{Aside, PREFIX, Staged, remove_abandoned, sync};
use super::{check_name, is_of_disk, read};
use crate::input::{InputError, InputFile, sha256};
use std::io::Read;
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
    write_all_new(&[(file.to_owned(), text)], existing, &[])
}

/// Refuses names of files that could not be written, before the long work that makes them from the inputs.
///
/// # Errors
/// [`InputError`] where a file is there already and to be kept, or is one of the inputs.
pub fn check_all_new(files: &[PathBuf], existing: Existing, inputs: &[InputFile]) -> Result<(), InputError> {
    files.iter().try_for_each(|file| check(file, existing, inputs))
}

/// Writes files that were made from the inputs: all, or none where one of them is there already and to be kept, is an
/// input, or cannot be written. They are written under temporary names first. The first of them, which names the
/// others, gets its name last, and one that is replaced loses it first: a process that is killed leaves the old files,
/// the new ones, or none that looks whole.
///
/// # Errors
/// Those of [`write_new`], and where a file is replaced by one that begins otherwise, so that it is somebody else's.
pub fn write_all_new(files: &[(PathBuf, &str)], existing: Existing, inputs: &[InputFile]) -> Result<(), InputError> {
    for (file, text) in files {
        check(file, existing, inputs)?;
        if existing == Existing::Replaced && !begins_like(file, text) {
            return Err(foreign(file));
        }
    }
    let mut made = MadeFolders::default();
    let mut staged = Vec::with_capacity(files.len());
    let folders: Vec<&Path> = files.iter().map(|(file, _)| file.parent().unwrap_or(Path::new(""))).collect();
    folders.chunk_by(PartialEq::eq).for_each(|same| remove_abandoned(same[0], PREFIX));
    for ((file, text), folder) in files.iter().zip(folders) {
        let written = made.make(folder).and_then(|()| Staged::write(folder, PREFIX, text.as_bytes()));
        staged.push((written.map_err(|cause| cannot(file, &cause))?, file));
    }
    let is_set = existing == Existing::Replaced && files.len() > 1;
    let mut replaced = Vec::new();
    let mut named: Vec<&PathBuf> = Vec::new();
    let mut put = || -> Result<(), InputError> {
        for (file, _) in files.iter().filter(|(file, _)| is_set && file.exists()) {
            replaced.push(Aside::take(file).map_err(|cause| cannot(file, &cause))?);
        }
        while let Some((written, file)) = staged.pop() {
            let done = match existing {
                Existing::Replaced if !is_set => written.put(file),
                // Fails rather than replacing a file that has come in the meantime.
                _ => written.put_new(file),
            };
            done.map_err(|cause| cannot(file, &cause))?;
            named.push(file);
        }
        Ok(())
    };
    if let Err(error) = put() {
        // What is removed here is what was made here.
        named.into_iter().for_each(|made| drop(std::fs::remove_file(made)));
        replaced.into_iter().rev().for_each(Aside::put_back);
        return Err(error);
    }
    replaced.into_iter().for_each(Aside::remove);
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

/// Whether a file begins as a new one does: with the same first word, such as the first column of a table; what is not
/// there or empty does so too.
fn begins_like(file: &Path, text: &str) -> bool {
    let word = |bytes: &[u8]| -> Vec<u8> {
        let text = bytes.trim_ascii_start();
        text.iter().copied().take_while(|byte| !byte.is_ascii_whitespace() && *byte != b',').collect()
    };
    let mut begin = Vec::new();
    match std::fs::File::open(file).and_then(|old| old.take(4096).read_to_end(&mut begin)) {
        Err(_) => !file.exists(),
        Ok(_) => begin.is_empty() || word(&begin) == word(text.as_bytes()),
    }
}

/// That a file was made by somebody else, so that it is not replaced.
pub fn foreign(file: &Path) -> InputError {
    InputError::new(file, "was not written by this command, and is not replaced")
        .allowed("another name, or no such file")
}

fn cannot(file: &Path, cause: &std::io::Error) -> InputError {
    let error = InputError::new(file, format!("cannot be written: {cause}"));
    if is_of_disk(cause) { error.of_disk() } else { error.allowed(ALLOWED) }
}

/// Refuses a file that is there, where it is to be kept, is no plain file, or is one that the new ones are made from.
fn check(file: &Path, existing: Existing, inputs: &[InputFile]) -> Result<(), InputError> {
    check_name(file).map_err(|cause| cannot(file, &cause))?;
    match (file.symlink_metadata(), existing) {
        (Err(_), _) => Ok(()),
        (Ok(found), Existing::Replaced) if found.is_file() && is_input(file, inputs) => {
            let problem = "is read by this command, and is not replaced by what is made from it";
            Err(InputError::new(file, problem).allowed("another name"))
        }
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

/// Whether a file is one of the inputs: by its name and its bytes.
fn is_input(file: &Path, inputs: &[InputFile]) -> bool {
    let name = file.file_name();
    let mut of_name = inputs.iter().filter(|input| Path::new(&input.name).file_name() == name).peekable();
    of_name.peek().is_some()
        && read(file).is_ok_and(|bytes| {
            let digest = sha256(&bytes);
            of_name.any(|input| input.sha256 == digest)
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::input_file;

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
        std::fs::write(at("a"), "of mine").unwrap();
        std::fs::create_dir(at("d")).unwrap();
        write_all_new(&[(at("a"), "of new"), (at("b"), "of new")], Existing::Replaced, &[]).unwrap();
        assert_eq!([at("a"), at("b")].map(|file| std::fs::read_to_string(file).unwrap()), ["of new", "of new"]);
        for other in ["d", "a/below"] {
            let files = [(at("a"), "of newer"), (at(other), "of newer")];
            let message = write_all_new(&files, Existing::Replaced, &[]).unwrap_err().to_string();
            assert!(message.contains("is a folder or a link") || message.contains("cannot be written"), "{message}");
            assert_eq!(std::fs::read_to_string(at("a")).unwrap(), "of new", "{other}");
        }
        // Nothing else is left.
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
        // What begins otherwise is somebody else's.
        for (begin, is_replaced) in [("solid part", false), ("\u{0}of", false), ("of,x_mm", true), ("", true)] {
            std::fs::write(at("c"), begin).unwrap();
            let replaced = write_all_new(&[(at("c"), "of new")], Existing::Replaced, &[]);
            assert_eq!(replaced.is_ok(), is_replaced, "{begin}");
            let found = std::fs::read_to_string(at("c")).unwrap();
            assert_eq!(found, if is_replaced { "of new" } else { begin });
        }
    }

    #[test]
    fn of_several_files_all_are_written_or_none() {
        let folder = tempfile::tempdir().unwrap();
        let files = ["a.src", "b.src"].map(|name| (folder.path().join(name), "text"));
        write_all_new(&files, Existing::Kept, &[]).unwrap();
        std::fs::remove_file(&files[0].0).unwrap();
        assert!(
            write_all_new(&files, Existing::Kept, &[]).unwrap_err().to_string().contains("b.src: is there already")
        );
        assert!(!files[0].0.exists());
        // The second cannot be written, since its folder is a file.
        let files = [(folder.path().join("c.src"), "text"), (files[1].0.join("d.src"), "text")];
        assert!(write_all_new(&files, Existing::Kept, &[]).is_err() && !files[0].0.exists());
        // Nor is a folder left, or a temporary file.
        let files = ["new/e.src", "new/deep/f.src", "b.src/g.src"].map(|name| (folder.path().join(name), "text"));
        assert!(write_all_new(&files, Existing::Kept, &[]).is_err());
        let names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(names, ["b.src"]);
    }

    #[test]
    fn a_set_that_cannot_be_replaced_is_as_it_was_and_what_is_read_is_never_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let texts = || ["a", "b", "c"].map(|name| std::fs::read_to_string(at(name)).unwrap_or_default());
        let set = |text: &'static str| ["a", "b", "c"].map(|name| (at(name), text));
        write_all_new(&set("of old"), Existing::Kept, &[]).unwrap();
        // What comes in the way after the old files have gone aside is not replaced.
        let aside = [at("a"), at("b")].map(|file| Aside::take(&file).unwrap());
        assert_eq!(texts(), ["", "", "of old"]);
        // A command that runs in the meantime takes them for those of a process that is alive.
        remove_abandoned(folder.path(), PREFIX);
        aside.into_iter().for_each(Aside::put_back);
        assert_eq!(texts(), ["of old"; 3]);

        let input = [input_file("task", "tasks/b", b"of old")];
        let message = write_all_new(&set("of new"), Existing::Replaced, &input).unwrap_err().to_string();
        assert!(message.contains("b: is read by this command") && texts() == ["of old"; 3], "{message}");
        write_all_new(&set("of new"), Existing::Replaced, &[input_file("task", "tasks/d", b"of old")]).unwrap();
        assert_eq!(texts(), ["of new"; 3]);

        // What a killed process has left is cleared by the next.
        Staged::write(folder.path(), PREFIX, b"left").unwrap().abandon().unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 4);
        write_all_new(&set("of newer"), Existing::Replaced, &[]).unwrap();
        assert_eq!(
            (std::fs::read_dir(folder.path()).unwrap().count(), texts()),
            (3, ["of newer"; 3].map(str::to_owned))
        );
    }
}
