//! An emulated sensor on its interface: a pseudo-terminal, or commands over TCP and readings as datagrams to a fixed
//! address.
//!
//! A network client owns the sensor once one of its commands has been answered. Until then the next client replaces it,
//! and a client that sends much data without a valid command is disconnected, so that other programs that connect to
//! the port cannot block a client.

use std::io;

use nima_devices::bota::Transport;

use super::{BotaBody, BotaWire, EmulatedBota, frames::BotaFrames};
use crate::emulators::{
    EmulatedFault, Emulator, EmulatorTurn, WireEnd, WirePeer,
    wires::{tcp_for_one, terminal, udp},
};

/// Data without a command in this many bytes are garbage. A client at the wrong line speed sends bytes that never form
/// a command; they must not fill the memory.
const GARBAGE_BYTES: usize = 4096;

pub(super) struct EmulatedSensor {
    wire: Box<dyn BotaWire>,
    frames: BotaFrames,
    of: EmulatedBota,
    /// Whether a command of the client has been answered.
    known: bool,
    /// Number of bytes from the client since its last answered command.
    unanswered: usize,
}

impl EmulatedSensor {
    pub(super) fn new(wire: Box<dyn BotaWire>, of: EmulatedBota, body: BotaBody) -> Self {
        let frames = BotaFrames::new(body, of.first_timestamp_us, of.status);
        Self { wire, frames, of, known: false, unanswered: 0 }
    }

    /// Another baud rate changes the bytes.
    fn understands(&self, turn: &EmulatorTurn<'_>) -> bool {
        turn.baud.is_none() || self.of.baud.is_none() || turn.baud == self.of.baud
    }

    /// Sends an answer, which only the fault of silence suppresses.
    fn answer(&mut self, mut answer: Vec<u8>, turn: &mut EmulatorTurn<'_>) {
        if answer.is_empty() {
            return;
        }
        self.known = true;
        self.unanswered = 0;
        if turn.fault != EmulatedFault::Silence {
            garble(&mut answer, self.understands(turn));
            turn.send_unspoilt(WirePeer::Everyone, &answer);
        }
    }
}

fn garble(bytes: &mut [u8], understood: bool) {
    for byte in bytes.iter_mut().filter(|_| !understood) {
        *byte = byte.rotate_left(3) ^ 0x5A;
    }
}

impl Emulator for EmulatedSensor {
    fn wires(&self) -> io::Result<Vec<Box<dyn WireEnd>>> {
        let line = |name| terminal(self.of.link.as_deref(), name, None);
        Ok(match self.of.transport {
            Transport::Gen0 => vec![line("bota-gen0")?],
            Transport::GenA => vec![line("bota-gen-a")?],
            Transport::Socket => vec![tcp_for_one(self.of.tcp_port), udp(0)],
        })
    }

    fn admits(&self) -> bool {
        !self.known
    }

    fn meet(&mut self, _: WirePeer, turn: &mut EmulatorTurn<'_>) {
        self.known = false;
        self.unanswered = 0;
        self.wire.opened(turn.now_s);
    }

    fn receive(&mut self, _: WirePeer, bytes: &[u8], turn: &mut EmulatorTurn<'_>) {
        if !self.understands(turn) {
            return;
        }
        let mut answer = Vec::new();
        self.wire.receive(bytes, turn.now_s, &mut answer);
        self.unanswered += bytes.len();
        self.answer(answer, turn);
        if self.unanswered >= GARBAGE_BYTES {
            turn.hang_up();
        }
    }

    fn pass(&mut self, turn: &mut EmulatorTurn<'_>) {
        let mut answer = Vec::new();
        self.wire.tick(turn.now_s, &mut answer);
        self.answer(answer, turn);
        let to = match self.of.transport {
            Transport::Socket => WirePeer::Address(self.of.destination.into()),
            Transport::Gen0 | Transport::GenA => WirePeer::Everyone,
        };
        let understood = self.understands(turn);
        self.frames.due(turn, &*self.wire, to, |bytes| garble(bytes, understood));
    }

    fn due_s(&self) -> Option<f64> {
        self.frames.next_s()
    }

    fn lose(&mut self, _: WirePeer) {
        self.known = false;
    }
}

#[cfg(test)]
mod tests {
    use std::{
        io::{ErrorKind, Read as _, Write as _},
        net::TcpStream,
        time::Duration,
    };

    use nima_testing::real_time::judged;

    use super::*;
    use crate::emulators::{EmulatorThread, bota::slow_motion};

    /// An active client is answered within milliseconds; this limit allows for busy machines.
    const LONG: Duration = Duration::from_secs(20);

    fn sensor() -> EmulatorThread {
        let emulated = EmulatedBota { transport: Transport::Socket, tcp_port: 0, ..EmulatedBota::default() };
        emulated.with(slow_motion()).serve().unwrap()
    }

    fn client(serving: &EmulatorThread) -> TcpStream {
        let stream = TcpStream::connect(&serving.endpoint).unwrap();
        stream.set_read_timeout(Some(LONG)).unwrap();
        stream
    }

    /// Requests the state and waits for the answer.
    fn ask(client: &mut TcpStream) -> std::io::Result<String> {
        client.write_all(b"rh,1,2,\n")?;
        let mut buffer = [0; 64];
        let count = client.read(&mut buffer)?;
        Ok(String::from_utf8_lossy(&buffer[..count]).into_owned())
    }

    #[test]
    fn neither_garbage_nor_silence_keeps_the_next_client_waiting() {
        judged(|| {
            let serving = sensor();
            let mut garbage = client(&serving);
            garbage.set_nonblocking(true).unwrap();
            let mut random = fastrand::Rng::with_seed(3);
            let noise: Vec<u8> = (0..65536).map(|_| random.u8(..)).collect();
            // Sends as much as the connection accepts, and keeps it open.
            let mut sent = 0;
            let stopped = loop {
                match garbage.write(&noise) {
                    Ok(count) if sent < 64 << 20 => sent += count,
                    Ok(_) => panic!("the emulator takes in everything"),
                    Err(error) => break error.kind(),
                }
            };
            println!("{sent} bytes of garbage, then {stopped:?}");
            assert_eq!(ask(&mut client(&serving)).unwrap(), "rh,0,0\n");
            let silent = client(&serving);
            assert_eq!(ask(&mut client(&serving)).unwrap(), "rh,0,0\n");
            drop(silent);
        });
    }

    #[test]
    fn a_client_that_was_answered_is_not_pushed_aside() {
        judged(|| {
            let serving = sensor();
            let mut first = client(&serving);
            assert_eq!(ask(&mut first).unwrap(), "rh,0,0\n");
            let mut second = client(&serving);
            second.write_all(b"rh,1,2,\n").unwrap();
            for _ in 0..20 {
                assert_eq!(ask(&mut first).unwrap(), "rh,0,0\n");
            }
            drop(first);
            let mut buffer = [0; 64];
            let count = second.read(&mut buffer).unwrap();
            assert_eq!(&buffer[..count], b"rh,0,0\n", "it is the next one's turn");
        });
    }

    #[test]
    fn a_client_that_takes_no_answers_is_cut_off() {
        judged(|| {
            let serving = sensor();
            let mut deaf = client(&serving);
            deaf.set_write_timeout(Some(LONG)).unwrap();
            let questions = b"rh,24,1,\n".repeat(1000);
            let cut = std::iter::repeat_with(|| deaf.write(&questions)).take(7000).find_map(Result::err);
            let kind = cut.map(|error| error.kind());
            assert!(matches!(kind, Some(ErrorKind::ConnectionReset | ErrorKind::BrokenPipe)), "{kind:?}");
        });
    }
}
