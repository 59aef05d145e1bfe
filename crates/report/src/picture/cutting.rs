//! Force and moment of a milling tool over the engagement (Klimchik 2017, Fig. 4) and over one turn.

use super::axes::{Panel, Scale, Ticks};
use super::canvas::{Canvas, Drawn, Lettering, Pixel, Place, picture};
use super::colour::{COMPONENTS, INK, SHADE};
use crate::output::ReportError;
use crate::units::fixed;
use nalgebra::Vector3;
use plotters::style::{BLACK, RGBColor};
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

/// What the work does to the tool. Left: the means over a turn of cuts that go from 0 to an angle; right: all teeth of this cut
/// over one turn, with their means. Force above, moment about the tool centre point below. The arcs on which a tooth of this cut
/// is in the work are shaded.
///
/// # Errors
/// [`ReportError::Format`] when the drawing fails.
pub fn cutting(force_history: &ForceHistory) -> Result<String, ReportError> {
    picture("the picture of the cutting force", SIZE, |canvas| {
        head(canvas, force_history)?;
        for (quantity, (bottom, top)) in QUANTITIES.iter().zip(ROWS) {
            let panel = |(left, right), x_label, samples: &[Sample], turn: f64, tick| {
                let x = Scale::new(0.0, turn, left, right);
                let y = range(samples, quantity.of, bottom, top);
                let (x_ticks, y_ticks) = (Ticks::every(&x, tick, 0), Ticks::round(&y, 8));
                Panel { x, y, x_ticks, y_ticks, x_label, y_label: quantity.label }
            };
            let entering = panel(COLUMNS[0], "engagement angle (deg)", &force_history.entering, 180.0, 30.0);
            ground(canvas, force_history, &entering)?;
            curves(canvas, &entering, &force_history.entering, quantity.of)?;
            let turn = panel(COLUMNS[1], "angle of the first tooth (deg)", &force_history.turn, 360.0, 60.0);
            ground(canvas, force_history, &turn)?;
            means(canvas, &turn, (quantity.of)(&force_history.mean))?;
            curves(canvas, &turn, &force_history.turn, quantity.of)?;
        }
        let captions = [
            "What the work does to the tool, moments about the tool centre point. Angles run in the sense of rotation, from the \
             side where a tooth enters a full slot.",
            "The mean of a cut is what the component curves on the left gain over its shaded arcs.",
        ];
        for (line, above) in captions.iter().zip([42, 22]) {
            canvas.text(line, (COLUMNS[0].0, SIZE.1 - above), Lettering::new(12.0).coloured(INK))?;
        }
        Ok(())
    })
}

/// Titles, the mean in figures, and the legend.
fn head(canvas: &Canvas<'_>, force_history: &ForceHistory) -> Drawn {
    let left = COLUMNS[0].0;
    canvas.text("Cutting force and moment on the tool", (left, 24), Lettering::new(17.0).bold())?;
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
        canvas.text(line, (left, y), Lettering::new(12.0).coloured(INK))?;
    }
    legend(canvas, left, 98)?;
    for ((left, _), title) in
        COLUMNS.into_iter().zip(["Mean over a turn, engaged from 0 to an angle", "All teeth over one turn"])
    {
        canvas.text(title, (left, ROWS[0].1 - 18), Lettering::new(13.0).bold().coloured(INK))?;
    }
    Ok(())
}

/// The legend, in one line.
fn legend(canvas: &Canvas<'_>, left: i32, y: i32) -> Drawn {
    let [feed, side, axis] = COMPONENTS;
    let curves = [
        (0, "along the feed", feed),
        (150, "to the left of it", side),
        (300, "along the tool axis", axis),
        (480, "magnitude", BLACK),
    ];
    let lettering = Lettering::new(12.0);
    for (offset, label, colour) in curves {
        let at = left + offset;
        canvas.line(vec![(at, y), (at + 28, y)], colour, 2)?;
        canvas.text(label, (at + 36, y), lettering)?;
    }
    let [mean, arcs] = [left + 606, left + 785];
    canvas.dashed((mean, y), (mean + 28, y), INK)?;
    canvas.text("mean over the turn", (mean + 36, y), lettering)?;
    canvas.fill((arcs, y - 7), (arcs + 28, y + 7), SHADE)?;
    canvas.text("a tooth is in the work", (arcs + 36, y), lettering)
}

/// The vertical scale: zero, all components and the magnitude.
fn range(samples: &[Sample], of: fn(&Wrench) -> Vector3<f64>, bottom: i32, top: i32) -> Scale {
    let (mut low, mut high) = (0.0_f64, 0.0_f64);
    for sample in samples {
        let vector = of(&sample.wrench);
        low = low.min(vector.min());
        high = high.max(vector.norm());
    }
    let margin = 0.06 * (high - low);
    Scale::new(low - margin, high + margin, bottom, top)
}

/// Shaded arcs, and the grid with its zero.
fn ground(canvas: &Canvas<'_>, force_history: &ForceHistory, panel: &Panel) -> Drawn {
    for arc in force_history.engagement.arcs() {
        let [from, to] = [arc.entry, arc.exit].map(|phi| panel.x.pixel(phi.to_degrees()));
        canvas.fill((from, panel.y.end), (to, panel.y.start), SHADE)?;
    }
    panel.draw_grid(canvas)?;
    let zero = panel.y.pixel(0.0);
    canvas.line(vec![(panel.x.start, zero), (panel.x.end, zero)], INK, 1)
}

/// The curves of the magnitude and of the components over it, and the frame.
fn curves(canvas: &Canvas<'_>, panel: &Panel, samples: &[Sample], of: fn(&Wrench) -> Vector3<f64>) -> Drawn {
    let curve = |value: &dyn Fn(&Vector3<f64>) -> f64, colour: RGBColor| {
        let place = |sample: &Sample| panel.place(sample.phi.to_degrees(), value(&of(&sample.wrench)));
        canvas.curve(&samples.iter().map(place).collect::<Vec<Place>>(), colour, 2)
    };
    curve(&|vector| vector.norm(), BLACK)?;
    for (axis, colour) in COMPONENTS.into_iter().enumerate() {
        curve(&|vector| vector[axis], colour)?;
    }
    panel.draw_frame(canvas)
}

/// The means of the components.
fn means(canvas: &Canvas<'_>, panel: &Panel, mean: Vector3<f64>) -> Drawn {
    for (axis, colour) in COMPONENTS.into_iter().enumerate() {
        let y = panel.y.pixel(mean[axis]);
        canvas.dashed((panel.x.start, y), (panel.x.end, y), colour)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::super::testing::{assert_well_formed, force_history};
    use super::*;

    #[test]
    fn the_picture_is_well_formed_small_the_same_each_time_and_labelled() {
        let svg = cutting(&force_history()).unwrap();
        assert_eq!(svg, cutting(&force_history()).unwrap());
        assert_well_formed(&svg);
        assert!(svg.len() < 150_000, "{}", svg.len());
        for label in ["force (N)", "moment (N m)", "along the feed", "from 0.0 to 60.0 and from 120.0 to 180.0 deg"] {
            assert!(svg.contains(label), "{label}");
        }
    }
}
