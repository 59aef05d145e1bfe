//! The files of one run put in place as one set.
//!
//! All files are written under temporary names first, so that a disk that is full changes nothing. Then names are
//! given, and nothing is written any more: the manifest with the command's entry marked as incomplete, the files, the
//! manifest as it is to stay. Names are put on disk between these three, so that the order holds for a loss of power
//! too.

use super::ReportError;
use std::path::{Path, PathBuf};
use stead_disk::files::{self, PREFIX, Staged};
use stead_disk::input::{InputFile, sha256};
use stead_disk::manifest::{Found, MANIFEST, Manifest, ResultFile, ResultSet, RunInput};

/// The results of a run, about to be written. Files of the last run of the same command that this one does not write
/// are removed, as its manifest lists them; no other file is touched.
#[derive(Debug)]
pub struct Transaction<'a> {
    folder: &'a Path,
    command: &'a str,
    inputs: &'a [InputFile],
    outdated: Vec<&'a str>,
    form: Option<&'a str>,
    anchor: Option<(&'a str, &'a [u8])>,
    derived: Option<&'a str>,
    interrupted: bool,
}

/// The manifest of a folder, or an empty one.
pub fn manifest_in(folder: &Path) -> Result<Manifest, ReportError> {
    let path = folder.join(MANIFEST);
    match Manifest::find(folder) {
        Ok(Found::Nothing) => Ok(Manifest::default()),
        Ok(Found::Manifest(manifest)) => Ok(manifest),
        Ok(Found::Other(problem)) => Err(ReportError::OtherManifest { path, problem }),
        Err(cause) => Err(ReportError::File { path, cause }),
    }
}

/// Refuses to replace a file that no manifest lists: somebody's own.
pub fn check_listed(folder: &Path, manifest: &Manifest, name: &str) -> Result<(), ReportError> {
    let is_listed = || manifest.results.iter().flat_map(|set| &set.files).any(|file| file.name == name);
    let path = folder.join(name);
    if !path.is_file() || is_listed() {
        return Ok(());
    }
    Err(ReportError::OtherManifest { path, problem: "no manifest.json lists it".to_owned() })
}

/// One change of a name, the only changes from the first mark to the last.
#[derive(Debug)]
enum Step {
    Put(Staged, PathBuf),
    Remove(PathBuf),
    Sync,
}

impl<'a> Transaction<'a> {
    /// Nothing yet, in a folder, by a command from its inputs.
    pub fn new(folder: &'a Path, command: &'a str, inputs: &'a [InputFile]) -> Self {
        Self {
            folder,
            command,
            inputs,
            outdated: Vec::new(),
            form: None,
            anchor: None,
            derived: None,
            interrupted: false,
        }
    }

    /// Removes these too, if they are there: results that would contradict these, in folders without a manifest.
    #[must_use]
    pub fn without(mut self, names: impl IntoIterator<Item = &'a str>) -> Self {
        self.outdated.extend(names);
        self
    }

    /// States that the user fills in one of the files, which may then differ from what is written now.
    #[must_use]
    pub fn with_form(mut self, name: &'a str) -> Self {
        self.form = Some(name);
        self
    }

    /// Adds the files to those of the run that has written a file with this content, instead of replacing them.
    #[must_use]
    pub fn joining(mut self, name: &'a str, bytes: &'a [u8]) -> Self {
        self.anchor = Some((name, bytes));
        self
    }

    /// States whether the run was interrupted.
    #[must_use]
    pub fn interrupted(mut self, interrupted: bool) -> Self {
        self.interrupted = interrupted;
        self
    }

    /// Removes the results of a command that were derived from these, where these have changed.
    #[must_use]
    pub fn without_derived(mut self, command: &'a str) -> Self {
        self.derived = Some(command);
        self
    }

    /// Writes the files, over older ones of their names, and the manifest. Returns their paths, without that of the
    /// manifest.
    ///
    /// # Errors
    /// [`ReportError::File`] with the path of the file: the folder is as it was, or its manifest says that it is
    /// incomplete. [`ReportError::OtherRun`] where files are to join results of another run.
    pub fn write<N: AsRef<str>>(self, files: &[(N, Vec<u8>)]) -> Result<Vec<PathBuf>, ReportError> {
        for step in self.steps(files)? {
            self.take(step)?;
        }
        Ok(files.iter().map(|(name, _)| self.folder.join(name.as_ref())).collect())
    }

    /// Writes everything under temporary names and tells what is left to do.
    fn steps<N: AsRef<str>>(&self, files: &[(N, Vec<u8>)]) -> Result<Vec<Step>, ReportError> {
        let former = manifest_in(self.folder)?;
        let former_set = former.of(self.command).cloned();
        let kept = self.kept(former_set.as_ref())?;
        let mut puts = Vec::new();
        for (name, bytes) in files {
            check_listed(self.folder, &former, name.as_ref())?;
            puts.push(self.staged(name.as_ref(), bytes)?);
        }
        let mut set = self.set(files, kept);
        if let (Some(_), Some(former)) = (self.anchor, &former_set) {
            // They join the results of that run.
            (set.version, set.inputs) = (former.version.clone(), former.inputs.clone());
            set.interrupted |= former.interrupted;
        }
        let has_changed = former_set.as_ref().is_none_or(|former| former.files != set.files);
        let derived = self.derived.and_then(|command| former.of(command)).filter(|_| has_changed).cloned();
        let is_outdated = |name: &str| set.file(name).is_none();
        let listed = former_set.iter().chain(&derived).flat_map(|set| &set.files).filter(|file| !file.form);
        let names = listed.map(|file| file.name.as_str()).chain(self.outdated.iter().copied());
        let removals: Vec<PathBuf> =
            names.filter(|name| is_outdated(name)).map(|name| self.folder.join(name)).collect();

        let mut mark = ResultSet { complete: false, ..set.clone() };
        let missing = former_set.into_iter().flat_map(|set| set.files).filter(|file| is_outdated(&file.name));
        mark.files.extend(missing);
        let mut mark = former.with(mark);
        let mut end = former.with(set);
        if let Some(derived) = derived {
            end = end.without(&derived.command);
            mark = mark.with(ResultSet { complete: false, ..derived });
        }
        let [mark, end] = [&mark, &end].map(|manifest| {
            let bytes = manifest.to_bytes();
            bytes.map_err(|e| ReportError::Format { what: MANIFEST, cause: e.to_string() })
        });
        let (mark, end) = (self.staged(MANIFEST, &mark?)?, self.staged(MANIFEST, &end?)?);
        let mut steps = vec![mark, Step::Sync];
        steps.extend(puts);
        steps.extend(removals.into_iter().map(Step::Remove));
        steps.extend([Step::Sync, end, Step::Sync]);
        Ok(steps)
    }

    /// The entries of files that these join.
    fn kept(&self, former: Option<&ResultSet>) -> Result<Vec<ResultFile>, ReportError> {
        let (Some((name, bytes)), Some(former)) = (self.anchor, former) else { return Ok(Vec::new()) };
        let is_same = former.complete && former.file(name).is_some_and(|file| file.sha256 == sha256(bytes));
        if !is_same {
            return Err(ReportError::OtherRun { path: self.folder.join(name) });
        }
        Ok(former.files.iter().filter(|file| !self.outdated.contains(&file.name.as_str())).cloned().collect())
    }

    /// The entry of this run.
    fn set<N: AsRef<str>>(&self, files: &[(N, Vec<u8>)], kept: Vec<ResultFile>) -> ResultSet {
        let mut entries: Vec<ResultFile> = files
            .iter()
            .map(|(name, bytes)| ResultFile {
                form: self.form == Some(name.as_ref()),
                ..ResultFile::of(name.as_ref(), bytes)
            })
            .collect();
        let is_new = |file: &ResultFile| files.iter().all(|(name, _)| name.as_ref() != file.name);
        entries.extend(kept.into_iter().filter(is_new));
        entries.sort_by(|a, b| a.name.cmp(&b.name));
        ResultSet {
            command: self.command.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            complete: true,
            interrupted: self.interrupted,
            inputs: self.inputs.iter().map(RunInput::from).collect(),
            files: entries,
        }
    }

    fn staged(&self, name: &str, bytes: &[u8]) -> Result<Step, ReportError> {
        let path = self.folder.join(name);
        // Told now, while nothing has changed.
        let staged = if path.is_dir() {
            Err(std::io::Error::new(std::io::ErrorKind::IsADirectory, "a folder of that name is there"))
        } else {
            Staged::write(self.folder, PREFIX, bytes)
        };
        match staged {
            Ok(staged) => Ok(Step::Put(staged, path)),
            Err(cause) => Err(ReportError::File { path, cause }),
        }
    }

    fn take(&self, step: Step) -> Result<(), ReportError> {
        let (result, path) = match step {
            Step::Put(staged, path) => (staged.put(&path), path),
            Step::Remove(path) => (files::remove(&path), path),
            Step::Sync => (files::sync(self.folder), self.folder.to_owned()),
        };
        result.map_err(|cause| ReportError::File { path, cause })
    }
}

#[cfg(test)]
mod tests;
