//! A table of results: typed columns, as CSV and as Parquet.

use super::StudyError;
use parquet::basic::{Compression, LogicalType, Repetition, Type as PhysicalType};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::record::Field;
use parquet::schema::types::Type;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use stead_disk::files;
use stead_disk::input::sha256;

/// The entry of a Parquet file's metadata that has the digest of the file, taken with [`BLANK`] in its place.
const DIGEST: &str = "stead.sha256";
/// See [`DIGEST`].
const BLANK: [u8; 64] = [b'0'; 64];
/// Bytes between the name of an entry and its value at the most: the head of a text in Thrift's compact protocol.
const MAX_HEAD: usize = 8;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnKind {
    /// Texts.
    Text,
    /// Numbers.
    Number,
    /// Whole numbers.
    Count,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Its name, with the unit.
    pub name: String,
    /// What it holds.
    pub kind: ColumnKind,
}

impl Column {
    /// A column of a name.
    pub fn new(name: impl Into<String>, kind: ColumnKind) -> Self {
        Self { name: name.into(), kind }
    }
}

/// One value of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum TableCell {
    /// No value.
    None,
    /// A text.
    Text(String),
    /// A finite number.
    Number(f64),
    /// A whole number.
    Count(i64),
}

impl TableCell {
    /// A number, where there is one that is finite.
    pub fn number(value: Option<f64>) -> Self {
        value.filter(|value| value.is_finite()).map_or(Self::None, Self::Number)
    }

    /// The value as a field of a CSV file: empty where there is none, numbers with as many digits as tell them from all
    /// others.
    pub fn written(&self) -> String {
        match self {
            Self::None => String::new(),
            Self::Text(text) => text.clone(),
            Self::Number(number) => number.to_string(),
            Self::Count(count) => count.to_string(),
        }
    }

    /// The value of a field of a CSV file, in a column of this kind.
    pub fn read(text: &str, kind: ColumnKind) -> Option<Self> {
        Some(match kind {
            _ if text.is_empty() => Self::None,
            ColumnKind::Text => Self::Text(text.to_owned()),
            ColumnKind::Number => Self::Number(text.parse().ok()?),
            ColumnKind::Count => Self::Count(text.parse().ok()?),
        })
    }
}

/// Rows under columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The columns.
    pub columns: Vec<Column>,
    /// The rows, each with a value for each column.
    pub rows: Vec<Vec<TableCell>>,
}

impl Table {
    /// The table as CSV.
    ///
    /// # Errors
    /// [`StudyError::Format`] when the writer fails.
    pub fn to_csv(&self) -> Result<Vec<u8>, StudyError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let fail = |cause: csv::Error| StudyError::format("the table", &cause);
        writer.write_record(self.columns.iter().map(|column| &column.name)).map_err(fail)?;
        for row in &self.rows {
            writer.write_record(row.iter().map(TableCell::written)).map_err(fail)?;
        }
        writer.into_inner().map_err(|cause| StudyError::format("the table", &cause))
    }

    /// The table as Parquet, compressed by Snappy; every column is optional. Its metadata has the digest of the file,
    /// since Parquet itself does not tell bytes that were changed on the disk.
    ///
    /// # Errors
    /// [`StudyError::Format`] when the writer fails.
    pub fn to_parquet(&self) -> Result<Vec<u8>, StudyError> {
        let fail = |cause: ParquetError| StudyError::format("the Parquet file", &cause);
        let schema = Arc::new(self.schema().map_err(fail)?);
        let properties = WriterProperties::builder().set_compression(Compression::SNAPPY);
        let digest = KeyValue::new(DIGEST.to_owned(), String::from_utf8_lossy(&BLANK).into_owned());
        let properties = properties.set_created_by("stead".to_owned()).set_key_value_metadata(Some(vec![digest]));
        let properties = Arc::new(properties.build());
        let mut bytes = Vec::new();
        let mut writer = SerializedFileWriter::new(&mut bytes, schema, properties).map_err(fail)?;
        let mut group = writer.next_row_group().map_err(fail)?;
        let mut index = 0;
        while let Some(mut column) = group.next_column().map_err(fail)? {
            let cells = || self.rows.iter().map(|row| &row[index]);
            let levels: Vec<i16> = cells().map(|cell| i16::from(*cell != TableCell::None)).collect();
            match column.untyped() {
                ColumnWriter::ByteArrayColumnWriter(writer) => {
                    let texts: Vec<ByteArray> = cells()
                        .filter(|cell| **cell != TableCell::None)
                        .map(|cell| ByteArray::from(cell.written().into_bytes()))
                        .collect();
                    writer.write_batch(&texts, Some(&levels), None).map_err(fail)?;
                }
                ColumnWriter::DoubleColumnWriter(writer) => {
                    let numbers =
                        cells().filter_map(|cell| if let TableCell::Number(n) = cell { Some(*n) } else { None });
                    writer.write_batch(&numbers.collect::<Vec<_>>(), Some(&levels), None).map_err(fail)?;
                }
                ColumnWriter::Int64ColumnWriter(writer) => {
                    let counts =
                        cells().filter_map(|cell| if let TableCell::Count(n) = cell { Some(*n) } else { None });
                    writer.write_batch(&counts.collect::<Vec<_>>(), Some(&levels), None).map_err(fail)?;
                }
                _ => return Err(StudyError::format("the Parquet file", &"a column of an unknown kind")),
            }
            column.close().map_err(fail)?;
            index += 1;
        }
        group.close().map_err(fail)?;
        writer.close().map_err(fail)?;
        let digest = sha256(&bytes);
        let place = place_of_digest(&bytes).ok_or_else(|| StudyError::format("the Parquet file", &"no digest"))?;
        bytes[place].copy_from_slice(digest.as_bytes());
        Ok(bytes)
    }

    /// The schema of the Parquet file.
    fn schema(&self) -> Result<Type, ParquetError> {
        let column = |column: &Column| {
            let (physical, logical) = match column.kind {
                ColumnKind::Text => (PhysicalType::BYTE_ARRAY, Some(LogicalType::String)),
                ColumnKind::Number => (PhysicalType::DOUBLE, None),
                ColumnKind::Count => (PhysicalType::INT64, None),
            };
            let builder = Type::primitive_type_builder(&column.name, physical);
            builder.with_repetition(Repetition::OPTIONAL).with_logical_type(logical).build().map(Arc::new)
        };
        let columns = self.columns.iter().map(column).collect::<Result<Vec<_>, _>>()?;
        Type::group_type_builder("study").with_fields(columns).build()
    }

    /// Reads a table from a Parquet file with these columns.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn from_parquet(file: &Path, columns: &[Column]) -> Result<Self, String> {
        let words = |cause: ParquetError| cause.to_string();
        // Before it is parsed: a reader need not bear bytes that no writer wrote.
        let bytes = files::read(file).map_err(|cause| cause.to_string())?;
        if !is_as_written(bytes) {
            return Err("is not as it was written".to_owned());
        }
        let opened = files::open(file).map_err(|cause| cause.to_string())?;
        let reader = SerializedFileReader::new(opened).map_err(words)?;
        let fields = reader.metadata().file_metadata().schema_descr();
        let is_same = fields.num_columns() == columns.len()
            && fields.columns().iter().zip(columns).all(|(found, column)| found.name() == column.name);
        if !is_same {
            return Err("has other columns".to_owned());
        }
        let mut rows = Vec::new();
        for row in reader.get_row_iter(None).map_err(words)? {
            let row = row.map_err(words)?;
            rows.push(row.get_column_iter().map(|(_, field)| cell(field)).collect::<Result<Vec<_>, _>>()?);
        }
        Ok(Self { columns: columns.to_vec(), rows })
    }

    /// Where a column is.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.name == name)
    }
}

/// Where the digest is in the bytes of a file.
fn place_of_digest(bytes: &[u8]) -> Option<Range<usize>> {
    let name = bytes.windows(DIGEST.len()).rposition(|window| window == DIGEST.as_bytes())?;
    let after = name + DIGEST.len();
    let is_digit = |byte: &u8| byte.is_ascii_hexdigit();
    (after..after + MAX_HEAD)
        .map(|start| start..start + BLANK.len())
        .find(|place| bytes.get(place.clone()).is_some_and(|digits| digits.iter().all(is_digit)))
}

/// Whether the digest in a file is that of its bytes.
fn is_as_written(mut bytes: Vec<u8>) -> bool {
    let Some(place) = place_of_digest(&bytes) else { return false };
    let stated = bytes[place.clone()].to_vec();
    bytes[place].copy_from_slice(&BLANK);
    sha256(&bytes).as_bytes() == stated
}

fn cell(field: &Field) -> Result<TableCell, String> {
    match field {
        Field::Null => Ok(TableCell::None),
        Field::Str(text) => Ok(TableCell::Text(text.clone())),
        Field::Double(number) => Ok(TableCell::Number(*number)),
        Field::Long(count) => Ok(TableCell::Count(*count)),
        _ => Err("has a value of an unknown kind".to_owned()),
    }
}
