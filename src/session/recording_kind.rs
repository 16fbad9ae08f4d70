//! The kind of a recording that a user names.

use std::{fs::File, io::Read as _, path::Path};

use nima_recording::{
    bag::{self, BagError},
    csv::{self, ColumnMapping, RecordingError, Signals},
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

/// Why a recording is not shown.
#[derive(Debug, thiserror::Error)]
pub enum OpenSignalsError {
    #[error(transparent)]
    Read(#[from] ReadError),
    #[error(transparent)]
    Table(#[from] RecordingError),
    #[error(transparent)]
    Bag(#[from] BagError),
}

impl OpenSignalsError {
    /// Returns whether the recording has other names than expected, so that a mapping helps.
    pub const fn needs_mapping(&self) -> bool {
        matches!(
            self,
            Self::Table(RecordingError::NoColumn { .. })
                | Self::Bag(BagError::NoMapping { .. } | BagError::NoField { .. } | BagError::NoQuantity { .. })
        )
    }
}

/// Reads the signals of another program's recording; `None` for a session. `is_mapped`: see [`RecordingKind::of`].
///
/// # Errors
/// [`OpenSignalsError`] if it cannot be read, or lacks the mapped quantities.
pub fn open_signals(
    path: &Path,
    mapping: &ColumnMapping,
    is_mapped: bool,
) -> Result<Option<Signals>, OpenSignalsError> {
    Ok(match RecordingKind::of(path, is_mapped)? {
        RecordingKind::Session => None,
        RecordingKind::Table => Some(csv::read_signals(path, mapping)?),
        RecordingKind::Bag => Some(bag::read_signals(path, mapping)?),
    })
}

fn is_mcap(path: &Path) -> bool {
    let begins_so = || {
        let mut bytes = [0; MAGIC.len()];
        path.is_file() && File::open(path).and_then(|mut file| file.read_exact(&mut bytes)).is_ok() && bytes == MAGIC
    };
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mcap")) || begins_so()
}
