//! The circularity maps of a robot (Klimchik 2017, Fig. 15 to 19).

use super::axes::{Panel, Scale, Ticks, Window, around};
use super::canvas::{Canvas, Place, TextStyle, exact, picture};
use super::circularity_panel::{Colours, ElbowPanel, Nodes, shoulder_mark};
use super::colour::{BEST, BLACK, Colour, GREY, INK, WORST};
use super::heat_map::{ColourBar, ColourRange};
use super::labels::{lines, whole_or_figures};
use super::plane_view::{ArmInPlane, PlaneView};
use crate::units::figures;
use stead_assessment::comparison::{Comparison, Configuration, ElbowNames, Load, RobotResult, Zones, obstacle_words};
use stead_assessment::map::{Elbow, Map};
use stead_assessment::zone::Zone;

const WIDTH: i32 = 1100;
/// Left edges of the panels.
const COLUMNS: [i32; 2] = [80, 565];
/// Width of a panel.
const PANEL: i32 = 405;
/// Upper edge of the panels.
const TOP: i32 = 116;
/// Least and largest height of a panel.
const HEIGHTS: [i32; 2] = [260, 660];
/// Letters of 11 pixels that fit under a panel.
const LETTERS: usize = 68;
/// Most nodes shown along an axis: a finer map is thinned out to keep the file small.
const MAX_NODES: usize = 240;
/// Free space around the map, as a share of its larger side.
const MARGIN: f64 = 0.04;
/// The arm is shown where that widens the view by no more than this share.
const WIDENED: f64 = 0.5;

/// The circularity of a robot under the test load over the plane of the study, for both elbows to the same scales:
/// colours and contour lines in mm, optimal zones and zones about the middle of each size, the most accurate place, and
/// the robot's axis 1 and shoulder where they lie in the plane and near the map. The axes show the part of the grid
/// that has values. A map of more than 240 nodes along an axis is thinned out evenly.
pub fn circularity_map(comparison: &Comparison, result: &RobotResult) -> String {
    let picture_of = Picture::new(comparison, result);
    picture((WIDTH, picture_of.height()), |canvas| picture_of.draw(canvas))
}

struct Picture<'a> {
    comparison: &'a Comparison,
    result: &'a RobotResult,
    view: PlaneView,
    nodes: [Nodes; 2],
    /// Edges of the view. mm
    window: Window,
    /// Lower edge of the panels. Pixels
    bottom: i32,
    colours: Colours,
    arm: Option<ArmInPlane>,
    /// What stands under each panel about its zones.
    zone_lines: [Vec<(String, Colour)>; 2],
}

impl<'a> Picture<'a> {
    fn new(comparison: &'a Comparison, result: &'a RobotResult) -> Self {
        let view = PlaneView::new(&comparison.benchmark.plane);
        let [up, down] = &result.maps;
        let extents = [&up.1, &down.1].map(|map| Nodes::new(map, &view, 1).extent());
        let grid = &up.1.grid;
        let whole = [[-0.5, -0.5], grid.counts.map(|count| count as f64 - 0.5)].map(|steps| view.shown(grid.at(steps)));
        let extent = around(extents.into_iter().flatten().flatten()).unwrap_or(whole);
        let longest = (0..2).map(|k| extent[1][k] - extent[0][k]).fold(0.0, f64::max);
        let stride = ((longest / (grid.step * 1e3)).ceil() as usize).div_ceil(MAX_NODES).max(1);
        let nodes = [&up.1, &down.1].map(|map| Nodes::new(map, &view, stride));
        let robot = comparison.robots.iter().find(|robot| robot.name() == result.name);
        let centre = grid.at([0, 1].map(|k| grid.counts[k] as f64 / 2.0));
        let arm = robot.and_then(|robot| view.arm(robot, centre));
        let (window, height) = window(extent, arm.as_ref());
        let bottom = TOP + height;
        let colours = colours(&nodes);
        let mut picture =
            Self { comparison, result, view, nodes, window, bottom, colours, arm, zone_lines: Default::default() };
        picture.zone_lines = Elbow::BOTH.map(|elbow| picture.found(elbow).map_or_else(Vec::new, zone_lines));
        picture
    }

    /// What was found for an elbow under the test load.
    fn found(&self, elbow: Elbow) -> Option<&'a Configuration> {
        self.result.configurations.iter().find(|found| found.elbow == elbow && found.load == Load::Test)
    }

    /// Lower edge of what stands under the panels. Pixels
    fn text_bottom(&self) -> i32 {
        let max = self.zone_lines.iter().map(Vec::len).max().unwrap_or(0);
        self.bottom + 50 + 17 * max as i32
    }

    fn height(&self) -> i32 {
        self.text_bottom() + 102
    }

    fn draw(&self, canvas: &mut Canvas) {
        self.title(canvas);
        for ((column, nodes), (elbow, map)) in (0..2).zip(&self.nodes).zip(&self.result.maps) {
            self.panel(canvas, column, nodes, *elbow, map);
        }
        if self.result.maps.iter().any(|(_, map)| map.count() > 0) {
            self.colour_bar(canvas);
        }
        self.legend(canvas)
    }

    fn title(&self, canvas: &mut Canvas) {
        let benchmark = &self.comparison.benchmark;
        let force = figures(benchmark.in_plane_force());
        let radius = whole_or_figures(benchmark.radius * 1e3);
        let title = format!("{}: circularity of a circle of radius {radius} mm under {force} N, mm", self.result.name);
        let size = (f64::from(WIDTH - 2 * 40) / (title.chars().count() as f64 * 0.6)).min(17.0);
        canvas.text(&title, (COLUMNS[0], 24), TextStyle::new(size).bold());
        let names = match self.comparison.elbow_names {
            ElbowNames::Geometric => "elbow up: above the line from the shoulder to the wrist centre",
            ElbowNames::Swapped => {
                "elbow up, by the names of this study: below the line from the shoulder to the wrist centre"
            }
        };
        let subtitle = format!("Centres of the circle in the {}; {names}", self.view.words());
        canvas.text(&subtitle, (COLUMNS[0], 47), TextStyle::new(12.0).coloured(INK))
    }

    fn panel(&self, canvas: &mut Canvas, column: usize, nodes: &Nodes, elbow: Elbow, map: &Map<2>) {
        let left = COLUMNS[column];
        let [low, high] = self.window;
        let x = Scale::new(low[0], high[0], left, left + PANEL);
        let y = Scale::new(low[1], high[1], self.bottom, TOP);
        let x_ticks = Ticks::round(&x, 7);
        let y_ticks = match x_ticks.values[..] {
            [first, second, ..] => Ticks::every(&y, second - first, x_ticks.decimals),
            _ => Ticks::round(&y, 7),
        };
        let [x_label, y_label] = self.view.labels;
        let panel = Panel { x, y, x_ticks, y_ticks, x_label: x_label.into(), y_label: y_label.into() };
        let Some(found) = self.found(elbow) else { return panel.draw_frame(canvas) };
        let name = match elbow {
            Elbow::Up => "Elbow up",
            Elbow::Down => "Elbow down",
        };
        canvas.text(name, (left, TOP - 34), TextStyle::new(14.0).bold());
        let millimetres = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| figures(value * 1e3));
        let [min, middle, max] =
            [found.min, found.middle, found.max].map(|spot| millimetres(spot.map(|spot| spot.circularity)));
        let figures = match found.circles {
            0 => "no circle fits".to_owned(),
            1 => format!("{min} mm; one circle"),
            count => format!("smallest {min}, middle {middle}, largest {max} mm; {count} circles"),
        };
        canvas.text(&figures, (left, TOP - 15), TextStyle::new(12.0).coloured(INK));
        let arm = self.arm.as_ref();
        let (view, colours) = (&self.view, &self.colours);
        ElbowPanel { panel: &panel, view, nodes, colours, found, arm }.draw(canvas);
        if found.circles == 0 {
            let (x, y) = (left + PANEL / 2, (TOP + self.bottom) / 2);
            canvas.text("no circle fits", (x, y - 10), TextStyle::new(14.0).centred().coloured(INK));
            let main = map.obstacles();
            let why = obstacle_words(&main[..main.len().min(1)], map.nodes.len());
            canvas.text(&why, (x, y + 12), TextStyle::new(11.0).centred().coloured(GREY));
        }
        for (index, (line, colour)) in self.zone_lines[column].iter().enumerate() {
            let y = self.bottom + 58 + 17 * index as i32;
            canvas.text(line, (left, y), TextStyle::new(11.0).coloured(*colour));
        }
    }

    fn colour_bar(&self, canvas: &mut Canvas) {
        let Colours { range, ticks } = &self.colours;
        let largest = self.nodes.iter().flat_map(finite).fold(0.0, f64::max);
        let labelled: Vec<(f64, String)> = if ticks.values.len() > 1 {
            ticks.values.iter().map(|value| (*value, self.colours.label(*value))).collect()
        } else {
            [range.from, range.to].map(|value| (value, figures(value))).to_vec()
        };
        let right = COLUMNS[1] + PANEL;
        ColourBar {
            sides: [right + 22, right + 40],
            scale: Scale::new(range.from, range.to, self.bottom, TOP),
            labels: labelled,
            beyond: (largest > range.to).then(|| figures(largest)),
            title: "circularity (mm)".into(),
            gap: 14,
        }
        .draw(canvas);
    }

    fn legend(&self, canvas: &mut Canvas) {
        let style = TextStyle::new(12.0);
        let y = self.text_bottom() + 26;
        let left = COLUMNS[0];
        for (x, colour, label) in [
            (left, BEST, "optimal zone: its largest circularity is the smallest of all squares of its side"),
            (left + 560, WORST, "zone about the middle of the map"),
        ] {
            canvas.curve(&square(x, y), colour, 2);
            canvas.text(label, (x + 24, y), style);
        }
        let y = y + 26;
        canvas.dot((f64::from(left + 8), f64::from(y)), 4, BLACK);
        canvas.text("most accurate place", (left + 24, y), style);
        let x = left + 180;
        if self.arm.as_ref().is_some_and(|arm| arm.axis_within(self.window).is_some()) {
            canvas.dash_dotted((f64::from(x), f64::from(y)), (f64::from(x + 36), f64::from(y)), INK);
            canvas.text("axis 1", (x + 44, y), style);
        }
        if self.arm.as_ref().is_some_and(|arm| arm.shoulder_within(self.window)) {
            shoulder_mark(canvas, (f64::from(x + 112), f64::from(y)));
            canvas.text("shoulder (axis 2)", (x + 126, y), style);
        }
        canvas.text("white: no circle fits", (left + 560, y), style.coloured(INK));
        let labels = "A square is labelled with its side in mm where there is room. Under the maps: side in mm, then the largest \
                      circularity in the zone in mm.";
        canvas.text(labels, (left, y + 26), style.coloured(INK))
    }
}

/// The sign of a zone in the legend.
fn square(left: i32, y: i32) -> [Place; 5] {
    let corners = [(left, y - 8), (left + 16, y - 8), (left + 16, y + 8), (left, y + 8), (left, y - 8)];
    corners.map(exact)
}

/// The edges of the view (mm) and the height of the panels (pixels): the extent of the map, that of the arm where it is
/// near, a margin, and as much more as fills the panels with both axes to the same scale.
fn window(extent: Window, arm: Option<&ArmInPlane>) -> (Window, i32) {
    let sides = |[low, high]: Window| [0, 1].map(|k| (high[k] - low[k]).max(1e-6));
    let mut shown = extent;
    if let Some(arm) = arm
        && let Some(wider) = around(extent.into_iter().chain([arm.shoulder, arm.foot]))
    {
        let (before, after) = (sides(extent), sides(wider));
        if (0..2).all(|k| after[k] <= before[k] * (1.0 + WIDENED)) {
            shown = wider;
        }
    }
    let [width, height] = sides(shown);
    let margin = MARGIN * width.max(height);
    let [width, height] = [width + 2.0 * margin, height + 2.0 * margin];
    let scale = (f64::from(PANEL) / width).min(f64::from(HEIGHTS[1]) / height);
    let pixels = ((height * scale).round() as i32).clamp(HEIGHTS[0], HEIGHTS[1]);
    let half = [f64::from(PANEL), f64::from(pixels)].map(|pixels| pixels / scale / 2.0);
    let middle = [0, 1].map(|k| (shown[0][k] + shown[1][k]) / 2.0);
    ([[0, 1].map(|k| middle[k] - half[k]), [0, 1].map(|k| middle[k] + half[k])], pixels)
}

fn finite(nodes: &Nodes) -> impl Iterator<Item = f64> + '_ {
    nodes.values.iter().copied().filter(|value| value.is_finite())
}

/// From the smallest value of both maps (from zero, where all are the same) to the largest that is no peak.
fn colours(nodes: &[Nodes; 2]) -> Colours {
    let mut ascending: Vec<f64> = nodes.iter().flat_map(finite).collect();
    ascending.sort_by(f64::total_cmp);
    let [min, max] = [ascending.first(), ascending.last()].map(|value| value.copied().unwrap_or(0.0));
    let range = if max > min {
        ColourRange::below_peaks(min, &ascending)
    } else {
        ColourRange { from: 0.0, to: if max > 0.0 { max } else { 1.0 } }
    };
    Colours { ticks: Ticks::round(&Scale::new(range.from, range.to, 0, 1), 10), range }
}

/// The largest circularity in the zones of each side, in the colours of the zones.
fn zone_lines(found: &Configuration) -> Vec<(String, Colour)> {
    let table = |kind: &str, colour, zone: fn(&Zones) -> Option<Zone>| {
        let each = found.zones.iter().map(|zones| {
            let largest = zone(zones).map_or_else(|| "–".to_owned(), |zone| figures(zone.largest * 1e3));
            format!("{}: {largest}", whole_or_figures(zones.side * 1e3))
        });
        let phrases: Vec<String> = std::iter::once(kind.to_owned()).chain(each).collect();
        lines(&phrases, LETTERS).into_iter().map(move |line| (line, colour)).collect::<Vec<_>>()
    };
    if found.zones.is_empty() || found.circles == 0 {
        return Vec::new();
    }
    let mut both = table("optimal zones", BEST, |zones| zones.optimal);
    both.extend(table("middle zones", WORST, |zones| zones.middle));
    both
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_axes_have_the_same_scale_and_a_near_arm_is_in_view() {
        let arm = ArmInPlane { shoulder: [500.0, 1000.0], foot: [0.0, 1000.0], along: [0.0, 1.0] };
        let extents = [
            ([[600.0, -400.0], [2700.0, 3200.0]], true),
            ([[300.0, 500.0], [3000.0, 1500.0]], true),
            // So tall that the arm is in the space beside it.
            ([[1200.0, -2000.0], [1300.0, 3000.0]], true),
            // A flat and a small one, too far away to show the arm.
            ([[1200.0, 500.0], [2400.0, 620.0]], false),
            ([[1200.0, 800.0], [1220.0, 820.0]], false),
        ];
        for (extent, near) in extents {
            let ([low, high], pixels) = window(extent, Some(&arm));
            let (across, up) = ((high[0] - low[0]) / f64::from(PANEL), (high[1] - low[1]) / f64::from(pixels));
            assert!((across / up - 1.0).abs() < 1e-12, "{extent:?}");
            assert!((HEIGHTS[0]..=HEIGHTS[1]).contains(&pixels));
            assert_eq!(around([low, high].into_iter().chain(extent)), Some([low, high]), "the map is in view");
            assert_eq!(arm.shoulder_within([low, high]) && arm.axis_within([low, high]).is_some(), near, "{extent:?}");
        }
    }

    #[test]
    fn a_peak_does_not_set_the_scale() {
        let view = PlaneView::new(&stead_assessment::benchmark::Plane::XOZ);
        let scale = |values: &[f64]| {
            let grid = stead_assessment::map::Grid { origin: [0.0, 0.0], step: 0.1, counts: [values.len(), 1] };
            let nodes = values.iter().map(|value| Ok([value * 1e-3; 2])).collect();
            let map = Map { grid, nodes };
            let Colours { range, .. } = colours(&[Nodes::new(&map, &view, 1), Nodes::new(&map, &view, 1)]);
            [range.from, range.to]
        };
        let even: Vec<f64> = (1..=100).map(f64::from).collect();
        assert_eq!(scale(&even), [1.0, 100.0]);
        let peak: Vec<f64> = (1..=100).map(|k| if k == 100 { 1000.0 } else { f64::from(k) }).collect();
        assert_eq!(scale(&peak), [1.0, 98.0]);
        assert_eq!(scale(&[2.0, 2.0]), [0.0, 2.0]);
        assert_eq!(scale(&[0.0]), [0.0, 1.0]);
        assert_eq!(scale(&[]), [0.0, 1.0]);
    }
}
