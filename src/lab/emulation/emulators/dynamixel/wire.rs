//! The emulated bus on a pseudo-terminal.

use std::io;

use super::Bus;
use crate::emulators::{Emulator, EmulatorTurn, WireEnd, WirePeer, wires::terminal};

/// Delay with which a waiting thread wakes up, s; answers are still punctual.
const WAKE_S: f64 = 50e-6;

impl Emulator for Bus {
    fn wires(&self) -> io::Result<Vec<Box<dyn WireEnd>>> {
        Ok(vec![terminal(self.link.as_deref(), "bus", Some(self.baud()))?])
    }

    /// Data of a client with another baud rate are ignored.
    fn receive(&mut self, _: WirePeer, bytes: &[u8], turn: &mut EmulatorTurn<'_>) {
        if turn.baud == Some(self.baud()) {
            self.receive(turn.now_s, bytes);
        }
    }

    fn pass(&mut self, turn: &mut EmulatorTurn<'_>) {
        self.send(turn.now_s, turn.fault, &mut |frame| turn.send(WirePeer::Everyone, frame));
    }

    fn due_s(&self) -> Option<f64> {
        self.next_s().map(|due_s| due_s - WAKE_S)
    }
}
