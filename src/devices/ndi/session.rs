//! Sends a command and waits for the reply: for opening and closing, never for the real-time thread.

use std::time::{Duration, Instant};

use super::{
    command::{COMMAND_MAX, NdiCommand},
    crc::read_hex,
    reply::{ExpectedReply, Inbox, NdiArrival},
    text::ErrorCode,
};
use crate::{
    Loss,
    transport::{ByteStream, Serial, Tcp},
};

#[derive(Debug)]
pub(super) enum NdiWire {
    Tcp(Tcp),
    Serial(Serial),
}

impl NdiWire {
    /// Returns whether the serial port no longer exists. A closed network connection is detected when it is read.
    pub(super) fn is_gone(&mut self) -> bool {
        match self {
            Self::Tcp(_) => false,
            Self::Serial(serial) => serial.clear().is_err(),
        }
    }
}

impl ByteStream for NdiWire {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, Loss> {
        match self {
            Self::Tcp(tcp) => tcp.receive(buffer),
            Self::Serial(serial) => serial.receive(buffer),
        }
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss> {
        match self {
            Self::Tcp(tcp) => tcp.send(bytes),
            Self::Serial(serial) => serial.send(bytes),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum NdiFailure {
    Silent,
    Garbled,
    Gone,
    Refused(ErrorCode),
}

/// A damaged reply counts as finished if no bytes arrive for this time.
const QUIET: Duration = Duration::from_millis(50);
// Replies take milliseconds, so half a millisecond does not delay them noticeably.
const NAP: Duration = Duration::from_micros(500);

#[derive(Debug)]
pub(super) struct NdiSession {
    pub(super) wire: NdiWire,
    pub(super) inbox: Inbox,
}

impl NdiSession {
    pub(super) fn new(wire: NdiWire) -> Self {
        Self { wire, inbox: Inbox::new() }
    }

    /// Sends a command and waits for its reply; returns the text of the reply.
    pub(super) fn ask(&mut self, command: &NdiCommand<'_>, timeout: Duration) -> Result<String, NdiFailure> {
        self.drain()?;
        self.wire.send(command.encode().as_bytes()).map_err(|_| NdiFailure::Gone)?;
        self.wait(timeout)
    }

    /// Sends a command that may safely be repeated, and repeats it if its reply is missing or damaged.
    pub(super) fn ask_again(&mut self, command: &NdiCommand<'_>, timeout: Duration) -> Result<String, NdiFailure> {
        match self.ask(command, timeout) {
            Err(NdiFailure::Silent | NdiFailure::Garbled) => self.ask(command, timeout),
            answered => answered,
        }
    }

    pub(super) fn wait(&mut self, timeout: Duration) -> Result<String, NdiFailure> {
        let begin = Instant::now();
        let mut received = begin;
        let mut damaged = false;
        let mut any = false;
        while begin.elapsed() < timeout {
            let count = self.wire.receive(self.inbox.room()).map_err(|_| NdiFailure::Gone)?;
            if count > 0 {
                received = Instant::now();
                any = true;
                self.inbox.filled(count);
                while let Some(arrival) = self.inbox.next(ExpectedReply::Line) {
                    match arrival {
                        NdiArrival::Line(line) => return answer(line),
                        NdiArrival::Block(_) | NdiArrival::Damaged => damaged = true,
                    }
                }
            } else {
                std::thread::sleep(NAP);
            }
            if damaged && received.elapsed() > QUIET {
                return Err(NdiFailure::Garbled);
            }
        }
        Err(if any { NdiFailure::Garbled } else { NdiFailure::Silent })
    }

    /// Waits until data have arrived and the line is quiet again, or until `timeout`.
    pub(super) fn let_pass(&mut self, timeout: Duration) {
        let begin = Instant::now();
        let mut received: Option<Instant> = None;
        while begin.elapsed() < timeout && received.is_none_or(|received| received.elapsed() < QUIET / 10) {
            match self.wire.receive(self.inbox.room()) {
                Ok(0) => std::thread::sleep(NAP),
                Ok(_) => received = Some(Instant::now()),
                Err(_) => return,
            }
        }
    }

    pub(super) fn drain(&mut self) -> Result<(), NdiFailure> {
        let mut old = [0; COMMAND_MAX];
        for _ in 0..64 {
            if self.wire.receive(&mut old).map_err(|_| NdiFailure::Gone)? == 0 {
                break;
            }
        }
        self.inbox.clear();
        Ok(())
    }
}

fn answer(line: &[u8]) -> Result<String, NdiFailure> {
    match line.strip_prefix(b"ERROR") {
        Some(code) => {
            Err(read_hex(code).map_or(NdiFailure::Garbled, |code| NdiFailure::Refused(ErrorCode(code as u8))))
        }
        None => Ok(String::from_utf8_lossy(line).into_owned()),
    }
}
