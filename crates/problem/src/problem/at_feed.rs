//! The forces of a cut at the feed that the arm holds, which are smaller where that is below the programmed one.

use super::{Problem, ProblemParts};

impl Problem {
    /// The same problem with the forces at another feed, given as its share of the programmed one (m/s) in a segment;
    /// `None` where it is not known which part of them grows with the feed
    /// ([`Task::with_edge_parts`](stead_model::task::Task::with_edge_parts)).
    pub fn at_feed(&self, share_of: impl Fn(usize, f64) -> f64) -> Option<Self> {
        let path = self.task.path();
        let share = |point: usize| {
            let segment = path.segment_of(point);
            let range = &path.segments()[segment];
            // The feed of the first point of a segment says nothing: what is cut there is cut on the way to the next.
            let move_to = if point == range.start && range.len() > 1 { point + 1 } else { point };
            share_of(segment, path.feed(move_to).unwrap_or(self.redundancy.feed))
        };
        let task = self.task.at_feed(share)?;
        Some(Self { parts: ProblemParts { task, ..self.parts.clone() } })
    }
}
