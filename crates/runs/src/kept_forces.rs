//! The file in which a run keeps the forces of its path, so that they are computed once.

use std::fmt::Write;
use std::path::PathBuf;
use stead_disk::Existing;
use stead_disk::files::new::write_new;
use stead_disk::files::read_own;
use stead_disk::input::{InputError, sha256, sha256_of};
use stead_model::task::ToolPath;
use stead_numerics::monitor::{Monitor, Progress};
use stead_removal::kept::{CutResult, load_of_row, load_rows};
use stead_removal::load::PointForces;
use stead_removal::operation::ForcesProblem;

/// How the first line of such a file begins.
const MARK: &str = "stead kept forces,1,";
/// How the line begins that stands before the loads of a tool that leans, followed by the digest of its path.
const LEAN: &str = "lean,";
/// What is said where something else is kept.
const ANEW: &str = "the forces are computed anew and kept: those in the file of [stock] keep were of another stock, path, cutter or \
                    program";
const ALLOWED: &str = "the name of a file that is not there yet, or of one with kept forces";

/// A file with the forces of a path. Its first line has the digests of what they were computed of, the program among
/// it, and of the other lines: rows of [`CutResult::rows`], and for each way in which the tool leans the digest of its
/// path and its loads.
#[derive(Debug, Clone, PartialEq)]
pub struct KeptForces {
    file: PathBuf,
    /// The place that names it.
    at: InputError,
}

impl KeptForces {
    /// The file that is named at a place.
    pub fn new(file: PathBuf, at: InputError) -> Self {
        Self { file, at }
    }

    /// What it keeps of a problem.
    pub(crate) fn of(&self, problem: &ForcesProblem) -> KeptOf<'_> {
        // The memory that it may take changes nothing.
        let all = (env!("CARGO_PKG_VERSION"), ForcesProblem { memory: 0.0, ..problem.clone() });
        KeptOf { keep: self, digest: sha256_of(&all), points: problem.operation.path.points().len() }
    }

    /// The file, where it is there.
    fn text(&self) -> Result<Option<String>, InputError> {
        let wrong = |problem: String| Err(self.at.clone().because(problem).allowed(ALLOWED));
        let bytes = match read_own(&self.file) {
            Ok(bytes) => bytes,
            Err(_) if self.file.symlink_metadata().is_err() => return Ok(None),
            Err(cause) => return wrong(format!("names a file that cannot be read: {cause}")),
        };
        match String::from_utf8(bytes) {
            Ok(text) if text.starts_with(MARK) => Ok(Some(text)),
            _ => wrong("names a file that has no kept forces, and is left as it is".to_owned()),
        }
    }
}

/// A file with the forces of a path, and the problem that it is used for.
pub(crate) struct KeptOf<'k> {
    keep: &'k KeptForces,
    /// Of all that the forces depend on.
    digest: String,
    /// Points of the path.
    points: usize,
}

impl KeptOf<'_> {
    /// What is kept of the cut. Where something else is, which is to be replaced, the monitor is told: a result does
    /// not depend on what was kept, so that it says nothing of it.
    ///
    /// # Errors
    /// [`InputError`] where the file is none of this kind.
    pub fn cut(&self, monitor: &Monitor) -> Result<Option<CutResult>, InputError> {
        let Some(text) = self.keep.text()? else { return Ok(None) };
        let known = self.body(&text).and_then(|body| CutResult::of_rows(parts(body).0, self.points));
        if known.is_none() {
            monitor.report(Progress::Note { text: ANEW });
        }
        Ok(known)
    }

    /// Keeps the rows of a cut.
    ///
    /// # Errors
    /// [`InputError`] where the file cannot be written or is none of this kind.
    pub fn put_cut(&self, rows: &str) -> Result<(), InputError> {
        // Looked at once more: it may be another one now.
        self.keep.text()?;
        self.put(rows)
    }

    /// The loads that are kept for paths on which the tool leans, where those of all are.
    ///
    /// # Errors
    /// Those of [`cut`](Self::cut).
    pub fn leaning(&self, paths: &[ToolPath]) -> Result<Option<Vec<Vec<PointForces>>>, InputError> {
        let text = self.keep.text()?;
        Ok(text.and_then(|text| leaning(parts(self.body(&text)?).1, paths)))
    }

    /// Keeps the loads for paths on which the tool leans beside what is kept of the cut, in place of other ones.
    ///
    /// # Errors
    /// Those of [`put_cut`](Self::put_cut).
    pub fn put_leaning(&self, paths: &[ToolPath], loads: &[Vec<PointForces>]) -> Result<(), InputError> {
        let text = self.keep.text()?.unwrap_or_default();
        // Somebody else keeps other forces there now.
        let Some(body) = self.body(&text) else { return Ok(()) };
        let mut rows = parts(body).0.to_owned();
        for (path, loads) in paths.iter().zip(loads) {
            // Writing to a string cannot fail.
            let _ = write!(rows, "{LEAN}{}\n{}", sha256_of(path), load_rows(loads));
        }
        self.put(&rows)
    }

    fn put(&self, rows: &str) -> Result<(), InputError> {
        let text = format!("{MARK}{},{}\n{rows}", self.digest, sha256(rows.as_bytes()));
        write_new(&self.keep.file, &text, Existing::Replaced)
    }

    /// All but the first line, where it is whole and of this problem.
    fn body<'t>(&self, text: &'t str) -> Option<&'t str> {
        let (first, body) = text.split_once('\n')?;
        let (of_problem, of_body) = first.strip_prefix(MARK)?.split_once(',')?;
        (of_problem == self.digest && of_body == sha256(body.as_bytes())).then_some(body)
    }
}

/// The rows of the cut, and those of leaning tools.
fn parts(body: &str) -> (&str, &str) {
    let split = body.find(&format!("\n{LEAN}")).map_or(body.len(), |at| at + 1);
    body.split_at(split)
}

/// The loads for paths, each under its digest.
fn leaning(text: &str, paths: &[ToolPath]) -> Option<Vec<Vec<PointForces>>> {
    let mut lines = text.lines();
    let of_path = |path: &ToolPath| {
        let head = lines.next()?.strip_prefix(LEAN)?;
        (head == sha256_of(path)).then_some(())?;
        (0..path.points().len()).map(|_| load_of_row(lines.next()?)).collect()
    };
    paths.iter().map(of_path).collect()
}
