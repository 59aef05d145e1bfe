//! Ways on which nothing hits.

use super::super::StateSet;
use super::super::state_set::kinds_left;
use super::super::until_free::Lazy;
use super::{Found, MotionPlanner, Sweep, Unreached};
use rayon::prelude::*;
use std::ops::Range as Span;
use stead_cell::Proximity;
use stead_model::robot::PostureClass;
use stead_problem::evaluate::batch::StateGrid;
use stead_problem::problem::Placement;

/// Points to either side of one that hits that are checked with it: what hits at one mostly hits at the next.
const NEIGHBOURS: usize = 3;

/// Ways of all segments at a placement, with more and more states forbidden.
pub(super) struct FreeWays<'s> {
    pub planner: &'s MotionPlanner<'s>,
    pub placement: &'s Placement,
    /// Of every segment the cheapest way in every posture class.
    pub found: Vec<Vec<Found>>,
    /// Segments that are planned next.
    pub again: Vec<usize>,
    /// For each number of a setting.
    pub forbidden: Vec<StateSet>,
    /// Classes of points of which all states that hit are known.
    pub checked: Vec<[bool; 4]>,
    /// How often the path was planned.
    pub rounds: usize,
}

impl Lazy for FreeWays<'_> {
    type Plan = Vec<Found>;
    type Refused = Unreached;

    fn plan(&mut self) -> Result<Vec<Found>, Unreached> {
        let task = &self.planner.grid.problem.task;
        let (spans, is_first) = (task.segments(), self.rounds == 0);
        self.rounds += 1;
        self.found.resize(spans.len(), Vec::new());
        let mut unreached = Unreached { points: 0, segments: 0 };
        for index in std::mem::take(&mut self.again) {
            match self.planner.segment(&spans[index], self.placement, &self.forbidden) {
                Ok(ways) => self.found[index] = ways,
                Err(points) => {
                    unreached = Unreached { points: unreached.points + points, segments: unreached.segments + 1 };
                    // All segments that fail by themselves are counted, but not those that fail for what hits.
                    if !is_first {
                        break;
                    }
                }
            }
        }
        if unreached.segments > 0 {
            return Err(unreached);
        }
        self.planner.chosen(&self.found).ok_or(Unreached { points: 0, segments: spans.len() })
    }

    fn forbid(&mut self, chosen: &Vec<Found>) -> bool {
        let spans = self.planner.grid.problem.task.segments();
        self.again = (0..spans.len()).filter(|index| self.forbid_hits(&spans[*index], &chosen[*index])).collect();
        !self.again.is_empty()
    }
}

impl FreeWays<'_> {
    /// Forbids all states that hit at the points at which a way does, in its class; whether there are any.
    fn forbid_hits(&mut self, span: &Span<usize>, way: &Found) -> bool {
        let (planner, class) = (self.planner, way.class);
        if planner.grid.problem.scene.is_none() {
            return false;
        }
        let points = self.points_to_check(span, way);
        let sweep = Sweep {
            evaluator: way.evaluator,
            placement: self.placement,
            classes: PostureClass::ALL.map(|other| other == class),
            forbidden: &self.forbidden,
        };
        let space = || StateGrid::new(planner.grid.problem.redundancy.beta_count, planner.pad);
        let hits_in = |states: &mut StateGrid, setting: usize| {
            let mut known = Proximity::default();
            let mut all = Vec::new();
            for point in &points {
                planner.evaluate(sweep, *point, setting, states);
                let is_open = |beta: &usize| states.inner_scores(class)[*beta].is_finite();
                let open = (0..states.count()).filter(is_open);
                let is_hit =
                    |beta: &usize| states.is_alive(class) && self.hits(way, *point, (setting, *beta), &mut known);
                all.extend(open.filter(is_hit).map(|beta| (*point, beta)));
            }
            all
        };
        let numbers = (0..planner.planners.len()).into_par_iter();
        let found: Vec<Vec<(usize, usize)>> = numbers.map_init(space, hits_in).collect();
        let mut is_any = false;
        for (states, new) in self.forbidden.iter_mut().zip(found) {
            for (point, beta) in new {
                is_any |= states.add(point, class, beta);
            }
        }
        is_any
    }

    /// The points at which a way hits and those near them, as far as they have not been checked in its class.
    fn points_to_check(&mut self, span: &Span<usize>, way: &Found) -> Vec<usize> {
        let mut known = Proximity::default();
        let is_hit = |place: &usize| self.hits(way, span.start + place, way.way[*place], &mut known);
        let places: Vec<usize> = (0..span.len()).filter(is_hit).collect();
        let near = |place: &usize| place.saturating_sub(NEIGHBOURS)..(place + NEIGHBOURS + 1).min(span.len());
        let mut points: Vec<usize> = places.iter().flat_map(near).map(|place| span.start + place).collect();
        points.dedup();
        points.retain(|point| !std::mem::replace(&mut self.checked[*point][way.class.index()], true));
        points
    }

    /// Whether something hits in a state of a point, by the numbers of its setting and of its beta, in every posture
    /// that a way covers.
    fn hits(&self, way: &Found, point: usize, state: (usize, usize), known: &mut Proximity) -> bool {
        let planner = &self.planner.planners[state.0];
        let (problem, kinds) = (planner.problem, kinds_left(planner.tool_hits.as_deref()));
        let angle = planner.grid.beta(state.1);
        let mut postures = self.planner.postures(way.evaluator, way.class).peekable();
        let hit = |p| problem.at(self.placement).next_hit(point, angle, p, kinds, known).is_some();
        postures.peek().is_some() && postures.all(hit)
    }
}
