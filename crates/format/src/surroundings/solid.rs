//! The form of a shape: one of five keys, and the mesh file where it is made of one.

use super::tables::ShapeTable;
use crate::mesh::MeshUnit;
use crate::place::Place;
use crate::quantity::Quantity;
use stead_cell::Solid;
use stead_disk::input::{InputError, InputFile};

const FORMS: &str = "exactly one of box_mm, cylinder_mm = { radius, length }, capsule_mm = { radius, length }, hull (a mesh file), mesh";

impl ShapeTable {
    /// The form, and the file that it comes from, if there is one.
    ///
    /// # Errors
    /// [`InputError`] for two forms or none, and for a mesh file that cannot be read.
    pub(super) fn solid(&self, at: &Place<'_>) -> Result<(Solid, Option<InputFile>), InputError> {
        let given = ["box_mm", "cylinder_mm", "capsule_mm", "hull", "mesh"].map(|key| at.key(key));
        let mut given = given.iter().filter(|place| place.is_given());
        let Some(form) = given.next() else { return Err(at.key("box_mm").error("has no form", FORMS)) };
        if let Some(second) = given.next() {
            let first = form.path.rsplit('.').next().unwrap_or_default();
            return Err(second.error(format!("is a second form beside {first}"), FORMS));
        }
        if self.unit.is_some() && self.hull.is_none() && self.mesh.is_none() {
            return Err(at
                .key("unit")
                .error("is for a mesh file", "hull or mesh beside it; box_mm and the others are in mm"));
        }
        let solid = if let Some(edges) = self.box_mm {
            Solid::Box(edges.vector())
        } else if let Some(table) = self.cylinder_mm {
            Solid::Cylinder { radius: table.radius.si(), length: table.length.si() }
        } else if let Some(table) = self.capsule_mm {
            Solid::Capsule { radius: Quantity::si(table.radius), length: table.length.si() }
        } else {
            let unit = self.unit.map_or(MeshUnit::Millimetre, |word| word.0);
            let (mesh, file) = form.named_mesh(unit)?;
            let solid = if self.hull.is_some() { Solid::Hull(mesh) } else { Solid::Mesh(mesh) };
            return Ok((solid, Some(file)));
        };
        Ok((solid, None))
    }
}
