//! What yields beside the robot of a run: what carries it, and the part.

use nalgebra::Matrix3;
use stead_disk::input::InputError;
use stead_format::compliance_matrix::{BaseComplianceTable, PartComplianceTable};
use stead_format::place::Place;
use stead_format::task::{Imported, PART};
use stead_model::robot::{MeasuredFrom, Robot};
use stead_model::task::Task;

/// The robot on what carries it.
///
/// # Errors
/// [`InputError`] for a matrix that is no compliance, and where the stiffness of the robot has the base in it already.
pub(super) fn on_its_base(
    robot: Robot,
    table: Option<&BaseComplianceTable>,
    at: &Place<'_>,
) -> Result<Robot, InputError> {
    let Some(table) = table else { return Ok(robot) };
    if robot.stiffness_measured_from() == Some(MeasuredFrom::Floor) {
        let problem = "counts the base twice: the robot file says that its stiffness was measured from the floor";
        let allowed = "a robot file with stiffness_measured_from = \"base\", or no table [base_compliance]";
        return Err(at.error(problem, allowed).found_if(None));
    }
    let base = table.base_compliance(at)?;
    Ok(robot.with_base_compliance(Some(base)))
}

/// That nobody knows whether the base is in the stiffness of the robot already.
pub(super) fn base_note(robot: &Robot) -> Option<String> {
    let is_open = robot.base_compliance().is_some() && robot.stiffness_measured_from().is_none();
    is_open.then(|| {
        format!(
            "{}: the robot file does not say from where its stiffness was measured (stiffness_measured_from): if from the floor, \
             [base_compliance] counts the base twice",
            robot.name()
        )
    })
}

/// How the part of a run yields.
pub(super) enum PartCompliances {
    /// Not at all.
    Rigid,
    /// Alike at every point. m/N
    Same(Matrix3<f64>),
    /// As the task says, point by point. m/N
    PerPoint(Vec<Matrix3<f64>>),
}

/// How the part yields: by the table of the run file, or by the columns of the task.
///
/// # Errors
/// [`InputError`] for both, for a matrix that is no compliance, and for columns of a task that gets other points.
pub(super) fn part_compliances(
    imported: &mut Imported,
    table: Option<&PartComplianceTable>,
    adds_points: bool,
    at: &Place<'_>,
) -> Result<PartCompliances, InputError> {
    let table_at = at.key("part_compliance");
    match (table, imported.part.take()) {
        (Some(_), Some(_)) => {
            let problem = format!("stands beside the columns {} .. of the task", PART[0]);
            Err(table_at.error(problem, "the compliance of the part in one place only").found_if(None))
        }
        (None, Some(_)) if adds_points => {
            let problem =
                format!("adds points to the task, whose columns {} .. do not say how the part yields there", PART[0]);
            let allowed = "[part_compliance] in place of the columns";
            Err(at.key("stock").error(problem, allowed).found_if(None))
        }
        (Some(table), None) => table.matrix(&table_at).map(PartCompliances::Same),
        (None, Some(matrices)) => Ok(PartCompliances::PerPoint(matrices)),
        (None, None) => Ok(PartCompliances::Rigid),
    }
}

impl PartCompliances {
    /// The task on the part.
    ///
    /// # Errors
    /// [`InputError`] at the task where that does not go together.
    pub fn of(self, task: Task, at: &Place<'_>) -> Result<Task, InputError> {
        let matrices = match self {
            Self::Rigid => return Ok(task),
            Self::Same(matrix) => vec![matrix; task.points().len()],
            Self::PerPoint(matrices) => matrices,
        };
        let refused =
            |error: stead_model::task::TaskError| at.key("task").error(error.to_string(), "a compliance of the part");
        task.with_part_compliances(matrices).map_err(refused)
    }
}

#[cfg(test)]
mod tests {
    use crate::testing::{RUN, folder};
    use stead_disk::input::InputError;
    use stead_model::robot::SpringModel;
    use stead_runs::Run;

    const BASE: &str = "[base_compliance]\npoint_mm = [0, 0, -500]\nmatrix = [[0.02, 0, 0, 0, 0.01, 0], [0, 0.02, 0, -0.01, 0, 0], \
        [0, 0, 0.01, 0, 0, 0], [0, -0.01, 0, 0.06, 0, 0], [0.01, 0, 0, 0, 0.06, 0], [0, 0, 0, 0, 0, 0.05]]\n";
    const PART_TABLE: &str = "[part_compliance]\num_per_n = [[0.5, 0.1, 0], [0.1, 0.25, 0], [0, 0, 2]]\n";

    /// A run with tables added, of a robot file and a task that are changed.
    fn read(
        tables: &str,
        robot: &dyn Fn(String) -> String,
        task: &dyn Fn(String) -> String,
    ) -> Result<Run, InputError> {
        let folder = folder();
        for (name, change) in [("arm.toml", robot), ("task.csv", task)] {
            let file = folder.path().join(name);
            let text = std::fs::read_to_string(&file).unwrap();
            std::fs::write(&file, change(text)).unwrap();
        }
        let file = folder.path().join("run.toml");
        std::fs::write(&file, format!("{RUN}{tables}")).unwrap();
        crate::read_run(&file)
    }

    fn same(text: String) -> String {
        text
    }

    fn refused(found: Result<Run, InputError>, parts: &[&str]) {
        let message = found.map(drop).unwrap_err().to_string();
        parts.iter().for_each(|part| assert!(message.contains(part), "{part} in {message}"));
        assert!(message.contains("; allowed: "), "{message}");
    }

    #[test]
    fn a_base_that_is_in_the_stiffness_already_is_refused_and_one_that_may_be_is_noted() {
        let measured = |from: &'static str| move |text: String| format!("stiffness_measured_from = '{from}'\n{text}");
        let run = read(BASE, &measured("base"), &same).unwrap();
        let base = run.problem.robot.base_compliance().unwrap();
        assert_eq!((base.point().z, base.matrix()[(0, 4)]), (-0.5, 0.01 * 1e-6));
        assert!(!run.notes.iter().any(|note| note.contains("stiffness_measured_from")));
        let parts = ["run.toml:", "base_compliance: counts the base twice", "stiffness_measured_from = \"base\""];
        refused(read(BASE, &measured("floor"), &same), &parts);
        let run = read(BASE, &same, &same).unwrap();
        assert!(
            run.notes.iter().any(|note| note.contains("(stiffness_measured_from): if from the floor")),
            "{:?}",
            run.notes
        );
        let soft = BASE.replace("[0, 0, 0.01, 0", "[0, 0, 0.01, 0.1");
        refused(read(&soft, &same, &same), &["base_compliance.matrix[4][3]: makes the matrix unsymmetric", "= 0.1"]);
    }

    #[test]
    fn the_part_yields_by_the_run_or_by_the_task() {
        let run = read(PART_TABLE, &same, &same).unwrap();
        assert_eq!(run.problem.task.part_compliance(0).unwrap()[(2, 2)], 2.0 * 1e-6);
        let columns = |text: String| {
            let rows = text.lines().enumerate().map(|(k, line)| match k {
                0 => format!("{line},part_xx_um_per_n,part_yy_um_per_n,part_zz_um_per_n,part_xy_um_per_n,part_xz_um_per_n,part_yz_um_per_n\n"),
                _ => format!("{line},1,2,{k},0,0,0\n"),
            });
            rows.collect()
        };
        let run = read("", &same, &columns).unwrap();
        assert_eq!(run.problem.task.part_compliance(1).unwrap()[(2, 2)], 2.0 * 1e-6);
        refused(
            read(PART_TABLE, &same, &columns),
            &["part_compliance: stands beside the columns part_xx_um_per_n", "one place"],
        );
        let negative = PART_TABLE.replace("0.25", "-0.25");
        refused(read(&negative, &same, &same), &["part_compliance.um_per_n: has an eigenvalue of -", "semidefinite"]);
    }

    #[test]
    fn matrices_of_the_spindle_are_checked_and_slips_of_units_are_noted() {
        let with = |line: &str| {
            let run = RUN.replacen("[spindle]\n", &format!("[spindle]\n{line}\n"), 1);
            assert!(run.contains(line));
            let folder = folder();
            let file = folder.path().join("run.toml");
            std::fs::write(&file, run).unwrap();
            crate::read_run(&file)
        };
        let run = with("tip_um_per_n = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.02]]").unwrap();
        assert_eq!(run.problem.spindle.tip.unwrap()[(2, 2)], 0.02 * 1e-6);
        assert!(run.problem.yields_beside());
        refused(
            with("tip_um_per_n = [[0.1, 0.2, 0], [0.2, 0.1, 0], [0, 0, 0.02]]"),
            &["spindle.tip_um_per_n: has an eigenvalue"],
        );
        refused(with("mount_matrix = [[1, 0, 0, 0, 0, 0]]"), &["spindle.mount_matrix: ", "has 1 elements and not 6"]);
        let run = with("tip_um_per_n = [[1000, 0, 0], [0, 0.1, 0], [0, 0, 0.02]]").unwrap();
        assert!(
            run.notes.iter().any(|note| note.contains("spindle.tip_um_per_n") && note.contains("1000 um/N")),
            "{:?}",
            run.notes
        );
    }

    #[test]
    fn a_full_arm_lends_pairs_bearings_and_model() {
        let without = |text: String| {
            let rows =
                text.lines().filter(|line| !line.starts_with("stiffness_mnm") && !line.starts_with("compliance_urad"));
            rows.collect::<Vec<_>>().join("\n")
        };
        let folder = folder();
        let arm = folder.path().join("arm.toml");
        let text = without(std::fs::read_to_string(&arm).unwrap());
        std::fs::write(&arm, text).unwrap();
        let file = folder.path().join("run.toml");
        std::fs::write(&file, format!("stiffness_like = 'name:staubli-tx200-huynh'\n{RUN}")).unwrap();
        let run = crate::read_run(&file).unwrap();
        let normal = run.problem.robot.normal_springs().unwrap();
        assert_eq!((normal[3].bearing, normal[3].compliance), (-0.621, [1e-6 / 2.3, 1e-6 / 3.1]));
        assert_eq!(run.problem.robot.spring_model(), Some(SpringModel::Full));
    }

    /// A robot file that does not state what its stiffness stands for.
    fn unstated(text: &str) -> String {
        let model = "stiffness_model = \"axes\"\n";
        assert!(text.contains(model));
        text.replace(model, "")
    }

    #[test]
    fn sets_that_state_their_model_stand_beside_none_that_does_not() {
        let folder = folder();
        let arm = unstated(&std::fs::read_to_string(folder.path().join("arm.toml")).unwrap());
        std::fs::write(folder.path().join("arm.toml"), &arm).unwrap();
        let full = arm.replace("[[joints]]\n", "[[joints]]\northogonal_stiffness_mnm_per_rad = 4\n");
        std::fs::write(folder.path().join("full.toml"), format!("stiffness_model = 'full'\n{full}")).unwrap();
        std::fs::write(folder.path().join("axes.toml"), format!("stiffness_model = 'axes'\n{arm}")).unwrap();
        let read = |sets: &str| {
            let file = folder.path().join("run.toml");
            std::fs::write(&file, format!("{RUN}[criterion]\nrobots = {sets}\nover = 'mean'\n")).unwrap();
            crate::read_run(&file)
        };
        refused(
            read("['full.toml', 'arm.toml']"),
            &["criterion.robots[2]: does not say what its stiffness stands for", "\"axes\""],
        );
        let run = read("['axes.toml', 'full.toml']").unwrap();
        let sets = &run.problem.scored_robots();
        assert!(sets[0].normal_springs().is_none() && sets[1].normal_springs().is_some());
    }

    #[test]
    fn what_the_springs_of_a_file_stand_for_decides_what_is_scored() {
        let with = |head: &'static str| {
            move |text: String| {
                let rows =
                    unstated(&text).replace("[[joints]]\n", "[[joints]]\northogonal_stiffness_mnm_per_rad = [4, 5]\n");
                format!("{head}\n{rows}")
            }
        };
        let run = read("", &with("stiffness_model = 'full'"), &same).unwrap();
        assert!(run.problem.yields_beside());
        refused(
            read("", &with("stiffness_model = 'axes'"), &same),
            &["arm.toml:1: stiffness_model: is \"axes\", beside springs"],
        );
        let run = read("", &with(""), &same).unwrap();
        assert!(!run.problem.yields_beside());
        assert!(run.notes.iter().any(|note| note.contains("scores leave them out")), "{:?}", run.notes);
        let axial = |text: String| format!("stiffness_model = 'axial_part'\n{}", unstated(&text));
        let run = read("", &axial, &same).unwrap();
        assert!(run.notes.iter().any(|note| note.contains("axial_part")), "{:?}", run.notes);
        let says =
            |run: &Run| run.notes.iter().any(|note| note.contains("does not state what its stiffness stands for"));
        assert!(says(&read("", &|text| unstated(&text), &same).unwrap()));
        assert!(!says(&run) && !says(&read("", &same, &same).unwrap()));
    }
}
