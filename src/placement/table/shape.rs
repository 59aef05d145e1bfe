//! What a table is sampled over.

use crate::placement::problem::Problem;
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// Step of radius and height. m
const STEP: f64 = 0.07;
/// Headings over a full turn, at least.
const HEADINGS: usize = 120;

/// Evenly spaced values. m
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// The first of them.
    pub first: f64,
    /// From one to the next.
    pub step: f64,
    /// How many.
    pub count: usize,
}

/// The size of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// Distance of the tool centre point from axis 1.
    pub radius: Axis,
    /// Its height in the root frame.
    pub height: Axis,
    /// Headings of the spindle against the azimuth of the point, over a full turn.
    pub headings: usize,
    /// Whether the compliance between the vertical and the plane is in it.
    pub has_vertical: bool,
    /// Whether the angle of joint 1 against the azimuth is in it: where joint 1 does not get all the way round.
    pub has_first_joint: bool,
}

/// Weights of the four nodes around a place, for the cubic through them (Lagrange).
pub(super) fn cubic(t: f64) -> [f32; 4] {
    let (a, b, c, d) = (t + 1.0, t, t - 1.0, t - 2.0);
    [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0].map(|weight| weight as f32)
}

impl Axis {
    /// An axis on which every value between two has two nodes on either side.
    fn around(min: f64, max: f64, step: f64) -> Self {
        Self { first: min - step, step, count: ((max - min) / step).ceil() as usize + 4 }
    }

    /// The node of that number.
    pub fn node(&self, index: usize) -> f64 {
        self.first + self.step * index as f64
    }

    /// The first of the four nodes around a value, and their weights; `None` for a value that the axis does not cover.
    pub(super) fn stencil(&self, value: f64) -> Option<(usize, [f32; 4])> {
        let place = (value - self.first) / self.step;
        // Rounding may leave the ends by a little.
        if !(place > 1.0 - 1e-6 && place < self.count as f64 - 2.0 + 1e-6) {
            return None;
        }
        let index = (place as usize).clamp(1, self.count - 3);
        Some((index - 1, cubic(place - index as f64)))
    }
}

impl Shape {
    pub(super) fn new(problem: &Problem, upside: f64, has_vertical: bool, has_first_joint: bool) -> Self {
        let g = problem.robot.geometry();
        let _ = upside;
        let [x, y, z] = problem.cell.position;
        let nearest =
            Vector2::new(x.clamp(g.root_in_base.x) - g.root_in_base.x, y.clamp(g.root_in_base.y) - g.root_in_base.y);
        let side = |min: f64, max: f64, root: f64| (min - root).abs().max((max - root).abs());
        let farthest = libm::hypot(side(x.min, x.max, g.root_in_base.x), side(y.min, y.max, g.root_in_base.y));
        let (mut reach, mut low, mut high) = (0.0_f64, f64::INFINITY, f64::NEG_INFINITY);
        for point in problem.task.points() {
            reach = reach.max(libm::hypot(point.position.x, point.position.y));
            low = low.min(point.position.z);
            high = high.max(point.position.z);
        }
        // Beyond the arm and its tool there is nothing to sample.
        let lever = problem.spindle.flange_from_tool.translation.norm() + g.flange.abs();
        let most = (g.reach() + lever).max(STEP);
        let min = (nearest.norm() - reach).clamp(0.0, most);
        let max = (farthest + reach).clamp(min, most);
        let up = g.base_from_root.m33;
        let heights = [z.min + low, z.max + high].map(|height| up * (height - g.root_in_base.z));
        let beta_count = problem.redundancy.beta_count;
        Self {
            radius: Axis::around(min, max, STEP),
            height: Axis::around(heights[0].min(heights[1]), heights[0].max(heights[1]), STEP),
            headings: beta_count * HEADINGS.div_ceil(beta_count),
            has_vertical,
            has_first_joint,
        }
    }

    /// Numbers in each state: m, d1, d2, the room left, and what else there is.
    pub fn fields(&self) -> usize {
        4 + 2 * usize::from(self.has_vertical) + 2 * usize::from(self.has_first_joint)
    }

    /// The first of the fields of joint 1: sine, then cosine.
    pub(super) fn first_joint(&self) -> usize {
        4 + 2 * usize::from(self.has_vertical)
    }

    /// Numbers in each row: all fields of one posture class over all headings.
    pub(super) fn block(&self) -> usize {
        self.fields() * self.headings
    }

    /// States sampled.
    pub fn states(&self) -> u64 {
        self.radius.count as u64 * self.height.count as u64 * self.headings as u64 * 4
    }

    /// What it takes in memory. Bytes
    pub fn bytes(&self) -> u64 {
        self.states().saturating_mul(self.fields() as u64 * 4)
    }

    /// Step of the heading. rad
    pub fn heading_step(&self) -> f64 {
        TAU / self.headings as f64
    }
}
