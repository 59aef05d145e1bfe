//! The tables of a setup sheet.

use super::Table;
use super::words::{deg, mm, shortened};
use crate::placement::setup::word;
use crate::units::fixed;
use stead_model::external_axis::{AxisKind, Carried};
use stead_model::robot::Pose;
use stead_numerics::rotation::zyx_from_rotation;
use stead_placement::outcome::Case;
use stead_placement::setup_sheet::{Allowed, AxisSetup, RISES, SetupSheet, SheetFrame, Ways};

/// Right edges of the columns of x, y, z, A, B and C.
const POSE: [i32; 6] = [-310, -385, -460, -535, -605, -675];

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
    let at_zero = if sheet.axes.is_empty() { "" } else { ", axes at zero" };
    table.pose(&format!("Part: datum (task origin){at_zero}"), &sheet.part, "");
    if sheet.frame == SheetFrame::Root {
        let in_base = sheet.sheet_from_cell.inverse().then(&sheet.part);
        table.pose("  in the base frame, as page and terminal", &in_base, "");
    }
    if sheet.frame != SheetFrame::Root {
        let name = if sheet.is_root { "Robot: root of its controller" } else { "Robot: base frame of its rows" };
        table.pose(name, &sheet.robot, "");
    }
    table.pose("Tool centre point on the flange", &sheet.flange_from_tool, "");
    for axis in &sheet.axes {
        let carries = match axis.carries {
            Carried::Robot => "robot",
            Carried::Workpiece => "part",
        };
        let name = format!("{} \"{}\", carries the {carries}", capital(word(axis.kind)), axis.name);
        table.remark(&format!("{name}, {}; {}", stands(axis), direction(axis)));
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

impl Table<'_> {
    /// A frame with its name and what is behind it.
    fn pose(&mut self, name: &str, pose: &Pose<f64>, behind: &str) {
        let cells = pose.translation.iter().map(|of| mm(*of));
        let cells: Vec<String> = cells.chain(zyx_from_rotation(&pose.rotation).map(deg)).collect();
        let figures = POSE.into_iter().zip(cells.iter().map(String::as_str));
        self.row([(0, name)].into_iter().chain(figures).chain([(700, behind)]), false);
    }
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
    let heads = ["x", "y", "z", "A", "B", "C"];
    let status = if sheet.check_points.iter().all(|point| point.status_and_turn.is_some()) { "S, T" } else { "" };
    table.row(POSE.into_iter().zip(heads).chain([(700, status)]), true);
    for (number, point) in (1..).zip(&sheet.check_points) {
        let status = point.status_and_turn.map_or_else(String::new, |[s, t]| format!("{s}, {t}"));
        table.pose(&format!("{number}: path point {}", point.point), &point.tool, &status);
        if let Some(in_root) = &point.in_root {
            table.pose("    in the controller's root", in_root, "");
        }
        let names = if controller { "A" } else { "joint " };
        let joints = (1..).zip(point.controller.unwrap_or(point.joints));
        let joints = joints.map(|(joint, angle)| format!("{names}{joint} {}", deg(angle)));
        let axes = sheet.axes.iter().zip(&point.axes);
        let axes = axes.map(|(of, at)| format!("{} at {}", of.name, position(of.kind, *at)));
        let text = joints.chain(axes).collect::<Vec<_>>().join(", ");
        table.remark(&format!("    {text}"));
    }
    table.remark(match controller {
        true => "Joint angles as the controller counts them ([controller] of the robot file), of the best plan.",
        false => {
            "Joint angles of the robot file's rows, of the best plan: the file has no [controller], so the pendant may count \
             otherwise."
        }
    });
    match sheet.ways {
        Ways::None => {}
        Ways::NotChecked => table.remark("Collisions were not checked, on the ways between these points neither."),
        Ways::Free => table.remark(
            "In this order nothing is hit: out along the tool axis, a joint move over the next point, in along the axis.",
        ),
        Ways::Blocked => table.warn(
            "WARNING: in no order of these points does a joint move from over one to over the next keep free of the shapes: go \
             around by hand.",
        ),
    }
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
    let shapes = if sheet.has_shapes { "" } else { " COLLISIONS WERE NOT CHECKED." };
    table.remark(&format!(
        "For this program with its base measured anew: until what is minimised has grown, from {} mm, or a limit or the clearance is \
         reached, joint moves between segments included; one direction at a time along the axes of the frame, rz about its z axis in \
         the datum. External axes stay, bounds of the cell do not count. Offsets are up to a fifth too small.{subset}{shapes}",
        fixed(found.nominal * 1e3, 4)
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
        format!("Least clearance in the cut: {} mm, {a} and {b} (point {}).", mm(near.distance), near.point)
    });
    let on_moves = sheet
        .room_on_moves
        .as_ref()
        .map(|room| format!("On joint moves: {} mm, {} and {}.", mm(room.distance), room.names[0], room.names[1]));
    let unchecked = (!sheet.has_shapes).then(|| "Collisions were not checked: no shapes are in the files.".to_owned());
    table.y += 4;
    table.rule();
    let all: Vec<String> = joint.into_iter().chain(clearance).chain(on_moves).chain(unchecked).collect();
    table.remark(&all.join("  "));
}
