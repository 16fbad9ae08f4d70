//! Motion and force of what a user names: a table (CSV), or an arm of a recorded session.

use std::{fs::File, io::Read as _, path::Path};

use anyhow::bail;
use nima_machine::rig::Side;
use nima_recording::csv::{Mapping, Recording};
use nima_session::plotted;

/// First bytes of a session.
const MAGIC: [u8; 5] = *b"\x89MCAP";

/// Reads one; `map` is for tables, `arm` for sessions. The leader's own motion is refused: what is asked here makes nothing of it.
pub(super) fn read(path: &Path, map: &[String], arm: Option<Side>) -> anyhow::Result<Recording> {
    if Mapping::parse(map)?.names_leader() {
        bail!("--map names the leader's own motion, which only nima identify uses: leave it away");
    }
    read_with_leader(path, map, arm)
}

/// The same with the leader's own motion, if it is mapped.
pub(super) fn read_with_leader(path: &Path, map: &[String], arm: Option<Side>) -> anyhow::Result<Recording> {
    let mapping = Mapping::parse(map)?;
    if !is_session(path) {
        if arm.is_some() {
            bail!("--arm chooses an arm of a session, and {} is a table: leave it away", path.display());
        }
        return Ok(Recording::read(path, &mapping)?);
    }
    if !map.is_empty() {
        bail!("--map names columns of a table, and {} is a session: leave it away", path.display());
    }
    Ok(plotted::recording(path, arm)?)
}

/// By its name or, whatever its name, by its first bytes. A pipe is not touched: what is read from it is gone.
fn is_session(path: &Path) -> bool {
    let begins_so = || {
        let mut bytes = [0; MAGIC.len()];
        path.is_file() && File::open(path).and_then(|mut file| file.read_exact(&mut bytes)).is_ok() && bytes == MAGIC
    };
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mcap")) || begins_so()
}
