//! Shapes of links: where the URDF has them, in the frames of the rows.

use super::super::forward::link_at;
use super::*;
use crate::read_robot;
use crate::surroundings::{SurroundingsFile, read_scene};
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stead_cell::{Attachment, Solid};
use stead_model::robot::testing::spindle;
use stead_numerics::rotation::rotation_from_zyx;

/// A wedge of 100 x 60 x 40 mm, as a file in mm and as one in m.
pub(super) fn fixture_folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let meshes = folder.path().join("wide_arm_k_support/meshes/collision");
    std::fs::create_dir_all(&meshes).unwrap();
    std::fs::create_dir_all(folder.path().join("wide_arm_k_support/urdf")).unwrap();
    let wedge = include_str!("../../mesh/fixtures/wedge.obj");
    std::fs::write(meshes.join("wedge.obj"), wedge).unwrap();
    std::fs::write(meshes.join("wedge.dae"), include_str!("../../mesh/fixtures/wedge.dae")).unwrap();
    let in_metres: String = wedge.lines().fold(String::new(), |text, line| match line.strip_prefix("v ") {
        Some(numbers) => {
            let numbers: Vec<String> =
                numbers.split(' ').map(|number| (number.parse::<f64>().unwrap() / 1e3).to_string()).collect();
            format!("{text}v {}\n", numbers.join(" "))
        }
        None => format!("{text}{line}\n"),
    });
    std::fs::write(meshes.join("metres.OBJ"), in_metres).unwrap();
    // An angle of two plates, closed: not convex.
    let corner = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0.2 1 0\nv 0.2 0.2 0\nv 0 0.2 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0.2 1 1\nv 0.2 0.2 1\nv 0 0.2 1\n\
                  f 5 3 2 1 6\nf 5 4 3\nf 11 12 7 8 9\nf 11 9 10\nf 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n";
    std::fs::write(meshes.join("corner.obj"), corner).unwrap();
    folder
}

pub(super) const PACKAGE: &str = "package://wide_arm_k_support/meshes/collision";

/// The fixture with a `<collision>` in a link.
pub(super) fn with(text: &str, link: &str, geometry: &str) -> String {
    let tag = format!("<link name=\"{link}\">");
    assert!(text.contains(&tag), "{tag}");
    let collision = "<collision><origin xyz=\"0.1 -0.2 0.3\" rpy=\"0.4 -0.5 0.6\"/><geometry>";
    text.replacen(&tag, &format!("{tag}{collision}{geometry}</geometry></collision>"), 1)
}

/// The fixture with a `<visual>` in a link.
pub(super) fn with_visual(text: &str, link: &str, geometry: &str, material: &str) -> String {
    let tag = format!("<link name=\"{link}\">");
    assert!(text.contains(&tag), "{tag}");
    // Behind those before.
    let start = text.find(&tag).unwrap();
    let end = start + text[start..].find("</link>").unwrap();
    let visual = format!("<visual><geometry>{geometry}</geometry>{material}</visual>");
    format!("{}{visual}{}", &text[..end], &text[end..])
}

fn shaped() -> String {
    let mesh = |name: &str, scale: &str| format!("<mesh filename=\"{PACKAGE}/{name}\"{scale}/>");
    let mut text = fixture("kuka");
    for (link, geometry) in [
        ("base_link", "<box size=\"0.5 0.6 0.2\"/>".to_owned()),
        ("link_1", "<sphere radius=\"0.3\"/>".to_owned()),
        ("link_2", mesh("wedge.obj", " scale=\"0.001 0.001 0.001\"")),
        ("link_3", mesh("metres.OBJ", "")),
        ("link_4", "<cylinder radius=\"0.1\" length=\"0.5\"/>".to_owned()),
        ("link_5", mesh("corner.obj", " scale=\"0.1 0.1 0.2\"")),
        ("link_6", mesh("wedge.ply", "")),
    ] {
        text = with(&text, link, &geometry);
    }
    text
}

pub(super) fn import_in(folder: &Path, text: &str) -> Result<ImportedRobot, InputError> {
    let file = folder.join("wide_arm_k_support/urdf/arm.urdf");
    std::fs::write(&file, text).unwrap();
    import_robot(&file, &ImportOptions { collision: true, ..ImportOptions::default() })
}

/// Points of the shapes, moved by the URDF's own joints, are where the rows move them.
#[test]
fn shapes_are_where_the_urdf_has_them_in_every_posture() {
    let folder = fixture_folder();
    let imported = import_in(folder.path(), &shaped()).unwrap_or_else(|error| panic!("{error}"));
    let shapes = imported.link_shapes.as_ref().unwrap();
    let urdf = Urdf::parse(Path::new("arm.urdf"), shaped()).unwrap();
    let tree = Tree::new(&urdf).unwrap();
    let chain = Chain::new(&urdf, &tree, None, None).unwrap();
    let robot = filled(&imported);
    let origin = Pose { rotation: rotation_from_zyx([0.6, -0.5, 0.4]), translation: Vector3::new(0.1, -0.2, 0.3) };
    let mut random = ChaCha8Rng::seed_from_u64(17);
    for _ in 0..20 {
        let q: [f64; 6] = std::array::from_fn(|_| random.random_range(-1.5..1.5));
        let theta: [f64; 6] =
            std::array::from_fn(|k| imported.rows[k].sign * q[k] + imported.rows[k].offset_deg.to_radians());
        let frames = robot.link_frames(&theta);
        for shape in &shapes.shapes {
            let (base_from_frame, base_from_link) = match shape.shape.attached {
                Attachment::Base => (Pose::identity(), Pose::identity()),
                Attachment::Link(number) => {
                    let joint = chain.moving[usize::from(number) - 1];
                    let last = chain.path.iter().position(|other| *other == joint).unwrap();
                    (frames[usize::from(number) - 1], link_at(&urdf, &chain, &q, last))
                }
                other => panic!("{other}"),
            };
            let by_rows = imported.link_from_base.then(&base_from_frame).then(&shape.shape.pose);
            let middle = match &shape.shape.solid {
                // The box around a mesh whose scale is neither m nor mm.
                Solid::Box(edges) if shape.shape.name == "link_5 shape" => edges / 2.0,
                _ => Vector3::zeros(),
            };
            let by_urdf =
                base_from_link.then(&origin).then(&Pose { rotation: Matrix3::identity(), translation: middle });
            for point in [Vector3::zeros(), Vector3::new(0.1, 0.0, 0.04), Vector3::new(-0.3, 0.2, 0.1)] {
                let off = (by_rows.point(&point) - by_urdf.point(&point)).norm();
                assert!(off < 1e-9, "{}: {off}", shape.shape.name);
            }
        }
    }
}

#[test]
fn forms_names_notes_and_pairs_are_those_of_the_urdf() {
    let folder = fixture_folder();
    let imported = import_in(folder.path(), &shaped()).unwrap();
    let shapes = imported.link_shapes.unwrap();
    let solid = |name: &str| {
        let found = shapes.shapes.iter().find(|shape| shape.shape.name == name);
        found.unwrap_or_else(|| panic!("{name} in {shapes:?}")).shape.solid.clone()
    };
    assert_eq!(solid("base_link"), Solid::Box(Vector3::new(0.5, 0.6, 0.2)));
    assert_eq!(solid("link_1 shape"), Solid::Capsule { radius: 0.3, length: 0.0 });
    assert_eq!(solid("link_4 shape"), Solid::Cylinder { radius: 0.1, length: 0.5 });
    assert_eq!(solid("link_5 shape"), Solid::Box(Vector3::new(0.1, 0.1, 0.2)));
    for name in ["link_2 shape", "link_3 shape"] {
        let Solid::Hull(mesh) = solid(name) else { panic!("{name}") };
        assert!((mesh.vertices()[2] - Vector3::new(0.1, 0.06, 0.0)).norm() < 1e-12);
    }
    let notes = shapes.notes.join("\n");
    for part in [
        "none of STL, OBJ and DAE",
        "scaled by [0.1, 0.1, 0.2]: the box around it",
        "link \"link_6\" has no <collision>",
    ] {
        assert!(notes.contains(part), "{part} in {notes}");
    }
    let corner = with(&fixture("kuka"), "link_5", &format!("<mesh filename=\"{PACKAGE}/corner.obj\"/>"));
    let imported = import_in(folder.path(), &corner).unwrap();
    let shapes = imported.link_shapes.unwrap();
    assert!(matches!(shapes.shapes[..], [LinkShape { shape: stead_cell::Shape { solid: Solid::Mesh(_), .. }, .. }]));
    assert!(shapes.notes.iter().any(|note| note.contains("is not convex: it is taken as it is")), "{:?}", shapes.notes);
}

/// What is written is read back as what was imported, from a run beside it.
#[test]
fn the_file_of_the_shapes_is_read_by_a_run() {
    let folder = fixture_folder();
    let mut text = shaped();
    // A forearm that always touches all others.
    text = with(&text, "link_4", "<sphere radius=\"5\"/>");
    let imported = import_in(folder.path(), &text).unwrap();
    let shapes = imported.link_shapes.clone().unwrap();
    assert!(!shapes.ignored.is_empty());
    let run = tempfile::tempdir().unwrap();
    let out = run.path().join("arms/imported.toml");
    imported.write(&out, Existing::Kept).unwrap();
    let cell = run.path().join("arms/imported-cell.toml");
    assert!(cell.is_file());
    let robot =
        std::fs::read_to_string(&out).unwrap().replace("# stiffness_mnm_per_rad = ?", "stiffness_mnm_per_rad = 1.0");
    std::fs::write(&out, robot).unwrap();
    let file = run.path().join("run.toml");
    std::fs::write(&file, "surroundings = 'arms/imported-cell.toml'\n").unwrap();
    let (source, robot) = (TomlFile::read(&file).unwrap(), read_robot(&out).unwrap());
    let own = SurroundingsFile::default();
    let read = read_scene(own, &source.parse().unwrap().root(), &robot, &spindle(), &[]);
    let scene = read.unwrap_or_else(|error| panic!("{error}")).scene.unwrap();
    assert_eq!(scene.surroundings().shapes().len(), shapes.shapes.len());
    for (read, written) in scene.surroundings().shapes().iter().zip(&shapes.shapes) {
        let written = &written.shape;
        assert_eq!((&read.name, read.attached, &read.solid), (&written.name, written.attached, &written.solid));
        assert!((read.pose.translation - written.pose.translation).norm() < 1e-12);
        assert!((read.pose.rotation - written.pose.rotation).norm() < 1e-12);
    }
    // There already.
    let message = imported.write(&run.path().join("arms/imported.toml"), Existing::Kept).unwrap_err().to_string();
    assert!(message.contains("is there already"), "{message}");
}

#[test]
fn a_collision_shape_that_cannot_be_is_refused_where_it_is_asked_for() {
    let folder = fixture_folder();
    for (geometry, parts) in [
        ("<box size=\"1 0 1\"/>", ["<box>, attribute size: ", "three lengths above 0"]),
        ("<sphere radius=\"-1\"/>", ["<sphere>, attribute radius: ", "a length above 0"]),
        ("<cylinder radius=\"1\"/>", ["<cylinder>, attribute length: ", "a length above 0"]),
        ("<cone/>", ["<geometry>: ", "<box>, <cylinder>, <sphere> or <mesh>"]),
        ("<mesh filename=\"a.stl\" scale=\"1 1 0\"/>", ["<mesh>, attribute scale: ", "not 0"]),
    ] {
        let text = with(&fixture("kuka"), "link_2", geometry);
        assert!(import(&text).is_ok());
        let message = import_in(folder.path(), &text).unwrap_err().to_string();
        for part in parts.iter().chain(&["arm.urdf:18: link \"link_2\"", "; allowed: "]) {
            assert!(message.contains(part), "{part} in {message}");
        }
    }
    let message = import_in(folder.path(), &fixture("kuka")).unwrap_err().to_string();
    assert!(message.contains("has no <collision> shape"), "{message}");
}

#[test]
fn parts_that_are_near_in_every_posture_are_ignored_and_noted() {
    let folder = fixture_folder();
    let sphere = |text: &str, link: &str, x: f64| {
        let tag = format!("<link name=\"{link}\">");
        let geometry = "<geometry><sphere radius=\"0.028\"/></geometry>";
        let collision = format!("<collision><origin xyz=\"{x} 0 0\" rpy=\"0 0 0\"/>{geometry}</collision>");
        text.replacen(&tag, &format!("{tag}{collision}"), 1)
    };
    // Around the wrist, 7 to 29 mm apart; and one on the upper arm that comes and goes.
    let text = sphere(&sphere(&sphere(&fixture("kuka"), "link_4", -0.07), "link_6", 0.015), "link_2", 0.3);
    let imported = import_in(folder.path(), &text).unwrap();
    let shapes = imported.link_shapes.as_ref().unwrap();
    let wrist = ["link_6 shape", "link_4 shape"].map(str::to_owned);
    assert_eq!(shapes.ignored, [wrist]);
    let note = "\"link_6 shape\" and \"link_4 shape\" are within 50 mm of each other in every posture tried";
    assert!(shapes.notes.iter().any(|text| text.starts_with(note)), "{:?}", shapes.notes);
    let cell = imported.files(&folder.path().join("arm.toml")).remove(1).1;
    assert!(
        cell.contains("are near each other in every posture") && cell.contains("[\"link_6 shape\", \"link_4"),
        "{cell}"
    );
}
