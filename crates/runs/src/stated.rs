//! In which keys the run file of a result and the one of now differ, and whether a score depends on them.

use serde_json::Value;
use std::collections::BTreeSet;

/// Tables of a run file on which the score of a placement does not depend.
const BESIDE_THE_SCORE: [&str; 4] = ["output", "search", "certificate", "reference"];

/// Keys that name a thing, or a file whose bytes are compared: another name is no other thing.
const NAMES: [&str; 7] = ["name", "robot", "task", "surroundings", "hull", "mesh", "robots"];

/// A key in which two run files differ, as `cell.x_mm` or `shape[2].box_mm[1]`, with both values.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// The key.
    pub key: String,
    /// The value in the first file, where it has the key.
    pub before: Option<Value>,
    /// The value in the second file, where it has the key.
    pub now: Option<Value>,
}

impl Change {
    /// Whether the score of a placement may depend on the key. Names of files do not count: their bytes are compared.
    pub fn matters(&self) -> bool {
        let steps = || self.key.split('.').map(|step| step.split('[').next().unwrap_or_default());
        let is_beside = steps().next().is_some_and(|table| BESIDE_THE_SCORE.contains(&table));
        !is_beside && !steps().next_back().is_some_and(|key| NAMES.contains(&key))
    }
}

/// The keys in which two run files differ. A table that is not there is one without keys.
pub fn changes(before: &Value, now: &Value) -> Vec<Change> {
    let mut found = Vec::new();
    compare("", Some(before), Some(now), &mut found);
    found
}

fn compare(key: &str, before: Option<&Value>, now: Option<&Value>, found: &mut Vec<Change>) {
    if let (Some(Value::Array(before)), Some(Value::Array(now))) = (before, now)
        && before.len() == now.len()
    {
        for (number, (before, now)) in (1..).zip(before.iter().zip(now)) {
            compare(&format!("{key}[{number}]"), Some(before), Some(now), found);
        }
        return;
    }
    let both = [before, now];
    if both.iter().all(|value| value.is_none_or(Value::is_object)) {
        let tables = both.map(|value| value.and_then(Value::as_object));
        let keys: BTreeSet<&String> = tables.iter().flatten().flat_map(|table| table.keys()).collect();
        for inner in keys {
            let path = if key.is_empty() { inner.clone() } else { format!("{key}.{inner}") };
            let [before, now] = tables.map(|table| table.and_then(|table| table.get(inner)));
            compare(&path, before, now, found);
        }
        return;
    }
    let [a, b] = both.map(|value| value.and_then(Value::as_f64));
    if before != now && (a.is_none() || a != b) {
        found.push(Change { key: key.to_owned(), before: before.cloned(), now: now.cloned() });
    }
}
