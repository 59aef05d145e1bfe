//! A run file for a robot and a task that are there.

use crate::files::new::write_new;
use crate::input::InputError;
use crate::robot::{read_geometry, says_stiffness};
use crate::shipped;
use crate::task::read_csv;
use std::path::{Component, Path, PathBuf, absolute};
use stead_model::robot::Robot;
use stead_model::task::PathPoint;

/// Writes a run file for `stead place` that names a robot file, or a shipped arm by `name:`, and a task file. What neither says is
/// filled in by a guess from the reach of the arm, and marked as one: spindle, cell and, for a task without forces, the forces. Shapes of the
/// links beside the robot file (`NAME-cell.toml`) are its surroundings.
///
/// # Errors
/// [`InputError`]: robot or task are wrong, or the run file is there already or cannot be written.
pub fn init_run(robot: &Path, task: &Path, out: &Path) -> Result<(), InputError> {
    let arm = read_geometry(robot)?;
    let imported = read_csv(task)?;
    let folder = out.parent().unwrap_or(Path::new(""));
    let robot_name = match shipped::text(robot) {
        Some(_) => robot.display().to_string(),
        None => relative(folder, robot),
    };
    let has_stiffness = says_stiffness(robot)?.unwrap_or(true);
    let names = [robot_name, relative(folder, task)];
    let mut text = text(&arm, imported.path.points(), imported.wrenches.is_some(), &names, has_stiffness);
    if let Some(cell) = shapes_beside(robot) {
        let name = toml::Value::from(relative(folder, &cell)).to_string();
        let keys = format!(
            "surroundings = {name}   # shapes of the links; those of table, fence and fixture belong beside them"
        );
        text = text.replacen("\n\n[spindle]", &format!("\n{keys}\n\n[spindle]"), 1);
    }
    write_new(out, &text)
}

/// The shapes of the links that `stead import robot --collision` has written beside a robot file.
fn shapes_beside(robot: &Path) -> Option<PathBuf> {
    let cell = robot.with_file_name(format!("{}-cell.toml", robot.file_stem()?.to_string_lossy()));
    (shipped::text(robot).is_none() && cell.is_file()).then_some(cell)
}

/// The name of a file seen from a folder, with forward slashes; the whole name where there is no way between them.
fn relative(folder: &Path, file: &Path) -> String {
    let (Ok(folder), Ok(file)) = (absolute(folder.join(".")), absolute(file)) else { return shown(file) };
    let (from, to): (Vec<Component<'_>>, Vec<Component<'_>>) =
        (folder.components().collect(), file.components().collect());
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    // Another drive, or a way through a folder whose name is not known.
    if common == 0 || from[common..].contains(&Component::ParentDir) {
        return shown(&file);
    }
    let up = std::iter::repeat_n(Component::ParentDir, from.len() - common);
    shown(&up.chain(to[common..].iter().copied()).collect::<PathBuf>())
}

fn shown(file: &Path) -> String {
    file.to_string_lossy().replace('\\', "/")
}

/// A length to the next 10 mm. mm
fn rounded(metres: f64) -> f64 {
    (metres * 100.0).round() * 10.0
}

fn text(
    robot: &Robot,
    points: &[PathPoint],
    has_forces: bool,
    [robot_name, task]: &[String; 2],
    has_stiffness: bool,
) -> String {
    let reach = robot.geometry().reach();
    // A root frame below the base of the rows is on the floor; one at the height of axis 2 is above it.
    let root = robot.controller().and_then(|controller| controller.root_from_base);
    let floor = root.map_or(0.0, |root| -root.translation.z.max(0.0));
    let [x, y, z] = [0, 1, 2].map(|axis| middle(points, axis));
    let range = |from: f64, to: f64| format!("[{:?}, {:?}]", rounded(from), rounded(to));
    let quoted = |name: &str| toml::Value::from(name).to_string();
    format!(
        "\
# A run: where to put the workpiece so that the robot machines it most accurately. Written by `stead init place`. What says \"guess\"
# is to be replaced by the figures of your cell; `stead check` shows what was understood.

robot = {}{}
task = {}

[spindle]                              # guess: a spindle across the flange. The tool frame in the flange frame, as the controller
xyz_mm = [200.0, 0.0, 150.0]           # has it for this tool (TCP); its z axis points out of the spindle to the work. In place of
abc_deg = [0.0, 90.0, 0.0]             # abc_deg: rotation, wpr_deg, rpy_deg or quaternion_wxyz

[cell]                                 # guess from the reach of the arm: where the workpiece origin may stand, in the base frame
x_mm = {}                # the middle of the path is at {x:?}, {y:?}, {z:?} mm of the workpiece frame
y_mm = {}
z_mm = {}
# q4 = [-1.0, 1.0]                     # sin(yaw / 2): how the workpiece may be turned about the vertical
# A robot on a pedestal or a wall, a part on its side: the page cell_setup has the tables.

# [[external_axis]]                    # a rail under the robot
# name = \"rail\"
# kind = \"rail\"
# carries = \"robot\"
# direction = [0.0, 1.0, 0.0]          # in the cell frame: that of the base while all axes are at zero
# range_mm = [-1000.0, 1000.0]
# speed_mm_per_s = 500.0
# use = \"fixed\"                      # one position for the path; or \"indexed\" (one for each segment), \"continuous\"

# [[external_axis]]                    # a table that turns the workpiece
# name = \"table\"
# kind = \"turntable\"
# carries = \"workpiece\"
# axis = [0.0, 0.0, 1.0]
# xyz_mm = [{:?}, 0.0, 0.0]          # a point on its axis
# range_deg = [-180.0, 180.0]
# speed_deg_per_s = 60.0
# use = \"indexed\"

[constraints]
min_inverse_condition = 0.15           # of the scaled Jacobian: distance from singularities, 0 to below 1
characteristic_length_mm = {:?}       # by which the translational part of the Jacobian is scaled: a quarter of the reach
joint_margin_deg = 2.0                 # kept from every joint limit

[criterion]                            # what is minimised
direction = \"total\"                  # the whole deflection counts: one part alone can be balanced while the tool is off
force_uncertainty = 0.1                # the plan must also stand force errors of this share in any direction

[redundancy]                           # the spindle may turn about the tool axis, by the angle beta
beta_step_deg = 5.0                    # grid of beta; a fraction of 360
feed_mm_per_s = 50.0                   # guess, where the task has no feeds of its own
max_spindle_turn_deg_per_mm = 0.5      # how fast the spindle turns in space: a plan that turns faster is driven more slowly
{}",
        quoted(robot_name),
        if has_stiffness { "" } else { "   # states no joint stiffness yet, without which nothing can be placed" },
        quoted(task),
        range(0.45 * reach, 0.8 * reach),
        range(-0.3 * reach, 0.3 * reach),
        range(floor + 0.15 * reach, floor + 0.4 * reach),
        rounded(0.6 * reach),
        rounded(reach / 4.0),
        if has_forces { "" } else { FORCES },
    )
}

/// Forces for a task that has none.
const FORCES: &str = "
[forces]                               # guess: the task has no forces. What the workpiece does to the tool, in the path's own frame
feed_n = -60.0                         # along the feed
normal_n = 120.0                       # to the left of the feed: towards or away from the wall
axis_n = 40.0                          # along the tool axis, from the work into the spindle
# In place of [forces]: the cutter and its cut, tables [tool] and [cut]
";

/// The middle of a path along an axis of the workpiece frame. mm
fn middle(points: &[PathPoint], axis: usize) -> f64 {
    let values = points.iter().map(|point| point.position[axis]);
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
    rounded((low + high) / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::read_run;

    #[test]
    fn the_run_is_read_and_names_its_files_from_its_own_folder() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        std::fs::create_dir(folder.join("tasks")).unwrap();
        let task = folder.join("tasks/part.csv");
        std::fs::write(&task, include_str!("task.csv")).unwrap();
        let out = folder.join("runs/run.toml");
        init_run(Path::new("name:kuka-kr500"), &task, &out).unwrap();
        let text = std::fs::read_to_string(&out).unwrap();
        assert!(text.contains("robot = \"name:kuka-kr500\"\ntask = \"../tasks/part.csv\"\n"), "{text}");
        assert!(!text.contains("[forces]"));
        let run = read_run(&out).unwrap();
        // The cell is in front of the arm, above the floor, within reach.
        let [x, _, z] = run.problem.cell.position;
        assert!(x.min > 1.0 && x.max < run.problem.robot.geometry().reach() && z.min > 0.0);
        let message = init_run(Path::new("name:kuka-kr500"), &task, &out).unwrap_err().to_string();
        assert!(message.contains("run.toml: is there already"), "{message}");
    }

    #[test]
    fn shapes_beside_the_robot_are_taken() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("part.csv"), include_str!("task.csv")).unwrap();
        std::fs::write(at("arm.toml"), shipped::by_name("kuka-kr500").unwrap()).unwrap();
        let made = |out: &str| {
            std::fs::create_dir_all(at("runs")).unwrap();
            init_run(&at("arm.toml"), &at("part.csv"), &at(out)).unwrap();
            (std::fs::read_to_string(at(out)).unwrap(), read_run(&at(out)).unwrap())
        };
        let (text, run) = made("runs/without.toml");
        assert!(!text.contains("\nsurroundings"));
        assert!(run.notes.iter().any(|note| note.starts_with("collisions were not checked: nothing stands around")));
        let shape = "[[shape]]\nname = 'forearm'\nattached = 'link_3'\ncapsule_mm = { radius = 80, length = 300 }\n";
        std::fs::write(at("arm-cell.toml"), shape).unwrap();
        let (text, run) = made("runs/with.toml");
        assert!(text.contains("\nsurroundings = \"../arm-cell.toml\""), "{text}");
        assert_eq!(run.problem.scene.as_ref().map(|scene| scene.surroundings().shapes().len()), Some(1));
        // Nothing but the arm itself is among the shapes.
        assert!(
            run.notes.iter().any(|note| note.starts_with("collisions were not checked but between parts of the arm"))
        );
        // With a table in the cell it is not said.
        let table =
            "[[shape]]\nname = 'table'\nattached = 'base'\nbox_mm = [1000, 1000, 100]\nxyz_mm = [2000, 0, -500]\n";
        std::fs::write(at("arm-cell.toml"), format!("{shape}{table}")).unwrap();
        assert!(
            !read_run(&at("runs/with.toml"))
                .unwrap()
                .notes
                .iter()
                .any(|note| note.contains("collisions were not checked"))
        );
    }

    #[test]
    fn a_robot_without_stiffness_and_one_with_its_base_above_the_floor_are_minded() {
        let folder = tempfile::tempdir().unwrap();
        let task = folder.path().join("part.csv");
        std::fs::write(&task, include_str!("task.csv")).unwrap();
        let made = |robot: &str, name: &str| {
            let out = folder.path().join(name);
            init_run(Path::new(robot), &task, &out).unwrap();
            std::fs::read_to_string(out).unwrap()
        };
        assert!(made("name:abb-irb6640-235", "a.toml").contains("states no joint stiffness yet"));
        // The rows of this arm begin 750 mm above the floor.
        assert!(made("name:kuka-kr270-2", "b.toml").contains("z_mm = [-340.0, 330.0]"));
    }
}
