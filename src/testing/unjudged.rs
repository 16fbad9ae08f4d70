//! Tests that could not judge. Cargo reports only passed and failed, so such a test returns and writes one line to
//! standard error; `./dev test` lists these lines and fails on them.

use std::{
    fmt::Display,
    io::Write as _,
    path::{Path, PathBuf},
    thread::current,
};

/// Returns the path of a real recording in `../shared/data`; see [`shared`].
pub fn recording(file: &str) -> Option<PathBuf> {
    shared(&format!("data/{file}"))
}

/// Returns the path `../shared/FILE` as seen from the workspace. These files are not part of the repository: `None`, reported
/// as `data absent`, if there is no such file.
pub fn shared(file: &str) -> Option<PathBuf> {
    let path = shared_folder().join(file);
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

fn shared_folder() -> PathBuf {
    let this_crate = Path::new(env!("CARGO_MANIFEST_DIR"));
    let workspace = this_crate.ancestors().find(|folder| folder.join("Cargo.lock").is_file());
    workspace.unwrap_or(this_crate).join("../shared")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_data_are_beside_the_workspace() {
        let around = shared_folder().join("..").canonicalize();
        // Without the folder `shared` the path leads nowhere.
        assert!(around.is_err() || !around.unwrap().join("Cargo.lock").exists());
        let text = std::fs::read_to_string(shared_folder().ancestors().nth(2).unwrap().join("Cargo.toml")).unwrap();
        assert!(text.contains("[workspace]"));
    }

    #[test]
    fn a_test_and_its_reason_are_one_line() {
        assert_eq!(line("data absent", "module::a_test", &"a/b.csv"), "data absent: module::a_test (a/b.csv)\n");
    }
}
