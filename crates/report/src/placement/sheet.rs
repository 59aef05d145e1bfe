//! The setup sheet as documents state it: what a fitter needs to set the best placement up and to check it.

use super::setup::{unit, unit_name, word};
use crate::figure::{AngleDeg, DeflectionMm, Percent, PlaceMm, each, some};
use schemars::JsonSchema;
use serde::Serialize;
use stead_model::external_axis::{AxisKind, Carried};
use stead_model::robot::Pose;
use stead_numerics::rotation::zyx_from_rotation;
use stead_placement::setup_sheet::{
    Allowed, AxisSetup, CheckPoint, NearestLimit, RISES, Room, SetupSheet, SheetFrame, Tolerance, Tolerances, Ways,
};

records! {
    /// What a fitter needs to set the best placement up and to check it. All places are in one frame.
    pub struct SheetFigures from sheet: &SetupSheet {
        let tolerances = sheet.tolerances.as_ref();
    } with {
        /// The frame of all places: `root`, that of the controller, which the pendant shows; `base`, that of the rows,
        /// where the robot file has no `[root]`; or `cell`, of a mounted robot, or one that external axes carry.
        #[schemars(with = "String")] frame: SheetFrame = sheet.frame,
        /// The part as its task file has it, all external axes at zero: its origin is the datum.
        part: PlacedFrame = (&sheet.part).into(),
        /// The same in the frame of placements, as page and terminal have it.
        part_in_base: PlacedFrame = (&sheet.sheet_from_cell.inverse().then(&sheet.part)).into(),
        /// What `robot` is: `root` or `base`.
        robot_frame: &'static str = if sheet.is_root { "root" } else { "base" },
        /// The robot's own frame, where it stands at the first point of the path.
        robot: PlacedFrame = (&sheet.robot).into(),
        /// The tool frame on the flange.
        tool_on_flange: PlacedFrame = (&sheet.flange_from_tool).into(),
        /// Diameter of the cutter, where the run states it among shapes of a cell.
        cutter_diameter_mm?: PlaceMm = some(sheet.cutter_diameter),
        /// Height of the top of the shape named `floor`, where there is one.
        floor_mm?: PlaceMm = some(sheet.floor),
        /// The external axes.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        axes: Vec<AxisSetupFigures> = sheet.axes.iter().map(Into::into).collect(),
        /// Path points far from each other, to which the tool is driven to check the setup.
        check_points: Vec<CheckFigures> = sheet.check_points.iter().map(|point| CheckFigures::of(point, sheet)).collect(),
        /// What is known of the ways from one check point to the next, out along the tool axis, by a joint move and in
        /// again: `free`, `blocked` in every order of the points, or `not-checked` without shapes; null for one point.
        #[schemars(with = "Option<String>")]
        ways: Option<Ways> = (sheet.ways != Ways::None).then_some(sheet.ways),
        /// Whether there are shapes, by which collisions were looked for.
        collisions_checked: bool = sheet.has_shapes,
        /// The least room on the joint moves between segments, at poses 0.02 rad apart.
        room_on_moves?: RoomFigures = sheet.room_on_moves.as_ref().map(Into::into),
        /// How near the plan comes to a limit of a joint.
        nearest_limit: Option<NearestLimitFigures> = sheet.nearest_limit.as_ref().map(Into::into),
        /// By how much the part may be off; null where that is not known.
        tolerances: Option<ToleranceFigures> = tolerances.ok().map(Into::into),
        /// Why it is not known.
        no_tolerances?: String = tolerances.err().cloned(),
    }

    /// A frame in another.
    pub struct PlacedFrame from pose: &Pose<f64> {
        /// Its origin.
        xyz_mm: [PlaceMm; 3] = each(pose.translation.into()),
        /// Its rotation Rz(A) Ry(B) Rx(C): A, B, C.
        abc_deg: [AngleDeg; 3] = each(zyx_from_rotation(&pose.rotation)),
    }

    /// The least room of something.
    pub struct RoomFigures from room: &Room {
        /// How far the two shapes are apart.
        distance_mm: PlaceMm = room.distance.into(),
        /// Their names.
        pair: [String; 2] = (*room.names).clone(),
    }

    /// An external axis as it is set up.
    pub struct AxisSetupFigures from axis: &AxisSetup {
        /// Its name.
        name: String = axis.name.clone(),
        /// `rail` or `turntable`.
        kind: &'static str = word(axis.kind),
        /// What it carries: the `robot` or the `workpiece`.
        carries: &'static str = match axis.carries {
            Carried::Robot => "robot",
            Carried::Workpiece => "workpiece",
        },
        /// Unit of its positions.
        unit: &'static str = unit_name(axis.kind),
        /// The least and the largest position along the plan, which are one where it stands still.
        positions: [f64; 2] = axis.positions.map(|at| unit(axis.kind).number(at)),
        /// Its direction, all axes at zero.
        direction: [f64; 3] = axis.direction.into(),
        /// A point on it there.
        point_mm: [PlaceMm; 3] = each(axis.point.into()),
    }

    /// A path point to which the tool is driven to check a setup.
    pub struct CheckFigures of (check: &CheckPoint, sheet: &SetupSheet) {
        let axes = sheet.axes.iter().zip(&check.axes);
    } with {
        /// The path point, from 0.
        point: usize = check.point,
        /// The tool centre point.
        xyz_mm: [PlaceMm; 3] = each(check.tool.translation.into()),
        /// The rotation Rz(A) Ry(B) Rx(C) of the tool frame: A, B, C.
        abc_deg: [AngleDeg; 3] = each(zyx_from_rotation(&check.tool.rotation)),
        /// Both in the root of the controller as the robot stands, where that is known and another frame.
        in_root?: PlacedFrame = check.in_root.as_ref().map(Into::into),
        /// Status and turn of a KUKA controller, S and T.
        status_and_turn?: [u8; 2] = check.status_and_turn,
        /// Joint angles of the rows.
        joints_deg: [AngleDeg; 6] = each(check.joints),
        /// Joint angles as the controller counts them; null without `[controller]`.
        controller_deg: Option<[AngleDeg; 6]> = check.controller.map(each),
        /// Positions of the external axes in their units.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        axes: Vec<f64> = axes.map(|(axis, at)| unit(axis.kind).number(*at)).collect(),
    }

    /// How near a plan comes to a limit of a joint.
    pub struct NearestLimitFigures from limit: &NearestLimit {
        /// The joint, from 1; null for the sum of joints 2 and 3.
        joint: Option<usize> = limit.joint.map(|joint| joint + 1),
        /// `lower` or `upper`.
        side: &'static str = if limit.is_upper { "upper" } else { "lower" },
        /// The path point, from 0.
        point: usize = limit.point,
        /// How far it stays from the limit of the arm.
        distance_deg: AngleDeg = limit.distance.into(),
    }

    /// By how much the part may be off, its base measured anew, before the program cannot run or its objective grows.
    pub struct ToleranceFigures from found: &Tolerances {
        let [points, all_points] = found.points;
    } with {
        /// The objective where the part is as stated, by which rises are measured.
        objective_mm: DeflectionMm = found.nominal.into(),
        /// Path points that are looked at; fewer than all for a long path.
        points: usize = points,
        /// All path points.
        all_points: usize = all_points,
        /// The rises, in per cent of the objective.
        rises: [Percent; 2] = each(RISES),
        /// How far the part may be off along the axes of the frame and turned about its z axis in the datum.
        directions: Vec<DirectionFigures> = found.directions.iter().map(Into::into).collect(),
    }

    /// How far the part may be off in a direction.
    pub struct DirectionFigures from found: &Tolerance {
        let is_turn = found.direction.is_turn();
    } with {
        /// `+x`, `-x` and so on, `+rz`, `-rz`.
        direction: String = found.direction.to_string(),
        /// `mm` or `deg`.
        unit: &'static str = if is_turn { unit_name(AxisKind::Turntable) } else { unit_name(AxisKind::Rail) },
        /// Until the objective has grown by each of the rises.
        rises: [AllowedFigures; 2] = [0, 1].map(|rise| AllowedFigures::of(&found.rises[rise], is_turn)),
        /// The nearest trial at which the program cannot run, where one was met.
        blocked_at?: Offset = found.blocked.as_ref().map(|of| Offset::of(of.offset, is_turn)),
        /// The limit that is broken there, or the two shapes that come too near.
        blocked_by?: String = found.blocked.as_ref().map(|of| of.by.clone()),
    }

    /// How far the part may be off until the objective has grown by a share.
    pub struct AllowedFigures of (allowed: &Allowed, is_turn: bool) {
        /// How far, to a fifth of it on the safe side.
        offset: Offset = Offset::of(allowed.offset, is_turn),
        /// Whether it is the farthest tried, so that the part may be off by more.
        is_more: bool = allowed.is_more,
    }
}

/// How far off, in the unit of the direction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Offset {
    /// Along an axis.
    Along(PlaceMm),
    /// About one.
    About(AngleDeg),
}

impl Offset {
    fn of(offset: f64, is_turn: bool) -> Self {
        if is_turn { Self::About(offset.into()) } else { Self::Along(offset.into()) }
    }
}
