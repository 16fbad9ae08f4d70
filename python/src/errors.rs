//! Converts the library's errors to Python's, one line each.

use std::{
    fmt::Display,
    fs::File,
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
};

use pyo3::{
    PyErr, PyResult,
    exceptions::{PyOSError, PyRuntimeError, PyValueError},
};

/// Returns an invalid value.
pub(crate) fn value(error: impl Display) -> PyErr {
    PyValueError::new_err(one_line(&error))
}

/// Converts an error of a file: an `OSError` if it cannot be opened, otherwise an error about its contents.
pub(crate) fn of_file(path: &Path, error: impl Display) -> PyErr {
    let is_readable = File::open(path).is_ok() && path.is_file();
    if is_readable { value(error) } else { PyOSError::new_err(one_line(&error)) }
}

fn one_line(error: &impl Display) -> String {
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Runs `work`; a panic, which is a bug of ours, becomes an ordinary error too.
pub(crate) fn guarded<T>(work: impl FnOnce() -> PyResult<T>) -> PyResult<T> {
    let broken =
        |_| Err(PyRuntimeError::new_err("a mistake inside nima; please report it with the call that led to it"));
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(broken)
}
