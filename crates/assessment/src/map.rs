//! Circularity over a plane of the cell (Klimchik 2017, Fig. 15 to 19).

use super::benchmark::{DeflectedCircle, Obstacle, Profile};
use rayon::prelude::*;
use serde::Serialize;
use stead_model::robot::{PostureClass, PostureWord, Robot};
use stead_numerics::monitor::Monitor;

/// Centres of circles: the nodes of a square grid, in the coordinates of the benchmark's plane.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Grid {
    /// First node. m
    pub origin: [f64; 2],
    /// Distance between neighbours. m
    pub step: f64,
    /// Number of nodes along each axis.
    pub counts: [usize; 2],
}

impl Grid {
    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.counts[0] * self.counts[1]
    }

    /// Whether there are no nodes.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Place of a node, counted along the first axis fastest. m
    pub fn place(&self, index: usize) -> [f64; 2] {
        self.at([(index % self.counts[0]) as f64, (index / self.counts[0]) as f64])
    }

    /// Place of a position counted in steps. m
    pub fn at(&self, steps: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| self.origin[axis] + self.step * steps[axis])
    }
}

stead_numerics::worded! {
    /// Which way the elbow stands, seen in the plane of the arm.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
    pub enum Elbow {
        /// Above the line from the shoulder to the wrist centre.
        Up = "up",
        /// Below it.
        Down = "down",
    }
}

impl Elbow {
    /// Both.
    pub const BOTH: [Elbow; 2] = [Elbow::Up, Elbow::Down];

    /// The other one.
    pub fn other(self) -> Self {
        match self {
            Elbow::Up => Elbow::Down,
            Elbow::Down => Elbow::Up,
        }
    }

    /// The posture class that reaches forwards with this elbow.
    pub fn forward_class(self, robot: &Robot) -> PostureClass {
        let elbow = if self == Elbow::Up { PostureWord::ElbowUp } else { PostureWord::ElbowDown };
        // The two postures of a class differ in the flip alone.
        let words = |class: &PostureClass| robot.posture_words(class.postures()[0]);
        let is_it = |class: &PostureClass| words(class).has(PostureWord::Front) && words(class).has(elbow);
        PostureClass::ALL.into_iter().find(is_it).unwrap_or(PostureClass::ALL[0])
    }
}

/// The circularity of every circle of a grid, for one arm, one elbow and `N` loads.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(bound(serialize = "[f64; N]: Serialize"))]
pub struct Map<const N: usize> {
    /// The centres.
    pub grid: Grid,
    /// Circularity under each load in m (infinite where the arm is too soft for that load, but not for another), or why
    /// there is none; in the order of [`Grid::place`].
    pub nodes: Vec<Result<[f64; N], Obstacle>>,
}

impl<const N: usize> Map<N> {
    /// Mills every circle of the grid in one posture class. `row_done` is called after each row. Once the monitor asks
    /// to stop, the rest is left undone and the map is of no use. Rows of the grid are shared among the threads of
    /// rayon's pool; the result does not depend on their number.
    pub fn new(
        deflected: &DeflectedCircle<'_>,
        class: PostureClass,
        grid: Grid,
        loads: [f64; N],
        monitor: &Monitor,
        row_done: &(dyn Fn() + Sync),
    ) -> Self {
        let rows = (0..grid.counts[1]).into_par_iter().map_init(Profile::default, |profile, row| {
            let first = row * grid.counts[0];
            let mill = |index: usize| deflected.circularity(grid.place(index), class, loads, profile);
            if monitor.should_stop() {
                return vec![Err(Obstacle::Reach); grid.counts[0]];
            }
            let nodes: Vec<_> = (first..first + grid.counts[0]).map(mill).collect();
            row_done();
            nodes
        });
        Self { grid, nodes: rows.collect::<Vec<_>>().concat() }
    }

    /// Circularity under one of the loads, infinite where there is none. m
    pub fn values(&self, load: usize) -> Vec<f64> {
        self.nodes.iter().map(|node| node.as_ref().map_or(f64::INFINITY, |values| values[load])).collect()
    }

    /// Number of circles that can be milled under some load.
    pub fn count(&self) -> usize {
        self.nodes.iter().filter(|node| node.is_ok()).count()
    }

    /// Number of circles that each obstacle prevents, the most frequent first.
    pub fn obstacles(&self) -> Vec<(Obstacle, usize)> {
        let mut found: Vec<Obstacle> = self.nodes.iter().filter_map(|node| node.as_ref().err().copied()).collect();
        found.sort_unstable();
        let mut counted: Vec<_> = found.chunk_by(|a, b| a == b).map(|run| (run[0], run.len())).collect();
        counted.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        counted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use stead_model::robot::{Frames, testing};

    #[test]
    fn elbow_up_has_the_elbow_above_the_line_to_the_wrist() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let mut seen = [0, 0];
        for robot in testing::odd_arms().into_iter().chain([testing::kr270()]) {
            let geometry = robot.geometry();
            for _ in 0..100 {
                let theta: [f64; 6] = std::array::from_fn(|_| random.random_range(-3.1..3.1));
                let posture = stead_model::robot::Posture::of(&robot, &theta);
                let Some(elbow) = Elbow::BOTH.into_iter().find(|elbow| elbow.forward_class(&robot) == posture.class())
                else {
                    continue;
                };
                let frames = Frames::new(&robot, &theta);
                let root =
                    |p: nalgebra::Vector3<f64>| geometry.base_from_root.transpose() * (p - geometry.root_in_base);
                let [shoulder, joint, wrist] = [frames.origins[1], frames.origins[2], frames.wrist_centre()].map(root);
                // In the plane of the arm, seen with the wrist to the right.
                let (sine, cosine) = libm::sincos(theta[0]);
                let flat = |p: nalgebra::Vector3<f64>| [cosine * p.x + sine * p.y, p.z];
                let [s, e, w] = [shoulder, joint, wrist].map(flat);
                let above = (w[0] - s[0]) * (e[1] - s[1]) - (w[1] - s[1]) * (e[0] - s[0]);
                assert_eq!(above > 0.0, elbow == Elbow::Up, "{theta:?}");
                seen[usize::from(elbow == Elbow::Up)] += 1;
            }
        }
        assert!(seen[0] > 300 && seen[1] > 300, "{seen:?}");
    }

    #[test]
    fn places_run_along_the_first_axis_fastest() {
        let grid = Grid { origin: [-1.0, 2.0], step: 0.5, counts: [3, 2] };
        assert_eq!(grid.len(), 6);
        assert_eq!([0, 2, 3].map(|k| grid.place(k)), [[-1.0, 2.0], [0.0, 2.0], [-1.0, 2.5]]);
    }
}
