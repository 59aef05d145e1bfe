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

/// Of pairs that touch the deepest is told, wherever it stands in the list.
#[test]
fn the_deepest_pair_is_told() {
    let wall = |name: &str, depth: f64| {
        // The part is a box of 0.4 by 0.5 by 0.2 m; walls lie in it from one side and from above.
        let edges = Vector3::new(0.3, 0.3, 0.3);
        let at = if name == "side" { [0.2 + 0.15 - depth, 0.0, -0.1] } else { [0.0, 0.0, 0.15 - depth] };
        shape(name, Attachment::Base, Solid::Box(edges), at)
    };
    let part = || shape("part", Attachment::Workpiece, Solid::Box(Vector3::new(0.4, 0.5, 0.2)), [0.0, 0.0, -0.1]);
    for (side, top, deepest) in [(0.05, 0.02, "side"), (0.02, 0.05, "top"), (0.021, 0.02, "side"), (0.02, 0.021, "top")]
    {
        for turned in [false, true] {
            let mut walls = vec![wall("side", side), wall("top", top)];
            if turned {
                walls.reverse();
            }
            let scene = scene_of(walls.into_iter().chain([part()]).collect(), 0.01);
            let poses = scene.poses(&[0.0; 6], &Pose::identity());
            let found = scene.deepest(&poses, &[PairKind::WorkpieceCell]).unwrap();
            let names = &scene.pairs()[found.pair].names;
            assert!(found.distance == 0.0 && names.iter().any(|name| name == deepest), "{names:?} {side} {top}");
        }
    }
    let apart = scene_of(vec![wall("side", -0.02), wall("top", -0.005), part()], 0.01);
    let poses = apart.poses(&[0.0; 6], &Pose::identity());
    let kinds = [PairKind::WorkpieceCell];
    assert_eq!(apart.deepest(&poses, &kinds), apart.clearance(&poses, &kinds));
    assert!(apart.deepest(&poses, &kinds).unwrap().distance > 0.004);
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

/// A path of states: small steps, and now and then a jump.
fn path(random: &mut ChaCha8Rng, steps: usize) -> Vec<[f64; 6]> {
    let mut joints = random_joints(random);
    let mut path = vec![joints];
    for step in 1..steps {
        if step % 40 == 0 {
            joints = random_joints(random);
        } else {
            joints.iter_mut().for_each(|angle| *angle += 0.05 * (random.random::<f64>() - 0.5));
        }
        path.push(joints);
    }
    path
}

#[test]
fn what_is_known_of_the_state_before_changes_no_answer() {
    for (seed, clearance) in [(3, 0.0), (4, 0.01), (5, 0.05)] {
        let (scene, mut random) = (scene_of(kr270_shapes(), clearance), ChaCha8Rng::seed_from_u64(seed));
        let workpiece = workpiece(&mut random);
        let (mut known, mut hits, mut free) = (Proximity::default(), 0, 0);
        for joints in path(&mut random, 2000) {
            let poses = scene.poses(&joints, &workpiece);
            let plain = (0..scene.pairs().len()).find(|number| {
                PairKind::OF_STATES.contains(&scene.pairs()[*number].kind) && !scene.keeps_apart(*number, &poses)
            });
            let found = scene.next_hit(&mut known, &poses, &PairKind::OF_STATES);
            match (plain, found) {
                // Any pair that hits may be named.
                (_, Some(found)) => assert!(!scene.keeps_apart(found, &poses)),
                (Some(number), None) => {
                    // GJK on round surfaces: 0.01 mm.
                    let (distance, required) = (scene.distance(number, &poses, FAR), scene.pairs()[number].required);
                    assert!(distance > required - 1e-5 && required > 0.0, "{distance} {required}");
                }
                (None, None) => {}
            }
            hits += usize::from(found.is_some());
            free += usize::from(found.is_none());
        }
        assert!(hits > 200 && free > 100, "{hits} {free}");
    }
}

#[test]
fn a_path_called_free_by_what_is_known_is_free_in_small_steps() {
    let (scene, mut random) = (scene_of(kr270_shapes(), 0.01), ChaCha8Rng::seed_from_u64(6));
    let workpiece = workpiece(&mut random);
    let (mut known, mut free, mut hits) = (Proximity::default(), 0, 0);
    let mut before: Option<([f64; 6], Poses)> = None;
    for (step, joints) in path(&mut random, 1200).into_iter().enumerate() {
        let poses = scene.poses(&joints, &workpiece);
        let is_free = scene.next_hit(&mut known, &poses, &PairKind::OF_STATES).is_none();
        let last = before.replace((joints, poses)).filter(|_| is_free && step % 40 != 0);
        let Some((from, start)) = last else {
            before = before.filter(|_| is_free);
            continue;
        };
        let hit = scene.motion_to(&known, (&from, &start), (&joints, &poses));
        let plain = scene.motion((&from, &start), (&joints, &poses));
        hits += usize::from(hit.is_some());
        free += usize::from(hit.is_none());
        // Both are good to a tenth of the clearance where a motion comes just so near.
        if let (None, Some(plain)) | (Some(plain), None) = (hit, plain) {
            let at: [f64; 6] = std::array::from_fn(|j| from[j] + plain.share * (joints[j] - from[j]));
            assert!(scene.distance(plain.pair, &scene.poses(&at, &workpiece), FAR) > 0.008);
        }
        if hit.is_none() {
            for k in 0..=20 {
                let at: [f64; 6] = std::array::from_fn(|j| from[j] + f64::from(k) / 20.0 * (joints[j] - from[j]));
                let clearance = scene.clearance(&scene.poses(&at, &workpiece), &PairKind::OF_STATES).unwrap();
                assert!(clearance.distance > 0.005, "{clearance:?}");
            }
        }
    }
    assert!(free > 50 && hits + free > 100, "{hits} {free}");
}

#[test]
fn what_an_axis_carries_moves_on_an_arc() {
    let platter = shape("platter", Attachment::Axis(0), Solid::Box(Vector3::new(0.2, 0.2, 0.2)), [1.0, 0.0, 0.0]);
    let post = shape("post", Attachment::Base, Solid::Box(Vector3::new(0.1, 0.1, 1.0)), [0.0, 1.0, 0.0]);
    let arm = shape("arm", Attachment::Link(2), Solid::Capsule { radius: 0.05, length: 0.1 }, [0.0, 0.0, 0.0]);
    let around = Surroundings::new(vec![platter, post, arm], Vec::new(), 0.0, Vec::new()).unwrap();
    let scene = Scene::new(&kr270(), &spindle().flange_from_tool, around).unwrap();
    let joints = [0.0; 6];
    let at = |degrees: f64| {
        let turn = stead_numerics::rotation::rotation_from_vector(&Vector3::new(0.0, 0.0, degrees.to_radians()));
        let pose = Pose { rotation: turn, translation: Vector3::zeros() };
        scene.poses(&joints, &Pose::identity()).with_axis(0, pose)
    };
    // Over the chord from one side to the other it would pass the post at a distance of 0.3 m.
    let hit = scene.motion((&joints, &at(30.0)), (&joints, &at(150.0))).unwrap();
    assert!((hit.share - 0.5).abs() < 0.2, "{hit:?}");
    assert_eq!(scene.motion((&joints, &at(-30.0)), (&joints, &at(60.0))), None);
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

#[test]
fn the_change_of_a_room_is_that_of_the_distance_to_first_order() {
    let (scene, mut random) = (scene_of(kr270_shapes(), 0.01), ChaCha8Rng::seed_from_u64(7));
    let (mut compared, mut changed) = (0, 0);
    for _ in 0..3000 {
        let (joints, workpiece) = (random_joints(&mut random), workpiece(&mut random));
        let poses = scene.poses(&joints, &workpiece);
        if scene.first_hit(&poses, &PairKind::ALL).is_some() {
            continue;
        }
        let turned: [f64; 6] = std::array::from_fn(|j| joints[j] + 8e-4 * (random.random::<f64>() - 0.5));
        let turned = scene.poses(&turned, &workpiece);
        for near in scene.near(&poses, &PairKind::ALL, 0.1) {
            let room = |poses: &Poses| scene.distance(near.pair, poses, FAR) - scene.pairs()[near.pair].required;
            // GJK ends at some micrometres on round surfaces.
            let rounding = 1e-5;
            assert!((near.room - room(&poses)).abs() < rounding && near.room < 0.1);
            let (change, real) = (scene.room_change(&near, &poses, &turned), room(&turned) - near.room);
            assert!((change - real).abs() < 2.0 * rounding, "{near:?} {change} {real}");
            compared += 1;
            changed += usize::from(real.abs() > 5.0 * rounding);
        }
    }
    assert!(compared > 300 && changed > 20, "{compared} {changed}");
}
