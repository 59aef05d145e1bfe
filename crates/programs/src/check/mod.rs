//! A program read back: every pose of the tool rebuilt from its text and compared with the plan.
//!
//! Nothing is shared with the writers: the languages are parsed anew, and frames, angles and forward kinematics are
//! those of `geometry`. Joint moves go through the rows of the robot and the controller's signs and offsets; linear
//! moves through the frames that the program states, as the controller takes them: a base that is coupled to no
//! mechanism stands still, whatever external axes do. Either way the flange is found first, and then the tool of the
//! run on it, so that a wrong tool frame in the program is found, too.

mod contact;
mod expected;
mod fanuc;
mod free;
mod geometry;
mod krl;
mod outcome;
mod rapid;
mod table;
mod written;

use super::{
    CorrectedPath, ExportError, ExportOptions, ProgramFormat, corrected::corrected_targets, motion,
    transfer_paths::TransferPaths,
};
use expected::{Expected, frame, workpiece};
use geometry::{Frame, apart, flange, floor_seen, of_rows, seen, table as table_at_zero};
use nalgebra::{Matrix3, Vector3};
pub use outcome::{ANGLE_DEG, Largest, MoveHit, MovePlace, POSITION_MM, ProgramCheck, UnfollowedMove};
use std::path::Path;
use stead_disk::input::{InputError, input_file};
use stead_model::external_axis::ExternalAxis;
use stead_model::robot::{Controller, Pose, Robot};
use stead_numerics::monitor::Monitor;
use stead_problem::problem::{Placement, Problem};
use stead_runs::Run;
use stead_runs::plan::read_plan;
use written::{Base, End, Goal, Source, Written};

/// How far the feed may be off where the form holds decimals. mm/s
const FEED_MM_PER_S: f64 = 2e-3;
/// How far it may be off on a Fanuc, which holds whole mm/s from 1 on. mm/s
const WHOLE_FEED: f64 = 0.5 + 1e-9;
/// The share of the speed at which moves of a Fanuc are blended. %
const FANUC_SHARE: f64 = 10.0;
/// How far the distance may be off at which blending begins. mm
const BLEND_MM: f64 = 1e-3;

/// How a program was exported, which cannot be read from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReadBackOptions<'a> {
    /// The corrected path that it follows.
    pub corrected: Option<CorrectedPath<'a>>,
    /// How far the tool is retracted along its axis before and after a segment; 0 for not at all. m
    pub approach: f64,
    /// Distance from a corner at which blending begins; 0 for exact stops. m
    pub blend: f64,
}

impl Default for ReadBackOptions<'_> {
    fn default() -> Self {
        Self { corrected: None, approach: ExportOptions::APPROACH, blend: ExportOptions::BLEND }
    }
}

/// Reads a program and compares it with the plan that it was made of.
///
/// # Errors
/// [`ExportError::Input`] with file and line for a program that is not understood, and for a plan or corrected path
/// that does not fit the run; [`ExportError::Stopped`] when `monitor` asked to stop while free ways were looked for.
pub fn check(
    run: &Run,
    plan: &Path,
    program: &Path,
    options: &ReadBackOptions<'_>,
    monitor: &Monitor,
) -> Result<ProgramCheck, ExportError> {
    let ReadBackOptions { corrected, approach, blend } = *options;
    let source = Source::read(program)?;
    let format = format_of(program)?;
    let (plan, plan_file) = read_plan(plan, &run.problem)?;
    let problem = run.problem.in_setup(&plan.setup);
    let mut inputs = run.inputs.clone();
    inputs.push(plan_file);
    if let Some(path) = corrected {
        inputs.push(corrected_targets(&problem, &motion::targets(&problem, &plan), path)?.2);
    }
    let written = match format {
        ProgramFormat::Krl => krl::moves(&source)?,
        ProgramFormat::Rapid => rapid::moves(&source)?,
        ProgramFormat::Fanuc => fanuc::moves(&source)?,
        ProgramFormat::Csv => table::moves(&source)?,
    };
    inputs.push(input_file("program", program.to_string_lossy().replace('\\', "/"), source.text.as_bytes()));
    let transfer_paths = TransferPaths::new(&problem, &plan, approach, monitor)?;
    let expected = expected::moves(&problem, &plan, &transfer_paths, corrected.map(|path| path.file), approach * 1e3)?;
    let arm = Arm::new(&problem, &plan.placement, format, blend * 1e3);
    let mut result = arm.compared(&source, &written.all, &expected)?;
    if let Some(space) = problem.lean.as_deref().filter(|_| corrected.is_none()) {
        result.contact_allowed = contact::allowed(space);
        result.contact = contact::largest(&arm, &problem, &space.rule, &plan.placement, &written.all, &expected)?;
    }
    result.hits = free::hits(&problem, &plan.placement, &transfer_paths, &written.all, &expected);
    result.unfollowed = free::unfollowed(&transfer_paths, &written.all, &expected);
    result.inputs = inputs;
    Ok(result)
}

/// The form of a program by the ending of its file.
fn format_of(program: &Path) -> Result<ProgramFormat, InputError> {
    let ending = program.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let found = ProgramFormat::ALL.into_iter().find(|format| format.extension() == ending);
    found.ok_or_else(|| {
        InputError::new(program, "is no program that can be read back")
            .allowed("a main program that `stead export` wrote: .src (KRL), .mod (RAPID), .ls (Fanuc), .csv")
    })
}

/// What turns the goals of a program into places of the tool.
struct Arm<'a> {
    robot: &'a Robot,
    controller: Option<&'a Controller>,
    /// The tool on the flange, as the run has it.
    mounted: Frame,
    /// The same on the mounting flange, as programs state it.
    on_flange: Frame,
    /// The base frame of the rows in the cell frame.
    stand: Frame,
    /// The workpiece of the task file in the cell frame, with all external axes at zero.
    placed: Frame,
    axes: &'a [ExternalAxis],
    format: ProgramFormat,
    /// Where blending begins. mm
    blend: f64,
}

impl<'a> Arm<'a> {
    fn new(problem: &'a Problem, placement: &Placement, format: ProgramFormat, blend: f64) -> Self {
        let robot = &problem.robot;
        let lying = problem.orientation().map_or(Matrix3::identity(), |orientation| orientation.rotation);
        let lying = Pose { rotation: lying, translation: Vector3::zeros() };
        Self {
            robot,
            controller: robot.controller(),
            mounted: frame(&problem.spindle.flange_from_tool),
            on_flange: frame(&robot.on_flange(&problem.spindle.flange_from_tool)),
            stand: frame(&robot.cell_from_base()),
            placed: workpiece(placement).of(&frame(&lying)),
            axes: &problem.external_axes,
            format,
            blend,
        }
    }

    fn compared(
        &self,
        source: &Source,
        written: &[Written],
        expected: &[Expected],
    ) -> Result<ProgramCheck, InputError> {
        let mut check = ProgramCheck {
            file: source.file.clone(),
            moves: written.len(),
            joint_moves: written.iter().filter(|one| one.goal.is_joint()).count(),
            expected_moves: expected.len(),
            position: None,
            angle: None,
            contact: None,
            contact_allowed: 0.0,
            mismatch: None,
            hits: Vec::new(),
            unfollowed: Vec::new(),
            inputs: Vec::new(),
        };
        for (number, (one, wanted)) in written.iter().zip(expected).enumerate() {
            if check.mismatch.is_none() {
                let ends_part = written.get(number + 1).is_none_or(|next| next.file != one.file);
                check.mismatch = self.mismatch(one, wanted).or_else(|| self.other_pace(one, wanted, ends_part));
            }
            for tool in self.tools(one)? {
                let (mm, deg) = apart(&tool, &wanted.tool);
                Largest::keep(&mut check.position, mm, one, wanted);
                Largest::keep(&mut check.angle, deg, one, wanted);
            }
        }
        if written.len() != expected.len() && check.mismatch.is_none() {
            check.mismatch =
                Some(format!("the program has {} moves, and the plan asks for {}", written.len(), expected.len()));
        }
        Ok(check)
    }

    /// In what a move is another than the plan's, but for its place: its kind, or a turn of a joint.
    fn mismatch(&self, one: &Written, wanted: &Expected) -> Option<String> {
        let place = format!("{}:{}", one.file.display(), one.line);
        if one.goal.is_joint() != wanted.is_joint {
            let kind = |is_joint: bool| if is_joint { "a joint move" } else { "a linear move" };
            let (found, expected) = (kind(one.goal.is_joint()), kind(wanted.is_joint));
            let point = wanted.point;
            return Some(format!("{place} is {found}, and at point {point} the plan asks for {expected}"));
        }
        if let Some(axis) = (0..6).find(|axis| is_off(one.external[*axis], wanted.external[*axis])) {
            return Some(format!(
                "{place}: external axis E{} is not where the plan has it at point {}",
                axis + 1,
                wanted.point
            ));
        }
        let (Goal::Angles(angles) | Goal::Row { angles: Some(angles), .. }) = one.goal else { return None };
        let rows = of_rows(self.robot.joints(), self.controller?, &angles);
        let far = (0..6).find(|axis| (rows[*axis] - wanted.near[*axis]).abs() > std::f64::consts::PI)?;
        Some(format!("{place}: axis {} is a turn away from the plan at point {}", far + 1, wanted.point))
    }

    /// In what the feed of a move or its end is another than the plan's. A part may end with an exact stop.
    fn other_pace(&self, one: &Written, wanted: &Expected, ends_part: bool) -> Option<String> {
        let place = format!("{}:{}", one.file.display(), one.line);
        let allowed = match self.format {
            ProgramFormat::Fanuc => WHOLE_FEED.max(1.0 - wanted.feed),
            _ => FEED_MM_PER_S,
        };
        if let Some(feed) = one.pace.feed.filter(|feed| (feed - wanted.feed).abs() > allowed || feed.is_nan()) {
            let (requested, point) = (wanted.feed, wanted.point);
            return Some(format!(
                "{place}: the feed is {feed} mm/s, and at point {point} the plan asks for {requested:.4}"
            ));
        }
        let end = one.pace.end?;
        let requested = match self.format {
            _ if !wanted.is_blended || self.blend == 0.0 => End::Exact,
            ProgramFormat::Fanuc => End::Share(FANUC_SHARE),
            _ => End::Within(self.blend),
        };
        let is_same = match (end, requested) {
            (End::Within(found), End::Within(requested)) => (found - requested).abs() <= BLEND_MM,
            (End::Exact, _) if ends_part => true,
            _ => end == requested,
        };
        (!is_same).then(|| {
            format!("{place}: the move {end}, where the program of the plan {requested}, at point {}", wanted.point)
        })
    }

    /// Where a move brings the tool of the run, in the cell frame, by each way in which the program says it.
    fn tools(&self, one: &Written) -> Result<Vec<Frame>, InputError> {
        let unknown = |what: &str| {
            InputError::new(&one.file, format!("cannot be compared, since the robot file has no {what}"))
                .at_line(one.line)
                .allowed("a robot file with [controller] and [root]")
        };
        let by_angles = |angles: &[f64; 6]| {
            let controller = self.controller.ok_or_else(|| unknown("[controller]"))?;
            Ok(self
                .stand
                .of(&flange(self.robot.joints(), &of_rows(self.robot.joints(), controller, angles)))
                .of(&self.mounted))
        };
        match &one.goal {
            Goal::Angles(angles) => Ok(vec![by_angles(angles)?]),
            Goal::Row { tool, angles, .. } => {
                let mut tools = vec![seen(self.axes, &one.external).of(&self.placed).of(tool)];
                tools.extend(angles.as_ref().map(by_angles).transpose()?);
                Ok(tools)
            }
            Goal::Line { tool, base, mounted } => {
                let root = self.controller.and_then(|controller| controller.root_from_base);
                let root = frame(&root.ok_or_else(|| unknown("[root]"))?);
                let cell_from_root = self.stand.of(&root.inverted());
                let base = match base {
                    Base::Still(base) => floor_seen(self.axes, &one.external).of(&cell_from_root).of(base),
                    Base::OnTable(base) => {
                        let table = table_at_zero(self.axes, &cell_from_root).ok_or_else(|| {
                            InputError::new(
                                &one.file,
                                "couples its base to axes that carry the workpiece, and the run has none",
                            )
                            .at_line(one.line)
                            .allowed("a program of this run")
                        })?;
                        seen(self.axes, &one.external).of(&table).of(base)
                    }
                };
                Ok(vec![base.of(tool).of(&mounted.inverted()).of(&self.on_flange)])
            }
        }
    }
}

/// Whether an external axis is elsewhere, by more than the tool may be. mm or deg
fn is_off(found: Option<f64>, wanted: Option<f64>) -> bool {
    match (found, wanted) {
        (None, None) => false,
        (Some(found), Some(wanted)) => (found - wanted).abs() > POSITION_MM,
        _ => true,
    }
}
