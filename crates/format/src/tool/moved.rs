//! Where the keys of `[tool]` and `[cut]` were before there were these tables.

use super::{CutTable, ToolTable};
use schemars::{JsonSchema, schema_for};

/// Where the keys are today that a table or a key of earlier files held, if it is one of these.
pub(crate) fn successor(path: &str) -> Option<String> {
    if ["cutting", "milling"].contains(&path) {
        return Some("[tool] for the cutter and [cut] for its cut".to_owned());
    }
    let key = path.strip_prefix("stability.")?;
    if has_key::<ToolTable>(key) {
        Some(format!("tool.{key}"))
    } else {
        has_key::<CutTable>(key).then(|| format!("cut.{key}"))
    }
}

fn has_key<T: JsonSchema>(key: &str) -> bool {
    schema_for!(T).get("properties").is_some_and(|properties| properties.get(key).is_some())
}
