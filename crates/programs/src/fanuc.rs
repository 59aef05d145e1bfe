//! Programs for Fanuc's controllers, in the ASCII form of TP programs (LS).

use super::layout::{Layout, Lines, ProgramFile};
use super::motion::{Move, MoveKind, external_units};
use super::names::{comment, number};
use super::stale;
use super::status::fanuc_config;
use stead_disk::template::filled;
use stead_model::robot::Pose;
use stead_numerics::rotation::zyx_from_rotation;

/// The number of the user frame and of the tool frame that a program takes.
pub(super) const FRAME_NUMBER: u8 = 9;
/// How far ahead of a point a blended move may turn off: Fanuc's CNT is a share of the speed, no distance.
pub(super) const BLENDING: &str = "CNT10";
/// The longest remark of a TP program.
const REMARK: usize = 32;
const MM_DECIMALS: usize = 3;
const DEG_DECIMALS: usize = 4;
/// Decimals of joint angles in deg: all six off by half a unit move nothing 4 m away by 3e-3 mm.
const AXIS_DECIMALS: usize = 5;

/// X, Y, Z in mm, W, P, R in deg, `Rz(R) Ry(P) Rx(W)`.
pub(super) fn xyzwpr(pose: &Pose<f64>) -> [(&'static str, f64); 6] {
    let [r, p, w] = zyx_from_rotation(&pose.rotation).map(f64::to_degrees);
    let [x, y, z] = [0, 1, 2].map(|axis| pose.translation[axis] * 1e3);
    [("X", x), ("Y", y), ("Z", z), ("W", w), ("P", p), ("R", r)]
}

/// Numbered statements of a TP program.
#[derive(Default)]
struct Statements {
    lines: Lines,
    count: usize,
}

impl Statements {
    fn push(&mut self, statement: impl std::fmt::Display) {
        self.count += 1;
        self.lines.line(format_args!("{:4}:{statement} ;", self.count));
    }

    fn remark(&mut self, text: &str) {
        self.push(format_args!("  !{}", comment(&text.replace(';', ","), REMARK)));
    }
}

fn program(name: &str, statements: &Statements, positions: &str) -> ProgramFile {
    let whole = |lines: &str| lines.strip_suffix('\n').map(str::to_owned);
    let text = filled(
        include_str!("fanuc.ls"),
        &[
            ("name", Some(name.to_owned())),
            ("mark", Some(stale::TP_MARK.to_owned())),
            ("statements", whole(&statements.lines.0)),
            ("positions", whole(positions)),
        ],
    );
    ProgramFile { name: format!("{name}.ls"), text }
}

/// The main program, which calls the parts.
pub(super) fn main(layout: &Layout<'_>) -> ProgramFile {
    let mut statements = Statements::default();
    layout.origin.iter().for_each(|text| statements.remark(text));
    match &layout.spindle_on {
        Some(text) => statements.push(format_args!("  {text}")),
        None => statements.remark("spindle on: --spindle-on"),
    }
    for index in 0..layout.parts.len() {
        statements.push(format_args!("  CALL {}", layout.part_name(index).to_ascii_uppercase()));
    }
    match &layout.spindle_off {
        Some(text) => statements.push(format_args!("  {text}")),
        None => statements.remark("spindle off: --spindle-off"),
    }
    program(&layout.options.name.to_ascii_uppercase(), &statements, "")
}

/// A part, counted from 0.
pub(super) fn part(layout: &Layout<'_>, index: usize) -> ProgramFile {
    let (mut statements, mut positions) = (Statements::default(), Lines::default());
    for (name, pose) in [("UFRAME", layout.frames.root_from_workpiece), ("UTOOL", layout.frames.flange_from_tool)] {
        for ((key, value), decimals) in xyzwpr(&pose).into_iter().zip([4, 4, 4, 6, 6, 6]) {
            statements.remark(&format!("{name} {FRAME_NUMBER} {key} {}", number(value, decimals)));
        }
    }
    statements.push(format_args!("  UFRAME_NUM={FRAME_NUMBER}"));
    statements.push(format_args!("  UTOOL_NUM={FRAME_NUMBER}"));
    let moves = layout.moves_of(index);
    for (in_part, step) in moves.iter().enumerate() {
        layout.heading(index, in_part).iter().for_each(|text| statements.remark(text));
        let position = in_part + 1;
        match step.kind {
            MoveKind::Joint => {
                statements.push(format_args!("J P[{position}] {}% FINE", Layout::JOINT_SPEED_PERCENT));
            }
            MoveKind::Linear => {
                let stop = if step.is_blended && position < moves.len() { BLENDING } else { "FINE" };
                statements.push(format_args!("L P[{position}] {}mm/sec {stop}", speed(step.feed)));
            }
        }
        position_of(&mut positions, position, step, layout);
    }
    program(&layout.part_name(index).to_ascii_uppercase(), &statements, &positions.0)
}

/// Speeds of linear moves are whole mm/s.
pub(super) fn speed(feed: f64) -> u32 {
    (feed * 1e3).round().max(1.0) as u32
}

fn position_of(lines: &mut Lines, number_of: usize, step: &Move, layout: &Layout<'_>) {
    let units = external_units(layout.problem);
    let angles = step.angles.unwrap_or(step.joints);
    lines.line(format_args!("P[{number_of}]{{"));
    lines.line("   GP1:");
    let of_frames = format!("\tUF : {FRAME_NUMBER}, UT : {FRAME_NUMBER},");
    match step.kind {
        MoveKind::Joint => {
            lines.line(of_frames);
            let axes: Vec<String> = angles
                .iter()
                .zip(1..)
                .map(|(angle, axis)| format!("\tJ{axis}= {:>10} deg", number(angle.to_degrees(), AXIS_DECIMALS)))
                .collect();
            lines.line(format_args!("{},", axes[..3].join(",")));
            lines.line(format_args!("{}{}", axes[3..].join(","), external(step, units)));
        }
        MoveKind::Linear => {
            let words = layout.problem.robot.posture_words(step.posture);
            lines.line(format_args!("{of_frames}\t\tCONFIG : '{}',", fanuc_config(words, &angles)));
            let numbers = xyzwpr(&step.workpiece_from_tool);
            let entry = |(key, value): (&str, f64), decimals, unit: &str| {
                format!("\t{key} = {:>10} {unit}", number(value, decimals))
            };
            let lengths: Vec<String> = numbers[..3].iter().map(|pair| entry(*pair, MM_DECIMALS, " mm")).collect();
            let turns: Vec<String> = numbers[3..].iter().map(|pair| entry(*pair, DEG_DECIMALS, "deg")).collect();
            lines.line(format_args!("{},", lengths.join(",")));
            lines.line(format_args!("{}{}", turns.join(","), external(step, units)));
        }
    }
    lines.line("};");
}

/// `, E1 = ..` for each external axis, on lines of their own.
fn external(step: &Move, units: [&str; 6]) -> String {
    let entry = |((position, unit), axis): ((Option<f64>, &str), usize)| {
        Some(format!("\tE{axis}= {:>10} {unit:>3}", number(position?, AXIS_DECIMALS)))
    };
    let entries: Vec<String> = step.external.into_iter().zip(units).zip(1..).filter_map(entry).collect();
    if entries.is_empty() { String::new() } else { format!(",\n{}", entries.join(",")) }
}
