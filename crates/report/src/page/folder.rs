//! Page and scene of a results folder, written again from its files alone.

use super::made::made_of;
use super::{DATA, PageError, content};
use crate::Files;
use crate::output::{Folder, ReportError};
use std::path::{Path, PathBuf};
use stead_disk::files;
use stead_disk::input::InputError;
use stead_disk::manifest::{self, Found, MANIFEST, Manifest, Unlisted};

/// Why a folder gets no page.
#[derive(Debug, thiserror::Error)]
pub enum RewriteError {
    /// Its files make none.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The page cannot be written.
    #[error(transparent)]
    Output(#[from] ReportError),
}

/// What is requested, where something else is found.
const ALLOWED: &str = "a folder that `stead place` or `stead score --out` has written with a page";

/// Writes `report.html` and `cell.glb` of a folder again: the same bytes as the run has left, from its files. Returns
/// the paths.
///
/// # Errors
/// [`RewriteError::Input`] for a folder that lacks a file, mixes two runs, is of another format or was changed since,
/// with the file; nothing is written then.
pub fn rewrite(path: &Path) -> Result<Vec<PathBuf>, RewriteError> {
    let missing = |problem: String| InputError::new(path, problem).allowed(ALLOWED);
    if !path.is_dir() {
        return Err(missing("is no folder".to_owned()).into());
    }
    let manifest = match Manifest::find(path).map_err(|cause| missing(format!("{MANIFEST} cannot be read: {cause}")))? {
        Found::Manifest(manifest) => manifest,
        Found::Nothing => return Err(missing(format!("has no {MANIFEST}")).into()),
        Found::Other(why) => return Err(missing(format!("its {MANIFEST} is none of stead: {why}")).into()),
    };
    let set = manifest.results.iter().find(|set| set.file(DATA).is_some());
    let Some(set) = set else {
        let kinds: Vec<&str> = manifest.results.iter().map(|set| set.command.as_str()).collect();
        let problem = match &kinds[..] {
            [] => format!("{MANIFEST} lists no results"),
            kinds if kinds.iter().any(|kind| !content::sources(kind).is_empty()) => {
                format!("{MANIFEST} lists no {DATA}: the run left no page")
            }
            kinds => {
                format!("has results of `stead {}`, which alone makes the page of them", kinds.join("` and `stead "))
            }
        };
        return Err(missing(problem).into());
    };
    let mut files = Files::new();
    for (name, is_needed) in content::sources(&set.command) {
        let file = path.join(name);
        if set.file(name).is_none() && !is_needed {
            continue;
        }
        let bytes = files::read(&file).map_err(|cause| InputError::new(&file, unread(&cause)).allowed(ALLOWED))?;
        manifest::check(&file, &bytes, Unlisted::Refused)?;
        files.push((name.to_owned(), bytes));
    }
    let wrong = |error: PageError| InputError::new(&path.join(&error.file), error.problem).allowed(ALLOWED);
    let made = made_of(&files).map_err(wrong)?;
    let folder = Folder::create(path)?;
    let (anchor, bytes) = &files[0];
    Ok(folder.results(&set.command, &[]).joining(anchor, bytes).write(&made)?)
}

/// Why a file that the manifest lists is not read.
fn unread(cause: &std::io::Error) -> String {
    match cause.kind() {
        std::io::ErrorKind::NotFound => format!("is missing, though {MANIFEST} lists it"),
        _ => format!("cannot be read: {cause}"),
    }
}
