//! Motion and force from a user's file: a table (CSV), or an arm of a recorded session.

use std::{fs::File, io::Read as _, path::Path};

use anyhow::bail;
use nima_machine::rig::Side;
use nima_recording::{
    csv::{ColumnMapping, CsvRecording},
    session::SessionReader,
};
use nima_session::plot_channels;

use crate::command::missing::report_missing;

/// First bytes of a session.
const MAGIC: [u8; 5] = *b"\x89MCAP";

/// Reads a recording; `map` applies to tables, `arm` to sessions. The leader's own motion is rejected, because callers
/// do not use it.
pub(super) fn read(path: &Path, map: &[String], arm: Option<Side>) -> anyhow::Result<CsvRecording> {
    if ColumnMapping::parse(map)?.names_leader() {
        bail!("--map selects the leader's own motion, which only nima identify uses: omit it");
    }
    read_with_leader(path, map, arm)
}

/// Like [`read`], with the leader's own motion if it is mapped.
pub(super) fn read_with_leader(path: &Path, map: &[String], arm: Option<Side>) -> anyhow::Result<CsvRecording> {
    let mapping = ColumnMapping::parse(map)?;
    if !is_session(path) {
        if arm.is_some() {
            bail!("--arm applies only to sessions, and {} is a table: omit it", path.display());
        }
        return Ok(CsvRecording::read(path, &mapping)?);
    }
    if !map.is_empty() {
        bail!("--map applies only to tables, and {} is a session: omit it", path.display());
    }
    report_missing(path, &SessionReader::open(path)?);
    Ok(plot_channels::recording(path, arm)?)
}

/// Detects a session by its name or by its first bytes. A pipe is not touched: data read from it are lost.
fn is_session(path: &Path) -> bool {
    let begins_so = || {
        let mut bytes = [0; MAGIC.len()];
        path.is_file() && File::open(path).and_then(|mut file| file.read_exact(&mut bytes)).is_ok() && bytes == MAGIC
    };
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mcap")) || begins_so()
}
