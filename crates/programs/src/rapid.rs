//! Programs for ABB's controllers, in RAPID.

use super::carrier::Carrier;
use super::layout::{Layout, Lines, ProgramFile};
use super::motion::{Move, MoveKind};
use super::names::{MODULE, number};
use nalgebra::{Matrix3, Vector3};
use stead_disk::template::{filled, shown_if};
use stead_model::robot::Pose;
use stead_numerics::rotation::quaternion_from_rotation;

/// Decimals of positions in mm: a tenth of a micrometre.
const MM_DECIMALS: usize = 4;
/// Decimals of quaternions: normalised far better than the controller asks.
const QUATERNION_DECIMALS: usize = 9;
/// Decimals of joint angles in deg: all six off by half a unit move nothing 4 m away by 3e-3 mm.
const AXIS_DECIMALS: usize = 5;
/// An external axis that is not there.
const NO_AXIS: &str = "9E9";
/// Speeds of reorientation, of linear and of rotating external axes, as in the predefined speed data.
const OTHER_SPEEDS: &str = "500,5000,1000";

fn list(values: impl IntoIterator<Item = f64>, decimals: usize) -> String {
    let texts: Vec<String> = values.into_iter().map(|value| number(value, decimals)).collect();
    format!("[{}]", texts.join(","))
}

fn position(translation: &Vector3<f64>) -> String {
    list(translation.iter().map(|m| m * 1e3), MM_DECIMALS)
}

fn orientation(rotation: &Matrix3<f64>) -> String {
    list(quaternion_from_rotation(rotation), QUATERNION_DECIMALS)
}

/// The orientation after another: of the two quaternions of a rotation, the one nearer to the last.
fn orientation_after(last: &mut [f64; 4], rotation: &Matrix3<f64>) -> String {
    let quaternion = quaternion_from_rotation(rotation);
    let is_far = quaternion.iter().zip(&*last).map(|(a, b)| a * b).sum::<f64>() < 0.0;
    *last = if is_far { quaternion.map(|part| -part) } else { quaternion };
    list(*last, QUATERNION_DECIMALS)
}

/// eax_a to eax_f, in mm or deg.
fn external(step: &Move) -> String {
    let axes = step.external.map(|axis| axis.map_or_else(|| NO_AXIS.to_owned(), |at| number(at, AXIS_DECIMALS)));
    format!("[{}]", axes.join(","))
}

/// The names of the data, which all parts share: none of another program's.
fn data(layout: &Layout<'_>) -> [String; 4] {
    ["t", "w", "z", "v"].map(|kind| format!("{kind}_{}", layout.options.name))
}

fn statement(text: &str) -> String {
    format!("    {};", text.trim_end_matches(';'))
}

/// The main module, with the data and a procedure that calls the parts.
pub(super) fn main(layout: &Layout<'_>) -> ProgramFile {
    let [tool, workpiece, zone, speed] = data(layout).map(Some);
    let (name, frames) = (layout.options.name, &layout.frames);
    let load = layout.problem.spindle.carried_mass();
    let (mass, centre) = load.map_or((1.0, Vector3::z() * 0.001), |body| (body.mass, body.centre));
    let framed = |pose: &Pose<f64>| format!("[{},{}]", position(&pose.translation), orientation(&pose.rotation));
    // The controller takes the user frame from the unit, whatever stands here.
    let coupled = match (layout.carrier, frames.table_from_workpiece(), frames.root_from_table) {
        (Some(Carrier::Unit(unit)), Some(on_table), Some(table)) => Some((unit, framed(&on_table), framed(&table))),
        _ => None,
    };
    let still = coupled.is_none().then(|| framed(&frames.root_from_workpiece));
    let (unit, on_table) = coupled.clone().map(|(unit, on_table, _)| (unit.to_owned(), on_table)).unzip();
    let blend = |factor: f64| Some(number(layout.options.blend * factor, 3));
    let own = |text: &Option<String>, none: &str| Some(text.as_deref().map_or(format!("    ! {none}"), statement));
    let text = filled(
        include_str!("rapid_main.mod"),
        &[
            ("module", Some(format!("{MODULE}{name}"))),
            ("origin", layout.origin_behind("  ! ")),
            ("has_no_load", shown_if(load.is_none())),
            ("tool", tool),
            ("tool_frame", Some(framed(&frames.flange_from_tool))),
            ("mass", Some(number(mass, 3))),
            ("centre", Some(list(centre.iter().map(|m| m * 1e3), 1))),
            ("unit", unit),
            ("table", coupled.map(|(_, _, table)| table)),
            ("workpiece", workpiece),
            ("on_table", on_table),
            ("still", still),
            ("zone", zone),
            ("blend", blend(1e3)),
            ("wide", blend(1.5e3)),
            ("turn", blend(0.15e3)),
            ("speed", speed),
            ("name", Some(name.to_owned())),
            ("on", own(&layout.spindle_on, "spindle on: stead export --spindle-on")),
            ("calls", layout.calls(|part| format!("    {part};"))),
            ("off", own(&layout.spindle_off, "spindle off: stead export --spindle-off")),
        ],
    );
    ProgramFile { name: format!("{name}.mod"), text }
}

/// A part, counted from 0.
pub(super) fn part(layout: &Layout<'_>, index: usize) -> ProgramFile {
    let name = layout.part_name(index);
    let [tool, workpiece, zone, speed] = data(layout);
    let mut lines = Lines::default();
    lines.line(format_args!("MODULE {MODULE}{name}"));
    layout.origin.iter().for_each(|text| lines.line(format_args!("  ! {text}")));
    lines.line(format_args!("  PROC {name}()"));
    lines.line("    ConfL\\Off;");
    let moves = layout.moves_of(index);
    let mut last = [0.0; 4];
    for (number_in_part, step) in moves.iter().enumerate() {
        layout.heading(index, number_in_part).iter().for_each(|text| lines.line(format_args!("    ! {text}")));
        let pose = &step.workpiece_from_tool;
        let target = format!("{},{}", position(&pose.translation), orientation_after(&mut last, &pose.rotation));
        match step.kind {
            MoveKind::Joint => {
                let angles = step.angles.unwrap_or(step.joints).map(f64::to_degrees);
                lines.line(format_args!("    ! start: {target}"));
                lines.line(format_args!(
                    "    MoveAbsJ [{},{}],{speed},fine,{tool}\\WObj:={workpiece};",
                    list(angles, AXIS_DECIMALS),
                    external(step)
                ));
            }
            MoveKind::Linear => {
                let is_blended = step.is_blended && number_in_part + 1 < moves.len();
                let stop = if is_blended { zone.as_str() } else { "fine" };
                lines.line(format_args!(
                    "    MoveL [{target},[0,0,0,0],{}],[{},{OTHER_SPEEDS}],{stop},{tool}\\WObj:={workpiece};",
                    external(step),
                    number(step.feed * 1e3, 3)
                ));
            }
        }
    }
    lines.line("  ENDPROC");
    lines.line("ENDMODULE");
    ProgramFile { name: format!("{name}.mod"), text: lines.0 }
}
