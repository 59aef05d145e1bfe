//! How the tool may lean and where the external axes may be along a path, and what may follow what.

use super::super::rate_limit::BetaChange;
use super::Motion;
use nalgebra::Matrix3;
use stead_model::external_axis::ExternalAxis;
use stead_model::task::lean::Lean;
use stead_problem::lean::{LeanRange, LeanSpace};
use stead_problem::problem::Problem;
use stead_problem::setup::{AxisPositions, Setup};

/// How far beyond its speed an external axis may be, relative: rounding.
const SPEED_ROUNDING: f64 = 1e-9;

/// How the tool leans at a path point and where the external axes are there.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// From the axis that the path states.
    pub lean: Lean,
    /// Positions of the external axes, in their order. m or rad
    pub axes: Vec<f64>,
}

/// How far one setting is from the next.
#[derive(Debug, Clone, PartialEq)]
pub struct SettingSteps {
    /// In lead and in tilt; zero where they stay. rad
    pub lean: [f64; 2],
    /// Of each external axis; zero where it stays. m or rad
    pub axes: Vec<f64>,
}

impl SettingSteps {
    /// Shorter by a factor.
    pub fn divided(&self, by: f64) -> Self {
        Self { lean: self.lean.map(|step| step / by), axes: self.axes.iter().map(|step| step / by).collect() }
    }
}

/// The settings that are planned on along a path: of each number one for every point, or none there.
#[derive(Debug, Clone)]
pub struct MotionGrid<'a> {
    /// The problem, with the axis that the path states.
    pub(super) problem: &'a Problem,
    /// Where the tool may lean.
    pub(super) space: Option<&'a LeanSpace>,
    pub(super) settings: Vec<Vec<Option<Setting>>>,
}

/// A setting at the point before, and how beta may change from there.
pub(super) type Before = (u16, BetaChange);

impl<'a> MotionGrid<'a> {
    /// All that the tool may do in a problem, in the steps of its [`LeanSpace`], the external axes as they are; none
    /// where it may not lean.
    pub fn new(problem: &'a Problem) -> Option<Self> {
        let half = problem.lean.as_deref()?.half_counts();
        Some(Self::product(problem, Some(half), &[]))
    }

    /// Every lean, so many steps of lead and tilt to either side, or the axis of the path alone, with all positions of
    /// the external axes of some numbers, the others as they are.
    pub fn product(problem: &'a Problem, half: Option<[usize; 2]>, axes: &[(usize, Vec<f64>)]) -> Self {
        let leaning = problem.lean.as_deref().zip(half);
        let of_point = |(point, own): (usize, Vec<f64>)| {
            let leans = leaning.map_or_else(|| vec![Lean::NONE], |(space, half)| space.grid(point, half));
            settings_of(&leans, &rows_with(own, axes))
        };
        let all = problem.setup.positions.spread(&problem.task).into_iter().enumerate();
        Self::of_rows(problem, leaning.map(|(space, _)| space), all.map(of_point).collect())
    }

    /// All positions of the external axes of some numbers, the others and the leans as in a known motion.
    pub fn of_axes(problem: &'a Problem, known: &Motion, axes: &[(usize, Vec<f64>)]) -> Self {
        let of_point = |(point, own): (usize, &Vec<f64>)| {
            let lean = known.leans.get(point).copied().unwrap_or(Lean::NONE);
            settings_of(&[lean], &rows_with(own.clone(), axes))
        };
        let space = problem.lean.as_deref().filter(|_| !known.leans.is_empty());
        Self::of_rows(problem, space, known.axes.iter().enumerate().map(of_point).collect())
    }

    /// What is near to a known motion: with up to `half` steps to either side. A motion without leans keeps the axis of
    /// the path.
    pub fn near(problem: &'a Problem, known: &Motion, steps: &SettingSteps, half: i32) -> Self {
        let space = problem.lean.as_deref().filter(|_| !known.leans.is_empty());
        let around = |(point, own): (usize, &Vec<f64>)| {
            let mut rows = vec![own.clone()];
            for (number, (axis, step)) in problem.external_axes.iter().zip(&steps.axes).enumerate() {
                if *step > 0.0 {
                    rows = rows.iter().flat_map(|row| beside(row, number, axis, *step, half)).collect();
                }
            }
            let leans = space.map_or_else(
                || vec![Lean::NONE],
                |space| leans_beside(&space.ranges[point], &known.leans[point], steps.lean, half),
            );
            settings_of(&leans, &rows)
        };
        Self::of_rows(problem, space, known.axes.iter().enumerate().map(around).collect())
    }

    /// What is near to given leans, the external axes as they are: with up to `half` steps of lead and of tilt (rad) to
    /// either side.
    pub fn near_leans(problem: &'a Problem, leans: &[Lean], steps: [f64; 2], half: i32) -> Self {
        let known = Motion { leans: leans.to_vec(), axes: problem.setup.positions.spread(&problem.task) };
        Self::near(problem, &known, &SettingSteps { lean: steps, axes: Vec::new() }, half)
    }

    fn of_rows(problem: &'a Problem, space: Option<&'a LeanSpace>, rows: Vec<Vec<Setting>>) -> Self {
        let path = problem.task.upright().path();
        let count = rows.first().map_or(0, Vec::len);
        let at = |number: usize, point: usize| {
            let setting = &rows[point][number];
            let is_new = !rows[point][..number].contains(setting);
            let is_allowed = || space.is_none_or(|space| space.allows(path, point, &setting.lean));
            (is_new && is_allowed()).then(|| setting.clone())
        };
        let settings = (0..count).map(|number| (0..rows.len()).map(|point| at(number, point)).collect()).collect();
        Self { problem, space, settings }
    }

    /// How many settings a point has at the most.
    pub fn count(&self) -> usize {
        self.settings.len()
    }

    /// The problem with the setting of one number at every point, and as it is where there is none.
    fn problem_at(&self, number: usize) -> Problem {
        let rows = self.problem.setup.positions.spread(&self.problem.task);
        let settings = self.settings[number].iter();
        let leans = settings.clone().map(|setting| setting.as_ref().map_or(Lean::NONE, |setting| setting.lean));
        let rows =
            settings.zip(rows).map(|(setting, row)| setting.as_ref().map_or(row, |setting| setting.axes.clone()));
        let setup = Setup {
            positions: AxisPositions::shortest(rows.collect(), &self.problem.task),
            leans: if self.space.is_some() { leans.collect() } else { [].into() },
            ..self.problem.setup.clone()
        };
        self.problem.in_setup(&setup).into_owned()
    }

    /// The problems of all settings, planned together by a [`MotionPlanner`](super::MotionPlanner).
    pub fn problems(&self) -> Vec<Problem> {
        (0..self.settings.len()).map(|number| self.problem_at(number)).collect()
    }

    /// Whether the external axes get from one setting to another on the way to a point.
    fn axes_reach(&self, point: usize, from: &Setting, to: &Setting) -> bool {
        let time = self.problem.step_time(point) * (1.0 + SPEED_ROUNDING);
        let reaches = |(axis, (from, to)): (&ExternalAxis, (&f64, &f64))| {
            from == to || (to - from).abs() <= axis.max_speed.unwrap_or(f64::INFINITY) * time
        };
        self.problem.external_axes.iter().zip(from.axes.iter().zip(&to.axes)).all(reaches)
    }
}

/// A row of positions with all those of some axes.
fn rows_with(own: Vec<f64>, axes: &[(usize, Vec<f64>)]) -> Vec<Vec<f64>> {
    axes.iter().fold(vec![own], |rows, (number, positions)| {
        let at = |row: &Vec<f64>, position: &f64| {
            let mut row = row.clone();
            row[*number] = *position;
            row
        };
        rows.iter().flat_map(|row| positions.iter().map(move |position| at(row, position))).collect()
    })
}

/// Every lean with every row of positions.
fn settings_of(leans: &[Lean], rows: &[Vec<f64>]) -> Vec<Setting> {
    leans.iter().flat_map(|lean| rows.iter().map(|axes| Setting { lean: *lean, axes: axes.clone() })).collect()
}

/// Steps to either side, the known place first, so that of equally good ones it stays.
fn sides(half: i32) -> Vec<i32> {
    let mut all: Vec<i32> = (-half..=half).collect();
    all.sort_by_key(|k| k.abs());
    all
}

/// A row of positions with one of them moved, as far as the range of the axis allows.
fn beside(row: &[f64], number: usize, axis: &ExternalAxis, step: f64, half: i32) -> Vec<Vec<f64>> {
    let moved = |k: i32| {
        let mut row = row.to_vec();
        if k != 0 {
            row[number] = (row[number] + step * f64::from(k)).max(axis.min).min(axis.max);
        }
        row
    };
    sides(half).into_iter().map(moved).collect()
}

/// A lean with those beside it.
fn leans_beside(range: &LeanRange, lean: &Lean, steps: [f64; 2], half: i32) -> Vec<Lean> {
    if steps == [0.0; 2] {
        return vec![*lean];
    }
    let mut all: Vec<(i32, i32)> = (-half..=half).flat_map(|l| (-half..=half).map(move |t| (l, t))).collect();
    all.sort_by_key(|(l, t)| l.abs() + t.abs());
    let at = |(l, t): (i32, i32)| Lean {
        lead: lean.lead + steps[0] * f64::from(l),
        tilt: lean.tilt + steps[1] * f64::from(t),
    };
    all.into_iter().map(|beside| range.nearest(&at(beside))).collect()
}

/// For each setting at a point those at the point before it from which the cell may come, with the changes of beta.
pub(super) fn steps_to(grid: &MotionGrid<'_>, point: usize) -> Vec<Vec<Before>> {
    let (problem, space) = (grid.problem, grid.space);
    let path = problem.task.upright().path();
    let at = |point: usize| {
        let frame = |settings: &Vec<Option<Setting>>| {
            let setting = settings[point].clone()?;
            let normal = path.surface_normals().map(|normals| &normals[point]);
            let at = &path.points()[point];
            let frame = space.map_or(*at, |space| space.rule.leaned(at, normal, &setting.lean)).workpiece_from_point();
            Some((setting, frame))
        };
        grid.settings.iter().map(frame).collect::<Vec<Option<(Setting, Matrix3<f64>)>>>()
    };
    let [before, now] = [at(point - 1), at(point)];
    let limits = &problem.redundancy;
    let to = |state: &Option<(Setting, Matrix3<f64>)>| {
        let Some((setting, axes)) = state else { return Vec::new() };
        let mut all: Vec<(f64, Before)> = Vec::new();
        for (number, known) in before.iter().enumerate() {
            let Some((old, old_axes)) = known.as_ref().filter(|(old, _)| {
                grid.axes_reach(point, old, setting)
                    && space.is_none_or(|space| space.allows_step(path, point, [&old.lean, &setting.lean]))
            }) else {
                continue;
            };
            let part = problem.part_turn_between(&old.axes, &setting.axes);
            let step = problem.beta_step_between(point, limits, [old_axes, axes], part.as_ref());
            let change = BetaChange::of(step, limits);
            if !change.is_none() {
                all.push((apart(old, setting), (number as u16, change)));
            }
        }
        // Of equally cheap ones the first is taken: that in which axis and axes turn least.
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.0.cmp(&b.1.0)));
        all.into_iter().map(|(_, before)| before).collect()
    };
    now.iter().map(to).collect()
}

/// How far two settings are apart: the sum of the differences of lead, tilt and the positions of the axes. rad, m
fn apart(a: &Setting, b: &Setting) -> f64 {
    let axes: f64 = a.axes.iter().zip(&b.axes).map(|(a, b)| (a - b).abs()).sum();
    (a.lean.lead - b.lean.lead).abs() + (a.lean.tilt - b.lean.tilt).abs() + axes
}
