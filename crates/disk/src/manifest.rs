//! `manifest.json`: which files of a results folder which command has written, and whether it came to its end.
//!
//! A command that puts results in place first marks its entry as incomplete and states it complete at the very end.
//! Whoever reads a result asks [`check`] whether the bytes are those of a run that came to its end. A folder without a
//! manifest holds the user's own files.

use crate::files;
use crate::input::{InputError, InputFile, sha256};
use serde::{Deserialize, Serialize};
use std::io::ErrorKind;
use std::path::Path;

/// The name of the file.
pub const MANIFEST: &str = "manifest.json";

/// The layout of the file; raised when a key goes or changes its meaning, not when one is added.
pub const FORMAT: u32 = 1;

/// What a results folder holds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    /// The layout of this file.
    pub format: u32,
    /// One entry for each command that has written here, in the order of their names.
    pub results: Vec<ResultSet>,
}

/// The files of the last run of one command.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ResultSet {
    /// The command, without `stead`.
    pub command: String,
    /// The version of stead that ran.
    pub version: String,
    /// Whether all files are in place. While they are not, they may be those of two runs.
    pub complete: bool,
    /// Whether the run was interrupted: what it has left is what there was by then.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub interrupted: bool,
    /// The files that the run has read.
    pub inputs: Vec<RunInput>,
    /// The files that it has written, in the order of their names.
    pub files: Vec<ResultFile>,
}

/// A file that a run has read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RunInput {
    /// What the file is for: see [`InputFile::role`].
    pub role: String,
    /// Its name: see [`InputFile::name`].
    pub name: String,
    /// SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
}

/// A file that a run has written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ResultFile {
    /// Its name in the folder.
    pub name: String,
    /// Its size. bytes
    pub bytes: u64,
    /// SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
    /// A form that the user fills in: it may differ from what was written.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub form: bool,
}

/// What is found under the name of the manifest.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Found {
    /// Nothing.
    Nothing,
    /// A file that is no manifest of stead, and why.
    Other(String),
    /// A manifest.
    Manifest(Manifest),
}

/// What becomes of a file that is not listed in the manifest beside it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unlisted {
    /// It is the user's own.
    Accepted,
    /// It cannot be the result that is requested.
    Refused,
}

impl From<&InputFile> for RunInput {
    fn from(input: &InputFile) -> Self {
        Self { role: input.role.to_owned(), name: input.name.clone(), sha256: input.sha256.clone() }
    }
}

impl ResultFile {
    /// The entry of a file with this content.
    pub fn of(name: &str, bytes: &[u8]) -> Self {
        Self { name: name.to_owned(), bytes: bytes.len() as u64, sha256: sha256(bytes), form: false }
    }
}

impl Default for Manifest {
    fn default() -> Self {
        Self { format: FORMAT, results: Vec::new() }
    }
}

impl Manifest {
    /// Looks for the manifest of a folder.
    ///
    /// # Errors
    /// What the system says, where there is a file that cannot be read.
    pub fn find(folder: &Path) -> std::io::Result<Found> {
        let bytes = match files::read(&folder.join(MANIFEST)) {
            Ok(bytes) => bytes,
            Err(cause) if matches!(cause.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                return Ok(Found::Nothing);
            }
            Err(cause) => return Err(cause),
        };
        Ok(match serde_json::from_slice::<Self>(&bytes) {
            Ok(manifest) if manifest.format != FORMAT => Found::Other(format!("its format is {}", manifest.format)),
            Ok(manifest) if !manifest.has_plain_names() => Found::Other("it names files in other folders".to_owned()),
            Ok(manifest) => Found::Manifest(manifest),
            Err(cause) => Found::Other(cause.to_string()),
        })
    }

    /// The entry of a command.
    pub fn of(&self, command: &str) -> Option<&ResultSet> {
        self.results.iter().find(|set| set.command == command)
    }

    /// The manifest with another entry of a command in place of the former one. The files belong to that entry alone.
    #[must_use]
    pub fn with(&self, set: ResultSet) -> Self {
        let mut results: Vec<ResultSet> =
            self.results.iter().filter(|other| other.command != set.command).cloned().collect();
        for other in &mut results {
            other.files.retain(|file| set.file(&file.name).is_none());
        }
        results.push(set);
        results.sort_by(|a, b| a.command.cmp(&b.command));
        Self { format: FORMAT, results }
    }

    /// The manifest without the entry of a command.
    #[must_use]
    pub fn without(&self, command: &str) -> Self {
        let results = self.results.iter().filter(|set| set.command != command).cloned().collect();
        Self { format: FORMAT, results }
    }

    /// As the bytes of the file.
    ///
    /// # Errors
    /// What the writer of JSON says.
    pub fn to_bytes(&self) -> Result<Vec<u8>, serde_json::Error> {
        let mut bytes = serde_json::to_vec_pretty(self)?;
        bytes.push(b'\n');
        Ok(bytes)
    }

    /// Whether every file is one of this folder, so that no hand-made manifest leads out of it.
    fn has_plain_names(&self) -> bool {
        let mut files = self.results.iter().flat_map(|set| &set.files);
        files.all(|file| Path::new(&file.name).file_name().is_some_and(|name| name == file.name.as_str()))
    }
}

impl ResultSet {
    /// The entry of a file.
    pub fn file(&self, name: &str) -> Option<&ResultFile> {
        self.files.iter().find(|file| file.name == name)
    }
}

/// A note on a file that the manifest beside it lists as left by a run that was interrupted.
pub fn interruption_note(file: &Path) -> Option<String> {
    let Ok(Found::Manifest(manifest)) = Manifest::find(file.parent().unwrap_or(Path::new(""))) else { return None };
    let name = file.file_name()?.to_str()?;
    let set = manifest.results.iter().find(|set| set.interrupted && set.file(name).is_some())?;
    let (file, command) = (file.display(), &set.command);
    Some(format!(
        "{file} is from a run of `stead {command}` that was interrupted: the best found by then, not the end of the search"
    ))
}

/// Refuses a file whose bytes are not those that the manifest beside it, if there is one, states of a run that came to
/// its end.
///
/// # Errors
/// [`InputError`] for a result of a run that did not end, or that was changed since; for a file that is not listed,
/// where that is refused.
pub fn check(file: &Path, bytes: &[u8], unlisted: Unlisted) -> Result<(), InputError> {
    let folder = file.parent().unwrap_or(Path::new(""));
    let error = |problem: String| InputError::new(file, problem);
    let found = Manifest::find(folder).map_err(|cause| {
        error(format!("the {MANIFEST} beside it cannot be read: {cause}")).allowed("a readable file, or none")
    })?;
    let manifest = match found {
        Found::Manifest(manifest) => manifest,
        Found::Other(why) if unlisted == Unlisted::Refused => {
            return Err(error(format!("the {MANIFEST} beside it is none of stead: {why}"))
                .allowed("results as a command of stead has left them"));
        }
        Found::Nothing | Found::Other(_) => return Ok(()),
    };
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let listed = manifest.results.iter().find_map(|set| set.file(&name).map(|entry| (set, entry)));
    let Some((set, entry)) = listed else {
        return match unlisted {
            Unlisted::Accepted => Ok(()),
            Unlisted::Refused => Err(error(format!("is not among the results that the {MANIFEST} beside it lists"))
                .allowed("a result that is listed there, or a file in a folder without one")),
        };
    };
    let again = format!("run `stead {}` again", set.command);
    if entry.form {
        Ok(())
    } else if !set.complete {
        Err(error(format!("is from a run of `stead {}` that did not come to its end", set.command))
            .allowed(format!("results of a run that did: {again}")))
    } else if entry.bytes != bytes.len() as u64 || entry.sha256 != sha256(bytes) {
        Err(error(format!("is not the file that `stead {}` has written, by the {MANIFEST} beside it", set.command))
            .found(format!("sha256 {}", sha256(bytes)))
            .allowed(format!("sha256 {}: {again}, or copy a changed file to another folder", entry.sha256)))
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(command: &str, complete: bool, files: &[(&str, &[u8])]) -> ResultSet {
        let files = files.iter().map(|(name, bytes)| ResultFile::of(name, bytes)).collect();
        ResultSet {
            command: command.to_owned(),
            version: "1".to_owned(),
            complete,
            interrupted: false,
            inputs: Vec::new(),
            files,
        }
    }

    fn folder_with(manifest: &[u8]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(MANIFEST), manifest).unwrap();
        folder
    }

    fn refusal(folder: &Path, name: &str, bytes: &[u8], unlisted: Unlisted) -> Option<String> {
        check(&folder.join(name), bytes, unlisted).err().map(|error| error.to_string())
    }

    #[test]
    fn a_result_is_what_its_run_has_left_at_its_end() {
        let mut sheet = set("identify plan", false, &[("sheet.csv", b"form")]);
        sheet.files[0].form = true;
        let manifest = Manifest::default()
            .with(set("score", true, &[("score.json", b"{}")]))
            .with(set("place", false, &[("best.csv", b"1")]))
            .with(sheet);
        assert_eq!(
            manifest.results.iter().map(|set| set.command.as_str()).collect::<Vec<_>>(),
            ["identify plan", "place", "score"]
        );
        let folder = folder_with(&manifest.to_bytes().unwrap());
        let refused = |name: &str, bytes: &[u8]| refusal(folder.path(), name, bytes, Unlisted::Refused);
        assert_eq!(refused("score.json", b"{}"), None);
        assert_eq!(refused("sheet.csv", b"filled in"), None);
        let message = refused("best.csv", b"1").unwrap();
        assert!(message.ends_with(
            "best.csv: is from a run of `stead place` that did not come to its end; allowed: results of a run that did: run `stead place` \
             again"
        ));
        let message = refused("score.json", b"[]").unwrap();
        for part in
            ["is not the file that `stead score` has written", "found sha256 4f53cda1", "run `stead score` again"]
        {
            assert!(message.contains(part), "{part} in {message}");
        }
        assert!(refused("mine.csv", b"1").unwrap().contains("is not among the results that the manifest.json"));
        assert_eq!(refusal(folder.path(), "mine.csv", b"1", Unlisted::Accepted), None);
    }

    #[test]
    fn what_is_no_manifest_vouches_for_no_result() {
        assert_eq!(refusal(Path::new("nowhere"), "best.csv", b"", Unlisted::Refused), None);
        let outside = Manifest::default().with(set("place", true, &[("../best.csv", b"1")])).to_bytes().unwrap();
        let newer = Manifest { format: 2, ..Manifest::default() }.to_bytes().unwrap();
        for bytes in [&b"{\"name\": \"a web page\"}"[..], b"{\"form", b"", &outside[..], &newer[..]] {
            let folder = folder_with(bytes);
            let message = refusal(folder.path(), "best.csv", b"1", Unlisted::Refused).unwrap();
            assert!(message.contains("the manifest.json beside it is none of stead"), "{message}");
            assert_eq!(refusal(folder.path(), "best.csv", b"1", Unlisted::Accepted), None);
        }
    }

    #[test]
    fn a_file_that_another_command_writes_over_is_that_commands() {
        let manifest = Manifest::default()
            .with(set("place", true, &[("best.csv", b"1"), ("summary.json", b"2")]))
            .with(set("compensate", true, &[("summary.json", b"3")]));
        let names =
            |command| manifest.of(command).unwrap().files.iter().map(|file| file.name.as_str()).collect::<Vec<_>>();
        assert_eq!((names("place"), names("compensate")), (vec!["best.csv"], vec!["summary.json"]));
    }
}
