//! Conversion of numpy arrays: read without a copy, and returned without a copy.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use numpy::{
    Element, PyArray1, PyArray2, PyArray3, PyArrayMethods as _, PyReadonlyArray1, PyReadonlyArray2,
    ndarray::{ArrayView1, ArrayView2},
};
use pyo3::{Bound, PyResult, Python};

use crate::errors::value;

/// Largest deviation of a quaternion from unit length that counts as rounding, as in files.
const UNIT_TOLERANCE: f64 = 0.01;

/// One array for each axis, with any memory layout.
pub(crate) struct ArrayAxes<'a> {
    name: &'static str,
    columns: Vec<ArrayView1<'a, f64>>,
}

impl<'a> ArrayAxes<'a> {
    /// Checks that all have the same length and are finite.
    pub(crate) fn new(name: &'static str, arrays: &'a [PyReadonlyArray1<'_, f64>]) -> PyResult<Self> {
        let columns: Vec<_> = arrays.iter().map(PyReadonlyArray1::as_array).collect();
        let this = Self { name, columns };
        let rows = this.rows();
        for (axis, column) in this.columns.iter().enumerate() {
            if column.len() != rows {
                return Err(value(format_args!("{name}: axis {axis} has {} samples, axis 0 has {rows}", column.len())));
            }
        }
        for row in 0..rows {
            if let Some(column) = this.columns.iter().find(|column| !column[row].is_finite()) {
                return Err(not_finite(name, row, column[row]));
            }
        }
        Ok(this)
    }

    pub(crate) fn count(&self) -> usize {
        self.columns.len()
    }

    pub(crate) fn rows(&self) -> usize {
        self.columns.first().map_or(0, ArrayView1::len)
    }

    /// Returns the vector of a row; zero beyond its axes.
    pub(crate) fn at(&self, row: usize) -> Vector3<f64> {
        let mut vector = Vector3::zeros();
        for (lane, column) in self.columns.iter().enumerate() {
            vector[lane] = column[row];
        }
        vector
    }

    /// Checks that both arrays have the same shape.
    pub(crate) fn fits(&self, other: &Self) -> PyResult<()> {
        if (self.count(), self.rows()) == (other.count(), other.rows()) {
            return Ok(());
        }
        Err(value(format_args!(
            "{} has the shape ({}, {}), {} has ({}, {}); both need one row for each sample and one column for each axis",
            self.name,
            self.rows(),
            self.count(),
            other.name,
            other.rows(),
            other.count()
        )))
    }
}

fn not_finite(name: &str, row: usize, number: f64) -> pyo3::PyErr {
    value(format_args!("{name}, row {row}: {number} is not a finite number; remove or repair the row"))
}

/// Checks that times (s) rise.
pub(crate) fn rising(times_s: &ArrayView1<'_, f64>) -> PyResult<()> {
    for (row, now_s) in times_s.iter().enumerate() {
        if !now_s.is_finite() {
            return Err(not_finite("times_s", row, *now_s));
        }
        let before_s = if row > 0 { times_s[row - 1] } else { f64::NEG_INFINITY };
        if *now_s <= before_s {
            return Err(value(format_args!(
                "times_s, row {row}: time does not increase ({before_s} s, then {now_s} s); sort the rows and remove duplicates"
            )));
        }
    }
    Ok(())
}

/// Checks that a table has this many columns, only finite values, and `rows` rows if given.
pub(crate) fn table<'a>(
    name: &str,
    array: &'a PyReadonlyArray2<'_, f64>,
    columns: usize,
    rows: Option<usize>,
) -> PyResult<ArrayView2<'a, f64>> {
    let view = array.as_array();
    let (found_rows, found) = view.dim();
    if found != columns || rows.is_some_and(|rows| rows != found_rows) {
        let wanted = rows.map_or_else(|| "n".to_owned(), |rows| rows.to_string());
        return Err(value(format_args!(
            "{name} has the shape ({found_rows}, {found}); give the shape ({wanted}, {columns})"
        )));
    }
    if let Some(((row, _), number)) = view.indexed_iter().find(|(_, number)| !number.is_finite()) {
        return Err(not_finite(name, row, *number));
    }
    Ok(view)
}

/// Returns the vector in a row.
pub(crate) fn vector(table: &ArrayView2<'_, f64>, row: usize) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| table[[row, axis]])
}

/// Returns the rotation (w, x, y, z) in a row, normalised.
pub(crate) fn rotation(name: &str, table: &ArrayView2<'_, f64>, row: usize) -> PyResult<UnitQuaternion<f64>> {
    let part = |column: usize| table[[row, column]];
    let quaternion = Quaternion::new(part(0), part(1), part(2), part(3));
    let length = quaternion.norm();
    if (length - 1.0).abs() > UNIT_TOLERANCE {
        return Err(value(format_args!(
            "{name}, row {row}: the quaternion has length {length:.3} instead of 1; remove or repair the row"
        )));
    }
    Ok(UnitQuaternion::from_quaternion(quaternion))
}

/// Returns numbers as a two-dimensional array, row by row.
pub(crate) fn given2<T: Element>(py: Python<'_>, numbers: Vec<T>, columns: usize) -> PyResult<Bound<'_, PyArray2<T>>> {
    let rows = numbers.len() / columns.max(1);
    PyArray1::from_vec(py, numbers).reshape([rows, columns])
}

/// Returns numbers as a three-dimensional array.
pub(crate) fn given3<T: Element>(
    py: Python<'_>,
    numbers: Vec<T>,
    [second, third]: [usize; 2],
) -> PyResult<Bound<'_, PyArray3<T>>> {
    let rows = numbers.len() / (second * third).max(1);
    PyArray1::from_vec(py, numbers).reshape([rows, second, third])
}
