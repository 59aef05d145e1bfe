//! The tables `[benchmark]` and `[stiffness]`: the circle, its load, and how the arm yields to it.

use super::file::{BenchmarkTable, StiffnessTable, Traced};
use nalgebra::{Matrix3, Vector3};
use stead_assessment::benchmark::{Benchmark, LimitsAt, Plane, StiffnessModel, Turning};
use stead_assessment::comparison::ElbowNames;
use stead_disk::input::InputError;
use stead_format::place::{Place, required};
use stead_format::quantity::Quantity;
use stead_format::scalars::joint_set;
use stead_format::shapes::Vector;
use stead_format::units::Number;
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

pub(super) fn yields_from(table: &StiffnessTable, at: &Place<'_>) -> Result<Yields, InputError> {
    let joints = match &table.joints {
        Some(joints) => joint_set(joints, &at.key("joints"))?,
        None => [true; 6],
    };
    let is_loaded = table.loaded.unwrap_or_default();
    Ok(Yields {
        joints,
        range_share: table.range_share.map(Quantity::si),
        model: if is_loaded { StiffnessModel::Loaded } else { StiffnessModel::Unloaded },
    })
}

/// What the benchmark takes from the other tables.
pub(super) struct Setting<'a> {
    pub plane: Plane,
    pub flange_from_tool: Pose<f64>,
    pub yields: Yields,
    pub force_history: Option<&'a ForceHistory>,
}

pub(super) fn benchmark_from(
    table: &BenchmarkTable,
    root: &Place<'_>,
    setting: &Setting<'_>,
) -> Result<(Benchmark, ElbowNames), InputError> {
    let at = root.key("benchmark");
    let normal = setting.plane.normal();
    let tool_axis = match table.tool_axis {
        Some(axis) => direction(axis, &at.key("tool_axis"))?,
        None => normal,
    };
    let wrench = wrench_from(table, root, setting.force_history, &tool_axis, &normal)?;
    let is_tool = table.traced.is_none_or(|word| word.0 == Traced::Tool);
    if !is_tool && root.key("spindle").is_given() {
        let problem = "leaves out the spindle, but there is a table [spindle]";
        let allowed = "\"tool\" with a table [spindle], or \"wrist-centre\" without";
        return Err(at.key("traced").error(problem, allowed));
    }
    let beta = table.beta_deg.map_or(0.0, Quantity::si);
    let benchmark = Benchmark {
        plane: setting.plane,
        radius: table.radius_mm.si(),
        points: table.points.map_or(72, |points| points.count()),
        wrench,
        turning: table.force_turns.map_or(Turning::WithTool, |word| word.0),
        base_from_tool: orientation(&setting.plane, &tool_axis, beta),
        flange_from_tool: is_tool.then_some(setting.flange_from_tool),
        yielding: setting.yields.joints,
        limits_at: table.limits_at.map_or(LimitsAt::Circle, |word| word.0),
        stiffness: setting.yields.model,
    };
    Ok((benchmark, table.elbow_names.map_or(ElbowNames::Geometric, |word| word.0)))
}

/// The load at polar angle 0: that of `[tool]` and `[cut]`, or the given one.
fn wrench_from(
    table: &BenchmarkTable,
    root: &Place<'_>,
    force_history: Option<&ForceHistory>,
    tool_axis: &Vector3<f64>,
    normal: &Vector3<f64>,
) -> Result<Wrench, InputError> {
    let at = root.key("benchmark");
    let wrench = match force_history {
        Some(force_history) => {
            if let Some(given) = ["force_n", "moment_nm"].map(|key| at.key(key)).iter().find(|place| place.is_given()) {
                return Err(given.error("is given beside a table [tool]", "force_n and moment_nm, or [tool] and [cut]"));
            }
            turning_wrench(&force_history.mean, tool_axis, normal).ok_or_else(|| {
                let allowed = "with [tool] and [cut]: the normal of the plane, or none";
                at.key("tool_axis").error("does not stand on the plane of the circle", allowed)
            })?
        }
        None => Wrench {
            force: required!(at, table.force_n)?.vector(),
            moment: table.moment_nm.map_or_else(Vector3::zeros, |moment| moment.vector()),
        },
    };
    if libm::hypot(wrench.force.x, wrench.force.y) >= MIN_FORCE {
        return Ok(wrench);
    }
    let rule =
        "a force with a part in the plane of the circle: [radial, tangential, normal] with the first two not both 0";
    let at = if force_history.is_some() { root.key("tool") } else { at.key("force_n") };
    Err(at.error("gives no force in the plane", rule))
}

/// No force in the plane is smaller than this. N
const MIN_FORCE: f64 = 1e-6;

/// A direction, made exactly one long.
pub(super) fn direction(given: Vector<Number>, at: &Place<'_>) -> Result<Vector3<f64>, InputError> {
    let vector = given.vector();
    let length = vector.norm();
    if (length - 1.0).abs() > 1e-3 {
        return Err(at.error(format!("has length {length:.4}"), "a direction of length 1, within 0.001"));
    }
    Ok(vector / length)
}

/// The mean wrench of a cut (along feed, left of the feed, tool axis), put to polar angle 0 of a circle that is gone
/// round with growing polar angle: radial, tangential, normal. `None` where the tool does not stand on the plane.
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

/// Orientation of the tool frame for a tool axis that points from the work to the robot: at beta zero the spindle's x
/// axis lies along the first axis of the plane as far as the tool axis lets it, or along the second where the first is
/// the tool axis (Caro 2013, eq. 10, with that direction for the feed).
fn orientation(plane: &Plane, tool_axis: &Vector3<f64>, beta: f64) -> Matrix3<f64> {
    let along_x = plane.x.cross(tool_axis).norm() > 0.1;
    let point =
        PathPoint { position: Vector3::zeros(), feed: if along_x { plane.x } else { plane.y }, axis: *tool_axis };
    point.workpiece_from_point() * point_from_tool(beta)
}
