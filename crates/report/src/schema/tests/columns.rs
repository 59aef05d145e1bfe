//! The guide page of the columns of result tables is that of the types which the rows are.

use super::root;
use crate::assessment::tables as assessment;
use crate::certificate::tables::OpenBoxRow;
use crate::circularity::DeviationRow;
use crate::compensation::CorrectedRow;
use crate::cutting::{EngagementRow, ToothRow};
use crate::forces;
use crate::identification::plan::tables::ExpectedRow;
use crate::identification::tables::{EstimateRow, ResidualRow};
use crate::placement::plan_row::PlanRow;
use crate::placement::tables as placement;
use crate::simulation::tables::{SeriesRow, WallRow};
use crate::stability::LobeFigures;
use crate::stability::path::PathStabilityRow;
use crate::stability::tables::{ModeRow, ResponseRow};
use crate::study::tables as study;
use schemars::{JsonSchema, generate::SchemaSettings};
use serde_json::{Map, Value};

/// The files with rows of a type, a shipped one of them, and the schema of the type.
type Table = (&'static str, &'static str, fn() -> Value);

const TABLES: [Table; 30] = [
    ("`best.csv`, `worst.csv` and other plans", "caro-2013/best.csv", of::<PlanRow>),
    ("`placements.csv`", "caro-2013/placements.csv", of::<placement::CaseRow>),
    ("`convergence.csv`", "caro-2013/convergence.csv", of::<placement::GenerationRow>),
    ("`deflection-map-best.csv`, `-worst.csv`", "caro-2013/deflection-map-best.csv", of::<placement::MapRow>),
    ("`lean-map.csv`", "", of::<placement::LeanMapRow>),
    ("`transfers.csv`", "caro-2013/transfers.csv", of::<placement::TransferRow>),
    ("`refinements.csv`", "caro-2013/refinements.csv", of::<placement::RefinementRow>),
    ("`open-region.csv`", "", of::<OpenBoxRow>),
    ("`stability-best.csv`, `-worst.csv`", "", of::<PathStabilityRow>),
    ("`study-ranking.csv`", "study-k1/study-ranking.csv", of::<study::RankingRow>),
    ("`study-front.csv`", "study-k1/study-front.csv", of::<study::FrontRow>),
    ("`study-effects.csv`", "study-k1/study-effects.csv", of::<study::EffectRow>),
    ("`map-ROBOT.csv`", "", of::<assessment::MapRow>),
    ("`circularity.csv`", "klimchik-2017/circularity.csv", of::<assessment::CircularityRow>),
    ("`optimal-zones.csv`, `middle-zones.csv`", "klimchik-2017/optimal-zones.csv", of::<assessment::ZoneRow>),
    ("`accuracy.csv`", "klimchik-2017/accuracy.csv", of::<assessment::AccuracyRow>),
    ("`selection.csv`", "klimchik-2017/selection.csv", of::<assessment::SelectionRow>),
    ("`cutting-engagement.csv`", "horizontal-slot/cutting-engagement.csv", of::<EngagementRow>),
    ("`cutting-turn.csv`", "horizontal-slot/cutting-turn.csv", of::<ToothRow>),
    ("`NAME-engagement.csv`", "", of::<forces::EngagementRow>),
    ("`compliances.csv`", "identify-example/compliances.csv", of::<EstimateRow>),
    ("`residuals.csv`", "identify-example/residuals.csv", of::<ResidualRow>),
    ("`expected.csv`", "identify-plan-example/expected.csv", of::<ExpectedRow>),
    ("`corrected-path.csv`", "compensate-caro-2013/corrected-path.csv", of::<CorrectedRow>),
    ("`series.csv`", "", of::<SeriesRow>),
    ("`wall.csv`", "umons-aluminium/wall.csv", of::<WallRow>),
    ("`modes.csv`", "umons-aluminium-stability/modes.csv", of::<ModeRow>),
    ("`frequency-response.csv`", "umons-aluminium-stability/frequency-response.csv", of::<ResponseRow>),
    ("`lobes.csv`", "umons-aluminium-stability/lobes.csv", of::<LobeFigures>),
    ("`deviations.csv`", "measured-groove/deviations.csv", of::<DeviationRow>),
];

fn of<T: JsonSchema>() -> Value {
    let generator = SchemaSettings::draft07().for_serialize().into_generator();
    generator.into_root_schema_for::<T>().to_value()
}

/// The columns of a schema with what is said of each; a struct in a row puts its name before those of its fields.
fn columns(root: &Value, object: &Value, before: &str, found: &mut Vec<(String, Map<String, Value>)>) {
    for (key, property) in object["properties"].as_object().unwrap() {
        let name = format!("{before}{key}");
        let reference = property.get("$ref").or_else(|| property.get("allOf")?[0].get("$ref"));
        match reference.and_then(|to| root.pointer(to.as_str()?.trim_start_matches('#'))) {
            Some(inner) => columns(root, inner, &format!("{name}_"), found),
            None => found.push((name, property.as_object().unwrap().clone())),
        }
    }
}

/// The columns of a shipped table, in their order.
fn header(example: &str) -> Vec<String> {
    let text = std::fs::read_to_string(root().join("results").join(example)).unwrap_or_default();
    text.lines().next().unwrap_or_default().split(',').map(str::to_owned).collect()
}

fn page() -> String {
    let mut page = "# Columns of result tables\n\nEvery table that a command writes, column by column: the unit is that of the name, and \
                    figures have the decimals\nstated here. A field is empty where there is no value. This page is made of the types that \
                    the rows are.\n"
        .to_owned();
    for (files, example, make) in TABLES {
        let schema = make();
        let mut found = Vec::new();
        columns(&schema, &schema, "", &mut found);
        let header = header(example);
        found.sort_by_key(|(name, _)| header.iter().position(|column| column == name).unwrap_or(header.len()));
        let head = schema["description"].as_str().unwrap();
        page += &format!("\n## {files}\n\n{head}\n\n| column | unit | decimals | meaning |\n|---|---|---|---|\n");
        for (name, said) in found {
            let text = |key: &str| said.get(key).map(|value| value.as_str().map_or(value.to_string(), str::to_owned));
            let [unit, decimals, meaning] =
                ["x-unit", "x-decimals", "description"].map(|key| text(key).unwrap_or_default().replace('\n', " "));
            page += &format!("| `{name}` | {unit} | {decimals} | {meaning} |\n");
        }
    }
    page
}

#[test]
fn the_guide_has_the_columns_of_every_table() {
    let (page, kept) = (page(), root().join("src/guide/columns.md"));
    let renewed = std::env::temp_dir().join("stead-columns.md");
    if std::fs::read_to_string(&kept).unwrap_or_default() != page {
        std::fs::write(&renewed, &page).unwrap();
        panic!("renew it: cp {} {}", renewed.display(), kept.display());
    }
}

/// Every column of a shipped table is a field of its row, but those that a run names.
#[test]
fn shipped_tables_have_no_other_columns() {
    let named_by_a_run = |schema: &Value| schema.get("additionalProperties").is_some();
    let mut compared = 0;
    for (_, example, make) in TABLES.into_iter().filter(|(_, example, _)| !example.is_empty()) {
        let schema = make();
        let mut found = Vec::new();
        columns(&schema, &schema, "", &mut found);
        let is_known = |column: &String| found.iter().any(|(name, _)| name == column);
        let others: Vec<_> = header(example).into_iter().filter(|column| !is_known(column)).collect();
        assert!(others.is_empty() || named_by_a_run(&schema), "{example}: {others:?}");
        compared += found.len();
    }
    assert!(compared > 180, "{compared}");
}
