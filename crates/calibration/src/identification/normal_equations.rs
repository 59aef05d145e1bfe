//! Normal equations of the compliances, kept sparse: configurations with different angles of the varying joint share no
//! column but those of the other joints, so that the matrix is an arrow and everything below is linear in its size.

use super::inverse::inverse_over;
use super::model::{Layout, Observation, Parameter};
use super::sheet::Sheet;
use super::springs::column;
use nalgebra::{DMatrix, SMatrix, SVector, SymmetricEigen};
use serde::Serialize;

/// Sums over readings: of the products of columns, and of columns and deflections.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalEquations<const N: usize> {
    /// The varying joint, whose row and column of `shared` are zero. Springs are in the order of [`super::springs`].
    pub varying: Option<usize>,
    /// Products of the columns of the springs that do not vary.
    pub shared: SMatrix<f64, N, N>,
    /// Those with the deflections.
    pub shared_rhs: SVector<f64, N>,
    /// The same for each distinct angle of the varying joint.
    pub groups: Vec<Group<N>>,
    /// Sum of the weights.
    pub weight: f64,
}

/// The part of one distinct angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Group<const N: usize> {
    /// Product of its column with those of the other springs.
    pub coupling: SVector<f64, N>,
    /// Product with itself.
    pub diagonal: f64,
    /// Product with the deflections.
    pub rhs: f64,
    /// Sum of the weights.
    pub weight: f64,
}

/// Which parameters are free; the others keep the values they are given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FreeParameters<const N: usize> {
    /// Springs; that of the varying joint is not among them.
    pub joints: [bool; N],
    /// Distinct angles.
    pub groups: Vec<bool>,
}

impl<const N: usize> FreeParameters<N> {
    /// Holds a parameter; whether it was free before.
    fn hold(&mut self, parameter: Parameter) -> bool {
        let was_free = self.contains(parameter);
        match parameter {
            Parameter::Group(group) => self.groups[group] = false,
            joint => self.joints[column(joint.spring(None))] = false,
        }
        was_free
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.joints.iter().chain(&self.groups).filter(|free| **free).count()
    }

    /// Whether a parameter is free.
    pub fn contains(&self, parameter: Parameter) -> bool {
        match parameter {
            Parameter::Group(group) => self.groups[group],
            joint => self.joints[column(joint.spring(None))],
        }
    }
}

/// Compliances of all parameters, and the covariance of the free ones for equations of unit variance.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution<const N: usize> {
    /// Of the springs that do not vary. rad/(N m)
    pub joints: SVector<f64, N>,
    /// At the distinct angles. rad/(N m)
    pub groups: Vec<f64>,
    /// Covariance of the springs; zero for what is not free.
    pub covariance: SMatrix<f64, N, N>,
    /// For each distinct angle: how its estimate follows an error of the springs, and its own variance for given ones.
    pub follow: Vec<(SVector<f64, N>, f64)>,
}

/// A combination of parameters along which no reading changes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Unidentifiable {
    /// The parameters in it, the one with the largest share first. A single one affects no reading at all.
    pub parameters: Vec<Parameter>,
}

/// A column whose root mean square is less than this part of the largest is taken for zero: what is left is rounding.
const ZERO_COLUMN: f64 = 1e-8;
/// Columns of unit length whose smallest singular value squared is less than this part of the largest are dependent.
const DEPENDENT: f64 = 1e-11;
/// Parameters with less than this share of a dependence are not named.
const SHARE: f64 = 0.05;

impl<const N: usize> NormalEquations<N> {
    /// Sums over all readings with these weights, one for each reading.
    pub fn new(sheet: &Sheet, layout: &Layout, observations: &[Observation<N>], weights: &[f64]) -> Self {
        let group = Group { coupling: SVector::zeros(), diagonal: 0.0, rhs: 0.0, weight: 0.0 };
        let mut normal = Self {
            varying: layout.varying,
            shared: SMatrix::zeros(),
            shared_rhs: SVector::zeros(),
            groups: vec![group; layout.angles.len()],
            weight: 0.0,
        };
        for ((reading, observation), weight) in sheet.readings.iter().zip(observations).zip(weights) {
            if *weight > 0.0 {
                normal.add(observation, layout.group(reading.configuration), *weight);
            }
        }
        normal
    }

    fn add(&mut self, observation: &Observation<N>, group: Option<usize>, weight: f64) {
        let mut products = observation.design.tr_mul(&observation.design) * weight;
        let mut rhs = observation.design.tr_mul(&observation.deflection) * weight;
        if let (Some(joint), Some(group)) = (self.varying, group) {
            let group = &mut self.groups[group];
            group.diagonal += products[(joint, joint)];
            group.rhs += rhs[joint];
            group.weight += weight;
            products.fill_row(joint, 0.0);
            group.coupling += products.column(joint);
            products.fill_column(joint, 0.0);
            rhs[joint] = 0.0;
        }
        self.shared += products;
        self.shared_rhs += rhs;
        self.weight += weight;
    }

    /// All parameters free but those of held springs; the varying one is not held.
    pub fn free_unless(&self, hold: [bool; N]) -> FreeParameters<N> {
        FreeParameters {
            joints: std::array::from_fn(|joint| self.varying != Some(joint) && !hold[joint]),
            groups: vec![true; self.groups.len()],
        }
    }

    /// Parameters whose columns are zero but for rounding.
    fn zero_columns(&self, free: &FreeParameters<N>) -> Vec<Parameter> {
        let mean = |square: f64, weight: f64| if weight > 0.0 { square / weight } else { 0.0 };
        let joint = |joint: usize| mean(self.shared[(joint, joint)], self.weight);
        let group = |group: usize| mean(self.groups[group].diagonal, self.groups[group].weight);
        let largest = (0..N).map(joint).chain((0..self.groups.len()).map(group)).fold(0.0, f64::max);
        let joints = (0..N)
            .filter(|j| free.joints[*j] && joint(*j) <= ZERO_COLUMN * ZERO_COLUMN * largest)
            .map(Parameter::of_column);
        let groups =
            (0..self.groups.len()).filter(|g| free.groups[*g] && group(*g) <= ZERO_COLUMN * ZERO_COLUMN * largest);
        joints.chain(groups.map(Parameter::Group)).collect()
    }

    /// The unidentifiable combinations: zero columns first, or, where there are none, dependent ones.
    pub fn unidentifiable(&self, free: &FreeParameters<N>) -> Vec<Unidentifiable> {
        let zero_columns = self.zero_columns(free);
        if !zero_columns.is_empty() {
            return zero_columns.into_iter().map(|parameter| Unidentifiable { parameters: vec![parameter] }).collect();
        }
        let joints: Vec<usize> = (0..N).filter(|joint| free.joints[*joint]).collect();
        if joints.is_empty() {
            return vec![];
        }
        let scale = joints.iter().map(|j| 1.0 / libm::sqrt(self.shared[(*j, *j)])).collect::<Vec<_>>();
        let reduced = self.reduced(free);
        let size = joints.len();
        let scaled = DMatrix::from_fn(size, size, |a, b| reduced[(joints[a], joints[b])] * scale[a] * scale[b]);
        let eigen = SymmetricEigen::new(scaled);
        let dependent = (0..size).filter(|k| eigen.eigenvalues[*k] <= DEPENDENT);
        let name = |k: usize| {
            let mut shares: Vec<(Parameter, f64)> = joints
                .iter()
                .enumerate()
                .map(|(a, j)| (Parameter::of_column(*j), eigen.eigenvectors[(a, k)]))
                .collect();
            let along = joints.iter().enumerate().fold(SVector::zeros(), |mut along: SVector<f64, N>, (a, j)| {
                along[*j] = eigen.eigenvectors[(a, k)] * scale[a];
                along
            });
            for (index, group) in self.groups.iter().enumerate().filter(|(index, _)| free.groups[*index]) {
                let share = -group.coupling.dot(&along) / libm::sqrt(group.diagonal);
                shares.push((Parameter::Group(index), share));
            }
            shares.retain(|(_, share)| share.abs() > SHARE);
            shares.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
            Unidentifiable { parameters: shares.into_iter().map(|(parameter, _)| parameter).collect() }
        };
        dependent.map(name).collect()
    }

    /// The identifiable parameters among those that are not held, and every unidentifiable combination: of each the
    /// first parameter is taken out until the others are identifiable.
    pub fn identifiable(&self, hold: [bool; N]) -> (FreeParameters<N>, Vec<Unidentifiable>) {
        let mut free = self.free_unless(hold);
        let mut all: Vec<Unidentifiable> = Vec::new();
        loop {
            let unidentifiable = self.unidentifiable(&free);
            let known = all.len();
            for unidentifiable in unidentifiable {
                if unidentifiable.parameters.first().is_some_and(|first| free.hold(*first)) {
                    all.push(unidentifiable);
                }
            }
            if all.len() == known {
                return (free, all);
            }
        }
    }

    /// Products of the springs' columns less what the free groups explain of them (Schur complement).
    fn reduced(&self, free: &FreeParameters<N>) -> SMatrix<f64, N, N> {
        let groups = self.groups.iter().zip(&free.groups).filter(|(_, free)| **free);
        groups.fold(self.shared, |sum, (group, _)| sum - group.coupling * group.coupling.transpose() / group.diagonal)
    }

    /// The least-squares estimate (Klimchik et al. 2017, eq. 18), with what is not free held at the values of `held`;
    /// nothing where the matrix is singular.
    pub fn solve(&self, free: &FreeParameters<N>, held: (&SVector<f64, N>, &[f64])) -> Option<Solution<N>> {
        let (mut joints, mut groups) = (*held.0, held.1.to_vec());
        for (joint, is_free) in free.joints.iter().enumerate() {
            if *is_free || self.varying == Some(joint) {
                joints[joint] = 0.0;
            }
        }
        for (value, is_free) in groups.iter_mut().zip(&free.groups) {
            if *is_free {
                *value = 0.0;
            }
        }
        // What the held parameters do is taken off, then what the free groups explain.
        let mut rhs = self.shared_rhs - self.shared * joints;
        for (group, value) in self.groups.iter().zip(&groups) {
            rhs -= group.coupling * *value;
        }
        let group_rhs: Vec<f64> =
            self.groups.iter().zip(&groups).map(|(g, v)| g.rhs - g.coupling.dot(&joints) - g.diagonal * v).collect();
        for ((group, rest), is_free) in self.groups.iter().zip(&group_rhs).zip(&free.groups) {
            if *is_free {
                rhs -= group.coupling * (*rest / group.diagonal);
            }
        }
        let covariance = inverse_over(&self.reduced(free), |joint| free.joints[joint], 0.0)?;
        let step = covariance * rhs;
        let mut follow = Vec::with_capacity(groups.len());
        for (index, group) in self.groups.iter().enumerate() {
            if free.groups[index] {
                groups[index] = (group_rhs[index] - group.coupling.dot(&step)) / group.diagonal;
                follow.push((-group.coupling / group.diagonal, 1.0 / group.diagonal));
            } else {
                follow.push((SVector::zeros(), 0.0));
            }
        }
        Some(Solution { joints: joints + step, groups, covariance, follow })
    }
}

impl<const N: usize> Solution<N> {
    /// The compliances in a configuration of a group. rad/(N m)
    pub fn compliances(&self, varying: Option<usize>, group: Option<usize>) -> SVector<f64, N> {
        let mut compliances = self.joints;
        if let (Some(joint), Some(group)) = (varying, group) {
            compliances[joint] = self.groups[group];
        }
        compliances
    }

    /// Their covariance, for equations of unit variance.
    pub fn covariance(&self, varying: Option<usize>, group: Option<usize>) -> SMatrix<f64, N, N> {
        let mut covariance = self.covariance;
        if let (Some(joint), Some(group)) = (varying, group) {
            let (follow, own) = &self.follow[group];
            let cross = self.covariance * follow;
            covariance.set_column(joint, &cross);
            covariance.set_row(joint, &cross.transpose());
            covariance[(joint, joint)] = follow.dot(&cross) + own;
        }
        covariance
    }
}
