//! What a certificate leaves open, over the cell.

use super::axes::Panel;
use super::canvas::{Canvas, TextStyle, picture};
use super::cell_view::CellView;
use super::colour::{GREY, INK, LEVELS, ORANGE, viridis};
use super::heat_map::ColouredCells;
use crate::units::fixed;
use stead_certify::{OpenBox, Proof};
use stead_model::robot::angles::wrap;
use stead_problem::problem::Problem;
use stead_problem::sense::Sense;
use stead_problem::symmetry::about_axis_1;

/// Pixels between panels, and the side of a panel.
const LEFT: [i32; 2] = [85, 635];
const TOP: i32 = 110;
const SIDE: i32 = 455;
/// Coloured cells along each side of a panel.
const CELLS: usize = 160;
/// Narrower ranges are drawn this wide. mm
const MIN_WIDTH: f64 = 10.0;

/// The boxes of placements that a certificate leaves open: where the workpiece origin may stand, from above, and over
/// the yaw less the azimuth, each place in the colour of the most promising box there. The dot is the placement found.
pub fn open_region(problem: &Problem, proof: &Proof) -> String {
    picture((1110, 690), |canvas| {
        let boxes = proof.open_boxes(problem);
        let colours = Colours::new(proof, &boxes);
        heading(canvas, proof, boxes.len());
        from_above(canvas, problem, proof, &boxes, &colours);
        turned(canvas, problem, proof, &boxes, &colours);
        colours.legend(canvas, proof)
    })
}

fn heading(canvas: &mut Canvas, proof: &Proof, count: usize) {
    let (title, past) = match proof.sense {
        Sense::Min => ("What the certificate of the best placement leaves open", "better"),
        Sense::Max => ("What the certificate of the worst placement leaves open, rate of beta dropped", "worse"),
    };
    canvas.title(title, (LEFT[0], 24));
    let gap = fixed(proof.gap_percent(), 4);
    let words = if count == 0 {
        format!("Nothing: no placement in the cell is {past} by more than {gap} %")
    } else {
        format!("{count} boxes of placements, in any of them one may be {past}; by {gap} % at most")
    };
    canvas.text(&words, (LEFT[0], 52), TextStyle::new(13.0).coloured(INK))
}

/// The cell from above. What is open is so at every azimuth: turning workpiece and joint 1 together changes nothing.
fn from_above(canvas: &mut Canvas, problem: &Problem, proof: &Proof, boxes: &[OpenBox], colours: &Colours) {
    let [x, y, _] = problem.cell.position.map(|range| widened(range.min * 1e3, range.max * 1e3));
    let side = 1.1 * (x[1] - x[0]).max(y[1] - y[0]);
    let about = |range: [f64; 2]| [0.5, -0.5].map(|sign| (range[0] + range[1]) / 2.0 - sign * side);
    let panel = panel(LEFT[0], about(x), about(y), ["x (mm)", "y (mm)"]);
    let root = problem.robot.geometry().root_in_base * 1e3;
    // How far the places of a coloured cell are from axis 1.
    let radii = |column: usize, row: usize| {
        let part = |range: [f64; 2], k: usize, from: f64| {
            [0, 1].map(|end| range[0] + (range[1] - range[0]) * (k + end) as f64 / CELLS as f64 - from)
        };
        let (dx, dy) = (part(x, column, root.x), part(y, row, root.y));
        let near = |d: [f64; 2]| d[0].max(-d[1]).max(0.0);
        let far = |d: [f64; 2]| d[0].abs().max(d[1].abs());
        [libm::hypot(near(dx), near(dy)), libm::hypot(far(dx), far(dy))]
    };
    let corners = [0, CELLS - 1].map(|c| [0, CELLS - 1].map(|r| radii(c, r)));
    let max = corners.iter().flatten().fold(0.0_f64, |max, r| max.max(r[1]));
    // The best box at every radius, in steps much finer than the coloured cells.
    let rings = Grid { from: [0.0, 0.0], to: [max.max(1.0), 1.0], counts: [16 * CELLS, 1] };
    let lowest =
        rings.filled(boxes.iter().map(|open| ([open.radius.map(|r| r * 1e3), [0.0, 1.0]], open.bound)), proof.sense);
    let levels: Vec<Option<usize>> = (0..CELLS * CELLS)
        .map(|k| {
            let [near, far] = radii(k % CELLS, k / CELLS);
            let [first, last] = rings.span(0, near, far);
            let here = lowest[first..=last].iter().copied().flatten();
            here.reduce(|a, b| more_promising(proof.sense, a, b)).map(|bound| colours.level(bound))
        })
        .collect();
    panel.draw_grid(canvas);
    let grid = Grid { from: [x[0], y[0]], to: [x[1], y[1]], counts: [CELLS, CELLS] };
    grid.draw(canvas, &panel, levels);
    let view = CellView { problem, panel };
    view.limits(canvas);
    let place = view.panel.place(proof.placement.x * 1e3, proof.placement.y * 1e3);
    canvas.dot(place, 4, ORANGE);
    canvas.text("Workpiece origin from above", (LEFT[0], TOP - 14), TextStyle::new(13.0).bold().coloured(INK));
    view.panel.draw_frame(canvas)
}

/// Distance from axis 1 over the yaw less the azimuth.
fn turned(canvas: &mut Canvas, problem: &Problem, proof: &Proof, boxes: &[OpenBox], colours: &Colours) {
    let root = problem.robot.geometry().root_in_base;
    let [own, _, turn] = about_axis_1(problem, &proof.placement);
    let (own, turn) = (own * 1e3, wrap(turn).to_degrees());
    let [x, y, _] = problem.cell.position;
    let distance = |x: f64, y: f64| libm::hypot(x - root.x, y - root.y) * 1e3;
    let far = [(x.min, y.min), (x.min, y.max), (x.max, y.min), (x.max, y.max)].map(|(x, y)| distance(x, y));
    let near = distance(x.clamp(root.x), y.clamp(root.y));
    let radius = widened(near, far.into_iter().fold(near, f64::max));
    let grid = Grid { from: [-180.0, radius[0]], to: [180.0, radius[1]], counts: [CELLS, CELLS] };
    let places = boxes.iter().map(|open| ([open.turn.map(f64::to_degrees), open.radius.map(|r| r * 1e3)], open.bound));
    let levels: Vec<Option<usize>> =
        grid.filled(places, proof.sense).into_iter().map(|bound| bound.map(|bound| colours.level(bound))).collect();
    let panel = panel(LEFT[1], [-180.0, 180.0], radius, ["yaw less azimuth (deg)", "distance from axis 1 (mm)"]);
    panel.draw_grid(canvas);
    grid.draw(canvas, &panel, levels);
    canvas.dot(panel.place(turn, own), 4, ORANGE);
    canvas.text("Workpiece origin and yaw", (LEFT[1], TOP - 14), TextStyle::new(13.0).bold().coloured(INK));
    panel.draw_frame(canvas)
}

fn widened(from: f64, to: f64) -> [f64; 2] {
    let more = ((MIN_WIDTH - (to - from)) / 2.0).max(0.0);
    [from - more, to + more]
}

fn panel(left: i32, x: [f64; 2], y: [f64; 2], labels: [&'static str; 2]) -> Panel {
    Panel::square([[x[0], y[0]], [x[1], y[1]]], (left, TOP), SIDE, labels)
}

fn more_promising(sense: Sense, a: f64, b: f64) -> f64 {
    match sense {
        Sense::Min => a.min(b),
        Sense::Max => a.max(b),
    }
}

/// A rectangle of coloured cells.
struct Grid {
    from: [f64; 2],
    to: [f64; 2],
    counts: [usize; 2],
}

impl Grid {
    /// The first and the last cell that a range touches, ends of the grid at most.
    fn span(&self, axis: usize, from: f64, to: f64) -> [usize; 2] {
        let (count, width) = (self.counts[axis], self.to[axis] - self.from[axis]);
        let last = count - 1;
        let at = |value: f64| (value - self.from[axis]) / width * count as f64;
        let first = (at(from).max(0.0) as usize).min(last);
        [first, ((at(to).ceil() - 1.0).max(0.0) as usize).min(last).max(first)]
    }

    /// The most promising bound in each cell.
    fn filled(&self, places: impl Iterator<Item = ([[f64; 2]; 2], f64)>, sense: Sense) -> Vec<Option<f64>> {
        let mut cells = vec![None; self.counts[0] * self.counts[1]];
        for ([across, up], bound) in places {
            let ([left, right], [low, high]) = (self.span(0, across[0], across[1]), self.span(1, up[0], up[1]));
            for row in low..=high {
                for cell in &mut cells[row * self.counts[0]..][left..=right] {
                    *cell = Some(cell.map_or(bound, |known| more_promising(sense, known, bound)));
                }
            }
        }
        cells
    }

    fn draw(&self, canvas: &mut Canvas, panel: &Panel, levels: Vec<Option<usize>>) {
        let value = |axis: usize, k: usize| {
            self.from[axis] + (self.to[axis] - self.from[axis]) * k as f64 / self.counts[axis] as f64
        };
        let columns = (0..=self.counts[0]).map(|k| panel.x.pixel(value(0, k))).collect();
        let rows = (0..=self.counts[1]).map(|k| panel.y.pixel(value(1, k))).collect();
        ColouredCells { columns, rows, cells: levels }.draw_merged(canvas, viridis);
    }
}

/// Colours of bounds, dark for the most promising.
struct Colours {
    best: f64,
    worst: f64,
}

impl Colours {
    fn new(proof: &Proof, boxes: &[OpenBox]) -> Self {
        let bounds = || boxes.iter().map(|open| open.bound).filter(|bound| bound.is_finite());
        let (low, high) = bounds().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), b| (l.min(b), h.max(b)));
        match proof.sense {
            Sense::Min => Self { best: low, worst: high },
            Sense::Max => Self { best: high, worst: low },
        }
    }

    fn level(&self, bound: f64) -> usize {
        let part = (bound - self.best) / (self.worst - self.best);
        if part.is_finite() { (part.clamp(0.0, 1.0) * (LEVELS - 1) as f64).round() as usize } else { 0 }
    }

    fn legend(&self, canvas: &mut Canvas, proof: &Proof) {
        let y = TOP + SIDE + 76;
        let small = TextStyle::new(12.0).coloured(INK);
        canvas.dot((f64::from(LEFT[1]), f64::from(y)), 4, ORANGE);
        canvas.text("the placement found", (LEFT[1] + 14, y), small);
        if !self.best.is_finite() || !self.worst.is_finite() {
            return;
        }
        let (left, width) = (LEFT[0] + 110, 8);
        for level in 0..LEVELS {
            let x = left + width * level as i32;
            canvas.fill((x, y - 8), (x + width, y + 8), viridis(level));
        }
        let right = left + width * LEVELS as i32;
        canvas.outline((left, y - 8), (right, y + 8), GREY);
        let label = |bound: f64| format!("{} mm", fixed(proof.rounded_mm(bound), 5));
        canvas.text(&label(self.best), (left - 8, y), small.ending());
        canvas.text(&label(self.worst), (right + 8, y), small)
    }
}
