//! What the program says on stderr. Nobody may be there to read it any more: that is no reason to panic.

use std::{
    fmt::Display,
    io::{self, Write as _},
};

/// Writes one line on stderr; a stderr that is closed swallows it.
pub fn tell(line: impl Display) {
    writeln!(io::stderr().lock(), "{line}").ok();
}
