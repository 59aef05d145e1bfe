//! Joint stiffness for an arm whose URDF has none: the values of a shipped arm, with their source.

use crate::input::InputError;
use crate::robot::{JointRow, OneOrRange, RobotFile};
use crate::toml_file::TomlFile;
use std::path::Path;

/// The arms whose values may be taken, with their files.
const ARMS: [(&str, &str); 7] = [
    ("kuka-kr100-ha", include_str!("../../../../configs/robots/kuka-kr100-ha.toml")),
    ("kuka-kr120-r3900", include_str!("../../../../configs/robots/kuka-kr120-r3900.toml")),
    ("kuka-kr270-2", include_str!("../../../../configs/robots/kuka-kr270-2.toml")),
    ("kuka-kr270-r2700", include_str!("../../../../configs/robots/kuka-kr270-r2700.toml")),
    ("kuka-kr360-l240", include_str!("../../../../configs/robots/kuka-kr360-l240.toml")),
    ("kuka-kr500", include_str!("../../../../configs/robots/kuka-kr500.toml")),
    ("staubli-tx200", include_str!("../../../../configs/robots/staubli-tx200.toml")),
];

/// The stiffness of another arm.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Borrowed {
    /// The name of the arm, as its file states it.
    pub arm: String,
    /// Where its numbers come from, as its file states it.
    pub source: String,
    /// The line of each joint: key and value, and what is to be said of it.
    pub lines: [String; 6],
}

impl Borrowed {
    /// The stiffness of a shipped arm.
    ///
    /// # Errors
    /// [`InputError`] where there is no arm of this name.
    pub fn of(name: &str) -> Result<Self, InputError> {
        let Some((_, text)) = ARMS.iter().find(|(known, _)| *known == name) else {
            let names = ARMS.map(|(known, _)| known);
            let error = InputError::new(Path::new("--stiffness-like"), "is no shipped arm");
            return Err(error.found(super::xml::quoted(name)).allowed(names.join(", ")));
        };
        let source = TomlFile::new(Path::new(name), text.as_bytes().to_vec())?;
        let document = source.parse()?;
        let file: RobotFile = document.read()?;
        let lines = std::array::from_fn(|k| file.joints.get(k).map(line).unwrap_or_default());
        Ok(Self { arm: file.name, source: file.source, lines })
    }
}

/// The key that a row states its stiffness by. Of a range, which belongs to the limits of its own arm, the middle.
fn line(row: &JointRow) -> String {
    match (row.stiffness_mnm_per_rad, row.compliance_urad_per_nm) {
        (Some(stiffness), _) => format!("stiffness_mnm_per_rad = {:?}", stiffness.written()),
        (None, Some(OneOrRange::One(compliance))) => format!("compliance_urad_per_nm = {:?}", compliance.written()),
        (None, Some(OneOrRange::Range(range))) => {
            let [from, to] = range.0.map(|end| end.written());
            let middle = ((from + to) / 2.0 * 1e9).round() / 1e9;
            format!("compliance_urad_per_nm = {middle:?}   # the middle of {from:?} to {to:?}")
        }
        (None, None) => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_arm_has_six_lines_and_a_source() {
        for (name, _) in ARMS {
            let borrowed = Borrowed::of(name).unwrap();
            assert!(borrowed.lines.iter().all(|line| line.contains(" = ")), "{borrowed:?}");
            assert!(!borrowed.source.is_empty());
        }
        assert_eq!(Borrowed::of("kuka-kr270-2").unwrap().lines[1], "stiffness_mnm_per_rad = 3.32");
        assert!(Borrowed::of("kuka-kr270-r2700").unwrap().lines[1].starts_with("compliance_urad_per_nm = 0.29 "));
    }

    #[test]
    fn an_unknown_arm_is_refused_with_the_known_ones() {
        let message = Borrowed::of("kr270").unwrap_err().to_string();
        assert!(message.starts_with("--stiffness-like: is no shipped arm, found \"kr270\"; allowed: kuka-kr100-ha, "));
    }
}
