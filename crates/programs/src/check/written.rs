//! What a program says, whatever its language: moves, with the frames that they are in.

use super::geometry::{Frame, Matrix};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use stead_disk::files;
use stead_disk::input::InputError;

/// One move as written.
#[derive(Debug, Clone)]
pub(super) struct Written {
    pub file: PathBuf,
    /// Line in the file, from 1.
    pub line: usize,
    pub goal: Goal,
    /// Where the external axes go that the move names, in mm and deg.
    pub external: External,
    pub pace: Pace,
}

/// How fast a move is, and how it ends.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Pace {
    /// Speed of the tool, for moves on lines. mm/s
    pub feed: Option<f64>,
    /// How it ends, where the program says.
    pub end: Option<End>,
}

/// How a move ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum End {
    /// With a stop.
    Exact,
    /// The next move begins within this distance. mm
    Within(f64),
    /// The next move begins at this share of the speed, in percent.
    Share(f64),
}

impl std::fmt::Display for End {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Exact => write!(f, "stops exactly"),
            Self::Within(mm) => write!(f, "is blended within {mm} mm"),
            Self::Share(percent) => write!(f, "is blended by CNT{percent}"),
        }
    }
}

/// What linear poses are given in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Base {
    /// A frame in the robot root: it stands still, wherever external axes bring the workpiece.
    Still(Frame),
    /// A frame on the table that the external axes carry.
    OnTable(Frame),
}

/// A move without its place in the file.
pub(super) type Step = (Goal, External, Pace);

/// Positions of external axes E1 to E6, in mm and deg.
pub(super) type External = [Option<f64>; 6];

/// Takes the external axes out of the entries of a move.
pub(super) fn external(entries: &mut BTreeMap<String, f64>) -> External {
    std::array::from_fn(|axis| entries.remove(&format!("E{}", axis + 1)))
}

/// Where a move goes.
#[derive(Debug, Clone, Copy)]
pub(super) enum Goal {
    /// All joints at once to angles of the controller. deg
    Angles([f64; 6]),
    /// On a line to the tool in a base, with this tool on the flange.
    Line { tool: Frame, base: Base, mounted: Frame },
    /// As a table has a move: the tool in the workpiece frame, and angles of the controller where they are known.
    Row { tool: Frame, angles: Option<[f64; 6]>, is_joint: bool },
}

impl Goal {
    /// Whether all joints move at once.
    pub fn is_joint(&self) -> bool {
        matches!(self, Self::Angles(_) | Self::Row { is_joint: true, .. })
    }
}

/// The deepest that parts call parts.
const DEEPEST: usize = 3;
/// The most moves that are read.
const MOST: usize = 20_000_000;

/// The text of a program.
#[derive(Debug, Clone)]
pub(super) struct Source {
    pub file: PathBuf,
    pub text: String,
    /// How deep it is in calls of parts.
    depth: usize,
}

impl Source {
    /// Reads a file.
    ///
    /// # Errors
    /// [`InputError`] where it cannot be read or is no text.
    pub fn read(file: &Path) -> Result<Self, InputError> {
        let fail = |problem: String| InputError::new(file, problem).allowed("a program that `stead export` wrote");
        let bytes = files::read(file).map_err(|cause| fail(format!("cannot be read: {cause}")))?;
        let text = String::from_utf8(bytes).map_err(|_| fail("is not UTF-8 text".to_owned()))?;
        Ok(Self { file: file.to_owned(), text, depth: 0 })
    }

    /// The part that a line calls by a name, where it is that of a part of this program.
    ///
    /// # Errors
    /// [`InputError`] for a part that is not beside this file, or cannot be read.
    pub fn called(&self, line: usize, name: &str) -> Result<Option<Self>, InputError> {
        if !self.is_part(name) {
            return Ok(None);
        }
        match self.part(name) {
            Some(path) if self.depth < DEEPEST => Ok(Some(Self { depth: self.depth + 1, ..Self::read(&path)? })),
            _ => Err(self.error(line, format!("the part {name} is not beside this file"), name)),
        }
    }

    /// A file beside this one, by its name without ending in any case. None where there is none.
    fn part(&self, name: &str) -> Option<PathBuf> {
        let folder = self.file.parent()?;
        let extension = self.file.extension()?;
        [name.to_owned(), name.to_ascii_lowercase()]
            .into_iter()
            .map(|name| folder.join(name).with_extension(extension))
            .find(|path| path.is_file())
            .or_else(|| {
                let wanted = format!("{name}.{}", extension.to_string_lossy()).to_ascii_lowercase();
                let entries =
                    std::fs::read_dir(if folder.as_os_str().is_empty() { Path::new(".") } else { folder }).ok()?;
                let mut paths = entries.filter_map(|entry| entry.ok().map(|entry| entry.path()));
                paths.find(|path| {
                    path.file_name().is_some_and(|name| name.to_string_lossy().to_ascii_lowercase() == wanted)
                })
            })
    }

    /// Whether a name is that of a part of this program.
    fn is_part(&self, name: &str) -> bool {
        let own = self.file.file_stem().map(|stem| stem.to_string_lossy().to_ascii_uppercase()).unwrap_or_default();
        name.to_ascii_uppercase()
            .strip_prefix(&format!("{own}_"))
            .is_some_and(|rest| !rest.is_empty() && rest.chars().all(|c| c.is_ascii_digit()))
    }

    /// What is wrong at a line.
    pub fn error(&self, line: usize, problem: impl Into<String>, found: &str) -> InputError {
        let shown: String = found.trim().chars().take(100).flat_map(char::escape_debug).collect();
        InputError::new(&self.file, problem)
            .at_line(line)
            .found(format!("'{shown}'"))
            .allowed("the statements that `stead export` writes")
    }
}

/// The moves so far.
#[derive(Debug, Default)]
pub(super) struct Moves {
    pub all: Vec<Written>,
}

impl Moves {
    /// Adds a move.
    ///
    /// # Errors
    /// [`InputError`] where there are more than anyone has.
    pub fn push(&mut self, source: &Source, line: usize, step: Step) -> Result<(), InputError> {
        let (goal, external, pace) = step;
        if self.all.len() >= MOST {
            return Err(source.error(line, format!("is beyond {MOST} moves"), ""));
        }
        self.all.push(Written { file: source.file.clone(), line, goal, external, pace });
        Ok(())
    }
}

/// A finite number as programs write it.
pub(super) fn number(text: &str) -> Option<f64> {
    text.trim().parse::<f64>().ok().filter(|value| value.is_finite() && value.abs() <= 1e9)
}

/// `X 1.0, Y -2.0, ..`: names and numbers, each once.
pub(super) fn entries(text: &str) -> Option<BTreeMap<String, f64>> {
    let mut map = BTreeMap::new();
    for entry in text.split(',') {
        let mut words = entry.split_whitespace();
        let (name, value) = (words.next()?, number(words.next()?)?);
        if words.next().is_some() || map.insert(name.to_ascii_uppercase(), value).is_some() {
            return None;
        }
    }
    Some(map)
}

/// The numbers of these names, and of no others.
pub(super) fn exactly<const N: usize>(entries: &BTreeMap<String, f64>, names: [&str; N]) -> Option<[f64; N]> {
    if entries.len() != N {
        return None;
    }
    let mut values = [0.0; N];
    for (value, name) in values.iter_mut().zip(names) {
        *value = *entries.get(name)?;
    }
    Some(values)
}

/// A frame of a position and a turn.
pub(super) fn frame_of(origin: [f64; 3], turn: Matrix) -> Frame {
    Frame { turn, origin }
}
