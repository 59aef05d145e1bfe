//! Placements that are kept: folders as `stead score --out` writes them.

use super::edits;
use super::kept::{Kept, numbers_in, strings};
use crate::files::FieldOverride;
use serde_json::{Map, Value, json};
use std::path::Path;
use stead_disk::files;
use stead_disk::quote::garbles;
use stead_report::Folder;

/// What its folder is called, with a number behind.
pub(super) const NAME: &str = "placement-";
/// The document in it.
const DOCUMENT: &str = "score.json";

/// A placement that is kept.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pin {
    /// The name of its folder.
    pub name: String,
    /// What the page calls it.
    label: String,
    /// Values that were changed in the session when it was kept.
    edits: Vec<String>,
    /// What the page shows of its `score.json`.
    document: Map<String, Value>,
}

/// The keys of `score.json` that the page shows.
const SHOWN: [&str; 7] =
    ["placement", "placement_exact", "orientation", "external_axes", "best", "feasible", "interrupted"];

impl Pin {
    /// Those in a folder, in the order of their numbers, with what an earlier session said of them. Temporary files of
    /// one that was killed while it kept a placement go.
    pub fn all_in(folder: &Folder, kept: &Kept) -> Vec<Self> {
        let read = |number: u64| {
            let name = format!("{NAME}{number}");
            let document: Value = serde_json::from_slice(&file(folder.path(), &name, DOCUMENT)?).ok()?;
            let said = kept.pin(&name);
            let label = said["label"].as_str().filter(|label| !label.contains(garbles)).unwrap_or_default().to_owned();
            Some(Self { label, edits: strings(&said["edits"]), document: shown(&document), name })
        };
        let numbers = numbers_in(folder.path(), NAME, "");
        for placement in numbers.iter().map(|number| folder.path().join(format!("{NAME}{number}"))) {
            if placement.symlink_metadata().is_ok_and(|found| found.is_dir()) {
                files::remove_abandoned(&placement, files::PREFIX);
            }
        }
        numbers.into_iter().filter_map(read).collect()
    }

    /// One whose folder has been written, by its `score.json`.
    pub fn new(name: &str, label: &str, edits: &[FieldOverride], document: &Value) -> Self {
        let edits = edits.iter().map(ToString::to_string).collect();
        Self { name: name.to_owned(), label: label.to_owned(), edits, document: shown(document) }
    }

    /// As the page has it.
    pub fn entry(&self) -> Value {
        let mut entry = self.document.clone();
        entry.insert("name".to_owned(), self.name.clone().into());
        entry.insert("label".to_owned(), self.label.clone().into());
        entry.insert("edits".to_owned(), self.edits.clone().into());
        Value::Object(entry)
    }

    /// What its own folder does not hold.
    pub fn kept(&self) -> Value {
        json!({ "name": self.name, "label": self.label, "edits": self.edits })
    }

    /// The values that were changed when it was kept.
    pub fn edits(&self) -> Vec<FieldOverride> {
        self.edits.iter().flat_map(|text| edits::allowed(text)).collect()
    }
}

fn shown(document: &Value) -> Map<String, Value> {
    let some = SHOWN.iter().filter_map(|key| Some(((*key).to_owned(), document.get(*key)?.clone())));
    some.collect()
}

/// A file of a kept placement, by the names of folder and file; none where there is no such file. Links are not
/// followed: they may lead anywhere.
pub(super) fn file(folder: &Path, pin: &str, name: &str) -> Option<Vec<u8>> {
    let is_plain = |text: &str| {
        let is_of = |c: char| c.is_ascii_alphanumeric() || ['.', '-', '_'].contains(&c);
        !text.is_empty() && !text.starts_with('.') && text.chars().all(is_of)
    };
    let folder = folder.join(pin);
    let is_folder = || folder.symlink_metadata().is_ok_and(|found| found.is_dir());
    (pin.starts_with(NAME) && is_plain(pin) && is_plain(name) && is_folder())
        .then(|| files::read_own(&folder.join(name)).ok())?
}
