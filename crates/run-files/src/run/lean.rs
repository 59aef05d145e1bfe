//! The table `[lean]`: how far the tool may lean from the axis of the path.

mod of_points;

pub(super) use of_points::PointLeans;

use super::reading::Reading;
use super::segments::by_segment;
use crate::Word;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Bound::{Excluded, Included};
use std::sync::Arc;
use stead_disk::input::InputError;
use stead_format::place::Place;
use stead_format::quantity::Quantity;
use stead_format::scalars::{Whole, words};
use stead_format::shapes::Interval;
use stead_format::tool::ToolTable;
use stead_format::units::{Deg, Mm, Positive, ranges};
use stead_model::task::Task;
use stead_model::task::lean::{ContactRule, CutterEnd, Lean, LeanForce, LeanRule};
use stead_numerics::digits::figures;
use stead_numerics::message::Note;
use stead_problem::lean::{LeanRange, LeanSpace};
use stead_problem::problem;

words!(ContactRule, LeanForce);

ranges! {
    /// An angle by which a tool may lean. deg
    LeanAngle: Included(-60.0), Included(60.0);
    /// The largest angle by which it may. deg
    LargestLean: Excluded(0.0), Included(60.0);
    /// A step of such an angle. deg
    LeanStep: Included(0.1), Included(30.0);
}

/// Steps of lead and tilt where none are stated. deg
const STEP_DEG: f64 = 2.5;
/// How far the contact may leave its line where nothing is stated. mm
const TOLERANCE_MM: f64 = 0.005;
/// Leans of a point at the most.
const MOST_LEANS: usize = 1681;
/// Memory for the states of a path at the most. Bytes
const MOST_MEMORY: f64 = 4e9;

/// How far the tool may lean from the axis that the task states. Without lead and tilt it keeps to that axis.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct LeanTable {
    /// Range `[min, max]` of the lead, in the direction of travel: above 0 the spindle is ahead of the tip; `[0, 0]`
    /// where left out.
    pub lead_deg: Option<Interval<Deg<LeanAngle>>>,
    /// Range `[min, max]` of the tilt, across the direction of travel: above 0 the spindle is to the left of the feed;
    /// `[0, 0]` where left out.
    pub tilt_deg: Option<Interval<Deg<LeanAngle>>>,
    /// Largest angle between the tool axis and that of the task; no limit beside the two ranges where left out.
    pub max_lean_deg: Option<Deg<LargestLean>>,
    /// Step of the lead that is planned on at first; 2.5 where left out. The plan leaves that grid in the end.
    pub lead_step_deg: Option<Deg<LeanStep>>,
    /// The same of the tilt.
    pub tilt_step_deg: Option<Deg<LeanStep>>,
    /// What stays where it is: the `centre` of a ball, the `contact` of a bull or flat cutter on a surface of which the
    /// task states the normals, or the `plane` that the cutter touches. Where left out: centre for a ball, else
    /// contact, or plane where the task states no normals.
    pub rule: Option<Word<ContactRule>>,
    /// What forces do: `feed` keeps the directions of feed and wall, `tool` turns them with the tool. Where left out:
    /// feed for those of the task, tool for those of `[forces]` and of `[cut]`, which are stated in the frame of the
    /// tool; those of `[stock]` are computed anew for every lean.
    pub force: Option<Word<LeanForce>>,
    /// Distance between passes side by side.
    pub step_over_mm: Option<Mm<Positive>>,
    /// Highest ridge that may be left between passes; no limit where left out.
    pub scallop_mm: Option<Mm<Positive>>,
    /// How far the contact may leave its line between two points; 0.005 where left out.
    pub contact_tolerance_mm: Option<Mm<Positive>>,
    /// Segments in which the tool may lean otherwise.
    pub segment: Option<Vec<LeanSegmentTable>>,
}

/// A segment of the task in which the tool may lean otherwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LeanSegmentTable {
    /// Its number in the task, from 1.
    pub number: Whole<1, 4294967295>,
    /// Range `[min, max]` of the lead; that of `[lean]` where left out.
    pub lead_deg: Option<Interval<Deg<LeanAngle>>>,
    /// Range `[min, max]` of the tilt; that of `[lean]` where left out.
    pub tilt_deg: Option<Interval<Deg<LeanAngle>>>,
}

impl LeanTable {
    /// Whether forces from the stock are computed anew for every lean.
    pub(super) fn computes_forces(&self) -> bool {
        self.force.is_none()
    }

    /// Where the tool may lean along a task, whose file has forces of its own or not.
    ///
    /// # Errors
    /// [`InputError`] with file, line and field: a cutter that is not described, a lean that it does not allow, a
    /// segment that is not there, a point that asks for more than these tables allow, more states than memory holds.
    pub(super) fn space(
        &self,
        reading: &Reading<'_>,
        task: &Task,
        of_points: &PointLeans,
        has_columns: bool,
    ) -> Result<Arc<LeanSpace>, InputError> {
        let at = &reading.at.key("lean");
        let end = end_of(reading.run.tool.as_ref(), at)?;
        let contact = self.contact(&end, task, at)?;
        let segments = self.of_segments(task.segments().len(), at)?;
        let path = task.path();
        let range = |point: usize| {
            let is_scored = path.is_scored(point);
            of_points.range(point, is_scored.then(|| segments[path.segment_of(point)]))
        };
        let usual = if has_columns { LeanForce::Feed } else { LeanForce::Tool };
        let step = |step: Option<Deg<LeanStep>>| step.map_or(STEP_DEG.to_radians(), Quantity::si);
        let space = LeanSpace {
            rule: LeanRule { end, contact, force: self.force.map_or(usual, |word| word.0) },
            ranges: (0..path.points().len()).map(range).collect::<Result<_, _>>()?,
            max_lean: self.max_lean_deg.map(Quantity::si),
            steps: [step(self.lead_step_deg), step(self.tilt_step_deg)],
            step_over: self.step_over_mm.map(Quantity::si),
            scallop: self.scallop_mm.map(Quantity::si),
            contact_tolerance: self.contact_tolerance_mm.map_or(TOLERANCE_MM / 1e3, Quantity::si),
        };
        check_max_lean(&space, at)?;
        space.check(path).map_err(|error| at.error(format!("cannot be: {error}"), "leans that the cutter allows"))?;
        check_size(&space, reading.redundancy.beta_count, at)?;
        Ok(Arc::new(space))
    }

    /// What stays where it is when the tool leans.
    fn contact(&self, end: &CutterEnd, task: &Task, at: &Place<'_>) -> Result<ContactRule, InputError> {
        match self.rule {
            Some(word) if end.is_ball() && word.0 != ContactRule::Centre => {
                let problem = format!("is \"{}\" for a ball, which leans about its centre", word.0.word());
                let allowed = "\"centre\", or no rule, or a smaller tool.corner_radius_mm";
                Err(at.key("rule").error(problem, allowed).found_if(None))
            }
            Some(word) => Ok(word.0),
            None if end.is_ball() => Ok(ContactRule::Centre),
            None if task.path().surface_normals().is_some() => Ok(ContactRule::Contact),
            None => Ok(ContactRule::Plane),
        }
    }

    /// The ranges of lead and tilt of each segment.
    fn of_segments(&self, count: usize, at: &Place<'_>) -> Result<Vec<LeanRange>, InputError> {
        let interval = |ends: Option<Interval<Deg<LeanAngle>>>, left_out: problem::Interval| {
            ends.map(Interval::si).map_or(left_out, |[min, max]| problem::Interval { min, max })
        };
        let none = LeanRange::NONE;
        let all = LeanRange { lead: interval(self.lead_deg, none.lead), tilt: interval(self.tilt_deg, none.tilt) };
        let own = self.segment.iter().flatten().map(|table| {
            let (lead, tilt) = (interval(table.lead_deg, all.lead), interval(table.tilt_deg, all.tilt));
            (table.number.count(), LeanRange { lead, tilt })
        });
        let own = by_segment(own, count, &at.key("segment"), || format!("1 to {count}, the segments of the task"))?;
        Ok(own.into_iter().map(|range| range.unwrap_or(all)).collect())
    }

    /// What the user should know of a tool that leans, whose forces come from a stock or not.
    pub(super) fn notes(&self, space: &LeanSpace, is_of_stock: bool, has_unscored: bool) -> Vec<Note> {
        if space.is_closed() {
            let text = "[lean] leaves neither lead nor tilt: the tool keeps to the axis of the task";
            return vec![text.to_owned().into()];
        }
        let mut notes = Vec::new();
        if is_of_stock && !self.computes_forces() {
            notes.push(format!(
                "forces are computed with the tool axis of the task: lean.force = \"{}\" carries them to the tool that leans; without it they \
                 are computed anew for every lean",
                space.rule.force.word()
            ));
        }
        if space.rule.contact == ContactRule::Plane && !space.rule.end.is_ball() {
            let aside = if space.step_over.is_some() {
                "by no more than half of lean.step_over_mm aside"
            } else {
                "by up to the radius of the cutter; lean.step_over_mm bounds that"
            };
            notes.push(format!(
                "the plane that the cutter touches stays where it is, not the contact, which moves towards the side to which the tool leans, {aside}"
            ));
        }
        notes.extend(hollow_note(space));
        if has_unscored {
            notes.push("points that are not scored (plunges) keep the tool axis of the task".to_owned());
        }
        notes.into_iter().map(Note::from).collect()
    }
}

/// The end of the cutter that leans.
fn end_of(tool: Option<&ToolTable>, at: &Place<'_>) -> Result<CutterEnd, InputError> {
    let Some(tool) = tool else {
        let allowed =
            "a table [tool] with cutter_diameter_mm and corner_radius_mm: how a tool leans depends on its end";
        return Err(at.error("is there without the cutter that leans", allowed));
    };
    let radius = tool.cutter_diameter_mm.si() / 2.0;
    let corner = tool.corner_radius_mm.map_or(0.0, Quantity::si);
    if corner > radius * (1.0 + 1e-9) {
        let problem = "leans a cutter whose corner is larger than its radius (tool.corner_radius_mm)";
        return Err(at.error(problem, format!("at most {}, half of tool.cutter_diameter_mm", radius * 1e3)));
    }
    if tool.taper_deg.is_some_and(|taper| taper.si() > 0.0) {
        return Err(at.error("leans a tapered cutter", "a ball, bull nose or flat cutter with straight sides"));
    }
    Ok(CutterEnd { radius, corner })
}

/// Refuses more leans of a point than are planned, and more states than memory holds.
fn check_size(space: &LeanSpace, beta_count: usize, at: &Place<'_>) -> Result<(), InputError> {
    let [lead, tilt] = space.half_counts().map(|half| 2 * half + 1);
    let (leans, memory) = (lead * tilt, space.memory(beta_count) as f64);
    if leans <= MOST_LEANS && memory <= MOST_MEMORY {
        return Ok(());
    }
    let key = if lead > tilt { "lead_step_deg" } else { "tilt_step_deg" };
    let problem = format!("makes {leans} leans a point with {beta_count} values of beta ({:.1} GB)", memory / 1e9);
    let allowed = format!("a wider step, {MOST_LEANS} leans and {} GB at the most", MOST_MEMORY / 1e9);
    Err(at.key(key).error(problem, allowed))
}

/// Refuses a largest angle below the least lean of a point.
fn check_max_lean(space: &LeanSpace, at: &Place<'_>) -> Result<(), InputError> {
    let Some(max) = space.max_lean else { return Ok(()) };
    let least = |range: &LeanRange| range.nearest(&Lean::NONE).angle();
    let beyond = space.ranges.iter().map(least).zip(1..).find(|(least, _)| *least > max + 1e-9);
    let Some((least, point)) = beyond else { return Ok(()) };
    let least = (least.to_degrees() * 1e3).ceil() / 1e3;
    let problem = format!("is below the least lean of point {point}, {least} deg by its ranges of lead and tilt");
    Err(at.key("max_lean_deg").error(problem, format!("at least {least}, or ranges that come nearer to 0")))
}

/// How much of the floor a bull or flat cutter leaves or takes where it leans as far as it may.
fn hollow_note(space: &LeanSpace) -> Option<String> {
    let end = &space.rule.end;
    if end.is_ball() {
        return None;
    }
    let corners = |range: &LeanRange| {
        let tilts = [range.tilt.min, range.tilt.max];
        [range.lead.min, range.lead.max].map(|lead| tilts.map(|tilt| Lean { lead, tilt })).concat()
    };
    // As far as the largest angle lets it.
    let held = |lean: Lean| {
        let share = space.max_lean.map_or(1.0, |max| (max / lean.angle().max(max)).min(1.0));
        Lean { lead: lean.lead * share, tilt: lean.tilt * share }
    };
    let leans: Vec<Lean> = space.ranges.iter().flat_map(corners).map(held).collect();
    let largest = |of: &dyn Fn(&Lean) -> f64| leans.iter().map(of).fold(0.0, f64::max);
    let angle = figures(largest(&|lean| lean.angle()).to_degrees());
    let mm = |length: f64| figures(length * 1e3);
    let slot = mm(largest(&|lean| end.hollow(lean)));
    let of_slot = format!("leaning by up to {angle} deg, the cutter hollows the floor of a slot by up to {slot} mm");
    let ridge = space.step_over.map(|step| {
        let ridge = largest(&|lean| end.scallop(lean, space.step_over).unwrap_or_default());
        format!(", and leaves ridges of up to {} mm between passes {} mm apart", mm(ridge), mm(step))
    });
    let bound = match (space.scallop, space.step_over) {
        (Some(most), _) => format!("; lean.scallop_mm keeps ridges to {} mm", mm(most)),
        (None, Some(_)) => "; lean.scallop_mm bounds that".to_owned(),
        (None, None) => {
            "; what it leaves between passes is not bounded without lean.step_over_mm and lean.scallop_mm".to_owned()
        }
    };
    Some(format!("{of_slot}{}{bound}", ridge.unwrap_or_default()))
}

#[cfg(test)]
mod tests;
