//! The interpreter of CLDATA: what each word of a dialect does to the state of the tool.

mod arcs;
mod points;

use super::super::course::{Course, Frame, NO_LENGTH};
use super::super::{LARGEST, LengthUnit, Program, ReadSettings};
use super::cutter::cutter;
use super::cycle::{Cycle, FORMS};
use super::dialect::{CutterForm, Dialect, Effect, Ending, FrameForm};
use super::statement::Statement;
use arcs::Pending;
use nalgebra::{Matrix3, Vector3};
use std::path::Path;
use stead_disk::input::InputError;
use stead_disk::quote::one_line;

/// Directions of a frame may be this far from unit length and right angles: digits as printed.
const FRAME_ROUNDING: f64 = 1e-3;
/// An unknown word with so many numbers may hold a position, a direction or a frame.
const NUMBERS_OF_A_PLACE: usize = 3;

/// Units of feed, for messages.
const FEED_UNITS: &str = "MMPM, IPM, MMPR, IPR, PERMIN or PERREV";

/// What becomes of the points that follow.
enum Holes {
    Drilled(Cycle),
    LeftOut,
}

/// Reads statements into moves.
pub(super) struct Reader<'a> {
    file: &'a Path,
    dialect: &'static Dialect,
    settings: &'a ReadSettings,
    unit: LengthUnit,
    course: Course,
    /// rev/s
    spindle: Option<f64>,
    is_rapid: bool,
    /// Whether `MULTAX/OFF` holds.
    is_three_axis: bool,
    /// The frame that the file names as that of its positions, where it is not applied.
    named: Option<Frame>,
    offset: Option<f64>,
    pending: Option<Pending>,
    /// The way out of the next arc, in the workpiece frame.
    tangent: Option<Vector3<f64>>,
    /// The arc whose circle the next points may lie on, where the dialect has such.
    circle: Option<Pending>,
    /// A cycle that is open, with its line.
    holes: Option<(Holes, usize)>,
    /// Length of flutes (m) that is stated before any move from this one on.
    flutes: Option<(f64, usize)>,
    is_ended: bool,
}

impl<'a> Reader<'a> {
    pub fn new(
        file: &'a Path,
        dialect: &'static Dialect,
        unit: LengthUnit,
        settings: &'a ReadSettings,
    ) -> Result<Self, InputError> {
        let is_path = |word: &&String| {
            matches!(dialect.effect(word), Some(Effect::Move(_) | Effect::Rapid | Effect::Arc(_) | Effect::End(_)))
        };
        if let Some(word) = settings.ignore.iter().find(is_path) {
            return Err(InputError::new(file, "is a word of the path itself")
                .in_field("--ignore")
                .found(format!("'{}'", one_line(word)))
                .allowed("words that do not move the tool"));
        }
        let mut course = Course::new(settings.resampling);
        (course.is_after_change, course.program.format) = (true, dialect.format);
        Ok(Self {
            file,
            dialect,
            settings,
            unit,
            course,
            spindle: None,
            is_rapid: false,
            is_three_axis: false,
            named: None,
            offset: None,
            pending: None,
            tangent: None,
            circle: None,
            holes: None,
            flutes: None,
            is_ended: false,
        })
    }

    /// Takes a statement; false after the one that ends the program.
    pub fn take(&mut self, statement: &Statement<'_>) -> Result<bool, InputError> {
        let Some(effect) = self.effect(statement)? else { return Ok(true) };
        if let (Some(pending), false) = (&self.pending, matches!(effect, Effect::Move(_) | Effect::Feed)) {
            return Err(self.fail_at(
                pending.line,
                pending.word,
                "is not followed by its end",
                "a GOTO behind each arc",
            ));
        }
        if !matches!(effect, Effect::Move(_)) {
            self.circle = None;
        }
        match effect {
            Effect::Move(ends) => self.goto(statement, ends)?,
            Effect::Rapid => self.is_rapid = true,
            Effect::Arc(form) => self.arc(statement, form)?,
            Effect::Tangent => self.tangent = Some(self.course.frame.rotation * self.direction(statement)?),
            Effect::Frame(form) => self.frame(statement, form)?,
            Effect::Axis => self.course.axis = self.direction(statement)?,
            Effect::Axes => self.is_three_axis = statement.has("OFF"),
            Effect::Feed => self.fedrat(statement)?,
            Effect::Spindle => self.spindl(statement),
            Effect::Unit => {}
            Effect::Cutter(form) => self.cutter(statement, form)?,
            Effect::Tool => self.tool(statement)?,
            Effect::Section => self.section(statement)?,
            Effect::Cycle => self.cycle(statement)?,
            Effect::Compensation => {
                if !statement.has("OFF") && !statement.has("LENGTH") {
                    self.course.program.note("CUTCOM: the points are taken as those of the tool centre");
                }
            }
            Effect::Offset => self.offset(statement)?,
            Effect::Mode if ["INCR", "INCREM", "INC", "DELTA"].iter().any(|word| statement.has(word)) => {
                let allowed = "positions from the origin: let the CAM system write them so";
                return Err(self.fail(statement, "positions that count from the last one", allowed));
            }
            Effect::Mode => {}
            Effect::Text | Effect::Nothing => self.pass_over(statement.word),
            Effect::Refused(why) => {
                let allowed = format!(
                    "GOTO, RAPID, arcs and drilling cycles: let the CAM system write straight moves and arcs; or --ignore {}, if it does nothing here",
                    statement.word.to_ascii_uppercase()
                );
                return Err(self.fail(statement, &format!("is not read: {why}"), &allowed));
            }
            Effect::End(Ending::Path) => self.is_ended = true,
            Effect::End(Ending::Program) => {
                self.is_ended = true;
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// What a statement does by its dialect; nothing where its word is ignored, or one that nobody knows.
    fn effect(&mut self, statement: &Statement<'_>) -> Result<Option<Effect>, InputError> {
        let word = statement.word;
        let ignored = self.settings.ignore.iter().find(|own| own.eq_ignore_ascii_case(word));
        if let Some(own) = ignored {
            let text = format!("{} passed over, as asked (--ignore)", one_line(&own.to_ascii_uppercase()));
            self.course.program.note_at(text, statement.line);
            return Ok(None);
        }
        let known = self.dialect.effect(word);
        if known.is_some() {
            return Ok(known);
        }
        let count = statement.numbers().count();
        let name = one_line(&word.to_ascii_uppercase());
        if count >= NUMBERS_OF_A_PLACE {
            let problem = format!(
                "is not known, and its {count} numbers may move the tool, or what its positions count from, in a way that is not known here"
            );
            let allowed = format!(
                "--ignore {name}, if it does nothing of that; else let the CAM system write straight moves and arcs"
            );
            return Err(self.fail(statement, &problem, &allowed));
        }
        self.course.program.unknown.entry(name).or_default().at(Some(statement.line));
        Ok(None)
    }

    /// The program, when the file is at its end.
    pub fn finish(self, last: &Statement<'_>) -> Result<Program, InputError> {
        if let Some(pending) = &self.pending {
            let problem = "the file ends before the end of the arc";
            return Err(self.fail_at(last.line.max(pending.line), pending.word, problem, "a GOTO behind each arc"));
        }
        let mut program = self.course.program;
        if !self.is_ended {
            program.note("no FINI and no END-OF-PATH: the file may be cut short");
        }
        for word in &self.settings.ignore {
            let start = format!("{} passed over", word.to_ascii_uppercase());
            if !program.notes.keys().any(|note| note.starts_with(&start)) {
                program.note(format!("--ignore {}: no such word in the file", one_line(word)));
            }
        }
        Ok(program)
    }

    fn pass_over(&mut self, word: &str) {
        let counts = &mut self.course.program.passed_over;
        match counts.get_mut(word) {
            Some(count) => *count += 1,
            None => *counts.entry(one_line(&word.to_ascii_uppercase())).or_default() += 1,
        }
    }

    /// A direction of the file, of unit length.
    fn direction(&self, statement: &Statement<'_>) -> Result<Vector3<f64>, InputError> {
        let allowed = "3 finite numbers: a direction, as 0,0,1";
        let given = self.numbers(statement, |count| count >= 3, allowed)?;
        let direction = Vector3::new(given[0], given[1], given[2]).try_normalize(NO_LENGTH);
        direction.ok_or_else(|| self.fail(statement, "the direction has no length", allowed))
    }

    fn cycle(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        let ends = ["OFF", "END", "INIT", "CLEAR"];
        let first = statement.words().next().unwrap_or_default();
        self.holes = if ends.iter().any(|word| first.eq_ignore_ascii_case(word)) {
            None
        } else if self.settings.skip_cycles {
            Some((Holes::LeftOut, statement.line))
        } else {
            self.numbers(statement, |_| true, FORMS)?;
            let cycle = Cycle::of(statement, self.dialect.hole_depth);
            let problem = "a cycle whose moves are not known here";
            let cycle = cycle.ok_or_else(|| self.fail(statement, problem, FORMS))?;
            Some((Holes::Drilled(cycle), statement.line))
        };
        Ok(())
    }

    /// Refuses what begins while a cycle is open: holes may follow, or cuts.
    fn no_cycle_is_open(&self, statement: &Statement<'_>) -> Result<(), InputError> {
        match &self.holes {
            Some((_, line)) => {
                let problem = format!("the cycle of line {line} is still open here: holes may follow, or cuts");
                Err(self.fail(statement, &problem, "CYCLE/OFF before, behind the last hole"))
            }
            None => Ok(()),
        }
    }

    fn fedrat(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        let given = self.numbers(statement, |count| count == 1, "one feed above 0 and its unit")?;
        let value = given[0];
        if value <= 0.0 {
            return Err(self.fail(statement, "not a feed", "a feed above 0"));
        }
        let words: Vec<&str> = statement.words().collect();
        let word = match words[..] {
            [] => {
                self.course.program.note(format!("FEDRAT without a unit, taken in {} per minute", self.unit.word()));
                "PERMIN"
            }
            [word] => word,
            _ => return Err(self.fail(statement, "not one unit of feed", FEED_UNITS)),
        };
        self.course.feed = Some(self.feed_in(statement, value, word)?);
        Ok(())
    }

    /// A feed in the unit of a word. m/s
    fn feed_in(&self, statement: &Statement<'_>, value: f64, word: &str) -> Result<f64, InputError> {
        let (unit, per_revolution) = match &word.to_ascii_uppercase()[..] {
            "MMPM" => (LengthUnit::Millimetre, false),
            "IPM" => (LengthUnit::Inch, false),
            "MMPR" => (LengthUnit::Millimetre, true),
            "IPR" => (LengthUnit::Inch, true),
            "PERMIN" => (self.unit, false),
            "PERREV" => (self.unit, true),
            _ => return Err(self.fail(statement, "not a unit of feed", FEED_UNITS)),
        };
        let length = value * unit.metres();
        match (per_revolution, self.spindle) {
            (false, _) => Ok(length / 60.0),
            (true, Some(speed)) => Ok(length * speed),
            (true, None) => {
                Err(self.fail(statement, "a feed per revolution without a spindle speed", "SPINDL with RPM before"))
            }
        }
    }

    fn spindl(&mut self, statement: &Statement<'_>) {
        let is_surface_speed = ["SFM", "SMM"].iter().any(|word| statement.has(word));
        if let Some(speed) = statement.numbers().next() {
            self.spindle = (speed > 0.0 && speed.is_finite() && !is_surface_speed).then_some(speed / 60.0);
        }
        let speed = self.spindle;
        self.course.program.change_tool(|tool| {
            tool.spindle_speed = speed;
            tool.is_counterclockwise = statement.has("CCLW") || (tool.is_counterclockwise && !statement.has("CLW"));
        });
    }

    fn frame(&mut self, statement: &Statement<'_>, form: FrameForm) -> Result<(), InputError> {
        let (counts, allowed): (&[usize], &str) = match form {
            FrameForm::OriginXY => (&[9], "9 numbers: origin, x axis, y axis"),
            FrameForm::Rows => (&[12], "12 numbers: three rows of a rotation and an origin"),
            FrameForm::RowsBelow => (&[12], "three comments below with a row of a rotation and of an origin each"),
            FrameForm::AxesOrigin => (&[12], "12 numbers: x, y and z axis, origin"),
            FrameForm::NumberOriginXY => (&[9, 10], "a number, origin, x axis, y axis"),
            FrameForm::OriginXZ => (&[3, 9], "an origin, and x and z axis where they turn"),
            FrameForm::Zero => {
                (&[0, 1, 3], "no origin but 0,0,0: let the CAM system write positions in the frame of the part")
            }
        };
        let given = self.numbers(statement, |count| counts.contains(&count), allowed)?;
        let at = |k: usize| Vector3::new(given[k], given[k + 1], given[k + 2]);
        let [origin, x, y] = match form {
            FrameForm::Zero if given.iter().all(|number| *number == 0.0) => return Ok(()),
            FrameForm::Zero => return Err(self.fail(statement, "an origin other than 0,0,0", allowed)),
            FrameForm::OriginXY => [at(0), at(3), at(6)],
            FrameForm::NumberOriginXY => [9, 6, 3].map(|k| at(given.len() - k)),
            FrameForm::AxesOrigin => [at(9), at(0), at(3)],
            FrameForm::Rows | FrameForm::RowsBelow => {
                [3, 0, 1].map(|column| Vector3::from_fn(|row, _| given[4 * row + column]))
            }
            FrameForm::OriginXZ if given.len() == 3 => [at(0), Vector3::x(), Vector3::y()],
            FrameForm::OriginXZ => [at(0), at(3), at(6).cross(&at(3))],
        };
        // All three axes of a statement that has them.
        let z = match form {
            FrameForm::AxesOrigin => at(6),
            FrameForm::Rows | FrameForm::RowsBelow => Vector3::from_fn(|row, _| given[4 * row + 2]),
            _ => x.cross(&y),
        };
        let rotation = Matrix3::from_columns(&[x, y, z]);
        let off = (rotation.tr_mul(&rotation) - Matrix3::identity()).abs().max();
        if off > FRAME_ROUNDING || rotation.determinant() < 0.0 {
            let allowed = "unit vectors at right angles, right-handed";
            return Err(self.fail(statement, "the axes of the frame are no rotation", allowed));
        }
        if form == FrameForm::RowsBelow {
            self.section(statement)?;
        }
        let z = x.cross(&y).normalize();
        let x = x.normalize();
        let rotation = Matrix3::from_columns(&[x, z.cross(&x), z]);
        self.set_frame(statement, Frame { rotation, origin: origin * self.unit.metres() })
    }

    /// Applies a frame, or takes it as that of all positions where the dialect names it so.
    fn set_frame(&mut self, statement: &Statement<'_>, frame: Frame) -> Result<(), InputError> {
        let word = statement.word.trim_start_matches(['$', '-', '>', '*']);
        let is_same = frame.is_near(&self.course.frame);
        if self.dialect.applies_frames {
            if !is_same {
                let note = format!("frame of {word}: positions and tool axes turned into that of the part");
                self.course.program.note(note);
            }
            self.course.frame = frame;
            return Ok(());
        }
        if self.named.is_some_and(|named| !frame.is_near(&named)) {
            let problem = "a second coordinate system, and the file does not say in which of them its positions are";
            return Err(self.fail(
                statement,
                problem,
                "one coordinate system for the whole file: write a file for each",
            ));
        }
        if !is_same {
            self.course
                .program
                .note(format!("frame of {word}: positions are taken as those in it, and it as the part's"));
        }
        self.named = Some(frame);
        Ok(())
    }

    /// A new path: the way to its first point is a rapid move.
    fn section(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        self.no_cycle_is_open(statement)?;
        self.course.is_after_change = true;
        Ok(())
    }

    fn tool(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        self.section(statement)?;
        let text = one_line(&format!("{}/{}", statement.word, statement.text()));
        if !self.course.program.tools.contains(&text) {
            self.course.program.tools.push(text);
        }
        Ok(())
    }

    fn cutter(&mut self, statement: &Statement<'_>, form: CutterForm) -> Result<(), InputError> {
        self.numbers(statement, |count| count > 0, "numbers of the tool")?;
        let read = cutter(statement, form, self.unit.metres());
        let moves = self.course.program.moves.len();
        if form == CutterForm::Flutes {
            self.flutes = read.length.map(|length| (length, moves));
        } else {
            self.tool(statement)?;
            self.course.program.change_tool(|last| *last = read.turning_as(last));
        }
        // Of the tool that is named before or behind it, without a move in between.
        if let Some((length, _)) = self.flutes.filter(|(_, from)| *from == moves) {
            self.course.program.change_tool(|tool| (tool.length, tool.is_length_of_flutes) = (Some(length), true));
        }
        Ok(())
    }

    fn offset(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        let given = self.numbers(statement, |count| count <= 1, "the number of a work offset")?.first().copied();
        if self.offset.is_some() && given.is_some() && self.offset != given {
            let problem = "a second work offset, and how the two lie to each other is not in the file";
            return Err(self.fail(statement, problem, "one work offset for the whole file"));
        }
        self.offset = given.or(self.offset);
        Ok(())
    }

    /// The numbers of a statement, so many as are right, finite and not too large.
    fn numbers(
        &self,
        statement: &Statement<'_>,
        is_right: impl Fn(usize) -> bool,
        allowed: &str,
    ) -> Result<Vec<f64>, InputError> {
        let numbers: Vec<f64> = statement.numbers().collect();
        let largest = LARGEST / self.unit.metres();
        if numbers.iter().any(|number| !number.is_finite() || number.abs() > largest) {
            return Err(self.fail(statement, "not finite numbers of a usual size", allowed));
        }
        if !is_right(numbers.len()) {
            let problem = format!("{} numbers that can be read", numbers.len());
            return Err(self.fail(statement, &problem, allowed));
        }
        Ok(numbers)
    }

    fn fail(&self, statement: &Statement<'_>, problem: &str, allowed: &str) -> InputError {
        let found = statement.text();
        let found = if found.is_empty() { statement.word.to_owned() } else { found };
        let word = statement.word.trim_start_matches(['$', '-', '>', '*']);
        self.fail_at(statement.line, word, problem, allowed).found(format!("'{found}'"))
    }

    fn fail_at(&self, line: usize, word: &str, problem: &str, allowed: &str) -> InputError {
        InputError::new(self.file, problem).at_line(line).in_field(word).allowed(allowed)
    }
}
