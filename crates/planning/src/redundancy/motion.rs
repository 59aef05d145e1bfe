//! A tool that leans and external axes that move along the path: dynamic programming over (beta, lead, tilt, axes).
//!
//! A state of a path point is a grid value of beta, one of the [settings](Setting) that the point may have, a lean with
//! positions of the external axes, and a posture class, with joint angles modulo a turn. From one point to the next the
//! tool axis may turn as far as the contact stays near its line
//! ([`LeanSpace::allows_step`](stead_problem::lean::LeanSpace::allows_step)), each axis move as fast as it may, beta
//! change as far as its limits allow between these two settings, and each joint go by its step. All states and all
//! steps are evaluated, so that what is found is the cheapest of its grid but for what flips and turns of the wrist
//! forbid. The plan itself is made afterwards, with tool and axes along the way found here
//! ([`Setup`](stead_problem::setup::Setup)), so nothing of what is printed rests on this grid.
//!
//! Where something hits, all states of the points at which the plan hits are checked for collisions, and the plan is
//! made again without those that hit, until it is free.

mod grid;
mod hits;

pub use grid::{MotionGrid, Setting, SettingSteps};

use super::transition::{self, advance};
use super::until_free::until_free;
use super::{Resolution, SegmentPlanner, StateSet};
use grid::{Before, steps_to};
use hits::FreeWays;
use rayon::prelude::*;
use std::ops::Range as Span;
use std::sync::Arc;
use stead_model::robot::{Posture, PostureClass};
use stead_model::task::lean::Lean;
use stead_problem::evaluate::batch::StateGrid;
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;

/// How the tool leans and the external axes move along the path.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// How the tool leans at every point; empty where its axis is that of the path.
    pub leans: Vec<Lean>,
    /// Positions of the external axes at every point. m or rad
    pub axes: Vec<Vec<f64>>,
}

/// What a [`MotionPlanner`] finds.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedMotion {
    /// How tool and axes move.
    pub motion: Motion,
    /// The objective, on the grid and with joint angles modulo a turn. m
    pub objective: f64,
    /// How often the path was planned until nothing hit.
    pub rounds: usize,
}

/// What keeps a placement from having a way of the tool along the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unreached {
    /// Path points that no state reaches from the point before, after each of which a way begins anew.
    pub points: usize,
    /// Segments without a way.
    pub segments: usize,
}

/// The planner of a [`MotionGrid`]: what does not change from one placement to the next.
#[derive(Debug, Clone)]
pub struct MotionPlanner<'a> {
    grid: &'a MotionGrid<'a>,
    /// For each number of a setting.
    planners: Vec<SegmentPlanner<'a>>,
    /// For every point and each setting the settings before it.
    before: Vec<Vec<Vec<Before>>>,
    /// How far states must be continued for the widest change of beta.
    pad: usize,
}

/// What one pass over a segment with one evaluator found.
struct MotionPass {
    /// For each class the smallest sum of costs with the setting and beta number at the end.
    ends: [Option<(f64, usize, usize)>; 4],
    /// Points that no state reaches from the point before, after each of which a way begins anew.
    unreached: usize,
    /// For every point, class, setting and beta the setting and the beta number before.
    links: Vec<Link>,
}

/// A setting at the point before and the step of the beta number back to it.
#[derive(Debug, Clone, Copy, Default)]
struct Link {
    setting: u16,
    shift: i16,
}

/// Space of one thread for the states of a point in a setting: their own scores, the smallest costs of ways to them,
/// and the steps of beta back along these.
#[derive(Debug, Default)]
struct Reached {
    own: Vec<f64>,
    best: Vec<f64>,
    shifts: Vec<i16>,
}

/// What is evaluated in a pass over a segment.
#[derive(Clone, Copy)]
struct Sweep<'s> {
    evaluator: usize,
    placement: &'s Placement,
    classes: [bool; 4],
    /// For each number of a setting the states that hit.
    forbidden: &'s [StateSet],
}

impl<'s> Sweep<'s> {
    /// In all classes of an evaluator that the problem allows.
    fn new(planner: &MotionPlanner<'_>, evaluator: usize, placement: &'s Placement, forbidden: &'s [StateSet]) -> Self {
        let classes = PostureClass::ALL.map(|class| planner.postures(evaluator, class).next().is_some());
        Self { evaluator, placement, classes, forbidden }
    }
}

/// The states of a point in one setting and one class.
#[derive(Clone, Copy)]
struct Target {
    point: usize,
    setting: usize,
    class: PostureClass,
}

/// The states at the points of a segment: of each point the number of its setting and that of its beta.
type Way = Vec<(usize, usize)>;

/// A way along a segment in a class.
#[derive(Clone)]
struct Found {
    evaluator: usize,
    class: PostureClass,
    cost: f64,
    way: Way,
}

impl<'a> MotionPlanner<'a> {
    /// Prepares the planning of the [problems](MotionGrid::problems) of a grid.
    pub fn new(grid: &'a MotionGrid<'a>, problems: &'a [Problem]) -> Self {
        let resolution = if grid.problem.task.path().is_thinned() { Resolution::Subset } else { Resolution::Search };
        // What the tool hits by itself depends on how it leans alone.
        let like = |problem: &Problem| problems.iter().position(|known| known.setup.leans == problem.setup.leans);
        let likes: Vec<usize> =
            problems.iter().enumerate().map(|(own, problem)| like(problem).unwrap_or(own)).collect();
        let tool_hits: Vec<Option<Arc<StateSet>>> = (0..problems.len())
            .into_par_iter()
            .map(|own| {
                let problem = Some(&problems[own]).filter(|_| likes[own] == own)?;
                StateSet::of_tool(problem, &problem.redundancy).map(Arc::new)
            })
            .collect();
        let planner = |(problem, like): (&'a Problem, usize)| {
            SegmentPlanner::with_tool_hits(problem, problem.redundancy, resolution, tool_hits[like].clone())
        };
        let planners: Vec<SegmentPlanner<'a>> = problems.par_iter().zip(likes).map(planner).collect();
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
    pub fn path(&self, placement: &Placement) -> Option<PlannedMotion> {
        self.path_or_unreached(placement).ok()
    }

    /// The cheapest way of the tool along the path at a placement.
    ///
    /// # Errors
    /// [`Unreached`] where there is none.
    pub fn path_or_unreached(&self, placement: &Placement) -> Result<PlannedMotion, Unreached> {
        let problem = self.grid.problem;
        let spans = problem.task.segments();
        let all = Unreached { points: problem.task.points().len(), segments: spans.len() };
        if problem.placement_hit(placement).is_some() {
            return Err(all);
        }
        let mut job = FreeWays {
            planner: self,
            placement,
            found: Vec::new(),
            again: (0..spans.len()).collect(),
            forbidden: vec![StateSet::default(); self.planners.len()],
            checked: vec![[false; 4]; all.points],
            rounds: 0,
        };
        let (chosen, _) = until_free(&mut job, usize::MAX)?;
        let objective = problem.objective(chosen.iter().map(|way| way.cost));
        Ok(PlannedMotion { motion: self.motion(spans, &chosen), objective, rounds: job.rounds })
    }

    /// The postures of a class that an evaluator covers and the problem allows.
    fn postures(&self, evaluator: usize, class: PostureClass) -> impl Iterator<Item = Posture> {
        let (flips, rules) = (self.planners[0].evaluators[evaluator].flips(), &self.grid.problem.postures);
        class.postures().into_iter().filter(move |p| flips.contains(*p) && rules.allows(*p))
    }

    /// The motion along the ways of all segments.
    fn motion(&self, spans: &[Span<usize>], ways: &[Found]) -> Motion {
        let setting = |(point, (number, _)): (usize, &(usize, usize))| self.grid.settings[*number][point].clone();
        let all = spans.iter().zip(ways).flat_map(|(span, found)| span.clone().zip(&found.way));
        let mut motion = Motion { leans: Vec::new(), axes: Vec::new() };
        for Setting { lean, axes } in all.filter_map(setting) {
            motion.leans.extend(self.grid.space.map(|_| lean));
            motion.axes.push(axes);
        }
        motion
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

    /// The cheapest way along a segment in every posture class in which there is one, or how many points none
    /// reaches.
    fn segment(&self, span: &Span<usize>, placement: &Placement, forbidden: &[StateSet]) -> Result<Vec<Found>, usize> {
        let evaluators = self.planners.first().map_or(0, |planner| planner.evaluators.len());
        let mut found = Vec::new();
        let mut unreached = span.len();
        for evaluator in 0..evaluators {
            let pass = self.pass(Sweep::new(self, evaluator, placement, forbidden), span);
            unreached = unreached.min(pass.unreached);
            for class in PostureClass::ALL {
                if let Some((cost, setting, beta)) = pass.ends[class.index()] {
                    let way = self.trace(&pass, span, class, (setting, beta));
                    found.push(Found { evaluator, class, cost, way });
                }
            }
        }
        if found.is_empty() { Err(unreached.max(1)) } else { Ok(found) }
    }

    /// Goes through a segment in all posture classes at once.
    #[expect(clippy::excessive_nesting, reason = "steps of one search that share what it keeps")]
    fn pass(&self, sweep: Sweep<'_>, span: &Span<usize>) -> MotionPass {
        let (number, beta_count) = (self.planners.len(), self.grid.problem.redundancy.beta_count);
        let mut links = vec![Link::default(); span.len() * 4 * number * beta_count];
        let counts_travel = self.planners[0].travel_cost(Sense::Min) > 0.0;
        let mut before = vec![StateGrid::new(beta_count, self.pad).with_angles(counts_travel); number];
        let mut now = before.clone();
        let (mut is_start, mut unreached) = (true, 0);
        for (point, row) in span.clone().zip(links.chunks_mut(4 * number * beta_count)) {
            let states = now.par_iter_mut().zip(row.par_chunks_mut(4 * beta_count)).enumerate();
            states.for_each_init(Reached::default, |reached, (setting, (states, links))| {
                self.evaluate(sweep, point, setting, states);
                for class in PostureClass::ALL {
                    let links = &mut links[class.index() * beta_count..][..beta_count];
                    if !states.is_alive(class) {
                        continue;
                    }
                    if is_start {
                        transition::begin(states, class, 1.0);
                    } else if !self.reach(Target { point, setting, class }, &before, states, links, reached) {
                        states.clear(class);
                        continue;
                    }
                    states.wrap_around(class);
                }
            });
            std::mem::swap(&mut before, &mut now);
            is_start = !before.iter().any(|states| PostureClass::ALL.iter().any(|class| states.is_alive(*class)));
            unreached += usize::from(is_start);
        }
        let end = |class: PostureClass| {
            let costs =
                before.iter().enumerate().filter(|(_, states)| states.is_alive(class)).flat_map(|(setting, s)| {
                    s.inner_scores(class).iter().enumerate().map(move |(beta, cost)| (*cost, setting, beta))
                });
            costs.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|end| unreached == 0 && end.0.is_finite())
        };
        MotionPass { ends: PostureClass::ALL.map(end), unreached, links }
    }

    /// The allowed states of a point in one setting, as far as they are known not to hit.
    fn evaluate(&self, sweep: Sweep<'_>, point: usize, setting: usize, states: &mut StateGrid) {
        if self.grid.settings[setting][point].is_none() {
            PostureClass::ALL.into_iter().for_each(|class| states.clear(class));
            return;
        }
        let planner = &self.planners[setting];
        planner.evaluators[sweep.evaluator].evaluate_some(point, sweep.placement, sweep.classes, None, states);
        if let Some(hits) = &planner.tool_hits {
            hits.apply(point, states);
        }
        sweep.forbidden[setting].apply(point, states);
    }

    /// Takes the cheapest states before, over all settings, for the states of a point in one of them; false when none
    /// is reached.
    fn reach(
        &self,
        target: Target,
        before: &[StateGrid],
        states: &mut StateGrid,
        links: &mut [Link],
        reached: &mut Reached,
    ) -> bool {
        let Target { point, setting, class } = target;
        let step = self.planners[setting].step(point, Sense::Min);
        let (pad, count) = (states.pad(), states.count());
        let Reached { own, best, shifts } = reached;
        own.clear();
        own.extend_from_slice(states.scores(class));
        best.clear();
        best.resize(count, f64::INFINITY);
        shifts.resize(count, 0);
        let mut is_reached = false;
        for (from, change) in &self.before[point][setting] {
            let known = &before[usize::from(*from)];
            if !known.is_alive(class) {
                continue;
            }
            states.scores_mut(class).copy_from_slice(own);
            let step = transition::Step { change: *change, ..step };
            if !advance(known, states, class, &step, shifts) {
                continue;
            }
            is_reached = true;
            let costs = states.inner_scores(class);
            for beta in 0..count {
                if costs[beta] < best[beta] {
                    best[beta] = costs[beta];
                    links[beta] = Link { setting: *from, shift: shifts[beta] };
                }
            }
        }
        states.scores_mut(class)[pad..pad + count].copy_from_slice(best);
        is_reached
    }

    /// The way to a state at the end of a segment.
    fn trace(&self, pass: &MotionPass, span: &Span<usize>, class: PostureClass, end: (usize, usize)) -> Way {
        let (number, count) = (self.planners.len(), self.grid.problem.redundancy.beta_count);
        let (mut setting, mut beta) = end;
        let mut way = vec![end; span.len()];
        for place in (1..span.len()).rev() {
            let link = pass.links[((place * number + setting) * 4 + class.index()) * count + beta];
            setting = usize::from(link.setting);
            beta = (beta as isize + isize::from(link.shift)).rem_euclid(count as isize) as usize;
            way[place - 1] = (setting, beta);
        }
        way
    }
}

#[cfg(test)]
mod tests;
