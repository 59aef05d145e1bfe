//! Moves between segments, as the summary states them: where they begin and end, that they are free, how long they
//! take.

use crate::cell::{Body, Cell, Frame, Stand};
use crate::plan::{Plan, SHAPE_SLACK};
use crate::solid::Solid;
use crate::values::{Answer, angle_between, number, plain, section};
use crate::verdict::Verdict;
use nalgebra::{Isometry3, Rotation3, Vector3};
use serde_json::Value;

/// The shapes of moves with the tool out of the cut.
pub(crate) struct WithTool {
    bodies: Vec<Body>,
    pairs: Vec<[usize; 2]>,
}

fn body(name: &str, frame: Frame, pose: Isometry3<f64>, solid: Solid) -> Body {
    Body { name: name.to_owned(), attached: String::new(), frame, pose, solid }
}

impl WithTool {
    /// Cutter and holder as far as they are stated, against all that is not on the arm; the path's box where no shape
    /// is the part.
    pub(crate) fn new(cell: &Cell) -> Self {
        let (mut bodies, mut pairs) = (cell.bodies.clone(), cell.pairs.clone());
        let count = bodies.len();
        let tool = section(&cell.run, "tool");
        let of = |key: &str| tool.and_then(|table| number(table, key)).map(|mm| mm * 1e-3);
        let up = |from: f64, to: f64| cell.tool * Isometry3::translation(0.0, 0.0, -(from + to) / 2.0);
        let mut height = of("flute_length_mm").unwrap_or(0.0);
        let mut pieces = Vec::new();
        if let Some(diameter) = of("cutter_diameter_mm") {
            pieces.push(body(
                "cutter",
                Frame::Link(6),
                up(0.0, height),
                Solid::cylinder(diameter / 2.0, height.max(1e-4)),
            ));
        }
        for pair in tool.and_then(|table| table.get("holder_mm")).and_then(toml::Value::as_array).into_iter().flatten()
        {
            let entries: Vec<f64> = pair.as_array().into_iter().flatten().filter_map(plain).collect();
            if let [length, diameter] = entries[..] {
                let top = height + length * 1e-3;
                pieces.push(body(
                    "holder",
                    Frame::Link(6),
                    up(height, top),
                    Solid::cylinder(diameter * 0.5e-3, length * 1e-3),
                ));
                height = top;
            }
        }
        if pieces.is_empty() {
            pieces.push(body("tool point", Frame::Link(6), cell.tool, Solid::capsule(0.5e-4, 0.0)));
        }
        for piece in pieces {
            let own = bodies.len();
            bodies.push(piece);
            pairs.extend(
                (0..count).filter(|other| !matches!(bodies[*other].frame, Frame::Link(_))).map(|other| [own, other]),
            );
        }
        if let Some(extent) = path_box(cell) {
            let part = bodies.len();
            bodies.push(extent);
            pairs.extend((count..part).map(|piece| [piece, part]));
        }
        Self { bodies, pairs }
    }

    fn nearest(&self, cell: &Cell, stand: &Stand) -> (f64, String) {
        let limit = cell.clearance.max(1e-3);
        cell.nearest(&self.bodies, &self.pairs, stand, limit)
            .map_or((f64::INFINITY, String::new()), |(distance, pair)| {
                (distance, pair.map(|body| self.bodies[body].name.as_str()).join(" and "))
            })
    }
}

/// The box of the path's extent, where no shape attached to the part holds the path and all tool axes are one.
fn path_box(cell: &Cell) -> Option<Body> {
    let points = &cell.points;
    let holds = |body: &Body| {
        let [low, high] = body.solid.extent;
        let inside = |place: &Vector3<f64>| {
            let at = body.pose.inverse() * nalgebra::Point3::from(*place);
            (0..3).all(|k| at[k] >= low[k] - 0.01 && at[k] <= high[k] + 0.01)
        };
        2 * points.iter().filter(|point| inside(&point.place)).count() >= points.len()
    };
    let axis = points.first()?.axes.column(2).into_owned();
    let is_one = points.iter().all(|point| (point.axes.column(2) - axis).norm() <= 1e-6);
    if !is_one || cell.bodies.iter().filter(|body| body.frame == Frame::Part).any(holds) {
        return None;
    }
    // A box with one side along the tool axis: for an upright tool that of the task's own axes.
    let turned = match (axis - Vector3::z()).norm() <= 1e-6 {
        true => Rotation3::identity(),
        false => {
            let other = if axis.z.abs() < 0.5 { Vector3::z() } else { Vector3::x() };
            let x = other.cross(&axis).normalize();
            Rotation3::from_basis_unchecked(&[x, axis.cross(&x), axis])
        }
    };
    let local: Vec<Vector3<f64>> = points.iter().map(|point| turned.inverse() * point.place).collect();
    let (low, high) = local.iter().fold((local[0], local[0]), |(low, high), v| (low.inf(v), high.sup(v)));
    let edges = (high - low).sup(&Vector3::repeat(1e-4));
    Some(body(
        "extent of the path",
        Frame::Part,
        crate::values::placed(&turned, &(turned * ((low + high) / 2.0))),
        Solid::cuboid(&edges),
    ))
}

/// Least time from rest to rest over a distance within speed, acceleration and jerk.
pub(crate) fn rest_to_rest(distance: f64, speed: f64, acceleration: f64, jerk: f64) -> f64 {
    // The speed that is reached, or the limit.
    let ramp = |v: f64| {
        if v * jerk >= acceleration * acceleration {
            v / acceleration + acceleration / jerk
        } else {
            2.0 * (v / jerk).sqrt()
        }
    };
    if speed * ramp(speed) <= distance {
        return distance / speed + ramp(speed);
    }
    let (mut low, mut high) = (0.0, speed);
    for _ in 0..200 {
        let middle = (low + high) / 2.0;
        if middle * ramp(middle) < distance { low = middle } else { high = middle }
    }
    2.0 * ramp((low + high) / 2.0)
}

/// By so much a distance between two printed joint angles may be off. rad
const ROUNDED: f64 = 1.8e-6;

fn angles(value: &Value) -> Option<[f64; 6]> {
    let all: Vec<f64> = value.as_array()?.iter().filter_map(Value::as_f64).map(f64::to_radians).collect();
    all.try_into().ok()
}

/// All moves of a plan.
pub(crate) fn judge(verdict: &mut Verdict, plan: &Plan<'_>, case: &Value) -> Answer<()> {
    let cell = plan.cell;
    let transfers = case.get("transfers").and_then(Value::as_array).ok_or("no transfers in the summary")?;
    let last = cell.points.last().map_or(0, |point| point.segment);
    verdict.holds("number of moves", || plan.name.clone(), transfers.len() + 1 == last);
    let with_tool = WithTool::new(cell);
    for transfer in transfers {
        let after = transfer.get("after_segment").and_then(Value::as_u64).ok_or("a move after no segment")? as usize;
        let Some(end) = cell.points.iter().rposition(|point| point.segment == after) else { continue };
        let at = |what: &str| format!("{} after segment {after}: {what}", plan.name);
        let stated: Vec<[f64; 6]> =
            transfer.get("joints_deg").and_then(Value::as_array).into_iter().flatten().filter_map(angles).collect();
        let has_shapes = !cell.bodies.is_empty() || !cell.zones.is_empty();
        verdict.holds("a way where there are shapes", || at("no joint angles"), stated.len() >= 2 || !has_shapes);
        let [from, to] = [end, end + 1].map(|i| plan.rows[i].joints);
        let way = if stated.len() >= 2 { stated } else { vec![from, to] };
        let off = |a: &[f64; 6], b: &[f64; 6]| (0..6).map(|j| (a[j] - b[j]).abs()).fold(0.0, f64::max);
        let (first, arrives) = (way[0], way[way.len() - 1]);
        verdict.within("start of a move (rad)", || at("start"), off(&first, &from), 2e-6);
        verdict.within("end of a move (rad)", || at("end"), off(&arrives, &to), 2e-6);
        time(verdict, plan, transfer, &way, end, &at);
        let is_blocked = transfer.get("blocked_by").is_some_and(|value| !value.is_null());
        if !has_shapes || is_blocked {
            continue;
        }
        free(verdict, plan, &with_tool, transfer, &way, end, &at);
    }
    Ok(())
}

/// From which place on the external axes stand where the next segment has them.
fn axes_from(transfer: &Value) -> usize {
    if transfer.get("retracts").and_then(Value::as_bool) == Some(true) { 2 } else { 1 }
}

fn time(
    verdict: &mut Verdict,
    plan: &Plan<'_>,
    transfer: &Value,
    way: &[[f64; 6]],
    end: usize,
    at: &dyn Fn(&str) -> String,
) {
    let cell = plan.cell;
    let of = |key: &str, default: f64| cell.setting("transfer", key).unwrap_or(default);
    let (gather, jerk_time) = (of("acceleration_time_s", 0.4), of("jerk_time_s", 0.1));
    // Joint angles are printed in rounded digits, which change the time of a very short move by much: the least and the
    // most.
    let mut sum = Some([0.0; 2]);
    let moved_at = axes_from(transfer);
    for place in 1..way.len() {
        let mut longest = Some([0.0_f64; 2]);
        let motors = [place - 1, place].map(|place| cell.arm.motors(&way[place]));
        for (j, row) in cell.arm.rows.iter().enumerate() {
            let distance = (motors[1][j] - motors[0][j]).abs();
            // The product leaves out what is below its printed digits.
            if distance < 2e-7 {
                continue;
            }
            longest = longest.zip(row.speed).map(|(longest, speed)| {
                let acceleration = row.acceleration.unwrap_or(speed / gather);
                let jerk = row.jerk.unwrap_or(acceleration / jerk_time);
                let bounds = [(distance - ROUNDED).max(0.0), distance + ROUNDED];
                [0, 1].map(|k| longest[k].max(rest_to_rest(bounds[k], speed, acceleration, jerk)))
            });
        }
        if place == moved_at {
            for (k, axis) in cell.axes.iter().enumerate() {
                let distance = (plan.rows[end + 1].positions[k] - plan.rows[end].positions[k]).abs();
                if distance > 0.0 {
                    longest = longest.zip(axis.speed).map(|(longest, speed)| {
                        let acceleration = speed / gather;
                        let time = rest_to_rest(distance, speed, acceleration, acceleration / jerk_time);
                        longest.map(|longest| longest.max(time))
                    });
                }
            }
        }
        sum = sum.zip(longest).map(|(sum, longest)| [0, 1].map(|k| sum[k] + longest[k]));
    }
    let stated = transfer.get("duration_s").and_then(Value::as_f64);
    let told = || at(&format!("duration stated {stated:?}, computed {sum:?}"));
    let is_right = match (stated, sum) {
        (Some(stated), Some([least, most])) => {
            let slack = 2e-4 + 1e-3 * stated;
            (least - slack..=most + slack).contains(&stated)
        }
        (None, None) => true,
        _ => false,
    };
    verdict.holds("duration of a move (s)", told, is_right);
    let travel =
        (0..6).map(|j| way.windows(2).map(|step| (step[1][j] - step[0][j]).abs()).sum::<f64>()).fold(0.0, f64::max);
    let stated = transfer.get("travel_deg").and_then(Value::as_f64).unwrap_or(f64::NAN);
    verdict.close("travel of a move (deg)", || at("travel"), stated, travel.to_degrees(), 1e-4 * way.len() as f64);
}

fn free(
    verdict: &mut Verdict,
    plan: &Plan<'_>,
    with_tool: &WithTool,
    transfer: &Value,
    way: &[[f64; 6]],
    end: usize,
    at: &dyn Fn(&str) -> String,
) {
    let cell = plan.cell;
    let [retracts, approaches] =
        ["retracts", "approaches"].map(|key| transfer.get(key).and_then(Value::as_bool) == Some(true));
    let moved_at = axes_from(transfer);
    let positions = [&plan.rows[end].positions, &plan.rows[end + 1].positions];
    for place in way.iter() {
        for (j, row) in cell.arm.rows.iter().enumerate() {
            let beyond = (row.min - place[j]).max(place[j] - row.max);
            verdict.within("joint limit of a move (rad)", || at(&format!("joint {}", j + 1)), beyond, 1e-6);
        }
        if let Some([min, max]) = cell.arm.sum {
            let sum = cell.arm.forearm(place);
            verdict.within("sum of joints 2 and 3 of a move (rad)", || at("sum"), (min - sum).max(sum - max), 2e-6);
        }
    }
    let wanted = cell.setting("transfer", "retract_mm").unwrap_or(50.0) * 1e-3;
    for (which, is_line, i) in [(0, retracts, end), (1, approaches, end + 1)] {
        let short = transfer.get("short_lines").and_then(|all| all.get(which)).filter(|line| !line.is_null());
        verdict.holds(
            "a line out of the cut, or why not",
            || at(["line out", "line in"][which]),
            is_line || short.is_some(),
        );
        let stand = |joints: &[f64; 6]| cell.at(&plan.placement, joints, &plan.rows[i].positions);
        if !is_line {
            continue;
        }
        let (low, high) = if which == 0 { (way[0], way[1]) } else { (way[way.len() - 1], way[way.len() - 2]) };
        let [from, to] = [stand(&low), stand(&high)];
        let axis = -(from.tool.rotation * Vector3::z());
        let lift = to.tool.translation.vector - from.tool.translation.vector;
        let aside = (lift - axis * lift.dot(&axis)).norm();
        verdict.within("a line along the tool axis (m)", || at(["line out", "line in"][which]), aside, 5e-5);
        let turn = angle_between(&from.tool, &to.tool);
        verdict.within("a line without a turn (rad)", || at(["line out", "line in"][which]), turn, 2e-5);
        if short.is_none() {
            verdict.within(
                "length of a line (m)",
                || at(["line out", "line in"][which]),
                wanted,
                lift.dot(&axis) + 5e-5,
            );
        }
        // The line itself, against all but the part that the tool has cut.
        let steps = (lift.norm() / 5e-3).ceil().max(1.0) as usize;
        let mut joints = low;
        for step in 1..=steps {
            // A line may end where the arm is stretched or folded, but for the rounding of the printed joint angles.
            let reach = |less: f64| {
                let along = lift * (step as f64 / steps as f64) - axis * less;
                let target = Isometry3::from_parts((from.tool.translation.vector + along).into(), from.tool.rotation);
                cell.arm.reach(&from.frames[0], &(target * cell.tool.inverse()), &joints)
            };
            let Some(found) = reach(0.0).or_else(|| reach(1e-5)) else {
                verdict.holds("reach along a line", || at(["line out", "line in"][which]), false);
                break;
            };
            joints = found;
            let here = stand(&joints);
            let nearest = cell.nearest(&cell.bodies, &cell.pairs, &here, cell.clearance.max(1e-3));
            let distance = nearest.as_ref().map_or(f64::INFINITY, |(distance, _)| *distance);
            let names = nearest
                .map_or(String::new(), |(_, pair)| pair.map(|body| cell.bodies[body].name.as_str()).join(" and "));
            verdict.within(
                "clearance along a line (m)",
                || at(&format!("{} {names}", ["line out", "line in"][which])),
                0.9 * cell.clearance,
                distance + SHAPE_SLACK,
            );
            if let Some((depth, zone)) = cell.zone_depth(&here) {
                verdict.within("zone along a line (m)", || at(&zone), depth, 1e-5);
            }
        }
    }
    for place in 1..way.len() {
        let is_line = (retracts && place == 1) || (approaches && place + 1 == way.len());
        if is_line {
            continue;
        }
        // On a direct way the external axes move with the joints; on any other while the arm stands still.
        let (a, b) = (way[place - 1], way[place]);
        let [stood, stands] = match place.cmp(&moved_at) {
            std::cmp::Ordering::Less => [0.0, 0.0],
            std::cmp::Ordering::Equal => [0.0, 1.0],
            std::cmp::Ordering::Greater => [1.0, 1.0],
        };
        let most = (0..6).map(|j| (a[j] - b[j]).abs()).fold(0.0, f64::max);
        let farther = positions[0].iter().zip(positions[1]).map(|(p, q)| (p - q).abs()).fold(0.0, f64::max);
        let steps = ((most / 0.02).max(farther / 0.02).ceil() as usize).clamp(1, 400);
        for step in 0..=steps {
            let share = step as f64 / steps as f64;
            let joints: [f64; 6] = std::array::from_fn(|j| a[j] + (b[j] - a[j]) * share);
            let moved = stood + (stands - stood) * share;
            let here: Vec<f64> = positions[0].iter().zip(positions[1]).map(|(p, q)| p + (q - p) * moved).collect();
            let stand = cell.at(&plan.placement, &joints, &here);
            let (distance, names) = with_tool.nearest(cell, &stand);
            verdict.within(
                "clearance of a joint move (m)",
                || at(&format!("move {place} at {share:.3}: {names}")),
                0.9 * cell.clearance,
                distance + SHAPE_SLACK,
            );
            if let Some((depth, zone)) = cell.zone_depth(&stand) {
                verdict.within(
                    "zone on a joint move (m)",
                    || at(&format!("move {place} at {share:.3}: {zone}")),
                    depth,
                    1e-4,
                );
            }
        }
    }
}
