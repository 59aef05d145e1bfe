//! The modal state of CLDATA, statement by statement.

mod arcs;

use super::super::{LARGEST, LengthUnit, Move, Program, ReadSettings, Resampling};
use super::cutter::cutter;
use super::cycle::{Cycle, FORMS};
use super::statement::Statement;
use super::words::is_harmless;
use nalgebra::{Matrix3, Vector3};
use std::path::Path;
use stead_disk::input::InputError;
use stead_disk::quote::one_line;

/// Directions of a frame may be this far from unit length and right angles: digits as printed.
const FRAME_ROUNDING: f64 = 1e-3;
/// A tool axis is shorter than this is none.
const NO_LENGTH: f64 = 1e-6;

/// An arc that the next GOTO ends.
#[derive(Clone, Copy)]
struct Pending {
    centre: Vector3<f64>,
    axis: Vector3<f64>,
    radius: Option<f64>,
    /// Whole turns of a helix.
    turns: Option<u32>,
    line: usize,
}

/// Moves that meet at more than this turn back. cos
const TURNED_BACK: f64 = -0.9;
/// The most turns of a helix.
const MOST_TURNS: f64 = 1000.0;

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
    unit: LengthUnit,
    resampling: Resampling,
    program: Program,
    rotation: Matrix3<f64>,
    origin: Vector3<f64>,
    /// Tool axis as last stated, in the frame of the file.
    axis: Vector3<f64>,
    feed: Option<f64>,
    /// rev/s
    spindle: Option<f64>,
    is_rapid: bool,
    is_after_change: bool,
    pending: Option<Pending>,
    holes: Option<Holes>,
    skips_cycles: bool,
    /// Direction in which the last cutting move has arrived.
    arrived: Option<Vector3<f64>>,
    /// The line of the last arc, where it set out against the move before it.
    against: Option<usize>,
    is_ended: bool,
}

impl<'a> Reader<'a> {
    pub fn new(file: &'a Path, unit: LengthUnit, settings: &ReadSettings) -> Self {
        Self {
            file,
            unit,
            resampling: settings.resampling,
            program: Program::default(),
            rotation: Matrix3::identity(),
            origin: Vector3::zeros(),
            axis: Vector3::z(),
            feed: None,
            spindle: None,
            is_rapid: false,
            is_after_change: true,
            pending: None,
            holes: None,
            skips_cycles: settings.skip_cycles,
            arrived: None,
            against: None,
            is_ended: false,
        }
    }

    /// Takes a statement; false after the one that ends the program.
    pub fn take(&mut self, statement: &Statement<'_>) -> Result<bool, InputError> {
        if let (Some(pending), false) = (self.pending, is_one_of(statement.word, &["GOTO", "FEDRAT"])) {
            return Err(self.fail_at(
                pending.line,
                "CIRCLE",
                "is not followed by its end",
                "a GOTO behind each CIRCLE",
            ));
        }
        let word = statement.word.to_ascii_uppercase();
        match &word[..] {
            "GOTO" => self.goto(statement)?,
            "FROM" => {
                self.is_after_change = true;
                self.goto(statement)?;
            }
            "GOHOME" => self.go_home(statement)?,
            "RAPID" => self.is_rapid = true,
            "CIRCLE" => self.circle(statement)?,
            "FEDRAT" => self.fedrat(statement)?,
            "SPINDL" => self.spindl(statement),
            "MSYS" => self.msys(statement)?,
            "CSYS" => self.csys(statement)?,
            "UNIT" | "UNITS" | "MULTAX" => {}
            "CUTCOM" if !statement.has("OFF") => {
                self.program.note("CUTCOM: the points are taken as those of the tool centre");
            }
            "CUTCOM" => {}
            "CYCLE" => self.cycle(statement)?,
            "MODE" if ["ABSOL", "ABS"].iter().any(|word| statement.has(word)) => {}
            "TRNTYP" if statement.numbers().all(|number| number == 0.0) => {}
            "TRNTYP" => {
                let allowed = "TRNTYP without an origin: let the CAM system write positions in the frame of the part";
                return Err(self.fail(statement, "an origin other than 0,0,0", allowed));
            }
            "TOOL PATH" => self.is_after_change = true,
            "LOAD" | "LOADTL" | "TOOLNO" | "TURRET" | "UNLOAD" => self.tool(statement),
            "TLDATA" | "CUTTER" => {
                self.numbers(statement, |count| count > 0, "numbers of the tool")?;
                self.tool(statement);
                let tool = cutter(statement, self.unit.metres());
                self.program.change_tool(|last| *last = tool.turning_as(last));
            }
            "END-OF-PATH" => self.is_ended = true,
            "FINI" => {
                self.is_ended = true;
                return Ok(false);
            }
            word if is_harmless(word) => {
                if word == "INSERT" {
                    self.program.note("INSERT: text for the post-processor, whatever it does");
                }
                *self.program.passed_over.entry(one_line(word)).or_default() += 1;
            }
            _ => {
                return Err(self.fail(
                    statement,
                    "may move the tool, or what its positions count from, in a way that is not known here",
                    "GOTO, RAPID, CIRCLE, FROM and drilling cycles: let the CAM system write straight moves and arcs",
                ));
            }
        }
        Ok(true)
    }

    /// The program, when the file is at its end.
    pub fn finish(mut self, last: &Statement<'_>) -> Result<Program, InputError> {
        if self.pending.is_some() {
            return Err(self.fail(last, "the file ends before the end of the arc", "a GOTO behind each CIRCLE"));
        }
        if !self.is_ended {
            self.program.note("no FINI and no END-OF-PATH: the file may be cut short");
        }
        Ok(self.program)
    }

    fn goto(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        let given = self.numbers(statement, |count| count == 3 || count == 6, "3 or 6 finite numbers")?;
        if let [_, _, _, i, j, k] = given[..] {
            let axis = Vector3::new(i, j, k);
            let length = axis.norm();
            if length < NO_LENGTH {
                return Err(self.fail(statement, "the tool axis has no length", "a direction, as 0,0,1"));
            }
            if (length - 1.0).abs() > FRAME_ROUNDING {
                self.program.note("tool axes made of unit length");
            }
            self.axis = axis / length;
        }
        let end = Move {
            position: self.place(Vector3::new(given[0], given[1], given[2])),
            axis: self.rotation * self.axis,
            feed: self.feed,
            is_rapid: self.is_rapid || self.is_after_change,
            is_arc: false,
            line: statement.line,
        };
        if let Some(pending) = self.pending.take() {
            self.arc(statement, &pending, end)?;
        } else if let (Some(holes), false) = (&self.holes, statement.word.eq_ignore_ascii_case("FROM")) {
            match holes {
                Holes::Drilled(cycle) => {
                    let unit = self.unit.metres();
                    let above = |height: f64| end.position + end.axis * (height * unit);
                    let feed = match &cycle.feed {
                        Some((value, word)) => Some(self.feed_in(statement, *value, word)?),
                        None => self.feed,
                    };
                    self.program.moves.extend([
                        Move { position: above(cycle.clear), is_rapid: true, ..end },
                        Move { position: above(-cycle.depth), is_rapid: false, feed, ..end },
                        Move { position: above(cycle.retract), is_rapid: true, ..end },
                    ]);
                    self.program.note("holes of drilling cycles taken as a plunge and a rapid retract, not scored");
                    (self.is_rapid, self.is_after_change) = (false, false);
                }
                Holes::LeftOut => {
                    self.program.holes_left_out.push((end.position, statement.line));
                    self.is_after_change = true;
                }
            }
            (self.arrived, self.against) = (None, None);
            return Ok(());
        } else {
            if self.is_after_change && !self.is_rapid && !self.program.moves.is_empty() && statement.word != "FROM" {
                self.program.note("first moves of a tool or tool path, taken as rapid ones though RAPID is not there");
            }
            let way = self.program.moves.last().map(|last| end.position - last.position);
            let way = way.filter(|_| !end.is_rapid).and_then(|way| way.try_normalize(1e-9));
            self.goes_on(way)?;
            self.arrived = way;
            self.program.moves.push(end);
        }
        (self.is_rapid, self.is_after_change) = (false, false);
        Ok(())
    }

    /// A rapid move home, or to where nothing is known of.
    fn go_home(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        if statement.numbers().next().is_some() {
            self.is_rapid = true;
            self.goto(statement)?;
        }
        self.is_after_change = true;
        Ok(())
    }

    fn cycle(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        self.holes = if statement.has("OFF") || statement.has("END") {
            None
        } else if self.skips_cycles {
            Some(Holes::LeftOut)
        } else {
            self.numbers(statement, |_| true, FORMS)?;
            let cycle = Cycle::of(statement);
            let problem = "a cycle whose moves are not known here";
            Some(Holes::Drilled(cycle.ok_or_else(|| self.fail(statement, problem, FORMS))?))
        };
        Ok(())
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
                self.program.note(format!("FEDRAT without a unit, taken in {} per minute", self.unit.word()));
                "PERMIN"
            }
            [word] => word,
            _ => return Err(self.fail(statement, "not one unit of feed", FEED_UNITS)),
        };
        self.feed = Some(self.feed_in(statement, value, word)?);
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
        self.program.change_tool(|tool| {
            tool.spindle_speed = speed;
            tool.is_counterclockwise = statement.has("CCLW") || (tool.is_counterclockwise && !statement.has("CLW"));
        });
    }

    fn msys(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        let given = self.numbers(statement, |count| count == 9, "9 numbers: origin, x axis, y axis")?;
        let [x, y] = [3, 6].map(|k| Vector3::new(given[k], given[k + 1], given[k + 2]));
        let origin = Vector3::new(given[0], given[1], given[2]);
        self.set_frame(statement, origin, Matrix3::from_columns(&[x, y, x.cross(&y)]))
    }

    fn csys(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        let given =
            self.numbers(statement, |count| count == 12, "12 numbers: three rows of a rotation and an origin")?;
        let at = |row: usize, column: usize| given[4 * row + column];
        let origin = Vector3::from_fn(|row, _| at(row, 3));
        self.set_frame(statement, origin, Matrix3::from_fn(at))
    }

    fn set_frame(
        &mut self,
        statement: &Statement<'_>,
        origin: Vector3<f64>,
        rotation: Matrix3<f64>,
    ) -> Result<(), InputError> {
        let off = (rotation.tr_mul(&rotation) - Matrix3::identity()).abs().max();
        if off > FRAME_ROUNDING || rotation.determinant() < 0.0 {
            let allowed = "unit vectors at right angles, right-handed";
            return Err(self.fail(statement, "the axes of the frame are no rotation", allowed));
        }
        let x = rotation.column(0).normalize();
        let z = x.cross(&rotation.column(1)).normalize();
        let rotation = Matrix3::from_columns(&[x, z.cross(&x), z]);
        let origin = origin * self.unit.metres();
        let is_same = (rotation - self.rotation).abs().max() < 1e-9 && (origin - self.origin).norm() < 1e-9;
        if !is_same {
            self.program.note(format!("{}: positions and tool axes turned into the frame of the part", statement.word));
        }
        (self.rotation, self.origin) = (rotation, origin);
        Ok(())
    }

    fn tool(&mut self, statement: &Statement<'_>) {
        self.is_after_change = true;
        let text = one_line(&format!("{}/{}", statement.word, statement.text()));
        if !self.program.tools.contains(&text) {
            self.program.tools.push(text);
        }
    }

    /// A position of the file in the workpiece frame. m
    fn place(&self, position: Vector3<f64>) -> Vector3<f64> {
        self.origin + self.rotation * position * self.unit.metres()
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
        let has_words = is_one_of(statement.word, &["GOTO", "FROM", "GOHOME", "MSYS", "CSYS"])
            && statement.words().next().is_some();
        if !is_right(numbers.len()) || has_words {
            let problem = format!("{} numbers that can be read", numbers.len());
            return Err(self.fail(statement, &problem, allowed));
        }
        Ok(numbers)
    }

    fn fail(&self, statement: &Statement<'_>, problem: &str, allowed: &str) -> InputError {
        let found = statement.text();
        let found = if found.is_empty() { statement.word.to_owned() } else { found };
        self.fail_at(statement.line, statement.word, problem, allowed).found(format!("'{found}'"))
    }

    fn fail_at(&self, line: usize, word: &str, problem: &str, allowed: &str) -> InputError {
        InputError::new(self.file, problem).at_line(line).in_field(word).allowed(allowed)
    }
}

fn is_one_of(word: &str, words: &[&str]) -> bool {
    words.iter().any(|one| word.eq_ignore_ascii_case(one))
}
