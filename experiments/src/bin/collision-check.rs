//! No false free: random states of three scenes, in which everything that the covers call free is looked at with the
//! shapes themselves.
//!
//! `cargo run --release -p stead-experiments --bin collision-check -- [STATES [RUN ..]]`: STATES of each scene, by
//! default 10 000; each RUN is a run with surroundings, by default the three cells that are shipped. Half of the states
//! are drawn from the joints' ranges and the cell; of the other half the arm stands over the path. Ends with an error
//! where covers, or what the search asks along a path, call free what is not.

#![allow(clippy::print_stdout, reason = "an experiment prints")]

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::HashMap;
use std::env;
use std::error::Error;
use stead_cell::cover::{Cover, lower_bound};
use stead_cell::{Attachment, PairKind, Proximity, Scene};
use stead_model::robot::Posture;
use stead_problem::problem::{Placement, Problem};

/// Distances of round shapes are good to this. m
const ACCURACY: f64 = 1e-5;

/// What was counted.
#[derive(Default)]
struct Counted {
    /// Pairs looked at, over all states.
    pairs: usize,
    /// Pairs of them that the covers call far enough apart.
    covered: usize,
    /// States that the shapes call free.
    free: usize,
    /// States called free, and pairs that the covers call apart, that are not.
    wrong: usize,
}

/// The cells that are shipped.
const RUNS: [&str; 3] = ["configs/collision.toml", "configs/rail-panel.toml", "configs/tilting-table.toml"];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let states: usize = arguments.first().map_or(Ok(10_000), |count| count.parse())?;
    let runs = if arguments.len() > 1 { arguments[1..].to_vec() } else { RUNS.map(str::to_owned).to_vec() };
    let mut is_wrong = false;
    for file in runs {
        let run = stead::Run::read(&file)?;
        let problem = run.problem();
        let scene = problem.scene.as_deref().ok_or("the run has no surroundings")?;
        let counted = counted(problem, scene, states);
        println!(
            "{file}: of {states} states {} are free; {} of {} pairs are apart by their covers alone; wrongly free: {}",
            counted.free, counted.covered, counted.pairs, counted.wrong
        );
        is_wrong |= counted.wrong > 0;
    }
    if is_wrong { Err("what is not free is called free".into()) } else { Ok(()) }
}

fn counted(problem: &Problem, scene: &Scene, states: usize) -> Counted {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut counted = Counted::default();
    let mut known = Proximity::default();
    let covers = scene
        .surroundings()
        .shapes()
        .iter()
        .map(|shape| (shape.name.clone(), (Cover::new(&shape.solid, &shape.pose), shape.attached)));
    let covers: HashMap<String, (Cover, Attachment)> = covers.collect();
    // Zones have no covers.
    let members: Vec<Option<[&(Cover, Attachment); 2]>> =
        scene.pairs().iter().map(|pair| Some([covers.get(&pair.names[0])?, covers.get(&pair.names[1])?])).collect();
    let mut done = 0;
    while done < states {
        let placement = placement(problem, &mut random);
        let joints = if done % 2 == 0 {
            std::array::from_fn(|j| {
                let joint = &problem.robot.joints()[j];
                joint.min + (joint.max - joint.min) * random.random::<f64>()
            })
        } else {
            let point = random.random_range(0..problem.task.points().len());
            let posture = Posture::ALL[random.random_range(0..8)];
            let beta = std::f64::consts::TAU * random.random::<f64>();
            match problem.robot.inverse(&problem.at(&placement).base_from_flange(point, beta), posture) {
                Ok(joints) => joints,
                Err(_) => continue,
            }
        };
        done += 1;
        let point = random.random_range(0..problem.task.points().len());
        let poses = problem.poses(scene, point, &placement, &joints);
        let is_free = |number: usize| {
            let distance = scene.distance(number, &poses, 1.0);
            // Zones may be touched, shapes may not.
            distance >= scene.pairs()[number].required - ACCURACY
                && (distance > 0.0 || scene.pairs()[number].is_of_zone())
        };
        let is_free = (0..scene.pairs().len()).all(is_free);
        counted.free += usize::from(is_free);
        for (number, [a, b]) in members.iter().enumerate().filter_map(|(number, ends)| Some((number, ends.as_ref()?))) {
            let required = scene.pairs()[number].required;
            let bound = lower_bound(&a.0, poses.of(a.1), &b.0, poses.of(b.1), required);
            let is_covered = bound >= required && bound > 0.0;
            counted.pairs += 1;
            counted.covered += usize::from(is_covered);
            counted.wrong += usize::from(is_covered && scene.distance(number, &poses, 1.0) < required - ACCURACY);
        }
        // What the search asks: the answer of both stages, and what is known from the state before.
        let is_called_free = scene.first_hit(&poses, &PairKind::ALL).is_none()
            || scene.next_hit(&mut known, &poses, &PairKind::ALL).is_none();
        counted.wrong += usize::from(is_called_free && !is_free);
    }
    counted
}

/// A placement drawn from the cell.
fn placement(problem: &Problem, random: &mut impl Rng) -> Placement {
    let [x, y, z] = problem.cell.position.map(|bounds| bounds.min + bounds.width() * random.random::<f64>());
    let yaw = problem.cell.yaw.min + problem.cell.yaw.width() * random.random::<f64>();
    Placement { x, y, z, yaw }
}
