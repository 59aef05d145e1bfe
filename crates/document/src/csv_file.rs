//! How every CSV file is written: rows are structs, whose fields are the columns.
//!
//! A struct within a row that is not flattened puts its name before those of its fields: `start` with `x_mm` is
//! `start_x_mm`. A field that is skipped has no column; `None` is an empty field.

use crate::output::ReportError;
use crate::units::fixed;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::ser::{Error, Impossible, SerializeMap, SerializeStruct};
use serde::{Serialize, Serializer};
use std::borrow::Cow;
use std::fmt::Display;

/// A CSV file of at least one row.
pub fn rows<T: Serialize>(what: &'static str, rows: impl IntoIterator<Item = T>) -> Result<Vec<u8>, ReportError> {
    written(what, None, rows)
}

/// A CSV file of rows; where there is none its columns are those of `blank`.
pub fn rows_or<T: Serialize>(
    what: &'static str,
    blank: &T,
    rows: impl IntoIterator<Item = T>,
) -> Result<Vec<u8>, ReportError> {
    written(what, Some(blank), rows)
}

fn written<T: Serialize>(
    what: &'static str,
    blank: Option<&T>,
    rows: impl IntoIterator<Item = T>,
) -> Result<Vec<u8>, ReportError> {
    let fail = |cause: &dyn Display| ReportError::Format { what, cause: cause.to_string() };
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut rows = rows.into_iter().peekable();
    let mut header = Row { names: Some(Vec::new()), cells: Vec::new() };
    if let Some(first) = rows.peek().or(blank) {
        first.serialize(header.at("", None)).map_err(|error| fail(&error))?;
    }
    writer.write_record(header.names.unwrap_or_default()).map_err(|error| fail(&error))?;
    let mut row = Row { names: None, cells: Vec::new() };
    for entry in rows {
        row.cells.clear();
        entry.serialize(row.at("", None)).map_err(|error| fail(&error))?;
        writer.write_record(&row.cells).map_err(|error| fail(&error))?;
    }
    writer.into_inner().map_err(|error| fail(&error))
}

/// Columns whose names only a run knows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Columns<T>(pub Vec<(String, T)>);

impl<T: Serialize> Serialize for Columns<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

impl<T: JsonSchema> JsonSchema for Columns<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("columns of {}", T::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "object", "additionalProperties": generator.subschema_for::<T>() })
    }
}

/// The fields of a row, and the names of its columns where they are wanted.
struct Row {
    names: Option<Vec<String>>,
    cells: Vec<String>,
}

impl Row {
    fn at<'a>(&'a mut self, name: &'a str, decimals: Option<usize>) -> Field<'a> {
        Field { row: self, name, decimals }
    }
}

/// A value on its way into a row: its column, and the decimals of a number where they are fixed.
struct Field<'a> {
    row: &'a mut Row,
    name: &'a str,
    decimals: Option<usize>,
}

impl Field<'_> {
    fn put(self, text: String) -> Result<(), csv::Error> {
        self.row.cells.push(text);
        if let Some(names) = &mut self.row.names {
            names.push(self.name.to_owned());
        }
        Ok(())
    }
}

/// The fields of a struct on their way into a row.
struct Fields<'a> {
    row: &'a mut Row,
    before: &'a str,
    key: String,
}

impl Fields<'_> {
    fn put<T: Serialize + ?Sized>(&mut self, key: &str, value: &T) -> Result<(), csv::Error> {
        match (self.before, &self.row.names) {
            ("", _) | (_, None) => value.serialize(self.row.at(key, None)),
            (before, _) => value.serialize(self.row.at(&format!("{before}_{key}"), None)),
        }
    }
}

/// Scalars are written as they print.
macro_rules! scalars {
    ($($method:ident: $kind:ty;)*) => {$(
        fn $method(self, value: $kind) -> Result<(), csv::Error> {
            self.put(value.to_string())
        }
    )*};
}

/// Rows have no columns for these.
macro_rules! no_columns {
    ($($method:ident($($of:ty),*) -> $made:ty;)*) => {$(
        fn $method(self, $(_: $of),*) -> Result<$made, csv::Error> {
            Err(csv::Error::custom(format!("'{}' has no single value for a table", self.name)))
        }
    )*};
}

impl<'a> Serializer for Field<'a> {
    type Ok = ();
    type Error = csv::Error;
    type SerializeSeq = Impossible<(), csv::Error>;
    type SerializeTuple = Impossible<(), csv::Error>;
    type SerializeTupleStruct = Impossible<(), csv::Error>;
    type SerializeTupleVariant = Impossible<(), csv::Error>;
    type SerializeMap = Fields<'a>;
    type SerializeStruct = Fields<'a>;
    type SerializeStructVariant = Impossible<(), csv::Error>;

    scalars! {
        serialize_bool: bool;
        serialize_i8: i8;
        serialize_i16: i16;
        serialize_i32: i32;
        serialize_i64: i64;
        serialize_u8: u8;
        serialize_u16: u16;
        serialize_u32: u32;
        serialize_u64: u64;
        serialize_f32: f32;
        serialize_char: char;
        serialize_str: &str;
    }

    fn serialize_f64(self, value: f64) -> Result<(), csv::Error> {
        match self.decimals {
            Some(decimals) => self.put(fixed(value, decimals)),
            None => self.put(value.to_string()),
        }
    }

    /// Figures come unrounded.
    fn is_human_readable(&self) -> bool {
        false
    }

    fn serialize_none(self) -> Result<(), csv::Error> {
        self.put(String::new())
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<(), csv::Error> {
        value.serialize(self)
    }

    fn serialize_unit_variant(self, _: &'static str, _: u32, variant: &'static str) -> Result<(), csv::Error> {
        self.put(variant.to_owned())
    }

    /// The name of a figure is its decimals.
    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, name: &'static str, value: &T) -> Result<(), csv::Error> {
        value.serialize(self.row.at(self.name, name.parse().ok()))
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Fields<'a>, csv::Error> {
        Ok(Fields { row: self.row, before: self.name, key: String::new() })
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Fields<'a>, csv::Error> {
        Ok(Fields { row: self.row, before: self.name, key: String::new() })
    }

    no_columns! {
        serialize_bytes(&[u8]) -> ();
        serialize_unit() -> ();
        serialize_unit_struct(&'static str) -> ();
        serialize_seq(Option<usize>) -> Self::SerializeSeq;
        serialize_tuple(usize) -> Self::SerializeTuple;
        serialize_tuple_struct(&'static str, usize) -> Self::SerializeTupleStruct;
        serialize_tuple_variant(&'static str, u32, &'static str, usize) -> Self::SerializeTupleVariant;
        serialize_struct_variant(&'static str, u32, &'static str, usize) -> Self::SerializeStructVariant;
    }

    fn serialize_newtype_variant<T: ?Sized>(self, _: &str, _: u32, _: &str, _: &T) -> Result<(), csv::Error> {
        self.serialize_unit()
    }
}

impl SerializeStruct for Fields<'_> {
    type Ok = ();
    type Error = csv::Error;

    fn serialize_field<T: Serialize + ?Sized>(&mut self, key: &'static str, value: &T) -> Result<(), csv::Error> {
        self.put(key, value)
    }

    fn end(self) -> Result<(), csv::Error> {
        Ok(())
    }
}

/// A struct with flattened fields comes as a map.
impl SerializeMap for Fields<'_> {
    type Ok = ();
    type Error = csv::Error;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Result<(), csv::Error> {
        let mut name = Row { names: None, cells: Vec::new() };
        key.serialize(name.at("", None))?;
        self.key = name.cells.pop().unwrap_or_default();
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), csv::Error> {
        let key = std::mem::take(&mut self.key);
        self.put(&key, value)
    }

    fn end(self) -> Result<(), csv::Error> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{DeflectionMm, PlaceMm, some};

    #[derive(Serialize, Default)]
    struct Place {
        x_mm: PlaceMm,
        y_mm: PlaceMm,
    }

    #[derive(Serialize, Default)]
    struct Entry {
        name: String,
        #[serde(flatten)]
        place: Place,
        start: Place,
        #[serde(skip_serializing_if = "Option::is_none")]
        std_mm: Option<DeflectionMm>,
        time: Option<f64>,
        is_done: bool,
    }

    #[test]
    fn columns_are_the_fields_of_the_rows() {
        let text =
            |entries: Vec<Entry>| String::from_utf8(rows_or("the table", &Entry::default(), entries).unwrap()).unwrap();
        let header = "name,x_mm,y_mm,start_x_mm,start_y_mm,time,is_done\n";
        assert_eq!(text(Vec::new()), header);
        let place = || Place { x_mm: PlaceMm(1e-3), y_mm: PlaceMm(-0.0) };
        let entry = |std| Entry { name: "a,b".to_owned(), place: place(), std_mm: some(std), ..Entry::default() };
        assert_eq!(text(vec![entry(None)]), format!("{header}\"a,b\",1.0000,0.0000,0.0000,0.0000,,false\n"));
        let with = text(vec![Entry { time: Some(0.5), ..entry(Some(1e-6)) }]);
        assert_eq!(with.lines().nth(1).unwrap(), "\"a,b\",1.0000,0.0000,0.0000,0.0000,0.0010000,0.5,false");
    }

    #[test]
    fn lists_have_no_column() {
        #[derive(Serialize)]
        struct Entry {
            joints: [f64; 2],
        }
        let message = rows("the table", [Entry { joints: [0.0; 2] }]).unwrap_err().to_string();
        assert!(message.contains("'joints' has no single value"), "{message}");
    }
}
