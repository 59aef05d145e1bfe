//! Drilling cycles of CLDATA: a plunge along the tool axis at each of the points that follow.

use super::dialect::HoleDepth;
use super::statement::{Minor, Statement};

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

/// Cycles that plunge along the tool axis and come back the same way.
const KINDS: [&str; 7] = ["DRILL", "DEEP", "DEEP2", "BRKCHP", "TAP", "BORE", "REAM"];
/// Words with a number of what is left out: pecks.
const PECKS: [&str; 4] = ["STEP", "INCR", "1STPECK", "SUBPECK"];
/// Units of feed.
const FEEDS: [&str; 6] = ["MMPM", "IPM", "PERMIN", "MMPR", "IPR", "PERREV"];

/// The forms that are taken, for messages.
pub(super) const FORMS: &str = "CYCLE/DRILL, DEEP, BRKCHP, TAP, BORE or REAM with DEPTH,d or FEDTO (-d of NX, d of SolidWorks and CAMplete; or as \
                                d,unit,feed,clearance) and RAPTO,c or CLEAR,c; or --skip-cycles, which leaves all holes out and lists them";

impl Cycle {
    /// A cycle of one of these forms; nothing of any other.
    pub fn of(statement: &Statement<'_>, hole_depth: HoleDepth) -> Option<Self> {
        let word = |minor: Minor<'_>| match minor {
            Minor::Word(word) => Some(word.to_ascii_uppercase()),
            Minor::Number(..) => None,
        };
        let mut minors = statement.minors.iter().copied().peekable();
        minors.next().and_then(word).filter(|kind| KINDS.contains(&&kind[..]))?;
        let (mut depth, mut clear, mut rapid_to, mut retract, mut feed) = (None, None, None, None, None);
        let mut is_first = true;
        while let Some(minor) = minors.next() {
            let mut number = || match minors.peek() {
                Some(Minor::Number(value, _)) if value.is_finite() => {
                    let value = *value;
                    minors.next();
                    Some(value)
                }
                _ => None,
            };
            match minor {
                Minor::Number(value, _) if is_first && value.is_finite() => depth = Some(value),
                // Behind depth and feed without words.
                Minor::Number(value, _) if feed.is_some() && clear.is_none() && value.is_finite() => {
                    clear = Some(value)
                }
                Minor::Number(..) => return None,
                Minor::Word(text) => match &text.to_ascii_uppercase()[..] {
                    "DEEP" | "BRKCHP" if is_first => continue,
                    "DEPTH" => depth = Some(number()?),
                    "FEDTO" => {
                        let to = number()?;
                        depth = Some(match hole_depth {
                            HoleDepth::Depth => to,
                            HoleDepth::Coordinate => -to,
                            HoleDepth::Either => to.abs(),
                        });
                    }
                    "CLEAR" => clear = Some(number()?),
                    "RAPTO" => rapid_to = Some(number()?),
                    "RTRCTO" | "RETURN" => match number() {
                        Some(value) => retract = Some(value),
                        None => {
                            minors.next().and_then(word).filter(|word| word == "AUTO")?;
                        }
                    },
                    "DWELL" => {
                        minors.next_if(|minor| word(*minor).is_some_and(|word| word == "REV"));
                        minors.next_if(|minor| matches!(minor, Minor::Number(..)))?;
                    }
                    pecks if PECKS.contains(&pecks) => {
                        minors.next_if(|minor| matches!(minor, Minor::Number(..)))?;
                    }
                    unit if FEEDS.contains(&unit) => feed = Some((number()?, unit.to_owned())),
                    _ => return None,
                },
            }
            is_first = false;
        }
        let depth = depth.filter(|depth| *depth > 0.0)?;
        let clear = rapid_to.or(clear).filter(|clear| *clear > 0.0)?;
        Some(Self { clear, depth, retract: retract.unwrap_or(clear).max(clear), feed })
    }
}
