//! What is minimised: which part of a path point's deflection is scored, and how the points make up one figure.
//!
//! The score of a point is `c_i = sqrt(sum_k w_k d_k^2)`, d_k being the parts of its deflection along the directions of
//! [`Weights`], with what errors of forces and compliances can add to it. With one direction alone that is `|d|`: the
//! wall, `axis x feed`, gives c_i of Caro et al. 2013, eq. 11.

mod force_error;

pub use force_error::worst_force_error;
#[cfg(test)]
pub(crate) use force_error::worst_gain;
pub(crate) use force_error::worst_gains;

use super::sense::Sense;
use nalgebra::{Matrix3, Vector3};
use stead_model::robot::Robot;
use stead_numerics::scalar::Scalar;

/// A mean deflection below this is a cancellation: the plan balances the deflection to nothing, and ratios to it mean
/// nothing. m
pub const CANCELLATION: f64 = 1e-9;
/// A scored part below this share of the whole deflection is small: parts of different sign cancel in it.
pub const SMALL_PART: f64 = 0.2;

/// How much the parts of a deflection count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    /// Along the feed, made normal to the tool axis.
    pub feed: f64,
    /// Along `axis x feed`: what spoils a wall cut by the tool's side.
    pub wall: f64,
    /// Along the tool axis: what spoils a floor.
    pub axis: f64,
    /// Along the normal of the surface that the task states.
    pub surface: f64,
}

impl Weights {
    /// Nothing counts.
    pub const NONE: Self = Self { feed: 0.0, wall: 0.0, axis: 0.0, surface: 0.0 };
    /// The wall alone (Caro et al. 2013).
    pub const WALL: Self = Self { wall: 1.0, ..Self::NONE };
    /// The normal of the surface alone.
    pub const SURFACE: Self = Self { surface: 1.0, ..Self::NONE };
    /// The tool axis alone.
    pub const AXIS: Self = Self { axis: 1.0, ..Self::NONE };
    /// The size of the whole deflection.
    pub const TOTAL: Self = Self { feed: 1.0, wall: 1.0, axis: 1.0, surface: 0.0 };

    /// Whether one direction alone is scored, so that a score is the absolute value of a signed part.
    pub fn is_single(&self) -> bool {
        [self.feed, self.wall, self.axis, self.surface].iter().filter(|weight| **weight > 0.0).count() == 1
    }
}

/// What is scored alone, in the words of the field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// The part normal to the wall, `axis x feed`.
    Wall,
    /// The part normal to the surface that the task states.
    Surface,
    /// The part along the tool axis.
    Axis,
    /// The size of the whole deflection.
    Total,
}

impl Direction {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Wall, Self::Surface, Self::Axis, Self::Total];

    /// As weights.
    pub fn weights(self) -> Weights {
        match self {
            Self::Wall => Weights::WALL,
            Self::Surface => Weights::SURFACE,
            Self::Axis => Weights::AXIS,
            Self::Total => Weights::TOTAL,
        }
    }

    /// As files state it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wall => "wall",
            Self::Surface => "surface",
            Self::Axis => "axis",
            Self::Total => "total",
        }
    }
}

/// How the scores of the points make up the figure that is minimised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Aggregate {
    /// Their mean, f_MQC (Caro et al. 2013, eq. 13).
    #[default]
    Mean,
    /// The root of the mean of their squares.
    Rms,
    /// The largest.
    Max,
}

impl Aggregate {
    /// As files state it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mean => "mean",
            Self::Rms => "rms",
            Self::Max => "max",
        }
    }

    /// Whether joint travel can be weighed beside it: plans are made of steps that add up.
    pub fn weighs_joint_travel(self) -> bool {
        self == Self::Mean
    }

    /// What a point of this weight and score (m) adds to the cost of a plan.
    pub fn point_cost(self, weight: f64, score: f64) -> f64 {
        match self {
            Self::Mean | Self::Max => weight * score,
            Self::Rms => weight * score * score,
        }
    }

    /// The cost of two parts of a plan together.
    pub fn join(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Mean | Self::Rms => a + b,
            Self::Max => a.max(b),
        }
    }

    /// The same of costs times the sign of a sense ([`Sense::sign`]).
    pub fn join_signed(self, sense: Sense, a: f64, b: f64) -> f64 {
        match (self, sense) {
            (Self::Mean | Self::Rms, _) => a + b,
            (Self::Max, Sense::Min) => a.max(b),
            (Self::Max, Sense::Max) => a.min(b),
        }
    }
}

/// How the scores under several sets of joint stiffness make up that of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Over {
    /// Their mean.
    Mean,
    /// The largest.
    Worst,
    /// Their mean; of the refined basins that of the least regret is taken.
    Regret,
}

impl Over {
    /// As files state it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mean => "mean",
            Self::Worst => "worst",
            Self::Regret => "regret",
        }
    }
}

/// What the stiffness of the arm may be: several sets of one geometry.
#[derive(Debug, Clone, PartialEq)]
pub struct StiffnessSets {
    /// The arm of the problem with the compliances of each set, and what is known of them; at least one.
    pub robots: Vec<Robot>,
    /// How their scores make up that of a point.
    pub over: Over,
}

/// How a placement is scored.
#[derive(Debug, Clone, PartialEq)]
pub struct Criterion {
    /// Which part of the deflection counts.
    pub weights: Weights,
    /// How points make up one figure.
    pub aggregate: Aggregate,
    /// The weight of every segment; empty where all are 1.
    pub segment_weights: Vec<f64>,
    /// Relative size eps of the force error in any direction that a score must cover: the score is the largest over all
    /// errors up to `eps |f|`, with one direction n alone `c_i + eps |f| |K^-1 n|`. Zero leaves it out.
    pub force_uncertainty: f64,
    /// How many standard deviations sigma_i of c_i a score must cover, from the uncertainty of the robot's compliances:
    /// this adds `confidence sigma_i` to the score, beside what force errors add. Zero leaves it out, and so does a
    /// robot whose uncertainty is not known.
    pub confidence: f64,
    /// What a radian of joint travel in every [`STRETCH`](super::joint_travel::STRETCH) of the path adds to the
    /// objective, beside the mean of the scores; zero where the largest score or the root of the mean of squares is
    /// minimised, which planning cannot add it to. m/rad
    pub joint_travel_weight: f64,
    /// The stiffness sets that a score covers; none where it is that of the problem's robot.
    pub stiffness: Option<StiffnessSets>,
}

impl Criterion {
    /// The direction that is scored alone, where it is one of [`Direction::ALL`].
    pub fn direction(&self) -> Option<Direction> {
        Direction::ALL.into_iter().find(|direction| direction.weights() == self.weights)
    }
}

impl Default for Criterion {
    /// As published: the mean of the part normal to the wall.
    fn default() -> Self {
        Self {
            weights: Weights::WALL,
            aggregate: Aggregate::Mean,
            segment_weights: Vec::new(),
            force_uncertainty: 0.0,
            confidence: 0.0,
            joint_travel_weight: 0.0,
            stiffness: None,
        }
    }
}

/// The directions that are scored at a path point, each as long as the root of its weight: the score is the norm of the
/// deflection's parts along them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScoredDirections<T: Scalar = f64> {
    vectors: [Vector3<T>; 3],
    count: usize,
}

impl<T: Scalar> ScoredDirections<T> {
    /// Those of a path point with these axes (feed, left of the feed, tool axis) as columns, where the surface has this
    /// normal in the frame of the point.
    pub fn new(weights: &Weights, normal: Option<Vector3<f64>>, axes: &Matrix3<T>) -> Self {
        let Weights { feed, wall, axis, surface } = *weights;
        let normal = normal.filter(|_| surface > 0.0).map(|normal| normal * libm::sqrt(surface));
        let mut directions = Self { vectors: [Vector3::zeros(); 3], count: 0 };
        if *weights == Weights::WALL {
            // What the published score asks for, at every point of every candidate.
            directions.vectors[0] = axes.column(1).into_owned();
            directions.count = 1;
            return directions;
        }
        let mut add = |coefficients: [f64; 3]| {
            let mut vector = Vector3::zeros();
            for k in (0..3).filter(|k| coefficients[*k] != 0.0) {
                vector += axes.column(k).map(|entry| entry.scale(coefficients[k]));
            }
            directions.vectors[directions.count] = vector;
            directions.count += 1;
        };
        match normal {
            Some(normal) if weights.is_single() => add(normal.into()),
            Some(normal) => {
                let metric = Matrix3::from_diagonal(&Vector3::new(feed, wall, axis)) + normal * normal.transpose();
                factor(metric).into_iter().filter(|column| column.iter().any(|entry| *entry != 0.0)).for_each(add);
            }
            None => {
                for (k, weight) in [feed, wall, axis].into_iter().enumerate().filter(|(_, weight)| *weight > 0.0) {
                    add(std::array::from_fn(|j| if j == k { libm::sqrt(weight) } else { 0.0 }));
                }
            }
        }
        directions
    }

    /// The directions, from one to three.
    pub fn vectors(&self) -> &[Vector3<T>] {
        &self.vectors[..self.count]
    }

    /// All three, zero where there are fewer.
    pub fn padded(&self) -> &[Vector3<T>; 3] {
        &self.vectors
    }

    /// The only one, where there is one.
    pub fn single(&self) -> Option<&Vector3<T>> {
        if self.count == 1 { self.vectors.first() } else { None }
    }

    /// The parts of a deflection along them, zero beyond their number. m
    pub fn parts(&self, deflection: &Vector3<T>) -> Vector3<T> {
        Vector3::from(self.vectors.map(|vector| vector.dot(deflection)))
    }

    /// As a matrix with a row each.
    pub fn rows(&self) -> Matrix3<T> {
        Matrix3::from_columns(&self.vectors).transpose()
    }
}

/// Columns whose products with themselves sum up to a positive semidefinite matrix (Cholesky).
fn factor(mut matrix: Matrix3<f64>) -> [[f64; 3]; 3] {
    let mut columns = [[0.0; 3]; 3];
    let floor = 1e-14 * matrix.trace();
    for k in 0..3 {
        if matrix[(k, k)] > floor {
            let column = matrix.column(k) / libm::sqrt(matrix[(k, k)]);
            matrix -= column * column.transpose();
            columns[k] = column.into();
        }
    }
    columns
}
