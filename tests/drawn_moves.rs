//! Moves between segments as `cell.glb` draws them: as free as the plan has them.

use crate::collision::{RUN, shipped};
use serde_json::Value;
use std::f64::consts::TAU;
use stead_cell::Scene;
use stead_problem::problem::{Placement, Problem};

type Joints = [f64; 6];

/// Joint angles at the keys of the animation, from the bytes of the file: from key to key the short way round. rad
fn drawn(file: &[u8]) -> Vec<Joints> {
    let length = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
    let json: Value = serde_json::from_slice(&file[20..20 + length]).unwrap();
    let numbers = |accessor: &Value| -> Vec<f64> {
        let view = &json["accessors"][accessor.as_u64().unwrap() as usize]["bufferView"];
        let view = &json["bufferViews"][view.as_u64().unwrap() as usize];
        let [from, size] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
        let bytes = &file[28 + length + from..28 + length + from + size];
        bytes.chunks(4).map(|four| f64::from(f32::from_le_bytes(four.try_into().unwrap()))).collect()
    };
    let animation = &json["animations"][0];
    let angles = |joint: usize| {
        let node = json["nodes"].as_array().unwrap().iter().position(|node| node["name"] == format!("joint {joint}"));
        let channels = animation["channels"].as_array().unwrap();
        let channel = channels.iter().find(|channel| channel["target"]["node"] == node.unwrap()).unwrap();
        let turns = numbers(&animation["samplers"][channel["sampler"].as_u64().unwrap() as usize]["output"]);
        let mut last = 0.0;
        let unwound = turns.chunks(4).map(|turn| {
            let change = 2.0 * libm::atan2(turn[2], turn[3]) - last;
            last += change - TAU * (change / TAU).round();
            last
        });
        unwound.collect::<Vec<f64>>()
    };
    let all = [1, 2, 3, 4, 5, 6].map(angles);
    (0..all[0].len()).map(|key| std::array::from_fn(|j| all[j][key])).collect()
}

/// The least distance of two shapes on joint moves from each of these places to the next, in steps of 0.02 rad at the
/// most. m
fn least(problem: &Problem, placement: &Placement, places: &[Joints]) -> f64 {
    let scene: &Scene = problem.scene.as_deref().unwrap();
    let mut least = f64::INFINITY;
    for pair in places.windows(2) {
        let turns: Joints = std::array::from_fn(|j| pair[1][j] - pair[0][j]);
        let largest = turns.iter().fold(0.0_f64, |largest, turn| largest.max(turn.abs()));
        let steps = (largest / 0.02).ceil().max(1.0);
        for step in 0..=steps as usize {
            let at: Joints = std::array::from_fn(|j| pair[0][j] + turns[j] * step as f64 / steps);
            let poses = problem.poses(scene, 0, placement, &at);
            let apart = (0..scene.pairs().len()).map(|number| scene.distance(number, &poses, 1.0));
            least = least.min(apart.fold(f64::INFINITY, f64::min));
        }
    }
    least
}

#[test]
fn the_animation_keeps_as_free_as_the_plan() {
    let bench = shipped();
    let ended = bench.stead(&["place", RUN, "--json", "--out", "r"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let best = ended.json()["cases"][0].clone();
    let run = stead::Run::read(bench.path(RUN)).unwrap();
    let of = |key: &str| best["placement"][key].as_f64().unwrap();
    let placement =
        Placement { x: of("x_mm") / 1e3, y: of("y_mm") / 1e3, z: of("z_mm") / 1e3, yaw: of("yaw_deg").to_radians() };
    let least = |places: &[Joints]| least(run.problem(), &placement, places);
    let joints = |value: &Value| -> Joints { std::array::from_fn(|j| value[j].as_f64().unwrap().to_radians()) };
    let list = |value: &Value| -> Vec<Joints> { value.as_array().unwrap().iter().map(joints).collect() };
    // The cut, and the joint moves between the ends of the lines out of it and into it; where these end is on both.
    let rows: Vec<(u64, Joints)> = best["plan"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| (row["segment"].as_u64().unwrap(), joints(&row["joints_deg"])))
        .collect();
    let cut = rows.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| least(&[pair[0].1, pair[1].1]));
    let mut planned = cut.fold(f64::INFINITY, f64::min);
    let mut straight = f64::INFINITY;
    for transfer in best["transfers"].as_array().unwrap() {
        assert_eq!(transfer["blocked_by"], Value::Null);
        let way = list(&transfer["joints_deg"]);
        let [first, last] = [usize::from(transfer["retracts"] == true), usize::from(transfer["approaches"] == true)];
        planned = planned.min(least(&way[first..way.len() - last]));
        straight = straight.min(least(&[way[0], way[way.len() - 1]]));
    }
    let drawn = least(&drawn(bench.tree("r")["cell.glb"].as_ref().unwrap()));
    // Joint angles have four decimals in deg, keys single precision.
    assert!((drawn - planned).abs() < 2e-5, "{drawn} m along the animation, {planned} m along the plan");
    assert!(planned > 5e-3 && straight < planned - 5e-3, "{planned} m on the way, {straight} m straight over");
}
