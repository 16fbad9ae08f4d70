//! Opens a file with the user's program for it.

use std::{
    path::Path,
    process::{Command, Stdio},
};

/// Program that opens a file on this desktop.
const OPENER: &[&str] = if cfg!(target_os = "macos") {
    &["open"]
} else if cfg!(windows) {
    &["cmd", "/C", "start", ""]
} else {
    &["xdg-open"]
};

/// Returns false if no program can open the file. May block for as long as that program runs, so do not call it on the
/// window's thread.
pub fn open(path: &Path) -> bool {
    open_with(OPENER, path)
}

fn open_with(opener: &[&str], path: &Path) -> bool {
    let Some((program, arguments)) = opener.split_first() else { return false };
    let mut command = Command::new(program);
    command.args(arguments).arg(path).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

// These tests use a program that every Unix has.
#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn an_opener_gets_the_file_and_one_that_is_not_there_or_fails_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a page.html");
        assert!(!open_with(&["test", "-f"], &file));
        std::fs::write(&file, "x").unwrap();
        assert!(open_with(&["test", "-f"], &file));
        assert!(!open_with(&["no-such-program-anywhere"], &file));
        assert!(!open_with(&[], &file));
    }
}
