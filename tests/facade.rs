//! The library against the command: the same files, byte for byte, and the same documents.

use crate::common::{Bench, RUN};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;
use stead::circularity::{Profile, Sector};
use stead::files::Existing;
use stead::program::{ExportOptions, ProgramFormat, ReadBackOptions};
use stead::{AssessmentRun, CompensationRun, DesignRun, FitRun, Monitor, Placement, Run, SimulationRun, StabilityRun};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    entries.map(|e| (e.file_name().into_string().unwrap(), std::fs::read(e.path()).unwrap())).collect()
}

/// What a result writes against the reference results of the command; maps and series are not kept there.
fn assert_writes_the_results(name: &str, write: impl FnOnce(&Path)) {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    let mut written = files(folder.path());
    written.retain(|file, _| file != "series.csv" && !(file.starts_with("map-") && file.ends_with(".csv")));
    let kept = files(&root().join("results").join(name));
    assert_eq!(written.keys().collect::<Vec<_>>(), kept.keys().collect::<Vec<_>>());
    for (file, bytes) in &kept {
        assert!(written[file] == *bytes, "{name}/{file} differs");
    }
}

#[test]
fn results_write_what_the_commands_left() {
    let configs = root().join("configs");
    let monitor = Monitor::silent();
    assert_writes_the_results("identify-example", |folder| {
        FitRun::read(configs.join("identify-example.toml")).unwrap().fit(&monitor).unwrap().write(folder).unwrap();
    });
    assert_writes_the_results("identify-plan-example", |folder| {
        let run = DesignRun::read(configs.join("identify-plan-example.toml")).unwrap();
        run.plan(&monitor).unwrap().write(folder).unwrap();
    });
    assert_writes_the_results("compensate-caro-2013", |folder| {
        let run = CompensationRun::read(configs.join("compensate-caro-2013.toml")).unwrap();
        run.compensate(&monitor).unwrap().write(folder).unwrap();
    });
    assert_writes_the_results("horizontal-slot", |folder| {
        let run = AssessmentRun::read(configs.join("horizontal-slot.toml")).unwrap();
        run.assess(&monitor).unwrap().write(folder).unwrap();
    });
    assert_writes_the_results("umons-aluminium", |folder| {
        SimulationRun::read(configs.join("umons-aluminium.toml"))
            .unwrap()
            .simulate(&monitor)
            .unwrap()
            .write(folder)
            .unwrap();
    });
    assert_writes_the_results("umons-aluminium-stability", |folder| {
        StabilityRun::read(configs.join("umons-aluminium.toml"))
            .unwrap()
            .analyse(&monitor)
            .unwrap()
            .write(folder)
            .unwrap();
    });
    assert_writes_the_results("measured-groove", |folder| {
        let burr = Sector { start: 354_f64.to_radians(), width: 13_f64.to_radians() };
        let profile = Profile::read(root().join("tasks/measured-groove.csv")).unwrap();
        profile.circularity(&[burr]).unwrap().write(folder).unwrap();
    });
}

#[test]
fn a_job_that_is_stopped_says_so_and_is_no_bad_input() {
    let configs = root().join("configs");
    let run = Run::read(configs.join("caro-2013.toml")).unwrap();
    let plan = root().join("results/caro-2013/best.csv");
    let folder = tempfile::tempdir().unwrap();
    let program = run.export(&plan, &ExportOptions::new(ProgramFormat::Csv, "PART"), &Monitor::silent()).unwrap();
    let main = program.write(folder.path(), Existing::Kept).unwrap().files.remove(0);
    let compensation = CompensationRun::read(configs.join("compensate-caro-2013.toml")).unwrap();
    let simulation = SimulationRun::read(configs.join("umons-aluminium.toml")).unwrap();
    let stability = StabilityRun::read(configs.join("umons-aluminium.toml")).unwrap();
    let (fit, design) = (configs.join("identify-example.toml"), configs.join("identify-plan-example.toml"));
    let (fit, design) = (FitRun::read(fit).unwrap(), DesignRun::read(design).unwrap());
    let requested = Monitor::silent();
    requested.stop_handle().stop();
    let late = Monitor::silent().with_deadline(Some(Instant::now()));
    for (monitor, words) in [(&requested, "stopped before it was done"), (&late, "stopped at its deadline before")] {
        let errors = [
            fit.fit(monitor).unwrap_err(),
            design.plan(monitor).unwrap_err(),
            compensation.compensate(monitor).unwrap_err(),
            compensation.compensate_all(monitor).unwrap_err(),
            simulation.simulate(monitor).unwrap_err(),
            stability.analyse(monitor).unwrap_err(),
            run.export(&plan, &ExportOptions::new(ProgramFormat::Csv, "PART"), monitor).unwrap_err(),
            run.check_program(&plan, &main, &ReadBackOptions::default(), monitor).unwrap_err(),
        ];
        for error in errors {
            assert!(error.is_interrupted() && !error.is_bad_input(), "{error:?}");
            assert!(error.to_string().starts_with(words), "{error}");
        }
    }
}

#[test]
fn placements_are_those_of_the_command_files_and_document() {
    let bench = Bench::new();
    let mut document = bench.stead(&["place", RUN, "--out", "out", "--json"]).json();
    let placements = Run::read(bench.path(RUN)).unwrap().place(&Monitor::silent()).unwrap();
    placements.write(bench.path("mine")).unwrap();
    assert_eq!(files(&bench.path("mine")), files(&bench.path("out")));
    let mut ours = serde_json::to_value(&placements).unwrap();
    for timed in ["wall_s", "threads", "states_per_second"] {
        assert!(ours.as_object_mut().unwrap().remove(timed).is_some());
        document.as_object_mut().unwrap().remove(timed);
    }
    assert_eq!(ours, document);
}

#[test]
fn a_score_outside_the_cell_notes_it_and_an_unknown_point_is_refused() {
    let run = Run::read(root().join("configs/caro-2013.toml")).unwrap();
    let outside = Placement { x: 0.0, y: -1.6, z: -0.214, yaw: 79_f64.to_radians() };
    let score = run.score(&outside, &Monitor::silent()).unwrap();
    assert!(score.notes().iter().any(|note| note.contains("outside the cell")), "{:?}", score.notes());
    assert_eq!(score.to_json()["notes"].as_array().unwrap().len(), score.notes().len());
    let error = run.explain(&outside, 105, 0.0).unwrap_err();
    assert!(error.is_bad_input());
    assert_eq!(error.to_string(), "no such path point, found 105; allowed: 0 to 104");
}
