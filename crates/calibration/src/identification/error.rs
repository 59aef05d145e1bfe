//! Why nothing can be identified, and which entry of the sheet is at fault.

use super::law::LawError;
use super::model::Layout;
use super::normal_equations::Unidentifiable;
use super::setup::SetupError;
use stead_model::robot::RobotError;
use stead_numerics::monitor::Stop;

/// Why nothing can be identified.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// Base transform and reference points are not identifiable.
    #[error("{0}")]
    Setup(#[from] SetupError),
    /// A deflection is far larger than the load could cause on the starting arm.
    #[error("a deflection of {deflection_mm:.3} mm, where the load could cause some {expected_mm:.3} mm")]
    TooFar {
        /// Line of the reading in the sheet, from 1.
        line: usize,
        /// The deflection. mm
        deflection_mm: f64,
        /// Upper bound by the compliances of the starting arm. mm
        expected_mm: f64,
    },
    /// Fewer equations than unknowns.
    #[error("{equations} deflection components do not determine {unknowns} compliances")]
    TooFew {
        /// Components read.
        equations: usize,
        /// Compliances sought.
        unknowns: usize,
    },
    /// As many equations as unknowns, and the noise is not stated.
    #[error("{equations} deflection components for {equations} compliances leave nothing to estimate the noise from")]
    NoiseUnknown {
        /// Components read, and compliances sought.
        equations: usize,
    },
    /// Every joint is held.
    #[error("every compliance is held: nothing is left to identify")]
    NothingFree,
    /// Compliances, or combinations of them, that change no reading.
    #[error("{}", unidentifiable_text(unidentifiable, layout, outliers))]
    Unidentifiable {
        /// The combinations.
        unidentifiable: Vec<Unidentifiable>,
        /// The parameters, to name them by.
        layout: Layout,
        /// Lines of the outliers without which it is so, from 1; none where it is so with all readings.
        outliers: Vec<usize>,
    },
    /// The estimate of a compliance is far below zero: the arm moves against the load.
    #[error(
        "the compliance of {name} comes out as {value_urad:.4} with a standard deviation of {deviation_urad:.4} urad/(N m): \
         the joint turns against its load{hint}"
    )]
    Negative {
        /// The joint, or the spring.
        name: String,
        /// What else may help, where anything does.
        hint: &'static str,
        /// The estimate. urad/(N m)
        value_urad: f64,
        /// Its standard deviation. urad/(N m)
        deviation_urad: f64,
    },
    /// The compensator is not identifiable.
    #[error("{0}")]
    Law(#[from] LawError),
    /// A compliance comes out at zero or below.
    #[error(
        "the compliance of joint {joint} comes out as {value_urad:.4} with a standard deviation of {deviation_urad:.4} \
         urad/(N m): it is not identifiable from these readings{hint}"
    )]
    NotPositive {
        /// Number of the joint, from 1.
        joint: usize,
        /// What else may help, where anything does.
        hint: &'static str,
        /// The estimate. urad/(N m)
        value_urad: f64,
        /// Its standard deviation. urad/(N m)
        deviation_urad: f64,
    },
    /// The caller asked to stop.
    #[error("{0}")]
    Stopped(#[from] Stop),
    /// The identified arm is refused, as where the compensator makes a joint give way inside its limits.
    #[error("the identified arm is none: {0}")]
    Robot(#[from] RobotError),
}

/// Every combination by the names of its parameters, in a sentence.
fn unidentifiable_text(unidentifiable: &[Unidentifiable], layout: &Layout, outliers: &[usize]) -> String {
    let combination = |combination: &Unidentifiable| {
        let names: Vec<String> = combination.parameters.iter().map(|parameter| layout.name(*parameter)).collect();
        match &names[..] {
            [alone] => format!("no reading depends on {alone}"),
            several => format!("{} are identifiable only in combination", several.join(", ")),
        }
    };
    let all: Vec<String> = unidentifiable.iter().map(combination).collect();
    let text = format!("not every compliance is identifiable from the readings: {}", all.join("; "));
    if outliers.is_empty() {
        return text;
    }
    let lines: Vec<String> = outliers.iter().map(usize::to_string).collect();
    format!("without the outliers of lines {}, {text}", lines.join(", "))
}

/// The entry of a sheet that is at fault for an error.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SheetFault {
    /// Line of the sheet, from 1; none where it is the sheet as a whole.
    pub line: Option<usize>,
    /// The column, if it is one.
    pub column: Option<String>,
    /// What is needed instead.
    pub needed: &'static str,
}

impl IdentifyError {
    /// Whether the readings give no spring beside the varying joint, but may give everything else.
    pub(super) fn is_of_the_spring(&self) -> bool {
        matches!(
            self,
            Self::Law(LawError::NoSpring { .. } | LawError::Unidentifiable { .. })
                | Self::Robot(RobotError::GivesWay { .. } | RobotError::SpringVanishes { .. })
        )
    }

    /// What is wrong with the sheet; nothing where a sound sheet gives no robot.
    pub fn fault(&self) -> Option<SheetFault> {
        let fault = |line: Option<usize>, column: &str, needed: &'static str| {
            Some(SheetFault { line, column: (!column.is_empty()).then(|| column.to_owned()), needed })
        };
        match self {
            Self::TooFar { line, .. } => fault(
                Some(*line),
                "loaded_x_mm",
                "places in millimetres, both of the same point, and wrenches in N and N m",
            ),
            Self::Setup(SetupError::Scale { .. }) => fault(
                None,
                "unloaded_x_mm",
                "places in millimetres, and joint angles in degrees as the robot counts them",
            ),
            Self::Setup(SetupError::Misfit { line, .. }) => fault(
                Some(*line),
                "unloaded_x_mm",
                "places in millimetres in a right-handed frame that does not move, and joint angles in degrees as the \
                 robot file counts them, each with its own reading",
            ),
            Self::Setup(_) => {
                fault(None, "unloaded_x_mm", "more configurations, with the flange in different orientations")
            }
            Self::TooFew { .. } => fault(
                None,
                "",
                "at least as many loaded coordinates as compliances: more configurations, or more at the same q2",
            ),
            Self::NoiseUnknown { .. } => fault(None, "", "more readings, or noise_mm in the config"),
            Self::Unidentifiable { outliers, .. } if !outliers.is_empty() => fault(
                outliers.first().copied(),
                "",
                "readings that agree with each other, and more of them for every compliance",
            ),
            Self::Unidentifiable { .. } => fault(
                None,
                "",
                "loads that turn every joint, each in its own way; or fit.hold or fit.reduce = true to keep compliances of \
                 the robot file",
            ),
            Self::Negative { .. } => fault(
                None,
                "force_x_n",
                "the wrench that acts on the robot, in its base frame, and the place under it as loaded_*_mm",
            ),
            Self::Law(LawError::TooFewAngles { joint, .. } | LawError::Unidentifiable { joint }) => {
                fault(None, &format!("theta{joint}_deg"), "three or more distinct angles, wide apart")
            }
            Self::Law(LawError::NoSpring { .. })
            | Self::NotPositive { .. }
            | Self::NothingFree
            | Self::Stopped(_)
            | Self::Robot(_) => None,
        }
    }
}
