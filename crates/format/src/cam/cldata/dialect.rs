//! Dialects of CLDATA as data: the words of each and what they do, and by what a file is told to be of it.
//!
//! Sources: files of NX and SolidWorks CAM; help of PTC Creo (CL Output for Circular Interpolation), of CATIA V5
//! (Syntaxes Interpreted by APT Import); posts of Autodesk (Common APT ISO 4343, Mori APT, CAMplete).

use super::super::CamFormat;
use Effect::{
    Arc, Axes, Axis, Compensation, Cutter, Cycle, End, Feed, Frame, Mode, Move, Nothing, Offset, Rapid, Refused,
    Section, Spindle, Tangent, Text, Tool, Unit,
};

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

/// How an arc is written; the move behind it is its end, but for that of a tangent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ArcForm {
    /// Centre, axis, with 7 and 11 numbers the radius. With 11 numbers left-handed about the axis, else right-handed.
    Circle,
    /// So, and the eighth of 11 numbers is the angle of the turn in degrees.
    CircleWithSweep,
    /// Centre, axis, radius, right-handed, with `ANGLE` the angle of the turn in degrees.
    Swept,
    /// By the way out that stands before: circle and a line from its centre to the end.
    OfTangent,
}

/// How a frame is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FrameForm {
    /// Origin, x axis, y axis.
    OriginXY,
    /// Three rows of a rotation and an origin.
    Rows,
    /// So, in the comments below.
    RowsBelow,
    /// x, y and z axis, origin.
    AxesOrigin,
    /// A number, origin, x axis, y axis.
    NumberOriginXY,
    /// Origin, and x and z axis where they turn.
    OriginXZ,
    /// An origin that must be 0,0,0.
    Zero,
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
        told_by: &[Sign::Begins("$$->"), Sign::Comment("Pro/CLfile")],
        three: Three::Upright,
        applies_frames: false,
        arcs_go_on: true,
        words: &[("$$->CUTTER", Cutter(CutterForm::Diameter)), ("$$->CSYS", Frame(FrameForm::Rows))],
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
        words: &[("CIRCLE", Arc(ArcForm::CircleWithSweep))],
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
        words: &[("$$*CATIA0", Frame(FrameForm::RowsBelow)), ("CUTTER", Cutter(CutterForm::AptWithCentre))],
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

const SPLINE: Effect = Refused("a spline");
const TRANSFORMATION: Effect = Refused("a transformation of what follows");
const TURN: Effect = Refused("a turn of table or head");
const PROGRAM: Effect = Refused("a program of its own: macro, subprogram, loop or jump");
const GEOMETRY: Effect = Refused("a motion along geometry that is not in the file");
const OFFSET: Effect = Refused("an offset of positions");

/// Words of every dialect.
pub(super) const COMMON: &[(&str, Effect)] = &[
    ("GOTO", Move(Ends::To)),
    ("FEDRAT", Feed),
    ("RAPID", Rapid),
    ("CIRCLE", Arc(ArcForm::Circle)),
    ("FROM", Move(Ends::Start)),
    ("GOHOME", Move(Ends::Home)),
    ("MOVARC", Arc(ArcForm::Swept)),
    ("INDIRV", Tangent),
    ("TLON", Arc(ArcForm::OfTangent)),
    ("MSYS", Frame(FrameForm::OriginXY)),
    ("CSYS", Frame(FrameForm::Rows)),
    ("MCS", Frame(FrameForm::AxesOrigin)),
    ("MCSYS", Frame(FrameForm::NumberOriginXY)),
    ("ORIGIN", Frame(FrameForm::OriginXZ)),
    ("TRNTYP", Frame(FrameForm::Zero)),
    ("TLAXIS", Axis),
    ("MULTAX", Axes),
    ("SPINDL", Spindle),
    ("UNIT", Unit),
    ("UNITS", Unit),
    ("CUTTER", Cutter(CutterForm::Apt)),
    ("TLDATA", Cutter(CutterForm::Kind)),
    ("CSI_SET_FLUTE_LENGTH", Cutter(CutterForm::Flutes)),
    ("LOADTL", Tool),
    ("LOAD", Tool),
    ("TOOLNO", Tool),
    ("TURRET", Tool),
    ("UNLOAD", Tool),
    ("TOOL PATH", Section),
    ("CYCLE", Cycle),
    ("CUTCOM", Compensation),
    ("ZERO", Offset),
    ("MODE", Mode),
    ("SET", Mode),
    ("FINI", End(Ending::Program)),
    ("END-OF-PATH", End(Ending::Path)),
    ("PARTNO", Text),
    ("PPRINT", Text),
    ("INSERT", Text),
    ("REMARK", Text),
    ("TPRINT", Text),
    ("LETTER", Text),
    ("OPNAME", Text),
    ("CSI_TOOL_PATH", Text),
    ("CSI_PROGRAM_COMMENT", Text),
    ("AIR", Nothing),
    ("APPLY", Nothing),
    ("ARCSLP", Nothing),
    ("AUTOPS", Nothing),
    ("AUXFUN", Nothing),
    ("BEGIN", Nothing),
    ("BREAK", Nothing),
    ("CLAMP", Nothing),
    ("CLEARP", Nothing),
    ("CLPRNT", Nothing),
    ("COOLNT", Nothing),
    ("CSI_*", Nothing),
    ("DELAY", Nothing),
    ("DISPLY", Nothing),
    ("END", Nothing),
    ("HEADER", Nothing),
    ("INTOL", Nothing),
    ("ISN", Nothing),
    ("LEADER", Nothing),
    ("LINTOL", Nothing),
    ("MACHIN", Nothing),
    ("MATERL", Nothing),
    ("MCHTOL", Nothing),
    ("NOPOST", Nothing),
    ("OPSKIP", Nothing),
    ("OPSTOP", Nothing),
    ("OUTTOL", Nothing),
    ("PAINT", Nothing),
    ("PLABEL", Nothing),
    ("PPLOT", Nothing),
    ("PROGRM", Nothing),
    ("REWIND", Nothing),
    ("SELCTL", Nothing),
    ("SELECT", Nothing),
    ("SEQNO", Nothing),
    ("SETUP", Nothing),
    ("START", Nothing),
    ("STOP", Nothing),
    ("SWITCH", Nothing),
    ("TCP", Nothing),
    ("TOLER", Nothing),
    ("GODLTA", Refused("a move that counts from the last position")),
    ("NURBS", SPLINE),
    ("KNOT", SPLINE),
    ("CNTRL", SPLINE),
    ("TRACUT", TRANSFORMATION),
    ("COPY", TRANSFORMATION),
    ("TRANS", TRANSFORMATION),
    ("TRANSL", TRANSFORMATION),
    ("MIRROR", TRANSFORMATION),
    ("SCALE", TRANSFORMATION),
    ("MATRIX", TRANSFORMATION),
    ("REFSYS", TRANSFORMATION),
    ("ROTABL", TURN),
    ("ROTATE", TURN),
    ("ROTHED", TURN),
    ("CALSUB", PROGRAM),
    ("CALL", PROGRAM),
    ("DEFSUB", PROGRAM),
    ("SUBRUT", PROGRAM),
    ("MACRO", PROGRAM),
    ("LOOPST", PROGRAM),
    ("IF", PROGRAM),
    ("JUMPTO", PROGRAM),
    ("INDEX", Refused("a repetition of what stands before")),
    ("RETRCT", Refused("a retract to where the machine says")),
    ("GOFWD", GEOMETRY),
    ("GOLFT", GEOMETRY),
    ("GORGT", GEOMETRY),
    ("GOBACK", GEOMETRY),
    ("GOUP", GEOMETRY),
    ("GODOWN", GEOMETRY),
    ("PSIS", GEOMETRY),
    ("POLAR", Refused("polar coordinates")),
    ("OFSETL", OFFSET),
    ("PIVOTZ", OFFSET),
    ("THREAD", Refused("a thread")),
    ("PROBE", Refused("a probing move")),
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn no_word_stands_twice_in_what_a_dialect_reads_and_every_format_has_one_dialect() {
        let is_once = |words: &[(&str, Effect)]| {
            let all: BTreeSet<&str> = words.iter().map(|(word, _)| *word).collect();
            assert_eq!(all.len(), words.len());
            assert!(all.iter().all(|word| *word == word.to_ascii_uppercase()));
        };
        is_once(COMMON);
        for dialect in DIALECTS {
            is_once(dialect.words);
            assert!(dialect.words.iter().all(|row| !COMMON.contains(row)), "a row of COMMON in {:?}", dialect.format);
        }
        let named: Vec<CamFormat> = DIALECTS.iter().map(|dialect| dialect.format).collect();
        for (word, format) in CamFormat::WORDS {
            let expected = usize::from(![CamFormat::Gcode, CamFormat::Cldata].contains(&format));
            assert_eq!(named.iter().filter(|own| **own == format).count(), expected, "{word}");
        }
    }
}
