use super::*;
use nalgebra::vector;
use proptest::prelude::*;
use stead_model::robot::Frames;
use stead_model::robot::testing::{kr270, odd_arms, spindle};
use stead_model::stiffness::equilibrium::{Load, displaced, equilibrium};
use stead_numerics::rotation::rotation_vector;

/// The path of a job that nobody stops.
fn compensate(job: &CompensationProblem) -> CompensatedPath {
    super::compensate(job, &Monitor::silent()).unwrap()
}

/// The station at which an arm stands with joint angles `theta`, under a wrench.
fn path_point(robot: &Robot, theta: &[f64; 6], wrench: [f64; 6]) -> PathPoint {
    let [fx, fy, fz, mx, my, mz] = wrench;
    PathPoint {
        segment: 1,
        base_from_tool: robot.forward(theta).then(&spindle().flange_from_tool),
        posture: Posture::of(robot, theta),
        joints: *theta,
        force: vector![fx, fy, fz],
        moment: vector![mx, my, mz],
        of_part: Vector3::zeros(),
        free_fall: vector![0.0, 0.0, -9.81],
        normal: vector![0.6, 0.0, 0.8],
    }
}

fn job(robot: &Robot, reality: &Robot, points: Vec<PathPoint>) -> CompensationProblem {
    CompensationProblem {
        robot: robot.clone(),
        reality: reality.clone(),
        spindle: spindle(),
        points,
        settings: Settings::default(),
    }
}

/// The same arm with all compliances larger by a factor.
fn softer(robot: &Robot, factor: f64) -> Robot {
    let compliances = robot.constant_compliances().unwrap();
    robot.with_compliances(compliances.map(|c| c * factor)).unwrap()
}

/// An arm in the middle of its workspace.
const MIDDLE: [f64; 6] = [0.3, 0.9, -2.1, 0.4, 1.1, 5.0];
const CUT: [f64; 6] = [120.0, -340.0, 210.0, 3.0, -8.0, 5.0];
/// A moment that the arm bears, and that a thousand times as large makes it give way.
const TWIST: [f64; 6] = [0.0, 0.0, 0.0, 1e3, 0.0, 0.0];

/// Whether the joint angles follow from the pose without singularities.
fn is_regular(robot: &Robot, theta: &[f64; 6]) -> bool {
    let frames = Frames::new(robot, theta);
    frames.jacobian(&frames.wrist_centre()).singular_values().min() > 0.05
}

proptest! {
    #[test]
    fn the_corrected_command_comes_to_rest_at_the_target(
        theta in prop::array::uniform6(-3.0..3.0_f64), wrench in prop::array::uniform6(-500.0..500.0_f64), arm in 0..32_usize
    ) {
        let robot = &odd_arms()[arm];
        prop_assume!(is_regular(robot, &theta));
        let path_point = path_point(robot, &theta, wrench);
        let done = compensate(&job(robot, robot, vec![path_point])).complete().unwrap();
        let point = &done.points[0];
        // An oracle that knows nothing of the iteration: the equilibrium of the commanded joint angles.
        let load = Load { point: spindle().flange_from_tool.translation, force: path_point.force, moment: path_point.moment };
        let rest = robot.forward(&equilibrium(robot, &point.joints, &load).unwrap()).then(&spindle().flange_from_tool);
        prop_assert!((rest.translation - path_point.base_from_tool.translation).norm() <= 1e-9);
        let turn = rotation_vector(&(rest.rotation * path_point.base_from_tool.rotation.transpose()));
        prop_assert!(turn.norm() <= 1e-9, "{}", turn);
        prop_assert!(point.after.unwrap().linear.norm() <= 1e-9 && point.iterations >= 1);
        // The joint angles are those of the command, near those of the plan.
        let commanded = robot.forward(&point.joints).then(&spindle().flange_from_tool);
        prop_assert!((commanded.translation - point.command.translation).norm() < 1e-11);
        prop_assert!((commanded.rotation - point.command.rotation).norm() < 1e-11);
        prop_assert!(point.joints.iter().zip(theta).all(|(a, b)| (a - b).abs() < 0.3));
        prop_assert_eq!(Posture::of(robot, &point.joints), path_point.posture);
    }

    #[test]
    fn before_is_the_deflection_of_the_plan(
        theta in prop::array::uniform6(-3.0..3.0_f64), wrench in prop::array::uniform6(-500.0..500.0_f64), arm in 0..32_usize
    ) {
        let robot = &odd_arms()[arm];
        prop_assume!(is_regular(robot, &theta));
        let path_point = path_point(robot, &theta, wrench);
        let point = compensate(&job(robot, robot, vec![path_point])).complete().unwrap().points[0];
        let load = Load { point: spindle().flange_from_tool.translation, force: path_point.force, moment: path_point.moment };
        let truth = displaced(robot, &theta, &load).unwrap();
        prop_assert!((point.before.unwrap().linear - truth.linear).norm() < 1e-9);
        prop_assert!((point.before.unwrap().angular - truth.angular).norm() < 1e-9);
        prop_assert_eq!(point.before.unwrap().normal, point.before.unwrap().linear.dot(&path_point.normal));
    }
}

/// Error left after a number of iterations, with a share of the load. m
fn left(robot: &Robot, model: DeflectionModel, iterations: usize, share: f64) -> f64 {
    let mut job = job(robot, robot, vec![path_point(robot, &MIDDLE, CUT.map(|w| w * share))]);
    job.settings = Settings { tolerance: 1e-18, max_iterations: iterations, model, ..job.settings };
    match compensate(&job).complete().unwrap_err().failed[0].1 {
        PointError::NotConverged { error, .. } => error,
        reason => panic!("{reason}"),
    }
}

#[test]
fn each_iteration_gains_one_order_in_the_load() {
    // A soft arm, so that the errors after three iterations are far above rounding.
    let robot = softer(&kr270(), 10.0);
    for model in [DeflectionModel::Equilibrium, DeflectionModel::Linear] {
        for iterations in 0..3_u8 {
            let ratio = left(&robot, model, iterations.into(), 1.0) / left(&robot, model, iterations.into(), 0.5);
            let expected = f64::from(2_u8 << iterations);
            assert!((ratio / expected - 1.0).abs() < 0.03, "{model:?} {iterations}: {ratio} {expected}");
        }
    }
}

#[test]
fn damping_leaves_its_share() {
    let robot = kr270();
    let mut job = job(&robot, &robot, vec![path_point(&robot, &MIDDLE, CUT)]);
    job.settings.alpha = 0.5;
    let damped = compensate(&job).complete().unwrap();
    // Half of the error each time: from about 1 mm to 1e-6 mm in 20 iterations.
    let expected = libm::log2(damped.points[0].before.unwrap().linear.norm() / 1e-9).ceil();
    assert!((damped.iterations() as f64 - expected).abs() <= 1.0, "{} {expected}", damped.iterations());
    job.settings.alpha = 1.0;
    let full = compensate(&job).complete().unwrap();
    assert!(full.iterations() <= 3);
    assert!((full.points[0].command.translation - damped.points[0].command.translation).norm() < 2e-9);
}

#[test]
fn what_the_model_does_not_know_remains() {
    let robot = kr270();
    let points = vec![path_point(&robot, &MIDDLE, CUT), path_point(&robot, &[-0.4, 1.2, -1.7, 0.1, 0.8, -0.3], CUT)];
    for known in [0.8, 0.5, 1.0 / 1.1] {
        let done = compensate(&job(&robot, &softer(&robot, 1.0 / known), points.clone())).complete().unwrap();
        let found = reduction(done.deflections()).unwrap();
        assert!((found - known).abs() < 0.002, "{found} {known}");
        for point in &done.points {
            let unknown = point.before.unwrap().linear * (1.0 - known);
            assert!((point.after.unwrap().linear - unknown).norm() < 5e-3 * unknown.norm());
            assert!(
                (point.after.unwrap().angular - point.before.unwrap().angular * (1.0 - known)).norm()
                    < 5e-3 * unknown.norm()
            );
        }
    }
}

#[test]
fn the_linear_model_leaves_what_is_of_second_order() {
    let robot = kr270();
    let after = |share: f64| {
        let mut job = job(&robot, &robot, vec![path_point(&robot, &MIDDLE, CUT.map(|w| w * share))]);
        job.settings.model = DeflectionModel::Linear;
        let point = compensate(&job).complete().unwrap().points[0];
        (point.after.unwrap().linear.norm(), point.before.unwrap().linear.norm())
    };
    let ((full, before), (half, _)) = (after(1.0), after(0.5));
    assert!(full > 1e-8 && full < 0.01 * before, "{full} {before}");
    assert!((full / half / 4.0 - 1.0).abs() < 0.02, "{full} {half}");
}

#[test]
fn without_a_load_nothing_is_to_do() {
    let robot = kr270();
    let done = compensate(&job(&robot, &robot, vec![path_point(&robot, &MIDDLE, [0.0; 6])])).complete().unwrap();
    assert_eq!(done.iterations(), 0);
    assert_eq!(done.points[0].command, done.points[0].target);
    // What is left is rounding of the kinematics, not a deflection.
    assert!(done.deflections().iter().all(|figures| figures.max < 1e-14));
}

fn reason(job: &CompensationProblem) -> PointError {
    let failed = compensate(job).complete().unwrap_err();
    assert_eq!((failed.failed.len(), failed.of), (1, 1));
    failed.failed[0].1
}

#[test]
fn an_arm_that_gives_way_has_no_result() {
    let robot = kr270();
    let heavy = job(&robot, &robot, vec![path_point(&robot, &MIDDLE, TWIST.map(|w| w * 1e3))]);
    assert!(matches!(reason(&heavy), PointError::Unstable { share } if share < 1.0));
    // The model holds and corrects, and reality does not.
    let only_there = job(&robot, &softer(&robot, 1e3), vec![path_point(&robot, &MIDDLE, TWIST)]);
    assert!(matches!(reason(&only_there), PointError::RealityUnstable { share } if share < 1.0));
}

#[test]
fn a_diverging_iteration_is_no_result() {
    let robot = kr270();
    let mut job = job(&robot, &robot, vec![path_point(&robot, &MIDDLE, CUT)]);
    // Beyond 2 each iteration overshoots by more than it started with.
    job.settings.alpha = 2.5;
    assert!(
        matches!(reason(&job), PointError::Diverged { iterations: 1, from, to } if to > 1.4 * from && to < 1.6 * from)
    );
    job.settings.alpha = 2.0;
    assert!(matches!(reason(&job), PointError::Diverged { .. } | PointError::NotConverged { .. }), "{}", reason(&job));
    job.settings = Settings { alpha: 0.1, max_iterations: 20, ..Settings::default() };
    assert!(matches!(reason(&job), PointError::NotConverged { iterations: 20, error } if error > 1e-9));
    // So soft that the linear deflection is a turn of the arm: its direction changes faster than it is corrected.
    let soft = softer(&robot, 300.0);
    let mut job = self::job(&soft, &soft, vec![path_point(&soft, &MIDDLE, CUT)]);
    job.settings.model = DeflectionModel::Linear;
    assert!(matches!(reason(&job), PointError::Diverged { .. } | PointError::Reach(_)), "{}", reason(&job));
}

#[test]
fn limits_and_reach_hold_for_the_corrected_command() {
    let robot = kr270();
    let mut joints = robot.joints().clone();
    // Just wide enough for the plan; the correction turns joint 1 against its deflection.
    let done = compensate(&job(&robot, &robot, vec![path_point(&robot, &MIDDLE, CUT)])).complete().unwrap();
    let step = done.points[0].joints[0] - MIDDLE[0];
    assert!(step.abs() > 1e-5);
    if step > 0.0 {
        joints[0].max = MIDDLE[0] + 0.25 * step;
    } else {
        joints[0].min = MIDDLE[0] + 0.25 * step;
    }
    let narrow = Robot::new("narrow", joints).unwrap();
    let PointError::JointLimit { joint: 1, by } =
        reason(&job(&narrow, &narrow, vec![path_point(&narrow, &MIDDLE, CUT)]))
    else {
        panic!("joint 1 is within its limits");
    };
    assert!((by - 0.75 * step.abs()).abs() < 1e-6 * step.abs() + 1e-9, "{by} {step}");

    // Stretched but for a tenth of a millimetre, and pulled back by the load: the command would have to be farther out.
    let stretched = [0.3, 0.5, -robot.geometry().forearm_angle - 0.01, 0.4, 1.1, 0.5];
    let there = path_point(&robot, &stretched, [-900.0, -300.0, -300.0, 0.0, 0.0, 0.0]);
    let soft = softer(&robot, 5.0);
    assert!(matches!(reason(&job(&soft, &soft, vec![there])), PointError::Reach(_)));
}

/// Where the target is kept, the loaded tool is as far off as without compensation, and the figures count it.
#[test]
fn points_that_cannot_be_corrected_keep_their_target_and_the_others_are_corrected() {
    let robot = kr270();
    let good = path_point(&robot, &MIDDLE, CUT);
    let mut joints = robot.joints().clone();
    let corrected = compensate(&job(&robot, &robot, vec![good])).points[0];
    // The correction of joint 1 leads beyond its limits; at another place it does not.
    let step = corrected.joints[0] - MIDDLE[0];
    (joints[0].min, joints[0].max) = (MIDDLE[0] - 0.5 * step.abs(), MIDDLE[0] + 0.5 * step.abs());
    let narrow = Robot::new("narrow", joints).unwrap();
    let unloaded = path_point(&narrow, &MIDDLE, [0.0; 6]);
    let heavy = path_point(&narrow, &MIDDLE, TWIST.map(|w| w * 1e3));
    let path = compensate(&job(&narrow, &narrow, vec![good, unloaded, heavy]));
    let [limited, easy, gives_way] = &path.points[..] else { panic!("three points") };
    assert!(matches!(limited.status, Status::Kept(PointError::JointLimit { joint: 1, .. })), "{}", limited.status);
    assert_eq!((limited.command, limited.iterations), (good.base_from_tool, 0));
    assert!(limited.joints.iter().zip(MIDDLE).all(|(a, b)| (a - b).abs() < 1e-12));
    assert_eq!((limited.before, limited.after), (corrected.before, corrected.before));
    assert_eq!((easy.status, easy.status.to_string().as_str()), (Status::Corrected, "corrected"));
    // There is no deflection of an arm that gives way.
    assert!(matches!(gives_way.status, Status::Kept(PointError::Unstable { .. })));
    assert_eq!((gives_way.before, gives_way.after), (None, None));
    let half = corrected.before.unwrap().linear.norm() / 2.0;
    assert!(
        path.deflections().iter().all(|figures| (figures.mean / half - 1.0).abs() < 1e-9),
        "{:?}",
        path.deflections()
    );
    assert_eq!(path.warnings.len(), 1);
    let message = &path.warnings[0].message;
    assert!(
        message.starts_with(
            "2 of 3 points are not corrected and keep their target, the first point 0: corrected, joint 1 "
        )
    );
    assert_eq!(path.clone().complete().unwrap_err().failed.iter().map(|(point, _)| *point).collect::<Vec<_>>(), [0, 2]);
    assert_eq!(path.not_corrected(), path.complete().err());
}

#[test]
fn failures_are_told_in_runs_of_points() {
    let robot = kr270();
    let good = path_point(&robot, &MIDDLE, CUT);
    let heavy = path_point(&robot, &MIDDLE, TWIST.map(|w| w * 1e3));
    let points = vec![heavy, good, heavy, heavy, heavy, good];
    let message = compensate(&job(&robot, &robot, points)).complete().unwrap_err().to_string();
    let lines: Vec<&str> = message.lines().collect();
    assert_eq!(lines[0], "4 of 6 points cannot be compensated:");
    assert!(lines[1].starts_with("  point 0: the arm has no stable equilibrium"), "{message}");
    assert!(lines[2].starts_with("  points 2 to 4: at point 2, the arm has no stable equilibrium"), "{message}");
    assert_eq!(lines.len(), 3);
}

#[test]
fn another_geometry_is_found_and_other_compliances_and_limits_are_not() {
    let robot = kr270();
    assert_eq!(other_geometry(&robot, &softer(&robot, 2.0)), None);
    let mut joints = robot.joints().clone();
    joints[0].max = 3.0;
    joints[3].d = 1.101;
    let other = other_geometry(&robot, &Robot::new("x", joints).unwrap()).unwrap();
    assert_eq!((other.joint, other.field, other.expected, other.found), (4, "d", 1.1, 1.101));
}

#[test]
fn a_stop_before_or_during_the_job_leaves_no_path() {
    let robot = kr270();
    let job = job(&robot, &robot, vec![path_point(&robot, &MIDDLE, CUT); 20]);
    let stopped = Monitor::silent();
    stopped.stop_handle().stop();
    assert_eq!(super::compensate(&job, &stopped), Err(Stop::Asked));
    // Stopped by its own first report, which says how far it is.
    let handle = stead_numerics::monitor::StopHandle::default();
    let stop = handle.clone();
    let watch = move |progress: &Progress| {
        assert!(matches!(progress, Progress::Steps { stage: "correcting points", done: 1..20, total: 20 }));
        stop.stop();
    };
    let during = Monitor::new(watch).with_stop(handle);
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(alone.install(|| super::compensate(&job, &during)), Err(Stop::Asked));
}

mod whole_arm;
