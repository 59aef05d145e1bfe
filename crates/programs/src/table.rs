//! Programs as a table for other posts: one row for each move.

use super::layout::{Lines, ProgramFile};
use super::motion::{Heading, Move, MoveKind};
use super::names::number;
use stead_numerics::rotation::{quaternion_from_rotation, zyx_from_rotation};

/// The columns: poses of the tool in the workpiece frame, as `Rz(A) Ry(B) Rx(C)` and as a quaternion; angles of the
/// controller, empty where it is not known how it counts; `point` is empty where the tool is retracted. Behind them
/// `e1_mm` or `e1_deg` and so on, where there are external axes, `hits` where shapes stand around: the pair that a move
/// is known to hit, and `unfollowed` where the arm cannot follow a line: why.
pub(super) const COLUMNS: &str = "\
    segment,point,move,x_mm,y_mm,z_mm,a_deg,b_deg,c_deg,q_w,q_x,q_y,q_z,a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg,feed_mm_per_s";

const MM_DECIMALS: usize = 4;
const DEG_DECIMALS: usize = 5;
const QUATERNION_DECIMALS: usize = 9;

/// The one file.
pub(super) fn files(name: &str, moves: &[Move], units: [&str; 6], has_scene: bool) -> Vec<ProgramFile> {
    let mut lines = Lines::default();
    let external = moves.first().map_or([None; 6], |step| step.external);
    let there = external.iter().zip(units).zip(1..).filter(|((axis, _), _)| axis.is_some());
    let names: String = there.map(|((_, unit), axis)| format!(",e{axis}_{unit}")).collect();
    let hits = if has_scene { ",hits" } else { "" };
    let has_unfollowed = moves.iter().any(|step| matches!(step.heading, Some(Heading::Unfollowed(_))));
    let unfollowed = if has_unfollowed { ",unfollowed" } else { "" };
    lines.line(format_args!("{COLUMNS}{names}{hits}{unfollowed}"));
    moves.iter().for_each(|step| lines.line(row(step, has_scene, has_unfollowed)));
    vec![ProgramFile { name: format!("{name}.csv"), text: lines.0 }]
}

fn row(step: &Move, has_scene: bool, has_unfollowed: bool) -> String {
    let pose = &step.workpiece_from_tool;
    let kind = match step.kind {
        MoveKind::Joint => "joint",
        MoveKind::Linear => "linear",
    };
    let point = step.point.map_or_else(String::new, |point| point.to_string());
    let mut cells = vec![step.segment.to_string(), point, kind.to_owned()];
    cells.extend(pose.translation.iter().map(|m| number(m * 1e3, MM_DECIMALS)));
    cells.extend(zyx_from_rotation(&pose.rotation).map(|angle| number(angle.to_degrees(), DEG_DECIMALS)));
    cells.extend(quaternion_from_rotation(&pose.rotation).map(|part| number(part, QUATERNION_DECIMALS)));
    match step.angles {
        Some(angles) => cells.extend(angles.map(|angle| number(angle.to_degrees(), DEG_DECIMALS))),
        None => cells.extend(std::iter::repeat_n(String::new(), 6)),
    }
    // A joint move has no speed of the tool.
    cells.push(if step.kind == MoveKind::Linear { number(step.feed * 1e3, 4) } else { String::new() });
    cells.extend(step.external.into_iter().flatten().map(|position| number(position, DEG_DECIMALS)));
    cells.extend(has_scene.then(|| match &step.heading {
        // Names of shapes have no quotes in them.
        Some(Heading::Hits(names)) => format!("\"{} and {}\"", names[0], names[1]),
        _ => String::new(),
    }));
    cells.extend(has_unfollowed.then(|| match &step.heading {
        Some(Heading::Unfollowed(why)) => format!("\"{why}\""),
        _ => String::new(),
    }));
    cells.join(",")
}
