//! What links look like: kept where it can be drawn, else noted by name.

use super::collision::{PACKAGE, fixture_folder, import_in, with, with_visual};
use super::*;
use crate::read_robot;
use crate::surroundings::{SurroundingsFile, read_scene};
use crate::toml_file::TomlFile;
use nalgebra::Vector3;
use stead_cell::Attachment;
use stead_model::robot::testing::spindle;

fn mesh(name: &str, more: &str) -> String {
    format!("<mesh filename=\"{PACKAGE}/{name}\"{more}/>")
}

/// The fixture without what it says of looks: its files are not there.
fn bare() -> String {
    let mut text = fixture("kuka");
    while let (Some(from), Some(to)) = (text.find("<visual>"), text.find("</visual>")) {
        text.replace_range(from..to + "</visual>".len(), "");
    }
    text
}

/// The fixture with collision boxes, and what each link looks like.
fn looking(visuals: &[(&str, String, &str)]) -> String {
    let boxes =
        ["link_1", "link_2"].into_iter().fold(bare(), |text, link| with(&text, link, "<box size=\"0.1 0.1 0.1\"/>"));
    visuals.iter().fold(boxes, |text, (link, geometry, material)| with_visual(&text, link, geometry, material))
}

#[test]
fn meshes_that_can_be_drawn_are_kept_and_read_by_a_run() {
    let folder = fixture_folder();
    let mm = " scale=\"0.001 0.001 0.001\"";
    let red = "<material name=\"own\"><color rgba=\"0.8 0.1 0.25 1\"/></material>";
    let text = looking(&[
        ("base_link", mesh("wedge.obj", mm), red),
        ("link_2", mesh("metres.OBJ", ""), "<material name=\"paint\"/>"),
        ("link_2", mesh("wedge.obj", mm), ""),
    ]);
    let paint = "<material name=\"paint\"><color rgba=\"0 0.5 1 1\"/></material></robot>";
    let imported = import_in(folder.path(), &text.replace("</robot>", paint)).unwrap_or_else(|e| panic!("{e}"));
    assert!(!imported.notes.iter().any(|note| note.contains("<visual>")), "{:?}", imported.notes);
    let out = folder.path().join("arms/arm.toml");
    imported.write(&out, Existing::Kept).unwrap();
    let robot =
        std::fs::read_to_string(&out).unwrap().replace("# stiffness_mnm_per_rad = ?", "stiffness_mnm_per_rad = 1.0");
    std::fs::write(&out, robot).unwrap();
    let file = folder.path().join("run.toml");
    std::fs::write(&file, "surroundings = 'arms/arm-cell.toml'\n").unwrap();
    let (source, robot) = (TomlFile::read(&file).unwrap(), read_robot(&out).unwrap());
    let read = read_scene(SurroundingsFile::default(), &source.parse().unwrap().root(), &robot, &spindle(), &[]);
    let read = read.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(read.inputs.iter().filter(|input| input.role == "mesh").count(), 2);
    let scene = read.scene.unwrap();
    let visuals = scene.surroundings().visuals();
    let seen: Vec<_> = visuals.iter().map(|of| (of.name.as_str(), of.attached, of.color)).collect();
    let expected = [
        ("base_link visual", Attachment::Base, Some([0.8, 0.1, 0.25])),
        ("link_2 visual", Attachment::Link(2), Some([0.0, 0.5, 1.0])),
        ("link_2 visual 2", Attachment::Link(2), None),
    ];
    assert_eq!(seen, expected);
    for (read, written) in visuals.iter().zip(&imported.link_visuals) {
        assert_eq!(read.mesh, written.visual.mesh);
        assert!((read.pose.translation - written.visual.pose.translation).norm() < 1e-12);
        assert!((read.mesh.vertices()[2] - Vector3::new(0.1, 0.06, 0.0)).norm() < 1e-12);
    }
}

/// The wedge is 100 x 60 x 40 mm, its file in cm.
#[test]
fn a_dae_is_drawn_in_the_unit_that_it_states() {
    let folder = fixture_folder();
    let text = looking(&[("link_1", mesh("wedge.dae", " scale=\"0.001 0.001 0.001\""), "")]);
    let imported = import_in(folder.path(), &text).unwrap();
    let [visual] = &imported.link_visuals[..] else { panic!("{:?}", imported.notes) };
    let size = visual.visual.mesh.vertices().iter().fold(Vector3::zeros(), |size: Vector3<f64>, at| size.sup(at));
    assert!((size - Vector3::new(0.1, 0.06, 0.04)).norm() < 1e-12, "{size}");
    let out = folder.path().join("arms/arm.toml");
    imported.write(&out, Existing::Kept).unwrap();
    let cell = std::fs::read_to_string(folder.path().join("arms/arm-cell.toml")).unwrap();
    assert!(cell.contains("wedge.dae\"\nxyz_mm"), "{cell}");
}

#[test]
fn meshes_that_cannot_be_drawn_are_noted_by_name() {
    let folder = fixture_folder();
    let meshes = folder.path().join("wide_arm_k_support/meshes/collision");
    std::fs::write(meshes.join("broken.dae"), "<COLLADA><scene>").unwrap();
    std::fs::write(meshes.join("broken.obj"), "v 0 0 0\nf 1 2 3\n").unwrap();
    std::fs::write(meshes.join("nan.obj"), "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    for (geometry, parts) in [
        (mesh("nowhere.stl", ""), vec!["nowhere.stl", "is not found"]),
        (mesh("wedge.ply", ""), vec!["wedge.ply", "none of STL, OBJ and DAE"]),
        (mesh("broken.dae", ""), vec!["broken.dae", "is no XML"]),
        (mesh("broken.obj", ""), vec!["broken.obj"]),
        (mesh("nan.obj", ""), vec!["nan.obj"]),
        (mesh("wedge.obj", " scale=\"0.001 -0.001 0.001\""), vec!["wedge.obj", "mirrored"]),
        (mesh("wedge.obj", " scale=\"2 2 2\""), vec!["wedge.obj", "a scale of [2.0, 2.0, 2.0]"]),
        (mesh("wedge.obj", " scale=\"nan 1 1\""), vec!["scale"]),
        (mesh("wedge.obj", " scale=\"1 0 1\""), vec!["scale"]),
        ("<sphere radius=\"0.1\"/>".to_owned(), vec!["it is no mesh"]),
        ("<cone/>".to_owned(), vec!["<geometry>"]),
    ] {
        let imported = import_in(folder.path(), &looking(&[("link_1", geometry.clone(), "")]));
        let imported = imported.unwrap_or_else(|error| panic!("{geometry}: {error}"));
        assert!(imported.link_visuals.is_empty(), "{geometry}");
        let note = imported.notes.iter().find(|note| note.starts_with("a <visual> of link \"link_1\" is not drawn: "));
        let note = note.unwrap_or_else(|| panic!("{geometry}: {:?}", imported.notes));
        assert!(parts.iter().all(|part| note.contains(part)) && !note.contains('\n'), "{note}");
    }
    // What is drawn of a link whose look cannot be read is its collision mesh.
    let text = with(&bare(), "link_2", &mesh("metres.OBJ", ""));
    let text = with_visual(&text, "link_2", &mesh("wedge.ply", ""), "");
    let imported = import_in(folder.path(), &text).unwrap();
    assert_eq!(imported.link_visuals.len(), 1);
    assert!(imported.notes.iter().any(|note| note == "link \"link_2\" is drawn by its collision mesh"));
}
