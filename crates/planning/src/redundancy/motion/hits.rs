//! What hits along a way, and is forbidden.

use super::super::StateSet;
use super::super::state_set::kinds_left;
use super::{Found, MotionPlanner};
use rayon::prelude::*;
use std::ops::Range as Span;
use stead_cell::Proximity;
use stead_model::robot::{Posture, PostureClass};
use stead_problem::evaluate::batch::StateGrid;
use stead_problem::problem::Placement;

/// Points to either side of one that hits that are checked with it: what hits at one mostly hits at the next.
const NEIGHBOURS: usize = 3;

impl MotionPlanner<'_> {
    /// Forbids all states that hit at the points at which a way does, in its class; whether there are any.
    pub(super) fn forbid_hits(
        &self,
        span: &Span<usize>,
        placement: &Placement,
        found: &Found,
        checked: &mut [[bool; 4]],
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
        let hits = |point: usize, setting: usize, beta: usize, known: &mut Proximity| {
            let planner = &self.planners[setting];
            let (problem, kinds) = (planner.problem, kinds_left(planner.tool_hits.as_deref()));
            let angle = planner.grid.beta(beta);
            let hit = |p: &Posture| problem.at(placement).next_hit(point, angle, *p, kinds, known).is_some();
            !postures.is_empty() && postures.iter().all(hit)
        };
        let mut known = Proximity::default();
        let places: Vec<usize> = (0..span.len())
            .filter(|place| hits(span.start + place, found.way[*place].0, found.way[*place].1, &mut known))
            .collect();
        let near = |place: &usize| place.saturating_sub(NEIGHBOURS)..(place + NEIGHBOURS + 1).min(span.len());
        let mut points: Vec<usize> = places.iter().flat_map(near).map(|place| span.start + place).collect();
        points.dedup();
        points.retain(|point| !checked[*point][class.index()]);
        for point in &points {
            checked[*point][class.index()] = true;
        }
        let classes = PostureClass::ALL.map(|other| other == class);
        let found: Vec<Vec<(usize, usize)>> = (0..self.planners.len())
            .into_par_iter()
            .map_init(
                || StateGrid::new(self.grid.problem.redundancy.beta_count, self.pad),
                |states, setting| {
                    let mut known = Proximity::default();
                    let mut all = Vec::new();
                    for point in &points {
                        self.evaluate(found.evaluator, *point, setting, placement, classes, forbidden, states);
                        let is_open = |beta: &usize| states.inner_scores(class)[*beta].is_finite();
                        let open: Vec<usize> = (0..states.count()).filter(is_open).collect();
                        all.extend(
                            open.into_iter()
                                .filter(|beta| states.is_alive(class) && hits(*point, setting, *beta, &mut known))
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
