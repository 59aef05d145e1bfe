//! What an earlier session has kept in its folder, and the numbers of what is there.

use super::{edits, place::Place};
use crate::Error;
use crate::files::FieldOverride;
use serde_json::{Map, Value};
use std::io::ErrorKind;
use std::path::Path;
use stead_disk::files;
use stead_problem::problem::Problem;
use stead_report::Folder;

/// The file of a session beside its placements.
pub(super) const FILE: &str = "live.json";
/// What one that is not readable is kept as, with a number between.
const ASIDE: [&str; 2] = ["live-unreadable-", ".json"];

/// What an earlier session has left.
#[derive(Debug, Default)]
pub(super) struct Kept(Map<String, Value>);

impl Kept {
    /// What is in a folder, and a note where it cannot be read: it is then kept under another name.
    ///
    /// # Errors
    /// [`Error::Failed`]: it cannot be read, and not be kept either.
    pub fn in_folder(folder: &Folder) -> Result<(Self, Option<String>), Error> {
        let path = folder.path().join(FILE);
        let problem = match files::read_own(&path) {
            Ok(bytes) => match serde_json::from_slice(&bytes) {
                Ok(Value::Object(kept)) => return Ok((Self(kept), None)),
                Ok(_) => "it is no JSON object".to_owned(),
                Err(error) => error.to_string(),
            },
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok((Self::default(), None)),
            Err(error) => error.to_string(),
        };
        let [before, behind] = ASIDE;
        let number = numbers_in(folder.path(), before, behind).last().map_or(1, |last| last + 1);
        let aside = folder.path().join(format!("{before}{number}{behind}"));
        std::fs::rename(&path, &aside).map_err(|error| Error::failed(format!("{}: {error}", path.display())))?;
        let (path, aside) = (path.display(), aside.display());
        let lost = "where the part was, changed values and the names of placements are not known";
        Ok((Self::default(), Some(format!("{path} is not readable ({problem}) and is kept as {aside}: {lost}"))))
    }

    /// The values that were changed.
    pub fn edits(&self) -> Vec<FieldOverride> {
        self.0.get("edits").map(strings).iter().flatten().flat_map(|text| edits::allowed(text)).collect()
    }

    /// Where the part was last.
    pub fn place(&self, problem: &Problem) -> Option<Place> {
        Place::of_entry(problem, self.0.get("place")?)
    }

    /// What was said of a placement beside its folder.
    pub fn pin(&self, name: &str) -> Value {
        let pins = self.0.get("pins").and_then(Value::as_array);
        pins.into_iter().flatten().find(|pin| pin["name"] == name).cloned().unwrap_or_default()
    }

    /// The last number of each kind of what was written.
    pub fn numbers(&self) -> Map<String, Value> {
        self.0.get("numbers").and_then(Value::as_object).cloned().unwrap_or_default()
    }
}

/// The numbers in the names of what is in a folder, in their order.
pub(super) fn numbers_in(folder: &Path, before: &str, behind: &str) -> Vec<u64> {
    let number = |name: &str| {
        let number: u64 = name.strip_prefix(before)?.strip_suffix(behind)?.parse().ok()?;
        (format!("{before}{number}{behind}") == name).then_some(number)
    };
    let names = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.file_name());
    let mut numbers: Vec<u64> = names.filter_map(|name| number(name.to_str()?)).collect();
    numbers.sort_unstable();
    numbers
}

/// The texts of a list.
pub(super) fn strings(list: &Value) -> Vec<String> {
    list.as_array().into_iter().flatten().filter_map(|one| one.as_str().map(str::to_owned)).collect()
}
