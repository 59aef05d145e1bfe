use super::*;

const BINARY: &[u8] = include_bytes!("fixtures/wedge.stl");
const ASCII: &str = include_str!("fixtures/wedge-ascii.stl");
const OBJ: &str = include_str!("fixtures/wedge.obj");
const HOUSE: &str = include_str!("fixtures/house.obj");
const DAE: &str = include_str!("fixtures/wedge.dae");

fn read(file: &str, bytes: &[u8]) -> Result<TriangleMesh, String> {
    read_mesh(file.as_ref(), bytes, MeshUnit::Millimetre).map_err(|error| error.to_string())
}

/// The area. m^2
fn area(mesh: &TriangleMesh) -> f64 {
    let corners = |t: &[u32; 3]| t.map(|number| mesh.vertices()[number as usize]);
    mesh.triangles().iter().map(corners).map(|[a, b, c]| (b - a).cross(&(c - a)).norm() / 2.0).sum()
}

#[test]
fn one_wedge_in_five_files_is_one_mesh() {
    let files: [(&str, &[u8]); 5] = [
        ("a.stl", BINARY),
        ("a.STL", ASCII.as_bytes()),
        ("a.obj", OBJ.as_bytes()),
        ("a.OBJ", HOUSE.as_bytes()),
        ("a.dae", DAE.as_bytes()),
    ];
    for (file, bytes) in files {
        let mesh = read(file, bytes).unwrap();
        assert!(mesh.is_closed(), "{file}");
        assert_eq!((mesh.vertices().len(), mesh.triangles().len()), (6, 8), "{file}");
        let slope = libm::hypot(100.0, 40.0);
        assert!((area(&mesh) * 1e6 - (100.0 * 60.0 + 40.0 * 60.0 + 100.0 * 40.0 + slope * 60.0)).abs() < 1e-6);
        assert!((volume(&mesh) * 1e9 - 0.5 * 100.0 * 40.0 * 60.0).abs() < 1e-6, "{file}");
    }
    let metres = read_mesh("a.stl".as_ref(), BINARY, MeshUnit::Metre).unwrap();
    assert_eq!(metres.vertices()[2].x, 100.0);
}

#[test]
fn what_is_no_stl_is_refused_where_it_stops_being_one() {
    let changed = |from: &str, to: &str| ASCII.replacen(from, to, 1);
    for (text, parts) in [
        (String::new(), &["a.stl: is too short", "found 0 bytes"][..]),
        (
            "some text about a part, long enough to have a count of triangles in it, as it were, in its 84 bytes"
                .to_owned(),
            &["is a text that does not begin with \"solid\""],
        ),
        ("solid a\nendsolid a\n".to_owned(), &["has no triangles"]),
        (changed("endsolid wedge", ""), &[":57:", "cut off", "endsolid"]),
        (changed("vertex 0 0 0e0", "vertex 0 nan 0"), &[":4:", "three finite numbers", "found 'vertex 0 nan 0'"]),
        (changed("vertex 0 0 0e0", "vertex 0 0"), &[":4:", "three finite numbers"]),
        (changed("vertex 0 0 0e0", "vertex 0 0 0 0"), &[":4:", "three finite numbers"]),
        (changed("vertex 0 0 0e0", "vertex 0 1e7 0"), &["beyond 1000 m in vertex 1", "found 10000000", "unit"]),
        (changed("vertex 0 0 0e0", "vortex 0 0 0"), &[":4:", "not what an STL has here", "found 'vortex 0 0 0'"]),
        (changed("      vertex 0 0 0e0\n", ""), &[":6:", "three vertices", "found 'endloop'"]),
        (changed("    outer loop\n", ""), &[":3:", "not what an STL has here"]),
    ] {
        let message = read("a.stl", text.as_bytes()).unwrap_err();
        for part in parts.iter().chain(&["a.stl", "; allowed: "]) {
            assert!(message.contains(part), "{part} in {message}");
        }
    }
    let mut bytes = BINARY.to_vec();
    bytes.truncate(300);
    let message = read("a.stl", &bytes).unwrap_err();
    assert!(message.contains("cut off") && message.contains("found 300 bytes; allowed: 484 bytes"), "{message}");
    let mut bytes = BINARY.to_vec();
    // The first coordinate of the second triangle.
    bytes[84 + 50 + 12..84 + 50 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
    let message = read("a.stl", &bytes).unwrap_err();
    assert!(message.contains("not a finite number in triangle 2, found NaN; allowed: "), "{message}");
}

#[test]
fn a_file_of_another_kind_is_named_before_triangles_are_counted() {
    let text = "x".repeat(200);
    for (file, bytes, part) in [
        ("a.stl", "robot = 'a.toml'\n[redundancy]\n", "is a run file, for `stead place`"),
        ("a.stl", "$$ made by hand\nTOOL PATH/CONTOUR,TOOL,MILL\n", "is CLDATA of a CAM system"),
        ("a.stl", "%\nO1000\nN10 G90 G54\n", "is G-code"),
        ("a.stl", "<?xml version='1.0'?>\n<robot name='arm'>", "is a URDF"),
        ("a.step", "ISO-10303-21;\nHEADER;\n", "is a STEP file"),
        ("a.stl", text.as_str(), "is a text that does not begin with \"solid\""),
    ] {
        let message = read(file, bytes.as_bytes()).unwrap_err();
        assert!(message.contains(part) && message.contains("; allowed: "), "{part} in {message}");
        assert!(!message.contains("triangles:"), "{message}");
    }
}

#[test]
fn what_is_no_obj_is_refused_where_it_stops_being_one() {
    let changed = |from: &str, to: &str| OBJ.replacen(from, to, 1);
    for (text, parts) in [
        (String::new(), &["has no faces"][..]),
        (changed("v 0 0 0", "v 0 0 inf"), &[":4:", "three finite numbers", "found 'v 0 0 inf'"]),
        (changed("v 0 0 0", "v 0 0"), &[":4:", "three finite numbers"]),
        (changed("f 1 4 3 2", "f 1 4"), &[":14:", "fewer than three corners"]),
        (changed("f 1 4 3 2", "f 1 4 0"), &[":14:", "names a vertex that there cannot be"]),
        (changed("f 1 4 3 2", "f 1 4 -7"), &[":14:", "names a vertex that there cannot be"]),
        (changed("f 1 4 3 2", "f 1 4 7"), &[":14:", "names vertex 7, and there are 6"]),
        (changed("f 1 4 3 2", "f 1 4 x"), &[":14:", "names a vertex that there cannot be"]),
        (changed("s off", "curv 0 1 1 2"), &[":13:", "is a statement that is not read", "found 'curv 0 1 1 2'"]),
    ] {
        let message = read("a.obj", text.as_bytes()).unwrap_err();
        for part in parts.iter().chain(&["a.obj", "; allowed: "]) {
            assert!(message.contains(part), "{part} in {message}");
        }
    }
}

#[test]
fn what_is_no_dae_is_refused_where_it_stops_being_one() {
    let changed = |from: &str, to: &str| {
        assert!(DAE.contains(from), "{from}");
        DAE.replacen(from, to, 1)
    };
    for (text, parts) in [
        (String::new(), &["is no XML"][..]),
        (changed("</scene>", ""), &[":62:", "is no XML"]),
        ("<robot/>".to_owned(), &["is no COLLADA file"]),
        (changed("meter=\"0.01\"", "meter=\"0\""), &[":4:", "attribute meter", "no length above 0"]),
        (changed("meter=\"0.01\"", "meter=\"nan\""), &[":4:", "attribute meter", "no"]),
        (changed("1000 0 0", "1000 inf 0"), &[":11:", "no finite number", "found 'inf'"]),
        (changed("0 0 1 0 2 0", "0 0 1 0 6 0"), &[":18:", "names vertex 6, and there are 6"]),
        (changed("0 0 1 0 2 0", "0 0 1 0 -1 0"), &["no number of a vertex", "found '-1'"]),
        (changed("<vcount>4 4 4", "<vcount>4 4 9"), &[":33:", "fewer corners than <vcount> says"]),
        (changed("url=\"#sides\"", "url=\"#nowhere\""), &[":47:", "names nothing of this file", "#nowhere"]),
        (changed("url=\"#sides\"", "url=\"other.dae#sides\""), &["names nothing of this file"]),
        (changed("<instance_geometry url=\"#sides\"/>", "<instance_node url=\"#turned\"/>"), &["too many nodes"]),
        (changed("<rotate>0 0 1 90", "<rotate>0 0 0 90"), &[":44:", "has not the numbers of such a transform"]),
        (changed("<translate>0 0 0<", "<translate>0 0<"), &[":43:", "has not the numbers of such a transform"]),
        (changed("<translate>0 0 0</translate>", "<skew>1 0 0 1 0 1 0</skew>"), &["<skew>: is not read"]),
        (changed("instance_geometry url=\"#ends\"", "instance_controller url=\"#ends\""), &["deformed surface"]),
        (changed("url=\"#all\"", "url=\"#vertices\""), &["shows no triangles"]),
    ] {
        let message = read("a.dae", text.as_bytes()).unwrap_err();
        for part in parts.iter().chain(&["a.dae", "; allowed: "]) {
            assert!(message.contains(part), "{part} in {message}");
        }
    }
}

#[test]
fn a_dae_without_a_scene_and_one_that_is_mirrored_are_whole() {
    let from = DAE.find("  <scene>").unwrap();
    let until = DAE.find("</COLLADA>").unwrap();
    let loose = format!("{}{}", &DAE[..from], &DAE[until..]);
    // The two geometries as they are, not placed: five faces that do not meet.
    let mesh = read("a.dae", loose.as_bytes()).unwrap();
    assert_eq!((mesh.vertices().len(), mesh.triangles().len(), mesh.is_closed()), (12, 8, false));
    let mirrored = DAE.replacen("<scale>10 10 10", "<scale>10 -10 10", 1);
    let mesh = read("a.dae", mirrored.as_bytes()).unwrap();
    assert!(mesh.is_closed() && (volume(&mesh) * 1e9 - 120_000.0).abs() < 1e-6);
    assert!(mesh.vertices().iter().all(|at| at.y < 1e-9));
}

/// Triangles that face inwards are turned, so that the inside of a closed mesh is inside.
#[test]
fn a_closed_mesh_faces_outwards_whatever_the_file_says() {
    let turned: String = HOUSE.lines().fold(String::new(), |text, line| match line.strip_prefix("f ") {
        Some(corners) if !corners.ends_with('\\') => {
            let words: Vec<&str> = corners.split(' ').rev().collect();
            format!("{text}f {}\n", words.join(" "))
        }
        _ => format!("{text}{line}\n"),
    });
    // The face that goes on in the next line.
    let turned = turned.replacen("f -6 -3 \\\n  -4 -5", "f -5 -4 -3 -6", 1);
    let mesh = read("a.obj", turned.as_bytes()).unwrap();
    assert!(mesh.is_closed() && (volume(&mesh) * 1e9 - 120_000.0).abs() < 1e-6);
}
