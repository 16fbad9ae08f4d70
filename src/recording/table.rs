//! A CSV file in memory, with every complaint naming its place.

use std::path::{Path, PathBuf};

use csv::{ReaderBuilder, StringRecord, Trim};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::{Mapping, RecordingError, mapping::Source};

/// A quaternion may depart from length one by this much: rounding in a file, not an error.
const UNIT_TOLERANCE: f64 = 0.01;

/// All rows of a file, as text.
pub(super) struct Table {
    path: PathBuf,
    header: StringRecord,
    rows: Vec<StringRecord>,
}

/// A column found in a table.
pub(super) struct Column {
    index: usize,
    name: String,
    scale: f64,
}

impl Table {
    pub(super) fn read(path: &Path) -> Result<Self, RecordingError> {
        let open = |error: csv::Error| RecordingError::Open { path: path.to_owned(), reason: error.to_string() };
        let mut reader = ReaderBuilder::new().trim(Trim::All).comment(Some(b'#')).from_path(path).map_err(open)?;
        let header = reader.headers().map_err(open)?.clone();
        let mut rows = Vec::new();
        for row in reader.into_records() {
            let wrong = |error: csv::Error| RecordingError::Row { path: path.to_owned(), message: error.to_string() };
            rows.push(row.map_err(wrong)?);
        }
        Ok(Self { path: path.to_owned(), header, rows })
    }

    pub(super) fn rows(&self) -> usize {
        self.rows.len()
    }

    pub(super) fn line(&self, row: usize) -> u64 {
        self.rows[row].position().map_or(0, csv::Position::line)
    }

    pub(super) fn has(&self, column: &str) -> bool {
        self.header.iter().any(|name| name == column)
    }

    /// The column that a mapping names; `cure` says what to do where it is missing.
    pub(super) fn column(&self, source: &Source, purpose: &'static str, cure: &str) -> Result<Column, RecordingError> {
        let name = source.column().to_owned();
        match self.header.iter().position(|found| found == name) {
            Some(index) => Ok(Column { index, name, scale: source.scale() }),
            None => Err(RecordingError::NoColumn {
                path: self.path.clone(),
                column: name,
                purpose,
                available: self.header.iter().collect::<Vec<_>>().join(", "),
                cure: cure.to_owned(),
            }),
        }
    }

    /// Columns of fixed names.
    pub(super) fn columns<const N: usize>(
        &self,
        names: [&str; N],
        purpose: &'static str,
        cure: &str,
    ) -> Result<[Column; N], RecordingError> {
        let mapping = Mapping::default();
        let found: Result<Vec<Column>, _> =
            names.iter().map(|name| self.column(&mapping.source(name), purpose, cure)).collect();
        found?.try_into().map_err(|_| unreachable!("as many columns as names"))
    }

    /// A vector of three columns.
    pub(super) fn vector(&self, row: usize, [x, y, z]: &[Column; 3]) -> Result<Vector3<f64>, RecordingError> {
        Ok(Vector3::new(self.number(row, x)?, self.number(row, y)?, self.number(row, z)?))
    }

    /// A rotation of four columns `w, x, y, z`, normalised; one further than 1 % from unit length is refused.
    pub(super) fn rotation(
        &self,
        row: usize,
        [w, x, y, z]: &[Column; 4],
    ) -> Result<UnitQuaternion<f64>, RecordingError> {
        let number = |column| self.number(row, column);
        let quaternion = Quaternion::new(number(w)?, number(x)?, number(y)?, number(z)?);
        let length = quaternion.norm();
        if (length - 1.0).abs() > UNIT_TOLERANCE {
            return Err(RecordingError::NotARotation { path: self.path.clone(), line: self.line(row), length });
        }
        Ok(UnitQuaternion::from_quaternion(quaternion))
    }

    pub(super) fn number(&self, row: usize, column: &Column) -> Result<f64, RecordingError> {
        let field = self.rows[row].get(column.index).unwrap_or_default();
        match field.parse::<f64>() {
            Ok(value) if (value * column.scale).is_finite() => Ok(value * column.scale),
            _ => Err(RecordingError::NotANumber {
                path: self.path.clone(),
                line: self.line(row),
                column: column.name.clone(),
                field: field.to_owned(),
            }),
        }
    }
}
