//! RAPID: tool and work object data, `MoveAbsJ`, `MoveL`, calls of parts.

use super::geometry::{Frame, turned_by_quaternion};
use super::written::{DEEPEST, External, Goal, Moves, Source, frame_of, number};
use crate::input::InputError;
use std::collections::BTreeMap;

/// Words that begin a statement whose effect on the path is not understood.
const NOT_UNDERSTOOD: [&str; 8] = ["IF", "FOR", "WHILE", "TEST", "GOTO", "RETURN", "PDISPSET", "PDISPON"];

#[derive(Debug, Default)]
struct Data {
    tools: BTreeMap<String, Frame>,
    workpieces: BTreeMap<String, Frame>,
}

/// The moves of a program and its parts.
///
/// # Errors
/// [`InputError`] with file and line for a statement that moves the robot and is not understood.
pub(super) fn moves(source: &Source) -> Result<Moves, InputError> {
    let (mut moves, mut data) = (Moves::default(), Data::default());
    read(source, 0, &mut data, &mut moves)?;
    Ok(moves)
}

fn read(source: &Source, depth: usize, data: &mut Data, moves: &mut Moves) -> Result<(), InputError> {
    for (index, whole) in source.text.lines().enumerate() {
        let line = index + 1;
        for statement in without_comment(whole).split(';').map(str::trim).filter(|text| !text.is_empty()) {
            let word = statement.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).next().unwrap_or_default();
            let upper = word.to_ascii_uppercase();
            match upper.as_str() {
                "PERS" | "CONST" | "VAR" | "TASK" | "LOCAL" => declare(source, line, statement, data)?,
                "MOVEABSJ" => moves.push(source, line, joint(source, line, statement)?)?,
                "MOVEL" => moves.push(source, line, linear(source, line, statement, data)?)?,
                upper if upper.starts_with("MOVE") || NOT_UNDERSTOOD.contains(&upper) => {
                    return Err(source.error(line, "is not understood, and may move the robot elsewhere", statement));
                }
                _ if source.is_part(word) => match source.part(word) {
                    Some(path) if depth < DEEPEST => read(&Source::read(&path)?, depth + 1, data, moves)?,
                    _ => return Err(source.missing(line, word)),
                },
                _ => {}
            }
        }
    }
    Ok(())
}

/// A line up to its comment; a `!` in a text is none.
fn without_comment(line: &str) -> &str {
    let mut is_text = false;
    for (at, c) in line.char_indices() {
        match c {
            '"' => is_text = !is_text,
            '!' if !is_text => return &line[..at],
            _ => {}
        }
    }
    line
}

/// The first bracketed list of a text: its numbers in their order, nested or not, and what is behind it.
fn list(text: &str) -> Option<(Vec<f64>, &str)> {
    let start = text.find('[')?;
    let mut depth = 0_usize;
    let mut end = None;
    for (at, c) in text[start..].char_indices() {
        match c {
            '[' => depth += 1,
            ']' if depth == 1 => {
                end = Some(start + at);
                break;
            }
            ']' => depth -= 1,
            _ => {}
        }
    }
    let end = end?;
    let mut numbers = Vec::new();
    for word in text[start..end].split(['[', ']', ',']).map(str::trim) {
        let is_other = word.is_empty() || word.starts_with('"') || word.parse::<f64>().is_err();
        match number(word) {
            Some(value) => numbers.push(value),
            // External axes that are not there: 9E9.
            None if !is_other => numbers.push(f64::INFINITY),
            None if ["TRUE", "FALSE", "\"\"", ""].contains(&word.to_ascii_uppercase().as_str()) => {}
            None => return None,
        }
    }
    Some((numbers, &text[end + 1..]))
}

fn pose(numbers: &[f64]) -> Option<Frame> {
    let [x, y, z, q1, q2, q3, q4] = *<&[f64; 7]>::try_from(numbers).ok()?;
    let is_finite = numbers.iter().all(|value| value.is_finite());
    is_finite.then(|| turned_by_quaternion([q1, q2, q3, q4])).flatten().map(|turn| frame_of([x, y, z], turn))
}

fn declare(source: &Source, line: usize, statement: &str, data: &mut Data) -> Result<(), InputError> {
    let Some((head, value)) = statement.split_once(":=") else { return Ok(()) };
    let words: Vec<String> = head.split_whitespace().map(str::to_ascii_uppercase).collect();
    let Some([kind, name]) = words.last_chunk::<2>() else { return Ok(()) };
    let wrong = || source.error(line, "is no tool or work object as `stead export` writes it", statement);
    match kind.as_str() {
        "TOOLDATA" => {
            let (numbers, _) = list(value).ok_or_else(wrong)?;
            let tool = numbers.get(..7).and_then(pose).ok_or_else(wrong)?;
            data.tools.insert(name.clone(), tool);
        }
        "WOBJDATA" => {
            let (numbers, _) = list(value).ok_or_else(wrong)?;
            let user = numbers.get(..7).and_then(pose).ok_or_else(wrong)?;
            let object = numbers.get(7..).and_then(pose).ok_or_else(wrong)?;
            data.workpieces.insert(name.clone(), user.of(&object));
        }
        _ => {}
    }
    Ok(())
}

/// The last six numbers of a goal, those that are axes.
fn external(numbers: &[f64]) -> Option<External> {
    let last = numbers.last_chunk::<6>()?;
    Some(last.map(|position| Some(position).filter(|position| position.is_finite())))
}

fn joint(source: &Source, line: usize, statement: &str) -> Result<(Goal, External), InputError> {
    let found = list(statement).and_then(|(numbers, _)| {
        let angles: [f64; 6] = numbers.get(..6)?.try_into().ok()?;
        let is_whole = numbers.len() == 12 && angles.iter().all(|angle| angle.is_finite());
        is_whole.then_some(Goal::Angles(angles)).zip(external(&numbers))
    });
    found.ok_or_else(|| source.error(line, "is no joint move MoveAbsJ [[..],[9E9,..]],..", statement))
}

fn linear(source: &Source, line: usize, statement: &str, data: &Data) -> Result<(Goal, External), InputError> {
    let wrong = || source.error(line, "is no linear move MoveL [[..],[..],[..],[..]],..,tool\\WObj:=wobj", statement);
    let (numbers, behind) = list(statement).ok_or_else(wrong)?;
    let tool = numbers.get(..7).and_then(pose).filter(|_| numbers.len() == 17).ok_or_else(wrong)?;
    let (named, workpiece) = behind.split_once("\\WObj:=").ok_or_else(wrong)?;
    let named = named.rsplit(',').next().unwrap_or_default().trim().to_ascii_uppercase();
    let workpiece = workpiece.trim().to_ascii_uppercase();
    let (Some(base), Some(mounted)) = (data.workpieces.get(&workpiece), data.tools.get(&named)) else {
        return Err(source.error(line, "names a tool or a work object that is not declared before", statement));
    };
    Ok((Goal::Line { tool, frames: [*base, *mounted] }, external(&numbers).ok_or_else(wrong)?))
}
