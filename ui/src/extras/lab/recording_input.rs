//! Motion and force from a user's file: a table (CSV), an arm of a recorded session, or topics of a recording of ROS 2.

use std::{fs::File, io::Read as _, path::Path};

use anyhow::bail;
use nima_machine::rig::Side;
use nima_recording::{
    bag,
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
    if path.is_dir() {
        return Ok(bag::read(path, &mapping)?);
    }
    let reader = SessionReader::open(path)?;
    if plot_channels::arms(&reader).is_empty() && (bag::is_bag(&reader) || !map.is_empty()) {
        if arm.is_some() {
            bail!(
                "--arm applies only to sessions of this program, and {} is another recording: omit it",
                path.display()
            );
        }
        return Ok(bag::read(path, &mapping)?);
    }
    if !map.is_empty() {
        bail!(
            "--map applies only to tables and other programs' recordings, and {} is a session: omit it",
            path.display()
        );
    }
    report_missing(path, &reader);
    Ok(plot_channels::recording(path, arm)?)
}

/// Detects a session or another recording (MCAP, or the folder of a bag) by its name or by its first bytes. A pipe is not touched: data read from it are lost.
fn is_session(path: &Path) -> bool {
    let begins_so = || {
        let mut bytes = [0; MAGIC.len()];
        path.is_file() && File::open(path).and_then(|mut file| file.read_exact(&mut bytes)).is_ok() && bytes == MAGIC
    };
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mcap")) || path.is_dir() || begins_so()
}
