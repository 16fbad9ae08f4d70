//! Messages on stderr. They are lost if stderr is closed, without a panic.

use std::{
    fmt::Display,
    io::{self, Write as _},
};

/// Writes one line to stderr; errors are ignored.
pub fn print_line(line: impl Display) {
    writeln!(io::stderr().lock(), "{line}").ok();
}
