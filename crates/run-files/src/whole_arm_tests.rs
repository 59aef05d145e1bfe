//! Jobs that count the springs about the axes alone say so of an arm that has others, or refuse it.

use crate::{Overrides, read_assessment, read_compensation, read_identification, read_simulation};
use stead_format::testing::root;
use stead_numerics::monitor::Monitor;

/// A shipped file with one piece replaced, in a folder beside the others of its kind.
fn with(name: &str, from: &str, to: &str) -> (tempfile::TempDir, std::path::PathBuf) {
    let configs = root().join("configs");
    let text = std::fs::read_to_string(configs.join(name)).unwrap();
    assert!(text.contains(from), "{from} in {name}");
    let text = text.replace(from, to).replace("\"robots/", &format!("\"{}/robots/", configs.display()));
    let text = text.replace("\"../tasks/", &format!("\"{}/tasks/", root().display()));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(name);
    std::fs::write(&file, text).unwrap();
    (folder, file)
}

#[test]
fn springs_are_not_fitted_about_the_axes_of_an_arm_that_has_others() {
    let (_folder, file) = with("identify-example.toml", "robots/kuka-kr270-2.toml", "name:kuka-kr210-2-full");
    let message = read_identification(&file).unwrap_err().to_string();
    for part in ["robot: states springs normal to the axes", "fitted by those about the axes alone", "; allowed: "] {
        assert!(message.contains(part), "{part} in {message}");
    }
}

#[test]
fn an_assessment_and_a_correction_note_what_they_leave_out() {
    let (_folder, file) = with("horizontal-slot.toml", "robots/kuka-kr360-l240.toml", "name:kuka-kr210-2-full");
    let run = read_assessment(&file).unwrap();
    let is_about = |note: &&String| note.contains("only its springs about the joint axes are counted here");
    assert_eq!(run.notes.iter().filter(is_about).count(), 1, "{:?}", run.notes);
    // An arm of the same geometry that has springs beside those about the axes, as what the commands are played on.
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(root().join("configs/robots/kuka-kr270-2.toml")).unwrap();
    let text = text.replace("\n[[joints]]", "\n[[joints]]\northogonal_compliance_urad_per_nm = 0.1");
    let text = text.replacen("\"axes\"", "\"full\"", 1);
    let reality = folder.path().join("full.toml");
    std::fs::write(&reality, text).unwrap();
    let config = root().join("configs/compensate-caro-2013.toml");
    let run = read_compensation(&config, Some(&reality), &Monitor::silent()).unwrap();
    assert!(run.job.reality.normal_springs().is_some());
    assert_eq!(run.notes.iter().filter(is_about).count(), 1, "{:?}", run.notes);
    assert_eq!(read_compensation(&config, None, &Monitor::silent()).unwrap().notes.iter().filter(is_about).count(), 0);
}

#[test]
fn what_yields_on_the_flange_is_refused_where_it_has_no_effect() {
    let tip = "[spindle]\ntip_um_per_n = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.02]]";
    let (_folder, file) = with("umons-aluminium.toml", "[spindle]", tip);
    let message = read_simulation(&file, &Overrides::default()).unwrap_err().to_string();
    assert!(message.contains("spindle.tip_um_per_n: is counted in the scores of placements alone"), "{message}");
    let (_folder, file) = with("horizontal-slot.toml", "[spindle]", tip);
    let message = read_assessment(&file).unwrap_err().to_string();
    assert!(message.contains("spindle.tip_um_per_n: is counted in the scores of placements alone"), "{message}");
}
