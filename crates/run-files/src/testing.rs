//! Files for the tests of this crate.

use crate::read_run;
use stead_disk::input::InputError;
use stead_format::testing::root;
use stead_runs::Run;

/// A run in a folder of its own, with the shipped robot and a task of two points.
pub fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let robot = root().join("configs/robots/kuka-kr270-2.toml");
    std::fs::copy(robot, folder.path().join("arm.toml")).unwrap();
    std::fs::write(folder.path().join("task.csv"), TASK).unwrap();
    std::fs::write(folder.path().join("path.csv"), PATH).unwrap();
    folder
}

/// A task file with forces.
pub const TASK: &str = "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,force_x_n,force_y_n,force_z_n
1,0,0,0,1,0,0,0,0,1,10,20,0
1,10,0,0,1,0,0,0,0,1,10,20,0
";
/// A task file without forces, going down a ramp.
pub const PATH: &str = "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z
1,0,0,0,1,0,0,0,0,1
1,10,0,-1,0.9950372,0,-0.0995037,0,0,1
";
/// A run file without optional tables.
pub const RUN: &str = "robot = 'arm.toml'
task = 'task.csv'
[spindle]
xyz_mm = [0, 0, 684]
rotation = [[0, -0.70710678, 0.70710678], [1, 0, 0], [0, 0.70710678, 0.70710678]]
[cell]
x_mm = [-300, 300]
y_mm = [-2240, -1640]
z_mm = [-500, -500]
[constraints]
min_inverse_condition = 0.2
characteristic_length_mm = 682
[redundancy]
beta_step_deg = 7.2
feed_mm_per_s = 50
max_beta_rate_deg_per_mm = 0.9
";

/// Reads a run file of this text.
pub fn read_text(text: &str) -> Result<Run, InputError> {
    let folder = folder();
    let file = folder.path().join("run.toml");
    std::fs::write(&file, text).unwrap();
    read_run(&file)
}

/// Asserts that `RUN` with one piece replaced is refused with all these parts in the message.
pub fn assert_refused(from: &str, to: &str, parts: &[&str]) {
    assert!(RUN.contains(from), "{from}");
    let message = read_text(&RUN.replacen(from, to, 1)).unwrap_err().to_string();
    for part in parts.iter().chain(&["; allowed: "]) {
        assert!(message.contains(part), "{part} in {message}");
    }
}
