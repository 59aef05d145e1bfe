//! A run and a plan on an arm imported from a URDF fixture.

use crate::check::{ProgramCheck, ReadBackOptions, check};
use crate::{ExportError, ExportOptions, Program, ProgramFormat, export};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use stead_disk::Existing;
use stead_format::urdf::{ImportOptions, ImportedRobot, import_robot_text};
use stead_model::external_axis::AxisKind;
use stead_model::robot::turns::Range;
use stead_model::robot::{Pose, Posture};
use stead_numerics::monitor::Monitor;
use stead_problem::problem::{Placement, Problem};
use stead_problem::setup::{AxisPositions, Setup};
use stead_run_files::read_run;
use stead_runs::Run;
use stead_runs::plan::axis_column;

/// Fixtures of the makers with a form of their own.
pub const ARMS: [(&str, &str, ProgramFormat); 3] = [
    ("kuka", include_str!("../../../format/src/urdf/fixtures/kuka.urdf"), ProgramFormat::Krl),
    ("abb", include_str!("../../../format/src/urdf/fixtures/abb.urdf"), ProgramFormat::Rapid),
    ("fanuc", include_str!("../../../format/src/urdf/fixtures/fanuc.urdf"), ProgramFormat::Fanuc),
];

/// A tilted tool; then level tools whose x axis is vertical, where B is a right angle; then one point.
const TASK: &str = "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,force_x_n,force_y_n,force_z_n
1,0,0,0,1,0,0,0,0.5,0.8660254037844386,10,20,0
1,33.3333,0,0,1,0,0,0,0.5,0.8660254037844386,10,20,0
1,66.6667,1,0.5,1,0,0,0,0.5,0.8660254037844386,10,20,0
1,100,0,0,1,0,0,0,0.6,0.8,10,20,0
2,0,0,0,0,1,0,-1,0,0,10,20,0
2,0,20,0,0,1,0,-1,0,0,10,20,0
2,0,40,0,0,1,0,-1,0,0,10,20,0
3,10,0,0,0,1,0,-1,0,0,10,20,0
3,10,20,5,0,1,0,-1,0,0,10,20,0
4,50,50,20,1,0,0,0,0,1,10,20,0
";
/// Where beta is not free: at B = -90 deg and at B = 90 deg.
const FIXED_BETA_DEG: [Option<f64>; 4] = [None, Some(90.0), Some(-90.0), None];

const RUN: &str = "robot = 'arm.toml'
task = 'task.csv'
[spindle]
xyz_mm = [30.0, -20.0, 500.0]
rotation = [[0, -0.70710678, 0.70710678], [1, 0, 0], [0, 0.70710678, 0.70710678]]
[cell]
x_mm = [-3000, 3000]
y_mm = [-3000, 3000]
z_mm = [-3000, 3000]
[constraints]
min_inverse_condition = 0.01
characteristic_length_mm = 682
[redundancy]
beta_step_deg = 7.2
feed_mm_per_s = 66.667
max_beta_rate_deg_per_mm = 0.9
";

/// A folder with run, arm, task and plan.
pub struct Bench {
    pub folder: tempfile::TempDir,
    pub run: Run,
    pub plan: PathBuf,
    pub format: ProgramFormat,
    pub imported: ImportedRobot,
}

impl Bench {
    /// On the arm of one of [`ARMS`], with its controller filled in.
    pub fn new(name: &str) -> Self {
        Self::with(name, "", |_| Vec::new())
    }

    /// The same with more tables in the run, and external axes that are at positions (m or rad) at each point.
    pub fn with(name: &str, tables_of_run: &str, positions: impl Fn(usize) -> Vec<f64>) -> Self {
        let (kind, urdf, format) = *ARMS.iter().find(|(known, ..)| *known == name).unwrap();
        let options = ImportOptions { stiffness_like: Some("kuka-kr270-2"), ..ImportOptions::default() };
        let imported = import_robot_text(Path::new("arm.urdf"), urdf, &options).unwrap();
        let (rows, tables) = imported.text.split_once("# [controller]\n").unwrap();
        let tables = tables.replace("\n# ", "\n").replacen("# ", "", 1).replace("\"kuka\"", &format!("\"{kind}\""));
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("arm.toml", &format!("{rows}[controller]\n{tables}"));
        write("task.csv", TASK);
        write("run.toml", &format!("{RUN}{tables_of_run}"));
        let run = read_run(&folder.path().join("run.toml")).unwrap_or_else(|error| panic!("{error}"));
        let rows: Vec<Vec<f64>> = (0..run.problem.task.points().len()).map(positions).collect();
        let positions = match &run.problem.external_axes[..] {
            [] => run.problem.setup.positions.clone(),
            _ => AxisPositions::PerPoint(rows),
        };
        let setup = Setup { positions, ..run.problem.setup.clone() };
        write("plan.csv", &plan(&run.problem.in_setup(&setup)));
        let plan = folder.path().join("plan.csv");
        Self { plan, folder, run, format, imported }
    }

    /// A path in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The program in the form of the arm's controller.
    pub fn options(&self) -> ExportOptions<'static> {
        ExportOptions::new(self.format, "PART")
    }

    pub fn export(&self, options: &ExportOptions<'_>) -> Result<Program, ExportError> {
        export(&self.run, &self.plan, options, &Monitor::silent())
    }

    /// Writes a program to a folder of its own, and its main file.
    pub fn written(&self, program: &Program, folder: &str) -> PathBuf {
        program.write(&self.path(folder), Existing::Kept).unwrap().files.remove(0)
    }

    pub fn check(&self, main: &Path) -> Result<ProgramCheck, ExportError> {
        check(&self.run, &self.plan, main, &ReadBackOptions::default(), &Monitor::silent())
    }
}

/// A plan as `stead place` prints it, at the first placement and with the first betas and postures that keep 5 deg from
/// all limits.
fn plan(problem: &Problem) -> String {
    let places =
        [[1.5, 0.2, 0.9], [1.4, -0.3, 0.7], [1.7, 0.3, 1.1], [1.3, 0.0, 1.2], [1.2, 0.5, 0.9], [1.6, 0.0, 0.6]];
    for [x, y, z] in places {
        for yaw_deg in [0.0_f64, 20.0, -25.0, 40.0] {
            let placement = Placement { x, y, z, yaw: yaw_deg.to_radians() };
            let rows: Option<Vec<String>> = (0..4).map(|segment| segment_rows(problem, &placement, segment)).collect();
            if let Some(rows) = rows {
                let header = "point,segment,x_mm,y_mm,z_mm,beta_deg,posture,theta1_deg,theta2_deg,theta3_deg,theta4_deg,theta5_deg,\
                              theta6_deg,force_x_n,force_y_n,force_z_n";
                let axes = problem.external_axes.iter().zip(1..);
                let axes: String = axes.map(|(axis, number)| format!(",{}", axis_column(number, axis.kind))).collect();
                return format!("{header}{axes}\n{}", rows.concat());
            }
        }
    }
    panic!("{} reaches no placement of the fixture", problem.robot.name())
}

fn segment_rows(problem: &Problem, placement: &Placement, segment: usize) -> Option<String> {
    let betas = match FIXED_BETA_DEG[segment] {
        Some(beta) => vec![beta],
        None => (0..24).map(|k| f64::from(k) * 15.0 - 180.0).collect(),
    };
    let mut transfer_paths = betas.into_iter().flat_map(|beta| Posture::ALL.map(|posture| (beta, posture)));
    transfer_paths.find_map(|(beta, posture)| {
        let range = problem.task.segments()[segment].clone();
        let rows: Option<String> =
            range.map(|point| row(problem, placement, (segment, point), beta, posture)).collect();
        rows
    })
}

fn row(
    problem: &Problem,
    placement: &Placement,
    (segment, point): (usize, usize),
    beta_deg: f64,
    posture: Posture,
) -> Option<String> {
    let base_from_flange = problem.at(placement).base_from_flange(point, beta_deg.to_radians());
    // Retracted, too.
    let tool = base_from_flange.then(&problem.spindle.flange_from_tool);
    let back = tool.rotation.column(2) * -0.05;
    let retracted = Pose { translation: base_from_flange.translation + back, ..base_from_flange };
    let margin = 5.0_f64.to_radians();
    let within = |pose: &Pose<f64>| {
        let angles = problem.robot.inverse(pose, posture).ok()?;
        let mut real = [0.0; 6];
        for (j, joint) in problem.robot.joints().iter().enumerate() {
            let range = Range { min: joint.min + margin, max: joint.max - margin };
            real[j] = range.real_angles(angles[j]).next()?;
        }
        (angles[4].abs() > 0.3).then_some(real)
    };
    let joints = within(&base_from_flange)?;
    let away = within(&retracted)?;
    if joints.iter().zip(away).any(|(a, b)| (a - b).abs() > 0.5) {
        return None;
    }
    let placed = problem.placed(point, placement);
    let mut text = format!("{point},{}", segment + 1);
    let tip = tool.translation * 1e3;
    let numbers = tip.iter().copied().chain([beta_deg]);
    numbers.for_each(|value| write!(text, ",{value:.4}").unwrap());
    write!(text, ",{posture}").unwrap();
    joints.iter().for_each(|angle| write!(text, ",{:.4}", angle.to_degrees()).unwrap());
    placed.force.iter().for_each(|value| write!(text, ",{value:.4}").unwrap());
    for (axis, position) in problem.external_axes.iter().zip(problem.axis_positions(point)) {
        let shown = if axis.kind == AxisKind::Rail { position * 1e3 } else { position.to_degrees() };
        write!(text, ",{shown:.4}").unwrap();
    }
    Some(text + "\n")
}
