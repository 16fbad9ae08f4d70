//! What commands print.

use std::io::{self, Write as _};

use serde::Serialize;

/// Prints one JSON object on stdout. A reader that has gone away is not an error.
pub(super) fn json(value: &impl Serialize) -> anyhow::Result<()> {
    line(&serde_json::to_string_pretty(value)?)
}

/// Prints text and a line break on stdout. A reader that has gone away is not an error.
pub(super) fn line(text: &str) -> anyhow::Result<()> {
    match writeln!(io::stdout().lock(), "{text}") {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}
