//! How everything that the subproblem needs changes with lead and tilt: differences between the tool as it leans and
//! leaning a little otherwise, beta counting from the feed as it is seen from each of these axes.

use super::LOCAL;
use super::differentiated::{Differentiated, DifferentiatedSet, Followed, PointState, gradient};
use nalgebra::{Matrix2, Matrix5, SMatrix, SymmetricEigen};
use stead_model::task::ToolPath;
use stead_model::task::lean::Lean;
use stead_numerics::scalar::Dual;
use stead_problem::lean::LeanSpace;
use stead_problem::problem::Problem;
use stead_problem::setup::Setup;

/// How far the leans are apart whose difference is the slope. rad
const STEP: f64 = 5e-4;
/// Lead and tilt of the neighbours, in steps: ahead and behind in each, and one in both.
const NEIGHBOURS: [[f64; 2]; 5] = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 1.0]];

/// Second derivatives by placement, beta, lead and tilt.
pub type Curvature7 = SMatrix<f64, 7, 7>;

/// A problem with its tool leaning a little otherwise at every point.
pub(super) struct LeanNeighbours {
    problems: [Problem; 5],
}

/// The changes of a path point with lead and tilt (rad).
#[derive(Debug, Clone, PartialEq)]
pub struct LeanSlopes {
    /// Of the joint angles. rad
    pub joints: [[f64; 2]; 6],
    /// Of 1/kappa_F.
    pub inverse_condition: [f64; 2],
    /// Of the distance from axis 1. m
    pub base_distance: [f64; 2],
    /// Under every set of compliances.
    pub sets: Vec<SetLeanSlopes>,
    /// Curvature of the score in all variables, as [`Local::curvature`](super::linearise::Local::curvature).
    pub curvature: Curvature7,
}

/// The changes of what is scored under one set of compliances.
#[derive(Debug, Clone, PartialEq)]
pub struct SetLeanSlopes {
    /// Of the scored part. m
    pub scored: [f64; 2],
    /// Of what the score adds to it, but for a margin near its kink. m
    pub added: [f64; 2],
    /// Of the changes of the margin, and of the parts, that have their kink near. m
    pub kinked: [Vec<[f64; 2]>; 2],
}

impl LeanNeighbours {
    /// Of a problem whose tool leans; none where it does not.
    pub fn of(problem: &Problem) -> Option<Self> {
        let leans = Some(&problem.setup.leans).filter(|leans| !leans.is_empty() && problem.lean.is_some())?;
        let at = |[lead, tilt]: [f64; 2]| {
            let moved = |lean: &Lean| Lean { lead: lean.lead + STEP * lead, tilt: lean.tilt + STEP * tilt };
            let setup = Setup { leans: leans.iter().map(moved).collect(), ..problem.setup.clone() };
            problem.in_setup(&setup).into_owned()
        };
        Some(Self { problems: NEIGHBOURS.map(at) })
    }

    /// The slopes at a state, of which vectors whose kink is not near are left out here; none where a neighbour is out
    /// of reach.
    pub fn slopes(
        &self,
        state: PointState,
        followed: &Followed,
        centre: &Differentiated,
        raw: Option<&Matrix5<f64>>,
    ) -> Option<LeanSlopes> {
        let there: Vec<Differentiated> =
            self.problems.iter().map(|problem| gradient(problem, state)).collect::<Option<_>>()?;
        let slope =
            |of: &dyn Fn(&Differentiated) -> f64| [0, 2].map(|k| (of(&there[k]) - of(&there[k + 1])) / (2.0 * STEP));
        let entries = |set: usize, of: &dyn Fn(&DifferentiatedSet) -> &Vec<Dual<LOCAL>>| {
            (0..of(&centre.sets[set]).len())
                .map(|k| slope(&|one| of(&one.sets[set]).get(k).map_or(0.0, |entry| entry.value)))
                .collect()
        };
        let set = |set: usize| {
            let is_margin = !centre.sets[set].changes.is_empty();
            let added = |one: &Differentiated| {
                let score = &one.sets[set].score;
                score.uncertainty.value + if is_margin { 0.0 } else { score.margin.value }
            };
            SetLeanSlopes {
                scored: slope(&|one| one.sets[set].score.scored.value),
                added: slope(&added),
                kinked: [entries(set, &|of| &of.changes), entries(set, &|of| &of.parts)],
            }
        };
        Some(LeanSlopes {
            joints: std::array::from_fn(|j| {
                // The short way around, where a joint passes half a turn.
                [0, 2].map(|k| {
                    let by = there[k].state.joints[j].value - there[k + 1].state.joints[j].value;
                    stead_model::robot::angles::wrap(by) / (2.0 * STEP)
                })
            }),
            inverse_condition: slope(&|one| one.state.inverse_condition.value),
            base_distance: slope(&|one| one.state.base_distance.value),
            sets: (0..centre.sets.len()).map(set).collect(),
            curvature: raw.map_or_else(Curvature7::zeros, |raw| curvature(followed, centre, &there, raw)),
        })
    }

    /// The problems with a step (rad) more in lead and in tilt.
    pub fn ahead(&self) -> ([&Problem; 2], f64) {
        ([&self.problems[0], &self.problems[2]], STEP)
    }
}

/// Second derivatives in all variables without their negative part: those by placement and beta as they are known,
/// those with lead and tilt by differences of slopes and of values.
fn curvature(followed: &Followed, centre: &Differentiated, there: &[Differentiated], raw: &Matrix5<f64>) -> Curvature7 {
    let mut hessian = Curvature7::zeros();
    hessian.fixed_view_mut::<5, 5>(0, 0).copy_from(raw);
    for (lean, ends) in [[0, 1], [2, 3]].into_iter().enumerate() {
        for k in 0..LOCAL {
            let [ahead, behind] = ends.map(|end| followed.slope(&there[end], k));
            hessian[(k, LOCAL + lean)] = (ahead - behind) / (2.0 * STEP);
            hessian[(LOCAL + lean, k)] = hessian[(k, LOCAL + lean)];
        }
    }
    let value = |one: &Differentiated| followed.value(one);
    let here = value(centre);
    let [lead, back, tilt, other, both] = [0, 1, 2, 3, 4].map(|k| value(&there[k]));
    let mixed = (both - lead - tilt + here) / (STEP * STEP);
    let own = Matrix2::new(lead + back - 2.0 * here, 0.0, 0.0, tilt + other - 2.0 * here) / (STEP * STEP);
    hessian.fixed_view_mut::<2, 2>(5, 5).copy_from(&(own + Matrix2::new(0.0, mixed, mixed, 0.0)));
    let eigen = SymmetricEigen::new(hessian);
    let positive = eigen.eigenvalues.map(|value| value.max(0.0));
    eigen.eigenvectors * Curvature7::from_diagonal(&positive) * eigen.eigenvectors.transpose()
}

/// How the tool leans at every point of a solution, moved by steps of lead and tilt (rad) as far as its limits at each
/// point allow; none where it may not turn so between two of them.
pub(super) fn moved_leans(problem: &Problem, steps: &[[f64; 2]]) -> Option<Vec<Lean>> {
    let space = problem.lean.as_deref()?;
    let path = problem.task.upright().path();
    let moved = |(point, (lean, step)): (usize, (&Lean, &[f64; 2]))| {
        let to = space.ranges[point].nearest(&Lean { lead: lean.lead + step[0], tilt: lean.tilt + step[1] });
        allowed_towards(space, path, point, lean, &to)
    };
    let leans: Vec<Lean> = problem.setup.leans.iter().zip(steps).enumerate().map(moved).collect::<Option<_>>()?;
    let mut steps = path.segments().iter().flat_map(|span| span.clone().skip(1));
    steps.all(|point| space.allows_step(path, point, [&leans[point - 1], &leans[point]])).then_some(leans)
}

/// A lean near one that is wanted, if that is not allowed: on the way to it from the axis of the path, or where that is
/// not allowed either, from the lean that is known. Along a limit that is curved a straight step leaves by its square.
fn allowed_towards(space: &LeanSpace, path: &ToolPath, point: usize, known: &Lean, to: &Lean) -> Option<Lean> {
    if space.allows(path, point, to) {
        return Some(*to);
    }
    let from = if space.allows(path, point, &Lean::NONE) { &Lean::NONE } else { known };
    let at = |share: f64| Lean {
        lead: from.lead + share * (to.lead - from.lead),
        tilt: from.tilt + share * (to.tilt - from.tilt),
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let half = (low + high) / 2.0;
        if space.allows(path, point, &at(half)) { low = half } else { high = half }
    }
    Some(at(low)).filter(|lean| space.allows(path, point, lean))
}

/// How often the way to a lean that is not allowed is halved.
const HALVINGS: usize = 40;
