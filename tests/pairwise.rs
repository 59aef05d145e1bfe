//! Every feature with every other: runs in which every pair of option values occurs, held against the judge, and the
//! keys of the input files that these runs state.

use crate::drive::{Outcome, drive};
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Mutex;
use stead_judge::cover::{Choice, cover, pairs, pairs_of, value_of, words};
use toml::{Table, Value};

/// Keys of the schemas that no run of the generator states, and why.
const LEFT_OUT: &[(&str, &str)] = &[
    ("run:certificate.gap_percent", "a certificate is held against its own enumeration"),
    ("run:certificate.memory_gb", "a certificate is held against its own enumeration"),
    ("run:certificate.time_limit_s", "a certificate is held against its own enumeration"),
    ("run:stability.damping_scale", "stability is no part of a plan"),
    ("run:stability.max_depth_mm", "stability is no part of a plan"),
    ("run:stability.variant", "stability is no part of a plan"),
    ("run:guesses", "names of keys, which every result says"),
    ("run:reference.case_mm", "figures beside the results"),
    ("run:reference.source", "figures beside the results"),
    ("run:search.memory_gb", "changes no result"),
    ("run:stiffness_like", "of a robot file without stiffness, which no run here has"),
    ("run:cut.engagement", "of assessments"),
    ("run:cut.open_width_mm", "of assessments"),
    ("run:tool.entering_angle_deg", "of assessments"),
    ("run:tool.rake_deg", "of assessments"),
    ("run:tool.kn_mpa", "of assessments"),
    ("run:tool.friction", "of assessments"),
    ("run:tool.helix_deg", "of simulation and stability"),
    ("run:tool.kr_mpa", "the other word for kr"),
    ("run:criterion.force_uncertainty_from", "a size of force errors, as force_uncertainty states one"),
    ("run:material", "of forces from the path, held against closed forms"),
    ("run:tool.centre_cutting", "of forces from the path, a warning"),
    ("run:tool.pitch_deg", "of simulation and stability"),
    ("run:tool.runout_um", "of simulation and stability"),
    ("run:spindle.power_kw", "of a warning"),
    ("run:spindle.torque_nm", "of a warning"),
    ("run:spindle.inertia_kg_m2.xy", "of simulation and stability"),
    ("run:spindle.inertia_kg_m2.xz", "of simulation and stability"),
    ("run:spindle.inertia_kg_m2.yz", "of simulation and stability"),
    ("robot:price_eur", "shown by assess"),
    ("robot:unverified", "a note"),
    ("surroundings:visual.name", "drawn, and held against nothing"),
    ("surroundings:visual.attached", "drawn, and held against nothing"),
    ("surroundings:visual.mesh", "drawn, and held against nothing"),
    ("surroundings:visual.unit", "drawn, and held against nothing"),
    ("surroundings:visual.color", "drawn, and held against nothing"),
    ("surroundings:visual.xyz_mm", "drawn, and held against nothing"),
];

/// Shapes, zones and their clearance are tables of the run file too, with the same keys.
const SHARED: [&str; 3] = ["shape.", "keep_out.", "collision."];

/// The keys of a schema, tables of lists as those of one.
fn schema_keys(name: &str) -> BTreeSet<String> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("configs/schema/{name}.json"));
    let schema: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    fn walk(schema: &serde_json::Value, at: &serde_json::Value, path: &str, keys: &mut BTreeSet<String>) {
        let inner = |at: &serde_json::Value| {
            let name = at.get("$ref")?.as_str()?.rsplit('/').next()?.to_owned();
            schema.get("definitions")?.get(&name).cloned()
        };
        if let Some(found) = inner(at) {
            return walk(schema, &found, path, keys);
        }
        let choices = ["anyOf", "allOf", "oneOf"].iter().filter_map(|word| at.get(*word)?.as_array()).flatten();
        let mut is_leaf = true;
        for choice in choices {
            if inner(choice).is_some() || choice.get("properties").is_some() || choice.get("items").is_some() {
                is_leaf = false;
                walk(schema, choice, path, keys);
            }
        }
        if let Some(items) = at.get("items").filter(|items| items.is_object()) {
            return walk(schema, items, path, keys);
        }
        if let Some(properties) = at.get("properties").and_then(serde_json::Value::as_object) {
            for (key, value) in properties {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                walk(schema, value, &path, keys);
            }
        } else if is_leaf {
            keys.insert(path.to_owned());
        }
    }
    let mut keys = BTreeSet::new();
    walk(&schema, &schema, "", &mut keys);
    keys
}

fn stated_keys(table: &Table, path: &str, keys: &mut BTreeSet<String>) {
    for (key, value) in table {
        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        keys.insert(path.clone());
        let tables = value.as_array().into_iter().flatten().filter_map(Value::as_table).chain(value.as_table());
        tables.for_each(|inner| stated_keys(inner, &path, keys));
    }
}

#[test]
fn every_key_of_the_input_files_is_stated_by_some_run_or_left_out_with_a_reason() {
    let folder = tempfile::tempdir().unwrap();
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/robots");
    let mut stated = BTreeSet::new();
    for (number, choice) in cover(1).iter().enumerate() {
        let folder = folder.path().join(number.to_string());
        std::fs::create_dir_all(&folder).unwrap();
        let files = stead_judge::write::write(choice, number as u64, &robots, &folder).unwrap();
        for (kind, file) in files.toml {
            let table: Table = std::fs::read_to_string(file).unwrap().parse().unwrap();
            let mut keys = BTreeSet::new();
            stated_keys(&table, "", &mut keys);
            stated.extend(keys.into_iter().map(|key| format!("{kind}:{key}")));
        }
    }
    let mut known: BTreeSet<String> = BTreeSet::new();
    for kind in ["run", "robot", "surroundings"] {
        known.extend(schema_keys(kind).into_iter().map(|key| format!("{kind}:{key}")));
    }
    assert!(known.len() > 150, "{known:?}");
    let is_motion = |key: &str| {
        [
            "mass_kg",
            "centre_of_mass_mm",
            "inertia_kg_m2",
            "damping_",
            "half_backlash",
            "gravity_compensated",
            "orthogonal_damping",
        ]
        .iter()
        .any(|word| key.starts_with(&format!("robot:joints.{word}")))
    };
    // The five words for an orientation are drawn for all tables alike, each in some run.
    let words = ["rotation", "abc_deg", "wpr_deg", "rpy_deg", "quaternion_wxyz"];
    let is_angle = |key: &str| {
        words.iter().any(|word| key.ends_with(word))
            && words.iter().any(|word| stated.contains(&format!("run:spindle.{word}")))
    };
    let in_surroundings = |key: &str| {
        let of_run = key.strip_prefix("run:").filter(|key| SHARED.iter().any(|table| key.starts_with(table)));
        of_run.is_some_and(|key| stated.contains(&format!("surroundings:{key}")))
    };
    // The judge removes no material: it takes the forces of a stock about the path from `stead forces`. Other stock is
    // held against closed forms beside its code.
    let of_stock = ["run:stock.", "run:finished_part.", "run:before."];
    let is_removal = |key: &str| of_stock.iter().any(|table| key.starts_with(table));
    let left_out: BTreeSet<&str> = LEFT_OUT.iter().map(|(key, _)| *key).collect();
    let missing: Vec<&String> = known
        .iter()
        .filter(|key| !stated.contains(*key) && !left_out.contains(key.as_str()))
        .filter(|key| !is_motion(key) && !is_angle(key) && !in_surroundings(key) && !is_removal(key))
        .collect();
    assert!(missing.is_empty(), "no run states {missing:?}: add them to tests/judge/src/cover.rs and write.rs");
    for (key, reason) in LEFT_OUT {
        assert!(known.contains(*key), "{key} is no key any more: {reason}");
        assert!(!stated.contains(*key), "{key} is stated by a run: {reason}");
    }
}

/// Runs of the first choices, which bring the most pairs.
const FIRST: usize = 5;

#[test]
fn runs_of_the_first_pairs_of_options_agree_with_the_judge() {
    let all = cover(1);
    let (first, rest) = all.split_at(FIRST);
    // What the others would add is run by `.ci/nightly`.
    let share = pairs_of(first).len() as f64 / pairs().len() as f64;
    assert!(share > 0.33 && !rest.is_empty(), "{share}");
    agree_with_the_judge(first, 0);
}

#[test]
#[ignore = "the rest of the pairs: half an hour"]
fn runs_of_the_other_pairs_of_options_agree_with_the_judge() {
    agree_with_the_judge(&cover(1)[FIRST..], FIRST);
}

/// Runs choices, the first one of a number, and holds them against the judge.
fn agree_with_the_judge(choices: &[Choice], first: usize) {
    // Side by side, for a run alone does not keep all processors busy.
    let (left, outcomes) = (Mutex::new(choices.iter().enumerate()), Mutex::new(Vec::new()));
    let next = || left.lock().unwrap().next();
    let worker = || {
        while let Some((number, choice)) = next() {
            let folder = tempfile::tempdir().unwrap();
            let outcome = drive(choice, 100_000 + (first + number) as u64 + 1, folder.path());
            outcomes.lock().unwrap().push((number, outcome));
        }
    };
    let count = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| (0..count).for_each(|_| drop(scope.spawn(worker))));
    let mut outcomes = outcomes.into_inner().unwrap();
    outcomes.sort_by_key(|(number, _)| *number);
    assert_eq!(outcomes.len(), choices.len());
    let (mut judged, mut not_placed, mut failed) = (0, Vec::new(), Vec::new());
    for (number, outcome) in outcomes {
        let choice = &choices[number];
        match outcome {
            Outcome::Judged(verdict) => {
                judged += 1;
                if !verdict.disagreements.is_empty() {
                    failed.push(format!("{}\n{}", words(choice), verdict.disagreements.join("\n")));
                }
                let requested = value_of(choice, "program") != "none" && verdict.not_exported.is_empty();
                assert_eq!(requested, verdict.checks.contains_key("points of a program"), "{}", words(choice));
            }
            Outcome::NotPlaced(why) => not_placed.push(why),
            Outcome::Failed(why) => failed.push(why),
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n\n"));
    // A cell without a placement says nothing: there may be few of them.
    assert!(10 * judged >= 8 * choices.len(), "{judged} of {} runs were judged: {not_placed:?}", choices.len());
}
