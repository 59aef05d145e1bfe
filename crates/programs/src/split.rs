//! The moves of a program in parts, since controllers take no programs of any length.

use super::motion::Move;
use std::ops::Range;

/// Parts of at most `max` moves: whole segments where they fit, a longer one cut.
pub(super) fn parts(moves: &[Move], max: usize) -> Vec<Range<usize>> {
    let mut parts: Vec<Range<usize>> = Vec::new();
    for segment in moves.chunk_by(|a, b| a.segment == b.segment) {
        let start = parts.last().map_or(0, |part| part.end);
        let fits = |part: &&mut Range<usize>| part.len() + segment.len() <= max;
        match parts.last_mut().filter(fits) {
            Some(part) => part.end += segment.len(),
            None => {
                let end = start + segment.len();
                parts.extend((start..end).step_by(max).map(|from| from..(from + max).min(end)));
            }
        }
    }
    parts
}
