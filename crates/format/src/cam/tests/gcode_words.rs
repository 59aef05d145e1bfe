//! Every code of G-code, and every way to get it wrong.

use super::*;
use std::f64::consts::FRAC_PI_2;

/// Three axes: both ways to state arcs, three planes, incremental and absolute.
pub const THREE_AXES: &str = include_str!("../fixtures/three_axes.nc");

/// Five axes with tool centre point control and inverse time.
pub const FIVE_AXES: &str = include_str!("../fixtures/five_axes.nc");

fn line(text: &str) -> String {
    format!("G21 G90\nG0 X0 Y0 Z0\nG1 X1 F600\n{text}\nG1 X50\nM30\n")
}

#[test]
fn three_axes() {
    let read = program(THREE_AXES, &settings()).unwrap();
    let ends = |line: usize| read.moves.iter().rfind(|one| one.line == line).unwrap();
    let near = |line: usize, mm: [f64; 3]| {
        assert!((ends(line).position * 1e3 - Vector3::from(mm)).norm() < 1e-9, "{line}: {}", ends(line).position);
    };
    near(16, [30.0, 10.0, -1.0]);
    near(17, [40.0, 20.0, -1.0]);
    near(18, [45.0, 20.0, -1.0]);
    near(20, [55.0, 20.0, -1.0]);
    // G3 about (20, 10), G2 about (40, 10), and in the plane of x and z the lower half about (50, 20, -1).
    let on = |line: usize, centre: [f64; 3], radius: f64| {
        let own: Vec<&Move> = read.moves.iter().filter(|one| one.line == line).collect();
        assert!(own.len() > 3);
        own.iter().all(|one| ((one.position * 1e3 - Vector3::from(centre)).norm() - radius).abs() < 1e-9)
    };
    assert!(on(16, [20.0, 10.0, -1.0], 10.0) && on(17, [40.0, 10.0, -1.0], 10.0) && on(20, [50.0, 20.0, -1.0], 5.0));
    assert!(read.moves.iter().any(|one| one.line == 20 && one.position.z < -5.9e-3));
    assert_eq!(ends(14).feed, Some(5e-3));
    assert_eq!(ends(15).feed, Some(0.02));
    assert!(ends(13).is_rapid && ends(23).is_rapid);
    assert_eq!(read.tools, ["T1"]);
}

#[test]
fn five_axes_with_and_without_tool_centre_point_control() {
    let machine = |machine| ReadSettings { machine: Some(machine), ..settings() };
    let read = program(FIVE_AXES, &machine(Machine::TableAc)).unwrap();
    let turned: Vec<&Move> = read.moves.iter().filter(|one| one.line == 7).collect();
    assert_eq!(turned.len(), 15, "30 deg in steps of 2");
    let [a, c] = [20.0_f64, 30.0].map(f64::to_radians);
    let axis = Vector3::new(libm::sin(c) * libm::sin(a), -libm::cos(c) * libm::sin(a), libm::cos(a));
    assert!((turned[14].axis - axis).norm() < 1e-12 && (turned[14].position.x - 0.04).abs() < 1e-12);
    // Inverse time: 20 mm, 30 times a minute.
    let inverse = read.moves.iter().rfind(|one| one.line == 8).unwrap();
    assert!((inverse.feed.unwrap() - 0.02 * 30.0 / 60.0).abs() < 1e-12);
    let text = "G21 G90\nG0 X2 Y0 Z5 B0 C0\nG1 C90 F600\nX3\nM30\n";
    let pivot = Some(Vector3::new(1e-3, 0.0, 0.0));
    let read = program(text, &ReadSettings { pivot, ..machine(Machine::TableBc) }).unwrap();
    let end = read.moves.iter().rfind(|one| one.line == 3).unwrap();
    assert!((end.position * 1e3 - Vector3::new(1.0, 1.0, 5.0)).norm() < 1e-9);
    let head = text.replace("C90", "B90");
    let read = program(&head, &ReadSettings { pivot: Some(Vector3::z() * 0.3), ..machine(Machine::HeadBc) }).unwrap();
    let end = read.moves.iter().rfind(|one| one.line == 3).unwrap();
    assert!((end.axis - Vector3::x()).norm() < 1e-12);
    assert!((end.position - Vector3::new(2e-3 - 0.3, 0.0, 5e-3 + 0.3)).norm() < 1e-12);
    let controlled = ReadSettings { tool_centre_point: true, ..machine(Machine::HeadBc) };
    let read = program(&head, &controlled).unwrap();
    assert!((read.moves.iter().rfind(|one| one.line == 3).unwrap().position.x - 2e-3).abs() < 1e-12);
    let quarter = Machine::TableAc.workpiece_from_tool([FRAC_PI_2, 0.0, 0.0]);
    assert!((quarter * Vector3::z() + Vector3::y()).norm() < 1e-12);
}

#[test]
fn rotary_axes_may_be_set_by_rapids_before_tool_centre_point_control() {
    let machine = ReadSettings { machine: Some(Machine::TableAc), ..settings() };
    let text = "G21 G90\nG0 X0 Y0 Z0 A-20 C90\nG43.4 H1\nG0 X5 Y0 Z9\nG1 Z0 F600\nX20\nG49\nG0 Z90\nG0 A0 C0\nG0 X1 Y1 Z1\nG1 X9\nM30\n";
    let read = program(text, &machine).unwrap();
    let lines: Vec<(usize, bool)> = read.moves.iter().map(|one| (one.line, one.is_rapid)).collect();
    assert_eq!(lines, [(4, true), (5, false), (6, false), (10, true), (11, false)]);
    assert!(
        (read.moves[0].axis - Vector3::new(libm::sin((-20.0_f64).to_radians()), 0.0, read.moves[0].axis.z)).norm()
            < 1e-9
    );
    assert!(read.notes.keys().any(|note| note.contains("where it is then is not known")), "{:?}", read.notes);
    assert!(read.notes.contains_key("angles of table-ac, with tool centre point control"), "{:?}", read.notes);
    // A cut with the tool turned and the control off is refused, with or without the angle in the block.
    refused(&text.replace("G0 Z90\n", "G1 Z90\n"), &machine, ":8: Z", &["without tool centre point control"]);
    refused(&text.replace("G43.4", "G43"), &machine, ":5: Z", &["without tool centre point control", "--pivot-mm"]);
}

#[test]
fn each_broken_block_names_line_word_value_and_what_is_allowed() {
    for (text, word, parts) in [
        ("G2 X10 Y10 I5 J1", "I", ["misses its end", "same radius"]),
        ("G2 X11 R1", "R", ["less than half the way", "a larger radius"]),
        ("G2 X1 R1", "R", ["full circle by its radius", "I, J, K"]),
        ("G2 X10", "X", ["without a centre or radius", "I, J, K or R"]),
        ("G2 X11 I5 R5", "R", ["a radius and a centre", "R, or I"]),
        ("G2 X11 I5 K2", "K", ["out of the plane", "'K2'"]),
        ("G18 G3 X11 J2 K5", "J", ["out of the plane", "I and K with G18"]),
        ("G3 X11 I5 P3", "P", ["several turns", "one turn"]),
        ("G1 X11 I5", "I", ["without an arc", "G2 and G3"]),
        ("G0 G1 X11", "G", ["two ways to move", "one of G0"]),
        ("G1 X11 X12", "X", ["twice in a block", "'X12'"]),
        ("G20", "G", ["contradicts the unit", "'G20'"]),
        ("G54 G1 X5\nG55", "G", ["second work offset", "one of G54 to G59"]),
        ("G1 X1e", "", ["not a letter with a number", "X-1.5"]),
        ("G1 Xnan", "", ["not a letter with a number", "'Xnan'"]),
        ("G1 X1e9", "E", ["a letter that is not known", "'E9'"]),
        ("G1 X99999999", "X", ["usual size", "100 m"]),
        ("G1 F0 X5", "F", ["not a feed", "above 0"]),
        ("G93 G1 X5", "X", ["G93 without a feed", "F with each"]),
        ("G83 X5 R2 Z-9", "G", ["a canned cycle", "'G83'"]),
        ("G41 D1", "G", ["cutter compensation", "'G41'"]),
        ("G81 X5 Z-3 R2", "G", ["a canned cycle", "--skip-cycles"]),
        ("G65 P9000", "G", ["a macro call", "'G65'"]),
        ("M98 P100", "M", ["a subprogram", "'M98'"]),
        ("M97 P100", "M", ["a subprogram", "without subprograms"]),
        ("M99", "M", ["a subprogram", "'M99'"]),
        ("G54 P1\nG54 P2", "G", ["second work offset", "one G54 P"]),
        ("G54.1", "G", ["without the number", "G54.1 with P"]),
        ("G52 X10 Y0", "G", ["a shift of positions", "'G52'"]),
        ("G92 X0", "G", ["a shift of positions", "'G92'"]),
        ("G10 L2 P1 X5", "G", ["offsets that the program sets", "'G10'"]),
        ("G51 X0 P2", "G", ["a scaling", "'G51'"]),
        ("G68 X0 Y0 R30", "G", ["a rotation", "'G68'"]),
        ("G5.1 Q1", "G", ["smoothing", "'G5.1'"]),
        ("G16", "G", ["polar", "'G16'"]),
        ("G68.2 P1 X0 Y0 Z0 I0 J0 K0", "P", ["of another form", "Euler angles"]),
        ("G68.3 X0 Y0 Z0 R1", "G", ["of another form", "'G68.3'"]),
        ("G68.2 X0 Y0 Z0 I0 J1e9 K0", "E", ["a letter", "'E9'"]),
        ("G1 X5 A3", "A", ["machine that is not named", "--machine table-ac"]),
        ("G1 X5 (open", "", ["not a letter", "( )"]),
    ] {
        let at = if text.contains('\n') { 5 } else { 4 };
        let place = if word.is_empty() { format!(":{at}") } else { format!(":{at}: {word}") };
        refused(&line(text), &settings(), &place, &parts);
    }
    refused("G90 G0 X1 Y1 Z1\n", &settings(), ":1: X", &["before its unit of length", "--units mm"]);
    refused("G21\nX1 Y1\n", &settings(), ":2: X", &["before any of G0 to G3"]);
    refused("G21 G0 X0 Y0 Z0\nG1 X5\n", &settings(), ":2: X", &["before the first feed"]);
    refused("G21 G91\nG0 X5\n", &settings(), ":2: X", &["G91 from where the tool is not known"]);
    let machine = ReadSettings { machine: Some(Machine::TableAc), ..settings() };
    refused(&line("G1 A5"), &machine, ":4: A", &["without tool centre point control", "--tcp", "--pivot-mm"]);
    refused(&line("G1 B5"), &machine, ":4: B", &["not a rotary axis of table-ac"]);
}

#[test]
fn other_languages_are_refused_by_name() {
    for (text, name) in [
        ("0 BEGIN PGM PART MM\n1 L X+5 R0 FMAX\n", "Heidenhain conversational"),
        ("%\nO1\n#100=5\n", "a macro program (variables)"),
        ("G21\nWHILE [#1 LT 5] DO1\n", "a macro program"),
        ("G21\no<part> sub\n", "a macro program (O-words)"),
        ("G90 G17 G71\nCYCLE800(1,\"A\",0,57,0,0,0,30)\n", "2: a tilted plane of a Siemens or Heidenhain control"),
        ("G90 G17 G71\nN7 TRAORI\nG1 X0 A3=0 B3=0 C3=1\n", "2: five axes of a Siemens control"),
        ("0 BEGIN PGM A MM\n5 PLANE SPATIAL SPA+0 SPB+30 SPC+0 STAY\n", "1: Heidenhain conversational"),
    ] {
        let message = import_bytes(Path::new("f"), text.as_bytes(), &settings()).map(drop).unwrap_err().to_string();
        assert!(message.contains(name) && message.contains(" not read") && message.contains("CLDATA"), "{message}");
    }
}

#[test]
fn tool_changes_end_segments_block_delete_is_said_and_holes_are_left_out() {
    let text = "G21 G90 G94\nT1 M6\nG0 X0 Y0 Z5\nG1 Z0 F600\nG1 X50\n/G1 Y20\nT2 M6\nG1 X0\nG1 Y40\nG0 Z9\n\
                G83 X10 Y10 Z-5 R2 Q1 F100\nX20\nG80\nG0 X0 Y0 Z9\nM30\n";
    refused(text, &settings(), ":11: G", &["a canned cycle", "'G83'"]);
    let (read, path) = task(text, &ReadSettings { skip_cycles: true, ..settings() });
    assert_eq!(read.path.segments().len(), 2);
    let said = path.notes.join("\n");
    for part in [
        "block delete",
        "first moves of a tool",
        "2 holes left out (--skip-cycles): 10, 10, 2 mm (line 11); 20, 10, 2 mm (line 12)",
    ] {
        assert!(said.contains(part), "{part} in {said}");
    }
}

/// The moves of lines as their ends in mm, with whether they are rapid.
fn ends(text: &str, settings: &ReadSettings) -> Vec<(usize, [f64; 3], bool)> {
    let read = program(text, settings).unwrap_or_else(|e| panic!("{e}"));
    let place = |one: &Move| (one.position * 1e3).map(|value| (value * 1e6).round() / 1e6).into();
    read.moves.iter().map(|one| (one.line, place(one), one.is_rapid)).collect()
}

#[test]
fn moves_home_take_away_the_axes_that_they_name_and_what_is_not_known_is_counted() {
    let start = "G21 G90\nG0 X0 Y0 Z5\nG1 Z-1 F300\nX40\n";
    // G53 without axes moves nothing; of z it leaves x and y, and so does G28.
    let plain = ends(&format!("{start}G53\nG0 X50\nM30\n"), &settings());
    assert_eq!(plain.last().unwrap(), &(6, [50.0, 0.0, -1.0], true));
    for home in ["G53 G0 Z0", "G28 G91 Z0\nG90", "G30 Z0"] {
        let text = format!("{start}{home}\nG0 X50\nZ-1\nG1 X60\nM30\n");
        let read = ends(&text, &settings());
        assert_eq!(read.last().unwrap().1, [60.0, 0.0, -1.0], "{home}");
        assert!(
            !read.last().unwrap().2
                && !program(&text, &settings()).unwrap().notes.keys().any(|note| note.contains("not known"))
        );
    }
    // A feed move from there is no cut, and neither is an arc.
    for (text, count, why) in [
        ("G28 Z0\nG1 X50\nZ-1\nX60", 2, "Z not known since G28, line 5"),
        ("G28\nG1 X50 Y0 Z0\nX60", 1, "X, Y, Z not known since G28, line 5"),
        ("G53 G0 Z0\nG2 X50 I5 F300\nG1 Z-1\nX60", 2, "Z not known since G53, line 5"),
    ] {
        let text = format!("{start}{text}\nM30\n");
        let read = program(&text, &settings()).unwrap();
        let start = format!("moves at feed that are not scored, from or to where the tool is not known: {why}");
        let found = read.notes.iter().find(|(note, _)| **note == start);
        assert!(found.is_some_and(|(_, found)| found.times == count), "{text} {:?}", read.notes);
        assert!(!read.moves.last().unwrap().is_rapid);
    }
}

#[test]
fn behind_holes_that_are_left_out_the_tool_is_over_the_last_one() {
    let skip = ReadSettings { skip_cycles: true, ..settings() };
    let path = |cycle: &str| format!("G21 G90\nG0 X0 Y0 Z10\n{cycle}\nG80\nG1 X40 F600\nG0 Z20\nM30\n");
    for (cycle, place) in [
        ("G99 G81 X10 Y10 Z-8 R2 F120\nX30", [30.0, 10.0, 2.0]),
        ("G98 G81 X10 Y10 Z-8 R2 F120\nX30", [30.0, 10.0, 10.0]),
        ("G81 X10 Y10 Z-8 R2 F120\nX30", [30.0, 10.0, 10.0]),
        ("G99 G83 X10 Y10 Z-8 R2 Q3 F120\nG98 X30", [30.0, 10.0, 10.0]),
        ("G91 G99 G81 X10 Y10 Z-10 R-8 L3 F120\nG90", [30.0, 30.0, 2.0]),
        ("G91 G98 G81 X10 Y0 Z-10 R-8 K4 F120\nG90", [40.0, 0.0, 10.0]),
    ] {
        let read = ends(&path(cycle), &skip);
        let cut = read.iter().position(|one| !one.2).unwrap();
        assert_eq!(read[cut - 1].1, place, "{cycle}");
        assert_eq!(read[cut].1[1..], place[1..], "{cycle}");
    }
}

#[test]
fn tilted_planes_turn_positions_arcs_and_from_g53_1_on_the_tool() {
    let (sine, cosine) = libm::sincos(30.0_f64.to_radians());
    let text = "G21 G90\nG0 X0 Y0 Z50\nG68.2 X10 Y0 Z20 I0 J30 K0\nG53.1\nG0 X0 Y0\nZ15\nG1 Z-2 F500\nX46\n\
                G3 X56 Y10 I0 J10\nG0 Z15\nG69\nG0 X0 Y0 Z90\nG1 X10\nM30\n";
    let read = program(text, &settings()).unwrap();
    let last = |line: usize| read.moves.iter().rfind(|one| one.line == line).unwrap();
    let (x, z) = (0.056, -0.002);
    let expected = Vector3::new(0.01 + x, 0.01 * cosine - z * sine, 0.02 + 0.01 * sine + z * cosine);
    assert!((last(9).position - expected).norm() < 1e-12);
    assert!((last(9).axis - Vector3::new(0.0, -sine, cosine)).norm() < 1e-12 && last(9).is_fixed);
    // All points of the arc are in the plane.
    let normal = Vector3::new(0.0, -sine, cosine);
    let heights = read.moves.iter().filter(|one| one.line == 9).map(|one| (one.position - expected).dot(&normal));
    assert!(heights.fold(0.0, |worst: f64, height| worst.max(height.abs())) < 1e-12);
    assert!((last(13).axis - Vector3::z()).norm() < 1e-12 && (last(13).position.z - 0.09).abs() < 1e-12);
    // Without G53.1 the tool stands as before; Euler angles are about z, x and z.
    let upright = program(&text.replace("G53.1\n", "\n"), &settings()).unwrap();
    assert!(upright.moves.iter().all(|one| (one.axis - Vector3::z()).norm() < 1e-12));
    let turned = text.replace("I0 J30 K0", "I90 J90 K90").replace("G3 X56 Y10 I0 J10\n", "\n");
    let turned = program(&turned, &settings()).unwrap();
    // Rz(90) Rx(90) Rz(90): x of the plane is z of the part, y is -y, z is x.
    let end = turned.moves.iter().rfind(|one| one.line == 8).unwrap();
    assert!((end.position - Vector3::new(0.01 - 0.002, 0.0, 0.02 + 0.046)).norm() < 1e-12, "{}", end.position);
    assert!((end.axis - Vector3::x()).norm() < 1e-12);
    // A rotary axis in it means two things.
    let machine = ReadSettings { machine: Some(Machine::TableAc), ..settings() };
    refused(&text.replace("G0 X0 Y0\nZ15", "G0 X0 Y0 A30\nZ15"), &machine, ":5: A", &["within a tilted", "G53.1"]);
}

#[test]
fn blocks_with_a_code_are_passed_over_as_asked() {
    let ignoring =
        |codes: &[&str]| ReadSettings { ignore: codes.iter().map(|&c| c.to_owned()).collect(), ..settings() };
    let text = line("G52 X0 Y0 Z0");
    let (_, path) = task(&text, &ignoring(&["G52"]));
    assert!(path.to_string().contains("blocks with G52 passed over, as asked (--ignore) (line 4)"), "{path}");
    for (word, at) in [("G1", ":3: G"), ("G00", ":2: G")] {
        refused(&text, &ignoring(&[word]), at, &["of the path itself", "codes other than G0 to G3"]);
    }
    for word in ["QUILLX", "G", ""] {
        refused(&text, &ignoring(&[word]), ":4: G", &["a shift of positions"]);
    }
}

/// Cuts of 30 mm at z = -2 on both sides of a link at a height.
fn linked(height: f64, comment: &str, rapid: f64) -> String {
    format!(
        "{comment}\nG21 G90\nG0 X0 Y0\nZ{rapid}\nG1 Z5 F900\nZ-2\nX30\nZ{height}\nX60 Y40\nX70\nZ-2\nX90\nZ5\nG0 Z{rapid}\nM30\n"
    )
}

#[test]
fn links_at_feed_are_level_and_as_high_as_rapid_moves_end() {
    let personal = "(WHEN USING FUSION FOR PERSONAL USE, THE FEEDRATE OF RAPID)\n(MOVES IS REDUCED)";
    let broken = "(When using Fusion 360 for Personal Use, the feedrate of)\n(rapid moves is reduced)";
    for (height, comment, has_link) in [
        (15.0, "", true),
        (16.0, "", true),
        (5.0, "", false),
        (5.0, personal, true),
        (5.0, broken, true),
        (4.0, personal, false),
        (15.0, personal, true),
    ] {
        let text = linked(height, comment, 15.0);
        let (read, path) = task(&text, &settings());
        assert_eq!(read.path.segments().len(), if has_link { 2 } else { 1 }, "{height} {comment}");
        assert_eq!(path.to_string().contains("links at feed, taken as rapid moves: 60 mm"), has_link, "{path}");
        let (kept, path) = task(&text, &ReadSettings { keep_links: true, ..settings() });
        assert!(kept.path.segments().len() == 1 && !path.to_string().contains("links at feed"));
    }
    // Neither out nor in along the axis: a cut at the height of rapid moves.
    let side = "G21 G90\nG0 X-20 Y0 Z0\nG1 X100 F900\nY30\nX-20\nZ-3\nX10\nG0 Z0\nM30\n";
    assert!(!task(side, &settings()).1.to_string().contains("links at feed"));
    // CLDATA has the same rule, along a tilted axis too.
    let tilted = "UNITS/MM\nFEDRAT/600,MMPM\nRAPID\nGOTO/0,0,0,0.6,0,0.8\nRAPID\nGOTO/12,0,16\nGOTO/0,0,0\nGOTO/0,20,0\nGOTO/12,20,16\n\
                  GOTO/12,60,16\nGOTO/0,60,0\nGOTO/0,90,0\nRAPID\nGOTO/12,90,16\nFINI\n";
    let (read, path) = task(tilted, &settings());
    assert!(read.path.segments().len() == 2 && path.to_string().contains("rapid moves: 40 mm"), "{path}");
}
