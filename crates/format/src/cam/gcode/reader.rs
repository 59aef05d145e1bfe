//! The interpreter of G-code: what each block does to the state of the tool.

mod tools;
mod travel;

use super::super::course::{Course, Frame};
use super::super::refusals::*;
use super::super::tool::ProgramTool;
use super::super::{CamFormat, LARGEST, LengthUnit, Program, ReadSettings};
use super::block::{Block, Word};
use super::codes::{Code, Tilt, code_of};
use super::comment;
use super::motion::Motion;
use nalgebra::{Rotation3, Vector3};
use stead_disk::input::InputError;

/// The letters that a block may have.
const LETTERS: &str = "GXYZABCIJKRFSTMNOHDP";
/// Codes of subprograms.
const SUBPROGRAMS: [f64; 4] = [97.0, 98.0, 99.0, 198.0];

/// What holds until another code of its group.
#[derive(Default)]
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
    /// Whether the tool goes back to plane R behind a hole (G99), not to the height before the cycle.
    is_to_plane: bool,
    /// Whether positions are in a tilted plane.
    is_tilted: bool,
    /// Of the rotary axes. rad
    angles: [f64; 3],
    /// Of a canned cycle that is left out: the height before it, and its plane R. m
    heights: [Option<f64>; 2],
}

/// Reads blocks into moves.
pub(super) struct Reader<'a> {
    settings: &'a ReadSettings,
    /// Its feed is as programmed, without its unit.
    course: Course,
    modes: Modes,
    /// Tools that comments describe, their lengths in the unit of the program.
    described: Vec<ProgramTool>,
    /// The tool that is called, in the spindle from the next change on.
    called: Option<u32>,
    /// Whether the tool was turned without and with tool centre point control.
    has_turned: [bool; 2],
}

/// What the G codes of a block do beside setting modes.
#[derive(Default)]
struct Codes {
    /// The code by which the tool leaves the frame of the program.
    away: Option<&'static str>,
    is_home: bool,
    is_dwell: bool,
    tilt: Option<Tilt>,
}

impl<'a> Reader<'a> {
    pub fn new(settings: &'a ReadSettings) -> Self {
        let (unit, is_controlled) = (settings.units, settings.tool_centre_point);
        let modes = Modes { plane: 2, unit, is_controlled, ..Modes::default() };
        let mut course = Course::new(settings.resampling);
        course.program.format = CamFormat::Gcode;
        Self { settings, course, modes, described: Vec::new(), called: None, has_turned: [false; 2] }
    }

    /// Takes what comments of a line say, and that the operator can have it left out.
    pub fn comment(&mut self, text: &str, line: usize) {
        self.described.extend(comment::tool_in(text));
        self.course.program.has_rapids_at_feed |= comment::says_rapids_at_feed(text);
        if text.trim_start().starts_with('/') {
            self.course.program.note("blocks behind / (block delete): taken", line);
        }
    }

    /// Takes a block; false after the one that ends the program.
    pub fn take(&mut self, block: &Block<'_>) -> Result<bool, InputError> {
        // By its number, so that G05.1 is G5.1.
        let is = |text: &str, word: &Word| text.get(1..).and_then(|number| number.parse().ok()) == Some(word.1);
        let is_ignored = |word: &&Word| self.settings.ignore.iter().any(|text| word.0 == 'G' && is(text, word));
        if let Some(word) = block.words.iter().find(is_ignored) {
            ensure!(!matches!(code_of(word.1), Some(Code::Motion(_))), block.fail(*word, IGNORED_PATH));
            let note = format!("blocks with G{} passed over, as asked (--ignore)", word.1);
            self.course.program.note(note, block.line);
            return Ok(true);
        }
        let codes = self.codes(block)?;
        let in_cycle = self.modes.motion == Some(Motion::Cycle);
        for (place, word) in block.words.iter().enumerate() {
            let letter = word.0;
            let is_known = LETTERS.contains(letter) || (in_cycle && "QL".contains(letter));
            ensure!(is_known, block.fail(*word, ("a letter that is not known here", LETTERS)));
            let is_twice = !"GMN".contains(letter) && block.words[..place].iter().any(|(before, _)| *before == letter);
            ensure!(!is_twice, block.fail(*word, TWICE));
            ensure!(letter != 'M' || !SUBPROGRAMS.contains(&word.1), block.fail(*word, SUBPROGRAM));
        }
        self.course.is_after_change |= block.words.contains(&('M', 6.0));
        if let Some(feed) = block.get('F') {
            ensure!(feed > 0.0 && feed <= 1e7, block.fail(('F', feed), NOT_A_FEED));
            self.course.feed = Some(feed);
        }
        self.change_tool(block);
        if let Some(code) = codes.away {
            // Of a move home all axes, where none is named.
            let is_all = codes.is_home && !block.has("XYZABC");
            self.course.forget(['X', 'Y', 'Z'].map(|axis| is_all || block.get(axis).is_some()), code, block.line);
        } else {
            if let Some(tilt) = codes.tilt {
                self.tilt(block, tilt)?;
            }
            if !codes.is_dwell && codes.tilt != Some(Tilt::Plane) && block.has("XYZABCIJKR") {
                self.travel(block)?;
            }
        }
        Ok(![2.0, 30.0].iter().any(|end| block.words.contains(&('M', *end))))
    }

    /// The program, when the file is at its end.
    pub fn finish(mut self, line: usize) -> Program {
        self.describe_tools();
        if let Some(machine) = self.settings.machine {
            for (_, control) in self.has_turned.iter().zip(["without", "with"]).filter(|(has_turned, _)| **has_turned) {
                let note = format!("angles of {}, {control} tool centre point control", machine.word());
                self.course.program.note(note, line);
            }
        }
        self.course.program
    }

    fn codes(&mut self, block: &Block<'_>) -> Result<Codes, InputError> {
        let mut codes = Codes::default();
        let mut motions = 0;
        for word in block.words.iter().filter(|(letter, _)| *letter == 'G') {
            let code = code_of(word.1).ok_or_else(|| block.fail(*word, NOT_A_CODE))?;
            let modes = &mut self.modes;
            match code {
                Code::Motion(motion) => {
                    motions += 1;
                    let before = modes.motion.replace(motion);
                    ensure!(motions == 1 || before == Some(motion), block.fail(*word, TWO_WAYS));
                }
                Code::Plane(normal) => modes.plane = normal,
                Code::Unit(unit) => {
                    ensure!(*modes.unit.get_or_insert(unit) == unit, block.fail(*word, OTHER_UNIT));
                }
                Code::Dwell => codes.is_dwell = true,
                Code::Home(name) => (codes.is_home, codes.away) = (true, Some(name)),
                Code::Machine => codes.away = Some("G53"),
                Code::Absolute(is_absolute) => modes.is_incremental = !is_absolute,
                Code::InverseTime(is_on) => modes.is_inverse_time = is_on,
                Code::Control(is_on) => modes.is_controlled = is_on || self.settings.tool_centre_point,
                Code::Offset => {
                    let number = block.get('P');
                    ensure!(number.is_some() || word.1.fract() == 0.0, block.fail(*word, NO_NUMBER));
                    let offset = (word.1 as u32, number.map(|number| number as u32));
                    ensure!(*modes.offset.get_or_insert(offset) == offset, block.fail(*word, SECOND_G54));
                }
                Code::Cycle => {
                    ensure!(self.settings.skip_cycles, block.fail(*word, CANNED_CYCLE));
                    if modes.motion.replace(Motion::Cycle) != Some(Motion::Cycle) {
                        modes.heights = [self.course.place[modes.plane], None];
                    }
                }
                Code::CycleEnd => modes.motion = modes.motion.filter(|motion| *motion != Motion::Cycle),
                Code::ToPlane(is_to_plane) => modes.is_to_plane = is_to_plane,
                Code::Mode(tilt) => codes.tilt = Some(tilt),
                Code::Nothing => {}
                Code::Refused(is, allowed) => return Err(block.fail(*word, (is, allowed))),
            }
        }
        Ok(codes)
    }

    /// Begins or ends a tilted work plane, or turns the tool normal to it.
    fn tilt(&mut self, block: &Block<'_>, tilt: Tilt) -> Result<(), InputError> {
        let (word, line) = (('G', 68.2), block.line);
        match tilt {
            Tilt::Plane => {
                ensure!(!block.has("PQ"), block.fail_at("PQ", TILTED_OTHERWISE));
                ensure!(self.modes.unit.is_some(), block.fail(word, NO_UNIT_BEFORE));
                let metres = self.metres();
                let [origin, angles] = ["XYZ", "IJK"].map(|letters| {
                    Vector3::from_iterator(letters.chars().map(|letter| block.get(letter).unwrap_or(0.0)))
                });
                let is_usual = origin.amax() * metres <= LARGEST && angles.amax() <= travel::LARGEST_ANGLE;
                ensure!(is_usual, block.fail(word, FAR_FRAME));
                let [z, x] = [Vector3::z_axis(), Vector3::x_axis()];
                let turned = |about, angle: f64| Rotation3::from_axis_angle(&about, angle.to_radians());
                let rotation = turned(z, angles.x) * turned(x, angles.y) * turned(z, angles.z);
                let note = "tilted work planes (G68.2): positions turned into the frame of the part";
                self.course.program.note(note, line);
                self.set_frame(Frame { rotation, origin: origin * metres }, "G68.2", line);
                self.modes.is_tilted = true;
            }
            Tilt::Tool { is_about_tip } => {
                let turns = (self.course.axis - Vector3::z()).norm() > 1e-9 && !is_about_tip;
                self.course.forget([turns; 3], "G53.1", line);
                (self.course.axis, self.modes.angles) = (Vector3::z(), [0.0; 3]);
            }
            // Before any tilted plane it ends nothing.
            Tilt::End if self.modes.is_tilted => {
                self.set_frame(Frame::default(), "G69", line);
                (self.course.axis, self.modes.is_tilted) = (Vector3::z(), false);
            }
            Tilt::End => {}
        }
        Ok(())
    }

    /// Positions are in another frame from here on; the tool stays as it stands.
    fn set_frame(&mut self, frame: Frame, code: &'static str, line: usize) {
        let axis = self.course.frame.rotation * (self.pose(Vector3::zeros(), self.modes.angles).0 * self.course.axis);
        (self.course.axis, self.course.frame) = (frame.rotation.transpose() * axis, frame);
        self.course.forget([true; 3], code, line);
    }

    /// The unit of length, 0 as long as it is not known. m
    fn metres(&self) -> f64 {
        self.modes.unit.map_or(0.0, LengthUnit::metres)
    }
}
