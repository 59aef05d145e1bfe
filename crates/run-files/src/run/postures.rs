//! The table `[postures]`: which postures segments may be driven in, and how moves between them count.

use crate::Word;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, IntoDeserializer, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::ops::Bound::Included;
use stead_disk::input::InputError;
use stead_format::place::Place;
use stead_format::quantity::{Expects, Quantity, expecting, inline_schema};
use stead_format::scalars::{Whole, words};
use stead_format::units::{MmPerS, NotNegative, Percent, ranges};
use stead_model::robot::{Posture, PostureWord, Robot};
use stead_problem::criterion::Aggregate;
use stead_problem::postures::PostureRules;
use stead_problem::problem::Problem;
use stead_problem::settings::{PostureSearch, SearchSettings};

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

words!(PostureWord);

/// Postures that are allowed: one by its number, or those of a word.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum AllowedPosture {
    /// One.
    Number(Whole<1, 8>),
    /// All that have a word, and those of the words beside it.
    Word(Word<PostureWord>),
}

impl Expects for AllowedPosture {
    fn expected() -> String {
        format!("{} or {}", Whole::<1, 8>::expected(), Word::<PostureWord>::expected())
    }
}

impl<'de> Deserialize<'de> for AllowedPosture {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AllowedVisitor)
    }
}

struct AllowedVisitor;

impl Visitor<'_> for AllowedVisitor {
    type Value = AllowedPosture;

    expecting!(AllowedPosture);

    fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
        let number = (value.fract() == 0.0).then(|| Whole::deserialize((value as u64).into_deserializer()));
        let number: Option<Result<_, E>> = number.filter(|_| value > 0.0);
        let refused = || E::invalid_value(Unexpected::Float(value), &self);
        number.and_then(Result::ok).map(AllowedPosture::Number).ok_or_else(refused)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
        let word: Result<_, E> = Word::deserialize(text.into_deserializer());
        word.map(AllowedPosture::Word).map_err(|_| E::invalid_value(Unexpected::Str(text), &self))
    }
}

impl JsonSchema for AllowedPosture {
    inline_schema!(Self::expected());

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let number = generator.subschema_for::<Whole<1, 8>>();
        let word = generator.subschema_for::<Word<PostureWord>>();
        json_schema!({ "anyOf": [number, word] })
    }
}

/// Which postures the segments of the path may be driven in, and how the moves between them count.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct PosturesTable {
    /// The allowed postures, all eight where left out: `front` or `back`, `elbow up` or `elbow down`, `flip` or `no
    /// flip`, of which several restrict together; and numbers, which add those postures.
    pub allowed: Option<Vec<AllowedPosture>>,
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
    pub(super) fn rules(&self, robot: &Robot, at: &Place<'_>) -> Result<PostureRules, InputError> {
        let mut rules = PostureRules {
            may_change: self.changes.is_none_or(|word| word.0 == Changes::Free),
            move_weight: self.move_weight_mm_per_s.map_or(0.0, Quantity::si),
            tie: self.tie_percent.map_or(PostureRules::default().tie, Quantity::si),
            ..PostureRules::NONE
        };
        let Some(entries) = &self.allowed else { return Ok(rules) };
        let at = at.key("allowed");
        if entries.is_empty() {
            return Err(at.error("allows no posture", format!("at least one of: {}", AllowedPosture::expected())));
        }
        for (place, entry) in entries.iter().enumerate() {
            let at = at.element(place + 1);
            if entries[..place].contains(entry) {
                return Err(at.error("is there twice", "each posture once"));
            }
            let AllowedPosture::Word(word) = entry else { continue };
            let other = word.0.other();
            if entries[..place].contains(&AllowedPosture::Word(other.into())) {
                let problem = format!("and \"{other}\" before it exclude each other");
                return Err(at.error(problem, "one of the two, or none of them for both"));
            }
        }
        rules.allowed = Posture::ALL.map(|posture| {
            let is_numbered = |entry: &AllowedPosture| match entry {
                AllowedPosture::Number(number) => number.get() == u64::from(posture.number()),
                AllowedPosture::Word(_) => false,
            };
            self.has_words(robot, posture) || entries.iter().any(is_numbered)
        });
        Ok(rules)
    }

    /// The words for what is allowed.
    fn words(&self) -> impl Iterator<Item = PostureWord> + '_ {
        self.allowed.iter().flatten().filter_map(|entry| match entry {
            AllowedPosture::Word(word) => Some(word.0),
            AllowedPosture::Number(_) => None,
        })
    }

    /// Whether there are words, and a posture has all of them.
    fn has_words(&self, robot: &Robot, posture: Posture) -> bool {
        let words = robot.posture_words(posture);
        self.words().next().is_some() && self.words().all(|word| words.has(word))
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
    let robot = &problem.robot;
    let possible = || Posture::ALL.into_iter().filter(|posture| robot.has_posture(*posture));
    for (entry, place) in table.allowed.iter().flatten().zip(1..) {
        let AllowedPosture::Number(number) = entry else { continue };
        let posture = u8::try_from(number.count()).ok().and_then(Posture::from_number);
        if let Some(posture) = posture.filter(|posture| !robot.has_posture(*posture)) {
            let name = robot.named_posture(posture);
            let why = format!("no segment can take posture {name}: the limits of the joints leave it out");
            let numbers = possible().map(|posture| posture.to_string()).collect::<Vec<_>>().join(", ");
            return Err(at.key("allowed").element(place).error(why, numbers));
        }
    }
    if table.words().next().is_some() && !possible().any(|posture| table.has_words(robot, posture)) {
        let words = table.words().map(|word| word.to_string()).collect::<Vec<_>>().join(", ");
        let why = format!("leaves no posture: the limits of the joints leave out all that are {words}");
        let named = possible().map(|posture| robot.named_posture(posture)).collect::<Vec<_>>().join("; ");
        return Err(at.key("allowed").error(why, named));
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
    use stead_problem::postures::PostureRules;

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
    fn words_restrict_together_and_numbers_add() {
        let allowed = |list: &str| {
            let read = read(&RUN.replace("[cell]", &with(&format!("allowed = [{list}]"))));
            let problem = read.unwrap_or_else(|error| panic!("{error}")).problem;
            problem.postures.allowed().map(|posture| posture.number()).collect::<Vec<_>>()
        };
        // KUKA counts A5 against theta_5.
        assert_eq!(allowed("'front', 'elbow up'"), [3, 4]);
        assert_eq!(allowed("'front'"), [1, 2, 3, 4]);
        assert_eq!(allowed("'back', 'elbow up'"), [5, 6]);
        assert_eq!(allowed("'elbow down', 'flip', 'front'"), [1]);
        assert_eq!(allowed("'no flip'"), [2, 4, 6, 8]);
        assert_eq!(allowed("'front', 'elbow up', 1, 3"), [1, 3, 4]);
    }

    #[test]
    fn postures_that_cannot_be_are_refused_where_they_are_named() {
        for (table, parts) in [
            ("allowed = []", [":7: postures.allowed: ", "allows no posture", "found []"]),
            ("allowed = [3, 4, 3]", [":7: postures.allowed[3]: ", "is there twice", "found 3;"]),
            ("allowed = [0]", [":7: postures.allowed[1]: ", "found 0", "from 1 to 8"]),
            ("allowed = [2.5]", [":7: postures.allowed[1]: ", "found 2.5", "from 1 to 8"]),
            ("allowed = ['up']", [":7: postures.allowed[1]: ", "found 'up'", "\"elbow up\" or \"elbow down\""]),
            ("allowed = [3, 'front', 'front']", [":7: postures.allowed[3]: ", "is there twice", "found 'front';"]),
            (
                "allowed = ['front', 3, 'back']",
                [
                    ":7: postures.allowed[3]: ",
                    "and \"front\" before it exclude each other",
                    "found 'back'; allowed: one",
                ],
            ),
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
