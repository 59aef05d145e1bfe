//! URDFs that are refused, each with file, line and element.

use super::*;

/// The fixture of KUKA's convention with one piece replaced is refused with all these parts; the first is its place.
fn refused(from: &str, to: &str, parts: &[&str]) {
    let text = fixture("kuka");
    assert!(text.contains(from), "{from}");
    let message = import(&text.replacen(from, to, 1)).unwrap_err().to_string();
    assert_parts(&message, parts);
}

fn assert_parts(message: &str, parts: &[&str]) {
    assert!(message.starts_with("arm.urdf:"), "{message}");
    for part in parts.iter().chain(&["; allowed: "]) {
        assert!(message.contains(part), "{part} in {message}");
    }
    assert_eq!(message.lines().count(), 1, "{message}");
}

const A2: &str = "<origin xyz=\"0.35 0 0\" rpy=\"0 0 0\"/>";

#[test]
fn text_that_is_no_urdf_is_refused_at_its_line() {
    let whole = fixture("kuka");
    let cut = &whole[..whole.len() / 2];
    let lines = cut.lines().count();
    let message = import(cut).unwrap_err().to_string();
    assert_parts(&message, &[&format!("arm.urdf:{lines}: "), "; allowed: a URDF"]);
    let open = import("<robot name='a'>\n<link name='b'/>\n").unwrap_err().to_string();
    assert_parts(&open, &["arm.urdf:2: ", "ends before its last element is closed"]);
    refused("</robot>", "</robt>", &["arm.urdf:113: ", "is no XML"]);
    refused("<robot name=\"wide_arm_k\"", "<sdf name=\"a\"/><robot", &["arm.urdf:3: "]);
    assert_parts(&import("<sdf/>").unwrap_err().to_string(), &["arm.urdf:1: <sdf>: is not a robot"]);
    assert_parts(&import("<robot name='a'/>").unwrap_err().to_string(), &["<robot>: has no links"]);
}

#[test]
fn xacro_is_refused_with_how_to_expand_it() {
    let how = "xacro robot.xacro > robot.urdf";
    let element = "  <xacro:arm prefix=\"\"/>\n</robot>";
    refused("</robot>", element, &["arm.urdf:113: <arm>: is an element of xacro", how]);
    refused(A2, "<origin xyz=\"${d2} 0 0\"/>", &["joint \"joint_a2\": <origin>, attribute xyz: ", how]);
    let bare = import("<robot name='a'>\n<xacro:include filename='b'/>\n</robot>").unwrap_err().to_string();
    assert_parts(&bare, &["arm.urdf:2: uses xacro", how]);
}

#[test]
fn numbers_and_names_are_refused_at_their_attribute() {
    let place = "joint \"joint_a2\": <origin>, attribute xyz: ";
    for (to, found) in
        [("0.35 0", "0.35 0"), ("0.35 0 nan", "nan"), ("1 2 3 4", "1 2 3 4"), ("1e9 0 0", "1e9"), ("a b c", "a b c")]
    {
        refused(A2, &format!("<origin xyz=\"{to}\"/>"), &[place, found, "three numbers from -1000 to 1000"]);
    }
    refused("velocity=\"2.37", "velocity=\"x2.37", &["<limit>, attribute velocity: ", "found \"x2.37"]);
    refused("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0 0\"/>", &["joint \"joint_a2\": <axis>", "length zero"]);
    refused(
        "type=\"revolute\"",
        "type=\"hinge\"",
        &["joint \"joint_a1\", attribute type: ", "found \"hinge\"", "revolute"],
    );
    refused("<child link=\"link_2\"/>", "<child link=\"link_9\"/>", &["joint \"joint_a2\": <child>", "no link"]);
    refused("<child link=\"link_2\"/>", "", &["joint \"joint_a2\": has no <child>"]);
    refused("<link name=\"flange\"/>", "<link name=\"link_1\"/>", &["link \"link_1\", attribute name: ", "two links"]);
    refused("<link name=\"flange\"/>", "<link/>", &["<link>, attribute name: is missing"]);
    refused("name=\"joint_a2\"", "name=\"joint_a1\"", &["two joints"]);
}

#[test]
fn a_fixed_joint_turns_about_nothing_and_may_say_so() {
    let own = fixture("kuka");
    let fixed = own.replace("type=\"fixed\">", "type=\"fixed\">\n<axis xyz=\"0 0 0\"/>");
    assert!(fixed.len() > own.len());
    assert_eq!(import(&fixed).unwrap().rows, import(&own).unwrap().rows);
}

#[test]
fn links_that_are_no_tree_are_refused() {
    refused(
        "<link name=\"flange\"/>",
        "<link name=\"flange\"/>\n<link name=\"shelf\"/>",
        &["link \"shelf\": ", "two roots"],
    );
    let back = "<parent link=\"base_link\"/>\n    <child link=\"link_1\"/>";
    refused(back, "<parent link=\"link_6\"/>\n    <child link=\"link_1\"/>", &["joint \"joint_a1\": is in a cycle"]);
    let two = "</robot>";
    let joint = "<joint name=\"x\" type=\"fixed\"><parent link=\"base\"/><child link=\"link_3\"/></joint></robot>";
    refused(two, joint, &["joint \"x\": leads to link \"link_3\", and so does joint \"joint_a3\""]);
}

#[test]
fn chains_that_are_not_six_hinges_are_refused() {
    let revolute = "<joint name=\"joint_a3\" type=\"revolute\">";
    let of = |kind: &str| format!("<joint name=\"joint_a3\" type=\"{kind}\">");
    refused(revolute, &of("prismatic"), &["joint \"joint_a3\": is a prismatic joint", "--base-link"]);
    refused(revolute, &of("fixed"), &["is behind 5 moving joints", "joint_a1, joint_a2, joint_a4"]);
    refused(A2, &format!("{A2}<mimic joint=\"joint_a1\"/>"), &["joint \"joint_a2\": follows joint \"joint_a1\""]);
    let second = "<link name=\"other_tool0\"/><joint name=\"x\" type=\"fixed\"><parent link=\"link_6\"/><child link=\"other_tool0\"/></joint></robot>";
    refused(
        "</robot>",
        second,
        &["link \"other_tool0\": may be the end of the arm, and so may link \"tool0\"", "--tip-link"],
    );
    let named = |base: Option<&'static str>, tip: Option<&'static str>| {
        let options = ImportOptions { base_link: base, tip_link: tip, ..ImportOptions::default() };
        import_robot_text(Path::new("arm.urdf"), &fixture("kuka"), &options)
    };
    assert!(named(Some("base_link"), Some("flange")).is_ok());
    let unknown = named(None, Some("tool1")).unwrap_err().to_string();
    assert_parts(
        &unknown.replace("arm.urdf: ", "arm.urdf:"),
        &["--tip-link: names no link", "nearest one is \"tool0\""],
    );
    let above = named(Some("link_3"), Some("link_1")).unwrap_err().to_string();
    assert_parts(&above, &["link \"link_1\": is not below the base link \"link_3\""]);
    let short = named(Some("link_1"), None).unwrap_err().to_string();
    assert_parts(&short, &["is behind 5 moving joints"]);
}

#[test]
fn limits_are_needed() {
    let text = fixture("kuka");
    let start = text.find("<limit").unwrap();
    let limit = &text[start..start + text[start..].find("/>").unwrap() + 2];
    for to in ["", "<limit effort=\"1\" velocity=\"1\"/>"] {
        refused(limit, to, &["joint \"joint_a1\": has no limits"]);
    }
    refused(limit, "<limit lower=\"1\" upper=\"-1\" velocity=\"1\"/>", &["has limits from 1 to -1 rad"]);
    refused(limit, "<limit lower=\"-1\" upper=\"1e9\" velocity=\"1\"/>", &["has limits from -1 to 1000000000 rad"]);
    refused(limit, "<limit lower=\"-1\" upper=\"1\" velocity=\"-2\"/>", &["has a speed of -2 rad/s"]);
    let endless = text.replacen("type=\"revolute\"", "type=\"continuous\"", 1).replacen(limit, "", 1);
    let imported = import(&endless).unwrap();
    assert_eq!((imported.limits_deg[0], imported.max_speed_deg_per_s[0]), ([-360.0, 360.0], None));
    assert_eq!(imported.notes.iter().filter(|note| note.contains("\"joint_a1\"")).count(), 2);
}

#[test]
fn arms_of_another_kind_are_refused_at_the_joint() {
    let wall = "<origin xyz=\"0 0 0.675\" rpy=\"0 0 0\"/>";
    refused(
        wall,
        "<origin xyz=\"0 0 0.675\" rpy=\"0 1.2 0\"/>",
        &["joint \"joint_a1\": ", "from the z axis of the base link"],
    );
    // As an arm of Universal Robots: axis 4 parallel to axis 3.
    let text = fixture("kuka");
    let at = text.find("<axis xyz=\"-1 0 0\"/>").unwrap();
    let parallel = format!("{}<axis xyz=\"0 1 0\"/>{}", &text[..at], &text[at + 20..]);
    let message = import(&parallel).unwrap_err().to_string();
    assert_parts(&message, &["joint \"joint_a4\": has its axis 0.0000 deg from axis 3, as axis 4"]);
    // Joint 5 beside axis 4.
    let fifth = "<origin xyz=\"0 0 0\" rpy=\"0 0 0\"/>";
    refused(fifth, "<origin xyz=\"0 0.004 0.004\" rpy=\"0 0 0\"/>", &["mm from the point nearest to axes 4, 5 and 6"]);
    refused(fifth, "<origin xyz=\"0 0 0.0006\" rpy=\"0 0 0\"/>", &["link \"tool0\": is up to ", "0.5 mm"]);
    refused(
        fifth,
        "<origin xyz=\"0 0 0\" rpy=\"0 0 0.01\"/>",
        &["joint \"joint_a5\": has its axis 89.4270 deg from axis 4"],
    );
    refused(
        "<origin xyz=\"1.15 0 0\" rpy=\"0 0 0\"/>",
        "<origin xyz=\"0 0.2 0\"/>",
        &["joint \"joint_a3\": ", "upper arm"],
    );
    let elbow = "<origin xyz=\"1 0 -0.041\" rpy=\"0 0 0\"/>";
    refused(
        elbow,
        "<origin xyz=\"0 0 0\"/>",
        &["joint \"joint_a4\": makes an arm that is not supported", "wrist centre lies on axis 3"],
    );
}

#[test]
fn files_of_other_kinds_are_named_with_the_command_that_takes_them() {
    for (text, parts) in [
        ("$$ made by hand\nTOOL PATH/CONTOUR,TOOL,MILL\n", ["is CLDATA of a CAM system", "stead import path"]),
        ("%\nO1000\nN10 G90 G54\n", ["is G-code", "stead import path"]),
        ("ISO-10303-21;\nHEADER;\n", ["is a STEP file", "a URDF"]),
        ("name = 'arm'\n[[joints]]\n", ["is a robot file already", "a URDF"]),
        ("<sdf version='1.6'/>", ["<sdf>: is not a robot", "whose outermost element is <robot>"]),
    ] {
        let message = import(text).unwrap_err().to_string();
        assert!(parts.iter().all(|part| message.contains(part)) && !message.contains('\n'), "{message}");
    }
    // A comment is no macro.
    assert!(import(&fixture("kuka").replacen("<link", "<!-- by xacro, ${pi} --><link", 1)).is_ok());
}
