//! Joint stiffness for an arm whose URDF has none: the values of a shipped arm, with their source.

use crate::robot::{JointRow, OneOrRange, lender, lent_urad_per_nm};
use std::path::Path;
use stead_disk::input::InputError;
use stead_model::robot::SpringModel;

/// The stiffness of another arm.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Borrowed {
    /// The name of the arm, as its file states it.
    pub arm: String,
    /// Where its numbers come from, as its file states it.
    pub source: String,
    /// What the springs stand for, where the file states it.
    pub model: Option<SpringModel>,
    /// The lines of each joint: key and value, and what is to be said of it.
    pub lines: [String; 6],
}

impl Borrowed {
    /// The stiffness of a shipped arm.
    ///
    /// # Errors
    /// [`InputError`] where there is no arm of this name.
    pub fn of(name: &str) -> Result<Self, InputError> {
        let (file, _) = lender(name).map_err(|no| {
            let error = InputError::new(Path::new("--stiffness-like"), no.problem).found(super::xml::quoted(name));
            error.allowed(no.allowed)
        })?;
        let model = file.stiffness_model.map(|word| word.0);
        let is_full = model == Some(SpringModel::Full);
        let lines = |row: &JointRow| match is_full {
            true => [line(row), normal_lines(row)].concat(),
            false => line(row),
        };
        let lines = std::array::from_fn(|k| file.joints.get(k).map(lines).unwrap_or_default());
        Ok(Self { arm: file.name, source: file.source, model, lines })
    }
}

/// The springs of a row normal to its axis, a line each behind that of the axis.
fn normal_lines(row: &JointRow) -> String {
    let pair = |[x, y]: [f64; 2]| if x == y { format!("{x:?}") } else { format!("[{x:?}, {y:?}]") };
    let mut lines = String::new();
    if let Some(stiffness) = row.orthogonal_stiffness_mnm_per_rad {
        lines += &format!("\northogonal_stiffness_mnm_per_rad = {}", pair(stiffness.both().map(|one| one.written())));
    }
    if let Some(compliance) = row.orthogonal_compliance_urad_per_nm {
        lines += &format!("\northogonal_compliance_urad_per_nm = {}", pair(compliance.both().map(|one| one.written())));
    }
    if let Some(bearing) = row.bearing_mm {
        lines += &format!("\nbearing_mm = {:?}", bearing.written());
    }
    lines
}

/// The key that a row states its stiffness by. Of a range, which belongs to the limits of its own arm, the middle.
fn line(row: &JointRow) -> String {
    match (row.stiffness_mnm_per_rad, row.compliance_urad_per_nm) {
        (Some(stiffness), _) => format!("stiffness_mnm_per_rad = {:?}", stiffness.written()),
        (None, Some(OneOrRange::One(compliance))) => format!("compliance_urad_per_nm = {:?}", compliance.written()),
        (None, Some(OneOrRange::Pair(range))) => {
            let [from, to] = range.0.map(|end| end.written());
            let middle = lent_urad_per_nm(row).unwrap_or_default();
            format!("compliance_urad_per_nm = {middle:?}   # the middle of {from:?} to {to:?}")
        }
        (None, None) => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::shipped_arms;

    #[test]
    fn every_shipped_arm_with_stiffness_has_six_lines_and_a_source() {
        for arm in shipped_arms().unwrap() {
            let borrowed = Borrowed::of(arm.name);
            assert_eq!(borrowed.is_ok(), arm.has_stiffness, "{}", arm.name);
            let Ok(borrowed) = borrowed else { continue };
            assert!(borrowed.lines.iter().all(|line| line.contains(" = ")), "{borrowed:?}");
            assert!(!borrowed.source.is_empty());
        }
        assert_eq!(Borrowed::of("kuka-kr270-2").unwrap().lines[1], "stiffness_mnm_per_rad = 3.32");
        let full = Borrowed::of("staubli-tx200-huynh").unwrap();
        assert_eq!(full.model, Some(SpringModel::Full));
        let normal = "stiffness_mnm_per_rad = 3.0\northogonal_stiffness_mnm_per_rad = [2.3, 3.1]\nbearing_mm = -621.0";
        assert_eq!(full.lines[3], normal);
        assert!(Borrowed::of("name:kuka-kr270-r2700").unwrap().lines[1].starts_with("compliance_urad_per_nm = 0.29 "));
    }

    #[test]
    fn an_arm_that_is_not_shipped_or_has_no_stiffness_is_refused() {
        let message = Borrowed::of("kr270").unwrap_err().to_string();
        assert!(message.starts_with("--stiffness-like: is no shipped arm, found \"kr270\"; allowed: "), "{message}");
        let message = Borrowed::of("abb-irb120").unwrap_err().to_string();
        assert!(message.contains("is an arm without stiffness, found \"abb-irb120\""), "{message}");
    }
}
