//! How hard to search.

use super::sense::Sense;

/// How the posture scheme of a candidate placement is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PostureSearch {
    /// Exactly: the best posture of each segment, for every candidate.
    Exact,
    /// In the genome, one posture number per segment, as Caro 2013 did.
    Genetic,
}

/// Whether the search uses a lookup table ([`super::lookup`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LookupUse {
    /// Where the task allows it and the table fits in memory.
    Auto,
    /// As a wish: a task that does not allow it is refused when it is read.
    Always,
    /// Never: the planner evaluates every candidate.
    Never,
}

/// Settings of the genetic search and of the refinement after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchSettings {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Candidates in a generation, at least 4.
    pub population: usize,
    /// Generations after the random start.
    pub generations: usize,
    /// How posture schemes are found.
    pub postures: PostureSearch,
    /// Distinct basins of each search that are refined, at least 1.
    pub basins: usize,
    /// Whether to use a lookup table.
    pub tables: LookupUse,
    /// Points of a long path by which candidates are compared; chosen where none is given. With all points of the path or more, it
    /// is searched and refined whole.
    pub path_points: Option<usize>,
    /// Whether the worst placement is looked for, too, to show what is at stake.
    pub worst: bool,
    /// The relative size of a force error for which the basins are refined once more, to see how far the optimum moves; none
    /// where that is not asked.
    pub sensitivity: Option<f64>,
}

impl SearchSettings {
    /// The force error of a sensitivity analysis where no other is given.
    pub const FORCE_ERROR: f64 = 0.1;

    /// Whether the placement that is best in a sense is looked for.
    pub fn seeks(&self, sense: Sense) -> bool {
        sense == Sense::Min || self.worst
    }
}

impl Default for SearchSettings {
    /// The published population and generations (Caro 2013, section V).
    fn default() -> Self {
        Self {
            seed: 1,
            population: 120,
            generations: 51,
            postures: PostureSearch::Exact,
            basins: 4,
            tables: LookupUse::Auto,
            path_points: None,
            worst: true,
            sensitivity: None,
        }
    }
}

/// Limits of the joint moves between segments, for joints whose row of the robot file does not state them, and how the cut is blended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransferSettings {
    /// Time from rest to full speed at full acceleration; the acceleration limit is speed over this. s
    pub acceleration_time: f64,
    /// Time from no to full acceleration at full jerk; the jerk limit is acceleration over this. s
    pub jerk_time: f64,
    /// Distance over which the controller blends changes of the joint speeds along the cut ([`super::feed`]). m
    pub blend: f64,
}

impl Default for TransferSettings {
    /// Assumptions: manufacturers publish speeds, not accelerations, and the blending distance is set by the robot's program.
    fn default() -> Self {
        Self { acceleration_time: 0.4, jerk_time: 0.1, blend: 5e-3 }
    }
}

/// How sharp a certificate ([`super::certify`]) is to be, and how long it may take.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct CertificateSettings {
    /// How much better than the value found a placement may still be, relative to it: from [`Self::MIN_GAP`] to below 1.
    pub gap: f64,
    /// Time for the certificate, of the best and of the worst placement together, where it is limited. What is reached by
    /// then depends on the machine. s
    pub time_limit: Option<f64>,
    /// Memory for tables and open boxes, counted and not measured, so that what is reached with it is the same on every machine. Bytes
    pub memory: u64,
}

impl CertificateSettings {
    /// The finest gap that can be asked for: rounding and the digits of the files are well below.
    pub const MIN_GAP: f64 = 1e-6;
    /// What the memory is where nothing is said of it. Bytes
    pub const DEFAULT_MEMORY: u64 = 4_000_000_000;

    /// A certificate of this gap (relative), without a time limit, in the memory that is allowed by default.
    pub fn new(gap: f64) -> Self {
        Self { gap, time_limit: None, memory: Self::DEFAULT_MEMORY }
    }

    /// The gap of so many per cent, where it can be asked for: not zero or below, not finer than rounding allows, and less
    /// than everything.
    pub fn gap(percent: f64) -> Option<f64> {
        // A number such as 0.0001 may come out a little low.
        let min = Self::MIN_GAP * (1.0 - 1e-12);
        Some(percent / 100.0).filter(|gap| (min..1.0).contains(gap))
    }
}
