//! Studies that are read: their cases, in which order, and what tells one from another.

use super::*;
use crate::testing::{RUN, TASK, folder};
use stead_runs::study::AxisValue;
use tempfile::TempDir;

/// A study of this text beside the run of the tests.
fn study_in(folder: &TempDir, text: &str) -> Result<Study, InputError> {
    std::fs::write(folder.path().join("run.toml"), RUN).unwrap();
    let file = folder.path().join("study.toml");
    std::fs::write(&file, text).unwrap();
    read_study(&file)
}

fn shown(study: &Study) -> Vec<String> {
    let value = |value: &AxisValue| match value {
        AxisValue::Number(number) => number.to_string(),
        AxisValue::Text(text) => text.clone(),
    };
    study.cases.iter().map(|case| case.values.iter().map(value).collect::<Vec<_>>().join(",")).collect()
}

fn ids(study: &Study) -> Vec<String> {
    study.cases.iter().map(|case| study.case(case, &Monitor::silent()).unwrap().id).collect()
}

const TWO: &str = "base = 'run.toml'
[[axis]]
field = 'robot.joints[1].stiffness_mnm_per_rad'
values = [0.2, 0.4]
[[axis]]
name = 'height'
field = 'cell.z_mm'
values = [[-500, -500], [-400, -400], [-300, -300]]
labels = ['low', 'middle', 'high']
";

#[test]
fn a_grid_has_every_value_with_every_other() {
    let folder = folder();
    let study = study_in(&folder, TWO).unwrap();
    assert_eq!(study.axes, ["robot.joints[1].stiffness_mnm_per_rad", "height"]);
    assert_eq!(shown(&study), ["0.2,low", "0.2,middle", "0.2,high", "0.4,low", "0.4,middle", "0.4,high"]);
    let run = study.case(&study.cases[4], &Monitor::silent()).unwrap().run;
    assert_eq!(run.problem.cell.position[2].min, -0.4);
    assert_eq!(run.problem.robot.joints()[0].compliance, (1e-6 / 0.4).into());
}

#[test]
fn conditions_leave_cases_out() {
    let folder = folder();
    for (condition, expected) in [
        ("height == \"low\"", &["0.2,middle", "0.2,high", "0.4,middle", "0.4,high"][..]),
        (
            "cell.z_mm[1] > -450 and robot.joints[1].stiffness_mnm_per_rad >= 0.4",
            &["0.2,low", "0.2,middle", "0.2,high", "0.4,low"],
        ),
        ("height != \"high\"", &["0.2,high", "0.4,high"]),
    ] {
        let study = study_in(&folder, &format!("exclude = ['{condition}']\n{TWO}")).unwrap();
        assert_eq!(shown(&study), expected, "{condition}");
        let numbers: Vec<usize> = study.cases.iter().map(|case| case.number).collect();
        assert_eq!(numbers, (1..=expected.len()).collect::<Vec<_>>());
    }
}

#[test]
fn zipped_axes_go_together_and_ranges_end_where_they_say() {
    let folder = folder();
    let text = "base = 'run.toml'\ncombine = 'zipped'
[[axis]]
field = 'search.seed'
values = [1, 2, 3]
[[axis]]
field = 'cell.x_mm[1]'
range = { from = -100, to = -300, count = 3 }
[[axis]]
field = 'constraints.characteristic_length_mm'
range = { from = 100, to = 400, count = 3, spacing = 'log' }
[[axis]]
fields = ['cell.y_mm[1]', 'cell.y_mm[2]']
values = [[-2000, -1900], [-2100, -2000], [-2200, -2100]]
";
    let study = study_in(&folder, text).unwrap();
    assert_eq!(shown(&study), ["1,-100,100,-2000 & -1900", "2,-200,200,-2100 & -2000", "3,-300,400,-2200 & -2100"]);
    let run = study.case(&study.cases[2], &Monitor::silent()).unwrap().run;
    assert_eq!((run.search.seed, run.problem.constraints.characteristic_length), (3, 0.4));
    assert_eq!(run.problem.cell.position[1].min, -2.2);
}

#[test]
fn steps_go_up_to_the_end_and_not_past_it() {
    let folder = folder();
    for (range, expected) in [
        ("from = 0, to = 100, step = 25", &["0", "25", "50", "75", "100"][..]),
        ("from = 0, to = 90, step = 25", &["0", "25", "50", "75"]),
        ("from = 1, to = 0.7, step = 0.1", &["1", "0.9", "0.8", "0.7"]),
    ] {
        let text = format!(
            "base = 'run.toml'\n[[axis]]\nfield = 'constraints.characteristic_length_mm'\nrange = {{ {range} }}\n"
        );
        assert_eq!(shown(&study_in(&folder, &text).unwrap()), expected, "{range}");
    }
    let text = "base = 'run.toml'\ncombine = 'latin'\nsamples = 6\n[[axis]]\nfield = 'cell.x_mm[1]'
range = { from = -300, to = -100, step = 100 }\n";
    let mut values = shown(&study_in(&folder, text).unwrap());
    values.sort();
    assert_eq!(values, ["-100", "-100", "-200", "-200", "-300", "-300"]);
    for (range, parts) in [
        ("from = 0, to = 90, step = 91", ["axis[1].range.step: ", "leaves one value", "found 91", "at most 90"]),
        ("from = 0, to = 90, step = 1e-7", ["axis[1].range.step: ", "more than a million", "found 1e-7", "millionth"]),
        ("from = 0, to = 90, step = 0", ["axis[1].range.step: ", "out of range", "found 0", "above 0"]),
        ("from = 0, to = 90, step = 9, count = 3", ["axis[1].range.step: ", "beside count", "found 9", "one of"]),
        ("from = 1, to = 9, step = 2, spacing = 'log'", ["axis[1].range.step: ", "ratios", "found 2", "linear"]),
    ] {
        let text = format!("base = 'run.toml'\n[[axis]]\nfield = 'cell.x_mm[1]'\nrange = {{ {range} }}\n");
        let message = study_in(&folder, &text).unwrap_err().to_string();
        assert!(parts.iter().all(|part| message.contains(part)), "{message}");
    }
}

#[test]
fn a_latin_hypercube_meets_every_stratum_once() {
    let folder = folder();
    let text = "base = 'run.toml'\ncombine = 'latin'\nsamples = 20\nseed = 7
[[axis]]
field = 'cell.x_mm[1]'
range = { from = -100, to = -300 }
[[axis]]
field = 'search.seed'
values = [1, 2, 3, 4]
";
    let study = study_in(&folder, text).unwrap();
    let numbers = |axis: usize| {
        let number = |case: &StudyCase| match case.values[axis] {
            AxisValue::Number(number) => number,
            AxisValue::Text(_) => f64::NAN,
        };
        study.cases.iter().map(number).collect::<Vec<_>>()
    };
    let mut strata: Vec<usize> = numbers(0).iter().map(|x| ((-100.0 - x) / 10.0) as usize).collect();
    assert!(!strata.is_sorted());
    strata.sort_unstable();
    assert_eq!(strata, (0..20).collect::<Vec<_>>());
    for seed in 1..=4 {
        assert_eq!(numbers(1).iter().filter(|found| **found == f64::from(seed)).count(), 5);
    }
    assert_eq!(shown(&study), shown(&study_in(&folder, text).unwrap()));
    assert_ne!(shown(&study), shown(&study_in(&folder, &text.replace("seed = 7", "seed = 8")).unwrap()));
}

#[test]
fn the_digest_of_a_case_is_that_of_what_decides_its_result() {
    let folder = folder();
    let before = ids(&study_in(&folder, TWO).unwrap());
    let mut distinct = before.clone();
    distinct.sort();
    distinct.dedup();
    assert_eq!((distinct.len(), before[0].len()), (6, 64));
    // Where the same values come from does not count, nor how they are written, nor labels.
    let other =
        TWO.replace("[0.2, 0.4]", "[2e-1, 0.40]").replace("'low'", "'lower'").replace("[-500, -500]", "[-500.0, -5e2]");
    assert_eq!(ids(&study_in(&folder, &other).unwrap())[1..3], before[1..3]);
    let moved = "base = 'run.toml'\n[[axis]]\nfield = 'robot'\nvalues = ['arms/a.toml', 'arm.toml']\n";
    std::fs::create_dir(folder.path().join("arms")).unwrap();
    std::fs::copy(folder.path().join("arm.toml"), folder.path().join("arms/a.toml")).unwrap();
    let same = ids(&study_in(&folder, moved).unwrap());
    assert_eq!(same[0], same[1]);
    // The bytes of every file do.
    let task = folder.path().join("task.csv");
    std::fs::write(&task, TASK.replace("10,20,0\n1", "10,21,0\n1")).unwrap();
    let after = ids(&study_in(&folder, TWO).unwrap());
    assert!(before.iter().all(|id| !after.contains(id)));
}

#[test]
fn tasks_joined_to_one_keep_their_segments_and_weights() {
    let folder = folder();
    std::fs::write(folder.path().join("second.csv"), TASK.replace("10,20,0", "30,40,0")).unwrap();
    let tasks = "placement = 'one'\n[[task]]\nfile = 'task.csv'\nweight = 2\n[[task]]\nfile = 'second.csv'\n";
    let study = study_in(&folder, &format!("base = 'run.toml'\n{tasks}")).unwrap();
    let CaseRun { run, task, .. } = study.case(&study.cases[0], &Monitor::silent()).unwrap();
    assert_eq!((study.cases.len(), task.as_str()), (1, "task.csv + second.csv"));
    assert_eq!((run.problem.task.segments().len(), run.problem.task.points().len()), (2, 4));
    assert_eq!(run.problem.task.loads()[2].wrench.force.x, 30.0);
    assert_eq!(run.problem.criterion.segment_weights, [2.0, 1.0]);
    let each = study_in(&folder, &format!("base = 'run.toml'\n{}", tasks.replace("'one'", "'each'"))).unwrap();
    assert_eq!(
        (each.axes.as_slice(), shown(&each)),
        (&["task".to_owned()][..], vec!["task.csv".to_owned(), "second.csv".to_owned()])
    );
    assert_eq!(each.cases.iter().map(|case| case.weight).collect::<Vec<_>>(), [2.0, 1.0]);
    std::fs::write(folder.path().join("second.csv"), crate::testing::PATH).unwrap();
    let message = study_in(&folder, &format!("base = 'run.toml'\n{tasks}")).unwrap_err().to_string();
    assert!(message.contains("have forces in some files and none in others"), "{message}");
}

#[test]
fn an_error_in_a_case_names_its_combination() {
    let folder = folder();
    let study = study_in(&folder, &TWO.replace("0.4", "0")).unwrap();
    let message = study.case(&study.cases[5], &Monitor::silent()).unwrap_err().to_string();
    let parts = [
        "arm.toml: case 6 of study.toml (robot.joints[1].stiffness_mnm_per_rad = 0, height = high): joints[1].stiffness",
        "is out of range, found 0; allowed: a finite number above 0",
    ];
    for part in parts {
        assert!(message.contains(part), "{part} in {message}");
    }
}
