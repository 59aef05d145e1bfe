//! Values of any kind, as data and as TOML on one line.

use serde_json::{Map, Number, Value};
use toml::de::DeValue;

/// A value as data: every number as a float, what is no finite number as its text.
pub(crate) fn data(value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => Value::String(text.as_ref().to_owned()),
        DeValue::Boolean(is) => Value::Bool(*is),
        DeValue::Integer(_) | DeValue::Float(_) => {
            let number = number(value).and_then(Number::from_f64);
            number.map_or_else(|| Value::String(toml(value)), Value::Number)
        }
        DeValue::Datetime(time) => Value::String(time.to_string()),
        DeValue::Array(array) => Value::Array(array.iter().map(|entry| data(entry.get_ref())).collect()),
        DeValue::Table(table) => {
            let mut entries: Vec<_> =
                table.iter().map(|(key, entry)| (key.get_ref().as_ref().to_owned(), data(entry.get_ref()))).collect();
            entries.sort_by(|a, b| a.0.cmp(&b.0));
            Value::Object(Map::from_iter(entries))
        }
    }
}

/// The number that a value holds.
fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().replace('_', "").parse().ok(),
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|n| n as f64),
        _ => None,
    }
}

/// A value in TOML on one line.
pub(crate) fn toml(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => quoted(text),
        DeValue::Boolean(is) => is.to_string(),
        DeValue::Integer(integer) => integer.to_string(),
        // However it is written, the same number is the same text, and so the same input.
        DeValue::Float(float) => {
            number(value).filter(|n| n.is_finite()).map_or_else(|| float.to_string(), |n| format!("{n:?}"))
        }
        DeValue::Datetime(time) => time.to_string(),
        DeValue::Array(array) => {
            let entries: Vec<String> = array.iter().map(|entry| toml(entry.get_ref())).collect();
            format!("[{}]", entries.join(", "))
        }
        DeValue::Table(table) => {
            let entry = |(key, value): (&toml::Spanned<_>, &toml::Spanned<DeValue<'_>>)| {
                let key: &std::borrow::Cow<'_, str> = key.get_ref();
                format!("{} = {}", quoted(key), self::toml(value.get_ref()))
            };
            format!("{{ {} }}", table.iter().map(entry).collect::<Vec<_>>().join(", "))
        }
    }
}

/// A text in quotes. What JSON escapes, TOML does alike.
pub(crate) fn quoted(text: &str) -> String {
    Value::String(text.to_owned()).to_string().replace('\u{7f}', "\\u007f")
}

/// A value as a field of a table of results: texts without quotes.
pub(crate) fn shown(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => text.as_ref().to_owned(),
        other => toml(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_back_from_one_line() {
        for (text, expected) in [
            ("[1,\n 2.50, 'a\"b']", "[1, 2.5, \"a\\\"b\"]"),
            ("{ b = 1, a.c = [true] }", "{ \"a\" = { \"c\" = [true] }, \"b\" = 1 }"),
            ("0x1F", "0x1f"),
            ("1e3", "1000.0"),
            ("'a\tb'", "\"a\\tb\""),
        ] {
            let value = DeValue::parse(text).unwrap();
            let line = toml(value.get_ref());
            assert_eq!(line.to_lowercase(), expected);
            assert_eq!(data(DeValue::parse(&line).unwrap().get_ref()), data(value.get_ref()));
        }
        assert_eq!(shown(DeValue::parse("'a.toml'").unwrap().get_ref()), "a.toml");
        assert_eq!(data(DeValue::parse("[1, 1.0, nan]").unwrap().get_ref()).to_string(), "[1.0,1.0,\"nan\"]");
    }
}
