//! The modal state of CLDATA, statement by statement.

use super::super::arc::{Arc, ArcError, MISSED};
use super::super::{LARGEST, LengthUnit, Move, Program, Resampling};
use super::statement::Statement;
use super::words::moves_unknown;
use crate::input::InputError;
use nalgebra::{Matrix3, Vector3};
use std::path::Path;

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
    line: usize,
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
    is_ended: bool,
}

impl<'a> Reader<'a> {
    pub fn new(file: &'a Path, unit: LengthUnit, resampling: Resampling) -> Self {
        Self {
            file,
            unit,
            resampling,
            program: Program::default(),
            rotation: Matrix3::identity(),
            origin: Vector3::zeros(),
            axis: Vector3::z(),
            feed: None,
            spindle: None,
            is_rapid: false,
            is_after_change: true,
            pending: None,
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
            "CYCLE" if statement.has("OFF") => {}
            "TOOL PATH" => self.is_after_change = true,
            "LOAD" | "LOADTL" => self.tool(statement),
            "TLDATA" | "CUTTER" => {
                self.numbers(statement, |count| count > 0, "numbers of the tool")?;
                self.tool(statement);
            }
            "END-OF-PATH" => self.is_ended = true,
            "FINI" => {
                self.is_ended = true;
                return Ok(false);
            }
            word if word == "CYCLE" || moves_unknown(word) => {
                return Err(self.fail(
                    statement,
                    "moves the tool, or what positions count from, in a way that is not known here",
                    "GOTO, RAPID, CIRCLE and FROM: let the CAM system write straight moves and arcs",
                ));
            }
            _ => *self.program.passed_over.entry(word).or_default() += 1,
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
        } else {
            if self.is_after_change && !self.is_rapid && !self.program.moves.is_empty() && statement.word != "FROM" {
                self.program.note("first moves of a tool or tool path, taken as rapid ones though RAPID is not there");
            }
            self.program.moves.push(end);
        }
        (self.is_rapid, self.is_after_change) = (false, false);
        Ok(())
    }

    fn arc(&mut self, statement: &Statement<'_>, pending: &Pending, end: Move) -> Result<(), InputError> {
        let start = match self.program.moves.last() {
            Some(start) if !self.is_after_change => start,
            _ => return Err(self.fail(statement, "an arc without a start", "a GOTO before CIRCLE")),
        };
        if self.is_rapid {
            return Err(self.fail(statement, "RAPID and CIRCLE for the same move", "an arc as a cutting move"));
        }
        let Pending { centre, axis, radius, .. } = *pending;
        let (from, last) = (start.axis, start.position);
        let arc = Arc { start: last, end: end.position, centre, axis, more_turns: 0 };
        let millimetres = |length: f64| format!("{:.4} mm", length * 1e3);
        if let (Some(stated), Some(found)) = (radius, arc.radius())
            && (stated - found).abs() > MISSED
        {
            let problem =
                format!("the arc misses its start: radius {}, stated {}", millimetres(found), millimetres(stated));
            return Err(self.fail(statement, &problem, "the same radius within 0.05 mm"));
        }
        if arc.rise().abs() > MISSED {
            let problem =
                format!("the arc misses its end, which is {} out of its plane", millimetres(arc.rise().abs()));
            return Err(self.fail(statement, &problem, "an end in the plane of the arc within 0.05 mm"));
        }
        let points = arc.points(&self.resampling).map_err(|error| match error {
            ArcError::Axis => self.fail(statement, "the axis of the arc has no length", "a direction, as 0,0,1"),
            ArcError::Radius(from, to) => {
                let problem = format!(
                    "the arc misses its end: radius {} at its start, {} there",
                    millimetres(from),
                    millimetres(to)
                );
                self.fail(statement, &problem, "the same radius, above 0, within 0.05 mm")
            }
        })?;
        let count = points.len() as f64;
        self.program.moves.extend(points.into_iter().zip(1..).map(|(position, place): (_, u32)| {
            let share = f64::from(place) / count;
            let axis = (from * (1.0 - share) + end.axis * share).try_normalize(NO_LENGTH).unwrap_or(end.axis);
            Move { position, axis, is_arc: true, ..end }
        }));
        Ok(())
    }

    fn circle(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        if statement.words().next().is_some() {
            return Err(self.fail(statement, "an arc with words, as a helix has", "CIRCLE with 6 or 11 numbers alone"));
        }
        let given = self.numbers(statement, |count| count == 6 || count == 11, "6 or 11 finite numbers")?;
        self.pending = Some(Pending {
            centre: self.place(Vector3::new(given[0], given[1], given[2])),
            axis: self.rotation * Vector3::new(given[3], given[4], given[5]),
            radius: given.get(6).map(|radius| radius * self.unit.metres()),
            line: statement.line,
        });
        Ok(())
    }

    fn fedrat(&mut self, statement: &Statement<'_>) -> Result<(), InputError> {
        let given = self.numbers(statement, |count| count == 1, "one feed above 0 and its unit")?;
        let value = given[0];
        if value <= 0.0 {
            return Err(self.fail(statement, "not a feed", "a feed above 0"));
        }
        let mut per_revolution = false;
        let mut unit = self.unit;
        for word in statement.words() {
            let word = word.to_ascii_uppercase();
            (unit, per_revolution) = match &word[..] {
                "MMPM" => (LengthUnit::Millimetre, false),
                "IPM" => (LengthUnit::Inch, false),
                "MMPR" => (LengthUnit::Millimetre, true),
                "IPR" => (LengthUnit::Inch, true),
                "PERMIN" => (self.unit, false),
                "PERREV" => (self.unit, true),
                _ => {
                    return Err(self.fail(statement, "not a unit of feed", "MMPM, IPM, MMPR, IPR, PERMIN or PERREV"));
                }
            };
        }
        let length = value * unit.metres();
        self.feed = Some(match (per_revolution, self.spindle) {
            (false, _) => length / 60.0,
            (true, Some(speed)) => length * speed,
            (true, None) => {
                return Err(self.fail(
                    statement,
                    "a feed per revolution without a spindle speed",
                    "SPINDL with RPM before",
                ));
            }
        });
        Ok(())
    }

    fn spindl(&mut self, statement: &Statement<'_>) {
        let is_surface_speed = ["SFM", "SMM"].iter().any(|word| statement.has(word));
        if let Some(speed) = statement.numbers().next() {
            self.spindle = (speed > 0.0 && speed.is_finite() && !is_surface_speed).then_some(speed / 60.0);
        }
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
        let text = format!("{}/{}", statement.word, statement.text());
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
        let has_words =
            is_one_of(statement.word, &["GOTO", "FROM", "MSYS", "CSYS"]) && statement.words().next().is_some();
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
