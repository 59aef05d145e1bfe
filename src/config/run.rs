//! Run files.

use super::chatter::chatter_from;
use super::cutting::cutting_from;
use super::reader::{Field, NamedFile, Table};
use super::robot::{moving_robot_from, robot_from};
use super::source::{Source, input_file};
use super::tables::{
    cell_from, check_confidence, check_tables, constraints_from, criterion_from, redundancy_from, reference_from,
    search_from, spindle_from, transfer_from,
};
use crate::input::{InputError, InputFile, Reference};
use crate::placement::problem::Problem;
use crate::placement::settings::{SearchSettings, TransferSettings};
use crate::robot::Robot;
use crate::simulation::arm::Variant;
use crate::simulation::chatter::Chatter;
use crate::task::{Imported, Task, ToolPath, parse_csv};
use std::path::Path;

/// A run file and the files it names, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// What is to be solved.
    pub problem: Problem,
    /// How hard to search.
    pub search: SearchSettings,
    /// Limits of the moves between segments.
    pub transfer: TransferSettings,
    /// The files that were read, in the order config, robot, task.
    pub inputs: Vec<InputFile>,
    /// Published figures to print beside ours.
    pub reference: Option<Reference>,
    /// What is to be cut along the path, where its stability is asked for.
    pub chatter: Option<Chatter>,
    /// What the user should know about the input though it is not wrong, in sentences.
    pub notes: Vec<String>,
}

/// Reads a run file and the robot and task files that it names. Top-level keys: `robot` and `task` (paths relative to
/// the folder of the run file), `[spindle]`, `[cell]`, `[constraints]` and `[redundancy]`; optionally `[criterion]`,
/// `[search]`, `[transfer]`, `[stability]` and `[reference]`; and `[cutting]` if, and only if, the task has no force columns.
///
/// # Errors
/// [`InputError`] with file, line and field: a file that cannot be read or parsed, a missing or unknown key, a value of
/// the wrong kind or out of range, an arm or a task that breaks a rule, forces from two places or from none.
pub fn read_run(file: &Path) -> Result<Run, InputError> {
    let source = Source::read(file)?;
    let document = source.parse()?;
    let [
        robot,
        task,
        spindle,
        cell,
        constraints,
        criterion,
        redundancy,
        search,
        transfer,
        cutting,
        stability,
        reference,
    ] = Table::root(&document).fields([
        "robot",
        "task",
        "spindle",
        "cell",
        "constraints",
        "criterion",
        "redundancy",
        "search",
        "transfer",
        "cutting",
        "stability",
        "reference",
    ])?;
    let spindle = spindle_from(&spindle.table()?)?;
    let cell = cell_from(&cell.table()?)?;
    let constraints = constraints_from(&constraints.table()?)?;
    let scoring = criterion.optional(Field::table)?;
    let criterion = scoring.as_ref().map(criterion_from).transpose()?.unwrap_or_default();
    let redundancy = redundancy_from(&redundancy.table()?)?;
    let searching = search.optional(Field::table)?;
    let search = searching.as_ref().map(search_from).transpose()?.unwrap_or_default();
    let transfer = transfer.optional(|field| transfer_from(&field.table()?))?.unwrap_or_default();
    let reference = reference.optional(|field| reference_from(&field.table()?))?;

    let robot_file = robot.named_file()?;
    let robot_source = Source::new(&robot_file.file, robot_file.bytes)?;
    let chatter = stability.optional(|field| chatter_from(&field.table()?))?;
    let robot = match &chatter {
        Some(chatter) => moving_robot_from(&robot_source, chatter.variant >= Variant::Orthogonal)?,
        None => robot_from(&robot_source)?,
    };
    if let Some(table) = &scoring {
        check_confidence(table, &criterion, &robot)?;
    }
    let task_file = task.named_file()?;
    let imported = parse_csv(&task_file.file, &task_file.bytes)?;
    let mut notes: Vec<String> =
        [tilt_note(&imported.path, &imported.lines), speed_note(&robot)].into_iter().flatten().collect();
    let inputs = vec![
        source.as_config(),
        input_file("robot", robot_file.name, robot_source.bytes()),
        input_file("task", &task_file.name, &task_file.bytes),
    ];
    let task = task_from(imported, &task_file, &task, &cutting)?;
    let problem = Problem { robot, spindle, task, cell, constraints, criterion, redundancy };
    if let Some(table) = &searching {
        check_tables(table, &search, &problem)?;
    }
    notes.extend(density_note(&problem));
    notes.extend(direction_note(&problem.task));
    Ok(Run { problem, search, transfer, inputs, reference, chatter, notes })
}

/// Puts the forces to the path: those of the file, or those of the `[cutting]` table.
fn task_from(imported: Imported, file: &NamedFile, field: &Field<'_>, cutting: &Field<'_>) -> Result<Task, InputError> {
    let rule = "force columns in the task or a table [cutting], one and not both";
    let wrenches = match (imported.wrenches, cutting.is_given()) {
        (Some(wrenches), false) => wrenches,
        (None, true) => cutting_from(&cutting.table()?)?.wrenches(&imported.path),
        (Some(_), true) => {
            let problem = format!("forces come from one place only, and the task {} has force columns", file.name);
            return Err(cutting.error(problem, rule));
        }
        (None, false) => {
            return Err(field.error("has no force columns, and there is no table [cutting] to compute them", rule));
        }
    };
    Task::new(imported.path, wrenches)
        .map_err(|e| cutting.error(format!("gives no usable forces: {e}"), "values whose forces are finite"))
}

/// A feed that misses the plane normal to the tool axis by no more than this is normal to it. deg
const NORMAL_FEED_DEG: f64 = 0.1;

/// The largest tilt of the feed, where there is one.
fn tilt_note(path: &ToolPath, lines: &[usize]) -> Option<String> {
    let tilts = path.points().iter().zip(lines).map(|(point, line)| (point.feed_tilt().abs().to_degrees(), line));
    let steepest = tilts.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(tilt, _)| *tilt > NORMAL_FEED_DEG);
    steepest.map(|(tilt, line)| {
        format!(
            "feed is up to {tilt:.2} deg off the normal of the tool axis (task line {line}): \
             the wall normal is axis x feed"
        )
    })
}

/// Points so near to each other that beta cannot change by a step of its grid between them.
fn density_note(problem: &Problem) -> Option<String> {
    let step = problem.redundancy.beta_step();
    let inner = || problem.task.segments().iter().flat_map(|span| span.clone().skip(1));
    let stuck = inner().filter(|point| problem.beta_step_limit(*point) < step * (1.0 - 1e-9)).count();
    (stuck > 0).then(|| {
        format!(
            "between {stuck} of {} neighbouring points the rate of beta allows less than beta_step_deg: steps of the grid are \
             spread over several points there, or beta is held where that breaks a limit; a finer grid or a thinner path is \
             planned more exactly",
            inner().count()
        )
    })
}

/// A feed that points away from the next point by more than this is suspicious. deg
const FEED_TO_PATH_DEG: f64 = 60.0;

/// The first point whose feed does not point along the path.
fn direction_note(task: &Task) -> Option<String> {
    let points = task.points();
    let off = |point: &usize| {
        let (feed, chord) = (points[point - 1].feed, points[*point].position - points[point - 1].position);
        libm::acos((feed.dot(&chord) / chord.norm()).clamp(-1.0, 1.0)).to_degrees()
    };
    let mut inner = task.segments().iter().flat_map(|span| span.clone().skip(1));
    let first = inner.find(|point| off(point) > FEED_TO_PATH_DEG)?;
    let (from, angle) = (first - 1, off(&first));
    Some(format!("at point {from} the feed is {angle:.0} deg off the way to the next point: check the signs of feed_*"))
}

/// The joints whose speed is not known, where there are some.
fn speed_note(robot: &Robot) -> Option<String> {
    let unknown = robot.joints().iter().zip(1..).filter(|(joint, _)| joint.max_speed.is_none());
    let numbers: Vec<String> = unknown.map(|(_, number): (_, usize)| number.to_string()).collect();
    (!numbers.is_empty()).then(|| {
        format!(
            "the robot file gives no max_speed_deg_per_s for joints {}: their steps along the path are not bounded, \
             and the times of moves between segments are not known",
            numbers.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::testing::{RUN, TASK, assert_refused, folder, read_text as read, root};
    use super::*;
    use crate::placement::problem::Interval;
    use crate::task::read_csv;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    fn shipped(name: &str) -> Run {
        read_run(&root().join("configs").join(name)).unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn shipped_runs_are_the_published_case() {
        let run = shipped("caro-2013.toml");
        let testing = crate::placement::testing::five_segments();
        assert_eq!(run.problem.task, testing.task);
        assert_eq!(run.problem.constraints, testing.constraints);
        assert_eq!(run.problem.criterion, testing.criterion);
        assert_eq!(run.problem.redundancy.beta_count, 120);
        assert!((run.problem.redundancy.feed - 0.066667).abs() < 1e-15);
        let spindle = (run.problem.spindle.flange_from_tool, testing.spindle.flange_from_tool);
        assert!((spindle.0.rotation - spindle.1.rotation).abs().max() < 1e-8);
        assert_eq!(spindle.0.translation, spindle.1.translation);
        for (found, expected) in run.problem.cell.position.iter().zip(testing.cell.position) {
            assert!((found.min - expected.min).abs() + (found.max - expected.max).abs() < 1e-12);
        }
        assert_eq!(run.problem.cell.yaw, Interval { min: -PI, max: PI });
        assert_eq!(run.search, SearchSettings::default());
        assert_eq!(run.transfer, TransferSettings::default());
        let reference = run.reference.unwrap();
        assert_eq!(reference.source, "Caro et al. 2013, Table III");
        assert_eq!(reference.case_mm[1], 0.35);
        assert_eq!(run.notes, Vec::<String>::new());

        let softer = shipped("caro-2013-k1-0.8.toml");
        assert_eq!(softer.problem.robot.joints()[0].compliance, (1e-6 / 0.8).into());
        assert_eq!(softer.problem.task, testing.task);
    }

    #[test]
    fn shipped_cutting_table_reproduces_the_shipped_forces() {
        let run = shipped("five-segments-cutting.toml");
        let with_forces = read_csv(&root().join("tasks/five-segments.csv")).unwrap();
        assert_eq!(run.problem.task.path(), &with_forces.path);
        for (ours, theirs) in run.problem.task.wrenches().iter().zip(with_forces.wrenches.unwrap()) {
            assert!((ours.force - theirs.force).abs().max() < 0.1);
        }
    }

    #[test]
    fn inputs_are_the_bytes_that_were_read() {
        let run = shipped("caro-2013.toml");
        let expected = [
            ("config", "caro-2013.toml", "configs/caro-2013.toml"),
            ("robot", "robots/kuka-kr270-2.toml", "configs/robots/kuka-kr270-2.toml"),
            ("task", "../tasks/five-segments.csv", "tasks/five-segments.csv"),
        ];
        for (input, (role, name, file)) in run.inputs.iter().zip(expected) {
            let digest = crate::config::source::sha256(&std::fs::read(root().join(file)).unwrap());
            assert_eq!((input.role, input.name.as_str(), &input.sha256), (role, name, &digest));
        }
        assert_eq!(run.inputs.len(), 3);
    }

    #[test]
    fn a_bad_file_that_the_run_names_is_located() {
        assert_refused(
            "arm.toml",
            "arn.toml",
            &["run.toml:1: robot: ", "cannot be read", "arn.toml: ", "found 'arn.toml'"],
        );
        assert_refused(
            "task.csv",
            "tusk.csv",
            &["run.toml:2: task: ", "cannot be read", "tusk.csv: ", "found 'tusk.csv'"],
        );
        assert_refused("task.csv", "arm.toml", &["arm.toml:1: ", "unknown column"]);
        assert_refused("arm.toml", "task.csv", &["task.csv:1: ", "TOML"]);
        let folder = folder();
        std::fs::write(folder.path().join("task.csv"), TASK.replace("10,20,0\n1", "10,nan,0\n1")).unwrap();
        let file = folder.path().join("run.toml");
        std::fs::write(&file, RUN).unwrap();
        let message = read_run(&file).unwrap_err().to_string();
        for part in ["task.csv:2: force_y_n: ", "finite", "found 'nan'", "; allowed: "] {
            assert!(message.contains(part), "{part} in {message}");
        }
        let message = read_run(&folder.path().join("ran.toml")).unwrap_err().to_string();
        assert!(message.contains("ran.toml: cannot be read: "), "{message}");
    }

    const CUTTING: &str = "[cutting]\ncutter_diameter_mm = 16\nteeth = 4\nmilling = 'climb'\nradial_depth_mm = 2\n\
        axial_depth_mm = 5\nfeed_per_tooth_mm = 0.05\nkt_mpa = 800\nkr = 0.4\nkte_n_per_mm = 20\nkre_n_per_mm = 20\n";

    proptest! {
        #[test]
        fn a_damaged_file_is_read_or_refused_with_its_name(
            at in 0..RUN.len(), cut in 0..4_usize, put in "[ -~\n\u{e4}]{0,3}"
        ) {
            let text = format!("{}{put}{}", &RUN[..at], RUN.get(at + cut..).unwrap_or_default());
            if let Err(error) = read(&text) {
                prop_assert!(error.file.ends_with("run.toml") && error.line.is_some() && error.allowed.is_some());
            }
        }
    }

    #[test]
    fn forces_come_from_one_place() {
        let both = format!("{CUTTING}[cell]");
        assert_refused("[cell]", &both, &["run.toml:6: cutting: ", "one place only", "task.csv", "found [cutting]"]);
        assert_refused(
            "task.csv",
            "path.csv",
            &["run.toml:2: task: ", "no force columns", "found 'path.csv'", "[cutting]"],
        );
        let text = format!("{RUN}{CUTTING}").replace("task.csv", "path.csv");
        assert!(read(&text).unwrap().problem.task.wrenches().iter().all(|wrench| wrench.force.norm() > 50.0));
        let message = read(&text.replace("= 800", "= 1e305")).unwrap_err().to_string();
        assert!(message.contains("run.toml:17: cutting: gives no usable forces"), "{message}");
    }

    #[test]
    fn notes_say_what_the_result_rests_on() {
        let folder = folder();
        let robot = std::fs::read_to_string(folder.path().join("arm.toml")).unwrap();
        std::fs::write(folder.path().join("arm.toml"), robot.replace("max_speed_deg_per_s = 101.0\n", "")).unwrap();
        let file = folder.path().join("run.toml");
        std::fs::write(&file, format!("{RUN}{CUTTING}").replace("task.csv", "path.csv")).unwrap();
        let notes = read_run(&file).unwrap().notes;
        assert_eq!(
            notes[0],
            "feed is up to 5.71 deg off the normal of the tool axis (task line 3): the wall normal is axis x feed"
        );
        assert!(notes[1].contains("no max_speed_deg_per_s for joints 2: "), "{}", notes[1]);
        assert_eq!(notes.len(), 2);
    }
}
