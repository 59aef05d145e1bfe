//! The tables `[benchmark]` and `[stiffness]`: the circle, its load, and how the arm yields to it.

use super::super::reader::{Field, Table};
use crate::input::InputError;
use nalgebra::{Matrix3, Vector3};
use stead_assessment::benchmark::{Benchmark, LimitsAt, Plane, StiffnessModel, Turning};
use stead_assessment::comparison::ElbowNames;
use stead_model::cutting::ForceHistory;
use stead_model::robot::{Pose, point_from_tool};
use stead_model::task::{PathPoint, Wrench};

/// What `[stiffness]` says.
#[derive(Debug, Clone, Copy)]
pub(super) struct Yields {
    pub joints: [bool; 6],
    pub range_share: Option<f64>,
    pub model: StiffnessModel,
}

impl Default for Yields {
    fn default() -> Self {
        Self { joints: [true; 6], range_share: None, model: StiffnessModel::Unloaded }
    }
}

pub(super) fn yield_from(table: &Table<'_>) -> Result<Yields, InputError> {
    let [joints, share, loaded] = table.fields(["joints", "range_share", "loaded"])?;
    let default = Yields::default();
    let rule = "numbers of joints from 1 to 6, each at most once";
    let read = |field: &Field<'_>| {
        let mut yielding = [false; 6];
        for entry in field.list(rule)? {
            let number = entry.integer(1..=6)? as usize;
            if std::mem::replace(&mut yielding[number - 1], true) {
                return Err(entry.error("is there twice", rule));
            }
        }
        Ok(yielding)
    };
    let unit = |field: &Field<'_>| field.number_where("a number from 0 to 1", |share| (0.0..=1.0).contains(&share));
    let is_loaded = loaded.optional(Field::boolean)?.unwrap_or(false);
    Ok(Yields {
        joints: joints.optional(read)?.unwrap_or(default.joints),
        range_share: share.optional(unit)?,
        model: if is_loaded { StiffnessModel::Loaded } else { StiffnessModel::Unloaded },
    })
}

/// What the benchmark takes from the other tables.
pub(super) struct Setting<'a> {
    pub plane: Plane,
    pub flange_from_tool: Pose<f64>,
    pub yields: Yields,
    pub force_history: Option<&'a ForceHistory>,
    pub milling: &'a Field<'a>,
    pub spindle: &'a Field<'a>,
}

pub(super) fn benchmark_from(table: &Table<'_>, setting: &Setting<'_>) -> Result<(Benchmark, ElbowNames), InputError> {
    let [radius, points, force, moment, turns, traced, axis, beta, limits, names] = table.fields([
        "radius_mm",
        "points",
        "force_n",
        "moment_nm",
        "force_turns",
        "traced",
        "tool_axis",
        "beta_deg",
        "limits_at",
        "elbow_names",
    ])?;
    let normal = setting.plane.normal();
    let tool_axis = axis.optional(direction)?.unwrap_or(normal);
    let wrench = match setting.force_history {
        Some(force_history) => {
            if let Some(given) = [&force, &moment].into_iter().find(|field| field.is_given()) {
                return Err(given.error("is given beside a table [tool]", "force_n and moment_nm, or [tool] and [cut]"));
            }
            turning_wrench(&force_history.mean, &tool_axis, &normal).ok_or_else(|| {
                axis.error(
                    "does not stand on the plane of the circle",
                    "with [tool] and [cut]: the normal of the plane, or none",
                )
            })?
        }
        None => Wrench { force: load(&force)?, moment: moment.optional(load)?.unwrap_or_default() },
    };
    if libm::hypot(wrench.force.x, wrench.force.y) < LEAST_FORCE {
        let rule = "a force with a part in the plane of the circle: [radial, tangential, normal] with the first two not both 0";
        let field = if setting.force_history.is_some() { setting.milling } else { &force };
        return Err(field.error("gives no force in the plane", rule));
    }
    let turnings = [("with-tool", Turning::WithTool), ("against-tool", Turning::AgainstTool)];
    let limit_words = [("circle", LimitsAt::Circle), ("centre", LimitsAt::Centre)];
    let name_words = [("geometric", ElbowNames::Geometric), ("swapped", ElbowNames::Swapped)];
    let is_tool = traced.optional(|field| field.one_of(&[("tool", true), ("wrist-centre", false)]))?.unwrap_or(true);
    if !is_tool && setting.spindle.is_given() {
        let problem = "leaves out the spindle, but there is a table [spindle]";
        return Err(traced.error(problem, "\"tool\" with a table [spindle], or \"wrist-centre\" without"));
    }
    let beta = beta.optional(Field::number)?.unwrap_or_default().to_radians();
    let benchmark = Benchmark {
        plane: setting.plane,
        radius: radius.number_where("a number from 0.001 to 100000", |mm| (1e-3..=1e5).contains(&mm))? / 1e3,
        points: points.optional(|field| field.integer(8..=100_000))?.unwrap_or(72) as usize,
        wrench,
        turning: turns.optional(|field| field.one_of(&turnings))?.unwrap_or(Turning::WithTool),
        base_from_tool: orientation(&setting.plane, &tool_axis, beta),
        flange_from_tool: is_tool.then_some(setting.flange_from_tool),
        yielding: setting.yields.joints,
        limits_at: limits.optional(|field| field.one_of(&limit_words))?.unwrap_or(LimitsAt::Circle),
        stiffness: setting.yields.model,
    };
    let names = names.optional(|field| field.one_of(&name_words))?.unwrap_or(ElbowNames::Geometric);
    Ok((benchmark, names))
}

/// No force in the plane is smaller than this. N
const LEAST_FORCE: f64 = 1e-6;

/// A force or a moment, within what machines can do.
fn load(field: &Field<'_>) -> Result<Vector3<f64>, InputError> {
    field.numbers_where("three numbers from -1e7 to 1e7", |part| part.abs() <= 1e7).map(Vector3::from)
}

/// A direction, made exactly one long.
pub(super) fn direction(field: &Field<'_>) -> Result<Vector3<f64>, InputError> {
    let vector = field.vector3()?;
    let length = vector.norm();
    if (length - 1.0).abs() > 1e-3 {
        return Err(field.error(format!("has length {length:.4}"), "a direction of length 1, within 0.001"));
    }
    Ok(vector / length)
}

/// The mean wrench of a cut (along feed, left of the feed, tool axis), put to polar angle 0 of a circle that is gone round
/// with growing polar angle: radial, tangential, normal. `None` where the tool does not stand on the plane.
fn turning_wrench(mean: &Wrench, tool_axis: &Vector3<f64>, normal: &Vector3<f64>) -> Option<Wrench> {
    let up = tool_axis.dot(normal);
    if up.abs() < 1.0 - 1e-6 {
        return None;
    }
    let sign = up.signum();
    // The feed is tangential, and left of it is towards the centre where the tool axis is the normal.
    let turned = |v: &Vector3<f64>| Vector3::new(-sign * v.y, v.x, sign * v.z);
    Some(Wrench { force: turned(&mean.force), moment: turned(&mean.moment) })
}

/// Orientation of the tool frame for a tool axis that points from the work to the robot: at beta zero the spindle's x axis
/// lies along the first axis of the plane as far as the tool axis lets it, or along the second where the first is the tool
/// axis (Caro 2013, eq. 10, with that direction for the feed).
fn orientation(plane: &Plane, tool_axis: &Vector3<f64>, beta: f64) -> Matrix3<f64> {
    let along_x = plane.x.cross(tool_axis).norm() > 0.1;
    let point =
        PathPoint { position: Vector3::zeros(), feed: if along_x { plane.x } else { plane.y }, axis: *tool_axis };
    point.workpiece_from_point() * point_from_tool(beta)
}
