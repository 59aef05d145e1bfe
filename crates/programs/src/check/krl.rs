//! KRL: `$BASE`, `$TOOL`, `$VEL.CP`, `$APO.CDIS`, `PTP {A1 ..}`, `LIN {X ..}`, calls of parts.

use super::geometry::{Frame, turned_xyz};
use super::written::{
    Base, End, External, Goal, Moves, Pace, Source, Step, entries, exactly, external, frame_of, number,
};
use std::collections::BTreeMap;
use stead_disk::input::InputError;

/// Words that begin a statement whose effect on the path is not understood.
const NOT_UNDERSTOOD: &str = "BAS CIRC CIRC_REL PTP_REL LIN_REL SPTP SLIN SCIRC SPL SPTP_REL SLIN_REL SPLINE \
    PTP_SPLINE IF FOR WHILE LOOP REPEAT SWITCH GOTO RETURN EXIT INTERRUPT";

/// Variables that bear on frames and paths, of which only those above are understood.
const SET_WHOLE: [&str; 4] = ["$BASE", "$TOOL", "$VEL", "$APO"];
/// What `BAS` may set that bears on no frame and on no speed of lines.
const HARMLESS_BAS: [&str; 4] = ["INITMOV", "VEL_PTP", "ACC_PTP", "ACC_CP"];

#[derive(Debug, Default, Clone, Copy)]
struct State {
    base: Option<Base>,
    tool: Option<Frame>,
    /// mm/s
    feed: Option<f64>,
    /// Where blending begins. mm
    blend: Option<f64>,
}

/// The moves of a program and its parts.
///
/// # Errors
/// [`InputError`] with file and line for a statement that moves the robot and is not understood.
pub(super) fn moves(source: &Source) -> Result<Moves, InputError> {
    let mut moves = Moves::default();
    read(source, &mut State::default(), &mut moves)?;
    Ok(moves)
}

fn read(source: &Source, state: &mut State, moves: &mut Moves) -> Result<(), InputError> {
    for (index, whole) in source.text.lines().enumerate() {
        let line = index + 1;
        let statement = whole.split(';').next().unwrap_or_default().trim();
        let upper = statement.to_ascii_uppercase();
        let word = upper.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == '$' || c == '.')).next();
        match word.unwrap_or_default() {
            "$BASE" => state.base = Some(base(source, line, &upper)?),
            "$VEL.CP" => state.feed = Some(value(source, line, &upper)? * 1e3),
            "$APO.CDIS" => state.blend = Some(value(source, line, &upper)?),
            "$TOOL" => state.tool = Some(frame(source, line, &upper)?),
            "PTP" => moves.push(source, line, joint(source, line, &upper)?)?,
            "LIN" => {
                let (Some(base), Some(mounted)) = (state.base, state.tool) else {
                    return Err(source.error(line, "moves before $BASE and $TOOL are set", whole));
                };
                if state.feed.is_none() {
                    return Err(source.error(line, "moves before $VEL.CP is set", whole));
                }
                let (tool, external, end) = linear(source, line, &upper, state.blend)?;
                let pace = Pace { feed: state.feed, end: Some(end) };
                moves.push(source, line, (Goal::Line { tool, base, mounted }, external, pace))?;
            }
            "BAS" if HARMLESS_BAS.iter().any(|what| upper.contains(&format!("#{what},"))) => {}
            word if NOT_UNDERSTOOD.split(' ').any(|known| known == word)
                || SET_WHOLE.iter().any(|name| word.starts_with(name)) =>
            {
                return Err(source.error(line, "is not understood, and may move the robot elsewhere", whole));
            }
            word => {
                if let Some(part) = source.called(line, word)? {
                    read(&part, state, moves)?;
                }
            }
        }
    }
    Ok(())
}

/// What is in the braces of a statement, and what is behind them.
fn braces(statement: &str) -> Option<(&str, &str)> {
    let (_, rest) = statement.split_once('{')?;
    let (inside, behind) = rest.split_once('}')?;
    // The type of the aggregate may stand before a colon.
    Some((inside.split_once(':').map_or(inside, |(_, values)| values), behind.trim()))
}

fn pose(entries: &BTreeMap<String, f64>) -> Option<Frame> {
    let [x, y, z, a, b, c] = exactly(entries, ["X", "Y", "Z", "A", "B", "C"])?;
    Some(frame_of([x, y, z], turned_xyz(c, b, a)))
}

/// A base that stands still, or `EK(MACHINE_DEF[n].ROOT,MACHINE_DEF[n].MECH_TYPE,{..})`: one on mechanism n.
fn base(source: &Source, line: usize, statement: &str) -> Result<Base, InputError> {
    let head: String = statement.split('{').next().unwrap_or_default().split_whitespace().collect();
    let Some(coupled) = head.strip_prefix("$BASE=EK(") else { return frame(source, line, statement).map(Base::Still) };
    let number = coupled.strip_prefix("MACHINE_DEF[").and_then(|rest| rest.split(']').next()).unwrap_or_default();
    let is_one = number.parse::<u32>().is_ok()
        && coupled == format!("MACHINE_DEF[{number}].ROOT,MACHINE_DEF[{number}].MECH_TYPE,");
    let on_table = braces(statement)
        .filter(|(_, behind)| is_one && *behind == ")")
        .and_then(|(inside, _)| pose(&entries(inside)?));
    let form = "is no base EK(MACHINE_DEF[n].ROOT,MACHINE_DEF[n].MECH_TYPE,{X ..,.. C ..})";
    on_table.map(Base::OnTable).ok_or_else(|| source.error(line, form, statement))
}

/// The number that is set.
fn value(source: &Source, line: usize, statement: &str) -> Result<f64, InputError> {
    let found = statement.split_once('=').and_then(|(_, value)| number(value));
    found.ok_or_else(|| source.error(line, "sets no number", statement))
}

fn frame(source: &Source, line: usize, statement: &str) -> Result<Frame, InputError> {
    let found =
        braces(statement).filter(|(_, behind)| behind.is_empty()).and_then(|(inside, _)| pose(&entries(inside)?));
    found.ok_or_else(|| source.error(line, "is no frame {X ..,Y ..,Z ..,A ..,B ..,C ..}", statement))
}

fn joint(source: &Source, line: usize, statement: &str) -> Result<Step, InputError> {
    let found = braces(statement).filter(|(_, behind)| behind.is_empty()).and_then(|(inside, _)| {
        let mut entries = entries(inside)?;
        let external = external(&mut entries);
        // Whatever stands behind the braces, as C_PTP, is refused.
        let pace = Pace { feed: None, end: Some(End::Exact) };
        Some((Goal::Angles(exactly(&entries, ["A1", "A2", "A3", "A4", "A5", "A6"])?), external, pace))
    });
    found.ok_or_else(|| source.error(line, "is no joint move PTP {A1 ..,.. A6 ..}", statement))
}

/// The tool in the base, the external axes, and how the move ends where blending begins at a distance (mm).
fn linear(
    source: &Source,
    line: usize,
    statement: &str,
    blend: Option<f64>,
) -> Result<(Frame, External, End), InputError> {
    let found = braces(statement).and_then(|(inside, behind)| {
        let end = match behind {
            "" => End::Exact,
            "C_DIS" => End::Within(blend?),
            _ => return None,
        };
        let mut entries = entries(inside)?;
        let external = external(&mut entries);
        Some((pose(&entries)?, external, end))
    });
    let form = "is no linear move LIN {X ..,Y ..,Z ..,A ..,B ..,C ..} C_DIS, behind $APO.CDIS=..";
    found.ok_or_else(|| source.error(line, form, statement))
}
