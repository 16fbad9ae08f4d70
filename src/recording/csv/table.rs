//! Reads a CSV file row by row; every error states its position.

use std::path::{Path, PathBuf};

use csv::{Reader, StringRecord};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use nima_files::{self, Input, PASSAGE, quoted, shortened};

use super::{
    ColumnMapping, RecordingError,
    dialect::{Comments, CsvDialect, TableText, recognise},
    mapping::ColumnSource,
};

/// Largest deviation of a quaternion from unit length that counts as rounding.
const UNIT_TOLERANCE: f64 = 0.01;

/// A file that is being read; columns are looked up before the rows are read.
pub(super) struct CsvTable {
    path: PathBuf,
    header: StringRecord,
    dialect: CsvDialect,
    reader: Reader<TableText<Input>>,
    row: StringRecord,
}

pub(super) struct CsvColumn {
    index: usize,
    name: String,
    scale: f64,
}

impl CsvColumn {
    pub(super) fn name(&self) -> &str {
        &self.name
    }
}

impl CsvTable {
    pub(super) fn open(path: &Path) -> Result<Self, RecordingError> {
        let refused = |reason: String| RecordingError::Open { path: path.to_owned(), reason };
        let input = nima_files::open_table(path).map_err(|error| refused(error.to_string()))?;
        let (dialect, text) = recognise(input, Comments::Skipped).map_err(refused)?;
        let (reader, header) = dialect.reader(text).map_err(refused)?;
        Ok(Self { path: path.to_owned(), header, dialect, reader, row: StringRecord::new() })
    }

    /// Reads the next row; `false` at the end.
    pub(super) fn advance(&mut self) -> Result<bool, RecordingError> {
        let wrong = |error: csv::Error| RecordingError::Row { path: self.path.clone(), message: error.to_string() };
        self.reader.read_record(&mut self.row).map_err(wrong)
    }

    pub(super) fn rows<T>(
        &mut self,
        take: impl Fn(&Self) -> Result<T, RecordingError>,
    ) -> Result<Vec<T>, RecordingError> {
        let mut all = Vec::new();
        while self.advance()? {
            all.push(take(self)?);
        }
        Ok(all)
    }

    pub(super) fn line(&self) -> u64 {
        self.dialect.line(self.row.position().map_or(0, csv::Position::line))
    }

    pub(super) fn has(&self, column: &str) -> bool {
        self.header.iter().any(|name| name == column)
    }

    /// Finds the column that a mapping names; `cure` is the remedy if it is missing.
    pub(super) fn column(
        &self,
        source: &ColumnSource,
        purpose: &'static str,
        cure: &str,
    ) -> Result<CsvColumn, RecordingError> {
        let name = source.column().to_owned();
        let mut places = self.header.iter().enumerate().filter(|(_, found)| *found == name).map(|(place, _)| place);
        let found = places.next();
        if let (Some(first), Some(second)) = (found, places.next()) {
            return Err(RecordingError::Double {
                path: self.path.clone(),
                column: quoted(&name),
                first: first + 1,
                second: second + 1,
            });
        }
        match found {
            Some(index) => Ok(CsvColumn { index, name, scale: source.scale() }),
            None => Err(RecordingError::NoColumn {
                path: self.path.clone(),
                column: quoted(&name),
                purpose,
                available: shortened(&self.header.iter().collect::<Vec<_>>().join(", "), PASSAGE),
                cure: cure.to_owned(),
            }),
        }
    }

    /// Finds the columns of these quantities.
    pub(super) fn columns<const N: usize>(
        &self,
        names: [&str; N],
        mapping: &ColumnMapping,
        purpose: &'static str,
        cure: &str,
    ) -> Result<[CsvColumn; N], RecordingError> {
        let found: Result<Vec<CsvColumn>, _> =
            names.iter().map(|name| self.column(&mapping.source(name), purpose, cure)).collect();
        found?.try_into().map_err(|_| unreachable!("as many columns as names"))
    }

    /// Returns the vector in three columns.
    pub(super) fn vector(&self, [x, y, z]: &[CsvColumn; 3]) -> Result<Vector3<f64>, RecordingError> {
        Ok(Vector3::new(self.number(x)?, self.number(y)?, self.number(z)?))
    }

    /// Returns the rotation in four columns `w, x, y, z`, normalised. A quaternion more than 1 % from unit length is
    /// refused.
    pub(super) fn quaternion(&self, [w, x, y, z]: &[CsvColumn; 4]) -> Result<UnitQuaternion<f64>, RecordingError> {
        let number = |column| self.number(column);
        let quaternion = Quaternion::new(number(w)?, number(x)?, number(y)?, number(z)?);
        let length = quaternion.norm();
        if (length - 1.0).abs() > UNIT_TOLERANCE {
            return Err(RecordingError::NotARotation { path: self.path.clone(), line: self.line(), length });
        }
        Ok(UnitQuaternion::from_quaternion(quaternion))
    }

    pub(super) fn implausible(&self, what: &'static str, value: f64, cure: &'static str) -> RecordingError {
        RecordingError::Implausible { path: self.path.clone(), line: self.line(), what, value, cure }
    }

    pub(super) fn is_empty(&self, column: &CsvColumn) -> bool {
        self.row.get(column.index).is_none_or(str::is_empty)
    }

    pub(super) fn number(&self, column: &CsvColumn) -> Result<f64, RecordingError> {
        let value = self.parsed(self.field(column)).map(|value| value * column.scale);
        value.filter(|value| value.is_finite()).ok_or_else(|| self.not_a_number(column))
    }

    pub(super) fn field(&self, column: &CsvColumn) -> &str {
        self.row.get(column.index).unwrap_or_default()
    }

    /// Parses a finite number.
    pub(super) fn parsed(&self, field: &str) -> Option<f64> {
        self.dialect.number(field).filter(|value| value.is_finite())
    }

    fn not_a_number(&self, column: &CsvColumn) -> RecordingError {
        let path = self.path.clone();
        let line = self.line();
        let [name, field] = [column.name.as_str(), self.field(column)].map(quoted);
        // The dialect is found in the first rows only.
        if self.field(column).replacen(',', ".", 1).parse::<f64>().is_ok_and(f64::is_finite) {
            return RecordingError::DecimalComma { path, line, column: name, field };
        }
        RecordingError::NotANumber { path, line, column: name, field }
    }

    pub(super) fn not_a_time(&self, column: &CsvColumn) -> RecordingError {
        let path = self.path.clone();
        let line = self.line();
        RecordingError::NotATime { path, line, column: quoted(&column.name), field: quoted(self.field(column)) }
    }

    /// Returns the error for a time that does not increase.
    pub(super) fn clock(&self, before_s: f64, now_s: f64, step_s: f64) -> RecordingError {
        let path = self.path.clone();
        let line = self.line();
        if step_s == 0.0 {
            return RecordingError::SameTime { path, line, now_s };
        }
        // Rounded to microseconds for the message.
        let back_s = (-step_s * 1e6).round() / 1e6;
        RecordingError::ClockSet { path, line, before_s, now_s, back_s }
    }

    pub(super) fn unknown_unit(&self, column: &CsvColumn, unit: &'static str, rate_hz: f64) -> RecordingError {
        RecordingError::TimeUnit { path: self.path.clone(), column: quoted(&column.name), unit, rate_hz }
    }
}
