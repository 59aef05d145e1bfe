//! Pictures of a study: the front, what each axis does, and a column over two axes.

mod effects;
mod front;
mod map;
#[cfg(test)]
mod tests;

pub use effects::effects;
pub use front::front;
pub use map::map;

use super::axes::{Scale, extent};
use super::canvas::TextStyle;
use crate::units::{figures, fixed};

/// Labels of ticks.
const TICKS: f64 = 12.0;

/// A scale over some values with a little room at both ends.
fn roomy(values: impl Iterator<Item = f64> + Clone, start: i32, end: i32) -> Scale {
    let first = values.clone().next().unwrap_or(0.0);
    let [low, high] = extent([first, first], values);
    // Values of which only the last digits differ are drawn as equal.
    let margin = if high - low > 1e-9 * high.abs().max(low.abs()) { 0.07 * (high - low) } else { 0.05 * high.abs() };
    let margin = if margin > 0.0 { margin } else { 0.5 };
    Scale::new(low - margin, high + margin, start, end)
}

/// Values of an axis as labels, without what they need not say, each cut to fit into so many pixels. Where there are
/// too many for that, some are left out.
fn fitting(labels: &[String], pixels: i32) -> Vec<String> {
    let letters = |pixels: i32| (f64::from(pixels) / (TICKS * 0.6)).floor() as usize;
    let short: Vec<String> = labels.iter().map(|label| short(label)).collect();
    let widest = short.iter().map(|label| TextStyle::new(TICKS).width(label)).max().unwrap_or(0).min(6 * 8);
    let step = ((widest + 6) as usize).div_ceil(pixels.max(1) as usize).max(1);
    let room = letters(pixels * step as i32 - 6).max(1);
    // Where the beginnings are the same, what tells labels apart is at their ends.
    let mut beginnings: Vec<String> = short.iter().map(|label| cut(label, room)).collect();
    beginnings.sort_unstable();
    let is_same = beginnings.windows(2).any(|two| two[0] == two[1]);
    let cut = if is_same { ending } else { cut };
    let shown =
        |(index, label): (usize, String)| if index.is_multiple_of(step) { cut(&label, room) } else { String::new() };
    short.into_iter().enumerate().map(shown).collect()
}

/// A value without folders and endings of files, a number with few digits.
fn short(label: &str) -> String {
    match label.parse::<f64>() {
        Ok(number) if label.len() > 7 => figures(number),
        Ok(_) => label.to_owned(),
        Err(_) => {
            let is_file = [".toml", ".csv"].iter().any(|ending| label.ends_with(ending));
            let name = if is_file { label.rsplit(['/', '\\']).next().unwrap_or(label) } else { label };
            name.trim_end_matches(".toml").trim_end_matches(".csv").to_owned()
        }
    }
}

/// A text of at most so many letters.
fn cut(text: &str, letters: usize) -> String {
    if text.chars().count() <= letters {
        return text.to_owned();
    }
    text.chars().take(letters.saturating_sub(1)).chain(['…']).collect()
}

/// The end of a text, of at most so many letters.
fn ending(text: &str, letters: usize) -> String {
    let backwards = |text: &str| text.chars().rev().collect::<String>();
    backwards(&cut(&backwards(text), letters))
}

/// A share in per cent.
fn percent(share: f64) -> String {
    fixed(share * 100.0, if share < 0.1 { 1 } else { 0 })
}
