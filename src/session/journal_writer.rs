//! Converts the entries of a loop's tap into the messages of a journal.

use std::collections::BTreeMap;

use nima_machine::{
    messages::Event,
    runtime::{Operation, TapEnd, TapEntry, TapPayload, TickRecord},
    teleop::Calibrations,
};

use crate::journal::{BlockWriter, JournalEncoder, JournalEnd, JournalError, JournalStart, TickNote};

/// A message of the journal, and the loop time that it belongs to (s).
#[derive(Clone, Debug)]
pub struct TimedMessage {
    /// Loop time of its last tick, s. It never falls, so that the messages keep their order.
    pub t_s: f64,
    pub bytes: Vec<u8>,
}

/// Receives a journal and the other records of a session.
pub trait Pages {
    /// Reason why it cannot accept more.
    type Error: From<JournalError>;

    /// Called for a message of the journal.
    ///
    /// # Errors
    /// The destination's errors.
    fn write(&mut self, written: &TimedMessage) -> Result<(), Self::Error>;

    /// Called for a tick and the events in it.
    ///
    /// # Errors
    /// The destination's errors.
    fn tick(&mut self, _stepped: &TickRecord, _events: &[Event]) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Called for calibrations that become active now, with their number.
    ///
    /// # Errors
    /// The destination's errors.
    fn calibrations(&mut self, _number: u64, _calibrations: &Calibrations) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Called for an operation on the loop after the tick at `t_s` (s).
    ///
    /// # Errors
    /// The destination's errors.
    fn operation(&mut self, _operation: &Operation, _t_s: f64) -> Result<(), Self::Error> {
        Ok(())
    }
}

impl Pages for Vec<Vec<u8>> {
    type Error = JournalError;

    fn write(&mut self, written: &TimedMessage) -> Result<(), JournalError> {
        self.push(written.bytes.clone());
        Ok(())
    }
}

#[derive(Debug)]
pub struct JournalWriter {
    encoder: JournalEncoder,
    block: BlockWriter,
    events: Vec<Event>,
    /// Calibrations that were passed in and that no operation has named yet.
    filed: BTreeMap<u64, Calibrations>,
    /// Number of the next entry, if none is dropped.
    next: u64,
    ticks: u64,
    lost: u64,
    t_s: f64,
}

impl JournalWriter {
    /// Begins a journal; the first message is the start.
    ///
    /// # Errors
    /// [`JournalError::Part`] if a part of the loop's origin cannot be written and read back unchanged.
    pub fn new(start: &JournalStart) -> Result<(Self, TimedMessage), JournalError> {
        let mut encoder = JournalEncoder::default();
        let bytes = encoder.start(start)?;
        let scribe = Self {
            encoder,
            block: BlockWriter::default(),
            events: Vec::new(),
            filed: BTreeMap::new(),
            next: 0,
            ticks: 0,
            lost: 0,
            t_s: 0.0,
        };
        Ok((scribe, TimedMessage { t_s: 0.0, bytes }))
    }

    /// Returns the number of ticks so far.
    pub const fn ticks(&self) -> u64 {
        self.ticks
    }

    /// Returns the number of entries dropped so far.
    pub const fn lost(&self) -> u64 {
        self.lost
    }

    /// Returns the loop time of the last tick, s.
    pub const fn t_s(&self) -> f64 {
        self.t_s
    }

    /// Handles one entry.
    ///
    /// # Errors
    /// The errors of `pages`, or [`JournalError::Part`] for calibrations that cannot be written.
    pub fn take<P: Pages>(&mut self, entry: TapEntry, tap: &TapEnd, pages: &mut P) -> Result<(), P::Error> {
        // A gap is visible only in the numbers, because a full queue drops entries silently.
        self.missed_until(entry.number);
        self.next = entry.number + 1;
        match entry.passed {
            TapPayload::Event(event) => self.events.push(event),
            TapPayload::Operation(operation) => {
                if let Operation::Calibrations { number, .. } = operation {
                    self.calibrations(number, tap, pages)?;
                }
                self.block.note(TickNote::Operation(operation));
                pages.operation(&operation, self.t_s)?;
            }
            TapPayload::Stepped(stepped) => {
                let row = BlockWriter::row(&stepped, self.events.iter());
                self.t_s = stepped.timing.now_s;
                self.block.tick(&row);
                self.ticks += 1;
                // Reported only after the buffer has been returned: an error must not take it out of circulation.
                let report = pages.tick(&stepped, &self.events);
                self.events.clear();
                tap.give_back(stepped);
                report?;
            }
        }
        if self.block.is_full() { pages.write(&self.block()) } else { Ok(()) }
    }

    /// Ends the journal.
    ///
    /// # Errors
    /// The errors of `pages`.
    pub fn end<P: Pages>(mut self, tap: &TapEnd, pages: &mut P) -> Result<JournalEnd, P::Error> {
        // Entries that were dropped at the very end have no successor that would show the gap.
        self.missed_until(tap.offered());
        if !self.block.is_empty() {
            pages.write(&self.block())?;
        }
        let end = JournalEnd { ticks: self.ticks, lost: self.lost };
        pages.write(&TimedMessage { t_s: self.t_s, bytes: self.encoder.end(&end) })?;
        Ok(end)
    }

    fn block(&mut self) -> TimedMessage {
        TimedMessage { t_s: self.t_s, bytes: self.encoder.block(&mut self.block) }
    }

    /// Notes a gap if entries before this number were dropped.
    fn missed_until(&mut self, number: u64) {
        let lost = number.saturating_sub(self.next);
        if lost > 0 {
            self.lost += lost;
            // The collected events may belong to a tick that was dropped.
            self.events.clear();
            self.block.note(TickNote::Hole { lost });
        }
    }

    fn calibrations<P: Pages>(&mut self, number: u64, tap: &TapEnd, pages: &mut P) -> Result<(), P::Error> {
        self.filed.extend(tap.calibrations());
        // The loop did not accept those with a lower number.
        self.filed = self.filed.split_off(&number);
        let Some(calibrations) = self.filed.remove(&number) else { return Ok(()) };
        let bytes = self.encoder.calibrations(number, &calibrations)?;
        // Written before the operation that names them, so that a replay has them when it needs them.
        pages.calibrations(number, &calibrations)?;
        pages.write(&TimedMessage { t_s: self.t_s, bytes })
    }
}
