//! How a path is followed: the feed of each move, and the points that are followed but not scored.

use super::{TaskError, ToolPath};

impl ToolPath {
    /// States the feed (m/s) of the move to each point from the one before; that of the first point of a segment says
    /// nothing.
    ///
    /// # Errors
    /// [`TaskError`] where their number is not that of the points, or at the first that is not above zero and finite.
    pub fn with_feeds(mut self, feeds: Vec<f64>) -> Result<Self, TaskError> {
        if feeds.len() != self.points.len() {
            return Err(TaskError::Feeds { feeds: feeds.len(), points: self.points.len() });
        }
        match feeds.iter().position(|feed| !(*feed > 0.0 && feed.is_finite())) {
            Some(point) => Err(TaskError::Feed { point, feed: feeds[point] }),
            None => {
                self.feeds = Some(feeds);
                Ok(self)
            }
        }
    }

    /// The path without feeds of its own.
    pub fn without_feeds(mut self) -> Self {
        self.feeds = None;
        self
    }

    /// The feed of the move to a point, where the task states it. m/s
    pub fn feed(&self, point: usize) -> Option<f64> {
        self.feeds.as_ref().map(|feeds| feeds[point])
    }

    /// The highest feed of the moves of a segment (from 0), where the task states feeds. m/s
    pub fn highest_feed(&self, segment: usize) -> Option<f64> {
        let feeds = self.feeds.as_ref()?;
        let inner = self.segments[segment].clone().skip(1);
        inner.map(|point| feeds[point]).reduce(f64::max)
    }

    /// The path with those of its scored points scored alone for which that holds; as it is where it holds for none.
    pub fn scored_where(&self, holds: impl Fn(usize) -> bool) -> Self {
        let scored: Vec<bool> = (0..self.points.len()).map(|point| self.is_scored(point) && holds(point)).collect();
        if scored.iter().all(|is_scored| *is_scored) || !scored.contains(&true) {
            return self.clone();
        }
        Self { scored: Some(scored), ..self.clone() }
    }

    /// Whether a point is scored, and does not only have to be reached.
    pub fn is_scored(&self, point: usize) -> bool {
        self.scored.as_ref().is_none_or(|scored| scored[point])
    }

    /// The first point that is not scored, where there is one.
    pub fn first_unscored(&self) -> Option<usize> {
        self.scored.as_ref()?.iter().position(|is_scored| !is_scored)
    }

    /// Number of points that are scored.
    pub fn scored_count(&self) -> usize {
        self.scored.as_ref().map_or(self.points.len(), |scored| scored.iter().filter(|is_scored| **is_scored).count())
    }

    /// Time from the point before to a point, both in one segment, at the feed of the task, or at the given one (m/s)
    /// where it states none; infinite for a turn of the tool in place, to which no feed belongs. s
    pub fn step_time(&self, point: usize, feed: f64) -> f64 {
        let length = self.step_length(point);
        if self.turns_in_place(point) { f64::INFINITY } else { length / self.feed(point).unwrap_or(feed) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{KeptPoint, PathPoint, Task, Wrench};
    use super::*;
    use nalgebra::{Vector3, vector};

    fn point(x: f64, axis: Vector3<f64>) -> PathPoint {
        PathPoint { position: vector![x, 0.0, 0.0], feed: Vector3::x(), axis: axis.normalize() }
    }

    /// A cut, a turn in place of two points, and a cut.
    fn turning() -> ToolPath {
        let (up, tilted) = (Vector3::z(), vector![0.0, 0.3, 1.0]);
        let points =
            [(0.0, up, true), (0.1, up, true), (0.1, tilted, false), (0.1, tilted, false), (0.3, tilted, true)];
        ToolPath::partly_scored(points.map(|(x, axis, is_scored)| (1, point(x, axis), is_scored))).unwrap()
    }

    #[test]
    fn feeds_give_times_and_turns_in_place_have_none() {
        let path = turning().with_feeds(vec![1.0, 0.05, 0.05, 0.05, 0.1]).unwrap();
        let times = [1, 2, 3, 4].map(|point| path.step_time(point, 9.0));
        assert_eq!(times[..3], [2.0, f64::INFINITY, f64::INFINITY]);
        assert!((times[3] - 2.0).abs() < 1e-12);
        assert_eq!((path.highest_feed(0), turning().step_time(1, 0.2)), (Some(0.1), 0.5));
        assert_eq!(turning().with_feeds(vec![1.0; 4]), Err(TaskError::Feeds { feeds: 4, points: 5 }));
        let feeds = vec![1.0, 1.0, 0.0, 1.0, 1.0];
        assert_eq!(turning().with_feeds(feeds), Err(TaskError::Feed { point: 2, feed: 0.0 }));
    }

    #[test]
    fn points_that_are_not_scored_have_no_weight_and_no_force() {
        let force = Wrench { force: Vector3::x(), moment: Vector3::z() };
        let task = Task::new(turning(), vec![force; 5]).unwrap();
        let path = task.path();
        assert_eq!((0..5).map(|point| path.weight(point)).collect::<Vec<_>>(), [1.0, 1.0, 0.0, 0.0, 1.0]);
        assert_eq!((path.scored_count(), path.first_unscored()), (3, Some(2)));
        assert_eq!(path.scored_where(|point| point > 0).scored_count(), 2);
        assert_eq!(path.scored_where(|_| false), *path);
        assert_eq!((task.loads()[1].wrench, task.loads()[2].wrench), (force, Wrench::default()));
        let unscored = ToolPath::partly_scored([(1, point(0.0, Vector3::z()), false)]);
        assert_eq!(unscored, Err(TaskError::NothingScored));
    }

    #[test]
    fn a_thinned_path_keeps_the_time_of_what_is_left_out() {
        let points = [0.0, 0.1, 0.3].map(|x| (1, point(x, Vector3::z())));
        let path = ToolPath::new(points).unwrap().with_feeds(vec![1.0, 0.1, 0.05]).unwrap();
        let task = Task::new(path, vec![Wrench::default(); 3]).unwrap();
        let ends = task.thinned(&[0, 2].map(|point| KeptPoint { point, weight: 1.5 }));
        assert!((ends.path().step_time(1, 9.0) - 5.0).abs() < 1e-12);
        let turning = Task::new(turning(), vec![Wrench::default(); 5]).unwrap();
        let ends = turning.thinned(&[0, 4].map(|point| KeptPoint { point, weight: 1.5 }));
        assert!(ends.path().turns_in_place(1) && ends.path().step_time(1, 9.0).is_infinite());
    }
}
