//! The circularity over a plane for one elbow: the map as colours and contour lines, zones, and the most accurate
//! place.

use super::axes::{Panel, Ticks, Window, around};
use super::canvas::{Canvas, Pixel, Place, exact, nearest};
use super::colour::{BEST, BLACK, INK, WHITE, WORST, contrast, viridis};
use super::contour::contour;
use super::heat_map::{ColourRange, HeatMap};
use super::labels::{Area, Label, Labeller, whole_or_figures};
use super::plane_view::{ArmInPlane, PlaneView};
use stead_assessment::comparison::Configuration;
use stead_assessment::map::Map;
use stead_assessment::zone::Zone;

/// Most letters of a label of a tick without a power of ten.
const MAX_LETTERS: usize = 7;
/// A contour line is labelled when it is so many times as long as its label.
const LONG: f64 = 1.5;

/// The nodes of a map in the units of the picture.
pub(super) struct Nodes {
    /// Circularity in mm, infinite where there is none, along the first axis fastest.
    pub values: Vec<f64>,
    columns: usize,
    /// Coordinates of the first node. mm
    origin: [f64; 2],
    /// Distance between neighbours. mm
    step: f64,
}

impl Nodes {
    /// Every so many nodes of a map under the test load.
    pub fn new(map: &Map<2>, view: &PlaneView, stride: usize) -> Self {
        let [columns, rows] = map.grid.counts;
        let all = map.values(0);
        let thinned = (0..rows).step_by(stride).flat_map(|row| {
            let all = &all;
            (0..columns).step_by(stride).map(move |column| all[row * columns + column] * 1e3)
        });
        Self {
            values: thinned.collect(),
            columns: columns.div_ceil(stride),
            origin: view.shown(map.grid.origin),
            step: map.grid.step * stride as f64 * 1e3,
        }
    }

    /// The smallest rectangle around the cells of all nodes with a value: the lowest and the highest coordinates. mm
    pub fn extent(&self) -> Option<Window> {
        let valued = (0..self.values.len()).filter(|index| self.values[*index].is_finite());
        around(valued.flat_map(|index| {
            let (column, row) = ((index % self.columns) as f64, (index / self.columns) as f64);
            [-0.5, 0.5].map(|aside| self.at([column + aside, row + aside]))
        }))
    }

    /// Coordinates of a position counted in steps. mm
    fn at(&self, steps: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| self.origin[k] + self.step * steps[k])
    }
}

/// The scale of colours that both elbows share.
pub(super) struct Colours {
    /// Circularity from the dark to the bright end. mm
    pub range: ColourRange,
    /// Values of the contour lines, and of the ticks at the colour bar. mm
    pub ticks: Ticks,
}

impl Colours {
    /// The label of a tick.
    pub fn label(&self, value: f64) -> String {
        let label = self.ticks.label(value);
        if label.len() <= MAX_LETTERS { label } else { format!("{value:.2e}") }
    }
}

/// One elbow.
pub(super) struct ElbowPanel<'a> {
    /// Where it is drawn; the axes are in mm and to the same scale.
    pub panel: &'a Panel,
    /// What coordinates are shown.
    pub view: &'a PlaneView,
    /// The map.
    pub nodes: &'a Nodes,
    /// Colours of the map.
    pub colours: &'a Colours,
    /// What was found on it.
    pub found: &'a Configuration,
    /// The arm, where it is in the plane.
    pub arm: Option<&'a ArmInPlane>,
}

impl ElbowPanel<'_> {
    /// Draws the map and all that lies on it.
    pub fn draw(&self, canvas: &mut Canvas) {
        self.panel.draw_grid(canvas);
        self.cells().draw_merged(canvas, viridis);
        self.arm(canvas);
        let lines = self.contours(canvas);
        let mut labeller = Labeller::new(self.area());
        self.zones(canvas, &mut labeller);
        for (value, line) in lines {
            self.contour_label(canvas, &mut labeller, value, &line);
        }
        self.panel.draw_frame(canvas)
    }

    fn area(&self) -> Area {
        let Panel { x, y, .. } = self.panel;
        ((x.start, y.end), (x.end, y.start))
    }

    fn place(&self, [x, y]: [f64; 2]) -> Place {
        self.panel.place(x, y)
    }

    /// The nodes with a value, each in the middle of its cell.
    fn cells(&self) -> HeatMap<usize> {
        let Nodes { values, columns, .. } = self.nodes;
        let edge = |k: usize, count: usize| self.nodes.at([count as f64 - 0.5; 2])[k];
        let level = |value: &f64| value.is_finite().then(|| self.colours.range.level(*value));
        HeatMap {
            columns: (0..=*columns).map(|count| self.panel.x.pixel(edge(0, count))).collect(),
            rows: (0..=values.len() / columns).map(|count| self.panel.y.pixel(edge(1, count))).collect(),
            cells: values.iter().map(level).collect(),
        }
    }

    /// The contour lines, drawn and returned with their values.
    fn contours(&self, canvas: &mut Canvas) -> Vec<(f64, Vec<Place>)> {
        let mut drawn = Vec::new();
        for value in &self.colours.ticks.values {
            let colour = contrast(viridis(self.colours.range.level(*value)));
            for line in contour(self.nodes.columns, &self.nodes.values, *value) {
                let places: Vec<Place> = line.into_iter().map(|steps| self.place(self.nodes.at(steps))).collect();
                canvas.curve(&places, colour, 1);
                drawn.push((*value, places));
            }
        }
        drawn
    }

    /// The value of a contour line on a ground of its colour, as near to the middle of the line as there is room.
    fn contour_label(&self, canvas: &mut Canvas, labeller: &mut Labeller, value: f64, line: &[Place]) {
        let text = self.colours.label(value);
        let length: f64 = line.windows(2).map(|pair| libm::hypot(pair[1].0 - pair[0].0, pair[1].1 - pair[0].1)).sum();
        if length < LONG * 2.0 * f64::from(Labeller::half(&text).0) {
            return;
        }
        let ground = viridis(self.colours.range.level(value));
        let middle = line.len() / 2;
        let outwards = (0..=middle).flat_map(|off| [middle.checked_sub(off), middle.checked_add(off)]).flatten();
        let half = Labeller::half(&text);
        let on_map = |(x, y): &Pixel| {
            let corners = [
                (x - half.0, y - half.1),
                (x + half.0, y - half.1),
                (x - half.0, y + half.1),
                (x + half.0, y + half.1),
            ];
            corners.into_iter().all(|corner| self.has_value(corner))
        };
        let centres = outwards.filter_map(|index| line.get(index)).map(|place| nearest(*place)).filter(on_map);
        labeller.put(canvas, &Label { text: &text, colour: contrast(ground), ground }, centres)
    }

    /// Whether a pixel is in the cell of a node with a value.
    fn has_value(&self, (x, y): Pixel) -> bool {
        let shown = [self.panel.x.number(f64::from(x)), self.panel.y.number(f64::from(y))];
        let [column, row] = [0, 1].map(|k| ((shown[k] - self.nodes.origin[k]) / self.nodes.step).round());
        if column < 0.0 || row < 0.0 || column >= self.nodes.columns as f64 {
            return false;
        }
        let node = row as usize * self.nodes.columns + column as usize;
        self.nodes.values.get(node).is_some_and(|value| value.is_finite())
    }

    /// The most accurate place and the zones of each size, labelled with their sides in mm where there is room.
    fn zones(&self, canvas: &mut Canvas, labeller: &mut Labeller) {
        let zones = || {
            let each = self.found.zones.iter();
            each.flat_map(|zones| [(zones.middle, WORST), (zones.optimal, BEST)])
                .filter_map(|(zone, colour)| Some((zone?, colour)))
        };
        for (zone, colour) in zones() {
            let ((left, top), (right, bottom)) = self.square(&zone);
            let corners = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
            let corners = corners.map(exact);
            canvas.curve(&corners, WHITE, 4);
            canvas.curve(&corners, colour, 2);
            labeller.take_outline(((left, top), (right, bottom)));
        }
        if let Some(spot) = self.found.min {
            let place = self.place(self.view.shown(spot.centre));
            canvas.dot(place, 4, BLACK);
            let (x, y) = nearest(place);
            labeller.take(((x - 6, y - 6), (x + 6, y + 6)));
        }
        for (zone, colour) in zones() {
            let text = whole_or_figures(zone.side * 1e3);
            let ((left, top), (right, bottom)) = self.square(&zone);
            let (half_width, half_height) = Labeller::half(&text);
            let (beside, above) = (half_width + 4, half_height + 4);
            let (inner_left, inner_right) = (left + half_width, right - half_width);
            let centres = [top - above, top + above, bottom + above, bottom - above].into_iter().flat_map(|y| {
                [inner_right, inner_left, (left + right) / 2, left - beside, right + beside].map(|x| (x, y))
            });
            let sides = [right + beside, left - beside].map(|x| (x, (top + bottom) / 2));
            let label = Label { text: &text, colour, ground: WHITE };
            labeller.put(canvas, &label, centres.chain(sides));
        }
    }

    fn square(&self, zone: &Zone) -> Area {
        let [x, y] = self.view.shown(zone.centre);
        let half = zone.side * 1e3 / 2.0;
        (nearest(self.place([x - half, y + half])), nearest(self.place([x + half, y - half])))
    }

    /// Axis 1 and the shoulder, as far as they are in view.
    fn arm(&self, canvas: &mut Canvas) {
        let Some(arm) = self.arm else { return };
        if let Some([from, to]) = arm.axis_within(self.window()) {
            canvas.dash_dotted(self.place(from), self.place(to), INK);
        }
        if arm.shoulder_within(self.window()) {
            shoulder_mark(canvas, self.place(arm.shoulder));
        }
    }

    fn window(&self) -> Window {
        let Panel { x, y, .. } = self.panel;
        [[x.from, y.from], [x.to, y.to]]
    }
}

/// The mark of the shoulder.
pub(super) fn shoulder_mark(canvas: &mut Canvas, place: Place) {
    canvas.dot(place, 6, INK);
    canvas.dot(place, 2, WHITE)
}
