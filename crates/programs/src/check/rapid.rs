//! RAPID: tool, work object and zone data, `ActUnit`, `MoveAbsJ`, `MoveL`, calls of parts.

use super::geometry::{Frame, turned_by_quaternion};
use super::written::{Base, End, External, Goal, Moves, Pace, Source, Step, frame_of, number};
use std::collections::{BTreeMap, BTreeSet};
use stead_disk::input::InputError;

/// Words that begin a statement whose effect on the path is not understood.
const NOT_UNDERSTOOD: [&str; 10] =
    ["DEACTUNIT", "EOFFSON", "IF", "FOR", "WHILE", "TEST", "GOTO", "RETURN", "PDISPSET", "PDISPON"];

#[derive(Debug, Default)]
struct Data {
    tools: BTreeMap<String, Frame>,
    workpieces: BTreeMap<String, Workpiece>,
    /// Where blending begins, by the name of the zone. mm
    zones: BTreeMap<String, f64>,
    /// Mechanical units that have been activated.
    active: BTreeSet<String>,
}

/// A work object, and the mechanical unit that moves it, if one does.
#[derive(Debug)]
struct Workpiece {
    base: Base,
    unit: Option<String>,
}

/// The moves of a program and its parts.
///
/// # Errors
/// [`InputError`] with file and line for a statement that moves the robot and is not understood.
pub(super) fn moves(source: &Source) -> Result<Moves, InputError> {
    let (mut moves, mut data) = (Moves::default(), Data::default());
    read(source, &mut data, &mut moves)?;
    Ok(moves)
}

fn read(source: &Source, data: &mut Data, moves: &mut Moves) -> Result<(), InputError> {
    for (index, whole) in source.text.lines().enumerate() {
        let line = index + 1;
        for statement in without_comment(whole).split(';').map(str::trim).filter(|text| !text.is_empty()) {
            let word = statement.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).next().unwrap_or_default();
            let upper = word.to_ascii_uppercase();
            match upper.as_str() {
                "PERS" | "CONST" | "VAR" | "TASK" | "LOCAL" => declare(source, line, statement, data)?,
                "ACTUNIT" => {
                    data.active.insert(statement[word.len()..].trim().to_ascii_uppercase());
                }
                "MOVEABSJ" => moves.push(source, line, joint(source, line, statement)?)?,
                "MOVEL" => moves.push(source, line, linear(source, line, statement, data)?)?,
                upper if upper.starts_with("MOVE") || NOT_UNDERSTOOD.contains(&upper) => {
                    return Err(source.error(line, "is not understood, and may move the robot elsewhere", statement));
                }
                _ => {
                    if let Some(part) = source.called(line, word)? {
                        read(&part, data, moves)?;
                    }
                }
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
            None if word.len() > 1 && word.starts_with('"') && word.ends_with('"') => {}
            None if ["TRUE", "FALSE", ""].contains(&word.to_ascii_uppercase().as_str()) => {}
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
            let workpiece = workpiece(value, &user, object).ok_or_else(wrong)?;
            data.workpieces.insert(name.clone(), workpiece);
        }
        "ZONEDATA" => {
            let (numbers, _) = list(value).ok_or_else(wrong)?;
            data.zones.insert(name.clone(), *numbers.first().ok_or_else(wrong)?);
        }
        _ => {}
    }
    Ok(())
}

/// A work object `[robhold, ufprog, "unit", user frame, object frame]`: that of a unit is on it, and its user frame is
/// the unit's, whatever the text says.
fn workpiece(value: &str, user: &Frame, object: Frame) -> Option<Workpiece> {
    let mut words = value.trim().strip_prefix('[')?.splitn(4, ',').map(|word| word.trim().to_ascii_uppercase());
    let (is_held, stands, unit) = (words.next()?, words.next()?, words.next()?);
    let unit = unit.strip_prefix('"')?.strip_suffix('"')?;
    match (is_held.as_str(), stands.as_str(), unit) {
        ("FALSE", "TRUE", "") => Some(Workpiece { base: Base::Still(user.of(&object)), unit: None }),
        ("FALSE", "FALSE", unit) if !unit.is_empty() => {
            Some(Workpiece { base: Base::OnTable(object), unit: Some(unit.to_owned()) })
        }
        _ => None,
    }
}

/// The last six numbers of a goal, those that are axes.
fn external(numbers: &[f64]) -> Option<External> {
    let last = numbers.last_chunk::<6>()?;
    Some(last.map(|position| Some(position).filter(|position| position.is_finite())))
}

fn joint(source: &Source, line: usize, statement: &str) -> Result<Step, InputError> {
    let found = list(statement).and_then(|(numbers, behind)| {
        let angles: [f64; 6] = numbers.get(..6)?.try_into().ok()?;
        let is_whole = numbers.len() == 12 && angles.iter().all(|angle| angle.is_finite());
        let is_exact = behind.split(',').nth(2)?.trim().eq_ignore_ascii_case("fine");
        let pace = Pace { feed: None, end: Some(End::Exact) };
        (is_whole && is_exact).then_some((Goal::Angles(angles), external(&numbers)?, pace))
    });
    found.ok_or_else(|| source.error(line, "is no joint move MoveAbsJ [[..],[9E9,..]],speed,fine,..", statement))
}

fn linear(source: &Source, line: usize, statement: &str, data: &Data) -> Result<Step, InputError> {
    let form = "is no linear move MoveL [[..],[..],[..],[..]],[..],zone,tool\\WObj:=wobj";
    let wrong = || source.error(line, form, statement);
    let (numbers, behind) = list(statement).ok_or_else(wrong)?;
    let tool = numbers.get(..7).and_then(pose).filter(|_| numbers.len() == 17).ok_or_else(wrong)?;
    let (speeds, behind) = list(behind).ok_or_else(wrong)?;
    let feed = speeds.first().copied().filter(|feed| feed.is_finite() && speeds.len() == 4).ok_or_else(wrong)?;
    let (behind, workpiece) = behind.split_once("\\WObj:=").ok_or_else(wrong)?;
    let names: Vec<String> = behind.split(',').map(|name| name.trim().to_ascii_uppercase()).collect();
    let [_, zone, named] = &names[..] else { return Err(wrong()) };
    let workpiece = workpiece.trim().to_ascii_uppercase();
    let (Some(workpiece), Some(mounted)) = (data.workpieces.get(&workpiece), data.tools.get(named)) else {
        return Err(source.error(line, "names a tool or a work object that is not declared before", statement));
    };
    if let Some(unit) = workpiece.unit.as_ref().filter(|unit| !data.active.contains(*unit)) {
        let problem = format!("moves on the mechanical unit {unit} before ActUnit {unit}");
        return Err(source.error(line, problem, statement));
    }
    let end = match (zone.as_str(), data.zones.get(zone)) {
        ("FINE", _) => End::Exact,
        (_, Some(mm)) => End::Within(*mm),
        _ => return Err(source.error(line, "names a zone that is not declared before", statement)),
    };
    let goal = Goal::Line { tool, base: workpiece.base, mounted: *mounted };
    Ok((goal, external(&numbers).ok_or_else(wrong)?, Pace { feed: Some(feed), end: Some(end) }))
}
