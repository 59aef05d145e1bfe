//! The tables `[criterion]` and `[[segment]]` of a run file: what is minimised.

use crate::input::InputError;
use crate::place::Place;
use crate::quantity::Quantity;
use crate::scalars::{Whole, Word, words};
use crate::units::{Number, ZeroToTen, ranges};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Bound::{Excluded, Included};
use stead_model::robot::Robot;
use stead_model::task::Task;
use stead_placement::criterion::{Aggregate, Criterion, Direction, Weights};

ranges! {
    /// From 0 to 1000.
    Weight: Included(0.0), Included(1000.0);
    /// Above 0 and not above 1000.
    PositiveWeight: Excluded(0.0), Included(1000.0);
}

words!(Direction: "wall" => Direction::Wall, "surface" => Direction::Surface, "axis" => Direction::Axis,
    "total" => Direction::Total);
words!(Aggregate: "mean" => Aggregate::Mean, "rms" => Aggregate::Rms, "max" => Aggregate::Max);

/// By what a placement is scored.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CriterionTable {
    /// Which part of the deflection is scored: normal to the `wall` (axis x feed; where left out), normal to the `surface` that the
    /// task states by its columns `normal_x`, `normal_y`, `normal_z`, along the tool `axis`, or the `total`.
    pub direction: Option<Word<Direction>>,
    /// In place of a direction: what each part counts, the score being the root of the weighted sum of their squares.
    pub weights: Option<WeightsTable>,
    /// How the scores of the path points make up the figure that is minimised: their `mean` (where left out), the root of the
    /// mean of their squares, `rms`, or the largest, `max`.
    pub aggregate: Option<Word<Aggregate>>,
    /// Size of an unknown error of the force, as a share of it, added in the worst direction; 0 where left out.
    pub force_uncertainty: Option<Number<ZeroToTen>>,
    /// How many standard deviations of the compliances are added to the deflection; 0 where left out. Above 0 the robot
    /// file needs a table `[covariance]`.
    pub confidence: Option<Number<ZeroToTen>>,
}

/// What the parts of a deflection count; 0 where left out.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
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
#[serde(deny_unknown_fields)]
pub struct SegmentTable {
    /// Its number in the task, from 1.
    pub number: Whole<1, 4294967295>,
    /// What each of its points counts; those of a segment that is not named count 1.
    pub weight: Number<PositiveWeight>,
}

impl CriterionTable {
    /// # Errors
    /// [`InputError`] for a direction beside weights, weights that are all zero, a surface that the task does not state, and a
    /// confidence where nothing is known of the errors of the compliances.
    pub(super) fn criterion(
        &self,
        segments: &[SegmentTable],
        robot: &Robot,
        task: &Task,
        root: &Place<'_>,
    ) -> Result<Criterion, InputError> {
        let at = root.key("criterion");
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
        let [force_uncertainty, confidence] =
            [self.force_uncertainty, self.confidence].map(|value| value.map_or(0.0, Quantity::si));
        if confidence > 0.0 && robot.uncertainty().is_none() {
            return Err(at.key("confidence").error(
                "asks for standard deviations, but the robot file has no table [covariance]",
                "0, or a robot file that says how well its compliances are known",
            ));
        }
        Ok(Criterion {
            weights,
            aggregate: self.aggregate.map_or(Aggregate::Mean, |word| word.0),
            segment_weights: segment_weights(segments, task.segments().len(), &root.key("segment"))?,
            force_uncertainty,
            confidence,
        })
    }
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
fn segment_weights(tables: &[SegmentTable], count: usize, at: &Place<'_>) -> Result<Vec<f64>, InputError> {
    if tables.is_empty() {
        return Ok(Vec::new());
    }
    let mut weights = vec![None; count];
    for (table, place) in tables.iter().zip(1..) {
        let at = at.element(place).key("number");
        let Some(weight) = weights.get_mut(table.number.count() - 1) else {
            return Err(at.error("is no segment of the task", format!("whole numbers from 1 to {count}")));
        };
        if weight.replace(table.weight.si()).is_some() {
            return Err(at.error("is there twice", "each segment once"));
        }
    }
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
        let criterion = read(&text).unwrap().problem.criterion;
        assert_eq!((criterion.weights, criterion.aggregate), (Weights::TOTAL, Aggregate::Rms));
        assert_eq!(criterion.segment_weights, [2.0]);
        let text = format!("{RUN}[criterion]\nweights = {{ wall = 1.0, axis = 0.5 }}\n");
        assert_eq!(read(&text).unwrap().problem.criterion.weights, Weights { axis: 0.5, ..Weights::WALL });
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
