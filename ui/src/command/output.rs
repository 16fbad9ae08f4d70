//! What commands print.

use std::{
    io::{self, Write as _},
    path::Path,
};

use anyhow::Context as _;
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

/// Looks, before the work, whether it can be written to `out`, which is none of the files that are read.
pub(super) fn check(out: &Path, inputs: &[&Path]) -> anyhow::Result<()> {
    nima_files::check_output(out, inputs).with_context(|| format!("cannot write {}", out.display()))
}

/// Makes the folder for results, where it is absent, and looks whether files of these names can be written into it.
pub(super) fn folder(out: &Path, names: &[&str], inputs: &[&Path]) -> anyhow::Result<()> {
    std::fs::create_dir_all(out).with_context(|| format!("cannot create the folder {}", out.display()))?;
    names.iter().try_for_each(|name| check(&out.join(name), inputs))
}

/// Writes one result into its folder.
pub(super) fn write(folder: &Path, name: &str, text: &str) -> anyhow::Result<()> {
    let path = folder.join(name);
    nima_files::write_atomically(&path, |file| file.write_all(text.as_bytes()))
        .with_context(|| format!("cannot write {}", path.display()))
}
