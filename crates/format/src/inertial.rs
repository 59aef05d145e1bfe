//! Fields of a rigid body: mass, centre of mass, inertia tensor.

use super::reader::{Field, Table};
use crate::input::InputError;
use nalgebra::Matrix3;
use stead_model::robot::{Inertial, InertialError};

pub(super) const MASS: &str = "mass_kg";
pub(super) const CENTRE: &str = "centre_of_mass_mm";
pub(super) const INERTIA: &str = "inertia_kg_m2";

/// The body of a table: `mass_kg`, `centre_of_mass_mm` and `inertia_kg_m2`, a table of `xx`, `yy`, `zz` and, where they are
/// not zero, `xy`, `xz`, `yz`: entries of the tensor about the centre of mass.
///
/// # Errors
/// [`InputError`] with file, line and field: a missing key, a mass not above 0, a tensor that no rigid body has.
pub(super) fn inertial_from(table: &Table<'_>) -> Result<Inertial, InputError> {
    let [mass, centre, inertia] = [MASS, CENTRE, INERTIA].map(|key| table.field(key));
    let (kilograms, centre) = (mass.positive()?, centre.vector3()? / 1e3);
    Inertial::new(kilograms, centre, tensor_from(&inertia)?).map_err(|error| {
        let (field, problem) = match error {
            InertialError::Mass { .. } | InertialError::Centre => (&mass, error.to_string()),
            InertialError::NotFinite => (&inertia, "is no tensor of finite numbers".to_owned()),
            InertialError::NotPositiveDefinite { smallest } => {
                (&inertia, format!("is not positive definite: its smallest principal moment is {smallest:.6} kg m^2"))
            }
            InertialError::Triangle { largest, others } => {
                let compared =
                    format!("its largest principal moment, {largest:.6}, is above the sum of the two others");
                (&inertia, format!("breaks the triangle inequality: {compared}, {others:.6} kg m^2"))
            }
        };
        field.error(problem, "the tensor of a rigid body about its centre of mass, entries in kg m^2")
    })
}

fn tensor_from(field: &Field<'_>) -> Result<Matrix3<f64>, InputError> {
    let [xx, yy, zz, xy, xz, yz] = field.table()?.fields(["xx", "yy", "zz", "xy", "xz", "yz"])?;
    let off = |field: &Field<'_>| field.optional(Field::number).map(Option::unwrap_or_default);
    let (xy, xz, yz) = (off(&xy)?, off(&xz)?, off(&yz)?);
    Ok(Matrix3::new(xx.positive()?, xy, xz, xy, yy.positive()?, yz, xz, yz, zz.positive()?))
}
