//! What the user should know about a run though it is not wrong, in sentences.

use stead_format::field::FieldOverride;
use stead_format::tool::{Cutting, ToolTable};
use stead_model::plausibility;
use stead_model::robot::Robot;
use stead_model::task::{Task, ToolPath};
use stead_numerics::message::Note;

/// A feed that misses the plane normal to the tool axis by no more than this is normal to it. deg
const NORMAL_FEED_DEG: f64 = 0.1;

/// A value that is not that of the files.
pub(super) fn override_note(field: &FieldOverride) -> String {
    format!("{} is {} in place of what the files say", field.path(), field.value())
}

/// The largest tilt of the feed, where there is one.
pub(super) fn tilt_note(path: &ToolPath, lines: &[usize]) -> Option<String> {
    let tilts = path.points().iter().zip(lines).map(|(point, line)| (point.feed_tilt().abs().to_degrees(), line));
    let steepest = tilts.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(tilt, _)| *tilt > NORMAL_FEED_DEG);
    steepest.map(|(tilt, line)| {
        format!(
            "feed is up to {tilt:.2} deg off the normal of the tool axis (task line {line}): \
             the wall normal is axis x feed"
        )
    })
}

/// A feed that points away from the next point by more than this is suspicious. deg
const FEED_TO_PATH_DEG: f64 = 60.0;

/// The first point whose feed does not point along the path.
pub(super) fn direction_note(task: &Task) -> Option<String> {
    let points = task.points();
    let off = |point: &usize| {
        let (feed, chord) = (points[point - 1].feed, points[*point].position - points[point - 1].position);
        libm::acos((feed.dot(&chord) / chord.norm()).clamp(-1.0, 1.0)).to_degrees()
    };
    // The feed of a point that is not scored says nothing, and neither does the way to one.
    let are_scored = |point: &usize| task.path().is_scored(*point) && task.path().is_scored(point - 1);
    let mut inner = task.segments().iter().flat_map(|span| span.clone().skip(1)).filter(are_scored);
    let first = inner.find(|point| off(point) > FEED_TO_PATH_DEG)?;
    let (from, angle) = (first - 1, off(&first));
    Some(format!("at point {from} the feed is {angle:.0} deg off the way to the next point: check the signs of feed_*"))
}

/// The joints whose speed is not known, where there are some.
pub(super) fn speed_note(robot: &Robot) -> Option<Note> {
    let unknown = robot.joints().iter().zip(1..).filter(|(joint, _)| joint.max_speed.is_none());
    let numbers: Vec<String> = unknown.map(|(_, number): (_, usize)| number.to_string()).collect();
    (!numbers.is_empty()).then(|| {
        let text = format!(
            "the robot file gives no max_speed_deg_per_s for joints {}: their steps along the path are not bounded, \
             and the times of moves between segments are not known",
            numbers.join(", ")
        );
        Note::not_checked("joint speeds", text)
    })
}

/// Numbers of cutter and cut that look wrong, of a run without a stock, which says them itself.
pub(super) fn cutter_notes(tool: Option<&ToolTable>, cutting: Option<&Cutting<'_>>, has_stock: bool) -> Vec<String> {
    match cutting {
        _ if has_stock => Vec::new(),
        Some(cutting) => cutting.notes(),
        None => tool.map(ToolTable::notes).unwrap_or_default(),
    }
}

/// Forces of single points that look like slips, where the task states them itself.
pub(super) fn force_note(task: &Task, has_columns: bool) -> Option<String> {
    let size = |point: usize| (point, task.loads()[point].wrench.force.norm());
    let scored = |span: &std::ops::Range<usize>| span.clone().filter(|point| task.path().is_scored(*point)).map(size);
    let segments: Vec<Vec<(usize, f64)>> = task.segments().iter().map(|span| scored(span).collect()).collect();
    has_columns.then(|| plausibility::forces(&segments)).flatten()
}

#[cfg(test)]
mod tests {
    use crate::testing::{RUN, folder};
    use stead_numerics::message::Note;
    use stead_runs::Run;

    /// The notes of a run with pieces of its files replaced.
    fn notes(changes: &[(&str, &str, &str)]) -> Vec<Note> {
        let folder = folder();
        std::fs::write(folder.path().join("run.toml"), RUN).unwrap();
        for (file, from, to) in changes {
            let file = folder.path().join(file);
            let text = std::fs::read_to_string(&file).unwrap();
            assert!(text.contains(from), "{from}");
            std::fs::write(&file, text.replacen(from, to, 1)).unwrap();
        }
        let Run { notes, .. } = crate::read_run(&folder.path().join("run.toml")).unwrap();
        notes
    }

    #[track_caller]
    fn noted(changes: &[(&str, &str, &str)], start: &str) {
        let all = notes(changes);
        assert!(all.iter().any(|note| note.starts_with(start)), "{start} in {all:?}");
    }

    const CUT: &str = "[tool]\ncutter_diameter_mm = 16\nteeth = 2\nkt_mpa = 800\nkr = 0.4\nkte_n_per_mm = 20\nkre_n_per_mm = 20\n\
                       [cut]\nmilling = 'climb'\nradial_depth_mm = 2\naxial_depth_mm = 5\nfeed_per_tooth_mm = 0.05\n[spindle]\n";

    #[test]
    fn numbers_of_cutter_and_cut_are_noted_without_a_stock_too() {
        let with = |from: &str, to: &str| {
            let cut = CUT.replacen(from, to, 1);
            notes(&[("run.toml", "task.csv", "path.csv"), ("run.toml", "[spindle]\n", &cut)])
        };
        assert!(!with("kr", "kr").iter().any(|note| note.starts_with("tool.") || note.starts_with("cut.")));
        for (from, to, start) in [
            ("kt_mpa = 800", "kt_mpa = 12000", "tool.kt_mpa is 12000 MPa, where 0 to 10000 MPa are usual"),
            ("kr = 0.4", "kr = 6", "tool.kr is 6.00 times kt_mpa"),
            ("kte_n_per_mm = 20", "kte_n_per_mm = 600", "tool.kte_n_per_mm is 600 N/mm"),
            ("kre_n_per_mm = 20", "kre_n_per_mm = 600", "tool.kre_n_per_mm is 600 N/mm"),
            (
                "axial_depth_mm = 5",
                "axial_depth_mm = 40",
                "cut.axial_depth_mm is 40.0 mm, where 0 to 32.0 mm are usual",
            ),
            ("feed_per_tooth_mm = 0.05", "feed_per_tooth_mm = 0.9", "feed per tooth is 0.900 mm"),
            ("[cut]", "[cut]\nspindle_rpm = 90", "cut.spindle_rpm is 90.0 1/min"),
        ] {
            let all = with(from, to);
            assert!(all.iter().any(|note| note.starts_with(start)), "{start} in {all:?}");
        }
        noted(
            &[("run.toml", "[cell]", "[tool]\ncutter_diameter_mm = 0.4\n[cell]")],
            "tool.cutter_diameter_mm is 0.400 mm, where 0.500 to 500 mm are usual",
        );
    }

    #[test]
    fn what_is_shipped_looks_right() {
        let files = std::fs::read_dir(stead_format::testing::root().join("configs")).unwrap();
        let files = files.map(|file| file.unwrap().path()).filter(|file| file.extension().is_some_and(|e| e == "toml"));
        let mut count = 0;
        for file in files.filter(|file| std::fs::read_to_string(file).unwrap().contains("\n[redundancy]")) {
            let Run { notes, .. } = crate::read_run(&file).unwrap();
            let parts = ["usual", "ten times", "is it in degrees", "points back to the flange", "the force at point"];
            let odd: Vec<&Note> = notes.iter().filter(|note| parts.iter().any(|part| note.contains(part))).collect();
            assert!(odd.is_empty(), "{}: {odd:?}", file.display());
            count += 1;
        }
        assert!(count > 8, "{count}");
    }

    #[test]
    fn a_slip_of_a_force_column_is_noted_with_its_point() {
        let rows = "1,20,0,0,1,0,0,0,0,1,10,20,0\n1,30,0,0,1,0,0,0,0,1,10,2000,0\n1,40,0,0,1,0,0,0,0,1,10,20,0\n";
        let last = "1,10,0,0,1,0,0,0,0,1,10,20,0\n";
        noted(
            &[("task.csv", last, &format!("{last}{rows}"))],
            "the force at point 3 is 2000 N, where half of the points",
        );
        assert!(!notes(&[]).iter().any(|note| note.starts_with("the force at point")));
    }

    #[test]
    fn angles_in_radians_are_noted_in_run_and_robot_file() {
        let rotation = "rotation = [[0, -0.70710678, 0.70710678], [1, 0, 0], [0, 0.70710678, 0.70710678]]";
        noted(&[("run.toml", rotation, "abc_deg = [0, 1.5708, 0]")], "spindle.abc_deg[2] is 1.5708, which is pi/2");
        noted(
            &[("run.toml", "z_mm = [-500", "yaw_deg = [-3.14, 3.14]\nz_mm = [-500")],
            "cell.yaw_deg[1] is -3.14, which is -pi",
        );
        let home = std::fs::read_to_string(folder().path().join("arm.toml")).unwrap();
        let limit = home.lines().find(|line| line.starts_with("max_deg = ")).unwrap();
        noted(&[("arm.toml", limit, "max_deg = 6.2832")], "robot.joints[1].max_deg is 6.2832, which is 2 pi");
    }

    #[test]
    fn angles_of_the_spindle_in_another_order_are_noted() {
        let rotation = "rotation = [[0, -0.70710678, 0.70710678], [1, 0, 0], [0, 0.70710678, 0.70710678]]";
        noted(
            &[("run.toml", rotation, "wpr_deg = [180, 0, 0]")],
            "spindle.wpr_deg: the tool points back to the flange",
        );
    }

    #[test]
    fn limits_of_the_rotation_of_the_spindle_that_hardly_let_it_turn_are_noted() {
        noted(
            &[("run.toml", "max_beta_rate_deg_per_mm = 0.9", "max_spindle_turn_deg_per_mm = 0.009")],
            "redundancy.max_spindle_turn_deg_per_mm is 0.00900 deg/mm, where at least 0.0100 deg/mm is usual",
        );
        noted(
            &[("run.toml", "max_beta_rate_deg_per_mm = 0.9", "max_beta_rate_deg_per_mm = 0.009")],
            "redundancy.max_beta_rate_deg_per_mm is 0.00900 deg/mm",
        );
    }

    #[test]
    fn what_the_flange_carries_and_soft_holders_are_noted() {
        let carried = "[spindle]\nmass_kg = 3000\ncentre_of_mass_mm = [0, 0, 0.2]\n";
        noted(&[("run.toml", "[spindle]\n", carried)], "spindle.mass_kg is 3000 kg, where 0 to 2000 kg are usual");
        noted(&[("run.toml", "[spindle]\n", carried)], "spindle.centre_of_mass_mm is 0.200 mm from the flange");
        let soft = "[spindle]\ntip_um_per_n = [[400, 0, 0], [0, 400, 0], [0, 0, 400]]\n";
        noted(&[("run.toml", "[spindle]\n", soft)], "holder and tool yields by 400 um/N at the tool");
    }
}
