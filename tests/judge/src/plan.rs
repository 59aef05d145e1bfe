//! A plan, point by point: poses, limits, steps, deflections, scores; and what it comes to.

mod distances;

pub(crate) use distances::SHAPE_SLACK;

use crate::cell::{Cell, Placement, Stand};
use crate::path::Point;
use crate::score::{Criterion, Loaded};
use crate::values::{Answer, angle_between, section, text};
use crate::verdict::Verdict;
use crate::yielding::{Loading, ORIGINS};
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Vector3};
use serde_json::Value;
use std::path::Path;

/// A row of a plan file, in SI units and rad.
#[derive(Debug, Clone)]
pub(crate) struct Row {
    pub segment: usize,
    pub place: Vector3<f64>,
    pub beta: f64,
    pub posture: usize,
    pub posture_words: String,
    pub turns: [f64; 3],
    pub joints: [f64; 6],
    pub inverse_condition: f64,
    pub force: Vector3<f64>,
    pub deflection: Vector3<f64>,
    /// Normal, feed, axial, score, total.
    pub parts: [f64; 5],
    /// What each thing that yields adds to the scored part, where the table says so.
    pub origins: Option<Vec<f64>>,
    /// Of the external axes.
    pub positions: Vec<f64>,
    /// Lead and tilt, where the tool leans.
    pub lean: Option<[f64; 2]>,
    pub clearance: Option<f64>,
    pub nearest: String,
}

/// Half of the last printed digit of angles (rad) and lengths (m).
const HALF_ANGLE: f64 = 0.5e-4 * std::f64::consts::PI / 180.0;
const HALF_LENGTH: f64 = 0.5e-7;

/// A plan file.
pub(crate) fn read(file: &Path, cell: &Cell) -> Answer<Vec<Row>> {
    let told = |error: String| format!("{}: {error}", file.display());
    let mut reader = csv::Reader::from_path(file).map_err(|error| told(error.to_string()))?;
    let names: Vec<String> =
        reader.headers().map_err(|error| told(error.to_string()))?.iter().map(str::to_owned).collect();
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| told(error.to_string()))?;
        let cell_of = |name: &str| names.iter().position(|known| known == name).and_then(|column| record.get(column));
        let maybe = |name: &str| cell_of(name).and_then(|text| text.parse::<f64>().ok());
        let value = |name: &str| maybe(name).ok_or_else(|| told(format!("no number in {name}")));
        let three = |stem: &str, unit: &str, scale: f64| {
            Ok::<_, String>(
                Vector3::new(
                    value(&format!("{stem}x{unit}"))?,
                    value(&format!("{stem}y{unit}"))?,
                    value(&format!("{stem}z{unit}"))?,
                ) * scale,
            )
        };
        let mut joints = [0.0; 6];
        for (j, joint) in joints.iter_mut().enumerate() {
            *joint = value(&format!("theta{}_deg", j + 1))?.to_radians();
        }
        let mut positions = Vec::new();
        for (k, axis) in cell.axes.iter().enumerate() {
            positions.push(match axis.is_rail {
                true => value(&format!("e{}_mm", k + 1))? * 1e-3,
                false => value(&format!("e{}_deg", k + 1))?.to_radians(),
            });
        }
        let part = |name: &str| value(name).map(|mm| mm * 1e-3);
        rows.push(Row {
            segment: value("segment")? as usize,
            place: three("", "_mm", 1e-3)?,
            beta: value("beta_deg")?.to_radians(),
            posture: value("posture")? as usize,
            posture_words: cell_of("posture_words").unwrap_or_default().to_owned(),
            turns: [value("turn_1")?, value("turn_4")?, value("turn_6")?],
            joints,
            inverse_condition: value("inverse_condition")?,
            force: three("force_", "_n", 1.0)?,
            deflection: three("deflection_", "_mm", 1e-3)?,
            parts: [part("normal_mm")?, part("feed_mm")?, part("axial_mm")?, part("score_mm")?, part("total_mm")?],
            origins: ORIGINS.iter().map(|name| Some(maybe(&format!("from_{name}_mm"))? * 1e-3)).collect(),
            positions,
            lean: maybe("lead_deg").zip(maybe("tilt_deg")).map(|(a, b)| [a.to_radians(), b.to_radians()]),
            clearance: maybe("clearance_mm").map(|mm| mm * 1e-3),
            nearest: cell_of("nearest_pair").unwrap_or_default().to_owned(),
        });
    }
    Ok(rows)
}

/// A plan at its placement.
pub(crate) struct Plan<'a> {
    pub cell: &'a Cell,
    pub placement: Placement,
    /// Those of the task, with the tool leaning as the rows have it.
    pub points: Vec<Point>,
    pub leans: Vec<[f64; 2]>,
    pub rows: Vec<Row>,
    pub name: String,
}

impl Plan<'_> {
    pub(crate) fn stand(&self, i: usize) -> Stand {
        let row = &self.rows[i];
        self.cell.at(&self.placement, &row.joints, &row.positions)
    }

    fn point(&self, i: usize) -> &Point {
        &self.points[i]
    }

    /// Distance along the task to a point from the one before, however the tool leans. m
    fn length(&self, i: usize) -> f64 {
        (self.cell.points[i].place - self.cell.points[i - 1].place).norm()
    }

    fn at(&self, i: usize) -> String {
        format!("{} point {i}", self.name)
    }

    /// By how much the printed digits of the angles can be off at the tool centre point. m
    fn slack(&self, stand: &Stand) -> f64 {
        let tool = stand.tool.translation.vector;
        let arm: f64 = (1..7).map(|k| (tool - stand.frames[k].translation.vector).norm() * HALF_ANGLE).sum();
        let axes: f64 = self
            .cell
            .axes
            .iter()
            .map(|axis| if axis.is_rail { HALF_LENGTH } else { (tool - axis.point).norm() * HALF_ANGLE })
            .sum();
        arm + axes + 2.0 * HALF_LENGTH
    }

    /// Tool frame in the frame of the part that the task and beta ask for.
    pub(crate) fn wanted(&self, i: usize) -> Isometry3<f64> {
        let (point, beta) = (self.point(i), self.rows[i].beta);
        let x = point.axes.column(0) * beta.cos() + point.axes.column(1) * beta.sin();
        let z = -point.axes.column(2);
        let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, z.cross(&x), z.into_owned()]));
        crate::values::placed(&rotation, &point.place)
    }

    fn is_in_place(&self, i: usize) -> bool {
        self.length(i) < 1e-9
    }

    /// Whether the point and the one before it are of one segment.
    fn follows(&self, i: usize) -> bool {
        i > 0 && self.point(i).segment == self.point(i - 1).segment
    }

    pub(crate) fn judge(&self, verdict: &mut Verdict, case: &Value) {
        verdict.holds("points of the plan", || self.name.clone(), self.rows.len() == self.cell.points.len());
        if self.rows.len() != self.cell.points.len() {
            return;
        }
        let criterion = Criterion::read(self.cell);
        let (mut scores, mut slacks) = (Vec::with_capacity(self.rows.len()), Vec::with_capacity(self.rows.len()));
        for i in 0..self.rows.len() {
            let stand = self.stand(i);
            self.pose(verdict, i, &stand);
            self.limits(verdict, i, &stand);
            self.posture(verdict, i, &stand);
            let (score, slack) = self.load(verdict, i, &stand, &criterion);
            scores.push(score);
            slacks.push(slack);
            if self.follows(i) {
                self.step(verdict, i);
            }
            self.clear(verdict, i, &stand);
        }
        self.axes(verdict);
        crate::lean::judge(verdict, &self.name, &self.cell.run, &self.cell.points, &self.leans);
        self.stays(verdict);
        self.cell_bounds(verdict);
        self.figures(verdict, case, &criterion, (&scores, &slacks));
        let told: Vec<u64> = case
            .get("unfollowed_moves")
            .and_then(Value::as_array)
            .into_iter()
            .flatten()
            .filter_map(|told| told.get("to_point").and_then(Value::as_u64))
            .collect();
        for i in (1..self.rows.len()).filter(|i| self.follows(*i)) {
            let feed = self.between(verdict, i, told.contains(&(i as u64)));
            let segment = self.point(i).segment;
            let stated = case.pointer(&format!("/feed/segments_mm_per_s/{}", segment - 1)).and_then(Value::as_f64);
            if let Some(stated) = stated {
                let told = || format!("{} segment {segment}", self.at(i));
                verdict.within("highest feed (m/s)", told, stated * 1e-3, feed * (1.0 + 1e-3) + 1e-6);
            } else {
                verdict.holds("highest feed", || format!("{} segment {segment}: none stated", self.at(i)), feed > 1e6);
            }
        }
    }

    fn pose(&self, verdict: &mut Verdict, i: usize, stand: &Stand) {
        let slack = self.slack(stand);
        let wanted = stand.part * self.wanted(i);
        let off = (wanted.translation.vector - stand.tool.translation.vector).norm();
        verdict.within("position of the tool (m)", || self.at(i), off, slack);
        let turn = angle_between(&wanted, &stand.tool);
        verdict.within(
            "orientation of the tool (rad)",
            || self.at(i),
            turn,
            (8.0 + self.cell.axes.len() as f64) * HALF_ANGLE,
        );
        let seen = (stand.carrier.inverse() * Point3::from(wanted.translation.vector)).coords;
        verdict.within("stated position (m)", || self.at(i), (seen - self.rows[i].place).amax(), slack);
        verdict.holds("stated segment", || self.at(i), self.rows[i].segment == self.point(i).segment);
    }

    fn limits(&self, verdict: &mut Verdict, i: usize, stand: &Stand) {
        let of = |key: &str| self.cell.setting("constraints", key);
        let margin = of("joint_margin_deg").unwrap_or(0.0).to_radians();
        for (j, row) in self.cell.arm.rows.iter().enumerate() {
            let angle = self.rows[i].joints[j];
            let beyond = (row.min + margin - angle).max(angle - row.max + margin);
            verdict.within(
                "joint limit (rad)",
                || format!("{} joint {}", self.at(i), j + 1),
                beyond,
                1.01 * HALF_ANGLE,
            );
        }
        if let Some([min, max]) = self.cell.arm.sum {
            let sum = self.cell.arm.forearm(&self.rows[i].joints);
            let beyond = (min + margin - sum).max(sum - max + margin);
            verdict.within("limit of the sum of joints 2 and 3 (rad)", || self.at(i), beyond, 2.02 * HALF_ANGLE);
        }
        let tool = stand.tool.translation.vector;
        let length = of("characteristic_length_mm").unwrap_or(f64::NAN) * 1e-3;
        let condition = self.cell.arm.inverse_condition(&stand.frames, &tool, length);
        verdict.close("inverse condition", || self.at(i), self.rows[i].inverse_condition, condition, 1e-5);
        verdict.within(
            "least inverse condition",
            || self.at(i),
            of("min_inverse_condition").unwrap_or(0.0),
            condition + 1e-5,
        );
        if let Some(least) = of("min_base_distance_mm") {
            let base = stand.frames[0];
            let seen = base.inverse() * Point3::from(tool);
            let first = self.cell.arm.frames(&Isometry3::identity(), &[0.0; 6])[1];
            let away = seen.coords - first.translation.vector;
            let axis = first.rotation * Vector3::z();
            let distance = (away - axis * away.dot(&axis)).norm();
            verdict.within("distance from axis 1 (m)", || self.at(i), least * 1e-3, distance + self.slack(stand));
        }
        if let Some(most) = of("max_deflection_mm") {
            verdict.within("largest score (m)", || self.at(i), self.rows[i].parts[3], most * 1e-3 + 1e-9);
        }
    }

    fn posture(&self, verdict: &mut Verdict, i: usize, stand: &Stand) {
        let row = &self.rows[i];
        let wrist = Point3::from(self.cell.arm.wrist(&stand.frames));
        let is_back = (stand.frames[1].inverse() * wrist).x < 0.0;
        // From axis 3 to the wrist, in the frame of row 2, whose x axis runs along the upper arm.
        let forearm = stand.frames[2].inverse() * (wrist - stand.frames[3].translation.vector).coords;
        let elbow = forearm.y.atan2(forearm.x);
        let number = 1 + 4 * usize::from(is_back) + 2 * usize::from(elbow <= 0.0) + usize::from(row.joints[4] < 0.0);
        verdict.holds(
            "posture",
            || format!("{}: stated {}, computed {number}", self.at(i), row.posture),
            number == row.posture,
        );
        let words = self.posture_words(row, &wrist, stand);
        // Where the arm is stretched, or the wrist straight, it is between two.
        if let Some(words) = &words {
            verdict.holds(
                "posture words",
                || format!("{}: stated {}, computed {words:?}", self.at(i), row.posture_words),
                words.join("; ") == row.posture_words,
            );
        }
        let table = section(&self.cell.run, "postures");
        if let Some(allowed) = table.and_then(|table| table.get("allowed")).and_then(toml::Value::as_array) {
            let is_number = |entry: &toml::Value| entry.as_integer() == Some(row.posture as i64);
            let mut requested = allowed.iter().filter_map(toml::Value::as_str).peekable();
            let stated: Vec<&str> = row.posture_words.split("; ").collect();
            let has_words = requested.peek().is_some() && requested.all(|word| stated.contains(&word));
            verdict.holds("allowed posture", || self.at(i), has_words || allowed.iter().any(is_number));
        }
        let is_one = table.and_then(|table| crate::values::text(table, "changes")) == Some("never");
        if i > 0 && (is_one || self.follows(i)) {
            verdict.holds("one posture", || self.at(i), row.posture == self.rows[i - 1].posture);
        }
        for (k, j) in [0, 3, 5].into_iter().enumerate() {
            let turns = (row.joints[j] / std::f64::consts::TAU).abs().fract();
            let is_edge = (turns - 0.5).abs() < 1e-6;
            let found = (row.joints[j] / std::f64::consts::TAU).round();
            verdict.holds("turns", || format!("{} joint {}", self.at(i), j + 1), is_edge || found == row.turns[k]);
        }
    }

    /// The posture in words, from where axes 2 and 3 and the wrist are in the base of the rows.
    fn posture_words(&self, row: &Row, wrist: &Point3<f64>, stand: &Stand) -> Option<[&'static str; 3]> {
        let base = stand.frames[0].inverse();
        let at = |frame: usize| base * Point3::from(stand.frames[frame].translation.vector);
        let (first, second, third, wrist) = (at(1), at(2), at(3), base * wrist);
        let out = (base * stand.frames[1]).rotation * nalgebra::Vector3::x();
        let out = if self.cell.arm.rows[1].a < 0.0 { -out } else { out };
        let ahead = (wrist - first).dot(&out);
        let flat = |point: Point3<f64>| ((point - second).dot(&out), (point - second).z);
        let ((far, high), (reach, rise)) = (flat(wrist), flat(third));
        // To the left of the line from axis 2 to the wrist is above it where the wrist is in front.
        let left = far * rise - high * reach;
        let counting = self.cell.arm.counting.as_ref();
        let fifth = counting.map_or(row.joints[4], |of| of.sign[4] * (row.joints[4] - of.offset[4]));
        let is_told = ahead.abs() > 1e-6 && left.abs() > 1e-6 && fifth.sin().abs() > 1e-6;
        is_told.then(|| {
            [
                if ahead > 0.0 { "front" } else { "back" },
                if (left > 0.0) == (ahead > 0.0) { "elbow up" } else { "elbow down" },
                if fifth.sin() < 0.0 { "flip" } else { "no flip" },
            ]
        })
    }

    /// The load, what it does, and what the criterion makes of it, with what the printed digits of the angles change of
    /// that. m
    fn load(&self, verdict: &mut Verdict, i: usize, stand: &Stand, criterion: &Criterion) -> (f64, f64) {
        let (row, point) = (&self.rows[i], self.point(i));
        let part = stand.part.rotation.to_rotation_matrix();
        let carrier = stand.carrier.rotation.inverse();
        let force = part * point.force;
        let size = force.norm();
        // Half the last digits of lead and tilt, 0.00005 deg each, where the force turns with the tool.
        let turned = if row.lean.is_some() { 2.25e-6 } else { 1e-6 };
        verdict.within("force (N)", || self.at(i), (carrier * force - row.force).amax(), 0.6e-4 + turned * size);
        let moment = part * point.moment;
        let loading = Loading { stand, joints: &row.joints, part: point.part.or(self.cell.beside.part) };
        let moved = loading.moved(self.cell, &self.cell.arm, &force, &moment);
        let slack = 0.6e-10 + OF_DIGITS * moved.norm();
        verdict.within("deflection (m)", || self.at(i), (carrier * moved - row.deflection).amax(), slack);
        let axes = part.matrix() * self.cell.points[i].axes;
        let stated = row.parts;
        for (k, column, word) in [(0, 1, "wall"), (1, 0, "feed"), (2, 2, "axis")] {
            let found = axes.column(column).dot(&moved);
            verdict.close("part of the deflection (m)", || format!("{} {word}", self.at(i)), stated[k], found, slack);
        }
        verdict.close("total deflection (m)", || self.at(i), stated[4], moved.norm(), slack);
        let normal = point.normal.map(|normal| part * normal);
        let load = Loaded { loading, force, moment, axes, normal };
        let score = criterion.score(self.cell, &load);
        if point.is_scored {
            self.origins(verdict, i, &criterion.by_origin(self.cell, &load), slack);
            verdict.close("score (m)", || self.at(i), stated[3], score, slack + OF_DIGITS * score);
        }
        (score, slack + OF_DIGITS * score)
    }

    /// What each thing that yields adds. Where the whole displacement turns, `slack` is what its digits do to a part.
    fn origins(&self, verdict: &mut Verdict, i: usize, found: &[f64; 6], slack: f64) {
        let stated = &self.rows[i].origins;
        verdict.holds("columns by what yields", || self.at(i), stated.is_some() == self.cell.yields_beside());
        let Some(stated) = stated else { return };
        let size: f64 = found.iter().map(|part| part.abs()).sum();
        // Where the parts add up to nothing their common sign is that of a rounding error.
        let is_cancelled = found.iter().sum::<f64>().abs() <= slack + OF_DIGITS * size;
        let is_other: f64 = found.iter().zip(stated).map(|(found, stated)| found * stated).sum();
        let found = if is_cancelled && is_other < 0.0 { (*found).map(|part| -part) } else { *found };
        for ((name, found), stated) in ORIGINS.iter().zip(&found).zip(stated) {
            let told = || format!("{} from {name}", self.at(i));
            verdict.close("part by what yields (m)", told, *stated, *found, slack + OF_DIGITS * size);
        }
    }

    fn step(&self, verdict: &mut Verdict, i: usize) {
        let of = |key: &str| self.cell.setting("redundancy", key);
        let [from, to] = [&self.rows[i - 1], &self.rows[i]];
        let length = self.length(i);
        let feed = self.point(i).speed.or(of("feed_mm_per_s").map(|feed| feed * 1e-3)).unwrap_or(f64::NAN);
        let time = if self.is_in_place(i) { f64::INFINITY } else { length / feed };
        let motors = [from, to].map(|row| self.cell.arm.motors(&row.joints));
        for (j, row) in self.cell.arm.rows.iter().enumerate() {
            let most = row.speed.map_or(f64::INFINITY, |speed| speed * time).min(std::f64::consts::PI);
            let most = if self.is_in_place(i) { most.min(std::f64::consts::TAU / 3.0) } else { most };
            let step = (motors[1][j] - motors[0][j]).abs();
            verdict.within(
                "joint step (rad)",
                || format!("{} joint {}", self.at(i), j + 1),
                step,
                most + 4.04 * HALF_ANGLE,
            );
        }
        for (k, axis) in self.cell.axes.iter().enumerate() {
            if let Some(speed) = axis.speed {
                let step = (to.positions[k] - from.positions[k]).abs();
                verdict.within(
                    "step of an external axis",
                    || format!("{} {}", self.at(i), axis.name),
                    step,
                    speed * time + 2.02 * HALF_ANGLE,
                );
            }
        }
        let parts = [i - 1, i].map(|i| self.stand(i).part);
        let turn = angle_between(&(parts[0] * self.wanted(i - 1)), &(parts[1] * self.wanted(i)));
        if self.is_in_place(i) {
            if of("max_spindle_turn_deg_per_mm").or(of("max_spindle_turn_deg_per_s")).is_some() {
                let [from, to] = [0, 1].map(|k| parts[k].rotation * self.point(i - 1 + k).axes.column(2));
                let tilt = from.cross(&to).norm().atan2(from.dot(&to));
                let limit = std::f64::consts::FRAC_PI_2.max(tilt + std::f64::consts::FRAC_PI_6);
                verdict.within("turn in place (rad)", || self.at(i), turn, limit + 2.02 * HALF_ANGLE);
            }
            return;
        }
        let mm = length * 1e3;
        if let Some(rate) = of("max_beta_rate_deg_per_mm") {
            let change = to.beta - from.beta;
            let step = change.sin().atan2(change.cos()).abs();
            verdict.within("rate of beta (rad)", || self.at(i), step, (rate * mm).to_radians() + 2.02 * HALF_ANGLE);
        }
        let by_length = of("max_spindle_turn_deg_per_mm").map(|limit| (limit * mm).to_radians());
        let by_time = of("max_spindle_turn_deg_per_s").map(|limit| (limit * time).to_radians());
        if let Some(limit) = by_length.into_iter().chain(by_time).reduce(f64::min) {
            verdict.within("turn of the spindle (rad)", || self.at(i), turn, limit + 2.02 * HALF_ANGLE);
        }
    }

    /// Beta, where it may not change.
    fn stays(&self, verdict: &mut Verdict) {
        let beta = section(&self.cell.run, "redundancy").and_then(|table| text(table, "beta")).unwrap_or("free");
        for i in (1..self.rows.len()).filter(|i| beta == "constant" || (beta != "free" && self.follows(*i))) {
            let change = self.rows[i].beta - self.rows[i - 1].beta;
            let change = change.sin().atan2(change.cos()).abs();
            verdict.within("beta that stays (rad)", || self.at(i), change, 2.02 * HALF_ANGLE);
        }
    }

    /// Ranges and uses of the external axes.
    fn axes(&self, verdict: &mut Verdict) {
        for (k, axis) in self.cell.axes.iter().enumerate() {
            for i in 0..self.rows.len() {
                let position = self.rows[i].positions[k];
                let beyond = (axis.range[0] - position).max(position - axis.range[1]);
                verdict.within(
                    "range of an external axis",
                    || format!("{} {}", self.at(i), axis.name),
                    beyond,
                    1.01 * HALF_ANGLE,
                );
                let stands = i > 0 && (axis.mode == "fixed" || (axis.mode == "indexed" && self.follows(i)));
                if stands {
                    let is_one = position == self.rows[i - 1].positions[k];
                    verdict.holds("use of an external axis", || format!("{} {}", self.at(i), axis.name), is_one);
                }
            }
        }
    }

    fn cell_bounds(&self, verdict: &mut Verdict) {
        let Some(table) = section(&self.cell.run, "cell") else { return };
        for (k, key) in ["x_mm", "y_mm", "z_mm"].into_iter().enumerate() {
            if let Some([low, high]) = crate::values::range(table, key, 1e-3) {
                let beyond = (low - self.placement.place[k]).max(self.placement.place[k] - high);
                verdict.within("bounds of the cell (m)", || format!("{} {key}", self.name), beyond, 1e-9);
            }
        }
        let degrees =
            crate::values::range(table, "yaw_deg", 1.0).map(|ends| ends.map(|end| (end.to_radians() / 2.0).sin()));
        let q4 = || crate::values::range(table, "q4", 1.0);
        let [low, high] = degrees.or_else(q4).unwrap_or([-1.0, 1.0]);
        let q4 = (self.placement.yaw / 2.0).sin();
        verdict.within("bounds of the cell (q4)", || self.name.clone(), (low - q4).max(q4 - high), 1e-9);
    }

    /// What the summary states of the plan.
    fn figures(&self, verdict: &mut Verdict, case: &Value, criterion: &Criterion, (scores, slacks): (&[f64], &[f64])) {
        let points = &self.cell.points;
        let mm = |key: &str| case.get(key).and_then(Value::as_f64).map(|mm| mm * 1e-3);
        // Joint travel, and the largest step of a joint.
        let pairs = || self.rows.windows(2).filter(|pair| pair[0].segment == pair[1].segment);
        let steps = || pairs().flat_map(|pair| (0..6).map(|j| (pair[1].joints[j] - pair[0].joints[j]).abs()));
        let (travel, largest) = (steps().sum::<f64>(), steps().fold(0.0, f64::max));
        let of_digits = 2.0 * HALF_ANGLE * steps().count() as f64;
        let per_radian = criterion.per_radian(points);
        let objective = criterion.objective(points, scores) + per_radian * travel;
        for (key, found, slack) in [("total_deg", travel, of_digits), ("max_step_deg", largest, 2.0 * HALF_ANGLE)] {
            let stated = case.pointer(&format!("/joint_travel/{key}")).and_then(Value::as_f64).unwrap_or(f64::NAN);
            let place = || format!("{} {key}", self.name);
            verdict.close("joint travel (rad)", place, stated.to_radians(), found, slack + 1.01 * HALF_ANGLE);
        }
        // No aggregate changes by more than the largest change of a score, with a weight where the largest is taken.
        let heaviest = points.iter().map(|point| criterion.weight(point)).fold(1.0, f64::max);
        let slack = 0.6e-10
            + per_radian * of_digits
            + slacks.iter().copied().fold(0.0, f64::max) * if criterion.aggregate == "max" { heaviest } else { 1.0 };
        let told = |key: &str| format!("{} {key}", self.name);
        verdict.close(
            "objective (m)",
            || told("objective_mm"),
            mm("objective_mm").unwrap_or(f64::NAN),
            objective,
            slack,
        );
        let scored: Vec<usize> = (0..points.len()).filter(|i| points[*i].is_scored).collect();
        let most = scored.iter().map(|i| scores[*i]).fold(0.0, f64::max);
        verdict.close("largest score (m)", || told("max_mm"), mm("max_mm").unwrap_or(f64::NAN), most, slack);
        let of = |part: &dyn Fn(&Row) -> f64| {
            let all: Vec<f64> = scored.iter().map(|i| part(&self.rows[*i]).abs()).collect();
            (all.iter().sum::<f64>() / all.len() as f64, all.iter().copied().fold(0.0, f64::max))
        };
        for (k, name) in ORIGINS.iter().enumerate().filter(|_| self.cell.yields_beside()) {
            let stated = case.pointer(&format!("/by_origin_mm/{name}_mm")).and_then(Value::as_f64).unwrap_or(f64::NAN);
            let all = scored.iter().filter_map(|i| self.rows[*i].origins.as_ref()).map(|all| all[k]);
            let mean = all.sum::<f64>() / scored.len() as f64;
            verdict.close("mean by what yields (m)", || told(name), stated * 1e-3, mean, 1.2e-10);
        }
        for (word, k) in [("wall", 0), ("feed", 1), ("axis", 2), ("total", 4)] {
            let (mean, most) = of(&|row| row.parts[k]);
            let stated = |key: &str| {
                case.pointer(&format!("/deflection_mm/{word}/{key}")).and_then(Value::as_f64).unwrap_or(f64::NAN) * 1e-3
            };
            verdict.close("mean deflection (m)", || told(word), stated("mean"), mean, 1.2e-10);
            verdict.close("largest deflection (m)", || told(word), stated("max"), most, 1.2e-10);
        }
    }
}

/// What the printed digits of six angles, half a unit of 0.0001 deg each (9e-7 rad), change of a deflection, relative
/// to it: each some five times itself at the most.
const OF_DIGITS: f64 = 3e-5;
