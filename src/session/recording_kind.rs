//! The kind of a recording that a user names.

use std::{fs::File, io::Read as _, path::Path};

use nima_recording::{
    bag,
    session::{ReadError, SessionReader},
};

use crate::plot_channels;

/// First bytes of an MCAP file.
const MAGIC: [u8; 5] = *b"\x89MCAP";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordingKind {
    /// CSV.
    Table,
    /// MCAP of another program, or the folder of a bag.
    Bag,
    /// Recorded by this program.
    Session,
}

impl RecordingKind {
    /// Detects the kind by the name, the first bytes and the channels; `is_mapped`: quantities are mapped, so that an MCAP
    /// file without arms is not a session. A pipe is not touched: data read from it are lost.
    ///
    /// # Errors
    /// [`ReadError`] if an MCAP file cannot be read.
    pub fn of(path: &Path, is_mapped: bool) -> Result<Self, ReadError> {
        if path.is_dir() {
            return Ok(Self::Bag);
        }
        if !is_mcap(path) {
            return Ok(Self::Table);
        }
        let reader = SessionReader::open(path)?;
        let is_foreign = plot_channels::arms(&reader).is_empty() && (is_mapped || bag::is_bag(&reader));
        Ok(if is_foreign { Self::Bag } else { Self::Session })
    }
}

fn is_mcap(path: &Path) -> bool {
    let begins_so = || {
        let mut bytes = [0; MAGIC.len()];
        path.is_file() && File::open(path).and_then(|mut file| file.read_exact(&mut bytes)).is_ok() && bytes == MAGIC
    };
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mcap")) || begins_so()
}
