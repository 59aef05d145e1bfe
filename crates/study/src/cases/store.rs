//! The folder of a study: what is where, and which rows are done.

use super::StudyError;
use super::journal::{self, Entry, JournalRead};
use super::lock::Lock;
use super::plan::Plan;
use super::row::result_columns;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use stead_disk::files::{self, Staged, is_of_disk};

/// One of several parts of a study: the cases I, I + N, and so on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Shard {
    /// Its number, from 1.
    pub index: usize,
    /// How many there are.
    pub count: usize,
}

impl Shard {
    /// The whole study.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// What is allowed, in words.
    pub const ALLOWED: &'static str = "I/N with whole numbers, N from 1 to 9999 and I from 1 to N";

    /// The shard of a text `I/N`.
    pub fn parse(text: &str) -> Option<Self> {
        let (index, count) = text.split_once('/')?;
        let shard = Self { index: index.parse().ok()?, count: count.parse().ok()? };
        ((1..=9999).contains(&shard.count) && (1..=shard.count).contains(&shard.index)).then_some(shard)
    }

    /// Whether a case (from 1) is in it.
    pub fn has(self, case: usize) -> bool {
        case % self.count == self.index % self.count
    }

    fn name(self) -> String {
        format!("{:04}-of-{:04}", self.index, self.count)
    }

    /// How the names of its temporary files begin.
    fn temporary(self) -> String {
        format!(".stead-{}-", self.name())
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

/// What `study.json` says.
#[derive(Debug, Serialize, Deserialize)]
struct Header {
    format: u32,
    study: String,
    cases: usize,
    /// The digest of all cases.
    sha256: String,
}

/// The folder of a study.
#[derive(Debug, Clone)]
pub(super) struct Store {
    folder: PathBuf,
}

impl Store {
    pub fn at(folder: &Path) -> Self {
        Self { folder: folder.to_owned() }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    fn shards(&self) -> PathBuf {
        self.path("shards")
    }

    /// A file of a shard, by its ending.
    pub fn of_shard(&self, shard: Shard, ending: &str) -> PathBuf {
        self.shards().join(format!("{}{ending}", shard.name()))
    }

    /// Makes the folder and says in it which study it is of.
    ///
    /// # Errors
    /// [`StudyError::Folder`] for the folder of another study, [`StudyError::File`] where it cannot be written.
    pub fn begin(&self, plan: &Plan) -> Result<(), StudyError> {
        let shards = self.shards();
        self.check(plan)?;
        std::fs::create_dir_all(&shards).map_err(|cause| match is_of_disk(&cause) {
            true => StudyError::write(&shards, cause),
            false => StudyError::Folder {
                path: self.folder.clone(),
                problem: format!("results cannot be written here: {cause}"),
                allowed: "a folder that can be made or written to".to_owned(),
            },
        })?;
        let _lock = self.lock()?;
        self.check(plan)?;
        let header = Header { format: 1, study: plan.name(), cases: plan.cases.len(), sha256: plan.digest() };
        let mut bytes = serde_json::to_vec_pretty(&header).map_err(|cause| StudyError::format("study.json", &cause))?;
        bytes.push(b'\n');
        self.write("study.json", &bytes)
    }

    /// Refuses the folder of another study. One whose file was edited is the same study.
    ///
    /// # Errors
    /// [`StudyError::Folder`].
    pub fn check(&self, plan: &Plan) -> Result<(), StudyError> {
        let path = self.path("study.json");
        let folder = |problem: String| StudyError::Folder {
            path: path.clone(),
            problem,
            allowed: "a folder of this study, or a new one".to_owned(),
        };
        match files::read(&path) {
            Err(_) if path.ancestors().skip(1).any(Path::is_file) => Err(folder("is below a file".to_owned())),
            Err(cause) if cause.kind() == std::io::ErrorKind::NotFound => Ok(()),
            Err(cause) => Err(StudyError::read(&path, cause)),
            Ok(bytes) => {
                let header: Header = serde_json::from_slice(&bytes)
                    .map_err(|cause| folder(format!("is no description of a study: {cause}")))?;
                let is_same = header.study == plan.name();
                if is_same {
                    Ok(())
                } else {
                    Err(folder(format!("is of another study, {}, and not of {}", header.study, plan.name())))
                }
            }
        }
    }

    /// The lock of the files that shards have in common.
    pub fn lock(&self) -> Result<Lock, StudyError> {
        let lock = Lock::wait(&self.path("study.lock"))?;
        lock.clean(&self.folder, OF_FOLDER);
        Ok(lock)
    }

    /// The lock of whoever writes the files of the best cases.
    pub fn lock_best(&self) -> Result<Lock, StudyError> {
        Lock::take(&self.shards().join("best.lock"), "the best cases of the study")
    }

    /// The lock of a shard.
    pub fn lock_shard(&self, shard: Shard) -> Result<Lock, StudyError> {
        let lock = Lock::take(&self.of_shard(shard, ".lock"), &format!("shard {shard} of the study"))?;
        lock.clean(&self.shards(), &shard.temporary());
        Ok(lock)
    }

    /// Writes a file whole: under another name first.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), StudyError> {
        write(&self.path(name), bytes, OF_FOLDER)
    }

    /// All shards that have left anything, in the order of their names.
    pub fn found(&self) -> Vec<Shard> {
        let entries = std::fs::read_dir(self.shards()).into_iter().flatten().flatten();
        let shard = |name: &str| {
            let (name, ending) = name.split_at_checked("0001-of-0001".len())?;
            let (index, count) = name.split_once("-of-")?;
            Shard::parse(&format!("{}/{}", index.parse::<usize>().ok()?, count.parse::<usize>().ok()?))
                .filter(|_| ending == ".jsonl")
        };
        let mut shards: Vec<Shard> = entries.filter_map(|entry| shard(entry.file_name().to_str()?)).collect();
        shards.sort_by_key(|shard| (shard.count, shard.index));
        shards
    }

    /// What all shards have finished.
    pub fn finished(&self, problems: &mut Vec<String>) -> Result<Entries, StudyError> {
        let mut finished = Entries::default();
        for shard in self.found() {
            let read = self.journal(shard)?;
            problems.extend(read.problem);
            finished.extend(read.entries.into_iter().map(|entry| (entry.id.clone(), entry)));
        }
        Ok(finished)
    }

    /// The journal of a shard, as it was left.
    pub fn journal(&self, shard: Shard) -> Result<JournalRead, StudyError> {
        journal::read(&self.of_shard(shard, ".jsonl"), &result_columns())
    }
}

/// Finished cases by their digests.
pub(super) type Entries = HashMap<String, Entry>;

/// Temporary files of the folder itself, which are written under its lock.
const OF_FOLDER: &str = ".stead-study-";
/// Writes a file whole: under another name in the same folder first, and on the disk before it is renamed.
fn write(path: &Path, bytes: &[u8], prefix: &str) -> Result<(), StudyError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let written = Staged::write(folder, prefix, bytes).and_then(|staged| staged.put(path));
    written.map_err(|cause| StudyError::write(path, cause))
}
