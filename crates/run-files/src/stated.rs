//! What a run file states, key by key: kept with results, so that what has changed since can be named.

use serde_json::{Value, json};
use stead_format::place::Place;
use toml::de::DeValue;

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

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use stead_format::toml_file::TomlFile;
    use stead_runs::stated::changes;

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
