//! No false free: random states of three scenes, in which everything that the covers call free is looked at with the shapes themselves.
//!
//! `cargo run --release --example collision-check -- RUN [STATES]`: RUN is a run with surroundings, by default `configs/collision.toml`;
//! STATES of each scene, by default 10 000. The three scenes are the run's own, the same without a clearance, and the same with 50 mm.
//! Half of the states are drawn from the joints' ranges and the cell; of the other half the arm stands over the path. Ends with an error
//! where covers call free what is not.

#![allow(clippy::print_stdout, reason = "an example prints")]

use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::env;
use std::error::Error;
use stead_cell::{PairKind, Scene, Surroundings};
use stead_model::robot::Posture;
use stead_placement::problem::{Placement, Problem};

/// Distances of round shapes are good to this. m
const ACCURACY: f64 = 1e-5;

/// What was counted.
#[derive(Default)]
struct Counted {
    /// States that the covers call free.
    covered: usize,
    /// States that the shapes call free.
    free: usize,
    /// States called free by the covers that are not.
    wrong: usize,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let file = arguments.first().map_or("configs/collision.toml", String::as_str);
    let states: usize = arguments.get(1).map_or(Ok(10_000), |count| count.parse())?;
    let run = stead::Run::read(file)?;
    let problem = run.problem();
    let own = problem.scene.as_deref().ok_or("the run has no surroundings")?;
    let mut is_wrong = false;
    for clearance in [own.surroundings().clearance(), 0.0, 0.05] {
        let around = own.surroundings();
        let (shapes, zones) = (around.shapes().to_vec(), around.zones().to_vec());
        let around = Surroundings::new(shapes, zones, clearance, around.ignored().to_vec())?;
        let scene = Scene::new(&problem.robot, &problem.spindle.flange_from_tool, around)?;
        let counted = counted(problem, &scene, states);
        let mm = clearance * 1e3;
        println!(
            "clearance {mm} mm: of {states} states the covers call {} free, the shapes {}; wrongly free: {}",
            counted.covered, counted.free, counted.wrong
        );
        is_wrong |= counted.wrong > 0;
    }
    if is_wrong { Err("covers call free what is not".into()) } else { Ok(()) }
}

fn counted(problem: &Problem, scene: &Scene, states: usize) -> Counted {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut counted = Counted::default();
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
            match problem.robot.inverse(&problem.base_from_flange(point, &placement, beta), posture) {
                Ok(joints) => joints,
                Err(_) => continue,
            }
        };
        done += 1;
        let poses = scene.poses(&joints, &placement.base_from_workpiece());
        let is_free = |number: usize| {
            let distance = scene.distance(number, &poses, 1.0);
            // Zones may be touched, shapes may not.
            distance >= scene.pairs()[number].required - ACCURACY
                && (distance > 0.0 || scene.pairs()[number].is_of_zone())
        };
        let is_free = (0..scene.pairs().len()).all(is_free);
        let is_covered = scene.first_covered_hit(&poses, &PairKind::ALL).is_none();
        counted.free += usize::from(is_free);
        counted.covered += usize::from(is_covered);
        // What the search asks is the answer of both stages.
        let is_called_free = scene.first_hit(&poses, &PairKind::ALL).is_none();
        counted.wrong += usize::from((is_covered || is_called_free) && !is_free);
    }
    counted
}

/// A placement drawn from the cell.
fn placement(problem: &Problem, random: &mut impl Rng) -> Placement {
    let [x, y, z] = problem.cell.position.map(|bounds| bounds.min + bounds.width() * random.random::<f64>());
    let yaw = problem.cell.yaw.min + problem.cell.yaw.width() * random.random::<f64>();
    Placement { x, y, z, yaw }
}
