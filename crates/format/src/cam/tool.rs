//! The cutter of a program, as far as it is described there, as tables of a run file.

use super::Program;
use super::refusals::{GUESSES, NOT_THE_SHAPE, ONE_ENGAGEMENT, guessed_keys};
use super::units::rounded;
use crate::written::commented;
use std::collections::BTreeMap;
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
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Use {
    pub tool: ProgramTool,
    /// Length of its cutting moves. m
    pub way: f64,
    /// How much of it goes at each feed (m), by the bits of the feed in m/s.
    feeds: BTreeMap<u64, f64>,
}

impl ProgramTool {
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
        let mut uses: Vec<Use> = Vec::new();
        for (place, (from, tool)) in self.tools_from.iter().enumerate() {
            let to = self.tools_from.get(place + 1).map_or(self.moves.len(), |(to, _)| *to);
            let moves = &self.moves[from.saturating_sub(1)..to];
            for pair in moves.windows(2).filter(|pair| !pair[1].is_rapid) {
                let known = uses.iter().position(|one| one.tool == *tool).unwrap_or_else(|| {
                    uses.push(Use { tool: tool.clone(), ..Use::default() });
                    uses.len() - 1
                });
                let (one, way) = (&mut uses[known], (pair[1].position - pair[0].position).norm());
                one.way += way;
                if let Some(feed) = pair[1].feed {
                    *one.feeds.entry(feed.to_bits()).or_default() += way;
                }
            }
        }
        uses.sort_by(|a, b| b.way.total_cmp(&a.way));
        uses
    }
}

impl Use {
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

/// Whether a row holds or stands as a comment, its text where it has one, and where that is from.
type Row<'a> = (bool, Option<String>, &'a str);

fn lines(rows: Vec<Row<'_>>) -> String {
    let line = |(holds, text, from): Row<'_>| {
        let text = text?;
        Some(commented(&if holds { text } else { format!("# {text}") }, from))
    };
    rows.into_iter().filter_map(line).collect()
}

/// The tables of a run file for the tool with the longest way of those that a program describes.
pub(super) fn text(uses: &[Use], program: &str) -> Option<String> {
    // A run file has a place for these.
    let first = uses.iter().find(|one| one.tool.diameter.or(one.tool.spindle_speed).is_some())?;
    let tool = &first.tool;
    // That of the longest part of its cutting moves.
    let feed = first.feeds.iter().max_by(|a, b| a.1.total_cmp(b.1)).map(|(feed, _)| f64::from_bits(*feed));
    let (is_known, described) = (tool.diameter.is_some(), shorten(&tool.description));
    let number = |key: &str, value: Option<f64>| value.map(|value| format!("{key} = {value:?}"));
    let word = |is_there: bool, text: &str| is_there.then(|| text.to_owned());
    let (flutes, flutes_from) = match (tool.length, tool.diameter) {
        (Some(length), _) if tool.is_length_of_flutes => (Some(length), STATED),
        (Some(length), _) => (Some(length), "of the CAM file, perhaps with its shank"),
        (None, diameter) => (diameter.filter(|_| !tool.is_other_shape).map(|diameter| 3.0 * diameter), ""),
    };
    let is_odd = is_known && flutes.is_none();
    let mut of_tool = vec![
        (is_known, word(true, "[tool]"), if described.is_empty() { STATED } else { &described }),
        (is_known, number("cutter_diameter_mm", tool.diameter.map(mm)), STATED),
        (false, word(!is_known, "cutter_diameter_mm = 10.0"), "the CAM file does not state it"),
        (is_known, word(tool.is_counterclockwise, "rotation = \"counterclockwise\""), "seen from the spindle"),
        (is_known, number("corner_radius_mm", tool.corner_radius.map(mm)), STATED),
        (is_known, number("taper_deg", tool.taper.map(|taper| rounded(taper.to_degrees()))), STATED),
        (is_known, number("flute_length_mm", flutes.map(mm)), flutes_from),
        (false, word(is_odd, "flute_length_mm = 10.0"), NOT_THE_SHAPE),
    ];
    of_tool.extend(GUESSES.map(|(text, from)| (is_known, word(true, text), from)));
    let speed = tool.spindle_speed.map(|speed| rounded(speed * 60.0));
    let speed_from = if speed.is_some() { STATED } else { "" };
    let mut of_cut = vec![(is_known, number("spindle_rpm", speed.or(Some(9000.0))), speed_from)];
    of_cut.extend(ONE_ENGAGEMENT.map(|(text, from)| (false, word(true, text), from)));
    let (mut tooth, mut tooth_from) = (0.05, String::new());
    if let (Some(turns), Some(speed), Some(feed)) = (tool.spindle_speed, speed, feed) {
        let fine = |mm: f64| (mm * 1e4).round() / 1e4;
        let (turn, feed) = (fine(feed / turns * 1e3), rounded(feed * 6e4));
        tooth = fine(turn / 2.0);
        tooth_from = format!("{turn} mm a turn at {feed} mm/min and {speed} rpm, over 2 teeth");
    }
    // A path without feeds has need of it in any case.
    of_cut.push((is_known && feed.is_none(), number("feed_per_tooth_mm", Some(tooth)), &tooth_from));
    let guessed = [
        ("tool.flute_length_mm", tool.length.is_none() && flutes.is_some()),
        ("cut.spindle_rpm", speed.is_none()),
        ("cut.feed_per_tooth_mm", feed.is_none()),
    ];
    let guessed = guessed.into_iter().filter(|(_, is_guess)| *is_guess).map(|(key, _)| key.to_owned());
    let guesses: Vec<String> = guessed_keys().chain(guessed).filter(|_| is_known).collect();
    let mut text = format!(
        "# The cutter of {} as far as it is described there, by `stead import path`. `stead init place` puts\n\
         # what follows into the run file.\n\n{}{}\n{}[cut]\n{}",
        shorten(program),
        if guesses.is_empty() { String::new() } else { format!("guesses = {guesses:?}\n\n") },
        lines(of_tool),
        if is_known { "" } else { "# " },
        lines(of_cut)
    );
    for other in uses.iter().filter(|other| *other != first) {
        let words = other.words();
        let words = if words.is_empty() { "not described" } else { &words };
        text += &format!("# Another tool of the program, with less to cut or less said of it: {words}\n");
    }
    Some(text)
}
