//! Force and moment of a milling tool over the engagement (Klimchik 2017, Fig. 4) and over one turn.

use super::axes::{Panel, Scale, Ticks};
use super::canvas::{Canvas, Pixel, TextStyle, picture};
use super::colour::{BLACK, COMPONENTS, INK, SHADE};
use super::line_chart::{LineChart, Mark, Sign, legend};
use crate::units::fixed;
use nalgebra::Vector3;
use stead_model::cutting::{ForceHistory, Sample};
use stead_model::task::Wrench;

const SIZE: Pixel = (1160, 930);
/// Left and right edges of the columns of panels.
const COLUMNS: [Pixel; 2] = [(90, 545), (675, 1130)];
/// Lower and upper edges of the rows of panels.
const ROWS: [Pixel; 2] = [(445, 165), (815, 535)];

/// Force or moment.
struct Quantity {
    label: &'static str,
    of: fn(&Wrench) -> Vector3<f64>,
}

const QUANTITIES: [Quantity; 2] = [
    Quantity { label: "force (N)", of: |wrench| wrench.force },
    Quantity { label: "moment (N m)", of: |wrench| wrench.moment },
];

/// What the work does to the tool. Left: the means over a turn of cuts that go from 0 to an angle; right: all teeth of
/// this cut over one turn, with their means. Force above, moment about the tool centre point below. The arcs on which a
/// tooth of this cut is in the work are shaded.
pub fn cutting(force_history: &ForceHistory) -> String {
    picture(SIZE, |canvas| {
        head(canvas, force_history);
        for (quantity, rows) in QUANTITIES.iter().zip(ROWS) {
            let entering = &force_history.entering;
            let mut chart =
                quantity.chart(force_history, entering, (COLUMNS[0], rows), (180.0, 30.0, "engagement angle (deg)"));
            quantity.curves(&mut chart, entering);
            chart.draw(canvas);
            let turn = &force_history.turn;
            let mut chart = quantity.chart(
                force_history,
                turn,
                (COLUMNS[1], rows),
                (360.0, 60.0, "angle of the first tooth (deg)"),
            );
            let mean = (quantity.of)(&force_history.mean);
            let axes = COMPONENTS.into_iter().enumerate();
            chart.marks.extend(axes.map(|(axis, colour)| Mark::Dashed(mean[axis], colour)));
            quantity.curves(&mut chart, turn);
            chart.draw(canvas);
        }
        let captions = [
            "What the work does to the tool, moments about the tool centre point. Angles run in the sense of rotation, from the \
             side where a tooth enters a full slot.",
            "The mean of a cut is what the component curves on the left gain over its shaded arcs.",
        ];
        for (line, above) in captions.iter().zip([42, 22]) {
            canvas.text(line, (COLUMNS[0].0, SIZE.1 - above), TextStyle::new(12.0).coloured(INK));
        }
    })
}

/// Titles, the mean in figures, and the legend.
fn head(canvas: &mut Canvas, force_history: &ForceHistory) {
    let left = COLUMNS[0].0;
    canvas.title("Cutting force and moment on the tool", (left, 24));
    let figures = |vector: &Vector3<f64>, decimals| {
        let [x, y, z] = [vector.x, vector.y, vector.z].map(|part| fixed(part, decimals));
        format!("({x}, {y}, {z}), magnitude {}", fixed(vector.norm(), decimals))
    };
    let arcs = force_history.engagement.arcs().iter();
    let arcs = arcs.map(|arc| format!("{} to {}", fixed(arc.entry.to_degrees(), 1), fixed(arc.exit.to_degrees(), 1)));
    let arcs = arcs.collect::<Vec<_>>().join(" and from ");
    let [force, moment] = [figures(&force_history.mean.force, 1), figures(&force_history.mean.moment, 3)];
    let lines = [
        format!("This cut: a tooth is in the work from {arcs} deg."),
        format!("Mean over a turn, along feed, left and axis: force {force} N; moment {moment} N m."),
    ];
    for (line, y) in lines.iter().zip([50, 70]) {
        canvas.text(line, (left, y), TextStyle::new(12.0).coloured(INK));
    }
    curve_legend(canvas, left);
    for ((left, _), title) in
        COLUMNS.into_iter().zip(["Mean over a turn, engaged from 0 to an angle", "All teeth over one turn"])
    {
        canvas.text(title, (left, ROWS[0].1 - 18), TextStyle::new(13.0).bold().coloured(INK));
    }
}

/// The legend, in one line.
fn curve_legend(canvas: &mut Canvas, left: i32) {
    let [feed, side, axis] = COMPONENTS;
    let entries = [
        (left, Sign::Line(feed.into()), "along the feed"),
        (left + 150, Sign::Line(side.into()), "to the left of it"),
        (left + 300, Sign::Line(axis.into()), "along the tool axis"),
        (left + 480, Sign::Line(BLACK.into()), "magnitude"),
        (left + 606, Sign::Dashed(INK), "mean over the turn"),
        (left + 785, Sign::Ground(SHADE), "a tooth is in the work"),
    ];
    legend(canvas, 98, &entries);
}

impl Quantity {
    /// A chart between these columns and rows over these angles, up to and every so many degrees, with room for all
    /// components and the magnitude, the arcs of this cut shaded, and a line at zero.
    fn chart(
        &self,
        force_history: &ForceHistory,
        samples: &[Sample],
        ((left, right), (bottom, top)): (Pixel, Pixel),
        (last, tick, x_label): (f64, f64, &'static str),
    ) -> LineChart {
        let vectors = || samples.iter().map(|sample| (self.of)(&sample.wrench));
        let low = vectors().map(|vector| vector.min()).fold(0.0, f64::min);
        let high = vectors().map(|vector| vector.norm()).fold(0.0, f64::max);
        let margin = 0.06 * (high - low);
        let x = Scale::new(0.0, last, left, right);
        let y = Scale::new(low - margin, high + margin, bottom, top);
        let panel = Panel { x_ticks: Ticks::every(&x, tick, 0), ..Panel::new(x, y, [1, 8], [x_label, self.label]) };
        let arcs = force_history.engagement.arcs().iter();
        let shades = arcs.map(|arc| [arc.entry, arc.exit].map(f64::to_degrees)).collect();
        LineChart { panel, shades, marks: vec![Mark::Horizontal(0.0, INK)] }
    }

    /// Adds the curves of the magnitude and of the components over it.
    fn curves(&self, chart: &mut LineChart, samples: &[Sample]) {
        let at = |sample: &Sample, value: f64| [sample.phi.to_degrees(), value];
        chart.curve(samples.iter().map(|sample| at(sample, (self.of)(&sample.wrench).norm())), BLACK);
        for (axis, colour) in COMPONENTS.into_iter().enumerate() {
            chart.curve(samples.iter().map(|sample| at(sample, (self.of)(&sample.wrench)[axis])), colour);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{assert_well_formed, force_history};

    #[test]
    fn the_picture_is_well_formed_small_the_same_each_time_and_labelled() {
        let svg = cutting(&force_history());
        assert_eq!(svg, cutting(&force_history()));
        assert_well_formed(&svg);
        assert!(svg.len() < 150_000, "{}", svg.len());
        for label in ["force (N)", "moment (N m)", "along the feed", "from 0.0 to 60.0 and from 120.0 to 180.0 deg"] {
            assert!(svg.contains(label), "{label}");
        }
    }
}
