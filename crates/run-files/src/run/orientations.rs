//! The ways in which the part may lie: `[cell] orientations` and `orientation`.

use super::tables::CellTable;
use nalgebra::Matrix3;
use std::sync::Arc;
use stead_disk::input::InputError;
use stead_disk::quote::garbles;
use stead_format::orientation::orientation_keys;
use stead_format::place::Place;
use stead_model::task::Task;
use stead_problem::setup::Orientation;

/// What a name is.
pub(super) const NAME: &str = "a text on one line that is not empty";

/// Whether a text may be the name of something.
pub(super) fn is_name(name: &str) -> bool {
    !name.trim().is_empty() && !name.contains(garbles)
}

impl CellTable {
    /// The orientations of the part among which one is chosen: all that are listed, or the one that is named; none
    /// where none is listed.
    ///
    /// # Errors
    /// [`InputError`] for an empty list, a name that is there twice or is none, a rotation that is none, and the name
    /// of an orientation that is not in the list.
    pub(super) fn orientations(&self, task: &Task, at: &Place<'_>) -> Result<Arc<[Orientation]>, InputError> {
        let list = at.key("orientations");
        let Some(tables) = &self.orientations else {
            let unlisted =
                || at.key("orientation").error("names an orientation, and none is listed", "orientations beside it");
            return if self.orientation.is_some() { Err(unlisted()) } else { Ok([].into()) };
        };
        if tables.is_empty() {
            return Err(list.error("is empty", "one orientation or more: { name = \"..\", rpy_deg = [..] }"));
        }
        let mut found: Vec<Orientation> = Vec::with_capacity(tables.len());
        for (table, number) in tables.iter().zip(1..) {
            let at = list.element(number);
            if !is_name(&table.name) {
                return Err(at.key("name").error("is no name", NAME));
            }
            if found.iter().any(|known| known.name == table.name) {
                return Err(at.key("name").error("is there twice", "a name of its own for each orientation"));
            }
            let keys = orientation_keys!(table);
            let rotation = if keys.is_given() { keys.rotation(&at)? } else { Matrix3::identity() };
            let is_as_in_the_task = rotation == Matrix3::identity();
            let task = Arc::new(if is_as_in_the_task { task.clone() } else { task.turned(&rotation) });
            found.push(Orientation { name: table.name.clone(), rotation, task });
        }
        if let Some(name) = &self.orientation {
            let names: Vec<String> = found.iter().map(|known| format!("\"{}\"", known.name)).collect();
            found.retain(|known| known.name == *name);
            if found.is_empty() {
                return Err(at.key("orientation").error("is not among the orientations", names.join(", ")));
            }
        }
        Ok(found.into())
    }
}
