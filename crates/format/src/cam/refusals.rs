//! The sentences of refusals as data: what is wrong, and what is allowed.

/// What is wrong, and what is allowed.
pub(super) type Refusal = (&'static str, &'static str);

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
pub(super) const TOO_MANY: &str = "20000000 points at most: a larger --step-mm";
pub(super) const SCORED: &str = "at least one cutting move at 5.05 deg or more from the tool axis";

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
pub(super) const BEHIND_ARC: &str = "a GOTO behind each arc";
pub(super) const NO_START: Refusal = ("an arc without a start", "a GOTO before the arc");
pub(super) const RAPID_ARC: Refusal = ("RAPID and the end of an arc for the same move", "an arc as a cutting move");
pub(super) const WORDS_OF_ARC: &str = "an arc with words or an angle that are not known here";
pub(super) const NO_WAY_OUT: &str = "an arc without its way out";
pub(super) const NOT_ALONG: &str = "the way out is not along the circle";
pub(super) const SAME_RADIUS: &str = "the same radius within 0.05 mm";
pub(super) const WHOLE_TURNS: &str = "whole turns behind TIMES: let the CAM system write straight moves";
pub(super) const SAME_ANGLE: &str = "the same angle within 1 deg";
pub(super) const IN_PLANE: &str = "an end in the plane of the arc within 0.05 mm";
pub(super) const ANOTHER_CYCLE: &str = "a cycle whose moves are not known here";
pub(super) const CLOSE_CYCLE: &str = "CYCLE/OFF before, behind the last hole";
pub(super) const NUMBERS_OF_POINT: &str = "3 or 6 finite numbers";
pub(super) const NUMBERS_OF_FEED: &str = "one feed above 0 and its unit";
pub(super) const THREE_ASKED: Refusal = (
    "three numbers behind MULTAX/OFF while the tool is tilted: in some systems its axis holds, in others it is 0,0,1",
    "the system that wrote the file: --format catia, nx or solidworks (it holds), autodesk, camplete or creo (0,0,1)",
);

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
