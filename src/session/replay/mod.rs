//! Replays a journal through the loop that recorded it: the same code and the same inputs, so the same bits.

mod cursor;
mod machine;
mod side_by_side;
mod steps;
mod verify;
mod what_if;

use std::io;

use nima_core::impedance::SettingsError;
use nima_machine::rig::Side;

pub use cursor::{CursorEvent, Keyframe, ReplayCursor, SessionMoment};
pub use machine::ReplayMachine;
pub use steps::{Journal, JournalPart, NumberedMessage, ReplayStep, StepsMessages, decoded};
pub use verify::verify;
pub use what_if::{ComparedSide, Difference, WhatIfChange, compare};

use nima_recording::session::ReadError;

use crate::{digest::TickStage, journal::JournalError};

#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    #[error("message {place} of its journal: {source}")]
    Message { place: u64, source: JournalError },
    #[error("message {place} of its journal is missing: the file was cut or damaged")]
    Missing { place: u64 },
    #[error("its journal has no beginning: the file was cut or damaged")]
    NoStart,
    #[error("it has no journal, so it cannot be replayed; of an excerpt, replay the session from which it was saved")]
    NoJournal,
    #[error(
        "calibration set {number} becomes active at tick {tick}, but the file does not contain it: the file was cut or damaged"
    )]
    NoCalibrations { number: u64, tick: u64 },
    /// The settings of the rig, as recorded or as changed, are not usable.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    #[error(transparent)]
    File(#[from] ReadError),
    #[error("cannot start the thread that reads the journal: {0}; end other programs, then try again")]
    Thread(#[source] io::Error),
}

/// The first tick that differs from the recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Differs {
    /// Number in the journal, from 0.
    pub tick: u64,
    /// Time on the loop's clock, s.
    pub t_s: f64,
    /// The first stage of the tick that differs; `None` if an event differs.
    pub place: Option<(Side, TickStage)>,
}

/// A gap in the journal: nothing after it can be replayed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JournalGap {
    /// Number of ticks before it.
    pub tick: u64,
    /// Number of dropped entries.
    pub lost: u64,
}

/// Result of a replay.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReplayOutcome {
    /// Ticks that were replayed and compared.
    pub ticks: u64,
    /// Earlier ticks that were only replayed.
    pub before: u64,
    /// Loop time of the last tick, s.
    pub seconds: f64,
    /// The first tick that differs; the replay ends there.
    pub differs: Option<Differs>,
    /// The gap at which the replay ended.
    pub hole: Option<JournalGap>,
    /// Whether the recording was closed; if not, the program was killed, or the file was cut.
    pub closed: bool,
}

/// Returns whether a tick at this loop time (s) is not before a moment; allows for the whole nanoseconds of times in
/// the file.
fn is_from(now_s: f64, moment_s: f64) -> bool {
    (now_s * 1e9).round() >= (moment_s * 1e9).round()
}

/// Replays a journal to its end, to its first gap or to the first tick that differs. `each` is called with every tick;
/// if only the outcome matters, [`verify`] is faster.
///
/// # Errors
/// [`ReplayError`] if the journal cannot be read.
pub fn replay<I: Iterator<Item = Result<NumberedMessage, ReplayError>>>(
    journal: Journal<I>,
    mut each: impl FnMut(&SessionMoment<'_>),
) -> Result<ReplayOutcome, ReplayError> {
    let mut cursor = ReplayCursor::new(journal)?;
    let mut outcome = ReplayOutcome::default();
    while let Some(passed) = cursor.step()? {
        match passed {
            CursorEvent::Closed => outcome.closed = true,
            CursorEvent::Hole(hole) => {
                outcome.hole = Some(hole);
                break;
            }
            CursorEvent::Tick(moment) => {
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
