//! `stead import path`: a task file from a tool path of a CAM system.

use super::super::Failure;
use super::super::given::Force;
use super::super::output::{print, say_notes};
use super::super::values::{finite, parsed};
use crate::cli::manual::Manual;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::path::PathBuf;
use stead::import::{CamFormat, LengthUnit, Machine, PathSettings, Resampling, import_path};

#[derive(Debug, Args)]
pub(in super::super) struct PathOptions {
    /// Tool path (CLDATA or G-code)
    pub program: PathBuf,
    /// Task file (CSV) to write; the cutter goes into NAME-tool.toml beside it, where the program describes one
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Largest distance between path points in mm
    #[arg(long, value_name = "S", default_value = "10", value_parser = step, allow_hyphen_values = true)]
    pub step_mm: f64,
    /// How far a point that is left out may be from the line that stands for it, in mm
    #[arg(long, value_name = "C", default_value = "0.01", value_parser = chord, allow_hyphen_values = true)]
    pub chord_mm: f64,
    /// Unit of length, where the file does not state it
    #[arg(long, value_parser = one_of(LengthUnit::WORDS))]
    pub units: Option<LengthUnit>,
    /// What the file is written in; cldata: a dialect told from the file [default: told from the file]
    #[arg(long, value_parser = one_of(CamFormat::WORDS))]
    pub format: Option<CamFormat>,
    /// Machine that G-code with rotary axes is for
    #[arg(long, value_parser = one_of(Machine::WORDS))]
    pub machine: Option<Machine>,
    /// Take tool centre point control as on though the G-code has no G43.4
    #[arg(long)]
    pub tcp: bool,
    /// Where the rotary axes meet, for G-code without it: in the workpiece frame, or for a head from the tool tip
    /// upright
    #[arg(long, value_name = "X,Y,Z", value_parser = place, allow_hyphen_values = true, conflicts_with = "tcp")]
    pub pivot_mm: Option<[f64; 3]>,
    /// Leave out the holes of drilling cycles, and list them
    #[arg(long)]
    pub skip_cycles: bool,
    /// Take links between cuts that are programmed at feed as cuts, not as rapid moves
    #[arg(long)]
    pub keep_links: bool,
    /// Words of CLDATA to pass over whatever they do, or codes of G-code whose blocks are passed over
    #[arg(long, value_name = "WORD,..", value_delimiter = ',')]
    pub ignore: Vec<String>,
    /// Print segments, points, length, extents, tilt, feeds, and what was changed and why
    #[arg(long)]
    pub report: bool,
    #[command(flatten)]
    pub force: Force,
}

/// What the help and the guide say of it.
pub(in crate::cli) const MANUAL: Manual = Manual {
    examples: &[
        "stead import path part.cls --units mm --out my/part.csv --report",
        "stead import path part.nc --machine table-ac --step-mm 5 --out my/part.csv",
    ],
    written: "as --out names them",
    files: "\
NAME.csv: the task: path points without forces
NAME-tool.toml: the cutter, where the program describes one",
    remarks: "The task has no forces: a run takes them from [tool] and [cut], or from [forces]. `stead init place \
              --robot .. --task ..` takes both files.",
    refused: "wrong usage, a program that is refused, with line and word, or a file that is there already (--force replaces it): nothing is written",
    ..Manual::NEW
};

pub(super) fn run(options: &PathOptions) -> Result<(), Failure> {
    let settings = PathSettings {
        format: options.format,
        units: options.units,
        machine: options.machine,
        pivot: options.pivot_mm.map(|mm| mm.map(|mm| mm / 1e3).into()),
        tool_centre_point: options.tcp,
        skip_cycles: options.skip_cycles,
        keep_links: options.keep_links,
        ignore: options.ignore.iter().map(|word| word.trim().to_owned()).filter(|word| !word.is_empty()).collect(),
        resampling: Resampling { chord: options.chord_mm / 1e3, step: options.step_mm / 1e3 },
    };
    let path = import_path(&options.program, &settings).map_err(stead::Error::from)?;
    let files = path.write(&options.out, options.force.existing()).map_err(stead::Error::from)?;
    let report = if options.report {
        format!("{path}\n")
    } else {
        say_notes(&path.notes);
        String::new()
    };
    let [points, scored] = path.point_counts();
    let segments = path.segment_count();
    let out: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    let out = out.join(", ");
    print(format!("{report}written: {out}: {segments} segments, {points} points, {scored} of them scored\n").as_bytes())
}

/// What one of some words stands for.
fn one_of<T: Copy + Send + Sync + 'static>(words: &'static [(&'static str, T)]) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(words.iter().map(|(word, _)| *word)).try_map(move |given| {
        let found = words.iter().find(|(word, _)| *word == given);
        found.map(|(_, meaning)| *meaning).ok_or("not one of the words")
    })
}

/// A length from 0.01 to 1000 mm.
fn step(text: &str) -> Result<f64, String> {
    parsed(text, |step| (0.01..=1000.0).contains(step), "a number from 0.01 to 1000")
}

/// A length from 0.0001 to 10 mm.
fn chord(text: &str) -> Result<f64, String> {
    parsed(text, |chord| (1e-4..=10.0).contains(chord), "a number from 0.0001 to 10")
}

fn place(text: &str) -> Result<[f64; 3], String> {
    let number = |text: &str| finite(text.trim()).ok().filter(|value| value.abs() <= 1e4);
    let numbers: Option<Vec<f64>> = text.split(',').map(number).collect();
    let allowed = || "allowed: three numbers up to 10000, as in 0,0,150".to_owned();
    numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(allowed)
}
