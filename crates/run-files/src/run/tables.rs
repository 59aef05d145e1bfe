//! The tables of a run file, each with the domain object that it becomes.

use super::certificate::Memory;
use super::reading::Reading;
use crate::Word;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Bound::{Excluded, Included};
use std::sync::Arc;
use stead_cell::Scene;
use stead_cell::tool_scene::{SegmentMoves, ToolScene};
use stead_disk::input::InputError;
use stead_format::orientation::Quaternion;
use stead_format::place::Place;
use stead_format::quantity::Quantity;
use stead_format::scalars::{Whole, words};
use stead_format::shapes::{Array, Interval, Matrix, Vector};
use stead_format::tool::ToolTable;
use stead_format::units::{Deg, Gb, Mm, NotNegative, Number, Positive, S, ranges};
use stead_model::published::Published;
use stead_model::robot::{Robot, Spindle, angles::yaw_from_q4, turns::Range};
use stead_model::task::ToolPath;
use stead_numerics::digits::figures;
use stead_problem::problem::{self, Cell, Constraints, Problem};
use stead_problem::settings::TransferSettings;
use stead_problem::settings::planning_memory;
use stead_problem::settings::{LookupUse, PostureSearch, SearchSettings};
use stead_problem::table_shape::Shape;

ranges! {
    /// From -1 to 1.
    PlusMinusOne: Included(-1.0), Included(1.0);
    /// From half a turn one way to half a turn the other. deg
    HalfTurns: Included(-180.0), Included(180.0);
    /// From 0 to below 1.
    BelowOne: Included(0.0), Excluded(1.0);
    /// A margin of joint angles. deg
    Margin: Included(0.0), Excluded(180.0);
    /// A blending distance. mm
    Blend: Included(0.1), Included(1000.0);
}

/// A way in which the part may lie: turned before it is placed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OrientationTable {
    /// Its name, as results and `--orientation` have it.
    pub name: String,
    /// Rotation from the workpiece frame of the task to the frame that is placed, by rows; at most one of this and the
    /// four keys below, as in the task where none is there.
    pub rotation: Option<Matrix>,
    /// The same as KUKA's A, B, C: Rz(A) Ry(B) Rx(C).
    pub abc_deg: Option<Vector<Deg>>,
    /// The same as Fanuc's W, P, R: Rz(R) Ry(P) Rx(W).
    pub wpr_deg: Option<Vector<Deg>>,
    /// The same as roll, pitch, yaw of a URDF: Rz(y) Ry(p) Rx(r).
    pub rpy_deg: Option<Vector<Deg>>,
    /// The same as ABB's quaternion.
    pub quaternion_wxyz: Option<Quaternion>,
}

/// Where the origin of the workpiece may stand, in the base frame, and how it may be turned about the vertical.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CellTable {
    /// Range `[min, max]` of the x coordinate.
    pub x_mm: Interval<Mm>,
    /// Range `[min, max]` of the y coordinate.
    pub y_mm: Interval<Mm>,
    /// Range `[min, max]` of the z coordinate.
    pub z_mm: Interval<Mm>,
    /// Range `[min, max]` of the yaw of the workpiece about the vertical axis, from -180 to 180; all yaw angles where
    /// this and `q4` are left out.
    pub yaw_deg: Option<Interval<Deg<HalfTurns>>>,
    /// The same as a range of sin(yaw / 2), the quaternion component that the papers state; at most one of the two.
    pub q4: Option<Interval<Number<PlusMinusOne>>>,
    /// The ways in which the part may lie, of which the search chooses one: the part is turned so before it is placed.
    pub orientations: Option<Vec<OrientationTable>>,
    /// The name of the orientation in which the part lies, in place of a choice among all of them.
    pub orientation: Option<String>,
}

impl CellTable {
    /// The cell that it states.
    ///
    /// # Errors
    /// [`InputError`] for a yaw that is stated twice.
    pub(super) fn cell(&self, at: &Place<'_>) -> Result<Cell, InputError> {
        let interval = |[min, max]: [f64; 2]| problem::Interval { min, max };
        let yaw = match (self.yaw_deg, self.q4) {
            (Some(_), Some(_)) => {
                return Err(at
                    .key("yaw_deg")
                    .error("states the yaw once more, beside cell.q4", "one of yaw_deg and q4"));
            }
            (Some(yaw), None) => yaw.si(),
            (None, q4) => q4.map_or([-1.0, 1.0], Interval::si).map(yaw_from_q4),
        };
        Ok(Cell { position: [self.x_mm, self.y_mm, self.z_mm].map(|ends| interval(ends.si())), yaw: interval(yaw) })
    }
}

/// What a placement has to keep to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ConstraintsTable {
    /// Smallest inverse condition number of the scaled Jacobian: how far the arm keeps from singularities.
    pub min_inverse_condition: Number<BelowOne>,
    /// Length by which the translational part of the Jacobian is scaled.
    pub characteristic_length_mm: Mm<Positive>,
    /// Largest deflection of the tool centre point at any path point; no limit where left out.
    pub max_deflection_mm: Option<Mm<Positive>>,
    /// Distance that every joint keeps from both of its limits; 0 where left out.
    pub joint_margin_deg: Option<Deg<Margin>>,
    /// Smallest distance of any path point from axis 1 of the robot, so that no workpiece stands in its column; 0 where
    /// left out.
    pub min_base_distance_mm: Option<Mm<NotNegative>>,
}

impl ConstraintsTable {
    pub(super) fn constraints(&self) -> Constraints {
        Constraints {
            min_inverse_condition: self.min_inverse_condition.si(),
            characteristic_length: self.characteristic_length_mm.si(),
            max_deflection: self.max_deflection_mm.map(Quantity::si),
            min_base_distance: self.min_base_distance_mm.map_or(0.0, Quantity::si),
            joint_margin: self.joint_margin_deg.map_or(0.0, Quantity::si),
        }
    }

    /// The robot with the margin taken off the limits of its joints.
    ///
    /// # Errors
    /// [`InputError`] for a margin that leaves nothing of a joint's range.
    pub(super) fn narrowed(&self, robot: Robot, at: &Place<'_>) -> Result<Robot, InputError> {
        let Some(margin) = self.joint_margin_deg.filter(|margin| margin.si() > 0.0) else { return Ok(robot) };
        robot.with_joint_margin(margin.si()).map_err(|e| {
            let ranges =
                robot.joints().iter().map(Range::of).chain(robot.sum_range()).map(|range| range.max - range.min);
            let half = (ranges.fold(f64::INFINITY, f64::min) / 2.0).to_degrees();
            let allowed =
                format!("less than {half} deg, half the smallest range of a joint or of the sum of joints 2 and 3");
            at.key("joint_margin_deg").error(format!("leaves no range: {e}"), allowed)
        })
    }
}

words!(PostureSearch: "exact" => PostureSearch::Exact, "genetic" => PostureSearch::Genetic);
words!(LookupUse: "auto" => LookupUse::Auto, "always" => LookupUse::Always, "never" => LookupUse::Never);

/// How hard to search.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct SearchTable {
    /// Seed of all random numbers: the same seed gives the same result.
    pub seed: Option<Whole<0, 9223372036854775807>>,
    /// Candidates in a generation.
    pub population: Option<Whole<4, 100000>>,
    /// Generations after the first.
    pub generations: Option<Whole<0, 100000>>,
    /// Whether each candidate is given the best posture of every segment, `exact`, or postures are searched for,
    /// `genetic`.
    pub postures: Option<Word<PostureSearch>>,
    /// Distinct basins of each search that are refined.
    pub basins: Option<Whole<1, 64>>,
    /// Whether candidates are scored by a precomputed lookup table: where there can be one, `always` or `never`.
    pub tables: Option<Word<LookupUse>>,
    /// Whether the worst placement is looked for, too, to show what is at stake; `true` where left out. It takes half
    /// of the time.
    pub worst: Option<bool>,
    /// Points of the path by which candidates are compared, at least one of every segment: chosen where left out, and
    /// all of them where the path is short. What can win is planned on the whole path in any case.
    pub path_points: Option<Whole<1, 1000000000>>,
    /// Memory that planning the whole path may take; 4 GB where left out, on every machine.
    pub memory_gb: Option<Gb<Memory>>,
}

impl SearchTable {
    pub(super) fn settings(&self) -> SearchSettings {
        let default = SearchSettings::default();
        SearchSettings {
            seed: self.seed.map_or(default.seed, Whole::get),
            population: self.population.map_or(default.population, Whole::count),
            generations: self.generations.map_or(default.generations, Whole::count),
            postures: self.postures.map_or(default.postures, |word| word.0),
            basins: self.basins.map_or(default.basins, Whole::count),
            tables: self.tables.map_or(default.tables, |word| word.0),
            path_points: self.path_points.map(Whole::count),
            worst: self.worst.unwrap_or(default.worst),
            sensitivity: default.sensitivity,
        }
    }

    /// Refuses a path that does not fit in the memory allowed.
    pub(super) fn check_memory(&self, problem: &Problem, at: &Place<'_>) -> Result<(), InputError> {
        let allowed = self.memory_gb.map_or(DEFAULT_MEMORY, Quantity::si);
        let needed = planning_memory(problem) as f64;
        if needed <= allowed {
            return Ok(());
        }
        // A little more than needed, so that the figure stated suffices when it is rounded.
        let [needed, allowed] = [needed * 1.006, allowed].map(|bytes| figures(bytes / 1e9));
        let points = problem.task.points().len();
        let reason =
            format!("planning the {points} points of the path takes about {needed} GB, more than {allowed} GB");
        Err(at.key("memory_gb").error(reason, format!("at least {needed}, or a path with fewer points")))
    }
}

/// Memory that planning may take where nothing is said of it. Bytes
const DEFAULT_MEMORY: f64 = 4e9;

/// Refuses a number of path points that the path does not have, or that leaves a segment without one.
pub(super) fn check_path_points(search: &SearchSettings, problem: &Problem, at: &Place<'_>) -> Result<(), InputError> {
    let (points, segments) = (problem.task.points().len(), problem.task.segments().len());
    match search.path_points {
        Some(requested) if !(segments..=points).contains(&requested) => {
            let reason = format!("the path has {points} points in {segments} segments");
            Err(at.key("path_points").error(reason, format!("a whole number from {segments} to {points}")))
        }
        _ => Ok(()),
    }
}

/// Refuses to promise a lookup table where the problem does not allow one.
pub(super) fn check_tables(search: &SearchSettings, problem: &Problem, at: &Place<'_>) -> Result<(), InputError> {
    if search.tables == LookupUse::Always
        && let Err(unsuited) = Shape::of(problem)
    {
        let reason = format!("asks for a table, but there can be none: {unsuited}");
        return Err(at.key("tables").error(reason, "\"auto\" or \"never\""));
    }
    Ok(())
}

/// Moves between segments, for joints whose row of the robot file has no acceleration or jerk; and how the cut is
/// blended.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct TransferTable {
    /// Time from rest to full speed.
    pub acceleration_time_s: Option<S<Positive>>,
    /// Time from no to full acceleration.
    pub jerk_time_s: Option<S<Positive>>,
    /// Distance along the cut over which the controller blends changes of the joint speeds.
    pub blend_mm: Option<Mm<Blend>>,
    /// How far the tool is drawn out of the cut along its axis before it moves to the next segment, where there are
    /// surroundings.
    pub retract_mm: Option<Mm<Positive>>,
}

impl TransferTable {
    pub(super) fn settings(&self) -> TransferSettings {
        let default = TransferSettings::default();
        TransferSettings {
            acceleration_time: self.acceleration_time_s.map_or(default.acceleration_time, Quantity::si),
            jerk_time: self.jerk_time_s.map_or(default.jerk_time, Quantity::si),
            blend: self.blend_mm.map_or(default.blend, Quantity::si),
        }
    }

    /// The moves between segments among the shapes of a scene, with the tool of the run.
    pub(super) fn segment_moves(
        &self,
        reading: &Reading<'_>,
        robot: &Robot,
        spindle: &Spindle,
        scene: Option<&Scene>,
        path: &ToolPath,
    ) -> Result<SegmentMoves, InputError> {
        let (tool, at) = (reading.run.tool.as_ref(), reading.at.key("tool"));
        let cutter_diameter = tool.map(|tool| tool.cutter_diameter_mm.si());
        let body = tool.map(ToolTable::body).unwrap_or_default();
        let joined = scene.map(|scene| ToolScene::new(robot, &spindle.flange_from_tool, scene, path, body)).transpose();
        let tool = joined.map_err(|error| at.error(error.to_string(), "a tool with room around it").found_if(None))?;
        let default = SegmentMoves::default();
        let retract = self.retract_mm.map_or(default.retract, Quantity::si);
        Ok(SegmentMoves { retract, tool: tool.map(Arc::new), cutter_diameter })
    }
}

/// Published figures to print beside ours.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReferenceTable {
    /// Where they were published.
    pub source: String,
    /// Mean deflection of cases 1 to 4.
    pub case_mm: Array<Mm<Positive>, 4>,
}

impl ReferenceTable {
    pub(super) fn reference(self) -> Published<[f64; 4]> {
        Published { source: self.source, figures: self.case_mm.0.map(Quantity::written) }
    }
}

#[cfg(test)]
mod tests {
    use super::{LookupUse, PostureSearch, SearchSettings, TransferSettings};
    use crate::testing::{RUN, assert_refused, read_text as read};
    use std::f64::consts::PI;
    use stead_problem::problem::Interval;

    #[test]
    fn optional_tables_override_the_defaults() {
        let more = "[criterion]\nforce_uncertainty = 0.1\n[search]\nseed = 9223372036854775807\npopulation = 40\n\
                    postures = 'genetic'\ntables = 'never'\n[transfer]\njerk_time_s = 0.2\nblend_mm = 2\n";
        let text = format!("{RUN}{more}").replace("z_mm = [-500, -500]", "z_mm = [-500, -500]\nq4 = [0.5, 0.5]");
        let run = read(&text.replace("length_mm = 682", "length_mm = 682\nmax_deflection_mm = 1.5")).unwrap();
        assert_eq!(run.problem.criterion.force_uncertainty, 0.1);
        assert_eq!(run.problem.constraints.max_deflection, Some(1.5e-3));
        assert_eq!(run.problem.cell.position[2], Interval { min: -0.5, max: -0.5 });
        assert!((run.problem.cell.yaw.min - PI / 3.0).abs() < 1e-15 && run.problem.cell.yaw.width() == 0.0);
        let in_degrees =
            read(&RUN.replace("z_mm = [-500, -500]", "z_mm = [-500, -500]\nyaw_deg = [-30, 180]")).unwrap();
        assert_eq!(in_degrees.problem.cell.yaw, Interval { min: (-30.0_f64).to_radians(), max: PI });
        assert_eq!(run.problem.redundancy.beta_count, 50);
        let default = SearchSettings::default();
        let expected = SearchSettings {
            tables: LookupUse::Never,
            seed: i64::MAX as u64,
            population: 40,
            postures: PostureSearch::Genetic,
            ..default
        };
        assert_eq!(run.search, expected);
        assert_eq!(run.transfer, TransferSettings { jerk_time: 0.2, blend: 2e-3, ..TransferSettings::default() });
        assert!(run.reference.is_none() && run.notes.len() == 1);
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
            (
                "[-500, -500]",
                "[-500, -500]\nyaw_deg = [-181, 0]",
                [":10: cell.yaw_deg[1]: ", "found -181", "from -180 to 180"],
            ),
            (
                "[-500, -500]",
                "[-500, -500]\nq4 = [0, 1]\nyaw_deg = [0, 90]",
                [":11: cell.yaw_deg: ", "beside cell.q4, found [0, 90]", "one of yaw_deg and q4"],
            ),
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
            (
                "[cell]",
                "[criterion]\nforce_uncertainty = 10\n[cell]",
                [":7: criterion.force", "found 10;", "to 1: 0.1 is 10 %"],
            ),
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
            ("[cell]", "[transfer]\nblend_mm = 0\n[cell]", [":7: transfer.blend_mm: ", "found 0", "from 0.1 to 1000"]),
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
        let folder = crate::testing::folder();
        let tilted = crate::testing::TASK.replace(",0,0,1,10,20,0\n1,10", ",0,0.6,0.8,10,20,0\n1,10");
        std::fs::write(folder.path().join("task.csv"), tilted).unwrap();
        let file = folder.path().join("run.toml");
        let read = |word: &str| {
            std::fs::write(&file, format!("{RUN}[search]\ntables = '{word}'\n")).unwrap();
            crate::read_run(&file)
        };
        assert!(read("auto").is_ok() && read("never").is_ok());
        let message = read("always").unwrap_err().to_string();
        for part in [
            "run.toml:18: search.tables: ",
            "not upright: its axis is 36.870 deg",
            "point 0",
            "found 'always'",
            "; allowed: \"auto\"",
        ] {
            assert!(message.contains(part), "{part} in {message}");
        }
    }
}
