//! The cutter and its cut in a simulation file.

use super::super::cutting::DIRECTIONS;
use super::super::reader::{Field, Table};
use crate::input::InputError;
use std::f64::consts::TAU;
use stead_model::cutting::{Coefficients, Cut, Cutter, CutterError, Rotation, Tooth};
use stead_simulation::milling::{CutError, PassCut};

/// The keys of a cutter and its cut.
pub(crate) const KEYS: [&str; 13] = [
    "cutter_diameter_mm",
    "teeth",
    "pitch_deg",
    "runout_um",
    "helix_deg",
    "flute_length_mm",
    "kt_mpa",
    "kr_mpa",
    "ka_mpa",
    "milling",
    "radial_depth_mm",
    "axial_depth_mm",
    "spindle_rpm",
];

/// Speeds beyond this are those of no spindle. rpm
pub const FASTEST_RPM: f64 = 1e6;

/// Reads the keys of [`KEYS`] from a table: the cutter and the cut, for work of a length (m), in so many slices and steps a
/// turn. `pitch_deg` may be left out for equal ones, `runout_um`, `helix_deg` and `ka_mpa` where they are 0.
///
/// # Errors
/// [`InputError`] with file, line and field: a missing key, a value of the wrong kind or out of range, pitches that do not make
/// a turn, a cut wider than the cutter or deeper than its flutes, too few steps.
pub(crate) fn milling_from(
    table: &Table<'_>,
    length: f64,
    slices: usize,
    steps_per_turn: usize,
) -> Result<(Cutter, PassCut), InputError> {
    let [diameter, teeth, pitch, runout, helix, flute, kt, kr, ka, milling, radial, axial, rpm] =
        KEYS.map(|key| table.field(key));
    let count = teeth.integer(1..=100)? as usize;
    let radius = diameter.positive()? / 2e3;
    let listed = |field: &Field<'_>, what: &str| -> Result<Option<Vec<f64>>, InputError> {
        let allowed = format!("{what}, one for each of the {count} teeth");
        let numbers = field.optional(|field| field.numbers(&allowed, |_| true))?;
        match &numbers {
            Some(numbers) if numbers.len() != count => {
                Err(field.error(format!("has {} numbers for {count} teeth", numbers.len()), allowed))
            }
            _ => Ok(numbers),
        }
    };
    let pitches = listed(&pitch, "pitches from one tooth to the next in deg that make 360")?;
    let offsets = listed(&runout, "what the radius of an edge is more than half the diameter, in um")?;
    let edges = (0..count).map(|k| Tooth {
        pitch: pitches.as_ref().map_or(TAU / count as f64, |pitches| pitches[k].to_radians()),
        radius: radius + offsets.as_ref().map_or(0.0, |offsets| offsets[k] / 1e6),
    });
    let angle = |field: &Field<'_>| field.number_where("a number above -90 and below 90", |v| v.abs() < 90.0);
    let pressure = |field: &Field<'_>| field.number().map(|mpa| mpa * 1e6);
    let tangential = kt.positive()? * 1e6;
    let coefficients = Coefficients::new(tangential, pressure(&kr)?, ka.optional(pressure)?.unwrap_or_default());
    let helix_angle = helix.optional(angle)?.unwrap_or_default().to_radians();
    let flute_length = Some(flute.positive()? / 1e3);
    let made = Cutter::new(edges.collect(), helix_angle, flute_length, Rotation::Clockwise, coefficients);
    let cutter = made.map_err(|error| {
        let field = match error {
            CutterError::Toothless => &teeth,
            CutterError::Pitch { .. } => &pitch,
            CutterError::Radius { .. } => &runout,
            CutterError::Helix { .. } => &helix,
            CutterError::Flute { .. } => &flute,
            CutterError::Coefficient { .. } => &kt,
        };
        field.error(format!("makes no cutter: {error}"), "the numbers of a real cutter")
    })?;
    // With runout the cutter cuts wider or less wide than its diameter: a cut of the whole diameter is a slot all the same.
    let (width, mean) = (radial.positive()? / 1e3, 2.0 * cutter.radius());
    let radial_depth = if (2.0 * radius.min(cutter.radius())..=2.0 * radius).contains(&width) { mean } else { width };
    let cut = PassCut {
        section: Cut { direction: milling.one_of(&DIRECTIONS)?, radial_depth, axial_depth: axial.positive()? / 1e3 },
        length,
        spindle_speed: rpm_from(&rpm)?,
        slices,
        steps_per_turn,
    };
    match cut.check(&cutter) {
        Ok(()) => Ok((cutter, cut)),
        Err(error) => Err(match error {
            CutError::Width { .. } => {
                let allowed = format!("a number above 0 and not above cutter_diameter_mm = {}", diameter.written());
                radial.error("is wider than the cutter", allowed)
            }
            CutError::Depth { .. } => {
                let allowed = format!("a number above 0 and not above flute_length_mm = {}", flute.written());
                axial.error("is deeper than the flutes of the cutter", allowed)
            }
            CutError::Positive { .. } => rpm.error(format!("makes no cut: {error}"), "finite numbers above 0"),
            CutError::Coefficient { .. } | CutError::EdgeForces => {
                kt.error(format!("makes no cut: {error}"), "a number above 0")
            }
            CutError::Slices => rpm.error("makes no cut without slices", "at least one slice"),
            CutError::Steps { min, .. } => {
                let problem = format!("has teeth so close that {steps_per_turn} steps a turn do not tell them apart");
                let at = if pitch.is_given() { &pitch } else { &teeth };
                at.error(problem, format!("at least {min} steps a turn"))
            }
        }),
    }
}

/// A spindle speed, rad/s.
pub(crate) fn rpm_from(field: &Field<'_>) -> Result<f64, InputError> {
    let allowed = format!("a number above 0 and not above {FASTEST_RPM}");
    field.number_where(&allowed, |value| value > 0.0 && value <= FASTEST_RPM).map(|rpm| rpm / 60.0 * TAU)
}
