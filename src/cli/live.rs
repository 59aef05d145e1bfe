//! `stead live`: the workpiece moved by hand in the browser.

use super::Failure;
use super::given::GivenRun;
use super::manual::Manual;
use super::output::{out_folder_named, print, say, say_notes, say_warnings};
use super::progress::Terminal;
use super::values::case;
use clap::Args;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Duration;
use stead::live::{LiveOptions, Server, Session};

#[derive(Debug, Args)]
pub(super) struct LiveCommand {
    #[command(flatten)]
    run: GivenRun,
    /// Folder for the placements that are kept [default: results/<name of the run file>-live]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Results of `stead place` from the same run file, to begin at [default: the middle of the cell, or as left in the
    /// folder]
    #[arg(long, value_name = "RESULTS")]
    placement_of: Option<PathBuf>,
    /// Case of these results: 1, the best placement, or 3, the worst [default: 1]
    #[arg(long, value_name = "N", value_parser = case, allow_hyphen_values = true, requires = "placement_of")]
    case: Option<u8>,
    /// Port of 127.0.0.1 [default: any that is free]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    port: u16,
    /// Say the address, and open no browser
    #[arg(long)]
    no_open: bool,
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &[
        "stead live configs/caro-2013.toml",
        "stead live configs/caro-2013.toml --placement-of results/caro-2013",
        "stead live my/run.toml --no-open --port 8017",
    ],
    files: "\
placement-1/, placement-2/, ..: the placements that are kept, each as `stead score --out` writes it
live.json: where the part stood last and which values were changed, for the next session in the folder
certificate-1.json, ..: bounds and gaps of placements that were certified, with placement and changed values
programs/placement-1/, ..: robot programs of placements that are kept",
    remarks: "The server answers on 127.0.0.1 alone, and only the page that is opened with the address printed. Nothing \
              leaves the machine. Ctrl-C ends it; a job that runs then ends with what it has, which is kept.",
    done: "done: ended by Ctrl-C",
    failed: "another session writes to the folder, or a file could not be written",
    refused: "wrong usage, bad input, a port that is taken, or a folder that cannot be written to",
    ..Manual::NEW
};

/// Between two looks whether Ctrl-C was pressed.
const BETWEEN_LOOKS: Duration = Duration::from_millis(100);

pub(super) fn run(options: &LiveCommand) -> Result<(), Failure> {
    let terminal = Terminal::start(None);
    let run = options.run.read(&terminal, None)?;
    let out = out_folder_named(options.out.as_deref(), &options.run.config, "-live", &Manual::NEW)?;
    terminal.holds(&out.folder);
    let requested = LiveOptions {
        file: options.run.config.clone(),
        values: options.run.values().to_vec(),
        placement_of: options.placement_of.clone().map(|results| (results, options.case.unwrap_or(1))),
    };
    let session = terminal.during(|monitor| Session::new(run, requested, out.folder, monitor))?;
    let run = session.run();
    say_notes(run.notes());
    say_notes(session.notes());
    say_warnings(run.warnings());
    let folder = session.folder().display().to_string();
    let server = Server::start(session, options.port).map_err(|error| Failure::Usage(error.to_string()))?;
    let address = server.address();
    print(format!("{address}\nplacements are kept in {folder}; Ctrl-C ends the session\n").as_bytes())?;
    if !options.no_open && !open(&address) {
        say("note: no browser could be opened: open the address above");
    }
    terminal.during(|monitor| {
        while !monitor.should_stop() {
            std::thread::sleep(BETWEEN_LOOKS);
        }
    });
    server.close();
    Ok(())
}

/// Opens an address in the browser; whether that could be tried.
fn open(address: &str) -> bool {
    let (program, arguments): (&str, &[&str]) = match std::env::consts::OS {
        "macos" => ("open", &[]),
        "windows" => ("rundll32", &["url.dll,FileProtocolHandler"]),
        _ => ("xdg-open", &[]),
    };
    let mut command = Command::new(program);
    command.args(arguments).arg(address).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().is_ok()
}
