//! Conditions on the values of a case: comparisons joined by `and`.

use super::value::data;
use serde_json::Value;
use std::cmp::Ordering;
use toml::de::DeValue;

/// Comparisons that all have to hold.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Condition(Vec<Comparison>);

/// A field or an axis beside a value.
#[derive(Debug, Clone, PartialEq)]
struct Comparison {
    name: String,
    operator: Operator,
    value: Value,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Operator {
    Equal,
    NotEqual,
    Below,
    NotAbove,
    Above,
    NotBelow,
}

/// Longer ones first, since some begin like shorter ones.
const OPERATORS: [(&str, Operator); 6] = [
    ("==", Operator::Equal),
    ("!=", Operator::NotEqual),
    ("<=", Operator::NotAbove),
    (">=", Operator::NotBelow),
    ("<", Operator::Below),
    (">", Operator::Above),
];

impl Condition {
    /// What a condition looks like.
    pub const ALLOWED: &'static str =
        "comparisons by ==, !=, <, <=, > or >= joined by \"and\", as in robot == \"a.toml\" and cell.z_mm[1] > 200";

    /// # Errors
    /// What is wrong, as a sentence.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut rest = text.trim();
        let mut comparisons = Vec::new();
        loop {
            let (comparison, after) = Comparison::parse(rest)?;
            comparisons.push(comparison);
            rest = after.trim_start();
            if rest.is_empty() {
                return Ok(Self(comparisons));
            }
            rest = rest
                .strip_prefix("and")
                .filter(|after| after.starts_with(char::is_whitespace))
                .ok_or_else(|| format!("has '{rest}' where \"and\" or the end should be"))?
                .trim_start();
        }
    }

    /// Whether it holds, by the values of fields and axes.
    ///
    /// # Errors
    /// What is wrong, as a sentence: a name that has no value, values that cannot be compared.
    pub fn holds(&self, value: &impl Fn(&str) -> Option<Value>) -> Result<bool, String> {
        let mut holds = true;
        for comparison in &self.0 {
            let Comparison { name, .. } = comparison;
            let found = value(name).ok_or_else(|| format!("names {name}, which is on no axis"))?;
            holds &= comparison.holds(&found)?;
        }
        Ok(holds)
    }

    /// The names that it compares.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|comparison| comparison.name.as_str())
    }
}

impl Comparison {
    fn parse(text: &str) -> Result<(Self, &str), String> {
        let is_name = |c: char| c.is_ascii_alphanumeric() || ['.', '_', '-', '[', ']'].contains(&c);
        let (name, rest) = text.split_at(text.find(|c| !is_name(c)).unwrap_or(text.len()));
        let (name, rest) = match text.strip_prefix('`').and_then(|quoted| quoted.split_once('`')) {
            Some(quoted) => quoted,
            None => (name, rest),
        };
        if name.is_empty() {
            return Err(format!("has '{text}' where a field or the name of an axis should be"));
        }
        let rest = rest.trim_start();
        let found = OPERATORS.iter().find_map(|(sign, operator)| Some((*operator, rest.strip_prefix(sign)?)));
        let (operator, rest) = found.ok_or_else(|| format!("has '{rest}' where a comparison should be"))?;
        let rest = rest.trim_start();
        let (value, rest) = rest.split_at(value_length(rest));
        let parsed = DeValue::parse(value.trim()).map_err(|_| format!("has '{value}' where a value should be"))?;
        Ok((Self { name: name.to_owned(), operator, value: data(parsed.get_ref()) }, rest))
    }

    fn holds(&self, found: &Value) -> Result<bool, String> {
        match self.operator {
            Operator::Equal => return Ok(*found == self.value),
            Operator::NotEqual => return Ok(*found != self.value),
            _ => {}
        }
        let ordering = match (found, &self.value) {
            (Value::Number(a), Value::Number(b)) => a.as_f64().zip(b.as_f64()).and_then(|(a, b)| a.partial_cmp(&b)),
            (Value::String(a), Value::String(b)) => Some(a.cmp(b)),
            _ => None,
        };
        let ordering = ordering
            .ok_or_else(|| format!("compares {} = {found} with {}, which have no order", self.name, self.value))?;
        Ok(match self.operator {
            Operator::Below => ordering == Ordering::Less,
            Operator::NotAbove => ordering != Ordering::Greater,
            Operator::Above => ordering == Ordering::Greater,
            _ => ordering != Ordering::Less,
        })
    }
}

/// How long the value is that a text begins with: to the end of its quotes or brackets, or to the next space.
fn value_length(text: &str) -> usize {
    let (mut depth, mut quote) = (0_i32, None);
    for (at, c) in text.char_indices() {
        match (quote, c) {
            (Some(open), _) if c == open => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(c),
            (None, '[' | '{') => depth += 1,
            (None, ']' | '}') => depth -= 1,
            (None, c) if c.is_whitespace() && depth <= 0 => return at,
            _ => {}
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(name: &str) -> Option<Value> {
        let text = match name {
            "robot" => "'a.toml'",
            "cell.z_mm" => "[-300, 250.0]",
            "cell.z_mm[1]" => "-300",
            "output.maps" => "true",
            _ => return None,
        };
        Some(data(DeValue::parse(text).unwrap().get_ref()))
    }

    #[test]
    fn comparisons_hold_or_not() {
        for (text, expected) in [
            ("robot == \"a.toml\"", true),
            ("robot != 'a.toml'", false),
            ("robot == \"a.toml\" and cell.z_mm[1] > 200", false),
            ("cell.z_mm[1]<=-300 and  robot<'b'", true),
            ("cell.z_mm == [-300.0, 250] and output.maps == true", true),
            ("`cell.z_mm[1]` >= -300.0", true),
            ("cell.z_mm[1] < -300", false),
        ] {
            assert_eq!(Condition::parse(text).unwrap().holds(&value), Ok(expected), "{text}");
        }
    }

    #[test]
    fn what_is_no_condition_is_refused() {
        for (text, part) in [
            ("", "has '' where a field"),
            ("robot", "has '' where a comparison"),
            ("robot = 'a'", "has '= 'a'' where a comparison"),
            ("robot == ", "has '' where a value"),
            ("robot == a.toml", "has 'a.toml' where a value"),
            ("robot == 'a' or x == 1", "has 'or x == 1' where \"and\""),
            ("robot == 'a' andx == 1", "where \"and\""),
            ("== 3", "where a field"),
        ] {
            let message = Condition::parse(text).unwrap_err();
            assert!(message.contains(part), "{part} in {message}");
        }
        for (text, part) in [("task == 1", "task, which is on no axis"), ("robot < 3", "have no order")] {
            let message = Condition::parse(text).unwrap().holds(&value).unwrap_err();
            assert!(message.contains(part), "{part} in {message}");
        }
    }
}
