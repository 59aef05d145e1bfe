//! The tables `[[external_axis]]`: rails and turntables.

use super::orientations::{NAME, is_name};
use crate::Word;
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use stead_disk::input::InputError;
use stead_format::place::Place;
use stead_format::quantity::Quantity;
use stead_format::scalars::words;
use stead_format::shapes::{Interval, Vector};
use stead_format::units::{Deg, DegPerS, Mm, MmPerS, Number, Positive};
use stead_model::external_axis::{AxisKind, AxisUse, Carried, ExternalAxis};
use stead_problem::problem::Problem;

words!(AxisKind: "rail" => AxisKind::Rail, "turntable" => AxisKind::Turntable);
words!(Carried: "robot" => Carried::Robot, "workpiece" => Carried::Workpiece);
words!(AxisUse: "fixed" => AxisUse::Fixed, "indexed" => AxisUse::Indexed, "continuous" => AxisUse::Continuous);

/// A rail or a turntable. Directions and points are those in the cell with all axes at zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExternalAxisTable {
    /// Its name, as results have it.
    pub name: String,
    /// How it moves: a `rail` along its direction, a `turntable` about its axis.
    pub kind: Word<AxisKind>,
    /// What stands on it: the `robot`, or the `workpiece` with its cell.
    pub carries: Word<Carried>,
    /// Direction of a rail; its length does not matter.
    pub direction: Option<Vector<Number>>,
    /// Direction of the axis of a turntable; its length does not matter.
    pub axis: Option<Vector<Number>>,
    /// A point on the axis of a turntable.
    pub xyz_mm: Option<Vector<Mm>>,
    /// Range `[min, max]` of the positions of a rail.
    pub range_mm: Option<Interval<Mm>>,
    /// Range `[min, max]` of the positions of a turntable.
    pub range_deg: Option<Interval<Deg>>,
    /// Largest speed of a rail.
    pub speed_mm_per_s: Option<MmPerS<Positive>>,
    /// Largest speed of a turntable.
    pub speed_deg_per_s: Option<DegPerS<Positive>>,
    /// How often it moves: one position for the path (`fixed`), one for each segment (`indexed`), or along the path
    /// with the robot (`continuous`).
    #[serde(rename = "use")]
    pub axis_use: Word<AxisUse>,
}

/// Most axes of a cell.
const MOST: usize = 6;
/// Most path points along which an axis moves with the robot.
const MOST_POINTS: usize = 2000;
/// A shorter vector is no direction.
const SHORTEST: f64 = 1e-9;

impl ExternalAxisTable {
    fn axis(&self, at: &Place<'_>) -> Result<ExternalAxis, InputError> {
        if !is_name(&self.name) {
            return Err(at.key("name").error("is no name", NAME));
        }
        let kind = self.kind.0;
        // The keys of the one kind, and those of the other, which must not be there.
        let (keys, others) = match kind {
            AxisKind::Rail => {
                (["direction", "range_mm"], ["axis", "xyz_mm", "range_deg", "speed_deg_per_s"].as_slice())
            }
            AxisKind::Turntable => (["axis", "range_deg"], ["direction", "range_mm", "speed_mm_per_s"].as_slice()),
        };
        let word = if kind == AxisKind::Rail { "rail" } else { "turntable" };
        if let Some(other) = others.iter().find(|key| at.key(key).is_given()) {
            let allowed = match kind {
                AxisKind::Rail => "direction, range_mm and speed_mm_per_s for a rail",
                AxisKind::Turntable => "axis, xyz_mm, range_deg and speed_deg_per_s for a turntable",
            };
            return Err(at.key(other).error(format!("is no key of a {word}"), allowed));
        }
        let missing = |key: &str| at.key(key).missing(format!("what a {word} has"));
        let (direction, range, speed) = match kind {
            AxisKind::Rail => (self.direction, self.range_mm.map(Interval::si), self.speed_mm_per_s.map(Quantity::si)),
            AxisKind::Turntable => {
                (self.axis, self.range_deg.map(Interval::si), self.speed_deg_per_s.map(Quantity::si))
            }
        };
        let direction = direction.ok_or_else(|| missing(keys[0]))?.vector();
        if direction.norm() < SHORTEST {
            return Err(at.key(keys[0]).error("is no direction", "three numbers, not all of them 0"));
        }
        let [min, max] = range.ok_or_else(|| missing(keys[1]))?;
        let point = match (kind, self.xyz_mm) {
            (AxisKind::Rail, _) => Vector3::zeros(),
            (AxisKind::Turntable, Some(point)) => point.vector(),
            (AxisKind::Turntable, None) => return Err(missing("xyz_mm")),
        };
        Ok(ExternalAxis {
            name: self.name.clone(),
            kind,
            carries: self.carries.0,
            direction: direction.normalize(),
            point,
            min,
            max,
            max_speed: speed,
            axis_use: self.axis_use.0,
        })
    }
}

/// The axes of a run.
///
/// # Errors
/// [`InputError`] for a name that is there twice, a key of the other kind, an axis without direction or range.
pub(super) fn external_axes(tables: &[ExternalAxisTable], at: &Place<'_>) -> Result<Vec<ExternalAxis>, InputError> {
    if tables.len() > MOST {
        return Err(at.error(format!("has {} axes", tables.len()), format!("at most {MOST} external axes")));
    }
    let mut axes: Vec<ExternalAxis> = Vec::with_capacity(tables.len());
    for (table, number) in tables.iter().zip(1..) {
        let at = at.element(number);
        let axis = table.axis(&at)?;
        if axes.iter().any(|known| known.name == axis.name) {
            return Err(at.key("name").error("is there twice", "a name of its own for each axis"));
        }
        axes.push(axis);
    }
    Ok(axes)
}

/// Refuses axes that move along the path where that cannot be planned.
///
/// # Errors
/// [`InputError`] for one without a speed, a path of too many points, a turntable whose axis is not
/// vertical beside a limit on the turn of the spindle.
pub(super) fn check_axes(problem: &Problem, at: &Place<'_>) -> Result<(), InputError> {
    let mut moving = problem.external_axes.iter().zip(1..).filter(|(axis, _)| axis.axis_use == AxisUse::Continuous);
    let Some((_, first)) = moving.clone().next() else { return Ok(()) };
    let key = at.element(first).key("use");
    if let Some((axis, number)) = moving.find(|(axis, _)| axis.max_speed.is_none()) {
        let speed = if axis.kind == AxisKind::Rail { "speed_mm_per_s" } else { "speed_deg_per_s" };
        return Err(at.element(number).key(speed).missing("the speed of an axis that moves along the path"));
    }
    let count = problem.task.points().len();
    if count > MOST_POINTS {
        let problem = format!("is for a path of {count} points");
        return Err(key.error(problem, format!("fixed or indexed, or a path of at most {MOST_POINTS} points")));
    }
    let redundancy = &problem.redundancy;
    let has_turn_limit = redundancy.max_spindle_turn.is_some() || redundancy.max_spindle_speed.is_some();
    if has_turn_limit && problem.turns_part_otherwise() {
        let what = "turns the workpiece about another direction than the vertical along the path, beside a limit on \
                    the turn of the spindle \
                    in [redundancy]";
        return Err(key.error(what, "fixed or indexed, or max_beta_rate_deg_per_mm as the only limit on beta"));
    }
    Ok(())
}
