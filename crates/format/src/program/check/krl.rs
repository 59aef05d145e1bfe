//! KRL: `$BASE`, `$TOOL`, `PTP {A1 ..}`, `LIN {X ..}`, calls of parts.

use super::geometry::{Frame, turned_xyz};
use super::written::{DEEPEST, External, Goal, Moves, Source, entries, exactly, external, frame_of};
use crate::input::InputError;

/// Words that begin a statement whose effect on the path is not understood.
const NOT_UNDERSTOOD: [&str; 22] = [
    "CIRC",
    "CIRC_REL",
    "PTP_REL",
    "LIN_REL",
    "SPTP",
    "SLIN",
    "SCIRC",
    "SPL",
    "SPTP_REL",
    "SLIN_REL",
    "SPLINE",
    "PTP_SPLINE",
    "IF",
    "FOR",
    "WHILE",
    "LOOP",
    "REPEAT",
    "SWITCH",
    "GOTO",
    "RETURN",
    "EXIT",
    "INTERRUPT",
];

#[derive(Debug, Default, Clone, Copy)]
struct State {
    base: Option<Frame>,
    tool: Option<Frame>,
}

/// The moves of a program and its parts.
///
/// # Errors
/// [`InputError`] with file and line for a statement that moves the robot and is not understood.
pub(super) fn moves(source: &Source) -> Result<Moves, InputError> {
    let mut moves = Moves::default();
    read(source, 0, &mut State::default(), &mut moves)?;
    Ok(moves)
}

fn read(source: &Source, depth: usize, state: &mut State, moves: &mut Moves) -> Result<(), InputError> {
    for (index, whole) in source.text.lines().enumerate() {
        let line = index + 1;
        let statement = whole.split(';').next().unwrap_or_default().trim();
        let upper = statement.to_ascii_uppercase();
        let word = upper.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == '$' || c == '.')).next();
        match word.unwrap_or_default() {
            "$BASE" => state.base = Some(frame(source, line, &upper)?),
            "$TOOL" => state.tool = Some(frame(source, line, &upper)?),
            "PTP" => moves.push(source, line, joint(source, line, &upper)?)?,
            "LIN" => {
                let (Some(base), Some(tool)) = (state.base, state.tool) else {
                    return Err(source.error(line, "moves before $BASE and $TOOL are set", whole));
                };
                moves.push(source, line, linear(source, line, &upper, [base, tool])?)?;
            }
            word if NOT_UNDERSTOOD.contains(&word) || word.starts_with("$BASE.") || word.starts_with("$TOOL.") => {
                return Err(source.error(line, "is not understood, and may move the robot elsewhere", whole));
            }
            word => call(source, line, word, (depth, state), moves)?,
        }
    }
    Ok(())
}

/// Reads a part where it is called.
fn call(
    source: &Source,
    line: usize,
    word: &str,
    (depth, state): (usize, &mut State),
    moves: &mut Moves,
) -> Result<(), InputError> {
    let is_own = word == "DEF" || word.is_empty();
    if is_own || !source.is_part(word) {
        return Ok(());
    }
    match source.part(word) {
        Some(path) if depth < DEEPEST => read(&Source::read(&path)?, depth + 1, state, moves),
        _ => Err(source.missing(line, word)),
    }
}

/// What is in the braces of a statement, and what is behind them.
fn braces(statement: &str) -> Option<(&str, &str)> {
    let (_, rest) = statement.split_once('{')?;
    let (inside, behind) = rest.split_once('}')?;
    // The type of the aggregate may stand before a colon.
    Some((inside.split_once(':').map_or(inside, |(_, values)| values), behind.trim()))
}

fn pose(inside: &str) -> Option<Frame> {
    let [x, y, z, a, b, c] = exactly(&entries(inside)?, ["X", "Y", "Z", "A", "B", "C"])?;
    Some(frame_of([x, y, z], turned_xyz(c, b, a)))
}

fn frame(source: &Source, line: usize, statement: &str) -> Result<Frame, InputError> {
    let found = braces(statement).filter(|(_, behind)| behind.is_empty()).and_then(|(inside, _)| pose(inside));
    found.ok_or_else(|| source.error(line, "is no frame {X ..,Y ..,Z ..,A ..,B ..,C ..}", statement))
}

fn joint(source: &Source, line: usize, statement: &str) -> Result<(Goal, External), InputError> {
    let found = braces(statement).filter(|(_, behind)| behind.is_empty()).and_then(|(inside, _)| {
        let mut entries = entries(inside)?;
        let external = external(&mut entries);
        Some((Goal::Angles(exactly(&entries, ["A1", "A2", "A3", "A4", "A5", "A6"])?), external))
    });
    found.ok_or_else(|| source.error(line, "is no joint move PTP {A1 ..,.. A6 ..}", statement))
}

fn linear(source: &Source, line: usize, statement: &str, frames: [Frame; 2]) -> Result<(Goal, External), InputError> {
    let found = braces(statement).filter(|(_, behind)| ["", "C_DIS"].contains(behind)).and_then(|(inside, _)| {
        let mut entries = entries(inside)?;
        let external = external(&mut entries);
        let [x, y, z, a, b, c] = exactly(&entries, ["X", "Y", "Z", "A", "B", "C"])?;
        Some((Goal::Line { tool: frame_of([x, y, z], turned_xyz(c, b, a)), frames }, external))
    });
    found.ok_or_else(|| source.error(line, "is no linear move LIN {X ..,Y ..,Z ..,A ..,B ..,C ..} C_DIS", statement))
}
