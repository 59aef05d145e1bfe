//! The global search: a genetic algorithm over table placement and, if wanted, the posture scheme.
//!
//! Genes are x, y, z and the yaw (not Q4, which is stretched near +-1 and has a seam there). In the exact mode every
//! candidate gets its best posture scheme from the planner; in the genetic mode the scheme is part of the genome, one
//! posture number per segment, as Caro 2013 did it. Feasible candidates always rank before infeasible ones, and these
//! by how many points and segments fail.
//!
//! Candidates are scored by interpolating a lookup table where the task allows one ([`super::lookup`]); the basins that
//! are refined and the best of every generation are then scored by the planner: only averages are the table's.
//!
//! Random numbers are counter-based: every candidate of every generation has its own stream, so the result depends on
//! the seed alone and not on the number of threads.

mod evaluation;
#[cfg(test)]
mod tests;

use super::evaluator::Evaluator;
use super::lookup::CollisionEffort;
use super::outcome::Generation;
use evaluation::{better_third, evaluate};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::cmp::Ordering;
use std::f64::consts::TAU;
use std::ops::RangeInclusive;
use stead_model::robot::{Posture, angles::wrap};
use stead_numerics::monitor::{Monitor, Progress};
use stead_planning::redundancy::{self, Planner};
use stead_problem::candidate::{Candidate, Objective, rank};
use stead_problem::problem::{Cell, Placement, Problem};
use stead_problem::sense::{BySense, Sense};
use stead_problem::settings::{PostureSearch, SearchSettings};
use stead_problem::symmetry::{apart_about_axis_1, is_axis_1_vertical};

/// What a search returns.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchResult {
    /// The best candidates of distinct basins, best first; if nothing was feasible, those that came nearest.
    pub basins: Vec<Candidate>,
    /// Generation by generation.
    pub history: Vec<Generation>,
    /// Placements evaluated.
    pub evaluations: usize,
    /// Whether the planner does not find what the lookup table promised.
    pub lookup_rejected: bool,
    /// Whether the caller stopped it.
    pub interrupted: bool,
}

impl SearchResult {
    /// That of a search that is not made.
    pub fn nothing() -> Self {
        Self { basins: Vec::new(), history: Vec::new(), evaluations: 0, lookup_rejected: false, interrupted: false }
    }

    /// Whether it met a feasible placement.
    pub fn is_feasible(&self) -> bool {
        self.basins.first().is_some_and(|best| best.objective.mean().is_some())
    }

    /// Of the searches of both senses the one that met nothing feasible continues from the basins of the other, where
    /// it is made at all; whether either met something.
    pub fn share_basins(found: &mut BySense<Self>, settings: &SearchSettings) -> bool {
        let feasible = BySense::from_fn(|sense| found[sense].is_feasible());
        match (feasible.best, feasible.worst) {
            (true, false) if settings.worst => found.worst.basins = found.best.basins.clone(),
            (false, true) => found.best.basins = found.worst.basins.clone(),
            _ => {}
        }
        feasible.best || feasible.worst
    }

    /// The basins of both searches, each with its sense and its rank.
    pub fn jobs(found: &BySense<Self>) -> Vec<(Sense, usize, &Candidate)> {
        let mut jobs = Vec::new();
        for (sense, found) in found.iter() {
            jobs.extend(found.basins.iter().enumerate().map(|(rank, candidate)| (sense, rank, candidate)));
        }
        jobs
    }
}

/// Share of the population that goes on unchanged: the best.
const ELITE: f64 = 0.05;
/// Share of the children that have two parents; the others are mutants of one.
const CROSSOVER: f64 = 0.8;
/// Candidates that fight for the place of a parent.
const TOURNAMENT: usize = 3;
/// How far outside its parents a child may be, relative to their distance.
const OVERSHOOT: f64 = 0.25;
/// Standard deviation of a mutation relative to the cell, at the start and at the end.
const MUTATION: (f64, f64) = (0.2, 0.004);
/// Two placements are in one basin when they are nearer than this, relative to the cell, and in yaw (rad).
const BASIN: (f64, f64) = (0.25, 0.35);

/// Basins kept in mind during the search.
const ARCHIVE: usize = 64;
/// A search stopped before it met a feasible candidate looks at this many more of them.
const LAST_LOOK: usize = 16;
/// The objective of a candidate that is not evaluated yet.
const UNEVALUATED: Objective = Objective::Infeasible { points: usize::MAX, segments: 0 };

/// Searches the cell.
pub fn search(evaluator: &Evaluator<'_>, settings: &SearchSettings, sense: Sense, monitor: &Monitor) -> SearchResult {
    let start = initial(evaluator.planner().problem(), settings, sense);
    generations(evaluator, settings, sense, start, 0..=settings.generations, monitor)
}

/// The generations of a search from a first population on.
pub fn generations(
    evaluator: &Evaluator<'_>,
    settings: &SearchSettings,
    sense: Sense,
    mut population: Vec<Candidate>,
    generations: RangeInclusive<usize>,
    monitor: &Monitor,
) -> SearchResult {
    let problem = evaluator.planner().problem();
    let first = *generations.start();
    let report = |done: usize, best: Option<f64>| {
        monitor.report(Progress::Search { stage: stage(sense), done, total: settings.generations, best });
    };
    // The first population can take as long as all others.
    report(first, None);
    evaluate(evaluator, &mut population, 0, CollisionEffort::ALL.within, monitor);
    let mut evaluations = population.len();
    let (mut history, mut best, mut archive) = (Vec::new(), Vec::new(), Vec::new());
    let mut interrupted = false;
    for generation in generations {
        if generation > first {
            let elite = ((population.len() as f64 * ELITE).ceil() as usize).min(population.len() - 1);
            let child = |index: usize| {
                let mut random = stream(settings.seed, sense, generation, index);
                breed(problem, settings, &population, sense, generation, &mut random)
            };
            let children: Vec<Candidate> = (elite..settings.population).map(child).collect();
            let within = better_third(&population, sense);
            population.truncate(elite);
            population.extend(children);
            evaluate(evaluator, &mut population, elite, within, monitor);
            evaluations += population.len() - elite;
        }
        population.sort_by(|a, b| rank(sense, a.objective, b.objective));
        archive.extend(population.iter().filter(|i| i.objective.mean().is_some()).cloned());
        archive.sort_by(|a, b| rank(sense, a.objective, b.objective));
        archive = distinct(problem, &archive, ARCHIVE);
        let figures = figures(sense, generation, &population, evaluations);
        history.push(figures);
        best.push(population[0].clone());
        report(generation, figures.best);
        interrupted = monitor.should_stop();
        if interrupted {
            break;
        }
    }
    if archive.is_empty() {
        archive = distinct(problem, &population, ARCHIVE);
    }
    evaluator.check(&mut history, &best, sense, monitor);
    let selected = evaluator.select_basins(archive, sense, settings.basins, monitor);
    evaluations += selected.evaluations;
    let (basins, lookup_rejected) = (selected.basins, selected.lookup_rejected);
    SearchResult { basins, history, evaluations, lookup_rejected, interrupted }
}

/// In place of a search, the only placement of a cell that leaves no other, on a planner's grid.
pub fn pinned(planner: &Planner<'_>, placement: Placement, sense: Sense) -> SearchResult {
    let objective = planner.objective(&placement, Sense::Min, None, &mut planner.workspace());
    let candidate = Candidate { placement, scheme: None, objective };
    let history = vec![figures(sense, 0, std::slice::from_ref(&candidate), 1)];
    SearchResult { basins: vec![candidate], history, evaluations: 1, lookup_rejected: false, interrupted: false }
}

/// Evaluates candidates by a planner on a finer grid, and sorts them anew: those that are feasible, or else the nearest
/// alone. Once the caller asks to stop, two are enough.
pub fn evaluate_finer(planner: &Planner<'_>, sense: Sense, candidates: &mut Vec<Candidate>, monitor: &Monitor) {
    let objective = |candidate: &Candidate, workspace: &mut redundancy::Workspace| {
        planner.objective(&candidate.placement, Sense::Min, candidate.scheme.as_deref(), workspace)
    };
    evaluation::by(&|| planner.workspace(), &objective, candidates, 0, 2, monitor);
    candidates.sort_by(|a, b| rank(sense, a.objective, b.objective));
    let feasible = candidates.iter().filter(|candidate| candidate.objective.mean().is_some()).count();
    candidates.truncate(feasible.max(1));
}

/// The name of a search in reports of progress.
fn stage(sense: Sense) -> &'static str {
    match sense {
        Sense::Min => "best placement",
        Sense::Max => "worst placement",
    }
}

/// The random numbers of one candidate: seed and place decide, nothing else.
fn stream(seed: u64, sense: Sense, generation: usize, index: usize) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let side = match sense {
        Sense::Min => 0,
        Sense::Max => 1_u64 << 63,
    };
    random.set_stream(side | (generation as u64) << 32 | index as u64);
    random
}

/// The bounds of the genes.
fn bounds(cell: &Cell) -> [(f64, f64); 4] {
    let [x, y, z] = cell.position;
    [(x.min, x.max), (y.min, y.max), (z.min, z.max), (cell.yaw.min, cell.yaw.max)]
}

/// Placements drawn from the cell as those of a first generation are, other ones for every `draw`.
pub fn drawn(problem: &Problem, settings: &SearchSettings, draw: u64) -> Vec<Placement> {
    let settings = SearchSettings { seed: settings.seed ^ (draw + 1) << 32, ..*settings };
    initial(problem, &settings, Sense::Min).into_iter().map(|candidate| candidate.placement).collect()
}

/// A first population, a Latin hypercube: along every gene, one candidate in each of equal slices.
pub fn initial(problem: &Problem, settings: &SearchSettings, sense: Sense) -> Vec<Candidate> {
    let size = settings.population;
    let mut random = stream(settings.seed, sense, 0, size);
    let slices: [Vec<usize>; 4] = std::array::from_fn(|_| {
        let mut order: Vec<usize> = (0..size).collect();
        for k in (1..size).rev() {
            order.swap(k, random.random_range(0..=k));
        }
        order
    });
    let bounds = bounds(&problem.cell);
    let segments = problem.task.segments().len();
    let allowed: Vec<Posture> = problem.postures.allowed().collect();
    (0..size)
        .map(|index| {
            let mut random = stream(settings.seed, sense, 0, index);
            let placement = std::array::from_fn(|k| {
                let share = (slices[k][index] as f64 + random.random::<f64>()) / size as f64;
                bounds[k].0 + share * (bounds[k].1 - bounds[k].0)
            });
            let scheme = (settings.postures == PostureSearch::Genetic)
                .then(|| (0..segments).map(|_| random_posture(&allowed, &mut random)).collect());
            Candidate { placement: Placement::from(placement), scheme, objective: UNEVALUATED }
        })
        .collect()
}

fn random_posture(allowed: &[Posture], random: &mut impl Rng) -> Posture {
    allowed[random.random_range(0..allowed.len())]
}

/// One child: of two parents, or a mutant of one.
fn breed(
    problem: &Problem,
    settings: &SearchSettings,
    population: &[Candidate],
    sense: Sense,
    generation: usize,
    random: &mut ChaCha8Rng,
) -> Candidate {
    let cell = &problem.cell;
    let mother = tournament(population, sense, random);
    let mut child = mother.clone();
    if random.random::<f64>() < CROSSOVER {
        let father = tournament(population, sense, random);
        for k in 0..4 {
            let share = random.random_range(-OVERSHOOT..1.0 + OVERSHOOT);
            let apart = father.placement[k] - mother.placement[k];
            child.placement[k] += share * if k == 3 && cell.is_yaw_free() { wrap(apart) } else { apart };
        }
        if let (Some(scheme), Some(other)) = (&mut child.scheme, &father.scheme) {
            for (posture, theirs) in scheme.iter_mut().zip(other) {
                if random.random::<bool>() {
                    *posture = *theirs;
                }
            }
        }
    } else {
        let progress = generation as f64 / settings.generations.max(1) as f64;
        let spread = MUTATION.0 * libm::pow(MUTATION.1 / MUTATION.0, progress);
        for (k, (min, max)) in bounds(cell).into_iter().enumerate() {
            child.placement[k] += spread * (max - min) * normal(random);
        }
        if let Some(scheme) = &mut child.scheme {
            let allowed: Vec<Posture> = problem.postures.allowed().collect();
            let chance = 1.0 / scheme.len() as f64;
            for posture in scheme.iter_mut() {
                if random.random::<f64>() < chance {
                    *posture = random_posture(&allowed, random);
                }
            }
        }
    }
    child.placement = cell.clamp(&child.placement);
    child
}

fn tournament<'p>(population: &'p [Candidate], sense: Sense, random: &mut ChaCha8Rng) -> &'p Candidate {
    let mut winner = &population[random.random_range(0..population.len())];
    for _ in 1..TOURNAMENT {
        let rival = &population[random.random_range(0..population.len())];
        if rank(sense, rival.objective, winner.objective) == Ordering::Less {
            winner = rival;
        }
    }
    winner
}

/// A normally distributed number (Box and Muller), from libm so that it is the same everywhere.
fn normal(random: &mut impl Rng) -> f64 {
    let (u, v): (f64, f64) = (random.random(), random.random());
    libm::sqrt(-2.0 * libm::log(1.0 - u)) * libm::cos(TAU * v)
}

fn figures(sense: Sense, generation: usize, population: &[Candidate], evaluations: usize) -> Generation {
    let means: Vec<f64> = population.iter().filter_map(|i| i.objective.mean()).collect();
    Generation {
        sense,
        generation,
        best: means.first().copied(),
        average: (!means.is_empty()).then(|| means.iter().sum::<f64>() / means.len() as f64),
        feasible: means.len(),
        population: population.len(),
        evaluations,
    }
}

/// Of candidates sorted from the best, those that are not in the basin of a better one: at most `max_count`. On a long
/// path, where comparing is dear, placements that a turn about axis 1 brings near each other count as one basin: it
/// changes nothing but the angle of joint 1.
pub fn distinct(problem: &Problem, sorted: &[Candidate], max_count: usize) -> Vec<Candidate> {
    let is_up_to_turn =
        problem.task.path().is_thinned() && is_axis_1_vertical(problem) && problem.external_axes.is_empty();
    let mut basins: Vec<Candidate> = Vec::new();
    for candidate in sorted {
        if basins.len() == max_count {
            break;
        }
        let is_near = |known: &Candidate| {
            let (a, b) = (&known.placement, &candidate.placement);
            is_near(&problem.cell, a, b) || (is_up_to_turn && is_near_after_turn(problem, a, b))
        };
        if !basins.iter().any(is_near) {
            basins.push(candidate.clone());
        }
    }
    basins
}

/// Whether two placements are in one basin.
fn is_near(cell: &Cell, a: &Placement, b: &Placement) -> bool {
    let near = |k: usize| {
        let width = cell.position[k].width();
        width <= 0.0 || (a[k] - b[k]).abs() / width <= BASIN.0
    };
    (0..3).all(near) && wrap(a.yaw - b.yaw).abs() <= BASIN.1
}

/// Whether they are when one of them is turned about axis 1 to the azimuth of the other.
fn is_near_after_turn(problem: &Problem, a: &Placement, b: &Placement) -> bool {
    let [x, y, z] = &problem.cell.position;
    let [distance, height, yaw] = apart_about_axis_1(problem, a, b);
    distance <= BASIN.0 * x.width().max(y.width()) && height <= BASIN.0 * z.width() && yaw <= BASIN.1
}
