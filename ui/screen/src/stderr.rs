//! Messages on stderr. They are lost if stderr is closed, without a panic.

use std::{
    fmt::Display,
    io::{self, IsTerminal as _, Write as _},
};

/// Writes one line to stderr; errors are ignored.
pub fn print_line(line: impl Display) {
    writeln!(io::stderr().lock(), "{line}").ok();
}

/// Shows a line of progress instead of the previous one, if stderr is a terminal; without a line, clears it.
pub fn show_progress(line: Option<&str>) {
    let mut stderr = io::stderr().lock();
    if stderr.is_terminal() {
        write!(stderr, "\r\x1b[K{}", line.unwrap_or_default()).and_then(|()| stderr.flush()).ok();
    }
}
