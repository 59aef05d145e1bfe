//! What all writers need: the moves in their parts, the frames, and the texts around them.

use super::carrier::Carrier;
use super::motion::{Frames, Heading, Move, MoveKind};
use super::{ExportOptions, names};
use std::fmt::Write;
use std::ops::Range;
use stead_problem::problem::Problem;

/// One file of a program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProgramFile {
    /// Its name, without a folder.
    pub name: String,
    /// What is in it.
    pub text: String,
}

/// A program about to be written.
#[derive(Debug)]
pub(super) struct Layout<'a> {
    pub problem: &'a Problem,
    pub options: &'a ExportOptions<'a>,
    /// What the program is and what it was made of, as texts for comments.
    pub origin: Vec<String>,
    pub moves: &'a [Move],
    pub parts: Vec<Range<usize>>,
    pub frames: Frames,
    /// What moves the base, where anything does.
    pub carrier: Option<Carrier<'a>>,
    /// Statements of the user's own.
    pub spindle_on: Option<String>,
    pub spindle_off: Option<String>,
}

impl Layout<'_> {
    /// Share of the full joint speed in joint moves: slow, for they lead through a cell that has not been tried.
    pub const JOINT_SPEED_PERCENT: u8 = 20;

    /// The name of a part, counted from 0.
    pub fn part_name(&self, index: usize) -> String {
        format!("{}{}", self.options.name, names::part(index + 1))
    }

    /// What the program is and what it was made of, as lines of comments behind a mark.
    pub fn origin_behind(&self, mark: &str) -> Option<String> {
        Some(self.origin.iter().map(|text| format!("{mark}{text}")).collect::<Vec<_>>().join("\n"))
    }

    /// The statements that call the parts.
    pub fn calls(&self, call: impl Fn(String) -> String) -> Option<String> {
        Some((0..self.parts.len()).map(|index| call(self.part_name(index))).collect::<Vec<_>>().join("\n"))
    }

    /// The moves of a part.
    pub fn moves_of(&self, index: usize) -> &[Move] {
        &self.moves[self.parts[index].clone()]
    }

    /// What the comments before a move of a part say, where a segment begins or goes on, or the move hits.
    pub fn heading(&self, index: usize, number: usize) -> Vec<String> {
        let step = &self.moves_of(index)[number];
        let segment = step.segment;
        let mut lines = match (&step.heading, step.kind) {
            (Some(Heading::FreeWay(short_lines)), _) => {
                let short = short_lines.iter().map(|line| names::comment(line, LONGEST_LINE));
                std::iter::once(format!("segment {segment}, by a free way")).chain(short).collect()
            }
            (Some(Heading::Segment), _) | (Some(Heading::Hits(_)), MoveKind::Joint) => {
                vec![format!("segment {segment}")]
            }
            _ if number == 0 => vec![format!("segment {segment} goes on")],
            _ => Vec::new(),
        };
        match &step.heading {
            Some(Heading::Hits(hit)) => {
                lines.push("NOT FREE: this move hits".to_owned());
                lines.extend(hit.iter().map(|name| format!("- {}", names::comment(name, LONGEST_NAME))));
            }
            Some(Heading::Unfollowed(why)) => {
                lines.push("NOT FREE: the arm cannot follow this move".to_owned());
                lines.push(format!("- {}", names::comment(why, LONGEST_LINE)));
            }
            _ => {}
        }
        lines
    }
}

/// The longest line of a comment on a short line.
const LONGEST_LINE: usize = 120;
/// The longest name of a shape in a comment.
const LONGEST_NAME: usize = 60;

/// Lines of a text; writing to it cannot fail.
#[derive(Debug, Default)]
pub(super) struct Lines(pub String);

impl Lines {
    /// Adds a line.
    pub fn line(&mut self, line: impl std::fmt::Display) {
        let _ = writeln!(self.0, "{line}");
    }
}
