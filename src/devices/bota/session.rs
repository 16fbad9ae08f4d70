//! Commands and answers while a sensor is opened. Blocks and allocates; never used in a running loop.

use std::time::{Duration, Instant};

use super::codec::BotaDecoder;
use crate::{DeviceError, transport::ByteStream};

#[derive(Clone, Copy, Debug)]
pub struct BotaTimeouts {
    /// First generation: time for the restart when the port is opened.
    pub boot: Duration,
    /// Time for one answer.
    pub answer: Duration,
    pub tries: u32,
    /// First generation: time for a restart of the firmware by command.
    pub init: Duration,
    /// Additional time for the first readings.
    pub stream: Duration,
}

impl Default for BotaTimeouts {
    /// Creates the times of the manufacturer's driver: 3 s for the start, 1 s for an answer.
    fn default() -> Self {
        Self {
            // Opening the port toggles DTR, which restarts a first-generation sensor; the manufacturer's driver waits
            // 3 s as well.
            boot: Duration::from_secs(3),
            answer: Duration::from_secs(1),
            tries: 3,
            // The wait of `RoboComp`'s `bota_force_sensor` after a restart.
            init: Duration::from_millis(1500),
            stream: Duration::from_secs(1),
        }
    }
}

/// Size of the buffer of received bytes in which answers are searched.
const RECEIVED_MAX: usize = 8192;
// At 460 800 bit/s, 46 bytes arrive in a millisecond: polling more often only costs processor time.
const NAP: Duration = Duration::from_millis(1);
/// Flushing a line ends when it has been quiet for this time, or after [`FLUSH`].
const QUIET: Duration = Duration::from_millis(15);
const FLUSH: Duration = Duration::from_millis(200);

/// A line for commands; received data are kept to explain failures.
pub(super) struct BotaSession {
    line: Box<dyn ByteStream>,
    /// Port or address, for messages.
    pub(super) place: String,
    pub(super) timeouts: BotaTimeouts,
    received: Vec<u8>,
    decoder: BotaDecoder,
    bytes: u64,
    frames: u64,
}

impl BotaSession {
    pub(super) fn new(line: Box<dyn ByteStream>, place: &str, timeouts: BotaTimeouts) -> Self {
        let received = Vec::with_capacity(2 * RECEIVED_MAX);
        let decoder = BotaDecoder::default();
        Self { line, place: place.to_owned(), timeouts, received, decoder, bytes: 0, frames: 0 }
    }

    /// Listens until `found` finds an answer in the data received since the last command, or until `timeout`.
    pub(super) fn listen<T>(
        &mut self,
        timeout: Duration,
        mut found: impl FnMut(&[u8]) -> Option<T>,
    ) -> Result<Option<T>, DeviceError> {
        let begin = Instant::now();
        loop {
            if self.take_in()? > 0
                && let Some(answer) = found(&self.received)
            {
                return Ok(Some(answer));
            }
            if begin.elapsed() >= timeout {
                return Ok(None);
            }
            std::thread::sleep(NAP);
        }
    }

    pub(super) fn ask<T>(
        &mut self,
        command: &[u8],
        found: impl FnMut(&[u8]) -> Option<T>,
    ) -> Result<Option<T>, DeviceError> {
        // Old bytes are read away first, so that an earlier answer is not taken as the answer to this command.
        self.take_in()?;
        self.received.clear();
        self.line.send(command).map_err(|_| self.broken())?;
        self.listen(self.timeouts.answer, found)
    }

    /// Discards data that are still arriving, for example from a stream that was just stopped.
    pub(super) fn flush(&mut self) -> Result<(), DeviceError> {
        let begin = Instant::now();
        let mut received = begin;
        while received.elapsed() < QUIET && begin.elapsed() < FLUSH {
            if self.take_in()? > 0 {
                received = Instant::now();
            }
            std::thread::sleep(NAP);
        }
        self.received.clear();
        Ok(())
    }

    /// Reads the data that have arrived and counts the frames in them.
    fn take_in(&mut self) -> Result<usize, DeviceError> {
        let count = self.line.receive(self.decoder.room()).map_err(|_| self.broken())?;
        let room = self.decoder.room();
        self.received.extend_from_slice(&room[..count]);
        self.decoder.filled(count);
        while self.decoder.next().is_some() {
            self.frames += 1;
        }
        self.bytes += count as u64;
        // The beginning is dropped: an answer is searched for among the newest bytes.
        if self.received.len() > RECEIVED_MAX {
            self.received.drain(..self.received.len() - RECEIVED_MAX);
        }
        Ok(count)
    }

    /// Returns the reason why a command is not answered, from all received data. `baud` if the line has a speed.
    pub(super) fn why_no_answer(&self, command: &str, baud: Option<u32>) -> DeviceError {
        let place = self.place.clone();
        match baud {
            // No byte at all: cable or power. Bytes without a frame: the speed of the line.
            _ if self.bytes == 0 => DeviceError::Silent { place },
            Some(baud) if self.frames == 0 => DeviceError::WrongBaud { place, baud },
            _ => DeviceError::Refused { place, command: command.trim().to_owned(), answer: "no answer".to_owned() },
        }
    }

    fn broken(&self) -> DeviceError {
        DeviceError::Other {
            place: self.place.clone(),
            reason: "the connection broke while the sensor was being opened".to_owned(),
        }
    }

    pub(super) fn into_line(self) -> Box<dyn ByteStream> {
        self.line
    }
}
