//! An imported tool path: its points as a task file, and what was found and changed.

use super::refusals::*;
use super::segments::{Counts, Point, Resampling, Segments, angle, expected_points, segments};
use super::tool::{self, ProgramTool, Use};
use super::units::rounded;
use super::{CamFormat, Found, Move, Program};
use crate::task::parse_csv;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::fmt::{self, Write};
use std::path::{Path, PathBuf};
use stead_disk::files::new::{Existing, write_all_new};
use stead_disk::input::{InputError, InputFile};
use stead_disk::quote::shorten;
use stead_model::plausibility;
use stead_model::task::ToolPath;

/// The points of a program, ready to be written as a task file.
#[derive(Debug, Clone, PartialEq)]
pub struct ImportedPath {
    format: CamFormat,
    cuts: Segments,
    resampling: Resampling,
    has_feeds: bool,
    tools: Vec<String>,
    /// Tables of a run file for its cutter, where it is described.
    cutter: Option<String>,
    /// What the program says of its tool: of several that with the longest way.
    pub tool: Option<ProgramTool>,
    /// What was found and changed.
    pub notes: Vec<String>,
    /// The program that it was made from.
    pub(super) inputs: Vec<InputFile>,
}

/// More points than this are a step that is meant for another unit.
const LARGEST_COUNT: f64 = 2e7;

/// Tools that a note names at the most.
const NAMED_TOOLS: usize = 8;
/// Feeds of cutting moves. m/s
const FEEDS: std::ops::RangeInclusive<f64> = 1e-7..=1e2;

impl ImportedPath {
    /// Resamples a program.
    ///
    /// # Errors
    /// [`InputError`] where it has no cutting move that can be scored, or feeds for some cutting moves alone.
    pub(super) fn new(file: &Path, program: Program, resampling: Resampling) -> Result<Self, InputError> {
        let cutting = || program.moves.iter().filter(|one| !one.is_rapid);
        let has_feeds = cutting().any(|one| one.feed.is_some());
        let fail = |(problem, allowed): (String, &str)| InputError::new(file, problem).allowed(allowed);
        let fail_at = |one: &Move, (problem, allowed): Refusal| fail((problem.to_owned(), allowed)).at_line(one.line);
        if let Some(without) = cutting().find(|one| has_feeds && one.feed.is_none()) {
            return Err(fail_at(without, FEED_TOO_LATE));
        }
        for one in cutting() {
            let unusual = one.feed.filter(|feed| !FEEDS.contains(feed)).map(|feed| format!("{:e} mm/s", feed * 1e3));
            ensure!(unusual.is_none(), fail_at(one, UNUSUAL_FEED).found_if(unusual));
        }
        let expected = expected_points(&program, resampling);
        ensure!(expected <= LARGEST_COUNT, fail(too_many(expected)));
        let cuts = segments(&program, resampling);
        let points = || cuts.segments.iter().flatten();
        ensure!(points().any(|point| point.is_scored), fail(none_scored(cuts.counts.cutting)));
        let Counts { doubled, left_out, added, plunging, turning, .. } = cuts.counts;
        let counted = [doubled, left_out, added, plunging, turning].into_iter().zip(COUNTED);
        let counted = counted.filter(|(count, _)| *count > 0).map(|(count, text)| format!("{count} {text}"));
        let mut notes: Vec<String> = counted.collect();
        notes.extend(listed(&program.notes));
        if !program.holes_left_out.is_empty() {
            let place = |(place, line): &(Vector3<f64>, usize)| {
                let [x, y, z] = [place.x, place.y, place.z].map(|value| rounded(value * 1e3));
                format!("{x}, {y}, {z} mm (line {line})")
            };
            let places: Vec<String> = program.holes_left_out.iter().map(place).collect();
            notes.push(format!("{} holes left out (--skip-cycles): {}", places.len(), places.join("; ")));
        }
        if !program.passed_over.is_empty() {
            notes.push(format!("words passed over: {}", listed(&program.passed_over).join(", ")));
        }
        notes.extend(plausibility::tool_axes(points().map(|point| &point.axis), "in the frame of the part"));
        notes.extend(plausibility::feed(points().filter_map(|point| point.feed).fold(0.0, f64::max)));
        if !has_feeds {
            notes.push("no feed in the program: no column feed_mm_per_s".to_owned());
        }
        let uses = program.uses();
        let cutter = tool::text(&uses, &file.file_name().unwrap_or_default().to_string_lossy());
        notes.extend(uses.iter().filter(|one| one.tool.is_other_shape).map(|one| {
            let description = shorten(&one.tool.description);
            format!("{description}: its shape is not that of a run file, of which the diameter alone is taken")
        }));
        let tool = uses.first().map(|one| one.tool.clone());
        if cutter.is_some() && uses.len() > 1 {
            let words: Vec<String> = uses.iter().take(NAMED_TOOLS).map(Use::words).collect();
            notes.push(format!(
                "{} tools cut, and a run has one: of those that are described, that with the longest way is taken; {}",
                uses.len(),
                words.join("; ")
            ));
        }
        let (tools, format) = (program.tools, program.format);
        Ok(Self { format, cuts, resampling, has_feeds, tools, cutter, tool, notes, inputs: Vec::new() })
    }

    /// The task file, checked as it will be read; `file` is its name in messages.
    ///
    /// # Errors
    /// [`InputError`] where a task breaks a rule that the import has not seen to.
    pub fn csv(&self, file: &Path) -> Result<String, InputError> {
        let mut text = String::from("segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z");
        text.push_str(if self.has_feeds { ",feed_mm_per_s,scored\n" } else { ",scored\n" });
        for (number, segment) in self.cuts.segments.iter().enumerate() {
            for point in segment {
                // Writing to a string cannot fail.
                let _ = write!(text, "{}", number + 1);
                for (vector, factor, digits) in
                    [(&point.position, 1e3, 6), (&point.direction, 1.0, 9), (&point.axis, 1.0, 9)]
                {
                    vector.iter().for_each(|value| push_number(&mut text, value * factor, digits));
                }
                if let Some(feed) = point.feed {
                    push_number(&mut text, feed * 1e3, 6);
                }
                text.push_str(if point.is_scored { ",1\n" } else { ",0\n" });
            }
        }
        parse_csv(file, text.as_bytes())?;
        Ok(text)
    }

    /// The files of the path with their texts: the task file, and beside it, where the program describes its cutter,
    /// tables of a run file for that, `NAME-tool.toml`.
    ///
    /// # Errors
    /// Those of [`ImportedPath::csv`].
    pub fn files(&self, out: &Path) -> Result<Vec<(PathBuf, String)>, InputError> {
        let task = (out.to_owned(), self.csv(out)?);
        let cutter = self.cutter.as_ref().map(|text| (tool::file_beside(out), text.clone()));
        Ok(std::iter::once(task).chain(cutter).collect())
    }

    /// Writes these files, and returns their paths; their folder is made where there is none.
    ///
    /// # Errors
    /// Those of [`ImportedPath::csv`], and [`InputError`] for a file that is there already and to be kept, or that
    /// cannot be written: nothing is left behind then.
    pub fn write(&self, out: &Path, existing: Existing) -> Result<Vec<PathBuf>, InputError> {
        let files = self.files(out)?;
        let texts: Vec<(PathBuf, &str)> = files.iter().map(|(file, text)| (file.clone(), text.as_str())).collect();
        write_all_new(&texts, existing, &self.inputs)?;
        Ok(files.into_iter().map(|(file, _)| file).collect())
    }

    /// The path with its lines in the task file that it would be; `file` is its name in messages.
    ///
    /// # Errors
    /// Those of [`ImportedPath::csv`].
    pub fn path(&self, file: &Path) -> Result<ToolPath, InputError> {
        Ok(parse_csv(file, self.csv(file)?.as_bytes())?.path)
    }

    /// The rapid moves before each segment and after the last: the places in the air between the end of one and the
    /// start of the next.
    pub fn rapids(&self) -> &[Vec<Move>] {
        &self.cuts.rapids
    }

    /// Number of segments.
    pub fn segment_count(&self) -> usize {
        self.cuts.segments.len()
    }

    /// Number of points, and of those that are scored.
    pub fn point_counts(&self) -> [usize; 2] {
        let points = || self.cuts.segments.iter().flatten();
        [points().count(), points().filter(|point| point.is_scored).count()]
    }
}

/// What was found, each with how often and where.
fn listed(all: &BTreeMap<String, Found>) -> Vec<String> {
    all.iter().map(|(text, found)| format!("{text}{}", found.words())).collect()
}

/// Adds a number behind a comma, without zeros that say nothing.
fn push_number(text: &mut String, value: f64, digits: usize) {
    text.push(',');
    let start = text.len();
    // Writing to a string cannot fail.
    let _ = write!(text, "{value:.digits$}");
    let end = text.trim_end_matches('0').trim_end_matches('.').len();
    text.truncate(end);
    if &text[start..] == "-0" {
        text.replace_range(start.., "0");
    }
}

impl fmt::Display for ImportedPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [points, scored] = self.point_counts();
        let Segments { segments, counts: Counts { cutting, rapid, .. }, .. } = &self.cuts;
        let range = |of: &dyn Fn(&Point) -> Option<f64>, unit: &str| {
            let values = segments.iter().flatten().filter_map(of).map(|value| [value; 2]);
            match values.reduce(|[low, high], [value, _]| [low.min(value), high.max(value)]) {
                Some([low, high]) if high - low < 5e-4 => format!("{low:.3} {unit}"),
                Some([low, high]) => format!("{low:.3} to {high:.3} {unit}"),
                None => "none".to_owned(),
            }
        };
        let along = |axis: usize| range(&|point| Some(point.position[axis] * 1e3), "mm");
        let tilt = |point: &Point| Some(angle(&point.axis, &Vector3::z()).to_degrees());
        let steps = segments.iter().flat_map(|segment| segment.windows(2));
        let length: f64 = steps.map(|pair| (pair[1].position - pair[0].position).norm()).sum();
        let [chord, step] = [self.resampling.chord, self.resampling.step].map(|length| rounded(length * 1e3));
        for (name, text) in [
            ("format", self.format.word().to_owned()),
            ("read", format!("{cutting} cutting and {rapid} rapid moves")),
            ("segments", segments.len().to_string()),
            ("points", format!("{points}, of which {scored} are scored")),
            ("length", format!("{:.3} mm", length * 1e3)),
            ("x", along(0)),
            ("y", along(1)),
            ("z", along(2)),
            ("tilt", range(&tilt, "deg from the z axis of the workpiece")),
            ("feed", range(&|point| point.feed.map(|feed| feed * 1e3), "mm/s")),
            ("chord", format!("{chord} mm, step {step} mm")),
            ("tools", self.tools.join("; ")),
        ] {
            if !text.is_empty() {
                writeln!(f, "{name:<9} {text}")?;
            }
        }
        self.notes.iter().try_for_each(|note| writeln!(f, "- {note}"))
    }
}
