//! Best first over boxes of placements.

use super::arm::Arm;
use super::bound::{Bounded, Evaluated, Tube};
use super::region::{Point, Region};
use super::table::{Extent, Steps, Table};
use crate::placement::problem::Problem;
use rayon::prelude::*;
use std::collections::BinaryHeap;
use std::cmp::Ordering;
use std::f64::consts::PI;
use std::sync::Arc;

fn prepare(problem: &Problem, steps: (f64, usize), with_rate: bool) -> (Bounded, Region) {
    let g = problem.robot.geometry().clone();
    let side = g.base_from_root[(2, 2)];
    let compliances = problem.robot.constant_compliances().unwrap();
        let task = &problem.task;
    let points: Vec<Point> = task
        .points()
        .iter()
        .zip(task.wrenches())
        .map(|(p, w)| {
            // Seen along axis 1: for a hanging arm y and z change sign.
            let (x, y) = (p.position.x, p.position.y * side);
            let (fx, fy) = (p.feed.x, p.feed.y * side);
            let length = libm::hypot(fx, fy);
            let (fx, fy) = (fx / length, fy / length);
            let f = [w.force.x, w.force.y * side, w.force.z * side];
            Point {
                distance: libm::hypot(x, y),
                direction: libm::atan2(y, x),
                height: p.position.z * side,
                feed: libm::atan2(fy, fx),
                force: [f[0] * fx + f[1] * fy, -f[0] * fy + f[1] * fx, f[2]],
            }
        })
        .collect();
    let [x, y, z] = problem.cell.position;
    let (x0, y0) = (x.min - g.root_in_base.x, y.min - g.root_in_base.y);
    let (x1, y1) = (x.max - g.root_in_base.x, y.max - g.root_in_base.y);
    let gap = |a: f64, b: f64| if a > 0.0 { a } else if b < 0.0 { -b } else { 0.0 };
    let near = libm::hypot(gap(x0, x1), gap(y0, y1));
    let far = libm::hypot(x0.abs().max(x1.abs()), y0.abs().max(y1.abs()));
    let (a, b) = ((z.min - g.root_in_base.z) * side, (z.max - g.root_in_base.z) * side);
    let (low, high) = (a.min(b), a.max(b));
    let whole = Region {
        middle: [(near + far) / 2.0, (low + high) / 2.0, 0.0],
        half: [(far - near) / 2.0, (high - low) / 2.0, PI],
    };
    let most = points.iter().map(|p| p.distance).fold(0.0, f64::max);
    let (zl, zh) = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p.height), h.max(p.height)));
    let extent = Extent { radius: ((near - most).max(0.05), far + most), height: (low + zl, high + zh) };
    let arm = Arm::new(problem, &compliances, extent.radius.0);
    let t = std::time::Instant::now();
    let table = Table::new(extent, Steps { length: steps.0, headings: steps.1 }, 3);
    println!("table {:?}", t.elapsed());
    let rates = (0..points.len())
        .map(|p| if !with_rate || p == 0 { f64::INFINITY } else { problem.beta_step_limit(p) })
        .collect();
    let bounded = Bounded {
        arm,
        table,
        points,
        segments: task.segments().to_vec(),
        rates,
        first: compliances[0],
        extent,
    };
    (bounded, whole)
}

struct Open {
    bound: f64,
    number: u64,
    region: Region,
    tube: Arc<Tube>,
}
impl PartialEq for Open {
    fn eq(&self, o: &Self) -> bool { self.cmp(o) == Ordering::Equal }
}
impl Eq for Open {}
impl PartialOrd for Open {
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> { Some(self.cmp(o)) }
}
impl Ord for Open {
    fn cmp(&self, o: &Self) -> Ordering {
        o.bound.total_cmp(&self.bound).then(o.number.cmp(&self.number))
    }
}

fn run_search(bounded: &Bounded, start_with: Vec<(f64, Region)>, incumbent: f64, gap: f64, limit_s: f64) {
    let n = bounded.points.len();
    let ceiling = incumbent * n as f64 * (1.0 - gap);
    let start = std::time::Instant::now();
    let mut heap = BinaryHeap::new();
    let mut number = 0;
    let full = Arc::new(Tube::full(n, bounded.table.headings(0)));
    for (bound, region) in start_with { number += 1; heap.push(Open { bound, number, region, tube: Arc::clone(&full) }); }
    let (mut nodes, mut states) = (0usize, 0usize);
    let mut closed = f64::INFINITY;
    let mut shown = 0.0;
    while !heap.is_empty() {
        let batch: Vec<Open> = (0..64).map_while(|_| heap.pop()).collect();
        let lowest = batch[0].bound;
        let t = start.elapsed().as_secs_f64();
        if t > shown {
            shown += 1.0;
            println!("{t:.1}s nodes {nodes} states {states} open {} lowest {:.7} gap {:.3} % region {:?} half {:?} cells {} tube {}", heap.len(), lowest / n as f64 * 1e3,
                (1.0 - lowest / n as f64 / incumbent) * 100.0, batch[0].region.middle, batch[0].region.half, batch[0].tube.level, batch[0].tube.len());
        }
        if t > limit_s { break; }
        let results: Vec<Vec<(Region, Evaluated)>> = batch
            .par_iter()
            .map(|open| {
                let h = open.region.half;
                let keys = [h[0] / 0.009, h[1] / 0.0125, h[2] / 0.0157];
                let side = (0..3).max_by(|a, b| keys[*a].total_cmp(&keys[*b])).unwrap();
                let tube = &open.tube;
                open.region.split(side).into_iter().map(|half| {
                    let mut tube = (**tube).clone();
                    let level = bounded.level(&half).unwrap_or(0);
                    while tube.level < level { tube = tube.halved(); }
                    let e = bounded.below(&half, &tube, ceiling);
                    (half, e)
                }).collect()
            })
            .collect();
        for (open, children) in batch.iter().zip(results) {
            for (region, e) in children {
                nodes += 1;
                states += e.states;
                let bound = e.sum.max(open.bound);
                if bound >= ceiling {
                    if bound < closed { closed = bound; }
                    continue;
                }
                number += 1;
                heap.push(Open { bound, number, region, tube: Arc::new(e.tube) });
            }
        }
    }
    let lowest = heap.peek().map_or(closed, |o: &Open| o.bound.min(closed));
    println!("made {:?}", bounded.table.count());
    println!("done {:.1}s nodes {nodes} states {states} open {} bound {:.7} gap {:.3} %", start.elapsed().as_secs_f64(), heap.len(), lowest / n as f64 * 1e3, (1.0 - lowest / n as f64 / incumbent) * 100.0);
}

pub fn trial(problem: &Problem, step: f64, headings: usize, rate: bool, incumbent: f64, gap: f64, limit: f64) {
    let (b, whole) = prepare(problem, (step, headings), rate);
    let t = std::time::Instant::now();
    let t = std::time::Instant::now();
    let rows = (((b.extent.radius.1 - b.extent.radius.0) / step).ceil() as usize + 1, ((b.extent.height.1 - b.extent.height.0) / step).ceil() as usize + 1);
    (0..rows.0 * rows.1).into_par_iter().for_each(|row| {
        for k in 0..headings { for class in crate::robot::PostureClass::ALL { b.table.node(&b.arm, 0, [row / rows.1, row % rows.1], k, class); } }
    });
    println!("level 0 {:?} {:?}", t.elapsed(), b.table.count());
    let reduced = super::reduced::Reduced::new(&b.arm, &b.table, &b.points, b.first, b.extent, Steps { length: step, headings });
    println!("reduced {:?} made {:?}", t.elapsed(), b.table.count());
    let n = b.points.len() as f64;
    let ceiling = incumbent * n * (1.0 - gap);
    let t = std::time::Instant::now();
    let mut open = vec![whole];
    let mut left = Vec::new();
    let mut count = 0;
    while !open.is_empty() {
        let bounds: Vec<Option<f64>> = open.par_iter().map(|r| reduced.below(&b.points, &b.segments, r)).collect();
        count += open.len();
        let mut next = Vec::new();
        for (r, bound) in open.iter().zip(bounds) {
            if bound.is_some_and(|v| v >= ceiling) { continue; }
            let keys = [r.half[0] / 0.009, r.half[1] / 0.0125, r.half[2] / 0.0157];
            let side = (0..3).max_by(|a, b| keys[*a].total_cmp(&keys[*b])).unwrap();
            if keys[side] <= 1.0 { left.push((bound.unwrap_or(0.0), *r)); } else { next.extend(r.split(side)); }
        }
        println!("level {} -> {} left {}", open.len(), next.len(), left.len());
        open = next;
    }
    let lowest = left.iter().map(|l| l.0).fold(f64::INFINITY, f64::min);
    println!("reduced search {:?} boxes {count} left {} lowest {:.5}", t.elapsed(), left.len(), lowest / n * 1e3);
    run_search(&b, left, incumbent, gap, limit);
}


