//! The journal of a shard: a line for each finished case, each with its own digest, so that a line that was torn is
//! told.

use super::StudyError;
use super::table::{Column, TableCell};
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{Seek, Write};
use std::path::{Path, PathBuf};
use stead_disk::files;
use stead_disk::input::sha256;

/// A finished case.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    /// The digest of the case.
    pub id: String,
    /// Its row of results.
    pub row: Vec<TableCell>,
    /// Where and how long it was computed, which is no result.
    pub timing: Timing,
}

/// Where and how long a case was computed.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Timing {
    /// Time on the clock. s
    pub seconds: f64,
    /// Threads that it had.
    pub threads: usize,
    /// The machine.
    pub host: String,
}

/// An entry as a line: values as in a CSV file, which comes back exactly.
#[derive(Serialize, Deserialize)]
struct Line {
    id: String,
    row: Vec<String>,
    timing: Timing,
}

const BEFORE_DIGEST: &str = "{\"sha256\":\"";
const BEFORE_ENTRY: &str = "\",\"case\":";

impl Entry {
    fn line(&self) -> Result<String, StudyError> {
        let line = Line {
            id: self.id.clone(),
            row: self.row.iter().map(TableCell::written).collect(),
            timing: self.timing.clone(),
        };
        let entry = serde_json::to_string(&line).map_err(|cause| StudyError::format("the journal", &cause))?;
        Ok(format!("{BEFORE_DIGEST}{}{BEFORE_ENTRY}{entry}}}\n", sha256(entry.as_bytes())))
    }

    /// The entry of a whole line; none where it was torn or changed.
    fn of(line: &str, columns: &[Column]) -> Option<Self> {
        let rest = line.strip_prefix(BEFORE_DIGEST)?;
        let (digest, rest) = rest.split_once(BEFORE_ENTRY)?;
        let entry = rest.strip_suffix('}')?;
        if sha256(entry.as_bytes()) != digest {
            return None;
        }
        let Line { id, row, timing } = serde_json::from_str(entry).ok()?;
        if row.len() != columns.len() {
            return None;
        }
        let row =
            row.iter().zip(columns).map(|(text, column)| TableCell::read(text, column.kind)).collect::<Option<_>>()?;
        Some(Self { id, row, timing })
    }
}

/// A journal as it was left.
#[derive(Debug, Default, PartialEq)]
pub(super) struct JournalRead {
    /// The entries up to the first line that is not whole.
    pub entries: Vec<Entry>,
    /// The length of their lines. Bytes
    pub whole: u64,
    /// That a line was changed, which a process that was killed does not do: it leaves the last one torn.
    pub problem: Option<String>,
}

/// Reads a journal; one that is not there has no entries.
///
/// # Errors
/// [`StudyError::File`] for a journal that cannot be read.
pub(super) fn read(path: &Path, columns: &[Column]) -> Result<JournalRead, StudyError> {
    let bytes = match files::read_own(path) {
        Ok(bytes) => bytes,
        Err(cause) if cause.kind() == std::io::ErrorKind::NotFound => return Ok(JournalRead::default()),
        Err(cause) => return Err(StudyError::read(path, cause)),
    };
    let mut read = JournalRead::default();
    for line in bytes.split_inclusive(|byte| *byte == b'\n') {
        let text = std::str::from_utf8(line).ok().and_then(|line| line.strip_suffix('\n'));
        let Some(entry) = text.and_then(|line| Entry::of(line, columns)) else {
            let place = format!("{}: line {}", path.display(), read.entries.len() + 1);
            let problem = format!("{place} is not as it was written; its case and those behind it are done again");
            read.problem = line.ends_with(b"\n").then_some(problem);
            break;
        };
        read.entries.push(entry);
        read.whole += line.len() as u64;
    }
    Ok(read)
}

/// A journal that entries are put to.
#[derive(Debug)]
pub(super) struct Journal {
    path: PathBuf,
    file: File,
}

impl Journal {
    /// Opens a journal behind its whole lines.
    ///
    /// # Errors
    /// [`StudyError::File`] where it cannot be written.
    pub fn open(path: &Path, whole: u64) -> Result<Self, StudyError> {
        let fail = |cause| StudyError::write(path, cause);
        let mut file = files::open_own(File::options().create(true).truncate(false).write(true), path).map_err(fail)?;
        file.set_len(whole).map_err(fail)?;
        file.seek(std::io::SeekFrom::End(0)).map_err(fail)?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Puts an entry to it, on the disk.
    ///
    /// # Errors
    /// [`StudyError::File`]: the disk is full, or gone.
    pub fn push(&mut self, entry: &Entry) -> Result<(), StudyError> {
        let line = entry.line()?;
        let written = self.file.write_all(line.as_bytes()).and_then(|()| self.file.sync_data());
        written.map_err(|cause| StudyError::write(&self.path, cause))
    }
}
