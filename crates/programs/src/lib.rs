//! Robot programs from plans: the moves (`motion`), in the words of a controller (`krl`, `rapid`, `fanuc`) or as a
//! `table`, and a program read back and compared with its plan (`check`).
//!
//! Between segments the moves are the free `transfer_paths`, where a run has surroundings. Linear poses are in the
//! workpiece frame, so that positions are those of the task. The two frames of a program are where the workpiece stands
//! in the controller's robot root, and where the tool is on the flange.
//!
//! ```
//! use stead_numerics::monitor::Monitor;
//! use stead_programs::check::{ReadBackOptions, check};
//! use stead_programs::{ExportOptions, ProgramFormat, export};
//! let run = stead_run_files::read_run("../../configs/caro-2013.toml".as_ref())?;
//! let plan = "../../results/caro-2013/best.csv".as_ref();
//! let program = export(&run, plan, &ExportOptions::new(ProgramFormat::Krl, "PART"), &Monitor::silent())?;
//! // A joint move to each of the five segments, a line to each of the 105 points, a line away from each segment.
//! assert_eq!((program.joint_moves, program.linear_moves), (5, 110));
//! // Written, and read back by what shares nothing with the writers.
//! let folder = tempfile::tempdir()?;
//! let written = program.write(folder.path(), stead_disk::Existing::Kept)?;
//! let found = check(&run, plan, &written.files[0], &ReadBackOptions::default(), &Monitor::silent())?;
//! assert!(found.is_sound() && found.moves == 115);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

mod carrier;
pub mod check;
mod corrected;
mod error;
mod fanuc;
mod frames;
mod krl;
mod layout;
mod motion;
mod names;
mod rapid;
mod split;
mod stale;
mod status;
mod table;
#[cfg(test)]
mod tests;
mod transfer_paths;

pub use error::{ExportError, ProgramError};
pub use frames::{OperatorFrame, Rotation};
pub use layout::ProgramFile;

use corrected::corrected_targets;
use layout::Layout;
use motion::{Frames, Move, MoveKind, Target};
use stale::StaleParts;
use std::path::{Path, PathBuf};
use stead_disk::files::new::{Existing, foreign, write_all_new};
use stead_disk::input::{InputError, InputFile};
use stead_disk::manifest::interruption_note;
use stead_model::robot::{ControllerKind, Robot};
use stead_numerics::message::{Note, NoteGroup, Warning};
use stead_numerics::monitor::Monitor;
use stead_problem::problem::{Placement, Problem, UNCHECKED};
use stead_runs::Run;
use stead_runs::plan::read_plan;
use transfer_paths::{Ends, TransferPaths};

/// The form of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProgramFormat {
    /// KUKA: KRL, files `.src`.
    Krl,
    /// ABB: RAPID, files `.mod`.
    Rapid,
    /// Fanuc: TP programs in ASCII, files `.ls`.
    Fanuc,
    /// A table of moves, for any post.
    Csv,
}

impl ProgramFormat {
    /// All, in the order in which they are listed.
    pub const ALL: [Self; 4] = [Self::Krl, Self::Rapid, Self::Fanuc, Self::Csv];

    /// Its name on the command line, the ending of its files, and whose controllers take it.
    fn about(self) -> (&'static str, &'static str, Option<ControllerKind>) {
        match self {
            Self::Krl => ("krl", "src", Some(ControllerKind::Kuka)),
            Self::Rapid => ("rapid", "mod", Some(ControllerKind::Abb)),
            Self::Fanuc => ("fanuc", "ls", Some(ControllerKind::Fanuc)),
            Self::Csv => ("csv", "csv", None),
        }
    }

    /// Its name on the command line.
    pub fn word(self) -> &'static str {
        self.about().0
    }

    /// The form that the controller of an arm takes; the table where none is known, or one of another kind.
    pub fn of_robot(robot: &Robot) -> Self {
        let kind = robot.controller().map(|controller| controller.kind);
        Self::ALL.into_iter().find(|format| kind.is_some() && format.controller() == kind).unwrap_or(Self::Csv)
    }

    /// The ending of its files.
    pub fn extension(self) -> &'static str {
        self.about().1
    }

    /// Whose controllers take it; none for the table.
    pub fn controller(self) -> Option<ControllerKind> {
        self.about().2
    }
}

/// The path that a program follows where it is not that of the plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CorrectedPath<'a> {
    /// `corrected-path.csv` of `stead compensate`.
    pub file: &'a Path,
    /// Whether points that could not be corrected are commanded as planned; else they are refused.
    pub is_uncorrected_as_planned: bool,
}

/// How a program is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExportOptions<'a> {
    /// In which form.
    pub format: ProgramFormat,
    /// Its name, without folder and ending.
    pub name: &'a str,
    /// The corrected path to follow.
    pub corrected: Option<CorrectedPath<'a>>,
    /// How far the tool is retracted along its axis before and after a segment; 0 for not at all. m
    pub approach: f64,
    /// Distance from a corner at which blending begins; 0 for exact stops. m
    pub blend: f64,
    /// Most moves in a part.
    pub max_moves: usize,
    /// KUKA: the number n of `MACHINE_DEF[n]`, the mechanism that carries the workpiece.
    pub mechanism: Option<usize>,
    /// ABB: the mechanical unit that carries the workpiece.
    pub unit: Option<&'a str>,
    /// Whether a program is made though moves between segments hit what stands around; they are marked in it.
    pub allow_blocked_moves: bool,
    /// The statement that starts the spindle.
    pub spindle_on: Option<&'a str>,
    /// The statement that stops it.
    pub spindle_off: Option<&'a str>,
}

impl<'a> ExportOptions<'a> {
    /// With the values of the command line where they are left out there.
    pub fn new(format: ProgramFormat, name: &'a str) -> Self {
        Self {
            format,
            name,
            corrected: None,
            approach: Self::APPROACH,
            blend: Self::BLEND,
            max_moves: 5000,
            mechanism: None,
            unit: None,
            allow_blocked_moves: false,
            spindle_on: None,
            spindle_off: None,
        }
    }
    /// How far the tool is retracted where nothing is said. m
    pub const APPROACH: f64 = 0.05;
    /// Where blending begins where nothing is said. m
    pub const BLEND: f64 = 1e-3;
}

/// A program, not written to files yet.
#[derive(Debug, Clone, PartialEq)]
pub struct Program {
    /// Its form.
    pub format: ProgramFormat,
    /// Its name.
    pub name: String,
    /// The robot that it is for.
    pub robot: String,
    /// Its files, the one to start first.
    pub files: Vec<ProgramFile>,
    /// The frames to enter at the controller, where its root is known: workpiece, tool, and the table where the program
    /// is coupled to one.
    pub frames: Vec<OperatorFrame>,
    /// How many segments it has.
    pub segments: usize,
    /// How many moves to joint angles.
    pub joint_moves: usize,
    /// How many moves on straight lines.
    pub linear_moves: usize,
    /// How many parts the moves are in.
    pub parts: usize,
    /// Points commanded as planned since they could not be corrected.
    pub uncorrected: usize,
    /// The files that it was made of.
    pub inputs: Vec<InputFile>,
    /// What the user should know.
    pub notes: Vec<String>,
    /// Which of its moves hit what stands around.
    pub warnings: Vec<Warning>,
}

/// A program in its folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WrittenProgram {
    /// The paths of its files, the one to start first.
    pub files: Vec<PathBuf>,
    /// Which parts of an earlier program of its name were removed, and which are still there, one sentence for each.
    pub notes: Vec<String>,
}

impl Program {
    /// Writes the files into a folder, which is made where there is none. All files or none: where one of them is there
    /// already and to be kept, nothing is changed. Where a program is replaced that an export has written, those of its
    /// parts that this one does not have are removed.
    ///
    /// # Errors
    /// [`InputError`] that names the file that is there already, or that cannot be written.
    pub fn write(&self, folder: &Path, existing: Existing) -> Result<WrittenProgram, InputError> {
        let files: Vec<(PathBuf, &str)> =
            self.files.iter().map(|file| (folder.join(&file.name), file.text.as_str())).collect();
        let stale = StaleParts::beside(self, folder);
        if existing == Existing::Replaced && self.format != ProgramFormat::Csv {
            let is_foreign =
                |file: &&ProgramFile| folder.join(&file.name).is_file() && !stale::is_own(folder, &file.name);
            if let Some(file) = self.files.iter().find(is_foreign) {
                return Err(foreign(&folder.join(&file.name)));
            }
        }
        write_all_new(&files, existing, &self.inputs)?;
        let notes = stale.remove();
        Ok(WrittenProgram { files: files.into_iter().map(|(path, _)| path).collect(), notes })
    }
}

/// The longest retraction, in m, and the widest blending, in m: beyond them a unit is wrong.
const MAX_LENGTHS: [f64; 2] = [1.0, 0.1];
/// What the header of a program says of a plan that is not the end of a search.
const INTERRUPTED: &str = "INTERRUPTED search: the best plan found by then";
/// Most moves in a part.
const MAX_MOVES: usize = 1_000_000;

/// Makes the program of a plan that `stead place` wrote for a run.
///
/// # Errors
/// [`ExportError::Input`] for a plan that is not of this run, a corrected path that is not of this plan, and a robot
/// without the tables that the form needs; [`ExportError::Program`] for options that are not taken, and points that the
/// arm does not reach; [`ExportError::Stopped`] when `monitor` asked to stop while free ways were looked for.
pub fn export(run: &Run, plan: &Path, options: &ExportOptions<'_>, monitor: &Monitor) -> Result<Program, ExportError> {
    check_options(run, options)?;
    let ends = Ends { approach: options.approach, has_blending: options.blend > 0.0 };
    let planned = targets(run, plan, options, monitor)?;
    let problem = &planned.problem;
    let blocked = planned.transfer_paths.blocked(ends);
    if !blocked.is_empty() && !options.allow_blocked_moves {
        return Err(ProgramError::Blocked { moves: blocked.join("; ") }.into());
    }
    let carrier = carrier::carrier(problem, options)?;
    let mut moves = motion::moves(problem, &planned.placement, &planned.targets, ends, &planned.transfer_paths)?;
    let cell_from_workpiece = match options.format {
        ProgramFormat::Fanuc => carrier::standing_still(problem, &planned.placement, &mut moves),
        _ => motion::at_zero(problem, &planned.placement),
    };
    let table = carrier.and_then(|_| carrier::root_from_table(problem));
    let frames = motion::frames(problem, &cell_from_workpiece, table);
    let parts = split::parts(&moves, options.max_moves);
    let mut notes = planned.notes.clone();
    notes.extend(names::check(options.name, options.format, parts.len())?);
    notes.extend(format_note(options, &moves, frames.is_some()));
    notes.extend(carrier::note(problem, carrier));
    let part_count = if options.format == ProgramFormat::Csv { 1 } else { parts.len() };
    let files = match frames.filter(|_| options.format.controller().is_some()) {
        None => table::files(options.name, &moves, motion::external_units(problem), problem.scene.is_some()),
        Some(frames) => {
            let statement = |option, text: Option<&str>| {
                text.map(|text| names::statement(option, text, options.format)).transpose()
            };
            files(&Layout {
                problem,
                options,
                origin: origin(run, &planned),
                moves: &moves,
                parts,
                frames,
                carrier,
                spindle_on: statement("--spindle-on", options.spindle_on)?,
                spindle_off: statement("--spindle-off", options.spindle_off)?,
            })
        }
    };
    let joint_moves = moves.iter().filter(|step| step.kind == MoveKind::Joint).count();
    Ok(Program {
        format: options.format,
        name: options.name.to_owned(),
        robot: problem.robot.name().to_owned(),
        files,
        frames: operator_frames(problem, frames),
        segments: problem.task.segments().len(),
        joint_moves,
        linear_moves: moves.len() - joint_moves,
        parts: part_count,
        uncorrected: planned.uncorrected,
        inputs: planned.inputs,
        notes,
        warnings: planned.transfer_paths.warnings(ends),
    })
}

/// The files of a program in the words of its controller: the main program, which calls the parts, and the parts.
fn files(layout: &Layout<'_>) -> Vec<ProgramFile> {
    type Writers = (fn(&Layout<'_>) -> ProgramFile, fn(&Layout<'_>, usize) -> ProgramFile);
    let (main, part): Writers = match layout.options.format {
        ProgramFormat::Rapid => (rapid::main, rapid::part),
        ProgramFormat::Fanuc => (fanuc::main, fanuc::part),
        ProgramFormat::Krl | ProgramFormat::Csv => (krl::main, krl::part),
    };
    std::iter::once(main(layout)).chain((0..layout.parts.len()).map(|index| part(layout, index))).collect()
}

/// What a program follows, and where from.
struct Planned {
    placement: Placement,
    /// The problem in the setup of the plan.
    problem: Problem,
    targets: Vec<Target>,
    transfer_paths: TransferPaths,
    uncorrected: usize,
    inputs: Vec<InputFile>,
    /// Whether the search that the plan is from was interrupted.
    is_interrupted: bool,
    notes: Vec<String>,
}

/// The targets of a plan, or those of its corrected path.
fn targets(run: &Run, plan: &Path, options: &ExportOptions<'_>, monitor: &Monitor) -> Result<Planned, ExportError> {
    let is_interrupted = interruption_note(plan).is_some();
    let (plan, file) = read_plan(plan, &run.problem)?;
    let problem = run.problem.in_setup(&plan.setup).into_owned();
    let mut inputs = run.inputs.clone();
    inputs.push(file);
    let transfer_paths = TransferPaths::new(&problem, &plan, options.approach, monitor)?;
    let planned = motion::targets(&problem, &plan);
    let (targets, uncorrected) = match options.corrected {
        Some(path) => {
            let (targets, uncorrected, file) = corrected_targets(&problem, &planned, path)?;
            inputs.push(file);
            (targets, uncorrected)
        }
        None => (planned, 0),
    };
    let (placement, notes) = (plan.placement, plan.notes);
    Ok(Planned { placement, problem, targets, transfer_paths, uncorrected, inputs, is_interrupted, notes })
}

/// The key by which an arm with a linkage says how its controller counts axis 3.
const IS_J3_LEVEL: &str = "controller.is_j3_level";

/// That the value of an option is beyond what is allowed.
fn out_of_range(option: &'static str, found: &str, allowed: &str) -> ExportError {
    let problem = format!("is out of range, found {found}");
    ProgramError::Argument { option, problem, allowed: allowed.to_owned() }.into()
}

/// Whether the options are in their ranges, and the form is one for the robot.
fn check_options(run: &Run, options: &ExportOptions<'_>) -> Result<(), ExportError> {
    names::check(options.name, options.format, 1)?;
    for (option, length, max, allowed) in [
        ("--approach-mm", options.approach, MAX_LENGTHS[0], "a number from 0 to 1000"),
        ("--blend-mm", options.blend, MAX_LENGTHS[1], "a number from 0 to 100"),
    ] {
        if !(0.0..=max).contains(&length) {
            return Err(out_of_range(option, &format!("{} mm", length * 1e3), allowed));
        }
    }
    if !(1..=MAX_MOVES).contains(&options.max_moves) {
        let allowed = "a whole number from 1 to 1000000";
        return Err(out_of_range("--max-moves", &options.max_moves.to_string(), allowed));
    }
    let Some(kind) = options.format.controller() else { return Ok(()) };
    let controller = run.problem.robot.controller();
    let missing = match controller {
        None => "controller",
        Some(controller) if controller.kind != kind => {
            let fitting = ProgramFormat::ALL.into_iter().filter(|format| format.controller() == Some(controller.kind));
            let words: Vec<&str> = fitting.chain([ProgramFormat::Csv]).map(ProgramFormat::word).collect();
            let problem = format!("{} is not for the robot's controller", options.format.word());
            return Err(ProgramError::Argument { option: "--format", problem, allowed: words.join(", ") }.into());
        }
        Some(controller) if controller.root_from_base.is_none() => "root",
        Some(controller) if run.problem.robot.has_linkage() && controller.is_j3_level.is_none() => IS_J3_LEVEL,
        Some(_) => return Ok(()),
    };
    let robot = run.inputs.iter().find(|input| input.role == "robot").map_or("", |input| input.name.as_str());
    let problem = format!("is missing, and a program in {} needs it", options.format.word());
    let error = InputError::new(Path::new(robot), problem).in_field(missing);
    if missing == IS_J3_LEVEL {
        let allowed = "true where the controller counts axis 3 against the horizontal, as Fanuc's do, and ABB's on arms with \
                       a parallelogram; false where it shows the angle between the links (stead pose tells)";
        return Err(error.allowed(allowed).into());
    }
    Err(error
        .allowed(
            "[controller] with kind, sign and offset_deg, and [root] with xyz_mm and an orientation as abc_deg (`stead import robot` writes \
             both commented out; the page robot_file says how to check them); or --format csv, for poses in the workpiece frame alone",
        )
        .into())
}

/// What the program is, what it was made of and what it does not say, for comments.
fn origin(run: &Run, planned: &Planned) -> Vec<String> {
    let mut lines = vec![format!("{} {} for", stale::MARK, env!("CARGO_PKG_VERSION"))];
    lines.push(names::comment(run.problem.robot.name(), 60));
    lines.extend(planned.inputs.iter().map(|input| names::comment(&format!("{}: {}", input.role, input.name), 100)));
    let rests_on = Note::shorts(&run.notes, NoteGroup::RestsOn);
    lines.extend(rests_on.iter().map(|short| names::comment(&format!("rests on {short}"), 100)));
    lines.extend(planned.problem.unchecked_collisions().is_some().then(|| UNCHECKED.to_owned()));
    lines.extend(planned.is_interrupted.then(|| INTERRUPTED.to_owned()));
    lines
}

/// What the form cannot hold.
fn format_note(options: &ExportOptions<'_>, moves: &[Move], has_frames: bool) -> Option<String> {
    let is_whole = |step: &Move| (step.feed * 1e3 - f64::from(fanuc::speed(step.feed))).abs() < 1e-6;
    match options.format {
        ProgramFormat::Fanuc if !moves.iter().all(is_whole) || options.blend > 0.0 => Some(format!(
            "TP programs hold whole mm/s and blend by a share of the speed: feeds are rounded, and corners are {}",
            if options.blend > 0.0 { fanuc::BLENDING } else { "FINE" }
        )),
        ProgramFormat::Csv if !has_frames => Some(
            "the robot file has no [root]: poses are in the workpiece frame, and no frame of the controller is known"
                .to_owned(),
        ),
        _ => None,
    }
}

/// The frames to enter at the controller, in its convention.
fn operator_frames(problem: &Problem, frames: Option<Frames>) -> Vec<OperatorFrame> {
    let (Some(frames), Some(controller)) = (frames, problem.robot.controller()) else { return Vec::new() };
    frames::operator_frames(controller.kind, &frames)
}
