//! The unit on its interfaces.

use std::{io, path::PathBuf};

use nima_devices::ndi::command::COMMAND_MAX;

use super::{Answer, Body, Profile, Unit, unit::FIRST_BAUD};
use crate::emulators::{
    EmulatedFault, Emulator, End, Peer, Turn,
    wires::{tcp_for_one, terminal},
};

/// Time from setting the rate to 9600, which counts as a break, to the unit's answer, s: hosts flush in between.
const RESET_S: f64 = 0.300;
/// Bits on the line per byte.
const BITS: f64 = 10.0;

impl Profile {
    /// Serves such a unit on TCP; `port` 0 selects a free one. The newest connection is answered.
    pub fn on_network(self, port: u16, body: impl Body + 'static) -> Box<dyn Emulator> {
        let hearing = Hearing::new(self, true, Box::new(body));
        Box::new(Network { port, hearing })
    }

    /// Serves such a unit on a pseudo-terminal: at `link`, or in its own folder.
    pub fn on_line(self, link: Option<PathBuf>, body: impl Body + 'static) -> Box<dyn Emulator> {
        let hearing = Hearing::new(self, false, Box::new(body));
        Box::new(Line { link, hearing, baud: FIRST_BAUD, taken_s: 0.0, due: None, reset_s: None })
    }
}

/// A unit, and its input buffer.
struct Hearing {
    unit: Unit,
    body: Box<dyn Body>,
    command: Vec<u8>,
}

impl Hearing {
    fn new(profile: Profile, network: bool, body: Box<dyn Body>) -> Self {
        Self { unit: Unit::new(profile, network), body, command: Vec::with_capacity(COMMAND_MAX) }
    }

    /// Processes one byte; returns the answer if the byte completes a command.
    fn hear(&mut self, byte: u8, turn: &Turn<'_>) -> Option<Answer> {
        if byte != b'\r' {
            // A command that is too long keeps its maximum length, and is refused.
            if self.command.len() < COMMAND_MAX {
                self.command.push(byte);
            }
            return None;
        }
        let answer = self.unit.answer(turn.now_s, &self.command, turn.fault, &mut *self.body);
        self.command.clear();
        Some(answer)
    }
}

/// Sends a reply in one write. The fault of reordering is applied by the unit, which returns an older frame.
fn say(reply: &[u8], turn: &mut Turn<'_>) {
    if turn.fault == EmulatedFault::Reorder {
        turn.send_unspoilt(Peer::Everyone, reply);
    } else {
        turn.send(Peer::Everyone, reply);
    }
}

struct Network {
    port: u16,
    hearing: Hearing,
}

impl Emulator for Network {
    fn wires(&self) -> io::Result<Vec<Box<dyn End>>> {
        Ok(vec![tcp_for_one(self.port)])
    }

    fn meet(&mut self, _: Peer, _: &mut Turn<'_>) {
        self.hearing.command.clear();
    }

    fn hear(&mut self, _: Peer, bytes: &[u8], turn: &mut Turn<'_>) {
        for byte in bytes {
            if let Some(answer) = self.hearing.hear(*byte, turn) {
                say(&answer.bytes, turn);
            }
        }
    }

    fn pass(&mut self, _: &mut Turn<'_>) {}
}

struct Line {
    link: Option<PathBuf>,
    hearing: Hearing,
    /// Baud rate of the unit's side, bit/s.
    baud: u32,
    /// Until when the last reply occupies the line, s.
    taken_s: f64,
    /// The reply to be sent once the bytes of the command have had their time.
    due: Option<(f64, Answer)>,
    reset_s: Option<f64>,
}

impl Line {
    /// A pseudo-terminal cannot carry a break: the host's change to the initial rate counts as one.
    fn watch_break(&mut self, now_s: f64, host: Option<u32>) {
        if self.baud == FIRST_BAUD || host != Some(FIRST_BAUD) {
            self.reset_s = None;
        } else if now_s - *self.reset_s.get_or_insert(now_s) >= RESET_S {
            let answer = self.hearing.unit.reset();
            self.hearing.command.clear();
            self.baud = FIRST_BAUD;
            self.due = Some((now_s, answer));
            self.reset_s = None;
        }
    }
}

impl Emulator for Line {
    fn wires(&self) -> io::Result<Vec<Box<dyn End>>> {
        Ok(vec![terminal(self.link.as_deref(), "tty", Some(FIRST_BAUD))?])
    }

    fn hear(&mut self, _: Peer, bytes: &[u8], turn: &mut Turn<'_>) {
        // At another baud rate the bytes are not received.
        for byte in bytes.iter().filter(|_| turn.baud == Some(self.baud)) {
            // The unit is half duplex: bytes that arrive before its reply is out are lost, so that a flood of requests
            // does not occupy the line for long.
            if self.due.is_some() {
                break;
            }
            let length = self.hearing.command.len() + 1;
            if let Some(answer) = self.hearing.hear(*byte, turn) {
                let took_s = |bytes: usize| bytes as f64 * BITS / f64::from(self.baud);
                // The reply is written as a whole when its first byte is due; the line is occupied until its last byte
                // has passed.
                let due_s = turn.now_s.max(self.taken_s) + took_s(length);
                self.taken_s = due_s + took_s(answer.bytes.len());
                self.due = Some((due_s, answer));
            }
        }
    }

    fn pass(&mut self, turn: &mut Turn<'_>) {
        self.watch_break(turn.now_s, turn.baud);
        if let Some((_, answer)) = self.due.take_if(|(due_s, _)| *due_s <= turn.now_s) {
            say(&answer.bytes, turn);
            self.baud = answer.then_baud.unwrap_or(self.baud);
        }
    }

    fn due_s(&self) -> Option<f64> {
        Some(self.due.as_ref().map_or(f64::INFINITY, |(due_s, _)| *due_s))
    }

    fn lose(&mut self, _: Peer) {
        self.hearing.command.clear();
        self.due = None;
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use nima_devices::transport::{Bytes as _, Serial, SerialSettings};

    use nima_testing::real_time::judged;

    use super::{super::wandering, *};

    /// At the initial baud rate each reply to an empty command takes 15 ms: twenty thousand would keep the unit sending
    /// for minutes.
    #[test]
    fn a_flood_of_empty_commands_takes_the_line_for_no_longer_than_a_reply() {
        judged(|| {
            let serving = Profile::default().on_line(None, wandering).serve().unwrap();
            let mut host = Serial::open(&SerialSettings { port: serving.endpoint.clone(), baud: FIRST_BAUD }).unwrap();
            let begin = Instant::now();
            let mut rest = 20_000_usize;
            while rest > 0 && begin.elapsed() < Duration::from_mins(1) {
                // A full buffer accepts no more.
                let flood = [b'\r'; 64];
                rest = rest.saturating_sub(if host.send(&flood).is_ok() { flood.len() } else { 0 });
                host.receive(&mut [0; 4096]).unwrap();
                std::thread::sleep(Duration::from_micros(100));
            }
            assert_eq!(rest, 0, "a busy machine had the line full for a minute");
            let begin = Instant::now();
            let mut heard = Vec::new();
            while !String::from_utf8_lossy(&heard).contains("Polaris Vega") {
                assert!(begin.elapsed() < Duration::from_secs(30), "{}", String::from_utf8_lossy(&heard));
                // A request during the unit's reply is lost.
                host.send(b"VER 0\r").unwrap();
                for _ in 0..500 {
                    let mut buffer = [0; 4096];
                    let count = host.receive(&mut buffer).unwrap();
                    heard.extend(&buffer[..count]);
                    std::thread::sleep(Duration::from_millis(1));
                }
            }
        });
    }
}
