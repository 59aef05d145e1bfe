//! What a run file states, key by key: kept with results, so that what has changed since can be named, and whether a
//! score depends on it.

use serde_json::{Value, json};
use std::collections::BTreeSet;
use stead_format::place::Place;
use toml::de::DeValue;

/// Tables of a run file on which the score of a placement does not depend.
const BESIDE_THE_SCORE: [&str; 4] = ["output", "search", "certificate", "reference"];

/// Keys that name a thing, or a file whose bytes are compared: another name is no other thing.
const NAMES: [&str; 7] = ["name", "robot", "task", "surroundings", "hull", "mesh", "robots"];

/// The keys of a file with their values, those of `--set` among them.
pub(crate) fn stated(root: &Place<'_>) -> Value {
    root.value.map_or(Value::Null, |value| json_of(value.get_ref()))
}

fn json_of(value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => json!(text),
        DeValue::Boolean(value) => json!(value),
        DeValue::Integer(number) => {
            let text = number.as_str();
            i64::from_str_radix(text, number.radix()).map_or_else(|_| json!(text), |number| json!(number))
        }
        DeValue::Float(number) => {
            let text = number.as_str();
            text.parse()
                .ok()
                .filter(|number: &f64| number.is_finite())
                .map_or_else(|| json!(text), |number| json!(number))
        }
        DeValue::Datetime(time) => json!(time.to_string()),
        DeValue::Array(array) => array.iter().map(|entry| json_of(entry.get_ref())).collect(),
        DeValue::Table(table) => {
            table.iter().map(|(key, value)| (key.get_ref().to_string(), json_of(value.get_ref()))).collect()
        }
    }
}

/// A key in which two run files differ, as `cell.x_mm` or `shape[2].box_mm[1]`, with both values.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Change {
    pub key: String,
    pub before: Option<Value>,
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
pub(crate) fn changes(before: &Value, now: &Value) -> Vec<Change> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use stead_format::toml_file::TomlFile;

    fn changed(before: &str, now: &str) -> Vec<(String, bool)> {
        let stated_in = |text: &str| {
            let source = TomlFile::new(Path::new("run.toml"), text.as_bytes().to_vec()).unwrap();
            stated(&source.parse().unwrap().root())
        };
        let found = changes(&stated_in(before), &stated_in(now));
        found.into_iter().map(|change| (change.key.clone(), change.matters())).collect()
    }

    #[test]
    fn what_says_the_same_in_other_words_is_no_change() {
        let before = "robot = 'a.toml'\ncell = { x_mm = [1, 2] }";
        assert_eq!(changed(before, "# new\nrobot = \"a.toml\"\n[cell]\nx_mm = [1.0, 2e0]\n[search]\n"), []);
    }

    #[test]
    fn a_change_is_named_by_its_key_and_names_do_not_matter() {
        let before = "robot = 'a.toml'\n[cell]\nx_mm = [1, 2]\n[[shape]]\nname = 'a'\nbox_mm = [1, 2, 3]\n";
        let now = "robot = 'b.toml'\n[cell]\nx_mm = [1, 3]\n[[shape]]\nname = 'b'\nbox_mm = [1, 2, 4]\n\
                   [search]\nseed = 3\n[criterion]\nforce_uncertainty = 0.1\n";
        let expected = [
            ("cell.x_mm[2]", true),
            ("criterion.force_uncertainty", true),
            ("robot", false),
            ("search.seed", false),
            ("shape[1].box_mm[3]", true),
            ("shape[1].name", false),
        ];
        assert_eq!(changed(before, now), expected.map(|(key, matters)| (key.to_owned(), matters)));
    }
}
