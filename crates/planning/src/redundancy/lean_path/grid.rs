//! The leans that are planned on, and which may follow each other.

use super::super::rate_limit::BetaChange;
use crate::lean::LeanSpace;
use crate::problem::Problem;
use crate::setup::Setup;
use nalgebra::Matrix3;
use stead_model::task::lean::Lean;

/// The leans that the tool may have along a path: of each number one for every point, or none there.
#[derive(Debug, Clone)]
pub struct LeanGrid<'a> {
    /// The problem, in a setup that says where part and external axes stand.
    pub(super) problem: &'a Problem,
    space: &'a LeanSpace,
    pub(super) leans: Vec<Vec<Option<Lean>>>,
}

/// A lean at the point before, and how beta may change from there.
pub(super) type Before = (u16, BetaChange);

impl<'a> LeanGrid<'a> {
    /// All that the tool may do in a problem, in the steps of its [`LeanSpace`]; none where it may not lean.
    pub fn new(problem: &'a Problem) -> Option<Self> {
        let space = problem.lean.as_deref()?;
        let half = space.half_counts();
        let rows: Vec<Vec<Lean>> = (0..space.ranges.len()).map(|point| space.grid(point, half)).collect();
        Some(Self::of_rows(problem, space, rows))
    }

    /// What is near to given leans: with up to `half` steps of lead and of tilt (rad) to either side.
    pub fn near(problem: &'a Problem, leans: &[Lean], steps: [f64; 2], half: i32) -> Option<Self> {
        let space = problem.lean.as_deref()?;
        let around = |(point, lean): (usize, &Lean)| -> Vec<Lean> {
            let at = |l: i32, t: i32| Lean {
                lead: lean.lead + steps[0] * f64::from(l),
                tilt: lean.tilt + steps[1] * f64::from(t),
            };
            // The lean itself first, so that of equally good ones it stays.
            let mut all: Vec<(i32, i32)> = (-half..=half).flat_map(|l| (-half..=half).map(move |t| (l, t))).collect();
            all.sort_by_key(|(l, t)| l.abs() + t.abs());
            all.into_iter().map(|(l, t)| space.ranges[point].nearest(&at(l, t))).collect()
        };
        Some(Self::of_rows(problem, space, leans.iter().enumerate().map(around).collect()))
    }

    fn of_rows(problem: &'a Problem, space: &'a LeanSpace, rows: Vec<Vec<Lean>>) -> Self {
        let path = problem.task.upright().path();
        let count = rows.first().map_or(0, Vec::len);
        let at = |number: usize, point: usize| {
            let lean = rows[point][number];
            let is_new = !rows[point][..number].contains(&lean);
            (is_new && space.allows(path, point, &lean)).then_some(lean)
        };
        let leans = (0..count).map(|number| (0..rows.len()).map(|point| at(number, point)).collect()).collect();
        Self { problem, space, leans }
    }

    /// The problem with the tool in the lean of one number at every point, and upright where there is none.
    fn problem_at(&self, number: usize) -> Problem {
        let leans = self.leans[number].iter().map(|lean| lean.unwrap_or(Lean::NONE)).collect();
        let setup = Setup { leans, ..self.problem.setup.clone() };
        self.problem.in_setup(&setup).into_owned()
    }

    /// The problems of all leans, planned together by a [`LeanPlanner`](super::LeanPlanner).
    pub fn problems(&self) -> Vec<Problem> {
        (0..self.leans.len()).map(|number| self.problem_at(number)).collect()
    }
}

/// For each lean at a point those at the point before it from which the tool may come, with the changes of beta.
pub(super) fn steps_to(grid: &LeanGrid<'_>, point: usize) -> Vec<Vec<Before>> {
    let (problem, space) = (grid.problem, grid.space);
    let path = problem.task.upright().path();
    let at = |point: usize| {
        let frame = |leans: &Vec<Option<Lean>>| {
            let lean = leans[point]?;
            let normal = path.surface_normals().map(|normals| &normals[point]);
            Some((lean, space.rule.leaned(&path.points()[point], normal, &lean).workpiece_from_point()))
        };
        grid.leans.iter().map(frame).collect::<Vec<Option<(Lean, Matrix3<f64>)>>>()
    };
    let [before, now] = [at(point - 1), at(point)];
    let limits = &problem.redundancy;
    let to = |state: &Option<(Lean, Matrix3<f64>)>| {
        let Some((lean, axes)) = state else { return Vec::new() };
        let mut all: Vec<(f64, Before)> = Vec::new();
        for (number, known) in before.iter().enumerate() {
            let Some((old, old_axes)) = known.as_ref().filter(|known| space.allows_step(path, point, [&known.0, lean]))
            else {
                continue;
            };
            let change = BetaChange::of(problem.beta_step_between(point, limits, [old_axes, axes]), limits);
            if !change.is_none() {
                all.push((apart(old, lean), (number as u16, change)));
            }
        }
        // Of equally cheap ones the first is taken: that in which the axis turns least.
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.0.cmp(&b.1.0)));
        all.into_iter().map(|(_, before)| before).collect()
    };
    now.iter().map(to).collect()
}

/// How far two leans are apart: the sum of the differences of lead and tilt. rad
fn apart(a: &Lean, b: &Lean) -> f64 {
    (a.lead - b.lead).abs() + (a.tilt - b.tilt).abs()
}
