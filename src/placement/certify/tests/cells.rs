//! The box of all placements, the yaws that a cell allows, and searches: no placement may get lost.

use super::super::relaxed::relaxed_value;
use super::super::search::{Bound, State, Watch, best};
use super::super::worst::worst;
use super::*;
use crate::placement::problem::Placement;
use crate::placement::redundancy::{Extremum, Planner};
use crate::robot::angles::wrap;

/// Radius, height and turn of a pose: the inverse of [`Setting::pose`].
fn coordinates(setting: &Setting, pose: &[f64; 4]) -> [f64; 3] {
    let (side, root) = (setting.side(), setting.problem.robot.geometry().root_in_base);
    let (x, y) = (pose[0] - root.x, side * (pose[1] - root.y));
    [libm::hypot(x, y), side * (pose[2] - root.z), wrap(side * pose[3] - libm::atan2(y, x))]
}

fn holds(region: &Region, at: &[f64; 3]) -> bool {
    let off = [at[0] - region.middle[0], at[1] - region.middle[1], wrap(at[2] - region.middle[2])];
    off.iter().zip(region.half).all(|(off, half)| off.abs() <= half + 1e-9)
}

/// A pose in the cell, often at its ends.
fn pose_in(problem: &Problem, random: &mut ChaCha8Rng) -> [f64; 4] {
    let [x, y, z] = problem.cell.position;
    [x, y, z, problem.cell.yaw].map(|i| i.min + i.width() * 0.5 * (1.0 + share(random)))
}

/// A cell within the cell, with few yaws.
fn narrowed(mut problem: Problem, random: &mut ChaCha8Rng) -> Problem {
    for side in &mut problem.cell.position {
        let ends = [random.random::<f64>(), random.random::<f64>()].map(|share| side.min + share * side.width());
        *side = Interval { min: ends[0].min(ends[1]), max: ends[0].max(ends[1]) };
    }
    let from = random.random_range(-4.0..4.0);
    problem.cell.yaw = Interval { min: from, max: from + random.random_range(0.0..2.0) };
    problem
}

/// How often a placement of a cell is not in its box, or has a yaw that is not allowed.
fn left_out(settings: &mut [Setting], change: fn(&mut Setting)) -> usize {
    let mut random = seeded(61);
    let mut wrong = 0;
    for setting in settings {
        let whole = setting.whole;
        let yaws = setting.bounded.yaws;
        change(setting);
        for _ in 0..60 {
            let at = coordinates(setting, &pose_in(&setting.problem, &mut random));
            let alone = Region { middle: at, half: [0.0; 3] };
            wrong += usize::from(!holds(&setting.whole, &at) || !setting.bounded.yaws.allow(&alone));
        }
        (setting.whole, setting.bounded.yaws) = (whole, yaws);
    }
    wrong
}

#[test]
fn cells_are_in_their_boxes_and_broken_boxes_are_seen() {
    let mut random = seeded(62);
    let mut settings: Vec<Setting> = Setting::all()
        .into_iter()
        .flat_map(|(_, setting)| std::array::from_fn::<_, 6, _>(|_| narrowed(setting.problem.clone(), &mut random)))
        .map(Setting::new)
        .collect();
    // And one about axis 1.
    let mut around = five_segments();
    around.cell.position[1] = Interval { min: -0.2, max: 0.4 };
    settings.push(Setting::new(around));
    assert!(settings.iter().filter(|s| s.bounded.yaws.range.is_some()).count() >= 30);
    assert_eq!(left_out(&mut settings, |_| {}), 0);
    let mutations: [Breaking<Setting>; 6] = [
        ("yaws turned the other way", |s| s.bounded.yaws.range = s.bounded.yaws.range.map(|(m, h)| (-m, h))),
        ("yaws without the azimuths of the cell", |s| {
            let half = s.problem.cell.yaw.width() / 2.0;
            s.bounded.yaws.range = s.bounded.yaws.range.map(|(m, _)| (m, half));
        }),
        ("height upside down", |s| s.whole.middle[1] = -s.whole.middle[1]),
        ("height a hundredth lower", |s| s.whole.half[1] *= 0.99),
        ("radius a hundredth narrower", |s| s.whole.half[0] *= 0.99),
        ("distances from the base frame and not from axis 1", |s| {
            s.whole.middle[0] += s.problem.robot.geometry().root_in_base.x + 0.1;
        }),
    ];
    for (name, change) in mutations {
        assert!(left_out(&mut settings, change) > 0, "{name} is not seen");
    }
}

struct Patience(usize);

impl Watch for Patience {
    fn goes_on(&mut self, _: &State) -> bool {
        self.0 = self.0.saturating_sub(1);
        self.0 > 0
    }
}

/// Every eighth point of the path, in a cell of two centimetres about a placement that has a plan.
fn short(mut problem: Problem, random: &mut ChaCha8Rng) -> Problem {
    let path = problem.task.path();
    let kept: Vec<usize> = (0..path.points().len()).filter(|point| point % 8 == 0).collect();
    let points = kept.iter().map(|point| (path.segment_of(*point) as u32 + 1, path.points()[*point]));
    let wrenches = kept.iter().map(|point| problem.task.wrenches()[*point]).collect();
    problem.task = Task::new(ToolPath::new(points.collect::<Vec<_>>()).unwrap(), wrenches).unwrap();
    let planner = Planner::new(&problem);
    let mut space = planner.workspace();
    let pose = (0..2000)
        .map(|_| pose_in(&problem, random))
        .find(|pose| planner.worth(pose, Extremum::Smallest, None, &mut space).mean().is_some())
        .unwrap();
    problem.cell.position = std::array::from_fn(|k| Interval { min: pose[k] - 0.01, max: pose[k] + 0.01 });
    problem.cell.yaw = Interval { min: pose[3] - 0.1, max: pose[3] + 0.1 };
    problem
}

/// How many placements worth less (of the worst: more) than was asked for are in no box left open, or in one whose bound is
/// above (below) what they are worth.
fn lost(setting: &Setting, found: &Bound, gap: f64, worths: &[([f64; 4], f64)]) -> usize {
    let is_lost = |pose: &[f64; 4], worth: f64| {
        let at = coordinates(setting, pose);
        let boxes = || found.open.iter().filter(|(region, _)| holds(region, &at)).map(|(_, bound)| *bound);
        if gap > 0.0 {
            worth < found.value * (1.0 - gap) && boxes().fold(f64::INFINITY, f64::min) > worth
        } else {
            // Beta is sought to some thousandths there.
            worth > found.value * (1.0 - gap) * 1.002 && boxes().fold(0.0, f64::max) < 0.998 * worth
        }
    };
    worths.iter().filter(|(pose, worth)| is_lost(pose, *worth)).count()
}

fn middle(worths: &[([f64; 4], f64)]) -> f64 {
    let mut all: Vec<f64> = worths.iter().map(|(_, worth)| *worth).collect();
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}

/// What a search for the best loses of placements and what they are worth, with their rate of beta.
fn lost_by_best(setting: &Setting, problem: &Problem, worths: &[([f64; 4], f64)]) -> usize {
    let found = best(problem, middle(worths), 1e-3, true, &mut Patience(8)).unwrap();
    lost(setting, &found, 1e-3, worths)
}

/// The same for the worst, and limits dropped.
fn lost_by_worst(setting: &Setting, problem: &Problem, worths: &[([f64; 4], f64)]) -> usize {
    let found = worst(problem, middle(worths), 1e-3, &mut Patience(8)).unwrap();
    lost(setting, &found, -1e-3, worths)
}

#[test]
fn no_placement_gets_lost_in_a_search_and_broken_ones_lose_some() {
    let mut random = seeded(63);
    for (name, problem) in [("five segments", five_segments()), ("hanging", hanging()), ("hanging arm", hanging_arm())]
    {
        let setting = Setting::new(short(problem, &mut random));
        let problem = &setting.problem;
        let planner = Planner::finer(problem);
        let mut space = planner.workspace();
        let mut worth =
            |pose: [f64; 4]| Some((pose, planner.worth(&pose, Extremum::Smallest, None, &mut space).mean()?));
        let worths: Vec<_> = (0..60).filter_map(|_| worth(pose_in(problem, &mut random))).collect();
        assert!(worths.len() > 10, "{name}");
        assert_eq!(lost_by_best(&setting, problem, &worths), 0, "{name}");
        let relaxed = |(pose, _): &([f64; 4], f64)| {
            let [x, y, z, yaw] = *pose;
            Some((*pose, relaxed_value(problem, &Placement { x, y, z, yaw })?))
        };
        let relaxed: Vec<_> = worths.iter().take(10).filter_map(relaxed).collect();
        assert_eq!(lost_by_worst(&setting, problem, &relaxed), 0, "{name}");
        if name != "five segments" {
            continue;
        }
        let mutations: [(&str, fn(&mut Problem)); 4] = [
            ("half of the yaws", |p| p.cell.yaw.max -= 0.1),
            ("half of the heights", |p| p.cell.position[2].min += 0.01),
            ("conditioning", |p| p.constraints.min_inverse_condition *= 2.0),
            ("a softer arm", |p| p.robot = softer(&p.robot)),
        ];
        for (mutation, change) in mutations {
            let mut broken = problem.clone();
            change(&mut broken);
            assert!(lost_by_best(&setting, &broken, &worths) > 0, "{mutation} is not seen");
        }
        let mut broken = problem.clone();
        broken.cell.yaw.max -= 0.1;
        assert!(lost_by_worst(&setting, &broken, &relaxed) > 0, "half of the yaws is not seen for the worst");
    }
}

/// The same arm with every joint twice as soft.
fn softer(robot: &Robot) -> Robot {
    let mut joints = robot.joints().clone();
    let compliances = robot.constant_compliances().unwrap();
    joints.iter_mut().zip(compliances).for_each(|(joint, c)| joint.compliance = (2.0 * c).into());
    Robot::new("soft", joints).unwrap()
}
