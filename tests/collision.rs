//! Shipped cells: no false free, plans that are free in small steps, and a wall that moves the best placement.

use crate::common::Bench;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stead_cell::{PairKind, Proximity};
use stead_model::robot::Posture;
use stead_problem::problem::{Placement, Problem};

/// What is drawn from each cell.
const STATES: usize = 300;
/// Distances of round shapes are good to this. m
const ACCURACY: f64 = 1e-5;

fn drawn(problem: &Problem, random: &mut ChaCha8Rng) -> (usize, Placement, Option<[f64; 6]>) {
    let mut within = |min: f64, max: f64| min + (max - min) * random.random::<f64>();
    let [x, y, z] = problem.cell.position.map(|bounds| within(bounds.min, bounds.max));
    let yaw = within(problem.cell.yaw.min, problem.cell.yaw.max);
    let placement = Placement { x, y, z, yaw };
    let point = random.random_range(0..problem.task.points().len());
    let beta = std::f64::consts::TAU * random.random::<f64>();
    let posture = Posture::ALL[random.random_range(0..8)];
    let joints = problem.robot.inverse(&problem.at(&placement).base_from_flange(point, beta), posture).ok();
    (point, placement, joints)
}

#[test]
fn what_covers_and_paths_call_free_is_free_in_all_shipped_cells() {
    for file in ["configs/collision.toml", "configs/rail-panel.toml", "configs/tilting-table.toml"] {
        let run = stead::Run::read(file).unwrap();
        let problem = run.problem();
        let scene = problem.scene.as_deref().unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(11);
        let (mut known, mut done, mut free) = (Proximity::default(), 0, 0);
        while done < STATES {
            let (point, placement, Some(joints)) = drawn(problem, &mut random) else { continue };
            done += 1;
            let poses = problem.poses(scene, point, &placement, &joints);
            let is_free = (0..scene.pairs().len()).all(|number| {
                let (distance, pair) = (scene.distance(number, &poses, 1.0), &scene.pairs()[number]);
                distance >= pair.required - ACCURACY && (distance > 0.0 || pair.is_of_zone())
            });
            let called = [
                scene.first_covered_hit(&poses, &PairKind::ALL),
                scene.first_hit(&poses, &PairKind::ALL),
                scene.next_hit(&mut known, &poses, &PairKind::ALL),
            ];
            assert!(is_free || called.iter().all(Option::is_some), "{file}: {called:?}");
            free += usize::from(is_free);
        }
        assert!(free > STATES / 50 && free < STATES, "{file}: {free}");
    }
}

/// The shipped cell with a search that is small enough for a test.
pub(crate) fn shipped() -> Bench {
    let bench = Bench::new();
    bench.copy_all(&[RUN, CELL]);
    let mesh = "configs/cells/stepped-part.stl";
    std::fs::copy(mesh, bench.path(mesh)).unwrap();
    bench.replace(RUN, "population = 120", "population = 30");
    bench.replace(RUN, "generations = 51", "generations = 8");
    bench.replace(RUN, "beta_step_deg = 3.0", "beta_step_deg = 6.0");
    bench
}

pub(crate) const RUN: &str = "configs/collision.toml";
const CELL: &str = "configs/cells/kr270-cell.toml";

/// The cases of a run of the shipped job.
fn cases(bench: &Bench) -> serde_json::Value {
    let ended = bench.stead(&["place", RUN, "--json", "--no-page", "--out", "r"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.json()["cases"].clone()
}

#[test]
fn a_wall_through_the_best_placement_moves_it_and_is_named() {
    let bench = shipped();
    let best = |bench: &Bench| {
        let best = cases(bench)[0].clone();
        let at = ["x_mm", "y_mm", "z_mm", "yaw_deg"].map(|key| best["placement"][key].as_f64().unwrap());
        (at, best["mean_mm"].as_f64().unwrap())
    };
    let ([x, y, z, yaw], mean) = best(&bench);
    // Across the slab, beside the middle of the part.
    let wall = format!(
        "[[shape]]\nname = \"wall\"\nattached = \"base\"\nbox_mm = [60.0, 500.0, 600.0]\nxyz_mm = [{x}, {y}, {z}]\n\n[[keep_out]]"
    );
    bench.replace(CELL, "[[keep_out]]", &wall);
    let text = |value: f64| value.to_string();
    let ended = bench.stead(&[
        "explain",
        RUN,
        "--x-mm",
        &text(x),
        "--y-mm",
        &text(y),
        "--z-mm",
        &text(z),
        "--yaw-deg",
        &text(yaw),
        "--point",
        "50",
        "--beta-deg",
        "0",
    ]);
    assert!(format!("{}{}", ended.stdout, ended.stderr).contains("wall"), "{} {}", ended.stdout, ended.stderr);
    let (moved, beside) = best(&bench);
    assert!(beside >= mean * (1.0 - 1e-6), "{beside} {mean}");
    let apart = moved.iter().zip([x, y, z, yaw]).map(|(moved, before)| (moved - before).abs()).fold(0.0, f64::max);
    assert!(apart > 10.0, "{moved:?}");
}

/// The robot's own interpolation between two points: straight in the joints where they are close.
#[test]
fn the_best_plan_of_the_shipped_cell_is_free_at_a_tenth_of_the_step() {
    let bench = shipped();
    let best = cases(&bench)[0].clone();
    let run = stead::Run::read(bench.path(RUN)).unwrap();
    let problem = run.problem();
    let scene = problem.scene.as_deref().unwrap();
    let of = |key: &str| best["placement"][key].as_f64().unwrap();
    let placement =
        Placement { x: of("x_mm") / 1e3, y: of("y_mm") / 1e3, z: of("z_mm") / 1e3, yaw: of("yaw_deg").to_radians() };
    let plan = bench.read("r/best.csv");
    let mut reader = csv::Reader::from_reader(plan.as_bytes());
    let header = reader.headers().unwrap().clone();
    let column = |name: &str| header.iter().position(|column| column == name).unwrap();
    let joints: Vec<usize> = (1..=6).map(|j| column(&format!("theta{j}_deg"))).collect();
    let mut last: Option<(String, [f64; 6])> = None;
    let mut looked = 0;
    for row in reader.records() {
        let row = row.unwrap();
        let segment = row[column("segment")].to_owned();
        let now: [f64; 6] = std::array::from_fn(|j| row[joints[j]].parse::<f64>().unwrap().to_radians());
        if let Some((_, before)) = last.filter(|(known, _)| *known == segment) {
            for k in 0..=10 {
                let at: [f64; 6] = std::array::from_fn(|j| before[j] + f64::from(k) / 10.0 * (now[j] - before[j]));
                let poses = problem.poses(scene, 0, &placement, &at);
                for number in 0..scene.pairs().len() {
                    let (distance, pair) = (scene.distance(number, &poses, 0.05), &scene.pairs()[number]);
                    // Between points nine tenths of the clearance are kept; the table has four decimals.
                    assert!(distance > 0.9 * pair.required - 1e-5, "{pair} {distance}");
                    looked += 1;
                }
            }
        }
        last = Some((segment, now));
    }
    assert!(looked > 50_000, "{looked}");
}

#[test]
fn the_fence_that_holds_the_worst_placement_is_named_with_what_less_clearance_gains() {
    let bench = shipped();
    let worst = |bench: &Bench| cases(bench)[2].clone();
    let here = worst(&bench);
    let bounds = here["active_bounds"].as_array().unwrap();
    let held = bounds.iter().find(|bound| bound["bound"] == "collision.clearance_mm of table and fence front");
    let held = held.unwrap_or_else(|| panic!("{bounds:?}"));
    assert_eq!((held["side"].as_str(), held["unit"].as_str()), (Some("lower"), Some("mm per mm")));
    bench.replace(CELL, "clearance_mm = 10.0", "clearance_mm = 9.0");
    let gained = worst(&bench)["mean_mm"].as_f64().unwrap() - here["mean_mm"].as_f64().unwrap();
    let told = held["gain"].as_f64().unwrap();
    assert!((gained / told - 1.0).abs() < 0.1, "{gained} {told}");
}
