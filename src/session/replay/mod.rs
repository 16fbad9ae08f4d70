//! Replays a journal through the loop that recorded it: the same code, the same inputs, so the same bits.

mod cursor;
mod machine;
mod side_by_side;
mod steps;
mod verify;
mod what_if;

use std::io;

use nima_core::impedance::SettingsError;
use nima_machine::rig::Side;

pub use cursor::{Cursor, Keyframe, Moment, Passed};
pub use machine::Machine;
pub use steps::{Journal, Messages, Numbered, Part, Step, decoded};
pub use verify::verify;
pub use what_if::{Change, Compared, Difference, compare};

use nima_recording::session::ReadError;

use crate::{digest::Stage, journal::JournalError};

/// Why a session cannot be replayed.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// A message of the journal cannot be read.
    #[error("message {place} of its journal: {source}")]
    Message { place: u64, source: JournalError },
    /// Messages are missing.
    #[error("message {place} of its journal is missing: the file was cut or damaged")]
    Missing { place: u64 },
    /// There is no beginning.
    #[error("its journal does not say what the loop was made of: the file was cut or damaged")]
    NoStart,
    /// There is no journal at all.
    #[error("it holds no journal: only a session that was recorded with `nima run --record` can be replayed")]
    NoJournal,
    /// An operation names calibrations that are not there.
    #[error("calibrations number {number} come into force at tick {tick}, and the file does not have them")]
    NoCalibrations { number: u64, tick: u64 },
    /// The settings of the rig are not usable, as recorded or as changed.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The file itself.
    #[error(transparent)]
    File(#[from] ReadError),
    /// The operating system gives no thread.
    #[error("cannot start the thread that reads the journal: {0}; end other programs, then try again")]
    Thread(#[source] io::Error),
}

/// The first tick that is not as it was recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Differs {
    /// Its number in the journal, from 0.
    pub tick: u64,
    /// Its time on the loop's clock, s.
    pub t_s: f64,
    /// The first part of the tick that differs; `None`: an event does.
    pub place: Option<(Side, Stage)>,
}

/// Entries that are missing in the journal: from there on nothing can be replayed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hole {
    /// Ticks before it.
    pub tick: u64,
    /// Entries that were dropped.
    pub lost: u64,
}

/// How a replay ended.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Ticks that were replayed and compared.
    pub ticks: u64,
    /// Ticks before them that were replayed only.
    pub before: u64,
    /// Loop time of the last one, s.
    pub seconds: f64,
    /// The first tick that differs; the replay ends there.
    pub differs: Option<Differs>,
    /// Where the journal has a hole; the replay ends there.
    pub hole: Option<Hole>,
    /// The recording was closed; if not, it was killed, or the file was cut.
    pub closed: bool,
}

/// Whether a tick at this loop time (s) is not before a moment: times in the file are whole nanoseconds.
fn is_from(now_s: f64, moment_s: f64) -> bool {
    (now_s * 1e9).round() >= (moment_s * 1e9).round()
}

/// Replays a journal to its end, to its first hole or to the first tick that differs. `each` is called with every tick; where only the
/// outcome matters, [`verify`] is faster.
///
/// # Errors
/// [`ReplayError`] if the journal cannot be read.
pub fn replay<I: Iterator<Item = Result<Numbered, ReplayError>>>(
    journal: Journal<I>,
    mut each: impl FnMut(&Moment<'_>),
) -> Result<Outcome, ReplayError> {
    let mut cursor = Cursor::new(journal)?;
    let mut outcome = Outcome::default();
    while let Some(passed) = cursor.step()? {
        match passed {
            Passed::Closed => outcome.closed = true,
            Passed::Hole(hole) => {
                outcome.hole = Some(hole);
                break;
            }
            Passed::Tick(moment) => {
                each(&moment);
                outcome.seconds = moment.row.timing.now_s;
                outcome.differs = moment.differs();
                if outcome.differs.is_some() {
                    break;
                }
                outcome.ticks += 1;
            }
        }
    }
    Ok(outcome)
}
