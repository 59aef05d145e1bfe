//! What a compensation file declares.

use crate::Word;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::Bound::Included;
use stead_calibration::compensation::DeflectionModel;
use stead_format::scalars::{Whole, words};
use stead_format::units::{Mm, Number, Share, ranges};

ranges! {
    /// An error that counts as none; below a nanometre the rounding of the kinematics is in the way. mm
    Tolerance: Included(1e-9), Included(1.0);
}

words!(DeflectionModel);

/// The compensation of the deflections of a plan, for `stead compensate`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CompensationFile {
    /// The run file of `stead place`, relative to the folder of this file.
    pub run: String,
    /// A plan that it wrote (`best.csv` and the like), relative to the folder of this file.
    pub plan: String,
    /// A robot file of the same geometry, relative to the folder of this file, on which the corrected commands are
    /// played; the robot of the run where left out.
    pub reality: Option<String>,
    /// How deflections are compensated.
    pub compensation: Option<CompensationTable>,
}

/// How deflections are compensated.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct CompensationTable {
    /// Share of the error that an iteration corrects (Klimchik et al. 2017, eq. 27); 1 where left out.
    pub alpha: Option<Number<Share>>,
    /// An error up to this counts as none; 1e-6 where left out.
    pub tolerance_mm: Option<Mm<Tolerance>>,
    /// Most iterations; 50 where left out.
    pub max_iterations: Option<Whole<1, 100000>>,
    /// What the deflection is taken for: the exact static `equilibrium` (where left out), or `linear`.
    pub model: Option<Word<DeflectionModel>>,
    /// Whether the weight of the spindle (`spindle.mass_kg` of the run) and of the links, as far as their masses are
    /// known, is corrected too; `false` where left out. Not for a program that is touched up at the machine, nor for a
    /// controller that corrects the weight itself.
    pub gravity: Option<bool>,
}
