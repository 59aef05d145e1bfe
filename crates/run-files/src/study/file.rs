//! What a study file declares.

use crate::Word;
use crate::run::PositiveWeight;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::IgnoredAny;
use serde::{Deserialize, Deserializer};
use stead_format::scalars::{Whole, words};
use stead_format::shapes::List;
use stead_format::units::{Number, Positive};

/// How the axes of a study make up its cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Combine {
    /// Every value of each axis with every value of the others.
    Grid,
    /// The first values of all axes together, then the second, and so on.
    Zipped,
    /// A Latin hypercube: every axis in as many strata as there are samples, each of them met once.
    Latin,
}

/// Whether tasks are placed by themselves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TaskPlacement {
    /// Each has its own placement: a case for each task.
    Each,
    /// One placement for all.
    One,
}

/// How the values of a range are spaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spacing {
    /// At equal differences.
    Linear,
    /// At equal ratios.
    Log,
}

words!(Combine: "grid" => Combine::Grid, "zipped" => Combine::Zipped, "latin" => Combine::Latin);
words!(TaskPlacement: "each" => TaskPlacement::Each, "one" => TaskPlacement::One);
words!(Spacing: "linear" => Spacing::Linear, "log" => Spacing::Log);

/// A study of `stead study`: a run, what is varied of it, and how the cases are made up.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
pub struct StudyFile {
    /// The run file that is varied, relative to the folder of this file.
    pub base: String,
    /// What is varied.
    pub axis: Option<Vec<AxisTable>>,
    /// How the axes make up the cases: as a `grid` (where left out), `zipped`, or as a Latin hypercube, `latin`.
    pub combine: Option<Word<Combine>>,
    /// Number of cases of a Latin hypercube, before any is excluded.
    pub samples: Option<Whole<1, 1000000>>,
    /// Seed of the Latin hypercube; 1 where left out.
    pub seed: Option<Whole<0, 9223372036854775807>>,
    /// Cases that are left out: comparisons of fields or axes with values, as in
    /// `robot == "a.toml" and cell.z_mm[1] > 200`.
    pub exclude: Option<List<String>>,
    /// The tasks, in place of that of the run file.
    pub task: Option<Vec<TaskTable>>,
    /// Whether `each` task has its own placement (where left out), or all of them `one`.
    pub placement: Option<Word<TaskPlacement>>,
    /// Which cases leave their files in a folder of their own: `none` (where left out), `all`, or as in `best 20` those
    /// with the smallest objective.
    pub keep: Option<String>,
    /// Whether cases are certified as the table `[certificate]` of the run file says; false where left out.
    pub certify: Option<bool>,
}

/// One thing that is varied: a field, or several together.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
pub struct AxisTable {
    /// Name of its column in the table of results; its fields where left out.
    pub name: Option<String>,
    /// The field, by its path from the run file on and through keys that name files into those:
    /// `robot.joints[1].min_deg`.
    pub field: Option<String>,
    /// In place of one field, several that vary together.
    pub fields: Option<List<String>>,
    /// The values, or with `fields` rows with a value for each of them. Names of files are relative to the folder of
    /// this file.
    pub values: Option<Values>,
    /// In place of values, numbers from one to another.
    pub range: Option<RangeTable>,
    /// What stands for the values in the table of results, as many as values.
    pub labels: Option<List<String>>,
}

/// Numbers from one to another.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
pub struct RangeTable {
    /// The first.
    pub from: Number,
    /// The last.
    pub to: Number,
    /// How many; where this and `step` are left out, a Latin hypercube takes as many as it has samples.
    pub count: Option<Whole<2, 1000000>>,
    /// In place of a count, the difference from one to the next, up to the last that is not past `to`.
    pub step: Option<Number<Positive>>,
    /// At equal differences, `linear` (where left out), or at equal ratios, `log`.
    pub spacing: Option<Word<Spacing>>,
}

/// A task of a study.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
pub struct TaskTable {
    /// The task file, relative to the folder of this file.
    pub file: String,
    /// What stands for it in the table of results; the name of the file where left out.
    pub label: Option<String>,
    /// What it counts beside the others, 1 where left out: each of its points with one placement for all, else its
    /// cases in a ranking.
    pub weight: Option<Number<PositiveWeight>>,
}

/// Values of any kind, which the files that they are for know more of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Values;

impl<'de> Deserialize<'de> for Values {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_ignored_any(IgnoredAny).map(|_| Self)
    }
}

impl JsonSchema for Values {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "values".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "array", "minItems": 1 })
    }
}
