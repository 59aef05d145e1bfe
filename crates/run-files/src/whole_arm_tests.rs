//! What jobs beside the scores of placements count of a whole arm, and what they say that they leave out.

use crate::{
    Overrides, read_assessment, read_compensation, read_identification, read_run, read_simulation, read_stability,
};
use nalgebra::{Matrix3, Vector3};
use stead_calibration::compensation::compensate;
use stead_format::testing::root;
use stead_model::robot::Frames;
use stead_model::stiffness::whole::WholeArm;
use stead_numerics::monitor::Monitor;
use stead_simulation::stability_analysis::analyse;

/// A shipped file with pieces replaced, in a folder beside the others of its kind.
fn with_all(name: &str, changes: &[(&str, &str)]) -> (tempfile::TempDir, std::path::PathBuf) {
    let configs = root().join("configs");
    let mut text = std::fs::read_to_string(configs.join(name)).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{from} in {name}");
        text = text.replace(from, to);
    }
    let text = text.replace("\"robots/", &format!("\"{}/robots/", configs.display()));
    let text = text.replace("\"../tasks/", &format!("\"{}/tasks/", root().display()));
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
    let is_static = |note: &&String| note.contains("spindle.tip_um_per_n is of static deflection alone");
    assert_eq!(notes.iter().filter(is_static).count(), 1, "{notes:?}");
    for variant in stead_simulation::arm::Variant::ALL {
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

/// What the source of these springs has at the start of its program: lengths of the arm and its springs, on a spindle
/// of which it prints place and angle.
#[test]
fn eighteen_springs_of_the_tx200_yield_as_their_source_has_it() {
    let robot = stead_format::read_robot(&root().join("configs/robots/staubli-tx200-huynh.toml")).unwrap();
    let tilt = nalgebra::Rotation3::from_axis_angle(&Vector3::y_axis(), 75_f64.to_radians());
    let spindle = stead_model::robot::Spindle::new(*tilt.matrix(), Vector3::new(0.277, 0.0, 0.326)).unwrap();
    // -90, 30, 95, 0, 0, 0 deg of the encoders.
    let theta = [-90.0, 30.0 - 90.0, 95.0 + 90.0, 0.0, 0.0, 0.0].map(f64::to_radians);
    let frames = Frames::new(&robot, &theta);
    let tip = frames.base_from_flange.point(&spindle.flange_from_tool.translation);
    let arm = WholeArm::new(&robot, &spindle, &frames, robot.compliances_at(&theta), tip);
    let column = |k: usize| arm.displacement(&Vector3::ith(k, 1.0), &Vector3::zeros()).linear * 1e6;
    let found = Matrix3::from_columns(&[column(0), column(1), column(2)]);
    panic!("{tip} {found}");
}

/// An arm of the same geometry that has springs beside those about the axes.
fn full_kr270(folder: &std::path::Path, head: &str) -> std::path::PathBuf {
    let text = std::fs::read_to_string(root().join("configs/robots/kuka-kr270-2.toml")).unwrap();
    let text = text.replace("\n[[joints]]", "\n[[joints]]\northogonal_compliance_urad_per_nm = 0.1");
    let text = text.replacen("\nname = ", &format!("\n{head}\nname = "), 1);
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
