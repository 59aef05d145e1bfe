//! A path thinned to some of its points, which stand for the others.

use super::{SAME_PLACE, Task, ToolPath};
use std::sync::Arc;

/// A point that is kept of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeptPoint {
    /// Its index in the whole path.
    pub point: usize,
    /// How many points of the whole path it stands for, itself among them.
    pub weight: f64,
}

/// What a thinned path knows of the whole one.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Thinned {
    /// For each point how many points of the whole path it stands for.
    weights: Vec<f64>,
    /// Distance along the whole path from the point before, in the same segment. m
    steps: Vec<f64>,
    /// Whether the tool turns in place on the way from the point before.
    turns: Vec<bool>,
    /// The largest part of that way that one step of the whole path takes.
    parts: Vec<f64>,
}

impl ToolPath {
    /// The path thinned to some of its points, ascending and at least one of every segment; the distances between them
    /// stay those along the whole path.
    #[expect(clippy::excessive_nesting, reason = "steps of one search that share what it keeps")]
    pub(super) fn thinned(&self, kept: &[KeptPoint]) -> Self {
        let mut segments = Vec::with_capacity(self.segments.len());
        let mut steps = Vec::with_capacity(kept.len());
        let mut turns = Vec::with_capacity(kept.len());
        let mut parts = Vec::with_capacity(kept.len());
        let mut feeds = self.feeds.as_ref().map(|_| Vec::with_capacity(kept.len()));
        for (place, KeptPoint { point, .. }) in kept.iter().enumerate() {
            let segment = self.segment_of(*point);
            let before = place.checked_sub(1).map(|before| kept[before].point);
            match before.filter(|before| self.segment_of(*before) == segment) {
                Some(before) => {
                    let passed = before + 1..=*point;
                    let length: f64 = passed.clone().map(|p| self.step_length(p)).sum();
                    steps.push(length);
                    let longest = passed.clone().map(|p| self.step_length(p)).fold(0.0, f64::max);
                    parts.push(if length > 0.0 { longest / length } else { 1.0 });
                    turns.push(passed.clone().any(|p| self.turns_in_place(p)));
                    if let (Some(feeds), Some(own)) = (feeds.as_mut(), &self.feeds) {
                        let time: f64 = passed.map(|p| self.step_length(p) / own[p]).sum();
                        feeds.push(if time > 0.0 { length / time } else { own[*point] });
                    }
                }
                None => {
                    steps.push(0.0);
                    parts.push(1.0);
                    turns.push(false);
                    if let (Some(feeds), Some(own)) = (feeds.as_mut(), &self.feeds) {
                        feeds.push(own[*point]);
                    }
                    segments.push(place..place);
                }
            }
            if let Some(last) = segments.last_mut() {
                last.end = place + 1;
            }
        }
        Self {
            points: kept.iter().map(|kept| self.points[kept.point]).collect(),
            segments,
            surface_normals: self
                .surface_normals
                .as_ref()
                .map(|normals| kept.iter().map(|kept| normals[kept.point]).collect()),
            feeds,
            scored: self.scored.as_ref().map(|scored| kept.iter().map(|kept| scored[kept.point]).collect()),
            leaned: self.leaned.as_ref().map(|leaned| leaned.thinned(kept)),
            thinned: Some(Thinned { weights: kept.iter().map(|kept| kept.weight).collect(), steps, turns, parts }),
        }
    }

    /// Distance along the path to a point from the one before, both in one segment; of a tool that leans, of its tip
    /// as the path states it. m
    pub fn step_length(&self, point: usize) -> f64 {
        match (&self.thinned, &self.leaned) {
            (Some(thinned), _) => thinned.steps[point],
            (None, Some(leaned)) => leaned.upright.step_length(point),
            (None, None) => (self.points[point].position - self.points[point - 1].position).norm(),
        }
    }

    /// The largest part of the way to a point from the one before, both in one segment, that one step of the whole path
    /// takes: 1 but in a thinned path.
    pub fn largest_part(&self, point: usize) -> f64 {
        self.thinned.as_ref().map_or(1.0, |thinned| thinned.parts[point])
    }

    /// How many scored points a point stands for: 1 but in a thinned path, 0 where it is not scored.
    pub fn weight(&self, point: usize) -> f64 {
        match &self.thinned {
            Some(thinned) => thinned.weights[point],
            None => f64::from(u8::from(self.is_scored(point))),
        }
    }

    /// Whether the tool turns in place, which no feed belongs to, on the way to a point from the one before, in the
    /// same segment.
    pub fn turns_in_place(&self, point: usize) -> bool {
        match &self.thinned {
            Some(thinned) => thinned.turns[point],
            None => self.scored.is_some() && self.step_length(point) < SAME_PLACE,
        }
    }

    /// Whether this is some of the points of a longer path.
    pub fn is_thinned(&self) -> bool {
        self.thinned.is_some()
    }
}

impl Task {
    /// The task thinned to some of its points, ascending and at least one of every segment.
    pub fn thinned(&self, kept: &[KeptPoint]) -> Self {
        Self {
            path: Arc::new(self.path.thinned(kept)),
            loads: kept.iter().map(|kept| self.loads[kept.point]).collect(),
            lean_forces: self.lean_forces.as_ref().map(|forces| Arc::new(forces.thinned(kept))),
            upright: self.upright.as_ref().map(|task| Arc::new(task.thinned(kept))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::five_segments;
    use super::*;

    #[test]
    fn distances_and_weights_are_those_of_the_whole_path() {
        let task = five_segments();
        let kept: Vec<KeptPoint> = (0..task.points().len())
            .filter(|point| point % 4 == 1)
            .map(|point| KeptPoint { point, weight: 4.0 })
            .collect();
        let thinned = task.thinned(&kept);
        assert_eq!(thinned.segments().len(), task.segments().len());
        assert!(thinned.path().is_thinned() && !task.path().is_thinned());
        for (place, kept) in kept.iter().enumerate() {
            assert_eq!(thinned.points()[place], task.points()[kept.point]);
            assert_eq!((thinned.path().weight(place), task.path().weight(kept.point)), (4.0, 1.0));
        }
        let span = &thinned.segments()[2];
        let along: f64 = span.clone().skip(1).map(|place| thinned.path().step_length(place)).sum();
        let whole: f64 =
            (kept[span.start].point + 1..=kept[span.end - 1].point).map(|p| task.path().step_length(p)).sum();
        assert!((along - whole).abs() < 1e-12 && along > 0.0);
    }

    #[test]
    fn a_step_of_the_whole_path_is_a_part_of_the_way_between_kept_points() {
        let task = five_segments();
        let span = task.segments()[0].clone();
        let all =
            |points: Vec<usize>| points.into_iter().map(|point| KeptPoint { point, weight: 1.0 }).collect::<Vec<_>>();
        let rest = task.segments().iter().skip(1).map(|span| span.start);
        let thinned = task.thinned(&all(span.clone().step_by(4).chain(rest).collect()));
        let path = thinned.path();
        for (point, before) in span.clone().step_by(4).skip(1).zip(1..) {
            let steps: Vec<f64> = (point - 3..=point).map(|point| task.path().step_length(point)).collect();
            let longest = steps.iter().copied().fold(0.0, f64::max);
            assert!((path.largest_part(before) - longest / steps.iter().sum::<f64>()).abs() < 1e-12);
        }
        assert_eq!(task.path().largest_part(1), 1.0);
    }
}
