//! What is said, as data: of refusals what is wrong and what is allowed; notes of an import; guesses of a cutter.

/// What is wrong, and what is allowed.
pub(super) type Refusal = (&'static str, &'static str);
/// A refusal with figures of the program in it.
pub(super) type Measured = (String, &'static str);

const STRAIGHT: &str = "GOTO, RAPID, arcs and drilling cycles: let the CAM system write straight moves and arcs";
const ONE_OFFSET: &str = "a second work offset, and how the two lie to each other is not in the file";

// Of both.
pub(super) const NOT_A_FEED: Refusal = ("not a feed", "a feed above 0");
pub(super) const IGNORED_PATH: Refusal =
    ("is of the path itself, and --ignore names it", "words that do not move the tool; codes other than G0 to G3");
pub(super) const NO_AXIS_OF_ARC: Refusal = ("the axis of the arc has no length", "a direction, as 0,0,1");

pub(super) const FEED_TOO_LATE: Refusal =
    ("a cutting move before the first feed", "a feed before the first cutting move, or none in the whole program");
pub(super) const UNUSUAL_FEED: Refusal = ("a cutting move with no usual feed", "a feed from 0.0001 to 100000 mm/s");
/// Of a program with about so many points.
pub(super) fn too_many(points: f64) -> Measured {
    (format!("{points:.0} points within --step-mm"), "20000000 points at most: a larger --step-mm")
}
/// Of a program with so many cutting moves, all along the tool axis.
pub(super) fn none_scored(cutting: usize) -> Measured {
    let problem = format!("{cutting} cutting moves, none of which can be scored");
    (problem, "at least one cutting move at 5.05 deg or more from the tool axis")
}
/// Of an arc with these radii (m) at its start and at its end.
pub(super) fn misses_end(radii: [f64; 2]) -> Measured {
    let [from, to] = radii.map(millimetres);
    let problem = format!("the arc misses its end: radius {from} at its start, {to} there");
    (problem, "the same radius, above 0, within 0.05 mm")
}

fn millimetres(length: f64) -> String {
    format!("{:.4} mm", length * 1e3)
}

// Of CLDATA.
pub(super) const NO_UNIT: Refusal = ("names no unit of length", "MM or INCHES");
pub(super) const NOT_USUAL: &str = "not finite numbers of a usual size";
pub(super) const ANOTHER_ORIGIN: Refusal =
    ("an origin other than 0,0,0", "no origin: let the CAM system write positions in the frame of the part");
pub(super) const COUNTS_ON: Refusal =
    ("positions that count from the last one", "positions from the origin: let the CAM system write them so");
pub(super) const NO_DIRECTION: Refusal = ("the direction has no length", "3 finite numbers: a direction, as 0,0,1");
pub(super) const NO_TOOL_AXIS: Refusal = ("the tool axis has no length", "a direction, as 0,0,1");
pub(super) const NOT_A_FEED_UNIT: Refusal = ("not a unit of feed", "MMPM, IPM, MMPR, IPR, PERMIN or PERREV");
pub(super) const NO_SPEED: Refusal = ("a feed per revolution without a spindle speed", "SPINDL with RPM before");
pub(super) const NO_ROTATION: Refusal =
    ("the axes of the frame are no rotation", "unit vectors at right angles, right-handed");
pub(super) const SECOND_FRAME: Refusal = (
    "a second coordinate system, and the file does not say in which of them its positions are",
    "one coordinate system for the whole file: write a file for each",
);
pub(super) const SECOND_OFFSET: Refusal = (ONE_OFFSET, "one work offset for the whole file");
/// What becomes of the frame of a statement.
pub(super) const FRAME_APPLIED: &str = "positions and tool axes turned into that of the part";
pub(super) const FRAME_NAMED: &str = "positions are taken as those in it, and it as the part's";
pub(super) const NO_CUTTER: Refusal = ("no numbers that can be read", "numbers of the tool");
pub(super) const HALF_AN_ARC: Refusal = ("the file ends before the end of the arc", BEHIND_ARC);
const BEHIND_ARC: &str = "a GOTO behind each arc";
pub(super) const NO_START: Refusal = ("an arc without a start", "a GOTO before the arc");
pub(super) const RAPID_ARC: Refusal = ("RAPID and the end of an arc for the same move", "an arc as a cutting move");
pub(super) const WORDS_OF_ARC: &str = "an arc with words or an angle that are not known here";
pub(super) const NO_WAY_OUT: &str = "an arc without its way out";
pub(super) const NOT_ALONG: &str = "the way out is not along the circle";
pub(super) const ANOTHER_CYCLE: &str = "a cycle whose moves are not known here";
pub(super) const NUMBERS_OF_POINT: &str = "3 or 6 finite numbers";
pub(super) const NUMBERS_OF_FEED: &str = "one feed above 0 and its unit";
pub(super) const THREE_ASKED: Refusal = (
    "three numbers behind MULTAX/OFF while the tool is tilted: in some systems its axis holds, in others it is 0,0,1",
    "the system that wrote the file: --format catia, nx or solidworks (it holds), autodesk, camplete or creo (0,0,1)",
);

/// Of a unit of length that contradicts one that the file or the option has stated.
pub(super) fn another_unit(is_option: bool, stated: &str) -> Measured {
    let by = if is_option { "--units" } else { "the file before" };
    (format!("is not what {by} says: {stated}"), "one unit of length for the whole file")
}

/// Of a word before the end of the arc of a line.
pub(super) fn within_arc(line: usize) -> Measured {
    (format!("stands between the arc of line {line} and its end"), BEHIND_ARC)
}

/// Of what begins while the cycle of a line is open.
pub(super) fn cycle_is_open(line: usize) -> Measured {
    let problem = format!("the cycle of line {line} is still open here: holes may follow, or cuts");
    (problem, "CYCLE/OFF before, behind the last hole")
}

/// Of an arc whose radius as it is found at its start is not the one stated. m
pub(super) fn misses_start(radii: [f64; 2]) -> Measured {
    let [found, stated] = radii.map(millimetres);
    (format!("the arc misses its start: radius {found}, stated {stated}"), "the same radius within 0.05 mm")
}

/// Of a helix whose end is so far (m) from where whole turns lead.
pub(super) fn no_whole_turns(off: f64) -> Measured {
    let problem = format!("a helix whose end is {} beside its start, along the turn", millimetres(off));
    (problem, "whole turns behind TIMES: let the CAM system write straight moves")
}

/// Of an arc that turns by another angle than is stated. rad
pub(super) fn another_angle(turns: [f64; 2]) -> Measured {
    let [turn, stated] = turns.map(f64::to_degrees);
    let problem = format!("the arc turns by {turn:.3} deg to its end, and {stated:.3} are stated");
    (problem, "the same angle within 1 deg")
}

/// Of an arc whose end is so far (m) out of its plane.
pub(super) fn out_of_plane(rise: f64) -> Measured {
    let problem = format!("the arc misses its end, which is {} out of its plane", millimetres(rise));
    (problem, "an end in the plane of the arc within 0.05 mm")
}

/// Of a word that is refused by name.
pub(super) fn not_read(why: &str, word: &str) -> (String, String) {
    (format!("is not read: {why}"), format!("{STRAIGHT}; or --ignore {word}, if it does nothing here"))
}

/// Of a word that nobody knows.
pub(super) fn not_known(count: usize, word: &str) -> (String, String) {
    (
        format!("is not known, and its {count} numbers may move the tool, or what its positions count from"),
        format!("--ignore {word}, if it does nothing of that; else let the CAM system write straight moves and arcs"),
    )
}

// Of G-code.
pub(super) const NOT_A_WORD: Refusal =
    ("not a letter with a number", "G-code words, as X-1.5, and comments in ( ) or behind ;");
pub(super) const NOT_A_CODE: Refusal = (
    "a code that is not known here",
    "G0-G4, G17-G19, G20, G21, G28, G30, G40, G43, G43.4, G49, G53, G53.1, G54-G59, G61, G64, G68.2, G69, G80, G90, \
     G91, G93, G94, G97-G99",
);
pub(super) const TWO_WAYS: Refusal = ("two ways to move in one block", "one of G0, G1, G2, G3");
pub(super) const OTHER_UNIT: Refusal =
    ("contradicts the unit before", "one unit of length for the whole program, and what --units says");
pub(super) const NO_NUMBER: Refusal = ("G54.1 without the number of its offset", "G54.1 with P");
pub(super) const SECOND_G54: Refusal = (ONE_OFFSET, "one of G54 to G59, or one G54 P, for the whole program");
pub(super) const CANNED_CYCLE: Refusal = (
    "a canned cycle",
    "--skip-cycles, which leaves all holes out and lists them, or straight moves: post without canned cycles",
);
pub(super) const TWICE: Refusal = ("is there twice in a block", "each letter once");
pub(super) const SUBPROGRAM: Refusal =
    ("a subprogram, whose cuts would be missing", "one program with all cuts in it: post it without subprograms");
pub(super) const TILTED_OTHERWISE: Refusal = (
    "a tilted work plane of another form",
    "G68.2 X Y Z I J K, Euler angles about z, x and z: let the CAM system post it so, or CLDATA",
);
pub(super) const FAR_FRAME: Refusal =
    ("not a frame of a usual size", "a frame up to 100 m away, and angles up to 36000 deg");
pub(super) const NO_UNIT_BEFORE: Refusal =
    ("a position before its unit of length is stated", "G20 or G21 before, or --units mm or inch");
pub(super) const NO_MOTION: Refusal = ("a position before any of G0 to G3", "G0, G1, G2 or G3 before");
pub(super) const ARC_AT_CHANGE: Refusal = ("an arc right after a tool change", "G0 to its start before");
pub(super) const CENTRE_OF_NONE: Refusal = ("a centre or radius without an arc", "I, J, K and R with G2 and G3");
pub(super) const FAR_PLACE: Refusal = ("not a position of a usual size", "up to 100 m");
pub(super) const TURNING_ARC: Refusal = ("an arc that turns the tool", "arcs at a constant tool axis");
pub(super) const TILTED_ARC: Refusal =
    ("an arc with a tilted tool, whose plane is that of the machine", "straight moves there");
pub(super) const SEVERAL_TURNS: Refusal = ("an arc of several turns", "one turn or less in a block");
pub(super) const RADIUS_AND_CENTRE: Refusal = ("a radius and a centre", "R, or I, J and K");
pub(super) const NO_CENTRE: Refusal = ("an arc without a centre or radius", "I, J, K or R");
pub(super) const OUT_OF_PLANE: Refusal = (
    "a centre out of the plane of the arc, or the lead of a helix",
    "I and J with G17, I and K with G18, J and K with G19; a helix by its end alone",
);
pub(super) const CIRCLE_BY_RADIUS: Refusal = ("a full circle by its radius", "I, J, K for a full circle");
pub(super) const SMALL_RADIUS: Refusal = ("a radius that is less than half the way to the end", "a larger radius");
pub(super) const NO_FEED: Refusal = ("a cutting move before the first feed", "F before or with it");
pub(super) const NO_INVERSE_TIME: Refusal = ("G93 without a feed in the block", "F with each move under G93");
pub(super) const UNCONTROLLED: Refusal = (
    "a rotary axis without tool centre point control",
    "G43.4 before, --tcp where it is on all the same, or --pivot-mm X,Y,Z of the machine",
);
pub(super) const FROM_NOWHERE: Refusal = ("G91 from where the tool is not known", "a position with G90 before");
pub(super) const FAR_ANGLE: Refusal = ("not an angle of a usual size", "up to 36000 deg");
pub(super) const AXIS_IN_PLANE: Refusal = (
    "a rotary axis within a tilted work plane",
    "G53.1, which turns the tool normal to the plane, or angles without G68.2: post one of them",
);
pub(super) const NO_MACHINE: Refusal =
    ("a rotary axis of a machine that is not named", "--machine table-ac, table-bc, head-ac or head-bc");

/// Of a rotary axis that the machine of this name has not.
pub(super) fn not_of_machine(name: &str) -> Measured {
    (format!("not a rotary axis of {name}"), "another --machine")
}

// Notes and guesses.
pub(super) const TURNED: &str =
    "rapid moves of a turned tool without tool centre point control: where it is then is not known here";
/// Of moves and points, behind how many they are.
pub(super) const COUNTED: [&str; 5] = [
    "moves end where they start: left out",
    "points left out, for which straight lines stand within the chord error",
    "points added, on lines longer than the step or turns of the tool axis by more than 5 deg",
    "points of plunges along the tool axis, where there is no wall: followed, not scored",
    "points of turns of the tool in place, where there is no wall: followed, not scored",
];
pub(super) const NOT_THE_SHAPE: &str = "to be stated: the shape of this cutter is not that of a run file";
/// Rows of `[tool]` that no program states, whose values are guesses, with a comment.
pub const GUESSES: [(&str, &str); 7] = [
    ("teeth = 2", ""),
    ("helix_deg = 30.0", ""),
    ("kt_mpa = 800.0", "cutting coefficients of an aluminium alloy; or `material` beside [stock]"),
    ("kr = 0.4", ""),
    ("ka_mpa = 100.0", ""),
    ("kte_n_per_mm = 20.0", "edge forces"),
    ("kre_n_per_mm = 20.0", ""),
];
/// The keys of the rows of `[tool]` that no program states, by which a file names them as guesses.
pub fn guessed_keys() -> impl Iterator<Item = String> {
    GUESSES.iter().map(|(row, _)| format!("tool.{}", row.split(" =").next().unwrap_or_default()))
}
/// Keys in place of the stock, as comments.
pub(super) const ONE_ENGAGEMENT: [(&str, &str); 3] = [
    ("milling = \"climb\"", "in place of [stock], one engagement for the whole path: these keys"),
    ("radial_depth_mm = 2.0", ""),
    ("axial_depth_mm = 2.0", ""),
];
