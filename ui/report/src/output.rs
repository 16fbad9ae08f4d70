use std::{
    io::{self, Write as _},
    path::Path,
};

use anyhow::Context as _;
use serde::Serialize;

/// Prints one JSON object on stdout. A closed pipe is not an error.
pub fn json(value: &impl Serialize) -> anyhow::Result<()> {
    line(&serde_json::to_string_pretty(value)?)
}

/// Prints a line on stdout. A closed pipe is not an error.
pub fn line(text: &str) -> anyhow::Result<()> {
    match writeln!(io::stdout().lock(), "{text}") {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

/// Returns the number as a table field, after its comma; empty for an unknown number.
pub fn cell(number: f64) -> String {
    if number.is_finite() { format!(",{number}") } else { ",".to_owned() }
}

/// Checks, before the work starts, that `out` can be written and is not an input file.
pub fn check(out: &Path, inputs: &[&Path]) -> anyhow::Result<()> {
    nima_files::check_output(out, inputs).with_context(|| format!("cannot write {}", out.display()))
}

/// Creates the results folder if necessary, and checks that files of these names can be written into it.
pub fn folder(out: &Path, names: &[&str], inputs: &[&Path]) -> anyhow::Result<()> {
    std::fs::create_dir_all(out).with_context(|| format!("cannot create the folder {}", out.display()))?;
    names.iter().try_for_each(|name| check(&out.join(name), inputs))
}

pub fn write(folder: &Path, name: &str, text: &str) -> anyhow::Result<()> {
    let path = folder.join(name);
    nima_files::write_atomically(&path, |file| file.write_all(text.as_bytes()))
        .with_context(|| format!("cannot write {}", path.display()))
}
