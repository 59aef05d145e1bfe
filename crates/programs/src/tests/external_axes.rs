//! Programs of a mounted arm with a rail and a tilted turntable, the part turned: written in every form and read back.

use super::bench::{ARMS, Bench};
use crate::{ExportError, ExportOptions, ProgramError, ProgramFormat};

pub const TABLES: &str = "[mount]
xyz_mm = [100, -50, 200]
rpy_deg = [8, -5, 20]
[[external_axis]]
name = 'rail'
kind = 'rail'
carries = 'robot'
direction = [1, 2, 0.5]
range_mm = [-500, 500]
use = 'indexed'
[[external_axis]]
name = 'table'
kind = 'turntable'
carries = 'workpiece'
axis = [0.2, 0, 1]
xyz_mm = [1500, 0, 500]
range_deg = [-90, 90]
use = 'indexed'
";

/// The segment of each point of the task of the bench.
const SEGMENT_OF: [usize; 10] = [0, 0, 0, 0, 1, 1, 1, 2, 2, 3];

/// Where rail and table are at each point: they move along the path, but on a Fanuc the table waits for the next
/// segment.
pub fn positions(name: &str) -> impl Fn(usize) -> Vec<f64> {
    let waits = name == "fanuc";
    move |point| {
        let turned = if waits { 3 * SEGMENT_OF[point] } else { point };
        vec![0.01 * point as f64 - 0.04, 0.1 - 0.02 * turned as f64]
    }
}

fn bench(name: &str) -> Bench {
    Bench::with(name, TABLES, positions(name))
}

/// The options of the form, with what carries the workpiece.
pub fn options(bench: &Bench, format: ProgramFormat) -> ExportOptions<'static> {
    ExportOptions {
        format,
        mechanism: (format == ProgramFormat::Krl).then_some(3),
        unit: (format == ProgramFormat::Rapid).then_some("STN1"),
        ..bench.options()
    }
}

#[test]
fn programs_with_external_axes_bring_the_tool_where_the_plan_has_it() {
    for (name, _, format) in ARMS {
        let bench = bench(name);
        for (format, folder) in [(format, "maker"), (ProgramFormat::Csv, "table")] {
            let program = bench.export(&options(&bench, format)).unwrap();
            let main = bench.written(&program, folder);
            let found = bench.check(&main).unwrap();
            assert!(found.is_sound(), "{name} {format:?}: {found:?}");
            assert!(found.position.unwrap().value < 0.005);
        }
    }
}

#[test]
fn bases_are_coupled_to_what_carries_the_workpiece() {
    let kuka = bench("kuka");
    let program = kuka.export(&options(&kuka, ProgramFormat::Krl)).unwrap();
    let part = &program.files[1].text;
    assert!(part.contains("\n$BASE=EK(MACHINE_DEF[3].ROOT,MACHINE_DEF[3].MECH_TYPE,{FRAME: X "), "{part}");
    assert!(program.notes.iter().any(|note| note.contains("MACHINE_DEF[3]") && note.contains("'table'")));
    assert_eq!(program.frames.len(), 3);
    // The table of the run stands at x = 1500, z = 500 mm in the cell, and its z axis leans towards x.
    assert!(program.frames[2].what.starts_with("table of the mechanism"));
    let abb = bench("abb");
    let program = abb.export(&options(&abb, ProgramFormat::Rapid)).unwrap();
    let main = &program.files[0].text;
    assert!(main.contains("PERS wobjdata w_PART:=[FALSE,FALSE,\"STN1\",[[0,0,0],[1,0,0,0]],[["), "{main}");
    assert!(main.contains("\n    ActUnit STN1;\n"), "{main}");
    // A user frame in the text is not what the controller takes.
    let elsewhere = main.replace("\"STN1\",[[0,0,0]", "\"STN1\",[[700,0,0]");
    let written = abb.written(&program, "p");
    std::fs::write(&written, elsewhere).unwrap();
    assert!(abb.check(&written).unwrap().is_sound());
    std::fs::write(&written, main.replace("    ActUnit STN1;\n", "")).unwrap();
    let message = abb.check(&written).unwrap_err().to_string();
    assert!(message.contains("before ActUnit STN1"), "{message}");
}

#[test]
fn a_static_base_under_a_part_that_turns_is_found() {
    let kuka = bench("kuka");
    let mut program = kuka.export(&options(&kuka, ProgramFormat::Krl)).unwrap();
    // What was written before: the workpiece in the robot root with all axes at zero.
    let placed = stead_runs::plan::read_plan(&kuka.plan, &kuka.run.problem).unwrap().0;
    let problem = kuka.run.problem.in_setup(&placed.setup).into_owned();
    let at_zero = super::super::motion::at_zero(&problem, &placed.placement);
    let frames = super::super::motion::frames(&problem, &at_zero, None).unwrap();
    let fixed = super::super::krl::frame(&frames.root_from_workpiece, [4, 6]);
    let text = &mut program.files[1].text;
    let line = text.lines().find(|line| line.starts_with("$BASE=EK")).unwrap().to_owned();
    *text = text.replace(&line, &format!("$BASE={{FRAME: {fixed}}}"));
    let found = kuka.check(&kuka.written(&program, "still")).unwrap();
    assert!(!found.is_sound() && found.position.unwrap().value > 1.0);

    let abb = bench("abb");
    let mut program = abb.export(&options(&abb, ProgramFormat::Rapid)).unwrap();
    let text = &mut program.files[0].text;
    let (before, rest) = text.split_once("[FALSE,FALSE,\"STN1\",[[0,0,0],[1,0,0,0]],").unwrap();
    *text = format!("{before}[FALSE,TRUE,\"\",[[1500,0,500],[1,0,0,0]],{rest}");
    let found = abb.check(&abb.written(&program, "still")).unwrap();
    assert!(!found.is_sound() && found.position.unwrap().value > 1.0);
}

#[test]
fn what_carries_the_workpiece_has_to_be_stated() {
    let message = |bench: &Bench, options: &ExportOptions<'_>| match bench.export(options) {
        Err(ExportError::Program(error @ ProgramError::Argument { .. })) => error.to_string(),
        other => panic!("{other:?}"),
    };
    let kuka = bench("kuka");
    let found = message(&kuka, &kuka.options());
    assert!(found.starts_with("--mechanism: is missing, ") && found.contains("'table'"), "{found}");
    assert!(found.contains("; allowed: the number n") && found.contains("csv"), "{found}");
    for mechanism in [0, 1, 17] {
        let found = message(&kuka, &ExportOptions { mechanism: Some(mechanism), ..kuka.options() });
        assert!(found.starts_with("--mechanism: is out of range, found "), "{found}");
    }
    let found = message(&kuka, &ExportOptions { unit: Some("STN1"), ..options(&kuka, ProgramFormat::Krl) });
    assert!(found.starts_with("--unit: is not for programs in krl"), "{found}");
    let abb = bench("abb");
    assert!(message(&abb, &abb.options()).starts_with("--unit: is missing, "));
    for unit in ["", "1A", "A\"B", "STN 1", "ABCDEFGHIJKLMNOPQRSTUVWXYZABCDEFG"] {
        let found = message(&abb, &ExportOptions { unit: Some(unit), ..abb.options() });
        assert!(found.starts_with("--unit: is no name of a mechanical unit; allowed: "), "{found}");
    }
    // Nothing carries the workpiece.
    let plain = Bench::new("kuka");
    let found = message(&plain, &ExportOptions { mechanism: Some(2), ..plain.options() });
    assert!(found.contains("no external axis of the run carries the workpiece"), "{found}");
    // A Fanuc whose part turns in the cut.
    let fanuc = Bench::with("fanuc", TABLES, positions("kuka"));
    let found = message(&fanuc, &fanuc.options());
    assert!(found.starts_with("--format: in segment 1 the external axis 'table' moves the workpiece"), "{found}");
    assert!(fanuc.export(&ExportOptions { format: ProgramFormat::Csv, ..fanuc.options() }).is_ok());
}

#[test]
fn a_fanuc_has_its_frame_where_the_part_stands_first() {
    let still = Bench::with("fanuc", TABLES, |point| vec![0.01 * point as f64 - 0.04, 0.3]);
    let part = &still.export(&still.options()).unwrap().files[1].text;
    // The part never turns: positions are those of the task.
    assert!(part.contains("X =     66.667  mm,\tY =      1.000  mm,\tZ =      0.500  mm"), "{part}");
    assert!(still.check(&still.written(&still.export(&still.options()).unwrap(), "p")).unwrap().is_sound());
}

#[test]
fn an_axis_that_is_elsewhere_is_found() {
    for (name, from, to) in [("kuka", "E2 ", "E2 9"), ("fanuc", "E1= ", "E1= 9"), ("abb", "[[", "[[")] {
        let bench = bench(name);
        let mut program = bench.export(&options(&bench, bench.format)).unwrap();
        let part = program.files.last_mut().unwrap();
        if name == "abb" {
            // The second external axis of the last target.
            let at = part.text.rfind(",9E9,9E9,9E9,9E9]").unwrap();
            let before = part.text[..at].rfind(',').unwrap();
            part.text.replace_range(before + 1..at, "77.7000");
        } else {
            assert!(part.text.contains(from), "{}", part.text);
            part.text = part.text.replacen(from, to, 1);
        }
        let main = bench.written(&program, "changed");
        match bench.check(&main) {
            Ok(found) => {
                assert!(!found.is_sound() && found.mismatch.unwrap().contains("external axis E"), "{name}")
            }
            Err(error) => panic!("{name}: {error}"),
        }
    }
}
