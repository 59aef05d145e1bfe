//! Programs for KUKA's controllers, in KRL.

use super::carrier::Carrier;
use super::layout::{Layout, Lines, ProgramFile};
use super::motion::{Move, MoveKind};
use super::names::number;
use stead_disk::template::{filled, shown_if};
use stead_model::robot::{Pose, kuka_status_and_turn};
use stead_numerics::rotation::zyx_from_rotation;

/// A frame as X, Y, Z in mm and A, B, C in deg, `Rz(A) Ry(B) Rx(C)`.
pub(super) fn frame(pose: &Pose<f64>, decimals: [usize; 2]) -> String {
    let [mm, deg] = decimals;
    let xyz = pose.translation * 1e3;
    let abc = zyx_from_rotation(&pose.rotation).map(f64::to_degrees);
    let entry = |name: &str, value: f64, decimals: usize| format!("{name} {}", number(value, decimals));
    let lengths = ["X", "Y", "Z"].into_iter().zip(xyz.iter()).map(|(name, value)| entry(name, *value, mm));
    let angles = ["A", "B", "C"].into_iter().zip(abc).map(|(name, value)| entry(name, value, deg));
    lengths.chain(angles).collect::<Vec<_>>().join(",")
}

/// Decimals of `$BASE` and `$TOOL`: so fine that over 2 m of workpiece they move nothing by 1e-4 mm.
pub(super) const FRAME_DECIMALS: [usize; 2] = [4, 6];
/// Decimals of a pose: as posts write positions; a unit of the angles turns a tool of 0.5 m by 1e-3 mm.
const POSE_DECIMALS: [usize; 2] = [3, 4];
/// Decimals of joint angles: all six off by half a unit move nothing 4 m away by 3e-3 mm.
const AXIS_DECIMALS: usize = 5;

fn head(layout: &Layout<'_>, name: &str) -> String {
    let holes = [("name", Some(name.to_owned())), ("origin", layout.origin_behind("; "))];
    filled(include_str!("krl_head.src"), &holes)
}

/// The base of linear moves: it stands still in the robot root, or moves with a mechanism.
fn base(layout: &Layout<'_>) -> String {
    let braced = |pose: &Pose<f64>| format!("{{FRAME: {}}}", frame(pose, FRAME_DECIMALS));
    match (layout.carrier, layout.frames.table_from_workpiece()) {
        (Some(Carrier::Mechanism(n)), Some(on_table)) => {
            format!("EK(MACHINE_DEF[{n}].ROOT,MACHINE_DEF[{n}].MECH_TYPE,{})", braced(&on_table))
        }
        _ => braced(&layout.frames.root_from_workpiece),
    }
}

/// The main program, which calls the parts.
pub(super) fn main(layout: &Layout<'_>) -> ProgramFile {
    let statement = |given: &Option<String>, none: &str| Some(given.as_deref().unwrap_or(none).to_owned());
    let body = filled(
        include_str!("krl_main.src"),
        &[
            ("base", Some(base(layout))),
            ("has_table", shown_if(layout.frames.root_from_table.is_some())),
            ("table", layout.frames.root_from_table.map(|table| frame(&table, FRAME_DECIMALS))),
            ("tool", Some(frame(&layout.frames.flange_from_tool, FRAME_DECIMALS))),
            ("on", statement(&layout.spindle_on, "; spindle on: stead export --spindle-on")),
            ("calls", layout.calls(|part| format!("{part} ( )"))),
            ("off", statement(&layout.spindle_off, "; spindle off: stead export --spindle-off")),
        ],
    );
    ProgramFile { name: format!("{}.src", layout.options.name), text: head(layout, layout.options.name) + &body }
}

/// A part, counted from 0.
pub(super) fn part(layout: &Layout<'_>, index: usize) -> ProgramFile {
    let name = layout.part_name(index);
    let mut lines = Lines(head(layout, &name));
    lines.line(format_args!("$BASE={}", base(layout)));
    lines.line(format_args!("$TOOL={{FRAME: {}}}", frame(&layout.frames.flange_from_tool, FRAME_DECIMALS)));
    lines.line("$ADVANCE=5");
    lines.line(format_args!("$APO.CDIS={}", number(layout.options.blend * 1e3, 4)));
    lines.line(format_args!("BAS (#VEL_PTP,{})", Layout::JOINT_SPEED_PERCENT));
    let mut feed = f64::NAN;
    let moves = layout.moves_of(index);
    for (number_in_part, step) in moves.iter().enumerate() {
        layout.heading(index, number_in_part).iter().for_each(|text| lines.line(format_args!("; {text}")));
        match step.kind {
            MoveKind::Joint => joint(&mut lines, layout, step),
            MoveKind::Linear => {
                if step.feed != feed {
                    feed = step.feed;
                    lines.line(format_args!("$VEL.CP={}", number(feed, 6)));
                }
                let is_blended = step.is_blended && number_in_part + 1 < moves.len();
                let blending = if is_blended { " C_DIS" } else { "" };
                let pose = frame(&step.workpiece_from_tool, POSE_DECIMALS);
                lines.line(format_args!("LIN {{{pose}{}}}{blending}", external(step)));
            }
        }
    }
    lines.line("END");
    ProgramFile { name: format!("{name}.src"), text: lines.0 }
}

fn joint(lines: &mut Lines, layout: &Layout<'_>, step: &Move) {
    let angles = step.angles.unwrap_or(step.joints);
    // 1 where the controller's third axis counts in the direction of the row, else -1.
    let sign_3 = layout.problem.robot.controller().map_or(1.0, |controller| controller.sign[2]);
    let [s, t] = kuka_status_and_turn(step.posture, sign_3, &angles);
    lines.line(format_args!("; start: {},S {s},T {t}", frame(&step.workpiece_from_tool, POSE_DECIMALS)));
    let axes =
        angles.iter().zip(1..).map(|(angle, axis)| format!("A{axis} {}", number(angle.to_degrees(), AXIS_DECIMALS)));
    lines.line(format_args!("PTP {{{}{}}}", axes.collect::<Vec<_>>().join(","), external(step)));
}

/// `,E1 ..` for each external axis, in mm or deg.
fn external(step: &Move) -> String {
    let entry = |(position, axis): (Option<f64>, usize)| Some(format!(",E{axis} {}", number(position?, AXIS_DECIMALS)));
    step.external.into_iter().zip(1..).filter_map(entry).collect()
}
