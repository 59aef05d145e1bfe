//! The JSON Schema of each kind of file, from the types that read it: units, ranges and what the keys mean.
//!
//! An editor that knows TOML checks and completes a file whose first line is `#:schema` and the path of its schema. The
//! schemas are kept in `configs/schema/`; after a change of a type, `stead schema NAME > configs/schema/NAME.json`
//! renews one.

use crate::assess::AssessmentFile;
use crate::compensate::CompensationFile;
use crate::forces::ForcesFile;
use crate::identify::IdentificationFile;
use crate::run::RunFile;
use crate::simulation::SimulationFile;
use crate::study::StudyFile;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema, generate::SchemaSettings};
use serde_json::{Map, Value};
use stead_format::robot::RobotFile;
use stead_format::surroundings::SurroundingsFile;

/// There is no schema of this name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no schema '{name}' (nearest known one: {nearest}); allowed: {}", names().join(", "))]
pub struct UnknownSchema {
    /// The name requested.
    pub name: String,
    /// The known name that is nearest to it.
    pub nearest: &'static str,
}

/// Makes the schema of one kind of file.
type Make = fn() -> Schema;

/// Every kind of file, by the name of its schema.
const SCHEMAS: [(&str, Make); 10] = [
    ("run", of::<RunFile>),
    ("robot", of::<RobotFile>),
    ("forces", of::<ForcesFile>),
    ("simulate", of::<SimulationFile>),
    ("assess", of::<AssessmentFile>),
    ("identify-fit", || requiring(of::<IdentificationFile>(), &["sheet"])),
    ("identify-plan", || requiring(of::<IdentificationFile>(), &["noise_mm", "plan"])),
    ("compensate", of::<CompensationFile>),
    ("study", of::<StudyFile>),
    ("surroundings", of::<SurroundingsFile>),
];

/// The names of all schemas.
pub fn names() -> Vec<&'static str> {
    SCHEMAS.iter().map(|(name, _)| *name).collect()
}

/// The schema of a kind of file as a JSON document (draft 7).
///
/// # Errors
/// [`UnknownSchema`] when there is none of this name.
///
/// ```
/// use stead_run_files::schema::schema;
/// assert!(schema("run")?.contains("beta_step_deg"));
/// assert_eq!(schema("robbot").unwrap_err().nearest, "robot");
/// # Ok::<(), stead_run_files::schema::UnknownSchema>(())
/// ```
pub fn schema(name: &str) -> Result<String, UnknownSchema> {
    match SCHEMAS.iter().find(|(known, _)| *known == name) {
        Some((_, make)) => Ok(format!("{:#}\n", make().as_value())),
        None => {
            let near = |known: &str| strsim::jaro(known, name);
            let nearest = names().into_iter().max_by(|a, b| near(a).total_cmp(&near(b))).unwrap_or_default();
            Err(UnknownSchema { name: name.to_owned(), nearest })
        }
    }
}

fn of<T: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft07();
    let settings = settings.with_transform(RecursiveTransform(without_null));
    let settings = settings.with_transform(RecursiveTransform(closed));
    settings.into_generator().into_root_schema_for::<T>()
}

/// Requires optional keys, which one command needs and another that reads the same file does not.
fn requiring(mut schema: Schema, keys: &[&str]) -> Schema {
    if let Some(Value::Array(required)) = schema.get_mut("required") {
        required.extend(keys.iter().map(|key| Value::from(*key)));
    }
    schema
}

/// Refuses keys that a table does not declare, as the reader does.
fn closed(schema: &mut Schema) {
    if schema.get("properties").is_some() {
        schema.insert("additionalProperties".to_owned(), false.into());
    }
}

/// Takes the null out that an optional key may be in JSON: TOML has none, a key is left out.
fn without_null(schema: &mut Schema) {
    let Some(object) = schema.as_object_mut() else { return };
    for key in ["type", "enum"] {
        if let Some(Value::Array(values)) = object.get_mut(key) {
            values.retain(|value| !value.is_null() && value != "null");
            if key == "type" && values.len() == 1 {
                let one = values.remove(0);
                object.insert(key.to_owned(), one);
            }
        }
    }
    let null = Value::Object(Map::from_iter([("type".to_owned(), "null".into())]));
    if let Some(Value::Array(choices)) = object.get_mut("anyOf")
        && choices.contains(&null)
    {
        choices.retain(|choice| *choice != null);
        if choices.len() == 1 {
            let one = choices.remove(0);
            object.remove("anyOf");
            object.insert("allOf".to_owned(), Value::Array(vec![one]));
        }
    }
}

#[cfg(test)]
mod tests;
