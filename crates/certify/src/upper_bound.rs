//! An upper bound of the objective over a box of placements, without the limits between neighbouring points.
//!
//! What is bounded is the relaxed value of [`super::relaxed_value`]: the mean over the points of the least score over
//! the heading, in the best posture class of each segment. For one box of placements and one posture class of a segment
//! - every point has a cell of heading that is surely allowed all over the box: the sum of what these cost bounds the
//!   class, and the best of such classes the segment;
//! - some point has no cell that may be allowed: the class is out, and where all are out the box holds no placement;
//! - else the class may be allowed in part of the box, and its sum there is at most that of the greatest costs of cells
//!   that may be allowed. Only where no class is of the first kind does this count, and then the greatest over classes.
//!
//! All these are convex functions of the placement, so the greatest value is at a corner of the box. Cells of heading
//! are sought near those that were best in the box it was cut from; where that is not enough, among all.

use super::branch_and_bound::Open;
use super::compliance_table::Node;
use super::cost::{CORNERS, PointCost, Without};
use super::model::Model;
use super::region::Region;
use super::sliding_min::plus;
use std::f64::consts::TAU;
use std::sync::Arc;
use stead_model::robot::PostureClass;
use stead_numerics::monitor::Monitor;

/// What a point may cost in the first, quick bound, as a share of the mean that is to be stayed below.
const CHEAP: f64 = 0.8;
/// Below this level, all cells are evaluated where those near the known ones are not enough.
const FINE: usize = 2;
/// Cells evaluated to either side of the best one.
const NEIGHBOURS: usize = 3;
/// No cell known.
const NONE: u16 = u16::MAX;
/// A sum of which nothing is known, and the greatest of no sums.
const ANYTHING: [f64; CORNERS] = [f64::INFINITY; CORNERS];
const NOTHING: [f64; CORNERS] = [f64::NEG_INFINITY; CORNERS];

/// What is known of a box and inherited by its halves.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Inherited {
    /// Level of the table.
    level: usize,
    /// For each point and class the best surely allowed cell.
    cells: Vec<u16>,
    /// For each segment, which classes are allowed nowhere in the box.
    out: Vec<[bool; 4]>,
}

impl Inherited {
    /// What it takes. bytes
    pub fn bytes(&self) -> u64 {
        (size_of_val(self.cells.as_slice()) + size_of_val(self.out.as_slice())) as u64
    }

    pub fn nothing(model: &Model) -> Self {
        let (points, segments) = (model.points.len(), model.segments.len());
        Self { level: 0, cells: vec![NONE; points * 4], out: vec![[false; 4]; segments] }
    }
}

/// A box, and what its halves inherit: `None` where it was not bounded in detail yet.
pub(super) type WorstBox = Open<Option<Arc<Inherited>>>;

/// A part of a box with its bound; where the box was not bounded in detail yet, quickly if that is enough to get below
/// `ceiling`. m
pub(super) fn bounded(model: &Model, of: &WorstBox, region: Region, ceiling: f64, monitor: &Monitor) -> WorstBox {
    let seen = of.known.clone().unwrap_or_else(|| Arc::new(Inherited::nothing(model)));
    let Some(over) = BoxBounds::new(model, &region, monitor) else {
        return Open { bound: of.bound, region, known: Some(seen) };
    };
    let quick = if of.known.is_none() { over.quick_bound(ceiling) } else { f64::INFINITY };
    if quick <= ceiling {
        return Open { bound: quick, region, known: None };
    }
    let (sum, seen) = over.upper_bound(&seen, ceiling);
    Open { bound: sum.min(of.bound), region, known: Some(Arc::new(seen)) }
}

/// One class of one segment over a box.
#[derive(Debug, Clone)]
struct ClassBound {
    class: PostureClass,
    sum: [f64; CORNERS],
    /// Points for which no surely allowed cell is known.
    missing: Vec<usize>,
    /// Whether it is surely allowed all over the box.
    sure: bool,
}

/// One box on one level.
pub(super) struct BoxBounds<'a> {
    model: &'a Model,
    region: &'a Region,
    /// Once it asks to stop, what is returned is no bound.
    monitor: &'a Monitor,
    /// `None` for a point that may be near axis 1, so that nothing is known of it.
    pub points: Vec<Option<PointCost<'a>>>,
    pub level: usize,
}

impl<'a> BoxBounds<'a> {
    /// `None` for one too large for the tables.
    pub fn new(model: &'a Model, region: &'a Region, monitor: &'a Monitor) -> Option<Self> {
        let level = model.level(region)?;
        Some(Self { model, region, monitor, points: model.point_costs(region, Without::Nothing), level })
    }

    /// Bounds cells of one point and class: the best of those surely allowed, and the greatest costs of all that may
    /// be.
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    fn bound_cells(&self, point: usize, class: PostureClass, cells: impl Iterator<Item = usize>) -> CellBounds {
        let Model { table, arm, .. } = self.model;
        let mut bounds = CellBounds { best: None, max: NOTHING };
        let half_cell = 0.5 * TAU / table.headings(self.level) as f64;
        let placed = self.points[point].as_ref();
        let found = placed.and_then(|p| Some((p, table.answer(arm, self.level, &p.placed)?)));
        let Some((pointwise, (nodes, off))) = found else {
            bounds.max = ANYTHING;
            return bounds;
        };
        let mut min_size = f64::INFINITY;
        for cell in cells {
            let (node, moments) = nodes.known(cell, class);
            match node {
                Node::Empty => {}
                Node::Unknown => bounds.max = ANYTHING,
                Node::Known(known) => {
                    let of = |choice: bool| pointwise.max_cost((known, moments), off, half_cell, self.region, choice);
                    if known.sure {
                        let costs = of(true);
                        let size: f64 = costs.iter().sum();
                        if size < min_size {
                            min_size = size;
                            bounds.best = Some((cell, costs));
                        }
                    }
                    if bounds.best.is_none() {
                        let costs = of(false);
                        bounds.max = std::array::from_fn(|k| bounds.max[k].max(costs[k]));
                    }
                }
            }
        }
        bounds
    }

    /// The bounds of a segment, class by class, from cells near those known.
    fn class_bounds(&self, segment: usize, before: &Inherited, seen: &mut Inherited) -> Vec<ClassBound> {
        let count = self.model.table.headings(self.level);
        let finer = self.level.saturating_sub(before.level);
        let coarser = before.level.saturating_sub(self.level);
        let mut ways = Vec::new();
        for class in PostureClass::ALL {
            if seen.out[segment][class.index()] {
                continue;
            }
            let mut way = ClassBound { class, sum: [0.0; CORNERS], missing: Vec::new(), sure: true };
            for point in self.model.segments[segment].clone() {
                let place = point * 4 + class.index();
                let cell = before.cells[place];
                let found = (cell != NONE && !self.monitor.should_stop()).then(|| {
                    let middle = ((usize::from(cell) << finer) + (1 << finer) / 2) >> coarser;
                    let near = (0..2 * NEIGHBOURS + 1).map(|k| (middle + count + k - NEIGHBOURS) % count);
                    self.bound_cells(point, class, near).best
                });
                if let Some(Some((cell, costs))) = found {
                    seen.cells[place] = cell as u16;
                    way.sum = plus(&way.sum, &costs);
                } else {
                    seen.cells[place] = NONE;
                    way.missing.push(point);
                }
            }
            ways.push(way);
        }
        ways
    }

    /// A sum that is enough for most boxes: of each point the first cell found that is cheap, in the first class that
    /// has one for each point; infinite where that is not enough. m
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    pub fn quick_bound(&self, ceiling: f64) -> f64 {
        let count = self.model.table.headings(self.level);
        let cheap = CHEAP * ceiling / self.points.len() as f64;
        let mut totals = [0.0; CORNERS];
        for span in &self.model.segments {
            let through = |class: PostureClass| {
                let (mut sum, mut start) = ([0.0; CORNERS], 0);
                for point in span.clone() {
                    if self.monitor.should_stop() {
                        return None;
                    }
                    let found = (0..count).map(|k| (start + k) % count).find_map(|cell| {
                        let (cell, costs) = self.bound_cells(point, class, std::iter::once(cell)).best?;
                        (greatest(&costs) <= cheap).then_some((cell, costs))
                    });
                    let (cell, costs) = found?;
                    (sum, start) = (plus(&sum, &costs), cell);
                }
                Some(sum)
            };
            match PostureClass::ALL.into_iter().find_map(through) {
                Some(sum) => totals = plus(&totals, &sum),
                None => return f64::INFINITY,
            }
        }
        greatest(&totals)
    }

    /// Bounds all cells of the points missing; false for a class that is allowed nowhere in the box.
    fn complete(&self, segment: usize, way: &mut ClassBound, seen: &mut Inherited) -> bool {
        let count = self.model.table.headings(self.level);
        for point in std::mem::take(&mut way.missing) {
            if self.monitor.should_stop() {
                return false;
            }
            let bounds = self.bound_cells(point, way.class, 0..count);
            match bounds.best {
                Some((cell, costs)) => {
                    seen.cells[point * 4 + way.class.index()] = cell as u16;
                    way.sum = plus(&way.sum, &costs);
                }
                None if bounds.max == NOTHING => {
                    seen.out[segment][way.class.index()] = true;
                    return false;
                }
                None => {
                    way.sure = false;
                    way.sum = plus(&way.sum, &bounds.max);
                }
            }
        }
        true
    }

    /// The sum of the scores over the box, at most; minus infinity where nothing is allowed. With the cells known from
    /// `before` only where that is enough to get below `ceiling`. m
    pub fn upper_bound(&self, before: &Inherited, ceiling: f64) -> (f64, Inherited) {
        let mut seen = before.clone();
        seen.level = self.level;
        let segments = 0..self.model.segments.len();
        let mut all: Vec<Vec<ClassBound>> = segments.map(|s| self.class_bounds(s, before, &mut seen)).collect();
        let sure = |ways: &[ClassBound]| total(ways.iter().filter(|w| w.missing.is_empty()));
        let totals = all.iter().fold([0.0; CORNERS], |sum, ways| plus(&sum, &sure(ways)));
        if greatest(&totals) <= ceiling {
            return (greatest(&totals), seen);
        }
        if self.level < FINE {
            for (way, segment) in all.iter_mut().enumerate().flat_map(|(s, ways)| ways.iter_mut().map(move |w| (w, s)))
            {
                way.sum = [0.0; CORNERS];
                way.missing = self.model.segments[segment].clone().collect();
            }
        }
        let mut totals = [0.0; CORNERS];
        for (segment, ways) in all.iter_mut().enumerate() {
            ways.retain_mut(|way| self.complete(segment, way, &mut seen));
            if ways.is_empty() {
                return (f64::NEG_INFINITY, seen);
            }
            totals = plus(&totals, &total(ways.iter()));
        }
        (greatest(&totals), seen)
    }
}

/// Bounds of one point and class over some cells.
struct CellBounds {
    /// The best surely allowed cell with what it costs.
    best: Option<(usize, [f64; CORNERS])>,
    /// Where there is none: the greatest costs of all cells that may be allowed.
    max: [f64; CORNERS],
}

/// What a segment costs at most, by its ways: the best sure one, or else the greatest.
fn total<'a>(ways: impl Iterator<Item = &'a ClassBound> + Clone) -> [f64; CORNERS] {
    let size = |way: &ClassBound| way.sum.iter().sum::<f64>();
    match ways.clone().filter(|way| way.sure).min_by(|a, b| size(a).total_cmp(&size(b))) {
        Some(way) => way.sum,
        None => {
            let max = ways.fold(NOTHING, |max, way| std::array::from_fn(|k| f64::max(max[k], way.sum[k])));
            if max == NOTHING { ANYTHING } else { max }
        }
    }
}

fn greatest(values: &[f64; CORNERS]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}
