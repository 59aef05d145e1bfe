//! How every CSV file is written.

use crate::output::ReportError;
use crate::units::Unit;
use nalgebra::Vector3;

/// Three fields of a vector.
pub(crate) fn vector(unit: Unit, vector: &Vector3<f64>) -> [String; 3] {
    [vector.x, vector.y, vector.z].map(|value| unit.text(value))
}

/// A CSV file with the names of its columns.
pub(crate) fn table(
    what: &'static str,
    header: impl IntoIterator<Item = impl AsRef<[u8]>>,
    rows: impl IntoIterator<Item = Vec<String>>,
) -> Result<Vec<u8>, ReportError> {
    let fail = |cause: csv::Error| ReportError::Format { what, cause: cause.to_string() };
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header).map_err(fail)?;
    for row in rows {
        writer.write_record(&row).map_err(fail)?;
    }
    writer.into_inner().map_err(|error| ReportError::Format { what, cause: error.to_string() })
}
