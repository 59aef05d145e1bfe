//! Run files.

mod certificate;
mod criterion;
mod external_axes;
mod forces;
pub mod lean;
mod notes;
mod orientations;
mod output;
mod postures;
mod reading;
mod redundancy;
mod removed;
mod segments;
mod stability;
mod stages;
#[cfg(test)]
mod surroundings_tests;
mod tables;
#[cfg(test)]
mod tests;
mod yielding;

pub use certificate::{CertificateTable, GAPS_ALLOWED, Gap};
pub use criterion::{CriterionTable, PositiveWeight, SegmentTable, WeightsTable};
pub use external_axes::ExternalAxisTable;
pub use forces::ForcesTable;
pub use output::OutputTable;
pub use postures::{AllowedPosture, Changes, PosturesTable};
pub use redundancy::RedundancyTable;
pub use stability::PathStabilityTable;
pub use tables::{CellTable, ConstraintsTable, OrientationTable, ReferenceTable, SearchTable, TransferTable};

use crate::Word;
use crate::forces::BeforeTable;
use crate::forces::material::Material;
use crate::kind::read_unless;
use lean::LeanTable;
use reading::Reading;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;
use stead_disk::input::InputError;
use stead_format::compliance_matrix::{BaseComplianceTable, PartComplianceTable};
use stead_format::document::Document;
use stead_format::field::FieldOverrides;
use stead_format::file_kind::FileKind;
use stead_format::mount::MountTable;
use stead_format::sources::Sources;
use stead_format::spindle::SpindleTable;
use stead_format::surroundings::{CollisionTable, KeepOutTable, PartTable, ShapeTable, StockTable};
use stead_format::toml_file::TomlFile;
use stead_format::tool::{CutTable, ToolTable};
use stead_numerics::monitor::Monitor;
use stead_runs::{ReadError, Run};

/// A run of `stead place`, `score`, `explain` and `certify`: a robot, its spindle, a tool path, and the cell in which
/// its workpiece may stand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RunFile {
    /// The robot file, relative to the folder of this file.
    pub robot: String,
    /// The task file, relative to the folder of this file: the tool path as CSV, with or without the forces along it.
    pub task: String,
    /// The tool frame in the flange frame.
    pub spindle: SpindleTable,
    /// Keys of this file whose values are guesses (`stock.depth_mm`), or whole tables: every result says that it rests
    /// on them.
    pub guesses: Option<Vec<String>>,
    /// Where the robot stands in its cell; with it, all that is stated in the base frame is in the cell frame.
    pub mount: Option<MountTable>,
    /// How what carries the robot yields, where that counts.
    pub base_compliance: Option<BaseComplianceTable>,
    /// How the part yields, the same at every point; the task may state it point by point instead (`part_xx_um_per_n`).
    pub part_compliance: Option<PartComplianceTable>,
    /// Where the workpiece may stand.
    pub cell: CellTable,
    /// Rails and turntables that carry the robot or the workpiece, those that carry the same thing on each other in
    /// their order.
    pub external_axis: Option<Vec<ExternalAxisTable>>,
    /// How far the tool may lean from the axis of the task.
    pub lean: Option<LeanTable>,
    /// What a placement has to keep to.
    pub constraints: ConstraintsTable,
    /// By what a placement is scored.
    pub criterion: Option<CriterionTable>,
    /// Segments of the task that count more or less than the others.
    pub segment: Option<Vec<SegmentTable>>,
    /// The free rotation of the spindle about the tool axis.
    pub redundancy: RedundancyTable,
    /// Which postures the segments may be driven in, and how the moves between them count.
    pub postures: Option<PosturesTable>,
    /// How hard to search.
    pub search: Option<SearchTable>,
    /// Moves between segments.
    pub transfer: Option<TransferTable>,
    /// Asks for a proof of how far the placement is from the best possible.
    pub certificate: Option<CertificateTable>,
    /// The cutter. With `[cut]` it gives the forces of a task without force columns, and what `[stability]` is asked
    /// of; among surroundings it is kept out of the part on the moves between segments.
    pub tool: Option<ToolTable>,
    /// What the cutter cuts.
    pub cut: Option<CutTable>,
    /// Forces in the frame of each path point, in place of force columns or of `[tool]` and `[cut]`.
    pub forces: Option<ForcesTable>,
    /// The material before it is cut, in place of all other forces: with `[tool]` and `[cut] spindle_rpm` the forces
    /// are those of what the path removes of it.
    pub stock: Option<StockTable>,
    /// The material that is cut, beside `[stock]`: for published cutting coefficients in place of those of `[tool]`.
    pub material: Option<Word<Material>>,
    /// The part as it shall be, beside `[stock]`: where the cutter cuts into it, a note says so.
    pub finished_part: Option<PartTable>,
    /// What is cut before, beside `[stock]`, in this order.
    pub before: Option<Vec<BeforeTable>>,
    /// What stands around the robot and on it, to be kept apart: a file of the tables below, relative to the folder of
    /// this one.
    pub surroundings: Option<String>,
    /// Of a robot file that states no joint stiffness, the shipped arm whose joint stiffness it gets; every result says
    /// so.
    pub stiffness_like: Option<String>,
    /// Shapes that keep apart, beside those of `surroundings`.
    pub shape: Option<Vec<ShapeTable>>,
    /// Zones that points of the arm are kept out of, beside those of `surroundings`.
    pub keep_out: Option<Vec<KeepOutTable>>,
    /// How far shapes keep apart, and which may touch.
    pub collision: Option<CollisionTable>,
    /// Asks for critical depths along the path.
    pub stability: Option<PathStabilityTable>,
    /// What is made beside the plans.
    pub output: Option<OutputTable>,
    /// Published figures to print beside ours.
    pub reference: Option<ReferenceTable>,
}

/// Reads a run file, the keys of [`RunFile`], and the robot and task files that it names.
///
/// # Errors
/// [`InputError`] with file, line and field: a file that cannot be read or parsed, a missing or unknown key, a value of
/// the wrong kind or out of range, an arm or a task that breaks a rule, forces from two places or from none.
pub fn read_run(file: &Path) -> Result<Run, InputError> {
    read_run_with(file, &FieldOverrides::none(), &Monitor::silent()).map_err(|error| error.input(file))
}

/// Reads a run file as [`read_run`] does, with values that take the place of its own or of those of the files that it
/// names. Forces of a table `[stock]` are computed at once, which may take long.
///
/// # Errors
/// Those of [`read_run`]; an error in such a value says which it is. [`ReadError::Stopped`] when the monitor asked to
/// stop before the forces were computed.
pub fn read_run_with(file: &Path, overrides: &FieldOverrides, monitor: &Monitor) -> Result<Run, ReadError> {
    read_from(&TomlFile::read(file)?.with_overrides(overrides, Sources::disk()), monitor)
}

/// The run that a file already read asks for.
pub(crate) fn read_from(source: &TomlFile, monitor: &Monitor) -> Result<Run, ReadError> {
    let document = source.parse()?;
    read_run_tables(source, &document, monitor)
}

/// The run that a parsed file asks for.
pub(crate) fn read_run_tables(source: &TomlFile, document: &Document<'_>, monitor: &Monitor) -> Result<Run, ReadError> {
    let run: RunFile = read_unless(&[FileKind::RobotFile, FileKind::ForcesFile], source, document)?;
    let at = document.root();
    let redundancy = run.redundancy.redundancy(&at.key("redundancy"))?;
    Reading { source, run: &run, at, monitor, redundancy }.run()
}
