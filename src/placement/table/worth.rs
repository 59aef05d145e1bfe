//! What a placement is worth by the table: dynamic programming over its scores.
//!
//! The rules are those of [`crate::placement::redundancy::band`], but for the steps and turns of the joints.

use super::look::Rows;
use super::{Lane, Table};
use crate::placement::redundancy::Worth;
use crate::robot::Posture;

/// Scratch space of one thread.
#[derive(Debug, Clone)]
pub struct Workspace {
    pub(super) rows: Rows,
    scores: Vec<f32>,
    /// Smallest sums of scores so far, for each class, over beta.
    costs: [Vec<f32>; 4],
    windows: [Vec<f32>; 2],
}

impl Table<'_> {
    /// Space for one thread to look along a grid of beta.
    pub fn workspace(&self, lane: &Lane) -> Workspace {
        let row = || vec![0.0; lane.count];
        Workspace {
            rows: Rows::new(self, lane),
            scores: row(),
            costs: std::array::from_fn(|_| row()),
            windows: std::array::from_fn(|_| vec![0.0; 2 * lane.count]),
        }
    }

    /// The mean score of the workpiece at `pose` (x, y, z in m, yaw in rad) under the best plan on a grid of beta, with the
    /// posture scheme found exactly or given (one posture per segment), to the accuracy of the table.
    pub fn worth(&self, pose: &[f64; 4], lane: &Lane, scheme: Option<&[Posture]>, workspace: &mut Workspace) -> Worth {
        let site = self.site(pose);
        let mut sum = 0.0;
        let (mut points, mut segments) = (0, 0);
        let Workspace { rows, scores, costs, windows } = workspace;
        for (index, span) in self.problem.task.segments().iter().enumerate() {
            let only = scheme.map(|s| s[index].class().index());
            let mut live = [0, 1, 2, 3].map(|class| only.is_none_or(|asked| asked == class));
            let asked = live;
            for point in span.clone() {
                let Some(spot) = self.spot(&site, point) else {
                    points += 1;
                    live = [false; 4];
                    continue;
                };
                let mut allowed = false;
                for class in 0..4 {
                    if !live[class] {
                        continue;
                    }
                    let any = self.look(&spot, class, lane, rows, scores);
                    allowed |= any;
                    live[class] = any
                        && if point == span.start {
                            costs[class].copy_from_slice(scores);
                            true
                        } else {
                            advance(&mut costs[class], scores, lane.reaches[point], windows)
                        };
                }
                // Classes that got lost on the way count as allowed where they are.
                let rest = (0..4).filter(|class| asked[*class] && !live[*class]);
                allowed = allowed || rest.into_iter().any(|class| self.look(&spot, class, lane, rows, scores));
                points += usize::from(!allowed);
            }
            let ends = (0..4).filter(|class| live[*class]).flat_map(|class| costs[class].iter());
            let best = ends.copied().fold(f32::INFINITY, f32::min);
            if best.is_finite() {
                sum += f64::from(best);
            } else {
                segments += 1;
            }
        }
        if points > 0 {
            Worth::Infeasible { points, segments: 0 }
        } else if segments > 0 {
            Worth::Infeasible { points, segments }
        } else {
            Worth::Feasible(sum / self.stations.len() as f64)
        }
    }
}

/// Adds to each score the smallest cost within `reach`, cyclically: the new costs. False when none is finite.
fn advance(costs: &mut [f32], scores: &[f32], reach: usize, windows: &mut [Vec<f32>; 2]) -> bool {
    let count = costs.len();
    let least = |a: f32, b: f32| if b < a { b } else { a };
    let mut any = false;
    if 2 * reach + 1 >= count {
        let best = costs.iter().copied().fold(f32::INFINITY, f32::min);
        for (cost, score) in costs.iter_mut().zip(scores) {
            *cost = best + score;
            any |= *cost < f32::INFINITY;
        }
        return any;
    }
    // Minima over windows of 1, 2, 4, ... values, then two of the widest that make up the band.
    let length = count + 2 * reach;
    let [now, next] = windows;
    now[..reach].copy_from_slice(&costs[count - reach..]);
    now[reach..reach + count].copy_from_slice(costs);
    now[reach + count..length].copy_from_slice(&costs[..reach]);
    let band = 2 * reach + 1;
    let mut width = 1;
    while 2 * width <= band {
        let kept = length + 1 - 2 * width;
        let (a, b) = (&now[..kept], &now[width..width + kept]);
        for (out, (a, b)) in next[..kept].iter_mut().zip(a.iter().zip(b)) {
            *out = least(*a, *b);
        }
        std::mem::swap(now, next);
        width *= 2;
    }
    let (a, b) = (&now[..count], &now[band - width..band - width + count]);
    for ((cost, score), (a, b)) in costs.iter_mut().zip(scores).zip(a.iter().zip(b)) {
        *cost = least(*a, *b) + score;
        any |= *cost < f32::INFINITY;
    }
    any
}
