//! The table `[postures]`: which postures segments may be driven in, and how moves between them count.

use crate::Word;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Bound::Included;
use stead_disk::input::InputError;
use stead_format::place::Place;
use stead_format::quantity::Quantity;
use stead_format::scalars::{Whole, words};
use stead_format::units::{MmPerS, NotNegative, Percent, ranges};
use stead_model::robot::Posture;
use stead_placement::settings::{PostureSearch, SearchSettings};
use stead_planning::criterion::Aggregate;
use stead_planning::postures::PostureRules;
use stead_planning::problem::Problem;

ranges! {
    /// From 0 to 20.
    UpToTwenty: Included(0.0), Included(20.0);
}

/// Whether the posture may change between segments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Changes {
    /// From any segment to the next.
    Free,
    /// Never: one posture for the whole path.
    Never,
}

words!(Changes: "free" => Changes::Free, "never" => Changes::Never);

/// Which postures the segments of the path may be driven in, and how the moves between them count.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PosturesTable {
    /// Numbers of the allowed postures; all eight where left out.
    pub allowed: Option<Vec<Whole<1, 8>>>,
    /// Whether the posture may change from segment to segment, `free`, or not, `never`; `free` where left out.
    pub changes: Option<Word<Changes>>,
    /// What each second of the moves between segments, of their slowest joint at full speed, counts beside the mean
    /// deflection in the choice of postures and turns; 0 where left out.
    pub move_weight_mm_per_s: Option<MmPerS<NotNegative>>,
    /// How much worse than its best plan the plan of a segment may be to make the moves between segments shorter; 0.1
    /// where left out.
    pub tie_percent: Option<Percent<UpToTwenty>>,
}

impl PosturesTable {
    pub(super) fn rules(&self, at: &Place<'_>) -> Result<PostureRules, InputError> {
        let mut rules = PostureRules {
            may_change: self.changes.is_none_or(|word| word.0 == Changes::Free),
            move_weight: self.move_weight_mm_per_s.map_or(0.0, Quantity::si),
            tie: self.tie_percent.map_or(PostureRules::default().tie, Quantity::si),
            ..PostureRules::NONE
        };
        let Some(numbers) = &self.allowed else { return Ok(rules) };
        let at = at.key("allowed");
        if numbers.is_empty() {
            return Err(at.error("allows no posture", "at least one number from 1 to 8"));
        }
        rules.allowed = [false; 8];
        for (number, place) in numbers.iter().zip(1..) {
            let allowed = &mut rules.allowed[number.count() - 1];
            if std::mem::replace(allowed, true) {
                return Err(at.element(place).error("is there twice", "each posture once"));
            }
        }
        Ok(rules)
    }
}

/// Refuses postures that no joint angles inside the limits are in, weights of moves that have no time or no mean to be
/// held against, and one posture for all segments beside a search for one of each.
pub(super) fn check_postures(
    table: &PosturesTable,
    problem: &Problem,
    search: &SearchSettings,
    at: &Place<'_>,
) -> Result<(), InputError> {
    if !problem.postures.may_change && search.postures == PostureSearch::Genetic {
        let why = "is not for search.postures = \"genetic\", which searches for a posture of each segment";
        return Err(at.key("changes").error(why, "\"free\", or search.postures = \"exact\""));
    }
    for (number, place) in table.allowed.iter().flatten().zip(1..) {
        let posture = u8::try_from(number.count()).ok().and_then(Posture::from_number);
        if posture.is_some_and(|posture| !problem.robot.has_posture(posture)) {
            let possible = Posture::ALL.into_iter().filter(|posture| problem.robot.has_posture(*posture));
            let possible: Vec<String> = possible.map(|posture| posture.to_string()).collect();
            let why = format!("no segment can take posture {}: the limits of the joints leave it out", number.count());
            return Err(at.key("allowed").element(place).error(why, possible.join(", ")));
        }
    }
    if problem.postures.move_weight > 0.0 {
        let at = at.key("move_weight_mm_per_s");
        if problem.criterion.aggregate != Aggregate::Mean {
            return Err(at.error("is held against a mean", "0, or criterion.aggregate = \"mean\""));
        }
        if problem.robot.joints().iter().any(|joint| joint.max_speed.is_none()) {
            let why = "the robot file does not give the max_speed_deg_per_s of every joint";
            return Err(at.error(why, "0, or a robot file with the speed of every joint"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::testing::{RUN, assert_refused, read_text as read};
    use stead_planning::postures::PostureRules;

    fn with(table: &str) -> String {
        format!("[postures]\n{table}\n[cell]")
    }

    #[test]
    fn a_table_is_read_and_an_empty_one_is_none() {
        assert_eq!(read(RUN).unwrap().problem.postures, PostureRules::default());
        let rules = |table: &str| read(&RUN.replace("[cell]", &with(table))).unwrap().problem.postures;
        assert_eq!(rules(""), PostureRules { tie: 0.1 / 100.0, ..PostureRules::NONE });
        assert_eq!(rules("tie_percent = 0"), PostureRules::NONE);
        let read = rules("allowed = [3, 4]\nchanges = 'never'\nmove_weight_mm_per_s = 0.002\ntie_percent = 2");
        assert!(!read.may_change && read.move_weight == 0.002 / 1e3 && read.tie == 0.02);
        assert_eq!(read.allowed().map(|posture| posture.number()).collect::<Vec<_>>(), [3, 4]);
    }

    #[test]
    fn postures_that_cannot_be_are_refused_where_they_are_named() {
        for (table, parts) in [
            ("allowed = []", [":7: postures.allowed: ", "allows no posture", "found []"]),
            ("allowed = [3, 4, 3]", [":7: postures.allowed[3]: ", "is there twice", "found 3;"]),
            ("allowed = [0]", [":7: postures.allowed[1]: ", "found 0", "from 1 to 8"]),
            ("changes = 'some'", [":7: postures.changes: ", "found 'some'", "\"never\""]),
            ("tie_percent = 21", [":7: postures.tie_percent: ", "found 21", "from 0 to 20"]),
        ] {
            assert_refused("[cell]", &with(table), &parts);
        }
        let text = RUN.replace("[cell]", &with("move_weight_mm_per_s = 1")) + "[criterion]\naggregate = 'max'\n";
        let message = read(&text).unwrap_err().to_string();
        assert!(message.contains(":7: postures.move_weight_mm_per_s: is held against a mean"), "{message}");
    }
}
