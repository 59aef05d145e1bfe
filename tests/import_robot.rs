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

/// A tool path at the door for robots, and a robot at that for tool paths.
#[test]
fn a_file_at_the_wrong_door_is_named_with_its_command() {
    let bench = bench();
    let refused = |arguments: &[&str], part: &str| {
        let ended = bench.stead(arguments);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
        assert!(ended.stderr.trim_end().lines().count() == 1 && ended.stderr.contains(part), "{}", ended.stderr);
    };
    let path = ["import", "path", "kuka.urdf", "--units", "mm", "--out", "part.csv"];
    refused(&path, "kuka.urdf: is a URDF: `stead import robot` makes a robot file of it; allowed: a tool path");
    refused(&[&path[..], &["--format", "gcode"]].concat(), "is a URDF: `stead import robot`");
    bench.write("arm.xacro", "<robot name='arm' xmlns:xacro='http://ros.org/wiki/xacro'><xacro:arm/></robot>");
    refused(&["import", "path", "arm.xacro", "--out", "part.csv"], "is a xacro file, for `stead import robot`");
    refused(&["import", "robot", "arm.xacro", "--out", "arm.toml"], "is an element of xacro, which is not expanded");
    bench.copy("crates/format/src/cam/fixtures/pocket.cls", "pocket.cls");
    refused(&["import", "robot", "pocket.cls", "--out", "arm.toml"], "is CLDATA of a CAM system: `stead import path`");
    bench.write("arm.sdf", "<sdf version='1.6'></sdf>");
    refused(&["import", "path", "arm.sdf", "--out", "part.csv"], "is XML, and no URDF");
    // A remark of the program that made it is no macro.
    let text = bench.read("kuka.urdf").replacen("<link", "<!-- made by xacro --><link", 1);
    bench.write("made.urdf", &text);
    refused(&["import", "path", "made.urdf", "--out", "part.csv"], "made.urdf: is a URDF");
    assert_eq!(bench.stead(&["import", "robot", "made.urdf", "--out", "made.toml"]).code, Some(0));
}

/// A robot on a pedestal: its run has it there.
#[test]
fn an_arm_on_a_pedestal_is_mounted_where_its_urdf_has_it() {
    let bench = bench();
    let boxed = "<collision><geometry><box size=\"0.2 0.2 0.2\"/></geometry></collision>";
    let text =
        bench.read("kuka.urdf").replacen("<link name=\"base_link\">", &format!("<link name=\"base_link\">{boxed}"), 1);
    let stand = "<link name=\"world\"/><joint name=\"stand\" type=\"fixed\"><parent link=\"world\"/>\
                 <child link=\"base_link\"/><origin xyz=\"0 0 0.5\" rpy=\"0 0 1.5707963267948966\"/></joint>";
    let (head, rest) = text.split_at(text.find("<link").unwrap());
    bench.write("floor.urdf", &text);
    bench.write("stand.urdf", &format!("{head}{stand}{rest}"));
    let like = ["--stiffness-like", "kuka-kr270-2", "--collision"];
    for name in ["floor", "stand"] {
        let (urdf, out) = (format!("{name}.urdf"), format!("{name}.toml"));
        let ended = bench.stead(&[&["import", "robot", urdf.as_str(), "--out", out.as_str()], &like[..]].concat());
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        if name == "stand" {
            ended.assert_says(&[
                "stands in link \"world\" at xyz_mm = [0.0, 0.0, 500.0], rpy_deg = [0.0, 0.0, 90.0]: [mount] of the surroundings",
            ]);
        }
    }
    assert!(!bench.read("floor-cell.toml").contains("[mount]"));
    let stated = "[mount]\nxyz_mm = [0.0, 0.0, 500.0]\nrpy_deg = [0.0, 0.0, 90.0]\n";
    assert!(bench.read("stand-cell.toml").contains(stated), "{}", bench.read("stand-cell.toml"));
    // The run that is written for it has its cell there, in front of the robot.
    let task = ["--task", "tasks/five-segments.csv"];
    let init = ["init", "place", "--robot", "stand.toml", "--out", "run.toml"];
    let ended = bench.stead(&[&init[..], &task[..]].concat());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let run: toml::Table = bench.read("run.toml").parse().unwrap();
    let range =
        |key: &str| run["cell"][key].as_array().unwrap().iter().map(|v| v.as_float().unwrap()).collect::<Vec<_>>();
    assert!(range("y_mm")[0] > 500.0 && range("x_mm")[0] < 0.0 && range("z_mm")[0] > 500.0, "{run}");
    let checked = bench.stead(&["check", "run.toml"]);
    assert_eq!(checked.code, Some(0), "{}", checked.stderr);
    assert!(checked.stdout.contains("base frame in the cell frame at x 0.0, y 0.0, z 500.0 mm"), "{}", checked.stdout);
}
