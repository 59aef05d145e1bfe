//! Dialects of CLDATA as data: the words of each and what they do, and by what a file is told to be of it.
//!
//! Sources: files of NX and SolidWorks CAM; help of PTC Creo (CL Output for Circular Interpolation), of CATIA V5
//! (Syntaxes Interpreted by APT Import); posts of Autodesk (Common APT ISO 4343, Mori APT, CAMplete).

use super::super::LengthUnit;
use Effect::{
    Arc, Axes, Axis, Compensation, Cutter, Cycle, End, Feed, Frame, Mode, Move, NoFrame, Nothing, Offset, Rapid,
    Refused, Section, Spindle, Tangent, Text, Tool, Unit,
};

stead_numerics::worded! {
    /// What a program is written in: G-code, or CLDATA in the dialect of a CAM system.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    pub enum CamFormat {
        /// CLDATA, its dialect told from the file.
        #[default]
        Cldata = "cldata",
        /// That of Siemens NX.
        Nx = "nx",
        /// That of SolidWorks CAM and CAMWorks.
        Solidworks = "solidworks",
        /// That of PTC Creo and Pro/NC.
        Creo = "creo",
        /// That of Dassault CATIA.
        Catia = "catia",
        /// That of the APT posts of Autodesk Fusion, HSM and Inventor CAM.
        Autodesk = "autodesk",
        /// That of the CAMplete post of Autodesk.
        Camplete = "camplete",
        /// Plain APT words of no system that can be told.
        Apt = "apt",
        /// G-code of ISO 6983.
        Gcode = "gcode",
    }
}

/// What a word does: a method of the reader each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Effect {
    Move(Ends),
    /// The next move is a rapid one.
    Rapid,
    Arc(ArcForm),
    /// The way out of an arc.
    Tangent,
    Frame(FrameForm),
    /// An origin that must be 0,0,0.
    NoFrame,
    /// The tool axis.
    Axis,
    /// Whether points have axes.
    Axes,
    Feed,
    Spindle,
    Unit,
    Cutter(CutterForm),
    /// Another tool.
    Tool,
    /// Another path.
    Section,
    Cycle,
    Compensation,
    /// The number of the work offset.
    Offset,
    /// Refused where positions count from the last one.
    Mode,
    /// No effect, and free text behind it.
    Text,
    Nothing,
    /// Refused, and why.
    Refused(&'static str),
    End(Ending),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ends {
    To,
    Start,
    Home,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ending {
    Path,
    Program,
}

/// How an arc is written; the move behind it is its end, but for that of a way out, whose last three numbers are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ArcForm {
    pub ways: &'static [ArcWay],
    pub allowed: &'static str,
}

/// One way to write an arc: its words between commas, how many numbers, and the places of these. The centre is first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ArcWay {
    pub words: &'static str,
    pub count: usize,
    /// 1.0 where the arc is right-handed about the axis behind the centre, -1.0 where it is left-handed; nothing where
    /// the way out tells the axis.
    pub hand: Option<f64>,
    pub radius: Option<usize>,
    /// Whole turns.
    pub turns: Option<usize>,
    /// Angle of the turn in degrees; 0 where it is not stated.
    pub angle: Option<usize>,
}

/// How a frame is written: the places of its numbers, where they are so many.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FrameForm {
    pub counts: &'static [usize],
    pub origin: [usize; 3],
    pub x: [usize; 3],
    pub y: Option<[usize; 3]>,
    pub z: Option<[usize; 3]>,
    pub is_in_comments_below: bool,
    pub allowed: &'static str,
}

/// How a cutter is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CutterForm {
    /// Diameter, corner radius, e, f, two angles, height.
    Apt,
    /// So, where e is the distance of the centre of the corner from the axis.
    AptWithCentre,
    /// A kind, and numbers that follow from it.
    Kind,
    /// Length of the flutes.
    Flutes,
    Diameter,
}

/// What a number of a cycle is, by the word before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OfCycle {
    Depth,
    /// A depth or a coordinate, by the dialect.
    To,
    Clear,
    RapidTo,
    Retract,
    Feed,
    /// A peck, a dwell, or nothing.
    Other,
}

/// What `GOTO` with three numbers means for the tool axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Three {
    /// It holds.
    Holds,
    /// It is z of the frame.
    Upright,
    /// It holds, and is refused where `MULTAX/OFF` leaves the tool tilted, since systems differ there.
    Asked,
}

/// What `FEDTO` of a cycle is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum HoleDepth {
    /// A depth above 0.
    Depth,
    /// A coordinate below 0.
    Coordinate,
    /// Either of them by its sign.
    Either,
}

/// By what a file is told to be of a dialect, whatever blanks and letter case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sign {
    /// A line that begins so.
    Begins(&'static str),
    /// A line that is so.
    Is(&'static str),
    /// A comment with this in it.
    Comment(&'static str),
}

/// A dialect.
#[derive(Debug)]
pub(super) struct Dialect {
    pub format: CamFormat,
    pub told_by: &'static [Sign],
    pub three: Three,
    pub hole_depth: HoleDepth,
    /// Whether positions are turned by the frames of the file; else the first one names what all positions count in.
    pub applies_frames: bool,
    /// Whether points behind the end of an arc that lie on its circle go on along it, and an arc may rise.
    pub arcs_go_on: bool,
    /// What differs from [`COMMON`]; words that begin with `$$` stand in comments.
    pub words: &'static [(&'static str, Effect)],
}

const PLAIN: Dialect = Dialect {
    format: CamFormat::Apt,
    told_by: &[],
    three: Three::Asked,
    hole_depth: HoleDepth::Either,
    applies_frames: true,
    arcs_go_on: false,
    words: &[],
};

/// All of them; a file is of the first that it is told to be of, or of the last.
pub(super) static DIALECTS: &[Dialect] = &[
    Dialect {
        format: CamFormat::Creo,
        told_by: &[Sign::Begins("$$->"), Sign::Comment("PRO/CLFILE")],
        three: Three::Upright,
        applies_frames: false,
        arcs_go_on: true,
        words: &[("$$->CUTTER", Cutter(CutterForm::Diameter)), ("$$->CSYS", Frame(ROWS))],
        ..PLAIN
    },
    Dialect {
        format: CamFormat::Nx,
        told_by: &[Sign::Begins("TOOL PATH/"), Sign::Begins("TLDATA/"), Sign::Begins("MSYS/")],
        three: Three::Holds,
        hole_depth: HoleDepth::Coordinate,
        ..PLAIN
    },
    Dialect {
        format: CamFormat::Camplete,
        told_by: &[Sign::Begins("CSI_TOOL_PATH/"), Sign::Begins("CSI_PROGRAM_COMMENT/"), Sign::Begins("MCS/")],
        three: Three::Upright,
        hole_depth: HoleDepth::Depth,
        words: &[("CIRCLE", Arc(CIRCLE_WITH_ANGLE))],
        ..PLAIN
    },
    Dialect {
        format: CamFormat::Solidworks,
        told_by: &[Sign::Begins("CSI_SET_"), Sign::Begins("INSERT/[HOLDER"), Sign::Is("RAPID/")],
        three: Three::Holds,
        hole_depth: HoleDepth::Depth,
        words: &[("CUTTER", Cutter(CutterForm::AptWithCentre))],
        ..PLAIN
    },
    Dialect {
        format: CamFormat::Catia,
        told_by: &[Sign::Comment("CATIA")],
        three: Three::Holds,
        words: &[("$$*CATIA0", Frame(ROWS_BELOW)), ("CUTTER", Cutter(CutterForm::AptWithCentre))],
        ..PLAIN
    },
    Dialect {
        format: CamFormat::Autodesk,
        told_by: &[
            Sign::Begins("MODE/MILL"),
            Sign::Begins("MODE/TURN"),
            Sign::Begins("MOVARC/"),
            Sign::Begins("MCSYS/"),
            Sign::Begins("APPLY/"),
        ],
        three: Three::Upright,
        ..PLAIN
    },
    PLAIN,
];

/// Centre and axis, right-handed.
const CENTRE_AXIS: ArcWay = ArcWay { words: "", count: 6, hand: Some(1.0), radius: None, turns: None, angle: None };
const CENTRE_AXIS_RADIUS: ArcWay = ArcWay { count: 7, radius: Some(6), ..CENTRE_AXIS };
const ELEVEN: ArcWay = ArcWay { count: 11, hand: Some(-1.0), ..CENTRE_AXIS_RADIUS };
const TURNS: ArcWay = ArcWay { words: "TIMES", count: 12, turns: Some(11), ..ELEVEN };
const ANGLE: ArcWay = ArcWay { words: "ANGLE", count: 8, angle: Some(7), ..CENTRE_AXIS_RADIUS };
const WAY_OUT: ArcWay = ArcWay { words: "GOFWD,CIRCLE,ON,LINE", count: 10, hand: None, radius: Some(3), ..CENTRE_AXIS };

const CIRCLE: ArcForm = ArcForm {
    ways: &[CENTRE_AXIS, CENTRE_AXIS_RADIUS, ELEVEN, TURNS],
    allowed: "6 or 11 finite numbers, or 7 with the radius; behind 11 TIMES and a number of turns up to 1000",
};
const CIRCLE_WITH_ANGLE: ArcForm = ArcForm {
    ways: &[CENTRE_AXIS, CENTRE_AXIS_RADIUS, ArcWay { angle: Some(7), ..ELEVEN }],
    allowed: "6 finite numbers, 7 with the radius, or 11, of which the eighth is the angle of the turn up to 360",
};
const MOVARC: ArcForm = ArcForm {
    ways: &[
        CENTRE_AXIS_RADIUS,
        ArcWay { words: "CENTER,AXIS,RADIUS", ..CENTRE_AXIS_RADIUS },
        ANGLE,
        ArcWay { words: "CENTER,AXIS,RADIUS,ANGLE", ..ANGLE },
    ],
    allowed: "centre, axis, radius, or these behind CENTER, AXIS and RADIUS; ANGLE and degrees up to 360",
};
const TLON: ArcForm = ArcForm {
    ways: &[WAY_OUT, ArcWay { words: "GOFWD,CIRCLE,ON,INTOF,LINE", count: 11, ..WAY_OUT }],
    allowed: "INDIRV/i,j,k, then TLON,GOFWD/(CIRCLE/centre,radius),ON[,2,INTOF],(LINE/centre,end)",
};

const ROWS: FrameForm = FrameForm {
    counts: &[12],
    origin: [3, 7, 11],
    x: [0, 4, 8],
    y: Some([1, 5, 9]),
    z: Some([2, 6, 10]),
    is_in_comments_below: false,
    allowed: "12 numbers: three rows of a rotation and an origin",
};
const ROWS_BELOW: FrameForm = FrameForm {
    is_in_comments_below: true,
    allowed: "three comments below with a row of a rotation and of an origin each",
    ..ROWS
};
const MSYS: FrameForm = FrameForm {
    counts: &[9],
    origin: [0, 1, 2],
    x: [3, 4, 5],
    y: Some([6, 7, 8]),
    z: None,
    is_in_comments_below: false,
    allowed: "9 numbers: origin, x axis, y axis",
};
const MCSYS: FrameForm = FrameForm {
    counts: &[10],
    origin: [1, 2, 3],
    x: [4, 5, 6],
    y: Some([7, 8, 9]),
    allowed: "10 numbers: its own, origin, x axis, y axis",
    ..MSYS
};
const MCS: FrameForm = FrameForm {
    origin: [9, 10, 11],
    x: [0, 1, 2],
    y: Some([3, 4, 5]),
    z: Some([6, 7, 8]),
    allowed: "12 numbers: x, y and z axis, origin",
    ..ROWS
};
const ORIGIN: FrameForm = FrameForm {
    counts: &[3, 9],
    y: None,
    z: Some([6, 7, 8]),
    allowed: "an origin, and x and z axis where they turn",
    ..MSYS
};

/// Cycles that plunge along the tool axis and come back the same way.
pub(super) const CYCLES: [&str; 7] = ["DRILL", "DEEP", "DEEP2", "BRKCHP", "TAP", "BORE", "REAM"];

/// Words of cycles. A number without a word is the depth at first, and the clearance behind a feed.
pub(super) const OF_CYCLES: &[(OfCycle, &[&str])] = &[
    (OfCycle::Depth, &["DEPTH"]),
    (OfCycle::To, &["FEDTO"]),
    (OfCycle::Clear, &["CLEAR"]),
    (OfCycle::RapidTo, &["RAPTO"]),
    (OfCycle::Retract, &["RTRCTO", "RETURN"]),
    (OfCycle::Feed, &["MMPM", "IPM", "PERMIN", "MMPR", "IPR", "PERREV"]),
    (OfCycle::Other, &["DEEP", "BRKCHP", "AUTO", "DWELL", "REV", "STEP", "INCR", "1STPECK", "SUBPECK"]),
];

/// The cycles that are taken, for messages.
pub(super) const CYCLES_TAKEN: &str = "CYCLE/DRILL, DEEP, BRKCHP, TAP, BORE or REAM with DEPTH,d or FEDTO (-d of NX, d of SolidWorks and CAMplete; or as \
                                       d,unit,feed,clearance) and RAPTO,c or CLEAR,c; or --skip-cycles, which leaves all holes out and lists them";

/// Units of feed: millimetres, inches or the unit of the file, a minute or a turn of the spindle.
pub(super) const FEEDS: &[(&str, Option<LengthUnit>, bool)] = &[
    ("MMPM", Some(LengthUnit::Millimetre), false),
    ("IPM", Some(LengthUnit::Inch), false),
    ("PERMIN", None, false),
    ("MMPR", Some(LengthUnit::Millimetre), true),
    ("IPR", Some(LengthUnit::Inch), true),
    ("PERREV", None, true),
];

/// Units of length as `UNITS` states them.
pub(super) const UNITS: [(&str, LengthUnit); 3] =
    [("MM", LengthUnit::Millimetre), ("INCH", LengthUnit::Inch), ("INCHES", LengthUnit::Inch)];

/// Words of every dialect; `*` ends the beginning of a family of them.
pub(super) const COMMON: &[(Effect, &[&str])] = &[
    (Move(Ends::To), &["GOTO"]),
    (Feed, &["FEDRAT"]),
    (Rapid, &["RAPID"]),
    (Arc(CIRCLE), &["CIRCLE"]),
    (Move(Ends::Start), &["FROM"]),
    (Move(Ends::Home), &["GOHOME"]),
    (Arc(MOVARC), &["MOVARC"]),
    (Tangent, &["INDIRV"]),
    (Arc(TLON), &["TLON"]),
    (Frame(MSYS), &["MSYS"]),
    (Frame(ROWS), &["CSYS"]),
    (Frame(MCS), &["MCS"]),
    (Frame(MCSYS), &["MCSYS"]),
    (Frame(ORIGIN), &["ORIGIN"]),
    (NoFrame, &["TRNTYP"]),
    (Axis, &["TLAXIS"]),
    (Axes, &["MULTAX"]),
    (Spindle, &["SPINDL"]),
    (Unit, &["UNIT", "UNITS"]),
    (Cutter(CutterForm::Apt), &["CUTTER"]),
    (Cutter(CutterForm::Kind), &["TLDATA"]),
    (Cutter(CutterForm::Flutes), &["CSI_SET_FLUTE_LENGTH"]),
    (Tool, &["LOADTL", "LOAD", "TOOLNO", "TURRET", "UNLOAD"]),
    (Section, &["TOOL PATH"]),
    (Cycle, &["CYCLE"]),
    (Compensation, &["CUTCOM"]),
    (Offset, &["ZERO"]),
    (Mode, &["MODE", "SET"]),
    (End(Ending::Program), &["FINI"]),
    (End(Ending::Path), &["END-OF-PATH"]),
    (
        Text,
        &["PARTNO", "PPRINT", "INSERT", "REMARK", "TPRINT", "LETTER", "OPNAME", "CSI_TOOL_PATH", "CSI_PROGRAM_COMMENT"],
    ),
    (
        Nothing,
        &[
            "AIR", "APPLY", "ARCSLP", "AUTOPS", "AUXFUN", "BEGIN", "BREAK", "CLAMP", "CLEARP", "CLPRNT", "COOLNT",
            "CSI_*", "DELAY", "DISPLY", "END", "HEADER", "INTOL", "ISN", "LEADER", "LINTOL", "MACHIN", "MATERL",
            "MCHTOL", "NOPOST", "OPSKIP", "OPSTOP", "OUTTOL", "PAINT", "PLABEL", "PPLOT", "PROGRM", "REWIND", "SELCTL",
            "SELECT", "SEQNO", "SETUP", "START", "STOP", "SWITCH", "TCP", "TOLER",
        ],
    ),
    (Refused("a move that counts from the last position"), &["GODLTA"]),
    (Refused("a spline"), &["NURBS", "KNOT", "CNTRL"]),
    (
        Refused("a transformation of what follows"),
        &["TRACUT", "COPY", "TRANS", "TRANSL", "MIRROR", "SCALE", "MATRIX", "REFSYS"],
    ),
    (Refused("a turn of table or head"), &["ROTABL", "ROTATE", "ROTHED"]),
    (
        Refused("a program of its own: macro, subprogram, loop or jump"),
        &["CALSUB", "CALL", "DEFSUB", "SUBRUT", "MACRO", "LOOPST", "IF", "JUMPTO"],
    ),
    (Refused("a repetition of what stands before"), &["INDEX"]),
    (Refused("a retract to where the machine says"), &["RETRCT"]),
    (
        Refused("a motion along geometry that is not in the file"),
        &["GOFWD", "GOLFT", "GORGT", "GOBACK", "GOUP", "GODOWN", "PSIS"],
    ),
    (Refused("polar coordinates"), &["POLAR"]),
    (Refused("an offset of positions"), &["OFSETL", "PIVOTZ"]),
    (Refused("a thread"), &["THREAD"]),
    (Refused("a probing move"), &["PROBE"]),
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn no_word_stands_twice_in_what_a_dialect_reads_and_every_format_has_one_dialect() {
        let is_once = |words: &[&str]| {
            let all: BTreeSet<&str> = words.iter().copied().collect();
            assert_eq!(all.len(), words.len());
            assert!(all.iter().all(|word| *word == word.to_ascii_uppercase()));
        };
        is_once(&COMMON.iter().flat_map(|(_, words)| *words).copied().collect::<Vec<_>>());
        for dialect in DIALECTS {
            is_once(&dialect.words.iter().map(|(word, _)| *word).collect::<Vec<_>>());
            let is_common = |(word, effect): &(&str, Effect)| {
                COMMON.iter().any(|(known, words)| known == effect && words.contains(word))
            };
            assert!(!dialect.words.iter().any(is_common), "a row of COMMON in {:?}", dialect.format);
        }
        let named: Vec<CamFormat> = DIALECTS.iter().map(|dialect| dialect.format).collect();
        for &(word, format) in CamFormat::WORDS {
            let expected = usize::from(![CamFormat::Gcode, CamFormat::Cldata].contains(&format));
            assert_eq!(named.iter().filter(|own| **own == format).count(), expected, "{word}");
        }
    }
}
