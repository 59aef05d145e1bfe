//! The records of the Python package declare the keys of the documents that they are of.

use super::{root, schema};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// A class of the package, the document that it is of, the part of it, if it is not the whole, and keys that it has no
/// annotation for.
type Record = (&'static str, &'static str, &'static str, &'static [&'static str]);

/// `notes` and `warnings` are attributes of all results, with types of their own.
const OF_RESULTS: &[&str] = &["notes", "warnings"];

const RECORDS: [Record; 29] = [
    // The command joins the certificate; cases, best and worst are properties that know their tables.
    ("Placements", "place-result", "", &["cases", "certificate", "notes", "warnings"]),
    // Findings and collisions go with an error.
    ("PlacementScore", "score-result", "", &["best", "worst", "collisions", "findings", "notes", "warnings"]),
    ("Explanations", "explain-result", "", OF_RESULTS),
    // The benchmark is in the file alone.
    ("RobotAssessment", "assess-result", "", &["benchmark", "notes", "warnings"]),
    ("IdentifiedRobot", "identify-fit-result", "", OF_RESULTS),
    ("MeasurementPlan", "identify-plan-result", "", OF_RESULTS),
    ("CompensatedPath", "compensate-result", "", OF_RESULTS),
    ("SimulatedPass", "simulate-result", "", OF_RESULTS),
    ("StabilityAnalysis", "stability-result", "", OF_RESULTS),
    ("StudyReport", "study-report", "", OF_RESULTS),
    ("Circularity", "circularity-result", "", OF_RESULTS),
    ("Certificate", "place-certificate", "", &[]),
    ("Input", "place-result", "Input", &[]),
    ("MeanAndMax", "place-result", "DeflectionMean", &[]),
    ("Deflections", "place-result", "DeflectionByDirection", &[]),
    ("FeedLimit", "place-result", "FeedDecision", &[]),
    ("CutFeed", "place-result", "FeedFigures", &[]),
    ("JointTurn", "place-result", "LargestTurn", &[]),
    ("JointTravel", "place-result", "JointTravelFigures", &[]),
    ("PlanEntries", "score-result", "PlanFigures", &[]),
    // A property that reads the table.
    ("CaseEntries", "place-result", "CaseFigures", &["plan"]),
    ("Transfer", "place-result", "TransferFigures", &[]),
    ("ActiveBound", "place-result", "ActiveBoundFigures", &[]),
    ("StiffnessGain", "place-result", "StiffnessSlope", &[]),
    ("Proof", "place-certificate", "ProofFigures", &[]),
    ("Explanation", "explain-result", "ExplainedPosture", &[]),
    ("ReferenceCircle", "circularity-result", "CircleFigures", &[]),
    ("Force", "simulate-result", "ForceFigures", &[]),
    ("Placement", "place-result", "PlacementExact", &[]),
];

/// The classes of the package with what they derive from and the attributes that they declare.
fn classes() -> BTreeMap<String, (String, BTreeSet<String>)> {
    let mut classes: BTreeMap<String, (String, BTreeSet<String>)> = BTreeMap::new();
    for file in ["_record.py", "_entries.py", "_records.py", "_results.py"] {
        let text = std::fs::read_to_string(root().join("python/package/stead").join(file)).unwrap();
        let mut current = None;
        for line in text.lines() {
            if let Some(head) = line.strip_prefix("class ") {
                let (name, parent) =
                    head.trim_end_matches(':').split_once('(').unwrap_or((head.trim_end_matches(':'), ""));
                classes.insert(name.to_owned(), (parent.trim_end_matches(')').to_owned(), BTreeSet::new()));
                current = Some(name.to_owned());
            } else if let (Some((name, _)), Some(class)) =
                (line.strip_prefix("    ").and_then(|line| line.split_once(": ")), &current)
                && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
                && !name.starts_with('_')
            {
                classes.get_mut(class).unwrap().1.insert(name.to_owned());
            }
        }
    }
    classes
}

/// What a class declares, with what it inherits.
fn declared(classes: &BTreeMap<String, (String, BTreeSet<String>)>, name: &str) -> BTreeSet<String> {
    let Some((parent, own)) = classes.get(name) else { return BTreeSet::new() };
    own.union(&declared(classes, parent)).cloned().collect()
}

#[test]
fn records_declare_the_keys_of_their_documents() {
    let classes = classes();
    for (class, document, part, without) in RECORDS {
        let schema: Value = serde_json::from_str(&schema(document).unwrap()).unwrap();
        let object = if part.is_empty() { &schema } else { &schema["definitions"][part] };
        let keys: BTreeSet<String> = object["properties"].as_object().unwrap().keys().cloned().collect();
        let left_out = |key: &String| !without.contains(&key.as_str());
        let [keys, declared] = [keys, declared(&classes, class)].map(|all| all.into_iter().filter(left_out).collect());
        let (keys, declared): (BTreeSet<String>, BTreeSet<String>) = (keys, declared);
        assert_eq!(declared, keys, "{class} of {document}");
    }
}

/// Records of the package that are made of schemas: the class, the document, the part of it, if it is not the whole.
const ENTRIES: [(&str, &str, &str); 23] = [
    ("Input", "place-result", "Input"),
    ("MeanAndMax", "place-result", "DeflectionMean"),
    ("Deflections", "place-result", "DeflectionByDirection"),
    ("FeedLimit", "place-result", "FeedDecision"),
    ("CutFeed", "place-result", "FeedFigures"),
    ("JointTurn", "place-result", "LargestTurn"),
    ("JointTravel", "place-result", "JointTravelFigures"),
    ("Clearance", "place-result", "ClearanceFigures"),
    ("UnfollowedMove", "place-result", "UnfollowedMove"),
    ("HeldFeed", "place-result", "HeldFeedFigures"),
    ("ByOrigin", "place-result", "OriginFigures"),
    ("PlanEntries", "score-result", "PlanFigures"),
    ("ShortLine", "place-result", "ShortLine"),
    ("Transfer", "place-result", "TransferFigures"),
    ("ActiveBound", "place-result", "ActiveBoundFigures"),
    ("StiffnessGain", "place-result", "StiffnessSlope"),
    ("ExternalAxes", "place-result", "ExternalAxisFigures"),
    ("CaseEntries", "place-result", "CaseFigures"),
    ("Proof", "place-certificate", "ProofFigures"),
    ("Certificate", "place-certificate", ""),
    ("Explanation", "explain-result", "ExplainedPosture"),
    ("ReferenceCircle", "circularity-result", "CircleFigures"),
    ("Force", "simulate-result", "ForceFigures"),
];

/// What a class that is made says of itself where its part has no description of its own.
const CERTIFICATE: &str =
    "How far the placements found are from the best and the worst possible; the reason where there is no proof.";

/// The class for a part of a document, and how it is made of entries.
fn class_of(reference: &str) -> (String, Option<String>) {
    let part = reference.trim_start_matches("#/definitions/");
    if part.starts_with("Placement") {
        return ("Placement".to_owned(), Some("Placement._of".to_owned()));
    }
    match ENTRIES.iter().find(|(_, _, known)| *known == part) {
        Some((class, ..)) => ((*class).to_owned(), Some((*class).to_owned())),
        None => ("Record".to_owned(), None),
    }
}

/// The Python type of a value, whether it may be null, and how its class is made.
fn python_type(value: &Value) -> (String, bool, Option<String>) {
    let one = |reference: &Value| reference["$ref"].as_str().map(class_of);
    if let Some((class, made)) = one(value).or_else(|| one(&value["allOf"][0])) {
        return (class, false, made);
    }
    if let Some(choices) = value["anyOf"].as_array() {
        let is_null = choices.iter().any(|choice| choice["type"] == "null");
        let known = choices.iter().find(|choice| choice["type"] != "null").map(python_type);
        let (class, _, made) = known.unwrap_or(("Any".to_owned(), false, None));
        return (class, is_null, made);
    }
    let types: Vec<&str> = match &value["type"] {
        Value::String(one) => vec![one.as_str()],
        Value::Array(all) => all.iter().filter_map(Value::as_str).collect(),
        _ => Vec::new(),
    };
    let is_null = types.contains(&"null");
    let (class, made) = match types.iter().find(|kind| **kind != "null") {
        Some(&"number") => ("float".to_owned(), None),
        Some(&"integer") => ("int".to_owned(), None),
        Some(&"string") => ("str".to_owned(), None),
        Some(&"boolean") => ("bool".to_owned(), None),
        Some(&"object") => ("Record".to_owned(), None),
        Some(&"array") => {
            let (item, is_null, made) = python_type(&value["items"]);
            (format!("list[{item}{}]", if is_null { " | None" } else { "" }), made)
        }
        _ => ("Any".to_owned(), None),
    };
    (class, is_null, made)
}

/// `_entries.py` as the schemas have it.
fn entries() -> String {
    let mut text = "\"\"\"Parts of JSON documents: made of the output schemas, as a test of the report crate holds it. Do not edit.\"\"\"\n\n\
                    from __future__ import annotations\n\n\
                    from collections.abc import Callable, Mapping\n\
                    from typing import Any, ClassVar\n\n\
                    from ._record import Placement, Record\n"
        .to_owned();
    for (class, document, part) in ENTRIES {
        let schema: Value = serde_json::from_str(&schema(document).unwrap()).unwrap();
        let object = if part.is_empty() { &schema } else { &schema["definitions"][part] };
        let said = object["description"].as_str().filter(|_| !part.is_empty()).unwrap_or(CERTIFICATE);
        let required = object["required"].as_array().unwrap();
        text += &format!("\n\nclass {class}(Record):\n    \"\"\"{}\"\"\"\n\n", said.replace('\n', " "));
        let mut made = String::new();
        for (key, value) in object["properties"].as_object().unwrap() {
            // The table of a plan is read by a property.
            if key == "plan" {
                continue;
            }
            let (kind, is_null, how) = python_type(value);
            let is_missing = !required.iter().any(|name| name == key);
            text += &format!("    {key}: {kind}{}\n", if is_null || is_missing { " | None" } else { "" });
            made += &how.map_or_else(String::new, |how| format!("        \"{key}\": {how},\n"));
        }
        if !made.is_empty() {
            text += &format!("    _made: ClassVar[Mapping[str, Callable[[Any], Any]]] = {{\n{made}    }}\n");
        }
    }
    text
}

#[test]
fn entries_are_made_of_the_schemas() {
    let file = root().join("python/package/stead/_entries.py");
    let made = entries();
    if std::fs::read_to_string(&file).ok().as_ref() != Some(&made) {
        let new = std::env::temp_dir().join("stead-entries.py");
        std::fs::write(&new, &made).unwrap();
        panic!("the schemas have changed: cp {} {}", new.display(), file.display());
    }
}
