//! The frames to enter at a controller, in its convention.

use super::motion::Frames;
use super::names::number;
use stead_model::robot::{ControllerKind, Pose};
use stead_numerics::rotation::{quaternion_from_rotation, zyx_from_rotation};

/// A rotation in the convention of a controller, with the names of its numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rotation {
    /// Three angles in deg.
    Angles([&'static str; 3], [f64; 3]),
    /// A quaternion q1 to q4.
    Quaternion([f64; 4]),
}

/// A frame to enter at the controller.
#[derive(Debug, Clone, PartialEq)]
pub struct OperatorFrame {
    /// What the controller calls it.
    pub name: &'static str,
    /// What it is.
    pub what: &'static str,
    /// Origin. mm
    pub xyz_mm: [f64; 3],
    /// Orientation.
    pub rotation: Rotation,
}

impl std::fmt::Display for OperatorFrame {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [x, y, z] = self.xyz_mm.map(|mm| number(mm, 4));
        write!(f, "{:<8} X {x}  Y {y}  Z {z}", self.name)?;
        match self.rotation {
            Rotation::Angles(names, angles) => {
                names.iter().zip(angles).try_for_each(|(name, angle)| write!(f, "  {name} {}", number(angle, 6)))?;
            }
            Rotation::Quaternion(parts) => {
                parts.iter().zip(1..).try_for_each(|(part, k)| write!(f, "  q{k} {}", number(*part, 9)))?;
            }
        }
        write!(f, "   ({})", self.what)
    }
}

/// The workpiece in the robot root, or on the table that the program is coupled to; the tool on the flange; then that
/// table.
pub(super) fn operator_frames(kind: ControllerKind, frames: &Frames) -> Vec<OperatorFrame> {
    let names = match (kind, frames.root_from_table) {
        (ControllerKind::Kuka, _) => ["$BASE", "$TOOL", "flange"],
        (ControllerKind::Abb, None) => ["wobj", "tool", ""],
        (ControllerKind::Abb, Some(_)) => ["oframe", "tool", "uframe"],
        (ControllerKind::Fanuc, _) => ["UFRAME", "UTOOL", ""],
        (ControllerKind::Staubli, _) => ["frame", "tool", ""],
    };
    let workpiece = match frames.table_from_workpiece() {
        Some(on_table) => ("workpiece on the table of the mechanism, mm", on_table),
        None => ("workpiece in the robot root, mm", frames.root_from_workpiece),
    };
    let tool = ("tool centre point on the flange, mm", frames.flange_from_tool);
    let table = frames.root_from_table.map(|table| {
        ("table of the mechanism in the robot root with its axes at zero, as the program takes it: compare it with the calibration, mm", table)
    });
    let all = names.into_iter().zip([workpiece, tool].into_iter().chain(table));
    all.map(|(name, (what, pose))| OperatorFrame {
        name,
        what,
        xyz_mm: (pose.translation * 1e3).into(),
        rotation: rotation(kind, &pose),
    })
    .collect()
}

fn rotation(kind: ControllerKind, pose: &Pose<f64>) -> Rotation {
    let zyx = zyx_from_rotation(&pose.rotation).map(f64::to_degrees);
    let [z, y, x] = zyx;
    match kind {
        ControllerKind::Kuka => Rotation::Angles(["A", "B", "C"], zyx),
        ControllerKind::Fanuc => Rotation::Angles(["W", "P", "R"], [x, y, z]),
        ControllerKind::Abb => Rotation::Quaternion(quaternion_from_rotation(&pose.rotation)),
        ControllerKind::Staubli => {
            // VAL 3 turns in the other order, Rx Ry Rz: the angles of the inverse with the opposite sign.
            let [z, y, x] = zyx_from_rotation(&pose.rotation.transpose()).map(|angle| -angle.to_degrees());
            Rotation::Angles(["RX", "RY", "RZ"], [x, y, z])
        }
    }
}
