//! The command line as a whole: which commands there are. What each takes and says of itself is declared in its own
//! file.

#[cfg(feature = "live")]
use super::live;
use super::manuals::STEAD;
use super::{
    VERSION, assess, check, circularity, compensate, completions, explain, export, forces, identify, import, init, man,
    page, place, pose, robots, schema, score, simulate, stability, study,
};
use clap::{Parser, Subcommand};

/// Workpiece placement optimiser for robotic machining.
#[derive(Debug, Parser)]
#[command(name = "stead", bin_name = "stead", version = VERSION, about, arg_required_else_help = true, after_help = STEAD)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Find the placement of the workpiece with the smallest deflection, and the largest to compare
    Place(place::PlaceOptions),
    /// Evaluate a given placement: its best and its worst plan of the spindle angle
    Score(score::ScoreOptions),
    /// Show which constraints each posture satisfies at one path point of a given placement
    Explain(explain::ExplainOptions),
    /// Move the workpiece by hand in the browser and see at once what a placement comes to
    #[cfg(feature = "live")]
    Live(live::LiveCommand),
    /// Write the page of a results folder again, from its files alone
    Page(page::PageOptions),
    /// Place many variants of a run, cell layouts by the thousand: one file, one table, resumable
    #[command(subcommand)]
    Study(study::StudyCommand),
    /// Compare robots by the circularity of a milled circle: maps, best zones, selection for a task
    Assess(assess::AssessOptions),
    /// Compute the cutting forces of a tool path from the stock that it cuts
    Forces(forces::ForcesOptions),
    /// Correct a path so that the deflected tool follows the target path
    Compensate(compensate::CompensateOptions),
    /// Write a robot program from a plan: KRL, RAPID, Fanuc or CSV; or read one back and compare it
    Export(export::ExportCommand),
    /// Identify joint compliances from measured deflections: plan the measurements, fit the parameters
    #[command(subcommand)]
    Identify(identify::IdentifyCommand),
    /// Compute the circularity of measured points about the four reference circles of ISO 12181
    Circularity(circularity::CircularityOptions),
    /// Simulate a milling pass with a flexible arm: forces, surface of the wall, chatter
    Simulate(simulate::SimulateOptions),
    /// Predict chatter: modes of the arm, frequency response of the tool tip, stability lobes
    Stability(stability::StabilityOptions),
    /// Say what was understood of a run or robot file, and what looks wrong
    Check(check::CheckOptions),
    /// Show where joint angles bring flange and tool, to compare with a teach pendant
    Pose(pose::PoseOptions),
    /// List the arms that stead ships with
    Robots(robots::RobotsOptions),
    /// Turn what other programs write into files of stead: a robot from a URDF, a tool path from CAM
    #[command(subcommand)]
    Import(import::ImportCommand),
    /// Write a small commented set of input files that runs
    Init(init::InitOptions),
    /// Print the JSON Schema of a kind of input file, or of a document that a command writes
    Schema(schema::SchemaOptions),
    /// Print the completion script of a shell
    Completions(completions::CompletionsOptions),
    /// Write the manual pages
    Man(man::ManOptions),
}
