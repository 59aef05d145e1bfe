//! Figures and labels of pictures: numbers of few digits, lines of a given width, and labels that do not cover each
//! other.

use super::canvas::{Canvas, Pixel, TextStyle};
use super::colour::Colour;
use crate::units::{figures, fixed};

/// A whole number without decimals, any other as [`figures`].
pub fn whole_or_figures(value: f64) -> String {
    let rounded = value.round();
    if (value - rounded).abs() < 1e-6 && rounded.abs() < 1e9 { fixed(rounded, 0) } else { figures(value) }
}

/// What stands between two phrases.
const BETWEEN: &str = " · ";

/// Phrases in lines of at most so many letters, with a dot between them; a longer phrase has a line of its own.
pub fn lines(phrases: &[String], max: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for phrase in phrases {
        match lines.last_mut() {
            Some(line) if line.chars().count() + BETWEEN.chars().count() + phrase.chars().count() <= max => {
                line.push_str(BETWEEN);
                line.push_str(phrase);
            }
            _ => lines.push(phrase.clone()),
        }
    }
    lines
}

/// A text of at most so many letters.
pub fn cut(text: &str, letters: usize) -> String {
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

/// Names of ticks, each cut to fit into so many pixels. Where there are too many for that, some are left out.
pub fn fitting(names: &[String], pixels: i32) -> Vec<String> {
    let style = TextStyle::new(TICKS);
    let widest = names.iter().map(|name| style.width(name)).max().unwrap_or(0).min(6 * 8);
    let step = ((widest + 6) as usize).div_ceil(pixels.max(1) as usize).max(1);
    let letters = f64::from(pixels * step as i32 - 6) / (TICKS * 0.6);
    let letters = (letters.floor() as usize).max(1);
    // Where the beginnings are the same, what tells names apart is at their ends.
    let mut beginnings: Vec<String> = names.iter().map(|name| cut(name, letters)).collect();
    beginnings.sort_unstable();
    let is_same = beginnings.windows(2).any(|two| two[0] == two[1]);
    let cut = if is_same { ending } else { cut };
    let shown = |(k, name): (usize, &String)| if k.is_multiple_of(step) { cut(name, letters) } else { String::new() };
    names.iter().enumerate().map(shown).collect()
}

/// A rectangle of pixels: its upper left and its lower right corner.
pub type Area = (Pixel, Pixel);

/// A label on a ground of its own.
pub struct Label<'a> {
    /// What it says.
    pub text: &'a str,
    /// Colour of the letters.
    pub colour: Colour,
    /// Colour behind them.
    pub ground: Colour,
}

/// Places labels where nothing else is.
pub struct Labeller {
    /// Labels stay inside.
    within: Area,
    taken: Vec<Area>,
}

/// Height of the letters of ticks. Pixels
pub const TICKS: f64 = 12.0;
/// Height of the letters of labels. Pixels
const SIZE: f64 = 10.5;

impl Labeller {
    /// A labeller for an empty area.
    pub fn new(within: Area) -> Self {
        Self { within, taken: Vec::new() }
    }

    /// Keeps labels off an area.
    pub fn take(&mut self, area: Area) {
        self.taken.push(area);
    }

    /// Keeps labels off the outline of an area.
    pub fn take_outline(&mut self, area: Area) {
        let ((left, top), (right, bottom)) = area;
        for (from, to) in [
            ((left, top), (right, top)),
            ((left, bottom), (right, bottom)),
            ((left, top), (left, bottom)),
            ((right, top), (right, bottom)),
        ] {
            self.take(((from.0 - 2, from.1 - 2), (to.0 + 2, to.1 + 2)));
        }
    }

    /// Half the width and half the height of a label. Pixels
    pub fn half(text: &str) -> Pixel {
        (TextStyle::new(SIZE).width(text) / 2 + 1, 7)
    }

    /// Puts a label at the first of some centres where it covers nothing; draws nothing where there is none.
    pub fn put(&mut self, canvas: &mut Canvas, label: &Label<'_>, centres: impl Iterator<Item = Pixel>) {
        let (x, y) = Self::half(label.text);
        let areas = centres.map(|centre| (centre, ((centre.0 - x, centre.1 - y), (centre.0 + x, centre.1 + y))));
        let mut free = areas.filter(|(_, area)| self.is_free(*area));
        let Some((centre, area)) = free.next() else { return };
        drop(free);
        self.take(area);
        canvas.fill(area.0, area.1, label.ground);
        canvas.text(label.text, centre, TextStyle::new(SIZE).centred().coloured(label.colour))
    }

    fn is_free(&self, area: Area) -> bool {
        let (((left, top), (right, bottom)), (from, to)) = (area, self.within);
        let inside = left >= from.0 && top >= from.1 && right <= to.0 && bottom <= to.1;
        let apart = |(from, to): &Area| right < from.0 || left > to.0 || bottom < from.1 || top > to.1;
        inside && self.taken.iter().all(apart)
    }
}

#[cfg(test)]
mod tests {
    use super::super::canvas::picture;
    use super::super::colour::{BLACK, WHITE};
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let texts = [0.0, 0.4149, 1.0, 12.34, 999.6, 123_456.7, 0.000_123_4, 1e-5, -2.5e12, f64::MAX].map(figures);
        let expected = ["0", "0.415", "1.00", "12.3", "1000", "123457", "0.000123", "1.00e-5", "-2.50e12", "1.80e308"];
        assert_eq!(texts, expected);
        assert_eq!(
            [50.0, 0.1 * 3.0 * 1e3, 12.5, 2e9, -0.0].map(whole_or_figures),
            ["50", "300", "12.5", "2.00e9", "0"]
        );
    }

    #[test]
    fn phrases_are_broken_into_lines() {
        let phrases = ["one", "two", "threefold", "a"].map(str::to_owned);
        assert_eq!(lines(&phrases, 9), ["one · two", "threefold", "a"]);
        assert_eq!(lines(&phrases, 100), ["one · two · threefold · a"]);
        assert!(lines(&[], 8).is_empty());
    }

    #[test]
    fn names_of_ticks_fit() {
        let names = |names: &[&str]| names.iter().map(ToString::to_string).collect::<Vec<_>>();
        assert_eq!(fitting(&names(&["kuka-kr500", "high and dry"]), 70), ["kuka-kr…", "high an…"]);
        assert_eq!(fitting(&names(&["kuka-kr270-r2700", "kuka-kr270-r3100"]), 70), ["…0-r2700", "…0-r3100"]);
        let many: Vec<String> = (100..140).map(|k| k.to_string()).collect();
        let shown = fitting(&many, 8);
        assert_eq!((shown[0].as_str(), shown[1].as_str(), shown[4].as_str()), ("100", "", "104"));
    }

    #[test]
    fn labels_do_not_cover_each_other() {
        let mut labeller = Labeller::new(((0, 0), (200, 100)));
        labeller.take_outline(((20, 20), (120, 80)));
        let svg = picture((200, 100), |canvas| {
            let label = |text| Label { text, colour: BLACK, ground: WHITE };
            // On the outline, over the edge, inside; then the same place again, and nothing else.
            labeller.put(canvas, &label("first"), [(20, 50), (195, 50), (60, 50)].into_iter());
            labeller.put(canvas, &label("second"), [(60, 50), (65, 45)].into_iter())
        });
        assert!(svg.contains("first") && !svg.contains("second"));
        assert_eq!(labeller.taken.len(), 5);
        let (x, y) = Labeller::half("first");
        assert_eq!(labeller.taken[4], ((60 - x, 50 - y), (60 + x, 50 + y)));
    }
}
