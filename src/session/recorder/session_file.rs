//! The file of a session and its channels.

use std::collections::BTreeMap;

use nima_machine::{
    messages::Event,
    rig::{DeviceName, SIDES, Side},
    runtime::{Operation, TickRecord},
    teleop::Calibrations,
};
use nima_recording::session::Encoding;

use super::{JOURNAL_ENCODING, JOURNAL_TOPIC, RecordError, RecordingInfo};
use crate::{
    calibration_metadata::described,
    journal_writer::{Pages, TimedMessage},
    layouts::layouts,
    sinks::{Destination, SessionSinks, SinkChannel},
    topics::SessionTopics,
    trim::{BEGINNING, CLOCK_TABLE},
};

/// The chunk is closed after this many blocks of the journal: 0.4 s at 1 kHz, the maximum that a killed process can
/// lose.
const BLOCKS_PER_CHUNK: u32 = 2;

pub(super) struct SessionFile {
    pub(super) out: SessionSinks,
    journal: SinkChannel,
    pub(super) topics: SessionTopics,
    pub(super) started_ns: u64,
    blocks: u32,
}

impl SessionFile {
    pub(super) fn create(
        to: Destination<'_>,
        about: RecordingInfo,
        known: &[(Side, BTreeMap<String, String>)],
        sides: [bool; SIDES],
        devices: Vec<DeviceName>,
    ) -> Result<Self, RecordError> {
        let RecordingInfo { program, started_ns, metadata, files, words } = about;
        let mut out = SessionSinks::create(to, &program, started_ns)?;
        for (name, entries) in &metadata {
            out.metadata(name, entries)?;
        }
        for (side, entries) in known {
            out.metadata(&format!("calibrations {}", side.word()), entries)?;
        }
        for attached in files.iter().chain(&layouts(sides)) {
            out.attachment(started_ns, attached)?;
        }
        let encoding = Encoding { message_encoding: JOURNAL_ENCODING.to_owned(), ..Encoding::default() };
        let journal = out.channel(JOURNAL_TOPIC, encoding)?;
        let topics = SessionTopics::new(&mut out, sides, words, devices)?;
        Ok(Self { out, journal, topics, started_ns, blocks: 0 })
    }

    /// Sets the start of the loop's clock, before the first tick is written. The file is older, because it was created
    /// before the loop.
    pub(super) fn started(&mut self, started_ns: u64) -> Result<(), RecordError> {
        self.started_ns = started_ns;
        let table = BTreeMap::from([(BEGINNING.to_owned(), started_ns.to_string())]);
        Ok(self.out.metadata(CLOCK_TABLE, &table)?)
    }

    pub(super) fn log_time_ns(&self, t_s: f64) -> u64 {
        log_time_ns(self.started_ns, t_s)
    }
}

/// Converts a time of the loop, s, to the time of a message in a session that began at `started_ns`.
pub(super) fn log_time_ns(started_ns: u64, t_s: f64) -> u64 {
    started_ns + (t_s.max(0.0) * 1e9).round() as u64
}

impl Pages for SessionFile {
    type Error = RecordError;

    fn write(&mut self, TimedMessage { t_s, bytes }: &TimedMessage) -> Result<(), RecordError> {
        let time_ns = self.log_time_ns(*t_s);
        self.out.message(self.journal, time_ns, bytes)?;
        self.blocks += 1;
        if self.blocks.is_multiple_of(BLOCKS_PER_CHUNK) {
            self.out.flush()?;
        }
        Ok(())
    }

    fn tick(&mut self, stepped: &TickRecord, events: &[Event]) -> Result<(), RecordError> {
        let t_s = stepped.timing.now_s;
        let time_ns = self.log_time_ns(t_s);
        let started_ns = self.started_ns;
        // The simulation has reported all object states up to this tick before the tick itself.
        self.topics.objects(&mut self.out, t_s, |t_s| log_time_ns(started_ns, t_s))?;
        self.out.tick(t_s, &stepped.ticks, events);
        Ok(self.topics.tick(&mut self.out, time_ns, stepped, events)?)
    }

    fn calibrations(&mut self, number: u64, calibrations: &Calibrations) -> Result<(), RecordError> {
        Ok(self.out.metadata(&format!("calibrations {number}"), &described(calibrations))?)
    }

    fn operation(&mut self, operation: &Operation, t_s: f64) -> Result<(), RecordError> {
        let time_ns = self.log_time_ns(t_s);
        Ok(self.topics.operation(&mut self.out, time_ns, operation)?)
    }
}
