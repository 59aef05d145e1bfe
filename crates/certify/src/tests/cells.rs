//! The box of all placements, and the yaws that a cell allows: no placement may get lost.

use super::*;
use stead_model::robot::angles::wrap;

/// Radius, height and turn of a pose: the inverse of [`Setting::pose`].
fn coordinates(setting: &Setting, placement: &Placement) -> [f64; 3] {
    let (side, root) = (setting.side(), setting.problem.robot.geometry().root_in_base);
    let (x, y) = (placement.x - root.x, side * (placement.y - root.y));
    [libm::hypot(x, y), side * (placement.z - root.z), wrap(side * placement.yaw - libm::atan2(y, x))]
}

fn holds(region: &Region, at: &[f64; 3]) -> bool {
    let off = [at[0] - region.middle[0], at[1] - region.middle[1], wrap(at[2] - region.middle[2])];
    off.iter().zip(region.half).all(|(off, half)| off.abs() <= half + 1e-9)
}

/// A pose in the cell, often at its ends.
fn pose_in(problem: &Problem, random: &mut ChaCha8Rng) -> Placement {
    let [x, y, z] = problem.cell.position;
    [x, y, z, problem.cell.yaw].map(|i| i.min + i.width() * 0.5 * (1.0 + share(random))).into()
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
        let yaws = setting.model.yaws.clone();
        change(setting);
        for _ in 0..60 {
            let at = coordinates(setting, &pose_in(&setting.problem, &mut random));
            let alone = Region { middle: at, half: [0.0; 3] };
            wrong += usize::from(!holds(&setting.whole, &at) || !setting.model.yaws.allow(&alone));
        }
        (setting.whole, setting.model.yaws) = (whole, yaws);
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
    assert!(settings.iter().filter(|s| s.model.yaws.0[0].range.is_some()).count() >= 30);
    assert_eq!(left_out(&mut settings, |_| {}), 0);
    let mutations: [Breaking<Setting>; 6] = [
        ("yaws turned the other way", |s| s.model.yaws.0[0].range = s.model.yaws.0[0].range.map(|(m, h)| (-m, h))),
        ("yaws without the azimuths of the cell", |s| {
            let half = s.problem.cell.yaw.width() / 2.0;
            s.model.yaws.0[0].range = s.model.yaws.0[0].range.map(|(m, _)| (m, half));
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
