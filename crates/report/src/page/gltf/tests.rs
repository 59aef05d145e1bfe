//! Scenes read back as a viewer reads them: nodes, tracks and meshes from the bytes alone.

use super::super::shapes::{BodyFrame, BodyMesh};
use super::*;
use crate::Files;
use crate::page::table::Table;
use crate::placement::placement_files;
use crate::testing::{context, outcome, problem};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use serde_json::Value;
use std::f64::consts::FRAC_PI_2;
use stead_model::external_axis::{AxisKind, AxisUse, Carried, ExternalAxis, carried};
use stead_model::robot::Pose;
use stead_planning::course::{MovePart, PlaceOnMove};

/// A file taken apart.
struct Read {
    json: Value,
    bytes: Vec<u8>,
}

impl Read {
    fn new(file: &[u8]) -> Self {
        let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&file[..4], word(4), word(8)), (b"glTF".as_slice(), 2, file.len()));
        let length = word(12);
        assert_eq!((&file[16..20], length % 4), (b"JSON".as_slice(), 0));
        let json = serde_json::from_slice(&file[20..20 + length]).unwrap();
        let rest = 20 + length;
        assert_eq!((&file[rest + 4..rest + 8], word(rest)), (b"BIN\0".as_slice(), file.len() - rest - 8));
        Self { json, bytes: file[rest + 8..].to_vec() }
    }

    /// The numbers of an accessor of floats.
    fn floats(&self, accessor: &Value) -> Vec<f64> {
        let accessor = &self.json["accessors"][accessor.as_u64().unwrap() as usize];
        assert_eq!(accessor["componentType"], 5126);
        let view = &self.json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let at = |key: &str| view[key].as_u64().unwrap() as usize;
        let bytes = &self.bytes[at("byteOffset")..at("byteOffset") + at("byteLength")];
        bytes.chunks(4).map(|four| f64::from(f32::from_le_bytes(four.try_into().unwrap()))).collect()
    }

    fn nodes(&self) -> &Vec<Value> {
        self.json["nodes"].as_array().unwrap()
    }

    fn named(&self, name: &str) -> usize {
        self.nodes().iter().position(|node| node["name"] == name).unwrap()
    }

    /// The transform of a node to the scene, the animation at its key from the start.
    fn world(&self, node: usize, key: usize) -> Isometry3<f64> {
        let numbers =
            |value: &Value| value.as_array().map(|list| list.iter().map(|v| v.as_f64().unwrap()).collect::<Vec<_>>());
        let animation = &self.json["animations"][0];
        let track = animation["channels"].as_array().unwrap().iter().find(|channel| channel["target"]["node"] == node);
        let animated = |path: &str, width: usize| {
            let channel = track.filter(|channel| channel["target"]["path"] == path)?;
            let sampler = &animation["samplers"][channel["sampler"].as_u64().unwrap() as usize];
            Some(self.floats(&sampler["output"])[width * key..width * (key + 1)].to_vec())
        };
        let rotation = animated("rotation", 4).or_else(|| numbers(&self.nodes()[node]["rotation"]));
        let rotation = rotation.map_or_else(UnitQuaternion::identity, |q| {
            UnitQuaternion::from_quaternion(Quaternion::new(q[3], q[0], q[1], q[2]))
        });
        let still = || numbers(&self.nodes()[node]["translation"]).unwrap_or(vec![0.0; 3]);
        let t = animated("translation", 3).unwrap_or_else(still);
        let own = Isometry3::from_parts(Translation3::new(t[0], t[1], t[2]), rotation);
        let is_parent =
            |other: &Value| other["children"].as_array().is_some_and(|list| list.contains(&Value::from(node)));
        match self.nodes().iter().position(is_parent) {
            Some(parent) => self.world(parent, key) * own,
            None => own,
        }
    }

    fn times(&self) -> Vec<f64> {
        self.floats(&self.json["animations"][0]["samplers"][0]["input"])
    }
}

/// The files of a run.
fn files() -> Files {
    placement_files(problem(), outcome(), &context()).unwrap()
}

/// The motion of its best plan.
fn motion_of(files: &Files) -> Motion {
    let bytes = |name: &str| files.iter().find(|(file, _)| file == name).unwrap().1.as_slice();
    let document: Value = serde_json::from_slice(bytes("summary.json")).unwrap();
    let task = &problem().task;
    let steps: Vec<f64> = (0..task.points().len())
        .map(|k| if task.segments().iter().any(|segment| segment.start == k) { 0.0 } else { problem().step_time(k) })
        .collect();
    let plan = Table::read("best.csv", bytes("best.csv")).unwrap();
    let positions: Vec<Vector3<f64>> = task.points().iter().map(|point| point.position).collect();
    kept::motion(&plan, &document["cases"][0], &[], &positions, &steps, &[]).unwrap()
}

/// The column of a CSV file at its last row, in mm.
fn last(csv: &[u8], column: &str) -> f64 {
    let text = std::str::from_utf8(csv).unwrap();
    let at = text.lines().next().unwrap().split(',').position(|name| name == column).unwrap();
    text.lines().last().unwrap().split(',').nth(at).unwrap().parse().unwrap()
}

/// At the end of the animation the tool centre is where the last row of `best.csv` has it, in a scene with y upwards.
#[test]
fn the_tool_ends_where_the_plan_ends() {
    let files = files();
    let read = Read::new(&scene(&files).unwrap());
    let key = read.times().len() - 1;
    let tool = read.world(read.named("tool"), key).translation.vector * 1e3;
    let best = &files.iter().find(|(name, _)| name == "best.csv").unwrap().1;
    let [x, y, z] = ["x_mm", "y_mm", "z_mm"].map(|column| last(best, column));
    let off = (tool - Vector3::new(x, z, -y)).norm();
    assert!(off < 0.1, "{off} mm off: {tool}");
    // And the work lies under it.
    let block = read.world(read.named("block under the path"), key);
    let placed = outcome().cases.best.placement;
    assert!((block.translation.vector - Vector3::new(placed.x, placed.z, -placed.y)).norm() < 1e-6);
}

/// Every key is a posture on the way, at a later time than the one before, and no joint takes a short cut.
#[test]
fn joints_turn_as_in_the_plan() {
    let case = &outcome().cases.best;
    let files = files();
    let motion = motion_of(&files);
    let keys = motion.keys();
    assert!(keys.windows(2).all(|pair| pair[0].time < pair[1].time));
    let turn = |pair: &[motion::Key]| (0..6).map(|j| (pair[1].joints[j] - pair[0].joints[j]).abs()).fold(0.0, f64::max);
    assert!(keys.windows(2).map(turn).fold(0.0, f64::max) < FRAC_PI_2 + 1e-9);
    for point in &case.plan.points {
        let is_there = |key: &motion::Key| (0..6).all(|j| (key.joints[j] - point.joints[j]).abs() < 2e-6);
        assert!(keys.iter().any(is_there), "point {}", point.point);
    }
    let read = Read::new(&scene(&files).unwrap());
    assert_eq!(read.times().len(), keys.len());
    let tool = read.named("tool");
    for (key, expected) in keys.iter().enumerate().step_by(17) {
        let flange = problem().robot.forward(&expected.joints);
        let tip = flange.then(&problem().spindle.flange_from_tool).translation;
        let found = read.world(tool, key).translation.vector;
        assert!((found - Vector3::new(tip.x, tip.z, -tip.y)).norm() < 1e-4, "key {key}");
    }
    // The cut and the moves between segments, as the document states them.
    let moves: f64 = case.cycle.transfers.iter().map(|transfer| transfer.duration.unwrap()).sum();
    let (end, expected) = (motion.stops.last().unwrap().time, case.cycle.cutting + moves);
    assert!((end - expected).abs() < 1e-3, "{end} s instead of {expected} s");
}

/// A joint that turns by 350 deg between two segments goes all the way round.
#[test]
fn long_turns_go_the_long_way_round() {
    let stop = |turn: f64, segment: usize, time: f64| Stop {
        joints: [0.0, 0.0, 0.0, turn, 0.0, 0.0],
        axes: Vec::new(),
        position: Vector3::new(time, 0.0, 0.0),
        segment,
        score: 1e-4,
        time,
        way: Vec::new(),
    };
    let motion = Motion {
        name: String::new(),
        stops: vec![stop(0.0, 1, 0.0), stop(6.1, 2, 1.0), stop(-6.1, 2, 2.0), stop(-6.1, 2, 2.0)],
    };
    let keys = motion.keys();
    let turns: Vec<f64> = keys.windows(2).map(|pair| pair[1].joints[3] - pair[0].joints[3]).collect();
    assert!(turns.iter().all(|turn| turn.abs() < FRAC_PI_2) && keys.windows(2).all(|pair| pair[0].time < pair[1].time));
    assert!((turns.iter().filter(|turn| **turn > 0.0).sum::<f64>() - 6.1).abs() < 1e-12);
    assert_eq!(keys.last().unwrap().joints[3], -6.1);
}

/// A move that goes a way goes through all of its places, each part in its share of the time, and stands still where
/// parts meet.
#[test]
fn moves_go_their_way() {
    let place = |turn: f64, at: f64| PlaceOnMove { joints: [turn, 0.0, 0.0, 0.0, 0.0, 0.0], axes: vec![at] };
    let stop = |turn: f64, segment: usize, time: f64, way: Vec<MovePart>| Stop {
        joints: [turn, 0.0, 0.0, 0.0, 0.0, 0.0],
        axes: vec![0.0],
        position: Vector3::new(time, 0.0, 0.0),
        segment,
        score: 1e-4,
        time,
        way,
    };
    let line = vec![place(0.0, 0.0), place(0.1, 0.0), place(0.3, 0.0)];
    let way = vec![
        MovePart { places: line, time_share: 0.25 },
        MovePart { places: vec![place(0.3, 0.0), place(-2.0, 0.5)], time_share: 0.75 },
    ];
    let stops = vec![stop(0.0, 1, 0.0, Vec::new()), stop(0.0, 1, 2.0, Vec::new()), stop(-2.0, 2, 6.0, way)];
    let keys = Motion { name: String::new(), stops }.keys();
    let at = |time: f32| keys.iter().find(|key| (key.time - time).abs() < 1e-6).map(|key| (key.joints[0], key.axes[0]));
    assert_eq!((at(0.0), at(2.0), at(2.5)), (Some((0.0, 0.0)), Some((0.0, 0.0)), Some((0.1, 0.0))));
    assert_eq!(at(3.0), Some((0.3, 0.0)));
    let (turn, along) = at(6.0).unwrap();
    assert!((turn + 2.0).abs() < 1e-12 && (along - 0.5).abs() < 1e-12, "{turn} {along}");
    assert!(keys.windows(2).all(|pair| pair[0].time < pair[1].time));
    let first = keys.iter().find(|key| key.time > 3.0).unwrap();
    assert!(first.joints[0] > 0.27, "it starts at {first:?}");
}

/// A long path is thinned, with the ends of its segments.
#[test]
fn long_paths_are_thinned() {
    let stops = (0..50_000).map(|k| Stop {
        joints: [k as f64 * 1e-5; 6],
        axes: Vec::new(),
        position: Vector3::new(k as f64 * 1e-3, 0.0, 0.0),
        segment: 1 + k / 20_000,
        score: 1e-4,
        time: k as f64,
        way: Vec::new(),
    });
    let motion = Motion { name: String::new(), stops: stops.collect() };
    let shown = motion.shown();
    assert!(shown.len() <= motion::MAX_STOPS && shown.len() > motion::MAX_STOPS / 2, "{}", shown.len());
    for end in [0, 19_999, 20_000, 39_999, 40_000, 49_999] {
        assert!(shown.contains(&motion.stops[end]));
    }
}

/// What is stated of each list of numbers holds, and the same scene gives the same bytes.
#[test]
fn scenes_are_consistent() {
    let file = scene(&files()).unwrap();
    assert_eq!(file, scene(&files()).unwrap());
    let read = Read::new(&file);
    assert!(file.len() < 1_000_000, "{} bytes", file.len());
    let mut attributes = Vec::new();
    for mesh in read.json["meshes"].as_array().unwrap() {
        for primitive in mesh["primitives"].as_array().unwrap() {
            let count = |accessor: &Value| read.json["accessors"][accessor.as_u64().unwrap() as usize]["count"].clone();
            let list: Vec<&Value> = primitive["attributes"].as_object().unwrap().values().collect();
            assert!(list.iter().all(|accessor| count(accessor) == count(list[0])), "{}", mesh["name"]);
            attributes.push(list.len());
        }
    }
    // Only the path has colours of its own.
    assert_eq!(attributes.iter().filter(|count| **count == 3).count(), 1);
    let illustrations = read.nodes().iter().filter(|node| node["extras"]["is_illustration"] == true);
    assert_eq!(illustrations.count(), crate::page::bodies(problem()).len() + 1);
}

/// A rail with the robot and a tilting table with the part: what they carry is where the model has it, all along the
/// animation.
#[test]
fn external_axes_move_what_they_carry() {
    let axis =
        |name: &str, kind: AxisKind, carries: Carried, direction: Vector3<f64>, point: Vector3<f64>| ExternalAxis {
            name: name.to_owned(),
            kind,
            carries,
            direction,
            point,
            min: -2.0,
            max: 2.0,
            max_speed: None,
            axis_use: AxisUse::Continuous,
        };
    let axes = [
        axis("tilt", AxisKind::Turntable, Carried::Workpiece, Vector3::y(), Vector3::new(1.7, 0.0, 0.6)),
        axis("rail", AxisKind::Rail, Carried::Robot, Vector3::x(), Vector3::zeros()),
        axis("turn", AxisKind::Turntable, Carried::Workpiece, Vector3::z(), Vector3::new(1.7, 0.2, 0.0)),
    ];
    let positions = [[0.0, 0.0, 0.0], [0.4, -0.5, 0.3], [-0.7, 1.2, 3.0]];
    let stop = |(k, at): (usize, &[f64; 3])| Stop {
        joints: [0.0; 6],
        axes: at.to_vec(),
        position: Vector3::new(k as f64, 0.0, 0.0),
        segment: 1,
        score: 1e-4,
        time: k as f64,
        way: Vec::new(),
    };
    let motion = Motion { name: String::new(), stops: positions.iter().enumerate().map(stop).collect() };
    let plate = |frame: BodyFrame, name: &str| BodyMesh {
        name: name.to_owned(),
        frame,
        color: [0.5; 3],
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        is_illustration: false,
    };
    let bodies = [
        plate(BodyFrame::Axis(0), "cradle"),
        plate(BodyFrame::Axis(1), "carriage"),
        plate(BodyFrame::Axis(2), "platter"),
        plate(BodyFrame::Cell, "fence"),
    ];
    let mount = Pose { translation: Vector3::new(0.0, 0.0, 0.8), ..Pose::identity() };
    let placed = Pose { translation: Vector3::new(1.7, 0.1, 0.9), ..Pose::identity() };
    let file = glb(&Cell {
        name: "cell",
        rows: [Pose::identity(); 6],
        flange_from_tool: Pose::identity(),
        mount,
        axes: &axes,
        cell_from_workpiece: placed,
        bodies: &bodies,
        motion: &motion,
    });
    let read = Read::new(&file);
    let times = read.times();
    for (k, at) in positions.iter().enumerate() {
        let key = times.iter().position(|time| *time == k as f64).unwrap();
        let on = |what: Carried, count: usize| carried(&axes[..count], at, what);
        let expected = [
            ("cradle", on(Carried::Workpiece, 1)),
            ("carriage", on(Carried::Robot, 3)),
            ("platter", on(Carried::Workpiece, 3)),
            ("workpiece", on(Carried::Workpiece, 3).then(&placed)),
            ("tool path", on(Carried::Workpiece, 3).then(&placed)),
            ("tool", on(Carried::Robot, 3).then(&mount)),
            ("fence", Pose::identity()),
        ];
        for (name, pose) in expected {
            let found = read.world(read.named(name), key);
            for corner in [Vector3::zeros(), Vector3::x(), Vector3::y()] {
                let (is, due) = (found * nalgebra::Point3::from(corner), pose.point(&corner));
                let off = (is.coords - Vector3::new(due.x, due.z, -due.y)).norm();
                assert!(off < 1e-5, "{name} is {off} m off at stop {k}");
            }
        }
    }
    // What stands in the cell is seen through.
    let material = |name: &str| {
        let node = &read.nodes()[read.named(name)];
        let mesh = &read.json["meshes"][node["mesh"].as_u64().unwrap() as usize];
        read.json["materials"][mesh["primitives"][0]["material"].as_u64().unwrap() as usize]["alphaMode"].clone()
    };
    assert_eq!((material("fence"), material("platter")), ("BLEND".into(), Value::Null));
}

/// Links that are no illustrations are drawn; collision shapes about them are not.
#[test]
fn real_links_are_drawn_and_their_collision_shapes_are_not() {
    let mut files = files();
    let (_, bytes) = files.iter_mut().find(|(name, _)| name == "page-data.json").unwrap();
    let mut data: Value = serde_json::from_slice(bytes).unwrap();
    let arm = data["bodies"].as_array_mut().unwrap().iter_mut().find(|body| body["frame"] == "link_2").unwrap();
    arm["is_illustration"] = false.into();
    arm["name"] = "real link".into();
    let mut cover = arm.clone();
    cover["name"] = "cover".into();
    data["surroundings"].as_array_mut().unwrap().push(cover);
    *bytes = data.to_string().into_bytes();
    let read = Read::new(&scene(&files).unwrap());
    let is_there = |name: &str| read.nodes().iter().any(|node| node["name"] == name);
    assert!(is_there("real link") && !is_there("cover"));
    assert!(read.nodes()[read.named("real link")]["extras"].is_null());
}
