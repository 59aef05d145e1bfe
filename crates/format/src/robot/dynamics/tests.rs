use super::*;
use crate::robot::{moving_robot_from, robot_from};
use std::path::Path;
use stead_simulation::arm::testing::{spindle, tx200};

fn shipped() -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/robots/staubli-tx200.toml");
    std::fs::read_to_string(file).unwrap()
}

fn source(text: &str) -> TomlFile {
    TomlFile::new(Path::new("arm.toml"), text.as_bytes().to_vec()).unwrap()
}

/// The line on which some text stands for the nth time (from 0).
fn line(text: &str, part: &str, nth: usize) -> usize {
    text.lines().enumerate().filter(|(_, line)| line.starts_with(part)).nth(nth).unwrap().0 + 1
}

#[test]
fn the_shipped_arm_is_that_of_the_tests() {
    let (read, expected) = (moving_robot_from(&source(&shipped()), true).unwrap(), tx200());
    for (joint, other) in read.dynamics().unwrap().iter().zip(expected.dynamics().unwrap()) {
        assert!((joint.link.centre() - other.link.centre()).amax() < 1e-15);
        assert_eq!((joint.link.mass(), joint.link.inertia()), (other.link.mass(), other.link.inertia()));
        assert_eq!((joint.damping, joint.orthogonal), (other.damping, other.orthogonal));
        assert_eq!(joint.gravity_compensated, other.gravity_compensated);
        assert!((joint.backlash - other.backlash).abs() < 1e-18 && (joint.bearing - other.bearing).abs() < 1e-15);
    }
    assert_eq!(read.constant_compliances(), expected.constant_compliances());
    for (joint, other) in read.joints().iter().zip(expected.joints()) {
        assert_eq!((joint.alpha, joint.a, joint.d), (other.alpha, other.a, other.d));
    }
    assert!(spindle().payload.is_some());
}

#[test]
fn a_robot_without_masses_stays_one_that_stands_still() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/robots/kuka-kr270-2.toml");
    let text = std::fs::read_to_string(file).unwrap();
    assert!(robot_from(&source(&text)).unwrap().dynamics().is_none());
    let message = moving_robot_from(&source(&text), false).unwrap_err().to_string();
    let first = line(&text, "[[joints]]", 0);
    for part in
        [&format!("arm.toml:{first}: joints[1].mass_kg: is missing"), "centre_of_mass_mm, inertia_kg_m2, damping_nms"]
    {
        assert!(message.contains(part), "{part} in {message}");
    }
}

#[test]
fn each_broken_rule_names_line_field_value_and_what_is_allowed() {
    let text = shipped();
    for (from, to, key, nth, parts) in [
        ("mass_kg = 256.0", "mass_kg = 0", "mass_kg", 1, ["joints[2].mass_kg: ", "found 0;", "above 0"]),
        ("mass_kg = 256.0", "mass_kg = -3", "mass_kg", 1, ["joints[2].mass_kg: ", "found -3;", "above 0"]),
        ("mass_kg = 256.0", "mass_kg = nan", "mass_kg", 1, ["joints[2].mass_kg: ", "found nan;", "above 0"]),
        ("mass_kg = 99.0", "", "[[joints]]", 2, ["joints[3].mass_kg: ", "is missing", "above 0"]),
        ("damping_nms_per_rad = 71.2", "", "[[joints]]", 5, ["joints[6].damping_nms_per_rad: ", "missing", "below 0"]),
        (
            "damping_nms_per_rad = 71.2",
            "damping_nms_per_rad = -1",
            "damping_nms",
            5,
            ["joints[6].damping_nms_per_rad: ", "found -1;", "not below 0"],
        ),
        (
            "{ xx = 12.25,",
            "{ xx = 42.25,",
            "inertia_kg_m2",
            0,
            ["joints[1].inertia_kg_m2: breaks the triangle inequality", "found { xx = 42.25", "rigid body"],
        ),
        (
            "xy = 0.07,",
            "xy = 0.7,",
            "inertia_kg_m2",
            2,
            ["joints[3].inertia_kg_m2: is not positive definite", "smallest principal moment is -0.", "rigid body"],
        ),
        (
            "yz = 0.06 }",
            "zy = 0.06 }",
            "inertia_kg_m2",
            3,
            ["joints[4].inertia_kg_m2.zy: ", "nearest known one", "xz, yz"],
        ),
        ("{ xx = 0.03,", "{ xx = 0.0,", "inertia_kg_m2", 4, ["joints[5].inertia_kg_m2.xx: ", "found 0.0", "above 0"]),
        ("bearing_mm = 279.0", "bearing = 279.0", "bearing =", 0, ["joints[3].bearing: ", "bearing_mm", "found 279"]),
        ("gravity_compensated = true", "gravity_compensated = 1", "gravity", 0, ["joints[2].grav", "found 1", "true"]),
        (
            "half_backlash_arcsec = 15.0",
            "half_backlash_arcsec = -15",
            "half",
            0,
            ["joints[1].half_b", "found -15", "not below 0"],
        ),
        (
            "orthogonal_stiffness_mnm_per_rad = 5.0",
            "",
            "[[joints]]",
            0,
            ["joints[1].orthogonal_stiffness_mnm_per_rad: ", "missing", "in every [[joints]]"],
        ),
    ] {
        assert!(text.contains(from), "{from}");
        let text = text.replacen(from, to, 1);
        let message = robot_from(&source(&text)).unwrap_err().to_string();
        let place = format!("arm.toml:{}: ", line(&text, key, nth));
        for part in parts.iter().chain(&[place.as_str(), "; allowed: "]) {
            assert!(message.contains(part), "{part} in {message}");
        }
    }
}

#[test]
fn stiffness_normal_to_the_axes_is_asked_for_where_it_is_needed() {
    let mut text = shipped();
    for part in ["orthogonal_stiffness_mnm_per_rad = 5.0\n", "orthogonal_damping_nms_per_rad = 1000.0\n"] {
        text = text.replace(part, "");
    }
    assert!(moving_robot_from(&source(&text), false).is_ok());
    let message = moving_robot_from(&source(&text), true).unwrap_err().to_string();
    let place = format!("arm.toml:{}: joints[1].orthogonal_stiffness_mnm_per_rad: ", line(&text, "[[joints]]", 0));
    assert!(message.contains(&place) && message.contains("orthogonal_damping_nms_per_rad in every"), "{message}");
}
