//! G codes as data: what each does, and the sentence of each refusal.

use super::super::LengthUnit;
use super::super::refusals::TILTED_OTHERWISE;
use super::motion::Motion;
use Code::{
    Absolute, Control, Cycle, CycleEnd, Dwell, Home, InverseTime, Machine, Mode, Motion as Moves, Nothing, Offset,
    Plane, Refused, ToPlane, Unit,
};

/// What a code does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Code {
    Motion(Motion),
    /// The plane of arcs, by its normal: 0 for x.
    Plane(usize),
    Unit(LengthUnit),
    Dwell,
    /// A move to a reference point of the machine, and the name of the code.
    Home(&'static str),
    /// A move in coordinates of the machine.
    Machine,
    Absolute(bool),
    InverseTime(bool),
    /// Whether tool centre point control is on.
    Control(bool),
    Offset,
    /// A canned cycle at each of the positions that follow.
    Cycle,
    CycleEnd,
    /// Whether the tool goes back to plane R behind a hole, not to the height before the cycle.
    ToPlane(bool),
    Mode(Tilt),
    Nothing,
    /// Refused: what it is, and what to do.
    Refused(&'static str, &'static str),
}

/// Tilted work planes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Tilt {
    Plane,
    /// The tool stands normal to it from here on, turned about its tip or about the axes of the machine.
    Tool {
        is_about_tip: bool,
    },
    End,
}

const SHIFT: Code =
    Refused("a shift of positions by the program", "positions in one work offset, G54 to G59: post without it");
const MACRO: Code = Refused("a macro call", "straight moves and arcs: post without macros");
const COMPENSATION: Code = Refused(
    "cutter compensation: the path is not that of the tool centre",
    "G40: let the CAM system write the path of the tool centre",
);
const TILTED: Code = Refused(TILTED_OTHERWISE.0, TILTED_OTHERWISE.1);

/// Codes by ten times their number.
pub(super) const CODES: &[(i64, Code)] = &[
    (0, Moves(Motion::Rapid)),
    (10, Moves(Motion::Line)),
    (20, Moves(Motion::Clockwise)),
    (30, Moves(Motion::CounterClockwise)),
    (40, Dwell),
    (50, Nothing),
    (51, Refused("a spline, or smoothing of the path by the control", "straight moves and arcs: post without it")),
    (90, Nothing),
    (100, Refused("offsets that the program sets", "one work offset, G54 to G59: post without it")),
    (150, Nothing),
    (160, Refused("polar coordinates", "X, Y and Z: post without polar coordinates")),
    (170, Plane(2)),
    (180, Plane(1)),
    (190, Plane(0)),
    (200, Unit(LengthUnit::Inch)),
    (210, Unit(LengthUnit::Millimetre)),
    (280, Home("G28")),
    (300, Home("G30")),
    (400, Nothing),
    (410, COMPENSATION),
    (411, COMPENSATION),
    (420, COMPENSATION),
    (421, COMPENSATION),
    (430, Nothing),
    (434, Control(true)),
    (490, Control(false)),
    (500, Nothing),
    (510, Refused("a scaling of positions", "positions as they are: post without scaling")),
    (520, SHIFT),
    (530, Machine),
    (531, Mode(Tilt::Tool { is_about_tip: false })),
    (536, Mode(Tilt::Tool { is_about_tip: true })),
    (540, Offset),
    (541, Offset),
    (550, Offset),
    (560, Offset),
    (570, Offset),
    (580, Offset),
    (590, Offset),
    (610, Nothing),
    (611, Nothing),
    (640, Nothing),
    (650, MACRO),
    (660, MACRO),
    (661, MACRO),
    (670, MACRO),
    (680, Refused("a rotation of positions by the program", "positions as they are: post without G68")),
    (682, Mode(Tilt::Plane)),
    (683, TILTED),
    (684, TILTED),
    (690, Mode(Tilt::End)),
    (730, Cycle),
    (740, Cycle),
    (760, Cycle),
    (800, CycleEnd),
    (810, Cycle),
    (820, Cycle),
    (830, Cycle),
    (840, Cycle),
    (850, Cycle),
    (860, Cycle),
    (870, Cycle),
    (880, Cycle),
    (890, Cycle),
    (900, Absolute(true)),
    (910, Absolute(false)),
    (911, Nothing),
    (920, SHIFT),
    (930, InverseTime(true)),
    (940, InverseTime(false)),
    (960, Refused("constant surface speed, of a lathe", "a milling program: G97")),
    (970, Nothing),
    (980, ToPlane(false)),
    (990, ToPlane(true)),
];

/// A program that is something else, by how a line of it begins.
#[derive(Debug)]
pub(crate) struct Foreign {
    pub names: &'static [&'static str],
    pub is: &'static str,
    pub allowed: &'static str,
    /// Whether the whole program is for another control, whatever else is refused in it.
    pub is_control: bool,
}

/// All of them, macros with variables and with O-words last: these are told by more than a name.
pub(super) static FOREIGN: [Foreign; 6] = [
    Foreign {
        names: &["BEGIN PGM", "CYCL DEF", "CYCL CALL", "TOOL CALL", "BLK FORM", "FN ", "LBL ", "CALL LBL"],
        is: "Heidenhain conversational is not read",
        allowed: POST,
        is_control: true,
    },
    Foreign {
        names: &["PLANE ", "CYCLE800"],
        is: "a tilted plane of a Siemens or Heidenhain control is not read",
        allowed: "CLDATA, or G68.2 of a Fanuc control: let the CAM system post one of them",
        is_control: true,
    },
    Foreign {
        names: &["TRAORI"],
        is: "five axes of a Siemens control are not read",
        allowed: "CLDATA, which has the tool axis at every point: let the CAM system post it",
        is_control: true,
    },
    Foreign {
        names: &["IF", "WHILE", "GOTO", "REPEAT", "FOR", "CALL", "DEF ", "PROC ", "MCALL", "CYCLE", "TRANS", "ROT"],
        is: "a macro program (control words) is not read",
        allowed: POST,
        is_control: false,
    },
    Foreign { names: &["O<"], is: "a macro program (O-words) is not read", allowed: POST, is_control: false },
    Foreign { names: &["#"], is: "a macro program (variables) is not read", allowed: POST, is_control: false },
];

const POST: &str = "G-code with numbers alone, or CLDATA: let the CAM system post one of them";

/// What a code does, where it is known.
pub(super) fn code_of(value: f64) -> Option<Code> {
    let tenths = (value * 10.0).round();
    let is_code = (tenths - value * 10.0).abs() < 1e-6 && (0.0..1e4).contains(&tenths);
    let row = CODES.binary_search_by_key(&(tenths as i64), |(code, _)| *code).ok();
    row.filter(|_| is_code).map(|row| CODES[row].1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_code_stands_twice() {
        assert!(CODES.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }
}
