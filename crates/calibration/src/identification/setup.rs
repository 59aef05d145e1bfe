//! Pose of the tracker and positions of the reference points, from the unloaded readings alone.
//!
//! Reading i of point p in configuration j is `R (R_j p_i + o_j) + t`, with the flange at (R_j, o_j) by the forward
//! kinematics and the tracker at (R, t). Given R it is linear in t and the points: their least-squares estimate is the
//! mean of `R_j^T dp` (Klimchik et al. 2017, eq. 24, where `D^T D` is the identity). Here R is sought along with them:
//! Gauss-Newton with steps halved until they help, to the least sum of squares over all of them.

use super::sheet::Sheet;
use nalgebra::{DMatrix, DVector, Matrix3, SymmetricEigen, Vector3};
use serde::Serialize;
use stead_model::robot::Pose;
use stead_numerics::rotation::rotation_from_vector;

/// Pose of the tracker and positions of the reference points.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Setup {
    /// The robot base in the tracker's frame.
    pub tracker_from_base: Pose<f64>,
    /// The reference points in the flange frame, as [`Sheet::points`]. m
    pub points: Vec<Vector3<f64>>,
    /// Root of the mean square distance of the unloaded readings from where kinematics puts their points. m
    pub residual_rms: f64,
}

/// Why base transform and reference points are not identifiable.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// Fewer equations than unknowns.
    #[error(
        "{equations} unloaded coordinates do not determine the {unknowns} unknowns of base transform and reference points"
    )]
    TooFew {
        /// Coordinates read without load.
        equations: usize,
        /// Six for the base transform, three for each point.
        unknowns: usize,
    },
    /// The configurations are too much alike.
    #[error("base transform and reference points are not identifiable separately from the unloaded readings")]
    Unidentifiable,
    /// The readings are not where any tracker and reference points would put them.
    #[error(
        "the unloaded readings are {off_mm:.3} mm (rms) away from where the joint angles put their points, this one \
         {worst_mm:.3} mm, while the flange moves over {moved_mm:.3} mm"
    )]
    Misfit {
        /// Root of the mean square distance. mm
        off_mm: f64,
        /// Line of the farthest reading, from 1.
        line: usize,
        /// Its distance. mm
        worst_mm: f64,
        /// Spread of the flange. mm
        moved_mm: f64,
    },
    /// The readings spread over another length than the flange does.
    #[error(
        "the unloaded readings spread over {read_mm:.3} mm (rms) while the flange, by its joint angles, moves over \
         {moved_mm:.3} mm"
    )]
    Scale {
        /// Spread of the readings of one point. mm
        read_mm: f64,
        /// Spread of the flange. mm
        moved_mm: f64,
    },
}

/// How well base transform and reference points fit the unloaded readings, and how well those determine them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SetupFit {
    /// The reading farthest from where kinematics puts its point: line of the sheet from 1, distance in m.
    pub worst: (usize, f64),
    /// Root of the mean square distance of all others. m
    pub others_rms: f64,
    /// Root of the mean square distance of the flange from its mean place. m
    pub flange_rms: f64,
    /// For each reference point the standard deviation of its place on the flange, in the direction in which it is
    /// largest, with the residuals taken for noise. m
    pub point_deviations: Vec<f64>,
    /// Standard deviation of a coordinate by the residuals, which it is at most: they have the errors of the kinematics
    /// too. m
    pub noise: f64,
    /// Coordinates less unknowns.
    pub degrees: usize,
}

/// Configurations that a start is sought from; more would not make it better.
const START: usize = 60;
/// Readings and flange may spread over lengths that differ by this factor: a reference point turns about the flange
/// too.
const SPREAD: f64 = 30.0;
/// Unloaded readings that are farther off than this share of the flange's spread do not belong to the joint angles.
const MISFIT: f64 = 0.02;
/// Below this part of the largest, an eigenvalue of the scaled normal matrix counts as zero.
const SINGULAR: f64 = 1e-11;
/// More steps than this are not needed where there is a minimum at all.
const STEPS: usize = 60;

/// Estimates base transform and reference points from the unloaded readings for which `kept` holds.
///
/// `flanges` are the poses of the flange in the base frame, one for each configuration. Without a `start` for
/// the rotation of `tracker_from_base` the best of 24 orientations all round is taken.
///
/// # Errors
/// [`SetupError`] when the readings do not determine them.
pub fn estimate(
    sheet: &Sheet,
    flanges: &[Pose<f64>],
    kept: &[bool],
    start: Option<&Matrix3<f64>>,
) -> Result<Setup, SetupError> {
    let all: Vec<usize> = (0..sheet.readings.len()).filter(|index| kept[*index]).collect();
    let unknowns = 6 + 3 * sheet.points.len();
    if 3 * all.len() < unknowns {
        return Err(SetupError::TooFew { equations: 3 * all.len(), unknowns });
    }
    let whole = SetupProblem::new(sheet, flanges, &all);
    whole.check_spread()?;
    let stride = sheet.configurations.len().div_ceil(START);
    let few: Vec<usize> =
        all.iter().copied().filter(|i| sheet.readings[*i].configuration.is_multiple_of(stride)).collect();
    let sample = SetupProblem::new(sheet, flanges, &few);
    let rotations = start.map_or_else(cube_rotations, |rotation| vec![*rotation]);
    let mut best: Option<(f64, Unknowns)> = None;
    for rotation in rotations {
        let found = sample.descend(sample.state_at(rotation));
        if best.as_ref().is_none_or(|(cost, _)| found.0 < *cost) {
            best = Some(found);
        }
    }
    let (_, iterate) = best.ok_or(SetupError::Unidentifiable)?;
    let (cost, iterate) = whole.descend(iterate);
    if whole.step(&iterate).is_none() {
        return Err(SetupError::Unidentifiable);
    }
    let translation = iterate.shift + whole.read_centre - iterate.rotation * whole.flange_centre;
    Ok(Setup {
        tracker_from_base: Pose { rotation: iterate.rotation, translation },
        points: iterate.points,
        residual_rms: libm::sqrt(cost / all.len() as f64),
    })
}

/// How well a setup fits the unloaded readings for which `used` holds.
///
/// # Errors
/// [`SetupError::Misfit`] where it does not: joint angles, zero positions, axes or units are others than the robot
/// file's.
pub fn check(sheet: &Sheet, flanges: &[Pose<f64>], used: &[bool], setup: &Setup) -> Result<SetupFit, SetupError> {
    let all: Vec<usize> = (0..sheet.readings.len()).filter(|index| used[*index]).collect();
    let whole = SetupProblem::new(sheet, flanges, &all);
    let Pose { rotation, translation } = setup.tracker_from_base;
    let shift = translation - whole.read_centre + rotation * whole.flange_centre;
    let iterate = Unknowns { rotation, shift, points: setup.points.clone() };
    let squares: Vec<f64> = whole.rows.iter().map(|row| whole.residual(&iterate, row).norm_squared()).collect();
    let sum: f64 = squares.iter().sum();
    let mean = |sum: f64, count: usize| libm::sqrt(sum.max(0.0) / count.max(1) as f64);
    let flange_rms = mean(whole.rows.iter().map(|row| row.origin.norm_squared()).sum(), all.len());
    let farthest =
        (0..all.len()).max_by(|a, b| squares[*a].total_cmp(&squares[*b])).ok_or(SetupError::Unidentifiable)?;
    let worst = (sheet.readings[all[farthest]].line, libm::sqrt(squares[farthest]));
    let off = mean(sum, all.len());
    if off > MISFIT * flange_rms {
        let [off_mm, worst_mm, moved_mm] = [off, worst.1, flange_rms].map(|length| length * 1e3);
        return Err(SetupError::Misfit { off_mm, line: worst.0, worst_mm, moved_mm });
    }
    let degrees = (3 * all.len()).saturating_sub(6 + 3 * sheet.points.len());
    let variance = if degrees > 0 { sum / degrees as f64 } else { 0.0 };
    let (matrix, _) = whole.equations(&iterate);
    let inverse = Scaled::new(&matrix).ok_or(SetupError::Unidentifiable)?.inverse();
    let deviation = |point: usize| {
        let own: Matrix3<f64> = inverse.fixed_view::<3, 3>(6 + 3 * point, 6 + 3 * point).into_owned();
        libm::sqrt((own.symmetric_eigenvalues().max() * variance).max(0.0))
    };
    let point_deviations = (0..sheet.points.len()).map(deviation).collect();
    let others_rms = mean(sum - squares[farthest], all.len() - 1);
    Ok(SetupFit { worst, others_rms, flange_rms, point_deviations, noise: libm::sqrt(variance), degrees })
}

/// The unknowns. Readings and flange origins count from their centres, so that `shift` and `rotation` are hardly
/// coupled.
#[derive(Debug, Clone)]
struct Unknowns {
    rotation: Matrix3<f64>,
    shift: Vector3<f64>,
    points: Vec<Vector3<f64>>,
}

struct Row {
    rotation: Matrix3<f64>,
    origin: Vector3<f64>,
    read: Vector3<f64>,
    point: usize,
}

struct SetupProblem {
    rows: Vec<Row>,
    points: usize,
    read_centre: Vector3<f64>,
    flange_centre: Vector3<f64>,
}

/// A normal matrix that is regular after scaling its diagonal to one.
struct Scaled {
    scale: DVector<f64>,
    eigen: SymmetricEigen<f64, nalgebra::Dyn>,
}

impl Scaled {
    fn new(matrix: &DMatrix<f64>) -> Option<Self> {
        let scale = matrix.diagonal().map(|value| if value > 0.0 { 1.0 / libm::sqrt(value) } else { 0.0 });
        let eigen = SymmetricEigen::new(DMatrix::from_fn(scale.len(), scale.len(), |i, j| {
            matrix[(i, j)] * scale[i] * scale[j]
        }));
        (eigen.eigenvalues.min() > SINGULAR * eigen.eigenvalues.max()).then_some(Self { scale, eigen })
    }

    fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        let along = self.eigen.eigenvectors.transpose() * right.component_mul(&self.scale);
        let solved = &self.eigen.eigenvectors * along.component_div(&self.eigen.eigenvalues);
        solved.component_mul(&self.scale)
    }

    fn inverse(&self) -> DMatrix<f64> {
        let size = self.scale.len();
        let vectors = &self.eigen.eigenvectors;
        let entry = |i: usize, j: usize| -> f64 {
            let terms = (0..size).map(|k| vectors[(i, k)] * vectors[(j, k)] / self.eigen.eigenvalues[k]);
            terms.sum::<f64>() * self.scale[i] * self.scale[j]
        };
        DMatrix::from_fn(size, size, entry)
    }
}

impl SetupProblem {
    fn new(sheet: &Sheet, flanges: &[Pose<f64>], readings: &[usize]) -> Self {
        let count = readings.len().max(1) as f64;
        let flange = |index: &usize| &flanges[sheet.readings[*index].configuration];
        let read_centre = readings.iter().map(|i| sheet.readings[*i].unloaded).sum::<Vector3<f64>>() / count;
        let flange_centre = readings.iter().map(|i| flange(i).translation).sum::<Vector3<f64>>() / count;
        let row = |index: &usize| Row {
            rotation: flange(index).rotation,
            origin: flange(index).translation - flange_centre,
            read: sheet.readings[*index].unloaded - read_centre,
            point: sheet.readings[*index].point,
        };
        Self { rows: readings.iter().map(row).collect(), points: sheet.points.len(), read_centre, flange_centre }
    }

    fn check_spread(&self) -> Result<(), SetupError> {
        let rms = |sum: f64| libm::sqrt(sum / self.rows.len() as f64);
        let read = rms(self.rows.iter().map(|row| row.read.norm_squared()).sum());
        let moved = rms(self.rows.iter().map(|row| row.origin.norm_squared()).sum());
        if read * SPREAD < moved || read > moved.max(0.1) * SPREAD {
            return Err(SetupError::Scale { read_mm: read * 1e3, moved_mm: moved * 1e3 });
        }
        Ok(())
    }

    fn state_at(&self, rotation: Matrix3<f64>) -> Unknowns {
        Unknowns { rotation, shift: Vector3::zeros(), points: vec![Vector3::zeros(); self.points] }
    }

    fn residual(&self, iterate: &Unknowns, row: &Row) -> Vector3<f64> {
        row.read - iterate.rotation * (row.rotation * iterate.points[row.point] + row.origin) - iterate.shift
    }

    fn cost(&self, iterate: &Unknowns) -> f64 {
        self.rows.iter().map(|row| self.residual(iterate, row).norm_squared()).sum()
    }

    /// Normal matrix and gradient. Unknowns in order: turn of the rotation from the left, shift, points.
    fn equations(&self, iterate: &Unknowns) -> (DMatrix<f64>, DVector<f64>) {
        let size = 6 + 3 * self.points;
        let mut matrix = DMatrix::<f64>::zeros(size, size);
        let mut gradient = DVector::<f64>::zeros(size);
        for row in &self.rows {
            let residual = self.residual(iterate, row);
            let turned = iterate.rotation * (row.rotation * iterate.points[row.point] + row.origin);
            let by_turn = -turned.cross_matrix();
            let by_point = iterate.rotation * row.rotation;
            let blocks = [(0, by_turn), (3, Matrix3::identity()), (6 + 3 * row.point, by_point)];
            for (i, left) in &blocks {
                let mut slot = gradient.fixed_rows_mut::<3>(*i);
                slot += left.transpose() * residual;
                for (j, right) in &blocks {
                    let mut slot = matrix.fixed_view_mut::<3, 3>(*i, *j);
                    slot += left.transpose() * right;
                }
            }
        }
        (matrix, gradient)
    }

    /// A Gauss-Newton step, where the normal matrix is regular.
    fn step(&self, iterate: &Unknowns) -> Option<DVector<f64>> {
        let (matrix, gradient) = self.equations(iterate);
        Scaled::new(&matrix).map(|scaled| scaled.solve(&gradient))
    }

    fn descend(&self, mut iterate: Unknowns) -> (f64, Unknowns) {
        let mut cost = self.cost(&iterate);
        for _ in 0..STEPS {
            let Some(step) = self.step(&iterate) else { break };
            let mut part = 1.0;
            let mut better = None;
            while part > 1e-3 {
                let trial = iterate.moved(&step, part);
                let trial_cost = self.cost(&trial);
                if trial_cost < cost {
                    better = Some((trial_cost, trial));
                    break;
                }
                part /= 2.0;
            }
            let Some((lower, next)) = better else { break };
            (cost, iterate) = (lower, next);
        }
        (cost, iterate)
    }
}

impl Unknowns {
    fn moved(&self, step: &DVector<f64>, part: f64) -> Self {
        let block = |at: usize| step.fixed_rows::<3>(at).into_owned() * part;
        Self {
            rotation: rotation_from_vector(&block(0)) * self.rotation,
            shift: self.shift + block(3),
            points: self.points.iter().enumerate().map(|(index, p)| p + block(6 + 3 * index)).collect(),
        }
    }
}

/// The 24 rotations of a cube: no rotation is further than 63 deg from one of them.
fn cube_rotations() -> Vec<Matrix3<f64>> {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let signed: Vec<Vector3<f64>> = axes.iter().flat_map(|axis| [*axis, -axis]).collect();
    let mut rotations = Vec::with_capacity(24);
    for x in &signed {
        for y in signed.iter().filter(|y| x.dot(y) == 0.0) {
            rotations.push(Matrix3::from_columns(&[*x, *y, x.cross(y)]));
        }
    }
    rotations
}
