//! An exported program, as the controller takes its text.

use crate::cell::Cell;
use crate::path::Point;
use crate::plan::Plan;
use crate::values::{Answer, angle_between, placed};
use crate::verdict::Verdict;
use nalgebra::{Isometry3, Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use std::path::Path;

/// What the base of a program is fixed to.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Base {
    /// The robot root with all axes at zero.
    World,
    /// The last axis that carries the part.
    Table,
    /// The part itself, wherever it is: a table of poses for other posts.
    Part,
}

/// A move, in m and rad.
#[derive(Debug, Clone)]
struct Move {
    line: String,
    /// Angles of the controller.
    joints: Option<[f64; 6]>,
    /// The tool in the base of the program.
    target: Option<Isometry3<f64>>,
    external: Vec<f64>,
    /// m/s
    feed: f64,
}

struct Program {
    base: Base,
    frame: Isometry3<f64>,
    tool: Option<Isometry3<f64>>,
    moves: Vec<Move>,
    /// Half the last digit of a feed.
    feed_slack: f64,
}

/// The number behind a word, as in `X -0.4`, `A1 3` or `P = 2 deg`.
fn after(text: &str, word: &str) -> Option<f64> {
    let mut rest = text;
    while let Some(at) = rest.find(word) {
        let is_start = !rest[..at].ends_with(|c: char| c.is_ascii_alphanumeric() || c == '_');
        let behind = rest[at + word.len()..].trim_start_matches([' ', '=', '\t']);
        rest = &rest[at + word.len()..];
        if is_start && behind.len() < rest.len() {
            let end = behind.find(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c))).unwrap_or(behind.len());
            if let Ok(number) = behind[..end].trim_end_matches(['e', 'E']).parse() {
                return Some(number);
            }
        }
    }
    None
}

/// X, Y, Z in mm and three angles in deg of rotations about z, y and x.
fn frame(text: &str, words: [&str; 6]) -> Option<Isometry3<f64>> {
    let [x, y, z, about_z, about_y, about_x] = words.map(|word| after(text, word));
    let rotation = Rotation3::from_euler_angles(about_x?.to_radians(), about_y?.to_radians(), about_z?.to_radians());
    Some(placed(&rotation, &(Vector3::new(x?, y?, z?) * 1e-3)))
}

const KRL: [&str; 6] = ["X", "Y", "Z", "A", "B", "C"];
const FANUC: [&str; 6] = ["X", "Y", "Z", "R", "P", "W"];

/// A pose as `[x,y,z],[q1,q2,q3,q4]`.
fn quaternion_frame(numbers: &[f64]) -> Option<Isometry3<f64>> {
    let [x, y, z, w, i, j, k] = numbers.get(..7)?.try_into().ok()?;
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
    Some(placed(&rotation.to_rotation_matrix(), &(Vector3::new(x, y, z) * 1e-3)))
}

fn numbers(text: &str) -> Vec<f64> {
    text.split(|c: char| "[],".contains(c)).filter_map(|word| word.trim().parse().ok()).collect()
}

impl Program {
    fn read(main: &Path, cell: &Cell) -> Answer<Self> {
        let told = |error: std::io::Error| format!("{}: {error}", main.display());
        let of_main = std::fs::read_to_string(main).map_err(told)?;
        let (Some(stem), Some(kind)) =
            (main.file_stem().and_then(|s| s.to_str()), main.extension().and_then(|s| s.to_str()))
        else {
            return Err("a program without a name".to_owned());
        };
        let mut parts = Vec::new();
        for number in 1.. {
            // The parts are called by name, in the case that the controller has them in.
            let names =
                [format!("{stem}_{number:02}.{kind}"), format!("{}_{number:02}.{kind}", stem.to_ascii_uppercase())];
            let Some(file) = names.iter().map(|name| main.with_file_name(name)).find(|file| file.exists()) else {
                break;
            };
            parts.push(std::fs::read_to_string(&file).map_err(told)?);
        }
        match kind {
            "src" => Self::krl(&parts, cell),
            "mod" => Self::rapid(&of_main, &parts, cell),
            "ls" => Self::fanuc(&parts, cell),
            _ => Self::table(main, cell),
        }
    }

    fn external(cell: &Cell, value: &dyn Fn(usize) -> Option<f64>) -> Answer<Vec<f64>> {
        let unit = |(k, axis): (usize, &crate::cell::Axis)| {
            let value = value(k).ok_or_else(|| format!("no position of external axis {}", k + 1))?;
            Ok(if axis.is_rail { value * 1e-3 } else { value.to_radians() })
        };
        cell.axes.iter().enumerate().map(unit).collect()
    }

    fn krl(parts: &[String], cell: &Cell) -> Answer<Self> {
        let mut program =
            Self { base: Base::World, frame: Isometry3::identity(), tool: None, moves: Vec::new(), feed_slack: 1e-6 };
        let mut feed = f64::NAN;
        for line in parts.iter().flat_map(|part| part.lines()).map(str::trim) {
            if let Some(text) = line.strip_prefix("$BASE=") {
                program.base = if text.starts_with("EK(") { Base::Table } else { Base::World };
                let text = &text[text.find('{').unwrap_or(0)..];
                program.frame = frame(text, KRL).ok_or(line)?;
            } else if let Some(text) = line.strip_prefix("$TOOL=") {
                program.tool = frame(text, KRL);
            } else if let Some(text) = line.strip_prefix("$VEL.CP=") {
                feed = text.trim().parse().map_err(|_| line.to_owned())?;
            } else if line.starts_with("PTP ") || line.starts_with("LIN ") {
                let angles = ["A1", "A2", "A3", "A4", "A5", "A6"].map(|word| after(line, word).map(f64::to_radians));
                let is_joint = line.starts_with("PTP ");
                let external = Self::external(cell, &|k| after(line, &format!("E{}", k + 1)))?;
                let joints = match (is_joint, angles) {
                    (true, [Some(a), Some(b), Some(c), Some(d), Some(e), Some(f)]) => Some([a, b, c, d, e, f]),
                    (true, _) => return Err(line.to_owned()),
                    (false, _) => None,
                };
                let target = if is_joint { None } else { Some(frame(line, KRL).ok_or(line)?) };
                program.moves.push(Move { line: line.to_owned(), joints, target, external, feed });
            }
        }
        Ok(program)
    }

    fn rapid(main: &str, parts: &[String], cell: &Cell) -> Answer<Self> {
        let line_of = |word: &str| main.lines().find(|line| line.contains(word)).ok_or_else(|| format!("no {word}"));
        let tool = line_of("PERS tooldata")?;
        let object = line_of("PERS wobjdata")?;
        let frames = numbers(object.split_once(":=").ok_or(object)?.1);
        let [user, on_it] = [frames.get(..7), frames.get(7..14)].map(|part| part.and_then(quaternion_frame));
        let (user, on_it) = user.zip(on_it).ok_or(object)?;
        let is_coupled = object.contains(":=[FALSE,FALSE,\"");
        let unit = object.split('"').nth(1).unwrap_or_default();
        if is_coupled && !main.lines().any(|line| line.trim() == format!("ActUnit {unit};")) {
            return Err(format!("the unit {unit} is not activated"));
        }
        let (base, frame) = if is_coupled { (Base::Table, on_it) } else { (Base::World, user * on_it) };
        let tool = quaternion_frame(&numbers(tool.split_once(":=").ok_or(tool)?.1));
        let mut moves = Vec::new();
        for line in parts.iter().flat_map(|part| part.lines()).map(str::trim) {
            let all = numbers(line.split_once(' ').map_or("", |(_, rest)| rest));
            let external =
                |from: usize| Self::external(cell, &|k| all.get(from + k).copied().filter(|value| *value < 8e9));
            if line.starts_with("MoveAbsJ ") {
                let joints = all.get(..6).and_then(|angles| <[f64; 6]>::try_from(angles).ok()).ok_or(line)?;
                let joints = Some(joints.map(f64::to_radians));
                moves.push(Move {
                    line: line.to_owned(),
                    joints,
                    target: None,
                    external: external(6)?,
                    feed: f64::NAN,
                });
            } else if line.starts_with("MoveL ") {
                // Pose (7), configuration (4), external axes (6), speed.
                let target = Some(quaternion_frame(&all).ok_or(line)?);
                let feed = all.get(17).ok_or(line)? * 1e-3;
                moves.push(Move { line: line.to_owned(), joints: None, target, external: external(11)?, feed });
            }
        }
        Ok(Self { base, frame, tool, moves, feed_slack: 1e-6 })
    }

    fn fanuc(parts: &[String], cell: &Cell) -> Answer<Self> {
        let first = parts.first().ok_or("a program without parts")?;
        let entered = |name: &str| {
            // What the operator enters stands in remarks, a line for each number.
            let remarks: String = first
                .lines()
                .filter_map(|line| line.split_once(&format!("!{name} 9 ")).map(|(_, rest)| format!("{rest} ")))
                .collect();
            frame(&remarks, FANUC)
        };
        let (frame_of, tool) = entered("UFRAME").zip(entered("UTOOL")).ok_or("no UFRAME or UTOOL in the remarks")?;
        let mut moves = Vec::new();
        for part in parts {
            let (statements, positions) = part.split_once("/POS").ok_or("no positions")?;
            let at = |number: usize| {
                let begin = positions.find(&format!("P[{number}]{{"))?;
                positions[begin..].split_once("};").map(|(text, _)| text.split_once('{').map_or("", |(_, rest)| rest))
            };
            for line in statements.lines() {
                let Some((_, move_)) = line.split_once(':') else { continue };
                let is_joint = move_.starts_with("J P[");
                if !is_joint && !move_.starts_with("L P[") {
                    continue;
                }
                let number = move_[4..].split(']').next().and_then(|text| text.parse().ok()).ok_or(line)?;
                let text = at(number).ok_or(line)?;
                let external = Self::external(cell, &|k| after(text, &format!("E{}", k + 1)))?;
                let joints = ["J1", "J2", "J3", "J4", "J5", "J6"].map(|word| after(text, word).map(f64::to_radians));
                let joints = match (is_joint, joints) {
                    (true, [Some(a), Some(b), Some(c), Some(d), Some(e), Some(f)]) => Some([a, b, c, d, e, f]),
                    (true, _) => return Err(line.to_owned()),
                    (false, _) => None,
                };
                let target = if is_joint { None } else { Some(frame(text, FANUC).ok_or(line)?) };
                let feed = match move_.split_once("] ").and_then(|(_, rest)| rest.split_once("mm/sec")) {
                    Some((speed, _)) => speed.trim().parse::<f64>().map_err(|_| line.to_owned())? * 1e-3,
                    None => f64::NAN,
                };
                moves.push(Move { line: line.to_owned(), joints, target, external, feed });
            }
        }
        Ok(Self { base: Base::World, frame: frame_of, tool: Some(tool), moves, feed_slack: 0.501e-3 })
    }

    fn table(file: &Path, cell: &Cell) -> Answer<Self> {
        let told = |error: csv::Error| format!("{}: {error}", file.display());
        let mut reader = csv::Reader::from_path(file).map_err(told)?;
        let names: Vec<String> = reader.headers().map_err(told)?.iter().map(str::to_owned).collect();
        let mut moves = Vec::new();
        for record in reader.records() {
            let record = record.map_err(told)?;
            let value = |name: &str| {
                names.iter().position(|known| known == name).and_then(|k| record.get(k)?.parse::<f64>().ok())
            };
            let line = record.iter().collect::<Vec<_>>().join(",");
            let pose: Option<Vec<f64>> =
                ["x_mm", "y_mm", "z_mm", "q_w", "q_x", "q_y", "q_z"].into_iter().map(value).collect();
            let angles: Option<Vec<f64>> = (1..7).map(|k| value(&format!("a{k}_deg")).map(f64::to_radians)).collect();
            let is_joint = record.get(2) == Some("joint");
            let external = Self::external(cell, &|k| {
                value(&format!("e{}_mm", k + 1)).or_else(|| value(&format!("e{}_deg", k + 1)))
            })?;
            let target = pose.and_then(|pose| quaternion_frame(&pose)).ok_or_else(|| line.clone())?;
            let joints = if is_joint { angles.and_then(|angles| angles.try_into().ok()) } else { None };
            let feed = value("feed_mm_per_s").map_or(f64::NAN, |feed| feed * 1e-3);
            // Without a controller joint moves have their pose alone, and are held against nothing.
            if is_joint && joints.is_none() {
                continue;
            }
            moves.push(Move { line, joints, target: (!is_joint).then_some(target), external, feed });
        }
        Ok(Self { base: Base::Part, frame: Isometry3::identity(), tool: None, moves, feed_slack: 1e-6 })
    }
}

/// The frame on the last axis that carries the part, with all axes at zero, in the cell: origin on the axis, z along
/// it, x as near as that allows to the x axis of the robot root, or to its y axis where that is within 25 deg.
fn table_at_zero(cell: &Cell, world: &Isometry3<f64>) -> Option<Isometry3<f64>> {
    let axis = cell.axes.iter().rfind(|axis| !axis.carries_robot)?;
    let [x, y] = [Vector3::x(), Vector3::y()].map(|unit| world.rotation * unit);
    let z = axis.direction;
    let angle = z.cross(&x).norm().atan2(z.dot(&x).abs());
    let near = if angle < 25_f64.to_radians() { y } else { x };
    let x = (near - z * z.dot(&near)).normalize();
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, z.cross(&x), z]));
    Some(placed(&rotation, &axis.point))
}

/// Holds a program against the plan that it was made from.
pub(crate) fn judge(verdict: &mut Verdict, plan: &Plan<'_>, main: &Path) -> Answer<()> {
    let cell = plan.cell;
    let program = Program::read(main, cell)?;
    let name = main.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_owned();
    let root_from_base =
        cell.arm.counting.as_ref().map_or_else(Isometry3::identity, |counting| counting.root_from_base);
    let world = cell.mount * root_from_base.inverse();
    if let Some(tool) = &program.tool {
        verdict.within(
            "tool of a program (m)",
            || name.clone(),
            (tool.translation.vector - cell.tool.translation.vector + Vector3::z() * cell.arm.flange).norm(),
            1e-7,
        );
        let turn = angle_between(tool, &cell.tool);
        verdict.within("tool of a program (rad)", || name.clone(), turn, 3e-8);
    }
    let mut next = 0_usize;
    let mut joints: Option<[f64; 6]> = None;
    let mut last: Option<(Isometry3<f64>, Vec<f64>)> = None;
    for step in &program.moves {
        let at = || format!("{name} {}", step.line);
        let still = cell.at(&plan.placement, &[0.0; 6], &step.external);
        if let Some(angles) = &step.joints {
            let rows = cell.arm.joints_of(angles).ok_or("a program without [controller]")?;
            for (j, row) in cell.arm.rows.iter().enumerate() {
                let beyond = (row.min - rows[j]).max(rows[j] - row.max);
                verdict.within("joint limit of a program (rad)", || format!("{} joint {}", at(), j + 1), beyond, 2e-7);
            }
            joints = Some(rows);
            let stand = cell.at(&plan.placement, &rows, &step.external);
            let in_part = stand.part.inverse() * stand.tool;
            last = Some((in_part, step.external.clone()));
            // Without a line into the cut the joint move leads to the first point of a segment.
            let is_there = plan.rows.get(next).is_some_and(|row| {
                let wanted = plan.wanted(next);
                let off = (0..6).map(|j| (rows[j] - row.joints[j]).abs()).fold(0.0, f64::max);
                (wanted.translation.vector - in_part.translation.vector).norm() < 2e-5 && off < 1e-5
            });
            next += usize::from(is_there);
            continue;
        }
        let Some(target) = &step.target else { continue };
        // Where the tool is in the cell, as the controller takes it.
        let tool = match program.base {
            Base::World => world * program.frame * target,
            Base::Part => still.part * target,
            Base::Table => {
                let zero = table_at_zero(cell, &world).ok_or("a coupled base, and no axis that carries the part")?;
                cell.carried_part(&step.external) * zero * program.frame * target
            }
        };
        let in_part = still.part.inverse() * tool;
        let off = |i: usize| {
            let wanted = plan.wanted(i);
            let turn = angle_between(&wanted, &in_part);
            ((wanted.translation.vector - in_part.translation.vector).norm(), turn)
        };
        let is_point = |i: usize| {
            i < plan.rows.len() && {
                let (away, turn) = off(i);
                away < 1e-5 && turn < 1.8e-4
            }
        };
        let previous = next.checked_sub(1);
        let is_next = is_point(next);
        // Out of the cut after a point, or into it before one: along the tool axis.
        let is_line = |i: usize| {
            let wanted = plan.wanted(i);
            let lift = in_part.translation.vector - wanted.translation.vector;
            let axis = -(wanted.rotation * Vector3::z());
            let turn = angle_between(&wanted, &in_part);
            (lift - axis * lift.dot(&axis)).norm() < 2e-5 && lift.dot(&axis) > 0.0 && turn < 1.8e-4
        };
        let stands_at = if is_next {
            Some(next)
        } else {
            previous.filter(|i| is_line(*i)).or_else(|| (next < plan.rows.len() && is_line(next)).then_some(next))
        };
        let told = || {
            let near = off(next.min(plan.rows.len() - 1));
            format!(
                "{}: neither path point {next} (off by {:.6} m, {:.6} rad) nor a line along the tool axis",
                at(),
                near.0,
                near.1
            )
        };
        verdict.holds("line of a program", told, stands_at.is_some());
        let Some(i) = stands_at else { return Ok(()) };
        for (k, position) in step.external.iter().enumerate() {
            let slack = if cell.axes[k].is_rail { 1e-7 } else { 2e-6 };
            verdict.close("external axis of a program", at, *position, plan.rows[i].positions[k], slack);
        }
        // The feed of the first point of a segment has no effect; the line to it has that of the cut that follows.
        let is_first = i == 0 || cell.points[i - 1].segment != cell.points[i].segment;
        let fed = if is_first && cell.points.get(i + 1).is_some_and(|next| next.segment == cell.points[i].segment) {
            i + 1
        } else {
            i
        };
        let feed = cell.points[fed]
            .speed
            .or(cell.setting("redundancy", "feed_mm_per_s").map(|feed| feed * 1e-3))
            .unwrap_or(f64::NAN);
        // What the tool touches has the feed of the path: a tip that leans otherwise has another.
        let way = |points: &[Point]| (points[fed].place - points[fed - 1].place).norm();
        let is_moved = fed > 0 && cell.points[fed - 1].segment == cell.points[fed].segment && way(&cell.points) > 1e-9;
        let feed = if is_moved { feed * way(&plan.points) / way(&cell.points) } else { feed };
        let least = if program.feed_slack > 1e-4 { feed.max(1e-3) } else { feed };
        verdict.close("feed of a program (m/s)", at, step.feed, least, program.feed_slack);
        // The arm, followed from where it is.
        if let (Some(here), Some((from, external))) = (joints, &last) {
            let turn = (in_part.rotation * from.rotation.inverse()).scaled_axis();
            let mut found = Some(here);
            for part in 1..=8 {
                let share = f64::from(part) / 8.0;
                let positions: Vec<f64> =
                    external.iter().zip(&step.external).map(|(a, b)| a + (b - a) * share).collect();
                let target =
                    Isometry3::new(from.translation.vector.lerp(&in_part.translation.vector, share), turn * share)
                        * from.rotation;
                let stand = cell.at(&plan.placement, &here, &positions);
                found = found.and_then(|near| {
                    cell.arm.reach(&stand.frames[0], &(stand.part * target * cell.tool.inverse()), &near)
                });
            }
            verdict.holds("the arm follows a program", at, found.is_some());
            if let (Some(found), true) = (found, is_next) {
                let off = (0..6).map(|j| (found[j] - plan.rows[next].joints[j]).abs()).fold(0.0, f64::max);
                verdict.within("joint angles of a program (rad)", at, off, 2e-3);
            }
            joints = found;
            last = Some((in_part, step.external.clone()));
        }
        if is_next {
            next += 1;
        }
    }
    verdict.holds("points of a program", || format!("{name}: {next} of {}", plan.rows.len()), next == plan.rows.len());
    Ok(())
}
