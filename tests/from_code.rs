//! The published case built in code, without a file, against the command on its files.

use crate::common::{Bench, RUN};
use serde_json::Value;
use stead::certify::CertificateSettings;
use stead::model::nalgebra::{Matrix3, Vector3, vector};
use stead::model::published::Published;
use stead::model::robot::{Controller, ControllerKind, Joint, Pose, Robot, Spindle, SpringModel, angles::yaw_from_q4};
use stead::model::task::{PathPoint, Task, ToolPath, Wrench};
use stead::placement::criterion::Aggregate;
use stead::placement::postures::PostureRules;
use stead::placement::{Cell, Constraints, Interval, LookupUse, PostureSearch, Problem, Redundancy};
use stead::{Monitor, PlaceOptions, Run};

/// The KUKA KR270-2 of Caro et al. 2013. Rows: alpha in deg, a and d in mm, limits in deg, speed in deg/s, stiffness in
/// MN m/rad.
fn robot() -> Robot {
    let rows = [
        (0.0, 0.0, 0.0, -185.0, 185.0, 86.0, 0.237),
        (90.0, 350.0, 0.0, 0.0, 146.0, 84.0, 3.32),
        (0.0, 1250.0, 0.0, -245.0, 29.0, 84.0, 2.79),
        (-90.0, 55.0, 1100.0, -350.0, 350.0, 100.0, 0.486),
        (90.0, 0.0, 0.0, -125.0, 125.0, 110.0, 0.521),
        (-90.0, 0.0, 0.0, -350.0, 350.0, 184.0, 0.38),
    ];
    let rows = rows.map(|(alpha, a, d, min, max, speed, stiffness): (f64, f64, f64, f64, f64, f64, f64)| Joint {
        alpha: alpha.to_radians(),
        a: a / 1e3,
        d: d / 1e3,
        min: min.to_radians(),
        max: max.to_radians(),
        max_speed: Some(speed.to_radians()),
        max_acceleration: None,
        max_jerk: None,
        compliance: (1e-6 / stiffness).into(),
    });
    let controller = Controller {
        kind: ControllerKind::Kuka,
        sign: [-1.0; 6],
        offset: [0.0, 0.0, -90.0, 0.0, 0.0, 0.0].map(f64::to_radians),
        is_j3_level: None,
        root_from_base: Some(Pose { rotation: Matrix3::identity(), translation: vector![0.0, 0.0, 0.75] }),
    };
    let robot = Robot::new("KUKA KR270-2", rows).unwrap().with_flange(0.23);
    robot.with_controller(controller).with_spring_model(Some(SpringModel::Axes))
}

/// Five segments of 21 points, a staircase down and to the right. Corners in tenths of a millimetre.
fn task() -> Task {
    let corners = [[-1920, 4000], [-1920, 2080], [80, 2080], [80, 80], [2080, 80], [2080, -2000]]
        .map(|place| place.map(f64::from));
    let mut points = Vec::new();
    let mut wrenches = Vec::new();
    for (ends, segment) in corners.windows(2).zip(1..) {
        let along = [0, 1].map(|axis| ends[1][axis] - ends[0][axis]);
        let is_down = along[0] == 0.0;
        for point in 0..21 {
            let place = [0, 1].map(|axis| (ends[0][axis] + along[axis] / 20.0 * f64::from(point)) / 10.0);
            let feed = if is_down { vector![0.0, -1.0, 0.0] } else { Vector3::x() };
            let position = vector![place[0], place[1], 0.0] * 1e-3;
            points.push((segment, PathPoint { position, feed, axis: Vector3::z() }));
            // The wall that the cutter leaves, and the corners that it comes into on the way down.
            let [x, y] = match (is_down, segment, point) {
                (false, ..) => [-91.647810, -22.904457],
                (true, 1, 19) => [-19.340714, 109.536309],
                (true, 1 | 3, 20) => [327.324282, 207.324282],
                (true, ..) => [-22.904457, 91.647810],
            };
            wrenches.push(Wrench { force: vector![x, y, 0.0], moment: Vector3::zeros() });
        }
    }
    Task::new(ToolPath::new(points).unwrap(), wrenches).unwrap()
}

/// Caro et al. 2013, equations 6, 9 and 22 to 27.
fn problem(beta_count: usize) -> Problem {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let rotation = Matrix3::new(0.0, -half, half, 1.0, 0.0, 0.0, 0.0, half, half);
    let spindle = Spindle::new(rotation, vector![0.0, 0.0, 0.684]).unwrap();
    let range = |[min, max]: [f64; 2]| Interval { min, max };
    let position = [[-0.3, 0.3], [-2.24, -1.64], [-0.602, -0.214]].map(range);
    let cell = Cell { position, yaw: range([-1.0, 1.0].map(yaw_from_q4)) };
    let max_beta_rate = Some(0.9_f64.to_radians() * 1e3);
    let redundancy = Redundancy { max_beta_rate, ..Redundancy::new(beta_count, 66.667 / 1e3) };
    let mut parts = Problem::builder(robot(), spindle, task(), cell, redundancy);
    parts.constraints =
        Constraints { min_inverse_condition: 0.2, characteristic_length: 0.682, ..Constraints::default() };
    parts.postures = PostureRules::NONE;
    parts.build().unwrap()
}

/// A document without what is of files alone: their names and digests, what the run file states, and that there are
/// none.
fn of_any_origin(text: &str) -> Value {
    let mut document: Value = serde_json::from_str(text).unwrap();
    let keys = document.as_object_mut().unwrap();
    assert!(keys.remove("inputs").is_some());
    keys.remove("run_file");
    for key in ["notes", "computed_notes"] {
        if let Some(notes) = keys.get_mut(key).and_then(Value::as_array_mut) {
            notes.retain(|note| !note.as_str().unwrap().contains("comes from a program"));
        }
    }
    document
}

#[test]
fn the_published_case_from_code_gives_the_bytes_of_the_command() {
    let bench = Bench::new();
    bench.replace(RUN, "beta_step_deg = 7.2", "beta_step_deg = 3.0");
    let ended = bench.stead(&["place", RUN, "--out", "out"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);

    let problem = problem(120);
    assert_eq!(problem, *Run::read(bench.path(RUN)).unwrap().problem());
    let mut options = PlaceOptions::default();
    (options.search.population, options.search.generations, options.search.basins) = (16, 3, 2);
    let source = "Caro et al. 2013, Table III".to_owned();
    let reference = Published { source, figures: [0.083, 0.35, 0.82, 1.2] };
    let run = Run::builder(problem).options(options).reference(reference).build().unwrap();
    run.place(&Monitor::silent()).unwrap().write(bench.path("mine")).unwrap();

    assert_eq!(bench.names("mine"), bench.names("out"));
    for name in bench.names("out") {
        let [ours, theirs] = ["mine", "out"].map(|folder| std::fs::read(bench.path(folder).join(&name)).unwrap());
        match name.as_str() {
            // Digests of the documents, those of the inputs, and the page of them.
            "manifest.json" | "report.html" | "setup.svg" => {}
            "summary.json" | "page-data.json" => {
                let [ours, theirs] = [ours, theirs].map(|bytes| of_any_origin(std::str::from_utf8(&bytes).unwrap()));
                assert!(ours == theirs, "{name} differs");
            }
            "notes.txt" => {
                let [ours, theirs] = [ours, theirs].map(|bytes| String::from_utf8(bytes).unwrap());
                let is_of_both = |line: &&str| !line.contains("comes from a program");
                assert!(ours.lines().filter(is_of_both).eq(theirs.lines()), "{name} differs");
            }
            name => assert!(ours == theirs, "{name} differs"),
        }
    }
}

#[test]
fn options_out_of_range_are_refused_in_one_line() {
    let problem = problem(50);
    let refused = |problem: &Problem, change: &dyn Fn(&mut PlaceOptions)| {
        let mut options = PlaceOptions { certificate: Some(CertificateSettings::new(0.01)), ..PlaceOptions::default() };
        change(&mut options);
        let error = Run::builder(problem.clone()).options(options).build().unwrap_err();
        assert!(error.is_bad_input());
        error.to_string()
    };
    for (change, message) in [
        (
            &(|o: &mut PlaceOptions| o.search.population = 3) as &dyn Fn(&mut PlaceOptions),
            "search.population of PlaceOptions is 3",
        ),
        (&|o| o.search.population = usize::MAX, "search.population of PlaceOptions is 1844"),
        (&|o| o.search.generations = 100_001, "search.generations of PlaceOptions is 100001; allowed: 0 to 100000"),
        (&|o| o.search.basins = 0, "search.basins of PlaceOptions is 0; allowed: 1 to 64"),
        (&|o| o.search.path_points = Some(0), "search.path_points of PlaceOptions is 0; allowed: 1 to"),
        (&|o| o.search.path_points = Some(4), "search.path_points of PlaceOptions is 4; allowed: 5 (segments) to 105"),
        (&|o| o.search.sensitivity = Some(1.0), "search.sensitivity of PlaceOptions is 1; allowed: above 0"),
        (&|o| o.search.sensitivity = Some(f64::NAN), "search.sensitivity of PlaceOptions is NaN"),
        (&|o| o.transfer.acceleration_time = 0.0, "transfer.acceleration_time of PlaceOptions is 0; allowed: a finite"),
        (&|o| o.transfer.jerk_time = f64::INFINITY, "transfer.jerk_time of PlaceOptions is inf; allowed: a finite"),
        (&|o| o.transfer.blend = -0.1, "transfer.blend of PlaceOptions is -0.1; allowed: 0 to 1 m"),
        (
            &|o| o.certificate = Some(CertificateSettings::new(1.0)),
            "certificate.gap of PlaceOptions is 1; allowed: 1e-6",
        ),
        (
            &|o| o.certificate.as_mut().unwrap().time_limit = Some(-1.0),
            "certificate.time_limit of PlaceOptions is -1; allowed: a finite",
        ),
        (&|o| o.certificate.as_mut().unwrap().memory = 0, "certificate.memory of PlaceOptions is 0; allowed: 1e6 to"),
    ] {
        let found = refused(&problem, change);
        assert!(found.starts_with(message) && found.lines().count() == 1, "{found}");
    }
    // What only some problems allow.
    let largest = problem.changed(|parts| parts.criterion.aggregate = Aggregate::Max).unwrap();
    assert!(refused(&largest, &|o| o.search.tables = LookupUse::Always).contains("is Always; allowed: Auto or Never"));
    let one_posture = problem.changed(|parts| parts.postures.may_change = false).unwrap();
    let found = refused(&one_posture, &|o| o.search.postures = PostureSearch::Genetic);
    assert!(found.contains("search.postures of PlaceOptions is Genetic; allowed: Exact"), "{found}");
}
