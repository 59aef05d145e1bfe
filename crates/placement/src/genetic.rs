//! The global search: a genetic algorithm over table pose and, if wanted, the posture scheme.
//!
//! Genes are x, y, z and the yaw (not Q4, which is stretched near +-1 and has a seam there). In the exact mode every
//! candidate gets its best posture scheme from the planner; in the genetic mode the scheme is part of the genome, one
//! posture number per segment, as Caro 2013 did it. Feasible candidates always rank before infeasible ones, and these by how
//! many points and segments fail.
//!
//! Candidates are looked at through a table where the task allows one ([`super::lookup`]), and then the basins that go on, and
//! the best of every generation, are looked at by the planner: only averages are the table's.
//!
//! Random numbers are counter-based: every individual of every generation has its own stream, so the result depends on the
//! seed alone and not on the number of threads.

use super::appraiser::Appraiser;
use super::control::{Control, Progress};
use super::outcome::{Generation, Goal};
use super::problem::{Cell, Placement, Problem};
use super::redundancy::Worth;
use super::settings::{PostureSearch, SearchSettings};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::cmp::Ordering;
use std::f64::consts::TAU;
use stead_model::robot::{Posture, angles::wrap};

/// One candidate.
#[derive(Debug, Clone, PartialEq)]
pub struct Individual {
    /// x, y, z (m) and yaw (rad).
    pub pose: [f64; 4],
    /// One posture per segment, in the genetic mode.
    pub scheme: Option<Vec<Posture>>,
    /// What it is worth under its best plan.
    pub worth: Worth,
}

/// What a search returns.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The best individuals of distinct basins, best first; if nothing was feasible, the one that came nearest.
    pub basins: Vec<Individual>,
    /// Generation by generation.
    pub history: Vec<Generation>,
    /// Placements evaluated.
    pub evaluations: usize,
    /// Whether a table misled it: what the table promised, the planner does not find.
    pub misled: bool,
    /// Whether the caller stopped it.
    pub interrupted: bool,
}

/// Share of the population that goes on unchanged: the best.
const ELITE: f64 = 0.05;
/// Share of the children that have two parents; the others are mutants of one.
const CROSSOVER: f64 = 0.8;
/// Individuals that fight for the place of a parent.
const TOURNAMENT: usize = 3;
/// How far outside its parents a child may be, relative to their distance.
const OVERSHOOT: f64 = 0.25;
/// Standard deviation of a mutation relative to the cell, at the start and at the end.
const MUTATION: (f64, f64) = (0.2, 0.004);
/// Two placements are in one basin when they are nearer than this, relative to the cell, and in yaw (rad).
const BASIN: (f64, f64) = (0.25, 0.35);

/// Basins kept in mind during the search.
const ARCHIVE: usize = 64;

/// Order of two individuals, better first.
pub fn rank(goal: Goal, a: Worth, b: Worth) -> Ordering {
    match (a, b) {
        (Worth::Feasible(a), Worth::Feasible(b)) => match goal {
            Goal::Best => a.total_cmp(&b),
            Goal::Worst => b.total_cmp(&a),
        },
        (Worth::Feasible(_), Worth::Infeasible { .. }) => Ordering::Less,
        (Worth::Infeasible { .. }, Worth::Feasible(_)) => Ordering::Greater,
        (Worth::Infeasible { points: p, segments: s }, Worth::Infeasible { points: q, segments: t }) => {
            (p, s).cmp(&(q, t))
        }
    }
}

/// Searches the cell.
pub fn search(appraiser: &Appraiser<'_>, settings: &SearchSettings, goal: Goal, control: &dyn Control) -> Found {
    let problem = appraiser.planner().problem();
    let cell = &problem.cell;
    let mut population = initial(problem, settings, goal);
    evaluate(appraiser, &mut population, 0);
    let mut evaluations = population.len();
    let mut history = Vec::new();
    let mut best = Vec::new();
    let mut archive = Vec::new();
    let mut interrupted = false;
    for generation in 0..=settings.generations {
        if generation > 0 {
            let elite = ((population.len() as f64 * ELITE).ceil() as usize).min(population.len() - 1);
            let children = (elite..settings.population)
                .map(|index| {
                    let mut random = stream(settings.seed, goal, generation, index);
                    breed(cell, settings, &population, goal, generation, &mut random)
                })
                .collect::<Vec<_>>();
            population.truncate(elite);
            population.extend(children);
            evaluate(appraiser, &mut population, elite);
            evaluations += settings.population - elite;
        }
        population.sort_by(|a, b| rank(goal, a.worth, b.worth));
        archive.extend(population.iter().filter(|i| i.worth.mean().is_some()).cloned());
        archive.sort_by(|a, b| rank(goal, a.worth, b.worth));
        archive = distinct(cell, &archive, ARCHIVE);
        let figures = figures(goal, generation, &population, evaluations);
        history.push(figures);
        best.push(population[0].clone());
        control.report(Progress::Generation { generation: figures, of: settings.generations });
        if control.should_stop() {
            interrupted = true;
            break;
        }
    }
    archive.extend(if archive.is_empty() { population.drain(..1).next() } else { None });
    appraiser.check(&mut history, &best, goal);
    let settled = appraiser.settle(archive, goal, settings.basins, control);
    evaluations += settled.looks;
    Found { basins: settled.basins, history, evaluations, misled: settled.misled, interrupted }
}

/// The random numbers of one individual: seed and place decide, nothing else.
fn stream(seed: u64, goal: Goal, generation: usize, index: usize) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let side = match goal {
        Goal::Best => 0,
        Goal::Worst => 1_u64 << 63,
    };
    random.set_stream(side | (generation as u64) << 32 | index as u64);
    random
}

/// The bounds of the genes.
fn bounds(cell: &Cell) -> [(f64, f64); 4] {
    let [x, y, z] = cell.position;
    [(x.min, x.max), (y.min, y.max), (z.min, z.max), (cell.yaw.min, cell.yaw.max)]
}

/// A Latin hypercube: along every gene, one individual in each of equal slices.
fn initial(problem: &Problem, settings: &SearchSettings, goal: Goal) -> Vec<Individual> {
    let size = settings.population;
    let mut random = stream(settings.seed, goal, 0, size);
    let slices: [Vec<usize>; 4] = std::array::from_fn(|_| {
        let mut order: Vec<usize> = (0..size).collect();
        for k in (1..size).rev() {
            order.swap(k, random.random_range(0..=k));
        }
        order
    });
    let bounds = bounds(&problem.cell);
    let segments = problem.task.segments().len();
    (0..size)
        .map(|index| {
            let mut random = stream(settings.seed, goal, 0, index);
            let pose = std::array::from_fn(|k| {
                let share = (slices[k][index] as f64 + random.random::<f64>()) / size as f64;
                bounds[k].0 + share * (bounds[k].1 - bounds[k].0)
            });
            let scheme = (settings.postures == PostureSearch::Genetic)
                .then(|| (0..segments).map(|_| random_posture(&mut random)).collect());
            Individual { pose, scheme, worth: Worth::Infeasible { points: usize::MAX, segments: 0 } }
        })
        .collect()
}

fn random_posture(random: &mut impl Rng) -> Posture {
    Posture::ALL[random.random_range(0..8)]
}

fn evaluate(appraiser: &Appraiser<'_>, population: &mut [Individual], from: usize) {
    population[from..].par_iter_mut().for_each_init(
        || appraiser.workspace(),
        |workspace, individual| {
            individual.worth = appraiser.worth(&individual.pose, individual.scheme.as_deref(), workspace);
        },
    );
}

/// One child: of two parents, or a mutant of one.
fn breed(
    cell: &Cell,
    settings: &SearchSettings,
    population: &[Individual],
    goal: Goal,
    generation: usize,
    random: &mut ChaCha8Rng,
) -> Individual {
    let mother = tournament(population, goal, random);
    let mut child = mother.clone();
    if random.random::<f64>() < CROSSOVER {
        let father = tournament(population, goal, random);
        for k in 0..4 {
            let share = random.random_range(-OVERSHOOT..1.0 + OVERSHOOT);
            let apart = father.pose[k] - mother.pose[k];
            child.pose[k] += share * if k == 3 && cell.is_yaw_free() { wrap(apart) } else { apart };
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
            child.pose[k] += spread * (max - min) * normal(random);
        }
        if let Some(scheme) = &mut child.scheme {
            let chance = 1.0 / scheme.len() as f64;
            for posture in scheme.iter_mut() {
                if random.random::<f64>() < chance {
                    *posture = random_posture(random);
                }
            }
        }
    }
    let [x, y, z, yaw] = child.pose;
    let inside = cell.clamp(&Placement { x, y, z, yaw });
    child.pose = [inside.x, inside.y, inside.z, inside.yaw];
    child
}

fn tournament<'p>(population: &'p [Individual], goal: Goal, random: &mut ChaCha8Rng) -> &'p Individual {
    let mut winner = &population[random.random_range(0..population.len())];
    for _ in 1..TOURNAMENT {
        let rival = &population[random.random_range(0..population.len())];
        if rank(goal, rival.worth, winner.worth) == Ordering::Less {
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

fn figures(goal: Goal, generation: usize, population: &[Individual], evaluations: usize) -> Generation {
    let means: Vec<f64> = population.iter().filter_map(|i| i.worth.mean()).collect();
    Generation {
        goal,
        generation,
        best: means.first().copied(),
        average: (!means.is_empty()).then(|| means.iter().sum::<f64>() / means.len() as f64),
        feasible: means.len(),
        population: population.len(),
        evaluations,
    }
}

/// Of individuals sorted from the best, those that are not in the basin of a better one: at most `most`.
pub fn distinct(cell: &Cell, sorted: &[Individual], most: usize) -> Vec<Individual> {
    let mut basins: Vec<Individual> = Vec::new();
    for individual in sorted {
        if basins.len() == most {
            break;
        }
        let is_new = basins.iter().all(|known| {
            let far = (0..3).any(|k| {
                let width = cell.position[k].width();
                width > 0.0 && (known.pose[k] - individual.pose[k]).abs() / width > BASIN.0
            });
            far || wrap(known.pose[3] - individual.pose[3]).abs() > BASIN.1
        });
        if is_new {
            basins.push(individual.clone());
        }
    }
    basins
}

#[cfg(test)]
mod tests {
    use super::super::control::Unwatched;
    use super::super::lookup::LookupTable;
    use super::super::redundancy::Planner;
    use super::super::testing::five_segments;
    use super::*;

    fn small() -> SearchSettings {
        SearchSettings { population: 24, generations: 6, ..SearchSettings::default() }
    }

    #[test]
    fn same_seed_same_result_for_any_number_of_threads() {
        let mut problem = five_segments();
        problem.redundancy.beta_count = 24;
        let planner = Planner::new(&problem);
        for looks_through_table in [false, true] {
            let run = |threads: usize, seed: u64| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| {
                    let table = looks_through_table.then(|| LookupTable::new(&problem).unwrap());
                    let appraiser = Appraiser::new(&planner, table.as_ref());
                    search(&appraiser, &SearchSettings { seed, ..small() }, Goal::Best, &Unwatched)
                })
            };
            let one = run(1, 1);
            assert_eq!(one, run(2, 1));
            assert_eq!(one, run(5, 1));
            assert_ne!(one.basins, run(2, 2).basins);
        }
    }

    #[test]
    fn best_only_gets_better_and_stays_in_the_cell() {
        let mut problem = five_segments();
        problem.redundancy.beta_count = 24;
        for (goal, postures) in [
            (Goal::Best, PostureSearch::Exact),
            (Goal::Worst, PostureSearch::Exact),
            (Goal::Best, PostureSearch::Genetic),
        ] {
            let planner = Planner::new(&problem);
            let appraiser = Appraiser::new(&planner, None);
            let found = search(&appraiser, &SearchSettings { postures, ..small() }, goal, &Unwatched);
            let best: Vec<f64> = found.history.iter().filter_map(|g| g.best).collect();
            let sign = if goal == Goal::Best { 1.0 } else { -1.0 };
            assert!(best.windows(2).all(|pair| pair[1] * sign <= pair[0] * sign));
            assert_eq!(found.history.len(), 7);
            for individual in &found.basins {
                let [x, y, z, yaw] = individual.pose;
                assert!(problem.cell.contains(&Placement { x, y, z, yaw }));
                assert_eq!(individual.scheme.is_some(), postures == PostureSearch::Genetic);
            }
        }
    }

    #[test]
    fn feasible_ranks_before_infeasible() {
        let (a, b) = (Worth::Feasible(1.0), Worth::Feasible(2.0));
        let (c, d) = (Worth::Infeasible { points: 1, segments: 5 }, Worth::Infeasible { points: 2, segments: 0 });
        assert_eq!(rank(Goal::Best, a, b), Ordering::Less);
        assert_eq!(rank(Goal::Worst, a, b), Ordering::Greater);
        assert_eq!(rank(Goal::Worst, a, c), Ordering::Less);
        assert_eq!(rank(Goal::Best, d, c), Ordering::Greater);
    }
}
