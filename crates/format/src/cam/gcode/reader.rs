//! The interpreter of G-code: what each block does to the state of the tool.

mod tools;
mod travel;

use super::super::course::{Course, Frame};
use super::super::tool::ProgramTool;
use super::super::{CamFormat, LengthUnit, Program, ReadSettings};
use super::block::{Block, Motion, Word};
use super::codes::{CODES, Code, TAKEN, Tilt};
use super::comment;
use nalgebra::{Matrix3, Rotation3, Vector3};
use std::path::Path;
use stead_disk::input::InputError;
use stead_disk::quote::shorten;

/// The letters that a block may have.
const LETTERS: &str = "GXYZABCIJKRFSTMNOHDP";

/// What holds until another code of its group.
struct Modes {
    motion: Option<Motion>,
    /// Normal of the plane of arcs: 0 for x (G19), 1 for y (G18), 2 for z (G17).
    plane: usize,
    unit: Option<LengthUnit>,
    is_incremental: bool,
    is_inverse_time: bool,
    is_controlled: bool,
    /// Work offset, with its number of an extended set.
    offset: Option<(u32, Option<u32>)>,
    /// Whether the tool goes back to the height before a canned cycle (G98).
    is_to_initial: bool,
    /// Whether positions are in a tilted plane.
    is_tilted: bool,
}

/// A canned cycle that is left out.
#[derive(Clone, Copy, Default)]
struct Hole {
    /// The height before it. m
    initial: Option<f64>,
    /// Its plane R. m
    plane: Option<f64>,
}

/// Reads blocks into moves.
pub(super) struct Reader<'a> {
    file: &'a Path,
    settings: &'a ReadSettings,
    /// Its feed is as programmed, without its unit.
    course: Course,
    modes: Modes,
    /// Of the rotary axes. rad
    angles: [f64; 3],
    hole: Hole,
    /// Codes whose blocks are passed over.
    ignored: Vec<Word>,
    /// Tools that comments describe, their lengths in the unit of the program.
    described: Vec<ProgramTool>,
    /// The tool that is called, in the spindle from the next change on.
    called: Option<u32>,
    /// Whether the tool was turned without and with tool centre point control.
    has_turned: [bool; 2],
}

/// The row of a code.
fn code_of(value: f64) -> Option<Code> {
    let tenths = (value * 10.0).round();
    let is_code = (tenths - value * 10.0).abs() < 1e-6 && (0.0..1e4).contains(&tenths);
    let row = is_code.then(|| CODES.binary_search_by_key(&(tenths as i64), |(code, _)| *code))?;
    row.ok().map(|row| CODES[row].1)
}

impl<'a> Reader<'a> {
    pub fn new(file: &'a Path, settings: &'a ReadSettings) -> Result<Self, InputError> {
        let modes = Modes {
            motion: None,
            plane: 2,
            unit: settings.units,
            is_incremental: false,
            is_inverse_time: false,
            is_controlled: settings.tool_centre_point,
            offset: None,
            is_to_initial: true,
            is_tilted: false,
        };
        let ignored = settings.ignore.iter().map(|text| {
            let number = text.trim().strip_prefix(['G', 'g']).and_then(|number| number.parse::<f64>().ok());
            let is_path = |number: &f64| matches!(code_of(*number), Some(Code::Motion(_)));
            number.filter(|number| !is_path(number)).map(|number| ('G', number)).ok_or_else(|| {
                InputError::new(file, "is no code of G-code that can be passed over")
                    .in_field("--ignore")
                    .found(format!("'{}'", shorten(text)))
                    .allowed("codes as G5.1, whose blocks are left out; not G0 to G3")
            })
        });
        let mut course = Course::new(settings.resampling);
        course.program.format = CamFormat::Gcode;
        Ok(Self {
            file,
            settings,
            course,
            modes,
            angles: [0.0; 3],
            hole: Hole::default(),
            ignored: ignored.collect::<Result<_, _>>()?,
            described: Vec::new(),
            called: None,
            has_turned: [false; 2],
        })
    }

    /// Takes what comments of a line say.
    pub fn comment(&mut self, line: &str) {
        self.described.extend(comment::tool_in(line));
        self.course.program.has_rapids_at_feed |= comment::says_rapids_at_feed(line);
    }

    /// Notes a block that the operator can have left out.
    pub fn note_block_delete(&mut self) {
        self.course.program.note("blocks behind / (block delete): taken");
    }

    /// Takes a block; false after the one that ends the program.
    pub fn take(&mut self, line: usize, words: &[Word]) -> Result<bool, InputError> {
        let block = Block { file: self.file, line, words };
        if let Some((letter, value)) = words.iter().find(|word| self.ignored.contains(word)) {
            let text = format!("blocks with {letter}{value} passed over, as asked (--ignore)");
            self.course.program.note_at(text, line);
            return Ok(true);
        }
        let codes = self.codes(&block)?;
        self.check_letters(&block)?;
        if words.contains(&('M', 6.0)) {
            self.course.is_after_change = true;
        }
        if let Some(feed) = block.get('F') {
            if !(feed > 0.0 && feed <= 1e7) {
                return Err(block.fail(('F', feed), "not a feed", "a feed above 0"));
            }
            self.course.feed = Some(feed);
        }
        if let Some(tool) = block.get('T') {
            let name = format!("T{tool}");
            if !self.course.program.tools.contains(&name) {
                self.course.program.tools.push(name);
            }
            self.called = Some(tool.clamp(0.0, 1e9) as u32);
        }
        self.change_tool(&block);
        let has = |letters: &str| words.iter().any(|(letter, _)| letters.contains(*letter));
        if let Some(name) = codes.away {
            // Of a move home all axes, where none is named.
            let is_all = codes.is_home && !has("XYZABC");
            self.course.forget(['X', 'Y', 'Z'].map(|axis| is_all || block.get(axis).is_some()), name, line);
        } else if let Some(tilt) = codes.tilt {
            self.tilt(&block, tilt)?;
            if tilt != Tilt::Plane && has("XYZIJKR") {
                self.travel(&block)?;
            }
        } else if !codes.is_dwell && has("XYZABCIJKR") {
            self.travel(&block)?;
        }
        Ok(!words.iter().any(|word| *word == ('M', 2.0) || *word == ('M', 30.0)))
    }

    fn check_letters(&self, block: &Block<'_>) -> Result<(), InputError> {
        let in_cycle = self.modes.motion == Some(Motion::Cycle);
        for (place, (letter, value)) in block.words.iter().enumerate() {
            let word = (*letter, *value);
            if in_cycle && "QL".contains(*letter) {
                continue;
            }
            if !LETTERS.contains(*letter) {
                return Err(block.fail(word, "a letter that is not known here", LETTERS));
            }
            if !"GMN".contains(*letter) && block.words[..place].iter().any(|(before, _)| before == letter) {
                return Err(block.fail(word, "is there twice in a block", "each letter once"));
            }
            if *letter == 'M' && [97.0, 98.0, 99.0, 198.0].contains(value) {
                let allowed = "one program with all cuts in it: post it without subprograms";
                return Err(block.fail(word, "a subprogram, whose cuts would be missing", allowed));
            }
        }
        Ok(())
    }

    /// The program, when the file is at its end.
    pub fn finish(mut self) -> Program {
        self.describe_tools();
        if let Some(machine) = self.settings.machine {
            for (has_turned, control) in self.has_turned.into_iter().zip(["without", "with"]) {
                if has_turned {
                    let note = format!("angles of {}, {control} tool centre point control", machine.word());
                    self.course.program.note(note);
                }
            }
        }
        self.course.program
    }

    /// What the G codes of a block do beside setting modes.
    fn codes(&mut self, block: &Block<'_>) -> Result<Codes, InputError> {
        let mut codes = Codes::default();
        let mut motions = 0;
        for word in block.words.iter().filter(|(letter, _)| *letter == 'G') {
            let code = code_of(word.1);
            let code = code.ok_or_else(|| block.fail(*word, "a code that is not known here", TAKEN))?;
            let modes = &mut self.modes;
            match code {
                Code::Motion(motion) => {
                    motions += 1;
                    if motions > 1 && modes.motion != Some(motion) {
                        return Err(block.fail(*word, "two ways to move in one block", "one of G0, G1, G2, G3"));
                    }
                    modes.motion = Some(motion);
                }
                Code::Plane(normal) => modes.plane = normal,
                Code::Unit(unit) => match modes.unit {
                    Some(before) if before != unit => {
                        return Err(block.fail(
                            *word,
                            "contradicts the unit before",
                            "one unit of length for the whole program, and what --units says",
                        ));
                    }
                    _ => modes.unit = Some(unit),
                },
                Code::Dwell => codes.is_dwell = true,
                Code::Home => {
                    codes.is_home = true;
                    codes.away = Some(if word.1 == 28.0 { "G28" } else { "G30" });
                }
                Code::Machine => codes.away = Some("G53"),
                Code::Absolute(is_absolute) => modes.is_incremental = !is_absolute,
                Code::InverseTime(is_on) => modes.is_inverse_time = is_on,
                Code::Control(is_on) => modes.is_controlled = is_on || self.settings.tool_centre_point,
                Code::Offset => self.offset(block, *word)?,
                Code::Cycle if !self.settings.skip_cycles => {
                    let allowed = "--skip-cycles, which leaves all holes out and lists them, or straight moves: post without canned cycles";
                    return Err(block.fail(*word, "a canned cycle", allowed));
                }
                Code::Cycle => {
                    if modes.motion != Some(Motion::Cycle) {
                        self.hole = Hole { initial: self.course.place[modes.plane], plane: None };
                    }
                    modes.motion = Some(Motion::Cycle);
                }
                Code::CycleEnd => modes.motion = modes.motion.filter(|motion| *motion != Motion::Cycle),
                Code::ToInitial(is_to_initial) => modes.is_to_initial = is_to_initial,
                Code::Mode(tilt) => codes.tilt = Some(tilt),
                Code::Nothing => {}
                Code::Refused(is, allowed) => return Err(block.fail(*word, is, allowed)),
            }
        }
        Ok(codes)
    }

    fn offset(&mut self, block: &Block<'_>, word: Word) -> Result<(), InputError> {
        let number = block.get('P');
        if number.is_none() && word.1.fract() != 0.0 {
            return Err(block.fail(word, "G54.1 without the number of its offset", "G54.1 with P"));
        }
        let offset = (word.1 as u32, number.map(|number| number as u32));
        if self.modes.offset.is_some_and(|before| before != offset) {
            let problem = "a second work offset, and how the two lie to each other is not in the file";
            return Err(block.fail(word, problem, "one of G54 to G59, or one G54 P, for the whole program"));
        }
        self.modes.offset = Some(offset);
        Ok(())
    }

    /// Begins or ends a tilted work plane, or turns the tool normal to it.
    fn tilt(&mut self, block: &Block<'_>, tilt: Tilt) -> Result<(), InputError> {
        match tilt {
            Tilt::Plane => {
                if let Some(form) = block.words.iter().find(|(letter, _)| "PQ".contains(*letter)) {
                    let allowed = "G68.2 X Y Z I J K, Euler angles about z, x and z: let the CAM system post it so";
                    return Err(block.fail(*form, "a tilted work plane of another form", allowed));
                }
                let metres = self.unit(block, ('G', 68.2))?.metres();
                let value = |letter| block.get(letter).unwrap_or(0.0);
                let origin = Vector3::from(['X', 'Y', 'Z'].map(value)) * metres;
                let angles = ['I', 'J', 'K'].map(value);
                let largest = travel::LARGEST_ANGLE;
                if origin.amax() > super::super::LARGEST || angles.iter().any(|angle| angle.abs() > largest) {
                    return Err(block.fail(('G', 68.2), "not a frame of a usual size", "up to 100 m and 36000 deg"));
                }
                let [about, tilt, turn] = angles.map(f64::to_radians);
                let turned = |axis, angle| *Rotation3::from_axis_angle(&axis, angle).matrix();
                let [z, x] = [Vector3::z_axis(), Vector3::x_axis()];
                let rotation = turned(z, about) * turned(x, tilt) * turned(z, turn);
                self.course
                    .program
                    .note_at("tilted work planes (G68.2): positions turned into the frame of the part", block.line);
                self.set_frame(Frame { rotation, origin }, "G68.2", block.line);
                self.modes.is_tilted = true;
            }
            Tilt::Tool | Tilt::ToolAboutTip => {
                let has_turned = (self.course.axis - Vector3::z()).norm() > 1e-9;
                if has_turned && tilt == Tilt::Tool {
                    self.course.forget([true; 3], "G53.1", block.line);
                }
                self.course.axis = Vector3::z();
                self.angles = [0.0; 3];
            }
            // Before any tilted plane it ends nothing.
            Tilt::End if self.modes.is_tilted => {
                self.set_frame(Frame::identity(), "G69", block.line);
                self.course.axis = Vector3::z();
                self.modes.is_tilted = false;
            }
            Tilt::End => {}
        }
        Ok(())
    }

    /// Positions are in another frame from here on; the tool stays as it stands.
    fn set_frame(&mut self, frame: Frame, code: &'static str, line: usize) {
        let axis = self.course.frame.rotation * (self.pose(Vector3::zeros(), self.angles).0 * self.course.axis);
        self.course.axis = frame.rotation.transpose() * axis;
        self.course.frame = frame;
        self.course.forget([true; 3], code, line);
    }

    fn unit(&self, block: &Block<'_>, word: Word) -> Result<LengthUnit, InputError> {
        let allowed = "G20 or G21 before, or --units mm or inch";
        self.modes.unit.ok_or_else(|| block.fail(word, "a position before its unit of length is stated", allowed))
    }

    /// How the tool stands in the frame at angles of the rotary axes, and where its tip is. m
    fn pose(&self, programmed: Vector3<f64>, angles: [f64; 3]) -> (Matrix3<f64>, Vector3<f64>) {
        let machine = self.settings.machine.filter(|_| !self.modes.is_tilted);
        let Some(machine) = machine else { return (Matrix3::identity(), programmed) };
        let position = match self.settings.pivot {
            Some(pivot) if !self.modes.is_controlled => machine.tip(programmed, angles, pivot),
            _ => programmed,
        };
        (machine.workpiece_from_tool(angles), position)
    }
}

/// What the G codes of a block do.
#[derive(Default)]
struct Codes {
    /// The code by which the tool leaves the frame of the program.
    away: Option<&'static str>,
    is_home: bool,
    is_dwell: bool,
    tilt: Option<Tilt>,
}
