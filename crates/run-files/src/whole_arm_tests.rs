//! What jobs beside the scores of placements count of a whole arm, and what they say that they leave out.

use crate::{
    Overrides, read_assessment, read_compensation, read_identification, read_run, read_simulation, read_stability,
};
use nalgebra::{Matrix3, Vector3};
use stead_calibration::compensation::compensate;
use stead_format::testing::root;
use stead_format::toml_file::TomlFile;
use stead_model::robot::{Frames, Inertial, Pose, Posture, Spindle};
use stead_model::stiffness::whole::WholeArm;
use stead_numerics::monitor::Monitor;
use stead_numerics::rotation::rotation_from_zyx;
use stead_simulation::arm::{Arm, Variant};
use stead_simulation::modes::LinearArm;
use stead_simulation::stability_analysis::analyse;

/// A shipped file with pieces replaced, in a folder beside the others of its kind.
fn with_all(name: &str, changes: &[(&str, &str)]) -> (tempfile::TempDir, std::path::PathBuf) {
    let configs = root().join("configs");
    let mut text = std::fs::read_to_string(configs.join(name)).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{from} in {name}");
        text = text.replace(from, to);
    }
    let root = std::path::absolute(root()).unwrap().display().to_string().replace('\\', "/");
    let text = text.replace("\"robots/", &format!("\"{root}/configs/robots/"));
    let text = text.replace("\"../tasks/", &format!("\"{root}/tasks/"));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(name);
    std::fs::write(&file, text).unwrap();
    (folder, file)
}

fn with(name: &str, from: &str, to: &str) -> (tempfile::TempDir, std::path::PathBuf) {
    with_all(name, &[(from, to)])
}

const TIP: &str = "[spindle]\ntip_um_per_n = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.02]]";

#[test]
fn springs_are_not_fitted_about_the_axes_of_an_arm_that_has_others() {
    let (_folder, file) = with("identify-example.toml", "robots/kuka-kr270-2.toml", "name:kuka-kr210-2-full");
    let message = read_identification(&file).unwrap_err().to_string();
    for part in ["robot: states springs normal to the axes", "fitted by those about the axes alone", "; allowed: "] {
        assert!(message.contains(part), "{part} in {message}");
    }
}

#[test]
fn an_assessment_counts_the_springs_of_the_joints_and_notes_what_it_leaves_out() {
    let (_folder, file) = with_all(
        "horizontal-slot.toml",
        &[("robots/kuka-kr360-l240.toml", "name:kuka-kr210-2-full"), ("[spindle]", TIP)],
    );
    let run = read_assessment(&file).unwrap();
    let notes = |part: &str| run.notes.iter().filter(|note| note.contains(part)).count();
    assert_eq!(
        notes("springs normal to the joint axes count as stated (KUKA KR 210-2 (full set"),
        1,
        "{:?}",
        run.notes
    );
    assert_eq!(notes("no comparison of like with like"), 1, "{:?}", run.notes);
    assert_eq!(notes("spindle.tip_um_per_n is left out: the joints are assessed"), 1, "{:?}", run.notes);
    let shipped = read_assessment(&root().join("configs/klimchik-2017.toml")).unwrap();
    assert!(shipped.notes.iter().all(|note| !note.contains("springs normal")), "{:?}", shipped.notes);
}

#[test]
fn motion_and_stability_note_matrices_and_warn_of_springs_that_the_variant_leaves_out() {
    let robot = ("robots/staubli-tx200.toml", "name:staubli-tx200-huynh");
    let (_folder, file) = with_all("umons-aluminium.toml", &[robot, ("[spindle]", TIP)]);
    let run = read_simulation(&file, &Overrides::default()).unwrap();
    let notes = run.setup.notes();
    let is_static =
        |note: &&stead_numerics::message::Note| note.contains("spindle.tip_um_per_n is of static deflection alone");
    assert_eq!(notes.iter().filter(is_static).count(), 1, "{notes:?}");
    for &(_, variant) in Variant::WORDS {
        let run = read_stability(&file, &Overrides { variant: Some(variant), ..Overrides::default() }).unwrap();
        let warnings = run.setup.warnings();
        let is_left_out = matches!(variant.word(), "springs" | "gravity");
        assert_eq!(warnings.len(), usize::from(is_left_out), "{warnings:?}");
        assert!(warnings.iter().all(|warning| warning.kind == "springs-left-out"));
    }
    let found = analyse(&run.setup, &run.cutter, &run.cut, &run.analysis, &Monitor::silent()).unwrap();
    assert_eq!(found.warnings.len(), 1);
    assert!(found.warnings[0].message.contains("variant orthogonal has them"), "{}", found.warnings[0]);
    let (_folder, file) = with("tx200-stability.toml", "robots/staubli-tx200.toml", "name:staubli-tx200-huynh");
    let run = read_run(&file).unwrap();
    assert_eq!(run.warnings.iter().filter(|warning| warning.kind == "springs-left-out").count(), 1);
}

/// The static compliance at the tool that other code has for these springs, with the spindle and at the start of the
/// path of the program that states them; in its workpiece frame, um/N.
#[test]
fn eighteen_springs_of_the_tx200_yield_as_other_code_has_it() {
    let robot = stead_format::read_robot(&root().join("configs/robots/staubli-tx200-huynh.toml")).unwrap();
    let tilt = nalgebra::Rotation3::from_axis_angle(&Vector3::y_axis(), 75_f64.to_radians());
    let spindle = Spindle::new(*tilt.matrix(), Vector3::new(0.277, 0.0, 0.326)).unwrap();
    // -90, 30, 95, 0, 0, 0 deg of the encoders bring the tool over the corner of the part.
    let near = [-90.0, 30.0 - 90.0, 95.0 + 90.0, 0.0, 0.0, 0.0].map(f64::to_radians);
    let corner = robot.forward(&near).then(&spindle.flange_from_tool).translation;
    assert!((corner - Vector3::new(0.0, -1.6474000255922296, 0.4806981213437843)).norm() < 1e-12, "{corner}");
    // The path begins 25 mm before it in both directions and 5 mm above, with the tool upright.
    let quarter = std::f64::consts::FRAC_PI_2;
    let upright = rotation_from_zyx([quarter, 0.0, 2.0 * quarter]);
    let tool = Pose { rotation: upright, translation: Vector3::new(-0.025, -1.6224, 0.4857) };
    let flange = tool.then(&spindle.flange_from_tool.inverse());
    let posture = Posture::of(&robot, &[near[0], near[1], near[2], near[3], -0.6, near[5]]);
    let theta = robot.inverse(&flange, posture).unwrap();
    let frames = Frames::new(&robot, &theta);
    let arm = WholeArm::new(&robot, &spindle, &frames, robot.compliances_at(&theta), tool.translation);
    let column = |k: usize| arm.displacement(&Vector3::ith(k, 1.0), &Vector3::zeros()).linear * 1e6;
    let found = Matrix3::from_columns(&[column(0), column(1), column(2)]);
    // The workpiece is a quarter turn behind the base: its x is the base's -y.
    let diagonal = [found[(1, 1)], found[(0, 0)], found[(2, 2)]];
    for (found, printed) in diagonal.into_iter().zip([1.467, 2.611, 1.875]) {
        assert!((found - printed).abs() <= 0.0005, "{diagonal:?}");
    }
    // The springs of the moving arm, at rest without gravity, are the same.
    let full = stead_format::robot::moving_robot_from(
        &TomlFile::read(&root().join("configs/robots/staubli-tx200-huynh.toml")).unwrap(),
        true,
    );
    let body = Inertial::new(61.4, Vector3::zeros(), Matrix3::identity()).unwrap();
    let spindle = Spindle { payload: Some(body), ..spindle };
    let moving = Arm::eighteen(&full.unwrap(), &spindle, Variant::Springs, &theta).unwrap();
    let linear = LinearArm::of(&moving, &Arm::<18>::spread(&theta), 1.0);
    let response = linear.response(0.0).unwrap().map(|entry| entry.re * 1e6);
    assert!((response - found).norm() < 1e-9 * found.norm(), "{response} {found}");
}

/// An arm of the same geometry that has springs beside those about the axes.
fn full_kr270(folder: &std::path::Path, head: &str) -> std::path::PathBuf {
    let text = std::fs::read_to_string(root().join("configs/robots/kuka-kr270-2.toml")).unwrap();
    let text = text.replace("\n[[joints]]", "\n[[joints]]\northogonal_compliance_urad_per_nm = 0.1");
    let text = text.replacen("\nstiffness_model = \"axes\"", &format!("\n{head}"), 1);
    let file = folder.join("full.toml");
    std::fs::write(&file, text).unwrap();
    file
}

#[test]
fn corrections_are_played_on_a_full_arm_and_what_they_do_not_know_is_left() {
    let folder = tempfile::tempdir().unwrap();
    let reality = full_kr270(folder.path(), "stiffness_model = \"full\"");
    let config = root().join("configs/compensate-caro-2013.toml");
    let run = read_compensation(&config, Some(&reality), &Monitor::silent()).unwrap();
    assert!(run.job.reality.normal_springs().is_some() && run.job.robot.normal_springs().is_none());
    let path = compensate(&run.job, &Monitor::silent()).unwrap();
    let alone = read_compensation(&config, None, &Monitor::silent()).unwrap();
    let about_axes = compensate(&alone.job, &Monitor::silent()).unwrap();
    assert!(path.points.iter().zip(&about_axes.points).all(|(a, b)| a.command == b.command));
    for (point, known) in path.points.iter().zip(&about_axes.points) {
        let [before, after, known] =
            [point.before, point.after, known.before].map(|deflection| deflection.unwrap().linear);
        assert!((before - known - after).norm() < 0.01 * after.norm() + 1e-9, "{before} {known} {after}");
    }
    assert!(path.deflections()[1].mean > 0.02 * path.deflections()[0].mean);
    // Springs of another set are refused, as in scores.
    let mixed = full_kr270(folder.path(), "stiffness_model = \"axes\"");
    let message = read_compensation(&config, Some(&mixed), &Monitor::silent()).unwrap_err().to_string();
    assert!(message.contains("stiffness_model: is \"axes\", beside springs normal to the axes"), "{message}");
}
