//! The table `[spindle]`: the tool frame in the flange frame, and what the flange carries.

use crate::compliance_matrix::{WrenchMatrix, force_matrix, wrench_matrix};
use crate::inertial::{CENTRE, INERTIA, InertiaTable, MASS, inertial_from, point_mass_from};
use crate::orientation::{Quaternion, orientation_keys};
use crate::place::Place;
use crate::shapes::{Matrix, Vector};
use crate::toml_file::TomlFile;
use crate::units::{Deg, Kg, Kw, Mm, Nm, Positive};
use nalgebra::Matrix3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;
use stead_disk::input::InputError;
use stead_model::robot::{Pose, Spindle};
use stead_numerics::rotation::rotation_from_zyx;

/// A tool whose axis is within 60 deg of the direction from the flange to its centre point points away from the flange:
/// the cosine.
const ALONG: f64 = 0.5;

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
    /// Power that it gives for long; with a stock, a cut that takes more is warned of.
    pub power_kw: Option<Kw<Positive>>,
    /// Torque that it gives for long; with a stock, a cut that takes more is warned of.
    pub torque_nm: Option<Nm<Positive>>,
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
        let keys = orientation_keys!(self);
        let rotation = keys.rotation(at).map_err(|error| match keys.is_given() {
            true => error,
            false => {
                let allowed = error.allowed.as_deref().unwrap_or_default();
                let allowed = format!("{allowed}; the guide's page `conventions` shows the tool frame");
                InputError { allowed: Some(allowed.into()), ..error }
            }
        })?;
        let flange_from_tool = Pose { rotation, translation: self.xyz_mm.vector() };
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

    /// Where the tool points from its centre point back to the flange, the key by whose order its angles, or the same
    /// numbers from the last to the first, would agree with where that point is.
    pub fn order_note(&self) -> Option<String> {
        let place = self.xyz_mm.vector().try_normalize(0.0)?;
        let out = |rotation: Matrix3<f64>| rotation.column(2).dot(&place);
        let (key, angles) = [("abc_deg", self.abc_deg), ("wpr_deg", self.wpr_deg), ("rpy_deg", self.rpy_deg)]
            .into_iter()
            .find_map(|(key, angles)| Some((key, angles?.si())))?;
        let [first, second, third] = angles;
        let [stated, other] = [[first, second, third], [third, second, first]].map(rotation_from_zyx);
        let (stated, other, known) =
            if key == "abc_deg" { (stated, other, "wpr_deg or rpy_deg") } else { (other, stated, "abc_deg") };
        (out(stated) < 0.0 && out(other) > ALONG).then(|| {
            format!(
                "spindle.{key}: the tool points back to the flange with these angles, and away from it with the same numbers as \
                 {known}: that order agrees with spindle.xyz_mm"
            )
        })
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

#[cfg(test)]
mod tests {
    use super::*;

    fn read(table: &str) -> Result<Option<String>, InputError> {
        let text = format!("[spindle]\nxyz_mm = [-30, 0, 350]\n{table}\n");
        let file = TomlFile::new("run.toml".as_ref(), text.into_bytes())?;
        let document = file.parse()?;
        let at = document.root().key("spindle");
        let table: SpindleTable = at.read()?;
        table.spindle(&at)?;
        Ok(table.order_note())
    }

    #[test]
    fn angles_in_another_order_are_noted_with_the_order_that_agrees() {
        // Rz(180) lets the tool point out, Rx(180) back.
        let note = read("wpr_deg = [180, 0, 0]").unwrap().unwrap();
        assert!(note.starts_with("spindle.wpr_deg: ") && note.contains("same numbers as abc_deg"), "{note}");
        let note = read("abc_deg = [0, 0, 170]").unwrap().unwrap();
        assert!(note.contains("same numbers as wpr_deg or rpy_deg"), "{note}");
        for right in ["abc_deg = [180, 0, 0]", "rpy_deg = [0, 0, 180]", "abc_deg = [0, 180, 0]", "abc_deg = [0, 90, 0]"]
        {
            assert_eq!(read(right).unwrap(), None, "{right}");
        }
    }

    #[test]
    fn a_spindle_without_orientation_is_refused_with_the_page_that_shows_how() {
        let message = read("").unwrap_err().to_string();
        assert!(message.contains("spindle.rotation: is missing; allowed: exactly one of "), "{message}");
        assert!(message.ends_with("the guide's page `conventions` shows the tool frame"), "{message}");
    }
}
