//! An emulated sensor in the network: commands over TCP from one client at a time, readings as datagrams to a fixed address.
//!
//! A client holds the line once a command of its was answered. Until then the next one takes its place, and one that sends much and
//! asks nothing is cut off: whatever else knocks at the port keeps no client waiting.

use std::io;

use super::{Body, Emulated, Wire as _, frames::Frames, gen_a::GenA};
use crate::emulators::{
    EmulatedFault, Emulator, End, Peer, Turn,
    wires::{tcp, udp},
};

/// Without a command among so many bytes what a client sends is garbage.
const GARBAGE_BYTES: usize = 4096;

/// Who asks.
struct Client {
    peer: Peer,
    /// A command of its was answered.
    known: bool,
    /// Bytes since the last one that was.
    unanswered: usize,
}

pub(super) struct Sensor {
    wire: GenA,
    frames: Frames,
    emulated: Emulated,
    client: Option<Client>,
}

impl Sensor {
    pub(super) fn new(emulated: Emulated, body: Body) -> Self {
        let frames = Frames::new(body, emulated.first_timestamp_us, emulated.status);
        Self { wire: GenA::new(&emulated), frames, emulated, client: None }
    }

    fn answer(&mut self, answer: &[u8], turn: &mut Turn<'_>) {
        let Some(client) = self.client.as_mut().filter(|_| !answer.is_empty()) else { return };
        (client.known, client.unanswered) = (true, 0);
        if turn.fault != EmulatedFault::Silence {
            turn.send_unspoilt(client.peer, answer);
        }
    }
}

impl Emulator for Sensor {
    fn wires(&self) -> io::Result<Vec<Box<dyn End>>> {
        Ok(vec![tcp(self.emulated.tcp_port), udp(0)])
    }

    fn admits(&self) -> bool {
        self.client.as_ref().is_none_or(|client| !client.known)
    }

    fn meet(&mut self, peer: Peer, turn: &mut Turn<'_>) {
        if let Some(client) = self.client.replace(Client { peer, known: false, unanswered: 0 }) {
            turn.hang_up(client.peer);
        }
        self.wire.opened(turn.now_s);
    }

    fn hear(&mut self, from: Peer, bytes: &[u8], turn: &mut Turn<'_>) {
        let mut answer = Vec::new();
        self.wire.hear(bytes, turn.now_s, &mut answer);
        if let Some(client) = &mut self.client {
            client.unanswered += bytes.len();
        }
        self.answer(&answer, turn);
        if self.client.take_if(|client| client.unanswered >= GARBAGE_BYTES).is_some() {
            turn.hang_up(from);
        }
    }

    fn pass(&mut self, turn: &mut Turn<'_>) {
        let mut answer = Vec::new();
        self.wire.tick(turn.now_s, &mut answer);
        self.answer(&answer, turn);
        self.frames.due(turn, &self.wire, Peer::Address(self.emulated.destination.into()), |_| {});
    }

    fn due_s(&self) -> Option<f64> {
        self.frames.next_s()
    }

    fn lose(&mut self, _: Peer) {
        self.client = None;
    }
}

#[cfg(test)]
mod tests {
    use std::{
        io::{ErrorKind, Read as _, Write as _},
        net::TcpStream,
        time::Duration,
    };

    use nima_devices::bota::Transport;

    use super::*;
    use crate::emulators::{Serving, bota::slow_motion};

    /// Whoever is served gets its answer within milliseconds; this is for machines that are busy with others.
    const LONG: Duration = Duration::from_secs(20);

    fn sensor() -> Serving {
        let emulated = Emulated { transport: Transport::Socket, tcp_port: 0, ..Emulated::default() };
        emulated.with(slow_motion()).serve().unwrap()
    }

    fn client(serving: &Serving) -> TcpStream {
        let stream = TcpStream::connect(&serving.endpoint).unwrap();
        stream.set_read_timeout(Some(LONG)).unwrap();
        stream
    }

    /// Asks for the state, and waits for the answer.
    fn ask(client: &mut TcpStream) -> std::io::Result<String> {
        client.write_all(b"rh,1,2,\n")?;
        let mut buffer = [0; 64];
        let count = client.read(&mut buffer)?;
        Ok(String::from_utf8_lossy(&buffer[..count]).into_owned())
    }

    #[test]
    fn neither_garbage_nor_silence_keeps_the_next_client_waiting() {
        let serving = sensor();
        let mut garbage = client(&serving);
        garbage.set_nonblocking(true).unwrap();
        let mut random = fastrand::Rng::with_seed(3);
        let noise: Vec<u8> = (0..65536).map(|_| random.u8(..)).collect();
        // As much as the connection takes, and it stays open.
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
    }

    #[test]
    fn a_client_that_was_answered_is_not_pushed_aside() {
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
    }

    #[test]
    fn a_client_that_takes_no_answers_is_cut_off() {
        let serving = sensor();
        let mut deaf = client(&serving);
        deaf.set_write_timeout(Some(LONG)).unwrap();
        let questions = b"rh,24,1,\n".repeat(1000);
        let cut = std::iter::repeat_with(|| deaf.write(&questions)).take(7000).find_map(Result::err);
        let kind = cut.map(|error| error.kind());
        assert!(matches!(kind, Some(ErrorKind::ConnectionReset | ErrorKind::BrokenPipe)), "{kind:?}");
    }
}
