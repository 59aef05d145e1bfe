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
mod redundancy;
mod removed;
mod stability;
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

use crate::forces::material::Material;
use crate::forces::{BeforeTable, ReadingTable, RemovalTables};
use crate::guesses::guesses;
use crate::stated::stated;
use crate::{Word, at_the_top};
use criterion::ReadSets;
use external_axes::{check_axes, external_axes};
use forces::ForceTables;
use lean::{LeanTable, PointLeans};
use notes::{cutter_notes, direction_note, force_note, override_note, speed_note, tilt_note};
use postures::check_postures;
use redundancy::check_axis_turns;
use removed::removed;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;
use stead_disk::input::{InputError, input_file};
use stead_format::compliance_matrix::{BaseComplianceTable, PartComplianceTable};
use stead_format::document::Document;
use stead_format::field::FieldOverrides;
use stead_format::file_kind::FileKind;
use stead_format::mount::MountTable;
use stead_format::place::Place;
use stead_format::quantity::Quantity;
use stead_format::robot::{checked_to_move, checked_to_score, moving_robot_from, robot_from, robot_like};
use stead_format::sources::Sources;
use stead_format::spindle::SpindleTable;
use stead_format::surroundings::{
    CollisionTable, KeepOutTable, PartTable, ShapeTable, StockTable, SurroundingsFile, read_mount, read_scene,
};
use stead_format::toml_file::TomlFile;
use stead_format::tool::{CutTable, Cutting, ToolTable};
use stead_numerics::message::Note;
use stead_numerics::monitor::Monitor;
use stead_problem::problem::ProblemParts;
use stead_problem::setup::Setup;
use stead_runs::{ReadError, Run};
use stead_simulation::arm::Variant;
use stead_simulation::stability_analysis::runout_note;
use tables::{check_path_points, check_tables};
use yielding::{base_note, on_its_base, part_compliances};

/// A run of `stead place`, `score`, `explain` and `certify`: a robot, its spindle, a tool path, and the cell in which
/// its workpiece may stand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
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
    let at = document.root();
    let run: RunFile = document.read().map_err(|error| match FileKind::of(source.text().as_bytes()) {
        Some(kind @ (FileKind::RobotFile | FileKind::ForcesFile)) => kind.refused(source.file()),
        _ => at_the_top::<RunFile>(error),
    })?;
    let spindle = match run.stability {
        Some(_) => run.spindle.moving_spindle(&at.key("spindle"))?,
        None => run.spindle.spindle(&at.key("spindle"))?,
    };
    let redundancy = run.redundancy.redundancy(&at.key("redundancy"))?;
    let search_table = run.search.unwrap_or_default();
    let search = search_table.settings();
    let transfer_table = run.transfer.unwrap_or_default();
    let transfer = transfer_table.settings();
    let output = run.output.unwrap_or_default();
    let (maps, page) = (output.maps(), output.page());
    let certificate = run.certificate.map(|table| table.settings());
    // Without a cut, the tool is there for the moves between segments.
    let cutting = if run.cut.is_some() { Cutting::of(&run.tool, &run.cut, &at)? } else { None };

    let (robot_field, task_field) = (at.key("robot"), at.key("task"));
    let robot_file = robot_field.named_file()?;
    let robot_source = robot_file.toml()?;
    let path_stability = match &run.stability {
        Some(table) => Some(table.analysis(&Cutting::required(cutting.as_ref(), &at)?, &at.key("stability"))?),
        None => None,
    };
    let moving = path_stability.as_ref().map(|analysis| analysis.variant >= Variant::Orthogonal);
    let like = run.stiffness_like.as_deref();
    let borrowed = like.map(|other| robot_like(&robot_source, other, &at.key("stiffness_like"))).transpose()?.flatten();
    let (robot, lender) = match borrowed {
        Some((robot, lender)) => match moving {
            Some(is_orthogonal) => (checked_to_move(robot, &robot_source, is_orthogonal)?, Some(lender)),
            None => (robot, Some(lender)),
        },
        None => {
            let (file, is_overridden) = (robot_source.file(), robot_source.is_overridden());
            let robot = source.sources.robot(file, is_overridden, moving, || match moving {
                Some(is_orthogonal) => moving_robot_from(&robot_source, is_orthogonal),
                None => robot_from(&robot_source),
            })?;
            if like.is_some() {
                let problem = "lends a stiffness to a robot file that states its own";
                let allowed = "a robot file without joint stiffness, or stiffness_like in the robot file, where it says whose its \
                               numbers are";
                return Err(at.key("stiffness_like").error(problem, allowed).into());
            }
            (robot, None)
        }
    };
    if moving != Some(true) {
        checked_to_score(&robot, &robot_source)?;
    }
    let robot = run.constraints.narrowed(robot, &at.key("constraints"))?;
    let robot = match read_mount(run.mount.as_ref(), &at)? {
        Some(mount) => robot.mounted(&mount),
        None => robot,
    };
    let robot = on_its_base(robot, run.base_compliance.as_ref(), &at.key("base_compliance"))?;
    let task_file = task_field.named_file()?;
    let mut imported = source.sources.task(&task_file.file, &task_file.bytes)?;
    let mut notes: Vec<Note> = source.overrides().iter().map(|(field, _)| override_note(field).into()).collect();
    notes.extend(guesses(run.guesses.as_deref().unwrap_or_default(), &at)?);
    let radians = at.radians("").into_iter().chain(robot_source.parse()?.root().radians("robot."));
    let of_cutter = cutter_notes(run.tool.as_ref(), cutting.as_ref(), run.stock.is_some());
    notes.extend(radians.chain(run.spindle.order_note()).chain(of_cutter).map(Note::may_be_wrong));
    notes.extend(tilt_note(&imported.path, &imported.lines).map(Note::from));
    notes.extend(speed_note(&robot));
    let mut inputs = vec![
        source.as_config(),
        input_file("robot", robot_file.name, robot_source.bytes()),
        input_file("task", &task_file.name, &task_file.bytes),
    ];
    let of_points = PointLeans::taken(&mut imported, &task_file.file, run.stock.is_some(), &at)?;
    let part = part_compliances(&mut imported, run.part_compliance.as_ref(), run.stock.is_some(), &at)?;
    let is_for_stability = run.stability.is_some();
    let tables = ForceTables { forces: run.forces.as_ref(), cutting: cutting.as_ref(), is_for_stability };
    let has_columns = imported.wrenches.is_some();
    let mut removal = None;
    let task = match &run.stock {
        Some(stock) => {
            let tool = run.tool.as_ref().ok_or_else(|| at.key("tool").missing("a table [tool] beside [stock]"))?;
            let tables = RemovalTables {
                path_key: "task",
                reading: ReadingTable::default(),
                stock,
                tool,
                material: run.material,
                cut: run.cut.as_ref(),
                finished_part: run.finished_part.as_ref(),
                before: run.before.as_deref().unwrap_or_default(),
                is_for_stability,
            };
            let removed = removed(&tables, imported, &task_file, redundancy.feed, source, &at, monitor)?;
            inputs.extend(removed.inputs);
            notes.extend(removed.notes);
            removal = Some(removed.removal);
            removed.task
        }
        None => {
            if let Some(alone) =
                ["material", "finished_part", "before"].map(|key| at.key(key)).into_iter().find(Place::is_given)
            {
                return Err(alone
                    .error("is there without the stock that it goes with", "a table [stock] beside it")
                    .found_if(None)
                    .into());
            }
            tables.task(imported, &task_file, &task_field, &at.key("forces"))?
        }
    };
    let task = part.of(task, &at)?;
    let removed_forces = removal.as_ref().map(|removal| &*removal.forces);
    let segments = run.segment.unwrap_or_default();
    let criterion = run.criterion.unwrap_or_default();
    let narrowed = |robot| run.constraints.narrowed(robot, &at.key("constraints"));
    let ReadSets { robots: sets, inputs: files, notes: of_sets } = criterion.sets(&robot, narrowed, &at)?;
    inputs.extend(files);
    inputs.extend(lender);
    let (force_uncertainty, about) = criterion.force_errors(removed_forces, &at.key("criterion"))?;
    notes.extend(about.map(Note::from));
    let criterion = criterion.criterion(&segments, &robot, &task, force_uncertainty, sets, &at)?;
    let (cell, constraints) = (run.cell.cell(&at.key("cell"))?, run.constraints.constraints());
    let postures = run.postures.unwrap_or_default();
    let rules = postures.rules(&robot, &at.key("postures"))?;
    let (shape, keep_out, collision) = (run.shape, run.keep_out, run.collision);
    let around = SurroundingsFile { shape, keep_out, collision, ..SurroundingsFile::default() };
    let external_axes = external_axes(run.external_axis.as_deref().unwrap_or_default(), &at.key("external_axis"))?;
    let around = read_scene(around, &at, &robot, &spindle, &external_axes)?;
    let scene = around.scene;
    let (tool, tool_at) = (run.tool.as_ref(), &at.key("tool"));
    let segment_moves = transfer_table.segment_moves(&robot, &spindle, scene.as_deref(), task.path(), tool, tool_at)?;
    let (lean, task) = match &run.lean {
        Some(table) => {
            let at = at.key("lean");
            let space = table.space(&task, &of_points, tool, redundancy.beta_count, has_columns, &at)?;
            let computed = removal.as_ref().filter(|_| table.computes_forces() && !space.is_closed());
            notes.extend(table.notes(&space, removal.is_some(), task.path().first_unscored().is_some()));
            let task = match computed {
                Some(removal) => removal.leaning(task, &space, source, monitor)?,
                None => task,
            };
            (Some(space), task)
        }
        None => {
            notes.extend(of_points.unused().map(Note::from));
            (None, task)
        }
    };
    let orientations = run.cell.orientations(&task, &at.key("cell"))?;
    let task = orientations.first().map_or(task, |first| (*first.task).clone());
    let lean = lean.filter(|space| !space.is_closed());
    let parts = ProblemParts {
        robot,
        spindle,
        task,
        cell,
        constraints,
        criterion,
        redundancy,
        postures: rules,
        scene,
        segment_moves,
        orientations,
        lean,
        setup: Setup::at_rest(&external_axes),
        external_axes,
    };
    let problem = parts.build().map_err(|error| at.error(error.to_string(), "parts that agree"))?;
    check_axes(&problem, &at.key("external_axis"))?;
    check_postures(&postures, &problem, &search, &at.key("postures"))?;
    check_axis_turns(&problem, &at.key("redundancy"))?;
    check_tables(&search, &problem, &at.key("search"))?;
    check_path_points(&search, &problem, &at.key("search"))?;
    search_table.check_memory(&problem, &at.key("search"))?;
    inputs.extend(around.inputs);
    notes.extend(base_note(&problem.robot).map(Note::may_be_wrong));
    notes.extend(problem.notes());
    // The robot of the run may be a set too.
    let of_sets: Vec<Note> = of_sets.into_iter().filter(|note| !notes.contains(note)).collect();
    notes.extend(of_sets);
    notes.extend(around.notes.into_iter().map(Note::from));
    notes.extend(
        direction_note(&problem.task).into_iter().chain(force_note(&problem.task, has_columns)).map(Note::may_be_wrong),
    );
    notes.extend(path_stability.as_ref().and_then(|analysis| runout_note(&analysis.cutter)));
    notes.extend(problem.unchecked_collisions());
    let reference = run.reference.map(ReferenceTable::reference);
    let stated = stated(&at);
    let removal = removal.map(|removal| removal.forces);
    let of_removal = removal.iter().flat_map(|removal| removal.warnings.iter().cloned());
    let [power, torque] = [run.spindle.power_kw.map(Quantity::si), run.spindle.torque_nm.map(Quantity::si)];
    let beyond = removal.iter().filter_map(|removal| removal.cut?.beyond(power, torque));
    let of_removal = of_removal.chain(beyond);
    let left_out = path_stability.as_ref().and_then(|analysis| analysis.variant.left_out(&problem.robot));
    let warnings = of_removal.chain(left_out).collect();
    Ok(Run {
        problem,
        search,
        transfer,
        certificate,
        maps,
        page,
        inputs,
        stated,
        reference,
        path_stability,
        removal,
        notes,
        warnings,
    })
}
