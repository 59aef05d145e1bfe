//! The manuals of all commands, and their overview.

#[cfg(test)]
mod tests;

use super::manual::Manual;
use super::{
    assess, check, circularity, compensate, completions, explain, export, forces, identify, import, init, man, page,
    place, pose, robots, schema, score, simulate, stability, study,
};

/// Every command that does something, as it is typed.
const MANUALS: &[(&str, &Manual)] = &[
    ("place", &place::MANUAL),
    ("score", &score::MANUAL),
    ("explain", &explain::MANUAL),
    #[cfg(feature = "live")]
    ("live", &super::live::MANUAL),
    ("page", &page::MANUAL),
    ("study run", &study::run::MANUAL),
    ("study slurm", &study::slurm::MANUAL),
    ("study status", &study::status::MANUAL),
    ("study report", &study::report::MANUAL),
    ("assess", &assess::MANUAL),
    ("forces", &forces::MANUAL),
    ("compensate", &compensate::MANUAL),
    ("export", &export::MANUAL),
    ("identify fit", &identify::MANUAL),
    ("identify plan", &identify::plan::MANUAL),
    ("circularity", &circularity::MANUAL),
    ("simulate", &simulate::MANUAL),
    ("stability", &stability::MANUAL),
    ("check", &check::MANUAL),
    ("pose", &pose::MANUAL),
    ("robots", &robots::MANUAL),
    ("import path", &import::path::MANUAL),
    ("import robot", &import::robot::MANUAL),
    ("init", &init::MANUAL),
    ("schema", &schema::MANUAL),
    ("completions", &completions::MANUAL),
    ("man", &man::MANUAL),
];

/// The commands by the question that they answer, those of no group last.
const GROUPS: [(&str, &[&str]); 8] = [
    ("Where to put the workpiece", &["place", "score", "explain", "live", "page"]),
    ("Which cell layout is best", &["study"]),
    ("How good a robot is for machining, and how stiff its joints are", &["assess", "identify"]),
    ("What the cut does to the tool, and the tool to the part", &["forces", "compensate", "simulate", "stability"]),
    ("What the robot is to run", &["export"]),
    ("How round a measured profile is", &["circularity"]),
    ("What was understood of robots and runs", &["check", "pose", "robots"]),
    ("Input files, shell and manual", &[]),
];

pub(super) const STEAD: &str = "\
Start with: stead place configs/caro-2013.toml
`stead COMMAND --help` shows examples, the files that a command writes and its exit codes.
With --json a command prints one JSON document on standard output. Notes, warnings, progress and errors go to standard error.

Exit codes: 0 done; 1 the job failed or nothing is feasible; 2 wrong usage or bad input; 130 ended early by Ctrl-C.
Ctrl-C ends a job with what it has by then; pressed again it ends the command at once. Where standard error is no terminal, a line
every 30 s says how far a job is.";

/// Puts the manuals into the commands, `above` being the names above this one.
pub(super) fn documented(command: clap::Command, above: &str) -> clap::Command {
    command.mut_subcommands(|below| {
        let name = format!("{above}{}", below.get_name());
        match MANUALS.iter().find(|(known, _)| *known == name) {
            Some((_, manual)) => below.after_long_help(manual.text()),
            None => documented(below, &format!("{name} ")),
        }
    })
}

/// The overview of all commands.
pub(super) fn overview(command: &clap::Command) -> String {
    let line = |command: &clap::Command| {
        let about = command.get_about().map(ToString::to_string).unwrap_or_default();
        format!("  {:<12} {about}\n", command.get_name())
    };
    let is_grouped = |name: &str| GROUPS.iter().any(|(_, names)| names.contains(&name));
    let mut text = String::new();
    for (question, names) in GROUPS {
        let members = command.get_subcommands().filter(|member| {
            let name = member.get_name();
            names.contains(&name) || (names.is_empty() && !is_grouped(name))
        });
        text.push_str(&format!("{question}:\n{}\n", members.map(line).collect::<String>()));
    }
    text
}
