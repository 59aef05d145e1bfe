//! Every word of CLDATA, and every way to get it wrong.

use super::*;

/// Every word that the reader knows, in inches, turned upside down, in both orders where there are two.
pub const EVERY_WORD: &str = include_str!("../fixtures/every_word.cls");

fn line(text: &str) -> String {
    format!("UNITS/MM\nFEDRAT/600\nGOTO/0,0,0\n{text}\nGOTO/9,9,0\nFINI\n")
}

#[test]
fn every_word_is_understood() {
    let read = program(EVERY_WORD, &settings()).unwrap();
    let inch = 25.4e-3;
    let near = |a: Vector3<f64>, b: [f64; 3]| assert!((a / inch - Vector3::from(b)).norm() < 1e-9, "{a} {b:?}");
    // MSYS: origin at x = 1, y and z against those of the part.
    near(read.moves[0].position, [1.0, 0.0, -2.0]);
    assert_eq!(read.moves[0].axis, -Vector3::z());
    assert!(read.moves[1].is_rapid && !read.moves[2].is_rapid);
    near(read.moves[2].position, [2.0, 0.0, 0.0]);
    let feeds: Vec<f64> = read.moves.iter().filter_map(|one| one.feed).collect();
    for feed in [30.0 * inch / 60.0, 0.1e-3 * 100.0, 0.005 * inch * 100.0] {
        assert!(feeds.iter().any(|own| (own - feed).abs() < 1e-12), "{feed} in {feeds:?}");
    }
    let arc: Vec<&Move> = read.moves.iter().filter(|one| one.is_fixed).collect();
    near(arc[arc.len() - 1].position, [3.0, -1.0, 0.0]);
    assert!(arc.iter().all(|one| ((one.position / inch - Vector3::new(2.0, -1.0, 0.0)).norm() - 1.0).abs() < 1e-9));
    // Counter-clockwise in the frame of the file is by way of its lower right.
    assert!(arc.iter().any(|one| one.position.x > 2.6 * inch && one.position.y > -0.4 * inch));
    let tilted = read.moves.iter().find(|one| one.axis.y < -0.5).unwrap();
    assert!((tilted.axis - Vector3::new(0.0, -0.6, -0.8)).norm() < 1e-9);
    near(read.moves.last().unwrap().position, [0.0, 0.0, 9.0]);
    assert_eq!(read.tools, ["TLDATA/MILL,.5,0.,3.,0.,0.", "LOADTL/1"]);
    assert_eq!(read.passed_over.keys().collect::<Vec<_>>(), ["COOLNT", "MACHIN", "PARTNO"]);
    for note in ["CUTCOM", "frame of MSYS", "frame of CSYS"] {
        assert!(read.notes.keys().any(|own| own.starts_with(note)), "{note} in {:?}", read.notes);
    }
}

#[test]
fn units_are_stated_once_by_file_or_option() {
    let bare = "GOTO/0,0,0\nGOTO/9,0,0\nFINI\n";
    refused(bare, &settings(), ": --units", &["does not state its unit", "--units mm"]);
    let inch = ReadSettings { units: Some(LengthUnit::Inch), ..settings() };
    assert!((program(bare, &inch).unwrap().moves[1].position.x - 9.0 * 25.4e-3).abs() < 1e-12);
    refused(&line(""), &inch, ":1: UNITS", &["'MM'", "--units says: inch"]);
    refused("UNIT/CM\nGOTO/0,0,0\n", &settings(), ":1: UNIT", &["names no unit", "'CM'"]);
    refused("UNITS/MM\nUNITS/INCHES\nGOTO/0,0,0\n", &settings(), ":2: UNITS", &["one unit"]);
}

#[test]
fn each_broken_statement_names_line_word_value_and_what_is_allowed() {
    for (text, word, parts) in [
        ("GOTO/1,2,nan", "GOTO", ["not finite", "'1,2,nan'"]),
        ("GOTO/1,2,inf", "GOTO", ["not finite", "3 or 6"]),
        ("GOTO/1,2,1e9", "GOTO", ["usual size", "3 or 6"]),
        ("GOTO/1,2,3,0,0", "GOTO", ["5 numbers", "3 or 6"]),
        ("GOTO/1,2", "GOTO", ["2 numbers", "3 or 6"]),
        ("GOTO/1,2,P3", "GOTO", ["2 numbers", "'1,2,P3'"]),
        ("GOTO/1,2,3,P4", "GOTO", ["3 numbers", "'1,2,3,P4'"]),
        ("GOTO", "GOTO", ["0 numbers", "'GOTO'"]),
        ("GOTO/1,2,3,0,0,0", "GOTO", ["no length", "a direction"]),
        ("FEDRAT/0", "FEDRAT", ["not a feed", "above 0"]),
        ("FEDRAT/MMPM", "FEDRAT", ["0 numbers", "one feed"]),
        ("FEDRAT/MMPM,nan", "FEDRAT", ["not finite", "one feed"]),
        ("FEDRAT/5,FURLONGS", "FEDRAT", ["not a unit of feed", "MMPM"]),
        ("FEDRAT/.1,MMPR", "FEDRAT", ["without a spindle speed", "SPINDL"]),
        ("MSYS/0,0,0,1,0,0,0,1", "MSYS", ["8 numbers", "9 numbers"]),
        ("MSYS/0,0,0,0,0,0,0,1,0", "MSYS", ["no rotation", "right angles"]),
        ("MSYS/0,0,0,1,0,0,1,0,0", "MSYS", ["no rotation", "right angles"]),
        ("CSYS/1,0,0,0,0,1,0,0,0,0,-1,0", "CSYS", ["no rotation", "right-handed"]),
        ("CIRCLE/0,0,0,0,0,1,5,0", "CIRCLE", ["8 numbers", "6 or 11"]),
        ("MODE/INCR", "MODE", ["count from the last one", "'INCR'"]),
        ("SET/MODE,INCR", "SET", ["count from the last one", "'MODE,INCR'"]),
        ("RETRCT", "RETRCT", ["a retract to where the machine says", "--ignore RETRCT"]),
        ("XFORM/1,0,0", "XFORM", ["3 numbers may move the tool", "--ignore XFORM"]),
        ("MCS/1,0,0,0,1,0,0,0,-1,0,0,0", "MCS", ["no rotation", "right-handed"]),
        ("MCSYS/NUM,1,POINT,0,0,0,VECTOR,1,0,0", "MCSYS", ["7 numbers", "origin, x axis, y axis"]),
        ("ORIGIN/0,0", "ORIGIN", ["2 numbers", "an origin"]),
        ("TLAXIS/0,0,0", "TLAXIS", ["no length", "a direction"]),
        ("INDIRV/1,0", "INDIRV", ["2 numbers", "a direction"]),
        ("TLON,GOFWD/(CIRCLE/0,5,0,5),ON,(LINE/0,5,0,5,5,0)", "TLON", ["without its way out", "INDIRV/i,j,k"]),
        ("INDIRV/1,0,0\nTLON,GOFWD/(CYLNDR/0,5,0,0,0,1,5),ON,(LINE/0,5,0,5,5,0)", "TLON", ["with words", "INTOF"]),
        ("INDIRV/0,1,0\nTLON,GOFWD/(CIRCLE/0,5,0,5),ON,(LINE/0,5,0,5,5,0)", "TLON", ["not along the circle", "INTOF"]),
        ("MOVARC/0,5,0,0,0,1,5,ANGLE,900", "MOVARC", ["words or an angle", "degrees up to 360"]),
        ("MOVARC/0,5,0,0,0,1", "MOVARC", ["6 numbers", "centre, axis, radius"]),
        ("ZERO/1\nZERO/2", "ZERO", ["second work offset", "'2'"]),
        (
            "CYCLE/DRILL,DEPTH,5,CLEAR,2\nTOOL PATH/B,TOOL,T",
            "TOOL PATH",
            ["cycle of line 4 is still open", "CYCLE/OFF"],
        ),
        ("CYCLE/DRILL,DEPTH,5,CLEAR,2\nLOADTL/2", "LOADTL", ["cycle of line 4 is still open", "CYCLE/OFF"]),
        ("CYCLE/DRILL,DEPTH,5,CLEAR,2\nCIRCLE/0,0,0,0,0,1", "CIRCLE", ["cycle of line 4", "CYCLE/OFF"]),
        ("TRNTYP/WORLD,0,0,5", "TRNTYP", ["an origin other", "frame of the part"]),
        ("CIRCLE/0,0,0,0,0,1,5,0,0,0,0,TIMES,2.5", "CIRCLE", ["with words", "6 or 11"]),
        ("CIRCLE/0,0,0,0,0,1\nRAPID", "RAPID", ["between the arc of line 4 and its end", "a GOTO behind"]),
        ("TLDATA/MILL,nan", "TLDATA", ["not finite", "'MILL,nan'"]),
        ("NURBS/1,2", "NURBS", ["a spline", "GOTO, RAPID, arcs"]),
        ("CYCLE/DRILL,5", "CYCLE", ["a cycle whose moves are not known", "'DRILL,5'"]),
        ("GODLTA/0,0,5", "GODLTA", ["counts from the last position", "straight moves"]),
        ("P1=POINT/0,0,0", "P1=POINT", ["may move the tool", "straight moves"]),
    ] {
        let at = 4 + text.matches('\n').count();
        refused(&line(text), &settings(), &format!(":{at}: {word}"), &parts);
    }
}

#[test]
fn arcs_that_miss_are_refused_at_their_end() {
    let arc = |circle: &str, goto: &str| line(&format!("{circle}\nGOTO/{goto}"));
    for (circle, goto, part) in [
        ("CIRCLE/5,0,0,0,0,1", "5,6,0", "misses its end: radius 5.0000 mm at its start, 6.0000 mm there"),
        ("CIRCLE/5,0,0,0,0,1", "5,5,1", "1.0000 mm out of its plane"),
        ("CIRCLE/5,0,0,0,0,0", "5,5,0", "axis of the arc has no length"),
        ("CIRCLE/0,0,0,0,0,1", "5,5,0", "radius 0.0000 mm at its start"),
        ("CIRCLE/5,0,0,0,0,-1,4,0,0,0,0", "5,5,0", "misses its start: radius 5.0000 mm, stated 4.0000 mm"),
    ] {
        refused(&arc(circle, goto), &settings(), ":5: GOTO", &[part]);
    }
    let rapid = "UNITS/MM\nFEDRAT/600\nGOTO/0,0,0\nRAPID\nCIRCLE/5,0,0,0,0,1\nGOTO/5,5,0\n";
    refused(rapid, &settings(), ":6: GOTO", &["RAPID and the end of an arc for the same move"]);
    refused("UNITS/MM\nCIRCLE/5,0,0,0,0,1\nGOTO/5,5,0\n", &settings(), ":3: GOTO", &["an arc without a start"]);
    refused("UNITS/MM\nGOTO/0,0,0\nCIRCLE/5,0,0,0,0,1", &settings(), ":3: CIRCLE", &["before the end of the arc"]);
}

#[test]
fn a_file_that_is_cut_short_is_read_and_said_to_be() {
    let read = program("UNITS/MM\nGOTO/0,0,0\nGOTO/9,0,0\n", &settings()).unwrap();
    assert!(read.notes.keys().any(|note| note.contains("cut short")));
}

/// The places of the arc of a program with this end, in millimetres.
fn arc_of(circle: &str, goto: &str) -> Vec<Vector3<f64>> {
    let text = format!("UNITS/MM\nFEDRAT/600,MMPM\nGOTO/10,0,0\n{circle}\nGOTO/{goto}\nFINI\n");
    let read = program(&text, &settings()).unwrap_or_else(|e| panic!("{e}"));
    read.moves.iter().filter(|one| one.is_fixed).map(|one| one.position * 1e3).collect()
}

#[test]
fn arcs_of_nx_are_left_handed_and_those_of_solidworks_and_creo_right_handed() {
    let length = |points: &[Vector3<f64>]| {
        points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum::<f64>() + (points[0] - Vector3::x() * 10.0).norm()
    };
    let quarter = std::f64::consts::PI * 5.0;
    for (circle, quarters) in [
        ("CIRCLE/0,0,0,0,0,1", 1.0),
        ("CIRCLE/0,0,0,0,0,1,10", 1.0),
        ("CIRCLE/0,0,0,0,0,1,10,.06,.5,20,0", 3.0),
        ("CIRCLE/0,0,0,0,0,-1,10,.06,.5,20,0", 1.0),
        ("CIRCLE/0,0,0,0,0,-1,10", 3.0),
    ] {
        let points = arc_of(circle, "0,10,0");
        assert!((length(&points) / (quarter * quarters) - 1.0).abs() < 2e-3, "{circle}: {}", length(&points));
    }
    let helix = arc_of("CIRCLE/0,0,0,0,0,-1,10,.06,.5,20,0,TIMES,3", "10,0,-6");
    assert!((length(&helix) / (quarter * 12.0) - 1.0).abs() < 2e-3, "{}", length(&helix));
    assert!(helix.iter().all(|place| (place.xy().norm() - 10.0).abs() < 1e-9));
    let halfway = helix[helix.len() / 2 - 1];
    assert!((halfway.z + 3.0).abs() < 0.1, "{halfway}");
    let beside = "UNITS/MM\nFEDRAT/600\nGOTO/10,0,0\nCIRCLE/0,0,0,0,0,-1,10,0,0,0,0,TIMES,2\nGOTO/0,10,-6\nFINI\n";
    refused(beside, &settings(), ":5: GOTO", &["a helix whose end is", "whole turns behind TIMES"]);
}

#[test]
fn an_arc_that_turns_back_at_both_ends_is_taken_the_other_way_round_with_its_line() {
    let path = |axis: &str| {
        format!(
            "UNITS/MM\nFEDRAT/600\nGOTO/-20,-10,0\nGOTO/0,-10,0\nCIRCLE/0,0,0,0,0,{axis}\nGOTO/10,0,0\nGOTO/10,20,0\nFINI\n"
        )
    };
    let [right, turned] = ["1", "-1"].map(|axis| program(&path(axis), &settings()).unwrap());
    assert_eq!(turned.moves.len(), right.moves.len());
    for (one, other) in right.moves.iter().zip(&turned.moves) {
        assert!((one.position - other.position).norm() < 1e-12);
    }
    let note = "arcs that would turn back at both ends, taken the other way round";
    assert_eq!(turned.notes[note].lines, [5]);
    assert!(!right.notes.contains_key(note));
    // At one end alone it stays, and so does one whose way out is stated.
    let one_end = program(&path("-1").replace("GOTO/10,20,0", "GOTO/10,-20,0"), &settings()).unwrap();
    assert!(one_end.moves.iter().any(|one| one.position.y > 9e-3) && !one_end.notes.contains_key(note));
    let stated = path("-1").replace("CIRCLE/0,0,0,0,0,-1\n", "MOVARC/0,0,0,0,0,-1,10,ANGLE,270\n");
    let stated = program(&stated, &settings()).unwrap();
    assert!(stated.moves.iter().any(|one| one.position.y > 9e-3) && !stated.notes.contains_key(note));
}

#[test]
fn labels_and_semicolons_keep_their_moves() {
    let text = "UNITS/MM\nFEDRAT/600,MMPM\nA1) GOTO/0,0,0\nRAPID; GOTO/5,0,0\n10) GOTO/9,0,0; GOTO/9,5,0\nPPRINT a; b) c\nFINI\n";
    let read = program(text, &settings()).unwrap();
    let places: Vec<_> =
        read.moves.iter().map(|one| ((one.position.xy() * 1e3).map(f64::round).into(), one.is_rapid)).collect();
    let expected: Vec<([f64; 2], bool)> =
        vec![([0.0, 0.0], true), ([5.0, 0.0], true), ([9.0, 0.0], false), ([9.0, 5.0], false)];
    assert_eq!(places, expected);
    assert_eq!(read.passed_over.keys().collect::<Vec<_>>(), ["PPRINT"]);
}

#[test]
fn drilling_cycles_are_plunges_that_are_not_scored_or_left_out_and_listed() {
    let path = |cycle: &str| {
        format!(
            "UNITS/MM\nFEDRAT/600,MMPM\nGOTO/0,0,5\nGOTO/0,0,0\nGOTO/50,0,0\nRAPID\nGOTO/50,0,30\n{cycle}\nGOTO/20,10,0\n\
             GOTO/30,10,0,0,0.6,0.8\nCYCLE/OFF\nGOHOME/0,0,90\nFINI\n"
        )
    };
    for cycle in [
        "CYCLE/DRILL,RAPTO,3.0,FEDTO,-20.0,RTRCTO,AUTO,MMPM,240.0",
        "CYCLE/DRILL,DEPTH,20,MMPM,240,CLEAR,3,DWELL,2",
        "CYCLE/DRILL,20,MMPM,240,3",
        "CYCLE/DRILL,DEEP,STEP,2,FEDTO,-20,RAPTO,3,MMPM,240",
    ] {
        let read = program(&path(cycle), &settings()).unwrap_or_else(|e| panic!("{cycle}: {e}"));
        let cutting: Vec<&Move> = read.moves.iter().filter(|one| !one.is_rapid).collect();
        assert_eq!(cutting.len(), 4, "{cycle}");
        assert!((cutting[2].position * 1e3 - Vector3::new(20.0, 10.0, -20.0)).norm() < 1e-9, "{cycle}");
        assert!((cutting[3].position * 1e3 - Vector3::new(30.0, 10.0 - 12.0, -16.0)).norm() < 1e-9, "{cycle}");
        assert!((cutting[2].feed.unwrap() - 4e-3).abs() < 1e-12, "{cycle}");
        let (task, imported) = task(&path(cycle), &settings());
        assert_eq!(task.path.segments().len(), 3, "{cycle}");
        assert!(task.path.segments()[1..].iter().flat_map(Clone::clone).all(|point| !task.path.is_scored(point)));
        assert!(imported.notes.iter().any(|note| note.starts_with("holes of drilling cycles")), "{imported}");
        let skip = ReadSettings { skip_cycles: true, ..settings() };
        let (task, imported) = super::task(&path(cycle), &skip);
        assert_eq!(task.path.segments().len(), 1);
        let said = imported.notes.join("\n");
        assert!(
            said.contains("2 holes left out (--skip-cycles): 20, 10, 0 mm (line 9); 30, 10, 0 mm (line 10)"),
            "{said}"
        );
    }
    let above = path("CYCLE/DRILL,FEDTO,5,RAPTO,3");
    let nx = ReadSettings { format: Some(CamFormat::Nx), ..settings() };
    refused(&above, &nx, ":8: CYCLE", &["a cycle whose moves", "-d of NX"]);
    let below = path("CYCLE/DRILL,FEDTO,-5,RAPTO,3");
    let solidworks = ReadSettings { format: Some(CamFormat::Solidworks), ..settings() };
    refused(&below, &solidworks, ":8: CYCLE", &["a cycle whose moves", "d of SolidWorks"]);
    assert!(program(&above, &solidworks).is_ok() && program(&below, &nx).is_ok());
    for cycle in ["CYCLE/DRILL,126,85,1,MMPR", "CYCLE/CSINK,DIAMET,5", "CYCLE/DRILL,DEPTH,5"] {
        refused(&path(cycle), &settings(), ":8: CYCLE", &["a cycle whose moves", "--skip-cycles"]);
    }
    for cycle in ["CYCLE/DRILL,FEDTO,-5,RAPTO,1e300", "CYCLE/DRILL,FEDTO,-nan,RAPTO,3"] {
        refused(&path(cycle), &settings(), ":8: CYCLE", &["not finite numbers of a usual size", "--skip-cycles"]);
    }
}
