//! The arguments of the command line: subcommands and options.

use super::check::CheckOptions;
use super::export::ExportCommand;
use super::given::{GivenPlacement, ModelArguments};
use super::help;
use super::import::ImportCommand;
use super::init::InitOptions;
use super::page::PageOptions;
use super::pose::PoseOptions;
use super::robots::RobotsOptions;
use super::values::{field, finite, gap, noise, point, positive, sector, seed, shard, shards, threads};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;
use std::path::PathBuf;
use stead_assessment::roundness::Sector;
use stead_format::field::FieldOverride;
use stead_study::cases::Shard;

/// Workpiece placement optimiser for robotic machining.
#[derive(Debug, Parser)]
#[command(name = "stead", version, about, arg_required_else_help = true, after_help = help::STEAD)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Find the placement of the workpiece with the smallest deflection, and the largest to compare
    #[command(after_long_help = help::PLACE)]
    Place(PlaceOptions),
    /// Evaluate a given placement: its best and its worst plan of the spindle angle
    #[command(after_long_help = help::SCORE)]
    Score(ScoreOptions),
    /// Show which constraints each posture satisfies at one path point of a given placement
    #[command(after_long_help = help::EXPLAIN)]
    Explain(ExplainOptions),
    /// Write the page of a results folder again, from its files alone
    #[command(after_long_help = super::page::HELP)]
    Page(PageOptions),
    /// Place many variants of a run, cell layouts by the thousand: one file, one table, resumable
    #[command(subcommand)]
    Study(StudyCommand),
    /// Compare robots by the circularity of a milled circle: maps, best zones, selection for a task
    #[command(after_long_help = help::ASSESS)]
    Assess(AssessOptions),
    /// Correct a path so that the deflected tool follows the target path
    #[command(after_long_help = help::COMPENSATE)]
    Compensate(CompensateOptions),
    /// Write a robot program from a plan: KRL, RAPID, Fanuc or CSV; or read one back and compare it
    #[command(after_long_help = super::export::HELP)]
    Export(ExportCommand),
    /// Identify joint compliances from measured deflections: plan the measurements, fit the parameters
    #[command(subcommand)]
    Identify(IdentifyCommand),
    /// Compute the circularity of measured points about the four reference circles of ISO 12181
    #[command(after_long_help = help::CIRCULARITY)]
    Circularity(CircularityOptions),
    /// Simulate a milling pass with a flexible arm: forces, surface of the wall, chatter
    #[command(after_long_help = help::SIMULATE)]
    Simulate(SimulateOptions),
    /// Predict chatter: modes of the arm, frequency response of the tool tip, stability lobes
    #[command(after_long_help = help::STABILITY)]
    Stability(StabilityOptions),
    /// Say what was understood of a run or robot file, and what looks wrong
    #[command(after_long_help = help::CHECK)]
    Check(CheckOptions),
    /// Show where joint angles bring flange and tool, to compare with a teach pendant
    #[command(after_long_help = help::POSE)]
    Pose(PoseOptions),
    /// List the arms that stead ships with
    #[command(after_long_help = help::ROBOTS)]
    Robots(RobotsOptions),
    /// Turn what other programs write into files of stead: a robot from a URDF, a tool path from CAM
    #[command(subcommand)]
    Import(ImportCommand),
    /// Write a small commented set of input files that runs
    #[command(after_long_help = help::INIT)]
    Init(InitOptions),
    /// Print the JSON Schema of a kind of input file
    #[command(after_long_help = help::SCHEMA)]
    Schema(SchemaOptions),
    /// Print the completion script of a shell
    #[command(after_long_help = help::COMPLETIONS)]
    Completions(CompletionsOptions),
    /// Write the manual pages
    #[command(after_long_help = help::MAN)]
    Man(ManOptions),
}

#[derive(Debug, Args)]
pub(super) struct SchemaOptions {
    /// Kind of file: run, robot, simulate, assess, identify-fit, identify-plan, compensate or study
    pub name: String,
}

#[derive(Debug, Args)]
pub(super) struct CompletionsOptions {
    /// Shell that the script is for
    #[arg(value_parser = PossibleValuesParser::new(["bash", "zsh", "fish"]).try_map(|name| name.parse::<Shell>()))]
    pub shell: Shell,
}

#[derive(Debug, Args)]
pub(super) struct ManOptions {
    /// Folder for the pages; it is created where it is missing
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
}

#[derive(Debug, Args)]
pub(super) struct PlaceOptions {
    /// Run file (TOML)
    pub config: PathBuf,
    /// Value in place of that of the run file, or of a file that it names, as cell.z_mm=[-300,0]; may be repeated
    #[arg(long, value_name = "PATH=VALUE", value_parser = field)]
    pub set: Vec<FieldOverride>,
    /// Folder for the results [default: results/<name of the run file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Seed of the random numbers, instead of the run file's
    #[arg(long, value_name = "S", value_parser = seed, allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// Continue until it is proved that no placement is better, or worse, by more than G per cent
    #[arg(long, value_name = "G", value_parser = gap, allow_hyphen_values = true)]
    pub certify: Option<f64>,
    /// Refine the basins of the best placement once more for force errors of 10 %, and say how far it moves
    #[arg(long)]
    pub sensitivity: bool,
    /// Look for the best placement alone, in half of the time, whatever the run file says
    #[arg(long)]
    pub no_worst: bool,
    /// Leave no page for the browser, whatever the run file says
    #[arg(long)]
    pub no_page: bool,
    /// If it is interrupted, let its results take the place of finished ones, instead of leaving them in <DIR>.interrupted
    #[arg(long)]
    pub keep_partial: bool,
    /// Number of threads; it does not change the result [default: number of processors]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Print one JSON document instead of tables
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub(super) struct AssessOptions {
    /// Assessment file (TOML)
    pub config: PathBuf,
    /// Folder for the results [default: results/<name of the assessment file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Wanted accuracy in mm, instead of the list in the file
    #[arg(long, value_name = "A", value_parser = positive, allow_hyphen_values = true)]
    pub accuracy_mm: Option<f64>,
    /// Cutting force in N for the wanted accuracy, instead of the list in the file
    #[arg(long, value_name = "F", value_parser = positive, allow_hyphen_values = true)]
    pub force_n: Option<f64>,
    /// Number of threads; it does not change the result [default: number of processors]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Print one JSON document instead of tables
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Subcommand)]
pub(super) enum StudyCommand {
    /// Do what is left to do of a study, or of a shard of it; goes on where it was after a crash
    #[command(after_long_help = help::STUDY_RUN)]
    Run(StudyRunOptions),
    /// Print the script of a Slurm array that does a study, one shard an element
    #[command(after_long_help = help::STUDY_SLURM)]
    Slurm(StudySlurmOptions),
    /// Show how far a study is, shard by shard
    #[command(after_long_help = help::STUDY_STATUS)]
    Status(StudyStatusOptions),
    /// Rank the layouts of a study that is done, with fronts, effects and pictures
    #[command(after_long_help = help::STUDY_REPORT)]
    Report(StudyReportOptions),
}

#[derive(Debug, Args)]
pub(super) struct StudyReportOptions {
    /// Study file (TOML)
    pub config: PathBuf,
    /// Folder of the results, which the report goes to too [default: results/<name of the study file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Column of study.csv to rank by, with :min or :max behind it to say which is better [default: objective_mm]
    #[arg(long, value_name = "COLUMN")]
    pub by: Option<String>,
    /// Columns of the front [default: best_mean_total_mm,cycle_s]
    #[arg(long, value_name = "COLUMN,COLUMN", value_delimiter = ',')]
    pub front: Option<Vec<String>>,
    /// Axes of the map [default: the two with the largest effects]
    #[arg(long, value_name = "AXIS,AXIS", value_delimiter = ',')]
    pub map: Option<Vec<String>>,
    /// Difference in per cent up to which figures of searches are ties
    #[arg(long, value_name = "N", default_value = "0.2", value_parser = noise, allow_hyphen_values = true)]
    pub noise_percent: f64,
    /// Print one JSON document instead of tables
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub(super) struct StudyRunOptions {
    /// Study file (TOML)
    pub config: PathBuf,
    /// Do part I of N: the cases I, I + N, and so on [default: all]
    #[arg(long, value_name = "I/N", value_parser = shard)]
    pub shard: Option<Shard>,
    /// Folder for the results [default: results/<name of the study file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of threads; it does not change the result [default: number of processors]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Remove kept cases that are not of the study as it is now, after an edit of its files
    #[arg(long)]
    pub prune: bool,
}

#[derive(Debug, Args)]
pub(super) struct StudySlurmOptions {
    /// Study file (TOML)
    pub config: PathBuf,
    /// Elements of the array, each with one shard of the study
    #[arg(long, value_name = "N", value_parser = shards, allow_negative_numbers = true)]
    pub shards: usize,
    /// Processors and threads of each element
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = threads, allow_negative_numbers = true)]
    pub threads: usize,
    /// Folder for the results, which all nodes see [default: results/<name of the study file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct StudyStatusOptions {
    /// Study file (TOML)
    pub config: PathBuf,
    /// Folder of the results [default: results/<name of the study file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print one JSON document instead of a table
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Subcommand)]
pub(super) enum IdentifyCommand {
    /// Fit compliances, compensator and covariance to a filled measurement sheet; writes a robot file
    #[command(after_long_help = help::IDENTIFY_FIT)]
    Fit(IdentifyFitOptions),
    /// Choose the configurations and loads to measure; writes the sheet to fill in
    #[command(after_long_help = help::IDENTIFY_PLAN)]
    Plan(IdentifyPlanOptions),
}

#[derive(Debug, Args)]
pub(super) struct IdentifyPlanOptions {
    /// Identification file (TOML) with a table [plan]
    pub config: PathBuf,
    /// Folder for the results [default: results/<name of the identification file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Seed of the random numbers, instead of the file's
    #[arg(long, value_name = "S", value_parser = seed, allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// Number of threads; it does not change the result [default: number of processors]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Print one JSON document instead of tables
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub(super) struct IdentifyFitOptions {
    /// Identification file (TOML)
    pub config: PathBuf,
    /// Folder for the results [default: results/<name of the identification file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print one JSON document instead of tables
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub(super) struct ScoreOptions {
    /// Run file (TOML)
    pub config: PathBuf,
    /// Value in place of that of the run file, or of a file that it names, as cell.z_mm=[-300,0]; may be repeated
    #[arg(long, value_name = "PATH=VALUE", value_parser = field)]
    pub set: Vec<FieldOverride>,
    #[command(flatten)]
    pub place: GivenPlacement,
    /// Orientation of the part by its name, where the run file has several
    #[arg(long, value_name = "NAME", conflicts_with = "placement_of")]
    pub orientation: Option<String>,
    /// Folder for plans, deflection map, pictures and score.json [default: nothing is written]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// If it is interrupted, let its results take the place of finished ones, instead of leaving them in <DIR>.interrupted
    #[arg(long, requires = "out")]
    pub keep_partial: bool,
    /// Print one JSON document instead of a table
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub(super) struct ExplainOptions {
    /// Run file (TOML)
    pub config: PathBuf,
    /// Value in place of that of the run file, or of a file that it names, as cell.z_mm=[-300,0]; may be repeated
    #[arg(long, value_name = "PATH=VALUE", value_parser = field)]
    pub set: Vec<FieldOverride>,
    #[command(flatten)]
    pub place: GivenPlacement,
    /// Orientation of the part by its name, where the run file has several
    #[arg(long, value_name = "NAME", conflicts_with = "placement_of")]
    pub orientation: Option<String>,
    /// Path point, counted from 0 in the order of the task file
    #[arg(long, value_name = "I", value_parser = point, allow_negative_numbers = true)]
    pub point: usize,
    /// Free angle beta about the tool axis in degrees
    #[arg(long, value_name = "B", value_parser = finite, allow_hyphen_values = true)]
    pub beta_deg: f64,
    /// Print one JSON document instead of a table
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub(super) struct CompensateOptions {
    /// Compensation file (TOML)
    pub config: PathBuf,
    /// Robot file (TOML) of the same geometry on which the corrected path is evaluated, instead of the file's `reality`
    #[arg(long, value_name = "ROBOT")]
    pub reality: Option<PathBuf>,
    /// Fail where a point cannot be corrected, instead of keeping its target
    #[arg(long)]
    pub all_or_nothing: bool,
    /// Folder for the results [default: results/<name of the compensation file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print one JSON document instead of a table
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub(super) struct CircularityOptions {
    /// Measured points (CSV with x_mm,y_mm or x_mm,y_mm,z_mm)
    pub points: PathBuf,
    /// Exclude points from angle A to B in degrees about the least-squares centre; may be repeated
    #[arg(long, value_name = "A:B", value_parser = sector, allow_hyphen_values = true)]
    pub exclude_deg: Vec<Sector>,
    /// Folder for circularity.json, deviations.csv, polar.svg and report.html [default: nothing is written]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print one JSON document instead of a table
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub(super) struct SimulateOptions {
    /// Simulation file (TOML)
    pub config: PathBuf,
    #[command(flatten)]
    pub model: ModelArguments,
    /// Use the condensed model, with mass matrix and Jacobian frozen every few millimetres
    #[arg(long)]
    pub fast: bool,
    /// Folder for the results [default: results/<name of the simulation file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print one JSON document instead of a text
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub(super) struct StabilityOptions {
    /// Simulation file (TOML)
    pub config: PathBuf,
    #[command(flatten)]
    pub model: ModelArguments,
    /// Folder for the results [default: results/<name of the simulation file>-stability]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of threads; it does not change the result [default: number of processors]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Print one JSON document instead of a text
    #[arg(long)]
    pub json: bool,
}
