//! Published tables of an assessment, to set beside ours.

use super::reader::{Field, Table};
use super::source::Source;
use crate::input::InputError;
use stead_assessment::comparison::Load;
use stead_assessment::map::Elbow;
use stead_assessment::published::{PublishedTables, Quantity, Reading};
use stead_model::published::Published;

/// Reads published tables: `source`, the heads `sides_mm`, `forces_n` and `accuracies_mm`, and for each of `[[robots]]` its
/// `name`, `accuracy_mm` (by force), `largest_force_n` (by accuracy: the largest of the forces at which the robot is
/// listed) and the tables `[robots.up]` and `[robots.down]` with `test_mm` and `rated_mm` (smallest, largest, middle),
/// `optimal_mm` and `middle_mm` (by side). Rows by force or side may be shorter than their head: the rest are dashes.
pub(super) fn printed_from(source: &Source) -> Result<Published<PublishedTables>, InputError> {
    let document = source.parse()?;
    let [origin, sides, forces, accuracies, robots] =
        Table::root(&document).fields(["source", "sides_mm", "forces_n", "accuracies_mm", "robots"])?;
    let head = |field: &Field<'_>| field.numbers("one or more numbers above 0", |value| value > 0.0);
    let heads = Heads { sides: head(&sides)?, forces: head(&forces)?, accuracies: head(&accuracies)? };
    let (source, mut published) = (origin.string()?.to_owned(), PublishedTables::default());
    for row in robots.tables()? {
        robot(&row, &heads, &mut published)?;
    }
    Ok(Published { source, figures: published })
}

/// What the rows are by, in the units of the file.
struct Heads {
    sides: Vec<f64>,
    forces: Vec<f64>,
    accuracies: Vec<f64>,
}

fn robot(row: &Table<'_>, heads: &Heads, published: &mut PublishedTables) -> Result<(), InputError> {
    let [name, accuracy, largest, up, down] = row.fields(["name", "accuracy_mm", "largest_force_n", "up", "down"])?;
    let name = name.string()?;
    let values = under(&heads.forces, &accuracy)?;
    published
        .accuracies
        .extend(values.into_iter().map(|(force, value)| (name.to_owned(), force, value.map(|mm| mm / 1e3))));
    for (accuracy, most) in under(&heads.accuracies, &largest)? {
        let reached = heads.forces.iter().filter(|force| most.is_some_and(|most| **force <= most));
        published.capable.extend(reached.map(|force| (accuracy / 1e3, *force, name.to_owned())));
    }
    for (elbow, field) in [(Elbow::Up, up), (Elbow::Down, down)] {
        let [test, rated, optimal, middle] =
            field.table()?.fields(["test_mm", "rated_mm", "optimal_mm", "middle_mm"])?;
        let mut add = |load: Load, quantity: Quantity, mm: Option<f64>| {
            let value = mm.map(|mm| mm / 1e3);
            published.readings.push(Reading { robot: name.to_owned(), elbow, load, quantity, value });
        };
        for (load, field) in [(Load::Test, test), (Load::Rated, rated)] {
            let rule = "three numbers above 0: smallest, largest, middle";
            let numbers: [f64; 3] = field.numbers_where(rule, |value| value > 0.0)?;
            for (quantity, mm) in [Quantity::Minimum, Quantity::Maximum, Quantity::Middle].into_iter().zip(numbers) {
                add(load, quantity, Some(mm));
            }
        }
        for (side, mm) in under(&heads.sides, &optimal)? {
            add(Load::Test, Quantity::OptimalZone(side / 1e3), mm);
        }
        for (side, mm) in under(&heads.sides, &middle)? {
            add(Load::Test, Quantity::MiddleZone(side / 1e3), mm);
        }
    }
    Ok(())
}

/// The numbers of a row, each with its head; `None` where the row has ended.
fn under(heads: &[f64], row: &Field<'_>) -> Result<Vec<(f64, Option<f64>)>, InputError> {
    let rule = format!("at most {} numbers above 0, as many as there are heads", heads.len());
    let numbers = row.numbers(&rule, |value| value > 0.0)?;
    if numbers.len() > heads.len() {
        return Err(row.error(format!("has {} numbers under {} heads", numbers.len(), heads.len()), rule));
    }
    let padded = numbers.into_iter().map(Some).chain(std::iter::repeat(None));
    Ok(heads.iter().copied().zip(padded).collect())
}
