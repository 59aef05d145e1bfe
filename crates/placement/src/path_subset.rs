//! Some points of a long path, by which placements are compared before the whole path is planned.
//!
//! The points are spread evenly over what changes along the path: position, tool axis, feed direction and force. Each
//! stands for the points around it: the score is taken as linear in the distance along the path between two kept points
//! of a segment, and as constant beyond the first and the last, so that the weights of a segment sum up to the number
//! of its scored points. Between kept points beta and the joints may change by what all the steps between them allow
//! together. What the points left out forbid is not seen: whoever uses a subset checks the whole path, and adds the
//! points that decide ([`PathSubset::add`]).

use std::ops::Range;
use stead_model::task::{KeptPoint, Task, ToolPath};
use stead_problem::problem::Problem;

/// Points kept of a path, ascending.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PathSubset {
    points: Vec<usize>,
}

/// Changes along the path that count alike: of position (m), of directions (rad), of the force relative to its mean
/// size.
const UNITS: [f64; 3] = [0.15, 0.5, 1.0];
/// How often points are spread again at the most.
const SPREADS: usize = 12;
/// In segments with fewer kept points than this they are staggered from segment to segment, so that segments side by
/// side are not all represented at the same place.
const STAGGERED: usize = 3;
/// The golden section, by which they are staggered.
const STAGGER: f64 = 0.618_033_988_749_895;

impl PathSubset {
    /// About `count` points, at least one of every segment; all points where the path has no more.
    pub fn new(task: &Task, count: usize) -> Self {
        if count >= task.points().len() {
            return Self { points: (0..task.points().len()).collect() };
        }
        let travelled = travelled(task);
        let mut subset = Self::spread(task, &travelled, count);
        let mut cells = count;
        // Where much changes from one point to the next, several cells share a point; those are spread anew.
        for _ in 0..SPREADS {
            cells += count.saturating_sub(subset.points.len());
            let wider = Self::spread(task, &travelled, cells);
            if wider.points.len() <= subset.points.len() || wider.points.len() > count {
                break;
            }
            subset = wider;
        }
        subset
    }

    /// The points nearest to the middles of so many cells, which are as long in what changes along the path.
    fn spread(task: &Task, travelled: &[f64], count: usize) -> Self {
        let spans = task.segments();
        let length = |span: &Range<usize>| travelled[span.end - 1] - travelled[span.start];
        let whole: f64 = spans.iter().map(length).sum();
        let free = count.saturating_sub(spans.len()) as f64;
        let mut points = Vec::with_capacity(count + spans.len());
        // Shares of the free points are rounded so that they sum up.
        let mut owed = 0.0;
        for (index, span) in spans.iter().enumerate() {
            owed += if whole > 0.0 { free * length(span) / whole } else { 0.0 };
            let more = (owed + 0.5).floor().max(0.0);
            owed -= more;
            let cells = 1 + more as usize;
            let offset = if cells < STAGGERED { (0.5 + index as f64 * STAGGER).fract() } else { 0.5 };
            points.extend((0..cells).map(|cell| {
                let at = travelled[span.start] + (cell as f64 + offset) / cells as f64 * length(span);
                scored_near(task.path(), span, nearest(&travelled[span.clone()], at) + span.start)
            }));
        }
        points.dedup();
        Self { points }
    }

    /// Given points, ascending, at least one of every segment.
    pub(crate) fn of_points(points: Vec<usize>) -> Self {
        Self { points }
    }

    /// The points, ascending.
    pub fn points(&self) -> &[usize] {
        &self.points
    }

    /// Adds points; whether any is new.
    pub fn add(&mut self, points: &[usize]) -> bool {
        let before = self.points.len();
        self.points.extend(points);
        self.points.sort_unstable();
        self.points.dedup();
        self.points.len() > before
    }

    /// The problem on these points alone.
    pub fn of(&self, problem: &Problem) -> Problem {
        problem.on_points(&self.weighted(&problem.task))
    }

    /// The points with what they stand for.
    #[expect(clippy::excessive_nesting, reason = "steps of one search that share what it keeps")]
    fn weighted(&self, task: &Task) -> Vec<KeptPoint> {
        let path = task.path();
        let mut kept: Vec<KeptPoint> =
            self.points.iter().map(|point| KeptPoint { point: *point, weight: 0.0 }).collect();
        let mut next = 0;
        for span in path.segments() {
            let first = next;
            while next < kept.len() && kept[next].point < span.end {
                next += 1;
            }
            let own: Vec<usize> = (first..next).filter(|place| path.is_scored(kept[*place].point)).collect();
            let (Some(head), Some(tail)) = (own.first().copied(), own.last().copied()) else { continue };
            let scored = |points: Range<usize>| points.filter(|point| path.is_scored(*point)).count() as f64;
            let (before, after) = (scored(span.start..kept[head].point), scored(kept[tail].point..span.end));
            kept[head].weight += before;
            kept[tail].weight += after;
            for pair in own.windows(2) {
                let [from, to] = [pair[0], pair[1]].map(|place| kept[place].point);
                let steps: Vec<f64> = (from + 1..=to).map(|point| path.step_length(point)).collect();
                let whole: f64 = steps.iter().sum();
                let mut done = 0.0;
                for (k, step) in steps.iter().enumerate() {
                    // The share of the point at the start of this step.
                    let share = if whole > 0.0 { done / whole } else { k as f64 / steps.len() as f64 };
                    if path.is_scored(from + k) {
                        kept[pair[0]].weight += 1.0 - share;
                        kept[pair[1]].weight += share;
                    }
                    done += step;
                }
            }
        }
        kept
    }
}

/// For each point what has changed along its segments up to it, in the units of [`UNITS`].
fn travelled(task: &Task) -> Vec<f64> {
    let (points, loads) = (task.points(), task.loads());
    let mean = task.wrenches().map(|wrench| wrench.force.norm()).sum::<f64>() / loads.len() as f64;
    let mut sum = 0.0;
    let mut travelled = vec![0.0; points.len()];
    for span in task.segments() {
        travelled[span.start] = sum;
        for point in span.clone().skip(1) {
            let (a, b) = (&points[point - 1], &points[point]);
            let angle = |u: &nalgebra::Vector3<f64>, v: &nalgebra::Vector3<f64>| {
                libm::atan2(u.cross(v).norm(), u.dot(v)) / UNITS[1]
            };
            sum += task.path().step_length(point) / UNITS[0] + angle(&a.axis, &b.axis) + angle(&a.feed, &b.feed);
            if mean > 0.0 {
                sum += (loads[point].wrench.force - loads[point - 1].wrench.force).norm() / (mean * UNITS[2]);
            }
            travelled[point] = sum;
        }
    }
    travelled
}

/// The scored point of a segment that is nearest by number to a point; that point, where none is scored.
fn scored_near(path: &ToolPath, span: &Range<usize>, point: usize) -> usize {
    let mut apart = 0..span.len();
    let near = |apart: usize| [point.checked_sub(apart), Some(point + apart)].into_iter().flatten();
    let found = apart.find_map(|apart| near(apart).find(|near| span.contains(near) && path.is_scored(*near)));
    found.unwrap_or(point)
}

/// The index of the value nearest to `at` in ascending values.
fn nearest(ascending: &[f64], at: f64) -> usize {
    let after = ascending.partition_point(|value| *value < at);
    match after {
        0 => 0,
        _ if after == ascending.len() => after - 1,
        _ if at - ascending[after - 1] <= ascending[after] - at => after - 1,
        _ => after,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stead_problem::testing::five_segments;

    #[test]
    fn weights_sum_up_and_linear_scores_keep_their_sum() {
        let problem = five_segments();
        let task = &problem.task;
        for count in [1, 5, 12, 40, 104, 105, 1000] {
            let mut subset = PathSubset::new(task, count);
            let most = count.max(task.segments().len()).min(105);
            assert!((most * 4 / 5..=most).contains(&subset.points().len()), "{count}: {}", subset.points().len());
            subset.add(&[0, 50, 104]);
            assert!(!subset.add(&[50]));
            let kept = subset.weighted(task);
            for span in task.segments() {
                let own: Vec<&KeptPoint> = kept.iter().filter(|kept| span.contains(&kept.point)).collect();
                let sum: f64 = own.iter().map(|kept| kept.weight).sum();
                assert!((sum - span.len() as f64).abs() < 1e-9, "{count}: {sum}");
            }
            let thinned = subset.of(&problem);
            assert!((thinned.total_weight() - 105.0).abs() < 1e-9);
            // What is linear along every segment, ends kept, is summed exactly.
            let ends: Vec<usize> = task.segments().iter().flat_map(|span| [span.start, span.end - 1]).collect();
            subset.add(&ends);
            let along = |point: usize| task.points()[point].position.x + 2.0 * task.points()[point].position.y;
            let whole: f64 = (0..105).map(along).sum();
            let estimate: f64 = subset.weighted(task).iter().map(|kept| kept.weight * along(kept.point)).sum();
            assert!((whole - estimate).abs() < 1e-9, "{count}");
        }
    }

    #[test]
    fn points_that_are_not_scored_stand_for_nothing() {
        let problem = five_segments();
        let task = &problem.task;
        let is_scored = |point: usize| point % 21 > 2 && point % 7 != 5;
        let points =
            (0..105).map(|point| (task.path().segment_of(point) as u32 + 1, task.points()[point], is_scored(point)));
        let path = ToolPath::partly_scored(points).unwrap();
        let problem =
            problem.clone().with(|parts| parts.task = Task::new(path, task.wrenches().copied().collect()).unwrap());
        let scored = (0..105).filter(|point| is_scored(*point)).count() as f64;
        for count in [5, 12, 40] {
            let mut subset = PathSubset::new(&problem.task, count);
            subset.add(&[0, 1, 5]);
            let thinned = subset.of(&problem);
            assert!((thinned.total_weight() - scored).abs() < 1e-9, "{count}: {}", thinned.total_weight());
            let unscored = subset.points().iter().position(|point| !is_scored(*point)).unwrap();
            assert_eq!(thinned.point_weight(unscored), 0.0);
        }
        assert_eq!(problem.total_weight(), scored);
    }
}
