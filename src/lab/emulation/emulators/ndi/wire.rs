//! The unit on its wires.

use std::{io, path::PathBuf};

use nima_devices::ndi::command::COMMAND_MAX;

use super::{Answer, Body, Profile, Unit, unit::FIRST_BAUD};
use crate::emulators::{
    EmulatedFault, Emulator, End, Peer, Turn,
    wires::{tcp_for_one, terminal},
};

/// From the speed being set to 9600, which stands for a break, to the unit's answer, s: hosts flush in between.
const RESET_S: f64 = 0.300;
/// Bits on the line per byte.
const BITS: f64 = 10.0;

impl Profile {
    /// Such a unit on TCP; `port` 0 takes a free one. The newest connection is the one that is answered.
    pub fn on_network(self, port: u16, body: impl Body + 'static) -> Box<dyn Emulator> {
        let hearing = Hearing::new(self, true, Box::new(body));
        Box::new(Network { port, hearing })
    }

    /// Such a unit on a pseudo-terminal: `link`, or one in a folder of its own.
    pub fn on_line(self, link: Option<PathBuf>, body: impl Body + 'static) -> Box<dyn Emulator> {
        let hearing = Hearing::new(self, false, Box::new(body));
        Box::new(Line { link, hearing, baud: FIRST_BAUD, taken_s: 0.0, due: None, reset_s: None })
    }
}

/// A unit, and what arrives for it.
struct Hearing {
    unit: Unit,
    body: Box<dyn Body>,
    command: Vec<u8>,
}

impl Hearing {
    fn new(profile: Profile, network: bool, body: Box<dyn Body>) -> Self {
        Self { unit: Unit::new(profile, network), body, command: Vec::with_capacity(COMMAND_MAX) }
    }

    /// Takes one byte; the answer once it ends a command.
    fn hear(&mut self, byte: u8, turn: &Turn<'_>) -> Option<Answer> {
        if byte != b'\r' {
            // What is too long stays so, and is refused.
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

/// Sends a reply, in one write. What reorder means for a unit that is asked is done by the unit: an older frame.
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
    /// Speed of the unit's side of the line, bit/s.
    baud: u32,
    /// Until when the last reply takes the line, s.
    taken_s: f64,
    /// What the line says once the bytes of the command have had their time.
    due: Option<(f64, Answer)>,
    reset_s: Option<f64>,
}

impl Line {
    /// A pseudo-terminal carries no break: the host's speed falling to the first one stands for it.
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
        // At another speed the bytes are none for the unit.
        for byte in bytes.iter().filter(|_| turn.baud == Some(self.baud)) {
            // The unit speaks or listens: what comes before its reply is out is lost, so that no flood of questions takes the line for long.
            if self.due.is_some() {
                break;
            }
            let length = self.hearing.command.len() + 1;
            if let Some(answer) = self.hearing.hear(*byte, turn) {
                let took_s = |bytes: usize| bytes as f64 * BITS / f64::from(self.baud);
                // The reply is written at once when its first byte would come; the line is taken until its last one has passed.
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

    /// At the line's first speed each reply to nothing takes 15 ms: twenty thousand would keep the unit speaking for minutes.
    #[test]
    fn a_flood_of_empty_commands_takes_the_line_for_no_longer_than_a_reply() {
        judged(|| {
            let serving = Profile::default().on_line(None, wandering).serve().unwrap();
            let mut host = Serial::open(&SerialSettings { port: serving.endpoint.clone(), baud: FIRST_BAUD }).unwrap();
            let begin = Instant::now();
            let mut rest = 20_000_usize;
            while rest > 0 && begin.elapsed() < Duration::from_mins(1) {
                // A full line takes none.
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
                // What is asked while the unit speaks is lost.
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
