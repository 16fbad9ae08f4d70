//! An emulated sensor behind a pseudo-terminal.

use std::io;

use super::{Body, Emulated, Wire, frames::Frames};
use crate::emulators::{EmulatedFault, Emulator, End, Peer, Turn, wires::terminal};

pub(super) struct Sensor<W> {
    wire: W,
    frames: Frames,
    name: &'static str,
    emulated: Emulated,
}

impl<W: Wire> Sensor<W> {
    pub(super) fn new(wire: W, name: &'static str, emulated: Emulated, body: Body) -> Self {
        let frames = Frames::new(body, emulated.first_timestamp_us, emulated.status);
        Self { wire, frames, name, emulated }
    }

    fn understands(&self, turn: &Turn<'_>) -> bool {
        self.emulated.baud.is_none_or(|baud| turn.baud == Some(baud))
    }

    /// An answer, which only silence keeps back.
    fn answer(&self, mut answer: Vec<u8>, turn: &mut Turn<'_>) {
        if answer.is_empty() || turn.fault == EmulatedFault::Silence {
            return;
        }
        if !self.understands(turn) {
            garble(&mut answer);
        }
        turn.send_unspoilt(Peer::Everyone, &answer);
    }
}

/// Another speed turns bytes into others.
fn garble(bytes: &mut [u8]) {
    bytes.iter_mut().for_each(|byte| *byte = byte.rotate_left(3) ^ 0x5A);
}

impl<W: Wire> Emulator for Sensor<W> {
    fn wires(&self) -> io::Result<Vec<Box<dyn End>>> {
        Ok(vec![terminal(self.emulated.link.as_deref(), self.name, None)?])
    }

    fn meet(&mut self, _: Peer, turn: &mut Turn<'_>) {
        self.wire.opened(turn.now_s);
    }

    fn hear(&mut self, _: Peer, bytes: &[u8], turn: &mut Turn<'_>) {
        if self.understands(turn) {
            let mut answer = Vec::new();
            self.wire.hear(bytes, turn.now_s, &mut answer);
            self.answer(answer, turn);
        }
    }

    fn pass(&mut self, turn: &mut Turn<'_>) {
        let mut answer = Vec::new();
        self.wire.tick(turn.now_s, &mut answer);
        self.answer(answer, turn);
        let understood = self.understands(turn);
        self.frames.due(turn, &self.wire, Peer::Everyone, |bytes| {
            if !understood {
                garble(bytes);
            }
        });
    }

    fn due_s(&self) -> Option<f64> {
        self.frames.next_s()
    }
}
