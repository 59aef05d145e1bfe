//! Engagement: the arcs of a turn over which a tooth cuts (Klimchik 2017, Fig. 3 and eq. 4 to 7).

use super::cut::MillingDirection;
use serde::Serialize;
use std::f64::consts::PI;

/// A part of a turn from `entry` to `exit`, angles phi as of [`Engagement`]. rad
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Arc {
    /// Where a tooth enters the work.
    pub entry: f64,
    /// Where it leaves the work.
    pub exit: f64,
}

/// The arcs of a turn over which a tooth cuts: one, or two where the middle of the slot is open already.
///
/// The angle phi of a tooth runs in the sense of rotation. At 0 the tooth is at the side of the tool where its motion
/// is along the feed of the tool, at pi/2 it is in front, and at pi at the other side; from pi to a full turn it is
/// behind and cuts nothing. The chip is `f_z sin(phi)` thick (eq. 1). Seen in the feed direction with the tool axis up,
/// phi = 0 is on the left for a cutter that turns clockwise, and on the right for the other. Up milling starts at phi =
/// 0, where the chip has no thickness, down milling ends at phi = pi, and a full slot does both.
///
/// Lengths are measured across the feed. Fig. 3 of the paper shows such cases; which, its text does not say.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Engagement {
    /// Ascending, without overlap, all within 0 to pi.
    arcs: Vec<Arc>,
}

/// Why numbers make no engagement.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum EngagementError {
    /// The diameter is no length. m
    #[error("the cutter diameter must be a finite number above 0, but is {0} m")]
    Diameter(f64),
    /// The width of cut is wider than the cutter, or nothing.
    #[error("the width of cut must be above 0 and not above the cutter diameter of {diameter} m, but is {width} m")]
    Width {
        /// Width of cut. m
        width: f64,
        /// Cutter diameter. m
        diameter: f64,
    },
    /// The open channel leaves nothing to cut, or is none.
    #[error("the open width must be above 0 and below the cutter diameter of {diameter} m, but is {width} m")]
    OpenWidth {
        /// Width of the open channel. m
        width: f64,
        /// Cutter diameter. m
        diameter: f64,
    },
}

impl Engagement {
    /// A full slot: work over the whole diameter.
    pub fn slot() -> Self {
        Self { arcs: vec![Arc { entry: 0.0, exit: PI }] }
    }

    /// Up (conventional) milling with a width of cut a_e. m
    ///
    /// # Errors
    /// [`EngagementError`] unless `0 < width <= diameter`.
    pub fn up(width: f64, diameter: f64) -> Result<Self, EngagementError> {
        check_width(width, diameter)?;
        Ok(Self { arcs: vec![Arc { entry: 0.0, exit: immersion(width, diameter) }] })
    }

    /// Down (climb) milling with a width of cut a_e. m
    ///
    /// # Errors
    /// [`EngagementError`] unless `0 < width <= diameter`.
    pub fn down(width: f64, diameter: f64) -> Result<Self, EngagementError> {
        check_width(width, diameter)?;
        Ok(Self { arcs: vec![Arc { entry: PI - immersion(width, diameter), exit: PI }] })
    }

    /// Up or down milling with a width of cut (m), from nothing to a full slot; a wider cut is a slot.
    pub(super) fn of_cut(direction: MillingDirection, width: f64, diameter: f64) -> Self {
        let arc = match direction {
            MillingDirection::Conventional => Arc { entry: 0.0, exit: immersion(width, diameter) },
            MillingDirection::Climb => Arc { entry: PI - immersion(width, diameter), exit: PI },
        };
        Self { arcs: vec![arc] }
    }

    /// Face milling of a width a_e with the cutter on the middle of it. m
    ///
    /// # Errors
    /// [`EngagementError`] unless `0 < width <= diameter`.
    pub fn centred(width: f64, diameter: f64) -> Result<Self, EngagementError> {
        check_width(width, diameter)?;
        let entry = immersion((diameter - width) / 2.0, diameter);
        Ok(Self { arcs: vec![Arc { entry, exit: PI - entry }] })
    }

    /// A slot of the cutter's diameter, in the middle of which a channel of the given width is open already: two arcs.
    /// m
    ///
    /// # Errors
    /// [`EngagementError`] unless `0 < open_width < diameter`.
    pub fn open_slot(open_width: f64, diameter: f64) -> Result<Self, EngagementError> {
        check_diameter(diameter)?;
        if !(open_width > 0.0 && open_width < diameter) {
            return Err(EngagementError::OpenWidth { width: open_width, diameter });
        }
        let exit = immersion((diameter - open_width) / 2.0, diameter);
        Ok(Self { arcs: vec![Arc { entry: 0.0, exit }, Arc { entry: PI - exit, exit: PI }] })
    }

    /// One arc by its angles, `0 <= entry < exit <= pi`. rad
    #[cfg(test)]
    pub(super) fn between(entry: f64, exit: f64) -> Self {
        Self { arcs: vec![Arc { entry, exit }] }
    }

    /// The arcs, ascending and without overlap.
    pub fn arcs(&self) -> &[Arc] {
        &self.arcs
    }

    /// Whether a tooth at phi, from 0 to a full turn, is in the work.
    pub fn cuts_at(&self, phi: f64) -> bool {
        self.arcs.iter().any(|arc| arc.entry <= phi && phi < arc.exit)
    }

    /// The integrals over all arcs.
    pub(super) fn integrals(&self) -> Integrals {
        self.arcs.iter().fold(Integrals::default(), |sum, arc| sum.plus(Integrals::over(*arc)))
    }
}

fn check_diameter(diameter: f64) -> Result<(), EngagementError> {
    if diameter.is_finite() && diameter > 0.0 { Ok(()) } else { Err(EngagementError::Diameter(diameter)) }
}

fn check_width(width: f64, diameter: f64) -> Result<(), EngagementError> {
    check_diameter(diameter)?;
    if width > 0.0 && width <= diameter { Ok(()) } else { Err(EngagementError::Width { width, diameter }) }
}

/// Angle between the radii to a side of the cutter and to its rim at a distance (m) across the feed from that side: 0
/// to pi. rad
fn immersion(distance: f64, diameter: f64) -> f64 {
    libm::acos((1.0 - 2.0 * distance / diameter).clamp(-1.0, 1.0))
}

/// What the mean over a turn of a force that turns with the tooth is made of.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Integrals {
    /// Integral of 1: the angle. rad
    pub angle: f64,
    /// Integral of sin(phi).
    pub sine: f64,
    /// Integral of cos(phi).
    pub cosine: f64,
    /// Integral of sin(phi)^2.
    pub sine_squared: f64,
    /// Integral of cos(phi)^2.
    pub cosine_squared: f64,
    /// Integral of sin(phi) cos(phi).
    pub sine_cosine: f64,
}

impl Integrals {
    /// Over one arc.
    pub fn over(arc: Arc) -> Self {
        let (entry_sine, entry_cosine) = libm::sincos(arc.entry);
        let (exit_sine, exit_cosine) = libm::sincos(arc.exit);
        Self {
            angle: arc.exit - arc.entry,
            sine: entry_cosine - exit_cosine,
            cosine: exit_sine - entry_sine,
            sine_squared: ((arc.exit - exit_sine * exit_cosine) - (arc.entry - entry_sine * entry_cosine)) / 2.0,
            cosine_squared: ((arc.exit + exit_sine * exit_cosine) - (arc.entry + entry_sine * entry_cosine)) / 2.0,
            sine_cosine: (exit_sine * exit_sine - entry_sine * entry_sine) / 2.0,
        }
    }

    /// Over the arcs of both.
    pub fn plus(self, other: Self) -> Self {
        Self {
            angle: self.angle + other.angle,
            sine: self.sine + other.sine,
            cosine: self.cosine + other.cosine,
            sine_squared: self.sine_squared + other.sine_squared,
            cosine_squared: self.cosine_squared + other.cosine_squared,
            sine_cosine: self.sine_cosine + other.sine_cosine,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};

    fn assert_arcs(engagement: Result<Engagement, EngagementError>, expected: &[[f64; 2]]) {
        let arcs = engagement.unwrap().arcs;
        assert_eq!(arcs.len(), expected.len());
        for (arc, [entry, exit]) in arcs.iter().zip(expected) {
            assert!((arc.entry - entry).abs() < 1e-14 && (arc.exit - exit).abs() < 1e-14, "{arc:?} {entry} {exit}");
        }
    }

    /// A quarter of the diameter reaches to a third of the half turn, three quarters to two thirds.
    #[test]
    fn each_way_of_milling_has_its_arcs() {
        assert_arcs(Ok(Engagement::slot()), &[[0.0, PI]]);
        assert_arcs(Engagement::up(0.25, 1.0), &[[0.0, FRAC_PI_3]]);
        assert_arcs(Engagement::up(0.5, 1.0), &[[0.0, FRAC_PI_2]]);
        assert_arcs(Engagement::up(0.75, 1.0), &[[0.0, 2.0 * FRAC_PI_3]]);
        assert_arcs(Engagement::down(0.25, 1.0), &[[2.0 * FRAC_PI_3, PI]]);
        assert_arcs(Engagement::down(0.75, 1.0), &[[FRAC_PI_3, PI]]);
        assert_arcs(Engagement::centred(0.5, 1.0), &[[FRAC_PI_3, 2.0 * FRAC_PI_3]]);
        assert_arcs(Engagement::open_slot(0.5, 1.0), &[[0.0, FRAC_PI_3], [2.0 * FRAC_PI_3, PI]]);
        for whole in [Engagement::up(1.0, 1.0), Engagement::down(1.0, 1.0), Engagement::centred(1.0, 1.0)] {
            assert_eq!(whole, Ok(Engagement::slot()));
        }
    }

    #[test]
    fn integrals_have_their_known_values() {
        let near = |found: Integrals, expected: [f64; 4]| {
            let parts = [found.sine, found.cosine, found.sine_squared, found.sine_cosine];
            assert!((0..4).all(|k| (parts[k] - expected[k]).abs() < 1e-15), "{found:?} {expected:?}");
        };
        near(Engagement::slot().integrals(), [2.0, 0.0, FRAC_PI_2, 0.0]);
        near(Engagement::between(0.0, FRAC_PI_2).integrals(), [1.0, 1.0, FRAC_PI_2 / 2.0, 0.5]);
        near(Engagement::between(FRAC_PI_2, PI).integrals(), [1.0, -1.0, FRAC_PI_2 / 2.0, -0.5]);
        near(Integrals::over(Arc { entry: 0.7, exit: 0.7 }), [0.0; 4]);
        let part = Integrals::over(Arc { entry: 0.3, exit: 1.9 });
        assert!((part.sine_squared + part.cosine_squared - 1.6).abs() < 1e-15);
    }

    #[test]
    fn a_tooth_is_in_the_work_on_the_arcs_alone() {
        let open = Engagement::open_slot(0.5, 1.0).unwrap();
        let cuts = [0.1, 1.0, 1.1, FRAC_PI_2, 2.0, 2.1, 3.1, 3.2, 6.2].map(|phi| open.cuts_at(phi));
        assert_eq!(cuts, [true, true, false, false, false, true, true, false, false]);
    }

    #[test]
    fn what_is_no_engagement_is_refused() {
        for diameter in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Engagement::up(0.1, diameter), Err(EngagementError::Diameter(_))), "{diameter}");
            assert!(matches!(Engagement::open_slot(0.1, diameter), Err(EngagementError::Diameter(_))));
        }
        for width in [0.0, -0.1, 1.1, f64::NAN, f64::INFINITY] {
            for make in [Engagement::up, Engagement::down, Engagement::centred] {
                assert!(matches!(make(width, 1.0), Err(EngagementError::Width { .. })), "{width}");
            }
        }
        for width in [0.0, 1.0, f64::NAN] {
            assert!(matches!(Engagement::open_slot(width, 1.0), Err(EngagementError::OpenWidth { .. })), "{width}");
        }
    }
}
