//! Validity limits of the milling model.

use serde::Serialize;

/// Why the model is no longer valid: the run ends there and is not extrapolated.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error, Serialize)]
pub enum Limit {
    /// A chip deeper than a gullet: beyond this the body of the cutter would be in the work.
    #[error("at {time} s a chip is {chip} m thick, more than half the radius of the cutter, {radius} m")]
    Chip {
        /// When. s
        time: f64,
        /// Its thickness. m
        chip: f64,
        /// Radius of the cutter. m
        radius: f64,
    },
    /// The tool is farther from where it should be than half its radius: there the wall is not represented.
    #[error("at {time} s the tool is {deflection} m off its path, more than half the radius of the cutter, {radius} m")]
    Deflection {
        /// When. s
        time: f64,
        /// How far it is off. m
        deflection: f64,
        /// Radius of the cutter. m
        radius: f64,
    },
    /// The tool centre moves so fast that its teeth do not come by in order.
    #[error("at {time} s the tool moves at {speed} m/s, more than a quarter of the speed of its edges, {edge} m/s")]
    Speed {
        /// When. s
        time: f64,
        /// Speed of the centre. m/s
        speed: f64,
        /// Speed of the edges. m/s
        edge: f64,
    },
}

/// The figures that the limits of validity depend on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Radius of the cutter. m
    pub radius: f64,
    /// Angular speed of the spindle. rad/s
    pub spindle_speed: f64,
}

impl Limits {
    /// Whether the model is valid at a time (s): the thickest chip (m), how far the tool is off its path (m) and how
    /// fast it moves (m/s).
    ///
    /// # Errors
    /// The [`Limit`] that is passed; what is not a number is as well.
    #[inline]
    pub fn check(&self, time: f64, chip: f64, deflection: [f64; 2], velocity: [f64; 2]) -> Result<(), Limit> {
        let (radius, edge) = (self.radius, self.radius * self.spindle_speed);
        let square = |[x, y]: [f64; 2]| x * x + y * y;
        // What is not a number is not within either.
        let (is_near, is_slow) = (square(deflection) <= radius * radius / 4.0, square(velocity) <= edge * edge / 16.0);
        let is_thin = chip <= radius / 2.0;
        if !is_near {
            return Err(Limit::Deflection { time, deflection: square(deflection).sqrt(), radius });
        }
        if !is_slow {
            return Err(Limit::Speed { time, speed: square(velocity).sqrt(), edge });
        }
        if !is_thin {
            return Err(Limit::Chip { time, chip, radius });
        }
        Ok(())
    }
}
