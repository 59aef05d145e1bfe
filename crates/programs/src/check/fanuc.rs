//! TP programs: `J P[n]`, `L P[n]`, their positions, the frames in remarks, calls of parts.

use super::geometry::{Frame, turned_xyz};
use super::written::{Base, End, External, Goal, Moves, Pace, Source, Step, external, frame_of, number};
use std::collections::BTreeMap;
use stead_disk::input::InputError;

/// Words that begin a statement whose effect on the path is not understood.
const NOT_UNDERSTOOD: [&str; 11] = ["A", "C", "S", "IF", "FOR", "JMP", "LBL", "SELECT", "OFFSET", "TOOL_OFFSET", "PR"];

/// A position of the program.
#[derive(Debug, Clone, Copy)]
enum Position {
    Angles([f64; 6]),
    Pose(Frame),
}

/// A position with its external axes and the numbers of its frames.
type Placed = (Position, External, [u32; 2]);

/// The moves of a program and its parts.
///
/// # Errors
/// [`InputError`] with file and line for a statement that moves the robot and is not understood.
pub(super) fn moves(source: &Source) -> Result<Moves, InputError> {
    let mut moves = Moves::default();
    read(source, &mut moves)?;
    Ok(moves)
}

/// The frames that remarks state: key by key.
#[derive(Debug, Default)]
struct Remarks(BTreeMap<String, f64>);

impl Remarks {
    /// `UFRAME 9 X 12.5`.
    fn take(&mut self, remark: &str) {
        let words: Vec<&str> = remark.split_whitespace().collect();
        if let [name @ ("UFRAME" | "UTOOL"), index, key, value] = words[..]
            && let Some(value) = number(value)
        {
            self.0.insert(format!("{name} {index} {key}"), value);
        }
    }

    fn frame(&self, name: &str, index: u32) -> Option<Frame> {
        let get = |key: &str| self.0.get(&format!("{name} {index} {key}")).copied();
        Some(frame_of([get("X")?, get("Y")?, get("Z")?], turned_xyz(get("W")?, get("P")?, get("R")?)))
    }
}

/// The positions of a program, and the frames that it has come to.
struct State {
    positions: BTreeMap<u32, Placed>,
    remarks: Remarks,
    /// UFRAME_NUM and UTOOL_NUM.
    numbers: [Option<u32>; 2],
}

fn read(source: &Source, moves: &mut Moves) -> Result<(), InputError> {
    let mut state = State { positions: positions(source)?, remarks: Remarks::default(), numbers: [None; 2] };
    let mut in_program = false;
    for (index, whole) in source.text.lines().enumerate() {
        let line = index + 1;
        match whole.trim() {
            "/MN" => in_program = true,
            "/POS" => return Ok(()),
            _ => {}
        }
        let Some((_, statement)) = whole.split_once(':').filter(|_| in_program) else { continue };
        let statement = statement.trim().trim_end_matches(';').trim();
        if let Some(remark) = statement.strip_prefix('!') {
            state.remarks.take(remark);
            continue;
        }
        let word = statement.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).next().unwrap_or_default();
        let set = || statement.split('=').nth(1).and_then(|text| text.trim().parse().ok());
        match word {
            "UFRAME_NUM" => state.numbers[0] = set(),
            "UTOOL_NUM" => state.numbers[1] = set(),
            "J" | "L" => moves.push(source, line, state.goal(source, line, statement, word)?)?,
            "CALL" => {
                if let Some(part) = source.called(line, statement["CALL".len()..].trim())? {
                    read(&part, moves)?;
                }
            }
            word if NOT_UNDERSTOOD.contains(&word) => {
                return Err(source.error(line, "is not understood, and may move the robot elsewhere", whole));
            }
            _ => {}
        }
    }
    Err(source.error(source.text.lines().count().max(1), "ends without its positions (/POS)", ""))
}

impl State {
    /// The goal of `J P[n]` or `L P[n]`.
    fn goal(&self, source: &Source, line: usize, statement: &str, word: &str) -> Result<Step, InputError> {
        let wrong = |problem: &str| source.error(line, problem, statement);
        let inside = statement.split_once("P[").and_then(|(_, rest)| rest.split_once(']'));
        let index = inside.and_then(|(number, _)| number.parse::<u32>().ok());
        if ["Offset", "VOFFSET", "PTH", "INC"].iter().any(|option| statement.contains(option)) {
            return Err(wrong("has an option that moves the robot elsewhere"));
        }
        let Some((position, external, of)) = index.and_then(|index| self.positions.get(&index)) else {
            return Err(wrong("names no position of this program"));
        };
        let words: Vec<&str> =
            statement.split_once(']').map(|(_, rest)| rest.split_whitespace().collect()).unwrap_or_default();
        let [speed, end] = words[..] else { return Err(wrong("is no move L P[n] .. mm/sec FINE or CNT..")) };
        let end = match end.strip_prefix("CNT").map(number) {
            None if end == "FINE" => End::Exact,
            Some(Some(share)) => End::Share(share),
            _ => return Err(wrong("ends in another way than FINE or CNT..")),
        };
        let pace = Pace { feed: speed.strip_suffix("mm/sec").and_then(number), end: Some(end) };
        match (word, position) {
            ("J", Position::Angles(angles)) if end == End::Exact => Ok((Goal::Angles(*angles), *external, pace)),
            ("L", Position::Pose(tool)) => {
                if self.numbers != of.map(Some) {
                    return Err(wrong("goes to a position of other frames than UFRAME_NUM and UTOOL_NUM"));
                }
                let frames = [self.remarks.frame("UFRAME", of[0]), self.remarks.frame("UTOOL", of[1])];
                let [Some(base), Some(mounted)] = frames else {
                    return Err(wrong("moves before the remarks state UFRAME and UTOOL"));
                };
                if pace.feed.is_none() {
                    return Err(wrong("has no speed in mm/sec"));
                }
                Ok((Goal::Line { tool: *tool, base: Base::Still(base), mounted }, *external, pace))
            }
            _ => Err(wrong("goes to a position of the other kind, or is a joint move that does not stop")),
        }
    }
}

/// All positions of a program with the numbers of their frames.
fn positions(source: &Source) -> Result<BTreeMap<u32, Placed>, InputError> {
    let mut positions = BTreeMap::new();
    let mut open: Option<(u32, usize, String)> = None;
    for (index, whole) in source.text.lines().enumerate().skip_while(|(_, whole)| whole.trim() != "/POS").skip(1) {
        let text = whole.trim();
        match &mut open {
            None => {
                let number =
                    text.strip_prefix("P[").and_then(|rest| rest.strip_suffix("]{")).and_then(|n| n.parse().ok());
                open = number.map(|number| (number, index + 1, String::new()));
            }
            Some((number, line, inside)) if text == "};" => {
                let position = position(inside).ok_or_else(|| source.error(*line, "is no position", inside))?;
                if positions.insert(*number, position).is_some() {
                    return Err(source.error(*line, format!("is a second position {number}"), ""));
                }
                open = None;
            }
            Some((_, _, inside)) => {
                inside.push_str(text);
                inside.push(' ');
            }
        }
    }
    match open {
        Some((_, line, inside)) => Err(source.error(line, "is a position without an end", &inside)),
        None => Ok(positions),
    }
}

/// A position from what is in its braces.
fn position(inside: &str) -> Option<Placed> {
    // What is in quotes has commas of its own.
    let plain: String = inside.split('\'').step_by(2).collect();
    let mut values = BTreeMap::new();
    for entry in plain.trim().strip_prefix("GP1:")?.split(',') {
        let (key, rest) = match entry.split_once('=').or_else(|| entry.split_once(':')) {
            Some(parts) => parts,
            None if entry.trim().is_empty() => continue,
            None => return None,
        };
        let key = key.trim();
        if key.starts_with("CONFIG") {
            continue;
        }
        let value = number(rest.split_whitespace().next()?)?;
        if values.insert(key.to_owned(), value).is_some() {
            return None;
        }
    }
    let frames = ["UF", "UT"].map(|key| values.remove(key).map(|value| value as u32));
    let frames = [frames[0]?, frames[1]?];
    let external = external(&mut values);
    if let Some(angles) = super::written::exactly(&values, ["J1", "J2", "J3", "J4", "J5", "J6"]) {
        return Some((Position::Angles(angles), external, frames));
    }
    let [x, y, z, w, p, r] = super::written::exactly(&values, ["X", "Y", "Z", "W", "P", "R"])?;
    Some((Position::Pose(frame_of([x, y, z], turned_xyz(w, p, r))), external, frames))
}
