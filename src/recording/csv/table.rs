//! Reads a CSV file row by row; every error states its position.

use std::path::{Path, PathBuf};

use csv::{Reader, ReaderBuilder, StringRecord, Trim};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use nima_files::{self, Input, PASSAGE, quoted, shortened};

use super::{ColumnMapping, RecordingError, mapping::ColumnSource};

/// Largest deviation of a quaternion from unit length that counts as rounding.
const UNIT_TOLERANCE: f64 = 0.01;

/// A file that is being read; columns are looked up before the rows are read.
pub(super) struct CsvTable {
    path: PathBuf,
    header: StringRecord,
    reader: Reader<Input>,
    row: StringRecord,
}

pub(super) struct CsvColumn {
    index: usize,
    name: String,
    scale: f64,
}

impl CsvTable {
    pub(super) fn open(path: &Path) -> Result<Self, RecordingError> {
        let refused = |reason: String| RecordingError::Open { path: path.to_owned(), reason };
        let input = nima_files::open_table(path).map_err(|error| refused(error.to_string()))?;
        let mut reader = ReaderBuilder::new().trim(Trim::All).comment(Some(b'#')).from_reader(input);
        let header = reader.headers().map_err(|error| refused(error.to_string()))?.clone();
        Ok(Self { path: path.to_owned(), header, reader, row: StringRecord::new() })
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
        self.row.position().map_or(0, csv::Position::line)
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
        match self.header.iter().position(|found| found == name) {
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

    /// Finds columns of fixed names.
    pub(super) fn columns<const N: usize>(
        &self,
        names: [&str; N],
        purpose: &'static str,
        cure: &str,
    ) -> Result<[CsvColumn; N], RecordingError> {
        let mapping = ColumnMapping::default();
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
    pub(super) fn rotation(&self, [w, x, y, z]: &[CsvColumn; 4]) -> Result<UnitQuaternion<f64>, RecordingError> {
        let number = |column| self.number(column);
        let quaternion = Quaternion::new(number(w)?, number(x)?, number(y)?, number(z)?);
        let length = quaternion.norm();
        if (length - 1.0).abs() > UNIT_TOLERANCE {
            return Err(RecordingError::NotARotation { path: self.path.clone(), line: self.line(), length });
        }
        Ok(UnitQuaternion::from_quaternion(quaternion))
    }

    pub(super) fn is_empty(&self, column: &CsvColumn) -> bool {
        self.row.get(column.index).is_none_or(str::is_empty)
    }

    pub(super) fn number(&self, column: &CsvColumn) -> Result<f64, RecordingError> {
        let field = self.row.get(column.index).unwrap_or_default();
        match field.parse::<f64>() {
            Ok(value) if (value * column.scale).is_finite() => Ok(value * column.scale),
            _ => Err(RecordingError::NotANumber {
                path: self.path.clone(),
                line: self.line(),
                column: quoted(&column.name),
                field: quoted(field),
            }),
        }
    }
}
