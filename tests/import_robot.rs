//! `stead import robot` from outside.

use crate::common::{Bench, RUN};

const URDF: &str = "crates/format/src/urdf/fixtures/kuka.urdf";

fn bench() -> Bench {
    let bench = Bench::new();
    bench.copy(URDF, "kuka.urdf");
    bench
}

#[test]
fn a_robot_is_imported_and_lacks_only_its_stiffness() {
    let bench = bench();
    let ended = bench.stead(&["import", "robot", "kuka.urdf", "--out", "my/arm.toml"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    for part in
        ["wide_arm_k: from link base_link to link tool0", "theta_3 = q(joint_a3) + 90 deg", "written: my/arm.toml"]
    {
        assert!(ended.stdout.contains(part), "{part} in {}", ended.stdout);
    }
    ended.assert_says(&["note: joint stiffness is not in a URDF", "identify plan", "--stiffness-like"]);
    bench.replace(RUN, "robots/kuka-kr270-2.toml", "../my/arm.toml");
    let place = bench.stead(&["place", RUN, "--out", "out"]);
    assert_eq!((place.code, place.stdout.as_str()), (Some(2), ""));
    place.assert_says(&[
        "arm.toml:",
        "joints[1].stiffness_mnm_per_rad: is missing",
        "identify plan",
        "--stiffness-like",
    ]);
    assert!(!bench.path("out").exists());
}

#[test]
fn with_the_stiffness_of_a_shipped_arm_it_is_placed() {
    let bench = bench();
    let import = ["import", "robot", "kuka.urdf", "--stiffness-like", "kuka-kr270-2", "--out", "arm.toml"];
    let ended = bench.stead(&import);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&["note: joint stiffness is that of another arm, KUKA KR270-2", "does not predict millimetres"]);
    bench.replace(RUN, "robots/kuka-kr270-2.toml", "../arm.toml");
    bench.replace(RUN, "z_mm = [-602.0, -214.0]", "z_mm = [73.0, 461.0]");
    assert!(bench.read("arm.toml").contains("\nstiffness_like = \"KUKA KR270-2\"\n"));
    let placed = bench.stead(&["place", RUN, "--out", "out"]);
    assert_eq!(placed.code, Some(0), "{}", placed.stderr);
    // Every result says whose stiffness it is: notes, headlines, summary and page.
    placed
        .assert_says(&["(stiffness of KUKA KR270-2): the joint stiffness is borrowed from KUKA KR270-2, not measured"]);
    let name = placed.stdout.lines().next().unwrap();
    assert!(name.contains(" (stiffness of KUKA KR270-2): 105 points"), "{name}");
    for file in ["out/summary.json", "out/report.html"] {
        assert!(bench.read(file).contains("(stiffness of KUKA KR270-2)"), "{file}");
    }
}

#[test]
fn a_file_that_is_there_is_left_as_it_is() {
    let bench = bench();
    bench.write("arm.toml", "mine\n");
    let before = bench.tree("");
    let ended = bench.stead(&["import", "robot", "kuka.urdf", "--out", "arm.toml"]);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""));
    ended.assert_says(&["error: arm.toml: is there already, and is left as it is; allowed: "]);
    assert_eq!(bench.tree(""), before);
}

#[test]
fn what_is_refused_leaves_nothing_behind() {
    let bench = bench();
    let line = bench.replace(
        "kuka.urdf",
        "<joint name=\"joint_a3\" type=\"revolute\">",
        "<joint name=\"joint_a3\" type=\"prismatic\">",
    );
    let before = bench.tree("");
    let refused = |more: &[&str], parts: &[&str]| {
        let ended = bench.stead(&[&["import", "robot"], more, &["--out", "my/arm.toml"]].concat());
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
        ended.assert_says(parts);
        assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
        assert_eq!(bench.tree(""), before);
    };
    refused(
        &["kuka.urdf"],
        &[&format!("error: kuka.urdf:{line}: joint \"joint_a3\": is a prismatic joint"), "; allowed: "],
    );
    refused(&["none.urdf"], &["error: none.urdf: cannot be read", "; allowed: "]);
    refused(&["kuka.urdf", "--stiffness-like", "kr270"], &["--stiffness-like: is no shipped arm", "kuka-kr270-2"]);
    refused(&["kuka.urdf", "--tip-link", "tool9"], &["--tip-link: names no link", "nearest one is \"tool0\""]);
}

/// A pose read at the controller fills in how it counts; a wrong one leaves nothing behind.
#[test]
fn a_pose_of_the_controller_settles_how_it_counts() {
    let bench = bench();
    bench.stead(&["import", "robot", "kuka.urdf", "--out", "first.toml"]);
    // What a controller that counts as this URDF shows: angles of the rows by its own, and the flange.
    let text = bench.read("first.toml");
    let own = text.replace("# [controller]", "[controller]").replace("# [root]", "[root]");
    let own = ["kind", "sign", "offset_deg", "xyz_mm", "abc_deg"]
        .iter()
        .fold(own, |text, key| text.replace(&format!("# {key} = "), &format!("{key} = ")));
    bench.write("own.toml", &own);
    let angles = "-31.2,-71.4,63.7,17.9,52.6,-117.3";
    let pose = bench.stead(&["pose", "own.toml", &format!("--controller-deg={angles}"), "--json"]);
    let document: serde_json::Value = serde_json::from_str(&pose.stdout).unwrap();
    let frame = &document["frames"][1];
    let numbers = |key: &str| {
        frame[key].as_array().unwrap().iter().map(|v| format!("{:.2}", v.as_f64().unwrap())).collect::<Vec<_>>()
    };
    let flange = [numbers("xyz_mm"), numbers("abc_deg")].concat().join(",");
    let import = |home: &str, out: &str| {
        bench.stead(&[
            "import",
            "robot",
            "kuka.urdf",
            "--controller",
            "kuka",
            &format!("--home-deg={home}"),
            "--out",
            out,
        ])
    };
    let taken = import(&format!("{angles}={flange}"), "settled.toml");
    assert_eq!(taken.code, Some(0), "{}", taken.stderr);
    assert!(bench.read("settled.toml").contains("\n[controller]\nkind = \"kuka\"\nsign = [-1, 1, 1, 1, 1, -1]\n"));
    for (home, words) in [
        (format!("{angles}=1500,900,1700,10,20,30"), "--home-deg: agrees with no way of counting"),
        (format!("0,{angles}={flange}"), "allowed: A1,..,A6=X,Y,Z,A,B,C"),
        (format!("{angles}=1500,900,1700,1,0,0,0"), "--home-deg: has a quaternion, and kuka shows angles"),
        (format!("{}={flange}", angles.replace("52.6", "12.6")), "leaves axes 4 and 6 open"),
    ] {
        let ended = import(&home, "wrong.toml");
        assert_eq!(ended.code, Some(2));
        ended.assert_says(&[words]);
        assert!(!bench.path("wrong.toml").exists());
    }
}

#[test]
fn links_become_shapes_of_a_cell_file_where_they_are_asked_for() {
    let bench = bench();
    let link = "<link name=\"link_2\">";
    let collision = "<collision><geometry><box size=\"0.3 0.3 1.0\"/></geometry></collision>";
    bench.replace("kuka.urdf", link, &format!("{link}{collision}"));
    let ended = bench.stead(&["import", "robot", "kuka.urdf", "--collision", "--out", "my/arm.toml"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.contains("written: my/arm.toml, my/arm-cell.toml"), "{}", ended.stdout);
    ended.assert_says(&["note: link \"link_1\" has no <collision> shape: the arm is not checked there"]);
    let cell = bench.read("my/arm-cell.toml");
    for part in ["name = \"link_2 shape\"", "attached = \"link_2\"", "box_mm = [300.0, 300.0, 1000.0]"] {
        assert!(cell.contains(part), "{part} in {cell}");
    }
}
