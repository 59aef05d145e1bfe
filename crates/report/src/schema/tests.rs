mod columns;
mod python;

use super::*;
use serde_json::{Value, json};
use std::path::PathBuf;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The kept schemas are those of the types. After a change: `stead schema NAME > configs/schema/results/NAME.json`.
#[test]
fn kept_schemas_are_those_of_the_types() {
    for name in names() {
        let kept =
            std::fs::read_to_string(root().join(format!("configs/schema/results/{name}.json"))).unwrap_or_default();
        assert_eq!(kept, schema(name).unwrap(), "renew it: stead schema {name} > configs/schema/results/{name}.json");
    }
    assert_eq!(std::fs::read_dir(root().join("configs/schema/results")).unwrap().count(), names().len());
    assert_eq!(schema("place-resul"), None);
}

/// A schema with what it refers to.
struct Validator(Value);

impl Validator {
    fn of(name: &str) -> Self {
        Self(serde_json::from_str(&schema(name).unwrap()).unwrap())
    }

    /// Whether a value is as its schema says, else where and why not. A keyword that is not known here is an error.
    fn check(&self, schema: &Value, value: &Value, at: &str) -> Result<(), String> {
        let Some(schema) = schema.as_object() else { return Ok(()) };
        let all = |rules: &Value| rules.as_array().unwrap().iter().try_for_each(|rule| self.check(rule, value, at));
        schema.iter().try_for_each(|(keyword, rule)| match keyword.as_str() {
            "$schema" | "title" | "description" | "definitions" | "x-unit" | "format" => Ok(()),
            "$ref" => self.check(self.0.pointer(rule.as_str().unwrap().trim_start_matches('#')).unwrap(), value, at),
            "x-decimals" => {
                let factor = 10_f64.powi(rule.as_i64().unwrap() as i32);
                let steps = value.as_f64().unwrap_or(0.0) * factor;
                let is_rounded = (steps - steps.round()).abs() <= 1e-15 * steps.abs() + 1e-6;
                is_rounded.then_some(()).ok_or(format!("{at}: {value} has more than {rule} decimals"))
            }
            "type" => {
                let is = |kind: &Value| match kind.as_str().unwrap() {
                    "object" => value.is_object(),
                    "array" => value.is_array(),
                    "number" => value.is_number(),
                    "integer" => value.is_u64() || value.is_i64(),
                    "string" => value.is_string(),
                    "boolean" => value.is_boolean(),
                    "null" => value.is_null(),
                    other => panic!("unknown type {other}"),
                };
                let fits = rule.as_array().map_or_else(|| is(rule), |kinds| kinds.iter().any(is));
                fits.then_some(()).ok_or(format!("{at}: {value} is no {rule}"))
            }
            "minimum" | "maximum" => {
                let (limit, number) = (rule.as_f64().unwrap(), value.as_f64());
                let fits = |number: f64| if keyword == "minimum" { number >= limit } else { number <= limit };
                number.is_none_or(fits).then_some(()).ok_or(format!("{at}: {value} is beyond {keyword} {rule}"))
            }
            "const" => (value == rule).then_some(()).ok_or(format!("{at}: {value} is not {rule}")),
            "enum" => {
                let is_one = rule.as_array().unwrap().contains(value);
                is_one.then_some(()).ok_or(format!("{at}: {value} is none of {rule}"))
            }
            "minItems" | "maxItems" => {
                let count = value.as_array().map(Vec::len);
                let limit = rule.as_u64().map(|limit| limit as usize);
                let fits = count.is_none() || if keyword == "minItems" { count >= limit } else { count <= limit };
                fits.then_some(()).ok_or(format!("{at}: has not {rule} items"))
            }
            "items" => {
                let mut items = value.as_array().into_iter().flatten().enumerate();
                items.try_for_each(|(number, item)| self.check(rule, item, &format!("{at}[{number}]")))
            }
            "allOf" => all(rule),
            "anyOf" | "oneOf" => {
                let results: Vec<_> = rule.as_array().unwrap().iter().map(|rule| self.check(rule, value, at)).collect();
                if results.iter().any(Result::is_ok) { Ok(()) } else { results.into_iter().collect() }
            }
            "properties" => {
                let mut found =
                    rule.as_object().unwrap().iter().filter_map(|(key, rule)| Some((key, rule, value.get(key)?)));
                found.try_for_each(|(key, rule, value)| self.check(rule, value, &format!("{at}.{key}")))
            }
            "required" => {
                let missing = rule.as_array().unwrap().iter().find(|key| value.get(key.as_str().unwrap()).is_none());
                missing.map_or(Ok(()), |key| if value.is_object() { Err(format!("{at}: no {key}")) } else { Ok(()) })
            }
            "additionalProperties" => {
                let known = |key: &String| schema.get("properties").and_then(|all| all.get(key)).is_some();
                let mut others = value.as_object().into_iter().flatten().filter(|(key, _)| !known(key));
                others.try_for_each(|(key, value)| match rule {
                    Value::Bool(false) => Err(format!("{at}: unknown key {key}")),
                    rule => self.check(rule, value, &format!("{at}.{key}")),
                })
            }
            other => Err(format!("{at}: unknown keyword {other}")),
        })
    }
}

/// The documents of the shipped results, each with its schema.
const SHIPPED: [(&str, &str); 14] = [
    ("caro-2013/summary.json", "place-summary"),
    ("caro-2013/page-data.json", "page-data"),
    ("caro-2013-k1-0.8/summary.json", "place-summary"),
    ("klimchik-2017/summary.json", "assess-result"),
    ("klimchik-2017-table-compatible/summary.json", "assess-result"),
    ("horizontal-slot/summary.json", "assess-result"),
    ("identify-example/report.json", "identify-fit-result"),
    ("identify-plan-example/plan.json", "identify-plan-result"),
    ("compensate-caro-2013/summary.json", "compensate-result"),
    ("umons-aluminium/summary.json", "simulate-result"),
    ("umons-aluminium-stability/summary.json", "stability-result"),
    ("umons-steel-stability/summary.json", "stability-result"),
    ("measured-groove/circularity.json", "circularity-result"),
    ("study-k1/study-report.json", "study-report"),
];

/// Every shipped document has the keys that its schema requires, no others, and figures with no more than its decimals.
#[test]
fn shipped_documents_are_as_their_schemas_say() {
    for (file, name) in SHIPPED {
        let text = std::fs::read_to_string(root().join("results").join(file)).unwrap();
        let validator = Validator::of(name);
        let checked = validator.check(&validator.0, &serde_json::from_str(&text).unwrap(), "");
        assert_eq!(checked, Ok(()), "{file} against {name}");
    }
}

/// What the schema does not say is refused: the check above can fail.
#[test]
fn other_documents_are_refused() {
    let text = std::fs::read_to_string(root().join("results/caro-2013/summary.json")).unwrap();
    let validator = Validator::of("place-summary");
    for (from, to) in [
        ("\"mean_mm\"", "\"mean_m\""),
        ("\"interrupted\": false", "\"interrupted\": 0"),
        ("\"q4\": 0.", "\"q4\": 0.0000000"),
        ("\"format\": 1,", ""),
    ] {
        assert!(text.contains(from), "{from}");
        let changed: Value = serde_json::from_str(&text.replacen(from, to, 1)).unwrap();
        let checked = validator.check(&validator.0, &changed, "");
        assert!(checked.is_err(), "{to}");
    }
}

/// Ends of numbers and lists of words are checked too.
#[test]
fn values_that_a_schema_does_not_allow_are_refused() {
    let validator = Validator(Value::Null);
    let check = |schema: Value, value: Value| validator.check(&schema, &value, "").is_ok();
    for (schema, good, bad) in [
        (json!({ "minimum": 0 }), json!(0), json!(-1)),
        (json!({ "maximum": 255 }), json!(255), json!(256)),
        (json!({ "const": 1 }), json!(1), json!(2)),
        (json!({ "enum": ["a", "b"] }), json!("b"), json!("c")),
    ] {
        assert!(check(schema.clone(), good) && !check(schema.clone(), bad), "{schema}");
    }
    // What the check does not know is no silent yes.
    assert!(!check(json!({ "patternProperties": {} }), json!({})));
}

/// Rust files below a folder, tests apart: the text before their test modules.
fn code(folder: &std::path::Path) -> Vec<(PathBuf, String)> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut found = Vec::new();
    for path in entries {
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() {
            found.extend(code(&path));
        } else if path.extension().is_some_and(|end| end == "rs") && !name.ends_with("tests") && name != "testing" {
            let text = std::fs::read_to_string(&path).unwrap();
            let end = text.find("#[cfg(test)]\nmod tests {").unwrap_or(text.len());
            found.push((path, text[..end].to_owned()));
        }
    }
    found
}

/// Keys of documents are fields of types: none is typed by hand.
#[test]
fn no_document_is_typed_by_hand() {
    let code = code(&root().join("crates/report/src"));
    assert!(code.len() > 80);
    let typed: Vec<_> = code.iter().filter(|(_, text)| text.contains("json!")).map(|(path, _)| path).collect();
    assert_eq!(typed, Vec::<&PathBuf>::new());
}
