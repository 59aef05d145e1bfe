//! The shape of a lookup table of scores: what it is sampled over, where a problem allows one.

use crate::problem::Problem;
use crate::symmetry::{
    Unsupported, Upright, require_alike_flips, require_certain_compliances, require_constant, require_free_beta,
    require_mean_wall, require_no_moment,
};
use nalgebra::Vector2;
use std::f64::consts::TAU;
use stead_model::robot::turns::Range;

/// Step of radius and height. m
const STEP: f64 = 0.07;
/// Headings over a full turn, about.
const HEADINGS: usize = 120;
/// ... at least and at the most, where a number of the grid of beta can be had.
const HEADING_COUNTS: (usize, usize) = (90, 180);

/// Largest size of a table. Bytes
pub const MAX_BYTES: u64 = 1 << 30;

/// Fields of a row.
pub mod field {
    /// Half the trace of the in-plane compliance of joints 2 to 6. m/N
    pub const MEAN: usize = 0;
    /// Half the difference of radial and tangential compliance. m/N
    pub const DIFFERENCE: usize = 1;
    /// Compliance between radial and tangential. m/N
    pub const MIXED: usize = 2;
    /// Room left to the nearest limit, below zero where it is passed (rad, or 1/kappa).
    pub const ROOM: usize = 3;
    /// Compliance between radial and vertical, then between tangential and vertical. m/N
    pub const VERTICAL: usize = 4;
    /// How many fields the moment has: compliance between radial, then tangential, and a moment about radial,
    /// tangential and up. 1/N
    pub const MOMENT: usize = 6;
}

/// Evenly spaced values. m
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TableAxis {
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
    pub radius: TableAxis,
    /// Its height in the root frame.
    pub height: TableAxis,
    /// Headings of the spindle against the azimuth of the point, over a full turn.
    pub headings: usize,
    /// What is in it beside the in-plane compliance and the room left.
    pub parts: Parts,
}

/// What a table holds only where a problem needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parts {
    /// The compliance between the vertical and the plane.
    pub vertical: bool,
    /// The compliance between the plane and a moment.
    pub moment: bool,
    /// The angle of joint 1 against the azimuth: where joint 1 does not get all the way round.
    pub first_joint: bool,
}

/// Fields of a table with all parts.
pub const MAX_FIELDS: usize = field::VERTICAL + 2 + field::MOMENT + 2;

/// Weights of the four nodes around a place, for the cubic through them (Lagrange).
pub fn cubic(t: f64) -> [f32; 4] {
    let (a, b, c, d) = (t + 1.0, t, t - 1.0, t - 2.0);
    [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0].map(|weight| weight as f32)
}

impl TableAxis {
    /// An axis on which every value between two has two nodes on either side.
    fn around(min: f64, max: f64, step: f64) -> Self {
        Self { first: min - step, step, count: (((max - min) / step).ceil() as usize).saturating_add(4) }
    }

    /// The node of that number.
    pub fn node(&self, index: usize) -> f64 {
        self.first + self.step * index as f64
    }

    /// The first of the four nodes around a value, and their weights; `None` for a value that the axis does not cover.
    pub fn stencil(&self, value: f64) -> Option<(usize, [f32; 4])> {
        let place = (value - self.first) / self.step;
        // Rounding may leave the ends by a little.
        if !(place > 1.0 - 1e-6 && place < self.count as f64 - 2.0 + 1e-6) {
            return None;
        }
        let index = (place as usize).clamp(1, self.count - 3);
        Some((index - 1, cubic(place - index as f64)))
    }
}

/// Headings that go well with a grid of beta: as many as it has, or a multiple, or a part of them, so that places
/// between headings repeat along the grid.
fn headings(beta_count: usize) -> usize {
    let (min_count, max_count) = HEADING_COUNTS;
    if beta_count <= max_count {
        beta_count * min_count.div_ceil(beta_count)
    } else {
        (min_count..=max_count).rev().find(|count| beta_count.is_multiple_of(*count)).unwrap_or(HEADINGS)
    }
}

impl Shape {
    /// The shape of the table of a problem, if the problem has the symmetry and the table fits in memory.
    ///
    /// # Errors
    /// [`Unsupported`], with the reason.
    pub fn of(problem: &Problem) -> Result<Self, Unsupported> {
        Upright::of(problem)?;
        require_mean_wall(problem)?;
        require_free_beta(problem)?;
        require_constant(problem, &[0, 3, 4, 5])?;
        require_certain_compliances(problem)?;
        require_alike_flips(problem)?;
        let is_flat =
            problem.criterion.force_uncertainty == 0.0 && problem.task.wrenches().all(|wrench| wrench.force.z == 0.0);
        let parts = Parts {
            vertical: !is_flat,
            moment: require_no_moment(problem).is_err(),
            first_joint: !Range::of(&problem.robot.joints()[0]).has_turns(),
        };
        let shape = Self::new(problem, parts);
        let bytes = shape.bytes();
        if bytes > MAX_BYTES { Err(Unsupported::TooLarge { bytes, max: MAX_BYTES }) } else { Ok(shape) }
    }

    fn new(problem: &Problem, parts: Parts) -> Self {
        let g = problem.robot.geometry();
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
        let max_radius = (g.reach() + lever).max(STEP);
        let min = (nearest.norm() - reach).clamp(0.0, max_radius);
        let max = (farthest + reach).clamp(min, max_radius);
        let up = g.base_from_root.m33.signum();
        let heights = [z.min + low, z.max + high].map(|height| up * (height - g.root_in_base.z));
        let (below, above) = (g.shoulder_height - max_radius, g.shoulder_height + max_radius);
        let bottom = heights[0].min(heights[1]).clamp(below, above);
        let top = heights[0].max(heights[1]).clamp(below, above);
        Self {
            radius: TableAxis::around(min, max, STEP),
            height: TableAxis::around(bottom, top, STEP),
            headings: headings(problem.redundancy.beta_count),
            parts,
        }
    }

    /// Numbers in each state: m, d1, d2, the room left, and what else there is.
    pub fn fields(&self) -> usize {
        self.first_joint() + 2 * usize::from(self.parts.first_joint)
    }

    /// The first of the fields of the moment.
    pub fn moment(&self) -> usize {
        field::VERTICAL + 2 * usize::from(self.parts.vertical)
    }

    /// The first of the fields of joint 1: sine, then cosine.
    pub fn first_joint(&self) -> usize {
        self.moment() + field::MOMENT * usize::from(self.parts.moment)
    }

    /// Numbers in each row: all fields of one posture class over all headings.
    pub fn block(&self) -> usize {
        self.fields() * self.headings
    }

    /// States sampled.
    pub fn states(&self) -> u64 {
        (self.radius.count as u64).saturating_mul(self.height.count as u64).saturating_mul(self.headings as u64 * 4)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_go_with_the_grid_of_beta() {
        assert_eq!([120, 90, 60, 40, 24, 1].map(headings), [120, 90, 120, 120, 96, 90]);
        assert_eq!([360, 720, 1440, 1009].map(headings), [180, 180, 180, 120]);
    }

    #[test]
    fn a_cubic_is_interpolated_exactly_anywhere_on_an_axis() {
        let f = |x: f64| 1.0 + x * (0.3 + x * (-0.7 + 0.2 * x));
        let axis = TableAxis::around(-0.4, 1.3, 0.17);
        for value in [-0.4, -0.39, 0.0, 0.731, 1.29, 1.3] {
            let (first, weights) = axis.stencil(value).unwrap();
            let sum: f64 = (0..4).map(|k| f64::from(weights[k]) * f(axis.node(first + k))).sum();
            assert!((sum - f(value)).abs() < 1e-6, "{value} {sum}");
        }
        assert!(axis.stencil(-0.41).is_none() && axis.stencil(f64::NAN).is_none() && axis.stencil(1.6).is_none());
    }
}
