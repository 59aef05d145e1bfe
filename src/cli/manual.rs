//! What a command says of itself: examples, files written and exit codes. Each command declares it beside its options;
//! long help, manual pages and the tables of the guide are made of it. Here is how it is laid out, and the overview of
//! all commands.

#[cfg(test)]
mod tests;

use super::{
    assess, check, circularity, compensate, completions, explain, export, forces, identify, import, init, man, page,
    place, pose, robots, schema, score, simulate, stability, study,
};

/// What long help and guide say of a command beyond its options.
pub(super) struct Manual {
    /// Command lines to copy.
    pub examples: &'static [&'static str],
    /// Where the files go, or why there are none: what follows "Files written".
    pub written: &'static str,
    /// Names of files, as `wall.csv, map-{best,worst}.{csv,svg}`, and what they hold.
    pub files: &'static [(&'static str, &'static str)],
    /// What else one has to know.
    pub remarks: &'static str,
    /// When it ends with exit code 0.
    pub done: &'static str,
    /// When it ends with exit code 1, if ever.
    pub failed: &'static str,
    /// When it ends with exit code 2.
    pub refused: &'static str,
    /// When it ends with exit code 130, if ever.
    pub interrupted: &'static str,
}

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

/// Columns of a terminal.
const WIDTH: usize = 120;

/// Of a command that has nothing to write before it is done.
pub(super) const STOPPED: &str = "Ctrl-C ended it early: nothing is written";

impl Manual {
    /// What most commands say.
    pub const NEW: Self = Self {
        examples: &[],
        written: "to the results folder",
        files: &[],
        remarks: "",
        done: "done",
        failed: "",
        refused: "wrong usage or bad input",
        interrupted: "",
    };

    /// The names of the files that it writes, those alone that are known before it has run.
    pub fn file_names(&self) -> Vec<String> {
        let names = self.files.iter().flat_map(|(names, _)| names.split(", "));
        names.flat_map(expanded).filter(|name| name.contains('.') && !name.contains(['/', '<'])).collect()
    }

    /// The end of the long help.
    fn text(&self) -> String {
        let heading = if self.examples.len() == 1 { "Example:" } else { "Examples:" };
        let mut text = self.examples.iter().fold(heading.to_owned(), |text, line| text + "\n  " + line);
        text += "\n\nFiles written";
        if self.files.is_empty() {
            text += &format!(": {}.", self.written);
        } else {
            let widths = self.files.iter().map(|(names, _)| names.len());
            let width = widths.max().unwrap_or(0).min(38);
            text += &format!(" {}:", self.written);
            for (names, content) in self.files {
                // Names that leave no room stand on a line of their own.
                let gap = if names.len() > width {
                    "\n".to_owned() + &" ".repeat(width + 4)
                } else {
                    " ".repeat(width + 2 - names.len())
                };
                text += &format!("\n  {names}{gap}{}", wrapped(content, width + 4));
            }
        }
        if !self.remarks.is_empty() {
            text += &format!("\n\n{}", wrapped(self.remarks, 0));
        }
        let codes = [(0, self.done), (1, self.failed), (2, self.refused), (130, self.interrupted)];
        let codes = codes.iter().filter(|(_, meaning)| !meaning.is_empty());
        let codes = codes.map(|(code, meaning)| format!("\n{code:>3}  {}", wrapped(meaning, 5)));
        text + "\n\nExit codes:" + &codes.collect::<String>()
    }
}

/// Words in lines, those after the first indented.
fn wrapped(words: &str, indent: usize) -> String {
    let (mut text, mut column) = (String::new(), indent);
    for word in words.split(' ') {
        let length = word.chars().count();
        if column > indent && column + 1 + length > WIDTH {
            text += &format!("\n{}", " ".repeat(indent));
            column = indent;
        } else if column > indent {
            text.push(' ');
            column += 1;
        }
        text += word;
        column += length;
    }
    text
}

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

/// The names that one with alternatives in braces stands for.
fn expanded(name: &str) -> Vec<String> {
    let Some((before, (among, behind))) =
        name.split_once('{').and_then(|(before, rest)| Some((before, rest.split_once('}')?)))
    else {
        return vec![name.to_owned()];
    };
    among.split(',').flat_map(|one| expanded(&format!("{before}{one}{behind}"))).collect()
}
