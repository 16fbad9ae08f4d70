//! Tests that could not judge. Cargo reports only passed and failed, so such a test returns and writes one line to
//! standard error; `./dev test` lists these lines and fails on them.

use std::{
    fmt::Display,
    io::Write as _,
    path::{Path, PathBuf},
    thread::current,
};

/// Returns the path of a real recording, `../shared/data/FILE` as seen from the workspace. The recordings are not part of the repository:
/// `None`, reported as `data absent`, if there is no such file.
pub fn recording(file: &str) -> Option<PathBuf> {
    let path = data_folder().join(file);
    let found = path.is_file();
    if !found {
        report("data absent", &path.display());
    }
    found.then_some(path)
}

/// Reports as `left out` that the test needs a program or a permission that this machine lacks.
pub fn left_out(reason: &str) {
    report("left out", &reason);
}

/// Reports as `not judged` that the machine was too busy.
pub(crate) fn too_busy() {
    report("not judged", &"too busy");
}

fn report(what: &str, reason: &dyn Display) {
    let line = line(what, current().name().unwrap_or("a test"), reason);
    // `eprintln!` is hidden when the test passes. One write call keeps other output from mixing with the line.
    let _ = std::io::stderr().write_all(line.as_bytes());
}

/// `./dev test` and `tests/windows/run.py` read this line.
fn line(what: &str, test: &str, reason: &dyn Display) -> String {
    format!("{what}: {test} ({reason})\n")
}

fn data_folder() -> PathBuf {
    let this_crate = Path::new(env!("CARGO_MANIFEST_DIR"));
    let workspace = this_crate.ancestors().find(|folder| folder.join("Cargo.lock").is_file());
    workspace.unwrap_or(this_crate).join("../shared/data")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_data_are_beside_the_workspace() {
        let workspace = data_folder().join("../../").canonicalize();
        // Without the folder `shared` the path leads nowhere.
        assert!(workspace.is_err() || !workspace.unwrap().join("Cargo.lock").exists());
        let text = std::fs::read_to_string(data_folder().ancestors().nth(3).unwrap().join("Cargo.toml")).unwrap();
        assert!(text.contains("[workspace]"));
    }

    #[test]
    fn a_test_and_its_reason_are_one_line() {
        assert_eq!(line("data absent", "module::a_test", &"a/b.csv"), "data absent: module::a_test (a/b.csv)\n");
    }
}
