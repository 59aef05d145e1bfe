//! Why a plan is not exported, or a program not compared with its plan.

use stead_disk::input::InputError;
use stead_numerics::monitor::Stop;

/// Why a plan that is sound makes no program.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ProgramError {
    /// The controller takes no program of this name.
    #[error("{name} {problem}; allowed: {allowed}")]
    Name {
        /// The name, in quotes.
        name: String,
        /// What is wrong with it.
        problem: String,
        /// What would be taken.
        allowed: String,
    },
    /// The value of an option is not what the form, the robot or the run takes.
    #[error("{option}: {problem}; allowed: {allowed}")]
    Argument {
        /// The option.
        option: &'static str,
        /// What is wrong.
        problem: String,
        /// What would be taken.
        allowed: String,
    },
    /// Moves between segments for which no free way is known.
    #[error(
        "NOT FREE: {moves}; allowed: another placement or plan, more room in the cell, a longer transfer.retract_mm, or \
         --allow-blocked-moves, which writes the program with these moves marked as NOT FREE"
    )]
    Blocked {
        /// The moves and what hits.
        moves: String,
    },
    /// The arm cannot be at a path point or retract from it in the posture of the plan.
    #[error("point {point}{way}: {reason}; allowed: {}", approaches(*.most))]
    Unreached {
        /// The path point, from 0.
        point: usize,
        /// How far from it.
        way: String,
        /// Why not.
        reason: String,
        /// The farthest in whole mm that the tool can be retracted everywhere, where the plan itself can be followed.
        /// mm
        most: Option<u32>,
    },
}

/// Which retractions a plan allows.
fn approaches(most: Option<u32>) -> String {
    match most {
        None => "a plan within the reach of the arm".to_owned(),
        Some(0) => "--approach-mm 0, for none".to_owned(),
        Some(most) => format!("--approach-mm up to {most}, or 0 for none"),
    }
}

/// Why a plan is not exported, or a program not compared with its plan.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ExportError {
    /// Something in a file is wrong.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The program cannot be made.
    #[error(transparent)]
    Program(#[from] ProgramError),
    /// The caller asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stop),
}
