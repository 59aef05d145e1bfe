//! How far the tool may lean at each point, as the columns of the task have it.

use std::path::{Path, PathBuf};
use stead_disk::input::InputError;
use stead_format::place::Place;
use stead_format::task::{Imported, LEAN, PointLean};
use stead_problem::lean::LeanRange;
use stead_problem::problem::Interval;

/// Angles of a task and of `[lean]` that differ by less are one. rad
const ROUNDING: f64 = 1e-9;

/// What the columns of a task say of the lean, with the file and the line of each point.
pub(in super::super) struct PointLeans {
    file: PathBuf,
    lines: Vec<usize>,
    leans: Option<Vec<PointLean>>,
}

impl PointLeans {
    /// Takes the columns of a task, to which points may be added afterwards.
    ///
    /// # Errors
    /// [`InputError`] for columns that would say nothing of the points that are added.
    pub(in super::super) fn taken(
        task: &mut Imported,
        file: &Path,
        adds_points: bool,
        at: &Place<'_>,
    ) -> Result<Self, InputError> {
        let leans = task.leans.take();
        if leans.is_some() && adds_points {
            let problem = format!(
                "adds points to the task, whose columns {} to {} do not say how far the tool may lean there",
                LEAN[0], LEAN[3]
            );
            return Err(at.key("stock").error(problem, "[[lean.segment]] in place of the columns").found_if(None));
        }
        let lines = if leans.is_some() { task.lines.clone() } else { Vec::new() };
        Ok(Self { file: file.to_owned(), lines, leans })
    }

    /// That there are columns in a run whose tool does not lean.
    pub(in super::super) fn unused(&self) -> Option<String> {
        self.leans.as_ref().map(|_| {
            format!("the columns {} to {} of the task count for nothing without a table [lean]", LEAN[0], LEAN[3])
        })
    }

    /// What a point allows of a range; none is that of a point that is not scored, where the tool keeps to the axis of
    /// the task.
    ///
    /// # Errors
    /// [`InputError`] at the line of the point, where its columns are not within that.
    pub(super) fn range(&self, point: usize, all: Option<LeanRange>) -> Result<LeanRange, InputError> {
        let own = self.leans.as_ref().map_or_else(PointLean::default, |leans| leans[point]);
        let narrowed = |own: Option<[f64; 2]>, all: Option<Interval>, names: &[&str]| {
            let Some([min, max]) = own else { return Ok(all.unwrap_or(LeanRange::NONE.lead)) };
            let fail = |name: &str, value: f64, problem: &str, allowed: String| {
                InputError::new(&self.file, problem)
                    .at_line(self.lines.get(point).copied().unwrap_or(0))
                    .in_field(name)
                    .found(format!("{}", rounded(value)))
                    .allowed(allowed)
            };
            let Some(all) = all else {
                let problem = "leans the tool at a point that is not scored, where it keeps to the axis of the task";
                if min > ROUNDING {
                    return Err(fail(names[0], min, problem, "at most 0".to_owned()));
                }
                if max < -ROUNDING {
                    return Err(fail(names[1], max, problem, "at least 0".to_owned()));
                }
                return Ok(LeanRange::NONE.lead);
            };
            for (name, value) in names.iter().zip([min, max]) {
                if value < all.min - ROUNDING || value > all.max + ROUNDING {
                    let allowed = format!("{} to {}, the range of [lean] there", rounded(all.min), rounded(all.max));
                    return Err(fail(name, value, "is outside of what [lean] allows", allowed));
                }
            }
            Ok(Interval { min: min.max(all.min), max: max.min(all.max) })
        };
        Ok(LeanRange {
            lead: narrowed(own.lead, all.map(|all| all.lead), &LEAN[..2])?,
            tilt: narrowed(own.tilt, all.map(|all| all.tilt), &LEAN[2..])?,
        })
    }
}

/// An angle in degrees, as it was written.
fn rounded(angle: f64) -> f64 {
    (angle.to_degrees() * 1e9).round() / 1e9
}
