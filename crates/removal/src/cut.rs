//! What is cut along a path in a few figures, and what of it no cutter does.

use crate::load::PointForces;
use crate::operation::Operation;

use std::f64::consts::{PI, TAU};
use stead_model::task::ToolPath;
use stead_numerics::digits::figures;
use stead_numerics::mean_max::{MeanAndMax, percentile};
use stead_numerics::message::Warning;

/// A tooth that cuts over this angle or more is in a full slot. rad
const SLOT: f64 = 170.0 * PI / 180.0;
/// So many diameters a cut is deep, and squares of the diameter large, before it looks wrong.
const DEEP: f64 = 1.5;
const LARGE: f64 = 1.0;
/// A deepest point looks wrong from so many times the depth that 95 of 100 points keep on, and diameters.
const UNEVEN: (f64, f64) = (2.0, 0.25);
/// A larger force looks wrong. N
const LARGEST_FORCE: f64 = 1000.0;
/// A share of air that is worth a word.
const SOME_AIR: f64 = 0.05;
/// Runs of points that are named.
const NAMED: usize = 3;

/// What the scored points of a path cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutFigures {
    /// Diameter of the cutter. m
    pub diameter: f64,
    /// Length of its flutes. m
    pub flutes: f64,
    /// The axial depth that half of the points, and 95 of 100, do not exceed, and the largest. m
    pub depths: [f64; 3],
    /// The point of the largest.
    pub deepest: usize,
    /// Section of what is cut, across the feed. m2
    pub section: MeanAndMax,
    /// Share of the points at which the cutter is in a full slot.
    pub slot: f64,
    /// The thickest chip of half of the points, at the most. m
    pub chip: f64,
    /// Norm of the mean force over a turn. N
    pub force: MeanAndMax,
    /// The point of the largest.
    pub hardest: usize,
    /// Moment about the axis of the spindle. N m
    pub torque: MeanAndMax,
    /// Power of the spindle: that moment by its speed. W
    pub power: MeanAndMax,
    /// Volume cut in a second, in the mean. m3/s
    pub rate: f64,
    /// Share of the length of scored path on which nothing is cut.
    pub air: f64,
}

impl CutFigures {
    /// Those of the points of a path that are scored and cut, where there are some.
    pub(crate) fn of(path: &ToolPath, points: &[PointForces], operation: &Operation, air: f64) -> Option<Self> {
        let cutting = || (0..points.len()).filter(|point| path.is_scored(*point) && points[*point].heights.is_some());
        let of = |value: &dyn Fn(usize) -> f64| MeanAndMax::of(cutting().map(value));
        let count = cutting().count();
        if count == 0 {
            return None;
        }
        let largest = |value: &dyn Fn(usize) -> f64| cutting().max_by(|a, b| value(*a).total_cmp(&value(*b)));
        let depth = |point: usize| points[point].heights.map_or(0.0, |heights| heights[1]);
        let force = |point: usize| points[point].at_feed(1.0).force.norm();
        let torque = |point: usize| points[point].at_feed(1.0).moment.dot(&path.points()[point].axis).abs();
        let slot = |point: &usize| points[*point].angles.is_some_and(|[from, to]| to - from >= SLOT);
        Some(Self {
            diameter: operation.mill.cutter.diameter(),
            flutes: operation.mill.flute_length,
            depths: [0.5, 0.95, 1.0].map(|share| percentile(cutting().map(depth), share)),
            deepest: largest(&depth)?,
            section: of(&|point| points[point].removed),
            slot: cutting().filter(slot).count() as f64 / count as f64,
            chip: percentile(cutting().map(|point| points[point].chip_thickness), 0.5),
            force: of(&force),
            hardest: largest(&force)?,
            torque: of(&torque),
            power: of(&|point| torque(point) * operation.spindle_speed * TAU),
            rate: of(&|point| points[point].removed * path.feed(point).unwrap_or_default()).mean,
            air,
        })
    }

    /// The cut in two lines: what is taken off, and what that takes.
    pub fn lines(&self) -> [String; 2] {
        let mm = |length: f64| figures(length * 1e3);
        let [half, most, largest] = self.depths;
        let diameters = figures(largest / self.diameter);
        let percent = |share: f64| format!("{:.0} %", (share * 100.0).abs());
        [
            format!(
                "depth {} mm (95 % to {}, deepest {} at point {}: {diameters} D, flutes {}), section {} mm2 (up to {}), full slot {}, \
                 air {}",
                mm(half),
                mm(most),
                mm(largest),
                self.deepest,
                mm(self.flutes),
                figures(self.section.mean * 1e6),
                figures(self.section.max * 1e6),
                percent(self.slot),
                percent(self.air)
            ),
            format!(
                "chip {} mm, force {} N (up to {}), spindle {} kW (up to {}), {} N m, {} cm3/min",
                mm(self.chip),
                figures(self.force.mean),
                figures(self.force.max),
                figures(self.power.mean / 1e3),
                figures(self.power.max / 1e3),
                figures(self.torque.max),
                figures(self.rate * 6e7)
            ),
        ]
    }

    /// The cut in a few words.
    pub fn words(&self) -> String {
        let air = if self.air > SOME_AIR { format!(", air {:.0}%", self.air * 100.0) } else { String::new() };
        format!(
            "depth {} mm ({} D), force {} N ({}), {} kW{air}",
            figures(self.depths[0] * 1e3),
            figures(self.depths[0] / self.diameter),
            figures(self.force.mean),
            figures(self.force.max),
            figures(self.power.max / 1e3)
        )
    }

    /// What of the cut no cutter does, or hardly any arm bears.
    pub(crate) fn warnings(&self, path: &ToolPath, points: &[PointForces]) -> Vec<Warning> {
        let diameter = self.diameter;
        let mm = |length: f64| figures(length * 1e3);
        let [_, most, largest] = self.depths;
        let square = diameter * diameter;
        let is_deep = most > DEEP * diameter && self.section.max > square / 2.0;
        let deep = (is_deep || self.section.max > LARGE * square).then(|| {
            let text = format!(
                "the cut is deeper than a cutter of {} mm bears: {} mm deep at 95 % of the points, with a section of up to {} mm2; is the \
                 stock what the operation before leaves ([stock] depth_mm, layer_mm)?",
                mm(diameter),
                mm(most),
                figures(self.section.max * 1e6)
            );
            Warning::new("deep-cut", text)
        });
        let limit = (UNEVEN.0 * most).max(UNEVEN.1 * diameter);
        let uneven = (largest > limit).then(|| {
            let is_deeper = |point: &usize| {
                path.is_scored(*point) && points[*point].heights.is_some_and(|heights| heights[1] > limit)
            };
            let text = format!(
                "some points cut much deeper than the others, up to {} mm where 95 % cut {} mm: points {}; are they links, or is material \
                 left there?",
                mm(largest),
                mm(most),
                runs(&(0..points.len()).filter(is_deeper).collect::<Vec<_>>())
            );
            Warning::new("uneven-depth", text)
        });
        let force = (self.force.max > LARGEST_FORCE).then(|| {
            let text = format!(
                "the force goes up to {} N at point {}, which hardly any arm mills with: are depth, feed and coefficients right?",
                figures(self.force.max),
                self.hardest
            );
            Warning::new("large-force", text)
        });
        deep.into_iter().chain(uneven).chain(force).collect()
    }

    /// That the spindle has less power (W) or torque (N m) than the cut takes.
    pub fn beyond(&self, power: Option<f64>, torque: Option<f64>) -> Option<Warning> {
        let says = |what: &str, needed: f64, stated: Option<f64>, unit: &str| {
            let stated = stated.filter(|stated| needed > *stated)?;
            Some(format!("{what} of up to {} {unit}, and it has {} {unit}", figures(needed), figures(stated)))
        };
        let kilowatts = says("a power", self.power.max / 1e3, power.map(|power| power / 1e3), "kW");
        let beyond: Vec<String> =
            kilowatts.into_iter().chain(says("a torque", self.torque.max, torque, "N m")).collect();
        (!beyond.is_empty()).then(|| {
            Warning::new("spindle-power", format!("the cut asks more than the spindle gives: {}", beyond.join("; ")))
        })
    }
}

/// Numbers in a row as `40 to 52`, the first few of such runs.
fn runs(numbers: &[usize]) -> String {
    let all: Vec<String> = numbers
        .chunk_by(|a, b| a + 1 == *b)
        .map(|run| if run.len() == 1 { run[0].to_string() } else { format!("{} to {}", run[0], run[run.len() - 1]) })
        .collect();
    let more = all.len().saturating_sub(NAMED);
    let named = all[..all.len().min(NAMED)].join(", ");
    if more > 0 { format!("{named} and {more} more runs") } else { named }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_numbers_are_named_by_their_ends() {
        assert_eq!(runs(&[3]), "3");
        assert_eq!(runs(&[1, 2, 3, 7, 9, 10]), "1 to 3, 7, 9 to 10");
        assert_eq!(runs(&[1, 3, 5, 7, 9]), "1, 3, 5 and 2 more runs");
    }
}
