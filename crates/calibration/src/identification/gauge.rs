//! Which springs of an arm no measurement on its flange tells apart, and what is told of them: a fixed gauge, and the
//! split of what was found among them.
//!
//! With the springs of joints 4 and 5 in the wrist centre, y of joint 4 and z of joint 5 turn the flange about one line
//! in every configuration, so do y of joint 5 and z of joint 6; and as much more compliance about all directions of
//! joint 4 as there is less of joint 5 changes nothing. Which springs hang together so is computed for the arm at hand:
//! the compliance of the flange is `sum_k c_k J_k J_k^T`, with J_k how spring k moves it, and in the sum over many
//! configurations of the products of two such terms, `(J_k . J_l)^2`, a spring that others can replace has nothing that
//! is its own. In the fixed gauge that spring is zero, and those that replace it have its share.

use super::elastic::Elastic;
use super::springs::{FULL, FitModel, column, spring};
use nalgebra::{DMatrix, DVector, Vector6};
use serde::Serialize;
use std::f64::consts::TAU;
use stead_model::robot::{About, Robot, Spring};

/// A spring that is zero in the fixed gauge, since others replace it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Replaced {
    /// The spring.
    pub spring: Spring,
    /// The springs that replace it: per rad/(N m) of it, so much of each.
    pub by: Vec<(Spring, f64)>,
}

/// Which springs of an arm cannot be told apart, and which of those are zero in the fit.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Gauge {
    /// The springs that are zero.
    pub replaced: Vec<Replaced>,
}

/// Configurations over which springs are compared.
const CONFIGURATIONS: usize = 64;
/// A spring with less than this share of its own can be replaced by others.
const DEPENDENT: f64 = 1e-11;
/// Shares so near to a whole number are that number: what is left is rounding.
const WHOLE: f64 = 1e-6;

/// The springs in the order in which they are kept: about the axes, then from the base on, at the wrist such that what
/// is left out are y of joint 5, and, where the springs of joint 4 sit in the wrist centre, y of joint 4 and x of joint
/// 5.
fn kept_first() -> impl Iterator<Item = usize> {
    let last = [(3, About::Y), (4, About::X), (4, About::Y)].map(|(joint, about)| column(Spring { joint, about }));
    (0..FULL).filter(move |column| !last.contains(column)).chain(last)
}

impl Gauge {
    /// For the springs of an arm that are sought, in the order of [`super::springs`].
    pub fn new(robot: &Robot, sought: &[bool; FULL]) -> Self {
        let products = products(robot);
        let mut kept: Vec<usize> = Vec::new();
        let mut replaced = Vec::new();
        for candidate in kept_first().filter(|column| sought[*column]) {
            let among = DMatrix::from_fn(kept.len(), kept.len(), |a, b| products[(kept[a], kept[b])]);
            let with = DVector::from_fn(kept.len(), |a, _| products[(kept[a], candidate)]);
            let shares = among.cholesky().map(|factor| factor.solve(&with)).unwrap_or_default();
            let own = products[(candidate, candidate)] - with.dot(&shares);
            if own > DEPENDENT * products[(candidate, candidate)] {
                kept.push(candidate);
                continue;
            }
            let whole = |share: f64| if (share - share.round()).abs() < WHOLE { share.round() } else { share };
            let by = kept.iter().zip(shares.iter()).map(|(column, share)| (spring(*column), whole(*share)));
            replaced.push(Replaced { spring: spring(candidate), by: by.filter(|(_, share)| *share != 0.0).collect() });
        }
        Self { replaced }
    }

    /// For an arm whose springs are sought but those that are held; among springs about the axes alone every sheet may
    /// tell all.
    pub fn of<const N: usize>(model: FitModel, robot: &Robot, held: &[bool; N]) -> Self {
        match model {
            FitModel::Axes => Self::default(),
            FitModel::Full => Self::new(robot, &std::array::from_fn(|column| !held[column])),
        }
    }

    /// Whether a spring is zero in the fixed gauge.
    pub fn is_zero(&self, spring: Spring) -> bool {
        self.replaced.iter().any(|replaced| replaced.spring == spring)
    }

    /// What is found under the name of a spring: the springs that are told only together with it, and how much of each
    /// is in the sum.
    pub fn others(&self, with: Spring) -> Vec<(Spring, f64)> {
        let share = |replaced: &Replaced| {
            let by = replaced.by.iter().find(|(spring, _)| *spring == with);
            by.map(|(_, share)| (replaced.spring, *share))
        };
        self.replaced.iter().filter_map(share).collect()
    }

    /// The name of what is found under the name of a spring: "joint 5 about z with joint 4 about y", "joint 6 about z
    /// with joint 5 about y, less joint 5 about x".
    pub fn sum_name(&self, with: Spring, name: String) -> String {
        let others = self.others(with);
        let named = |share: f64, spring: &Spring| {
            if share == 1.0 { spring.to_string() } else { format!("{share:.4} times {spring}") }
        };
        let more: Vec<String> =
            others.iter().filter(|(_, share)| *share > 0.0).map(|(spring, share)| named(*share, spring)).collect();
        let less: Vec<String> =
            others.iter().filter(|(_, share)| *share < 0.0).map(|(spring, share)| named(-share, spring)).collect();
        let more = if more.is_empty() { String::new() } else { format!(" with {}", more.join(" and ")) };
        let less = match (less.is_empty(), more.is_empty()) {
            (true, _) => String::new(),
            (false, true) => format!(" less {}", less.join(" and ")),
            (false, false) => format!(", less {}", less.join(" and ")),
        };
        format!("{name}{more}{less}")
    }

    /// The compliances in the fixed gauge that change no deflection. rad/(N m)
    pub fn fixed(&self, compliances: &[f64; FULL]) -> [f64; FULL] {
        let mut fixed = *compliances;
        for Replaced { spring, by } in &self.replaced {
            let value = std::mem::replace(&mut fixed[column(*spring)], 0.0);
            by.iter().for_each(|(other, share)| fixed[column(*other)] += share * value);
        }
        fixed
    }

    /// The compliances that change no deflection, with all values at or above the lowest allowed ones and the least sum
    /// of squares; nothing where no such compliances have these sums.
    ///
    /// The values of the springs that are zero in the fixed gauge are a few unknowns in which everything is linear: the
    /// least sum of squares has some set of values at their lowest, and all sets are tried.
    pub fn split(&self, fixed: &[f64; FULL], lowest: &[f64; FULL]) -> Option<[f64; FULL]> {
        let unknowns = self.replaced.len();
        if unknowns == 0 {
            return Some(*fixed);
        }
        // c = fixed + slopes x.
        let mut slopes = DMatrix::<f64>::zeros(FULL, unknowns);
        for (unknown, Replaced { spring, by }) in self.replaced.iter().enumerate() {
            slopes[(column(*spring), unknown)] = 1.0;
            by.iter().for_each(|(other, share)| slopes[(column(*other), unknown)] -= share);
        }
        let moving: Vec<usize> = (0..FULL).filter(|row| slopes.row(*row).iter().any(|slope| *slope != 0.0)).collect();
        let size = moving.iter().map(|row| fixed[*row].abs()).fold(0.0, f64::max);
        let at = |x: &DVector<f64>| -> [f64; FULL] {
            std::array::from_fn(|row| fixed[row] + slopes.row(row).transpose().dot(x))
        };
        let is_allowed = |c: &[f64; FULL]| moving.iter().all(|row| c[*row] >= lowest[*row] - ROUNDING * size);
        let mut best: Option<(f64, [f64; FULL])> = None;
        for set in subsets(moving.len(), unknowns) {
            // Stationary under these values at their lowest: [S^T S, B^T; B, 0] [x; multipliers] = [-S^T f; l - f].
            let rows: Vec<usize> = set.iter().map(|place| moving[*place]).collect();
            let count = unknowns + rows.len();
            let mut matrix = DMatrix::zeros(count, count);
            let mut right = DVector::zeros(count);
            for a in 0..unknowns {
                for b in 0..unknowns {
                    matrix[(a, b)] = slopes.column(a).dot(&slopes.column(b));
                }
                right[a] = -(0..FULL).map(|row| slopes[(row, a)] * fixed[row]).sum::<f64>();
                for (place, row) in rows.iter().enumerate() {
                    matrix[(a, unknowns + place)] = slopes[(*row, a)];
                    matrix[(unknowns + place, a)] = slopes[(*row, a)];
                }
            }
            for (place, row) in rows.iter().enumerate() {
                right[unknowns + place] = lowest[*row] - fixed[*row];
            }
            let Some(solved) = matrix.lu().solve(&right) else { continue };
            let found = at(&solved.rows(0, unknowns).into_owned());
            let square: f64 = found.iter().map(|value| value * value).sum();
            let is_better = best.as_ref().is_none_or(|(least, _)| square < *least);
            if square.is_finite() && is_better && is_allowed(&found) {
                best = Some((square, found));
            }
        }
        let (_, mut found) = best?;
        moving.iter().for_each(|row| found[*row] = found[*row].max(lowest[*row]));
        Some(found)
    }
}

/// Values below the lowest by no more than this share of the largest are rounding.
const ROUNDING: f64 = 1e-12;

/// All sets of at most `most` of the numbers below `count`.
fn subsets(count: usize, most: usize) -> Vec<Vec<usize>> {
    let mut all = vec![vec![]];
    let mut first = 0;
    for _ in 0..most {
        let end = all.len();
        for index in first..end {
            let next = all[index].last().map_or(0, |last| last + 1);
            for more in next..count {
                let mut set = all[index].clone();
                set.push(more);
                all.push(set);
            }
        }
        first = end;
    }
    all
}

/// The sum over many configurations of `(J_k . J_l)^2`, with lengths in units of the arm's.
fn products(robot: &Robot) -> DMatrix<f64> {
    // Angles that repeat in no configuration: multiples of irrational parts of a turn.
    const PARTS: [f64; 6] = [0.618_033_989, 0.414_213_562, 0.732_050_808, 0.236_067_977, 0.645_751_311, 0.316_624_790];
    let size = robot.joints().iter().map(|joint| joint.a.abs() + joint.d.abs()).sum::<f64>();
    let mut products = DMatrix::zeros(FULL, FULL);
    for number in 1..=CONFIGURATIONS {
        let arm = Elastic::<FULL>::unloaded(robot, &PARTS.map(|part| (number as f64 * part).fract() * TAU));
        let moved: [Vector6<f64>; FULL] = std::array::from_fn(|column| {
            let (linear, angular) = arm.twist(column, &arm.base_from_flange.translation);
            let linear = linear / size;
            Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
        });
        for a in 0..FULL {
            for b in 0..FULL {
                let product = moved[a].dot(&moved[b]);
                products[(a, b)] += product * product;
            }
        }
    }
    products
}
