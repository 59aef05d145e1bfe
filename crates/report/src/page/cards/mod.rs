//! Pages of cards: what a command has found, as text, figures, tables and charts that answer to pointer and keys, in
//! one file.
//!
//! A command says what it has found as a [`Page`]; one set of scripts draws whatever cards there are. Everything from
//! an input file is text in the data of the page and is put into it as text alone.

pub use stead_document::cards::{
    Axis, Cell, Chart, Column, HeatMap, MapLine, MapPoint, Mark, Outline, Polar, PolarChoice, Series, Style, Table,
};

use super::html::{CARDS, html};
use serde::Serialize;
use stead_disk::input::InputFile;

/// A page: what it is about, and its cards in their order.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Page {
    /// What it is about: the name of a robot, a study or a file.
    pub title: String,
    /// What kind of result, and of how much.
    pub subtitle: String,
    /// What has been found, in one sentence.
    pub lead: String,
    /// Its cards.
    pub cards: Vec<Card>,
    /// The program and the files behind it, under the cards.
    pub origin: Vec<String>,
}

/// A card.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Card {
    /// Sentences.
    Text(Text),
    /// Figures.
    Tiles(Tiles),
    /// A table.
    Table(Table),
    /// Curves and dots over two axes.
    Chart(Chart),
    /// Values over two axes as colours.
    HeatMap(Box<HeatMap>),
    /// Deviations about a circle.
    Polar(Polar),
}

/// What each kind of card is made of.
macro_rules! cards {
    ($($of:ident: $type:ty => $card:expr;)*) => {$(
        impl From<$type> for Card {
            fn from($of: $type) -> Self {
                $card
            }
        }
    )*};
}

cards! {
    text: Text => Self::Text(text);
    tiles: Vec<Tile> => Self::Tiles(Tiles { tiles });
    table: Table => Self::Table(table);
    chart: Chart => Self::Chart(chart);
    map: HeatMap => Self::HeatMap(Box::new(map));
    polar: Polar => Self::Polar(polar);
}

/// Sentences under a heading.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Text {
    /// Heading.
    pub title: String,
    /// The sentences, each on its own.
    pub sentences: Vec<String>,
    /// Whether they are warnings.
    pub is_warning: bool,
}

impl Text {
    /// Sentences, where there are any.
    pub fn of(title: &str, sentences: Vec<String>, is_warning: bool) -> Option<Self> {
        (!sentences.is_empty()).then(|| Self { title: title.to_owned(), sentences, is_warning })
    }
}

/// Figures in large digits.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Tiles {
    /// Each figure.
    pub tiles: Vec<Tile>,
}

/// A figure.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Tile {
    /// What it is.
    pub label: String,
    /// The figure as it is shown.
    pub value: String,
    /// Its unit.
    pub unit: String,
    /// What else is to be said of it.
    pub detail: String,
}

impl Tile {
    /// A figure with its unit.
    pub fn new(label: &str, value: impl Into<String>, unit: &str, detail: impl Into<String>) -> Self {
        Self { label: label.to_owned(), value: value.into(), unit: unit.to_owned(), detail: detail.into() }
    }
}

impl Page {
    /// A page without cards, with the files behind it.
    pub fn new(title: &str, subtitle: impl Into<String>, lead: impl Into<String>, inputs: &[InputFile]) -> Self {
        let program = format!("stead {}", env!("CARGO_PKG_VERSION"));
        let files = inputs.iter().map(|file| format!("{} {}, SHA-256 {}", file.role, file.name, start(&file.sha256)));
        let origin = std::iter::once(program).chain(files).collect();
        Self { title: title.to_owned(), subtitle: subtitle.into(), lead: lead.into(), cards: Vec::new(), origin }
    }

    /// Adds warnings and notes, where there are any: they come first on every page.
    pub fn messages(self, warnings: &[impl ToString], notes: &[impl ToString]) -> Self {
        let warnings = Text::of("Warnings", warnings.iter().map(ToString::to_string).collect(), true);
        self.with_all(warnings).with_all(Text::of("Notes", notes.iter().map(ToString::to_string).collect(), false))
    }

    /// Adds a card.
    pub fn with(self, card: impl Into<Card>) -> Self {
        self.with_all([card])
    }

    /// Adds cards, or one where there is one.
    pub fn with_all(mut self, cards: impl IntoIterator<Item = impl Into<Card>>) -> Self {
        self.cards.extend(cards.into_iter().map(Into::into));
        self
    }

    /// The page as the bytes of an HTML file that needs no other file and no network.
    pub fn html(&self) -> Vec<u8> {
        let data = String::from_utf8_lossy(&crate::document::compact(self)).into_owned();
        html(&self.title, CARDS, &data).into_bytes()
    }
}

/// As much of a digest as tells files apart.
fn start(digest: &str) -> String {
    digest.chars().take(12).collect()
}

#[cfg(test)]
mod tests;
