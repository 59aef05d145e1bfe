//! Where the kernel writes and the planner reads.

use crate::robot::PostureClass;

/// Score and joint angles of all states of one path point: for each posture class seven rows over beta.
///
/// Each row is continued cyclically by `pad` values at both ends, so that a planner can look to either side of beta
/// without taking remainders: entry `pad + k` belongs to beta number k.
#[derive(Debug, Clone)]
pub struct States {
    count: usize,
    pad: usize,
    stride: usize,
    data: Vec<f64>,
    alive: [bool; 4],
}

/// The rows of one posture class.
#[derive(Debug)]
pub struct StatesView<'a> {
    rows: &'a mut [f64],
    stride: usize,
    pad: usize,
    alive: &'a mut bool,
}

const ROWS: usize = 7;

impl States {
    /// Room for `count` grid values of beta, continued by `pad` at both ends.
    pub fn new(count: usize, pad: usize) -> Self {
        // A few more, so that the last batch of lanes may run over.
        let stride = count + 2 * pad + super::lanes::WIDTH;
        Self { count, pad, stride, data: vec![f64::INFINITY; 4 * ROWS * stride], alive: [false; 4] }
    }

    /// Number of grid values.
    pub fn count(&self) -> usize {
        self.count
    }

    /// How far rows are continued at both ends.
    pub fn pad(&self) -> usize {
        self.pad
    }

    /// Whether any state of the class is allowed.
    pub fn is_alive(&self, class: PostureClass) -> bool {
        self.alive[class.index()]
    }

    /// Marks every state of a class as not allowed.
    pub fn clear(&mut self, class: PostureClass) {
        let start = class.index() * ROWS * self.stride;
        if self.alive[class.index()] {
            self.data[start..start + self.stride].fill(f64::INFINITY);
        }
        self.alive[class.index()] = false;
    }

    /// The rows of a class, to write.
    pub fn class_mut(&mut self, class: PostureClass) -> StatesView<'_> {
        let size = ROWS * self.stride;
        StatesView {
            rows: &mut self.data[class.index() * size..][..size],
            stride: self.stride,
            pad: self.pad,
            alive: &mut self.alive[class.index()],
        }
    }

    /// Scores with their cyclic continuation. m, infinite where not allowed
    pub fn scores(&self, class: PostureClass) -> &[f64] {
        self.row(class, 0)
    }

    /// Scores without continuation. m, infinite where not allowed
    pub fn inner_scores(&self, class: PostureClass) -> &[f64] {
        &self.scores(class)[self.pad..self.pad + self.count]
    }

    /// Angles of a joint (from 0) with their cyclic continuation, meaningful where the score is finite. rad
    pub fn joint(&self, class: PostureClass, joint: usize) -> &[f64] {
        self.row(class, 1 + joint)
    }

    /// The score row, to be overwritten by the planner with accumulated costs.
    pub fn scores_mut(&mut self, class: PostureClass) -> &mut [f64] {
        let start = class.index() * ROWS * self.stride;
        &mut self.data[start..start + self.stride]
    }

    /// Continues the rows of a class cyclically after they were written.
    pub fn wrap_around(&mut self, class: PostureClass) {
        let (count, pad) = (self.count, self.pad);
        for row in self.data[class.index() * ROWS * self.stride..][..ROWS * self.stride].chunks_exact_mut(self.stride) {
            row.copy_within(count..count + pad, 0);
            row.copy_within(pad..2 * pad, count + pad);
        }
    }

    fn row(&self, class: PostureClass, row: usize) -> &[f64] {
        &self.data[(class.index() * ROWS + row) * self.stride..][..self.stride]
    }
}

impl StatesView<'_> {
    /// Writes one state: beta number `beta`, its score and joint angles.
    #[inline(always)]
    pub fn set(&mut self, beta: usize, score: f64, joints: [f64; 6]) {
        let place = self.pad + beta;
        *self.alive = true;
        self.rows[place] = score;
        for (j, angle) in joints.into_iter().enumerate() {
            self.rows[(1 + j) * self.stride + place] = angle;
        }
    }
}
