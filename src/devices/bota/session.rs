//! Questions and answers while a sensor is being opened. Blocks and allocates; never used in a running loop.

use std::time::{Duration, Instant};

use super::codec::Decoder;
use crate::{Trouble, transport::Bytes};

/// How long an opening waits for what.
#[derive(Clone, Copy, Debug)]
pub struct Timeouts {
    /// First generation: opening the port restarts it; until it has begun.
    pub boot: Duration,
    /// For one answer.
    pub answer: Duration,
    /// How often the first command is sent.
    pub tries: u32,
    /// First generation: after a restart of the firmware.
    pub init: Duration,
    /// For the first readings, beyond their own time.
    pub stream: Duration,
}

impl Default for Timeouts {
    /// The official driver's times: 3 s for the start, 1 s for an answer.
    fn default() -> Self {
        Self {
            boot: Duration::from_secs(3),
            answer: Duration::from_secs(1),
            tries: 3,
            init: Duration::from_millis(1500),
            stream: Duration::from_secs(1),
        }
    }
}

impl Timeouts {
    /// For a diagnosis: a second, and as long again for the start of a first-generation sensor.
    pub(super) const SHORT: Self = Self {
        boot: Duration::from_secs(1),
        answer: Duration::from_millis(150),
        tries: 2,
        init: Duration::from_millis(100),
        stream: Duration::from_millis(200),
    };
}

/// Of what was heard, so much is kept to look for an answer in.
const HEARD_MAX: usize = 8192;
const NAP: Duration = Duration::from_millis(1);
/// A line is flushed when it was quiet for so long, or after [`FLUSH`].
const QUIET: Duration = Duration::from_millis(15);
const FLUSH: Duration = Duration::from_millis(200);

/// A line on which questions are asked, with what was heard on it as evidence.
pub(super) struct Session {
    line: Box<dyn Bytes>,
    /// Port or address, for messages.
    pub(super) place: String,
    pub(super) timeouts: Timeouts,
    heard: Vec<u8>,
    decoder: Decoder,
    /// Bytes since the line was opened.
    bytes: u64,
    /// Whole frames among them.
    frames: u64,
}

impl Session {
    pub(super) fn new(line: Box<dyn Bytes>, place: &str, timeouts: Timeouts) -> Self {
        let (heard, decoder) = (Vec::with_capacity(2 * HEARD_MAX), Decoder::default());
        Self { line, place: place.to_owned(), timeouts, heard, decoder, bytes: 0, frames: 0 }
    }

    /// Listens until `found` finds something in what was heard since the last question, or for `timeout`.
    pub(super) fn listen<T>(
        &mut self,
        timeout: Duration,
        mut found: impl FnMut(&[u8]) -> Option<T>,
    ) -> Result<Option<T>, Trouble> {
        let begin = Instant::now();
        loop {
            if self.take_in()? > 0
                && let Some(answer) = found(&self.heard)
            {
                return Ok(Some(answer));
            }
            if begin.elapsed() >= timeout {
                return Ok(None);
            }
            std::thread::sleep(NAP);
        }
    }

    /// Sends a command and listens for its answer.
    pub(super) fn ask<T>(
        &mut self,
        command: &[u8],
        found: impl FnMut(&[u8]) -> Option<T>,
    ) -> Result<Option<T>, Trouble> {
        self.take_in()?;
        self.heard.clear();
        self.line.send(command).map_err(|_| self.broken())?;
        self.listen(self.timeouts.answer, found)
    }

    /// Throws away what is still coming, for instance of a stream that was just stopped.
    pub(super) fn flush(&mut self) -> Result<(), Trouble> {
        let begin = Instant::now();
        let mut heard = begin;
        while heard.elapsed() < QUIET && begin.elapsed() < FLUSH {
            if self.take_in()? > 0 {
                heard = Instant::now();
            }
            std::thread::sleep(NAP);
        }
        self.heard.clear();
        Ok(())
    }

    /// Takes in what has arrived, and counts frames in it.
    fn take_in(&mut self) -> Result<usize, Trouble> {
        let count = self.line.receive(self.decoder.room()).map_err(|_| self.broken())?;
        let room = self.decoder.room();
        self.heard.extend_from_slice(&room[..count]);
        self.decoder.filled(count);
        while self.decoder.next().is_some() {
            self.frames += 1;
        }
        self.bytes += count as u64;
        if self.heard.len() > HEARD_MAX {
            self.heard.drain(..self.heard.len() - HEARD_MAX);
        }
        Ok(count)
    }

    /// Why a command stays without an answer, by all that was heard. `baud` where the line has a speed.
    pub(super) fn why_no_answer(&self, command: &str, baud: Option<u32>) -> Trouble {
        let place = self.place.clone();
        match baud {
            _ if self.bytes == 0 => Trouble::Silent { place },
            Some(baud) if self.frames == 0 => Trouble::WrongBaud { place, baud },
            _ => Trouble::Refused { place, command: command.trim().to_owned(), answer: "no answer".to_owned() },
        }
    }

    fn broken(&self) -> Trouble {
        Trouble::Other { place: self.place.clone(), reason: "the connection broke while it was opened".to_owned() }
    }

    /// The line, when all is asked.
    pub(super) fn into_line(self) -> Box<dyn Bytes> {
        self.line
    }
}
