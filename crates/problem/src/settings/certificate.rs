//! How sharp a certificate is to be, and what it may take.

/// How sharp a certificate is to be, and how long it may take.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct CertificateSettings {
    /// How much better than the value found a placement may still be, relative to it: from [`Self::MIN_GAP`] to
    /// below 1.
    pub gap: f64,
    /// Time for the certificate, of the best and of the worst placement together, where it is limited. What is reached
    /// by then depends on the machine. s
    pub time_limit: Option<f64>,
    /// Memory for tables and open boxes, counted and not measured, so that what is reached with it is the same on every
    /// machine. Bytes
    pub memory: u64,
}

impl CertificateSettings {
    /// The finest gap that can be requested: rounding and the digits of the files are well below.
    pub const MIN_GAP: f64 = 1e-6;
    /// What the memory is where nothing is said of it. Bytes
    pub const DEFAULT_MEMORY: u64 = 4_000_000_000;

    /// A certificate of this gap (relative), without a time limit, in the memory that is allowed by default.
    pub fn new(gap: f64) -> Self {
        Self { gap, time_limit: None, memory: Self::DEFAULT_MEMORY }
    }

    /// The gap of so many per cent, where it can be requested: not zero or below, not finer than rounding allows, and
    /// less than everything.
    pub fn gap(percent: f64) -> Option<f64> {
        // A number such as 0.0001 may come out a little low.
        let min = Self::MIN_GAP * (1.0 - 1e-12);
        Some(percent / 100.0).filter(|gap| (min..1.0).contains(gap))
    }
}
