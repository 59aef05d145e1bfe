//! Where the robot stands: fixed joints before the base link as `[mount]` of a run.

use super::collision::{fixture_folder, import_in, with};
use super::*;
use crate::read_robot;
use crate::surroundings::{SurroundingsFile, read_mount, read_scene};
use nalgebra::Vector3;
use stead_cell::Attachment;
use stead_model::robot::testing::spindle;
use stead_numerics::rotation::rotation_from_zyx;

/// The fixture on a pedestal that leans and is turned, on a platform: origins as roll, pitch and yaw.
fn on_pedestal(text: &str) -> String {
    let before = "<link name=\"world\"/><link name=\"pedestal\"/>\
        <joint name=\"platform\" type=\"fixed\"><parent link=\"world\"/><child link=\"pedestal\"/>\
        <origin xyz=\"2 -0.5 0.4\" rpy=\"0.1 -0.2 0.7\"/></joint>\
        <joint name=\"stand\" type=\"fixed\"><parent link=\"pedestal\"/><child link=\"base_link\"/>\
        <origin xyz=\"0 0.1 0.6\" rpy=\"0.3 0.2 -1.1\"/></joint>";
    let (head, rest) = text.split_at(text.find("<link").unwrap());
    format!("{head}{before}{rest}")
}

/// The same by hand.
fn world_from_base_link() -> Pose<f64> {
    let pose = |xyz: [f64; 3], [roll, pitch, yaw]: [f64; 3]| Pose {
        rotation: rotation_from_zyx([yaw, pitch, roll]),
        translation: Vector3::from(xyz),
    };
    pose([2.0, -0.5, 0.4], [0.1, -0.2, 0.7]).then(&pose([0.0, 0.1, 0.6], [0.3, 0.2, -1.1]))
}

#[test]
fn a_run_with_the_shapes_has_the_robot_where_the_urdf_has_it() {
    let folder = fixture_folder();
    let boxed = |text: &str, link: &str| with(text, link, "<box size=\"0.5 0.6 0.2\"/>");
    let text = boxed(&boxed(&fixture("kuka"), "base_link"), "link_4");
    // The pedestal has the same box at its origin.
    let geometry = "<collision><geometry><box size=\"0.3 0.3 0.6\"/></geometry></collision>";
    let tag = "<link name=\"pedestal\"";
    let text = on_pedestal(&text).replace(&format!("{tag}/>"), &format!("{tag}>{geometry}</link>"));
    let imported = import_in(folder.path(), &text).unwrap_or_else(|error| panic!("{error}"));
    let note = "the robot stands in link \"world\" at xyz_mm = [";
    assert!(imported.notes.iter().any(|text| text.starts_with(note)), "{:?}", imported.notes);
    let out = folder.path().join("arm.toml");
    imported.write(&out, Existing::Kept).unwrap();
    let robot =
        std::fs::read_to_string(&out).unwrap().replace("# stiffness_mnm_per_rad = ?", "stiffness_mnm_per_rad = 1.0");
    std::fs::write(&out, robot).unwrap();
    let file = folder.path().join("run.toml");
    std::fs::write(&file, "surroundings = 'arm-cell.toml'\n").unwrap();
    let source = TomlFile::read(&file).unwrap();
    let document = source.parse().unwrap();
    let mount = read_mount(None, &document.root()).unwrap().unwrap();
    let robot = read_robot(&out).unwrap().mounted(&mount);
    // Flange by the rows where the run mounts them, and by the URDF.
    let (urdf, values) = (Urdf::parse(Path::new("arm.urdf"), text).unwrap(), [0.4, -1.1, 1.3, 0.7, -0.6, 2.0]);
    let chain = Chain::new(&urdf, &Tree::new(&urdf).unwrap(), None, None).unwrap();
    let theta = std::array::from_fn(|k| imported.rows[k].sign * values[k] + imported.rows[k].offset_deg.to_radians());
    let by_rows = robot.forward(&theta).then(&imported.flange_from_tip);
    let by_urdf = world_from_base_link().then(&forward::tip_at(&urdf, &chain, &values));
    assert!((by_rows.translation - by_urdf.translation).norm() < 1e-9, "{by_rows:?} {by_urdf:?}");
    assert!((by_rows.rotation - by_urdf.rotation).norm() < 1e-9, "{by_rows:?} {by_urdf:?}");
    // What stands is in the cell, the foot and the pedestal alike.
    let read = read_scene(SurroundingsFile::default(), &document.root(), &robot, &spindle(), &[]).unwrap();
    let shapes = read.scene.as_ref().unwrap().surroundings().shapes();
    let at = |name: &str| shapes.iter().find(|shape| shape.name == name).unwrap();
    assert!([at("pedestal"), at("base_link")].iter().all(|shape| shape.attached == Attachment::Base));
    let foot = world_from_base_link().point(&Vector3::new(0.1, -0.2, 0.3));
    assert!((at("base_link").pose.translation - foot).norm() < 1e-9);
    assert!((at("pedestal").pose.translation - Vector3::new(2.0, -0.5, 0.4)).norm() < 1e-9);
    // A second place is one too many.
    std::fs::write(&file, "surroundings = 'arm-cell.toml'\n[mount]\nxyz_mm = [0, 0, 0]\n").unwrap();
    let source = TomlFile::read(&file).unwrap();
    let document = source.parse().unwrap();
    let own: crate::mount::MountTable = toml::from_str("xyz_mm = [0, 0, 0]").unwrap();
    let message = read_mount(Some(&own), &document.root()).unwrap_err().to_string();
    assert!(
        message.contains("arm-cell.toml:") && message.contains("mount: is stated in the run file too"),
        "{message}"
    );
}

#[test]
fn a_robot_on_the_floor_and_one_that_is_carried_have_no_mount() {
    let imported = import(&fixture("kuka")).unwrap();
    assert_eq!(imported.mount, None);
    assert!(!imported.notes.iter().any(|note| note.contains("stands in")));
    let moved = on_pedestal(&fixture("kuka"));
    let imported = import(&moved).unwrap();
    let note = imported.notes.iter().find(|note| note.contains("for [mount] of a run")).unwrap();
    assert!(note.contains("rpy_deg = ["), "{note}");
    let still = moved
        .replace("xyz=\"2 -0.5 0.4\" rpy=\"0.1 -0.2 0.7\"", "")
        .replace("xyz=\"0 0.1 0.6\" rpy=\"0.3 0.2 -1.1\"", "");
    assert_eq!(import(&still).unwrap().mount, None);
    let rail = "name=\"platform\" type=\"prismatic\"><limit lower=\"0\" upper=\"2\" velocity=\"1\" effort=\"0\"/>";
    let text = moved.replace("name=\"platform\" type=\"fixed\">", rail);
    let options = ImportOptions { base_link: Some("base_link"), ..ImportOptions::default() };
    let carried = import_robot_text(Path::new("arm.urdf"), &text, &options).unwrap();
    assert_eq!(carried.mount, None);
    let note = "link \"base_link\" is carried by joint \"platform\", which moves";
    assert!(carried.notes.iter().any(|text| text.starts_with(note)), "{:?}", carried.notes);
}
