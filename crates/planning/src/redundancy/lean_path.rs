//! A tool that leans along the path: dynamic programming over (beta, lead, tilt).
//!
//! A state of a path point is a grid value of beta, one of the leans that the point may have, and a posture class, with
//! joint angles modulo a turn. From one point to the next the axis may turn as far as the contact stays near its line
//! ([`LeanSpace::allows_step`]), beta as far as its limits allow between these two leans, and each joint by its step.
//! All states and all steps are looked at, so that what is found is the cheapest of its grid but for what flips and
//! turns of the wrist forbid. The plan itself is made afterwards, with the tool leaning along the way found here
//! ([`Setup::leans`]), so nothing of what is printed rests on this grid.
//!
//! Where something hits, the states of the points at which the plan hits are looked at, all of them, and the plan is
//! made again without those that hit, until it is free.

use super::state_set::kinds_left;
use super::transition::{self, advance};
use super::{BetaChange, Resolution, SegmentPlanner, StateSet};
use crate::evaluate::batch::StateGrid;
use crate::lean::LeanSpace;
use crate::problem::{Placement, Problem};
use crate::sense::Sense;
use crate::setup::Setup;
use nalgebra::Matrix3;
use rayon::prelude::*;
use std::ops::Range as Span;
use stead_cell::Proximity;
use stead_model::robot::{Posture, PostureClass};
use stead_model::task::lean::Lean;

/// The leans that the tool may have along a path: of each number one for every point, or none there.
#[derive(Debug, Clone)]
pub struct LeanGrid<'a> {
    /// The problem, in a setup that says where part and external axes stand.
    problem: &'a Problem,
    space: &'a LeanSpace,
    leans: Vec<Vec<Option<Lean>>>,
}

/// How the tool leans along the path.
#[derive(Debug, Clone, PartialEq)]
pub struct LeanPath {
    /// At every point.
    pub leans: Vec<Lean>,
    /// The objective, on the grid and with joint angles modulo a turn. m
    pub objective: f64,
    /// How often the path was planned until nothing hit.
    pub rounds: usize,
}

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

    /// The problems of all leans, which a [`LeanPlanner`] plans.
    pub fn problems(&self) -> Vec<Problem> {
        (0..self.leans.len()).map(|number| self.problem_at(number)).collect()
    }
}

/// A lean at the point before, and how beta may change from there.
type Before = (u16, BetaChange);

/// The planner of a [`LeanGrid`]: what does not change from one placement to the next.
#[derive(Debug, Clone)]
pub struct LeanPlanner<'a> {
    grid: &'a LeanGrid<'a>,
    /// For each number of a lean.
    planners: Vec<SegmentPlanner<'a>>,
    /// For every point and each lean the leans before it.
    before: Vec<Vec<Vec<Before>>>,
    /// How far states must be continued for the widest change of beta.
    pad: usize,
}

/// What one pass over a segment with one evaluator found.
struct LeanPass {
    /// For each class the smallest sum of costs with the lean and beta number at the end.
    ends: [Option<(f64, usize, usize)>; 4],
    /// For every point, class, lean and beta the lean and the beta number before.
    links: Vec<Link>,
}

/// A lean at the point before and the step of the beta number back to it.
#[derive(Debug, Clone, Copy, Default)]
struct Link {
    lean: u16,
    shift: i16,
}

/// The states at the points of a segment: of each point the number of its lean and that of its beta.
type Way = Vec<(usize, usize)>;

/// A way along a segment in a class.
#[derive(Clone)]
struct Found {
    evaluator: usize,
    class: PostureClass,
    cost: f64,
    way: Way,
}

impl<'a> LeanPlanner<'a> {
    /// Prepares the planning of the [problems](LeanGrid::problems) of a grid.
    pub fn new(grid: &'a LeanGrid<'a>, problems: &'a [Problem]) -> Self {
        let resolution = if grid.problem.task.path().is_thinned() { Resolution::Subset } else { Resolution::Search };
        let planners: Vec<SegmentPlanner<'a>> =
            problems.par_iter().map(|problem| SegmentPlanner::new(problem, problem.redundancy, resolution)).collect();
        let starts: Vec<usize> = grid.problem.task.segments().iter().map(|span| span.start).collect();
        let count = grid.problem.task.points().len();
        let before: Vec<Vec<Vec<Before>>> = (0..count)
            .into_par_iter()
            .map(|point| if starts.binary_search(&point).is_ok() { Vec::new() } else { steps_to(grid, point) })
            .collect();
        let changes = before.iter().flatten().flatten().map(|(_, change)| change.widest());
        let pad = changes.max().unwrap_or(0);
        Self { grid, planners, before, pad }
    }

    /// The cheapest way of the tool along the path at a placement; none where there is none.
    pub fn path(&self, placement: &Placement) -> Option<LeanPath> {
        let problem = self.grid.problem;
        if problem.placement_hit(placement).is_some() {
            return None;
        }
        let spans = problem.task.segments();
        let mut forbidden = vec![StateSet::default(); self.planners.len()];
        let mut looked_at = vec![[false; 4]; problem.task.points().len()];
        let mut found: Vec<Vec<Found>> =
            spans.iter().map(|span| self.segment(span, placement, &forbidden)).collect::<Option<_>>()?;
        for rounds in 1.. {
            let chosen = self.chosen(&found)?;
            let mut again = Vec::new();
            for (index, (span, way)) in spans.iter().zip(&chosen).enumerate() {
                if self.forbid_hits(span, placement, way, &mut looked_at, &mut forbidden) {
                    again.push(index);
                }
            }
            if again.is_empty() {
                let costs = chosen.iter().map(|way| way.cost);
                let lean = |(point, (number, _)): (usize, &(usize, usize))| {
                    self.grid.leans[*number][point].unwrap_or(Lean::NONE)
                };
                let leans = spans.iter().zip(&chosen).flat_map(|(span, found)| span.clone().zip(&found.way).map(lean));
                return Some(LeanPath { leans: leans.collect(), objective: problem.objective(costs), rounds });
            }
            for index in again {
                found[index] = self.segment(&spans[index], placement, &forbidden)?;
            }
        }
        None
    }

    /// Of the ways of every segment the cheapest, or those of one posture all along.
    fn chosen(&self, found: &[Vec<Found>]) -> Option<Vec<Found>> {
        let problem = self.grid.problem;
        let cheapest = |ways: &Vec<Found>| ways.iter().min_by(|a, b| a.cost.total_cmp(&b.cost)).cloned();
        if problem.postures.may_change {
            return found.iter().map(cheapest).collect();
        }
        let of = |posture: Posture| {
            let is_of = |way: &&Found| {
                let flips = self.planners[0].evaluators[way.evaluator].flips();
                way.class == posture.class() && flips.contains(posture)
            };
            found.iter().map(|ways| ways.iter().find(is_of).cloned()).collect::<Option<Vec<Found>>>()
        };
        let objective = |ways: &Vec<Found>| problem.objective(ways.iter().map(|way| way.cost));
        problem.postures.allowed().filter_map(of).min_by(|a, b| objective(a).total_cmp(&objective(b)))
    }

    /// The cheapest way along a segment in every posture class in which there is one; none where there is none.
    fn segment(&self, span: &Span<usize>, placement: &Placement, forbidden: &[StateSet]) -> Option<Vec<Found>> {
        let evaluators = 0..self.planners.first()?.evaluators.len();
        let mut found = Vec::new();
        for evaluator in evaluators {
            let pass = self.pass(evaluator, span, placement, forbidden);
            for class in PostureClass::ALL {
                if let Some((cost, lean, beta)) = pass.ends[class.index()] {
                    let way = self.trace(&pass, span, class, (lean, beta));
                    found.push(Found { evaluator, class, cost, way });
                }
            }
        }
        (!found.is_empty()).then_some(found)
    }

    /// Goes through a segment in all posture classes at once.
    fn pass(&self, evaluator: usize, span: &Span<usize>, placement: &Placement, forbidden: &[StateSet]) -> LeanPass {
        let (number, beta_count) = (self.planners.len(), self.grid.problem.redundancy.beta_count);
        let flips = self.planners[0].evaluators[evaluator].flips();
        let rules = &self.grid.problem.postures;
        let classes = PostureClass::ALL
            .map(|class| Posture::ALL.iter().any(|p| p.class() == class && flips.contains(*p) && rules.allows(*p)));
        let mut links = vec![Link::default(); span.len() * 4 * number * beta_count];
        let mut before = vec![StateGrid::new(beta_count, self.pad); number];
        let mut now = before.clone();
        for (point, row) in span.clone().zip(links.chunks_mut(4 * number * beta_count)) {
            let states = now.par_iter_mut().zip(row.par_chunks_mut(4 * beta_count)).enumerate();
            states.for_each(|(lean, (states, links))| {
                self.evaluate(evaluator, point, lean, placement, classes, forbidden, states);
                for class in PostureClass::ALL {
                    let links = &mut links[class.index() * beta_count..][..beta_count];
                    if !states.is_alive(class) {
                        continue;
                    }
                    if point == span.start {
                        transition::begin(states, class, 1.0);
                    } else if !self.reach(point, lean, class, &before, states, links) {
                        states.clear(class);
                        continue;
                    }
                    states.wrap_around(class);
                }
            });
            std::mem::swap(&mut before, &mut now);
        }
        let end = |class: PostureClass| {
            let costs = before.iter().enumerate().filter(|(_, states)| states.is_alive(class)).flat_map(|(lean, s)| {
                s.inner_scores(class).iter().enumerate().map(move |(beta, cost)| (*cost, lean, beta))
            });
            costs.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|end| end.0.is_finite())
        };
        LeanPass { ends: PostureClass::ALL.map(end), links }
    }

    /// The allowed states of a point in one lean, as far as they are known not to hit.
    #[allow(clippy::too_many_arguments, reason = "what is evaluated, where, and into what")]
    fn evaluate(
        &self,
        evaluator: usize,
        point: usize,
        lean: usize,
        placement: &Placement,
        classes: [bool; 4],
        forbidden: &[StateSet],
        states: &mut StateGrid,
    ) {
        if self.grid.leans[lean][point].is_none() {
            PostureClass::ALL.into_iter().for_each(|class| states.clear(class));
            return;
        }
        let planner = &self.planners[lean];
        planner.evaluators[evaluator].evaluate_classes(point, placement, classes, states);
        if let Some(hits) = &planner.tool_hits {
            hits.apply(point, states);
        }
        forbidden[lean].apply(point, states);
    }

    /// Takes the cheapest states before, over all leans, for the states of a point in one of them; false when none is
    /// reached.
    fn reach(
        &self,
        point: usize,
        lean: usize,
        class: PostureClass,
        before: &[StateGrid],
        states: &mut StateGrid,
        links: &mut [Link],
    ) -> bool {
        let step = self.planners[lean].step(point, Sense::Min);
        let (pad, count) = (states.pad(), states.count());
        let own = states.scores(class).to_vec();
        let mut best = vec![f64::INFINITY; count];
        let mut shifts = vec![0_i16; count];
        let mut is_reached = false;
        for (from, change) in &self.before[point][lean] {
            let known = &before[usize::from(*from)];
            if !known.is_alive(class) {
                continue;
            }
            states.scores_mut(class).copy_from_slice(&own);
            let step = transition::Step { change: *change, ..step };
            if !advance(known, states, class, &step, &mut shifts) {
                continue;
            }
            is_reached = true;
            let costs = states.inner_scores(class);
            for beta in 0..count {
                if costs[beta] < best[beta] {
                    best[beta] = costs[beta];
                    links[beta] = Link { lean: *from, shift: shifts[beta] };
                }
            }
        }
        states.scores_mut(class)[pad..pad + count].copy_from_slice(&best);
        is_reached
    }

    /// The way to a state at the end of a segment.
    fn trace(&self, pass: &LeanPass, span: &Span<usize>, class: PostureClass, end: (usize, usize)) -> Way {
        let (number, count) = (self.planners.len(), self.grid.problem.redundancy.beta_count);
        let (mut lean, mut beta) = end;
        let mut way = vec![end; span.len()];
        for place in (1..span.len()).rev() {
            let link = pass.links[((place * number + lean) * 4 + class.index()) * count + beta];
            lean = usize::from(link.lean);
            beta = (beta as isize + isize::from(link.shift)).rem_euclid(count as isize) as usize;
            way[place - 1] = (lean, beta);
        }
        way
    }

    /// Forbids all states that hit at the points at which a way does, in its class; whether there are any.
    fn forbid_hits(
        &self,
        span: &Span<usize>,
        placement: &Placement,
        found: &Found,
        looked_at: &mut [[bool; 4]],
        forbidden: &mut [StateSet],
    ) -> bool {
        if self.grid.problem.scene.is_none() {
            return false;
        }
        let class = found.class;
        let flips = self.planners[0].evaluators[found.evaluator].flips();
        let rules = &self.grid.problem.postures;
        let postures: Vec<Posture> =
            class.postures().into_iter().filter(|p| flips.contains(*p) && rules.allows(*p)).collect();
        let hits = |point: usize, lean: usize, beta: usize, known: &mut Proximity| {
            let planner = &self.planners[lean];
            let (problem, kinds) = (planner.problem, kinds_left(planner.tool_hits.as_deref()));
            let angle = planner.grid.beta(beta);
            let hit = |p: &Posture| problem.next_hit(point, angle, placement, *p, kinds, known).is_some();
            !postures.is_empty() && postures.iter().all(hit)
        };
        let mut known = Proximity::default();
        let places: Vec<usize> = (0..span.len())
            .filter(|place| hits(span.start + place, found.way[*place].0, found.way[*place].1, &mut known))
            .collect();
        let near = |place: &usize| place.saturating_sub(NEIGHBOURS)..(place + NEIGHBOURS + 1).min(span.len());
        let mut points: Vec<usize> = places.iter().flat_map(near).map(|place| span.start + place).collect();
        points.dedup();
        points.retain(|point| !looked_at[*point][class.index()]);
        for point in &points {
            looked_at[*point][class.index()] = true;
        }
        let classes = PostureClass::ALL.map(|other| other == class);
        let found: Vec<Vec<(usize, usize)>> = (0..self.planners.len())
            .into_par_iter()
            .map_init(
                || StateGrid::new(self.grid.problem.redundancy.beta_count, self.pad),
                |states, lean| {
                    let mut known = Proximity::default();
                    let mut all = Vec::new();
                    for point in &points {
                        self.evaluate(found.evaluator, *point, lean, placement, classes, forbidden, states);
                        let is_open = |beta: &usize| states.inner_scores(class)[*beta].is_finite();
                        let open: Vec<usize> = (0..states.count()).filter(is_open).collect();
                        all.extend(
                            open.into_iter()
                                .filter(|beta| states.is_alive(class) && hits(*point, lean, *beta, &mut known))
                                .map(|beta| (*point, beta)),
                        );
                    }
                    all
                },
            )
            .collect();
        let mut is_any = false;
        for (states, new) in forbidden.iter_mut().zip(found) {
            for (point, beta) in new {
                is_any |= states.add(point, class, beta);
            }
        }
        is_any
    }
}

/// Points to either side of one that hits that are looked at with it: what hits at one mostly hits at the next.
const NEIGHBOURS: usize = 3;

/// For each lean at a point those at the point before it from which the tool may come, with the changes of beta.
fn steps_to(grid: &LeanGrid<'_>, point: usize) -> Vec<Vec<Before>> {
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

#[cfg(test)]
mod tests;
