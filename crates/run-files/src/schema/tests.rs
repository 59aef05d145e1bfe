use super::*;
use serde::{Serialize, de::DeserializeOwned};
use std::fmt::Debug;
use std::path::{Path, PathBuf};
use stead_format::testing::root;
use stead_format::toml_file::TomlFile;

/// The kept schemas are those of the types. After a change: `stead schema NAME > configs/schema/NAME.json`.
#[test]
fn kept_schemas_are_those_of_the_types() {
    for name in names() {
        let kept = std::fs::read_to_string(root().join(format!("configs/schema/{name}.json"))).unwrap_or_default();
        assert_eq!(kept, schema(name).unwrap(), "renew it: stead schema {name} > configs/schema/{name}.json");
    }
    let kept = std::fs::read_dir(root().join("configs/schema")).unwrap();
    let kept = kept.filter(|entry| entry.as_ref().unwrap().path().is_file()).count();
    assert_eq!(kept, names().len());
}

#[test]
fn an_unknown_name_is_refused_with_the_nearest() {
    let message = schema("runn").unwrap_err().to_string();
    for part in ["no schema 'runn'", "nearest known one: run", "; allowed: run, robot"] {
        assert!(message.contains(part), "{part} in {message}");
    }
}

/// The schema and the whole document.
struct Validator {
    root: Value,
}

impl Validator {
    fn of(name: &str) -> Self {
        Self { root: serde_json::from_str(&schema(name).unwrap()).unwrap() }
    }

    /// Whether a value is as its schema says, else where and why not. A keyword that is not known here is an error, so
    /// that none is passed over.
    fn check(&self, schema: &Value, value: &Value, at: &str) -> Result<(), String> {
        let fail = |why: &str| Err(format!("{at}: {why}: {value} against {schema}"));
        if *schema == Value::Bool(true) {
            return Ok(());
        }
        for (keyword, rule) in schema.as_object().unwrap() {
            let number = || value.as_f64().unwrap_or(f64::NAN);
            let ok = match keyword.as_str() {
                "$schema" | "title" | "description" | "definitions" | "x-unit" | "required" | "format" => true,
                "$ref" => {
                    let pointer = rule.as_str().unwrap().trim_start_matches('#');
                    self.check(self.root.pointer(pointer).unwrap(), value, at)?;
                    true
                }
                "type" => match rule.as_str().unwrap() {
                    "object" => value.is_object(),
                    "array" => value.is_array(),
                    "number" => value.is_number(),
                    "integer" => value.is_u64() || value.is_i64(),
                    "string" => value.is_string(),
                    "boolean" => value.is_boolean(),
                    other => return fail(&format!("unknown type {other}")),
                },
                "minimum" => number() >= rule.as_f64().unwrap(),
                "maximum" => number() <= rule.as_f64().unwrap(),
                "exclusiveMinimum" => number() > rule.as_f64().unwrap(),
                "exclusiveMaximum" => number() < rule.as_f64().unwrap(),
                "enum" => rule.as_array().unwrap().contains(value),
                "minItems" => value.as_array().is_some_and(|items| items.len() as u64 >= rule.as_u64().unwrap()),
                "maxItems" => value.as_array().is_some_and(|items| items.len() as u64 <= rule.as_u64().unwrap()),
                "items" => {
                    for (number, item) in value.as_array().into_iter().flatten().enumerate() {
                        self.check(rule, item, &format!("{at}[{}]", number + 1))?;
                    }
                    true
                }
                "allOf" => {
                    rule.as_array().unwrap().iter().try_for_each(|rule| self.check(rule, value, at))?;
                    true
                }
                "anyOf" => rule.as_array().unwrap().iter().any(|rule| self.check(rule, value, at).is_ok()),
                "properties" => {
                    for (key, rule) in rule.as_object().unwrap() {
                        if let Some(value) = value.get(key) {
                            self.check(rule, value, &format!("{at}.{key}"))?;
                        }
                    }
                    true
                }
                "additionalProperties" => {
                    assert_eq!(*rule, Value::Bool(false));
                    value.as_object().unwrap().keys().all(|key| schema["properties"].get(key).is_some())
                }
                other => return fail(&format!("unknown keyword {other}")),
            };
            if !ok {
                return fail(keyword);
            }
        }
        match schema["required"].as_array().into_iter().flatten().find(|key| value.get(key.as_str().unwrap()).is_none())
        {
            Some(missing) => fail(&format!("no {missing}")),
            None => Ok(()),
        }
    }
}

/// All shipped TOML files below a folder that have a schema.
fn shipped(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
    files.sort();
    files
}

fn document(text: &str) -> Value {
    serde_json::to_value(toml::from_str::<toml::Table>(text).unwrap()).unwrap()
}

/// Every shipped file names its schema in its first line, and is as the schema says.
#[test]
fn shipped_files_are_as_their_schemas_say() {
    let configs = root().join("configs");
    let files = [shipped(&configs), shipped(&configs.join("robots")), shipped(&configs.join("cells"))].concat();
    assert!(files.len() > 15);
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        let named = text.lines().next().unwrap().strip_prefix("#:schema ");
        let Some(named) = named else { panic!("{} does not begin with its schema", file.display()) };
        let path = file.parent().unwrap().join(named);
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert!(names().contains(&name), "{} names {named}", file.display());
        assert!(path.exists(), "{} names {named}", file.display());
        let validator = Validator::of(name);
        let checked = validator.check(&validator.root, &document(&text), "");
        assert_eq!(checked, Ok(()), "{}", file.display());
    }
}

/// What the reader refuses for its kind or its range, the schema refuses too.
#[test]
fn schemas_refuse_what_the_reader_does() {
    let text = std::fs::read_to_string(root().join("configs/caro-2013.toml")).unwrap();
    let validator = Validator::of("run");
    for (from, to) in [
        ("x_mm = [-300.0, 300.0]", "x_mm = [-300.0]"),
        ("x_mm = [-300.0, 300.0]", "x_m = [-300.0, 300.0]"),
        ("q4 = [-1.0, 1.0]", "q4 = [-1.0, 1.5]"),
        ("condition = 0.2", "condition = 1.0"),
        ("seed = 1", "seed = -1"),
        ("population = 120", "population = 12.5"),
        ("\"exact\"", "\"all\""),
        ("task = \"../tasks/five-segments.csv\"", ""),
    ] {
        assert!(text.contains(from), "{from}");
        let changed = document(&text.replacen(from, to, 1));
        assert!(validator.check(&validator.root, &changed, "").is_err(), "{to}");
    }
}

/// What a type reads of a shipped file it writes so that it reads the same again.
fn assert_written_as_read<T: DeserializeOwned + Serialize + PartialEq + Debug>(file: &Path) {
    let read = |text: String| -> T {
        let file = TomlFile::new(file, text.into_bytes()).unwrap();
        file.parse().unwrap().read().unwrap_or_else(|error| panic!("{error}"))
    };
    let table = read(std::fs::read_to_string(file).unwrap());
    assert_eq!(read(toml::to_string(&table).unwrap()), table, "{}", file.display());
}

#[test]
fn what_is_written_is_read_back() {
    let configs = root().join("configs");
    for name in ["caro-2013", "collision", "five-segments-cutting", "tx200-stability"] {
        assert_written_as_read::<RunFile>(&configs.join(format!("{name}.toml")));
    }
    assert_written_as_read::<SurroundingsFile>(&configs.join("cells/kr270-cell.toml"));
    shipped(&configs.join("robots")).iter().for_each(|robot| assert_written_as_read::<RobotFile>(robot));
}
