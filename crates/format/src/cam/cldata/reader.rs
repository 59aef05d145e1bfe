//! The interpreter of CLDATA: what each word of a dialect does to the state of the tool.

mod arcs;
mod points;

use super::super::arc::Arc;
use super::super::course::{Course, Frame, NO_LENGTH};
use super::super::refusals::*;
use super::super::{LARGEST, LengthUnit, Program, ReadSettings};
use super::cutter::cutter;
use super::cycle::Cycle;
use super::dialect::{CYCLES_TAKEN, CutterForm, Dialect, Effect, Ending, FEEDS, FrameForm};
use super::statement::Statement;
use arcs::Pending;
use nalgebra::{Matrix3, Rotation3, Vector3};
use stead_disk::input::InputError;
use stead_disk::quote::one_line;

/// Directions of a frame may be this far from unit length and right angles: digits as printed.
const FRAME_ROUNDING: f64 = 1e-3;
/// An unknown word with so many numbers may hold a position, a direction or a frame.
const NUMBERS_OF_A_PLACE: usize = 3;

/// Reads statements into moves.
pub(super) struct Reader<'a> {
    dialect: &'static Dialect,
    settings: &'a ReadSettings,
    unit: LengthUnit,
    course: Course,
    state: State,
}

/// What holds until another word beside the place of the tool.
#[derive(Default)]
struct State {
    /// rev/s
    spindle: Option<f64>,
    is_rapid: bool,
    /// Whether `MULTAX/OFF` holds.
    is_three_axis: bool,
    /// The frame that the file names as that of its positions, where it is not applied.
    named: Option<Frame>,
    offset: Option<f64>,
    /// An arc that the next point ends.
    pending: Option<Pending>,
    /// The way out of the next arc, in the workpiece frame.
    tangent: Option<Vector3<f64>>,
    /// The arc whose circle the next points may lie on, where the dialect has such, and what it rises in a turn of 1
    /// rad. m
    circle: Option<(Arc, f64)>,
    /// A cycle that is open, nothing of it where its holes are left out, with its line.
    holes: Option<(Option<Cycle>, usize)>,
    /// Length of flutes (m) that is stated before any move from this one on.
    flutes: Option<(f64, usize)>,
    is_ended: bool,
}

impl<'a> Reader<'a> {
    pub fn new(dialect: &'static Dialect, unit: LengthUnit, settings: &'a ReadSettings) -> Self {
        let mut course = Course::new(settings.resampling);
        (course.is_after_change, course.program.format) = (true, dialect.format);
        Self { dialect, settings, unit, course, state: State::default() }
    }

    /// Takes a statement; false after the one that ends the program.
    pub fn take(&mut self, statement: &Statement<'_>) -> Result<bool, InputError> {
        let Some(effect) = self.effect(statement)? else { return Ok(true) };
        let is_move = matches!(effect, Effect::Move(_));
        if let (Some(pending), false) = (&self.state.pending, is_move || effect == Effect::Feed) {
            return Err(statement.fail(within_arc(pending.line)));
        }
        if !is_move {
            self.state.circle = None;
        }
        match effect {
            Effect::Move(ends) => self.goto(statement, ends)?,
            Effect::Rapid => self.state.is_rapid = true,
            Effect::Arc(form) => self.arc(statement, form)?,
            Effect::Tangent => self.state.tangent = Some(self.course.frame.rotation * self.direction(statement)?),
            Effect::Frame(form) => self.frame(statement, form)?,
            Effect::NoFrame => {
                ensure!(statement.numbers().all(|number| number == 0.0), statement.fail(ANOTHER_ORIGIN));
            }
            Effect::Axis => self.course.axis = self.direction(statement)?,
            Effect::Axes => self.state.is_three_axis = statement.has("OFF"),
            Effect::Feed => self.fedrat(statement)?,
            Effect::Spindle => self.spindl(statement),
            Effect::Cutter(form) => self.cutter(statement, form)?,
            Effect::Tool => self.tool(statement)?,
            Effect::Section => self.section(statement)?,
            Effect::Cycle => self.cycle(statement)?,
            Effect::Compensation if statement.has("OFF") || statement.has("LENGTH") => {}
            Effect::Compensation => {
                self.course.program.note("CUTCOM: the points are taken as those of the tool centre", statement.line);
            }
            Effect::Offset => self.offset(statement)?,
            Effect::Mode => {
                let counts_on = ["INCR", "INCREM", "INC", "DELTA"].iter().any(|word| statement.has(word));
                ensure!(!counts_on, statement.fail(COUNTS_ON));
            }
            Effect::Unit => {}
            Effect::Text | Effect::Nothing => {
                self.course.program.passed_over.entry(name_of(statement)).or_default().at(statement.line);
            }
            Effect::Refused(why) => return Err(statement.fail(not_read(why, &name_of(statement)))),
            Effect::End(ending) => {
                self.state.is_ended = true;
                return Ok(ending == Ending::Path);
            }
        }
        Ok(true)
    }

    /// What a statement does by its dialect; nothing where its word is ignored, or one that nobody knows.
    fn effect(&mut self, statement: &Statement<'_>) -> Result<Option<Effect>, InputError> {
        let (known, program) = (self.dialect.effect(statement.word), &mut self.course.program);
        if self.settings.ignore.iter().any(|own| own.eq_ignore_ascii_case(statement.word)) {
            let is_path = matches!(known, Some(Effect::Move(_) | Effect::Rapid | Effect::Arc(_) | Effect::End(_)));
            ensure!(!is_path, statement.fail(IGNORED_PATH));
            program.note(format!("{} passed over, as asked (--ignore)", name_of(statement)), statement.line);
            return Ok(None);
        }
        if known.is_none() {
            let (name, count) = (name_of(statement), statement.numbers().count());
            ensure!(count < NUMBERS_OF_A_PLACE, statement.fail(not_known(count, &name)));
            program.note(format!("not known, taken not to move the tool: {name}"), statement.line);
        }
        Ok(known)
    }

    /// The program, when the file is at its end.
    pub fn finish(self, last: &Statement<'_>) -> Result<Program, InputError> {
        ensure!(self.state.pending.is_none(), last.fail(HALF_AN_ARC));
        let mut program = self.course.program;
        if !self.state.is_ended {
            program.note("no FINI and no END-OF-PATH: the file may be cut short", last.line);
        }
        Ok(program)
    }

    /// A direction of the file, of unit length.
    fn direction(&self, statement: &Statement<'_>) -> Result<Vector3<f64>, InputError> {
        let given = self.numbers(statement, &[3], NO_DIRECTION.1)?;
        let direction = Vector3::from_column_slice(&given).try_normalize(NO_LENGTH);
        direction.ok_or_else(|| statement.fail(NO_DIRECTION))
    }

    fn cycle(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        let first = statement.words().next().unwrap_or_default();
        let is_none = ["OFF", "END", "INIT", "CLEAR"].iter().any(|word| first.eq_ignore_ascii_case(word));
        let mut cycle = None;
        if !is_none && !self.settings.skip_cycles {
            self.numbers(statement, &[], CYCLES_TAKEN)?;
            cycle = Cycle::of(statement, self.dialect.hole_depth);
            ensure!(cycle.is_some(), statement.fail((ANOTHER_CYCLE, CYCLES_TAKEN)));
        }
        self.state.holes = (!is_none).then_some((cycle, statement.line));
        Ok(())
    }

    /// Refuses what begins while a cycle is open: holes may follow, or cuts.
    fn no_cycle_is_open(&self, statement: &Statement<'_>) -> Result<(), InputError> {
        self.state.holes.as_ref().map_or(Ok(()), |(_, line)| Err(statement.fail(cycle_is_open(*line))))
    }

    fn fedrat(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        let value = self.numbers(statement, &[1], NUMBERS_OF_FEED)?[0];
        ensure!(value > 0.0, statement.fail(NOT_A_FEED));
        // No unit of feed is two words.
        let mut word = statement.worded();
        if word.is_empty() {
            let note = format!("FEDRAT without a unit, taken in {} per minute", self.unit.word());
            self.course.program.note(note, statement.line);
            word.push_str("PERMIN");
        }
        self.course.feed = Some(self.feed_in(statement, value, &word)?);
        Ok(())
    }

    /// A feed in the unit of a word. m/s
    fn feed_in(&self, statement: &Statement<'_>, value: f64, word: &str) -> Result<f64, InputError> {
        let known = FEEDS.iter().find(|(own, ..)| own.eq_ignore_ascii_case(word));
        let (_, unit, is_per_turn) = known.ok_or_else(|| statement.fail(NOT_A_FEED_UNIT))?;
        let length = value * unit.unwrap_or(self.unit).metres();
        let speed = if *is_per_turn { self.state.spindle } else { None };
        ensure!(speed.is_some() || !is_per_turn, statement.fail(NO_SPEED));
        Ok(speed.map_or(length / 60.0, |speed| length * speed))
    }

    fn spindl(&mut self, statement: &Statement<'_>) {
        let is_surface_speed = statement.has("SFM") || statement.has("SMM");
        if let Some(speed) = statement.numbers().next() {
            self.state.spindle = (speed > 0.0 && speed.is_finite() && !is_surface_speed).then_some(speed / 60.0);
        }
        let speed = self.state.spindle;
        self.course.program.change_tool(|tool| {
            tool.spindle_speed = speed;
            tool.is_counterclockwise = statement.has("CCLW") || (tool.is_counterclockwise && !statement.has("CLW"));
        });
    }

    fn frame(&mut self, statement: &Statement<'_>, form: FrameForm) -> Result<(), InputError> {
        let given = self.numbers(statement, form.counts, form.allowed)?;
        let at = |places: [usize; 3]| Vector3::from(places.map(|place| given[place]));
        let mut rotation = Matrix3::identity();
        if given.len() > 3 {
            let (x, y, z) = (at(form.x), form.y.map(at), form.z.map(at));
            let y = y.or(z.map(|z| z.cross(&x))).unwrap_or_default();
            rotation = Matrix3::from_columns(&[x, y, z.unwrap_or(x.cross(&y))]);
        }
        let off = (rotation.tr_mul(&rotation) - Matrix3::identity()).abs().max();
        let is_rotation = off < FRAME_ROUNDING && rotation.determinant() > 0.0;
        ensure!(is_rotation, statement.fail(NO_ROTATION));
        if form.is_in_comments_below {
            self.section(statement)?;
        }
        let x = rotation.column(0).normalize();
        let z = x.cross(&rotation.column(1)).normalize();
        let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, z.cross(&x), z]));
        let frame = Frame { rotation, origin: at(form.origin) * self.unit.metres() };
        let is_applied = self.dialect.applies_frames;
        if !frame.is_near(&self.course.frame) {
            let what = if is_applied { FRAME_APPLIED } else { FRAME_NAMED };
            self.course.program.note(format!("frame of {}: {what}", statement.name()), statement.line);
        }
        let named = if is_applied { &mut self.course.frame } else { self.state.named.get_or_insert(frame) };
        ensure!(is_applied || frame.is_near(named), statement.fail(SECOND_FRAME));
        *named = frame;
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
        self.course.program.name_tool(one_line(&format!("{}/{}", statement.name(), statement.text())));
        Ok(())
    }

    fn cutter(&mut self, statement: &Statement<'_>, form: CutterForm) -> Result<(), InputError> {
        ensure!(!self.numbers(statement, &[], NO_CUTTER.1)?.is_empty(), statement.fail(NO_CUTTER));
        let read = cutter(statement, form, self.unit.metres());
        let moves = self.course.program.moves.len();
        if form == CutterForm::Flutes {
            self.state.flutes = read.length.map(|length| (length, moves));
        } else {
            self.tool(statement)?;
            self.course.program.change_tool(|last| *last = read.turning_as(last));
        }
        // Of the tool that is named before or behind it, without a move in between.
        if let Some((length, _)) = self.state.flutes.filter(|(_, from)| *from == moves) {
            self.course.program.change_tool(|tool| (tool.length, tool.is_length_of_flutes) = (Some(length), true));
        }
        Ok(())
    }

    fn offset(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        let given = self.numbers(statement, &[0, 1], SECOND_OFFSET.1)?.first().copied();
        let offset = *self.state.offset.get_or_insert(given.unwrap_or_default());
        ensure!(given.is_none_or(|given| given == offset), statement.fail(SECOND_OFFSET));
        Ok(())
    }

    /// The numbers of a statement, so many as one of some counts or as there are, finite and not too large.
    fn numbers(&self, statement: &Statement<'_>, counts: &[usize], allowed: &str) -> Result<Vec<f64>, InputError> {
        let numbers: Vec<f64> = statement.numbers().collect();
        let largest = LARGEST / self.unit.metres();
        ensure!(numbers.iter().all(|number| number.abs() <= largest), statement.fail((NOT_USUAL, allowed)));
        ensure!(counts.is_empty() || counts.contains(&numbers.len()), statement.fail((statement.counted(), allowed)));
        Ok(numbers)
    }
}

/// The word of a statement, for messages.
fn name_of(statement: &Statement<'_>) -> String {
    one_line(&statement.name().to_ascii_uppercase())
}
