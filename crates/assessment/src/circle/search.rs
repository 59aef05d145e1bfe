//! The global search for a centre: branch and bound with cutting planes.
//!
//! Sought is the centre with the smallest *objective*: the reach of the farthest point less that of the nearest for the
//! minimum zone, and less the distance of the nearest alone for the maximum inscribed circle. A cell is a convex
//! polygon of centres and the points that may be farthest or nearest somewhere in it. Seen from its centroid, farthest
//! and nearest point give a plane that the objective exceeds everywhere in the cell, but for a bound on the bending
//! that shrinks with the square of the size. Where the plane is above the best objective known, the cell is cut off;
//! where that takes away too little it is split. What is left in the end is nothing, which proves the best one best.

use super::chart::{Chart, Point, farthest, nearest};
use super::hull::Hull;
use super::polygon::Polygon;
use std::rc::Rc;

/// What counts as no better: a part of the objective, and some roundings of numbers of unit size.
const RELATIVE: f64 = 1e-13;
const ABSOLUTE: f64 = 2e-15;
/// A cell of this size has no better centre in it than its own, but for rounding.
const MIN_SIZE: f64 = 1e-15;
/// A cut that leaves this part of a cell, or more, calls for a split.
const TOO_LITTLE: f64 = 0.7;
/// Of lists longer than this only one in [`STRIDE`] points is looked at first, which gives weaker cuts for less work.
const LONG: usize = 8192;
const STRIDE: usize = 97;
/// Lists shorter than this are not worth filtering.
const SHORT: usize = 12;

/// A search on one chart.
pub(super) struct CentreSearch<'a> {
    /// Points that may be farthest from a centre; none where the objective does not ask for the farthest.
    pub outer: &'a [Point],
    /// Points that may be nearest.
    pub inner: &'a [Point],
    /// Where the centre must lie, besides the rectangle searched.
    pub fence: Option<&'a Hull>,
}

/// A centre by its chart coordinates, and its objective.
#[derive(Clone, Copy, Debug)]
pub(super) struct BestCentre {
    pub coordinates: Point,
    pub objective: f64,
}

struct Cell {
    polygon: Polygon,
    lists: Rc<Lists>,
}

/// Points that may count in a cell of a size, in full and thinned out.
struct Lists {
    outer: Vec<Point>,
    inner: Vec<Point>,
    size: f64,
}

/// What there is to see from one centre.
struct View {
    far: f64,
    near: f64,
    far_gradient: Point,
    near_gradient: Point,
}

impl CentreSearch<'_> {
    /// The best centre in a rectangle of chart coordinates, if it is better than `known`, which is a bound on the
    /// objective.
    pub fn best<C: Chart>(&self, from: Point, to: Point, known: f64) -> Option<BestCentre> {
        let mut best = BestCentre { coordinates: from, objective: known };
        let lists = Lists { outer: self.outer.to_vec(), inner: self.inner.to_vec(), size: f64::INFINITY };
        let mut cells = vec![Cell { polygon: Polygon::rectangle(from, to), lists: Rc::new(lists) }];
        while let Some(cell) = cells.pop() {
            if let Some(halves) = self.shrink::<C>(cell, &mut best) {
                cells.extend(halves);
            }
        }
        (best.objective < known).then_some(best)
    }

    /// Cuts a cell until it is empty or must be split.
    fn shrink<C: Chart>(&self, mut cell: Cell, best: &mut BestCentre) -> Option<[Cell; 2]> {
        let mut thin = (cell.lists.inner.len() > LONG).then(|| cell.lists.thinned());
        while !cell.polygon.is_empty() {
            let (area, middle) = cell.polygon.area_and_centroid();
            let (_, size) = cell.polygon.farthest(middle);
            let at = C::at(middle);
            let lists = thin.as_ref().unwrap_or(&cell.lists);
            let view = lists.view::<C>(&at);
            let is_inside = self.fence.is_none_or(|hull| confine(hull, middle, &mut cell.polygon));
            if thin.is_none() && is_inside && view.objective() < best.objective {
                *best = BestCentre { coordinates: middle, objective: view.objective() };
            }
            if size <= MIN_SIZE {
                // Seen in part only, it is looked at once more in full.
                thin.take()?;
                continue;
            }
            let goal = best.objective - ABSOLUTE - RELATIVE * best.objective.abs();
            view.cut::<C>(middle, size, goal, &mut cell.polygon);
            if cell.polygon.is_empty() {
                return None;
            }
            let (left, centre) = cell.polygon.area_and_centroid();
            if thin.is_some() {
                if left >= TOO_LITTLE * area {
                    thin = None;
                }
                continue;
            }
            if size < 0.5 * cell.lists.size && cell.lists.inner.len() + cell.lists.outer.len() > SHORT {
                // The cell has only become smaller, so the size about the former middle is still good.
                cell.lists = Rc::new(cell.lists.filtered::<C>(&at, &view, size));
            }
            // As good as no area is left of a cell that a cut has narrowed to a line: it is split until it is short.
            if left >= TOO_LITTLE * area {
                let halves = cell.polygon.split(centre);
                return Some(halves.map(|polygon| Cell { polygon, lists: Rc::clone(&cell.lists) }));
            }
        }
        None
    }
}

/// Cuts a polygon of centres at the edge of the hull that faces a place, if the place is outside, and says whether it
/// is inside.
fn confine(hull: &Hull, place: Point, polygon: &mut Polygon) -> bool {
    let (corner, along) = hull.facing(place);
    let outward = [along[1], -along[0]];
    let is_inside = outward[0] * (place[0] - corner[0]) + outward[1] * (place[1] - corner[1]) <= 0.0;
    polygon.cut(corner, outward, 0.0);
    is_inside
}

impl Lists {
    fn thinned(&self) -> Self {
        let some = |points: &[Point]| points.iter().copied().step_by(STRIDE).collect();
        Self { outer: some(&self.outer), inner: some(&self.inner), size: self.size }
    }

    fn view<C: Chart>(&self, at: &C::At) -> View {
        let (near_point, near) = nearest::<C>(at, &self.inner);
        let (_, near_gradient, _) = C::derivatives(at, &near_point);
        if self.outer.is_empty() {
            return View { far: 0.0, near, far_gradient: [0.0, 0.0], near_gradient };
        }
        let (far_point, far) = farthest::<C>(at, &self.outer);
        let (_, far_gradient, _) = C::derivatives(at, &far_point);
        View { far, near, far_gradient, near_gradient }
    }

    /// What may still count within a size about a centre.
    fn filtered<C: Chart>(&self, at: &C::At, view: &View, size: f64) -> Self {
        let slack = 2.0 * C::STEEPEST * size + ABSOLUTE;
        let reach = |p: &Point| C::reach(C::key(at, p));
        Self {
            outer: self.outer.iter().copied().filter(|p| reach(p) >= view.far - slack).collect(),
            inner: self.inner.iter().copied().filter(|p| reach(p) <= view.near + slack).collect(),
            size,
        }
    }
}

impl View {
    fn objective(&self) -> f64 {
        self.far - self.near
    }

    /// Cuts off where the objective cannot be below the goal, in a polygon of a size about the place seen from.
    fn cut<C: Chart>(&self, place: Point, size: f64, goal: f64, polygon: &mut Polygon) {
        let below = self.far - 0.5 * C::bend_below(self.far) * size * size;
        let bent = self.near + 0.5 * C::bend_above(self.near) * size * size;
        let ([fx, fy], [nx, ny]) = (self.far_gradient, self.near_gradient);
        polygon.cut(place, [fx - nx, fy - ny], goal - below + bent);
        // Close to a point its distance bends too much; it still grows no faster than its steepest.
        let steep = self.near + C::STEEPEST * size;
        if steep < bent && !polygon.is_empty() {
            polygon.cut(place, [fx, fy], goal - below + steep);
        }
    }
}
