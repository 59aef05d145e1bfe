//! Units of length of a program, words of values, and numbers without the digits of a unit.

/// A unit of length of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LengthUnit {
    /// Millimetres.
    Millimetre,
    /// Inches.
    Inch,
}

impl LengthUnit {
    /// Its length. m
    pub fn metres(self) -> f64 {
        match self {
            Self::Millimetre => 1e-3,
            Self::Inch => 25.4e-3,
        }
    }

    /// Both with their names as options and keys have them.
    pub const WORDS: [(&'static str, Self); 2] = [("mm", Self::Millimetre), ("inch", Self::Inch)];

    /// Its name as an option has it.
    pub fn word(self) -> &'static str {
        word_of(&Self::WORDS, self)
    }
}

/// The word of a value.
pub(super) fn word_of<T: PartialEq>(words: &[(&'static str, T)], value: T) -> &'static str {
    words.iter().find(|(_, known)| *known == value).map_or("", |(word, _)| word)
}

/// A number without the digits that its unit has brought in.
pub(super) fn rounded(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}
