//! `stead export`: a robot program from a plan, or a program read back.

use super::Failure;
use super::given::Force;
use super::manual::{Manual, STOPPED};
use super::output::{print, print_json, say_all, say_notes, say_warnings, show};
use super::progress::Terminal;
use super::values::{finite, input_file};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::path::{Path, PathBuf};
use stead::program::{CorrectedPath, ExportOptions, ProgramFormat, ReadBackOptions};
use stead::{Error, Run};

#[derive(Debug, Args)]
pub(super) struct ExportCommand {
    /// Run file (TOML) of the plan
    #[arg(value_parser = input_file())]
    pub config: PathBuf,
    /// Plan that `stead place` wrote for it, as results/<run>/best.csv
    pub plan: PathBuf,
    /// Form of the program: krl (KUKA), rapid (ABB), fanuc, or csv for any post
    #[arg(long, value_name = "F", value_parser = formats(), required_unless_present = "check")]
    pub format: Option<ProgramFormat>,
    /// Folder and name of the program, without ending
    #[arg(long, value_name = "DIR/NAME", required_unless_present = "check")]
    pub out: Option<PathBuf>,
    /// Follow the path of `stead compensate` (corrected-path.csv) instead of the plan's
    #[arg(long, value_name = "FILE")]
    pub corrected: Option<PathBuf>,
    /// Command points that could not be corrected as planned, instead of refusing the path
    #[arg(long, requires = "corrected")]
    pub uncorrected_as_planned: bool,
    /// How far the tool is drawn back along its axis where no free way is planned; 0 for none [default:
    /// transfer.retract_mm]
    #[arg(long, value_name = "D", value_parser = finite, allow_hyphen_values = true)]
    pub approach_mm: Option<f64>,
    /// Write moves that hit or that the arm cannot follow too, marked NOT FREE, instead of refusing the program
    #[arg(long)]
    pub allow_blocked_moves: bool,
    /// Distance from a corner at which blending begins; 0 for exact stops
    #[arg(long, value_name = "D", value_parser = finite, default_value = "1", allow_hyphen_values = true)]
    pub blend_mm: f64,
    /// Most moves in a part
    #[arg(long, value_name = "N", default_value = "5000", allow_hyphen_values = true)]
    pub max_moves: usize,
    /// KUKA, where an external axis carries the workpiece: number n of that mechanism at the controller,
    /// MACHINE_DEF[n]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub mechanism: Option<usize>,
    /// ABB, where an external axis carries the workpiece: name of that mechanical unit at the controller, as STN1
    #[arg(long, value_name = "NAME", allow_hyphen_values = true)]
    pub unit: Option<String>,
    /// Statement that starts the spindle, instead of a comment
    #[arg(long, value_name = "TEXT")]
    pub spindle_on: Option<String>,
    /// Statement that stops the spindle, instead of a comment
    #[arg(long, value_name = "TEXT")]
    pub spindle_off: Option<String>,
    #[command(flatten)]
    pub force: Force,
    /// Read this program back (its main file) and compare every pose, feed and blending with the plan, instead of
    /// writing one
    #[arg(long, value_name = "FILE", conflicts_with_all = ["format", "out", "allow_blocked_moves", "max_moves", "mechanism", "unit", "spindle_on", "spindle_off", "force"])]
    pub check: Option<PathBuf>,
    /// Print one JSON document instead of a text
    #[arg(long)]
    pub json: bool,
}

fn formats() -> impl TypedValueParser<Value = ProgramFormat> {
    PossibleValuesParser::new(ProgramFormat::ALL.map(ProgramFormat::word)).try_map(|word| {
        let found = ProgramFormat::ALL.into_iter().find(|format| format.word() == word);
        found.ok_or("no such format")
    })
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &[
        "stead export configs/caro-2013.toml results/caro-2013/best.csv --format csv --out my/program/PART",
        "stead export my/run.toml results/run/best.csv --format krl --out my/program/PART",
        "stead export my/table.toml results/table/best.csv --format rapid --unit STN1 --out my/program/TABLE",
        "stead export my/run.toml results/run/best.csv --format krl --out my/program/PART2 --corrected results/comp/corrected-path.csv",
        "stead export my/run.toml results/run/best.csv --check my/program/PART.src",
    ],
    written: "with --out, none of which may be there yet without --force",
    files: "\
NAME.src, NAME_01.src, ..: krl (KUKA): a main program that calls the parts
NAME.mod, NAME_01.mod, ..: rapid (ABB, IRC5 and OmniCore), likewise
NAME.ls, NAME_01.ls, ..: fanuc, likewise: TP programs as text, which the controller or its maker's tools translate
NAME.csv: csv, for a post of your own: one row for each move",
    remarks: "The frames to enter at the controller are printed. A part on a turntable needs --mechanism (krl) or \
              --unit (rapid). Programs need [controller] and [root] in the robot file; csv does not. With \
              surroundings, moves between segments are the free ways of `stead place`; a plan with a move that has \
              none is refused, or written with --allow-blocked-moves and the move marked NOT FREE. Without, collisions \
              are not checked. Run a program slowly and without a cut first. --check writes nothing.",
    done: "done; with --check: every pose is that of the plan within 0.01 mm and 0.01 deg, feeds and blending too, and no move between segments hits",
    failed: "a move hits, the arm does not reach a retracted point, a file could not be written; with --check: not the program of the plan, or it hits",
    refused: "wrong usage, bad input, a plan that is not of this run, or a file that is there already (--force replaces it): nothing is written",
    interrupted: STOPPED,
};

pub(super) fn run(options: &ExportCommand) -> Result<(), Failure> {
    let terminal = Terminal::start(None);
    let run = terminal.during(|monitor| Run::read_with(&options.config, Vec::new(), monitor))?;
    say_all(run.notes(), run.warnings());
    match &options.check {
        Some(program) => check(options, &run, program, &terminal),
        None => export(options, &run, &terminal),
    }
}

fn corrected(options: &ExportCommand) -> Option<CorrectedPath<'_>> {
    let is_uncorrected_as_planned = options.uncorrected_as_planned;
    options.corrected.as_deref().map(|file| CorrectedPath { file, is_uncorrected_as_planned })
}

/// How far the tool is retracted. m
fn approach(options: &ExportCommand, run: &Run) -> f64 {
    options.approach_mm.map_or(run.problem().segment_moves.retract, |length| length / 1e3)
}

fn export(options: &ExportCommand, run: &Run, terminal: &Terminal) -> Result<(), Failure> {
    let (Some(format), Some(out)) = (options.format, &options.out) else {
        return Err(Failure::Usage("--format and --out are needed to write a program".to_owned()));
    };
    let name = out.file_name().unwrap_or_default().to_string_lossy();
    let requested = ExportOptions {
        corrected: corrected(options),
        approach: approach(options, run),
        blend: options.blend_mm / 1e3,
        allow_blocked_moves: options.allow_blocked_moves,
        max_moves: options.max_moves,
        mechanism: options.mechanism,
        unit: options.unit.as_deref(),
        spindle_on: options.spindle_on.as_deref(),
        spindle_off: options.spindle_off.as_deref(),
        ..ExportOptions::new(format, &name)
    };
    let program = terminal.during(|monitor| run.export(&options.plan, &requested, monitor))?;
    let written = program.write(out.parent().unwrap_or(Path::new("")), options.force.existing())?;
    say_notes(program.notes());
    say_notes(&written.notes);
    say_warnings(program.warnings());
    if options.json {
        return print_json(&program);
    }
    let files: String = written.files.iter().map(|file| format!("  {}\n", file.display())).collect();
    print(format!("{program}\nwritten:\n{files}").as_bytes())
}

fn check(options: &ExportCommand, run: &Run, program: &Path, terminal: &Terminal) -> Result<(), Failure> {
    for (option, found, most) in
        [("--approach-mm", approach(options, run) * 1e3, 1000.0), ("--blend-mm", options.blend_mm, 100.0)]
    {
        if !(0.0..=most).contains(&found) {
            let problem = format!("{option}: is out of range, found {found}");
            return Err(Error::Argument(format!("{problem}; allowed: a number from 0 to {most}")).into());
        }
    }
    let exported = ReadBackOptions {
        corrected: corrected(options),
        approach: approach(options, run),
        blend: options.blend_mm / 1e3,
    };
    let checked = terminal.during(|monitor| run.check_program(&options.plan, program, &exported, monitor))?;
    show(&checked, options.json)?;
    Ok(checked.sound()?)
}
