//! Elements of an XML document with their place in the file: attributes read as text and numbers, errors with line, tag
//! and value.

use roxmltree::Node;
use std::path::Path;
use stead_disk::input::InputError;
pub(crate) use stead_disk::quote::one_line;
use stead_disk::quote::{GARBLED, garbles};

/// An element, and the file that it is in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Element<'a> {
    pub file: &'a Path,
    pub node: Node<'a, 'a>,
}

impl<'a> Element<'a> {
    /// The name of the tag.
    pub fn tag(self) -> &'a str {
        self.node.tag_name().name()
    }

    /// Where it begins in the text.
    pub fn byte(self) -> usize {
        self.node.range().start
    }

    /// The elements of a tag directly below this one.
    pub fn children(self, tag: &'a str) -> impl Iterator<Item = Element<'a>> {
        let below = self.node.children().filter(move |node| node.is_element() && node.tag_name().name() == tag);
        below.map(move |node| Element { file: self.file, node })
    }

    /// The first of these.
    pub fn child(self, tag: &'a str) -> Option<Element<'a>> {
        self.children(tag).next()
    }

    /// The first of these, which must be there.
    pub fn require_child(self, tag: &'a str) -> Result<Element<'a>, InputError> {
        self.child(tag).ok_or_else(|| self.error(None, format!("has no <{tag}>"), format!("an element <{tag}> in it")))
    }

    /// The text of an attribute.
    pub fn attribute(self, name: &str) -> Option<&'a str> {
        self.node.attribute(name)
    }

    /// The text of an attribute, which must be there and not empty.
    pub fn require(self, name: &str) -> Result<&'a str, InputError> {
        let text = self.attribute(name).filter(|text| !text.trim().is_empty());
        let text = text.ok_or_else(|| self.error(Some(name), "is missing", "a text that is not empty"))?;
        // The result is in the files that are written.
        let is_plain = !text.contains(garbles);
        is_plain.then_some(text).ok_or_else(|| self.error(Some(name), GARBLED, "a text without them"))
    }

    /// The number of an attribute, where it is given; its size may not be above `largest`.
    pub fn number(self, name: &str, largest: f64) -> Result<Option<f64>, InputError> {
        let number = self.numbers(name, largest, "one finite number", "a number")?;
        Ok(number.map(|[number]| number))
    }

    /// The three numbers of an attribute, where it is given.
    pub fn vector(self, name: &str, largest: f64) -> Result<Option<[f64; 3]>, InputError> {
        self.numbers(name, largest, "three finite numbers", "three numbers")
    }

    fn numbers<const N: usize>(
        self,
        name: &str,
        largest: f64,
        what: &str,
        allowed: &str,
    ) -> Result<Option<[f64; N]>, InputError> {
        let Some(text) = self.attribute(name) else { return Ok(None) };
        let number = |word: &str| word.parse::<f64>().ok().filter(|value| value.abs() <= largest);
        // One more than is wanted tells that there are too many.
        let numbers: Option<Vec<f64>> = text.split_ascii_whitespace().take(N + 1).map(number).collect();
        let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
        numbers.map(Some).ok_or_else(|| {
            let error = self.error(Some(name), format!("is not {what} in range"), "");
            error.found(quoted(text)).allowed(format!("{allowed} from -{largest} to {largest}"))
        })
    }

    /// An error here: at an attribute, or at the element as a whole.
    pub fn error(self, attribute: Option<&str>, problem: impl Into<String>, allowed: impl Into<String>) -> InputError {
        let field = match attribute {
            Some(attribute) => format!("{}, attribute {attribute}", self.path()),
            None => self.path(),
        };
        let line = self.node.document().text_pos_at(self.byte()).row as usize;
        let error = InputError::new(self.file, problem).at_line(line).in_field(field);
        let found = attribute.and_then(|name| self.attribute(name));
        error.found_if(found.map(quoted)).allowed(allowed)
    }

    /// The element as a person finds it: `joint "a1": <limit>`.
    fn path(self) -> String {
        let named = |node: Node<'a, 'a>| {
            let tag = node.tag_name().name();
            (tag == "joint" || tag == "link")
                .then(|| node.attribute("name").map(|name| format!("{tag} {}", quoted(name))))?
        };
        match self.node.ancestors().find_map(|node| named(node).map(|name| (node == self.node, name))) {
            Some((true, name)) => name,
            Some((false, name)) => format!("{name}: <{}>", self.tag()),
            None => format!("<{}>", self.tag()),
        }
    }
}

/// Longest text that a message quotes, in characters.
const QUOTE: usize = 60;

/// A text in quotes, on one line and not too long.
pub(super) fn quoted(text: &str) -> String {
    let clean = one_line(text);
    let short: String = clean.chars().take(QUOTE).collect();
    if short == clean { format!("\"{short}\"") } else { format!("\"{short}..\"") }
}
