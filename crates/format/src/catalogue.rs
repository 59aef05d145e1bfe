//! The arms that stead ships with: robot files that are part of the program, named `name:kuka-kr270-2` where a file is
//! requested.

use crate::robot::{JointRow, RobotFile, geometry_from};
use crate::shipped::{ARMS, PREFIX, text};
use crate::toml_file::{TomlFile, without_schema};
use std::path::Path;
use stead_disk::input::InputError;
use stead_model::robot::ShippedArm;

/// All shipped arms, in the order of their names.
///
/// # Errors
/// [`InputError`] where a shipped file is wrong, which the tests exclude.
pub fn shipped_arms() -> Result<Vec<ShippedArm>, InputError> {
    ARMS.iter().map(|(name, _)| shipped_arm(name)).collect()
}

/// The robot file of a shipped arm, by its name with or without `name:`, to begin one's own with.
///
/// # Errors
/// [`InputError`] where there is no arm of this name.
pub fn robot_file(name: &str) -> Result<&'static str, InputError> {
    let path = format!("{PREFIX}{}", name.strip_prefix(PREFIX).unwrap_or(name));
    Ok(without_schema(text(Path::new(&path)).transpose()?.unwrap_or_default()))
}

/// A shipped arm by its name.
fn shipped_arm(name: &'static str) -> Result<ShippedArm, InputError> {
    let path = format!("{PREFIX}{name}");
    let text = text(Path::new(&path)).transpose()?.unwrap_or_default();
    let source = TomlFile::new(Path::new(&path), text.as_bytes().to_vec())?;
    let file: RobotFile = source.parse()?.read()?;
    Ok(ShippedArm {
        name,
        robot: geometry_from(&source)?,
        has_stiffness: file.joints.iter().all(JointRow::has_stiffness),
        has_dynamics: file.joints.iter().all(|row| row.mass_kg.is_some()),
        source: file.source,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Vector3};
    use std::collections::BTreeSet;
    use stead_model::robot::Robot;
    use stead_model::robot::{ControllerKind, Pose};
    use stead_numerics::rotation::rotation_from_vector;

    #[test]
    fn every_shipped_file_is_there_by_its_name() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/robots");
        let files: BTreeSet<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap().replace(".toml", ""))
            .collect();
        let names: Vec<&str> = ARMS.iter().map(|(name, _)| *name).collect();
        assert!(names.is_sorted());
        assert_eq!(names.into_iter().map(str::to_owned).collect::<BTreeSet<_>>(), files);
    }

    #[test]
    fn arms_say_what_is_known_of_them() {
        let arms = shipped_arms().unwrap();
        let arm = |name: &str| arms.iter().find(|arm| arm.name == name).unwrap();
        assert!(arms.iter().filter(|arm| arm.has_stiffness).count() >= 12);
        assert!(arm("staubli-tx200").has_dynamics && !arm("abb-irb6640-235").has_stiffness);
        assert!(arm("kuka-kr240-2").robot.unverified().len() == 3);
        // Figures that were taken over from a source which is about another arm or says nothing of it, and where each
        // comes from.
        for (name, word) in [("kuka-kr210-2", "stiffness: "), ("kuka-kr360-l240", "payload: 360 kg is what Klimchik")] {
            let unverified = arm(name).robot.unverified();
            assert!(unverified.iter().any(|what| what.starts_with(word)), "{name}: {unverified:?}");
        }
        for (name, source) in [("abb-irb6640-185", "MIT Sim.xml"), ("staubli-rx160l", "Bartlett.xml")] {
            let text = robot_file(name).unwrap();
            assert!(
                text.contains("; limits, speeds: visose/Robots") && text.contains(&format!("{source}\"\n")),
                "{text}"
            );
        }
        // All but the one of a maker whose controllers nothing is written for say how they count.
        let silent: Vec<&str> =
            arms.iter().filter(|arm| arm.robot.controller().is_none()).map(|arm| arm.name).collect();
        assert_eq!(silent, ["motoman-ms210"]);
    }

    #[test]
    fn arms_with_a_parallelogram_say_so() {
        let arms = shipped_arms().unwrap();
        let linked: Vec<&ShippedArm> = arms.iter().filter(|arm| arm.robot.has_linkage()).collect();
        assert_eq!(linked.iter().map(|arm| arm.name).collect::<Vec<_>>(), ["abb-irb4400-60", "fanuc-m900ia-260l"]);
        // The range of A3 at the controller, whatever A2.
        let ranges: [(&str, [f64; 2]); 2] = [("abb-irb4400-60", [65.0, -60.0]), ("fanuc-m900ia-260l", [-196.3, 165.0])];
        for (arm, (name, ends)) in linked.iter().zip(ranges) {
            let (robot, controller) = (&arm.robot, arm.robot.controller().unwrap());
            assert_eq!((arm.name, controller.is_j3_level), (name, Some(true)));
            let sum = robot.sum_range().unwrap();
            for (end, a3) in [sum.min, sum.max].into_iter().zip(ends) {
                for a2 in [-20.0_f64, 0.0, 35.0] {
                    let joints = controller.joints(robot, &[0.0, a2.to_radians(), a3.to_radians(), 0.0, 0.0, 0.0]);
                    assert!((robot.sum_of(&joints) - end).abs() < 1e-12, "{name}");
                }
            }
            assert!(!robot.unverified().is_empty());
        }
    }

    /// A point on an axis in m, and its direction.
    type Axis = ([f64; 3], [f64; 3]);

    /// The axes of an arm at controller angles zero as its maker defines them: a point on each, its direction; then the
    /// flange. Written from the makers' drawings, without the rows.
    fn zero_pose(robot: &Robot) -> ([Axis; 6], Pose<f64>) {
        let [first, second, third, fourth, _, sixth] = robot.joints();
        let (low, shoulder, upper) = (first.d, second.a, third.a);
        let (rise, forearm, hand, aside) = (-fourth.a, fourth.d, sixth.d, -third.d);
        let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let back = |v: [f64; 3]| v.map(|v| -v);
        let turned = |columns: [[f64; 3]; 3]| Matrix3::from_columns(&columns.map(Vector3::from));
        let kind = robot.controller().unwrap().kind;
        let elbow = match kind {
            // The arm stretched out level.
            ControllerKind::Kuka => [shoulder + upper, 0.0, low],
            _ => [shoulder, aside, low + upper],
        };
        let [ex, ey, ez] = elbow;
        let (wrist, flange) = match kind {
            ControllerKind::Staubli => ([ex, ey, ez + forearm], [ex, ey, ez + forearm + hand]),
            _ => ([ex + forearm, ey, ez + rise], [ex + forearm + hand, ey, ez + rise]),
        };
        let (directions, rotation) = match kind {
            ControllerKind::Kuka => ([back(z), y, y, back(x), y, back(x)], turned([back(z), y, x])),
            ControllerKind::Abb => ([z, y, y, x, y, x], turned([back(z), y, x])),
            ControllerKind::Fanuc => ([z, y, back(y), back(x), back(y), back(x)], turned([z, back(y), x])),
            ControllerKind::Staubli => ([z, y, y, z, y, z], turned([x, y, z])),
        };
        let points = [[0.0; 3], [shoulder, 0.0, low], elbow, wrist, wrist, wrist];
        let axes = std::array::from_fn(|joint| (points[joint], directions[joint]));
        (axes, Pose { rotation, translation: flange.into() })
    }

    /// Rows and controller angles together give the flange where turning the maker's own axes one after the other
    /// brings it.
    #[test]
    fn controller_angles_turn_the_axes_as_the_maker_says() {
        let mut seen = 0;
        for arm in shipped_arms().unwrap() {
            let Some(controller) = arm.robot.controller().copied() else { continue };
            // This file is for other rows than the rest: those of its paper.
            let is_same_rows = arm.robot.joints()[1].alpha > 0.0;
            if !is_same_rows {
                continue;
            }
            seen += 1;
            let (axes, zero) = zero_pose(&arm.robot);
            for trial in 0..20 {
                let angles: [f64; 6] = std::array::from_fn(|joint| libm::sin((trial * 7 + joint * 3 + 1) as f64) * 2.0);
                let mut turned = angles;
                match (controller.kind, arm.robot.has_linkage()) {
                    (ControllerKind::Fanuc, _) => turned[2] += angles[1],
                    (ControllerKind::Abb, true) => turned[2] -= angles[1],
                    _ => {}
                }
                let expected = axes.iter().zip(turned).rev().fold(zero, |pose, ((point, axis), angle)| {
                    let rotation = rotation_from_vector(&(Vector3::from(*axis) * angle));
                    let point = Vector3::from(*point);
                    Pose { rotation, translation: point - rotation * point }.then(&pose)
                });
                let found = arm.robot.forward(&controller.joints(&arm.robot, &angles));
                let off =
                    (found.translation - expected.translation).norm() + (found.rotation - expected.rotation).norm();
                assert!(off < 1e-12, "{}: {off}", arm.name);
            }
        }
        assert!(seen > 40, "{seen}");
    }

    #[test]
    fn an_unknown_name_is_refused_with_the_nearest() {
        let message = text(Path::new("name:kuka-kr2702")).unwrap().unwrap_err().to_string();
        assert!(
            message.starts_with("name:kuka-kr2702: is no shipped arm; allowed: kuka-kr270-2, or another of "),
            "{message}"
        );
        assert!(text(Path::new("robots/kuka-kr270-2.toml")).is_none());
        assert!(robot_file("abb-irb120").unwrap().starts_with("# ABB IRB 120-3/0.6. Six rows"));
        assert!(robot_file("name:abb-irb120").is_ok() && robot_file("abb").is_err());
    }
}
