//! Circularity over a plane of the cell (Klimchik 2017, Fig. 15 to 19).

use super::benchmark::{Benchmark, Obstacle, Profile};
use crate::robot::{PostureClass, Robot};
use rayon::prelude::*;

/// Centres of circles: the nodes of a square grid, in the coordinates of the benchmark's plane.
#[derive(Debug, Clone, Copy, PartialEq)]
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

/// Which way the elbow stands, seen in the plane of the arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Elbow {
    /// Above the line from the shoulder to the wrist centre.
    Up,
    /// Below it.
    Down,
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
        let geometry = robot.geometry();
        // With axis 2 lifting and axis 3 turning alike, delta <= 0 bends the forearm down, which puts the elbow up.
        let negative_is_up = geometry.lift * geometry.fold > 0.0;
        let negative = (self == Elbow::Up) == negative_is_up;
        PostureClass::ALL[usize::from(negative)]
    }
}

/// The circularity of every circle of a grid, for one arm, one elbow and `N` loads.
#[derive(Debug, Clone, PartialEq)]
pub struct Map<const N: usize> {
    /// The centres.
    pub grid: Grid,
    /// Circularity under each load in m, or why there is none; in the order of [`Grid::place`].
    pub nodes: Vec<Result<[f64; N], Obstacle>>,
}

impl<const N: usize> Map<N> {
    /// Mills every circle of the grid in one posture class. Rows of the grid are shared among the threads of rayon's pool;
    /// the result does not depend on their number.
    pub fn new(
        benchmark: &Benchmark,
        robot: &Robot,
        class: PostureClass,
        grid: Grid,
        loads: [f64; N],
        row_done: &(dyn Fn() + Sync),
    ) -> Self {
        let trial = benchmark.trial(robot);
        let rows = (0..grid.counts[1]).into_par_iter().map_init(Profile::default, |profile, row| {
            let first = row * grid.counts[0];
            let nodes: Vec<_> = (first..first + grid.counts[0])
                .map(|index| trial.circularity(grid.place(index), class, loads, profile))
                .collect();
            row_done();
            nodes
        });
        Self { grid, nodes: rows.collect::<Vec<_>>().concat() }
    }

    /// Circularity under one of the loads, infinite where there is none. m
    pub fn values(&self, load: usize) -> Vec<f64> {
        self.nodes.iter().map(|node| node.as_ref().map_or(f64::INFINITY, |values| values[load])).collect()
    }

    /// Number of circles that can be milled.
    pub fn count(&self) -> usize {
        self.nodes.iter().filter(|node| node.is_ok()).count()
    }

    /// How often each obstacle stands in the way, the most frequent first.
    pub fn obstacles(&self) -> Vec<(Obstacle, usize)> {
        let mut found: Vec<Obstacle> = self.nodes.iter().filter_map(|node| node.as_ref().err().copied()).collect();
        found.sort_unstable();
        let mut counted: Vec<_> = found.chunk_by(|a, b| a == b).map(|run| (run[0], run.len())).collect();
        counted.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        counted
    }
}
