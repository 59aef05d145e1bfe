//! The modal state of G-code, block by block.

mod position;
mod tools;

use super::super::tool::ProgramTool;
use super::super::{LARGEST, LengthUnit, Move, Program, ReadSettings};
use super::arc::arc_of;
use super::block::{Block, Motion, Word, failed};
use super::state::State;
use nalgebra::{Matrix3, Vector3};
use std::path::Path;
use stead_disk::input::InputError;

/// No rotary axis is programmed beyond this. deg
const LARGEST_ANGLE: f64 = 3.6e4;

/// Canned cycles for holes.
const CYCLES: [i64; 12] = [73, 74, 76, 81, 82, 83, 84, 85, 86, 87, 88, 89];

/// The letters that a block may have.
const LETTERS: &str = "GXYZABCIJKRFSTMNOHDP";

/// What holds until another code of its group.
pub(super) struct Modes {
    pub motion: Option<Motion>,
    /// Normal of the plane of arcs: 0 for x (G19), 1 for y (G18), 2 for z (G17).
    pub plane: usize,
    unit: Option<LengthUnit>,
    pub is_incremental: bool,
    is_inverse_time: bool,
    is_controlled: bool,
    /// Work offset, with its number of an extended set.
    offset: Option<(u32, Option<u32>)>,
}

/// Reads blocks into moves.
pub(super) struct Reader<'a> {
    file: &'a Path,
    pub settings: &'a ReadSettings,
    program: Program,
    pub modes: Modes,
    pub state: State,
    /// As programmed, without its unit.
    feed: Option<f64>,
    is_after_change: bool,
    /// Tools that comments describe, their lengths in the unit of the program.
    pub described: Vec<ProgramTool>,
    /// The tool that is called, in the spindle from the next change on.
    called: Option<u32>,
    /// Whether the tool was turned without and with tool centre point control.
    has_turned: [bool; 2],
}

impl<'a> Reader<'a> {
    pub fn new(file: &'a Path, settings: &'a ReadSettings) -> Self {
        let modes = Modes {
            motion: None,
            plane: 2,
            unit: settings.units,
            is_incremental: false,
            is_inverse_time: false,
            is_controlled: settings.tool_centre_point,
            offset: None,
        };
        let state = State { position: [None; 3], angles: [0.0; 3] };
        Self {
            file,
            settings,
            program: Program::default(),
            modes,
            state,
            feed: None,
            is_after_change: false,
            described: Vec::new(),
            called: None,
            has_turned: [false; 2],
        }
    }

    /// Takes a block; false after the one that ends the program.
    pub fn take(&mut self, line: usize, words: &[Word]) -> Result<bool, InputError> {
        let block = Block { file: self.file, line, words };
        let is_of_cycle = |word: &Word| word.0 == 'G' && CYCLES.contains(&(word.1 as i64));
        let in_cycle = self.modes.motion == Some(Motion::Cycle) || words.iter().any(is_of_cycle);
        for (place, (letter, value)) in words.iter().enumerate() {
            if in_cycle && "QL".contains(*letter) {
                continue;
            }
            if !LETTERS.contains(*letter) {
                return Err(self.fail(line, (*letter, *value), "a letter that is not known here", LETTERS));
            }
            if !"GMN".contains(*letter) && words[..place].iter().any(|(before, _)| before == letter) {
                return Err(self.fail(line, (*letter, *value), "is there twice in a block", "each letter once"));
            }
        }
        if let Some(word) = words.iter().find(|word| word.0 == 'M' && [97.0, 98.0, 99.0, 198.0].contains(&word.1)) {
            let problem = "a subprogram, whose cuts would be missing";
            return Err(self.fail(
                line,
                *word,
                problem,
                "one program with all cuts in it: post it without subprograms",
            ));
        }
        if words.contains(&('M', 6.0)) {
            self.is_after_change = true;
        }
        let (mut is_home, mut is_dwell) = (false, false);
        let mut motions = 0;
        for word in words.iter().filter(|(letter, _)| *letter == 'G') {
            let before = self.modes.motion;
            match self.code(line, *word, block.get('P'))? {
                Code::Motion(motion) => {
                    motions += 1;
                    if motions > 1 && before != Some(motion) {
                        return Err(self.fail(line, *word, "two ways to move in one block", "one of G0, G1, G2, G3"));
                    }
                    self.modes.motion = Some(motion);
                }
                Code::Home => is_home = true,
                Code::Dwell => is_dwell = true,
                Code::Mode => {}
            }
        }
        if let Some(feed) = block.get('F') {
            if !(feed > 0.0 && feed <= 1e7) {
                return Err(self.fail(line, ('F', feed), "not a feed", "a feed above 0"));
            }
            self.feed = Some(feed);
        }
        if let Some(tool) = block.get('T') {
            let name = format!("T{tool}");
            if !self.program.tools.contains(&name) {
                self.program.tools.push(name);
            }
            self.called = Some(tool.clamp(0.0, 1e9) as u32);
        }
        self.change_tool(&block);
        if is_home {
            self.state.position = [None; 3];
            self.program.note("G28, G30 or G53: where the tool is then is not known here");
        } else if !is_dwell && words.iter().any(|(letter, _)| "XYZABCIJKR".contains(*letter)) {
            self.travel(&block)?;
        }
        Ok(!words.iter().any(|word| *word == ('M', 2.0) || *word == ('M', 30.0)))
    }

    /// The program, when the file is at its end.
    pub fn finish(mut self) -> Program {
        self.describe_tools();
        if let Some(machine) = self.settings.machine {
            for (has_turned, control) in self.has_turned.into_iter().zip(["without", "with"]) {
                if has_turned {
                    self.program.note(format!("angles of {}, {control} tool centre point control", machine.word()));
                }
            }
        }
        self.program
    }

    /// What a G code does; modes are set.
    fn code(&mut self, line: usize, word: Word, number: Option<f64>) -> Result<Code, InputError> {
        let tenths = (word.1 * 10.0).round();
        let is_code = (tenths - word.1 * 10.0).abs() < 1e-6 && (0.0..1e4).contains(&tenths);
        let modes = &mut self.modes;
        match if is_code { tenths as i64 } else { -1 } {
            0 => return Ok(Code::Motion(Motion::Rapid)),
            10 => return Ok(Code::Motion(Motion::Line)),
            20 => return Ok(Code::Motion(Motion::Clockwise)),
            30 => return Ok(Code::Motion(Motion::CounterClockwise)),
            170 => modes.plane = 2,
            180 => modes.plane = 1,
            190 => modes.plane = 0,
            200 | 210 => return self.set_unit(line, word).map(|()| Code::Mode),
            40 => return Ok(Code::Dwell),
            280 | 300 | 530 => return Ok(Code::Home),
            434 => modes.is_controlled = true,
            490 => modes.is_controlled = self.settings.tool_centre_point,
            541 if number.is_none() => {
                return Err(self.fail(line, word, "G54.1 without the number of its offset", "G54.1 with P"));
            }
            540..=590 if tenths % 10.0 == 0.0 || tenths == 541.0 => {
                let offset = ((tenths / 10.0) as u32, number.map(|number| number as u32));
                if modes.offset.is_some_and(|before| before != offset) {
                    let problem = "a second work offset, and how the two lie to each other is not in the file";
                    return Err(self.fail(
                        line,
                        word,
                        problem,
                        "one of G54 to G59, or one G54 P, for the whole program",
                    ));
                }
                modes.offset = Some(offset);
            }
            800 => {
                if modes.motion == Some(Motion::Cycle) {
                    modes.motion = None;
                }
            }
            code if code % 10 == 0 && CYCLES.contains(&(code / 10)) => {
                if self.settings.skip_cycles {
                    return Ok(Code::Motion(Motion::Cycle));
                }
                let allowed = "--skip-cycles, which leaves all holes out and lists them, or straight moves: post without canned cycles";
                return Err(self.fail(line, word, "a canned cycle", allowed));
            }
            410 | 420 | 411 | 421 => {
                let allowed = "G40: let the CAM system write the path of the tool centre";
                return Err(self.fail(
                    line,
                    word,
                    "cutter compensation: the path is not that of the tool centre",
                    allowed,
                ));
            }
            650 | 660 | 661 | 670 => {
                return Err(self.fail(line, word, "a macro call", "straight moves and arcs: post without macros"));
            }
            900 => modes.is_incremental = false,
            910 => modes.is_incremental = true,
            930 => modes.is_inverse_time = true,
            940 => modes.is_inverse_time = false,
            90 | 50 | 51 | 400 | 430 | 500 | 610 | 611 | 640 | 690 | 911 | 970 | 980 | 990 => {}
            _ => {
                let allowed = "G0-G4, G17-G19, G20, G21, G28, G30, G40, G43, G43.4, G49, G53-G59, G61, G64, G69, G80, G90, G91, G93, \
                               G94, G97-G99";
                return Err(self.fail(line, word, "a code that is not known here", allowed));
            }
        }
        Ok(Code::Mode)
    }

    fn set_unit(&mut self, line: usize, word: Word) -> Result<(), InputError> {
        let unit = if word.1 == 20.0 { LengthUnit::Inch } else { LengthUnit::Millimetre };
        match self.modes.unit {
            Some(before) if before != unit => {
                let problem = format!("contradicts the unit stated before, {}", before.word());
                Err(self.fail(line, word, &problem, "one unit of length for the whole program, as --units says"))
            }
            _ => {
                self.modes.unit = Some(unit);
                Ok(())
            }
        }
    }

    /// Moves to the position of a block.
    fn travel(&mut self, block: &Block<'_>) -> Result<(), InputError> {
        let first =
            block.words.iter().find(|(letter, _)| "XYZABCIJKR".contains(*letter)).copied().unwrap_or(('X', 0.0));
        let Some(motion) = self.modes.motion else {
            return Err(self.fail(block.line, first, "a position before any of G0 to G3", "G0, G1, G2 or G3 before"));
        };
        let metres = self.unit(block.line, first)?.metres();
        if motion == Motion::Cycle {
            return self.leave_out_hole(block, metres);
        }
        let motion = match motion {
            Motion::Line if self.is_after_change && !self.program.moves.is_empty() => {
                self.program.note("first moves of a tool, taken as rapid ones though G0 is not there");
                Motion::Rapid
            }
            Motion::Clockwise | Motion::CounterClockwise if self.is_after_change => {
                return Err(self.fail(block.line, first, "an arc right after a tool change", "G0 to its start before"));
            }
            other => other,
        };
        self.is_after_change = false;
        let is_arc = matches!(motion, Motion::Clockwise | Motion::CounterClockwise);
        if !is_arc && let Some(word) = block.words.iter().find(|(letter, _)| "IJKR".contains(*letter)) {
            return Err(self.fail(
                block.line,
                *word,
                "a centre or radius without an arc",
                "I, J, K and R with G2 and G3",
            ));
        }
        let end = self.target(block, metres)?;
        if end.angles != [0.0; 3] && !self.modes.is_controlled && self.settings.pivot.is_none() {
            return self.turn_without_control(block, motion, end);
        }
        if !self.state.is_known() || !end.is_known() {
            if motion != Motion::Rapid && self.state.position.iter().any(Option::is_some) && end.is_known() {
                self.program.note("moves from where the tool was not known in all axes, taken as rapid ones");
            } else if is_arc {
                return Err(self.fail(
                    block.line,
                    first,
                    "an arc from where the tool is not known",
                    "a position before",
                ));
            }
            self.state = end;
            return if end.is_known() { self.push_end(block.line, end, None, true, false) } else { Ok(()) };
        }
        if motion == Motion::Rapid {
            self.state = end;
            return self.push_end(block.line, end, None, true, false);
        }
        let states = if is_arc { self.arc(block, motion, &end, metres)? } else { self.state.line_to(&end) };
        let first_move = self.program.moves.len();
        for state in states {
            self.push_end(block.line, state, None, false, is_arc)?;
        }
        let feed = self.feed_of(block, first, first_move, metres)?;
        self.program.moves[first_move..].iter_mut().for_each(|one| one.feed = feed);
        self.state = end;
        Ok(())
    }

    /// Notes a block that the operator can have left out.
    pub fn note_block_delete(&mut self) {
        self.program.note("blocks behind / (block delete): taken");
    }

    /// Adds the move to a state.
    fn push_end(
        &mut self,
        line: usize,
        state: State,
        feed: Option<f64>,
        is_rapid: bool,
        is_arc: bool,
    ) -> Result<(), InputError> {
        let programmed = state.programmed();
        self.has_turned[usize::from(self.modes.is_controlled)] |= state.angles != [0.0; 3];
        let (rotation, position) = match self.settings.machine {
            None => (Matrix3::identity(), programmed),
            Some(machine) => {
                let rotation = machine.workpiece_from_tool(state.angles);
                let position = match self.settings.pivot {
                    Some(pivot) if !self.modes.is_controlled => machine.tip(programmed, state.angles, pivot),
                    _ => programmed,
                };
                (rotation, position)
            }
        };
        if !position.iter().all(|value| value.abs() <= 2.0 * LARGEST) {
            return Err(self.fail(line, ('X', programmed.x), "not a position of a usual size", "up to 100 m"));
        }
        let axis = rotation.column(2).into_owned();
        self.program.moves.push(Move { position, axis, feed, is_rapid, is_arc, line });
        Ok(())
    }

    /// The feed of the moves of a block, which are there from a place on; nothing where they have no length. m/s
    fn feed_of(&self, block: &Block<'_>, word: Word, from: usize, metres: f64) -> Result<Option<f64>, InputError> {
        if !self.modes.is_inverse_time {
            return match self.feed {
                Some(feed) => Ok(Some(feed * metres / 60.0)),
                None => Err(self.fail(block.line, word, "a cutting move before the first feed", "F before or with it")),
            };
        }
        let Some(per_minute) = block.get('F') else {
            return Err(self.fail(block.line, word, "G93 without a feed in the block", "F with each move under G93"));
        };
        let length: f64 =
            self.program.moves[from - 1..].windows(2).map(|pair| (pair[1].position - pair[0].position).norm()).sum();
        let before = self.program.moves[from - 1].feed.unwrap_or(1e-3);
        Ok(Some(if length > 1e-6 { length * per_minute / 60.0 } else { before }))
    }

    fn unit(&self, line: usize, word: Word) -> Result<LengthUnit, InputError> {
        self.modes.unit.ok_or_else(|| {
            self.fail(
                line,
                word,
                "a position before its unit of length is stated",
                "G20 or G21 before, or --units mm or inch",
            )
        })
    }

    /// The states along an arc from where the machine is, the end last.
    fn arc(&self, block: &Block<'_>, motion: Motion, end: &State, metres: f64) -> Result<Vec<State>, InputError> {
        let mut axis = Vector3::zeros();
        axis[self.modes.plane] = if motion == Motion::Clockwise { -1.0 } else { 1.0 };
        arc_of(self.settings, block, axis, [&self.state, end], metres)
    }

    fn fail(&self, line: usize, word: Word, problem: &str, allowed: &str) -> InputError {
        failed(self.file, line, word, problem, allowed)
    }
}

/// What a code does beside setting a mode.
enum Code {
    Motion(Motion),
    Home,
    Dwell,
    Mode,
}
