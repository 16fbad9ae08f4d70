//! Warnings about a session or another recording that is not whole.

use std::path::Path;

use nima_files::quoted;
use nima_recording::session::SessionReader;
use nima_screen::stderr::print_line;
use nima_session::completeness;

/// Prints what a session lacks to stderr, one line each; returns the lines.
pub(crate) fn report_missing(session: &Path, reader: &SessionReader) -> Vec<String> {
    let missing = completeness::missing(reader);
    print_missing(session, &missing);
    missing
}

/// Prints what a recording lacks to stderr, one line each.
pub(crate) fn print_missing(recording: &Path, missing: &[String]) {
    for line in missing {
        print_line(format_args!("nima: {}: {line}", quoted(&recording.display().to_string())));
    }
}
