//! Speed of circularity maps: `cargo bench --bench assessment`. Items are circles of 72 points that can be milled.

#![allow(clippy::expect_used, reason = "a benchmark of shipped files")]

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use std::path::Path;
use stead_assessment::benchmark::DeflectedCircle;
use stead_assessment::comparison::{Comparison, assess};
use stead_assessment::map::{Elbow, Map};
use stead_numerics::monitor::Monitor;
use stead_run_files::read_assessment;

fn main() {
    divan::main();
}

fn published() -> Comparison {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/klimchik-2017.toml");
    read_assessment(&file).map(|run| run.comparison).expect("the shipped study is good")
}

/// All maps of the paper with everything that is read off them: five robots, both elbows, both loads, 25 mm grid, on
/// all processors.
#[divan::bench(sample_count = 5, sample_size = 1)]
fn all_maps(bencher: Bencher) {
    let comparison = published();
    let maps = assess(&comparison, &Monitor::silent()).expect("the shipped study is good");
    let circles: usize = maps.robots.iter().flat_map(|robot| &robot.maps).map(|(_, map)| map.count()).sum();
    bencher.counter(ItemsCount::new(circles)).bench_local(|| assess(black_box(&comparison), &Monitor::silent()));
}

/// One map of the KR 500 on one processor, with so many times finer a grid.
#[divan::bench(args = [1, 2, 4], sample_count = 5, sample_size = 1)]
fn one_map_finer_by(bencher: Bencher, fineness: usize) {
    let comparison = published();
    let robot = &comparison.robots[4];
    let mut grid = comparison.grid;
    grid.step /= fineness as f64;
    grid.counts = grid.counts.map(|count| (count - 1) * fineness + 1);
    let class = Elbow::Up.forward_class(robot);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be started");
    let silent = Monitor::silent();
    let map = || {
        pool.install(|| {
            Map::new(
                &DeflectedCircle::new(black_box(&comparison.benchmark), robot),
                class,
                grid,
                [1.0, 2.0],
                &silent,
                &|| {},
            )
        })
    };
    let circles = map().count();
    bencher.counter(ItemsCount::new(circles)).bench_local(map);
}
