//! Fields of a rigid body: mass, centre of mass, inertia tensor.

use crate::place::Place;
use crate::quantity::{Expects, Quantity};
use crate::shapes::Vector;
use crate::units::{Kg, KgM2, Mm, Positive};
use nalgebra::Matrix3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use stead_disk::input::InputError;
use stead_model::robot::{Inertial, InertialError, PointMass};

pub(super) const MASS: &str = "mass_kg";
pub(super) const CENTRE: &str = "centre_of_mass_mm";
pub(super) const INERTIA: &str = "inertia_kg_m2";

/// An inertia tensor about the centre of mass. The entries beside the diagonal are those of the tensor; 0 where left
/// out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InertiaTable {
    /// Moment of inertia about the x direction.
    pub xx: KgM2<Positive>,
    /// Moment of inertia about the y direction.
    pub yy: KgM2<Positive>,
    /// Moment of inertia about the z direction.
    pub zz: KgM2<Positive>,
    /// Entry of the tensor in row x and column y.
    pub xy: Option<KgM2>,
    /// Entry of the tensor in row x and column z.
    pub xz: Option<KgM2>,
    /// Entry of the tensor in row y and column z.
    pub yz: Option<KgM2>,
}

impl Expects for InertiaTable {
    fn expected() -> String {
        format!("a table {INERTIA} with xx, yy and zz")
    }
}

impl InertiaTable {
    fn tensor(&self) -> Matrix3<f64> {
        let [xx, yy, zz] = [self.xx, self.yy, self.zz].map(Quantity::si);
        let [xy, xz, yz] = [self.xy, self.xz, self.yz].map(|entry| entry.map_or(0.0, Quantity::si));
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }
}

/// Mass and centre of a body from the keys `mass_kg` and `centre_of_mass_mm` of a table.
///
/// # Errors
/// [`InputError`] with file, line and field: a missing key.
pub(super) fn point_mass_from(
    mass: Option<Kg<Positive>>,
    centre: Option<Vector<Mm>>,
    at: &Place<'_>,
) -> Result<PointMass, InputError> {
    Ok(PointMass { mass: at.require(MASS, mass)?.si(), centre: at.require(CENTRE, centre)?.vector() })
}

/// A body from the keys `mass_kg`, `centre_of_mass_mm` and `inertia_kg_m2` of a table.
///
/// # Errors
/// [`InputError`] with file, line and field: a missing key, a tensor that no rigid body has.
pub(super) fn inertial_from(
    mass: Option<Kg<Positive>>,
    centre: Option<Vector<Mm>>,
    inertia: Option<InertiaTable>,
    at: &Place<'_>,
) -> Result<Inertial, InputError> {
    let (mass, centre) = (at.require(MASS, mass)?.si(), at.require(CENTRE, centre)?.vector());
    let inertia = at.require(INERTIA, inertia)?;
    Inertial::new(mass, centre, inertia.tensor()).map_err(|error| {
        let (field, problem) = match error {
            InertialError::Mass(_) | InertialError::Centre => (MASS, error.to_string()),
            InertialError::NotFinite => (INERTIA, "is no tensor of finite numbers".to_owned()),
            InertialError::NotPositiveDefinite(smallest) => {
                (INERTIA, format!("is not positive definite: its smallest principal moment is {smallest:.6} kg m^2"))
            }
            InertialError::Triangle { largest, others } => {
                let compared =
                    format!("its largest principal moment, {largest:.6}, is above the sum of the two others");
                (INERTIA, format!("breaks the triangle inequality: {compared}, {others:.6} kg m^2"))
            }
        };
        at.key(field).error(problem, "the tensor of a rigid body about its centre of mass, entries in kg m^2")
    })
}
