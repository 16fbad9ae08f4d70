//! Motion and force from a user's file: a table (CSV), an arm of a recorded session, or topics of a recording of ROS 2.

use std::path::Path;

use anyhow::bail;
use nima_machine::rig::Side;
use nima_recording::{
    bag,
    csv::{ColumnMapping, CsvRecording},
    session::SessionReader,
};
use nima_session::{RecordingKind, plot_channels};

use crate::command::missing::{print_missing, report_missing};

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
    match RecordingKind::of(path, !map.is_empty())? {
        RecordingKind::Table if arm.is_some() => {
            bail!("--arm applies only to sessions, and {} is a table: omit it", path.display())
        }
        RecordingKind::Bag if arm.is_some() => bail!(
            "--arm applies only to sessions of this program, and {} is another recording: omit it",
            path.display()
        ),
        RecordingKind::Session if !map.is_empty() => bail!(
            "--map applies only to tables and other programs' recordings, and {} is a session: omit it",
            path.display()
        ),
        RecordingKind::Table => Ok(CsvRecording::read(path, &mapping)?),
        RecordingKind::Bag => {
            let recording = bag::read(path, &mapping)?;
            print_missing(path, &bag::missing(path)?);
            Ok(recording)
        }
        RecordingKind::Session => {
            report_missing(path, &SessionReader::open(path)?);
            Ok(plot_channels::recording(path, arm)?)
        }
    }
}
