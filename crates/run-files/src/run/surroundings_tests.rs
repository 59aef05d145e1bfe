//! Shapes of a cell file, read by a run.

use crate::read_run;
use crate::testing::{RUN, folder};
use nalgebra::Vector3;
use std::path::Path;
use stead_cell::{Attachment, Solid, Zone};
use stead_format::testing::root;
use stead_numerics::monitor::Monitor;
use stead_numerics::rotation::rotation_from_zyx;
use stead_runs::Run;

/// A cell file with every key.
const CELL: &str = "[[shape]]
name = 'fence'
attached = 'base'
box_mm = [20, 4000, 2000]
xyz_mm = [1800, 0, 250]
[[shape]]
name = 'upper arm'
attached = 'link_2'
capsule_mm = { radius = 150, length = 1250 }
xyz_mm = [625, 0, 0]
rpy_deg = [0, 90, 0]
[[shape]]
name = 'spindle'
attached = 'flange'
cylinder_mm = { radius = 100, length = 400 }
xyz_mm = [0, 0, 250]
[[shape]]
name = 'part'
attached = 'workpiece'
mesh = 'meshes/wedge.stl'
xyz_mm = [-50, -30, -100]
[[shape]]
name = 'fixture'
attached = 'workpiece'
hull = 'meshes/wedge.obj'
unit = 'm'
[[keep_out]]
name = 'floor'
points = ['tool', 'wrist', 'elbow']
half_space = { xyz_mm = [0, 0, -700], normal = [0, 0, -2] }
[[keep_out]]
name = 'door'
points = ['tool']
box_mm = [1000, 200, 2000]
xyz_mm = [0, 2000, 0]
abc_deg = [45, 0, 0]
[collision]
clearance_mm = 25
ignore = [['upper arm', 'fence'], ['link_2', 'flange']]
";

/// The folder of a run, with meshes and a cell file beside it.
fn cell(text: &str) -> tempfile::TempDir {
    let folder = folder();
    let meshes = folder.path().join("cells/meshes");
    std::fs::create_dir_all(&meshes).unwrap();
    let fixtures = root().join("crates/format/src/mesh/fixtures");
    for name in ["wedge.stl", "wedge.obj"] {
        std::fs::copy(fixtures.join(name), meshes.join(name)).unwrap();
    }
    std::fs::write(folder.path().join("cells/cell.toml"), text).unwrap();
    folder
}

fn run(folder: &Path, head: &str, tables: &str) -> Result<Run, String> {
    let file = folder.join("run.toml");
    std::fs::write(&file, format!("{head}{RUN}{tables}")).unwrap();
    read_run(&file).map_err(|error| error.to_string().replace(&format!("{}/", folder.display()), ""))
}

const NAMED: &str = "surroundings = 'cells/cell.toml'\n";

#[test]
fn a_cell_is_read_with_its_meshes_and_joined_with_tables_of_the_run() {
    let folder = cell(CELL);
    let own = "[[shape]]\nname = 'pillar'\nattached = 'base'\ncylinder_mm = { radius = 100, length = 2000 }\nxyz_mm = [900, 900, 0]\n\
               [collision]\nignore = [['pillar', 'spindle']]\n";
    let read = run(folder.path(), NAMED, own).unwrap();
    let scene = read.problem.scene.clone().unwrap();
    let around = scene.surroundings();
    let names: Vec<&str> = around.shapes().iter().map(|shape| shape.name.as_str()).collect();
    assert_eq!(names, ["fence", "upper arm", "spindle", "part", "fixture", "pillar"]);
    assert_eq!(around.clearance(), 0.025);
    let [fence, arm, spindle, part, fixture, pillar] = around.shapes() else { panic!("six shapes") };
    assert_eq!((fence.attached, &fence.solid), (Attachment::Base, &Solid::Box(Vector3::new(0.02, 4.0, 2.0))));
    assert_eq!((arm.attached, &arm.solid), (Attachment::Link(2), &Solid::Capsule { radius: 0.15, length: 1.25 }));
    assert!((arm.pose.rotation - rotation_from_zyx([0.0, std::f64::consts::FRAC_PI_2, 0.0])).norm() < 1e-15);
    assert_eq!(arm.pose.translation, Vector3::new(0.625, 0.0, 0.0));
    assert_eq!(spindle.solid, Solid::Cylinder { radius: 0.1, length: 0.4 });
    let size = |solid: &Solid| solid.extent()[1] - solid.extent()[0];
    assert!((size(&part.solid) - Vector3::new(0.1, 0.06, 0.04)).norm() < 1e-12 && matches!(part.solid, Solid::Mesh(_)));
    assert!(
        (size(&fixture.solid) - Vector3::new(100.0, 60.0, 40.0)).norm() < 1e-9
            && matches!(fixture.solid, Solid::Hull(_))
    );
    for (a, b, is_ignored) in [(arm, fence, true), (arm, spindle, true), (pillar, spindle, true), (pillar, arm, false)]
    {
        assert_eq!(around.is_ignored(a, b), is_ignored, "{} {}", a.name, b.name);
    }
    let [floor, door] = around.zones() else { panic!("two zones") };
    assert_eq!(floor.points.len(), 3);
    assert_eq!(
        floor.zone,
        Zone::HalfSpace { point: Vector3::new(0.0, 0.0, -0.7), normal: Vector3::new(0.0, 0.0, -1.0) }
    );
    assert!(
        door.zone.distance(&Vector3::new(0.3, 2.3, 0.0)) < 0.0
            && door.zone.distance(&Vector3::new(0.3, 1.7, 0.0)) > 0.0
    );
    let inputs: Vec<(&str, &str)> = read.inputs.iter().map(|input| (input.role, input.name.as_str())).collect();
    let added = [("surroundings", "cells/cell.toml"), ("mesh", "meshes/wedge.stl"), ("mesh", "meshes/wedge.obj")];
    assert_eq!(inputs[3..], added);
    let fixtures = include_bytes!("../../../format/src/mesh/fixtures/wedge.stl");
    assert_eq!(read.inputs[4].sha256, stead_disk::input::sha256(fixtures));
    let notes = read.notes.join("\n");
    for part in [
        "\"fixture\" is 100000 mm long, and the robot reaches",
        "metres for millimetres?",
        "links 1, 3, 4, 5: the arm is not checked",
    ] {
        assert!(notes.contains(part), "{part} in {notes}");
    }
    assert!(!notes.contains("not closed"), "{notes}");
}

#[test]
fn a_run_without_shapes_has_no_scene_and_one_with_tables_alone_has_one() {
    let folder = cell("");
    assert!(run(folder.path(), "", "").unwrap().problem.scene.is_none());
    assert!(run(folder.path(), NAMED, "").unwrap().problem.scene.is_none());
    let pillar = "[[shape]]\nname = 'ball'\nattached = 'base'\ncapsule_mm = { radius = 100, length = 0 }\nxyz_mm = [0, 2500, 0]\n";
    let scene = run(folder.path(), "", pillar).unwrap().problem.scene.clone().unwrap();
    assert_eq!((scene.surroundings().clearance(), scene.unchecked_links()), (0.01, vec![1, 2, 3, 4, 5]));
    let wedge = "[[shape]]\nname = 'wedge'\nattached = 'workpiece'\nmesh = 'cells/meshes/wedge.stl'\nunit = 'm'\n";
    assert!(run(folder.path(), "", wedge).unwrap().problem.scene.is_some());
}

#[test]
fn what_looks_wrong_is_noted() {
    let folder = cell(CELL);
    let open: Vec<u8> = {
        // One triangle less.
        let mut bytes = include_bytes!("../../../format/src/mesh/fixtures/wedge.stl").to_vec();
        bytes.truncate(bytes.len() - 50);
        bytes[80] -= 1;
        bytes
    };
    std::fs::write(folder.path().join("open.stl"), open).unwrap();
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::fs::write(folder.path().join("small.obj"), obj).unwrap();
    // Two tetrahedra with an edge in common, the second with corners that rounding has moved.
    let touching = "v 0 0 0\nv 0 0 100\nv 100 0 0\nv 0 100 0\nv 0 0.00001 0\nv 0 0 100.00001\nv -100 0 0\nv 0 -100 0\n\
                    f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n";
    std::fs::write(folder.path().join("touching.obj"), touching).unwrap();
    let tables = "[[shape]]\nname = 'touching'\nattached = 'workpiece'\nmesh = 'touching.obj'\n\
                  [[shape]]\nname = 'open'\nattached = 'workpiece'\nmesh = 'open.stl'\n\
                  [[shape]]\nname = 'small'\nattached = 'workpiece'\nmesh = 'small.obj'\n";
    let notes = run(folder.path(), "", tables).unwrap().notes.join("\n");
    for part in [
        "the mesh of shape \"open\" is not closed",
        "the mesh of shape \"touching\" is made of 2 closed surfaces, some of which touch",
        "shape \"small\" is 1.00 mm long: is its mesh in metres (unit = \"m\")?",
    ] {
        assert!(notes.contains(part), "{part} in {notes}");
    }
    assert!(!notes.contains("\"touching\" is not closed"), "{notes}");
}

#[test]
fn each_broken_rule_names_file_line_field_value_and_what_is_allowed() {
    for (from, to, parts) in [
        ("'meshes/wedge.stl'", "'none.stl'", [":20: shape[4].mesh: ", "cannot be read", "found 'none.stl'"]),
        ("'link_2'", "'link_7'", [":8: shape[2].attached: ", "unknown frame", "found 'link_7'; allowed: \"base\""]),
        ("'link_2'", "'link_02'", [":8: shape[2].attached: ", "unknown frame", "found 'link_02'"]),
        ("'part'", "'fence'", [":18: shape[4].name: ", "another shape", "found 'fence'"]),
        ("'door'", "'part'", [":32: keep_out[2].name: ", "another shape or zone", "found 'part'"]),
        ("'part'", "'link_3'", [":18: shape[4].name: ", "is the name of a frame", "found 'link_3'"]),
        ("'part'", "' '", [":18: shape[4].name: ", "is blank", "a text"]),
        ("'part'", "\"a\\nb\"", [":18: shape[4].name: ", "control character", "one line"]),
        ("clearance_mm = 25", "clearance_mm = -1", [":38: collision.clearance_mm: ", "found -1", "not below 0"]),
        ("clearance_mm = 25", "clearance_mm = nan", [":38: collision.clearance_mm: ", "found nan", "finite"]),
        ("unit = 'm'", "box_mm = [1, 1, 1]", [":25: shape[5].hull: ", "second form beside box_mm", "exactly one"]),
        ("mesh = 'meshes/wedge.stl'\n", "", [":17: shape[4].box_mm: ", "no form", "exactly one of box_mm"]),
        ("radius = 100", "radius = 0", [":15: shape[3].cylinder_mm.radius: ", "found 0", "above 0"]),
        ("length = 1250", "length = -1", [":9: shape[2].capsule_mm.length: ", "found -1", "not below 0"]),
        ("[20, 4000, 2000]", "[20, 0, 2000]", [":4: shape[1].box_mm", "found 0", "above 0"]),
        ("xyz_mm = [0, 0, 250]", "unit = 'm'", [":16: shape[3].unit: ", "for a mesh file", "hull or mesh"]),
        ("unit = 'm'", "unit = 'inch'", [":26: shape[5].unit: ", "found 'inch'", "\"mm\" or \"m\""]),
        (
            "rpy_deg = [0, 90, 0]",
            "rpy_deg = [0, 90, 0]\nabc_deg = [0, 0, 0]",
            [":", "states an orientation beside", "exactly one"],
        ),
        ("['tool', 'wrist', 'elbow']", "[]", [":29: keep_out[1].points: ", "is empty", "\"tool\" or \"wrist\""]),
        ("['tool', 'wrist', 'elbow']", "['tool', 'hand']", [":29: keep_out[1].points", "is unknown", "\"elbow\""]),
        ("['tool', 'wrist', 'elbow']", "['tool', 'tool']", [":29: keep_out[1].points[2]: ", "twice", "found 'tool'"]),
        ("points = ['tool', 'wrist', 'elbow']\n", "", [":27: keep_out[1].points: ", "is missing", "\"tool\" or"]),
        (
            "half_space = {",
            "box_mm = [1, 1, 1]\nhalf_space = {",
            [":31: keep_out[1].half_space: ", "beside box_mm", "one of the two"],
        ),
        ("box_mm = [1000, 200, 2000]", "", [":31: keep_out[2].box_mm: ", "is missing", "half_space"]),
        (
            "normal = [0, 0, -2]",
            "normal = [0, 0, 0]",
            [":30: keep_out[1].half_space.normal: ", "no direction", "found [0, 0, 0]"],
        ),
        ("[0, 0, -2] }", "[0, 0, -2] }\nxyz_mm = [0, 0, 0]", [":31: keep_out[1].xyz_mm: ", "of a box", "half_space ="]),
        (
            "'upper arm', 'fence'",
            "'upper arm', 'gate'",
            [":39: collision.ignore[1][2]: ", "is no shape", "fence, upper arm, spindle"],
        ),
        (
            "'link_2', 'flange'",
            "'link_4', 'flange'",
            [":39: collision.ignore[2][1]: ", "is no shape", "found 'link_4'"],
        ),
        (
            "['upper arm', 'fence']",
            "['fence', 'fence']",
            [":39: collision.ignore[1]: ", "names one shape twice", "a shape is never held against itself"],
        ),
        ("['upper arm', 'fence']", "['upper arm']", [":39: collision.ignore", "2", "found"]),
        ("[collision]", "[collison]", [":37: collison: ", "nearest known one: collision", "allowed: shape, keep_out"]),
    ] {
        assert!(CELL.contains(from), "{from}");
        let folder = cell(&CELL.replacen(from, to, 1));
        let message = run(folder.path(), NAMED, "").unwrap_err();
        let parts = parts.iter().chain(&["cells/cell.toml", "; allowed: "]);
        parts.for_each(|part| assert!(message.contains(part), "{part} in {message}"));
    }
}

#[test]
fn what_two_files_say_together_is_located_in_the_run() {
    let folder = cell(CELL);
    for (head, tables, parts) in [
        (NAMED, "[collision]\nclearance_mm = 5\n", [":19: collision.clearance_mm: ", "another file too", "found 5"]),
        (
            "",
            "[collision]\nclearance_mm = 5\n",
            [":17: collision: ", "without anything that could collide", "[[shape]]"],
        ),
        (
            NAMED,
            "[[shape]]\nname = 'part'\nattached = 'base'\nbox_mm = [1, 1, 1]\n",
            [":19: shape[1].name: ", "another shape", "found 'part'"],
        ),
        ("surroundings = 'none.toml'\n", "", [":1: surroundings: ", "cannot be read", "found 'none.toml'"]),
    ] {
        let message = run(folder.path(), head, tables).unwrap_err();
        parts.iter().chain(&["run.toml:"]).for_each(|part| assert!(message.contains(part), "{part} in {message}"));
    }
}

#[test]
fn shapes_that_touch_in_every_posture_are_named_with_the_line_to_write() {
    let folder = cell("");
    let tables = "[[shape]]\nname = 'foot'\nattached = 'base'\nbox_mm = [600, 600, 600]\n\
                  [[shape]]\nname = 'column'\nattached = 'link_1'\nbox_mm = [600, 600, 600]\n";
    let message = run(folder.path(), "", tables).unwrap_err();
    let ignore = "ignore = [[\"column\", \"foot\"]]";
    for part in [
        "run.toml:21: shape[2]: ",
        "in every posture tried: \"column\" and \"foot\"",
        "; allowed: room between them",
        ignore,
    ] {
        assert!(message.contains(part), "{part} in {message}");
    }
    assert!(run(folder.path(), "", &format!("{tables}[collision]\n{ignore}\n")).is_ok());
}

/// The digest of a case changes with every file that the scene is made of.
#[test]
fn cases_of_a_study_know_the_files_of_the_cell() {
    let folder = cell(CELL);
    let read = |folder: &Path| {
        run(folder, NAMED, "").unwrap();
        let study = folder.join("study.toml");
        std::fs::write(
            &study,
            "base = 'run.toml'\n[[axis]]\nfield = 'surroundings.collision.clearance_mm'\nvalues = [5, 30]\n",
        )
        .unwrap();
        let study = crate::read_study(&study).unwrap();
        study
            .cases
            .iter()
            .map(|case| study.case(case, &Monitor::silent()).unwrap())
            .map(|case| (case.id, case.run.problem.scene.clone().unwrap()))
            .collect::<Vec<_>>()
    };
    let before = read(folder.path());
    let clearances: Vec<f64> = before.iter().map(|(_, scene)| scene.surroundings().clearance()).collect();
    assert_eq!(clearances, [0.005, 0.03]);
    assert_ne!(before[0].0, before[1].0);
    let ids = |cases: &[(String, std::sync::Arc<stead_cell::Scene>)]| {
        cases.iter().map(|case| case.0.clone()).collect::<Vec<_>>()
    };
    assert_eq!(ids(&read(folder.path())), ids(&before));
    let mesh = folder.path().join("cells/meshes/wedge.stl");
    let mut bytes = std::fs::read(&mesh).unwrap();
    // Another word in the header: another file.
    bytes[6] = b'W';
    std::fs::write(&mesh, bytes).unwrap();
    let after = read(folder.path());
    assert!(ids(&after).iter().zip(ids(&before)).all(|(after, before)| *after != before));
}
