//! The tables `[criterion]` and `[[segment]]` of a run file: what is minimised.

use super::reading::Reading;
use super::segments::by_segment;
use crate::Word;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Bound::{self, Excluded, Included};
use stead_disk::input::{InputError, InputFile, input_file};
use stead_format::place::Place;
use stead_format::quantity::{Quantity, Range};
use stead_format::robot::{checked_to_score, robot_from};
use stead_format::scalars::{Whole, words};
use stead_format::units::{MmPerRad, Number, ZeroToTen, ranges};
use stead_model::plausibility;
use stead_model::robot::{Joint, MeasuredFrom, Robot};
use stead_model::task::Task;
use stead_numerics::message::Note;
use stead_problem::criterion::{Aggregate, Criterion, Direction, Over, StiffnessSets, Weights};
use stead_removal::outcome::RemovalForces;

ranges! {
    /// From 0 to 1000.
    Weight: Included(0.0), Included(1000.0);
    /// Above 0 and not above 1000.
    PositiveWeight: Excluded(0.0), Included(1000.0);
}

/// From 0 to 1, as a share of a force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShareOfForce;

impl Range for ShareOfForce {
    const ENDS: (Bound<f64>, Bound<f64>) = (Included(0.0), Included(1.0));
    const EXAMPLE: &'static str = ": 0.1 is 10 %";
}

/// What is taken for the errors of forces from the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForceErrors {
    /// How far cells twice as large are off.
    Cells,
    /// How far the force exceeds its mean within a turn.
    Turn,
    /// The sum of the two.
    Both,
}

words!(ForceErrors: "cells" => ForceErrors::Cells, "turn" => ForceErrors::Turn, "both" => ForceErrors::Both);
words!(Direction: "wall" => Direction::Wall, "surface" => Direction::Surface, "axis" => Direction::Axis,
    "total" => Direction::Total);
words!(Over: "mean" => Over::Mean, "worst" => Over::Worst, "regret" => Over::Regret);
words!(Aggregate: "mean" => Aggregate::Mean, "rms" => Aggregate::Rms, "max" => Aggregate::Max);

/// By what a placement is scored.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct CriterionTable {
    /// Which part of the deflection is scored: normal to the `wall` (axis x feed; where left out), normal to the
    /// `surface` that the task states by its columns `normal_x`, `normal_y`, `normal_z`, along the tool `axis`, or the
    /// `total`.
    pub direction: Option<Word<Direction>>,
    /// In place of a direction: what each part counts, the score being the root of the weighted sum of their squares.
    pub weights: Option<WeightsTable>,
    /// How the scores of the path points make up the figure that is minimised: their `mean` (where left out), the root
    /// of the mean of their squares, `rms`, or the largest, `max`.
    pub aggregate: Option<Word<Aggregate>>,
    /// Size of an unknown error of the force, as a share of it, added in the worst direction; 0 where left out.
    pub force_uncertainty: Option<Number<ShareOfForce>>,
    /// In its place, beside `[stock]`: the error that the forces state of themselves, `cells`, how far the force
    /// exceeds its mean within a `turn`, or the sum of `both`.
    pub force_uncertainty_from: Option<Word<ForceErrors>>,
    /// How many standard deviations of the compliances are added to the deflection; 0 where left out. Above 0 the robot
    /// file needs a table `[covariance]`.
    pub confidence: Option<Number<ZeroToTen>>,
    /// What a radian of joint travel, the sum over all joints of what they turn, counts in every 10 mm of the cut,
    /// beside the mean of the scores; 0 where left out.
    pub joint_travel_weight_mm_per_rad: Option<MmPerRad<ZeroToTen>>,
    /// Robot files of the same geometry, relative to the folder of this file: the sets of joint stiffness that a score
    /// covers.
    pub robots: Option<Vec<String>>,
    /// With `robots`, what is scored: the `mean` over the sets, or the `worst` of them at each point; with `regret` the
    /// mean, and of the refined basins that one is taken whose mean exceeds the best mean of a set alone the least.
    pub over: Option<Word<Over>>,
}

/// What the parts of a deflection count; 0 where left out.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct WeightsTable {
    /// Normal to the wall, axis x feed.
    pub wall: Option<Number<Weight>>,
    /// Along the tool axis.
    pub axis: Option<Number<Weight>>,
    /// Along the feed, made normal to the tool axis.
    pub feed: Option<Number<Weight>>,
    /// Normal to the surface that the task states.
    pub surface: Option<Number<Weight>>,
}

/// A segment of the task that counts more or less than the others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SegmentTable {
    /// Its number in the task, from 1.
    pub number: Whole<1, 4294967295>,
    /// What each of its points counts; those of a segment that is not named count 1.
    pub weight: Number<PositiveWeight>,
}

/// Further sets of stiffness of the same arm.
#[derive(Default)]
pub(super) struct ReadSets {
    /// The robot itself with the compliances of each.
    pub robots: Vec<Robot>,
    /// The files that state them.
    pub inputs: Vec<InputFile>,
    /// What is to be said of them.
    pub notes: Vec<Note>,
}

impl CriterionTable {
    /// The size of force errors to be covered, as a share of the force, and what is to be said of it.
    ///
    /// # Errors
    /// [`InputError`]: it is stated twice, or taken from forces that do not come from a stock.
    pub(super) fn force_errors(
        &self,
        removal: Option<&RemovalForces>,
        at: &Place<'_>,
    ) -> Result<(f64, Option<String>), InputError> {
        let Some(from) = self.force_uncertainty_from.map(|word| word.0) else {
            return Ok((self.force_uncertainty.map_or(0.0, Quantity::si), None));
        };
        let at = at.key("force_uncertainty_from");
        if self.force_uncertainty.is_some() {
            return Err(at.error("is there beside criterion.force_uncertainty", "one of the two"));
        }
        let Some(forces) = removal else {
            let allowed = "a table [stock], or criterion.force_uncertainty";
            return Err(at.error("takes the errors of forces from the path, but there is no stock", allowed));
        };
        let (cells, turn) = (forces.own_error(), forces.spread_over_a_turn());
        let percent = |share: f64| format!("{:.2} %", share * 100.0);
        let (size, parts) = match from {
            ForceErrors::Cells => (cells, "how far the forces are off with cells twice as large".to_owned()),
            ForceErrors::Turn => (turn, "how far the force exceeds its mean within a turn".to_owned()),
            ForceErrors::Both => (
                cells + turn,
                format!("{} of cells twice as large and {} within a turn", percent(cells), percent(turn)),
            ),
        };
        Ok((size, Some(format!("the scores cover force errors of {}: {parts}", percent(size)))))
    }

    /// # Errors
    /// [`InputError`] for stiffness sets of another geometry or without a word on what is scored, a direction beside
    /// weights, weights that are all zero, a surface that the task does not state, joint travel weighed beside another
    /// figure than the mean, and a confidence where nothing is known of the errors of the compliances.
    pub(super) fn criterion(
        &self,
        reading: &Reading<'_>,
        robot: &Robot,
        task: &Task,
        force_uncertainty: f64,
        sets: Vec<Robot>,
    ) -> Result<Criterion, InputError> {
        let at = reading.at.key("criterion");
        let weights = match (self.direction, &self.weights) {
            (Some(_), Some(_)) => {
                return Err(at.key("weights").error("is there beside criterion.direction", "one of the two"));
            }
            (direction, None) => direction.map_or(Weights::WALL, |word| word.0.weights()),
            (None, Some(weights)) => weights.weights(&at.key("weights"))?,
        };
        if weights.surface > 0.0 && task.path().surface_normals().is_none() {
            let at = if self.weights.is_some() { at.key("weights").key("surface") } else { at.key("direction") };
            let allowed = "a task with the columns normal_x,normal_y,normal_z, or another direction";
            return Err(at.error("asks for the normal of the surface, which the task does not state", allowed));
        }
        let confidence = self.confidence.map_or(0.0, Quantity::si);
        let stiffness = match (self.over, sets.is_empty()) {
            (Some(over), false) => Some(StiffnessSets { robots: sets, over: over.0 }),
            (None, true) => None,
            (Some(_), true) => {
                return Err(at.key("over").error("is there without criterion.robots", "both or neither"));
            }
            (None, false) => {
                let allowed = "criterion.over = \"mean\", \"worst\" or \"regret\" beside them";
                return Err(at.key("robots").error("do not say what is scored over them", allowed));
            }
        };
        let known = |robot: &Robot| robot.uncertainty().is_some();
        let is_known = stiffness.as_ref().map_or(known(robot), |sets| sets.robots.iter().all(known));
        if confidence > 0.0 && !is_known {
            return Err(at.key("confidence").error(
                "asks for standard deviations, but the robot file has no table [covariance]",
                "0, or a robot file that says how well its compliances are known",
            ));
        }
        let aggregate = self.aggregate.map_or(Aggregate::Mean, |word| word.0);
        let joint_travel_weight = self.joint_travel_weight_mm_per_rad.map_or(0.0, Quantity::si);
        if joint_travel_weight > 0.0 && !aggregate.weighs_joint_travel() {
            let allowed = "0, or criterion.aggregate = \"mean\"";
            return Err(at.key("joint_travel_weight_mm_per_rad").error("is for the mean of the scores alone", allowed));
        }
        Ok(Criterion {
            weights,
            aggregate,
            joint_travel_weight,
            segment_weights: segment_weights(reading, task.segments().len())?,
            force_uncertainty,
            confidence,
            stiffness,
        })
    }

    /// Reads the robot files of the stiffness sets.
    ///
    /// # Errors
    /// [`InputError`] for a file that cannot be read, an arm of another geometry or with other joint limits, an empty
    /// list.
    pub(super) fn sets(
        &self,
        robot: &Robot,
        narrowed: impl Fn(Robot) -> Result<Robot, InputError>,
        root: &Place<'_>,
    ) -> Result<ReadSets, InputError> {
        let at = root.key("criterion").key("robots");
        let Some(names) = &self.robots else { return Ok(ReadSets::default()) };
        if names.is_empty() {
            return Err(at.error("is empty", "one robot file or more"));
        }
        let ReadSets { mut robots, mut inputs, mut notes } = ReadSets::default();
        for number in 1..=names.len() {
            let at = at.element(number);
            let file = at.named_file()?;
            let source = file.toml()?;
            let set = narrowed(robot_from(&source)?)?;
            checked_to_score(&set, &source)?;
            notes.extend(plausibility::stiffness_set(&set));
            if let Some(joint) = differs(robot, &set) {
                let problem = format!("is an arm of another geometry or other limits at joint {joint}");
                return Err(at.error(problem, "robot files with the rows and joint limits of the run's robot"));
            }
            inputs.push(input_file("stiffness", file.name, source.bytes()));
            let laws = set.joints().clone().map(|joint| joint.compliance);
            if robot.base_compliance().is_some() && set.stiffness_measured_from() == Some(MeasuredFrom::Floor) {
                let problem = "has stiffness measured from the floor: [base_compliance] would count the base twice";
                return Err(at.error(problem, "robot files with stiffness_measured_from = \"base\""));
            }
            let with = robot.with_compliances(laws).map_err(|e| at.error(e.to_string(), "another robot file"))?;
            let with = with
                .with_normal_springs(set.stated_normal_springs().copied())
                .map_err(|e| at.error(e.to_string(), "another robot file"))?
                .with_spring_model(set.spring_model())
                .with_stiffness_measured_from(set.stiffness_measured_from());
            robots.push(match set.uncertainty() {
                Some(known) => {
                    with.with_uncertainty(known.clone()).map_err(|e| at.error(e.to_string(), "another robot file"))?
                }
                None => with,
            });
        }
        let models = || robots.iter().map(Robot::spring_model);
        if let Some(unstated) = models().position(|model| model.is_none()).filter(|_| models().any(|m| m.is_some())) {
            let problem = "does not say what its stiffness stands for, beside robot files that do (stiffness_model)";
            let allowed = "stiffness_model = \"axes\", \"axial_part\" or \"full\" in each of them, or in none";
            return Err(at.element(unstated + 1).error(problem, allowed));
        }
        Ok(ReadSets { robots, inputs, notes })
    }
}

/// Rows of two arms may differ by this and be the same. m, rad
const SAME_ROW: f64 = 1e-9;

/// The first joint (from 1) whose row or limits differ.
fn differs(a: &Robot, b: &Robot) -> Option<usize> {
    let row = |joint: &Joint| [joint.alpha, joint.a, joint.d, joint.min, joint.max];
    let is_other = |(a, b): (&Joint, &Joint)| row(a).iter().zip(row(b)).any(|(a, b)| (a - b).abs() > SAME_ROW);
    let joint = a.joints().iter().zip(b.joints()).position(is_other).map(|joint| joint + 1);
    joint.or((a.axes_2_3() != b.axes_2_3()).then_some(3))
}

impl WeightsTable {
    fn weights(&self, at: &Place<'_>) -> Result<Weights, InputError> {
        let [feed, wall, axis, surface] =
            [self.feed, self.wall, self.axis, self.surface].map(|value| value.map_or(0.0, Quantity::si));
        let weights = Weights { feed, wall, axis, surface };
        if weights == Weights::NONE {
            return Err(at.error("weighs nothing", "at least one of wall, axis, feed, surface above 0"));
        }
        Ok(weights)
    }
}

/// The weight of every segment; nothing where none is named.
fn segment_weights(reading: &Reading<'_>, count: usize) -> Result<Vec<f64>, InputError> {
    let tables = reading.run.segment.as_deref().unwrap_or_default();
    if tables.is_empty() {
        return Ok(Vec::new());
    }
    let at = reading.at.key("segment");
    let weights = tables.iter().map(|table| (table.number.count(), table.weight.si()));
    let weights = by_segment(weights, count, &at, || format!("whole numbers from 1 to {count}"))?;
    Ok(weights.into_iter().map(|weight| weight.unwrap_or(1.0)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{RUN, assert_refused, read_text as read};

    #[test]
    fn left_out_the_mean_of_the_wall_is_minimised() {
        assert_eq!(read(RUN).unwrap().problem.criterion, Criterion::default());
        let text =
            format!("{RUN}[criterion]\ndirection = 'total'\naggregate = 'rms'\n[[segment]]\nnumber = 1\nweight = 2\n");
        let criterion = read(&text).unwrap().problem.criterion.clone();
        assert_eq!((criterion.weights, criterion.aggregate), (Weights::TOTAL, Aggregate::Rms));
        assert_eq!(criterion.segment_weights, [2.0]);
        let text = format!("{RUN}[criterion]\nweights = {{ wall = 1.0, axis = 0.5 }}\n");
        assert_eq!(read(&text).unwrap().problem.criterion.weights, Weights { axis: 0.5, ..Weights::WALL });
    }

    #[test]
    fn stiffness_sets_are_arms_of_one_geometry() {
        let folder = crate::testing::folder();
        let file = folder.path().join("run.toml");
        let arm = std::fs::read_to_string(folder.path().join("arm.toml")).unwrap();
        let softer = arm.replacen("stiffness_mnm_per_rad = 0.237", "stiffness_mnm_per_rad = 0.2", 1);
        assert_ne!(arm, softer);
        std::fs::write(folder.path().join("softer.toml"), softer).unwrap();
        std::fs::write(folder.path().join("longer.toml"), arm.replacen("a_mm = 1250", "a_mm = 1300", 1)).unwrap();
        let read = |table: &str| {
            std::fs::write(&file, format!("{RUN}[criterion]\n{table}\n")).unwrap();
            crate::read_run(&file)
        };
        let run = read("robots = ['arm.toml', 'softer.toml']\nover = 'worst'").unwrap();
        let sets = run.problem.criterion.stiffness.clone().unwrap();
        assert_eq!((sets.over, sets.robots.len(), run.inputs.len()), (Over::Worst, 2, 5));
        assert_eq!(sets.robots[0].joints(), run.problem.robot.joints());
        assert_eq!(sets.robots[1].joints()[0].compliance, (1e-6 / 0.2).into());
        let run = read("robots = ['arm.toml', 'softer.toml']\nover = 'regret'").unwrap();
        assert_eq!(run.problem.criterion.stiffness.clone().unwrap().over, Over::Regret);
        for (table, parts) in [
            (
                "robots = ['arm.toml', 'longer.toml']\nover = 'mean'",
                [":18: criterion.robots[2]: ", "geometry", "joint 3"],
            ),
            ("robots = ['arm.toml']", [":18: criterion.robots: ", "over", "\"worst\""]),
            ("over = 'mean'", [":18: criterion.over: ", "without criterion.robots", "both"]),
            ("robots = []\nover = 'mean'", [":18: criterion.robots: ", "is empty", "one robot file"]),
            ("robots = ['none.toml']\nover = 'mean'", [":18: criterion.robots[1]: ", "cannot be read", "none.toml"]),
        ] {
            let message = read(table).unwrap_err().to_string();
            parts.iter().for_each(|part| assert!(message.contains(part), "{part} in {message}"));
        }
    }

    #[test]
    fn criteria_that_mean_nothing_are_refused() {
        for (table, parts) in [
            ("[criterion]\ndirection = 'wall'\nweights = { wall = 1 }", [":8: criterion.weights: ", "one of the two"]),
            ("[criterion]\nweights = { wall = 0 }", [":7: criterion.weights: ", "at least one of"]),
            ("[criterion]\ndirection = 'surface'", [":7: criterion.direction: ", "normal_x,normal_y,normal_z"]),
            ("[criterion]\nweights = { surface = 1 }", [":7: criterion.weights.surface: ", "normal_x"]),
            ("[criterion]\ndirection = 'up'", [":7: criterion.direction: ", "\"wall\" or \"surface\""]),
            ("[criterion]\naggregate = 'sum'", [":7: criterion.aggregate: ", "\"rms\""]),
            ("[[segment]]\nnumber = 9\nweight = 2", [":7: segment[1].number: ", "from 1 to 1"]),
            ("[[segment]]\nnumber = 0\nweight = 2", [":7: segment[1].number: ", "found 0"]),
            ("[[segment]]\nnumber = 1\nweight = 0", [":8: segment[1].weight: ", "found 0"]),
            (
                "[[segment]]\nnumber = 1\nweight = 2\n[[segment]]\nnumber = 1\nweight = 3",
                [":10: segment[2].number: ", "twice"],
            ),
        ] {
            assert_refused("[cell]", &format!("{table}\n[cell]"), &[&["run.toml"], &parts[..]].concat());
        }
    }
}
