//! Lists of numbers in few characters: what the page's script unpacks in `data.js`.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Bytes as Base64 with padding (RFC 4648, section 4).
pub fn base64(bytes: &[u8]) -> String {
    STANDARD.encode(bytes)
}

/// The bytes behind such a text; none where it is no Base64.
pub fn bytes_of(text: &str) -> Vec<u8> {
    STANDARD.decode(text).unwrap_or_default()
}

/// Numbers in single precision, little endian, as Base64.
pub fn singles(values: impl IntoIterator<Item = f64>) -> String {
    base64(&values.into_iter().flat_map(|value| (value as f32).to_le_bytes()).collect::<Vec<u8>>())
}

/// Those chosen of rows of so many singles in Base64.
pub fn chosen_singles(all: &str, chosen: &[usize], width: usize) -> String {
    let bytes = bytes_of(all);
    let row = |row: &usize| bytes.get(4 * width * row..4 * width * (row + 1)).unwrap_or_default();
    base64(&chosen.iter().flat_map(row).copied().collect::<Vec<u8>>())
}

/// Whole numbers that change little from one to the next: each as seven bits a byte, the lowest first, the sign in
/// bit 0.
#[derive(Debug, Default)]
pub struct Varints(Vec<u8>);

impl Varints {
    /// Adds a number.
    pub fn push(&mut self, value: i64) {
        let mut rest = (value << 1 ^ value >> 63) as u64;
        while rest >= 128 {
            self.0.push(rest as u8 & 127 | 128);
            rest >>= 7;
        }
        self.0.push(rest as u8);
    }

    /// All of them as Base64.
    pub fn text(&self) -> String {
        base64(&self.0)
    }
}

/// Numbers of which many that follow each other are the same: for each run how many, and the number.
#[derive(Debug, Default)]
pub struct Runs {
    ended: Varints,
    run: Option<(i64, i64)>,
}

impl Runs {
    /// Adds a number.
    pub fn push(&mut self, value: i64) {
        match &mut self.run {
            Some((count, last)) if *last == value => *count += 1,
            run => {
                if let Some((count, last)) = run.replace((1, value)) {
                    self.ended.push(count);
                    self.ended.push(last);
                }
            }
        }
    }

    /// All of them as Base64.
    pub fn text(mut self) -> String {
        if let Some((count, last)) = self.run {
            self.ended.push(count);
            self.ended.push(last);
        }
        self.ended.text()
    }
}

/// The second differences of a sequence, which are small where it is smooth; [`SecondDifferences::restart`] begins a
/// new one.
#[derive(Debug, Default, Clone, Copy)]
pub struct SecondDifferences {
    last: Option<(i64, i64)>,
}

impl SecondDifferences {
    /// The difference of the next value to what the last two lead to expect.
    pub fn next(&mut self, value: i64) -> i64 {
        let (last, step) = self.last.unwrap_or((0, 0));
        let surprise = value - last - step;
        let new_step = if self.last.is_some() { value - last } else { 0 };
        self.last = Some((value, new_step));
        surprise
    }

    /// Forgets the sequence so far.
    pub fn restart(&mut self) {
        self.last = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_numbers_take_one_byte() {
        let mut packed = Varints::default();
        [0, -1, 1, 63, -64, 64, -300].into_iter().for_each(|value| packed.push(value));
        assert_eq!(packed.0, [0, 1, 2, 126, 127, 128, 1, 215, 4]);
    }

    #[test]
    fn runs_are_counted() {
        let mut runs = Runs::default();
        [7, 7, 7, 3, 7].into_iter().for_each(|value| runs.push(value));
        let mut packed = Varints::default();
        [3, 7, 1, 3, 1, 7].into_iter().for_each(|value| packed.push(value));
        assert_eq!(runs.text(), packed.text());
        assert_eq!(Runs::default().text(), "");
    }

    #[test]
    fn a_straight_line_has_no_second_differences() {
        let mut line = SecondDifferences::default();
        assert_eq!([5, 8, 11, 14, 16].map(|value| line.next(value)), [5, 3, 0, 0, -1]);
        line.restart();
        assert_eq!(line.next(16), 16);
    }

    #[test]
    fn singles_are_little_endian() {
        assert_eq!(singles([1.0, -2.0]), "AACAPwAAAMA=");
        assert_eq!(chosen_singles(&singles([1.0, -2.0, 3.0, 4.0]), &[0, 3], 1), singles([1.0, 4.0]));
        assert_eq!(chosen_singles(&singles([1.0, -2.0, 3.0, 4.0]), &[1], 2), singles([3.0, 4.0]));
    }
}
