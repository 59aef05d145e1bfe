//! Segments that stand at places of their own along external axes, held together by what they share of a placement.
//!
//! Boxes of all segments are searched in one queue. What segments share (the yaw, the height, the coordinate across
//! rails) is divided into cells. Of every cell it is known what each segment costs at least in it: the least bound of
//! the boxes of that segment that reach it. A box is open as long as its own bound and what the other segments cost in
//! one of the cells that it reaches come to less than the ceiling.

use super::best::{Known, Spent, TABLES, count_box, parts};
use super::branch_and_bound::{BATCH, Bound, BranchAndBound, Open, OpenIn, Status, widest};
use super::cell::whole;
use super::coarse_bounds::CoarseBounds;
use super::keeps_open::KeepsOpen;
use super::load::Objective;
use super::model::Model;
use super::region::Region;
use super::requirements::Leaf;
use super::shared_cells::SharedCells;
use rayon::prelude::*;
use std::time::Instant;
use stead_numerics::monitor::Monitor;
use stead_problem::criterion::Aggregate;
use stead_problem::problem::Problem;
use stead_problem::sense::Sense;
use stead_problem::settings::CertificateSettings;

/// One segment, with the tables of all.
struct Segment {
    number: usize,
    model: Model,
    coarse: CoarseBounds,
}

/// A box of placements of one segment.
struct HeldBox {
    /// The place of its segment among those that count.
    segment: usize,
    open: Open<Known>,
    /// What the other segments cost at least where it reaches.
    others: f64,
    /// Whether it is not to be cut further.
    is_stuck: bool,
}

/// The segments that count, and what holds them together.
struct Apart {
    segments: Vec<Segment>,
    cells: SharedCells,
    objective: Objective,
    /// What the points have to cost together for a placement to be of interest.
    ceiling: f64,
    spent: Spent,
}

/// Of all open boxes one in so many is cut at a time, the most promising first; and all that are larger than this (in
/// terms of those that coarse tables begin with), of which little is known.
const PART: usize = 16;
const LARGE: f64 = 2.0;
/// What the bound of a box may yet gain, by its size up to the largest: shares of what a segment may cost in the mean.
const GAIN: f64 = 0.1;
const LARGEST: f64 = 4.0;

/// Bounds the objective of all placements of a problem from below, with other positions of its external axes for each
/// segment; `leaf` is the same problem in a cell that holds all places to which these bring the part.
pub(super) fn best(
    problem: &Problem,
    leaf: &Leaf,
    value: f64,
    settings: &CertificateSettings,
    monitor: &Monitor,
) -> (Bound, Vec<OpenIn>) {
    let CertificateSettings { gap, memory, .. } = *settings;
    let (spent, threads, since) = (Spent::default(), rayon::current_num_threads() as u64, Instant::now());
    let widened = &leaf.problem;
    let (model, whole) = (Model::of(widened, &leaf.pieces), whole(widened));
    let Model { keeps, objective, .. } = model;
    let search = BranchAndBound { sense: Sense::Min, value, gap, keeps, objective, memory };
    let coarse = match CoarseBounds::new(&model, monitor, || search.report(monitor, 0.0, 1, 0)) {
        Ok(coarse) => coarse,
        Err(stop) => return (search.not_begun(whole, stop), vec![OpenIn { boxes: 1, ..OpenIn::default() }]),
    };
    spent.add(TABLES, threads, since);
    let counts = |number: &usize| model.segments[*number].clone().any(|point| widened.point_weight(point) > 0.0);
    let segment = |number: usize| {
        let coarse = coarse.on_points(model.segments[number].clone());
        Segment { number, model: model.on_segment(number), coarse }
    };
    let segments: Vec<Segment> = (0..model.segments.len()).filter(counts).map(segment).collect();
    let cells = SharedCells::new(problem, widened);
    let apart = Apart { segments, cells, objective, ceiling: search.ceiling(), spent };
    let mut held = apart.start(whole);
    let mut nodes = held.len();
    let (status, bound) = loop {
        let Some(least) = apart.hold_together(&mut held) else { break (Status::Reached, apart.ceiling) };
        if let Some(stop) = search.report(monitor, objective.value(least), held.len(), nodes) {
            break (stop.into(), least);
        }
        let known: u64 = held.iter().filter_map(|held| held.open.known.as_ref()).map(|known| known.bytes()).sum();
        let of_boxes = known + size_of_val(held.as_slice()) as u64;
        if model.used() + coarse.used() + of_boxes + apart.cells.bytes(apart.segments.len()) > memory {
            break (Status::Memory, least);
        }
        if !apart.cut_some(&mut held, &mut nodes, monitor) {
            break (Status::Exhausted, least);
        }
    };
    apart.found(held, |open| search.ended(bound, nodes, status, open), value)
}

impl Apart {
    /// All placements, of each segment.
    fn start(&self, whole: Region) -> Vec<HeldBox> {
        let of = |segment| {
            let open = Open { bound: 0.0, region: whole, known: None };
            HeldBox { segment, open, others: 0.0, is_stuck: false }
        };
        (0..self.segments.len()).map(of).collect()
    }

    /// Drops the boxes that cannot be part of a placement below the ceiling, and notes for the others what the other
    /// segments cost at least where they reach. Returns what all of them cost together at least, if something is left.
    fn hold_together(&self, held: &mut Vec<HeldBox>) -> Option<f64> {
        let Self { segments, cells, .. } = self;
        let (count, segments) = (cells.count(), segments.len());
        let mut least = vec![f64::INFINITY; segments * count];
        least.par_chunks_mut(count).enumerate().for_each(|(segment, least)| {
            for one in held.iter().filter(|one| one.segment == segment) {
                cells.reached(&one.open.region, |cell| least[cell] = least[cell].min(one.open.bound));
            }
        });
        let others = self.others(&least, count);
        held.par_iter_mut().for_each(|one| {
            let mut found = f64::INFINITY;
            cells.reached(&one.open.region, |cell| found = found.min(others[one.segment * count + cell]));
            one.others = found;
        });
        held.retain(|one| self.come_to(one) < self.ceiling);
        held.iter().map(|one| self.come_to(one)).min_by(f64::total_cmp)
    }

    /// Segment by segment, and cell by cell, of which there are so many: what the others cost together, of what each
    /// costs at least.
    fn others(&self, least: &[f64], count: usize) -> Vec<f64> {
        let aggregate = self.objective.aggregate;
        let mut others = vec![0.0; least.len()];
        let (mut before, mut after) = (vec![0.0; count], vec![0.0; count]);
        let mut add = |place: usize, sums: &mut [f64]| {
            for (cell, sum) in sums.iter_mut().enumerate() {
                let at = place * count + cell;
                others[at] = aggregate.join(others[at], *sum);
                *sum = aggregate.join(*sum, least[at]);
            }
        };
        (0..self.segments.len()).for_each(|place| add(place, &mut before));
        (0..self.segments.len()).rev().for_each(|place| add(place, &mut after));
        others
    }

    /// What all segments cost together where a box reaches, at least.
    fn come_to(&self, held: &HeldBox) -> f64 {
        self.objective.aggregate.join(held.open.bound, held.others)
    }

    /// Boxes of the least are cut first: what all segments cost together where it reaches, less what its own bound may
    /// gain. So of the boxes that keep a cell low those come first of which least is known: with low bounds of others
    /// all of them would have to be cut as far.
    fn rank(&self, held: &HeldBox) -> f64 {
        let share = self.ceiling / self.segments.len() as f64;
        self.come_to(held) - GAIN * share * widest(&held.open.region).1.min(LARGEST)
    }

    /// Cuts some boxes in two, or bounds them by cells of heading; false where none of them is to be cut further.
    fn cut_some(&self, held: &mut Vec<HeldBox>, nodes: &mut usize, monitor: &Monitor) -> bool {
        held.sort_by(|a, b| self.rank(a).total_cmp(&self.rank(b)));
        let large = held.iter().rposition(|held| widest(&held.open.region).1 > LARGE).map_or(0, |last| last + 1);
        let some = (held.len() / PART).max(BATCH).min(held.len()).max(large);
        if held[..some].iter().all(|held| held.is_stuck) {
            return false;
        }
        let rest = held.split_off(some);
        // What a box comes to after the caller has asked to stop says nothing: it stays as it was.
        let cut = |held: &HeldBox| match monitor.should_stop() {
            true => Err(()),
            false => Ok(self.cut(held, monitor)).and_then(|cut| if monitor.should_stop() { Err(()) } else { Ok(cut) }),
        };
        let results: Vec<_> = held.par_iter().with_max_len(1).map(cut).collect();
        for (whole, cut) in std::mem::take(held).into_iter().zip(results) {
            match cut {
                Err(()) => held.push(whole),
                Ok(None) => held.push(HeldBox { is_stuck: true, ..whole }),
                Ok(Some(parts)) => {
                    *nodes += parts.len();
                    held.extend(parts.into_iter().map(|open| HeldBox { open, ..whole }));
                }
            }
        }
        held.extend(rest);
        true
    }

    /// The parts of a box; `None` where it is not to be cut further.
    fn cut(&self, held: &HeldBox, monitor: &Monitor) -> Option<Vec<Open<Known>>> {
        if held.is_stuck {
            return None;
        }
        let Segment { model, coarse, .. } = &self.segments[held.segment];
        let most = match self.objective.aggregate {
            Aggregate::Mean | Aggregate::Rms => self.ceiling - held.others,
            Aggregate::Max => self.ceiling,
        };
        self.spent.on_parts(|| parts(model, coarse, &held.open, most, monitor))
    }

    /// The bound that `ended` makes of the boxes that are left, and how many are of each segment.
    fn found(
        &self,
        mut held: Vec<HeldBox>,
        ended: impl FnOnce(Vec<(Region, f64)>) -> Bound,
        value: f64,
    ) -> (Bound, Vec<OpenIn>) {
        held.sort_by_key(|held| held.segment);
        let of = |(place, segment): (usize, &Segment)| {
            let boxes = held.iter().filter(|held| held.segment == place).count();
            OpenIn { segment: Some(segment.number + 1), boxes, ..OpenIn::default() }
        };
        let open_in = self.segments.iter().enumerate().map(of).collect();
        let come_to = |held: &HeldBox| (held.open.region, self.objective.value(self.come_to(held)));
        let mut bound = ended(held.iter().map(come_to).collect());
        if !matches!(bound.status, Status::Reached | Status::Interrupted) {
            let known: Vec<(usize, Known)> = held.into_iter().map(|held| (held.segment, held.open.known)).collect();
            bound.keeps_open = KeepsOpen::of(&bound.open, &known, |counted, region, (segment, known)| {
                count_box(&self.segments[*segment].model, counted, region, known, value);
                // Of one segment they say nothing of the value.
                counted.sums = None;
                counted.seconds = Some(self.spent.seconds()).filter(|_| bound.status == Status::TimeLimit);
            });
        }
        (bound, open_in)
    }
}
