//! The JSON Schema of each document that a command writes, from the types that it is written from: keys, units,
//! decimals, meanings.
//!
//! They are kept in `configs/schema/results/`; after a change of a type,
//! `stead schema NAME > configs/schema/results/NAME.json` renews one.

use crate::assessment::AssessmentFigures;
use crate::certificate::CertificateFigures;
use crate::check::CheckFigures;
use crate::circularity::CircularityFigures;
use crate::compensation::CompensationFigures;
use crate::document::Document;
use crate::forces::ForcesFigures;
use crate::identification::IdentificationFigures;
use crate::identification::plan::PlanFigures;
use crate::page::data::PageData;
use crate::placement::evaluation::{ExplainFigures, ScoreFigures};
use crate::placement::{PlaceFigures, SummaryFigures};
use crate::program::{ProgramCheckFigures, ProgramFigures};
use crate::robot::{ArmList, PoseFigures};
use crate::simulation::SimulationFigures;
use crate::stability::StabilityFigures;
use crate::study::{StatusFigures, StudyFigures};
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema, generate::SchemaSettings};

/// Makes the schema of one kind of document.
type Make = fn() -> Schema;

/// Every kind of document, by the name of its schema.
const SCHEMAS: [(&str, Make); 21] = [
    ("place-result", of::<PlaceFigures>),
    ("place-summary", of::<SummaryFigures>),
    ("place-certificate", of::<CertificateFigures>),
    ("score-result", of::<ScoreFigures>),
    ("explain-result", of::<ExplainFigures>),
    ("page-data", of::<PageData>),
    ("study-report", of::<StudyFigures>),
    ("study-status", of::<StatusFigures>),
    ("assess-result", of::<AssessmentFigures>),
    ("identify-fit-result", of::<IdentificationFigures>),
    ("identify-plan-result", of::<PlanFigures>),
    ("compensate-result", of::<CompensationFigures>),
    ("forces-result", of::<ForcesFigures>),
    ("simulate-result", of::<SimulationFigures>),
    ("stability-result", of::<StabilityFigures>),
    ("circularity-result", of::<CircularityFigures>),
    ("export-result", of::<ProgramFigures>),
    ("export-check-result", of::<ProgramCheckFigures>),
    ("check-result", of::<CheckFigures>),
    ("pose-result", of::<PoseFigures>),
    ("robots-result", of::<ArmList>),
];

/// The names of all schemas.
pub fn names() -> Vec<&'static str> {
    SCHEMAS.iter().map(|(name, _)| *name).collect()
}

/// The schema of a kind of document as a JSON document (draft 7), where there is one of this name.
pub fn schema(name: &str) -> Option<String> {
    let (_, make) = SCHEMAS.iter().find(|(known, _)| *known == name)?;
    Some(format!("{:#}\n", make().as_value()))
}

fn of<T: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft07().for_serialize().with_transform(RecursiveTransform(closed));
    let mut schema = settings.into_generator().into_root_schema_for::<Document<T>>();
    schema.insert("title".to_owned(), T::schema_name().into());
    schema
}

/// A document has no keys but those declared.
fn closed(schema: &mut Schema) {
    let is_open = ["anyOf", "oneOf", "patternProperties", "additionalProperties"];
    if schema.get("properties").is_some() && is_open.iter().all(|key| schema.get(*key).is_none()) {
        schema.insert("additionalProperties".to_owned(), false.into());
    }
}

#[cfg(test)]
mod tests;
