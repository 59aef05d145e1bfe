//! `stead study report`: what a study says.

use super::read::{folder, read};
use crate::cli::Failure;
use crate::cli::manual::Manual;
use crate::cli::output::{files_written, print, print_json, results_in};
use crate::cli::progress::Terminal;
use crate::cli::values::{input_file, noise};
use clap::Args;
use std::path::PathBuf;
use stead::study::StudyQuestion;
use stead_report::output::Folder;

#[derive(Debug, Args)]
pub(in crate::cli) struct StudyReportOptions {
    /// Study file (TOML)
    #[arg(value_parser = input_file())]
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

/// What the help and the guide say of it.
pub(in crate::cli) const MANUAL: Manual = Manual {
    examples: &[
        "stead study report configs/study-example.toml",
        "stead study report configs/study-example.toml --by max_feed_mm_per_s:max",
        "stead study report configs/study-example.toml --front best_mean_total_mm,cycle_s,min_joint_margin_deg",
    ],
    written: "to the folder of the study",
    files: "\
study-ranking.csv: every layout with its rank by --by; ties share one
study-front.{csv,svg}: the compromises: layouts that no other is better than in every column of --front
study-effects.{csv,svg}: what each axis does to the column of the ranking: mean for each value, share of the variance
study-map.svg: with two axes, or one and several tasks: that column over both, the mean over all others
study-report.json: what --json prints
report.html: a page with all of it, which leads to the pages of kept cases",
    failed: "a file could not be written",
    refused: "wrong usage, bad input, or a study that is not done",
    ..Manual::NEW
};

pub(super) fn run(options: &StudyReportOptions) -> Result<(), Failure> {
    let map = options.map.as_ref().map(|names| {
        <[String; 2]>::try_from(names.clone()).map_err(|_| {
            Failure::Usage(format!("--map {}: is no pair of axes; allowed: two axes of the study", names.join(",")))
        })
    });
    let question = StudyQuestion {
        by: options.by.clone(),
        front: options.front.clone(),
        map: map.transpose()?,
        noise: options.noise_percent,
    };
    let study = read(&options.config, None, &Terminal::start(None))?;
    let folder = folder(options.out.as_deref(), &options.config);
    let report = study.report(&folder, &question)?;
    // The last shards may have ended at the same time or elsewhere, or the study may have been edited since.
    study.merge(&folder)?;
    let out = Folder::create(&folder)?;
    files_written(report.write_in(&out))?;
    if options.json {
        return print_json(&report);
    }
    print(format!("{report}{}", results_in(folder.display().to_string())).as_bytes())
}
