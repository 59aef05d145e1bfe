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
    pub fn take_outline(&mut self, ((left, top), (right, bottom)): Area) {
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

    fn is_free(&self, ((left, top), (right, bottom)): Area) -> bool {
        let (from, to) = self.within;
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
