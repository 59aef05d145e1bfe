//! A results folder that this process alone writes to.

use super::lock::{Lock, LockError};
use super::transaction::Transaction;
use super::{ReportError, transaction};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use stead_disk::files::{self, PREFIX, Staged, remove_stale};
use stead_disk::input::InputFile;
use stead_disk::manifest::{MANIFEST, ResultSet};

/// The name of the lock file, which is there as long as a run writes.
const LOCK: &str = ".stead.lock";

/// Between two attempts to take a folder.
const BETWEEN_ATTEMPTS: Duration = Duration::from_millis(50);

/// An output folder, held by this process until this is dropped, whose files appear whole or not at all.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    lock: Lock,
    keeps_partial: bool,
}

impl Folder {
    /// Takes a folder, making it and its parents where they are missing, and tries whether a file can be written to it.
    /// Temporary files of runs that were killed are removed.
    ///
    /// # Errors
    /// [`ReportError::Folder`] when there is none and none can be made, or when no file can be written to it;
    /// [`ReportError::Locked`] when another run holds it; [`ReportError::OtherManifest`] when results would replace a
    /// `manifest.json` that is none of stead.
    pub fn create(path: &Path) -> Result<Self, ReportError> {
        let fail = |cause| ReportError::Folder { path: path.to_owned(), cause };
        files::check_name(path).map_err(fail)?;
        if path.exists() && !path.is_dir() {
            return Err(fail(std::io::Error::new(std::io::ErrorKind::NotADirectory, "a file of that name is there")));
        }
        std::fs::create_dir_all(path).map_err(fail)?;
        let lock = Lock::take(&path.join(LOCK)).map_err(|error| match error {
            LockError::Held { process } => ReportError::Locked { path: path.to_owned(), process },
            LockError::System(cause) => fail(cause),
        })?;
        if lock.is_locked() {
            remove_stale(path, PREFIX);
        }
        // Gone again as soon as it is dropped.
        Staged::write(path, PREFIX, b"").map_err(fail)?;
        transaction::manifest_in(path)?;
        Ok(Self { path: path.to_owned(), lock, keeps_partial: false })
    }

    /// As [`Folder::create`], but waits for another run to let go of the folder, for so long.
    ///
    /// # Errors
    /// As [`Folder::create`].
    pub fn create_within(path: &Path, limit: Duration) -> Result<Self, ReportError> {
        let begun = Instant::now();
        loop {
            match Self::create(path) {
                Err(ReportError::Locked { .. }) if begun.elapsed() < limit => std::thread::sleep(BETWEEN_ATTEMPTS),
                result => return result,
            }
        }
    }

    /// Refuses a folder with a file of a name that results would replace though no manifest lists it, or with
    /// somebody's own in place of the folder for interrupted results: to be called before the long work.
    ///
    /// # Errors
    /// [`ReportError::OtherManifest`] with that file, and for a manifest that cannot be read.
    pub fn has_no_other<N: AsRef<str>>(&self, names: impl IntoIterator<Item = N>) -> Result<(), ReportError> {
        let manifest = transaction::manifest_in(&self.path)?;
        self.check_interrupted()?;
        names.into_iter().try_for_each(|name| transaction::check_listed(&self.path, &manifest, name.as_ref()))
    }

    /// Where the folder is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The lock file, for whoever ends the process without dropping this.
    pub fn lock_file(&self) -> &Path {
        self.lock.path()
    }

    /// The same folder, in which results of an interrupted run take the place of those of a finished one.
    #[must_use]
    pub fn keeping_partial(mut self, keeps_partial: bool) -> Self {
        self.keeps_partial = keeps_partial;
        self
    }

    /// The folder for results of an interrupted run of a command where finished ones of that command are in this
    /// folder, which they shall not replace: the one beside it, named with `.interrupted` behind. None where they
    /// belong here.
    ///
    /// # Errors
    /// As [`Folder::create`].
    pub fn beside_finished(&self, command: &str, is_interrupted: bool) -> Result<Option<Self>, ReportError> {
        (is_interrupted && self.shields(command, |_| true)?).then(|| self.interrupted()).transpose()
    }

    /// Whether a finished run of a command has left this file, too, among its results here, so that an interrupted run
    /// shall not replace them.
    ///
    /// # Errors
    /// [`ReportError`] for a manifest that cannot be read.
    pub fn has_finished(&self, command: &str, file: &str) -> Result<bool, ReportError> {
        self.shields(command, |set| set.file(file).is_some())
    }

    /// Whether finished results of a command, of which something else holds, are here and shall not be replaced by
    /// those of an interrupted run.
    fn shields(&self, command: &str, holds: impl Fn(&ResultSet) -> bool) -> Result<bool, ReportError> {
        if self.keeps_partial {
            return Ok(false);
        }
        let manifest = transaction::manifest_in(&self.path)?;
        Ok(manifest.of(command).is_some_and(|set| set.complete && !set.interrupted && holds(set)))
    }

    /// The folder beside this one for results of an interrupted run; they take the place of whatever is in it.
    ///
    /// # Errors
    /// As [`Folder::create`].
    pub fn beside(&self) -> Result<Self, ReportError> {
        self.interrupted().map(|folder| folder.keeping_partial(true))
    }

    fn interrupted(&self) -> Result<Self, ReportError> {
        self.check_interrupted()?;
        Self::create(&self.interrupted_path())
    }

    /// Refuses something else in place of the folder beside this one: a link, or a folder with files but no manifest.
    fn check_interrupted(&self) -> Result<(), ReportError> {
        let path = self.interrupted_path();
        let is_link = path.symlink_metadata().is_ok_and(|found| found.is_symlink());
        let is_ours =
            |name: &std::ffi::OsStr| name.to_str().is_some_and(|name| name == LOCK || name.starts_with(PREFIX));
        let mut entries = std::fs::read_dir(&path).into_iter().flatten().flatten();
        if is_link || (!path.join(MANIFEST).exists() && entries.any(|entry| !is_ours(&entry.file_name()))) {
            let problem = "it is a link, or has files and no manifest.json".to_owned();
            return Err(ReportError::OtherManifest { path, problem });
        }
        Ok(())
    }

    /// Where [`beside_finished`](Self::beside_finished) is.
    fn interrupted_path(&self) -> PathBuf {
        // A path as `.` has no name of its own.
        let path = match self.path.file_name() {
            Some(_) => self.path.clone(),
            None => self.path.canonicalize().unwrap_or_else(|_| self.path.clone()),
        };
        let mut name = path.file_name().unwrap_or_default().to_owned();
        name.push(".interrupted");
        path.with_file_name(name)
    }

    /// The results of a run of a command, in place of those of its last run here.
    pub fn results<'a>(&'a self, command: &'a str, inputs: &'a [InputFile]) -> Transaction<'a> {
        Transaction::new(&self.path, command, inputs)
    }

    /// Removes all results here that the manifest lists, and the manifest. What it does not list stays.
    ///
    /// # Errors
    /// [`ReportError`] for a manifest that cannot be read, or with the path of a file that cannot be removed.
    pub fn clear(&self) -> Result<(), ReportError> {
        let manifest = transaction::manifest_in(&self.path)?;
        let listed = manifest.results.iter().flat_map(|set| &set.files).map(|file| file.name.as_str());
        for name in listed.chain([MANIFEST]) {
            let path = self.path.join(name);
            files::remove(&path).map_err(|cause| ReportError::File { path, cause })?;
        }
        Ok(())
    }

    /// Writes one file that is no result, over an older one of that name, whole or not at all. Returns its path.
    ///
    /// # Errors
    /// [`ReportError::File`] with the path of the file; what was there is left as it was.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf, ReportError> {
        let path = self.path.join(name);
        match Staged::write(&self.path, PREFIX, bytes).and_then(|staged| staged.put(&path)) {
            Ok(()) => Ok(path),
            Err(cause) => Err(ReportError::File { path, cause }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn files_appear_whole_and_nothing_else_does() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("a/b");
        let folder = Folder::create(&path).unwrap();
        assert_eq!(folder.path(), path);
        folder.write("x.csv", b"old and longer").unwrap();
        let file = folder.write("x.csv", b"new").unwrap();
        assert_eq!(std::fs::read(&file).unwrap(), b"new");
        assert_eq!(names(&path), [LOCK, "x.csv"]);
        drop(folder);
        assert_eq!(names(&path), ["x.csv"]);
    }

    #[test]
    fn errors_name_the_path_and_leave_no_temporary_file() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("file");
        std::fs::write(&file, "").unwrap();
        let error = Folder::create(&file).unwrap_err();
        assert!(matches!(error, ReportError::Folder { .. }));
        let start = format!("{}: results cannot be written here: a file of that name", file.display());
        assert!(error.to_string().starts_with(&start), "{error}");

        let folder = Folder::create(&place.path().join("out")).unwrap();
        std::fs::create_dir(folder.path().join("best.csv")).unwrap();
        let best = folder.path().join("best.csv").display().to_string();
        let error = folder.write("best.csv", b"1").unwrap_err();
        assert!(error.to_string().contains(&best), "{error}");
        let error = folder.results("place", &[]).write(&[("a.csv", b"1".to_vec()), ("best.csv", vec![])]).unwrap_err();
        assert!(error.to_string().contains(&best), "{error}");
        assert_eq!(names(folder.path()), [LOCK, "best.csv"]);

        // Windows lets nobody remove a folder with a file that is open.
        if cfg!(windows) {
            return;
        }
        std::fs::remove_dir_all(folder.path()).unwrap();
        assert!(matches!(folder.write("best.csv", b"1"), Err(ReportError::File { .. })));
        assert!(matches!(folder.results("place", &[]).write(&[("best.csv", vec![])]), Err(ReportError::File { .. })));
    }

    #[test]
    fn a_second_writer_is_refused_and_one_that_was_killed_is_cleared_up_after() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::create(place.path()).unwrap();
        let message = Folder::create(place.path()).unwrap_err().to_string();
        let process = format!("another run of stead (process {}) writes to this folder", std::process::id());
        for part in [process.as_str(), "; allowed: another folder, or wait until the other run has ended"] {
            assert!(message.contains(part), "{part} in {message}");
        }
        drop(folder);
        std::fs::write(place.path().join(LOCK), "1").unwrap();
        Staged::write(place.path(), PREFIX, b"stale").unwrap().abandon().unwrap();
        drop(Folder::create(place.path()).unwrap());
        assert!(names(place.path()).is_empty());
    }

    #[test]
    fn a_manifest_of_something_else_is_left_alone() {
        let place = tempfile::tempdir().unwrap();
        std::fs::write(place.path().join(MANIFEST), "{\"name\": \"a web page\"}").unwrap();
        let error = Folder::create(place.path()).unwrap_err();
        assert!(matches!(error, ReportError::OtherManifest { .. }), "{error}");
        assert!(error.to_string().contains("manifest.json: is none of stead and is left as it is: "), "{error}");
        assert_eq!(names(place.path()), [MANIFEST]);
    }

    #[test]
    fn interrupted_results_go_to_no_folder_of_somebody_else() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::create(&place.path().join("out")).unwrap();
        let beside = place.path().join("out.interrupted");
        std::fs::create_dir(&beside).unwrap();
        drop(folder.beside().unwrap());
        std::fs::write(beside.join("mine.txt"), "mine").unwrap();
        let message = folder.beside().unwrap_err().to_string();
        assert!(message.contains("out.interrupted: is none of stead and is left as it is"), "{message}");
        std::fs::write(beside.join(MANIFEST), "{\"format\": 1, \"results\": []}").unwrap();
        drop(folder.beside().unwrap());
        #[cfg(unix)]
        {
            std::fs::rename(&beside, place.path().join("elsewhere")).unwrap();
            std::os::unix::fs::symlink(place.path().join("elsewhere"), &beside).unwrap();
            assert!(folder.beside().is_err());
        }
        assert_eq!(
            names(&place.path().join(if cfg!(unix) { "elsewhere" } else { "out.interrupted" })),
            [MANIFEST, "mine.txt"]
        );
    }

    #[test]
    fn files_that_no_manifest_lists_are_not_replaced() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::create(place.path()).unwrap();
        folder.results("place", &[]).write(&[("best.csv", b"1".to_vec())]).unwrap();
        std::fs::write(place.path().join("cell.svg"), "mine").unwrap();
        let both = [("best.csv", b"2".to_vec()), ("cell.svg", b"2".to_vec())];
        let message = folder.results("place", &[]).write(&both).unwrap_err().to_string();
        assert!(message.contains("cell.svg: is none of stead"), "{message}");
        let texts = ["best.csv", "cell.svg"].map(|name| std::fs::read_to_string(place.path().join(name)).unwrap());
        assert_eq!(texts, ["1", "mine"]);
        assert!(folder.has_no_other(["best.csv"]).is_ok() && folder.has_no_other(["best.csv", "cell.svg"]).is_err());
    }
}
