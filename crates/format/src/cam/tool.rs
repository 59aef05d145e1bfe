//! The cutter of a program, as far as it is described there, as tables of a run file.

use super::{Program, rounded};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use stead_disk::quote::shorten;

/// A tool and how it turns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ProgramTool {
    /// How the program describes it.
    pub description: String,
    /// Its number, where it is called by one.
    pub number: Option<u32>,
    /// Diameter. m
    pub diameter: Option<f64>,
    /// Radius of its corner, where it has a round one. m
    pub corner_radius: Option<f64>,
    /// Length. m
    pub length: Option<f64>,
    /// Whether that is stated as the length of its flutes, without the shank.
    pub is_length_of_flutes: bool,
    /// Angle between the side and the axis, where it is tapered. rad
    pub taper: Option<f64>,
    /// Whether its shape is another than a run file has: with a neck, a barrel, a corner beside the flank.
    pub is_other_shape: bool,
    /// Speed of the spindle. rev/s
    pub spindle_speed: Option<f64>,
    /// Whether it turns counterclockwise, seen from the spindle.
    pub is_counterclockwise: bool,
}

/// The file with the cutter of a task file, `NAME-tool.toml` beside it.
pub fn file_beside(task: &Path) -> PathBuf {
    task.with_file_name(format!("{}-tool.toml", task.file_stem().unwrap_or_default().to_string_lossy()))
}

/// What a tool cuts.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Use {
    pub tool: ProgramTool,
    /// Length of its cutting moves. m
    pub way: f64,
    /// The feed of the longest part of them. m/s
    pub feed: Option<f64>,
}

impl ProgramTool {
    /// This tool with lengths in a unit (m) in metres.
    pub(super) fn scaled(&self, metres: f64) -> Self {
        let [diameter, corner_radius, length] =
            [self.diameter, self.corner_radius, self.length].map(|length| length.map(|length| length * metres));
        Self { diameter, corner_radius, length, ..self.clone() }
    }

    /// This tool in the spindle of another.
    pub(super) fn turning_as(self, other: &Self) -> Self {
        let Self { spindle_speed, is_counterclockwise, .. } = *other;
        Self { spindle_speed, is_counterclockwise, ..self }
    }
}

impl Program {
    /// Changes the tool of the moves from here on.
    pub(super) fn change_tool(&mut self, change: impl FnOnce(&mut ProgramTool)) {
        let mut tool = self.tools_from.last().map(|(_, tool)| tool.clone()).unwrap_or_default();
        change(&mut tool);
        self.tools_from.push((self.moves.len(), tool));
    }

    /// The tools that cut, that with the longest way first.
    pub(super) fn uses(&self) -> Vec<Use> {
        let mut uses: Vec<(Use, BTreeMap<u64, f64>)> = Vec::new();
        for (place, (from, tool)) in self.tools_from.iter().enumerate() {
            let to = self.tools_from.get(place + 1).map_or(self.moves.len(), |(to, _)| *to);
            let moves = &self.moves[from.saturating_sub(1)..to];
            let cuts = || moves.windows(2).filter(|pair| !pair[1].is_rapid);
            if cuts().next().is_none() {
                continue;
            }
            let known = uses.iter().position(|(one, _)| one.tool == *tool);
            let known = known.unwrap_or_else(|| {
                uses.push((Use { tool: tool.clone(), way: 0.0, feed: None }, BTreeMap::new()));
                uses.len() - 1
            });
            let (one, feeds) = &mut uses[known];
            for pair in cuts() {
                let way = (pair[1].position - pair[0].position).norm();
                one.way += way;
                if let Some(feed) = pair[1].feed {
                    *feeds.entry(feed.to_bits()).or_default() += way;
                }
            }
        }
        for (one, feeds) in &mut uses {
            let longest = feeds.iter().max_by(|a, b| a.1.total_cmp(b.1));
            one.feed = longest.map(|(feed, _)| f64::from_bits(*feed));
        }
        let mut uses: Vec<Use> = uses.into_iter().map(|(one, _)| one).collect();
        uses.sort_by(|a, b| b.way.total_cmp(&a.way));
        uses
    }
}

impl Use {
    /// Whether the program says anything of it that a run file has a place for.
    pub fn is_described(&self) -> bool {
        self.tool.diameter.is_some() || self.tool.spindle_speed.is_some()
    }

    /// The tool in few words: `D 20 mm, corner 3 mm, 12000 rpm`.
    pub fn words(&self) -> String {
        let tool = &self.tool;
        let length = |name: &str, value: Option<f64>| value.map(|value| format!("{name} {} mm", mm(value)));
        let words = [
            Some(shorten(&tool.description)).filter(|text| !text.is_empty()),
            length("D", tool.diameter),
            length("corner radius", tool.corner_radius),
            tool.spindle_speed.map(|speed| format!("{} rpm", rounded(speed * 60.0))),
        ];
        words.into_iter().flatten().collect::<Vec<_>>().join(", ")
    }
}

fn mm(metres: f64) -> f64 {
    rounded(metres * 1e3)
}

/// Where a figure is from.
const STATED: &str = "of the CAM file";

/// Lines with a comment in one column.
struct Lines(String);

impl Lines {
    fn row(&mut self, key: &str, comment: &str) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "{key:<38} # {comment}");
    }
}

/// The tables of a run file for the tool with the longest way of those that a program describes.
pub(super) fn text(uses: &[Use], program: &str) -> Option<String> {
    let first = uses.iter().find(|one| one.is_described())?;
    let tool = &first.tool;
    let mut lines = Lines(format!(
        "# The cutter of {} as far as it is described there, by `stead import path`. `stead init place` puts\n\
         # what follows into the run file.\n\n",
        shorten(program)
    ));
    let described = shorten(&tool.description);
    let is_known = tool.diameter.is_some();
    let key = |text: String| if is_known { text } else { format!("# {text}") };
    lines.row(&key("[tool]".to_owned()), if described.is_empty() { STATED } else { &described });
    match tool.diameter {
        Some(diameter) => lines.row(&format!("cutter_diameter_mm = {:?}", mm(diameter)), STATED),
        None => lines.row("# cutter_diameter_mm = 10.0", "guess: the CAM file does not state it"),
    }
    let flutes = match (tool.length, tool.diameter) {
        (Some(length), _) if tool.is_length_of_flutes => Some((mm(length), STATED)),
        (Some(length), _) => Some((mm(length), "of the CAM file, perhaps with its shank")),
        (None, diameter) => diameter.filter(|_| !tool.is_other_shape).map(|diameter| (mm(3.0 * diameter), "guess")),
    };
    for (name, value) in [
        ("rotation", tool.is_counterclockwise.then(|| ("\"counterclockwise\"".to_owned(), "seen from the spindle"))),
        ("corner_radius_mm", tool.corner_radius.map(|corner| (format!("{:?}", mm(corner)), STATED))),
        ("taper_deg", tool.taper.map(|taper| (format!("{:?}", rounded(taper.to_degrees())), STATED))),
        ("flute_length_mm", flutes.map(|(length, comment)| (format!("{length:?}"), comment))),
    ] {
        if let Some((value, comment)) = value {
            lines.row(&key(format!("{name} = {value}")), comment);
        }
    }
    if flutes.is_none() && is_known {
        lines.row("# flute_length_mm = 10.0", "to be stated: the shape of this cutter is not that of a run file");
    }
    for (row, comment) in [
        ("teeth = 2", "guess"),
        ("helix_deg = 30.0", "guess"),
        ("kt_mpa = 800.0", "guess: cutting coefficients of an aluminium alloy; or `material` beside [stock]"),
        ("kr = 0.4", "guess"),
        ("kte_n_per_mm = 20.0", "guess: edge forces"),
        ("kre_n_per_mm = 20.0", "guess"),
    ] {
        lines.row(&key(row.to_owned()), comment);
    }
    lines.0.push_str(if is_known { "\n[cut]\n" } else { "\n# [cut]\n" });
    let (speed, comment) = match tool.spindle_speed {
        Some(speed) => (rounded(speed * 60.0), STATED),
        None => (9000.0, "guess"),
    };
    lines.row(&key(format!("spindle_rpm = {speed:?}")), comment);
    lines.row("# milling = \"climb\"", "guess; in place of [stock], one engagement for the whole path: these keys");
    lines.row("# radial_depth_mm = 2.0", "guess");
    lines.row("# axial_depth_mm = 2.0", "guess");
    let feed_per_tooth = match (tool.spindle_speed, first.feed) {
        (Some(speed), Some(feed)) => {
            let fine = |mm: f64| (mm * 1e4).round() / 1e4;
            let (turn, speed, feed) = (fine(feed / speed * 1e3), rounded(speed * 60.0), rounded(feed * 6e4));
            let comment = format!("{turn} mm a turn at {feed} mm/min and {speed} rpm, over 2 teeth");
            (fine(turn / 2.0), comment)
        }
        _ => (0.05, "guess".to_owned()),
    };
    // A path without feeds has need of it in any case.
    let is_needed = is_known && first.feed.is_none();
    let row = format!("feed_per_tooth_mm = {:?}", feed_per_tooth.0);
    lines.row(&if is_needed { row } else { format!("# {row}") }, &feed_per_tooth.1);
    for other in uses.iter().filter(|other| *other != first) {
        let words = other.words();
        let words = if words.is_empty() { "not described".to_owned() } else { words };
        let _ = writeln!(lines.0, "# Another tool of the program, with less to cut or less said of it: {words}");
    }
    Some(lines.0)
}
