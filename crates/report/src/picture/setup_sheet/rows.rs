//! The tables of a setup sheet.

use super::{Table, deg, mm, shortened};
use crate::placement::setup::word;
use crate::units::fixed;
use stead_model::external_axis::{AxisKind, Carried};
use stead_model::robot::Pose;
use stead_numerics::rotation::zyx_from_rotation;
use stead_placement::outcome::Case;
use stead_placement::setup_sheet::{Allowed, AxisSetup, RISES, SetupSheet, SheetFrame};

/// Right edges of the columns of x, y, z, A, B and C.
const POSE: [i32; 6] = [-310, -385, -460, -535, -605, -675];
/// Most characters of what stands before and behind them.
const NAME: usize = 36;

/// A position of an axis with its unit.
fn position(kind: AxisKind, at: f64) -> String {
    match kind {
        AxisKind::Rail => format!("{} mm", mm(at)),
        AxisKind::Turntable => format!("{} deg", deg(at)),
    }
}

/// Where part, robot, tool, axes and floor stand.
pub(super) fn places(table: &mut Table<'_>, sheet: &SetupSheet) {
    table.heading("Where things stand");
    let heads = ["x", "y", "z", "A", "B", "C"];
    table.row(POSE.into_iter().zip(heads), true);
    let mut pose = |name: &str, pose: &Pose<f64>| {
        let cells = pose.translation.iter().map(|of| mm(*of));
        let cells: Vec<String> = cells.chain(zyx_from_rotation(&pose.rotation).map(deg)).collect();
        let figures = POSE.into_iter().zip(cells.iter().map(String::as_str));
        table.row([(0, name)].into_iter().chain(figures), false);
    };
    let at_zero = if sheet.axes.is_empty() { "" } else { ", axes at zero" };
    pose(&format!("Part: datum (task origin){at_zero}"), &sheet.part);
    if sheet.frame != SheetFrame::Root {
        let name = if sheet.is_root { "Robot: root of its controller" } else { "Robot: base frame of its rows" };
        pose(name, &sheet.robot);
    }
    pose("Tool centre point on the flange", &sheet.flange_from_tool);
    for axis in &sheet.axes {
        let carries = match axis.carries {
            Carried::Robot => "robot",
            Carried::Workpiece => "part",
        };
        let name =
            shortened(&format!("{} \"{}\", carries the {carries}", capital(word(axis.kind)), axis.name), NAME + 8);
        let text = format!("{}; {}", stands(axis), direction(axis));
        table.row([(0, name.as_str()), (235, text.as_str())], false);
    }
    let floor = match sheet.floor {
        Some(height) => format!("Floor: top of the shape \"floor\" at z {} mm.", mm(height)),
        None => "Floor: no level shape named \"floor\" is in the files; heights are from the origin of the frame."
            .to_owned(),
    };
    let cutter = sheet.cutter_diameter.map_or_else(
        || "Cutter: the run states no diameter.".to_owned(),
        |diameter| format!("Cutter: diameter {} mm.", mm(diameter)),
    );
    table.remark(&format!("{floor} {cutter}"));
    table.remark("Rotations are Rz(A) Ry(B) Rx(C), as KUKA states them; as Fanuc states them W = C, P = B, R = A.");
}

/// Where an axis stands.
fn stands(axis: &AxisSetup) -> String {
    let [least, most] = axis.positions;
    if least == most {
        return format!("stands at {}", position(axis.kind, least));
    }
    format!("moves along the path, {} to {}", position(axis.kind, least), position(axis.kind, most))
}

/// Where an axis is.
fn direction(axis: &AxisSetup) -> String {
    let part = |part: &f64| fixed(*part, if part.fract() == 0.0 { 0 } else { 3 });
    let along = axis.direction.iter().map(part).collect::<Vec<_>>().join(", ");
    match axis.kind {
        AxisKind::Rail => format!("along ({along})"),
        AxisKind::Turntable => {
            let through = axis.point.iter().map(|of| mm(*of)).collect::<Vec<_>>().join(", ");
            format!("about ({along}) through ({through})")
        }
    }
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The points to drive to.
pub(super) fn checks(table: &mut Table<'_>, sheet: &SetupSheet) {
    let controller = sheet.check_points.iter().all(|point| point.controller.is_some());
    table.heading("Check points: drive the tool centre point there, with this tool on the flange");
    const PLACE: [i32; 3] = [-170, -235, -300];
    const JOINTS: [i32; 6] = [-375, -445, -515, -585, -655, -725];
    let heads = PLACE.into_iter().zip(["x", "y", "z"]).chain(JOINTS.into_iter().zip(match controller {
        true => ["A1", "A2", "A3", "A4", "A5", "A6"],
        false => ["joint 1", "joint 2", "joint 3", "joint 4", "joint 5", "joint 6"],
    }));
    table.row(heads, true);
    for (number, point) in (1..).zip(&sheet.check_points) {
        let name = format!("{number}: path point {}", point.point);
        let place = point.place.map(mm);
        let joints = point.controller.unwrap_or(point.joints).map(deg);
        let cells = PLACE.into_iter().zip(place.iter().map(String::as_str));
        let cells = cells.chain(JOINTS.into_iter().zip(joints.iter().map(String::as_str)));
        table.row([(0, name.as_str())].into_iter().chain(cells), false);
        let axes = sheet.axes.iter().zip(&point.axes);
        let mut more: Vec<String> = axes.map(|(of, at)| format!("{} at {}", of.name, position(of.kind, *at))).collect();
        more.extend(point.in_root.map(|place| {
            format!("in the controller's root {}", place.iter().map(|of| mm(*of)).collect::<Vec<_>>().join(", "))
        }));
        if !more.is_empty() {
            let text = more.join("; ");
            table.row([(62, text.as_str())], false);
        }
    }
    table.remark(match controller {
        true => "Joint angles as the controller counts them ([controller] of the robot file), of the best plan.",
        false => {
            "Joint angles of the robot file's rows, of the best plan: the file has no [controller], so the pendant may count otherwise."
        }
    });
}

/// By how much the part may be off.
pub(super) fn tolerances(table: &mut Table<'_>, sheet: &SetupSheet) {
    table.heading("How exactly: the part may be off its place by");
    let found = match &sheet.tolerances {
        Ok(found) => found,
        Err(why) => return table.remark(&format!("not known: {why}.")),
    };
    const COLUMNS: [i32; 4] = [0, -215, -365, 395];
    let rises = RISES.map(|rise| format!("until +{} %", fixed(rise * 100.0, 0)));
    table.row(COLUMNS.into_iter().zip(["direction", &rises[0], &rises[1], "limit or shape met on the way"]), true);
    for of in &found.directions {
        let text = |offset: f64| {
            if of.direction.is_turn() { format!("{} deg", deg(offset)) } else { format!("{} mm", mm(offset)) }
        };
        let allowed = |of: &Allowed| format!("{}{}", if of.is_more { "more than " } else { "" }, text(of.offset));
        let blocked = of.blocked.as_ref().map_or_else(
            || "none".to_owned(),
            |blocked| format!("at {}: {}", text(blocked.offset), shortened(&blocked.by, 48)),
        );
        let direction = of.direction.to_string();
        let [small, large] = [allowed(&of.rises[0]), allowed(&of.rises[1])];
        table.row(COLUMNS.into_iter().zip([direction.as_str(), &small, &large, &blocked]), false);
    }
    let [points, all] = found.points;
    let subset = if points < all { format!(" By {points} of {all} path points.") } else { String::new() };
    table.remark(&format!(
        "Growth of what is minimised, from {} mm, with the plan made anew in its postures for the part where it is; one direction \
         at a time, along the axes",
        fixed(found.nominal * 1e3, 4)
    ));
    table.remark(&format!(
        "of the frame, rz about its z axis in the datum; external axes stay, and bounds of the cell do not count. Offsets are up to \
         a fifth too small, never too large.{subset}"
    ));
}

/// What the plan comes near to.
pub(super) fn limits(table: &mut Table<'_>, case: &Case, sheet: &SetupSheet) {
    let joint = sheet.nearest_limit.map(|near| {
        let side = if near.is_upper { "upper" } else { "lower" };
        format!(
            "Nearest joint limit: {} stays {} deg from its {side} limit (point {}).",
            near.joint.map_or_else(|| "the sum of 2 and 3".to_owned(), |joint| format!("joint {}", joint + 1)),
            deg(near.distance),
            near.point
        )
    });
    let clearance = case.plan.clearance.as_ref().map(|near| {
        let [a, b] = &*near.names;
        format!("Least clearance: {} mm, {a} and {b} (point {}).", mm(near.distance), near.point)
    });
    table.y += 4;
    table.rule();
    let all: Vec<String> = joint.into_iter().chain(clearance).collect();
    table.remark(&all.join("  "));
}
