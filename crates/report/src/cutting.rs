//! CSV files of the force and the moment of a milling tool.

use super::output::ReportError;
use crate::csv_file::rows_or;
use crate::figure::{AngleDeg, ForceN, MomentNm};
use crate::page::cards::{Axis, Chart, Mark, Series, Style};
use crate::units::fixed;
use nalgebra::Vector3;
use stead_model::cutting::{ForceHistory, Sample};
use stead_model::task::Wrench;

records! {
    /// Mean force and moment over a turn as the tool moves into the work (Klimchik 2017, Fig. 4).
    #[derive(Default)]
    pub struct EngagementRow of (sample: &Sample) {
        /// The angle to which a tooth is in the work.
        engaged_deg: AngleDeg = sample.phi.into(),
        #[serde(flatten)] load: LoadColumns = sample.into(),
    }

    /// Force and moment of all teeth at an angle of the first tooth.
    #[derive(Default)]
    pub struct ToothRow of (sample: &Sample) {
        /// The angle of the first tooth.
        tooth_deg: AngleDeg = sample.phi.into(),
        #[serde(flatten)] load: LoadColumns = sample.into(),
    }

    /// Force on the tool, and moment about its centre point: along the feed, to the left of it, and along the tool axis
    /// from the work to the spindle.
    #[derive(Default)]
    struct LoadColumns from sample: &Sample {
        /// Force along the feed.
        force_feed_n: ForceN = sample.wrench.force.x.into(),
        /// Force to the left of it.
        force_left_n: ForceN = sample.wrench.force.y.into(),
        /// Force along the tool axis.
        force_axis_n: ForceN = sample.wrench.force.z.into(),
        /// Size of the force.
        force_n: ForceN = sample.wrench.force.norm().into(),
        /// Moment about the feed.
        moment_feed_nm: MomentNm = sample.wrench.moment.x.into(),
        /// Moment about the left.
        moment_left_nm: MomentNm = sample.wrench.moment.y.into(),
        /// Moment about the tool axis.
        moment_axis_nm: MomentNm = sample.wrench.moment.z.into(),
        /// Size of the moment.
        moment_nm: MomentNm = sample.wrench.moment.norm().into(),
    }
}

/// Force or moment.
struct Quantity {
    name: &'static str,
    unit: &'static str,
    /// Where it acts.
    about: &'static str,
    decimals: usize,
    of: fn(&Wrench) -> Vector3<f64>,
}

const QUANTITIES: [Quantity; 2] = [
    Quantity { name: "Force", unit: "N", about: "on the tool", decimals: 1, of: |wrench| wrench.force },
    Quantity {
        name: "Moment",
        unit: "N m",
        about: "about the tool centre point",
        decimals: 3,
        of: |wrench| wrench.moment,
    },
];

/// The charts of `cutting.svg`: what the work does to the tool (Klimchik 2017, Fig. 4), moments about the tool centre
/// point. Of each the mean over a turn of cuts that go from 0 to an angle, then all teeth of this cut over one turn
/// with their means. The angles at which a tooth of this cut enters and leaves the work are marked.
pub fn charts(force_history: &ForceHistory) -> Vec<Chart> {
    QUANTITIES.iter().flat_map(|quantity| quantity.charts(force_history)).collect()
}

impl Quantity {
    fn charts(&self, force_history: &ForceHistory) -> [Chart; 2] {
        let mean = (self.of)(&force_history.mean);
        let [x, y, z] = [mean.x, mean.y, mean.z].map(|part| fixed(part, self.decimals));
        let means = [0, 1, 2].map(|axis| {
            let level = [0.0, 360.0].map(|angle| [angle, mean[axis]]);
            Series::curve("", COLOURS[axis], level).styled(Style::Dashed)
        });
        let (name, unit, norm) = (self.name.to_lowercase(), self.unit, fixed(mean.norm(), self.decimals));
        let entering = ["of a cut to an angle", "engagement angle"];
        let entering = self.chart(entering, force_history, &force_history.entering, 180.0);
        let turn = ["of all teeth over one turn", "angle of the first tooth"];
        let turn = self.chart(turn, force_history, &force_history.turn, 360.0);
        let turn = Chart { series: means.into_iter().chain(turn.series).collect(), ..turn };
        [
            entering.detailed("mean over a turn, engaged from 0; that of arcs is what components gain over them"),
            turn.detailed(format!("mean {name}, dashed: ({x}, {y}, {z}) {unit}, magnitude {norm} {unit}")),
        ]
    }

    /// Components and magnitude over the angle up to a last one (deg), zero, and the arcs of the cut.
    fn chart(&self, words: [&str; 2], force_history: &ForceHistory, samples: &[Sample], last: f64) -> Chart {
        let [what, angle] = words;
        let curve = |name: &str, color: usize, value: &dyn Fn(&Vector3<f64>) -> f64| {
            let points = samples.iter().map(|of| [of.phi.to_degrees(), value(&(self.of)(&of.wrench))]);
            Series::curve(name, color, points)
        };
        let components = ["along the feed", "to the left of it", "along the tool axis"];
        let components = (0..3).map(|axis| curve(components[axis], COLOURS[axis], &|vector| vector[axis]));
        let arcs = force_history.engagement.arcs().iter().flat_map(|arc| [("enters", arc.entry), ("leaves", arc.exit)]);
        let arcs = arcs.map(|(what, angle)| {
            let at = angle.to_degrees();
            Mark::across(at, format!("a tooth {what}, {} deg", fixed(at, 1)))
        });
        let x = Axis { range: Some([0.0, last]), ..Axis::new(format!("{angle} {SENSE}")) };
        let y = format!("{} ({}) {}", self.name.to_lowercase(), self.unit, self.about);
        let curves = components.chain([curve("magnitude", 3, &|vector| vector.norm())]);
        Chart::new(format!("{} {what}", self.name), x, y, curves).marked(arcs.chain([Mark::level(0.0, "")]))
    }
}

/// Colours of the components along the feed, to the left and along the tool axis.
const COLOURS: [usize; 3] = [0, 2, 1];
const SENSE: &str = "in the sense of rotation, from the side where a tooth enters a full slot (deg)";

/// An [`EngagementRow`] per degree, from 0 to 180.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn entering(force_history: &ForceHistory) -> Result<Vec<u8>, ReportError> {
    let samples = force_history.entering.iter().map(EngagementRow::of);
    rows_or("the table of mean cutting forces", &EngagementRow::default(), samples)
}

/// A [`ToothRow`] per angle of the first tooth over one turn.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn turn(force_history: &ForceHistory) -> Result<Vec<u8>, ReportError> {
    rows_or(
        "the table of cutting forces over a turn",
        &ToothRow::default(),
        force_history.turn.iter().map(ToothRow::of),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture;
    use crate::testing::{assert_well_formed, force_history};

    fn lines(bytes: Vec<u8>) -> Vec<String> {
        String::from_utf8(bytes).unwrap().lines().map(str::to_owned).collect()
    }

    #[test]
    fn each_row_has_both_vectors_with_their_magnitudes() {
        let lines = lines(entering(&force_history()).unwrap());
        assert_eq!(lines.len(), 1 + 181);
        assert_eq!(
            lines[0],
            "engaged_deg,force_feed_n,force_left_n,force_axis_n,force_n,moment_feed_nm,moment_left_nm,moment_axis_nm,moment_nm"
        );
        assert!(lines[1].starts_with("0.0000,0.0000,0.0000,0.0000,0.0000,0.000000,"), "{}", lines[1]);
        let slot: Vec<f64> = lines[181].split(',').map(|field| field.parse().unwrap()).collect();
        assert_eq!(slot[0], 180.0);
        assert!((slot[4] - libm::sqrt(slot[1..4].iter().map(|part| part * part).sum())).abs() < 1e-3, "{slot:?}");
        assert!((slot[8] - libm::sqrt(slot[5..8].iter().map(|part| part * part).sum())).abs() < 1e-5, "{slot:?}");
    }

    #[test]
    fn a_turn_has_a_row_per_half_degree() {
        let lines = lines(turn(&force_history()).unwrap());
        assert_eq!(lines.len(), 1 + 721);
        assert!(lines[0].starts_with("tooth_deg,") && lines[721].starts_with("360.0000,"), "{}", lines[721]);
    }

    #[test]
    fn the_picture_is_well_formed_small_the_same_each_time_and_labelled() {
        let draw = || picture::charts(&charts(&force_history()));
        let svg = draw();
        assert_eq!(svg, draw());
        assert_well_formed(&svg);
        assert!(svg.len() < 150_000, "{}", svg.len());
        let arcs = ["enters, 0.0 deg", "leaves, 60.0 deg", "enters, 120.0 deg", "leaves, 180.0 deg"];
        for label in ["force (N)", "moment (N m)", "along the feed"].into_iter().chain(arcs) {
            assert!(svg.contains(label), "{label}");
        }
    }
}
