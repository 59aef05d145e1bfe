//! Where the evaluator writes and the planner reads.

use std::ops::Range;
use stead_model::robot::PostureClass;
use stead_numerics::simd::{LaneNumber, Lanes, MAX_LANES, Simd};

/// Score and joint angles of all states of one path point: for each posture class thirteen rows over beta. The score is
/// what the state adds to the cost of a plan.
///
/// Joint angles are kept as sines and cosines, and on request as angles too. Each row is continued cyclically by `pad`
/// values at both ends, so that a planner can look to either side of beta without taking remainders: entry `pad + k`
/// belongs to beta number k.
#[derive(Debug, Clone)]
pub struct StateGrid<E = f64> {
    count: usize,
    pad: usize,
    stride: usize,
    rows: usize,
    data: Vec<E>,
    alive: [bool; 4],
}

/// Score, and sine and cosine of six joints;
const ROWS: usize = 13;
/// and their angles.
const ROWS_WITH_ANGLES: usize = 19;

impl<E: LaneNumber> StateGrid<E> {
    /// Room for `count` grid values of beta, continued by `pad` at both ends.
    pub fn new(count: usize, pad: usize) -> Self {
        // A few more, so that the last batch of lanes may run over.
        let stride = (count + 2 * pad).next_multiple_of(MAX_LANES) + MAX_LANES;
        Self { count, pad, stride, rows: ROWS, data: vec![E::of(f64::INFINITY); 4 * ROWS * stride], alive: [false; 4] }
    }

    /// The same before any state is written, with joint angles where they are kept, for joint travel.
    pub fn with_angles(mut self, are_kept: bool) -> Self {
        if are_kept {
            self.rows = ROWS_WITH_ANGLES;
            self.data.resize(4 * self.rows * self.stride, E::of(f64::INFINITY));
        }
        self
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
        if self.alive[class.index()] {
            self.scores_mut(class).fill(E::of(f64::INFINITY));
        }
        self.alive[class.index()] = false;
    }

    /// Marks states of a class, by their numbers of beta, as not allowed.
    pub fn forbid(&mut self, class: PostureClass, betas: impl Iterator<Item = usize>) {
        let (pad, count) = (self.pad, self.count);
        let scores = &mut self.scores_mut(class)[pad..pad + count];
        for beta in betas.filter(|beta| *beta < count) {
            scores[beta] = E::of(f64::INFINITY);
        }
        if !scores.iter().any(|score| score.get().is_finite()) {
            self.clear(class);
        }
    }

    /// Marks all states but those of one number of beta as not allowed.
    pub fn keep_beta(&mut self, only: usize) {
        for class in PostureClass::ALL {
            if self.is_alive(class) {
                self.forbid(class, (0..self.count).filter(|beta| *beta != only));
            }
        }
    }

    /// Scores with their cyclic continuation. m, infinite where not allowed
    pub fn scores(&self, class: PostureClass) -> &[E] {
        self.row(class, 0)
    }

    /// Scores without continuation. m, infinite where not allowed
    pub fn inner_scores(&self, class: PostureClass) -> &[E] {
        &self.scores(class)[self.pad..self.pad + self.count]
    }

    /// Sines and cosines of a joint's angles (joint from 0) with their cyclic continuation, meaningful where the score
    /// is finite.
    pub fn directions(&self, class: PostureClass, joint: usize) -> [&[E]; 2] {
        [self.row(class, 1 + 2 * joint), self.row(class, 2 + 2 * joint)]
    }

    /// The score row, to be overwritten by the planner with accumulated costs.
    pub fn scores_mut(&mut self, class: PostureClass) -> &mut [E] {
        let start = class.index() * self.rows * self.stride;
        &mut self.data[start..start + self.stride]
    }

    /// The score row, to be overwritten, beside [`StateGrid::all_joints`].
    #[inline(always)]
    pub fn scores_and_joints(&mut self, class: PostureClass) -> (&mut [E], [&[E]; 2]) {
        let (stride, size) = (self.stride, self.rows * self.stride);
        let (scores, joints) = self.data[class.index() * size..][..size].split_at_mut(stride);
        (scores, joints.split_at((ROWS - 1) * stride).into())
    }

    /// The rows of [`StateGrid::directions`] of all joints, one behind the other, each as long as
    /// [`StateGrid::scores`], and those of their angles, where they are kept (rad, from -pi to pi).
    #[inline(always)]
    pub fn all_joints(&self, class: PostureClass) -> [&[E]; 2] {
        let (stride, size) = (self.stride, self.rows * self.stride);
        self.data[class.index() * size + stride..][..size - stride].split_at((ROWS - 1) * stride).into()
    }

    /// What the state of a beta number adds to the cost of a plan, with its joint angles (rad), where these are kept;
    /// none where it is not allowed.
    pub fn state(&self, class: PostureClass, beta: usize) -> Option<(f64, [f64; 6])> {
        let (cost, [_, angles]) = (self.inner_scores(class)[beta].get(), self.all_joints(class));
        cost.is_finite().then(|| (cost, std::array::from_fn(|j| angles[j * self.stride + self.pad + beta].get())))
    }

    /// Writes one state: beta number `beta`, its score (m) and joint angles (rad).
    pub fn set(&mut self, class: PostureClass, beta: usize, score: f64, joints: [f64; 6]) {
        let place = class.index() * self.rows * self.stride + self.pad + beta;
        self.alive[class.index()] = true;
        self.data[place] = E::of(score);
        for (j, angle) in joints.into_iter().enumerate() {
            let (sine, cosine) = libm::sincos(angle);
            self.data[place + (1 + 2 * j) * self.stride] = E::of(sine);
            self.data[place + (2 + 2 * j) * self.stride] = E::of(cosine);
            if self.rows > ROWS {
                self.data[place + (ROWS + j) * self.stride] = E::of(libm::atan2(sine, cosine));
            }
        }
    }

    /// Writes states side by side, the first one of beta number `beta`; scores are infinite where not allowed, and some
    /// are not.
    #[inline(always)]
    pub(super) fn set_lanes<S: Simd<Number = E>>(
        &mut self,
        class: PostureClass,
        beta: usize,
        score: Lanes<S>,
        directions: &[[Lanes<S>; 2]; 6],
    ) {
        let stride = self.stride;
        self.alive[class.index()] = true;
        let has_angles = self.rows > ROWS;
        let rows = &mut self.data[class.index() * self.rows * stride..][..self.rows * stride];
        let place = self.pad + beta;
        score.store(rows, place);
        for j in 0..6 {
            directions[j][0].store(rows, (1 + 2 * j) * stride + place);
            directions[j][1].store(rows, (2 + 2 * j) * stride + place);
            if has_angles {
                directions[j][0].atan2(directions[j][1]).store(rows, (ROWS + j) * stride + place);
            }
        }
    }

    /// Continues the rows of a class cyclically after they were written.
    pub fn wrap_around(&mut self, class: PostureClass) {
        self.wrap_scores(class);
        self.wrap_joints(class);
    }

    /// The same with the scores alone.
    pub fn wrap_scores(&mut self, class: PostureClass) {
        self.wrap_rows(class, 0..1);
    }

    /// The same with the joint angles alone.
    pub fn wrap_joints(&mut self, class: PostureClass) {
        self.wrap_rows(class, 1..self.rows);
    }

    fn wrap_rows(&mut self, class: PostureClass, rows: Range<usize>) {
        let (count, pad, stride) = (self.count, self.pad, self.stride);
        let of_class = &mut self.data[class.index() * self.rows * stride..][..self.rows * stride];
        for row in of_class[rows.start * stride..rows.end * stride].chunks_exact_mut(stride) {
            row.copy_within(count..count + pad, 0);
            row.copy_within(pad..2 * pad, count + pad);
        }
    }

    fn row(&self, class: PostureClass, row: usize) -> &[E] {
        &self.data[(class.index() * self.rows + row) * self.stride..][..self.stride]
    }
}
