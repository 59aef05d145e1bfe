//! The table `[spindle]`: the tool frame in the flange frame, and what the flange carries.

use crate::compliance_matrix::{WrenchMatrix, force_matrix, wrench_matrix};
use crate::inertial::{CENTRE, INERTIA, InertiaTable, MASS, inertial_from, point_mass_from};
use crate::orientation::{Quaternion, orientation_keys};
use crate::place::Place;
use crate::shapes::{Matrix, Vector};
use crate::toml_file::TomlFile;
use crate::units::{Deg, Kg, Mm, Positive};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;
use stead_disk::input::InputError;
use stead_model::robot::{Pose, Spindle};

/// The tool frame in the flange frame, and the body that the flange carries. The tool frame has its origin at the tool
/// centre point and its z axis along the tool, out of the spindle to the work.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpindleTable {
    /// Tool centre point in the flange frame.
    pub xyz_mm: Vector<Mm>,
    /// Rotation from tool to flange coordinates, by rows: its columns are the axes of the tool frame in the flange
    /// frame; exactly one of this and the four keys below.
    pub rotation: Option<Matrix>,
    /// The same as KUKA's A, B, C: Rz(A) Ry(B) Rx(C).
    pub abc_deg: Option<Vector<Deg>>,
    /// The same as Fanuc's W, P, R: Rz(R) Ry(P) Rx(W).
    pub wpr_deg: Option<Vector<Deg>>,
    /// The same as roll, pitch, yaw of a URDF: Rz(y) Ry(p) Rx(r).
    pub rpy_deg: Option<Vector<Deg>>,
    /// The same as ABB's quaternion.
    pub quaternion_wxyz: Option<Quaternion>,
    /// Mass of all that the flange carries: spindle, holder and tool. With it results state how far the weight moves
    /// the tool. Needed where motion or stability is computed.
    pub mass_kg: Option<Kg<Positive>>,
    /// Centre of mass of all that the flange carries, in the flange frame.
    pub centre_of_mass_mm: Option<Vector<Mm>>,
    /// Inertia tensor of all that the flange carries about its centre of mass, in the directions of the flange frame;
    /// needed where motion or stability is computed.
    pub inertia_kg_m2: Option<InertiaTable>,
    /// How the spindle is fixed to the flange, where that yields: displacement and turn per force and moment at the
    /// origin of the flange frame, in its directions, translations first: um/N, urad/N; urad/N, urad/(N m).
    pub mount_matrix: Option<WrenchMatrix>,
    /// How holder and tool yield at the tool centre point: displacement per force, in the directions of the tool frame,
    /// in um/N.
    pub tip_um_per_n: Option<Matrix>,
}

/// Reads the table `[spindle]` of a file, as of a run file, whatever else is in it; with the bytes of the file.
///
/// # Errors
/// [`InputError`] with file, line and field.
pub fn read_spindle(file: &Path) -> Result<(Spindle, Vec<u8>), InputError> {
    let source = TomlFile::read(file)?;
    let document = source.parse()?;
    let at = document.root().key("spindle");
    if !at.is_given() {
        return Err(at.missing("a table [spindle] with xyz_mm and an orientation, as in a run file"));
    }
    let table: SpindleTable = at.read()?;
    Ok((table.spindle(&at)?, source.bytes().to_vec()))
}

impl SpindleTable {
    /// The spindle that the table describes.
    ///
    /// # Errors
    /// [`InputError`] with file, line and field: a matrix that is no rotation, a body that cannot be.
    pub fn spindle(&self, at: &Place<'_>) -> Result<Spindle, InputError> {
        let flange_from_tool =
            Pose { rotation: orientation_keys!(self).rotation(at)?, translation: self.xyz_mm.vector() };
        let mut spindle = Spindle::rigid(flange_from_tool);
        let matrix = |rows| wrench_matrix(rows, &at.key("mount_matrix"));
        spindle.mount = self.mount_matrix.as_ref().map(matrix).transpose()?;
        let matrix = |rows| force_matrix(rows, &at.key("tip_um_per_n"));
        spindle.tip = self.tip_um_per_n.as_ref().map(matrix).transpose()?;
        if self.inertia_kg_m2.is_some() {
            spindle.payload = Some(inertial_from(self.mass_kg, self.centre_of_mass_mm, self.inertia_kg_m2, at)?);
        } else if self.mass_kg.is_some() || self.centre_of_mass_mm.is_some() {
            spindle.point_mass = Some(point_mass_from(self.mass_kg, self.centre_of_mass_mm, at)?);
        }
        Ok(spindle)
    }

    /// The same where motion is computed: what the flange carries has to be known.
    ///
    /// # Errors
    /// As [`SpindleTable::spindle`], and for a table without a mass.
    pub fn moving_spindle(&self, at: &Place<'_>) -> Result<Spindle, InputError> {
        let spindle = self.spindle(at)?;
        if spindle.payload.is_none() {
            let key = if spindle.point_mass.is_some() { INERTIA } else { MASS };
            let what = "is missing: how the arm moves depends on what the flange carries";
            let allowed = format!("{MASS}, {CENTRE} and {INERTIA} of spindle, holder and tool, in the flange frame");
            return Err(at.key(key).error(what, allowed));
        }
        Ok(spindle)
    }
}
