//! What is in the programs, and what is refused.

use super::super::names::{comment, number};
use super::super::split::parts;
use super::super::{CorrectedPath, ExportError, ExportOptions, Program, ProgramError, ProgramFormat};
use super::bench::{ARMS, Bench};
use std::path::Path;
use stead_disk::Existing;

fn text<'a>(program: &'a Program, name: &str) -> &'a str {
    let file = program.files.iter().find(|file| file.name == name);
    &file.unwrap_or_else(|| panic!("{name} in {:?}", program.files)).text
}

fn refused(bench: &Bench, options: &ExportOptions<'_>) -> String {
    match bench.export(options) {
        Err(error @ ExportError::Program(_)) => error.to_string(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_krl_program_moves_jointly_to_each_segment_and_then_on_lines() {
    let bench = Bench::new("kuka");
    let program = bench.export(&bench.options()).unwrap();
    assert_eq!((program.segments, program.joint_moves, program.linear_moves, program.parts), (4, 4, 14, 1));
    let main = text(&program, "PART.src");
    for part in
        ["&ACCESS RVP\n&REL 1\nDEF PART ( )\n", "\nBAS (#INITMOV,0)\n", "\nPART_01 ( )\n", "; spindle on", "\nEND\n"]
    {
        assert!(main.contains(part), "{part} in {main}");
    }
    assert!(main.contains("\n; collisions were not checked\n"), "{main}");
    let part = text(&program, "PART_01.src");
    for wanted in [
        "$BASE={FRAME: X ",
        "$TOOL={FRAME: X 30.0000,Y -20.0000,Z 500.0000,A ",
        "$APO.CDIS=1.0000\n",
        "$VEL.CP=0.066667\n",
    ] {
        assert!(part.contains(wanted), "{wanted} in {part}");
    }
    let statements: Vec<&str> =
        part.lines().filter(|line| ["PTP", "LIN"].iter().any(|word| line.starts_with(word))).collect();
    assert_eq!(statements.len(), 18);
    // Segment 1: to the retracted point, its four points of which the inner two are blended, and away.
    let kinds: Vec<bool> = statements[..6].iter().map(|line| line.ends_with("} C_DIS")).collect();
    assert_eq!(kinds, [false, false, true, true, false, false]);
    assert!(statements[0].starts_with("PTP {A1 ") && statements[6].starts_with("PTP {A1 "));
    assert!(statements[1].starts_with("LIN {X 0.000,Y 0.000,Z 0.000,A "), "{}", statements[1]);
    assert!(statements[3].starts_with("LIN {X 66.667,Y 1.000,Z 0.500,A "), "{}", statements[3]);
    // The tool axis of segment 1 leans towards y: retracted by 50 mm.
    assert!(statements[5].starts_with("LIN {X 100.000,Y 30.000,Z 40.000,A "), "{}", statements[5]);
    let start = part.lines().find(|line| line.starts_with("; start: ")).unwrap();
    assert!(
        start.starts_with("; start: X 0.000,Y 25.000,Z 43.301,A ") && start.contains(",S ") && start.contains(",T ")
    );
    // S and T stand in comments alone, and no line says them.
    assert!(statements.iter().all(|line| !line.contains(",S ") && !line.contains("-0.0000,")));
}

#[test]
fn the_other_forms_have_the_same_moves() {
    let abb = Bench::new("abb");
    let program = abb.export(&abb.options()).unwrap();
    let main = text(&program, "PART.mod");
    for part in [
        "MODULE M_PART\n",
        "PERS tooldata t_PART:=[TRUE,[[30.0000,-20.0000,500.0000],[",
        "PERS wobjdata w_PART:=[FALSE,TRUE,\"\",[",
    ] {
        assert!(main.contains(part), "{part} in {main}");
    }
    let part = text(&program, "PART_01.mod");
    assert_eq!((part.matches("MoveAbsJ [[").count(), part.matches("MoveL [[").count()), (4, 14));
    assert_eq!((part.matches(",z_PART,").count(), part.matches("ConfL\\Off;").count()), (3, 1));
    assert!(part.contains(",[66.667,500,5000,1000],"));

    let fanuc = Bench::new("fanuc");
    let program = fanuc.export(&fanuc.options()).unwrap();
    let part = text(&program, "PART_01.ls");
    assert_eq!((part.matches("\tJ1=").count(), part.matches("CONFIG : '").count()), (4, 14));
    assert_eq!((part.matches(" 67mm/sec CNT10 ;").count(), part.matches(" 67mm/sec FINE ;").count()), (3, 11));
    let statements: Vec<&str> = part.lines().filter(|line| line.ends_with(" ;")).collect();
    for (line, count) in statements.iter().zip(1..) {
        let (number, statement) = line.split_once(':').unwrap();
        assert_eq!(number.trim(), count.to_string());
        // A remark holds 32 characters.
        assert!(!statement.trim().starts_with('!') || statement.trim().len() <= 1 + 32 + 2, "{line}");
    }
    assert!(program.notes.iter().any(|note| note.contains("whole mm/s")), "{:?}", program.notes);

    let table = fanuc.export(&ExportOptions::new(ProgramFormat::Csv, "PART")).unwrap();
    assert_eq!(table.files.len(), 1);
    let rows: Vec<&str> = text(&table, "PART.csv").lines().collect();
    assert_eq!(rows.len(), 1 + 18);
    assert!(rows.iter().all(|row| row.split(',').count() == 20));
    assert!(rows[1].starts_with("1,,joint,") && rows[2].starts_with("1,0,linear,0.0000,0.0000,0.0000,"));
}

#[test]
fn without_approach_and_blending_each_segment_begins_at_its_first_point_and_stops_at_all() {
    let bench = Bench::new("kuka");
    let program = bench.export(&ExportOptions { approach: 0.0, blend: 0.0, ..bench.options() }).unwrap();
    assert_eq!((program.joint_moves, program.linear_moves), (4, 6));
    let part = text(&program, "PART_01.src");
    assert!(!part.contains("C_DIS\n") && part.contains("$APO.CDIS=0.0000\n"));
    let table = bench.export(&ExportOptions { approach: 0.0, ..ExportOptions::new(ProgramFormat::Csv, "T") }).unwrap();
    assert!(text(&table, "T.csv").lines().nth(1).unwrap().starts_with("1,0,joint,"));
}

#[test]
fn parts_end_at_segments_where_they_can() {
    let bench = Bench::new("kuka");
    let lengths = |max: usize| {
        let program = bench.export(&ExportOptions { max_moves: max, ..bench.options() }).unwrap();
        let count = |text: &str| text.lines().filter(|line| line.starts_with("PTP") || line.starts_with("LIN")).count();
        assert_eq!(program.parts + 1, program.files.len());
        program.files[1..].iter().map(|file| count(&file.text)).collect::<Vec<_>>()
    };
    // Segments of 6, 5, 4 and 3 moves.
    assert_eq!(lengths(18), [18]);
    assert_eq!(lengths(17), [15, 3]);
    assert_eq!(lengths(11), [11, 7]);
    assert_eq!(lengths(6), [6, 5, 4, 3]);
    assert_eq!(lengths(4), [4, 2, 4, 1, 4, 3]);
    assert_eq!(lengths(1), [1; 18]);
    assert!(parts(&[], 5).is_empty());
    // The same moves, whatever the parts; where a cut part ends it stops.
    let moves = |max: usize| {
        let program = bench.export(&ExportOptions { max_moves: max, ..bench.options() }).unwrap();
        let all: String = program.files[1..].iter().map(|file| file.text.as_str()).collect();
        let lines = all.lines().filter(|line| line.starts_with("PTP") || line.starts_with("LIN"));
        lines.map(|line| line.trim_end_matches(" C_DIS").to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(moves(4), moves(5000));
    let cut = bench.export(&ExportOptions { max_moves: 4, ..bench.options() }).unwrap();
    assert!(text(&cut, "PART_02.src").contains("; segment 1 goes on\n"));
    let last = text(&cut, "PART_01.src").lines().rev().nth(1).unwrap();
    assert!(last.starts_with("LIN") && !last.ends_with("C_DIS"), "{last}");
}

#[test]
fn names_that_the_controller_does_not_take_are_refused() {
    for (arm, _, format) in ARMS {
        let bench = Bench::new(arm);
        let message = |name: &str| refused(&bench, &ExportOptions::new(format, name));
        for name in ["", "1PART", "_A", "PA RT", "PART;", "PART)", "P\nART", "PÄRT", "A.B", "loop", "Proc"] {
            let message = message(name);
            assert!(message.contains("; allowed: up to ") && message.lines().count() == 1, "{message}");
        }
        let longest = match format {
            ProgramFormat::Krl => 21,
            ProgramFormat::Rapid => 27,
            _ => 33,
        };
        assert!(message(&"P".repeat(longest + 1)).contains("more than the controller takes"));
        let long = bench.export(&ExportOptions::new(format, &"P".repeat(longest))).unwrap();
        let is_noted = long.notes.iter().any(|note| note.contains("older make"));
        assert_eq!(is_noted, format != ProgramFormat::Krl, "{:?}", long.notes);
    }
}

#[test]
fn texts_of_the_user_stay_in_their_place() {
    let mut bench = Bench::new("kuka");
    let on = |text: &'static str, bench: &Bench| {
        refused(bench, &ExportOptions { spindle_on: Some(text), ..bench.options() })
    };
    for text in ["$OUT[1]=TRUE\nPTP {A1 0}", "a\rb", "\u{2028}", "", "  ", "x\u{0}"] {
        let message = on(text, &bench);
        assert!(
            message.starts_with("--spindle-on: is no statement that is taken, found '")
                && message.contains("; allowed: ")
        );
        assert_eq!(message.lines().count(), 1);
    }
    let spindle =
        ExportOptions { spindle_on: Some("$OUT[1]=TRUE"), spindle_off: Some("$OUT[1]=FALSE"), ..bench.options() };
    let program = bench.export(&spindle).unwrap();
    assert!(text(&program, "PART.src").contains("\n$OUT[1]=TRUE\nPART_01 ( )\n$OUT[1]=FALSE\nEND\n"));
    let fanuc = Bench::new("fanuc");
    let options = ExportOptions { spindle_off: Some("DO[1]=ON ; L P[1] 100% FINE"), ..fanuc.options() };
    assert!(refused(&fanuc, &options).contains("without a semicolon"));
    let abb = Bench::new("abb");
    let program = abb.export(&ExportOptions { spindle_on: Some("SetDO do1,1;"), ..abb.options() }).unwrap();
    assert!(text(&program, "PART.mod").contains("\n    SetDO do1,1;\n"));

    // Names of files, in comments.
    bench.run.inputs[0].name = "run\nLIN {X 0}\u{e4}.toml".to_owned();
    let program = bench.export(&bench.options()).unwrap();
    assert!(text(&program, "PART.src").contains("; config: run?LIN {X 0}?.toml\n"));
    assert_eq!(comment("a\tb;\u{7f}", 3), "a?b");
}

#[test]
fn an_arm_that_does_not_say_how_its_controller_counts_gets_a_table_alone() {
    let mut bench = Bench::new("kuka");
    let other = |format| refused(&bench, &ExportOptions::new(format, "PART"));
    assert_eq!(other(ProgramFormat::Fanuc), "--format: fanuc is not for the robot's controller; allowed: krl, csv");
    let controller = *bench.run.problem.robot.controller().unwrap();
    let without_root = stead_model::robot::Controller { root_from_base: None, ..controller };
    bench.run.problem.robot = bench.run.problem.robot.clone().with_controller(without_root);
    let message = bench.export(&bench.options()).unwrap_err().to_string();
    assert!(message.starts_with("arm.toml: root: is missing, and a program in krl needs it; allowed: "), "{message}");
    let table = bench.export(&ExportOptions::new(ProgramFormat::Csv, "PART")).unwrap();
    assert!(table.frames.is_empty() && table.notes[0].contains("no [root]"));

    let robot = std::fs::read_to_string(bench.path("arm.toml")).unwrap();
    let rows = robot.split("[controller]").next().unwrap();
    std::fs::write(bench.path("arm.toml"), rows).unwrap();
    bench.run = stead_run_files::read_run(&bench.path("run.toml")).unwrap();
    let message = bench.export(&bench.options()).unwrap_err().to_string();
    assert!(message.starts_with("arm.toml: controller: is missing") && message.contains("--format csv"), "{message}");
    let table = bench.export(&ExportOptions::new(ProgramFormat::Csv, "PART")).unwrap();
    assert!(text(&table, "PART.csv").lines().nth(1).unwrap().ends_with(",,,,,,,"));
    assert!(bench.check(&bench.written(&table, "t")).unwrap().is_sound());
}

#[test]
fn numbers_out_of_range_and_points_out_of_reach_are_refused() {
    let bench = Bench::new("kuka");
    for options in [
        ExportOptions { approach: -0.001, ..bench.options() },
        ExportOptions { approach: 1.001, ..bench.options() },
        ExportOptions { approach: f64::NAN, ..bench.options() },
        ExportOptions { blend: -0.001, ..bench.options() },
        ExportOptions { blend: 0.2, ..bench.options() },
        ExportOptions { max_moves: 0, ..bench.options() },
    ] {
        assert!(
            matches!(bench.export(&options), Err(ExportError::Program(ProgramError::Argument { .. }))),
            "{options:?}"
        );
    }
    // A metre back along the tool axis leads out of the reach or the limits somewhere.
    let message = refused(&bench, &ExportOptions { approach: 1.0, ..bench.options() });
    assert!(
        message.starts_with("point ")
            && message.contains(" mm back along the tool axis ")
            && message.contains("--approach-mm")
    );
}

#[test]
fn files_that_are_there_are_left_as_they_are() {
    let bench = Bench::new("kuka");
    let program = bench.export(&bench.options()).unwrap();
    std::fs::create_dir(bench.path("p")).unwrap();
    std::fs::write(bench.path("p/PART_01.src"), "mine").unwrap();
    let message = program.write(&bench.path("p"), Existing::Kept).unwrap_err().to_string();
    assert!(message.contains("PART_01.src: is there already"), "{message}");
    assert!(!bench.path("p/PART.src").exists());
    // Nor replaced: it is no work of an export.
    let message = program.write(&bench.path("p"), Existing::Replaced).unwrap_err().to_string();
    assert!(message.contains("PART_01.src: was not written by this command"), "{message}");
    assert!(!bench.path("p/PART.src").exists());
    assert_eq!(std::fs::read_to_string(bench.path("p/PART_01.src")).unwrap(), "mine");
}

#[test]
fn parts_of_a_longer_program_that_is_replaced_are_removed_and_no_other_file() {
    for (arm, _, format) in super::bench::ARMS {
        let bench = Bench::new(arm);
        let folder = bench.path("p");
        let long = bench.export(&ExportOptions { max_moves: 4, ..bench.options() }).unwrap();
        let short = bench.export(&bench.options()).unwrap();
        assert!(long.parts > 3 && short.parts == 1);
        long.write(&folder, Existing::Kept).unwrap();
        let ending = short.files[0].name.strip_prefix("PART").unwrap().to_owned();
        let at = |stem: &str| folder.join(format!("{stem}{ending}"));
        // A file of the user's own; a program of its own that is named as a part; files that only look like parts.
        std::fs::write(at("PART_03"), "mine").unwrap();
        let other = bench.export(&ExportOptions::new(format, "PART_44")).unwrap();
        let mut kept = other.write(&folder, Existing::Kept).unwrap().files;
        for stem in ["PART_2", "PART_002", "PART_x", "PART_02_01", "XPART_02"] {
            std::fs::write(at(stem), &long.files[2].text).unwrap();
            kept.push(at(stem));
        }
        kept.extend([at("PART"), at("PART_01"), at("PART_03")]);
        let written = short.write(&folder, Existing::Replaced).unwrap();
        assert_eq!(written.files, [at("PART"), at("PART_01")]);
        let mut left: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        kept.sort();
        left.sort();
        assert_eq!(left, kept, "{arm}");
        assert_eq!(std::fs::read_to_string(at("PART_03")).unwrap(), "mine");
        let [removed, named] = &written.notes[..] else { panic!("{:?}", written.notes) };
        assert!(removed.starts_with("removed as parts") && removed.contains(&at("PART_02").display().to_string()));
        assert!(!removed.contains("PART_03") && !removed.contains("PART_44"), "{removed}");
        assert!(named.contains(&format!("PART_03{ending}")) && named.contains(&format!("PART_44{ending}")), "{named}");
    }
}

#[test]
fn a_corrected_path_that_is_none_is_refused() {
    let bench = Bench::new("kuka");
    let corrected = |file: &'static str| ExportOptions {
        corrected: Some(CorrectedPath { file: Path::new(file), is_uncorrected_as_planned: true }),
        ..bench.options()
    };
    let message = bench.export(&corrected("nowhere.csv")).unwrap_err().to_string();
    assert!(message.starts_with("nowhere.csv: cannot be read: "), "{message}");
}

#[test]
fn zero_has_no_sign() {
    assert_eq!(
        ["-0.0004", "-0.0005001", "0", "-12"].map(|text| number(text.parse().unwrap(), 3)),
        ["0.000", "-0.001", "0.000", "-12.000"]
    );
}

#[test]
fn arms_get_the_form_of_the_controllers_of_their_maker() {
    for (name, form) in [
        ("kuka-kr500", ProgramFormat::Krl),
        ("abb-irb4400-60", ProgramFormat::Rapid),
        ("fanuc-m10ia", ProgramFormat::Fanuc),
        ("staubli-tx200", ProgramFormat::Csv),
    ] {
        let robot = stead_format::robot::read_geometry(Path::new(&format!("name:{name}"))).unwrap();
        assert_eq!(ProgramFormat::of_robot(&robot), form, "{name}");
    }
}
