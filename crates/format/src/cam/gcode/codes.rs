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

/// What codes do, by ten times their number.
pub(super) const CODES: &[(Code, &[i64])] = &[
    (Moves(Motion::Rapid), &[0]),
    (Moves(Motion::Line), &[10]),
    (Moves(Motion::Clockwise), &[20]),
    (Moves(Motion::CounterClockwise), &[30]),
    (Dwell, &[40]),
    (Nothing, &[50, 90, 150, 400, 430, 500, 610, 611, 640, 911, 970]),
    (Refused("a spline, or smoothing of the path by the control", "straight moves and arcs: post without it"), &[51]),
    (Refused("offsets that the program sets", "one work offset, G54 to G59: post without it"), &[100]),
    (Refused("polar coordinates", "X, Y and Z: post without polar coordinates"), &[160]),
    (Plane(2), &[170]),
    (Plane(1), &[180]),
    (Plane(0), &[190]),
    (Unit(LengthUnit::Inch), &[200]),
    (Unit(LengthUnit::Millimetre), &[210]),
    (Home("G28"), &[280]),
    (Home("G30"), &[300]),
    (
        Refused(
            "cutter compensation: the path is not that of the tool centre",
            "G40: let the CAM system write the path of the tool centre",
        ),
        &[410, 411, 420, 421],
    ),
    (Control(true), &[434]),
    (Control(false), &[490]),
    (Refused("a scaling of positions", "positions as they are: post without scaling"), &[510]),
    (
        Refused("a shift of positions by the program", "positions in one work offset, G54 to G59: post without it"),
        &[520, 920],
    ),
    (Machine, &[530]),
    (Mode(Tilt::Tool { is_about_tip: false }), &[531]),
    (Mode(Tilt::Tool { is_about_tip: true }), &[536]),
    (Offset, &[540, 541, 550, 560, 570, 580, 590]),
    (Refused("a macro call", "straight moves and arcs: post without macros"), &[650, 660, 661, 670]),
    (Refused("a rotation of positions by the program", "positions as they are: post without G68"), &[680]),
    (Mode(Tilt::Plane), &[682]),
    (Refused(TILTED_OTHERWISE.0, TILTED_OTHERWISE.1), &[683, 684]),
    (Mode(Tilt::End), &[690]),
    (Cycle, &[730, 740, 760, 810, 820, 830, 840, 850, 860, 870, 880, 890]),
    (CycleEnd, &[800]),
    (Absolute(true), &[900]),
    (Absolute(false), &[910]),
    (InverseTime(true), &[930]),
    (InverseTime(false), &[940]),
    (Refused("constant surface speed, of a lathe", "a milling program: G97"), &[960]),
    (ToPlane(false), &[980]),
    (ToPlane(true), &[990]),
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
    let row = CODES.iter().find(|(_, known)| is_code && known.contains(&(tenths as i64)));
    row.map(|(code, _)| *code)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn no_code_stands_twice() {
        let all: Vec<i64> = CODES.iter().flat_map(|(_, known)| *known).copied().collect();
        assert_eq!(BTreeSet::from_iter(&all).len(), all.len());
    }
}
