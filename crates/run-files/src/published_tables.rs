//! Published tables of an assessment, to print beside ours.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use stead_assessment::comparison::Load;
use stead_assessment::map::Elbow;
use stead_assessment::published::{PublishedTables, Quantity, Reading};
use stead_disk::input::InputError;
use stead_format::place::Place;
use stead_format::quantity::{self, Range, Unit};
use stead_format::shapes::{Array, List};
use stead_format::toml_file::TomlFile;
use stead_format::units::{Mm, N, Positive};
use stead_model::published::Published;

/// Published tables. Rows by force, accuracy or side may be shorter than their head: the rest are dashes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PublishedTablesFile {
    /// Where they were published.
    pub source: String,
    /// Head of the rows by side of a zone.
    pub sides_mm: List<Mm<Positive>>,
    /// Head of the rows by force.
    pub forces_n: List<N<Positive>>,
    /// Head of the rows by accuracy.
    pub accuracies_mm: List<Mm<Positive>>,
    /// What was published of each robot.
    pub robots: Vec<PublishedRobot>,
}

/// What was published of a robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PublishedRobot {
    /// Name of the robot, as in its robot file.
    pub name: String,
    /// Accuracy by force.
    pub accuracy_mm: List<Mm<Positive>>,
    /// By accuracy: the largest of the forces at which the robot is listed.
    pub largest_force_n: List<N<Positive>>,
    /// With the elbow up.
    pub up: PublishedCircularities,
    /// With the elbow down.
    pub down: PublishedCircularities,
}

/// Published circularities of a robot with its elbow up or down.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PublishedCircularities {
    /// Under the test load: smallest, largest, and in the middle of the map.
    pub test_mm: Array<Mm<Positive>, 3>,
    /// Under the rated load: smallest, largest, and in the middle of the map.
    pub rated_mm: Array<Mm<Positive>, 3>,
    /// Largest in the best zone, by side.
    pub optimal_mm: List<Mm<Positive>>,
    /// Largest in the middle zone, by side.
    pub middle_mm: List<Mm<Positive>>,
}

/// Reads published tables, the keys of [`PublishedTablesFile`].
///
/// # Errors
/// [`InputError`] with line and field: a file that is no TOML, a missing or unknown key, a value of the wrong kind or
/// out of range, a row longer than its head.
pub(super) fn published_tables_from(source: &TomlFile) -> Result<Published<PublishedTables>, InputError> {
    let document = source.parse()?;
    let file: PublishedTablesFile = document.read()?;
    let mut published = PublishedTables::default();
    for (row, number) in file.robots.iter().zip(1..) {
        row.add_to(&mut published, &file, &document.root().key("robots").element(number))?;
    }
    Ok(Published { source: file.source, figures: published })
}

impl PublishedRobot {
    fn add_to(
        &self,
        published: &mut PublishedTables,
        file: &PublishedTablesFile,
        at: &Place<'_>,
    ) -> Result<(), InputError> {
        let named = || self.name.clone();
        let by_force = under(&file.forces_n, &self.accuracy_mm, &at.key("accuracy_mm"))?;
        published.accuracies.extend(by_force.into_iter().map(|(force, value)| (named(), force, value)));
        let forces = file.forces_n.si();
        for (accuracy, max) in under(&file.accuracies_mm, &self.largest_force_n, &at.key("largest_force_n"))? {
            let reached = forces.iter().filter(|force| max.is_some_and(|max| **force <= max));
            published.capable.extend(reached.map(|force| (accuracy, *force, named())));
        }
        for (elbow, table, at) in [(Elbow::Up, &self.up, at.key("up")), (Elbow::Down, &self.down, at.key("down"))] {
            let mut add = |load: Load, quantity: Quantity, value: Option<f64>| {
                published.readings.push(Reading { robot: named(), elbow, load, quantity, value });
            };
            for (load, values) in [(Load::Test, table.test_mm), (Load::Rated, table.rated_mm)] {
                let quantities = [Quantity::Minimum, Quantity::Maximum, Quantity::Middle];
                for (quantity, value) in quantities.into_iter().zip(values.si()) {
                    add(load, quantity, Some(value));
                }
            }
            for (side, value) in under(&file.sides_mm, &table.optimal_mm, &at.key("optimal_mm"))? {
                add(Load::Test, Quantity::OptimalZone(side), value);
            }
            for (side, value) in under(&file.sides_mm, &table.middle_mm, &at.key("middle_mm"))? {
                add(Load::Test, Quantity::MiddleZone(side), value);
            }
        }
        Ok(())
    }
}

/// The numbers of a row in SI units, each with its head; `None` where the row has ended.
fn under<H: Unit, V: Unit, R: Range>(
    heads: &List<quantity::Quantity<H, R>>,
    row: &List<quantity::Quantity<V, R>>,
    at: &Place<'_>,
) -> Result<Vec<(f64, Option<f64>)>, InputError> {
    let (heads, numbers) = (heads.si(), row.si());
    if numbers.len() > heads.len() {
        let problem = format!("has {} numbers under {} heads", numbers.len(), heads.len());
        let rule = format!("at most {} numbers above 0, as many as there are heads", heads.len());
        return Err(at.error(problem, rule));
    }
    Ok(heads.into_iter().zip(numbers.into_iter().map(Some).chain(std::iter::repeat(None))).collect())
}
