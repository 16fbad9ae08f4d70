//! The unit on its interfaces.

use std::{io, path::PathBuf};

use nima_devices::ndi::command::COMMAND_MAX;

use super::{NdiBody, NdiProfile, NdiUnit, UnitAnswer, unit::FIRST_BAUD};
use crate::emulators::{
    EmulatedFault, Emulator, EmulatorTurn, WireEnd, WirePeer,
    wires::{tcp_for_one, terminal},
};

/// Time from setting the rate to 9600, which counts as a break, to the unit's answer, s: hosts flush in between.
const RESET_S: f64 = 0.300;
/// Bits on the line per byte.
const BITS: f64 = 10.0;

impl NdiProfile {
    /// Serves such a unit on TCP; `port` 0 selects a free one. The newest connection is answered.
    pub fn on_network(self, port: u16, body: impl NdiBody + 'static) -> Box<dyn Emulator> {
        let listening_unit = ListeningUnit::new(self, true, Box::new(body));
        Box::new(NdiNetwork { port, listening_unit })
    }

    /// Serves this unit on a pseudo-terminal: at `link`, or in a temporary folder.
    pub fn on_line(self, link: Option<PathBuf>, body: impl NdiBody + 'static) -> Box<dyn Emulator> {
        let listening_unit = ListeningUnit::new(self, false, Box::new(body));
        Box::new(NdiLine { link, listening_unit, baud: FIRST_BAUD, taken_s: 0.0, due: None, reset_s: None })
    }
}

/// A unit, and its input buffer.
struct ListeningUnit {
    unit: NdiUnit,
    body: Box<dyn NdiBody>,
    command: Vec<u8>,
}

impl ListeningUnit {
    fn new(profile: NdiProfile, network: bool, body: Box<dyn NdiBody>) -> Self {
        Self { unit: NdiUnit::new(profile, network), body, command: Vec::with_capacity(COMMAND_MAX) }
    }

    /// Processes one byte; returns the answer if the byte completes a command.
    fn receive(&mut self, byte: u8, turn: &EmulatorTurn<'_>) -> Option<UnitAnswer> {
        if byte != b'\r' {
            // A command that is too long is cut to the maximum length, and then refused.
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
fn say(reply: &[u8], turn: &mut EmulatorTurn<'_>) {
    if turn.fault == EmulatedFault::Reorder {
        turn.send_unspoilt(WirePeer::Everyone, reply);
    } else {
        turn.send(WirePeer::Everyone, reply);
    }
}

struct NdiNetwork {
    port: u16,
    listening_unit: ListeningUnit,
}

impl Emulator for NdiNetwork {
    fn wires(&self) -> io::Result<Vec<Box<dyn WireEnd>>> {
        Ok(vec![tcp_for_one(self.port)])
    }

    fn meet(&mut self, _: WirePeer, _: &mut EmulatorTurn<'_>) {
        self.listening_unit.command.clear();
    }

    fn receive(&mut self, _: WirePeer, bytes: &[u8], turn: &mut EmulatorTurn<'_>) {
        for byte in bytes {
            if let Some(answer) = self.listening_unit.receive(*byte, turn) {
                say(&answer.bytes, turn);
            }
        }
    }

    fn pass(&mut self, _: &mut EmulatorTurn<'_>) {}
}

struct NdiLine {
    link: Option<PathBuf>,
    listening_unit: ListeningUnit,
    /// Baud rate of the unit's side, bit/s.
    baud: u32,
    /// Until when the last reply occupies the line, s.
    taken_s: f64,
    /// The reply to be sent once the bytes of the command have had their time.
    due: Option<(f64, UnitAnswer)>,
    reset_s: Option<f64>,
}

impl NdiLine {
    /// A pseudo-terminal cannot carry a break: the host's change to the initial rate counts as one.
    fn watch_break(&mut self, now_s: f64, host: Option<u32>) {
        if self.baud == FIRST_BAUD || host != Some(FIRST_BAUD) {
            self.reset_s = None;
        } else if now_s - *self.reset_s.get_or_insert(now_s) >= RESET_S {
            let answer = self.listening_unit.unit.reset();
            self.listening_unit.command.clear();
            self.baud = FIRST_BAUD;
            self.due = Some((now_s, answer));
            self.reset_s = None;
        }
    }
}

impl Emulator for NdiLine {
    fn wires(&self) -> io::Result<Vec<Box<dyn WireEnd>>> {
        Ok(vec![terminal(self.link.as_deref(), "tty", Some(FIRST_BAUD))?])
    }

    fn receive(&mut self, _: WirePeer, bytes: &[u8], turn: &mut EmulatorTurn<'_>) {
        // At another baud rate the bytes are not received.
        for byte in bytes.iter().filter(|_| turn.baud == Some(self.baud)) {
            // The unit is half duplex: bytes that arrive before its reply has been sent are lost, so a flood of
            // requests does not occupy the line for long.
            if self.due.is_some() {
                break;
            }
            let length = self.listening_unit.command.len() + 1;
            if let Some(answer) = self.listening_unit.receive(*byte, turn) {
                let took_s = |bytes: usize| bytes as f64 * BITS / f64::from(self.baud);
                // Write the whole reply when its first byte is due; the line is occupied until its last byte has been
                // sent.
                let due_s = turn.now_s.max(self.taken_s) + took_s(length);
                self.taken_s = due_s + took_s(answer.bytes.len());
                self.due = Some((due_s, answer));
            }
        }
    }

    fn pass(&mut self, turn: &mut EmulatorTurn<'_>) {
        self.watch_break(turn.now_s, turn.baud);
        if let Some((_, answer)) = self.due.take_if(|(due_s, _)| *due_s <= turn.now_s) {
            say(&answer.bytes, turn);
            self.baud = answer.then_baud.unwrap_or(self.baud);
        }
    }

    fn due_s(&self) -> Option<f64> {
        Some(self.due.as_ref().map_or(f64::INFINITY, |(due_s, _)| *due_s))
    }

    fn lose(&mut self, _: WirePeer) {
        self.listening_unit.command.clear();
        self.due = None;
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use nima_devices::transport::{ByteStream as _, Serial, SerialSettings};

    use nima_testing::real_time::judged;

    use super::{super::wandering, *};

    /// At the initial baud rate, each reply to an empty command takes 15 ms, so twenty thousand would keep the unit
    /// sending for minutes.
    #[test]
    fn a_flood_of_empty_commands_takes_the_line_for_no_longer_than_a_reply() {
        judged(|| {
            let serving = NdiProfile::default().on_line(None, wandering).serve().unwrap();
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
            let mut received = Vec::new();
            while !String::from_utf8_lossy(&received).contains("Polaris Vega") {
                assert!(begin.elapsed() < Duration::from_secs(30), "{}", String::from_utf8_lossy(&received));
                // A request during the unit's reply is lost.
                host.send(b"VER 0\r").unwrap();
                for _ in 0..500 {
                    let mut buffer = [0; 4096];
                    let count = host.receive(&mut buffer).unwrap();
                    received.extend(&buffer[..count]);
                    std::thread::sleep(Duration::from_millis(1));
                }
            }
        });
    }
}
