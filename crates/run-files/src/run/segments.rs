//! Tables for segments of the task, each named by its number.

use stead_disk::input::InputError;
use stead_format::place::Place;

/// The values of tables in the order of the segments: each with the number of its segment, from 1; nothing of a
/// segment without a table. `at` is the place of the tables.
///
/// # Errors
/// [`InputError`] at a number that is none of the segments, and at one that is there twice.
pub(super) fn by_segment<T: Clone>(
    tables: impl Iterator<Item = (usize, T)>,
    count: usize,
    at: &Place<'_>,
    allowed: impl FnOnce() -> String,
) -> Result<Vec<Option<T>>, InputError> {
    let mut values = vec![None; count];
    for ((number, value), place) in tables.zip(1..) {
        let at = at.element(place).key("number");
        let Some(slot) = values.get_mut(number - 1) else {
            return Err(at.error("is no segment of the task", allowed()));
        };
        if slot.replace(value).is_some() {
            return Err(at.error("is there twice", "each segment once"));
        }
    }
    Ok(values)
}
