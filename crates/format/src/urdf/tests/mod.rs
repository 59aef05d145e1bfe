//! Imported rows against the URDF and against the arms that fixtures are made of; what is refused; fixtures with
//! mutations.

mod arms;
mod collision;
mod mutations;
mod postures;
mod refusals;
mod rows;
mod stand;
mod visual;

use super::tree::{Chain, Tree};
use super::*;
use crate::robot::robot_from;
use crate::toml_file::TomlFile;
use stead_model::robot::{Joint, Robot};

const FIXTURES: [(&str, &str); 4] = [
    ("kuka", include_str!("../fixtures/kuka.urdf")),
    ("abb", include_str!("../fixtures/abb.urdf")),
    ("fanuc", include_str!("../fixtures/fanuc.urdf")),
    ("staubli", include_str!("../fixtures/staubli.urdf")),
];

fn fixture(name: &str) -> String {
    FIXTURES.iter().find(|(known, _)| *known == name).unwrap().1.to_owned()
}

fn import(text: &str) -> Result<ImportedRobot, InputError> {
    import_robot_text(Path::new("arm.urdf"), text, &ImportOptions::default())
}

/// The robot of an imported file once its six stiffness lines are filled in.
fn filled(imported: &ImportedRobot) -> Robot {
    assert_eq!(imported.text.matches("# stiffness_mnm_per_rad = ?").count(), 6);
    let text = imported.text.replace("# stiffness_mnm_per_rad = ?", "stiffness_mnm_per_rad = 1.0");
    let file = TomlFile::new(Path::new("arm.toml"), text.into_bytes()).unwrap();
    robot_from(&file).unwrap_or_else(|error| panic!("{error}"))
}
