//! The deflection map in the page: joint angles of its states, from the problem, and scores and reasons, from its
//! table.

use super::PageError;
use super::packed::{Runs, SecondDifferences, Varints};
use super::table::Table;
use serde_json::Value;
use stead_model::robot::Posture;
use stead_model::robot::turns::Range;
use stead_planning::feasibility::{DeflectionMap, MapRow};
use stead_problem::problem::{Placement, Problem};

/// Joint angles in the page are multiples of this. deg
const ANGLE_STEP_DEG: f64 = 0.02;
/// Scores are multiples of this: the last digit that the page shows. mm
const SCORE_STEP_MM: f64 = 1e-4;
/// A map shows at most about so many path points: more are no wider than a pixel.
const COLUMNS: usize = 400;

/// The path points that a map in the page shows: all, or evenly chosen ones.
pub(super) fn columns(points: usize) -> Vec<usize> {
    let step = points.div_ceil(COLUMNS).max(1);
    (0..points).step_by(step).collect()
}

records! {
    /// A deflection map in `page-data.json`.
    pub struct MapData of (problem: &Problem, placement: &Placement, map: &DeflectionMap, table: &str) {
        let points = columns(map.rows.len());
        let joints = packed_joints(problem, placement, points.iter().map(|point| (*point, &map.rows[*point])));
    } with {
        /// The table of its scores.
        table: String = table.to_owned(),
        /// The path points that it shows, from 0.
        points: Vec<usize> = points,
        /// Angles about the tool axis at each point.
        beta_count: usize = map.beta_count,
        /// Joint angles are multiples of this. deg
        angle_step_deg: f64 = ANGLE_STEP_DEG,
        /// Joint angles of its allowed states: for each joint the second differences along beta, begun anew behind a
        /// state that is not allowed or has another posture.
        joints: String = joints,
    }
}

/// The joint angles of the allowed states of rows at path points.
fn packed_joints<'a>(
    problem: &Problem,
    placement: &Placement,
    rows: impl Iterator<Item = (usize, &'a MapRow)>,
) -> String {
    let mut packed = Varints::default();
    for (point, row) in rows {
        let mut last: Option<Posture> = None;
        let mut sequences = [SecondDifferences::default(); 6];
        for (k, cell) in row.iter().enumerate() {
            let posture = cell.as_ref().ok().map(|cell| cell.posture);
            if posture != last {
                sequences.iter_mut().for_each(SecondDifferences::restart);
            }
            last = posture;
            let Some(posture) = posture else { continue };
            let angles = state(problem, placement, point, problem.redundancy.beta(k), posture);
            for (sequence, angle) in sequences.iter_mut().zip(angles) {
                packed.push(sequence.next((angle.to_degrees() / ANGLE_STEP_DEG).round() as i64));
            }
        }
    }
    packed.text()
}

records! {
    /// Some columns of a deflection map as the script of the page has a whole one.
    pub struct MapColumns of (problem: &Problem, placement: &Placement, points: &[usize], rows: &[MapRow]) {
        let mut states = States::default();
        for row in rows {
            states.begin();
            for cell in row {
                match cell {
                    Ok(cell) => states.allowed(u8::from(cell.posture), cell.score * 1e3),
                    Err(reason) => states.refused(&reason.kind.code()),
                }
            }
        }
        let joints = packed_joints(problem, placement, points.iter().copied().zip(rows));
        let (codes, scores) = (states.codes.text(), states.packed.text());
    } with {
        /// The path points, from 0.
        points: Vec<usize> = points.to_vec(),
        /// Angles about the tool axis at each point.
        beta_count: usize = problem.redundancy.beta_count,
        /// Joint angles are multiples of this. deg
        angle_step_deg: f64 = ANGLE_STEP_DEG,
        /// Joint angles of the allowed states.
        joints: String = joints,
        /// For each state its posture, or 16 and the number of the reason why none is allowed.
        codes: String = codes,
        /// The reasons.
        reasons: Vec<String> = states.names,
        /// Scores are multiples of this. mm
        score_step_mm: f64 = SCORE_STEP_MM,
        /// Scores of the allowed states.
        scores: String = scores,
    }
}

/// States one after the other, as the script unpacks them.
#[derive(Debug, Default)]
struct States {
    names: Vec<String>,
    codes: Runs,
    packed: Varints,
    sequence: SecondDifferences,
}

impl States {
    /// Begins with another path point.
    fn begin(&mut self) {
        self.sequence.restart();
    }

    fn allowed(&mut self, posture: u8, score_mm: f64) {
        self.codes.push(i64::from(posture));
        self.packed.push(self.sequence.next((score_mm / SCORE_STEP_MM).round() as i64));
    }

    fn refused(&mut self, why: &str) {
        let known = self.names.iter().position(|name| name == why).unwrap_or(self.names.len());
        if known == self.names.len() {
            self.names.push(why.to_owned());
        }
        self.codes.push(16 + known as i64);
        self.sequence.restart();
    }
}

/// The joint angles of an allowed state, in the turn nearest to their ranges. rad
fn state(problem: &Problem, placement: &Placement, point: usize, beta: f64, posture: Posture) -> [f64; 6] {
    let flange = problem.at(placement).base_from_flange(point, beta);
    let mut angles = problem.robot.inverse(&flange, posture).unwrap_or_default();
    for (angle, joint) in angles.iter_mut().zip(problem.robot.joints()) {
        *angle = Range::of(joint).nearest(*angle).0;
    }
    angles
}

/// The map as the page's script wants it: the entry of `page-data.json` with the states of its table: `codes`, one for
/// each (the posture, or 16 and the number of its reason), as [`Runs`], and the `scores` of the allowed ones. Of the
/// table only the rows that are shown are kept: that of a long path has millions.
pub(super) fn content(entry: &Value, table: &Table<'_>) -> Result<Value, PageError> {
    let wrong = || PageError::data("maps", "is no description of a deflection map");
    let points = entry["points"].as_array().ok_or_else(wrong)?;
    let beta_count = entry["beta_count"].as_u64().filter(|count| *count > 0).ok_or_else(wrong)? as usize;
    let [score, posture, reason] = [table.column("score_mm")?, table.column("posture")?, table.column("reason")?];
    let mut rows = table.rows();
    let mut states = States::default();
    for point in points {
        let point = point.as_u64().ok_or_else(wrong)? as usize;
        states.begin();
        for row in point * beta_count..(point + 1) * beta_count {
            if !rows.go_to(row)? {
                return Err(table.error("has fewer states than page-data.json says: they are of two runs"));
            }
            match rows.text(reason) {
                "" => states.allowed(rows.number(posture)? as u8, rows.number(score)?),
                why => states.refused(why),
            }
        }
    }
    let mut value = entry.clone();
    value["codes"] = states.codes.text().into();
    value["reasons"] = states.names.into();
    value["score_step_mm"] = SCORE_STEP_MM.into();
    value["scores"] = states.packed.text().into();
    Ok(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn rows_that_are_not_shown_are_not_looked_at() {
        let (count, beta_count) = (2 * COLUMNS, 3);
        let shown = columns(count);
        let row = |point: usize, k: usize| match point % 2 {
            0 => format!("{point},1,{k},0.{:04},2,\n", point + k),
            _ => "no,row,that,is,looked,at\n".to_owned(),
        };
        let rows: String = (0..count).flat_map(|point| (0..beta_count).map(move |k| row(point, k))).collect();
        let text = format!("point,segment,beta_deg,score_mm,posture,reason\n{rows}");
        let entry = json!({ "points": shown, "beta_count": beta_count });
        let content = |text: &str| content(&entry, &Table::read("map.csv", text.as_bytes())?);
        assert_eq!(shown.len(), COLUMNS);
        let mut codes = Varints::default();
        [3 * COLUMNS as i64, 2].into_iter().for_each(|number| codes.push(number));
        assert_eq!(content(&text).unwrap()["codes"], codes.text().as_str());
        let cut: String = text.lines().take(100).map(|line| format!("{line}\n")).collect();
        assert!(content(&cut).unwrap_err().to_string().contains("has fewer states"));
    }
}
