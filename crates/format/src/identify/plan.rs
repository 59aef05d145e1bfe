//! The table `[plan]` of an identification file.

use super::Shared;
use crate::input::{InputError, InputFile};
use crate::reader::{Field, Table};
use crate::source::Source;
use nalgebra::Vector3;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use stead_calibration::identification::design::{LoadDirections, Request, TestCases, Volume};
use stead_calibration::identification::law::Law;
use stead_calibration::identification::sheet::LoadCase;
use stead_model::robot::Robot;

/// What `stead identify plan` reads.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanRun {
    /// What is to be planned.
    pub request: Request,
    /// The config, to name it in messages.
    pub file: PathBuf,
    /// Line of the number of configurations, from 1.
    pub configurations_line: usize,
    /// Line of the table, from 1.
    pub table_line: usize,
    /// The files that were read: config, robot.
    pub inputs: Vec<InputFile>,
    /// What the user should know about the input though it is not wrong, in sentences.
    pub notes: Vec<String>,
}

/// Candidates where the file does not say.
const CANDIDATES: usize = 2000;
/// Test poses where the file gives none and does not say how many to draw.
const TESTS: usize = 200;
/// Starts of the search where the file does not say.
const STARTS: usize = 8;
/// Random sets where the file does not say.
const RANDOM_SETS: usize = 1000;
/// Per cent of a compliance above which its standard deviation is large, where the file does not say; as in the report of fit.
const HARDLY_PERCENT: f64 = 20.0;
/// Largest deflection where the file does not say. mm
const MOST_MM: f64 = 10.0;
/// Levels where the file does not say.
const LEVELS: usize = 5;

/// Reads an identification file for a plan: what [`read_identification`](super::read_identification) reads but the sheet, which
/// is not there yet, with `noise_mm`, and the table `[plan]`.
///
/// Keys of `[plan]`: `configurations`, `load_n` and `reference_points_mm` (flange frame); optionally `load_directions` (`"any"`,
/// `"horizontal"`, `"vertical"` or a list of directions in the base frame), `levels_deg` (angles of the joint beside the
/// compensator, or of joint 2), `limits_deg` (narrower joint limits), `max_deflection_mm`, `tip_mm` (flange frame), `tests` or
/// `[[plan.test]]` (`joints_deg`, `force_n`, `moment_nm`), `candidates`, `seed`, `starts`, `random_sets`, `hardly_seen_percent`
/// and `[plan.volume]` (`x_mm`, `y_mm`, `z_mm`, `min_radius_mm`). The shipped file explains each. `seed` given here takes the
/// place of the file's.
///
/// # Errors
/// [`InputError`] with file, line and field: a file that cannot be read or parsed, a missing or unknown key, a value of the
/// wrong kind or out of range.
pub fn read_plan(file: &Path, seed: Option<u64>) -> Result<PlanRun, InputError> {
    let source = Source::read(file)?;
    let document = source.parse()?;
    let shared = Shared::new(&document)?;
    let table = shared.plan.table()?;
    let [
        configurations,
        load,
        directions,
        points,
        levels,
        limits,
        deflection,
        tip,
        tests,
        test,
        candidates,
        file_seed,
        starts,
        random_sets,
        hardly,
        volume,
    ] = table.fields([
        "configurations",
        "load_n",
        "load_directions",
        "reference_points_mm",
        "levels_deg",
        "limits_deg",
        "max_deflection_mm",
        "tip_mm",
        "tests",
        "test",
        "candidates",
        "seed",
        "starts",
        "random_sets",
        "hardly_seen_percent",
        "volume",
    ])?;
    let count = |field: &Field<'_>, default: usize, least: u64| {
        let asked = field.optional(|field| field.integer(least..=100_000))?;
        Ok::<usize, InputError>(asked.map_or(default, |asked| asked as usize))
    };
    let size = configurations.integer(1..=1000)? as usize;
    let candidate_count = count(&candidates, CANDIDATES.max(size), 2)?;
    if candidate_count < size {
        let allowed = format!("at least as many as configurations = {size}");
        return Err(candidates.error("is less than there are to choose", allowed));
    }
    if tests.is_given() && test.is_given() {
        return Err(tests.error("is the number of tests to draw, but there are tests [[plan.test]]", "one of the two"));
    }
    let robot = &shared.robot;
    let limits = limits_from(&limits, robot)?;
    let level_joint = shared.varying.map_or(1, |(joint, _)| joint);
    let needed = shared.varying.map_or(0, |(_, law)| if matches!(law, Law::Spring(_)) { 3 } else { 1 });
    let spread =
        Spread { joint: level_joint, needed, limits: limits[level_joint], tolerance: shared.fit.angle_tolerance };
    let request = Request {
        load_point: shared.load_point,
        points: points.list(POINTS)?.iter().map(|point| Ok(point.vector3()? / 1e3)).collect::<Result<_, _>>()?,
        noise: shared.noise.positive()? / 1e3,
        varying: shared.varying,
        hold: shared.fit.hold,
        angle_tolerance: shared.fit.angle_tolerance,
        level_joint,
        levels: spread.levels_from(&levels)?,
        limits,
        loads: directions.optional(loads_from)?.unwrap_or(LoadDirections::Any),
        load: load.positive()?,
        volume: volume.optional(|field| volume_from(&field.table()?))?.unwrap_or(Volume::OPEN),
        max_deflection: deflection.optional(Field::positive)?.unwrap_or(MOST_MM) / 1e3,
        tip: tip.optional(Field::vector3)?.map_or(shared.load_point, |tip| tip / 1e3),
        tests: if test.is_given() {
            TestCases::Given(test.tables()?.iter().map(|table| test_from(table, robot)).collect::<Result<_, _>>()?)
        } else {
            TestCases::Drawn(count(&tests, TESTS, 1)?)
        },
        configurations: size,
        candidates: candidate_count,
        seed: seed.map_or_else(|| Ok(file_seed.optional(|f| f.integer(0..=i64::MAX as u64))?.unwrap_or(1)), Ok)?,
        starts: count(&starts, STARTS, 2)?,
        random_sets: count(&random_sets, RANDOM_SETS, 1)?,
        max_relative_deviation: hardly.optional(Field::positive)?.unwrap_or(HARDLY_PERCENT) / 100.0,
        robot: shared.robot,
    };
    Ok(PlanRun {
        request,
        file: file.to_owned(),
        configurations_line: configurations.line(),
        table_line: shared.plan.line(),
        inputs: vec![source.as_config(), shared.robot_input],
        notes: shared.note.into_iter().collect(),
    })
}

const POINTS: &str = "one or more places [x, y, z] in the flange frame";

/// Limits of the measurements: those of the robot, to half a turn to either side, or narrower ones.
fn limits_from(field: &Field<'_>, robot: &Robot) -> Result<[[f64; 2]; 6], InputError> {
    let own: [[f64; 2]; 6] = std::array::from_fn(|j| [robot.joints()[j].min, robot.joints()[j].max]);
    let Some(rows) = field.optional(|field| field.list(LIMITS))? else {
        return Ok(own.map(|[min, max]| {
            let (low, high) = (min.max(-PI), max.min(PI));
            if low < high { [low, high] } else { [min, max] }
        }));
    };
    let Ok(rows) = <[Field<'_>; 6]>::try_from(rows) else {
        return Err(field.error("has not one entry for each joint", LIMITS));
    };
    let mut limits = own;
    for ((row, limits), [min, max]) in rows.iter().zip(&mut limits).zip(own) {
        let ends = row.interval()?.map(f64::to_radians);
        if ends[0] < min - 1e-9 || ends[1] > max + 1e-9 {
            let allowed =
                format!("two angles from {:.4} to {:.4}, the limits of the joint", min.to_degrees(), max.to_degrees());
            return Err(row.error("is outside the limits of the joint", allowed));
        }
        *limits = ends;
    }
    Ok(limits)
}

const LIMITS: &str = "six pairs [min, max] in degrees";

/// How the angles of the joint with few of them are to lie.
struct Spread {
    joint: usize,
    needed: usize,
    limits: [f64; 2],
    tolerance: f64,
}

impl Spread {
    fn levels_from(&self, field: &Field<'_>) -> Result<Vec<f64>, InputError> {
        let [min, max] = self.limits;
        if !field.is_given() {
            // Whole degrees, a twentieth of the range away from its ends.
            let level = |k: usize| {
                let part = 0.05 + 0.9 * k as f64 / (LEVELS - 1) as f64;
                (min + (max - min) * part).to_degrees().round().to_radians().clamp(min, max)
            };
            return Ok(if self.needed > 0 { (0..LEVELS).map(level).collect() } else { vec![] });
        }
        let rule = format!(
            "angles of joint {} in ascending order from {:.4} to {:.4}",
            self.joint + 1,
            min.to_degrees(),
            max.to_degrees()
        );
        let levels: Vec<f64> = field.numbers(&rule, |_| true)?.into_iter().map(f64::to_radians).collect();
        if levels.iter().any(|level| !(min - 1e-9..=max + 1e-9).contains(level)) {
            return Err(field.error("is not within the limits of the joint", rule));
        }
        if levels.windows(2).any(|pair| pair[1] - pair[0] <= self.tolerance.max(1e-9)) {
            let problem = "has angles that are not in ascending order, or no further apart than angle_tolerance_deg";
            return Err(field.error(problem, rule));
        }
        if levels.len() < self.needed {
            let problem = format!("has {} angles, from which a compensator cannot be told", levels.len());
            return Err(field.error(problem, format!("three or more {rule}")));
        }
        Ok(levels)
    }
}

fn loads_from(field: &Field<'_>) -> Result<LoadDirections, InputError> {
    if !field.is_array() {
        let words = [("any", 0), ("horizontal", 1), ("vertical", 2)];
        return Ok([LoadDirections::Any, LoadDirections::Horizontal, LoadDirections::Vertical]
            [field.one_of(&words)?]
        .clone());
    }
    let rule = "directions [x, y, z] in the base frame, not zero; or \"any\", \"horizontal\", \"vertical\"";
    let direction = |entry: &Field<'_>| {
        let vector = entry.vector3()?;
        if vector.norm() < 1e-9 {
            Err(entry.error("is no direction: its length is zero", rule))
        } else {
            Ok(vector.normalize())
        }
    };
    Ok(LoadDirections::Listed(field.list(rule)?.iter().map(direction).collect::<Result<_, _>>()?))
}

fn volume_from(table: &Table<'_>) -> Result<Volume, InputError> {
    let [x, y, z, radius] = table.fields(["x_mm", "y_mm", "z_mm", "min_radius_mm"])?;
    let mut volume = Volume::OPEN;
    for (ends, field) in volume.ranges.iter_mut().zip([x, y, z]) {
        if let Some(given) = field.optional(Field::interval)? {
            *ends = given.map(|end| end / 1e3);
        }
    }
    let rule = "a finite number not below 0";
    let radius = radius.optional(|field| field.number_where(rule, |radius| radius >= 0.0))?;
    Ok(Volume { min_radius: radius.unwrap_or_default() / 1e3, ..volume })
}

fn test_from(table: &Table<'_>, robot: &Robot) -> Result<LoadCase, InputError> {
    let [joints, force, moment] = table.fields(["joints_deg", "force_n", "moment_nm"])?;
    let theta: [f64; 6] = joints.numbers_where("six joint angles in degrees", |_| true)?.map(f64::to_radians);
    for (index, joint) in robot.joints().iter().enumerate() {
        if !(joint.min - 1e-9..=joint.max + 1e-9).contains(&theta[index]) {
            let (min, max) = (joint.min.to_degrees(), joint.max.to_degrees());
            let problem = format!("puts joint {} outside its limits", index + 1);
            return Err(joints.error(problem, format!("{min:.4} to {max:.4} for joint {}", index + 1)));
        }
    }
    let (force_given, moment) = (force.vector3()?, moment.optional(Field::vector3)?.unwrap_or_else(Vector3::zeros));
    if force_given.norm() == 0.0 && moment.norm() == 0.0 {
        return Err(force.error("is a load of zero", "a force, or a moment_nm, that is not zero"));
    }
    Ok(LoadCase { theta, force: force_given, moment })
}
