//! Everything that is tested from outside: the command line, and independent oracles.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "a test may panic, in its helpers too")]
#![cfg_attr(not(unix), allow(unused_imports, dead_code, reason = "what tests of links, pipes and signals use"))]
#![allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")]

mod assess;
mod axes_2_3;
mod bad_input;
mod by_origin;
mod calm;
mod cam_files;
mod cell_setup;
mod certify;
mod circularity;
mod collision;
mod common;
mod compensate;
mod criterion;
mod discretisation;
mod documents;
mod drawn_moves;
mod drive;
mod export;
mod facade;
mod feed;
#[cfg(unix)]
mod files;
mod forces_from_path;
mod forces_in_runs;
mod from_code;
mod help;
mod identify;
mod identify_plan;
mod import_path;
mod import_robot;
mod lean;
#[cfg(feature = "live")]
mod live;
mod looks_wrong;
mod opw_oracle;
mod page;
mod pairwise;
mod place;
mod results_folder;
mod robots;
mod score_explain;
mod setup_sheet;
mod simulate;
mod stability;
mod standard_output;
mod starting;
mod stock_in_run;
mod stop;
mod study;
#[cfg(unix)]
mod study_killed;
mod study_report;
mod uncertainty;
mod whole_arm;
mod your_cell;
