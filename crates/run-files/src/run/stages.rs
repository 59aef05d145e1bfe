//! A run file read stage by stage: the arm, the forces along the path, the scoring, the surroundings and
//! the leans of the tool, each with its own notes and input files, and the problem of them all.

use super::ReferenceTable;
use super::criterion::ReadSets;
use super::external_axes::{check_axes, external_axes};
use super::forces::ForceTables;
use super::lean::PointLeans;
use super::notes::{cutter_notes, direction_note, force_note, override_note, speed_note, tilt_note};
use super::postures::check_postures;
use super::reading::Reading;
use super::redundancy::check_axis_turns;
use super::removed::{Removal, removed};
use super::tables::{check_path_points, check_tables};
use super::yielding::{base_note, on_its_base, part_compliances};
use crate::forces::{ReadingTable, RemovalTables};
use crate::guesses::guesses;
use crate::stated::stated;
use std::sync::Arc;
use stead_disk::input::{InputError, InputFile, input_file};
use stead_format::place::Place;
use stead_format::quantity::Quantity;
use stead_format::robot::{checked_to_move, checked_to_score, moving_robot_from, robot_from, robot_like};
use stead_format::surroundings::{SceneRead, SurroundingsFile, read_mount, read_scene};
use stead_format::toml_file::TomlFile;
use stead_format::tool::Cutting;
use stead_model::external_axis::ExternalAxis;
use stead_model::robot::{Robot, Spindle};
use stead_model::task::Task;
use stead_numerics::message::{Note, Warning};
use stead_problem::criterion::Criterion;
use stead_problem::lean::LeanSpace;
use stead_problem::problem::{Problem, ProblemParts};
use stead_problem::setup::Setup;
use stead_runs::{ReadError, Run};
use stead_simulation::arm::Variant;
use stead_simulation::path_stability::PathStabilityAnalysis;
use stead_simulation::stability_analysis::runout_note;

/// The arm on its mount, with its spindle.
struct Arm {
    robot: Robot,
    spindle: Spindle,
    /// Its file, and the one that lends it a stiffness.
    input: InputFile,
    lender: Option<InputFile>,
    notes: Vec<Note>,
}

/// Where the path and the forces along it come from.
struct Load {
    of_points: PointLeans,
    /// Whether the task file states forces.
    has_columns: bool,
    removal: Option<Removal>,
    input: InputFile,
    /// Those that the forces are made of.
    inputs: Vec<InputFile>,
    of_path: Option<Note>,
    notes: Vec<Note>,
}

/// By what placements are scored.
struct Scoring {
    criterion: Criterion,
    inputs: Vec<InputFile>,
    notes: Vec<Note>,
    /// Of the robots of the sets.
    of_sets: Vec<Note>,
}

/// The surroundings of the arm, and the axes that carry it or the part.
struct Around {
    scene: SceneRead,
    axes: Vec<ExternalAxis>,
}

/// How the tool may lean.
struct Leaning {
    space: Option<Arc<LeanSpace>>,
    notes: Vec<Note>,
}

impl<'r> Reading<'r> {
    /// The run with all that it rests on.
    pub fn run(&self) -> Result<Run, ReadError> {
        let Self { run, at, source, .. } = self;
        // Without a cut, the tool is there for the moves between segments.
        let cutting = if run.cut.is_some() { Cutting::of(&run.tool, &run.cut, at)? } else { None };
        let stability = self.stability(cutting.as_ref())?;
        let arm = self.arm(stability.as_ref().map(|analysis| analysis.variant >= Variant::Orthogonal))?;
        let (task, load) = self.load(cutting.as_ref())?;
        let scoring = self.scoring(&arm.robot, &task, &load)?;
        let around = self.around(&arm)?;
        let (task, leaning) = self.leaning(task, &load)?;
        let problem = self.problem(&arm, task, scoring.criterion, &around, leaning.space)?;
        self.checked(&problem)?;

        let of_cutter = cutter_notes(run.tool.as_ref(), cutting.as_ref(), run.stock.is_some());
        let radians = at.radians("").into_iter().map(Note::may_be_wrong).chain(arm.notes);
        let of_spindle = run.spindle.order_note().into_iter().chain(of_cutter).map(Note::may_be_wrong);
        let mut notes: Vec<Note> = source.overrides().iter().map(|(field, _)| override_note(field).into()).collect();
        notes.extend(guesses(run.guesses.as_deref().unwrap_or_default(), at)?);
        notes.extend(radians.chain(of_spindle).chain(load.of_path).chain(speed_note(&arm.robot)));
        notes.extend(load.notes.into_iter().chain(scoring.notes).chain(leaning.notes));
        notes.extend(base_note(&problem.robot).map(Note::may_be_wrong));
        notes.extend(problem.notes());
        // The robot of the run may be a set too.
        let of_sets: Vec<Note> = scoring.of_sets.into_iter().filter(|note| !notes.contains(note)).collect();
        notes.extend(of_sets.into_iter().chain(around.scene.notes.into_iter().map(Note::from)));
        let of_task = direction_note(&problem.task).into_iter().chain(force_note(&problem.task, load.has_columns));
        notes.extend(of_task.map(Note::may_be_wrong));
        notes.extend(stability.as_ref().and_then(|analysis| runout_note(&analysis.cutter)));
        notes.extend(problem.unchecked_collisions());

        let first = [source.as_config(), arm.input, load.input];
        let others = load.inputs.into_iter().chain(scoring.inputs).chain(arm.lender).chain(around.scene.inputs);
        let output = run.output.unwrap_or_default();
        Ok(Run {
            search: run.search.unwrap_or_default().settings(),
            transfer: run.transfer.unwrap_or_default().settings(),
            certificate: run.certificate.map(|table| table.settings()),
            maps: output.maps(),
            page: output.page(),
            inputs: first.into_iter().chain(others).collect(),
            stated: stated(at),
            reference: run.reference.clone().map(ReferenceTable::reference),
            warnings: self.warnings(load.removal.as_ref(), stability.as_ref(), &problem.robot),
            removal: load.removal.map(|removal| removal.forces),
            path_stability: stability,
            problem,
            notes,
        })
    }

    fn stability(&self, cutting: Option<&Cutting<'r>>) -> Result<Option<PathStabilityAnalysis>, InputError> {
        let analysis = |table: &super::PathStabilityTable| {
            table.analysis(&Cutting::required(cutting, &self.at)?, &self.at.key("stability"))
        };
        self.run.stability.as_ref().map(analysis).transpose()
    }

    /// The arm: one that moves where its stability is analysed, with springs normal to the axes or without.
    fn arm(&self, moving: Option<bool>) -> Result<Arm, ReadError> {
        let Self { run, at, .. } = self;
        let spindle_at = at.key("spindle");
        let spindle = match moving {
            Some(_) => run.spindle.moving_spindle(&spindle_at)?,
            None => run.spindle.spindle(&spindle_at)?,
        };
        let file = at.key("robot").named_file()?;
        let source = file.toml()?;
        let (robot, lender) = self.robot(&source, moving)?;
        if moving != Some(true) {
            checked_to_score(&robot, &source)?;
        }
        let robot = run.constraints.narrowed(robot, &at.key("constraints"))?;
        let robot = match read_mount(run.mount.as_ref(), at)? {
            Some(mount) => robot.mounted(&mount),
            None => robot,
        };
        let robot = on_its_base(robot, run.base_compliance.as_ref(), &at.key("base_compliance"))?;
        let notes = source.parse()?.root().radians("robot.").into_iter().map(Note::may_be_wrong).collect();
        Ok(Arm { robot, spindle, input: input_file("robot", file.name, source.bytes()), lender, notes })
    }

    /// The robot of a file, with the stiffness that another one lends it.
    fn robot(&self, source: &TomlFile, moving: Option<bool>) -> Result<(Robot, Option<InputFile>), InputError> {
        let at = self.at.key("stiffness_like");
        let like = self.run.stiffness_like.as_deref();
        if let Some((robot, lender)) = like.map(|other| robot_like(source, other, &at)).transpose()?.flatten() {
            let robot = match moving {
                Some(is_orthogonal) => checked_to_move(robot, source, is_orthogonal)?,
                None => robot,
            };
            return Ok((robot, Some(lender)));
        }
        let robot = self.source.sources.robot(source.file(), source.is_overridden(), moving, || match moving {
            Some(is_orthogonal) => moving_robot_from(source, is_orthogonal),
            None => robot_from(source),
        })?;
        if like.is_some() {
            let problem = "lends a stiffness to a robot file that states its own";
            let allowed = "a robot file without joint stiffness, or stiffness_like in the robot file, where it says whose its \
                           numbers are";
            return Err(at.error(problem, allowed));
        }
        Ok((robot, None))
    }

    /// The path with the forces along it, as the tool axis of the task has them.
    fn load(&self, cutting: Option<&Cutting<'_>>) -> Result<(Task, Load), ReadError> {
        let Self { run, at, .. } = self;
        let file = at.key("task").named_file()?;
        let mut imported = self.source.sources.task(&file.file, &file.bytes)?;
        let of_path = tilt_note(&imported.path, &imported.lines).map(Note::from);
        let input = input_file("task", &file.name, &file.bytes);
        let of_points = PointLeans::taken(&mut imported, &file.file, run.stock.is_some(), at)?;
        let part = part_compliances(&mut imported, run.part_compliance.as_ref(), run.stock.is_some(), at)?;
        let has_columns = imported.wrenches.is_some();
        let (task, removal, inputs, notes) = match self.removal_tables()? {
            Some(tables) => {
                let removed = removed(self, &tables, imported, &file)?;
                (removed.task, Some(removed.removal), removed.inputs, removed.notes)
            }
            None => {
                let tables =
                    ForceTables { forces: run.forces.as_ref(), cutting, is_for_stability: run.stability.is_some() };
                let task = tables.task(imported, &file, &at.key("task"), &at.key("forces"))?;
                (task, None, Vec::new(), Vec::new())
            }
        };
        let task = part.of(task, at)?;
        Ok((task, Load { of_points, has_columns, removal, input, inputs, of_path, notes }))
    }

    /// Stock, and what goes with it.
    fn removal_tables(&self) -> Result<Option<RemovalTables<'r>>, InputError> {
        let Self { run, at, .. } = self;
        let Some(stock) = &run.stock else {
            let of_stock = ["material", "finished_part", "before"].map(|key| at.key(key));
            return match of_stock.into_iter().find(Place::is_given) {
                Some(alone) => {
                    let problem = "is there without the stock that it goes with";
                    Err(alone.error(problem, "a table [stock] beside it").found_if(None))
                }
                None => Ok(None),
            };
        };
        let tool = run.tool.as_ref().ok_or_else(|| at.key("tool").missing("a table [tool] beside [stock]"))?;
        Ok(Some(RemovalTables {
            path_key: "task",
            reading: ReadingTable::default(),
            stock,
            tool,
            material: run.material,
            cut: run.cut.as_ref(),
            finished_part: run.finished_part.as_ref(),
            before: run.before.as_deref().unwrap_or_default(),
            is_for_stability: run.stability.is_some(),
        }))
    }

    fn scoring(&self, robot: &Robot, task: &Task, load: &Load) -> Result<Scoring, InputError> {
        let Self { run, at, .. } = self;
        let table = run.criterion.clone().unwrap_or_default();
        let narrowed = |robot| run.constraints.narrowed(robot, &at.key("constraints"));
        let ReadSets { robots, inputs, notes: of_sets } = table.sets(robot, narrowed, at)?;
        let forces = load.removal.as_ref().map(|removal| &*removal.forces);
        let (force_uncertainty, about) = table.force_errors(forces, &at.key("criterion"))?;
        let criterion = table.criterion(self, robot, task, force_uncertainty, robots)?;
        Ok(Scoring { criterion, inputs, notes: about.map(Note::from).into_iter().collect(), of_sets })
    }

    fn around(&self, arm: &Arm) -> Result<Around, InputError> {
        let own = SurroundingsFile {
            shape: self.run.shape.clone(),
            keep_out: self.run.keep_out.clone(),
            collision: self.run.collision.clone(),
            ..SurroundingsFile::default()
        };
        let tables = self.run.external_axis.as_deref().unwrap_or_default();
        let axes = external_axes(tables, &self.at.key("external_axis"))?;
        Ok(Around { scene: read_scene(own, &self.at, &arm.robot, &arm.spindle, &axes)?, axes })
    }

    /// Where the tool may lean, with notes on it; forces that change with the lean are made for it.
    fn leaning(&self, task: Task, load: &Load) -> Result<(Task, Leaning), ReadError> {
        let Some(table) = &self.run.lean else {
            let notes = load.of_points.unused().map(Note::from).into_iter().collect();
            return Ok((task, Leaning { space: None, notes }));
        };
        let space = table.space(self, &task, &load.of_points, load.has_columns)?;
        let notes = table.notes(&space, load.removal.is_some(), task.path().first_unscored().is_some());
        let task = match load.removal.as_ref().filter(|_| table.computes_forces() && !space.is_closed()) {
            Some(removal) => removal.leaning(self, task, &space)?,
            None => task,
        };
        Ok((task, Leaning { space: Some(space).filter(|space| !space.is_closed()), notes }))
    }

    fn problem(
        &self,
        arm: &Arm,
        task: Task,
        criterion: Criterion,
        around: &Around,
        lean: Option<Arc<LeanSpace>>,
    ) -> Result<Problem, InputError> {
        let Self { run, at, .. } = self;
        let (scene, transfer) = (around.scene.scene.clone(), run.transfer.unwrap_or_default());
        let segment_moves = transfer.segment_moves(self, &arm.robot, &arm.spindle, scene.as_deref(), task.path())?;
        let orientations = run.cell.orientations(&task, &at.key("cell"))?;
        let parts = ProblemParts {
            robot: arm.robot.clone(),
            spindle: arm.spindle,
            task: orientations.first().map_or(task, |first| (*first.task).clone()),
            cell: run.cell.cell(&at.key("cell"))?,
            constraints: run.constraints.constraints(),
            criterion,
            redundancy: self.redundancy,
            postures: run.postures.clone().unwrap_or_default().rules(&arm.robot, &at.key("postures"))?,
            segment_moves,
            scene,
            orientations,
            lean,
            setup: Setup::at_rest(&around.axes),
            external_axes: around.axes.clone(),
        };
        parts.build().map_err(|error| at.error(error.to_string(), "parts that agree"))
    }

    /// Whether the parts of a problem go together.
    fn checked(&self, problem: &Problem) -> Result<(), InputError> {
        let at = |key: &str| self.at.key(key);
        let table = self.run.search.unwrap_or_default();
        let search = table.settings();
        check_axes(problem, &at("external_axis"))?;
        check_postures(&self.run.postures.clone().unwrap_or_default(), problem, &search, &at("postures"))?;
        check_axis_turns(problem, &at("redundancy"))?;
        check_tables(&search, problem, &at("search"))?;
        check_path_points(&search, problem, &at("search"))?;
        table.check_memory(problem, &at("search"))
    }

    /// Faults of the cut that the user should see to, and parts of the arm that its model leaves out.
    fn warnings(
        &self,
        removal: Option<&Removal>,
        stability: Option<&PathStabilityAnalysis>,
        robot: &Robot,
    ) -> Vec<Warning> {
        let spindle = &self.run.spindle;
        let [power, torque] = [spindle.power_kw.map(Quantity::si), spindle.torque_nm.map(Quantity::si)];
        let forces = || removal.iter().map(|removal| &removal.forces);
        let beyond = forces().filter_map(|forces| forces.cut?.beyond(power, torque));
        let left_out = stability.and_then(|analysis| analysis.variant.left_out(robot));
        forces().flat_map(|forces| forces.warnings.iter().cloned()).chain(beyond).chain(left_out).collect()
    }
}
