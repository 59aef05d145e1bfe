use super::*;
use crate::certificate::{NoProof, certify};
use crate::region::Region;
use crate::relaxed::relaxed_value;
use crate::tests::seeded;
use nalgebra::{Matrix3, Vector3};
use rand::RngExt;
use stead_model::external_axis::{AxisKind, Carried};
use stead_model::robot::angles::wrap;
use stead_model::task::{Task, ToolPath, Wrench};
use stead_model::testing::some;
use stead_numerics::rotation::rotation_from_vector;
use stead_problem::constraints::ConstraintKind;
use stead_problem::criterion::{Aggregate, Weights};
use stead_problem::problem::{Cell, Interval, Placement};
use stead_problem::sense::Sense;
use stead_problem::setup::{AxisPositions, Orientation};
use stead_problem::symmetry::about_axis_1;
use stead_problem::testing::five_segments;

/// The five segments near the best placement, as the part lies and turned by an angle (rad) about the vertical.
fn in_two(angle: f64) -> (Problem, Placement) {
    let mut problem = five_segments();
    let at = Placement::from_mm_deg([0.0284, -1640.0, -214.0], 78.9664);
    let near = |value: f64| Interval { min: value - 1e-3, max: value + 1e-3 };
    problem.cell = Cell { position: [near(at.x), near(at.y), near(at.z)], yaw: near(at.yaw) };
    let rotation = rotation_from_vector(&(Vector3::z() * angle));
    problem.orientations =
        Arc::from([("as it lies", Matrix3::identity()), ("turned", rotation)].map(|(name, rotation)| Orientation {
            name: name.to_owned(),
            rotation,
            task: Arc::new(turned(&problem.task, &rotation)),
        }));
    (problem, at)
}

fn turned(task: &Task, by: &Matrix3<f64>) -> Task {
    let path = task.path();
    let points = (0..path.points().len()).map(|k| {
        let mut point = path.points()[k];
        point.position = by * point.position;
        point.feed = by * point.feed;
        point.axis = by * point.axis;
        (path.segment_of(k) as u32 + 1, point)
    });
    let wrench = |w: &Wrench| Wrench { force: by * w.force, moment: by * w.moment };
    Task::new(ToolPath::new(points).unwrap(), task.wrenches().map(wrench).collect()).unwrap()
}

#[test]
fn the_least_bound_of_the_orientations_holds_and_their_boxes_are_told_by_name() {
    let (problem, at) = in_two(0.3);
    assert_eq!(certifiable(&problem, u64::MAX), Ok(()));
    let (value, settings, silent) = (0.1075e-3, CertificateSettings::new(0.001), Monitor::silent());
    let (both, open_in) = Part::of(&problem, u64::MAX).unwrap().bound_from_below(value, &settings, &silent).unwrap();
    let alone = [0, 1].map(|number| in_orientation(&problem, number).unwrap());
    let each = [0, 1].map(|number| best(&alone[number], value, &settings, &silent).unwrap());
    assert_eq!(both.bound, each[0].bound.min(each[1].bound));
    assert_eq!(open_in.iter().map(|part| part.boxes).collect::<Vec<_>>(), [each[0].open.len(), each[1].open.len()]);
    assert_eq!(both.open.len(), each[0].open.len() + each[1].open.len());
    assert_ne!(each[0].bound, each[1].bound);
    // In the second orientation the same placements are others.
    let planner = |one: &Problem| {
        let planner = stead_planning::redundancy::Planner::finer(one);
        let plans = planner.plan_fine(&at, Sense::Min, None, &mut planner.workspace()).unwrap();
        one.objective(plans.iter().map(|plan| plan.cost))
    };
    for (one, bound) in alone.iter().zip(&each) {
        assert!(planner(one) >= bound.bound);
    }
    let proof = certify(&problem, &at, value, None, settings, &silent).best.unwrap();
    let named = proof.open_boxes(&problem);
    assert!(named.iter().all(|open| open.orientation.is_some()));
    assert_eq!(named.len(), both.open.len());
}

#[test]
fn limits_that_one_orientation_drops_are_named() {
    let (mut problem, at) = in_two(0.3);
    let settings = CertificateSettings { time_limit: Some(1.0), ..CertificateSettings::new(0.5) };
    let relaxes_rate = |problem: &Problem| {
        let proof = certify(problem, &at, 0.1075e-3, None, settings, &Monitor::silent()).best.unwrap();
        proof.relaxed.contains(&ConstraintKind::BetaRate)
    };
    assert!(!relaxes_rate(&problem));
    // With a tool that leans limits on beta are dropped.
    let mut orientations = problem.orientations.to_vec();
    orientations[1].task = Arc::new(turned(&problem.task, &rotation_from_vector(&(Vector3::x() * 0.2))));
    problem.orientations = orientations.into();
    assert!(relaxes_rate(&problem));
}

#[test]
fn an_orientation_in_which_nothing_can_be_bounded_is_refused_by_name() {
    let (mut problem, _) = in_two(0.3);
    let mut orientations = problem.orientations.to_vec();
    // Five tool axes are more than a bound covers.
    let tilted = |k: usize| turned(&problem.task, &rotation_from_vector(&(Vector3::x() * (0.1 * k as f64))));
    let tasks: Vec<Task> = (1..=5).map(tilted).collect();
    let points = (0..problem.task.points().len())
        .map(|k| (problem.task.path().segment_of(k) as u32 + 1, tasks[k % 5].points()[k]));
    let path = ToolPath::new(points).unwrap();
    orientations[1].task = Arc::new(Task::new(path, problem.task.wrenches().copied().collect()).unwrap());
    problem.orientations = orientations.into();
    let refused = certifiable(&problem, u64::MAX).unwrap_err().to_string();
    assert!(refused.starts_with("in the orientation \"turned\": "), "{refused}");
}

/// The five segments near the best placement, on a short rail or turntable with a place for each segment.
fn indexed(kind: AxisKind, aggregate: Aggregate) -> (Problem, Placement) {
    let mut problem = five_segments();
    let at = Placement::from_mm_deg([0.0284, -1640.0, -214.0], 78.9664);
    let near = |value: f64| Interval { min: value - 1e-3, max: value + 1e-3 };
    problem.cell = Cell { position: [near(at.x), near(at.y), near(at.z)], yaw: near(at.yaw) };
    (problem.criterion.aggregate, problem.criterion.weights) = (aggregate, Weights::TOTAL);
    problem.criterion.segment_weights = vec![1.0, 2.0, 0.0, 1.0, 0.5];
    let (direction, max) = match kind {
        AxisKind::Rail => (Vector3::y(), 0.02),
        AxisKind::Turntable => (Vector3::z(), 0.05),
    };
    problem.external_axes = vec![ExternalAxis {
        name: "axis".to_owned(),
        kind,
        carries: Carried::Workpiece,
        direction,
        point: Vector3::new(at.x, at.y, 0.0),
        min: -max,
        max,
        max_speed: None,
        axis_use: AxisUse::Indexed,
    }];
    problem.setup = Setup::at_rest(&problem.external_axes);
    (problem, at)
}

/// What the problem comes to with the axis at these shares of its range, segment by segment.
fn value_at(problem: &Problem, at: &Placement, shares: [f64; 5]) -> f64 {
    let mut there = problem.clone();
    let axis = &problem.external_axes[0];
    let positions = shares.map(|share| vec![axis.min + share * (axis.max - axis.min)]);
    there.setup.positions = AxisPositions::PerSegment(positions.to_vec());
    relaxed_value(&there, at, &Monitor::silent()).unwrap()
}

#[test]
fn no_places_of_an_axis_for_the_segments_are_better_than_their_bounds_together() {
    for (kind, aggregate) in some(2, [(AxisKind::Turntable, Aggregate::Max), (AxisKind::Rail, Aggregate::Mean)]) {
        let (problem, at) = indexed(kind, aggregate);
        assert_eq!(certifiable(&problem, u64::MAX), Ok(()));
        let ends = (0..32).map(|k| std::array::from_fn(|s| f64::from(k >> s & 1)));
        let least = ends.map(|shares| value_at(&problem, &at, shares)).fold(f64::INFINITY, f64::min);
        let silent = Monitor::silent();
        let settings = CertificateSettings::new(0.01);
        let (bound, parts) = Part::of(&problem, u64::MAX).unwrap().bound_from_below(least, &settings, &silent).unwrap();
        // In so small a cell that segments share a placement is worth little; where only the largest counts, what a
        // segment comes to by itself is the larger of one way.
        assert!(bound.bound <= least && bound.gap() < 0.02, "{kind:?} {aggregate:?}: {bound:?} {least}");
        // The third segment has no weight.
        assert_eq!(parts.iter().map(|part| part.segment).collect::<Vec<_>>(), [1, 2, 4, 5].map(Some));
        assert_eq!(parts.iter().map(|part| part.boxes).sum::<usize>(), bound.open.len());
        // Compared with a value so much worse that these places are of interest, nothing can be excluded.
        let raised = CertificateSettings { memory: 40_000_000, ..CertificateSettings::new(0.02) };
        let of_worse = Part::of(&problem, raised.memory).unwrap();
        let (worse, _) = of_worse.bound_from_below(1.022 * least, &raised, &silent).unwrap();
        assert!(worse.bound <= least && worse.status != Status::Reached, "{kind:?}: {} {least}", worse.bound);
        // With the axis at one place for the path there is less to choose from.
        let mut still = problem.clone();
        still.external_axes[0].axis_use = AxisUse::Fixed;
        let of_one = best(&still, least, &settings, &silent).unwrap();
        assert!(of_one.bound >= bound.bound * 0.989, "{kind:?}: {} {}", of_one.bound, bound.bound);
        // Words are the same however near the bound comes.
        let proof = certify(&problem, &at, least, Some(&at), CertificateSettings::new(0.5), &silent);
        let words = proof.best.unwrap().relaxed_words();
        let apart = "differences of up to 25 mm and 2.8 deg between the places of segments";
        assert!(words.iter().any(|word| word == apart), "{words:?}");
        assert!(words.iter().any(|word| word == "segments without scored points"), "{words:?}");
        let Err(NoProof::Unsupported(Unsupported::Several(reasons))) = proof.worst else { panic!("bounded") };
        let direction = Unsupported::NotFromAbove { key: "criterion.direction" };
        assert!(reasons[0] == Unsupported::ExternalAxes && reasons.contains(&direction), "{reasons:?}");
    }
}

#[test]
fn bounds_of_segments_make_up_the_figure_as_their_values_do() {
    for aggregate in [Aggregate::Mean, Aggregate::Rms, Aggregate::Max] {
        let (problem, at) = indexed(AxisKind::Rail, aggregate);
        let whole = value_at(&problem, &at, [0.5; 5]);
        let objective = Objective::of(&problem);
        let sum = Part::of(&problem, u64::MAX).unwrap().leaves().into_iter().fold(0.0, |sum, leaf| {
            let value = relaxed_value(&leaf.problem, &at, &Monitor::silent()).unwrap();
            objective.aggregate.join(sum, Objective::of(&leaf.problem).sum(value))
        });
        assert!((objective.value(sum) - whole).abs() < 1e-9 * whole, "{aggregate:?}");
    }
}

#[test]
fn placements_compared_with_are_no_better_than_what_is_possible() {
    let (problem, _) = indexed(AxisKind::Rail, Aggregate::Mean);
    let (settings, silent) = (CertificateSettings::new(0.01), Monitor::silent());
    for leaf in Part::of(&problem, u64::MAX).unwrap().leaves() {
        let found = low_value(&leaf.problem, &silent).unwrap();
        let bound = bound_of(leaf, found, &settings, &silent);
        assert!(bound.bound <= found && bound.status == Status::Reached, "{bound:?}");
    }
}

/// Where axes at those positions bring a placement, seen from the robot.
pub(crate) fn moved(axes: &[ExternalAxis], positions: &[f64], at: &Placement) -> Placement {
    let of = |what: Carried| axes.iter().zip(positions).filter(move |(axis, _)| axis.carries == what);
    let steps = of(Carried::Workpiece).rev().map(|(axis, at)| (axis, *at));
    let steps = steps.chain(of(Carried::Robot).map(|(axis, at)| (axis, -*at)));
    steps.fold(*at, |at, (axis, position)| {
        let motion = axis.motion(position);
        let place = motion.rotation * Vector3::new(at.x, at.y, at.z) + motion.translation;
        let yaw = at.yaw + libm::atan2(motion.rotation[(1, 0)], motion.rotation[(0, 0)]);
        Placement { x: place.x, y: place.y, z: place.z, yaw }
    })
}

/// Every open box is below the placements of which a segment stands in it, and what is in none of them is not of
/// interest: of a search that memory ended with many boxes open. The threads do not matter.
#[test]
fn boxes_of_segments_are_below_all_that_they_hold() {
    let mut random = seeded(61);
    for kind in some(1, [AxisKind::Rail, AxisKind::Turntable]) {
        let (mut problem, at) = indexed(kind, Aggregate::Mean);
        let near = |value: f64, off: f64| Interval { min: value - off, max: value + off };
        problem.cell = Cell { position: [at.x, at.y, at.z].map(|value| near(value, 0.04)), yaw: near(at.yaw, 0.5) };
        let axis = &mut problem.external_axes[0];
        (axis.min, axis.max) = if kind == AxisKind::Rail { (-0.1, 0.15) } else { (-0.3, 0.2) };
        let (value, silent) = (value_at(&problem, &at, [0.5; 5]), Monitor::silent());
        let settings = CertificateSettings { memory: 40_000_000, ..CertificateSettings::new(0.001) };
        let part = Part::of(&problem, settings.memory).unwrap();
        let of = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| part.bound_from_below(value, &settings, &silent).unwrap())
        };
        let ((bound, parts), again) = (of(2), of(5));
        assert!((&bound, &parts) == (&again.0, &again.1));
        assert!(
            bound.status == Status::Memory && bound.open.len() > 500,
            "{kind:?} {:?} {}",
            bound.status,
            bound.open.len()
        );
        let segments: Vec<usize> =
            parts.iter().flat_map(|part| std::iter::repeat_n(part.segment.unwrap() - 1, part.boxes)).collect();
        let (mut held, mut free) = (0, 0);
        for _ in 0..40 {
            let mut from = |range: Interval| range.min + range.width() * random.random::<f64>();
            let [x, y, z] = problem.cell.position.map(&mut from);
            let there = Placement { x, y, z, yaw: from(problem.cell.yaw) };
            let shares: [f64; 5] = std::array::from_fn(|_| from(Interval { min: 0.0, max: 1.0 }));
            let mut with_axes = problem.clone();
            let axis = &problem.external_axes[0];
            let positions = shares.map(|share| vec![axis.min + share * (axis.max - axis.min)]);
            with_axes.setup.positions = AxisPositions::PerSegment(positions.to_vec());
            let Some(found) = relaxed_value(&with_axes, &there, &silent) else { continue };
            assert!(found >= bound.bound);
            for (segment, position) in positions.iter().enumerate().filter(|(segment, _)| *segment != 2) {
                let seen = about_axis_1(&problem, &moved(&problem.external_axes, position, &there));
                let root = problem.robot.geometry().root_in_base;
                let seen = [seen[0], seen[1] - root.z, seen[2]];
                let holds = |region: &Region| {
                    let off =
                        |k: usize| if k == 2 { wrap(seen[k] - region.middle[k]) } else { seen[k] - region.middle[k] };
                    (0..3).all(|k| off(k).abs() <= region.half[k] + 1e-9)
                };
                let boxes = bound.open.iter().zip(&segments).filter(|(one, of)| **of == segment && holds(&one.0));
                let bounds: Vec<f64> = boxes.map(|(one, _)| one.1).collect();
                if bounds.is_empty() {
                    free += 1;
                    assert!(found >= value * 0.999 * (1.0 - 1e-9), "{found}");
                }
                held += bounds.len();
                assert!(bounds.iter().all(|bound| *bound <= found), "{found} {bounds:?}");
            }
        }
        assert!(held > 20 && free > 0, "{kind:?} {held} {free}");
    }
}
