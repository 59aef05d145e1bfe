//! The tables of a run file, each into its domain object.

use super::inertial::{CENTRE, INERTIA, MASS, inertial_from};
use super::reader::{Field, Table};
use crate::input::InputError;
use stead_model::published::Published;
use stead_model::robot::{Robot, Spindle, angles::yaw_from_q4};
use stead_placement::lookup::LookupTable;
use stead_placement::problem::{Cell, Constraints, Criterion, Interval, Problem, Redundancy};
use stead_placement::settings::{PostureSearch, SearchSettings, Tables, TransferSettings};

/// Reads `[spindle]`: `xyz_mm` and `rotation`, from flange to tool, and where its motion matters `mass_kg`,
/// `centre_of_mass_mm` and `inertia_kg_m2` of all that the flange carries, in the flange frame.
pub(super) fn spindle_from(table: &Table<'_>) -> Result<Spindle, InputError> {
    let [xyz, rotation, body @ ..] = table.fields(["xyz_mm", "rotation", MASS, CENTRE, INERTIA])?;
    let mut spindle = Spindle::new(rotation.matrix3()?, xyz.vector3()? / 1e3).map_err(|problem| {
        let tolerance = Spindle::ROTATION_TOLERANCE;
        rotation.error(problem, format!("a right-handed rotation matrix [row, row, row] within {tolerance}"))
    })?;
    if body.iter().any(Field::is_given) {
        spindle.payload = Some(inertial_from(table)?);
    }
    Ok(spindle)
}

/// The same where motion is computed: what the flange carries has to be known.
///
/// # Errors
/// [`InputError`] as [`spindle_from`], and for a table without a mass.
pub(super) fn moving_spindle_from(table: &Table<'_>) -> Result<Spindle, InputError> {
    let spindle = spindle_from(table)?;
    if spindle.payload.is_none() {
        let what = "is missing: how the arm moves depends on what the flange carries";
        let allowed = format!("{MASS}, {CENTRE} and {INERTIA} of spindle, holder and tool, in the flange frame");
        return Err(table.field(MASS).error(what, allowed));
    }
    Ok(spindle)
}

pub(super) fn cell_from(table: &Table<'_>) -> Result<Cell, InputError> {
    let [x, y, z, q4] = table.fields(["x_mm", "y_mm", "z_mm", "q4"])?;
    let length = |field: &Field<'_>| field.interval().map(|ends| interval(ends.map(|end| end / 1e3)));
    let rule = "two numbers [min, max] from -1 to 1 with min not above max";
    let q4 = q4.optional(|field| field.interval_where(rule, |q4| q4.abs() <= 1.0))?.unwrap_or([-1.0, 1.0]);
    Ok(Cell { position: [length(&x)?, length(&y)?, length(&z)?], yaw: interval(q4.map(yaw_from_q4)) })
}

fn interval([min, max]: [f64; 2]) -> Interval {
    Interval { min, max }
}

pub(super) fn constraints_from(table: &Table<'_>) -> Result<Constraints, InputError> {
    let [condition, length, deflection] =
        table.fields(["min_inverse_condition", "characteristic_length_mm", "max_deflection_mm"])?;
    Ok(Constraints {
        min_inverse_condition: condition
            .number_where("a number from 0 to below 1", |value| (0.0..1.0).contains(&value))?,
        characteristic_length: length.positive()? / 1e3,
        max_deflection: deflection.optional(Field::positive)?.map(|value| value / 1e3),
    })
}

const CONFIDENCE: &str = "confidence";

/// Refuses a confidence where nothing is known of the errors of the compliances.
pub(super) fn check_confidence(table: &Table<'_>, criterion: &Criterion, robot: &Robot) -> Result<(), InputError> {
    if criterion.confidence > 0.0 && robot.uncertainty().is_none() {
        return Err(table.field(CONFIDENCE).error(
            "asks for standard deviations, but the robot file has no table [covariance]",
            "0, or a robot file that says how well its compliances are known",
        ));
    }
    Ok(())
}

pub(super) fn criterion_from(table: &Table<'_>) -> Result<Criterion, InputError> {
    let [uncertainty, confidence] = table.fields(["force_uncertainty", CONFIDENCE])?;
    let read = |field: &Field<'_>| field.number_where("a number from 0 to 10", |value| (0.0..=10.0).contains(&value));
    let [force_uncertainty, confidence] =
        [uncertainty.optional(read)?, confidence.optional(read)?].map(Option::unwrap_or_default);
    Ok(Criterion { force_uncertainty, confidence })
}

/// Bounds of the number of grid values of beta over a full turn.
const BETA_COUNT: std::ops::RangeInclusive<f64> = 4.0..=7200.0;

pub(super) fn redundancy_from(table: &Table<'_>) -> Result<Redundancy, InputError> {
    let [step, feed, rate] = table.fields(["beta_step_deg", "feed_mm_per_s", "max_beta_rate_deg_per_mm"])?;
    let step_deg = step.positive()?;
    let count = (360.0 / step_deg).round();
    if !BETA_COUNT.contains(&count) || (count * step_deg - 360.0).abs() > 360.0 * 1e-9 {
        let (most, fewest) = (BETA_COUNT.end(), BETA_COUNT.start());
        return Err(step.error(
            "does not divide a full turn into an allowed number of steps",
            format!("360 over a whole number from {fewest} to {most}, so from {} to {}", 360.0 / most, 360.0 / fewest),
        ));
    }
    Ok(Redundancy {
        beta_count: count as usize,
        feed: feed.positive()? / 1e3,
        max_beta_rate: rate.positive()?.to_radians() * 1e3,
    })
}

pub(super) fn search_from(table: &Table<'_>) -> Result<SearchSettings, InputError> {
    let [seed, population, generations, postures, basins, tables] =
        table.fields(["seed", "population", "generations", "postures", "basins", TABLES])?;
    let default = SearchSettings::default();
    let words = [("exact", PostureSearch::Exact), ("genetic", PostureSearch::Genetic)];
    let count = |field: &Field<'_>, least, most, default| {
        field.optional(|field| field.integer(least..=most)).map(|value| value.map_or(default, |value| value as usize))
    };
    Ok(SearchSettings {
        seed: seed.optional(|field| field.integer(0..=i64::MAX as u64))?.unwrap_or(default.seed),
        population: count(&population, 4, 100_000, default.population)?,
        generations: count(&generations, 0, 100_000, default.generations)?,
        postures: postures.optional(|field| field.one_of(&words))?.unwrap_or(default.postures),
        basins: count(&basins, 1, 64, default.basins)?,
        tables: tables
            .optional(|field| {
                field.one_of(&[("auto", Tables::Auto), ("always", Tables::Always), ("never", Tables::Never)])
            })?
            .unwrap_or(default.tables),
    })
}

/// The field of a run file's `[search]` that asks for a table.
const TABLES: &str = "tables";

/// Refuses to promise a table where the problem does not allow one.
pub(super) fn check_tables(table: &Table<'_>, search: &SearchSettings, problem: &Problem) -> Result<(), InputError> {
    if search.tables == Tables::Always
        && let Err(unsuited) = LookupTable::shape_for(problem)
    {
        let reason = format!("asks for a table, but there can be none: {unsuited}");
        return Err(table.field(TABLES).error(reason, "\"auto\" or \"never\""));
    }
    Ok(())
}

pub(super) fn transfer_from(table: &Table<'_>) -> Result<TransferSettings, InputError> {
    let [acceleration, jerk] = table.fields(["acceleration_time_s", "jerk_time_s"])?;
    let default = TransferSettings::default();
    Ok(TransferSettings {
        acceleration_time: acceleration.optional(Field::positive)?.unwrap_or(default.acceleration_time),
        jerk_time: jerk.optional(Field::positive)?.unwrap_or(default.jerk_time),
    })
}

pub(super) fn reference_from(table: &Table<'_>) -> Result<Published<[f64; 4]>, InputError> {
    let [source, case] = table.fields(["source", "case_mm"])?;
    let case: [f64; 4] = case.numbers_where("four numbers above 0, of cases 1 to 4", |value| value > 0.0)?;
    Ok(Published { source: source.string()?.to_owned(), figures: case })
}

#[cfg(test)]
mod tests {
    use super::super::testing::{RUN, assert_refused, read_text as read};
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn optional_tables_override_the_defaults() {
        let more = "[criterion]\nforce_uncertainty = 0.1\n[search]\nseed = 9223372036854775807\npopulation = 40\n\
                    postures = 'genetic'\ntables = 'never'\n[transfer]\njerk_time_s = 0.2\n";
        let text = format!("{RUN}{more}").replace("z_mm = [-500, -500]", "z_mm = [-500, -500]\nq4 = [0.5, 0.5]");
        let run = read(&text.replace("length_mm = 682", "length_mm = 682\nmax_deflection_mm = 1.5")).unwrap();
        assert_eq!(run.problem.criterion.force_uncertainty, 0.1);
        assert_eq!(run.problem.constraints.max_deflection, Some(1.5e-3));
        assert_eq!(run.problem.cell.position[2], Interval { min: -0.5, max: -0.5 });
        assert!((run.problem.cell.yaw.min - PI / 3.0).abs() < 1e-15 && run.problem.cell.yaw.width() == 0.0);
        assert_eq!(run.problem.redundancy.beta_count, 50);
        let default = SearchSettings::default();
        let expected = SearchSettings {
            tables: Tables::Never,
            seed: i64::MAX as u64,
            population: 40,
            postures: PostureSearch::Genetic,
            ..default
        };
        assert_eq!(run.search, expected);
        assert_eq!(run.transfer, TransferSettings { jerk_time: 0.2, ..TransferSettings::default() });
        assert!(run.reference.is_none() && run.notes.is_empty());
    }

    #[test]
    fn each_broken_rule_names_line_field_value_and_what_is_allowed() {
        let condition = "min_inverse_condition";
        for (from, to, parts) in [
            ("[cell]", "[cell]]", [":6: ", "TOML", "found '[cell]]'"]),
            ("x_mm =", "x_m =", [":7: cell.x_m: ", "nearest known one: x_mm", "found [-300, 300]"]),
            ("[cell]", "[call]", [":6: call: ", "nearest known one: cell", "found [call]"]),
            ("[-300, 300]", "[300, -300]", [":7: cell.x_mm: ", "found [300, -300]", "min not above max"]),
            ("[-300, 300]", "[nan, 300]", [":7: cell.x_mm[1]: ", "found nan", "finite"]),
            ("[-300, 300]", "'wide'", [":7: cell.x_mm: ", "not an array", "found 'wide'"]),
            ("[-500, -500]", "[-500, -500]\nq4 = [-1, 1.5]", [":10: cell.q4[2]: ", "found 1.5", "from -1 to 1"]),
            ("[-500, -500]", "[-500, -500]\nq4 = [1, -1]", [":10: cell.q4: ", "found [1, -1]", "from -1 to 1"]),
            ("[1, 0, 0]", "[1, 0, 0.1]", [":5: spindle.rotation: ", "no rotation", "found [[0, -0.7"]),
            ("[1, 0, 0]", "[-1, 0, 0]", [":5: spindle.rotation: ", "reflection", "right-handed"]),
            ("684]", "684, 0]", [":4: spindle.xyz_mm: ", "4 elements and not 3", "found [0, 0, 684, 0]"]),
            ("= 0.2", "= 1.0", [condition, "found 1.0", "from 0 to below 1"]),
            ("= 682", "= -682", [":12: constraints.characteristic_length_mm: ", "found -682", "above 0"]),
            ("= 682", "= 682\nmax_deflection_mm = 0", [":13: constraints.max_deflection_mm: ", "found 0", "above 0"]),
            ("= 7.2", "= 7", [":14: redundancy.beta_step_deg: ", "found 7;", "from 0.05 to 90"]),
            ("= 7.2", "= 120", [":14: redundancy.beta_step_deg: ", "found 120;", "from 0.05 to 90"]),
            ("= 7.2", "= 0.01", [":14: redundancy.beta_step_deg: ", "found 0.01;", "from 0.05 to 90"]),
            ("= 50", "= 0", [":15: redundancy.feed_mm_per_s: ", "found 0;", "above 0"]),
            ("feed_mm_per_s = 50\n", "", [":13: redundancy.feed_mm_per_s: ", "missing", "above 0"]),
            ("[cell]", "[criterion]\nforce_uncertainty = 11\n[cell]", [":7: criterion.force", "found 11;", "to 10"]),
            (
                "[cell]",
                "[search]\nseed = -1\n[cell]",
                [":7: search.seed: ", "found -1", "from 0 to 9223372036854775807"],
            ),
            ("[cell]", "[search]\npopulation = 3\n[cell]", [":7: search.population: ", "found 3", "from 4 to 100000"]),
            ("[cell]", "[search]\nbasins = 65\n[cell]", [":7: search.basins: ", "found 65", "from 1 to 64"]),
            ("[cell]", "[search]\npostures = 'all'\n[cell]", [":7: search.postures: ", "found 'all'", "\"genetic\""]),
            ("[cell]", "[search]\ntables = 'some'\n[cell]", [":7: search.tables: ", "found 'some'", "\"always\""]),
            ("[cell]", "[transfer]\njerk_time_s = 0\n[cell]", [":7: transfer.jerk_time_s: ", "found 0", "above 0"]),
            (
                "[cell]",
                "[reference]\nsource = 'x'\ncase_mm = [1, 2, 3, 0]\n[cell]",
                [":8: reference", "found 0", "four"],
            ),
        ] {
            assert_refused(from, to, &[&["run.toml"], &parts[..]].concat());
        }
        let cell = &RUN[RUN.find("[cell]").unwrap()..RUN.find("[constraints]").unwrap()];
        assert_refused(cell, "", &["run.toml:1: cell: ", "is missing", "a table [cell]"]);
    }

    #[test]
    fn a_table_that_cannot_be_is_refused_where_it_is_asked_for() {
        let folder = super::super::testing::folder();
        let tilted = super::super::testing::TASK.replace(",0,0,1,10,20,0\n1,10", ",0,0.6,0.8,10,20,0\n1,10");
        std::fs::write(folder.path().join("task.csv"), tilted).unwrap();
        let file = folder.path().join("run.toml");
        let read = |word: &str| {
            std::fs::write(&file, format!("{RUN}[search]\ntables = '{word}'\n")).unwrap();
            super::super::run::read_run(&file)
        };
        assert!(read("auto").is_ok() && read("never").is_ok());
        let message = read("always").unwrap_err().to_string();
        for part in ["run.toml:18: search.tables: ", "not upright", "point 0", "found 'always'", "; allowed: \"auto\""]
        {
            assert!(message.contains(part), "{part} in {message}");
        }
    }
}
