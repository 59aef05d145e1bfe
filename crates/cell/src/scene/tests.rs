use super::*;
use crate::shape::Attachment;
use crate::solid::Solid;
use crate::surroundings::Surroundings;
use crate::testing::{kr270_shapes, scene_of, shape};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stead_model::robot::testing::{kr270, spindle};

fn random_joints(random: &mut ChaCha8Rng) -> [f64; 6] {
    let robot = kr270();
    std::array::from_fn(|j| {
        let joint = &robot.joints()[j];
        joint.min + (joint.max - joint.min) * random.random::<f64>()
    })
}

fn workpiece(random: &mut ChaCha8Rng) -> Pose<f64> {
    let at = |random: &mut ChaCha8Rng, low: f64, high: f64| low + (high - low) * random.random::<f64>();
    let (x, y) = (at(random, -0.5, 0.5), at(random, -2.4, -1.6));
    Pose { translation: Vector3::new(x, y, at(random, -0.6, -0.2)), ..Pose::identity() }
}

#[test]
fn kinds_are_told_apart() {
    let scene = scene_of(kr270_shapes(), 0.01);
    let kind = |a: &str, b: &str| {
        let found =
            scene.pairs().iter().find(|pair| pair.names.iter().any(|n| n == a) && pair.names.iter().any(|n| n == b));
        found.map(|pair| pair.kind)
    };
    assert_eq!(kind("spindle", "part"), Some(PairKind::ToolWorkpiece));
    assert_eq!(kind("part", "fence"), Some(PairKind::WorkpieceCell));
    assert_eq!(kind("upper arm", "spindle"), Some(PairKind::ArmArm));
    assert_eq!(kind("forearm", "pillar"), Some(PairKind::ArmCell));
    assert_eq!(kind("forearm", "part"), Some(PairKind::ArmWorkpiece));
    assert_eq!(kind("elbow", "floor"), Some(PairKind::ArmCell));
    assert_eq!(kind("upper arm", "forearm"), None);
    assert_eq!(kind("pillar", "fence"), None);
    assert_eq!(scene.unchecked_links(), [1, 4, 5]);
}

#[test]
fn what_covers_call_free_is_free_and_clearances_agree() {
    let (scene, mut random) = (scene_of(kr270_shapes(), 0.02), ChaCha8Rng::seed_from_u64(1));
    let (mut hits, mut free, mut saved) = (0, 0, 0);
    for _ in 0..300 {
        let poses = scene.poses(&random_joints(&mut random), &workpiece(&mut random));
        let plain = (0..scene.pairs().len()).find(|pair| {
            let (distance, pair) = (scene.distance(*pair, &poses, FAR), &scene.pairs()[*pair]);
            distance < pair.required || (distance <= 0.0 && pair.required > 0.0)
        });
        assert_eq!(scene.first_hit(&poses, &PairKind::ALL), plain);
        let covered = scene.first_covered_hit(&poses, &PairKind::ALL);
        assert!(covered.is_some() || plain.is_none());
        let clearance = scene.clearance(&poses, &PairKind::ALL).unwrap();
        assert_eq!(clearance.distance < scene.pairs()[clearance.pair].required, plain.is_some());
        hits += usize::from(plain.is_some());
        free += usize::from(plain.is_none());
        saved += usize::from(plain.is_none() && covered.is_some());
    }
    assert!(hits > 50 && free > 30 && saved > 5, "{hits} {free} {saved}");
}

#[test]
fn a_free_motion_is_free_in_small_steps_and_a_hit_is_one() {
    let (scene, mut random) = (scene_of(kr270_shapes(), 0.01), ChaCha8Rng::seed_from_u64(2));
    let (mut hits, mut free) = (0, 0);
    for _ in 0..400 {
        let (from, workpiece) = (random_joints(&mut random), workpiece(&mut random));
        let to: [f64; 6] = std::array::from_fn(|j| from[j] + 0.6 * (random.random::<f64>() - 0.5));
        let at = |share: f64| -> [f64; 6] { std::array::from_fn(|j| from[j] + share * (to[j] - from[j])) };
        if scene.first_hit(&scene.poses(&from, &workpiece), &PairKind::ALL).is_some() {
            continue;
        }
        let [start, end] = [from, to].map(|joints| scene.poses(&joints, &workpiece));
        match scene.motion((&from, &start), (&to, &end)) {
            Some(hit) => {
                hits += 1;
                assert!(!scene.keeps_apart(hit.pair, &scene.poses(&at(hit.share), &workpiece)));
            }
            None => {
                free += 1;
                for k in 0..=200 {
                    let poses = scene.poses(&at(f64::from(k) / 200.0), &workpiece);
                    // Between two states looked at nothing moves farther than the clearance.
                    let clearance = scene.clearance(&poses, &PairKind::ALL).unwrap();
                    assert!(clearance.distance > 0.0, "{clearance:?}");
                }
            }
        }
    }
    assert!(hits > 10 && free > 50, "{hits} {free}");
}

#[test]
fn pairs_that_always_touch_are_named() {
    let mut shapes = kr270_shapes();
    shapes.push(shape("foot", Attachment::Base, Solid::Box(Vector3::new(0.6, 0.6, 0.6)), [0.0, 0.0, -0.8]));
    shapes.push(shape("column", Attachment::Link(1), Solid::Box(Vector3::new(0.4, 0.4, 0.6)), [0.0, 0.0, -0.5]));
    let around = |ignored| Surroundings::new(shapes.clone(), Vec::new(), 0.0, ignored).unwrap();
    let scene = |ignored| Scene::new(&kr270(), &spindle().flange_from_tool, around(ignored));
    let pair = ["column".to_owned(), "foot".to_owned()];
    assert_eq!(scene(Vec::new()).unwrap_err(), SceneError::AlwaysTouching(vec![pair.clone()]));
    assert!(scene(vec![pair]).is_ok());
}
