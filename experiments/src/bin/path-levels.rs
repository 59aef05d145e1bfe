//! How well long paths are searched on subsets of their points, on random paths.
//!
//! `cargo run --release -p stead-experiments --bin path-levels -- RUN coverage|adversarial|quality [NUMBER] [POINTS]
//! [POPULATION GENERATIONS]` takes robot, spindle, cell and rules from a run file such as `freeform-3000.toml` of
//! `long-paths`.
//!
//! - `coverage`: how often the stated error of the subsets covers the error at another placement, over NUMBER paths
//!   (250) with 40 other placements each; POINTS is the most points of a path (1200).
//! - `adversarial`: NUMBER paths (20; or those of FROM..TO) of POINTS points (3000), of which ten neighbours decide;
//!   each is searched on subsets and by all points.
//! - `quality`: five paths of POINTS points (1500), the last one of so many rounds that it winds joint 6 to its limits,
//!   each searched with NUMBER seeds (20) and once by all points; the best known is the best of all these.

#![allow(clippy::print_stdout, reason = "an experiment prints")]

use nalgebra::{Rotation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::env;
use std::error::Error;
use std::f64::consts::TAU;
use std::ops::Range;
use std::path::Path;
use std::time::Instant;
use stead_model::task::{PathPoint, Task, ToolPath, Wrench};
use stead_numerics::monitor::Monitor;
use stead_placement::outcome::Outcome;
use stead_placement::path_comparison::PathComparison;
use stead_placement::path_subset::PathSubset;
use stead_placement::place::{LongPath, place};
use stead_planning::redundancy::Planner;
use stead_problem::problem::{Problem, ProblemError};
use stead_problem::settings::SearchSettings;
use stead_run_files::read_run;
use stead_runs::Run;

type Failure = Box<dyn Error>;

/// Neighbours that decide.
const DECIDING: usize = 10;
/// Other placements of a path for `coverage`.
const OTHERS: usize = 40;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let (file, what) =
        arguments.first().zip(arguments.get(1)).ok_or("usage: path-levels RUN WHAT [NUMBER] [POINTS] ..")?;
    let number = |index: usize, default: usize| arguments.get(index).map_or(Ok(default), |text| text.parse());
    let mut run = read_run(Path::new(file))?;
    run.problem = run.problem.changed(|parts| parts.postures.tie = 0.0)?;
    run.search.population = number(4, run.search.population)?;
    run.search.generations = number(5, run.search.generations)?;
    match what.as_str() {
        "coverage" => coverage(&run, number(2, 250)?, number(3, 1200)?),
        "adversarial" => adversarial(&run, paths(arguments.get(2))?, number(3, 3000)?),
        "quality" => quality(&run, number(2, 20)?, number(3, 1500)?),
        _ => Err("what: coverage, adversarial or quality".into()),
    }
}

/// Which paths: `FROM..TO`, or so many from the first.
fn paths(text: Option<&String>) -> Result<Range<usize>, Failure> {
    match text.map(|text| text.split_once("..").ok_or(text)) {
        None => Ok(0..20),
        Some(Ok((from, to))) => Ok(from.parse()?..to.parse()?),
        Some(Err(number)) => Ok(0..number.parse()?),
    }
}

/// A path to be made.
#[derive(Clone, Copy)]
struct Shape {
    points: usize,
    segments: usize,
    /// By how much force and tool axis change at random from point to point: relative, and in rad.
    roughness: f64,
    /// How often it goes round; drawn where none is given.
    rounds: Option<f64>,
}

/// Rounds of a wavy circle of 0.4 m, the tool tilted by up to 30 deg, with a force that turns with the feed and varies
/// by a factor of 2.
fn task(shape: Shape, random: &mut ChaCha8Rng) -> Result<Task, Failure> {
    let mut wave = |size: f64| -> [[f64; 3]; 3] {
        std::array::from_fn(|k| {
            let harmonic = (k + 1) as f64;
            [size / harmonic * random.random_range(0.5..1.0), TAU * harmonic, random.random_range(0.0..TAU)]
        })
    };
    let (radius, height) = (wave(0.03), wave(0.02));
    let (tilt, heading, force) = (wave(0.28), wave(1.5), wave(0.18));
    let at =
        |wave: &[[f64; 3]; 3], t: f64| wave.iter().map(|[size, rate, phase]| size * libm::sin(rate * t + phase)).sum();
    let drawn: f64 = random.random_range(0.5..3.0);
    let rounds = shape.rounds.unwrap_or(drawn);
    let position = |t: f64| {
        let (sine, cosine) = libm::sincos(TAU * rounds * t);
        let radius: f64 = 0.2 + at(&radius, t);
        Vector3::<f64>::new(radius * cosine, radius * sine, at(&height, t))
    };
    let (mut points, mut wrenches) = (Vec::new(), Vec::new());
    for k in 0..shape.points {
        let t = k as f64 / shape.points as f64;
        let feed = (position(t + 1e-6) - position(t - 1e-6)).normalize();
        let noise = Vector3::from_fn(|_, _| shape.roughness * random.random_range(-1.0..1.0));
        let heading: f64 = at(&heading, t);
        let turn = Rotation3::new(Vector3::new(libm::cos(heading), libm::sin(heading), 0.0) * at(&tilt, t));
        let axis = (turn * Vector3::z() + noise * 0.02).normalize();
        let size: f64 = 150.0 * (1.0 + at(&force, t) + noise.x);
        let cutting = (-feed * 0.4 + axis.cross(&feed) * 0.85 + axis * 0.34) * size;
        points.push(((k * shape.segments / shape.points) as u32 + 1, PathPoint { position: position(t), feed, axis }));
        wrenches.push(Wrench { force: cutting, moment: Vector3::zeros() });
    }
    Ok(Task::new(ToolPath::new(points)?, wrenches)?)
}

/// Random paths: how often the stated errors cover another.
fn coverage(run: &Run, paths: usize, most: usize) -> Result<(), Failure> {
    let (mut covered, mut all, mut short) = ([0_usize; 2], [0_usize; 2], 0);
    let silent = Monitor::silent();
    for path in 0..paths {
        let mut random = ChaCha8Rng::seed_from_u64(path as u64);
        let segments = random.random_range(1..=20);
        let points = random.random_range(6 * (60 + segments)..=most.max(6 * (60 + segments)));
        let roughness = [0.0, 0.1, 0.5][random.random_range(0..3)];
        let problem = with_task(&run.problem, task(Shape { points, segments, roughness, rounds: None }, &mut random)?)?;
        let planner = Planner::finer(&problem);
        let settings = SearchSettings { seed: path as u64, ..run.search };
        let Some(long) = LongPath::new(&planner, &settings, &silent) else {
            short += 1;
            continue;
        };
        let other = SearchSettings { seed: 1_000_000 + path as u64, ..settings };
        let others = PathComparison::draw(&planner, &long.search, &other, OTHERS, &silent);
        for (k, subset) in [&long.search, &long.refinement].into_iter().enumerate() {
            // Where no placement is feasible nothing is stated.
            let Some(stated) = [long.levels.search, long.levels.refinement][k].error else { continue };
            let errors = others.errors(&problem, subset);
            all[k] += errors.len();
            covered[k] += errors.iter().filter(|error| **error <= stated).count();
        }
        let (search, refinement) = (long.levels.search, long.levels.refinement);
        let percent = |error: Option<f64>| error.map_or(f64::NAN, |error| error * 100.0);
        println!(
            "path {path}: {points} points, {segments} segments, roughness {roughness}: {} points {:.3} %, {} points {:.3} %; \
             {} placements; so far covered {:.2} and {:.2} %",
            search.points,
            percent(search.error),
            refinement.points,
            percent(refinement.error),
            search.pairs,
            100.0 * covered[0] as f64 / all[0] as f64,
            100.0 * covered[1] as f64 / all[1] as f64,
        );
    }
    println!("covered: search {covered:?} of {all:?} pairs; {short} paths too short");
    Ok(())
}

/// Places, and prints how long it took; case 1 and case 3 in mm.
fn placed(problem: &Problem, settings: &SearchSettings, run: &Run, what: &str) -> Option<(Outcome, [f64; 2])> {
    let start = Instant::now();
    let outcome = place(problem, settings, &run.transfer, &Monitor::silent());
    let seconds = start.elapsed().as_secs_f64();
    let Ok(outcome) = outcome else {
        println!("  {what}: nothing feasible, {seconds:.1} s");
        return None;
    };
    let figures = [0, 1].map(|k| outcome.cases.optima()[k].plan.objective * 1e3);
    let levels = outcome.path_levels.map_or(String::new(), |levels| {
        let (search, refinement) = (levels.search, levels.refinement);
        format!(", on {} and {} points, {} decide", search.points, refinement.points, levels.deciding)
    });
    let [x, y, z, yaw] = std::array::from_fn(|k| outcome.cases.best.placement[k]);
    println!(
        "  {what}: {:.6} and {:.6} mm, {seconds:.1} s{levels}; the best at {x:.3} {y:.3} {z:.3} m, yaw {:.1} deg",
        figures[0],
        figures[1],
        yaw.to_degrees()
    );

    Some((outcome, figures))
}

/// A task whose forces, moments or tool axes are others at some neighbours, each given its share of the way through
/// them.
fn changed(task: &Task, first: usize, change: impl Fn(f64, &mut PathPoint, &mut Wrench)) -> Result<Task, Failure> {
    let mut wrenches: Vec<_> = task.wrenches().copied().collect();
    let mut points: Vec<(u32, PathPoint)> =
        (0..wrenches.len()).map(|k| (task.path().segment_of(k) as u32 + 1, task.points()[k])).collect();
    for k in 0..DECIDING {
        let share = (k as f64 + 0.5) / DECIDING as f64;
        change(share, &mut points[first + k].1, &mut wrenches[first + k]);
    }
    Ok(Task::new(ToolPath::new(points)?, wrenches)?)
}

/// The problem with another task.
fn with_task(problem: &Problem, task: Task) -> Result<Problem, ProblemError> {
    problem.changed(|parts| parts.task = task)
}

/// Paths on which ten neighbours decide, left out by both subsets where that is possible.
fn adversarial(run: &Run, paths: Range<usize>, points: usize) -> Result<(), Failure> {
    let (first_path, mut as_good) = (paths.start, 0);
    for path in paths {
        let mut random = ChaCha8Rng::seed_from_u64(1000 + path as u64);
        let shape = Shape { points, segments: random.random_range(1..=30), roughness: 0.0, rounds: None };
        let mut problem = with_task(&run.problem, task(shape, &mut random)?)?;
        let first = unseen(&problem, 60 + shape.segments, random.random_range(0..points / 2));
        let kind =
            ["force x 10", "tool axis turns by 20 deg and back", "moment of 100 N m", "moment and largest deflection"]
                [path % 4];
        println!("path {path}: {points} points, {} segments, from point {first}: {kind}", shape.segments);
        let task = match path % 4 {
            0 => changed(&problem.task, first, |_, _, wrench| wrench.force *= 10.0)?,
            1 => changed(&problem.task, first, |share, point, _| {
                let turn = Rotation3::new(point.feed * (0.35 * libm::sin(share * TAU / 2.0)));
                point.axis = turn * point.axis;
            })?,
            _ => changed(&problem.task, first, |_, point, wrench| wrench.moment = point.feed * 100.0)?,
        };
        problem = with_task(&problem, task)?;
        if path % 4 == 3
            && let Some((free, _)) = placed(&problem, &run.search, run, "without a limit")
        {
            // A limit that the ten points would not keep at the best placement without one.
            let scores = free.cases.best.plan.points[first..first + DECIDING].iter().map(|point| point.score);
            let most = Some(0.9 * scores.fold(0.0, f64::max));
            problem = problem.changed(|parts| parts.constraints.max_deflection = most)?;
        }
        let subsets = placed(&problem, &run.search, run, "by subsets");
        let whole = SearchSettings { path_points: Some(points), ..run.search };
        let whole = placed(&problem, &whole, run, "by all points");
        let is_as_good = match (subsets, whole) {
            (Some((_, subsets)), Some((_, whole))) => {
                let [best, worst] = std::array::from_fn(|k| 100.0 * (subsets[k] / whole[k] - 1.0));
                println!("  best {best:+.3} %, worst {worst:+.3} % against all points");
                best <= 0.5
            }
            (subsets, whole) => subsets.is_none() == whole.is_none(),
        };
        as_good += usize::from(is_as_good);
        println!("  as good: {as_good} of {}", path + 1 - first_path);
    }
    Ok(())
}

/// The first of neighbours, from a point on, that neither the subset for the search nor that for the refinement has, or
/// at least not the first.
fn unseen(problem: &Problem, count: usize, from: usize) -> usize {
    let points = problem.task.points().len();
    let is_free = |subset: &PathSubset, first: usize| {
        subset.points().iter().all(|point| !(first..first + DECIDING).contains(point))
    };
    let [small, large] = [count, 3 * count].map(|count| PathSubset::new(&problem.task, count));
    let mut firsts = from..points - DECIDING;
    firsts
        .clone()
        .find(|first| is_free(&small, *first) && is_free(&large, *first))
        .unwrap_or_else(|| firsts.find(|first| is_free(&small, *first)).unwrap_or(from))
}

/// Five paths, with many seeds.
fn quality(run: &Run, seeds: usize, points: usize) -> Result<(), Failure> {
    let plain = Shape { points, segments: 1, roughness: 0.0, rounds: Some(1.0) };
    let shapes = [
        ("smooth", plain),
        ("rough", Shape { roughness: 0.5, ..plain }),
        ("one hard corner", plain),
        ("many segments", Shape { segments: 60, ..plain }),
        ("many rounds", Shape { rounds: Some(2.5), ..plain }),
    ];
    for (path, (name, shape)) in shapes.into_iter().enumerate() {
        println!("{name}: {points} points");
        let mut random = ChaCha8Rng::seed_from_u64(2000 + path as u64);
        let mut problem = with_task(&run.problem, task(shape, &mut random)?)?;
        if name == "one hard corner" {
            let task = changed(&problem.task, points / 3, |_, _, wrench| wrench.force *= 10.0)?;
            problem = with_task(&problem, task)?;
        }
        let whole = SearchSettings { path_points: Some(points), ..run.search };
        let mut figures: Vec<[f64; 2]> =
            placed(&problem, &whole, run, "by all points").map(|(_, figures)| figures).into_iter().collect();
        for seed in 1..=seeds as u64 {
            let settings = SearchSettings { seed, ..run.search };
            figures.extend(placed(&problem, &settings, run, &format!("seed {seed}")).map(|(_, figures)| figures));
        }
        let best = figures.iter().map(|figures| figures[0]).fold(f64::INFINITY, f64::min);
        let worst = figures.iter().map(|figures| figures[1]).fold(0.0, f64::max);
        let of_seeds = &figures[figures.len().min(1)..];
        let good = of_seeds.iter().filter(|figures| figures[0] <= best * 1.002).count();
        let bad = of_seeds.iter().filter(|figures| figures[1] >= worst * 0.995).count();
        println!(
            "{name}: best known {best:.6} and {worst:.6} mm; case 1 within 0.2 % in {good}, case 3 within 0.5 % in {bad} of {seeds}"
        );
    }
    Ok(())
}
