use super::super::lookup::LookupTable;
use super::super::path_subset::PathSubset;
use super::*;
use stead_planning::redundancy::Planner;
use stead_problem::testing::five_segments;

fn small() -> SearchSettings {
    SearchSettings { population: 24, generations: 6, ..SearchSettings::default() }
}

#[test]
fn same_seed_same_result_for_any_number_of_threads() {
    let mut problem = five_segments();
    problem.redundancy.beta_count = 24;
    let planner = Planner::new(&problem);
    for looks_through_table in [false, true] {
        let run = |threads: usize, seed: u64| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let table = looks_through_table.then(|| LookupTable::new(&problem).unwrap());
                let evaluator = Evaluator::new(&planner, table.as_ref());
                search(&evaluator, &SearchSettings { seed, ..small() }, Sense::Min, &Monitor::silent())
            })
        };
        let one = run(1, 1);
        assert_eq!(one, run(2, 1));
        assert_eq!(one, run(5, 1));
        assert_ne!(one.basins, run(2, 2).basins);
    }
}

#[test]
fn best_only_gets_better_and_stays_in_the_cell() {
    let mut problem = five_segments();
    problem.redundancy.beta_count = 24;
    for (sense, postures) in
        [(Sense::Min, PostureSearch::Exact), (Sense::Max, PostureSearch::Exact), (Sense::Min, PostureSearch::Genetic)]
    {
        let planner = Planner::new(&problem);
        let evaluator = Evaluator::new(&planner, None);
        let found = search(&evaluator, &SearchSettings { postures, ..small() }, sense, &Monitor::silent());
        let best: Vec<f64> = found.history.iter().filter_map(|g| g.best).collect();
        let sign = if sense == Sense::Min { 1.0 } else { -1.0 };
        assert!(best.windows(2).all(|pair| pair[1] * sign <= pair[0] * sign));
        assert_eq!(found.history.len(), 7);
        for candidate in &found.basins {
            assert!(problem.cell.contains(&candidate.placement));
            assert_eq!(candidate.scheme.is_some(), postures == PostureSearch::Genetic);
        }
    }
}

#[test]
fn on_a_long_path_a_turn_about_axis_1_makes_no_other_basin() {
    let problem = five_segments();
    let thinned = PathSubset::new(&problem.task, 20).of(&problem);
    let root = problem.robot.geometry().root_in_base;
    let at = |radius: f64, azimuth: f64, heading: f64| {
        let (sine, cosine) = libm::sincos(azimuth);
        let placement = Placement {
            x: root.x + radius * cosine,
            y: root.y + radius * sine,
            z: problem.cell.position[2].min,
            yaw: heading + azimuth,
        };
        Candidate { placement, scheme: None, objective: UNEVALUATED }
    };
    let turned = [at(1.5, 0.1, 0.3), at(1.5, 1.4, 0.3), at(1.5, -2.0, 0.3)];
    assert_eq!(distinct(&problem, &turned, 9), turned);
    assert_eq!(distinct(&thinned, &turned, 9), turned[..1]);
    // Another radius, or another heading, is another basin.
    let others = [at(1.5, 0.1, 0.3), at(0.3, 0.1, 0.3), at(1.5, 0.1, 1.3)];
    assert_eq!(distinct(&thinned, &others, 9), others);
    assert_eq!(distinct(&thinned, &others, 2), others[..2]);
}
