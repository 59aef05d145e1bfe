//! The file in which a run keeps the forces of its path, so that they are computed once.

use crate::ReadError;
use std::fmt::Write;
use std::path::PathBuf;
use stead_disk::Existing;
use stead_disk::files::new::write_new;
use stead_disk::files::read_own;
use stead_disk::input::{InputError, sha256, sha256_of};
use stead_model::task::ToolPath;
use stead_numerics::message::Note;
use stead_removal::kept::{CutResult, load_of_row, load_rows};
use stead_removal::operation::ForcesProblem;
use stead_removal::outcome::PointForces;

/// How the first line of such a file begins.
const MARK: &str = "stead kept forces,1,";
/// How the line begins that stands before the loads of a tool that leans, followed by the digest of its path.
const LEAN: &str = "lean,";
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

    /// What is kept of the cut of a problem, where that is so; and a note where something else is kept, which is
    /// replaced.
    ///
    /// # Errors
    /// [`InputError`] where the file is none of this kind.
    pub fn known(&self, problem: &ForcesProblem) -> Result<(Option<CutResult>, Option<Note>), InputError> {
        let Some(text) = self.text()? else { return Ok((None, None)) };
        let points = problem.operation.path.points().len();
        let known = body(&text, &digest(problem)).and_then(|body| CutResult::of_rows(parts(body).0, points));
        let note = known.is_none().then(|| {
            let file = self.file.display();
            format!(
                "the forces are computed anew and kept: those in {file} were of another stock, path, cutter or program"
            )
            .into()
        });
        Ok((known, note))
    }

    /// Keeps what was computed of a problem.
    ///
    /// # Errors
    /// [`InputError`] where the file cannot be written or is none of this kind.
    pub fn put(&self, problem: &ForcesProblem, rows: &str) -> Result<(), InputError> {
        // Looked at once more: it may be another one now.
        self.text()?;
        let text = format!("{MARK}{},{}\n{rows}", digest(problem), sha256(rows.as_bytes()));
        write_new(&self.file, &text, Existing::Replaced)
    }

    /// The loads that are kept for paths on which the tool leans, where those of all are.
    ///
    /// # Errors
    /// Those of [`known`](Self::known).
    pub fn leaning(
        &self,
        problem: &ForcesProblem,
        paths: &[ToolPath],
    ) -> Result<Option<Vec<Vec<PointForces>>>, ReadError> {
        let Some(text) = self.text()? else { return Ok(None) };
        let found = body(&text, &digest(problem)).and_then(|body| leaning(parts(body).1, paths));
        Ok(found)
    }

    /// Keeps the loads for paths on which the tool leans beside what is kept of the problem, in place of other ones.
    ///
    /// # Errors
    /// Those of [`put`](Self::put).
    pub fn put_leaning(
        &self,
        problem: &ForcesProblem,
        paths: &[ToolPath],
        loads: &[Vec<PointForces>],
    ) -> Result<(), InputError> {
        let text = self.text()?.unwrap_or_default();
        // Somebody else keeps other forces there now.
        let Some(body) = body(&text, &digest(problem)) else { return Ok(()) };
        let mut rows = parts(body).0.to_owned();
        for (path, loads) in paths.iter().zip(loads) {
            // Writing to a string cannot fail.
            let _ = write!(rows, "{LEAN}{}\n{}", sha256_of(path), load_rows(loads));
        }
        self.put(problem, &rows)
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

/// Of all that forces depend on.
fn digest(problem: &ForcesProblem) -> String {
    // What it may take changes nothing.
    sha256_of(&(env!("CARGO_PKG_VERSION"), ForcesProblem { memory: 0.0, ..problem.clone() }))
}

/// All but the first line, where it is whole and of the problem with this digest.
fn body<'t>(text: &'t str, digest: &str) -> Option<&'t str> {
    let (first, body) = text.split_once('\n')?;
    let (of_problem, of_body) = first.strip_prefix(MARK)?.split_once(',')?;
    (of_problem == digest && of_body == sha256(body.as_bytes())).then_some(body)
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
