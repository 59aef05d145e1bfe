//! Robot files: what they become, and what is refused where.

use super::*;
use std::path::PathBuf;
use stead_model::robot::{Compensator, Compliance, testing::kr270};

/// A robot file: name on line 1, source on line 2, and joint j in the eight lines from 8 j - 5, its header first.
fn text() -> String {
    let rows = [
        (0, 0, 0, -185, 185, "stiffness_mnm_per_rad = 0.237"),
        (90, 350, 0, 0, 146, "stiffness_mnm_per_rad = 3.32"),
        (0, 1250, 0, -245, 29, "compliance_urad_per_nm = 0.4"),
        (-90, 55, 1100, -350, 350, "stiffness_mnm_per_rad = 0.486"),
        (90, 0, 0, -125, 125, "stiffness_mnm_per_rad = 0.521"),
        (-90, 0, 0, -350, 350, "stiffness_mnm_per_rad = 0.38"),
    ];
    let mut text = "name = 'arm'\nsource = 'a test'\n".to_owned();
    for (alpha, a, d, min, max, yielding) in rows {
        text += &format!("[[joints]]\nalpha_deg = {alpha}\na_mm = {a}\nd_mm = {d}\nmin_deg = {min}\n");
        text += &format!("max_deg = {max}\nmax_speed_deg_per_s = 180\n{yielding}\n");
    }
    text
}

fn read(text: &str) -> Result<Robot, InputError> {
    robot_from(&TomlFile::new(Path::new("arm.toml"), text.as_bytes().to_vec())?)
}

/// The file with one line (from 1) replaced.
fn with_line(number: usize, line: &str) -> String {
    let mut lines: Vec<String> = text().lines().map(str::to_owned).collect();
    lines[number - 1] = line.to_owned();
    lines.join("\n")
}

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/robots").join(name)
}

#[test]
fn units_become_si() {
    let robot = read(&text()).unwrap();
    assert_eq!(robot.name(), "arm");
    let [_, second, third, ..] = robot.joints();
    assert_eq!((second.alpha, second.a, second.max), (90_f64.to_radians(), 0.35, 146_f64.to_radians()));
    assert_eq!((second.max_speed, second.max_jerk), (Some(std::f64::consts::PI), None));
    assert_eq!((second.compliance, third.compliance), ((1e-6 / 3.32).into(), (0.4 / 1e6).into()));
    assert_eq!(*robot.data_sheet(), DataSheet::default());
}

#[test]
fn shipped_robots_are_the_paper_and_its_sensitivity() {
    let printed = read_robot(&shipped("kuka-kr270-2.toml")).unwrap();
    let paper = kr270();
    for (joint, expected) in printed.joints().iter().zip(paper.joints()) {
        let speed = joint.max_speed;
        assert!(speed.is_some_and(|speed| (1.4..3.3).contains(&speed)));
        let difference = [
            joint.alpha - expected.alpha,
            joint.a - expected.a,
            joint.d - expected.d,
            joint.min - expected.min,
            joint.max - expected.max,
        ];
        assert!(difference.iter().all(|difference| difference.abs() < 1e-12), "{joint:?}");
    }
    assert_eq!(printed.constant_compliances(), paper.constant_compliances());
    let softer = read_robot(&shipped("kuka-kr270-2-k1-0.8.toml")).unwrap();
    let mut compliances = printed.constant_compliances().unwrap();
    compliances[0] = 1e-6 / 0.8;
    assert_eq!(softer.joints(), printed.with_compliances(compliances).unwrap().joints());
    assert_ne!(softer.name(), printed.name());
}

#[test]
fn each_broken_rule_names_line_field_value_and_what_is_allowed() {
    // Joint 3 stands in lines 19 to 26, joint 5 in 35 to 42.
    for (text, parts) in [
        (with_line(1, "name = \"a\\nb\""), ["arm.toml:1: name: ", "control", "", "one line"]),
        (with_line(1, "name = 3"), ["arm.toml:1: name: ", "not a text", "found 3", "text in quotes"]),
        (with_line(2, ""), ["arm.toml:1: source: ", "missing", "", "text in quotes"]),
        (with_line(2, "sorce = 'x'"), ["arm.toml:2: sorce: ", "nearest known one: source", "found 'x'", "joints"]),
        (with_line(21, "a_m = 3"), ["arm.toml:21: joints[3].a_m: ", "nearest known one: a_mm", "found 3", "d_mm"]),
        (with_line(21, ""), ["arm.toml:19: joints[3].a_mm: ", "missing", "", "a finite number"]),
        (with_line(21, "a_mm = nan"), ["arm.toml:21: joints[3].a_mm: ", "not a finite", "found nan", "a finite"]),
        (
            with_line(23, "min_deg = 29"),
            ["arm.toml:23: joints[3].min_deg: ", "below max_deg = 29", "found 29", "lower"],
        ),
        (with_line(25, "max_speed_deg_per_s = 0"), [":25: joints[3].max_speed_deg_per_s: ", "", "found 0", "above 0"]),
        (with_line(18, "stiffness_mnm_per_rad = 0"), [":18: joints[2].stiffness", "range", "found 0", "above 0"]),
        (with_line(18, "stiffness_mnm_per_rad = -1.0"), [":18: joints[2].stiffness", "", "found -1.0", "above 0"]),
        (with_line(26, "compliance_urad_per_nm = 0.0"), [":26: joints[3].compliance", "", "found 0.0", "above 0"]),
        (with_line(26, "compliance_urad_per_nm = 1e-320"), [":26: joints[3].compliance", "", "1e-320", "above 0"]),
        (with_line(18, "stiffness_mnm_per_rad = 1e-320"), [":18: joints[2].stiffness", "inf", "1e-320", "finite"]),
        (
            with_line(25, "stiffness_mnm_per_rad = 2.5"),
            [":26: joints[3].compliance_urad_per_nm: ", "beside stiffness_mnm", "found 0.4", "only one"],
        ),
        (with_line(26, ""), [":19: joints[3].stiffness_mnm_per_rad: ", "missing", "", "or compliance_urad_per_nm"]),
        (with_line(38, "d_mm = 12.5"), [":38: joints[5].d_mm: ", "not spherical", "found 12.5;", "one point"]),
        (with_line(36, "alpha_deg = 60"), [":36: joints[5].alpha_deg: ", "orthogonal", "found 60;", "right angles"]),
        (with_line(3, "[joints]"), ["arm.toml:", "TOML", "found", "a TOML file"]),
    ] {
        let message = read(&text).unwrap_err().to_string();
        for part in parts.iter().chain(&["; allowed: "]) {
            assert!(message.contains(part), "{part} in {message}");
        }
    }
}

/// The file with this table in lines 51 on.
fn with_table(table: &str) -> String {
    text() + table
}

#[test]
fn what_joins_axes_2_and_3_is_read_and_what_joins_none_is_refused() {
    let robot = read(&with_table("[axes_2_3]\nsum_min_deg = -200\nsum_max_deg = -30\n")).unwrap();
    let sum = robot.sum_range().unwrap();
    assert_eq!((sum.min, sum.max), (-200_f64.to_radians(), -30_f64.to_radians()));
    assert!(!robot.has_linkage() && read(&text()).unwrap().axes_2_3().is_none());
    let linked = "[axes_2_3]\nlinkage = true\nsum_min_deg = -245\nsum_max_deg = 175\n";
    assert!(read(&with_table(linked)).unwrap().has_linkage());
    for (table, parts) in [
        ("linkage = true", ["arm.toml:51: axes_2_3.sum_min_deg: ", "missing", "", "a finite number"]),
        ("linkage = true\nsum_min_deg = 1", [":51: axes_2_3.sum_max_deg: ", "missing", "", "a finite number"]),
        ("sum_min_deg = 9\nsum_max_deg = 8", [":52: axes_2_3.sum_min_deg: ", "not below sum_max", "found 9", "below"]),
        ("sum_min_deg = 9\nsum_max_deg = nan", [":53: axes_2_3.sum_max_deg: ", "", "found nan", "a finite number"]),
        ("sum_min_deg = -inf\nsum_max_deg = 8", [":52: axes_2_3.sum_min_deg: ", "", "found -inf", "a finite number"]),
        (
            "sum_min_deg = -246\nsum_max_deg = 8",
            [":52: axes_2_3.sum_min_deg: ", "-245.0000 to 175.0000 deg", "found -246", "of joints 2 and 3"],
        ),
        (
            "sum_min_deg = 0\nsum_max_deg = 176",
            [":53: axes_2_3.sum_max_deg: ", "-245.0000 to 175.0000 deg", "found 176", "of joints 2 and 3"],
        ),
        ("linkage = 1\nsum_min_deg = 0\nsum_max_deg = 8", [":52: axes_2_3.linkage: ", "", "found 1", "true or false"]),
        ("link = true\nsum_min_deg = 0\nsum_max_deg = 8", [":52: axes_2_3.link: ", "linkage", "true", "sum_max_deg"]),
    ] {
        let message = read(&with_table(&format!("[axes_2_3]\n{table}\n"))).unwrap_err().to_string();
        for part in parts.iter().chain(&["; allowed: "]) {
            assert!(message.contains(part), "{part} in {message}");
        }
        assert_eq!(message.lines().count(), 1);
    }
    let varying = with_line(26, "compliance_urad_per_nm = [0.4, 0.5]") + "\n" + linked;
    let message = read(&varying).unwrap_err().to_string();
    assert!(message.contains("axes_2_3.linkage: drives joint 3, whose compliance changes"), "{message}");
    let turning = with_line(24, "max_deg = 200") + "\n" + linked;
    let message = read(&turning).unwrap_err().to_string();
    assert!(message.contains("needs a range of less than 360 deg of joint 3"), "{message}");
}

/// A compensator at joint 2, its header in line 19.
const COMPENSATED: &str = "stiffness_mnm_per_rad = 3.32
[joints.compensator]
spring_stiffness_n_per_mm = 140
a_mm = 700
l_mm = 180
alpha_deg = 11.5
free_length_mm = 460";

#[test]
fn laws_and_the_data_sheet_become_si() {
    let robot = read(&with_line(26, "compliance_urad_per_nm = [0.55, 0.28]")).unwrap();
    assert_eq!(robot.joints()[2].compliance, Compliance::Range { at_min: 0.55 / 1e6, at_max: 0.28 / 1e6 });
    let robot = read(&with_line(18, COMPENSATED)).unwrap();
    let compensator =
        Compensator { spring_stiffness: 1.4e5, a: 0.7, l: 0.18, alpha: 11.5_f64.to_radians(), free_length: 0.46 };
    assert_eq!(robot.joints()[1].compliance, Compliance::Compensated { alone: 1e-6 / 3.32, compensator });
    assert_eq!(robot.joints()[2].compliance, (0.4 / 1e6).into());
    let known = "source = 'a test'\npayload_kg = 270\nworking_radius_mm = 2700\nprice_eur = 1.5e5";
    let expected = DataSheet { payload: Some(270.0), working_radius: Some(2.7), price: Some(1.5e5) };
    assert_eq!(*read(&with_line(2, known)).unwrap().data_sheet(), expected);
}

#[test]
fn broken_laws_and_data_sheets_are_located() {
    let compensated = |from: &str, to: &str| with_line(18, &COMPENSATED.replace(from, to));
    let both = COMPENSATED.replace("stiffness_mnm_per_rad = 3.32", "compliance_urad_per_nm = [0.3, 0.4]");
    for (text, parts) in [
        (
            with_line(26, "compliance_urad_per_nm = [0.3, -0.4]"),
            [":26: joints[3].compliance_urad_per_nm[2]: ", "out of range", "found -0.4", "[at min_deg, at max_deg]"],
        ),
        (
            with_line(26, "compliance_urad_per_nm = [0.3]"),
            [":26: joints[3].compliance_urad_per_nm: ", "1 elements and not 2", "found [0.3]", "one number above 0"],
        ),
        (
            with_line(26, "compliance_urad_per_nm = [0.3, nan]"),
            [":26: joints[3].compliance_urad_per_nm[2]: ", "finite", "found nan", "above 0"],
        ),
        (
            with_line(26, "compliance_urad_per_nm = [0.3, 1e-320]"),
            [":26: joints[3].compliance_urad_per_nm[2]: ", "out of range", "found 1e-320", "above 0"],
        ),
        (
            with_line(34, "compliance_urad_per_nm = [2, 3]"),
            [":34: joints[4].compliance_urad_per_nm: ", "700 deg apart", "found [2, 3]", "less than 360 deg"],
        ),
        (
            with_line(18, "stiffness_mnm_per_rad = [3, 4]"),
            [":18: joints[2].stiffness_mnm_per_rad: ", "not a finite number", "found [3, 4]", "above 0"],
        ),
        (
            with_line(18, &both),
            [":18: joints[2].compliance_urad_per_nm: ", "beside a compensator", "found [0.3, 0.4]", "one number"],
        ),
        (
            compensated("l_mm = 180", "l_mm = 0"),
            [":22: joints[2].compensator.l_mm: ", "out of range", "found 0;", "above 0"],
        ),
        (
            compensated("free_length_mm = 460", ""),
            [":19: joints[2].compensator.free_length_mm: ", "missing", "", "above 0"],
        ),
        (
            compensated("alpha_deg", "alfa_deg"),
            [":23: joints[2].compensator.alfa_deg: ", "nearest known one: alpha_deg", "found 11.5", "l_mm"],
        ),
        (
            compensated("mm = 140", "mm = 140000"),
            [":20: joints[2].compensator.spring_stiffness_n_per_mm: ", "at 0 deg", "found 140000", "is above 0"],
        ),
        (
            compensated("mm = 140", "mm = 1e308"),
            [":20: joints[2].compensator.spring_stiffness_n_per_mm: ", "range", "found 1e308", "not above 1e9"],
        ),
        (
            compensated("a_mm = 700", "a_mm = 180").replace("11.5", "120"),
            [":22: joints[2].compensator.l_mm: ", "meet at 60", "found 180", "has a length"],
        ),
        (
            with_line(18, "stiffness_mnm_per_rad = 3.32\ncompensator = 3"),
            [":19: joints[2].compensator: ", "not a table", "found 3", "[joints[2].compensator]"],
        ),
        (
            with_line(2, "source = 'a'\npayload_kg = 0"),
            ["arm.toml:3: payload_kg: ", "out of range", "found 0", "above 0"],
        ),
        (
            with_line(2, "source = 'a'\nworking_radius_mm = 1e-323"),
            ["arm.toml:3: working_radius_mm: ", "is 0", "found 1e-323", "above 0"],
        ),
        (
            with_line(2, "source = 'a'\nprice_eur = inf"),
            ["arm.toml:3: price_eur: ", "not a finite", "found inf", "above 0"],
        ),
    ] {
        let message = read(&text).unwrap_err().to_string();
        for part in parts.iter().chain(&["; allowed: "]) {
            assert!(message.contains(part), "{part} in {message}");
        }
    }
}

#[test]
fn an_arm_has_six_rows() {
    let lines: Vec<String> = text().lines().map(str::to_owned).collect();
    let message = read(&lines[..42].join("\n")).unwrap_err().to_string();
    assert_eq!(
        message,
        "arm.toml:3: joints: does not make a six-axis arm, found 5 rows; allowed: six tables [[joints]], base first"
    );
    let seven = format!("{}{}", text(), lines[34..42].join("\n"));
    assert!(read(&seven).unwrap_err().to_string().contains("found 7 rows"));
}

#[test]
fn a_missing_file_is_named() {
    let message = read_robot(Path::new("nowhere/arm.toml")).unwrap_err().to_string();
    for part in ["nowhere/arm.toml: ", "cannot be read", "allowed: "] {
        assert!(message.contains(part), "{part} in {message}");
    }
}
