//! Drilling cycles of CLDATA: a plunge along the tool axis at each of the points that follow.

use super::dialect::{CYCLES, HoleDepth, OF_CYCLES, OfCycle};
use super::statement::Statement;

/// What a cycle does at each point, in the unit of the file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cycle {
    /// How far above the point the plunge begins, along the tool axis.
    pub clear: f64,
    /// How far below the point it ends.
    pub depth: f64,
    /// How far above the point the tool is drawn back to.
    pub retract: f64,
    /// Feed of the plunge with the word of its unit; that of the moves before where left out.
    pub feed: Option<(f64, String)>,
}

impl Cycle {
    /// A cycle of a form that is known; nothing of any other.
    pub fn of(statement: &Statement<'_>, hole_depth: HoleDepth) -> Option<Self> {
        let (mut depth, mut clear, mut rapid_to, mut retract, mut feed) = (None, None, None, None, None);
        let kind = statement.words().next()?;
        CYCLES.iter().find(|known| known.eq_ignore_ascii_case(kind))?;
        let (mut last, mut of) = ("", Some(OfCycle::Depth));
        for minor in &statement.minors[1..] {
            let Some(value) = minor.number else {
                let is_named = |words: &[&str]| words.iter().any(|word| word.eq_ignore_ascii_case(minor.text));
                of = Some(OF_CYCLES.iter().find(|(_, words)| is_named(words))?.0);
                last = minor.text;
                continue;
            };
            match of.take()? {
                OfCycle::Depth => depth = Some(value),
                OfCycle::To if hole_depth == HoleDepth::Coordinate => depth = Some(-value),
                OfCycle::To if hole_depth == HoleDepth::Depth => depth = Some(value),
                OfCycle::To => depth = Some(value.abs()),
                OfCycle::Clear => clear = Some(value),
                OfCycle::RapidTo => rapid_to = Some(value),
                OfCycle::Retract => retract = Some(value),
                OfCycle::Feed => (feed, of) = (Some((value, last.to_owned())), Some(OfCycle::Clear)),
                OfCycle::Other => {}
            }
        }
        let depth = depth.filter(|depth| *depth > 0.0)?;
        let clear = rapid_to.or(clear).filter(|clear| *clear > 0.0)?;
        Some(Self { clear, depth, retract: retract.unwrap_or(clear).max(clear), feed })
    }
}
